//! What is done with a drawing that is read unsurely: rooms and openings as data, questions, no options.

#![allow(clippy::unwrap_used)]

use std::fmt::Write as _;
use std::time::Instant;

use enfilade_config::{Partial, ReadingTable, Settings, Unsure};
use enfilade_overlay::result::RoundResult;
use enfilade_pipeline::{Input, Outcome};
use enfilade_report::Cancel;

/// Lines on a layer of walls, metres.
fn dxf(lines: &[[f64; 4]], texts: &[([f64; 2], &str)]) -> String {
    let mut out =
        String::from("0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n6\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n");
    for [x0, y0, x1, y1] in lines {
        let _ = write!(out, "0\nLINE\n8\nWALL\n10\n{x0}\n20\n{y0}\n11\n{x1}\n21\n{y1}\n");
    }
    for ([x, y], text) in texts {
        let _ = write!(out, "0\nTEXT\n8\nROOMS\n10\n{x}\n20\n{y}\n40\n0.3\n1\n{text}\n");
    }
    out + "0\nENDSEC\n0\nEOF\n"
}

/// A hall of 10 m × 10 m, and beside it a room of 4 m × 9 m that is open to the outside over `gap` metres.
fn hall_and_porch(gap: f64) -> String {
    let outer =
        [[0.0, 0.0, 10.0, 0.0], [10.0, 0.0, 10.0, 10.0], [10.0, 10.0, 0.0, 10.0], [0.0, 10.0, 0.0, 0.0]];
    let porch = [
        [10.0, 0.5, 16.0, 0.5],
        [16.0, 9.5, 10.0, 9.5],
        [16.0, 0.5, 16.0, 5.0 - gap / 2.0],
        [16.0, 5.0 + gap / 2.0, 16.0, 9.5],
    ];
    dxf(&[&outer[..], &porch[..]].concat(), &[([4.0, 5.0], "Hall"), ([4.0, 4.0], "100 m2")])
}

fn settings(unsure: Option<Unsure>) -> Settings {
    let partial =
        Partial { unsure, evaluations: Some(20), spacing: Some(0.5), threads: Some(1), ..Partial::default() };
    Settings::new(partial).unwrap()
}

fn run(text: &str, unsure: Option<Unsure>) -> Outcome<RoundResult> {
    let input = Input::new("plan.dxf", text.as_bytes(), 1);
    enfilade_pipeline::run(&input, &settings(unsure), Instant::now(), &mut |_| {}, &Cancel::default())
        .unwrap()
}

#[test]
fn rooms_have_their_names_and_their_areas_on_the_drawn_lines() {
    let text = hall_and_porch(0.0);
    let outcome =
        enfilade_pipeline::check(&Input::new("plan.dxf", text.as_bytes(), 1), &settings(None)).unwrap();
    let reading = outcome.result.reading.unwrap();
    let rooms: Vec<(&str, f64)> = reading.rooms.iter().map(|r| (r.name.as_str(), r.area_m2)).collect();
    assert_eq!(rooms, [("Hall", 100.0), ("", 54.0)]);
    assert_eq!(reading.rooms[0].outline.len(), 4);
    assert_eq!((reading.coverage, reading.questions.len()), (Some(1.0), 0));
    let of_role = |role: &str| reading.entities.iter().filter(|e| e.role == role).count();
    assert_eq!((of_role("wall"), of_role("annotation")), (8, 2));
    assert_eq!(outcome.result.schema, "enfilade.check/2");
}

/// The samples state their units, or leave no doubt.
#[test]
fn samples_ask_nothing() {
    let files = std::fs::read_dir(enfilade_fixtures::repository("samples")).unwrap();
    let paths = files.map(|f| f.unwrap().path());
    let drawings: Vec<_> =
        paths.filter(|p| p.extension().is_some_and(|e| e != "md" && e != "enfilade")).collect();
    assert!(drawings.len() > 15, "{drawings:?}");
    for path in drawings {
        let bytes = std::fs::read(&path).unwrap();
        let name = path.file_name().unwrap().to_str().unwrap();
        let outcome = enfilade_pipeline::check(&Input::new(name, &bytes, 1), &settings(None)).unwrap();
        let reading = outcome.result.reading.unwrap();
        assert_eq!(reading.questions, [], "{name}");
    }
}

#[test]
fn floor_left_out_is_asked_for_and_nothing_is_optimised_until_it_is_answered() {
    let text = hall_and_porch(5.2);
    let asked = run(&text, None);
    let codes = |o: &Outcome<RoundResult>| o.report.problems.iter().filter(|p| p.code == "unsure").count();
    assert_eq!((asked.result.candidates.len(), asked.result.evaluations, codes(&asked)), (0, 0, 1));
    let [question] = &asked.result.questions[..] else { panic!("{:?}", asked.result.questions) };
    assert_eq!((question.about.as_str(), question.answers.len()), ("floor", 2));
    let keys: Vec<&str> =
        question.answers.iter().flat_map(|a| a.correction.keys()).map(String::as_str).collect();
    assert_eq!(keys, ["outside", "inside"]);
    let at = question.values["at"].as_array().unwrap();
    assert!((10.0..14.0).contains(&at[0].as_f64().unwrap()));
    let point = [0, 1].map(|k| at[k].as_f64().unwrap());
    let reading = ReadingTable { outside: vec![point], ..ReadingTable::default() };
    let answered = Settings::new(Partial { reading, ..Partial::default() }).unwrap();
    let outcome = enfilade_pipeline::check(&Input::new("plan.dxf", text.as_bytes(), 1), &answered).unwrap();
    let reading = outcome.result.reading.unwrap();
    assert_eq!((reading.questions.len(), reading.coverage), (0, Some(1.0)));
    let gone_on = run(&text, Some(Unsure::Optimise));
    assert_eq!((codes(&gone_on), gone_on.result.questions.len()), (0, 1));
}

#[test]
fn the_graph_says_which_opening_joins_which_rooms() {
    // Two rooms with a passage of 1 m between them.
    let walls = [
        [0.0, 0.0, 8.0, 0.0],
        [8.0, 0.0, 8.0, 4.0],
        [8.0, 4.0, 0.0, 4.0],
        [0.0, 4.0, 0.0, 0.0],
        [4.0, 0.0, 4.0, 1.5],
        [4.0, 2.5, 4.0, 4.0],
    ];
    let text = dxf(&walls, &[([1.0, 2.0], "West"), ([6.0, 2.0], "East")]);
    let outcome =
        enfilade_pipeline::check(&Input::new("plan.dxf", text.as_bytes(), 1), &settings(None)).unwrap();
    let file = |name: &str| outcome.files.iter().find(|f| f.path.as_os_str() == name).unwrap();
    let graph: enfilade_overlay::graph::PlanGraph =
        serde_json::from_slice(&file("graph.json").bytes).unwrap();
    assert_eq!(graph.rooms.iter().map(|r| r.name.as_str()).collect::<Vec<_>>(), ["outside", "West", "East"]);
    let [opening] = &graph.openings[..] else { panic!("{:?}", graph.openings) };
    let mut rooms = opening.rooms;
    rooms.sort_unstable();
    assert_eq!((rooms, opening.width_m), ([Some(1), Some(2)], 1.0));
    assert!(file("graph.graphml").bytes.starts_with(b"<?xml"));
}

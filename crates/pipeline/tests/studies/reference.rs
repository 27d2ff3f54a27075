//! The published reference values, by an independent program (`../shared/reference`).

#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::collections::HashMap;
use std::path::PathBuf;

use enfilade_config::{Partial, Settings};
use enfilade_pipeline::{Input, Study};
use enfilade_report::Cancel;
use serde_json::Value;

fn reference(file: &str) -> Option<PathBuf> {
    let shared = std::env::var_os("ENFILADE_SHARED")
        .map_or_else(|| enfilade_fixtures::repository("../shared"), PathBuf::from);
    let path = shared.join("reference").join(file);
    if !path.exists() {
        eprintln!("skipped: {file} is not there");
        return None;
    }
    Some(path)
}

fn study(file: &str, partial: Partial) -> Option<Study> {
    let bytes = std::fs::read(reference(file)?).unwrap();
    let settings = Settings::new(partial).unwrap();
    let input = Input::new(file, &bytes, 1);
    Some(enfilade_pipeline::analyse(&input, &settings, &Cancel::default()).unwrap().1)
}

fn expected(file: &str) -> Option<Value> {
    Some(serde_json::from_slice(&std::fs::read(reference(file)?).unwrap()).unwrap())
}

fn assert_values(study: &Study, expected: &Value) {
    let count = |key: &str| expected["counts"][key].as_u64().unwrap();
    let lattice = &study.lattice;
    assert_eq!(lattice.cells.len() as u64, count("vertices"));
    assert_eq!(lattice.query.len() as u64, count("query"));
    assert_eq!(lattice.is_reference.iter().filter(|r| **r).count() as u64, count("reference"));
    assert_eq!(study.edges, count("edges"));
    let means = study.initial.seen.means;
    for (key, found) in [
        ("degree", means.degree),
        ("degree_all", means.degree_all),
        ("depth", means.depth),
        ("entropy", means.entropy),
    ] {
        let expected = expected["mean"][key].as_f64().unwrap();
        assert!((found - expected).abs() < 1e-9, "{key}: {found}, expected {expected}");
    }
    let clearance = expected["penalty"]["clearance"].as_f64().unwrap();
    assert!(
        (study.initial.clearance_m2 - clearance).abs() < 1e-6,
        "{} {clearance}",
        study.initial.clearance_m2
    );
}

fn partial(expected: &Value) -> Partial {
    let centre = |k: usize| expected["lattice_centre"][k].as_f64().unwrap();
    Partial {
        spacing: expected["spacing_m"].as_f64(),
        lattice_centre: Some([centre(0), centre(1)]),
        ..Partial::default()
    }
}

#[test]
fn the_rooms() {
    for name in ["simple_room", "large_room", "art_gallery"] {
        let Some(expected) = expected(&format!("{name}.expected.json")) else { return };
        let study = study(&format!("{name}.dxf"), partial(&expected)).unwrap();
        assert_values(&study, &expected);
    }
}

#[test]
fn the_maze_at_three_spacings() {
    let Some(all) = expected("maze_a.expected.json") else { return };
    for expected in all["initial"].as_array().unwrap() {
        assert_values(&study("maze_a.dxf", partial(expected)).unwrap(), expected);
    }
}

#[test]
fn the_maze_vertex_by_vertex() {
    let Some(expected) = expected("maze_a.vertices.json") else { return };
    let study = study("maze_a.dxf", partial(&expected)).unwrap();
    let vertices = &expected["per_vertex"];
    let tally = &study.initial.seen.tally;
    let mut starts = vec![0usize];
    tally.depth.iter().for_each(|d| starts.push(starts[starts.len() - 1] + *d as usize));
    let by_place: HashMap<[i64; 2], usize> = study
        .lattice
        .query
        .iter()
        .enumerate()
        .map(|(i, v)| (study.lattice.centre_um(*v as usize), i))
        .collect();
    let places = vertices["xy"].as_array().unwrap();
    assert_eq!(places.len(), tally.degree.len());
    for (k, xy) in places.iter().enumerate() {
        let um = [0, 1].map(|c| (xy[c].as_f64().unwrap() * 1e6).round() as i64);
        let i = by_place[&um];
        assert_eq!(u64::from(tally.degree[i]), vertices["degree"][k].as_u64().unwrap());
        assert_eq!(u64::from(tally.degree_all[i]), vertices["degree_all"][k].as_u64().unwrap());
        let expected: Vec<u64> = vertices["level_counts"][k]
            .as_array()
            .unwrap()
            .iter()
            .skip(1)
            .map(|v| v.as_u64().unwrap())
            .collect();
        let found: Vec<u64> = tally.levels[starts[i]..starts[i + 1]].iter().map(|v| u64::from(*v)).collect();
        assert_eq!(found, expected, "levels at {xy}");
    }
}

#[test]
fn depthmapx_cell_by_cell() {
    let file = "depthmapx-n900/plan.dxf";
    let partial = Partial {
        wall_layer: Some(vec!["WALLS".into()]),
        unit: Some("m".into()),
        spacing: Some(1.3333),
        seed_point: Some(vec![[2.0, 2.0]]),
        ..Partial::default()
    };
    let Some(study) = study(file, partial) else { return };
    let rows = |csv: &str| -> Vec<Vec<String>> {
        csv.lines().map(|l| l.split(',').map(str::to_string).collect()).collect()
    };
    let theirs = rows(&std::fs::read_to_string(reference("depthmapx-n900/cells.csv").unwrap()).unwrap());
    let measured =
        enfilade_pipeline::cells::measure_cells(&study, &enfilade_pipeline::cells::CellOptions::default())
            .unwrap();
    let ours = rows(&enfilade_pipeline::cells::cells_csv(
        &study,
        &enfilade_pipeline::cells::cells(&study, measured.columns),
    ));
    assert_eq!(ours.len(), theirs.len());
    let column = |table: &[Vec<String>], name: &str| table[0].iter().position(|n| n == name).unwrap();
    let by_ref: HashMap<&str, &Vec<String>> = theirs[1..].iter().map(|r| (r[0].as_str(), r)).collect();
    for row in &ours[1..] {
        let other = by_ref[row[0].as_str()];
        for (name, tolerance) in [
            ("x", 1e-5),
            ("y", 1e-5),
            ("Connectivity", 0.0),
            ("Visual Node Count", 0.0),
            ("Visual Mean Depth", 1e-6),
            ("Visual Entropy", 1e-6),
        ] {
            let value = |t: &[Vec<String>], r: &[String]| r[column(t, name)].parse::<f64>().unwrap();
            let (a, b) = (value(&ours, row), value(&theirs, other));
            assert!((a - b).abs() <= tolerance * b.abs().max(1.0), "{name} of {}: {a}, expected {b}", row[0]);
        }
    }
    let sorted = |csv: &str| {
        let mut pairs: Vec<(i64, i64)> = csv
            .lines()
            .skip(1)
            .map(|l| {
                let (a, b) = l.split_once(',').unwrap();
                let (a, b): (i64, i64) = (a.parse().unwrap(), b.parse().unwrap());
                (a.min(b), a.max(b))
            })
            .collect();
        pairs.sort_unstable();
        pairs
    };
    let edges = std::fs::read_to_string(reference("depthmapx-n900/edges.csv").unwrap()).unwrap();
    let ours = sorted(&enfilade_pipeline::cells::edges_csv(&study));
    assert_eq!(ours.len(), 27_839);
    assert!(ours == sorted(&edges));
}

/// Drawn with single lines and without a unit: the width of their rooms is no thickness of walls.
#[test]
fn plans_without_a_unit_are_read_in_metres() {
    for file in ["bench/b40_r12.dxf", "bench/b67_r12.dxf", "bench/b133_r12.dxf", "bench/b267_r12.dxf"] {
        let Some(path) = reference(file) else { return };
        let bytes = std::fs::read(path).unwrap();
        let settings = Settings::new(Partial::default()).unwrap();
        let done = enfilade_pipeline::check(&Input::new(file, &bytes, 1), &settings).unwrap();
        let reason = done.result.unit.reason;
        assert!(reason.starts_with("m assumed"), "{file}: {reason}");
    }
}

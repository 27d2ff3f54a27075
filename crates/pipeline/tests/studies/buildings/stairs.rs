//! Storeys over one another: steps over stairs, told, the same from either side, repeated by `analyse`; and what stands
//! above wall that works take away.

use enfilade_config::{Beside, Partial, Settings};
use enfilade_overlay::result::RoundResult;
use enfilade_pipeline::accept::{Chosen, Origin, accept};
use enfilade_pipeline::{Input, Outcome, Study, analyse};
use enfilade_report::{Cancel, Report};

const IFC: &str = include_str!("../../../../../samples/pavilion.ifc");

/// The sample with a flight of 1.2 by 3 m in the gallery, from the ground floor to the upper one. Regions are those of
/// the sample, or none.
fn house(flight: bool, regions: bool) -> String {
    let flight = if flight {
        "#9000=IFCCARTESIANPOINT((9000.,5000.,0.));\n#9001=IFCAXIS2PLACEMENT3D(#9000,$,$);\n\
         #9002=IFCLOCALPLACEMENT(#17,#9001);\n#9003=IFCRECTANGLEPROFILEDEF(.AREA.,$,$,1200.,3000.);\n\
         #9004=IFCDIRECTION((0.,0.,1.));\n#9005=IFCEXTRUDEDAREASOLID(#9003,$,#9004,3200.);\n\
         #9006=IFCSHAPEREPRESENTATION(#7,'Body','SweptSolid',(#9005));\n#9007=IFCPRODUCTDEFINITIONSHAPE($,$,(#9006));\n\
         #9008=IFCSTAIRFLIGHT('0StairOfThePavilion001',$,'flight',$,$,#9002,#9007,'1',$,$,$,$,$);\n\
         #9009=IFCRELCONTAINEDINSPATIALSTRUCTURE('0StairOfThePavilion002',$,$,$,(#9008),#18);\n"
    } else {
        ""
    };
    let text = IFC.replace("ENDSEC;\nEND-ISO", &format!("{flight}ENDSEC;\nEND-ISO"));
    if regions { text } else { text.replace("('Query'", "('-'").replace("('Reference'", "('-'") }
}

fn settings(storey: &str, over_stairs: bool) -> Settings {
    let partial = Partial {
        storey: Some(storey.into()),
        over_stairs: Some(over_stairs),
        spacing: Some(0.5),
        pictures: Some(false),
        ..Partial::default()
    };
    Settings::new(partial).unwrap()
}

fn measured(text: &str, settings: &Settings) -> (Study, Report) {
    let input = Input::new("house.ifc", text.as_bytes(), 1);
    let (outcome, study) = analyse(&input, settings, &Cancel::default()).unwrap();
    (study, outcome.report)
}

/// A round of two options.
fn round(input: &Input<'_>, settings: Settings) -> Outcome<RoundResult> {
    let settings = Settings { members: 2, ..settings };
    let started = std::time::Instant::now();
    enfilade_pipeline::run(input, &settings, started, &mut |_| {}, &Cancel::default()).unwrap()
}

/// Cells reached, and steps to them, from all cells together.
fn reached(study: &Study) -> [u64; 2] {
    let tally = &study.initial.seen.tally;
    let (mut out, mut at) = ([0; 2], 0);
    for depth in &tally.depth {
        for (n, level) in tally.levels[at..at + *depth as usize].iter().zip(1..) {
            out[0] += u64::from(*n);
            out[1] += u64::from(*n) * level;
        }
        at += *depth as usize;
    }
    out
}

#[test]
fn steps_between_storeys_are_the_same_from_either() {
    let text = house(true, false);
    let over = ["Ground floor", "Upper floor"].map(|storey| {
        let [alone, joined] = [false, true].map(|over| measured(&text, &settings(storey, over)).0);
        assert_eq!(
            alone.initial.seen.tally.degree, joined.initial.seen.tally.degree,
            "stairs are walked, not seen"
        );
        let [alone, joined] = [reached(&alone), reached(&joined)];
        [joined[0] - alone[0], joined[1] - alone[1]]
    });
    assert!(over[0][0] > 0 && over[0][1] > 2 * over[0][0], "{over:?}");
    assert_eq!(over[0], over[1]);
}

#[test]
fn what_stairs_join_is_told() {
    let told = |text: &str| {
        let report = measured(text, &settings("Ground floor", true)).1;
        let of = report.problems.iter().filter(|p| p.code.starts_with("stairs"));
        of.map(|p| (p.code, p.text.clone())).collect::<Vec<_>>()
    };
    let joined = told(&house(true, true));
    assert!(
        matches!(joined.as_slice(), [("stairs", text)] if text.contains("over the stairs to Upper floor")),
        "{joined:?}"
    );
    let apart = told(&house(false, true));
    assert!(
        matches!(apart.as_slice(), [("stairs-none", text)] if text.contains("no stair was found")),
        "{apart:?}"
    );
    // Without a stair nothing changes.
    let [alone, over] =
        [false, true].map(|over| measured(&house(false, true), &settings("Ground floor", over)).0);
    assert_eq!(alone.initial.seen, over.initial.seen);
}

/// An option says in its settings how it was measured: over the stairs, to the last digit.
#[test]
fn an_option_is_measured_over_the_stairs_again() {
    let text = house(true, true);
    let input = Input::new("house.ifc", text.as_bytes(), 1);
    let round = round(&input, Settings { evaluations: Some(60), ..settings("Ground floor", true) });
    let file = |name: &str| {
        let found = round.files.iter().find(|f| f.path.ends_with(name));
        found.unwrap_or_else(|| panic!("{name} is there")).bytes.to_vec()
    };
    let candidate = &round.result.candidates[0];
    let name = candidate.file.trim_end_matches(".ifc");
    let said = String::from_utf8(file(&format!("{name}.enfilade.toml"))).unwrap();
    assert!(said.contains("over-stairs = true"), "{said}");
    let again = Settings::new(Partial::from_toml("candidate.enfilade.toml", &said).unwrap()).unwrap();
    let written = file(&candidate.file);
    let input = Input::new("candidate.ifc", &written, 1);
    let (outcome, _) = analyse(&input, &again, &Cancel::default()).unwrap();
    assert_eq!(outcome.result.mean, candidate.mean);
    let alone = Settings { over_stairs: false, ..again };
    let (alone, _) = analyse(&input, &alone, &Cancel::default()).unwrap();
    assert!(alone.result.mean.get("depth") < outcome.result.mean.get("depth"));
}

/// What is accepted on one storey holds nothing on the next: its moves are that storey's own.
#[test]
fn the_next_storey_has_its_own_round() {
    let text = house(true, true);
    let input = Input::new("house.ifc", text.as_bytes(), 1);
    let round = round(&input, Settings { evaluations: Some(60), ..settings("Ground floor", true) });
    let origin = Origin { round: 1, is_so_far: false };
    let taken = accept(&input, Beside::default(), &round.result, origin, Chosen::Option(1)).unwrap();
    let side_car = taken.side_car;
    assert!(side_car.contains("of-storey = \"Ground floor\""), "{side_car}");
    let moves = |storey: Option<&str>| {
        let asked = Partial { storey: storey.map(Into::into), ..Partial::default() };
        let partial = asked.over(Partial::from_toml("", &side_car).unwrap());
        let settings = Settings::new(partial).unwrap();
        let input = Input::new("house-r02.ifc", &taken.drawing, 2);
        let done = enfilade_pipeline::check(&input, &settings).unwrap();
        let told = done.report.problems.iter().any(|p| p.code == "storey-tables");
        let mut names: Vec<String> = done.result.moves.into_iter().map(|m| m.name).collect();
        names.dedup();
        (names, told)
    };
    assert_eq!(moves(Some("2")), (vec!["screen-5".to_owned()], true));
    let ground = moves(Some("1"));
    assert!(ground.0.contains(&"screen-1".to_owned()) && !ground.1, "{ground:?}");
}

/// An opening below a wall of the upper floor names it, and over how much of the opening it stands.
#[test]
fn what_stands_above_wall_that_goes_is_named() {
    let storey = IFC.lines().find(|l| l.contains("'Upper floor'")).and_then(|l| l.split_once('=')).unwrap().0;
    // 2 m of wall over the wall of the hall, which runs up at 7 m.
    let wall = format!(
        "#9000=IFCCARTESIANPOINT((7000.,4200.,0.));\n#9001=IFCAXIS2PLACEMENT3D(#9000,$,$);\n\
         #9002=IFCLOCALPLACEMENT(#520,#9001);\n#9003=IFCRECTANGLEPROFILEDEF(.AREA.,$,$,200.,2000.);\n\
         #9004=IFCDIRECTION((0.,0.,1.));\n#9005=IFCEXTRUDEDAREASOLID(#9003,$,#9004,3000.);\n\
         #9006=IFCSHAPEREPRESENTATION(#7,'Body','SweptSolid',(#9005));\n#9007=IFCPRODUCTDEFINITIONSHAPE($,$,(#9006));\n\
         #9008=IFCWALL('0WallOfThePavilion0001',$,'above',$,$,#9002,#9007,'1',$);\n\
         #9009=IFCRELCONTAINEDINSPATIALSTRUCTURE('0WallOfThePavilion0002',$,$,$,(#9008),{storey});\n"
    );
    let plain = IFC.replace("'Pset_Enfilade'", "'Pset_Other'");
    let over = |text: &str, storey: &str| {
        let allow = "structure".parse().unwrap();
        let input = Input::new("house.ifc", text.as_bytes(), 1);
        let round = round(&input, Settings { evaluations: Some(20), allow, ..settings(storey, false) });
        let built = round.result.candidates.into_iter().filter(|c| !c.works.is_empty());
        built.map(|c| (c.words, c.works)).collect::<Vec<_>>()
    };
    let alone = over(&plain, "Ground floor");
    assert!(!alone.is_empty() && alone.iter().all(|(_, works)| works.iter().all(|w| w.above.is_none())));
    let walled = plain.replace("ENDSEC;\nEND-ISO", &format!("{wall}ENDSEC;\nEND-ISO"));
    let options = over(&walled, "Ground floor");
    let below = options.iter().flat_map(|(words, works)| works.iter().map(move |w| (words, w)));
    let below: Vec<_> = below.filter_map(|(words, w)| Some((words, w.stretch, w.above.clone()?))).collect();
    assert!(!below.is_empty(), "{options:?}");
    for (words, stretch, above) in below {
        assert_eq!(above.storey, "Upper floor");
        assert_eq!(above.elements.iter().map(|e| e.name()).collect::<Vec<_>>(), ["#9008"]);
        let [lo, hi] = [0, 1].map(|k| stretch[k][1].clamp(3.2, 5.2));
        assert!((above.length_m - (hi - lo).abs()).abs() < 0.06, "{stretch:?} {above:?}");
        assert!(words.contains("of it walls of storey \"Upper floor\" stand: #9008"), "{words}");
    }
}

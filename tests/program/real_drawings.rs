//! Real drawings of many offices: walls on the right layers, the right unit, the right view.
//!
//! The drawings are not part of the repository; the folder that `ENFILADE_SHARED` names holds them.

#![allow(clippy::expect_used)]

use std::path::PathBuf;
use std::process::Command;

use enfilade_cad::drawing::Drawing;
use enfilade_cad::dxf;
use enfilade_config::{Partial, Settings};
use enfilade_pipeline::{Extras, Input};
use enfilade_plan::axes::{AxisGraph, Drawn, Path};
use enfilade_plan::{Plan, PlanOptions, drawn, understand};
use enfilade_report::Report;
use glam::DVec2;

/// File, metres in a unit where it is known, layers of the walls, drawings on the sheet.
const DRAWINGS: &[(&str, Option<f64>, &[&str], usize)] = &[
    ("gallery_depthmapx", None, &["0"], 1),
    ("us_house_bishop", Some(0.0254), &["xref-Bishop-Overland-08$0$A-WALL"], 1),
    ("ceco_villa_plan", Some(1.0), &["wall high"], 1),
    ("pms_building001_floor3_aia", Some(0.0254), &["A-WALL"], 1),
    ("giraffe360_residential", Some(0.01), &["Pillars", "Walls"], 1),
    (
        "roomsize_ground_floor_lhs",
        Some(1.0),
        // Partitions of glass, on "Layer 1 11" and on the layer of doors, are not read.
        &["A-210 G - Existing Structure 4", "A-320G - Permanent Solid Partitions 12"],
        1,
    ),
    ("roomsize_two_rooms", Some(1.0), &["A-210 G - Existing Structure 1", "A-325G - Internal Doors 3"], 1),
    ("olymp_librecad", Some(0.01), &["Wand (neu)"], 1),
    ("gama_house_librecad", Some(0.01), &["MURS", "Wall"], 1),
    ("barcelona_freecad_r12", Some(0.001), &["0"], 1),
    ("potynobg_pianta_house", Some(1.0), &["PIANTA"], 1),
    // Two storeys, and the elevations; the walls between posts, on "_0-2_", are not read.
    ("ono_jwcad_house_r12_sjis", Some(0.001), &["_0-3_柱", "_0-9_壁__窓"], 3),
    ("ensal", Some(0.01), &["Walls"], 1),
    ("san_sebastian", None, &["Walls"], 1),
];

fn read(name: &str) -> Option<Plan> {
    Some(opened(name)?.0)
}

fn opened(name: &str) -> Option<(Plan, Drawing)> {
    let shared = PathBuf::from(std::env::var_os("ENFILADE_SHARED")?);
    let file = format!("{name}.dxf");
    let bytes = std::fs::read(shared.join("data/dxf").join(&file)).expect("the drawing is there");
    let mut report = Report::default();
    let drawing = dxf::read(&file, &bytes, &dxf::ReadOptions::default(), &mut report).expect("it is read");
    let plan = understand(&drawing, &PlanOptions::default(), &mut report).expect("it is understood");
    Some((plan, drawing))
}

#[test]
fn walls_units_and_views_of_real_drawings() {
    for (name, metres, layers, views) in DRAWINGS {
        let Some(plan) = read(name) else {
            eprintln!("skipped: ENFILADE_SHARED names no folder with the drawings");
            return;
        };
        if let Some(metres) = metres {
            assert_eq!(plan.unit.unit.metres, *metres, "{name}: {}", plan.unit.reason);
        }
        let taken: Vec<&str> =
            plan.layers.iter().filter(|l| l.role == "wall").map(|l| l.name.as_str()).collect();
        let used = taken.iter().filter(|l| layers.contains(l)).count();
        assert_eq!(used, layers.len(), "{name}: {taken:?}");
        assert_eq!((plan.views.len(), taken.len()), (*views, layers.len()), "{name}: {taken:?}");
        assert!(plan.views.iter().any(|v| v.is_chosen), "{name}");
    }
}

/// The same drawing elsewhere on its sheet has the same walls and openings: nothing hangs on errors of rounding.
#[test]
fn walls_are_the_same_wherever_they_stand() {
    for (name, ..) in DRAWINGS {
        let Some((plan, drawing)) = opened(name) else { return };
        let (drawn, _) = drawn::drawn(&plan, &drawing);
        let here = AxisGraph::new(&drawn);
        for by in [DVec2::new(-4.383, 6.467), DVec2::new(713.09, -1_291.7), DVec2::new(0.1, 1.0 / 3.0)] {
            let there = AxisGraph::new(&shifted(&drawn, by));
            let near = |p: DVec2, q: DVec2| (q - p - by).length() < 1e-5;
            assert_eq!(
                (here.edges.len(), here.openings.len()),
                (there.edges.len(), there.openings.len()),
                "{name}"
            );
            let pairs = here.openings.iter().zip(&there.openings);
            for (a, b) in pairs {
                assert!(a.kind == b.kind && near(a.centre, b.centre), "{name}: {a:?} {b:?}");
            }
            let pairs = here.nodes.iter().zip(&there.nodes);
            assert!(pairs.into_iter().all(|(a, b)| near(a.at, b.at)), "{name}");
        }
    }
}

fn shifted(drawn: &Drawn, by: DVec2) -> Drawn {
    let mut out = drawn.clone();
    let faces = out.faces.iter_mut().map(|f| &mut f.path);
    for path in faces.chain(out.marks.iter_mut().flat_map(|m| &mut m.paths)) {
        match path {
            Path::Line { a, b } => (*a, *b) = (*a + by, *b + by),
            Path::Arc { centre, .. } => *centre += by,
        }
    }
    out
}

/// Files of one building in two formats measure within 2 % of each other.
#[test]
fn twins_agree() {
    let Some(shared) = std::env::var_os("ENFILADE_SHARED") else { return };
    let script = enfilade_fixtures::repository("scripts/compare-twins");
    let data = PathBuf::from(shared).join("data");
    let program = env!("CARGO_BIN_EXE_enfilade");
    let done = Command::new("python3").arg(script).arg(program).arg(data).output().expect("Python is there");
    let said = String::from_utf8_lossy(&done.stdout);
    assert!(done.status.success(), "{said}{}", String::from_utf8_lossy(&done.stderr));
    assert!(said.contains("pavilion: "), "{said}");
}

/// Two windows of a round wall with a pier between them are not one window that closes a room.
#[test]
fn a_round_wall_alone_encloses_no_room() {
    let Some(shared) = std::env::var_os("ENFILADE_SHARED") else { return };
    let folder = tempfile::tempdir().expect("a folder");
    let drawing = folder.path().join("round.ifc");
    std::fs::copy(PathBuf::from(shared).join("data/ifc/vectorworks_curved_wall.ifc"), &drawing)
        .expect("it is there");
    let done =
        Command::new(env!("CARGO_BIN_EXE_enfilade")).arg("analyse").arg(&drawing).output().expect("it runs");
    let said = String::from_utf8_lossy(&done.stderr);
    assert!(done.status.code() == Some(2) && said.contains("the walls enclose no room"), "{said}");
}

/// How large the measured floor is as a person adds it up in the picture of `check`, m².
const FLOORS: &[(&str, f64)] = &[
    ("barcelona_freecad_r12", 240.0),
    ("ceco_villa_plan", 140.0),
    ("ensal", 3_700.0),
    ("gama_house_librecad", 67.0),
    ("giraffe360_residential", 65.0),
    ("pms_building001_floor3_aia", 490.0),
    ("potynobg_pianta_house", 83.0),
    ("roomsize_ground_floor_lhs", 540.0),
    ("roomsize_two_rooms", 26.0),
    ("us_house_bishop", 180.0),
];

/// Floors may differ from [`FLOORS`] by this share: a deck, a niche.
const FLOOR_OFF: f64 = 0.08;

#[test]
fn floors_of_real_drawings() {
    let Some(shared) = std::env::var_os("ENFILADE_SHARED").map(PathBuf::from) else { return };
    let settings = Settings::new(Partial::default()).expect("settings");
    for (name, floor_m2) in FLOORS {
        let file = format!("{name}.dxf");
        let bytes = std::fs::read(shared.join("data/dxf").join(&file)).expect("the drawing is there");
        let done = enfilade_pipeline::check_with(&Input::new(&file, &bytes, 1), &settings, Extras::default());
        let reading = done.expect("it is read").result.reading.expect("a reading");
        let found: f64 = reading.rooms.iter().map(|r| r.area_m2).sum();
        assert!((found / floor_m2 - 1.0).abs() <= FLOOR_OFF, "{name}: {found:.0} m², expected {floor_m2}");
    }
}

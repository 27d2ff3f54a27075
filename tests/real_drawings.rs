//! Real drawings of many offices: walls on the right layers, the right unit, the right view.
//!
//! The drawings are not part of the repository; the folder that `ENFILADE_SHARED` names holds them.

#![allow(clippy::expect_used)]

use std::path::PathBuf;

use enfilade::formats::dxf;
use enfilade::plan::{Plan, PlanOptions, understand};
use enfilade::report::Report;

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
        &["A-210 G - Existing Structure 4", "A-320G - Permanent Solid Partitions 12", "Layer 1 11"],
        1,
    ),
    ("roomsize_two_rooms", Some(1.0), &["A-210 G - Existing Structure 1"], 1),
    ("olymp_librecad", Some(0.01), &["Wand (neu)"], 1),
    ("gama_house_librecad", Some(0.01), &["MURS", "Wall"], 1),
    ("barcelona_freecad_r12", Some(0.001), &["0"], 1),
    ("potynobg_pianta_house", Some(1.0), &["PIANTA"], 1),
    // Two storeys, and the elevations.
    ("ono_jwcad_house_r12_sjis", Some(0.001), &["_0-2_", "_0-3_柱", "_0-9_壁__窓"], 3),
    ("ensal", Some(0.01), &["Walls"], 1),
    ("san_sebastian", None, &["Walls"], 1),
];

fn read(name: &str) -> Option<Plan> {
    let shared = PathBuf::from(std::env::var_os("ENFILADE_SHARED")?);
    let file = format!("{name}.dxf");
    let bytes = std::fs::read(shared.join("data/dxf").join(&file)).expect("the drawing is there");
    let mut report = Report::default();
    let drawing = dxf::read(&file, &bytes, &dxf::ReadOptions::default(), &mut report).expect("it is read");
    Some(understand(&drawing, &PlanOptions::default(), &mut report).expect("it is understood"))
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

//! IFC and glTF: one building in three formats, what is written back, bad input and limits.

#![allow(clippy::unwrap_used, clippy::expect_used)]

mod building;
mod gltf;
mod ifc;
mod lengths;
mod pavilion;
mod stairs;

use enfilade_config::{Partial, RegionTable, Settings};
use enfilade_pipeline::{Input, Study};
use enfilade_report::Cancel;

/// Measures the hall of a building; `unit` is one metre in the file's unit.
fn hall(file: &str, bytes: &[u8], unit: f64) -> Study {
    let ring = building::HALL.map(|p| p.map(|v| v * unit)).to_vec();
    let region = |kind: &str| RegionTable { kind: kind.into(), pair: None, points: ring.clone() };
    let partial = Partial {
        spacing: Some(0.4),
        lattice_centre: Some([0.123, 0.057]),
        ignore_move_markers: Some(true),
        regions: vec![region("query"), region("reference")],
        ..Partial::default()
    };
    let settings = Settings::new(partial).unwrap();
    let input = Input::new(file, bytes, 1);
    enfilade_pipeline::analyse(&input, &settings, &Cancel::default()).unwrap().1
}

#[test]
fn one_building_in_three_formats_is_one_plan() {
    let walls = building::house();
    let dxf = hall("house.dxf", building::dxf(&walls, 1.5).as_bytes(), 1.0);
    let ifc = hall("house.ifc", building::ifc(&walls).as_bytes(), 1000.0);
    let glb = hall("house.glb", &building::glb(&walls), 1.0);
    assert!(dxf.lattice.cells.len() > 300, "{}", dxf.lattice.cells.len());
    for other in [&ifc, &glb] {
        assert_eq!(other.lattice.cells, dxf.lattice.cells);
        assert_eq!((other.edges, &other.initial.seen.tally), (dxf.edges, &dxf.initial.seen.tally));
    }
}

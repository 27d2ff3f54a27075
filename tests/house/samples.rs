//! The drawings in `samples/` are those that `cargo run --example make_samples` writes.

#![allow(clippy::expect_used)]

#[path = "../../examples/make_samples/building.rs"]
mod building;
#[path = "../../examples/make_samples/dxf.rs"]
mod dxf;
#[path = "../../examples/make_samples/gltf.rs"]
mod gltf;
#[path = "../../examples/make_samples/ifc.rs"]
mod ifc;
#[path = "../../examples/make_samples/plans.rs"]
mod plans;

use std::collections::BTreeSet;

fn folder() -> std::path::PathBuf {
    enfilade_fixtures::repository("samples")
}

/// Written by `scripts/samples/make_buildings.py`, each in three formats.
const BUILDINGS: [&str; 3] = ["flat", "small-office", "school-wing"];

#[test]
fn samples_are_what_the_generator_writes() {
    for (name, text) in plans::all() {
        let committed = std::fs::read(folder().join(name)).expect(name);
        assert!(committed == text, "{name} differs: run `cargo run --example make_samples`");
    }
}

#[test]
fn every_sample_is_made_and_described() {
    let buildings =
        BUILDINGS.iter().flat_map(|b| ["dxf", "ifc", "glb"].map(|ending| format!("{b}.{ending}")));
    let made: BTreeSet<String> =
        plans::all().into_iter().map(|(name, _)| name.to_owned()).chain(buildings).collect();
    let names = std::fs::read_dir(folder()).expect("samples").map(|e| e.expect("entry").file_name());
    let drawings = names
        .filter_map(|n| n.into_string().ok())
        .filter(|n| !n.ends_with(".md") && !n.ends_with(".enfilade"))
        .collect();
    assert_eq!(made, drawings);
    let readme = std::fs::read_to_string(folder().join("README.md")).expect("README.md");
    for name in &made {
        assert!(readme.contains(&format!("| `{name}` |")), "samples/README.md does not describe {name}");
    }
}

//! The drawings in `samples/` are those that `cargo run --example make_samples` writes.

#![allow(clippy::expect_used)]

#[path = "../examples/make_samples/building.rs"]
#[allow(dead_code)]
mod building;
#[path = "../examples/make_samples/dxf.rs"]
mod dxf;
#[path = "../examples/make_samples/plans.rs"]
mod plans;

use std::collections::BTreeSet;
use std::path::Path;

fn folder() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("samples")
}

fn all() -> Vec<(&'static str, Vec<u8>)> {
    let drawings = plans::all().into_iter().map(|(name, text)| (name, text.as_bytes().to_vec()));
    drawings.chain(building::all()).collect()
}

#[test]
fn samples_are_what_the_generator_writes() {
    for (name, bytes) in all() {
        let committed = std::fs::read(folder().join(name)).expect(name);
        assert!(committed == bytes, "{name} differs: run `cargo run --example make_samples`");
    }
}

#[test]
fn every_sample_is_made_and_described() {
    let made: BTreeSet<String> = all().into_iter().map(|(name, _)| name.to_owned()).collect();
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

//! Any bytes as glTF or GLB: no panic, the same answer twice, no edit no change, what may move can be moved, and
//! what we add shows nothing new.
#![no_main]

mod building;

use enfilade::formats::{ReadOptions, read};
use enfilade::report::Report;
use libfuzzer_sys::fuzz_target;

const FILE: &str = "fuzz.gltf";

fuzz_target!(|bytes: &[u8]| {
    let Some(drawing) = building::read_steadily(FILE, bytes) else { return };
    building::move_some(FILE, bytes, &drawing);
    if let Some(added) = building::with_additions(FILE, bytes) {
        let after = read(FILE, &added, &ReadOptions::default(), &mut Report::default());
        assert_eq!(after.map(|d| d.entities).ok(), Some(drawing.entities), "what was added is shown");
    }
});

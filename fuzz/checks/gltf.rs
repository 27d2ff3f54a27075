//! Any bytes as glTF or GLB: no panic, the same answer twice, no edit no change, what may move can be moved, and
//! what we add shows nothing new.

use enfilade_cad::{ReadOptions, read};
use enfilade_report::Report;

use super::building;

const FILE: &str = "fuzz.gltf";

/// Whether the bytes could be read.
pub fn check(bytes: &[u8]) -> bool {
    let Some(drawing) = building::read_steadily(FILE, bytes) else { return false };
    building::move_one(FILE, bytes, &drawing);
    if let Some(added) = building::with_additions(FILE, bytes) {
        let after = read(FILE, &added, &ReadOptions::default(), &mut Report::default());
        assert_eq!(after.map(|d| d.entities).ok(), Some(drawing.entities), "what was added is shown");
    }
    true
}

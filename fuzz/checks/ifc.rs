//! Any bytes as IFC: no panic, the same answer twice, no edit no change, what may move can be moved, and what we
//! add comes off again.

use enfilade_cad::{ifc, plain};

use super::building;

const FILE: &str = "fuzz.ifc";

/// Whether the bytes could be read.
pub fn check(bytes: &[u8]) -> bool {
    let _ = ifc::inventory(bytes, None);
    let _ = ifc::strip_own(bytes);
    let Some(drawing) = building::read_steadily(FILE, bytes) else { return false };
    // An archive is unpacked before it is written.
    if ifc::is_zip(bytes) {
        return true;
    }
    building::move_one(FILE, bytes, &drawing);
    if let Some(added) = building::with_additions(FILE, bytes) {
        let stripped = ifc::strip_own(&added);
        assert!(*stripped == *bytes || plain(FILE, bytes).len() < bytes.len(), "what was added stays");
    }
    true
}

//! Real drawings, where they lie beside the repository: read, patched and checked from outside.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a failing helper fails the test")]

use crate::support::{additions_for, corpus, edits_of, read_whole};
use enfilade_cad::drawing::{Edit, Editable, RigidMotion};
use enfilade_cad::dxf::{Completeness, changed_records, is_complete, patch, strip_own};
use glam::DVec2;

#[test]
fn every_drawing_is_read() {
    for (name, bytes) in corpus() {
        assert_eq!(is_complete(&bytes), Completeness::Whole, "{name}");
        let (drawing, _) = read_whole(&name, &bytes);
        assert!(!drawing.entities.is_empty(), "{name}");
    }
}

#[test]
fn rewriting_what_was_read_changes_no_byte() {
    for (name, bytes) in corpus() {
        let (drawing, _) = read_whole(&name, &bytes);
        let free = drawing.entities.iter().filter(|e| e.editable == Editable::Free);
        let edits: Vec<Edit> =
            free.map(|e| Edit::Shape { record: e.source.record, shape: e.shape.clone() }).collect();
        assert_eq!(patch(&name, &bytes, &[], &[]).unwrap(), bytes, "{name}");
        assert!(patch(&name, &bytes, &edits, &[]).unwrap() == bytes, "{name}");
        assert!(changed_records(&name, &bytes, &edits).unwrap().iter().all(Vec::is_empty), "{name}");
    }
}

/// With `ENFILADE_PYTHON` (an interpreter with ezdxf) and `ENFILADE_DXF_CHECK` (a script that compares two
/// drawings, `BEFORE AFTER`, and exits with 0 where the second is a clean write-back of the first), every
/// drawing with moved walls, moved blocks and additions passes. `ENFILADE_DXF_OUT` keeps the drawings.
#[test]
fn an_outside_check_finds_nothing_wrong() {
    let (Some(python), Some(check)) =
        (std::env::var_os("ENFILADE_PYTHON"), std::env::var_os("ENFILADE_DXF_CHECK"))
    else {
        eprintln!("skipped: ENFILADE_PYTHON or ENFILADE_DXF_CHECK is not set");
        return;
    };
    let temp = tempfile::tempdir().unwrap();
    let out = std::env::var_os("ENFILADE_DXF_OUT").map_or(temp.path().to_owned(), Into::into);
    let motion = RigidMotion { turn_rad: 0.1, shift: DVec2::new(0.25, -0.125) };
    let mut wrong = String::new();
    for (name, bytes) in corpus() {
        let (drawing, _) = read_whole(&name, &bytes);
        let edits = edits_of(&drawing, 7, motion);
        let patched = patch(&name, &bytes, &edits, &additions_for(&drawing)).unwrap();
        let (before, after) = (out.join(format!("before-{name}")), out.join(&name));
        std::fs::write(&before, &bytes).unwrap();
        std::fs::write(&after, &patched).unwrap();
        let stripped = strip_own(&patched);
        let moved = patch(&name, &bytes, &edits, &[]).unwrap();
        let (a, b) = (read_whole(&name, &stripped).0, read_whole(&name, &moved).0);
        assert_eq!(
            (a.layers, a.entities.len(), a.texts.len()),
            (b.layers, b.entities.len(), b.texts.len()),
            "{name}"
        );
        if bytes.starts_with(b"AutoCAD Binary") {
            continue;
        }
        let result =
            std::process::Command::new(&python).arg(&check).arg(&before).arg(&after).output().unwrap();
        let words = String::from_utf8_lossy(&result.stdout);
        eprintln!("{name}: {}", words.lines().next().unwrap_or_default());
        if !result.status.success() {
            wrong += &format!("{name}: {words}{}\n", String::from_utf8_lossy(&result.stderr));
        }
    }
    assert!(wrong.is_empty(), "{wrong}");
}

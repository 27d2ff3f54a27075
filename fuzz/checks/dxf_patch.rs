//! Any bytes that are a drawing: writing back what was read changes nothing, moving it changes its own
//! records alone, and what we add comes off again.

use std::collections::HashSet;

use enfilade_cad::drawing::{Addition, Drawing, Edit, Editable, Mark, RigidMotion, Shape};
use enfilade_cad::dxf::{Limits, ReadOptions, changed_records, patch, read, strip_own, tied};
use enfilade_cad::own_layers::{MOVED, MOVED_RGB, NOTE, NOTE_RGB};
use enfilade_report::Report;
use glam::DVec2;

fn drawing_of(bytes: &[u8]) -> Option<Drawing> {
    let limits = Limits { max_expanded_segments: 5_000, ..Limits::default() };
    let options = ReadOptions { limits, ..ReadOptions::default() };
    read("fuzz.dxf", bytes, &options, &mut Report::default()).ok()
}

fn moved(shape: &Shape, by: DVec2) -> Shape {
    let mut shape = shape.clone();
    match &mut shape {
        Shape::Line { a, b } => (*a += by, *b += by).0,
        Shape::Polyline { vertices, .. } => vertices.iter_mut().for_each(|v| v.at += by),
        Shape::Arc { centre, .. } | Shape::Circle { centre, .. } => *centre += by,
    }
    shape
}

/// Panics where the bytes show a fault; whether they could be read.
pub fn check(bytes: &[u8]) -> bool {
    assert_eq!(patch("fuzz.dxf", bytes, &[], &[]).ok().as_deref(), Some(bytes));
    let Some(drawing) = drawing_of(bytes) else { return false };
    let edits = |by: DVec2| -> Vec<Edit> {
        let free = drawing.entities.iter().filter(|e| e.editable == Editable::Free);
        free.map(|e| Edit::Shape { record: e.source.record, shape: moved(&e.shape, by) }).collect()
    };
    let same = patch("fuzz.dxf", bytes, &edits(DVec2::ZERO), &[]);
    assert!(same.ok().as_deref() == Some(bytes), "what was read is written back as it was");

    let edits = edits(DVec2::new(0.5, -0.25));
    let moved = patch("fuzz.dxf", bytes, &edits, &[]);
    let moved = moved.unwrap_or_else(|error| panic!("a free entity cannot be moved: {error}"));
    if let Some(after) = drawing_of(&moved) {
        assert!(after.entities.len() <= drawing.entities.len());
        for (a, b) in
            after.entities.iter().zip(&drawing.entities).filter(|(_, b)| b.editable != Editable::Free)
        {
            assert!(a.source.record != b.source.record || a == b, "{b:?} changed without an edit: {a:?}");
        }
    }
    // Of the walls alone, so that some things stand.
    let half: Vec<Edit> = edits.iter().take(edits.len().div_ceil(2)).cloned().collect();
    for edits in [edits, half] {
        let found = tied("fuzz.dxf", bytes, &drawing, &edits, (&HashSet::new(), 1.0));
        let found = found.unwrap_or_else(|error| panic!("what is tied to an edit cannot be found: {error}"));
        let follow: Vec<Edit> =
            edits.iter().cloned().chain(found.following.into_iter().map(|f| f.edit)).collect();
        let written = patch("fuzz.dxf", bytes, &follow, &[]);
        assert!(written.is_ok(), "what goes along cannot be written: {written:?}");
    }
    for insert in
        drawing.entities.iter().filter(|e| matches!(e.editable, Editable::WithInsert { .. })).take(3)
    {
        let Editable::WithInsert { turnable } = insert.editable else { continue };
        let motion = RigidMotion { turn_rad: if turnable { 0.25 } else { 0.0 }, shift: DVec2::ONE };
        let edit = Edit::Insert { record: insert.source.record, motion };
        let changed = changed_records("fuzz.dxf", bytes, &[edit]);
        assert!(changed.is_ok(), "a movable INSERT cannot be moved: {changed:?}");
    }

    let add = |layer: &str, rgb, mark| Addition { layer: layer.into(), rgb, mark };
    let additions = [
        add(NOTE, NOTE_RGB, Mark::Text { at: DVec2::ZERO, height: 1.0, text: "ä 壁\nb".into() }),
        add(MOVED, MOVED_RGB, Mark::Path { points: vec![DVec2::ZERO, DVec2::X], closed: false }),
    ];
    if let Ok(added) = patch("fuzz.dxf", bytes, &[], &additions) {
        let after = drawing_of(&added).unwrap_or_else(|| panic!("with additions it cannot be read"));
        assert!(after.texts.len() >= drawing.texts.len() + 2);
        let stripped = drawing_of(&strip_own(&added));
        assert_eq!(
            stripped.map(|d| d.entities.len()),
            drawing_of(&strip_own(bytes)).map(|d| d.entities.len())
        );
    }
    true
}

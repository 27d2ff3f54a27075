//! What holds of any bytes read as a building, whatever the format.

use enfilade_cad::drawing::{Addition, Drawing, Edit, Editable, Entity, Mark, RigidMotion, Shape};
use enfilade_cad::{ReadOptions, changes, is_complete, patch, plain, read, storeys};
use enfilade_report::Report;
use glam::DVec2;

/// Reads it twice: the same answer, every shape finite, and no edit no change.
pub fn read_steadily(file: &str, bytes: &[u8]) -> Option<Drawing> {
    let _ = is_complete(file, bytes);
    let _ = plain(file, bytes);
    let _ = storeys(file, bytes, &ReadOptions::default());
    let options = ReadOptions::default();
    assert_eq!(patch(file, bytes, &options, &[], &[]).ok().as_deref(), Some(bytes));
    let (mut report, mut again) = (Report::default(), Report::default());
    let first = read(file, bytes, &options, &mut report).ok();
    assert_eq!(read(file, bytes, &options, &mut again).ok(), first);
    assert_eq!(report, again);
    let drawing = first?;
    for entity in &drawing.entities {
        let Shape::Polyline { vertices, .. } = &entity.shape else { panic!("{entity:?}") };
        assert!(vertices.len() > 1 && vertices.iter().all(|v| v.at.is_finite()), "{entity:?}");
    }
    Some(drawing)
}

/// An element that may move can be moved: not at all without a change, else without losing what stays. Which one,
/// the bytes decide: over many inputs every one has its turn.
pub fn move_one(file: &str, bytes: &[u8], drawing: &Drawing) {
    let options = ReadOptions::default();
    let mut records: Vec<usize> =
        drawing.entities.iter().filter(|e| e.editable.moves_whole()).map(|e| e.source.record).collect();
    records.dedup();
    let turn: usize = bytes.iter().map(|b| usize::from(*b)).sum();
    if let Some(&record) = records.get(turn % records.len().max(1)) {
        lengthen(file, bytes, drawing, record);
        let edit = |shift: DVec2| [Edit::Insert { record, motion: RigidMotion { turn_rad: 0.0, shift } }];
        let still = patch(file, bytes, &options, &edit(DVec2::ZERO), &[]);
        assert!(
            still.is_err() || still.ok().as_deref() == Some(bytes),
            "moved by nothing, {record} changed the file"
        );
        let edit = edit(DVec2::new(0.5, -0.25));
        let moved = patch(file, bytes, &options, &edit, &[]);
        let named = changes(file, bytes, &options, &edit);
        assert!(named.is_err() || moved.is_ok(), "{moved:?}");
        if let Ok(moved) = moved {
            let after = read(file, &moved, &options, &mut Report::default());
            assert!(after.is_ok(), "after a move it cannot be read: {after:?}");
        }
    }
}

/// A wall that may change its length can, and then the file reads on.
fn lengthen(file: &str, bytes: &[u8], drawing: &Drawing, record: usize) {
    let is_it = |e: &&Entity| e.source.record == record && matches!(e.editable, Editable::Wall { .. });
    if drawing.entities.iter().find(is_it).is_none() {
        return;
    }
    let options = ReadOptions::default();
    let edit = |by: [f64; 2]| [Edit::Ends { record, by }];
    let still = patch(file, bytes, &options, &edit([0.0; 2]), &[]);
    assert!(still.is_ok_and(|s| s == bytes), "a wall no longer than it was changed the file");
    let longer = patch(file, bytes, &options, &edit([-0.5, 0.25]), &[]);
    assert!(longer.is_ok(), "#{record} was said to change its length: {longer:?}");
    let after = longer.and_then(|bytes| read(file, &bytes, &options, &mut Report::default()));
    assert!(after.is_ok(), "after a wall grew it cannot be read: {after:?}");
}

/// The file with what we add, which must be readable.
pub fn with_additions(file: &str, bytes: &[u8]) -> Option<Vec<u8>> {
    let add = |layer: &str, mark| Addition { layer: layer.into(), rgb: [200, 30, 30], mark };
    let own = [
        add("EF-NOTE", Mark::Text { at: DVec2::ZERO, height: 1.0, text: "it's ä 壁\nb".into() }),
        add("EF-HEAT-DEGREE", Mark::Fill { corners: [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y] }),
        add("EF-MOVED", Mark::Path { points: vec![DVec2::ZERO, DVec2::X], closed: false }),
    ];
    let options = ReadOptions::default();
    let added = patch(file, bytes, &options, &[], &own).ok()?;
    let after = read(file, &added, &options, &mut Report::default());
    assert!(after.is_ok(), "with additions it cannot be read: {after:?}");
    Some(added)
}

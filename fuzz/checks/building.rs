//! Any bytes as IFC and as glTF: no panic, the same answer twice, every shape finite, no edit no change, and
//! every element that may move can be moved.

use enfilade::formats::{ReadOptions, changed_records, is_complete, patch, plain, read};
use enfilade::plan::drawing::{Edit, Editable, RigidMotion, Shape};
use enfilade::report::Report;
use glam::DVec2;

/// Panics where the bytes show a fault; whether they could be read.
pub fn check(bytes: &[u8]) -> bool {
    let mut is_read = false;
    for file in ["fuzz.ifc", "fuzz.gltf"] {
        let _ = is_complete(file, bytes);
        let _ = plain(file, bytes);
        let options = ReadOptions::default();
        assert_eq!(patch(file, bytes, &options, &[], &[]).ok().as_deref(), Some(bytes));
        let mut report = Report::default();
        let Ok(drawing) = read(file, bytes, &options, &mut report) else { continue };
        is_read = true;
        for entity in &drawing.entities {
            let Shape::Polyline { vertices, .. } = &entity.shape else { panic!("{entity:?}") };
            assert!(vertices.len() > 1 && vertices.iter().all(|v| v.at.is_finite()), "{entity:?}");
        }
        let mut again = Report::default();
        assert_eq!(read(file, bytes, &options, &mut again).ok().as_ref(), Some(&drawing));
        assert_eq!(report, again);
        let movable = drawing.entities.iter().find(|e| matches!(e.editable, Editable::WithInsert { .. }));
        if let Some(entity) = movable {
            let motion = RigidMotion { turn_rad: 0.0, shift: DVec2::new(0.5, -0.25) };
            let edit = [Edit::Insert { record: entity.source.record, motion }];
            let moved = patch(file, bytes, &options, &edit, &[]);
            assert!(changed_records(file, bytes, &edit).is_err() || moved.is_ok(), "{moved:?}");
        }
    }
    is_read
}

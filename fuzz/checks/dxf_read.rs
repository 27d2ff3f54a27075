//! Any bytes: no panic, the same answer twice, every shape finite, every record in the file.

use enfilade_cad::drawing::Shape;
use enfilade_cad::dxf::{Limits, ReadOptions, is_complete, read};
use enfilade_report::Report;

/// Panics where the bytes show a fault; whether they could be read.
pub fn check(bytes: &[u8]) -> bool {
    let mut is_read = false;
    let _ = is_complete(bytes);
    let limits = Limits { max_expanded_segments: 20_000, ..Limits::default() };
    for accept_missing_eof in [false, true] {
        let options = ReadOptions { accept_missing_eof, limits, ..ReadOptions::default() };
        let mut report = Report::default();
        let Ok(drawing) = read("fuzz.dxf", bytes, &options, &mut report) else { continue };
        is_read = true;
        for entity in &drawing.entities {
            assert!(entity.source.record < bytes.len());
            let is_finite = match &entity.shape {
                Shape::Line { a, b } => a.is_finite() && b.is_finite(),
                Shape::Polyline { vertices, .. } => {
                    !vertices.is_empty() && vertices.iter().all(|v| v.at.is_finite() && v.bulge.is_finite())
                }
                Shape::Arc { centre, radius, start_rad, end_rad } => {
                    centre.is_finite()
                        && *radius > 0.0
                        && radius.is_finite()
                        && (start_rad + end_rad).is_finite()
                }
                Shape::Circle { centre, radius } => centre.is_finite() && *radius > 0.0 && radius.is_finite(),
            };
            assert!(is_finite, "{entity:?}");
        }
        let mut again = Report::default();
        assert_eq!(read("fuzz.dxf", bytes, &options, &mut again).ok(), Some(drawing));
        assert_eq!(report, again);
    }
    is_read
}

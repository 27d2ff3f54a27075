//! What stands in a room and is no wall: stairs and sanitary objects. A wall that slides must not run into them.

use std::collections::BTreeSet;

use super::choice::Hidden;
use super::curve;
use super::drawing::{Drawing, Entity, Shape};
use super::frame::Frame;
use super::geometry::Segment;
use super::layers::{self, words};
use super::parallels::Straight;
use super::roles::{Role, role_by_name};
use super::stairs;

/// Words of layers and blocks of sanitary objects, lower case.
const SANITARY: &[&str] = &[
    "fixture",
    "fixtures",
    "plumbing",
    "plfx",
    "sanitary",
    "sanitaryware",
    "sanitär",
    "sanitaer",
    "sanitari",
    "sanitarios",
    "sanitaire",
    "sanitaires",
    "sanitair",
    "wc",
    "toilet",
    "lavabo",
    "lavatory",
    "basin",
    "bidet",
    "bath",
    "bathtub",
    "shower",
    "dusche",
    "douche",
    "ducha",
    "doccia",
    "inodoro",
    "waschbecken",
    "waschtisch",
    "badewanne",
    "sink",
    "urinal",
    "衛生",
];

/// Most lines among which treads are looked for.
const LINES_MAX: usize = 20_000;

/// Most pieces kept.
const PIECES_MAX: usize = 20_000;

/// The pieces of stairs and sanitary objects, drawing frame, micrometres. `standing`: entities that were found
/// on the layers of walls; `walls`: those that are walls.
pub(super) fn find(
    drawing: &Drawing,
    standing: &[usize],
    walls: &[usize],
    metres_per_unit: f64,
    frame: &Frame,
) -> Vec<Segment> {
    let hidden = Hidden::new(drawing);
    let is_wall: BTreeSet<usize> = walls.iter().copied().collect();
    let mut found: BTreeSet<usize> = standing.iter().copied().collect();
    let mut lines: Vec<Straight> = Vec::new();
    for (i, e) in drawing.entities.iter().enumerate() {
        if is_wall.contains(&i) || layers::is_own(&e.layer) || hidden.entity(e) {
            continue;
        }
        match said(e) {
            Some(true) => drop(found.insert(i)),
            Some(false) => {}
            None => lines.extend(straight(i, e, metres_per_unit)),
        }
    }
    if lines.len() <= LINES_MAX {
        found.extend(stairs::find(&lines).into_iter().map(|l| lines[l].entity));
    }
    let traces = found.into_iter().map(|i| curve::trace(&drawing.entities[i].shape, frame));
    traces.flat_map(|t| t.segments().map(|s| s.2).collect::<Vec<_>>()).take(PIECES_MAX).collect()
}

/// Whether names say that an entity stands in the way, or not; `None` where they leave it open.
fn said(e: &Entity) -> Option<bool> {
    let names = || e.blocks.iter().map(String::as_str).chain([e.layer.as_str()]);
    if names().any(|n| words(n).iter().any(|w| SANITARY.contains(&w.as_str()))) {
        return Some(true);
    }
    let roles: Vec<Role> = names().map(|n| role_by_name(n).0).collect();
    if roles.contains(&Role::Stair) {
        return Some(true);
    }
    roles.iter().any(|r| !matches!(r, Role::Unknown | Role::Furniture)).then_some(false)
}

fn straight(entity: usize, e: &Entity, metres_per_unit: f64) -> Option<Straight> {
    let [a, b] = match &e.shape {
        Shape::Line { a, b } => [*a, *b],
        Shape::Polyline { vertices, closed: false } if vertices.len() == 2 => {
            [vertices[0].at, vertices[1].at]
        }
        _ => return None,
    };
    Some(Straight { entity, a: a * metres_per_unit, b: b * metres_per_unit })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::drawing::{Editable, SourceRef};
    use glam::DVec2;

    /// Pieces found among `count` equal lines on a layer, 0.28 m apart.
    fn pieces(layer: &str, count: usize) -> usize {
        let source = SourceRef { record: 0, handle: None, line: 0, kind: "LINE".into(), layer: layer.into() };
        let line = |i: usize| Entity {
            source: source.clone(),
            layer: layer.into(),
            shape: Shape::Line { a: DVec2::new(0.0, 0.28 * i as f64), b: DVec2::new(1.0, 0.28 * i as f64) },
            editable: Editable::Free,
            blocks: Vec::new(),
        };
        let drawing = Drawing::of((0..count).map(line).collect());
        find(&drawing, &[], &[], 1.0, &Frame::new(1.0, [DVec2::ZERO, DVec2::splat(10.0)])).len()
    }

    #[test]
    fn treads_are_looked_for_among_so_many_lines_and_so_many_pieces_are_kept() {
        assert_eq!(pieces("level 0", 12), 12, "a flight");
        assert_eq!(pieces("level 0", LINES_MAX), LINES_MAX, "a long one");
        assert_eq!(pieces("level 0", LINES_MAX + 1), 0, "too many to look through");
        assert_eq!(pieces("WC", PIECES_MAX + 9), PIECES_MAX);
    }
}

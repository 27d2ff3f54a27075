//! What stands in a room and is no wall: stairs, sanitary objects, crosses over lifts, counters, machines, and the
//! parts of doors. A wall that slides must not run into them.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;

use super::curve;
use super::frame::Frame;
use super::hidden::Hidden;
use super::parallels::Straight;
use super::paving;
use super::reading::Reading;
use crate::sizes::ERROR_GAP_M;
use enfilade_cad::drawing::{Drawing, Entity, Format, Shape};
use enfilade_cad::names::words;
use enfilade_cad::own_layers;
use enfilade_cad::plane::box_of;
use enfilade_cad::roles::Role;
use enfilade_engine::geometry::Segment;

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

/// Most lines among which joints of a floor and crosses are looked for.
const LINES_MAX: usize = 20_000;

/// Most pieces kept.
const PIECES_MAX: usize = 20_000;

/// A closed outline over more floor than this is a room, square metres.
pub const OUTLINE_MAX_M2: f64 = 5.0;

/// A line that reaches farther than this is no part of a thing, metres.
pub const LINE_MAX_M: f64 = 5.0;

/// No door stands where a thing is nearer to its wall than this, metres of a person: somebody stops there to open it, or
/// steps through.
pub const BEFORE_DOOR_M: f64 = 0.6;

/// Shortest arm of a cross over a lift, metres, and how exactly its arms halve each other and are equal.
const CROSS_ARM_MIN_M: f64 = 1.0;

/// The arms of a cross meet at an angle of which the sine is no smaller.
const CROSS_SIN: f64 = 0.17;

/// Where more lines have one middle they are a hatch or a star.
const MIDDLES_MAX: usize = 8;

/// What something that stands in the way is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ObstacleKind {
    /// A stair, a sanitary object, a cross over a lift: it cannot stand elsewhere.
    Fixed,
    /// Something that stands on the floor.
    Standing,
    /// Part of a door or window, by its layer.
    Door,
}

/// Something drawn that is no wall and stands in the way of walls.
#[derive(Clone, Debug, PartialEq)]
pub struct Obstacle {
    /// The record of its entity.
    pub record: usize,
    /// What it is.
    pub kind: ObstacleKind,
    /// Its pieces, drawing frame, micrometres.
    pub pieces: Vec<Segment>,
}

/// Outlines that a building's reader knows of, but for those of walls: fixed.
pub(super) fn known(drawing: &Drawing, frame: &Frame, is_wall: impl Fn(usize) -> bool) -> Vec<Obstacle> {
    let side = |ring: &[DVec2], i: usize| {
        let [a, b] = [ring[i], ring[(i + 1) % ring.len()]].map(|p| frame.um_from_file(p));
        Segment { a, b }
    };
    let things = drawing.things.iter().filter(|(record, ring)| ring.len() > 1 && !is_wall(*record));
    let thing = |(record, ring): &(usize, Vec<DVec2>)| Obstacle {
        record: *record,
        kind: ObstacleKind::Fixed,
        pieces: (0..ring.len()).map(|i| side(ring, i)).collect(),
    };
    things.map(thing).collect()
}

/// What stands in the way, what is fixed first. `walls`: entities that are walls; `metres_per_unit`: of a person.
pub(super) fn find(
    drawing: &Drawing,
    reading: &Reading,
    walls: &[usize],
    metres_per_unit: f64,
    frame: &Frame,
) -> Vec<Obstacle> {
    let hidden = Hidden::new(drawing);
    let is_wall: BTreeSet<usize> = walls.iter().copied().collect();
    let mut found: BTreeSet<usize> = BTreeSet::new();
    let mut lines: Vec<Straight> = Vec::new();
    let mut others: Vec<(usize, ObstacleKind)> = Vec::new();
    for (i, e) in drawing.entities.iter().enumerate() {
        if is_wall.contains(&i) || own_layers::is_own(&e.layer) || hidden.entity(e) {
            continue;
        }
        match said(e, reading.role(i)) {
            Said::Fixed => drop(found.insert(i)),
            Said::Other => {}
            Said::Door => others.push((i, ObstacleKind::Door)),
            Said::Nothing => {
                lines.extend(straight(i, e, metres_per_unit));
                others.push((i, ObstacleKind::Standing));
            }
        }
    }
    // The joints of a floor stand in nobody's way.
    if lines.len() <= LINES_MAX {
        let joints: BTreeSet<usize> =
            paving::find_joints(&lines).into_iter().map(|l| lines[l].entity).collect();
        others.retain(|(i, _)| !joints.contains(i));
    }
    // A building's other elements are told apart by their kinds, not by layers and sizes.
    let is_drawn = drawing.format == Format::Dxf;
    others.retain(|(i, _)| {
        is_drawn && !found.contains(i) && is_small(&drawing.entities[*i].shape, metres_per_unit)
    });
    let shafts = if is_drawn && lines.len() <= LINES_MAX { crosses(&lines) } else { Vec::new() };
    let all = found.into_iter().map(|i| (i, ObstacleKind::Fixed)).chain(others);
    let mut left = PIECES_MAX;
    let mut obstacle = |(i, kind): (usize, ObstacleKind)| {
        let e = &drawing.entities[i];
        let trace = curve::trace(&e.shape, frame);
        let pieces: Vec<Segment> = trace.segments().map(|s| s.2).take(left).collect();
        left -= pieces.len();
        (!pieces.is_empty()).then_some(Obstacle { record: e.source.record, kind, pieces })
    };
    let mut out: Vec<Obstacle> =
        shafts.into_iter().map(|s| shaft(drawing, s, metres_per_unit, frame)).collect();
    out.extend(all.filter_map(&mut obstacle));
    out
}

/// Pairs of lines that halve each other and are equal: crosses over lifts and shafts. The lines' ends, round the
/// shaft, and the entity of the first.
fn crosses(lines: &[Straight]) -> Vec<(usize, [DVec2; 4])> {
    let cell = |p: DVec2| (p / ERROR_GAP_M).floor().as_i64vec2().to_array();
    let mut by_middle: BTreeMap<[i64; 2], Vec<usize>> = BTreeMap::new();
    for (i, l) in lines.iter().enumerate().filter(|(_, l)| l.a.distance(l.b) >= CROSS_ARM_MIN_M) {
        by_middle.entry(cell(l.a.midpoint(l.b))).or_default().push(i);
    }
    let mut out = Vec::new();
    for ([x, y], here) in &by_middle {
        let around = (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| [x + dx, y + dy]));
        let near: Vec<usize> = around.filter_map(|c| by_middle.get(&c)).flatten().copied().collect();
        if near.len() > MIDDLES_MAX {
            continue;
        }
        for (i, j) in here.iter().flat_map(|i| near.iter().map(move |j| (*i, *j))).filter(|(i, j)| i < j) {
            let (p, q) = (&lines[i], &lines[j]);
            let (u, v) = (p.b - p.a, q.b - q.a);
            let sine = u.normalize_or_zero().perp_dot(v.normalize_or_zero()).abs();
            let is_one = p.a.midpoint(p.b).distance(q.a.midpoint(q.b)) <= ERROR_GAP_M;
            if is_one && (u.length() - v.length()).abs() <= ERROR_GAP_M && sine >= CROSS_SIN {
                out.push((p.entity, [p.a, q.a, p.b, q.b]));
            }
        }
    }
    out
}

/// The floor below a cross.
fn shaft(
    drawing: &Drawing,
    (entity, corners): (usize, [DVec2; 4]),
    metres_per_unit: f64,
    frame: &Frame,
) -> Obstacle {
    let at = |i: usize| frame.um_from_file(corners[i % 4] / metres_per_unit);
    Obstacle {
        record: drawing.entities[entity].source.record,
        kind: ObstacleKind::Fixed,
        pieces: (0..4).map(|i| Segment { a: at(i), b: at(i + 1) }).collect(),
    }
}

/// Whether a drawn thing is no larger than what stands in a room.
fn is_small(shape: &Shape, metres_per_unit: f64) -> bool {
    if let Shape::Circle { radius, .. } | Shape::Arc { radius, .. } = shape {
        return std::f64::consts::PI * (radius * metres_per_unit).powi(2) <= OUTLINE_MAX_M2;
    }
    let points = enfilade_cad::curve::control_points(shape);
    let Some([lo, hi]) = box_of(points.iter().copied()) else { return false };
    let size = (hi - lo) * metres_per_unit;
    let is_closed = matches!(shape, Shape::Polyline { closed: true, .. })
        || points.len() > 3 && points.first() == points.last();
    if is_closed { size.x * size.y <= OUTLINE_MAX_M2 } else { size.length() <= LINE_MAX_M }
}

/// What names say of an entity.
enum Said {
    Fixed,
    Door,
    /// It is something that does not stand on the floor, or a wall.
    Other,
    Nothing,
}

fn said(e: &Entity, role: Role) -> Said {
    let mut names = e.blocks.iter().map(String::as_str).chain([e.layer.as_str()]);
    if names.any(|n| words(n).iter().any(|w| SANITARY.contains(&w.as_str()))) {
        return Said::Fixed;
    }
    match role {
        Role::Stair => Said::Fixed,
        Role::Door | Role::Window => Said::Door,
        Role::Furniture | Role::Unknown => Said::Nothing,
        _ => Said::Other,
    }
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
    use enfilade_cad::drawing::{Editable, SourceRef};

    /// Fixed pieces found among `count` lines on a layer.
    fn pieces(layer: &str, count: usize) -> usize {
        let source = SourceRef { record: 0, handle: None, line: 0, kind: "LINE".into(), layer: layer.into() };
        let line = |i: usize| Entity {
            source: source.clone(),
            layer: layer.into(),
            shape: Shape::Line { a: DVec2::new(0.0, 0.28 * i as f64), b: DVec2::new(1.0, 0.28 * i as f64) },
            editable: Editable::Free,
            blocks: Vec::new(),
            origin: Default::default(),
        };
        let drawing = Drawing::of((0..count).map(line).collect());
        let found = find(
            &drawing,
            &Reading::by_names(&drawing),
            &[],
            1.0,
            &Frame::new(1.0, [DVec2::ZERO, DVec2::splat(10.0)]),
        );
        found.iter().filter(|o| o.kind == ObstacleKind::Fixed).map(|o| o.pieces.len()).sum()
    }

    /// Slabs of a metre: their joints are no thing that a wall must not come near.
    #[test]
    fn the_joints_of_a_floor_stand_in_nobodys_way() {
        let entity = |a: [f64; 2], b: [f64; 2]| Entity {
            source: SourceRef { record: 0, handle: None, line: 0, kind: "LINE".into(), layer: "0".into() },
            layer: "0".into(),
            shape: Shape::Line { a: DVec2::from(a), b: DVec2::from(b) },
            editable: Editable::Free,
            blocks: Vec::new(),
            origin: Default::default(),
        };
        let mut lines = Vec::new();
        for (x, y) in (0..6).flat_map(|x| (0..6).map(move |y| (f64::from(x), f64::from(y)))) {
            lines.push(entity([x, y], [x + 1.0, y]));
            lines.push(entity([x, y], [x, y + 1.0]));
        }
        let bench = entity([20.0, 0.0], [22.0, 0.0]);
        let count = |lines: Vec<Entity>| {
            let frame = Frame::new(1.0, [DVec2::ZERO, DVec2::splat(10.0)]);
            let drawing = Drawing::of(lines);
            find(&drawing, &Reading::by_names(&drawing), &[], 1.0, &frame).len()
        };
        assert_eq!(count(lines.clone()), 0);
        lines.push(bench);
        assert_eq!(count(lines), 1);
    }

    #[test]
    fn so_many_pieces_are_kept() {
        assert_eq!(pieces("WC", 12), 12);
        assert_eq!(pieces("WC", PIECES_MAX + 9), PIECES_MAX);
    }
}

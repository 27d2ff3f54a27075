//! Furniture that stands at walls: it follows the wall that it stands at.

use std::collections::BTreeSet;

use glam::DVec2;

use super::Plan;
use super::axes::{AxisGraph, FaceRef};
use super::body_sides::body_sides;
use super::fittings::{Fitting, FittingKind};
use super::graph::Handle;
use super::kinds::{Thing, furniture};
use super::structure::{face_handles, handle_at};
use enfilade_cad::drawing::{Drawing, Editable, Shape, SourceRef, Vertex};

/// What stands no farther from a wall stands at it, metres of a person: a skirting fits behind it.
pub const AT_WALL_M: f64 = 0.05;

/// A thing stands at a wall with at least this share of its side.
const SIDE_SHARE: f64 = 0.5;

/// The furniture at walls, each with the sides of walls that it stands at.
pub fn furniture_at_walls(plan: &Plan, drawing: &Drawing, axes: &AxisGraph) -> Vec<Fitting> {
    let sides = body_sides(plan, axes);
    // A line by itself has no body: something may stand on either side of it.
    let single = axes.edges.iter().filter(|e| e.thickness_m == 0.0 && e.bulge == 0.0).flat_map(|e| &e.left);
    let both = single.flat_map(|f| [(*f, true), (*f, false)]);
    let all: BTreeSet<(FaceRef, bool)> = sides.iter().map(|(f, left)| (*f, *left)).chain(both).collect();
    let walls: Vec<Face> = all.into_iter().filter_map(|(f, left)| Face::new(plan, f, left)).collect();
    let of = |(thing, source, editable): (Thing, SourceRef, Editable)| {
        let place = |p: DVec2| plan.frame.plan_from_file(p) / plan.human_scale;
        let corners = corners_of(thing.extent.map(|p| plan.frame.file_from_um(p)));
        let is_at = |w: &&Face| w.has_at_it(corners.map(place));
        let faces: Vec<[Handle; 2]> = walls.iter().filter(is_at).map(|w| w.handles).collect();
        let vertices = corners.map(|at| Vertex { at, bulge: 0.0 }).to_vec();
        (!faces.is_empty()).then(|| Fitting {
            source,
            editable,
            shape: Shape::Polyline { vertices, closed: true },
            jambs: Default::default(),
            host: None,
            kind: FittingKind::Furniture(faces),
        })
    };
    furniture(drawing, plan).into_iter().filter_map(of).collect()
}

/// The corners of a box, anticlockwise.
fn corners_of([lo, hi]: [DVec2; 2]) -> [DVec2; 4] {
    [lo, DVec2::new(hi.x, lo.y), hi, DVec2::new(lo.x, hi.y)]
}

/// A drawn side of a wall, metres of a person.
struct Face {
    handles: [Handle; 2],
    from: DVec2,
    along: DVec2,
    length: f64,
    /// Unit normal away from the body.
    out: DVec2,
}

impl Face {
    fn new(plan: &Plan, face: FaceRef, is_left: bool) -> Option<Self> {
        let handles: [Handle; 2] = face_handles(plan, face).try_into().ok()?;
        let [from, to] = handles.map(|h| handle_at(plan, h));
        let along = (to - from).try_normalize()?;
        let out = if is_left { -along.perp() } else { along.perp() };
        Some(Self { handles, from, along, length: from.distance(to), out })
    }

    /// Whether something with such corners stands at it.
    fn has_at_it(&self, corners: [DVec2; 4]) -> bool {
        let corners = corners.map(|p| p - self.from);
        let range = |d: DVec2| {
            let places = corners.map(|p| p.dot(d));
            places.into_iter().fold([f64::MAX, f64::MIN], |[l, h], v| [l.min(v), h.max(v)])
        };
        let ([near, far], [first, last]) = (range(self.out), range(self.along));
        let common = last.min(self.length) - first.max(0.0);
        near.abs() <= AT_WALL_M && far > AT_WALL_M && common >= SIDE_SHARE * (last - first)
    }
}

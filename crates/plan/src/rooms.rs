//! Drawings of rooms instead of walls (surveys, scans): one closed outline a room, and where two rooms
//! open into each other their outlines touch.

use std::collections::BTreeSet;

use glam::DVec2;

use super::Plan;
use super::axes::{AxisGraph, FaceRef, Jamb, Opening, OpeningKind, Shown};
use crate::sizes::FINISH_MAX_M;
use enfilade_cad::curve::control_points;
use enfilade_cad::drawing::Shape;
use enfilade_cad::plane::ring_area;
use enfilade_report::counted;

/// Share of all wall pieces, by length, that outlines of rooms have in a drawing of rooms.
const RINGS_SHARE: f64 = 0.8;

/// Fewest outlines of a drawing of rooms.
const ROOMS_MIN: usize = 3;

/// Outlines this near to each other, against the thinnest usual wall between two rooms, touch.
const TOUCHING_SHARE: f64 = 0.55;

/// Widths of what is open where outlines touch.
const WIDTH_M: [f64; 2] = [0.5, 3.0];

/// Sine of the angle up to which two pieces are parallel.
const PARALLEL_SIN: f64 = 0.03;

/// Share of the thickness found most below which a thickness is not a usual one.
const USUAL_SHARE: f64 = 0.2;

/// Most pieces looked at pairwise.
const PIECES_MAX: usize = 4_000;

struct Piece {
    face: FaceRef,
    a: DVec2,
    b: DVec2,
    /// Whether the room lies to the left of it.
    is_left: bool,
}

impl Piece {
    /// The unit normal into the room.
    fn inward(&self) -> DVec2 {
        let left = (self.b - self.a).normalize_or_zero().perp();
        if self.is_left { left } else { -left }
    }
}

/// Adds the openings where room outlines touch. Nothing is added where rooms share their lines, because
/// then all of them touch and nothing tells a door from a wall.
pub fn open_touching(plan: &Plan, axes: &mut AxisGraph) {
    let pieces = pieces(plan);
    let Some(thickness) = usual_thickness(axes) else { return };
    if pieces.is_empty() || pieces.len() > PIECES_MAX {
        return;
    }
    let rings: BTreeSet<u32> = pieces.iter().map(|p| p.face.0).collect();
    // What looks like a window between two outlines is the outlines' own jambs; a symbol of a door or window is not.
    let is_jambs =
        |o: &Opening| o.marks.is_empty() && o.faces.iter().chain(&o.through).any(|f| rings.contains(&f.0));
    axes.openings.retain(|o| !is_jambs(o));
    let meant: BTreeSet<FaceRef> = axes.openings.iter().flat_map(|o| o.faces.iter().copied()).collect();
    axes.see_through.retain(|f| !rings.contains(&f.0) || meant.contains(f));
    let reach = (TOUCHING_SHARE * thickness).min(FINISH_MAX_M);
    let mut found: Vec<Opening> = Vec::new();
    for (i, p) in pieces.iter().enumerate() {
        for q in pieces[i + 1..].iter().filter(|q| q.face.0 != p.face.0) {
            found.extend(touching(p, q, reach));
        }
    }
    let taken: Vec<DVec2> = axes.openings.iter().map(|o| o.centre).collect();
    found.retain(|o| taken.iter().all(|c| c.distance(o.centre) > WIDTH_M[0]));
    if !found.is_empty() {
        axes.statements
            .push(format!("{} where outlines of rooms touch", counted(found.len() as u64, "opening")));
    }
    axes.openings.extend(found);
}

/// The thinnest wall of which there is a good deal.
fn usual_thickness(axes: &AxisGraph) -> Option<f64> {
    let most = axes.thicknesses.iter().map(|t| t.1).fold(0.0, f64::max);
    axes.thicknesses.iter().find(|t| t.1 >= USUAL_SHARE * most).map(|t| t.0)
}

fn pieces(plan: &Plan) -> Vec<Piece> {
    let rings: Vec<usize> = (0..plan.walls.len())
        .filter(|w| {
            let wall = &plan.walls[*w];
            wall.trace.is_closed && !wall.is_solid && matches!(wall.shape, Shape::Polyline { .. })
        })
        .collect();
    let length = |w: usize| -> f64 {
        let pieces = plan.walls[w].trace.segments();
        pieces.map(|(_, _, s)| ((s.b[0] - s.a[0]) as f64).hypot((s.b[1] - s.a[1]) as f64)).sum()
    };
    let all: f64 = (0..plan.walls.len()).map(length).sum();
    if rings.len() < ROOMS_MIN || rings.iter().map(|w| length(*w)).sum::<f64>() < RINGS_SHARE * all {
        return Vec::new();
    }
    let mut out = Vec::new();
    for w in rings {
        let Shape::Polyline { vertices, .. } = &plan.walls[w].shape else { continue };
        let points = control_points(&plan.walls[w].shape);
        let is_left = ring_area(&points) > 0.0;
        for (k, v) in vertices.iter().enumerate().filter(|(_, v)| v.bulge == 0.0) {
            let next = points[(k + 1) % points.len()];
            let [a, b] = [v.at, next].map(|p| plan.frame.plan_from_file(p) / plan.human_scale);
            if a.distance(b) >= WIDTH_M[0] {
                out.push(Piece { face: (w as u32, k as u32), a, b, is_left });
            }
        }
    }
    out
}

fn touching(p: &Piece, q: &Piece, reach: f64) -> Option<Opening> {
    let along = (p.b - p.a).normalize();
    let (s0, s1) = (along.dot(q.a - p.a), along.dot(q.b - p.a));
    let (from, to) = (s0.min(s1).max(0.0), s0.max(s1).min(p.a.distance(p.b)));
    let (u, v) = (along.perp_dot(q.a - p.a), along.perp_dot(q.b - p.a));
    // One inside the other are not two rooms: the finish of a wall in its outline.
    let is_outside = p.inward().dot(q.inward()) < 0.0;
    let is_near =
        is_outside && u.abs().max(v.abs()) <= reach && (u - v).abs() <= PARALLEL_SIN * (s1 - s0).abs();
    if !is_near || !(WIDTH_M[0]..=WIDTH_M[1]).contains(&(to - from)) {
        return None;
    }
    let across = along.perp() * f64::midpoint(u, v) / 2.0;
    let jamb = |s: f64| Jamb { at: p.a + along * s + across, node: None, edge: None };
    Some(Opening {
        kind: OpeningKind::Passage,
        centre: p.a + along * f64::midpoint(from, to) + across,
        width_m: to - from,
        thickness_m: f64::midpoint(u, v).abs(),
        jambs: [jamb(from), jamb(to)],
        shown: Shown::Rooms,
        marks: Vec::new(),
        faces: Vec::new(),
        through: vec![p.face, q.face],
    })
}

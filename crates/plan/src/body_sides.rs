//! On which side of its drawn pieces the body of a wall lies, however the wall is drawn: as two faces, as a box, or in one
//! outline with all others.

use std::collections::BTreeMap;

use glam::DVec2;

use super::axes::{AxisGraph, FaceRef};
use super::structure::{face_handles, handle_at};
use super::{Plan, Wall};
use enfilade_cad::plane::ring_area;

/// Whether the body lies to the left of each piece, seen from its first control point to its second; pieces of which
/// nobody can tell are left out: single lines, arcs, what is drawn inside a wall.
pub fn body_sides(plan: &Plan, axes: &AxisGraph) -> BTreeMap<FaceRef, bool> {
    let mut out = BTreeMap::new();
    let mut add = |face: FaceRef, inside: DVec2| {
        let ends: Vec<DVec2> = face_handles(plan, face).into_iter().map(|h| handle_at(plan, h)).collect();
        let [a, b] = ends[..] else { return };
        let far = (b - a).normalize_or_zero().perp_dot(inside - a);
        if far != 0.0 {
            out.entry(face).or_insert(far > 0.0);
        }
    };
    // A line drawn as wide as its wall is the axis, left and right side in one: the body lies on both sides of it.
    for edge in axes.edges.iter().filter(|e| e.thickness_m > 0.0 && e.bulge == 0.0 && e.left != e.right) {
        let [a, b] = axes.ends(edge);
        edge.left.iter().chain(&edge.right).for_each(|f| add(*f, a.midpoint(b)));
        for (node, inside) in edge.nodes.iter().zip([b, a]) {
            axes.nodes[*node as usize].faces.iter().for_each(|f| add(*f, inside));
        }
    }
    // An outline says it itself.
    for (w, wall) in (0u32..).zip(&plan.walls).filter(|(_, w)| w.is_solid && w.trace.is_closed) {
        let is_left = is_anticlockwise(wall);
        let parts = wall.trace.control.iter().flatten();
        out.extend(parts.map(|part| ((w, *part), is_left)));
    }
    out
}

fn is_anticlockwise(wall: &Wall) -> bool {
    let ring: Vec<DVec2> = wall.trace.points.iter().map(|p| DVec2::new(p[0] as f64, p[1] as f64)).collect();
    ring_area(&ring) > 0.0
}

//! A layout as it was written and read again, corner by corner.

use std::collections::BTreeMap;

use crate::moves::Layout;
use crate::plan::Plan;
use crate::plan::curve::control_points;
use crate::plan::drawing::Shape;
use crate::plan::geometry::PointUm;

/// Where a layout means every wall to stand.
pub(super) fn meant_shapes<'a>(plan: &'a Plan, layout: &'a Layout) -> BTreeMap<u32, &'a Shape> {
    let mut out: BTreeMap<u32, &Shape> =
        plan.walls.iter().enumerate().map(|(w, wall)| (w as u32, &wall.shape)).collect();
    out.extend(layout.walls.iter().map(|w| (w.wall, &w.shape)));
    out
}

/// Corners nearer than this are the same one, micrometres.
const SAME_CORNER_UM: f64 = 1_000.0;

/// A shape as written where its corners are those that were meant, one by one, else the shape that was meant:
/// the cut through a turned mesh may start at another corner, or have one more on a straight face.
pub(super) fn as_cornered<'a>(plan: &Plan, written: &'a Shape, meant: &'a Shape) -> &'a Shape {
    let corners = |s: &Shape| -> Vec<PointUm> {
        control_points(s).into_iter().map(|p| plan.frame.um_from_file(p)).collect()
    };
    let (a, b) = (corners(written), corners(meant));
    let near =
        |(p, q): (&PointUm, &PointUm)| ((p[0] - q[0]) as f64).hypot((p[1] - q[1]) as f64) <= SAME_CORNER_UM;
    if a.len() == b.len() && a.iter().zip(&b).all(near) { written } else { meant }
}

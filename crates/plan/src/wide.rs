//! Polylines drawn as wide as a wall is thick: the line is the axis, its width the wall.
//!
//! What moves and is written is the axis, as with walls of one line. Sight stops at the sides, and nobody stands on the
//! ground between them.

use glam::DVec2;

use super::Wall;
use super::frame::Frame;
use crate::sizes::THICKNESS_MAX_M;
use enfilade_cad::drawing::{Drawing, Entity};
use enfilade_engine::geometry::{PointUm, Segment, UM_PER_M};
use enfilade_report::{Place, Report};

/// Widths that are a wall's thickness, metres of a person: below them a line is wide so that it is seen in print, beyond
/// them it is a road or a border.
pub const WIDTH_M: [f64; 2] = [0.08, THICKNESS_MAX_M];

/// Gives the walls that are drawn as wide polylines their width. `entities` are those of the walls, in their order.
pub(super) fn mark(
    walls: &mut [Wall],
    entities: &[&Entity],
    drawing: &Drawing,
    (frame, human_scale): (&Frame, f64),
    report: &mut Report,
) {
    let [lo, hi] = WIDTH_M;
    let mut found: Vec<f64> = Vec::new();
    for (wall, entity) in walls.iter_mut().zip(entities) {
        let drawn = drawing.widths.get(&entity.source.record).filter(|_| entity.blocks.is_empty());
        let Some(width_m) = drawn.map(|w| w * frame.metres_per_unit / human_scale) else { continue };
        // Of a solid the pen draws the outline.
        if (lo..=hi).contains(&width_m) && !wall.is_solid {
            wall.width_um = (width_m * human_scale * UM_PER_M).round() as i64;
            found.push(width_m);
        }
    }
    if let Some([thinnest, thickest]) = found.iter().fold(None, |b: Option<[f64; 2]>, w| {
        let [lo, hi] = b.unwrap_or([*w, *w]);
        Some([lo.min(*w), hi.max(*w)])
    }) {
        let wide = match thickest - thinnest > 0.005 {
            true => format!("{thinnest:.2} to {thickest:.2}"),
            false => format!("{thinnest:.2}"),
        };
        let text = match found.len() {
            1 => format!(
                "1 wall is a polyline drawn {wide} m wide: it stops sight at its sides and covers the ground between them"
            ),
            n => format!(
                "{n} walls are polylines drawn {wide} m wide: they stop sight at their sides and cover the ground between \
                 them"
            ),
        };
        report.info("wide-polylines", Place::file(&drawing.file), text);
    }
}

impl Wall {
    /// The ground that a piece of it covers, as a ring in the drawing frame, micrometres; `None` where it has no width
    /// of its own.
    pub fn ground(&self, s: Segment) -> Option<[PointUm; 4]> {
        let along = DVec2::new((s.b[0] - s.a[0]) as f64, (s.b[1] - s.a[1]) as f64);
        let beside =
            along.try_normalize().filter(|_| self.width_um > 0)?.perp() * (self.width_um as f64 / 2.0);
        let d = [beside.x.round() as i64, beside.y.round() as i64];
        let at = |p: PointUm, side: i64| [p[0] + side * d[0], p[1] + side * d[1]];
        Some([at(s.a, 1), at(s.b, 1), at(s.b, -1), at(s.a, -1)])
    }

    /// A piece of it with what stops sight beside it: the sides of a wide one, and its ends.
    pub fn with_sides(&self, s: Segment) -> impl Iterator<Item = Segment> + use<> {
        let ring = self.ground(s);
        let sides =
            ring.into_iter().flat_map(|r| (0..4).map(move |k| Segment { a: r[k], b: r[(k + 1) % 4] }));
        std::iter::once(s).chain(sides)
    }
}

//! Soft penalties on a layout (spec section 5; paper: Penalty Metrics): one file, one penalty.
//!
//! Each penalty is made once from the initial layout and then measures any number of layouts of the
//! same walls. The list is open; all work on [`Layout`] alone. Sums run in a fixed order, so the same
//! layout gives the same bits on any thread.
//!
//! ```
//! use enfilade_penalties::{Layout, WallLength, WallPiece};
//! use glam::DVec2;
//!
//! let wall = |end_m: f64| {
//!     let [a, b] = [DVec2::ZERO, DVec2::new(end_m, 0.0)];
//!     WallPiece { a, b, nodes: [0, 1], is_moving: true, solid: None, bar: None, body: None, half_m: 0.0 }
//! };
//! let drawn = [wall(4.0)];
//! let penalty = WallLength::new(&Layout { pieces: &drawn });
//! assert_eq!(penalty.measure_m(&Layout { pieces: &[wall(5.5)] }), 1.5);
//! ```

pub mod alignment;
pub mod clearance;
pub mod covered;
pub mod disconnection;
pub mod overlap;
pub mod pairs;
pub mod passage;
pub mod room_area;
pub mod rounded;
pub mod wall_length;

use glam::DVec2;

pub use alignment::Alignment;
pub use clearance::Clearance;
pub use disconnection::disconnection;
pub use overlap::Overlap;
pub use passage::Passage;
pub use room_area::RoomArea;
pub use wall_length::WallLength;

/// Walls closer than this count as touching, and a joint this near the straight line as straight:
/// ends are rounded to whole micrometres, so an end drawn on an oblique wall may lie off it by up to
/// √2 µm after rounding.
pub const TOUCH_M: f64 = 2e-6;

/// One edge of the architectural graph: the axis of a straight wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallPiece {
    /// One end, metres, plan frame.
    pub a: DVec2,
    /// The other end.
    pub b: DVec2,
    /// Node at `a` and node at `b`; pieces that meet share the number.
    pub nodes: [u32; 2],
    /// Whether a parameter moves at least one of its nodes.
    pub is_moving: bool,
    /// Number of the solid (column, wall drawn as an outline) whose outline this is a piece of; the
    /// pieces of a solid follow each other round the ring. `None`: a wall by itself.
    pub solid: Option<u32>,
    /// Number of the thick wall of which this is a face: what is drawn with two faces is one wall.
    pub bar: Option<u32>,
    /// On which side of the way from `a` to `b` the body of its wall lies; `None` where none is known: a single line.
    pub body: Option<BodySide>,
    /// How far the wall reaches to either side of it, metres: half the width of a line drawn as wide as a wall, else 0.
    pub half_m: f64,
}

/// A side of a piece, seen from its first end to its second.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BodySide {
    /// To the left.
    Left,
    /// To the right.
    Right,
}

impl WallPiece {
    /// Unit normal into the body of its wall, where that is known.
    pub fn into_body(&self) -> Option<DVec2> {
        let left = (self.b - self.a).try_normalize()?.perp();
        self.body.map(|side| if side == BodySide::Left { left } else { -left })
    }

    /// Length, metres, ≥ 0.
    pub fn length_m(&self) -> f64 {
        self.a.distance(self.b)
    }

    /// Both ends.
    pub fn ends(&self) -> [DVec2; 2] {
        [self.a, self.b]
    }
}

/// All walls of one layout; every layout of a study lists the same pieces in the same order.
#[derive(Clone, Copy, Debug)]
pub struct Layout<'a> {
    /// The pieces.
    pub pieces: &'a [WallPiece],
}

/// Where two straight walls stand to each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Meeting {
    /// No common point; the distance in metres, > [`TOUCH_M`].
    Apart(f64),
    /// They touch: nearer than [`TOUCH_M`], neither passes through the other.
    Touch,
    /// Each passes through the other, at least [`TOUCH_M`] beyond the crossing. `through_m`: how far
    /// the nearest of the four ends lies from the crossing, > 0.
    Cross {
        /// Metres.
        through_m: f64,
    },
    /// On one line, with this common length in metres, > [`TOUCH_M`].
    Overlap {
        /// Metres.
        common_m: f64,
    },
}

/// How two segments meet. Symmetric up to rounding; a segment may be a point.
pub fn meeting(p: [DVec2; 2], q: [DVec2; 2]) -> Meeting {
    if let Some(common_m) = common_length_m(p, q) {
        return Meeting::Overlap { common_m };
    }
    if let Some(through_m) = through_m(p, q) {
        return if through_m > TOUCH_M { Meeting::Cross { through_m } } else { Meeting::Touch };
    }
    let gap_m = distance_to_m(q, p[0])
        .min(distance_to_m(q, p[1]))
        .min(distance_to_m(p, q[0]))
        .min(distance_to_m(p, q[1]));
    if gap_m > TOUCH_M { Meeting::Apart(gap_m) } else { Meeting::Touch }
}

/// Whether a point lies inside a ring (even-odd); on the outline either.
fn is_inside(ring: &[DVec2], p: DVec2) -> bool {
    let edges = ring.iter().zip(ring.iter().cycle().skip(1));
    let crossed = edges.filter(|&(a, b)| {
        let is_between = (a.y <= p.y) != (b.y <= p.y);
        is_between && ((*b - *a).perp_dot(p - *a) > 0.0) == (b.y > a.y)
    });
    crossed.count() % 2 == 1
}

/// Whether a ring turns one way at every corner, straight corners included.
fn is_convex(ring: &[DVec2]) -> bool {
    let at = |i: usize| ring[i % ring.len()];
    let bends = (0..ring.len()).map(|i| {
        let (from, to) = (at(i + 1) - at(i), at(i + 2) - at(i + 1));
        from.perp_dot(to) / from.length().max(to.length()).max(TOUCH_M)
    });
    let (least, most) = bends.fold((0.0f64, 0.0f64), |(lo, hi), b| (lo.min(b), hi.max(b)));
    least > -TOUCH_M || most < TOUCH_M
}

/// Distance from a point to a segment, metres.
fn distance_to_m([a, b]: [DVec2; 2], p: DVec2) -> f64 {
    let along = b - a;
    let square = along.length_squared();
    let t = if square > 0.0 { ((p - a).dot(along) / square).clamp(0.0, 1.0) } else { 0.0 };
    p.distance(a + along * t)
}

/// Common length of two segments on one line, if longer than [`TOUCH_M`].
fn common_length_m(p: [DVec2; 2], q: [DVec2; 2]) -> Option<f64> {
    let (long, short) =
        if p[0].distance_squared(p[1]) >= q[0].distance_squared(q[1]) { (p, q) } else { (q, p) };
    let axis = (long[1] - long[0]).try_normalize()?;
    let off_line = |x: DVec2| axis.perp_dot(x - long[0]).abs();
    if off_line(short[0]) > TOUCH_M || off_line(short[1]) > TOUCH_M {
        return None;
    }
    let (s, t) = (axis.dot(short[0] - long[0]), axis.dot(short[1] - long[0]));
    let common_m = s.max(t).min(axis.dot(long[1] - long[0])) - s.min(t).max(0.0);
    (common_m > TOUCH_M).then_some(common_m)
}

/// For segments that properly cross, the distance from the crossing to the nearest of the four ends.
fn through_m(p: [DVec2; 2], q: [DVec2; 2]) -> Option<f64> {
    let (u, v) = (p[1] - p[0], q[1] - q[0]);
    let turn = u.perp_dot(v);
    if turn == 0.0 {
        return None;
    }
    let between = q[0] - p[0];
    let (s, t) = (between.perp_dot(v) / turn, between.perp_dot(u) / turn);
    if !((0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t)) {
        return None;
    }
    Some((s.min(1.0 - s) * u.length()).min(t.min(1.0 - t) * v.length()))
}

#[cfg(test)]
mod tests;

//! Exact area common to two walls, each widened by a disc (`w ⊕ D_r`).
//!
//! A straight wall or a convex outline so widened is convex. Between two abscissae where neither has a
//! joint, its upper and lower bound are one arc or one straight line each, so the common area
//! `∫ max(0, min(upper) − max(lower))` has a closed form. Unlike tracing the boundary, this knows no
//! degenerate case: bounds that touch or coincide differ by nothing, so it does not matter which of
//! them is taken. Outlines that are not convex are left to `cavalier_contours`, which clips native arcs.

use cavalier_contours::polyline::{BooleanOp, PlineSource, PlineSourceMut, Polyline};
use glam::DVec2;

/// Area of `(p ⊕ D_r) ∩ (q ⊕ D_r)` for the convex hulls of two sets of points, m², ≥ 0. One point is a
/// disc, two are a capsule. Error below 1e-11 m² for walls up to a kilometre, 0 for no points.
pub fn hull_overlap_m2(p: &[DVec2], q: &[DVec2], radius_m: f64) -> f64 {
    let Some(&origin) = p.first() else { return 0.0 };
    let (first, second) = (Rounded::new(p, origin, radius_m), Rounded::new(q, origin, radius_m));
    let (mut low, high) = (first.low.max(second.low), first.high.min(second.high));
    let mut walks = [&first.upper, &first.lower, &second.upper, &second.lower]
        .map(|chain| Walk::new(chain.pieces(), low));
    let mut area_m2 = 0.0;
    while low < high {
        let next = walks.iter().map(Walk::until).fold(high, f64::min);
        if next > low {
            area_m2 += strip_m2(walks.each_ref().map(Walk::bound), low, next);
        }
        low = next;
        walks.iter_mut().for_each(|w| w.pass(low));
    }
    area_m2
}

/// The same for two rings that need not be convex, which stand apart (the library makes nothing of
/// coinciding outlines).
pub fn ring_overlap_m2(p: &[DVec2], q: &[DVec2], radius_m: f64) -> f64 {
    let Some(&origin) = p.first() else { return 0.0 };
    let (p, q) = (widened(p, origin, radius_m), widened(q, origin, radius_m));
    let mut area = 0.0;
    for (p_sign, p) in &p {
        for (q_sign, q) in &q {
            let common = p.boolean(q, BooleanOp::And);
            let within: f64 = common.pos_plines.iter().map(|c| c.pline.area().abs()).sum();
            let without: f64 = common.neg_plines.iter().map(|c| c.pline.area().abs()).sum();
            area += p_sign * q_sign * (within - without);
        }
    }
    (area / (ENLARGED * ENLARGED)).max(0.0)
}

/// The library takes positions within 1e-5 for equal; so it gets millimetres.
const ENLARGED: f64 = 1000.0;

/// Outline (+1) and holes (−1) of a widened ring, millimetres.
fn widened(ring: &[DVec2], origin: DVec2, radius_m: f64) -> Vec<(f64, Polyline<f64>)> {
    let mut line = Polyline::new_closed();
    for &p in ring {
        let p = (p - origin) * ENLARGED;
        line.add(p.x, p.y, 0.0);
    }
    if line.area() < 0.0 {
        line.invert_direction_mut();
    }
    let parts = line.parallel_offset(-radius_m * ENLARGED);
    parts.into_iter().map(|part| (part.area().signum(), part)).collect()
}

/// A convex hull widened by a disc, as functions of x.
struct Rounded {
    low: f64,
    high: f64,
    upper: Chain,
    lower: Chain,
}

/// The pieces of a bound from left to right; the last never ends.
enum Chain {
    /// Of a capsule: an arc, a line, an arc.
    Three([Piece; 3]),
    Many(Vec<Piece>),
}

/// One piece of a bound, up to an abscissa.
#[derive(Clone, Copy)]
struct Piece {
    until: f64,
    bound: Bound,
}

#[derive(Clone, Copy)]
enum Bound {
    /// Half of a circle: `sign` +1 the upper, −1 the lower.
    Arc { centre: DVec2, r: f64, sign: f64 },
    /// A straight line through a point; `d` is its unit direction.
    Line { through: DVec2, d: DVec2 },
}

impl Rounded {
    fn new(points: &[DVec2], origin: DVec2, r: f64) -> Self {
        if let [a, b] = *points {
            let (a, b) = (a - origin, b - origin);
            let (a, b) = if (a.x, a.y) <= (b.x, b.y) { (a, b) } else { (b, a) };
            let [upper, lower] = [1.0, -1.0].map(|sign| {
                let [arc, line] = edge_pieces(a, b, r, sign);
                Chain::Three([arc, line, last_piece(b, r, sign)])
            });
            return Self { low: a.x - r, high: b.x + r, upper, lower };
        }
        let mut sorted: Vec<DVec2> = points.iter().map(|&p| p - origin).collect();
        sorted.sort_by(|p, q| p.x.total_cmp(&q.x).then(p.y.total_cmp(&q.y)));
        let (low, high) = match (sorted.first(), sorted.last()) {
            (Some(first), Some(last)) => (first.x - r, last.x + r),
            _ => (f64::INFINITY, f64::NEG_INFINITY),
        };
        let [upper, lower] = [1.0, -1.0].map(|sign| {
            let corners = hull_chain(&sorted, sign);
            let mut pieces = Vec::with_capacity(2 * corners.len());
            pieces.extend(corners.windows(2).flat_map(|edge| edge_pieces(edge[0], edge[1], r, sign)));
            pieces.extend(corners.last().map(|&end| last_piece(end, r, sign)));
            Chain::Many(pieces)
        });
        Self { low, high, upper, lower }
    }
}

impl Chain {
    fn pieces(&self) -> &[Piece] {
        match self {
            Self::Three(pieces) => pieces,
            Self::Many(pieces) => pieces,
        }
    }
}

/// Upper (`sign` +1) or lower (−1) side of the convex hull, from left to right.
fn hull_chain(sorted: &[DVec2], sign: f64) -> Vec<DVec2> {
    let mut chain: Vec<DVec2> = Vec::with_capacity(sorted.len());
    for &p in sorted {
        while let [.., a, b] = chain[..]
            && (b - a).perp_dot(p - b) * sign >= 0.0
        {
            chain.pop();
        }
        chain.push(p);
    }
    chain
}

/// The arc about the left end of an edge and the line along the edge.
fn edge_pieces(a: DVec2, b: DVec2, r: f64, sign: f64) -> [Piece; 2] {
    let d = (b - a).try_normalize().unwrap_or(DVec2::X);
    let side = d.perp() * (sign * r);
    [
        Piece { until: a.x + side.x, bound: Bound::Arc { centre: a, r, sign } },
        Piece { until: b.x + side.x, bound: Bound::Line { through: a + side, d } },
    ]
}

fn last_piece(centre: DVec2, r: f64, sign: f64) -> Piece {
    Piece { until: f64::INFINITY, bound: Bound::Arc { centre, r, sign } }
}

/// The piece of a bound at the abscissa reached.
struct Walk<'a> {
    pieces: &'a [Piece],
}

impl<'a> Walk<'a> {
    fn new(pieces: &'a [Piece], from: f64) -> Self {
        let mut walk = Self { pieces };
        walk.pass(from);
        walk
    }

    fn until(&self) -> f64 {
        self.pieces.first().map_or(f64::INFINITY, |p| p.until)
    }

    fn bound(&self) -> Bound {
        // The last piece never ends, so there always is one.
        self.pieces.first().map_or(Bound::Line { through: DVec2::ZERO, d: DVec2::X }, |p| p.bound)
    }

    fn pass(&mut self, x: f64) {
        while let [piece, rest @ ..] = self.pieces
            && piece.until <= x
            && !rest.is_empty()
        {
            self.pieces = rest;
        }
    }
}

/// Common area over `x0..x1`, where each bound is one curve: `[upper, lower, upper, lower]`.
fn strip_m2([first_upper, first_lower, second_upper, second_lower]: [Bound; 4], x0: f64, x1: f64) -> f64 {
    let mut breaks = Breaks::new(x0, x1);
    first_upper.crossings(&second_upper, &mut breaks);
    first_lower.crossings(&second_lower, &mut breaks);
    first_upper.crossings(&second_lower, &mut breaks);
    second_upper.crossings(&first_lower, &mut breaks);
    let between = |x0: f64, x1: f64| {
        let at_mid = |bound: Bound| (bound, bound.value(0.5 * (x0 + x1)));
        let (u, v) = (at_mid(first_upper), at_mid(second_upper));
        let upper = if u.1 <= v.1 { u } else { v };
        let (u, v) = (at_mid(first_lower), at_mid(second_lower));
        let lower = if u.1 >= v.1 { u } else { v };
        if upper.1 <= lower.1 { 0.0 } else { (upper.0.integral(x0, x1) - lower.0.integral(x0, x1)).max(0.0) }
    };
    breaks.sorted().windows(2).map(|w| between(w[0], w[1])).sum()
}

impl Bound {
    fn value(&self, x: f64) -> f64 {
        match *self {
            Self::Arc { centre, r, sign } => {
                let u = x - centre.x;
                centre.y + sign * ((r - u) * (r + u)).max(0.0).sqrt()
            }
            Self::Line { through, d } => through.y + d.y / d.x * (x - through.x),
        }
    }

    fn integral(&self, x0: f64, x1: f64) -> f64 {
        match *self {
            Self::Arc { centre, r, sign } => {
                let under = |x: f64| {
                    let u = (x - centre.x).clamp(-r, r);
                    0.5 * (u * ((r - u) * (r + u)).sqrt() + r * r * (u / r).asin())
                };
                centre.y * (x1 - x0) + sign * (under(x1) - under(x0))
            }
            Self::Line { .. } => self.value(0.5 * (x0 + x1)) * (x1 - x0),
        }
    }

    /// Where the whole circle or line crosses another one.
    fn crossings(&self, other: &Self, breaks: &mut Breaks) {
        match (*self, *other) {
            (Self::Line { through: p, d }, Self::Line { through: q, d: e }) => {
                let turn = d.perp_dot(e);
                if turn != 0.0 {
                    breaks.add(p.x + d.x * ((q - p).perp_dot(e) / turn));
                }
            }
            (Self::Line { through, d }, Self::Arc { centre, r, .. })
            | (Self::Arc { centre, r, .. }, Self::Line { through, d }) => {
                let off = d.perp_dot(through - centre);
                let half = (r - off) * (r + off);
                if half >= -TANGENT * r * r {
                    let foot = through.x + d.x * d.dot(centre - through);
                    let half = half.max(0.0).sqrt();
                    breaks.add(foot - d.x * half);
                    breaks.add(foot + d.x * half);
                }
            }
            (Self::Arc { centre: p, r, .. }, Self::Arc { centre: q, .. }) => {
                let (mid, half) = (0.5 * (p.x + q.x), 0.5 * (q - p));
                let square = half.length_squared();
                if square > 0.0 && square <= r * r {
                    let across = ((r * r - square) / square).sqrt() * half.y;
                    breaks.add(mid - across);
                    breaks.add(mid + across);
                }
            }
        }
    }
}

/// A line that misses a circle by this share of r² touches it. The touching point is a break too: if it
/// fell on the middle of a strip, the bounds compared there would be equal and the wrong one taken.
const TANGENT: f64 = 1e-12;

/// Both ends of a strip and two crossings for each of four pairs of bounds.
const BREAKS_MAX: usize = 10;

/// The ends of a strip and where its bounds cross.
struct Breaks {
    x: [f64; BREAKS_MAX],
    len: usize,
}

impl Breaks {
    fn new(low: f64, high: f64) -> Self {
        let mut x = [0.0; BREAKS_MAX];
        x[..2].copy_from_slice(&[low, high]);
        Self { x, len: 2 }
    }

    fn add(&mut self, x: f64) {
        if x > self.x[0] && x < self.x[1] {
            self.x[self.len] = x;
            self.len += 1;
        }
    }

    fn sorted(&mut self) -> &[f64] {
        let used = &mut self.x[..self.len];
        used.sort_unstable_by(f64::total_cmp);
        used
    }
}

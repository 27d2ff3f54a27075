//! Exact area common to two capsules (a segment widened by a disc: `w ⊕ D_r`).
//!
//! Both shapes are convex, so in the frame of the first one the common area is the integral of
//! `max(0, min(upper) − max(lower))`, and every bound is piece by piece an arc or a straight line with
//! a closed integral. Unlike tracing the boundary, this knows no degenerate case: bounds that touch or
//! coincide differ by nothing, so it does not matter which of them is taken.

use glam::DVec2;

/// Relative to the squared radius: what computing a crossing may lose where outlines nearly touch. A
/// point kept too much only splits a strip in two.
const ROUNDING: f64 = 1e-6;

/// Joints of both capsules (8) and crossings of their lines and circles (28).
const BREAKS_MAX: usize = 36;

/// Area of `(p ⊕ D_r) ∩ (q ⊕ D_r)`, m², ≥ 0; segments may be points. Error below 1e-12 m² for walls up
/// to a kilometre.
pub fn overlap_m2(p: [DVec2; 2], q: [DVec2; 2], radius_m: f64) -> f64 {
    let axis = (p[1] - p[0]).try_normalize().unwrap_or(DVec2::X);
    let local = |x: DVec2| {
        let v = x - p[0];
        DVec2::new(axis.dot(v), axis.perp_dot(v))
    };
    let first = Capsule::new([DVec2::ZERO, DVec2::new(p[0].distance(p[1]), 0.0)], radius_m);
    let second = Capsule::new([local(q[0]), local(q[1])], radius_m);
    let low = first.left().max(second.left());
    let high = first.right().min(second.right());
    if low >= high {
        return 0.0;
    }
    let mut breaks = Breaks::new(low, high);
    first.joints(&mut breaks);
    second.joints(&mut breaks);
    first.crossings(&second, &mut breaks);
    breaks.sorted().windows(2).map(|w| strip_m2(&first, &second, w[0], w[1])).sum()
}

/// Common area over `x0..x1`, where none of the bounds has a joint and no two of them cross.
fn strip_m2(first: &Capsule, second: &Capsule, x0: f64, x1: f64) -> f64 {
    let mid = 0.5 * (x0 + x1);
    let at_mid = |capsule: &Capsule, sign| {
        let bound = capsule.bound(mid, sign);
        (bound, bound.value(mid))
    };
    let (u, v) = (at_mid(first, 1.0), at_mid(second, 1.0));
    let upper = if u.1 <= v.1 { u } else { v };
    let (u, v) = (at_mid(first, -1.0), at_mid(second, -1.0));
    let lower = if u.1 >= v.1 { u } else { v };
    if upper.1 <= lower.1 {
        return 0.0;
    }
    (upper.0.integral(x0, x1) - lower.0.integral(x0, x1)).max(0.0)
}

/// A capsule with its left end first: `d` is the unit direction, `d.x ≥ 0`.
struct Capsule {
    ends: [DVec2; 2],
    d: DVec2,
    length_m: f64,
    r: f64,
}

/// One piece of a bound, as a function of x.
#[derive(Clone, Copy)]
enum Bound {
    /// Half of a circle: `sign` +1 the upper, −1 the lower.
    Arc { centre: DVec2, r: f64, sign: f64 },
    /// A straight line through a point.
    Line { through: DVec2, slope: f64 },
}

impl Bound {
    fn value(&self, x: f64) -> f64 {
        match *self {
            Self::Arc { centre, r, sign } => {
                let u = x - centre.x;
                centre.y + sign * ((r - u) * (r + u)).max(0.0).sqrt()
            }
            Self::Line { through, slope } => through.y + slope * (x - through.x),
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
}

impl Capsule {
    fn new([a, b]: [DVec2; 2], r: f64) -> Self {
        let ends = if a.x <= b.x { [a, b] } else { [b, a] };
        let along = ends[1] - ends[0];
        Self { ends, d: along.try_normalize().unwrap_or(DVec2::X), length_m: along.length(), r }
    }

    fn left(&self) -> f64 {
        self.ends[0].x - self.r
    }

    fn right(&self) -> f64 {
        self.ends[1].x + self.r
    }

    /// From an end to where its circle meets the upper (`sign` +1) or lower (−1) straight side.
    fn side(&self, sign: f64) -> DVec2 {
        self.d.perp() * (sign * self.r)
    }

    fn bound(&self, x: f64, sign: f64) -> Bound {
        let side = self.side(sign);
        if x < self.ends[0].x + side.x {
            Bound::Arc { centre: self.ends[0], r: self.r, sign }
        } else if x < self.ends[1].x + side.x {
            Bound::Line { through: self.ends[0] + side, slope: self.d.y / self.d.x }
        } else {
            Bound::Arc { centre: self.ends[1], r: self.r, sign }
        }
    }

    fn joints(&self, breaks: &mut Breaks) {
        for sign in [1.0, -1.0] {
            let side = self.side(sign);
            breaks.add(self.ends[0].x + side.x);
            breaks.add(self.ends[1].x + side.x);
        }
    }

    /// Where an outline crosses the other one.
    fn crossings(&self, other: &Self, breaks: &mut Breaks) {
        let mut add = |p: DVec2| {
            if breaks.is_within(p.x) && self.is_outermost(p) && other.is_outermost(p) {
                breaks.add(p.x);
            }
        };
        for sign in [1.0, -1.0] {
            let (line, other_line) = (self.ends[0] + self.side(sign), other.ends[0] + other.side(sign));
            for k in 0..2 {
                line_circle(line, self.d, other.ends[k], self.r, &mut add);
                line_circle(other_line, other.d, self.ends[k], self.r, &mut add);
            }
            for sign in [1.0, -1.0] {
                line_line(line, self.d, other.ends[0] + other.side(sign), other.d, &mut add);
            }
        }
        for centre in self.ends {
            for other_centre in other.ends {
                circle_circle(centre, other_centre, self.r, &mut add);
            }
        }
    }

    /// Whether a point of one of the circles or side lines belongs to the outline: whether it is not
    /// inside by more than rounding can make it.
    fn is_outermost(&self, p: DVec2) -> bool {
        let from_start = p - self.ends[0];
        let along = self.d.dot(from_start).clamp(0.0, self.length_m);
        (from_start - self.d * along).length_squared() > self.r * self.r * (1.0 - ROUNDING)
    }
}

fn line_line(p: DVec2, d: DVec2, q: DVec2, e: DVec2, add: &mut impl FnMut(DVec2)) {
    let turn = d.perp_dot(e);
    if turn != 0.0 {
        add(p + d * ((q - p).perp_dot(e) / turn));
    }
}

fn line_circle(p: DVec2, d: DVec2, centre: DVec2, r: f64, add: &mut impl FnMut(DVec2)) {
    let off = d.perp_dot(p - centre);
    let half_square = (r - off) * (r + off);
    if half_square >= 0.0 {
        let foot = p + d * d.dot(centre - p);
        let half = d * half_square.sqrt();
        add(foot - half);
        add(foot + half);
    }
}

fn circle_circle(p: DVec2, q: DVec2, r: f64, add: &mut impl FnMut(DVec2)) {
    let (mid, half) = (0.5 * (p + q), 0.5 * (q - p));
    let square = half.length_squared();
    if square > 0.0 && square <= r * r {
        let across = half.perp() * ((r * r - square) / square).sqrt();
        add(mid - across);
        add(mid + across);
    }
}

/// The x at which a bound may change, strictly between two limits, which are breaks themselves.
struct Breaks {
    x: [f64; BREAKS_MAX + 2],
    len: usize,
}

impl Breaks {
    fn new(low: f64, high: f64) -> Self {
        let mut x = [0.0; BREAKS_MAX + 2];
        x[0] = low;
        x[1] = high;
        Self { x, len: 2 }
    }

    fn is_within(&self, x: f64) -> bool {
        x > self.x[0] && x < self.x[1]
    }

    fn add(&mut self, x: f64) {
        if self.is_within(x) {
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

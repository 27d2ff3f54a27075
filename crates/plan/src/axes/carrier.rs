//! What faces and axes lie on: a straight line or a circle, with a length `s` along it.

use std::f64::consts::{PI, TAU};

use glam::DVec2;

use super::Path;
use super::spans::Span;

/// A line or a circle. `s_m` runs along it: from the origin, or from `base_rad` anticlockwise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Carrier {
    /// Straight; `dir` is a unit vector, offsets are positive to its left.
    Line {
        /// s = 0.
        origin: DVec2,
        /// Where s grows.
        dir: DVec2,
    },
    /// Round; offsets are positive outwards.
    Circle {
        /// Centre.
        centre: DVec2,
        /// Radius, m.
        radius: f64,
        /// Angle at which s = 0; s lies within half a turn of it.
        base_rad: f64,
    },
}

impl Carrier {
    /// Through two points, which differ.
    pub fn line(a: DVec2, b: DVec2) -> Self {
        Self::Line { origin: a, dir: (b - a).normalize() }
    }

    /// The carrier of a path, and the path's span on it.
    pub fn of(path: &Path) -> (Self, Span) {
        match *path {
            Path::Line { a, b } => (Self::line(a, b), [0.0, a.distance(b)]),
            Path::Arc { centre, radius, start_rad, sweep_rad } => {
                let half = sweep_rad * radius / 2.0;
                (Self::Circle { centre, radius, base_rad: start_rad + sweep_rad / 2.0 }, [-half, half])
            }
        }
    }

    /// Point at `s`.
    pub fn at(&self, s: f64) -> DVec2 {
        match *self {
            Self::Line { origin, dir } => origin + dir * s,
            Self::Circle { centre, radius, base_rad } => {
                centre + DVec2::from_angle(base_rad + s / radius) * radius
            }
        }
    }

    /// Where the foot of `p` lies.
    pub fn s_of(&self, p: DVec2) -> f64 {
        match *self {
            Self::Line { origin, dir } => (p - origin).dot(dir),
            Self::Circle { centre, radius, base_rad } => {
                let turn = (p - centre).to_angle() - base_rad;
                ((turn + PI).rem_euclid(TAU) - PI) * radius
            }
        }
    }

    /// Distance of `p` with its side.
    pub fn offset_of(&self, p: DVec2) -> f64 {
        match *self {
            Self::Line { origin, dir } => dir.perp_dot(p - origin),
            Self::Circle { centre, radius, .. } => p.distance(centre) - radius,
        }
    }

    /// Unit vector along growing s.
    pub fn tangent(&self, s: f64) -> DVec2 {
        match *self {
            Self::Line { dir, .. } => dir,
            Self::Circle { radius, base_rad, .. } => DVec2::from_angle(base_rad + s / radius).perp(),
        }
    }

    /// Whether it is straight.
    pub fn is_line(&self) -> bool {
        matches!(self, Self::Line { .. })
    }

    /// Points along a span, ends included, near enough for looking things up by place.
    pub fn points(&self, span: Span) -> Vec<DVec2> {
        let n = match self {
            Self::Line { .. } => 1,
            Self::Circle { radius, .. } => {
                ((span[1] - span[0]) / radius / 0.2).ceil().clamp(1.0, 64.0) as usize
            }
        };
        (0..=n).map(|k| self.at(span[0] + (span[1] - span[0]) * k as f64 / n as f64)).collect()
    }

    /// The span of another piece on this one: the feet of its ends; for circles, the turn of `s` that
    /// lies nearest to this carrier's own zero.
    pub fn span_of(&self, other: &Carrier, span: Span) -> Span {
        let ends = [self.s_of(other.at(span[0])), self.s_of(other.at(span[1]))];
        match (*self, *other) {
            (Self::Circle { radius, .. }, Self::Circle { radius: r, .. }) => {
                let middle = self.s_of(other.at((span[0] + span[1]) / 2.0));
                let half = (span[1] - span[0]) / 2.0 * radius / r;
                [middle - half, middle + half]
            }
            _ => [ends[0].min(ends[1]), ends[0].max(ends[1])],
        }
    }

    /// Points where two carriers cross.
    pub fn crossings(&self, other: &Carrier) -> Vec<DVec2> {
        match (*self, *other) {
            (Self::Line { origin: p, dir: u }, Self::Line { origin: q, dir: v }) => {
                let turn = u.perp_dot(v);
                if turn.abs() < 1e-9 { Vec::new() } else { vec![p + u * ((q - p).perp_dot(v) / turn)] }
            }
            (Self::Line { origin, dir }, Self::Circle { centre, radius, .. })
            | (Self::Circle { centre, radius, .. }, Self::Line { origin, dir }) => {
                let foot = origin + dir * (centre - origin).dot(dir);
                let half2 = radius * radius - foot.distance_squared(centre);
                if half2 <= 0.0 {
                    return Vec::new();
                }
                vec![foot - dir * half2.sqrt(), foot + dir * half2.sqrt()]
            }
            (Self::Circle { centre: c, radius: r, .. }, Self::Circle { centre: d, radius: q, .. }) => {
                let apart = c.distance(d);
                if apart < 1e-6 {
                    return Vec::new();
                }
                let along = (apart * apart + r * r - q * q) / (2.0 * apart);
                let half2 = r * r - along * along;
                if half2 <= 0.0 {
                    return Vec::new();
                }
                let u = (d - c) / apart;
                let foot = c + u * along;
                vec![foot + u.perp() * half2.sqrt(), foot - u.perp() * half2.sqrt()]
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_run_along_lines_and_circles() {
        let arc = Path::Arc { centre: DVec2::new(1.0, 2.0), radius: 3.0, start_rad: 3.0, sweep_rad: 1.0 };
        let (c, span) = Carrier::of(&arc);
        assert!((span[1] - span[0] - 3.0).abs() < 1e-12);
        for s in [-1.4, 0.0, 1.1] {
            let outwards = -c.tangent(s).perp();
            assert!((c.s_of(c.at(s) + outwards * 0.2) - s).abs() < 1e-12);
            assert!((c.offset_of(c.at(s) - outwards * 0.2) + 0.2).abs() < 1e-12);
        }
        let line = Carrier::line(DVec2::new(-9.0, 2.0), DVec2::new(9.0, 2.0));
        assert_eq!(line.crossings(&c).len(), 2);
        assert!(line.crossings(&c).iter().all(|p| c.offset_of(*p).abs() < 1e-9));
    }
}

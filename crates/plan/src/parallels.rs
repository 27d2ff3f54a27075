//! Straight pieces and their nearest parallel neighbours: the evidence of walls drawn as two faces.

use std::collections::BTreeMap;

use glam::DVec2;

use enfilade_cad::drawing::{Entity, Shape};

/// Directions nearer than this are parallel: drawn walls are off by less, furniture by more.
pub const DIRECTION_STEP_RAD: f64 = std::f64::consts::PI / 180.0;

/// Neighbours looked at before a piece counts as alone; keeps hatches near-linear.
const LOOK_MAX: usize = 48;

/// Two faces of one wall run along each other for at least this share of the shorter one.
const OVERLAP_SHARE: f64 = 0.5;

/// A straight piece, drawing units, with the entity it belongs to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// Start.
    pub a: DVec2,
    /// End.
    pub b: DVec2,
    /// Index of its entity in the list they were taken from.
    pub entity: usize,
}

impl Piece {
    /// Length, drawing units.
    pub fn length(&self) -> f64 {
        self.a.distance(self.b)
    }
}

/// A straight line as one entity draws it, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Straight {
    /// Its entity: index in the list it was taken from.
    pub entity: usize,
    /// Start.
    pub a: DVec2,
    /// End.
    pub b: DVec2,
}

impl Straight {
    /// Length, metres.
    pub fn length(&self) -> f64 {
        self.a.distance(self.b)
    }

    /// Direction, radians, in half a turn from half a [`DIRECTION_STEP_RAD`] below 0.
    pub fn direction_rad(&self) -> f64 {
        let angle = (self.b - self.a).to_angle().rem_euclid(std::f64::consts::PI);
        // A hair below π is a hair below 0.
        if angle > std::f64::consts::PI - DIRECTION_STEP_RAD / 2.0 {
            angle - std::f64::consts::PI
        } else {
            angle
        }
    }
}

/// The straight pieces of some entities; arcs and bulged pieces give none.
pub fn pieces<'a>(entities: impl Iterator<Item = &'a Entity>) -> Vec<Piece> {
    let mut out = Vec::new();
    for (entity, e) in entities.enumerate() {
        match &e.shape {
            Shape::Line { a, b } => out.push(Piece { a: *a, b: *b, entity }),
            Shape::Polyline { vertices, closed } => {
                let n = vertices.len();
                let last = if *closed && n > 2 { n } else { n.saturating_sub(1) };
                let straight = (0..last).filter(|i| vertices[*i].bulge.abs() < 1e-9);
                out.extend(straight.map(|i| Piece {
                    a: vertices[i].at,
                    b: vertices[(i + 1) % n].at,
                    entity,
                }));
            }
            Shape::Arc { .. } | Shape::Circle { .. } => {}
        }
    }
    out
}

/// For each piece the distances to the first `count` parallel pieces on either side of it, drawing units;
/// those of one line drawn in parts count once. Up to `least` two are the same line drawn twice.
pub fn parallels(pieces: &[Piece], least: f64, count: usize) -> Vec<Vec<f64>> {
    let mut out = vec![Vec::new(); pieces.len()];
    let Some(origin) = pieces.first().map(|p| p.a) else { return out };
    let mut bins: BTreeMap<i64, Vec<Strip>> = BTreeMap::new();
    let turns = (std::f64::consts::PI / DIRECTION_STEP_RAD).round() as i64;
    for (i, p) in pieces.iter().enumerate() {
        let d = p.b - p.a;
        if d.length() <= least {
            continue;
        }
        let bin = (d.to_angle() / DIRECTION_STEP_RAD).round() as i64;
        let bin = bin.rem_euclid(turns);
        let along = DVec2::from_angle(bin as f64 * DIRECTION_STEP_RAD);
        let (s, e) = (along.dot(p.a - origin), along.dot(p.b - origin));
        let offset = along.perp().dot((p.a + p.b) / 2.0 - origin);
        bins.entry(bin).or_default().push(Strip { index: i, offset, from: s.min(e), to: s.max(e) });
    }
    for strips in bins.values_mut() {
        strips.sort_by(|x, y| x.offset.total_cmp(&y.offset).then(x.index.cmp(&y.index)));
        for (k, strip) in strips.iter().enumerate() {
            let distances = &mut out[strip.index];
            strip.look(strips[k + 1..].iter().take(LOOK_MAX), least, count, distances);
            strip.look(strips[..k].iter().rev().take(LOOK_MAX), least, count, distances);
        }
    }
    out
}

struct Strip {
    index: usize,
    offset: f64,
    from: f64,
    to: f64,
}

impl Strip {
    /// Adds the distances to the first `count` lines beside this one.
    fn look<'s>(&self, others: impl Iterator<Item = &'s Self>, least: f64, count: usize, out: &mut Vec<f64>) {
        let mut last = 0.0;
        let mut found = 0;
        for other in others {
            let distance = (other.offset - self.offset).abs();
            if distance > last + least && self.is_beside(other, least) {
                out.push(distance);
                last = distance;
                found += 1;
                if found == count {
                    return;
                }
            }
        }
    }

    fn is_beside(&self, other: &Self, least: f64) -> bool {
        let distance = (other.offset - self.offset).abs();
        let overlap = self.to.min(other.to) - self.from.max(other.from);
        let shorter = (self.to - self.from).min(other.to - other.from);
        distance > least && overlap >= OVERLAP_SHARE * shorter
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_faces_find_each_other_and_not_the_next_wall() {
        let line = |x0: f64, y0: f64, x1: f64, y1: f64| Piece {
            a: DVec2::new(x0, y0),
            b: DVec2::new(x1, y1),
            entity: 0,
        };
        let pieces = [
            line(0.0, 0.0, 5.0, 0.0),
            line(4.9, 0.2, 0.1, 0.2),
            line(0.0, 0.2, 5.0, 0.2),
            line(0.0, 3.0, 5.0, 3.0),
            line(9.0, 0.1, 12.0, 0.1),
        ];
        let found = parallels(&pieces, 0.001, 1);
        let nearest = |i: usize| found[i].iter().copied().fold(f64::INFINITY, f64::min);
        for i in 0..3 {
            assert!((nearest(i) - 0.2).abs() < 1e-9, "{i}");
        }
        assert!(nearest(3) > 2.7 && nearest(3) < 3.1 && found[4].is_empty());
    }
}

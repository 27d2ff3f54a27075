//! Shortest ways over a floor: they turn only at corners that stand out into it.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use glam::DVec2;

use crate::fence::Fence;
use crate::polygon::Polygon;

/// A corner stands out if it turns by more than this, the sine: what rounding leaves.
const TURN_SIN: f64 = 1e-6;

/// Most corners among which ways are looked for; beyond them a plan is refused rather than waited for.
pub(crate) const CORNERS_MAX: usize = 6_000;

/// So many of the shortest legs are looked at before all others are put in order.
const FIRST: usize = 12;

/// A floor on which one walks.
pub(crate) struct Ground {
    fence: Fence,
    corners: Vec<DVec2>,
}

/// What is walked to.
pub(crate) type Target = [DVec2; 2];

/// The shortest ways from everywhere to the nearest of some targets.
pub(crate) struct Ways<'a> {
    ground: &'a Ground,
    targets: Vec<Target>,
    /// Of every corner: how far it is, and where one goes next.
    of: Vec<Option<Leg>>,
}

/// The next stretch of a way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Leg {
    /// Metres in all.
    pub length_m: f64,
    /// Where the stretch ends.
    pub to: DVec2,
    /// The corner there, or the target.
    next: Next,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Next {
    Corner(usize),
    Target(usize),
}

struct Open {
    length_m: f64,
    corner: usize,
    leg: Leg,
}

impl PartialEq for Open {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Open {}

impl PartialOrd for Open {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Open {
    fn cmp(&self, other: &Self) -> Ordering {
        other.length_m.total_cmp(&self.length_m).then(other.corner.cmp(&self.corner))
    }
}

impl Ground {
    /// Of a floor; `None` where it has too many corners.
    pub fn new(floor: &Polygon) -> Option<Self> {
        let mut corners = Vec::new();
        for ring in floor.rings() {
            for k in 0..ring.len() {
                let [a, b, c] = [k + ring.len() - 1, k, k + 1].map(|i| ring[i % ring.len()]);
                let turn = (b - a).normalize_or_zero().perp_dot((c - b).normalize_or_zero());
                if turn < -TURN_SIN {
                    corners.push(b);
                }
            }
        }
        (corners.len() <= CORNERS_MAX).then(|| Self { fence: Fence::new(floor), corners })
    }

    /// Whether a point is on it.
    pub fn holds(&self, p: DVec2) -> bool {
        self.fence.holds(p)
    }

    /// Finds the shortest ways to some targets.
    pub fn ways(&self, targets: &[Target]) -> Ways<'_> {
        let mut out = Ways { ground: self, targets: targets.to_vec(), of: vec![None; self.corners.len()] };
        let mut open = BinaryHeap::new();
        for (corner, at) in self.corners.iter().enumerate() {
            for (k, t) in targets.iter().enumerate() {
                let to = nearest(*at, *t);
                let leg = Leg { length_m: at.distance(to), to, next: Next::Target(k) };
                open.push(Open { length_m: leg.length_m, corner, leg });
            }
        }
        while let Some(Open { length_m, corner, leg }) = open.pop() {
            let at = self.corners[corner];
            if out.of[corner].is_some() || !self.fence.is_free(at, leg.to) {
                continue;
            }
            out.of[corner] = Some(leg);
            for (k, other) in self.corners.iter().enumerate().filter(|(k, _)| out.of[*k].is_none()) {
                let length_m = length_m + at.distance(*other);
                let leg = Leg { length_m, to: at, next: Next::Corner(corner) };
                open.push(Open { length_m, corner: k, leg });
            }
        }
        out
    }
}

/// The point of a target that is nearest to a point.
pub(crate) fn nearest(p: DVec2, [a, b]: Target) -> DVec2 {
    let d = b - a;
    let t = if d == DVec2::ZERO { 0.0 } else { ((p - a).dot(d) / d.length_squared()).clamp(0.0, 1.0) };
    a + d * t
}

impl Ways<'_> {
    /// The first stretch of the shortest way from a point; `None` where no way leads to a target.
    pub fn from(&self, p: DVec2) -> Option<Leg> {
        let straight = self.targets.iter().enumerate().map(|(k, t)| {
            let to = nearest(p, *t);
            Leg { length_m: p.distance(to), to, next: Next::Target(k) }
        });
        let corners = self.ground.corners.iter().zip(&self.of).enumerate();
        let by_corner = corners.filter_map(|(k, (at, leg))| {
            let length_m = leg.as_ref()?.length_m + p.distance(*at);
            Some(Leg { length_m, to: *at, next: Next::Corner(k) })
        });
        let mut legs: Vec<Leg> = straight.chain(by_corner).collect();
        let shorter = |a: &Leg, b: &Leg| a.length_m.total_cmp(&b.length_m);
        // Nearly always one of the first few is free: the others need no order.
        if legs.len() > FIRST {
            legs.select_nth_unstable_by(FIRST, shorter);
            legs[..FIRST].sort_by(shorter);
            if let Some(leg) = legs[..FIRST].iter().find(|leg| self.ground.fence.is_free(p, leg.to)) {
                return Some(*leg);
            }
            legs.drain(..FIRST);
        }
        legs.sort_by(shorter);
        legs.into_iter().find(|leg| self.ground.fence.is_free(p, leg.to))
    }

    /// The shortest way from a point, with the number of the target that it ends at.
    pub fn way(&self, p: DVec2) -> Option<(Vec<DVec2>, usize)> {
        let mut leg = self.from(p)?;
        let mut out = vec![p, leg.to];
        loop {
            match leg.next {
                Next::Target(k) => return Some((out, k)),
                Next::Corner(k) => leg = self.of[k]?,
            }
            out.push(leg.to);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(points: &[[f64; 2]]) -> Vec<DVec2> {
        points.iter().copied().map(DVec2::from).collect()
    }

    #[test]
    fn a_way_goes_round_a_column() {
        let column = at(&[[4.0, 4.0], [6.0, 4.0], [6.0, 6.0], [4.0, 6.0]]);
        let hall = Polygon::new(&at(&[[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]]), &[column]);
        let ground = Ground::new(&hall).unwrap();
        let ways = ground.ways(&[[DVec2::new(10.0, 5.0), DVec2::new(10.0, 5.0)]]);
        // By Pythagoras: to the corner (4, 4), along the column to (6, 4), on to (10, 5).
        let by_hand = 4.0_f64.hypot(1.0) + 2.0 + 4.0_f64.hypot(1.0);
        let leg = ways.from(DVec2::new(0.0, 5.0)).unwrap();
        assert!((leg.length_m - by_hand).abs() < 1e-9, "{}", leg.length_m);
        let (way, target) = ways.way(DVec2::new(0.0, 5.0)).unwrap();
        assert_eq!((way.len(), target), (4, 0));
    }

    #[test]
    fn too_many_corners_are_refused() {
        let tooth = |k: usize| [[k as f64, 0.0], [k as f64 + 0.5, 1.0]];
        let comb = |teeth: usize| {
            let mut ring: Vec<[f64; 2]> = vec![[teeth as f64, 9.0], [0.0, 9.0]];
            ring.extend((0..teeth).flat_map(tooth));
            Ground::new(&Polygon::new(&at(&ring), &[])).is_some()
        };
        assert!(comb(100) && !comb(CORNERS_MAX + 10));
    }

    #[test]
    fn no_way_leads_into_a_closed_room() {
        let room = |x: f64| Polygon::new(&at(&[[x, 0.0], [x + 2.0, 0.0], [x + 2.0, 2.0], [x, 2.0]]), &[]);
        let all = Polygon::union([&room(0.0), &room(3.0)].into_iter());
        let ground = Ground::new(&all).unwrap();
        let ways = ground.ways(&[[DVec2::new(0.0, 1.0), DVec2::new(0.0, 1.5)]]);
        assert!(ways.from(DVec2::new(4.0, 1.0)).is_none());
        assert!((ways.from(DVec2::new(2.0, 1.2)).unwrap().length_m - 2.0).abs() < 1e-12);
    }
}

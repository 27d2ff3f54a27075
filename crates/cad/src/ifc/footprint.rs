//! What an element covers in the plan, and how what two cover lies together.

use glam::DVec2;

use crate::plane::distance_to_segment;

/// An end of a wall this near to another wall stands at it, metres.
const JOINT_M: f64 = 0.02;

/// A joint counts as opened where its walls part by more than this, metres: less is rounding.
const OPEN_M: f64 = 0.01;

/// What is this near to an outline is on it, metres: coordinates of a plan are whole micrometres.
const OUTLINE_M: f64 = 1e-6;

/// Points across a box by which it is asked how much of what lies in it lies in others.
const SPREAD: u32 = 24;

/// What an element covers half way up its body, world, file units.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Footprint {
    rings: Vec<Vec<DVec2>>,
    /// Two corners of the box round it.
    extent: [DVec2; 2],
}

/// A wall as it stands.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct StandingWall {
    /// Its lowest and its highest point.
    pub reach: [f64; 2],
    /// What it covers.
    pub at: Footprint,
}

/// What becomes of a joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Parting {
    /// A gap, metres.
    Gap(f64),
    /// What stood at the other one is so far from it, metres, and both run through each other.
    Through(f64),
    /// Nothing can be measured: neither stands at the other as drawn, or one has no outline.
    Unknown,
}

impl Footprint {
    /// What rings enclose; none where there is no corner.
    pub fn new(rings: Vec<Vec<DVec2>>) -> Option<Self> {
        let extent = crate::plane::box_of(rings.iter().flatten().copied())?;
        Some(Self { rings, extent })
    }

    /// Whether a side of it runs in a direction, up to a small sine of the angle.
    pub fn has_face_along(&self, along: DVec2, sin: f64) -> bool {
        let runs =
            self.rings.iter().flat_map(|r| r.iter().zip(r.iter().cycle().skip(1))).map(|(a, b)| *b - *a);
        runs.filter(|run| *run != DVec2::ZERO).any(|run| run.normalize().perp_dot(along).abs() <= sin)
    }

    /// Two corners of the box round it.
    pub fn extent(&self) -> [DVec2; 2] {
        self.extent
    }

    /// Its rings.
    pub fn rings(&self) -> &[Vec<DVec2>] {
        &self.rings
    }

    /// Its rings.
    pub fn into_rings(self) -> Vec<Vec<DVec2>> {
        self.rings
    }

    /// The least distance of the corners of either to the other.
    pub fn gap(&self, other: &Self) -> f64 {
        let to = |a: &Self, b: &Self| a.corners().map(|p| b.distance(p)).fold(f64::INFINITY, f64::min);
        to(self, other).min(to(other, self))
    }

    /// The share of its ground that lies in any of some others, by points spread over it.
    pub fn share_in(&self, others: &[&Self]) -> f64 {
        let [lo, hi] = self.extent;
        let at = |i: u32, j: u32| {
            lo + (hi - lo) * (DVec2::new(f64::from(i), f64::from(j)) + 0.5) / f64::from(SPREAD)
        };
        let all = (0..SPREAD).flat_map(|i| (0..SPREAD).map(move |j| at(i, j)));
        let own: Vec<DVec2> = all.filter(|p| self.distance(*p) == 0.0).collect();
        let within = own.iter().filter(|p| others.iter().any(|o| o.distance(**p) == 0.0)).count();
        within as f64 / own.len().max(1) as f64
    }

    /// What an end of a wall passes over, its corners in order.
    pub fn swept(end: &[DVec2], by: DVec2) -> Option<Self> {
        Self::new(vec![end.iter().copied().chain(end.iter().rev().map(|p| p + by)).collect()])
    }

    /// Whether the boxes round both are no further apart than walls that stand at each other.
    pub fn is_near(&self, other: &Self, metres: f64) -> bool {
        self.is_near_by(other, JOINT_M / metres)
    }

    /// Whether the boxes round both are no further apart than a margin.
    pub fn is_near_by(&self, other: &Self, margin: f64) -> bool {
        let ([lo, hi], margin) = (self.extent, DVec2::splat(margin));
        (other.extent[0] - margin).cmple(hi).all() && (other.extent[1] + margin).cmpge(lo).all()
    }

    /// Whether it has a corner at another or in it.
    pub fn stands_at(&self, other: &Self, metres: f64) -> bool {
        self.is_near(other, metres) && other.is_at(&self.corners().collect::<Vec<_>>(), metres)
    }

    /// Whether both cover some ground.
    pub fn runs_through(&self, other: &Self) -> bool {
        let middle = |f: &Self| f.corners().sum::<DVec2>() / f.corners().count().max(1) as f64;
        self.crosses(other) || other.distance(middle(self)) == 0.0 || self.distance(middle(other)) == 0.0
    }

    /// The same after a motion.
    pub fn moved(&self, go: impl Fn(DVec2) -> DVec2) -> Self {
        let rings = self.rings.iter().map(|r| r.iter().map(|p| go(*p)).collect()).collect();
        Self::new(rings).unwrap_or_else(|| self.clone())
    }

    /// Whether one of some corners stands at it or in it.
    pub fn is_at(&self, corners: &[DVec2], metres: f64) -> bool {
        corners.iter().any(|p| self.distance(*p) * metres <= JOINT_M)
    }

    /// How far a point is from it; 0 within it.
    pub fn distance(&self, p: DVec2) -> f64 {
        let crosses = |[a, b]: &[DVec2; 2]| {
            (a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)
        };
        if self.sides().filter(crosses).count() % 2 == 1 {
            return 0.0;
        }
        self.sides().map(|s| distance_to_segment(p, s)).fold(f64::INFINITY, f64::min)
    }

    /// Whether a point lies in it or on its outline.
    pub fn holds(&self, p: DVec2, metres: f64) -> bool {
        self.distance(p) * metres <= OUTLINE_M
    }

    fn sides(&self) -> impl Iterator<Item = [DVec2; 2]> {
        self.rings.iter().flat_map(|r| (0..r.len()).map(|i| [r[i], r[(i + 1) % r.len()]]))
    }

    /// The sides nearest to a point.
    fn sides_at(&self, p: DVec2, near: f64) -> Vec<usize> {
        let far: Vec<f64> = self.sides().map(|s| distance_to_segment(p, s)).collect();
        let least = far.iter().copied().fold(f64::INFINITY, f64::min);
        (0..far.len()).filter(|s| far[*s] <= least + near).collect()
    }

    /// How deep a point is behind one of its sides; below 0 before it.
    fn behind(&self, side: usize, p: DVec2) -> f64 {
        let sides = self.rings.iter().flat_map(|r| {
            let turns: f64 = (0..r.len()).map(|i| r[i].perp_dot(r[(i + 1) % r.len()])).sum();
            (0..r.len()).map(move |i| (r[i], r[(i + 1) % r.len()], turns.signum()))
        });
        let of = sides.skip(side).map(|(a, b, turn)| (b - a).normalize_or_zero().perp_dot(p - a) * turn);
        of.take(1).sum()
    }

    /// How long its sides are.
    pub fn runs(&self) -> impl Iterator<Item = f64> {
        self.sides().map(|[a, b]| a.distance(b))
    }

    /// How thick it is: the least it measures across one of its sides.
    pub fn width(&self) -> f64 {
        let across = |[a, b]: [DVec2; 2]| {
            let normal = (b - a).try_normalize()?.perp();
            let places = self.corners().map(|p| p.dot(normal));
            let (lo, hi) = places.fold((f64::INFINITY, f64::NEG_INFINITY), |s, v| (s.0.min(v), s.1.max(v)));
            Some(hi - lo)
        };
        self.sides().filter_map(across).fold(f64::INFINITY, f64::min)
    }

    /// Whether its sides cross those of another.
    fn crosses(&self, other: &Self) -> bool {
        let [lo, hi] = self.extent;
        if !(other.extent[0].cmple(hi).all() && other.extent[1].cmpge(lo).all()) {
            return false;
        }
        let parts =
            |[a, b]: [DVec2; 2], [p, q]: [DVec2; 2]| (b - a).perp_dot(p - a) * (b - a).perp_dot(q - a) < 0.0;
        self.sides().any(|s| other.sides().any(|o| parts(s, o) && parts(o, s)))
    }

    fn corners(&self) -> impl Iterator<Item = DVec2> {
        self.rings.iter().flatten().copied()
    }
}

/// What becomes of the joint of a wall that goes from one place to another with one that stays; `None` where it holds: a
/// corner that stood at the other one still does, and no deeper behind the same side of it than it was or than the
/// other one is thick.
pub(super) fn parting(from: &Footprint, to: &Footprint, stays: &Footprint, metres: f64) -> Option<Parting> {
    let near = JOINT_M / metres;
    let mine = from.corners().zip(to.corners()).map(|(p, q)| ([stays, stays], [p, q]));
    let others = stays.corners().map(|p| ([from, to], [p, p]));
    let ends = mine.chain(others).filter_map(|([was_at, is_at], [p, q])| {
        let was = was_at.distance(p);
        (was <= near).then(|| {
            let sides = was_at.sides_at(p, near);
            let depth = |f: &Footprint, p: DVec2| sides.iter().map(|s| f.behind(*s, p)).fold(0.0, f64::max);
            let deepest = was_at.width().max(depth(was_at, p));
            [was, is_at.distance(q), deepest, depth(is_at, q)].map(|d| d * metres)
        })
    });
    let mut nearest: Option<f64> = None;
    let mut is_inside = false;
    for [was, is, deepest, depth] in ends {
        let is_at = is <= JOINT_M.max(was + OPEN_M);
        if is_at && depth <= deepest + OPEN_M {
            return None;
        }
        is_inside |= is_at;
        let by_m = if is_at { depth } else { is };
        nearest = Some(nearest.map_or(by_m, |n| n.min(by_m)));
    }
    let kind = if is_inside || to.crosses(stays) { Parting::Through } else { Parting::Gap };
    Some(nearest.map_or(Parting::Unknown, kind))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn slab(x: [f64; 2], y: [f64; 2]) -> Footprint {
        let ring = [[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]];
        Footprint::new(vec![ring.map(DVec2::from).to_vec()]).unwrap()
    }

    #[test]
    fn a_joint_holds_no_deeper_than_the_other_wall_is_thick() {
        let through = |by: f64| Some(Parting::Through(by));
        let gap = |by: f64| Some(Parting::Gap(by));
        let cases = [
            // In line, end to end.
            (slab([3.0, 6.0], [0.0, 0.12]), slab([1.0, 3.0], [0.0, 0.12]), [-0.8, 0.0], through(0.8)),
            (slab([3.0, 6.0], [0.0, 0.12]), slab([1.0, 3.0], [0.0, 0.12]), [-0.1, 0.0], None),
            (slab([3.0, 6.0], [0.0, 0.12]), slab([1.0, 3.0], [0.0, 0.12]), [0.5, 0.0], gap(0.5)),
            // A wall that slides along the one at whose face, or in which, it ends.
            (slab([3.0, 3.2], [0.2, 4.0]), slab([0.0, 9.0], [0.0, 0.2]), [0.8, 0.0], None),
            (slab([3.0, 3.2], [0.1, 4.0]), slab([0.0, 9.0], [0.0, 0.2]), [0.8, 0.0], None),
            (slab([3.0, 3.2], [0.0, 4.0]), slab([0.0, 9.0], [0.0, 0.2]), [-0.8, 0.0], None),
            // One that leaves the end at which it stands, and stays in the other.
            (slab([5.0, 5.12], [4.0, 8.0]), slab([5.12, 8.0], [3.9, 4.1]), [0.7, 0.0], through(0.58)),
        ];
        for (from, stays, by, expected) in cases {
            let to = from.moved(|p| p + DVec2::from(by));
            let found = parting(&from, &to, &stays, 1.0);
            let rounded = |v: f64| (v * 1e6).round() / 1e6;
            let found = found.map(|p| match p {
                Parting::Gap(v) => Parting::Gap(rounded(v)),
                Parting::Through(v) => Parting::Through(rounded(v)),
                Parting::Unknown => p,
            });
            assert_eq!(found, expected, "{from:?} {by:?}");
        }
    }

    #[test]
    fn an_outline_is_as_thick_as_its_narrowest_way() {
        assert!((slab([0.0, 5.0], [1.0, 1.3]).width() - 0.3).abs() < 1e-12);
        let turned = slab([0.0, 5.0], [1.0, 1.3]).moved(|p| DVec2::from_angle(0.7).rotate(p));
        assert!((turned.width() - 0.3).abs() < 1e-12);
    }
}

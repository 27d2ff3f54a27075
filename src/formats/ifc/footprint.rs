//! Where elements stand in the plan, whether or not the cut shows them.

use std::collections::BTreeMap;

use glam::{DAffine3, DVec2};
use rayon::prelude::*;

use super::model::body_items;
use super::read::Building;
use crate::plan::distance_to_segment;

/// An end of a wall this near to another wall stands at it, metres.
const JOINT_M: f64 = 0.02;

/// A joint counts as opened where its walls part by more than this, metres: less is rounding.
const OPEN_M: f64 = 0.01;

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

/// Every wall that has a body that can be cut, by its instance.
pub(super) fn standing(b: &Building<'_, '_>) -> BTreeMap<u64, StandingWall> {
    let walls: Vec<u64> =
        b.model.products.iter().filter(|p| p.class.starts_with("IfcWall")).map(|p| p.id).collect();
    let one = |id: &u64| Some((*id, StandingWall { reach: reach(b, *id)?, at: Footprint::of(b, *id)? }));
    walls.par_iter().filter_map(one).collect()
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

/// The lowest and the highest point of an element's body.
pub(super) fn reach(b: &Building<'_, '_>, id: u64) -> Option<[f64; 2]> {
    let product = b.model.product(id)?;
    let world = product.placement.map_or(Ok(DAffine3::IDENTITY), |p| b.geo.placement(p)).ok()?;
    let items = body_items(b.step, product.shape?).ok()?;
    let all: Option<Vec<[f64; 2]>> = items.iter().map(|i| b.geo.reach(*i, &world, 0).ok()).collect();
    all?.into_iter().reduce(|s, r| [s[0].min(r[0]), s[1].max(r[1])])
}

impl Footprint {
    /// Of an element with a body that can be cut.
    pub fn of(b: &Building<'_, '_>, id: u64) -> Option<Self> {
        let [low, high] = reach(b, id)?;
        let product = b.model.product(id)?;
        let world = product.placement.map_or(Ok(DAffine3::IDENTITY), |p| b.geo.placement(p)).ok()?;
        let cut =
            b.geo.cut_items(&body_items(b.step, product.shape?).ok()?, &world, f64::midpoint(low, high));
        let rings: Vec<Vec<DVec2>> =
            cut.region.rings().map(|r| r.iter().map(|p| DVec2::from(*p)).collect()).collect();
        Self::new(rings)
    }

    fn new(rings: Vec<Vec<DVec2>>) -> Option<Self> {
        let extent = crate::plan::box_of(rings.iter().flatten().copied())?;
        Some(Self { rings, extent })
    }

    /// What an end of a wall passes over, its corners in order.
    pub fn swept(end: &[DVec2], by: DVec2) -> Option<Self> {
        Self::new(vec![end.iter().copied().chain(end.iter().rev().map(|p| p + by)).collect()])
    }

    /// Whether the boxes round both are no further apart than walls that stand at each other.
    pub fn is_near(&self, other: &Self, metres: f64) -> bool {
        let margin = DVec2::splat(JOINT_M / metres);
        let [lo, hi] = self.extent;
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
    fn distance(&self, p: DVec2) -> f64 {
        let crosses = |[a, b]: &[DVec2; 2]| {
            (a.y > p.y) != (b.y > p.y) && p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)
        };
        if self.sides().filter(crosses).count() % 2 == 1 {
            return 0.0;
        }
        self.sides().map(|s| distance_to_segment(p, s)).fold(f64::INFINITY, f64::min)
    }

    fn sides(&self) -> impl Iterator<Item = [DVec2; 2]> {
        self.rings.iter().flat_map(|r| (0..r.len()).map(|i| [r[i], r[(i + 1) % r.len()]]))
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

/// What becomes of the joint of a wall that goes from one place to another with one that stays; `None` where it holds.
pub(super) fn parting(from: &Footprint, to: &Footprint, stays: &Footprint, metres: f64) -> Option<Parting> {
    let mine = from.corners().zip(to.corners()).map(|(p, q)| [stays.distance(p), stays.distance(q)]);
    let others = stays.corners().map(|p| [from.distance(p), to.distance(p)]);
    let joined = mine.chain(others).map(|d| d.map(|d| d * metres)).filter(|d| d[0] <= JOINT_M);
    let joined: Vec<[f64; 2]> = joined.collect();
    if joined.iter().any(|[was, is]| *is <= JOINT_M.max(was + OPEN_M)) {
        return None;
    }
    let nearest = joined.iter().map(|d| d[1]).reduce(f64::min);
    let kind = if to.crosses(stays) { Parting::Through } else { Parting::Gap };
    Some(nearest.map_or(Parting::Unknown, kind))
}

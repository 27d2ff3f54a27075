//! Where elements of a building stand in the plan, whether or not the cut shows them.

use std::collections::BTreeMap;

use glam::{DAffine3, DVec2};
use rayon::prelude::*;

use super::building::Building;
use super::footprint::{Footprint, StandingWall};
use super::marks::{is_yes, of_space};
use super::model::{Product, body_items};

impl Building<'_, '_> {
    /// Every wall as it stands, whatever its storey; measured when first asked for.
    pub fn standing(&self) -> &BTreeMap<u64, StandingWall> {
        self.standing.get_or_init(|| standing(self))
    }
}

/// Every wall that has a body that can be cut, by its instance.
fn standing(b: &Building<'_, '_>) -> BTreeMap<u64, StandingWall> {
    let walls: Vec<u64> =
        b.model.products.iter().filter(|p| p.class.starts_with("IfcWall")).map(|p| p.id).collect();
    let one = |id: &u64| Some((*id, StandingWall { reach: reach(b, *id)?, at: Footprint::of(b, *id)? }));
    walls.par_iter().filter_map(one).collect()
}

/// Every space that a mark keeps, on whichever storey.
pub(super) fn kept_spaces(b: &Building<'_, '_>) -> Vec<StandingWall> {
    let spaces = b.model.products.iter().filter(|p| p.class == "IfcSpace");
    let is_kept = |p: &Product| of_space(b, p.id).get("keep").is_some_and(|v| is_yes(v) == Some(true));
    let one = |p: &Product| Some(StandingWall { reach: reach(b, p.id)?, at: Footprint::of(b, p.id)? });
    spaces.filter(|p| is_kept(p)).filter_map(one).collect()
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

    /// Of a body at several heights, each for itself: what has no height at which it shows all of its ground.
    pub fn slices(b: &Building<'_, '_>, product: &Product, count: u32) -> Vec<Self> {
        let Some(world) = product.placement.map_or(Some(DAffine3::IDENTITY), |p| b.geo.placement(p).ok())
        else {
            return Vec::new();
        };
        let Some(items) = product.shape.and_then(|s| body_items(b.step, s).ok()) else { return Vec::new() };
        let reach = items.iter().filter_map(|i| b.geo.reach(*i, &world, 0).ok());
        let Some([low, high]) = reach.reduce(|s, r| [s[0].min(r[0]), s[1].max(r[1])]) else {
            return Vec::new();
        };
        let at = |k: u32| low + (high - low) * (f64::from(k) + 0.5) / f64::from(count);
        let slice = |k: u32| {
            let cut = b.geo.cut_items(&items, &world, at(k));
            Self::new(cut.region.rings().map(|r| r.iter().map(|p| DVec2::from(*p)).collect()).collect())
        };
        (0..count).filter_map(slice).collect()
    }
}

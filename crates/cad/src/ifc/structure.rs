//! Which walls of a building carry, hold fire up or part dwellings.

use std::collections::{BTreeMap, HashMap};

use glam::{DAffine3, DVec2};
use rayon::prelude::*;

use super::building::Building;
use super::footprint::{Footprint, StandingWall};
use super::model::{Product, pairs, product};
use super::step::Value;
use crate::bearing::{Bearing, by_name};
use crate::drawing::Called;
use crate::plane::box_of;

/// What closes the gap between a wall and the one over it: a floor, metres.
const FLOOR_M: f64 = 0.6;

/// A wall stands over others by so much of its ground.
const STACKED_SHARE: f64 = 0.5;

/// A wall no farther from a stair or a lift stands at it, metres.
const CORE_M: f64 = 0.3;

/// A column no farther from a wall stands at it, metres.
const COLUMN_M: f64 = 0.05;

/// Heights at which stairs and lifts are cut: a flight shows one tread at each.
const SLICES: u32 = 9;

/// Heights at which things are cut.
const THING_SLICES: u32 = 3;

/// What is fixed to the floor and no shape of the plan.
const FIXTURES: [(&str, &str); 3] = [
    ("IFCFLOWTERMINAL", "IfcFlowTerminal"),
    ("IFCSANITARYTERMINAL", "IfcSanitaryTerminal"),
    ("IFCTRANSPORTELEMENT", "IfcTransportElement"),
];

/// Levels of materials: usage, set, layer, material.
const MATERIAL_DEPTH: u32 = 4;

/// The structure among the walls of a storey, or of a building without any, by instance. `cut`: the height at which it is
/// shown, file units.
pub(super) fn of_storey(b: &Building<'_, '_>, storey: Option<u64>, cut: f64) -> BTreeMap<usize, Bearing> {
    let types: HashMap<u64, u64> = pairs(b.step, "IFCRELDEFINESBYTYPE", 5, 4)
        .into_iter()
        .flat_map(|(kind, many)| many.into_iter().map(move |m| (m, kind)))
        .collect();
    let standing = b.standing();
    let is_here = |p: &Product| {
        let is_cut = standing.get(&p.id).is_some_and(|w| w.reach[0] <= cut && w.reach[1] >= cut);
        is_cut || b.model.storey_of(p.id) == storey
    };
    let around = Around::new(b, cut);
    let mut out = BTreeMap::new();
    for p in b.model.products.iter().filter(|p| p.class.starts_with("IfcWall") && is_here(p)) {
        let found = stated(b, p, &types).or_else(|| around.shown(b, p).filter(|_| !is_denied(b, p)));
        out.extend(found.map(|bearing| (p.id as usize, bearing)));
    }
    out
}

/// Whether the file says that a wall does not carry.
fn is_denied(b: &Building<'_, '_>, p: &Product) -> bool {
    b.model.wall_common(b.step, p.id, "LoadBearing").is_some_and(|v| v == "F")
}

/// What the file says of a wall: by its properties, then by names.
fn stated(b: &Building<'_, '_>, p: &Product, types: &HashMap<u64, u64>) -> Option<Bearing> {
    let common = |key: &str| b.model.wall_common(b.step, p.id, key);
    if common("LoadBearing").is_some_and(|v| v == "T") {
        return Some(Bearing::Stated);
    }
    if common("FireRating").is_some_and(|v| v.contains(|c: char| ('1'..='9').contains(&c))) {
        return Some(Bearing::Fire);
    }
    let name_of = |id: &u64| b.step.args(*id).get(2).and_then(|a| b.step.text(a)).unwrap_or_default();
    let mut names = vec![p.name.clone()];
    names.extend(types.get(&p.id).map(name_of));
    let material = b.model.materials.get(&p.id).or_else(|| b.model.materials.get(types.get(&p.id)?));
    material.iter().for_each(|m| materials(b, **m, 0, &mut names));
    let found = names.iter().find_map(|n| by_name(n));
    found.filter(|bearing| *bearing != Bearing::Named || !is_denied(b, p))
}

/// Names of all materials of an association.
fn materials(b: &Building<'_, '_>, id: u64, depth: u32, names: &mut Vec<String>) {
    let args = b.step.args(id);
    names.extend(args.iter().filter_map(|a| b.step.text(a)));
    let below = args.iter().flat_map(|a| a.id().into_iter().chain(a.ids()));
    if depth < MATERIAL_DEPTH {
        below.for_each(|id| materials(b, id, depth + 1, names));
    }
}

/// What stands on the floor below the cut and stops no sight: furniture, stairs, lifts, fixtures, by outlines at a few
/// heights. `between`: the heights of floor and cut, file units.
pub(super) fn things(b: &Building<'_, '_>, between: [f64; 2]) -> Vec<(usize, Vec<DVec2>)> {
    let is_thing = |p: &&Product| is_furniture(p.class) || p.class.starts_with("IfcStair");
    let mut all: Vec<Product> = b.model.products.iter().filter(is_thing).cloned().collect();
    for (keyword, class) in FIXTURES {
        all.extend(b.step.all(keyword).map(|i| product(b.step, i.id, class)));
    }
    let one = |p: &Product| {
        let is_here = height_of(b, p).is_some_and(|[low, high]| low < between[1] && high > between[0]);
        let slices = if is_here { Footprint::slices(b, p, THING_SLICES) } else { Vec::new() };
        slices.into_iter().flat_map(Footprint::into_rings).map(|r| (p.id as usize, r)).collect::<Vec<_>>()
    };
    all.par_iter().flat_map_iter(one).collect()
}

fn is_furniture(class: &str) -> bool {
    ["IfcFurn", "IfcSystemFurn"].iter().any(|c| class.starts_with(c))
}

/// What the file calls the things on a floor, each with the box of its outlines.
pub(super) fn called(b: &Building<'_, '_>, things: &[(usize, Vec<DVec2>)]) -> Vec<Called> {
    let types: HashMap<u64, u64> = pairs(b.step, "IFCRELDEFINESBYTYPE", 5, 4)
        .into_iter()
        .flat_map(|(kind, many)| many.into_iter().map(move |m| (m, kind)))
        .collect();
    let mut boxes: BTreeMap<usize, [DVec2; 2]> = BTreeMap::new();
    for (record, ring) in things {
        let Some([lo, hi]) = box_of(ring.iter().copied()) else { continue };
        let of = boxes.entry(*record).or_insert([lo, hi]);
        *of = [of[0].min(lo), of[1].max(hi)];
    }
    let of = |(record, extent): (usize, [DVec2; 2])| {
        let id = record as u64;
        let said = [Some(id), types.get(&id).copied()].into_iter().flatten();
        let mut words: Vec<String> = said.flat_map(|id| said_of(b, id)).collect();
        let product = b.model.products.iter().find(|p| p.id == id);
        // Stairs are often without a name.
        words.extend(product.filter(|p| p.class.starts_with("IfcStair")).map(|p| p.class.to_owned()));
        let source = product.filter(|p| is_furniture(p.class)).map(|p| b.source(p, p.class));
        Called { words: words.join(" "), extent, source }
    };
    boxes.into_iter().map(of).collect()
}

/// The name of an instance, the type that it is told to be, and its class.
fn said_of(b: &Building<'_, '_>, id: u64) -> Vec<String> {
    let args = b.step.args(id);
    let text = |k: usize| args.get(k).and_then(|a| b.step.text(a));
    let predefined = args.last().and_then(|a| match &a.value {
        Value::Enum(name) => Some(name.clone()),
        _ => None,
    });
    // The last text is the type in words: of an occurrence the fifth, of a type the ninth.
    let in_words = if args.len() > 8 { text(8).or_else(|| text(4)) } else { text(4) };
    let class = b.step.keyword(id).to_lowercase();
    let class = class.strip_prefix("ifc").map(str::to_owned);
    [text(2), in_words, predefined, class].into_iter().flatten().collect()
}

/// Lowest and highest point of a product that need not be among those of the model.
pub(super) fn height_of(b: &Building<'_, '_>, p: &Product) -> Option<[f64; 2]> {
    let world = p.placement.map_or(Some(DAffine3::IDENTITY), |m| b.geo.placement(m).ok())?;
    let items = super::model::body_items(b.step, p.shape?).ok()?;
    let reach = items.iter().filter_map(|i| b.geo.reach(*i, &world, 0).ok());
    reach.reduce(|s, r| [s[0].min(r[0]), s[1].max(r[1])])
}

/// What stands round the walls of a storey.
struct Around<'b> {
    standing: &'b BTreeMap<u64, StandingWall>,
    /// Stairs and lifts.
    cores: Vec<Footprint>,
    columns: Vec<Footprint>,
}

impl<'b> Around<'b> {
    fn new(b: &'b Building<'_, '_>, cut: f64) -> Self {
        let stairs = b.model.products.iter().filter(|p| p.class.starts_with("IfcStair"));
        let lifts = b.step.all("IFCTRANSPORTELEMENT").map(|i| product(b.step, i.id, "IfcTransportElement"));
        let all: Vec<Product> = stairs.cloned().chain(lifts).collect();
        let columns = b.model.products.iter().filter(|p| p.class.starts_with("IfcColumn"));
        let at_cut = columns.flat_map(|p| Footprint::slices(b, p, 1).into_iter().map(move |f| (p, f)));
        let is_cut = |p: &Product| {
            super::standing::reach(b, p.id).is_some_and(|[low, high]| low <= cut && high >= cut)
        };
        Self {
            standing: b.standing(),
            cores: all
                .iter()
                .filter(|p| is_near_height(b, p, cut))
                .flat_map(|p| Footprint::slices(b, p, SLICES))
                .collect(),
            columns: at_cut.filter(|(p, _)| is_cut(p)).map(|(_, f)| f).collect(),
        }
    }

    /// What the building shows of a wall.
    fn shown(&self, b: &Building<'_, '_>, p: &Product) -> Option<Bearing> {
        let own = self.standing.get(&p.id)?;
        let metres = b.geo.metres;
        if self
            .cores
            .iter()
            .any(|c| own.at.is_near_by(c, CORE_M / metres) && own.at.gap(c) * metres <= CORE_M)
        {
            return Some(Bearing::Core);
        }
        let at =
            |c: &&Footprint| own.at.is_near_by(c, COLUMN_M / metres) && own.at.gap(c) * metres <= COLUMN_M;
        if self.columns.iter().filter(at).count() > 1 {
            return Some(Bearing::Columns);
        }
        let floor = FLOOR_M / metres;
        let is_over = |low: f64, high: f64| (-floor / 4.0..=floor).contains(&(low - high));
        let others = self.standing.iter().filter(|(id, _)| **id != p.id);
        let stacked = others.filter(|(_, o)| {
            (is_over(own.reach[0], o.reach[1]) || is_over(o.reach[0], own.reach[1]))
                && own.at.is_near_by(&o.at, 0.0)
        });
        let stacked: Vec<&Footprint> = stacked.map(|(_, o)| &o.at).collect();
        (!stacked.is_empty() && own.at.share_in(&stacked) >= STACKED_SHARE).then_some(Bearing::Stacked)
    }
}

/// Whether a stair or a lift begins below a height, and ends no more than a storey below it.
fn is_near_height(b: &Building<'_, '_>, p: &Product, cut: f64) -> bool {
    const STOREY_M: f64 = 2.0;
    height_of(b, p).is_some_and(|[low, high]| low <= cut && high >= cut - STOREY_M / b.geo.metres)
}

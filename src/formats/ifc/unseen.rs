//! Walls of another height: what the file joins to a wall that shifts and the cut does not show goes along on its own
//! axis, as walls that are shown do by moves of their own.

use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet};

use glam::{DAffine3, DVec2};

use super::ReadOptions;
use super::length::{self, Bar};
use super::model::body_items;
use super::read::{Building, heights};
use super::step::{Arg, Step};
use crate::plan::drawing::Edit;
use crate::report::Report;

/// Walls that meet at an angle with a smaller sine do not follow each other.
const CROSSING_MIN_SIN: f64 = 0.2;

/// What must remain of a wall.
const REST_M: f64 = 0.1;

/// By the wall that shifts: unseen walls joined to it, and how far their two ends go along them, file units.
pub(super) type Tails = BTreeMap<u64, Vec<(u64, [f64; 2])>>;

/// The unseen walls that follow what edits shift. A wall that an opening is cut out of stays, and so does one that
/// would be left shorter than [`REST_M`], has no axis that says where it starts, or cannot change its length.
pub(super) fn tails(b: &Building<'_, '_>, options: &ReadOptions, edits: &[Edit]) -> Tails {
    let edited: BTreeSet<u64> = edits.iter().map(|e| e.record() as u64).collect();
    let shifts: BTreeMap<u64, DVec2> = edits.iter().filter_map(shift).collect();
    let Ok(storey) = b.storey(options.storey.as_deref(), options.sight, &mut Report::default()) else {
        return Tails::new();
    };
    let (_, cut) = heights(b, storey, options.sight);
    // By the wall that goes along: its bar, who takes it, how far its ends go.
    let mut found: BTreeMap<u64, (Bar, u64, [Option<f64>; 2])> = BTreeMap::new();
    for (wall, other, end) in joints(b.step) {
        let Some(shift) = shifts.get(&wall).filter(|_| !edited.contains(&other)) else { continue };
        let Ok(at) = length::bar(b, wall) else { continue };
        let (bar, _, ways) = match found.entry(other) {
            Entry::Occupied(entry) => entry.into_mut(),
            Entry::Vacant(entry) => match unseen(b, other, cut) {
                Some(bar) => entry.insert((bar, wall, [None; 2])),
                None => continue,
            },
        };
        let across = at.along.perp().dot(bar.along);
        if across.abs() >= CROSSING_MIN_SIN {
            ways[end].get_or_insert(shift.dot(at.along.perp()) / across);
        }
    }
    let mut out = Tails::new();
    for (id, (bar, wall, ways)) in found {
        let by = ways.map(|w| w.unwrap_or(0.0));
        let rest = bar.inner[1] + by[1] - bar.inner[0] - by[0];
        if by != [0.0; 2] && rest * b.geo.metres >= REST_M {
            out.entry(wall).or_default().push((id, by));
        }
    }
    out
}

/// A wall that is shifted and not turned, and how far.
fn shift(edit: &Edit) -> Option<(u64, DVec2)> {
    match edit {
        Edit::Insert { record, motion } if motion.turn_rad == 0.0 => Some((*record as u64, motion.shift)),
        _ => None,
    }
}

/// Walls that the file joins: a wall, and another with the one of its ends that stands there.
fn joints(step: &Step<'_>) -> Vec<(u64, u64, usize)> {
    let end =
        |arg: Option<&Arg>| ["ATSTART", "ATEND"].iter().position(|name| arg.is_some_and(|a| a.is(name)));
    let mut out = Vec::new();
    for i in step.all("IFCRELCONNECTSPATHELEMENTS") {
        let args = step.args_of(i);
        let wall = |k: usize| args.get(k).and_then(Arg::id);
        let (Some(relating), Some(related)) = (wall(5), wall(6)) else { continue };
        out.extend(end(args.get(9)).map(|e| (relating, related, e)));
        out.extend(end(args.get(10)).map(|e| (related, relating, e)));
    }
    out
}

/// How a wall without openings that the cut misses changes its length.
fn unseen(b: &Building<'_, '_>, id: u64, cut: f64) -> Option<Bar> {
    let product = b.model.product(id).filter(|p| p.class.starts_with("IfcWall"))?;
    if b.model.openings.contains_key(&id) || super::patch::refusal(b, id).is_some() {
        return None;
    }
    let world = product.placement.map_or(Ok(DAffine3::IDENTITY), |p| b.geo.placement(p)).ok()?;
    let items = body_items(b.step, product.shape?).ok()?;
    let reaches: Option<Vec<[f64; 2]>> = items.iter().map(|i| b.geo.reach(*i, &world, 0).ok()).collect();
    let is_seen = reaches?.iter().any(|[low, high]| (*low..=*high).contains(&cut));
    length::bar(b, id).ok().filter(|bar| !is_seen && bar.has_axis())
}

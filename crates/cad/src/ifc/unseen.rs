//! Walls of another height: what stands at a wall that shifts and the cut does not show goes along on its own axis, as
//! walls that are shown do by moves of their own. Walls that share no height follow where the file joins them.

use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;

use super::ReadOptions;
use super::building::{Building, refusal};
use super::footprint::{Footprint, Parting, StandingWall, parting};
use super::heights::heights;
use super::length::{self, Bar};
use super::step::{Arg, Step};
use crate::drawing::{Edit, RigidMotion};
use enfilade_report::Report;

/// Walls that meet at an angle with a smaller sine do not follow each other.
const CROSSING_MIN_SIN: f64 = 0.2;

/// Corners of an outline this near to those of an end are the same.
const END_M: f64 = 1e-5;

/// Walls bar each other where they share more than this of their heights, metres.
const BESIDE_M: f64 = 0.05;

/// What must remain of a wall.
const REST_M: f64 = 0.1;

/// An unseen wall that goes along.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tail {
    /// The wall.
    pub id: u64,
    /// How far its two ends go along it, file units.
    pub by: [f64; 2],
    /// Its outline as drawn and afterwards: the corners of its first end, then those of its second, world, file units.
    pub outlines: [Vec<DVec2>; 2],
}

/// By the wall that shifts: the unseen walls that it takes along.
pub(super) type Tails = BTreeMap<u64, Vec<Tail>>;

/// The unseen walls that edits take along, and the joints with a wall that shifts that hold so.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Taken {
    /// The walls.
    pub tails: Tails,
    /// Who shifts, and who follows it.
    held: BTreeSet<[u64; 2]>,
}

/// A joint, stated by the file or seen in the plan, between a wall that moves and one that stays and is not in the plan.
#[derive(Clone, Debug, PartialEq)]
pub struct UnseenJoint {
    /// Instance of the wall that moves.
    pub id: u64,
    /// Instance of the other one.
    pub other: u64,
    /// The storey of the other one.
    pub storey: Option<String>,
    /// What becomes of it.
    pub parting: Parting,
}

/// An unseen wall whose ends are being looked at.
struct Candidate {
    bar: Bar,
    /// The first of those that take it.
    taker: Option<u64>,
    takers: BTreeSet<u64>,
    ways: [Option<f64>; 2],
}

impl Candidate {
    /// How far its ends go along it, file units.
    fn by(&self) -> [f64; 2] {
        self.ways.map(|w| w.unwrap_or(0.0))
    }

    /// What remains of it, file units.
    fn rest(&self) -> f64 {
        let by = self.by();
        self.bar.inner[1] + by[1] - self.bar.inner[0] - by[0]
    }

    /// Whether another wall stands where it would be drawn back from, or in its way where it grows.
    fn is_barred_by(&self, other: &Footprint, metres: f64) -> bool {
        let by = self.by();
        (0..2).filter(|k| by[*k] != 0.0).any(|k| {
            let is_shorter = (by[k] > 0.0) == (k == 0);
            let is_barred = |slice: Footprint| {
                slice.is_near(other, metres)
                    && if is_shorter { other.stands_at(&slice, metres) } else { slice.runs_through(other) }
            };
            Footprint::swept(&self.bar.ends[k], self.bar.along * by[k]).is_some_and(is_barred)
        })
    }
}

/// Leaves out the walls that others bar, of the same heights: an end is never drawn back behind a wall that stands at it,
/// nor through one.
fn leave_barred(b: &Building<'_, '_>, edited: &BTreeSet<u64>, found: &mut BTreeMap<u64, Candidate>) {
    if found.is_empty() {
        return;
    }
    let is_other = |id: &u64| !edited.contains(id) && !found.contains_key(id);
    let mut others: Vec<&StandingWall> =
        b.standing().iter().filter(|(id, _)| is_other(id)).map(|(_, s)| s).collect();
    // What stays bars as well, so once more with that alone.
    while !others.is_empty() {
        let is_barred = |id: u64, one: &Candidate| {
            let Some(own) = b.standing().get(&id) else { return true };
            let is_near = |other: &StandingWall| is_level(own.reach, other.reach, b.geo.metres);
            others.iter().any(|other| is_near(other) && one.is_barred_by(&other.at, b.geo.metres))
        };
        let barred: Vec<u64> =
            found.iter().filter(|(id, one)| is_barred(**id, one)).map(|(id, _)| *id).collect();
        barred.iter().for_each(|id| drop(found.remove(id)));
        others = barred.iter().filter_map(|id| b.standing().get(id)).collect();
    }
}

/// Leaves out the walls of which an end that would go stands in a space that a mark keeps, or at its outline.
fn leave_kept(b: &Building<'_, '_>, found: &mut BTreeMap<u64, Candidate>) {
    if found.is_empty() {
        return;
    }
    let metres = b.geo.metres;
    let spaces = super::standing::kept_spaces(b);
    let holds = |space: &StandingWall, own: &StandingWall, one: &Candidate| {
        let goes = (0..2).filter(|k| one.by()[*k] != 0.0);
        is_level(space.reach, own.reach, metres)
            && goes.flat_map(|k| &one.bar.ends[k]).any(|p| space.at.holds(*p, metres))
    };
    found.retain(|id, one| {
        let own = b.standing().get(id);
        own.is_some_and(|own| !spaces.iter().any(|space| holds(space, own, one)))
    });
}

/// Whether two share enough of their heights to bar each other.
fn is_level(a: [f64; 2], b: [f64; 2], metres: f64) -> bool {
    (a[1].min(b[1]) - a[0].max(b[0])) * metres > BESIDE_M
}

/// The unseen walls that follow what edits shift: each end that stands at a wall that shifts, where the file joins both
/// or they share some height. A wall that an opening is cut out of or that a mark keeps, its own or that of a space, stays,
/// and so does one that would be left shorter than [`REST_M`], has no axis that says where it starts, cannot change its
/// length, or is barred by another.
pub(super) fn taken(b: &Building<'_, '_>, options: &ReadOptions, edits: &[Edit]) -> Taken {
    let edited: BTreeSet<u64> = edits.iter().map(|e| e.record() as u64).collect();
    let shifts: BTreeMap<u64, DVec2> = edits.iter().filter_map(shift).collect();
    let Some(cut) = cut_height(b, options) else { return Taken::default() };
    let mut found: BTreeMap<u64, Candidate> = BTreeMap::new();
    let beside = beside(b, shifts.keys().copied(), cut);
    for (wall, other, end) in joints(b.step).into_iter().chain(beside.into_iter().map(|(w, o)| (w, o, 0))) {
        let Some(shift) = shifts.get(&wall).filter(|_| !edited.contains(&other)) else { continue };
        let Ok(at) = length::bar(b, wall) else { continue };
        let one = match found.entry(other) {
            Entry::Occupied(entry) => entry.into_mut(),
            Entry::Vacant(entry) => match unseen(b, other, cut) {
                Some(bar) => {
                    entry.insert(Candidate { bar, taker: None, takers: BTreeSet::new(), ways: [None; 2] })
                }
                None => continue,
            },
        };
        let across = at.along.perp().dot(one.bar.along);
        let Some(end) = standing_end(b, wall, &one.bar, end) else { continue };
        if across.abs() >= CROSSING_MIN_SIN && one.ways[end].is_none() {
            one.ways[end] = Some(shift.dot(at.along.perp()) / across);
            one.taker.get_or_insert(wall);
            one.takers.insert(wall);
        }
    }
    found.retain(|_, c| c.by() != [0.0; 2] && c.rest() * b.geo.metres >= REST_M && c.bar.can_go(c.by()));
    leave_kept(b, &mut found);
    leave_barred(b, &edited, &mut found);
    let mut out = Taken::default();
    for (id, one) in found {
        let by = one.by();
        let Candidate { bar, taker: Some(taker), takers, .. } = one else { continue };
        let outlines = [[0.0; 2], by].map(|by| {
            let end = |k: usize| bar.ends[k].iter().map(|p| p + bar.along * by[k]).collect::<Vec<_>>();
            [end(0), end(1)].concat()
        });
        out.held.extend(takers.into_iter().map(|w| [w, id]));
        out.tails.entry(taker).or_default().push(Tail { id, by, outlines });
    }
    out
}

/// The end of a wall that stands at another: the one that the file names, else the other one.
fn standing_end(b: &Building<'_, '_>, wall: u64, bar: &Bar, stated: usize) -> Option<usize> {
    let wall = b.standing().get(&wall)?;
    [stated, 1 - stated].into_iter().find(|end| wall.at.is_at(&bar.ends[*end], b.geo.metres))
}

/// The joints with walls that the plan does not show that edits open, or of which nobody can tell, each once.
pub(super) fn left(b: &Building<'_, '_>, options: &ReadOptions, edits: &[Edit]) -> Vec<UnseenJoint> {
    let edited: BTreeSet<u64> = edits.iter().map(|e| e.record() as u64).collect();
    let ways = ways(edits);
    let Some(cut) = cut_height(b, options) else { return Vec::new() };
    let held = taken(b, options, edits).held;
    let mut out = Vec::new();
    let mut joined = stated(b.step);
    joined.extend(beside(b, ways.keys().copied(), cut));
    for (id, other) in joined {
        let Some(way) = ways.get(&id).filter(|_| !edited.contains(&other)) else { continue };
        let [from, stays] = [id, other].map(|id| b.standing().get(&id));
        if held.contains(&[id, other]) || stays.is_some_and(|s| is_cut(s.reach, cut)) {
            continue;
        }
        let parting = match (from, stays) {
            (Some(from), Some(stays)) => {
                let to = gone(b, id, &from.at, way);
                // One above the other they run through nothing.
                match parting(&from.at, &to, &stays.at, b.geo.metres) {
                    Some(Parting::Through(by_m)) if !is_level(from.reach, stays.reach, b.geo.metres) => {
                        Some(Parting::Gap(by_m))
                    }
                    parting => parting,
                }
            }
            _ => Some(Parting::Unknown),
        };
        let storey = b.storey_name(other);
        out.extend(parting.map(|parting| UnseenJoint { id, other, storey, parting }));
    }
    out
}

/// Where the storey that is read is cut.
fn cut_height(b: &Building<'_, '_>, options: &ReadOptions) -> Option<f64> {
    let storey = b.storey(options.storey.as_deref(), options.sight, &mut Report::default()).ok()?;
    Some(heights(b, storey, options.sight).1)
}

fn is_cut([low, high]: [f64; 2], cut: f64) -> bool {
    (low..=high).contains(&cut)
}

/// How what moves goes: as a whole, and its ends along it before that.
type Ways = BTreeMap<u64, (RigidMotion, [f64; 2])>;

fn ways(edits: &[Edit]) -> Ways {
    let mut out = Ways::new();
    for edit in edits {
        let still = RigidMotion { turn_rad: 0.0, shift: DVec2::ZERO };
        let (motion, ends) = out.entry(edit.record() as u64).or_insert((still, [0.0; 2]));
        match edit {
            Edit::Insert { motion: by, .. } => *motion = *by,
            Edit::Ends { by, .. } => *ends = *by,
            Edit::Shape { .. } | Edit::Points { .. } | Edit::Work { .. } => {}
        }
    }
    out
}

/// Where a wall stands afterwards.
fn gone(
    b: &Building<'_, '_>,
    id: u64,
    from: &Footprint,
    (motion, ends): &(RigidMotion, [f64; 2]),
) -> Footprint {
    let bar = length::bar(b, id).ok().filter(|_| *ends != [0.0; 2]);
    let turn = DVec2::from_angle(motion.turn_rad);
    let near = END_M / b.geo.metres;
    from.moved(|p| {
        let along = bar.iter().flat_map(|bar| {
            let is_of = |k: &usize| bar.ends[*k].iter().any(|q| q.distance(p) <= near);
            (0..2).filter(is_of).map(|k| bar.along * ends[k])
        });
        turn.rotate(p + along.sum::<DVec2>()) + motion.shift
    })
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

/// Pairs of walls that the file joins, either way round, each once.
fn stated(step: &Step<'_>) -> BTreeSet<(u64, u64)> {
    let mut out = BTreeSet::new();
    for i in step.all("IFCRELCONNECTSPATHELEMENTS") {
        let args = step.args_of(i);
        let wall = |k: usize| args.get(k).and_then(Arg::id);
        if let (Some(a), Some(b)) = (wall(5), wall(6)) {
            out.extend([(a, b), (b, a)]);
        }
    }
    out
}

/// Pairs of some walls that shift and the walls of their height that stand at them and that the cut misses, whatever
/// the file says of joints.
fn beside(b: &Building<'_, '_>, shifting: impl Iterator<Item = u64>, cut: f64) -> BTreeSet<(u64, u64)> {
    let metres = b.geo.metres;
    let meet = |a: &StandingWall, o: &StandingWall| {
        is_level(a.reach, o.reach, metres) && (o.at.stands_at(&a.at, metres) || a.at.stands_at(&o.at, metres))
    };
    let of = |id: u64| {
        let own = b.standing().get(&id);
        let others = b.standing().iter().filter(move |(other, o)| **other != id && !is_cut(o.reach, cut));
        others.filter(move |(_, o)| own.is_some_and(|a| meet(a, o))).map(move |(other, _)| (id, *other))
    };
    shifting.flat_map(of).collect()
}

/// How a wall without openings and without a mark that keeps it, which the cut misses, changes its length.
fn unseen(b: &Building<'_, '_>, id: u64, cut: f64) -> Option<Bar> {
    b.model.product(id).filter(|p| p.class.starts_with("IfcWall"))?;
    let is_held = super::marks::kept(b, id).is_some();
    if is_held || b.model.openings.contains_key(&id) || refusal(b, id).is_some() {
        return None;
    }
    let is_seen = is_cut(b.standing().get(&id)?.reach, cut);
    length::bar(b, id).ok().filter(|bar| !is_seen && bar.has_axis)
}

//! Ends of walls that change their length, on their own axes, with the wall they stand at; where the file can say so.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;

use super::Refusal;
use super::bars::{Bars, Motion, Moving};
use super::beside::{Beside, ByRecord, along};
use super::follower::Follower;
use crate::remains::{NOISE_M, REST_M};
use crate::{Slid, with_points};
use enfilade_cad::curve::control_points;
use enfilade_cad::drawing::{Editable, RigidMotion, Shape};
use enfilade_plan::Plan;
use enfilade_plan::axes::AxisGraph;
use enfilade_plan::graph::{Graph, Handle};

/// By record: how far both ends go along the wall's axis, metres.
pub(crate) type Lengths = BTreeMap<usize, [f64; 2]>;

/// What both ends of one wall do.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ends {
    /// Drawing units, positive from the first end to the second.
    pub by: [f64; 2],
    along: DVec2,
}

/// What shifts along one wall: its ends, and openings in it.
#[derive(Clone, Debug, Default)]
pub(crate) struct Along {
    /// Its ends, where its length changes.
    pub ends: Option<Ends>,
    /// Its openings that slide.
    pub slid: Vec<Slid>,
}

impl Along {
    /// A shape of the wall, moved already, with the corners of its ends and its openings shifted along it.
    pub fn applied(&self, plan: &Plan, wall: u32, motion: Option<&RigidMotion>, moved: Shape) -> Shape {
        if self.ends.is_none() && self.slid.is_empty() {
            return moved;
        }
        let turn = DVec2::from_angle(motion.map_or(0.0, |m| m.turn_rad));
        let mut points = control_points(&moved);
        if let (Some(e), Editable::Wall { ends, .. }) = (self.ends, &plan.walls[wall as usize].editable) {
            for (end, by) in ends.iter().zip(e.by) {
                end.iter().for_each(|c| points[*c as usize] += turn.rotate(e.along) * by);
            }
        }
        for s in &self.slid {
            let own = plan.slots[s.slot].jambs.iter().flatten().filter(|h| h.0 == wall);
            own.for_each(|h| points[h.1 as usize] += turn.rotate(s.shift));
        }
        with_points(&moved, &points)
    }
}

/// The ends that follow, each the first group that moves what it stands at; and both sides of openings that slide.
pub(super) fn following(
    (plan, graph, axes): (&Plan, &Graph, &AxisGraph),
    (bars, moving): (&Bars, Moving<'_>),
    is_kept: &dyn Fn(u32) -> bool,
) -> Vec<Follower> {
    let mut out: Vec<Follower> = Vec::new();
    let (ends, by_record) = (ends(plan), ByRecord::new(plan));
    let turning = turning_records(plan, moving);
    for group in 0..moving.groups.len() {
        let own = records(plan, moving, group);
        if own.iter().any(|r| turning.contains(r)) {
            continue;
        }
        let shifted = bars.list.iter().filter(|b| {
            b.motion == Motion::Rigid && b.groups[0].contains(&group) && moving.only_shifts(&b.groups[0])
        });
        let drawn = shifted.filter_map(|b| Beside::bar(plan, axes, b));
        let walls: Vec<Beside> =
            own.iter().filter_map(|r| Beside::record(&by_record, *r)).chain(drawn).collect();
        for end in ends.iter().filter(|e| !own.contains(&e.record) && !turning.contains(&e.record)) {
            if out.iter().any(|f| (f.record, f.end) == (end.record, end.end)) {
                continue;
            }
            let node = |h: &Handle| graph.control_nodes[h.0 as usize][h.1 as usize];
            if end.handles.iter().any(|h| is_kept(node(h))) {
                continue;
            }
            let at = end.corners(plan);
            let Some(wall) = walls.iter().find(|w| w.is_joined_at(&at)) else { continue };
            if wall.holds_both_ends(end, &ends, plan) {
                continue;
            }
            let follower = Follower { group, normal: wall.normal, ..end.clone() };
            if follower.is_moved(moving) {
                out.push(follower);
            }
        }
    }
    out.extend((0..moving.groups.len()).flat_map(|g| sides_of(plan, moving, g)));
    out
}

/// The last group of those that together draw an end back behind a part of its wall's body that stays.
pub(super) fn too_far(plan: &Plan, followers: &[Follower], moving: Moving<'_>) -> Option<Refusal> {
    for wall in &plan.walls {
        let Editable::Wall { free, .. } = &wall.editable else { continue };
        let free_m = free.map(|way| way * plan.frame.metres_per_unit - REST_M * plan.human_scale);
        let mut inward = [0.0; 2];
        for f in followers.iter().filter(|f| f.record == wall.source.record) {
            inward[f.end] += worst(f, moving);
            if inward[f.end] > free_m[f.end].max(0.0) + NOISE_M {
                let why = format!(
                    "would leave less than {REST_M} m of the wall #{} between its joints and openings",
                    wall.source.record
                );
                return Some(Refusal { group: f.group, why });
            }
        }
    }
    None
}

/// What the ends of a wall and its openings do.
pub(super) fn along_of(plan: &Plan, followers: &[Follower], wall: u32, lengths: &Lengths) -> Along {
    let (record, per_m) = (plan.walls[wall as usize].source.record, 1.0 / plan.frame.metres_per_unit);
    let of = |record: usize| {
        let by = lengths.get(&record)?.map(|m| m * per_m);
        let along = followers.iter().find(|f| f.record == record)?.along;
        (by != [0.0; 2]).then_some(Ends { by, along })
    };
    let own = plan.slots.iter().enumerate().filter(|(_, s)| s.host == record);
    let slid = own.filter_map(|(slot, s)| {
        let Ends { by, along } = of(s.source.record)?;
        Some(Slid { slot, shift: along * by[0] })
    });
    Along { ends: of(record), slid: slid.collect() }
}

/// How far into its own wall an end goes at most.
fn worst(f: &Follower, moving: Moving<'_>) -> f64 {
    let inward = if f.end == 0 { 1.0 } else { -1.0 };
    let of = |(direction, ends): (DVec2, [f64; 2])| {
        ends.map(|v| inward * f.way(direction * v)).into_iter().fold(0.0, f64::max)
    };
    moving.shifts(f.group).map(of).sum()
}

/// Records of the walls that a group moves.
fn records(plan: &Plan, moving: Moving<'_>, group: usize) -> BTreeSet<usize> {
    let walls = moving.groups[group].handles.iter().map(|h| &plan.walls[h.0 as usize]);
    walls.filter(|w| w.editable.moves_whole()).map(|w| w.source.record).collect()
}

/// All ends of walls that can change their length, in the order of their records, as followers of nobody.
fn ends(plan: &Plan) -> Vec<Follower> {
    let mut by_record: BTreeMap<usize, Vec<u32>> = BTreeMap::new();
    for (w, wall) in plan.walls.iter().enumerate() {
        if matches!(wall.editable, Editable::Wall { .. }) {
            by_record.entry(wall.source.record).or_default().push(w as u32);
        }
    }
    let of = |(record, walls): (usize, Vec<u32>)| {
        let along = along(plan, &walls);
        let mut ends: [Vec<Handle>; 2] = Default::default();
        for w in walls {
            let Editable::Wall { ends: own, .. } = &plan.walls[w as usize].editable else { continue };
            for (list, corners) in ends.iter_mut().zip(own) {
                list.extend(corners.iter().map(|c| (w, *c)));
            }
        }
        let one = move |(end, handles): (usize, Vec<Handle>)| {
            let along = along.filter(|_| !handles.is_empty())?;
            Some(Follower { group: 0, record, end, handles, along, normal: DVec2::ZERO })
        };
        ends.into_iter().enumerate().filter_map(one)
    };
    by_record.into_iter().flat_map(of).collect()
}

/// Both sides of the openings that a group slides; they go as it does.
fn sides_of(plan: &Plan, moving: Moving<'_>, group: usize) -> impl Iterator<Item = Follower> {
    let slots = moving.groups[group].slots.iter().map(|s| &plan.slots[*s]);
    slots.flat_map(move |s| {
        (0..2).map(move |end| Follower {
            group,
            record: s.source.record,
            end,
            handles: s.jambs[end].clone(),
            along: s.along,
            normal: s.along,
        })
    })
}

/// Records of walls that turn: their axes are no guide.
fn turning_records(plan: &Plan, moving: Moving<'_>) -> BTreeSet<usize> {
    let turns = |g: &usize| !moving.only_shifts(&[*g]);
    (0..moving.groups.len()).filter(turns).flat_map(|g| records(plan, moving, g)).collect()
}

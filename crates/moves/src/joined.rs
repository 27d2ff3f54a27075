//! Walls that end at a wall that shifts go along with it on their own axes, so that the joint holds (spec 1), where
//! the file lets them change their length.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;

use super::bars::Moving;
use super::followed::{ByRecord, Followed, Follower, direction_of, ends, records, worst};
use super::mitre::Refusal;
use super::remains::REST_M;
use super::{Slid, with_points};
use enfilade_cad::curve::control_points;
use enfilade_cad::drawing::{Editable, RigidMotion, Shape};
use enfilade_plan::Plan;
use enfilade_plan::graph::{Graph, Handle};

/// By record: how far both ends go along the wall's axis, metres.
pub(super) type Lengths = BTreeMap<usize, [f64; 2]>;

/// All ends that follow.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Joined {
    followers: Vec<Follower>,
}

/// What both ends of one wall do.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ends {
    /// Drawing units, positive from the first end to the second.
    pub by: [f64; 2],
    along: DVec2,
}

/// What goes along one wall: its ends, and openings in it.
#[derive(Clone, Debug, Default)]
pub(super) struct Along {
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

impl Joined {
    /// Finds the ends that follow.
    ///
    /// # Errors
    /// The first group within whose bounds a wall would grow too short.
    pub fn new(
        plan: &Plan,
        moving: Moving<'_>,
        is_kept: &dyn Fn(u32) -> bool,
        graph: &Graph,
    ) -> Result<Self, Refusal> {
        let mut out = Self::default();
        if moving.groups.is_empty() {
            return Ok(out);
        }
        let (ends, by_record) = (ends(plan), ByRecord::new(plan));
        let turning = turning_records(plan, moving);
        for group in 0..moving.groups.len() {
            let own = records(plan, moving, group);
            if own.iter().any(|r| turning.contains(r)) {
                continue;
            }
            let walls: Vec<Followed> = own.iter().filter_map(|r| Followed::new(&by_record, *r)).collect();
            for end in ends.iter().filter(|e| !own.contains(&e.record) && !turning.contains(&e.record)) {
                if out.followers.iter().any(|f| (f.record, f.end) == (end.record, end.end)) {
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
                    out.followers.push(follower);
                }
            }
        }
        out.followers.extend((0..moving.groups.len()).flat_map(|g| sides_of(plan, moving, g)));
        match out.too_far(plan, moving) {
            Some(refusal) => Err(refusal),
            None => Ok(out),
        }
    }

    /// The ends that follow one group.
    pub fn of_group(&self, group: usize) -> impl Iterator<Item = &Follower> {
        self.followers.iter().filter(move |f| f.group == group)
    }

    /// All control points of ends that follow.
    pub fn handles(&self) -> impl Iterator<Item = &Handle> {
        self.followers.iter().flat_map(|f| &f.handles)
    }

    /// What the ends of a wall and its openings do.
    pub fn along_of(&self, plan: &Plan, wall: u32, lengths: &Lengths) -> Along {
        let (record, per_m) = (plan.walls[wall as usize].source.record, 1.0 / plan.frame.metres_per_unit);
        let of = |record: usize| {
            let by = lengths.get(&record)?.map(|m| m * per_m);
            let along = self.followers.iter().find(|f| f.record == record)?.along;
            (by != [0.0; 2]).then_some(Ends { by, along })
        };
        let own = plan.slots.iter().enumerate().filter(|(_, s)| s.host == record);
        let slid = own.filter_map(|(slot, s)| {
            let Ends { by, along } = of(s.source.record)?;
            Some(Slid { slot, shift: along * by[0] })
        });
        Along { ends: of(record), slid: slid.collect() }
    }

    /// The last group of those that together draw an end back behind a part of its wall's body that stays.
    fn too_far(&self, plan: &Plan, moving: Moving<'_>) -> Option<Refusal> {
        for wall in &plan.walls {
            let Editable::Wall { free, .. } = &wall.editable else { continue };
            let free_m = free.map(|way| way * plan.frame.metres_per_unit - REST_M * plan.human_scale);
            let mut inward = [0.0; 2];
            for f in self.followers.iter().filter(|f| f.record == wall.source.record) {
                inward[f.end] += worst(f, moving);
                if inward[f.end] > 0.0 && inward[f.end] > free_m[f.end].max(0.0) {
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
    let turns = |g: &usize| {
        let mut own = moving.parameters.iter().filter(|p| p.group == *g);
        own.any(|p| direction_of(p.clause.kind).is_none())
    };
    (0..moving.groups.len()).filter(turns).flat_map(|g| records(plan, moving, g)).collect()
}

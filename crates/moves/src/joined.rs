//! Walls that end at a wall that shifts go along with it on their own axes, so that the joint holds (spec 1), where
//! the file lets them change their length.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;

use super::bars::Moving;
use super::followed::{ByRecord, Followed, Follower, REST_M, direction_of, ends, records, rooms, worst};
use super::mitre::Refusal;
use super::{Slid, with_points};
use enfilade_cad::curve::control_points;
use enfilade_cad::drawing::{Editable, RigidMotion, Shape};
use enfilade_plan::Plan;
use enfilade_plan::graph::{Graph, Handle};
use enfilade_plan::markers::Clause;

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
        let parted = || super::abutting::parted(plan, &by_record, &out.followers, moving);
        match out.too_short(plan, moving).or_else(parted) {
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

    /// What goes along walls by a shift that is one parameter's.
    pub fn goers(&self, plan: &Plan, clause: &Clause) -> Vec<Goer> {
        let Some(direction) = direction_of(clause.kind) else { return Vec::new() };
        let goer = |f: &Follower| {
            let slot = plan.slots.iter().find(|s| s.source.record == f.record);
            Goer {
                host: slot.map_or(f.record, |s| s.host),
                corners: f.corners(plan).into_iter().map(|p| plan.frame.plan_from_um(p)).collect(),
                along: f.along,
                per_unit: f.way(direction * clause.si_per_unit),
                is_side: slot.is_some(),
            }
        };
        self.followers.iter().map(goer).collect()
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

    /// The last group of those that together leave too little of a wall.
    fn too_short(&self, plan: &Plan, moving: Moving<'_>) -> Option<Refusal> {
        for wall in plan.walls.iter().filter(|w| matches!(w.editable, Editable::Wall { .. })) {
            let mut inward = [0.0; 2];
            for f in self.followers.iter().filter(|f| f.record == wall.source.record) {
                let rooms = rooms(plan, wall, f.along);
                inward[f.end] += worst(f, moving);
                let is_short =
                    |room: Option<f64>, taken: f64| room.is_some_and(|r| taken > (r - REST_M).max(0.0));
                let alone = is_short(rooms.ends[f.end], inward[f.end]);
                let together = is_short(rooms.whole, inward[0] + inward[1]);
                if inward[f.end] > 0.0 && (alone || together) {
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

/// A corner set that one parameter takes along a wall: an end of the wall, or a side of an opening in it.
#[derive(Clone, Debug)]
pub(super) struct Goer {
    /// Record of the wall.
    host: usize,
    corners: Vec<DVec2>,
    along: DVec2,
    /// How far it goes along the wall for one unit of its parameter, metres.
    per_unit: f64,
    is_side: bool,
}

impl Goer {
    /// Within what bounds its parameter keeps enough of the wall between it and another one, whose parameter has some
    /// bounds of its own.
    pub fn kept_from(&self, [lower, upper]: [f64; 2], other: &Self, theirs: [f64; 2]) -> [f64; 2] {
        let places = |g: &Self| {
            let of = g.corners.iter().map(|p| p.dot(self.along));
            of.fold([f64::MAX, f64::MIN], |[l, h], v| [l.min(v), h.max(v)])
        };
        if self.host != other.host || !(self.is_side || other.is_side) {
            return [lower, upper];
        }
        let ([low, high], [other_low, other_high]) = (places(self), places(other));
        let is_before = other_low > high;
        let (gap, toward) = if is_before { (other_low - high, 1.0) } else { (low - other_high, -1.0) };
        let comes = -toward * other.per_unit * other.along.dot(self.along).signum();
        let comes = theirs.map(|v| v * comes).into_iter().fold(0.0, f64::max);
        let room = (gap - REST_M - comes).max(0.0);
        let per_unit = self.per_unit * toward;
        let within = |v: f64| if v * per_unit > room { room / per_unit } else { v };
        [within(lower), within(upper)]
    }
}

/// Records of walls that turn: their axes are no guide.
fn turning_records(plan: &Plan, moving: Moving<'_>) -> BTreeSet<usize> {
    let turns = |g: &usize| {
        let mut own = moving.parameters.iter().filter(|p| p.group == *g);
        own.any(|p| direction_of(p.clause.kind).is_none())
    };
    (0..moving.groups.len()).filter(turns).flat_map(|g| records(plan, moving, g)).collect()
}

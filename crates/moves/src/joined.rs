//! One graph of what follows a wall that moves (spec 1), however each wall is drawn: corners of walls drawn point by point
//! stay on the faces that meet in them, ends of walls that change their length as bodies stay at the wall they stand at.

mod bars;
mod beside;
mod corners;
mod ends;
mod follower;

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;

pub(super) use bars::{Moving, shift_of};
pub(super) use beside::{JOINT_M, SIDE_SIN, along};
pub(super) use ends::Along;

use bars::{Bar, Bars};
use corners::{Corner, Finder, Turn, cannot_follow, kept_words, too_acute};
use ends::Lengths;
use enfilade_plan::Plan;
use enfilade_plan::axes::{AxisGraph, FaceRef};
use enfilade_plan::graph::{Graph, Handle};
use enfilade_plan::structure::face_handles;
use follower::Follower;

/// Walls that meet at less than this angle are not mitred: the mitre would run far beyond the joint.
pub const CROSSING_MIN_RAD: f64 = 0.21;

/// Control points by wall, plan frame, metres.
type Places = BTreeMap<u32, Vec<DVec2>>;

/// What keeps walls thick and joined.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Joined {
    bars: Vec<Bar>,
    corners: Vec<Corner>,
    /// The drawn pieces of bars with such corners.
    faces: Vec<([Handle; 2], usize)>,
    /// Ends of bodies.
    ends: Vec<Follower>,
    /// Control points that follow although no group holds them.
    followers: BTreeSet<Handle>,
    /// Walls with a corner that would have to follow and cannot be written.
    pub stuck: Vec<Stuck>,
}

/// A wall with a corner that would have to follow.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Stuck {
    /// Index into [`Plan::walls`].
    pub wall: u32,
    /// Whether what it is joined to may turn, or change its length unevenly; else it shifts alone.
    pub turns: bool,
    /// What that one may do, in a word: turn or shift.
    pub may: &'static str,
    /// Why it cannot follow.
    pub why: String,
}

/// Why a group cannot move as it says.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Refusal {
    /// The group.
    pub group: usize,
    /// In plain words.
    pub why: String,
}

/// Where one layout puts what follows.
#[derive(Clone, Debug)]
pub(super) struct Stand {
    /// Ends of the bars, plan frame, metres; none where no corner follows.
    bars: Vec<[DVec2; 2]>,
    /// How far ends of bodies went.
    lengths: Lengths,
}

impl Joined {
    /// Finds all that needs more than its group's own motion. `is_kept`: whether a node of the graph stays.
    ///
    /// # Errors
    /// The first group that moves a wall meeting another at less than [`CROSSING_MIN_RAD`], or within whose bounds a body
    /// would grow too short.
    pub fn new(
        (plan, graph, axes): (&Plan, &Graph, &AxisGraph),
        moving: Moving<'_>,
        is_kept: &dyn Fn(u32) -> bool,
    ) -> Result<Self, Refusal> {
        if moving.groups.is_empty() {
            return Ok(Self::default());
        }
        let bars = Bars::new(plan, axes, moving);
        let ends = ends::following((plan, graph, axes), (&bars, moving), is_kept);
        if let Some(refusal) = ends::too_far(plan, &ends, moving) {
            return Err(refusal);
        }
        let followers = ends.iter().flat_map(|f| f.handles.iter().copied()).collect();
        let mut out = Self { ends, followers, ..Self::default() };
        out.take_corners(&Finder { plan, graph, axes, moving, bars: &bars }, is_kept)?;
        let cornered: BTreeSet<usize> = out.corners.iter().flat_map(|c| c.rule.bars()).collect();
        let faces = bars.of_face.iter().filter(|(_, b)| cornered.contains(b));
        let ends = |(f, b): (&FaceRef, &usize)| Some((face_handles(plan, *f).try_into().ok()?, *b));
        out.faces = faces.filter_map(ends).collect();
        out.bars = bars.list;
        Ok(out)
    }

    fn take_corners(&mut self, finder: &Finder<'_>, is_kept: &dyn Fn(u32) -> bool) -> Result<(), Refusal> {
        let plan = finder.plan;
        let of_bodies = self.followers.clone();
        for node in finder.nodes() {
            let Some(rule) = finder.rule(node)? else { continue };
            let mut handles = Vec::new();
            for h in &finder.graph.handles[node as usize] {
                let is_own = !finder.moving.of(h).is_empty();
                let why = is_kept(node).then(|| kept_words(plan).into()).or_else(|| cannot_follow(plan, *h));
                match why {
                    Some(_) if is_own || of_bodies.contains(h) => {}
                    Some(why) => {
                        let (turns, may) = (finder.turns(rule), finder.may(rule));
                        self.stuck.push(Stuck { wall: h.0, turns, may, why });
                    }
                    None => {
                        handles.push(*h);
                        if !is_own {
                            self.followers.insert(*h);
                        }
                    }
                }
            }
            if !handles.is_empty() {
                self.corners.push(Corner { handles, rule });
            }
        }
        self.stuck.sort();
        self.stuck.dedup();
        Ok(())
    }

    /// Control points that follow although no group holds them, ascending.
    pub fn followers(&self) -> impl Iterator<Item = &Handle> {
        self.followers.iter()
    }

    /// As drawn.
    pub fn drawn(&self) -> Stand {
        let is_idle = self.corners.is_empty();
        let bars = if is_idle { Vec::new() } else { self.bars.iter().map(|b| b.ends).collect() };
        Stand { bars, lengths: Lengths::default() }
    }

    /// Goes one step with a group: the ends of bars that it holds, and the ends of bodies that follow it.
    pub fn step(
        &self,
        stand: &mut Stand,
        at: &mut Places,
        (group, shift): (usize, DVec2),
        step: impl Fn(DVec2) -> DVec2,
    ) {
        for (bar, ends) in self.bars.iter().zip(&mut stand.bars) {
            for (groups, end) in bar.groups.iter().zip(ends) {
                if groups.contains(&group) {
                    *end = step(*end);
                }
            }
        }
        for follower in self.ends.iter().filter(|f| f.group == group) {
            let way = follower.way(shift);
            stand.lengths.entry(follower.record).or_default()[follower.end] += way;
            for (w, c) in &follower.handles {
                if let Some(points) = at.get_mut(w) {
                    points[*c as usize] += follower.along * way;
                }
            }
        }
    }

    /// Puts every corner on its faces, after all steps. `start`: as drawn.
    pub fn place(&self, stand: &Stand, start: &Places, at: &mut Places) {
        for corner in &self.corners {
            let has_moved = |b: &usize| stand.bars[*b] != self.bars[*b].ends;
            if !corner.rule.bars().iter().any(has_moved) {
                continue;
            }
            for (w, c) in &corner.handles {
                if let (Some(from), Some(to)) = (start.get(w), at.get_mut(w)) {
                    to[*c as usize] = corner.rule.moved(&self.bars, from[*c as usize], &stand.bars);
                }
            }
        }
    }

    /// What the ends of a wall and its openings do.
    pub fn along_of(&self, plan: &Plan, wall: u32, stand: &Stand) -> Along {
        ends::along_of(plan, &self.ends, wall, &stand.lengths)
    }

    /// Why a layout cannot be built: walls that meet at too small an angle, a face turned end for end.
    pub fn trouble(&self, stand: &Stand, start: &Places, at: &Places) -> Option<String> {
        if self.corners.iter().any(|c| c.rule.is_acute(&self.bars, &stand.bars)) {
            return Some(too_acute());
        }
        let is_reversed = |(handles, b): &([Handle; 2], usize)| {
            let find = |of: &Places| {
                let [p, q] = handles.map(|h| Some(of.get(&h.0)?[h.1 as usize]));
                Some(q? - p?)
            };
            let (Some(drawn), Some(now)) = (find(start), find(at)) else { return false };
            let turn = Turn::new(&self.bars[*b], stand.bars[*b]);
            drawn != DVec2::ZERO && now.dot(turn.turned(drawn)) <= 0.0
        };
        let is_short = self.faces.iter().any(is_reversed);
        is_short.then(|| "would make a wall shorter than its joints need".into())
    }
}

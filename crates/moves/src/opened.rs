//! Joints that a layout opens: what stood at a wall and does not follow it.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;

use super::joined::JOINT_M;
use super::struck::box_of;
use super::{Layout, MovedWall, Moves};
use enfilade_cad::drawing::{Format, RigidMotion};
use enfilade_cad::plane::distance_to_segment;
use enfilade_engine::geometry::{PointUm, Side, UM_PER_M, segments_touch, side_of_ring};
use enfilade_plan::curve::Trace;
use enfilade_plan::{Plan, Plug};

/// A joint counts as opened where its walls part by more than this, metres: less is rounding and mitres.
pub const OPEN_M: f64 = 0.01;

/// Lines of a drawing that are nearer meet, metres.
const MEETING_M: f64 = 0.002;

/// A joint that no longer holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Opened {
    /// Record of a wall that moves.
    pub record: usize,
    /// Record of the wall it was joined to.
    pub other: usize,
    /// How far the end that stood at the other wall is from it, metres.
    pub by_m: f64,
    /// Whether that end now stands beyond the other wall, which runs through; else there is a gap.
    pub is_through: bool,
}

/// What a record is drawn with: its walls, and what closes its openings.
#[derive(Clone, Debug, Default)]
struct Member {
    walls: Vec<u32>,
    plugs: Vec<usize>,
}

/// A corner of one of two records that stands at the other.
#[derive(Clone, Debug)]
struct Contact {
    /// Whose corner it is, of the two.
    of: usize,
    /// Which of its outlines, and which point of that.
    at: (usize, usize),
    was_m: f64,
}

/// Two records that are joined as drawn, of which one may move.
#[derive(Clone, Debug)]
struct Joint {
    records: [usize; 2],
    contacts: Vec<Contact>,
}

/// The joints of a plan that a move could open.
#[derive(Clone, Debug, Default)]
pub struct Joints {
    members: BTreeMap<usize, Member>,
    joints: Vec<Joint>,
}

/// Outlines of records as they stand.
type Outlines<'a> = BTreeMap<usize, Vec<Cow<'a, Trace>>>;

impl Joints {
    /// Those at the walls that may move.
    pub fn new(plan: &Plan, moves: &Moves) -> Self {
        let mut members: BTreeMap<usize, Member> = BTreeMap::new();
        for (w, wall) in plan.walls.iter().enumerate() {
            members.entry(wall.source.record).or_default().walls.push(w as u32);
        }
        for (p, plug) in plan.plugs.iter().enumerate() {
            if let Some(member) = members.get_mut(&plug.host) {
                member.plugs.push(p);
            }
        }
        let moving: BTreeSet<usize> =
            moves.walls.iter().map(|w| plan.walls[*w as usize].source.record).collect();
        let drawn: Outlines<'_> = members.iter().map(|(r, m)| (*r, m.outlines(plan, None))).collect();
        let boxes: BTreeMap<usize, [PointUm; 2]> = drawn
            .iter()
            .filter_map(|(r, outlines)| {
                Some((*r, box_of(outlines.iter().flat_map(|t| t.points.iter().copied()))?))
            })
            .collect();
        // Lines of a drawing meet in their points; the faces of a thin wall are no joint.
        let near_m = if plan.format == Format::Dxf { MEETING_M } else { JOINT_M };
        let near_um = (near_m * UM_PER_M) as i64;
        let mut joints = Vec::new();
        for (record, own) in moving.iter().filter_map(|r| Some((*r, boxes.get(r)?))) {
            for (other, at) in
                boxes.iter().filter(|(o, _)| **o != record && !(moving.contains(o) && **o < record))
            {
                let is_near =
                    (0..2).all(|k| own[0][k] - near_um <= at[1][k] && at[0][k] - near_um <= own[1][k]);
                let records = [record, *other];
                let contacts = if is_near { contacts(plan, records, &drawn, near_m) } else { Vec::new() };
                if !contacts.is_empty() {
                    joints.push(Joint { records, contacts });
                }
            }
        }
        let joined: BTreeSet<usize> = joints.iter().flat_map(|j| j.records).collect();
        members.retain(|record, _| joined.contains(record));
        Self { members, joints }
    }

    /// The joints that a layout opens, each once.
    pub fn opened(&self, plan: &Plan, layout: &Layout) -> Vec<Opened> {
        let changed: BTreeMap<u32, &MovedWall> =
            layout.walls.iter().filter(|w| w.is_changed).map(|w| (w.wall, w)).collect();
        let moved: BTreeSet<usize> = changed.keys().map(|w| plan.walls[*w as usize].source.record).collect();
        let is_moved = |j: &&Joint| j.records.iter().any(|r| moved.contains(r));
        let mut now: Outlines<'_> = Outlines::new();
        for record in self.joints.iter().filter(is_moved).flat_map(|j| j.records) {
            let Some(member) = self.members.get(&record) else { continue };
            now.entry(record).or_insert_with(|| member.outlines(plan, Some(&changed)));
        }
        self.joints.iter().filter(is_moved).filter_map(|j| j.opened(plan, &now)).collect()
    }

    /// By how much a layout opens joints, metres in all.
    pub fn opened_m(&self, plan: &Plan, layout: &Layout) -> f64 {
        self.opened(plan, layout).iter().map(|o| o.by_m).sum()
    }
}

impl Member {
    fn outlines<'a>(
        &self,
        plan: &'a Plan,
        changed: Option<&BTreeMap<u32, &'a MovedWall>>,
    ) -> Vec<Cow<'a, Trace>> {
        let moved = |w: &u32| changed.and_then(|c| c.get(w).copied());
        let motion = self.walls.iter().filter_map(moved).find_map(|m| m.motion);
        let slid = |slot: usize| {
            self.walls
                .iter()
                .filter_map(moved)
                .flat_map(|m| &m.slid)
                .find(|s| s.slot == slot)
                .map(|s| s.shift)
        };
        let wall = |w: &u32| Cow::Borrowed(moved(w).map_or(&plan.walls[*w as usize].trace, |m| &m.trace));
        let plug = |p: &usize| {
            let Plug { outline: drawn, slot, .. } = &plan.plugs[*p];
            super::after_sliding(motion, slot.and_then(slid))
                .as_ref()
                .map_or(Cow::Borrowed(drawn), |m| Cow::Owned(after(plan, drawn, m)))
        };
        self.walls.iter().map(wall).chain(self.plugs.iter().map(plug)).collect()
    }
}

/// The corners of either record that stand at the other as drawn.
fn contacts(plan: &Plan, records: [usize; 2], drawn: &Outlines<'_>, near_m: f64) -> Vec<Contact> {
    let sides = records.map(|r| drawn.get(&r).map_or(&[][..], Vec::as_slice));
    let mut out = Vec::new();
    for (of, (own, other)) in [(sides[0], sides[1]), (sides[1], sides[0])].into_iter().enumerate() {
        for (i, outline) in own.iter().enumerate() {
            for (j, p) in outline.points.iter().enumerate() {
                let was_m = distance(plan, *p, other);
                if was_m <= near_m {
                    out.push(Contact { of, at: (i, j), was_m });
                }
            }
        }
    }
    out
}

impl Joint {
    /// By how much it is open now, if it is.
    fn opened(&self, plan: &Plan, now: &Outlines<'_>) -> Option<Opened> {
        let [own, other] = self.records.map(|r| now.get(&r).map_or(&[][..], Vec::as_slice));
        let mut best: Option<f64> = None;
        for c in &self.contacts {
            let (from, to) = if c.of == 0 { (own, other) } else { (other, own) };
            let p = from.get(c.at.0)?.points.get(c.at.1)?;
            let is = distance(plan, *p, to);
            if is <= JOINT_M.max(c.was_m + OPEN_M) {
                return None;
            }
            best = Some(best.map_or(is, |b| b.min(is)));
        }
        let [record, other_record] = self.records;
        let is_through = gap(plan, own, other) <= JOINT_M;
        best.map(|by_m| Opened { record, other: other_record, by_m, is_through })
    }
}

/// A trace after a rigid motion in drawing units.
fn after(plan: &Plan, trace: &Trace, motion: &RigidMotion) -> Trace {
    let turn = DVec2::from_angle(motion.turn_rad);
    let go = |p: &PointUm| plan.frame.um_from_file(turn.rotate(plan.frame.file_from_um(*p)) + motion.shift);
    Trace { points: trace.points.iter().map(go).collect(), ..trace.clone() }
}

/// How near two records come to each other now: 0 where one reaches into the other.
fn gap(plan: &Plan, a: &[Cow<'_, Trace>], b: &[Cow<'_, Trace>]) -> f64 {
    let touch = a
        .iter()
        .flat_map(|t| t.segments())
        .any(|(.., s)| b.iter().flat_map(|t| t.segments()).any(|(.., o)| segments_touch(s, o)));
    if touch {
        return 0.0;
    }
    let nearest = |from: &[Cow<'_, Trace>], to: &[Cow<'_, Trace>]| {
        let points = from.iter().flat_map(|t| &t.points);
        points.map(|p| distance(plan, *p, to)).fold(f64::INFINITY, f64::min)
    };
    nearest(a, b).min(nearest(b, a))
}

/// How far a point is from the outlines of one record, metres; 0 within it, an outline within another being a hole.
fn distance(plan: &Plan, p: PointUm, outlines: &[Cow<'_, Trace>]) -> f64 {
    let at = |p: PointUm| plan.frame.plan_from_um(p);
    let holds = |t: &&Cow<'_, Trace>| t.is_closed && side_of_ring(&t.points, p) == Side::Inside;
    if outlines.iter().filter(holds).count() % 2 == 1 {
        return 0.0;
    }
    let to = |t: &Cow<'_, Trace>| {
        let ways = t.segments().map(|(.., s)| distance_to_segment(at(p), [at(s.a), at(s.b)]));
        ways.fold(f64::INFINITY, f64::min)
    };
    outlines.iter().map(to).fold(f64::INFINITY, f64::min)
}

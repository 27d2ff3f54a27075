//! Walls that follow a moving one by their ends: by record, and how far each is off its own line.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;

use super::bars::Moving;
use super::mitre::CROSSING_MIN_RAD;
use enfilade_cad::curve::control_points;
use enfilade_cad::drawing::Editable;
use enfilade_engine::geometry::{PointUm, Segment, UM_PER_M};
use enfilade_plan::graph::Handle;
use enfilade_plan::markers::Kind;
use enfilade_plan::{Plan, Plug, Wall};

/// An end of a wall this near to another wall is joined to it.
pub(super) const JOINT_M: f64 = 0.02;

/// Pieces whose direction differs by more than this sine from that of their wall are no sides of it.
pub(super) const SIDE_SIN: f64 = 0.02;

/// An end that goes less far than this share of a shift stays.
const STILL: f64 = 1e-6;

/// An end of a wall that follows a group.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Follower {
    /// The group that it follows.
    pub group: usize,
    /// Record of its wall.
    pub record: usize,
    /// Which of its two ends.
    pub end: usize,
    /// The control points of that end.
    pub handles: Vec<Handle>,
    /// Unit vector along its wall, from the first end to the second, plan frame.
    pub along: DVec2,
    /// Unit normal of the wall that is followed.
    pub normal: DVec2,
}

/// Outlines and plugs of a plan by the record of their wall.
pub(super) struct ByRecord<'p> {
    walls: BTreeMap<usize, Vec<&'p Wall>>,
    plugs: BTreeMap<usize, Vec<&'p Plug>>,
}

impl<'p> ByRecord<'p> {
    /// Of all walls.
    pub fn new(plan: &'p Plan) -> Self {
        let mut out = Self { walls: BTreeMap::new(), plugs: BTreeMap::new() };
        plan.walls.iter().for_each(|w| out.walls.entry(w.source.record).or_default().push(w));
        plan.plugs.iter().for_each(|p| out.plugs.entry(p.host).or_default().push(p));
        out
    }

    /// Outlines of a wall.
    pub fn walls(&self, record: usize) -> impl Iterator<Item = &'p Wall> {
        self.walls.get(&record).into_iter().flatten().copied()
    }

    /// What closes the openings of a wall.
    pub fn plugs(&self, record: usize) -> impl Iterator<Item = &'p Plug> {
        self.plugs.get(&record).into_iter().flatten().copied()
    }
}

impl Follower {
    /// How far the end goes along its own wall where the wall it ends at shifts: its face stays on the other's.
    pub fn way(&self, shift: DVec2) -> f64 {
        let across = self.normal.dot(self.along);
        if across.abs() < CROSSING_MIN_RAD.sin() {
            return shift.dot(self.along);
        }
        shift.dot(self.normal) / across
    }

    /// Where its control points stand.
    pub fn corners(&self, plan: &Plan) -> Vec<PointUm> {
        let at = |h: &Handle| control_points(&plan.walls[h.0 as usize].shape)[h.1 as usize];
        self.handles.iter().map(|h| plan.frame.um_from_file(at(h))).collect()
    }

    /// Whether its group ever shifts it.
    pub fn is_moved(&self, moving: Moving<'_>) -> bool {
        let own = moving.parameters.iter().filter(|p| p.group == self.group);
        own.filter_map(|p| direction_of(p.clause.kind)).any(|d| self.way(d).abs() > STILL)
    }
}

/// How far into its own wall an end goes at most.
pub(super) fn worst(f: &Follower, moving: Moving<'_>) -> f64 {
    let inward = if f.end == 0 { 1.0 } else { -1.0 };
    let of = |p: &super::Parameter| {
        let Some(direction) = direction_of(p.clause.kind) else { return 0.0 };
        let way = |v: f64| inward * f.way(direction * (v * p.clause.si_per_unit));
        way(p.clause.lower).max(way(p.clause.upper)).max(0.0)
    };
    moving.parameters.iter().filter(|p| p.group == f.group).map(of).sum()
}

/// The direction of a shift.
pub(super) fn direction_of(kind: Kind) -> Option<DVec2> {
    match kind {
        Kind::X => Some(DVec2::X),
        Kind::Y => Some(DVec2::Y),
        Kind::Along(angle) => Some(DVec2::from_angle(angle)),
        Kind::Rotate(_) | Kind::Scale(_) => None,
    }
}

/// Records of the walls that a group moves.
pub(super) fn records(plan: &Plan, moving: Moving<'_>, group: usize) -> BTreeSet<usize> {
    let walls = moving.groups[group].handles.iter().map(|h| &plan.walls[h.0 as usize]);
    walls.filter(|w| w.editable.moves_whole()).map(|w| w.source.record).collect()
}

/// All ends of walls that can change their length, in the order of their records, as followers of nobody.
pub(super) fn ends(plan: &Plan) -> Vec<Follower> {
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

/// A wall that others may be joined to, by its sides.
pub(super) struct Followed {
    pieces: Vec<Segment>,
    /// Lowest and highest coordinates that are near enough to be joined, micrometres.
    box_um: [[i64; 2]; 2],
    /// Unit normal, plan frame.
    pub normal: DVec2,
}

impl Followed {
    /// The outlines of a record.
    pub fn new(by_record: &ByRecord<'_>, record: usize) -> Option<Self> {
        // A door at its end stands between it and what ends there.
        let plugs = by_record.plugs(record).map(|p| &p.outline);
        let own = by_record.walls(record).map(|w| &w.trace);
        let pieces: Vec<Segment> = own.chain(plugs).flat_map(|t| t.segments().map(|s| s.2)).collect();
        let run = |s: &Segment| DVec2::new((s.b[0] - s.a[0]) as f64, (s.b[1] - s.a[1]) as f64);
        let longest = pieces.iter().map(run).max_by(|a, b| a.length().total_cmp(&b.length()))?;
        // What touches the end of a wall is what that wall ends at.
        let is_side =
            |s: &Segment| run(s).perp_dot(longest).abs() <= SIDE_SIN * run(s).length() * longest.length();
        let pieces: Vec<Segment> = pieces.into_iter().filter(is_side).collect();
        let mut box_um = [[i64::MAX; 2], [i64::MIN; 2]];
        for (p, k) in pieces.iter().flat_map(|s| [s.a, s.b]).flat_map(|p| [(p, 0), (p, 1)]) {
            box_um[0][k] = box_um[0][k].min(p[k] - (JOINT_M * UM_PER_M) as i64);
            box_um[1][k] = box_um[1][k].max(p[k] + (JOINT_M * UM_PER_M) as i64);
        }
        Some(Self { normal: longest.try_normalize()?.perp(), box_um, pieces })
    }

    /// Whether a wall in line with this one stands with both its ends at it, in one of its openings: both following would
    /// carry it, and nobody said so.
    pub fn holds_both_ends(&self, end: &Follower, ends: &[Follower], plan: &Plan) -> bool {
        let is_in_line = self.normal.dot(end.along).abs() < CROSSING_MIN_RAD.sin();
        let mut others = ends.iter().filter(|e| e.record == end.record && e.end != end.end);
        is_in_line && others.any(|e| self.is_joined_at(&e.corners(plan)))
    }

    /// Whether an end with these corners stands at this wall.
    pub fn is_joined_at(&self, corners: &[PointUm]) -> bool {
        let far = |s: &Segment, p: [i64; 2]| {
            let v = |q: [i64; 2]| DVec2::new((q[0] - s.a[0]) as f64, (q[1] - s.a[1]) as f64) * 1e-6;
            let (d, q) = (v(s.b), v(p));
            let t = (q.dot(d) / d.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
            q.distance(d * t)
        };
        let is_near = |p: &[i64; 2]| (0..2).all(|k| (self.box_um[0][k]..=self.box_um[1][k]).contains(&p[k]));
        corners.iter().copied().filter(is_near).any(|p| self.pieces.iter().any(|s| far(s, p) <= JOINT_M))
    }
}

/// The direction of a wall from its first end to its second: its longest piece that ends at one of them.
pub(super) fn along(plan: &Plan, walls: &[u32]) -> Option<DVec2> {
    let mut best = DVec2::ZERO;
    for wall in walls.iter().map(|w| &plan.walls[*w as usize]) {
        let Editable::Wall { ends: [first, second], .. } = &wall.editable else { continue };
        let points = control_points(&wall.shape);
        for i in 0..points.len() {
            let j = (i + 1) % points.len();
            let (a, b) = (i as u32, j as u32);
            let leads_on = |a: &u32, b: &u32| {
                first.contains(a) && !first.contains(b) || second.contains(b) && !second.contains(a)
            };
            let v = plan.frame.plan_from_file(points[j]) - plan.frame.plan_from_file(points[i]);
            let v = if leads_on(&a, &b) { v } else { -v };
            if (leads_on(&a, &b) || leads_on(&b, &a)) && v.length() > best.length() {
                best = v;
            }
        }
    }
    best.try_normalize()
}

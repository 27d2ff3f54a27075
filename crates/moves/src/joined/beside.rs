//! The sides of a wall at which others end.

use std::collections::BTreeMap;

use glam::DVec2;

use super::CROSSING_MIN_RAD;
use super::bars::Bar;
use super::follower::{Follower, place_um};
use enfilade_cad::curve::control_points;
use enfilade_cad::drawing::Editable;
use enfilade_engine::geometry::{PointUm, Segment, UM_PER_M};
use enfilade_plan::axes::AxisGraph;
use enfilade_plan::structure::face_handles;
use enfilade_plan::{Plan, Plug, Wall};

/// An end of a wall this near to another wall is joined to it.
pub(crate) const JOINT_M: f64 = 0.02;

/// Pieces whose direction differs by more than this sine from that of their wall are no sides of it.
pub(crate) const SIDE_SIN: f64 = 0.02;

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

/// A wall that others may be joined to, by its sides.
pub(super) struct Beside {
    pieces: Vec<Segment>,
    /// Lowest and highest coordinates that are near enough to be joined, micrometres.
    box_um: [[i64; 2]; 2],
    /// Unit normal, plan frame.
    pub normal: DVec2,
}

impl Beside {
    /// The outlines of a record.
    pub fn record(by_record: &ByRecord<'_>, record: usize) -> Option<Self> {
        // A door at its end stands between it and what ends there.
        let plugs = by_record.plugs(record).map(|p| &p.outline);
        let own = by_record.walls(record).map(|w| &w.trace);
        Self::new(own.chain(plugs).flat_map(|t| t.segments().map(|s| s.2)).collect())
    }

    /// The faces of a bar that are drawn point by point; none where a record moves it whole.
    pub fn bar(plan: &Plan, axes: &AxisGraph, bar: &Bar) -> Option<Self> {
        let edges = bar.edges.iter().map(|e| &axes.edges[*e as usize]);
        let faces = edges.flat_map(|e| e.left.iter().chain(&e.right).chain(&e.inner));
        let free = faces.filter(|f| plan.walls[f.0 as usize].editable == Editable::Free);
        let piece = |f| {
            let [a, b] = face_handles(plan, f)[..] else { return None };
            let [a, b] = [a, b].map(|h| place_um(plan, h));
            Some(Segment { a, b })
        };
        Self::new(free.filter_map(|f| piece(*f)).collect())
    }

    fn new(pieces: Vec<Segment>) -> Option<Self> {
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
pub(crate) fn along(plan: &Plan, walls: &[u32]) -> Option<DVec2> {
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

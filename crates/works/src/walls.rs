//! The straight walls of a plan, each between two joints, ends or jambs, with what stands beside it.

use std::collections::{BTreeMap, BTreeSet};

use enfilade_cad::bearing::Bearing;
use enfilade_cad::drawing::Format;
use enfilade_engine::geometry::{PointUm, Segment};
use enfilade_plan::Plan;
use enfilade_plan::axes::{AxisGraph, Edge, NodeKind, OpeningKind};
use glam::DVec2;

use crate::change::Quad;
use crate::rooms::{Room, RoomId, room_at};

/// Wall kept beside a joint, metres of a person (`docs/works.md`).
pub const JOINT_M: f64 = 0.1;
/// Wall kept beside an opening or a free end: what carries a frame.
pub const PIER_M: f64 = 0.3;
/// How far from a face the room beside it is looked for: farther than a skirting, nearer than the next wall.
pub const BESIDE_M: f64 = 0.25;
/// A mark on what draws so much of a wall is one on the wall, metres of a person: more than the thickness of partitions.
const MARKED_M: f64 = 0.5;
/// How far a stretch reaches beyond the faces, so that lines drawn on them go with it: plaster and slips of the hand.
const COVER_M: f64 = 0.02;
/// The same of walls that are bodies: their faces are where they are, and what stands at them stays.
const COVER_OF_BODIES_M: f64 = 0.002;

/// A wall, by its place in the list of walls.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct WallId(pub usize);

/// What a wall ends at.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WallEnd {
    /// Other walls; so far from the node their bodies reach, metres.
    Joint(f64),
    /// An opening, by its place in [`AxisGraph::openings`].
    Opening(usize),
    /// Nothing.
    Free,
}

/// A straight wall between two ends. Lengths in metres of the plan, along its axis from its first node.
#[derive(Clone, Debug, PartialEq)]
pub struct Wall {
    /// Its place in [`AxisGraph::edges`].
    pub edge: usize,
    /// First end of its axis, plan frame.
    pub at: DVec2,
    /// Unit vector to the other end.
    pub along: DVec2,
    /// Length of the axis.
    pub length_m: f64,
    /// Distance of the two faces, 0 for a single line.
    pub thickness_m: f64,
    /// What it ends at.
    pub ends: [WallEnd; 2],
    /// Records of what draws it ([`enfilade_cad::drawing::SourceRef::record`]).
    pub records: BTreeSet<usize>,
    /// Those of them that draw enough of it for a mark on them to be one on it: the end of a wall that meets it is drawn on
    /// its face, too.
    pub markable: BTreeSet<usize>,
    /// Why it is structure, where something says so.
    pub bearing: Option<Bearing>,
}

impl Wall {
    /// A point of the plan by its place along and across, metres.
    pub fn point(&self, along_m: f64, across_m: f64) -> DVec2 {
        self.at + self.along * along_m + self.along.perp() * across_m
    }

    /// How much of it a line draws, metres along it.
    fn drawn_m(&self, plan: &Plan, line: Segment) -> f64 {
        let [a, b] = [line.a, line.b].map(|p| plan.frame.plan_from_um(p) - self.at);
        let across = [a, b].map(|p| self.along.perp_dot(p).abs());
        let is_beside = across.iter().all(|d| *d <= self.thickness_m / 2.0 + BESIDE_M);
        let [from, to] = [a, b].map(|p| self.along.dot(p).clamp(0.0, self.length_m));
        if is_beside && (across[0] - across[1]).abs() < (to - from).abs() { (to - from).abs() } else { 0.0 }
    }

    /// A stretch of it with its faces, drawing frame.
    pub fn quad(&self, plan: &Plan, [from, to]: [f64; 2]) -> Quad {
        let half = self.thickness_m / 2.0 + cover_m(plan, self.thickness_m);
        [(from, -half), (to, -half), (to, half), (from, half)]
            .map(|(t, v)| plan.frame.um_from_plan(self.point(t, v)))
    }

    /// The cut faces at the ends of a stretch.
    pub fn jambs(&self, plan: &Plan, [from, to]: [f64; 2]) -> [Segment; 2] {
        [from, to].map(|t| self.across(plan, t))
    }

    /// A line across it.
    pub fn across(&self, plan: &Plan, at_m: f64) -> Segment {
        let half = self.thickness_m / 2.0;
        let at = |v: f64| plan.frame.um_from_plan(self.point(at_m, v));
        Segment { a: at(-half), b: at(half) }
    }

    /// Where openings may be made: between what is kept at its ends.
    pub fn free(&self, human_scale: f64) -> [f64; 2] {
        let keep = |end: WallEnd| match end {
            WallEnd::Joint(reach) => reach + JOINT_M * human_scale,
            WallEnd::Opening(_) | WallEnd::Free => PIER_M * human_scale,
        };
        [keep(self.ends[0]), self.length_m - keep(self.ends[1])]
    }

    /// The rooms on its right and its left side at a place.
    pub fn rooms_at(&self, plan: &Plan, rooms: &[Room], at_m: f64) -> [Option<RoomId>; 2] {
        let off = self.thickness_m / 2.0 + BESIDE_M * plan.human_scale;
        [-off, off].map(|v| room_at(rooms, plan.frame.um_from_plan(self.point(at_m, v))))
    }
}

/// All straight walls, in the order of the edges.
pub fn walls(plan: &Plan, axes: &AxisGraph) -> Vec<Wall> {
    let straight = axes.edges.iter().enumerate().filter(|(_, e)| e.bulge == 0.0);
    straight.filter_map(|(i, e)| wall(plan, axes, i, e)).collect()
}

fn wall(plan: &Plan, axes: &AxisGraph, index: usize, edge: &Edge) -> Option<Wall> {
    let scale = plan.human_scale;
    let [a, b] = axes.ends(edge).map(|p| p * scale);
    let along = (b - a).try_normalize()?;
    let faces = edge.left.iter().chain(&edge.right).chain(&edge.inner);
    let records: BTreeSet<usize> =
        faces.filter_map(|f| plan.walls.get(f.0 as usize)).map(|w| w.source.record).collect();
    let bearing = records.iter().find_map(|r| plan.bearing.get(r)).copied();
    let ends = [0, 1].map(|k| end(axes, index, edge.nodes[k], along, scale));
    let mut wall = Wall {
        edge: index,
        at: a,
        along,
        length_m: a.distance(b),
        thickness_m: edge.thickness_m * scale,
        ends,
        records,
        markable: BTreeSet::new(),
        bearing,
    };
    let least_m = (MARKED_M * scale).min(wall.length_m / 2.0);
    let faces: BTreeSet<u32> = edge.left.iter().chain(&edge.right).chain(&edge.inner).map(|f| f.0).collect();
    let mut drawn_m: BTreeMap<usize, f64> = BTreeMap::new();
    for drawn in faces.into_iter().filter_map(|w| plan.walls.get(w as usize)) {
        let lines = drawn.trace.segments().map(|(_, _, s)| wall.drawn_m(plan, s));
        *drawn_m.entry(drawn.source.record).or_default() += lines.sum::<f64>();
    }
    wall.markable = drawn_m.into_iter().filter(|(_, m)| *m >= least_m).map(|(r, _)| r).collect();
    Some(wall)
}

fn end(axes: &AxisGraph, index: usize, node: u32, along: DVec2, scale: f64) -> WallEnd {
    let is_jamb = |o: &enfilade_plan::axes::Opening| o.jambs.iter().any(|j| j.node == Some(node));
    let others = axes.edges.iter().enumerate().filter(|(i, e)| *i != index && e.nodes.contains(&node));
    let reach = |e: &Edge| {
        let [a, b] = axes.ends(e);
        let way = (b - a).normalize_or_zero();
        // A wall that goes on in line takes nothing of this one.
        if way.perp_dot(along).abs() < 0.05 { 0.0 } else { e.thickness_m / 2.0 * scale }
    };
    let reaches: Vec<f64> = others.map(|(_, e)| reach(e)).collect();
    if let Some(k) = axes.openings.iter().position(is_jamb).filter(|_| reaches.is_empty()) {
        return WallEnd::Opening(k);
    }
    match &axes.nodes[node as usize].kind {
        NodeKind::End if reaches.is_empty() => WallEnd::Free,
        NodeKind::Column(ring) => {
            let at = axes.nodes[node as usize].at;
            let half = ring.iter().map(|p| (*p - at).dot(along).abs()).fold(0.0, f64::max);
            WallEnd::Joint(half * scale)
        }
        _ => WallEnd::Joint(reaches.into_iter().fold(0.0, f64::max)),
    }
}

/// A wall from joint to joint: its pieces and the openings between them, in order.
#[derive(Clone, Debug, PartialEq)]
pub struct Chain {
    /// Its pieces.
    pub walls: Vec<WallId>,
    /// The openings in it, by their place in [`AxisGraph::openings`].
    pub openings: Vec<usize>,
    /// Its ends: a piece, and which end of it.
    pub ends: [(WallId, usize); 2],
}

/// How far a stretch of a wall of a thickness reaches beyond its faces, metres of the plan.
pub fn cover_m(plan: &Plan, thickness_m: f64) -> f64 {
    let is_body = plan.format != Format::Dxf && thickness_m > 0.0;
    plan.human_scale * if is_body { COVER_OF_BODIES_M } else { COVER_M }
}

/// Walls put together over the openings in them, each once.
pub fn chains(walls: &[Wall], axes: &AxisGraph) -> Vec<Chain> {
    let by_node = |node: u32| {
        walls.iter().position(|w| {
            axes.edges[w.edge]
                .nodes
                .iter()
                .zip(w.ends)
                .any(|(n, e)| *n == node && matches!(e, WallEnd::Opening(_)))
        })
    };
    // The wall beyond the opening at an end, in line, and which end of it is there.
    let beyond = |at: (usize, usize)| {
        let WallEnd::Opening(o) = walls[at.0].ends[at.1] else { return None };
        let node = axes.edges[walls[at.0].edge].nodes[at.1];
        let other = axes.openings[o].jambs.iter().filter_map(|j| j.node).find(|n| *n != node)?;
        let next = by_node(other)?;
        let end = axes.edges[walls[next].edge].nodes.iter().position(|n| *n == other)?;
        (walls[next].along.perp_dot(walls[at.0].along).abs() < 0.05).then_some((o, next, end))
    };
    let mut is_taken = vec![false; walls.len()];
    let mut out = Vec::new();
    for first in 0..walls.len() {
        if std::mem::replace(&mut is_taken[first], true) {
            continue;
        }
        let (mut parts, mut openings) = (vec![WallId(first)], Vec::new());
        let mut ends = [(WallId(first), 0), (WallId(first), 1)];
        for last in &mut ends {
            while let Some((o, next, end)) = beyond((last.0.0, last.1)) {
                if std::mem::replace(&mut is_taken[next], true) {
                    break;
                }
                openings.push(o);
                parts.push(WallId(next));
                *last = (WallId(next), 1 - end);
            }
        }
        openings.sort_unstable();
        out.push(Chain { walls: parts, openings, ends });
    }
    out
}

/// Whether an opening is one to go through or see through from room to room.
pub fn is_way(kind: OpeningKind) -> bool {
    kind != OpeningKind::Window
}

/// A stretch's ends in the drawing frame, on the axis.
pub fn ends_um(plan: &Plan, wall: &Wall, [from, to]: [f64; 2]) -> [PointUm; 2] {
    [from, to].map(|t| plan.frame.um_from_plan(wall.point(t, 0.0)))
}

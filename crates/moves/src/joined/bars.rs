//! Straight thick walls as bars, and what moves their ends.
//!
//! Walls on one line that share a drawn face are one bar: it can turn, but not bend. A wall that another one
//! merely abuts is therefore not turned when the joint moves, only when an end of its own does.

use std::collections::BTreeMap;

use glam::DVec2;

use crate::{NodeGroup, Parameter};
use enfilade_plan::Plan;
use enfilade_plan::axes::{AxisGraph, FaceRef};
use enfilade_plan::graph::{Handle, NODE_JOIN_M};
use enfilade_plan::markers::Kind;
use enfilade_plan::structure::{face_handles, handle_at};

/// Directions whose angle has a smaller sine are one: a wall that is drawn this much askew grows longer and does
/// not turn.
const SAME_SIN: f64 = 0.02;

/// What the moves do to the line that a bar stands on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Motion {
    /// Nothing: no end moves, or the ends only along it.
    Still,
    /// Both ends go by one rigid motion.
    Rigid,
    /// The ends go different ways.
    Turning,
    /// Only some corners of an end move: each goes for itself, as the user said.
    Torn,
}

/// One bar.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Bar {
    /// Edges of the axis graph, ascending.
    pub edges: Vec<u32>,
    /// Nodes of the axis graph at its ends.
    pub nodes: [u32; 2],
    /// Where its ends stand as drawn, plan frame, metres.
    pub ends: [DVec2; 2],
    /// Groups that move each end, in order.
    pub groups: [Vec<usize>; 2],
    /// What becomes of its line.
    pub motion: Motion,
    /// Half its thickness, metres of the plan.
    pub half_m: f64,
}

impl Bar {
    /// Unit vector from the first to the second end.
    pub fn along(&self) -> DVec2 {
        (self.ends[1] - self.ends[0]).normalize_or_zero()
    }

    /// The end nearer to a point (plan frame), and how far beyond it the point lies along the bar.
    pub fn nearest_end(&self, p: DVec2) -> (usize, f64) {
        let along = self.along();
        let beyond = [(self.ends[0] - p).dot(along), (p - self.ends[1]).dot(along)];
        let end = usize::from(beyond[1] > beyond[0]);
        (end, beyond[end])
    }
}

/// All bars of a plan.
#[derive(Debug)]
pub(super) struct Bars {
    pub list: Vec<Bar>,
    /// The bar of a drawn piece.
    pub of_face: BTreeMap<FaceRef, usize>,
    /// Edges at every node of the axis graph.
    pub at_node: Vec<Vec<u32>>,
}

/// The groups with their parameters.
#[derive(Clone, Copy)]
pub(crate) struct Moving<'a> {
    pub groups: &'a [NodeGroup],
    pub parameters: &'a [Parameter],
}

impl Moving<'_> {
    /// The groups that move a control point, ascending.
    pub fn of(&self, handle: &Handle) -> Vec<usize> {
        let holds = |g: &usize| self.groups[*g].handles.binary_search(handle).is_ok();
        (0..self.groups.len()).filter(holds).collect()
    }

    /// Transformations of some groups.
    fn kinds<'s>(&'s self, groups: &'s [usize]) -> impl Iterator<Item = Kind> + 's {
        self.parameters.iter().filter(|p| groups.contains(&p.group)).map(|p| p.clause.kind)
    }

    /// Whether some groups shift in one direction alone, there and back.
    pub fn only_along(&self, groups: &[usize], direction: DVec2) -> bool {
        self.kinds(groups).all(|k| shift_of(k).is_some_and(|d| d.perp_dot(direction).abs() < SAME_SIN))
    }

    /// Whether some groups shift across a direction.
    pub fn leaves(&self, groups: &[usize], direction: DVec2, sin: f64) -> bool {
        self.kinds(groups).filter_map(shift_of).any(|d| d.perp_dot(direction).abs() > sin)
    }

    /// Whether some groups only shift.
    pub fn only_shifts(&self, groups: &[usize]) -> bool {
        self.kinds(groups).all(|k| shift_of(k).is_some())
    }

    /// Those of a group's own transformations that shift, and how far each goes at its bounds, SI.
    pub fn shifts(&self, group: usize) -> impl Iterator<Item = (DVec2, [f64; 2])> + '_ {
        let own = self.parameters.iter().filter(move |p| p.group == group);
        own.filter_map(|p| {
            let si = p.clause.si_per_unit;
            Some((shift_of(p.clause.kind)?, [p.clause.lower * si, p.clause.upper * si]))
        })
    }

    fn scales(&self, groups: &[usize]) -> bool {
        self.kinds(groups).any(|k| matches!(k, Kind::Scale(_)))
    }
}

pub(crate) fn shift_of(kind: Kind) -> Option<DVec2> {
    match kind {
        Kind::X => Some(DVec2::X),
        Kind::Y => Some(DVec2::Y),
        Kind::Along(angle) => Some(DVec2::from_angle(angle)),
        Kind::Rotate(_) | Kind::Scale(_) => None,
    }
}

impl Bars {
    /// Finds the bars and what moves them.
    pub fn new(plan: &Plan, axes: &AxisGraph, moving: Moving<'_>) -> Self {
        let mut at_node = vec![Vec::new(); axes.nodes.len()];
        for (i, e) in axes.edges.iter().enumerate() {
            e.nodes.iter().for_each(|n| at_node[*n as usize].push(i as u32));
        }
        let mut out = Self { list: Vec::new(), of_face: BTreeMap::new(), at_node };
        for edges in chains(axes) {
            let Some(bar) = bar(plan, axes, edges, moving) else { continue };
            for e in bar.edges.iter().map(|e| &axes.edges[*e as usize]) {
                let faces = e.left.iter().chain(&e.right).chain(&e.inner);
                out.of_face.extend(faces.map(|f| (*f, out.list.len())));
            }
            out.list.push(bar);
        }
        out
    }
}

/// Straight thick edges by the faces they share.
fn chains(axes: &AxisGraph) -> Vec<Vec<u32>> {
    let mut root: Vec<usize> = (0..axes.edges.len()).collect();
    let find = |root: &Vec<usize>, mut i: usize| {
        while root[i] != i {
            i = root[i];
        }
        i
    };
    let is_bar = |i: &usize| axes.edges[*i].bulge == 0.0 && axes.edges[*i].thickness_m > 0.0;
    let mut first: BTreeMap<FaceRef, usize> = BTreeMap::new();
    for i in (0..axes.edges.len()).filter(is_bar) {
        let e = &axes.edges[i];
        for f in e.left.iter().chain(&e.right) {
            let (a, b) = (find(&root, *first.entry(*f).or_insert(i)), find(&root, i));
            root[a.max(b)] = a.min(b);
        }
    }
    let mut out: BTreeMap<usize, Vec<u32>> = BTreeMap::new();
    for i in (0..axes.edges.len()).filter(is_bar) {
        out.entry(find(&root, i)).or_default().push(i as u32);
    }
    out.into_values().collect()
}

fn bar(plan: &Plan, axes: &AxisGraph, edges: Vec<u32>, moving: Moving<'_>) -> Option<Bar> {
    let of = |e: &u32| &axes.edges[*e as usize];
    let length = |e: &&u32| axes.ends(of(e))[0].distance(axes.ends(of(e))[1]);
    let longest = edges.iter().max_by(|a, b| length(a).total_cmp(&length(b)))?;
    let [a, b] = axes.ends(of(longest));
    let along = (b - a).try_normalize()?;
    let place = |n: &u32| (axes.nodes[*n as usize].at - a).dot(along);
    let mut nodes: Vec<u32> = edges.iter().flat_map(|e| of(e).nodes).collect();
    nodes.sort_by(|m, n| place(m).total_cmp(&place(n)).then(m.cmp(n)));
    let nodes = [*nodes.first()?, *nodes.last()?];
    let half_m = edges.iter().map(|e| of(e).thickness_m).fold(0.0, f64::max) / 2.0 * plan.human_scale;
    let mut out = Bar {
        nodes,
        ends: nodes.map(|n| axes.nodes[n as usize].at * plan.human_scale),
        groups: [Vec::new(), Vec::new()],
        motion: Motion::Still,
        half_m,
        edges,
    };
    let Some(corners) = end_corners(plan, axes, &out, along) else {
        out.motion = Motion::Torn;
        return Some(out);
    };
    let mut is_torn = false;
    for (end, corners) in corners.iter().enumerate() {
        for g in 0..moving.groups.len() {
            let held = corners.iter().filter(|h| moving.groups[g].handles.binary_search(h).is_ok()).count();
            is_torn |= held > 0 && held < corners.len();
            if held == corners.len() {
                out.groups[end].push(g);
            }
        }
    }
    let [first, second] = &out.groups;
    let all: Vec<usize> = first.iter().chain(second).copied().collect();
    out.motion = if is_torn {
        Motion::Torn
    } else if moving.only_along(&all, out.along()) {
        Motion::Still
    } else if first == second && !moving.scales(first) {
        Motion::Rigid
    } else {
        Motion::Turning
    };
    Some(out)
}

/// The outermost corners of the two sides at either end. `None` where a side has no drawn corner.
fn end_corners(plan: &Plan, axes: &AxisGraph, bar: &Bar, along: DVec2) -> Option<[Vec<Handle>; 2]> {
    let mut out = [Vec::new(), Vec::new()];
    for is_left in [true, false] {
        let mut side: Vec<(f64, Handle)> = Vec::new();
        for e in bar.edges.iter().map(|e| &axes.edges[*e as usize]) {
            let [a, b] = axes.ends(e);
            let faces = if ((b - a).dot(along) > 0.0) == is_left { &e.left } else { &e.right };
            let corners = faces.iter().flat_map(|f| face_handles(plan, *f));
            side.extend(corners.map(|h| (handle_at(plan, h).dot(along), h)));
        }
        let first = side.iter().map(|s| s.0).min_by(f64::total_cmp)?;
        let last = side.iter().map(|s| s.0).max_by(f64::total_cmp)?;
        for (end, at) in [first, last].into_iter().enumerate() {
            out[end].extend(side.iter().filter(|s| (s.0 - at).abs() <= NODE_JOIN_M).map(|s| s.1));
        }
    }
    out.iter_mut().for_each(|list| {
        list.sort_unstable();
        list.dedup();
    });
    Some(out)
}

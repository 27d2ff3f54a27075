//! The walls of a plan as bodies: what the axis graph says of them, joined to what can be written back.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;

use super::Plan;
use super::axes::near::Buckets;
use super::axes::{AxisGraph, Drawn, Edge, FaceRef, NodeKind, Opening, OpeningKind, Path};
use super::drawn::drawn;
use super::graph::Handle;
use super::rooms;
use crate::sizes::{ERROR_GAP_M, FINISH_MAX_M, THICKNESS_USUAL_M, ZERO_M};
use enfilade_cad::curve::control_point;
use enfilade_cad::drawing::{Drawing, Format, Shape};
use enfilade_engine::geometry::{PointUm, UM_PER_M};

/// What covers ground by its lines: a thick straight wall, by the two ends of its left face and of its right face in ring
/// order, or a column.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// Its corners, in order round it.
    pub corners: Vec<Handle>,
    /// Of a wall the distance of its faces, micrometres; a column has none.
    pub thickness_um: Option<f64>,
}

/// A body's ends are at most this many times as wide as it is thick: mitred, not two faces torn apart.
const END_WIDTH_MAX: f64 = 1.6;

impl Body {
    /// The ring of its corners; `at` says where a control point stands. `None` where its faces do not end
    /// side by side: one of them runs on beyond the wall, and what lies between them is no body.
    pub fn ring(&self, at: impl FnMut(Handle) -> PointUm) -> Option<Vec<PointUm>> {
        let ring: Vec<PointUm> = self.corners.iter().copied().map(at).collect();
        let (Some(thickness_um), [p, q, r, s]) = (self.thickness_um, ring.as_slice()) else {
            return Some(ring);
        };
        let width = |p: &PointUm, q: &PointUm| ((p[0] - q[0]) as f64).hypot((p[1] - q[1]) as f64);
        let is_wide = |w: f64| w > END_WIDTH_MAX * thickness_um;
        (!is_wide(width(p, s)) && !is_wide(width(q, r))).then_some(ring)
    }
}

/// Shortest wall on either side of a window in a wall that is drawn through: a box with lines in it is a radiator.
const BESIDE_WINDOW_M: f64 = 0.2;

/// The axis graph of a plan, and for every mark that it was understood from the index of its entity.
pub fn axes(plan: &Plan, drawing: &Drawing) -> (AxisGraph, Vec<usize>) {
    let (drawn, marked) = drawn(plan, drawing);
    let mut axes = AxisGraph::new(&drawn);
    // Where wall lines run through and nothing shows a door or a window, there is no gap.
    let goes_on = |node: u32| {
        let beyond = axes.edges.iter().filter(|e| e.nodes.contains(&node)).map(|e| {
            let [a, b] = axes.ends(e);
            a.distance(b)
        });
        beyond.fold(0.0, f64::max) >= BESIDE_WINDOW_M
    };
    let is_window = |o: &Opening| {
        let is_between = o.jambs.iter().all(|j| j.edge.is_some() || j.node.is_some_and(goes_on));
        // The wall's own faces are no panes.
        let has_panes = o.faces.iter().any(|f| !o.through.contains(f));
        o.kind == OpeningKind::Window && has_panes && is_between
    };
    let shows: Vec<bool> =
        axes.openings.iter().map(|o| o.through.is_empty() || !o.marks.is_empty() || is_window(o)).collect();
    let mut shows = shows.into_iter();
    axes.openings.retain(|_| shows.next().unwrap_or(true));
    leave_uncut(plan, &drawn, &mut axes);
    rooms::open_touching(plan, &mut axes);
    axes.count_again();
    (axes, marked)
}

/// Where most doors stand in gaps of their walls, a swing before a wall that runs on shows no door in it, unless lines across
/// the wall end it on both sides: it belongs to another storey. In other drawings walls are drawn through.
fn leave_uncut(plan: &Plan, drawn: &Drawn, axes: &mut AxisGraph) {
    let across = Across::new(drawn);
    // Bodies of a model end where they end: what closes a gap there has ends as well.
    let is_drawn = plan.format == Format::Dxf;
    let is_uncut = |o: &Opening| {
        let [from, to] = o.jambs.map(|j| j.at);
        let side = |f: &FaceRef| {
            let piece = face_handles(plan, *f).first().map(|h| handle_at(plan, *h));
            piece.map(|p| (to - from).perp_dot(p - from) > 0.0)
        };
        let sides: BTreeSet<bool> = o.through.iter().filter_map(side).collect();
        let is_through = sides.len() == 2 || o.thickness_m == 0.0 && !o.through.is_empty();
        o.kind == OpeningKind::Door && is_through && !(is_drawn && across.ends(o))
    };
    let in_gaps = |o: &&Opening| o.kind == OpeningKind::Door && o.through.is_empty();
    let uncut = axes.openings.iter().filter(|o| is_uncut(o)).count();
    if uncut < axes.openings.iter().filter(in_gaps).count() {
        axes.openings.retain(|o| !is_uncut(o));
    }
}

/// Straight pieces by their middles: those that lie across a wall end it.
struct Across {
    lines: Vec<[DVec2; 2]>,
    near: Buckets,
}

impl Across {
    fn new(drawn: &Drawn) -> Self {
        let paths = drawn.faces.iter().map(|f| &f.path).chain(drawn.marks.iter().flat_map(|m| &m.paths));
        let lines: Vec<[DVec2; 2]> =
            paths.filter(|p| matches!(p, Path::Line { .. })).map(Path::ends).collect();
        let mut near = Buckets::new(0.5);
        lines.iter().enumerate().for_each(|(i, [a, b])| near.add(i as u32, &[a.midpoint(*b)]));
        Self { lines, near }
    }

    /// Whether one as long as the wall is thick lies at both jambs.
    fn ends(&self, o: &Opening) -> bool {
        let along = (o.jambs[1].at - o.jambs[0].at).normalize_or_zero();
        let reach = 2.0 * ERROR_GAP_M;
        let is_at = |at: DVec2| {
            self.near.near(at - reach, at + reach).into_iter().any(|i| {
                let [a, b] = self.lines[i as usize];
                a.midpoint(b).distance(at) <= reach
                    && (a.distance(b) - o.thickness_m).abs() <= reach
                    && (b - a).normalize_or_zero().dot(along).abs() <= ACROSS_COS
            })
        };
        o.thickness_m > 0.0 && o.jambs.iter().all(|j| is_at(j.at))
    }
}

/// A jamb stands square to its wall, or up to 12° askew: the cosine.
const ACROSS_COS: f64 = 0.2;

/// The thick straight walls of an axis graph, and its columns that are drawn by single lines. What another wall's joint
/// divides into edges, while a face runs on past it, is one wall.
pub fn bodies(plan: &Plan, axes: &AxisGraph) -> Vec<Body> {
    let walls = lengths(axes).into_iter().filter_map(|edges| body(plan, axes, &edges));
    walls.chain(columns(plan, axes).filter_map(|(ring, faces)| column(plan, ring, faces))).collect()
}

/// Thick straight edges that go on in one line past a node with one face: each list is one wall.
fn lengths(axes: &AxisGraph) -> Vec<Vec<&Edge>> {
    let straight: Vec<&Edge> = axes.edges.iter().filter(|e| e.thickness_m > 0.0 && e.bulge == 0.0).collect();
    let mut at_node: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    for (i, e) in straight.iter().enumerate() {
        e.nodes.iter().for_each(|n| at_node.entry(*n).or_default().push(i));
    }
    let goes_on = |e: &Edge, f: &Edge| {
        e.nodes[1] == f.nodes[0]
            && (e.left.iter().any(|s| f.left.contains(s)) || e.right.iter().any(|s| f.right.contains(s)))
    };
    let mut is_begun = vec![false; straight.len()];
    let mut out = Vec::new();
    let has_before = |i: usize| {
        at_node[&straight[i].nodes[0]].iter().any(|&j| j != i && goes_on(straight[j], straight[i]))
    };
    for first in (0..straight.len()).filter(|&i| !has_before(i)).chain(0..straight.len()) {
        let mut wall = Vec::new();
        let mut next = Some(first).filter(|&i| !is_begun[i]);
        while let Some(i) = next {
            is_begun[i] = true;
            wall.push(straight[i]);
            let beyond = at_node[&straight[i].nodes[1]].iter();
            next = beyond.copied().find(|&j| !is_begun[j] && goes_on(straight[i], straight[j]));
        }
        if !wall.is_empty() {
            out.push(wall);
        }
    }
    out
}

/// Rings and faces of the columns of which no outline says by itself that it is solid.
fn columns<'a>(plan: &'a Plan, axes: &'a AxisGraph) -> impl Iterator<Item = (&'a [DVec2], &'a [FaceRef])> {
    axes.nodes.iter().filter_map(|node| match &node.kind {
        NodeKind::Column(ring) if !node.faces.iter().any(|f| plan.walls[f.0 as usize].is_solid) => {
            Some((ring.as_slice(), node.faces.as_slice()))
        }
        _ => None,
    })
}

fn column(plan: &Plan, ring: &[DVec2], faces: &[FaceRef]) -> Option<Body> {
    let handles: Vec<(DVec2, Handle)> =
        faces.iter().flat_map(|f| face_handles(plan, *f)).map(|h| (handle_at(plan, h), h)).collect();
    let corner = |p: &DVec2| {
        let near = handles.iter().map(|(at, h)| (at.distance(*p), *h)).filter(|h| h.0 <= ERROR_GAP_M);
        Some(near.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))?.1)
    };
    let corners: Option<Vec<Handle>> = ring.iter().map(corner).collect();
    Some(Body { corners: corners?, thickness_um: None })
}

fn body(plan: &Plan, axes: &AxisGraph, edges: &[&Edge]) -> Option<Body> {
    let (first, last) = (edges.first()?, edges.last()?);
    let [a, b] = [axes.ends(first)[0], axes.ends(last)[1]];
    let along = |p: DVec2| (p - a).dot(b - a);
    let side = |faces: fn(&Edge) -> &Vec<FaceRef>| -> Option<[Handle; 2]> {
        let ends = edges.iter().flat_map(|e| faces(e)).flat_map(|f| face_handles(plan, *f));
        let mut ends: Vec<(f64, Handle)> = ends.map(|h| (along(handle_at(plan, h)), h)).collect();
        ends.sort_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
        Some([ends.first()?.1, ends.last()?.1])
    };
    let ([l0, l1], [r0, r1]) = (side(|e| &e.left)?, side(|e| &e.right)?);
    let thickest_m = edges.iter().map(|e| e.thickness_m).fold(0.0, f64::max);
    let thickness_um = thickest_m * plan.human_scale * UM_PER_M;
    Some(Body { corners: vec![l0, l1, r1, r0], thickness_um: Some(thickness_um) })
}

/// A slender wall is at least this many times as long as thick.
const SLENDER: f64 = 2.5;

/// The ground that straight thick walls stand on, openings left out, and columns of single lines: rings in the drawing
/// frame, micrometres.
///
/// Only walls of which one side stays, all its drawn pieces, are taken: where the other side moves, it is a joint
/// that slides along the wall. Of a column all stay.
pub fn footprints(plan: &Plan, axes: &AxisGraph, stays: impl Fn(FaceRef) -> bool) -> Vec<Vec<PointUm>> {
    let um = |p: DVec2| plan.frame.um_from_plan(p * plan.human_scale);
    let still = columns(plan, axes).filter(|(_, faces)| faces.iter().all(|f| stays(*f)));
    let mut out: Vec<Vec<PointUm>> = still.map(|(ring, _)| ring.iter().map(|p| um(*p)).collect()).collect();
    for edge in axes.edges.iter().filter(|e| e.thickness_m > 0.0 && e.bulge == 0.0) {
        let holds = |side: &[FaceRef]| side.iter().all(|f| stays(*f));
        if edge.left.is_empty() || edge.right.is_empty() || !(holds(&edge.left) || holds(&edge.right)) {
            continue;
        }
        let [a, b] = axes.ends(edge);
        if edge.thickness_m > THICKNESS_USUAL_M && a.distance(b) < SLENDER * edge.thickness_m {
            continue;
        }
        let half = (b - a).normalize_or_zero().perp() * (edge.thickness_m / 2.0);
        for [from, to] in closed_parts(axes, edge) {
            let [p, q] = [from, to].map(|t| a.lerp(b, t));
            out.push([p + half, q + half, q - half, p - half].map(um).to_vec());
        }
    }
    out
}

/// The parts of a straight wall between the openings it runs through, as shares of its length.
fn closed_parts(axes: &AxisGraph, edge: &Edge) -> Vec<[f64; 2]> {
    let [a, b] = axes.ends(edge);
    let share = |p: DVec2| (p - a).dot(b - a) / (b - a).length_squared();
    let is_own = |f: &FaceRef| edge.left.contains(f) || edge.right.contains(f);
    let mut open: Vec<[f64; 2]> = axes
        .openings
        .iter()
        .filter(|o| o.through.iter().any(is_own))
        .map(|o| o.jambs.map(|j| share(j.at)))
        .map(|[s, t]| [s.min(t), s.max(t)])
        .collect();
    open.sort_by(|x, y| x[0].total_cmp(&y[0]));
    let mut out = Vec::new();
    let mut at = 0.0;
    for [s, t] in open {
        if s > at {
            out.push([at, s.min(1.0)]);
        }
        at = t.max(at);
    }
    if at < 1.0 {
        out.push([at, 1.0]);
    }
    out
}

/// The thick wall that each drawn face and each face's end belongs to, numbered from 0: edges on which one
/// face lies are one wall.
pub fn thick_walls(axes: &AxisGraph) -> BTreeMap<FaceRef, u32> {
    let mut out: BTreeMap<FaceRef, u32> = BTreeMap::new();
    let mut root: Vec<u32> = (0..axes.edges.len() as u32).collect();
    let find = |root: &[u32], mut i: u32| {
        while root[i as usize] != i {
            i = root[i as usize];
        }
        i
    };
    let thick = || axes.edges.iter().enumerate().filter(|(_, e)| e.thickness_m > 0.0);
    for (i, edge) in thick() {
        for face in edge.left.iter().chain(&edge.right).chain(&edge.inner) {
            let first = *out.entry(*face).or_insert(i as u32);
            let (a, b) = (find(&root, first), find(&root, i as u32));
            root[a.max(b) as usize] = a.min(b);
        }
    }
    for (i, edge) in thick() {
        let ends = edge.nodes.iter().flat_map(|n| &axes.nodes[*n as usize].faces);
        for face in ends {
            out.entry(*face).or_insert(i as u32);
        }
    }
    out.values_mut().for_each(|wall| *wall = find(&root, *wall));
    out
}

/// Where a control point stands, metres of a person.
pub fn handle_at(plan: &Plan, (wall, control): Handle) -> DVec2 {
    let p = control_point(&plan.walls[wall as usize].shape, control);
    plan.frame.plan_from_file(p) / plan.human_scale
}

/// The control points of an edge's faces that stand at one of its nodes; none where the faces run on. Of a short face
/// both ends lie near the node: the nearer one stands at it.
pub fn end_handles(plan: &Plan, axes: &AxisGraph, edge: &Edge, node: u32) -> Vec<Handle> {
    let [a, b] = axes.ends(edge);
    let at = axes.nodes[node as usize].at;
    let along = (b - a).normalize_or_zero();
    let reach = FINISH_MAX_M + edge.thickness_m / 2.0;
    let far = |h: &Handle| (handle_at(plan, *h) - at).dot(along).abs();
    let faces = edge.left.iter().chain(&edge.right).chain(&edge.inner);
    let standing = faces.flat_map(|f| {
        let mut ends = face_handles(plan, *f);
        if let [Some(a), Some(b)] = [0, 1].map(|k| ends.get(k).map(far))
            && (a - b).abs() > ZERO_M
        {
            ends.swap_remove(usize::from(a < b));
        }
        ends
    });
    standing.filter(|h| far(h) <= reach).collect()
}

/// The control points at the ends of a straight drawn piece.
pub fn face_handles(plan: &Plan, (wall, part): FaceRef) -> Vec<Handle> {
    match &plan.walls[wall as usize].shape {
        Shape::Line { .. } => vec![(wall, 0), (wall, 1)],
        Shape::Polyline { vertices, .. } => {
            vec![(wall, part), (wall, (part + 1) % vertices.len() as u32)]
        }
        Shape::Arc { .. } | Shape::Circle { .. } => Vec::new(),
    }
}

//! Openings: gaps between wall ends, and what the drawing shows in them.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;

use super::assembly::Axes;
use super::axis::Axis;
use super::evidence::{Evidence, ordered, trace};
use super::joints::{FreeEnd, Joined};
use super::near::Buckets;
use super::spans::{self, Span};
use super::{AxisGraph, Drawn, FaceRef, Jamb, Opening, OpeningKind, Path, Shown, doors_by_swing, shell};
use crate::sizes::{
    CAVITY_MAX_M, COLLINEAR_M, CROSSING_MIN_RAD, ERROR_GAP_M, FINISH_MAX_M, OPENING_MAX_M, OPENING_MIN_M,
    PASSAGE_MAX_M, SIDE_OPENING_MAX_M, SQUARE_SIN, THICKNESS_MAX_M, THICKNESS_MIN_M, THICKNESS_USUAL_M,
};

/// Ends that look at each other lie in one line up to this share of half their thickness, or [`ERROR_GAP_M`].
const IN_LINE_SHARE: f64 = 0.5;

/// Nobody walks through a gap before which a wall is drawn nearer than this on both sides: metres beyond its faces, from
/// where thresholds may lie.
const CLEAR_MAX_M: f64 = 0.35;
/// Shortest pier in a gap: frames and mullions are shorter.
const PIER_MIN_M: f64 = 0.5;
/// What covers more of a gap is the frame of what stands in it.
const PIER_MAX_SHARE: f64 = 0.9;
/// Share of a gap along which a wall beside it runs if the gap leads nowhere.
const BESIDE_SHARE: f64 = 0.9;
/// Where one looks across a gap, as shares of its width.
const LOOKS: [f64; 3] = [0.25, 0.5, 0.75];

/// What a gap ends at.
struct Facing {
    /// Clear width.
    width: f64,
    jamb: Jamb,
    /// The free end at the other side, by its place in the list of free ends.
    other: Option<usize>,
    /// Whether the wall stands square to what it ends at, or in line with it.
    is_square: bool,
}

/// Finds the openings.
pub fn find(drawn: &Drawn, all: &Axes, joined: &Joined, out: &mut AxisGraph) {
    let scene = Scene::new(drawn, all, joined, out);
    let mut found: Vec<Opening> = Vec::new();
    let facing: Vec<Option<Facing>> = joined.free.iter().map(|f| scene.facing(f)).collect();
    for (i, f) in joined.free.iter().enumerate() {
        let Some(to) = &facing[i] else { continue };
        let is_mutual = |o: usize| facing[o].as_ref().is_some_and(|b| b.other == Some(i));
        if to.other.is_some_and(|o| o < i && is_mutual(o)) {
            continue;
        }
        found.extend(scene.opening(f, to));
    }
    found.extend(doors_by_swing::find(&scene.evidence, out, &found));
    found.sort_by(|a, b| a.centre.x.total_cmp(&b.centre.x).then(a.centre.y.total_cmp(&b.centre.y)));
    tell_second_leaves(&mut found);
    shell::tell_sliding_doors(drawn, &mut found);
    for o in &found {
        if o.kind == OpeningKind::Window {
            out.see_through.extend(&o.faces);
        }
    }
    let in_opening: BTreeSet<FaceRef> = found.iter().flat_map(|o| o.faces.clone()).collect();
    out.leftovers.retain(|l| !in_opening.contains(&l.face));
    out.openings = found;
}

/// An empty gap in the one leaf of a double wall is part of the window or door in the other.
fn tell_second_leaves(openings: &mut [Opening]) {
    let shown: Vec<Opening> = openings.iter().filter(|o| o.shown != Shown::Nothing).cloned().collect();
    let is_twin = |o: &Opening, p: &Opening| {
        let along = (o.jambs[1].at - o.jambs[0].at).normalize_or_zero();
        let to = p.centre - o.centre;
        let turn = (p.jambs[1].at - p.jambs[0].at).normalize_or_zero().perp_dot(along).abs();
        turn < CROSSING_MIN_RAD
            && to.dot(along).abs() <= p.width_m.min(o.width_m) * (1.0 - BESIDE_SHARE)
            && to.perp_dot(along).abs() <= (o.thickness_m + p.thickness_m) / 2.0 + CAVITY_MAX_M
    };
    for o in openings.iter_mut().filter(|o| o.shown == Shown::Nothing) {
        if let Some(twin) = shown.iter().find(|p| is_twin(o, p)) {
            (o.kind, o.shown) = (twin.kind, twin.shown);
        }
    }
}

struct Scene<'a> {
    drawn: &'a Drawn,
    axes: &'a [Axis],
    joined: &'a Joined,
    graph: &'a AxisGraph,
    axes_near: Buckets,
    ends_near: Buckets,
    columns_near: Buckets,
    faces_near: Buckets,
    evidence: Evidence<'a>,
}

impl<'a> Scene<'a> {
    fn new(drawn: &'a Drawn, all: &'a Axes, joined: &'a Joined, graph: &'a AxisGraph) -> Self {
        let mut near: [Buckets; 4] = [1.0, 1.0, 1.0, 1.0].map(Buckets::new);
        for (i, a) in all.axes.iter().enumerate() {
            near[0].add(i as u32, &a.carrier.points(a.span));
        }
        for (i, f) in joined.free.iter().enumerate() {
            near[1].add(i as u32, &[graph.nodes[f.node as usize].at]);
        }
        for (i, (_, c)) in joined.columns.iter().enumerate() {
            near[2].add(i as u32, &c.ring);
        }
        for (i, f) in drawn.faces.iter().enumerate() {
            near[3].add(i as u32, &trace(&f.path));
        }
        let [axes_near, ends_near, columns_near, faces_near] = near;
        Self {
            drawn,
            axes: &all.axes,
            joined,
            graph,
            axes_near,
            ends_near,
            columns_near,
            faces_near,
            evidence: Evidence::new(drawn, &all.spares),
        }
    }

    /// What a free end looks at along its axis, the nearest first thing.
    fn facing(&self, f: &FreeEnd) -> Option<Facing> {
        let axis = &self.axes[f.axis as usize];
        let sign = if f.end == 1 { 1.0 } else { -1.0 };
        let from = axis.span[f.end];
        let ray = axis.carrier.points(ordered(from, from + sign * OPENING_MAX_M));
        let mut best: Option<Facing> = None;
        let mut offer = |found: Facing| {
            if best.as_ref().is_none_or(|b| found.width < b.width) {
                best = Some(found);
            }
        };
        for o in self.ends_near.along(&ray, axis.thickness / 2.0 + FINISH_MAX_M) {
            self.end_ahead(f, o as usize).into_iter().for_each(&mut offer);
        }
        for a in self.axes_near.along(&ray, FINISH_MAX_M) {
            if a != f.axis {
                self.side_ahead(f, a).into_iter().for_each(&mut offer);
            }
        }
        for c in self.columns_near.along(&ray, 1.0) {
            self.column_ahead(f, c as usize).into_iter().for_each(&mut offer);
        }
        best.filter(|b| b.width >= OPENING_MIN_M)
    }

    fn end_ahead(&self, f: &FreeEnd, o: usize) -> Option<Facing> {
        let g = &self.joined.free[o];
        let (a, b) = (&self.axes[f.axis as usize], &self.axes[g.axis as usize]);
        let at = b.carrier.at(b.span[g.end]);
        let (s, sign) = (a.carrier.s_of(at), if f.end == 1 { 1.0 } else { -1.0 });
        let out = b.carrier.tangent(b.span[g.end]) * if g.end == 1 { 1.0 } else { -1.0 };
        let ahead = a.carrier.tangent(s) * sign;
        let half = a.thickness.max(b.thickness) / 2.0;
        let width = spans::tidy((s - a.span[f.end]) * sign);
        let faces = (g.axis, g.end) != (f.axis, f.end)
            && width > 0.0
            && a.carrier.offset_of(at).abs() <= half.max(ERROR_GAP_M)
            && out.dot(ahead) < -CROSSING_MIN_RAD.cos();
        // On the axis of the wall that looks at it, so that the opening runs straight.
        let on_axis = a.carrier.at(s);
        faces.then_some(Facing {
            width,
            jamb: Jamb { at: on_axis, node: Some(g.node), edge: None },
            other: Some(o),
            is_square: at.distance(on_axis) <= ERROR_GAP_M.max(IN_LINE_SHARE * half),
        })
    }

    fn side_ahead(&self, f: &FreeEnd, other: u32) -> Option<Facing> {
        let (a, b) = (&self.axes[f.axis as usize], &self.axes[other as usize]);
        let sign = if f.end == 1 { 1.0 } else { -1.0 };
        let stations = &self.joined.stations[other as usize];
        let (first, last) = (stations.first()?, stations.last()?);
        let mut best: Option<Facing> = None;
        for p in a.carrier.crossings(&b.carrier) {
            let (s, t) = (a.carrier.s_of(p), b.carrier.s_of(p));
            let sin = a.carrier.tangent(s).perp_dot(b.carrier.tangent(t)).abs();
            let reach = a.thickness / 2.0 + ERROR_GAP_M;
            let width = spans::tidy((s - a.span[f.end]) * sign - b.thickness / 2.0 / sin.max(0.1));
            let meets = sin > 0.5 && t > first.0 - reach && t < last.0 + reach;
            if meets && width > -b.thickness && best.as_ref().is_none_or(|x| width < x.width) {
                let edges = &self.joined.edges[other as usize];
                let k =
                    stations.windows(2).position(|w| t <= w[1].0).unwrap_or(edges.len().saturating_sub(1));
                let at = a.carrier.at(a.span[f.end] + sign * width);
                let jamb = Jamb { at, node: None, edge: edges.get(k).copied() };
                best = Some(Facing { width, jamb, other: None, is_square: sin > SQUARE_SIN });
            }
        }
        best
    }

    fn column_ahead(&self, f: &FreeEnd, c: usize) -> Option<Facing> {
        let a = &self.axes[f.axis as usize];
        let sign = if f.end == 1 { 1.0 } else { -1.0 };
        let (node, column) = &self.joined.columns[c];
        let half = a.thickness / 2.0;
        let offsets = column.ring.iter().map(|p| a.carrier.offset_of(*p));
        let (lo, hi) = offsets.fold((f64::MAX, f64::MIN), |b, o| (b.0.min(o), b.1.max(o)));
        let ahead = column.ring.iter().map(|p| (a.carrier.s_of(*p) - a.span[f.end]) * sign);
        let width = spans::tidy(ahead.fold(f64::MAX, f64::min));
        if lo > half || hi < -half || width < -ERROR_GAP_M {
            return None;
        }
        let at = a.carrier.at(a.span[f.end] + sign * width);
        Some(Facing { width, jamb: Jamb { at, node: Some(*node), edge: None }, other: None, is_square: true })
    }

    fn opening(&self, f: &FreeEnd, to: &Facing) -> Option<Opening> {
        let a = &self.axes[f.axis as usize];
        let s0 = a.span[f.end];
        let s1 = s0 + if f.end == 1 { to.width } else { -to.width };
        let gap = ordered(s0, s1);
        let seen = self.evidence.look(&a.carrier, a.thickness, gap);
        let (kind, shown) = seen.verdict();
        let limit = match (kind, to.other) {
            (OpeningKind::Passage, Some(_)) if to.is_square => PASSAGE_MAX_M,
            (OpeningKind::Passage, Some(_)) => 0.0,
            (OpeningKind::Passage, None) if to.is_square && self.is_held(f) => SIDE_OPENING_MAX_M,
            (OpeningKind::Passage, None) => 0.0,
            _ => OPENING_MAX_M,
        };
        if to.width > limit {
            return None;
        }
        if self.is_beside_wall(f.axis, gap)
            || self.holds_pier(a, gap)
            || (kind == OpeningKind::Passage && self.is_blocked(a, gap))
        {
            return None;
        }
        let other = to.other.map(|o| &self.axes[self.joined.free[o].axis as usize]);
        let sides = a.sides.iter().flatten().chain(&a.inner);
        let both = sides.filter(|f| other.is_some_and(|b| b.has_face(**f))).copied().collect::<Vec<u32>>();
        let uncut = self.drawn.along(&both, &a.carrier, gap);
        let is_shown = kind == OpeningKind::Door && !seen.marks.is_empty();
        let through = self.with_abutting(a, gap, uncut, is_shown);
        Some(Opening {
            kind,
            centre: a.carrier.at((s0 + s1) / 2.0),
            width_m: to.width,
            thickness_m: a.thickness,
            jambs: [
                Jamb { at: self.graph.nodes[f.node as usize].at, node: Some(f.node), edge: None },
                to.jamb,
            ],
            shown,
            marks: seen.marks,
            faces: self.drawn.refs(&seen.faces),
            through: self.drawn.refs(&through),
        })
    }

    /// The faces that an opening in an uncut wall leads through, with those of a wall that stands flush against it and is not
    /// cut there either: rooms that are drawn each with walls of their own, linings, second leaves. A door that is shown by
    /// its symbol leads through a second leaf behind a cavity too.
    fn with_abutting(&self, wall: &Axis, gap: Span, mut through: Vec<u32>, is_shown: bool) -> Vec<u32> {
        if through.is_empty() && !is_shown || !wall.carrier.is_line() {
            return through;
        }
        let apart = if is_shown { CAVITY_MAX_M } else { ERROR_GAP_M };
        let half = wall.thickness / 2.0;
        let mut beside: BTreeMap<u32, Vec<(u32, f64)>> = BTreeMap::new();
        for f in self.faces_near.along(&wall.carrier.points(gap), half + THICKNESS_USUAL_M) {
            let face = &self.drawn.faces[f as usize];
            let ends = face.path.ends();
            let [from, to] = ends.map(|p| wall.carrier.offset_of(p));
            let own = ends.map(|p| wall.carrier.s_of(p));
            let along = spans::overlap(ordered(own[0], own[1]), gap).map_or(0.0, spans::length);
            let is_straight = matches!(face.path, Path::Line { .. }) && (from - to).abs() <= COLLINEAR_M;
            if face.is_closed && is_straight && along >= BESIDE_SHARE * spans::length(gap) {
                beside.entry(face.wall).or_default().push((f, from));
            }
        }
        for faces in beside.into_values().filter(|faces| faces.len() > 1) {
            let reach = faces.iter().map(|(_, offset)| offset.abs() - half);
            let [nearest, farthest] =
                reach.fold([f64::MAX, f64::MIN], |[low, high], r| [low.min(r), high.max(r)]);
            let is_one_side = faces.iter().all(|(_, offset)| offset * faces[0].1 > 0.0);
            let is_wall = (THICKNESS_MIN_M..=THICKNESS_USUAL_M + apart).contains(&farthest);
            if is_one_side && (-ERROR_GAP_M..=apart).contains(&nearest) && is_wall {
                through.extend(
                    faces.iter().map(|(f, _)| *f).filter(|f| !through.contains(f)).collect::<Vec<u32>>(),
                );
            }
        }
        through
    }

    /// Whether a thicker wall runs along a gap and touches what would stand in it: the gap leads nowhere.
    fn is_beside_wall(&self, axis: u32, gap: Span) -> bool {
        let a = &self.axes[axis as usize];
        let near = self.axes_near.along(&a.carrier.points(gap), THICKNESS_MAX_M);
        near.into_iter().map(|b| &self.axes[b as usize]).filter(|b| b.thickness > a.thickness).any(|b| {
            let middle = a.carrier.at((gap[0] + gap[1]) / 2.0);
            let turn = b.carrier.tangent(b.carrier.s_of(middle)).perp_dot(a.carrier.tangent(gap[0]));
            let apart = b.carrier.offset_of(middle).abs() - (a.thickness + b.thickness) / 2.0;
            let along = spans::covered(b.carrier.span_of(&a.carrier, gap), &[b.span]);
            turn.abs() < CROSSING_MIN_RAD
                && apart <= COLLINEAR_M
                && along >= BESIDE_SHARE * spans::length(gap)
        })
    }

    /// Whether a piece of wall with an outline of its own, as thick as the wall, stands in a gap and leaves some of it.
    fn holds_pier(&self, wall: &Axis, gap: Span) -> bool {
        let half = wall.thickness / 2.0;
        let mut flush: BTreeMap<u32, Vec<Span>> = BTreeMap::new();
        for f in self.faces_near.along(&wall.carrier.points(gap), half + COLLINEAR_M) {
            let face = &self.drawn.faces[f as usize];
            let ends = face.path.ends();
            let is_flush = |p: DVec2| (wall.carrier.offset_of(p).abs() - half).abs() <= COLLINEAR_M;
            let [s, t] = ends.map(|p| wall.carrier.s_of(p));
            if face.is_closed && ends.into_iter().all(is_flush) && (s - t).abs() > wall.thickness / 2.0 {
                flush.entry(face.wall).or_default().push(ordered(s, t));
            }
        }
        let reach = PIER_MIN_M..PIER_MAX_SHARE * spans::length(gap);
        flush.values().any(|of| reach.contains(&spans::covered(gap, of)))
    }

    /// Whether drawn walls run across the way through a gap on both sides of it: the gap lies in a pier or a niche.
    fn is_blocked(&self, wall: &Axis, gap: Span) -> bool {
        let half = wall.thickness / 2.0;
        let looks = LOOKS.map(|share| gap[0] + spans::length(gap) * share);
        [1.0, -1.0].into_iter().all(|side| {
            looks.into_iter().all(|s| {
                let out = wall.carrier.tangent(s).perp() * side;
                let way = [half + ERROR_GAP_M, half + CLEAR_MAX_M].map(|d| wall.carrier.at(s) + out * d);
                self.faces_near.along(&way, 0.0).into_iter().any(|f| {
                    let trace = trace(&self.drawn.faces[f as usize].path);
                    trace.windows(2).any(|w| shell::cross(way[0], way[1], [w[0], w[1]]))
                })
            })
        })
    }

    /// Whether the wall of a free end is joined to something at its other end, and runs: what is shorter than half its
    /// thickness is a stub that ends nowhere.
    fn is_held(&self, f: &FreeEnd) -> bool {
        let axis = &self.axes[f.axis as usize];
        let runs = spans::length(axis.span) >= axis.thickness / 2.0;
        runs && !self.joined.free.iter().any(|g| g.axis == f.axis && g.end != f.end)
    }
}

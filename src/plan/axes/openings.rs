//! Openings: gaps between wall ends, and what the drawing shows in them.

use glam::DVec2;

use super::assembly::{Axes, Axis, Spare};
use super::carrier::Carrier;
use super::joints::{FreeEnd, Joined};
use super::near::Buckets;
use super::spans::{self, Span};
use super::tolerances::{
    CROSSING_MIN_RAD, ERROR_GAP_M, LEAF_M, OPENING_MAX_M, OPENING_MIN_M, PASSAGE_MAX_M, SIDE_OPENING_MAX_M,
};
use super::{AxisGraph, Drawn, FaceRef, Jamb, Mark, Opening, OpeningKind, Path, Role};

/// How far beside the wall's faces something still lies in an opening.
const BESIDE_M: f64 = 0.06;
/// How far from a jamb a door leaf may turn.
const HINGE_M: f64 = 0.15;
/// Share of the gap that a window line runs along.
const PANE_COVER: f64 = 0.6;

/// Half the width in which things lie in the gap of a wall drawn as one line.
const SINGLE_HALF_M: f64 = 0.21;

/// A wall that ends in front of another's side leaves a passage only if it stands this square to it.
const SQUARE_SIN: f64 = 0.97;

/// What a gap ends at.
struct Facing {
    /// Clear width.
    width: f64,
    jamb: Jamb,
    /// The free end at the other side, by its place in the list of free ends.
    other: Option<usize>,
    /// Whether the wall stands square to what it ends at.
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
    found.sort_by(|a, b| a.centre.x.total_cmp(&b.centre.x).then(a.centre.y.total_cmp(&b.centre.y)));
    for o in &found {
        if o.kind == OpeningKind::Window {
            out.see_through.extend(&o.faces);
        }
    }
    let in_opening: Vec<FaceRef> = found.iter().flat_map(|o| o.faces.clone()).collect();
    out.leftovers.retain(|l| !in_opening.contains(&l.face));
    out.openings = found;
}

struct Scene<'a> {
    drawn: &'a Drawn,
    axes: &'a [Axis],
    spares: &'a [Spare],
    joined: &'a Joined,
    graph: &'a AxisGraph,
    axes_near: Buckets,
    ends_near: Buckets,
    columns_near: Buckets,
    marks_near: Buckets,
    spares_near: Buckets,
}

impl<'a> Scene<'a> {
    fn new(drawn: &'a Drawn, all: &'a Axes, joined: &'a Joined, graph: &'a AxisGraph) -> Self {
        let mut near: [Buckets; 5] = [1.0, 1.0, 1.0, 1.0, 1.0].map(Buckets::new);
        for (i, a) in all.axes.iter().enumerate() {
            near[0].add(i as u32, &a.carrier.points(a.span));
        }
        for (i, f) in joined.free.iter().enumerate() {
            near[1].add(i as u32, &[graph.nodes[f.node as usize].at]);
        }
        for (i, (_, c)) in joined.columns.iter().enumerate() {
            near[2].add(i as u32, &c.ring);
        }
        for (i, m) in drawn.marks.iter().enumerate() {
            m.paths.iter().for_each(|p| near[3].add(i as u32, &trace(p)));
        }
        for (i, s) in all.spares.iter().enumerate() {
            near[4].add(i as u32, &s.carrier.points(s.span));
        }
        let [axes_near, ends_near, columns_near, marks_near, spares_near] = near;
        Self {
            drawn,
            axes: &all.axes,
            spares: &all.spares,
            joined,
            graph,
            axes_near,
            ends_near,
            columns_near,
            marks_near,
            spares_near,
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
            if best.as_ref().is_none_or(|b| found.width < b.width - 1e-9) {
                best = Some(found);
            }
        };
        for o in self.ends_near.along(&ray, axis.thickness / 2.0 + BESIDE_M) {
            self.end_ahead(f, o as usize).into_iter().for_each(&mut offer);
        }
        for a in self.axes_near.along(&ray, BESIDE_M) {
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
        let width = (s - a.span[f.end]) * sign;
        let faces = (g.axis, g.end) != (f.axis, f.end)
            && width > 0.0
            && a.carrier.offset_of(at).abs() <= half.max(ERROR_GAP_M)
            && out.dot(ahead) < -CROSSING_MIN_RAD.cos();
        faces.then_some(Facing {
            width,
            jamb: Jamb { at, node: Some(g.node), edge: None },
            other: Some(o),
            is_square: true,
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
            let width = (s - a.span[f.end]) * sign - b.thickness / 2.0 / sin.max(0.1);
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
        let width = ahead.fold(f64::MAX, f64::min);
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
        let seen = self.look(a, gap);
        let (kind, evidence) = seen.verdict();
        let limit = match (kind, to.other) {
            (OpeningKind::Passage, Some(_)) => PASSAGE_MAX_M,
            (OpeningKind::Passage, None) if to.is_square && self.is_held(f) => SIDE_OPENING_MAX_M,
            (OpeningKind::Passage, None) => 0.0,
            _ => OPENING_MAX_M,
        };
        if to.width > limit {
            return None;
        }
        Some(Opening {
            kind,
            centre: a.carrier.at((s0 + s1) / 2.0),
            width_m: to.width,
            thickness_m: a.thickness,
            jambs: [
                Jamb { at: self.graph.nodes[f.node as usize].at, node: Some(f.node), edge: None },
                to.jamb,
            ],
            evidence,
            marks: seen.marks,
            faces: seen.faces,
        })
    }

    /// Whether the wall of a free end is joined to something at its other end.
    fn is_held(&self, f: &FreeEnd) -> bool {
        !self.joined.free.iter().any(|g| g.axis == f.axis && g.end != f.end)
    }

    /// What is drawn in a gap.
    fn look(&self, a: &Axis, gap: Span) -> Seen {
        let band = Band {
            carrier: a.carrier,
            gap,
            half: if a.thickness > 0.0 { a.thickness / 2.0 } else { SINGLE_HALF_M },
        };
        let around = a.carrier.points(gap);
        let mut seen = Seen::default();
        for m in self.marks_near.along(&around, band.half + LEAF_M[1]) {
            let mark = &self.drawn.marks[m as usize];
            if seen.look_at(mark, &band) {
                seen.marks.push(m);
            }
        }
        let groups: Vec<u32> = seen.marks.iter().map(|m| self.drawn.marks[*m as usize].group).collect();
        for m in self.marks_near.along(&around, band.half + 2.0 * LEAF_M[1]) {
            if groups.contains(&self.drawn.marks[m as usize].group) {
                seen.marks.push(m);
            }
        }
        seen.marks.sort_unstable();
        seen.marks.dedup();
        for s in self.spares_near.along(&around, band.half + LEAF_M[1]) {
            let spare = &self.spares[s as usize];
            let path = path_of(spare);
            let is_swing = band.has_swing(&path);
            seen.swing |= is_swing;
            seen.panes |= band.has_pane(&path) && !spare.is_cap;
            if is_swing || (!spare.is_cap && band.holds(&path)) {
                seen.faces.extend(&spare.faces);
            }
        }
        seen.faces.sort_unstable();
        seen.faces.dedup();
        seen
    }
}

fn ordered(a: f64, b: f64) -> Span {
    [a.min(b), a.max(b)]
}

fn trace(path: &Path) -> Vec<DVec2> {
    let (carrier, span) = Carrier::of(path);
    if span[1] - span[0] < 1e-9 || !carrier.at(span[0]).is_finite() {
        return vec![path.ends()[0]];
    }
    carrier.points(span)
}

fn path_of(spare: &Spare) -> Path {
    let [a, b] = spare.span.map(|s| spare.carrier.at(s));
    match spare.carrier {
        Carrier::Line { .. } => Path::Line { a, b },
        Carrier::Circle { centre, radius, base_rad } => Path::Arc {
            centre,
            radius,
            start_rad: base_rad + spare.span[0] / radius,
            sweep_rad: spans::length(spare.span) / radius,
        },
    }
}

/// The place of a gap in its wall.
struct Band {
    carrier: Carrier,
    gap: Span,
    half: f64,
}

impl Band {
    /// Whether a point lies in the gap or at most `more` beside it.
    fn has(&self, p: DVec2, more: f64) -> bool {
        let s = self.carrier.s_of(p);
        s > self.gap[0] - more
            && s < self.gap[1] + more
            && self.carrier.offset_of(p).abs() <= self.half + more
    }

    /// Whether the middle of a piece lies in the gap.
    fn holds(&self, path: &Path) -> bool {
        let points = trace(path);
        let n = points.len() / 2;
        let middle = if points.len() == 2 { points[0].midpoint(points[1]) } else { points[n] };
        self.has(middle, ERROR_GAP_M)
    }

    /// A line along the wall through most of the gap.
    fn has_pane(&self, path: &Path) -> bool {
        let ends = path.ends();
        if ends.iter().any(|e| self.carrier.offset_of(*e).abs() > self.half + ERROR_GAP_M) {
            return false;
        }
        let s = ordered(self.carrier.s_of(ends[0]), self.carrier.s_of(ends[1]));
        let shared = spans::overlap(s, self.gap).map_or(0.0, spans::length);
        let is_straight = matches!(path, Path::Line { .. }) == self.carrier.is_line();
        is_straight
            && shared >= PANE_COVER * spans::length(self.gap)
            && spans::length(s) < 1.6 * spans::length(self.gap)
    }

    /// An arc about a hinge at a jamb that closes the gap, alone or with its twin.
    fn has_swing(&self, path: &Path) -> bool {
        let Path::Arc { centre, radius, sweep_rad, .. } = *path else { return false };
        let width = spans::length(self.gap);
        let s = self.carrier.s_of(centre);
        let at_jamb = self.gap.iter().any(|g| (g - s).abs() <= HINGE_M);
        at_jamb
            && self.carrier.offset_of(centre).abs() <= self.half + HINGE_M
            && (0.3..3.2).contains(&sweep_rad)
            && radius > 0.35 * width
            && radius < 1.15 * width + 0.05
    }
}

/// What was found in a gap.
#[derive(Debug, Default)]
struct Seen {
    swing: bool,
    door: Option<String>,
    window: Option<String>,
    panes: bool,
    marks: Vec<u32>,
    faces: Vec<FaceRef>,
}

impl Seen {
    /// Takes a mark as evidence; whether it belongs to the opening.
    fn look_at(&mut self, mark: &Mark, band: &Band) -> bool {
        let swing = mark.paths.iter().any(|p| band.has_swing(p));
        let inside = mark.paths.iter().any(|p| band.holds(p));
        let panes = mark.paths.iter().any(|p| band.has_pane(p));
        self.swing |= swing;
        match mark.role {
            Role::Door if inside || swing => self.door.get_or_insert(mark.word.clone()),
            Role::Window | Role::Glazing if inside => self.window.get_or_insert(mark.word.clone()),
            Role::Unknown if panes => {
                self.panes = true;
                return true;
            }
            _ => return swing || inside,
        };
        true
    }

    fn verdict(&self) -> (OpeningKind, String) {
        let with = |what: &str, word: &str| {
            if word.is_empty() { what.to_string() } else { format!("{what}: {word}") }
        };
        if let Some(word) = &self.door {
            return (
                OpeningKind::Door,
                with(if self.swing { "door swing and layer or block" } else { "layer or block" }, word),
            );
        }
        if self.swing {
            return (OpeningKind::Door, "door swing".into());
        }
        if let Some(word) = &self.window {
            return (OpeningKind::Window, with("layer or block", word));
        }
        if self.panes {
            return (OpeningKind::Window, "lines along the wall between its jambs".into());
        }
        (OpeningKind::Passage, "nothing is drawn in the gap".into())
    }
}

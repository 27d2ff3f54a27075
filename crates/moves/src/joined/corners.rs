//! Corners of walls drawn point by point (spec 1): where an end of a wall moves, its faces keep their distance from the axis,
//! and every corner stays on the two faces that meet in it, also with a wall that stands still.

use std::collections::BTreeSet;

use glam::DVec2;

use super::bars::{Bar, Bars, Motion, Moving};
use super::{CROSSING_MIN_RAD, Refusal};
use enfilade_cad::drawing::{Editable, Format, Shape};
use enfilade_plan::Plan;
use enfilade_plan::axes::{AxisGraph, FaceRef};
use enfilade_plan::graph::{Graph, Handle};
use enfilade_plan::sizes::ERROR_GAP_M;
use enfilade_plan::structure::{face_handles, handle_at};

/// Faces whose directions differ by less than this are one face that bends at the joint.
const STRAIGHT_RAD: f64 = 0.02;

/// Pieces of a bar this near to one line are one face.
const SAME_LINE_M: f64 = 0.002;

/// How far beyond half its thickness a corner of a wall's end may lie from it along the wall.
const END_REACH_M: f64 = 0.06;

/// The least share of itself to which a bend may shrink a face's distance in its mitre.
const BEND_COS_MIN: f64 = 0.3;

/// A face line at a corner: the bar that it belongs to, if one, and its direction as drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Line {
    bar: Option<usize>,
    direction: DVec2,
}

/// How a corner follows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Rule {
    /// It stays on both lines.
    Meet([Line; 2]),
    /// It stays on both of two faces that go straight on: bars and their ends.
    Bend([(usize, usize); 2]),
    /// It stays where it is as seen from the end of a bar.
    End(usize, usize),
    /// It stays at its share of the bar's length.
    Along(usize),
}

/// One corner with all control points that meet in it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Corner {
    pub handles: Vec<Handle>,
    pub rule: Rule,
}

pub(super) fn too_acute() -> String {
    format!("would make walls meet at less than {:.0}°, where no mitre holds", CROSSING_MIN_RAD.to_degrees())
}

impl Rule {
    /// Where a corner drawn at `v` goes when the ends of all bars stand at `ends`.
    pub fn moved(self, bars: &[Bar], v: DVec2, ends: &[[DVec2; 2]]) -> DVec2 {
        let turn = |b: usize| Turn::new(&bars[b], ends[b]);
        match self {
            Self::Meet(lines) => {
                let [(p, d), (q, e)] = lines.map(|l| match l.bar {
                    Some(b) => (turn(b).apply(v), turn(b).turned(l.direction)),
                    None => (v, l.direction),
                });
                let sin = d.perp_dot(e);
                if sin.abs() < CROSSING_MIN_RAD.sin() / 2.0 {
                    p.midpoint(q)
                } else {
                    p + d * ((q - p).perp_dot(e) / sin)
                }
            }
            Self::Bend([(a, end), (b, _)]) => {
                let (n, drawn) = (ends[a][end], bars[a].ends[end]);
                let normal = bars[a].along().perp();
                let offset = (v - drawn).dot(normal);
                let [m, o] = [a, b].map(|k| turn(k).turned(normal));
                let Some(middle) = (m + o).try_normalize() else { return turn(a).apply(v) };
                let beyond = (v - drawn).dot(bars[a].along());
                n + middle * (offset / middle.dot(m).max(BEND_COS_MIN)) - middle.perp() * beyond
            }
            Self::End(b, end) => ends[b][end] + turn(b).turned(v - bars[b].ends[end]),
            Self::Along(b) => {
                let (bar, [from, to]) = (&bars[b], ends[b]);
                let length = bar.ends[0].distance(bar.ends[1]);
                let share = (v - bar.ends[0]).dot(bar.along()) / length;
                let beside = (v - bar.ends[0]).dot(bar.along().perp());
                from.lerp(to, share) + turn(b).turned(bar.along()).perp() * beside
            }
        }
    }

    /// Whether the two faces meet at too small an angle.
    pub fn is_acute(self, bars: &[Bar], ends: &[[DVec2; 2]]) -> bool {
        let Self::Meet(lines) = self else { return false };
        let turned = |b: usize, d: DVec2| Turn::new(&bars[b], ends[b]).turned(d);
        let [d, e] = lines.map(|l| l.bar.map_or(l.direction, |b| turned(b, l.direction)));
        d.perp_dot(e).abs() < CROSSING_MIN_RAD.sin()
    }

    pub fn bars(&self) -> Vec<usize> {
        match self {
            Self::Meet(lines) => lines.iter().filter_map(|l| l.bar).collect(),
            Self::Bend(ends) => ends.iter().map(|e| e.0).collect(),
            Self::End(b, _) | Self::Along(b) => vec![*b],
        }
    }
}

/// The rigid motion that takes a bar's line to where it stands now.
pub(super) struct Turn {
    from: DVec2,
    to: DVec2,
    /// Cosine and sine.
    turn: DVec2,
}

impl Turn {
    pub fn new(bar: &Bar, ends: [DVec2; 2]) -> Self {
        let now = (ends[1] - ends[0]).normalize_or_zero();
        let turn = DVec2::new(bar.along().dot(now), bar.along().perp_dot(now));
        let still = bar.motion == Motion::Still || turn == DVec2::ZERO;
        if still {
            return Self { from: DVec2::ZERO, to: DVec2::ZERO, turn: DVec2::X };
        }
        Self { from: bar.ends[0], to: ends[0], turn }
    }

    pub fn turned(&self, d: DVec2) -> DVec2 {
        self.turn.rotate(d)
    }

    fn apply(&self, p: DVec2) -> DVec2 {
        self.to + self.turned(p - self.from)
    }
}

/// What holds what lies in a region of Keep.
pub(super) fn kept_words(plan: &Plan) -> &'static str {
    if plan.format == Format::Dxf { "EF-KEEP holds it" } else { "a space that says Keep holds it" }
}

/// Why a control point cannot be written where it should go.
pub(super) fn cannot_follow(plan: &Plan, (w, _): Handle) -> Option<String> {
    let wall = &plan.walls[w as usize];
    match (&wall.editable, &wall.shape) {
        (Editable::No(why), _) => Some(why.clone()),
        (Editable::WithInsert { .. } | Editable::Wall { .. }, _) => {
            Some(format!("{} moves only as a whole", crate::whole_of(plan, wall)))
        }
        (Editable::Free, Shape::Arc { .. } | Shape::Circle { .. }) => {
            Some("an arc moves only as a whole".into())
        }
        (Editable::Free, _) => None,
    }
}

/// Looks for corners.
pub(super) struct Finder<'a> {
    pub plan: &'a Plan,
    pub graph: &'a Graph,
    pub axes: &'a AxisGraph,
    pub moving: Moving<'a>,
    pub bars: &'a Bars,
}

/// A straight drawn piece at a corner.
#[derive(Clone, Copy, PartialEq)]
struct Piece {
    bar: usize,
    direction: DVec2,
}

impl Finder<'_> {
    /// Whether a bar of a corner turns, as a whole or because its ends go different ways.
    pub fn turns(&self, rule: Rule) -> bool {
        rule.bars().into_iter().map(|b| self.bar(b)).any(|b| {
            let shifts = b.groups.iter().all(|own| self.moving.only_shifts(own));
            b.motion == Motion::Turning || !shifts
        })
    }

    /// What the walls of a corner may do, in a word: where all that moves them shifts, one in line with them is only drawn
    /// out of line.
    pub fn may(&self, rule: Rule) -> &'static str {
        let mut groups = rule.bars().into_iter().flat_map(|b| &self.bar(b).groups);
        if groups.all(|own| self.moving.only_shifts(own)) { "shift" } else { "turn" }
    }

    fn bar(&self, b: usize) -> &Bar {
        &self.bars.list[b]
    }

    fn faces(&self, edge: u32) -> impl Iterator<Item = &FaceRef> + '_ {
        let e = &self.axes.edges[edge as usize];
        e.left.iter().chain(&e.right).chain(&e.inner)
    }

    /// Nodes of the graph that may have to follow: all of bars whose line moves, and of what abuts them.
    pub fn nodes(&self) -> BTreeSet<u32> {
        let mut out = BTreeSet::new();
        for bar in self.bars.list.iter().filter(|b| matches!(b.motion, Motion::Rigid | Motion::Turning)) {
            let ends = bar.edges.iter().flat_map(|e| self.axes.edges[*e as usize].nodes);
            let beside = ends.flat_map(|n| &self.bars.at_node[n as usize]);
            for e in bar.edges.iter().chain(beside) {
                for h in self.faces(*e).flat_map(|f| face_handles(self.plan, *f)) {
                    out.insert(self.graph.control_nodes[h.0 as usize][h.1 as usize]);
                }
            }
        }
        out
    }

    /// How a node's corner follows; `None` where its groups' own motion is right, or nobody's.
    pub fn rule(&self, node: u32) -> Result<Option<Rule>, Refusal> {
        let pieces = self.pieces(node);
        if pieces.iter().any(|p| self.bar(p.bar).motion == Motion::Torn) {
            return Ok(None);
        }
        let at = self.graph.nodes[node as usize];
        let mut best: Option<[Piece; 2]> = None;
        for (i, p) in pieces.iter().enumerate() {
            for q in pieces[i + 1..].iter().filter(|q| q.bar != p.bar) {
                let sin = |pair: &[Piece; 2]| pair[0].direction.perp_dot(pair[1].direction).abs();
                if best.is_none_or(|b| sin(&[*p, *q]) > sin(&b)) {
                    best = Some([*p, *q]);
                }
            }
        }
        match (best, pieces.first()) {
            (Some(pair), _) => self.joint(node, at, pair),
            (None, Some(piece)) => Ok(self.single(at, *piece)),
            (None, None) => Ok(None),
        }
    }

    /// Straight pieces of bars that end at a node.
    fn pieces(&self, node: u32) -> Vec<Piece> {
        let mut out: Vec<Piece> = Vec::new();
        // Lines drawn over one another are looked at once.
        let mut seen: BTreeSet<(usize, [u64; 2])> = BTreeSet::new();
        for (w, c) in &self.graph.handles[node as usize] {
            let n = self.graph.control_nodes[*w as usize].len() as u32;
            for part in [*c, (c + n - 1) % n] {
                let Some(bar) = self.bars.of_face.get(&(*w, part)) else { continue };
                let [p, q] = face_handles(self.plan, (*w, part))[..] else { continue };
                let direction = (handle_at(self.plan, q) - handle_at(self.plan, p)).normalize_or_zero();
                if direction == DVec2::ZERO || ![p, q].contains(&(*w, *c)) {
                    continue;
                }
                if !seen.insert((*bar, direction.to_array().map(f64::to_bits))) {
                    continue;
                }
                let piece = Piece {
                    bar: *bar,
                    direction: self.along(*bar, self.graph.nodes[node as usize], direction),
                };
                if !out.contains(&piece) {
                    out.push(piece);
                }
            }
        }
        out
    }

    /// The direction of a bar's face through a point, by its longest piece: a short one has it less exactly.
    fn along(&self, bar: usize, at: DVec2, direction: DVec2) -> DVec2 {
        let scale = self.plan.human_scale;
        let mut best = (0.0, direction);
        for f in self.bar(bar).edges.iter().flat_map(|e| self.faces(*e)) {
            let [p, q] = face_handles(self.plan, *f)[..] else { continue };
            let [a, b] = [p, q].map(|h| handle_at(self.plan, h) * scale);
            let along = (b - a).normalize_or_zero();
            let is_same = along.perp_dot(direction).abs() < STRAIGHT_RAD.sin()
                && along.perp_dot(at - a).abs() < SAME_LINE_M * scale;
            if is_same && a.distance(b) > best.0 {
                best = (a.distance(b), along);
            }
        }
        best.1
    }

    /// Two bars whose faces meet in a corner.
    fn joint(&self, node: u32, at: DVec2, pair: [Piece; 2]) -> Result<Option<Rule>, Refusal> {
        let bars = pair.map(|p| self.bar(p.bar));
        let is_turning = bars.iter().any(|b| b.motion == Motion::Turning);
        let own = self.groups_at(node);
        let keeps = |b: &Bar| match b.motion {
            Motion::Rigid => b.groups[0] == own,
            _ => self.moving.only_along(&own, b.along()),
        };
        if !is_turning && bars.iter().all(|b| keeps(b)) {
            return Ok(None);
        }
        let sin = pair[0].direction.perp_dot(pair[1].direction).abs();
        if sin >= CROSSING_MIN_RAD.sin() {
            return Ok(Some(Rule::Meet(pair.map(|p| Line { bar: Some(p.bar), direction: p.direction }))));
        }
        let ends = pair.map(|p| (p.bar, self.bar(p.bar).nearest_end(at).0));
        if sin < STRAIGHT_RAD.sin() {
            return Ok(Some(Rule::Bend(ends)));
        }
        let mover = bars.iter().flat_map(|b| b.groups.iter().flatten()).chain(&own).next();
        mover.map_or(Ok(None), |group| Err(Refusal { group: *group, why: too_acute() }))
    }

    fn groups_at(&self, node: u32) -> Vec<usize> {
        let all = self.graph.handles[node as usize].iter().flat_map(|h| self.moving.of(h));
        all.collect::<BTreeSet<usize>>().into_iter().collect()
    }

    /// A corner of one bar: it abuts another wall's side, or closes the bar's own end.
    fn single(&self, at: DVec2, piece: Piece) -> Option<Rule> {
        let bar = self.bar(piece.bar);
        let (end, beyond) = bar.nearest_end(at);
        if let Some(side) = self.side_at(at, piece) {
            let other = side.bar.map_or(Motion::Still, |b| self.bar(b).motion);
            let leaves = other == Motion::Still
                && self.moving.leaves(&bar.groups[end], side.direction, STRAIGHT_RAD.sin());
            let is_turning = [bar.motion, other].contains(&Motion::Turning);
            let slides = bar.motion == Motion::Rigid
                && other == Motion::Still
                && self.moving.only_along(&bar.groups[end], bar.along().perp())
                && !self.moving.only_along(&bar.groups[end], side.direction);
            if slides || is_turning && !leaves {
                let own = Line { bar: Some(piece.bar), direction: piece.direction };
                return Some(Rule::Meet([own, side]));
            }
        }
        if bar.motion != Motion::Turning {
            return None;
        }
        let is_end = beyond >= -(bar.half_m + END_REACH_M * self.plan.human_scale);
        Some(if is_end { Rule::End(piece.bar, end) } else { Rule::Along(piece.bar) })
    }

    /// The face of another wall, joined with the bar, on which a corner lies.
    fn side_at(&self, at: DVec2, piece: Piece) -> Option<Line> {
        let bar = self.bar(piece.bar);
        let scale = self.plan.human_scale;
        let nodes = bar.edges.iter().flat_map(|e| self.axes.edges[*e as usize].nodes);
        let around = nodes.flat_map(|n| &self.bars.at_node[n as usize]).filter(|e| !bar.edges.contains(e));
        let around: BTreeSet<u32> = around.copied().collect();
        let mut best: Option<(f64, Line)> = None;
        for f in around.into_iter().flat_map(|e| self.faces(e)) {
            let other = self.bars.of_face.get(f).copied();
            let [p, q] = face_handles(self.plan, *f)[..] else { continue };
            let moves = || [p, q].iter().any(|h| !self.moving.of(h).is_empty());
            if other.map_or_else(moves, |b| self.bar(b).motion == Motion::Torn) {
                continue;
            }
            let [a, b] = [p, q].map(|h| handle_at(self.plan, h) * scale);
            let direction = (b - a).normalize_or_zero();
            let far = direction.perp_dot(at - a).abs();
            let along = (at - a).dot(direction);
            let reach = ERROR_GAP_M * scale;
            let is_on = far <= reach && (-reach..=a.distance(b) + reach).contains(&along);
            let is_across = direction.perp_dot(piece.direction).abs() >= CROSSING_MIN_RAD.sin();
            if is_on && is_across && best.is_none_or(|b| far < b.0) {
                best = Some((far, Line { bar: other, direction }));
            }
        }
        best.map(|(_, line)| match line.bar {
            Some(b) => Line { direction: self.along(b, at, line.direction), ..line },
            None => line,
        })
    }
}

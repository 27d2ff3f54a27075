//! Joints of thick walls (spec 1): where an end of a wall moves, its faces keep their distance from the axis,
//! and every corner stays on the two faces that meet in it, also with a wall that stands still.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;

use super::bars::{Bar, Bars, Motion, Moving};
use enfilade_cad::drawing::{Editable, Format, Shape};
use enfilade_plan::Plan;
use enfilade_plan::axes::tolerances::ERROR_GAP_M;
use enfilade_plan::axes::{AxisGraph, FaceRef};
use enfilade_plan::graph::{Graph, Handle};
use enfilade_plan::structure::{face_handles, handle_at};

/// Walls that meet at less than this angle are not mitred: the mitre would run far beyond the joint.
pub const CROSSING_MIN_RAD: f64 = 0.21;

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
struct Line {
    bar: Option<usize>,
    direction: DVec2,
}

/// How a corner follows.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Rule {
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
struct Corner {
    handles: Vec<Handle>,
    rule: Rule,
}

/// What keeps thick walls thick and joined.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Mitre {
    bars: Vec<Bar>,
    corners: Vec<Corner>,
    /// The drawn pieces of bars with such corners.
    faces: Vec<([Handle; 2], usize)>,
    /// Control points that follow although no group holds them, ascending.
    pub followers: Vec<Handle>,
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

impl Mitre {
    /// Finds all corners that need more than their group's own motion. `follows`: control points that go along
    /// their wall by themselves.
    ///
    /// # Errors
    /// The first group that moves a wall meeting another at less than [`CROSSING_MIN_RAD`].
    pub fn new(
        plan: &Plan,
        graph: &Graph,
        axes: &AxisGraph,
        moving: Moving<'_>,
        is_kept: &dyn Fn(u32) -> bool,
        follows: &BTreeSet<Handle>,
    ) -> Result<Self, Refusal> {
        let bars = Bars::new(plan, axes, moving);
        let finder = Finder { plan, graph, axes, moving, bars: &bars };
        let mut out = Self::default();
        let mut followers: BTreeSet<Handle> = BTreeSet::new();
        for node in finder.nodes() {
            let Some(rule) = finder.rule(node)? else { continue };
            let mut handles = Vec::new();
            for h in &graph.handles[node as usize] {
                let is_own = !moving.of(h).is_empty();
                let why = is_kept(node).then(|| kept_words(plan).into()).or_else(|| cannot_follow(plan, *h));
                match why {
                    Some(_) if is_own || follows.contains(h) => {}
                    Some(why) => {
                        let (turns, may) = (finder.turns(rule), finder.may(rule));
                        out.stuck.push(Stuck { wall: h.0, turns, may, why });
                    }
                    None => {
                        handles.push(*h);
                        if !is_own {
                            followers.insert(*h);
                        }
                    }
                }
            }
            if !handles.is_empty() {
                out.corners.push(Corner { handles, rule });
            }
        }
        out.followers = followers.into_iter().collect();
        let cornered: BTreeSet<usize> = out.corners.iter().flat_map(|c| c.rule.bars()).collect();
        let faces = bars.of_face.iter().filter(|(_, b)| cornered.contains(b));
        let ends = |(f, b): (&FaceRef, &usize)| Some((face_handles(plan, *f).try_into().ok()?, *b));
        out.faces = faces.filter_map(ends).collect();
        out.bars = bars.list;
        out.stuck.sort();
        out.stuck.dedup();
        Ok(out)
    }

    /// Where the ends of all bars stand as drawn, plan frame.
    pub fn ends(&self) -> Vec<[DVec2; 2]> {
        if self.corners.is_empty() { Vec::new() } else { self.bars.iter().map(|b| b.ends).collect() }
    }

    /// Moves the ends that a group holds.
    pub fn step(&self, ends: &mut [[DVec2; 2]], group: usize, step: impl Fn(DVec2) -> DVec2) {
        for (bar, ends) in self.bars.iter().zip(ends) {
            for (groups, end) in bar.groups.iter().zip(ends) {
                if groups.contains(&group) {
                    *end = step(*end);
                }
            }
        }
    }

    /// Puts every corner on its faces; `ends`: where the ends of the bars stand now.
    pub fn place(
        &self,
        start: &BTreeMap<u32, Vec<DVec2>>,
        ends: &[[DVec2; 2]],
        at: &mut BTreeMap<u32, Vec<DVec2>>,
    ) {
        for corner in &self.corners {
            let has_moved = |b: &usize| ends[*b] != self.bars[*b].ends;
            if !corner.rule.bars().iter().any(has_moved) {
                continue;
            }
            for (w, c) in &corner.handles {
                if let (Some(from), Some(to)) = (start.get(w), at.get_mut(w)) {
                    to[*c as usize] = self.moved(corner.rule, from[*c as usize], ends);
                }
            }
        }
    }

    fn moved(&self, rule: Rule, v: DVec2, ends: &[[DVec2; 2]]) -> DVec2 {
        let turn = |b: usize| Turn::new(&self.bars[b], ends[b]);
        match rule {
            Rule::Meet(lines) => {
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
            Rule::Bend([(a, end), (b, _)]) => {
                let (n, drawn) = (ends[a][end], self.bars[a].ends[end]);
                let normal = self.bars[a].along().perp();
                let offset = (v - drawn).dot(normal);
                let [m, o] = [a, b].map(|k| turn(k).turned(normal));
                let Some(middle) = (m + o).try_normalize() else { return turn(a).apply(v) };
                let beyond = (v - drawn).dot(self.bars[a].along());
                n + middle * (offset / middle.dot(m).max(BEND_COS_MIN)) - middle.perp() * beyond
            }
            Rule::End(b, end) => ends[b][end] + turn(b).turned(v - self.bars[b].ends[end]),
            Rule::Along(b) => {
                let (bar, [from, to]) = (&self.bars[b], ends[b]);
                let length = bar.ends[0].distance(bar.ends[1]);
                let share = (v - bar.ends[0]).dot(bar.along()) / length;
                let beside = (v - bar.ends[0]).dot(bar.along().perp());
                from.lerp(to, share) + turn(b).turned(bar.along()).perp() * beside
            }
        }
    }

    /// Why a layout cannot be built: walls that meet at too small an angle, a face turned end for end.
    pub fn trouble(
        &self,
        start: &BTreeMap<u32, Vec<DVec2>>,
        ends: &[[DVec2; 2]],
        at: &BTreeMap<u32, Vec<DVec2>>,
    ) -> Option<String> {
        let turned = |b: usize, d: DVec2| Turn::new(&self.bars[b], ends[b]).turned(d);
        let is_acute = |corner: &Corner| {
            let Rule::Meet(lines) = corner.rule else { return false };
            let [d, e] = lines.map(|l| l.bar.map_or(l.direction, |b| turned(b, l.direction)));
            d.perp_dot(e).abs() < CROSSING_MIN_RAD.sin()
        };
        if self.corners.iter().any(is_acute) {
            return Some(too_acute());
        }
        let is_reversed = |(handles, b): &([Handle; 2], usize)| {
            let find = |of: &BTreeMap<u32, Vec<DVec2>>| {
                let [p, q] = handles.map(|h| Some(of.get(&h.0)?[h.1 as usize]));
                Some(q? - p?)
            };
            let (Some(drawn), Some(now)) = (find(start), find(at)) else { return false };
            drawn != DVec2::ZERO && now.dot(turned(*b, drawn)) <= 0.0
        };
        let is_short = self.faces.iter().any(is_reversed);
        is_short.then(|| "would make a wall shorter than its joints need".into())
    }
}

fn too_acute() -> String {
    format!("would make walls meet at less than {:.0}°, where no mitre holds", CROSSING_MIN_RAD.to_degrees())
}

impl Rule {
    fn bars(&self) -> Vec<usize> {
        match self {
            Self::Meet(lines) => lines.iter().filter_map(|l| l.bar).collect(),
            Self::Bend(ends) => ends.iter().map(|e| e.0).collect(),
            Self::End(b, _) | Self::Along(b) => vec![*b],
        }
    }
}

/// The rigid motion that takes a bar's line to where it stands now.
struct Turn {
    from: DVec2,
    to: DVec2,
    /// Cosine and sine.
    turn: DVec2,
}

impl Turn {
    fn new(bar: &Bar, ends: [DVec2; 2]) -> Self {
        let now = (ends[1] - ends[0]).normalize_or_zero();
        let turn = DVec2::new(bar.along().dot(now), bar.along().perp_dot(now));
        let still = bar.motion == Motion::Still || turn == DVec2::ZERO;
        if still {
            return Self { from: DVec2::ZERO, to: DVec2::ZERO, turn: DVec2::X };
        }
        Self { from: bar.ends[0], to: ends[0], turn }
    }

    fn turned(&self, d: DVec2) -> DVec2 {
        self.turn.rotate(d)
    }

    fn apply(&self, p: DVec2) -> DVec2 {
        self.to + self.turned(p - self.from)
    }
}

/// What holds what lies in a region of Keep.
fn kept_words(plan: &Plan) -> &'static str {
    if plan.format == Format::Dxf { "EF-KEEP holds it" } else { "a space that says Keep holds it" }
}

/// Why a control point cannot be written where it should go.
fn cannot_follow(plan: &Plan, (w, _): Handle) -> Option<String> {
    let wall = &plan.walls[w as usize];
    match (&wall.editable, &wall.shape) {
        (Editable::No(why), _) => Some(why.clone()),
        (Editable::WithInsert { .. } | Editable::Wall { .. }, _) => {
            Some(format!("{} moves only as a whole", super::whole_of(plan, wall)))
        }
        (Editable::Free, Shape::Arc { .. } | Shape::Circle { .. }) => {
            Some("an arc moves only as a whole".into())
        }
        (Editable::Free, _) => None,
    }
}

/// Looks for corners.
struct Finder<'a> {
    plan: &'a Plan,
    graph: &'a Graph,
    axes: &'a AxisGraph,
    moving: Moving<'a>,
    bars: &'a Bars,
}

/// A straight drawn piece at a corner.
#[derive(Clone, Copy, PartialEq)]
struct Piece {
    bar: usize,
    direction: DVec2,
}

impl Finder<'_> {
    /// Whether a bar of a corner turns, as a whole or because its ends go different ways.
    fn turns(&self, rule: Rule) -> bool {
        rule.bars().into_iter().map(|b| self.bar(b)).any(|b| {
            let shifts = b.groups.iter().all(|own| self.moving.only_shifts(own));
            b.motion == Motion::Turning || !shifts
        })
    }

    /// What the walls of a corner may do, in a word: where all that moves them shifts, one in line with them is only drawn
    /// out of line.
    fn may(&self, rule: Rule) -> &'static str {
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
    fn nodes(&self) -> BTreeSet<u32> {
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
    fn rule(&self, node: u32) -> Result<Option<Rule>, Refusal> {
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

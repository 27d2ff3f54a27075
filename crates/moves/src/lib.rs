//! The parametrisation (spec 2): which nodes move, how, within what bounds; parameters → layout.
//!
//! A layout is what its parameters make of the drawing; at the identity nothing is changed, to the bit:
//!
//! ```
//! use enfilade_moves::Moves;
//! use enfilade_plan::{graph::Graph, structure, understand};
//! use enfilade_report::Report;
//!
//! let mut report = Report::default();
//! let bytes = std::fs::read("../../samples/gallery.dxf").expect("a sample of the repository");
//! let drawing = enfilade_cad::read("gallery.dxf", &bytes, &Default::default(), &mut report)?;
//! let plan = understand(&drawing, &Default::default(), &mut report)?;
//! let (graph, (axes, _)) = (Graph::new(&plan), structure::axes(&plan, &drawing));
//!
//! let moves = Moves::from_markers(&plan, &graph, &axes, &mut report);
//! let drawn = moves.apply(&plan, &graph, &moves.identity());
//! assert!(!moves.parameters.is_empty() && drawn.walls.iter().all(|w| !w.is_changed));
//!
//! let bounds = moves.bounds();
//! let farthest = moves.apply(&plan, &graph, &bounds.iter().map(|b| b[1]).collect::<Vec<_>>());
//! assert!(farthest.walls.iter().any(|w| w.is_changed));
//! # Ok::<(), enfilade_report::Error>(())
//! ```

mod axial;
pub mod carried;
pub mod control;
pub mod defaults;
pub mod doorways;
mod furniture;
pub mod idle;
pub mod jambs;
mod joined;
pub mod narrowed;
mod neighbours;
pub mod opened;
mod remains;
mod shortened;
mod sides;
pub mod sizes;
mod sliding;
mod slotted;
pub mod struck;
mod things;

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;

use joined::{Along, Joined, Moving, Refusal, Stand, Stuck};
use remains::{Ledger, REST_M, Stretches};
use shortened::Holding;

use enfilade_cad::drawing::place_in;
use enfilade_cad::drawing::{Editable, Format, RigidMotion, Shape, Single, Vertex};
use enfilade_plan::axes::AxisGraph;
use enfilade_plan::curve::{self, Trace};
use enfilade_plan::graph::{Graph, Handle};
use enfilade_plan::markers::{Clause, Group, Kind};
use enfilade_plan::{Plan, Wall};
use enfilade_report::Report;

/// What would move by less stays, to the byte; metres of a person. Nobody builds to half a millimetre, and corners this
/// near are one anyway.
pub const MOVE_MIN_M: f64 = 0.0005;

/// One parameter `p_i` with its transformation and bounds.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Name of its group.
    pub group_name: String,
    /// Index into [`Moves::groups`].
    pub group: usize,
    /// Transformation and bounds, in the marker's own unit.
    pub clause: Clause,
    /// The bounds as they were stated, before what stands in the way ended them earlier.
    pub stated: [f64; 2],
}

impl Parameter {
    /// Its clause with the bounds that were stated: how far it can go is found anew in another layout.
    pub fn as_stated(&self) -> Clause {
        let [lower, upper] = self.stated;
        Clause { lower, upper, ..self.clause.clone() }
    }
}

/// A set of nodes that moves together.
#[derive(Clone, Debug, PartialEq)]
pub struct NodeGroup {
    /// Nodes of the graph, ascending.
    pub nodes: Vec<u32>,
    /// Their control points that can be written back, ascending; none where an opening slides.
    pub handles: Vec<Handle>,
    /// The openings that slide along their walls: their places in [`Plan::slots`].
    pub slots: Vec<usize>,
}

impl NodeGroup {
    /// The control points that go as the group does.
    pub fn corners<'p>(&'p self, plan: &'p Plan) -> impl Iterator<Item = &'p Handle> {
        let sides = self.slots.iter().flat_map(|s| plan.slots[*s].jambs.iter().flatten());
        self.handles.iter().chain(sides)
    }
}

/// All parameters of a study.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Moves {
    /// Whether nothing was marked and these are the default moves.
    pub are_default: bool,
    /// Parameters in the order in which they apply.
    pub parameters: Vec<Parameter>,
    /// Parameters that move nothing and were left out.
    pub left_out: Vec<Parameter>,
    /// Groups, in the order of their outlines in the file.
    pub groups: Vec<NodeGroup>,
    /// Walls any of whose control points can move, ascending.
    pub walls: Vec<u32>,
    /// Walls that move as a whole or not at all: arcs, and all that one INSERT shows.
    rigid: BTreeSet<u32>,
    /// Ways shorter than this are none, metres of the plan.
    pub least_m: f64,
    /// Control points of the moving walls as drawn, plan frame, metres.
    start: BTreeMap<u32, Vec<DVec2>>,
    /// What follows, so that walls stay thick and joined.
    joined: Joined,
    /// The sides of walls that become longer or shorter.
    stretches: Stretches,
}

/// A wall after its move.
#[derive(Clone, Debug, PartialEq)]
pub struct MovedWall {
    /// Index into [`Plan::walls`].
    pub wall: u32,
    /// Geometry as it will be written, drawing units.
    pub shape: Shape,
    /// The same as straight pieces, drawing frame, micrometres.
    pub trace: Trace,
    /// The rigid motion in drawing units, for walls that move as a whole.
    pub motion: Option<RigidMotion>,
    /// How far both ends go along the wall's own axis besides, drawing units, where its length changes.
    pub ends: Option<[f64; 2]>,
    /// Its openings that slide, and how far.
    pub slid: Vec<Slid>,
    /// Whether anything differs from the drawing.
    pub is_changed: bool,
}

/// An opening that stands elsewhere along its wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slid {
    /// Its place in [`Plan::slots`].
    pub slot: usize,
    /// How far it goes, drawing units.
    pub shift: DVec2,
}

/// The motion of what slides along a wall and then goes with it.
fn after_sliding(wall: Option<RigidMotion>, slid: Option<DVec2>) -> Option<RigidMotion> {
    let Some(slid) = slid else { return wall };
    let wall = wall.unwrap_or(RigidMotion { turn_rad: 0.0, shift: DVec2::ZERO });
    Some(RigidMotion { shift: DVec2::from_angle(wall.turn_rad).rotate(slid) + wall.shift, ..wall })
}

/// The moving walls of one parameter vector; all other walls stand as drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Layout {
    /// In the order of [`Moves::walls`].
    pub walls: Vec<MovedWall>,
}

impl MovedWall {
    /// Whether the wall itself changes, and not only where its openings stand.
    pub fn is_rebuilt(&self) -> bool {
        self.is_changed && (self.slid.is_empty() || self.motion.is_some() || self.ends.is_some())
    }
}

impl Layout {
    /// Whether a record closes an opening that slides.
    pub fn slides(&self, plan: &Plan, record: usize) -> bool {
        self.walls.iter().flat_map(|w| &w.slid).any(|s| plan.slots[s.slot].closing.record == record)
    }

    /// How far an opening slides, drawing units.
    pub fn slid(&self, slot: usize) -> Option<DVec2> {
        self.walls.iter().flat_map(|w| &w.slid).find(|s| s.slot == slot).map(|s| s.shift)
    }
}

/// The nodes within the outline of a marker.
pub fn enclosed(plan: &Plan, graph: &Graph, group: &Group) -> Vec<u32> {
    let is_within = |n: &u32| group.outline.contains(plan.frame.um_from_plan(graph.nodes[*n as usize]));
    (0..graph.nodes.len() as u32).filter(is_within).collect()
}

impl Moves {
    /// Takes the groups that the user marked; what cannot move is reported.
    pub fn from_markers(plan: &Plan, graph: &Graph, axes: &AxisGraph, report: &mut Report) -> Self {
        let mut groups = Vec::new();
        for group in &plan.markers.groups {
            let nodes = enclosed(plan, graph, group);
            if nodes.is_empty() {
                let text = "encloses no wall end, junction or column; nothing moves here";
                report.warn("move-empty", place_in(&plan.file, &group.source), text);
            }
            say_kept(plan, graph, group, &nodes, report);
            groups.push((group.clone(), nodes));
        }
        Self::new(plan, graph, axes, &groups, report)
    }

    /// Builds the parametrisation from groups of nodes. Nodes inside `EF-KEEP`, walls that cannot be
    /// written back, and groups within whose bounds a joint of thick walls breaks stay, with a warning.
    pub fn new(
        plan: &Plan,
        graph: &Graph,
        axes: &AxisGraph,
        groups: &[(Group, Vec<u32>)],
        report: &mut Report,
    ) -> Self {
        Self::of_records(plan, graph, axes, (groups, &[]), report)
    }

    /// The same, where the file names by group which records alone move with it: what merely shares a corner with them
    /// is not carried. No such list for a group: all that its nodes show.
    pub fn of_records(
        plan: &Plan,
        graph: &Graph,
        axes: &AxisGraph,
        (groups, records): (&[Marked], &[Option<BTreeSet<usize>>]),
        report: &mut Report,
    ) -> Self {
        let groups = &usable(plan, graph, (groups, records), report);
        let held = held(plan, graph, (groups, records), report);
        let held = held.into_iter().map(|(i, group)| Holding::new(&groups[i].0, group)).collect();
        let out = shortened::as_far_as_joints_hold((plan, graph, axes), held, report);
        out.joined.stuck.iter().for_each(|stuck| say_stuck(plan, stuck, report));
        out
    }

    /// The parametrisation of groups, unless a joint breaks within the bounds of one.
    fn mitred(plan: &Plan, graph: &Graph, axes: &AxisGraph, groups: &[Holding]) -> Result<Self, Refusal> {
        let mut out = Self { least_m: MOVE_MIN_M * plan.human_scale, ..Self::default() };
        for (group, Holding { marker, stated, nodes }) in groups.iter().enumerate() {
            for (clause, stated) in marker.clauses.iter().zip(stated) {
                let (group_name, clause, stated) = (marker.name.clone(), clause.clone(), *stated);
                out.parameters.push(Parameter { group_name, group, clause, stated });
            }
            out.groups.push(nodes.clone());
        }
        let moving = Moving { groups: &out.groups, parameters: &out.parameters };
        out.joined = Joined::new((plan, graph, axes), moving, &|n| is_kept(plan, graph, n))?;
        let walls: BTreeSet<u32> = out.handles().map(|h| h.0).collect();
        out.rigid = walls.iter().copied().filter(|w| moves_whole(plan, *w)).collect();
        for w in &walls {
            let points = enfilade_cad::curve::control_points(&plan.walls[*w as usize].shape);
            out.start.insert(*w, points.into_iter().map(|p| plan.frame.plan_from_file(p)).collect());
        }
        out.walls = walls.into_iter().collect();
        out.stretches = Stretches::new(plan, axes, &out.handles().copied().collect());
        match out.refused(plan, graph) {
            Some(refusal) => Err(refusal),
            None => Ok(out),
        }
    }

    /// All control points that can move: those of the groups, and those that follow.
    pub fn handles(&self) -> impl Iterator<Item = &Handle> {
        let own = self.groups.iter().flat_map(|g| &g.handles);
        own.chain(self.joined.followers())
    }

    /// The first group that breaks a joint where all its parameters stand at a bound, in any combination, or leaves too
    /// little of a side of a wall, all groups before it standing where they take most of that.
    fn refused(&self, plan: &Plan, graph: &Graph) -> Option<Refusal> {
        let mut taken = Ledger::default();
        (0..self.groups.len()).find_map(|group| {
            let mut most: Vec<f64> = Vec::new();
            for p in self.corners_of(group) {
                let placed = self.placed(plan, graph, &p);
                if let Some(why) = self.joined.trouble(&placed.stand, &self.start, &placed.at) {
                    return Some(Refusal { group, why });
                }
                let shrunk = self.stretches.shrunk(&placed.at);
                most = shrunk
                    .iter()
                    .zip(most.iter().chain(std::iter::repeat(&0.0)))
                    .map(|(a, b)| a.max(*b))
                    .collect();
            }
            // What turns is no shorter for it: its sides only point elsewhere.
            let side = self.only_shifts(group).then(|| taken.take(&self.stretches, &most))??;
            let wall = &plan.walls[side[0].0 as usize].source;
            let name = wall.handle.as_ref().map_or_else(|| format!("#{}", wall.record), Clone::clone);
            let why = format!(
                "would leave less than {REST_M} m of the wall {name} between its joints and openings"
            );
            Some(Refusal { group, why })
        })
    }

    /// By how much each side of walls is shorter where the one parameter has a value.
    fn shrunk(&self, plan: &Plan, graph: &Graph, value: f64) -> Vec<f64> {
        self.stretches.shrunk(&self.placed(plan, graph, &[value]).at)
    }

    /// Whether a group only shifts.
    fn only_shifts(&self, group: usize) -> bool {
        Moving { groups: &self.groups, parameters: &self.parameters }.only_shifts(&[group])
    }

    /// The places where all parameters of one group stand at a bound, in any combination.
    fn corners_of(&self, group: usize) -> impl Iterator<Item = Vec<f64>> + '_ {
        let own = |i: &usize| self.parameters[*i].group == group;
        let own: Vec<usize> = (0..self.parameters.len()).filter(own).take(CORNER_PARAMETERS_MAX).collect();
        (0..1u32 << own.len()).map(move |bits| {
            let mut p = self.identity();
            for (k, i) in own.iter().enumerate() {
                let clause = &self.parameters[*i].clause;
                p[*i] = if bits >> k & 1 == 0 { clause.lower } else { clause.upper };
            }
            p
        })
    }

    /// Bounds of every parameter, in the marker's own unit.
    pub fn bounds(&self) -> Vec<[f64; 2]> {
        self.parameters.iter().map(|p| [p.clause.lower, p.clause.upper]).collect()
    }

    /// `p_0`: the drawing as it is.
    pub fn identity(&self) -> Vec<f64> {
        self.parameters.iter().map(|p| p.clause.kind.identity()).collect()
    }

    /// `G_A(p)`: the layout of one parameter vector. At the identity nothing is changed, to the bit.
    pub fn apply(&self, plan: &Plan, graph: &Graph, p: &[f64]) -> Layout {
        let placed = self.placed(plan, graph, p);
        let wall = |w: &u32| {
            let along = self.joined.along_of(plan, *w, &placed.stand);
            moved_wall(plan, *w, &placed.at[w], placed.motions.get(w), along)
        };
        Layout { walls: self.walls.iter().map(wall).collect() }
    }

    /// Control points of the moving walls and ends of thick walls (plan frame), and motions of what moves whole.
    fn placed(&self, plan: &Plan, graph: &Graph, p: &[f64]) -> Placed {
        let mut at = self.start.clone();
        let mut stand = self.joined.drawn();
        let mut motions: BTreeMap<u32, RigidMotion> = BTreeMap::new();
        let still = RigidMotion { turn_rad: 0.0, shift: DVec2::ZERO };
        for w in &self.rigid {
            motions.insert(*w, still);
        }
        for (parameter, value) in self.parameters.iter().zip(p) {
            let group = &self.groups[parameter.group];
            if *value == parameter.clause.kind.identity() {
                continue;
            }
            let step = step_of(parameter, *value, || self.centroid(graph, group, &at), plan);
            if self.is_none(group, &step, &at) {
                continue;
            }
            let by = (parameter.group, step.shift);
            self.joined.step(&mut stand, &mut at, by, |p| step.apply(p));
            for (w, c) in &group.handles {
                if let Some(points) = at.get_mut(w) {
                    points[*c as usize] = step.apply(points[*c as usize]);
                }
            }
            let whole: BTreeSet<u32> =
                group.handles.iter().map(|h| h.0).filter(|w| self.rigid.contains(w)).collect();
            for w in whole {
                if let Some(m) = motions.get_mut(&w) {
                    *m = step.after(m);
                }
            }
        }
        self.joined.place(&stand, &self.start, &mut at);
        Placed { at, stand, motions }
    }

    /// Leaves out some parameters; they are remembered, so that an option of an earlier round still fits.
    pub fn leave_out(&mut self, dropped: &[usize]) {
        let all = std::mem::take(&mut self.parameters);
        for (i, p) in all.into_iter().enumerate() {
            let list = if dropped.contains(&i) { &mut self.left_out } else { &mut self.parameters };
            list.push(p);
        }
    }

    /// Whether a step takes nothing as far as a move is.
    fn is_none(&self, group: &NodeGroup, step: &Step, at: &BTreeMap<u32, Vec<DVec2>>) -> bool {
        if !group.slots.is_empty() {
            return step.shift.length() < self.least_m;
        }
        let mut points = group.handles.iter().filter_map(|(w, c)| at.get(w).map(|p| p[*c as usize]));
        points.all(|p| step.apply(p).distance(p) < self.least_m)
    }

    /// Mean of the group's nodes where they stand now.
    fn centroid(&self, graph: &Graph, group: &NodeGroup, at: &BTreeMap<u32, Vec<DVec2>>) -> DVec2 {
        let position = |n: &u32| {
            let handles = &graph.handles[*n as usize];
            let moving = handles.iter().find(|h| group.handles.binary_search(h).is_ok());
            moving.map_or(graph.nodes[*n as usize], |(w, c)| at[w][*c as usize])
        };
        group.nodes.iter().map(position).sum::<DVec2>() / group.nodes.len() as f64
    }
}

/// Where one parameter vector puts everything, plan frame, metres.
struct Placed {
    /// Control points by wall.
    at: BTreeMap<u32, Vec<DVec2>>,
    /// What follows.
    stand: Stand,
    /// Motions of walls that move whole.
    motions: BTreeMap<u32, RigidMotion>,
}

/// A group as it is marked, with the nodes in it.
pub type Marked = (Group, Vec<u32>);

/// Most parameters of one group whose bounds are tried in every combination.
const CORNER_PARAMETERS_MAX: usize = 6;

/// The groups that hold anything that can move, each with its place in the list.
fn held(
    plan: &Plan,
    graph: &Graph,
    (groups, records): (&[Marked], &[Option<BTreeSet<usize>>]),
    report: &mut Report,
) -> Vec<(usize, NodeGroup)> {
    let mut out = Vec::new();
    for (i, (marker, nodes)) in groups.iter().enumerate() {
        let nodes: Vec<u32> = nodes.iter().copied().filter(|n| !is_kept(plan, graph, *n)).collect();
        let only = records.get(i).and_then(Option::as_ref);
        let slots = slotted::slots_of(plan, marker, only);
        let shown = shown_by(plan, graph, &nodes, only).into_iter().filter(|_| slots.is_empty()).collect();
        let handles = writable_handles(plan, graph, marker, shown, report);
        if !handles.is_empty() || !slots.is_empty() {
            out.push((i, NodeGroup { nodes, handles, slots }));
        }
    }
    out
}

/// Control points at some nodes, of all records or of some alone.
fn shown_by(plan: &Plan, graph: &Graph, nodes: &[u32], only: Option<&BTreeSet<usize>>) -> BTreeSet<Handle> {
    let is_own = |h: &Handle| only.is_none_or(|r| r.contains(&plan.walls[h.0 as usize].source.record));
    let shown = nodes.iter().flat_map(|n| graph.handles[*n as usize].iter().copied());
    shown.filter(is_own).collect()
}

/// The groups without turns and scalings that hold a wall of theirs back which could go along with the rest; where
/// nothing would be left, they stay as they are. What is dropped is said.
fn usable(
    plan: &Plan,
    graph: &Graph,
    (groups, records): (&[Marked], &[Option<BTreeSet<usize>>]),
    report: &mut Report,
) -> Vec<Marked> {
    let mut out = groups.to_vec();
    for (i, (marker, nodes)) in out.iter_mut().enumerate() {
        let slots = slotted::slots_of(plan, marker, records.get(i).and_then(Option::as_ref));
        if !slots.is_empty() {
            *marker = slotted::within_walls(plan, marker, &slots, report);
            continue;
        }
        let free: Vec<u32> = nodes.iter().copied().filter(|n| !is_kept(plan, graph, *n)).collect();
        let handles = shown_by(plan, graph, &free, records.get(i).and_then(Option::as_ref));
        let walls: BTreeSet<u32> = handles.iter().map(|h| h.0).collect();
        let is_turn = |c: &Clause| matches!(c.kind, Kind::Rotate(_));
        let is_scale = |c: &Clause| matches!(c.kind, Kind::Scale(_));
        for (is_such, what) in [(&is_turn as &dyn Fn(&Clause) -> bool, "turn"), (&is_scale, "scaling")] {
            let mut rest = marker.clone();
            rest.clauses.retain(|c| !is_such(c));
            if rest.clauses.is_empty() || rest.clauses.len() == marker.clauses.len() {
                continue;
            }
            let why = |group: &Group, w: u32| refusal(plan, graph, group, w, &handles);
            let stopped = walls.iter().find_map(|w| {
                why(marker, *w)
                    .filter(|why| !why.is_empty())
                    .filter(|_| why(&rest, *w).is_none())
                    .map(|why| (*w, why))
            });
            if let Some((w, why)) = stopped {
                let text = format!(
                    "group {:?} would {what_verb} it, but {why}; its {what} is left out, its other moves stay",
                    marker.name,
                    what_verb = if what == "turn" { "turn" } else { "scale" }
                );
                report.warn("move-clause-unused", place_in(&plan.file, &plan.walls[w as usize].source), text);
                *marker = rest;
            }
        }
    }
    out
}

/// Whether a node lies inside `EF-KEEP`.
fn is_kept(plan: &Plan, graph: &Graph, node: u32) -> bool {
    let at = plan.frame.um_from_plan(graph.nodes[node as usize]);
    plan.markers.keep.iter().any(|r| r.contains(at))
}

/// Says which wall at a joint does not follow. Beside one that shifts, in a building, most joints hold nevertheless: those
/// that open are told with the options.
fn say_stuck(plan: &Plan, stuck: &Stuck, report: &mut Report) {
    let place = place_in(&plan.file, &plan.walls[stuck.wall as usize].source);
    let text = format!("is joined to a wall that may {}, but {}; it stays as drawn", stuck.may, stuck.why);
    match plan.format != Format::Dxf && !stuck.turns {
        true => report.info("joint-stays", place, text),
        false => report.warn("joint-stays", place, text),
    }
}

/// Says which ends of a group's walls `EF-KEEP` holds.
pub fn say_kept(plan: &Plan, graph: &Graph, group: &Group, nodes: &[u32], report: &mut Report) {
    let kept = nodes.iter().filter(|n| is_kept(plan, graph, **n)).count();
    let place = || place_in(&plan.file, &group.source);
    let kept_region = plan.format.marking().kept_region;
    if kept > 0 && kept == nodes.len() {
        let text =
            format!("group {:?}: all its wall ends lie inside {kept_region}; nothing moves here", group.name);
        report.warn("move-kept", place(), text);
    } else if kept > 0 {
        let text = format!(
            "group {:?}: {kept} of its {} wall ends lie inside {kept_region} and stay",
            group.name,
            nodes.len()
        );
        report.info("move-kept", place(), text);
    }
}

/// One parameter's effect: `p' = centre + factor·R(turn)(p − centre) + shift`, plan frame.
struct Step {
    centre: DVec2,
    turn_rad: f64,
    factor: f64,
    shift: DVec2,
}

impl Step {
    fn apply(&self, p: DVec2) -> DVec2 {
        if self.turn_rad == 0.0 && self.factor == 1.0 {
            return p + self.shift;
        }
        self.centre + DVec2::from_angle(self.turn_rad).rotate(p - self.centre) * self.factor + self.shift
    }

    /// This step after a rigid motion (both in the plan frame).
    fn after(&self, m: &RigidMotion) -> RigidMotion {
        RigidMotion { turn_rad: m.turn_rad + self.turn_rad, shift: self.apply(m.shift) }
    }
}

fn step_of(parameter: &Parameter, value: f64, centroid: impl Fn() -> DVec2, plan: &Plan) -> Step {
    let si = value * parameter.clause.si_per_unit;
    let shift = |shift: DVec2| Step { centre: DVec2::ZERO, turn_rad: 0.0, factor: 1.0, shift };
    let centre = |about: Option<DVec2>| about.map_or_else(&centroid, |p| plan.frame.plan_from_file(p));
    match parameter.clause.kind {
        Kind::X => shift(DVec2::new(si, 0.0)),
        Kind::Y => shift(DVec2::new(0.0, si)),
        Kind::Along(angle) => shift(DVec2::from_angle(angle) * si),
        Kind::Rotate(about) => Step { turn_rad: si, centre: centre(about), ..shift(DVec2::ZERO) },
        Kind::Scale(about) => Step { factor: si, centre: centre(about), ..shift(DVec2::ZERO) },
    }
}

fn moves_whole(plan: &Plan, wall: u32) -> bool {
    let wall = &plan.walls[wall as usize];
    matches!(wall.shape, Shape::Arc { .. }) || wall.editable.moves_whole()
}

/// Those of a group's control points that can be written back; the others are reported.
fn writable_handles(
    plan: &Plan,
    graph: &Graph,
    group: &Group,
    mut handles: BTreeSet<Handle>,
    report: &mut Report,
) -> Vec<Handle> {
    let walls: BTreeSet<u32> = handles.iter().map(|h| h.0).collect();
    for w in walls {
        if let Some(why) = refusal(plan, graph, group, w, &handles) {
            if !why.is_empty() {
                let place = place_in(&plan.file, &plan.walls[w as usize].source);
                let text = format!("group {:?} would move it, but {why}; it stays as drawn", group.name);
                report.warn("wall-stays", place, text);
            }
            handles.retain(|h| h.0 != w);
        }
    }
    handles.into_iter().collect()
}

/// What moves as a whole where a wall does, in words.
fn whole_of(plan: &Plan, wall: &Wall) -> &'static str {
    match wall.source.kind.as_str() {
        _ if plan.format != Format::Dxf => "it",
        "MLINE" => "a multiline",
        "SPLINE" | "ELLIPSE" => "a curve",
        _ => "its block",
    }
}

/// Why a wall cannot move with a group; an empty reason where nobody asked for it.
fn refusal(plan: &Plan, graph: &Graph, group: &Group, w: u32, handles: &BTreeSet<Handle>) -> Option<String> {
    let wall = &plan.walls[w as usize];
    let all_in =
        |w: u32| (0..graph.control_nodes[w as usize].len() as u32).all(|c| handles.contains(&(w, c)));
    let turns = group.clauses.iter().any(|c| matches!(c.kind, Kind::Rotate(_)));
    let scales = group.clauses.iter().any(|c| matches!(c.kind, Kind::Scale(_)));
    match &wall.editable {
        Editable::No(why) => return Some(why.clone()),
        Editable::WithInsert { .. } | Editable::Wall { .. } => {
            let same = |v: &u32| plan.walls[*v as usize].source.record == wall.source.record;
            if !(0..plan.walls.len() as u32).filter(same).all(all_in) {
                // A building's neighbours share corners; nobody drew a box round a part of them. An end follows by itself.
                let is_end = |c: u32| match &wall.editable {
                    Editable::Wall { ends, .. } => ends.iter().any(|end| end.contains(&c)),
                    _ => false,
                };
                let is_at_end = handles.iter().filter(|h| h.0 == w).all(|h| is_end(h.1));
                if plan.format != Format::Dxf || is_at_end {
                    return Some(String::new());
                }
                let what = whole_of(plan, wall);
                return Some(format!("{what} moves only as a whole and the group encloses a part of it"));
            }
            if scales {
                let what = if plan.format == Format::Dxf { whole_of(plan, wall) } else { "an element" };
                return Some(format!("{what} is not scaled"));
            }
            if turns && wall.editable == (Editable::WithInsert { turnable: false }) {
                return Some(plan.format.why_no_turn().into());
            }
        }
        Editable::Free => {}
    }
    if matches!(wall.shape, Shape::Arc { .. }) && (!all_in(w) || scales) {
        return Some("an arc moves only as a whole, unscaled".into());
    }
    None
}

fn moved_wall(plan: &Plan, w: u32, at: &[DVec2], motion: Option<&RigidMotion>, along: Along) -> MovedWall {
    let wall = &plan.walls[w as usize];
    let frame = &plan.frame;
    let points: Vec<DVec2> = enfilade_cad::curve::control_points(&wall.shape)
        .into_iter()
        .zip(at)
        .map(|(old, new)| {
            let um = frame.um_from_plan(*new);
            if um == frame.um_from_file(old) { old } else { frame.file_from_um(um) }
        })
        .collect();
    let (shape, motion) = match motion {
        Some(m) => held_shape(wall.single.as_ref(), rigid_shape(plan, &wall.shape, m)),
        None => (with_points(&wall.shape, &points), None),
    };
    let shape = along.applied(plan, w, motion.as_ref(), shape);
    let is_changed = shape != wall.shape;
    let trace = if is_changed { curve::trace(&shape, frame) } else { wall.trace.clone() };
    let ends = along.ends.map(|e| e.by);
    MovedWall { wall: w, shape, trace, motion, ends, slid: along.slid, is_changed }
}

/// A moved shape as the file holds it.
fn held_shape(
    single: Option<&Single>,
    (shape, motion): (Shape, Option<RigidMotion>),
) -> (Shape, Option<RigidMotion>) {
    let Some(single) = single.filter(|_| motion.is_some()) else { return (shape, motion) };
    let points: Vec<DVec2> =
        enfilade_cad::curve::control_points(&shape).into_iter().map(|p| single.held(p)).collect();
    (with_points(&shape, &points), motion)
}

/// The shape after a rigid motion of the plan frame, and that motion in drawing units.
fn rigid_shape(plan: &Plan, shape: &Shape, m: &RigidMotion) -> (Shape, Option<RigidMotion>) {
    if m.turn_rad == 0.0 && m.shift == DVec2::ZERO {
        return (shape.clone(), None);
    }
    let frame = &plan.frame;
    let zero = frame.file_from_plan(DVec2::ZERO);
    let moved_zero = frame.file_from_plan(m.shift);
    let motion =
        RigidMotion { turn_rad: m.turn_rad, shift: moved_zero - DVec2::from_angle(m.turn_rad).rotate(zero) };
    (moved_shape(plan, shape, &motion), Some(motion))
}

/// The shape after a rigid motion in drawing units.
fn moved_shape(plan: &Plan, shape: &Shape, motion: &RigidMotion) -> Shape {
    let (m, frame) = (motion, &plan.frame);
    let go = |p: DVec2| DVec2::from_angle(m.turn_rad).rotate(p) + motion.shift;
    let snap = |p: DVec2| frame.file_from_um(frame.um_from_file(go(p)));
    match shape {
        Shape::Arc { centre, radius, start_rad, end_rad } => Shape::Arc {
            centre: snap(*centre),
            radius: *radius,
            start_rad: start_rad + m.turn_rad,
            end_rad: end_rad + m.turn_rad,
        },
        Shape::Circle { centre, radius } => Shape::Circle { centre: go(*centre), radius: *radius },
        other => with_points(
            other,
            &enfilade_cad::curve::control_points(other).into_iter().map(go).collect::<Vec<_>>(),
        ),
    }
}

/// The same shape through other control points; bulges and radii stay. Arcs are returned unchanged.
fn with_points(shape: &Shape, points: &[DVec2]) -> Shape {
    match shape {
        Shape::Line { .. } => Shape::Line { a: points[0], b: points[1] },
        Shape::Polyline { vertices, closed } => {
            let vertices =
                vertices.iter().zip(points).map(|(v, at)| Vertex { at: *at, bulge: v.bulge }).collect();
            Shape::Polyline { vertices, closed: *closed }
        }
        Shape::Circle { radius, .. } => Shape::Circle { centre: points[0], radius: *radius },
        Shape::Arc { .. } => shape.clone(),
    }
}

#[cfg(test)]
mod tests;

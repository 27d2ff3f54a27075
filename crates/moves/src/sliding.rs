//! What may slide by default.

use glam::DVec2;

use enfilade_engine::Region;
use enfilade_plan::Plan;
use enfilade_plan::graph::Graph;
use enfilade_plan::markers::{Clause, Group, Kind};

/// A set of nodes that may slide.
pub(super) struct Sliding {
    /// Nodes of the graph, ascending.
    pub nodes: Vec<u32>,
    /// Direction, unit vector, plan frame.
    pub direction: DVec2,
    /// Bounds, metres of the plan.
    pub way: [f64; 2],
    /// Where it is, metres of a person.
    pub at: DVec2,
    /// Length of the wall or width of the door, metres of a person.
    pub size: f64,
    /// A wall of it, an index into [`Plan::walls`], where it is a wall that slides.
    pub wall: Option<u32>,
    /// The opening that slides with what fills it, where the file says so: its place in [`Plan::slots`].
    pub slot: Option<usize>,
}

impl Sliding {
    /// As a group of one clause.
    pub fn group(&self, plan: &Plan, graph: &Graph, name: String) -> (Group, Vec<u32>) {
        let d = self.direction;
        let kind = if d.y.abs() < 1e-6 {
            Kind::X
        } else if d.x.abs() < 1e-6 {
            Kind::Y
        } else {
            Kind::Along(d.to_angle())
        };
        let [lower, upper] = self.way;
        let clause = Clause { kind, lower, upper, unit: "m".into(), si_per_unit: 1.0 };
        let first = self.wall.unwrap_or(graph.handles[self.nodes[0] as usize][0].0);
        let source = self.slot.map_or(&plan.walls[first as usize].source, |s| &plan.slots[s].source).clone();
        (Group { name, outline: Region::Ring(Vec::new()), clauses: vec![clause], source }, self.nodes.clone())
    }
}

/// A way in whole millimetres, metres; never longer by more than a nanometre, which is how exactly it is known.
pub(super) fn whole_mm(way: f64) -> f64 {
    (way * 1e3 + 1e-6).floor() / 1e3
}

/// The direction that points right or up, and whether it was turned.
pub(super) fn upright(d: DVec2) -> (DVec2, bool) {
    let is_turned = d.x < -1e-9 || (d.x.abs() <= 1e-9 && d.y < 0.0);
    (if is_turned { -d } else { d }, is_turned)
}

/// The lowest and highest y of the part of a segment with x in a range.
pub(super) fn clipped(p: DVec2, q: DVec2, from: f64, to: f64) -> Option<[f64; 2]> {
    let (p, q) = if p.x <= q.x { (p, q) } else { (q, p) };
    if q.x < from || p.x > to || from > to {
        return None;
    }
    let at =
        |x: f64| if q.x - p.x < 1e-12 { p } else { p.lerp(q, ((x - p.x) / (q.x - p.x)).clamp(0.0, 1.0)) };
    let (a, b) = if q.x - p.x < 1e-12 { (p, q) } else { (at(from), at(to)) };
    Some([a.y.min(b.y), a.y.max(b.y)])
}

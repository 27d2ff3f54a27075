//! The architectural graph `G_A = ⟨N, E⟩` (spec 1): nodes where wall ends meet, an edge a drawn piece.

use std::collections::HashMap;

use glam::DVec2;

use super::{Plan, Wall};
use enfilade_engine::geometry::{PointUm, UM_PER_M};

/// Wall ends nearer than this are one node.
pub const NODE_JOIN_M: f64 = 0.001;

/// One control point of one wall: `(wall, control point)`.
pub type Handle = (u32, u32);

/// The graph. Node ids index [`Graph::nodes`]; wall ids index [`Plan::walls`].
#[derive(Clone, Debug, PartialEq)]
pub struct Graph {
    /// Position of each node (that of its first control point), plan frame, metres.
    pub nodes: Vec<DVec2>,
    /// The control points that meet in each node, ascending.
    pub handles: Vec<Vec<Handle>>,
    /// Node of every traced point of every wall; points between control points have nodes of their own.
    pub trace_nodes: Vec<Vec<u32>>,
    /// Node of every control point of every wall.
    pub control_nodes: Vec<Vec<u32>>,
    /// Number of nodes, those between control points included.
    pub len: u32,
}

impl Graph {
    /// Builds the graph of a plan. The same whatever the order of the walls' ends.
    pub fn new(plan: &Plan) -> Self {
        let mut out = Self {
            nodes: Vec::new(),
            handles: Vec::new(),
            trace_nodes: Vec::new(),
            control_nodes: Vec::new(),
            len: 0,
        };
        let mut index = NodeIndex::default();
        for (w, wall) in plan.walls.iter().enumerate() {
            let points = control_um(wall, plan);
            let ids = points.iter().enumerate().map(|(c, p)| {
                let id = index.find_or_add(*p);
                if id as usize == out.nodes.len() {
                    out.nodes.push(plan.frame.plan_from_um(*p));
                    out.handles.push(Vec::new());
                }
                out.handles[id as usize].push((w as u32, c as u32));
                id
            });
            let ids: Vec<u32> = ids.collect();
            out.control_nodes.push(ids);
        }
        out.len = out.nodes.len() as u32;
        for (w, wall) in plan.walls.iter().enumerate() {
            let node_of = |c: &Option<u32>| match c {
                Some(c) => out.control_nodes[w][*c as usize],
                None => {
                    out.len += 1;
                    out.len - 1
                }
            };
            let nodes = wall.trace.control.iter().map(node_of).collect();
            out.trace_nodes.push(nodes);
        }
        out
    }
}

/// Control points of a wall in the drawing frame, micrometres.
pub fn control_um(wall: &Wall, plan: &Plan) -> Vec<PointUm> {
    enfilade_cad::curve::control_points(&wall.shape).into_iter().map(|p| plan.frame.um_from_file(p)).collect()
}

/// Finds points within [`NODE_JOIN_M`] by buckets of that size.
#[derive(Default)]
struct NodeIndex {
    buckets: HashMap<[i64; 2], Vec<(PointUm, u32)>>,
    count: u32,
}

impl NodeIndex {
    fn find_or_add(&mut self, p: PointUm) -> u32 {
        let size = (NODE_JOIN_M * UM_PER_M) as i64;
        let key = [p[0].div_euclid(size), p[1].div_euclid(size)];
        let mut best: Option<(i128, u32)> = None;
        for dx in -1..=1 {
            for dy in -1..=1 {
                for (q, id) in self.buckets.get(&[key[0] + dx, key[1] + dy]).into_iter().flatten() {
                    let d2 = i128::from(q[0] - p[0]).pow(2) + i128::from(q[1] - p[1]).pow(2);
                    if d2 <= i128::from(size).pow(2) && best.is_none_or(|b| (d2, *id) < b) {
                        best = Some((d2, *id));
                    }
                }
            }
        }
        if let Some((_, id)) = best {
            return id;
        }
        self.buckets.entry(key).or_default().push((p, self.count));
        self.count += 1;
        self.count - 1
    }
}

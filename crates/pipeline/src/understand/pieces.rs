//! The walls of a plan as pieces, in the present layout and in others.

use std::collections::BTreeSet;

use crate::understand::understood::Understood;
use enfilade_cad::drawing::Shape;
use enfilade_engine::geometry::{Segment, UM_PER_M};
use enfilade_moves::Layout;
use enfilade_penalties::{BodySide, WallPiece};
use enfilade_plan::body_sides::body_sides;
use enfilade_plan::curve::{Trace, trace_like};
use enfilade_plan::structure;

/// All walls as pieces, those that stay and those that move.
#[derive(Clone, Debug)]
pub(crate) struct Pieces {
    /// Of the present layout, wall by wall; metres, plan frame.
    pub drawn: Vec<WallPiece>,
    /// The wall of each, an index into the walls of the plan.
    pub walls: Vec<u32>,
    /// For every moving wall and control point: whether the piece that starts there moves.
    pub moves: Vec<Vec<bool>>,
    /// For every moving wall its pieces in `drawn`.
    ranges: Vec<[usize; 2]>,
}

impl Pieces {
    /// Of a drawing as understood.
    pub fn new(base: &Understood) -> Self {
        let moves = piece_moves(base);
        let mut out = Self { drawn: Vec::new(), walls: Vec::new(), ranges: vec![[0; 2]; moves.len()], moves };
        let bars = structure::thick_walls(&base.axes);
        let sides = body_sides(&base.plan, &base.axes);
        for (w, wall) in base.plan.walls.iter().enumerate() {
            let moving = base.moves.walls.binary_search(&(w as u32)).ok();
            let start = out.drawn.len();
            let nodes = &base.graph.trace_nodes[w];
            let parts = pieces_of(&wall.trace, moving.map(|i| &out.moves[i])).map(|p| (p.1, p.2));
            for ((i, j, s), (part, is_moving)) in wall.trace.segments().zip(parts) {
                let [a, b] = [s.a, s.b].map(|p| base.plan.frame.plan_from_um(p));
                let solid = wall.is_solid.then_some(w as u32);
                let bar = bars.get(&(w as u32, part)).copied();
                let is_left = sides.get(&(w as u32, part));
                let body = is_left.map(|left| if *left { BodySide::Left } else { BodySide::Right });
                let (nodes, half_m) = ([nodes[i], nodes[j]], wall.width_um as f64 / UM_PER_M / 2.0);
                out.drawn.push(WallPiece { a, b, nodes, is_moving, solid, bar, body, half_m });
                out.walls.push(w as u32);
            }
            if let Some(i) = moving {
                out.ranges[i] = [start, out.drawn.len()];
            }
        }
        out
    }

    /// Puts the moving ones of `pieces` where a layout has them.
    pub fn place(&self, base: &Understood, layout: &Layout, pieces: &mut [WallPiece]) {
        for (i, moved) in layout.walls.iter().enumerate() {
            self.place_wall(base, i, &moved.shape, pieces);
        }
    }

    /// The same of one moving wall, an index into those that move, as drawn with another shape.
    pub fn place_wall(&self, base: &Understood, i: usize, shape: &Shape, pieces: &mut [WallPiece]) {
        let plan = &base.plan;
        let trace = trace_like(shape, &plan.walls[base.moves.walls[i] as usize].trace, &plan.frame);
        let [from, to] = self.ranges[i];
        for (piece, (_, _, s)) in pieces[from..to].iter_mut().zip(trace.segments()) {
            piece.a = plan.frame.plan_from_um(s.a);
            piece.b = plan.frame.plan_from_um(s.b);
        }
    }

    /// All as a layout has them.
    pub fn placed(&self, base: &Understood, layout: &Layout) -> Vec<WallPiece> {
        let mut out = self.drawn.clone();
        self.place(base, layout, &mut out);
        out
    }
}

/// For every moving wall and control point: whether the piece that starts there moves.
fn piece_moves(base: &Understood) -> Vec<Vec<bool>> {
    let mut moving = vec![BTreeSet::new(); base.plan.walls.len()];
    for (w, c) in base.moves.handles() {
        moving[*w as usize].insert(*c);
    }
    let of_wall = |w: &u32| {
        let (n, set) = (base.graph.control_nodes[*w as usize].len() as u32, &moving[*w as usize]);
        (0..n).map(|c| set.contains(&c) || set.contains(&((c + 1) % n))).collect()
    };
    base.moves.walls.iter().map(of_wall).collect()
}

/// The pieces of a trace, each with the control point it starts from and whether it moves.
pub(crate) fn pieces_of<'a>(
    trace: &'a Trace,
    moving: Option<&'a Vec<bool>>,
) -> impl Iterator<Item = (Segment, u32, bool)> + 'a {
    let mut control = 0u32;
    trace.segments().map(move |(i, _, s)| {
        if let Some(c) = trace.control[i] {
            control = c;
        }
        (s, control, moving.is_some_and(|m| m.get(control as usize).copied().unwrap_or(true)))
    })
}

//! What of a study's walls stays and what moves, piece by piece.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;

use crate::measure::study::Study;
use crate::understand::understood::Understood;
use enfilade_engine::geometry::{PointUm, Segment};
use enfilade_engine::lattice::CellIndex;
use enfilade_moves::Layout;
use enfilade_plan::axes::FaceRef;
use enfilade_plan::curve::Trace;
use enfilade_plan::structure;

impl Study {
    /// The walls that a layout runs through each other, and by how many metres, as the penalty counts them.
    pub fn overlapping(&self, layout: &Layout) -> Vec<([u32; 2], f64)> {
        let mut pieces = self.pieces.clone();
        self.place_all(layout, &mut pieces);
        let walls = self.base.plan.walls.iter().enumerate();
        let of_piece: Vec<u32> =
            walls.flat_map(|(w, wall)| wall.trace.segments().map(move |_| w as u32)).collect();
        let mut out: BTreeMap<[u32; 2], f64> = BTreeMap::new();
        for (pair, by_m) in self.overlap.pairs_m(&enfilade_penalties::Layout { pieces: &pieces }) {
            *out.entry(pair.map(|p| of_piece[p])).or_default() += by_m;
        }
        out.into_iter().collect()
    }
}

/// For every moving wall and control point: whether the piece that starts there moves.
pub(crate) fn piece_moves(base: &Understood) -> Vec<Vec<bool>> {
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

/// Sight-blocking pieces and solid outlines that cannot move.
pub(crate) fn fixed_parts(base: &Understood, piece_moves: &[Vec<bool>]) -> (Vec<Segment>, Vec<Vec<PointUm>>) {
    let (mut segments, mut solids) = (Vec::new(), Vec::new());
    for (w, wall) in base.plan.walls.iter().enumerate() {
        let moving = base.moves.walls.binary_search(&(w as u32)).ok().map(|i| &piece_moves[i]);
        for (s, part, _) in pieces_of(&wall.trace, moving).filter(|p| !p.2) {
            for s in base.sight.blocking((w as u32, part), s) {
                segments.extend(wall.with_sides(s));
                solids.extend(wall.ground(s).map(|ring| ring.to_vec()));
            }
        }
        if wall.is_solid && moving.is_none() {
            solids.push(wall.trace.points.clone());
        }
    }
    segments.extend(closed_that_stay(base));
    let stays = |f: FaceRef| match base.moves.walls.binary_search(&f.0) {
        Ok(i) => piece_moves[i].get(f.1 as usize).is_some_and(|moves| !moves),
        Err(_) => true,
    };
    solids.extend(structure::footprints(&base.plan, &base.axes, stays));
    (segments, solids)
}

/// How near a moving wall's end must be to a closed gap for the gap to be its own.
const CLOSED_REACH_M: f64 = 0.1;

/// What stops sight although nothing is drawn, where no moving wall ends: a gap beside a moving wall is
/// no slip any more once it moves. The building ends where it did.
pub(crate) fn closed_that_stay(base: &Understood) -> Vec<Segment> {
    let ends: Vec<DVec2> = base.moves.handles().map(|h| structure::handle_at(&base.plan, *h)).collect();
    let at = |p: PointUm| base.plan.frame.plan_from_um(p) / base.plan.human_scale;
    let stays =
        |s: &&Segment| [s.a, s.b].iter().all(|p| ends.iter().all(|e| e.distance(at(*p)) > CLOSED_REACH_M));
    let closed = base.sight.closed.iter().filter(stays);
    closed.chain(&base.sight.ends).copied().collect()
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

/// Sight-blocking pieces that move, as they stand in a layout.
pub(crate) fn moving_segments(base: &Understood, layout: &Layout, piece_moves: &[Vec<bool>]) -> Vec<Segment> {
    let mut out = Vec::new();
    for (wall, moving) in layout.walls.iter().zip(piece_moves) {
        for (s, part, _) in pieces_of(&wall.trace, Some(moving)).filter(|p| p.2) {
            let drawn = &base.plan.walls[wall.wall as usize];
            out.extend(base.sight.blocking((wall.wall, part), s).flat_map(|s| drawn.with_sides(s)));
        }
    }
    out
}

/// Adds the vertices that a wall drawn as a wide polyline covers where it stands.
pub(crate) fn cover_wide(base: &Understood, wall: u32, trace: &Trace, cells: &CellIndex, out: &mut Vec<u32>) {
    let drawn = &base.plan.walls[wall as usize];
    for (s, part, _) in pieces_of(trace, None).filter(|_| drawn.width_um > 0) {
        for ring in base.sight.blocking((wall, part), s).filter_map(|s| drawn.ground(s)) {
            cells.vertices_in(&ring, out);
        }
    }
}

//! What of a study's walls stays and what moves, piece by piece.

use std::collections::BTreeMap;

use crate::understand::pieces::pieces_of;
use crate::understand::understood::{Understood, closed_that_stay};
use enfilade_cad::curve::control_points;
use enfilade_cad::drawing::Shape;
use enfilade_engine::geometry::{PointUm, Segment};
use enfilade_engine::lattice::CellIndex;
use enfilade_moves::Layout;
use enfilade_plan::axes::FaceRef;
use enfilade_plan::curve::Trace;
use enfilade_plan::structure;

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

/// All that stops sight in a layout.
pub(crate) fn stopping(base: &Understood, layout: &Layout) -> Vec<Segment> {
    let mut traces: Vec<&Trace> = base.plan.walls.iter().map(|w| &w.trace).collect();
    layout.walls.iter().for_each(|moved| traces[moved.wall as usize] = &moved.trace);
    let walls = traces.into_iter().enumerate();
    let pieces = walls.flat_map(|(w, t)| pieces_of(t, None).map(move |p| (w as u32, p)));
    let blocking = pieces.flat_map(|(w, (s, part, _))| base.sight.blocking((w, part), s));
    blocking.chain(closed_that_stay(base)).collect()
}

/// Vertices covered by what can move and has a body, solids and thick walls, and those that its lines touch: they
/// are no floor, so they count in no mean and are not cut off. What stays touches none, or its vertices were dropped.
pub(crate) fn blind(base: &Understood, layout: &Layout, cells: &CellIndex, segments: &[Segment]) -> Vec<u32> {
    let shapes: BTreeMap<u32, &Shape> = layout.walls.iter().map(|w| (w.wall, &w.shape)).collect();
    let mut out = Vec::new();
    for wall in layout.walls.iter().filter(|w| base.plan.walls[w.wall as usize].is_solid) {
        cells.vertices_in(&wall.trace.points, &mut out);
    }
    cover_bodies(base, &|w| shapes.get(&w).copied(), cells, &mut out);
    layout.walls.iter().for_each(|w| cover_wide(base, w.wall, &w.trace, cells, &mut out));
    segments.iter().for_each(|s| cells.vertices_on(*s, &mut out));
    out.sort_unstable();
    out.dedup();
    out
}

/// Adds the vertices that moving thick walls cover; `shape` says where a moving wall stands.
pub(crate) fn cover_bodies<'a>(
    base: &'a Understood,
    shape: &impl Fn(u32) -> Option<&'a Shape>,
    cells: &CellIndex,
    out: &mut Vec<u32>,
) {
    let moves = |w: u32| base.moves.walls.binary_search(&w).is_ok();
    for body in base.bodies.iter().filter(|b| b.corners.iter().any(|h| moves(h.0))) {
        let ring = body.ring(|(w, c)| {
            let shape = shape(w).unwrap_or(&base.plan.walls[w as usize].shape);
            base.plan.frame.um_from_file(control_points(shape)[c as usize])
        });
        if let Some(ring) = ring {
            cells.vertices_in(&ring, out);
        }
    }
}

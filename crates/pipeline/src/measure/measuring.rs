//! What a layout of a study is worth: on every lattice, and by its penalties.

use rayon::prelude::*;

use crate::measure::look;
use crate::measure::look::{Look, Scratches, SeenOn};
use crate::measure::parts::moving_segments;
use crate::measure::study::{Study, Worth, blind};
use enfilade_engine::Obstacles;
use enfilade_engine::geometry::Segment;
use enfilade_moves::Layout;
use enfilade_penalties::WallPiece;
use enfilade_plan::curve::{Trace, trace_like};

/// Reusable memory of one thread that measures.
pub struct Bench {
    pub(crate) scratches: Vec<Scratches>,
    pub(crate) pieces: Vec<WallPiece>,
}

impl Study {
    /// Memory for one thread.
    pub fn bench(&self) -> Bench {
        Bench { scratches: self.looks.iter().map(Look::scratches).collect(), pieces: self.pieces.clone() }
    }

    /// Measures the layout of one parameter vector.
    pub fn measure(&self, p: &[f64], bench: &mut Bench) -> Worth {
        let layout = self.base.moves.apply(&self.base.plan, &self.base.graph, p);
        let segments = moving_segments(&self.base, &layout, &self.piece_moves);
        let looks = self.looks.par_iter().zip(&mut bench.scratches);
        let seen = looks.map(|(look, scratches)| {
            let moving = self.moving(look, &layout, &segments);
            let tally = look.main.evaluator.evaluate(&moving, &mut scratches.main);
            self.all_seen(look, &layout, tally, &moving, &mut scratches.pairs)
        });
        let seen = seen.collect();
        self.place_all(&layout, &mut bench.pieces);
        self.worth(seen, &bench.pieces, &layout)
    }

    /// What moves in a layout, with the cells of a lattice that it covers.
    pub(crate) fn moving(&self, look: &Look, layout: &Layout, segments: &[Segment]) -> Obstacles {
        Obstacles {
            blind: blind(&self.base, layout, &look.main.cells, segments),
            segments: segments.to_vec(),
        }
    }

    pub(crate) fn place_all(&self, layout: &Layout, pieces: &mut [WallPiece]) {
        for (moved, range) in layout.walls.iter().zip(&self.piece_ranges) {
            let initial = &self.base.plan.walls[moved.wall as usize].trace;
            let trace = trace_like(&moved.shape, initial, &self.base.plan.frame);
            self.place(&mut pieces[range.0..range.1], &trace);
        }
    }

    pub(crate) fn place(&self, pieces: &mut [WallPiece], trace: &Trace) {
        for (piece, (_, _, s)) in pieces.iter_mut().zip(trace.segments()) {
            piece.a = self.base.plan.frame.plan_from_um(s.a);
            piece.b = self.base.plan.frame.plan_from_um(s.b);
        }
    }

    /// What a layout is worth whose unnamed and named pairs see that on every lattice.
    pub(crate) fn worth(&self, seen: Vec<SeenOn>, pieces: &[WallPiece], moved: &Layout) -> Worth {
        let layout = enfilade_penalties::Layout { pieces };
        let clearance_m2 = self.clearance.measure_m2(&layout);
        let passages_m: Vec<f64> = self.passages.iter().map(|p| p.measure_m(&layout)).collect();
        let rooms_m2 = self.rooms.as_ref().map_or_else(Vec::new, |r| r.areas_m2(&layout));
        let penalties = [
            clearance_m2 * clearance_m2,
            self.wall_length.measure_m(&layout),
            self.alignment.measure_rad2(&layout),
            self.overlap.measure_m(&layout),
            passages_m.first().copied().unwrap_or(0.0),
            self.rooms.as_ref().map_or(0.0, |r| r.lost_m2(&rooms_m2)),
        ];
        let mut worth = Worth {
            penalties,
            wall_total_m: enfilade_penalties::wall_length::total_m(&layout),
            passages_m,
            rooms_m2,
            clearance_m2,
            faults: self.guards.faults(&self.base, moved, &layout),
            ..Worth::default()
        };
        look::take_means(self, seen, &mut worth);
        worth
    }
}

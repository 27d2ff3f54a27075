//! What a layout of a study is worth: on every lattice, and by its penalties.

use std::collections::BTreeMap;

use rayon::prelude::*;

use crate::measure::aims;
use crate::measure::look::{Bench, Look, Pair, SeenOn};
use crate::measure::obstacles::{blind, moving_segments};
use crate::measure::seen::Seen;
use crate::measure::study::Study;
use crate::measure::worth::Worth;
use crate::understand::faults::{Faults, Guards};
use enfilade_config::{Aim, PairName};
use enfilade_engine::evaluator::Scratch;
use enfilade_engine::geometry::Segment;
use enfilade_engine::measures::Means;
use enfilade_engine::{Obstacles, Tally};
use enfilade_moves::Layout;
use enfilade_penalties::{WallPiece, disconnection};

impl Study {
    /// Memory for one thread.
    pub fn bench(&self) -> Bench {
        Bench {
            scratches: self.looks.iter().map(Look::scratches).collect(),
            pieces: self.pieces.drawn.clone(),
        }
    }

    /// Measures the layout of one parameter vector.
    pub fn measure(&self, p: &[f64], bench: &mut Bench) -> Worth {
        let layout = self.base.moves.apply(&self.base.plan, &self.base.graph, p);
        let segments = moving_segments(&self.base, &layout, &self.pieces.moves);
        let looks = self.looks.par_iter().zip(&mut bench.scratches);
        let seen = looks.map(|(look, scratches)| {
            let moving = self.moving(look, &layout, &segments);
            let tally = look.main.evaluator.evaluate(&moving, &mut scratches.main);
            self.all_seen(look, &layout, tally, &moving, &mut scratches.pairs)
        });
        let seen = seen.collect();
        self.pieces.place(&self.base, &layout, &mut bench.pieces);
        self.worth(seen, &bench.pieces, &layout)
    }

    /// What moves in a layout, with the cells of a lattice that it covers.
    pub(crate) fn moving(&self, look: &Look, layout: &Layout, segments: &[Segment]) -> Obstacles {
        Obstacles {
            blind: blind(&self.base, layout, &look.main.cells, segments),
            segments: segments.to_vec(),
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
        take_means(self, seen, &mut worth);
        worth
    }
}

/// Takes in what is seen on every lattice: as it is where there is one, else its means.
pub(crate) fn take_means(study: &Study, seen: Vec<SeenOn>, worth: &mut Worth) {
    let looks = &study.looks;
    let share = |(look, seen): (&Look, &SeenOn)| {
        let lattice = &look.main.lattice;
        let (query, all) = (lattice.query.len(), lattice.cells.len());
        let lost = seen.main.tally.disconnected;
        [disconnection(lost, query, all), lost as f64 / (query as f64 * all as f64)]
    };
    let shares: Vec<[f64; 2]> = looks.iter().zip(&seen).map(share).collect();
    let n = looks.len() as f64;
    [worth.disconnection, worth.cut_off] = [0, 1].map(|k| shares.iter().map(|s| s[k]).sum::<f64>() / n);
    let aim = |a: &Aim, look: &Look, on: &SeenOn| {
        let named = a.pair.and_then(|name| study.pairs().iter().position(|p| p.name == name));
        let of = named.and_then(|i| on.pairs.get(i)).unwrap_or(&on.main);
        look.told(a.measure, aims::together(aims::cell_values(of, a.measure), a.aggregate))
    };
    let mean = |a: &Aim| looks.iter().zip(&seen).map(|(l, s)| aim(a, l, s)).sum::<f64>() / n;
    worth.aims = study.aims.iter().map(mean).collect();
    if let [look] = looks.as_slice() {
        SeenOn { main: worth.seen, pairs: worth.pairs } = seen.into_iter().next().unwrap_or_default();
        let all = std::iter::once(&mut worth.seen).chain(&mut worth.pairs);
        all.for_each(|seen| seen.means = look.told_means(&seen.means));
        return;
    }
    let mean = |of: &dyn Fn(&SeenOn) -> Means| {
        let all = looks.iter().zip(&seen).map(|(look, seen)| look.told_means(&of(seen)));
        Seen { means: Means::mean(all.collect()), ..Seen::default() }
    };
    worth.seen = mean(&|s| s.main.means);
    worth.pairs = (0..study.pairs().len()).map(|i| mean(&|s| s.pairs[i].means)).collect();
}

impl Study {
    /// What every pair sees on a lattice in a layout, the unnamed first, whose tally is known; `moving` is what moves,
    /// with the cells of the unnamed pair that it covers.
    pub(crate) fn all_seen(
        &self,
        look: &Look,
        layout: &Layout,
        tally: Tally,
        moving: &Obstacles,
        scratches: &mut [Scratch],
    ) -> SeenOn {
        let of = |(pair, scratch): (&Pair, &mut Scratch)| {
            let blind = blind(&self.base, layout, &pair.scene.cells, &moving.segments);
            let moving = Obstacles { segments: moving.segments.clone(), blind };
            let tally = pair.scene.evaluator.evaluate(&moving, scratch);
            pair.scene.seen(tally, &moving.blind, || self.obstacles(layout, &pair.scene.cells))
        };
        let pairs = look.pairs.iter().zip(scratches).map(of).collect();
        let main = look.main.seen(tally, &moving.blind, || self.obstacles(layout, &look.main.cells));
        SeenOn { main, pairs }
    }

    /// What a pair sees in a layout; the unnamed one for `None`.
    pub fn seen_of<'a>(&self, worth: &'a crate::measure::worth::Worth, pair: Option<PairName>) -> &'a Seen {
        let named = pair.and_then(|name| self.pairs().iter().position(|p| p.name == name));
        named.and_then(|i| worth.pairs.get(i)).unwrap_or(&worth.seen)
    }
}

impl Study {
    /// What a builder would refuse of a layout, allowed or not.
    pub(crate) fn all_faults(&self, layout: &Layout) -> Faults {
        let pieces = self.pieces.placed(&self.base, layout);
        let guards = Guards::whole(&self.base, &self.pieces.drawn);
        guards.faults(&self.base, layout, &enfilade_penalties::Layout { pieces: &pieces })
    }

    /// The walls that a layout runs through each other, and by how many metres, as the penalty counts them.
    pub fn overlapping(&self, layout: &Layout) -> Vec<([u32; 2], f64)> {
        let pieces = self.pieces.placed(&self.base, layout);
        let mut out: BTreeMap<[u32; 2], f64> = BTreeMap::new();
        for (pair, by_m) in self.overlap.pairs_m(&enfilade_penalties::Layout { pieces: &pieces }) {
            *out.entry(pair.map(|p| self.pieces.walls[p])).or_default() += by_m;
        }
        out.into_iter().collect()
    }
}

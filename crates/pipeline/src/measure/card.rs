//! Many layouts at a time, on a graphics card where the study has one.

use std::sync::Arc;
use std::time::{Duration, Instant};

use rayon::prelude::*;

use crate::measure::look::{Bench, SeenOn};
use crate::measure::obstacles::moving_segments;
use crate::measure::study::Study;
use crate::measure::worth::Worth;
use enfilade_engine::geometry::Segment;
use enfilade_engine::gpu::Gpu;
use enfilade_engine::{Obstacles, Tally};
use enfilade_moves::Layout;

/// Layouts that the graphics card measures at a time: what a search asks for fits.
const CARD_LAYOUTS: u32 = 16;

/// Batches by which a card and the cores are compared: the first makes their memory.
const TRIALS: usize = 2;

impl Study {
    /// Measures batches on a graphics card from now on, once it agrees with the cores on the present layout.
    ///
    /// # Errors
    /// Why it cannot, in words for the report.
    pub fn attach(&mut self, gpu: Arc<Gpu>) -> Result<(), String> {
        let identity = self.base.moves.apply(&self.base.plan, &self.base.graph, &self.base.moves.identity());
        let segments = moving_segments(&self.base, &identity, &self.pieces.moves);
        let moving: Vec<Obstacles> =
            self.looks.iter().map(|look| self.moving(look, &identity, &segments)).collect();
        for (look, moving) in self.looks.iter_mut().zip(&moving) {
            look.main.evaluator.attach(Arc::clone(&gpu), moving, CARD_LAYOUTS)?;
        }
        self.gpu = Some(gpu);
        Ok(())
    }

    /// Whether the graphics card, if there is one, measures a batch of the present layout in less time than all cores do:
    /// the least of [`TRIALS`] on each. Whichever goes on, the values are the same.
    ///
    /// # Errors
    /// Why the card failed.
    pub(crate) fn card_pays(&self) -> Result<bool, String> {
        let ps = vec![self.base.moves.identity(); CARD_LAYOUTS as usize];
        let mut least = [Duration::MAX; 2];
        for _ in 0..TRIALS {
            let started = Instant::now();
            self.measure_on_card(&ps)?;
            least[0] = least[0].min(started.elapsed());
            let started = Instant::now();
            self.measure_on_cores(&ps);
            least[1] = least[1].min(started.elapsed());
        }
        Ok(least[0] < least[1])
    }

    /// Measures on the cores from now on.
    pub(crate) fn detach(&mut self) {
        self.gpu = None;
        self.looks.iter_mut().for_each(|look| look.main.evaluator.detach());
    }

    fn measure_on_cores(&self, ps: &[Vec<f64>]) -> Vec<Worth> {
        ps.par_iter().map(|p| self.with_bench(|bench| self.measure(p, bench))).collect()
    }

    /// Measures the layouts of many parameter vectors: all at once on the graphics card if there is one and
    /// it works, otherwise each on a core. The same bits either way.
    pub fn measure_all(&self, ps: &[Vec<f64>]) -> Vec<Worth> {
        if self.gpu.is_none() || self.card_trouble.get().is_some() {
            return self.measure_on_cores(ps);
        }
        match self.measure_on_card(ps) {
            Ok(worths) => worths,
            Err(why) => {
                self.card_trouble.get_or_init(|| why);
                self.measure_on_cores(ps)
            }
        }
    }

    /// Lattice by lattice.
    fn measure_on_card(&self, ps: &[Vec<f64>]) -> Result<Vec<Worth>, String> {
        let laid_out = |p: &Vec<f64>| {
            let layout = self.base.moves.apply(&self.base.plan, &self.base.graph, p);
            let segments = moving_segments(&self.base, &layout, &self.pieces.moves);
            (layout, segments)
        };
        let layouts: Vec<(Layout, Vec<Segment>)> = ps.par_iter().map(laid_out).collect();
        let mut seen: Vec<Vec<SeenOn>> = ps.iter().map(|_| Vec::new()).collect();
        for (k, look) in self.looks.iter().enumerate() {
            let moving: Vec<Obstacles> = layouts.par_iter().map(|(l, s)| self.moving(look, l, s)).collect();
            let tallies = look.main.evaluator.evaluate_on_card(&moving).unwrap_or(Ok(Vec::new()))?;
            let jobs = layouts.par_iter().zip(&moving).zip(tallies);
            let of = |((layout, moving), tally): ((&(Layout, Vec<Segment>), &Obstacles), Tally)| {
                let work = |bench: &mut Bench| {
                    self.all_seen(look, &layout.0, tally, moving, &mut bench.scratches[k].pairs)
                };
                self.with_bench(work)
            };
            let found: Vec<SeenOn> = jobs.map(of).collect();
            seen.iter_mut().zip(found).for_each(|(all, one)| all.push(one));
        }
        let worth = |((layout, _), seen): (&(Layout, Vec<Segment>), Vec<SeenOn>)| {
            self.with_bench(|bench| {
                self.pieces.place(&self.base, layout, &mut bench.pieces);
                self.worth(seen, &bench.pieces, layout)
            })
        };
        Ok(layouts.par_iter().zip(seen).map(worth).collect())
    }

    /// Works with memory that nobody else uses, and keeps it for the next: a search asks for a few layouts at
    /// a time, and to clear the memory of a thread takes longer than to measure one.
    fn with_bench<T>(&self, work: impl FnOnce(&mut Bench) -> T) -> T {
        let idle = self.benches.lock().ok().and_then(|mut benches| benches.pop());
        let mut bench = idle.unwrap_or_else(|| self.bench());
        let done = work(&mut bench);
        if let Ok(mut benches) = self.benches.lock() {
            benches.push(bench);
        }
        done
    }

    /// Areas of two cells or more that no view joins to the largest one, and cells that see no other:
    /// how many of each there are, and how many cells the areas have.
    pub fn cut_off(&self) -> CutOff {
        let mut sizes = vec![0usize; self.looks[0].main.components.len()];
        self.looks[0].main.components.iter().for_each(|&c| sizes[c as usize] += 1);
        let largest = sizes.iter().copied().max().unwrap_or(0);
        let areas = sizes.iter().filter(|n| **n > 1).count().saturating_sub(1);
        let together: usize = sizes.iter().filter(|n| **n > 1).sum();
        // What a wall that may move covers is no floor now.
        let alone = sizes.iter().filter(|n| **n == 1).count() - self.initial_obstacles().blind.len();
        CutOff { areas, cells: together - largest.min(together), alone }
    }

    /// Why the graphics card gave up while layouts were measured; the cores went on.
    pub fn card_trouble(&self) -> Option<&str> {
        self.card_trouble.get().map(String::as_str)
    }
}

/// See [`Study::cut_off`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CutOff {
    /// Areas beside the largest.
    pub areas: usize,
    /// Cells in them.
    pub cells: usize,
    /// Cells that see no other.
    pub alone: usize,
}

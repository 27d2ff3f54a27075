//! The trees of one plan on the graphics card, in its present layout or in many: what is seen without the walls that
//! move is uploaded once, a batch of layouts is shaded and walked in one submission, buffers are used again.

use std::sync::{Arc, Mutex, PoisonError};

use wgpu::Buffer;

use super::rows::Block;
use super::shape::{SQUARE, Shape};
use super::store::{Store, Work, local};
use super::walk::{Trees, Walk};
use super::{Gpu, Params, SEGMENTS_PER_PASS, Step, groups};
use crate::graph::Graph;
use crate::{Lattice, Obstacles, Tally};

/// A lattice and what is seen on it on the card. Roots are the vertices of the query region.
pub struct CardForest {
    store: Store,
    /// Cells of each tile that see any other without the walls that move.
    can_see: Vec<u64>,
    components: Option<Vec<u32>>,
    work: Mutex<Work>,
}

impl CardForest {
    /// `graph` is what is seen where nothing of the layouts stands; `initial_components` are those against which cut-off
    /// vertices are counted; up to `layouts` are measured at a time.
    ///
    /// # Errors
    /// Why this plan cannot be measured on this adapter.
    pub fn new(
        gpu: Arc<Gpu>,
        lattice: Arc<Lattice>,
        graph: &Graph,
        initial_components: Option<&[u32]>,
        layouts: u32,
    ) -> Result<Self, String> {
        let bytes = gpu.buffer_bytes_max();
        Self::with_bytes(gpu, lattice, graph, initial_components, (layouts, bytes), |shape| shape)
    }

    /// For up to so many layouts at a time with buffers of at most so many bytes, cut as a function says.
    pub(super) fn with_bytes(
        gpu: Arc<Gpu>,
        lattice: Arc<Lattice>,
        graph: &Graph,
        initial_components: Option<&[u32]>,
        cut_for: (u32, u64),
        cut: impl FnOnce(Shape) -> Shape,
    ) -> Result<Self, String> {
        if lattice.query.is_empty() {
            return Err("there is no cell to measure".into());
        }
        let store = Store::new(gpu, lattice, graph, initial_components, cut_for, cut)?;
        let new = Self {
            can_see: graph.tile_masks(|v| graph.degree(v) > 0),
            components: initial_components.map(<[u32]>::to_vec),
            work: Mutex::new(Work::new(&store)),
            store,
        };
        new.share_unmoved()?;
        Ok(new)
    }

    /// The stage "share" of what is seen where nothing moves.
    fn share_unmoved(&self) -> Result<(), String> {
        let work = self.work.lock().unwrap_or_else(PoisonError::into_inner);
        self.upload_sight(&work, &[Obstacles::default()]);
        let mut steps = Vec::new();
        self.share(&work, &self.unmoved(), 1, &mut steps);
        self.store.gpu.submit(&steps)
    }

    /// How its work is cut.
    #[cfg(test)]
    pub(super) fn shape(&self) -> Shape {
        self.store.shape
    }

    /// Adapter it runs on.
    pub fn gpu(&self) -> &Gpu {
        &self.store.gpu
    }

    /// The same integers as `forest::tally` of each layout's visibility graph on the cores.
    ///
    /// # Errors
    /// Why the card did not do it; the cores can.
    pub fn tallies(&self, layouts: &[Obstacles]) -> Result<Vec<Tally>, String> {
        let mut work = self.work.lock().unwrap_or_else(PoisonError::into_inner);
        let mut all = Vec::with_capacity(layouts.len());
        for group in layouts.chunks(self.store.shape.layouts as usize) {
            all.extend(self.group(&mut work, group)?);
        }
        Ok(all)
    }

    /// The stage "share" of what is seen in some layouts, by block.
    fn share<'a>(&'a self, work: &Work, seen: &[Buffer], layouts: u32, steps: &mut Vec<Step<'a>>) {
        let (gpu, stage) = (&self.store.gpu, &self.store.gpu.share);
        for (block, seen) in self.store.blocks.iter().zip(seen) {
            let buffers = gpu.bind(stage, &[&block.rows, &work.sight, seen]);
            let params = block.params(self.store.params());
            let groups = groups(u64::from(block.squares), layouts);
            steps.push(Step::Run { stage, buffers, params, groups });
        }
    }

    /// What is seen where nothing moves, by block.
    fn unmoved(&self) -> Vec<Buffer> {
        self.store.blocks.iter().map(|block| block.seen.clone()).collect()
    }

    fn group(&self, work: &mut Work, layouts: &[Obstacles]) -> Result<Vec<Tally>, String> {
        let mut steps = Vec::new();
        self.upload_sight(work, layouts);
        let is_still = matches!(layouts, [only] if only.segments.is_empty() && only.blind.is_empty());
        if !is_still {
            self.shade(work, layouts, &mut steps)?;
        }
        let seen: Vec<Buffer> = match is_still {
            true => self.unmoved(),
            false => work.shaded.clone(),
        };
        let mut batch = vec![Trees::new(self.store.roots.len()); layouts.len()];
        for first in (0..self.store.roots.len() as u32).step_by(self.store.shape.roots() as usize) {
            let roots = self.store.shape.roots().min(self.store.roots.len() as u32 - first);
            let walk =
                Walk { store: &self.store, work, seen: &seen, layouts: layouts.len() as u32, first, roots };
            work.levels = walk.run(std::mem::take(&mut steps), &mut batch)?;
        }
        let tally = |(layout, trees): (&Obstacles, Trees)| {
            let lost = self.lost(layout, &trees.kept);
            trees.into_tally(lost)
        };
        Ok(layouts.iter().zip(batch).map(tally).collect())
    }

    /// Σ over the roots of the vertices of their initial component that were not reached, what is covered left out; from
    /// how many of them were reached, by root.
    fn lost(&self, layout: &Obstacles, kept: &[u32]) -> u64 {
        let Some(components) = &self.components else { return 0 };
        let mut sizes = vec![0u64; components.len()];
        components.iter().for_each(|&c| sizes[c as usize] += 1);
        let mut is_covered = vec![false; components.len()];
        for &v in &layout.blind {
            if !std::mem::replace(&mut is_covered[v as usize], true) {
                sizes[components[v as usize] as usize] -= 1;
            }
        }
        let roots = self.store.lattice.query.iter().zip(kept).filter(|(v, _)| !is_covered[**v as usize]);
        roots.map(|(&v, &kept)| sizes[components[v as usize] as usize] - u64::from(kept)).sum()
    }

    /// Which cells may see in each layout, and which are covered.
    fn upload_sight(&self, work: &Work, layouts: &[Obstacles]) {
        let mut sight = Vec::with_capacity(layouts.len() * self.can_see.len());
        for layout in layouts {
            let first = sight.len();
            sight.extend(self.can_see.iter().map(|&cells| [cells, 0]));
            for &v in &layout.blind {
                let (tile, bit) = self.store.tiles.slot_of[self.store.tiles.rank_of[v as usize] as usize];
                let [seeing, covered]: &mut [u64; 2] = &mut sight[first + tile as usize];
                *seeing &= !(1 << bit);
                *covered |= 1 << bit;
            }
        }
        self.store.gpu.write(&work.sight, &sight);
    }

    /// Uploads the walls of some layouts; steps of the stage "shade".
    fn shade<'a>(
        &'a self,
        work: &mut Work,
        layouts: &[Obstacles],
        steps: &mut Vec<Step<'a>>,
    ) -> Result<(), String> {
        let (gpu, stage) = (&self.store.gpu, &self.store.gpu.shade);
        let (middle_um, corners) = self.store.corners.as_ref().map_err(Clone::clone)?;
        let (mut segments, mut ranges) = (Vec::new(), Vec::new());
        for layout in layouts {
            ranges.push([segments.len() as u32, layout.segments.len() as u32]);
            for s in &layout.segments {
                let (a, b) = (local(s.a, *middle_um)?, local(s.b, *middle_um)?);
                segments.push([a[0], a[1], b[0], b[1]]);
            }
        }
        if segments.len() as u64 * 16 > gpu.buffer_bytes_max() {
            return Err(format!("{} walls at once are more than a buffer holds", segments.len()));
        }
        if segments.len() > work.segments_fit {
            work.segments_fit = segments.len();
            work.segments = gpu.buffer(work.segments_fit as u64 * 4);
        }
        if work.shaded.is_empty() {
            let seen = |b: &Block| {
                gpu.buffer(u64::from(self.store.shape.layouts) * u64::from(b.squares) * 2 * SQUARE as u64)
            };
            work.shaded = self.store.blocks.iter().map(seen).collect();
        }
        gpu.write(&work.segments, &segments);
        gpu.write(&work.ranges, &ranges);
        let most = ranges.iter().map(|r| r[1]).max().unwrap_or(0);
        for (block, shaded) in self.store.blocks.iter().zip(&work.shaded) {
            let buffers =
                [&block.rows, &block.seen, corners, &work.segments, &work.ranges, &work.sight, shaded];
            let bound = gpu.bind(stage, &buffers);
            for pass in 0..most.div_ceil(SEGMENTS_PER_PASS).max(1) {
                let params = Params {
                    first_segment: pass * SEGMENTS_PER_PASS,
                    segments: SEGMENTS_PER_PASS,
                    spacing: self.store.lattice.spacing_um as u32,
                    ..block.params(self.store.params())
                };
                let groups = groups(u64::from(block.squares) * 8, layouts.len() as u32);
                steps.push(Step::Run { stage, buffers: bound.clone(), params, groups });
            }
        }
        self.share(work, &work.shaded, layouts.len() as u32, steps);
        Ok(())
    }
}

//! The trees of some roots in all layouts of a group: levels until none grows, counted by root.

use std::ops::Range;

use wgpu::{BindGroup, Buffer};

use super::store::{Store, Work};
use super::{Params, Step, groups};
use crate::Tally;

/// Tiles that an invocation of the stage "count" adds; `TILES` in `shaders/count.wgsl`.
const TILES_COUNTED: u32 = 64;

/// See the module page.
pub(super) struct Walk<'a> {
    pub store: &'a Store,
    pub work: &'a Work,
    /// What is seen in the layouts, by block.
    pub seen: &'a [Buffer],
    pub layouts: u32,
    /// Roots before these, and how many these are.
    pub first: u32,
    pub roots: u32,
}

/// What the roots have in one layout, by place in the region of query.
#[derive(Clone)]
pub(super) struct Trees {
    levels: Vec<Vec<u32>>,
    degrees: Vec<[u32; 2]>,
    /// Vertices of a root's initial component that it reaches; 0 where nobody asks for components.
    pub kept: Vec<u32>,
}

impl Trees {
    pub fn new(roots: usize) -> Self {
        Self { levels: vec![Vec::new(); roots], degrees: vec![[0; 2]; roots], kept: vec![0; roots] }
    }

    /// With what the layout has lost.
    pub fn into_tally(self, disconnected: u64) -> Tally {
        Tally {
            degree: self.degrees.iter().map(|d| d[0]).collect(),
            degree_all: self.degrees.iter().map(|d| d[1]).collect(),
            depth: self.levels.iter().map(|l| l.len() as u32).collect(),
            levels: self.levels.concat(),
            disconnected,
        }
    }
}

/// Buffers of the stages; those of two levels in turn.
struct Bound {
    blocks: Vec<BoundBlock>,
    count: [BindGroup; 2],
}

/// Those of the stages that go over a block.
struct BoundBlock {
    begin: BindGroup,
    step: [BindGroup; 2],
    kept: Option<[BindGroup; 2]>,
}

impl<'a> Walk<'a> {
    /// Submits what came before together with the first levels, goes on while any tree grows, and keeps what is
    /// found in the batch; how many levels the next walk may need.
    pub fn run(&self, mut steps: Vec<Step<'a>>, batch: &mut [Trees]) -> Result<u32, String> {
        let (gpu, work) = (&self.store.gpu, self.work);
        let bound = Bound {
            blocks: (0..self.seen.len()).map(|b| self.bound(b)).collect(),
            count: [0, 1].map(|i| gpu.bind(&gpu.count, &[&work.fronts[i], &work.sums, &work.counts])),
        };
        let mut degrees = if self.first == 0 { self.degrees(&mut steps) } else { 0 };
        self.begin(&bound, &mut steps);
        let most = self.store.shape.levels;
        let mut many = work.levels.clamp(1, most);
        let mut done = 0;
        loop {
            let counts = self.levels(done..done + many, &bound, &mut steps);
            self.copy((&work.counts, counts), 0, &mut steps);
            self.copy((&work.degrees, degrees), counts, &mut steps);
            gpu.submit(&steps)?;
            steps.clear();
            let read = gpu.read(&work.staging, counts + degrees)?;
            self.add_degrees(&read[counts..], batch);
            if !self.add_levels(&read[..counts], batch) {
                break;
            }
            (done, degrees) = (done + many, 0);
            many = (2 * many).min(most);
        }
        let deepest = batch.iter().flat_map(|trees| &trees.levels).map(Vec::len).max().unwrap_or(0);
        // One more finds nothing, and so the end.
        Ok(deepest as u32 + 1)
    }

    /// The levels after some, each in a slot, and in one more who of the initial components is reached; words of all slots.
    fn levels(&self, levels: Range<u32>, bound: &Bound, steps: &mut Vec<Step<'a>>) -> usize {
        let words = (levels.len() + 1) * self.trees();
        steps.push(Step::Clear { buffer: &self.work.counts, from: 0, bytes: words as u64 * 4 });
        for (slot, level) in (0..).zip(levels.clone()) {
            self.level(level + 1, bound, steps);
            self.count(&bound.count[(level + 1) as usize % 2], slot, steps);
        }
        let to = (levels.end + 1) as usize % 2;
        if self.kept(to, bound, steps) {
            self.count(&bound.count[to], levels.len() as u32, steps);
        }
        words
    }

    /// Words for the cores, `at` words behind the first.
    fn copy(&self, (from, words): (&'a Buffer, usize), at: usize, steps: &mut Vec<Step<'a>>) {
        if words > 0 {
            let [to_at, bytes] = [at, words].map(|n| n as u64 * 4);
            steps.push(Step::Copy { from, at: 0, to: &self.work.staging, to_at, bytes });
        }
    }

    /// Adds the levels in all slots but the last, and what is in that if they are all; whether they may not be.
    fn add_levels(&self, slots: &[u32], batch: &mut [Trees]) -> bool {
        let (levels, kept) = slots.split_at(slots.len() - self.trees());
        let mut grows = false;
        for counts in levels.chunks_exact(self.trees()) {
            grows = self.add_level(counts, batch);
        }
        if !grows {
            self.for_each_tree(|tree, layout, place| batch[layout].kept[place] = kept[tree]);
        }
        grows
    }

    fn trees(&self) -> usize {
        (self.layouts * self.roots) as usize
    }

    /// Calls `visit` with the number, layout and place of each tree.
    fn for_each_tree(&self, mut visit: impl FnMut(usize, usize, usize)) {
        let roots = &self.store.roots[self.first as usize..][..self.roots as usize];
        for layout in 0..self.layouts as usize {
            for (i, root) in roots.iter().enumerate() {
                visit(layout * roots.len() + i, layout, root.1 as usize);
            }
        }
    }

    /// Adds a level; whether any tree has it.
    fn add_level(&self, counts: &[u32], batch: &mut [Trees]) -> bool {
        let mut grows = false;
        self.for_each_tree(|tree, layout, place| {
            if counts[tree] > 0 {
                batch[layout].levels[place].push(counts[tree]);
                grows = true;
            }
        });
        grows
    }

    fn bound(&self, block: usize) -> BoundBlock {
        let (gpu, work, store) = (&self.store.gpu, self.work, self.store);
        let (rows, seen) = (&self.store.blocks[block].rows, &self.seen[block]);
        let Work { sight, missing, fronts, sums, awake, .. } = work;
        let step = |to: usize| {
            let buffers = [rows, seen, sight, missing, &fronts[1 - to], &fronts[to], sums, awake];
            gpu.bind(&gpu.step, &buffers)
        };
        let kept = |labels: &Buffer| {
            [0, 1].map(|to| gpu.bind(&gpu.kept, &[rows, sight, labels, missing, &fronts[to], sums]))
        };
        BoundBlock {
            begin: gpu.bind(&gpu.begin, &[rows, sight, &store.root_at, missing, &fronts[0], sums, awake]),
            step: [0, 1].map(step),
            kept: store.labels.as_ref().map(kept),
        }
    }

    fn params(&self) -> Params {
        Params {
            layouts: self.layouts,
            roots: self.roots,
            first_root: self.first,
            all_roots: self.store.roots.len() as u32,
            words: self.store.shape.words,
            ..self.store.params()
        }
    }

    /// The stage "degrees", for all roots; how many words it makes.
    fn degrees(&self, steps: &mut Vec<Step<'a>>) -> usize {
        let (gpu, store) = (&self.store.gpu, self.store);
        let (stage, all) = (&gpu.degrees, store.roots.len());
        for (block, seen) in store.blocks.iter().zip(self.seen) {
            let buffers =
                [&block.rows, seen, &self.work.sight, &store.region, &store.root_slots, &self.work.degrees];
            let params = Params { roots: all as u32, ..block.params(self.params()) };
            let groups = groups(all as u64, self.layouts);
            steps.push(Step::Run { stage, buffers: gpu.bind(stage, &buffers), params, groups });
        }
        all * self.layouts as usize * 2
    }

    fn add_degrees(&self, words: &[u32], batch: &mut [Trees]) {
        let roots = &self.store.roots;
        for (layout, degrees) in words.chunks_exact(roots.len() * 2).enumerate() {
            for (root, degrees) in roots.iter().zip(degrees.chunks_exact(2)) {
                batch[layout].degrees[root.1 as usize] = [degrees[0], degrees[1]];
            }
        }
    }

    fn begin(&self, bound: &Bound, steps: &mut Vec<Step<'a>>) {
        let (stage, awake) = (&self.store.gpu.begin, &self.work.awake);
        steps.push(Step::Clear { buffer: awake, from: 0, bytes: awake.size() });
        for (block, bound) in self.store.blocks.iter().zip(&bound.blocks) {
            let params = block.params(self.params());
            let groups = groups(u64::from(block.tiles) * u64::from(params.words), self.layouts);
            steps.push(Step::Run { stage, buffers: bound.begin.clone(), params, groups });
        }
    }

    /// The stage "step", a block and a part of its tiles after the other.
    fn level(&self, level: u32, bound: &Bound, steps: &mut Vec<Step<'a>>) {
        let (stage, shape) = (&self.store.gpu.step, self.store.shape);
        for (block, bound) in self.store.blocks.iter().zip(&bound.blocks) {
            for pass in 0..shape.passes {
                let params = Params {
                    level,
                    first_square: pass * shape.pass_squares,
                    pass_squares: shape.pass_squares,
                    is_last: u32::from(pass + 1 == shape.passes),
                    ..block.params(self.params())
                };
                let groups = groups(u64::from(block.tiles) * u64::from(params.words), self.layouts);
                let buffers = bound.step[level as usize % 2].clone();
                steps.push(Step::Run { stage, buffers, params, groups });
            }
        }
    }

    /// The stage "kept" into one of two frontiers, where there is an initial layout; whether there is.
    fn kept(&self, to: usize, bound: &Bound, steps: &mut Vec<Step<'a>>) -> bool {
        let stage = &self.store.gpu.kept;
        for (block, bound) in self.store.blocks.iter().zip(&bound.blocks) {
            let Some(buffers) = &bound.kept else { return false };
            let params = block.params(self.params());
            let groups = groups(u64::from(block.tiles) * u64::from(params.words), self.layouts);
            let buffers = buffers[to].clone();
            steps.push(Step::Run { stage, buffers, params, groups });
        }
        true
    }

    /// The stage "count".
    fn count(&self, buffers: &BindGroup, slot: u32, steps: &mut Vec<Step<'a>>) {
        let params = Params { slot, ..self.params() };
        let many = u64::from(params.tiles.div_ceil(TILES_COUNTED)) * u64::from(params.words);
        let groups = groups(many, self.layouts);
        steps.push(Step::Run { stage: &self.store.gpu.count, buffers: buffers.clone(), params, groups });
    }
}

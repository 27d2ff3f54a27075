//! The trees of some roots in all layouts of a group: levels until none grows, counted by root.

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

/// What the roots have in each layout, by place in the region of query.
pub(super) struct Batch {
    levels: Vec<Vec<Vec<u32>>>,
    degrees: Vec<Vec<[u32; 2]>>,
    /// Vertices of a root's initial component that it reaches; 0 where none are told apart.
    pub kept: Vec<Vec<u32>>,
}

impl Batch {
    pub fn new(layouts: usize, roots: usize) -> Self {
        Self {
            levels: vec![vec![Vec::new(); roots]; layouts],
            degrees: vec![vec![[0; 2]; roots]; layouts],
            kept: vec![vec![0; roots]; layouts],
        }
    }

    /// With what each layout has lost.
    pub fn into_tallies(self, lost: Vec<u64>) -> Vec<Tally> {
        let tally = |((levels, degrees), disconnected): ((Vec<Vec<u32>>, Vec<[u32; 2]>), u64)| Tally {
            degree: degrees.iter().map(|d| d[0]).collect(),
            degree_all: degrees.iter().map(|d| d[1]).collect(),
            depth: levels.iter().map(|l| l.len() as u32).collect(),
            levels: levels.concat(),
            disconnected,
        };
        self.levels.into_iter().zip(self.degrees).zip(lost).map(tally).collect()
    }
}

/// Buffers of the stages of a block; those of two levels in turn.
struct Bound {
    begin: BindGroup,
    step: [BindGroup; 2],
    kept: Option<[BindGroup; 2]>,
}

impl<'a> Walk<'a> {
    /// Submits what came before together with the first levels, goes on while any tree grows, and keeps what is
    /// found in the batch; how many levels the next walk may need.
    pub fn run(&self, mut steps: Vec<Step<'a>>, batch: &mut Batch) -> Result<u32, String> {
        let (gpu, work) = (&self.store.gpu, self.work);
        let bound: Vec<Bound> = (0..self.seen.len()).map(|b| self.bound(b)).collect();
        let count = [0, 1].map(|i| gpu.bind(&gpu.count, &[&work.fronts[i], &work.sums, &work.counts]));
        let mut degrees = if self.first == 0 { self.degrees(&mut steps) } else { 0 };
        self.begin(&bound, &mut steps);
        let most = self.store.shape.levels;
        let mut many = work.levels.clamp(1, most);
        let mut done = 0;
        loop {
            let slots = many as usize + 1;
            let bytes = (slots * self.trees() * 4) as u64;
            steps.push(Step::Clear { buffer: &work.counts, from: 0, bytes });
            for slot in 0..many {
                self.level(done + slot + 1, &bound, &mut steps);
                self.count(&count[(done + slot + 1) as usize % 2], slot, &mut steps);
            }
            done += many;
            if self.kept(done, &bound, &mut steps) {
                self.count(&count[(done + 1) as usize % 2], many, &mut steps);
            }
            let to = &work.staging;
            steps.push(Step::Copy { from: &work.counts, at: 0, to, to_at: 0, bytes });
            if degrees > 0 {
                let more = degrees as u64 * 4;
                steps.push(Step::Copy { from: &work.degrees, at: 0, to, to_at: bytes, bytes: more });
            }
            gpu.submit(&steps)?;
            steps.clear();
            let read = gpu.read(to, slots * self.trees() + degrees)?;
            let (read, more) = read.split_at(slots * self.trees());
            self.add_degrees(more, batch);
            degrees = 0;
            let mut by_slot = read.chunks_exact(self.trees());
            let mut grows = false;
            for counts in by_slot.by_ref().take(many as usize) {
                grows = self.add_level(counts, batch);
            }
            if !grows {
                if let Some(kept) = by_slot.next() {
                    self.for_each_tree(|tree, l, place| batch.kept[l][place] = kept[tree]);
                }
                break;
            }
            many = (2 * many).min(most);
        }
        let deepest = batch.levels.iter().flatten().map(Vec::len).max().unwrap_or(0);
        // One more finds nothing, and so the end.
        Ok(deepest as u32 + 1)
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
    fn add_level(&self, counts: &[u32], batch: &mut Batch) -> bool {
        let mut grows = false;
        self.for_each_tree(|tree, layout, place| {
            if counts[tree] > 0 {
                batch.levels[layout][place].push(counts[tree]);
                grows = true;
            }
        });
        grows
    }

    fn bound(&self, block: usize) -> Bound {
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
        Bound {
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

    fn add_degrees(&self, words: &[u32], batch: &mut Batch) {
        let roots = &self.store.roots;
        for (layout, degrees) in words.chunks_exact(roots.len() * 2).enumerate() {
            for (root, degrees) in roots.iter().zip(degrees.chunks_exact(2)) {
                batch.degrees[layout][root.1 as usize] = [degrees[0], degrees[1]];
            }
        }
    }

    fn begin(&self, bound: &[Bound], steps: &mut Vec<Step<'a>>) {
        let (stage, awake) = (&self.store.gpu.begin, &self.work.awake);
        steps.push(Step::Clear { buffer: awake, from: 0, bytes: awake.size() });
        for (block, bound) in self.store.blocks.iter().zip(bound) {
            let params = block.params(self.params());
            let groups = groups(u64::from(block.tiles) * u64::from(params.words), self.layouts);
            steps.push(Step::Run { stage, buffers: bound.begin.clone(), params, groups });
        }
    }

    /// The stage "step", a block and a part of its tiles after the other.
    fn level(&self, level: u32, bound: &[Bound], steps: &mut Vec<Step<'a>>) {
        let (stage, shape) = (&self.store.gpu.step, self.store.shape);
        for (block, bound) in self.store.blocks.iter().zip(bound) {
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

    /// The stage "kept" after so many levels, where there is an initial layout; whether there is.
    fn kept(&self, done: u32, bound: &[Bound], steps: &mut Vec<Step<'a>>) -> bool {
        let stage = &self.store.gpu.kept;
        for (block, bound) in self.store.blocks.iter().zip(bound) {
            let Some(buffers) = &bound.kept else { return false };
            let params = block.params(self.params());
            let groups = groups(u64::from(block.tiles) * u64::from(params.words), self.layouts);
            let buffers = buffers[(done + 1) as usize % 2].clone();
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

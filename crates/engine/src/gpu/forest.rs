//! The forest of many layouts of one plan on the graphics card: what never moves is prepared once, a
//! batch of layouts goes in one submission, buffers are used again.

use std::sync::{Arc, Mutex, PoisonError};

use wgpu::{BindGroup, Buffer};

use super::{GROUP, Gpu, Params, ROWS_PER_PASS, SEGMENTS_PER_PASS, Step};
use crate::geometry::{PointUm, Segment};
use crate::graph::{Graph, RowChunk};
use crate::tiles::Tiles;
use crate::{Lattice, Obstacles, Tally};

/// Levels walked before the counts come back; a tree that is deeper takes another submission.
pub(super) const LEVELS_PER_SUBMISSION: u32 = 12;

/// Ordinates from the middle of the plan, at most: differences of two fit into 32 bits.
pub const ORDINATE_UM_MAX: i64 = (1 << 30) - 1;

/// Bytes of the visibility matrix of one layout, at most: 130,000 vertices.
pub const MATRIX_BYTES_MAX: u64 = 2 << 30;

/// How the work is cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Shape {
    pub vertices: u32,
    /// Words of 32 vertices in a row.
    pub words: u32,
    /// Rows of a block of the matrix, a multiple of 32.
    pub rows: u32,
    /// Layouts of a submission.
    pub layouts: u32,
    /// Roots walked from at a time.
    pub roots: u32,
}

impl Shape {
    /// Cuts the work so that no buffer has more than `bytes_max` bytes and no dispatch more than
    /// `groups_max` groups a side.
    pub fn new(vertices: u32, roots: u32, layouts: u32, bytes_max: u64, groups_max: u32) -> Self {
        let words = vertices.div_ceil(32).max(1);
        let row_bytes = u64::from(words) * 4;
        let all_rows = words * 32;
        let fit = (bytes_max / row_bytes).min(u64::from(u32::MAX)) as u32;
        let rows = (fit / 32 * 32).clamp(32, all_rows).min(ROWS_PER_PASS);
        let together = if rows == all_rows { fit / all_rows } else { 1 };
        let layouts = layouts.clamp(1, together.max(1));
        let by_bytes = fit / layouts;
        let by_groups = (u64::from(groups_max) * u64::from(GROUP) / u64::from(words)) as u32;
        Self { vertices, words, rows, layouts, roots: roots.min(by_bytes).min(by_groups).max(1) }
    }

    /// First row and number of rows of each block.
    pub fn blocks(&self) -> impl Iterator<Item = (u32, u32)> + use<> {
        let (all, rows) = (self.vertices, self.rows);
        (0..all.div_ceil(rows)).map(move |i| (i * rows, rows.min(all - i * rows)))
    }
}

/// A lattice and its fixed walls on the card. Roots are the vertices of the query region.
pub struct CardForest {
    gpu: Arc<Gpu>,
    lattice: Arc<Lattice>,
    tiles: Arc<Tiles>,
    middle_um: PointUm,
    shape: Shape,
    centres: Buffer,
    boxes: Buffer,
    /// Reference bits, labels of the initial components, roots.
    region: Buffer,
    base: Vec<Buffer>,
    work: Mutex<Work>,
}

/// Buffers that every batch uses again.
struct Work {
    seen: Vec<Buffer>,
    segments: Buffer,
    segments_fit: usize,
    ranges: Buffer,
    blind: Buffer,
    reached: Buffer,
    frontier: Buffer,
    next: Buffer,
    counts: Buffer,
    /// Counts of the last level, on their way to the first slot.
    carry: Buffer,
    roots_out: Buffer,
    staging: Buffer,
}

impl CardForest {
    /// `fixed` blocks sight in every layout; `initial_components` are those against which cut-off
    /// vertices are counted; up to `layouts` are measured at a time.
    ///
    /// # Errors
    /// Why this plan cannot be measured on this adapter.
    pub fn new(
        gpu: Arc<Gpu>,
        lattice: Arc<Lattice>,
        fixed: &[Segment],
        initial_components: Option<&[u32]>,
        layouts: u32,
    ) -> Result<Self, String> {
        let (n, roots) = (lattice.cells.len() as u32, lattice.query.len() as u32);
        let shape = Shape::new(n, roots, layouts, gpu.buffer_bytes_max(), gpu.groups_max());
        let bytes = u64::from(n) * u64::from(shape.words) * 4;
        if bytes > MATRIX_BYTES_MAX || n == 0 {
            return Err(format!("{n} cells: the matrix of sight lines would take {} MB", bytes >> 20));
        }
        Self::with_shape(gpu, lattice, fixed, initial_components, shape)
    }

    pub(super) fn with_shape(
        gpu: Arc<Gpu>,
        lattice: Arc<Lattice>,
        fixed: &[Segment],
        initial_components: Option<&[u32]>,
        shape: Shape,
    ) -> Result<Self, String> {
        let tiles = Arc::new(Tiles::new(&lattice));
        let (middle_um, centres) = local_centres(&lattice, &tiles)?;
        let region = region_words(&lattice, &tiles, initial_components);
        let mut new = Self {
            work: Mutex::new(Work::new(&gpu, &shape)),
            centres: gpu.buffer(u64::from(shape.vertices) * 2),
            boxes: gpu.buffer(u64::from(shape.words) * 4),
            region: gpu.buffer(region.len() as u64),
            base: Vec::new(),
            gpu,
            lattice,
            tiles,
            middle_um,
            shape,
        };
        new.gpu.write(&new.centres, &centres);
        new.gpu.write(&new.boxes, &word_boxes(&centres));
        new.gpu.write(&new.region, &region);
        new.base = new.base_of(fixed)?;
        Ok(new)
    }

    /// Adapter it runs on.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// The same integers as `forest::tally` of each layout's visibility graph on the cores.
    ///
    /// # Errors
    /// Why the card did not do it; the cores can.
    pub fn tallies(&self, layouts: &[Obstacles]) -> Result<Vec<Tally>, String> {
        let mut work = self.work.lock().unwrap_or_else(PoisonError::into_inner);
        let mut all = Vec::with_capacity(layouts.len());
        for group in layouts.chunks(self.shape.layouts as usize) {
            all.extend(self.group(&mut work, group)?);
        }
        Ok(all)
    }

    /// The visibility graph of the fixed walls.
    ///
    /// # Errors
    /// Why the card did not return it.
    pub fn fixed_graph(&self) -> Result<Graph, String> {
        let words = self.shape.words as usize;
        let staging = self.gpu.staging(u64::from(self.shape.rows) * words as u64);
        let mut chunks = Vec::new();
        for ((_, rows), block) in self.shape.blocks().zip(&self.base) {
            let n = rows as usize * words;
            let copy = Step::Copy { from: block, at: 0, to: &staging, to_at: 0, bytes: n as u64 * 4 };
            self.gpu.submit(&[copy])?;
            let bits = self.gpu.read(&staging, n)?;
            chunks.push(row_chunk(&self.tiles, bits.chunks_exact(words)));
        }
        Ok(Graph::from_chunks(Arc::clone(&self.tiles), chunks))
    }

    fn base_of(&self, fixed: &[Segment]) -> Result<Vec<Buffer>, String> {
        let (shape, gpu) = (&self.shape, &self.gpu);
        let words = u64::from(shape.words);
        let blocks: Vec<Buffer> =
            shape.blocks().map(|(_, rows)| gpu.buffer(u64::from(rows) * words)).collect();
        let mut work = self.work.lock().unwrap_or_else(PoisonError::into_inner);
        let only = [Obstacles { segments: fixed.to_vec(), blind: Vec::new() }];
        let most = self.upload(&mut work, &only)?;
        let none = gpu.buffer(4);
        let mut steps = Vec::new();
        for (block, seen) in shape.blocks().zip(&blocks) {
            self.see(&work, block, (&none, seen), (1, most, FROM_ALL), &mut steps);
        }
        gpu.submit(&steps)?;
        Ok(blocks)
    }

    /// Walls and covered cells of some layouts; returns the most walls any of them has.
    fn upload(&self, work: &mut Work, layouts: &[Obstacles]) -> Result<u32, String> {
        let words = self.shape.words as usize;
        let (mut segments, mut ranges) = (Vec::new(), Vec::new());
        let mut blind = vec![0u32; words * layouts.len()];
        for (l, layout) in layouts.iter().enumerate() {
            ranges.push([segments.len() as u32, layout.segments.len() as u32]);
            for s in &layout.segments {
                let (a, b) = (local(s.a, self.middle_um)?, local(s.b, self.middle_um)?);
                segments.push([a[0], a[1], b[0], b[1]]);
            }
            for &v in &layout.blind {
                let rank = self.tiles.rank_of[v as usize] as usize;
                blind[l * words + rank / 32] |= 1 << (rank % 32);
            }
        }
        if segments.len() > work.segments_fit {
            work.segments_fit = segments.len() * 2;
            work.segments = self.gpu.buffer(work.segments_fit as u64 * 4);
        }
        if segments.len() as u64 * 16 > self.gpu.buffer_bytes_max() {
            return Err(format!("{} walls at once are more than a buffer holds", segments.len()));
        }
        self.gpu.write(&work.segments, &segments);
        self.gpu.write(&work.ranges, &ranges);
        self.gpu.write(&work.blind, &blind);
        Ok(ranges.iter().map(|r| r[1]).max().unwrap_or(0))
    }

    /// Steps of the stage "visibility" over one block of rows.
    fn see<'a>(
        &'a self,
        work: &Work,
        (first_row, rows): (u32, u32),
        (base, seen): (&Buffer, &Buffer),
        (layouts, most, first): (u32, u32, u32),
        steps: &mut Vec<Step<'a>>,
    ) {
        let stage = &self.gpu.visibility;
        let buffers = [&self.centres, &self.boxes, &work.segments, &work.ranges, &work.blind, base, seen];
        for pass in 0..most.div_ceil(SEGMENTS_PER_PASS).max(1) {
            let params = Params {
                first_row,
                rows,
                first_segment: pass * SEGMENTS_PER_PASS,
                segments: SEGMENTS_PER_PASS,
                is_first: if pass == 0 { first } else { 0 },
                layouts,
                ..self.params()
            };
            let groups = [rows.div_ceil(GROUP), self.shape.words, layouts];
            steps.push(Step::Run { stage, buffers: self.gpu.bind(stage, &buffers), params, groups });
        }
    }

    fn params(&self) -> Params {
        Params { words: self.shape.words, vertices: self.shape.vertices, ..Params::default() }
    }

    fn group(&self, work: &mut Work, layouts: &[Obstacles]) -> Result<Vec<Tally>, String> {
        let most = self.upload(work, layouts)?;
        let work = &*work;
        let mut steps = Vec::new();
        for ((block, base), seen) in self.shape.blocks().zip(&self.base).zip(&work.seen) {
            self.see(work, block, (base, seen), (layouts.len() as u32, most, FROM_BASE), &mut steps);
        }
        let mut all = vec![Tally::default(); layouts.len()];
        let n_roots = self.lattice.query.len() as u32;
        for first in (0..n_roots).step_by(self.shape.roots as usize) {
            let roots = self.shape.roots.min(n_roots - first);
            let walk = Walk { forest: self, work, layouts: layouts.len() as u32, first, roots };
            walk.run(std::mem::take(&mut steps), &mut all)?;
        }
        Ok(all)
    }
}

/// `is_first` of the stage "visibility".
const FROM_BASE: u32 = 1;
const FROM_ALL: u32 = 2;

impl Work {
    fn new(gpu: &Gpu, shape: &Shape) -> Self {
        let words = u64::from(shape.words);
        let layouts = u64::from(shape.layouts);
        let trees = layouts * u64::from(shape.roots);
        let matrix = || gpu.buffer(trees * words);
        let counts = u64::from(LEVELS_PER_SUBMISSION + 1) * trees;
        Self {
            seen: shape.blocks().map(|(_, rows)| gpu.buffer(layouts * u64::from(rows) * words)).collect(),
            segments: gpu.buffer(0),
            segments_fit: 0,
            ranges: gpu.buffer(layouts * 2),
            blind: gpu.buffer(layouts * words),
            reached: matrix(),
            frontier: matrix(),
            next: matrix(),
            counts: gpu.buffer(counts),
            carry: gpu.buffer(trees),
            roots_out: gpu.buffer(2 * trees),
            staging: gpu.staging(counts + 2 * trees),
        }
    }
}

/// The trees of some roots in all layouts of a group.
struct Walk<'a> {
    forest: &'a CardForest,
    work: &'a Work,
    layouts: u32,
    first: u32,
    roots: u32,
}

impl<'a> Walk<'a> {
    /// Submits what came before together with the first levels, goes on while any tree grows, and adds
    /// the results to the tallies.
    fn run(&self, mut steps: Vec<Step<'a>>, all: &mut [Tally]) -> Result<(), String> {
        let (gpu, work, trees) = (&self.forest.gpu, self.work, self.trees());
        let slot_bytes = trees as u64 * 4;
        let slots = u64::from(LEVELS_PER_SUBMISSION);
        steps.push(Step::Clear { buffer: &work.counts, from: 0, bytes: slot_bytes * (slots + 1) });
        steps.push(Step::Clear { buffer: &work.roots_out, from: 0, bytes: slot_bytes * 2 });
        let levels_bind = self.levels_bind();
        let frontier_binds: Vec<BindGroup> = work.seen.iter().map(|seen| self.frontier_bind(seen)).collect();
        self.count(&levels_bind, 0, &mut steps);
        let mut levels = vec![Vec::new(); trees];
        let mut level = 1;
        let roots_out = loop {
            for _ in 0..LEVELS_PER_SUBMISSION {
                self.expand(&frontier_binds, level, &mut steps);
                self.count(&levels_bind, level, &mut steps);
                level += 1;
            }
            let (counts, out) = (slot_bytes * (slots + 1), slot_bytes * 2);
            let (to, at) = (&work.staging, 0);
            steps.push(Step::Copy { from: &work.counts, at, to, to_at: 0, bytes: counts });
            steps.push(Step::Copy { from: &work.roots_out, at, to, to_at: counts, bytes: out });
            gpu.submit(&steps)?;
            steps.clear();
            let read = gpu.read(&work.staging, ((counts + out) / 4) as usize)?;
            for slot in read[..(counts / 4) as usize].chunks_exact(trees).skip(1) {
                let grown = levels.iter_mut().zip(slot).filter(|(_, n)| **n > 0);
                grown.for_each(|(levels, &n): (&mut Vec<u32>, _)| levels.push(n));
            }
            let last = slots as usize * trees;
            if read[last..last + trees].iter().all(|&n| n == 0) {
                break read[(counts / 4) as usize..].to_vec();
            }
            let (from, to) = (&work.counts, &work.carry);
            steps.push(Step::Copy { from, at: slot_bytes * slots, to, to_at: 0, bytes: slot_bytes });
            steps.push(Step::Copy { from: to, at: 0, to: from, to_at: 0, bytes: slot_bytes });
            steps.push(Step::Clear { buffer: from, from: slot_bytes, bytes: slot_bytes * slots });
        };
        self.add(levels, &roots_out, all);
        Ok(())
    }

    fn trees(&self) -> usize {
        (self.layouts * self.roots) as usize
    }

    fn levels_bind(&self) -> BindGroup {
        let w = self.work;
        let buffers =
            [&w.reached, &w.frontier, &w.next, &w.counts, &w.roots_out, &self.forest.region, &w.blind];
        self.forest.gpu.bind(&self.forest.gpu.levels, &buffers)
    }

    fn frontier_bind(&self, seen: &Buffer) -> BindGroup {
        let w = self.work;
        let buffers = [seen, &w.counts, &w.reached, &w.frontier, &w.next];
        self.forest.gpu.bind(&self.forest.gpu.frontier, &buffers)
    }

    fn params(&self, level: u32) -> Params {
        let slot_before = level.saturating_sub(1) % LEVELS_PER_SUBMISSION;
        Params {
            layouts: self.layouts,
            roots: self.roots,
            first_root: self.first,
            level,
            slot_before,
            slot: slot_before + 1,
            ..self.forest.params()
        }
    }

    fn groups(&self) -> [u32; 3] {
        [(self.roots * self.forest.shape.words).div_ceil(GROUP), self.layouts, 1]
    }

    /// The stage "frontier", a block of the matrix after the other.
    fn expand(&self, binds: &[BindGroup], level: u32, steps: &mut Vec<Step<'a>>) {
        for ((first_row, rows), bind) in self.forest.shape.blocks().zip(binds) {
            let params = Params { first_row, rows, ..self.params(level) };
            let stage = &self.forest.gpu.frontier;
            steps.push(Step::Run { stage, buffers: bind.clone(), params, groups: self.groups() });
        }
    }

    /// The stage "levels".
    fn count(&self, bind: &BindGroup, level: u32, steps: &mut Vec<Step<'a>>) {
        let stage = &self.forest.gpu.levels;
        let params = self.params(level);
        steps.push(Step::Run { stage, buffers: bind.clone(), params, groups: self.groups() });
    }

    fn add(&self, levels: Vec<Vec<u32>>, roots_out: &[u32], all: &mut [Tally]) {
        let trees = self.trees();
        for (tree, levels) in levels.into_iter().enumerate() {
            let tally = &mut all[tree / self.roots as usize];
            tally.degree.push(roots_out[tree]);
            tally.degree_all.push(levels.first().copied().unwrap_or(0));
            tally.depth.push(levels.len() as u32);
            tally.levels.extend(levels);
            tally.disconnected += u64::from(roots_out[trees + tree]);
        }
    }
}

/// Centres by rank, micrometres from the middle of the lattice's box.
fn local_centres(lattice: &Lattice, tiles: &Tiles) -> Result<(PointUm, Vec<[i32; 2]>), String> {
    let corner = |k: usize, cells: i64| {
        let index = tiles.min_cell[k] + cells;
        lattice.origin_um[k] + index * lattice.spacing_um
    };
    let middle = [0, 1].map(|k| corner(k, tiles.size_cells[k] as i64 / 2));
    let centre = |&v: &u32| local(lattice.centre_um(v as usize), middle);
    let centres: Result<Vec<_>, String> = tiles.vertex_of.iter().map(centre).collect();
    Ok((middle, centres?))
}

fn local(p: PointUm, middle: PointUm) -> Result<[i32; 2], String> {
    let [x, y] = [0, 1].map(|k| p[k].saturating_sub(middle[k]));
    if x.abs().max(y.abs()) > ORDINATE_UM_MAX {
        return Err(format!("the plan reaches more than {} m from its middle", ORDINATE_UM_MAX / 1_000_000));
    }
    Ok([x as i32, y as i32])
}

/// Smallest and largest ordinates of every 32 centres.
fn word_boxes(centres: &[[i32; 2]]) -> Vec<[i32; 4]> {
    let extreme = |word: &[[i32; 2]]| {
        let first = [word[0][0], word[0][1], word[0][0], word[0][1]];
        word.iter().fold(first, |b, p| [b[0].min(p[0]), b[1].min(p[1]), b[2].max(p[0]), b[3].max(p[1])])
    };
    centres.chunks(32).map(extreme).collect()
}

fn region_words(lattice: &Lattice, tiles: &Tiles, components: Option<&[u32]>) -> Vec<u32> {
    let n = lattice.cells.len();
    let mut words = vec![0u32; n.div_ceil(32)];
    for (rank, &v) in tiles.vertex_of.iter().enumerate() {
        words[rank / 32] |= u32::from(lattice.is_reference[v as usize]) << (rank % 32);
    }
    // Without an initial layout every vertex is a component of its own: nothing can be lost.
    words.extend(tiles.vertex_of.iter().map(|&v| components.map_or(v, |c| c[v as usize])));
    words.extend(lattice.query.iter().map(|&v| tiles.rank_of[v as usize]));
    words
}

/// Rows of bits by rank as rows of the graph.
fn row_chunk<'a>(tiles: &Tiles, rows: impl Iterator<Item = &'a [u32]>) -> RowChunk {
    let mut chunk = RowChunk::default();
    for row in rows {
        let (before, mut degree) = (chunk.tile.len(), 0);
        for (w, &word) in row.iter().enumerate() {
            degree += word.count_ones();
            let mut left = word;
            while left != 0 {
                let (tile, bit) = tiles.slot_of[w * 32 + left.trailing_zeros() as usize];
                left &= left - 1;
                if chunk.tile.len() == before || chunk.tile.last() != Some(&tile) {
                    chunk.tile.push(tile);
                    chunk.mask.push(0);
                }
                if let Some(mask) = chunk.mask.last_mut() {
                    *mask |= 1 << bit;
                }
            }
        }
        chunk.rows.push(((chunk.tile.len() - before) as u32, degree));
    }
    chunk
}

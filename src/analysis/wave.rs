//! Breadth-first waves from 512 roots at once: stages "frontier" and "levels".
//!
//! A vertex that some roots have not reached pulls the frontier words of its neighbours. Neighbours are
//! listed per tile as aligned blocks of cells (cell, pair, four, row of eight, the whole tile), so
//! that a tile's words are combined once a level and not once a neighbour; a tile whose whole frontier
//! holds nothing a vertex still misses is passed over.

use super::graph::{Graph, for_each_bit};
#[cfg(target_arch = "x86_64")]
use super::lanes::x86::{Avx2, Avx512};
use super::lanes::{LANES, Lanes, Path, Portable, Vector};

/// Words of a tile: 64 cells, 32 pairs, 16 fours, 8 rows, the tile; the rest is padding.
const BLOCK: usize = 128;
const PAIRS: usize = 64;
const FOURS: usize = 96;
const ROWS: usize = 112;
const WHOLE: usize = 120;

/// Bits of a level counter: enough for every vertex number.
const PLANES: usize = 32;

/// The graph's rows as blocks of cells, made once for all waves.
pub(super) struct Relays<'a> {
    pub graph: &'a Graph,
    /// Blocks of each entry of the graph.
    count: Vec<u8>,
    /// First block of each rank's row.
    start: Vec<usize>,
    blocks: Vec<u8>,
    /// Component of each rank: its smallest rank.
    component: Vec<u32>,
}

impl<'a> Relays<'a> {
    pub fn new(graph: &'a Graph) -> Self {
        let n = graph.len();
        let mut new = Self {
            graph,
            count: Vec::with_capacity(graph.entry_tile.len()),
            start: Vec::with_capacity(n + 1),
            blocks: Vec::with_capacity(graph.entry_tile.len() * 6),
            component: graph.rank_components(),
        };
        // Cells that see nothing are never on a frontier, so blocks may cover them.
        let mut active = graph.tiles.occupied.clone();
        for (rank, &(tile, bit)) in graph.tiles.slot_of.iter().enumerate() {
            if graph.degree[rank] == 0 {
                active[tile as usize] &= !(1 << bit);
            }
        }
        for rank in 0..n {
            new.start.push(new.blocks.len());
            let (own_tile, own_bit) = graph.tiles.slot_of[rank];
            let (tiles, masks) = graph.row(rank);
            for (&t, &mask) in tiles.iter().zip(masks) {
                // A vertex never misses what it is itself the frontier of: it may read itself.
                let own = if t == own_tile { 1 << own_bit } else { 0 };
                let before = new.blocks.len();
                cover(mask | own | !active[t as usize], mask, &mut new.blocks);
                new.count.push((new.blocks.len() - before) as u8);
            }
        }
        new.start.push(new.blocks.len());
        new
    }
}

/// Fewest aligned blocks within `allowed` that cover `needed`.
fn cover(allowed: u64, needed: u64, blocks: &mut Vec<u8>) {
    if allowed == u64::MAX {
        blocks.push(WHOLE as u8);
        return;
    }
    // Bit k of each: block k of that size lies within `allowed`.
    let pairs = allowed & (allowed >> 1) & 0x5555_5555_5555_5555;
    let fours = pairs & (pairs >> 2) & 0x1111_1111_1111_1111;
    let rows = fours & (fours >> 4) & 0x0101_0101_0101_0101;
    let mut left = needed;
    while left != 0 {
        let bit = left.trailing_zeros();
        let (block, covered) = if rows >> (bit & !7) & 1 == 1 {
            (ROWS + bit as usize / 8, 0xffu64 << (bit & !7))
        } else if fours >> (bit & !3) & 1 == 1 {
            (FOURS + bit as usize / 4, 0xf << (bit & !3))
        } else if pairs >> (bit & !1) & 1 == 1 {
            (PAIRS + bit as usize / 2, 0x3 << (bit & !1))
        } else {
            (bit as usize, 1 << bit)
        };
        blocks.push(block as u8);
        left &= !covered;
    }
}

/// Buffers of one worker; every array is by rank or by tile.
pub(super) struct Wave<'a> {
    relays: &'a Relays<'a>,
    path: Path,
    /// Roots of its component that have not reached a rank yet.
    missing: Vec<Lanes>,
    /// Roots that reached a rank on the newest level; valid where `changed`.
    fresh: Vec<Lanes>,
    /// The newest level by tile and block; a tile without frontier has only its `WHOLE` word at 0.
    front: Vec<Lanes>,
    /// Cells with `fresh` words, by tile.
    changed: Vec<u64>,
    /// Cells that have been on a frontier.
    started: Vec<u64>,
    /// Cells beside one that has been, still incomplete.
    within_reach: Vec<u64>,
    /// Counts of the newest level, one bit plane each.
    planes: [Lanes; PLANES],
    /// Roots of each component, by smallest rank; 0 outside a walk.
    roots_of: Vec<Lanes>,
}

impl<'a> Wave<'a> {
    pub fn new(relays: &'a Relays<'a>, path: Path) -> Self {
        let (n, tiles) = (relays.graph.len(), relays.graph.tiles.count());
        Self {
            relays,
            path,
            missing: vec![Lanes::default(); n],
            fresh: vec![Lanes::default(); n],
            front: vec![Lanes::default(); tiles * BLOCK],
            changed: vec![0; tiles],
            started: vec![0; tiles],
            within_reach: vec![0; tiles],
            planes: [Lanes::default(); PLANES],
            roots_of: vec![Lanes::default(); n],
        }
    }

    /// Vertices on level 1, 2, … up to `max_level` of each root (ranks, at most [`LANES`]).
    pub fn levels(&mut self, roots: &[u32], max_level: u32) -> Vec<Vec<u32>> {
        let mut levels = vec![Vec::new(); roots.len()];
        self.begin(roots);
        for (list, &root) in levels.iter_mut().zip(roots) {
            let degree = self.relays.graph.degree[root as usize];
            if degree > 0 && max_level > 0 {
                list.push(degree);
            }
        }
        for _ in 1..max_level {
            self.grow_reach();
            if !self.step() {
                break;
            }
            for (lane, list) in levels.iter_mut().enumerate() {
                let count = self.count(lane);
                if count > 0 {
                    list.push(count);
                }
            }
        }
        levels
    }

    /// Level 1, straight from the rows of the roots.
    fn begin(&mut self, roots: &[u32]) {
        let relays = self.relays;
        for (lane, &root) in roots.iter().enumerate() {
            self.roots_of[relays.component[root as usize] as usize].set(lane);
        }
        for (missing, &c) in self.missing.iter_mut().zip(&relays.component) {
            *missing = self.roots_of[c as usize];
        }
        self.fresh.fill(Lanes::default());
        self.changed.fill(0);
        self.started.fill(0);
        self.within_reach.fill(0);
        self.front.chunks_exact_mut(BLOCK).for_each(|block| block[WHOLE] = Lanes::default());
        for (lane, &root) in roots.iter().enumerate() {
            self.roots_of[relays.component[root as usize] as usize] = Lanes::default();
            self.missing[root as usize].clear(lane);
            let (tiles, masks) = relays.graph.row(root as usize);
            for (&t, &mask) in tiles.iter().zip(masks) {
                self.changed[t as usize] |= mask;
                for_each_bit(mask, |bit| {
                    let rank = relays.graph.tiles.rank(t, bit);
                    self.fresh[rank].set(lane);
                    self.missing[rank].clear(lane);
                });
            }
        }
    }

    /// Cells beside those that are on a frontier for the first time come within reach.
    fn grow_reach(&mut self) {
        let graph = self.relays.graph;
        for t in 0..self.changed.len() {
            let first_time = self.changed[t] & !self.started[t];
            self.started[t] |= first_time;
            for_each_bit(first_time, |bit| {
                let (tiles, masks) = graph.row(graph.tiles.rank(t as u32, bit));
                for (&t, &mask) in tiles.iter().zip(masks) {
                    self.within_reach[t as usize] |= mask;
                }
            });
        }
    }

    fn count(&self, lane: usize) -> u32 {
        self.planes.iter().enumerate().map(|(p, plane)| (plane.get(lane) as u32) << p).sum()
    }

    /// One level on; whether any vertex was reached.
    fn step(&mut self) -> bool {
        match self.path {
            // SAFETY: a path is only made for a processor that has its instructions.
            #[cfg(target_arch = "x86_64")]
            #[allow(unsafe_code)]
            Path::Avx512 => unsafe { self.step_avx512() },
            #[cfg(target_arch = "x86_64")]
            #[allow(unsafe_code)]
            Path::Avx2 => unsafe { self.step_avx2() },
            Path::Portable => self.step_in::<Portable>(),
        }
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx512f,popcnt")]
    fn step_avx512(&mut self) -> bool {
        self.step_in::<Avx512>()
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,popcnt")]
    fn step_avx2(&mut self) -> bool {
        self.step_in::<Avx2>()
    }

    #[inline(always)]
    fn step_in<V: Vector>(&mut self) -> bool {
        self.publish::<V>();
        self.planes.fill(Lanes::default());
        let mut any = false;
        for t in 0..self.within_reach.len() {
            let mut bits = self.within_reach[t];
            let mut rank = self.relays.graph.tiles.first_rank[t] as usize;
            let occupied = self.relays.graph.tiles.occupied[t];
            let mut changed = 0u64;
            let first = rank;
            while bits != 0 {
                let bit = bits & bits.wrapping_neg();
                bits ^= bit;
                rank = first + (occupied & (bit - 1)).count_ones() as usize;
                let missing = V::load(&self.missing[rank]);
                let left = self.pull(rank, missing);
                let new = missing.without(left);
                if !new.is_zero() {
                    left.store(&mut self.missing[rank]);
                    new.store(&mut self.fresh[rank]);
                    self.tally(new);
                    changed |= bit;
                }
                if left.is_zero() {
                    self.within_reach[t] &= !bit;
                }
            }
            self.changed[t] = changed;
            any |= changed != 0;
        }
        any
    }

    /// What a rank still misses after reading all its neighbours.
    #[inline(always)]
    fn pull<V: Vector>(&self, rank: usize, missing: V) -> V {
        let graph = self.relays.graph;
        let mut left = missing;
        let mut at = self.relays.start[rank];
        for entry in graph.start[rank]..graph.start[rank + 1] {
            let count = self.relays.count[entry] as usize;
            let block = &self.front[graph.entry_tile[entry] as usize * BLOCK..][..BLOCK];
            if !V::load(&block[WHOLE]).and(left).is_zero() {
                for &b in &self.relays.blocks[at..at + count] {
                    left = left.without(V::load(&block[usize::from(b) & (BLOCK - 1)]));
                }
                if left.is_zero() {
                    break;
                }
            }
            at += count;
        }
        left
    }

    /// Adds one to the counter of every lane in `new`.
    #[inline(always)]
    fn tally<V: Vector>(&mut self, new: V) {
        let mut carry = new;
        for plane in &mut self.planes {
            let old = V::load(plane);
            old.xor(carry).store(plane);
            carry = carry.and(old);
            if carry.is_zero() {
                break;
            }
        }
    }

    /// Combines the fresh words into the blocks of their tiles.
    #[inline(always)]
    fn publish<V: Vector>(&mut self) {
        for t in 0..self.changed.len() {
            let block = &mut self.front[t * BLOCK..][..BLOCK];
            let changed = self.changed[t];
            if changed == 0 {
                block[WHOLE] = Lanes::default();
                continue;
            }
            let first = self.relays.graph.tiles.first_rank[t] as usize;
            let occupied = self.relays.graph.tiles.occupied[t];
            block[..PAIRS].fill(Lanes::default());
            let mut bits = changed;
            while bits != 0 {
                let bit = bits.trailing_zeros();
                bits &= bits - 1;
                let rank = first + (occupied & ((1u64 << bit) - 1)).count_ones() as usize;
                block[bit as usize] = self.fresh[rank];
            }
            combine::<V>(block, 0, PAIRS, 32);
            combine::<V>(block, PAIRS, FOURS, 16);
            combine::<V>(block, FOURS, ROWS, 8);
            let mut whole = V::load(&block[ROWS]);
            for row in 1..8 {
                whole = whole.or(V::load(&block[ROWS + row]));
            }
            whole.store(&mut block[WHOLE]);
        }
    }
}

/// `to[i] = from[2i] | from[2i + 1]`.
#[inline(always)]
fn combine<V: Vector>(block: &mut [Lanes], from: usize, to: usize, count: usize) {
    for i in 0..count {
        let both = V::load(&block[from + 2 * i]).or(V::load(&block[from + 2 * i + 1]));
        both.store(&mut block[to + i]);
    }
}

/// Roots walked at once.
pub(super) const BATCH: usize = LANES;

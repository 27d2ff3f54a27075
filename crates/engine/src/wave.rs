//! Breadth-first waves from 512 roots at once: stages "frontier" and "levels".
//!
//! A vertex that some roots have not reached pulls the frontier words of its neighbours, block by block
//! (see [`Relays`]). The words of a tile are combined into blocks, and its new bits counted, as soon
//! as the tile has been walked.

#[cfg(target_arch = "x86_64")]
use super::lanes::x86::{Avx2, Avx512};
use super::lanes::{LANES, Lanes, Path, Portable, Vector, transpose};
use super::relays::{BLOCK, FOURS, PAIRS, ROWS, Relays, WHOLE};

/// Bits of a level counter: enough for every vertex number.
const PLANES: usize = 32;

/// Bits that count the cells of one tile.
const TILE_PLANES: usize = 7;

/// Buffers of one worker; every array is by rank or by tile.
pub(super) struct Wave<'a> {
    relays: &'a Relays<'a>,
    path: Path,
    /// Roots of its component that have not reached a rank yet.
    missing: Vec<Lanes>,
    /// Roots that reached a block of cells on the newest level, by block number.
    front: Vec<Lanes>,
    /// The level in the making.
    next: Vec<Lanes>,
    /// Cells with a word that is not 0 in `front`, by tile; a tile without any holds only zeros.
    changed: Vec<u64>,
    next_changed: Vec<u64>,
    /// Cells that have been on a frontier.
    started: Vec<u64>,
    /// Cells beside one that has been, still incomplete.
    within_reach: Vec<u64>,
    /// Counts of the newest level, one bit plane each, and as numbers.
    planes: [Lanes; PLANES],
    counts: [u32; LANES],
    /// Roots of each component, by smallest rank; 0 outside a walk.
    roots_of: Vec<Lanes>,
    /// Rows of 64 roots by tile, in the order the tiles were met.
    rows: Vec<[u64; 64]>,
    met: Vec<u32>,
    met_at: Vec<u32>,
}

impl<'a> Wave<'a> {
    pub fn new(relays: &'a Relays<'a>, path: Path) -> Self {
        let (n, tiles) = (relays.graph.len(), relays.graph.tiles.count());
        Self {
            relays,
            path,
            missing: vec![Lanes::default(); n],
            front: vec![Lanes::default(); tiles * BLOCK],
            next: vec![Lanes::default(); tiles * BLOCK],
            changed: vec![0; tiles],
            next_changed: vec![0; tiles],
            started: vec![0; tiles],
            within_reach: vec![0; tiles],
            planes: [Lanes::default(); PLANES],
            counts: [0; LANES],
            roots_of: vec![Lanes::default(); n],
            rows: Vec::new(),
            met: Vec::new(),
            met_at: vec![u32::MAX; tiles],
        }
    }

    /// Vertices on level 1, 2, … up to `max_level` of each root (distinct ranks, at most [`LANES`]).
    pub fn levels(&mut self, roots: &[u32], max_level: u32) -> Vec<Vec<u32>> {
        match self.path {
            // SAFETY: a path is only made for a processor that has its instructions.
            #[cfg(target_arch = "x86_64")]
            #[allow(unsafe_code)]
            Path::Avx512 => unsafe { self.levels_avx512(roots, max_level) },
            #[cfg(target_arch = "x86_64")]
            #[allow(unsafe_code)]
            Path::Avx2 => unsafe { self.levels_avx2(roots, max_level) },
            Path::Portable => self.levels_in::<Portable>(roots, max_level),
        }
    }

    /// For every rank, how many of the roots reach it on level 1, 2, …: added to `levels`, which grows.
    pub fn levels_by_rank(&mut self, roots: &[u32], levels: &mut Vec<Vec<u32>>) {
        match self.path {
            // SAFETY: as above.
            #[cfg(target_arch = "x86_64")]
            #[allow(unsafe_code)]
            Path::Avx512 => unsafe { self.levels_by_rank_avx512(roots, levels) },
            #[cfg(target_arch = "x86_64")]
            #[allow(unsafe_code)]
            Path::Avx2 => unsafe { self.levels_by_rank_avx2(roots, levels) },
            Path::Portable => self.levels_by_rank_in::<Portable>(roots, levels),
        }
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx512f,avx512dq,avx2,popcnt,bmi1,bmi2")]
    fn levels_avx512(&mut self, roots: &[u32], max_level: u32) -> Vec<Vec<u32>> {
        self.levels_in::<Avx512>(roots, max_level)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,popcnt,bmi1,bmi2")]
    fn levels_avx2(&mut self, roots: &[u32], max_level: u32) -> Vec<Vec<u32>> {
        self.levels_in::<Avx2>(roots, max_level)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx512f,avx512dq,avx2,popcnt,bmi1,bmi2")]
    fn levels_by_rank_avx512(&mut self, roots: &[u32], levels: &mut Vec<Vec<u32>>) {
        self.levels_by_rank_in::<Avx512>(roots, levels);
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,popcnt,bmi1,bmi2")]
    fn levels_by_rank_avx2(&mut self, roots: &[u32], levels: &mut Vec<Vec<u32>>) {
        self.levels_by_rank_in::<Avx2>(roots, levels);
    }

    // From here on plain loops, no closures: they are compiled for the caller's instruction set.
    #[inline(always)]
    fn levels_in<V: Vector>(&mut self, roots: &[u32], max_level: u32) -> Vec<Vec<u32>> {
        let mut levels = vec![Vec::new(); roots.len()];
        self.begin(roots);
        for level in 1..=max_level {
            let any = if level == 1 { self.settle::<V>() } else { self.step::<V>() };
            if !any {
                break;
            }
            number_planes(&self.planes, &mut self.counts);
            for (list, &count) in levels.iter_mut().zip(&self.counts) {
                if count > 0 {
                    list.push(count);
                }
            }
            if level < max_level {
                self.grow_reach();
            }
        }
        levels
    }

    #[inline(always)]
    fn levels_by_rank_in<V: Vector>(&mut self, roots: &[u32], levels: &mut Vec<Vec<u32>>) {
        self.begin(roots);
        for level in 0.. {
            let any = if level == 0 { self.settle::<V>() } else { self.step::<V>() };
            if !any {
                break;
            }
            if levels.len() == level {
                levels.push(vec![0; self.relays.graph.len()]);
            }
            for t in 0..self.changed.len() {
                let mut bits = self.changed[t];
                while bits != 0 {
                    let bit = bits.trailing_zeros();
                    bits &= bits - 1;
                    let mut count = 0;
                    for word in self.front[t * BLOCK + bit as usize].0 {
                        count += word.count_ones();
                    }
                    levels[level][self.relays.graph.tiles.rank(t as u32, bit)] += count;
                }
            }
            self.grow_reach();
        }
    }

    /// Level 1, straight from the rows of the roots, into the cells of `front`.
    #[inline(always)]
    fn begin(&mut self, roots: &[u32]) {
        let relays = self.relays;
        for (lane, &root) in roots.iter().enumerate() {
            self.roots_of[relays.component[root as usize] as usize].set(lane);
        }
        for (missing, &c) in self.missing.iter_mut().zip(&relays.component) {
            *missing = self.roots_of[c as usize];
        }
        for (lane, &root) in roots.iter().enumerate() {
            self.roots_of[relays.component[root as usize] as usize] = Lanes::default();
            self.missing[root as usize].clear(lane);
        }
        for t in 0..self.changed.len() {
            for (front, changed) in
                [(&mut self.front, &mut self.changed), (&mut self.next, &mut self.next_changed)]
            {
                if changed[t] != 0 {
                    changed[t] = 0;
                    front[t * BLOCK..][..BLOCK].fill(Lanes::default());
                }
            }
        }
        self.started.fill(0);
        self.within_reach.fill(0);
        for (word, roots) in roots.chunks(64).enumerate() {
            self.begin_word(word, roots);
        }
    }

    /// The rows of 64 roots, turned into words of what they see.
    #[inline(always)]
    fn begin_word(&mut self, word: usize, roots: &[u32]) {
        let graph = self.relays.graph;
        for (lane, &root) in roots.iter().enumerate() {
            let (tiles, masks) = graph.row(root as usize);
            for (&t, &mask) in tiles.iter().zip(masks) {
                let at = &mut self.met_at[t as usize];
                if *at == u32::MAX {
                    *at = self.met.len() as u32;
                    self.met.push(t);
                    if self.rows.len() < self.met.len() {
                        self.rows.push([0; 64]);
                    }
                }
                self.rows[*at as usize][lane] = mask;
                self.changed[t as usize] |= mask;
            }
        }
        for (at, &t) in self.met.iter().enumerate() {
            self.met_at[t as usize] = u32::MAX;
            transpose(&mut self.rows[at]);
            for (cell, lanes) in self.front[t as usize * BLOCK..][..PAIRS].iter_mut().zip(self.rows[at]) {
                cell.0[word] = lanes;
            }
            self.rows[at] = [0; 64];
        }
        self.met.clear();
    }

    /// Cells beside those that are on a frontier for the first time come within reach.
    #[inline(always)]
    fn grow_reach(&mut self) {
        let graph = self.relays.graph;
        for t in 0..self.changed.len() {
            let mut first_time = self.changed[t] & !self.started[t];
            self.started[t] |= first_time;
            while first_time != 0 {
                let bit = first_time.trailing_zeros();
                first_time &= first_time - 1;
                let (tiles, masks) = graph.row(graph.tiles.rank(t as u32, bit));
                for (&t, &mask) in tiles.iter().zip(masks) {
                    self.within_reach[t as usize] |= mask;
                }
            }
        }
    }

    /// Completes level 1 from the cells of `front`; whether any vertex was reached.
    #[inline(always)]
    fn settle<V: Vector>(&mut self) -> bool {
        self.planes.fill(Lanes::default());
        let tiles = &self.relays.graph.tiles;
        let mut any = false;
        for t in 0..self.changed.len() {
            let mut bits = self.changed[t];
            if bits == 0 {
                continue;
            }
            any = true;
            let block = &mut self.front[t * BLOCK..][..BLOCK];
            while bits != 0 {
                let bit = bits.trailing_zeros();
                bits &= bits - 1;
                let missing = &mut self.missing[tiles.rank(t as u32, bit)];
                V::load(missing).without(V::load(&block[bit as usize])).store(missing);
            }
            count_cells::<V>(block, &mut self.planes);
            combine_cells::<V>(block);
        }
        any
    }

    /// One level on; whether any vertex was reached.
    #[inline(always)]
    fn step<V: Vector>(&mut self) -> bool {
        self.planes.fill(Lanes::default());
        let mut any = false;
        for t in 0..self.within_reach.len() {
            let changed = if self.within_reach[t] == 0 { 0 } else { self.walk_tile::<V>(t) };
            let block = &mut self.next[t * BLOCK..][..BLOCK];
            if changed != 0 {
                let mut stale = self.next_changed[t] & !changed;
                while stale != 0 {
                    block[stale.trailing_zeros() as usize] = Lanes::default();
                    stale &= stale - 1;
                }
                count_cells::<V>(block, &mut self.planes);
                combine_cells::<V>(block);
                any = true;
            } else if self.next_changed[t] != 0 {
                block.fill(Lanes::default());
            }
            self.next_changed[t] = changed;
        }
        std::mem::swap(&mut self.front, &mut self.next);
        std::mem::swap(&mut self.changed, &mut self.next_changed);
        any
    }

    /// Pulls for all cells of a tile that are within reach; the cells that were reached.
    #[inline(always)]
    fn walk_tile<V: Vector>(&mut self, t: usize) -> u64 {
        let relays = self.relays;
        let tiles = &relays.graph.tiles;
        let (first, occupied) = (tiles.first_rank[t] as usize, tiles.occupied[t]);
        let next = &mut self.next[t * BLOCK..][..BLOCK];
        let groups = relays.first_group[t] as usize..relays.first_group[t + 1] as usize;
        let mut at = if groups.start == 0 { 0 } else { relays.groups[groups.start - 1].end as usize };
        let mut changed = 0;
        let mut complete = 0;
        for group in &relays.groups[groups] {
            let shared = &relays.shared[at..group.end as usize];
            at = group.end as usize;
            let mut bits = group.members & self.within_reach[t];
            if bits == 0 {
                continue;
            }
            let reached = gather::<V>(&self.front, shared, V::zero());
            while bits != 0 {
                let bit = bits & bits.wrapping_neg();
                bits ^= bit;
                let rank = first + (occupied & (bit - 1)).count_ones() as usize;
                let own = &relays.own[relays.own_start[rank] as usize..relays.own_start[rank + 1] as usize];
                let missing = V::load(&self.missing[rank]);
                let new = gather::<V>(&self.front, own, reached).and(missing);
                let left = missing.without(new);
                if !new.is_zero() {
                    left.store(&mut self.missing[rank]);
                    new.store(&mut next[bit.trailing_zeros() as usize & 63]);
                    changed |= bit;
                }
                if left.is_zero() {
                    complete |= bit;
                }
            }
        }
        self.within_reach[t] &= !complete;
        changed
    }
}

/// The union of some blocks and `sum`.
#[inline(always)]
fn gather<V: Vector>(front: &[Lanes], blocks: &[u32], sum: V) -> V {
    let (mut a, mut b) = (sum, V::zero());
    let mut pairs = blocks.chunks_exact(2);
    for pair in &mut pairs {
        a = a.or(V::load(&front[pair[0] as usize]));
        b = b.or(V::load(&front[pair[1] as usize]));
    }
    for &last in pairs.remainder() {
        a = a.or(V::load(&front[last as usize]));
    }
    a.or(b)
}

/// Combines the words of a tile's cells into those of its larger blocks.
#[inline(always)]
fn combine_cells<V: Vector>(block: &mut [Lanes]) {
    combine::<V>(block, 0, PAIRS, 32);
    combine::<V>(block, PAIRS, FOURS, 16);
    combine::<V>(block, FOURS, ROWS, 8);
    let mut whole = V::load(&block[ROWS]);
    for row in 1..8 {
        whole = whole.or(V::load(&block[ROWS + row]));
    }
    whole.store(&mut block[WHOLE]);
}

/// `to[i] = from[2i] | from[2i + 1]`.
#[inline(always)]
fn combine<V: Vector>(block: &mut [Lanes], from: usize, to: usize, count: usize) {
    for i in 0..count {
        let both = V::load(&block[from + 2 * i]).or(V::load(&block[from + 2 * i + 1]));
        both.store(&mut block[to + i]);
    }
}

/// Bit planes as numbers. Plain loops: they are compiled for the caller's instruction set.
#[inline(always)]
fn number_planes(planes: &[Lanes; PLANES], counts: &mut [u32; LANES]) {
    counts.fill(0);
    for (p, plane) in planes.iter().enumerate() {
        for (word, counts) in plane.0.iter().zip(counts.as_chunks_mut::<64>().0) {
            if *word == 0 {
                continue;
            }
            let (low, high) = counts.split_at_mut(32);
            for (half, counts) in [*word as u32, (*word >> 32) as u32].into_iter().zip([low, high]) {
                for (bit, count) in counts.iter_mut().enumerate() {
                    *count |= (half >> bit & 1) << p;
                }
            }
        }
    }
}

/// Adds, for every lane, the number of cells whose word has it to the counters.
#[inline(always)]
fn count_cells<V: Vector>(block: &[Lanes], planes: &mut [Lanes; PLANES]) {
    let mut tile = [V::zero(); TILE_PLANES];
    for row in block[..PAIRS].chunks_exact(8) {
        let cell = |i: usize| V::load(&row[i]);
        let (a, ones) = tile[0].add(cell(0), cell(1));
        let (b, ones) = ones.add(cell(2), cell(3));
        let (c, ones) = ones.add(cell(4), cell(5));
        let (d, ones) = ones.add(cell(6), cell(7));
        let (e, twos) = tile[1].add(a, b);
        let (f, twos) = twos.add(c, d);
        let (mut carry, fours) = tile[2].add(e, f);
        tile[0] = ones;
        tile[1] = twos;
        tile[2] = fours;
        for plane in &mut tile[3..] {
            (carry, *plane) = (plane.and(carry), plane.xor(carry));
        }
    }
    let mut carry = V::zero();
    for (i, plane) in planes.iter_mut().enumerate() {
        if i >= TILE_PLANES && carry.is_zero() {
            break;
        }
        let digit = if i < TILE_PLANES { tile[i] } else { V::zero() };
        let (over, sum) = V::load(plane).add(digit, carry);
        sum.store(plane);
        carry = over;
    }
}

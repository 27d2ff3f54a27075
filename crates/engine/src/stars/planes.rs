//! Words of lanes, and which cells have them.

use super::super::lanes::Vector;

/// Roots of a word.
pub const WORD: usize = 64;

/// One bit for each root of a star.
pub type Word<const W: usize> = [u64; W];

/// Words of a star, each once.
pub struct Words<const W: usize> {
    pub all: Vec<Word<W>>,
    /// Numbers by hash, [`UNSET`] where there is none; a power of two, at least twice as many as words.
    table: Vec<u32>,
}

/// The number of the word without any lane.
pub const ZERO: u32 = 0;

/// No word yet.
pub const UNSET: u32 = u32::MAX;

/// Several words.
pub const MIXED: u32 = u32::MAX - 1;

impl<const W: usize> Words<W> {
    pub fn new() -> Self {
        Self { all: Vec::new(), table: vec![UNSET; 1024] }
    }

    pub fn clear(&mut self) {
        self.all.clear();
        self.table.fill(UNSET);
        self.number(&[0; W]);
    }

    #[inline(always)]
    fn place(&self, word: &Word<W>) -> usize {
        let mut hash = 0u64;
        for part in word {
            hash = (hash.rotate_left(29) ^ part).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        }
        let mut at = (hash >> 32) as usize & (self.table.len() - 1);
        while self.table[at] != UNSET && self.all[self.table[at] as usize] != *word {
            at = (at + 1) & (self.table.len() - 1);
        }
        at
    }

    #[inline(always)]
    pub fn number(&mut self, word: &Word<W>) -> u32 {
        let at = self.place(word);
        if self.table[at] == UNSET {
            self.table[at] = self.all.len() as u32;
            self.all.push(*word);
            if self.all.len() * 2 > self.table.len() {
                self.grow();
            }
            return self.all.len() as u32 - 1;
        }
        self.table[at]
    }

    #[cold]
    fn grow(&mut self) {
        self.table = vec![UNSET; self.table.len() * 2];
        for i in 0..self.all.len() {
            let at = self.place(&self.all[i]);
            self.table[at] = i as u32;
        }
    }
}

/// Words of the cells of a group: one, or one each for some parts of it.
#[derive(Clone, Copy, Default)]
pub struct Held {
    pub first: u32,
    pub end: u32,
    pub word: u32,
}

/// One plane of a star.
#[derive(Default)]
pub struct Plane<const W: usize> {
    pub held: Vec<Held>,
    /// By group, the lanes of all its cells and of any; one entry more, for no group.
    pub sums: Vec<[Word<W>; 2]>,
    /// Cells and word.
    pub parts: Vec<(u64, u32)>,
    /// Cells that have each lane's bit, level by level.
    pub counts: Vec<u32>,
}

impl<const W: usize> Plane<W> {
    pub fn clear(&mut self, groups: usize, levels: usize) {
        self.held.resize(groups, Held::default());
        self.sums.resize(groups + 1, [[0; W]; 2]);
        self.sums[groups] = [[u64::MAX; W], [0; W]];
        self.parts.clear();
        self.counts.clear();
        self.counts.resize(levels * WORD * W, 0);
    }

    /// The parts of a group, if it has more than one word.
    #[inline(always)]
    pub fn parts_of(&self, group: usize) -> &[(u64, u32)] {
        let held = self.held[group];
        &self.parts[held.first as usize..held.end as usize]
    }
}

/// Lanes in a tile: their cells, and the first of their lanes.
#[derive(Clone, Copy, Default)]
pub struct LanesIn {
    pub cells: u64,
    pub first: u32,
}

impl LanesIn {
    /// Sets the lanes of some cells in a word.
    #[inline(always)]
    pub fn set<V: Vector, const W: usize>(self, cells: u64, word: &mut Word<W>) {
        let lanes = V::gather(cells, self.cells);
        let (at, by) = (self.first as usize / WORD, self.first % WORD as u32);
        word[at] |= lanes << by;
        if by != 0 && at + 1 < W {
            word[at + 1] |= lanes >> (WORD as u32 - by);
        }
    }
}

#[inline(always)]
pub fn is_within<const W: usize>(a: &Word<W>, b: &Word<W>) -> bool {
    let mut outside = 0;
    for i in 0..W {
        outside |= a[i] & !b[i];
    }
    outside == 0
}

/// Adds a number of cells to the counters of the lanes of their word; a negative one takes them off.
#[inline(always)]
pub fn add<const W: usize>(counts: &mut [u32], word: &Word<W>, cells: u32) {
    if cells == 0 || *word == [0; W] {
        return;
    }
    for (word, counts) in word.iter().zip(counts.as_chunks_mut::<WORD>().0) {
        let (low, high) = counts.split_at_mut(WORD / 2);
        for (half, counts) in [*word as u32, (*word >> 32) as u32].into_iter().zip([low, high]) {
            for (bit, count) in counts.iter_mut().enumerate() {
                *count = count.wrapping_add(cells & (half >> bit & 1).wrapping_neg());
            }
        }
    }
}

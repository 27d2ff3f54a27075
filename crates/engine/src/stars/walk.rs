//! The walk of one star.

#[cfg(target_arch = "x86_64")]
use super::super::lanes::x86::{Avx2, Avx512};
use super::super::lanes::{Path, Portable, Vector};
use super::Sky;
use super::levels::{Head, Levels, Order};
use super::plan::Star;
use super::planes::{Held, LanesIn, MIXED, Plane, UNSET, WORD, Word, Words, ZERO, add, is_within};

/// The planes of a star, in the order they are made.
const NEARER: usize = 0;
const WITHIN: usize = 1;

/// Buffers of one worker.
pub struct Walk<'a, const W: usize> {
    sky: &'a Sky<'a>,
    levels: Levels,
    order: Order,
    words: Words<W>,
    planes: [Plane<W>; 2],
    /// By tile, the only word of each plane so far, [`UNSET`] or [`MIXED`].
    only: Vec<[u32; 2]>,
    /// Tiles that do not rest, in each plane.
    awake: Vec<[bool; 2]>,
    /// Groups of the level that are still to be met in the second plane.
    later: Vec<(u32, u32)>,
    /// Tiles that the first plane woke after they had rested on the level.
    roused: Vec<u32>,
    lanes: Vec<LanesIn>,
    scratch: Scratch<W>,
}

/// Buffers of one group.
#[derive(Default)]
struct Scratch<const W: usize> {
    /// Tiles seen, and groups of theirs, that may bring a lane; whether of the plane in the making.
    sources: Vec<(u32, u32, bool)>,
    /// Words that only some cells get.
    found: Vec<(u64, u32)>,
    /// When each word was met last, and where in `found` it is.
    met: Vec<(u32, u32)>,
    now: u32,
    pieces: Vec<(u64, Word<W>)>,
    parts: Vec<(u64, u32)>,
}

/// Cells that have one word.
#[derive(Clone, Copy)]
struct Run {
    word: u32,
    cells: u32,
}

impl Default for Run {
    fn default() -> Self {
        Self { word: ZERO, cells: 0 }
    }
}

/// A word all of whose lanes all cells have.
const EVERYWHERE: u32 = u32::MAX;

impl<'a, const W: usize> Walk<'a, W> {
    pub fn new(sky: &'a Sky<'a>) -> Self {
        let tiles = sky.graph.tiles.count();
        let most = (0..tiles).map(|t| sky.sight.of(t).len()).max().unwrap_or(0);
        Self {
            sky,
            levels: Levels::default(),
            order: Order::default(),
            words: Words::new(),
            planes: [Plane::default(), Plane::default()],
            only: vec![[UNSET; 2]; tiles],
            awake: vec![[false; 2]; tiles],
            later: Vec::new(),
            roused: Vec::new(),
            lanes: vec![LanesIn::default(); tiles],
            scratch: Scratch { sources: vec![(0, 0, false); 2 * most + 2], ..Scratch::default() },
        }
    }

    pub fn star(&mut self, star: &Star, levels: Levels) {
        self.levels = levels;
        self.order.fill(&self.levels);
        self.words.clear();
        self.scratch.met.clear();
        self.scratch.now = 0;
        self.only.fill([UNSET; 2]);
        self.awake.fill([false; 2]);
        let tile_of = |rank: u32| self.sky.graph.tiles.slot_of[rank as usize];
        for (lane, &rank) in (0u32..).zip(&star.lanes) {
            let (tile, bit) = tile_of(rank);
            let lanes = &mut self.lanes[tile as usize];
            if lanes.cells == 0 {
                lanes.first = lane;
            }
            lanes.cells |= 1 << bit;
            self.awake[tile as usize] = [true; 2];
        }
        for plane in &mut self.planes {
            plane.clear(self.levels.cells.len(), self.order.totals.len());
        }
        match self.sky.path {
            // SAFETY: a path is only made for a processor that has its instructions.
            #[cfg(target_arch = "x86_64")]
            #[allow(unsafe_code)]
            Path::Avx512 => unsafe { self.walk_avx512() },
            #[cfg(target_arch = "x86_64")]
            #[allow(unsafe_code)]
            Path::Avx2 => unsafe { self.walk_avx2() },
            Path::Portable => self.walk_in::<Portable>(),
        }
        for &rank in &star.lanes {
            self.lanes[self.sky.graph.tiles.slot_of[rank as usize].0 as usize].cells = 0;
        }
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx512f,avx512dq,avx2,popcnt,bmi1,bmi2")]
    fn walk_avx512(&mut self) {
        self.walk_in::<Avx512>();
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,popcnt,bmi1,bmi2")]
    fn walk_avx2(&mut self) {
        self.walk_in::<Avx2>();
    }

    // From here on plain loops, no closures: they are compiled for the caller's instruction set.
    #[inline(always)]
    fn walk_in<V: Vector>(&mut self) {
        for level in 0..self.order.totals.len() as u32 {
            let mut runs = [Run::default(); 2];
            self.later.clear();
            self.roused.clear();
            for i in self.order.start[level as usize]..self.order.start[level as usize + 1] {
                let (tile, group) = self.order.groups[i as usize];
                let (t, g) = (tile as usize, group as usize);
                self.look(t);
                if self.awake[t][NEARER] {
                    self.meet::<V, NEARER>(t, g, level);
                } else {
                    self.rest::<NEARER>(t, g);
                }
                self.count::<NEARER>(g, level, &mut runs[NEARER]);
                if self.awake[t][WITHIN] {
                    self.later.push((tile, group));
                } else {
                    self.rest::<WITHIN>(t, g);
                    self.count::<WITHIN>(g, level, &mut runs[WITHIN]);
                }
            }
            self.recall(level);
            for i in 0..self.later.len() {
                let (tile, group) = self.later[i];
                self.meet::<V, WITHIN>(tile as usize, group as usize, level);
                self.count::<WITHIN>(group as usize, level, &mut runs[WITHIN]);
            }
            self.add::<NEARER>(level, runs[NEARER]);
            self.add::<WITHIN>(level, runs[WITHIN]);
        }
    }

    /// Whether a tile that is reached first may rest: where all that it sees have one word.
    #[inline(always)]
    fn look(&mut self, t: usize) {
        let is_new = |p: usize| !self.awake[t][p] && self.only[t][p] == UNSET;
        let new = [is_new(NEARER), is_new(WITHIN)];
        if new == [false; 2] {
            return;
        }
        let words = self.only_words(t);
        for p in [NEARER, WITHIN] {
            if new[p] {
                self.only[t][p] = words[p];
                self.awake[t][p] = words[p] == UNSET;
            }
        }
        if self.awake[t][NEARER] && new[NEARER] && !self.awake[t][WITHIN] {
            self.awake[t][WITHIN] = true;
            self.only[t][WITHIN] = UNSET;
        }
    }

    /// Of each plane the one word that all tiles which a tile sees have, or [`UNSET`].
    #[inline(always)]
    fn only_words(&self, t: usize) -> [u32; 2] {
        let (mut only, mut is_one) = ([UNSET; 2], [true; 2]);
        for &near in self.sky.sight.of(t) {
            let words = self.only[near as usize];
            for p in [NEARER, WITHIN] {
                let word = words[p];
                is_one[p] &= (word == UNSET) | (only[p] == UNSET) | (word == only[p]);
                only[p] = std::hint::select_unpredictable(word == UNSET, only[p], word);
            }
        }
        for p in [NEARER, WITHIN] {
            if !is_one[p] || only[p] == MIXED {
                only[p] = UNSET;
            }
        }
        only
    }

    #[inline(always)]
    fn rest<const P: usize>(&mut self, t: usize, g: usize) {
        let word = self.only[t][P];
        let plane = &mut self.planes[P];
        plane.held[g] = Held { first: 0, end: 0, word };
        plane.sums[g] = [self.words.all[word as usize]; 2];
    }

    /// What rested in the second plane before the first woke it: not counted, and met later.
    #[inline(always)]
    fn recall(&mut self, level: u32) {
        let none = self.levels.cells.len();
        for i in 0..self.roused.len() {
            let tile = self.roused[i];
            let g = self.levels.tiles[tile as usize].group(level, none);
            if g != none {
                let (word, cells) = (self.planes[WITHIN].held[g].word, self.levels.cells[g].count_ones());
                self.add::<WITHIN>(level, Run { word, cells: cells.wrapping_neg() });
                self.later.push((tile, g as u32));
            }
        }
    }

    /// Counts the cells of a group with those before it: neighbours mostly have the same word.
    #[inline(always)]
    fn count<const P: usize>(&mut self, g: usize, level: u32, run: &mut Run) {
        let held = self.planes[P].held[g];
        if held.first == held.end {
            return self.extend::<P>(level, run, self.levels.cells[g], held.word);
        }
        for i in held.first..held.end {
            let (cells, word) = self.planes[P].parts[i as usize];
            self.extend::<P>(level, run, cells, word);
        }
    }

    #[inline(always)]
    fn extend<const P: usize>(&mut self, level: u32, run: &mut Run, cells: u64, word: u32) {
        if word != run.word {
            self.add::<P>(level, *run);
            *run = Run { word, cells: 0 };
        }
        run.cells += cells.count_ones();
    }

    #[inline(always)]
    fn add<const P: usize>(&mut self, level: u32, run: Run) {
        let counts = &mut self.planes[P].counts[level as usize * WORD * W..][..WORD * W];
        add(counts, &self.words.all[run.word as usize], run.cells);
    }

    /// The words of a group, from all that it sees.
    #[inline(always)]
    fn meet<V: Vector, const P: usize>(&mut self, t: usize, g: usize, level: u32) {
        // One more than the steps from the lanes in question.
        let steps = level + P as u32;
        if steps <= 2 {
            self.meet_lanes::<V>(t, self.levels.cells[g], steps);
        } else {
            let base = self.gather::<V, P>(t, g, level);
            if self.scratch.found.is_empty() {
                let word = self.words.number(&base);
                return self.settle::<P>(t, g, word);
            }
            self.split(self.levels.cells[g], base);
        }
        self.unite();
        if let [(_, word)] = self.scratch.parts[..] {
            return self.settle::<P>(t, g, word);
        }
        let plane = &mut self.planes[P];
        let first = plane.parts.len() as u32;
        plane.parts.extend_from_slice(&self.scratch.parts);
        plane.held[g] = Held { first, end: plane.parts.len() as u32, word: MIXED };
        let mut sums = [[u64::MAX; W], [0; W]];
        for &(_, word) in &self.scratch.parts {
            let word = &self.words.all[word as usize];
            for i in 0..W {
                sums[0][i] &= word[i];
                sums[1][i] |= word[i];
            }
        }
        plane.sums[g] = sums;
        self.mix::<P>(t);
    }

    /// The words of cells at no step from a lane, or at most one.
    #[inline(always)]
    fn meet_lanes<V: Vector>(&mut self, t: usize, group: u64, steps: u32) {
        let pieces = &mut self.scratch.pieces;
        pieces.clear();
        let mut left = group;
        while left != 0 {
            let cell = left & left.wrapping_neg();
            left ^= cell;
            let mut word = [0; W];
            if steps >= 1 {
                self.lanes[t].set::<V, W>(cell, &mut word);
            }
            pieces.push((cell, word));
        }
        if steps < 2 {
            return;
        }
        for (&tile, near) in self.sky.sight.of(t).iter().zip(self.sky.sight.near(t)) {
            let lanes = self.lanes[tile as usize];
            if lanes.cells & near.any == 0 {
                continue;
            }
            let (seeing, seen) = self.sky.sight.views(near);
            for (cell, word) in &mut *pieces {
                let seen = if near.sees_all() { lanes.cells } else { V::union_by(seen, seeing, *cell) };
                lanes.set::<V, W>(seen, word);
            }
        }
    }

    /// The lanes that come to all cells of a group, and in `found` the words that come to some.
    #[inline(always)]
    fn gather<V: Vector, const P: usize>(&mut self, t: usize, g: usize, level: u32) -> Word<W> {
        let Self { sky, levels, words, planes: [nearer, within], scratch, .. } = self;
        let own = if P == NEARER { &*nearer } else { &*within };
        let (group, none) = (levels.cells[g], levels.cells.len());
        let (mut base, mut any) = ([u64::MAX; W], [0; W]);
        // Without a branch, as nobody can tell which tiles have groups.
        let mut there = 0;
        for (i, &near) in (0u32..).zip(sky.sight.of(t)) {
            let head = levels.tiles[near as usize];
            let before = head.group(level - 1, none);
            scratch.sources[there] = (i, before as u32, true);
            there += usize::from(before != none);
            let [all, some] = &own.sums[before];
            for i in 0..W {
                base[i] &= all[i];
                any[i] |= some[i];
            }
            if P == WITHIN {
                let beside = head.group(level, none);
                scratch.sources[there] = (i, beside as u32, false);
                there += usize::from(beside != none);
                let [_, some] = &nearer.sums[beside];
                for i in 0..W {
                    any[i] |= some[i];
                }
            }
        }
        scratch.found.clear();
        if is_within(&any, &base) {
            return base;
        }
        // Again without a branch: which bring more.
        let mut count = 0;
        for at in 0..there {
            let (i, from, is_own) = scratch.sources[at];
            scratch.sources[count] = (i, from, is_own);
            let [_, some] = if is_own { &own.sums[from as usize] } else { &nearer.sums[from as usize] };
            count += usize::from(!is_within(some, &base));
        }
        scratch.met.resize(words.all.len(), (0, 0));
        scratch.now += 1;
        let Scratch { sources, found, met, now, .. } = scratch;
        for &(i, from, is_own) in &sources[..count] {
            let near = &sky.sight.near(t)[i as usize];
            let plane = if is_own { own } else { &*nearer };
            let whole = [(levels.cells[from as usize], plane.held[from as usize].word)];
            let parts = plane.parts_of(from as usize);
            for &(cells, number) in if parts.is_empty() { &whole } else { parts } {
                let before = &mut met[number as usize];
                let is_new = before.0 != *now;
                if before.1 == EVERYWHERE && !is_new || cells & near.any == 0 {
                    continue;
                }
                let word = &words.all[number as usize];
                if is_new && is_within(word, &base) {
                    *before = (*now, EVERYWHERE);
                    continue;
                }
                let mut by = group;
                if !near.sees_all() {
                    let (seeing, seen) = sky.sight.views(near);
                    by &= V::union_by(seeing, seen, cells);
                }
                if by == 0 {
                    continue;
                }
                if is_new {
                    *before = (*now, found.len() as u32);
                    found.push((0, number));
                }
                let found = &mut found[before.1 as usize].0;
                *found |= by;
                if *found == group {
                    before.1 = EVERYWHERE;
                    for i in 0..W {
                        base[i] |= word[i];
                    }
                }
            }
            if is_within(&any, &base) {
                found.clear();
                return base;
            }
        }
        // Most words are everywhere in the end.
        let mut left = 0;
        for i in 0..found.len() {
            found[left] = found[i];
            left += usize::from(!is_within(&words.all[found[i].1 as usize], &base));
        }
        found.truncate(left);
        base
    }

    /// Parts the cells of a group by the words in `found`.
    #[inline(always)]
    fn split(&mut self, group: u64, base: Word<W>) {
        let Scratch { found, pieces, .. } = &mut self.scratch;
        pieces.clear();
        pieces.push((group, base));
        for &(cells, number) in found.iter() {
            let word = &self.words.all[number as usize];
            for i in 0..pieces.len() {
                let (piece, old) = pieces[i];
                let inside = piece & cells;
                if inside == 0 || is_within(word, &old) {
                    continue;
                }
                for (to, lanes) in pieces[i].1.iter_mut().zip(word) {
                    *to |= lanes;
                }
                if inside != piece {
                    pieces[i].0 = inside;
                    pieces.push((piece & !cells, old));
                }
            }
        }
    }

    /// Makes parts of pieces: each word once.
    #[inline(always)]
    fn unite(&mut self) {
        let Scratch { pieces, parts, met, now, .. } = &mut self.scratch;
        parts.clear();
        *now += 1;
        for (cells, word) in pieces.iter() {
            let number = self.words.number(word);
            if met.len() <= number as usize {
                met.resize(self.words.all.len(), (0, 0));
            }
            let before = &mut met[number as usize];
            if before.0 == *now {
                parts[before.1 as usize].0 |= cells;
            } else {
                *before = (*now, parts.len() as u32);
                parts.push((*cells, number));
            }
        }
    }

    /// One word for all cells of a group.
    #[inline(always)]
    fn settle<const P: usize>(&mut self, t: usize, g: usize, word: u32) {
        let plane = &mut self.planes[P];
        plane.held[g] = Held { first: 0, end: 0, word };
        plane.sums[g] = [self.words.all[word as usize]; 2];
        if self.only[t][P] == UNSET {
            self.only[t][P] = word;
            for &near in self.sky.sight.of(t) {
                let other = self.only[near as usize][P];
                if other != UNSET && other != word {
                    self.wake::<P>(near, t);
                }
            }
        } else if self.only[t][P] != word {
            self.mix::<P>(t);
        }
    }

    /// A tile has more than one word: those that see it must look.
    #[inline(always)]
    fn mix<const P: usize>(&mut self, t: usize) {
        if std::mem::replace(&mut self.only[t][P], MIXED) != MIXED {
            self.wake::<P>(t as u32, t);
            for &near in self.sky.sight.of(t) {
                self.wake::<P>(near, t);
            }
        }
    }

    /// Wakes a tile, as a tile `by` has a new word. What the first plane brings comes to the second on the same level:
    /// tiles before `by` have rested there.
    #[inline(always)]
    fn wake<const P: usize>(&mut self, tile: u32, by: usize) {
        let [nearer, within] = &mut self.awake[tile as usize];
        if P == NEARER {
            *nearer = true;
            if !*within && (tile as usize) < by && self.only[tile as usize][WITHIN] != UNSET {
                self.roused.push(tile);
            }
        }
        *within = true;
    }

    /// Vertices on level 1, 2, … of a lane.
    pub fn counts_of(&self, lane: usize) -> Vec<u32> {
        let totals = &self.order.totals;
        let at = |plane: usize, level: usize| {
            self.planes[plane].counts.get(level * WORD * W + lane).copied().unwrap_or(0)
        };
        let count = |level: usize| {
            let beside = at(WITHIN, level) - at(NEARER, level);
            at(NEARER, level + 1) + beside + totals[level - 1] - at(WITHIN, level - 1)
        };
        let counts = (1..=totals.len()).map(count);
        counts.take_while(|&count| count > 0).collect()
    }

    /// The levels of all cells from a lane.
    pub fn levels_of(&self, lane: usize) -> Levels {
        let mut new = Levels {
            tiles: vec![Head::default(); self.levels.tiles.len()],
            cells: Vec::with_capacity(self.levels.cells.len()),
        };
        let has = |number: u32| self.words.all[number as usize][lane / WORD] >> (lane % WORD) & 1 == 1;
        let cells_with = |plane: usize, group: usize| {
            let parts = self.planes[plane].parts_of(group);
            if parts.is_empty() {
                return if has(self.planes[plane].held[group].word) { self.levels.cells[group] } else { 0 };
            }
            parts.iter().filter(|part| has(part.1)).fold(0, |with, part| with | part.0)
        };
        let mut merged: Vec<(u32, u64)> = Vec::new();
        for (t, head) in self.levels.tiles.iter().enumerate() {
            if head.present == 0 {
                continue;
            }
            let only = self.only[t];
            if !only.contains(&MIXED) {
                let steps = only.map(|number| u32::from(has(number)));
                new.push_shifted(t, &self.levels, 2 - steps[0] - steps[1]);
                continue;
            }
            merged.clear();
            for (level, g) in head.groups() {
                let (nearer, within) = (cells_with(NEARER, g), cells_with(WITHIN, g));
                let farther = self.levels.cells[g] & !within;
                for (by, cells) in [nearer, within & !nearer, farther].into_iter().enumerate() {
                    if cells == 0 {
                        continue;
                    }
                    let level = level + by as u32 - 1;
                    let at = merged.partition_point(|m| m.0 < level);
                    match merged.get_mut(at) {
                        Some(group) if group.0 == level => group.1 |= cells,
                        _ => merged.insert(at, (level, cells)),
                    }
                }
            }
            merged.iter().for_each(|&(level, cells)| new.push(t, level, cells));
        }
        new
    }
}

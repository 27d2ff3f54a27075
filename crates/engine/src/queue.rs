//! Cells in the order of their cost.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::paths::Paths;

/// Bands of cost, at most; what costs more waits in the last one.
const BANDS_MAX: usize = 1 << 16;

/// Cost in the bits of a non-negative f32 above the vertex: sorts by cost, then vertex.
pub(super) type Key = u64;

pub(super) fn cost_of(key: Key) -> f32 {
    f32::from_bits((key >> 32) as u32)
}

/// From here on single-precision numbers are whole.
const WHOLE: f32 = (1 << (f32::MANTISSA_DIGITS - 1)) as f32;

/// The nearest whole number to one that is not negative and below 2²².
#[inline(always)]
pub(super) fn whole(x: f32) -> usize {
    // Whole numbers of this size are the last bits of a single-precision number.
    ((x + WHOLE).to_bits() - WHOLE.to_bits()) as usize
}

/// Cells in the order of their cost. Only those of the band at hand are sorted; what a better way has
/// overtaken by then is never sorted at all. Hardly a branch here can be foreseen, so there are few.
#[derive(Default)]
pub(super) struct Queue {
    /// The band at hand: sorted, from `at` to `end`, and what came to it since.
    now: Vec<Key>,
    at: usize,
    end: usize,
    late: BinaryHeap<Reverse<Key>>,
    waiting: Vec<Waiting>,
    /// The last that waits in each band, where the band holds any.
    last: Vec<u32>,
    /// Bands that hold any, bit by bit.
    filled: Vec<u64>,
    band: usize,
    bands_per_cost: f32,
}

/// A cell at the cost it had when it came, and what came to its band before.
#[derive(Clone, Copy)]
struct Waiting {
    cost: f32,
    slot: u32,
    before: u32,
}

/// Nothing came before.
const END: u32 = u32::MAX;

impl Queue {
    pub fn clear(&mut self, bands_per_cost: f32) {
        self.late.clear();
        self.waiting.clear();
        self.filled.fill(0);
        (self.at, self.end, self.band, self.bands_per_cost) = (0, 0, 0, bands_per_cost);
    }

    #[inline(always)]
    pub fn push(&mut self, paths: &Paths<'_>, cost: f32, slot: u32) {
        let band = whole((cost * self.bands_per_cost).min((BANDS_MAX - 1) as f32));
        if band <= self.band {
            self.late.push(Reverse(key(paths, cost, slot)));
            return;
        }
        if band >= self.last.len() {
            self.make_room(band);
        }
        let (filled, bit) = (&mut self.filled[band / 64], 1 << (band % 64));
        let before = if *filled & bit == 0 { END } else { self.last[band] };
        *filled |= bit;
        self.last[band] = self.waiting.len() as u32;
        self.waiting.push(Waiting { cost, slot, before });
    }

    #[cold]
    fn make_room(&mut self, band: usize) {
        let words = band / 64 + 1;
        self.filled.resize(words, 0);
        self.last.resize(words * 64, END);
    }

    /// The cheapest of the band at hand.
    #[inline(always)]
    pub fn pop(&mut self) -> Option<Key> {
        let now = &self.now[self.at..self.end];
        if self.late.is_empty() {
            self.at += 1;
            return now.first().copied();
        }
        self.pop_late()
    }

    #[cold]
    fn pop_late(&mut self) -> Option<Key> {
        if self.at >= self.end {
            self.now.clear();
            self.now.extend(self.late.drain().map(|late| late.0));
            self.now.sort_unstable();
            (self.at, self.end) = (1, self.now.len());
            return self.now.first().copied();
        }
        let key = self.now[self.at];
        if self.late.peek().is_some_and(|late| late.0 < key) {
            return self.late.pop().map(|late| late.0);
        }
        self.at += 1;
        Some(key)
    }

    /// Goes on to the next band that holds any cell whose cost is still that at which it came; `false` at the end.
    #[inline(always)]
    pub fn advance(&mut self, paths: &Paths<'_>, costs: &[f32]) -> bool {
        if self.now.len() <= self.waiting.len() {
            self.now.resize(2 * self.waiting.len() + 1, 0);
        }
        (self.at, self.end) = (0, 0);
        while self.end == 0 {
            let Some(band) = self.next_band() else { return false };
            self.band = band;
            let mut next = self.last[band];
            while let Some(&Waiting { cost, slot, before }) = self.waiting.get(next as usize) {
                self.now[self.end] = key(paths, cost, slot);
                self.end += usize::from(costs[slot as usize] == cost);
                next = before;
            }
        }
        self.now[..self.end].sort_unstable();
        true
    }

    /// The next band that holds any.
    #[inline(always)]
    fn next_band(&self) -> Option<usize> {
        let from = self.band + 1;
        let mut word = from / 64;
        let mut bits = self.filled.get(word)? & (u64::MAX << (from % 64));
        while bits == 0 {
            word += 1;
            bits = *self.filled.get(word)?;
        }
        Some(word * 64 + bits.trailing_zeros() as usize)
    }
}

#[inline(always)]
pub(super) fn key(paths: &Paths<'_>, cost: f32, slot: u32) -> Key {
    u64::from(cost.to_bits()) << 32 | u64::from(paths.vertex_of_slot[slot as usize])
}

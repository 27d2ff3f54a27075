//! What a walk has reached, in the order of its cost.

use super::paths::Paths;
use super::queue::{Key, key, whole};

/// Bins to one cell: with fewer cells to a bin hardly any are out of order in it.
const BINS_PER_CELL: usize = 2;

/// Bins, at most: as many as a first cache holds.
const BINS_MAX: usize = 1 << 13;

/// Moves to a cell, within its bin; where more are needed all are sorted anew.
const MOVES_MAX: usize = 8;

/// Buffers for the order of cells.
#[derive(Default)]
pub(super) struct Order {
    kept: Vec<(Key, u32)>,
    /// Where the cells of each bin end.
    end: Vec<u32>,
    sorted: Vec<Key>,
}

impl Order {
    /// Those of some slots that cost at most so much, by cost, then vertex. What is reached costs at most `highest`.
    pub fn by_cost(
        &mut self,
        paths: &Paths<'_>,
        reached: &[u32],
        cost: impl Fn(u32) -> f32,
        (highest, most): (f32, f64),
    ) -> &[Key] {
        let nearest = most as f32;
        let below = if f64::from(nearest) > most { nearest.next_down() } else { nearest };
        self.keep(paths, reached, cost, below.min(highest));
        let mut start = 0;
        for end in &mut self.end {
            (start, *end) = (start + *end, start);
        }
        self.sorted.clear();
        self.sorted.resize(self.kept.len(), 0);
        for &(key, bin) in &self.kept {
            let end = &mut self.end[bin as usize];
            self.sorted[*end as usize] = key;
            *end += 1;
        }
        self.put_in_order();
        &self.sorted
    }

    /// Keeps what costs at most so much, with its bin, and counts the cells of each.
    #[inline(always)]
    fn keep(&mut self, paths: &Paths<'_>, reached: &[u32], cost: impl Fn(u32) -> f32, most: f32) {
        let bins = (reached.len() * BINS_PER_CELL).clamp(1, BINS_MAX);
        let per_cost = if most > 0.0 { (bins - 1) as f32 / most } else { 0.0 };
        self.end.clear();
        self.end.resize(bins, 0);
        self.kept.resize(reached.len(), (0, 0));
        let mut n = 0;
        for &slot in reached {
            let cost = cost(slot);
            // Rounding keeps the order, so a bin holds no less than one before it.
            let bin = whole(cost.min(most) * per_cost).min(bins - 1);
            self.kept[n] = (key(paths, cost, slot), bin as u32);
            self.end[bin] += u32::from(cost <= most);
            n += usize::from(cost <= most);
        }
        self.kept.truncate(n);
    }

    /// Puts in order what is so but within bins.
    fn put_in_order(&mut self) {
        let sorted = &mut self.sorted[..];
        let mut moves = 0;
        for i in 1..sorted.len() {
            let key = sorted[i];
            let mut to = i;
            while to > 0 && sorted[to - 1] > key {
                sorted[to] = sorted[to - 1];
                to -= 1;
            }
            sorted[to] = key;
            moves += i - to;
            if moves > MOVES_MAX * sorted.len() {
                sorted.sort_unstable();
                return;
            }
        }
    }
}

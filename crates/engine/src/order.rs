//! What a walk has reached, in the order of its cost.

use super::paths::Paths;
use super::queue::{Key, cost_of, key, whole};

/// Bins to one cell: with fewer cells to a bin hardly any are out of order in it.
const BINS_PER_CELL: usize = 2;

/// Bins, at most: as many as a first cache holds.
const BINS_MAX: usize = 1 << 13;

/// Moves to a cell, within its bin; where more are needed all are sorted anew.
const MOVES_MAX: usize = 8;

/// Buffers for the order of cells.
#[derive(Default)]
pub(super) struct Order {
    kept: Vec<Key>,
    /// Where the cells of each bin end.
    end: Vec<u32>,
    sorted: Vec<Key>,
}

impl Order {
    /// Those of some slots that cost at most so much, by cost, then vertex.
    pub fn by_cost(
        &mut self,
        paths: &Paths<'_>,
        reached: &[u32],
        cost: impl Fn(u32) -> f32,
        most: f64,
    ) -> &[Key] {
        let highest = self.keep(paths, reached, cost, most);
        let n = self.kept.len();
        let bins = (n * BINS_PER_CELL).clamp(1, BINS_MAX);
        let per_cost = if highest > 0.0 { (bins - 1) as f32 / highest } else { 0.0 };
        // Rounding keeps the order, so a bin holds no less than one before it.
        let bin = |key: Key| whole(cost_of(key) * per_cost).min(bins - 1);
        self.end.clear();
        self.end.resize(bins, 0);
        self.kept.iter().for_each(|&key| self.end[bin(key)] += 1);
        let mut start = 0;
        for end in &mut self.end {
            (start, *end) = (start + *end, start);
        }
        self.sorted.clear();
        self.sorted.resize(n, 0);
        for &key in &self.kept {
            let end = &mut self.end[bin(key)];
            self.sorted[*end as usize] = key;
            *end += 1;
        }
        self.put_in_order();
        &self.sorted
    }

    /// Keeps what costs at most so much; the highest of the costs.
    fn keep(&mut self, paths: &Paths<'_>, reached: &[u32], cost: impl Fn(u32) -> f32, most: f64) -> f32 {
        let nearest = most as f32;
        let below = if f64::from(nearest) > most { nearest.next_down() } else { nearest };
        let most = below.min(f32::MAX);
        self.kept.resize(reached.len(), 0);
        let (mut n, mut highest) = (0, 0f32);
        for &slot in reached {
            let cost = cost(slot);
            self.kept[n] = key(paths, cost, slot);
            n += usize::from(cost <= most);
            highest = if cost <= most && cost > highest { cost } else { highest };
        }
        self.kept.truncate(n);
        highest
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

//! What a walk has reached, in the order of its cost.

use super::paths::Paths;
use super::queue::whole;

/// Bins to one cell, at most: with fewer cells to a bin hardly any are out of order in it.
const BINS_PER_CELL: usize = 2;

/// Bins, at most: as many as a first cache holds.
const BINS_MAX: usize = 1 << 13;

/// Cells of one bin that are put in order one by one; more are sorted as a whole.
const FEW: usize = 32;

/// Buffers for the order of cells.
#[derive(Default)]
pub(super) struct Order {
    kept: Vec<Reached>,
    /// Where the cells of each bin end.
    end: Vec<u32>,
    sorted: Vec<Reached>,
}

/// A cell that was reached, and at which cost.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Reached {
    pub cost: f32,
    pub slot: u32,
}

/// Whether a cell was reached: costs are not negative, and infinite where there is no way.
#[inline(always)]
pub(super) fn is_cost(cost: f32) -> bool {
    (cost >= 0.0) & (cost < f32::INFINITY)
}

impl Order {
    /// The cells that cost from 0 to `most`, by cost, then vertex. `cost` is by slot.
    pub fn by_cost(&mut self, paths: &Paths<'_>, cost: &[f32], most: f64) -> &[Reached] {
        self.keep(paths, cost, most);
        let n = self.kept.len();
        let highest =
            self.kept.iter().fold(0f32, |highest, r| if r.cost > highest { r.cost } else { highest });
        let bins = (n * BINS_PER_CELL).clamp(1, BINS_MAX);
        let per_cost = if highest > 0.0 { (bins - 1) as f32 / highest } else { 0.0 };
        if !per_cost.is_finite() {
            self.kept.sort_by(|a, b| a.cost.total_cmp(&b.cost));
            return &self.kept;
        }
        // Rounding keeps the order, so a bin never holds less than one before it.
        let bin = |r: &Reached| whole(r.cost * per_cost).min(bins - 1);
        self.end.clear();
        self.end.resize(bins, 0);
        self.kept.iter().for_each(|r| self.end[bin(r)] += 1);
        let mut start = 0;
        for end in &mut self.end {
            (start, *end) = (start + *end, start);
        }
        if self.sorted.len() < n {
            self.sorted.resize(n, Reached::default());
        }
        for r in &self.kept {
            let end = &mut self.end[bin(r)];
            self.sorted[*end as usize] = *r;
            *end += 1;
        }
        self.put_in_order(n);
        &self.sorted[..n]
    }

    /// Keeps what was reached, by vertex.
    fn keep(&mut self, paths: &Paths<'_>, cost: &[f32], most: f64) {
        self.kept.resize(paths.slot_of_vertex.len(), Reached::default());
        let mut n = 0;
        for &slot in &paths.slot_of_vertex {
            let cost = cost[slot as usize];
            self.kept[n] = Reached { cost, slot };
            n += usize::from(is_cost(cost) & (f64::from(cost) <= most));
        }
        self.kept.truncate(n);
    }

    /// Within bins the cells come by vertex, and stay so where they cost the same.
    fn put_in_order(&mut self, n: usize) {
        let mut start = 0;
        for &end in self.end.iter().filter(|&&end| end as usize <= n) {
            let bin = &mut self.sorted[start..end as usize];
            start = end as usize;
            if bin.len() > FEW {
                bin.sort_by(|a, b| a.cost.total_cmp(&b.cost));
                continue;
            }
            for i in 1..bin.len() {
                let r = bin[i];
                let mut to = i;
                while to > 0 && bin[to - 1].cost > r.cost {
                    bin[to] = bin[to - 1];
                    to -= 1;
                }
                bin[to] = r;
            }
        }
    }
}

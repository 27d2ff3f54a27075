//! Walls that run through each other now and did not in the initial layout (spec section 5).

use std::collections::BTreeSet;

use super::pairs::{Aabb, BoxGrid, sweep};
use super::{Layout, TOUCH_M, WallPiece, common_length_m, through_m};

/// Metres of walls run through each other, over the pairs that did not do so initially.
///
/// A crossing counts with the distance from the crossing to the nearest of the four wall ends (the
/// least by which a wall would have to draw back), a common stretch of two walls on one line with its
/// length. Touching counts nothing, so the penalty grows from 0 without a jump.
#[derive(Clone, Debug)]
pub struct Overlap {
    moving: Vec<usize>,
    fixed: Vec<usize>,
    fixed_grid: BoxGrid,
    /// Pairs (smaller, larger piece number) that met already.
    initial_pairs: BTreeSet<(usize, usize)>,
}

impl Overlap {
    /// Remembers which walls ran through each other from the start.
    pub fn new(initial: &Layout<'_>) -> Self {
        let pieces = initial.pieces;
        let (moving, fixed): (Vec<_>, Vec<_>) = (0..pieces.len()).partition(|&i| pieces[i].is_moving);
        let fixed_grid = BoxGrid::new(fixed.iter().map(|&i| box_of(&pieces[i])).collect());
        let mut overlap = Self { moving, fixed, fixed_grid, initial_pairs: BTreeSet::new() };
        let mut pairs = BTreeSet::new();
        overlap.for_each_pair(pieces, |i, j, _| {
            pairs.insert((i, j));
        });
        overlap.initial_pairs = pairs;
        overlap
    }

    /// The penalty, metres, ≥ 0. `now` lists the pieces of the initial layout in the same order.
    pub fn measure_m(&self, now: &Layout<'_>) -> f64 {
        let mut sum_m = 0.0;
        self.for_each_pair(now.pieces, |i, j, through_m| {
            if !self.initial_pairs.contains(&(i, j)) {
                sum_m += through_m;
            }
        });
        sum_m
    }

    /// Calls `visit(i, j, metres)`, i < j, for every pair that runs through each other and of which one
    /// may move.
    fn for_each_pair(&self, pieces: &[WallPiece], mut visit: impl FnMut(usize, usize, f64)) {
        let boxes: Vec<Aabb> = self.moving.iter().map(|&i| box_of(&pieces[i])).collect();
        let mut pair = |i: usize, j: usize| {
            let through_m = run_through_m(&pieces[i], &pieces[j]);
            if through_m > 0.0 {
                visit(i.min(j), i.max(j), through_m);
            }
        };
        for (k, aabb) in boxes.iter().enumerate() {
            self.fixed_grid.visit(aabb, |f| pair(self.moving[k], self.fixed[f]));
        }
        sweep(&boxes, |i, j| pair(self.moving[i], self.moving[j]));
    }
}

fn box_of(piece: &WallPiece) -> Aabb {
    Aabb::of_segment(piece.ends(), 0.0)
}

fn run_through_m(p: &WallPiece, q: &WallPiece) -> f64 {
    if let Some(common_m) = common_length_m(p.ends(), q.ends()) {
        return common_m;
    }
    // Walls that share a node meet there and nowhere else.
    let is_joined = p.nodes.iter().any(|n| q.nodes.contains(n));
    let through_m = if is_joined { None } else { through_m(p.ends(), q.ends()) };
    through_m.filter(|&m| m > TOUCH_M).unwrap_or(0.0)
}

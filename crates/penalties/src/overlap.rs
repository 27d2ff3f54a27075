//! Walls that run through each other now and did not in the initial layout (spec section 5).

use std::collections::{BTreeMap, BTreeSet};

use super::covered::Bodies;
use super::pairs::{Aabb, BoxGrid, sweep};
use super::{Layout, TOUCH_M, WallPiece, common_length_m, through_m};

/// Metres of walls run through each other or into solids, over the pairs that did not do so initially.
///
/// A crossing counts with the distance from the crossing to the nearest of the four wall ends (the
/// least by which a wall would have to draw back), a common stretch of two walls on one line with its
/// length, unless both are faces of solids: these touch. Where one of two walls is a solid, the other may stand in it and cross nothing: such a pair
/// counts at least with the shortest way by which one leaves the other (of an outline that is not
/// convex, the largest among its convex parts). Touching counts nothing, so the penalty grows from 0
/// without a jump.
#[derive(Clone, Debug)]
pub struct Overlap {
    moving: Vec<usize>,
    fixed: Vec<usize>,
    fixed_grid: BoxGrid,
    bodies: Bodies,
    /// Pairs (smaller, larger piece number) that met already.
    initial_pairs: BTreeSet<(usize, usize)>,
    /// Pairs of bodies that met already.
    initial_bodies: BTreeSet<[usize; 2]>,
}

impl Overlap {
    /// Remembers which walls ran through each other from the start.
    pub fn new(initial: &Layout<'_>) -> Self {
        let pieces = initial.pieces;
        let (moving, fixed): (Vec<_>, Vec<_>) = (0..pieces.len()).partition(|&i| pieces[i].is_moving);
        let fixed_grid = BoxGrid::new(fixed.iter().map(|&i| box_of(&pieces[i])).collect());
        let mut overlap = Self {
            moving,
            fixed,
            fixed_grid,
            bodies: Bodies::new(initial),
            initial_pairs: BTreeSet::new(),
            initial_bodies: BTreeSet::new(),
        };
        let initial_bodies = overlap.pairs_m(initial).into_iter().map(|(names, _)| names).collect();
        let mut pairs = BTreeSet::new();
        overlap.for_each_pair(pieces, |i, j, _| {
            pairs.insert((i, j));
        });
        overlap.initial_pairs = pairs;
        overlap.initial_bodies = initial_bodies;
        overlap
    }

    /// The penalty, metres, ≥ 0. `now` lists the pieces of the initial layout in the same order.
    pub fn measure_m(&self, now: &Layout<'_>) -> f64 {
        // The sum of nothing is −0.
        self.by_pair(now).values().sum::<f64>() + 0.0
    }

    /// What the penalty counts, pair by pair: a piece of either wall (of a solid the first), and metres.
    pub fn pairs_m(&self, now: &Layout<'_>) -> Vec<([usize; 2], f64)> {
        self.by_pair(now).into_iter().collect()
    }

    fn by_pair(&self, now: &Layout<'_>) -> BTreeMap<[usize; 2], f64> {
        let mut out: BTreeMap<[usize; 2], f64> = BTreeMap::new();
        self.for_each_pair(now.pieces, |i, j, through_m| {
            if !self.initial_pairs.contains(&(i, j)) {
                let (i, j) = (self.bodies.of(i), self.bodies.of(j));
                *out.entry([i.min(j), i.max(j)]).or_default() += through_m;
            }
        });
        let is_known = |names| self.initial_bodies.contains(&names);
        self.bodies.for_each(now.pieces, is_known, |names, depth_m| {
            let counted = out.entry(names).or_default();
            *counted = counted.max(depth_m);
        });
        out
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
        // Solids face to face touch.
        return if p.solid.is_some() && q.solid.is_some() { 0.0 } else { common_m };
    }
    // Walls that share a node meet there and nowhere else.
    let is_joined = p.nodes.iter().any(|n| q.nodes.contains(n));
    let through_m = if is_joined { None } else { through_m(p.ends(), q.ends()) };
    through_m.filter(|&m| m > TOUCH_M).unwrap_or(0.0)
}

//! Shortest paths from one cell to all others, in the order of their length.
//!
//! Where many roots are walked from, [`Bundle`](super::bundle::Bundle) does it by lists. Here a cell goes through what it
//! sees and its predecessor does not. Only cells at which paths may turn wait for their turn. Costs lie by slot (64 to a
//! tile), so that a row of eight cells of a tile is one register, with lengths from a table whose rows run along the same
//! cells.

use super::lanes::{ROW, Rows, known_in, next_row, walk_by_rows};
use super::offsets::{length_of, turn};
use super::paths::Paths;
use super::queue::{Queue, cost_of};

/// Bands of cost to one cell of length.
const BANDS_PER_CELL: f32 = 1.0;

/// Buffers of one worker, by slot.
pub(super) struct Shortest {
    /// Cells; infinite where there is no way.
    pub cost: Vec<f32>,
    /// The slot before, which is a root's own.
    before: Vec<u32>,
    /// Angle turned on the way, at cells that were left; none at roots, where paths turn for nothing.
    angle: Vec<f32>,
    /// Direction of the last piece of the way, at cells that were left.
    heading: Vec<f64>,
    queue: Queue,
    /// Slots that were reached, and then room for the others.
    reached: Vec<u32>,
    count: usize,
}

/// A cell that is left: its cost and its slot.
#[derive(Clone, Copy)]
struct Leaving {
    cost: f32,
    at: u32,
}

impl Shortest {
    pub fn new(paths: &Paths<'_>) -> Self {
        let slots = paths.vertex_of_slot.len();
        Self {
            cost: vec![f32::INFINITY; slots],
            before: vec![0; slots],
            angle: vec![0.0; slots],
            heading: vec![0.0; slots],
            queue: Queue::default(),
            reached: vec![0; slots + 1],
            count: 0,
        }
    }

    walk_by_rows!(
        /// Walks from some slots; costs beyond `radius` need not be the lowest.
        roots: &[u32], radius: f64
    );

    #[inline(always)]
    fn walk_in<R: Rows>(&mut self, paths: &Paths<'_>, roots: &[u32], radius: f64) {
        self.begin(paths, roots);
        loop {
            while let Some(key) = self.queue.pop() {
                let at = paths.slot_of_vertex[key as u32 as usize];
                let cost = cost_of(key);
                if self.cost[at as usize] != cost {
                    continue;
                }
                if f64::from(cost) > radius {
                    return;
                }
                self.leave::<R>(paths, Leaving { cost, at });
            }
            if !self.queue.advance(paths, &self.cost) {
                return;
            }
        }
    }

    fn begin(&mut self, paths: &Paths<'_>, roots: &[u32]) {
        for &slot in &self.reached[..self.count] {
            self.cost[slot as usize] = f32::INFINITY;
        }
        self.count = 0;
        self.queue.clear(BANDS_PER_CELL);
        for &root in roots {
            if self.cost[root as usize] != 0.0 {
                self.cost[root as usize] = 0.0;
                self.reached[self.count] = root;
                self.count += 1;
                self.before[root as usize] = root;
                self.queue.push(paths, 0.0, root);
            }
        }
    }

    /// Offers a way through a cell to all that it sees and its predecessor, if it has one, does not: the straight way there
    /// is no longer.
    #[inline(always)]
    fn leave<R: Rows>(&mut self, paths: &Paths<'_>, leaving: Leaving) {
        let at = leaving.at as usize;
        let before = self.before[at];
        let is_root = before == leaving.at;
        self.angle[at] = if is_root { f32::NEG_INFINITY } else { self.turned(paths, leaving.at) };
        self.heading[at] = paths.direction(before, leaving.at);
        let graph = paths.graph;
        let known = if is_root { (&[][..], &[][..]) } else { graph.row(paths.rank(before)) };
        let (tiles, masks) = graph.row(paths.rank(leaving.at));
        let mut next = 0;
        for (&tile, &mask) in tiles.iter().zip(masks) {
            let mut bits = mask & !known_in(known, tile, &mut next);
            while let Some((row, cells)) = next_row(&mut bits) {
                let first = tile << 6 | row;
                let (new, mut better) = self.better::<R>(paths, leaving, first, cells);
                while better != 0 {
                    let i = better.trailing_zeros();
                    better &= better - 1;
                    self.take(paths, first + i, new[i as usize & 7], leaving.at);
                }
            }
        }
    }

    /// The slots that were reached, in any order.
    pub fn reached(&self) -> &[u32] {
        &self.reached[..self.count]
    }

    /// The slot before one that was reached, on the way there.
    #[inline(always)]
    pub fn before(&self, slot: u32) -> u32 {
        self.before[slot as usize]
    }

    /// The angle turned on the way to a slot that was reached, right angles: none on the first piece.
    #[inline(always)]
    pub fn turned(&self, paths: &Paths<'_>, slot: u32) -> f32 {
        let before = self.before[slot as usize];
        let turn = turn(self.heading[before as usize], paths.direction(before, slot));
        let angle = self.angle[before as usize] + turn;
        if angle > 0.0 { angle } else { 0.0 }
    }

    /// Takes a better way to a cell.
    #[inline(always)]
    fn take(&mut self, paths: &Paths<'_>, slot: u32, cost: f32, before: u32) {
        let at = slot as usize;
        self.before[at] = before;
        if self.cost[at] == cost {
            // Shorter by less than single precision holds: where paths may turn it waits at this cost.
            return;
        }
        self.reached[self.count] = slot;
        self.count += usize::from(self.cost[at] == f32::INFINITY);
        self.cost[at] = cost;
        if paths.may_turn(slot) {
            self.queue.push(paths, cost, slot);
        }
    }

    /// The costs of a row of eight after a cell, and which of some are better than the old ones.
    #[inline(always)]
    fn better<R: Rows>(
        &self,
        paths: &Paths<'_>,
        leaving: Leaving,
        first: u32,
        cells: u32,
    ) -> ([f32; ROW], u32) {
        let lengths = paths.row(&paths.offsets.lengths, leaving.at, first, length_of);
        let (mut new, mut exact) = ([leaving.cost; ROW], [f64::from(leaving.cost); ROW]);
        for i in 0..ROW {
            exact[i] += lengths[i];
            new[i] += lengths[i] as f32;
        }
        let old = &self.cost.as_chunks::<ROW>().0[first as usize / ROW];
        (new, R::less_wide(&exact, old) & cells)
    }
}

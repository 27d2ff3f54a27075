//! Shortest paths from one cell to all others, in the order of their length.
//!
//! A cell offers a way to the cells to which the way there leads on, by the lists of [`Corners`]. Only cells that lead on
//! wait for their turn. Where there are no lists a cell goes through what it sees and its predecessor does not: costs lie
//! by slot (64 to a tile), so that a row of eight cells of a tile is one register, with lengths from a table whose rows
//! run along the same cells.

use super::corners::{Away, Corners, List, NOTHING};
use super::lanes::{ROW, Rows, known_in, next_row, walk_by_rows};
use super::offsets::{length_of, turn};
use super::paths::Paths;
use super::queue::{Queue, cost_of};

/// Bands of cost to one cell of length.
const BANDS_PER_CELL: f32 = 1.0;

/// Stands for the list of all that a cell sees, without [`Corners`].
const ALL: List = [u32::MAX; 2];

/// How a cell was reached: the slot before, which is a root's own, and what is offered from here.
#[derive(Clone, Copy)]
struct Arrival {
    before: u32,
    list: List,
}

/// Buffers of one worker, by slot.
pub(super) struct Shortest {
    /// Cells; infinite where there is no way.
    pub cost: Vec<f32>,
    arrival: Vec<Arrival>,
    /// Angle turned on the way, at cells that were left; none at roots, where paths turn for nothing.
    angle: Vec<f32>,
    /// Direction of the last piece of the way, at cells that were left.
    heading: Vec<f64>,
    queue: Queue,
    /// Places of the better ones of some cells.
    found: Vec<u32>,
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
            arrival: vec![Arrival { before: 0, list: NOTHING }; slots],
            angle: vec![0.0; slots],
            heading: vec![0.0; slots],
            queue: Queue::default(),
            found: Vec::new(),
            reached: vec![0; slots + 1],
            count: 0,
        }
    }

    walk_by_rows!(
        /// Walks from some slots; costs beyond `radius` need not be the lowest. Corners pay where many roots share them; the
        /// lengths are the same up to rounding.
        Away
    );

    #[inline(always)]
    fn walk_in<R: Rows>(
        &mut self,
        paths: &Paths<'_>,
        corners: Option<&Corners<Away>>,
        roots: &[u32],
        radius: f64,
    ) {
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
                self.leave::<R>(paths, corners, Leaving { cost, at });
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
                self.arrival[root as usize] = Arrival { before: root, list: ALL };
                self.queue.push(paths, 0.0, root);
            }
        }
    }

    /// Offers a way through a cell to those to which the way there leads on.
    #[inline(always)]
    fn leave<R: Rows>(&mut self, paths: &Paths<'_>, corners: Option<&Corners<Away>>, leaving: Leaving) {
        let at = leaving.at as usize;
        let Arrival { before, list } = self.arrival[at];
        let is_root = before == leaving.at;
        self.angle[at] = if is_root { f32::NEG_INFINITY } else { self.turned(paths, leaving.at) };
        self.heading[at] = paths.direction(before, leaving.at);
        match corners {
            Some(corners) if !is_root => self.offer(paths, corners, leaving, list),
            _ => self.offer_all::<R>(paths, corners, leaving, (!is_root).then_some(before)),
        }
    }

    /// The slots that were reached, in any order.
    pub fn reached(&self) -> &[u32] {
        &self.reached[..self.count]
    }

    /// The angle turned on the way to a slot that was reached, right angles: none on the first piece.
    #[inline(always)]
    pub fn turned(&self, paths: &Paths<'_>, slot: u32) -> f32 {
        let before = self.arrival[slot as usize].before;
        let turn = turn(self.heading[before as usize], paths.direction(before, slot));
        let angle = self.angle[before as usize] + turn;
        if angle > 0.0 { angle } else { 0.0 }
    }

    /// Offers a way to the cells of a list: first to all, without a branch, as nobody can tell which take it.
    #[inline(always)]
    fn offer(&mut self, paths: &Paths<'_>, corners: &Corners<Away>, leaving: Leaving, list: List) {
        let cells = corners.cells(list);
        if self.found.len() < cells.len() {
            self.found.resize(2 * cells.len(), 0);
        }
        let (costs, found) = (&self.cost[..], &mut self.found[..cells.len()]);
        let cost = f64::from(leaving.cost);
        let mut count = 0;
        for (to, i) in cells.iter().zip(0..) {
            found[count] = i;
            count += usize::from(cost + to.length < f64::from(costs[to.slot as usize]));
        }
        for i in 0..count {
            let to = cells[self.found[i] as usize];
            self.take(paths, to.slot, leaving.cost + to.length as f32, leaving.at, corners.list(to.list));
        }
    }

    /// Takes a better way to a cell.
    #[inline(always)]
    fn take(&mut self, paths: &Paths<'_>, slot: u32, cost: f32, before: u32, list: List) {
        let at = slot as usize;
        let led = self.arrival[at].list;
        if self.cost[at] == cost && led != NOTHING {
            // Shorter by less than single precision holds: it waits at this cost, and leads at least where it led.
            let list = if list == NOTHING { led } else { list };
            self.arrival[at] = Arrival { before, list };
            return;
        }
        self.reached[self.count] = slot;
        self.count += usize::from(self.cost[at] == f32::INFINITY);
        self.cost[at] = cost;
        self.arrival[at] = Arrival { before, list };
        if list != NOTHING {
            self.queue.push(paths, cost, slot);
        }
    }

    /// Offers a way to all that a cell sees and its predecessor, if it has one, does not: the straight way there is no
    /// longer.
    #[inline(always)]
    fn offer_all<R: Rows>(
        &mut self,
        paths: &Paths<'_>,
        corners: Option<&Corners<Away>>,
        leaving: Leaving,
        before: Option<u32>,
    ) {
        let (graph, rank) = (paths.graph, paths.rank(leaving.at));
        let known = before.map_or((&[][..], &[][..]), |before| graph.row(paths.rank(before)));
        let (tiles, masks) = graph.row(rank);
        let (mut next, mut place) = (0, 0);
        for (&tile, &mask) in tiles.iter().zip(masks) {
            let mut bits = mask & !known_in(known, tile, &mut next);
            while let Some((row, cells)) = next_row(&mut bits) {
                let first = tile << 6 | row;
                let (new, mut better) = self.better::<R>(paths, leaving, first, cells);
                while better != 0 {
                    let i = better.trailing_zeros();
                    better &= better - 1;
                    let slot = first + i;
                    let list = match corners {
                        Some(corners) => {
                            let before = mask & ((1 << (slot & 63)) - 1);
                            corners.list_of(rank, place + before.count_ones())
                        }
                        None if paths.may_turn(slot) => ALL,
                        None => NOTHING,
                    };
                    self.take(paths, slot, new[i as usize & 7], leaving.at, list);
                }
            }
            place += mask.count_ones();
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

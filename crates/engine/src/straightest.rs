//! Straightest paths from one cell to all others, in the order of their turns.
//!
//! A cell offers a way to the cells to which the way there leads on, by the lists of [`Corners`]. Where there are no lists
//! a cell goes through what it sees and its predecessor does not: costs lie by slot (64 to a tile), so that a row of eight
//! cells of a tile is one register, with directions from a table whose rows run along the same cells.

use super::corners::{Corners, List, NOTHING, Turned};
use super::lanes::{ROW, Rows, known_in, next_row, walk_by_rows};
use super::offsets::{direction_of, turn};
use super::paths::Paths;
use super::queue::{Queue, cost_of};

/// Bands of cost to one right angle.
const BANDS_PER_RIGHT_ANGLE: f32 = 32.0;

/// How a cell was reached.
#[derive(Clone, Copy)]
struct Arrival {
    /// The slot before, which is a root's own.
    before: u32,
    /// What is offered from here, where there are lists.
    list: List,
}

/// Buffers of one worker, by slot.
pub(super) struct Straightest {
    /// Right angles; infinite where there is no way.
    pub cost: Vec<f32>,
    /// Costs of what was reached, ascending.
    pub reached: Vec<f32>,
    /// Cells that have not been left, by tile.
    open: Vec<u64>,
    arrival: Vec<Arrival>,
    queue: Queue,
    /// Places of the better ones of some cells.
    found: Vec<u32>,
    hits: Vec<Hit>,
}

/// A row of eight with better ways to some cells: its first slot, the cells, the costs, and the place of the
/// first cell of its tile, with all cells of the tile, among the neighbours of the cell that leads there.
#[derive(Clone, Copy, Default)]
struct Hit {
    first: u32,
    better: u32,
    costs: [f32; ROW],
    place: u32,
    mask: u64,
}

/// A cell that is left: its cost, its slot, and the direction in which it was reached, if it was.
struct Leaving {
    cost: f32,
    at: u32,
    heading: Option<f64>,
}

impl Straightest {
    pub fn new(paths: &Paths<'_>) -> Self {
        let slots = paths.vertex_of_slot.len();
        Self {
            cost: vec![f32::INFINITY; slots],
            reached: Vec::new(),
            open: Vec::new(),
            arrival: vec![Arrival { before: 0, list: NOTHING }; slots],
            queue: Queue::default(),
            found: Vec::new(),
            hits: Vec::new(),
        }
    }

    walk_by_rows!(
        /// Walks from some slots; costs beyond `radius` need not be the lowest. Corners pay where many roots share them.
        corners: Option<&Corners<Turned>>, roots: &[u32], radius: f64
    );

    #[inline(always)]
    fn walk_in<R: Rows>(
        &mut self,
        paths: &Paths<'_>,
        corners: Option<&Corners<Turned>>,
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
                self.open[at as usize >> 6] &= !(1 << (at & 63));
                self.reached.push(cost);
                self.leave::<R>(paths, corners, cost, at);
            }
            if !self.queue.advance(paths, &self.cost) {
                return;
            }
        }
    }

    fn begin(&mut self, paths: &Paths<'_>, roots: &[u32]) {
        self.cost.fill(f32::INFINITY);
        self.open.clone_from(&paths.graph.tiles.occupied);
        self.reached.clear();
        self.queue.clear(BANDS_PER_RIGHT_ANGLE);
        for &root in roots {
            if self.cost[root as usize] != 0.0 {
                self.cost[root as usize] = 0.0;
                self.arrival[root as usize] = Arrival { before: root, list: NOTHING };
                self.queue.push(paths, 0.0, root);
            }
        }
    }

    /// Offers a way through `at` to all that it sees and its predecessor does not: the straight way there turns no more.
    #[inline(always)]
    fn leave<R: Rows>(&mut self, paths: &Paths<'_>, corners: Option<&Corners<Turned>>, cost: f32, at: u32) {
        let Arrival { before, list } = self.arrival[at as usize];
        let before = (before != at).then_some(before);
        match corners {
            Some(corners) if list != NOTHING => self.offer::<R>(paths, corners, cost, at, list),
            // Straight ahead paths go on anywhere.
            _ if cost == 0.0 || (corners.is_none() && paths.may_turn(at)) => {
                let heading = before.map(|before| paths.direction(before, at));
                self.find_all::<R>(paths, &Leaving { cost, at, heading }, before);
                for i in 0..self.hits.len() {
                    self.take_row(paths, corners, at, self.hits[i]);
                }
            }
            _ => {}
        }
    }

    /// Offers a way to the cells of a list: first to all, without a branch, as nobody can tell which take it.
    #[inline(always)]
    fn offer<R: Rows>(
        &mut self,
        paths: &Paths<'_>,
        corners: &Corners<Turned>,
        cost: f32,
        at: u32,
        list: List,
    ) {
        let cells = corners.cells(list);
        if self.found.len() < cells.len() + ROW {
            self.found.resize(2 * (cells.len() + ROW), 0);
        }
        let count = find_straighter::<R>(&self.cost, cells, cost, &mut self.found);
        for i in 0..count {
            let to = cells[self.found[i] as usize];
            self.take(paths, Some(corners.list(to.list)), to.slot, cost + to.turn, at);
        }
    }

    /// Takes a better way to a cell, and what is offered from there, where there are lists.
    #[inline(always)]
    fn take(&mut self, paths: &Paths<'_>, list: Option<List>, slot: u32, cost: f32, before: u32) {
        self.cost[slot as usize] = cost;
        self.arrival[slot as usize] = Arrival { before, list: list.unwrap_or(NOTHING) };
        self.queue.push(paths, cost, slot);
    }

    /// Lists the rows with better ways among all that a cell sees and its predecessor, if it has one, does not.
    #[inline(always)]
    fn find_all<R: Rows>(&mut self, paths: &Paths<'_>, leaving: &Leaving, before: Option<u32>) {
        let graph = paths.graph;
        let known = before.map_or((&[][..], &[][..]), |before| graph.row(paths.rank(before)));
        let (tiles, masks) = graph.row(paths.rank(leaving.at));
        let costs = self.cost.as_chunks::<ROW>().0;
        let (mut next, mut place) = (0, 0);
        self.hits.clear();
        for (&tile, &mask) in tiles.iter().zip(masks) {
            let mut bits = mask & self.open[tile as usize] & !known_in(known, tile, &mut next);
            while let Some((row, cells)) = next_row(&mut bits) {
                let first = tile << 6 | row;
                let costs_now = &costs[first as usize / ROW];
                let new = leaving.costs_of_row(paths, first);
                let better = R::less(&new, costs_now) & cells;
                if better != 0 {
                    self.hits.push(Hit { first, better, costs: new, place, mask });
                }
            }
            place += mask.count_ones();
        }
    }

    #[inline(always)]
    fn take_row(&mut self, paths: &Paths<'_>, corners: Option<&Corners<Turned>>, at: u32, hit: Hit) {
        let mut better = hit.better;
        while better != 0 {
            let i = better.trailing_zeros();
            better &= better - 1;
            let slot = hit.first + i;
            let list = corners.map(|corners| {
                let place = hit.place + (hit.mask & ((1 << (slot & 63)) - 1)).count_ones();
                corners.list_of(paths.rank(at), place)
            });
            self.take(paths, list, slot, hit.costs[i as usize & 7], at);
        }
    }
}

impl Leaving {
    /// The costs of a row of eight after a cell.
    #[inline(always)]
    fn costs_of_row(&self, paths: &Paths<'_>, first: u32) -> [f32; ROW] {
        let mut new = [self.cost; ROW];
        if let Some(heading) = self.heading {
            let directions = paths.row(&paths.offsets.directions, self.at, first, direction_of);
            for i in 0..ROW {
                new[i] += turn(heading, directions[i]);
            }
        }
        new
    }
}

/// Lists the places of those cells to which a way is straighter than theirs: so many.
#[inline(always)]
fn find_straighter<R: Rows>(costs: &[f32], cells: &[Turned], cost: f32, found: &mut [u32]) -> usize {
    let mut count = 0;
    let (eights, rest) = cells.as_chunks::<ROW>();
    for (eight, first) in eights.iter().zip((0..).step_by(ROW)) {
        let (mut new, mut old) = ([cost; ROW], [0.0; ROW]);
        for i in 0..ROW {
            new[i] += eight[i].turn;
            old[i] = costs[eight[i].slot as usize];
        }
        let better = R::less(&new, &old);
        if let Some(to) = found.get_mut(count..).and_then(|f| f.first_chunk_mut()) {
            R::list(better, first, to);
        }
        count += better.count_ones() as usize;
    }
    for (to, i) in rest.iter().zip(cells.len() - rest.len()..) {
        found[count] = i as u32;
        count += usize::from(cost + to.turn < costs[to.slot as usize]);
    }
    count
}

//! Walks from one cell to all others in the order of their cost: shortest and straightest paths.
//!
//! A cell offers a way to the cells to which the way there leads on, by the lists of [`Corners`]. Where there
//! are none it goes through what it sees and its predecessor does not: costs lie by slot (64 to a tile), so that a
//! row of eight cells of a tile is one register, with lengths and angles from tables whose rows run along the
//! same cells.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::corners::{Corners, List, Turned, next_row};
use super::graph::Graph;
use super::lanes::Path;
#[cfg(target_arch = "x86_64")]
use super::lanes::x86::Avx2;
use super::lanes::{Portable, ROW, Rows};
use super::offsets::{direction_of, length_of, turn};
use super::paths::Paths;

/// No predecessor.
pub(super) const START: u32 = u32::MAX;

/// Bands of cost to one cell of length, and to one right angle.
const BANDS_PER_CELL: f32 = 1.0;
const BANDS_PER_RIGHT_ANGLE: f32 = 32.0;

/// Bands that are told apart; what costs more waits in the last one.
const BANDS_MAX: usize = 1 << 16;

/// Cost in the bits of a non-negative f32 above the vertex: sorts by cost, then vertex.
type Key = u64;

fn cost_of(key: Key) -> f32 {
    f32::from_bits((key >> 32) as u32)
}

/// From here on single-precision numbers are whole.
const WHOLE: f32 = (1 << (f32::MANTISSA_DIGITS - 1)) as f32;

/// Cells in the order of their cost. Only those of the band at hand are sorted; what a better way has
/// overtaken by then is never sorted at all. Hardly a branch here can be foreseen, so there are few.
#[derive(Default)]
struct Queue {
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
    fn clear(&mut self, bands_per_cost: f32) {
        self.late.clear();
        self.waiting.clear();
        self.filled.fill(0);
        (self.at, self.end, self.band, self.bands_per_cost) = (0, 0, 0, bands_per_cost);
    }

    #[inline(always)]
    fn push(&mut self, paths: &Paths<'_>, cost: f32, slot: u32) {
        // Whole numbers of this size are the last bits of a single-precision number.
        let band = (cost * self.bands_per_cost).min((BANDS_MAX - 1) as f32) + WHOLE;
        let band = (band.to_bits() - WHOLE.to_bits()) as usize;
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
    fn pop(&mut self) -> Option<Key> {
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
    fn advance(&mut self, paths: &Paths<'_>, costs: &[f32]) -> bool {
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
fn key(paths: &Paths<'_>, cost: f32, slot: u32) -> Key {
    u64::from(cost.to_bits()) << 32 | u64::from(paths.vertex_of_slot[slot as usize])
}

/// How a cell was reached.
#[derive(Clone, Copy)]
struct Arrival {
    /// The slot before, on the way here.
    before: u32,
    /// What is offered from here.
    list: List,
}

/// Buffers of one worker, by slot.
pub(super) struct Walk {
    /// Infinite where there is no way.
    pub cost: Vec<f32>,
    arrival: Vec<Arrival>,
    /// Angle turned along the metric path, at cells that were left.
    pub angle: Vec<f32>,
    /// Direction of the last piece of the way, at cells that were left.
    heading: Vec<f64>,
    /// Cells that have not been left, by tile.
    open: Vec<u64>,
    queue: Queue,
    /// Places of the better ones of some cells.
    found: Vec<u32>,
    hits: Vec<Hit>,
    /// What was reached, by cost, then vertex: cost and slot.
    pub reached: Vec<(f32, u32)>,
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

/// A cell that is left: its cost, its slot, that before, and the direction in which it was reached, if it was.
struct Leaving {
    cost: f32,
    at: u32,
    before: u32,
    heading: Option<f64>,
}

impl Walk {
    pub fn new(graph: &Graph) -> Self {
        let slots = graph.tiles.count() * 64;
        Self {
            cost: vec![f32::INFINITY; slots],
            arrival: vec![Arrival { before: START, list: List::NONE }; slots],
            angle: vec![0.0; slots],
            heading: vec![0.0; slots],
            open: Vec::new(),
            queue: Queue::default(),
            found: Vec::new(),
            hits: Vec::new(),
            reached: Vec::new(),
        }
    }

    /// Shortest paths from some slots, costs in cells. Costs beyond `radius` need not be the lowest.
    /// Corners pay where many roots share them; the lengths are the same up to rounding.
    pub fn metric(&mut self, paths: &Paths<'_>, corners: Option<&Corners>, roots: &[u32], radius: f64) {
        self.walk::<true>(paths, corners, roots, radius);
    }

    /// Straightest paths from some slots, costs in right angles. Corners pay where many roots share them.
    pub fn angular(&mut self, paths: &Paths<'_>, corners: Option<&Corners>, roots: &[u32], radius: f64) {
        self.walk::<false>(paths, corners, roots, radius);
    }

    fn walk<const METRIC: bool>(
        &mut self,
        paths: &Paths<'_>,
        corners: Option<&Corners>,
        roots: &[u32],
        radius: f64,
    ) {
        match paths.path {
            // SAFETY: a path is only made for a processor that has its instructions.
            #[cfg(target_arch = "x86_64")]
            #[allow(unsafe_code)]
            Path::Avx512 => unsafe { self.walk_avx512::<METRIC>(paths, corners, roots, radius) },
            #[cfg(target_arch = "x86_64")]
            #[allow(unsafe_code)]
            Path::Avx2 => unsafe { self.walk_avx2::<METRIC>(paths, corners, roots, radius) },
            Path::Portable => self.walk_in::<METRIC, Portable>(paths, corners, roots, radius),
        }
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx512f,avx512dq,avx2,popcnt,bmi1,bmi2")]
    fn walk_avx512<const METRIC: bool>(
        &mut self,
        paths: &Paths<'_>,
        corners: Option<&Corners>,
        roots: &[u32],
        radius: f64,
    ) {
        self.walk_in::<METRIC, Avx2>(paths, corners, roots, radius);
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,popcnt,bmi1,bmi2")]
    fn walk_avx2<const METRIC: bool>(
        &mut self,
        paths: &Paths<'_>,
        corners: Option<&Corners>,
        roots: &[u32],
        radius: f64,
    ) {
        self.walk_in::<METRIC, Avx2>(paths, corners, roots, radius);
    }

    #[inline(always)]
    fn walk_in<const METRIC: bool, R: Rows>(
        &mut self,
        paths: &Paths<'_>,
        corners: Option<&Corners>,
        roots: &[u32],
        radius: f64,
    ) {
        self.begin(paths, roots, if METRIC { BANDS_PER_CELL } else { BANDS_PER_RIGHT_ANGLE });
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
                self.reached.push((cost, at));
                self.leave::<METRIC, R>(paths, corners, cost, at);
            }
            if !self.queue.advance(paths, &self.cost) {
                return;
            }
        }
    }

    #[inline(always)]
    fn begin(&mut self, paths: &Paths<'_>, roots: &[u32], bands_per_cost: f32) {
        self.cost.fill(f32::INFINITY);
        self.open.clone_from(&paths.graph.tiles.occupied);
        self.queue.clear(bands_per_cost);
        self.reached.clear();
        for &root in roots {
            if self.cost[root as usize] != 0.0 {
                self.cost[root as usize] = 0.0;
                self.arrival[root as usize] = Arrival { before: START, list: List::ALL };
                self.queue.push(paths, 0.0, root);
            }
        }
    }

    /// Offers a way through `at` to those cells to which the way there leads on; without corners to all that
    /// it sees and its predecessor does not: the straight way there is no longer and turns no more.
    #[inline(always)]
    fn leave<const METRIC: bool, R: Rows>(
        &mut self,
        paths: &Paths<'_>,
        corners: Option<&Corners>,
        cost: f32,
        at: u32,
    ) {
        let Arrival { before, list } = self.arrival[at as usize];
        let heading = (before != START && (METRIC || list.count > 0)).then(|| paths.direction(before, at));
        if METRIC {
            self.head(before, at, heading);
        }
        if list.count == 0 {
            return;
        }
        let leaving = Leaving { cost, at, before, heading };
        match corners {
            Some(corners) if list != List::ALL => {
                self.offer::<METRIC, R>(paths, corners, &leaving, list);
            }
            _ => {
                self.find_all::<METRIC, R>(paths, &leaving);
                for i in 0..self.hits.len() {
                    self.take_row::<METRIC, R>(paths, corners, &leaving, self.hits[i]);
                }
            }
        }
    }

    /// Offers a way to the cells of a list: first to all, without a branch, as nobody can tell which take it.
    #[inline(always)]
    fn offer<const METRIC: bool, R: Rows>(
        &mut self,
        paths: &Paths<'_>,
        corners: &Corners,
        leaving: &Leaving,
        list: List,
    ) {
        let Self { cost: costs, found, .. } = self;
        if found.len() < list.count as usize + ROW {
            found.resize(2 * (list.count as usize + ROW), 0);
        }
        let count = if METRIC {
            let cost = f64::from(leaving.cost);
            let mut count = 0;
            for (to, i) in corners.by_length(list).iter().zip(0..) {
                found[count] = i;
                count += usize::from(cost + to.length < f64::from(costs[to.slot as usize]));
            }
            count
        } else {
            find_straighter::<R>(costs, corners.by_turn(list), leaving.cost, found)
        };
        for i in 0..count {
            let k = self.found[i] as usize;
            let (slot, way, by) = if METRIC {
                let to = corners.by_length(list)[k];
                (to.slot, to.way, to.length as f32)
            } else {
                let to = corners.by_turn(list)[k];
                (to.slot, to.way, to.turn)
            };
            self.take::<METRIC>(paths, slot, leaving.cost + by, leaving.at, corners.list_to(way));
        }
    }

    /// Takes a better way to a cell.
    #[inline(always)]
    fn take<const METRIC: bool>(
        &mut self,
        paths: &Paths<'_>,
        slot: u32,
        cost: f32,
        before: u32,
        mut list: List,
    ) {
        let at = slot as usize;
        if METRIC && self.cost[at] == cost {
            // Shorter by less than single precision holds: it waits at this cost, and leads at least where it led.
            list = if list.count == 0 { self.arrival[at].list } else { list };
            self.arrival[at] = Arrival { before, list };
            return;
        }
        if !METRIC && cost == 0.0 && paths.turns[at >> 6] >> (at & 63) & 1 == 0 {
            list = List::ALL;
        }
        self.cost[at] = cost;
        self.arrival[at] = Arrival { before, list };
        self.queue.push(paths, cost, slot);
    }

    /// Lists the rows with better ways among all that a cell sees and its predecessor does not.
    #[inline(always)]
    fn find_all<const METRIC: bool, R: Rows>(&mut self, paths: &Paths<'_>, leaving: &Leaving) {
        let (graph, rank) = (paths.graph, paths.rank(leaving.at));
        let known =
            if leaving.before == START { (&[][..], &[][..]) } else { graph.row(paths.rank(leaving.before)) };
        let (tiles, masks) = graph.row(rank);
        let costs: &[[f32; ROW]] = self.cost.as_chunks().0;
        let (mut next, mut place) = (0, 0);
        self.hits.clear();
        for (&tile, &mask) in tiles.iter().zip(masks) {
            let mut bits = mask & self.open[tile as usize] & !known_in(known, tile, &mut next);
            while let Some((row, cells)) = next_row(&mut bits) {
                let first = tile << 6 | row;
                let old = &costs[first as usize / ROW];
                let (new, better) = ways::<METRIC, R>(paths, leaving, first, old);
                if better & cells != 0 {
                    self.hits.push(Hit { first, better: better & cells, costs: new, place, mask });
                }
            }
            place += mask.count_ones();
        }
    }

    #[inline(always)]
    fn take_row<const METRIC: bool, R: Rows>(
        &mut self,
        paths: &Paths<'_>,
        corners: Option<&Corners>,
        leaving: &Leaving,
        hit: Hit,
    ) {
        let mut better = hit.better;
        while better != 0 {
            let i = better.trailing_zeros();
            better &= better - 1;
            let slot = hit.first + i;
            let bit = 1u64 << (slot & 63);
            let list = match corners {
                Some(corners) => {
                    let place = hit.place + (hit.mask & (bit - 1)).count_ones();
                    corners.list_to(corners.first_way(paths.rank(leaving.at)) + place)
                }
                None if paths.turns[slot as usize >> 6] & bit != 0 => List::ALL,
                None => List::NONE,
            };
            self.take::<METRIC>(paths, slot, hit.costs[i as usize & 7], leaving.at, list);
        }
    }

    /// Angle turned on leaving a cell.
    #[inline(always)]
    fn head(&mut self, before: u32, at: u32, heading: Option<f64>) {
        let mut angle = 0.0;
        if let Some(heading) = heading {
            self.heading[at as usize] = heading;
            if self.arrival[before as usize].before != START {
                angle = self.angle[before as usize] + turn(self.heading[before as usize], heading);
            }
        }
        self.angle[at as usize] = angle;
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

/// The costs of a row of eight after a cell, and which are better than the old ones.
#[inline(always)]
fn ways<const METRIC: bool, R: Rows>(
    paths: &Paths<'_>,
    leaving: &Leaving,
    first: u32,
    old: &[f32; ROW],
) -> ([f32; ROW], u32) {
    let mut new = [leaving.cost; ROW];
    if METRIC {
        let lengths = paths.row(&paths.offsets.lengths, leaving.at, first, length_of);
        let mut exact = [f64::from(leaving.cost); ROW];
        for i in 0..ROW {
            exact[i] += lengths[i];
            new[i] += lengths[i] as f32;
        }
        return (new, R::less_wide(&exact, old));
    }
    if let Some(heading) = leaving.heading {
        let directions = paths.row(&paths.offsets.directions, leaving.at, first, direction_of);
        for i in 0..ROW {
            new[i] += turn(heading, directions[i]);
        }
    }
    (new, R::less(&new, old))
}

/// The mask of a tile in a row of the graph, tiles asked for in ascending order.
#[inline(always)]
fn known_in((tiles, masks): (&[u32], &[u64]), tile: u32, next: &mut usize) -> u64 {
    while *next < tiles.len() && tiles[*next] < tile {
        *next += 1;
    }
    if tiles.get(*next) == Some(&tile) { masks[*next] } else { 0 }
}

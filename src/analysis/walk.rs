//! Walks from one cell to all others in the order of their cost: shortest and straightest paths.
//!
//! Costs lie by slot (64 to a tile), so that a row of eight cells of a tile is one register: a cell
//! offers a way to the cells it sees row by row, with lengths and angles from tables whose rows run
//! along the same cells.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::corners::Corners;
use super::graph::Graph;
use super::lanes::Path;
#[cfg(target_arch = "x86_64")]
use super::lanes::x86::Avx2;
use super::lanes::{Portable, ROW, Rows};
use super::paths::Paths;

/// No predecessor.
pub(super) const START: u32 = u32::MAX;

/// Bands of cost to one cell of length, and to one right angle.
const BANDS_PER_CELL: f32 = 2.0;
const BANDS_PER_RIGHT_ANGLE: f32 = 64.0;

/// Bands that are told apart; what costs more waits in the last one.
const BANDS_MAX: usize = 1 << 16;

/// Offsets that are tabulated, at most: 32 MB a table.
const MAX_OFFSETS: i64 = 1 << 22;

/// Length (cells) and direction (right angles from +x, anticlockwise) of every offset between two cells.
pub(super) struct Offsets {
    /// Largest offset each way.
    size: [i32; 2],
    stride: usize,
    /// By row, then column, with room for a row of eight on both sides; empty if there are too many.
    pub lengths: Vec<f64>,
    directions: Vec<f64>,
}

impl Offsets {
    pub fn new(size: [i32; 2]) -> Self {
        let [w, h] = size.map(i64::from);
        let wide = 2 * (w + ROW as i64) + 1;
        let mut new = Self { size, stride: wide as usize, lengths: Vec::new(), directions: Vec::new() };
        if wide.saturating_mul(2 * h + 1) <= MAX_OFFSETS {
            let reach = size[0] + ROW as i32;
            let all = || (-size[1]..=size[1]).flat_map(|y| (-reach..=reach).map(move |x| [x, y]));
            new.lengths = all().map(length_of).collect();
            new.directions = all().map(direction_of).collect();
        }
        new
    }

    #[inline(always)]
    fn at(&self, [x, y]: [i32; 2]) -> usize {
        let [x, y] = [i64::from(x) + i64::from(self.size[0]), i64::from(y) + i64::from(self.size[1])];
        y as usize * self.stride + x as usize + ROW
    }

    #[inline(always)]
    pub fn length(&self, offset: [i32; 2]) -> f64 {
        self.lengths.get(self.at(offset)).copied().unwrap_or_else(|| length_of(offset))
    }

    #[inline(always)]
    pub fn direction(&self, offset: [i32; 2]) -> f64 {
        self.directions.get(self.at(offset)).copied().unwrap_or_else(|| direction_of(offset))
    }

    /// Eight offsets from one on, along x.
    #[inline(always)]
    pub fn row(&self, table: &[f64], offset: [i32; 2], value: fn([i32; 2]) -> f64) -> [f64; ROW] {
        let found = table.get(self.at(offset)..).and_then(|t| t.first_chunk::<ROW>());
        found.copied().unwrap_or_else(|| std::array::from_fn(|i| value([offset[0] + i as i32, offset[1]])))
    }
}

pub(super) fn length_of([x, y]: [i32; 2]) -> f64 {
    let [x, y] = [f64::from(x), f64::from(y)];
    (x * x + y * y).sqrt()
}

fn direction_of([x, y]: [i32; 2]) -> f64 {
    f64::from(y).atan2(f64::from(x)) / std::f64::consts::FRAC_PI_2
}

/// How far a path turns from one direction to another, in right angles.
#[inline(always)]
fn turn(before: f64, after: f64) -> f32 {
    let apart = (after - before).abs();
    let other = 4.0 - apart;
    (if apart < other { apart } else { other }) as f32
}

/// Cost in the bits of a non-negative f32 above the vertex: sorts by cost, then vertex.
pub(super) type Key = u64;

fn cost_of(key: Key) -> f32 {
    f32::from_bits((key >> 32) as u32)
}

/// Cost and vertex of something reached.
pub(super) fn parts(key: Key) -> (f32, u32) {
    (cost_of(key), key as u32)
}

/// Relays in the order of their cost. Only those of the band at hand are sorted; what a better way has
/// overtaken by then is never sorted at all.
#[derive(Default)]
struct Queue {
    /// The band at hand: sorted, up to `at`, and what came to it since.
    now: Vec<Key>,
    at: usize,
    late: BinaryHeap<Reverse<Key>>,
    later: Vec<Vec<Key>>,
    /// Cells that lead nowhere, by the band in which they were reached: closed once it is over.
    others: Vec<Vec<u32>>,
    band: usize,
    /// Bands that hold anything end before this one.
    end: usize,
    bands_per_cost: f32,
}

impl Queue {
    fn clear(&mut self, bands_per_cost: f32) {
        self.now.clear();
        self.late.clear();
        self.later[..self.end].iter_mut().for_each(Vec::clear);
        self.others[..self.end].iter_mut().for_each(Vec::clear);
        (self.at, self.band, self.end, self.bands_per_cost) = (0, 0, 0, bands_per_cost);
    }

    #[inline(always)]
    fn push(&mut self, cost: f32, vertex: u32) {
        let key = u64::from(cost.to_bits()) << 32 | u64::from(vertex);
        let band = self.band_of(cost);
        if band <= self.band {
            self.late.push(Reverse(key));
        } else {
            self.make_room(band);
            self.later[band].push(key);
        }
    }

    /// A cell that leads nowhere was reached.
    #[inline(always)]
    fn push_other(&mut self, cost: f32, slot: u32) {
        let band = self.band_of(cost);
        self.make_room(band);
        self.others[band].push(slot);
    }

    #[inline(always)]
    fn band_of(&self, cost: f32) -> usize {
        ((cost * self.bands_per_cost) as usize).min(BANDS_MAX - 1)
    }

    #[inline(always)]
    fn make_room(&mut self, band: usize) {
        if band >= self.end {
            self.end = band + 1;
            if self.later.len() < self.end {
                self.later.resize_with(self.end, Vec::new);
                self.others.resize_with(self.end, Vec::new);
            }
        }
    }

    /// The cheapest of the band at hand.
    #[inline(always)]
    fn pop(&mut self) -> Option<Key> {
        let sorted = self.now.get(self.at).copied();
        match (sorted, self.late.peek()) {
            (Some(key), late) if late.is_none_or(|l| key < l.0) => {
                self.at += 1;
                Some(key)
            }
            _ => self.late.pop().map(|l| l.0),
        }
    }

    /// Goes on to the next band that holds any relay for which `is_current` holds; `false` at the end.
    /// Closes what leads nowhere and is no dearer than the bands left behind.
    #[inline(always)]
    fn advance(&mut self, costs: &[f32], open: &mut [u64], mut is_current: impl FnMut(Key) -> bool) -> bool {
        self.now.clear();
        self.at = 0;
        while self.now.is_empty() {
            while let Some(slot) = self.others.get_mut(self.band).and_then(Vec::pop) {
                if self.band_of(costs[slot as usize]) <= self.band {
                    open[slot as usize >> 6] &= !(1 << (slot & 63));
                }
            }
            self.band += 1;
            if self.band >= self.end {
                return false;
            }
            let Self { now, later, band, .. } = self;
            now.extend(later[*band].drain(..).filter(|&key| is_current(key)));
        }
        self.now.sort_unstable();
        true
    }
}

/// Buffers of one worker, by slot.
pub(super) struct Walk {
    /// Infinite where there is no way.
    pub cost: Vec<f32>,
    /// The slot before, on the way here.
    before: Vec<u32>,
    /// Angle turned along the metric path, and direction of its last piece, at cells that were left.
    angle: Vec<f32>,
    heading: Vec<f64>,
    /// What is offered from here, see [`Corners`].
    list: Vec<u32>,
    /// Cells that have not been left, by tile.
    open: Vec<u64>,
    queue: Queue,
    /// See [`sort_reached`](Self::sort_reached).
    pub reached: Vec<Key>,
    bins: Vec<u32>,
}

/// First slot of a row of a tile, the cells of it that are meant, and the offset of the first.
type Row = (u32, u32, [i32; 2]);

/// Bins into which what was reached is sorted first.
const BINS: usize = 4096;

impl Walk {
    pub fn new(graph: &Graph) -> Self {
        let slots = graph.tiles.count() * 64;
        Self {
            cost: vec![f32::INFINITY; slots],
            before: vec![START; slots],
            angle: vec![0.0; slots],
            heading: vec![0.0; slots],
            list: vec![0; slots],
            open: Vec::new(),
            queue: Queue::default(),
            reached: Vec::new(),
            bins: Vec::new(),
        }
    }

    /// Shortest paths from some slots, costs in cells. Costs beyond `radius` need not be the lowest.
    /// Corners pay where many roots share them; the lengths are the same up to rounding.
    pub fn metric(&mut self, paths: &Paths<'_>, corners: Option<&Corners>, roots: &[u32], radius: f64) {
        self.walk::<true>(paths, corners, roots, radius);
    }

    /// Straightest paths from some slots, costs in right angles.
    pub fn angular(&mut self, paths: &Paths<'_>, roots: &[u32], radius: f64) {
        self.walk::<false>(paths, None, roots, radius);
    }

    /// Angle turned along the metric path to a slot that was reached, right angles.
    #[inline(always)]
    pub fn turned(&self, paths: &Paths<'_>, slot: u32) -> f32 {
        let from = self.before[slot as usize];
        if from == START || self.before[from as usize] == START {
            return 0.0;
        }
        let heading = paths.offsets.direction(paths.offset(from, slot));
        self.angle[from as usize] + turn(self.heading[from as usize], heading)
    }

    /// Lists what was reached within a radius in `reached`, by cost, then vertex; see [`parts`].
    pub fn sort_reached(&mut self, paths: &Paths<'_>, radius: f64) {
        let mut most = 0f32;
        let mut found = 0;
        for &slot in &paths.slot_of_vertex {
            let cost = self.cost[slot as usize];
            if cost < f32::INFINITY && f64::from(cost) <= radius {
                most = most.max(cost);
                found += 1;
            }
        }
        let per_cost = if most > 0.0 { (BINS - 1) as f32 / most } else { 0.0 };
        self.bins.clear();
        self.bins.resize(BINS + 1, 0);
        let within = |cost: f32| cost < f32::INFINITY && f64::from(cost) <= radius;
        for &slot in &paths.slot_of_vertex {
            let cost = self.cost[slot as usize];
            if within(cost) {
                self.bins[(cost * per_cost) as usize + 1] += 1;
            }
        }
        for bin in 0..BINS {
            self.bins[bin + 1] += self.bins[bin];
        }
        self.reached.clear();
        self.reached.resize(found, 0);
        for (v, &slot) in (0u64..).zip(&paths.slot_of_vertex) {
            let cost = self.cost[slot as usize];
            if within(cost) {
                let at = &mut self.bins[(cost * per_cost) as usize];
                self.reached[*at as usize] = u64::from(cost.to_bits()) << 32 | v;
                *at += 1;
            }
        }
        insertion_sort(&mut self.reached);
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
                let (cost, bit) = (cost_of(key), 1u64 << (at & 63));
                if self.cost[at as usize] != cost || self.open[at as usize >> 6] & bit == 0 {
                    continue;
                }
                if f64::from(cost) > radius {
                    return;
                }
                self.open[at as usize >> 6] &= !bit;
                self.head(paths, at);
                if METRIC {
                    self.leave_metric(paths, corners, cost, at);
                } else {
                    self.leave_angular::<R>(paths, cost, at);
                }
            }
            let Self { cost, open, queue, .. } = self;
            let is_current = |key| cost[paths.slot_of_vertex[key as u32 as usize] as usize] == cost_of(key);
            if !queue.advance(cost, open, is_current) {
                return;
            }
        }
    }

    #[inline(always)]
    fn begin(&mut self, paths: &Paths<'_>, roots: &[u32], bands_per_cost: f32) {
        self.cost.fill(f32::INFINITY);
        self.open.clone_from(&paths.graph.tiles.occupied);
        self.queue.clear(bands_per_cost);
        for &root in roots {
            self.cost[root as usize] = 0.0;
            self.before[root as usize] = START;
            self.queue.push(0.0, paths.vertex_of_slot[root as usize]);
        }
    }

    /// Direction and angle on leaving a cell.
    #[inline(always)]
    fn head(&mut self, paths: &Paths<'_>, at: u32) {
        self.angle[at as usize] = self.turned(paths, at);
        let from = self.before[at as usize];
        if from != START {
            self.heading[at as usize] = paths.offsets.direction(paths.offset(from, at));
        }
    }

    /// Offers a way through `at` to those cells to which the way there leads on; without corners to all
    /// that it sees and its predecessor does not: the straight way there is no longer.
    #[inline(always)]
    fn leave_metric(&mut self, paths: &Paths<'_>, corners: Option<&Corners>, cost: f32, at: u32) {
        let (graph, rank, from) = (paths.graph, paths.rank(at), self.before[at as usize]);
        let list = corners.filter(|_| from != START).map(|c| c.list(self.list[at as usize]));
        let (tiles, masks) = list.map_or_else(|| graph.row(rank), |l| (l.tiles, l.masks));
        let known = if from == START || corners.is_some() { NOTHING } else { graph.row(paths.rank(from)) };
        let [x, y] = paths.cell(at);
        let mut next = 0;
        for (i, (&t, &mask)) in tiles.iter().zip(masks).enumerate() {
            let mut bits = mask & self.open[t as usize] & !known_in(known, t, &mut next);
            if bits == 0 {
                continue;
            }
            let entry = list.map_or(graph.start[rank] + i, |l| l.entries[i] as usize);
            let (live, first_list) = corners.map_or((paths.turns[t as usize], 0), |c| c.live(entry));
            let [tx, ty] = graph.tiles.tile_at[t as usize].map(|c| c as i32 * ROW as i32);
            while bits != 0 {
                let bit = bits.trailing_zeros();
                bits &= bits - 1;
                let slot = t << 6 | bit;
                let apart = paths.offsets.length([tx + (bit & 7) as i32 - x, ty + (bit >> 3) as i32 - y]);
                if f64::from(cost) + apart < f64::from(self.cost[slot as usize]) {
                    let new = cost + apart as f32;
                    self.cost[slot as usize] = new;
                    self.before[slot as usize] = at;
                    if live >> bit & 1 == 1 {
                        self.list[slot as usize] = first_list + (live & ((1 << bit) - 1)).count_ones();
                        self.queue.push(new, paths.vertex_of_slot[slot as usize]);
                    }
                }
            }
        }
    }

    /// Offers a way through `at` to the cells it sees. Those its predecessor sees as well are passed
    /// over: the way there without the detour turns no more.
    #[inline(always)]
    fn leave_angular<R: Rows>(&mut self, paths: &Paths<'_>, cost: f32, at: u32) {
        let graph = paths.graph;
        let from = self.before[at as usize];
        let known = if from == START { NOTHING } else { graph.row(paths.rank(from)) };
        let heading = (from != START).then(|| self.heading[at as usize]);
        let [x, y] = paths.cell(at);
        let (tiles, masks) = graph.row(paths.rank(at));
        let mut next = 0;
        for (&t, &mask) in tiles.iter().zip(masks) {
            let mut bits = mask & self.open[t as usize] & !known_in(known, t, &mut next);
            let [tx, ty] = graph.tiles.tile_at[t as usize].map(|c| c as i32 * ROW as i32);
            while bits != 0 {
                let row = bits.trailing_zeros() & !7;
                let some = (bits >> row) as u32 & 0xff;
                bits &= !(0xff << row);
                let offset = [tx - x, ty - y + (row / 8) as i32];
                self.offer_turn::<R>(paths, cost, at, (t << 6 | row, some, offset), heading);
            }
        }
    }

    #[inline(always)]
    fn offer_turn<R: Rows>(
        &mut self,
        paths: &Paths<'_>,
        cost: f32,
        at: u32,
        (first, some, offset): Row,
        heading: Option<f64>,
    ) {
        let Some(old) = self.cost.get(first as usize..).and_then(|c| c.first_chunk::<ROW>()) else { return };
        let mut better = R::less(&[cost; ROW], old) & some;
        if better == 0 {
            return;
        }
        let mut new = [cost; ROW];
        if let Some(heading) = heading {
            let directions = paths.offsets.row(&paths.offsets.directions, offset, direction_of);
            for i in 0..ROW {
                new[i] = cost + turn(heading, directions[i]);
            }
            better &= R::less(&new, old);
        }
        while better != 0 {
            let bit = better.trailing_zeros();
            better &= better - 1;
            let (slot, cost) = (first + bit, new[bit as usize]);
            self.cost[slot as usize] = cost;
            self.before[slot as usize] = at;
            if cost == 0.0 || paths.turns[slot as usize >> 6] >> (slot & 63) & 1 == 1 {
                self.queue.push(cost, paths.vertex_of_slot[slot as usize]);
            } else {
                self.queue.push_other(cost, slot);
            }
        }
    }
}

/// An empty row of the graph.
const NOTHING: (&[u32], &[u64]) = (&[], &[]);

/// The mask of a tile in a row of the graph, tiles asked for in ascending order.
#[inline(always)]
pub(super) fn known_in((tiles, masks): (&[u32], &[u64]), tile: u32, next: &mut usize) -> u64 {
    while *next < tiles.len() && tiles[*next] < tile {
        *next += 1;
    }
    if tiles.get(*next) == Some(&tile) { masks[*next] } else { 0 }
}

/// Sorts what is almost in order.
fn insertion_sort(keys: &mut [Key]) {
    for i in 1..keys.len() {
        let key = keys[i];
        let mut at = i;
        while at > 0 && keys[at - 1] > key {
            keys[at] = keys[at - 1];
            at -= 1;
        }
        keys[at] = key;
    }
}

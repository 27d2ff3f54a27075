//! Straightest paths from one cell to all others, in the order of their turns.
//!
//! Costs lie by slot (64 to a tile), so that a row of eight cells of a tile is one register, with directions from a
//! table whose rows run along the same cells. A row is looked at only if its worst cell could be reached with less.

use super::lanes::Path;
#[cfg(target_arch = "x86_64")]
use super::lanes::x86::Avx2;
use super::lanes::{Portable, ROW, Rows, known_in, next_row};
use super::offsets::{direction_of, turn};
use super::onward::Onward;
use super::paths::Paths;
use super::queue::{Queue, cost_of};

/// Bands of cost to one right angle.
const BANDS_PER_RIGHT_ANGLE: f32 = 32.0;

/// Less than any cost: nothing is offered to a cell that has it.
const NOWHERE: f32 = -1.0;

/// How a cell was reached: the slot before, which is a root's own, and the graph's entry there for the cell's tile.
#[derive(Clone, Copy)]
struct Arrival {
    before: u32,
    entry: u32,
}

/// Buffers of one worker, by slot.
pub(super) struct Straightest {
    /// Right angles; infinite or negative where there is no way.
    pub cost: Vec<f32>,
    arrival: Vec<Arrival>,
    /// The highest cost of each row of eight.
    worst: Vec<f32>,
    queue: Queue,
    /// Costs and worst costs before anything is reached.
    unreached: (Vec<f32>, Vec<f32>),
}

/// A cell that is left: its cost, its slot, and the direction in which it was reached, if it was.
struct Leaving {
    cost: f32,
    at: u32,
    heading: Option<f64>,
}

impl Straightest {
    pub fn new(paths: &Paths<'_>) -> Self {
        let graph = paths.graph;
        let mut cost = vec![NOWHERE; graph.tiles.count() * 64];
        for rank in (0..graph.len()).filter(|&rank| graph.degree[rank] > 0) {
            let (tile, bit) = graph.tiles.slot_of[rank];
            cost[(tile as usize) << 6 | usize::from(bit)] = f32::INFINITY;
        }
        let worst: Vec<f32> = cost.as_chunks().0.iter().map(worst_of).collect();
        Self {
            arrival: vec![Arrival { before: 0, entry: 0 }; cost.len()],
            queue: Queue::default(),
            cost: cost.clone(),
            worst: worst.clone(),
            unreached: (cost, worst),
        }
    }

    /// Walks from some slots; costs beyond `radius` need not be the lowest. `onward` pays where many roots share it.
    pub fn walk(&mut self, paths: &Paths<'_>, onward: Option<&Onward>, roots: &[u32], radius: f64) {
        match paths.path {
            // SAFETY: a path is only made for a processor that has its instructions.
            #[cfg(target_arch = "x86_64")]
            #[allow(unsafe_code)]
            Path::Avx512 => unsafe { self.walk_avx512(paths, onward, roots, radius) },
            #[cfg(target_arch = "x86_64")]
            #[allow(unsafe_code)]
            Path::Avx2 => unsafe { self.walk_avx2(paths, onward, roots, radius) },
            Path::Portable => self.walk_in::<Portable>(paths, onward, roots, radius),
        }
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx512f,avx512dq,avx2,popcnt,bmi1,bmi2")]
    fn walk_avx512(&mut self, paths: &Paths<'_>, onward: Option<&Onward>, roots: &[u32], radius: f64) {
        self.walk_in::<Avx2>(paths, onward, roots, radius);
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,popcnt,bmi1,bmi2")]
    fn walk_avx2(&mut self, paths: &Paths<'_>, onward: Option<&Onward>, roots: &[u32], radius: f64) {
        self.walk_in::<Avx2>(paths, onward, roots, radius);
    }

    #[inline(always)]
    fn walk_in<R: Rows>(&mut self, paths: &Paths<'_>, onward: Option<&Onward>, roots: &[u32], radius: f64) {
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
                self.leave::<R>(paths, onward, cost, at);
            }
            if !self.queue.advance(paths, &self.cost) {
                return;
            }
        }
    }

    fn begin(&mut self, paths: &Paths<'_>, roots: &[u32]) {
        self.cost.copy_from_slice(&self.unreached.0);
        self.worst.copy_from_slice(&self.unreached.1);
        self.queue.clear(BANDS_PER_RIGHT_ANGLE);
        for &root in roots {
            if self.cost[root as usize] != 0.0 {
                self.cost[root as usize] = 0.0;
                self.arrival[root as usize] = Arrival { before: root, entry: 0 };
                self.queue.push(paths, 0.0, root);
            }
        }
    }

    /// Offers a way through `at` to all that it sees and its predecessor does not: the straight way there turns no more.
    #[inline(always)]
    fn leave<R: Rows>(&mut self, paths: &Paths<'_>, onward: Option<&Onward>, cost: f32, at: u32) {
        let Arrival { before, entry } = self.arrival[at as usize];
        let before = (before != at).then_some(before);
        let heading = before.map(|before| paths.direction(before, at));
        let leaving = Leaving { cost, at, heading };
        match onward {
            Some(onward) if before.is_some() && paths.may_turn(at) => {
                let way = onward.way(paths, entry, at & 63);
                for lead in onward.beyond(way) {
                    self.offer::<R>(paths, &leaving, lead.entry, lead.cells, lead.least);
                }
            }
            _ => self.offer_all::<R>(paths, &leaving, before),
        }
    }

    #[inline(always)]
    fn offer_all<R: Rows>(&mut self, paths: &Paths<'_>, leaving: &Leaving, before: Option<u32>) {
        let (graph, rank) = (paths.graph, paths.rank(leaving.at));
        let known = before.map_or((&[][..], &[][..]), |before| graph.row(paths.rank(before)));
        let (tiles, masks) = graph.row(rank);
        let mut next = 0;
        for ((&tile, &mask), entry) in tiles.iter().zip(masks).zip(graph.start[rank] as u32..) {
            let cells = mask & !known_in(known, tile, &mut next);
            self.offer::<R>(paths, leaving, entry, cells, 0.0);
        }
    }

    /// Offers a way to some cells of a tile, which turns by at least so much.
    #[inline(always)]
    fn offer<R: Rows>(&mut self, paths: &Paths<'_>, leaving: &Leaving, entry: u32, cells: u64, least: f32) {
        let tile = paths.graph.entry_tile[entry as usize];
        let worst = &self.worst.as_chunks::<ROW>().0[tile as usize];
        let rows = R::less(&[leaving.cost + least; ROW], worst);
        let mut bits = cells & R::rows(rows);
        while let Some((row, some)) = next_row(&mut bits) {
            self.offer_row::<R>(paths, leaving, entry, tile << 6 | row, some);
        }
    }

    #[inline(always)]
    fn offer_row<R: Rows>(
        &mut self,
        paths: &Paths<'_>,
        leaving: &Leaving,
        entry: u32,
        first: u32,
        some: u32,
    ) {
        let mut new = [leaving.cost; ROW];
        if let Some(heading) = leaving.heading {
            let directions = paths.row(&paths.offsets.directions, leaving.at, first, direction_of);
            for i in 0..ROW {
                new[i] += turn(heading, directions[i]);
            }
        }
        let row = first as usize / ROW;
        let old = &mut self.cost.as_chunks_mut::<ROW>().0[row];
        let better = R::less(&new, old) & some;
        if better == 0 {
            return;
        }
        for i in 0..ROW {
            old[i] = if better >> i & 1 == 1 { new[i] } else { old[i] };
        }
        self.worst[row] = worst_of(old);
        let may_turn = (paths.turns[first as usize >> 6] >> (first & 63)) as u32;
        let mut bits = better;
        while bits != 0 {
            let i = bits.trailing_zeros();
            bits &= bits - 1;
            let (slot, cost) = (first + i, new[i as usize & 7]);
            self.arrival[slot as usize] = Arrival { before: leaving.at, entry };
            // Straight ahead paths go on anywhere.
            if may_turn >> i & 1 == 1 || cost == 0.0 {
                self.queue.push(paths, cost, slot);
            }
        }
    }
}

#[inline(always)]
fn worst_of(row: &[f32; ROW]) -> f32 {
    row.iter().fold(NOWHERE, |worst, &cost| if cost > worst { cost } else { worst })
}

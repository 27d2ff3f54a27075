//! Shortest paths from sixteen roots beside each other at once, one root a lane.
//!
//! The ways of such roots share nearly all their corners. A corner that is left offers the cells of its lists to all lanes.
//! A cell notes who offers, and asks all of them when its turn comes: what it costs in each lane then is what the walk
//! from one root would find. Corners whose cost or list changes after they were left are left anew, until none does.

#![allow(
    clippy::needless_range_loop,
    reason = "lanes of several rows are counted together: so they become vectors"
)]

use super::corners::{Away, Corners, NONE};
use super::lanes::{Least, Offer, ROW, Rows, walk_by_rows};
use super::paths::Paths;
use super::queue::{Queue, cost_of, key};

/// Roots that are walked at once.
pub(super) const ROOTS: usize = 16;

/// Bands of cost to one cell of length.
const BANDS_PER_CELL: f32 = 1.0;

/// Costs that differ by a smaller part may be ties, which are decided as one root would: above what rounding does.
const TIED: f32 = 1.0 + 1.0 / (1 << 20) as f32;

/// A corner that is left for some root is left for all to whom it costs at most so many cells more: neighbours. For others,
/// behind a wall, what is known of it then is far from the end.
const APART_CELLS: f32 = 8.0;

/// Rows of eight roots.
const HALVES: usize = ROOTS / ROW;

/// One value a root.
type Each<T> = [[T; ROW]; HALVES];

/// How a cell is reached, by root: cost in cells, the slot before, and the number of the list of what is offered from here.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
struct Reach {
    cost: Each<f32>,
    list: Each<u32>,
    before: Each<u32>,
}

const UNREACHED: Reach = Reach {
    cost: [[f32::INFINITY; ROW]; HALVES],
    list: [[NONE; ROW]; HALVES],
    before: [[u32::MAX; ROW]; HALVES],
};

/// How far a cell is from a root, and the slot before it on the way.
#[derive(Clone, Copy)]
pub(super) struct Way {
    pub cost: f32,
    pub before: u32,
}

/// What a corner that was left offers with: these are read most.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
struct Left {
    cost: Each<f32>,
    list: Each<u32>,
}

/// How far a cell has come.
#[derive(Clone, Copy, PartialEq)]
enum Stage {
    Untouched,
    Waited,
    Left,
}

/// An offer, and the one before it to the same cell.
#[derive(Clone, Copy)]
struct Offered {
    offer: Offer,
    next: u32,
}

/// Buffers of one worker, by slot.
pub(super) struct Bundle {
    roots: Vec<u32>,
    left: Vec<Left>,
    /// By slot, of one root after another.
    ways: Vec<Way>,
    /// The slots before corners that were left.
    before: Vec<Each<u32>>,
    /// At most what a corner that waits will cost.
    near: Vec<Each<f32>>,
    /// At which cost a corner waits; infinite where it does not.
    waits: Vec<f32>,
    stage: Vec<Stage>,
    /// The last offer.
    offers: Vec<u32>,
    all: Vec<Offered>,
    /// Straight ways from roots, and their places.
    seen: Vec<u32>,
    straight: Vec<Reach>,
    /// The round in which lists were offered.
    offered: Vec<u32>,
    round: u32,
    queue: Queue,
    /// The highest cost of what is reached.
    highest: Each<f32>,
    /// By tile, and then one by one.
    touched: Vec<u64>,
    reached: Vec<u32>,
    ties: Vec<(u64, Offer)>,
}

/// A corner whose turn it is, and at which cost.
#[derive(Clone, Copy)]
struct Turn {
    at: u32,
    cost: f32,
}

/// What a list offers: its number, costs before its first cell, and whether it did before. News is nothing for a root to
/// which the corner is new, infinite for others.
struct Leaving {
    at: u32,
    list: u32,
    cost: Each<f32>,
    news: Each<f32>,
    anew: bool,
}

impl Reach {
    /// What is left up to a cost, or was left before, and the next cost above it.
    #[inline(always)]
    fn left_at(&self, most: f32, old: &Left) -> (Left, f32) {
        let mut left = Left { cost: self.cost, list: self.list };
        let mut later = [f32::INFINITY; ROW];
        for half in 0..HALVES {
            for i in 0..ROW {
                let cost = self.cost[half][i];
                let is_late = cost > most && old.cost[half][i] == f32::INFINITY;
                left.cost[half][i] = if is_late { f32::INFINITY } else { cost };
                left.list[half][i] = if is_late { NONE } else { self.list[half][i] };
                later[i] = if is_late && cost < later[i] { cost } else { later[i] };
            }
        }
        (left, lowest(later))
    }
}

impl Bundle {
    pub fn new(paths: &Paths<'_>, corners: &Corners<Away>) -> Self {
        let slots = paths.vertex_of_slot.len();
        Self {
            roots: Vec::new(),
            left: vec![Left { cost: UNREACHED.cost, list: UNREACHED.list }; slots],
            ways: vec![Way { cost: f32::INFINITY, before: u32::MAX }; stride(slots) * ROOTS],
            before: vec![UNREACHED.before; slots],
            near: vec![UNREACHED.cost; slots],
            waits: vec![f32::INFINITY; slots],
            stage: vec![Stage::Untouched; slots],
            offers: vec![u32::MAX; slots],
            all: Vec::new(),
            seen: vec![u32::MAX; slots],
            straight: Vec::new(),
            offered: vec![0; corners.lists()],
            round: 0,
            queue: Queue::default(),
            highest: [[0.0; ROW]; HALVES],
            touched: vec![0; slots / 64],
            reached: Vec::new(),
            ties: Vec::new(),
        }
    }

    /// The slots that some root reaches, in any order.
    pub fn reached(&self) -> &[u32] {
        &self.reached
    }

    /// The ways from a root to every slot that is reached.
    pub fn ways(&self, root: usize) -> &[Way] {
        let slots = self.offers.len();
        &self.ways[root * stride(slots)..][..slots]
    }

    /// At least what anything that a root reaches costs.
    pub fn highest(&self, root: usize) -> f32 {
        self.highest[root / ROW][root % ROW]
    }

    walk_by_rows!(
        /// Walks from up to sixteen slots; costs beyond `radius` need not be the lowest.
        corners: &Corners<Away>, roots: &[u32], radius: f64
    );

    #[inline(always)]
    fn walk_in<R: Rows>(&mut self, paths: &Paths<'_>, corners: &Corners<Away>, roots: &[u32], radius: f64) {
        self.begin();
        self.roots.extend(roots.iter().take(ROOTS));
        for root in 0..self.roots.len() {
            self.look_around(paths, corners, root);
        }
        loop {
            while let Some(key) = self.queue.pop() {
                let at = paths.slot_of_vertex[key as u32 as usize];
                let cost = cost_of(key);
                if self.waits[at as usize] == cost {
                    self.waits[at as usize] = f32::INFINITY;
                    if f64::from(cost) <= radius {
                        self.leave::<R>(paths, corners, Turn { at, cost });
                    }
                }
            }
            if !self.queue.advance(paths, &self.waits) {
                break;
            }
        }
        self.end::<R>(paths);
    }

    /// Asks for the ways to all cells that do not lead on, and notes all, in the order of their slots.
    #[inline(always)]
    fn end<R: Rows>(&mut self, paths: &Paths<'_>) {
        for tile in 0..self.touched.len() {
            let mut bits = std::mem::take(&mut self.touched[tile]);
            while bits != 0 {
                let slot = (tile as u32) << 6 | bits.trailing_zeros();
                bits &= bits - 1;
                self.reached.push(slot);
                if self.stage[slot as usize] == Stage::Left {
                    let (costs, before) = (self.left[slot as usize].cost, self.before[slot as usize]);
                    self.note(slot, &costs, &before);
                } else {
                    let reach = self.best::<R>(paths, slot);
                    self.note(slot, &reach.cost, &reach.before);
                }
            }
        }
    }

    /// Notes how a slot is reached, root by root.
    #[inline(always)]
    fn note(&mut self, slot: u32, costs: &Each<f32>, before: &Each<u32>) {
        for (highest, costs) in self.highest.iter_mut().zip(costs) {
            for i in 0..ROW {
                let cost = if costs[i] < f32::INFINITY { costs[i] } else { 0.0 };
                highest[i] = if cost > highest[i] { cost } else { highest[i] };
            }
        }
        let stride = stride(self.offers.len());
        let ways = costs.as_flattened().iter().zip(before.as_flattened());
        for (of_root, (&cost, &before)) in self.ways.chunks_exact_mut(stride).zip(ways) {
            of_root[slot as usize] = Way { cost, before };
        }
    }

    fn begin(&mut self) {
        for &slot in &self.reached {
            let at = slot as usize;
            self.stage[at] = Stage::Untouched;
            self.offers[at] = u32::MAX;
            self.seen[at] = u32::MAX;
        }
        self.reached.clear();
        self.all.clear();
        self.straight.clear();
        self.roots.clear();
        self.queue.clear(BANDS_PER_CELL);
        self.highest = [[0.0; ROW]; HALVES];
        self.round += 1;
    }

    /// Straight ways from a root.
    #[inline(always)]
    fn look_around(&mut self, paths: &Paths<'_>, corners: &Corners<Away>, root: usize) {
        let at = self.roots[root];
        let own = self.straight_to(at);
        let (half, lane) = (root / ROW, root % ROW);
        (own.cost[half][lane], own.before[half][lane]) = (0.0, at);
        let rank = paths.rank(at);
        let (tiles, masks) = paths.graph.row(rank);
        let mut place = 0;
        for (&tile, &mask) in tiles.iter().zip(masks) {
            let mut bits = mask;
            while bits != 0 {
                let slot = tile << 6 | bits.trailing_zeros();
                bits &= bits - 1;
                let (cost, list) = (paths.single(at, slot), corners.number_of(rank, place));
                place += 1;
                let way = self.straight_to(slot);
                (way.cost[half][lane], way.before[half][lane], way.list[half][lane]) = (cost, at, list);
                if list != NONE {
                    self.near(slot)[half][lane] = cost;
                    self.wait(paths, slot, cost);
                }
            }
        }
    }

    #[inline(always)]
    fn straight_to(&mut self, slot: u32) -> &mut Reach {
        let mut place = self.seen[slot as usize] as usize;
        if place >= self.straight.len() {
            place = self.straight.len();
            self.seen[slot as usize] = place as u32;
            self.straight.push(UNREACHED);
            self.touched[slot as usize >> 6] |= 1 << (slot & 63);
        }
        &mut self.straight[place]
    }

    #[inline(always)]
    fn near(&mut self, slot: u32) -> &mut Each<f32> {
        let (stage, near) = (&mut self.stage[slot as usize], &mut self.near[slot as usize]);
        if *stage == Stage::Untouched {
            (*stage, *near) = (Stage::Waited, UNREACHED.cost);
        }
        near
    }

    #[inline(always)]
    fn wait(&mut self, paths: &Paths<'_>, slot: u32, cost: f32) {
        if cost < self.waits[slot as usize] {
            self.waits[slot as usize] = cost;
            self.queue.push(paths, cost, slot);
        }
    }

    /// Finds how a corner is reached, and offers ways through it to those to whom that is news.
    #[inline(always)]
    fn leave<R: Rows>(&mut self, paths: &Paths<'_>, corners: &Corners<Away>, turn: Turn) {
        let at = turn.at as usize;
        let now = self.best::<R>(paths, turn.at);
        self.before[at] = now.before;
        self.near[at] = now.cost;
        let anew = std::mem::replace(&mut self.stage[at], Stage::Left) == Stage::Left;
        let nothing = Left { cost: UNREACHED.cost, list: UNREACHED.list };
        let old = if anew { self.left[at] } else { nothing };
        let (left, later) = now.left_at(turn.cost + APART_CELLS, &old);
        self.left[at] = left;
        if later < f32::INFINITY {
            self.wait(paths, turn.at, later);
        }
        let mut news = UNREACHED.cost;
        for half in 0..HALVES {
            for i in 0..ROW {
                let is_cost = old.cost[half][i] == left.cost[half][i];
                let is_same = is_cost & (old.list[half][i] == left.list[half][i]);
                news[half][i] = if is_same { f32::INFINITY } else { 0.0 };
            }
        }
        if news == UNREACHED.cost {
            return;
        }
        if anew {
            self.offer_lists::<R>(paths, corners, &old.list, &left, (turn.at, &news, true));
        }
        self.offer_lists::<R>(paths, corners, &left.list, &left, (turn.at, &news, anew));
    }

    /// Offers every one of some lists once.
    #[inline(always)]
    fn offer_lists<R: Rows>(
        &mut self,
        paths: &Paths<'_>,
        corners: &Corners<Away>,
        lists: &Each<u32>,
        now: &Left,
        (at, news, anew): (u32, &Each<f32>, bool),
    ) {
        let mut left = !same::<R>(lists, NONE) & ALL;
        while left != 0 {
            let list = lists.as_flattened()[left.trailing_zeros() as usize & (ROOTS - 1)];
            left &= !same::<R>(lists, list);
            let mut cost = UNREACHED.cost;
            for half in 0..HALVES {
                for i in 0..ROW {
                    let is_made = now.list[half][i] == list;
                    cost[half][i] = news[half][i] + if is_made { now.cost[half][i] } else { f32::INFINITY };
                }
            }
            self.offer_list::<R>(paths, corners, &Leaving { at, list, cost, news: *news, anew });
        }
    }

    #[inline(always)]
    fn offer_list<R: Rows>(&mut self, paths: &Paths<'_>, corners: &Corners<Away>, leaving: &Leaving) {
        let cells = corners.cells(corners.list(leaving.list));
        if self.offered[leaving.list as usize] != self.round {
            self.offered[leaving.list as usize] = self.round;
            for to in cells {
                let slot = to.slot as usize;
                self.touched[slot >> 6] |= 1 << (slot & 63);
                let next = std::mem::replace(&mut self.offers[slot], self.all.len() as u32);
                let (by, of, length, list) = (leaving.at, leaving.list, to.length, to.list);
                self.all.push(Offered { offer: Offer { by, of, length, list }, next });
            }
        }
        for to in cells {
            let is_left = self.stage[to.slot as usize] == Stage::Left;
            if to.list != NONE || is_left {
                self.tell::<R>(paths, leaving, to, is_left && leaving.anew);
            }
        }
    }

    /// Has a corner wait if an offer is better than what it has, or may be a tie.
    #[inline(always)]
    fn tell<R: Rows>(&mut self, paths: &Paths<'_>, leaving: &Leaving, to: &Away, anyway: bool) {
        let near = self.near(to.slot);
        let length = to.length;
        let (mut new, mut limit) = (leaving.cost, *near);
        for half in 0..HALVES {
            for i in 0..ROW {
                new[half][i] += length;
                limit[half][i] *= TIED;
            }
        }
        if !anyway && less::<R>(&new, &limit) == 0 {
            return;
        }
        let mut low = [f32::INFINITY; ROW];
        for half in 0..HALVES {
            for i in 0..ROW {
                let (old, new) = (near[half][i], new[half][i]);
                near[half][i] = if new < old { new } else { old };
                let told = if new < limit[half][i] { new } else { f32::INFINITY };
                let known = if anyway { old + leaving.news[half][i] } else { f32::INFINITY };
                let from = if told < known { told } else { known };
                low[i] = if from < low[i] { from } else { low[i] };
            }
        }
        self.wait(paths, to.slot, lowest(low));
    }

    /// The best of all offers to a cell.
    #[inline(always)]
    fn best<R: Rows>(&mut self, paths: &Paths<'_>, slot: u32) -> Reach {
        let straight = self.straight.get(self.seen[slot as usize] as usize).unwrap_or(&UNREACHED);
        let mut least: [Least; HALVES] = std::array::from_fn(|half| Least {
            cost: straight.cost[half],
            second: [f32::INFINITY; ROW],
            by: straight.before[half],
            list: straight.list[half],
        });
        let mut next = self.offers[slot as usize];
        while let Some(&Offered { offer, next: before }) = self.all.get(next as usize) {
            next = before;
            let by = &self.left[offer.by as usize];
            for half in 0..HALVES {
                R::take_in(&mut least[half], &by.cost[half], &by.list[half], offer);
            }
        }
        let mut best = UNREACHED;
        let (mut second, mut limit) = (UNREACHED.cost, UNREACHED.cost);
        for half in 0..HALVES {
            best.cost[half] = least[half].cost;
            best.before[half] = least[half].by;
            best.list[half] = least[half].list;
            second[half] = least[half].second;
            for i in 0..ROW {
                limit[half][i] = least[half].cost[i] * TIED;
            }
        }
        // Where both are infinite neither is less.
        let mut tied = less::<R>(&second, &limit);
        while tied != 0 {
            self.untie(paths, slot, tied.trailing_zeros() as usize & (ROOTS - 1), &mut best);
            tied &= tied - 1;
        }
        best
    }

    /// Decides between offers of nearly the same cost as one root does: they come in the order in which corners are left.
    #[inline(never)]
    fn untie(&mut self, paths: &Paths<'_>, slot: u32, root: usize, best: &mut Reach) {
        let (half, lane) = (root / ROW, root % ROW);
        let limit = best.cost[half][lane] * TIED;
        self.ties.clear();
        let mut next = self.offers[slot as usize];
        while let Some(&Offered { offer, next: before }) = self.all.get(next as usize) {
            next = before;
            let by = &self.left[offer.by as usize];
            let cost = by.cost[half][lane];
            if by.list[half][lane] == offer.of && cost + offer.length < limit {
                self.ties.push((key(paths, cost, offer.by), offer));
            }
        }
        self.ties.sort_unstable_by_key(|tie| tie.0);
        let straight = self.straight.get(self.seen[slot as usize] as usize).unwrap_or(&UNREACHED);
        let (mut cost, mut before, mut list) =
            (straight.cost[half][lane], straight.before[half][lane], straight.list[half][lane]);
        for (key, offer) in &self.ties {
            let start = cost_of(*key);
            if f64::from(start) + paths.length(offer.by, slot) < f64::from(cost) {
                let new = start + offer.length;
                // Shorter by less than single precision holds: it leads at least where it led.
                let keeps = new == cost && offer.list == NONE;
                list = if keeps { list } else { offer.list };
                (cost, before) = (new, offer.by);
            }
        }
        (best.cost[half][lane], best.before[half][lane], best.list[half][lane]) = (cost, before, list);
    }
}

/// From the values of one root to those of the next: what is noted together falls into different sets of a cache.
const fn stride(slots: usize) -> usize {
    slots + 24
}

/// One bit a root.
const ALL: u32 = (1 << ROOTS) - 1;

/// The roots with less in the first.
#[inline(always)]
fn less<R: Rows>(a: &Each<f32>, b: &Each<f32>) -> u32 {
    R::less(&a[0], &b[0]) | R::less(&a[1], &b[1]) << ROW
}

/// The roots with this list.
#[inline(always)]
fn same<R: Rows>(lists: &Each<u32>, list: u32) -> u32 {
    R::same(&lists[0], list) | R::same(&lists[1], list) << ROW
}

#[inline(always)]
fn lowest(mut of: [f32; ROW]) -> f32 {
    for width in [4, 2, 1] {
        for i in 0..width {
            of[i] = if of[i + width] < of[i] { of[i + width] } else { of[i] };
        }
    }
    of[0]
}

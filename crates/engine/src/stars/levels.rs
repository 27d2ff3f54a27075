//! The cells of every tile by their steps from a leader.

use super::super::graph::{Graph, for_each_bit};

/// Groups of cells of one tile on one level, tile by tile, ascending.
#[derive(Default)]
pub struct Levels {
    pub tiles: Vec<Head>,
    /// Cells of each group.
    pub cells: Vec<u64>,
}

/// The groups of a tile: bit `i` of `present` is level `lowest + i`. The cells of a tile are joined by sight within
/// the tile, so that 64 levels are enough.
#[derive(Clone, Copy, Default)]
pub struct Head {
    pub first: u32,
    pub lowest: u32,
    pub present: u64,
}

impl Head {
    /// The group of a level, or `none`; without a branch, as nobody can tell which tiles have it.
    #[inline(always)]
    pub fn group(&self, level: u32, none: usize) -> usize {
        let by = level.wrapping_sub(self.lowest);
        let bit = 1u64 << (by & 63);
        let is_there = (by < 64) & (self.present & bit != 0);
        let at = self.first as usize + (self.present & (bit - 1)).count_ones() as usize;
        std::hint::select_unpredictable(is_there, at, none)
    }

    /// Levels and groups.
    #[inline(always)]
    pub fn groups(self) -> impl Iterator<Item = (u32, usize)> {
        let mut left = self.present;
        (self.first as usize..self.first as usize + left.count_ones() as usize).map(move |group| {
            let level = self.lowest + left.trailing_zeros();
            left &= left - 1;
            (level, group)
        })
    }

    fn highest(self) -> u32 {
        self.lowest + 63 - self.present.leading_zeros()
    }
}

impl Levels {
    /// Levels from one rank, or nothing if they are more than `levels_max`.
    pub fn from(graph: &Graph, leader: u32, levels_max: u32) -> Option<Self> {
        let tiles = graph.tiles.count();
        let mut unseen = graph.tiles.occupied.clone();
        let [mut front, mut next] = [vec![0u64; tiles], vec![0u64; tiles]];
        let (tile, bit) = graph.tiles.slot_of[leader as usize];
        front[tile as usize] = 1 << bit;
        unseen[tile as usize] &= !(1 << bit);
        let mut groups = Vec::new();
        let (mut now, mut then) = (vec![tile], Vec::new());
        let mut level = 0;
        while !now.is_empty() {
            if level > levels_max {
                return None;
            }
            for t in now.drain(..) {
                let cells = std::mem::take(&mut front[t as usize]);
                groups.push((t, level, cells));
                for_each_bit(cells, |bit| {
                    let (tiles, masks) = graph.row(graph.tiles.rank(t, bit));
                    for (&to, &mask) in tiles.iter().zip(masks) {
                        let new = mask & unseen[to as usize];
                        if new != 0 {
                            unseen[to as usize] &= !new;
                            if next[to as usize] == 0 {
                                then.push(to);
                            }
                            next[to as usize] |= new;
                        }
                    }
                });
            }
            level += 1;
            std::mem::swap(&mut now, &mut then);
            std::mem::swap(&mut front, &mut next);
        }
        groups.sort_unstable();
        let mut new = Self { tiles: vec![Head::default(); tiles], cells: Vec::with_capacity(groups.len()) };
        groups.into_iter().for_each(|(t, level, cells)| new.push(t as usize, level, cells));
        Some(new)
    }

    /// Adds a group: tile by tile, ascending.
    #[inline(always)]
    pub fn push(&mut self, tile: usize, level: u32, cells: u64) {
        let head = &mut self.tiles[tile];
        if head.present == 0 {
            *head = Head { first: self.cells.len() as u32, lowest: level, present: 0 };
        }
        head.present |= 1 << (level - head.lowest);
        self.cells.push(cells);
    }

    /// Adds the groups of a tile, `by` less one levels farther.
    #[inline(always)]
    pub fn push_shifted(&mut self, tile: usize, of: &Self, by: u32) {
        let head = of.tiles[tile];
        let groups = head.first as usize..head.first as usize + head.present.count_ones() as usize;
        let first = self.cells.len() as u32;
        self.tiles[tile] = Head { first, lowest: head.lowest + by - 1, present: head.present };
        self.cells.extend_from_slice(&of.cells[groups]);
    }
}

/// Groups by level.
#[derive(Default)]
pub struct Order {
    /// Tile and group.
    pub groups: Vec<(u32, u32)>,
    /// First of each level in `groups`, one more.
    pub start: Vec<u32>,
    /// Cells of each level.
    pub totals: Vec<u32>,
}

impl Order {
    pub fn fill(&mut self, levels: &Levels) {
        let Self { groups, start, totals } = self;
        let reached = || levels.tiles.iter().filter(|head| head.present != 0);
        let count = reached().map(|head| head.highest() as usize + 1).max().unwrap_or(0);
        start.clear();
        start.resize(count + 1, 0);
        totals.clear();
        totals.resize(count, 0);
        for (level, group) in reached().flat_map(|head| head.groups()) {
            start[level as usize] += 1;
            totals[level as usize] += levels.cells[group].count_ones();
        }
        let mut sum = 0;
        for start in start.iter_mut() {
            sum += *start;
            *start = sum;
        }
        groups.resize(levels.cells.len(), (0, 0));
        for (tile, head) in levels.tiles.iter().enumerate().rev() {
            for (level, group) in head.groups() {
                let at = &mut start[level as usize];
                *at -= 1;
                groups[*at as usize] = (tile as u32, group as u32);
            }
        }
    }
}

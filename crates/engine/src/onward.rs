//! Where straightest paths can lead on: for every first piece of a way, what its end sees and its start does not.
//!
//! These cells lie by tile, with the least turn to any of them. How a cell is reached depends on the order in which cells
//! are left, so none can be passed over; but a tile whose cells have all been reached with less than that turn can.

use rayon::prelude::*;

use super::lanes::{ROW, next_row};
use super::offsets::{direction_of, turn};
use super::paths::Paths;

/// Tiles that all lists may hold: 50 MB.
pub(super) const TILES_MAX: usize = 3 << 20;

/// Ranks whose lists are made before they join those of others.
const BLOCK: usize = 1024;

/// Lists of one vertex after another, for all neighbours in the order of the graph. Only those where paths may turn have
/// any tiles.
#[derive(Default)]
pub(super) struct Onward {
    /// Number of the first way of each entry of the graph.
    first: Vec<u32>,
    /// Where the list of each way ends.
    end: Vec<u32>,
    tiles: Vec<Lead>,
}

/// Some cells of a tile beyond a way.
#[derive(Clone, Copy)]
pub(super) struct Lead {
    pub cells: u64,
    /// The entry of the graph, of the way's end to the tile.
    pub entry: u32,
    /// The least turn to any of the cells, right angles.
    pub least: f32,
}

impl Onward {
    /// The lists of all ways, unless they would hold more than `most` tiles.
    pub fn new(paths: &Paths<'_>, most: usize) -> Option<Self> {
        let graph = paths.graph;
        let mut all = Self::default();
        let mut ways = 0u32;
        for mask in &graph.entry_mask {
            all.first.push(ways);
            ways = ways.checked_add(mask.count_ones())?;
        }
        u32::try_from(graph.entry_mask.len()).ok()?;
        let most = most.min(u32::MAX as usize);
        for block in (0..graph.len()).step_by(BLOCK) {
            let ranks = block..graph.len().min(block + BLOCK);
            let own = || vec![0; graph.tiles.count()];
            let parts: Vec<Self> =
                ranks.into_par_iter().map_init(own, |own, rank| Self::of_rank(paths, own, rank)).collect();
            let tiles = parts.iter().map(|part| part.tiles.len()).sum::<usize>();
            if all.tiles.len() + tiles > most {
                return None;
            }
            for part in parts {
                let before = all.tiles.len() as u32;
                all.end.extend(part.end.iter().map(|end| end + before));
                all.tiles.extend(part.tiles);
            }
        }
        Some(all)
    }

    /// The lists of one rank; `own` is empty, and stays so.
    fn of_rank(paths: &Paths<'_>, own: &mut [u64], rank: usize) -> Self {
        let (tiles, masks) = paths.graph.row(rank);
        let (own_tile, own_bit) = paths.graph.tiles.slot_of[rank];
        tiles.iter().zip(masks).for_each(|(&t, &mask)| own[t as usize] = mask);
        own[own_tile as usize] |= 1 << own_bit;
        let from = own_tile << 6 | u32::from(own_bit);
        let mut part = Self::default();
        for (&t, &mask) in tiles.iter().zip(masks) {
            let mut bits = mask;
            while bits != 0 {
                let bit = bits.trailing_zeros();
                bits &= bits - 1;
                if paths.turns[t as usize] >> bit & 1 == 1 {
                    part.add(paths, own, from, t << 6 | bit);
                }
                part.end.push(part.tiles.len() as u32);
            }
        }
        tiles.iter().for_each(|&t| own[t as usize] = 0);
        own[own_tile as usize] = 0;
        part
    }

    fn add(&mut self, paths: &Paths<'_>, own: &[u64], from: u32, via: u32) {
        let heading = paths.direction(from, via);
        let rank = paths.rank(via);
        let (tiles, masks) = paths.graph.row(rank);
        for ((&tile, &mask), entry) in tiles.iter().zip(masks).zip(paths.graph.start[rank] as u32..) {
            let cells = mask & !own[tile as usize];
            let (mut bits, mut least) = (cells, f32::INFINITY);
            while let Some((row, some)) = next_row(&mut bits) {
                let directions = paths.row(&paths.offsets.directions, via, tile << 6 | row, direction_of);
                for i in 0..ROW {
                    let turn = if some >> i & 1 == 1 { turn(heading, directions[i]) } else { f32::INFINITY };
                    least = if turn < least { turn } else { least };
                }
            }
            if cells != 0 {
                self.tiles.push(Lead { cells, entry, least });
            }
        }
    }

    #[cfg(test)]
    pub fn tiles(&self) -> usize {
        self.tiles.len()
    }

    /// The number of a way: its entry of the graph, and which of the entry's cells it leads to.
    #[inline(always)]
    pub fn way(&self, paths: &Paths<'_>, entry: u32, bit: u32) -> u32 {
        let before = paths.graph.entry_mask[entry as usize] & ((1 << bit) - 1);
        self.first[entry as usize] + before.count_ones()
    }

    /// What a way leads on to.
    #[inline(always)]
    pub fn beyond(&self, way: u32) -> &[Lead] {
        let start = if way == 0 { 0 } else { self.end[way as usize - 1] };
        &self.tiles[start as usize..self.end[way as usize] as usize]
    }
}

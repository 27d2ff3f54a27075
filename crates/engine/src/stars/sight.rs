//! Which cells of one tile see which of another.

use std::cmp::Reverse;

use super::super::graph::{Graph, for_each_bit};

/// Row `i`: the cells of another tile that the cell at bit `i` sees. Cache lines, so that eight rows are one load.
#[derive(Clone, Copy)]
#[repr(C, align(64))]
pub struct Square(pub [u64; 64]);

/// A tile that cells of another see.
#[derive(Clone, Copy)]
pub struct Near {
    pub tile: u32,
    /// Number of the square, or [`Near::ALL`].
    pub square: u32,
    /// What any cell sees of it.
    pub any: u64,
}

impl Near {
    /// Every cell that sees anything sees all.
    pub const ALL: u32 = u32::MAX;
}

/// See the module page.
pub struct Sight {
    /// First entry of each tile in `near`, one more.
    pub start: Vec<u32>,
    /// Tiles seen, of which most is seen first.
    pub near: Vec<Near>,
    pub squares: Vec<Square>,
}

impl Sight {
    pub fn new(graph: &Graph) -> Self {
        let count = graph.tiles.count();
        let mut new = Self { start: vec![0], near: Vec::new(), squares: Vec::new() };
        let mut sums = vec![0u32; count];
        let mut places = vec![0u32; count];
        let mut met = Vec::new();
        for t in 0..count {
            let ranks = graph.tiles.first_rank[t] as usize..graph.tiles.first_rank[t + 1] as usize;
            for rank in ranks.clone() {
                let (tiles, masks) = graph.row(rank);
                for (&to, mask) in tiles.iter().zip(masks) {
                    if sums[to as usize] == 0 {
                        met.push(to);
                    }
                    sums[to as usize] += mask.count_ones();
                }
            }
            met.sort_unstable_by_key(|&to| (Reverse(sums[to as usize]), to));
            let first = new.squares.len();
            for (i, &to) in met.iter().enumerate() {
                sums[to as usize] = 0;
                places[to as usize] = (first + i) as u32;
                new.squares.push(Square([0; 64]));
            }
            let mut seeing = 0u64;
            for rank in ranks {
                let bit = graph.tiles.slot_of[rank].1;
                seeing |= u64::from(graph.degree[rank] > 0) << bit;
                let (tiles, masks) = graph.row(rank);
                for (&to, &mask) in tiles.iter().zip(masks) {
                    // A cell may be read as seeing itself: what reaches it on a level has reached it on that level.
                    let own = if to as usize == t { 1 << bit } else { 0 };
                    new.squares[places[to as usize] as usize].0[usize::from(bit)] = mask | own;
                }
            }
            let mut kept = first;
            for (i, to) in met.drain(..).enumerate() {
                let square = new.squares[first + i];
                let (mut any, mut all) = (0, true);
                for_each_bit(seeing, |bit| {
                    any |= square.0[bit as usize];
                    all &= square.0[bit as usize] == graph.tiles.occupied[to as usize];
                });
                new.near.push(Near { tile: to, square: if all { Near::ALL } else { kept as u32 }, any });
                if !all {
                    new.squares[kept] = square;
                    kept += 1;
                }
            }
            new.squares.truncate(kept);
            new.start.push(new.near.len() as u32);
        }
        new
    }

    /// The tiles that cells of a tile see.
    #[inline(always)]
    pub fn of(&self, tile: usize) -> &[Near] {
        &self.near[self.start[tile] as usize..self.start[tile + 1] as usize]
    }
}

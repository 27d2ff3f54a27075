//! Where shortest paths turn: for every first piece of a way, the cells to which its end leads on.
//!
//! On a shortest path any two pieces in a row are the shortest way of two pieces between their ends, and
//! their ends do not see each other. For every vertex `a` and every cell `t` that it sees and where paths
//! may turn, a list holds the cells `v` for which `a → t → v` is such a way. Few `t` have any: those at
//! the corners of walls. Ways as short as the best up to [`TIED_CELLS`] are all kept: rounding may
//! yet choose another of several equally short paths than without these lists.

use rayon::prelude::*;

use super::lanes::Path;
#[cfg(target_arch = "x86_64")]
use super::lanes::x86::Avx2;
use super::lanes::{Portable, ROW, Rows};
use super::paths::Paths;
use super::walk::{known_in, length_of};

/// Ways that differ by less count as equally long, cells: above what single precision adds up to.
const TIED_CELLS: f32 = 1e-3;

/// Lists of one vertex after another. A list is named by its number.
#[derive(Default)]
pub(super) struct Corners {
    /// For every entry of the rows of the graph: cells that lead on, and the list of the first of them.
    live: Vec<u64>,
    first_list: Vec<u32>,
    /// First entry of each list; one more than lists.
    start: Vec<u32>,
    tile: Vec<u32>,
    mask: Vec<u64>,
    /// Place of the tile among the entries of the graph's row of the cell that leads there.
    entry: Vec<u32>,
}

/// Cells to which a cell leads, as a part of its row in the graph.
#[derive(Clone, Copy)]
pub(super) struct List<'a> {
    pub tiles: &'a [u32],
    pub masks: &'a [u64],
    pub entries: &'a [u32],
}

/// What one worker needs: the shortest way of two pieces by slot, and the tiles where there is any.
struct Scratch {
    best: Vec<f32>,
    touched: Vec<u32>,
}

/// One row of eight cells beyond a relay: the first slot, the cells meant, and the ways there.
type Beyond = (u32, u32, [f32; ROW]);

impl Corners {
    pub fn new(paths: &Paths<'_>) -> Self {
        let graph = paths.graph;
        let scratch = || Scratch { best: vec![f32::INFINITY; graph.tiles.count() * 64], touched: Vec::new() };
        let of_rank = |scratch: &mut Scratch, rank: usize| scratch.corners_of(paths, rank);
        let parts: Vec<Self> = (0..graph.len()).into_par_iter().map_init(scratch, of_rank).collect();
        let mut all = Self { start: vec![0], ..Self::default() };
        for part in parts {
            let (lists, entries) = (all.start.len() as u32 - 1, all.tile.len() as u32);
            all.live.extend(part.live);
            all.first_list.extend(part.first_list.iter().map(|l| l + lists));
            all.start.extend(part.start.iter().map(|s| s + entries));
            all.tile.extend(part.tile);
            all.mask.extend(part.mask);
            all.entry.extend(part.entry);
        }
        all
    }

    #[inline(always)]
    pub fn list(&self, list: u32) -> List<'_> {
        let range = self.start[list as usize] as usize..self.start[list as usize + 1] as usize;
        List {
            tiles: &self.tile[range.clone()],
            masks: &self.mask[range.clone()],
            entries: &self.entry[range],
        }
    }

    /// Cells of an entry of the graph that lead on, and the list of the first of them.
    #[inline(always)]
    pub fn live(&self, entry: usize) -> (u64, u32) {
        (self.live[entry], self.first_list[entry])
    }
}

impl Scratch {
    /// The lists of one rank, numbered from 0; `start` holds their ends.
    fn corners_of(&mut self, paths: &Paths<'_>, rank: usize) -> Corners {
        match paths.path {
            // SAFETY: a path is only made for a processor that has its instructions.
            #[cfg(target_arch = "x86_64")]
            #[allow(unsafe_code)]
            Path::Avx512 => unsafe { self.corners_of_avx512(paths, rank) },
            #[cfg(target_arch = "x86_64")]
            #[allow(unsafe_code)]
            Path::Avx2 => unsafe { self.corners_of_avx2(paths, rank) },
            Path::Portable => self.corners_of_in::<Portable>(paths, rank),
        }
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx512f,avx512dq,avx2,popcnt,bmi1,bmi2")]
    fn corners_of_avx512(&mut self, paths: &Paths<'_>, rank: usize) -> Corners {
        self.corners_of_in::<Avx2>(paths, rank)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,popcnt,bmi1,bmi2")]
    fn corners_of_avx2(&mut self, paths: &Paths<'_>, rank: usize) -> Corners {
        self.corners_of_in::<Avx2>(paths, rank)
    }

    #[inline(always)]
    fn corners_of_in<R: Rows>(&mut self, paths: &Paths<'_>, rank: usize) -> Corners {
        let mut corners = Corners::default();
        let (tiles, masks) = paths.graph.row(rank);
        for (&t, &mask) in tiles.iter().zip(masks) {
            let mut bits = mask & paths.turns[t as usize];
            while bits != 0 {
                self.measure(paths, rank, t << 6 | bits.trailing_zeros());
                bits &= bits - 1;
            }
        }
        for (&t, &mask) in tiles.iter().zip(masks) {
            corners.first_list.push(corners.start.len() as u32);
            let mut live = 0;
            let mut bits = mask & paths.turns[t as usize];
            while bits != 0 {
                let bit = bits.trailing_zeros();
                bits &= bits - 1;
                live |= u64::from(self.add_list::<R>(paths, rank, t << 6 | bit, &mut corners)) << bit;
            }
            corners.live.push(live);
        }
        for tile in self.touched.drain(..) {
            self.best[tile as usize * 64..][..64].fill(f32::INFINITY);
        }
        corners
    }

    /// Lowers `best` to the ways over `via`.
    #[inline(always)]
    fn measure(&mut self, paths: &Paths<'_>, rank: usize, via: u32) {
        let mut beyond = Rest::new(paths, rank, via);
        while let Some((tile, _, bits)) = beyond.next_tile() {
            self.touched.push(tile);
            let mut bits = bits;
            while let Some((first, some, ways)) = beyond.next_row(paths, tile, &mut bits) {
                let Some(best) = self.best.get_mut(first as usize..).and_then(|b| b.first_chunk_mut::<ROW>())
                else {
                    continue;
                };
                for i in 0..ROW {
                    let way = if some >> i & 1 == 1 { ways[i] } else { f32::INFINITY };
                    best[i] = if way < best[i] { way } else { best[i] };
                }
            }
        }
    }

    /// Whether there is any cell to which `via` leads; they become the next list.
    #[inline(always)]
    fn add_list<R: Rows>(&self, paths: &Paths<'_>, rank: usize, via: u32, corners: &mut Corners) -> bool {
        let before = corners.tile.len();
        let mut beyond = Rest::new(paths, rank, via);
        while let Some((tile, entry, bits)) = beyond.next_tile() {
            let mut bits = bits;
            let mut chosen = 0u64;
            while let Some((first, some, ways)) = beyond.next_row(paths, tile, &mut bits) {
                let best = self.best.get(first as usize..).and_then(|b| b.first_chunk::<ROW>());
                let limit = best.map_or([0.0; ROW], |b| b.map(|b| b + TIED_CELLS));
                chosen |= u64::from(R::less(&ways, &limit) & some) << (first & 63);
            }
            if chosen != 0 {
                corners.tile.push(tile);
                corners.mask.push(chosen);
                corners.entry.push(entry);
            }
        }
        let any = corners.tile.len() > before;
        if any {
            corners.start.push(corners.tile.len() as u32);
        }
        any
    }
}

/// Goes through the cells that `via` sees and `rank` does not.
struct Rest<'a> {
    known: (&'a [u32], &'a [u64]),
    next: usize,
    row: (&'a [u32], &'a [u64]),
    entry: usize,
    start: usize,
    own: (u32, u64),
    /// Cells to `via`, and where it is.
    first: f32,
    at: [i32; 2],
}

impl<'a> Rest<'a> {
    #[inline(always)]
    fn new(paths: &Paths<'a>, rank: usize, via: u32) -> Self {
        let (tile, bit) = paths.graph.tiles.slot_of[rank];
        let via_rank = paths.rank(via);
        Self {
            known: paths.graph.row(rank),
            next: 0,
            row: paths.graph.row(via_rank),
            entry: 0,
            start: paths.graph.start[via_rank],
            own: (tile, 1 << bit),
            first: paths.offsets.length(paths.offset(tile << 6 | u32::from(bit), via)) as f32,
            at: paths.cell(via),
        }
    }

    /// The next tile with any, its entry in the graph, and the cells.
    #[inline(always)]
    fn next_tile(&mut self) -> Option<(u32, u32, u64)> {
        while self.entry < self.row.0.len() {
            let (tile, mask) = (self.row.0[self.entry], self.row.1[self.entry]);
            let itself = if tile == self.own.0 { self.own.1 } else { 0 };
            let bits = mask & !itself & !known_in(self.known, tile, &mut self.next);
            self.entry += 1;
            if bits != 0 {
                return Some((tile, (self.start + self.entry - 1) as u32, bits));
            }
        }
        None
    }

    /// The next row of `bits`, which are taken off.
    #[inline(always)]
    fn next_row(&self, paths: &Paths<'_>, tile: u32, bits: &mut u64) -> Option<Beyond> {
        if *bits == 0 {
            return None;
        }
        let row = bits.trailing_zeros() & !7;
        let some = (*bits >> row) as u32 & 0xff;
        *bits &= !(0xff << row);
        let [tx, ty] = paths.graph.tiles.tile_at[tile as usize].map(|c| c as i32 * ROW as i32);
        let offset = [tx - self.at[0], ty - self.at[1] + (row / 8) as i32];
        let lengths = paths.offsets.row(&paths.offsets.lengths, offset, length_of);
        let mut ways = [0.0; ROW];
        for i in 0..ROW {
            ways[i] = self.first + lengths[i] as f32;
        }
        Some((tile << 6 | row, some, ways))
    }
}

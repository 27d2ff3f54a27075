//! Half of what is seen, and the whole from it: sight is mutual, so only rows upwards are swept.

use super::graph::RowChunk;
use super::lanes::transpose;
use super::tiles::Tiles;

/// The cells of one tile that each of the 64 viewers of another sees.
type Square = [u64; 64];

/// What the viewers of one tile see on their own rows and above: one square for every tile seen.
#[derive(Default)]
pub(super) struct Half {
    /// Tiles seen, ascending, and the place of their square.
    tiles: Vec<(u32, u32)>,
    squares: Vec<Square>,
}

impl Half {
    /// Adds cells of a tile to what the viewer at a bit sees. `places` holds `u32::MAX` for every tile that the
    /// half does not have yet.
    #[inline(always)]
    pub fn add(&mut self, places: &mut [u32], viewer: u8, tile: u32, mask: u64) {
        let mut place = places[tile as usize];
        if place == u32::MAX {
            place = self.squares.len() as u32;
            places[tile as usize] = place;
            self.tiles.push((tile, place));
            self.squares.push([0; 64]);
        }
        self.squares[place as usize][usize::from(viewer & 63)] = mask;
    }

    /// Squares, and rows of them that are not empty.
    pub fn sizes(&self) -> [u64; 2] {
        let rows = self.squares.iter().flatten().filter(|row| **row != 0).count();
        [self.squares.len() as u64, rows as u64]
    }

    /// Sorts the tiles and takes them off `places`.
    pub fn finish(&mut self, places: &mut [u32]) {
        self.tiles.sort_unstable();
        for &(tile, _) in &self.tiles {
            places[tile as usize] = u32::MAX;
        }
    }
}

/// The halves of all tiles, and for each tile the halves that see it.
pub(super) struct Halves<'a> {
    tiles: &'a Tiles,
    halves: Vec<Half>,
    /// Tile and place of the square, ascending, by tile seen; with offsets.
    seen_by: Vec<(u32, u32)>,
    start: Vec<usize>,
}

impl<'a> Halves<'a> {
    /// `halves` are those of the tiles in their order.
    pub fn new(tiles: &'a Tiles, halves: Vec<Half>) -> Self {
        let mut start = vec![0; tiles.count() + 1];
        let seen = || halves.iter().flat_map(|half| &half.tiles);
        seen().for_each(|&(tile, _)| start[tile as usize + 1] += 1);
        for t in 0..tiles.count() {
            start[t + 1] += start[t];
        }
        let mut next = start.clone();
        let mut seen_by = vec![(0, 0); seen().count()];
        for (by, half) in (0u32..).zip(&halves) {
            for &(tile, place) in &half.tiles {
                seen_by[next[tile as usize]] = (by, place);
                next[tile as usize] += 1;
            }
        }
        Self { tiles, halves, seen_by, start }
    }

    /// Whole rows of the viewers of a tile. `squares` is a buffer.
    pub fn rows(&self, t: usize, squares: &mut Vec<(u32, Square)>) -> RowChunk {
        #[cfg(target_arch = "x86_64")]
        if is_x86_feature_detected!("avx2") && is_x86_feature_detected!("popcnt") {
            // SAFETY: the processor has just been asked.
            #[allow(unsafe_code)]
            return unsafe { self.rows_avx2(t, squares) };
        }
        self.rows_in(t, squares)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,popcnt")]
    fn rows_avx2(&self, t: usize, squares: &mut Vec<(u32, Square)>) -> RowChunk {
        self.rows_in(t, squares)
    }

    #[inline(always)]
    fn rows_in(&self, t: usize, squares: &mut Vec<(u32, Square)>) -> RowChunk {
        self.complete(t, squares);
        let mut chunk = RowChunk::default();
        let mut viewers = self.tiles.occupied[t];
        while viewers != 0 {
            let viewer = viewers.trailing_zeros() as usize;
            viewers &= viewers - 1;
            let (before, mut degree) = (chunk.tile.len(), 0);
            for (tile, square) in squares.iter() {
                let mask = square[viewer & 63];
                if mask != 0 {
                    chunk.tile.push(*tile);
                    chunk.mask.push(mask);
                    degree += mask.count_ones();
                }
            }
            chunk.rows.push(((chunk.tile.len() - before) as u32, degree));
        }
        chunk
    }

    /// The squares of all tiles that a tile sees: its own half and, turned over, what the others have of it.
    #[inline(always)]
    fn complete(&self, t: usize, squares: &mut Vec<(u32, Square)>) {
        squares.clear();
        let half = &self.halves[t];
        let mut own = half.tiles.iter().peekable();
        for &(by, place) in &self.seen_by[self.start[t]..self.start[t + 1]] {
            while let Some((tile, own_place)) = own.next_if(|o| o.0 < by) {
                squares.push((*tile, half.squares[*own_place as usize]));
            }
            let mut square = self.halves[by as usize].squares[place as usize];
            transpose(&mut square);
            if let Some((_, own_place)) = own.next_if(|o| o.0 == by) {
                let own_square = &half.squares[*own_place as usize];
                square.iter_mut().zip(own_square).for_each(|(mask, own)| *mask |= own);
            }
            squares.push((by, square));
        }
        squares.extend(own.map(|(tile, place)| (*tile, half.squares[*place as usize])));
    }
}

//! Vertices in tiles of 8 × 8 cells, tiles along a Hilbert curve: the numbering in which the graph is
//! stored and walked. A vertex is a *rank* (its place along the curve) or a bit of its tile's mask.

use super::Lattice;

/// Marks a tile of the bounding box that holds no vertex.
pub(super) const NO_TILE: u32 = u32::MAX;

/// Largest bounding box, in tiles, that is tabulated: so many times the vertices, plus [`GRID_FLOOR`].
/// A lattice sparser than that (two regions many kilometres apart) is compared pair by pair.
const GRID_TILES_PER_VERTEX: usize = 16;

/// See [`GRID_TILES_PER_VERTEX`].
const GRID_FLOOR: usize = 1 << 22;

/// The tiling of a lattice. Tile rows and columns count from the lower left vertex.
#[derive(Clone, Debug, Default)]
pub(super) struct Tiles {
    /// Smallest column and row of any vertex.
    pub min_cell: [i64; 2],
    /// Columns and rows of the bounding box, in cells.
    pub size_cells: [usize; 2],
    /// Columns and rows of the bounding box, in tiles.
    pub size_tiles: [usize; 2],
    /// Tile number at `row * size_tiles[0] + column`, or [`NO_TILE`]; empty if the box is too large.
    pub grid: Vec<u32>,
    /// Which of a tile's 64 cells are vertices; bit `8 * row + column`.
    pub occupied: Vec<u64>,
    /// Column and row of each tile.
    pub tile_at: Vec<[u32; 2]>,
    /// Rank of a tile's first vertex; one more entry than tiles.
    pub first_rank: Vec<u32>,
    /// Vertex of each rank.
    pub vertex_of: Vec<u32>,
    /// Rank of each vertex.
    pub rank_of: Vec<u32>,
    /// Tile and bit of each rank.
    pub slot_of: Vec<(u32, u8)>,
}

impl Tiles {
    /// Tiles of all vertices of `lattice`.
    pub fn new(lattice: &Lattice) -> Self {
        let cells = &lattice.cells;
        if cells.is_empty() {
            return Self { first_rank: vec![0], ..Self::default() };
        }
        let extreme = |k: usize, max: bool| {
            let values = cells.iter().map(|c| i64::from(c[k]));
            (if max { values.max() } else { values.min() }).unwrap_or(0)
        };
        let min_cell = [extreme(0, false), extreme(1, false)];
        let size_cells = [0, 1].map(|k| (extreme(k, true) - min_cell[k] + 1) as usize);
        let size_tiles = size_cells.map(|n| n.div_ceil(8));
        let mut tiles = Self { min_cell, size_cells, size_tiles, ..Self::default() };
        tiles.number(cells);
        tiles
    }

    /// Tiles the bounding box holds.
    pub fn count(&self) -> usize {
        self.occupied.len()
    }

    /// Column and row from the lower left vertex.
    pub fn local(&self, cell: [i32; 2]) -> [usize; 2] {
        [0, 1].map(|k| (i64::from(cell[k]) - self.min_cell[k]) as usize)
    }

    /// Rank of the vertex at a bit of a tile, which must be occupied.
    #[inline(always)]
    pub fn rank(&self, tile: u32, bit: u32) -> usize {
        let before = self.occupied[tile as usize] & ((1u64 << bit) - 1);
        self.first_rank[tile as usize] as usize + before.count_ones() as usize
    }

    /// The tile that holds a cell of the box, if any vertex lies in it and the box is tabulated.
    pub fn tile_with(&self, [column, row]: [i64; 2]) -> Option<u32> {
        let [tw, th] = self.size_tiles;
        if column < 0 || row < 0 || column as usize >= tw * 8 || row as usize >= th * 8 {
            return None;
        }
        let tile = *self.grid.get((row as usize >> 3) * tw + (column as usize >> 3))?;
        (tile != NO_TILE).then_some(tile)
    }

    fn number(&mut self, cells: &[[i32; 2]]) {
        let side = self.size_tiles[0].max(self.size_tiles[1]).next_power_of_two() as u64;
        let mut order: Vec<(u64, u8, u32)> = Vec::with_capacity(cells.len());
        for (v, &cell) in cells.iter().enumerate() {
            let [c, r] = self.local(cell);
            let bit = ((r & 7) << 3 | (c & 7)) as u8;
            order.push((hilbert(side, (c >> 3) as u64, (r >> 3) as u64), bit, v as u32));
        }
        order.sort_unstable();
        let [tw, th] = self.size_tiles;
        let limit = GRID_TILES_PER_VERTEX * cells.len() + GRID_FLOOR;
        if tw.checked_mul(th).is_some_and(|n| n <= limit) {
            self.grid = vec![NO_TILE; tw * th];
        }
        self.rank_of = vec![0; cells.len()];
        let mut last_key = None;
        for (rank, &(key, bit, v)) in order.iter().enumerate() {
            if last_key != Some(key) {
                last_key = Some(key);
                let [c, r] = self.local(cells[v as usize]);
                if !self.grid.is_empty() {
                    self.grid[(r >> 3) * tw + (c >> 3)] = self.occupied.len() as u32;
                }
                self.occupied.push(0);
                self.tile_at.push([(c >> 3) as u32, (r >> 3) as u32]);
                self.first_rank.push(rank as u32);
            }
            let tile = self.occupied.len() - 1;
            self.occupied[tile] |= 1 << bit;
            self.vertex_of.push(v);
            self.rank_of[v as usize] = rank as u32;
            self.slot_of.push((tile as u32, bit));
        }
        self.first_rank.push(cells.len() as u32);
    }
}

/// Place of `(x, y)` along the Hilbert curve through a square of `side` (a power of two).
fn hilbert(side: u64, mut x: u64, mut y: u64) -> u64 {
    let mut d = 0;
    let mut s = side / 2;
    while s > 0 {
        let rx = u64::from(x & s > 0);
        let ry = u64::from(y & s > 0);
        d += s * s * ((3 * rx) ^ ry);
        if ry == 0 {
            if rx == 1 {
                x = (side - 1) - x;
                y = (side - 1) - y;
            }
            std::mem::swap(&mut x, &mut y);
        }
        s /= 2;
    }
    d
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hilbert_neighbours_are_adjacent() {
        let mut at = vec![(0i64, 0i64); 256];
        for x in 0..16 {
            for y in 0..16 {
                at[hilbert(16, x, y) as usize] = (x as i64, y as i64);
            }
        }
        for w in at.windows(2) {
            assert_eq!((w[0].0 - w[1].0).abs() + (w[0].1 - w[1].1).abs(), 1);
        }
    }

    #[test]
    fn ranks_and_slots_agree() {
        let cells: Vec<[i32; 2]> = (-20..20)
            .flat_map(|c| (-9..11).map(move |r| [c, r]))
            .filter(|c| (c[0] + c[1]) % 3 != 0)
            .collect();
        let lattice = Lattice {
            spacing_um: 10,
            origin_um: [0, 0],
            query: vec![],
            is_reference: vec![false; cells.len()],
            beyond: None,
            cells,
        };
        let tiles = Tiles::new(&lattice);
        for v in 0..lattice.cells.len() {
            let rank = tiles.rank_of[v] as usize;
            assert_eq!(tiles.vertex_of[rank] as usize, v);
            let (tile, bit) = tiles.slot_of[rank];
            assert_eq!(tiles.rank(tile, u32::from(bit)), rank);
            let [c, r] = tiles.local(lattice.cells[v]);
            assert_eq!(tiles.grid[(r >> 3) * tiles.size_tiles[0] + (c >> 3)], tile);
        }
    }
}

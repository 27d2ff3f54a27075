//! A visibility graph as the card reads it: squares, in blocks of tiles that fit into its buffers.

use std::cmp::Reverse;

use wgpu::Buffer;

use super::shape::{Extent, SQUARE};
use super::{Gpu, Params};
use crate::graph::Graph;

/// Words of a tile's head; `HEAD` in `shaders/params.wgsl`, which says what they are.
const HEAD: usize = 14;

/// Where the masks of a square's eight viewers stand; `EACH`.
const EACH: usize = 2;

/// The squares of some consecutive tiles.
pub(super) struct Block {
    first_tile: u32,
    pub tiles: u32,
    pub squares: u32,
    squares_at: u32,
    /// Heads, tiles seen by tiles, tiles and viewers of squares.
    pub rows: Buffer,
    /// What is seen, by square.
    pub seen: Buffer,
}

impl Block {
    /// What a dispatch over this block begins with.
    pub fn params(&self, of: Params) -> Params {
        Params {
            first_tile: self.first_tile,
            block_tiles: self.tiles,
            squares: self.squares,
            squares_at: self.squares_at,
            ..of
        }
    }

    fn upload(gpu: &Gpu, first_tile: usize, parts: &Parts) -> Self {
        let pairs: Vec<u32> = parts.squares.iter().flatten().copied().collect();
        let rows = gpu.buffer((parts.rows.len() + pairs.len()) as u64);
        gpu.write(&rows, &[&parts.rows[..], &pairs].concat());
        let seen = gpu.buffer(parts.seen.len() as u64 * 2);
        gpu.write(&seen, &parts.seen);
        Self {
            first_tile: first_tile as u32,
            tiles: parts.tiles,
            squares: parts.squares.len() as u32,
            squares_at: parts.rows.len() as u32,
            rows,
            seen,
        }
    }
}

/// Uploads a graph in blocks of at most `bytes_max` bytes a buffer; what decides how its work is cut, the roots left out.
///
/// # Errors
/// A tile sees more than a buffer holds.
pub(super) fn upload(gpu: &Gpu, graph: &Graph, bytes_max: u64) -> Result<(Vec<Block>, Extent), String> {
    let count = graph.tiles.count();
    let mut extent = Extent { tiles: count as u32, ..Extent::default() };
    let (mut blocks, mut first) = (Vec::new(), 0);
    let mut builder = Builder { graph, places: vec![usize::MAX; count] };
    while first < count {
        let mut end = first;
        let mut entries = 0;
        while end < count {
            entries += entries_of(graph, end);
            // A row of cells has a square at most for each entry of its cells.
            if end > first && 8 * (SQUARE * entries) as u64 > bytes_max {
                break;
            }
            end += 1;
        }
        let parts = builder.parts(first, end);
        if parts.seen.len() as u64 * 8 > bytes_max {
            return Err("a tile of 64 cells sees more than a buffer of the card holds".into());
        }
        extent.squares = extent.squares.max(parts.squares.len() as u64);
        extent.row = extent.row.max(parts.row);
        extent.near = extent.near.max(parts.near);
        blocks.push(Block::upload(gpu, first, &parts));
        first = end;
    }
    Ok((blocks, extent))
}

fn entries_of(graph: &Graph, tile: usize) -> usize {
    let [from, to] = [tile, tile + 1].map(|t| graph.start[graph.tiles.first_rank[t] as usize]);
    to - from
}

/// A block before it is uploaded.
#[derive(Default)]
struct Parts {
    tiles: u32,
    /// Heads and tiles seen by tiles.
    rows: Vec<u32>,
    /// Tile seen and viewers of each square. A row of cells begins with the tiles of which it sees most: they bring most of
    /// what is missing.
    squares: Vec<[u32; 2]>,
    seen: Vec<u64>,
    /// Squares of a row, and tiles seen by a tile, at most.
    row: u32,
    near: u32,
}

struct Builder<'a> {
    graph: &'a Graph,
    /// Places in a list, by tile; the largest number between lists.
    places: Vec<usize>,
}

impl Builder<'_> {
    fn parts(&mut self, first: usize, end: usize) -> Parts {
        let tiles = &self.graph.tiles;
        let mut parts = Parts { tiles: (end - first) as u32, ..Parts::default() };
        parts.rows = vec![0; HEAD * (end - first)];
        let mut near = Vec::new();
        for t in first..end {
            let (near_at, squares) = (parts.rows.len() as u32, parts.squares.len());
            let mut head = [0; HEAD];
            let occupied = tiles.occupied[t];
            head[..4].copy_from_slice(&[
                occupied as u32,
                (occupied >> 32) as u32,
                tiles.first_rank[t],
                near_at,
            ]);
            head[5] = squares as u32;
            for row in 0..8 {
                self.row(t, row, &mut parts);
                head[6 + row as usize] = parts.squares.len() as u32;
                let many = head[6 + row as usize] - head[5 + row as usize];
                parts.row = parts.row.max(many);
            }
            near.clear();
            near.extend(parts.squares[squares..].iter().map(|s| s[0]));
            near.sort_unstable();
            near.dedup();
            parts.near = parts.near.max(near.len() as u32);
            parts.rows.extend(&near);
            head[4] = parts.rows.len() as u32;
            parts.rows[HEAD * (t - first)..][..HEAD].copy_from_slice(&head);
        }
        parts
    }

    /// Adds the squares of a row of cells.
    fn row(&mut self, tile: usize, row: u32, parts: &mut Parts) {
        let tiles = &self.graph.tiles;
        let mut cells = tiles.occupied[tile] >> (8 * row) & 255;
        let mut found: Vec<(u32, [u64; 8])> = Vec::new();
        while cells != 0 {
            let i = cells.trailing_zeros();
            cells &= cells - 1;
            let (to, masks) = self.graph.row(tiles.rank(tile as u32, 8 * row + i));
            for (&to, &mask) in to.iter().zip(masks) {
                let place = &mut self.places[to as usize];
                if *place == usize::MAX {
                    *place = found.len();
                    found.push((to, [0; 8]));
                }
                found[*place].1[i as usize] = mask;
            }
        }
        found.iter().for_each(|square| self.places[square.0 as usize] = usize::MAX);
        found.sort_by_key(|square| Reverse(square.1.iter().map(|m| m.count_ones()).sum::<u32>()));
        for (to, masks) in found {
            parts.squares.push([to, tile as u32 * 8 + row]);
            parts.seen.extend([0; EACH]);
            parts.seen.extend(masks);
        }
    }
}

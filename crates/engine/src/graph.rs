//! Who sees whom: one row a vertex, each row a sorted list of (tile, mask of 64 cells).

use std::collections::VecDeque;
use std::sync::Arc;

use super::tiles::Tiles;

/// A visibility graph. Undirected, no loops; memory grows with what is visible.
#[derive(Clone, Debug, Default)]
pub struct Graph {
    pub(super) tiles: Arc<Tiles>,
    /// First entry of the row of each rank; one more entry than vertices.
    pub(super) start: Vec<usize>,
    /// Tile of each entry, ascending within a row.
    pub(super) entry_tile: Vec<u32>,
    /// Cells of that tile that are seen; never 0.
    pub(super) entry_mask: Vec<u64>,
    /// Neighbours of each rank.
    pub(super) degree: Vec<u32>,
}

/// Rows of some consecutive ranks, as one worker makes them.
#[derive(Default)]
pub(super) struct RowChunk {
    pub tile: Vec<u32>,
    pub mask: Vec<u64>,
    /// Entries and neighbours of each row.
    pub rows: Vec<(u32, u32)>,
}

impl Graph {
    pub(super) fn from_chunks(tiles: Arc<Tiles>, chunks: Vec<RowChunk>) -> Self {
        let entries = chunks.iter().map(|c| c.tile.len()).sum();
        let n = tiles.vertex_of.len();
        let mut graph = Self {
            tiles,
            start: Vec::with_capacity(n + 1),
            entry_tile: Vec::with_capacity(entries),
            entry_mask: Vec::with_capacity(entries),
            degree: Vec::with_capacity(n),
        };
        let mut at = 0;
        graph.start.push(0);
        for chunk in chunks {
            graph.entry_tile.extend_from_slice(&chunk.tile);
            graph.entry_mask.extend_from_slice(&chunk.mask);
            for (entries, degree) in chunk.rows {
                at += entries as usize;
                graph.start.push(at);
                graph.degree.push(degree);
            }
        }
        graph
    }

    /// Vertices.
    pub fn len(&self) -> usize {
        self.degree.len()
    }

    /// Whether there is no vertex at all.
    pub fn is_empty(&self) -> bool {
        self.degree.is_empty()
    }

    /// Pairs that see each other, each once.
    pub fn edge_count(&self) -> u64 {
        self.degree.iter().map(|&d| u64::from(d)).sum::<u64>() / 2
    }

    /// How many vertices `v` sees, itself not counted.
    pub fn degree(&self, v: u32) -> u32 {
        self.degree[self.tiles.rank_of[v as usize] as usize]
    }

    /// Calls `visit` with every vertex that `v` sees, in an order that depends on the lattice alone.
    pub fn for_each_neighbour(&self, v: u32, mut visit: impl FnMut(u32)) {
        let rank = self.tiles.rank_of[v as usize] as usize;
        self.for_each_rank(rank, |r| visit(self.tiles.vertex_of[r]));
    }

    /// Steps of sight from the nearest of some vertices, which are none, to every vertex; `u32::MAX` where no way leads.
    pub fn steps_from(&self, first: &[u32]) -> Vec<u32> {
        let mut steps = vec![u32::MAX; self.len()];
        let mut queue: VecDeque<u32> = first.iter().copied().collect();
        first.iter().for_each(|v| steps[*v as usize] = 0);
        while let Some(v) = queue.pop_front() {
            let next = steps[v as usize] + 1;
            self.for_each_neighbour(v, |to| {
                if steps[to as usize] == u32::MAX {
                    steps[to as usize] = next;
                    queue.push_back(to);
                }
            });
        }
        steps
    }

    /// Whether `u` and `v` see each other; a vertex does not see itself.
    pub fn sees(&self, u: u32, v: u32) -> bool {
        let (tile, bit) = self.tiles.slot_of[self.tiles.rank_of[v as usize] as usize];
        let (tiles, masks) = self.row(self.tiles.rank_of[u as usize] as usize);
        tiles.binary_search(&tile).is_ok_and(|at| masks[at] >> bit & 1 == 1)
    }

    /// Pairs that see each other here and not in `other`, a graph of the same lattice; each once, the smaller first, in an
    /// order that depends on the lattice alone.
    pub fn beyond(&self, other: &Self) -> Vec<[u32; 2]> {
        let mut out = Vec::new();
        for rank in 0..self.len() {
            let u = self.tiles.vertex_of[rank];
            let ((tiles, masks), (known, known_masks)) = (self.row(rank), other.row(rank));
            let mut at = 0;
            for (&tile, &mask) in tiles.iter().zip(masks) {
                at += known[at..].iter().take_while(|t| **t < tile).count();
                let seen = known_masks.get(at).filter(|_| known[at] == tile).copied().unwrap_or(0);
                for_each_bit(mask & !seen, |bit| {
                    let v = self.tiles.vertex_of[self.tiles.rank(tile, bit)];
                    if u < v {
                        out.push([u, v]);
                    }
                });
            }
        }
        out
    }

    /// This graph, complete, with what is seen through some windows in another layout instead of what is seen through them
    /// now: `before` and `then` are those parts of it.
    pub fn replaced(&self, before: &Self, then: &Self) -> Self {
        let mut out = Self {
            tiles: Arc::clone(&self.tiles),
            start: Vec::with_capacity(self.start.len()),
            entry_tile: Vec::with_capacity(self.entry_tile.len() + then.entry_tile.len()),
            entry_mask: Vec::with_capacity(self.entry_tile.len() + then.entry_tile.len()),
            degree: Vec::with_capacity(self.len()),
        };
        out.start.push(0);
        for rank in 0..self.len() {
            let [now, gone, come] = [self, before, then].map(|g| g.row(rank));
            if gone.0.is_empty() && come.0.is_empty() {
                out.entry_tile.extend_from_slice(now.0);
                out.entry_mask.extend_from_slice(now.1);
                out.degree.push(self.degree[rank]);
            } else {
                let degree = out.push_replaced(now, gone, come);
                out.degree.push(degree);
            }
            out.start.push(out.entry_tile.len());
        }
        out
    }

    /// This graph and what else is seen in a part of another.
    pub fn with(&self, more: &Self) -> Self {
        let nothing = Self { start: vec![0; self.start.len()], ..Self::default() };
        self.replaced(&nothing, more)
    }

    /// Adds the entries of a row without some of them and with others; how many cells it has.
    fn push_replaced(
        &mut self,
        now: (&[u32], &[u64]),
        gone: (&[u32], &[u64]),
        come: (&[u32], &[u64]),
    ) -> u32 {
        let mut at = [0; 3];
        let mut degree = 0;
        loop {
            let rows = [now, gone, come];
            let next = |k: usize| rows[k].0.get(at[k]).copied().unwrap_or(u32::MAX);
            let tile = next(0).min(next(2));
            if tile == u32::MAX {
                return degree;
            }
            let masks: [u64; 3] = std::array::from_fn(|k| {
                let is_here = next(k) == tile;
                if is_here { rows[k].1[at[k]] } else { 0 }
            });
            (0..3).for_each(|k| at[k] += usize::from(rows[k].0.get(at[k]) == Some(&tile)));
            let mask = masks[0] & !masks[1] | masks[2];
            if mask != 0 {
                self.entry_tile.push(tile);
                self.entry_mask.push(mask);
                degree += mask.count_ones();
            }
        }
    }

    /// Component label of every vertex: the smallest vertex of its component.
    pub fn components(&self) -> Vec<u32> {
        let by_rank = self.rank_components();
        let mut smallest = vec![u32::MAX; self.len()];
        for v in 0..self.len() {
            let root = by_rank[self.tiles.rank_of[v] as usize] as usize;
            smallest[root] = smallest[root].min(v as u32);
        }
        (0..self.len()).map(|v| smallest[by_rank[self.tiles.rank_of[v] as usize] as usize]).collect()
    }

    /// Component label of every rank: the smallest rank of its component.
    pub(super) fn rank_components(&self) -> Vec<u32> {
        let mut label = vec![u32::MAX; self.len()];
        let mut unseen = self.tiles.occupied.clone();
        let mut stack = Vec::new();
        for root in 0..self.len() {
            if label[root] != u32::MAX {
                continue;
            }
            label[root] = root as u32;
            let (tile, bit) = self.tiles.slot_of[root];
            unseen[tile as usize] &= !(1 << bit);
            stack.push(root);
            while let Some(at) = stack.pop() {
                let (tiles, masks) = self.row(at);
                for (&t, &mask) in tiles.iter().zip(masks) {
                    let fresh = mask & unseen[t as usize];
                    unseen[t as usize] &= !fresh;
                    for_each_bit(fresh, |bit| {
                        let rank = self.tiles.rank(t, bit);
                        label[rank] = root as u32;
                        stack.push(rank);
                    });
                }
            }
        }
        label
    }

    /// Tiles and masks of the row of a rank.
    #[inline(always)]
    pub(super) fn row(&self, rank: usize) -> (&[u32], &[u64]) {
        let range = self.start[rank]..self.start[rank + 1];
        (&self.entry_tile[range.clone()], &self.entry_mask[range])
    }

    pub(super) fn for_each_rank(&self, rank: usize, mut visit: impl FnMut(usize)) {
        let (tiles, masks) = self.row(rank);
        for (&t, &mask) in tiles.iter().zip(masks) {
            for_each_bit(mask, |bit| visit(self.tiles.rank(t, bit)));
        }
    }

    /// Rank of the vertex at a cell, if there is one.
    pub(super) fn rank_at(&self, cell: [i32; 2]) -> Option<usize> {
        let [c, r] = [0, 1].map(|k| i64::from(cell[k]) - self.tiles.min_cell[k]);
        let tile = self.tiles.tile_with([c, r])?;
        let bit = ((r & 7) << 3 | (c & 7)) as u32;
        (self.tiles.occupied[tile as usize] >> bit & 1 == 1).then(|| self.tiles.rank(tile, bit))
    }

    /// Calls `visit` with those of the four cells beside a rank that it sees.
    pub(super) fn for_each_beside(&self, rank: usize, mut visit: impl FnMut(usize)) {
        let (tile, bit) = self.tiles.slot_of[rank];
        let (tiles, masks) = self.row(rank);
        let [column, row] = self.tiles.tile_at[tile as usize];
        let (c, r) = (i64::from(column) * 8 + i64::from(bit & 7), i64::from(row) * 8 + i64::from(bit >> 3));
        for (c, r) in [(c - 1, r), (c, r - 1), (c, r + 1), (c + 1, r)] {
            let Some(tile) = self.tiles.tile_with([c, r]) else { continue };
            let bit = ((r & 7) << 3 | (c & 7)) as u32;
            if tiles.binary_search(&tile).is_ok_and(|at| masks[at] >> bit & 1 == 1) {
                visit(self.tiles.rank(tile, bit));
            }
        }
    }

    /// Packs a property of vertices into one mask a tile.
    pub(super) fn tile_masks(&self, of_vertex: impl Fn(u32) -> bool) -> Vec<u64> {
        let mut masks = vec![0u64; self.tiles.count()];
        for (rank, &v) in self.tiles.vertex_of.iter().enumerate() {
            let (tile, bit) = self.tiles.slot_of[rank];
            masks[tile as usize] |= u64::from(of_vertex(v)) << bit;
        }
        masks
    }
}

/// Calls `visit` with the number of every set bit, ascending.
pub(super) fn for_each_bit(mut mask: u64, mut visit: impl FnMut(u32)) {
    while mask != 0 {
        visit(mask.trailing_zeros());
        mask &= mask - 1;
    }
}

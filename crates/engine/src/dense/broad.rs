//! One layout of a larger plan against what never moves: the shadows of the dense rows, gathered tile by tile into
//! a visibility graph.

use std::sync::Arc;

use super::{Dense, DenseScratch, Moving, Viewer, lowest_first};
use crate::graph::Graph;
use crate::halves::{Half, Halves};
use crate::lanes::Path;
use crate::tiles::Tiles;
use crate::{Lattice, Obstacles};

/// Most words of the table of what is seen under the fixed walls: 64 MiB.
const MAX_WORDS: usize = 1 << 23;

/// Most cells along a line.
const MAX_COLUMNS: usize = super::MAX_CELLS;

/// See the module page.
pub(crate) struct Broad {
    dense: Dense,
    tiles: Arc<Tiles>,
}

impl Broad {
    /// `graph` is that under the fixed walls; `None` without vertices, with lines of more than [`MAX_COLUMNS`] cells
    /// or a table of more than [`MAX_WORDS`].
    pub fn new(lattice: &Lattice, graph: &Graph) -> Option<Self> {
        let fits = Self::has_room(graph.len(), graph.tiles.size_cells);
        fits.then(|| Self { dense: Dense::prepared(lattice, graph), tiles: Arc::clone(&graph.tiles) })
    }

    /// Whether [`new`](Self::new) takes the graph of a lattice; it does where [`Dense::new`] does.
    pub fn fits(lattice: &Lattice) -> bool {
        Self::has_room(lattice.cells.len(), Tiles::new(lattice).size_cells)
    }

    fn has_room(vertices: usize, size: [usize; 2]) -> bool {
        let words = || vertices.checked_mul(Dense::view_words_of(size));
        vertices > 0 && size[0].max(size[1]) <= MAX_COLUMNS && words().is_some_and(|w| w <= MAX_WORDS)
    }

    /// The graph with the `moving` walls too, on the calling thread; `None` if a coordinate is beyond the
    /// arithmetic. Equal to that of all walls at once, bit for bit.
    pub fn graph(&self, moving: &Obstacles, scratch: &mut DenseScratch) -> Option<Graph> {
        let mut segments = self.dense.take(&moving.segments)?;
        lowest_first(&mut segments);
        let mut open = self.tiles.occupied.clone();
        for &v in &moving.blind {
            let (tile, bit) = self.tiles.slot_of[self.tiles.rank_of[v as usize] as usize];
            open[tile as usize] &= !(1 << bit);
        }
        let halves = match self.dense.path {
            // SAFETY: a path is only made for a processor that has its instructions.
            #[cfg(target_arch = "x86_64")]
            #[allow(unsafe_code)]
            Path::Avx512 => unsafe { self.halves_avx512(&segments, &open, scratch) },
            #[cfg(target_arch = "x86_64")]
            #[allow(unsafe_code)]
            Path::Avx2 => unsafe { self.halves_avx2(&segments, &open, scratch) },
            Path::Portable => self.halves(&segments, &open, scratch),
        };
        let (halves, mut squares) = (Halves::new(&self.tiles, halves), Vec::new());
        let chunks = (0..self.tiles.count()).map(|t| halves.rows(t, &mut squares)).collect();
        Some(Graph::from_chunks(Arc::clone(&self.tiles), chunks))
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx512f,avx512dq,avx2,popcnt,bmi1,bmi2")]
    fn halves_avx512(&self, segments: &[Moving], open: &[u64], scratch: &mut DenseScratch) -> Vec<Half> {
        self.halves(segments, open, scratch)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,popcnt,bmi1,bmi2")]
    fn halves_avx2(&self, segments: &[Moving], open: &[u64], scratch: &mut DenseScratch) -> Vec<Half> {
        self.halves(segments, open, scratch)
    }

    /// Tile by tile, the upper half plane of its open viewers.
    #[inline(always)]
    fn halves(&self, segments: &[Moving], open: &[u64], scratch: &mut DenseScratch) -> Vec<Half> {
        let DenseScratch { view, near, .. } = scratch;
        near.resize(segments.len() + 1, 0);
        let mut places = vec![u32::MAX; open.len()];
        let mut half_of = |t: usize| {
            let mut half = Half::default();
            for rank in self.tiles.first_rank[t]..self.tiles.first_rank[t + 1] {
                let bit = self.tiles.slot_of[rank as usize].1;
                if open[t] >> bit & 1 == 1 {
                    let v = self.tiles.vertex_of[rank as usize] as usize;
                    let viewer = self.dense.shade(v, (&[], segments), near, view);
                    self.for_each_tile(&viewer, view, |tile, mask| {
                        let mask = mask & open[tile as usize];
                        if mask != 0 {
                            half.add(&mut places, bit, tile, mask);
                        }
                    });
                }
            }
            half.finish(&mut places);
            half
        };
        (0..open.len()).map(&mut half_of).collect()
    }

    /// Calls `visit` with every tile of a view that has cells in it, and these.
    #[inline(always)]
    fn for_each_tile(&self, viewer: &Viewer, view: &[u64], mut visit: impl FnMut(u32, u64)) {
        let line_stride = self.dense.line_stride();
        let is_turned = self.dense.axes[0] == 1;
        for strip in viewer.at[1] / 8..=viewer.top / 8 {
            for word in 0..self.dense.size[0].div_ceil(64) {
                let mut masks = [0; 8];
                masks.copy_from_slice(&view[word * line_stride + strip * 8..][..8]);
                if masks.iter().fold(0, |any, m| any | m) == 0 {
                    continue;
                }
                transpose_bytes(&mut masks);
                for (byte, &mask) in masks.iter().enumerate().filter(|(_, m)| **m != 0) {
                    let along = word * 8 + byte;
                    let [column, row] = if is_turned { [strip, along] } else { [along, strip] };
                    let tile = self.tiles.grid[row * self.tiles.size_tiles[0] + column];
                    visit(tile, if is_turned { turned(mask) } else { mask });
                }
            }
        }
    }
}

/// Byte `j` of word `i` changes places with byte `i` of word `j`.
#[inline(always)]
fn transpose_bytes(m: &mut [u64; 8]) {
    let mut swap = |i: usize, j: usize, shift: u32, mask: u64| {
        let swap = ((m[i] >> shift) ^ m[j]) & mask;
        m[i] ^= swap << shift;
        m[j] ^= swap;
    };
    (0..4).for_each(|i| swap(i, i + 4, 32, 0x0000_0000_ffff_ffff));
    [0, 1, 4, 5].into_iter().for_each(|i| swap(i, i + 2, 16, 0x0000_ffff_0000_ffff));
    [0, 2, 4, 6].into_iter().for_each(|i| swap(i, i + 1, 8, 0x00ff_00ff_00ff_00ff));
}

/// Rows of a tile become columns.
#[inline(always)]
fn turned(mut m: u64) -> u64 {
    for (shift, mask) in
        [(7, 0x00aa_00aa_00aa_00aa), (14, 0x0000_cccc_0000_cccc), (28, 0x0000_0000_f0f0_f0f0)]
    {
        let swap = (m ^ (m >> shift)) & mask;
        m ^= swap ^ (swap << shift);
    }
    m
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::fixtures;
    use crate::geometry::Segment;
    use crate::visibility::visibility_graph_serial;

    fn rows(graph: &Graph) -> (&[usize], &[u32], &[u64], &[u32]) {
        (&graph.start, &graph.entry_tile, &graph.entry_mask, &graph.degree)
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 2000, max_shrink_iters: 4000, ..ProptestConfig::default() })]

        /// However the walls are shared out between those that move and those that do not, with every
        /// instruction set; walls on lattice lines, ends on centres, collinear, touching, 45°.
        #[test]
        fn shadows_on_the_unmoved_equal_the_whole((lattice, obstacles) in fixtures::plans(), share in any::<u64>()) {
            prop_assume!(!lattice.cells.is_empty());
            let part = |moves: bool| -> Vec<Segment> {
                let chosen = obstacles.segments.iter().enumerate();
                chosen.filter(|(i, _)| (share.rotate_left(*i as u32) & 1 == 1) == moves).map(|(_, s)| *s).collect()
            };
            let fixed = Obstacles { segments: part(false), blind: vec![] };
            let moving = Obstacles { segments: part(true), blind: obstacles.blind.clone() };
            let mut broad = Broad::new(&lattice, &visibility_graph_serial(&lattice, &fixed)).unwrap();
            let whole = visibility_graph_serial(&lattice, &obstacles);
            for path in Path::available() {
                broad.dense.path = path;
                let found = broad.graph(&moving, &mut DenseScratch::default()).unwrap();
                prop_assert_eq!(rows(&found), rows(&whole), "{:?}", path);
            }
        }
    }

    #[test]
    fn tables_beyond_the_limit_are_not_made() {
        let broad = |cells: Vec<[i32; 2]>| {
            let lattice = fixtures::lattice(10, [0, 0], cells);
            Broad::new(&lattice, &visibility_graph_serial(&lattice, &Obstacles::default())).is_some()
        };
        let apart = |columns: usize| vec![[0, 0], [columns as i32 - 1, 0]];
        assert!(broad(apart(MAX_COLUMNS)) && !broad(apart(MAX_COLUMNS + 1)));
        // A strip of 8 rows takes 16 words a viewer for every 64 columns: 2,048 columns fill the table.
        let strip = |columns: i32| (0..columns).flat_map(|c| (0..8).map(move |r| [c, r])).collect();
        assert!(broad(strip(2048)) && !broad(strip(2049)));
    }

    #[test]
    fn turned_and_transposed_by_bit_and_byte() {
        let of = |bits: &dyn Fn(u32) -> u32| {
            (0..64).filter(|i| i % 7 == 3 || i % 11 == 5).fold(0, |m, i| m | 1u64 << bits(i))
        };
        assert_eq!(turned(of(&|i| i)), of(&|i| i % 8 * 8 + i / 8));
        let mut bytes: [u64; 8] =
            std::array::from_fn(|i| (0..8).fold(0, |m, j| m | (10 * i as u64 + j) << (8 * j)));
        transpose_bytes(&mut bytes);
        for (i, word) in bytes.iter().enumerate() {
            assert_eq!(word.to_le_bytes(), std::array::from_fn(|j| (10 * j + i) as u8));
        }
    }
}

//! What stays on the card: a lattice and what is seen on it, uploaded once, and the buffers that every batch uses again.

use std::sync::Arc;

use wgpu::Buffer;

use super::rows::{self, Block};
use super::shape::{SLOTS, SUMS, Shape};
use super::{Gpu, Params};
use crate::Lattice;
use crate::geometry::PointUm;
use crate::graph::Graph;
use crate::tiles::Tiles;

/// Ordinates from the middle of the plan, at most, where walls move: differences of two fit into 32 bits.
pub const ORDINATE_UM_MAX: i64 = (1 << 30) - 1;

/// Levels of the first submission.
const LEVELS_FIRST: u32 = 12;

/// What never changes.
pub(super) struct Store {
    pub gpu: Arc<Gpu>,
    pub lattice: Arc<Lattice>,
    pub tiles: Arc<Tiles>,
    pub shape: Shape,
    pub blocks: Vec<Block>,
    /// Rank and place in the query region of every root, by rank.
    pub roots: Vec<(u32, u32)>,
    /// Lower left cell of each tile from a point, where the plan is not too large for walls that move.
    pub corners: Result<(PointUm, Buffer), String>,
    /// Cells of each tile in the region of reference.
    pub region: Buffer,
    /// Tile and bit of every root.
    pub root_slots: Buffer,
    /// Number of each rank among the roots.
    pub root_at: Buffer,
    /// Initial components of ranks, of roots and of words of roots.
    pub labels: Option<Buffer>,
}

/// Buffers that every batch uses again.
pub(super) struct Work {
    /// What each layout leaves of the masks, by block; none before a layout has walls that move.
    pub shaded: Vec<Buffer>,
    pub segments: Buffer,
    pub segments_fit: usize,
    pub ranges: Buffer,
    pub sight: Buffer,
    pub missing: Buffer,
    /// What is on the frontier after even and odd levels.
    pub fronts: [Buffer; 2],
    pub sums: Buffer,
    pub awake: Buffer,
    pub counts: Buffer,
    pub degrees: Buffer,
    pub staging: Buffer,
    /// Levels of the next submission, by the depth of the last.
    pub levels: u32,
}

impl Store {
    /// With buffers of at most `bytes_max` bytes, for up to `layouts` at a time, cut as a function says at last.
    ///
    /// # Errors
    /// The plan is too large for the adapter.
    pub fn new(
        gpu: Arc<Gpu>,
        lattice: Arc<Lattice>,
        graph: &Graph,
        components: Option<&[u32]>,
        (layouts, bytes_max): (u32, u64),
        cut: impl FnOnce(Shape) -> Shape,
    ) -> Result<Self, String> {
        let (blocks, mut extent) = rows::upload(&gpu, graph, bytes_max)?;
        extent.roots = lattice.query.len() as u32;
        let shape = cut(Shape::new(extent, layouts, (bytes_max, gpu.iterations_max()))?);
        let tiles = &graph.tiles;
        let place = |(place, &v): (u32, &u32)| (tiles.rank_of[v as usize], place);
        let mut roots: Vec<(u32, u32)> = (0..).zip(&lattice.query).map(place).collect();
        roots.sort_unstable();
        let uploaded = |words: &[u32]| {
            let buffer = gpu.buffer(words.len() as u64);
            gpu.write(&buffer, words);
            buffer
        };
        let region = graph.tile_masks(|v| lattice.is_reference[v as usize]);
        let region: Vec<u32> = region.iter().flat_map(|&m| [m as u32, (m >> 32) as u32]).collect();
        let ranks: Vec<u32> = roots.iter().map(|r| r.0).collect();
        let slot = |&rank: &u32| {
            let (tile, bit) = tiles.slot_of[rank as usize];
            tile * 64 + u32::from(bit)
        };
        let slots: Vec<u32> = ranks.iter().map(slot).collect();
        let mut root_at = vec![u32::MAX; graph.len()];
        (0..).zip(&ranks).for_each(|(i, &rank)| root_at[rank as usize] = i);
        Ok(Self {
            corners: corners(&lattice, tiles).map(|(from_um, corners)| (from_um, uploaded(&corners))),
            region: uploaded(&region),
            labels: components.map(|c| uploaded(&labels(tiles, &ranks, c))),
            root_slots: uploaded(&slots),
            root_at: uploaded(&root_at),
            tiles: Arc::clone(tiles),
            gpu,
            lattice,
            shape,
            blocks,
            roots,
        })
    }

    /// What all dispatches have in common.
    pub fn params(&self) -> Params {
        Params {
            vertices: self.lattice.cells.len() as u32,
            tiles: self.tiles.count() as u32,
            ..Params::default()
        }
    }
}

impl Work {
    pub fn new(store: &Store) -> Self {
        let Store { gpu, shape, .. } = store;
        let (layouts, tiles) = (u64::from(shape.layouts), store.tiles.count() as u64);
        let words = layouts * u64::from(shape.words);
        let front = || gpu.buffer(words * tiles * SLOTS);
        let counts = u64::from(shape.levels + 1) * words * 32;
        let degrees = layouts * store.roots.len() as u64 * 2;
        Self {
            shaded: Vec::new(),
            segments: gpu.buffer(0),
            segments_fit: 0,
            ranges: gpu.buffer(layouts * 2),
            sight: gpu.buffer(layouts * tiles * 4),
            missing: gpu.buffer(words * store.lattice.cells.len() as u64),
            fronts: [front(), front()],
            sums: gpu.buffer(words * tiles * SUMS),
            awake: gpu.buffer(words * tiles),
            counts: gpu.buffer(counts),
            degrees: gpu.buffer(degrees),
            staging: gpu.staging(counts + degrees),
            levels: LEVELS_FIRST,
        }
    }
}

/// Lower left cells of the tiles, micrometres from the middle of the lattice's box, which is given too.
fn corners(lattice: &Lattice, tiles: &Tiles) -> Result<(PointUm, Vec<u32>), String> {
    let corner =
        |k: usize, cells: i64| lattice.origin_um[k] + (tiles.min_cell[k] + cells) * lattice.spacing_um;
    let middle_um = [0, 1].map(|k| corner(k, tiles.size_cells[k] as i64 / 2));
    let mut out = Vec::with_capacity(tiles.count() * 2);
    for at in &tiles.tile_at {
        let low = [0, 1].map(|k| corner(k, i64::from(at[k]) * 8));
        local(low.map(|v| v + 7 * lattice.spacing_um), middle_um)?;
        out.extend(local(low, middle_um)?.map(|v| v as u32));
    }
    Ok((middle_um, out))
}

/// A point from another.
pub(super) fn local(p: PointUm, from_um: PointUm) -> Result<[i32; 2], String> {
    let [x, y] = [0, 1].map(|k| p[k].saturating_sub(from_um[k]));
    if x.saturating_abs().max(y.saturating_abs()) > ORDINATE_UM_MAX {
        return Err(format!("the plan reaches more than {} m from its middle", ORDINATE_UM_MAX / 1_000_000));
    }
    Ok([x as i32, y as i32])
}

/// Components of ranks, of roots, and of every 32 roots where these have the same one; otherwise the largest number.
fn labels(tiles: &Tiles, roots: &[u32], components: &[u32]) -> Vec<u32> {
    let mut labels: Vec<u32> = tiles.vertex_of.iter().map(|&v| components[v as usize]).collect();
    let of_roots: Vec<u32> = roots.iter().map(|&rank| labels[rank as usize]).collect();
    let common = |word: &[u32]| if word.iter().all(|c| *c == word[0]) { word[0] } else { u32::MAX };
    labels.extend(&of_roots);
    labels.extend(of_roots.chunks(32).map(common));
    labels
}

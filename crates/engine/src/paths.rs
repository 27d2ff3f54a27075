//! What paths through the visibility graph go by: where they may turn, and what lies between two cells.

use std::collections::HashSet;

use crate::geometry::UM_PER_M;

use super::graph::Graph;
use super::lanes::{Path, ROW};
use super::offsets::{Offsets, direction_of, length_of, single_of};
use super::tiles::Tiles;
use super::{Lattice, Obstacles};

/// Where a path may turn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Turning {
    /// At every cell: the shortest paths of the visibility graph.
    Everywhere,
    /// depthmapX's rule: at cells whose own square, or one of the eight squares around it, a wall
    /// touches.
    #[default]
    AtWalls,
}

/// Paths over one graph; share it between threads. A *slot* is a tile and a bit of its mask.
pub struct Paths<'a> {
    lattice: &'a Lattice,
    pub(super) graph: &'a Graph,
    pub(super) path: Path,
    /// Cells at which paths may turn, by tile.
    pub(super) turns: Vec<u64>,
    pub(super) offsets: Offsets,
    /// By slot, see [`Offsets::place`].
    place: Vec<u32>,
    pub(super) vertex_of_slot: Vec<u32>,
    pub(super) slot_of_vertex: Vec<u32>,
}

impl<'a> Paths<'a> {
    /// `obstacles` are those of the graph; they say where the walls stand.
    pub fn new(lattice: &'a Lattice, graph: &'a Graph, obstacles: &Obstacles, turning: Turning) -> Self {
        let walls = match turning {
            Turning::Everywhere => HashSet::new(),
            Turning::AtWalls => wall_squares(lattice, obstacles),
        };
        let turns_at = |v: u32| {
            let [c, r] = lattice.cells[v as usize];
            let around = (-1..=1).flat_map(|x| (-1..=1).map(move |y| [c + x, r + y]));
            turning == Turning::Everywhere || around.into_iter().any(|cell| walls.contains(&cell))
        };
        let tiles = &graph.tiles;
        let slot = |&rank: &u32| {
            let (tile, bit) = tiles.slot_of[rank as usize];
            tile << 6 | u32::from(bit)
        };
        let slot_of_vertex: Vec<u32> = tiles.rank_of.iter().map(slot).collect();
        let mut vertex_of_slot = vec![u32::MAX; tiles.count() * 64];
        for (v, &slot) in slot_of_vertex.iter().enumerate() {
            vertex_of_slot[slot as usize] = v as u32;
        }
        let offsets = Offsets::new(tiles.size_cells.map(|n| n as i32));
        let places = (0..tiles.count() as u32 * 64).map(|slot| offsets.place(cell(tiles, slot)));
        Self {
            lattice,
            graph,
            path: Path::best(),
            turns: graph.tile_masks(turns_at),
            place: places.collect(),
            offsets,
            vertex_of_slot,
            slot_of_vertex,
        }
    }

    pub(super) fn spacing_m(&self) -> f64 {
        self.lattice.spacing_um as f64 / UM_PER_M
    }

    #[inline(always)]
    pub(super) fn rank(&self, slot: u32) -> usize {
        self.graph.tiles.rank(slot >> 6, slot & 63)
    }

    /// Whether paths may turn at a slot.
    #[inline(always)]
    pub(super) fn may_turn(&self, slot: u32) -> bool {
        self.turns[slot as usize >> 6] >> (slot & 63) & 1 == 1
    }

    /// Cells between two slots.
    #[inline(always)]
    pub(super) fn length(&self, from: u32, to: u32) -> f64 {
        let found = self.offsets.lengths.get(self.entry(from, to)).copied();
        found.unwrap_or_else(|| length_of(self.offset(from, to)))
    }

    /// The same in single precision.
    #[inline(always)]
    pub(super) fn single(&self, from: u32, to: u32) -> f32 {
        let found = self.offsets.singles.get(self.entry(from, to)).copied();
        found.unwrap_or_else(|| single_of(self.offset(from, to)))
    }

    /// Right angles from +x, anticlockwise.
    #[inline(always)]
    pub(super) fn direction(&self, from: u32, to: u32) -> f64 {
        let found = self.offsets.directions.get(self.entry(from, to)).copied();
        found.unwrap_or_else(|| direction_of(self.offset(from, to)))
    }

    /// A table at eight slots from one on, along x, or what stands there where it is empty.
    #[inline(always)]
    pub(super) fn row<T: Copy>(
        &self,
        table: &[T],
        from: u32,
        first: u32,
        value: fn([i32; 2]) -> T,
    ) -> [T; ROW] {
        let found = table.get(self.entry(from, first)..).and_then(|t| t.first_chunk::<ROW>());
        if let Some(found) = found { *found } else { self.computed_row(from, first, value) }
    }

    #[cold]
    #[inline(never)]
    fn computed_row<T>(&self, from: u32, first: u32, value: fn([i32; 2]) -> T) -> [T; ROW] {
        let [x, y] = self.offset(from, first);
        std::array::from_fn(|i| value([x + i as i32, y]))
    }

    #[inline(always)]
    fn entry(&self, from: u32, to: u32) -> usize {
        self.offsets.origin(self.place[from as usize]).wrapping_add(self.place[to as usize]) as usize
    }

    fn offset(&self, from: u32, to: u32) -> [i32; 2] {
        let (a, b) = (cell(&self.graph.tiles, from), cell(&self.graph.tiles, to));
        [b[0] - a[0], b[1] - a[1]]
    }
}

/// Column and row from the lower left vertex.
fn cell(tiles: &Tiles, slot: u32) -> [i32; 2] {
    let [column, row] = tiles.tile_at[slot as usize >> 6].map(|c| c as i32 * 8);
    [column + (slot & 7) as i32, row + (slot >> 3 & 7) as i32]
}

/// Cells whose closed square a wall touches, around the lattice.
fn wall_squares(lattice: &Lattice, obstacles: &Obstacles) -> HashSet<[i32; 2]> {
    let s = lattice.spacing_um as f64;
    let extreme = |k: usize| {
        let values = lattice.cells.iter().map(|c| c[k]);
        (values.clone().min().unwrap_or(0) - 1, values.max().unwrap_or(0) + 1)
    };
    let (columns, rows) = (extreme(0), extreme(1));
    let mut squares = HashSet::new();
    for segment in &obstacles.segments {
        let place = |p: [i64; 2]| [0, 1].map(|k| (p[k] - lattice.origin_um[k]) as f64 / s);
        let (mut a, mut b) = (place(segment.a), place(segment.b));
        if b[1] < a[1] {
            (a, b) = (b, a);
        }
        let whole = |x: f64, limits: (i32, i32)| (x as i32).clamp(limits.0, limits.1);
        if b[1] < f64::from(rows.0) - 0.5 || a[1] > f64::from(rows.1) + 0.5 {
            continue;
        }
        for row in whole((a[1] - 0.5).ceil(), rows)..=whole((b[1] + 0.5).floor(), rows) {
            let at = |y: f64| {
                let t = if b[1] > a[1] { ((y - a[1]) / (b[1] - a[1])).clamp(0.0, 1.0) } else { 0.0 };
                a[0] + (b[0] - a[0]) * t
            };
            let (mut x0, mut x1) = (at(f64::from(row) - 0.5), at(f64::from(row) + 0.5));
            if a[1] == b[1] {
                (x0, x1) = (a[0], b[0]);
            }
            let (lo, hi) = (x0.min(x1), x0.max(x1));
            if hi < f64::from(columns.0) - 0.5 || lo > f64::from(columns.1) + 0.5 {
                continue;
            }
            let cells = whole((lo - 0.5).ceil(), columns)..=whole((hi + 0.5).floor(), columns);
            squares.extend(cells.map(|column| [column, row]));
        }
    }
    squares
}

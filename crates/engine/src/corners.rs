//! Where paths turn: for every first piece of a way, the cells to which its end leads on.
//!
//! On a shortest path any two pieces in a row are the shortest way of two pieces between their ends, and
//! their ends do not see each other. For every vertex `a` and every cell `t` that it sees and where paths
//! may turn, a list holds the cells `v` for which `a → t → v` is such a way. Few `t` have any: those at
//! the corners of walls. Ways as short as the best up to [`TIED_CELLS`] are all kept: rounding may
//! yet choose another of several equally short paths than without these lists.
//!
//! For straightest paths a list holds all that `t` sees and `a` does not, with the turn at `t`: how a cell is reached
//! depends on the order in which cells are left, so none can be passed over.

use rayon::prelude::*;

use super::lanes::Path;
#[cfg(target_arch = "x86_64")]
use super::lanes::x86::Avx2;
use super::lanes::{Portable, ROW, Rows};
use super::offsets::{length_of, turn};
use super::paths::Paths;

/// Ways that differ by less count as equally long, cells: above what single precision adds up to.
const TIED_CELLS: f32 = 1e-3;

/// Cells that the lists of straightest paths may hold: 50 MB. Larger graphs have no such lists, which would not stay in any
/// cache and so save them nothing.
pub(super) const STRAIGHTEST_MAX: usize = 1 << 22;

/// Cells that can be numbered.
const MOST: usize = u32::MAX as usize;

/// Ranks whose lists are made before they join those of others.
const BLOCK: usize = 1024;

/// Lists of one vertex after another.
#[derive(Default)]
pub(super) struct Corners {
    /// For all neighbours of all ranks, in the order of the graph: the cells to which the way there leads.
    list_to: Vec<List>,
    /// Number of the first of these ways of each rank.
    first: Vec<u32>,
    cells: Cells,
}

/// Some of the cells of [`Corners`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct List {
    pub start: u32,
    pub count: u32,
}

impl List {
    /// Nothing is offered.
    pub const NONE: Self = Self { start: 0, count: 0 };

    /// All is offered that the cell sees and its predecessor does not, whether or not there are lists.
    pub const ALL: Self = Self { start: u32::MAX, count: u32::MAX };

    fn range(self) -> std::ops::Range<usize> {
        self.start as usize..self.start as usize + self.count as usize
    }
}

/// Cells to which a cell leads.
#[derive(Default)]
struct Cells {
    by_length: Vec<Away>,
    by_turn: Vec<Turned>,
}

/// A cell, the number of the way there, see [`Corners::list_to`], and how far away it is.
#[derive(Clone, Copy)]
pub(super) struct Away {
    pub length: f64,
    pub slot: u32,
    pub way: u32,
}

/// A cell, the number of the way there, and how far that turns.
#[derive(Clone, Copy)]
pub(super) struct Turned {
    pub turn: f32,
    pub slot: u32,
    pub way: u32,
}

impl Cells {
    fn extend(&mut self, more: &Self) {
        self.by_length.extend_from_slice(&more.by_length);
        self.by_turn.extend_from_slice(&more.by_turn);
    }

    fn len(&self) -> usize {
        self.by_length.len() + self.by_turn.len()
    }
}

/// What one worker needs: what the vertex itself sees by tile, the shortest way of two pieces by slot, and the
/// tiles where there is any.
struct Scratch {
    own: Vec<u64>,
    best: Vec<f32>,
    touched: Vec<u32>,
}

/// One row of eight cells beyond a relay: the first slot, the cells meant, and the ways there.
type Beyond = (u32, u32, [f32; ROW]);

impl Corners {
    #[cfg(test)]
    pub fn cells(&self) -> usize {
        self.cells.len()
    }

    #[cfg(test)]
    pub fn new(paths: &Paths<'_>) -> Self {
        Self::shortest(paths).unwrap()
    }

    /// The lists of shortest paths, unless their cells cannot be numbered.
    pub fn shortest(paths: &Paths<'_>) -> Option<Self> {
        Self::make::<true>(paths, MOST)
    }

    /// The lists of straightest paths, unless they would hold more than `most` cells.
    pub fn straightest(paths: &Paths<'_>, most: usize) -> Option<Self> {
        Self::make::<false>(paths, most.min(MOST))
    }

    fn make<const METRIC: bool>(paths: &Paths<'_>, most: usize) -> Option<Self> {
        let graph = paths.graph;
        let tiles = graph.tiles.count();
        let scratch = || Scratch {
            own: vec![0; tiles],
            best: if METRIC { vec![f32::INFINITY; tiles * 64] } else { Vec::new() },
            touched: Vec::new(),
        };
        let mut ways = 0u32;
        let mut first = Vec::with_capacity(graph.len());
        for &degree in &graph.degree {
            first.push(ways);
            ways = ways.checked_add(degree)?;
        }
        let first = &first[..];
        let of_rank = |scratch: &mut Scratch, rank: usize| scratch.corners_of::<METRIC>(paths, first, rank);
        let mut all = Self { first: first.to_vec(), ..Self::default() };
        for block in (0..graph.len()).step_by(BLOCK) {
            let ranks = block..graph.len().min(block + BLOCK);
            let parts: Vec<Self> = ranks.into_par_iter().map_init(scratch, of_rank).collect();
            let cells = parts.iter().map(|part| part.cells.len()).sum::<usize>();
            if all.cells.len() + cells > most {
                return None;
            }
            parts.iter().for_each(|part| all.add(part));
        }
        Some(all)
    }

    fn add(&mut self, part: &Self) {
        let cells = self.cells.len() as u32;
        let moved = |list: &List| List { start: list.start + cells, ..*list };
        self.list_to.extend(part.list_to.iter().map(moved));
        self.cells.extend(&part.cells);
    }

    #[inline(always)]
    pub fn by_length(&self, list: List) -> &[Away] {
        &self.cells.by_length[list.range()]
    }

    #[inline(always)]
    pub fn by_turn(&self, list: List) -> &[Turned] {
        &self.cells.by_turn[list.range()]
    }

    /// What a way leads to.
    #[inline(always)]
    pub fn list_to(&self, way: u32) -> List {
        self.list_to[way as usize]
    }

    /// The number of the first way from a rank.
    pub fn first_way(&self, rank: usize) -> u32 {
        self.first[rank]
    }
}

impl Scratch {
    /// The lists of one rank, numbered from 0; `start` holds their ends.
    fn corners_of<const METRIC: bool>(&mut self, paths: &Paths<'_>, first: &[u32], rank: usize) -> Corners {
        match paths.path {
            // SAFETY: a path is only made for a processor that has its instructions.
            #[cfg(target_arch = "x86_64")]
            #[allow(unsafe_code)]
            Path::Avx512 => unsafe { self.corners_of_avx512::<METRIC>(paths, first, rank) },
            #[cfg(target_arch = "x86_64")]
            #[allow(unsafe_code)]
            Path::Avx2 => unsafe { self.corners_of_avx2::<METRIC>(paths, first, rank) },
            Path::Portable => self.corners_of_in::<METRIC, Portable>(paths, first, rank),
        }
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx512f,avx512dq,avx2,popcnt,bmi1,bmi2")]
    fn corners_of_avx512<const METRIC: bool>(
        &mut self,
        paths: &Paths<'_>,
        first: &[u32],
        rank: usize,
    ) -> Corners {
        self.corners_of_in::<METRIC, Avx2>(paths, first, rank)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,popcnt,bmi1,bmi2")]
    fn corners_of_avx2<const METRIC: bool>(
        &mut self,
        paths: &Paths<'_>,
        first: &[u32],
        rank: usize,
    ) -> Corners {
        self.corners_of_in::<METRIC, Avx2>(paths, first, rank)
    }

    #[inline(always)]
    fn corners_of_in<const METRIC: bool, R: Rows>(
        &mut self,
        paths: &Paths<'_>,
        first: &[u32],
        rank: usize,
    ) -> Corners {
        let mut corners = Corners::default();
        let (tiles, masks) = paths.graph.row(rank);
        for (&t, &mask) in tiles.iter().zip(masks) {
            self.own[t as usize] = mask;
        }
        let (own_tile, own_bit) = paths.graph.tiles.slot_of[rank];
        self.own[own_tile as usize] |= 1 << own_bit;
        if METRIC {
            for (&t, &mask) in tiles.iter().zip(masks) {
                let mut bits = mask & paths.turns[t as usize];
                while bits != 0 {
                    self.measure(paths, rank, t << 6 | bits.trailing_zeros());
                    bits &= bits - 1;
                }
            }
        }
        for (&t, &mask) in tiles.iter().zip(masks) {
            let mut bits = mask;
            while bits != 0 {
                let bit = bits.trailing_zeros();
                bits &= bits - 1;
                let start = corners.cells.len() as u32;
                if paths.turns[t as usize] >> bit & 1 == 1 {
                    if METRIC {
                        self.add_shortest::<R>(paths, first, rank, t << 6 | bit, &mut corners.cells);
                    } else {
                        self.add_all(paths, first, rank, t << 6 | bit, &mut corners.cells);
                    }
                }
                corners.list_to.push(List { start, count: corners.cells.len() as u32 - start });
            }
        }
        for tile in self.touched.drain(..) {
            self.best[tile as usize * 64..][..64].fill(f32::INFINITY);
        }
        for &t in tiles {
            self.own[t as usize] = 0;
        }
        self.own[own_tile as usize] = 0;
        corners
    }

    /// Lowers `best` to the ways over `via`.
    #[inline(always)]
    fn measure(&mut self, paths: &Paths<'_>, rank: usize, via: u32) {
        let to_via = ToVia::new(paths, rank, via);
        let (tiles, masks) = paths.graph.row(paths.rank(via));
        for (&tile, &mask) in tiles.iter().zip(masks) {
            let mut bits = mask & !self.own[tile as usize];
            if bits == 0 {
                continue;
            }
            self.touched.push(tile);
            while let Some((first, some, ways)) = to_via.next_row(paths, tile, &mut bits) {
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

    /// Adds the cells to which the shortest ways over `via` lead.
    #[inline(always)]
    fn add_shortest<R: Rows>(
        &self,
        paths: &Paths<'_>,
        first: &[u32],
        rank: usize,
        via: u32,
        cells: &mut Cells,
    ) {
        let to_via = ToVia::new(paths, rank, via);
        let via_rank = paths.rank(via);
        let (tiles, masks) = paths.graph.row(via_rank);
        let mut way = first[via_rank];
        for (&tile, &mask) in tiles.iter().zip(masks) {
            let mut bits = mask & !self.own[tile as usize];
            while let Some((first, some, ways)) = to_via.next_row(paths, tile, &mut bits) {
                let best = self.best.get(first as usize..).and_then(|b| b.first_chunk::<ROW>());
                let limit = best.map_or([0.0; ROW], |b| b.map(|b| b + TIED_CELLS));
                let mut chosen = R::less(&ways, &limit) & some;
                while chosen != 0 {
                    let slot = first + chosen.trailing_zeros();
                    chosen &= chosen - 1;
                    let way = way + (mask & ((1 << (slot & 63)) - 1)).count_ones();
                    cells.by_length.push(Away { length: paths.length(via, slot), slot, way });
                }
            }
            way += mask.count_ones();
        }
    }

    /// Adds all that `via` sees and the vertex does not.
    #[inline(always)]
    fn add_all(&self, paths: &Paths<'_>, first: &[u32], rank: usize, via: u32, cells: &mut Cells) {
        let (tile, bit) = paths.graph.tiles.slot_of[rank];
        let heading = paths.direction(tile << 6 | u32::from(bit), via);
        let via_rank = paths.rank(via);
        let (tiles, masks) = paths.graph.row(via_rank);
        let mut way = first[via_rank];
        for (&tile, &mask) in tiles.iter().zip(masks) {
            let mut bits = mask & !self.own[tile as usize];
            while bits != 0 {
                let bit = bits.trailing_zeros();
                bits &= bits - 1;
                let slot = tile << 6 | bit;
                let way = way + (mask & ((1 << bit) - 1)).count_ones();
                cells.by_turn.push(Turned { turn: turn(heading, paths.direction(via, slot)), slot, way });
            }
            way += mask.count_ones();
        }
    }
}

/// Cells from a vertex to `via`, and where that is.
struct ToVia {
    first: f32,
    via: u32,
}

impl ToVia {
    #[inline(always)]
    fn new(paths: &Paths<'_>, rank: usize, via: u32) -> Self {
        let (tile, bit) = paths.graph.tiles.slot_of[rank];
        let first = paths.length(tile << 6 | u32::from(bit), via) as f32;
        Self { first, via }
    }

    /// The next row of `bits`, which are taken off.
    #[inline(always)]
    fn next_row(&self, paths: &Paths<'_>, tile: u32, bits: &mut u64) -> Option<Beyond> {
        let (row, some) = next_row(bits)?;
        let lengths = paths.row(&paths.offsets.lengths, self.via, tile << 6 | row, length_of);
        let mut ways = [0.0; ROW];
        for i in 0..ROW {
            ways[i] = self.first + lengths[i] as f32;
        }
        Some((tile << 6 | row, some, ways))
    }
}

/// The first bit of the next row of eight that has any, and the row, which is taken off.
#[inline(always)]
pub(super) fn next_row(bits: &mut u64) -> Option<(u32, u32)> {
    if *bits == 0 {
        return None;
    }
    let row = bits.trailing_zeros() & !7;
    let cells = (*bits >> row) as u32 & 0xff;
    *bits &= !(0xff << row);
    Some((row, cells))
}

//! Where shortest paths turn: for every first piece of a way, the cells to which its end leads on.
//!
//! On a shortest path any two pieces in a row are the shortest way of two pieces between their ends, and
//! their ends do not see each other. For every vertex `a` and every cell `t` that it sees and where paths
//! may turn, a list holds the cells `v` for which `a → t → v` is such a way. Few `t` have any: those at
//! the corners of walls. Ways as short as the best up to [`TIED_CELLS`] are all kept: rounding may
//! yet choose another of several equally short paths than without these lists.
//!
//! For straightest paths a list holds all that `t` sees and `a` does not, with the turn at `t`: how a cell is reached
//! depends on the order in which cells are left, so none can be passed over.

use std::marker::PhantomData;

use rayon::prelude::*;

use super::lanes::Path;
#[cfg(target_arch = "x86_64")]
use super::lanes::x86::Avx2;
use super::lanes::{Portable, ROW, Rows, next_row};
use super::offsets::{single_of, turn};
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
pub(super) struct Corners<C> {
    /// For all neighbours of all ranks, in the order of the graph: the number of the list of the way there, or
    /// [`Corners::NONE`].
    list_of_way: Vec<u32>,
    /// Number of the first of these ways of each rank.
    first: Vec<u32>,
    /// Where the cells of each list end; none is empty.
    end: Vec<u32>,
    cells: Vec<C>,
}

/// The places of the cells of a list.
pub(super) type List = [u32; 2];

/// The list of a way that leads to nothing.
pub(super) const NOTHING: List = [0; 2];

/// The number of no list.
pub(super) const NONE: u32 = u32::MAX;

/// A cell of a list.
pub(super) trait Cell: Copy + Send + Sync {
    /// The number of the list of the way there.
    fn list(&mut self) -> &mut u32;
}

/// A cell, the list of the way there, and how far away it is.
#[derive(Clone, Copy)]
pub(super) struct Away {
    pub length: f32,
    pub slot: u32,
    pub list: u32,
}

/// A cell, the list of the way there, and how far that turns.
#[derive(Clone, Copy)]
pub(super) struct Turned {
    pub turn: f32,
    pub slot: u32,
    pub list: u32,
}

impl Cell for Away {
    fn list(&mut self) -> &mut u32 {
        &mut self.list
    }
}

impl Cell for Turned {
    fn list(&mut self) -> &mut u32 {
        &mut self.list
    }
}

/// For the bits of a byte: nothing where a bit is set, infinity elsewhere.
static OTHERS: [[f32; ROW]; 256] = {
    let mut others = [[0.0; ROW]; 256];
    let mut i = 0;
    while i < 256 * ROW {
        if ((i / ROW) >> (i % ROW)) & 1 == 0 {
            others[i / ROW][i % ROW] = f32::INFINITY;
        }
        i += 1;
    }
    others
};

/// What one worker needs: what the vertex itself sees by tile, the shortest way of two pieces by slot, and the
/// tiles where there is any.
struct Scratch {
    own: Vec<u64>,
    best: Vec<f32>,
    touched: Vec<u32>,
}

/// One row of eight cells beyond a relay: the first slot, the cells meant, and the ways there.
type Beyond = (u32, u32, [f32; ROW]);

impl Corners<Away> {
    /// The lists of shortest paths, unless their cells cannot be numbered.
    pub fn shortest(paths: &Paths<'_>) -> Option<Self> {
        let slots = paths.vertex_of_slot.len();
        let scratch = || Scratch::new(paths, slots);
        Self::make(paths, MOST, scratch, |scratch, first, rank| scratch.corners_of(paths, first, rank))
    }
}

impl Corners<Turned> {
    /// The lists of straightest paths, unless they would hold more than `most` cells.
    pub fn straightest(paths: &Paths<'_>, most: usize) -> Option<Self> {
        let scratch = || Scratch::new(paths, 0);
        Self::make(paths, most.min(MOST), scratch, |scratch, first, rank| {
            scratch.lists_of::<_, All>(paths, first, rank)
        })
    }
}

impl<C: Cell> Corners<C> {
    fn make(
        paths: &Paths<'_>,
        most: usize,
        scratch: impl Fn() -> Scratch + Send + Sync,
        of_rank: impl Fn(&mut Scratch, &[u32], usize) -> Self + Send + Sync,
    ) -> Option<Self> {
        let graph = paths.graph;
        let mut ways = 0u32;
        let mut first = Vec::with_capacity(graph.len());
        for &degree in &graph.degree {
            first.push(ways);
            ways = ways.checked_add(degree)?;
        }
        let mut all = Self { list_of_way: Vec::with_capacity(ways as usize), ..Self::new() };
        for block in (0..graph.len()).step_by(BLOCK) {
            let ranks = block..graph.len().min(block + BLOCK);
            let of_rank = |scratch: &mut Scratch, rank| of_rank(scratch, &first, rank);
            let parts: Vec<Self> = ranks.into_par_iter().map_init(&scratch, of_rank).collect();
            let cells = parts.iter().map(|part| part.cells.len()).sum::<usize>();
            if all.cells.len() + cells > most {
                return None;
            }
            parts.iter().for_each(|part| all.add(part));
        }
        let Self { list_of_way, cells, .. } = &mut all;
        cells.par_iter_mut().for_each(|cell| *cell.list() = list_of_way[*cell.list() as usize]);
        Some(Self { first, ..all })
    }

    fn new() -> Self {
        Self { list_of_way: Vec::new(), first: Vec::new(), end: Vec::new(), cells: Vec::new() }
    }

    #[cfg(test)]
    pub fn len(&self) -> usize {
        self.cells.len()
    }

    fn add(&mut self, part: &Self) {
        let (lists, cells) = (self.end.len() as u32, self.cells.len() as u32);
        let moved = |&list: &u32| if list == NONE { list } else { list + lists };
        self.list_of_way.extend(part.list_of_way.iter().map(moved));
        self.end.extend(part.end.iter().map(|end| end + cells));
        self.cells.extend_from_slice(&part.cells);
    }

    /// A list by its number.
    #[inline(always)]
    pub fn list(&self, number: u32) -> List {
        match (number.checked_sub(1), self.end.get(number as usize)) {
            (_, None) => NOTHING,
            (None, Some(&end)) => [0, end],
            (Some(before), Some(&end)) => [self.end[before as usize], end],
        }
    }

    /// What a list holds.
    #[inline(always)]
    pub fn cells(&self, [start, end]: List) -> &[C] {
        self.cells.get(start as usize..end as usize).unwrap_or_default()
    }

    /// The list of one of the ways from a rank, in the order of the graph.
    #[inline(always)]
    pub fn list_of(&self, rank: usize, place: u32) -> List {
        self.list(self.number_of(rank, place))
    }

    /// The number of that list, or [`NONE`].
    #[inline(always)]
    pub fn number_of(&self, rank: usize, place: u32) -> u32 {
        self.list_of_way[(self.first[rank] + place) as usize]
    }

    /// How many lists there are.
    pub fn lists(&self) -> usize {
        self.end.len()
    }
}

impl Scratch {
    fn new(paths: &Paths<'_>, slots: usize) -> Self {
        let own = vec![0; paths.graph.tiles.count()];
        Self { own, best: vec![f32::INFINITY; slots], touched: Vec::new() }
    }

    /// The lists of one rank, numbered from 0.
    fn corners_of(&mut self, paths: &Paths<'_>, first: &[u32], rank: usize) -> Corners<Away> {
        match paths.path {
            // SAFETY: a path is only made for a processor that has its instructions.
            #[cfg(target_arch = "x86_64")]
            #[allow(unsafe_code)]
            Path::Avx512 => unsafe { self.corners_of_avx512(paths, first, rank) },
            #[cfg(target_arch = "x86_64")]
            #[allow(unsafe_code)]
            Path::Avx2 => unsafe { self.corners_of_avx2(paths, first, rank) },
            Path::Portable => self.corners_of_in::<Portable>(paths, first, rank),
        }
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx512f,avx512dq,avx2,popcnt,bmi1,bmi2")]
    fn corners_of_avx512(&mut self, paths: &Paths<'_>, first: &[u32], rank: usize) -> Corners<Away> {
        self.corners_of_in::<Avx2>(paths, first, rank)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,popcnt,bmi1,bmi2")]
    fn corners_of_avx2(&mut self, paths: &Paths<'_>, first: &[u32], rank: usize) -> Corners<Away> {
        self.corners_of_in::<Avx2>(paths, first, rank)
    }

    #[inline(always)]
    fn corners_of_in<R: Rows>(&mut self, paths: &Paths<'_>, first: &[u32], rank: usize) -> Corners<Away> {
        self.own_of(paths, rank, true);
        let (tiles, masks) = paths.graph.row(rank);
        for (&t, &mask) in tiles.iter().zip(masks) {
            let mut bits = mask & paths.turns[t as usize];
            while bits != 0 {
                self.measure(paths, rank, t << 6 | bits.trailing_zeros());
                bits &= bits - 1;
            }
        }
        let lists = self.lists_of::<_, OnlyShortest<R>>(paths, first, rank);
        for tile in self.touched.drain(..) {
            self.best[tile as usize * 64..][..64].fill(f32::INFINITY);
        }
        lists
    }

    /// Sets what a rank sees, or nothing.
    #[inline(always)]
    fn own_of(&mut self, paths: &Paths<'_>, rank: usize, sees: bool) {
        let (tiles, masks) = paths.graph.row(rank);
        for (&t, &mask) in tiles.iter().zip(masks) {
            self.own[t as usize] = if sees { mask } else { 0 };
        }
        let (tile, bit) = paths.graph.tiles.slot_of[rank];
        let own = &mut self.own[tile as usize];
        *own = if sees { *own | 1 << bit } else { 0 };
    }

    /// The lists of one rank, numbered from 0; `add` puts in what is beyond a slot, with the numbers of ways instead of
    /// those of lists.
    #[inline(always)]
    fn lists_of<C: Cell, A: Adds<C>>(&mut self, paths: &Paths<'_>, first: &[u32], rank: usize) -> Corners<C> {
        let mut lists = Corners::new();
        self.own_of(paths, rank, true);
        let (tiles, masks) = paths.graph.row(rank);
        for (&t, &mask) in tiles.iter().zip(masks) {
            let mut bits = mask;
            while bits != 0 {
                let via = t << 6 | bits.trailing_zeros();
                bits &= bits - 1;
                let start = lists.cells.len();
                if paths.may_turn(via) {
                    A::add(self, (paths, first, rank), via, &mut lists.cells);
                }
                if lists.cells.len() > start {
                    lists.list_of_way.push(lists.end.len() as u32);
                    lists.end.push(lists.cells.len() as u32);
                } else {
                    lists.list_of_way.push(NONE);
                }
            }
        }
        self.own_of(paths, rank, false);
        lists
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
                let others = &OTHERS[some as usize & 0xff];
                for i in 0..ROW {
                    let way = ways[i] + others[i];
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
        cells: &mut Vec<Away>,
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
                    cells.push(Away { length: paths.single(via, slot), slot, list: way });
                }
            }
            way += mask.count_ones();
        }
    }

    /// Adds all that `via` sees and the vertex does not.
    #[inline(always)]
    fn add_all(&self, paths: &Paths<'_>, first: &[u32], rank: usize, via: u32, cells: &mut Vec<Turned>) {
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
                let list = way + (mask & ((1 << bit) - 1)).count_ones();
                cells.push(Turned { turn: turn(heading, paths.direction(via, slot)), slot, list });
            }
            way += mask.count_ones();
        }
    }
}

/// Puts in what is beyond a slot, for the lists of a rank. No closure: those do not have the instructions of their function.
trait Adds<C> {
    fn add(scratch: &Scratch, of: (&Paths<'_>, &[u32], usize), via: u32, cells: &mut Vec<C>);
}

/// All that the slot sees and the rank does not.
struct All;

impl Adds<Turned> for All {
    #[inline(always)]
    fn add(
        scratch: &Scratch,
        (paths, first, rank): (&Paths<'_>, &[u32], usize),
        via: u32,
        cells: &mut Vec<Turned>,
    ) {
        scratch.add_all(paths, first, rank, via, cells);
    }
}

/// The cells to which the shortest ways of two pieces lead over the slot.
struct OnlyShortest<R>(PhantomData<R>);

impl<R: Rows> Adds<Away> for OnlyShortest<R> {
    #[inline(always)]
    fn add(
        scratch: &Scratch,
        (paths, first, rank): (&Paths<'_>, &[u32], usize),
        via: u32,
        cells: &mut Vec<Away>,
    ) {
        scratch.add_shortest::<R>(paths, first, rank, via, cells);
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
        let first = paths.single(tile << 6 | u32::from(bit), via);
        Self { first, via }
    }

    /// The next row of `bits`, which are taken off.
    #[inline(always)]
    fn next_row(&self, paths: &Paths<'_>, tile: u32, bits: &mut u64) -> Option<Beyond> {
        let (row, some) = next_row(bits)?;
        let lengths = paths.row(&paths.offsets.singles, self.via, tile << 6 | row, single_of);
        let mut ways = [0.0; ROW];
        for i in 0..ROW {
            ways[i] = self.first + lengths[i];
        }
        Some((tile << 6 | row, some, ways))
    }
}

//! Stage "visibility": which cells see each other, exactly (spec: visibility graph).
//!
//! Each viewer sweeps the lattice row by row upwards, with the list of slope intervals that nothing blocks
//! yet; what lies below follows, since sight is mutual. Slopes are f64; wherever two of them come nearer
//! than the rounding error allows to tell apart, the decision is made in whole numbers, so the result
//! equals the pairwise test of every sight line against every wall.

mod vista;
mod windows;

use std::sync::Arc;

use rayon::prelude::*;

use crate::geometry::{Segment, segments_touch};

pub use super::graph::Graph;
use super::graph::RowChunk;
use super::halves::{Half, Halves};
use super::strips::{self, CUT, EndId, Fraction, NEGATIVE_INFINITY, POSITIVE_INFINITY, Piece, Strips};
use super::tiles::{NO_TILE, Tiles};
use super::{Lattice, Obstacles};
pub use vista::Vista;
pub use windows::Window;
use windows::{Views, Windows};

/// Marks the end of a view through windows, by its place: no wall has so many points.
const VIEW: EndId = 1 << 62;

/// Stands for an infinite slope and stays finite in arithmetic.
const HUGE: f64 = 1e300;

/// Two cells see each other iff the closed segment between their centres touches no obstacle and
/// neither is blind. Exact; runs on the current rayon pool; the same bits on any number of threads.
pub fn visibility_graph(lattice: &Lattice, obstacles: &Obstacles) -> Graph {
    let tiles = Arc::new(Tiles::new(lattice));
    match Strips::new(lattice, &tiles, obstacles) {
        Some(strips) => swept((lattice, tiles), &strips, None),
        None => pairwise_graph(lattice, obstacles),
    }
}

/// The graph under walls that were cut already, through windows where there are any.
fn swept((lattice, tiles): (&Lattice, Arc<Tiles>), strips: &Strips, windows: Option<&[&[Window]]>) -> Graph {
    let low_um = strips::low_um(lattice, &tiles);
    let windows = windows.map(|groups| Windows::new(groups, low_um, strips.columns as f64));
    let all = (0..tiles.count()).into_par_iter();
    let look = |sweep: &mut Sweep<'_>, t: usize| sweep.half(t);
    let new = || Sweep { windows: windows.as_ref(), ..Sweep::new(strips, &tiles) };
    let halves = all.clone().map_init(new, look).collect();
    let halves = Halves::new(&tiles, halves);
    let chunks = all.map_init(Vec::new, |squares, t| halves.rows(t, squares)).collect();
    drop(halves);
    Graph::from_chunks(tiles, chunks)
}

/// Tiles whose views are looked at to foresee how large a graph becomes.
const FORESEEN_TILES: usize = 96;

/// What a run takes beside the parts of its graph, as a factor: up to 1.25 times these were measured on halls of 70,000
/// to 830,000 vertices with screens.
const RUN_SHARE: f64 = 1.25;

/// About how much memory a run that makes the graph takes at its peak, bytes, where that is more than `limit`: from the views of
/// some tiles, so to a tenth or two where a plan is much the same everywhere. A lattice that fits even without an obstacle
/// is not looked at.
pub fn bytes_beyond(lattice: &Lattice, obstacles: &Obstacles, limit: u64) -> Option<u64> {
    let tiles = Tiles::new(lattice);
    let (vertices, count) = (lattice.cells.len() as f64, tiles.count() as f64);
    let open = peak_bytes(count * (count + 1.0) / 2.0, vertices * count);
    if open <= limit {
        return None;
    }
    let Some(strips) = Strips::new(lattice, &tiles, obstacles) else { return Some(open) };
    let step = tiles.count().div_ceil(FORESEEN_TILES);
    let some: Vec<usize> = (step / 2..tiles.count()).step_by(step).collect();
    let look = |sweep: &mut Sweep<'_>, t: &usize| sweep.half(*t).sizes();
    let add = |a: [u64; 2], b: [u64; 2]| [a[0] + b[0], a[1] + b[1]];
    let seen = some.par_iter().map_init(|| Sweep::new(&strips, &tiles), look).reduce(|| [0; 2], add);
    let [squares, entries] = seen.map(|n| n as f64 * count / some.len() as f64);
    // Who is seen above sees below.
    let needed = peak_bytes(squares, 2.0 * entries).min(open);
    (needed > limit).then_some(needed)
}

/// Memory for the halves of a graph, the rows made of them, and the graph made of these, bytes: all three, since what is
/// freed in small pieces is not given back to the machine. What grows by doubling is on average half as large again.
fn peak_bytes(squares: f64, entries: f64) -> u64 {
    let halves = 1.5 * squares * (64 * size_of::<u64>()) as f64;
    let entries = entries * (size_of::<u32>() + size_of::<u64>()) as f64;
    (RUN_SHARE * (halves + 1.5 * entries + entries)) as u64
}

/// [`visibility_graph`] on the calling thread alone.
pub(super) fn visibility_graph_serial(lattice: &Lattice, obstacles: &Obstacles) -> Graph {
    let tiles = Tiles::new(lattice);
    let Some(strips) = Strips::new(lattice, &tiles, obstacles) else {
        return pairwise_graph(lattice, obstacles);
    };
    let tiles = Arc::new(tiles);
    let (mut sweep, mut squares) = (Sweep::new(&strips, &tiles), Vec::new());
    let halves = Halves::new(&tiles, (0..tiles.count()).map(|t| sweep.half(t)).collect());
    let chunks = (0..tiles.count()).map(|t| halves.rows(t, &mut squares)).collect();
    drop(halves);
    Graph::from_chunks(tiles, chunks)
}

/// The same graph by testing every pair against every obstacle: for lattices beyond the sweep's limits.
fn pairwise_graph(lattice: &Lattice, obstacles: &Obstacles) -> Graph {
    let tiles = Tiles::new(lattice);
    let n = lattice.cells.len();
    let mut blind = vec![false; n];
    obstacles.blind.iter().for_each(|&v| blind[v as usize] = true);
    let row = |rank: usize| {
        let u = tiles.vertex_of[rank] as usize;
        let mut chunk = RowChunk::default();
        let mut degree = 0;
        for (other, &(tile, bit)) in tiles.slot_of.iter().enumerate() {
            let v = tiles.vertex_of[other] as usize;
            let sight = Segment { a: lattice.centre_um(u), b: lattice.centre_um(v) };
            let touches = |s: &Segment| segments_touch(sight, *s);
            if u == v || blind[u] || blind[v] || obstacles.segments.iter().any(touches) {
                continue;
            }
            if chunk.tile.last() != Some(&tile) {
                chunk.tile.push(tile);
                chunk.mask.push(0);
            }
            if let Some(mask) = chunk.mask.last_mut() {
                *mask |= 1 << bit;
            }
            degree += 1;
        }
        chunk.rows.push((chunk.tile.len() as u32, degree));
        chunk
    };
    let chunks = (0..n).into_par_iter().map(row).collect();
    Graph::from_chunks(Arc::new(tiles), chunks)
}

/// Which vertices can see at all: no obstacle touches their centre and no solid covers them.
pub(super) fn seeing_cells(lattice: &Lattice, obstacles: &Obstacles) -> Vec<bool> {
    let tiles = Tiles::new(lattice);
    let Some(strips) = Strips::new(lattice, &tiles, obstacles) else {
        let touched = |v: usize| {
            let centre = lattice.centre_um(v);
            obstacles.segments.iter().any(|s| segments_touch(Segment { a: centre, b: centre }, *s))
        };
        let mut sees: Vec<bool> = (0..lattice.cells.len()).map(|v| !touched(v)).collect();
        obstacles.blind.iter().for_each(|&v| sees[v as usize] = false);
        return sees;
    };
    let slots = tiles.rank_of.iter().map(|&rank| tiles.slot_of[rank as usize]);
    slots.map(|(tile, bit)| strips.open[tile as usize] >> bit & 1 == 1).collect()
}

/// A slope with the identity of the point it passes through.
#[derive(Clone, Copy)]
struct End {
    slope: f64,
    id: EndId,
}

/// A closed blocked interval, or an open unblocked one.
#[derive(Clone, Copy)]
struct Interval {
    lo: End,
    hi: End,
}

/// One worker: buffers that live as long as it does.
struct Sweep<'a> {
    strips: &'a Strips,
    tiles: &'a Tiles,
    /// What is looked through; `None`: anything.
    windows: Option<&'a Windows>,
    /// What the viewer looks at, where there are windows.
    views: Views,
    gaps: Vec<Interval>,
    next_gaps: Vec<Interval>,
    blocks: Vec<Interval>,
    /// Cells seen, by tile, and a bitmap of the tiles that have any; the last tile is a dump.
    seen: Vec<u64>,
    touched: Vec<u64>,
    /// Places of the squares of a half, by tile; `u32::MAX` between halves.
    places: Vec<u32>,
    viewer: Viewer,
    /// Slopes beyond this lie outside every row of the lattice and count as infinite.
    steep: f64,
    /// Largest difference of two computed slopes, not steep, that proves nothing.
    tolerance: f64,
}

#[derive(Clone, Copy, Default)]
struct Viewer {
    column: usize,
    row: usize,
    at: [i64; 2],
    x: f64,
    y: f64,
}

impl<'a> Sweep<'a> {
    fn new(strips: &'a Strips, tiles: &'a Tiles) -> Self {
        Self {
            strips,
            tiles,
            windows: None,
            views: Views::default(),
            gaps: Vec::new(),
            next_gaps: Vec::new(),
            blocks: Vec::new(),
            seen: vec![0; tiles.count() + 1],
            touched: vec![0; tiles.count() / 64 + 1],
            places: vec![u32::MAX; tiles.count()],
            viewer: Viewer::default(),
            steep: strips.columns as f64,
            tolerance: (strips.extent_cells + strips.columns as f64) * (-46f64).exp2(),
        }
    }

    /// What the viewers of a tile see on their rows and above.
    fn half(&mut self, t: usize) -> Half {
        #[cfg(target_arch = "x86_64")]
        if is_x86_feature_detected!("popcnt") && is_x86_feature_detected!("bmi1") {
            // SAFETY: the processor has just been asked.
            #[allow(unsafe_code)]
            return unsafe { self.half_bits(t) };
        }
        self.half_in(t)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "popcnt,bmi1")]
    fn half_bits(&mut self, t: usize) -> Half {
        self.half_in(t)
    }

    #[inline(always)]
    fn half_in(&mut self, t: usize) -> Half {
        let mut half = Half::default();
        if self.sees_no_window(t) {
            return half;
        }
        let mut viewers = self.strips.open[t];
        while viewers != 0 {
            let bit = viewers.trailing_zeros() as u8;
            viewers &= viewers - 1;
            self.look(t as u32, bit);
            self.collect(t as u32, bit, &mut half);
        }
        half.finish(&mut self.places);
        half
    }

    /// Whether nobody in a tile looks through the windows, upwards or along his row.
    fn sees_no_window(&mut self, t: usize) -> bool {
        let Some(windows) = self.windows else { return false };
        let at = |cell: u32| (i64::from(cell) * self.strips.spacing_um) as f64;
        let low = self.tiles.tile_at[t].map(|tile| at(tile * 8));
        windows.look([low, low.map(|v| v + at(7))], &mut self.views);
        self.views.above.is_empty() && self.views.is_row_closed
    }

    /// Fills `seen` for the viewer at a bit of a tile.
    fn look(&mut self, tile: u32, bit: u8) {
        let [tile_column, tile_row] = self.tiles.tile_at[tile as usize];
        let column = tile_column as usize * 8 + usize::from(bit & 7);
        let row = tile_row as usize * 8 + usize::from(bit >> 3);
        let at = [column as i64 * self.strips.spacing_um, row as i64 * self.strips.spacing_um];
        self.viewer = Viewer { column, row, at, x: at[0] as f64, y: at[1] as f64 };
        if let Some(windows) = self.windows {
            windows.look([[self.viewer.x, self.viewer.y]; 2], &mut self.views);
        }
        if self.windows.is_none() || !self.views.is_row_closed {
            self.own_row();
        }
        self.sweep();
    }

    /// Moves what was seen into a half and clears the buffers.
    #[inline(always)]
    fn collect(&mut self, tile: u32, bit: u8, half: &mut Half) {
        self.seen[tile as usize] &= !(1 << bit);
        for word in 0..self.touched.len() {
            let mut bits = std::mem::take(&mut self.touched[word]);
            while bits != 0 {
                let t = word * 64 + bits.trailing_zeros() as usize;
                bits &= bits - 1;
                let mask = std::mem::take(&mut self.seen[t]) & self.strips.open.get(t).copied().unwrap_or(0);
                if mask != 0 {
                    half.add(&mut self.places, bit, t as u32, mask);
                }
            }
        }
    }

    /// Own row: up to the first broken link on either side.
    fn own_row(&mut self) {
        let words = self.strips.words_per_row;
        let row = &self.strips.broken[self.viewer.row * words..][..words];
        let c = self.viewer.column;
        let mut right = self.strips.columns - 1;
        for (w, &word) in row.iter().enumerate().skip(c / 64) {
            let word = if w == c / 64 { word & (u64::MAX << (c % 64)) } else { word };
            if word != 0 {
                right = right.min(w * 64 + word.trailing_zeros() as usize);
                break;
            }
        }
        let mut left = 0;
        for w in (0..=c / 64).rev() {
            let word = if w == c / 64 { row[w] & ((1u64 << (c % 64)) - 1) } else { row[w] };
            if word != 0 {
                left = w * 64 + 64 - word.leading_zeros() as usize;
                break;
            }
        }
        self.mark(self.viewer.row, left, right);
    }

    /// The half plane above the viewer.
    fn sweep(&mut self) {
        let rows = self.strips.rows - 1 - self.viewer.row;
        if rows == 0 {
            return;
        }
        match self.windows {
            None => self.first_strip(),
            Some(_) if self.views.above.is_empty() => return,
            Some(_) => self.first_strip_through(),
        }
        for distance in 1..=rows {
            self.emit(distance);
            if self.gaps.is_empty() || distance == rows {
                break;
            }
            self.advance(distance);
        }
        self.gaps.clear();
    }

    /// From the viewer's row to the next, through the windows alone.
    fn first_strip_through(&mut self) {
        let end = |slope: f64, place: usize| self.end(slope, VIEW | place as EndId);
        let views = self.views.above.iter().enumerate();
        self.gaps = views.map(|(i, v)| Interval { lo: end(v[0], 2 * i), hi: end(v[1], 2 * i + 1) }).collect();
        self.advance(0);
    }

    /// From the viewer's row to the next: looks right and left as far as nothing closes the view.
    fn first_strip(&mut self) {
        let strips = self.strips;
        let base = self.viewer.row * strips.bins;
        let bin = self.viewer.column >> strips.bin_shift;
        let width = (1u64 << strips.bin_shift) as f64;
        self.blocks.clear();
        let whole = Interval {
            lo: End { slope: -HUGE, id: NEGATIVE_INFINITY },
            hi: End { slope: HUGE, id: POSITIVE_INFINITY },
        };
        let carried = strips.carried_start[base + bin]..strips.carried_start[base + bin + 1];
        let (mut left, mut right) = (-HUGE, HUGE);
        for &p in &strips.carried[carried.start as usize..carried.end as usize] {
            self.block(&strips.pieces[p as usize], whole, &mut left, &mut right);
        }
        let column = self.viewer.column as f64;
        let starts = strips.start[base + bin] as usize..strips.start[base + strips.bins] as usize;
        for piece in &strips.pieces[starts] {
            if f64::from(piece.first_bin) * width - column > right + 1.0 {
                break;
            }
            self.block(piece, whole, &mut left, &mut right);
        }
        let ends = strips.end_start[base] as usize..strips.end_start[base + bin] as usize;
        for &p in strips.by_end[ends].iter().rev() {
            let piece = &strips.pieces[p as usize];
            if f64::from(piece.last_bin + 1) * width - column < left - 1.0 {
                break;
            }
            self.block(piece, whole, &mut left, &mut right);
        }
        self.next_gaps.clear();
        self.subtract(whole);
        std::mem::swap(&mut self.gaps, &mut self.next_gaps);
    }

    /// Subtracts the strip beyond row `distance` from all gaps.
    fn advance(&mut self, distance: usize) {
        let strips = self.strips;
        let base = (self.viewer.row + distance) * strips.bins;
        let (near, far) = (distance as f64, (distance + 1) as f64);
        let last = (strips.columns - 1) as f64;
        let column = self.viewer.column as f64;
        self.next_gaps.clear();
        for g in 0..self.gaps.len() {
            let gap = self.gaps[g];
            let left = column + gap.lo.slope * if gap.lo.slope < 0.0 { far } else { near } - 1e-3;
            let right = column + gap.hi.slope * if gap.hi.slope < 0.0 { near } else { far } + 1e-3;
            if left > last || right < 0.0 {
                continue;
            }
            let first_bin = left.max(0.0) as usize >> strips.bin_shift;
            let last_bin = right.min(last) as usize >> strips.bin_shift;
            self.blocks.clear();
            let carried = strips.carried_start[base + first_bin]..strips.carried_start[base + first_bin + 1];
            let (mut l, mut r) = (0.0, 0.0);
            for &p in &strips.carried[carried.start as usize..carried.end as usize] {
                self.block(&strips.pieces[p as usize], gap, &mut l, &mut r);
            }
            let starts = strips.start[base + first_bin] as usize..strips.start[base + last_bin + 1] as usize;
            for piece in &strips.pieces[starts] {
                self.block(piece, gap, &mut l, &mut r);
            }
            self.subtract(gap);
        }
        std::mem::swap(&mut self.gaps, &mut self.next_gaps);
    }

    /// Files the interval a piece blocks, if it may meet `gap`; keeps `blocks` sorted by lower end.
    /// An interval that reaches to an infinite slope closes the view on that side: `left`, `right`.
    fn block(&mut self, piece: &Piece, gap: Interval, left: &mut f64, right: &mut f64) {
        let height = piece.y.map(|y| y - self.viewer.y);
        if height[1] <= 0.0 {
            return;
        }
        let far = self.end((piece.x[1] - self.viewer.x) / height[1], piece.id[1]);
        let reach = piece.x[0] - self.viewer.x;
        let near = if height[0] > 0.0 {
            self.end(reach / height[0], piece.id[0])
        } else if reach > 0.0 {
            *right = right.min(far.slope);
            gap.hi
        } else {
            *left = left.max(far.slope);
            gap.lo
        };
        let (lo, hi) = if self.less(far, near) { (far, near) } else { (near, far) };
        if !self.less(gap.lo, hi) || !self.less(lo, gap.hi) {
            return;
        }
        let mut at = self.blocks.len();
        while at > 0 && self.less(lo, self.blocks[at - 1].lo) {
            at -= 1;
        }
        self.blocks.insert(at, Interval { lo, hi });
    }

    #[inline(always)]
    fn end(&self, slope: f64, id: EndId) -> End {
        if slope > self.steep {
            End { slope: HUGE, id: POSITIVE_INFINITY }
        } else if slope < -self.steep {
            End { slope: -HUGE, id: NEGATIVE_INFINITY }
        } else {
            End { slope, id }
        }
    }

    /// Appends to `next_gaps` what `blocks` leave of `gap`.
    fn subtract(&mut self, gap: Interval) {
        let mut from = gap.lo;
        for b in 0..self.blocks.len() {
            let block = self.blocks[b];
            if self.less(from, block.lo) {
                self.next_gaps.push(Interval { lo: from, hi: block.lo });
            }
            if self.less(from, block.hi) {
                from = block.hi;
            }
        }
        if self.less(from, gap.hi) {
            self.next_gaps.push(Interval { lo: from, hi: gap.hi });
        }
    }

    /// Marks the cells of row `distance` that lie strictly inside a gap.
    fn emit(&mut self, distance: usize) {
        let row = self.viewer.row + distance;
        let (d, column) = (distance as f64, self.viewer.column as f64);
        let last = self.strips.columns as f64 - 1.0;
        for g in 0..self.gaps.len() {
            let gap = self.gaps[g];
            let lo = column + gap.lo.slope * d;
            let hi = column + gap.hi.slope * d;
            if lo > last + 0.5 || hi < -0.5 {
                continue;
            }
            let first = if lo < -0.5 { 0 } else { self.column_beside(gap.lo, lo, distance, true) };
            let end =
                if hi > last + 0.5 { last as i64 } else { self.column_beside(gap.hi, hi, distance, false) };
            if first <= end {
                self.mark(row, first as usize, end as usize);
            }
        }
    }

    /// The first whole column strictly right of a slope (`right`), or the last strictly left of it, at
    /// `position` on row `distance`; clamped to the lattice.
    fn column_beside(&self, end: End, position: f64, distance: usize, right: bool) -> i64 {
        let d = distance as f64;
        let near = (position + 0.5) as i64 as f64;
        let error = self.tolerance * d + 1e-9;
        let column = if (position - near).abs() > error {
            near as i64 + if right { i64::from(near < position) } else { -i64::from(near > position) }
        } else {
            let cell = Fraction {
                num: i128::from((near as i64 - self.viewer.column as i64) * self.strips.spacing_um),
                den: i128::from(distance as i64 * self.strips.spacing_um),
            };
            let order = cell.compare(self.fraction(end.id));
            match right {
                true => near as i64 + i64::from(order.is_le()),
                false => near as i64 - i64::from(order.is_ge()),
            }
        };
        if right { column.max(0) } else { column.min(self.strips.columns as i64 - 1) }
    }

    /// Whether slope `a` is smaller than slope `b`; exact.
    #[inline]
    fn less(&self, a: End, b: End) -> bool {
        let difference = b.slope - a.slope;
        if difference.abs() > self.tolerance {
            return difference > 0.0;
        }
        a.id != b.id && self.less_exactly(a.id, b.id)
    }

    #[cold]
    fn less_exactly(&self, a: EndId, b: EndId) -> bool {
        self.fraction(a).compare(self.fraction(b)).is_lt()
    }

    /// The slope of an end, exactly.
    fn fraction(&self, id: EndId) -> Fraction {
        match id & (CUT | VIEW) {
            VIEW => self.views.slope((id & !VIEW) as usize),
            _ => self.strips.fraction(id, self.viewer.at),
        }
    }

    /// Adds the cells `first..=last` of a row to what is seen.
    fn mark(&mut self, row: usize, first: usize, last: usize) {
        let tiles = &self.tiles.grid[(row >> 3) * self.tiles.size_tiles[0]..][..self.tiles.size_tiles[0]];
        let shift = (row & 7) * 8;
        for (column, &tile) in tiles.iter().enumerate().take((last >> 3) + 1).skip(first >> 3) {
            let from = first.saturating_sub(column * 8);
            let to = (last - column * 8).min(7);
            let bits = (0xffu64 >> (7 - to)) & (0xff << from);
            let tile = if tile == NO_TILE { self.seen.len() - 1 } else { tile as usize };
            self.seen[tile] |= bits << shift;
            self.touched[tile >> 6] |= 1 << (tile & 63);
        }
    }
}

#[cfg(test)]
#[path = "visibility_tests.rs"]
mod tests;

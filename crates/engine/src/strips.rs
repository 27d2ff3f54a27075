//! Walls cut at the lattice rows and filed by strip and column: what a viewer sweeping row by row meets.
//!
//! Local frame: origin at the lower left cell centre of the vertices' box, whole micrometres. Strip `k`
//! lies between rows `k` and `k + 1`. The ends of a piece are either real wall ends or cuts of a wall
//! at a row; each has an identity, so that two ends that nearly coincide can be compared exactly.

use crate::geometry::Segment;

use super::tiles::{NO_TILE, Tiles};
use super::{Lattice, Obstacles};

/// Largest local coordinate, micrometres: differences stay exact in f64 and products in 128 bits.
pub(super) const MAX_COORDINATE_UM: i64 = 1 << 50;

/// Largest local coordinate in cells, and [`MAX_ROWS`]: together they keep the rounding error of a
/// slope times a row number far below half a cell.
pub(super) const MAX_COORDINATE_CELLS: i64 = 1 << 23;

/// See [`MAX_COORDINATE_CELLS`].
pub(super) const MAX_ROWS: usize = 1 << 20;

/// Strip tables hold at most so many bins per vertex (and [`BIN_FLOOR`]); bins widen beyond that.
const BINS_PER_VERTEX: usize = 16;

/// See [`BINS_PER_VERTEX`].
const BIN_FLOOR: usize = 1 << 16;

/// Identity of the end of a blocked slope interval.
pub(super) type EndId = u64;

/// The slope of the viewer's own row, to the right.
pub(super) const POSITIVE_INFINITY: EndId = u64::MAX;

/// The slope of the viewer's own row, to the left.
pub(super) const NEGATIVE_INFINITY: EndId = u64::MAX - 1;

/// Marks the cut of a wall at a row.
pub(super) const CUT: EndId = 1 << 63;

/// The part of one wall inside one strip; `y[0] <= y[1]`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Piece {
    pub x: [f64; 2],
    pub y: [f64; 2],
    pub id: [EndId; 2],
    pub first_bin: u32,
    pub last_bin: u32,
}

/// See the module page.
#[derive(Debug, Default)]
pub(super) struct Strips {
    pub spacing_um: i64,
    pub columns: usize,
    pub rows: usize,
    /// Largest local coordinate of anything here, in cells.
    pub extent_cells: f64,
    /// Bin of column `c` is `c >> bin_shift`.
    pub bin_shift: u32,
    /// Bins of a strip.
    pub bins: usize,
    /// By strip, then first bin.
    pub pieces: Vec<Piece>,
    /// First piece of `strip * bins + bin`, one entry more.
    pub start: Vec<u32>,
    /// Pieces by strip, then last bin; with its own offsets.
    pub by_end: Vec<u32>,
    pub end_start: Vec<u32>,
    /// Pieces that reach into `strip * bins + bin` from the left; with its own offsets.
    pub carried: Vec<u32>,
    pub carried_start: Vec<u32>,
    /// Bit `c` of a row: a wall touches the closed link between columns `c` and `c + 1`.
    pub broken: Vec<u64>,
    pub words_per_row: usize,
    /// Vertices of each tile that no wall touches and no solid covers.
    pub open: Vec<u64>,
    walls: Vec<Segment>,
    points: Vec<[i64; 2]>,
}

/// A slope as seen by a viewer, `num / den` with `den > 0`.
#[derive(Clone, Copy)]
pub(super) struct Fraction {
    pub num: i128,
    pub den: i128,
}

impl Fraction {
    /// Exact comparison; falls back to continued fractions where products overflow.
    pub fn compare(self, other: Self) -> std::cmp::Ordering {
        match (self.num.checked_mul(other.den), other.num.checked_mul(self.den)) {
            (Some(a), Some(b)) => a.cmp(&b),
            _ => self.compare_by_quotients(other),
        }
    }

    fn compare_by_quotients(mut self, mut other: Self) -> std::cmp::Ordering {
        loop {
            let whole = self.num.div_euclid(self.den).cmp(&other.num.div_euclid(other.den));
            let rest = [self.num.rem_euclid(self.den), other.num.rem_euclid(other.den)];
            if whole.is_ne() || rest[0] == 0 || rest[1] == 0 {
                return whole.then(rest[0].signum().cmp(&rest[1].signum()));
            }
            (self, other) = (Self { num: other.den, den: rest[1] }, Self { num: self.den, den: rest[0] });
        }
    }
}

/// The zero point of the local frame: the lowest vertex, drawing frame.
pub(super) fn low_um(lattice: &Lattice, tiles: &Tiles) -> [i64; 2] {
    [0, 1].map(|k| lattice.origin_um[k] + tiles.min_cell[k] * lattice.spacing_um)
}

impl Strips {
    /// `None` if the lattice is too sparse or a coordinate too large for the sweep's arithmetic.
    pub fn new(lattice: &Lattice, tiles: &Tiles, obstacles: &Obstacles) -> Option<Self> {
        if tiles.grid.is_empty() || tiles.size_cells[1] > MAX_ROWS {
            return None;
        }
        let mut strips = Self {
            spacing_um: lattice.spacing_um,
            columns: tiles.size_cells[0],
            rows: tiles.size_cells[1],
            words_per_row: tiles.size_cells[0].div_ceil(64),
            open: tiles.occupied.clone(),
            ..Self::default()
        };
        strips.take_walls(lattice, tiles, &obstacles.segments)?;
        strips.broken = vec![0; strips.words_per_row * strips.rows];
        for w in 0..strips.walls.len() {
            strips.mark_rows(tiles, strips.walls[w]);
        }
        for &v in &obstacles.blind {
            let (tile, bit) = tiles.slot_of[tiles.rank_of[v as usize] as usize];
            strips.open[tile as usize] &= !(1 << bit);
        }
        strips.file();
        Some(strips)
    }

    /// Keeps the walls that meet the box of the vertices, in the local frame, lower end first.
    fn take_walls(&mut self, lattice: &Lattice, tiles: &Tiles, segments: &[Segment]) -> Option<()> {
        let s = lattice.spacing_um;
        let low = low_um(lattice, tiles);
        let size = [(self.columns - 1) as i64 * s, (self.rows - 1) as i64 * s];
        for segment in segments {
            let (a, b) = (segment.a, segment.b);
            if (0..2).any(|k| a[k].max(b[k]) < low[k] || a[k].min(b[k]) > low[k] + size[k]) {
                continue;
            }
            let local = |p: [i64; 2]| Some([p[0].checked_sub(low[0])?, p[1].checked_sub(low[1])?]);
            let (a, b) = (local(a)?, local(b)?);
            let (a, b) = if (a[1], a[0]) <= (b[1], b[0]) { (a, b) } else { (b, a) };
            self.walls.push(Segment { a, b });
        }
        self.walls.sort_unstable();
        self.walls.dedup();
        let ends = self.walls.iter().flat_map(|w| [w.a, w.b]);
        let extent = ends.flatten().map(i64::abs).chain(size).max().unwrap_or(0);
        self.extent_cells = extent as f64 / s as f64 + 1.0;
        (extent <= MAX_COORDINATE_UM && extent / s < MAX_COORDINATE_CELLS).then_some(())
    }

    /// Marks the cells and links of the lattice rows that a wall touches.
    fn mark_rows(&mut self, tiles: &Tiles, wall: Segment) {
        let s = self.spacing_um;
        let first = wall.a[1].max(0).div_euclid(s) + i64::from(wall.a[1].max(0) % s != 0);
        let last = wall.b[1].div_euclid(s).min(self.rows as i64 - 1);
        for row in first..=last {
            // Smallest and largest column position the wall touches on this row, as whole columns
            // rounded outwards (links) and inwards (cells).
            let (lo, hi) = if wall.a[1] == wall.b[1] {
                ((floor_ceil(wall.a[0], s)), (floor_ceil(wall.b[0], s)))
            } else {
                let at = self.cross_row(wall, row);
                (at, at)
            };
            self.break_links(row as usize, lo[1] - 1, hi[0]);
            self.close_cells(tiles, row as usize, lo[1], hi[0]);
        }
    }

    /// Floor and ceiling, in columns, of where a wall that is not level crosses a row.
    fn cross_row(&self, wall: Segment, row: i64) -> [i64; 2] {
        let s = self.spacing_um;
        if wall.a[0] == wall.b[0] {
            return floor_ceil(wall.a[0], s);
        }
        let guess = self.cut_x(wall, row) / s as f64;
        let near = guess.round();
        if (guess - near).abs() > 1e-4 {
            return [guess.floor() as i64, guess.ceil() as i64];
        }
        let at = cut_fraction(wall, row * s);
        let column = near as i64;
        match at.num.cmp(&(i128::from(column * s) * at.den)) {
            std::cmp::Ordering::Less => [column - 1, column],
            std::cmp::Ordering::Equal => [column, column],
            std::cmp::Ordering::Greater => [column, column + 1],
        }
    }

    fn break_links(&mut self, row: usize, first: i64, last: i64) {
        for c in first.max(0)..=last.min(self.columns as i64 - 1) {
            self.broken[row * self.words_per_row + c as usize / 64] |= 1 << (c % 64);
        }
    }

    fn close_cells(&mut self, tiles: &Tiles, row: usize, first: i64, last: i64) {
        for c in first.max(0)..=last.min(self.columns as i64 - 1) {
            let c = c as usize;
            let tile = tiles.grid[(row >> 3) * tiles.size_tiles[0] + (c >> 3)];
            if tile != NO_TILE {
                self.open[tile as usize] &= !(1 << ((row & 7) << 3 | (c & 7)));
            }
        }
    }

    /// Where a wall that is not level crosses a row, micrometres, rounded.
    fn cut_x(&self, wall: Segment, row: i64) -> f64 {
        let along = (row * self.spacing_um - wall.a[1]) as f64 / (wall.b[1] - wall.a[1]) as f64;
        wall.a[0] as f64 + (wall.b[0] - wall.a[0]) as f64 * along
    }

    /// Cuts all walls and files the pieces.
    fn file(&mut self) {
        self.points = self.walls.iter().flat_map(|w| [w.a, w.b]).collect();
        self.points.sort_unstable();
        self.points.dedup();
        let cells = self.rows * self.columns;
        let limit = BINS_PER_VERTEX * self.open.len() * 64 + BIN_FLOOR;
        self.bin_shift = cells.div_ceil(limit).next_power_of_two().trailing_zeros();
        self.bins = ((self.columns - 1) >> self.bin_shift) + 1;
        let mut keyed = Vec::new();
        for w in 0..self.walls.len() {
            self.cut(w, &mut keyed);
        }
        keyed.sort_unstable_by_key(|(key, piece): &(u32, Piece)| (*key, piece.id));
        let slots = self.rows.saturating_sub(1) * self.bins;
        let strip_of = |key: u32| key as usize / self.bins * self.bins;
        let mut carried = Vec::new();
        let mut by_end = Vec::with_capacity(keyed.len());
        for (i, (key, piece)) in keyed.iter().enumerate() {
            let base = strip_of(*key);
            by_end.push(((base + piece.last_bin as usize) as u32, i as u32));
            carried.extend((piece.first_bin + 1..=piece.last_bin).map(|b| (base as u32 + b, i as u32)));
        }
        self.start = offsets(slots, keyed.iter().map(|k| k.0));
        self.pieces = keyed.into_iter().map(|k| k.1).collect();
        (self.end_start, self.by_end) = filed(slots, by_end);
        (self.carried_start, self.carried) = filed(slots, carried);
    }

    fn cut(&self, w: usize, out: &mut Vec<(u32, Piece)>) {
        let (wall, s) = (self.walls[w], self.spacing_um);
        let last_strip = self.rows as i64 - 2;
        let below = wall.a[1].div_euclid(s) - i64::from(wall.a[1].rem_euclid(s) == 0);
        for strip in below.max(0)..=wall.b[1].div_euclid(s).min(last_strip) {
            let lower = self.end(w, wall.a, wall.a[1] >= strip * s, strip);
            let upper = self.end(w, wall.b, wall.b[1] <= (strip + 1) * s, strip + 1);
            let (left, right) = (lower.0.min(upper.0), lower.0.max(upper.0));
            let width = s as f64 * (1u64 << self.bin_shift) as f64;
            let last_bin = self.bins as f64 - 1.0;
            if right < 0.0 || left > (self.columns - 1) as f64 * s as f64 {
                continue;
            }
            let bin = |x: f64| (x / width).floor().clamp(0.0, last_bin) as u32;
            let piece = Piece {
                x: [lower.0, upper.0],
                y: [lower.1, upper.1],
                id: [lower.2, upper.2],
                first_bin: bin(left),
                last_bin: bin(right),
            };
            out.push(((strip as usize * self.bins) as u32 + piece.first_bin, piece));
        }
    }

    fn end(&self, w: usize, p: [i64; 2], real: bool, row: i64) -> (f64, f64, EndId) {
        if real {
            let id = self.points.partition_point(|q| *q < p) as EndId;
            return (p[0] as f64, p[1] as f64, id);
        }
        let y = (row * self.spacing_um) as f64;
        (self.cut_x(self.walls[w], row), y, CUT | (w as EndId) << 31 | row as EndId)
    }

    /// The slope of an end as seen from a cell, x over the height above the cell.
    pub fn fraction(&self, id: EndId, viewer: [i64; 2]) -> Fraction {
        match id {
            POSITIVE_INFINITY => Fraction { num: i128::MAX >> 2, den: 1 },
            NEGATIVE_INFINITY => Fraction { num: -(i128::MAX >> 2), den: 1 },
            _ if id & CUT == 0 => {
                let p = self.points[id as usize];
                Fraction { num: (p[0] - viewer[0]).into(), den: (p[1] - viewer[1]).into() }
            }
            _ => {
                let y = (id & 0x7fff_ffff) as i64 * self.spacing_um;
                let at = cut_fraction(self.walls[(id & !CUT) as usize >> 31], y);
                let num = at.num - i128::from(viewer[0]) * at.den;
                Fraction { num, den: at.den * i128::from(y - viewer[1]) }
            }
        }
    }
}

/// x of a wall that is not level at height `y`, exactly.
fn cut_fraction(wall: Segment, y: i64) -> Fraction {
    let den = i128::from(wall.b[1] - wall.a[1]);
    let along = i128::from(y - wall.a[1]);
    Fraction { num: i128::from(wall.a[0]) * den + i128::from(wall.b[0] - wall.a[0]) * along, den }
}

fn floor_ceil(x: i64, s: i64) -> [i64; 2] {
    let floor = x.div_euclid(s);
    [floor, floor + i64::from(x.rem_euclid(s) != 0)]
}

/// Offsets of `slots` groups for ascending or unordered keys.
fn offsets(slots: usize, keys: impl Iterator<Item = u32>) -> Vec<u32> {
    let mut start = vec![0u32; slots + 1];
    for key in keys {
        start[key as usize + 1] += 1;
    }
    for i in 0..slots {
        start[i + 1] += start[i];
    }
    start
}

/// Groups values by key, keeping their order.
fn filed(slots: usize, keyed: Vec<(u32, u32)>) -> (Vec<u32>, Vec<u32>) {
    let start = offsets(slots, keyed.iter().map(|k| k.0));
    let mut next = start.clone();
    let mut values = vec![0; keyed.len()];
    for (key, value) in keyed {
        values[next[key as usize] as usize] = value;
        next[key as usize] += 1;
    }
    (start, values)
}

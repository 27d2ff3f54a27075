//! One layout of a small plan against what never moves: dense bit rows, made for the optimiser's loop.
//!
//! Cells stand in lines along the longer side of the lattice, those that are no vertices left out; a row
//! of bits says which of them a viewer sees. The rows under the fixed walls are prepared once; a layout clears the
//! shadows of the moving segments from the upper half plane of every viewer, mirrors the result, and
//! walks the breadth-first trees with tables of four rows each.

use crate::plan::geometry::{PointUm, Segment, segments_touch};

use super::bit_rows::{count_bits, fill_tables, lost_bits, mirror, pull, push, set, shared_bits};
use super::graph::Graph;
#[cfg(target_arch = "x86_64")]
use super::lanes::x86::{Avx2, Avx512};
use super::lanes::{LANES, Lanes, Path, Portable, Vector};
use super::strips::{MAX_COORDINATE_CELLS, MAX_COORDINATE_UM};
use super::{Lattice, Obstacles, Tally};

/// Largest box: a row of bits is at most eight cache lines and the tables stay near the processor.
pub(super) const MAX_CELLS: usize = 8 * LANES;

/// A shadow's edge nearer to a cell than this, in cells, is decided in whole numbers. Rounding stays
/// below 2⁻²⁵ under the coordinate limits of the sweep.
const GRAZING_CELLS: f64 = 1e-6;

/// Reading this many tables costs as much as one cell's pull.
const TABLES_PER_PULL: u32 = 3;

/// A slope beyond any cell.
const STEEP: f64 = 1e12;

/// See the module page.
pub(super) struct Dense {
    path: Path,
    /// Which coordinate runs along a line, and which across.
    axes: [usize; 2],
    low_um: PointUm,
    spacing_um: i64,
    /// Cells along a line, and lines.
    size: [usize; 2],
    /// Cache lines of a row of bits, and words of it in use.
    stride: usize,
    words: usize,
    /// Place of every vertex in a row of bits, and back: by line, then along it.
    cell_of: Vec<u32>,
    vertex_of: Vec<u32>,
    /// Where the vertices of each line stand in a row of bits: first run of each line, one more entry.
    runs: Vec<Run>,
    first_run: Vec<u32>,
    viewers: Vec<Viewer>,
    /// Upper half plane of every viewer under the fixed walls, see `view_words`.
    fixed: Vec<u64>,
    reference: Vec<Lanes>,
    query: Vec<u32>,
    /// Component of every query vertex in the initial layout.
    initial: Vec<Vec<Lanes>>,
    initial_of: Vec<u32>,
}

/// A vertex and the box of its upper half plane under the fixed walls, in cells.
#[derive(Clone, Copy)]
struct Viewer {
    at: [usize; 2],
    lo: f64,
    hi: f64,
    top: usize,
}

/// Vertices next to each other within one word of a line.
#[derive(Clone, Copy)]
struct Run {
    /// Word of the line and first bit in it.
    word: u32,
    bit: u32,
    /// Ones from bit 0 on, one a vertex.
    mask: u64,
    /// Place of the first in a row of bits.
    at: u32,
}

/// Buffers of one thread.
#[derive(Default)]
pub(super) struct DenseScratch {
    view: Vec<u64>,
    rows: Vec<Lanes>,
    tables: Vec<Lanes>,
    /// Frontier, unseen cells and next frontier of every query vertex.
    trees: Vec<Lanes>,
    active: Vec<u32>,
    pushed: Vec<u32>,
    /// Cells per level and query vertex.
    found: Vec<u32>,
    component_of: Vec<u32>,
    components: Vec<Lanes>,
    /// Cells that no solid covers.
    bare: Vec<Lanes>,
}

/// A moving segment in the local frame, lower end first, with its box.
struct Moving {
    a: [f64; 2],
    b: [f64; 2],
    left: f64,
    right: f64,
    exact: Segment,
}

/// Lines of the half plane that are computed at a time.
const STRIDE: usize = 8;

/// The shadow of a segment in a viewer's upper half plane: between the slope of its lower end (or an
/// infinite one) and that of its upper end, beyond the segment.
struct Shadow {
    near: f64,
    far: f64,
    /// Run of the segment over its rise.
    lean: f64,
    /// Lower end as seen from the viewer, and height of the upper one, micrometres.
    a: [f64; 2],
    top: f64,
    column: f64,
    spacing: f64,
}

impl Shadow {
    /// Where the shadow begins and ends on some lines from `first` on, in columns (empty: `lo > hi`),
    /// and whether any edge comes too near to a cell.
    #[inline(always)]
    fn lines(&self, first: usize) -> ([f64; STRIDE], [f64; STRIDE], bool) {
        let (mut lo, mut hi) = ([0.0; STRIDE], [0.0; STRIDE]);
        let mut grazing = false;
        for i in 0..STRIDE {
            let d = (first + i) as f64;
            let height = d * self.spacing;
            let one = self.near * d;
            let cut = (self.a[0] + self.lean * (height - self.a[1])) / self.spacing;
            let two = if self.top <= height { self.far * d } else { cut };
            let reached = self.a[1] <= height;
            lo[i] = if reached { one.min(two) + self.column } else { 1e9 };
            hi[i] = if reached { one.max(two) + self.column } else { -1e9 };
            let near_lo = ((lo[i] - nearest(lo[i])).abs() <= GRAZING_CELLS) & (lo[i].abs() < 1e8);
            let near_hi = ((hi[i] - nearest(hi[i])).abs() <= GRAZING_CELLS) & (hi[i].abs() < 1e8);
            grazing |= reached & (near_lo | near_hi);
        }
        (lo, hi, grazing)
    }
}

/// Added to a number below 2⁵¹, leaves its nearest whole number in the low bits.
const WHOLE_BITS: f64 = 6_755_399_441_055_744.0;

#[inline(always)]
fn nearest(x: f64) -> f64 {
    (x + WHOLE_BITS) - WHOLE_BITS
}

/// The first whole number above `x`, which is not whole, clamped to `0..=64`.
#[inline(always)]
fn whole_above(x: f64) -> u64 {
    (x.clamp(-0.4, 63.5) + 0.5 + WHOLE_BITS).to_bits() & 127
}

/// All bits from `first` on; none for 64.
#[inline(always)]
fn ones_from(first: u64) -> u64 {
    if first < 64 { u64::MAX << first } else { 0 }
}

impl Dense {
    /// `None` if the lattice's box holds more than [`MAX_CELLS`] cells.
    pub fn new(lattice: &Lattice, graph: &Graph) -> Option<Self> {
        let columns = graph.tiles.size_cells;
        if lattice.cells.is_empty() || columns[0].checked_mul(columns[1])? > MAX_CELLS {
            return None;
        }
        let axes = if columns[0] >= columns[1] { [0, 1] } else { [1, 0] };
        let size = axes.map(|k| columns[k]);
        let stride = graph.len().div_ceil(LANES);
        let at = |v: usize| {
            let local = graph.tiles.local(lattice.cells[v]);
            axes.map(|k| local[k])
        };
        let mut order: Vec<u32> = (0..graph.len() as u32).collect();
        order.sort_unstable_by_key(|&v| (at(v as usize)[1], at(v as usize)[0]));
        let mut cell_of = vec![0; graph.len()];
        order.iter().enumerate().for_each(|(cell, &v)| cell_of[v as usize] = cell as u32);
        let low = [0, 1].map(|k| lattice.origin_um[k] + graph.tiles.min_cell[k] * lattice.spacing_um);
        let mut new = Self {
            path: Path::best(),
            axes,
            low_um: axes.map(|k| low[k]),
            spacing_um: lattice.spacing_um,
            size,
            stride,
            words: graph.len().div_ceil(64),
            runs: Vec::new(),
            first_run: Vec::with_capacity(size[1] + 1),
            viewers: Vec::with_capacity(graph.len()),
            fixed: Vec::new(),
            reference: vec![Lanes::default(); stride],
            query: lattice.query.clone(),
            initial: Vec::new(),
            initial_of: Vec::new(),
            vertex_of: vec![0; stride * LANES],
            cell_of,
        };
        new.find_runs(order.iter().map(|&v| at(v as usize)));
        new.fixed = vec![0; graph.len() * new.view_words()];
        for v in 0..graph.len() {
            new.vertex_of[new.cell_of[v] as usize] = v as u32;
            new.add_viewer(v, at, graph);
            if lattice.is_reference[v] {
                set(&mut new.reference, new.cell_of[v] as usize);
            }
        }
        Some(new)
    }

    /// Takes the vertices by line, then along it.
    fn find_runs(&mut self, vertices: impl Iterator<Item = [usize; 2]>) {
        let mut last = None;
        for (cell, [along, line]) in (0u32..).zip(vertices) {
            while self.first_run.len() <= line {
                self.first_run.push(self.runs.len() as u32);
            }
            match self.runs.last_mut() {
                Some(run) if along % 64 != 0 && last == Some([along - 1, line]) => {
                    run.mask = run.mask << 1 | 1
                }
                _ => {
                    let (word, bit) = ((along / 64) as u32, (along % 64) as u32);
                    self.runs.push(Run { word, bit, mask: 1, at: cell });
                }
            }
            last = Some([along, line]);
        }
        self.first_run.resize(self.size[1] + 1, self.runs.len() as u32);
    }

    fn add_viewer(&mut self, v: usize, place: impl Fn(usize) -> [usize; 2], graph: &Graph) {
        let (own, at) = (self.cell_of[v], place(v));
        let mut viewer = Viewer { at, lo: at[0] as f64, hi: at[0] as f64, top: at[1] };
        let (words, line_stride) = (self.view_words(), self.line_stride());
        let view = &mut self.fixed[v * words..][..words];
        graph.for_each_neighbour(v as u32, |u| {
            if self.cell_of[u as usize] > own {
                let [along, line] = place(u as usize);
                view[along / 64 * line_stride + line] |= 1 << (along % 64);
                viewer.lo = viewer.lo.min(along as f64);
                viewer.hi = viewer.hi.max(along as f64);
                viewer.top = viewer.top.max(line);
            }
        });
        self.viewers.push(viewer);
    }

    /// Takes a layout as the one against which cut-off vertices are counted; `false` if it is beyond the
    /// arithmetic.
    pub fn set_initial(&mut self, moving: &Obstacles, scratch: &mut DenseScratch) -> bool {
        let Some(segments) = self.take(&moving.segments) else { return false };
        self.look(&segments, &moving.blind, scratch);
        self.find_components(scratch);
        self.initial = scratch.components.chunks(self.stride).map(<[Lanes]>::to_vec).collect();
        self.initial_of = self.query.iter().map(|&v| scratch.component_of[v as usize]).collect();
        true
    }

    /// The tally of a layout; `None` if a coordinate is beyond the arithmetic.
    pub fn evaluate(&self, moving: &Obstacles, scratch: &mut DenseScratch) -> Option<Tally> {
        let segments = self.take(&moving.segments)?;
        self.look(&segments, &moving.blind, scratch);
        self.find_components(scratch);
        Some(match self.path {
            // SAFETY: a path is only made for a processor that has its instructions.
            #[cfg(target_arch = "x86_64")]
            #[allow(unsafe_code)]
            Path::Avx512 => unsafe { self.walk_avx512(scratch) },
            #[cfg(target_arch = "x86_64")]
            #[allow(unsafe_code)]
            Path::Avx2 => unsafe { self.walk_avx2(scratch) },
            Path::Portable => self.walk_in::<Portable>(scratch),
        })
    }

    /// Segments that meet the box of the vertices, in the local frame.
    fn take(&self, segments: &[Segment]) -> Option<Vec<Moving>> {
        let far = [0, 1].map(|k| (self.size[k] - 1) as i64 * self.spacing_um);
        let mut taken = Vec::with_capacity(segments.len());
        for s in segments {
            let swapped = [s.a, s.b].map(|p| self.axes.map(|k| p[k]));
            let low = self.low_um;
            let outside = |k: usize| {
                swapped.iter().all(|p| p[k] < low[k]) || swapped.iter().all(|p| p[k] > low[k] + far[k])
            };
            if outside(0) || outside(1) {
                continue;
            }
            let [mut a, mut b] = swapped.map(|p| [p[0].checked_sub(low[0]), p[1].checked_sub(low[1])]);
            if (b[1], b[0]) < (a[1], a[0]) {
                std::mem::swap(&mut a, &mut b);
            }
            let exact = Segment { a: [a[0]?, a[1]?], b: [b[0]?, b[1]?] };
            let reach = [exact.a, exact.b].iter().flatten().map(|v| v.abs()).max()?;
            if reach > MAX_COORDINATE_UM || reach / self.spacing_um >= MAX_COORDINATE_CELLS {
                return None;
            }
            let [a, b] = [exact.a, exact.b].map(|p| p.map(|v| v as f64));
            taken.push(Moving { a, b, left: a[0].min(b[0]), right: a[0].max(b[0]), exact });
        }
        Some(taken)
    }

    /// Fills `rows` by cell: who sees whom in this layout.
    fn look(&self, segments: &[Moving], blind: &[u32], scratch: &mut DenseScratch) {
        scratch.rows.clear();
        scratch.rows.resize(self.stride * LANES * self.stride, Lanes::default());
        match self.path {
            // SAFETY: a path is only made for a processor that has its instructions.
            #[cfg(target_arch = "x86_64")]
            #[allow(unsafe_code)]
            Path::Avx512 => unsafe { self.cast_all_avx512(segments, scratch) },
            #[cfg(target_arch = "x86_64")]
            #[allow(unsafe_code)]
            Path::Avx2 => unsafe { self.cast_all_avx2(segments, scratch) },
            Path::Portable => self.cast_all(segments, scratch),
        }
        scratch.bare.clear();
        scratch.bare.resize(self.stride, Lanes([u64::MAX; 8]));
        if !blind.is_empty() {
            self.blindfold(blind, &mut scratch.rows, &mut scratch.bare);
        }
        mirror(&mut scratch.rows, self.stride, self.words);
    }

    fn blindfold(&self, blind: &[u32], rows: &mut [Lanes], bare: &mut [Lanes]) {
        for &v in blind {
            let cell = self.cell_of[v as usize] as usize;
            rows[cell * self.stride..][..self.stride].fill(Lanes::default());
            bare[cell / LANES].clear(cell % LANES);
        }
        for row in rows.chunks_exact_mut(self.stride) {
            row.iter_mut().zip(&*bare).for_each(|(r, s)| (0..8).for_each(|w| r.0[w] &= s.0[w]));
        }
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx512f,avx512dq,popcnt")]
    fn cast_all_avx512(&self, segments: &[Moving], scratch: &mut DenseScratch) {
        self.cast_all(segments, scratch);
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,popcnt")]
    fn cast_all_avx2(&self, segments: &[Moving], scratch: &mut DenseScratch) {
        self.cast_all(segments, scratch);
    }

    /// The upper half plane of every viewer, as bits by cell.
    #[inline(always)]
    fn cast_all(&self, segments: &[Moving], scratch: &mut DenseScratch) {
        let s = self.spacing_um as f64;
        let view = &mut scratch.view;
        for (v, viewer) in self.viewers.iter().enumerate() {
            view.clear();
            view.extend_from_slice(&self.fixed[v * self.view_words()..][..self.view_words()]);
            let (low, top) = (viewer.at[1] as f64 * s, viewer.top as f64 * s);
            let (left, right) = (viewer.lo * s, viewer.hi * s);
            for m in segments {
                let apart = (m.b[1] < low) | (m.a[1] > top) | (m.right < left) | (m.left > right);
                if !apart {
                    self.cast(viewer, m, view);
                }
            }
            let row = &mut scratch.rows[self.cell_of[v] as usize * self.stride..][..self.stride];
            self.pack(viewer, view, row);
        }
    }

    /// Words of a half plane: by word of a line, then line, with room for a last stride of lines.
    fn view_words(&self) -> usize {
        self.size[0].div_ceil(64) * self.line_stride()
    }

    fn line_stride(&self) -> usize {
        self.size[1] + STRIDE
    }

    /// Puts the lines of a view one behind the other.
    #[inline(always)]
    fn pack(&self, viewer: &Viewer, view: &[u64], row: &mut [Lanes]) {
        let lines = viewer.at[1]..=viewer.top;
        let ends = self.first_run[viewer.at[1]..viewer.top + 2].windows(2);
        for (line, ends) in lines.zip(ends) {
            for run in &self.runs[ends[0] as usize..ends[1] as usize] {
                let bits = view[run.word as usize * self.line_stride() + line] >> run.bit & run.mask;
                if bits == 0 {
                    continue;
                }
                let at = run.at as usize;
                row[at / LANES].0[at / 64 % 8] |= bits << (at % 64);
                let over = bits.checked_shr(64 - (at % 64) as u32).unwrap_or(0);
                if over != 0 {
                    row[(at / 64 + 1) / 8].0[(at / 64 + 1) % 8] |= over;
                }
            }
        }
    }

    /// Clears the shadow of one segment from a viewer's upper half plane, [`STRIDE`] lines at a time.
    #[inline(always)]
    fn cast(&self, viewer: &Viewer, m: &Moving, view: &mut [u64]) {
        let s = self.spacing_um as f64;
        let at = [viewer.at[0] as f64 * s, viewer.at[1] as f64 * s];
        let a = [m.a[0] - at[0], m.a[1] - at[1]];
        let b = [m.b[0] - at[0], m.b[1] - at[1]];
        // Towards the viewer's own line: a slope, or one of the two ends of the line.
        let near = if a[1] > 0.0 {
            a[0] / a[1]
        } else {
            let Some(side) = self.clear_own_line(viewer, m, view) else { return };
            side
        };
        if b[1] <= 0.0 {
            return;
        }
        let shadow = Shadow {
            near,
            far: b[0] / b[1],
            lean: if b[1] > a[1] { (b[0] - a[0]) / (b[1] - a[1]) } else { 0.0 },
            a,
            top: b[1],
            column: viewer.at[0] as f64,
            spacing: s,
        };
        let mut first = ((a[1] / s).max(0.0) as usize).max(1);
        let last = viewer.top - viewer.at[1];
        while first <= last {
            let (lo, hi, grazing) = shadow.lines(first);
            if grazing {
                self.cast_exactly(viewer, m, view, first..=last.min(first + STRIDE - 1), (&lo, &hi));
            } else {
                self.clear_lines(view, viewer.at[1] + first, &lo, &hi);
            }
            first += STRIDE;
        }
    }

    /// Clears the cells between two positions on each of some lines.
    #[inline(always)]
    fn clear_lines(&self, view: &mut [u64], line: usize, lo: &[f64; STRIDE], hi: &[f64; STRIDE]) {
        for w in 0..self.size[0].div_ceil(64) {
            let base = (w * 64) as f64;
            let words = &mut view[w * self.line_stride() + line..][..STRIDE];
            for i in 0..STRIDE {
                let (from, beyond) = (whole_above(lo[i] - base), whole_above(hi[i] - base));
                words[i] &= !(ones_from(from) & !ones_from(beyond));
            }
        }
    }

    /// The same where an edge grazes a cell: the cells at the edges are tested in whole numbers.
    #[cold]
    fn cast_exactly(
        &self,
        viewer: &Viewer,
        m: &Moving,
        view: &mut [u64],
        distances: std::ops::RangeInclusive<usize>,
        (lo, hi): (&[f64; STRIDE], &[f64; STRIDE]),
    ) {
        for (i, distance) in distances.enumerate() {
            let line = viewer.at[1] + distance;
            if lo[i] > hi[i] || hi[i] < -0.5 || lo[i] > self.size[0] as f64 - 0.5 {
                continue;
            }
            let from = self.edge(viewer, m, line, lo[i], true);
            let to = self.edge(viewer, m, line, hi[i], false);
            self.clear_cells(view, line, from, to);
        }
    }

    fn clear_cells(&self, view: &mut [u64], line: usize, from: i64, to: i64) {
        for cell in from..=to {
            view[cell as usize / 64 * self.line_stride() + line] &= !(1 << (cell % 64));
        }
    }

    /// First (`lower`) or last cell of a line in the shadow whose edge lies at `position`.
    fn edge(&self, viewer: &Viewer, m: &Moving, line: usize, position: f64, lower: bool) -> i64 {
        let last = (self.size[0] - 1) as i64;
        if position < -0.5 {
            return 0;
        }
        if position > last as f64 + 0.5 {
            return last;
        }
        let near = (position + 0.5) as i64;
        let offset = position - near as f64;
        let inside = if offset.abs() > GRAZING_CELLS {
            (offset < 0.0) == lower
        } else {
            self.blocks(m, viewer.at, [near as usize, line])
        };
        match (lower, inside) {
            (_, true) => near,
            (true, false) => near + 1,
            (false, false) => near - 1,
        }
    }

    fn blocks(&self, m: &Moving, from: [usize; 2], to: [usize; 2]) -> bool {
        let centre = |c: [usize; 2]| c.map(|v| v as i64 * self.spacing_um);
        segments_touch(Segment { a: centre(from), b: centre(to) }, m.exact)
    }

    /// A segment that reaches down to the viewer's own line or below: clears what it hides on the line.
    /// The side on which it meets the line as an infinite slope; `None` if it hides the whole half plane.
    #[inline(never)]
    fn clear_own_line(&self, viewer: &Viewer, m: &Moving, view: &mut [u64]) -> Option<f64> {
        let centre = viewer.at.map(|v| v as i64 * self.spacing_um);
        if segments_touch(m.exact, Segment { a: centre, b: centre }) {
            view.fill(0);
            return None;
        }
        let (a, b) = (m.exact.a, m.exact.b);
        // Right of the line through the segment, read upwards, it passes on the left.
        let turn = crate::plan::geometry::cross_um(a, b, centre);
        let right = if a[1] == b[1] { a[0] > centre[0] } else { turn > 0 };
        if !right {
            return Some(-STEEP);
        }
        // The first cell whose sight segment along the line touches.
        let line = viewer.at[1];
        let mut first = viewer.at[0] + 1;
        let reach = if a[1] == b[1] {
            a[0] as f64
        } else {
            m.a[0] + (m.b[0] - m.a[0]) * ((centre[1] as f64 - m.a[1]) / (m.b[1] - m.a[1]))
        };
        let guess = (reach / self.spacing_um as f64 - 1.0).clamp(0.0, self.size[0] as f64) as usize;
        first = first.max(guess);
        while first < self.size[0] && !self.blocks(m, viewer.at, [first, line]) {
            first += 1;
        }
        self.clear_cells(view, line, first as i64, self.size[0] as i64 - 1);
        Some(STEEP)
    }

    /// Labels the components of the layout in `rows`.
    fn find_components(&self, scratch: &mut DenseScratch) {
        let k = self.stride;
        scratch.component_of.clear();
        scratch.component_of.resize(self.viewers.len(), u32::MAX);
        scratch.components.clear();
        let mut todo = vec![0u64; k * 8];
        for v in 0..self.viewers.len() {
            if scratch.component_of[v] != u32::MAX {
                continue;
            }
            let label = (scratch.components.len() / k) as u32;
            let mut member = vec![Lanes::default(); k];
            set(&mut member, self.cell_of[v] as usize);
            todo.iter_mut().zip(member.iter().flat_map(|m| m.0)).for_each(|(t, m)| *t = m);
            while let Some(w) = todo.iter().position(|t| *t != 0) {
                let cell = w * 64 + todo[w].trailing_zeros() as usize;
                todo[w] &= todo[w] - 1;
                scratch.component_of[self.vertex_of[cell] as usize] = label;
                let row = &scratch.rows[cell * k..][..k];
                for (i, (m, r)) in member.iter_mut().zip(row).enumerate() {
                    for j in 0..8 {
                        todo[i * 8 + j] |= r.0[j] & !m.0[j];
                        m.0[j] |= r.0[j];
                    }
                }
            }
            scratch.components.extend_from_slice(&member);
        }
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx512f,popcnt,bmi1")]
    fn walk_avx512(&self, scratch: &mut DenseScratch) -> Tally {
        self.walk_in::<Avx512>(scratch)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,popcnt")]
    fn walk_avx2(&self, scratch: &mut DenseScratch) -> Tally {
        self.walk_in::<Avx2>(scratch)
    }

    #[inline(always)]
    fn walk_in<V: Vector>(&self, scratch: &mut DenseScratch) -> Tally {
        match self.stride {
            1 => self.walk_rows::<V, 1>(scratch),
            2 => self.walk_rows::<V, 2>(scratch),
            3 => self.walk_rows::<V, 3>(scratch),
            4 => self.walk_rows::<V, 4>(scratch),
            5 => self.walk_rows::<V, 5>(scratch),
            6 => self.walk_rows::<V, 6>(scratch),
            7 => self.walk_rows::<V, 7>(scratch),
            _ => self.walk_rows::<V, 8>(scratch),
        }
    }

    /// The breadth-first trees of the query vertices, all of them level by level.
    #[inline(always)]
    fn walk_rows<V: Vector, const K: usize>(&self, scratch: &mut DenseScratch) -> Tally {
        let mut tally = Tally::default();
        let rows: &[[Lanes; K]] = scratch.rows.as_chunks().0;
        let components: &[[Lanes; K]] = scratch.components.as_chunks().0;
        let words = self.words;
        fill_tables::<V, K>(&rows[..words * 64], &mut scratch.tables);
        let tables: &[[Lanes; K]] = scratch.tables.as_chunks().0;
        let trees = &mut scratch.trees;
        trees.resize(self.query.len() * 3 * K, Lanes::default());
        let trees: &mut [[[Lanes; K]; 3]] = trees.as_chunks_mut().0.as_chunks_mut().0;
        let found = &mut scratch.found;
        found.clear();
        let (active, pushed) = (&mut scratch.active, &mut scratch.pushed);
        active.clear();
        for (i, (&v, [frontier, unseen, _])) in self.query.iter().zip(trees.iter_mut()).enumerate() {
            let cell = self.cell_of[v as usize] as usize;
            *frontier = rows[cell];
            *unseen = components[scratch.component_of[v as usize] as usize];
            tally.degree.push(shared_bits(frontier, &self.reference));
            tally.degree_all.push(count_bits(frontier));
            if let Some(initial) = self.initial_of.get(i)
                && scratch.bare[cell / LANES].get(cell % LANES) == 1
            {
                let was = &self.initial[*initial as usize];
                tally.disconnected += u64::from(lost_bits(was, unseen, &scratch.bare));
            }
            unseen[cell / LANES].clear(cell % LANES);
            active.push(i as u32);
        }
        let few = (words * 16) as u32 / TABLES_PER_PULL;
        let mut level = 0;
        while !active.is_empty() {
            found.resize((level + 1) * self.query.len(), 0);
            let counts = &mut found[level * self.query.len()..];
            pushed.clear();
            let mut kept = 0;
            for at in 0..active.len() {
                let [frontier, unseen, _] = &mut trees[active[at] as usize];
                counts[active[at] as usize] = count_bits(frontier);
                for k in 0..K {
                    V::load(&unseen[k]).without(V::load(&frontier[k])).store(&mut unseen[k]);
                }
                let missing = count_bits(unseen);
                if missing > few {
                    pushed.push(active[at]);
                } else if missing > 0 {
                    *frontier = pull::<V, K>(rows, frontier, unseen);
                }
                active[kept] = active[at];
                kept += usize::from(missing > 0);
            }
            active.truncate(kept);
            push::<V, K>(tables, trees, pushed);
            level += 1;
        }
        for i in 0..self.query.len() {
            let before = tally.levels.len();
            let counts = (0..level).map(|l| found[l * self.query.len() + i]);
            tally.levels.extend(counts.take_while(|n| *n > 0));
            tally.depth.push((tally.levels.len() - before) as u32);
        }
        tally
    }
}

#[cfg(test)]
mod limits {
    use super::*;
    use crate::analysis::Obstacles;
    use crate::analysis::visibility::visibility_graph;

    fn two_cells(columns_apart: i32) -> Lattice {
        Lattice {
            spacing_um: 1,
            origin_um: [0, 0],
            cells: vec![[0, 0], [columns_apart, 0]],
            query: vec![0, 1],
            is_reference: vec![true; 2],
        }
    }

    #[test]
    fn a_large_box_is_left_to_the_general_way() {
        let dense = |n: usize| {
            let lattice = two_cells(n as i32);
            let graph = visibility_graph(&lattice, &Obstacles::default());
            Dense::new(&lattice, &graph).is_some()
        };
        assert!(dense(100) && !dense(MAX_CELLS));
    }

    #[test]
    fn cells_farther_apart_than_the_sweep_can_count_see_each_other_all_the_same() {
        let lattice = two_cells(MAX_COORDINATE_CELLS as i32 + 2);
        let wall = Segment { a: [77, -1], b: [77, 1] };
        for (segments, edges) in [(vec![], 1), (vec![wall], 0)] {
            let obstacles = Obstacles { segments, blind: vec![] };
            assert_eq!(visibility_graph(&lattice, &obstacles).edge_count(), edges);
        }
    }
}

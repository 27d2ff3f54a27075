//! One layout of a small plan against what never moves: dense bit rows, made for the optimiser's loop.
//!
//! Cells stand in a grid of lines along the longer side of the lattice; a row of bits says which cells
//! of the grid a viewer sees. The rows under the fixed walls are prepared once; a layout clears the
//! shadows of the moving segments from the upper half plane of every viewer, mirrors the result, and
//! walks the breadth-first trees with tables of four rows each.

use crate::plan::geometry::{PointUm, Segment, segments_touch};

use super::graph::Graph;
#[cfg(target_arch = "x86_64")]
use super::lanes::x86::{Avx2, Avx512};
use super::lanes::{LANES, Lanes, Path, Portable, Vector, transpose};
use super::strips::{MAX_COORDINATE_CELLS, MAX_COORDINATE_UM};
use super::{Lattice, Obstacles, Tally};

/// Largest grid: a row of bits is at most four cache lines and the tables stay near the processor.
pub(super) const MAX_CELLS: usize = 4 * LANES;

/// A shadow's edge nearer to a cell than this, in cells, is decided in whole numbers. Rounding stays
/// below 2⁻²⁵ under the coordinate limits of the sweep.
const GRAZING_CELLS: f64 = 1e-6;

/// A level is pulled by the unseen cells once they are fewer than the cells in so many table rows.
const PULL_BELOW: u32 = 5;

/// See the module page.
pub(super) struct Dense {
    path: Path,
    /// Which coordinate runs along a line, and which across.
    axes: [usize; 2],
    low_um: PointUm,
    spacing_um: i64,
    /// Cells along a line, and lines.
    size: [usize; 2],
    /// Cache lines of a row of bits.
    stride: usize,
    /// Grid cell of every vertex, and back.
    cell_of: Vec<u32>,
    vertex_of: Vec<u32>,
    viewers: Vec<Viewer>,
    /// Upper half plane of every viewer under the fixed walls.
    fixed: Vec<Lanes>,
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

/// Buffers of one thread.
#[derive(Default)]
pub(super) struct DenseScratch {
    rows: Vec<Lanes>,
    tables: Vec<Lanes>,
    component_of: Vec<u32>,
    components: Vec<Lanes>,
}

/// A moving segment in the local frame, lower end first, with its box.
struct Moving {
    a: [f64; 2],
    b: [f64; 2],
    exact: Segment,
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
        let stride = (size[0] * size[1]).div_ceil(LANES);
        let local = |v: usize| graph.tiles.local(lattice.cells[v]);
        let at = |v: usize| axes.map(|k| local(v)[k]);
        let cell_of: Vec<u32> =
            (0..graph.len()).map(|v| (at(v)[1] * size[0] + at(v)[0]) as u32).collect();
        let low = [0, 1].map(|k| lattice.origin_um[k] + graph.tiles.min_cell[k] * lattice.spacing_um);
        let mut new = Self {
            path: Path::best(),
            axes,
            low_um: axes.map(|k| low[k]),
            spacing_um: lattice.spacing_um,
            size,
            stride,
            viewers: Vec::with_capacity(graph.len()),
            fixed: vec![Lanes::default(); graph.len() * stride],
            reference: vec![Lanes::default(); stride],
            query: lattice.query.clone(),
            initial: Vec::new(),
            initial_of: Vec::new(),
            vertex_of: vec![0; stride * LANES],
            cell_of,
        };
        for v in 0..graph.len() {
            new.vertex_of[new.cell_of[v] as usize] = v as u32;
            new.add_viewer(v, at(v), graph);
            if lattice.is_reference[v] {
                set(&mut new.reference, new.cell_of[v] as usize);
            }
        }
        Some(new)
    }

    fn add_viewer(&mut self, v: usize, at: [usize; 2], graph: &Graph) {
        let own = self.cell_of[v];
        let mut viewer = Viewer { at, lo: at[0] as f64, hi: at[0] as f64, top: at[1] };
        let row = &mut self.fixed[v * self.stride..][..self.stride];
        graph.for_each_neighbour(v as u32, |u| {
            let cell = self.cell_of[u as usize];
            if cell > own {
                set(row, cell as usize);
                let along = (cell as usize % self.size[0]) as f64;
                viewer.lo = viewer.lo.min(along);
                viewer.hi = viewer.hi.max(along);
                viewer.top = viewer.top.max(cell as usize / self.size[0]);
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
            taken.push(Moving { a: exact.a.map(|v| v as f64), b: exact.b.map(|v| v as f64), exact });
        }
        Some(taken)
    }

    /// Fills `rows` by grid cell: who sees whom in this layout.
    fn look(&self, segments: &[Moving], blind: &[u32], scratch: &mut DenseScratch) {
        let cells = self.stride * LANES;
        scratch.rows.clear();
        scratch.rows.resize(cells * self.stride, Lanes::default());
        let s = self.spacing_um as f64;
        for (v, viewer) in self.viewers.iter().enumerate() {
            let cell = self.cell_of[v] as usize;
            let row = &mut scratch.rows[cell * self.stride..][..self.stride];
            row.copy_from_slice(&self.fixed[v * self.stride..][..self.stride]);
            let (low, top) = (viewer.at[1] as f64 * s, viewer.top as f64 * s);
            let (left, right) = (viewer.lo * s, viewer.hi * s);
            for m in segments {
                let apart = m.b[1] < low
                    || m.a[1] > top
                    || m.a[0].max(m.b[0]) < left
                    || m.a[0].min(m.b[0]) > right;
                if !apart {
                    self.cast(viewer, m, row);
                }
            }
        }
        if !blind.is_empty() {
            let mut seeing = vec![Lanes([u64::MAX; 8]); self.stride];
            for &v in blind {
                let cell = self.cell_of[v as usize] as usize;
                scratch.rows[cell * self.stride..][..self.stride].fill(Lanes::default());
                seeing[cell / LANES].clear(cell % LANES);
            }
            for row in scratch.rows.chunks_exact_mut(self.stride) {
                row.iter_mut().zip(&seeing).for_each(|(r, s)| (0..8).for_each(|w| r.0[w] &= s.0[w]));
            }
        }
        mirror(&mut scratch.rows, self.stride, (self.size[0] * self.size[1]).div_ceil(64));
    }

    /// Clears the shadow of one segment from a viewer's upper half plane.
    fn cast(&self, viewer: &Viewer, m: &Moving, row: &mut [Lanes]) {
        let s = self.spacing_um as f64;
        let at = [viewer.at[0] as f64 * s, viewer.at[1] as f64 * s];
        let a = [m.a[0] - at[0], m.a[1] - at[1]];
        let b = [m.b[0] - at[0], m.b[1] - at[1]];
        // Towards the viewer's own line: nothing, a slope, or one of the two ends of the line.
        let near = if a[1] > 0.0 {
            a[0] / a[1]
        } else {
            let Some(side) = self.clear_own_line(viewer, m, row) else { return };
            side
        };
        let far = if b[1] > 0.0 { b[0] / b[1] } else { return };
        let lean = if b[1] > a[1] { (b[0] - a[0]) / (b[1] - a[1]) } else { 0.0 };
        let first = ((a[1] / s).max(0.0) as usize).max(1);
        for distance in first..=viewer.top - viewer.at[1] {
            let (d, height) = (distance as f64, distance as f64 * s);
            if a[1] > height {
                continue;
            }
            let one = near * d;
            let two = if b[1] <= height { far * d } else { (a[0] + lean * (height - a[1])) / s };
            let column = viewer.at[0] as f64;
            let (lo, hi) = (one.min(two) + column, one.max(two) + column);
            if hi < -0.5 || lo > self.size[0] as f64 - 0.5 {
                continue;
            }
            let line = viewer.at[1] + distance;
            let from = self.edge(viewer, m, line, lo, true);
            let to = self.edge(viewer, m, line, hi, false);
            if from <= to {
                clear_range(row, line * self.size[0] + from as usize, line * self.size[0] + to as usize);
            }
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
            (true, true) | (false, true) => near,
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
    fn clear_own_line(&self, viewer: &Viewer, m: &Moving, row: &mut [Lanes]) -> Option<f64> {
        let centre = viewer.at.map(|v| v as i64 * self.spacing_um);
        if segments_touch(m.exact, Segment { a: centre, b: centre }) {
            row.fill(Lanes::default());
            return None;
        }
        let (a, b) = (m.exact.a, m.exact.b);
        // Right of the line through the segment, read upwards, it passes on the left.
        let turn = crate::plan::geometry::cross_um(a, b, centre);
        let right = if a[1] == b[1] { a[0] > centre[0] } else { turn > 0 };
        if !right {
            return Some(-1e300);
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
        if first < self.size[0] {
            clear_range(row, line * self.size[0] + first, (line + 1) * self.size[0] - 1);
        }
        Some(1e300)
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
            _ => self.walk_rows::<V, 4>(scratch),
        }
    }

    /// The breadth-first trees of the query vertices.
    #[inline(always)]
    fn walk_rows<V: Vector, const K: usize>(&self, scratch: &mut DenseScratch) -> Tally {
        let mut tally = Tally::default();
        let rows: &[[Lanes; K]] = scratch.rows.as_chunks().0;
        let components: &[[Lanes; K]] = scratch.components.as_chunks().0;
        fill_tables::<V, K>(rows, &mut scratch.tables);
        let tables: &[[Lanes; K]] = scratch.tables.as_chunks().0;
        for (i, &v) in self.query.iter().enumerate() {
            let cell = self.cell_of[v as usize] as usize;
            let row = rows[cell];
            let component = components[scratch.component_of[v as usize] as usize];
            tally.degree.push(shared_bits(&row, &self.reference));
            tally.degree_all.push(count_bits(&row));
            if let Some(initial) = self.initial_of.get(i) {
                let was = &self.initial[*initial as usize];
                tally.disconnected += u64::from(count_bits(was) - shared_bits(was, &component));
            }
            let before = tally.levels.len();
            let mut unseen = component;
            unseen[cell / LANES].clear(cell % LANES);
            let mut frontier = row;
            loop {
                let found = count_bits(&frontier);
                if found == 0 {
                    break;
                }
                tally.levels.push(found);
                let mut any = false;
                for k in 0..K {
                    let left = V::load(&unseen[k]).without(V::load(&frontier[k]));
                    any |= !left.is_zero();
                    left.store(&mut unseen[k]);
                }
                if !any {
                    break;
                }
                let few = count_bits(&unseen) < (rows.len() as u32 / 4) / PULL_BELOW * 2;
                frontier = if few {
                    pull::<V, K>(rows, &frontier, &unseen)
                } else {
                    push::<V, K>(tables, &frontier, &unseen)
                };
            }
            tally.depth.push((tally.levels.len() - before) as u32);
        }
        tally
    }
}

/// For every four rows the unions of all 16 choices of them.
#[inline(always)]
fn fill_tables<V: Vector, const K: usize>(rows: &[[Lanes; K]], tables: &mut Vec<Lanes>) {
    tables.resize(rows.len() * 4 * K, Lanes::default());
    let choices: &mut [[[Lanes; K]; 16]] = tables.as_chunks_mut().0.as_chunks_mut().0;
    for (four, table) in rows.as_chunks::<4>().0.iter().zip(choices) {
        for choice in 1..16usize {
            let row = &four[choice.trailing_zeros() as usize];
            for k in 0..K {
                let both = V::load(&table[choice & (choice - 1)][k]).or(V::load(&row[k]));
                both.store(&mut table[choice][k]);
            }
        }
    }
}

/// Unseen cells beside the frontier, by the rows of the frontier.
#[inline(always)]
fn push<V: Vector, const K: usize>(
    tables: &[[Lanes; K]],
    frontier: &[Lanes; K],
    unseen: &[Lanes; K],
) -> [Lanes; K] {
    let mut sum = [V::zero(); K];
    for (w, tables) in tables.chunks_exact(256).enumerate() {
        let mut word = frontier[w / 8].0[w % 8];
        if word == 0 {
            continue;
        }
        for table in tables.as_chunks::<16>().0 {
            let choice = &table[(word & 15) as usize];
            for k in 0..K {
                sum[k] = sum[k].or(V::load(&choice[k]));
            }
            word >>= 4;
        }
    }
    let mut new = [Lanes::default(); K];
    for k in 0..K {
        sum[k].and(V::load(&unseen[k])).store(&mut new[k]);
    }
    new
}

/// Unseen cells beside the frontier, by their own rows.
#[inline(always)]
fn pull<V: Vector, const K: usize>(
    rows: &[[Lanes; K]],
    frontier: &[Lanes; K],
    unseen: &[Lanes; K],
) -> [Lanes; K] {
    let mut new = [Lanes::default(); K];
    for k in 0..K {
        for w in 0..8 {
            let mut bits = unseen[k].0[w];
            while bits != 0 {
                let bit = bits.trailing_zeros();
                bits &= bits - 1;
                let row = &rows[k * LANES + w * 64 + bit as usize];
                let mut shared = V::zero();
                for i in 0..K {
                    shared = shared.or(V::load(&row[i]).and(V::load(&frontier[i])));
                }
                new[k].0[w] |= u64::from(!shared.is_zero()) << bit;
            }
        }
    }
    new
}

fn set(row: &mut [Lanes], cell: usize) {
    row[cell / LANES].set(cell % LANES);
}

#[inline(always)]
fn count_bits(row: &[Lanes]) -> u32 {
    row.iter().flat_map(|l| l.0).map(u64::count_ones).sum()
}

#[inline(always)]
fn shared_bits(a: &[Lanes], b: &[Lanes]) -> u32 {
    a.iter().zip(b).flat_map(|(a, b)| a.0.into_iter().zip(b.0)).map(|(a, b)| (a & b).count_ones()).sum()
}

/// Clears the bits `from..=to`.
fn clear_range(row: &mut [Lanes], from: usize, to: usize) {
    let mut word = from / 64;
    let mut mask = u64::MAX << (from % 64);
    while word < to / 64 {
        row[word / 8].0[word % 8] &= !mask;
        mask = u64::MAX;
        word += 1;
    }
    row[word / 8].0[word % 8] &= !(mask & (u64::MAX >> (63 - to % 64)));
}

/// Makes a matrix that holds bits only right of its diagonal symmetric; `words` of a row are in use.
fn mirror(rows: &mut [Lanes], stride: usize, words: usize) {
    let mut block = [0u64; 64];
    for r in 0..words {
        for c in r..words {
            let mut any = 0;
            for (i, word) in block.iter_mut().enumerate() {
                *word = rows[(r * 64 + i) * stride + c / 8].0[c % 8];
                any |= *word;
            }
            if any == 0 {
                continue;
            }
            transpose(&mut block);
            for (i, word) in block.iter().enumerate() {
                rows[(c * 64 + i) * stride + r / 8].0[r % 8] |= word;
            }
        }
    }
}

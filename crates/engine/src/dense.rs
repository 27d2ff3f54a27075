//! One layout of a small plan against what never moves: dense bit rows, made for the optimiser's loop.
//!
//! Cells stand in lines along the longer side of the lattice, those that are no vertices left out; a row
//! of bits says which of them a viewer sees. The rows under the fixed walls are prepared once; a layout clears the
//! shadows of the moving segments from the upper half plane of every viewer, mirrors the result, and
//! walks the breadth-first trees with tables of four rows each.

mod broad;
mod poses;
mod shadow;
mod steps;

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use crate::geometry::{PointUm, Segment, cross_um, segments_touch};

use super::bit_rows::{
    PushRoom, count_bits, fill_tables, flood, lost_bits, mirror, pull, push, set, shared_bits,
};
use super::graph::{Graph, for_each_bit};
#[cfg(target_arch = "x86_64")]
use super::lanes::x86::{Avx2, Avx512};
use super::lanes::{LANES, Lanes, Path, Portable, Vector};
use super::strips::{MAX_COORDINATE_CELLS, MAX_COORDINATE_UM};
use super::{Lattice, Obstacles, Tally};
pub(super) use broad::Broad;
use poses::{Pose, Poses};
use shadow::{BEFORE, STRIDE, Shadow, first_above, is_grazing, ones_from};

/// Largest box: a row of bits is at most eight cache lines and the tables stay near the processor.
pub(super) const MAX_CELLS: usize = 8 * LANES;

/// Reading this many tables costs as much as one cell's pull.
const TABLES_PER_PULL: u32 = 3;

/// A slope beyond any cell.
const STEEP: f64 = 1e12;

/// See the module page.
pub(super) struct Dense {
    /// Another for every value made.
    id: u64,
    pub(super) path: Path,
    /// Which coordinate runs along a line, and which across.
    axes: [usize; 2],
    low_um: PointUm,
    spacing_um: i64,
    per_spacing: f64,
    /// Cells along a line, and lines.
    size: [usize; 2],
    /// Cache lines of a row of bits, and words of it in use.
    stride: usize,
    words: usize,
    /// Place of every vertex in a row of bits, and back: by line, then along it.
    cell_of: Vec<u32>,
    vertex_of: Vec<u32>,
    /// Vertices of each word of each line, and where the first of them stands in a row of bits; in the order of
    /// a view.
    masks: Vec<u64>,
    firsts: Vec<u32>,
    viewers: Vec<Viewer>,
    /// Upper half plane of every viewer under the fixed walls, see `view_words`.
    fixed: Vec<u64>,
    reference: Vec<Lanes>,
    query: Vec<u32>,
    /// Places in it of those whose trees are walked, ascending.
    roots: Vec<u32>,
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
    view: Vec<u64>,
    poses: Poses,
    /// A row of bits in the making, a word more than it has; segments near a viewer.
    packed: Vec<u64>,
    near: Vec<u32>,
    rows: Vec<Lanes>,
    tables: Vec<Lanes>,
    /// Frontier and unseen cells of every query vertex.
    trees: Vec<Lanes>,
    room: PushRoom,
    active: Vec<u32>,
    pushed: Vec<u32>,
    /// Cells of its component that the tree of a query vertex has not reached.
    missing: Vec<u32>,
    /// Cells per level and query vertex.
    found: Vec<u32>,
    component_of: Vec<u32>,
    components: Vec<Lanes>,
    /// Cells that no solid covers.
    bare: Vec<Lanes>,
}

/// A moving segment in the local frame, lower end first, with its box.
#[derive(Clone)]
struct Moving {
    a: [f64; 2],
    b: [f64; 2],
    left: f64,
    right: f64,
    /// Run over rise; 0 if it is level.
    lean: f64,
    exact: Segment,
}

/// The lowest first: what they hide need not be looked at again.
fn lowest_first(segments: &mut [Moving]) {
    segments.sort_unstable_by_key(|m| (m.exact.a[1], m.exact));
}

impl Dense {
    /// `None` if the lattice's box holds more than [`MAX_CELLS`] cells.
    pub fn new(lattice: &Lattice, graph: &Graph) -> Option<Self> {
        let columns = graph.tiles.size_cells;
        let fits = !lattice.cells.is_empty() && columns[0].checked_mul(columns[1])? <= MAX_CELLS;
        fits.then(|| Self::prepared(lattice, graph))
    }

    /// For a lattice of any size that holds a vertex: what casts shadows, whoever gathers the views.
    fn prepared(lattice: &Lattice, graph: &Graph) -> Self {
        let columns = graph.tiles.size_cells;
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
        static MADE: AtomicU64 = AtomicU64::new(0);
        let mut new = Self {
            id: MADE.fetch_add(1, Ordering::Relaxed),
            path: Path::best(),
            axes,
            low_um: axes.map(|k| low[k]),
            spacing_um: lattice.spacing_um,
            per_spacing: 1.0 / lattice.spacing_um as f64,
            size,
            stride,
            words: graph.len().div_ceil(64),
            masks: Vec::new(),
            firsts: Vec::new(),
            viewers: Vec::with_capacity(graph.len()),
            fixed: Vec::new(),
            reference: vec![Lanes::default(); stride],
            query: lattice.query.clone(),
            roots: (0..lattice.query.len() as u32).collect(),
            initial: Vec::new(),
            initial_of: Vec::new(),
            vertex_of: vec![0; stride * LANES],
            cell_of,
        };
        new.masks = vec![0; new.view_words()];
        new.firsts = vec![0; new.view_words()];
        for (cell, &v) in (0u32..).zip(&order) {
            let [along, line] = at(v as usize);
            let word = along / 64 * new.line_stride() + line;
            if new.masks[word] == 0 {
                new.firsts[word] = cell;
            }
            new.masks[word] |= 1 << (along % 64);
        }
        new.fixed = vec![0; graph.len() * new.view_words()];
        for v in 0..graph.len() {
            new.vertex_of[new.cell_of[v] as usize] = v as u32;
            new.add_viewer(v, at, graph);
            if lattice.is_reference[v] {
                set(&mut new.reference, new.cell_of[v] as usize);
            }
        }
        new
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

    /// Walks the trees of some places in the region of query alone, ascending.
    pub fn set_roots(&mut self, places: &[u32]) {
        self.roots = places.to_vec();
    }

    /// The tally of a layout; `None` if a coordinate is beyond the arithmetic.
    pub fn evaluate(&self, moving: &Obstacles, scratch: &mut DenseScratch) -> Option<Tally> {
        let segments = self.take(&moving.segments)?;
        self.look(&segments, &moving.blind, scratch);
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
            let lean = if b[1] > a[1] { (b[0] - a[0]) / (b[1] - a[1]) } else { 0.0 };
            taken.push(Moving { a, b, left: a[0].min(b[0]), right: a[0].max(b[0]), lean, exact });
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
            Path::Avx512 => unsafe { self.cast_all_avx512(segments, blind, scratch) },
            #[cfg(target_arch = "x86_64")]
            #[allow(unsafe_code)]
            Path::Avx2 => unsafe { self.cast_all_avx2(segments, blind, scratch) },
            Path::Portable => self.cast_all::<Portable>(segments, blind, scratch),
        }
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
    #[target_feature(enable = "avx512f,avx512dq,avx2,popcnt,bmi1,bmi2")]
    fn cast_all_avx512(&self, segments: &[Moving], blind: &[u32], scratch: &mut DenseScratch) {
        self.cast_all::<Avx512>(segments, blind, scratch);
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,popcnt,bmi1,bmi2")]
    fn cast_all_avx2(&self, segments: &[Moving], blind: &[u32], scratch: &mut DenseScratch) {
        self.cast_all::<Avx2>(segments, blind, scratch);
    }

    /// The upper half plane of every viewer, as bits by cell, and the lower ones from them.
    #[inline(always)]
    fn cast_all<V: Vector>(&self, segments: &[Moving], blind: &[u32], scratch: &mut DenseScratch) {
        let DenseScratch { view, poses, packed, near, rows, bare, .. } = scratch;
        packed.resize(self.stride * 8 + 1, 0);
        near.resize(segments.len() + 1, 0);
        let poses::Sorted { mut known, again, mut new } = poses.sort(self.id, segments);
        for (key, chain) in again {
            known.push(poses.keep(key, self.pose(chain, near, view)));
        }
        lowest_first(&mut new);
        for v in 0..self.viewers.len() {
            let viewer = self.shade(v, (&known, &new), near, view);
            self.pack::<V>(&viewer, view, packed);
            let row = &mut rows[self.cell_of[v] as usize * self.stride..][..self.stride];
            for (lanes, words) in row.iter_mut().zip(packed.as_chunks().0) {
                lanes.0 = *words;
            }
        }
        bare.clear();
        bare.resize(self.stride, Lanes([u64::MAX; 8]));
        if !blind.is_empty() {
            self.blindfold(blind, rows, bare);
        }
        mirror(rows, self.stride, self.words);
    }

    /// What one chain of segments leaves of every view.
    #[inline(always)]
    fn pose(&self, chain: &[Moving], near: &mut [u32], view: &mut Vec<u64>) -> Pose {
        let mut segments = chain.to_vec();
        lowest_first(&mut segments);
        let mut pose = Pose::with_room(self.viewers.len());
        for v in 0..self.viewers.len() {
            self.shade(v, (&[], &segments), near, view);
            pose.add(self, &self.fixed[v * self.view_words()..][..self.view_words()], view);
        }
        pose
    }

    /// Makes `view` the upper half plane of viewer `v` behind some poses and segments, the lowest first; the viewer with the
    /// box that is left. `near` has room for all segments and one more.
    #[inline(always)]
    fn shade(
        &self,
        v: usize,
        (poses, segments): (&[Arc<Pose>], &[Moving]),
        near: &mut [u32],
        view: &mut Vec<u64>,
    ) -> Viewer {
        let s = self.spacing_um as f64;
        let mut viewer = self.viewers[v];
        view.clear();
        view.extend_from_slice(&self.fixed[v * self.view_words()..][..self.view_words()]);
        for pose in poses {
            pose.shade(v, self.line_stride(), view);
        }
        let (low, top) = (viewer.at[1] as f64 * s, viewer.top as f64 * s);
        let (left, right) = (viewer.lo * s, viewer.hi * s);
        // No branch: which segments are near cannot be guessed.
        let mut count = 0;
        for (i, m) in segments.iter().enumerate() {
            let apart = (m.b[1] < low) | (m.a[1] > top) | (m.right < left) | (m.left > right);
            near[count] = i as u32;
            count += usize::from(!apart);
        }
        for &i in &near[..count] {
            let m = &segments[i as usize];
            if m.a[1] > viewer.top as f64 * s {
                break;
            }
            self.cast(&viewer, m, view);
            while viewer.top > viewer.at[1] && self.is_dark(view, viewer.top) {
                viewer.top -= 1;
            }
        }
        viewer
    }

    /// Whether nothing of a line is seen.
    #[inline(always)]
    fn is_dark(&self, view: &[u64], line: usize) -> bool {
        let mut any = 0;
        for w in 0..self.size[0].div_ceil(64) {
            any |= view[w * self.line_stride() + line];
        }
        any == 0
    }

    /// Words of a half plane: by word of a line, then line, with room for a last stride of lines.
    fn view_words(&self) -> usize {
        self.size[0].div_ceil(64) * self.line_stride()
    }

    /// [`Self::view_words`] for a box of so many columns and rows, before it is made.
    fn view_words_of(size: [usize; 2]) -> usize {
        size[0].max(size[1]).div_ceil(64) * (size[0].min(size[1]) + STRIDE)
    }

    fn line_stride(&self) -> usize {
        self.size[1] + STRIDE
    }

    /// Puts the lines of a view one behind the other, into words that are all written.
    #[inline(always)]
    fn pack<V: Vector>(&self, viewer: &Viewer, view: &[u64], packed: &mut [u64]) {
        packed.fill(0);
        for w in 0..self.size[0].div_ceil(64) {
            let lines = w * self.line_stride() + viewer.at[1]..=w * self.line_stride() + viewer.top;
            let (view, masks, firsts) =
                (&view[lines.clone()], &self.masks[lines.clone()], &self.firsts[lines]);
            for ((&word, &mask), &at) in view.iter().zip(masks).zip(firsts) {
                let bits = V::gather(word, mask);
                let (at, shift) = (at as usize / 64, at % 64);
                packed[at] |= bits << shift;
                packed[at + 1] |= bits >> 1 >> (63 - shift);
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
            lean: m.lean,
            a,
            top: b[1],
            column: viewer.at[0] as f64,
            spacing: s,
            per_spacing: self.per_spacing,
            beyond: self.size[0] as f64 - 0.4,
        };
        let below = (a[1] * self.per_spacing).max(0.0) as usize;
        let mut first = (below + usize::from((below as f64) * s < a[1])).max(1);
        let last = viewer.top - viewer.at[1];
        while first <= last {
            let edges = shadow.lines(first);
            let ((mut from, off_lo), (mut end, off_hi)) = (first_above(&edges.lo), first_above(&edges.hi));
            let mut grazing = false;
            for i in 0..STRIDE {
                grazing |= is_grazing(off_lo[i]) | is_grazing(off_hi[i]);
            }
            if grazing {
                let lines = first..=last.min(first + STRIDE - 1);
                self.settle(viewer, m, lines.clone(), &edges.lo, (&mut from, &off_lo, 0));
                self.settle(viewer, m, lines, &edges.hi, (&mut end, &off_hi, 1));
            }
            self.clear_lines(view, viewer.at[1] + first, &from, &end);
            first += STRIDE;
        }
    }

    /// Clears the cells from one on up to another on each of some lines.
    #[inline(always)]
    fn clear_lines(&self, view: &mut [u64], line: usize, from: &[u64; STRIDE], end: &[u64; STRIDE]) {
        for w in 0..self.size[0].div_ceil(64) {
            let base = (w * 64) as u64;
            let words = &mut view[w * self.line_stride() + line..][..STRIDE];
            for i in 0..STRIDE {
                let (from, end) = (from[i].saturating_sub(base), end[i].saturating_sub(base));
                words[i] &= !(ones_from(from) & !ones_from(end));
            }
        }
    }

    /// Where an edge grazes a cell, whether that cell is in the shadow is tested in whole numbers.
    #[cold]
    fn settle(
        &self,
        viewer: &Viewer,
        m: &Moving,
        distances: std::ops::RangeInclusive<usize>,
        positions: &[f64; STRIDE],
        (whole, off, inside): (&mut [u64; STRIDE], &[f64; STRIDE], u64),
    ) {
        for (i, distance) in distances.enumerate() {
            if is_grazing(off[i]) {
                let cell = (positions[i] + 0.5) as usize;
                let is_in = self.blocks(m, viewer.at, [cell, viewer.at[1] + distance]);
                whole[i] = cell as u64 + if is_in { inside } else { 1 - inside };
            }
        }
    }

    fn clear_cells(&self, view: &mut [u64], line: usize, from: i64, to: i64) {
        for cell in from..=to {
            view[cell as usize / 64 * self.line_stride() + line] &= !(1 << (cell % 64));
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
        let (a, b) = (m.exact.a, m.exact.b);
        // Right of the line through the segment, read upwards, it passes on the left.
        let turn = cross_um(a, b, centre);
        if turn == 0 && segments_touch(m.exact, Segment { a: centre, b: centre }) {
            view.fill(0);
            return None;
        }
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
        let reach = (reach * self.per_spacing).clamp(BEFORE, self.size[0] as f64 - 0.4);
        let ([beyond], [off]) = first_above(&[reach]);
        let is_near = is_grazing(off);
        first = first.max((beyond as usize).saturating_sub(usize::from(is_near)));
        while is_near && first < self.size[0] && !self.blocks(m, viewer.at, [first, line]) {
            first += 1;
        }
        self.clear_cells(view, line, first as i64, self.size[0] as i64 - 1);
        Some(STEEP)
    }

    /// Labels the components of the layout in `rows`.
    #[inline(always)]
    fn find_components(&self, scratch: &mut DenseScratch) {
        let k = self.stride;
        let DenseScratch { rows, component_of, components, .. } = scratch;
        component_of.clear();
        component_of.resize(self.viewers.len(), u32::MAX);
        components.clear();
        // Cells that see anything and belong to no component yet: none, and a flood is over before all of its
        // cells have been asked.
        let mut left = vec![0u64; k * 8];
        for cell in 0..self.viewers.len() {
            let sees = rows[cell * k..][..k].iter().any(|r| *r != Lanes::default());
            left[cell / 64] |= u64::from(sees) << (cell % 64);
        }
        let mut todo = vec![0u64; k * 8];
        for first in 0..self.viewers.len() {
            if component_of[self.vertex_of[first] as usize] != u32::MAX {
                continue;
            }
            let label = (components.len() / k) as u32;
            let start = components.len();
            components.resize(start + k, Lanes::default());
            let member = &mut components[start..];
            set(member, first);
            left[first / 64] &= !(1 << (first % 64));
            todo.fill(0);
            todo[first / 64] |= 1 << (first % 64);
            flood(rows, member, &mut todo, &mut left);
            for (w, word) in member.iter().flat_map(|m| m.0).enumerate() {
                for_each_bit(word, |bit| {
                    component_of[self.vertex_of[w * 64 + bit as usize] as usize] = label;
                });
            }
        }
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx512f,avx512dq,avx2,popcnt,bmi1,bmi2")]
    fn walk_avx512(&self, scratch: &mut DenseScratch) -> Tally {
        self.walk_in::<Avx512>(scratch)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,popcnt,bmi1,bmi2")]
    fn walk_avx2(&self, scratch: &mut DenseScratch) -> Tally {
        self.walk_in::<Avx2>(scratch)
    }

    #[inline(always)]
    fn walk_in<V: Vector>(&self, scratch: &mut DenseScratch) -> Tally {
        self.find_components(scratch);
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
        trees.resize(self.roots.len() * 2 * K, Lanes::default());
        let trees: &mut [[[Lanes; K]; 2]] = trees.as_chunks_mut().0.as_chunks_mut().0;
        let found = &mut scratch.found;
        found.clear();
        let (active, pushed, missing) = (&mut scratch.active, &mut scratch.pushed, &mut scratch.missing);
        active.clear();
        missing.clear();
        for (i, &v) in self.query.iter().enumerate() {
            let cell = self.cell_of[v as usize] as usize;
            let (row, member) = (&rows[cell], &components[scratch.component_of[v as usize] as usize]);
            tally.degree.push(shared_bits(row, &self.reference));
            tally.degree_all.push(count_bits(row));
            if let Some(initial) = self.initial_of.get(i)
                && scratch.bare[cell / LANES].get(cell % LANES) == 1
            {
                let was = &self.initial[*initial as usize];
                tally.disconnected += u64::from(lost_bits(was, member, &scratch.bare));
            }
        }
        for (tree, (&i, [frontier, unseen])) in self.roots.iter().zip(trees.iter_mut()).enumerate() {
            let v = self.query[i as usize] as usize;
            let cell = self.cell_of[v] as usize;
            *frontier = rows[cell];
            *unseen = components[scratch.component_of[v] as usize];
            unseen[cell / LANES].clear(cell % LANES);
            missing.push(count_bits(unseen));
            active.push(tree as u32);
        }
        let few = (words * 16) as u32 / TABLES_PER_PULL;
        let mut level = 0;
        while !active.is_empty() {
            found.resize((level + 1) * self.roots.len(), 0);
            let counts = &mut found[level * self.roots.len()..];
            pushed.clear();
            let mut kept = 0;
            for at in 0..active.len() {
                let tree = active[at] as usize;
                let [frontier, unseen] = &mut trees[tree];
                counts[tree] = count_bits(frontier);
                for k in 0..K {
                    V::load(&unseen[k]).without(V::load(&frontier[k])).store(&mut unseen[k]);
                }
                missing[tree] -= counts[tree];
                if missing[tree] > few {
                    pushed.push(active[at]);
                } else if missing[tree] > 0 {
                    *frontier = pull::<V, K>(rows, frontier, unseen);
                }
                active[kept] = active[at];
                kept += usize::from(missing[tree] > 0);
            }
            active.truncate(kept);
            push::<V, K>(tables, trees, pushed, &mut scratch.room);
            level += 1;
        }
        tally.depth.resize(self.query.len(), 0);
        for (tree, &i) in self.roots.iter().enumerate() {
            let before = tally.levels.len();
            let counts = (0..level).map(|l| found[l * self.roots.len() + tree]);
            tally.levels.extend(counts.take_while(|n| *n > 0));
            tally.depth[i as usize] = (tally.levels.len() - before) as u32;
        }
        tally
    }
}

#[cfg(test)]
mod limits {
    use super::*;
    use crate::Obstacles;
    use crate::visibility::visibility_graph;

    fn two_cells(columns_apart: i32) -> Lattice {
        Lattice {
            spacing_um: 1,
            origin_um: [0, 0],
            cells: vec![[0, 0], [columns_apart, 0]],
            query: vec![0, 1],
            is_reference: vec![true; 2],
            beyond: None,
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

//! Walls as pixels: distances, and what they hide from where.

use crate::geometry::{PointUm, Segment, UM_PER_M};

/// Finest pixel, metres of a person.
const PIXEL_MIN_M: f64 = 0.05;

/// Pixels along the longer side.
const PIXELS_ALONG: f64 = 900.0;

/// Ground round the walls, metres of a person, and as a share of the longer side: as much as makes the outside wider than
/// a gap that is narrower than half the building.
const PAD_M: f64 = 2.0;
const PAD_SHARE: f64 = 0.15;

/// Pixel `c * rows + r` is the one at column `c` and row `r`.
#[derive(Clone, Debug)]
pub struct Raster {
    /// Lower left corner, drawing frame, micrometres.
    pub origin_um: PointUm,
    /// Side of a pixel, micrometres.
    pub pixel_um: i64,
    pub cols: usize,
    pub rows: usize,
    /// Whether a wall, or what closes a gap in one, lies on a pixel.
    pub wall: Vec<bool>,
}

impl Raster {
    /// Empty, with room round the lines; `None` without walls.
    pub fn new(walls: &[Segment], closings: &[Segment], human_scale: f64) -> Option<Self> {
        let (mut lo, mut hi) = ([i64::MAX; 2], [i64::MIN; 2]);
        for p in walls.iter().chain(closings).flat_map(|w| [w.a, w.b]) {
            for k in 0..2 {
                lo[k] = lo[k].min(p[k]);
                hi[k] = hi[k].max(p[k]);
            }
        }
        if walls.is_empty() {
            return None;
        }
        let long = (hi[0] - lo[0]).max(hi[1] - lo[1]) as f64;
        let pixel_um = (long / PIXELS_ALONG).max(PIXEL_MIN_M * human_scale * UM_PER_M).max(1.0) as i64;
        let pad = (PAD_M * human_scale * UM_PER_M).max(PAD_SHARE * long) as i64 / pixel_um + 3;
        let size = |k: usize| ((hi[k] - lo[k]) / pixel_um + 2 * pad + 1) as usize;
        let (cols, rows) = (size(0), size(1));
        let origin_um = [lo[0] - pad * pixel_um, lo[1] - pad * pixel_um];
        Some(Self { origin_um, pixel_um, cols, rows, wall: vec![false; cols * rows] })
    }

    /// Draws lines.
    pub fn draw(&mut self, walls: &[Segment]) {
        for w in walls {
            let d = [(w.b[0] - w.a[0]) as f64, (w.b[1] - w.a[1]) as f64];
            let steps = (d[0].abs().max(d[1].abs()) / self.pixel_um as f64 * 2.0).ceil().max(1.0) as i64;
            for i in 0..=steps {
                let t = i as f64 / steps as f64;
                let at = |k: usize| {
                    (w.a[k] + (d[k] * t) as i64 - self.origin_um[k]).div_euclid(self.pixel_um) as usize
                };
                let (c, r) = (at(0), at(1));
                self.wall[c * self.rows + r] = true;
            }
        }
    }

    /// The pixel that a point lies in.
    pub fn at(&self, p: PointUm) -> Option<usize> {
        let k = |k: usize| (p[k] - self.origin_um[k]).div_euclid(self.pixel_um);
        let (c, r) = (k(0), k(1));
        let inside = c >= 0 && r >= 0 && c < self.cols as i64 && r < self.rows as i64;
        inside.then(|| c as usize * self.rows + r as usize)
    }

    /// The neighbours of a pixel, each with the step that leads on from there.
    pub fn around(&self, i: usize) -> impl Iterator<Item = (usize, isize)> + use<> {
        // Divisions of 32 bits take a fraction of the time, and no raster has so many pixels.
        let (c, r) = ((i as u32 / self.rows as u32) as usize, (i as u32 % self.rows as u32) as usize);
        let row = self.rows as isize;
        let all = [(c > 0, -row), (c + 1 < self.cols, row), (r > 0, -1), (r + 1 < self.rows, 1)];
        all.into_iter().filter(|a| a.0).map(move |(_, step)| (i.wrapping_add_signed(step), step))
    }

    /// The pixels that can be reached from one through such as are free; those `seen` are passed over, and marked.
    pub fn flood(&self, from: usize, seen: &mut [bool], is_free: impl Fn(usize) -> bool) -> Vec<usize> {
        seen[from] = true;
        let (mut found, mut next) = (vec![from], 0);
        while next < found.len() {
            for (j, _) in self.around(found[next]) {
                if !seen[j] && is_free(j) {
                    seen[j] = true;
                    found.push(j);
                }
            }
            next += 1;
        }
        found
    }

    /// Ground from which the border can be reached.
    pub fn open_ground(&self) -> Vec<bool> {
        let mut open = vec![false; self.wall.len()];
        self.flood(0, &mut open, |i| !self.wall[i]);
        open
    }

    /// Whether a pixel lies at the border.
    pub fn is_border(&self, i: usize) -> bool {
        let (c, r) = (i / self.rows, i % self.rows);
        c == 0 || r == 0 || c + 1 == self.cols || r + 1 == self.rows
    }

    /// Distance of every pixel to the nearest marked one, pixels (Felzenszwalb & Huttenlocher 2012).
    pub fn distance(&self, marked: &[bool]) -> Vec<f32> {
        let (cols, rows) = (self.cols, self.rows);
        let far = ((cols + rows) * (cols + rows)) as f64;
        let mut grid: Vec<f64> = vec![far; marked.len()];
        for (column, marked) in grid.chunks_mut(rows).zip(marked.chunks(rows)) {
            along_column(column, marked);
        }
        let mut out = vec![0.0; marked.len()];
        // Several rows at a time, as those of a column lie side by side in memory.
        let mut lines = vec![0.0; ROWS_AT_ONCE * cols];
        let mut envelope = Envelope::new(cols);
        for first in (0..rows).step_by(ROWS_AT_ONCE) {
            let n = ROWS_AT_ONCE.min(rows - first);
            for (c, column) in grid.chunks(rows).enumerate() {
                for (k, v) in column[first..first + n].iter().enumerate() {
                    lines[k * cols + c] = *v;
                }
            }
            lines.chunks_mut(cols).take(n).for_each(|line| envelope.lower(line));
            for (c, column) in out.chunks_mut(rows).enumerate() {
                for (k, v) in column[first..first + n].iter_mut().enumerate() {
                    *v = lines[k * cols + c].sqrt() as f32;
                }
            }
        }
        out
    }
}

/// Rows whose pixels are gathered together.
const ROWS_AT_ONCE: usize = 8;

/// Squared distance of every pixel of a column to the nearest marked one of it; as it was where none is marked.
fn along_column(column: &mut [f64], marked: &[bool]) {
    let mut last = None;
    for (r, v) in column.iter_mut().enumerate() {
        last = if marked[r] { Some(r) } else { last };
        if let Some(at) = last {
            *v = ((r - at) * (r - at)) as f64;
        }
    }
    let mut next = None;
    for (r, v) in column.iter_mut().enumerate().rev() {
        next = if marked[r] { Some(r) } else { next };
        if let Some(at) = next {
            *v = v.min(((at - r) * (at - r)) as f64);
        }
    }
}

/// The lower envelope of parabolas over a line, with the memory for it.
struct Envelope {
    /// Where the parabolas stand that are lowest somewhere, what each has there, and from where on it is the lowest.
    at: Vec<usize>,
    height: Vec<f64>,
    from: Vec<f64>,
}

impl Envelope {
    fn new(n: usize) -> Self {
        Self { at: vec![0; n], height: vec![0.0; n], from: vec![0.0; n + 1] }
    }

    /// Of every place the least of all parabolas `f[q] + (x - q)²`.
    fn lower(&mut self, f: &mut [f64]) {
        let Self { at, height, from } = self;
        let mut k = 0;
        (at[0], height[0]) = (0, f[0]);
        (from[0], from[1]) = (f64::NEG_INFINITY, f64::INFINITY);
        for (q, here) in f.iter().enumerate().skip(1) {
            let own = here + (q * q) as f64;
            let crossing = |p: usize, of_p: f64| (own - (of_p + (p * p) as f64)) / (2.0 * (q - p) as f64);
            let mut s = crossing(at[k], height[k]);
            while s <= from[k] {
                k -= 1;
                s = crossing(at[k], height[k]);
            }
            k += 1;
            (at[k], height[k], from[k]) = (q, *here, s);
            from[k + 1] = f64::INFINITY;
        }
        k = 0;
        for (q, v) in f.iter_mut().enumerate() {
            while from[k + 1] < q as f64 {
                k += 1;
            }
            *v = (q as f64 - at[k] as f64).powi(2) + height[k];
        }
    }
}

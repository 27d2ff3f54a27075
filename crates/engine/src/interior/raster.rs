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
        let (c, r, row) = (i / self.rows, i % self.rows, self.rows as isize);
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
        let mut grid: Vec<f64> = marked.iter().map(|m| if *m { 0.0 } else { far }).collect();
        for column in grid.chunks_mut(rows) {
            let squared = lower_envelope(column);
            column.copy_from_slice(&squared);
        }
        let mut line = vec![0.0; cols];
        for r in 0..rows {
            for c in 0..cols {
                line[c] = grid[c * rows + r];
            }
            for (c, v) in lower_envelope(&line).into_iter().enumerate() {
                grid[c * rows + r] = v;
            }
        }
        grid.into_iter().map(|v| v.sqrt() as f32).collect()
    }

    /// In how many of [`LOOKS`] directions a wall hides the border from each pixel.
    pub fn enclosure(&self) -> Vec<u8> {
        let mut out = vec![0_u8; self.wall.len()];
        for d in LOOKS {
            self.look(d, &mut out);
        }
        out
    }

    /// Adds one to all pixels from which a wall is met in a direction.
    fn look(&self, [dx, dy]: [isize; 2], out: &mut [u8]) {
        let (cols, rows) = (self.cols as isize, self.rows as isize);
        let mut hit = vec![false; self.wall.len()];
        // A long step passes between two pixels: both together hide what is behind.
        let unit = [dx.signum(), dy.signum()];
        let between = match (dx.abs(), dy.abs()) {
            (2, 1) => Some([[unit[0], 0], unit]),
            (1, 2) => Some([[0, unit[1]], unit]),
            (1, 1) => Some([[unit[0], 0], [0, unit[1]]]),
            _ => None,
        };
        let order = |n: isize, back: bool| (0..n).map(move |k| if back { k } else { n - 1 - k });
        for c in order(cols, dx < 0) {
            for r in order(rows, dy < 0) {
                let (x, y) = (c + dx, r + dy);
                if x < 0 || y < 0 || x >= cols || y >= rows {
                    continue;
                }
                let (own, next) = ((c * rows + r) as usize, (x * rows + y) as usize);
                let is_wall = |[dx, dy]: [isize; 2]| self.wall[((c + dx) * rows + r + dy) as usize];
                let is_hidden =
                    self.wall[next] || hit[next] || between.is_some_and(|[p, q]| is_wall(p) && is_wall(q));
                hit[own] = is_hidden;
                out[own] += u8::from(is_hidden);
            }
        }
    }
}

/// Directions in which it is looked.
pub const LOOKS: [[isize; 2]; 16] = [
    [1, 0],
    [2, 1],
    [1, 1],
    [1, 2],
    [0, 1],
    [-1, 2],
    [-1, 1],
    [-2, 1],
    [-1, 0],
    [-2, -1],
    [-1, -1],
    [-1, -2],
    [0, -1],
    [1, -2],
    [1, -1],
    [2, -1],
];

fn lower_envelope(f: &[f64]) -> Vec<f64> {
    let n = f.len();
    let (mut v, mut z) = (vec![0usize; n], vec![0.0; n + 1]);
    let mut k = 0;
    (z[0], z[1]) = (f64::NEG_INFINITY, f64::INFINITY);
    let crossing = |q: usize, p: usize| {
        ((f[q] + (q * q) as f64) - (f[p] + (p * p) as f64)) / (2.0 * q as f64 - 2.0 * p as f64)
    };
    for q in 1..n {
        let mut s = crossing(q, v[k]);
        while s <= z[k] {
            k -= 1;
            s = crossing(q, v[k]);
        }
        k += 1;
        v[k] = q;
        z[k] = s;
        z[k + 1] = f64::INFINITY;
    }
    k = 0;
    (0..n)
        .map(|q| {
            while z[k + 1] < q as f64 {
                k += 1;
            }
            (q as f64 - v[k] as f64).powi(2) + f[v[k]]
        })
        .collect()
}

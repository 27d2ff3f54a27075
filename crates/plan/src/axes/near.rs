//! Things by place: a grid of square buckets.

use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

use glam::DVec2;

/// Squares of a grid to what lies in them. Nothing may depend on their order.
pub type Squares<T> = HashMap<[i64; 2], Vec<T>, BuildHasherDefault<Mix>>;

/// A quick hash of square numbers, which nobody outside chooses with malice beyond slowness.
#[derive(Debug, Default)]
pub struct Mix(u64);

impl Hasher for Mix {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, bytes: &[u8]) {
        for chunk in bytes.chunks(8) {
            let mut word = [0; 8];
            word[..chunk.len()].copy_from_slice(chunk);
            self.write_u64(u64::from_le_bytes(word));
        }
    }

    fn write_u64(&mut self, word: u64) {
        let mixed = (self.0 ^ word).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        self.0 = mixed ^ (mixed >> 29);
    }
}

/// Ids by the squares their paths pass through. Time and memory grow with what is drawn, not with how far it
/// reaches: one value too large must not take the machine.
#[derive(Debug, Default)]
pub struct Buckets {
    size_m: f64,
    squares: Squares<u32>,
    /// Pieces too long for squares.
    long: Vec<(u32, [DVec2; 2])>,
    /// Half squares that pieces longer than [`SHORT_STEPS`] were laid through.
    laid: f64,
}

/// Most squares of one query; beyond it the query is not local and the caller looks at less.
const SQUARES_MAX: i64 = 1 << 16;

/// Half squares up to which a piece is laid through its squares whatever else there is, and those up to which it may
/// be: of squares of 1 m, 2 km.
const SHORT_STEPS: f64 = 64.0;
const LONG_STEPS: f64 = 4096.0;

/// Half squares that all pieces longer than [`SHORT_STEPS`] may take together: some 100 MB.
const LAID_MAX: f64 = 1e6;

impl Buckets {
    /// Empty, with squares of `size_m`.
    pub fn new(size_m: f64) -> Self {
        Self { size_m, ..Self::default() }
    }

    fn square(&self, p: DVec2) -> [i64; 2] {
        [(p.x / self.size_m).floor() as i64, (p.y / self.size_m).floor() as i64]
    }

    /// Adds `id` along straight pieces through `points`; ids in ascending order.
    pub fn add(&mut self, id: u32, points: &[DVec2]) {
        let one = [points[0], points[0]];
        let pieces = if points.len() == 1 { one.windows(2) } else { points.windows(2) };
        for w in pieces {
            let steps = ((w[1] - w[0]).length() / (0.5 * self.size_m)).ceil().max(1.0);
            if steps > SHORT_STEPS {
                if steps > LONG_STEPS || self.laid + steps > LAID_MAX {
                    self.long.push((id, [w[0], w[1]]));
                    continue;
                }
                self.laid += steps;
            }
            let steps = steps as usize;
            for k in 0..=steps {
                let key = self.square(w[0].lerp(w[1], k as f64 / steps as f64));
                let list = self.squares.entry(key).or_default();
                if list.last() != Some(&id) {
                    list.push(id);
                }
            }
        }
    }

    /// Ids that may come nearer than half a square to the box `[lo, hi]`, ascending.
    pub fn near(&self, lo: DVec2, hi: DVec2) -> Vec<u32> {
        let half = DVec2::splat(0.5 * self.size_m);
        let mut out = Vec::new();
        let is_long_near = |(_, s): &&(u32, [DVec2; 2])| meets(*s, [lo - half, hi + half]);
        let long = self.long.iter().filter(is_long_near).map(|l| l.0);
        let (lo, hi) = (self.square(lo - half), self.square(hi + half));
        if (hi[0] - lo[0] + 1).saturating_mul(hi[1] - lo[1] + 1) > SQUARES_MAX {
            return out;
        }
        for x in lo[0]..=hi[0] {
            for y in lo[1]..=hi[1] {
                out.extend(self.squares.get(&[x, y]).into_iter().flatten().copied());
            }
        }
        out.extend(long);
        out.sort_unstable();
        out.dedup();
        out
    }

    /// Ids near straight pieces through `points`, ascending: for long oblique paths, whose box is large.
    pub fn along(&self, points: &[DVec2], reach_m: f64) -> Vec<u32> {
        let mut out = Vec::new();
        let step = self.size_m.max(reach_m);
        let r = DVec2::splat(reach_m);
        for w in points.windows(2) {
            let steps = ((w[1] - w[0]).length() / step).ceil().max(1.0);
            if steps > LONG_STEPS.max(self.squares.len() as f64) {
                out.extend(self.beside([w[0], w[1]], reach_m));
                continue;
            }
            let steps = steps as usize;
            for k in 0..steps {
                let (p, q) = (
                    w[0].lerp(w[1], k as f64 / steps as f64),
                    w[0].lerp(w[1], (k + 1) as f64 / steps as f64),
                );
                out.extend(self.near(p.min(q) - r, p.max(q) + r));
            }
        }
        out.sort_unstable();
        out.dedup();
        out
    }

    /// Ids near a piece that passes more squares than there are, in any order.
    fn beside(&self, piece: [DVec2; 2], reach_m: f64) -> Vec<u32> {
        let around = DVec2::splat(reach_m + 0.5 * self.size_m);
        let is_near = |key: &[i64; 2]| {
            let lo = DVec2::new(key[0] as f64, key[1] as f64) * self.size_m;
            meets(piece, [lo - around, lo + self.size_m + around])
        };
        let squares = self.squares.iter().filter(|(key, _)| is_near(key)).flat_map(|(_, ids)| ids);
        squares.chain(self.long.iter().map(|l| &l.0)).copied().collect()
    }
}

/// Whether a straight piece meets a box.
fn meets([a, b]: [DVec2; 2], [lo, hi]: [DVec2; 2]) -> bool {
    let (middle, half) = ((lo + hi) / 2.0, (hi - lo) / 2.0);
    let normal = (b - a).perp();
    a.min(b).cmple(hi).all()
        && a.max(b).cmpge(lo).all()
        && normal.dot(middle - a).abs() <= normal.abs().dot(half)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a grid of squares of 1 m says of some pieces, and how many squares it holds.
    fn laid(pieces: &[[f64; 4]]) -> Buckets {
        let mut out = Buckets::new(1.0);
        for (i, [x, y, u, v]) in pieces.iter().enumerate() {
            out.add(i as u32, &[DVec2::new(*x, *y), DVec2::new(*u, *v)]);
        }
        out
    }

    #[test]
    fn a_long_piece_is_found_without_squares_of_its_own() {
        let at = |grid: &Buckets, x: f64, y: f64| grid.near(DVec2::new(x, y), DVec2::new(x, y));
        for far in [2_000.0, 2_100.0, 1e6, 1e12] {
            let grid = laid(&[[0.0, 0.0, 3.0, 0.0], [-far, 0.0, far, far * 1e-13], [0.0, 5.0, 3.0, 5.0]]);
            assert!(grid.squares.len() < 9_000, "{far}");
            assert_eq!(at(&grid, 1.0, 0.0), [0, 1], "{far}");
            assert_eq!(at(&grid, 1.0, 5.0), [2], "{far}");
            assert!(at(&grid, 1.0, -3.0).is_empty());
            let along = grid.along(&[DVec2::new(-far, 5.0), DVec2::new(far, 5.0)], 0.5);
            assert!(along.contains(&2), "{far}");
        }
    }

    #[test]
    fn many_long_pieces_take_no_more_squares_than_their_share() {
        let rows: Vec<[f64; 4]> = (0..2_000).map(|i| [0.0, f64::from(i), 2_000.0, f64::from(i)]).collect();
        let grid = laid(&rows);
        assert!(grid.laid <= LAID_MAX && grid.squares.len() as f64 <= LAID_MAX);
        for row in [3, 1_999] {
            let p = DVec2::new(1_500.2, f64::from(row));
            assert!(grid.near(p, p).contains(&(row as u32)), "{row}");
        }
    }
}

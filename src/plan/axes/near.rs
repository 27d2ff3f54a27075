//! Things by place: a grid of square buckets.

use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};

use glam::DVec2;

/// Squares of a grid to what lies in them. Looked up, never iterated.
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

/// Ids by the squares their paths pass through. Looked up, never iterated.
#[derive(Debug, Default)]
pub struct Buckets {
    size_m: f64,
    squares: Squares<u32>,
}

/// Most squares of one query; beyond it the query is not local and the caller looks at less.
const SQUARES_MAX: i64 = 1 << 16;

impl Buckets {
    /// Empty, with squares of `size_m`.
    pub fn new(size_m: f64) -> Self {
        Self { size_m, squares: Squares::default() }
    }

    fn square(&self, p: DVec2) -> [i64; 2] {
        [(p.x / self.size_m).floor() as i64, (p.y / self.size_m).floor() as i64]
    }

    /// Adds `id` along straight pieces through `points`; ids in ascending order.
    pub fn add(&mut self, id: u32, points: &[DVec2]) {
        let one = [points[0], points[0]];
        let pieces = if points.len() == 1 { one.windows(2) } else { points.windows(2) };
        for w in pieces {
            let steps = ((w[1] - w[0]).length() / (0.5 * self.size_m)).ceil().max(1.0) as usize;
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
        let (lo, hi) = (self.square(lo - half), self.square(hi + half));
        let mut out = Vec::new();
        if (hi[0] - lo[0] + 1).saturating_mul(hi[1] - lo[1] + 1) > SQUARES_MAX {
            return out;
        }
        for x in lo[0]..=hi[0] {
            for y in lo[1]..=hi[1] {
                out.extend(self.squares.get(&[x, y]).into_iter().flatten().copied());
            }
        }
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
            let steps = ((w[1] - w[0]).length() / step).ceil().max(1.0) as usize;
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
}

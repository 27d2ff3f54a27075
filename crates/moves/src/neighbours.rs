//! Straight pieces of walls, and which of them lie near a box.

use std::collections::BTreeMap;

use glam::DVec2;

use super::sizes::{DOOR_WIDTH_M, WALL_THICKNESS_MAX_M};

/// Most squares in the boxes of all wall pieces that are looked at for neighbours: beyond, looking takes seconds.
pub const SQUARES_MAX: f64 = 5e6;

/// A straight piece of a wall with its node ids.
pub(super) struct Piece {
    /// Its wall.
    pub wall: u32,
    /// Nodes of its ends.
    pub nodes: [u32; 2],
    /// One end, metres of a person.
    pub a: DVec2,
    /// The other end.
    pub b: DVec2,
}

/// Pieces by place: buckets as large as the largest distance asked for.
pub(super) struct Neighbours {
    size: f64,
    buckets: BTreeMap<[i64; 2], Vec<u32>>,
}

impl Neighbours {
    /// Side of a bucket.
    pub const SIZE_M: f64 = DOOR_WIDTH_M[1].max(WALL_THICKNESS_MAX_M);

    /// How many buckets the boxes of all pieces cover: what looking at the neighbours of each costs.
    pub fn squares(pieces: &[Piece]) -> f64 {
        let of = |p: &Piece| ((p.b - p.a).abs() / Self::SIZE_M + 1.0).element_product();
        pieces.iter().map(of).sum()
    }

    /// Pieces by the buckets that they pass.
    pub fn new(pieces: &[Piece]) -> Self {
        let size = Self::SIZE_M;
        let mut buckets: BTreeMap<[i64; 2], Vec<u32>> = BTreeMap::new();
        for (i, p) in pieces.iter().enumerate() {
            let steps = ((p.b - p.a).length() / size).ceil().max(1.0) as usize;
            for k in 0..=steps {
                let at = p.a.lerp(p.b, k as f64 / steps as f64);
                let bucket =
                    buckets.entry([(at.x / size).floor() as i64, (at.y / size).floor() as i64]).or_default();
                if bucket.last() != Some(&(i as u32)) {
                    bucket.push(i as u32);
                }
            }
        }
        Self { size, buckets }
    }

    /// Pieces that may come nearer than the bucket size to the box, ascending.
    pub fn near(&self, lo: DVec2, hi: DVec2) -> Vec<u32> {
        let mut out: Vec<u32> = self.around(lo, hi).collect();
        out.sort_unstable();
        out.dedup();
        out
    }

    /// The same in any order, some of them several times.
    pub fn around(&self, lo: DVec2, hi: DVec2) -> impl Iterator<Item = u32> + '_ {
        let cell = |p: DVec2| [(p.x / self.size).floor() as i64, (p.y / self.size).floor() as i64];
        let (lo, hi) = (cell(lo), cell(hi));
        let cells = (lo[0] - 1..=hi[0] + 1).flat_map(move |x| (lo[1] - 1..=hi[1] + 1).map(move |y| [x, y]));
        cells.filter_map(|cell| self.buckets.get(&cell)).flatten().copied()
    }
}

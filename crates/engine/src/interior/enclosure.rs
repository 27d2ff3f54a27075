//! From where walls hide the border: all pixels of a column at once, a bit for each.

use super::raster::Raster;

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

/// Bits of a word.
const BITS: usize = 64;

/// Digits that a count of [`LOOKS`] has in binary.
const DIGITS: usize = 5;

/// A bit for every pixel, column by column.
struct Bits {
    words: Vec<u64>,
    /// Words of a column.
    each: usize,
}

impl Bits {
    fn empty(cols: usize, rows: usize) -> Self {
        let each = rows.div_ceil(BITS);
        Self { words: vec![0; cols * each], each }
    }

    fn of(marked: &[bool], cols: usize, rows: usize) -> Self {
        let mut out = Self::empty(cols, rows);
        for (column, marked) in out.words.chunks_mut(out.each).zip(marked.chunks(rows)) {
            for (r, _) in marked.iter().enumerate().filter(|(_, m)| **m) {
                column[r / BITS] |= 1 << (r % BITS);
            }
        }
        out
    }

    fn column(&self, c: usize) -> &[u64] {
        &self.words[c * self.each..(c + 1) * self.each]
    }

    /// A word of a column in which each row has what the row `by` further up has; nothing comes from beyond the ends.
    fn shifted(&self, c: usize, word: usize, by: isize) -> u64 {
        let column = self.column(c);
        let at = |w: Option<usize>| w.and_then(|w| column.get(w)).copied().unwrap_or(0);
        let n = by.unsigned_abs();
        match by {
            0 => column[word],
            1.. => (column[word] >> n) | (at(Some(word + 1)) << (BITS - n)),
            _ => (column[word] << n) | (at(word.checked_sub(1)) >> (BITS - n)),
        }
    }
}

impl Raster {
    /// In how many of [`LOOKS`] directions a wall hides the border from each pixel.
    pub fn enclosure(&self) -> Vec<u8> {
        let (cols, rows) = (self.cols, self.rows);
        let wall = Bits::of(&self.wall, cols, rows);
        let mut digits = [(); DIGITS].map(|()| Bits::empty(cols, rows));
        for d in LOOKS {
            let hidden = if d[0] == 0 { self.above(&wall, d[1]) } else { self.hidden(&wall, d) };
            for (i, word) in hidden.words.iter().enumerate() {
                let mut carry = *word;
                for digit in &mut digits {
                    (digit.words[i], carry) = (digit.words[i] ^ carry, digit.words[i] & carry);
                }
            }
        }
        let mut out = vec![0_u8; self.wall.len()];
        for (c, column) in out.chunks_mut(rows).enumerate() {
            for (r, count) in column.iter_mut().enumerate() {
                let bit = |k: usize| (digits[k].column(c)[r / BITS] >> (r % BITS) & 1) as u8;
                *count = (0..DIGITS).map(|k| bit(k) << k).sum();
            }
        }
        out
    }

    /// Rows from which a step of so many rows stays within the raster.
    fn within(&self, word: usize, dy: isize) -> u64 {
        let up_to = |r: usize| match r.saturating_sub(word * BITS) {
            n if n >= BITS => u64::MAX,
            n => (1 << n) - 1,
        };
        let n = dy.unsigned_abs();
        let ends = if dy > 0 { [0, self.rows.saturating_sub(n)] } else { [n, self.rows] };
        up_to(ends[1]) & !up_to(ends[0])
    }

    /// The pixels from which a wall is met in a direction that leads to other columns.
    fn hidden(&self, wall: &Bits, [dx, dy]: [isize; 2]) -> Bits {
        let mut hit = Bits::empty(self.cols, self.rows);
        let unit = [dx.signum(), dy.signum()];
        let to = |c: usize, dx: isize| c.checked_add_signed(dx).filter(|x| *x < self.cols);
        for k in 0..self.cols {
            let c = if dx < 0 { k } else { self.cols - 1 - k };
            let (Some(next), Some(beside)) = (to(c, dx), to(c, unit[0])) else { continue };
            for word in 0..hit.each {
                // A long step passes between two pixels: both together hide what is behind.
                let between = match (dx.abs(), dy.abs()) {
                    (2, 1) => wall.shifted(beside, word, 0) & wall.shifted(beside, word, unit[1]),
                    (1, 2) => wall.shifted(c, word, unit[1]) & wall.shifted(beside, word, unit[1]),
                    (1, 1) => wall.shifted(beside, word, 0) & wall.shifted(c, word, unit[1]),
                    _ => 0,
                };
                let met = wall.shifted(next, word, dy) | hit.shifted(next, word, dy) | between;
                hit.words[c * hit.each + word] = met & self.within(word, dy);
            }
        }
        hit
    }

    /// The pixels that have a wall above them in their column, or below.
    fn above(&self, wall: &Bits, dy: isize) -> Bits {
        let mut hit = Bits::empty(self.cols, self.rows);
        for c in 0..self.cols {
            let mut is_met = false;
            for k in 0..hit.each {
                let word = if dy > 0 { hit.each - 1 - k } else { k };
                let own = wall.column(c)[word];
                let beyond = match own {
                    0 => 0,
                    _ if dy > 0 => (1_u64 << (BITS as u32 - 1 - own.leading_zeros())) - 1,
                    _ => !(own ^ (own - 1)),
                };
                hit.words[c * hit.each + word] =
                    (if is_met { u64::MAX } else { beyond }) & self.within(word, dy);
                is_met |= own != 0;
            }
        }
        hit
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Whether a wall is met from a pixel in a direction, step by step.
    fn is_hidden(raster: &Raster, at: [isize; 2], [dx, dy]: [isize; 2]) -> bool {
        let size = [raster.cols as isize, raster.rows as isize];
        let wall = |c: isize, r: isize| raster.wall[(c * size[1] + r) as usize];
        let [ux, uy] = [dx.signum(), dy.signum()];
        let [mut c, mut r] = at;
        loop {
            let (x, y) = (c + dx, r + dy);
            if x < 0 || y < 0 || x >= size[0] || y >= size[1] {
                return false;
            }
            let is_between = match (dx.abs(), dy.abs()) {
                (2, 1) => wall(c + ux, r) && wall(c + ux, r + uy),
                (1, 2) => wall(c, r + uy) && wall(c + ux, r + uy),
                (1, 1) => wall(c + ux, r) && wall(c, r + uy),
                _ => false,
            };
            if wall(x, y) || is_between {
                return true;
            }
            (c, r) = (x, y);
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn columns_of_bits_hide_what_steps_meet(
            (cols, rows) in (3_usize..20, 3_usize..150),
            seed in any::<u64>(),
            every in 4_u64..40,
        ) {
            let mut state = seed;
            let mut next = || {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                state >> 33
            };
            let wall: Vec<bool> = (0..cols * rows).map(|_| next() % every == 0).collect();
            let raster = Raster { origin_um: [0, 0], pixel_um: 1, cols, rows, wall };
            let count = |i: usize| {
                let at = [(i / rows) as isize, (i % rows) as isize];
                LOOKS.iter().filter(|d| is_hidden(&raster, at, **d)).count() as u8
            };
            prop_assert_eq!(raster.enclosure(), (0..cols * rows).map(count).collect::<Vec<u8>>());
            let near = raster.distance(&raster.wall);
            let marked: Vec<usize> = (0..cols * rows).filter(|i| raster.wall[*i]).collect();
            for i in (0..cols * rows).filter(|_| !marked.is_empty()) {
                let squared = |j: &usize| (i / rows).abs_diff(j / rows).pow(2) + (i % rows).abs_diff(j % rows).pow(2);
                let least = marked.iter().map(squared).min().unwrap_or_default();
                prop_assert_eq!(near[i], (least as f64).sqrt() as f32);
            }
        }
    }
}

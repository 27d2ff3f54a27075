//! What lies between two cells: lengths, directions, turns.

use super::lanes::ROW;

/// Offsets that are tabulated, at most: 32 MB a table.
const MAX_OFFSETS: i64 = 1 << 22;

/// Length (cells) and direction (right angles from +x, anticlockwise) of every offset between two cells.
pub(super) struct Offsets {
    stride: usize,
    /// The entry of no offset.
    centre: u32,
    /// By row, then column, with room for a row of eight on both sides; empty if there are too many.
    pub lengths: Vec<f64>,
    /// The same in single precision.
    pub singles: Vec<f32>,
    pub directions: Vec<f64>,
}

impl Offsets {
    pub fn new(size: [i32; 2]) -> Self {
        let [w, h] = size.map(i64::from);
        let wide = 2 * (w + ROW as i64) + 1;
        let centre = (h * wide + w) as u32 + ROW as u32;
        let (lengths, singles, directions) = (Vec::new(), Vec::new(), Vec::new());
        let mut new = Self { stride: wide as usize, centre, lengths, singles, directions };
        if wide.saturating_mul(2 * h + 1) <= MAX_OFFSETS {
            let reach = size[0] + ROW as i32;
            let all = || (-size[1]..=size[1]).flat_map(|y| (-reach..=reach).map(move |x| [x, y]));
            new.lengths = all().map(length_of).collect();
            new.singles = all().map(single_of).collect();
            new.directions = all().map(direction_of).collect();
        }
        new
    }

    /// Where a cell lies among the offsets: two places differ by what lies between the entries of their offsets.
    pub fn place(&self, [x, y]: [i32; 2]) -> u32 {
        (y as u32).wrapping_mul(self.stride as u32).wrapping_add(x as u32)
    }

    /// What is added to a place for the entry of the offset there.
    #[inline(always)]
    pub fn origin(&self, from: u32) -> u32 {
        self.centre.wrapping_sub(from)
    }
}

pub(super) fn length_of([x, y]: [i32; 2]) -> f64 {
    let [x, y] = [f64::from(x), f64::from(y)];
    (x * x + y * y).sqrt()
}

pub(super) fn single_of(offset: [i32; 2]) -> f32 {
    length_of(offset) as f32
}

pub(super) fn direction_of([x, y]: [i32; 2]) -> f64 {
    f64::from(y).atan2(f64::from(x)) / std::f64::consts::FRAC_PI_2
}

/// How far a path turns from one direction to another, in right angles.
#[inline(always)]
pub(super) fn turn(before: f64, after: f64) -> f32 {
    let apart = (after - before).abs();
    let other = 4.0 - apart;
    (if apart < other { apart } else { other }) as f32
}

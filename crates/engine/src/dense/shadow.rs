//! The shadow of one segment in the half plane of one viewer, line by line, and where its edges fall between cells.

use super::MAX_CELLS;

/// A shadow's edge nearer to a cell than this, in cells, is decided in whole numbers. Rounding stays
/// below 2⁻²⁵ under the coordinate limits of the sweep.
const GRAZING_CELLS: f64 = 1e-6;

/// Lines of the half plane that are computed at a time.
pub(super) const STRIDE: usize = 8;

/// The shadow of a segment in a viewer's upper half plane: between the slope of its lower end (or an
/// infinite one) and that of its upper end, beyond the segment.
pub(super) struct Shadow {
    pub near: f64,
    pub far: f64,
    pub lean: f64,
    /// Lower end as seen from the viewer, and height of the upper one, micrometres.
    pub a: [f64; 2],
    pub top: f64,
    pub column: f64,
    pub spacing: f64,
    pub per_spacing: f64,
    /// Positions beyond this lie right of all cells.
    pub beyond: f64,
}

/// Where a shadow begins and ends on some lines, in columns; a little beyond the cells where it goes on.
pub(super) struct Edges {
    pub lo: [f64; STRIDE],
    pub hi: [f64; STRIDE],
}

/// Left of all cells, and of nothing whole.
pub(super) const BEFORE: f64 = -0.6;

impl Shadow {
    /// The edges on the lines from `first` on, none of which lies below the segment. Every choice is written so
    /// that it is one instruction for all lines: no number here is NaN.
    #[inline(always)]
    pub fn lines(&self, first: usize) -> Edges {
        let mut edges = Edges { lo: [0.0; STRIDE], hi: [0.0; STRIDE] };
        for i in 0..STRIDE {
            let d = (first + i) as f64;
            let height = d * self.spacing;
            let one = self.near * d;
            let cut = (self.a[0] + self.lean * (height - self.a[1])) * self.per_spacing;
            let two = if self.top <= height { self.far * d } else { cut };
            let (lo, hi) = (if one < two { one } else { two }, if one < two { two } else { one });
            edges.lo[i] = clamped(lo + self.column, self.beyond);
            edges.hi[i] = clamped(hi + self.column, self.beyond);
        }
        edges
    }
}

#[inline(always)]
fn clamped(position: f64, beyond: f64) -> f64 {
    let low = if position > BEFORE { position } else { BEFORE };
    if low < beyond { low } else { beyond }
}

/// Added to a number below 2⁵¹, leaves its nearest whole number in the low bits.
const WHOLE_BITS: f64 = 6_755_399_441_055_744.0;

/// For each of some positions from [`BEFORE`] to [`MAX_CELLS`] the first whole number above it, and how near to
/// half a cell it is from a place between two cells: at a cell, 0.5.
#[inline(always)]
pub(super) fn first_above<const N: usize>(positions: &[f64; N]) -> ([u64; N], [f64; N]) {
    let (mut whole, mut off) = ([0; N], [0.0; N]);
    for i in 0..N {
        let half_on = positions[i] + 0.5;
        let rounded = half_on + WHOLE_BITS;
        whole[i] = rounded.to_bits() & (2 * MAX_CELLS as u64 - 1);
        off[i] = (half_on - (rounded - WHOLE_BITS)).abs();
    }
    (whole, off)
}

/// Whether an edge that is so far off the middle between two cells comes too near to a cell.
#[inline(always)]
pub(super) fn is_grazing(off: f64) -> bool {
    off >= 0.5 - GRAZING_CELLS
}

/// All bits from `first` on; none for 64.
#[inline(always)]
pub(super) fn ones_from(first: u64) -> u64 {
    if first < 64 { u64::MAX << first } else { 0 }
}

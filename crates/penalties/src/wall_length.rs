//! Change of total wall length (spec section 5; paper: Penalty Metrics, "wall length").

use super::Layout;

/// `|S(new) − S(initial)|`: S is the sum of all wall lengths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallLength {
    initial_m: f64,
}

impl WallLength {
    /// Remembers the length of the initial layout.
    pub fn new(initial: &Layout<'_>) -> Self {
        Self { initial_m: total_m(initial) }
    }

    /// The penalty, metres, ≥ 0.
    pub fn measure_m(&self, now: &Layout<'_>) -> f64 {
        (total_m(now) - self.initial_m).abs()
    }
}

/// Sum of all wall lengths S, metres.
pub fn total_m(layout: &Layout<'_>) -> f64 {
    layout.pieces.iter().map(super::WallPiece::length_m).sum()
}

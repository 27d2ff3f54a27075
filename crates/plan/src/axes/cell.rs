//! The space between two neighbouring parallel runs: of wall or of air.

use super::solids::Known;
use super::spans::Span;

/// The space between two neighbouring runs, `i` with `j` on its side `side[0]` (0 positive, 1 negative).
#[derive(Clone, Debug)]
pub struct Cell {
    pub runs: [u32; 2],
    pub side: [usize; 2],
    /// On the first run.
    pub span: Span,
    pub t: f64,
    /// What closed outlines say of it.
    pub known: Known,
}

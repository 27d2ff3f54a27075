//! Centrelines of wall between joints, and what no wall took.

use super::Role;
use super::carrier::Carrier;
use super::spans::Span;

/// A piece of axis.
#[derive(Clone, Debug)]
pub struct Axis {
    pub carrier: Carrier,
    pub span: Span,
    pub thickness: f64,
    pub role: Role,
    /// Indices of [`super::Drawn::faces`] on the positive and on the negative side of the carrier.
    pub sides: [Vec<u32>; 2],
    pub inner: Vec<u32>,
    /// Runs of the sides: what tells that a face goes on where the other is interrupted.
    pub runs: Vec<u32>,
    /// Axes on one line have one row.
    pub row: usize,
}

impl Axis {
    /// Whether a drawn face is a side or a layer of it.
    pub fn has_face(&self, face: u32) -> bool {
        self.sides.iter().flatten().chain(&self.inner).any(|f| *f == face)
    }
}

/// A drawn line on a wall layer that is no face: a pane, a sill, a leaf, a jamb.
#[derive(Clone, Debug)]
pub struct Spare {
    pub carrier: Carrier,
    pub span: Span,
    pub faces: Vec<u32>,
    pub is_cap: bool,
}

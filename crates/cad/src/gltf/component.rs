//! Numbers by which the standard names modes of primitives and types of components.

/// Modes of a primitive: what a list of triangles is where none is stated, and the last.
pub(super) const TRIANGLES: usize = 4;

pub(super) const FAN: usize = 6;

/// Component types of whole numbers that may be normalised; of what is normalised.
pub(super) const WHOLE: [usize; 4] = [5120, 5121, 5122, 5123];

/// Component type of floats.
pub(super) const FLOAT: usize = 5126;

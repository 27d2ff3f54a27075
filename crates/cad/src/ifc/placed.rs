//! Where a new element stands, and what shows it.

use glam::DAffine3;

/// What a new body is placed by: a placement that stands upright, and where that is in the world.
#[derive(Clone, Copy)]
pub(super) struct Base {
    pub placement: Option<u64>,
    pub world: DAffine3,
}

/// A new body: its placement, its item and the representation that shows it.
#[derive(Clone, Copy)]
pub(super) struct Body {
    pub placement: u64,
    pub item: u64,
    pub shown: u64,
    /// For what is placed by it.
    pub base: Base,
}

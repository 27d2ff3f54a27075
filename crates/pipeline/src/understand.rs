//! A drawing understood: its plan, axes and moves.

pub(crate) mod behind;
pub(crate) mod building;
pub(crate) mod carrying;
pub(crate) mod far;
pub(crate) mod fits;
pub(crate) mod gaps;
pub(crate) mod idle;
pub(crate) mod jambs;
pub(crate) mod marked;
pub(crate) mod options;
pub(crate) mod regions;
pub(crate) mod sensed;

//! What is understood, made ready to be measured, and measured.

pub(crate) mod aims;
pub(crate) mod alike;
pub(crate) mod backend;
pub(crate) mod card;
pub mod cells;
pub(crate) mod estimate;
pub(crate) mod faults;
pub(crate) mod lattices;
pub(crate) mod limits;
pub(crate) mod look;
pub(crate) mod measuring;
pub(crate) mod parts;
pub(crate) mod ruler;
pub(crate) mod seen;
pub(crate) mod spacing;
pub(crate) mod study;
pub(crate) mod worth;
pub(crate) mod written;

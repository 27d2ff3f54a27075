//! Drawings understood as plans.

mod houses_in_blocks;
mod offices;
mod understanding;

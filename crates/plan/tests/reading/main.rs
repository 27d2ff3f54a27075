//! Drawings understood as plans.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a failing helper fails the test")]

mod beside_the_lines;
mod houses_in_blocks;
mod offices;
mod understanding;

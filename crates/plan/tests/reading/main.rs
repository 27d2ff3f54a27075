//! Drawings understood as plans.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a failing helper fails the test")]

mod houses_in_blocks;
mod offices;
mod understanding;

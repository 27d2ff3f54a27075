//! The brief of rooms, worked out by hand.

#![allow(clippy::unwrap_used, clippy::expect_used)]

mod hand;
mod plan;
mod property;
mod words;

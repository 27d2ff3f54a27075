//! Whole studies, from bytes to what is written.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a failing helper fails the test")]

mod alike;
mod brief;
mod building;
mod buildings;
mod cases;
mod decided;
mod gltf;
mod habits;
mod ifc;
mod ifc_marks;
mod made;
mod outlines;
mod plan_hazards;
mod reference;
mod sheets;
mod slips;
mod strangers;
mod unsure;
mod wide;

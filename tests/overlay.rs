//! Pictures and pages as a reader gets them.
//!
//! With `ENFILADE_LOOK=DIR` everything drawn is also written there, to be looked at.
#![allow(clippy::unwrap_used)] // a helper that fails fails its test

#[path = "overlay/golden.rs"]
mod golden;
#[path = "overlay/page.rs"]
mod page;
#[path = "overlay/pictures.rs"]
mod pictures;
#[path = "overlay/plans.rs"]
mod plans;
#[path = "overlay/sample.rs"]
mod sample;

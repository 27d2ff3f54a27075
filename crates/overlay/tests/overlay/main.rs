//! Pictures and pages as a reader gets them.
//!
//! With `ENFILADE_LOOK=DIR` everything drawn is also written there, to be looked at.
#![allow(clippy::unwrap_used)] // a helper that fails fails its test

mod golden;
mod page;
mod pictures;
mod plans;
mod sample;

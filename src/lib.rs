//! Enfilade: from an architect's drawing to a diverse set of better layouts, and back.
//!
//! The modules stand in the order of the flow; see `ARCHITECTURE.md`.

pub mod analysis;
pub mod daemon;
pub mod formats;
pub mod overlay;
pub mod plan;
pub mod report;
pub mod search;
pub mod store;
pub mod watch;

//! Enfilade: from an architect's drawing to a diverse set of better layouts, and back.
//!
//! The modules stand in the order of the flow; see `ARCHITECTURE.md`.

pub mod analysis;
pub mod batch;
pub mod cli;
pub mod commands;
pub mod config;
pub mod daemon;
pub mod formats;
pub mod moves;
pub mod overlay;
pub mod penalties;
pub mod pipeline;
pub mod plan;
pub mod progress;
pub mod report;
pub mod sample_settings;
pub mod search;
pub mod server;
pub mod service;
pub mod store;
pub mod watch;

/// Version of the program, with the commit that it was built from where that is known: `0.1.0 (1f2e3d4c5)`.
pub const VERSION: &str = concat!(env!("CARGO_PKG_VERSION"), env!("ENFILADE_COMMIT_SUFFIX"));

//! Enfilade: from an architect's drawing to a diverse set of better layouts, and back.
//!
//! This is the shell: command line, daemon, local page, store. What it calls stands in `crates`; see `ARCHITECTURE.md`.

pub mod batch;
pub mod cli;
pub mod commands;
pub mod daemon;
pub mod output;
pub mod progress;
pub mod sample_settings;
pub mod server;
pub mod service;
pub mod store;
pub mod watch;
pub mod worked;

//! The program as its users meet it: command line, daemon, page.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a failing helper fails the test")]

mod analyse;
mod chaos;
mod cleaning;
mod cli;
mod control;
mod corrections;
mod daemon;
mod desk;
mod jobs;
mod joined;
mod limits;
mod page;
mod parsers;
mod parts;
mod real_drawings;
mod resume;
mod rounds;
mod told_moves;

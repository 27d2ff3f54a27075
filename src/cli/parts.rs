//! `parts` and `merge`: one analysis on many machines; `join`: one search.

use std::path::PathBuf;

use clap::Args;

use super::values::{json_file, radius, whole};
use super::{Common, TableArgs, seconds};

/// `parts`.
#[derive(Debug, Args)]
pub struct PartsArgs {
    /// The drawing.
    pub file: PathBuf,
    /// How many parts.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub parts: u32,
    /// Measures of every cell, as `analyse` takes them; graph by default.
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub measures: Vec<String>,
    /// Nothing farther than this counts, as `analyse` takes it.
    #[arg(long, value_name = "R", value_parser = radius)]
    pub radius: Option<f64>,
    /// Put the drawing's bytes into the parts, for machines that share no folder.
    #[arg(long)]
    pub embed: bool,
    /// Where the list goes; - or nothing for standard output.
    #[arg(long, short, value_name = "FILE")]
    pub output: Option<PathBuf>,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub common: Common,
}

/// `merge`.
#[derive(Debug, Args)]
pub struct MergeArgs {
    /// The list that `parts` wrote; it says the drawing, its settings and what is measured.
    pub list: PathBuf,
    /// The parts lie below this folder instead of the one that the list names.
    #[arg(long, value_name = "DIR")]
    pub parts: Option<PathBuf>,
    /// Write the lines of parts that are not done, to be sent again.
    #[arg(long, value_name = "FILE")]
    pub missing: Option<PathBuf>,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub tables: TableArgs,
    /// Threads; all cores by default. Never changes the result.
    #[arg(long, value_name = "N", value_parser = whole::<usize>)]
    pub threads: Option<usize>,
    /// Results go to DIR/plan.enfilade/ instead of beside the drawing.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// The result as JSON; - or nothing for standard output.
    #[arg(long, value_name = "FILE", num_args = 0..=1, default_missing_value = "-", value_parser = json_file)]
    pub json: Option<PathBuf>,
    /// Say nothing but errors.
    #[arg(long, short)]
    pub quiet: bool,
    /// Joining that takes longer by the clock, in seconds, is given up (else as `analyse`).
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    pub job_limit_secs: Option<f64>,
}

/// `join`.
#[derive(Debug, Args)]
pub struct JoinArgs {
    /// The list that `jobs --seeds` wrote.
    pub list: PathBuf,
    /// The results lie below this folder instead of the one that the list names.
    #[arg(long, value_name = "DIR")]
    pub results: Option<PathBuf>,
    /// Write the lines of searches that are not done, to be sent again.
    #[arg(long, value_name = "FILE")]
    pub missing: Option<PathBuf>,
    /// Where the job goes; - or nothing for standard output.
    #[arg(long, short, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Say nothing but errors.
    #[arg(long, short)]
    pub quiet: bool,
}

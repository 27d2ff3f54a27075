//! The command line: with `idle` the only place that says clap.

mod choices;
mod idle;
mod manual;
mod parts;
mod reading;
mod tables;
mod values;

use std::io::Write as _;
use std::path::PathBuf;

use clap::{Args, CommandFactory, FromArgMatches, Parser, Subcommand, ValueEnum};

use crate::output::unsaid;
pub use choices::{
    BackendArg, ColoursArg, LevelArg, MethodArg, ModeArg, OverlayArg, ThresholdsArg, UnsureArg,
};
use enfilade_config::{BriefText, JOB_SECS, Partial};
use enfilade_pipeline::resolution;
use enfilade_report::complain;
pub use manual::man;
pub use parts::{JoinArgs, MergeArgs, PartsArgs};
use reading::ReadingArgs;
pub use tables::TableArgs;
use values::{graph_file, json_file, levels, picture_file, point, radius, whole};

/// From an architect's drawing to a diverse set of better layouts, and back.
#[derive(Debug, Parser)]
#[command(name = "enfilade", version = enfilade_config::VERSION, about, max_term_width = 100, arg_required_else_help = true)]
pub struct Cli {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// Parses the command line of this process. Help and errors are printed here.
///
/// # Errors
/// The exit code: 0 where help or the version was asked for, 3 for wrong usage, 4 where help could not be said.
pub fn parse() -> Result<Cli, u8> {
    let matches = grammar().try_get_matches().map_err(|e| end_of(&e))?;
    idle::judge(&matches).map_err(|error| {
        complain(format_args!("error: {error}"));
        error.exit_code()
    })?;
    Cli::from_arg_matches(&matches).map_err(|e| end_of(&e))
}

/// Says help, version or what is wrong, and with what code that ends.
fn end_of(e: &clap::Error) -> u8 {
    let said = e.print().and_then(|()| std::io::stdout().flush());
    if e.use_stderr() {
        return 3;
    }
    match said {
        // A closed pipe is no reason to fail.
        Err(fault) if fault.kind() != std::io::ErrorKind::BrokenPipe => {
            let error = unsaid(&fault.to_string());
            complain(format_args!("error: {error}"));
            error.exit_code()
        }
        _ => 0,
    }
}

/// What the command line may say. A negative number is a value, if one out of range, and not an option.
fn grammar() -> clap::Command {
    let command = idle::hidden(Cli::command()).after_help(manual::exit_codes());
    command.mut_subcommands(|c| c.allow_negative_numbers(true))
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Say what the program understands of a drawing.
    Check(CheckArgs),
    /// Measure the present layout; heat maps go to plan.enfilade/analysis/.
    Analyse(AnalyseArgs),
    /// Say what one building work would bring: every opening, door, wider door, removal, at its best place.
    Works(WorksArgs),
    /// Say whether the present layout has what is asked of its rooms, doors and ways.
    Brief(BriefArgs),
    /// Measure over a series of lattice spacings, the drawing as it is and layouts moved at random: how fine the lattice
    /// must be.
    Resolution(ResolutionArgs),
    /// Do the whole job once: measure, optimise, write the next round.
    Run(RunArgs),
    /// Do the same job for every finished save in the folders, until stopped.
    Watch(WatchArgs),
    /// One job of the daemon, in a process of its own; the request comes on standard input.
    #[command(hide = true)]
    JobChild {
        /// The drawing.
        drawing: PathBuf,
        /// Its result folder.
        results: PathBuf,
    },
    /// Make candidate N of the newest round a new drawing beside the old one.
    Accept(AcceptArgs),
    /// List jobs for many machines, one a line: drawings, storeys and seeds.
    Jobs(JobsArgs),
    /// Do one such job or part, unless it is done. Exit code 2: bad input; 75: try again.
    RunJob(RunJobArgs),
    /// List the parts of one large analysis for many machines, one a line; `run-job` does each.
    Parts(PartsArgs),
    /// Join the parts: the analysis that one machine would have made. Exit code 75: some are not done.
    Merge(MergeArgs),
    /// Join the searches that `jobs --seeds` lists: one more job, which begins with what they found. Exit code 75: some are
    /// not done.
    Join(JoinArgs),
    /// Say what the daemon does in the folders.
    Status(StatusArgs),
    /// Open the page of a running daemon in the browser.
    Open(OpenArgs),
    /// Install the daemon as a service of yours, ask for it, take it away.
    Service(ServiceArgs),
    /// Say what this machine offers, what is wrong and what helps. Exit code 1: something is.
    Doctor {
        /// Folders to look at as well.
        #[arg(value_name = "DIR")]
        folders: Vec<PathBuf>,
        /// Say what graphics card there is, and no more: asked in a process of its own.
        #[arg(long, hide = true)]
        card: bool,
    },
    /// Write the completions of a shell to standard output.
    Completions {
        /// The shell.
        shell: ShellArg,
    },
    /// Write the manual page to standard output.
    Man,
    /// Write a commented enfilade.toml.
    Init(InitArgs),
}

/// Options of every command that reads a drawing.
#[derive(Debug, Default, Args)]
pub struct Common {
    /// Unit of the drawing; overrides the file.
    #[arg(long, value_name = "mm|cm|m|in|ft")]
    pub unit: Option<String>,
    /// Layer of the walls, * and ? may stand in it; repeatable.
    #[arg(long, value_name = "GLOB")]
    pub wall_layer: Vec<String>,
    /// Layer of the region of query instead of EF-QUERY.
    #[arg(long, value_name = "NAME")]
    pub query_layer: Option<String>,
    /// Layer of the region of reference instead of EF-REFERENCE.
    #[arg(long, value_name = "NAME")]
    pub reference_layer: Option<String>,
    /// Which drawing of a sheet with several: its name or number as `check` lists them, all, or a box in drawing units.
    #[arg(long, value_name = "NAME|N|XMIN,YMIN,XMAX,YMAX", allow_hyphen_values = true)]
    pub view: Option<String>,
    /// Height of the sight lines.
    #[arg(long, value_enum)]
    pub level: Option<LevelArg>,
    /// Distance of the lattice's cell centres.
    #[arg(long, value_name = "METRES")]
    pub spacing: Option<f64>,
    /// A cell centre, metres.
    #[arg(long, value_name = "X,Y", value_parser = point, allow_hyphen_values = true)]
    pub lattice_centre: Option<[f64; 2]>,
    /// Where no region is drawn: the region is what a flood from here reaches, drawing units; repeatable.
    #[arg(long, value_name = "X,Y", value_parser = point, allow_hyphen_values = true)]
    pub seed_point: Vec<[f64; 2]>,
    /// What computes.
    #[arg(long, value_enum)]
    pub backend: Option<BackendArg>,
    /// Threads; all cores by default. Never changes the result.
    #[arg(long, value_name = "N", value_parser = whole::<usize>)]
    pub threads: Option<usize>,
    /// Results go to DIR/plan.enfilade/ instead of beside the drawing.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Colours of the heat maps.
    #[arg(long, value_enum)]
    pub colours: Option<ColoursArg>,
    /// Draw no picture: the numbers alone, sooner. The page of a round then has none either.
    #[arg(long)]
    pub no_pictures: bool,
    /// Storey of a building, by name or number from the lowest; by default the one with most walls.
    #[arg(long, value_name = "NAME")]
    pub storey: Option<String>,
    /// Count steps over the stairs to the other storeys of the building too.
    #[arg(long)]
    pub over_stairs: bool,
    /// Spaces of a building that are the region of query: space:NAME or zone:NAME, * and ? may stand in NAME.
    #[arg(long, value_name = "space:NAME|zone:NAME")]
    pub query: Option<String>,
    /// Read a DXF that ends without its end mark (0/EOF).
    #[arg(long)]
    pub accept_missing_eof: bool,
    /// The result as JSON; - or nothing for standard output.
    #[arg(long, value_name = "FILE", num_args = 0..=1, default_missing_value = "-", value_parser = json_file)]
    pub json: Option<PathBuf>,
    /// Say nothing but errors.
    #[arg(long, short)]
    pub quiet: bool,
    /// How progress is said on standard error.
    #[arg(long, value_enum)]
    pub progress: Option<ProgressArg>,
    /// A drawing that takes longer to read, in seconds of work, is given up (`read-limit-secs` under `watch` in the settings, else 300).
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    pub read_limit_secs: Option<f64>,
    /// The same for the whole job (`job-limit-secs` under `watch` in the settings, else 3600 more than --seconds).
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    pub job_limit_secs: Option<f64>,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub reading: ReadingArgs,
}

/// A limit of time.
fn seconds(text: &str) -> Result<f64, String> {
    let found = text.parse().ok().filter(|s: &f64| *s > 0.0 && *s <= JOB_SECS[1]);
    found.ok_or_else(|| format!("expected seconds above 0, at most {}", JOB_SECS[1]))
}

/// `check`.
#[derive(Debug, Args)]
pub struct CheckArgs {
    /// The drawing.
    pub file: PathBuf,
    /// Draw a picture of what was understood.
    #[arg(long, value_name = "OUT.png", value_parser = picture_file)]
    pub preview: Option<PathBuf>,
    /// Write walls, openings and rooms as a graph: GraphML, or JSON where the name ends so.
    #[arg(long, value_name = "OUT.graphml|OUT.json", value_parser = graph_file)]
    pub graph: Option<PathBuf>,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub common: Common,
}

/// `analyse`.
#[derive(Debug, Args)]
pub struct AnalyseArgs {
    /// The drawing.
    pub file: PathBuf,
    /// Measures of every cell: graph (or visual), isovist, metric, angular, through, all, or depthmapX's names of
    /// columns, separated by commas. They stand in --cells, and each gets a heat map. Default: graph,
    /// in --cells only.
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub measures: Vec<String>,
    /// Nothing farther than this counts: steps of the graph measures (whole), right angles of the angular,
    /// metres of the metric ones.
    #[arg(long, value_name = "R", value_parser = radius)]
    pub radius: Option<f64>,
    /// Estimate depth, entropy and integration from about N cells, with confidence intervals.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(2..))]
    pub roots: Option<u64>,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub tables: TableArgs,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub common: Common,
}

/// `works`.
#[derive(Debug, Args)]
pub struct WorksArgs {
    /// The drawing.
    pub file: PathBuf,
    /// Draw the plan with each wall in the colour of the best that an opening there would bring.
    #[arg(long, value_name = "OUT.png", value_parser = picture_file)]
    pub preview: Option<PathBuf>,
    /// Make works of the list by their numbers, separated by commas, in a new drawing beside this one: plan-r02.dxf.
    #[arg(long, value_name = "NUMBERS", value_delimiter = ',', value_parser = whole::<usize>)]
    pub make: Vec<usize>,
    /// How many works to list, each pair of rooms once.
    #[arg(long, value_name = "N", default_value_t = 10, value_parser = whole::<usize>)]
    pub most: usize,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub common: Common,
}

/// `brief`.
#[derive(Debug, Args)]
pub struct BriefArgs {
    /// The drawing.
    pub file: PathBuf,
    /// What is asked: "kitchen area min 8 m2; bath not-seen-from hall; rule=ways-out-35m"; repeatable.
    #[arg(long, value_name = "ITEMS")]
    pub brief: Vec<String>,
    /// Draw the plan with each place in the colour of its verdict.
    #[arg(long, value_name = "OUT.png", value_parser = picture_file)]
    pub preview: Option<PathBuf>,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub common: Common,
}

/// `resolution`.
#[derive(Debug, Args)]
pub struct ResolutionArgs {
    /// The drawing.
    pub file: PathBuf,
    /// Spacings to study, metres, separated by commas; a series that suits the plan by default.
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub spacings: Vec<f64>,
    /// Change, relative to the finest lattice, up to which a measure counts as unchanged.
    #[arg(long, value_name = "0..1", default_value_t = resolution::TOLERANCE)]
    pub tolerance: f64,
    /// Layouts sampled within the bounds of the moves; their means stand beside the drawing as it is.
    #[arg(long, value_name = "N", default_value_t = resolution::SAMPLES, value_parser = whole::<usize>)]
    pub samples: usize,
    /// Seed of the samples.
    #[arg(long, value_name = "N", value_parser = whole::<u64>)]
    pub seed: Option<u64>,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub common: Common,
}

/// What the search does.
#[derive(Debug, Default, Args)]
pub struct SearchArgs {
    /// Seed: the same seed gives the same bytes.
    #[arg(long, value_name = "N", value_parser = whole::<u64>)]
    pub seed: Option<u64>,
    /// Budget: layouts to measure.
    #[arg(long, value_name = "N", value_parser = whole::<u64>)]
    pub evaluations: Option<u64>,
    /// Budget: seconds (the result then depends on the machine).
    #[arg(long, value_name = "S")]
    pub seconds: Option<f64>,
    /// End when about 95 % of what the search would converge to is reached; --evaluations and --seconds are the most.
    #[arg(long)]
    pub until_converged: bool,
    /// Layouts measured at once, 1 to 64: more fill more cores or a graphics card, fewer learn sooner. Part of the search:
    /// the number of cores changes nothing.
    #[arg(long, value_name = "N", value_parser = whole::<usize>)]
    pub together: Option<usize>,
    /// Write what was found so far every S seconds, into the folder so-far.
    #[arg(long, value_name = "S")]
    pub write_every: Option<f64>,
    /// Options wanted.
    #[arg(long, value_name = "N", value_parser = whole::<usize>)]
    pub members: Option<usize>,
    /// Several different options, or the single best.
    #[arg(long, value_enum)]
    pub mode: Option<ModeArg>,
    /// Our search, or the paper's algorithms as published.
    #[arg(long, value_enum)]
    pub method: Option<MethodArg>,
    /// Objectives in order with thresholds: "degree max 0.7, depth min 0.7, entropy max 0.7"; measures as
    /// -min, -max, -p10 of their cells ("degree-p10 max"), over a named pair of regions ("degree@entrance max").
    #[arg(long, value_name = "LIST")]
    pub objective: Option<String>,
    /// Whether thresholds stand, or are lowered where they leave no room for options that differ [default:
    /// firm with --objective, else yielding].
    #[arg(long, value_enum)]
    pub thresholds: Option<ThresholdsArg>,
    /// Where the reading of the drawing is unsure: ask and make no option, or optimise all the same [default: ask].
    #[arg(long, value_enum)]
    pub unsure: Option<UnsureArg>,
    /// Weights of the composite measure: "degree +1, depth -1, entropy +1".
    #[arg(long, value_name = "LIST", allow_hyphen_values = true)]
    pub score: Option<String>,
    /// What weighs against gains: "clearance 1, wall-length 0.5", or "none". 1 weighs as a gain of 100 %.
    #[arg(long, value_name = "LIST")]
    pub penalty: Option<String>,
    /// How far apart options should be, as a fraction of the largest distance.
    #[arg(long, value_name = "0..1")]
    pub distance: Option<f64>,
    /// Hard limits: "wall-length -5%, room-area -5%, clearance 3, passage 0.9 m, degree-p10 >= 40", or "none".
    #[arg(long, value_name = "LIST")]
    pub limit: Option<String>,
    /// Groups that move together: "same: door-1, door-2", "mirror-x: a, b", "mirror-y: a, b",
    /// "equal: a, b, c"; repeatable; "none" for no link.
    #[arg(long, value_name = "LINK")]
    pub link: Vec<String>,
    /// Modules that moves keep to: "0.1 m, 5 deg", or "none".
    #[arg(long, value_name = "LIST")]
    pub snap: Option<String>,
    /// Most groups that an option may move.
    #[arg(long, value_name = "N", value_parser = whole::<usize>)]
    pub most_moves: Option<usize>,
    /// Move what is marked and nothing else, not even where nothing is marked.
    #[arg(long)]
    pub only_marked: bool,
    /// What options may do that none does otherwise: structure, open-joints, crossings, narrow-ways, things, any-step.
    #[arg(long, value_name = "LIST")]
    pub allow: Option<String>,
    /// What the building works of an option may cost: "2 works, 4 m" of wall that goes or is built.
    #[arg(long, value_name = "LIST")]
    pub budget: Option<String>,
    /// The brief of rooms: "kitchen area min 8 m2; rule=ways-out-35m". It is checked for the present layout.
    #[arg(long, value_name = "ITEMS")]
    pub brief: Option<String>,
    /// Show an option if it surely gains this much in something that is asked for; 1% by default.
    #[arg(long, value_name = "SHARE")]
    pub least_gain: Option<String>,
    /// Heat maps, notes and traces: drawn in the drawings of a round on layers of ours, or in a DXF of their own beside
    /// each, to be attached as a reference [default: drawn].
    #[arg(long, value_enum)]
    pub overlay: Option<OverlayArg>,
    /// The bare problem, for comparisons: one lattice, options by the distance of their parameters, nothing stripped,
    /// rounded or confirmed.
    #[arg(long)]
    pub raw: bool,
}

/// `run`.
#[derive(Debug, Args)]
pub struct RunArgs {
    /// The drawing.
    pub file: PathBuf,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub search: SearchArgs,
    /// Keep option N of the newest round and find others unlike it; repeatable.
    #[arg(long, value_name = "N")]
    pub pin: Vec<usize>,
    /// Look near option N of the newest round.
    #[arg(long, value_name = "N", value_parser = whole::<usize>)]
    pub like: Option<usize>,
    /// --pin and --like name options of the best so far of a stopped search, not of the newest round.
    #[arg(long)]
    pub so_far: bool,
    /// Say every move in words, why each option is better, and all notes.
    #[arg(long, short, conflicts_with = "quiet")]
    pub verbose: bool,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub common: Common,
}

/// Which folders are watched, and how.
#[derive(Debug, Args)]
pub struct LookingArgs {
    /// The folders.
    #[arg(required = true, value_name = "DIR")]
    pub folders: Vec<PathBuf>,
    /// Look at the folders regularly instead of waiting for events (network drives).
    #[arg(long)]
    pub poll: bool,
    /// Also look into folders below, this many levels deep.
    #[arg(long, value_name = "LEVELS", value_parser = levels)]
    pub depth: Option<usize>,
    /// Names to leave alone, * and ? may stand in them; repeatable.
    #[arg(long, value_name = "GLOB")]
    pub ignore: Vec<String>,
    /// Results go below this folder where nothing may be written beside a drawing; a full disk is waited for.
    #[arg(long, value_name = "DIR")]
    pub fallback: Option<PathBuf>,
    /// Watch even a root or home folder.
    #[arg(long)]
    pub force: bool,
}

/// `watch`.
#[derive(Debug, Args)]
pub struct WatchArgs {
    #[command(flatten)]
    #[allow(missing_docs)]
    pub looking: LookingArgs,
    /// Open a page on this machine alone: what is done, options side by side. PORT 0: any free one.
    #[arg(long, value_name = "PORT", num_args = 0..=1, default_missing_value = "0", require_equals = true)]
    pub page: Option<u16>,
    /// Show a message on the desktop when options are ready.
    #[arg(long = "notify")]
    pub desktop: bool,
    /// Write what is said to this file as well; full ones are put aside.
    #[arg(long, value_name = "FILE")]
    pub log: Option<PathBuf>,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub search: SearchArgs,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub common: Common,
}

/// `open`.
#[derive(Debug, Args)]
pub struct OpenArgs {
    /// The watched folder.
    #[arg(default_value = ".", value_name = "DIR")]
    pub folder: PathBuf,
    /// Say the address instead of opening it.
    #[arg(long)]
    pub print: bool,
}

/// `service`.
#[derive(Debug, Args)]
pub struct ServiceArgs {
    /// What to do.
    #[command(subcommand)]
    pub what: ServiceCommand,
}

/// What can be done with the service.
#[derive(Debug, Subcommand)]
pub enum ServiceCommand {
    /// Watch these folders from now on, whenever you are logged in.
    Install(InstallArgs),
    /// Whether it is installed and runs.
    Status,
    /// Stop it and take it away.
    Uninstall,
}

/// `service install`.
#[derive(Debug, Args)]
pub struct InstallArgs {
    #[command(flatten)]
    #[allow(missing_docs)]
    pub looking: LookingArgs,
    /// Results go below this folder instead of beside the drawings.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// Shells with completions.
#[derive(Clone, Copy, Debug, ValueEnum)]
#[allow(missing_docs)]
pub enum ShellArg {
    Bash,
    Elvish,
    Fish,
    #[value(alias = "powershell")]
    PowerShell,
    Zsh,
}

/// Completions of a shell.
pub fn completions(shell: ShellArg) -> String {
    let shell = match shell {
        ShellArg::Bash => clap_complete::Shell::Bash,
        ShellArg::Elvish => clap_complete::Shell::Elvish,
        ShellArg::Fish => clap_complete::Shell::Fish,
        ShellArg::PowerShell => clap_complete::Shell::PowerShell,
        ShellArg::Zsh => clap_complete::Shell::Zsh,
    };
    let mut out = Vec::new();
    clap_complete::generate(shell, &mut idle::left_out(Cli::command()), "enfilade", &mut out);
    String::from_utf8_lossy(&out).into_owned()
}

/// The number of an option; 0 for `best`.
fn option_number(text: &str) -> Result<usize, String> {
    if text.eq_ignore_ascii_case("best") { Ok(0) } else { whole(text) }
}

/// `accept`.
#[derive(Debug, Args)]
#[command(group = clap::ArgGroup::new("taken").args(["number", "point"]))]
pub struct AcceptArgs {
    /// The drawing the round was made from.
    pub file: PathBuf,
    /// Option, from 1; `best` (or 0): the best layout found, with all its moves.
    #[arg(value_name = "N|best", value_parser = option_number, required_unless_present_any = ["clean", "point"])]
    pub number: Option<usize>,
    /// A point of the front of gain against effort instead of an option: its works, as the page and result.json list them.
    #[arg(long, value_name = "N", conflicts_with = "number", value_parser = whole::<usize>)]
    pub point: Option<usize>,
    /// Take what is demolished out of the new drawing for good; without an option, out of a copy of this one.
    #[arg(long)]
    pub clean: bool,
    /// Round to take it from; the newest by default.
    #[arg(long, value_name = "N", requires = "taken", value_parser = whole::<u32>)]
    pub round: Option<u32>,
    /// Take it from the best so far of a stopped search, in the folder so-far.
    #[arg(long, requires = "taken", conflicts_with = "round")]
    pub so_far: bool,
    /// Where the results of the drawing are, if not beside it.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// `jobs`.
#[derive(Debug, Args)]
pub struct JobsArgs {
    /// The drawings.
    #[arg(required = true, value_name = "PLAN")]
    pub files: Vec<PathBuf>,
    /// Seeds, one job each: 1..20, or 1,5,9.
    #[arg(long, value_name = "LIST", conflicts_with = "seed")]
    pub seeds: Option<String>,
    /// Storeys, one job each: all, or names or numbers separated by commas.
    #[arg(long, value_name = "all|LIST")]
    pub storeys: Option<String>,
    /// Put the drawings' bytes into the jobs, for machines that share no folder.
    #[arg(long)]
    pub embed: bool,
    /// Where the list goes; - or nothing for standard output.
    #[arg(long, short, value_name = "FILE")]
    pub output: Option<PathBuf>,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub search: SearchArgs,
    #[command(flatten)]
    #[allow(missing_docs)]
    pub common: Common,
}

/// `run-job`.
#[derive(Debug, Args)]
pub struct RunJobArgs {
    /// The job as `jobs` or `parts` wrote it; - for standard input.
    #[arg(value_name = "JSON")]
    pub job: String,
    /// Results go below this folder instead of the one the job names.
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Threads; all cores by default. Never changes the result.
    #[arg(long, value_name = "N", value_parser = whole::<usize>)]
    pub threads: Option<usize>,
    /// How progress is said on standard error.
    #[arg(long, value_enum)]
    pub progress: Option<ProgressArg>,
}

/// `status`.
#[derive(Debug, Args)]
pub struct StatusArgs {
    /// The folders; the current one by default.
    #[arg(value_name = "DIR")]
    pub folders: Vec<PathBuf>,
    /// As JSON.
    #[arg(long)]
    pub json: bool,
}

/// `init`.
#[derive(Debug, Args)]
pub struct InitArgs {
    /// The folder.
    #[arg(default_value = ".")]
    pub folder: PathBuf,
}

/// How progress is said.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ProgressArg {
    /// A bar on a terminal, nothing elsewhere.
    Bar,
    /// One JSON object a line.
    Json,
    /// Nothing.
    None,
}

impl Common {
    /// What the command line says of the settings.
    pub fn partial(&self, search: Option<&SearchArgs>) -> Partial {
        let list = |v: &Vec<String>| (!v.is_empty()).then(|| v.clone());
        let none = SearchArgs::default();
        let s = search.unwrap_or(&none);
        Partial {
            version: None,
            unit: self.unit.clone(),
            wall_layer: list(&self.wall_layer),
            query_layer: self.query_layer.clone(),
            reference_layer: self.reference_layer.clone(),
            view: self.view.clone(),
            level: self.level.map(Into::into),
            spacing: self.spacing,
            lattice_centre: self.lattice_centre,
            seed_point: (!self.seed_point.is_empty()).then(|| self.seed_point.clone()),
            backend: self.backend.map(Into::into),
            threads: self.threads,
            out: self.out.as_ref().map(|p| p.to_string_lossy().into_owned()),
            colours: self.colours.map(Into::into),
            pictures: self.no_pictures.then_some(false),
            storey: self.storey.clone(),
            over_stairs: self.over_stairs.then_some(true),
            query: self.query.clone(),
            accept_missing_eof: self.accept_missing_eof.then_some(true),
            reading: self.reading.table(),
            seed: s.seed,
            evaluations: s.evaluations,
            seconds: s.seconds,
            write_every: s.write_every,
            members: s.members,
            mode: s.mode.map(Into::into),
            method: s.method.map(Into::into),
            objective: s.objective.clone(),
            thresholds: s.thresholds.map(Into::into),
            unsure: s.unsure.map(Into::into),
            score: s.score.clone(),
            penalty: s.penalty.clone(),
            distance: s.distance,
            limit: s.limit.clone(),
            link: list(&s.link),
            snap: s.snap.clone(),
            most_moves: s.most_moves,
            only_marked: s.only_marked.then_some(true),
            allow: s.allow.clone(),
            budget: s.budget.clone(),
            brief: s.brief.clone().map(BriefText::Text),
            least_gain: s.least_gain.clone(),
            raw: s.raw.then_some(true),
            overlay: s.overlay.map(Into::into),
            until_converged: s.until_converged.then_some(true),
            together: s.together,
            ..Partial::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What a command refuses stands neither in its help nor in the manual.
    #[test]
    fn refused_options_are_not_shown() {
        let help =
            |command: &str| grammar().find_subcommand_mut(command).unwrap().render_long_help().to_string();
        for (command, option) in [
            ("watch", "--json"),
            ("check", "--out "),
            ("jobs", "--json"),
            ("jobs", "--threads"),
            ("jobs", "--write-every"),
            ("jobs", "--progress"),
        ] {
            assert!(!help(command).contains(option), "{command} {option}");
            assert!(help("run").contains(option), "run {option}");
        }
        let page = man().unwrap();
        let jobs = page.split(".SH \"ENFILADE JOBS\"").nth(1).unwrap().split("\n.SH ").next().unwrap();
        assert!(!jobs.contains(r"\-\-threads") && jobs.contains(r"\-\-embed"), "{jobs}");
        let completed = completions(ShellArg::Bash);
        let mut known = completed.lines().filter(|l| l.contains("opts=") && l.contains("--seeds"));
        assert!(known.all(|l| l.contains("--embed") && !l.contains("--threads")), "{completed}");
    }

    #[test]
    fn the_command_line_is_sound() {
        idle::hidden(Cli::command()).debug_assert();
        idle::left_out(Cli::command()).debug_assert();
    }

    #[test]
    fn shells_are_known_by_their_own_names() {
        for name in ["bash", "zsh", "fish", "elvish", "powershell", "power-shell"] {
            assert!(ShellArg::from_str(name, false).is_ok(), "{name}");
        }
    }

    #[test]
    fn a_number_out_of_range_is_a_value() {
        for (option, said) in [("--seed", "\"-1\", expected a whole number from 0"), ("--spacing", "")] {
            let parsed = grammar().try_get_matches_from(["enfilade", "run", "a.dxf", option, "-1"]);
            match parsed {
                Ok(_) => assert!(said.is_empty(), "{option} takes any number; its range is held later"),
                Err(e) => assert!(!said.is_empty() && e.to_string().contains(said), "{e}"),
            }
        }
    }

    #[test]
    fn negative_coordinates_and_scores_are_taken() {
        let cli = Cli::try_parse_from([
            "enfilade",
            "run",
            "a.dxf",
            "--lattice-centre",
            "-0.5,3",
            "--score",
            "degree +1, depth -1",
            "--seed",
            "7",
        ])
        .unwrap();
        let Command::Run(args) = cli.command else { panic!("{cli:?}") };
        let p = args.common.partial(Some(&args.search));
        assert_eq!((p.lattice_centre, p.seed), (Some([-0.5, 3.0]), Some(7)));
        assert_eq!(p.score.as_deref(), Some("degree +1, depth -1"));
    }
}

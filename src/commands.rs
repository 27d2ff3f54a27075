//! What each command does: reads files, runs the job, stores what it hands out, says how it went.

mod accepting;
mod batching;
mod beside;
mod brief;
mod installing;
mod joining;
pub mod library;
mod limits;
mod listing;
mod outputs;
mod parting;
mod telling;
mod watching;
mod works;

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError, mpsc};
use std::time::Instant;

use crate::cli::{
    AnalyseArgs, CheckArgs, Cli, Command, Common, InitArgs, ResolutionArgs, RunArgs, SearchArgs,
};
use crate::daemon::{self, Asked, Done, JobEvent, JobOutput, JobRequest, Notice, WatchSettings};
use crate::output::{self, print, say};
use crate::progress::Display;
use crate::sample_settings;
use crate::store::{self, Home, Placing, SystemDisk, led_beside, round_name};
use crate::watch::MAX_DRAWING_BYTES;
use accepting::{Accepted, Choice, accept_option};
pub use beside::settings_for;
use beside::{read_settings, settings_partial};
use enfilade_cad::drawing::Format;
use enfilade_config::{Partial, PinnedOption, PinnedWork, Settings};
use enfilade_overlay::measure::{counts_cells, numbers_apart, parts, plain_name, wording};
use enfilade_overlay::reading::{Headline, QuestionEntry};
use enfilade_overlay::result::{
    AnalysisResult, Candidate, Interval, RESULT_SCHEMA, RoundResult, StoreyEntry, to_json,
};
use enfilade_overlay::words::headline;
use enfilade_pipeline::accept::Origin;
use enfilade_pipeline::cells::{CellOptions, cells, cells_csv, edges_csv};
use enfilade_pipeline::geojson::{cells_geojson, edges_geojson};
use enfilade_pipeline::{Event, Input, Known, Outcome, resolution};
use enfilade_report::{Cancel, Error, Place, Report, Severity, complain, counted, gathered};
use limits::Clock;

/// Runs one command line. The exit code of a finished command is 0, or 1 when something was left out.
///
/// # Errors
/// What the command returns; the variant decides the exit code.
pub fn execute(cli: Cli, cancel: &Cancel) -> Result<u8, Error> {
    outputs::judge(&cli.command)?;
    let code = carry_out(cli.command, cancel)?;
    match output::fault() {
        // The word of a command that ended otherwise stands.
        Some(fault) if code <= 1 => Err(fault),
        _ => Ok(code),
    }
}

/// Whether a search runs that leaves its best so far when it is stopped.
static KEEPS_BEST: AtomicBool = AtomicBool::new(false);

/// Whether whoever stops this process should wait until the best so far is written.
pub fn keeps_best() -> bool {
    KEEPS_BEST.load(Ordering::Relaxed)
}

fn carry_out(command: Command, cancel: &Cancel) -> Result<u8, Error> {
    match command {
        Command::Check(args) => {
            timed(&args.file, &args.common, None, cancel, |clock, cancel| check(&args, clock, cancel))
        }
        Command::Analyse(args) => {
            timed(&args.file, &args.common, None, cancel, |clock, cancel| analyse(&args, clock, cancel))
        }
        Command::Works(args) => {
            timed(&args.file, &args.common, None, cancel, |clock, cancel| works::works(&args, clock, cancel))
        }
        Command::Brief(args) => {
            timed(&args.file, &args.common, None, cancel, |clock, cancel| brief::brief(&args, clock, cancel))
        }
        Command::Resolution(args) => {
            timed(&args.file, &args.common, None, cancel, |clock, cancel| resolution(&args, clock, cancel))
        }
        Command::Run(args) => {
            let seconds = args.search.seconds;
            timed(&args.file, &args.common, seconds, cancel, |clock, cancel| run(&args, clock, cancel))
        }
        Command::Watch(args) => watching::watch(&args, cancel),
        Command::JobChild { drawing, results } => watching::job_child(&drawing, &results),
        Command::Accept(args) => accepting::accept(&args),
        Command::Jobs(args) => batching::jobs(&args),
        Command::RunJob(args) => batching::run_job(&args, cancel),
        Command::Parts(args) => parting::parts(&args),
        Command::Merge(args) => parting::merge(&args, cancel),
        Command::Join(args) => joining::join(&args),
        Command::Status(args) => watching::status(&args),
        Command::Open(args) => installing::open(&args),
        Command::Service(args) => installing::service(&args),
        Command::Doctor { card: true, .. } => installing::card_alone(),
        Command::Doctor { folders, .. } => installing::doctor(&folders),
        Command::Completions { shell } => installing::completions(shell),
        Command::Man => installing::man(),
        Command::Init(args) => init(&args),
    }
}

/// A command on one drawing, within its limits of time.
fn timed(
    file: &Path,
    common: &Common,
    seconds: Option<f64>,
    cancel: &Cancel,
    command: impl FnOnce(&Clock, &Cancel) -> Result<u8, Error>,
) -> Result<u8, Error> {
    let clock = Clock::start(file, common, seconds)?;
    clock.judge(command(&clock, &clock.within(cancel)))
}

fn check(args: &CheckArgs, clock: &Clock, cancel: &Cancel) -> Result<u8, Error> {
    let (path, bytes) = open(&args.file)?;
    let settings = settings_for(&args.file, args.common.partial(None))?.0;
    let extras = enfilade_pipeline::Extras { picture: args.preview.is_some(), graph: args.graph.is_some() };
    let outcome = enfilade_pipeline::check_with(&Input::new(&path, &bytes, 1), &settings, extras)?;
    cancel.check()?;
    clock.is_read();
    let result = &outcome.result;
    let graph =
        args.graph.as_ref().and_then(|to| to.extension()).is_some_and(|e| e.eq_ignore_ascii_case("json"));
    let graph = if graph { "graph.json" } else { "graph.graphml" };
    for (to, name) in [(&args.preview, "check.png"), (&args.graph, graph)] {
        if let (Some(to), Some(made)) = (to, outcome.files.iter().find(|f| f.path.as_os_str() == name)) {
            write(to, &made.bytes)?;
        }
    }
    if hand_json(&args.common, result)? {
        return Ok(exit_code(&outcome.report));
    }
    if !args.common.quiet {
        let solid = if result.solids == 1 { "1 solid".into() } else { format!("{} solid", result.solids) };
        let is_building = result.format != Format::Dxf.name();
        let walls =
            if is_building { wall_pieces(result.walls) } else { counted(result.walls, "wall element") };
        let entities = if is_building { "elements" } else { "entities" };
        if let Some(reading) = &result.reading {
            let is_drawn = result.regions.iter().any(|r| r.kind == "query");
            let headline = reading.headline();
            let coverage = headline.coverage.filter(|_| !is_drawn);
            say(&Headline { coverage, ..headline }.words());
            ask(&reading.questions);
        }
        say(&format!("{}: {}, {walls} ({solid})", result.file, result.version));
        say(&format!("unit: {}", result.unit.reason));
        result.statements.iter().for_each(|s| say(s));
        for layer in &result.layers {
            say(&format!(
                "layer {:<24} {:>6} {entities}  {}: {}",
                layer.name, layer.entities, layer.taken_as, layer.reason
            ));
        }
        for m in &result.moves {
            let kind = format!("{:?}", m.kind).to_lowercase();
            say(&format!("move {}: {kind} {} … {} {}", m.name, tidy(m.lower), tidy(m.upper), m.unit));
        }
        if let Some(reading) = &result.reading {
            let rooms = reading.rooms.iter().enumerate();
            rooms.for_each(|(k, room)| say(&format!("room {}", room.words(k + 1))));
            ask(&reading.room_questions);
        }
        result.storeys.iter().for_each(|s| say(&storey_line(s)));
        for r in result.regions.iter().filter(|r| r.kind != "move") {
            let pair = r.pair.as_ref().map_or_else(String::new, |name| format!(" {name}"));
            say(&format!("region of {}{pair}: {:.1} m²", r.kind, r.area_m2));
        }
    }
    tell(&args.common, &outcome.report);
    Ok(exit_code(&outcome.report))
}

/// A bound without the noise of changing frames.
fn tidy(bound: f64) -> f64 {
    (bound * 1e6).round() / 1e6 + 0.0
}

/// `visibility 42.1 m² (41.5 to 42.7)`.
fn estimate_words(result: &AnalysisResult, key: &str, of: &Interval) -> String {
    let cell = if counts_cells(key) { result.spacing_m * result.spacing_m } else { 1.0 };
    let unit = wording(parts(key).0).map_or("", |w| w.bare_unit());
    let [value, low, high] = numbers_apart([of.value, of.low, of.high].map(|v| v * cell));
    format!("{} {value} {unit} ({low} to {high})", plain_name(key).to_lowercase())
}

fn analyse(args: &AnalyseArgs, clock: &Clock, cancel: &Cancel) -> Result<u8, Error> {
    let (path, bytes) = open(&args.file)?;
    let (settings, out) = settings_for(&args.file, args.common.partial(None))?;
    analysed(args, Input::new(&path, &bytes, 1), (settings, out), None, (clock, cancel))
}

/// The analysis of a drawing; tables and pictures of cells take what is `known` from parts. Aims that need more than trees
/// are measured again.
fn analysed(
    args: &AnalyseArgs,
    input: Input<'_>,
    (settings, out): (Settings, Option<PathBuf>),
    known: Option<&Known>,
    (clock, cancel): (&Clock, &Cancel),
) -> Result<u8, Error> {
    let placing = Placing { out_dir: out.as_deref().map(named_folder), fallback_dir: None };
    let home = Home::open(Arc::new(SystemDisk), &led_beside(&absolute(&args.file)), &placing)?;
    let tables_said =
        [&args.tables.cells, &args.tables.edges].into_iter().flatten().any(|to| is_standard_output(to));
    let is_told = args.common.json.is_some() || !args.common.quiet && !tables_said;
    let depth = enfilade_pipeline::Depth { roots: roots_of(args), intervals: is_told, known };
    let (mut outcome, study) = enfilade_pipeline::on_threads(&settings, || {
        enfilade_pipeline::analyse_with(&input, &settings, depth, &mut || clock.is_read(), cancel)
    })?;
    let wants_pictures = !args.measures.is_empty() || !args.tables.step_from.is_empty();
    let mut tables = Vec::new();
    if args.tables.cells.is_some() || wants_pictures {
        let measured = enfilade_pipeline::on_threads(&settings, || {
            enfilade_pipeline::cells::measure_cells(&study, &cell_options(args, &settings))
        })?;
        if wants_pictures {
            enfilade_pipeline::add_columns(&input, &settings, (&study, &measured), &mut outcome)?;
        }
        if let Some(to) = &args.tables.cells {
            let cells = cells(&study, measured.columns);
            let write = if outputs::is_geojson(to) { cells_geojson } else { cells_csv };
            let table = write(&study, &cells);
            tables.push((to, table));
        }
    }
    if let Some(to) = &args.tables.edges {
        let is_geojson = outputs::is_geojson(to);
        tables.push((to, if is_geojson { edges_geojson(&study) } else { edges_csv(&study) }));
    }
    cancel.check()?;
    let folder = home.publish_analysis(&outcome.files)?;
    // Not before: they may be meant for that folder, which has just taken the place of another.
    for (to, table) in &tables {
        if is_standard_output(to) {
            print(table);
        } else {
            write(to, table.as_bytes())?;
        }
    }
    let is_quiet = args.common.quiet || tables_said;
    if !hand_json(&args.common, &outcome.result)? && !is_quiet {
        let r = &outcome.result;
        let mean = |key| r.mean.get(key).unwrap_or(f64::NAN);
        let vertices = if r.counts.vertices == 1 { "vertex" } else { "vertices" };
        say(&format!(
            "{} {vertices}, spacing {} m: visibility {:.2} cells, depth {:.3} steps, entropy {:.4} bits",
            r.counts.vertices,
            r.spacing_m,
            mean("degree"),
            mean("depth"),
            mean("entropy")
        ));
        if !r.estimate.is_empty() {
            let told: Vec<String> = r.estimate.iter().map(|(key, of)| estimate_words(r, key, of)).collect();
            say(&format!("beyond this lattice (95 %): {}", told.join(", ")));
        }
        if let Some(roots) = r.estimated_from_roots {
            let off = |key| r.mean_ci95.get(key).unwrap_or(f64::NAN);
            say(&format!(
                "depth and entropy estimated from {}: ± {:.3} steps, ± {:.4} bits (95 %)",
                counted(roots, "root"),
                off("depth"),
                off("entropy")
            ));
        }
        r.storeys.iter().for_each(|s| say(&storey_line(s)));
        let name = if settings.pictures { "heat maps" } else { "numbers" };
        say(&format!("{name}: {}", folder.display()));
    }
    tell(&args.common, &outcome.report);
    Ok(exit_code(&outcome.report))
}

/// What `walls` of a building counts: a wall with a door at the cut is two of them.
fn wall_pieces(count: u64) -> String {
    if count == 1 {
        "1 piece of wall at the cut".into()
    } else {
        format!("{count} pieces of walls at the cut")
    }
}

/// One storey of a building with several, in a line.
fn storey_line(s: &StoreyEntry) -> String {
    let building = s.building.as_ref().map_or_else(String::new, |b| format!(" of {b:?}"));
    let name = format!("storey {:?}{building} at {:.2} m", s.name, s.floor_m);
    if let Some(problem) = &s.problem {
        return format!("{name}: {problem}");
    }
    let mean = |key| s.mean.get(key).unwrap_or(f64::NAN);
    let means = format!(
        ": visibility {:.2} cells, depth {:.3} steps, entropy {:.4} bits",
        mean("degree"),
        mean("depth"),
        mean("entropy")
    );
    let means = if s.mean.0.is_empty() { "" } else { &means };
    let openings = counted(s.openings, if s.openings == 1 { "door or window" } else { "doors and window" });
    format!("{name}, {}, {openings}{means}", wall_pieces(s.walls))
}

fn roots_of(args: &AnalyseArgs) -> Option<usize> {
    args.roots.map(|n| usize::try_from(n).unwrap_or(usize::MAX))
}

fn cell_options(args: &AnalyseArgs, settings: &Settings) -> CellOptions {
    CellOptions {
        measures: args.measures.iter().map(|m| m.trim().to_string()).filter(|m| !m.is_empty()).collect(),
        radius: args.radius,
        roots: roots_of(args),
        step_from: args.tables.step_from.clone(),
        seed: settings.seed,
    }
}

fn resolution(args: &ResolutionArgs, clock: &Clock, cancel: &Cancel) -> Result<u8, Error> {
    let out_of = |what: &'static str, found: String, expected: &str| {
        let text = format!("--{what}: found {found}, expected {expected}; nothing was done");
        Err(Error::usage(what, Place::default(), text))
    };
    if let Some(s) = args.spacings.iter().find(|s| !(s.is_finite() && **s > 0.0)) {
        return out_of("spacings", s.to_string(), "metres above 0");
    }
    if !(args.tolerance > 0.0 && args.tolerance < 1.0) {
        return out_of("tolerance", args.tolerance.to_string(), "a number between 0 and 1");
    }
    let (path, bytes) = open(&args.file)?;
    let search = SearchArgs { seed: args.seed, ..SearchArgs::default() };
    let (settings, out) = settings_for(&args.file, args.common.partial(Some(&search)))?;
    let placing = Placing { out_dir: out.as_deref().map(named_folder), fallback_dir: None };
    let home = Home::open(Arc::new(SystemDisk), &led_beside(&absolute(&args.file)), &placing)?;
    let input = Input::new(&path, &bytes, 1);
    let options = resolution::Options {
        spacings_m: args.spacings.clone(),
        tolerance: args.tolerance,
        samples: args.samples,
    };
    let mut display = Display::new(args.common.progress, args.common.quiet);
    let mut show = |event: Event| {
        if let Event::Progress(p) = event {
            clock.is_read();
            display.show(&p);
        }
    };
    let outcome = enfilade_pipeline::on_threads(&settings, || {
        resolution::resolution(&input, &settings, &options, &mut show, cancel)
    });
    display.finish();
    let outcome = outcome?;
    let folder = home.publish_resolution(&outcome.files)?;
    if !hand_json(&args.common, &outcome.result)? && !args.common.quiet {
        tell_resolution(&outcome.result, &folder);
    }
    tell(&args.common, &outcome.report);
    Ok(exit_code(&outcome.report))
}

fn tell_resolution(result: &resolution::ResolutionResult, folder: &Path) {
    resolution::words(result).iter().for_each(|line| say(line));
    say(&format!("plot and table: {}", folder.display()));
}

fn run(args: &RunArgs, clock: &Clock, cancel: &Cancel) -> Result<u8, Error> {
    let mut partial = args.common.partial(Some(&args.search));
    let asked = Asked { pin: args.pin.clone(), like: args.like, ..Asked::default() };
    if args.so_far && asked == Asked::default() {
        let text = "--so-far says where --pin and --like count their options; without them a run begins anew; nothing was done";
        return Err(Error::usage("so-far", Place::default(), text));
    }
    if asked != Asked::default() {
        let which = if args.so_far { Which::SoFar(None) } else { Which::Newest };
        hold(&mut partial, &results_of(&args.file, args.common.out.clone())?, &asked, which)?;
    }
    let (settings, out) = settings_for(&args.file, partial)?;
    let mut display = Display::new(args.common.progress, args.common.quiet);
    let mut show = |notice: Notice| match notice {
        Notice::Progress { value, .. } => {
            if value["stage"] != "read" {
                clock.is_read();
            }
            if value["stage"].as_str().is_some_and(|stage| stage.starts_with("optimise")) {
                KEEPS_BEST.store(true, Ordering::Relaxed);
            }
            if let Some(folder) = value["folder"].as_str().filter(|_| cancel.is_stopped()) {
                complain(format_args!("the best so far: {folder}"));
            }
            if let Ok(p) = serde_json::from_value(value) {
                display.show(&p);
            }
        }
        Notice::Problem { problem, .. } => complain(format_args!("warning: {problem}")),
        _ => {}
    };
    let made = one_round(&args.file, settings, out, &mut show, cancel);
    display.finish();
    let (done, finished) = made?;
    if let Some((result, report)) = finished {
        let is_json = hand_json(&args.common, &result)?;
        if !is_json && !args.common.quiet {
            telling::summary(&result, args, &done.folder);
        }
        let (shown, left) = telling::shown(&report, args.verbose || is_json, !result.candidates.is_empty());
        tell(&args.common, &shown);
        if left > 0 && !args.common.quiet {
            complain(format_args!("{}: --verbose shows them", counted(left as u64, "more note")));
        }
    }
    Ok(u8::from(done.is_degraded))
}

/// The next round of a drawing, published in its result folder below `out`, or beside it.
fn one_round(
    file: &Path,
    settings: Settings,
    out: Option<PathBuf>,
    show: &mut dyn FnMut(Notice),
    cancel: &Cancel,
) -> Result<(Done, Option<(RoundResult, Report)>), Error> {
    let watch = WatchSettings { out_dir: out.as_deref().map(named_folder), ..WatchSettings::default() };
    let finished: Arc<Mutex<Option<(RoundResult, Report)>>> = Arc::default();
    let keep = Arc::clone(&finished);
    let shown = file.to_string_lossy().into_owned();
    let job = move |request: &JobRequest, tell: &mut dyn FnMut(JobEvent), cancel: &Cancel| {
        let outcome = round(&shown, request, &settings, tell, cancel)?;
        let output = output_of(&outcome);
        *keep.lock().unwrap_or_else(PoisonError::into_inner) = Some((outcome.result, outcome.report));
        Ok(output)
    };
    let done = daemon::run_once(file, &watch, &job, show, cancel)?;
    let finished = finished.lock().unwrap_or_else(PoisonError::into_inner).take();
    Ok((done, finished))
}

/// Puts the options that a round is to keep, or to find more of, into its settings.
fn hold(partial: &mut Partial, results: &Path, asked: &Asked, which: Which) -> Result<(), Error> {
    if asked.pin.is_empty() && asked.like.is_none() {
        return Ok(());
    }
    let which = match asked {
        Asked { so_far: Some(n), .. } => Which::SoFar(Some(*n)),
        Asked { round: Some(n), .. } => Which::Round(*n),
        _ if which == Which::Newest => newest_with_options(results).map_or(which, Which::Round),
        _ => which,
    };
    let (origin, result) = round_result(results, which)?;
    let once = asked.pin.iter().enumerate().filter(|(i, n)| !asked.pin[..*i].contains(n));
    let pinned: Vec<&Candidate> =
        once.map(|(_, n)| option_of(&result, origin, *n)).collect::<Result<_, _>>()?;
    let (building, moving): (Vec<&Candidate>, Vec<&Candidate>) =
        pinned.into_iter().partition(|c| !c.works.is_empty());
    partial.pin_options = building.into_iter().map(pinned_option).collect();
    partial.pin =
        Some(moving.into_iter().map(|c| c.parameters.clone()).collect()).filter(|p: &Vec<_>| !p.is_empty());
    let of = |n: &usize| layout_of(&result, origin, *n);
    partial.like = asked.like.as_ref().map(of).transpose()?;
    partial.pin_moves = enfilade_pipeline::moves_of(&result.moves);
    Ok(())
}

/// The newest round that has options: one that found none leaves those of before to be named.
fn newest_with_options(results: &Path) -> Option<u32> {
    let has_options = |n: &u32| {
        round_result(results, Which::Round(*n)).is_ok_and(|(_, result)| !result.candidates.is_empty())
    };
    store::finished_rounds(results).into_iter().rev().find(has_options)
}

/// One round of a drawing, on the threads of the settings; what it says goes to `tell` on this thread.
fn round(
    shown: &str,
    request: &JobRequest,
    settings: &Settings,
    tell: &mut dyn FnMut(JobEvent),
    cancel: &Cancel,
) -> Result<Outcome<RoundResult>, Error> {
    let started = Instant::now();
    let (say, heard) = mpsc::channel();
    std::thread::scope(|scope| {
        let worker = scope.spawn(move || {
            enfilade_pipeline::on_threads(settings, || {
                let input = Input::new(shown, &request.bytes, u64::from(request.round));
                let input = input.going_on_from(&request.earlier);
                // Nobody hears any more once the job was given up.
                let mut show = |event: Event| drop(say.send(event));
                enfilade_pipeline::run(&input, settings, started, &mut show, cancel)
            })
        });
        for event in heard {
            tell(match event {
                Event::Progress(p) => JobEvent::Progress(serde_json::to_value(p).unwrap_or_default()),
                Event::Analysis(files) => JobEvent::Analysis(files),
                Event::SoFar { files, progress } => {
                    JobEvent::SoFar { files, progress: serde_json::to_value(progress).unwrap_or_default() }
                }
                Event::Keep(k) => JobEvent::Keep { bytes: k.bytes, is_anew: k.is_anew },
            });
        }
        worker.join().unwrap_or_else(|payload| std::panic::resume_unwind(payload))
    })
}

fn options_of(result: &RoundResult) -> String {
    counted(result.candidates.len() as u64, "option")
}

fn output_of(outcome: &Outcome<RoundResult>) -> JobOutput {
    let r = &outcome.result;
    let options = options_of(r);
    let summary = match r.candidates.first() {
        Some(first) => format!("{options}; the first: {}", headline(&first.words, &first.explanation)),
        None if !r.questions.is_empty() => format!("{options}; {}", asked(&r.questions)),
        None => format!("{options}; {}", r.stopped_by),
    };
    JobOutput { files: outcome.files.clone(), is_degraded: outcome.report.is_degraded(), summary }
}

/// What a person should decide, in one line.
fn asked(questions: &[QuestionEntry]) -> String {
    questions.iter().map(|q| q.text.as_str()).collect::<Vec<_>>().join(" ")
}

/// Questions with their answers and the option that gives each.
fn ask(questions: &[QuestionEntry]) {
    for q in questions {
        say(&format!("question: {}", q.text));
        q.answers.iter().for_each(|a| say(&format!("  {} ({})", a.text, a.option)));
    }
}

/// The result folder of a drawing, wherever the settings have put it.
fn results_of(file: &Path, out: Option<PathBuf>) -> Result<PathBuf, Error> {
    let said = settings_partial(file, Partial::default())?;
    let fallback_dir = said.watch.and_then(|w| w.fallback).map(PathBuf::from);
    let out_dir = out.or(said.out.map(PathBuf::from)).as_deref().map(named_folder);
    let placing = Placing { out_dir, fallback_dir: fallback_dir.as_deref().map(named_folder) };
    store::present_folder(&led_beside(&absolute(file)), &placing).ok_or_else(|| {
        let place = Place::file(file.to_string_lossy());
        Error::usage("no-round", place, "no round yet; `enfilade run` makes one")
    })
}

/// Which of the results of a drawing are meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Which {
    /// The newest round; where there is none, what a search has found so far.
    Newest,
    Round(u32),
    /// What a search that goes on, or was stopped, has found so far; after so many evaluations, where that is said.
    SoFar(Option<u64>),
}

/// A result in a result folder.
fn round_result(folder: &Path, which: Which) -> Result<(Origin, RoundResult), Error> {
    let last = store::finished_rounds(folder).last().copied();
    let has_so_far = || folder.join(store::SO_FAR).join("result.json").is_file();
    let next = last.map_or(1, |n| n.saturating_add(1));
    let (origin, name) = match (which, last) {
        (Which::Round(n), _) | (Which::Newest, Some(n)) => {
            (Origin { round: n, is_so_far: false }, round_name(n))
        }
        (Which::SoFar(_) | Which::Newest, _) if has_so_far() => {
            (Origin { round: next, is_so_far: true }, store::SO_FAR.to_owned())
        }
        (Which::Newest | Which::SoFar(_), _) => {
            let text = match which {
                Which::SoFar(_) => {
                    "nothing is kept of a stopped search; `enfilade run --write-every 10` keeps the best so far"
                }
                _ => "no round yet; `enfilade run` makes one",
            };
            return Err(Error::usage("no-round", Place::file(folder.to_string_lossy()), text));
        }
    };
    let set = folder.join(name);
    if std::fs::symlink_metadata(&set).is_ok_and(|found| found.is_symlink()) {
        let text = format!("is a link, so there is no {origin}; nothing was written");
        return Err(Error::usage("no-round", Place::file(set.to_string_lossy()), text));
    }
    let at = set.join("result.json");
    let place = || Place::file(at.to_string_lossy());
    let json = store::read_own(&at).map_err(|e| {
        Error::usage(
            "no-round",
            place(),
            match e.kind() {
                std::io::ErrorKind::NotFound => format!("there is no {origin}; nothing was written"),
                _ => format!("{e}; expected the result of {origin}; nothing was written"),
            },
        )
    })?;
    let result: RoundResult = serde_json::from_slice(&json)
        .map_err(|e| Error::input("result", place(), format!("{e}; nothing was written")))?;
    if result.schema != RESULT_SCHEMA {
        let text =
            format!("found schema {:?}, expected {RESULT_SCHEMA:?}; nothing was written", result.schema);
        return Err(Error::input("result", place(), text));
    }
    if let Which::SoFar(Some(seen)) = which
        && seen != result.evaluations
    {
        let text = format!(
            "the best so far is another by now, of {}, expected that of {seen}; look at it again; nothing was done",
            counted(result.evaluations, "layout")
        );
        return Err(Error::usage("so-far", place(), text));
    }
    Ok((origin, result))
}

/// An option of a round, from 1.
fn option_of(result: &RoundResult, origin: Origin, number: usize) -> Result<&Candidate, Error> {
    let found = number.checked_sub(1).and_then(|i| result.candidates.get(i));
    found.ok_or_else(|| {
        let has = match result.candidates.len() {
            0 => "no options".into(),
            _ => options_of(result),
        };
        let text = format!("{origin} has {has}, found number {number}; nothing was done");
        Error::usage("candidate", Place::default(), text)
    })
}

/// An option that builds, as the next round finds it again.
fn pinned_option(option: &Candidate) -> PinnedOption {
    let works = option.works.iter().map(|w| PinnedWork { kind: w.kind.clone(), stretch: w.stretch });
    PinnedOption { parameters: option.parameters.clone(), works: works.collect() }
}

/// Parameters of an option near which others are found: one that moves alone.
fn layout_of(result: &RoundResult, origin: Origin, number: usize) -> Result<Vec<f64>, Error> {
    let option = option_of(result, origin, number)?;
    if option.works.is_empty() {
        return Ok(option.parameters.clone());
    }
    let text = format!(
        "option {number} of {origin} has building works, and only what moves alone is searched near; nothing was done; leave \
         it out of --like (`like` in the side-car), and keep it with --pin"
    );
    Err(Error::usage("works-option", Place::default(), text))
}

fn init(args: &InitArgs) -> Result<u8, Error> {
    let to = args.folder.join("enfilade.toml");
    store::write_new(&SystemDisk, &led_beside(&to), sample_settings::TEXT.as_bytes())?;
    say(&format!("{} written; every line in it is a comment until you change it", to.display()));
    Ok(0)
}

/// Reads a drawing; the path comes back as it is shown.
fn open(file: &Path) -> Result<(String, Vec<u8>), Error> {
    let shown = file.to_string_lossy().into_owned();
    let place = || Place::file(shown.clone());
    let unreadable = |e: std::io::Error| match e.kind() {
        std::io::ErrorKind::NotFound => {
            Error::input("no-such-file", place(), "there is no such file; nothing was done")
        }
        _ => Error::environment("unreadable", place(), format!("{e}; nothing was done")),
    };
    let found = std::fs::metadata(file).map_err(unreadable)?;
    // Whoever opens a pipe waits for its other end.
    if !found.is_file() {
        let text = "found a folder, a pipe or a device, expected a file; nothing was done";
        return Err(Error::input("no-file", place(), text));
    }
    if found.len() > MAX_DRAWING_BYTES {
        let text = format!(
            "found a file of {} MB, expected at most {} MB; nothing was done",
            found.len() >> 20,
            MAX_DRAWING_BYTES >> 20
        );
        return Err(Error::input("too-large", place(), text));
    }
    Ok((shown.clone(), std::fs::read(file).map_err(unreadable)?))
}

fn write(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    store::replace_file(&SystemDisk, &led_beside(&absolute(path)), bytes)
}

/// Where a folder lies that the user names, or the settings.
fn named_folder(folder: &Path) -> PathBuf {
    store::led_to(&absolute(folder))
}

fn absolute(path: &Path) -> PathBuf {
    std::path::absolute(path).unwrap_or_else(|_| path.into())
}

fn is_standard_output(path: &Path) -> bool {
    path.as_os_str() == "-"
}

fn hand_json<T: serde::Serialize>(common: &Common, result: &T) -> Result<bool, Error> {
    match &common.json {
        None => Ok(false),
        Some(to) if is_standard_output(to) => {
            print(&to_json(result)?);
            Ok(true)
        }
        Some(to) => {
            write(to, to_json(result)?.as_bytes())?;
            Ok(false)
        }
    }
}

fn tell(common: &Common, report: &Report) {
    if common.quiet {
        return;
    }
    for (p, others) in gathered(&report.problems, |p| (p.code, p.severity, &p.text)) {
        let word = match p.severity {
            Severity::Info => "note",
            Severity::Warning => "warning",
            Severity::Error => "error",
        };
        complain(format_args!("{word}: {p}"));
        if !others.is_empty() {
            complain(format_args!(
                "{word}: {}: {} more like the last; --json names each",
                p.place.file,
                others.len()
            ));
        }
    }
}

fn exit_code(report: &Report) -> u8 {
    u8::from(report.is_degraded())
}

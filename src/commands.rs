//! What each command does: reads files, runs the job, stores what it hands out, says how it went.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

use crate::cli::{AcceptArgs, AnalyseArgs, CheckArgs, Cli, Command, Common, InitArgs, RunArgs};
use crate::config::{Partial, Settings};
use crate::overlay::result::{RoundResult, to_json};
use crate::pipeline::{self, Event, Input};
use crate::progress::Display;
use crate::report::{Cancel, Error, Place, Report, Severity};
use crate::sample_settings;
use crate::store::{self, Results};

/// Runs one command line. The number is the exit code of a finished command: 0, or 1 when something was
/// left out.
///
/// # Errors
/// What the command returns; the variant decides the exit code.
pub fn execute(cli: Cli, cancel: &Cancel) -> Result<u8, Error> {
    match cli.command {
        Command::Check(args) => check(&args),
        Command::Analyse(args) => analyse(&args, cancel),
        Command::Run(args) => run(&args, cancel),
        Command::Accept(args) => accept(&args),
        Command::Doctor => doctor(),
        Command::Init(args) => init(&args),
    }
}

fn check(args: &CheckArgs) -> Result<u8, Error> {
    let (path, bytes) = open(&args.file)?;
    let settings = settings_for(&args.file, args.common.partial(None))?.0;
    let outcome = pipeline::check(&Input::new(&path, &bytes, 1), &settings)?;
    let result = &outcome.result;
    if let (Some(to), Some(png)) =
        (&args.preview, outcome.files.iter().find(|f| f.path.as_os_str() == "check.png"))
    {
        store::write_file(to, &png.bytes)?;
    }
    if hand_json(&args.common, result)? {
        return Ok(exit_code(&outcome.report));
    }
    if !args.common.quiet {
        let solid = if result.columns == 1 { "1 solid".into() } else { format!("{} solid", result.columns) };
        say(&format!("{}: {}, {} wall elements ({solid})", result.file, result.version, result.walls));
        say(&format!("unit: {}", result.unit.reason));
        for layer in &result.layers {
            say(&format!(
                "layer {:<24} {:>6} entities  {}: {}",
                layer.name, layer.entities, layer.taken_as, layer.reason
            ));
        }
        for m in &result.moves {
            let kind = format!("{:?}", m.kind).to_lowercase();
            say(&format!("move {}: {kind} {} … {} {}", m.name, m.lower, m.upper, m.unit));
        }
        for r in result.regions.iter().filter(|r| r.kind != "move") {
            say(&format!("region of {}: {:.1} m²", r.kind, r.area_m2));
        }
    }
    tell(&args.common, &outcome.report);
    Ok(exit_code(&outcome.report))
}

fn analyse(args: &AnalyseArgs, cancel: &Cancel) -> Result<u8, Error> {
    let (path, bytes) = open(&args.file)?;
    let (settings, out) = settings_for(&args.file, args.common.partial(None))?;
    let results = Results::of(&args.file, out.as_deref())?;
    let input = Input::new(&path, &bytes, 1);
    let (outcome, study) = pipeline::on_threads(&settings, || pipeline::analyse(&input, &settings, cancel))?;
    if let Some(to) = &args.cells {
        store::write_file(to, pipeline::cells::cells_csv(&study, args.radius).as_bytes())?;
    }
    if let Some(to) = &args.edges {
        store::write_file(to, pipeline::cells::edges_csv(&study).as_bytes())?;
    }
    cancel.check()?;
    let folder = results.publish_analysis(&outcome.files)?;
    if !hand_json(&args.common, &outcome.result)? && !args.common.quiet {
        let r = &outcome.result;
        let mean = |key| r.mean.get(key).unwrap_or(f64::NAN);
        say(&format!(
            "{} vertices, spacing {} m: visibility {:.2} cells, depth {:.3} steps, entropy {:.4} bits",
            r.counts.vertices,
            r.spacing_m,
            mean("degree"),
            mean("depth"),
            mean("entropy")
        ));
        say(&format!("heat maps: {}", folder.display()));
    }
    tell(&args.common, &outcome.report);
    Ok(exit_code(&outcome.report))
}

fn run(args: &RunArgs, cancel: &Cancel) -> Result<u8, Error> {
    let started = Instant::now();
    let (path, bytes) = open(&args.file)?;
    let (settings, out) = settings_for(&args.file, args.common.partial(Some(&args.search)))?;
    let results = Results::of(&args.file, out.as_deref())?;
    let input = Input::new(&path, &bytes, u64::from(results.next_round()?));
    let mut display = Display::new(args.common.progress, args.common.quiet);
    let mut early = Ok(());
    let outcome = pipeline::on_threads(&settings, || {
        let mut show = |event: Event| match event {
            Event::Progress(p) => display.show(&p),
            Event::Analysis(files) => early = results.publish_analysis(&files).map(|_| ()),
        };
        pipeline::run(&input, &settings, started, &mut show, cancel)
    });
    display.finish();
    let outcome = outcome?;
    early?;
    cancel.check()?;
    let folder = results.publish_round(&outcome.files)?;
    if !hand_json(&args.common, &outcome.result)? && !args.common.quiet {
        summary(&outcome.result, &folder);
    }
    tell(&args.common, &outcome.report);
    Ok(exit_code(&outcome.report))
}

fn summary(result: &RoundResult, folder: &Path) {
    for (i, c) in result.candidates.iter().enumerate() {
        let mark = if c.within_threshold { "" } else { " (below a threshold)" };
        say(&format!("option {}{mark}: {}", i + 1, c.words));
    }
    say(&format!(
        "{} layouts measured in {:.1} s, stopped by {}; {} options",
        result.evaluations,
        result.seconds,
        result.stopped_by,
        result.candidates.len()
    ));
    say(&format!("compare them: {}", folder.join("report.html").display()));
}

fn accept(args: &AcceptArgs) -> Result<u8, Error> {
    let (path, bytes) = open(&args.file)?;
    let out = settings_partial(&args.file, Partial::default())?.out.map(PathBuf::from);
    let results = Results::of(&args.file, args.out.as_deref().or(out.as_deref()))?;
    let (round, json) = results.read_round(args.round)?;
    let result: RoundResult = serde_json::from_slice(&json).map_err(|e| {
        let place = Place::file(format!("round-{round:02}/result.json"));
        Error::input("result", place, format!("{e}; nothing was written"))
    })?;
    let accepted = pipeline::accept::accept(&Input::new(&path, &bytes, 1), &result, round, args.number)?;
    let (drawing, side_car) =
        store::write_accepted(&args.file, &accepted.drawing, accepted.side_car.as_bytes())?;
    say(&format!("option {} of round {round} is now {}", args.number, drawing.display()));
    say(&format!("its moves, bounds and settings for the next round: {}", side_car.display()));
    Ok(0)
}

fn doctor() -> Result<u8, Error> {
    say(&format!("enfilade {}", env!("CARGO_PKG_VERSION")));
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    say(&format!("cores: {cores}"));
    say("graphics card: not used by this version; all measures run on the cores");
    Ok(0)
}

fn init(args: &InitArgs) -> Result<u8, Error> {
    let to = args.folder.join("enfilade.toml");
    store::write_new(&to, sample_settings::TEXT.as_bytes())?;
    say(&format!("{} written; every line in it is a comment until you change it", to.display()));
    Ok(0)
}

/// Reads a drawing; the path comes back as it is shown.
fn open(file: &Path) -> Result<(String, Vec<u8>), Error> {
    let shown = file.to_string_lossy().into_owned();
    let bytes = std::fs::read(file).map_err(|e| {
        let place = Place::file(shown.clone());
        match e.kind() {
            std::io::ErrorKind::NotFound => {
                Error::usage("not-found", place, "no such file; nothing was done")
            }
            _ => Error::environment("unreadable", place, format!("{e}; nothing was done")),
        }
    })?;
    Ok((shown, bytes))
}

/// Settings of a drawing: the command line, its side-car, its folder's file, the defaults; and where the
/// results go.
///
/// # Errors
/// [`Error::Usage`] with the place of what is wrong.
pub fn settings_for(drawing: &Path, command_line: Partial) -> Result<(Settings, Option<PathBuf>), Error> {
    let partial = settings_partial(drawing, command_line)?;
    let out = partial.out.clone().map(PathBuf::from);
    Ok((Settings::new(partial)?, out))
}

fn settings_partial(drawing: &Path, command_line: Partial) -> Result<Partial, Error> {
    let mut out = command_line;
    for file in settings_files(drawing) {
        match std::fs::read_to_string(&file) {
            Ok(text) => out = out.over(Partial::from_toml(&file.to_string_lossy(), &text)?),
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => {}
            Err(e) => {
                let place = Place::file(file.to_string_lossy());
                return Err(Error::environment(
                    "settings-unreadable",
                    place,
                    format!("{e}; nothing was done"),
                ));
            }
        }
    }
    Ok(out)
}

/// Files that may hold settings of a drawing, the nearest first.
pub fn settings_files(drawing: &Path) -> [PathBuf; 2] {
    [drawing.with_extension("enfilade.toml"), drawing.with_file_name("enfilade.toml")]
}

fn hand_json<T: serde::Serialize>(common: &Common, result: &T) -> Result<bool, Error> {
    match &common.json {
        None => Ok(false),
        Some(to) if to.as_os_str() == "-" => {
            print(&to_json(result)?);
            Ok(true)
        }
        Some(to) => {
            store::write_file(to, to_json(result)?.as_bytes())?;
            Ok(false)
        }
    }
}

fn tell(common: &Common, report: &Report) {
    if common.quiet {
        return;
    }
    for p in &report.problems {
        let word = match p.severity {
            Severity::Info => "note",
            Severity::Warning => "warning",
            Severity::Error => "error",
        };
        eprintln!("{word}: {p}");
    }
}

fn exit_code(report: &Report) -> u8 {
    u8::from(report.is_degraded())
}

fn say(line: &str) {
    print(&format!("{}\n", line.trim_end_matches('\n')));
}

/// Standard output may be a closed pipe: that is no reason to fail.
fn print(text: &str) {
    let _ = std::io::stdout().lock().write_all(text.as_bytes());
}

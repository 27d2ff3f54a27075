//! `parts` and `merge`: one large analysis on many machines. `run-job` does each part.

use std::path::PathBuf;

use super::limits::Clock;
use super::listing::{ListedJob, TRY_AGAIN, hand_lines, is_drawing, jobs_in, numbers};
use super::{absolute, analysed, open, outputs, settings_partial};
use crate::batch::{FinishedPart, Job, PartOf};
use crate::cli::{AnalyseArgs, Command, Common, MergeArgs, PartsArgs};
use crate::worked::Work;
use enfilade_config::{Backend, Partial, Settings};
use enfilade_pipeline::{Input, Known, parts as pipeline_parts};
use enfilade_report::{Cancel, Error, Place, complain};

/// Where parts go if nothing is said.
const OUT: &str = "enfilade-parts";

pub(super) fn parts(args: &PartsArgs) -> Result<u8, Error> {
    let (shown, bytes) = open(&args.file)?;
    is_drawing(&args.file, &shown, &bytes)?;
    let settings = settings_partial(&args.file, args.common.partial(None))?;
    let measures = args.measures.iter().map(|m| m.trim().to_owned()).filter(|m| !m.is_empty());
    let first = PartOf {
        number: 1,
        count: args.parts,
        measures: measures.collect(),
        radius: args.radius,
        named: shown.clone(),
    };
    pipeline_parts::judge(&first.options())?;
    let out = args.common.out.clone().unwrap_or_else(|| OUT.into());
    let job = Job::new(&absolute(&args.file), &bytes, settings, &absolute(&out), args.embed)?;
    let job = job.with_beside(&super::beside::beside(&args.file));
    let mut lines = String::new();
    for number in 1..=args.parts {
        lines.push_str(&job.clone().with_part(PartOf { number, ..first.clone() }).to_line()?);
        lines.push('\n');
    }
    hand_lines(args.output.as_deref(), &lines, (!args.common.quiet).then_some("part"))?;
    Ok(0)
}

/// Does a part, unless it is done.
pub(super) fn done(
    job: &Job,
    part: &PartOf,
    settings: &Settings,
    cancel: &Cancel,
) -> Result<FinishedPart, Error> {
    if part.number == 0 || part.number > part.count {
        let text = format!("found part {} of {}; nothing was done", part.number, part.count);
        return Err(Error::input("job", Place::file("job"), text));
    }
    let home = job.home()?;
    if let Some(finished) = job.finished_part() {
        return Ok(finished);
    }
    let work = Work::begin();
    let (name, bytes) = (job.name(), job.bytes()?);
    let input = Input::new(&name, &bytes, 1);
    let made = enfilade_pipeline::on_threads(settings, || {
        pipeline_parts::part(&input, settings, &part.options(), (part.number, part.count), cancel)
    })?;
    cancel.check()?;
    let took = [work.elapsed(), work.worked()].map(|t| t.as_secs_f64());
    job.publish_part(&home, (part, made), took)
}

pub(super) fn merge(args: &MergeArgs, cancel: &Cancel) -> Result<u8, Error> {
    let list = list_of(args)?;
    let missing: Vec<&Listed> = list.iter().filter(|l| l.job.finished_part().is_none()).collect();
    if let Some(to) = &args.missing {
        let lines: String = missing.iter().map(|l| format!("{}\n", l.text)).collect();
        hand_lines(Some(to), &lines, None)?;
    }
    if !missing.is_empty() {
        complain(format_args!("error: {}", not_done(&list, &missing)));
        return Ok(TRY_AGAIN);
    }
    let values = |l: &Listed| match l.job.part_values() {
        Some((_, bytes)) => Ok((l.part.number, bytes)),
        None => Err(Error::environment("part", Place::file(l.job.out.to_string_lossy()), "a part is gone")),
    };
    let known = pipeline_parts::join(list.iter().map(values))?;
    let Some(Listed { job, part, .. }) = list.first() else { return Ok(0) };
    let analyse = analyse_args(args, job, part);
    let command = Command::Analyse(analyse);
    outputs::judge(&command)?;
    let Command::Analyse(analyse) = command else { return Ok(0) };
    let clock = Clock::start(&analyse.file, &analyse.common, None)?;
    clock.judge(merged(&analyse, (job, part), &known, (&clock, &clock.within(cancel))))
}

fn merged(
    args: &AnalyseArgs,
    (job, part): (&Job, &PartOf),
    known: &Known,
    (clock, cancel): (&Clock, &Cancel),
) -> Result<u8, Error> {
    let bytes = job.bytes()?;
    let said = settings_partial(&args.file, args.common.partial(None))?;
    let settings = Settings {
        beside: job.beside(|| super::beside::beside(&job.drawing))?,
        unread: super::beside::unread(&args.file),
        // Nothing is left to measure that a card could.
        backend: Backend::Cpu,
        ..Settings::new(Partial { threads: args.common.threads, ..job.settings.clone() })?
    };
    let out = said.out.map(PathBuf::from);
    analysed(args, Input::new(&part.named, &bytes, 1), (settings, out), Some(known), (clock, cancel))
}

/// The analysis of which the parts are.
fn analyse_args(args: &MergeArgs, job: &Job, part: &PartOf) -> AnalyseArgs {
    let is_elsewhere = job.content.is_some() && !job.drawing.is_file();
    AnalyseArgs {
        file: if is_elsewhere { job.name().into() } else { job.drawing.clone() },
        measures: part.measures.clone(),
        radius: part.radius,
        roots: None,
        tables: args.tables.clone(),
        common: Common {
            threads: args.threads,
            out: args.out.clone(),
            json: args.json.clone(),
            quiet: args.quiet,
            job_limit_secs: args.job_limit_secs,
            ..Common::default()
        },
    }
}

/// A line of a list of parts.
struct Listed {
    /// From 1.
    line: usize,
    text: String,
    job: Job,
    part: PartOf,
}

/// The parts of a list: each of one analysis, once, in their order.
fn list_of(args: &MergeArgs) -> Result<Vec<Listed>, Error> {
    let shown = args.list.to_string_lossy();
    let refused = |text: String| {
        Error::input("parts-list", Place::file(&*shown), format!("{text}; nothing was written"))
    };
    let mut list: Vec<Listed> = Vec::new();
    for found in jobs_in(&args.list, args.parts.as_deref(), "parts-list")? {
        let line = found.line;
        list.push(part_of(found).map_err(|why| refused(format!("line {line}: {why}")))?);
    }
    let Some(first) = list.first() else {
        return Err(refused("has no part in it, expected one a line, as `parts` writes them".into()));
    };
    let analysis = first.job.analysis_id();
    if let Some(other) = list.iter().find(|l| l.job.analysis_id() != analysis) {
        return Err(refused(format!(
            "line {} is of another analysis ({}) than line {} ({}): drawing, settings, measures or number of parts differ",
            other.line,
            described(other),
            first.line,
            described(first)
        )));
    }
    let count = first.part.count;
    list.sort_by_key(|l| l.part.number);
    list.dedup_by_key(|l| l.part.number);
    let unlisted: Vec<u32> =
        (1..=count).filter(|n| list.binary_search_by_key(n, |l| l.part.number).is_err()).collect();
    if !unlisted.is_empty() {
        let which = numbers(&unlisted);
        return Err(refused(format!(
            "has no line of part {which} of {count}; `enfilade parts` lists them all"
        )));
    }
    Ok(list)
}

fn part_of(found: ListedJob) -> Result<Listed, String> {
    let ListedJob { line, text, job } = found;
    let part = job
        .part
        .clone()
        .ok_or("is a job of `jobs`, expected a part of an analysis, as `parts` lists them")?;
    Ok(Listed { line, text, job, part })
}

fn described(l: &Listed) -> String {
    format!("part {} of {} of {}", l.part.number, l.part.count, l.job.name())
}

/// Which parts are not done, and which lines do them.
fn not_done(list: &[Listed], missing: &[&Listed]) -> String {
    let mut lines: Vec<u32> = missing.iter().map(|l| l.line as u32).collect();
    lines.sort_unstable();
    let parts: Vec<u32> = missing.iter().map(|l| l.part.number).collect();
    let out = list.first().map_or_else(String::new, |l| l.job.out.display().to_string());
    let (parts, are, lines) = match missing.len() {
        1 => (format!("part {}", numbers(&parts)), "is", format!("line {}", numbers(&lines))),
        _ => (format!("parts {}", numbers(&parts)), "are", format!("lines {}", numbers(&lines))),
    };
    format!(
        "{parts} of {} {are} not done, or damaged, in {out}: do {lines} of the list with `run-job` (--missing writes \
         them); nothing was written",
        list.len()
    )
}

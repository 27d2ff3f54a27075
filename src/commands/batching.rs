//! `jobs` and `run-job`: batches for many machines.

use std::collections::HashSet;
use std::io::Read;
use std::path::Path;
use std::sync::Arc;

use super::listing::{TRY_AGAIN, hand_lines, is_drawing};
use super::parting;
use crate::batch::{self, Finished, Job};
use crate::cli::{JobsArgs, RunJobArgs};
use crate::daemon::{Asked, JobEvent, JobRequest, Share};
use crate::output::say;
use crate::progress::Display;
use crate::store;
use enfilade_cad::StoreyInfo;
use enfilade_config::{Beside, Partial, Settings};
use enfilade_report::{Cancel, Error, Place, complain};

/// Where results go if nothing is said.
const OUT: &str = "enfilade-jobs";

pub(super) fn jobs(args: &JobsArgs) -> Result<u8, Error> {
    let seeds = match &args.seeds {
        Some(list) => Some(batch::seeds(list).map_err(|text| usage("seeds", &text))?),
        None => None,
    };
    let out = args.common.out.clone().unwrap_or_else(|| OUT.into());
    let (mut lines, mut ids) = (String::new(), HashSet::new());
    for file in &args.files {
        for job in
            jobs_of(args, file, seeds.as_deref(), &out)?.into_iter().filter(|j| ids.insert(j.id.clone()))
        {
            lines.push_str(&job.to_line()?);
            lines.push('\n');
        }
    }
    hand_lines(args.output.as_deref(), &lines, (!args.common.quiet).then_some("job"))?;
    Ok(0)
}

fn jobs_of(args: &JobsArgs, file: &Path, seeds: Option<&[u64]>, out: &Path) -> Result<Vec<Job>, Error> {
    let (shown, bytes) = super::open(file)?;
    is_drawing(file, &shown, &bytes)?;
    let settings = super::settings_partial(file, args.common.partial(Some(&args.search)))?;
    let beside = super::beside::beside(file);
    let building = || storeys_of(&shown, &bytes, &settings, &beside);
    let storeys: Vec<Option<String>> = match args.storeys.as_deref() {
        None => vec![settings.storey.clone()],
        Some("all") => {
            let found = building()?;
            let cut_m = enfilade_pipeline::read_options(&Settings::new(settings.clone())?).cut_m();
            let is_own = |i: &usize| enfilade_cad::shown_instead(&found, *i, cut_m).is_none();
            let walled = (0..found.len()).filter(|i| found[*i].walls > 0).filter(is_own);
            let found: Vec<String> = walled.map(|i| enfilade_cad::storey_key(&found, i)).collect();
            if found.is_empty() { vec![None] } else { found.into_iter().map(Some).collect() }
        }
        Some(list) => named_storeys(&shown, &building()?, list)?.into_iter().map(Some).collect(),
    };
    let own = [Settings::new(settings.clone())?.seed];
    let seeds = seeds.unwrap_or(&own);
    // A drawing with a budget of seconds would differ from machine to machine; that is the user's choice.
    let of = |storey: &Option<String>, seed: u64| {
        let settings = Partial { storey: storey.clone(), seed: Some(seed), ..settings.clone() };
        let job = Job::new(&super::absolute(file), &bytes, settings, &super::absolute(out), args.embed)?;
        Ok(job.with_beside(&beside))
    };
    storeys.iter().flat_map(|storey| seeds.iter().map(move |seed| of(storey, *seed))).collect()
}

/// The storeys that a job of these settings would find.
fn storeys_of(
    shown: &str,
    bytes: &[u8],
    settings: &Partial,
    beside: &Beside,
) -> Result<Vec<StoreyInfo>, Error> {
    let settings = Settings { beside: beside.clone(), ..Settings::new(settings.clone())? };
    Ok(enfilade_cad::storeys(shown, bytes, &enfilade_pipeline::read_options(&settings)))
}

/// The storeys of a list as the building writes them, by number where names are shared; it must have each.
fn named_storeys(shown: &str, there: &[StoreyInfo], list: &str) -> Result<Vec<String>, Error> {
    let find = |name: &str| {
        let found = enfilade_cad::storey_at(there.iter().map(|s| s.name.as_str()), name);
        found.map(|i| enfilade_cad::storey_key(there, i)).ok_or_else(|| {
            let why = enfilade_cad::no_storey(there, name, "none");
            Error::usage("storeys", Place::file(shown), format!("--storeys \"{name}\": {why}"))
        })
    };
    list.split(',').map(|name| find(name.trim())).collect()
}

pub(super) fn run_job(args: &RunJobArgs, cancel: &Cancel) -> Result<u8, Error> {
    match done(args, cancel) {
        Ok(line) => {
            say(&line);
            // A batch system takes any other code for a failure; what was left out stands in the line and the report.
            Ok(0)
        }
        // To a batch system wrong settings in a job are a bad job.
        Err(Error::Usage(problem)) => Err(Error::Input(problem)),
        // A link in the place of results stays until somebody removes it: no further try mends that.
        Err(Error::Environment(problem)) if problem.code != store::OUTPUT_IS_LINK => {
            complain(format_args!("error: {problem}"));
            Ok(TRY_AGAIN)
        }
        Err(other) => Err(other),
    }
}

/// Does a job; what it says of itself, as a line.
fn done(args: &RunJobArgs, cancel: &Cancel) -> Result<String, Error> {
    let mut job = Job::from_json(&text_of(&args.job)?)?;
    if let Some(out) = &args.out {
        job.out = super::absolute(out);
    }
    let partial = Partial { threads: args.threads, ..job.settings.clone() };
    let beside = job.beside(|| super::beside::beside(&job.drawing))?;
    let settings = Settings { beside, ..Settings::new(partial)? };
    match &job.part {
        Some(part) => line_of(&parting::done(&job, part, &settings, cancel)?),
        None => line_of(&round_done(args, &job, &settings, cancel)?),
    }
}

fn line_of<T: serde::Serialize>(finished: &T) -> Result<String, Error> {
    serde_json::to_string(finished).map_err(|e| Error::environment("json", Place::default(), e.to_string()))
}

/// A round of a job.
fn round_done(args: &RunJobArgs, job: &Job, settings: &Settings, cancel: &Cancel) -> Result<Finished, Error> {
    let home = job.home()?;
    if let Some(finished) = job.finished(&home) {
        return Ok(finished);
    }
    let request = JobRequest {
        drawing: job.drawing.clone(),
        bytes: Arc::new(job.bytes()?),
        sha256: job.sha256.clone(),
        content: String::new(),
        config: String::new(),
        share: Share::default(),
        round: 1,
        asked: Asked::default(),
        earlier: Arc::new(home.memory()),
        results: home.folder().into(),
    };
    let mut display = Display::new(args.progress, false);
    let mut tell = |event: JobEvent| match event {
        JobEvent::Progress(value) => {
            if let Ok(p) = serde_json::from_value(value) {
                display.show(&p);
            }
        }
        // What is not kept is measured again by the next try.
        JobEvent::Keep { bytes, is_anew } => drop(home.remember(&bytes, is_anew)),
        JobEvent::Analysis(_) | JobEvent::SoFar { .. } | JobEvent::Worked(_) => {}
    };
    // Only the name is shown: paths differ from machine to machine.
    let outcome = super::round(&job.name(), &request, settings, &mut tell, cancel);
    display.finish();
    let outcome = outcome?;
    cancel.check()?;
    let finished = job.publish(&home, &outcome, settings.seed)?;
    home.forget();
    Ok(finished)
}

fn text_of(job: &str) -> Result<String, Error> {
    if job != "-" {
        return Ok(job.into());
    }
    let mut text = String::new();
    let read = std::io::stdin().lock().read_to_string(&mut text);
    read.map_err(|e| Error::input("job", Place::file("standard input"), e.to_string()))?;
    Ok(text)
}

fn usage(what: &'static str, text: &str) -> Error {
    Error::usage(what, Place::default(), format!("--{what}: {text}; nothing was done"))
}

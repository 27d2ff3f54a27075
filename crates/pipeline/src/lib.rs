//! One job from bytes to files: the only place where the siblings meet.
//!
//! Bytes and settings in; files to write, progress and problems out. Clock, seed and stop request are
//! inputs; nothing here touches a disk.
//!
//! A job goes one way, and what a stage makes is all that the next one needs:
//!
//! | stage | takes | makes |
//! |---|---|---|
//! | `read` | the bytes of a file | `Drawing` |
//! | `understand` | `Drawing` | `Understood`: plan, axes, what may move |
//! | `measure` | `Understood` | [`Study`]: lattices, the present layout measured |
//! | `search` | `Round`: the study and what is asked of it | `Searched` |
//! | `confirm` | `Searched` | `Found`: options, confirmed and explained |
//! | [`works`] | `Round`, `Found` | `Offer`: building works, and the options that build |
//! | `write` | `Round`, `Found`, `Offer` | files, [`Outcome`] |
//!
//! ```
//! use enfilade_config::{Partial, Settings};
//! use enfilade_pipeline::{Input, analyse};
//!
//! let bytes = std::fs::read("../../samples/gallery.dxf").expect("a sample of the repository");
//! let settings = Settings::new(Partial::from_toml("", "spacing = 0.5\n")?)?;
//! let (outcome, _study) = analyse(&Input::new("gallery.dxf", &bytes, 1), &settings, &Default::default())?;
//! assert!(outcome.files.iter().any(|f| f.path.ends_with("analysis.json")));
//! # Ok::<(), enfilade_report::Error>(())
//! ```

pub mod accept;
mod analyse;
pub mod brief;
mod check;
mod confirm;
mod job;
mod measure;
pub mod parts;
mod read;
pub mod resolution;
mod round;
mod search;
mod storey;
mod storeys;
mod understand;
pub mod works;
mod write;

use std::sync::Arc;
use std::time::Instant;

use confirm::found::{Found, as_drawn, found};
use enfilade_config::Settings;
use enfilade_overlay::PlanPicture;
use enfilade_overlay::result::RoundResult;
use enfilade_report::{Cancel, Error, Place, Report};
use job::{Job, Watch};
use measure::known::Forest;
use round::Round;
use search::brief::{Brief, is_bare};
use search::judged::objectives;
use search::rules;
use understand::fits;
use works::Offer;
use write::briefed;

pub use analyse::{Depth, add_columns, analyse, analyse_with, measure};
pub use check::{Extras, check, check_with};
pub use job::{Event, Input, Keep, Outcome, Progress, on_threads};
pub use measure::cells;
pub use measure::known::Known;
pub use measure::look::LatticeAt;
pub use measure::seen::Use;
pub use measure::study::Study;
pub use read::read_options;
pub use understand::fits::moves_of;
pub use write::geojson;
pub use write::heat_maps::{ColumnLook, column_look};

/// The plan of a study as it is shown: strokes and regions, plan frame.
pub fn picture(study: &Study) -> PlanPicture {
    write::show::picture(&study.base)
}

/// `enfilade run`: the whole job; the files of one round.
///
/// A stop request ends the job without a round; what was handed out as analysis stays.
///
/// # Errors
/// [`Error::Input`] when the drawing cannot be read or no cell is left; [`Error::Stopped`].
pub fn run(
    input: &Input<'_>,
    settings: &Settings,
    started: Instant,
    show: &mut (dyn FnMut(Event) + Send),
    cancel: &Cancel,
) -> Result<Outcome<RoundResult>, Error> {
    let mut watch = Watch { show, cancel };
    watch.stage("read", None);
    let settings = &*read::query::for_its_storey(input, settings)?;
    let job = Job { input, settings };
    let mut understood = || watch.stage("measure", None);
    let (mut analysis, study) = storey::analyse_storey(job, (Forest::Every, None), &mut understood, cancel)?;
    (watch.show)(Event::Analysis(analysis.files.clone()));
    if analyse::add_storeys(job, (&study, Forest::Every), &mut analysis, cancel)? {
        (watch.show)(Event::Analysis(analysis.files));
    }
    round(job, &study, analysis.report, started, &mut watch)
}

/// Said where the seconds stated are too few.
const HURRIED: &str = "The seconds stated are few for this plan: fewer layouts were ranked, on fewer and coarser lattices, and \
                       fewer works paired. Intervals are wider than with more time.";

/// One round over a study: search, confirm, write. `report` holds what there is to say of the drawing.
fn round(
    job: Job<'_>,
    study: &Study,
    mut report: Report,
    started: Instant,
    watch: &mut Watch<'_>,
) -> Result<Outcome<RoundResult>, Error> {
    let settings = &fits::fitted(&study.base, job.settings, &mut report)?;
    rules::say_odd(&study.base, settings, &mut report)?;
    let mut round = Round::new(Job { settings, ..job }, study, started);
    round.check_brief(&mut report)?;
    round.state_asked(&mut report);
    // Too small a floor has no cells on wider lattices.
    let is_tried = round.is_open() && !is_bare(settings);
    let trial = if is_tried { measure::lattices::trial(study, settings) } else { None };
    let trial = trial.as_ref().unwrap_or(study);
    let found = if round.is_open() { Some(options((&round, trial), &report, watch)?) } else { None };
    let offer =
        if is_bare(settings) { None } else { offer((&round, trial), found.as_ref(), &mut report, watch)? };
    if study.is_hurried() {
        report.info("hurried", Place::file(job.input.file()), HURRIED);
    }
    if let Some(offer) = &offer {
        works::say_best(&offer.listed.result, job.input.file(), &mut report);
    }
    watch.stage("write", Some(found.as_ref().map_or(0, |f| f.members.len() as u64)));
    write::write(&round, report, found.as_ref(), offer.as_ref())
}

/// The building works of the present layout; `None` where somebody stops the job: he keeps the best of its search.
fn offer(
    (round, trial): (&Round<'_>, &Study),
    found: Option<&Found>,
    report: &mut Report,
    watch: &mut Watch<'_>,
) -> Result<Option<Offer>, Error> {
    watch.stage("works", None);
    match offered((round, trial), found, report, watch.cancel) {
        Err(Error::Stopped) => Ok(None),
        offer => offer.map(Some),
    }
}

fn offered(
    (round, trial): (&Round<'_>, &Study),
    found: Option<&Found>,
    report: &mut Report,
    cancel: &Cancel,
) -> Result<Offer, Error> {
    let Round { job, study, .. } = *round;
    let listed = works::of_study(job, study, cancel)?;
    let aims = objectives(job.settings);
    let told = found.map_or_else(|| as_drawn((trial, job.settings), &aims), |f| f.objectives.clone());
    let judges = works::option::Judges { study, trial, objectives: &aims, told: &told };
    let layouts = found.map_or(Vec::new(), Found::layouts);
    let is_pinned = !job.settings.pinned_options.is_empty();
    let is_wanted = !round.is_asked() && (is_pinned || works::options::are_wanted(&study.base));
    let chosen = if is_wanted {
        works::options::options(job, judges, (&listed, &layouts, !round.brief.is_empty()), report, cancel)?
    } else {
        Default::default()
    };
    let objectives = works::options::lowered(told, &chosen.options, job.settings);
    let front = briefed::points(round, (chosen.front, chosen.drawn), report)?;
    works::options::say_front(&front, job.input.file(), report);
    let options = chosen.options.into_iter().map(Arc::new).collect();
    Ok(Offer { listed, options, front, objectives })
}

/// What a round finds: a search, and what is confirmed of it. The best so far is handed out as often as the settings say.
fn options(
    (round, trial): (&Round<'_>, &Study),
    report: &Report,
    watch: &mut Watch<'_>,
) -> Result<Found, Error> {
    let Job { input, settings } = round.job;
    let study = round.study;
    let control = rules::control(&study.base, settings)?;
    let objectives = objectives(settings);
    let brief = Brief { input, study, trial, settings, control: &control, objectives: &objectives };
    let mut so_far = |search: &enfilade_search::Search, at: Progress, watch: &mut Watch<'_>| {
        let made = write::write(round, report.clone(), Some(&found(&brief, search, &[])), None)?;
        let progress = Progress { stage: "so-far".into(), ..at };
        (watch.show)(Event::SoFar { files: made.files, progress });
        Ok(())
    };
    let searched = search::search(&brief, round.started, watch, &mut so_far)?;
    confirm::confirm(&brief, &searched, watch, &mut so_far)
}

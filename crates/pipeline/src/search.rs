//! The fourth stage, from a study to a search that has ended: layouts asked for, measured and told.

pub(crate) mod brief;
pub(crate) mod budget;
pub(crate) mod distance;
pub(crate) mod gain;
pub(crate) mod judged;
pub(crate) mod memory;
pub(crate) mod rules;

use std::time::Instant;

use crate::job::{Event, Progress, Watch};
use crate::search::brief::Brief;
use crate::search::budget::Allowance;
use crate::search::judged::{measured, pinned};
use crate::search::memory::Memory;
use enfilade_config::{Method, Mode, Thresholds};
use enfilade_moves::control::Control;
use enfilade_report::Error;
use enfilade_search::{Evaluation, Search};

/// How often progress is said at most.
const PROGRESS_EVERY_MS: u128 = 50;

/// Takes what a search has found while it goes on.
pub(crate) type TakeSoFar<'a> = dyn FnMut(&Search, Progress, &mut Watch<'_>) -> Result<(), Error> + 'a;

/// A search that has ended.
pub(crate) struct Searched<'a> {
    /// The search.
    pub(crate) search: Search,
    /// Whether too little time is left for what comes after it.
    pub(crate) is_late: bool,
    control: &'a Control,
    begun: Instant,
}

impl Searched<'_> {
    /// How far it came.
    pub(crate) fn progress(&self) -> Progress {
        progress(&self.search, self.control, self.begun)
    }
}

/// Asks, measures, tells until the search stops, the time is over or somebody asks; what is found meanwhile
/// goes to `so_far` as often as the settings say. The round began at `started`.
///
/// # Errors
/// What [`Search::new`] and `so_far` return.
pub(crate) fn search<'a>(
    brief: &Brief<'a>,
    started: Instant,
    watch: &mut Watch<'_>,
    so_far: &mut TakeSoFar<'_>,
) -> Result<Searched<'a>, Error> {
    let Brief { study, settings, control, objectives, .. } = *brief;
    let seeds = rules::seeds(control, settings);
    let known = (1 + seeds.len()) as u64;
    let mut search = Search::new(enfilade_search::Study {
        bounds: control.bounds(),
        start: control.start(),
        objectives: objectives.iter().map(|o| o.1.clone()).collect(),
        members: settings.members,
        d_min: distance::distance(study, settings),
        least_share: if settings.thresholds == Thresholds::Yielding { YIELDING_LEAST_SHARE } else { 1.0 },
        seed: settings.seed,
        evaluations: budget::stated(study, settings),
        method: if settings.method == Method::Paper {
            enfilade_search::Method::Paper
        } else {
            enfilade_search::Method::Default
        },
        mode: if settings.mode == Mode::Best {
            enfilade_search::Mode::Best
        } else {
            enfilade_search::Mode::Diverse
        },
        batch: budget::together(study, settings),
        pinned: pinned(settings),
        seeds,
    })?;
    let mut memory = Memory::new(brief.input, settings, objectives.len());
    let begun = Instant::now();
    let mut allowance = Allowance::new(brief, &mut search, known, started);
    let mut said = Instant::now();
    let mut written = Instant::now();
    loop {
        if watch.cancel.is_stopped() {
            search.finish(enfilade_search::Stop::Asked);
        }
        let remembered = memory.pace();
        allowance.turn(&mut search, remembered);
        let asked = search.ask();
        if asked.is_empty() {
            break;
        }
        let permitted: Vec<Vec<f64>> = asked.iter().map(|p| control.permit(p)).collect();
        let recalled = memory.recall(&permitted);
        if let (Some(pace), Some(_)) = (remembered, &recalled) {
            allowance.go_on(pace);
        }
        let told = recalled.unwrap_or_else(|| {
            let told = measured(brief, &permitted);
            memory.learn(&permitted, &told, allowance.pace());
            told
        });
        let told: Vec<Evaluation> =
            told.into_iter().zip(permitted).map(|(e, at)| Evaluation { at: Some(at), ..e }).collect();
        search.tell(&told);
        if let Some(keep) = memory.keep() {
            (watch.show)(Event::Keep(keep));
        }
        if said.elapsed().as_millis() >= PROGRESS_EVERY_MS {
            said = Instant::now();
            watch.progress(progress(&search, control, begun));
        }
        let is_due = settings.write_every_secs.is_some_and(|s| written.elapsed().as_secs_f64() >= s);
        if is_due && search.stop_reason().is_none() && !watch.cancel.is_stopped() {
            let at = Instant::now();
            so_far(&search, progress(&search, control, begun), watch)?;
            allowance.pause(at.elapsed().as_secs_f64());
            written = Instant::now();
        }
    }
    let is_late = allowance.is_late(search.progress().evaluations);
    Ok(Searched { search, is_late, control, begun })
}

/// To what share of themselves yielding thresholds are lowered at most: options must stay better than the
/// layouts that anybody would find by chance.
const YIELDING_LEAST_SHARE: f64 = 0.3;

pub(crate) fn progress(search: &Search, control: &Control, begun: Instant) -> Progress {
    let p = search.progress();
    let rate = p.evaluations as f64 / begun.elapsed().as_secs_f64().max(1e-3);
    Progress {
        stage: format!("optimise: {}", p.stage),
        done: p.evaluations,
        total: p.total,
        evaluations: p.evaluations,
        best: Some(p.best).filter(|b| b.is_finite()),
        best_parameters: p.best_parameters.map(|q| control.expand(&q)),
        eta_secs: p.total.map(|t| t.saturating_sub(p.evaluations) as f64 / rate.max(1e-9)),
        folder: None,
    }
}

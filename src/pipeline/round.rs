//! One round: search, verify, write.

mod budget;
mod doors;
mod files;
mod grid;
mod joints;
mod judged;
mod overlaps;
mod told;

use std::collections::BTreeMap;
use std::time::Instant;

use rayon::prelude::*;

use super::memory::{Clock, Memory, Pace};
use super::ruler::ruler;
use super::show;
use super::study::{self, Study, Understood, Worth};
use super::{Event, Input, Outcome, Progress};
use super::{explain, fits, rules};
use crate::config::{Aim, Method, Mode, Settings, Thresholds};
use crate::formats::{self, gltf};
use crate::moves::carried::{Carried, carried};
use crate::moves::control::{Control, LIKE_SHARE};
use crate::moves::{Layout, Parameter};
use crate::overlay::Series;
use crate::overlay::measure::plain_name;
use crate::overlay::result::{
    self, Best, Candidate, ElementRef, Explanation, LineageEntry, MoveEntry, Numbers, Objective, RoundResult,
    Sense as ShownSense,
};
use crate::overlay::words;
use crate::plan::drawing::Edit;
use crate::plan::markers::place_in;
use crate::report::{Cancel, Error, OutFile, Place, Report};
use crate::search::{self, Evaluation, Search};
use budget::{budget, most};
pub(super) use judged::hidden;
use judged::{apart, distances, evaluation, is_firm, moves_visibly, nearest, objectives, pinned};

/// Layouts that are asked for at once. Part of the search's definition, not of the machine: the same
/// on any number of threads.
pub const BATCH: usize = 2;

/// A sum of penalties up to this counts as none when it is an objective of its own: written coordinates are
/// rounded to 1 µm, so that a turned wall never keeps its length exactly, and a drawing without any penalty
/// would otherwise allow no turn at all. Results report what was measured.
pub const PENALTY_FREE: f64 = 0.05;

/// How often progress is said at most.
const PROGRESS_EVERY_MS: u128 = 50;

/// Searches and makes the files of the round.
pub(super) fn run(
    input: &Input<'_>,
    settings: &Settings,
    study: &Study,
    mut report: Report,
    started: Instant,
    show: &mut (dyn FnMut(Event) + Send),
    cancel: &Cancel,
) -> Result<Outcome<RoundResult>, Error> {
    let settings = &fits::fitted(&study.base, settings, &mut report)?;
    rules::say_odd(&study.base, settings, &mut report)?;
    let found = if study.base.moves.parameters.is_empty() {
        None
    } else {
        let mut so_far = |found: Found, at: Progress, show: &mut (dyn FnMut(Event) + Send)| {
            let made = round(input, settings, study, report.clone(), Some(&found), started)?;
            let progress = Progress { stage: "so-far".into(), ..at };
            show(Event::SoFar { files: made.files, progress });
            Ok(())
        };
        Some(optimise(input, study, settings, started, show, cancel, &mut so_far)?)
    };
    let total = Some(found.as_ref().map_or(0, |f| f.members.len() as u64));
    show(Event::Progress(Progress { stage: "write".into(), total, ..Default::default() }));
    round(input, settings, study, report, found.as_ref(), started)
}

/// The files of a round from what was found.
fn round(
    input: &Input<'_>,
    settings: &Settings,
    study: &Study,
    mut report: Report,
    found: Option<&Found>,
    started: Instant,
) -> Result<Outcome<RoundResult>, Error> {
    if let Some(why) = study.card_trouble() {
        let text = format!("{why}; the cores measured the rest, with the same result");
        report.warn("backend-gave-up", Place::file(input.file()), text);
    }
    let members = found.map_or(Vec::new(), |f| f.members.clone());
    let made: Vec<Made> = members
        .par_iter()
        .enumerate()
        .map(|(i, m)| make(input, settings, study, i, m))
        .collect::<Result<_, _>>()?;
    for m in &made {
        report.extend(m.report.clone());
    }
    joints::say_opened(&mut report, input.file(), study, &made);
    doors::say_narrowed(&mut report, input.file(), study, &made);
    overlaps::say_overlaps(&mut report, input.file(), study, settings, &made);
    if let Some(found) = found {
        told::say_pinned(&mut report, input.file(), &found.explanations);
        if is_firm(settings) && !made.is_empty() {
            told::say_out_of_reach(&mut report, input.file(), (study, settings), found);
        }
        if !made.is_empty() {
            told::say_below_present(&mut report, input.file(), &found.objectives, is_firm(settings));
        }
        told::say_options(&mut report, input.file(), study, settings, (found, made.len()));
    }
    let wanted = distance(study, settings) * (study.base.moves.parameters.len() as f64).sqrt();
    let share = found.filter(|_| !made.is_empty()).map_or(1.0, |f| f.threshold_share);
    let nearest = nearest(study, &made).map(|(pair, distance)| told::Nearest {
        distance,
        wanted,
        are_pinned: pair.into_iter().all(|i| i < pinned(settings)),
        has_ended: found.is_none_or(|f| f.has_ended),
    });
    told::say_alikeness(&mut report, input.file(), settings, share, nearest.as_ref());
    if found.is_some_and(|f| f.has_ended) {
        grid::say_gridded(&mut report, input.file(), settings, study, &made);
    }
    told::say_free_of_modules(&mut report, input.file(), study, settings);
    let result = round_result(input, settings, study, &report, found, &made, started);
    let mut files = files::pictures(input, settings, study, &made)?;
    files.extend(files::drawings(input, settings, study, &made, &result)?);
    files.push(OutFile::new("convergence.png", files::convergence(found)?));
    files.push(OutFile::new("diversity.png", files::diversity(study, &made)?));
    let understood = super::check_picture(&study.base, &show::check(&study.base, &report))?;
    let maps = show::maps(study);
    let page = super::page::page(input, settings, &result, (&files, &maps), &understood, found);
    files.push(OutFile::new("report.html", page));
    files.push(OutFile::new("result.json", result::to_json(&result)?));
    files.extend(files::lying_beside(settings, &files));
    files.sort_by(|a, b| a.path.cmp(&b.path));
    Ok(Outcome { result, files, report })
}

/// What a search found, in our terms.
pub(super) struct Found {
    pub(super) members: Vec<search::Member>,
    /// Of every member.
    explanations: Vec<Explanation>,
    /// Members left out because they were almost the same as a better one.
    alike: usize,
    /// Members left out because they were no better than the present layout.
    unworthy: usize,
    /// Whether what is left is no better either.
    is_none_better: bool,
    best: Option<Best>,
    /// Why there is no option, where there is none.
    no_option: Option<String>,
    pub(super) objectives: Vec<Objective>,
    /// What is left of the thresholds stated.
    threshold_share: f64,
    pub(super) evaluations: u64,
    pub(super) stopped_by: String,
    /// Whether the search had ended, and not merely been looked at on its way.
    has_ended: bool,
    pub(super) series: Vec<Series>,
    /// Objective values of every layout measured that keeps the hard limits and does not lose far more than it gains.
    pub(super) archive: Vec<Vec<f64>>,
}

/// Takes what was found while the search goes on.
type TakeSoFar<'a> =
    dyn FnMut(Found, Progress, &mut (dyn FnMut(Event) + Send)) -> Result<(), Error> + Send + 'a;

/// Asks, measures, tells until the search stops, the time is over or somebody asks; what is found meanwhile
/// goes to `so_far` as often as the settings say.
fn optimise(
    input: &Input<'_>,
    study: &Study,
    settings: &Settings,
    started: Instant,
    show: &mut (dyn FnMut(Event) + Send),
    cancel: &Cancel,
    so_far: &mut TakeSoFar<'_>,
) -> Result<Found, Error> {
    let objectives = objectives(settings);
    let control = rules::control(&study.base, settings)?;
    let seeds = rules::seeds(&control, settings);
    let known = (1 + seeds.len() + BATCH) as u64;
    let mut search = Search::new(search::Study {
        bounds: control.bounds(),
        start: control.start(),
        objectives: objectives.iter().map(|o| o.1.clone()).collect(),
        members: settings.members,
        d_min: distance(study, settings),
        least_share: if settings.thresholds == Thresholds::Yielding { YIELDING_LEAST_SHARE } else { 1.0 },
        seed: settings.seed,
        evaluations: (!settings.until_converged).then(|| budget(study, settings)),
        method: if settings.method == Method::Paper {
            search::Method::Paper
        } else {
            search::Method::Default
        },
        mode: if settings.mode == Mode::Best { search::Mode::Best } else { search::Mode::Diverse },
        batch: BATCH,
        pinned: pinned(settings),
        seeds,
    })?;
    if settings.until_converged {
        search.set_most(most(settings));
    }
    let mut memory = Memory::new(input, settings, objectives.len());
    let begun = Instant::now();
    let mut clock = Clock::new(started);
    let mut said = Instant::now();
    let mut written = Instant::now();
    let mut fit = 0;
    loop {
        if cancel.is_stopped() {
            search.finish(search::Stop::Asked);
        } else if let Some(seconds) = settings.seconds {
            let remembered = memory.pace();
            if remembered.is_none() && clock.spent_secs() >= seconds && search.progress().evaluations > 0 {
                search.finish(search::Stop::Time);
            }
            fit = remembered
                .map_or_else(|| clock.fit(search.progress().evaluations, seconds).max(known), |p| p.fit);
            if !settings.until_converged {
                search.set_evaluations(settings.evaluations.map_or(fit, |limit| limit.min(fit)));
            }
        }
        if settings.until_converged && search.progress().evaluations >= most(settings) {
            search.finish(search::Stop::Budget);
        }
        let asked = search.ask();
        if asked.is_empty() {
            break;
        }
        let permitted: Vec<Vec<f64>> = asked.iter().map(|p| control.permit(p)).collect();
        let remembered = memory.pace();
        let recalled = memory.recall(&permitted);
        if let (Some(pace), Some(_)) = (remembered, &recalled) {
            clock.set(pace.spent_secs);
        }
        let told = recalled.unwrap_or_else(|| {
            let told = measured(study, settings, &control, &objectives, &permitted);
            // Without such a budget nothing depends on the clock, and what is kept neither.
            let pace = settings.seconds.map(|_| Pace { fit, spent_secs: clock.spent_secs() });
            memory.learn(&permitted, &told, pace.unwrap_or_default());
            told
        });
        let told: Vec<Evaluation> =
            told.into_iter().zip(permitted).map(|(e, at)| Evaluation { at: Some(at), ..e }).collect();
        search.tell(&told);
        if let Some(keep) = memory.keep() {
            show(Event::Keep(keep));
        }
        if said.elapsed().as_millis() >= PROGRESS_EVERY_MS {
            said = Instant::now();
            show(Event::Progress(progress(&search, &control, begun)));
        }
        let is_due = settings.write_every_secs.is_some_and(|s| written.elapsed().as_secs_f64() >= s);
        if is_due && search.stop_reason().is_none() && !cancel.is_stopped() {
            let found = found(study, settings, &control, &objectives, &search);
            so_far(found, progress(&search, &control, begun), show)?;
            written = Instant::now();
        }
    }
    cancel.check()?;
    Ok(found(study, settings, &control, &objectives, &search))
}

/// Violation of what breaks a rule, as only a pinned option can: others are brought to what the rules allow.
const RULE_BROKEN: f64 = 1.0;

/// What vectors of free parameters are worth.
fn measured(
    study: &Study,
    settings: &Settings,
    control: &Control,
    objectives: &[(Aim, search::Objective)],
    vectors: &[Vec<f64>],
) -> Vec<Evaluation> {
    let layouts: Vec<Vec<f64>> = vectors.iter().map(|p| control.expand(p)).collect();
    let worths = study.measure_all(&layouts);
    let of = |(worth, q): (&Worth, &Vec<f64>)| {
        let found = evaluation(study, settings, objectives, worth);
        let breach = if control.pinned_breaks(q) { RULE_BROKEN } else { 0.0 };
        Evaluation { violation: found.violation + breach, ..found }
    };
    worths.par_iter().zip(vectors).map(of).collect()
}

/// What a finished search found: options and best layout with all their parameters, explained.
fn found(
    study: &Study,
    settings: &Settings,
    control: &Control,
    objectives: &[(Aim, search::Objective)],
    search: &Search,
) -> Found {
    let outcome = search.outcome();
    let initial = evaluation(study, settings, objectives, &study.initial);
    let shown = objectives.iter().enumerate().map(|(i, (_, o))| Objective {
        name: o.name.clone(),
        sense: if o.sense == search::Sense::Maximise { ShownSense::Max } else { ShownSense::Min },
        threshold: o.threshold * outcome.threshold_share,
        initial: initial.values[i],
        best: best_of(&outcome, i, o.sense),
        reachable: outcome.reachable[i],
        // No −0, which would be written so.
        limit: outcome.reachable[i].map(|_| outcome.thresholds[i] + 0.0),
        free: o.is_penalty.then_some(PENALTY_FREE),
    });
    let shown: Vec<Objective> = shown.collect();
    let goes_on = || "the search had not ended; this is the best so far".to_owned();
    let mut stopped_by = search.stop_reason().map_or_else(goes_on, |s| s.to_string());
    let whole = |p: &[f64]| control.expand(p);
    let mut members = outcome.members.clone();
    let pinned = pinned(settings).min(members.len());
    let mut at = 0..;
    members.retain(|m| at.next().is_some_and(|i: usize| i < pinned) || m.violation == 0.0);
    for m in &mut members {
        m.parameters = whole(&m.parameters);
    }
    if settings.mode == Mode::Best && settings.method != Method::Paper && !members.is_empty() {
        let best = best_in_all(settings, &outcome, &shown);
        if outcome.members.iter().all(|m| m.parameters != best.parameters) {
            members = vec![the_best(best, &whole)];
        }
    }
    let found = members.len();
    members = apart(study, members);
    let alike = outcome.alike + found - members.len();
    let unworthy = keep_better(study, settings, &shown, &mut members);
    let is_none_better =
        unworthy > 0 && members.iter().all(|m| !explain::is_better(&shown, &m.values, is_firm(settings)));
    let is_unmet = outcome.best.violation > 0.0;
    let best = best_in_all(settings, &outcome, &shown);
    let is_best_better = explain::is_better(&shown, &best.values, is_firm(settings));
    let no_option = (members.is_empty() || is_unmet).then(|| {
        if !is_unmet {
            return told::nothing_returned(settings, outcome.evaluations, is_best_better);
        }
        let nearest = whole(&outcome.best.parameters);
        let worth = study.measure(&nearest, &mut study.bench());
        let missed = rules::missed_words(study, settings, control, (&nearest, &worth));
        let text = format!(
            "no layout of the {} measured keeps every hard limit; the one that comes nearest misses {missed}",
            outcome.evaluations
        );
        stopped_by.push_str("; no layout keeps every hard limit");
        text
    });
    let best = (!is_unmet && is_best_better).then(|| {
        let mut parameters = whole(&best.parameters);
        // Another layout that measures the same is no better: the best is among the options then.
        let option = members.iter().position(|m| m.parameters == parameters);
        let option = option.or_else(|| members.iter().position(|m| m.values == best.values));
        if let Some(i) = option {
            parameters.clone_from(&members[i].parameters);
        }
        let worth = study.measure(&parameters, &mut study.bench());
        Best {
            option: option.map(|i| i + 1),
            mean: show::mean_numbers(study, &worth),
            penalty: show::penalty_numbers(&worth),
            score: Some(study.score(&worth, settings)),
            parameters,
        }
    });
    Found {
        explanations: explanations(study, settings, control, objectives, &shown, &members),
        best,
        alike,
        unworthy,
        is_none_better,
        no_option,
        objectives: shown,
        threshold_share: outcome.threshold_share,
        evaluations: outcome.evaluations,
        stopped_by,
        has_ended: search.stop_reason().is_some(),
        series: series(&outcome, objectives),
        archive: outcome.archive.iter().filter(|p| p.violation == 0.0).map(|p| p.values.clone()).collect(),
        members,
    }
}

/// The layout that keeps hard limits and thresholds and gains most in all, as options are ordered; a single objective has
/// its own. The paper's algorithms do not look for it among what they measure after their first stages.
fn best_in_all<'a>(
    settings: &Settings,
    outcome: &'a search::Outcome<'_>,
    objectives: &[Objective],
) -> &'a search::Point {
    let aims = objectives.iter().filter(|o| o.name != "penalty").count();
    if settings.method != Method::Paper && aims < 2 {
        return &outcome.best;
    }
    let keeps = |p: &search::Point| {
        let sides = objectives.iter().zip(&p.values).zip(&outcome.thresholds);
        p.violation == 0.0
            && sides.into_iter().all(|((o, v), t)| if o.sense == ShownSense::Max { v >= t } else { v <= t })
    };
    let gain = |p: &search::Point| explain::total_gain(objectives, &p.values);
    let kept = outcome.archive.iter().filter(|p| keeps(p));
    kept.fold(&outcome.best, |best, p| if gain(p) > gain(best) { p } else { best })
}

/// The one option of mode best.
fn the_best(point: &search::Point, whole: &dyn Fn(&[f64]) -> Vec<f64>) -> search::Member {
    search::Member {
        parameters: whole(&point.parameters),
        values: point.values.clone(),
        violation: point.violation,
        within_threshold: true,
    }
}

/// Leaves out the members that are as drawn or no better than the present layout, and says how many are no better;
/// the best of the others come first, after those that were pinned, which all stay.
fn keep_better(
    study: &Study,
    settings: &Settings,
    objectives: &[Objective],
    members: &mut Vec<search::Member>,
) -> usize {
    let pinned = pinned(settings).min(members.len());
    let mut free = members.split_off(pinned);
    free.retain(|m| moves_visibly(study, &m.parameters));
    let gain = |m: &search::Member| explain::total_gain(objectives, &m.values);
    free.sort_by(|a, b| gain(b).total_cmp(&gain(a)));
    if settings.method == Method::Paper {
        members.append(&mut free);
        return 0;
    }
    let worthy = free.iter().filter(|m| explain::is_better(objectives, &m.values, is_firm(settings)));
    let better: Vec<search::Member> = worthy.cloned().collect();
    let unworthy = free.len() - better.len();
    if better.is_empty() && pinned == 0 {
        // Where nothing is better, the best there is shows how little these moves can do.
        free.truncate(1);
        members.append(&mut free);
    } else {
        members.extend(better);
    }
    unworthy
}

fn explanations(
    study: &Study,
    settings: &Settings,
    control: &Control,
    objectives: &[(Aim, search::Objective)],
    shown: &[Objective],
    members: &[search::Member],
) -> Vec<Explanation> {
    let options: Vec<Vec<f64>> = members.iter().map(|m| m.parameters.clone()).collect();
    let measured = |p: &[f64]| {
        let worth = study.measure(p, &mut study.bench());
        evaluation(study, settings, objectives, &worth).values
    };
    let one = |i: usize| {
        let mut out = explain::explain(study, control, shown, &options, i, &measured);
        if i < pinned(settings) {
            let worth = study.measure(&options[i], &mut study.bench());
            out.breaks = rules::broken(study, settings, control, (&options[i], &worth));
            if !out.breaks.is_empty() {
                // What may be gained without keeping the limits was not looked for: no share to tell.
                out.kept = result::Numbers::default();
            }
        }
        out
    };
    (0..options.len()).into_par_iter().map(one).collect()
}

/// Best value of one objective among all layouts that keep the hard limits, if any does.
fn best_of(outcome: &search::Outcome<'_>, objective: usize, sense: search::Sense) -> Option<f64> {
    let values = outcome.archive.iter().filter(|p| p.violation == 0.0).map(|p| p.values[objective]);
    let better = |a: f64, b: f64| if sense == search::Sense::Maximise { a.max(b) } else { a.min(b) };
    values.reduce(better)
}

/// The course of the search: the best value of every objective among the layouts that keep the hard limits,
/// and, once options spread, how far the two most alike stand apart.
fn series(outcome: &search::Outcome<'_>, objectives: &[(Aim, search::Objective)]) -> Vec<Series> {
    let mut out: Vec<Series> = objectives
        .iter()
        .enumerate()
        .map(|(j, (_, o))| Series {
            name: format!("{}: best found", plain_name(&o.name)),
            points: course(outcome, j, o.sense),
        })
        .collect();
    let apart = outcome.stages.iter().filter(|s| s.min_distance > 0.0);
    let points: Vec<(u64, f64)> = apart.map(|s| (s.evaluations, s.min_distance)).collect();
    if !points.is_empty() {
        out.push(Series { name: "Distance of the two options most alike".into(), points });
    }
    out
}

/// Where the best value of an objective rose, and to what.
fn course(outcome: &search::Outcome<'_>, objective: usize, sense: search::Sense) -> Vec<(u64, f64)> {
    let mut points: Vec<(u64, f64)> = vec![];
    for (i, p) in outcome.archive.iter().enumerate().filter(|(_, p)| p.violation == 0.0) {
        let value = p.values[objective];
        let is_better =
            |best: f64| if sense == search::Sense::Maximise { value > best } else { value < best };
        if value.is_finite() && points.last().is_none_or(|(_, best)| is_better(*best)) {
            points.push((i as u64 + 1, value));
        }
    }
    points
}

fn progress(search: &Search, control: &Control, begun: Instant) -> Progress {
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

/// How far apart options should stand, as a share of √n: where all stay near one, or few walls may move at once, the
/// same share of the room there is.
fn distance(study: &Study, settings: &Settings) -> f64 {
    let near = if settings.like.is_some() { 2.0 * LIKE_SHARE } else { 1.0 };
    let few = settings.most_moves.map_or(1.0, |most| share_of_two(study, most));
    settings.distance * near * few
}

/// The largest distance of two layouts that move at most so many groups each, as a share of the largest of all: in a
/// group that both move they may stand at opposite ends of its ranges, in others one of them stands as drawn.
fn share_of_two(study: &Study, most: usize) -> f64 {
    let parameters = &study.base.moves.parameters;
    // Largest squares with so many of the moves of both used up.
    let mut best = vec![0.0_f64; 2 * most.min(parameters.len()) + 1];
    for of in parameters.chunk_by(|a, b| a.group_name == b.group_name) {
        let from_drawn = |p: &Parameter| {
            let (identity, range) = (p.clause.kind.identity(), p.clause.upper - p.clause.lower);
            let most = (p.clause.upper - identity).max(identity - p.clause.lower);
            if range > 0.0 { (most / range).powi(2) } else { 0.0 }
        };
        let (both, one) = (of.len() as f64, of.iter().map(from_drawn).sum::<f64>());
        for used in (1..best.len()).rev() {
            let with_both = if used > 1 { best[used - 2] + both } else { 0.0 };
            best[used] = best[used].max(best[used - 1] + one).max(with_both);
        }
    }
    (best.last().copied().unwrap_or(0.0) / parameters.len().max(1) as f64).sqrt().min(1.0)
}

/// To what share of themselves yielding thresholds are lowered at most: options must stay better than the
/// layouts that anybody would find by chance.
const YIELDING_LEAST_SHARE: f64 = 0.3;

/// A member made real: its layout, its bytes without our layers, and what these are worth.
pub(super) struct Made {
    layout: Layout,
    member: search::Member,
    worth: Worth,
    edits: Vec<Edit>,
    /// For every edit the records it changes.
    changed: Vec<Vec<formats::ChangedRecord>>,
    /// Ids of the host program, by record.
    host_ids: BTreeMap<u64, String>,
    report: Report,
    name: String,
}

/// Patches the drawing, reads it again and measures from scratch: what is reported is what is written.
fn make(
    input: &Input<'_>,
    settings: &Settings,
    study: &Study,
    index: usize,
    member: &search::Member,
) -> Result<Made, Error> {
    let layout = study.base.moves.apply(&study.base.plan, &study.base.graph, &member.parameters);
    let edits = edits_of(&study.base, &layout);
    let options = study::read_options(settings);
    let changed = formats::changed_records(input.file(), &input.bytes, &options, &edits)?;
    let bytes = formats::patch(input.file(), &input.bytes, &options, &edits, &[])?;
    let worth = study.measure_written(&bytes, &layout, settings)?;
    let name = format!("candidate-{}", index + 1);
    let mut report = Report::default();
    let records: Vec<usize> = edits.iter().map(Edit::record).collect();
    let ids = formats::host_ids(input.file(), &input.bytes, &records);
    let host_ids = records.iter().zip(ids).filter_map(|(r, id)| Some((*r as u64, id?))).collect();
    state_stale(input, settings, &records, &mut report)?;
    state_left_behind(&study.base, &layout, &mut report);
    let searched = study.measure(&member.parameters, &mut study.bench());
    let differs = worth.differences(&searched);
    if !differs.is_empty() {
        let differs: Vec<String> =
            differs.into_iter().map(|(what, new, old)| format!("{what} {new} instead of {old}")).collect();
        let text = format!(
            "{name} read again does not measure as in the search: {}; the values of the file are reported",
            differs.join(", ")
        );
        report.warn("written-differs", Place::file(input.file()), text);
    }
    Ok(Made { layout, member: member.clone(), worth, edits, changed, host_ids, report, name })
}

/// The changes of the file that make a layout; blocks once for all that they show.
pub(super) fn edits_of(base: &Understood, layout: &Layout) -> Vec<Edit> {
    let mut out: Vec<Edit> = Vec::new();
    for moved in layout.walls.iter().filter(|w| w.is_changed) {
        let wall = &base.plan.walls[moved.wall as usize];
        let record = wall.source.record;
        if !wall.editable.moves_whole() {
            out.push(Edit::Shape { record, shape: moved.shape.clone() });
            continue;
        }
        let motion = moved.motion.map(|motion| Edit::Insert { record, motion });
        for edit in motion.into_iter().chain(moved.ends.map(|by| Edit::Ends { record, by })) {
            if !out.contains(&edit) {
                out.push(edit);
            }
        }
    }
    for fitting in &base.fittings {
        let record = fitting.source.record;
        let Carried::Moves(shape, motion) = carried(&base.plan, fitting, layout) else { continue };
        let edit = match fitting.editable.moves_whole() {
            true => Edit::Insert { record, motion },
            false => Edit::Shape { record, shape },
        };
        if !out.contains(&edit) {
            out.push(edit);
        }
    }
    out
}

/// Names the annotation that does not follow the moved walls.
fn state_stale(
    input: &Input<'_>,
    settings: &Settings,
    moved: &[usize],
    report: &mut Report,
) -> Result<(), Error> {
    let options = study::read_options(settings);
    told::say_stale(report, input.file(), &formats::dependents(input.file(), &input.bytes, &options, moved)?);
    Ok(())
}

/// Doors and windows that cannot go with their wall.
fn state_left_behind(base: &Understood, layout: &Layout, report: &mut Report) {
    for fitting in &base.fittings {
        if let Carried::Stale(why) = carried(&base.plan, fitting, layout) {
            let text = format!(
                "is part of a door or window whose wall moves in an option, but {why}; it stays as drawn"
            );
            report.info(told::OPENING_STAYS, place_in(&base.plan.file, &fitting.source), text);
        }
    }
    told::say_labels(base, layout, report);
}

fn round_result(
    input: &Input<'_>,
    settings: &Settings,
    study: &Study,
    report: &Report,
    found: Option<&Found>,
    made: &[Made],
    started: Instant,
) -> RoundResult {
    let moves = show::move_entries(&study.base);
    let settings_map = match serde_json::to_value(settings) {
        Ok(serde_json::Value::Object(map)) => map,
        _ => serde_json::Map::new(),
    };
    let initial = result::Layout {
        mean: show::mean_numbers(study, &study.initial),
        penalty: show::penalty_numbers(&study.initial),
    };
    let none = Explanation::default();
    let explanations = found.map_or(&[][..], |f| &f.explanations);
    let of = |(i, m): (usize, &Made)| {
        candidate(settings, study, &moves, &initial.mean, m, explanations.get(i).unwrap_or(&none))
    };
    let candidates = made.iter().enumerate().map(of).collect();
    RoundResult {
        schema: result::RESULT_SCHEMA.into(),
        input: show::input(&study.base.plan, input.path, input.sha256()),
        settings: settings_map,
        counts: show::counts(study, study.edges),
        spacing_m: study.spacing_m,
        lattice_centre: super::lattice_centre(study),
        initial,
        moves,
        objectives: found.map_or(Vec::new(), |f| f.objectives.clone()),
        candidates,
        best: found.and_then(|f| f.best.clone()),
        diversity: distances(study, made),
        evaluations: found.map_or(0, |f| f.evaluations),
        seconds: started.elapsed().as_secs_f64(),
        stopped_by: found
            .map_or("nothing may move: the present layout was measured".into(), |f| f.stopped_by.clone()),
        lineage: lineage(settings, &ruler(&study.base.plan.markers, study.spacing_m)),
        problems: report.problems.iter().map(Into::into).collect(),
    }
}

fn candidate(
    settings: &Settings,
    study: &Study,
    moves: &[MoveEntry],
    initial: &Numbers,
    made: &Made,
    explanation: &Explanation,
) -> Candidate {
    let mean = show::mean_numbers(study, &made.worth);
    Candidate {
        file: format!("{}.{}", made.name, study.base.plan.format.name()),
        parameters: made.member.parameters.clone(),
        words: words::words(
            moves,
            &made.member.parameters,
            &told(study, initial),
            &told(study, &mean),
            explanation,
        ) + &told::goes_along_words(&study.base, &made.layout)
            + &doors::narrowed_words(&study.base, &made.layout)
            + &told::stays_words(&made.report),
        explanation: explanation.clone(),
        mean,
        penalty: show::penalty_numbers(&made.worth),
        score: Some(study.score(&made.worth, settings)),
        within_threshold: made.member.within_threshold,
        changes: changes(study, made),
    }
}

/// `changes` of a candidate, each with the records of the file that differ.
fn changes(study: &Study, made: &Made) -> Vec<result::Change> {
    let mut out = show::changes(&study.base, &made.layout);
    for change in &mut out {
        if let ElementRef::Gltf { path } = &change.element {
            let fitted = study.base.fittings.iter().map(|f| &f.source);
            let all = study.base.plan.walls.iter().map(|w| &w.source).chain(fitted);
            let named = all.filter(|s| s.handle.as_deref() == Some(path)).map(|s| &s.kind);
            change.host_id = named.into_iter().find(|name| gltf::is_global_id(name)).cloned();
            continue;
        }
        let (ElementRef::Dxf { record, .. } | ElementRef::Ifc { id: record, .. }) = change.element else {
            continue;
        };
        change.host_id = made.host_ids.get(&record).cloned();
        let edit = made.edits.iter().position(|e| e.record() as u64 == record);
        let Some(changed) = edit.and_then(|i| made.changed.get(i)).filter(|c| c.len() != 1) else { continue };
        let mut all = vec![change.element.clone()];
        for c in changed {
            let element = show::element_of(study.base.plan.format, c.handle.clone(), c.record);
            if !all.contains(&element) {
                all.push(element);
            }
        }
        change.element = ElementRef::Several(all);
    }
    out
}

/// What is told in words: the three of the paper, what each named pair sees, and what else was asked for.
fn told(study: &Study, mean: &Numbers) -> Numbers {
    let is_asked = |name: &str| study.aims.iter().any(|a| a.to_string() == name);
    let is_told = |name: &str| {
        let is_of_pair = name.contains('@');
        name != "degree_all" && (!is_of_pair || name.starts_with("degree@") || is_asked(name))
    };
    Numbers(mean.0.iter().filter(|(name, _)| is_told(name)).cloned().collect())
}

/// The rounds before, as this one, whose mark of spacing and regions is `ruler`, has them.
fn lineage(settings: &Settings, ruler: &str) -> Vec<LineageEntry> {
    let entry = |entry: &crate::config::LineageTable| LineageEntry {
        drawing: entry.drawing.clone(),
        round: u64::from(entry.round),
        so_far: entry.so_far,
        other_ruler: !entry.ruler.is_empty() && entry.ruler != ruler,
        candidate: Some(u64::from(entry.candidate)),
        mean: Numbers::of(entry.initial.iter().map(|(k, v)| (k.clone(), *v))),
        score: None,
    };
    settings.lineage.iter().map(entry).collect()
}

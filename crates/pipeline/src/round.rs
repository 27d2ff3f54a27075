//! One round: search, verify, write.

use crate::confirm::elsewhere;
use crate::measure::limits;
use crate::search::budget;
use crate::write::doors;
use crate::write::files;
use crate::write::joints;
use crate::write::leaving;
use crate::write::overlaps;
use crate::write::told;
use std::time::Instant;

use rayon::prelude::*;

pub(crate) use crate::confirm::found::Found;
use crate::confirm::found::found;
use crate::confirm::ideas::Experience;
use crate::job::Event;
use crate::job::Input;
use crate::job::Outcome;
use crate::job::Progress;
use crate::measure::lattices;
use crate::measure::ruler::ruler;
use crate::measure::seen::Use;
use crate::measure::study::Study;
use crate::measure::worth::Worth;
use crate::search::budget::Allowance;
use crate::search::judged::{distances, evaluation, is_firm, nearest, objectives, pinned};
use crate::search::memory::Memory;
use crate::search::rules;
use crate::understand::fits;
use crate::understand::sensed::Sensed;
use crate::write::asked;
use crate::write::made::{Made, changes, make};
use crate::write::show;
use enfilade_config::{Aim, Held, Method, Mode, Settings, Thresholds, Unsure};
use enfilade_moves::Parameter;
use enfilade_moves::control::{Control, LIKE_SHARE};
use enfilade_overlay::result::{
    self, Best, Candidate, Diversity, Explanation, Gains, LineageEntry, MoveEntry, Numbers, RoundResult,
};
use enfilade_overlay::words;
use enfilade_report::{Cancel, Error, OutFile, Place, Report};
use enfilade_search::{Evaluation, Search};

/// Layouts that are asked for at once. Part of the search's definition, not of the machine: the same
/// on any number of threads.
pub const BATCH: usize = 2;

/// A sum of penalties up to this counts as none when it is an objective of its own: written coordinates are
/// rounded to 1 µm, so that a turned wall never keeps its length exactly, and a drawing without any penalty
/// would otherwise allow no turn at all. Results report what was measured.
pub const PENALTY_FREE: f64 = 0.05;

/// Objectives as the user and as the search know them.
pub(crate) type Aims = [(Aim, enfilade_search::Objective)];

/// What a search works with.
pub(crate) struct Brief<'a> {
    /// The drawing.
    pub(crate) input: &'a Input<'a>,
    /// On the lattice that is shown.
    pub(crate) study: &'a Study,
    /// On the lattices that are searched on; the same one where the problem is bare.
    pub(crate) trial: &'a Study,
    pub(crate) settings: &'a Settings,
    pub(crate) control: &'a Control,
    pub(crate) objectives: &'a Aims,
}

/// Whether a search is the bare problem: one lattice, options by the distance of their parameters.
pub(crate) fn is_bare(settings: &Settings) -> bool {
    settings.raw || settings.method == Method::Paper
}

/// How often progress is said at most.
const PROGRESS_EVERY_MS: u128 = 50;

/// Searches and makes the files of the round.
pub(crate) fn run(
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
    let sensed = Sensed::new(&study.base, settings);
    let is_asked = !sensed.doubts.is_empty() && settings.unsure == Unsure::Ask;
    if is_asked {
        let text = "The reading is unsure, so no option was made. Answer the questions, or run it with --unsure optimise.";
        report.warn("unsure", Place::file(input.file()), text);
    }
    let found = if study.base.moves.parameters.is_empty() || is_asked {
        None
    } else {
        let mut so_far = |found: Found, at: Progress, show: &mut (dyn FnMut(Event) + Send)| {
            let made = round(input, settings, (study, &sensed), report.clone(), Some(&found), started)?;
            let progress = Progress { stage: "so-far".into(), ..at };
            show(Event::SoFar { files: made.files, progress });
            Ok(())
        };
        let control = rules::control(&study.base, settings)?;
        let objectives = objectives(settings);
        // Too small a floor has no cells on wider lattices.
        let trial = (!is_bare(settings))
            .then(|| study.on_lattices(settings, &lattices::searched(study, settings), Use::Search).ok())
            .flatten();
        let trial = trial.map(|mut trial| {
            trial.share_card(study);
            trial
        });
        let trial = trial.as_ref().unwrap_or(study);
        let brief = Brief { input, study, trial, settings, control: &control, objectives: &objectives };
        Some(optimise(input, &brief, started, show, cancel, &mut so_far)?)
    };
    let total = Some(found.as_ref().map_or(0, |f| f.members.len() as u64));
    show(Event::Progress(Progress { stage: "write".into(), total, ..Default::default() }));
    round(input, settings, (study, &sensed), report, found.as_ref(), started)
}

/// The files of a round from what was found.
fn round(
    input: &Input<'_>,
    settings: &Settings,
    (study, sensed): (&Study, &Sensed),
    mut report: Report,
    found: Option<&Found>,
    started: Instant,
) -> Result<Outcome<RoundResult>, Error> {
    let card_trouble = found.and_then(|f| f.card_trouble.as_deref());
    if let Some(why) = study.card_trouble().or(card_trouble) {
        let text = format!("{why}; the cores measured the rest, with the same result");
        report.warn("backend-gave-up", Place::file(input.file()), text);
    }
    let members = found.map_or(Vec::new(), |f| f.members.clone());
    let made: Vec<Made> = members
        .par_iter()
        .enumerate()
        .map(|(i, m)| make(input, settings, study, &format!("candidate-{}", i + 1), m))
        .collect::<Result<_, _>>()?;
    for m in &made {
        report.extend(m.report.clone());
    }
    let best = found.and_then(|f| f.best.as_ref());
    let best = best.map(|b| make(input, settings, study, "best", &b.member)).transpose()?;
    joints::say_opened(&mut report, input.file(), study, &made);
    doors::say_narrowed(&mut report, input.file(), study, &made);
    overlaps::say_overlaps(&mut report, input.file(), study, settings, &made);
    leaving::say_leaving(&mut report, input.file(), study, &made);
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
    told::say_lowered(&mut report, input.file(), share);
    let likeness = likeness(study, &made);
    if is_bare(settings) {
        told::say_alikeness(&mut report, input.file(), settings, nearest.as_ref());
    } else {
        let shared = told::shared_parts(found.map_or(&[][..], |f| &f.explanations));
        let of = (input.file(), study.base.plan.format);
        told::say_likeness(&mut report, of, likeness, &shared);
    }
    told::say_free_of_modules(&mut report, input.file(), study, settings);
    let mut result = round_result(input, settings, study, &report, found, (&made, best.as_ref()), started);
    result.questions = sensed.doubts.iter().map(|d| asked::entry(d, &study.base.plan)).collect();
    if found.is_none() && !result.questions.is_empty() {
        result.stopped_by = "questions are open: the present layout was measured".into();
    }
    let shown: Vec<&Made> = made.iter().chain(&best).collect();
    let mut files = files::pictures(input, settings, study, &shown)?;
    files.extend(files::drawings(input, settings, study, &shown, &result)?);
    files.push(OutFile::new("convergence.png", files::convergence(found)?));
    files.push(OutFile::new("diversity.png", files::diversity(study, &made)?));
    let understood = crate::check_picture(&study.base, sensed)?;
    let maps = show::maps(study);
    let page = crate::write::page::page(input, settings, &result, (&files, &maps), &understood, found);
    files.push(OutFile::new("report.html", page));
    files.push(OutFile::new("result.json", result::to_json(&result)?));
    files.extend(files::lying_beside(settings, &files));
    files.sort_by(|a, b| a.path.cmp(&b.path));
    Ok(Outcome { result, files, report })
}

/// Takes what was found while the search goes on.
type TakeSoFar<'a> =
    dyn FnMut(Found, Progress, &mut (dyn FnMut(Event) + Send)) -> Result<(), Error> + Send + 'a;

/// Asks, measures, tells until the search stops, the time is over or somebody asks; what is found meanwhile
/// goes to `so_far` as often as the settings say.
fn optimise(
    input: &Input<'_>,
    brief: &Brief<'_>,
    started: Instant,
    show: &mut (dyn FnMut(Event) + Send),
    cancel: &Cancel,
    so_far: &mut TakeSoFar<'_>,
) -> Result<Found, Error> {
    let Brief { study, settings, control, objectives, .. } = *brief;
    let seeds = rules::seeds(control, settings);
    let known = (1 + seeds.len()) as u64;
    let mut search = Search::new(enfilade_search::Study {
        bounds: control.bounds(),
        start: control.start(),
        objectives: objectives.iter().map(|o| o.1.clone()).collect(),
        members: settings.members,
        d_min: distance(study, settings),
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
        batch: BATCH,
        pinned: pinned(settings),
        seeds,
    })?;
    let mut memory = Memory::new(input, settings, objectives.len());
    let begun = Instant::now();
    let mut allowance = Allowance::new(settings, &mut search, known, started);
    let mut said = Instant::now();
    let mut written = Instant::now();
    loop {
        if cancel.is_stopped() {
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
            show(Event::Keep(keep));
        }
        if said.elapsed().as_millis() >= PROGRESS_EVERY_MS {
            said = Instant::now();
            show(Event::Progress(progress(&search, control, begun)));
        }
        let is_due = settings.write_every_secs.is_some_and(|s| written.elapsed().as_secs_f64() >= s);
        if is_due && search.stop_reason().is_none() && !cancel.is_stopped() {
            let found = found(brief, &search, &[]);
            so_far(found, progress(&search, control, begun), show)?;
            written = Instant::now();
        }
    }
    let mut confirmed = || {
        cancel.check()?;
        show(Event::Progress(Progress { stage: "confirm".into(), ..progress(&search, control, begun) }));
        elsewhere::elsewhere(brief, &search.outcome(), cancel)
    };
    let others = confirmed();
    if matches!(others, Err(Error::Stopped)) && cancel.keeps_best() {
        so_far(found(brief, &search, &[]), progress(&search, control, begun), show)?;
    }
    Ok(found(brief, &search, &others?))
}

/// Violation of what breaks a rule, as only a pinned option can: others are brought to what the rules allow.
const RULE_BROKEN: f64 = 1.0;

/// What vectors of free parameters are worth.
pub(crate) fn measured(brief: &Brief<'_>, vectors: &[Vec<f64>]) -> Vec<Evaluation> {
    let Brief { study, trial, settings, control, objectives, .. } = *brief;
    let layouts: Vec<Vec<f64>> = vectors.iter().map(|p| control.expand(p)).collect();
    let worths = trial.measure_all(&layouts);
    // A limit holds for the numbers that are shown.
    let has_limits = settings.limits.iter().any(|l| matches!(l.held, Held::Aim(_)));
    let here = (has_limits && !is_bare(settings)).then(|| study.measure_all(&layouts));
    let missed_here = |i: usize| {
        here.as_ref().map_or(0.0, |all| limits::missed(study, settings, &all[i]).iter().sum::<f64>())
    };
    let of = |(i, (worth, q)): (usize, (&Worth, &Vec<f64>))| {
        let found = evaluation(trial, settings, objectives, worth);
        let breach = if control.pinned_breaks(q) { RULE_BROKEN } else { 0.0 };
        Evaluation { violation: found.violation + breach + missed_here(i), ..found }
    };
    worths.par_iter().zip(vectors).enumerate().map(of).collect()
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

/// How alike the options are to the people in them: the median correlation of their maps of change.
fn likeness(study: &Study, made: &[Made]) -> Option<f64> {
    let maps: Vec<Experience> = made.iter().map(|m| Experience::of(study, &m.worth)).collect();
    let after = |i: usize| maps[i + 1..].iter().map(move |b| (i, b));
    let mut all: Vec<f64> = (0..maps.len()).flat_map(after).map(|(i, b)| maps[i].likeness(b)).collect();
    all.sort_by(f64::total_cmp);
    let (low, high) = (all.get((all.len().max(1) - 1) / 2)?, all.get(all.len() / 2)?);
    Some((low + high) / 2.0)
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

fn round_result(
    input: &Input<'_>,
    settings: &Settings,
    study: &Study,
    report: &Report,
    found: Option<&Found>,
    (made, best): (&[Made], Option<&Made>),
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
    let gains = found.map_or(&[][..], |f| &f.gains);
    let of = |(i, m): (usize, &Made)| {
        let told = (explanations.get(i).unwrap_or(&none), gains.get(i).cloned().unwrap_or_default());
        candidate(settings, study, &moves, &initial.mean, m, told)
    };
    let candidates = made.iter().enumerate().map(of).collect();
    let best = found.and_then(|f| f.best.as_ref()).zip(best).map(|(found, made)| {
        let of = candidate(settings, study, &moves, &initial.mean, made, (&none, found.gains.clone()));
        Best {
            file: of.file,
            parameters: of.parameters,
            mean: of.mean,
            penalty: of.penalty,
            score: of.score,
            gain: of.gain,
            words: of.words,
            option: found.option,
            changes: of.changes,
        }
    });
    RoundResult {
        schema: result::RESULT_SCHEMA.into(),
        version: enfilade_config::VERSION.into(),
        input: show::input(&study.base.plan, input),
        settings: settings_map,
        counts: show::counts(study, study.edges),
        spacing_m: study.spacing_m,
        lattice_centre: crate::lattice_centre(study),
        initial,
        moves,
        objectives: found.map_or(Vec::new(), |f| f.objectives.clone()),
        candidates,
        best,
        diversity: Diversity { likeness: likeness(study, made), ..distances(study, made) },
        evaluations: found.map_or(0, |f| f.evaluations),
        seconds: started.elapsed().as_secs_f64(),
        stopped_by: found
            .map_or("nothing may move: the present layout was measured".into(), |f| f.stopped_by.clone()),
        lineage: lineage(settings, &ruler(&study.base.plan, settings, study.spacing_m)),
        problems: report.problems.iter().map(Into::into).collect(),
        questions: Vec::new(),
    }
}

fn candidate(
    settings: &Settings,
    study: &Study,
    moves: &[MoveEntry],
    initial: &Numbers,
    made: &Made,
    (explanation, gain): (&Explanation, Gains),
) -> Candidate {
    let mean = show::mean_numbers(study, &made.worth);
    Candidate {
        file: format!("{}.{}", made.name, study.base.plan.format.name()),
        parameters: made.member.parameters.clone(),
        words: words::words(
            &words::by_north(moves, study.base.plan.north_deg),
            &made.member.parameters,
            &gains_words(study, initial, &mean, &gain),
            explanation,
        ) + &told::goes_along_words(&study.base, made)
            + &told::unseen_words(made)
            + &leaving::leaving_words(&study.base.plan, &made.layout)
            + &doors::narrowed_words(&study.base, &made.layout)
            + &told::stays_words(&made.report),
        explanation: explanation.clone(),
        mean,
        penalty: show::penalty_numbers(&made.worth),
        score: Some(study.score(&made.worth, settings)),
        gain,
        within_threshold: made.member.within_threshold && explanation.breaks.is_empty(),
        changes: changes(study, made),
    }
}

/// What is gained, in words: what was confirmed, else what was measured on the lattice shown.
pub(crate) fn gains_words(study: &Study, initial: &Numbers, mean: &Numbers, gain: &Gains) -> String {
    if gain.is_empty() {
        words::gains(&told(study, initial), &told(study, mean))
    } else {
        words::confirmed(initial, gain)
    }
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
    let entry = |entry: &enfilade_config::LineageTable| LineageEntry {
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

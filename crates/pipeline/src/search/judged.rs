//! What layouts are worth to the search, and which of those found are options.

use rayon::prelude::*;

use crate::measure::limits;
use crate::measure::study::Study;
use crate::measure::worth::Worth;
use crate::search::brief::{Aims, Brief, PENALTY_FREE, is_bare};
use crate::search::gain;
use crate::understand::faults::{CROSSING_FREE_M, is_gated};
use enfilade_config::{Aim, Held, Measure, Method, Mode, PairName, Penalty, Settings, Thresholds};
use enfilade_search::{Evaluation, Sense};

/// Threshold of the implied penalty objective of the published method: no option has more of it than the present layout.
/// To ask for less would pin every option to the few places where the penalty is least.
const PENALTY_THRESHOLD: f64 = 0.0;

/// Objectives in order; in the published method the penalty first unless `score` holds it. Elsewhere a penalty weighs
/// ([`weight`]).
pub(crate) fn objectives(settings: &Settings) -> Vec<(Aim, enfilade_search::Objective)> {
    let objective = |aim: Aim, is_max: bool, threshold: f64| {
        let o = enfilade_search::Objective {
            name: aim.to_string(),
            sense: if is_max { Sense::Max } else { Sense::Min },
            threshold,
            is_score: aim.measure == Measure::Score,
            is_penalty: aim.measure == Measure::Penalty,
        };
        (aim, o)
    };
    let mut out = Vec::new();
    let named = settings.objectives.iter().any(|o| !o.measure.measure.is_of_cells());
    if settings.method == Method::Paper && !named && !settings.penalties.is_empty() {
        out.push(objective(Aim::mean(Measure::Penalty), false, PENALTY_THRESHOLD));
    }
    out.extend(settings.objectives.iter().map(|o| objective(o.measure, o.is_max, o.threshold)));
    out
}

pub(crate) fn evaluation(
    study: &Study,
    settings: &Settings,
    objectives: &[(Aim, enfilade_search::Objective)],
    worth: &Worth,
) -> Evaluation {
    let value = |aim: Aim| match aim.measure {
        Measure::Score => study.score(worth, settings),
        Measure::Penalty => (study.penalty(worth, settings) - PENALTY_FREE).max(0.0),
        _ => study.value(worth, aim),
    };
    let missed: f64 = limits::missed(study, settings, worth).iter().sum();
    Evaluation {
        values: objectives.iter().map(|(aim, _)| value(*aim)).collect(),
        violation: worth.cut_off
            + missed
            + crossing_m(study, settings, worth)
            + worth.faults.sum()
            + hidden(study, settings, worth).len() as f64
            + loss(study, settings, objectives, worth),
        at: None,
    }
}

/// What a layout gains over the present one on the lattice of a study: the sum of its relative gains in all objectives.
pub(crate) fn gained(study: &Study, settings: &Settings, objectives: &Aims, worth: &Worth) -> f64 {
    let of = |worth: &Worth| evaluation(study, settings, objectives, worth).values;
    let all = objectives.iter().zip(of(worth).into_iter().zip(of(&study.initial)));
    let aims = all.filter(|((_, o), _)| !o.is_penalty);
    let gains = aims.map(|((_, o), (now, present))| gain::relative_gain(o.sense == Sense::Max, now, present));
    gains.sum::<f64>() - weight(study, settings, worth)
}

/// What the penalties of a layout weigh against its gains, beyond those of the present one: 1 as much as a gain of 100 %.
/// Nothing in the published method, and where the user made them an objective.
pub(crate) fn weight(study: &Study, settings: &Settings, worth: &Worth) -> f64 {
    let is_aim = settings.objectives.iter().any(|o| !o.measure.measure.is_of_cells());
    if is_aim || settings.method == Method::Paper {
        return 0.0;
    }
    let more = study.penalty(worth, settings) - study.penalty(&study.initial, settings);
    if more > PENALTY_FREE { more } else { 0.0 }
}

/// The pairs of regions of objectives, of the score where it is one, and of limits, of which nothing is seen any more, though it is at present; the unnamed one is
/// `None`. Measures of what is seen say nothing there: nobody who sees nothing is a view away from anything.
pub(crate) fn hidden(study: &Study, settings: &Settings, worth: &Worth) -> Vec<Option<PairName>> {
    let sees = |worth: &Worth, pair: Option<PairName>| study.seen_of(worth, pair).means.degree > 0.0;
    let is_scored = settings.objectives.iter().any(|o| o.measure.measure == Measure::Score)
        || settings.limits.iter().any(|l| l.held == Held::Aim(Aim::mean(Measure::Score)));
    let scored = settings.score.iter().filter(|(_, weight)| is_scored && *weight != 0.0).map(|(aim, _)| *aim);
    let limited = settings.limits.iter().filter_map(|l| match l.held {
        Held::Aim(aim) => Some(aim),
        Held::Penalty(_) => None,
    });
    let aims = settings.objectives.iter().map(|o| o.measure).chain(scored).chain(limited);
    let mut pairs: Vec<Option<PairName>> = aims.filter(|a| a.measure.is_of_cells()).map(|a| a.pair).collect();
    pairs.sort_unstable();
    pairs.dedup();
    pairs.retain(|p| sees(&study.initial, *p) && !sees(worth, *p));
    pairs
}

/// By how much walls run through each other only now, metres. Such a layout is not offered.
fn crossing_m(study: &Study, settings: &Settings, worth: &Worth) -> f64 {
    if settings.allow.crossings || !is_gated(&study.base, settings) {
        return 0.0;
    }
    (worth.penalty(Penalty::Overlap) - CROSSING_FREE_M).max(0.0)
}

/// A sum of losses up to this is no reason to look elsewhere: the way to a gain may lead through it.
const LOSS_FREE: f64 = 0.02;

/// What a layout loses over all objectives against the present one, penalties too, where it loses more than it gains and the
/// thresholds are not the user's own: lowered, they would admit it. Where the present layout breaks a limit,
/// keeping it is worth a loss.
fn loss(
    study: &Study,
    settings: &Settings,
    objectives: &[(Aim, enfilade_search::Objective)],
    worth: &Worth,
) -> f64 {
    let is_measure = |aim: &Aim| !matches!(aim.measure, Measure::Score | Measure::Penalty);
    let aims: Vec<_> = objectives.iter().filter(|(aim, _)| is_measure(aim)).collect();
    let breaks_limit = || limits::missed(study, settings, &study.initial).iter().any(|m| *m > 0.0);
    let weight = weight(study, settings, worth);
    if is_firm(settings) || aims.len() < 2 && weight == 0.0 || breaks_limit() {
        return 0.0;
    }
    let gain = |(aim, o): &&(Aim, enfilade_search::Objective)| {
        let is_more_better = o.sense == Sense::Max;
        gain::relative_gain(is_more_better, study.value(worth, *aim), study.value(&study.initial, *aim))
    };
    let gained = aims.iter().map(gain).sum::<f64>() - weight;
    if gained < -LOSS_FREE { -gained - LOSS_FREE } else { 0.0 }
}

/// Whether the user's own thresholds decide what is good: they are held, or the method is the paper's.
pub(crate) fn is_firm(settings: &Settings) -> bool {
    settings.thresholds == Thresholds::Firm || settings.method == Method::Paper
}

/// How many of the first options stay because the user pinned them.
pub(crate) fn pinned(settings: &Settings) -> usize {
    if settings.mode == Mode::Best || settings.method == Method::Paper { 0 } else { settings.pinned.len() }
}

/// Violation of what breaks a rule, as only a pinned option can: others are brought to what the rules allow.
pub(crate) const RULE_BROKEN: f64 = 1.0;

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

//! What a search found, in our terms: options, the best layout, the course of the search.

use rayon::prelude::*;

use crate::confirm::ideas::{apart, moves_visibly};
use crate::confirm::refined::{Refined, refined};
use crate::confirm::{confirmed, explain, nothing, withheld};
use crate::measure::study::Study;
use crate::search::brief::{Aims, Brief, PENALTY_FREE, is_bare};
use crate::search::judged::{evaluation, is_firm, pinned};
use crate::search::{gain, rules};
use enfilade_config::{Method, Mode, Settings};
use enfilade_overlay::Series;
use enfilade_overlay::measure::plain_name;
use enfilade_overlay::result::{self, Explanation, Gains, Objective, Sense};
use enfilade_search::Search;

/// What a search found, in our terms.
pub(crate) struct Found {
    pub(crate) members: Vec<enfilade_search::Member>,
    /// Of every member.
    pub(crate) explanations: Vec<Explanation>,
    /// Of every member; empty where nothing was confirmed.
    pub(crate) gains: Vec<Gains>,
    /// Members left out because they were almost the same as a better one.
    pub(crate) alike: usize,
    /// Members left out because they were no better than the present layout.
    pub(crate) unworthy: usize,
    /// Why the graphics card gave up while it was searched, if it did.
    pub(crate) card_trouble: Option<String>,
    /// Whether what is left is no better either.
    pub(crate) is_none_better: bool,
    /// Layouts left out because their gain was not confirmed.
    pub(crate) unconfirmed: usize,
    pub(crate) best: Option<FoundBest>,
    /// What the rules hold back of marked moves, where there are options all the same; empty where nothing.
    pub(crate) held_back: String,
    /// Why there is no option, where there is none.
    pub(crate) no_option: Option<String>,
    pub(crate) objectives: Vec<Objective>,
    /// What is left of the thresholds stated.
    pub(crate) threshold_share: f64,
    pub(crate) evaluations: u64,
    pub(crate) stopped_by: String,
    /// Whether the search had ended, and not merely been looked at on its way.
    pub(crate) has_ended: bool,
    pub(crate) series: Vec<Series>,
    /// Objective values of every layout measured that keeps the hard limits and does not lose far more than it gains.
    pub(crate) archive: Vec<Vec<f64>>,
}

impl Found {
    /// The parameters of all layouts that are shown, the best first.
    pub(crate) fn layouts(&self) -> Vec<Vec<f64>> {
        let best = self.best.iter().map(|b| &b.member);
        best.chain(&self.members).map(|m| m.parameters.clone()).collect()
    }
}

/// The best layout of all.
pub(crate) struct FoundBest {
    pub(crate) member: enfilade_search::Member,
    pub(crate) gains: Gains,
}

/// What a search found, and `others` that were looked for beside it: options and best layout with all their parameters,
/// explained.
pub(crate) fn found(brief: &Brief<'_>, search: &Search, others: &[enfilade_search::Point]) -> Found {
    let Brief { trial, settings, control, objectives, .. } = *brief;
    let outcome = search.outcome();
    let mut shown = shown(brief, &outcome);
    let goes_on = || "the search had not ended; this is the best so far".to_owned();
    let mut stopped_by = search.stop_reason().map_or_else(goes_on, |s| s.to_string());
    let is_unmet = outcome.best.violation > 0.0;
    let best = best_in_all(settings, &outcome, &shown);
    let is_best_better = is_better(settings, &shown, &best.values);
    let mut unworthy = 0;
    let mut out = if is_bare(settings) || is_unmet {
        let mut out = as_searched(brief, &outcome);
        let found = out.members.len();
        out.members = apart(brief.study, out.members);
        out.alike = outcome.alike + found - out.members.len();
        unworthy = keep_better(brief.study, settings, &shown, &mut out.members);
        if !is_unmet && is_best_better {
            out.best = Some((the_best(best, &|p| control.expand(p)), Gains::new()));
        }
        if settings.method == Method::Paper {
            confirm(brief, &mut out);
        }
        out
    } else if settings.mode == Mode::Best {
        let best = the_best(best, &|p| control.expand(p));
        let mut out =
            Refined { members: vec![best.clone()], best: Some((best, Gains::new())), ..Refined::default() };
        confirm(brief, &mut out);
        if !out.gains.iter().all(|g| confirmed::is_confirmed(objectives, g, settings.least_gain)) {
            out = Refined { unconfirmed: 1, ..Refined::default() };
        }
        out
    } else {
        refined(brief, &outcome, others, &shown)
    };
    let mut members = std::mem::take(&mut out.members);
    let mut threshold_share = outcome.threshold_share;
    if !is_bare(settings) && !is_firm(settings) {
        let pins = pinned(settings).min(members.len());
        threshold_share *= lower(&mut shown, &mut members[pins..]);
    }
    let is_none_better = unworthy > 0 && members.iter().all(|m| !is_better(settings, &shown, &m.values));
    let no_option = (members.is_empty() || is_unmet).then(|| {
        if !is_unmet {
            let nearest = control.expand(&best.parameters);
            let sure_gain = out.best.as_ref().and_then(|(_, g)| confirmed::sure_gain(objectives, g));
            return nothing::nothing_returned(
                brief,
                outcome.evaluations,
                (&nearest, is_best_better),
                sure_gain.unwrap_or_default(),
            );
        }
        let nearest = control.expand(&outcome.best.parameters);
        let worth = trial.measure(&nearest, &mut trial.bench());
        let missed = rules::missed_words(trial, settings, control, (&nearest, &worth));
        let text = format!(
            "no layout of the {} measured keeps every hard limit; the one that comes nearest misses {missed}",
            outcome.evaluations
        );
        stopped_by.push_str("; no layout keeps every hard limit");
        text
    });
    let best = out.best.map(|(mut member, gains)| {
        // Another layout that measures the same is no better: the best is among the options then.
        let option = members.iter().position(|m| m.parameters == member.parameters);
        let option = option.or_else(|| members.iter().position(|m| m.values == member.values));
        if let Some(i) = option {
            member.parameters.clone_from(&members[i].parameters);
        }
        FoundBest { member, gains }
    });
    let has_ended = search.stop_reason().is_some();
    // Whoever marks a move asks for it: the report must say why it was not done.
    let is_told = has_ended && no_option.is_none() && !brief.study.base.moves.are_default;
    Found {
        explanations: explanations(brief, &shown, &members),
        held_back: if is_told { withheld::words(brief) } else { String::new() },
        gains: out.gains,
        best,
        alike: out.alike,
        unconfirmed: out.unconfirmed,
        unworthy,
        card_trouble: trial.card_trouble().map(str::to_owned),
        is_none_better,
        no_option,
        objectives: shown,
        threshold_share,
        evaluations: outcome.evaluations,
        stopped_by,
        has_ended,
        series: series(&outcome, objectives),
        archive: outcome.archive.iter().filter(|p| p.violation == 0.0).map(|p| p.values.clone()).collect(),
        members,
    }
}

/// The objectives as results tell them where nothing was searched.
pub(crate) fn as_drawn((study, settings): (&Study, &Settings), objectives: &Aims) -> Vec<Objective> {
    let initial = evaluation(study, settings, objectives, &study.initial);
    let one = |((_, o), initial): (&(_, enfilade_search::Objective), f64)| Objective {
        name: o.name.clone(),
        sense: o.sense,
        threshold: o.threshold,
        initial,
        best: None,
        reachable: None,
        limit: None,
        free: o.is_penalty.then_some(PENALTY_FREE),
    };
    objectives.iter().zip(initial.values).map(one).collect()
}

/// The objectives as results tell them.
pub(crate) fn shown(brief: &Brief<'_>, outcome: &enfilade_search::Outcome<'_>) -> Vec<Objective> {
    let Brief { trial, settings, objectives, .. } = *brief;
    let initial = evaluation(trial, settings, objectives, &trial.initial);
    let one = |(i, (_, o)): (usize, &(_, enfilade_search::Objective))| Objective {
        name: o.name.clone(),
        sense: o.sense,
        threshold: o.threshold * outcome.threshold_share,
        initial: initial.values[i],
        best: best_of(outcome, i, o.sense),
        reachable: outcome.reachable[i],
        // No −0, which would be written so.
        limit: outcome.reachable[i].map(|_| outcome.thresholds[i] + 0.0),
        free: o.is_penalty.then_some(PENALTY_FREE),
    };
    objectives.iter().enumerate().map(one).collect()
}

/// Lowers the limits of thresholds that nobody stated to what the options keep; what is left of the gains that they stood for,
/// of the objective that gave up most.
fn lower(shown: &mut [Objective], members: &mut [enfilade_search::Member]) -> f64 {
    let mut left: f64 = 1.0;
    for (j, o) in shown.iter_mut().enumerate().filter(|(_, o)| o.name != "penalty") {
        let kept = o.limit_with(members.iter().map(|m| m.values[j]));
        let (Some(limit), Some(kept)) = (o.limit, kept) else { continue };
        if kept != limit && limit != o.initial {
            left = left.min(((kept - o.initial) / (limit - o.initial)).clamp(0.0, 1.0));
        }
        o.limit = Some(kept);
    }
    members.iter_mut().for_each(|m| m.within_threshold = true);
    left
}

/// The options as the search itself chose them, those that break a limit only where they were pinned.
fn as_searched(brief: &Brief<'_>, outcome: &enfilade_search::Outcome<'_>) -> Refined {
    let mut members = outcome.members.clone();
    let pinned = pinned(brief.settings).min(members.len());
    let mut at = 0..;
    members.retain(|m| at.next().is_some_and(|i: usize| i < pinned) || m.violation == 0.0);
    for m in &mut members {
        m.parameters = brief.control.expand(&m.parameters);
    }
    Refined { members, ..Refined::default() }
}

/// Tells what options and best gain, as confirmed.
fn confirm(brief: &Brief<'_>, out: &mut Refined) {
    let layouts = out.members.iter().chain(out.best.iter().map(|b| &b.0));
    let layouts: Vec<Vec<f64>> = layouts.map(|m| m.parameters.clone()).collect();
    out.gains = confirmed::gains(brief.study, brief.settings, brief.objectives, &layouts);
    if let Some(best) = &mut out.best {
        best.1 = out.gains.pop().unwrap_or_default();
    }
}

fn is_better(settings: &Settings, objectives: &[Objective], values: &[f64]) -> bool {
    let weight = settings.score.iter().map(|(_, w)| w.abs()).fold(0.0, f64::max);
    gain::is_better(objectives, values, is_firm(settings), weight)
}

/// The layout that keeps hard limits and thresholds and gains most in all, as options are ordered; a single objective has
/// its own. The paper's algorithms do not look for it among what they measure after their first stages.
fn best_in_all<'a>(
    settings: &Settings,
    outcome: &'a enfilade_search::Outcome<'_>,
    objectives: &[Objective],
) -> &'a enfilade_search::Point {
    let aims = objectives.iter().filter(|o| o.name != "penalty").count();
    if settings.method != Method::Paper && aims < 2 {
        return &outcome.best;
    }
    let keeps = |p: &enfilade_search::Point| {
        let sides = objectives.iter().zip(&p.values).zip(&outcome.thresholds);
        p.violation == 0.0
            && sides.into_iter().all(|((o, v), t)| if o.sense == Sense::Max { v >= t } else { v <= t })
    };
    let gain = |p: &enfilade_search::Point| gain::total_gain(objectives, &p.values);
    let kept = outcome.archive.iter().filter(|p| keeps(p));
    kept.fold(&outcome.best, |best, p| if gain(p) > gain(best) { p } else { best })
}

/// The one option of mode best.
fn the_best(point: &enfilade_search::Point, whole: &dyn Fn(&[f64]) -> Vec<f64>) -> enfilade_search::Member {
    enfilade_search::Member {
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
    members: &mut Vec<enfilade_search::Member>,
) -> usize {
    let pinned = pinned(settings).min(members.len());
    let mut free = members.split_off(pinned);
    free.retain(|m| moves_visibly(study, &m.parameters));
    let gain = |m: &enfilade_search::Member| gain::total_gain(objectives, &m.values);
    free.sort_by(|a, b| gain(b).total_cmp(&gain(a)));
    if settings.method == Method::Paper {
        members.append(&mut free);
        return 0;
    }
    let worthy = free.iter().filter(|m| is_better(settings, objectives, &m.values));
    let better: Vec<enfilade_search::Member> = worthy.cloned().collect();
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
    brief: &Brief<'_>,
    shown: &[Objective],
    members: &[enfilade_search::Member],
) -> Vec<Explanation> {
    let Brief { trial: study, settings, control, objectives, .. } = *brief;
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
fn best_of(outcome: &enfilade_search::Outcome<'_>, objective: usize, sense: Sense) -> Option<f64> {
    let values = outcome.archive.iter().filter(|p| p.violation == 0.0).map(|p| p.values[objective]);
    let better = |a: f64, b: f64| if sense == Sense::Max { a.max(b) } else { a.min(b) };
    values.reduce(better)
}

/// The course of the search: the best value of every objective among the layouts that keep the hard limits,
/// and, once options spread, how far the two most alike stand apart.
fn series(outcome: &enfilade_search::Outcome<'_>, objectives: &Aims) -> Vec<Series> {
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
fn course(outcome: &enfilade_search::Outcome<'_>, objective: usize, sense: Sense) -> Vec<(u64, f64)> {
    let mut points: Vec<(u64, f64)> = vec![];
    for (i, p) in outcome.archive.iter().enumerate().filter(|(_, p)| p.violation == 0.0) {
        let value = p.values[objective];
        let is_better = |best: f64| if sense == Sense::Max { value > best } else { value < best };
        if value.is_finite() && points.last().is_none_or(|(_, best)| is_better(*best)) {
            points.push((i as u64 + 1, value));
        }
    }
    points
}

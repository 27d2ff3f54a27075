//! Why there is no option, and what narrows the search.

use std::collections::BTreeSet;

use crate::confirm::withheld;
use crate::measure::study::Study;
use crate::search::brief::{Brief, is_bare};
use crate::search::gain::LEAST_GAIN;
use crate::search::judged::is_firm;
use enfilade_config::{Method, Settings};
use enfilade_overlay::measure::{fixed, sentence_case, trimmed};
use enfilade_overlay::words::listed;
use enfilade_overlay::works::LEAST_SHOWN;
use enfilade_report::counted;

/// That nothing measured is better, and what would be called so: the best may well gain less than that.
pub(crate) fn none_better(measured: &str, is_firm: bool) -> String {
    let least = fixed(LEAST_GAIN * 100.0, 1);
    let others = if is_firm { "" } else { " and lose less in the others" };
    format!(
        "No layout is better than the present one. Better is: gain {least} % or more in an objective{others}. {measured} measured."
    )
}

/// Why there is no option although layouts keep every hard limit: nothing that was measured surely gains enough, or the
/// published method returned nothing that moves.
pub(crate) fn nothing_returned(
    brief: &Brief<'_>,
    evaluations: u64,
    (best, is_best_better): (&[f64], bool),
    sure_gain: f64,
) -> String {
    let settings = brief.settings;
    let measured = counted(evaluations, "layout");
    if !is_bare(settings) {
        let least = trimmed(settings.least_gain * 100.0, 2);
        return format!(
            "No layout improves the present one by {least} % or more. {measured} measured; the best of them were measured \
             again on other lattices.{} {}",
            smaller_gain(sure_gain),
            what_limits(brief, best)
        );
    }
    if !is_best_better {
        return none_better(&measured, is_firm(settings));
    }
    let method = if settings.method == Method::Paper { "The published method" } else { "The search" };
    format!(
        "{method} returned no layout in which something moves. The best of {measured} measured is better than the present one: \
         `accept FILE best` takes it."
    )
}

/// How to take the best layout and see others like it, where it surely gains more than a trifle, in tenths of a per cent.
pub(crate) fn smaller_gain(share: f64) -> String {
    match (share * 1000.0).floor() / 10.0 {
        percent if share >= LEAST_SHOWN && percent.is_finite() => format!(
            " The best layout found surely gains {percent} %: `accept FILE best` takes it. `--least-gain {percent}%` shows \
             others like it."
        ),
        _ => String::new(),
    }
}

/// What limits the search: what may move, and what to allow next.
pub(crate) fn what_limits(brief: &Brief<'_>, best: &[f64]) -> String {
    let names = group_names(brief.study);
    let walls = brief.study.base.plan.walls.len();
    let moving = brief.study.base.moves.walls.len();
    let who = match names.as_slice() {
        few if few.len() <= GROUPS_TOLD => listed(few, "and"),
        many => format!("{} groups", many.len()),
    };
    let bounds = at_bounds(brief.study, best);
    let bounds = match bounds.as_slice() {
        [] => String::new(),
        few if few.len() <= GROUPS_TOLD => {
            format!(" At their bounds in the best layout: {}.", listed(few, "and"))
        }
        many => format!(" At their bounds in the best layout: {} moves.", many.len()),
    };
    format!(
        "May move: {who} ({moving} of {walls} wall elements). All others are fixed.{}{bounds}{} Add {}, or \
         wider bounds in them.",
        rules_clause(brief.settings, names.len()),
        withheld::words(brief),
        brief.study.base.plan.format.marking().more
    )
}

/// A move this near to its bound, as a share of its range, stands at it.
pub(crate) const AT_BOUND: f64 = 0.01;

/// What moves in a layout as far as it may.
pub(crate) fn at_bounds(study: &Study, layout: &[f64]) -> Vec<String> {
    let moves = &study.base.moves;
    let is_at = |(value, [lo, hi]): (&f64, &[f64; 2])| (value - lo).min(hi - value) <= AT_BOUND * (hi - lo);
    let bounds = moves.bounds();
    let held = layout.iter().zip(&bounds).map(is_at).zip(&moves.parameters);
    let moved = layout.iter().zip(moves.identity()).map(|(value, still)| *value != still);
    let names: BTreeSet<String> = (held.zip(moved))
        .filter(|((is_at, _), is_moved)| *is_at && *is_moved)
        .map(|((_, p), _)| sentence_case(&p.group_name))
        .collect();
    names.into_iter().collect()
}

/// Groups that may move up to which they are told by name.
pub(crate) const GROUPS_TOLD: usize = 3;

/// The groups that may move, each once.
pub(crate) fn group_names(study: &Study) -> Vec<String> {
    let mut names: Vec<String> = vec![];
    for p in &study.base.moves.parameters {
        let name = sentence_case(&p.group_name);
        if !names.contains(&name) {
            names.push(name);
        }
    }
    names
}

/// The settings that narrow what options may do: a sentence; empty without any.
pub(crate) fn rules_clause(settings: &Settings, groups: usize) -> String {
    let rules = rules_words(settings, groups);
    if rules.is_empty() { rules } else { format!(" These settings narrow it: {rules}.") }
}

/// The rules of the user that narrow what options may do, as they are stated; empty without any. So many moves as there are
/// groups narrow nothing.
pub(crate) fn rules_words(settings: &Settings, groups: usize) -> String {
    let most = settings.most_moves.filter(|n| *n < groups).map(|n| format!("--most-moves {n}"));
    let snap = settings.snap.map(|s| format!("--snap \"{s}\"{}", s.metres_words()));
    let limits = settings.limits.iter().map(|l| format!("--limit \"{l}\""));
    let like = settings.like.as_ref().map(|_| "--like".to_owned());
    most.into_iter().chain(snap).chain(limits).chain(like).collect::<Vec<_>>().join(", ")
}

/// What may hold layouts back besides thresholds, where anything does: rules that are asked for here or were taken over from
/// the round before, and weights of penalties beside them.
pub(crate) fn held_back(settings: &Settings, groups: usize) -> String {
    let rules = rules_words(settings, groups);
    if rules.is_empty() {
        return rules;
    }
    let penalties = settings.penalty_text();
    let also = if penalties == "none" { String::new() } else { format!(", --penalty \"{penalties}\"") };
    format!(" These settings may be the reason: {rules}{also}.")
}

#[cfg(test)]
mod tests {
    use super::*;
    use enfilade_config::Partial;

    #[test]
    fn a_gain_too_small_to_be_shown_is_said_with_what_shows_it() {
        assert!(["gains 0.5 %", "--least-gain 0.5%"].iter().all(|s| smaller_gain(0.00578).contains(s)));
        assert_eq!(
            (smaller_gain(0.0009), smaller_gain(0.0), smaller_gain(f64::INFINITY)),
            Default::default()
        );
    }

    #[test]
    fn what_may_hold_layouts_back_is_named_as_no_more_than_that() {
        let with = |edit: &dyn Fn(&mut Partial)| {
            let mut p = Partial::default();
            edit(&mut p);
            Settings::new(p).unwrap()
        };
        assert_eq!(
            (held_back(&with(&|_| ()), 3), rules_clause(&with(&|_| ()), 3)),
            (String::new(), String::new())
        );
        let ruled = with(&|p| {
            p.limit = Some("degree -50%".into());
            p.penalty = Some("clearance 1".into());
        });
        let said = held_back(&ruled, 3);
        assert!(
            ["--limit \"degree -50%\"", "--penalty \"clearance 1\""].iter().all(|s| said.contains(s)),
            "{said}"
        );
        let few = with(&|p| p.most_moves = Some(3));
        assert_eq!((rules_clause(&few, 3), rules_clause(&few, 4).is_empty()), (String::new(), false));
        assert!(rules_clause(&ruled, 3).contains("--limit \"degree -50%\""));
    }
}

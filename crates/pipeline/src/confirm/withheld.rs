//! What the rules hold back: better layouts that a builder would refuse, and structure that stays.

use std::collections::BTreeMap;

use crate::confirm::confirmed::gains;
use crate::measure::worth::Worth;
use crate::search::brief::Brief;
use crate::search::judged::{evaluation, gained};
use crate::search::rules::control_as_stated;
use crate::understand::faults::{Faults, is_gated};
use enfilade_config::{Allow, Settings};
use enfilade_overlay::measure::trimmed;
use enfilade_overlay::words::listed;
use enfilade_report::counted;

/// Where in its bounds each move is tried alone, from the lower to the upper.
const TRIED_AT: [f64; 4] = [0.0, 0.25, 0.75, 1.0];

/// A rule that can be given up.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Rule {
    Joints,
    Crossings,
    Ways,
    Things,
}

impl Rule {
    /// The rules that a layout breaks, in their order.
    fn broken(faults: Faults, crosses: bool) -> Vec<Self> {
        let Faults { opened_m, narrowed_m, struck, vanished: _ } = faults;
        let broken = [
            (opened_m > 0.0, Self::Joints),
            (crosses, Self::Crossings),
            (narrowed_m > 0.0, Self::Ways),
            (struck > 0, Self::Things),
        ];
        broken.into_iter().filter(|(is_broken, _)| *is_broken).map(|(_, rule)| rule).collect()
    }

    /// What a move would do that breaks it, and the word that permits that.
    fn words(self) -> [&'static str; 2] {
        match self {
            Self::Joints => ["open a joint", "open-joints"],
            Self::Crossings => ["run walls through each other", "crossings"],
            Self::Ways => ["leave a way below 0.9 m", "narrow-ways"],
            Self::Things => ["run into something that stands there", "things"],
        }
    }
}

/// What of the rules keeps moves from options, with the word that permits it; empty where nothing does.
pub(crate) fn words(brief: &Brief<'_>) -> String {
    let base = &brief.study.base;
    if !is_gated(base, brief.settings) {
        return String::new();
    }
    // Marks move structure all the same.
    told(&held(brief), if base.moves.are_default { base.plan.bearing.len() } else { 0 })
}

/// What a rule holds back.
#[derive(Clone, Debug, Default, PartialEq)]
struct Held {
    /// Single moves that gain enough on the lattice shown.
    count: u64,
    /// What the best of them surely gains, a share.
    surely: f64,
}

/// Moves of each rule that are measured again: advice that does not help when it is followed is none.
const TRIED_AGAIN: usize = 2;

/// What the rules hold back, by all of them that a move breaks.
///
/// Each move is tried alone on the lattice shown. Counted are those that gain what an option must and break these rules and
/// nothing else: the words that permit them are then enough. Measured again on the lattices that options are confirmed on,
/// rules are left out if their best move does not surely gain that.
fn held(brief: &Brief<'_>) -> BTreeMap<Vec<Rule>, Held> {
    let Brief { study, settings, objectives, .. } = brief;
    // Ways that end at what a rule forbids are tried as far as they were stated.
    let Ok(control) = control_as_stated(&study.base, settings) else { return BTreeMap::new() };
    let start = control.start();
    let alone = |(i, [lo, hi]): (usize, [f64; 2])| {
        let at = |t: f64| {
            let mut q = start.clone();
            q[i] = lo + t * (hi - lo);
            control.expand(&control.permit(&q))
        };
        TRIED_AT.map(at)
    };
    let vectors: Vec<Vec<f64>> = control.bounds().into_iter().enumerate().flat_map(alone).collect();
    let crossing = Settings { allow: Allow { crossings: true, ..settings.allow }, ..(*settings).clone() };
    let mut found: BTreeMap<Vec<Rule>, Vec<(f64, usize)>> = BTreeMap::new();
    for (i, worth) in study.measure_all(&vectors).into_iter().enumerate() {
        let lawful = Worth { faults: Faults::default(), ..worth.clone() };
        let violation = |settings: &Settings| evaluation(study, settings, objectives, &lawful).violation;
        let is_kept_else = violation(&crossing) == 0.0;
        let gain = gained(study, settings, objectives, &worth);
        if !is_kept_else || gain < settings.least_gain {
            continue;
        }
        let rules = Rule::broken(worth.faults, violation(settings) > 0.0);
        if !rules.is_empty() {
            found.entry(rules).or_default().push((gain, i));
        }
    }
    let sure = |(rules, mut moves): (Vec<Rule>, Vec<(f64, usize)>)| {
        moves.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let best: Vec<Vec<f64>> = moves.iter().take(TRIED_AGAIN).map(|m| vectors[m.1].clone()).collect();
        let asked: Vec<&str> =
            objectives.iter().filter(|(_, o)| !o.is_penalty).map(|(_, o)| o.name.as_str()).collect();
        let again = gains(study, settings, objectives, &best);
        let lows = again.iter().flat_map(|g| asked.iter().filter_map(|name| Some(g.get(*name)?.low)));
        let surely = lows.fold(0.0, f64::max);
        (surely >= settings.least_gain).then_some((rules, Held { count: moves.len() as u64, surely }))
    };
    found.into_iter().filter_map(sure).collect()
}

/// The same in words, and how many walls of the structure stay.
fn told(held: &BTreeMap<Vec<Rule>, Held>, structure: usize) -> String {
    let mut out = String::new();
    for (rules, Held { count, surely }) in held {
        let [would, words] =
            [0, 1].map(|k| rules.iter().map(|r| r.words()[k].to_owned()).collect::<Vec<_>>());
        let (would, word) = (listed(&would, "and"), words.join(", "));
        let word = if rules.len() > 1 { format!("\"{word}\"") } else { word };
        // Down to the last tenth: what is sure is never rounded up.
        let percent = trimmed((surely * 1e3).floor() / 10.0, 1);
        out += &format!(
            " {} that may gain enough would {would}; the best surely gains {percent} %. `--allow {word}` permits that.",
            counted(*count, "single move")
        );
    }
    if structure > 0 {
        out += &format!(" Walls of the structure that stay: {structure}. `--allow structure` frees them.");
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_move_counts_for_the_rules_that_it_breaks() {
        let none = Faults::default();
        let cases = [
            (Faults { opened_m: 0.1, ..none }, false, vec![Rule::Joints]),
            (none, true, vec![Rule::Crossings]),
            (Faults { narrowed_m: 0.1, ..none }, false, vec![Rule::Ways]),
            (Faults { struck: 2, ..none }, false, vec![Rule::Things]),
            (none, false, vec![]),
            (Faults { struck: 1, ..none }, true, vec![Rule::Crossings, Rule::Things]),
            (Faults { opened_m: 0.1, narrowed_m: 0.1, ..none }, false, vec![Rule::Joints, Rule::Ways]),
        ];
        for (faults, crosses, rules) in cases {
            assert_eq!(Rule::broken(faults, crosses), rules, "{faults:?} {crosses}");
        }
    }

    #[test]
    fn each_rule_is_told_with_its_count_and_the_word_that_permits_it() {
        let permitted = |rule: Rule, allow: Allow| match rule {
            Rule::Joints => allow.open_joints,
            Rule::Crossings => allow.crossings,
            Rule::Ways => allow.narrow_ways,
            Rule::Things => allow.things,
        };
        for rule in [Rule::Joints, Rule::Crossings, Rule::Ways, Rule::Things] {
            let [would, word] = rule.words();
            let allow: Allow = word.parse().unwrap();
            assert!(permitted(rule, allow) && allow.to_string() == word, "{rule:?}: {allow}");
            let said = told(&BTreeMap::from([(vec![rule], Held { count: 7, surely: 0.0399 })]), 0);
            assert!(
                said.starts_with(" 7 single moves ")
                    && said.contains("surely gains 3.9 %")
                    && said.contains(would)
                    && said.contains(&format!("`--allow {word}`")),
                "{said}"
            );
        }
        assert_eq!(told(&BTreeMap::new(), 0), "");
        let said = told(&BTreeMap::from([(vec![Rule::Ways], Held { count: 1, surely: 0.02 })]), 3);
        assert!(said.contains(" 1 single move ") && said.contains("stay: 3. `--allow structure`"), "{said}");
        assert!("structure".parse::<Allow>().unwrap().structure);
        let both = vec![Rule::Joints, Rule::Ways];
        let said = told(&BTreeMap::from([(both, Held { count: 2, surely: 0.034 })]), 0);
        assert!(said.contains("would open a joint and leave a way below 0.9 m"), "{said}");
        assert!(said.contains("`--allow \"open-joints, narrow-ways\"`"), "{said}");
    }
}

//! Many random studies: whatever the bounds, rules and objectives, no option breaks a hard limit.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::*;

/// Random studies that are searched.
const STUDIES: u64 = 10_000;
/// Most evaluations of one: enough to climb and to spread in a few dimensions.
const MOST_EVALUATIONS: u64 = 48;

/// Fewer candidates a proposal: what is tested does not depend on how many the models screen.
fn quick() -> Tuning {
    Tuning {
        candidates: 24,
        spread_candidates: 24,
        neighbours: 24,
        spread_neighbours: 24,
        ..Tuning::default()
    }
}

/// What a random study forbids.
#[derive(Clone, Copy, Debug)]
enum Rule {
    Nothing,
    /// All but a slab across the first parameter.
    HalfSpace(f64),
    /// All but a ball of this radius, in widths, around the middle.
    Ball(f64),
    /// Everything.
    All,
    /// A part of the box has no values at all.
    Unmeasurable(f64),
}

#[derive(Debug)]
struct Case {
    study: Study,
    rule: Rule,
    /// Parameters are measured on multiples of this, if not 0.
    module: f64,
}

fn between(rng: &mut ChaCha8Rng, [lower, upper]: [f64; 2]) -> f64 {
    (lower + rng.random::<f64>() * (upper - lower)).clamp(lower, upper)
}

fn point(rng: &mut ChaCha8Rng, bounds: &[[f64; 2]]) -> Vec<f64> {
    bounds.iter().map(|b| between(rng, *b)).collect()
}

fn random_objective(rng: &mut ChaCha8Rng) -> Objective {
    let sense = if rng.random::<bool>() { Sense::Max } else { Sense::Min };
    let threshold = [0.0, 0.3, 0.7, 1.0][rng.random_range(0..4usize)];
    let (is_score, is_penalty) = [(true, false), (false, true), (false, false)][rng.random_range(0..3usize)];
    Objective { threshold, is_penalty, ..objective("a", sense, is_score) }
}

fn case(seed: u64) -> Case {
    let rng = &mut ChaCha8Rng::seed_from_u64(seed);
    let dims = rng.random_range(1..7usize);
    let width = |rng: &mut ChaCha8Rng| {
        if rng.random::<f64>() < 0.1 { 0.0 } else { 10f64.powf(between(rng, [-3.0, 3.0])) }
    };
    let bounds: Vec<[f64; 2]> = (0..dims)
        .map(|_| {
            let lower = between(rng, [-50.0, 50.0]);
            [lower, lower + width(rng)]
        })
        .collect();
    let members = rng.random_range(1..7usize);
    let seeds: Vec<Vec<f64>> = (0..rng.random_range(0..4usize)).map(|_| point(rng, &bounds)).collect();
    let study = Study {
        start: point(rng, &bounds),
        objectives: (0..rng.random_range(1..4usize)).map(|_| random_objective(rng)).collect(),
        members,
        seed,
        evaluations: Some(rng.random_range(1..=MOST_EVALUATIONS)),
        least_share: if rng.random::<f64>() < 0.3 { rng.random::<f64>() } else { 1.0 },
        method: if rng.random::<f64>() < 0.1 { Method::Paper } else { Method::Default },
        mode: if rng.random::<f64>() < 0.1 { Mode::Best } else { Mode::Diverse },
        batch: rng.random_range(1..6usize),
        pinned: if members > 1 { rng.random_range(0..=seeds.len().min(members - 1)) } else { 0 },
        seeds,
        bounds,
        ..study(dims, 1)
    };
    let part = rng.random::<f64>();
    let rule = [Rule::Nothing, Rule::HalfSpace(part), Rule::Ball(part), Rule::All, Rule::Unmeasurable(part)]
        [rng.random_range(0..5usize)];
    let module = if rng.random::<f64>() < 0.2 { 0.25 } else { 0.0 };
    // What is pinned is measured in any case: fewer evaluations are refused.
    let evaluations = study.evaluations.map(|e| e.max(1 + study.pinned as u64));
    Case { study: Study { evaluations, ..study }, rule, module }
}

impl Case {
    /// The nearest point on the module that is inside the bounds.
    fn permit(&self, p: &[f64]) -> Vec<f64> {
        let snap = |(x, [lower, upper]): (&f64, &[f64; 2])| {
            let snapped = if self.module > 0.0 { (x / self.module).round() * self.module } else { *x };
            snapped.clamp(*lower, *upper)
        };
        p.iter().zip(&self.study.bounds).map(snap).collect()
    }

    fn evaluate(&self, p: &[f64]) -> Evaluation {
        let at = self.permit(p);
        let unit: Vec<f64> = at
            .iter()
            .zip(&self.study.bounds)
            .map(|(x, [a, b])| if b > a { (x - a) / (b - a) } else { 0.0 })
            .collect();
        let off: f64 = unit.iter().map(|u| (u - 0.5).powi(2)).sum::<f64>().sqrt();
        let violation = match self.rule {
            Rule::Nothing => 0.0,
            Rule::HalfSpace(part) => (unit[0] - part).max(0.0),
            Rule::Ball(part) => (off - 0.5 * part).max(0.0),
            Rule::All => 1.0 + off,
            Rule::Unmeasurable(part) => {
                if unit[unit.len() - 1] > part {
                    f64::NAN
                } else {
                    0.0
                }
            }
        };
        let value = |j: usize| unit.iter().map(|u| (7.0 * u + j as f64).sin()).sum::<f64>();
        let values = (0..self.study.objectives.len()).map(value).collect();
        Evaluation { values, violation, at: (self.module > 0.0).then_some(at) }
    }

    fn search(&self) -> Search {
        let mut search = Search::with_tuning(self.study.clone(), quick()).unwrap();
        loop {
            let asked = search.ask();
            if asked.is_empty() {
                return search;
            }
            let told: Vec<Evaluation> = asked.iter().map(|p| self.evaluate(p)).collect();
            search.tell(&told);
        }
    }

    /// How many of the first members stay whatever they are worth.
    fn pinned(&self) -> usize {
        let holds = self.study.method == Method::Default && self.study.mode == Mode::Diverse;
        if holds { self.study.pinned } else { 0 }
    }

    fn is_inside(&self, p: &[f64]) -> bool {
        p.iter().zip(&self.study.bounds).all(|(x, [lower, upper])| x >= lower && x <= upper)
    }
}

/// Limits that nobody may lower are shares of what was found until the end: the best of every objective among all
/// points that keep the limits before it, and no less than the share stated of the gain over the present layout.
fn assert_firm(case: &Case, outcome: &Outcome<'_>) {
    let objectives = &case.study.objectives;
    let gain = |j: usize, v: f64| objectives[j].sense.gain(v);
    let keeps = |p: &Point, j: usize| gain(j, p.values[j]) >= gain(j, outcome.thresholds[j]);
    let mut kept: Vec<&Point> = outcome.archive.iter().filter(|p| p.violation == 0.0).collect();
    for (j, o) in objectives.iter().enumerate() {
        let best = kept.iter().map(|p| gain(j, p.values[j])).reduce(f64::max);
        assert_eq!(best, outcome.reachable[j].map(|v| gain(j, v)), "objective {j} of {case:?}");
        let Some(best) = best else { return };
        let present = gain(j, outcome.archive[0].values[j]);
        if !o.is_score && !o.is_penalty && best > present + 1e-9 {
            let range = (best - present).max(0.02 * present.abs());
            let least = best - (1.0 - o.threshold) * range;
            assert!(gain(j, outcome.thresholds[j]) >= least - 1e-9, "objective {j} of {case:?}");
        }
        kept.retain(|p| keeps(p, j));
    }
}

/// Every option of every study lies inside the bounds, was measured, and keeps the hard limits (by the default
/// method the thresholds too); a study without options has met no layout that keeps the limits, and says what
/// comes nearest.
#[test]
fn every_member_keeps_the_hard_limits_or_none_is_known() {
    for seed in 0..STUDIES {
        let case = case(seed);
        let search = case.search();
        let outcome = search.outcome();
        let is_permitted = |p: &Point| p.violation == 0.0;
        assert!(search.stop_reason().is_some(), "{case:?}");
        assert!(outcome.archive.iter().all(|p| case.is_inside(&p.parameters)), "{case:?}");
        assert!(outcome.members.len() <= case.study.members, "{case:?}");
        if outcome.members.is_empty() {
            assert!(!outcome.archive.iter().any(is_permitted), "a permitted layout was met: {case:?}");
            assert!(outcome.best.violation > 0.0, "{case:?}");
        }
        if case.study.method == Method::Default && case.study.least_share >= 1.0 {
            assert_firm(&case, &outcome);
        }
        for (m, member) in outcome.members.iter().enumerate() {
            assert!(outcome.archive.iter().any(|p| p.parameters == member.parameters), "{case:?}");
            if m >= case.pinned() {
                assert!(member.violation == 0.0, "{member:?} of {case:?}");
                let is_default = case.study.method == Method::Default;
                assert!(member.within_threshold || !is_default, "{member:?} of {case:?}");
            }
        }
    }
}

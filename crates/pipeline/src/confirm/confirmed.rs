//! What is promised: gains measured afresh, on lattices that the search has not used.

use std::collections::BTreeMap;

use rayon::prelude::*;

use crate::measure::estimate::{Sampled, interval};
use crate::measure::lattices;
use crate::measure::study::Study;
use crate::measure::worth::Worth;
use crate::search::brief::Aims;
use crate::search::gain::relative_gain;
use crate::search::judged::hidden;
use enfilade_config::{Aim, Measure, Settings};
use enfilade_overlay::result::{Gain, Gains, Interval};
use enfilade_search::Sense;

/// Lattices of either spacing with which somebody else would measure again.
const AGAIN: f64 = 2.0;
/// Share of all pairs of cells that may lose each other on a lattice without a layout being held to cut space off: a niche of
/// one cell behind a gap as wide as a cell.
const CUT_OFF_FREE: f64 = 1e-3;
/// Where extrapolation from a spacing and half of it lies beyond the finer mean, in their difference.
const REACH: f64 = 1.0;

/// Measures on the lattices of a study, in a fixed order.
pub(crate) type Measured<'a> = dyn Fn(&Study) -> Vec<Worth> + Sync + 'a;

/// The measures whose gains are told, with whether more is better: what is asked for, then what everybody asks.
fn measures(objectives: &Aims) -> Vec<(Aim, bool)> {
    let mut out: Vec<(Aim, bool)> = Vec::new();
    let asked = objectives.iter().filter(|(_, o)| !o.is_penalty).map(|(a, o)| (*a, o.sense == Sense::Max));
    let usual = [(Aim::mean(Measure::Degree), true), (Aim::mean(Measure::Entropy), true)];
    for (aim, is_more_better) in asked.chain(usual) {
        if out.iter().all(|(known, _)| *known != aim) {
            out.push((aim, is_more_better));
        }
    }
    out
}

/// Gains of layouts over the present one, as [`gains_of`].
pub(crate) fn gains(
    study: &Study,
    settings: &Settings,
    objectives: &Aims,
    layouts: &[Vec<f64>],
) -> Vec<Gains> {
    gains_of(study, settings, objectives, layouts.len(), &|on| on.measure_all(layouts))
}

/// Gains over the present layout of whatever a study can measure, so many of them, with their 95 % intervals; none of a
/// measure that too few lattices can tell.
///
/// The interval of [`interval`] holds what either spacing measures, the extrapolation to none, and what two lattices of
/// either would show if somebody measured again.
pub(crate) fn gains_of(
    study: &Study,
    settings: &Settings,
    objectives: &Aims,
    count: usize,
    measured: &Measured<'_>,
) -> Vec<Gains> {
    let measures = measures(objectives);
    let [coarse, fine] = lattices::confirming(study, settings).each_ref().map(|all| {
        let gains = all.par_iter().map(|on| on_one(on, settings, &measures, measured));
        gains.collect::<Vec<Vec<Vec<f64>>>>()
    });
    let of = |layout: usize| {
        let one = |(k, (aim, is_more_better)): (usize, &(Aim, bool))| {
            let values = |of: &[Vec<Vec<f64>>]| Sampled::of(of.iter().map(|l| l[layout][k]).collect());
            let (coarse, fine) = (values(&coarse)?, values(&fine)?);
            Some((aim.to_string(), gain(&coarse, &fine, *is_more_better)))
        };
        measures.iter().enumerate().filter_map(one).collect::<BTreeMap<_, _>>()
    };
    (0..count).map(of).collect()
}

/// For every layout the gain in every measure on one lattice.
fn on_one(
    one: &Study,
    settings: &Settings,
    measures: &[(Aim, bool)],
    measured: &Measured<'_>,
) -> Vec<Vec<f64>> {
    let value = |worth: &Worth, aim: Aim| match aim.measure {
        Measure::Score => one.score(worth, settings),
        _ => one.value(worth, aim),
    };
    let gains = |worth: &Worth| {
        // What sees nothing, or no longer reaches the rest, is not a step away from anything.
        let is_lost = worth.cut_off > CUT_OFF_FREE || !hidden(one, settings, worth).is_empty();
        let of = |&(aim, is_more_better): &(Aim, bool)| {
            let gain = relative_gain(is_more_better, value(worth, aim), value(&one.initial, aim));
            if is_lost { f64::NAN } else { gain }
        };
        measures.iter().map(of).collect()
    };
    measured(one).iter().map(gains).collect()
}

fn gain(coarse: &Sampled, fine: &Sampled, is_more_better: bool) -> Gain {
    let Interval { value: share, low, high } = interval(coarse, fine, REACH, AGAIN);
    Gain { share, low, high, sense: if is_more_better { Sense::Max } else { Sense::Min } }
}

/// Least sure gain of a best layout that is shown, a share: messages give gains in tenths of a per cent.
pub(crate) const BEST_MIN: f64 = 0.001;

/// The most that a layout surely gains in something that is asked for; none if it surely loses something that is asked
/// for, unless that objective's threshold is 0. Without end if nothing is asked for.
pub(crate) fn sure_gain(objectives: &Aims, gains: &Gains) -> Option<f64> {
    let asked = || objectives.iter().filter(|(_, o)| !o.is_penalty);
    if asked().next().is_none() {
        return Some(f64::INFINITY);
    }
    let is_lost = asked().any(|(_, o)| o.threshold > 0.0 && gains.get(&o.name).is_some_and(|g| g.high < 0.0));
    asked().filter_map(|(_, o)| Some(gains.get(&o.name)?.low)).reduce(f64::max).filter(|_| !is_lost)
}

/// Whether a layout may be shown: it surely gains `least` or more.
pub(crate) fn is_confirmed(objectives: &Aims, gains: &Gains, least: f64) -> bool {
    sure_gain(objectives, gains).is_some_and(|g| g >= least)
}

/// What is gained in all objectives together.
pub(crate) fn total(objectives: &Aims, gains: &Gains) -> f64 {
    objectives.iter().filter_map(|(_, o)| gains.get(&o.name)).map(|g| g.share).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use enfilade_search::Objective;

    #[test]
    fn what_is_lost_for_sure_is_not_shown_unless_it_was_given_up() {
        let aims = |threshold: f64| -> Vec<(Aim, Objective)> {
            let of = |measure, name: &str, sense| {
                let (is_score, is_penalty) = (false, false);
                (Aim::mean(measure), Objective { name: name.into(), sense, threshold, is_score, is_penalty })
            };
            vec![of(Measure::Degree, "degree", Sense::Max), of(Measure::MeanDepth, "mean-depth", Sense::Min)]
        };
        let of = |degree: [f64; 2], depth: [f64; 2]| -> Gains {
            let gain =
                |[low, high]: [f64; 2]| Gain { share: (low + high) / 2.0, low, high, sense: Sense::Max };
            [("degree".into(), gain(degree)), ("mean-depth".into(), gain(depth))].into()
        };
        let firm = |gains: &Gains| is_confirmed(&aims(0.7), gains, 0.01);
        assert!(firm(&of([0.02, 0.04], [-0.01, 0.02])));
        assert!(!firm(&of([0.005, 0.04], [-0.01, 0.02])));
        assert!(!firm(&of([0.02, 0.04], [-0.05, -0.02])));
        assert!(is_confirmed(&aims(0.0), &of([0.02, 0.04], [-0.05, -0.02]), 0.01));
        assert!(!firm(&Gains::new()));
    }
}

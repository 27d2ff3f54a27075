//! What is asked of a layout: measures taken together in other ways than the mean, and hard limits.

use crate::measure::seen::Seen;
use enfilade_config::{Aggregate, Aim, Bound, Held, Limit, Measure, PairName, Penalty, Settings, Source};
use enfilade_engine::measures::{UNDEFINED, entropy_bits, global_row, mean_depth};

/// The aims of the settings that are not among the paper's means, each once.
pub fn aims(settings: &Settings) -> Vec<Aim> {
    let objectives = settings.objectives.iter().map(|o| o.measure);
    let score = settings.score.iter().map(|s| s.0);
    let limits = settings.limits.iter().filter_map(|l| match l.held {
        Held::Aim(aim) => Some(aim),
        Held::Penalty(_) => None,
    });
    let mut out = Vec::new();
    for aim in objectives.chain(score).chain(limits).filter(|a| a.measure.is_of_cells() && !a.is_basic()) {
        if !out.contains(&aim) {
            out.push(aim);
        }
    }
    out
}

/// Widths of passages that the settings ask for, metres, and where: of the penalty first, then of every limit.
pub fn passages(settings: &Settings, penalty_m: f64) -> Vec<(f64, Option<PairName>)> {
    let passage = |l: &Limit| match (l.held, l.bound) {
        (Held::Penalty(Penalty::Passage), Bound::At(width_m)) => Some((width_m, l.place)),
        _ => None,
    };
    let limits: Vec<_> = settings.limits.iter().filter_map(passage).collect();
    let is_asked = !limits.is_empty() || settings.penalties.iter().any(|p| p.0 == Penalty::Passage);
    is_asked.then_some((penalty_m, None)).into_iter().chain(limits).collect()
}

/// Whether the settings ask for the areas of rooms.
pub fn asks_for_rooms(settings: &Settings) -> bool {
    let is_limit = |l: &Limit| l.held == Held::Penalty(Penalty::RoomArea);
    settings.penalties.iter().any(|p| p.0 == Penalty::RoomArea) || settings.limits.iter().any(is_limit)
}

/// Values of one measure, one a query vertex, NaN where it has none or the layout covers the vertex; empty
/// for `score` and `penalty`.
pub fn cell_values(seen: &Seen, measure: Measure) -> Vec<f64> {
    let mut values = all_values(seen, measure);
    for i in &seen.covered {
        if let Some(v) = values.get_mut(*i as usize) {
            *v = f64::NAN;
        }
    }
    if let Some(known) = seen.estimated.as_ref().filter(|_| is_of_trees(measure)) {
        let unknown = |i: &usize| known.places.binary_search(&(*i as u32)).is_err();
        (0..values.len()).filter(unknown).for_each(|i| values[i] = f64::NAN);
    }
    values
}

/// Whether a measure of a cell takes its breadth-first tree.
pub fn is_of_trees(measure: Measure) -> bool {
    measure.source() == Source::Forest && !matches!(measure, Measure::Degree | Measure::Connectivity)
}

fn all_values(seen: &Seen, measure: Measure) -> Vec<f64> {
    let tally = &seen.tally;
    let each = |of: &dyn Fn(&[u32]) -> f64| {
        let mut at = 0;
        let next = |d: &u32| {
            let own = &tally.levels[at..at + *d as usize];
            at += *d as usize;
            of(own)
        };
        tally.depth.iter().map(next).collect::<Vec<f64>>()
    };
    let levels = |k: usize| {
        let defined = |v: f64| if v == UNDEFINED { f64::NAN } else { v };
        each(&|own| defined(global_row(own)[k]))
    };
    let isovist = |k: usize| seen.isovists.iter().map(|v| v[k]).collect();
    let counts = |list: &[u32]| list.iter().map(|v| f64::from(*v)).collect();
    match measure {
        Measure::Degree => counts(&tally.degree),
        Measure::Connectivity => counts(&tally.degree_all),
        Measure::Depth => counts(&tally.depth),
        // Who sees nobody is 0 steps away, and the spread over no steps is 0 bits.
        Measure::Entropy => each(&entropy_bits),
        Measure::Integration => levels(1),
        Measure::IntegrationPValue => levels(2),
        Measure::IntegrationTekl => levels(3),
        Measure::MeanDepth => each(&mean_depth),
        Measure::Reach => levels(5).into_iter().map(|n| n - 1.0).collect(),
        Measure::RelativisedEntropy => levels(6),
        Measure::IsovistArea => isovist(0),
        Measure::IsovistPerimeter => isovist(1),
        Measure::IsovistCompactness => isovist(2),
        Measure::IsovistOcclusivity => isovist(3),
        Measure::IsovistDrift => isovist(4),
        Measure::IsovistMaxRadial => isovist(5),
        Measure::IsovistMinRadial => isovist(6),
        _ => {
            let defined = |v: &f64| if *v == UNDEFINED { f64::NAN } else { *v };
            let own = seen.columns.iter().find(|c| c.0 == measure);
            own.map_or_else(Vec::new, |c| c.1.iter().map(defined).collect())
        }
    }
}

/// The values of the cells as one number, those that have one; 0 without. A percentile is the least value
/// that so many per cent of the cells do not exceed (nearest rank).
pub fn together(mut values: Vec<f64>, aggregate: Aggregate) -> f64 {
    values.retain(|v| !v.is_nan());
    let n = values.len();
    if n == 0 {
        return 0.0;
    }
    match aggregate {
        Aggregate::Mean => values.iter().sum::<f64>() / n as f64,
        Aggregate::Min => values.into_iter().fold(f64::INFINITY, f64::min),
        Aggregate::Max => values.into_iter().fold(f64::NEG_INFINITY, f64::max),
        Aggregate::Percentile(p) => {
            values.sort_by(f64::total_cmp);
            values[(usize::from(p) * n).div_ceil(100).max(1) - 1]
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use enfilade_engine::Tally;

    #[test]
    fn cells_become_one_number() {
        let values = || vec![4.0, 1.0, 3.0, 2.0, 10.0];
        assert_eq!(together(values(), Aggregate::Mean), 4.0);
        assert_eq!(together(values(), Aggregate::Min), 1.0);
        assert_eq!(together(values(), Aggregate::Max), 10.0);
        let percentiles = [(1, 1.0), (20, 1.0), (21, 2.0), (50, 3.0), (80, 4.0), (81, 10.0)];
        for (p, value) in percentiles {
            assert_eq!(together(values(), Aggregate::Percentile(p)), value, "p{p}");
        }
        assert_eq!(together(vec![], Aggregate::Min), 0.0);
    }

    #[test]
    fn cells_without_a_value_do_not_count() {
        let levels = vec![4, 2, 1, 1];
        let tally = Tally { depth: vec![3, 0, 1], levels, degree: vec![4, 0, 1], ..Tally::default() };
        let seen = Seen { tally, ..Seen::default() };
        assert_eq!(cell_values(&seen, Measure::MeanDepth), [11.0 / 7.0, 0.0, 1.0]);
        assert_eq!(cell_values(&seen, Measure::Reach), [7.0, 0.0, 1.0]);
        let integration = cell_values(&seen, Measure::Integration);
        assert!(integration[0] > 0.0 && integration[1].is_nan() && integration[2].is_nan());
        assert_eq!(together(integration.clone(), Aggregate::Mean), integration[0]);
        assert_eq!(together(vec![f64::NAN], Aggregate::Max), 0.0);
        let covered = Seen { covered: vec![1], ..seen };
        let depths = cell_values(&covered, Measure::Depth);
        assert!(depths[1].is_nan());
        assert_eq!(together(depths, Aggregate::Min), 1.0);
    }
}

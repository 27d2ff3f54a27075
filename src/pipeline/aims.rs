//! What is asked of a layout: measures taken together in other ways than the mean, and hard limits.

use super::study::{Study, Worth, divisor};
use crate::analysis::measures::entropy_bits;
use crate::config::{Aggregate, Aim, Bound, Held, Limit, Measure, Penalty, Settings};

/// A limit passed by less than this share of it is kept: written coordinates are rounded to 1 µm.
pub const LIMIT_TOLERANCE: f64 = 1e-6;

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

/// Widths of passages that the settings ask for, metres: of the penalty first, then of every limit.
pub fn passage_widths_m(settings: &Settings, penalty_m: f64) -> Vec<f64> {
    let passage = |l: &Limit| match (l.held, l.bound) {
        (Held::Penalty(Penalty::Passage), Bound::At(width_m)) => Some(width_m),
        _ => None,
    };
    let limits: Vec<f64> = settings.limits.iter().filter_map(passage).collect();
    let is_asked = !limits.is_empty() || settings.penalties.iter().any(|p| p.0 == Penalty::Passage);
    is_asked.then_some(penalty_m).into_iter().chain(limits).collect()
}

/// Values of one measure, one a query vertex; none for `score` and `penalty`.
pub fn cell_values(worth: &Worth, measure: Measure) -> Vec<f64> {
    let tally = &worth.tally;
    let levels = |of: fn(&[u32]) -> f64| {
        let mut at = 0;
        let mut next = |d: &u32| {
            let own = &tally.levels[at..at + *d as usize];
            at += *d as usize;
            of(own)
        };
        tally.depth.iter().map(&mut next).collect()
    };
    let isovist = |k: usize| worth.isovists.iter().map(|v| v[k]).collect();
    match measure {
        Measure::Degree => tally.degree.iter().map(|v| f64::from(*v)).collect(),
        Measure::Depth => tally.depth.iter().map(|v| f64::from(*v)).collect(),
        Measure::Entropy => levels(entropy_bits),
        Measure::MeanDepth => levels(mean_depth),
        Measure::Reach => levels(|own| own.iter().map(|n| f64::from(*n)).sum()),
        Measure::IsovistArea => isovist(0),
        Measure::IsovistPerimeter => isovist(1),
        Measure::IsovistCompactness => isovist(2),
        Measure::IsovistOcclusivity => isovist(3),
        Measure::Score | Measure::Penalty => Vec::new(),
    }
}

/// `Σ j n_j / Σ n_j` over the levels; 0 for an isolated vertex.
fn mean_depth(levels: &[u32]) -> f64 {
    let total: f64 = levels.iter().map(|n| f64::from(*n)).sum();
    let steps: f64 = levels.iter().enumerate().map(|(j, n)| (j + 1) as f64 * f64::from(*n)).sum();
    if total > 0.0 { steps / total } else { 0.0 }
}

/// The values of the cells as one number; 0 without cells. A percentile is the least value that so many
/// per cent of the cells do not exceed (nearest rank).
pub fn together(mut values: Vec<f64>, aggregate: Aggregate) -> f64 {
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

/// What a layout has of what a limit holds, and where the limit lies; both in the limit's own unit.
pub fn held(study: &Study, settings: &Settings, worth: &Worth, index: usize) -> (f64, f64) {
    let limit = &settings.limits[index];
    let value = |w: &Worth| match (limit.held, limit.bound) {
        (Held::Aim(Aim { measure: Measure::Score, .. }), _) => study.score(w, settings),
        (Held::Aim(Aim { measure: Measure::Penalty, .. }), _) => study.penalty(w, settings),
        (Held::Aim(aim), _) => study.value(w, aim),
        (Held::Penalty(Penalty::Clearance), _) => w.clearance_m2,
        (Held::Penalty(Penalty::WallLength), Bound::Change(_)) => w.wall_total_m,
        (Held::Penalty(penalty), _) => w.penalty(penalty),
    };
    match (limit.held, limit.bound) {
        (Held::Penalty(Penalty::Passage), Bound::At(width_m)) => {
            let is_passage = |l: &&Limit| l.held == limit.held;
            let nth = settings.limits[..index].iter().filter(is_passage).count() + 1;
            (width_m - worth.passages_m.get(nth).copied().unwrap_or(0.0), width_m)
        }
        (_, Bound::At(at)) => (value(worth), at),
        (_, Bound::Change(share)) => {
            let present = value(&study.initial);
            (value(worth), present + share * divisor(present))
        }
    }
}

/// By how much a layout misses every limit, relative to it; 0: kept.
pub fn missed(study: &Study, settings: &Settings, worth: &Worth) -> Vec<f64> {
    let of = |index: usize| {
        let (value, bound) = held(study, settings, worth, index);
        let lacks = if settings.limits[index].is_least { bound - value } else { value - bound };
        let share = lacks / divisor(bound);
        if share > LIMIT_TOLERANCE || share.is_nan() { share } else { 0.0 }
    };
    (0..settings.limits.len()).map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

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
    fn mean_depth_counts_steps() {
        assert_eq!(mean_depth(&[4, 2, 1]), 11.0 / 7.0);
        assert_eq!(mean_depth(&[]), 0.0);
    }
}

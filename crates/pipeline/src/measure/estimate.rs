//! What holds beyond one lattice: means over shifted lattices of two spacings, with 95 % intervals that hold the bias of
//! the spacing too.

use std::collections::BTreeMap;

use crate::measure::lattices;
use crate::measure::look::LatticeAt;
use crate::measure::seen::Use;
use crate::measure::study::Study;
use enfilade_config::{Aim, Measure, Settings};
use enfilade_engine::sampled::student;
use enfilade_overlay::result::Interval;

/// Fewer lattices of a spacing say nothing of how sure a value is.
const LATTICES_MIN: usize = 3;
/// Layouts of more vertices are not measured several times to tell how sure their means are.
const VERTICES_MAX: usize = 20_000;

/// Values on lattices of one spacing.
pub(crate) struct Sampled {
    mean: f64,
    /// Of one lattice.
    variance: f64,
    count: f64,
}

impl Sampled {
    /// None of so few values that nothing can be said of them.
    pub(crate) fn of(values: Vec<f64>) -> Option<Self> {
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (count - 1.0);
        (values.len() >= LATTICES_MIN && mean.is_finite()).then_some(Self { mean, variance, count })
    }
}

/// The fine mean and its interval. What is measured at the coarse spacing is off by a bias that falls with the spacing;
/// extrapolation to none lies `reach` = f / (c − f) times their difference beyond the fine mean. The interval holds that, as
/// far to either side, and the noise: of the fine mean, and of what `again` lattices of either spacing would show if somebody
/// measured again. Student's factor is that of Welch and Satterthwaite, as both variances are estimates.
pub(crate) fn interval(coarse: &Sampled, fine: &Sampled, reach: f64, again: f64) -> Interval {
    let share_again = if again > 0.0 { again / (2.0 * again).powi(2) } else { 0.0 };
    let parts = [
        (coarse.variance * share_again, coarse.count - 1.0),
        (fine.variance * (1.0 / fine.count + share_again), fine.count - 1.0),
    ];
    let variance: f64 = parts.iter().map(|p| p.0).sum();
    let of_parts: f64 = parts.iter().map(|(v, f)| v * v / f).sum();
    let freedom = variance.powi(2) / of_parts.max(f64::MIN_POSITIVE);
    let half = reach * (fine.mean - coarse.mean).abs() + student(freedom.max(1.0)) * variance.sqrt();
    Interval { value: fine.mean, low: fine.mean - half, high: fine.mean + half }
}

/// Means of the present layout by the names that they have in `mean`; none of a floor that is too large or too small.
pub(crate) fn present(study: &Study, settings: &Settings) -> BTreeMap<String, Interval> {
    let (coarse, reach) = lattices::coarser(study, settings);
    let coarse = values(study, settings, &coarse);
    around(study, settings, |k, fine| Some(interval(coarse.get(k)?.as_ref()?, fine, reach, 0.0)))
}

/// The same as they are at the study's own spacing, without what a finer one would show.
pub(crate) fn at_spacing(study: &Study, settings: &Settings) -> BTreeMap<String, Interval> {
    around(study, settings, |_, fine| Some(interval(fine, fine, 0.0, 0.0)))
}

fn aims(study: &Study) -> Vec<Aim> {
    let usual = [Measure::Degree, Measure::Depth, Measure::Entropy, Measure::MeanDepth].map(Aim::mean);
    let others = study.aims.iter().copied().filter(|a| !usual.contains(a));
    usual.into_iter().chain(others).collect()
}

/// Of every aim of [`aims`] what it has on lattices shifted about the study's.
fn around(
    study: &Study,
    settings: &Settings,
    of: impl Fn(usize, &Sampled) -> Option<Interval>,
) -> BTreeMap<String, Interval> {
    let found = values(study, settings, &lattices::ranked(study, settings));
    let named = aims(study).into_iter().zip(found).enumerate();
    named.filter_map(|(k, (aim, found))| Some((aim.to_string(), of(k, &found?)?))).collect()
}

/// Of every aim of [`aims`] what the present layout has on lattices; nothing where it would take long.
fn values(study: &Study, settings: &Settings, at: &[LatticeAt]) -> Vec<Option<Sampled>> {
    if study.lattice.cells.len() > VERTICES_MAX {
        return Vec::new();
    }
    let on: Vec<Study> = at
        .iter()
        .filter_map(|at| study.on_lattices(settings, std::slice::from_ref(at), Use::Few(None)).ok())
        .collect();
    let of = |aim: &Aim| Sampled::of(on.iter().map(|on| on.mean_of_cells(*aim)).collect());
    aims(study).iter().map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sampled(values: &[f64]) -> Sampled {
        Sampled::of(values.to_vec()).unwrap()
    }

    #[test]
    fn an_interval_holds_both_spacings_and_what_lies_beyond() {
        let of = |fine: &[f64], reach, again| interval(&sampled(&[0.10; 3]), &sampled(fine), reach, again);
        let g = of(&[0.06; 3], 1.0, 2.0);
        let is = |found: Interval, [value, low, high]: [f64; 3]| {
            [found.value - value, found.low - low, found.high - high].iter().all(|d| d.abs() < 1e-12)
        };
        assert!(is(g, [0.06, 0.02, 0.10]));
        assert!(is(of(&[0.06; 3], 2.0, 2.0), [0.06, -0.02, 0.14]));
        let [noisy, known] = [2.0, 0.0].map(|again| of(&[0.05, 0.06, 0.07], 1.0, again));
        assert!(noisy.high > known.high && known.high > g.high);
        assert!(Sampled::of(vec![0.1, 0.2]).is_none());
        assert!(Sampled::of(vec![0.1, f64::NAN, 0.2]).is_none());
    }
}

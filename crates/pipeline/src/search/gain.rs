//! What a layout gains over the present one.

use crate::measure::study::divisor;
use enfilade_overlay::result::{Objective, Sense};

/// What is gained over the present value, as a share of it; where that is 0, as a score's, as it is.
pub fn relative_gain(is_more_better: bool, now: f64, present: f64) -> f64 {
    let gain = if is_more_better { now - present } else { present - now };
    gain / divisor(present)
}

/// The relative gain in every objective but the penalty.
pub(crate) fn relative_gains<'a>(
    objectives: &'a [Objective],
    values: &'a [f64],
) -> impl Iterator<Item = f64> + 'a {
    let aims = objectives.iter().zip(values).filter(|(o, _)| o.name != "penalty");
    aims.map(|(o, v)| relative_gain(o.sense == Sense::Max, *v, o.initial))
}

/// Sum of the gains over the present layout: the order in which options are shown.
pub fn total_gain(objectives: &[Objective], values: &[f64]) -> f64 {
    relative_gains(objectives, values).sum()
}

/// Whether a layout is worth showing: it gains something in an objective, and, unless the user's own
/// thresholds decide (`is_firm`), not less than it loses in the others. A score is as large as `score_weight`, the
/// largest of its weights, makes it.
pub fn is_better(objectives: &[Objective], values: &[f64], is_firm: bool, score_weight: f64) -> bool {
    let least = |o: &Objective| LEAST_GAIN * if o.name == "score" { score_weight.min(1.0) } else { 1.0 };
    let aims = objectives.iter().filter(|o| o.name != "penalty");
    let mut gains = relative_gains(objectives, values).zip(aims.clone());
    let gains_somewhere = gains.any(|(g, o)| g > 0.0 && g >= least(o));
    let has_aims = objectives.iter().any(|o| o.name != "penalty");
    // Who is content with anything that is no worse gets it.
    let is_all_wanted = is_firm && aims.into_iter().all(|o| o.threshold == 0.0);
    !has_aims || is_all_wanted || gains_somewhere && (is_firm || total_gain(objectives, values) > 0.0)
}

/// What is smaller, as a share of the present value, nobody would call a gain.
pub const LEAST_GAIN: f64 = 0.005;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_layout_is_better_by_what_it_gains() {
        let of = |name: &str, sense, initial| Objective {
            name: name.into(),
            sense,
            threshold: 0.7,
            initial,
            best: Some(initial),
            free: None,
            reachable: Some(initial),
            limit: Some(initial),
        };
        let three =
            [of("penalty", Sense::Min, 0.0), of("degree", Sense::Max, 400.0), of("depth", Sense::Min, 2.0)];
        for (degree, depth, better, firm) in [
            (440.0, 2.0, true, true),
            (400.0, 1.9, true, true),
            // Gains 10 % and loses 20 %: only who set the thresholds may want it.
            (440.0, 2.4, false, true),
            // As drawn, or nearly.
            (400.0, 2.0, false, false),
            (401.0, 2.001, false, false),
            (380.0, 2.1, false, false),
        ] {
            let values = [1e9, degree, depth];
            assert_eq!(is_better(&three, &values, false, 1.0), better, "{values:?}");
            assert_eq!(is_better(&three, &values, true, 1.0), firm, "{values:?}");
        }
        let score = [of("score", Sense::Max, 0.0)];
        assert!(is_better(&score, &[0.3], false, 1.0) && !is_better(&score, &[-0.1], true, 1.0));
        let small = |value, weight| is_better(&score, &[value], false, weight);
        assert!(!small(0.004, 1.0) && small(0.004, 0.02) && !small(0.0, 0.0), "as large as its weights");
        assert!(is_better(&three[..1], &[5.0], false, 1.0), "nothing but a penalty: nothing to judge by");
        assert!(total_gain(&three, &[0.0, 440.0, 1.9]) > total_gain(&three, &[0.0, 440.0, 2.0]));
    }
}

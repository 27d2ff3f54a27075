//! The settings of the default method: one set for all studies and budgets.

/// What the default method does how often. [`Tuning::default`] is what the product uses; benches vary
/// it to show what each part is worth.
#[derive(Clone, Debug, PartialEq)]
pub struct Tuning {
    /// Share of the budget that only climbs.
    pub climb_share: f64,
    /// Share of the later evaluations that still climb.
    pub late_climb: f64,
    /// From this share of the budget on the late climbing fades to nothing.
    pub fade_from: f64,
    /// How much more than the threshold a member must have while the best still rises.
    pub margin: f64,
    /// Nearest archive points in a surrogate that climbs.
    pub neighbours: usize,
    /// Nearest archive points in a surrogate that spreads.
    pub spread_neighbours: usize,
    /// Candidates that the surrogate screens for one climb proposal.
    pub candidates: usize,
    /// Candidates of one spread proposal.
    pub spread_candidates: usize,
    /// Share of climb proposals that no model screens.
    pub raw_share: f64,
    /// Share of climb proposals that polish the best point, once a climb has converged.
    pub polish: f64,
    /// The same for the late climbing, beside the spread.
    pub late_polish: f64,
    /// Added to the surrogate's diagonal: how much it smooths the stairs of the objective.
    pub nugget: f64,
    /// Share of coordinates that a candidate changes.
    pub coordinate_share: f64,
    /// Widest standard deviation of a climb candidate, in widths of the unit cube.
    pub first_step: f64,
    /// Below this step a climb has converged.
    pub last_step: f64,
    /// Share of the best below which gains are levelled before fitting.
    pub floor_share: f64,
    /// Share of spread proposals that take any member, not one of the closest pair.
    pub any_member: f64,
    /// Whether the best point is always a member. It costs the others a fifth of their distance, so by default
    /// it is reported beside them.
    pub keep_best: bool,
    /// Share of spread evaluations that should be accepted.
    pub acceptance: f64,
    /// Share of the screened candidates that follow the difference of two good points of the climb.
    pub differences: f64,
    /// Failures in a row that halve the step, a dimension.
    pub patience: f64,
}

impl Default for Tuning {
    fn default() -> Self {
        Self {
            climb_share: 0.8,
            late_climb: 0.35,
            fade_from: 0.7,
            margin: 0.043,
            neighbours: 300,
            spread_neighbours: 300,
            candidates: 500,
            spread_candidates: 600,
            raw_share: 0.25,
            polish: 0.1,
            late_polish: 0.6,
            nugget: 1e-4,
            coordinate_share: 0.2,
            first_step: 0.2,
            last_step: 0.015,
            floor_share: 0.2,
            any_member: 0.0,
            keep_best: false,
            acceptance: 0.3,
            differences: 0.3,
            patience: 1.4,
        }
    }
}

//! Everything evaluated so far, and the thresholds that follow from it.

use super::space::square_distance;
use super::{Evaluation, Objective, Point};

/// All evaluated points in the order they were told.
///
/// A *gain* is an objective turned so that more is better.
#[derive(Clone, Debug)]
pub(super) struct Archive {
    dims: usize,
    objectives: usize,
    units: Vec<f64>,
    gains: Vec<f64>,
    hard: Vec<f64>,
    points: Vec<Point>,
}

impl Archive {
    pub(super) fn new(dims: usize, objectives: usize) -> Self {
        Self { dims, objectives, units: vec![], gains: vec![], hard: vec![], points: vec![] }
    }

    /// Adds an evaluated point and returns its index. Values that are not finite make it infeasible.
    pub(super) fn push(
        &mut self,
        unit: &[f64],
        parameters: Vec<f64>,
        told: &Evaluation,
        objectives: &[Objective],
    ) -> usize {
        let usable = told.values.len() == self.objectives
            && told.values.iter().all(|v| v.is_finite())
            && told.violation.is_finite();
        let violation = if usable { told.violation.max(0.0) } else { f64::INFINITY };
        self.units.extend_from_slice(unit);
        for (j, objective) in objectives.iter().enumerate() {
            let value = told.values.get(j).copied().unwrap_or(f64::NAN);
            self.gains.push(objective.sense.gain(value));
        }
        self.hard.push(violation);
        self.points.push(Point { parameters, values: told.values.clone(), violation });
        self.points.len() - 1
    }

    pub(super) fn len(&self) -> usize {
        self.points.len()
    }

    pub(super) fn dims(&self) -> usize {
        self.dims
    }

    pub(super) fn objectives(&self) -> usize {
        self.objectives
    }

    pub(super) fn points(&self) -> &[Point] {
        &self.points
    }

    pub(super) fn unit(&self, i: usize) -> &[f64] {
        &self.units[i * self.dims..(i + 1) * self.dims]
    }

    pub(super) fn gains(&self, i: usize) -> &[f64] {
        &self.gains[i * self.objectives..(i + 1) * self.objectives]
    }

    /// Sum of hard violations; infinite for a point whose values are no numbers.
    pub(super) fn hard(&self, i: usize) -> f64 {
        self.hard[i]
    }

    pub(super) fn distance(&self, i: usize, j: usize) -> f64 {
        square_distance(self.unit(i), self.unit(j)).sqrt()
    }
}

/// Smallest difference of gains that counts as a range.
const NO_RANGE: f64 = 1e-12;

/// The thresholds `T` of Algorithm 1, as they follow from an archive.
///
/// Objective by objective, in order: the best gain among the points that keep hard limits and all
/// earlier thresholds, and from it `l = base + z (best − base)`. The base is the present layout; 0
/// for a `score` (spec 7, Decision). Objectives conflict: where the best of an earlier one costs this
/// one more than the present layout has, the base is what it has there (the payoff table's estimate of
/// the nadir), or a range of almost nothing would leave no room for different members; firm limits do so
/// only where nothing is gained on the present layout. Where even that
/// gives no range, the base is the median of the points that were admitted. A range is never less than
/// [`LEAST_RANGE`].
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Limits {
    /// Index of the best point of each objective; `None` from the first objective that has none.
    pub(super) best: Vec<Option<usize>>,
    base: Vec<f64>,
    top: Vec<f64>,
    threshold: Vec<f64>,
    /// Bases that are the median of all points, where nothing else is known.
    guessed: Vec<Option<f64>>,
    /// Such bases found earlier, which stand: else members that improve would close the room they need.
    held: Vec<Option<f64>>,
    /// Whether a median moves with every point.
    provisional: bool,
    /// Whether a threshold is a share of the gain over the present layout wherever there is one.
    is_firm: bool,
}

/// Range of an objective, relative to its present value, that is nothing to anybody: where no layout
/// changes it by more, its threshold must not decide which layouts are good.
const LEAST_RANGE: f64 = 0.02;

fn least_range(archive: &Archive, objective: &Objective, j: usize) -> f64 {
    if objective.is_score || objective.is_penalty || archive.len() == 0 {
        return 0.0;
    }
    let now = archive.gains(0)[j].abs();
    if now.is_finite() { LEAST_RANGE * now } else { 0.0 }
}

/// What a penalty that only must not grow may grow by all the same: less than [`LEAST_RANGE`] is nothing to
/// anybody, and without it a wall drawn a hair askew could never slide.
fn slack(archive: &Archive, objective: &Objective, j: usize) -> f64 {
    if !objective.is_penalty || objective.threshold > 0.0 || archive.len() == 0 {
        return 0.0;
    }
    let now = archive.gains(0)[j].abs();
    if now.is_finite() { LEAST_RANGE * now } else { 0.0 }
}

/// How far below its limit a gain is still told apart, in ranges: a surrogate must see the limit.
const FLOOR_BELOW_LIMIT: f64 = 0.5;

/// Provisional limits are taken anew whenever the archive has grown by this many points.
const PROVISIONAL_POINTS: usize = 32;

impl Limits {
    pub(super) fn of(archive: &Archive, objectives: &[Objective], is_firm: bool) -> Self {
        Self { is_firm, ..Self::default() }.continued(archive, objectives)
    }

    /// These limits for all objectives but the last, whose limit follows the archive: once members
    /// spread, an earlier threshold stands, as in Algorithm 2, or each late find would turn them out.
    pub(super) fn with_last_anew(&self, archive: &Archive, objectives: &[Objective]) -> Self {
        let mut limits = self.clone();
        let kept = objectives.len() - 1;
        limits.best.truncate(kept);
        limits.guessed.truncate(kept);
        for list in [&mut limits.base, &mut limits.top, &mut limits.threshold] {
            list.truncate(kept);
        }
        limits.continued(archive, objectives)
    }

    /// Firm limits of all that is known now; only medians stand, but that of the last objective.
    pub(super) fn anew(&self, archive: &Archive, objectives: &[Objective]) -> Self {
        let mut held = self.guessed.clone();
        held.truncate(objectives.len() - 1);
        Self { is_firm: self.is_firm, held, ..Self::default() }.continued(archive, objectives)
    }

    /// These limits with other thresholds, from the same best points.
    pub(super) fn with_thresholds_of(&self, objectives: &[Objective]) -> Self {
        let mut limits = self.clone();
        for (z, objective) in limits.threshold.iter_mut().zip(objectives) {
            *z = objective.threshold;
        }
        limits
    }

    fn continued(self, archive: &Archive, objectives: &[Objective]) -> Self {
        let mut limits = self;
        for (j, objective) in objectives.iter().enumerate().skip(limits.top.len()) {
            let within = |&i: &usize| archive.hard(i) == 0.0 && limits.admits(archive.gains(i), j, 0.0);
            let gain = |i: usize| archive.gains(i)[j];
            let best = (0..archive.len()).filter(within).reduce(|a, b| if gain(b) > gain(a) { b } else { a });
            limits.add(archive, objective, best);
        }
        limits
    }

    /// `T ← T ∪ t(l, ∞, ·)`: the threshold of the next objective, whose best point is `best`.
    pub(super) fn add(&mut self, archive: &Archive, objective: &Objective, best: Option<usize>) {
        let j = self.top.len();
        let top = best.map_or(0.0, |i| archive.gains(i)[j]);
        self.best.push(best);
        let known = self.known_base(archive, objective, j, top);
        let held = self.held.get(j).copied().flatten();
        let guess = || held.unwrap_or_else(|| self.median_admitted(archive, j, top));
        let guessed = known.is_none().then(guess);
        self.provisional |= guessed.is_some() && held.is_none();
        self.guessed.push(guessed);
        let base = known.or(guessed).unwrap_or(top) - slack(archive, objective, j);
        self.base.push(base.min(top - least_range(archive, objective, j)));
        self.top.push(top);
        self.threshold.push(objective.threshold);
    }

    /// Whether some point keeps hard limits and all thresholds; without one the limits mean nothing yet.
    pub(super) fn are_known(&self) -> bool {
        self.best.iter().all(Option::is_some)
    }

    /// How far each threshold is missed, in ranges; 0 where it is kept.
    pub(super) fn misses(&self, gains: &[f64]) -> impl Iterator<Item = f64> {
        (0..self.top.len()).map(|j| ((self.limit(j, 0.0) - gains[j]) / self.range(j)).max(0.0))
    }

    /// Whether the newest point `i` can change these limits.
    pub(super) fn moved_by(&self, archive: &Archive, i: usize) -> bool {
        if self.provisional && i.is_multiple_of(PROVISIONAL_POINTS) {
            return true;
        }
        if archive.hard(i) > 0.0 {
            return false;
        }
        let gains = archive.gains(i);
        (0..self.top.len()).any(|j| {
            self.admits(gains, j, 0.0) && self.best[j].is_none_or(|b| gains[j] > archive.gains(b)[j])
        })
    }

    /// The gain `l_j` a member needs. A margin of 0.05 asks for 5 % more than the threshold, so that
    /// members stay inside while the best still rises; it never asks for more than half of what the
    /// threshold leaves open, nor, by rounding, more than the best has.
    pub(super) fn limit(&self, j: usize, margin: f64) -> f64 {
        let z = self.threshold[j];
        let asked = (z * (1.0 + margin)).min(f64::midpoint(z, 1.0));
        (self.base[j] + asked * (self.top[j] - self.base[j])).min(self.top[j])
    }

    /// Best gain of objective `j` (0 where no point is feasible).
    pub(super) fn top(&self, j: usize) -> f64 {
        self.top[j]
    }

    /// Best gain of objective `j` among the points that keep the thresholds before it, where there is one.
    pub(super) fn best_gain(&self, j: usize) -> Option<f64> {
        self.best.get(j).copied().flatten().map(|_| self.top[j])
    }

    /// `best − base`, at least tiny.
    pub(super) fn range(&self, j: usize) -> f64 {
        let range = self.top[j] - self.base[j];
        if range > NO_RANGE { range } else { 1.0 }
    }

    /// The level below which a gain is only "bad": the surrogate does not follow the cliffs there.
    pub(super) fn floor(&self, j: usize, share: f64) -> f64 {
        let by_share = self.top[j] - (1.0 - share) * self.range(j);
        by_share.min(self.limit(j, 0.0) - FLOOR_BELOW_LIMIT * self.range(j))
    }

    /// Whether a point of these gains keeps the thresholds of the first `count` objectives.
    pub(super) fn admits(&self, gains: &[f64], count: usize, margin: f64) -> bool {
        (0..count).all(|j| gains[j] >= self.limit(j, margin))
    }

    /// How far inside the thresholds of the first `count` objectives a point lies, in ranges:
    /// the smallest `(f − l) / range`; negative outside.
    pub(super) fn slack(&self, gains: &[f64], count: usize, margin: f64) -> f64 {
        (0..count).map(|j| (gains[j] - self.limit(j, margin)) / self.range(j)).fold(f64::INFINITY, f64::min)
    }

    /// 0 for a score; the present layout's for the penalty, which never makes room, and for firm limits where
    /// something is gained on it; else the least of what the present layout and the best points of the earlier
    /// objectives have, as long as the best is better.
    fn known_base(&self, archive: &Archive, objective: &Objective, j: usize, top: f64) -> Option<f64> {
        if objective.is_score && top > 0.0 {
            return Some(0.0);
        }
        if objective.is_penalty && archive.len() > 0 && archive.gains(0)[j].is_finite() {
            return Some(archive.gains(0)[j]);
        }
        let present = if archive.len() > 0 { archive.gains(0)[j] } else { f64::NAN };
        if self.is_firm && top - present > NO_RANGE {
            return Some(present);
        }
        let earlier = self.best[..j].iter().flatten().copied();
        let known = (archive.len() > 0).then_some(0).into_iter().chain(earlier);
        let base = known.map(|i| archive.gains(i)[j]).filter(|g| g.is_finite()).fold(f64::INFINITY, f64::min);
        (base.is_finite() && top - base > NO_RANGE).then_some(base)
    }

    /// Median gain of the points that keep the earlier thresholds, at most `top`.
    fn median_admitted(&self, archive: &Archive, j: usize, top: f64) -> f64 {
        let admitted = |&i: &usize| archive.hard(i).is_finite() && self.admits(archive.gains(i), j, 0.0);
        let mut gains: Vec<f64> = (0..archive.len())
            .filter(admitted)
            .map(|i| archive.gains(i)[j])
            .filter(|g| g.is_finite())
            .collect();
        if gains.is_empty() {
            return top;
        }
        let middle = gains.len() / 2;
        let (_, median, _) = gains.select_nth_unstable_by(middle, f64::total_cmp);
        median.min(top)
    }
}

/// Cost of breaking a hard limit, in ranges: more than any objective can make up for.
const HARD_COST: f64 = 1e3;

/// `g_h(p, T)` of an archive point: squared misses of the thresholds, each in its own range, and
/// the cost of broken hard limits.
pub(super) fn violation(archive: &Archive, limits: &Limits, i: usize) -> f64 {
    let hard = archive.hard(i);
    if hard > 0.0 {
        return if hard.is_finite() { HARD_COST * (1.0 + hard) } else { f64::INFINITY };
    }
    limits.misses(archive.gains(i)).map(|miss| miss * miss).sum()
}

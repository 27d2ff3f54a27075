//! Climbing to the best point of one objective: DYCORS (Regis & Shoemaker 2013) with raw jumps.
//!
//! A surrogate screens sparse Gaussian steps from the best point of the present climb; a quarter of
//! the proposals are jumps that no model screens, because the objective has cliffs no model sees.
//! A climb whose step has become small has converged; its end is kept. The next ones start anywhere; later, by
//! turns, they widen the step again at the best point, with all that is known, or start from a crossover of
//! ends. All but the former learn from their own points alone: the objective has many optima, and
//! whoever borrows from the best falls back to where the best lies. Meanwhile some proposals polish the
//! best point: one or two coordinates by steps of any size, since the objective is made of stairs.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use rayon::prelude::*;

use super::archive::{Archive, Limits};
use super::models::Models;
use super::space::{reflect, square_distance};
use super::surrogate::Surrogate;
use super::tuning::Tuning;

/// Weights of the predicted gain against the distance to what is known, taken in turn.
const WEIGHTS: [f64; 4] = [0.3, 0.5, 0.8, 0.95];
/// Successes in a row that double the step.
const SUCCESSES: u32 = 3;
/// Screened failures in a row that halve the step, at least.
const LEAST_PATIENCE: usize = 4;
/// Gain, relative to the range, that counts as a success.
const SUCCESS_GAIN: f64 = 1e-3;
/// Ends of climbs that are remembered.
const ENDS_KEPT: usize = 8;
/// Least distance of a restart from the known ends.
const RESTART_DISTANCE: f64 = 0.1;
/// Crossovers among which the model chooses a restart.
const RESTART_CANDIDATES: usize = 200;
/// Distance from the centre beyond which a good point serves for a raw crossover.
const CROSSOVER_DISTANCE: f64 = 0.3;

/// Candidates that one thread judges at a time.
const JUDGED_TOGETHER: usize = 128;

/// How a proposal was made; decides what its result teaches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Step {
    Screened,
    Raw,
    Restart,
    /// Near this archive point, whichever climb is under way.
    Polish(usize),
}

/// One climb after another on the objective `stage`.
#[derive(Clone, Debug)]
pub(super) struct Climb {
    stage: usize,
    centre: Option<usize>,
    restart_pending: bool,
    step: f64,
    successes: u32,
    failures: u32,
    ends: Vec<usize>,
    restarts: usize,
    weight: usize,
    /// The first archive point that the present climb learns from.
    begun: usize,
    good: Good,
}

/// The best tenth of what a climb learns from, as long as nothing is learnt.
#[derive(Clone, Debug, Default)]
struct Good {
    /// First point of the climb, points known and the objective they were chosen for.
    of: (usize, usize, usize),
    /// Ascending.
    points: Vec<usize>,
}

/// What a climb looks at: the archive and its thresholds.
pub(super) struct View<'a> {
    pub(super) archive: &'a Archive,
    pub(super) limits: &'a Limits,
    pub(super) tuning: &'a Tuning,
    /// Whether a new climb begins anywhere, whatever is known.
    pub(super) fresh: bool,
    /// Members of the diverse set, once there is one.
    pub(super) members: &'a [usize],
    /// Points asked and not told yet.
    pub(super) pending: &'a [Vec<f64>],
}

impl View<'_> {
    /// What a climb on `stage` maximises: the gain, less what it misses of earlier thresholds.
    fn merit(&self, gains: &[f64], stage: usize) -> f64 {
        let missed: f64 =
            (0..stage).map(|j| (self.limits.limit(j, 0.0) - gains[j]).max(0.0) / self.limits.range(j)).sum();
        gains[stage] - 3.0 * missed * self.limits.range(stage)
    }

    fn is_within(&self, i: usize, stage: usize) -> bool {
        self.archive.hard(i) == 0.0 && self.limits.admits(self.archive.gains(i), stage, 0.0)
    }

    /// Whether `a` is better than `b`: within hard limits and thresholds first, then by merit.
    fn is_better(&self, a: usize, b: usize, stage: usize, least: f64) -> bool {
        match (self.is_within(a, stage), self.is_within(b, stage)) {
            (true, false) => true,
            (false, true) => false,
            (true, true) => self.archive.gains(a)[stage] > self.archive.gains(b)[stage] + least,
            (false, false) => {
                let (ha, hb) = (self.archive.hard(a), self.archive.hard(b));
                if ha != hb { ha < hb } else { self.merit_of(a, stage) > self.merit_of(b, stage) + least }
            }
        }
    }

    fn merit_of(&self, i: usize, stage: usize) -> f64 {
        if self.archive.hard(i).is_finite() {
            self.merit(self.archive.gains(i), stage)
        } else {
            f64::NEG_INFINITY
        }
    }

    /// What a surrogate learns of objective `j` at point `i`: the gain, levelled below the floor.
    pub(super) fn lesson(&self, i: usize, j: usize) -> f64 {
        let floor = self.limits.floor(j, self.tuning.floor_share);
        if self.archive.hard(i) > 0.0 { floor } else { self.archive.gains(i)[j].max(floor) }
    }
}

impl Climb {
    pub(super) fn new(tuning: &Tuning, stage: usize) -> Self {
        Self {
            stage,
            centre: None,
            restart_pending: false,
            step: tuning.first_step,
            successes: 0,
            failures: 0,
            ends: vec![],
            restarts: 0,
            weight: 0,
            begun: 0,
            good: Good::default(),
        }
    }

    /// Turns to another objective, from the best point known for it.
    pub(super) fn set_stage(&mut self, view: &View<'_>, stage: usize) {
        self.stage = stage;
        self.ends.clear();
        self.restart_pending = false;
        self.begun = 0;
        self.begin(view.tuning, best_of(view, stage));
    }

    /// Climbs begun after the first.
    pub(super) fn restarts(&self) -> usize {
        self.restarts
    }

    fn begin(&mut self, tuning: &Tuning, centre: Option<usize>) {
        self.centre = centre;
        self.step = tuning.first_step;
        self.successes = 0;
        self.failures = 0;
    }

    pub(super) fn propose(
        &mut self,
        view: &View<'_>,
        models: &mut Models,
        rng: &mut ChaCha8Rng,
    ) -> (Vec<f64>, Step) {
        let dims = view.archive.dims();
        if let Some(best) = view.limits.best.get(self.stage).copied().flatten()
            && rng.random::<f64>() < self.polish_share(view)
        {
            return (polish(view.archive.unit(best), rng), Step::Polish(best));
        }
        if self.centre.is_none() && !self.restart_pending {
            self.turn(view);
        }
        let Some(centre) = self.centre else {
            if self.restart_pending {
                return (random_point(dims, rng), Step::Raw);
            }
            self.restart_pending = true;
            return (self.restart(view, models, rng), Step::Restart);
        };
        if rng.random::<f64>() < view.tuning.raw_share {
            return (self.raw_jump(view, centre, rng), Step::Raw);
        }
        (self.screened_step(view, models, centre, rng), Step::Screened)
    }

    /// The best point is worth polishing once a climb has ended there, and most when time runs out.
    fn polish_share(&self, view: &View<'_>) -> f64 {
        if !view.members.is_empty() {
            view.tuning.late_polish
        } else if self.ends.is_empty() {
            0.0
        } else {
            view.tuning.polish
        }
    }

    fn screened_step(
        &mut self,
        view: &View<'_>,
        models: &mut Models,
        centre: usize,
        rng: &mut ChaCha8Rng,
    ) -> Vec<f64> {
        let at = view.archive.unit(centre);
        self.update_good(view);
        let (good, step, count) = (&self.good.points, self.step, self.stage + 1);
        let (surrogate, candidates) =
            rayon::join(|| models.around(view, at, count), || around(view, at, good, step, rng));
        let (merit, distance) = self.judge(view, surrogate, &candidates);
        let weight = WEIGHTS[self.weight % WEIGHTS.len()];
        self.weight += 1;
        let (merit, distance) = (scaled(&merit), scaled(&distance));
        let score = |i: usize| weight * merit[i] + (1.0 - weight) * distance[i];
        let best = (0..merit.len()).reduce(|a, b| if score(b) > score(a) { b } else { a });
        best.map_or_else(|| random_point(at.len(), rng), |b| candidates[b * at.len()..][..at.len()].to_vec())
    }

    /// Predicted merit and distance to the nearest point known or pending, per candidate; candidates stand one
    /// behind the other.
    fn judge(&self, view: &View<'_>, surrogate: &Surrogate, candidates: &[f64]) -> (Vec<f64>, Vec<f64>) {
        let dims = view.archive.dims();
        let judged = candidates.par_chunks(JUDGED_TOGETHER * dims).flat_map_iter(|some| {
            let mut scratch = vec![];
            let mut gains = vec![0.0; self.stage + 1];
            some.chunks_exact(dims).map(move |x| {
                let known = surrogate.predict(x, &mut scratch, &mut gains);
                let nearest = view.pending.iter().map(|p| square_distance(p, x)).fold(known, f64::min);
                (view.merit(&gains, self.stage), nearest.sqrt())
            })
        });
        judged.unzip()
    }

    /// Half resets of one to three coordinates, half crossovers with another good point.
    fn raw_jump(&mut self, view: &View<'_>, centre: usize, rng: &mut ChaCha8Rng) -> Vec<f64> {
        let at = view.archive.unit(centre);
        if rng.random::<bool>()
            && let Some(other) = self.partner(view, centre, rng)
        {
            return crossover(at, view.archive.unit(other), rng);
        }
        reset(at, rng)
    }

    fn update_good(&mut self, view: &View<'_>) {
        let (archive, stage) = (view.archive, self.stage);
        let of = (self.begun, archive.len(), stage);
        if self.good.of == of {
            return;
        }
        let mut ranked: Vec<(f64, usize)> = (self.begun..archive.len())
            .filter(|&i| archive.hard(i) == 0.0)
            .map(|i| (view.merit_of(i, stage), i))
            .collect();
        let tenth = ranked.len().div_ceil(10);
        if tenth < ranked.len() {
            ranked.select_nth_unstable_by(tenth, |a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
            ranked.truncate(tenth);
        }
        let mut points: Vec<usize> = ranked.into_iter().map(|(_, i)| i).collect();
        points.sort_unstable();
        self.good = Good { of, points };
    }

    /// Another good point of this climb, away from the centre.
    fn partner(&mut self, view: &View<'_>, centre: usize, rng: &mut ChaCha8Rng) -> Option<usize> {
        self.update_good(view);
        let is_away = |&&i: &&usize| view.archive.distance(i, centre) > CROSSOVER_DISTANCE;
        let away: Vec<usize> = self.good.points.iter().filter(is_away).copied().collect();
        (!away.is_empty()).then(|| away[rng.random_range(0..away.len())])
    }

    /// Once climbs no longer begin anywhere, every other one goes on from the best point.
    fn turn(&mut self, view: &View<'_>) {
        self.restarts += 1;
        if !view.fresh
            && self.restarts % 2 == 1
            && let Some(best) = view.limits.best.get(self.stage).copied().flatten()
        {
            self.begun = 0;
            self.begin(view.tuning, Some(best));
        }
    }

    /// Where a climb apart from the best point starts: anywhere (later near a member), or between two ends.
    fn restart(&mut self, view: &View<'_>, models: &mut Models, rng: &mut ChaCha8Rng) -> Vec<f64> {
        let best = view.limits.best.get(self.stage).copied().flatten();
        match best {
            _ if !view.fresh && self.ends.len() > 1 => self.restart_between_ends(view, models, rng),
            Some(best) if !view.fresh => reset(view.archive.unit(best), rng),
            _ if !view.members.is_empty() => {
                let member = view.members[rng.random_range(0..view.members.len())];
                reset(view.archive.unit(member), rng)
            }
            _ => random_point(view.archive.dims(), rng),
        }
    }

    fn restart_between_ends(
        &mut self,
        view: &View<'_>,
        models: &mut Models,
        rng: &mut ChaCha8Rng,
    ) -> Vec<f64> {
        let mut candidates = vec![];
        for _ in 0..RESTART_CANDIDATES {
            let a = self.ends[rng.random_range(0..self.ends.len())];
            let b = self.ends[rng.random_range(0..self.ends.len())];
            let child = crossover(view.archive.unit(a), view.archive.unit(b), rng);
            let far = |&e: &usize| square_distance(&child, view.archive.unit(e)).sqrt() > RESTART_DISTANCE;
            if self.ends.iter().all(far) {
                candidates.extend(child);
            }
        }
        if candidates.is_empty() {
            return random_point(view.archive.dims(), rng);
        }
        let at = view.archive.unit(self.ends[self.ends.len() - 1]);
        let surrogate = models.around(view, at, self.stage + 1);
        let (merit, _) = self.judge(view, surrogate, &candidates);
        let best = (0..merit.len()).reduce(|a, b| if merit[b] > merit[a] { b } else { a }).unwrap_or(0);
        candidates[best * at.len()..][..at.len()].to_vec()
    }

    /// Learns from the evaluated point `i`.
    pub(super) fn absorb(&mut self, view: &View<'_>, i: usize, step: Step) {
        let Some(centre) = self.centre else {
            if step == Step::Restart {
                self.restart_pending = false;
                self.begun = i;
                self.begin(view.tuning, Some(i));
            }
            return;
        };
        if matches!(step, Step::Polish(base) if base != centre) {
            return;
        }
        if view.is_better(i, centre, self.stage, 0.0) {
            let clear = SUCCESS_GAIN * view.limits.range(self.stage);
            if step == Step::Screened && view.is_better(i, centre, self.stage, clear) {
                self.successes += 1;
                self.failures = 0;
            }
            self.centre = Some(i);
        } else if step == Step::Screened {
            self.successes = 0;
            self.failures += 1;
        }
        self.adapt(view);
    }

    fn adapt(&mut self, view: &View<'_>) {
        if self.successes >= SUCCESSES {
            self.step = (2.0 * self.step).min(view.tuning.first_step);
            self.successes = 0;
        }
        let patience = (view.tuning.patience * view.archive.dims() as f64) as usize;
        if self.failures as usize >= patience.max(LEAST_PATIENCE) {
            self.step /= 2.0;
            self.failures = 0;
        }
        if self.step < view.tuning.last_step {
            self.ends.extend(self.centre);
            if self.ends.len() > ENDS_KEPT {
                self.drop_worst_end(view);
            }
            self.begin(view.tuning, None);
        }
    }

    fn drop_worst_end(&mut self, view: &View<'_>) {
        let stage = self.stage;
        let worst = (0..self.ends.len())
            .reduce(|a, b| if view.is_better(self.ends[a], self.ends[b], stage, 0.0) { b } else { a });
        if let Some(worst) = worst {
            self.ends.remove(worst);
        }
    }
}

/// The best point of a stage: within limits if there is one, else the one that comes nearest.
pub(super) fn best_of(view: &View<'_>, stage: usize) -> Option<usize> {
    (0..view.archive.len()).reduce(|a, b| if view.is_better(b, a, stage, 0.0) { b } else { a })
}

/// Candidates around the centre of a climb, one behind the other.
fn around(view: &View<'_>, at: &[f64], good: &[usize], step: f64, rng: &mut ChaCha8Rng) -> Vec<f64> {
    let mut candidates = at.repeat(view.tuning.candidates);
    for point in candidates.chunks_exact_mut(at.len()) {
        if good.len() > 1 && rng.random::<f64>() < view.tuning.differences {
            step_along_difference(view, point, good, step, rng);
        } else {
            step_sparsely(point, view.tuning.coordinate_share, step, rng);
        }
    }
    candidates
}

/// A Gaussian step of a few coordinates, at least one, folded back into the cube.
pub(super) fn step_sparsely(point: &mut [f64], share: f64, step: f64, rng: &mut ChaCha8Rng) {
    let mut changed = false;
    for u in &mut *point {
        if rng.random::<f64>() < share {
            *u = reflect(*u + step * rng.sample::<f64, _>(StandardNormal));
            changed = true;
        }
    }
    if !changed && !point.is_empty() {
        let d = rng.random_range(0..point.len());
        point[d] = reflect(point[d] + step * rng.sample::<f64, _>(StandardNormal));
    }
}

/// Differences shorter than this say nothing of a direction.
const LEAST_DIFFERENCE: f64 = 1e-9;

/// A step along the difference of two good points, in all coordinates or a run of them (cyclic): along the ridges
/// on which good points lie. About as long as a sparse step.
fn step_along_difference(
    view: &View<'_>,
    point: &mut [f64],
    good: &[usize],
    step: f64,
    rng: &mut ChaCha8Rng,
) {
    let share = view.tuning.coordinate_share;
    let mut pick = || view.archive.unit(good[rng.random_range(0..good.len())]);
    let (a, b) = (pick(), pick());
    let length = square_distance(a, b).sqrt();
    if length < LEAST_DIFFERENCE {
        return step_sparsely(point, share, step, rng);
    }
    let dims = point.len();
    let factor = step * (share * dims as f64).sqrt() / length * rng.sample::<f64, _>(StandardNormal);
    let is_whole = rng.random::<bool>();
    let (from, count) = (rng.random_range(0..dims), rng.random_range(1..=dims));
    for (k, u) in point.iter_mut().enumerate() {
        if is_whole || (k + dims - from) % dims < count {
            *u = reflect(*u + factor * (a[k] - b[k]));
        }
    }
}

/// Widest and narrowest step of a polishing move, in widths of the unit cube.
const POLISH_STEPS: [f64; 2] = [0.3, 0.002];

/// One or two coordinates, by a step of any size: what no smooth model sees of a stepped objective.
fn polish(at: &[f64], rng: &mut ChaCha8Rng) -> Vec<f64> {
    let mut out = at.to_vec();
    let [widest, narrowest] = POLISH_STEPS;
    for _ in 0..rng.random_range(1..=2usize) {
        let d = rng.random_range(0..out.len());
        let step = widest * (narrowest / widest).powf(rng.random::<f64>());
        out[d] = (out[d] + step * (2.0 * rng.random::<f64>() - 1.0)).clamp(0.0, 1.0);
    }
    out
}

/// One to three coordinates anywhere.
pub(super) fn reset(at: &[f64], rng: &mut ChaCha8Rng) -> Vec<f64> {
    let mut out = at.to_vec();
    for _ in 0..rng.random_range(1..=3usize) {
        let d = rng.random_range(0..out.len());
        out[d] = rng.random::<f64>();
    }
    out
}

/// A run of neighbouring coordinates (cyclic) or a random half of them from `other`.
pub(super) fn crossover(at: &[f64], other: &[f64], rng: &mut ChaCha8Rng) -> Vec<f64> {
    let mut out = at.to_vec();
    let dims = out.len();
    if rng.random::<bool>() {
        let (from, length) = (rng.random_range(0..dims), rng.random_range(1..=dims));
        for d in (from..from + length).map(|d| d % dims) {
            out[d] = other[d];
        }
    } else {
        for (o, &u) in out.iter_mut().zip(other) {
            if rng.random::<bool>() {
                *o = u;
            }
        }
    }
    out
}

pub(super) fn random_point(dims: usize, rng: &mut ChaCha8Rng) -> Vec<f64> {
    (0..dims).map(|_| rng.random::<f64>()).collect()
}

/// Scales values to `[0, 1]`; all equal gives all 1.
fn scaled(values: &[f64]) -> Vec<f64> {
    let least = values.iter().copied().fold(f64::INFINITY, f64::min);
    let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let width = most - least;
    values.iter().map(|v| if width > 0.0 { (v - least) / width } else { 1.0 }).collect()
}

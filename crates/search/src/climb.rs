//! Climbing to the best point of one objective: DYCORS (Regis & Shoemaker 2013) with raw jumps.
//!
//! A surrogate screens sparse Gaussian steps from the best point of the present climb; a quarter of
//! the proposals are jumps that no model screens, because the objective has cliffs no model sees.
//! A climb whose step has become small has converged; its end is kept. The next ones start anywhere and keep
//! away from the ends known: the model knows all points, and would lead every climb back to the best one. They
//! borrow from their own points alone. After each, the best point is mixed with the ends: parameters that do not
//! act together are each as good there as anywhere. Later climbs, by turns, widen the step again at the best
//! point, or start from a crossover of ends. Meanwhile some proposals polish the best point: one or two
//! coordinates by steps of any size, since the objective is made of stairs.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;
use rayon::prelude::*;

use super::models::Models;
use super::space::{reflect, square_distance};
use super::surrogate::Surrogate;
use super::tuning::Tuning;
use super::view::View;

/// Weights of the predicted gain against the distance to what is known, taken in turn.
const WEIGHTS: [f64; 4] = [0.3, 0.5, 0.8, 0.95];
/// Successes in a row that double the step.
const SUCCESSES: u32 = 3;
/// Screened failures in a row that halve the step, at least.
const LEAST_PATIENCE: usize = 4;
/// Gain, relative to the range, that counts as a success.
const SUCCESS_GAIN: f64 = 1e-3;
/// Ends of climbs that are remembered.
const ENDS_KEPT: usize = 24;
/// Least distance of a restart from the known ends.
const RESTART_DISTANCE: f64 = 0.1;
/// A climb that begins anywhere keeps this far from the ends of earlier ones, in √n with n parameters.
const END_DISTANCE: f64 = 0.1;
/// Mixtures of the best point and the ends that are tried after each climb but the first.
const MIXTURES: usize = 12;
/// Least distance of a mixture from all that is known or pending.
const MIXTURE_NEWS: f64 = 1e-3;
/// Crossovers among which the model chooses a restart or a mixture.
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
    /// From this archive point, whichever climb is under way: near it, or mixed with an end.
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
    /// Whether it keeps away from the ends known.
    is_apart: bool,
    /// Points since then that came from another than its centre.
    aside: Vec<usize>,
    /// Mixtures of the best point and the ends that are still to be tried.
    mixtures: usize,
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
            is_apart: false,
            aside: vec![],
            mixtures: 0,
            good: Good::default(),
        }
    }

    /// Turns to another objective, from the best point known for it.
    pub(super) fn set_stage(&mut self, view: &View<'_>, stage: usize) {
        self.stage = stage;
        self.ends.clear();
        self.restart_pending = false;
        self.mixtures = 0;
        self.go_on(view.tuning, best_of(view, stage));
    }

    /// Climbs begun after the first.
    pub(super) fn restarts(&self) -> usize {
        self.restarts
    }

    /// Begins from a known point, with all that is known.
    fn go_on(&mut self, tuning: &Tuning, centre: Option<usize>) {
        self.begun = 0;
        self.aside.clear();
        self.is_apart = false;
        self.begin(tuning, centre);
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
        if let Some(best) = view.limits.best.get(self.stage).copied().flatten() {
            if rng.random::<f64>() < self.polish_share(view) {
                return (polish(view.archive.unit(best), rng), Step::Polish(best));
            }
            if self.mixtures > 0 {
                self.mixtures -= 1;
                if let Some(mixture) = self.mixture(view, models, best, rng) {
                    return (mixture, Step::Polish(best));
                }
            }
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
        let point = |i: usize| &candidates[i * at.len()..][..at.len()];
        let allowed = (0..merit.len()).filter(|&i| !self.is_apart || self.is_off_ends(view, point(i)));
        let best = allowed.reduce(|a, b| if score(b) > score(a) { b } else { a });
        best.map_or_else(|| random_point(at.len(), rng), |b| point(b).to_vec())
    }

    /// Whether no end known is near: then another optimum may be.
    fn is_off_ends(&self, view: &View<'_>, x: &[f64]) -> bool {
        let least = END_DISTANCE * END_DISTANCE * x.len() as f64;
        self.ends.iter().all(|&e| square_distance(x, view.archive.unit(e)) > least)
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
            .filter(|i| !self.is_apart || self.aside.binary_search(i).is_err())
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
            self.go_on(view.tuning, Some(best));
        }
    }

    /// Where a climb apart from the best point starts: anywhere (later near a member), or between two ends.
    fn restart(&mut self, view: &View<'_>, models: &mut Models, rng: &mut ChaCha8Rng) -> Vec<f64> {
        let best = view.limits.best.get(self.stage).copied().flatten();
        self.is_apart = view.fresh && view.members.is_empty();
        self.aside.clear();
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

    /// The best point with some coordinates of an end or a member: the one that the model holds to be best.
    fn mixture(
        &self,
        view: &View<'_>,
        models: &mut Models,
        best: usize,
        rng: &mut ChaCha8Rng,
    ) -> Option<Vec<f64>> {
        let at = view.archive.unit(best);
        let away = |&e: &usize| view.archive.distance(e, best) > RESTART_DISTANCE;
        let donors: Vec<usize> = self.ends.iter().chain(view.members).copied().filter(away).collect();
        if donors.is_empty() {
            return None;
        }
        let mut candidates = vec![];
        for _ in 0..RESTART_CANDIDATES {
            let donor = donors[rng.random_range(0..donors.len())];
            candidates.extend(crossover(at, view.archive.unit(donor), rng));
        }
        let surrogate = models.around(view, at, self.stage + 1);
        let (merit, distance) = self.judge(view, surrogate, &candidates);
        let new = (0..merit.len()).filter(|&i| distance[i] > MIXTURE_NEWS);
        let chosen = new.reduce(|a, b| if merit[b] > merit[a] { b } else { a })?;
        Some(candidates[chosen * at.len()..][..at.len()].to_vec())
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
        if matches!(step, Step::Polish(base) if Some(base) != self.centre) {
            self.aside.push(i);
        }
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
            self.mixtures = if self.ends.len() > 1 { MIXTURES } else { 0 };
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

#[cfg(test)]
mod tests {
    use rand::SeedableRng;

    use super::super::archive::{Archive, Limits};
    use super::*;
    use crate::{Evaluation, Objective, Sense};

    const DIMS: usize = 6;

    fn objective() -> Objective {
        Objective { name: "f".into(), sense: Sense::Max, threshold: 0.7, is_score: true, is_penalty: false }
    }

    /// A hill in the middle, measured at random places, at its top and somewhat aside of it.
    fn hill() -> Archive {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let mut archive = Archive::new(DIMS, 1);
        let mut points: Vec<Vec<f64>> = (0..80).map(|_| random_point(DIMS, &mut rng)).collect();
        points.extend([vec![0.5; DIMS], [vec![0.8], vec![0.5; DIMS - 1]].concat()]);
        for u in points {
            let value = 3.0 - u.iter().map(|v| (v - 0.5).powi(2)).sum::<f64>();
            let told = Evaluation { values: vec![value], violation: 0.0, ..Evaluation::default() };
            archive.push(&u, u.clone(), &told, &[objective()]);
        }
        archive
    }

    fn view<'a>(archive: &'a Archive, limits: &'a Limits, tuning: &'a Tuning) -> View<'a> {
        View { archive, limits, tuning, fresh: true, members: &[], pending: &[] }
    }

    #[test]
    fn a_climb_that_begins_anywhere_is_not_led_back_to_a_known_end() {
        let (archive, tuning) = (hill(), Tuning { raw_share: 0.0, polish: 0.0, ..Tuning::default() });
        let limits = Limits::of(&archive, &[objective()], true);
        let view = view(&archive, &limits, &tuning);
        let (end, start) = (archive.len() - 2, archive.len() - 1);
        let nearest = |is_apart: bool| {
            let mut climb =
                Climb { ends: vec![end], centre: Some(start), is_apart, ..Climb::new(&tuning, 0) };
            let (mut models, mut rng) = (Models::new(2, 100), ChaCha8Rng::seed_from_u64(1));
            let mut ask = || climb.propose(&view, &mut models, &mut rng).0;
            let distances = (0..40).map(|_| square_distance(&ask(), archive.unit(end)).sqrt());
            distances.fold(f64::INFINITY, f64::min)
        };
        let least = END_DISTANCE * (DIMS as f64).sqrt();
        assert!(
            nearest(true) > least && nearest(false) < least,
            "{} {} {least}",
            nearest(true),
            nearest(false)
        );
    }

    #[test]
    fn the_best_point_is_mixed_with_an_end_that_is_better_in_some_parameters() {
        let mut rng = ChaCha8Rng::seed_from_u64(3);
        let mut archive = Archive::new(DIMS, 1);
        // One end is at the top of the first half of the parameters, the other at that of the second.
        let ends = [[0.5, 0.5, 0.5, 0.2, 0.2, 0.2], [0.1, 0.1, 0.1, 0.5, 0.5, 0.5]];
        let mut points: Vec<Vec<f64>> = (0..80).map(|_| random_point(DIMS, &mut rng)).collect();
        points.extend(ends.map(|end| end.to_vec()));
        for u in &points {
            let value = 3.0 - u.iter().map(|v| (v - 0.5).powi(2)).sum::<f64>();
            let told = Evaluation { values: vec![value], violation: 0.0, ..Evaluation::default() };
            archive.push(u, u.clone(), &told, &[objective()]);
        }
        let (tuning, first) = (Tuning::default(), archive.len() - 2);
        let limits = Limits::of(&archive, &[objective()], true);
        let view = view(&archive, &limits, &tuning);
        let climb = Climb { ends: vec![first, first + 1], ..Climb::new(&tuning, 0) };
        let mixture = climb.mixture(&view, &mut Models::new(2, 100), first, &mut rng).unwrap();
        assert!(square_distance(&mixture, &[0.5; DIMS]) < 1e-12, "{mixture:?}");
        let alone = Climb { ends: vec![first], ..Climb::new(&tuning, 0) };
        assert!(alone.mixture(&view, &mut Models::new(2, 100), first, &mut rng).is_none());
    }
}

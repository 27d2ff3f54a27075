//! Spreading the diverse set: members move only to points inside their thresholds (spec 7, Decision).
//!
//! One of the closest pair moves at a time, to the place farthest from the others that the surrogate
//! holds to be inside. How sure it has to be (`caution`) is steered by how often it was right.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::climb::{View, crossover, reset, sparse_step};
use super::members::{closest_pair, improve_by_swaps, key, select, soft_minimum};
use super::surrogate::Surrogate;

/// Steps of the Gaussian proposals, in widths of the unit cube.
const STEPS: [f64; 3] = [0.03, 0.1, 0.2];
/// Share of coordinates that a Gaussian proposal changes.
const GAUSSIAN_SHARE: f64 = 0.4;
/// Shares of the kinds of proposals: resets, Gaussian steps; the rest are crossovers.
const RESET_SHARE: f64 = 0.47;
const GAUSSIAN_KIND_SHARE: f64 = 0.29;
/// How much the caution changes with one success, in ranges.
const CAUTION_STEP: f64 = 0.007;

/// The diverse set while it spreads.
#[derive(Clone, Debug)]
pub(super) struct Spread {
    count: usize,
    members: Vec<usize>,
    caution: f64,
    surrogates: Vec<Surrogate>,
    turn: usize,
}

impl Spread {
    pub(super) fn new(count: usize) -> Self {
        Self { count, members: vec![], caution: 0.0, surrogates: vec![Surrogate::default(); count], turn: 0 }
    }

    pub(super) fn members(&self) -> &[usize] {
        &self.members
    }

    fn is_inside(view: &View<'_>, i: usize, margin: f64) -> bool {
        view.archive.hard(i) == 0.0
            && view.limits.admits(view.archive.gains(i), view.archive.objectives(), margin)
    }

    fn pool(view: &View<'_>, margin: f64) -> Vec<usize> {
        (0..view.archive.len()).filter(|&i| Self::is_inside(view, i, margin)).collect()
    }

    /// Chooses the set anew where a member has fallen outside or is missing.
    pub(super) fn refresh(&mut self, view: &View<'_>, margin: f64) {
        let best = view.limits.best.last().copied().flatten();
        let pinned = !view.tuning.keep_best || self.members.first().copied() == best;
        let whole = self.members.len() == self.count;
        if whole && pinned && self.members.iter().all(|&m| Self::is_inside(view, m, margin)) {
            return;
        }
        let pool = Self::pool(view, margin);
        self.members = best.map_or_else(Vec::new, |b| select(view.archive, &pool, b, self.count));
        if !view.tuning.keep_best {
            self.loosen_first(view, &pool);
        }
    }

    /// Without `keep_best` the first member may be exchanged like any other.
    fn loosen_first(&mut self, view: &View<'_>, pool: &[usize]) {
        for _ in 0..2 * self.members.len() {
            self.members.rotate_left(1);
            improve_by_swaps(view.archive, pool, &mut self.members);
        }
    }

    /// A last pass over everything evaluated, at the bare thresholds.
    pub(super) fn settle(&mut self, view: &View<'_>, margin: f64) {
        self.refresh(view, margin);
        let pool = Self::pool(view, margin);
        improve_by_swaps(view.archive, &pool, &mut self.members);
        if !view.tuning.keep_best {
            self.loosen_first(view, &pool);
        }
    }

    /// The next point to evaluate; `None` while there are no two members to spread.
    pub(super) fn propose(&mut self, view: &View<'_>, margin: f64, rng: &mut ChaCha8Rng) -> Option<Vec<f64>> {
        let m = self.choose(view, rng)?;
        self.swap_from_archive(view, m, margin);
        let at = view.archive.unit(self.members[m]).to_vec();
        let candidates = self.candidates(view, m, margin, rng);
        if candidates.is_empty() {
            return Some(reset(&at, rng));
        }
        let objectives = view.archive.objectives();
        let surrogate = &mut self.surrogates[m];
        surrogate.sync(view.archive, &at, view.tuning.neighbours);
        surrogate.fit(objectives, |i, j| view.lesson(i, j));
        let mut scratch = vec![];
        let mut gains = vec![0.0; objectives];
        let mut best: Option<(bool, f64, usize)> = None;
        for (c, (distance, x)) in candidates.iter().enumerate() {
            surrogate.predict(x, &mut scratch, &mut gains);
            let slack = view.limits.slack(&gains, objectives, margin);
            let sure = slack >= self.caution;
            let merit = (sure, if sure { *distance } else { slack }, c);
            if best.is_none_or(|b| (merit.0, merit.1) > (b.0, b.1)) {
                best = Some(merit);
            }
        }
        best.map(|(_, _, c)| candidates[c].1.clone())
    }

    /// Which member moves: one of the closest pair, now and then any. The kept best never does.
    fn choose(&mut self, view: &View<'_>, rng: &mut ChaCha8Rng) -> Option<usize> {
        let (a, b, _) = closest_pair(view.archive, &self.members)?;
        self.turn += 1;
        let first = usize::from(view.tuning.keep_best);
        let any = rng.random::<f64>() < view.tuning.any_member;
        let m = if any {
            rng.random_range(first..self.members.len())
        } else if rng.random::<bool>() {
            a
        } else {
            b
        };
        Some(if m < first { b } else { m })
    }

    fn swap_from_archive(&mut self, view: &View<'_>, m: usize, margin: f64) {
        let mut best = (key(view.archive, &self.members, m, self.members[m]), self.members[m]);
        for i in Self::pool(view, margin) {
            let k = key(view.archive, &self.members, m, i);
            if k > best.0 {
                best = (k, i);
            }
        }
        self.members[m] = best.1;
    }

    /// Proposals for member `m` that would stand farther off than it does, with that distance.
    fn candidates(
        &self,
        view: &View<'_>,
        m: usize,
        margin: f64,
        rng: &mut ChaCha8Rng,
    ) -> Vec<(f64, Vec<f64>)> {
        let archive = view.archive;
        let at = archive.unit(self.members[m]);
        let now = key(archive, &self.members, m, self.members[m]);
        let pool = Self::pool(view, margin);
        let mut out = vec![];
        for _ in 0..view.tuning.spread_candidates {
            let kind = rng.random::<f64>();
            let x = if kind < RESET_SHARE {
                reset(at, rng)
            } else if kind < RESET_SHARE + GAUSSIAN_KIND_SHARE || pool.is_empty() {
                sparse_step(at, GAUSSIAN_SHARE, STEPS[rng.random_range(0..STEPS.len())], rng)
            } else {
                crossover(at, archive.unit(pool[rng.random_range(0..pool.len())]), rng)
            };
            let distance = self.stand_off(view, m, &x);
            if distance > now {
                out.push((distance, x));
            }
        }
        out
    }

    /// Distance of `x` from the other members and from what is asked already, as a soft minimum.
    fn stand_off(&self, view: &View<'_>, m: usize, x: &[f64]) -> f64 {
        let others = self.members.iter().enumerate().filter(|&(o, _)| o != m);
        soft_minimum(others.map(|(_, &i)| super::space::square_distance(view.archive.unit(i), x).sqrt()))
    }

    /// Learns from the evaluated point `i`, asked for member `m` or not: it is taken where it stands
    /// farther off than a member of the closest pair, and inside.
    pub(super) fn absorb(&mut self, view: &View<'_>, i: usize, margin: f64, is_spread: bool) {
        let inside = Self::is_inside(view, i, margin);
        if is_spread {
            let acceptance = view.tuning.acceptance;
            let change = if inside { -(1.0 - acceptance) } else { acceptance };
            self.caution += CAUTION_STEP * change;
        }
        if !inside {
            return;
        }
        let first = usize::from(view.tuning.keep_best);
        let lead = |m: usize| {
            key(view.archive, &self.members, m, i) - key(view.archive, &self.members, m, self.members[m])
        };
        let Some((a, b, _)) = closest_pair(view.archive, &self.members) else { return };
        let taken = [a, b]
            .into_iter()
            .filter(|&m| m >= first && lead(m) > 0.0)
            .reduce(|x, y| if lead(y) > lead(x) { y } else { x });
        if let Some(m) = taken {
            self.members[m] = i;
        }
    }
}

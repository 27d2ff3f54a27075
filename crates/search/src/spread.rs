//! Spreading the diverse set: members move only to points inside their thresholds (spec 7, Decision).
//!
//! One of the closest pair moves at a time, to the place farthest from the others that the surrogate
//! holds to be inside. How sure it has to be (`caution`) is steered by how often it was right.

use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::archive::Limits;
use super::climb::{crossover, reset, step_sparsely};
use super::members::{closest_pair, improve_by_swaps, key, key_above, select, soft_minimum};
use super::models::Models;
use super::space::square_distance;
use super::surrogate::Surrogate;
use super::view::View;

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
    /// Archive points that are members whatever they are worth.
    pinned: Vec<usize>,
    /// The pinned first.
    members: Vec<usize>,
    /// How many of the first members never move: the pinned, and the best where it is kept.
    fixed: usize,
    caution: f64,
    /// Points inside the thresholds, of the first `pooled` of the archive, under `pool_limits`.
    pool: Vec<usize>,
    pooled: usize,
    pool_limits: Limits,
    pool_margin: f64,
    /// The members as they were when the whole archive was last looked through for member `m`.
    searched: Vec<Vec<usize>>,
}

impl Spread {
    pub(super) fn new(count: usize, pinned: Vec<usize>) -> Self {
        Self {
            count,
            fixed: pinned.len(),
            pinned,
            members: vec![],
            caution: 0.0,
            pool: vec![],
            pooled: 0,
            pool_limits: Limits::default(),
            pool_margin: 0.0,
            searched: vec![vec![]; count],
        }
    }

    /// The same set without what it has learnt.
    pub(super) fn with_members(&self) -> Self {
        let members = self.members.clone();
        Self { members, fixed: self.fixed, ..Self::new(self.count, self.pinned.clone()) }
    }

    pub(super) fn members(&self) -> &[usize] {
        &self.members
    }

    fn is_inside(view: &View<'_>, i: usize, margin: f64) -> bool {
        view.archive.hard(i) == 0.0
            && view.limits.admits(view.archive.gains(i), view.archive.objectives(), margin)
    }

    fn update_pool(&mut self, view: &View<'_>, margin: f64) {
        if self.pool_limits != *view.limits || self.pool_margin != margin {
            self.pool_limits = view.limits.clone();
            self.pool_margin = margin;
            self.pool.clear();
            self.pooled = 0;
        }
        let new = self.pooled..view.archive.len();
        self.pool.extend(new.filter(|&i| Self::is_inside(view, i, margin)));
        self.pooled = view.archive.len();
    }

    /// Chooses the set anew where a member has fallen outside or is missing.
    pub(super) fn refresh(&mut self, view: &View<'_>, margin: f64) {
        self.update_pool(view, margin);
        let best = view.limits.best.last().copied().flatten();
        let mut fixed: Vec<usize> = self.pinned.iter().copied().filter(|&p| p < view.archive.len()).collect();
        let pinned = fixed.len();
        let keeps_best = view.tuning.keep_best || self.count == 1;
        fixed.extend(best.filter(|b| keeps_best && !fixed.contains(b)));
        let whole = self.members.len() == self.count && self.members.starts_with(&fixed);
        let free = self.members.get(pinned..).unwrap_or_default();
        if whole && free.iter().all(|&m| Self::is_inside(view, m, margin)) {
            return;
        }
        self.fixed = fixed.len();
        if !fixed.is_empty() {
            self.members = select(view.archive, &self.pool, &fixed, self.count);
            return;
        }
        self.members = best.map_or_else(Vec::new, |b| select(view.archive, &self.pool, &[b], self.count));
        self.loosen_first(view);
    }

    /// Where no member is fixed, the first may be exchanged like any other.
    fn loosen_first(&mut self, view: &View<'_>) {
        for _ in 0..2 * self.members.len() {
            self.members.rotate_left(1);
            improve_by_swaps(view.archive, &self.pool, &mut self.members, 1);
        }
    }

    /// A last pass over everything evaluated, at the bare thresholds.
    pub(super) fn settle(&mut self, view: &View<'_>, margin: f64) {
        self.refresh(view, margin);
        improve_by_swaps(view.archive, &self.pool, &mut self.members, self.fixed);
        if self.fixed == 0 {
            self.loosen_first(view);
        }
    }

    /// The next point to evaluate; `None` while there are no two members to spread. Members that are `sent` somewhere in
    /// this batch are sent again only when all are.
    pub(super) fn propose(
        &mut self,
        view: &View<'_>,
        models: &mut Models,
        (margin, sent): (f64, &mut Vec<usize>),
        rng: &mut ChaCha8Rng,
    ) -> Option<Vec<f64>> {
        let mut chosen = self.choose(view, sent, rng);
        if chosen.is_none() {
            sent.clear();
            chosen = self.choose(view, sent, rng);
        }
        let m = chosen?;
        sent.push(m);
        self.swap_from_archive(view, m);
        let at = view.archive.unit(self.members[m]).to_vec();
        let mut candidates = self.candidates(view, m, rng);
        if candidates.is_empty() {
            return Some(reset(&at, rng));
        }
        let surrogate = models.around(view, &at, view.archive.objectives());
        self.judge(view, surrogate, &candidates, margin).map(|c| candidates.swap_remove(c).1)
    }

    /// The candidate that stands farthest off among those that the surrogate holds to be inside; where there is
    /// none, the one nearest to it.
    fn judge(
        &self,
        view: &View<'_>,
        surrogate: &Surrogate,
        candidates: &[(f64, Vec<f64>)],
        margin: f64,
    ) -> Option<usize> {
        let objectives = view.archive.objectives();
        let mut scratch = vec![];
        let mut gains = vec![0.0; objectives];
        let mut most: Option<(f64, usize)> = None;
        for c in farthest_first(candidates) {
            surrogate.predict(&candidates[c].1, &mut scratch, &mut gains);
            let slack = view.limits.slack(&gains, objectives, margin);
            if slack >= self.caution {
                return Some(c);
            }
            if most.is_none_or(|(best, _)| slack > best) {
                most = Some((slack, c));
            }
        }
        most.map(|(_, c)| c)
    }

    /// Which member moves: one of the closest pair, now and then any. A fixed one never does.
    fn choose(&mut self, view: &View<'_>, sent: &[usize], rng: &mut ChaCha8Rng) -> Option<usize> {
        let moves = |m: usize| m >= self.fixed && !sent.contains(&m);
        let (a, b, _) = closest_pair(view.archive, &self.members, moves)?;
        let any = rng.random::<f64>() < view.tuning.any_member;
        let m = if any {
            rng.random_range(self.fixed..self.members.len())
        } else if rng.random::<bool>() {
            a
        } else {
            b
        };
        Some([m, a, b].into_iter().find(|&m| moves(m)).unwrap_or(b))
    }

    /// Member `m` goes to the archive point inside that stands farthest off. New points were compared
    /// when they came, so this is due only after the others have moved.
    fn swap_from_archive(&mut self, view: &View<'_>, m: usize) {
        if self.searched[m] == self.members {
            return;
        }
        let mut best = (key(view.archive, &self.members, m, self.members[m]), self.members[m]);
        for &i in &self.pool {
            if let Some(key) = key_above(view.archive, &self.members, m, i, best.0) {
                best = (key, i);
            }
        }
        self.members[m] = best.1;
        self.searched[m].clone_from(&self.members);
    }

    /// Proposals for member `m` that would stand farther off than it does, with that distance.
    fn candidates(&self, view: &View<'_>, m: usize, rng: &mut ChaCha8Rng) -> Vec<(f64, Vec<f64>)> {
        let archive = view.archive;
        let at = archive.unit(self.members[m]);
        let now = key(archive, &self.members, m, self.members[m]);
        let pool = &self.pool;
        let mut out = vec![];
        for _ in 0..view.tuning.spread_candidates {
            let kind = rng.random::<f64>();
            let x = if kind < RESET_SHARE {
                reset(at, rng)
            } else if kind < RESET_SHARE + GAUSSIAN_KIND_SHARE || pool.is_empty() {
                let mut x = at.to_vec();
                step_sparsely(&mut x, GAUSSIAN_SHARE, STEPS[rng.random_range(0..STEPS.len())], rng);
                x
            } else {
                crossover(at, archive.unit(pool[rng.random_range(0..pool.len())]), rng)
            };
            if let Some(distance) = self.stand_off(view, m, &x, now) {
                out.push((distance, x));
            }
        }
        out
    }

    /// Distance of `x` from the other members, as a soft minimum, if it exceeds `least`.
    fn stand_off(&self, view: &View<'_>, m: usize, x: &[f64], least: f64) -> Option<f64> {
        let others = self.members.iter().enumerate().filter(|&(o, _)| o != m);
        let distances = others.map(|(_, &i)| square_distance(view.archive.unit(i), x));
        if distances.clone().any(|square| square <= least * least) {
            return None;
        }
        Some(soft_minimum(distances.map(f64::sqrt))).filter(|&d| d > least)
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
        let lead = |m: usize| {
            key(view.archive, &self.members, m, i) - key(view.archive, &self.members, m, self.members[m])
        };
        let Some((a, b, _)) = closest_pair(view.archive, &self.members, |m| m >= self.fixed) else { return };
        let taken = [a, b]
            .into_iter()
            .filter(|&m| m >= self.fixed && lead(m) > 0.0)
            .reduce(|x, y| if lead(y) > lead(x) { y } else { x });
        if let Some(m) = taken {
            self.members[m] = i;
        }
    }
}

/// Indices of candidates, the one that would stand farthest off first.
fn farthest_first(candidates: &[(f64, Vec<f64>)]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..candidates.len()).collect();
    order.sort_by(|&a, &b| candidates[b].0.total_cmp(&candidates[a].0).then(a.cmp(&b)));
    order
}

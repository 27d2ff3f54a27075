//! CMA-ES as ask and tell, after Hansen's tutorial (arXiv 1604.00772): active (negative) weights,
//! eigen-decomposition only as often as the covariance has changed enough, named stop reasons.

use std::collections::VecDeque;

use nalgebra::{DMatrix, SymmetricEigen};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rand_distr::StandardNormal;

use super::space::reflect;

/// Where samples may lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Domain {
    /// Anywhere.
    Free,
    /// In the unit cube: samples are folded back at its faces, none is drawn twice.
    UnitCube,
}

/// Why a CMA-ES run has nothing more to find.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CmaStop {
    /// Costs no longer change (`tolfun`).
    FlatCosts,
    /// Steps have become as small as numbers go (`tolx`).
    SmallSteps,
    /// The covariance has become ill-conditioned (`conditioncov`).
    IllConditioned,
}

/// Costs that differ by less are the same.
const COST_TOLERANCE: f64 = 1e-11;
/// Steps smaller than this share of the first one end the run.
const STEP_TOLERANCE: f64 = 1e-11;
/// Iterations of an eigen-decomposition for each coordinate (LAPACK's `dsteqr` allows as many).
const EIGEN_ITERATIONS: usize = 30;
/// Condition number of the covariance that ends the run.
const CONDITION_LIMIT: f64 = 1e14;

/// Strategy parameters (tutorial, table 1).
#[derive(Clone, Debug)]
struct Strategy {
    lambda: usize,
    weights: Vec<f64>,
    mu_eff: f64,
    c_sigma: f64,
    d_sigma: f64,
    c_c: f64,
    c_1: f64,
    c_mu: f64,
    /// E ‖N(0, I)‖.
    chi: f64,
    /// Generations between eigen-decompositions.
    lazy: u64,
}

impl Strategy {
    fn new(dims: usize) -> Self {
        let n = dims as f64;
        let lambda = 4 + (3.0 * n.ln()).floor() as usize;
        let raw: Vec<f64> =
            (1..=lambda).map(|i| ((lambda as f64 + 1.0) / 2.0).ln() - (i as f64).ln()).collect();
        let effective = |keep: fn(f64) -> bool| {
            let chosen = raw.iter().filter(|w| keep(**w));
            chosen.clone().sum::<f64>().powi(2) / chosen.map(|w| w * w).sum::<f64>()
        };
        let (mu_eff, mu_eff_negative) = (effective(|w| w > 0.0), effective(|w| w <= 0.0));
        let c_1 = 2.0 / ((n + 1.3).powi(2) + mu_eff);
        let c_mu = (2.0 * (0.25 + mu_eff + 1.0 / mu_eff - 2.0) / ((n + 2.0).powi(2) + mu_eff)).min(1.0 - c_1);
        let most_negative = (1.0 + c_1 / c_mu)
            .min(1.0 + 2.0 * mu_eff_negative / (mu_eff + 2.0))
            .min((1.0 - c_1 - c_mu) / (n * c_mu));
        let positive: f64 = raw.iter().filter(|w| **w > 0.0).sum();
        let negative: f64 = -raw.iter().filter(|w| **w <= 0.0).sum::<f64>();
        let scale = |w: &f64| if *w > 0.0 { w / positive } else { most_negative * w / negative };
        let c_sigma = (mu_eff + 2.0) / (n + mu_eff + 5.0);
        Self {
            lambda,
            weights: raw.iter().map(scale).collect(),
            mu_eff,
            c_sigma,
            d_sigma: 1.0 + 2.0 * (((mu_eff - 1.0) / (n + 1.0)).sqrt() - 1.0).max(0.0) + c_sigma,
            c_c: (4.0 + mu_eff / n) / (n + 4.0 + 2.0 * mu_eff / n),
            c_1,
            c_mu,
            chi: n.sqrt() * (1.0 - 1.0 / (4.0 * n) + 1.0 / (21.0 * n * n)),
            lazy: ((1.0 / (10.0 * n * (c_1 + c_mu))).floor() as u64).max(1),
        }
    }
}

/// One run of CMA-ES; minimises.
#[derive(Clone, Debug)]
pub struct Cma {
    domain: Domain,
    strategy: Strategy,
    rng: ChaCha8Rng,
    mean: Vec<f64>,
    sigma: f64,
    first_sigma: f64,
    path_sigma: Vec<f64>,
    path_c: Vec<f64>,
    covariance: DMatrix<f64>,
    /// Eigenvectors as columns and square roots of the eigenvalues.
    basis: DMatrix<f64>,
    scales: Vec<f64>,
    generation: u64,
    steps: Vec<Vec<f64>>,
    recent: VecDeque<f64>,
    stop: Option<CmaStop>,
}

impl Cma {
    /// A run from `start` with standard deviation `sigma` in every coordinate; at least one coordinate.
    pub fn new(start: &[f64], sigma: f64, seed: u64, domain: Domain) -> Self {
        let n = start.len();
        Self {
            domain,
            strategy: Strategy::new(n.max(1)),
            rng: ChaCha8Rng::seed_from_u64(seed),
            mean: start.to_vec(),
            sigma,
            first_sigma: sigma,
            path_sigma: vec![0.0; n],
            path_c: vec![0.0; n],
            covariance: DMatrix::identity(n, n),
            basis: DMatrix::identity(n, n),
            scales: vec![1.0; n],
            generation: 0,
            steps: vec![],
            recent: VecDeque::new(),
            stop: None,
        }
    }

    /// Points of one generation, λ = 4 + ⌊3 ln n⌋ of them, each inside the domain.
    pub fn ask(&mut self) -> Vec<Vec<f64>> {
        let n = self.mean.len();
        self.steps.clear();
        for _ in 0..self.strategy.lambda {
            let z: Vec<f64> =
                (0..n).map(|k| self.scales[k] * self.rng.sample::<f64, _>(StandardNormal)).collect();
            let step = (0..n).map(|i| (0..n).map(|k| self.basis[(i, k)] * z[k]).sum()).collect();
            self.steps.push(step);
        }
        self.steps.iter().map(|step| self.place(step)).collect()
    }

    fn place(&self, step: &[f64]) -> Vec<f64> {
        let free = self.mean.iter().zip(step).map(|(m, y)| m + self.sigma * y);
        match self.domain {
            Domain::Free => free.collect(),
            Domain::UnitCube => free.map(reflect).collect(),
        }
    }

    /// Takes the costs of the last generation in the order asked; NaN counts as worst.
    pub fn tell(&mut self, costs: &[f64]) {
        if costs.len() != self.steps.len() || self.steps.is_empty() {
            return;
        }
        let cost = |i: usize| if costs[i].is_nan() { f64::INFINITY } else { costs[i] };
        let mut order: Vec<usize> = (0..costs.len()).collect();
        order.sort_by(|&a, &b| cost(a).total_cmp(&cost(b)).then(a.cmp(&b)));
        let steps = std::mem::take(&mut self.steps);
        let ranked: Vec<&[f64]> = order.iter().map(|&i| &steps[i][..]).collect();
        self.generation += 1;
        self.update(&ranked);
        self.look_for_stop(cost(order[0]), cost(order[order.len() - 1]));
    }

    fn update(&mut self, ranked: &[&[f64]]) {
        let s = &self.strategy;
        let n = self.mean.len();
        let mut shift = vec![0.0; n];
        for (w, y) in s.weights.iter().zip(ranked).filter(|(w, _)| **w > 0.0) {
            shift.iter_mut().zip(*y).for_each(|(m, y)| *m += w * y);
        }
        self.mean.iter_mut().zip(&shift).for_each(|(m, y)| *m += self.sigma * y);
        let whitened = self.whiten(&shift);
        let pull = (s.c_sigma * (2.0 - s.c_sigma) * s.mu_eff).sqrt();
        for (p, w) in self.path_sigma.iter_mut().zip(&whitened) {
            *p = (1.0 - s.c_sigma) * *p + pull * w;
        }
        let length = norm(&self.path_sigma);
        let settled = (1.0 - (1.0 - s.c_sigma).powf(2.0 * self.generation as f64)).sqrt();
        let is_short = length / settled < (1.4 + 2.0 / (n as f64 + 1.0)) * s.chi;
        let pull = if is_short { (s.c_c * (2.0 - s.c_c) * s.mu_eff).sqrt() } else { 0.0 };
        for (p, y) in self.path_c.iter_mut().zip(&shift) {
            *p = (1.0 - s.c_c) * *p + pull * y;
        }
        let forgotten = if is_short { 0.0 } else { s.c_c * (2.0 - s.c_c) };
        let growth = ((s.c_sigma / s.d_sigma) * (length / s.chi - 1.0)).min(1.0);
        self.update_covariance(ranked, forgotten);
        self.sigma *= growth.exp();
        if self.generation.is_multiple_of(self.strategy.lazy) {
            self.decompose();
        }
    }

    fn update_covariance(&mut self, ranked: &[&[f64]], forgotten: f64) {
        let s = &self.strategy;
        let n = self.mean.len();
        let total: f64 = s.weights.iter().sum();
        let keep = 1.0 + s.c_1 * forgotten - s.c_1 - s.c_mu * total;
        let signed = |(w, y): (&f64, &&[f64])| {
            if *w >= 0.0 { *w } else { w * n as f64 / norm(&self.whiten(y)).powi(2).max(f64::MIN_POSITIVE) }
        };
        let weights: Vec<f64> = s.weights.iter().zip(ranked).map(signed).collect();
        for i in 0..n {
            for j in 0..=i {
                let spread: f64 = weights.iter().zip(ranked).map(|(w, y)| w * y[i] * y[j]).sum();
                let value = keep * self.covariance[(i, j)]
                    + s.c_1 * self.path_c[i] * self.path_c[j]
                    + s.c_mu * spread;
                self.covariance[(i, j)] = value;
                self.covariance[(j, i)] = value;
            }
        }
    }

    /// `C^(-1/2) y`, with the covariance as last decomposed.
    fn whiten(&self, y: &[f64]) -> Vec<f64> {
        let n = y.len();
        let inner: Vec<f64> =
            (0..n).map(|k| (0..n).map(|i| self.basis[(i, k)] * y[i]).sum::<f64>() / self.scales[k]).collect();
        (0..n).map(|i| (0..n).map(|k| self.basis[(i, k)] * inner[k]).sum()).collect()
    }

    fn decompose(&mut self) {
        let is_finite = self.covariance.iter().all(|v| v.is_finite());
        let most_iterations = EIGEN_ITERATIONS * self.mean.len();
        let eigen = SymmetricEigen::try_new(self.covariance.clone(), f64::EPSILON, most_iterations);
        let Some(SymmetricEigen { eigenvectors, eigenvalues: values }) = eigen.filter(|_| is_finite) else {
            self.stop = Some(CmaStop::IllConditioned);
            return;
        };
        let (least, most) = values.iter().fold((f64::INFINITY, 0.0f64), |(a, b), &v| (a.min(v), b.max(v)));
        if least.is_nan() || least <= 0.0 || most > CONDITION_LIMIT * least {
            self.stop = Some(CmaStop::IllConditioned);
            return;
        }
        self.scales = values.iter().map(|v| v.sqrt()).collect();
        self.basis = eigenvectors;
    }

    fn look_for_stop(&mut self, best: f64, worst: f64) {
        let n = self.mean.len();
        let window = 10 + (30 * n).div_ceil(self.strategy.lambda);
        self.recent.push_back(best);
        if self.recent.len() > window {
            self.recent.pop_front();
        }
        let least = self.recent.iter().copied().fold(f64::INFINITY, f64::min);
        let most = self.recent.iter().copied().fold(worst, f64::max);
        if self.recent.len() == window && (most - least < COST_TOLERANCE || least == f64::INFINITY) {
            self.stop.get_or_insert(CmaStop::FlatCosts);
        }
        let widest = (0..n).map(|i| self.covariance[(i, i)].sqrt()).fold(0.0, f64::max);
        if self.sigma * widest < STEP_TOLERANCE * self.first_sigma {
            self.stop.get_or_insert(CmaStop::SmallSteps);
        }
    }

    /// Why the run has ended; `None` while it goes on.
    pub fn stop(&self) -> Option<CmaStop> {
        self.stop
    }

    /// The mean, folded into the domain: where the run thinks the optimum is.
    pub fn mean(&self) -> Vec<f64> {
        self.place(&vec![0.0; self.mean.len()])
    }
}

fn norm(v: &[f64]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// First standard deviation, in widths of the unit cube. The paper publishes none.
pub(super) const FIRST_SIGMA: f64 = 0.3;

#[cfg(test)]
mod tests {
    use super::*;

    fn rosenbrock(x: &[f64]) -> f64 {
        x.windows(2).map(|w| 100.0 * (w[1] - w[0] * w[0]).powi(2) + (1.0 - w[0]).powi(2)).sum()
    }

    fn ellipsoid(x: &[f64]) -> f64 {
        let n = x.len() as f64 - 1.0;
        x.iter().enumerate().map(|(i, v)| 1e6f64.powf(i as f64 / n) * v * v).sum()
    }

    /// Best cost after each number of evaluations in `at`, median of 15 seeds, dim 10, x0 = 2, σ = 0.5.
    fn medians(f: fn(&[f64]) -> f64, at: [usize; 2]) -> [f64; 2] {
        let mut found = [vec![], vec![]];
        for seed in 1..=15 {
            let mut cma = Cma::new(&[2.0; 10], 0.5, seed, Domain::Free);
            let (mut best, mut evaluations, mut next) = (f64::INFINITY, 0, 0);
            while next < 2 {
                let costs: Vec<f64> = cma.ask().iter().map(|x| f(x)).collect();
                for c in &costs {
                    evaluations += 1;
                    best = best.min(*c);
                    if next < 2 && evaluations == at[next] {
                        found[next].push(best);
                        next += 1;
                    }
                }
                cma.tell(&costs);
            }
        }
        found.map(|mut v| {
            v.sort_by(f64::total_cmp);
            v[7]
        })
    }

    /// pycma 4.5 is at 5e-10 and 3e-22 (Rosenbrock), 8e-9 and 9e-22 (ellipsoid) after 4,000 and 6,000
    /// evaluations: about 3,800 and 4,000 to 1e-8. Within a factor 1.2 of these: below 1e-8 at 4,600
    /// and 4,800, and below pycma's second figure at 7,200.
    #[test]
    fn needs_at_most_a_fifth_more_evaluations_than_pycma() {
        for (f, at) in [(rosenbrock as fn(&[f64]) -> f64, [4600, 7200]), (ellipsoid, [4800, 7200])] {
            let [first, second] = medians(f, at);
            assert!(first < 1e-8, "{first:e}");
            assert!(second < 3e-22, "{second:e}");
        }
    }

    #[test]
    fn stays_in_the_cube_and_finds_an_optimum_on_its_face() {
        let mut cma = Cma::new(&[0.5; 5], 0.3, 7, Domain::UnitCube);
        let mut best = f64::INFINITY;
        while cma.stop().is_none() {
            let asked = cma.ask();
            assert!(asked.iter().flatten().all(|u| (0.0..=1.0).contains(u)));
            let costs: Vec<f64> = asked.iter().map(|x| x.iter().map(|u| (u - 1.2).powi(2)).sum()).collect();
            best = costs.iter().copied().fold(best, f64::min);
            cma.tell(&costs);
        }
        assert!(best < 0.2001, "{best}");
    }

    #[test]
    fn says_why_it_stops() {
        let mut flat = Cma::new(&[0.5; 3], 0.3, 1, Domain::UnitCube);
        for _ in 0..200 {
            let count = flat.ask().len();
            flat.tell(&vec![1.0; count]);
        }
        assert_eq!(flat.stop(), Some(CmaStop::FlatCosts));
        let mut lost = Cma::new(&[0.5; 3], 0.3, 1, Domain::UnitCube);
        for _ in 0..200 {
            let count = lost.ask().len();
            lost.tell(&vec![f64::NAN; count]);
        }
        assert_eq!(lost.stop(), Some(CmaStop::FlatCosts));
    }
}

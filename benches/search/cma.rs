//! CMA-ES alone: evaluations until a cost of 1e-8, as pycma's `fmin` counts them.

use enfilade_search::{Cma, Domain};

const DIMS: usize = 10;
const START: f64 = 2.0;
const SIGMA: f64 = 0.5;
const TARGET: f64 = 1e-8;
/// A run that has not arrived by then counts as this many.
const MOST_EVALUATIONS: usize = 20_000;

fn rosenbrock(x: &[f64]) -> f64 {
    x.windows(2).map(|w| 100.0 * (w[1] - w[0] * w[0]).powi(2) + (1.0 - w[0]).powi(2)).sum()
}

fn ellipsoid(x: &[f64]) -> f64 {
    let last = x.len() as f64 - 1.0;
    x.iter().enumerate().map(|(i, v)| 1e6f64.powf(i as f64 / last) * v * v).sum()
}

/// Prints median and range over seeds, from a start of 2 in every coordinate with σ = 0.5, in 10 dimensions.
pub fn print(seeds: u64) {
    for (name, f) in [("rosenbrock", rosenbrock as fn(&[f64]) -> f64), ("ellipsoid", ellipsoid)] {
        let mut counts: Vec<usize> = (1..=seeds).map(|seed| evaluations(f, seed)).collect();
        counts.sort_unstable();
        println!("{name:10} {} [{}, {}]", counts[counts.len() / 2], counts[0], counts[counts.len() - 1]);
    }
}

fn evaluations(f: fn(&[f64]) -> f64, seed: u64) -> usize {
    let mut cma = Cma::new(&[START; DIMS], SIGMA, seed, Domain::Free);
    let mut count = 0;
    while cma.stop().is_none() && count < MOST_EVALUATIONS {
        let costs: Vec<f64> = cma.ask().iter().map(|x| f(x)).collect();
        if let Some(hit) = costs.iter().position(|c| *c < TARGET) {
            return count + hit + 1;
        }
        count += costs.len();
        cma.tell(&costs);
    }
    MOST_EVALUATIONS
}

//! Algorithm 2 as published: members leave `p_0` one after another, each with a CMA state of its own.

use super::archive::{Archive, Limits, violation};
use super::cma::{Cma, Domain, FIRST_SIGMA};
use super::space::square_distance;

/// Weight w of the distances in `div`, per unit of √n. The paper publishes no value; with this one a
/// member gives up about a tenth of a range of its thresholds for distance.
const DISTANCE_WEIGHT: f64 = 0.05;
/// Weight w_m of the missing distance to the nearest member, per unit of n.
const NEAREST_WEIGHT: f64 = 1.0;

/// `div(p, 𝒟)` of eq. diversity-metric for a point and the other members, lengths in √n.
pub(super) fn div(x: &[f64], others: &[&[f64]], d_min: f64) -> f64 {
    let widest = (x.len().max(1) as f64).sqrt();
    let distances = others.iter().map(|o| square_distance(o, x).sqrt() / widest);
    let nearest = distances.clone().fold(f64::INFINITY, f64::min);
    let missing = (nearest - d_min).min(0.0);
    DISTANCE_WEIGHT * distances.sum::<f64>() - NEAREST_WEIGHT * missing * missing
}

/// The members, round robin.
#[derive(Clone, Debug)]
pub(super) struct RoundRobin {
    runs: Vec<Cma>,
    turn: usize,
    d_min: f64,
    /// Best of the newest generation of each member, as an archive index.
    newest: Vec<Option<usize>>,
}

impl RoundRobin {
    pub(super) fn new(start: &[f64], count: usize, d_min: f64, seed: u64) -> Self {
        let run = |m: usize| {
            let own = seed.wrapping_add(0x9E37_79B9_7F4A_7C15u64.wrapping_mul(m as u64 + 1));
            Cma::new(start, FIRST_SIGMA, own, Domain::UnitCube)
        };
        Self { runs: (0..count).map(run).collect(), turn: 0, d_min, newest: vec![None; count] }
    }

    /// λ candidates of the member whose turn it is.
    pub(super) fn ask(&mut self) -> Vec<Vec<f64>> {
        self.runs[self.turn].ask()
    }

    /// Updates that member with the archive points from `first` on; the next one's turn.
    pub(super) fn tell(&mut self, archive: &Archive, limits: &Limits, first: usize) {
        let means: Vec<Vec<f64>> = self.runs.iter().map(Cma::mean).collect();
        let others: Vec<&[f64]> =
            means.iter().enumerate().filter(|&(m, _)| m != self.turn).map(|(_, x)| &x[..]).collect();
        let cost = |i: usize| violation(archive, limits, i) - div(archive.unit(i), &others, self.d_min);
        let costs: Vec<f64> = (first..archive.len()).map(cost).collect();
        let best = (0..costs.len()).min_by(|&a, &b| costs[a].total_cmp(&costs[b]));
        self.newest[self.turn] = best.map(|b| first + b);
        self.runs[self.turn].tell(&costs);
        self.turn = (self.turn + 1) % self.runs.len();
    }

    /// Where the members are: their means.
    pub(super) fn means(&self) -> Vec<Vec<f64>> {
        self.runs.iter().map(Cma::mean).collect()
    }

    /// The newest evaluated point of each member that has one.
    pub(super) fn newest(&self) -> Vec<usize> {
        self.newest.iter().copied().flatten().collect()
    }

    pub(super) fn is_converged(&self) -> bool {
        self.runs.iter().all(|run| run.stop().is_some())
    }
}

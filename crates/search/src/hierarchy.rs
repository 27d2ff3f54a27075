//! Algorithm 1 as published: objective by objective with CMA-ES from `p_0`, each under the soft
//! thresholds of those before it; then Algorithm 2.

use super::archive::{Archive, Limits, violation};
use super::cma::{Cma, Domain, FIRST_SIGMA};
use super::diversity::RoundRobin;
use super::members::min_distance;
use super::{Mode, Objective, Study};

/// The objective being optimised.
struct Stage<'a> {
    archive: &'a Archive,
    limits: &'a Limits,
    stage: usize,
    from: usize,
}

impl Stage<'_> {
    /// `g_h − f`, the gain in units of what the present layout has, so that it stands beside `g_h`.
    fn cost(&self, i: usize) -> f64 {
        let start = self.archive.gains(0)[self.stage].abs();
        let unit = if start.is_finite() && start > 0.0 { start } else { 1.0 };
        violation(self.archive, self.limits, i) - self.archive.gains(i)[self.stage] / unit
    }

    /// `p_opt`: the best point of this stage, or the start.
    fn best(&self) -> Option<usize> {
        let own = std::iter::once(0).chain(self.from..self.archive.len());
        own.filter(|&i| self.archive.hard(i) == 0.0)
            .reduce(|a, b| if self.cost(b) < self.cost(a) { b } else { a })
    }
}

/// What the generation in hand is for.
#[derive(Clone, Debug)]
enum Phase {
    Climb(Box<Cma>),
    Spread(RoundRobin),
    /// The members' means are being evaluated; then nothing is left to do.
    Last,
}

/// State of the published method.
#[derive(Clone, Debug)]
pub(super) struct Hierarchy {
    objectives: Vec<Objective>,
    start: Vec<f64>,
    members: usize,
    d_min: f64,
    seed: u64,
    diverse: bool,
    budget: Option<u64>,
    stage: usize,
    stage_from: usize,
    phase: Phase,
    /// T: the thresholds of the objectives done.
    limits: Limits,
    /// The thresholds as everything evaluated has them, for who looks on.
    known: Limits,
    /// Points of the generation that are not asked yet, and where its first one lies in the archive.
    queue: Vec<Vec<f64>>,
    generation_from: usize,
    found: Vec<usize>,
    done: bool,
}

impl Hierarchy {
    pub(super) fn new(study: &Study, start: Vec<f64>) -> Self {
        Self {
            objectives: study.objectives.clone(),
            phase: Phase::Climb(Box::new(Cma::new(&start, FIRST_SIGMA, study.seed, Domain::UnitCube))),
            start,
            members: study.members,
            d_min: study.d_min,
            seed: study.seed,
            diverse: study.mode == Mode::Diverse,
            budget: study.evaluations,
            stage: 0,
            stage_from: 0,
            limits: Limits::default(),
            known: Limits::default(),
            queue: vec![],
            generation_from: 0,
            found: vec![],
            done: false,
        }
    }

    pub(super) fn ask(&mut self, archive: &Archive, count: usize) -> Vec<Vec<f64>> {
        if self.queue.is_empty() {
            self.generation_from = archive.len();
            self.queue = match &mut self.phase {
                Phase::Climb(run) => run.ask(),
                Phase::Spread(members) => members.ask(),
                Phase::Last => vec![],
            };
        }
        self.queue.drain(..count.min(self.queue.len())).collect()
    }

    pub(super) fn tell(&mut self, archive: &Archive, first: usize) {
        if first == 0 || (first..archive.len()).any(|i| self.known.moved_by(archive, i)) {
            self.known = Limits::of(archive, &self.objectives, false);
        }
        if archive.len() == 1 {
            return;
        }
        if self.queue.is_empty() {
            self.end_generation(archive);
        }
        self.end_phase(archive);
    }

    fn end_generation(&mut self, archive: &Archive) {
        let from = self.generation_from;
        match &mut self.phase {
            Phase::Climb(run) => {
                let stage = Stage { archive, limits: &self.limits, stage: self.stage, from: self.stage_from };
                let costs: Vec<f64> = (from..archive.len()).map(|i| stage.cost(i)).collect();
                run.tell(&costs);
            }
            Phase::Spread(members) => {
                members.tell(archive, &self.limits, from);
                self.found = members.newest();
            }
            Phase::Last => {
                self.found = (from..archive.len()).collect();
                self.done = true;
            }
        }
    }

    pub(super) fn set_budget(&mut self, evaluations: u64) {
        self.budget = Some(evaluations);
    }

    /// Evaluations of one phase: the budget in equal parts, one an objective, diversity included.
    fn share(&self) -> usize {
        let parts = self.objectives.len() + usize::from(self.diverse);
        self.budget.map_or(usize::MAX, |b| (b as usize / parts).max(1))
    }

    fn end_phase(&mut self, archive: &Archive) {
        let spent = archive.len() - self.stage_from >= self.share();
        let left = self.budget.map_or(usize::MAX, |b| (b as usize).saturating_sub(archive.len()));
        match &self.phase {
            Phase::Climb(run) if spent || run.stop().is_some() => self.next_stage(archive),
            Phase::Spread(members) if left <= self.members || members.is_converged() => {
                self.queue = members.means();
                self.generation_from = archive.len();
                self.phase = Phase::Last;
            }
            _ => {}
        }
    }

    fn next_stage(&mut self, archive: &Archive) {
        self.queue.clear();
        let stage = Stage { archive, limits: &self.limits, stage: self.stage, from: self.stage_from };
        let best = stage.best();
        self.limits.add(archive, &self.objectives[self.stage], best);
        self.stage_from = archive.len();
        if self.stage + 1 < self.objectives.len() {
            self.stage += 1;
            let seed = self.seed.wrapping_add(self.stage as u64);
            self.phase = Phase::Climb(Box::new(Cma::new(&self.start, FIRST_SIGMA, seed, Domain::UnitCube)));
        } else if self.diverse {
            self.phase = Phase::Spread(RoundRobin::new(&self.start, self.members, self.d_min, self.seed));
        } else {
            self.done = true;
        }
    }

    /// The members: their evaluated means at the end, before that the best of their newest samples.
    pub(super) fn members(&self) -> Vec<usize> {
        self.found.clone()
    }

    /// T where it is complete, else what it would be now.
    pub(super) fn limits(&self) -> &Limits {
        if self.limits.best.len() == self.objectives.len() { &self.limits } else { &self.known }
    }

    pub(super) fn stage(&self) -> usize {
        self.stage
    }

    pub(super) fn is_spreading(&self) -> bool {
        !matches!(self.phase, Phase::Climb(_))
    }

    pub(super) fn min_distance(&self, archive: &Archive) -> f64 {
        min_distance(archive, &self.found)
    }

    pub(super) fn is_converged(&self) -> bool {
        self.done
    }
}

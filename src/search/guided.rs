//! The default method: climb with a surrogate, then spread with it, over one archive.
//!
//! Objectives are climbed in order, as Algorithm 1 has them, but nothing evaluated is lost between
//! them: every point serves every surrogate and every threshold. When the climbing share of the
//! budget is spent, most evaluations spread the diverse set and some keep climbing.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::archive::{Archive, Limits};
use super::climb::{Climb, Step, View};
use super::members::min_distance;
use super::models::Models;
use super::spread::Spread;
use super::tuning::Tuning;
use super::{Mode, Objective, Study};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Climb(Step),
    Spread,
}

/// State of the default method.
#[derive(Clone, Debug)]
pub(super) struct Guided {
    rng: ChaCha8Rng,
    tuning: Tuning,
    objectives: Vec<Objective>,
    spreads: bool,
    budget: Option<u64>,
    stage: usize,
    climb: Climb,
    spread: Spread,
    models: Models,
    limits: Limits,
    asked: Vec<Kind>,
}

impl Guided {
    pub(super) fn new(study: &Study, tuning: Tuning) -> Self {
        Self {
            rng: ChaCha8Rng::seed_from_u64(study.seed),
            objectives: study.objectives.clone(),
            spreads: study.mode == Mode::Diverse && study.members > 1,
            budget: study.evaluations,
            stage: 0,
            climb: Climb::new(&tuning),
            spread: Spread::new(study.members),
            models: Models::new(study.members + 1),
            limits: Limits::default(),
            asked: vec![],
            tuning,
        }
    }

    /// Share of the budget used, 0 without one.
    fn used(&self, evaluations: usize) -> f64 {
        self.budget.map_or(0.0, |b| evaluations as f64 / b as f64)
    }

    fn climb_share(&self) -> f64 {
        if self.spreads { self.tuning.climb_share } else { 1.0 }
    }

    /// Whether evaluation number `n` climbs.
    fn climbs(&mut self, n: usize) -> bool {
        let used = self.used(n);
        if !self.spreads || used < self.climb_share() {
            return true;
        }
        let fade = ((1.0 - used) / (1.0 - self.tuning.fade_from)).clamp(0.0, 1.0);
        self.rng.random::<f64>() < self.tuning.late_climb * fade
    }

    pub(super) fn ask(&mut self, archive: &Archive, count: usize) -> Vec<Vec<f64>> {
        let mut out: Vec<Vec<f64>> = vec![];
        self.asked.clear();
        self.turn_stage(archive);
        for b in 0..count {
            let climbs = self.climbs(archive.len() + b);
            let mut proposal = None;
            if !climbs {
                let (limits, tuning) = (&self.limits, &self.tuning);
                let members = self.spread.members().to_vec();
                let view = View { archive, limits, tuning, members: &members, pending: &out };
                self.spread.refresh(&view, tuning.margin);
                proposal = self
                    .spread
                    .propose(&view, &mut self.models, tuning.margin, &mut self.rng)
                    .map(|x| (x, Kind::Spread));
            }
            let (x, kind) = proposal.unwrap_or_else(|| {
                let view = View {
                    archive,
                    limits: &self.limits,
                    tuning: &self.tuning,
                    members: self.spread.members(),
                    pending: &out,
                };
                let (x, step) = self.climb.propose(&view, &mut self.models, &mut self.rng);
                (x, Kind::Climb(step))
            });
            out.push(x);
            self.asked.push(kind);
        }
        out
    }

    /// Goes to the next objective when this one's share of the climbing budget is spent.
    fn turn_stage(&mut self, archive: &Archive) {
        let share = self.climb_share() / self.objectives.len() as f64;
        let due = ((self.used(archive.len()) / share) as usize).min(self.objectives.len() - 1);
        if due != self.stage {
            self.stage = due;
            let view = View {
                archive,
                limits: &self.limits,
                tuning: &self.tuning,
                members: self.spread.members(),
                pending: &[],
            };
            self.climb.set_stage(&view, due);
        }
    }

    /// Learns from the points from `first` on, in the order they were asked.
    pub(super) fn tell(&mut self, archive: &Archive, first: usize) {
        for i in first..archive.len() {
            if i == 0 || self.limits.moved_by(archive, i) {
                self.limits = Limits::of(archive, &self.objectives);
            }
            let kind = self.asked.get(i - first).copied().unwrap_or(Kind::Climb(Step::Raw));
            let members = self.spread.members().to_vec();
            let view =
                View { archive, limits: &self.limits, tuning: &self.tuning, members: &members, pending: &[] };
            if let Kind::Climb(step) = kind {
                self.climb.absorb(&view, i, if i == 0 { Step::Restart } else { step });
            }
            if !members.is_empty() {
                self.spread.absorb(&view, i, self.tuning.margin, kind == Kind::Spread);
            }
        }
    }

    /// The diverse set as it stands, inside the bare thresholds.
    pub(super) fn members(&self, archive: &Archive) -> Vec<usize> {
        let mut spread = self.spread.with_members();
        let view = View { archive, limits: &self.limits, tuning: &self.tuning, members: &[], pending: &[] };
        spread.settle(&view, self.tuning.margin);
        spread.members().to_vec()
    }

    pub(super) fn stage(&self) -> usize {
        self.stage
    }

    pub(super) fn is_spreading(&self) -> bool {
        !self.spread.members().is_empty()
    }

    pub(super) fn limits(&self) -> &Limits {
        &self.limits
    }

    pub(super) fn min_distance(&self, archive: &Archive) -> f64 {
        min_distance(archive, self.spread.members())
    }

    pub(super) fn is_converged(&self) -> bool {
        false
    }
}

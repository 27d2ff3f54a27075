//! The default method: climb with a surrogate, then spread with it, over one archive.
//!
//! Objectives are climbed in order, as Algorithm 1 has them, but nothing evaluated is lost between
//! them: every point serves every surrogate and every threshold. When the climbing share of the
//! budget is spent, most evaluations spread the diverse set and some keep climbing.

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::archive::{Archive, Limits};
use super::climb::{Climb, Step};
use super::members::min_distance;
use super::models::Models;
use super::spread::Spread;
use super::tuning::Tuning;
use super::view::View;
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
    members: usize,
    spreads: bool,
    budget: Option<u64>,
    /// Objectives that are climbed, in order.
    climbed: Vec<usize>,
    stage: usize,
    climb: Climb,
    spread: Spread,
    climb_models: Models,
    spread_models: Models,
    limits: Limits,
    /// The limits as the spreading found them.
    standing: Option<Limits>,
    asked: Vec<Kind>,
    course: Course,
    /// How far thresholds have yielded.
    yielding: Yielding,
    /// Evaluations after which a search without a budget ends: known once its climbs have converged.
    enough: Option<u64>,
}

/// Surrogates of the climbing: around its centre and around the best point.
const CLIMB_MODELS: usize = 2;

/// Room that a climb which begins anywhere needs, in mean lengths of the climbs so far.
const CLIMB_ROOM: f64 = 0.5;

/// How much of them is left after each step that thresholds yield.
const YIELD_STEP: f64 = 0.85;
/// Share of the spreading after which they may yield for the first time: members need some to part.
const YIELD_FROM: f64 = 0.25;
/// Share of the spreading from one step to the next.
const YIELD_EVERY: f64 = 0.1;
/// Share of the spreading from which they stand: what is left goes to spreading inside them.
const YIELD_UNTIL: f64 = 0.85;

/// Thresholds that give way while they leave no room for members that differ.
#[derive(Clone, Debug)]
struct Yielding {
    least_share: f64,
    d_min: f64,
    /// What is left of the thresholds stated.
    share: f64,
    /// Share of the spreading at which they may yield next.
    due: f64,
}

impl Yielding {
    fn new(study: &Study) -> Self {
        Self { least_share: study.least_share, d_min: study.d_min, share: 1.0, due: YIELD_FROM }
    }

    /// Whether thresholds never yield. Then every late find counts in all of them: members keep the shares stated
    /// of what was found until the end.
    fn is_firm(&self) -> bool {
        self.least_share >= 1.0
    }

    /// The factor by which the thresholds fall, now that this share of the spreading is done and the
    /// closest members stand so far apart; `None` where they stand.
    fn step(&mut self, spread: f64, distance: f64, dims: usize) -> Option<f64> {
        if spread < self.due || spread >= YIELD_UNTIL {
            return None;
        }
        self.due += YIELD_EVERY;
        let wanted = self.d_min * (dims as f64).sqrt();
        let share = (self.share * YIELD_STEP).max(self.least_share);
        if distance >= wanted || share >= self.share {
            return None;
        }
        let factor = share / self.share;
        self.share = share;
        Some(factor)
    }
}

/// Evaluations of a stage before its convergence is judged, a parameter and at least.
const COURSE_PER_DIMENSION: usize = 15;
const COURSE_LEAST: usize = 120;
/// What is reached of the converged value when a climb without a budget ends.
const CONVERGED_SHARE: f64 = 0.95;

/// How the best value of a stage has risen, evaluation by evaluation.
#[derive(Clone, Debug, Default)]
struct Course {
    tops: Vec<f64>,
}

impl Course {
    /// Whether about 95 % of the converged rise is reached. What is still to come is taken from the
    /// last two doublings of the evaluations, as a geometric series.
    fn is_converged(&self, dims: usize) -> bool {
        let n = self.tops.len();
        if n < COURSE_LEAST.max(COURSE_PER_DIMENSION * dims) {
            return false;
        }
        let [first, quarter, half, last] = [0, n / 4, n / 2, n - 1].map(|i| self.tops[i]);
        let (before, now) = (half - quarter, last - half);
        let ratio = if before > 0.0 { (now / before).min(0.9) } else { 0.9 };
        let to_come = now * ratio / (1.0 - ratio);
        last - first >= CONVERGED_SHARE * (last - first + to_come)
    }
}

/// Which objectives are climbed: a penalty that need only not grow has its limit from the start.
fn climbed(objectives: &[Objective]) -> Vec<usize> {
    let needs = |&j: &usize| !(objectives[j].is_penalty && objectives[j].threshold == 0.0);
    let found: Vec<usize> = (0..objectives.len()).filter(needs).collect();
    if found.is_empty() { vec![0] } else { found }
}

impl Guided {
    pub(super) fn new(study: &Study, tuning: Tuning) -> Self {
        let climbed = climbed(&study.objectives);
        Self {
            rng: ChaCha8Rng::seed_from_u64(study.seed),
            objectives: study.objectives.clone(),
            members: study.members,
            spreads: study.mode == Mode::Diverse && study.members > 1,
            budget: study.evaluations,
            stage: climbed[0],
            climb: Climb::new(&tuning, climbed[0]),
            climbed,
            spread: Spread::new(study.members, (1..=study.pinned).collect()),
            climb_models: Models::new(CLIMB_MODELS, tuning.neighbours),
            spread_models: Models::new(study.members, tuning.spread_neighbours),
            limits: Limits::default(),
            standing: None,
            asked: vec![],
            course: Course::default(),
            yielding: Yielding::new(study),
            enough: None,
            tuning,
        }
    }

    pub(super) fn set_budget(&mut self, evaluations: u64) {
        self.budget = Some(evaluations);
    }

    /// Share of the budget used, 0 while there is none.
    fn used(&self, evaluations: usize) -> f64 {
        self.budget.or(self.enough).map_or(0.0, |b| evaluations as f64 / b as f64)
    }

    fn climb_share(&self) -> f64 {
        if self.spreads { self.tuning.climb_share } else { 1.0 }
    }

    /// Whether a climb that begins after that many evaluations begins anywhere: as long as the stage has room for
    /// half of another one like those so far, since what is begun is climbed on beside the spread. Without a
    /// budget every other one.
    fn is_fresh(&self, evaluations: usize) -> bool {
        let Some(budget) = self.budget else {
            return self.climb.restarts().is_multiple_of(2);
        };
        let now = self.climbed.iter().position(|&j| j == self.stage).unwrap_or(0);
        let until = self.climb_share() * (now + 1) as f64 / self.climbed.len() as f64;
        let mean = evaluations as f64 / (self.climb.restarts() + 1) as f64;
        evaluations as f64 + CLIMB_ROOM * mean <= until * budget as f64
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
        self.yield_thresholds(archive);
        let mut sent = vec![];
        for b in 0..count {
            let climbs = self.climbs(archive.len() + b);
            let mut proposal = None;
            if !climbs {
                if self.limits.are_known() {
                    self.standing.get_or_insert_with(|| self.limits.clone());
                }
                let (limits, tuning) = (&self.limits, &self.tuning);
                let members = self.spread.members().to_vec();
                let view = View { archive, limits, tuning, members: &members, pending: &out, fresh: false };
                self.spread.refresh(&view, tuning.margin);
                proposal = self
                    .spread
                    .propose(&view, &mut self.spread_models, (tuning.margin, &mut sent), &mut self.rng)
                    .map(|x| (x, Kind::Spread));
            }
            let (x, kind) = proposal.unwrap_or_else(|| {
                let view = View {
                    archive,
                    limits: &self.limits,
                    tuning: &self.tuning,
                    members: self.spread.members(),
                    pending: &out,
                    fresh: self.is_fresh(archive.len()),
                };
                let (x, step) = self.climb.propose(&view, &mut self.climb_models, &mut self.rng);
                (x, Kind::Climb(step))
            });
            out.push(x);
            self.asked.push(kind);
        }
        out
    }

    /// Lowers the thresholds where they leave no room.
    fn yield_thresholds(&mut self, archive: &Archive) {
        if self.standing.is_none() {
            return;
        }
        let spread = (self.used(archive.len()) - self.climb_share()) / (1.0 - self.climb_share());
        let distance = self.min_distance(archive);
        if let Some(factor) = self.yielding.step(spread, distance, archive.dims()) {
            for objective in &mut self.objectives {
                objective.threshold *= factor;
            }
            self.limits = self.limits.with_thresholds_of(&self.objectives);
            self.standing = Some(self.limits.clone());
        }
    }

    pub(super) fn threshold_share(&self) -> f64 {
        self.yielding.share
    }

    /// Goes to the next objective when this one's share of the climbing budget is spent, or, without
    /// a budget, when it has converged.
    fn turn_stage(&mut self, archive: &Archive) {
        let now = self.climbed.iter().position(|&j| j == self.stage).unwrap_or(0);
        let last = self.climbed.len() - 1;
        let share = self.climb_share() / self.climbed.len() as f64;
        let next = if self.budget.is_some() {
            ((self.used(archive.len()) / share) as usize).clamp(now, last)
        } else if self.enough.is_none() && self.course.is_converged(archive.dims()) {
            if now == last {
                self.enough = Some((archive.len() as f64 / self.climb_share()) as u64);
            }
            (now + 1).min(last)
        } else {
            now
        };
        let due = self.climbed[next];
        if due != self.stage {
            self.stage = due;
            self.course = Course::default();
            let view = View {
                archive,
                limits: &self.limits,
                tuning: &self.tuning,
                members: self.spread.members(),
                pending: &[],
                fresh: false,
            };
            self.climb.set_stage(&view, due);
        }
    }

    /// Learns from the points from `first` on, in the order they were asked.
    pub(super) fn tell(&mut self, archive: &Archive, first: usize) {
        for i in first..archive.len() {
            if i == 0 || self.limits.moved_by(archive, i) {
                self.limits = match &self.standing {
                    Some(standing) if self.yielding.is_firm() => standing.anew(archive, &self.objectives),
                    Some(standing) => standing.with_last_anew(archive, &self.objectives),
                    None => Limits::of(archive, &self.objectives, self.yielding.is_firm()),
                };
            }
            self.course.tops.push(self.limits.top(self.stage));
            let kind = self.asked.get(i - first).copied().unwrap_or(Kind::Climb(Step::Raw));
            let members = self.spread.members().to_vec();
            let view = View {
                archive,
                limits: &self.limits,
                tuning: &self.tuning,
                members: &members,
                pending: &[],
                fresh: false,
            };
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
        let view = View {
            archive,
            limits: &self.limits,
            tuning: &self.tuning,
            members: &[],
            pending: &[],
            fresh: false,
        };
        spread.settle(&view, self.tuning.margin);
        if spread.members().len() < self.members {
            spread.settle(&view, 0.0);
        }
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

    /// Whether a search without a budget has found about what it would find.
    pub(super) fn is_converged(&self, archive: &Archive) -> bool {
        self.enough.is_some_and(|n| archive.len() as u64 >= n)
    }
}

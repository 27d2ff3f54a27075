//! The optimiser: vectors, bounds and a seed in; asks and is told; knows no wall.
//!
//! [`Search::ask`] gives a batch of parameter vectors, [`Search::tell`] takes what they are worth, in
//! the same order; the search never calls user code. The same study and the same evaluations give the
//! same asks, bit for bit: randomness comes from the seed, and nothing here uses threads, clocks or
//! hashed order.
//!
//! The highest point of a hill, by asking and telling:
//!
//! ```
//! use enfilade_search::{Evaluation, Method, Mode, Objective, Search, Sense, Study};
//!
//! let height = |p: &[f64]| 4.0 - (p[0] - 1.0).powi(2) - (p[1] + 0.5).powi(2);
//! let objective = Objective {
//!     name: "height".into(),
//!     sense: Sense::Max,
//!     threshold: 0.9,
//!     is_score: false,
//!     is_penalty: false,
//! };
//! let mut search = Search::new(Study {
//!     bounds: vec![[-2.0, 2.0]; 2],
//!     start: vec![0.0, 0.0],
//!     objectives: vec![objective],
//!     members: 1,
//!     d_min: 0.25,
//!     least_share: 1.0,
//!     seed: 1,
//!     evaluations: Some(200),
//!     method: Method::Default,
//!     mode: Mode::Best,
//!     batch: 8,
//!     seeds: vec![],
//!     pinned: 0,
//! })?;
//! loop {
//!     let asked = search.ask();
//!     if asked.is_empty() {
//!         break;
//!     }
//!     let worth = |p: &Vec<f64>| Evaluation { values: vec![height(p)], ..Evaluation::default() };
//!     search.tell(&asked.iter().map(worth).collect::<Vec<_>>());
//! }
//! assert!(search.outcome().best.values[0] > 3.9);
//! # Ok::<(), enfilade_report::Error>(())
//! ```

mod archive;
mod climb;
mod cma;
mod diversity;
mod guided;
mod hierarchy;
mod lanes;
mod members;
mod method;
mod models;
mod space;
mod spread;
mod surrogate;
mod tuning;

use std::fmt;

use archive::{Archive, Limits};
pub use cma::{Cma, CmaStop, Domain};
pub use enfilade_brief::{Method, Mode, Sense};
use enfilade_report::{Error, Place};
use method::Engine;
use space::Space;
pub use space::normalised_distance;
pub use tuning::Tuning;

/// One objective of the hierarchy (spec section 7).
#[derive(Clone, Debug, PartialEq)]
pub struct Objective {
    /// Name as shown to the user: `degree`.
    pub name: String,
    /// Which way is better.
    pub sense: Sense,
    /// Threshold z in `[0, 1]`: the share of the best improvement that every member must keep.
    pub threshold: f64,
    /// Whether this is the composite `score`, whose baseline is 0: `l = z · f(p_opt)`.
    pub is_score: bool,
    /// Whether this is the sum of penalties.
    pub is_penalty: bool,
}

/// Everything that decides a search.
#[derive(Clone, Debug, PartialEq)]
pub struct Study {
    /// Lower and upper bound of each parameter, in its own unit.
    pub bounds: Vec<[f64; 2]>,
    /// `p_0`, the present layout; inside the bounds.
    pub start: Vec<f64>,
    /// Objectives in order, without diversity, which is always last in [`Mode::Diverse`].
    pub objectives: Vec<Objective>,
    /// Wanted size of the diverse set, at least 1.
    pub members: usize,
    /// `d_min` of eq. div-mem-dist, as a fraction of √n, the largest distance with n parameters.
    pub d_min: f64,
    /// To what share of themselves thresholds may be lowered, all together, while members stand nearer than
    /// `d_min`; 1: never. The default method alone does so.
    pub least_share: f64,
    /// Seed of all randomness.
    pub seed: u64,
    /// Evaluations to spend, at least one more than are pinned; `None`: until converged.
    pub evaluations: Option<u64>,
    /// How to search.
    pub method: Method,
    /// What is wanted.
    pub mode: Mode,
    /// Points a batch, at least 1. Part of the study, so that the machine decides nothing.
    pub batch: usize,
    /// Points worth knowing before the search begins, inside the bounds: evaluated right after the start.
    pub seeds: Vec<Vec<f64>>,
    /// That many of the first seeds are members that stay, whatever they are worth; the others are found
    /// away from them. Fewer than `members`.
    pub pinned: usize,
}

/// What one parameter vector is worth.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Evaluation {
    /// One value an objective, in the order of the study, as measured (no sign turned).
    pub values: Vec<f64>,
    /// Sum of the hard constraint violations; 0: feasible.
    pub violation: f64,
    /// Where it was evaluated, if not at the vector asked for: the nearest that the caller's rules allow
    /// (a module, a number of moves), inside the bounds.
    pub at: Option<Vec<f64>>,
}

/// An evaluated parameter vector.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// Parameters in the study's own units.
    pub parameters: Vec<f64>,
    /// Values as told.
    pub values: Vec<f64>,
    /// Sum of the hard constraint violations; infinite where a value was no finite number.
    pub violation: f64,
}

/// One of the diverse set.
#[derive(Clone, Debug, PartialEq)]
pub struct Member {
    /// Parameters in the study's own units.
    pub parameters: Vec<f64>,
    /// Values as told.
    pub values: Vec<f64>,
    /// Sum of the hard constraint violations.
    pub violation: f64,
    /// Whether it keeps all thresholds and hard limits.
    pub within_threshold: bool,
}

/// Why a search ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// The evaluations are spent.
    Budget,
    /// About 95 % of what it would converge to is reached.
    Converged,
    /// The time is over.
    Time,
    /// Somebody asked to stop.
    Asked,
    /// No parameter has room to move.
    NothingToMove,
}

impl fmt::Display for Stop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Budget => "the evaluations allowed were used up",
            Self::Converged => "about 95 % of what more evaluations would bring is reached",
            Self::Time => "the seconds allowed were used up",
            Self::Asked => "it was asked to stop",
            Self::NothingToMove => "nothing in the drawing has room to move",
        })
    }
}

/// One point of the convergence plot.
#[derive(Clone, Debug, PartialEq)]
pub struct Milestone {
    /// Evaluations told so far.
    pub evaluations: u64,
    /// What was being done, as in [`Progress::stage`].
    pub stage: String,
    /// Best value of the stage's objective so far, as measured.
    pub best: f64,
    /// Smallest `dn` between members; 0 while there are none.
    pub min_distance: f64,
}

/// How far the search is.
#[derive(Clone, Debug, PartialEq)]
pub struct Progress {
    /// What is being done, in plain words.
    pub stage: String,
    /// Evaluations told so far.
    pub evaluations: u64,
    /// Evaluations allowed, where there is a limit.
    pub total: Option<u64>,
    /// Best value of the stage's objective so far, as measured; NaN before the first.
    pub best: f64,
    /// Parameters of that best point, in the study's own units; none before the first.
    pub best_parameters: Option<Vec<f64>>,
}

/// What a search has found so far.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome<'a> {
    /// Best point of the last objective inside all thresholds; where no point is feasible, the one
    /// that comes nearest (`violation > 0`); before the first evaluation the start, violation infinite.
    pub best: Point,
    /// The diverse set: at most as many as asked for, fewer where fewer feasible points are known.
    /// None breaks a hard limit, but those that were pinned. In [`Mode::Best`] the best point alone.
    pub members: Vec<Member>,
    /// Members that were found but stand so near a better one that they are none: fewer options are better than
    /// several of the same.
    pub alike: usize,
    /// The limits l_i of the objectives, as measured.
    pub thresholds: Vec<f64>,
    /// What they are shares of: the best of every objective among the points that keep hard limits and the
    /// thresholds before it, as measured; `None` where no point does.
    pub reachable: Vec<Option<f64>>,
    /// What is left of the thresholds stated, in `(0, 1]` (see [`Study::least_share`]).
    pub threshold_share: f64,
    /// Evaluations told.
    pub evaluations: u64,
    /// Everything evaluated, in order.
    pub archive: &'a [Point],
    /// The course of the search.
    pub stages: &'a [Milestone],
}

/// Members nearer than this share of the distance wanted (`d_min`) are the same option to anybody, …
const ALIKE_SHARE: f64 = 0.5;

/// … where so few parameters move; …
const FEW_PARAMETERS: usize = 3;

/// … with more of them options differ in what moves, not only in how far, and only those nearer than this are.
const ALIKE_SHARE_OF_MANY: f64 = 0.25;

/// A running search.
#[derive(Clone, Debug)]
pub struct Search {
    study: Study,
    space: Space,
    archive: Archive,
    engine: Engine,
    asked: Vec<(Vec<f64>, Vec<f64>)>,
    stop: Option<Stop>,
    history: Vec<Milestone>,
    /// No more evaluations are asked for than this, whatever the study spends.
    most: u64,
}

impl Search {
    /// Checks a study and makes ready to ask.
    ///
    /// # Errors
    /// Usage error where bounds, start, thresholds or counts make no sense.
    pub fn new(study: Study) -> Result<Self, Error> {
        Self::with_tuning(study, Tuning::default())
    }

    /// As [`Search::new`], with other settings of the default method.
    ///
    /// # Errors
    /// As [`Search::new`].
    pub fn with_tuning(study: Study, tuning: Tuning) -> Result<Self, Error> {
        let space = Space::new(&study.bounds)?;
        check(&study)?;
        let archive = Archive::new(space.dims(), study.objectives.len());
        let engine = Engine::new(&study, &space, tuning);
        Ok(Self { study, space, archive, engine, asked: vec![], stop: None, history: vec![], most: u64::MAX })
    }

    /// The next batch of parameter vectors, always inside the bounds; empty when stopped. The first
    /// batch is the start and the seeds. Asking again without telling gives the same batch.
    pub fn ask(&mut self) -> Vec<Vec<f64>> {
        if self.stop.is_some() {
            return vec![];
        }
        if self.asked.is_empty() {
            let most = self.study.evaluations.map_or(self.most, |b| b.min(self.most));
            let left = usize::try_from(most).unwrap_or(usize::MAX).saturating_sub(self.archive.len());
            let count = self.study.batch.min(left);
            self.asked =
                if self.archive.len() == 0 { self.first_batch(left) } else { self.next_batch(count) };
        }
        self.asked.iter().map(|(_, parameters)| parameters.clone()).collect()
    }

    /// The start and the seeds alone: everything after them is drawn in their light.
    fn first_batch(&self, left: usize) -> Vec<(Vec<f64>, Vec<f64>)> {
        let known = std::iter::once(&self.study.start).chain(&self.study.seeds);
        known.take(left).map(|p| (self.space.unit(p), p.clone())).collect()
    }

    fn next_batch(&mut self, count: usize) -> Vec<(Vec<f64>, Vec<f64>)> {
        let units = self.engine.ask(&self.archive, count);
        units.into_iter().map(|u| (u.clone(), self.space.parameters(&u))).collect()
    }

    /// Takes what the last batch is worth, in the order asked. A value that is no finite number, or is
    /// missing, makes its point infeasible.
    pub fn tell(&mut self, evaluations: &[Evaluation]) {
        let first = self.archive.len();
        let missing = Evaluation { violation: f64::INFINITY, ..Evaluation::default() };
        for (k, (mut unit, mut parameters)) in std::mem::take(&mut self.asked).into_iter().enumerate() {
            let told = evaluations.get(k).unwrap_or(&missing);
            if let Some(at) = told.at.as_ref().filter(|at| at.len() == parameters.len()) {
                unit = self.space.unit(at);
                parameters.clone_from(at);
            }
            self.archive.push(&unit, parameters, told, &self.study.objectives);
        }
        if self.archive.len() == first {
            return;
        }
        self.engine.tell(&self.archive, first);
        self.record();
        if self.space.dims() == 0 {
            self.stop = Some(Stop::NothingToMove);
        } else if self.study.evaluations.is_some_and(|b| self.archive.len() as u64 >= b) {
            self.stop = Some(Stop::Budget);
        } else if self.engine.is_converged(&self.archive) {
            self.stop = Some(Stop::Converged);
        }
    }

    fn record(&mut self) {
        let Progress { stage, evaluations, best, .. } = self.progress();
        let min_distance = self.engine.min_distance(&self.archive);
        let news = self.history.last().is_none_or(|last| {
            last.stage != stage
                || last.best.to_bits() != best.to_bits()
                || last.min_distance.to_bits() != min_distance.to_bits()
        });
        if news {
            self.history.push(Milestone { evaluations, stage, best, min_distance });
        }
    }

    /// Why the search ended; `None` while it goes on.
    pub fn stop_reason(&self) -> Option<Stop> {
        self.stop
    }

    /// Ends the search now; [`Search::outcome`] has the best so far.
    pub fn finish(&mut self, why: Stop) {
        self.stop.get_or_insert(why);
        self.asked.clear();
    }

    /// Asks for no more than so many evaluations in all of a search that ends when it has converged; when they are
    /// spent nothing more is asked for, and the caller says why it ends.
    pub fn set_most(&mut self, evaluations: u64) {
        self.most = evaluations;
    }

    /// Changes the evaluations to spend, for callers whose budget is time and who learn as they go how
    /// many fit into it: what is climbed first and what is spread last follows the new number.
    pub fn set_evaluations(&mut self, evaluations: u64) {
        self.study.evaluations = Some(evaluations);
        self.engine.set_budget(evaluations);
    }

    /// How far the search is.
    pub fn progress(&self) -> Progress {
        let j = self.engine.stage();
        let objective = &self.study.objectives[j];
        let best = self.engine.limits().best[..].get(j).copied().flatten();
        let best = best.map(|i| &self.archive.points()[i]);
        Progress {
            stage: if self.engine.is_spreading() {
                "spreading".into()
            } else {
                format!("improving {}", objective.name)
            },
            evaluations: self.archive.len() as u64,
            total: self.study.evaluations,
            best: best.map_or(f64::NAN, |point| point.values[j]),
            best_parameters: best.map(|point| point.parameters.clone()),
        }
    }

    /// What the search has found so far; usable at any moment.
    pub fn outcome(&self) -> Outcome<'_> {
        let unknown_limits = Limits::of(&self.archive, &self.study.objectives, false);
        let limits = if self.archive.len() == 0 { &unknown_limits } else { self.engine.limits() };
        let best = self.best(limits);
        let (members, alike) = self.unlike(self.chosen(limits), best);
        let unknown = || Point {
            parameters: self.study.start.clone(),
            values: vec![f64::NAN; self.study.objectives.len()],
            violation: f64::INFINITY,
        };
        let senses = self.study.objectives.iter().enumerate();
        let pinned = if self.study.method == Method::Default { self.study.pinned } else { 0 };
        Outcome {
            best: best.map_or_else(unknown, |i| self.archive.points()[i].clone()),
            members: members
                .into_iter()
                .enumerate()
                .map(|(k, i)| self.member(limits, i, k < pinned))
                .collect(),
            alike,
            thresholds: senses.clone().map(|(j, o)| o.sense.gain(limits.limit(j, 0.0))).collect(),
            reachable: senses.map(|(j, o)| limits.best_gain(j).map(|g| o.sense.gain(g))).collect(),
            threshold_share: self.engine.threshold_share(),
            evaluations: self.archive.len() as u64,
            archive: self.archive.points(),
            stages: &self.history,
        }
    }

    /// The members, as archive indices: whatever a method strives for, none breaks a hard limit but those the
    /// caller pinned; the best point alone where a method has none yet.
    fn chosen(&self, limits: &Limits) -> Vec<usize> {
        let best = self.best(limits).filter(|&i| self.archive.hard(i) == 0.0);
        if self.study.mode == Mode::Best {
            return best.into_iter().collect();
        }
        let pinned = if self.study.method == Method::Default { self.study.pinned } else { 0 };
        let members = self.best_first(self.engine.members(&self.archive)).into_iter().enumerate();
        let kept: Vec<usize> =
            members.filter(|&(m, i)| m < pinned || self.archive.hard(i) == 0.0).map(|(_, i)| i).collect();
        if kept.is_empty() { best.into_iter().collect() } else { kept }
    }

    /// Without those that stand too near a better one, and how many these are. Where there are any, the best point
    /// is kept first: what is left may be one option, and that must be the best. Pinned members all stay.
    fn unlike(&self, members: Vec<usize>, best: Option<usize>) -> (Vec<usize>, usize) {
        let is_default = self.study.method == Method::Default && self.study.mode == Mode::Diverse;
        let is_few = self.space.dims() <= FEW_PARAMETERS;
        let share = if is_few { ALIKE_SHARE } else { ALIKE_SHARE_OF_MANY };
        let least = share * self.study.d_min * (self.space.dims() as f64).sqrt();
        let is_far = |kept: &[usize], i: usize| kept.iter().all(|&k| self.archive.distance(k, i) >= least);
        if !is_default || (0..members.len()).all(|m| is_far(&members[..m], members[m])) {
            return (members, 0);
        }
        let (pinned, free) = members.split_at(self.study.pinned.min(members.len()));
        let mut kept = pinned.to_vec();
        for i in best.filter(|&b| self.archive.hard(b) == 0.0).into_iter().chain(free.iter().copied()) {
            if is_far(&kept, i) && kept.len() < members.len() {
                kept.push(i);
            }
        }
        let alike = members.len() - kept.len();
        (kept, alike)
    }

    /// Pinned members as they were given, then the others, the best in the last objective first.
    fn best_first(&self, mut members: Vec<usize>) -> Vec<usize> {
        let pinned = self.study.pinned.min(members.len());
        let gain = |i: usize| self.archive.gains(i).last().copied().unwrap_or(f64::NAN);
        if self.study.method == Method::Default {
            members[pinned..].sort_by(|&a, &b| gain(b).total_cmp(&gain(a)).then(a.cmp(&b)));
        }
        members
    }

    fn best(&self, limits: &Limits) -> Option<usize> {
        let nearest = || {
            (0..self.archive.len())
                .reduce(|a, b| if self.archive.hard(b) < self.archive.hard(a) { b } else { a })
        };
        limits.best.last().copied().flatten().or_else(nearest)
    }

    /// A pinned member may break a hard limit and keep all thresholds.
    fn member(&self, limits: &Limits, i: usize, is_pinned: bool) -> Member {
        let Point { parameters, values, violation } = self.archive.points()[i].clone();
        let count = self.study.objectives.len();
        let within_threshold =
            (violation == 0.0 || is_pinned) && limits.admits(self.archive.gains(i), count, 0.0);
        Member { parameters, values, violation, within_threshold }
    }
}

fn check(study: &Study) -> Result<(), Error> {
    let bad = |text: String| Err(Error::usage("search-study", Place::default(), text));
    if study.start.len() != study.bounds.len() {
        return bad(format!(
            "start, found {} parameters, expected {}",
            study.start.len(),
            study.bounds.len()
        ));
    }
    for (i, (p, [lower, upper])) in study.start.iter().zip(&study.bounds).enumerate() {
        if !(p >= lower && p <= upper) {
            return bad(format!("start of parameter {i}, found {p}, expected {lower} .. {upper}"));
        }
    }
    if study.objectives.is_empty() {
        return bad("objectives, found none, expected at least one".into());
    }
    if let Some(o) = study.objectives.iter().find(|o| !(0.0..=1.0).contains(&o.threshold)) {
        return bad(format!("threshold of {}, found {}, expected 0 .. 1", o.name, o.threshold));
    }
    if !(0.0..=1.0).contains(&study.d_min) {
        return bad(format!("least distance between members, found {}, expected 0 .. 1 of √n", study.d_min));
    }
    if !(0.0..=1.0).contains(&study.least_share) {
        return bad(format!("least share of the thresholds, found {}, expected 0 .. 1", study.least_share));
    }
    for (what, count) in [("members", study.members), ("batch", study.batch)] {
        if count == 0 {
            return bad(format!("{what}, found 0, expected at least 1"));
        }
    }
    let inside = |seed: &Vec<f64>| {
        seed.len() == study.bounds.len()
            && seed.iter().zip(&study.bounds).all(|(p, [lower, upper])| p >= lower && p <= upper)
    };
    if let Some(seed) = study.seeds.iter().find(|s| !inside(s)) {
        return bad(format!("seed, found {seed:?}, expected a point inside the bounds"));
    }
    if study.pinned > study.seeds.len() || (study.pinned > 0 && study.pinned >= study.members) {
        return bad(format!(
            "pinned members, found {}, expected fewer than the {} members",
            study.pinned, study.members
        ));
    }
    // The present layout and the pinned ones are measured in any case.
    let least = 1 + study.pinned as u64;
    if let Some(evaluations) = study.evaluations.filter(|e| *e < least) {
        let why =
            if study.pinned > 0 { ": the present layout and the pinned ones are measured first" } else { "" };
        return bad(format!("evaluations, found {evaluations}, expected at least {least}{why}"));
    }
    Ok(())
}

#[cfg(test)]
mod tests;
mod view;

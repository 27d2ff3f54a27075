//! How many layouts a search may measure: by the number stated, by the clock, or until it has converged.

use std::time::Instant;

use crate::measure::study::Study;
use crate::search::brief::{Brief, is_bare};
use crate::search::memory::{Clock, Pace};
use enfilade_config::Settings;
use enfilade_search::{Search, Stop};

/// Evaluations of a study whose user names no budget: this many query–vertex pairs in all …
const PAIRS_BUDGET: f64 = 3.0e9;
/// … but within these bounds.
const EVALUATIONS: [f64; 2] = [200.0, 1_000.0];

/// Most layouts of a search that ends when it has converged, where no number is stated.
const CONVERGING_MAX: u64 = 20_000;

/// The evaluations that a search plans with: the number stated, else by how much measuring one costs; none where it
/// ends when it has converged.
pub(crate) fn stated(study: &Study, settings: &Settings) -> Option<u64> {
    let by_cost = || (EVALUATIONS[1] * effort(study) * search_share(settings)) as u64;
    (!settings.until_converged).then(|| settings.evaluations.unwrap_or_else(by_cost))
}

/// How much is measured of what a small plan is worth, by how much measuring one layout costs: 0.2 to 1.
pub(crate) fn effort(study: &Study) -> f64 {
    let pairs = study.lattice.cells.len() as f64 * study.lattice.query.len() as f64;
    (PAIRS_BUDGET / pairs).clamp(EVALUATIONS[0], EVALUATIONS[1]) / EVALUATIONS[1]
}

/// Layouts that are asked for at once where nobody states how many: of small plans, …
const TOGETHER: usize = 2;
/// … and of those of which fewer are measured, since each takes long: on four lattices they keep 32 cores busy. After 130 and
/// 200 layouts eight at a time reach as much as two, and stand 7 to 13 % nearer to each other; after 350 they stand 9 % nearer
/// (`BENCHMARKS.md`, "Layouts at once").
const TOGETHER_LARGE: usize = 8;

/// Layouts that are asked for at once. Part of the search's definition, not of the machine: the same on any number of threads
/// and on any back end.
pub(crate) fn together(study: &Study, settings: &Settings) -> usize {
    settings.together.unwrap_or(if effort(study) < 1.0 { TOGETHER_LARGE } else { TOGETHER })
}

/// Share of the layouts, where no number is stated, that ranking, stripping and confirming take after the search.
const AFTER_SEARCH: f64 = 0.35;

/// What the search and those beside it take, of which the search is one.
const WITH_OTHERS: f64 = 1.0 + SEARCHES as f64 * SHARE;

fn search_share(settings: &Settings) -> f64 {
    if is_bare(settings) { 1.0 } else { (1.0 - AFTER_SEARCH) / WITH_OTHERS }
}

/// What works, ranking, confirming and writing take after the search, in evaluations of it: at the least effort, and how much
/// more at the whole. From profiles of the museum hall and of `ensal`, tried on two others (`BENCHMARKS.md`, "Within the time").
const AFTER: [f64; 2] = [450.0, 650.0];
/// Share of the seconds stated that a search has at least, whatever comes after it: of less nothing is learned that could be
/// confirmed.
const SEARCH_LEAST: f64 = 0.25;

/// What a search may still measure.
pub(crate) struct Allowance<'a> {
    settings: &'a Settings,
    /// Of [`effort`].
    effort: f64,
    clock: Clock,
    /// Evaluations thought to fit into the seconds stated.
    fit: u64,
    /// Layouts that are asked for at once.
    together: u64,
    /// Evaluations that are measured whatever the clock says.
    least: u64,
}

impl<'a> Allowance<'a> {
    /// Of a search that first measures `known` layouts, in a round that began at `started`.
    pub(crate) fn new(brief: &Brief<'a>, search: &mut Search, known: u64, started: Instant) -> Self {
        let (settings, effort) = (brief.settings, effort(brief.study));
        let together = together(brief.study, settings) as u64;
        let clock = Clock::new(started);
        let out = Self { settings, effort, clock, fit: 0, together, least: known + together };
        if settings.until_converged {
            search.set_most(out.most());
        }
        out
    }

    fn most(&self) -> u64 {
        self.settings.evaluations.unwrap_or(CONVERGING_MAX)
    }

    /// Seconds of those stated that the search has, as long as what comes after it is thought to need the others.
    fn seconds(&self, done: u64) -> Option<f64> {
        let stated = self.settings.seconds?;
        if is_bare(self.settings) {
            return Some(stated);
        }
        Some(((stated - self.after_secs(done)) / WITH_OTHERS).max(stated * SEARCH_LEAST))
    }

    /// Seconds that what comes after the search is thought to take, by the pace of so many evaluations.
    fn after_secs(&self, done: u64) -> f64 {
        self.clock.secs_each(done) * (AFTER[0] + AFTER[1] * self.effort)
    }

    /// Whether the seconds stated are too few for what comes after a search of so many evaluations.
    pub(crate) fn is_late(&self, done: u64) -> bool {
        let left = |stated: f64| stated - self.clock.spent_secs();
        !is_bare(self.settings) && self.settings.seconds.is_some_and(|s| self.after_secs(done) > left(s))
    }

    /// Before a batch is asked for: a search whose time or number is spent ends, another plans with what fits. The pace
    /// of a batch that is remembered counts instead of the clock.
    pub(crate) fn turn(&mut self, search: &mut Search, remembered: Option<Pace>) {
        let done = search.progress().evaluations;
        if let Some(seconds) = self.seconds(done) {
            if remembered.is_none() && done > 0 && self.clock.spent_secs() >= seconds {
                search.finish(Stop::Time);
            }
            self.fit = remembered
                .map_or_else(|| self.clock.fit(done, seconds, self.together).max(self.least), |p| p.fit);
            if !self.settings.until_converged {
                search.set_evaluations(self.settings.evaluations.map_or(self.fit, |most| most.min(self.fit)));
            }
        }
        if self.settings.until_converged && done >= self.most() {
            search.finish(Stop::Budget);
        }
    }

    /// What was found so far was written, which took so many seconds.
    pub(crate) fn pause(&mut self, secs: f64) {
        self.clock.pause(secs);
    }

    /// The clock goes on from where a remembered batch left it.
    pub(crate) fn go_on(&mut self, from: Pace) {
        self.clock.set(from.spent_secs);
    }

    /// Where the clock stands; nothing where no seconds are stated, so that nothing kept depends on it.
    pub(crate) fn pace(&self) -> Pace {
        let pace = self.settings.seconds.map(|_| Pace { fit: self.fit, spent_secs: self.clock.spent_secs() });
        pace.unwrap_or_default()
    }
}

/// Searches without some of the groups that the best layout gains most by, …
pub(crate) const SEARCHES: usize = 2;

/// Layouts measured by each, as a share of those that the search measured.
pub(crate) const SHARE: f64 = 0.1;

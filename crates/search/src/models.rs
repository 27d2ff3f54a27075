//! The surrogates of a search, one for each neighbourhood that is being looked at.

use super::archive::Archive;
use super::surrogate::Surrogate;
use super::view::View;

/// A few surrogates, used again as long as they know the place asked for.
#[derive(Clone, Debug)]
pub(super) struct Models {
    surrogates: Vec<Surrogate>,
    /// When each was used last.
    used: Vec<u64>,
    clock: u64,
    /// Nearest points in each.
    size: usize,
}

impl Models {
    /// Room for `count` neighbourhoods of `size` points.
    pub(super) fn new(count: usize, size: usize) -> Self {
        Self { surrogates: vec![Surrogate::default(); count], used: vec![0; count], clock: 0, size }
    }

    /// A surrogate of the first `count` objectives around `at`, fitted to all that is known there.
    pub(super) fn around(&mut self, view: &View<'_>, at: &[f64], count: usize) -> &Surrogate {
        let slot = self.slot(view.archive, at);
        self.clock += 1;
        self.used[slot] = self.clock;
        let surrogate = &mut self.surrogates[slot];
        surrogate.sync(view.archive, at, self.size, view.tuning.nugget);
        surrogate.fit_once(count, |i, j| view.lesson(i, j));
        surrogate.aim(at);
        surrogate
    }

    /// The surrogate whose centre is nearest, if it still serves; else the one unused for longest.
    fn slot(&self, archive: &Archive, at: &[f64]) -> usize {
        let serving = (0..self.surrogates.len()).filter(|&s| self.surrogates[s].serves(archive, at));
        let distance = |&s: &usize| self.surrogates[s].distance(at);
        let nearest = serving.min_by(|a, b| distance(a).total_cmp(&distance(b)));
        nearest.unwrap_or_else(|| (0..self.used.len()).min_by_key(|&s| self.used[s]).unwrap_or(0))
    }
}

//! What a climb looks at, and how it compares what it sees.

use super::Tuning;
use super::archive::{Archive, Limits};

/// What a climb looks at: the archive and its thresholds.
pub(super) struct View<'a> {
    pub(super) archive: &'a Archive,
    pub(super) limits: &'a Limits,
    pub(super) tuning: &'a Tuning,
    /// Whether a new climb begins anywhere, whatever is known.
    pub(super) fresh: bool,
    /// Members of the diverse set, once there is one.
    pub(super) members: &'a [usize],
    /// Points asked and not told yet.
    pub(super) pending: &'a [Vec<f64>],
}

impl View<'_> {
    /// What a climb on `stage` maximises: the gain, less what it misses of earlier thresholds.
    pub(super) fn merit(&self, gains: &[f64], stage: usize) -> f64 {
        let missed: f64 =
            (0..stage).map(|j| (self.limits.limit(j, 0.0) - gains[j]).max(0.0) / self.limits.range(j)).sum();
        gains[stage] - 3.0 * missed * self.limits.range(stage)
    }

    pub(super) fn is_within(&self, i: usize, stage: usize) -> bool {
        self.archive.hard(i) == 0.0 && self.limits.admits(self.archive.gains(i), stage, 0.0)
    }

    /// Whether `a` is better than `b`: within hard limits and thresholds first, then by merit.
    pub(super) fn is_better(&self, a: usize, b: usize, stage: usize, least: f64) -> bool {
        match (self.is_within(a, stage), self.is_within(b, stage)) {
            (true, false) => true,
            (false, true) => false,
            (true, true) => self.archive.gains(a)[stage] > self.archive.gains(b)[stage] + least,
            (false, false) => {
                let (ha, hb) = (self.archive.hard(a), self.archive.hard(b));
                if ha != hb { ha < hb } else { self.merit_of(a, stage) > self.merit_of(b, stage) + least }
            }
        }
    }

    pub(super) fn merit_of(&self, i: usize, stage: usize) -> f64 {
        if self.archive.hard(i).is_finite() {
            self.merit(self.archive.gains(i), stage)
        } else {
            f64::NEG_INFINITY
        }
    }

    /// What a surrogate learns of objective `j` at point `i`: the gain, levelled below the floor.
    pub(super) fn lesson(&self, i: usize, j: usize) -> f64 {
        let floor = self.limits.floor(j, self.tuning.floor_share);
        if self.archive.hard(i) > 0.0 { floor } else { self.archive.gains(i)[j].max(floor) }
    }
}

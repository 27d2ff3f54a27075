//! Moves of the best layouts beside works.
//!
//! The places of works are not looked at again beside each other: over four plans that changed one set of nine, by 0.07 % of
//! what is seen.

use std::collections::BTreeSet;

use super::builder::{Builder, Set};
use super::made::Moved;
use crate::confirm::refined::STRIPPED;
use crate::search::rules;
use crate::understand::edits::edits_of;
use enfilade_moves::control::Control;
use enfilade_report::{Cancel, Error};
use rayon::prelude::*;

/// Sets that moves are added to, the best: for speed alone.
const MOVED_SETS: usize = 3;
/// Moves beside works: more make another plan.
const MOVES: usize = 5;
/// Moves of which the best are sought: for speed alone.
const STEPS: usize = 40;

impl Builder<'_> {
    /// The best of the first sets with moves of the layouts that the search found, one after another as long as each brings its
    /// share of what all bring; none where no move does.
    pub(super) fn with_moves(&self, sets: &[Set], cancel: &Cancel) -> Result<Option<Set>, Error> {
        let (study, settings) = (self.judges.study, self.job.settings);
        if self.layouts.is_empty() {
            return Ok(None);
        }
        let control = rules::control(&study.base, settings)?;
        let still = control.start();
        let mut steps: Vec<Vec<(usize, f64)>> = Vec::new();
        for q in self.layouts.iter().map(|p| control.reduce(p)) {
            for (unit, _) in control.units() {
                let step: Vec<(usize, f64)> =
                    unit.iter().filter(|k| q[**k] != still[**k]).map(|k| (*k, q[*k])).collect();
                if !step.is_empty() && !steps.contains(&step) {
                    steps.push(step);
                }
            }
        }
        steps.truncate(STEPS);
        let mut best: Option<Set> = None;
        for set in sets.iter().filter(|s| s.is_legal).take(MOVED_SETS) {
            let gained = self.moved(set, &control, &steps, cancel)?;
            if gained.as_ref().is_some_and(|g| best.as_ref().is_none_or(|b| g.gain > b.gain)) {
                best = gained;
            }
        }
        Ok(best)
    }

    /// A set with the steps that bring their share, the one that brings most first.
    fn moved(
        &self,
        set: &Set,
        control: &Control,
        steps: &[Vec<(usize, f64)>],
        cancel: &Cancel,
    ) -> Result<Option<Set>, Error> {
        let base = &self.judges.study.base;
        let touched: BTreeSet<usize> = self.records(set);
        let (mut now, mut q) = (set.clone(), control.start());
        for _ in 0..MOVES {
            cancel.check()?;
            let tried = steps.par_iter().filter_map(|step| {
                let mut next = q.clone();
                step.iter().for_each(|(k, v)| next[*k] = *v);
                let next = control.permit(&next);
                let moved = Moved::new(base, control.expand(&next));
                let is_apart = edits_of(base, &moved.layout).iter().all(|e| !touched.contains(&e.record()));
                let is_new = next != q && is_apart;
                is_new.then(|| (self.set(set.works.clone(), set.effort_m, moved), next))
            });
            let tried: Vec<(Set, Vec<f64>)> = tried.collect();
            let legal = tried.into_iter().filter(|(s, _)| s.is_legal);
            let best = legal.reduce(|a, b| if b.0.gain > a.0.gain { b } else { a });
            let Some((next, at)) = best.filter(|(s, _)| s.gain * (1.0 - STRIPPED) >= now.gain) else { break };
            (now, q) = (next, at);
        }
        Ok(now.moved.is_any().then_some(now))
    }

    /// The records that the works of a set change.
    fn records(&self, set: &Set) -> BTreeSet<usize> {
        let walls = set.works.iter().flat_map(|w| &self.work(*w).walls);
        walls.flat_map(|w| self.floor().walls[w.0].records.iter().copied()).collect()
    }
}

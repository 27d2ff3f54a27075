//! Options that build and that somebody pinned: found again among the works of the drawing as it is now.

use glam::DVec2;

use super::builder::{Builder, Set};
use super::made::{Moved, overlap};
use crate::measure::worth::Worth;
use crate::search::rules;
use enfilade_config::{PinnedOption, PinnedWork};
use enfilade_overlay::built::titles;
use enfilade_report::{Place, Report};
use enfilade_works::counts::STEP_M;

/// A place of a work is the same where both its ends are this near: places lie a step apart.
const SAME_PLACE_M: f64 = STEP_M / 2.0;

impl Builder<'_> {
    /// The pinned options as sets of works; leaves out those of which a work has no place any more, and says so.
    pub(super) fn pinned(&self, report: &mut Report) -> Vec<Set> {
        let mut out = Vec::new();
        for pinned in &self.job.settings.pinned_options {
            match self.found_again(pinned) {
                Ok(set) => out.push(set),
                Err(why) => {
                    let text = format!("A pinned option is left out: {why}.");
                    report.warn("pin-works", Place::file(self.job.input.file()), text);
                }
            }
        }
        out
    }

    /// Says that the drawing cannot hold a pinned option, or reads otherwise with it.
    pub(super) fn say_unpinned(&self, set: &Set, report: &mut Report) {
        let text = format!(
            "A pinned option is left out, because the drawing cannot hold it any more, or reads otherwise with it: {}.",
            titles(&self.told_all(set))
        );
        report.warn("pin-works", Place::file(self.job.input.file()), text);
    }

    /// What of the limits and rules a set breaks, in words.
    pub(super) fn broken(&self, set: &Set, worth: &Worth) -> Vec<String> {
        let (study, settings) = (self.judges.study, self.job.settings);
        let control = rules::control(&study.base, settings).ok().filter(|_| set.moved.is_any());
        let mut out = match control {
            Some(control) => rules::broken(study, settings, &control, (&set.moved.parameters, worth)),
            None => rules::broken_limits(study, settings, worth),
        };
        let result = &self.listed.result;
        let forbidden = set.works.iter().map(|w| &result.works[*w]).filter(|e| !e.is_allowed);
        out.extend(
            forbidden.map(|e| format!("a rule of its works ({}: {})", result.title(e), result.rule_words(e))),
        );
        if !settings.budget.holds(set.works.len(), set.effort_m) {
            out.push(format!("`--budget \"{}\"`", settings.budget));
        }
        out
    }

    /// # Errors
    /// In words, why there is no such set.
    fn found_again(&self, pinned: &PinnedOption) -> Result<Set, String> {
        let place = |w: &PinnedWork| {
            let [x, y] = w.stretch[0];
            let lost = || format!("its work `{}` has no place any more at {x:.2}, {y:.2} m", w.kind);
            self.place_of(w).ok_or_else(lost)
        };
        let mut works: Vec<usize> = pinned.works.iter().map(place).collect::<Result<_, _>>()?;
        works.sort_unstable();
        works.dedup();
        let is_apart =
            |(i, w): (usize, &usize)| works[..i].iter().all(|o| !overlap(self.work(*o), self.work(*w)));
        if !works.iter().enumerate().all(is_apart) {
            return Err("two of its works change the same stretch of a wall".into());
        }
        let base = &self.judges.study.base;
        let is_still = pinned.parameters.is_empty();
        let moved = if is_still { Moved::none(base) } else { Moved::new(base, pinned.parameters.clone()) };
        let entries = works.iter().map(|w| &self.listed.result.works[*w]);
        let effort_m = entries.map(|e| e.effort.length_m()).sum();
        Ok(Set { is_pinned: true, ..self.set(works, effort_m, moved) })
    }

    /// The place in the list of a work.
    fn place_of(&self, work: &PinnedWork) -> Option<usize> {
        let far = |ends: [[f64; 2]; 2]| {
            let [a, b] = ends.map(DVec2::from_array);
            let [c, d] = work.stretch.map(DVec2::from_array);
            let apart = |p: DVec2, q: DVec2| p.distance(c).max(q.distance(d));
            apart(a, b).min(apart(b, a))
        };
        let same = self.listed.result.works.iter().filter(|e| e.kind == work.kind);
        let nearest = same.map(|e| (far(e.stretch), e.id - 1)).min_by(|a, b| a.0.total_cmp(&b.0));
        nearest.filter(|n| n.0 <= SAME_PLACE_M).map(|n| n.1)
    }
}

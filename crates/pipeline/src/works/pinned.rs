//! Options that build and that somebody pinned: found again among the works of the drawing as it is now.

use glam::DVec2;

use super::builder::{Builder, Set};
use super::made::Moved;
use crate::measure::worth::Worth;
use crate::search::rules;
use enfilade_config::{PinnedOption, PinnedWork};
use enfilade_overlay::built::titles;
use enfilade_report::{Place, Report};
use enfilade_works::counts::STEP_M;

/// A place of a work is the same where both its ends are this near: places lie a step apart.
const SAME_PLACE_M: f64 = STEP_M / 2.0;

impl Builder<'_> {
    /// The pinned options as sets of works; those of which a work has no place any more are told and left out.
    pub(super) fn pinned(&self, report: &mut Report) -> Vec<Set> {
        let mut out = Vec::new();
        for pinned in &self.job.settings.pinned_options {
            match self.found_again(pinned) {
                Ok(set) => out.push(set),
                Err(lost) => {
                    let [x, y] = lost.stretch[0];
                    let text = format!(
                        "A pinned option has no place any more for its work `{}` at {x:.2}, {y:.2} m; it is left out.",
                        lost.kind
                    );
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
        let mut out = rules::broken_limits(self.judges.study, self.job.settings, worth);
        let forbidden = set.works.iter().map(|w| &self.listed.result.works[*w]).filter(|e| !e.is_allowed);
        out.extend(forbidden.map(|e| format!("that {}", self.listed.result.line(e))));
        let works = set.works.len();
        if !self.job.settings.budget.holds(works, set.effort_m) {
            out.push(format!("`--budget \"{}\"`", self.job.settings.budget));
        }
        out
    }

    fn found_again<'p>(&self, pinned: &'p PinnedOption) -> Result<Set, &'p PinnedWork> {
        let mut works: Vec<usize> =
            pinned.works.iter().map(|w| self.place_of(w).ok_or(w)).collect::<Result<_, _>>()?;
        works.sort_unstable();
        works.dedup();
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

//! Groups of openings that slide: which they are, and how far they go.

use std::collections::BTreeSet;

use super::joined::shift_of;
use super::remains::REST_M;
use enfilade_cad::drawing::place_in;
use enfilade_plan::Plan;
use enfilade_plan::markers::{Clause, Group};
use enfilade_report::Report;

/// A clause that takes an opening along its wall by less than this share of its value takes it nowhere.
const ALONG_MIN: f64 = 1e-6;

/// The openings that a group slides: the one that it stands for, and those among the records that the file names.
pub(super) fn slots_of(plan: &Plan, group: &Group, only: Option<&BTreeSet<usize>>) -> Vec<usize> {
    let is_own = |r: usize| r == group.source.record || only.is_some_and(|only| only.contains(&r));
    (0..plan.slots.len()).filter(|s| is_own(plan.slots[*s].source.record)).collect()
}

/// A group of openings with ways that end before their walls do; what is shortened or left out is told.
pub(super) fn within_walls(plan: &Plan, group: &Group, slots: &[usize], report: &mut Report) -> Group {
    let mut out = group.clone();
    out.clauses.retain(|c| shift_of(c.kind).is_some());
    let place = || place_in(&plan.file, &group.source);
    if out.clauses.len() < group.clauses.len() {
        let text = format!(
            "group {:?}: a door slides along its wall; its turns and scalings are left out",
            group.name
        );
        report.warn("move-clause-unused", place(), text);
    }
    let per_unit = |c: &Clause, slot: usize| {
        shift_of(c.kind).map_or(0.0, |d| d.dot(plan.slots[slot].along)) * c.si_per_unit
    };
    for slot in slots {
        let is_along = |c: &&Clause| per_unit(c, *slot).abs() > ALONG_MIN * c.si_per_unit;
        let shared = out.clauses.iter().filter(is_along).count().max(1) as f64;
        let [back, forth] = plan.slots[*slot].free_m;
        let room = [(back + REST_M).min(0.0), (forth - REST_M).max(0.0)].map(|r| r / shared);
        for c in out.clauses.iter_mut().filter(|c| is_along(&&**c)) {
            let ends = room.map(|r| r / per_unit(c, *slot));
            let [low, high] = [ends[0].min(ends[1]) + 0.0, ends[0].max(ends[1]) + 0.0];
            (c.lower, c.upper) = (c.lower.clamp(low, high), c.upper.clamp(low, high));
        }
    }
    if out.clauses.iter().zip(&group.clauses).any(|(a, b)| a.kind == b.kind && a != b) {
        let text = format!(
            "group {:?}: its way ends {REST_M} m before the next corner of its wall, or the next opening in it",
            group.name
        );
        report.warn("move-shortened", place(), text);
    }
    out
}

//! What marks say of works.

use enfilade_brief::WorkKind;
use enfilade_plan::Plan;
use enfilade_plan::allowed::{AllowedAt, AllowedWork};
use glam::DVec2;

use crate::rule::Rule;
use crate::walls::Wall;

/// How far inside an outline the ends of a stretch count, metres: they often stand on it.
const INSET_M: f64 = 0.01;

/// Widths nearer than this are one, metres.
const SAME_M: f64 = 1e-3;

/// What marks say of one work.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Word {
    /// A mark allows it.
    Granted,
    /// Nobody marked any work.
    Unsaid,
    /// Marks allow others.
    Denied,
}

impl Word {
    /// The rules that forbid a work, by default and by this word. Who allows a work by a mark means it: what he keeps and
    /// a room's last door forbid it all the same.
    pub fn rules(self, by_default: Vec<Rule>) -> Vec<Rule> {
        match self {
            Self::Unsaid => by_default,
            Self::Granted => {
                by_default.into_iter().filter(|r| matches!(r, Rule::Kept | Rule::LastDoor(_))).collect()
            }
            Self::Denied => by_default.into_iter().chain([Rule::Unmarked]).collect(),
        }
    }
}

/// What the marks of a plan say of a work of a kind and a size, on a stretch of some walls.
pub fn word(plan: &Plan, kind: WorkKind, size_m: f64, stretch: [DVec2; 2], walls: &[&Wall]) -> Word {
    let marks = &plan.markers.allowed;
    if marks.is_empty() {
        return Word::Unsaid;
    }
    let [a, b] = stretch;
    let inset = (b - a).normalize_or_zero() * INSET_M.min(a.distance(b) / 2.0);
    let ends = [a + inset, b - inset].map(|p| plan.frame.um_from_plan(p));
    let is_here = |at: &AllowedAt| match at {
        AllowedAt::Inside(region) => ends.iter().all(|p| region.contains(*p)),
        AllowedAt::Record(record) => walls.iter().any(|w| w.markable.contains(record)),
    };
    let is_of_kind = |w: &AllowedWork| w.kind == kind && is_of_size(w, size_m);
    match marks.iter().any(|m| is_here(&m.at) && m.works.iter().any(is_of_kind)) {
        true => Word::Granted,
        false => Word::Denied,
    }
}

fn is_of_size(work: &AllowedWork, size_m: f64) -> bool {
    let Some([low, high]) = work.range_m else { return true };
    match work.kind {
        // A wall that goes back by a metre has a length of one less.
        WorkKind::End => size_m <= -low + SAME_M,
        WorkKind::Open | WorkKind::Door | WorkKind::Widen | WorkKind::Glaze => {
            (low - SAME_M..=high + SAME_M).contains(&size_m)
        }
        WorkKind::Close | WorkKind::Rehang | WorkKind::Remove | WorkKind::Add => true,
    }
}

/// Widths that marks name, metres.
pub fn widths_m(plan: &Plan) -> Vec<f64> {
    let works = plan.markers.allowed.iter().flat_map(|m| &m.works);
    let sized = works.filter(|w| w.kind != WorkKind::End).filter_map(|w| w.range_m).flatten();
    sized.collect()
}

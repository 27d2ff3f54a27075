//! A chain of straight walls on one line, and what moves with it.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;

use enfilade_plan::Plan;
use enfilade_plan::graph::Handle;

/// How far from a wall's axis its own corners may lie beyond half its thickness.
pub(super) const BESIDE_M: f64 = 0.06;

/// Edges on one line, joined at nodes or by openings.
pub(super) struct Chain {
    pub edges: Vec<u32>,
    /// Openings between them.
    pub openings: Vec<u32>,
    /// Where its line starts, plan frame, metres of a person.
    pub origin: DVec2,
    /// Unit vector along it.
    pub along: DVec2,
    /// Where it begins on the line, metres of a person from the origin.
    pub from: f64,
    /// Where it ends.
    pub to: f64,
    /// Of its thickest wall, metres of a person.
    pub thickness: f64,
}

impl Chain {
    /// Whether a gap lies on its line, within it or at its ends. One of drawing error is closed for sight only where its
    /// walls stay. What lies across is the cavity between two leaves.
    pub(super) fn has_gap(&self, gap: [DVec2; 2]) -> bool {
        let [a, b] = gap.map(|p| self.local(p));
        let (beside, beyond) = (self.thickness / 2.0 + BESIDE_M, self.thickness + BESIDE_M);
        let is_along = (b - a).x.abs() > (b - a).y.abs();
        let is_at = |p: &DVec2| p.y.abs() <= beside && (self.from - beyond..=self.to + beyond).contains(&p.x);
        is_along && [a, b].iter().any(is_at)
    }

    /// A point along the line and to its left, metres of a person from the origin.
    pub(super) fn local(&self, p: DVec2) -> DVec2 {
        DVec2::new((p - self.origin).dot(self.along), self.along.perp_dot(p - self.origin))
    }

    /// The point at such a place, plan frame.
    pub(super) fn world(&self, x: f64, y: f64) -> DVec2 {
        self.origin + self.along * x + self.along.perp() * y
    }
}

/// What moves with a chain.
pub(super) struct Own {
    /// Its corners, and those of what ends at it.
    pub handles: BTreeSet<Handle>,
    /// Records of its walls that move whole.
    pub records: BTreeSet<usize>,
}

/// The walls that move whole, by their record.
pub(super) fn walls_by_record(plan: &Plan) -> BTreeMap<usize, Vec<u32>> {
    let mut out: BTreeMap<usize, Vec<u32>> = BTreeMap::new();
    for (w, wall) in (0u32..).zip(&plan.walls).filter(|(_, w)| w.editable.moves_whole()) {
        out.entry(wall.source.record).or_default().push(w);
    }
    out
}

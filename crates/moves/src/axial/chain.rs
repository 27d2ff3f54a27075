//! A chain of straight walls on one line, and what moves with it.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;

use enfilade_plan::Plan;
use enfilade_plan::graph::Handle;

/// Edges on one line, joined at nodes or by openings.
pub(super) struct Chain {
    pub edges: Vec<u32>,
    /// Openings between them.
    pub openings: Vec<u32>,
    /// Start, and unit vector along.
    pub origin: DVec2,
    pub along: DVec2,
    /// Ends along the line, from the origin.
    pub from: f64,
    pub to: f64,
    pub thickness: f64,
}

impl Chain {
    pub(super) fn local(&self, p: DVec2) -> DVec2 {
        DVec2::new((p - self.origin).dot(self.along), self.along.perp_dot(p - self.origin))
    }

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

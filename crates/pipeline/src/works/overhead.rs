//! What stands on the storey above over wall that works take away.

use std::sync::Arc;

use super::whole_mm;
use crate::job::Job;
use crate::measure::study::Study;
use crate::storeys::together;
use crate::understand::understood::Understood;
use crate::write::show;
use enfilade_overlay::built::Above;
use enfilade_overlay::element::ElementRef;
use enfilade_works::walls::{Wall, walls};
use glam::DVec2;

/// Steps in which a stretch is looked at, metres of a person.
const STEP_M: f64 = 0.05;

/// Where it is looked at across the wall, from one face to the other.
const ACROSS: [f64; 3] = [0.1, 0.5, 0.9];

/// A wall that reaches so little over a stretch does not stand on it, metres of a person.
const LEAST_M: f64 = 0.1;

/// Walls of two storeys that stand over one another may be drawn so far apart, metres of a person: plaster, and slips.
const SLIP_M: f64 = 0.03;

/// The storey above.
pub(super) struct Overhead {
    storey: String,
    base: Arc<Understood>,
    walls: Vec<Wall>,
}

impl Overhead {
    /// The one above the storey that was understood; none above the highest.
    pub(super) fn of(job: Job<'_>, study: &Study) -> Option<Self> {
        let (storey, base) = together::above(job, study)?;
        let walls = walls(&base.plan, &base.axes);
        Some(Self { storey, base, walls })
    }

    /// The walls that stand over outlines of wall that goes: along one face, and back along the other; plan frame of `base`.
    pub(super) fn over(&self, base: &Understood, outlines: &[[DVec2; 4]]) -> Option<Above> {
        let scale = base.plan.human_scale;
        let (mut length_m, mut over) = (0.0, vec![0.0; self.walls.len()]);
        for o in outlines {
            // A thinner wall may stand over one face alone.
            let lines = ACROSS
                .map(|across| [(o[0], o[3]), (o[1], o[2])].map(|(a, b)| self.here(base, a.lerp(b, across))));
            let length = lines[0][0].distance(lines[0][1]);
            let steps = (length / (STEP_M * scale)).ceil().max(1.0);
            for i in 0..steps as usize {
                let at = lines.map(|[a, b]| a.lerp(b, (i as f64 + 0.5) / steps));
                let is_over = |w: &usize| at.iter().any(|p| self.stands(*w, *p, scale));
                let here: Vec<usize> = (0..self.walls.len()).filter(is_over).collect();
                length_m += if here.is_empty() { 0.0 } else { length / steps };
                here.into_iter().for_each(|w| over[w] += length / steps);
            }
        }
        let mut elements: Vec<ElementRef> = Vec::new();
        let standing = self.walls.iter().zip(&over).filter(|(_, over)| **over >= LEAST_M * scale);
        for record in standing.flat_map(|(w, _)| &w.records) {
            let source = self.base.plan.walls.iter().map(|w| &w.source).find(|s| s.record == *record);
            let element = source.map(|s| show::element(self.base.plan.format, s));
            elements.extend(element.filter(|e| !elements.contains(e)));
        }
        let above = Above { storey: self.storey.clone(), elements, length_m: whole_mm(length_m) };
        (!above.elements.is_empty()).then_some(above)
    }

    /// A point of another plan of the same file in the frame of this one.
    fn here(&self, base: &Understood, p: DVec2) -> DVec2 {
        self.base.plan.frame.plan_from_um(base.plan.frame.um_from_plan(p))
    }

    fn stands(&self, wall: usize, at: DVec2, scale: f64) -> bool {
        let wall = &self.walls[wall];
        let from = at - wall.at;
        let across = wall.along.perp_dot(from).abs();
        (0.0..=wall.length_m).contains(&wall.along.dot(from))
            && across <= wall.thickness_m / 2.0 + SLIP_M * scale
    }
}

//! The two sides of a door in a drawn wall, and where they go when the wall moves.

use std::collections::BTreeSet;

use glam::DVec2;

use enfilade_plan::Plan;
use enfilade_plan::axes::{AxisGraph, Jamb};
use enfilade_plan::graph::Handle;
use enfilade_plan::structure::{face_handles, handle_at};

/// Control points whose distance changes by less go along together, metres of a person.
const RIGID_M: f64 = 1e-4;

/// A door's axis meets the face on which a jamb stands at no less than this (as a sine): where they run nearly alike, no
/// place on the face is across the door.
const CROSSING_MIN: f64 = 0.1;

/// How far something goes, and by how much it turns (cosine and sine).
#[derive(Clone, Copy)]
struct Gone {
    step: DVec2,
    turn: DVec2,
}

/// One side of a door in a drawn wall; metres of a person.
pub(super) struct Side {
    /// Where the door's axis meets it.
    at: DVec2,
    stands: Stands,
}

/// What a jamb is.
enum Stands {
    /// The end of a wall: its control points, and where they are drawn.
    End(Vec<(Handle, DVec2)>),
    /// The wall runs past: the piece on which the jamb stands, by its control points, where on it, and what is across it.
    Face { ends: [Handle; 2], from: [DVec2; 2], share: f64, across: DVec2 },
}

impl Side {
    pub fn new(plan: &Plan, axes: &AxisGraph, jamb: &Jamb, handles: Vec<Handle>) -> Self {
        let edge = jamb.edge.filter(|_| handles.is_empty()).map(|e| &axes.edges[e as usize]);
        let faces = edge.into_iter().flat_map(|e| e.left.iter().chain(&e.right).chain(&e.inner));
        let found = faces.filter_map(|f| {
            let ends: [Handle; 2] = face_handles(plan, *f).try_into().ok()?;
            let from @ [a, b] = ends.map(|h| handle_at(plan, h));
            let along = (b - a).try_normalize()?;
            let share = ((jamb.at - a).dot(along) / a.distance(b)).clamp(0.0, 1.0);
            let face = Stands::Face { ends, from, share, across: along.perp() };
            Some((a.lerp(b, share).distance(jamb.at), face))
        });
        let end = || Stands::End(handles.iter().map(|h| (*h, handle_at(plan, *h))).collect());
        let stands = found.min_by(|a, b| a.0.total_cmp(&b.0)).map_or_else(end, |f| f.1);
        Self { at: jamb.at, stands }
    }

    /// Whether a wall that ends there has one of some control points.
    pub fn ends_in(&self, handles: &BTreeSet<&Handle>) -> bool {
        matches!(&self.stands, Stands::End(own) if own.iter().any(|(h, _)| handles.contains(h)))
    }

    /// Its walls.
    pub fn walls(&self) -> impl Iterator<Item = u32> + '_ {
        let (ends, face) = match &self.stands {
            Stands::End(handles) => (handles.as_slice(), None),
            Stands::Face { ends, .. } => (&[][..], Some(ends[0].0)),
        };
        ends.iter().map(|(h, _)| h.0).chain(face)
    }

    /// How far it goes when its control points go as far as `moved` says. A jamb on a face goes with the face, across it;
    /// along the face it goes with the other jamb.
    pub fn step(&self, moved: &impl Fn(&Handle) -> Option<DVec2>, other: &Self) -> DVec2 {
        let own = self.gone(moved);
        let Stands::Face { from: [a, b], across, .. } = &self.stands else { return own.step };
        let theirs = other.gone(moved);
        if let (Stands::Face { .. }, true) = (&other.stands, own.turn != DVec2::X) {
            return own.step;
        }
        // Where the door's axis, which goes with the other jamb, meets the face as it stands then.
        let face = own.turn.rotate(b - a).normalize_or_zero();
        let axis = theirs.turn.rotate(self.at - other.at).normalize_or_zero();
        let crossing = face.perp_dot(axis);
        if crossing.abs() < CROSSING_MIN {
            return own.step.project_onto(*across) + theirs.step.reject_from(*across);
        }
        let (on_face, on_axis) = (self.at + own.step, other.at + theirs.step);
        on_axis + axis * face.perp_dot(on_face - on_axis) / crossing - self.at
    }

    fn gone(&self, moved: &impl Fn(&Handle) -> Option<DVec2>) -> Gone {
        match &self.stands {
            Stands::End(handles) => {
                let steps: Vec<(DVec2, DVec2)> =
                    handles.iter().filter_map(|(h, at)| Some((*at, moved(h)?))).collect();
                end_gone(self.at, &steps)
            }
            Stands::Face { ends, from, share, across } => {
                let [a, b] = ends.each_ref().map(|h| moved(h).unwrap_or_default());
                let turn = turned((from[0], a), (from[1], b)).unwrap_or(DVec2::X);
                let step = a.lerp(b, *share);
                if turn == DVec2::X {
                    return Gone { step: step.project_onto(*across), turn };
                }
                Gone { step: step + arm_step(self.at - from[0].lerp(from[1], *share), turn), turn }
            }
        }
    }
}

/// How far the end of a wall goes whose control points stand at such places and go so far: as the one that goes farthest,
/// turned with the farthest other that keeps its distance from it.
fn end_gone(at: DVec2, steps: &[(DVec2, DVec2)]) -> Gone {
    let farthest = steps.iter().max_by(|a, b| a.1.length().total_cmp(&b.1.length()));
    let Some((from, step)) = farthest.copied() else { return Gone { step: DVec2::ZERO, turn: DVec2::X } };
    let with = steps.iter().filter_map(|s| Some((s.0.distance(from), turned((from, step), *s)?)));
    let turn = with.max_by(|a, b| a.0.total_cmp(&b.0)).map_or(DVec2::X, |w| w.1);
    Gone { step: step + arm_step(at - from, turn), turn }
}

/// How far the end of an arm goes by a turn about its beginning.
fn arm_step(arm: DVec2, turn: DVec2) -> DVec2 {
    turn.rotate(arm) - arm
}

/// The turn of one point round another, each where it is drawn and how far it goes; `None` where their distance changes, or
/// they are one.
fn turned((a, a_step): (DVec2, DVec2), (b, b_step): (DVec2, DVec2)) -> Option<DVec2> {
    let (was, is) = (b - a, b + b_step - (a + a_step));
    if a_step == b_step {
        return Some(DVec2::X);
    }
    let is_kept = was.length() > RIGID_M && (was.length() - is.length()).abs() < RIGID_M;
    is_kept.then(|| DVec2::new(was.dot(is), was.perp_dot(is)).normalize_or(DVec2::X))
}

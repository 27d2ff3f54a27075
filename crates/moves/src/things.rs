//! What is drawn beside walls and is none: it holds what may move by default, or ends its way.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;

use super::sliding::clipped;
use enfilade_cad::plane::{box_of, distance_to_segment};
use enfilade_plan::Plan;
pub(super) use enfilade_plan::at_walls::AT_WALL_M;
use enfilade_plan::axes::Opening;
use enfilade_plan::fittings::{Fitting, FittingKind, reach_m};
use enfilade_plan::graph::Handle;
use enfilade_plan::obstacles::{BEFORE_DOOR_M, ObstacleKind};

/// What ends this near to a door's gap is part of the door.
const AT_DOOR_M: f64 = 0.1;

/// A straight piece, metres of a person.
pub(super) type Piece = [DVec2; 2];

/// One thing; metres of a person.
pub(super) struct Thing {
    /// The record of its entity.
    pub record: usize,
    /// What it is.
    pub kind: ObstacleKind,
    /// Its pieces.
    pub pieces: Vec<Piece>,
    bounds: [DVec2; 2],
}

/// All that stands in the way, and what of it belongs to which door or window.
pub(super) struct Things<'a> {
    all: Vec<Thing>,
    fitted: BTreeMap<usize, Vec<&'a Fitting>>,
}

impl<'a> Things<'a> {
    /// Those of a plan.
    pub fn new(plan: &Plan, fittings: &'a [Fitting]) -> Self {
        let at = |p| plan.frame.plan_from_um(p) / plan.human_scale;
        let thing = |o: &enfilade_plan::obstacles::Obstacle| {
            let pieces: Vec<Piece> = o.pieces.iter().map(|s| [at(s.a), at(s.b)]).collect();
            let bounds = box_of(pieces.iter().flatten().copied())?;
            Some(Thing { record: o.record, kind: o.kind, pieces, bounds })
        };
        let mut fitted: BTreeMap<usize, Vec<&Fitting>> = BTreeMap::new();
        for f in fittings {
            fitted.entry(f.source.record).or_default().push(f);
        }
        // What is drawn on a wall's own line goes where that goes: a view under its section.
        let is_hosted =
            |record: &usize| fitted.get(record).is_some_and(|f| f.iter().any(|f| f.host.is_some()));
        let others = plan.obstacles.iter().filter(|o| !is_hosted(&o.record));
        Self { all: others.filter_map(thing).collect(), fitted }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// Those that may reach into a box.
    pub fn near(&self, [lo, hi]: [DVec2; 2]) -> impl Iterator<Item = &Thing> {
        self.all.iter().filter(move |t| t.bounds[0].cmple(hi).all() && t.bounds[1].cmpge(lo).all())
    }

    /// Whether a thing is part of any door or window.
    pub fn is_fitted(&self, thing: &Thing) -> bool {
        self.fitted.contains_key(&thing.record) && !self.is_furniture(thing)
    }

    /// Whether a thing is part of a door or window of which a jamb is among some control points, or stands at a side of a
    /// wall that is.
    pub fn goes_along(&self, thing: &Thing, moving: &BTreeSet<Handle>) -> bool {
        let mut fitted = self.fitted.get(&thing.record).into_iter().flatten();
        fitted.any(|f| match &f.kind {
            FittingKind::Furniture(sides) => sides.iter().any(|s| s.iter().all(|h| moving.contains(h))),
            _ => f.jambs.iter().flatten().any(|h| moving.contains(h)),
        })
    }

    /// Whether a thing is furniture at a wall.
    pub fn is_furniture(&self, thing: &Thing) -> bool {
        let fitted = self.fitted.get(&thing.record);
        fitted.is_some_and(|all| all.iter().any(|f| f.is_furniture()))
    }

    /// Whether something is drawn in an opening that would not go along with it: a leaf in its pocket, a frame, a
    /// swing that could not be told.
    pub fn tears(&self, opening: &Opening) -> bool {
        let reach = reach_m(opening);
        let around = [opening.centre - reach, opening.centre + reach];
        let (wide, half) = (opening.width_m / 2.0 + AT_DOOR_M, opening.thickness_m / 2.0 + AT_DOOR_M);
        let local = place(opening.centre, opening.jambs.map(|j| j.at));
        self.near(around).filter(|t| !self.is_fitted(t)).any(|t| {
            let is_near = t.pieces.iter().flatten().all(|p| p.distance(opening.centre) <= reach);
            let is_in = |[p, q]: &Piece| {
                clipped(local(*p), local(*q), -wide, wide).is_some_and(|[lo, hi]| lo <= half && hi >= -half)
            };
            is_near && t.pieces.iter().any(is_in)
        })
    }

    /// How far a door between two jambs in a wall of some thickness may slide back and forth until they come to something
    /// that stands at its wall.
    pub fn room_along(&self, at: Piece, thickness_m: f64, jambs: &BTreeSet<Handle>, most: f64) -> [f64; 2] {
        let (centre, half) = (at[0].midpoint(at[1]), at[0].distance(at[1]) / 2.0);
        let (reach, beside) = (half + most, thickness_m / 2.0 + BEFORE_DOOR_M);
        let local = place(centre, at);
        let mut way = [-most, most];
        let around = [centre - reach - beside, centre + reach + beside];
        for thing in self.near(around).filter(|t| !self.goes_along(t, jambs)) {
            for [p, q] in &thing.pieces {
                let [p, q] = [local(*p), local(*q)].map(|p| DVec2::new(p.y, p.x));
                let Some([lo, hi]) = clipped(p, q, -beside, beside) else { continue };
                if hi > half {
                    way[1] = way[1].min((lo - half).max(0.0));
                }
                if lo < -half {
                    way[0] = way[0].max(-(-hi - half).max(0.0));
                }
            }
        }
        way
    }
}

/// From metres of a person to those along and across an opening, from its middle.
fn place(centre: DVec2, [a, b]: Piece) -> impl Fn(DVec2) -> DVec2 {
    let along = (b - a).normalize_or_zero();
    move |p| DVec2::new((p - centre).dot(along), along.perp_dot(p - centre))
}

/// Distance between two pieces; 0 where they cross.
pub(super) fn gap([a, b]: Piece, [c, d]: Piece) -> f64 {
    let side = |p: DVec2, [a, b]: Piece| (b - a).perp_dot(p - a);
    let parts = |p, q, line| side(p, line) * side(q, line) < 0.0;
    if parts(a, b, [c, d]) && parts(c, d, [a, b]) {
        return 0.0;
    }
    let to = |p, line| distance_to_segment(p, line);
    to(a, [c, d]).min(to(b, [c, d])).min(to(c, [a, b])).min(to(d, [a, b]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_that_cross_have_no_gap() {
        let piece = |a: [f64; 2], b: [f64; 2]| [DVec2::from(a), DVec2::from(b)];
        let level = piece([0.0, 0.0], [4.0, 0.0]);
        for (other, expected) in [
            (piece([1.0, -1.0], [1.0, 1.0]), 0.0),
            (piece([1.0, 0.5], [3.0, 0.5]), 0.5),
            (piece([2.0, 0.25], [2.0, 3.0]), 0.25),
            (piece([7.0, 4.0], [9.0, 9.0]), 5.0),
            (piece([4.0, 0.0], [5.0, 1.0]), 0.0),
        ] {
            assert!((gap(level, other) - expected).abs() < 1e-12, "{other:?}");
            assert!((gap(other, level) - expected).abs() < 1e-12, "{other:?}");
        }
    }
}

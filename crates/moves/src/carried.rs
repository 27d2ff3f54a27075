//! Doors and windows go with the walls they sit in, furniture with those that it stands at.

use glam::DVec2;

use super::{Layout, MovedWall, moved_shape, rigid_shape};
use enfilade_cad::curve::control_points;
use enfilade_cad::drawing::{Editable, RigidMotion, Shape};
use enfilade_plan::fittings::{Fitting, FittingKind};
use enfilade_plan::graph::Handle;
use enfilade_plan::{Plan, Wall};

/// Corners of a wall's ends may differ by this much from one rigid motion: rounding to micrometres.
const RIGID_M: f64 = 2e-5;

/// Faces that a hand drew a little askew slide along their own lines: corners whose shifts differ by less than this,
/// metres of a person, go together. Half of what makes control points one.
pub const ASKEW_M: f64 = 5e-4;

/// Ends that shift by less than this stay.
const STILL_M: f64 = 1e-9;

/// What becomes of a fitting in a layout.
#[derive(Clone, Debug, PartialEq)]
pub enum Carried {
    /// Its wall stands.
    Stays,
    /// It goes along: the shape as it will be written and the motion, drawing units.
    Moves(Shape, RigidMotion),
    /// Its wall moves and it cannot; why, in plain words.
    Stale(String),
}

/// Where a fitting goes.
pub fn carried(plan: &Plan, fitting: &Fitting, layout: &Layout) -> Carried {
    if let Some(host) = fitting.host {
        return with_host(plan, fitting, layout, host);
    }
    if let FittingKind::Furniture(sides) = &fitting.kind {
        return with_sides(plan, fitting, layout, sides);
    }
    let handles: Vec<Handle> = fitting.jambs.concat();
    let (before, after): (Vec<DVec2>, Vec<DVec2>) = handles.iter().map(|h| places(plan, layout, *h)).unzip();
    if before.iter().zip(&after).all(|(p, q)| p.distance(*q) < STILL_M) {
        return Carried::Stays;
    }
    let Some(motion) = motion_of(&before, &after, ASKEW_M * plan.human_scale) else {
        if fitting.kind == FittingKind::Loose {
            return Carried::Stays;
        }
        return Carried::Stale("the two sides of its opening move apart".into());
    };
    match &fitting.editable {
        Editable::No(why) => return Carried::Stale(why.clone()),
        Editable::WithInsert { turnable: false } if motion.turn_rad != 0.0 => {
            return Carried::Stale(plan.format.why_no_turn().into());
        }
        _ => {}
    }
    if motion.turn_rad == 0.0 && motion.shift == DVec2::ZERO {
        return Carried::Stays;
    }
    match rigid_shape(plan, &fitting.shape, &motion) {
        (shape, Some(motion)) => Carried::Moves(shape, motion),
        (_, None) => Carried::Stays,
    }
}

/// A fitting of which the file says in which wall it sits goes with that wall; a line drawn once more on a wall's is
/// drawn on it again.
fn with_host(plan: &Plan, fitting: &Fitting, layout: &Layout, host: u32) -> Carried {
    let moved = layout.walls.iter().find(|w| w.wall == host);
    if plan.walls[host as usize].editable == Editable::Free {
        return moved
            .filter(|w| w.is_changed)
            .map_or(Carried::Stays, |w| again_on(fitting, &plan.walls[host as usize], w));
    }
    let slot = plan.slots.iter().position(|s| s.closing.record == fitting.source.record);
    let moved = super::after_sliding(moved.and_then(|w| w.motion), slot.and_then(|s| layout.slid(s)));
    match (moved, &fitting.editable) {
        (None, _) => Carried::Stays,
        (Some(_), Editable::No(why)) => Carried::Stale(why.clone()),
        (Some(motion), _) => Carried::Moves(moved_shape(plan, &fitting.shape, &motion), motion),
    }
}

/// Furniture goes where the sides of walls go that it stands at: turned with one, shifted with those of a corner. Where a
/// side only grows longer, or two turn, it stays.
fn with_sides(plan: &Plan, fitting: &Fitting, layout: &Layout, sides: &[[Handle; 2]]) -> Carried {
    let askew = ASKEW_M * plan.human_scale;
    let mut shift = DVec2::ZERO;
    for side in sides {
        let (before, after): (Vec<DVec2>, Vec<DVec2>) = side.iter().map(|h| places(plan, layout, *h)).unzip();
        let Some(motion) = motion_of(&before, &after, askew) else { continue };
        if motion.turn_rad != 0.0 {
            let may_turn = fitting.editable != Editable::WithInsert { turnable: false };
            return match rigid_shape(plan, &fitting.shape, &motion) {
                (shape, Some(motion)) if sides.len() == 1 && may_turn => Carried::Moves(shape, motion),
                _ => Carried::Stays,
            };
        }
        // Another side of the same wall, or of one in line with it, says the same again.
        let across = (before[1] - before[0]).normalize_or_zero().perp();
        shift += across * (motion.shift - shift).dot(across);
    }
    match rigid_shape(plan, &fitting.shape, &RigidMotion { turn_rad: 0.0, shift }) {
        (shape, Some(motion)) if shift.length() > STILL_M => Carried::Moves(shape, motion),
        _ => Carried::Stays,
    }
}

fn again_on(fitting: &Fitting, wall: &Wall, moved: &MovedWall) -> Carried {
    let shape = match &moved.shape {
        Shape::Line { a, b } if fitting.shape != wall.shape => Shape::Line { a: *b, b: *a },
        other => other.clone(),
    };
    Carried::Moves(shape, moved.motion.unwrap_or(RigidMotion { turn_rad: 0.0, shift: DVec2::ZERO }))
}

/// A control point as drawn and in the layout, plan frame, metres.
fn places(plan: &Plan, layout: &Layout, (wall, control): Handle) -> (DVec2, DVec2) {
    let drawn = &plan.walls[wall as usize].shape;
    let moved = layout.walls.iter().find(|w| w.wall == wall).map_or(drawn, |w| &w.shape);
    let at = |s: &Shape| plan.frame.plan_from_file(control_points(s)[control as usize]);
    (at(drawn), at(moved))
}

/// The motion that carries all points, or the shift that carries them but for `askew`.
fn motion_of(before: &[DVec2], after: &[DVec2], askew: f64) -> Option<RigidMotion> {
    rigid_motion(before, after).or_else(|| {
        let steps = || before.iter().zip(after).map(|(p, q)| *q - *p);
        let shift = steps().sum::<DVec2>() / before.len() as f64;
        let worst = steps().map(|s| s.distance(shift)).fold(0.0, f64::max);
        // Where they do no more than differ, nothing moves.
        let shift = if shift.length() <= worst { DVec2::ZERO } else { shift };
        (worst <= askew).then_some(RigidMotion { turn_rad: 0.0, shift })
    })
}

/// The turn and shift that carry all points, if one does.
fn rigid_motion(before: &[DVec2], after: &[DVec2]) -> Option<RigidMotion> {
    let mean = |points: &[DVec2]| points.iter().sum::<DVec2>() / points.len() as f64;
    let (from, to) = (mean(before), mean(after));
    let (mut cos, mut sin) = (0.0, 0.0);
    for (p, q) in before.iter().zip(after) {
        cos += (*p - from).dot(*q - to);
        sin += (*p - from).perp_dot(*q - to);
    }
    let is_shift = before.iter().zip(after).all(|(p, q)| (*q - *p).distance(to - from) <= RIGID_M);
    let turn_rad = if is_shift { 0.0 } else { sin.atan2(cos) };
    let turned = |p: DVec2| DVec2::from_angle(turn_rad).rotate(p);
    let shift = to - turned(from);
    let fits = before.iter().zip(after).all(|(p, q)| (turned(*p) + shift).distance(*q) <= RIGID_M);
    fits.then_some(RigidMotion { turn_rad, shift })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_common_motion_is_found_and_only_then() {
        let corners = [DVec2::new(4.0, 2.0), DVec2::new(4.0, 2.1), DVec2::new(5.0, 2.0)];
        let go = |p: &DVec2| DVec2::from_angle(0.2).rotate(*p) + DVec2::new(1.0, -2.0);
        let moved: Vec<DVec2> = corners.iter().map(go).collect();
        let found = rigid_motion(&corners, &moved).unwrap();
        assert!((found.turn_rad - 0.2).abs() < 1e-12 && found.shift.distance(DVec2::new(1.0, -2.0)) < 1e-12);
        let shifted: Vec<DVec2> = corners.iter().map(|p| *p + DVec2::X * 0.3).collect();
        assert_eq!(rigid_motion(&corners, &shifted).unwrap().turn_rad, 0.0);
        let apart = [corners[0], corners[1], corners[2] + DVec2::X * 0.1];
        assert!(rigid_motion(&corners, &apart).is_none());
    }

    /// Corners drawn a little askew: the sides of the opening move alike, or not at all.
    #[test]
    fn corners_that_differ_by_a_hair_go_together() {
        let before =
            [DVec2::new(12.0, 5.6), DVec2::new(12.0, 5.7), DVec2::new(12.9, 5.7), DVec2::new(12.9, 5.6)];
        let go = |by: f64, askew: f64| -> Option<DVec2> {
            let shifts = [-askew, askew, 0.0, 0.0].map(|d| DVec2::new(by + d, 0.0));
            let after: Vec<DVec2> = before.iter().zip(shifts).map(|(p, s)| *p + s).collect();
            motion_of(&before, &after, ASKEW_M).map(|m| m.shift)
        };
        for askew in [4e-5, ASKEW_M - 1e-6] {
            assert!(go(0.5, askew).unwrap().distance(DVec2::X * 0.5) < 1e-9, "{askew}");
            assert_eq!(go(0.0, askew), Some(DVec2::ZERO));
        }
        assert_eq!(go(0.5, ASKEW_M + 1e-6), None);
    }
}

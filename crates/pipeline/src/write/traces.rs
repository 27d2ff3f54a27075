//! What of a layout's walls moved, and from where: stretches, door symbols, arrows.

use std::collections::BTreeMap;

use glam::DVec2;

use crate::understand::understood::Understood;
use crate::write::show::{picture, stroke_of};
use enfilade_cad::curve::control_points;
use enfilade_engine::geometry::PointUm;
use enfilade_moves::carried::{Carried, carried};
use enfilade_moves::{Layout, MovedWall};
use enfilade_overlay::picture::{PlanPicture, Stroke, StrokeKind};
use enfilade_plan::Plan;
use enfilade_plan::curve::{Trace, trace};

/// Corners that go less far stand where they stood, micrometres.
const SAME_UM: f64 = 10.0;

/// A stretch off the line of its piece by less lies on it, micrometres: rounding.
const ON_LINE_UM: f64 = 50.0;

/// Shifts that are shorter get no arrow, metres.
const ARROW_MIN_M: f64 = 0.02;

/// What moved, plan frame, metres.
#[derive(Clone, Debug, Default)]
pub struct Traces {
    /// Where it stands now.
    pub now: Vec<Stroke>,
    /// Where it stood.
    pub before: Vec<Stroke>,
    /// From the middle of each group as drawn to where that is now.
    pub arrows: Vec<[DVec2; 2]>,
}

/// The traces of a layout.
pub fn of(base: &Understood, layout: &Layout) -> Traces {
    let mut out = Traces { arrows: arrows(base, layout), ..Traces::default() };
    for moved in layout.walls.iter().filter(|w| w.is_changed) {
        let wall = &base.plan.walls[moved.wall as usize];
        out.take(&base.plan, (&wall.trace, &moved.trace), wall.is_solid);
    }
    for fitting in &base.fittings {
        let Carried::Moves(shape, _) = carried(&base.plan, fitting, layout) else { continue };
        let [drawn, now] = [&fitting.shape, &shape].map(|s| trace(s, &base.plan.frame));
        out.take(&base.plan, (&drawn, &now), false);
    }
    out
}

/// The plan as a layout has it, what moved shown as such.
pub fn moved_picture(base: &Understood, layout: &Layout) -> PlanPicture {
    let mut out = picture(base);
    for moved in layout.walls.iter().filter(|w| w.is_changed) {
        let solid = base.plan.walls[moved.wall as usize].is_solid;
        let stroke = &mut out.strokes[moved.wall as usize];
        *stroke = stroke_of(&base.plan, &moved.trace, solid, stroke.kind);
    }
    let Traces { now, before, .. } = of(base, layout);
    out.strokes.extend(before.into_iter().chain(now));
    out
}

impl Traces {
    fn take(&mut self, plan: &Plan, (drawn, now): (&Trace, &Trace), is_solid: bool) {
        let is_same_size = drawn.points.len() == now.points.len();
        let moves = |(p, q): (&PointUm, &PointUm)| apart(*p, *q) > SAME_UM;
        if !is_same_size || drawn.points.iter().zip(&now.points).all(moves) && !is_stretched(drawn, now) {
            self.before.push(stroke_of(plan, drawn, is_solid, StrokeKind::Before));
            self.now.push(stroke_of(plan, now, is_solid, StrokeKind::Moved));
            return;
        }
        for ((.., was), (.., is)) in drawn.segments().zip(now.segments()) {
            let ([a, b], [c, d]) = ([was.a, was.b], [is.a, is.b]);
            if apart(a, c) <= SAME_UM && apart(b, d) <= SAME_UM {
                continue;
            }
            if !is_on_line([a, b], [c, d]) {
                self.before.push(line(plan, [a, b], StrokeKind::Before));
                self.now.push(line(plan, [c, d], StrokeKind::Moved));
                continue;
            }
            for (old, new) in [(a, c), (b, d)].into_iter().filter(|(old, new)| apart(*old, *new) > SAME_UM) {
                let is_longer = apart(a, b) < apart(if old == a { b } else { a }, new);
                let kind = if is_longer { StrokeKind::Moved } else { StrokeKind::Before };
                let list = if is_longer { &mut self.now } else { &mut self.before };
                list.push(line(plan, [old, new], kind));
            }
        }
    }
}

/// Whether every piece of a wall stays on its own line: only its length changes.
fn is_stretched(drawn: &Trace, now: &Trace) -> bool {
    let mut both = drawn.segments().zip(now.segments());
    !drawn.is_closed && both.all(|((.., was), (.., is))| is_on_line([was.a, was.b], [is.a, is.b]))
}

fn is_on_line([a, b]: [PointUm; 2], others: [PointUm; 2]) -> bool {
    let v = |p: PointUm| DVec2::new((p[0] - a[0]) as f64, (p[1] - a[1]) as f64);
    let Some(along) = v(b).try_normalize() else { return false };
    others.iter().all(|p| along.perp_dot(v(*p)).abs() <= ON_LINE_UM)
}

fn apart(p: PointUm, q: PointUm) -> f64 {
    ((p[0] - q[0]) as f64).hypot((p[1] - q[1]) as f64)
}

fn line(plan: &Plan, ends: [PointUm; 2], kind: StrokeKind) -> Stroke {
    let points = ends.map(|p| plan.frame.plan_from_um(p).to_array()).to_vec();
    Stroke { points, closed: false, filled: false, kind }
}

/// One arrow a group that shifts.
fn arrows(base: &Understood, layout: &Layout) -> Vec<[DVec2; 2]> {
    let at: BTreeMap<u32, &MovedWall> = layout.walls.iter().map(|w| (w.wall, w)).collect();
    let place = |p: DVec2| base.plan.frame.plan_from_file(p);
    let of = |group: &enfilade_moves::NodeGroup| {
        let both: Vec<[DVec2; 2]> = group
            .corners(&base.plan)
            .filter_map(|(w, c)| {
                let now = *control_points(&at.get(w)?.shape).get(*c as usize)?;
                let drawn = *control_points(&base.plan.walls[*w as usize].shape).get(*c as usize)?;
                Some([place(drawn), place(now)])
            })
            .collect();
        let mean = |k: usize| both.iter().map(|p| p[k]).sum::<DVec2>() / both.len().max(1) as f64;
        let [from, to] = [mean(0), mean(1)];
        (from.distance(to) >= ARROW_MIN_M * base.plan.human_scale).then_some([from, to])
    };
    base.moves.groups.iter().filter_map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use enfilade_engine::geometry::UM_PER_M;

    #[test]
    fn a_line_that_only_grows_is_on_its_line() {
        let m = UM_PER_M as i64;
        let face = [[0, 0], [5 * m, 0]];
        assert!(is_on_line(face, [[0, 0], [6 * m, 0]]));
        assert!(!is_on_line(face, [[0, m], [5 * m, m]]));
        assert!(!is_on_line([[m, m], [m, m]], face), "a point has no line");
    }
}

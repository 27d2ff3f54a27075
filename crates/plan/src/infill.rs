//! What fills the gaps between walls: it closes the outline where an opening was not understood, and stops people.

use glam::DVec2;

use super::Plan;
use super::axes::swing::Swing;
use super::axes::{AxisGraph, Opening, Path, paths_of};
use super::curve::trace as trace_of;
use super::drawn::{DrawnWalls, swing_or};
use super::hidden::Hidden;
use enfilade_cad::curve::control_points;
use enfilade_cad::drawing::{Drawing, Entity, Format};
use enfilade_cad::plane::box_of;
use enfilade_cad::roles;
use enfilade_engine::geometry::{PointUm, Segment};

/// How far beyond the walls what fills their openings may lie, metres of a person: sills, bays.
const BEYOND_WALLS_M: f64 = 1.0;

/// Glass that hangs together with such goes on farther out, up to this share of the longer side of the walls' box:
/// a room of glass before the walls.
const BEYOND_SHARE: f64 = 0.5;

/// Ends of glass nearer than this to glass hang together with it, metres of a person.
const HANGING_M: f64 = 0.1;

/// Most lines beyond the walls that are looked at.
const FAR_MAX: usize = 400;

/// How far beside a wall's faces lines still belong to a window in it, metres of a person: sills, frames.
const SILL_M: f64 = 0.3;

/// What fills the gaps between walls, drawing frame: straight lines of doors, windows and glass by the names of
/// their layers and blocks, and from the hinge of every door's swing to its ends. It closes the outline when it is
/// asked what lies inside, where an opening was not understood; those that were close themselves.
pub fn infill_lines(plan: &Plan, drawing: &Drawing, axes: &AxisGraph) -> Vec<Segment> {
    if drawing.format != Format::Dxf {
        return Vec::new();
    }
    let place = |p: DVec2| plan.frame.plan_from_file(p) / plan.human_scale;
    let points = plan.walls.iter().flat_map(|w| control_points(&w.shape)).map(place);
    let Some([lo, hi]) = box_of(points) else { return Vec::new() };
    let hidden = Hidden::new(drawing);
    let walls = DrawnWalls::new(plan, drawing);
    let lies_within = |s: &[DVec2; 2], beyond: f64| {
        s.iter().all(|p| p.cmpge(lo - beyond).all() && p.cmple(hi + beyond).all())
    };
    let widest = BEYOND_WALLS_M.max(BEYOND_SHARE * (hi - lo).max_element());
    let mut out: Vec<[DVec2; 2]> = Vec::new();
    let shown = drawing.entities.iter().enumerate();
    let shown = shown.filter(|(i, e)| !walls.contains(*i, e) && !plan.is_gone(e));
    for (i, e) in shown.filter(|(_, e)| !hidden.entity(e)) {
        let role = plan.reading.role(i);
        let by_name = fills(role);
        let may_swing = by_name || matches!(role, roles::Role::Wall | roles::Role::Unknown);
        for path in swing_or(paths_of(&e.shape, place)) {
            let shut = Swing::of(&path).filter(|_| may_swing);
            out.extend(shut.iter().flat_map(|s| s.tips().into_iter().map(|tip| [s.hinge, tip])));
            if let Path::Line { a, b } = path
                && by_name
            {
                out.push([a, b]);
            }
        }
    }
    out.retain(|s| lies_within(s, widest) && !axes.openings.iter().any(|o| lies_in(s, o)));
    let (near, far) = out.into_iter().partition(|s| lies_within(s, BEYOND_WALLS_M));
    let walls = plan.walls.iter().flat_map(|w| w.trace.segments());
    let walls = walls.map(|(_, _, s)| [s.a, s.b].map(|p| plan.frame.plan_from_um(p) / plan.human_scale));
    let out = with_hanging(near, far, &walls.collect::<Vec<_>>());
    let um = |p: DVec2| plan.frame.um_from_plan(p * plan.human_scale);
    out.into_iter().map(|[a, b]| Segment { a: um(a), b: um(b) }).collect()
}

/// Lines near the walls, and of those far from them the ones that hang together with these or with a wall.
fn with_hanging(mut near: Vec<[DVec2; 2]>, far: Vec<[DVec2; 2]>, walls: &[[DVec2; 2]]) -> Vec<[DVec2; 2]> {
    if far.len() > FAR_MAX {
        return near;
    }
    let (at_walls, mut far): (Vec<_>, Vec<_>) =
        far.into_iter().partition(|s| walls.iter().any(|w| hangs_at(s, w)));
    near.extend(at_walls);
    let mut from = 0;
    while from < near.len() {
        let (hanging, rest) = far.into_iter().partition(|s| near[from..].iter().any(|t| hangs_at(s, t)));
        far = rest;
        from = near.len();
        near.extend::<Vec<[DVec2; 2]>>(hanging);
    }
    near
}

/// Whether one of two lines ends at the other.
fn hangs_at(s: &[DVec2; 2], t: &[DVec2; 2]) -> bool {
    let at = |p: DVec2, [a, b]: [DVec2; 2]| {
        let d = b - a;
        let share = (p - a).dot(d) / d.length_squared().max(f64::MIN_POSITIVE);
        p.distance(a + d * share.clamp(0.0, 1.0)) <= HANGING_M
    };
    s.iter().any(|p| at(*p, *t)) || t.iter().any(|p| at(*p, *s))
}

/// Whether it fills gaps between walls.
fn fills(role: roles::Role) -> bool {
    matches!(role, roles::Role::Door | roles::Role::Window | roles::Role::Glazing)
}

/// Whether the middle of a line lies in an opening or just beside it.
fn lies_in([a, b]: &[DVec2; 2], opening: &Opening) -> bool {
    let [from, to] = opening.jambs.map(|j| j.at);
    let along = (to - from).normalize_or_zero();
    let p = a.midpoint(*b) - from;
    (-SILL_M..=from.distance(to) + SILL_M).contains(&p.dot(along))
        && along.perp_dot(p).abs() <= opening.thickness_m / 2.0 + SILL_M
}

/// The lines of windows and glass that are shown, drawing frame: they stop people, and sight at the height of a knee.
/// What stands in an understood opening is closed with it.
pub fn glass_lines(plan: &Plan, drawing: &Drawing, axes: &AxisGraph) -> Vec<Segment> {
    let (hidden, walls) = (Hidden::new(drawing), DrawnWalls::new(plan, drawing));
    let is_drawn = |(i, e): &(usize, &Entity)| {
        is_glass(plan, *i)
            && !hidden.entity(e)
            && !walls.contains(*i, e)
            && !plan.is_gone(e)
            && drawing.format == Format::Dxf
    };
    let shown = drawing.entities.iter().enumerate().filter(is_drawn);
    let lines =
        shown.flat_map(|(_, e)| trace_of(&e.shape, &plan.frame).segments().map(|s| s.2).collect::<Vec<_>>());
    let at = |p: PointUm| plan.frame.plan_from_um(p) / plan.human_scale;
    lines.filter(|s| !axes.openings.iter().any(|o| lies_in(&[at(s.a), at(s.b)], o))).collect()
}

/// Whether an entity, by its index, was taken for a window or glass.
pub fn is_glass(plan: &Plan, i: usize) -> bool {
    matches!(plan.reading.role(i), roles::Role::Window | roles::Role::Glazing)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Glass beyond the walls that hangs together is followed to its end, until there is too much of it to be glass.
    #[test]
    fn more_lines_beyond_the_walls_than_the_limit_are_not_looked_at() {
        let chain = |count: usize| -> Vec<[DVec2; 2]> {
            (1..=count).rev().map(|i| [i as f64, i as f64 + 1.0].map(|x| DVec2::new(x, 0.0))).collect()
        };
        let near = vec![[DVec2::ZERO, DVec2::X]];
        assert_eq!(with_hanging(near.clone(), chain(FAR_MAX), &[]).len(), 1 + FAR_MAX);
        assert_eq!(with_hanging(near.clone(), chain(FAR_MAX + 1), &[]), near);
    }
}

//! Joints of a building that a layout opens: what stood at a wall and does not follow it.

use std::collections::BTreeMap;

use glam::DVec2;

use super::joined::JOINT_M;
use super::{Layout, MovedWall};
use crate::plan::curve::Trace;
use crate::plan::drawing::{Format, RigidMotion};
use crate::plan::geometry::{PointUm, Side, segments_touch, side_of_ring};
use crate::plan::{Plan, distance_to_segment};

/// A joint counts as opened where its walls part by more than this, metres: less is rounding and mitres.
pub const OPEN_M: f64 = 0.01;

/// A joint that no longer holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Opened {
    /// Record of a wall that moves.
    pub record: usize,
    /// Record of the wall it was joined to.
    pub other: usize,
    /// How far the end that stood at the other wall is from it, metres.
    pub by_m: f64,
    /// Whether that end now stands beyond the other wall, which runs through; else there is a gap.
    pub is_through: bool,
}

/// The outlines of one record as drawn and in a layout.
#[derive(Default)]
struct Body {
    is_moved: bool,
    drawn: Vec<Trace>,
    now: Vec<Trace>,
}

/// The joints that a layout opens, each once, by the records of their walls. In a DXF all that meets in a point moves with
/// it: nothing is told there.
pub fn opened(plan: &Plan, layout: &Layout) -> Vec<Opened> {
    if plan.format == Format::Dxf {
        return Vec::new();
    }
    let bodies = bodies(plan, layout);
    let mut out = Vec::new();
    for (record, body) in bodies.iter().filter(|b| b.1.is_moved) {
        for (other, at) in bodies.iter().filter(|o| o.0 != record && !(o.1.is_moved && o.0 < record)) {
            out.extend(between(plan, (*record, body), (*other, at)));
        }
    }
    out
}

fn bodies(plan: &Plan, layout: &Layout) -> BTreeMap<usize, Body> {
    let changed: BTreeMap<u32, &MovedWall> =
        layout.walls.iter().filter(|w| w.is_changed).map(|w| (w.wall, w)).collect();
    let mut out: BTreeMap<usize, Body> = BTreeMap::new();
    let mut motions: BTreeMap<usize, RigidMotion> = BTreeMap::new();
    for (w, wall) in plan.walls.iter().enumerate() {
        let body = out.entry(wall.source.record).or_default();
        let moved = changed.get(&(w as u32));
        body.is_moved |= moved.is_some();
        body.drawn.push(wall.trace.clone());
        body.now.push(moved.map_or_else(|| wall.trace.clone(), |m| m.trace.clone()));
        if let Some(motion) = moved.and_then(|m| m.motion) {
            motions.insert(wall.source.record, motion);
        }
    }
    for plug in &plan.plugs {
        let Some(body) = out.get_mut(&plug.host) else { continue };
        body.drawn.push(plug.outline.clone());
        let motion = motions.get(&plug.host);
        body.now.push(motion.map_or_else(|| plug.outline.clone(), |m| after(plan, &plug.outline, m)));
    }
    out
}

/// A trace after a rigid motion in drawing units.
fn after(plan: &Plan, trace: &Trace, motion: &RigidMotion) -> Trace {
    let turn = DVec2::from_angle(motion.turn_rad);
    let go = |p: &PointUm| plan.frame.um_from_file(turn.rotate(plan.frame.file_from_um(*p)) + motion.shift);
    Trace { points: trace.points.iter().map(go).collect(), ..trace.clone() }
}

/// The joint between two records, if they had one and it is open now.
fn between(plan: &Plan, (record, body): (usize, &Body), (other, at): (usize, &Body)) -> Option<Opened> {
    let mut best: Option<f64> = None;
    for (from, to) in [(body, at), (at, body)] {
        for (drawn, now) in from.drawn.iter().zip(&from.now) {
            for (p, q) in drawn.points.iter().zip(&now.points) {
                let was = distance(plan, *p, &to.drawn);
                if was > JOINT_M {
                    continue;
                }
                let is = distance(plan, *q, &to.now);
                if is <= JOINT_M.max(was + OPEN_M) {
                    return None;
                }
                best = Some(best.map_or(is, |b| b.min(is)));
            }
        }
    }
    best.map(|by_m| Opened { record, other, by_m, is_through: gap(plan, body, at) <= JOINT_M })
}

/// How near two records come to each other now: 0 where one reaches into the other.
fn gap(plan: &Plan, a: &Body, b: &Body) -> f64 {
    let touch = a
        .now
        .iter()
        .flat_map(|t| t.segments())
        .any(|(.., s)| b.now.iter().flat_map(|t| t.segments()).any(|(.., o)| segments_touch(s, o)));
    if touch {
        return 0.0;
    }
    let nearest = |from: &Body, to: &Body| {
        let points = from.now.iter().flat_map(|t| &t.points);
        points.map(|p| distance(plan, *p, &to.now)).fold(f64::INFINITY, f64::min)
    };
    nearest(a, b).min(nearest(b, a))
}

/// How far a point is from the outlines of one record, metres; 0 within it, an outline within another being a hole.
fn distance(plan: &Plan, p: PointUm, outlines: &[Trace]) -> f64 {
    let at = |p: PointUm| plan.frame.plan_from_um(p);
    let holds = |t: &&Trace| t.is_closed && side_of_ring(&t.points, p) == Side::Inside;
    if outlines.iter().filter(holds).count() % 2 == 1 {
        return 0.0;
    }
    let to = |t: &Trace| {
        let ways = t.segments().map(|(.., s)| distance_to_segment(at(p), [at(s.a), at(s.b)]));
        ways.fold(f64::INFINITY, f64::min)
    };
    outlines.iter().map(to).fold(f64::INFINITY, f64::min)
}

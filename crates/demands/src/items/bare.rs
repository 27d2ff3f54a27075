//! What the outline of a room says: area, circles, proportion, doors and windows.

use enfilade_brief::demand::Demand;
use enfilade_cad::plane::distance_to_segment;
use enfilade_engine::geometry::UM_PER_M;
use enfilade_plan::kinds::RoomKind;
use glam::DVec2;

use super::{judged, judged_to};
use crate::answer::{Finding, Mark, Verdict};
use crate::building::RoomId;
use crate::peak::{Look, peak};
use crate::polygon::Polygon;
use crate::site::Site;

/// How near the radius of the largest circle is found, metres: its diameter to a millimetre.
const RADIUS_M: f64 = 0.0005;

/// First squares in which circles are looked for, metres.
const SQUARE_M: f64 = 0.5;

pub(super) fn area(site: &Site<'_>, demand: &Demand, room: RoomId) -> Finding {
    let floor = &site.rooms[room.0];
    let value = floor.area_m2();
    Finding::of_room(judged(demand.bound, value), room, Some(value)).at([site.ground_mark(floor)])
}

pub(super) fn width(site: &Site<'_>, demand: &Demand, room: RoomId) -> Finding {
    let Some((at, radius)) = circle(&site.rooms[room.0], &[]) else {
        return Finding::of_room(Verdict::Untold, room, None);
    };
    let value = 2.0 * radius;
    let verdict = judged_to(demand.bound, value, 2.0 * RADIUS_M);
    Finding::of_room(verdict, room, Some(value)).at([circle_mark(site, at, radius)])
}

fn circle_mark(site: &Site<'_>, at: DVec2, radius: f64) -> Mark {
    Mark::Circle(site.um(at), (radius * UM_PER_M).round() as i64)
}

/// The largest circle inside a floor that stays clear of some things: its middle and radius.
pub(crate) fn circle(floor: &Polygon, things: &[[DVec2; 2]]) -> Option<(DVec2, f64)> {
    let look = |at: DVec2| {
        let clear = things.iter().map(|t| distance_to_segment(at, *t)).fold(f64::INFINITY, f64::min);
        Some(Look { at, value: floor.depth_m(at).min(clear) })
    };
    let found = peak(floor.bounds()?, SQUARE_M, RADIUS_M, None, look)?;
    (found.value > 0.0).then_some((found.at, found.value))
}

pub(super) fn proportion(site: &Site<'_>, demand: &Demand, room: RoomId) -> Finding {
    let Some((corners, [long, short])) = smallest_box(&site.rooms[room.0]) else {
        return Finding::of_room(Verdict::Untold, room, None);
    };
    let value = long / short;
    let ring = [corners.as_slice(), &corners[..1]].concat();
    Finding::of_room(judged(demand.bound, value), room, Some(value)).at([site.line_mark(&ring)])
}

/// The smallest rectangle round a floor: one of its sides lies along a side of the hull.
pub(crate) fn smallest_box(floor: &Polygon) -> Option<([DVec2; 4], [f64; 2])> {
    let hull = hull(floor.corners().collect());
    let boxed = |k: usize| {
        let u = (hull[(k + 1) % hull.len()] - hull[k]).try_normalize()?;
        let turned = hull.iter().map(|p| DVec2::new(u.dot(*p), u.perp_dot(*p)));
        let [lo, hi] = enfilade_cad::plane::box_of(turned)?;
        let back = |x: f64, y: f64| u * x + u.perp() * y;
        let corners = [back(lo.x, lo.y), back(hi.x, lo.y), back(hi.x, hi.y), back(lo.x, hi.y)];
        let size = hi - lo;
        (size.min_element() > 0.0).then_some((corners, [size.max_element(), size.min_element()]))
    };
    let all = (0..hull.len()).filter_map(boxed);
    all.min_by(|a, b| (a.1[0] * a.1[1]).total_cmp(&(b.1[0] * b.1[1])))
}

/// The convex hull, anticlockwise.
fn hull(mut points: Vec<DVec2>) -> Vec<DVec2> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let half = |points: &mut dyn Iterator<Item = DVec2>| {
        let mut out: Vec<DVec2> = Vec::new();
        for p in points {
            while out.len() > 1
                && (out[out.len() - 1] - out[out.len() - 2]).perp_dot(p - out[out.len() - 2]) <= 0.0
            {
                out.pop();
            }
            out.push(p);
        }
        out.pop();
        out
    };
    let mut out = half(&mut points.iter().copied());
    out.extend(half(&mut points.iter().rev().copied()));
    out
}

pub(super) fn has_door(site: &Site<'_>, room: RoomId) -> Finding {
    let ways = site.building.openings_of(room).filter(|o| site.building.openings[o.0.0].is_way());
    let ways: Vec<_> = ways.map(|o| o.0).collect();
    let verdict = if ways.is_empty() { Verdict::Fail } else { Verdict::Pass };
    let lines: Vec<Mark> = ways.iter().map(|id| site.line_mark(&site.jambs(*id))).collect();
    Finding::of_room(verdict, room, Some(ways.len() as f64)).through(ways).at(lines)
}

pub(super) fn has_window(site: &Site<'_>, room: RoomId) -> Finding {
    let windows = site.outer_windows(room);
    let lines: Vec<Mark> = windows.iter().map(|id| site.line_mark(&site.jambs(*id))).collect();
    let value = Some(windows.len() as f64);
    if !windows.is_empty() {
        return Finding::of_room(Verdict::Pass, room, value).through(windows).at(lines);
    }
    let doors = site.outer_doors(room);
    if doors.is_empty() {
        return Finding::of_room(Verdict::Fail, room, value).at([site.ground_mark(&site.rooms[room.0])]);
    }
    let found = Finding::of_room(Verdict::Untold, room, value).through(doors);
    found.noted("A door leads to the outside; whether it is glazed stands in no plan.")
}

/// Kinds of rooms in which things stand that a plan may leave out.
const FURNISHED: [RoomKind; 3] = [RoomKind::Bath, RoomKind::Wc, RoomKind::Kitchen];

pub(super) fn turning_circle(site: &Site<'_>, demand: &Demand, room: RoomId) -> Finding {
    let floor = &site.rooms[room.0];
    let things: Vec<[DVec2; 2]> = site.building.things.iter().map(|s| [site.at(s.a), site.at(s.b)]).collect();
    let inside = |t: &&[DVec2; 2]| t.iter().any(|p| floor.depth_m(*p) > -RADIUS_M);
    let things: Vec<[DVec2; 2]> = things.iter().filter(inside).copied().collect();
    let Some((at, radius)) = circle(floor, &things) else {
        return Finding::of_room(Verdict::Fail, room, Some(0.0));
    };
    let value = 2.0 * radius;
    let mut verdict = judged_to(demand.bound, value, 2.0 * RADIUS_M);
    let is_bare = things.is_empty() && FURNISHED.contains(&site.building.room(room).kind);
    if is_bare && verdict == Verdict::Pass {
        verdict = Verdict::Untold;
    }
    let found = Finding::of_room(verdict, room, Some(value)).at([circle_mark(site, at, radius)]);
    match is_bare && verdict == Verdict::Untold {
        true => found.noted("It fits into the bare room; what stands there is not drawn."),
        false => found,
    }
}

//! How wide the ways through a room are: the largest disc that goes from each of its doors to all others.

use enfilade_brief::demand::Demand;
use enfilade_cad::plane::distance_to_segment;
use glam::DVec2;

use super::judged_to;
use crate::answer::{Finding, Verdict};
use crate::building::RoomId;
use crate::items::bare::circle;
use crate::polygon::Polygon;
use crate::site::Site;

/// How exactly a width is found, metres.
const WIDTH_M: f64 = 0.002;

/// A disc stands before a door if it comes this near to it, metres.
const AT_DOOR_M: f64 = 0.01;

pub(super) fn of_ways(site: &Site<'_>, demand: &Demand, room: RoomId) -> Finding {
    let floor = &site.rooms[room.0];
    let ways = site.building.openings_of(room).filter(|o| site.building.openings[o.0.0].is_way());
    let (ids, fronts): (Vec<_>, Vec<[DVec2; 2]>) =
        ways.map(|(id, side)| (id, front(site, id.0, side))).unzip();
    let Some((_, radius)) = circle(floor, &[]) else {
        return Finding::of_room(Verdict::Untold, room, None);
    };
    let widest = 2.0 * radius;
    let value = if fronts.len() < 2 { widest } else { narrowest(floor, &fronts, widest) };
    let found = Finding::of_room(judged_to(demand.bound, value, WIDTH_M), room, Some(value));
    let found = found.through(ids).at([site.ground_mark(floor)]);
    if fronts.len() < 2 { found.noted("It has one door: the largest circle counts.") } else { found }
}

/// The line of an opening along the face of its wall on one side.
fn front(site: &Site<'_>, opening: usize, side: usize) -> [DVec2; 2] {
    let [a, b] = site.building.openings[opening].jambs.map(|p| site.at(p));
    let half = site.building.openings[opening].thickness_m / 2.0;
    let into = (b - a).normalize_or_zero().perp() * half * if side == 0 { 1.0 } else { -1.0 };
    [a + into, b + into]
}

/// The widest disc that can go from each front to all others.
fn narrowest(floor: &Polygon, fronts: &[[DVec2; 2]], widest: f64) -> f64 {
    let (mut fits, mut sticks) = (0.0, widest);
    if joins(floor, fronts, widest - WIDTH_M) {
        return widest;
    }
    while sticks - fits > WIDTH_M {
        let middle = f64::midpoint(fits, sticks);
        if joins(floor, fronts, middle) { fits = middle } else { sticks = middle }
    }
    f64::midpoint(fits, sticks)
}

/// Whether the middle of a disc can go from each front to all others.
fn joins(floor: &Polygon, fronts: &[[DVec2; 2]], width: f64) -> bool {
    let reach = width / 2.0 + AT_DOOR_M;
    let stands = |part: &Polygon, front: &[DVec2; 2]| {
        let corner = part.corners().map(|c| distance_to_segment(c, *front)).fold(f64::INFINITY, f64::min);
        let end = |p: DVec2| part.sides().map(|s| distance_to_segment(p, s)).fold(corner, f64::min);
        end(front[0]).min(end(front[1])) <= reach
    };
    floor.inset(width / 2.0).parts().any(|part| fronts.iter().all(|f| stands(&part, f)))
}

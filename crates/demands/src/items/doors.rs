//! Doors: how wide they are, and what is free beside their handles.

use enfilade_brief::demand::Demand;
use enfilade_plan::axes::OpeningKind;
use glam::DVec2;

use super::{ROUNDING, judged};
use crate::answer::{Finding, Verdict};
use crate::building::{Opening, OpeningId};
use crate::site::Site;

/// What frame and leaf may take of an opening in a wall, metres: an opening of 885 mm has a clear width of 811 mm by
/// DIN 18101.
const FRAME_M: f64 = 0.074;

/// How far a handle sits inside the clear width of its door at most, metres: a backset of 55 to 65 mm (DIN 18251) and
/// its rose.
const HANDLE_M: f64 = 0.1;

/// How far into a room something stands beside a handle, metres: from behind a skirting to as far as an arm reaches.
const BESIDE_M: [f64; 2] = [0.02, 0.6];

/// Whether an opening leaves a clear width, where a plan can tell; and why not.
pub(super) fn judged_clear(least_m: f64, opening: &Opening) -> (Verdict, Option<String>) {
    let has_frame = opening.kind == OpeningKind::Door;
    let sure_m = opening.width_m - if has_frame { FRAME_M } else { 0.0 };
    if opening.width_m < least_m - ROUNDING {
        return (Verdict::Fail, None);
    }
    if sure_m >= least_m - ROUNDING {
        return (Verdict::Pass, None);
    }
    let note = format!("Wide enough between the jambs; frame and leaf may take {:.0} mm.", FRAME_M * 1e3);
    (Verdict::Untold, Some(note))
}

pub(super) fn clear_width(site: &Site<'_>, demand: &Demand, id: OpeningId) -> Finding {
    let opening = &site.building.openings[id.0];
    let (verdict, note) = match demand.bound.least {
        Some(least) if judged(demand.bound, opening.width_m) == Verdict::Pass => judged_clear(least, opening),
        _ => (judged(demand.bound, opening.width_m), None),
    };
    let rooms = (0..2).filter_map(|s| site.building.beyond(id, s)).collect();
    let marks = vec![site.line_mark(&site.jambs(id))];
    Finding { verdict, rooms, openings: vec![id], measured: Some(opening.width_m), marks, note }
}

/// What is free beside the handle of a door, on each side of it that is a room.
pub(super) fn beside_handle(site: &Site<'_>, demand: &Demand, id: OpeningId) -> Vec<Finding> {
    let opening = &site.building.openings[id.0];
    if opening.kind != OpeningKind::Door {
        return Vec::new();
    }
    let sides = (0..2).filter_map(|side| Some((side, site.building.beyond(id, 1 - side)?)));
    let handle = handle(site, id);
    let one = |(side, room): (usize, crate::building::RoomId)| {
        let free = [0, 1].map(|jamb| free_m(site, id, side, jamb));
        let all: Vec<usize> = handle.map_or(vec![0, 1], |h| vec![h]);
        let worst = all.iter().copied().min_by(|a, b| free[*a].total_cmp(&free[*b])).unwrap_or(0);
        let best = all.iter().copied().max_by(|a, b| free[*a].total_cmp(&free[*b])).unwrap_or(0);
        let verdict = match (judged(demand.bound, free[worst]), judged(demand.bound, free[best] + HANDLE_M)) {
            (Verdict::Pass, _) => Verdict::Pass,
            (_, Verdict::Fail) => Verdict::Fail,
            _ => Verdict::Untold,
        };
        let line = site.line_mark(&beside(site, id, side, worst, free[worst].min(1.0)));
        let found = Finding::of_room(verdict, room, Some(free[worst])).through([id]).at([line]);
        match (verdict, handle) {
            (Verdict::Untold, None) => {
                found.noted("On which side the handle is stands in no line of the plan.")
            }
            (Verdict::Untold, _) => found.noted("It depends on how far the handle sits from the jamb."),
            _ => found,
        }
    };
    sides.map(one).collect()
}

/// The jamb at which the handle is: away from the end at which the leaf hangs.
fn handle(site: &Site<'_>, id: OpeningId) -> Option<usize> {
    let leaves = &site.building.openings[id.0].leaves;
    let [leaf] = leaves.as_slice() else { return None };
    let far =
        site.jambs(id).map(|j| leaf.iter().map(|p| site.at(*p).distance(j)).fold(f64::INFINITY, f64::min));
    let width = site.building.openings[id.0].width_m;
    // A leaf that stands open is near one jamb alone.
    let is_told = (far[0] - far[1]).abs() > width / 4.0;
    is_told.then_some(if far[0] < far[1] { 1 } else { 0 })
}

/// Origin, direction along the wall away from the opening, and direction into the room, at a jamb.
fn corner(site: &Site<'_>, id: OpeningId, side: usize, jamb: usize) -> [DVec2; 3] {
    let jambs = site.jambs(id);
    let along = (jambs[1] - jambs[0]).normalize_or_zero();
    let into = along.perp() * if side == 0 { 1.0 } else { -1.0 };
    let half = site.building.openings[id.0].thickness_m / 2.0;
    [jambs[jamb] + into * half, if jamb == 0 { -along } else { along }, into]
}

fn beside(site: &Site<'_>, id: OpeningId, side: usize, jamb: usize, length: f64) -> [DVec2; 2] {
    let [from, out, into] = corner(site, id, side, jamb);
    [from + into * 0.05, from + into * 0.05 + out * length]
}

/// How far the floor beside a jamb goes on along the wall, metres.
fn free_m(site: &Site<'_>, id: OpeningId, side: usize, jamb: usize) -> f64 {
    let Some(room) = site.building.beyond(id, 1 - side) else { return 0.0 };
    let [from, out, into] = corner(site, id, side, jamb);
    let local = |p: DVec2| DVec2::new(out.dot(p - from), into.dot(p - from));
    let near = |[a, b]: [DVec2; 2]| {
        let [a, b] = [local(a), local(b)];
        let [lo, hi] = BESIDE_M;
        if a.y.max(b.y) <= lo || a.y.min(b.y) >= hi {
            return None;
        }
        let at =
            |y: f64| if a.y == b.y { a.x } else { a.lerp(b, ((y - a.y) / (b.y - a.y)).clamp(0.0, 1.0)).x };
        let ends = [at(lo), at(hi)];
        (ends[0].max(ends[1]) > -ROUNDING).then(|| ends[0].min(ends[1]).max(0.0))
    };
    site.rooms[room.0].sides().filter_map(near).fold(f64::INFINITY, f64::min)
}

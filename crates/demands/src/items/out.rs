//! Ways out: how long, how straight, without a choice, and how wide.

use std::collections::BTreeMap;

use enfilade_brief::demand::{Bound, Demand};
use glam::DVec2;

use super::doors::judged_clear;
use super::judged;
use crate::answer::{Finding, Verdict};
use crate::building::{OpeningId, RoomId};
use crate::peak::{Look, NEAR_M, peak};
use crate::polygon::Polygon;
use crate::site::Site;
use crate::walk::{Ground, Ways, nearest};

/// First squares in which the farthest place is looked for, metres.
const SQUARE_M: f64 = 1.0;

/// Two ways are a choice if they part by this angle: 45°, as Approved Document B (England), volume 2, has it for
/// alternative escape routes.
const CHOICE_DEG: f64 = 45.0;

/// Steps in which a way is followed until there is a choice, metres, and how exactly the place is found then.
const STEP_M: f64 = 0.25;
const PLACE_M: f64 = 0.002;

/// Places lie this near to the outline of the room whose farthest place is wanted, metres.
const ON_M: f64 = 1e-5;

const TOO_MANY: &str = "The plan has too many corners to look for ways.";
const NO_EXIT: &str = "No door leads outside; EF-EXIT says where the exits are.";
const NO_WAY: &str = "No way leads to an exit.";

/// Ground and exits, or why neither is known.
fn ground<'a>(site: &'a Site<'_>) -> Result<(&'a Ground, Vec<[DVec2; 2]>), String> {
    let lines: Vec<[DVec2; 2]> = site.exits().iter().map(|e| e.line).collect();
    if lines.is_empty() {
        return Err(NO_EXIT.into());
    }
    Ok((site.ground().ok_or(TOO_MANY)?, lines))
}

/// The farthest place of a room.
fn farthest(floor: &Polygon, value: impl Fn(DVec2) -> Option<f64>) -> Option<Look> {
    let at = |p: DVec2| Some(Look { at: p, value: value(p)? });
    let first = floor.corners().filter_map(at).max_by(|a, b| a.value.total_cmp(&b.value));
    // Corners are farthest but where two ways are as long.
    let look = |p: DVec2| at(if floor.holds(p) { p } else { on_outline(floor, p) });
    peak(floor.bounds()?, SQUARE_M, NEAR_M, first, look)
}

fn on_outline(floor: &Polygon, p: DVec2) -> DVec2 {
    let all = floor.sides().map(|s| nearest(p, s));
    all.min_by(|a, b| a.distance_squared(p).total_cmp(&b.distance_squared(p))).unwrap_or(p)
}

pub(super) fn walked(site: &Site<'_>, demand: &Demand, rooms: &[RoomId]) -> Result<Vec<Finding>, String> {
    let (ground, lines) = ground(site)?;
    let ways = ground.ways(&lines);
    Ok(rooms.iter().map(|r| walked_one(site, demand.bound, *r, &ways)).collect())
}

fn walked_one(site: &Site<'_>, bound: Bound, room: RoomId, ways: &Ways<'_>) -> Finding {
    let floor = &site.rooms[room.0];
    let Some(far) = farthest(floor, |p| ways.from(p).map(|leg| leg.length_m)) else {
        return Finding::of_room(Verdict::Fail, room, None).at([site.ground_mark(floor)]).noted(NO_WAY);
    };
    let way = ways.way(far.at);
    let exit = way.as_ref().and_then(|w| site.exits()[w.1].opening);
    let line = way.map(|w| site.line_mark(&w.0));
    Finding::of_room(judged(bound, far.value), room, Some(far.value)).through(exit).at(line)
}

pub(super) fn straight(site: &Site<'_>, demand: &Demand, rooms: &[RoomId]) -> Result<Vec<Finding>, String> {
    let (ground, lines) = ground(site)?;
    let ways = ground.ways(&lines);
    let to = |p: DVec2| {
        let all = lines.iter().map(|l| nearest(p, *l));
        all.min_by(|a, b| a.distance_squared(p).total_cmp(&b.distance_squared(p))).unwrap_or(p)
    };
    let one = |room: &RoomId| {
        let floor = &site.rooms[room.0];
        let is_reached = floor.corners().any(|c| ways.from(c).is_some());
        let far = farthest(floor, |p| Some(p.distance(to(p)))).filter(|_| is_reached);
        let Some(far) = far else {
            return Finding::of_room(Verdict::Fail, *room, None).at([site.ground_mark(floor)]).noted(NO_WAY);
        };
        let line = site.line_mark(&[far.at, to(far.at)]);
        Finding::of_room(judged(demand.bound, far.value), *room, Some(far.value)).at([line])
    };
    Ok(rooms.iter().map(one).collect())
}

pub(super) fn dead_end(site: &Site<'_>, demand: &Demand, rooms: &[RoomId]) -> Result<Vec<Finding>, String> {
    let (ground, lines) = ground(site)?;
    let nearest = ground.ways(&lines);
    let each: Vec<Ways<'_>> = match lines.len() {
        1 => Vec::new(),
        _ => lines.iter().map(|l| ground.ways(&[*l])).collect(),
    };
    let one = |room: &RoomId| {
        let Some((length_m, way)) = longest(&site.rooms[room.0], ground, &nearest, &each) else {
            let ground = site.ground_mark(&site.rooms[room.0]);
            return Finding::of_room(Verdict::Fail, *room, None).at([ground]).noted(NO_WAY);
        };
        let found = Finding::of_room(judged(demand.bound, length_m), *room, Some(length_m));
        let found = found.at([site.line_mark(&way)]);
        if lines.len() == 1 { found.noted("There is one exit.") } else { found }
    };
    Ok(rooms.iter().map(one).collect())
}

/// The longest way without a choice from the corners of a room.
fn longest(
    floor: &Polygon,
    ground: &Ground,
    nearest: &Ways<'_>,
    each: &[Ways<'_>],
) -> Option<(f64, Vec<DVec2>)> {
    let far = |c: DVec2| Some((nearest.from(c)?.length_m, c));
    let mut corners: Vec<(f64, DVec2)> = floor.corners().filter_map(far).collect();
    corners.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut best: Option<(f64, Vec<DVec2>)> = None;
    for (walk, corner) in corners {
        // It is no longer than the walk.
        if best.as_ref().is_some_and(|b| b.0 >= walk) {
            break;
        }
        let found = without_choice(ground, nearest, each, corner);
        best = match (best, found) {
            (Some(b), Some(f)) if f.0 > b.0 => Some(f),
            (None, found) => found,
            (best, _) => best,
        };
    }
    best
}

/// How far one walks from a point before two directions lead to two exits, and the way until then.
fn without_choice(
    ground: &Ground,
    nearest: &Ways<'_>,
    each: &[Ways<'_>],
    from: DVec2,
) -> Option<(f64, Vec<DVec2>)> {
    let (way, _) = nearest.way(from)?;
    let is_choice = |p: DVec2| {
        let mut to: Vec<DVec2> = Vec::new();
        each.iter().filter_map(|w| Some((w.from(p)?.to - p).normalize_or_zero())).any(|a| {
            let is_apart = to.iter().any(|b| a.dot(*b) <= CHOICE_DEG.to_radians().cos() + 1e-9);
            to.push(a);
            is_apart
        })
    };
    let (mut walked, mut out) = (0.0, vec![from]);
    for leg in way.windows(2) {
        let length = leg[0].distance(leg[1]);
        let mut s = 0.0;
        while s < length {
            let next = (s + STEP_M).min(length);
            let at = |s: f64| leg[0].lerp(leg[1], s / length);
            if is_choice(at(next)) && ground.holds(at(next)) {
                let found = first(s, next, |s| is_choice(at(s)));
                out.push(at(found));
                return Some((walked + found, out));
            }
            s = next;
        }
        walked += length;
        out.push(leg[1]);
    }
    Some((walked, out))
}

/// Where something first holds between a place where it may not and one where it does.
fn first(mut from: f64, mut to: f64, holds: impl Fn(f64) -> bool) -> f64 {
    if holds(from) {
        return from;
    }
    while to - from > PLACE_M {
        let middle = f64::midpoint(from, to);
        if holds(middle) { to = middle } else { from = middle }
    }
    to
}

/// Clear width of ways out by the number of people that depend on them: the German rule for workplaces ASR A2.3
/// (August 2007, amended 2017), 5 (3).
const WIDTHS: [(u32, f64); 5] = [(5, 0.875), (20, 1.0), (200, 1.2), (300, 1.8), (400, 2.4)];

/// The width that so many people need, metres; `None` where the rule has none.
pub(crate) fn width_for(people: u32) -> Option<f64> {
    WIDTHS.iter().find(|w| people <= w.0).map(|w| w.1)
}

pub(super) fn wide_for(site: &Site<'_>, demand: &Demand, rooms: &[RoomId]) -> Result<Vec<Finding>, String> {
    let people = demand.people.unwrap_or(1);
    let least = width_for(people).ok_or("The rule has no width for more than 400 people.")?;
    if site.exits().is_empty() {
        return Err(NO_EXIT.into());
    }
    let widest = widest(site);
    let one = |room: &RoomId| match widest.get(room) {
        Some(Some(id)) => {
            let opening = &site.building.openings[id.0];
            let (verdict, note) = judged_clear(least, opening);
            let found = Finding::of_room(verdict, *room, Some(opening.width_m)).through([*id]);
            let found = found.at([site.line_mark(&site.jambs(*id))]);
            note.map_or(found.clone(), |n| found.noted(n))
        }
        Some(None) => Finding::of_room(Verdict::Pass, *room, None),
        None => {
            let ground = site.ground_mark(&site.rooms[room.0]);
            Finding::of_room(Verdict::Fail, *room, None).at([ground]).noted(NO_WAY)
        }
    };
    Ok(rooms.iter().map(one).collect())
}

/// For every room the narrowest opening on the way out that has the widest; none where the exit lies in the room.
fn widest(site: &Site<'_>) -> BTreeMap<RoomId, Option<OpeningId>> {
    let width = |id: Option<OpeningId>| id.map_or(f64::INFINITY, |id| site.building.openings[id.0].width_m);
    let narrower = |a: Option<OpeningId>, b: OpeningId| if width(a) < width(Some(b)) { a } else { Some(b) };
    let mut open: Vec<(RoomId, Option<OpeningId>)> = Vec::new();
    for exit in site.exits() {
        match exit.opening {
            Some(id) => open.extend((0..2).filter_map(|s| Some((site.building.beyond(id, s)?, Some(id))))),
            None => {
                let middle = exit.line[0].midpoint(exit.line[1]);
                let room = site.rooms.iter().position(|r| r.depth_m(middle) > -ON_M);
                open.extend(room.map(|r| (RoomId(r), None)));
            }
        }
    }
    let mut out: BTreeMap<RoomId, Option<OpeningId>> = BTreeMap::new();
    while let Some(best) = (0..open.len())
        .max_by(|a, b| width(open[*a].1).total_cmp(&width(open[*b].1)).then(open[*b].0.cmp(&open[*a].0)))
    {
        let (room, by) = open.swap_remove(best);
        if out.contains_key(&room) {
            continue;
        }
        out.insert(room, by);
        let ways = site.building.openings_of(room).filter(|o| site.building.openings[o.0.0].is_way());
        for (id, side) in ways {
            open.extend(site.building.beyond(id, side).map(|next| (next, narrower(by, id))));
        }
    }
    out
}

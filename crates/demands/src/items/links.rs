//! Which rooms lie side by side, and which lead into each other.

use std::collections::{BTreeMap, VecDeque};

use enfilade_brief::demand::{Demand, DemandKind};
use glam::DVec2;

use crate::answer::{Finding, Mark, Verdict};
use crate::building::{OpeningId, RoomId};
use crate::select;
use crate::site::Site;

/// Thickest wall between two rooms that lie side by side, metres: as thick as walls are believed at all
/// (`THICKNESS_MAX_M` of the axes).
const WALL_MAX_M: f64 = 0.8;

/// Rooms with less wall in common touch at a corner, metres: the narrowest door would not stand in it.
const COMMON_MIN_M: f64 = 0.5;

/// Two sides of one wall differ by no more than this, the sine: as the faces of walls drawn by eye do.
const ALONG_SIN: f64 = 0.06;

pub(super) fn next_to(site: &Site<'_>, demand: &Demand, room: RoomId, others: &[RoomId]) -> Finding {
    let best = others.iter().map(|o| (*o, common(site, room, *o)));
    let best = best.max_by(|a, b| a.1.0.total_cmp(&b.1.0));
    let (other, (wall, lines)) = best.unwrap_or((room, (0.0, Vec::new())));
    let is_joined = |o: &RoomId| between(site, room, *o).next().is_some();
    let is_next = wall >= COMMON_MIN_M || others.iter().any(is_joined);
    let verdict = match is_next != demand.kind.is_negative() {
        true => Verdict::Pass,
        false => Verdict::Fail,
    };
    let mut found = Finding::of_room(verdict, room, Some(wall));
    if wall > 0.0 {
        found.rooms.push(other);
    }
    let marks: Vec<Mark> = lines.iter().map(|l| site.line_mark(l)).collect();
    let ground = site.ground_mark(&site.rooms[room.0]);
    found.at(if marks.is_empty() { vec![ground] } else { marks })
}

/// How much wall two rooms have in common, metres, and where.
fn common(site: &Site<'_>, a: RoomId, b: RoomId) -> (f64, Vec<[DVec2; 2]>) {
    let (mut sum, mut lines) = (0.0, Vec::new());
    for [p, q] in site.rooms[a.0].sides() {
        let length = p.distance(q);
        let along = (q - p) / length.max(f64::MIN_POSITIVE);
        for [r, s] in site.rooms[b.0].sides() {
            let back = (s - r).normalize_or_zero();
            // The inside lies to the left: sides of one wall run against each other, each to the right of the other.
            let is_opposite = along.dot(back) < 0.0 && along.perp_dot(back).abs() <= ALONG_SIN;
            let off = -along.perp_dot(r.midpoint(s) - p);
            let (from, to) = (along.dot(s - p).max(0.0), along.dot(r - p).min(length));
            if is_opposite && (-COMMON_MIN_M / 100.0..=WALL_MAX_M).contains(&off) && to > from {
                sum += to - from;
                lines.push([p + along * from, p + along * to]);
            }
        }
    }
    (sum, lines)
}

/// Ways from one room straight into another.
fn between<'a>(site: &'a Site<'_>, a: RoomId, b: RoomId) -> impl Iterator<Item = OpeningId> + 'a {
    let ways = site.building.openings_of(a).filter(|o| site.building.openings[o.0.0].is_way());
    ways.filter(move |(id, side)| site.building.beyond(*id, *side) == Some(b)).map(|o| o.0)
}

/// Word for any room on a way.
const ANY: &str = "any";

pub(super) fn reached(
    site: &Site<'_>,
    demand: &Demand,
    rooms: &[RoomId],
    others: &[RoomId],
) -> Result<Vec<Finding>, String> {
    let mut through = Vec::new();
    for word in demand.through.iter().filter(|w| *w != ANY) {
        through.extend(select::rooms(site.building, word)?);
    }
    let is_any = demand.through.iter().any(|w| w == ANY);
    let may = |r: RoomId| is_any || through.contains(&r);
    Ok(rooms.iter().map(|r| reached_one(site, demand.kind, *r, others, &may)).collect())
}

fn reached_one(
    site: &Site<'_>,
    kind: DemandKind,
    room: RoomId,
    others: &[RoomId],
    may: &dyn Fn(RoomId) -> bool,
) -> Finding {
    let found = fewest(site, room, others, may);
    let verdict = match found.is_some() != kind.is_negative() {
        true => Verdict::Pass,
        false => Verdict::Fail,
    };
    match found {
        Some(way) => {
            let lines: Vec<Mark> = way.iter().map(|id| site.line_mark(&site.jambs(*id))).collect();
            Finding::of_room(verdict, room, Some(way.len() as f64)).through(way).at(lines)
        }
        None => {
            let out = Finding::of_room(verdict, room, None).at([site.ground_mark(&site.rooms[room.0])]);
            match fewest(site, room, others, &|_| true) {
                Some(way) => out.noted(format!("By {} doors.", way.len())),
                None => out.noted("No way leads there."),
            }
        }
    }
}

/// The openings of a way through fewest of them, through rooms that it may lead through.
fn fewest(
    site: &Site<'_>,
    from: RoomId,
    to: &[RoomId],
    may: &dyn Fn(RoomId) -> bool,
) -> Option<Vec<OpeningId>> {
    let mut came: BTreeMap<RoomId, (RoomId, OpeningId)> = BTreeMap::new();
    let mut open = VecDeque::from([from]);
    while let Some(room) = open.pop_front() {
        if room != from && to.contains(&room) {
            let mut way = Vec::new();
            let mut at = room;
            while at != from {
                let (before, opening) = *came.get(&at)?;
                way.push(opening);
                at = before;
            }
            way.reverse();
            return Some(way);
        }
        if room != from && !may(room) {
            continue;
        }
        let ways = site.building.openings_of(room).filter(|o| site.building.openings[o.0.0].is_way());
        for (id, side) in ways {
            let Some(next) = site.building.beyond(id, side) else { continue };
            if next != from && !came.contains_key(&next) {
                came.insert(next, (room, id));
                open.push_back(next);
            }
        }
    }
    None
}

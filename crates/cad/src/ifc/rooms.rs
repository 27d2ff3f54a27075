//! Rooms that a moved wall bounds: each side of a room's outline that lies on such a wall goes with it, and the corners
//! between are where the sides then meet.
//!
//! Certain is a room of which every point stands on its outline, and whose shape can follow ([`super::reshape`]). Every
//! other one stays as drawn, with the reason. Areas, volumes and girths that the file states follow where they were those of
//! the outline as drawn; other quantities and the boundaries of the room are named.

use std::collections::BTreeMap;

use glam::DVec2;

use super::building::Building;
use super::footprint::{Footprint, StandingWall};
use super::geo::Why;
use super::length;
use super::model::Product;
use super::number::real;
use super::quantity::{Stated, is_same};
use super::reshape::{Change, Node, Reshape, list_of};
use super::standing::reach;
use super::step::Arg;
use super::unseen::Tails;
use crate::drawing::{Edit, RigidMotion};
use crate::plane::distance_to_segment;
use crate::plane::ring_area;
use crate::room_outline::{ON_WALL_M, PARALLEL_SIN, Walls, Way, followed, sides, way};

/// A room that a moved wall bounds.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Room {
    /// The space.
    pub id: u64,
    /// Its outline as drawn and afterwards, world, file units; or why it stays as drawn.
    pub outlines: Result<[Vec<DVec2>; 2], Why>,
    /// Names of its quantities that stay as stated, though the room is another.
    pub quantities: Vec<String>,
    /// How many of its space boundaries lie on walls that change.
    pub boundaries: usize,
    /// What changes below the space; nothing where it stays.
    pub shape: Option<Node>,
    /// Sets of quantities of which some follow.
    pub stated: Vec<Node>,
}

/// A wall that changes.
struct Wall<'b> {
    id: u64,
    at: &'b StandingWall,
    motion: Option<RigidMotion>,
    /// Direction along it, its two ends, and how far these go along.
    ends: Option<(DVec2, [Vec<DVec2>; 2], [f64; 2])>,
}

impl Wall<'_> {
    /// How a side at a place of the wall goes; `None` where it stays there.
    fn way(&self, along_side: DVec2, at: DVec2, near: f64) -> Option<Way> {
        let end = self.ends.as_ref().and_then(|(along, ends, by)| {
            let is_at = |k: &usize| ends[*k].iter().any(|p| (at - *p).dot(*along).abs() <= near);
            let is_across = along.dot(along_side).abs() <= PARALLEL_SIN;
            (0..2).filter(|k| is_across && by[*k] != 0.0).find(is_at).map(|k| *along * by[k])
        });
        let way = Way { along: end.unwrap_or_default(), motion: self.motion };
        (end.is_some() || self.motion.is_some()).then_some(way)
    }
}

/// The walls that edits change, and those that go along.
fn walls<'b>(b: &'b Building<'_, '_>, edits: &[Edit], tails: &Tails) -> Vec<Wall<'b>> {
    let mut found: BTreeMap<u64, (Option<RigidMotion>, [f64; 2])> = BTreeMap::new();
    for edit in edits.iter().filter(|e| !e.is_still()) {
        let one = found.entry(edit.record() as u64).or_default();
        match edit {
            Edit::Insert { motion, .. } => one.0 = Some(*motion),
            Edit::Ends { by, .. } => one.1 = *by,
            Edit::Shape { .. } | Edit::Points { .. } | Edit::Work { .. } => {}
        }
    }
    found.extend(tails.values().flatten().map(|t| (t.id, (None, t.by))));
    let wall = |(id, (motion, by)): (u64, (Option<RigidMotion>, [f64; 2]))| {
        let at = b.standing().get(&id)?;
        let bar = length::bar(b, id).ok().filter(|_| by != [0.0; 2]);
        Some(Wall { id, at, motion, ends: bar.map(|bar| (bar.along, bar.ends, by)) })
    };
    found.into_iter().filter_map(wall).collect()
}

/// The rooms that the walls bound which edits change. `tails`: the walls that go along.
pub(super) fn bounded(b: &Building<'_, '_>, edits: &[Edit], tails: &Tails) -> Vec<Room> {
    let walls = walls(b, edits, tails);
    if walls.is_empty() {
        return Vec::new();
    }
    let near = ON_WALL_M / b.geo.metres;
    let one = |p: &Product| {
        let (at, own) = (Footprint::of(b, p.id)?, reach(b, p.id)?);
        let shares_height = |w: &&Wall<'_>| w.at.reach[0] < own[1] && own[0] < w.at.reach[1];
        let is_beside = |w: &&Wall<'_>| shares_height(w) && w.at.at.is_near_by(&at, near);
        let beside = Beside { walls: walls.iter().filter(is_beside).collect(), near };
        let is_still = |s| matches!(way(s, &beside, b.geo.metres), Ok(None));
        let is_bounded = !at.rings().iter().flat_map(|r| sides(r)).all(is_still);
        is_bounded.then(|| room(b, p, &at, &beside))
    };
    b.model.products.iter().filter(|p| p.class == "IfcSpace").filter_map(one).collect()
}

/// The walls that change beside a room; all else stands.
struct Beside<'w, 'b> {
    walls: Vec<&'w Wall<'b>>,
    /// What is this near to a wall lies on it, file units.
    near: f64,
}

impl Walls for Beside<'_, '_> {
    fn way(&self, at: DVec2, along: DVec2) -> Option<Way> {
        let is_on =
            |w: &&&Wall<'_>| w.at.at.distance(at) <= self.near && w.at.at.has_face_along(along, PARALLEL_SIN);
        let way = self.walls.iter().filter(is_on).find_map(|w| w.way(along, at, self.near));
        Some(way.unwrap_or_default())
    }
}

/// What a room covers as drawn and afterwards, in the world's plan: each ring, the outer one first.
type Grounds = Vec<[Vec<DVec2>; 2]>;

/// A place this near to a corner of a room is that corner, metres.
const AT_CORNER_M: f64 = 1e-6;

/// A point of a room's body this near to its outline stands on it, metres.
const ON_OUTLINE_M: f64 = 1e-3;

fn room(b: &Building<'_, '_>, p: &Product, at: &Footprint, walls: &Beside<'_, '_>) -> Room {
    let boundaries = boundaries(b, p.id, &walls.walls);
    let changed = grounds(at, walls, b.geo.metres).and_then(|grounds| {
        let all = [0, 1].map(|k| grounds.iter().flat_map(|g| g[k].iter().copied()).collect::<Vec<_>>());
        let go = |p: DVec2| shift(&grounds, p, b.geo.metres);
        let shape = Reshape { b, go: &go, grounds: [&all[0], &all[1]] }.product(p.id)?;
        Ok((grounds, shape))
    });
    match changed {
        Ok((grounds, shape)) => {
            let (stated, quantities) = quantities(b, p.id, &grounds);
            let outlines = grounds.into_iter().next().unwrap_or_default();
            Room { id: p.id, outlines: Ok(outlines), quantities, boundaries, shape: Some(shape), stated }
        }
        Err(why) => {
            let (stated, quantities) = quantities(b, p.id, &[]);
            Room { id: p.id, outlines: Err(why), quantities, boundaries, shape: None, stated }
        }
    }
}

fn grounds(at: &Footprint, walls: &Beside<'_, '_>, metres: f64) -> Result<Grounds, Why> {
    let mut rings: Vec<&Vec<DVec2>> = at.rings().iter().collect();
    rings.sort_by(|a, b| ring_area(b).abs().total_cmp(&ring_area(a).abs()));
    rings.into_iter().map(|ring| Ok([ring.clone(), followed(ring, walls, metres)?])).collect()
}

/// How a point of a room's body goes: with the side of the outline on which it stands.
fn shift(grounds: &[[Vec<DVec2>; 2]], p: DVec2, metres: f64) -> Result<DVec2, Why> {
    let sides = grounds.iter().flat_map(|[was, now]| sides(was).zip(sides(now)));
    let far = |([a, b], _): &([DVec2; 2], [DVec2; 2])| distance_to_segment(p, [*a, *b]);
    let nearest = sides.min_by(|s, o| far(s).total_cmp(&far(o)));
    let on = nearest.filter(|s| far(s) * metres <= ON_OUTLINE_M);
    let ([a, b], [to_a, to_b]) = on.ok_or("a part of it stands within its outline")?;
    let is_at = |corner: DVec2| p.distance(corner) * metres <= AT_CORNER_M;
    Ok(match (is_at(a), is_at(b)) {
        (true, _) => to_a - a,
        (_, true) => to_b - b,
        _ => (to_a - a).lerp(to_b - b, (p - a).dot(b - a) / (b - a).length_squared()),
    })
}

/// How many of a room's boundaries lie on walls that change.
fn boundaries(b: &Building<'_, '_>, id: u64, walls: &[&Wall<'_>]) -> usize {
    let kinds = ["IFCRELSPACEBOUNDARY", "IFCRELSPACEBOUNDARY1STLEVEL", "IFCRELSPACEBOUNDARY2NDLEVEL"];
    let all = kinds.iter().flat_map(|k| b.step.all(k));
    let is_here = |args: &[Arg]| {
        let of = |at: usize| args.get(at).and_then(Arg::id);
        of(4) == Some(id) && walls.iter().any(|w| of(5) == Some(w.id))
    };
    all.filter(|i| is_here(&b.step.args_of(i))).count()
}

/// The sets of a room with the stated quantities that follow its outline, and the names of those that do not. `grounds`:
/// nothing of a room that stays.
fn quantities(b: &Building<'_, '_>, id: u64, grounds: &[[Vec<DVec2>; 2]]) -> (Vec<Node>, Vec<String>) {
    let depth = reach(b, id).map_or(0.0, |[low, high]| high - low);
    let girth = |ring: &Vec<DVec2>| sides(ring).map(|[p, q]| p.distance(q)).sum::<f64>();
    let area = |ring: &Vec<DVec2>| ring_area(ring).abs();
    // With what stands within it, and without.
    let whole = |of: &dyn Fn(&Vec<DVec2>) -> f64| grounds.first().map(|g| [of(&g[0]), of(&g[1])]);
    let in_all = |of: &dyn Fn(&Vec<DVec2>) -> f64, sign: f64| {
        let sum = |k: usize| grounds.iter().skip(1).map(|g| sign * of(&g[k])).sum::<f64>();
        whole(of).map(|[was, now]| [was + sum(0), now + sum(1)])
    };
    let girths = [whole(&girth), in_all(&girth, 1.0)];
    let areas = [whole(&area), in_all(&area, -1.0)];
    let (mut follow, mut stay) = (Vec::new(), Vec::new());
    for set in b.model.quantity_sets(b.step, id) {
        let mut changes = Vec::new();
        for (at, quantity) in list_of(b, set, 5).unwrap_or_default() {
            let Some(stated) = Stated::of(b, quantity) else { continue };
            let (of, by) = match stated.power {
                1 => (girths, 1.0),
                2 => (areas, 1.0),
                _ => (areas, depth),
            };
            let is_of = |was: f64| is_same(stated.value, was * by, b.geo.metres.powi(stated.power));
            match of.into_iter().flatten().find(|[was, _]| is_of(*was)) {
                Some([was, now]) if !b.model.is_shared_set(set) => {
                    let text = Change::Text(real(stated.value * (now / was)));
                    let changed = Node { id: quantity, changes: vec![(stated.slot, text)] };
                    changes.push((at, Change::Instance(changed)));
                }
                // A length that is no girth is a height.
                None if stated.power == 1 => {}
                _ => stay.push(stated.name),
            }
        }
        follow.extend((!changes.is_empty()).then_some(Node { id: set, changes }));
    }
    (follow, stay)
}

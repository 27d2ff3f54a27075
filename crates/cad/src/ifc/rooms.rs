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

/// A side of a room this near to a wall, or within it, lies on it, metres.
const ON_WALL_M: f64 = 0.02;

/// Sides and faces whose directions differ by a smaller sine are parallel: half a degree.
const PARALLEL_SIN: f64 = 0.01;

/// Places along a side at which it is asked on which wall it lies.
const PLACES: u32 = 40;

/// A side of which less lies on walls that move stays: it ends at their faces.
const STAYS_SHARE: f64 = 0.1;

/// A side of which more lies on them goes with them. Between the two nobody can tell, and the room stays.
const GOES_SHARE: f64 = 0.9;

/// A side that would become shorter than this would be gone, metres.
const SIDE_MIN_M: f64 = 0.05;

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

/// How a place on a wall goes: along the wall where that becomes longer or shorter, and then with the wall.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Way {
    along: DVec2,
    motion: Option<RigidMotion>,
}

impl Way {
    fn of(self, p: DVec2) -> DVec2 {
        let p = p + self.along;
        self.motion.map_or(p, |m| DVec2::from_angle(m.turn_rad).rotate(p) + m.shift)
    }
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
        let beside: Vec<&Wall<'_>> =
            walls.iter().filter(shares_height).filter(|w| w.at.at.is_near_by(&at, near)).collect();
        let is_bounded =
            at.rings().iter().flat_map(|r| sides(r)).any(|s| !matches!(way(s, &beside, near), Ok(None)));
        is_bounded.then(|| room(b, p, &at, &beside))
    };
    b.model.products.iter().filter(|p| p.class == "IfcSpace").filter_map(one).collect()
}

fn sides(ring: &[DVec2]) -> impl Iterator<Item = [DVec2; 2]> + '_ {
    (0..ring.len()).map(|i| [ring[i], ring[(i + 1) % ring.len()]])
}

/// How a side of a room goes; `None` where it stays.
fn way([a, b]: [DVec2; 2], walls: &[&Wall<'_>], near: f64) -> Result<Option<Way>, Why> {
    let Some(along) = (b - a).try_normalize() else { return Ok(None) };
    let beside: Vec<_> = walls.iter().filter(|w| w.at.at.has_face_along(along, PARALLEL_SIN)).collect();
    let mut shares: Vec<(Way, u32)> = Vec::new();
    for k in 0..PLACES {
        let at = a.lerp(b, (f64::from(k) + 0.5) / f64::from(PLACES));
        let mut on = beside.iter().filter(|w| w.at.at.distance(at) <= near);
        let Some(way) = on.find_map(|w| w.way(along, at, near)) else { continue };
        match shares.iter_mut().find(|s| s.0 == way) {
            Some(share) => share.1 += 1,
            None => shares.push((way, 1)),
        }
    }
    let Some((way, most)) = shares.iter().max_by_key(|s| s.1).copied() else { return Ok(None) };
    match f64::from(most) / f64::from(PLACES) {
        share if share >= GOES_SHARE => Ok(Some(way)),
        share if share <= STAYS_SHARE => Ok(None),
        _ => Err("a side of it lies only in part on the wall that moves".into()),
    }
}

/// What a room covers as drawn and afterwards, in the world's plan: each ring, the outer one first.
type Grounds = Vec<[Vec<DVec2>; 2]>;

/// A place this near to a corner of a room is that corner, metres.
const AT_CORNER_M: f64 = 1e-6;

/// Coordinates that differ less are one, metres.
const ROUNDING_M: f64 = 1e-9;

/// A point of a room's body this near to its outline stands on it, metres.
const ON_OUTLINE_M: f64 = 1e-3;

fn room(b: &Building<'_, '_>, p: &Product, at: &Footprint, walls: &[&Wall<'_>]) -> Room {
    let boundaries = boundaries(b, p.id, walls);
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

fn grounds(at: &Footprint, walls: &[&Wall<'_>], metres: f64) -> Result<Grounds, Why> {
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

/// The corners of a room after its sides went.
fn followed(ring: &[DVec2], walls: &[&Wall<'_>], metres: f64) -> Result<Vec<DVec2>, Why> {
    let ways: Vec<Option<Way>> =
        sides(ring).map(|s| way(s, walls, ON_WALL_M / metres)).collect::<Result<_, _>>()?;
    let n = ring.len();
    let go = |i: usize, p: DVec2| ways[i].map_or(p, |w| w.of(p));
    let corner = |i: usize| {
        let before = (i + n - 1) % n;
        let [p, q] = [before, i].map(|k| [go(k, ring[k]), go(k, ring[(k + 1) % n])]);
        if ways[before] == ways[i] {
            return Ok(go(i, ring[i]));
        }
        let ([along, across], between) = ([p[1] - p[0], q[1] - q[0]], q[0] - p[0]);
        let turn = along.perp_dot(across);
        if turn.abs() <= PARALLEL_SIN * along.length() * across.length() {
            return Err("its outline would need one more corner".to_owned());
        }
        Ok(settled(p[0] + along * (between.perp_dot(across) / turn), ring[i], metres))
    };
    let now: Vec<DVec2> = (0..n).map(corner).collect::<Result<_, _>>()?;
    let keeps = |(old, new): ([DVec2; 2], [DVec2; 2])| {
        let (old, new) = (old[1] - old[0], new[1] - new[0]);
        new.length() >= (SIDE_MIN_M / metres).min(old.length()) && old.dot(new) > 0.0
    };
    let are_kept = sides(ring).zip(sides(&now)).all(keeps);
    are_kept.then_some(now).ok_or_else(|| "a side of it would be gone".into())
}

/// A place with what of it is as drawn, but for rounding.
fn settled(p: DVec2, drawn: DVec2, metres: f64) -> DVec2 {
    DVec2::from_array(
        [0, 1].map(|k| if (p[k] - drawn[k]).abs() * metres <= ROUNDING_M { drawn[k] } else { p[k] }),
    )
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

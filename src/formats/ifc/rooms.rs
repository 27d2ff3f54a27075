//! Rooms that a moved wall bounds: each side of a room's outline that lies on such a wall goes with it, and the corners
//! between are where the sides then meet.
//!
//! Certain is a room whose body is one upright extrusion of a rectangle or a closed polyline and that has no other shape. Every other
//! one stays as drawn, with the reason. Areas, volumes and girths that the file states follow where they were those of
//! the outline as drawn; other quantities and the boundaries of the room are named.

use std::collections::BTreeMap;
use std::ops::Range;

use glam::{DAffine3, DVec2, DVec3};

use super::footprint::{Footprint, StandingWall, reach};
use super::geo::Why;
use super::length::{self, Change, Node, list_of};
use super::model::{Product, body_items};
use super::patch::real;
use super::read::Building;
use super::step::Arg;
use super::unseen::Tails;
use crate::plan::drawing::{Edit, RigidMotion};
use crate::plan::floor::ring_area;

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

/// A stated quantity that differs by a smaller share from that of the outline is the outline's.
const SAME_SHARE: f64 = 0.005;

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
    /// Stated quantities that follow: where, and the new value.
    pub stated: Vec<(Range<usize>, String)>,
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
            Edit::Shape { .. } | Edit::Points { .. } => {}
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
        is_bounded.then(|| room(b, p, &beside))
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

/// The instances that say what a room covers.
struct Outline {
    shape: u64,
    body: u64,
    solid: u64,
    profile: u64,
    /// From the plane of the profile to the world.
    to_world: DAffine3,
    /// Its corners in that plane; the last is not the first once more.
    ring: Vec<DVec2>,
    /// Its height, file units.
    depth: f64,
}

fn outline(b: &Building<'_, '_>, p: &Product) -> Result<Outline, Why> {
    let shape = p.shape.ok_or("it has no shape")?;
    let [(_, body)] = list_of(b, shape, 2)?[..] else {
        return Err("it has more than one shape".into());
    };
    let [solid] = body_items(b.step, shape)?[..] else {
        return Err("its body is not one solid".into());
    };
    if b.step.keyword(solid) != "IFCEXTRUDEDAREASOLID" {
        return Err(format!("{} is no plain extrusion", b.geo.named(solid)));
    }
    let args = b.geo.args(solid)?;
    let profile = b.geo.reference(&args, 0, solid)?;
    let position =
        args.get(1).and_then(Arg::id).map_or(Ok(DAffine3::IDENTITY), |at| b.geo.axis_placement(at))?;
    let world = p.placement.map_or(Ok(DAffine3::IDENTITY), |at| b.geo.placement(at))?;
    let up = b.geo.direction(b.geo.reference(&args, 2, solid)?)?;
    if !length::is_plumb(&world) || !length::is_plumb(&position) || up.truncate().length() > PARALLEL_SIN {
        return Err("it does not stand upright".into());
    }
    let mut ring = match &*b.step.keyword(profile) {
        "IFCRECTANGLEPROFILEDEF" => b
            .geo
            .profile(profile)?
            .rings()
            .next()
            .cloned()
            .unwrap_or_default()
            .into_iter()
            .map(DVec2::from)
            .collect(),
        "IFCARBITRARYCLOSEDPROFILEDEF" => {
            let line = b.geo.reference(&b.geo.args(profile)?, 2, profile)?;
            length::line_points(b, line)?.ok_or_else(|| format!("{} is no polyline", b.geo.named(line)))?
        }
        _ => return Err(format!("{} is neither a rectangle nor a polyline", b.geo.named(profile))),
    };
    if ring.len() > 1 && ring[0].distance(ring[ring.len() - 1]) <= length::SAME_PLACE_M / b.geo.metres {
        ring.pop();
    }
    let depth = args.get(3).and_then(Arg::number).ok_or("its body has no height")?;
    Ok(Outline { shape, body, solid, profile, to_world: world * position, ring, depth })
}

impl Outline {
    fn world(&self) -> Vec<DVec2> {
        self.ring.iter().map(|p| self.to_world.transform_point3(p.extend(0.0)).truncate()).collect()
    }

    /// What changes below the space where its corners go to other places of the world.
    fn change(&self, b: &Building<'_, '_>, id: u64, to: &[DVec2]) -> Result<Node, Why> {
        let back = self.to_world.matrix3.transpose();
        let by: Vec<DVec3> = self.world().iter().zip(to).map(|(p, q)| back * (*q - *p).extend(0.0)).collect();
        let profile = if b.step.keyword(self.profile) == "IFCRECTANGLEPROFILEDEF" {
            self.rectangle(b, &by)?
        } else {
            let slot = b.geo.args(self.profile)?.get(2).map(|a| (a.span.clone(), a.id()));
            let (slot, line) = slot.ok_or("its outline is gone")?;
            let line = line.ok_or("its outline is gone")?;
            let again = length::line_points(b, line)?.is_some_and(|all| all.len() > self.ring.len());
            let places = |i: usize| if i == 0 && again { vec![0, self.ring.len()] } else { vec![i] };
            let corners: Vec<Vec<usize>> = (0..self.ring.len()).map(places).collect();
            let line = length::moved_line(b, line, &corners, &by)?;
            Node { id: self.profile, changes: vec![(slot, Change::Instance(line))] }
        };
        let slot = b.geo.args(self.solid)?.first().map(|a| a.span.clone()).ok_or("its outline is gone")?;
        let solid = Node { id: self.solid, changes: vec![(slot, Change::Instance(profile))] };
        let slot = list_of(b, self.body, 3)?.into_iter().next().ok_or("its body is gone")?.0;
        let body = Node { id: self.body, changes: vec![(slot, Change::Instance(solid))] };
        let slot = list_of(b, self.shape, 2)?.into_iter().next().ok_or("its body is gone")?.0;
        let shape = Node { id: self.shape, changes: vec![(slot, Change::Instance(body))] };
        let slot = b.geo.args(id)?.get(6).map(|a| a.span.clone()).ok_or("it has no shape")?;
        Ok(Node { id, changes: vec![(slot, Change::Instance(shape))] })
    }

    /// The rectangle round the corners after their shifts, where they still are one.
    fn rectangle(&self, b: &Building<'_, '_>, by: &[DVec3]) -> Result<Node, Why> {
        let args = b.geo.args(self.profile)?;
        let position = args.get(2).ok_or("its rectangle is incomplete")?;
        let own = position.id().map_or(Ok(DAffine3::IDENTITY), |p| b.geo.axis_placement(p))?;
        let back = own.inverse();
        let extent = |ring: &[DVec2]| {
            let all = ring.iter().map(|p| back.transform_point3(p.extend(0.0)).truncate());
            crate::plan::box_of(all).ok_or("its rectangle has no size")
        };
        let now: Vec<DVec2> = self.ring.iter().zip(by).map(|(p, by)| p + by.truncate()).collect();
        let ([lo, hi], [was_lo, was_hi]) = (extent(&now)?, extent(&self.ring)?);
        let near = length::SAME_PLACE_M / b.geo.metres;
        let is_corner = |p: &DVec2| {
            let q = back.transform_point3(p.extend(0.0)).truncate();
            (0..2).all(|k| (q[k] - lo[k]).abs().min((q[k] - hi[k]).abs()) <= near)
        };
        if !now.iter().all(is_corner) {
            return Err("its outline would be no rectangle any more".into());
        }
        let mut changes = Vec::new();
        for k in 0..2 {
            let grows = (hi - lo)[k] - (was_hi - was_lo)[k];
            if grows.abs() > near {
                let side = args.get(3 + k).ok_or("its rectangle is incomplete")?;
                let was = side.number().ok_or("its rectangle has no size")?;
                changes.push((side.span.clone(), Change::Text(real(was + grows))));
            }
        }
        let shift = own.matrix3 * ((lo + hi) / 2.0 - (was_lo + was_hi) / 2.0).extend(0.0);
        if shift.length() > near {
            let id = position.id().ok_or("its rectangle has no position of its own")?;
            changes.insert(0, (position.span.clone(), Change::Instance(length::moved_axes(b, id, shift)?)));
        }
        Ok(Node { id: self.profile, changes })
    }
}

fn room(b: &Building<'_, '_>, p: &Product, walls: &[&Wall<'_>]) -> Room {
    let boundaries = boundaries(b, p.id, walls);
    let followed = outline(b, p).and_then(|o| {
        let was = o.world();
        let now = followed(&was, walls, b.geo.metres)?;
        let shape = o.change(b, p.id, &now)?;
        Ok(([was, now], o.depth, shape))
    });
    match followed {
        Ok((outlines, depth, shape)) => {
            let (stated, quantities) = quantities(b, p.id, Some((&outlines, depth)));
            Room { id: p.id, outlines: Ok(outlines), quantities, boundaries, shape: Some(shape), stated }
        }
        Err(why) => {
            let (stated, quantities) = quantities(b, p.id, None);
            Room { id: p.id, outlines: Err(why), quantities, boundaries, shape: None, stated }
        }
    }
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
        Ok(p[0] + along * (between.perp_dot(across) / turn))
    };
    let now: Vec<DVec2> = (0..n).map(corner).collect::<Result<_, _>>()?;
    let keeps = |(old, new): ([DVec2; 2], [DVec2; 2])| {
        let (old, new) = (old[1] - old[0], new[1] - new[0]);
        new.length() >= (SIDE_MIN_M / metres).min(old.length()) && old.dot(new) > 0.0
    };
    let are_kept = sides(ring).zip(sides(&now)).all(keeps);
    are_kept.then_some(now).ok_or_else(|| "a side of it would be gone".into())
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

/// The stated quantities of a room that follow its outline, and the names of those that do not.
fn quantities(
    b: &Building<'_, '_>,
    id: u64,
    outlines: Option<(&[Vec<DVec2>; 2], f64)>,
) -> (Vec<(Range<usize>, String)>, Vec<String>) {
    let girth = |ring: &[DVec2]| sides(ring).map(|[p, q]| p.distance(q)).sum::<f64>();
    let area = |ring: &[DVec2]| ring_area(ring).abs();
    let (mut stated, mut stay) = (Vec::new(), Vec::new());
    let sets = b.model.properties.get(&id).into_iter().flatten();
    for quantity in sets.flat_map(|s| b.step.args(*s).get(5).map(Arg::ids).unwrap_or_default()) {
        let args = b.step.args(quantity);
        let power = match &*b.step.keyword(quantity) {
            "IFCQUANTITYLENGTH" => 1,
            "IFCQUANTITYAREA" => 2,
            "IFCQUANTITYVOLUME" => 3,
            _ => continue,
        };
        let Some((value, slot)) = args.get(3).and_then(|a| Some((a.number()?, a.span.clone()))) else {
            continue;
        };
        let name = args.first().and_then(|a| b.step.text(a)).unwrap_or_default();
        let ratio = outlines.and_then(|([was, now], depth)| {
            let of = |ring: &[DVec2]| match power {
                1 => girth(ring),
                2 => area(ring),
                _ => area(ring) * depth,
            };
            is_same(value, of(was), b.geo.metres.powi(power)).then(|| of(now) / of(was))
        });
        match ratio {
            Some(ratio) => stated.push((slot, real(value * ratio))),
            // A length that is no girth is a height.
            None if power > 1 => stay.push(name),
            None => {}
        }
    }
    (stated, stay)
}

/// Whether a stated value is one of the outline's, in units of the file or in metres.
fn is_same(stated: f64, own: f64, metres: f64) -> bool {
    [1.0, metres].iter().any(|unit| (stated - own * unit).abs() <= SAME_SHARE * own * unit)
}

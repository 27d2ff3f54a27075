//! Walls that change their length: which can, and what of the file says how long they are.
//!
//! Certain is a wall whose ground has two long sides along it and whose shape can follow both ends ([`super::reshape`]). Its
//! placement stays, and so do the openings that stand in its frame.

use std::cell::Cell;

use glam::{DAffine3, DVec2};

use super::building::Building;
use super::footprint::Footprint;
use super::geo::{Why, plan_point};
use super::model::body_items;
use super::quantity::{Stated, is_same};
use super::reshape::{Node, Reshape, SLOPE_MIN, is_plumb, is_straight, list_of};
use super::standing::reach;
use super::step::Arg;

/// Directions whose sine is smaller are one.
const SAME_WAY_SIN: f64 = 1e-6;

/// Sides and corners out of line by less are in line, metres.
const IN_LINE_M: f64 = 1e-4;

/// Most cuts through one wall.
const CUTS_MAX: usize = 16;

/// Without an axis a wall is at least this many times as long as thick.
const SLENDER: f64 = 3.0;

/// Ways of both ends by which it is tried whether a wall can change its length, metres.
const TRIED_M: [f64; 2] = [-0.1, 0.2];

/// A wall whose ends can go along its axis.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Bar {
    /// Unit vector from the first end to the second, in the world's plan.
    pub along: DVec2,
    /// Places along it up to where the first end reaches and from where the second does, file units.
    pub inner: [f64; 2],
    /// The corners of both ends in the world's plan, each in the order in which they lie round the outline.
    pub ends: [Vec<DVec2>; 2],
    /// Whether an axis says which of its ends is the first.
    pub has_axis: bool,
    /// How far each end may go into the wall before it passes a point of the shape that stays, file units.
    pub free: [f64; 2],
}

/// Whether a wall can change its length, and how.
pub(super) fn bar(b: &Building<'_, '_>, id: u64) -> Result<Bar, Why> {
    let args = b.geo.args(id)?;
    let shape = args.get(6).and_then(Arg::id).ok_or("it has no shape")?;
    if let Some(whole) = b.model.whole.get(&id).filter(|whole| b.model.is_part(id) && !is_row(b, **whole)) {
        return Err(format!(
            "it is a part of {}, of which the rest would not grow with it",
            b.geo.named(*whole)
        ));
    }
    let world = b.geo.placement(args.get(5).and_then(Arg::id).ok_or("it has no placement")?)?;
    let axis = axis(b, shape, &world)?;
    let rings = ground(b, id, shape, &world)?;
    let mut bar = outline(&rings, axis, b.geo.metres)?;
    let by = TRIED_M.map(|way| way / b.geo.metres);
    bar.change(b, id, by)?;
    bar.free = bar.free_ways(b, id, by)?;
    Ok(bar)
}

/// Whether a whole is nothing but several walls.
fn is_row(b: &Building<'_, '_>, whole: u64) -> bool {
    let is_wall = |part: &u64| b.model.product(*part).is_some_and(|p| p.class.starts_with("IfcWall"));
    let has_shape = b.step.args(whole).get(6).and_then(Arg::id).is_some();
    !has_shape && b.model.parts.get(&whole).is_some_and(|parts| parts.iter().all(is_wall))
}

/// What changes its length with a wall: the wall, its parts and its coverings.
pub(super) fn grows(b: &Building<'_, '_>, id: u64) -> Vec<u64> {
    let on = |of: &u64| b.model.coverings.get(of).cloned().unwrap_or_default();
    let mut out: Vec<u64> = std::iter::once(id).chain(b.model.parts_of(id)).collect();
    out.extend(out.clone().iter().flat_map(on));
    let has_shape = |of: &u64| *of == id || b.step.args(*of).get(6).and_then(Arg::id).is_some();
    out.retain(has_shape);
    out
}

/// Stated figures by element.
pub(super) type Figures = Vec<(u64, Vec<String>)>;

/// The lengths, areas and volumes that the file states of what grows with a wall and that another length makes wrong: all
/// but how high and how thick it is. They stay as stated.
pub(super) fn figures(b: &Building<'_, '_>, id: u64) -> Figures {
    let of = |id: u64| {
        let at = Footprint::of(b, id);
        let high = reach(b, id).map(|[low, high]| high - low);
        let stays: Vec<f64> = at.iter().map(Footprint::width).chain(high).collect();
        let long = at.iter().flat_map(Footprint::runs).fold(0.0, f64::max);
        let is_stale = |s: &Stated| {
            let is = |own: f64| is_same(s.value, own, b.geo.metres);
            s.power > 1 || is(long) || !stays.iter().any(|v| is(*v))
        };
        let sets = b.model.quantity_sets(b.step, id).into_iter();
        let all = sets.flat_map(|set| b.step.args(set).get(5).map(Arg::ids).unwrap_or_default());
        let names: Vec<String> =
            all.filter_map(|q| Stated::of(b, q)).filter(is_stale).map(|s| s.name).collect();
        (!names.is_empty()).then_some((id, names))
    };
    grows(b, id).into_iter().filter_map(of).collect()
}

/// From where to where the straight axis of a wall runs, in the world's plan.
fn axis(b: &Building<'_, '_>, shape: u64, world: &DAffine3) -> Result<Option<DVec2>, Why> {
    for (_, representation) in list_of(b, shape, 2)? {
        let name = b.geo.args(representation)?.get(1).and_then(|a| b.step.text(a)).unwrap_or_default();
        let [(_, line)] = list_of(b, representation, 3)?[..] else { continue };
        let Some(points) = b.geo.curve(line, 0).ok().filter(|_| name == "Axis") else { continue };
        let points: Vec<DVec2> = points.into_iter().map(|p| plan_point(world, DVec2::from(p))).collect();
        if let [first, .., last] = points[..]
            && is_straight(&points, IN_LINE_M / b.geo.metres)
        {
            return Ok((last - first).try_normalize());
        }
    }
    Ok(None)
}

/// What a wall covers in the world's plan: the ground of its extrusion, whatever slopes take from it, else its cut half
/// way up.
fn ground(b: &Building<'_, '_>, id: u64, shape: u64, world: &DAffine3) -> Result<Vec<Vec<DVec2>>, Why> {
    let items = body_items(b.step, shape)?;
    if let [item] = items[..]
        && let Some(solid) = under_slopes(b, item, world)?
    {
        let args = b.geo.args(solid)?;
        let position = args.get(1).and_then(Arg::id);
        let frame = *world * position.map_or(Ok(DAffine3::IDENTITY), |p| b.geo.axis_placement(p))?;
        if is_plumb(&frame) {
            let profile = b.geo.profile(b.geo.reference(&args, 0, solid)?)?;
            let of =
                |ring: &Vec<[f64; 2]>| ring.iter().map(|p| plan_point(&frame, DVec2::from(*p))).collect();
            return Ok(profile.rings().map(of).collect());
        }
    }
    Footprint::of(b, id).map(Footprint::into_rings).ok_or_else(|| "its body cannot be read".into())
}

/// The extrusion that nothing but slopes are taken from.
fn under_slopes(b: &Building<'_, '_>, item: u64, world: &DAffine3) -> Result<Option<u64>, Why> {
    let mut at = item;
    for _ in 0..CUTS_MAX {
        match &*b.step.keyword(at) {
            "IFCEXTRUDEDAREASOLID" => return Ok(Some(at)),
            "IFCBOOLEANCLIPPINGRESULT" | "IFCBOOLEANRESULT" => {
                let args = b.geo.args(at)?;
                let tool = b.geo.reference(&args, 2, at)?;
                if !args.first().is_some_and(|op| op.is("DIFFERENCE")) || !is_slope(b, tool, world)? {
                    return Ok(None);
                }
                at = b.geo.reference(&args, 1, at)?;
            }
            _ => return Ok(None),
        }
    }
    Ok(None)
}

/// Whether what cuts a wall is a plane that is far from upright.
fn is_slope(b: &Building<'_, '_>, tool: u64, world: &DAffine3) -> Result<bool, Why> {
    if !matches!(&*b.step.keyword(tool), "IFCHALFSPACESOLID" | "IFCPOLYGONALBOUNDEDHALFSPACE") {
        return Ok(false);
    }
    let plane = b.geo.reference(&b.geo.args(tool)?, 0, tool)?;
    if b.step.keyword(plane) != "IFCPLANE" {
        return Ok(false);
    }
    let at = *world * b.geo.axis_placement(b.geo.reference(&b.geo.args(plane)?, 0, plane)?)?;
    Ok(at.matrix3.z_axis.normalize_or_zero().z.abs() > SLOPE_MIN)
}

/// The ends of what a wall covers. `axis`: from its first end to its second.
fn outline(rings: &[Vec<DVec2>], axis: Option<DVec2>, metres: f64) -> Result<Bar, Why> {
    let near = IN_LINE_M / metres;
    let rings: Vec<Vec<DVec2>> = rings.iter().map(|r| cornered(r, near)).filter(|r| r.len() > 3).collect();
    let along = axis.or_else(|| rings.iter().filter_map(|r| longest_side(r)).max_by(longer));
    let along = along.and_then(DVec2::try_normalize).ok_or("its outline has no size")?;
    let place = |p: &DVec2| p.dot(along);
    let least = |r: &&Vec<DVec2>| r.iter().map(place).fold(f64::INFINITY, f64::min);
    let most = |r: &&Vec<DVec2>| r.iter().map(place).fold(f64::NEG_INFINITY, f64::max);
    let lowest = rings.iter().min_by(|a, b| least(a).total_cmp(&least(b)));
    let highest = rings.iter().max_by(|a, b| most(a).total_cmp(&most(b)));
    let of = |ring: Option<&Vec<DVec2>>, end: usize| {
        let ring = ring.ok_or("its outline has no size")?;
        let ends = sides(ring, along, near).ok_or("it has no two sides along it")?;
        Ok::<Vec<DVec2>, Why>(ends[end].iter().map(|i| ring[*i]).collect())
    };
    let ends = [of(lowest, 0)?, of(highest, 1)?];
    let top = ends[0].iter().map(place).fold(f64::NEG_INFINITY, f64::max);
    let low = ends[1].iter().map(place).fold(f64::INFINITY, f64::min);
    if low - top <= near || axis.is_none() && !is_slender(&rings.concat(), along) {
        return Err("it is too short to tell its ends from its sides".into());
    }
    Ok(Bar { along, inner: [top, low], ends, has_axis: axis.is_some(), free: [f64::INFINITY; 2] })
}

fn longer(a: &DVec2, b: &DVec2) -> std::cmp::Ordering {
    a.length().total_cmp(&b.length())
}

/// A ring without the corners at which it does not turn.
fn cornered(ring: &[DVec2], near: f64) -> Vec<DVec2> {
    let mut out: Vec<DVec2> = Vec::new();
    for p in ring.iter().filter(|p| p.is_finite()) {
        if out.last().is_none_or(|last| last.distance(*p) > near) {
            out.push(*p);
        }
    }
    while out.len() > 1 && out[0].distance(out[out.len() - 1]) <= near {
        out.pop();
    }
    let n = out.len();
    let turns = |i: &usize| {
        let [a, p, b] = [out[(i + n - 1) % n], out[*i], out[(i + 1) % n]];
        let along = (b - a).normalize_or_zero();
        along.perp_dot(p - a).abs() > near || (p - a).dot(b - p) <= 0.0
    };
    (0..n).filter(turns).map(|i| out[i]).collect()
}

fn longest_side(ring: &[DVec2]) -> Option<DVec2> {
    (0..ring.len()).map(|i| ring[(i + 1) % ring.len()] - ring[i]).max_by(longer)
}

fn is_slender(ring: &[DVec2], along: DVec2) -> bool {
    let size = |d: DVec2| {
        let places = ring.iter().map(|p| p.dot(d));
        let (lo, hi) = places.fold((f64::INFINITY, f64::NEG_INFINITY), |s, v| (s.0.min(v), s.1.max(v)));
        hi - lo
    };
    size(along) >= SLENDER * size(along.perp())
}

/// The corners of both ends: what is left of a ring without its two longest sides, which run along the wall.
fn sides(ring: &[DVec2], along: DVec2, near: f64) -> Option<[Vec<usize>; 2]> {
    let n = ring.len();
    let run = |i: usize| ring[(i + 1) % n] - ring[i];
    let is_along = |i: &usize| run(*i).perp_dot(along).abs() <= (SAME_WAY_SIN * run(*i).length()).max(near);
    let mut long: Vec<usize> = (0..n).filter(is_along).collect();
    long.sort_by(|i, j| run(*j).length().total_cmp(&run(*i).length()).then(i.cmp(j)));
    let [i, j] = long.get(..2)?.try_into().ok()?;
    let (out, back) = if run(i).dot(along) > 0.0 { (i, j) } else { (j, i) };
    if run(out).dot(along) <= near || run(back).dot(along) >= -near {
        return None;
    }
    let chain = |from: usize, to: usize| -> Vec<usize> {
        let len = (to + n - from) % n + 1;
        (0..len).map(|k| (from + k) % n).collect()
    };
    Some([chain((back + 1) % n, out), chain((out + 1) % n, back)])
}

impl Bar {
    /// The end that a point is at.
    fn end_of(&self, p: DVec2, near: f64) -> Option<usize> {
        match p.dot(self.along) {
            at if at <= self.inner[0] + near => Some(0),
            at if at >= self.inner[1] - near => Some(1),
            _ => None,
        }
    }

    /// Whether its ends can go `by` along it, file units, and pass nothing of the wall that stays.
    pub fn can_go(&self, by: [f64; 2]) -> bool {
        by[0] < self.free[0] && -by[1] < self.free[1]
    }

    /// What changes below the wall's instance and those that grow with it where its ends go `by` along it, file units.
    pub fn change(&self, b: &Building<'_, '_>, id: u64, by: [f64; 2]) -> Result<Vec<Node>, Why> {
        if !self.can_go(by) {
            return Err("an end of it would pass a part of its body that stays".into());
        }
        self.reshaped(b, by, &|_| {}, |shape| grows(b, id).into_iter().map(|id| shape.product(id)).collect())
    }

    /// How far each end may go into the wall before it passes a point of its body that stays.
    fn free_ways(&self, b: &Building<'_, '_>, id: u64, by: [f64; 2]) -> Result<[f64; 2], Why> {
        let stays = Cell::new([f64::INFINITY, f64::NEG_INFINITY]);
        let see = |p: DVec2| {
            let at = p.dot(self.along);
            stays.update(|[low, high]| [low.min(at), high.max(at)]);
        };
        self.reshaped(b, by, &see, |shape| shape.body(id))?;
        let [low, high] = stays.get();
        Ok([low - self.inner[0], self.inner[1] - high])
    }

    /// What becomes of shapes where the ends go; `stays` sees the points that do not.
    fn reshaped<T>(
        &self,
        b: &Building<'_, '_>,
        by: [f64; 2],
        stays: &dyn Fn(DVec2),
        of: impl Fn(&Reshape<'_, '_, '_, '_>) -> Result<T, Why>,
    ) -> Result<T, Why> {
        let near = IN_LINE_M / b.geo.metres;
        let grounds = [[0.0; 2], by].map(|by| {
            let end = |k: usize| self.ends[k].iter().map(move |p| *p + self.along * by[k]);
            end(0).chain(end(1)).collect::<Vec<_>>()
        });
        let go = |p: DVec2| {
            let end = self.end_of(p, near);
            if end.is_none() {
                stays(p);
            }
            Ok(end.map_or(DVec2::ZERO, |end| self.along * by[end]))
        };
        of(&Reshape { b, go: &go, grounds: [&grounds[0], &grounds[1]] })
    }
}

//! Bodies cut by a horizontal plane.

use std::collections::HashMap;

use glam::{DAffine3, DVec2, DVec3};

use super::geo::{Geo, UPRIGHT, Why};
use super::limits::{BODY_DEPTH_MAX, BODY_ITEMS_MAX, FACES_MAX};
use super::step::Arg;
use crate::region::{Region, Rule, clip, slice};

/// A half-space without an outline is taken to reach this far, file units times this many metres.
const FAR_M: f64 = 10_000.0;

/// Area beside the square of the size up to which a profile is a line.
const FLAT_MAX: f64 = 1e-9;

/// A cut through a body: what is found, and from where to where the body reaches.
#[derive(Clone, Debug, Default)]
pub(super) struct Cut {
    /// The outlines at the height.
    pub region: Region,
    /// Why a part of the body is missing in it.
    pub missing: Vec<Why>,
}

impl Geo<'_, '_> {
    /// Cuts the items of a shape at height `z` of the frame that `to` leads to.
    pub fn cut_items(&self, items: &[u64], to: &DAffine3, z: f64) -> Cut {
        let mut out = Cut::default();
        for item in items {
            match self.light(*item).and_then(|()| self.cut(*item, to, z, 0)) {
                Ok(region) => out.region = std::mem::take(&mut out.region).combine(&region, Rule::Union),
                Err(why) => out.missing.push(why),
            }
        }
        out
    }

    /// Why an item shows nothing at any height: its profile has no width or no length.
    pub fn without_width(&self, id: u64, depth: usize) -> Option<Why> {
        let of = |id: u64, k: usize| self.step.args(id).get(k).and_then(Arg::id);
        if depth > BODY_DEPTH_MAX {
            return None;
        }
        match &*self.step.keyword(id) {
            "IFCEXTRUDEDAREASOLID" => {
                let profile = of(id, 0)?;
                let why = || format!("{} has no width or no length, expected an area", self.named(profile));
                encloses_nothing(&self.profile(profile).ok()?).then(why)
            }
            "IFCBOOLEANCLIPPINGRESULT" | "IFCBOOLEANRESULT" => self.without_width(of(id, 1)?, depth + 1),
            "IFCMAPPEDITEM" => {
                let shape = of(of(id, 0)?, 1)?;
                let items = self.step.args(shape).get(3).map(Arg::ids).unwrap_or_default();
                items.into_iter().find_map(|item| self.without_width(item, depth + 1))
            }
            _ => None,
        }
    }

    /// Refuses an item that shows too many others.
    fn light(&self, id: u64) -> Result<(), Why> {
        match self.weight(id, 0, &mut HashMap::new()) {
            n if n > BODY_ITEMS_MAX => Err(format!(
                "{} shows {n} items, those that are shown again counted again, expected at most {BODY_ITEMS_MAX}",
                self.named(id)
            )),
            _ => Ok(()),
        }
    }

    /// Items that one shows, as often as it shows them; what holds itself counts once, [`Geo::cut`] names it.
    fn weight(&self, id: u64, depth: usize, known: &mut HashMap<u64, u64>) -> u64 {
        let inner: Vec<u64> = match &*self.step.keyword(id) {
            "IFCBOOLEANCLIPPINGRESULT" | "IFCBOOLEANRESULT" => {
                self.step.args(id).iter().skip(1).take(2).filter_map(Arg::id).collect()
            }
            "IFCMAPPEDITEM" => {
                let of = |id: u64, k: usize| self.step.args(id).get(k).and_then(Arg::id);
                let shape = of(id, 0).and_then(|map| of(map, 1));
                shape.and_then(|s| self.step.args(s).get(3).map(Arg::ids)).unwrap_or_default()
            }
            "IFCCSGSOLID" => self.step.args(id).first().and_then(Arg::id).into_iter().collect(),
            _ => return 1,
        };
        if let Some(weight) = known.get(&id) {
            return *weight;
        }
        known.insert(id, 1);
        if depth > BODY_DEPTH_MAX {
            return 1;
        }
        let sum = inner.into_iter().fold(1u64, |s, i| s.saturating_add(self.weight(i, depth + 1, known)));
        known.insert(id, sum);
        sum
    }

    /// Cuts one representation item.
    pub fn cut(&self, id: u64, to: &DAffine3, z: f64, depth: usize) -> Result<Region, Why> {
        if depth > BODY_DEPTH_MAX {
            return Err(format!(
                "{} is nested deeper than {BODY_DEPTH_MAX} levels, or holds itself",
                self.named(id)
            ));
        }
        let args = self.args(id)?;
        let keyword = self.step.keyword(id);
        match &*keyword {
            "IFCEXTRUDEDAREASOLID" | "IFCEXTRUDEDAREASOLIDTAPERED" => self.extruded(id, &args, to, z),
            "IFCBOOLEANCLIPPINGRESULT" | "IFCBOOLEANRESULT" => {
                let first = self.cut(self.reference(&args, 1, id)?, to, z, depth + 1)?;
                let rule = match args.first() {
                    Some(op) if op.is("UNION") => Rule::Union,
                    Some(op) if op.is("INTERSECTION") => Rule::Intersection,
                    _ => Rule::Difference,
                };
                let second = self.operand(self.reference(&args, 2, id)?, &first, to, z, depth + 1)?;
                Ok(first.combine(&second, rule))
            }
            "IFCMAPPEDITEM" => {
                let source = self.reference(&args, 0, id)?;
                let map = self.args(source)?;
                let origin = self.axis_placement(self.reference(&map, 0, source)?)?;
                let target = self.operator(self.reference(&args, 1, id)?)?;
                let shape = self.reference(&map, 1, source)?;
                let m = *to * target * origin;
                let mut out = Region::default();
                for item in self.args(shape)?.get(3).map(Arg::ids).unwrap_or_default() {
                    out = out.combine(&self.cut(item, &m, z, depth + 1)?, Rule::Union);
                }
                Ok(out)
            }
            "IFCCSGSOLID" => self.cut(self.reference(&args, 0, id)?, to, z, depth + 1),
            "IFCBLOCK" => self.block(id, &args, to, z),
            _ => Ok(slice(&self.faces(id, &keyword, &args, to, [z, z])?, z)),
        }
    }

    fn operand(&self, id: u64, first: &Region, to: &DAffine3, z: f64, depth: usize) -> Result<Region, Why> {
        match &*self.step.keyword(id) {
            "IFCHALFSPACESOLID" | "IFCBOXEDHALFSPACE" => self.half_space(id, first, to, z),
            "IFCPOLYGONALBOUNDEDHALFSPACE" => {
                let half = self.half_space(id, first, to, z)?;
                let args = self.args(id)?;
                let at = *to * self.axis_placement(self.reference(&args, 2, id)?)?;
                let ring = self.ring(self.reference(&args, 3, id)?)?;
                let far = FAR_M / self.metres;
                let prism = prism(&Region::ring(ring), &at, DVec3::Z * 2.0 * far, -far, z);
                Ok(half.combine(&prism, Rule::Intersection))
            }
            _ => self.cut(id, to, z, depth),
        }
    }

    /// The part of the box round `first` that lies in a half-space.
    fn half_space(&self, id: u64, first: &Region, to: &DAffine3, z: f64) -> Result<Region, Why> {
        let args = self.args(id)?;
        let plane = self.reference(&args, 0, id)?;
        if self.step.keyword(plane) != "IFCPLANE" {
            return Err(format!("{} is a surface that is not read", self.named(plane)));
        }
        let of = self.args(plane)?;
        let m = *to * self.axis_placement(self.reference(&of, 0, plane)?)?;
        let away = if args.get(1).is_some_and(|a| a.is("F")) { -1.0 } else { 1.0 };
        let n = m.matrix3.z_axis.normalize_or_zero() * away;
        let d = n.dot(m.translation) - n.z * z;
        if n.truncate().length() < UPRIGHT {
            let Some([lo, hi]) = first.extent().filter(|_| d >= 0.0) else { return Ok(Region::default()) };
            let (lo, hi) = (lo - 1.0 / self.metres, hi + 1.0 / self.metres);
            return Ok(Region::ring(vec![lo.to_array(), [hi.x, lo.y], hi.to_array(), [lo.x, hi.y]]));
        }
        Ok(first.half_plane(n.truncate(), d))
    }

    fn extruded(&self, id: u64, args: &[Arg], to: &DAffine3, z: f64) -> Result<Region, Why> {
        let profile = self.profile(self.reference(args, 0, id)?)?;
        let at = match args.get(1).and_then(Arg::id) {
            Some(position) => *to * self.axis_placement(position)?,
            None => *to,
        };
        let direction = self.direction(self.reference(args, 2, id)?)?;
        let depth = self.depth(id, args)?;
        Ok(prism(&profile, &at, direction * depth, 0.0, z))
    }

    /// How far an extrusion goes.
    fn depth(&self, id: u64, args: &[Arg]) -> Result<f64, Why> {
        let depth = args.get(3).and_then(Arg::number).filter(|d| *d > 0.0);
        depth.ok_or_else(|| format!("{} has no depth", self.named(id)))
    }

    fn block(&self, id: u64, args: &[Arg], to: &DAffine3, z: f64) -> Result<Region, Why> {
        let at = *to * self.axis_placement(self.reference(args, 0, id)?)?;
        let size: Vec<f64> = (1..4).filter_map(|i| args.get(i).and_then(Arg::number)).collect();
        let [x, y, h] = size[..] else { return Err(format!("{} has no size", self.named(id))) };
        let base = Region::ring(vec![[0.0, 0.0], [x, 0.0], [x, y], [0.0, y]]);
        Ok(prism(&base, &at, DVec3::Z * h, 0.0, z))
    }

    /// Plane faces of a body with corners; of one made of loops those that reach between two heights.
    pub(super) fn faces(
        &self,
        id: u64,
        keyword: &str,
        args: &[Arg],
        to: &DAffine3,
        between: [f64; 2],
    ) -> Result<Vec<Vec<Vec<DVec3>>>, Why> {
        let shells: Vec<u64> = match keyword {
            "IFCFACETEDBREP" => args.first().and_then(Arg::id).into_iter().collect(),
            "IFCFACETEDBREPWITHVOIDS" => {
                let outer = args.first().and_then(Arg::id);
                outer.into_iter().chain(args.get(1).map(Arg::ids).unwrap_or_default()).collect()
            }
            "IFCSHELLBASEDSURFACEMODEL" | "IFCFACEBASEDSURFACEMODEL" => {
                args.first().map(Arg::ids).unwrap_or_default()
            }
            "IFCTRIANGULATEDFACESET" => return self.triangles(id, args, to),
            "IFCPOLYGONALFACESET" => return self.polygons(id, args, to),
            _ => return Err(format!("{} is a kind of body that is not read", self.named(id))),
        };
        let (mut out, mut count) = (Vec::new(), 0);
        for shell in shells {
            for face in self.first_ids(shell)? {
                let mut rings: Vec<Vec<DVec3>> = Vec::new();
                for bound in self.first_ids(face)? {
                    let ring = self.first_ids(bound)?.first().copied();
                    let ring = ring.ok_or_else(|| format!("{} is incomplete", self.named(bound)))?;
                    if self.step.keyword(ring) != "IFCPOLYLOOP" {
                        return Err(format!("{} is a kind of edge that is not read", self.named(ring)));
                    }
                    let points =
                        self.first_ids(ring)?.into_iter().map(|p| Ok(to.transform_point3(self.point(p)?)));
                    rings.push(points.collect::<Result<Vec<_>, Why>>()?);
                }
                let heights = || rings.iter().flatten().map(|p| p.z);
                if heights().any(|z| z <= between[1]) && heights().any(|z| z >= between[0]) {
                    out.push(rings);
                }
                count += 1;
                self.count_faces(id, count)?;
            }
        }
        Ok(out)
    }

    fn count_faces(&self, id: u64, count: usize) -> Result<(), Why> {
        if count > FACES_MAX {
            return Err(format!("{} has more than {FACES_MAX} faces", self.named(id)));
        }
        Ok(())
    }

    fn triangles(&self, id: u64, args: &[Arg], to: &DAffine3) -> Result<Vec<Vec<Vec<DVec3>>>, Why> {
        let points = self.moved_list(self.reference(args, 0, id)?, to)?;
        // IFC4 has Normals and Closed before the indices; IFC4 Add2 and later the same.
        let faces = args.get(3).map(Arg::list).unwrap_or_default();
        self.count_faces(id, faces.len())?;
        faces.iter().map(|f| Ok(vec![self.corners(id, f, &points)?])).collect()
    }

    fn polygons(&self, id: u64, args: &[Arg], to: &DAffine3) -> Result<Vec<Vec<Vec<DVec3>>>, Why> {
        let points = self.moved_list(self.reference(args, 0, id)?, to)?;
        let numbers: Vec<f64> = args.get(3).and_then(Arg::numbers).unwrap_or_default();
        let points = if numbers.is_empty() {
            points
        } else {
            let at = |n: &f64| (*n as usize).checked_sub(1).and_then(|i| points.get(i)).copied();
            numbers.iter().filter_map(at).collect()
        };
        let mut out = Vec::new();
        let faces = args.get(2).map(Arg::ids).unwrap_or_default();
        self.count_faces(id, faces.len())?;
        for face in faces {
            let of = self.args(face)?;
            let outer = of.first().map(|f| self.corners(id, f, &points)).transpose()?.unwrap_or_default();
            let holes = of.get(1).map(Arg::list).unwrap_or_default();
            let mut rings = vec![outer];
            for hole in holes {
                rings.push(self.corners(id, hole, &points)?);
            }
            out.push(rings);
        }
        Ok(out)
    }

    fn moved_list(&self, id: u64, to: &DAffine3) -> Result<Vec<DVec3>, Why> {
        Ok(self.point_list(id)?.into_iter().map(|p| to.transform_point3(p)).collect())
    }

    fn corners(&self, id: u64, face: &Arg, points: &[DVec3]) -> Result<Vec<DVec3>, Why> {
        let at = |i: &Arg| {
            let i = i.number().map(|n| n as usize).and_then(|n| n.checked_sub(1));
            i.and_then(|i| points.get(i)).copied()
        };
        let corners: Option<Vec<DVec3>> = face.list().iter().map(at).collect();
        corners.ok_or_else(|| format!("{} names a corner that is not in its list", self.named(id)))
    }
}

/// Whether a region has no area to speak of beside its size.
fn encloses_nothing(region: &Region) -> bool {
    let Some([lo, hi]) = region.extent() else { return true };
    region.area() <= FLAT_MAX * (hi - lo).length_squared()
}

/// A profile drawn along a direction from `start` times it, cut at a height.
fn prism(profile: &Region, at: &DAffine3, along: DVec3, start: f64, z: f64) -> Region {
    let offset = if start == 0.0 { DVec3::ZERO } else { along.normalize_or_zero() * start };
    let base = *at * DAffine3::from_translation(offset);
    let way = at.matrix3 * along;
    let normal = at.matrix3.z_axis.normalize_or_zero();
    let is_flat = normal.truncate().length() < UPRIGHT && way.z != 0.0;
    if is_flat {
        let low = base.translation.z.min(base.translation.z + way.z);
        let high = base.translation.z.max(base.translation.z + way.z);
        if z < low || z > high {
            return Region::default();
        }
        let t = (z - base.translation.z) / way.z;
        let lean =
            if way.truncate().length() < UPRIGHT * way.length() { DVec2::ZERO } else { way.truncate() * t };
        return profile.clone().map(|p| base.transform_point3(p.extend(0.0)).truncate() + lean);
    }
    let mut out = Region::default();
    for shape in &profile.shapes {
        let lift = |by: DVec3| -> Vec<Vec<DVec3>> {
            let of = |r: &Vec<[f64; 2]>| {
                r.iter().map(|p| base.transform_point3(DVec3::new(p[0], p[1], 0.0)) + by).collect()
            };
            shape.iter().map(of).collect()
        };
        let (bottom, top) = (lift(DVec3::ZERO), lift(way));
        let mut faces = vec![bottom.clone(), top.clone()];
        for (low, high) in bottom.iter().zip(&top) {
            for i in 0..low.len() {
                let j = (i + 1) % low.len();
                faces.push(vec![vec![low[i], low[j], high[j], high[i]]]);
            }
        }
        out = out.combine(&slice(&faces, z), Rule::Union);
    }
    out
}

/// The strip round a line: what stands in for a wall whose body cannot be read.
pub(super) fn strip(axis: &[[f64; 2]], left: f64, right: f64) -> Region {
    let mut out = Region::default();
    for pair in axis.windows(2) {
        let [a, b] = [pair[0], pair[1]].map(DVec2::from);
        let Some(u) = (b - a).try_normalize() else { continue };
        let n = u.perp();
        let ring = [a + n * left, b + n * left, b + n * right, a + n * right];
        out = out.combine(&Region::ring(clip(&ring, DVec2::ZERO, 0.0)), Rule::Union);
    }
    out
}

impl Geo<'_, '_> {
    /// The lowest and the highest point of an item.
    pub fn reach(&self, id: u64, to: &DAffine3, depth: usize) -> Result<[f64; 2], Why> {
        if depth > BODY_DEPTH_MAX {
            return Err(format!("{} holds itself", self.named(id)));
        }
        if depth == 0 {
            self.light(id)?;
        }
        let args = self.args(id)?;
        let keyword = self.step.keyword(id);
        let of = |z: &mut dyn Iterator<Item = f64>| {
            z.fold([f64::INFINITY, f64::NEG_INFINITY], |s, z| [s[0].min(z), s[1].max(z)])
        };
        match &*keyword {
            "IFCEXTRUDEDAREASOLID" => {
                let at = match args.get(1).and_then(Arg::id) {
                    Some(position) => *to * self.axis_placement(position)?,
                    None => *to,
                };
                let depth = self.depth(id, &args)?;
                let way = at.matrix3 * (self.direction(self.reference(&args, 2, id)?)? * depth);
                let profile = self.profile(self.reference(&args, 0, id)?)?;
                let low = profile.points().map(|p| at.transform_point3(p.extend(0.0)).z);
                let [lo, hi] = of(&mut low.into_iter());
                Ok([lo.min(lo + way.z), hi.max(hi + way.z)])
            }
            "IFCBOOLEANCLIPPINGRESULT" | "IFCBOOLEANRESULT" => {
                self.reach(self.reference(&args, 1, id)?, to, depth + 1)
            }
            "IFCMAPPEDITEM" => {
                let source = self.reference(&args, 0, id)?;
                let map = self.args(source)?;
                let origin = self.axis_placement(self.reference(&map, 0, source)?)?;
                let m = *to * self.operator(self.reference(&args, 1, id)?)? * origin;
                let items =
                    self.args(self.reference(&map, 1, source)?)?.get(3).map(Arg::ids).unwrap_or_default();
                let parts: Vec<[f64; 2]> =
                    items.into_iter().filter_map(|i| self.reach(i, &m, depth + 1).ok()).collect();
                Ok(of(&mut parts.into_iter().flatten()))
            }
            _ => {
                let faces = self.faces(id, &keyword, &args, to, [f64::NEG_INFINITY, f64::INFINITY])?;
                Ok(of(&mut faces.iter().flatten().flatten().map(|p| p.z)))
            }
        }
    }
}

//! Shapes of which points go elsewhere in plan: the instances that change, or why the shape cannot follow.
//!
//! Certain are bodies of plane faces and of extrusions, curves in plan, and boxes round them. A face of which only some
//! points go must stay parallel to itself, flat or upright: no slope of a roof is bent.

use std::collections::BTreeSet;
use std::ops::Range;

use glam::{DAffine3, DVec2, DVec3};

use super::building::Building;
use super::geo::{UPRIGHT, Why};
use super::limits::BODY_DEPTH_MAX;
use super::model::body_items;
use super::number::real;
use super::step::{Arg, Value};
use crate::plane::box_of;

/// Shifts that differ less are one, metres. A face out of its plane by less is plane.
const SAME_SHIFT_M: f64 = 1e-6;

/// Most points of one shape: more is no wall.
const POINTS_MAX: usize = 20_000;

/// A plane whose normal rises less stands upright.
pub(super) const SLOPE_MIN: f64 = 0.1;

/// A change of one instance: its arguments' spans with what stands there instead.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Node {
    /// The instance.
    pub id: u64,
    /// What changes of it.
    pub changes: Vec<(Range<usize>, Change)>,
}

/// What an argument becomes.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Change {
    /// Another text.
    Text(String),
    /// The same instance, changed.
    Instance(Node),
}

impl Change {
    /// The instance that changes.
    pub fn instance(&self) -> Option<&Node> {
        match self {
            Self::Text(_) => None,
            Self::Instance(node) => Some(node),
        }
    }
}

/// An instance that changes, or none.
type Changed = Result<Option<Node>, Why>;

type Changes = Vec<(Range<usize>, Change)>;

/// Where points of the plan go.
pub(super) struct Reshape<'m, 'b, 's, 'a> {
    /// The building.
    pub b: &'b Building<'s, 'a>,
    /// The shift of a point, both of the world's plan, file units; an error where nobody can tell.
    pub go: &'m dyn Fn(DVec2) -> Result<DVec2, Why>,
    /// What the shape covers as drawn and afterwards, in the world's plan.
    pub grounds: [&'m [DVec2]; 2],
}

/// A node, where anything changes.
fn node(id: u64, changes: Changes) -> Option<Node> {
    (!changes.is_empty()).then_some(Node { id, changes })
}

impl Reshape<'_, '_, '_, '_> {
    /// What changes below a product; an error where its shape cannot follow.
    pub fn product(&self, id: u64) -> Result<Node, Why> {
        let (b, args) = (self.b, self.b.geo.args(id)?);
        let slot = args.get(6).ok_or("it has no shape")?;
        let shape = slot.id().ok_or("it has no shape")?;
        self.aspects_go_along(shape)?;
        let placement = args.get(5).and_then(Arg::id);
        let world = placement.map_or(Ok(DAffine3::IDENTITY), |p| b.geo.placement(p))?;
        let representations = self.each(list_of(b, shape, 2)?, |representation| {
            let items = self.each(list_of(b, representation, 3)?, |item| self.item(item, &world, 0))?;
            Ok(node(representation, items))
        })?;
        let shape = Node { id: shape, changes: representations };
        Ok(Node { id, changes: vec![(slot.span.clone(), Change::Instance(shape))] })
    }

    /// Goes through the points of a product's body alone.
    pub fn body(&self, id: u64) -> Result<(), Why> {
        let args = self.b.geo.args(id)?;
        let shape = args.get(6).and_then(Arg::id).ok_or("it has no shape")?;
        let placement = args.get(5).and_then(Arg::id);
        let world = placement.map_or(Ok(DAffine3::IDENTITY), |p| self.b.geo.placement(p))?;
        body_items(self.b.step, shape)?.into_iter().try_for_each(|item| self.item(item, &world, 0).map(drop))
    }

    /// Refuses a shape of which parts are shown by items of their own.
    fn aspects_go_along(&self, shape: u64) -> Result<(), Why> {
        let Some(aspects) = self.b.model.aspects.get(&shape) else { return Ok(()) };
        let items = |of: u64| Ok::<_, Why>(list_of(self.b, of, 3)?.into_iter().map(|(_, item)| item));
        let mut own = BTreeSet::new();
        for (_, representation) in list_of(self.b, shape, 2)? {
            own.extend(items(representation)?);
        }
        for aspect in aspects {
            if items(*aspect)?.any(|item| !own.contains(&item)) {
                return Err("its shape has aspects of their own".into());
            }
        }
        Ok(())
    }

    /// The changes of some instances at their places.
    fn each(&self, list: Vec<(Range<usize>, u64)>, of: impl Fn(u64) -> Changed) -> Result<Changes, Why> {
        let mut out = Changes::new();
        for (slot, id) in list {
            out.extend(of(id)?.map(|node| (slot, Change::Instance(node))));
        }
        Ok(out)
    }

    /// The change of the instance that one argument names.
    fn child(&self, id: u64, at: usize, of: impl Fn(u64) -> Changed) -> Result<Changes, Why> {
        let args = self.b.geo.args(id)?;
        let child = self.b.geo.reference(&args, at, id)?;
        self.each(vec![(args[at].span.clone(), child)], of)
    }

    fn item(&self, id: u64, to: &DAffine3, depth: usize) -> Changed {
        let geo = &self.b.geo;
        if depth > BODY_DEPTH_MAX {
            return Err(format!("{} holds itself", geo.named(id)));
        }
        match &*self.b.step.keyword(id) {
            "IFCEXTRUDEDAREASOLID" => self.extruded(id, to),
            "IFCBOOLEANCLIPPINGRESULT" | "IFCBOOLEANRESULT" => {
                let mut changes = self.child(id, 1, |first| self.item(first, to, depth + 1))?;
                changes.extend(self.child(id, 2, |tool| self.tool(tool, to, depth + 1))?);
                Ok(node(id, changes))
            }
            "IFCGEOMETRICSET" | "IFCGEOMETRICCURVESET" => {
                let list = list_of(self.b, id, 0)?;
                Ok(node(id, self.each(list, |item| self.item(item, to, depth + 1))?))
            }
            "IFCBOUNDINGBOX" => self.bounds(id, to),
            "IFCCARTESIANPOINT" => self.point(id, to),
            "IFCPOLYLINE"
            | "IFCINDEXEDPOLYCURVE"
            | "IFCCOMPOSITECURVE"
            | "IFCTRIMMEDCURVE"
            | "IFCCIRCLE"
            | "IFCELLIPSE" => self.curve(id, to, depth),
            keyword => self.faces(id, keyword, to),
        }
    }

    /// The shift of a point of a frame, in that frame.
    fn shift(&self, p: DVec3, to: &DAffine3) -> Result<DVec3, Why> {
        let by = (self.go)(to.transform_point3(p).truncate())?;
        Ok(to.matrix3.transpose() * by.extend(0.0))
    }

    fn is_same(&self, a: DVec3, b: DVec3) -> bool {
        (a - b).length() * self.b.geo.metres <= SAME_SHIFT_M
    }

    /// The one shift of several points; `None` where they go by different ways.
    fn one_shift(&self, points: impl Iterator<Item = DVec3>, to: &DAffine3) -> Result<Option<DVec3>, Why> {
        let mut first = None;
        for p in points {
            let by = self.shift(p, to)?;
            if !self.is_same(by, *first.get_or_insert(by)) {
                return Ok(None);
            }
        }
        Ok(first)
    }

    fn point(&self, id: u64, to: &DAffine3) -> Changed {
        let by = self.shift(self.b.geo.point(id)?, to)?;
        self.moved_point(id, by)
    }

    /// A point with the coordinates that differ after a shift.
    fn moved_point(&self, id: u64, by: DVec3) -> Changed {
        let (old, args) = (self.b.geo.point(id)?, self.b.geo.args(id)?);
        Ok(node(id, args.first().map(|row| moved_coordinates(old, row, by)).unwrap_or_default()))
    }

    /// An axis placement, or another instance that names a point first, with that point shifted.
    fn moved_axes(&self, id: u64, by: DVec3) -> Changed {
        Ok(node(id, self.child(id, 0, |point| self.moved_point(point, by))?))
    }

    /// A list of points with those shifted that go.
    fn point_list(&self, id: u64, to: &DAffine3) -> Changed {
        let (points, args) = (self.b.geo.point_list(id)?, self.b.geo.args(id)?);
        let rows = args.first().map(Arg::list).unwrap_or_default();
        let mut changes = Changes::new();
        for (p, row) in points.iter().zip(rows) {
            changes.extend(moved_coordinates(*p, row, self.shift(*p, to)?));
        }
        Ok(node(id, changes))
    }

    fn extruded(&self, id: u64, to: &DAffine3) -> Changed {
        let (geo, args) = (&self.b.geo, self.b.geo.args(id)?);
        let position = args.get(1).and_then(Arg::id);
        let own = position.map_or(Ok(DAffine3::IDENTITY), |p| geo.axis_placement(p))?;
        let frame = *to * own;
        let profile = geo.reference(&args, 0, id)?;
        let depth =
            args.get(3).and_then(Arg::number).ok_or_else(|| format!("{} has no depth", geo.named(id)))?;
        let way = geo.direction(geo.reference(&args, 2, id)?)? * depth;
        let region = geo.profile(profile)?;
        let ground: Vec<DVec3> = region.points().map(|p| p.extend(0.0)).collect();
        let all = ground.iter().flat_map(|p| [*p, *p + way]);
        if let Some(by) = self.one_shift(all, &frame)? {
            let by = own.matrix3 * by;
            return match position {
                _ if by == DVec3::ZERO => Ok(None),
                Some(p) => {
                    let slot = args.get(1).map(|a| a.span.clone()).unwrap_or_default();
                    Ok(node(id, self.each(vec![(slot, p)], |p| self.moved_axes(p, by))?))
                }
                None => Ok(node(id, self.child(id, 0, |p| self.profile(p, &frame))?)),
            };
        }
        for ring in region.rings() {
            let ring: Vec<DVec3> = ring.iter().map(|p| DVec2::from(*p).extend(0.0)).collect();
            for i in 0..ring.len() {
                let [p, q] = [ring[i], ring[(i + 1) % ring.len()]];
                let by = [p, q, q + way, p + way].map(|p| self.shift(p, &frame));
                let [a, b, c, d] = by;
                let (a, b, c, d) = (a?, b?, c?, d?);
                if !self.is_same(a, d) || !self.is_same(b, c) || a.z.abs().max(b.z.abs()) > self.tolerance() {
                    return Err(format!("{} would not stay a plain extrusion", geo.named(id)));
                }
                let side = [(p, a), (q, b), (q + way, c), (p + way, d)];
                self.face(&side.map(|(p, by)| (frame.transform_point3(p), frame.matrix3 * by)), id)?;
            }
        }
        Ok(node(id, self.child(id, 0, |p| self.profile(p, &frame))?))
    }

    fn tolerance(&self) -> f64 {
        SAME_SHIFT_M / self.b.geo.metres
    }

    /// Holds a face to its bounds: its corners in the world, each with its shift.
    fn face(&self, corners: &[(DVec3, DVec3)], of: u64) -> Result<(), Why> {
        let Some((_, first)) = corners.first() else { return Ok(()) };
        if corners.iter().all(|(_, by)| self.is_same(*by, *first)) {
            return Ok(());
        }
        let normal = normal(corners.iter().map(|c| c.0));
        let is_parallel = corners.iter().all(|(_, by)| normal.dot(*by - *first).abs() <= self.tolerance());
        let is_flat = normal.truncate().length() <= FLAT_SIN;
        let is_upright = || {
            let after = corners.iter().map(|(p, by)| (*p + *by).truncate());
            normal.z.abs() <= FLAT_SIN && is_straight(&after.collect::<Vec<_>>(), self.tolerance())
        };
        if is_parallel || is_flat || is_upright() {
            return Ok(());
        }
        Err(format!("{} has a slope that would be bent", self.b.geo.named(of)))
    }

    /// A body of plane faces.
    fn faces(&self, id: u64, keyword: &str, to: &DAffine3) -> Changed {
        let geo = &self.b.geo;
        let args = geo.args(id)?;
        let faces = geo.faces(id, keyword, &args, to, [f64::NEG_INFINITY, f64::INFINITY])?;
        if faces.iter().flatten().map(Vec::len).sum::<usize>() > POINTS_MAX {
            return Err(format!("{} has more than {POINTS_MAX} corners", geo.named(id)));
        }
        for face in &faces {
            let corner = |p: &DVec3| Ok((*p, (self.go)(p.truncate())?.extend(0.0)));
            let corners = face.iter().flatten().map(corner).collect::<Result<Vec<_>, Why>>()?;
            self.face(&corners, id)?;
        }
        match keyword {
            "IFCTRIANGULATEDFACESET" | "IFCPOLYGONALFACESET" => {
                Ok(node(id, self.child(id, 0, |list| self.point_list(list, to))?))
            }
            "IFCFACETEDBREP" => Ok(node(id, self.child(id, 0, |shell| self.shell(shell, to, SHELL_DEPTH))?)),
            "IFCFACETEDBREPWITHVOIDS" => {
                let mut changes = self.child(id, 0, |shell| self.shell(shell, to, SHELL_DEPTH))?;
                changes
                    .extend(self.each(list_of(self.b, id, 1)?, |shell| self.shell(shell, to, SHELL_DEPTH))?);
                Ok(node(id, changes))
            }
            _ => {
                Ok(node(id, self.each(list_of(self.b, id, 0)?, |shell| self.shell(shell, to, SHELL_DEPTH))?))
            }
        }
    }

    /// What lies below a shell: faces, their bounds, loops and points, each named by the first argument of the one before.
    fn shell(&self, id: u64, to: &DAffine3, depth: usize) -> Changed {
        if depth == 0 {
            return self.point(id, to);
        }
        let args = self.b.geo.args(id)?;
        let below = match args.first() {
            Some(one) if one.id().is_some() => self.child(id, 0, |next| self.shell(next, to, depth - 1))?,
            _ => self.each(list_of(self.b, id, 0)?, |next| self.shell(next, to, depth - 1))?,
        };
        Ok(node(id, below))
    }

    /// What is taken from a body: a slope stays, an upright plane goes with the end that it cuts.
    fn tool(&self, id: u64, to: &DAffine3, depth: usize) -> Changed {
        let geo = &self.b.geo;
        let keyword = self.b.step.keyword(id);
        if !matches!(&*keyword, "IFCHALFSPACESOLID" | "IFCPOLYGONALBOUNDEDHALFSPACE") {
            return self.item(id, to, depth);
        }
        let mut changes = self.child(id, 0, |plane| self.plane(plane, to))?;
        if &*keyword == "IFCPOLYGONALBOUNDEDHALFSPACE" {
            let args = geo.args(id)?;
            let frame = *to * geo.axis_placement(geo.reference(&args, 2, id)?)?;
            if !is_plumb(&frame) {
                return Err(format!("{} is bounded askew", geo.named(id)));
            }
            changes.extend(self.child(id, 3, |line| self.curve(line, &frame, depth))?);
        }
        Ok(node(id, changes))
    }

    fn plane(&self, id: u64, to: &DAffine3) -> Changed {
        let geo = &self.b.geo;
        if self.b.step.keyword(id) != "IFCPLANE" {
            return Err(format!("{} is a surface that is not read", geo.named(id)));
        }
        let at = *to * geo.axis_placement(geo.reference(&geo.args(id)?, 0, id)?)?;
        let normal = at.matrix3.z_axis.normalize_or_zero();
        if normal.z.abs() > SLOPE_MIN {
            return Ok(None);
        }
        let on = |p: &&DVec2| (p.extend(at.translation.z) - at.translation).dot(normal).abs() * geo.metres;
        let mut cut = self.grounds[0].iter().filter(|p| on(p) <= ON_PLANE_M).map(|p| p.extend(0.0));
        let world = DAffine3::IDENTITY;
        let first = cut.next().ok_or_else(|| format!("{} stands upright beside it", geo.named(id)))?;
        let by = self.one_shift(std::iter::once(first).chain(cut), &world)?;
        let by = by.ok_or_else(|| format!("{} cuts more than one end", geo.named(id)))?;
        let by = to.matrix3.transpose() * by;
        Ok(node(id, self.child(id, 0, |axes| self.moved_axes(axes, by))?))
    }

    fn profile(&self, id: u64, to: &DAffine3) -> Changed {
        let keyword = self.b.step.keyword(id);
        match &*keyword {
            "IFCARBITRARYCLOSEDPROFILEDEF" => {
                Ok(node(id, self.child(id, 2, |line| self.curve(line, to, 0))?))
            }
            "IFCARBITRARYPROFILEDEFWITHVOIDS" => {
                let mut changes = self.child(id, 2, |line| self.curve(line, to, 0))?;
                changes.extend(self.each(list_of(self.b, id, 3)?, |line| self.curve(line, to, 0))?);
                Ok(node(id, changes))
            }
            "IFCRECTANGLEPROFILEDEF" => self.rectangle(id, to),
            _ => Err(format!("{} cannot become longer", self.b.geo.named(id))),
        }
    }

    /// A rectangle after the shifts of its corners, where it then still is one: it grows on both sides of its middle.
    fn rectangle(&self, id: u64, to: &DAffine3) -> Changed {
        let geo = &self.b.geo;
        let args = geo.args(id)?;
        let position = args.get(2).ok_or("its rectangle is incomplete")?;
        let own = position.id().map_or(Ok(DAffine3::IDENTITY), |p| geo.axis_placement(p))?;
        let size = [3, 4].map(|k| args.get(k).and_then(Arg::number));
        let [Some(x), Some(y)] = size else { return Err("its rectangle has no size".into()) };
        let frame = *to * own;
        let at = |i: f64, j: f64| self.shift(DVec3::new(i * x / 2.0, j * y / 2.0, 0.0), &frame);
        let [a, b, c, d] = [at(-1.0, -1.0)?, at(1.0, -1.0)?, at(1.0, 1.0)?, at(-1.0, 1.0)?];
        let pairs = [[(a.x, d.x), (b.x, c.x)], [(a.y, b.y), (d.y, c.y)]];
        let is_one = |(p, q): &(f64, f64)| (p - q).abs() <= self.tolerance();
        if !pairs.iter().flatten().all(is_one) {
            return Err(format!("{} would be no rectangle any more", geo.named(id)));
        }
        let (mut changes, mut middle) = (Changes::new(), DVec3::ZERO);
        for (k, [(lower, _), (upper, _)]) in pairs.into_iter().enumerate() {
            middle[k] = f64::midpoint(lower, upper);
            let (grows, was) = (upper - lower, size[k].unwrap_or_default());
            if grows.abs() > UPRIGHT * lower.abs().max(upper.abs()) {
                changes.push((args[3 + k].span.clone(), Change::Text(real(was + grows))));
            }
        }
        let by = own.matrix3 * middle;
        if by != DVec3::ZERO {
            let axes =
                position.id().ok_or_else(|| format!("{} has no position of its own", geo.named(id)))?;
            changes.extend(self.each(vec![(position.span.clone(), axes)], |axes| self.moved_axes(axes, by))?);
        }
        Ok(node(id, changes))
    }

    fn curve(&self, id: u64, to: &DAffine3, depth: usize) -> Changed {
        let geo = &self.b.geo;
        if depth > BODY_DEPTH_MAX {
            return Err(format!("{} holds itself", geo.named(id)));
        }
        match &*self.b.step.keyword(id) {
            "IFCPOLYLINE" => Ok(node(id, self.each(list_of(self.b, id, 0)?, |p| self.point(p, to))?)),
            "IFCINDEXEDPOLYCURVE" => self.indexed(id, to),
            "IFCCOMPOSITECURVE" => {
                let segment = |s: u64| Ok(node(s, self.child(s, 2, |line| self.curve(line, to, depth + 1))?));
                Ok(node(id, self.each(list_of(self.b, id, 0)?, segment)?))
            }
            "IFCTRIMMEDCURVE" => self.trimmed(id, to),
            "IFCCIRCLE" | "IFCELLIPSE" => {
                let points = geo.curve(id, depth)?;
                let by = self.one_shift(points.into_iter().map(|p| DVec2::from(p).extend(0.0)), to)?;
                let by = by.ok_or_else(|| format!("{} would be bent", geo.named(id)))?;
                Ok(node(id, self.child(id, 0, |axes| self.moved_axes(axes, by))?))
            }
            _ => Err(format!("{} is a curve that is not read", geo.named(id))),
        }
    }

    /// An indexed curve: the coordinates in its list change. An arc goes as it is or not at all.
    fn indexed(&self, id: u64, to: &DAffine3) -> Changed {
        let geo = &self.b.geo;
        let args = geo.args(id)?;
        let points = geo.point_list(geo.reference(&args, 0, id)?)?;
        for segment in args.get(1).map(Arg::list).unwrap_or_default() {
            let Value::Typed(kind, inner) = &segment.value else { continue };
            let places = inner.first().and_then(Arg::numbers).unwrap_or_default();
            let corners = places.iter().filter_map(|i| points.get((*i as usize).checked_sub(1)?)).copied();
            if kind == "IFCARCINDEX" && self.one_shift(corners, to)?.is_none() {
                return Err(format!("{} has an arc that would be bent", geo.named(id)));
            }
        }
        Ok(node(id, self.child(id, 0, |list| self.point_list(list, to))?))
    }

    /// A piece of a line or an arc. The ends of a line may go along it by different ways.
    fn trimmed(&self, id: u64, to: &DAffine3) -> Changed {
        let geo = &self.b.geo;
        let args = geo.args(id)?;
        let points: Vec<DVec3> = geo.curve(id, 0)?.into_iter().map(|p| DVec2::from(p).extend(0.0)).collect();
        let moved_trim = |trim: &Arg, by: DVec3| {
            let points = trim.list().iter().filter_map(|a| Some((a.span.clone(), a.id()?)));
            self.each(points.collect(), |p| self.moved_point(p, by))
        };
        if let Some(by) = self.one_shift(points.iter().copied(), to)? {
            let mut changes = self.child(id, 0, |basis| match &*self.b.step.keyword(basis) {
                "IFCLINE" => self.moved_axes(basis, by),
                "IFCCIRCLE" | "IFCELLIPSE" => {
                    Ok(node(basis, self.child(basis, 0, |a| self.moved_axes(a, by))?))
                }
                _ => Err(format!("{} is a curve that is not read", geo.named(basis))),
            })?;
            for trim in args.iter().skip(1).take(2) {
                changes.extend(moved_trim(trim, by)?);
            }
            return Ok(node(id, changes));
        }
        let basis = geo.reference(&args, 0, id)?;
        if self.b.step.keyword(basis) != "IFCLINE" {
            return Err(format!("{} is an arc that would be bent", geo.named(id)));
        }
        let vector = geo.args(geo.reference(&geo.args(basis)?, 1, basis)?)?;
        let unit = geo.direction(geo.reference(&vector, 0, basis)?)?;
        let step = vector.get(1).and_then(Arg::number).filter(|v| *v != 0.0).unwrap_or(1.0);
        let mut changes = Changes::new();
        let ends = [points.first(), points.last()];
        for (trim, at) in args.iter().skip(1).zip(ends.into_iter().flatten()) {
            let by = self.shift(*at, to)?;
            if by.cross(unit).length() > self.tolerance() {
                return Err(format!("{} would be turned", geo.named(id)));
            }
            changes.extend(moved_trim(trim, by)?);
            for arg in trim.list() {
                let (Value::Typed(_, inner), Some(was)) = (&arg.value, arg.number()) else { continue };
                let slot = inner.first().map(|a| a.span.clone()).filter(|_| by != DVec3::ZERO);
                changes.extend(slot.map(|s| (s, Change::Text(real(was + by.dot(unit) / step)))));
            }
        }
        Ok(node(id, changes))
    }

    /// A box round the shape goes with what the shape covers.
    fn bounds(&self, id: u64, to: &DAffine3) -> Changed {
        let geo = &self.b.geo;
        let back = to.inverse();
        let of = |ground: &[DVec2]| {
            let own = ground.iter().map(|p| back.transform_point3(p.extend(to.translation.z)).truncate());
            box_of(own).ok_or("its outline has no size")
        };
        let ([was_lo, was_hi], [lo, hi]) = (of(self.grounds[0])?, of(self.grounds[1])?);
        if !is_plumb(to) {
            return Err(format!("{} does not stand upright", geo.named(id)));
        }
        let kept = |by: DVec2| {
            DVec2::from_array(by.to_array().map(|v| if v.abs() <= self.tolerance() { 0.0 } else { v }))
        };
        let (lower, grows) = (kept(lo - was_lo), kept((hi - lo) - (was_hi - was_lo)));
        let args = geo.args(id)?;
        let mut changes = self.child(id, 0, |corner| self.moved_point(corner, lower.extend(0.0)))?;
        for k in (0..2).filter(|k| grows[*k] != 0.0) {
            let side = args.get(1 + k).ok_or("its box is incomplete")?;
            let was = side.number().ok_or("its box has no size")?;
            changes.push((side.span.clone(), Change::Text(real(was + grows[k]))));
        }
        Ok(node(id, changes))
    }
}

/// Levels below a shell: faces, bounds, loops, points.
const SHELL_DEPTH: usize = 4;

/// A face whose normal is this near to upright, as a sine, is flat, and one this near to level stands upright.
const FLAT_SIN: f64 = 1e-4;

/// A corner of the ground this near to a plane is cut by it, metres.
const ON_PLANE_M: f64 = 1e-4;

/// The normal of a polygon, of length 1; 0 of one without area.
fn normal(corners: impl Iterator<Item = DVec3>) -> DVec3 {
    let all: Vec<DVec3> = corners.collect();
    let Some(first) = all.first() else { return DVec3::ZERO };
    let pairs = all.iter().zip(all.iter().cycle().skip(1));
    pairs.map(|(p, q)| (*p - *first).cross(*q - *first)).sum::<DVec3>().normalize_or_zero()
}

/// Whether points lie on one line.
pub(super) fn is_straight(points: &[DVec2], near: f64) -> bool {
    let Some(first) = points.first() else { return true };
    let far = points.iter().map(|p| *p - *first).max_by(|a, b| a.length().total_cmp(&b.length()));
    let along = far.and_then(DVec2::try_normalize).unwrap_or_default();
    points.iter().all(|p| along.perp_dot(*p - *first).abs() <= near)
}

/// Whether a frame stands upright or on its head: a profile lies flat in it, whichever side of it is up.
pub(super) fn is_plumb(m: &DAffine3) -> bool {
    m.matrix3.z_axis.normalize_or_zero().truncate().length() < UPRIGHT
}

/// The instances that the list at one place of the arguments names, each with its span.
pub(super) fn list_of(b: &Building<'_, '_>, id: u64, at: usize) -> Result<Vec<(Range<usize>, u64)>, Why> {
    let args = b.geo.args(id)?;
    let list = args.get(at).map(Arg::list).unwrap_or_default();
    Ok(list.iter().filter_map(|a| Some((a.span.clone(), a.id()?))).collect())
}

/// The coordinates of a list that differ after a shift.
fn moved_coordinates(old: DVec3, row: &Arg, by: DVec3) -> Changes {
    let slots = row.list();
    // A shift across the axis that is as small as rounding leaves does not count.
    let noise = UPRIGHT * by.length();
    let is_moved = |i: &usize| by[*i].abs() > noise;
    let change = |i: usize| (slots[i].span.clone(), Change::Text(real(old[i] + by[i])));
    (0..slots.len().min(3)).filter(is_moved).map(change).collect()
}

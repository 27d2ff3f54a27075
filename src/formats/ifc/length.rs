//! Walls that change their length: which can, and what of the file says how long they are.
//!
//! Certain is a wall whose body is one upright extrusion of a rectangle or a closed polyline with two long sides along
//! the wall, and that has nothing but this body and, if any, a straight axis of two points; either line may be indexed. Roofs
//! and floors may cut it, and a box may be stated round it. Its placement stays, and so do the openings that stand in its frame.

use std::collections::BTreeSet;
use std::ops::Range;

use glam::{DAffine3, DVec2, DVec3};

use super::geo::{UPRIGHT, Why, plan_point};
use super::patch::real;
use super::read::Building;
use super::step::{Arg, Value};

/// Directions whose sine is smaller are one.
const SAME_WAY_SIN: f64 = 1e-6;

/// Places nearer than this are one, metres.
pub(super) const SAME_PLACE_M: f64 = 1e-6;

/// Most cuts through one wall.
const CUTS_MAX: usize = 16;

/// A plane whose normal rises less stands upright.
const SLOPE_MIN: f64 = 0.1;

/// Without an axis a wall is at least this many times as long as thick.
const SLENDER: f64 = 3.0;

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
    pub fn instance(&self) -> Option<u64> {
        match self {
            Self::Text(_) => None,
            Self::Instance(node) => Some(node.id),
        }
    }
}

/// A wall whose ends can go along its axis.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Bar {
    /// Unit vector from the first end to the second, in the world's plan.
    pub along: DVec2,
    /// Places along it up to where the first end reaches and from where the second does, file units.
    pub inner: [f64; 2],
    /// The corners of both ends in the world's plan, each in the order in which they lie round the outline.
    pub ends: [Vec<DVec2>; 2],
    body: Body,
}

/// The instances that say how long a wall is.
#[derive(Clone, Debug, PartialEq)]
struct Body {
    shape: u64,
    body: u64,
    /// What cuts the extrusion, the outermost first.
    cuts: Vec<u64>,
    solid: u64,
    profile: u64,
    /// From the wall's own frame to the profile's plane.
    to_profile: DAffine3,
    /// Corners of each end by their place in the polyline's list; of a rectangle none.
    corners: Option<[Vec<usize>; 2]>,
    /// Representation and polyline of the axis; its first point is at the wall's first end.
    axis: Option<(u64, u64)>,
    /// Representation and box round the wall.
    bounds: Option<(u64, u64)>,
    /// The world's direction along in the wall's own frame.
    along: DVec3,
}

/// Whether a wall can change its length, and how.
pub(super) fn bar(b: &Building<'_, '_>, id: u64) -> Result<Bar, Why> {
    let args = b.geo.args(id)?;
    let shape = args.get(6).and_then(Arg::id).ok_or("it has no shape")?;
    if b.model.parts.contains_key(&id) || b.model.coverings.contains_key(&id) {
        return Err("it has parts or coverings, which would not grow with it".into());
    }
    if let Some(whole) = b.model.whole.get(&id).filter(|_| b.model.is_part(id)) {
        return Err(format!(
            "it is a part of {}, of which the rest would not grow with it",
            b.geo.named(*whole)
        ));
    }
    if b.model.aspects.contains(&shape) {
        return Err("its shape has aspects of their own".into());
    }
    let placement = args.get(5).and_then(Arg::id).ok_or("it has no placement")?;
    let world = b.geo.placement(placement)?;
    let (mut body, mut axis, mut bounds) = (None, None, None);
    for representation in b.geo.args(shape)?.get(2).map(Arg::ids).unwrap_or_default() {
        let of = b.geo.args(representation)?;
        let name = of.get(1).and_then(|a| b.step.text(a)).unwrap_or_default();
        let items = of.get(3).map(Arg::ids).unwrap_or_default();
        match (name.as_str(), items.as_slice()) {
            ("Body", [item]) if body.is_none() => body = Some((representation, *item)),
            ("Axis", [item]) if axis.is_none() => axis = Some((representation, *item)),
            (_, [item]) if bounds.is_none() && b.step.keyword(*item) == "IFCBOUNDINGBOX" => {
                bounds = Some((representation, *item));
            }
            ("Body" | "Axis", [_]) => return Err(format!("it has more than one representation {name:?}")),
            ("Body" | "Axis", items) => {
                return Err(format!("its representation {name:?} has {} items instead of one", items.len()));
            }
            _ => return Err(format!("it has a representation {name:?} beside axis and body")),
        }
    }
    let (body, item) = body.ok_or("it has no body")?;
    let (cuts, solid) = uncut(b, item, &world)?;
    if b.step.keyword(solid) != "IFCEXTRUDEDAREASOLID" {
        return Err(format!("{} is no plain extrusion", b.geo.named(solid)));
    }
    let of = b.geo.args(solid)?;
    let position = of.get(1).and_then(Arg::id).map_or(Ok(DAffine3::IDENTITY), |p| b.geo.axis_placement(p))?;
    let way = b.geo.direction(b.geo.reference(&of, 2, solid)?)?;
    let profile = b.geo.reference(&of, 0, solid)?;
    if !is_plumb(&world) || !is_plumb(&position) || way.truncate().length() > UPRIGHT {
        return Err("it does not stand upright".into());
    }
    let ends = axis.map(|(_, line)| axis_ends(b, line)).transpose()?;
    let outline = outline(b, profile, &position, ends)?;
    let inner_along = position.matrix3 * outline.along.extend(0.0);
    if bounds.is_some() && inner_along.x.abs().min(inner_along.y.abs()) > SAME_WAY_SIN {
        return Err("the box round it stands askew to it".into());
    }
    let m = world * position;
    let along = (m.matrix3 * outline.along.extend(0.0)).truncate();
    let shift = m.translation.truncate().dot(along);
    Ok(Bar {
        along,
        inner: outline.inner.map(|v| v + shift),
        ends: outline.ends.map(|end| end.iter().map(|p| plan_point(&m, *p)).collect()),
        body: Body {
            shape,
            body,
            cuts,
            solid,
            profile,
            to_profile: position.inverse(),
            corners: outline.corners,
            axis,
            bounds,
            along: inner_along,
        },
    })
}

/// The solid that roofs and floors are taken from, and what takes them. A plane that stands upright would cut the end of
/// the wall where that no longer is, and one that is bounded reaches no farther than drawn.
fn uncut(b: &Building<'_, '_>, item: u64, world: &DAffine3) -> Result<(Vec<u64>, u64), Why> {
    let (mut cuts, mut at) = (Vec::new(), item);
    while matches!(&*b.step.keyword(at), "IFCBOOLEANCLIPPINGRESULT" | "IFCBOOLEANRESULT") {
        let args = b.geo.args(at)?;
        let tool = b.geo.reference(&args, 2, at)?;
        if cuts.len() == CUTS_MAX
            || !args.first().is_some_and(|op| op.is("DIFFERENCE"))
            || !is_slope(b, tool, world)?
        {
            return Err(format!("{} cuts it in a way that would not go along", b.geo.named(tool)));
        }
        cuts.push(at);
        at = b.geo.reference(&args, 1, at)?;
    }
    Ok((cuts, at))
}

/// Whether what cuts a wall is a plane without end that is far from upright.
fn is_slope(b: &Building<'_, '_>, tool: u64, world: &DAffine3) -> Result<bool, Why> {
    if b.step.keyword(tool) != "IFCHALFSPACESOLID" {
        return Ok(false);
    }
    let plane = b.geo.reference(&b.geo.args(tool)?, 0, tool)?;
    if b.step.keyword(plane) != "IFCPLANE" {
        return Ok(false);
    }
    let at = *world * b.geo.axis_placement(b.geo.reference(&b.geo.args(plane)?, 0, plane)?)?;
    Ok(at.matrix3.z_axis.normalize_or_zero().z.abs() > SLOPE_MIN)
}

/// Whether a frame stands upright or on its head: a profile lies flat in it, whichever side of it is up.
pub(super) fn is_plumb(m: &DAffine3) -> bool {
    m.matrix3.z_axis.normalize_or_zero().truncate().length() < UPRIGHT
}

/// The two points of a straight axis, in the wall's own frame.
fn axis_ends(b: &Building<'_, '_>, line: u64) -> Result<[DVec2; 2], Why> {
    match line_points(b, line)?.as_deref() {
        Some([p, q]) => Ok([*p, *q]),
        _ => Err(format!("{} is no axis of two points", b.geo.named(line))),
    }
}

/// The points of a polyline or of an indexed curve of straight pieces, one after the other; `None` for another curve.
pub(super) fn line_points(b: &Building<'_, '_>, line: u64) -> Result<Option<Vec<DVec2>>, Why> {
    match &*b.step.keyword(line) {
        "IFCPOLYLINE" => {
            let points = b.geo.first_ids(line)?;
            points
                .into_iter()
                .map(|p| Ok(DVec2::from(b.geo.point2(p)?)))
                .collect::<Result<_, Why>>()
                .map(Some)
        }
        "IFCINDEXEDPOLYCURVE" => {
            let list = b.geo.reference(&b.geo.args(line)?, 0, line)?;
            let points = b.geo.point_list(list)?;
            let Some(order) = straight_order(b, line, points.len())? else { return Ok(None) };
            let at = |i: &usize| points.get(*i).map(|p| p.truncate());
            let all: Option<Vec<DVec2>> = order.iter().map(at).collect();
            all.map(Some)
                .ok_or_else(|| format!("{} names a point that is not in its list", b.geo.named(line)))
        }
        _ => Ok(None),
    }
}

/// The places in its list of the points of an indexed curve, one after the other; `None` where it is not of straight
/// pieces, each from where the one before ends.
fn straight_order(b: &Building<'_, '_>, line: u64, points: usize) -> Result<Option<Vec<usize>>, Why> {
    let args = b.geo.args(line)?;
    let segments = args.get(1).map(Arg::list).unwrap_or_default();
    if segments.is_empty() {
        return Ok(Some((0..points).collect()));
    }
    let mut out: Vec<usize> = Vec::new();
    for segment in segments {
        let Value::Typed(kind, inner) = &segment.value else { return Ok(None) };
        let indices = inner.first().and_then(Arg::numbers).unwrap_or_default();
        let places: Option<Vec<usize>> = indices.iter().map(|i| (*i as usize).checked_sub(1)).collect();
        let Some(places) = places.filter(|_| kind.eq_ignore_ascii_case("IFCLINEINDEX")) else {
            return Ok(None);
        };
        if out.last().is_some_and(|last| places.first() != Some(last)) {
            return Ok(None);
        }
        let skip = usize::from(!out.is_empty());
        out.extend(places.into_iter().skip(skip));
    }
    Ok(Some(out))
}

/// The outline of a wall in the plane of its profile.
struct Outline {
    /// Unit vector from the first end to the second.
    along: DVec2,
    /// Places along it from the plane's zero: as [`Bar::inner`].
    inner: [f64; 2],
    /// The corners of both ends.
    ends: [Vec<DVec2>; 2],
    /// As [`Body::corners`].
    corners: Option<[Vec<usize>; 2]>,
}

fn outline(
    b: &Building<'_, '_>,
    profile: u64,
    position: &DAffine3,
    axis: Option<[DVec2; 2]>,
) -> Result<Outline, Why> {
    let args = b.geo.args(profile)?;
    let keyword = b.step.keyword(profile);
    let ring: Vec<DVec2> = match &*keyword {
        "IFCRECTANGLEPROFILEDEF" => {
            // One end moves the middle, and so the point at which the rectangle lies.
            let point = args.get(2).and_then(Arg::id).and_then(|at| b.geo.args(at).ok()?.first()?.id());
            point.ok_or_else(|| format!("{} has no position of its own", b.geo.named(profile)))?;
            let ring = b.geo.profile(profile)?.rings().next().cloned().unwrap_or_default();
            ring.into_iter().map(DVec2::from).collect()
        }
        "IFCARBITRARYCLOSEDPROFILEDEF" => {
            let line = b.geo.reference(&args, 2, profile)?;
            line_points(b, line)?.ok_or_else(|| format!("{} is no polyline", b.geo.named(line)))?
        }
        _ => return Err(format!("{} is neither a rectangle nor a polyline", b.geo.named(profile))),
    };
    let is_rectangle = &*keyword == "IFCRECTANGLEPROFILEDEF";
    let near = SAME_PLACE_M / b.geo.metres;
    let is_closed = ring.len() > 1 && ring[0].distance(ring[ring.len() - 1]) <= near;
    let corners = if is_closed { &ring[..ring.len() - 1] } else { &ring[..] };
    if corners.len() < 4 || !is_rectangle && !is_closed {
        return Err(format!("{} is not closed", b.geo.named(profile)));
    }
    let along = match axis {
        Some([p, q]) => {
            let back = position.matrix3.transpose() * (q - p).extend(0.0);
            back.truncate().try_normalize().ok_or("its axis has no length")?
        }
        None => longest_side(corners).ok_or("its outline has no size")?,
    };
    let [first, second] = sides(corners, along, near)
        .ok_or_else(|| format!("{} has no two sides along the wall", b.geo.named(profile)))?;
    let place = |i: &usize| corners[*i].dot(along);
    let top = first.iter().map(place).fold(f64::NEG_INFINITY, f64::max);
    let low = second.iter().map(place).fold(f64::INFINITY, f64::min);
    if low - top <= near || axis.is_none() && !is_slender(corners, along) {
        return Err(format!("{} is too short to tell its ends from its sides", b.geo.named(profile)));
    }
    // The polyline states its first corner once more at its end.
    let again = |list: Vec<usize>| -> Vec<usize> {
        let closing = (is_closed && list.contains(&0)).then_some(corners.len());
        list.into_iter().chain(closing).collect()
    };
    let ends = [&first, &second].map(|list| list.iter().map(|i| corners[*i]).collect());
    let corners = (!is_rectangle).then(|| [again(first), again(second)]);
    Ok(Outline { along, inner: [top, low], ends, corners })
}

fn longest_side(ring: &[DVec2]) -> Option<DVec2> {
    let side = |i: usize| ring[(i + 1) % ring.len()] - ring[i];
    let longest = (0..ring.len()).map(side).max_by(|a, b| a.length().total_cmp(&b.length()))?;
    longest.try_normalize()
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
    /// Whether an axis says which of its ends is the first.
    pub fn has_axis(&self) -> bool {
        self.body.axis.is_some()
    }

    /// What changes below the wall's instance where its ends go `by` along it, file units.
    pub fn change(&self, b: &Building<'_, '_>, id: u64, by: [f64; 2]) -> Result<Node, Why> {
        let own = &self.body;
        let mut shape = Vec::new();
        for (i, representation) in list_of(b, own.shape, 2)? {
            if representation == own.body {
                shape.push((i, Change::Instance(self.body_change(b, by)?)));
            } else if let Some((axis, line)) = own.axis.filter(|a| a.0 == representation) {
                let shift = [0, 1].map(|k| own.along * by[k]);
                let line = moved_line(b, line, &[vec![0], vec![1]], &shift)?;
                let slot = list_of(b, axis, 3)?.into_iter().next().ok_or("its axis is gone")?.0;
                let node = Node { id: axis, changes: vec![(slot, Change::Instance(line))] };
                shape.push((i, Change::Instance(node)));
            } else if let Some((box_of, item)) = own.bounds.filter(|a| a.0 == representation) {
                let slot = list_of(b, box_of, 3)?.into_iter().next().ok_or("its box is gone")?.0;
                let node = Node {
                    id: box_of,
                    changes: vec![(slot, Change::Instance(self.bounds_change(b, item, by)?))],
                };
                shape.push((i, Change::Instance(node)));
            }
        }
        let slot = b.geo.args(id)?.get(6).map(|a| a.span.clone()).ok_or("it has no shape")?;
        let shape = Node { id: own.shape, changes: shape };
        Ok(Node { id, changes: vec![(slot, Change::Instance(shape))] })
    }

    fn body_change(&self, b: &Building<'_, '_>, by: [f64; 2]) -> Result<Node, Why> {
        let own = &self.body;
        let inner = by.map(|v| own.to_profile.matrix3 * own.along * v);
        let profile = match &own.corners {
            Some(corners) => {
                let line = b.geo.args(own.profile)?;
                let slot = line.get(2).ok_or("its outline is gone")?;
                let id = slot.id().ok_or("its outline is gone")?;
                let line = moved_line(b, id, corners, &inner)?;
                Node { id: own.profile, changes: vec![(slot.span.clone(), Change::Instance(line))] }
            }
            None => self.rectangle_change(b, by, (inner[0] + inner[1]) / 2.0)?,
        };
        let slot = b.geo.args(own.solid)?.first().map(|a| a.span.clone()).ok_or("its outline is gone")?;
        let mut solid = Node { id: own.solid, changes: vec![(slot, Change::Instance(profile))] };
        for cut in own.cuts.iter().rev() {
            let slot = b.geo.args(*cut)?.get(1).map(|a| a.span.clone()).ok_or("its body is gone")?;
            solid = Node { id: *cut, changes: vec![(slot, Change::Instance(solid))] };
        }
        let slot = list_of(b, own.body, 3)?.into_iter().next().ok_or("its body is gone")?.0;
        Ok(Node { id: own.body, changes: vec![(slot, Change::Instance(solid))] })
    }

    /// The box grows where the wall does.
    fn bounds_change(&self, b: &Building<'_, '_>, item: u64, by: [f64; 2]) -> Result<Node, Why> {
        let along = self.body.along;
        let axis = if along.x.abs() > along.y.abs() { 0 } else { 1 };
        // How far the lower side of the box goes, and by how much it grows.
        let lower = if along[axis] > 0.0 { by[0] } else { -by[1] };
        let args = b.geo.args(item)?;
        let side = args.get(1 + axis).ok_or("its box is incomplete")?;
        let length = side.number().ok_or("its box has no size")? + by[1] - by[0];
        let mut changes = vec![(side.span.clone(), Change::Text(real(length)))];
        if lower != 0.0 {
            let corner = args.first().ok_or("its box is incomplete")?;
            let point = corner.id().ok_or("its box has no corner")?;
            let mut shift = DVec3::ZERO;
            shift[axis] = lower;
            changes.insert(0, (corner.span.clone(), Change::Instance(moved_point(b, point, shift)?)));
        }
        Ok(Node { id: item, changes })
    }

    /// A rectangle grows on both sides of its middle, so that goes half the way.
    fn rectangle_change(&self, b: &Building<'_, '_>, by: [f64; 2], middle: DVec3) -> Result<Node, Why> {
        let profile = self.body.profile;
        let args = b.geo.args(profile)?;
        let position = args.get(2).ok_or("its rectangle is incomplete")?;
        let own = position.id().map_or(Ok(DAffine3::IDENTITY), |p| b.geo.axis_placement(p))?;
        let along = (self.body.to_profile.matrix3 * self.body.along).truncate();
        let is_x = own.matrix3.x_axis.truncate().dot(along).abs() > 0.5;
        let side = args.get(if is_x { 3 } else { 4 }).ok_or("its rectangle is incomplete")?;
        let length = side.number().ok_or("its rectangle has no size")? + by[1] - by[0];
        let mut changes = vec![(side.span.clone(), Change::Text(real(length)))];
        let shift = middle.truncate();
        if shift != DVec2::ZERO {
            let id = position.id().ok_or("its rectangle has no position of its own")?;
            let node = moved_axes(b, id, shift.extend(0.0))?;
            changes.push((position.span.clone(), Change::Instance(node)));
        }
        Ok(Node { id: profile, changes })
    }
}

/// The instances that the list at one place of the arguments names, each with its span.
pub(super) fn list_of(b: &Building<'_, '_>, id: u64, at: usize) -> Result<Vec<(Range<usize>, u64)>, Why> {
    let args = b.geo.args(id)?;
    let list = args.get(at).map(Arg::list).unwrap_or_default();
    Ok(list.iter().filter_map(|a| Some((a.span.clone(), a.id()?))).collect())
}

/// A polyline or indexed curve with groups of its corners shifted, each by its own way.
pub(super) fn moved_line(
    b: &Building<'_, '_>,
    line: u64,
    corners: &[Vec<usize>],
    by: &[DVec3],
) -> Result<Node, Why> {
    if b.step.keyword(line) == "IFCINDEXEDPOLYCURVE" {
        return moved_indexed(b, line, corners, by);
    }
    let list = list_of(b, line, 0)?;
    let mut out = Vec::new();
    for (places, by) in corners.iter().zip(by) {
        for corner in places.iter().filter(|_| *by != DVec3::ZERO) {
            let (slot, point) = list.get(*corner).ok_or("a corner of its outline is gone")?;
            out.push((slot.clone(), Change::Instance(moved_point(b, *point, *by)?)));
        }
    }
    Ok(Node { id: line, changes: out })
}

/// The same of an indexed curve: coordinates change in its list of points.
fn moved_indexed(b: &Building<'_, '_>, line: u64, corners: &[Vec<usize>], by: &[DVec3]) -> Result<Node, Why> {
    let gone = || "a corner of its outline is gone";
    let args = b.geo.args(line)?;
    let (slot, id) = args.first().and_then(|a| Some((a.span.clone(), a.id()?))).ok_or_else(gone)?;
    let points = b.geo.point_list(id)?;
    let order = straight_order(b, line, points.len())?.ok_or_else(gone)?;
    let list = b.geo.args(id)?;
    let rows = list.first().map(Arg::list).unwrap_or_default();
    let mut changes: Vec<(Range<usize>, Change)> = Vec::new();
    for (corners, by) in corners.iter().zip(by) {
        // A closed curve names its first point once more.
        let places: BTreeSet<usize> = corners.iter().filter_map(|c| order.get(*c).copied()).collect();
        for place in places {
            let (old, row) = points.get(place).zip(rows.get(place)).ok_or_else(gone)?;
            changes.extend(moved_coordinates(*old, row, *by));
        }
    }
    let node = Node { id, changes };
    Ok(Node { id: line, changes: vec![(slot, Change::Instance(node))] })
}

/// An axis placement with its point shifted.
pub(super) fn moved_axes(b: &Building<'_, '_>, id: u64, by: DVec3) -> Result<Node, Why> {
    let slot = b.geo.args(id)?.first().and_then(|a| Some((a.span.clone(), a.id()?)));
    let (slot, point) = slot.ok_or("its rectangle has no position of its own")?;
    Ok(Node { id, changes: vec![(slot, Change::Instance(moved_point(b, point, by)?))] })
}

/// A point with the coordinates that differ after a shift.
fn moved_point(b: &Building<'_, '_>, id: u64, by: DVec3) -> Result<Node, Why> {
    let old = b.geo.point(id)?;
    let args = b.geo.args(id)?;
    let changes = args.first().map(|row| moved_coordinates(old, row, by)).unwrap_or_default();
    Ok(Node { id, changes })
}

/// The coordinates of a list that differ after a shift.
fn moved_coordinates(old: DVec3, row: &Arg, by: DVec3) -> Vec<(Range<usize>, Change)> {
    let slots = row.list();
    // A shift across the axis as small as rounding leaves it is none.
    let noise = UPRIGHT * by.length();
    let is_moved = |i: &usize| by[*i].abs() > noise;
    let change = |i: usize| (slots[i].span.clone(), Change::Text(real(old[i] + by[i])));
    (0..slots.len().min(3)).filter(is_moved).map(change).collect()
}

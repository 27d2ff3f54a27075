//! How high walls are where works change them.

use std::collections::{BTreeMap, BTreeSet};

use glam::{DAffine3, DVec2, DVec3};

use super::body::Body;
use super::cutter::Cutter;
use super::pieces::Pieces;
use super::soup::Part;
use crate::drawing::Filling;

/// Where something reaches.
#[derive(Clone, Copy, Debug)]
struct Extent {
    lo: DVec3,
    hi: DVec3,
    /// Whether it is cut in the stretch.
    is_cut: bool,
}

impl Extent {
    const NONE: Self = Self { lo: DVec3::INFINITY, hi: DVec3::NEG_INFINITY, is_cut: false };

    fn with(self, p: DVec3) -> Self {
        Self { lo: self.lo.min(p), hi: self.hi.max(p), ..self }
    }

    fn of(points: impl IntoIterator<Item = DVec3>) -> Self {
        points.into_iter().fold(Self::NONE, Self::with)
    }
}

/// The pieces of a mesh that stand in a stretch at the height of the cut, and how high they reach, units of the scene. Of
/// what goes from the floor to the top also what hangs over it there, as the head of a door does.
pub(super) fn is_standing(
    parts: &[Part],
    own: Option<usize>,
    (all, to_box): (&Cutter, DAffine3),
    (cut, near, filling): (f64, f64, Filling),
) -> Option<(BTreeSet<usize>, [f64; 2])> {
    let mut extents: BTreeMap<usize, Extent> = BTreeMap::new();
    let inside = |e: &Extent| (0..2).all(|k| e.lo[k] >= -near && e.hi[k] <= all.size[k] + near);
    let over = |e: &Extent| (0..2).all(|k| e.lo[k] < all.size[k] - near && e.hi[k] > near);
    for part in parts {
        for face in part.faces.iter().filter(|f| own.is_none_or(|own| f.piece == own)) {
            let points = face.corners.map(|v| to_box.transform_point3(part.at(v)));
            let of = Extent::of(points);
            let piece = extents.entry(face.piece).or_insert(Extent::NONE);
            *piece = points.into_iter().fold(*piece, Extent::with);
            piece.is_cut |= over(&of) && of.lo.z <= cut && of.hi.z >= cut;
        }
    }
    let cut: Vec<&Extent> = extents.values().filter(|e| e.is_cut).collect();
    let low = cut.iter().map(|e| e.lo.z).reduce(f64::min)?;
    let high = cut.iter().map(|e| e.hi.z).reduce(f64::max)?;
    let hangs = |e: &Extent| filling == Filling::Gone && inside(e) && e.lo.z < high && e.hi.z > low;
    let met = extents.iter().filter(|(_, e)| e.is_cut || hangs(e)).map(|(piece, _)| *piece);
    Some((met.collect(), [low, high]))
}

/// How high what is nearest to a place and stands at the height of the cut reaches, units of the scene.
pub(super) fn reach(body: &Body<'_>, place: DVec2, cut: f64) -> Option<[f64; 2]> {
    let pieces = Pieces::new(&body.triangles);
    let mut extents = vec![Extent::NONE; pieces.count];
    for triangle in &body.triangles {
        let piece = pieces.of(triangle[0])?;
        extents[piece] = triangle.iter().fold(extents[piece], |e, p| e.with(*p));
    }
    let far = |e: &Extent| place.distance(place.clamp(e.lo.truncate(), e.hi.truncate()));
    let standing = extents.iter().filter(|e| e.lo.z < cut && e.hi.z > cut);
    let nearest = standing.min_by(|a, b| far(a).total_cmp(&far(b)))?;
    Some([nearest.lo.z, nearest.hi.z])
}

/// The part of some heights about that of the cut that no wall takes at a place: below the head of the door that was there.
pub(super) fn clear<'b>(
    walls: impl Iterator<Item = &'b Body<'b>>,
    place: DVec2,
    (heights, cut): ([f64; 2], f64),
) -> [f64; 2] {
    let [mut low, mut high] = heights;
    let faces = walls.filter(|b| b.low < heights[1] && b.high > heights[0]).flat_map(|b| &b.triangles);
    for z in faces.filter_map(|t| above(t, place)) {
        if z > cut {
            high = high.min(z);
        } else {
            low = low.max(z);
        }
    }
    [low, high]
}

/// The height of a face over a place.
fn above(triangle: &[DVec3; 3], place: DVec2) -> Option<f64> {
    let [a, b, c] = *triangle;
    let area = |p: DVec2, q: DVec2, r: DVec2| (q - p).perp_dot(r - p);
    let [p, q, r] = triangle.map(|p| p.truncate());
    let whole = area(p, q, r);
    let shares = [area(q, r, place), area(r, p, place), area(p, q, place)].map(|s| s / whole);
    let is_over = whole != 0.0 && shares.iter().all(|s| *s >= 0.0);
    is_over.then(|| shares[0] * a.z + shares[1] * b.z + shares[2] * c.z)
}

//! Polygons with holes, metres: area, distance, what they have in common.

use enfilade_cad::plane::{box_of, distance_to_segment, is_inside_ring, ring_area};
use glam::DVec2;
use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::float::simplify::SimplifyShape;
use i_overlay::float::single::SingleFloatOverlay;
use i_overlay::mesh::float::outline::offset::OutlineOffset;
use i_overlay::mesh::float::style::{LineJoin, OutlineStyle};

/// A closed outline without a repeated point.
pub(crate) type Ring = Vec<DVec2>;

/// Some floor: shapes with an outline each, anticlockwise, and its holes, clockwise.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Polygon {
    shapes: Vec<Vec<Ring>>,
}

/// Corners nearer than this to the line of their neighbours are left out, metres: what rounding to micrometres leaves.
const STRAIGHT_M: f64 = 2e-6;

/// Length of a piece of an arc by its radius: it leaves the arc by a thousandth of the radius.
const ARC: f64 = 0.09;

type Raw = Vec<Vec<Vec<[f64; 2]>>>;

impl Polygon {
    /// An outline with holes, whichever way round; slits without width go.
    pub fn new(outline: &[DVec2], holes: &[Ring]) -> Self {
        let turned = |ring: &[DVec2], is_left: bool| -> Vec<[f64; 2]> {
            let raw = ring.iter().map(|p| p.to_array());
            if (ring_area(ring) > 0.0) == is_left { raw.collect() } else { raw.rev().collect() }
        };
        let rings = std::iter::once(turned(outline, true)).chain(holes.iter().map(|h| turned(h, false)));
        let rings: Vec<Vec<[f64; 2]>> = rings.filter(|r| r.len() > 2).collect();
        Self::of(rings.simplify_shape_as::<i64>(FillRule::NonZero))
    }

    fn of(raw: Raw) -> Self {
        let ring = |r: Vec<[f64; 2]>| straightened(r.into_iter().map(DVec2::from).collect());
        let shape = |rings: Vec<Vec<[f64; 2]>>| -> Vec<Ring> {
            let mut out: Vec<Ring> = rings.into_iter().map(ring).collect();
            for (k, r) in out.iter_mut().enumerate() {
                if (ring_area(r) > 0.0) != (k == 0) {
                    r.reverse();
                }
            }
            out.retain(|r| r.len() > 2);
            out
        };
        let shapes = raw.into_iter().map(shape).filter(|s| !s.is_empty()).collect();
        Self { shapes }
    }

    fn raw(&self) -> Raw {
        let ring = |r: &Ring| r.iter().map(|p| p.to_array()).collect();
        self.shapes.iter().map(|s| s.iter().map(ring).collect()).collect()
    }

    fn combined(&self, other: &Self, rule: OverlayRule) -> Self {
        Self::of(self.raw().overlay_as::<i64>(&other.raw(), rule, FillRule::NonZero))
    }

    /// All of both.
    pub fn with(&self, other: &Self) -> Self {
        self.combined(other, OverlayRule::Union)
    }

    /// What both have.
    pub fn within(&self, other: &Self) -> Self {
        self.combined(other, OverlayRule::Intersect)
    }

    /// All of many.
    pub fn union<'a>(all: impl Iterator<Item = &'a Self>) -> Self {
        let raw: Raw = all.flat_map(Self::raw).collect();
        Self::of(raw.overlay_as::<i64>(&Raw::new(), OverlayRule::Union, FillRule::NonZero))
    }

    /// Where the middle of a disc of this radius can be.
    pub fn inset(&self, radius_m: f64) -> Self {
        let style = OutlineStyle::new(-radius_m).line_join(LineJoin::Round(ARC));
        let parts = self.raw().into_iter().map(|s| Self::of(s.outline_as::<i64>(&style)));
        Self { shapes: parts.flat_map(|p| p.shapes).collect() }
    }

    /// Its outlines and holes.
    pub fn rings(&self) -> impl Iterator<Item = &Ring> + Clone {
        self.shapes.iter().flatten()
    }

    /// Its sides; the inside lies to the left.
    pub fn sides(&self) -> impl Iterator<Item = [DVec2; 2]> + Clone + '_ {
        self.rings().flat_map(|r| (0..r.len()).map(move |i| [r[i], r[(i + 1) % r.len()]]))
    }

    /// Its corners.
    pub fn corners(&self) -> impl Iterator<Item = DVec2> + '_ {
        self.rings().flatten().copied()
    }

    /// Square metres.
    pub fn area_m2(&self) -> f64 {
        self.rings().map(|r| ring_area(r)).sum::<f64>() + 0.0
    }

    /// Whether a point lies inside; on an outline either.
    pub fn holds(&self, p: DVec2) -> bool {
        self.rings().filter(|r| is_inside_ring(r, p)).count() % 2 == 1
    }

    /// Distance from the outlines, positive inside.
    pub fn depth_m(&self, p: DVec2) -> f64 {
        let far = self.sides().map(|s| distance_to_segment(p, s)).fold(f64::INFINITY, f64::min);
        if self.holds(p) { far } else { -far }
    }

    /// Box round it.
    pub fn bounds(&self) -> Option<[DVec2; 2]> {
        box_of(self.corners())
    }

    /// Whether nothing is left.
    pub fn is_empty(&self) -> bool {
        self.shapes.is_empty()
    }

    /// Its separate parts.
    pub fn parts(&self) -> impl Iterator<Item = Self> + '_ {
        self.shapes.iter().map(|s| Self { shapes: vec![s.clone()] })
    }
}

/// A ring without the corners that turn nowhere.
fn straightened(ring: Ring) -> Ring {
    let mut out = ring;
    let mut k = 0;
    while out.len() > 3 && k < out.len() {
        let [a, b, c] = [k + out.len() - 1, k, k + 1].map(|i| out[i % out.len()]);
        // What turns back is an end of a slit, not a straight place.
        let is_idle = distance_to_segment(b, [a, c]) < STRAIGHT_M;
        if is_idle {
            out.remove(k);
        } else {
            k += 1;
        }
    }
    out
}

/// The four corners of a stretch from `a` to `b`, with what lies to its left and to its right, metres.
pub(crate) fn quad([a, b]: [DVec2; 2], [left, right]: [f64; 2]) -> Polygon {
    let across = (b - a).normalize_or_zero().perp();
    Polygon::new(&[a - across * right, b - across * right, b + across * left, a + across * left], &[])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(points: &[[f64; 2]]) -> Ring {
        points.iter().copied().map(DVec2::from).collect()
    }

    #[test]
    fn area_counts_holes_and_slits_go() {
        let square = at(&[[0.0, 0.0], [4.0, 0.0], [4.0, 3.0], [0.0, 3.0]]);
        let column = at(&[[1.0, 1.0], [2.0, 1.0], [2.0, 2.0], [1.0, 2.0]]);
        let floor = Polygon::new(&square, &[column]);
        assert!((floor.area_m2() - 11.0).abs() < 1e-9);
        assert!(floor.holds(DVec2::new(0.5, 0.5)) && !floor.holds(DVec2::new(1.5, 1.5)));
        assert!((floor.depth_m(DVec2::new(0.25, 1.5)) - 0.25).abs() < 1e-12);
        let slit = at(&[[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [2.0, 0.0], [4.0, 0.0], [4.0, 3.0], [0.0, 3.0]]);
        let slit = Polygon::new(&slit, &[]);
        assert!((slit.area_m2() - 12.0).abs() < 1e-9);
        assert_eq!(slit.corners().count(), 4);
    }

    #[test]
    fn a_door_joins_two_rooms() {
        let room = |x: f64| Polygon::new(&at(&[[x, 0.0], [x + 2.0, 0.0], [x + 2.0, 3.0], [x, 3.0]]), &[]);
        let door = quad([DVec2::new(2.05, 1.0), DVec2::new(2.05, 2.0)], [0.08, 0.08]);
        let all = Polygon::union([&room(0.0), &door, &room(2.1)].into_iter());
        assert_eq!(all.parts().count(), 1);
        assert!((all.area_m2() - 12.1).abs() < 1e-7, "{}", all.area_m2());
    }
}

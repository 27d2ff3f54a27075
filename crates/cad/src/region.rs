//! Polygons with holes in the plane, and what clipping does to them.

use glam::{DAffine3, DVec2, DVec3};
use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::float::simplify::SimplifyShape;
use i_overlay::float::single::SingleFloatOverlay;

/// Outlines of one cut: every shape an outer ring and its holes, file units.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Region {
    /// Shapes; rings are not closed by a repeated point.
    pub shapes: Vec<Vec<Vec<[f64; 2]>>>,
    /// Open lines: cuts of surfaces that enclose nothing.
    pub lines: Vec<Vec<[f64; 2]>>,
}

/// How two regions are combined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Rule {
    Union,
    Difference,
    Intersection,
}

/// Vertices that clipping moved by less than this share of the extent are put back where they were drawn.
const SNAP_SHARE: f64 = 1e-8;

/// Coordinates beyond this, and what is no number, are not clipped: such outlines touch nothing. File units; no
/// unit makes a building of it.
const CLIPPED_MAX: f64 = 1e15;

/// Sides along which a box round a region is tried, the longest.
const SIDES_MAX: usize = 64;

/// What takes no more of a wall than this many times the depth looked at is a notch, where walls are fitted together.
const NOTCH_DEPTHS: f64 = 5.0;

/// Share of the depth looked at below which what is left behind a hole is rounding alone.
const SKIN_NOISE: f64 = 1e-3;

impl Region {
    /// One ring.
    pub fn ring(points: Vec<[f64; 2]>) -> Self {
        if points.len() < 3 {
            Self::default()
        } else {
            Self { shapes: vec![vec![points]], lines: Vec::new() }
        }
    }

    /// An outer ring with holes.
    pub fn with_holes(rings: Vec<Vec<[f64; 2]>>) -> Self {
        if rings.first().is_none_or(|r| r.len() < 3) {
            Self::default()
        } else {
            Self { shapes: vec![rings], lines: Vec::new() }
        }
    }

    /// Rings of which those inside others are holes.
    pub fn even_odd(rings: Vec<Vec<[f64; 2]>>) -> Self {
        match rings.len() {
            0 => Self::default(),
            1 => rings.into_iter().next().map(Self::ring).unwrap_or_default(),
            _ if !can_be_clipped(rings.iter()) => {
                Self { shapes: rings.into_iter().map(|r| vec![r]).collect(), lines: Vec::new() }
            }
            _ => {
                let shapes = snapped(rings.simplify_shape_as::<i64>(FillRule::EvenOdd), &[&rings]);
                Self { shapes, lines: Vec::new() }
            }
        }
    }

    /// Whether nothing is in it.
    pub fn is_empty(&self) -> bool {
        self.shapes.is_empty() && self.lines.is_empty()
    }

    /// Whether no coordinate lies beyond all buildings.
    pub fn is_within_reach(&self) -> bool {
        can_be_clipped(self.rings().chain(&self.lines))
    }

    /// All rings.
    pub fn rings(&self) -> impl Iterator<Item = &Vec<[f64; 2]>> {
        self.shapes.iter().flatten()
    }

    /// All points.
    pub fn points(&self) -> impl Iterator<Item = DVec2> {
        self.rings().chain(&self.lines).flatten().map(|p| DVec2::from(*p))
    }

    /// How many points it has.
    pub fn size(&self) -> usize {
        self.rings().chain(&self.lines).map(Vec::len).sum()
    }

    /// Lowest and highest corner of the box round it.
    pub fn extent(&self) -> Option<[DVec2; 2]> {
        crate::plane::box_of(self.points())
    }

    /// Corners of the smallest box round it that lies along one of its sides; none where it has no area.
    pub fn box_along(&self) -> Option<[DVec2; 4]> {
        let ring_sides = |r: &Vec<[f64; 2]>| {
            (0..r.len()).map(|i| DVec2::from(r[(i + 1) % r.len()]) - DVec2::from(r[i])).collect::<Vec<_>>()
        };
        let mut sides: Vec<DVec2> = self.rings().chain(&self.lines).flat_map(ring_sides).collect();
        sides.sort_by(|a, b| b.length_squared().total_cmp(&a.length_squared()));
        // Along its axes first, so that an even choice leaves it straight.
        let ways = std::iter::once(DVec2::X).chain(sides.into_iter().take(SIDES_MAX));
        let mut best: Option<(f64, [DVec2; 4])> = None;
        for u in ways.filter_map(DVec2::try_normalize) {
            let turned = self.points().map(|p| DVec2::new(u.dot(p), u.perp_dot(p)));
            let [lo, hi] = crate::plane::box_of(turned)?;
            let area = (hi - lo).element_product();
            if best.is_none_or(|(least, _)| area < least * (1.0 - SNAP_SHARE)) {
                let corners = [lo, DVec2::new(hi.x, lo.y), hi, DVec2::new(lo.x, hi.y)];
                best = Some((area, corners.map(|c| u * c.x + u.perp() * c.y)));
            }
        }
        best.map(|(_, corners)| corners)
    }

    /// The region through a map of the plane.
    pub fn map(mut self, to: impl Fn(DVec2) -> DVec2) -> Self {
        for ring in self.shapes.iter_mut().flatten().chain(&mut self.lines) {
            for p in ring {
                *p = to(DVec2::from(*p)).to_array();
            }
        }
        self
    }

    /// This region combined with another; open lines of this one stay.
    pub fn combine(self, other: &Self, rule: Rule) -> Self {
        if !self.may_touch(other) {
            return match rule {
                Rule::Difference => self,
                Rule::Intersection => Self::default(),
                Rule::Union => {
                    let mut out = self;
                    out.shapes.extend(other.shapes.iter().cloned());
                    out.lines.extend(other.lines.iter().cloned());
                    out
                }
            };
        }
        let overlay = match rule {
            Rule::Union => OverlayRule::Union,
            Rule::Difference => OverlayRule::Difference,
            Rule::Intersection => OverlayRule::Intersect,
        };
        let (a, b) = (oriented(&self.shapes), oriented(&other.shapes));
        let made = a.overlay_as::<i64>(&b, overlay, FillRule::NonZero);
        let mut lines = self.lines;
        if rule == Rule::Union {
            lines.extend(other.lines.iter().cloned());
        }
        let flat: Vec<Vec<[f64; 2]>> = a.into_iter().chain(b).flatten().collect();
        Self { shapes: snapped(made, &[&flat]), lines }
    }

    /// A hole made to reach through a wall that it leaves a skin of: every side beyond which the wall
    /// ends within `depth` is moved out by that much. What ends beside the hole, such as the last
    /// millimetres of a wall behind its door, stays: it closes nothing. A notch stays as it is, see
    /// [`NOTCH_DEPTHS`].
    pub fn through(&self, wall: &Self, depth: f64) -> Self {
        let mut out = self.clone();
        for ring in self.shapes.iter().filter_map(|s| s.first()) {
            let taken = wall.clone().combine(&Self::ring(ring.clone()), Rule::Intersection);
            let is_notch = |[lo, hi]: [DVec2; 2]| (hi - lo).max_element() <= NOTCH_DEPTHS * depth;
            if taken.extent().is_none_or(is_notch) {
                continue;
            }
            let turn = area2(ring).signum();
            for (i, a) in ring.iter().enumerate() {
                let (a, b) = (DVec2::from(*a), DVec2::from(ring[(i + 1) % ring.len()]));
                let Some(u) = (b - a).try_normalize() else { continue };
                let outward = -u.perp() * turn * depth;
                let strip = |from: f64, to: f64| {
                    let corners =
                        [a + outward * from, b + outward * from, b + outward * to, a + outward * to];
                    Self::ring(corners.map(|p| p.to_array()).to_vec())
                };
                let covered = |s: &Self| wall.clone().combine(s, Rule::Intersection).area();
                let whole = a.distance(b) * depth;
                let skin = covered(&strip(0.0, 1.0)) / whole;
                // A skin thinner than clipping sees shows by the wall inside of the side alone.
                let is_on_the_face = || covered(&strip(-SKIN_NOISE, 0.0)) > 0.5 * SKIN_NOISE * whole;
                if (skin <= 0.0 && !is_on_the_face()) || covered(&strip(1.0, 2.0)) >= 0.05 * whole {
                    continue;
                }
                let beside = |from: DVec2, along: DVec2| {
                    let corners = [from, from + along, from + along + outward, from + outward];
                    covered(&Self::ring(corners.map(|p| p.to_array()).to_vec())) / (depth * depth)
                };
                let goes_on = || beside(a, -u * depth).max(beside(b, u * depth)) > 0.5 * skin;
                if skin < SKIN_NOISE || goes_on() {
                    out = out.combine(&strip(0.0, 1.0), Rule::Union);
                }
            }
        }
        out
    }

    /// Area inside the outlines.
    pub fn area(&self) -> f64 {
        let of = |s: &Vec<Vec<[f64; 2]>>| {
            let mut rings = s.iter().map(|r| area2(r).abs() / 2.0);
            rings.next().unwrap_or(0.0) - rings.sum::<f64>()
        };
        self.shapes.iter().map(of).sum()
    }

    fn may_touch(&self, other: &Self) -> bool {
        let (Some(a), Some(b)) = (self.extent(), other.extent()) else { return false };
        a[0].cmple(b[1]).all()
            && b[0].cmple(a[1]).all()
            && !self.shapes.is_empty()
            && !other.shapes.is_empty()
            && can_be_clipped(self.rings().chain(other.rings()))
    }

    /// Takes away (or keeps) the half-plane `n·p ≤ d`.
    pub fn half_plane(&self, n: DVec2, d: f64) -> Self {
        let Some([lo, hi]) = self.extent() else { return Self::default() };
        let pad = (hi - lo).max_element().max(1e-6);
        let (lo, hi) = (lo - pad, hi + pad);
        let corners = [lo, DVec2::new(hi.x, lo.y), hi, DVec2::new(lo.x, hi.y)];
        Self::ring(clip(&corners, n, d))
    }
}

/// The part of a convex ring with `n·p ≤ d`.
pub(super) fn clip(ring: &[DVec2], n: DVec2, d: f64) -> Vec<[f64; 2]> {
    let mut out = Vec::new();
    for (i, a) in ring.iter().enumerate() {
        let b = ring[(i + 1) % ring.len()];
        let (da, db) = (n.dot(*a) - d, n.dot(b) - d);
        if da <= 0.0 {
            out.push(a.to_array());
        }
        if (da < 0.0 && db > 0.0) || (da > 0.0 && db < 0.0) {
            out.push(a.lerp(b, da / (da - db)).to_array());
        }
    }
    out
}

fn can_be_clipped<'a>(mut rings: impl Iterator<Item = &'a Vec<[f64; 2]>>) -> bool {
    rings.all(|ring| ring.iter().flatten().all(|x| x.abs() <= CLIPPED_MAX))
}

/// Twice the signed area of a ring.
pub(super) fn area2(ring: &[[f64; 2]]) -> f64 {
    let Some(o) = ring.first() else { return 0.0 };
    let local = |p: &[f64; 2]| DVec2::new(p[0] - o[0], p[1] - o[1]);
    (0..ring.len()).map(|i| local(&ring[i]).perp_dot(local(&ring[(i + 1) % ring.len()]))).sum()
}

/// Outer rings anticlockwise, holes clockwise.
fn oriented(shapes: &[Vec<Vec<[f64; 2]>>]) -> Vec<Vec<Vec<[f64; 2]>>> {
    let turn = |(i, ring): (usize, &Vec<[f64; 2]>)| {
        let mut ring = ring.clone();
        if (area2(&ring) > 0.0) != (i == 0) {
            ring.reverse();
        }
        ring
    };
    shapes.iter().map(|s| s.iter().enumerate().map(turn).collect()).collect()
}

/// Puts vertices back on those of the inputs; rings without an area vanish.
fn snapped(mut shapes: Vec<Vec<Vec<[f64; 2]>>>, inputs: &[&Vec<Vec<[f64; 2]>>]) -> Vec<Vec<Vec<[f64; 2]>>> {
    let drawn: Vec<DVec2> = inputs.iter().flat_map(|r| r.iter().flatten()).map(|p| DVec2::from(*p)).collect();
    let Some([lo, hi]) = crate::plane::box_of(drawn.iter().copied()) else { return shapes };
    let near = (hi - lo).max_element() * SNAP_SHARE;
    for p in shapes.iter_mut().flatten().flatten() {
        let at = DVec2::from(*p);
        if let Some(q) = drawn.iter().find(|q| (at - **q).abs().max_element() <= near) {
            *p = q.to_array();
        }
    }
    for shape in &mut shapes {
        shape.iter_mut().for_each(|ring| *ring = without_spikes(ring, near));
    }
    shapes.retain(|s| s.first().is_some_and(|r| area2(r).abs() > near * near));
    shapes.iter_mut().for_each(|s| s.retain(|r| r.len() > 2));
    shapes
}

/// A ring without the tips that putting vertices back has left: there and back along one line.
fn without_spikes(ring: &[[f64; 2]], near: f64) -> Vec<[f64; 2]> {
    let is_tip = |a: [f64; 2], p: [f64; 2], b: [f64; 2]| {
        let (u, v) = (DVec2::from(p) - DVec2::from(a), DVec2::from(b) - DVec2::from(p));
        let long = u.length().max(v.length());
        let short = u.length().min(v.length());
        short <= near || (u.dot(v) < 0.0 && u.perp_dot(v).abs() <= near * long)
    };
    let mut out: Vec<[f64; 2]> = Vec::with_capacity(ring.len());
    for p in ring {
        out.push(*p);
        while let [.., a, tip, b] = out[..]
            && is_tip(a, tip, b)
        {
            out.remove(out.len() - 2);
        }
    }
    while let [first, second, .., before, last] = out[..] {
        if is_tip(before, last, first) {
            out.pop();
        } else if is_tip(last, first, second) {
            out.remove(0);
        } else {
            break;
        }
    }
    out
}

/// The region that plane faces enclose at height `z`: every face a list of rings.
pub(super) fn slice(faces: &[Vec<Vec<DVec3>>], z: f64) -> Region {
    let mut segments = Vec::new();
    for face in faces {
        let mut hits: Vec<DVec2> = Vec::new();
        for ring in face {
            for (i, a) in ring.iter().enumerate() {
                let b = ring[(i + 1) % ring.len()];
                if (a.z > z) != (b.z > z) {
                    hits.push(crossing(*a, b, z));
                }
            }
        }
        let Some([lo, hi]) = crate::plane::box_of(hits.iter().copied()) else { continue };
        let along = if (hi - lo).x > (hi - lo).y { |p: &DVec2| p.x } else { |p: &DVec2| p.y };
        hits.sort_by(|p, q| along(p).total_cmp(&along(q)));
        segments.extend(hits.chunks_exact(2).map(|c| [c[0], c[1]]).filter(|[a, b]| a != b));
    }
    chain(&segments)
}

/// Where an edge crosses a height; the same from either end.
fn crossing(a: DVec3, b: DVec3, z: f64) -> DVec2 {
    let (a, b) = if (a.z, a.x, a.y) < (b.z, b.x, b.y) { (a, b) } else { (b, a) };
    let t = (z - a.z) / (b.z - a.z);
    a.truncate().lerp(b.truncate(), t)
}

/// Joins segments to rings; what does not close stays a line.
fn chain(segments: &[[DVec2; 2]]) -> Region {
    use std::collections::BTreeMap;
    let Some([lo, hi]) = crate::plane::box_of(segments.iter().flatten().copied()) else {
        return Region::default();
    };
    let step = ((hi - lo).max_element() * 1e-6).max(1e-9);
    let mut ids: BTreeMap<[i64; 2], usize> = BTreeMap::new();
    let mut points: Vec<DVec2> = Vec::new();
    let mut node = |p: DVec2| {
        let c = ((p - lo) / step).round();
        let (x, y) = (c.x as i64, c.y as i64);
        for dx in -1..=1 {
            for dy in -1..=1 {
                if let Some(i) = ids.get(&[x + dx, y + dy]) {
                    return *i;
                }
            }
        }
        points.push(p);
        ids.insert([x, y], points.len() - 1);
        points.len() - 1
    };
    let edges: Vec<[usize; 2]> = segments.iter().map(|s| s.map(&mut node)).filter(|e| e[0] != e[1]).collect();
    let mut at: Vec<Vec<usize>> = vec![Vec::new(); points.len()];
    for (i, e) in edges.iter().enumerate() {
        at[e[0]].push(i);
        at[e[1]].push(i);
    }
    let mut used = vec![false; edges.len()];
    let (mut rings, mut lines) = (Vec::new(), Vec::new());
    // Ends of open lines first, so that a line is walked from its end.
    let mut starts: Vec<usize> = (0..points.len()).filter(|n| at[*n].len() % 2 == 1).collect();
    starts.extend(0..points.len());
    for start in starts {
        loop {
            let (mut path, mut here) = (vec![start], start);
            while let Some(e) = at[here].iter().copied().find(|e| !used[*e]) {
                used[e] = true;
                here = edges[e][0] + edges[e][1] - here;
                if here == start {
                    break;
                }
                path.push(here);
            }
            if path.len() < 2 {
                break;
            }
            let path_points: Vec<DVec2> = path.iter().map(|n| points[*n]).collect();
            if here == start { rings.push(straight(path_points)) } else { lines.push(path_points) }
        }
    }
    let arrays = |list: Vec<DVec2>| list.into_iter().map(|p| p.to_array()).collect::<Vec<_>>();
    let rings = rings.into_iter().filter(|r| r.len() > 2).map(arrays).collect();
    Region { lines: lines.into_iter().map(arrays).collect(), ..Region::even_odd(rings) }
}

/// Drops points on the straight line between their neighbours: cuts of triangles have many.
fn straight(ring: Vec<DVec2>) -> Vec<DVec2> {
    let mut out: Vec<DVec2> = Vec::new();
    for (i, p) in ring.iter().enumerate() {
        let next = ring[(i + 1) % ring.len()];
        let before = out.last().copied().unwrap_or(ring[ring.len() - 1]);
        let (u, v) = (*p - before, next - *p);
        if u.perp_dot(v).abs() > 1e-9 * u.length() * v.length() || u.dot(v) < 0.0 {
            out.push(*p);
        }
    }
    out
}

/// Points of a plane through a placement, as seen from above.
pub(super) fn flat(ring: &[[f64; 2]], m: &DAffine3) -> Vec<[f64; 2]> {
    ring.iter().map(|p| m.transform_point3(DVec3::new(p[0], p[1], 0.0)).truncate().to_array()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_lies_along_what_it_is_round() {
        let turn =
            |angle: f64| Region::ring(square(1.0, 2.0, 4.0, 0.5)).map(|p| DVec2::from_angle(angle).rotate(p));
        for angle in [0.0, 0.3, -1.2] {
            let corners = turn(angle).box_along().unwrap();
            let found = Region::ring(corners.map(|c| c.to_array()).to_vec());
            assert!((found.area() - 2.0).abs() < 1e-9, "{corners:?}");
            let all = turn(angle).combine(&found, Rule::Union);
            assert!((all.area() - 2.0).abs() < 1e-6, "{corners:?}");
        }
        assert_eq!(Region::default().box_along(), None);
    }

    fn square(x: f64, y: f64, w: f64, h: f64) -> Vec<[f64; 2]> {
        vec![[x, y], [x + w, y], [x + w, y + h], [x, y + h]]
    }

    #[test]
    fn what_lies_beyond_all_buildings_is_not_clipped() {
        let wall = || Region::ring(square(0.0, 0.0, 5.0, 0.2));
        let cut = |far: f64| {
            let hole = Region::ring(vec![[2.0, -1.0], [far, 0.1], [2.0, 1.0]]);
            wall().combine(&hole, Rule::Difference) != wall()
        };
        assert!(cut(CLIPPED_MAX) && !cut(2.0 * CLIPPED_MAX) && !cut(f64::INFINITY) && !cut(f64::NAN));
        let inner = square(0.1 * CLIPPED_MAX, 0.1 * CLIPPED_MAX, 0.5 * CLIPPED_MAX, 0.5 * CLIPPED_MAX);
        let rings = |far: f64| Region::even_odd(vec![square(0.0, 0.0, far, far), inner.clone()]);
        assert_eq!(rings(CLIPPED_MAX).shapes.len(), 1);
        assert_eq!(rings(2.0 * CLIPPED_MAX).shapes.len(), 2);
    }

    #[test]
    fn a_door_cuts_a_wall_in_two() {
        let wall = Region::ring(square(0.0, 0.0, 5.0, 0.2));
        let cut = wall.combine(&Region::ring(square(2.0, -0.1, 0.9, 0.4)), Rule::Difference);
        assert_eq!(cut.shapes.len(), 2);
        assert!((cut.rings().map(|r| area2(r).abs() / 2.0).sum::<f64>() - 0.82).abs() < 1e-9);
    }

    #[test]
    fn what_is_left_behind_a_hole_goes_and_what_ends_beside_it_stays() {
        let wall = Region::ring(square(0.0, 0.0, 3.0, 0.2));
        let hole = |x: f64, w: f64, d: f64| Region::ring(square(x, -0.1, w, d + 0.1));
        let rest = |h: &Region| wall.clone().combine(&h.through(&wall, 0.01), Rule::Difference).shapes.len();
        let (skin, end) = (hole(1.0, 0.9, 0.195), hole(2.095, 0.9, 0.3));
        assert_eq!((rest(&skin), rest(&end)), (2, 2));
        assert!((end.through(&wall, 0.01).area() - end.area()).abs() < 1e-12);
        let rounded = hole(1.0, 0.9, 0.2 - 1e-13);
        assert_eq!(rest(&rounded), 2);
        let corner = Region::ring(square(-0.1, -0.1, 0.105, 0.105));
        assert!((corner.through(&wall, 0.01).area() - corner.area()).abs() < 1e-12, "{corner:?}");
    }

    #[test]
    fn tips_without_width_vanish() {
        let there_and_back = vec![[0.0, 0.0], [4.0, 0.0], [4.0, 1.0], [2.0, 1.0], [6.0, 1.0], [0.0, 1.0]];
        assert_eq!(without_spikes(&there_and_back, 1e-9), square(0.0, 0.0, 4.0, 1.0));
        let over_the_seam = vec![[0.0, 2.0], [0.0, 0.0], [4.0, 0.0], [4.0, 1.0], [0.0, 1.0]];
        assert_eq!(without_spikes(&over_the_seam, 1e-9).len(), 4);
        assert!(without_spikes(&[[0.0, 0.0], [1.0, 0.0], [0.0, 0.0], [1.0, 0.0]], 1e-9).len() < 3);
        let thin = square(0.0, 0.0, 4.0, 1e-3);
        assert_eq!(without_spikes(&thin, 1e-9), thin);
    }

    #[test]
    fn a_box_of_faces_cut_at_a_height() {
        let at = |z: f64| {
            square(1.0, 1.0, 3.0, 0.25).into_iter().map(|p| DVec3::new(p[0], p[1], z)).collect::<Vec<_>>()
        };
        let (low, high) = (at(0.0), at(2.5));
        let mut faces = vec![vec![low.clone()], vec![high.clone()]];
        faces.extend((0..4).map(|i| vec![vec![low[i], low[(i + 1) % 4], high[(i + 1) % 4], high[i]]]));
        let cut = slice(&faces, 1.5);
        assert_eq!((cut.shapes.len(), cut.size(), cut.lines.len()), (1, 4, 0));
        assert!(slice(&faces, 3.0).is_empty());
        let open = slice(&faces[2..3], 1.5);
        assert_eq!((open.shapes.len(), open.lines.len()), (0, 1));
    }

    #[test]
    fn a_half_plane_clips() {
        let wall = Region::ring(square(0.0, 0.0, 4.0, 1.0));
        let half = wall.half_plane(DVec2::X, 1.0);
        let rest = wall.combine(&half, Rule::Difference);
        assert!((area2(&rest.shapes[0][0]).abs() / 2.0 - 3.0).abs() < 1e-9);
    }
}

//! Geometry of points and rings in floating point, in whatever unit the caller holds.

use glam::DVec2;

/// Box of some points, `None` for none.
pub fn box_of(points: impl Iterator<Item = DVec2>) -> Option<[DVec2; 2]> {
    points.fold(None, |acc, p| match acc {
        None => Some([p, p]),
        Some([lo, hi]) => Some([lo.min(p), hi.max(p)]),
    })
}

/// How much of the smaller of two boxes the other covers; nothing where it has no area.
pub fn shared_of_boxes(a: [DVec2; 2], b: [DVec2; 2]) -> f64 {
    let area = |[lo, hi]: [DVec2; 2]| (hi - lo).max(DVec2::ZERO).element_product();
    let least = area(a).min(area(b));
    if least > 0.0 { area([a[0].max(b[0]), a[1].min(b[1])]) / least } else { 0.0 }
}

/// Whether a point lies inside a ring (even-odd) that is not closed by a repeated point; on the outline
/// either.
pub fn is_inside_ring(ring: &[DVec2], p: DVec2) -> bool {
    let mut inside = false;
    for (i, a) in ring.iter().enumerate() {
        let b = ring[(i + 1) % ring.len()];
        if (a.y > p.y) != (b.y > p.y) && p.x < (b.x - a.x) * (p.y - a.y) / (b.y - a.y) + a.x {
            inside = !inside;
        }
    }
    inside
}

/// Distance of a point from a segment.
pub fn distance_to_segment(p: DVec2, [a, b]: [DVec2; 2]) -> f64 {
    let d = b - a;
    let t = if d == DVec2::ZERO { 0.0 } else { ((p - a).dot(d) / d.length_squared()).clamp(0.0, 1.0) };
    p.distance(a + d * t)
}

/// Area of a ring, positive anticlockwise.
pub fn ring_area(ring: &[DVec2]) -> f64 {
    let origin = ring.first().copied().unwrap_or_default();
    let next = ring.iter().cycle().skip(1);
    ring.iter().zip(next).map(|(p, q)| (*p - origin).perp_dot(*q - origin)).sum::<f64>() / 2.0
}

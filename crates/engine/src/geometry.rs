//! Exact plane geometry on whole micrometres, and the named tolerances of the house.

/// A point of the drawing frame in whole micrometres: the *snapped input* on which every sight-line
/// decision is exact (spec: visibility graph).
pub type PointUm = [i64; 2];

/// Micrometres in a metre.
pub const UM_PER_M: f64 = 1e6;

/// A straight piece that blocks sight, ends included. Both ends may coincide (a point that blocks).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Segment {
    /// One end.
    pub a: PointUm,
    /// The other end.
    pub b: PointUm,
}

impl Segment {
    /// The same segment shifted by whole micrometres.
    pub fn shifted(self, by: PointUm) -> Self {
        let shift = |p: PointUm| [p[0] + by[0], p[1] + by[1]];
        Self { a: shift(self.a), b: shift(self.b) }
    }
}

/// Twice the signed area of the triangle `a b c`, positive anticlockwise; exact for coordinates
/// within ±2^62 µm because it is computed in 128 bits.
pub fn cross_um(a: PointUm, b: PointUm, c: PointUm) -> i128 {
    let (abx, aby) = ((b[0] - a[0]) as i128, (b[1] - a[1]) as i128);
    let (acx, acy) = ((c[0] - a[0]) as i128, (c[1] - a[1]) as i128);
    abx * acy - aby * acx
}

/// Whether two closed segments share at least one point. Exact.
pub fn segments_touch(p: Segment, q: Segment) -> bool {
    let d1 = cross_um(q.a, q.b, p.a).signum();
    let d2 = cross_um(q.a, q.b, p.b).signum();
    let d3 = cross_um(p.a, p.b, q.a).signum();
    let d4 = cross_um(p.a, p.b, q.b).signum();
    if d1 * d2 < 0 && d3 * d4 < 0 {
        return true;
    }
    (d1 == 0 && in_box(q, p.a))
        || (d2 == 0 && in_box(q, p.b))
        || (d3 == 0 && in_box(p, q.a))
        || (d4 == 0 && in_box(p, q.b))
}

fn in_box(s: Segment, p: PointUm) -> bool {
    (0..2).all(|k| s.a[k].min(s.b[k]) <= p[k] && p[k] <= s.a[k].max(s.b[k]))
}

/// Where a point stands relative to a closed ring.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Strictly inside.
    Inside,
    /// On the outline.
    On,
    /// Strictly outside.
    Outside,
}

/// Even-odd position of `p` in the ring through `ring` (closed implicitly). Exact.
pub fn side_of_ring(ring: &[PointUm], p: PointUm) -> Side {
    let mut inside = false;
    for (i, &a) in ring.iter().enumerate() {
        let b = ring[(i + 1) % ring.len()];
        let turn = cross_um(a, b, p);
        if turn == 0 && in_box(Segment { a, b }, p) {
            return Side::On;
        }
        let (lo, hi, up) = if a[1] <= b[1] { (a, b, turn > 0) } else { (b, a, turn < 0) };
        if lo[1] <= p[1] && p[1] < hi[1] && up {
            inside = !inside;
        }
    }
    if inside { Side::Inside } else { Side::Outside }
}

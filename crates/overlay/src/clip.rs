//! Cuts lines and outlines to a box before they are drawn: the rasteriser works in 32-bit floats and
//! gives up on points far outside the sheet.

/// A point, any unit.
type Point = [f64; 2];
/// Lower left and upper right corner.
type Box2 = [Point; 2];

/// The parts of a polyline (closed: the last point is joined with the first) that lie in the box, in
/// order. A line that lies inside as a whole comes back as one part with its closing flag.
pub fn lines(points: &[Point], closed: bool, to: Box2) -> Vec<(Vec<Point>, bool)> {
    let finite: Vec<Point> =
        points.iter().copied().filter(|p| p[0].is_finite() && p[1].is_finite()).collect();
    if finite.iter().all(|p| contains(to, *p)) {
        return if finite.is_empty() { Vec::new() } else { vec![(finite, closed)] };
    }
    let last = usize::from(closed && finite.len() > 2);
    let mut parts: Vec<(Vec<Point>, bool)> = Vec::new();
    for i in 0..finite.len() - 1 + last {
        let Some([a, b]) = segment(finite[i], finite[(i + 1) % finite.len()], to) else { continue };
        match parts.last_mut() {
            Some((part, _)) if part.last() == Some(&a) => part.push(b),
            _ => parts.push((vec![a, b], false)),
        }
    }
    parts
}

/// The part of a segment inside the box (Liang and Barsky 1984).
fn segment(a: Point, b: Point, to: Box2) -> Option<[Point; 2]> {
    let (mut from, mut until) = (0.0f64, 1.0f64);
    for k in 0..2 {
        let way = b[k] - a[k];
        for (room, way) in [(to[0][k] - a[k], way), (a[k] - to[1][k], -way)] {
            if way == 0.0 {
                if room > 0.0 {
                    return None;
                }
            } else if way > 0.0 {
                from = from.max(room / way);
            } else {
                until = until.min(room / way);
            }
        }
    }
    let within = |p: Point| [0, 1].map(|k| p[k].clamp(to[0][k], to[1][k]));
    let at = |t: f64| [0, 1].map(|k| a[k] + t * (b[k] - a[k]));
    // Rounding can say "the whole segment" for one that only comes near: both ends are held to the box.
    let start = within(if from == 0.0 { a } else { at(from) });
    let end = within(if until == 1.0 { b } else { at(until) });
    (from <= until).then_some([start, end])
}

/// An outline cut to the box (Sutherland and Hodgman 1974); pieces that fall apart stay joined along
/// the edge of the box, where nothing is seen of them.
pub fn ring(points: &[Point], to: Box2) -> Vec<Point> {
    let mut ring: Vec<Point> =
        points.iter().copied().filter(|p| p[0].is_finite() && p[1].is_finite()).collect();
    for k in 0..2 {
        for (limit, sign) in [(to[0][k], 1.0), (to[1][k], -1.0)] {
            let inside = |p: Point| (p[k] - limit) * sign >= 0.0;
            let mut kept = Vec::with_capacity(ring.len());
            for (i, &b) in ring.iter().enumerate() {
                let a = ring[(i + ring.len() - 1) % ring.len()];
                if inside(a) != inside(b) {
                    let t = (limit - a[k]) / (b[k] - a[k]);
                    let other = a[1 - k] + t * (b[1 - k] - a[1 - k]);
                    kept.push(if k == 0 { [limit, other] } else { [other, limit] });
                }
                if inside(b) {
                    kept.push(b);
                }
            }
            ring = kept;
        }
    }
    ring
}

fn contains(to: Box2, p: Point) -> bool {
    (0..2).all(|k| to[0][k] <= p[k] && p[k] <= to[1][k])
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const UNIT: Box2 = [[0.0, 0.0], [1.0, 1.0]];

    #[test]
    fn a_line_through_the_box_keeps_its_middle() {
        let cut = lines(&[[-1.0, 0.5], [2.0, 0.5], [2.0, 3.0]], false, UNIT);
        assert_eq!(cut, [(vec![[0.0, 0.5], [1.0, 0.5]], false)]);
        assert_eq!(lines(&[[0.2, 0.2], [0.8, 0.2], [0.5, 0.9]], true, UNIT).len(), 1);
        assert_eq!(lines(&[[5.0, 5.0], [6.0, 6.0]], false, UNIT), []);
        assert_eq!(lines(&[[f64::NAN, 0.0]], true, UNIT), []);
    }

    #[test]
    fn a_ring_round_the_box_becomes_the_box() {
        let cut = ring(&[[-9.0, -9.0], [9.0, -9.0], [9.0, 9.0], [-9.0, 9.0]], UNIT);
        let area = |r: &[Point]| {
            let twice: f64 = (0..r.len())
                .map(|i| {
                    let (a, b) = (r[i], r[(i + 1) % r.len()]);
                    a[0] * b[1] - a[1] * b[0]
                })
                .sum();
            twice / 2.0
        };
        assert_eq!(area(&cut), 1.0);
        assert_eq!(ring(&[[2.0, 2.0], [3.0, 2.0], [3.0, 3.0]], UNIT), Vec::<Point>::new());
    }

    proptest! {
        #[test]
        fn what_is_kept_lies_in_the_box(
            points in proptest::collection::vec(proptest::array::uniform2(prop_oneof![
                -1e9..1e9f64,
                Just(1e300),
                Just(-1e300),
            ]), 1..8),
            closed: bool,
        ) {
            let to = [[-1e3, -1e3], [1e3, 1e3]];
            let near = |p: &Point| p.iter().all(|v| v.abs() <= 1e3 * (1.0 + 1e-6));
            prop_assert!(lines(&points, closed, to).iter().flat_map(|(part, _)| part).all(near));
            prop_assert!(ring(&points, to).iter().all(near));
        }

        #[test]
        fn what_is_inside_stays(points in proptest::collection::vec(proptest::array::uniform2(0.0..1.0f64), 1..8)) {
            prop_assert_eq!(lines(&points, true, UNIT), vec![(points.clone(), true)]);
            prop_assert_eq!(ring(&points, UNIT), points);
        }
    }
}

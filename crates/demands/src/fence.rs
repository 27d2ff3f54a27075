//! What bounds a floor, found by rows: whether a straight line stays inside.

use enfilade_cad::plane::distance_to_segment;
use glam::DVec2;

use crate::polygon::Polygon;

/// Height of a row, metres: a few sides of a building lie in each.
const ROW_M: f64 = 0.5;

/// Lines that pass a corner nearer than this touch it, metres: what rounding to micrometres leaves.
const TOUCH_M: f64 = 2e-6;

/// The sides of a floor.
pub(crate) struct Fence {
    sides: Vec<[DVec2; 2]>,
    rows: Vec<Vec<u32>>,
    low: f64,
}

impl Fence {
    /// Of a floor.
    pub fn new(floor: &Polygon) -> Self {
        let sides: Vec<[DVec2; 2]> = floor.sides().collect();
        let [lo, hi] = floor.bounds().unwrap_or_default();
        let count = ((hi.y - lo.y) / ROW_M).floor().max(0.0) as usize + 1;
        let mut out = Self { sides, rows: vec![Vec::new(); count], low: lo.y };
        for k in 0..out.sides.len() {
            let [from, to] = out.span(out.sides[k]);
            (from..=to).for_each(|row| out.rows[row].push(k as u32));
        }
        out
    }

    fn row(&self, y: f64) -> usize {
        (((y - self.low) / ROW_M).floor().max(0.0) as usize).min(self.rows.len() - 1)
    }

    fn span(&self, [a, b]: [DVec2; 2]) -> [usize; 2] {
        [self.row(a.y.min(b.y) - TOUCH_M), self.row(a.y.max(b.y) + TOUCH_M)]
    }

    /// Whether a point lies inside or on a side.
    pub fn holds(&self, p: DVec2) -> bool {
        let mut is_inside = false;
        for k in &self.rows[self.row(p.y)] {
            let [a, b] = self.sides[*k as usize];
            if (a.y > p.y) != (b.y > p.y) && p.x < (b.x - a.x) * (p.y - a.y) / (b.y - a.y) + a.x {
                is_inside = !is_inside;
            }
        }
        is_inside || self.is_on(p)
    }

    fn is_on(&self, p: DVec2) -> bool {
        let [from, to] = self.span([p, p]);
        let near = |k: &u32| distance_to_segment(p, self.sides[*k as usize]) <= 2.0 * TOUCH_M;
        (from..=to).any(|row| self.rows[row].iter().any(near))
    }

    /// Whether one can go straight from one point to another; along a side and past a corner too.
    pub fn is_free(&self, a: DVec2, b: DVec2) -> bool {
        let length = a.distance(b);
        if length <= TOUCH_M {
            return true;
        }
        let along = (b - a) / length;
        let [from, to] = self.span([a, b]);
        let mut touched = vec![0.0, length];
        for row in from..=to {
            for k in &self.rows[row] {
                let side = self.sides[*k as usize];
                match meeting([a, b], (along, length), side) {
                    Meeting::Crosses => return false,
                    Meeting::Touches(at) => touched.extend(at.into_iter().flatten()),
                    Meeting::Apart => {}
                }
            }
        }
        touched.sort_by(f64::total_cmp);
        // Between two places where it touches, a line lies on one side.
        let pieces = touched.windows(2).filter(|w| w[1] - w[0] > 4.0 * TOUCH_M);
        pieces.map(|w| a + along * f64::midpoint(w[0], w[1])).all(|p| self.holds(p))
    }
}

enum Meeting {
    Crosses,
    /// Where it touches, metres along the line.
    Touches([Option<f64>; 2]),
    Apart,
}

fn meeting([a, b]: [DVec2; 2], (along, length): (DVec2, f64), [p, q]: [DVec2; 2]) -> Meeting {
    let off = [p, q].map(|c| along.perp_dot(c - a));
    if off[0] > TOUCH_M && off[1] > TOUCH_M || off[0] < -TOUCH_M && off[1] < -TOUCH_M {
        return Meeting::Apart;
    }
    let on = [p, q].map(|c| along.dot(c - a));
    if on[0].min(on[1]) > length + TOUCH_M || on[0].max(on[1]) < -TOUCH_M {
        return Meeting::Apart;
    }
    let is_end = off.map(|o| o.abs() <= TOUCH_M);
    if is_end[0] || is_end[1] {
        let inside = |k: usize| Some(on[k]).filter(|s| is_end[k] && *s > 0.0 && *s < length);
        return Meeting::Touches([inside(0), inside(1)]);
    }
    let side = (q - p).normalize_or_zero();
    let ends = [a, b].map(|c| side.perp_dot(c - p));
    if ends[0].abs() <= TOUCH_M || ends[1].abs() <= TOUCH_M || ends[0] * ends[1] > 0.0 {
        return Meeting::Apart;
    }
    Meeting::Crosses
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(points: &[[f64; 2]]) -> Vec<DVec2> {
        points.iter().copied().map(DVec2::from).collect()
    }

    #[test]
    fn a_line_stays_inside_or_does_not() {
        let column = at(&[[4.0, 4.0], [6.0, 4.0], [6.0, 6.0], [4.0, 6.0]]);
        let hall = Polygon::new(&at(&[[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]]), &[column]);
        let fence = Fence::new(&hall);
        let free = |a: [f64; 2], b: [f64; 2]| fence.is_free(a.into(), b.into());
        assert!(free([1.0, 1.0], [9.0, 1.0]));
        assert!(free([0.0, 0.0], [10.0, 0.0]), "along a side");
        assert!(free([4.0, 4.0], [6.0, 4.0]), "along the column");
        assert!(free([2.0, 4.0], [9.0, 4.0]), "past the column");
        assert!(!free([1.0, 5.0], [9.0, 5.0]));
        assert!(!free([4.0, 4.0], [6.0, 6.0]), "across the column from corner to corner");
        assert!(!free([2.0, 2.0], [8.0, 8.0]), "through both corners");
        assert!(free([2.0, 6.0], [6.0, 2.0]), "past one corner");
        assert!(!fence.holds(DVec2::new(5.0, 5.0)) && fence.holds(DVec2::new(4.0, 5.0)));
    }
}

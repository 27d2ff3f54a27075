//! What works do to the lines that stop sight: some go, some come.

use enfilade_engine::geometry::{PointUm, Segment};

/// A stretch of wall as a quadrilateral, drawing frame, micrometres: along the wall at its first side, back at its second.
pub type Quad = [PointUm; 4];

/// What is demolished and what is built.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Change {
    /// What lies inside goes. Convex.
    pub demolished: Vec<Quad>,
    /// What stops sight afterwards, besides what stays: jambs, walled-up doors, partitions.
    pub built: Vec<Segment>,
}

impl Change {
    /// The lines of a layout: what is drawn, less what is demolished, plus what is built.
    pub fn apply(&self, drawn: &[Segment]) -> Vec<Segment> {
        let mut out = drawn.to_vec();
        for quad in &self.demolished {
            let parts = out.iter().flat_map(|s| outside(*s, quad));
            out = parts.collect();
        }
        out.extend(&self.built);
        out
    }

    /// Both together.
    pub fn and(mut self, other: &Self) -> Self {
        self.demolished.extend(&other.demolished);
        self.built.extend(&other.built);
        self
    }
}

/// The parts of a segment outside a convex quadrilateral, at most two. Ends on its outline stay with the part outside.
fn outside(s: Segment, quad: &Quad) -> impl Iterator<Item = Segment> {
    let inside = inside(s, quad);
    let whole = inside.is_none().then_some(s);
    let at = |share: f64| -> PointUm {
        [0, 1].map(|k| s.a[k] + ((s.b[k] - s.a[k]) as f64 * share).round() as i64)
    };
    let parts = inside.map(|[from, to]| {
        let before = (from > 0.0).then(|| Segment { a: s.a, b: at(from) });
        let after = (to < 1.0).then(|| Segment { a: at(to), b: s.b });
        [before, after]
    });
    whole.into_iter().chain(parts.into_iter().flatten().flatten())
}

/// The part of a segment inside a convex quadrilateral as shares of its length, if it has any length there.
pub fn inside(s: Segment, quad: &Quad) -> Option<[f64; 2]> {
    let point = |p: PointUm| [p[0] as f64, p[1] as f64];
    let (a, b) = (point(s.a), point(s.b));
    let turn: f64 = (0..4).map(|i| cross(point(quad[i]), point(quad[(i + 1) % 4]))).sum();
    let (mut from, mut to) = (0.0f64, 1.0f64);
    for i in 0..4 {
        let (p, q) = (point(quad[i]), point(quad[(i + 1) % 4]));
        let side =
            |x: [f64; 2]| turn.signum() * cross([q[0] - p[0], q[1] - p[1]], [x[0] - p[0], x[1] - p[1]]);
        let (at_a, at_b) = (side(a), side(b));
        if at_a <= 0.0 && at_b <= 0.0 {
            return None;
        }
        let share = at_a / (at_a - at_b);
        if at_a < 0.0 {
            from = from.max(share);
        } else if at_b < 0.0 {
            to = to.min(share);
        }
    }
    (from < to).then_some([from, to])
}

fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

#[cfg(test)]
mod tests {
    use super::*;

    const QUAD: Quad = [[10, -5], [20, -5], [20, 5], [10, 5]];

    fn left_of(a: PointUm, b: PointUm) -> Vec<[PointUm; 2]> {
        let change = Change { demolished: vec![QUAD], built: Vec::new() };
        change.apply(&[Segment { a, b }]).iter().map(|s| [s.a, s.b]).collect()
    }

    #[test]
    fn what_lies_in_the_stretch_goes_and_the_rest_stays() {
        assert_eq!(left_of([0, 2], [30, 2]), [[[0, 2], [10, 2]], [[20, 2], [30, 2]]]);
        assert_eq!(left_of([0, 2], [15, 2]), [[[0, 2], [10, 2]]]);
        assert_eq!(left_of([12, 0], [18, 0]), [[[0; 2]; 2]; 0]);
        assert_eq!(left_of([0, 6], [30, 6]), [[[0, 6], [30, 6]]]);
        // Along its outline: a face of the next wall.
        assert_eq!(left_of([10, -9], [10, 9]), [[[10, -9], [10, 9]]]);
        assert_eq!(left_of([0, 5], [30, 5]), [[[0, 5], [30, 5]]]);
    }

    #[test]
    fn the_way_round_the_stretch_does_not_matter() {
        let back = Change { demolished: vec![[QUAD[3], QUAD[2], QUAD[1], QUAD[0]]], built: Vec::new() };
        let lines = [Segment { a: [0, 2], b: [30, 2] }];
        assert_eq!(back.apply(&lines), Change { demolished: vec![QUAD], built: vec![] }.apply(&lines));
    }
}

//! What is seen from a point: the exact polygon, and how wide what lies at its edge is seen.

use std::f64::consts::{PI, TAU};

use enfilade_cad::plane::distance_to_segment;
use glam::DVec2;

use crate::polygon::Polygon;

/// Directions nearer to each other than this are one, radians.
const SAME_RAD: f64 = 1e-12;

/// What a look meets lies this near to a side that it is taken for, metres: what rounding to micrometres leaves.
const ON_M: f64 = 1e-5;

/// Where a view ends: between two directions it meets one side of the floor.
struct Slice {
    ends: [DVec2; 2],
    width_rad: f64,
}

/// A floor on which one looks round.
pub(crate) struct Scene {
    sides: Vec<[DVec2; 2]>,
}

/// What one looks at: the middle of the field and how wide it is in all, radians.
pub(crate) type Field = [f64; 2];

impl Scene {
    /// Of a floor.
    pub fn new(floor: &Polygon) -> Self {
        Self { sides: floor.sides().collect() }
    }

    /// Directions between which a view from `p` meets one side, ascending, over a turn.
    fn directions(&self, p: DVec2, field: Option<Field>) -> Vec<f64> {
        let from = field.map_or(-PI, |[middle, width]| middle - width / 2.0);
        let width = field.map_or(TAU, |f| f[1].min(TAU));
        let turned = |a: DVec2| (a - p).to_angle() - from;
        let corners = self.sides.iter().map(|s| turned(s[0]).rem_euclid(TAU)).filter(|a| *a < width);
        let mut out: Vec<f64> = corners.chain([0.0, width]).collect();
        out.sort_by(f64::total_cmp);
        out.dedup_by(|a, b| *a - *b < SAME_RAD);
        out.iter().map(|a| a + from).collect()
    }

    /// The side that a look in a direction meets first.
    fn met(&self, p: DVec2, direction: DVec2) -> Option<usize> {
        let mut best: Option<(f64, usize)> = None;
        for (k, [a, b]) in self.sides.iter().enumerate() {
            let [l, r] = [a, b].map(|c| direction.perp_dot(*c - p));
            if (l > 0.0) == (r > 0.0) {
                continue;
            }
            let far = direction.dot(a.lerp(*b, l / (l - r)) - p);
            if far > 0.0 && best.is_none_or(|b| far < b.0) {
                best = Some((far, k));
            }
        }
        best.map(|b| b.1)
    }

    fn slices(&self, p: DVec2, field: Option<Field>) -> Vec<Slice> {
        let directions = self.directions(p, field);
        let slice = |w: &[f64]| {
            let side = self.sides[self.met(p, DVec2::from_angle(f64::midpoint(w[0], w[1])))?];
            let end = |angle: f64| {
                let direction = DVec2::from_angle(angle);
                let [l, r] = side.map(|c| direction.perp_dot(c - p));
                let share = if l == r { 0.5 } else { (l / (l - r)).clamp(0.0, 1.0) };
                side[0].lerp(side[1], share)
            };
            Some(Slice { ends: [end(w[0]), end(w[1])], width_rad: w[1] - w[0] })
        };
        directions.windows(2).filter_map(slice).collect()
    }

    /// What is seen from a point.
    pub fn seen(&self, p: DVec2, field: Option<Field>) -> Polygon {
        let slices = self.slices(p, field);
        let mut ring: Vec<DVec2> = slices.iter().flat_map(|s| s.ends).collect();
        ring.dedup_by(|a, b| a.distance(*b) < 1e-9);
        if field.is_some_and(|f| f[1] < TAU) {
            ring.push(p);
        }
        if ring.len() < 3 { Polygon::default() } else { Polygon::new(&ring, &[]) }
    }

    /// How wide some whole sides of the floor are seen from a point, radians in all.
    pub fn width_rad(&self, p: DVec2, targets: &[[DVec2; 2]]) -> f64 {
        let is_target = |s: &&Slice| {
            let middle = s.ends[0].midpoint(s.ends[1]);
            targets.iter().any(|t| distance_to_segment(middle, *t) < ON_M)
        };
        self.slices(p, None).iter().filter(is_target).map(|s| s.width_rad).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hall() -> Polygon {
        let at = |p: &[[f64; 2]]| p.iter().copied().map(DVec2::from).collect::<Vec<_>>();
        let column = at(&[[4.0, 4.0], [6.0, 4.0], [6.0, 6.0], [4.0, 6.0]]);
        Polygon::new(&at(&[[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]]), &[column])
    }

    #[test]
    fn a_column_hides_what_is_behind_it() {
        let scene = Scene::new(&hall());
        // From the middle of a side: rays past the corners (4, 4) and (4, 6) meet the far side at 2.5 either way of 5.
        let seen = scene.seen(DVec2::new(1e-9, 5.0), None);
        let hidden = f64::midpoint(2.0, 5.0) * 6.0;
        assert!((seen.area_m2() - (100.0 - hidden)).abs() < 1e-4, "{}", seen.area_m2());
    }

    #[test]
    fn one_looks_half_a_turn() {
        let scene = Scene::new(&hall());
        let [up, right] = [PI / 2.0, 0.0].map(|to| scene.seen(DVec2::new(2.0, 5.0), Some([to, PI])));
        assert!(up.depth_m(DVec2::new(2.0, 7.0)) > 0.0 && up.depth_m(DVec2::new(2.0, 3.0)) < 0.0);
        assert!(right.depth_m(DVec2::new(1.0, 5.0)) < 0.0);
        let left = scene.seen(DVec2::new(2.0, 5.0), Some([PI, PI]));
        assert!((left.area_m2() - 20.0).abs() < 1e-6);
    }

    #[test]
    fn a_side_is_seen_as_wide_as_it_is() {
        let scene = Scene::new(&hall());
        let whole = [[DVec2::new(0.0, 0.0), DVec2::new(0.0, 10.0)]];
        let angle = scene.width_rad(DVec2::new(2.0, 5.0), &whole);
        assert!((angle - 2.0 * 2.5_f64.atan()).abs() < 1e-9);
    }
}

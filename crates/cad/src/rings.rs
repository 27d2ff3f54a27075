//! Rings divided by other rings, in whatever unit the caller holds.

use glam::DVec2;

use crate::region::{Region, Rule};

/// A ring divided by another.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Divided {
    /// What of it lies outside the other, each part an outline; corners that stay keep their digits.
    pub outside: Vec<Vec<DVec2>>,
    /// What of it lies inside the other.
    pub inside: Vec<Vec<DVec2>>,
    /// Whether a part outside has a hole: the other does not reach through.
    pub has_hole: bool,
}

/// Divides a ring by another. Rings do not repeat their first point.
pub fn divide(ring: &[DVec2], by: &[DVec2]) -> Divided {
    let region = |r: &[DVec2]| Region::ring(r.iter().map(|p| p.to_array()).collect());
    let outlines = |r: &Region| {
        let outer = r.shapes.iter().filter_map(|s| s.first());
        outer.map(|ring| ring.iter().map(|p| DVec2::from(*p)).collect()).collect()
    };
    let outside = region(ring).combine(&region(by), Rule::Difference);
    let inside = region(ring).combine(&region(by), Rule::Intersection);
    Divided {
        has_hole: outside.shapes.iter().any(|s| s.len() > 1),
        outside: outlines(&outside),
        inside: outlines(&inside),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ring(lo: [f64; 2], hi: [f64; 2]) -> Vec<DVec2> {
        [[lo[0], lo[1]], [hi[0], lo[1]], [hi[0], hi[1]], [lo[0], hi[1]]].map(DVec2::from).to_vec()
    }

    #[test]
    fn a_wall_is_divided_by_a_box_across_it() {
        let wall = ring([0.0, 0.0], [5.0, 0.2]);
        let cut = divide(&wall, &ring([2.0, -1.0], [3.0, 1.0]));
        assert_eq!((cut.outside.len(), cut.inside.len(), cut.has_hole), (2, 1, false));
        assert!(wall.iter().all(|p| cut.outside.iter().flatten().any(|q| q == p)), "{cut:?}");
        let apart = divide(&wall, &ring([2.0, 1.0], [3.0, 2.0]));
        assert_eq!((apart.outside.len(), apart.inside.len()), (1, 0));
        assert!(divide(&wall, &ring([2.0, 0.05], [3.0, 0.15])).has_hole);
        assert!(divide(&wall, &ring([-1.0, -1.0], [9.0, 1.0])).outside.is_empty());
    }
}

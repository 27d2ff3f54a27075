//! Boxes: how two lie to each other, and which lie at a place, found without a look at all others.

use glam::DVec2;

use enfilade_cad::curve::control_points;
use enfilade_cad::drawing::Entity;
use enfilade_cad::plane::box_of;

/// Boxes of a part that is halved no further: so few are looked at one by one as fast.
const LEAF: usize = 8;

/// Boxes in halves of halves, however unevenly they lie.
pub struct ByPlace {
    boxes: Vec<[DVec2; 2]>,
    order: Vec<u32>,
    /// Every part before its halves.
    parts: Vec<Part>,
}

struct Part {
    extent: [DVec2; 2],
    /// Its boxes in the order.
    from: usize,
    to: usize,
    /// Parts in it, itself among them.
    count: usize,
}

impl ByPlace {
    /// A box with a coordinate that is no number lies nowhere.
    pub fn new(boxes: Vec<[DVec2; 2]>) -> Self {
        let is_somewhere = |i: &u32| boxes[*i as usize].iter().all(|p| p.is_finite());
        let mut order: Vec<u32> = (0..boxes.len() as u32).filter(is_somewhere).collect();
        let mut parts = Vec::new();
        halve(&boxes, &mut order, 0, &mut parts);
        Self { boxes, order, parts }
    }

    /// The numbers of those that touch a box, ascending.
    pub fn touching(&self, asked: &[DVec2; 2]) -> Vec<usize> {
        let (mut out, mut k) = (Vec::new(), 0);
        while let Some(part) = self.parts.get(k) {
            let is_there = touches(&part.extent, asked);
            if is_there && part.count == 1 {
                let own = self.order[part.from..part.to].iter().map(|i| *i as usize);
                out.extend(own.filter(|i| touches(&self.boxes[*i], asked)));
            }
            k += if is_there { 1 } else { part.count };
        }
        out.sort_unstable();
        out
    }
}

/// Entities by the boxes of their control points, drawing units.
pub struct Entities<'d> {
    all: Vec<&'d Entity>,
    by_place: ByPlace,
}

impl<'d> Entities<'d> {
    /// Those without a point lie nowhere.
    pub fn new(entities: impl Iterator<Item = &'d Entity>) -> Self {
        let all: Vec<&Entity> = entities.collect();
        let extent = |e: &&Entity| box_of(control_points(&e.shape).into_iter()).unwrap_or([DVec2::NAN; 2]);
        Self { by_place: ByPlace::new(all.iter().map(extent).collect()), all }
    }

    /// Those whose box touches another, in their order.
    pub fn touching(&self, extent: &[DVec2; 2]) -> impl Iterator<Item = &'d Entity> {
        self.by_place.touching(extent).into_iter().map(|i| self.all[i])
    }

    /// The box of their points in a box; without points the box itself.
    pub fn tight(&self, extent: &[DVec2; 2]) -> [DVec2; 2] {
        let inside = self.touching(extent).flat_map(|e| control_points(&e.shape)).filter(is_in(extent));
        box_of(inside).unwrap_or(*extent)
    }
}

/// Whether a point lies in a box.
pub fn is_in([lo, hi]: &[DVec2; 2]) -> impl Fn(&DVec2) -> bool + use<> {
    let (lo, hi) = (*lo, *hi);
    move |p| p.cmpge(lo).all() && p.cmple(hi).all()
}

/// How much ground a box takes.
pub fn area([lo, hi]: &[DVec2; 2]) -> f64 {
    (hi - lo).element_product()
}

/// The box round two.
pub fn union(a: &[DVec2; 2], b: &[DVec2; 2]) -> [DVec2; 2] {
    [a[0].min(b[0]), a[1].max(b[1])]
}

/// Distance of two boxes, 0 where they overlap.
pub fn gap(a: &[DVec2; 2], b: &[DVec2; 2]) -> f64 {
    #[cfg(test)]
    looked::at_two();
    (a[0] - b[1]).max(b[0] - a[1]).max(DVec2::ZERO).length()
}

/// A box with more round it.
pub fn wider([lo, hi]: &[DVec2; 2], by: f64) -> [DVec2; 2] {
    [*lo - by, *hi + by]
}

/// Adds a part, which begins at `from`, and its halves across its longer side.
fn halve(boxes: &[[DVec2; 2]], own: &mut [u32], from: usize, parts: &mut Vec<Part>) {
    let all = own.iter().map(|i| boxes[*i as usize]);
    let Some([lo, hi]) = all.reduce(|[a, b], [c, d]| [a.min(c), b.max(d)]) else { return };
    let this = parts.len();
    parts.push(Part { extent: [lo, hi], from, to: from + own.len(), count: 1 });
    if own.len() > LEAF {
        let is_wide = hi.x - lo.x >= hi.y - lo.y;
        let at = |i: &u32| {
            let middle = boxes[*i as usize][0].midpoint(boxes[*i as usize][1]);
            if is_wide { middle.x } else { middle.y }
        };
        let half = own.len() / 2;
        own.select_nth_unstable_by(half, |i, j| at(i).total_cmp(&at(j)).then(i.cmp(j)));
        let (first, second) = own.split_at_mut(half);
        halve(boxes, first, from, parts);
        halve(boxes, second, from + half, parts);
    }
    parts[this].count = parts.len() - this;
}

fn touches(a: &[DVec2; 2], b: &[DVec2; 2]) -> bool {
    #[cfg(test)]
    looked::at_two();
    a[0].cmple(b[1]).all() && b[0].cmple(a[1]).all()
}

/// How often two boxes were held against each other in this thread, for tests of how work grows.
#[cfg(test)]
pub mod looked {
    use std::cell::Cell;

    thread_local! {
        static PAIRS: Cell<usize> = const { Cell::new(0) };
    }

    /// Counts one pair.
    pub fn at_two() {
        PAIRS.set(PAIRS.get() + 1);
    }

    /// The pairs since it was asked last.
    pub fn pairs() -> usize {
        PAIRS.replace(0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Boxes near, far and one over all, asked for all over.
    #[test]
    fn what_touches_a_box_is_found_and_nothing_else() {
        let at = |k: u32| DVec2::new(f64::from(k * 7919 % 101), f64::from(k * 104_729 % 97));
        let far = |k: u32| if k.is_multiple_of(50) { 1e6 } else { 1.0 };
        let mut boxes: Vec<[DVec2; 2]> =
            (0..400).map(|k| [at(k) * far(k), at(k) * far(k) + f64::from(k % 5)]).collect();
        boxes.push([DVec2::splat(-1e9), DVec2::splat(1e9)]);
        boxes.push([DVec2::NAN, DVec2::ONE]);
        let places = ByPlace::new(boxes.clone());
        for k in 0..200 {
            let asked = [at(k) - f64::from(k % 3), at(k) + f64::from(k % 30)];
            let plain: Vec<usize> = (0..boxes.len()).filter(|i| touches(&boxes[*i], &asked)).collect();
            assert!(plain.contains(&400));
            assert_eq!(places.touching(&asked), plain, "{asked:?}");
        }
        assert!(ByPlace::new(Vec::new()).touching(&boxes[400]).is_empty());
    }
}

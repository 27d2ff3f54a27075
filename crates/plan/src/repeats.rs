//! Storeys of one building drawn side by side, so near that they seem one drawing: their walls repeat.

use glam::DVec2;

use super::by_place::{ByPlace, area, gap, is_in, wider};
use super::parallels::Piece;

/// Storeys drawn side by side stand at least so far apart, metres: more than a passage is wide.
pub const APART_STOREYS_M: f64 = 1.2;

/// Each has this share of the largest drawing, by its box: no storey is a small part of another.
const LIKE_SHARE: f64 = 0.6;

/// So many of the corners of the one with fewer stand where corners of the other do, once they are laid over one another.
/// Of the two nearest storeys of the one real sheet of this kind at hand 28 of 64 do; of 64 other drawings none has two parts
/// that are as large and clear of each other.
const SHARED_MIN: f64 = 0.25;
/// … and at least so many: a rectangle has four on either face.
const CORNERS_MIN: usize = 12;

/// Corners laid over one another may be drawn so far apart, metres.
const SLIP_M: f64 = 0.05;

/// Walls of more pieces are not compared.
const PIECES_MAX: usize = 4_000;

/// Whether two of some drawings, clear of each other, are storeys of one building: as large as each other, and with corners in
/// the same places. `pieces`: all straight pieces of walls.
pub fn has_storeys(boxes: &[[DVec2; 2]], pieces: &[&Piece], metres_per_unit: f64) -> bool {
    let largest = boxes.iter().map(area).fold(0.0, f64::max);
    let is_large = |b: &&[DVec2; 2]| area(b) >= LIKE_SHARE * largest;
    let large: Vec<&[DVec2; 2]> = boxes.iter().filter(is_large).collect();
    let slip = SLIP_M / metres_per_unit;
    let own = |extent: &[DVec2; 2]| corners(pieces.iter().copied(), extent, slip);
    large.iter().enumerate().any(|(i, a)| {
        large[i + 1..]
            .iter()
            .any(|b| gap(a, b) * metres_per_unit >= APART_STOREYS_M && are_shared(&own(a), &own(b), slip))
    })
}

/// The ends of pieces in a box, each place once.
fn corners<'a>(pieces: impl Iterator<Item = &'a Piece>, extent: &[DVec2; 2], slip: f64) -> Vec<DVec2> {
    let is_in = is_in(extent);
    let ends: Vec<DVec2> = pieces.flat_map(|p| [p.a, p.b]).filter(|p| is_in(p)).collect();
    if ends.len() > 2 * PIECES_MAX {
        return Vec::new();
    }
    let places = ByPlace::new(ends.iter().map(|p| [*p, *p]).collect());
    let is_first = |(i, p): &(usize, &DVec2)| {
        places.touching(&wider(&[**p, **p], slip)).into_iter().all(|other| other >= *i)
    };
    ends.iter().enumerate().filter(is_first).map(|(_, p)| *p).collect()
}

/// Whether enough corners of the set with fewer stand where corners of the other do, both laid over one another by a corner
/// of their boxes.
fn are_shared(a: &[DVec2], b: &[DVec2], slip: f64) -> bool {
    let (few, many) = if a.len() <= b.len() { (a, b) } else { (b, a) };
    let extent = |of: &[DVec2]| enfilade_cad::plane::box_of(of.iter().copied());
    let (Some(low), Some(high)) = (extent(few), extent(many)) else { return false };
    let places = ByPlace::new(many.iter().map(|p| [*p, *p]).collect());
    let shared = |by: DVec2| {
        let is_there = |p: &&DVec2| !places.touching(&wider(&[**p + by, **p + by], slip)).is_empty();
        few.iter().filter(is_there).count()
    };
    let shifts =
        [[0, 0], [0, 1], [1, 0], [1, 1]].map(|[x, y]| DVec2::new(high[x].x - low[x].x, high[y].y - low[y].y));
    let most = shifts.into_iter().map(shared).max().unwrap_or(0);
    most >= CORNERS_MIN && most as f64 >= SHARED_MIN * few.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Both faces of the walls of a building of 10 by 8 m with a partition at `x`, stretched and moved.
    fn building(x: f64, times: DVec2, by: DVec2) -> Vec<Piece> {
        let ring = |t: f64| {
            let [lo, hi] = [t, -t].map(DVec2::splat);
            let (lo, hi) = (lo, DVec2::new(10.0, 8.0) + hi);
            [lo, DVec2::new(hi.x, lo.y), hi, DVec2::new(lo.x, hi.y), lo]
        };
        let mut out: Vec<[DVec2; 2]> = Vec::new();
        for ring in [ring(0.0), ring(0.3)] {
            out.extend(ring.windows(2).map(|w| [w[0], w[1]]));
        }
        for face in [0.0, 0.1] {
            out.push([DVec2::new(x + face, 0.3), DVec2::new(x + face, 7.7)]);
            out.push([DVec2::new(x, 4.0 + face), DVec2::new(9.7, 4.0 + face)]);
        }
        out.into_iter().map(|[a, b]| Piece { a: a * times + by, b: b * times + by, entity: 0 }).collect()
    }

    fn are_storeys(all: &[Vec<Piece>]) -> bool {
        let extent = |of: &Vec<Piece>| enfilade_cad::plane::box_of(of.iter().flat_map(|p| [p.a, p.b]));
        let boxes: Vec<[DVec2; 2]> = all.iter().filter_map(extent).collect();
        has_storeys(&boxes, &all.iter().flatten().collect::<Vec<_>>(), 1.0)
    }

    #[test]
    fn storeys_repeat_their_corners() {
        let first = || building(3.0, DVec2::ONE, DVec2::ZERO);
        let beside = |x: f64, times: [f64; 2], by: [f64; 2]| building(x, times.into(), by.into());
        assert!(are_storeys(&[first(), beside(3.0, [1.0, 1.0], [12.0, 0.3])]));
        assert!(are_storeys(&[first(), beside(3.02, [1.0, 1.0], [12.0, 0.3])]), "drawn by hand");
        assert!(!are_storeys(&[first(), beside(3.0, [1.0, 1.0], [11.0, 0.0])]), "a passage apart");
        assert!(!are_storeys(&[first(), beside(3.0, [0.8, 1.2], [12.0, 0.0])]), "another building");
        assert!(!are_storeys(&[first(), beside(3.0, [0.5, 0.5], [12.0, 0.0])]), "a shed");
    }
}

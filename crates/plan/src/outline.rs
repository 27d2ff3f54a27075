//! Closed outlines: solid (a column, a wall drawn as an outline), or walls round a space (spec 3).

use enfilade_cad::sizes::SOLID_HALF_WIDTH_M;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

use super::Wall;
use super::markers::Markers;
use enfilade_engine::geometry::{PointUm, Side, UM_PER_M, side_of_ring};

/// An outline at most this large across (largest distance of two of its points) is solid.
pub const SOLID_ACROSS_M: f64 = 2.0;

/// How exactly the widest place of an outline is found.
const WIDTH_PRECISION_M: f64 = 0.005;

/// Cells looked at before the search for the widest place gives up and takes what it has.
const WIDTH_CELLS_MAX: usize = 20_000;

/// Marks the walls whose closed outline is solid.
pub fn mark_solids(walls: &mut [Wall], markers: &Markers) {
    let probes: Vec<PointUm> = walls.iter().map(|w| w.trace.points[0]).collect();
    for (i, wall) in walls.iter_mut().enumerate() {
        if !wall.trace.is_closed || wall.trace.points.len() < 3 {
            continue;
        }
        let ring = &wall.trace.points;
        let holds_wall =
            probes.iter().enumerate().any(|(j, p)| j != i && side_of_ring(ring, *p) == Side::Inside);
        wall.is_solid = !holds_wall && !markers.lies_in(ring) && is_thin_or_small(ring);
    }
}

/// Marks every outline of an element as solid, holes of the same element excepted: a cut through a body
/// says itself what is inside.
pub fn mark_bodies(walls: &mut [Wall]) {
    let probes: Vec<(usize, PointUm)> = walls.iter().map(|w| (w.source.record, w.trace.points[0])).collect();
    for (i, wall) in walls.iter_mut().enumerate() {
        let holds_hole = |(j, (record, p)): (usize, &(usize, PointUm))| {
            j != i && *record == wall.source.record && side_of_ring(&wall.trace.points, *p) == Side::Inside
        };
        wall.is_solid =
            wall.trace.is_closed && wall.trace.points.len() > 2 && !probes.iter().enumerate().any(holds_hole);
    }
}

fn is_thin_or_small(ring: &[PointUm]) -> bool {
    across_um(ring) <= SOLID_ACROSS_M * UM_PER_M
        || inner_radius_m(ring) <= SOLID_HALF_WIDTH_M + WIDTH_PRECISION_M
}

fn across_um(ring: &[PointUm]) -> f64 {
    let mut across = 0.0_f64;
    for (i, a) in ring.iter().enumerate() {
        for b in &ring[i + 1..] {
            across = across.max(((a[0] - b[0]) as f64).hypot((a[1] - b[1]) as f64));
        }
    }
    across
}

struct Square {
    centre: [f64; 2],
    half: f64,
    reach: f64,
}

impl PartialEq for Square {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}
impl Eq for Square {}
impl PartialOrd for Square {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Square {
    fn cmp(&self, other: &Self) -> Ordering {
        self.reach.total_cmp(&other.reach)
    }
}

/// Radius of the largest circle inside the ring, metres, within `WIDTH_PRECISION_M`; stops early once
/// it is known to be larger than [`SOLID_HALF_WIDTH_M`].
///
/// Branch and bound over squares (the "pole of inaccessibility").
pub fn inner_radius_m(ring: &[PointUm]) -> f64 {
    let base = ring[0];
    let local: Vec<[f64; 2]> = ring
        .iter()
        .map(|p| [(p[0] - base[0]) as f64 / UM_PER_M, (p[1] - base[1]) as f64 / UM_PER_M])
        .collect();
    let (mut lo, mut hi) = ([f64::MAX; 2], [f64::MIN; 2]);
    for p in &local {
        for k in 0..2 {
            lo[k] = lo[k].min(p[k]);
            hi[k] = hi[k].max(p[k]);
        }
    }
    let half = ((hi[0] - lo[0]).max(hi[1] - lo[1]) / 2.0).max(WIDTH_PRECISION_M);
    let square = |centre: [f64; 2], half: f64| Square {
        centre,
        half,
        reach: signed_distance(&local, centre) + half * std::f64::consts::SQRT_2,
    };
    let mut heap = BinaryHeap::from([square([(lo[0] + hi[0]) / 2.0, (lo[1] + hi[1]) / 2.0], half)]);
    let mut best = 0.0_f64;
    for _ in 0..WIDTH_CELLS_MAX {
        let Some(top) = heap.pop() else { break };
        if top.reach <= best + WIDTH_PRECISION_M {
            break;
        }
        best = best.max(top.reach - top.half * std::f64::consts::SQRT_2);
        if best > SOLID_HALF_WIDTH_M + 2.0 * WIDTH_PRECISION_M {
            break;
        }
        let h = top.half / 2.0;
        for (sx, sy) in [(-h, -h), (h, -h), (-h, h), (h, h)] {
            heap.push(square([top.centre[0] + sx, top.centre[1] + sy], h));
        }
    }
    best
}

/// Distance to the outline, positive inside.
fn signed_distance(ring: &[[f64; 2]], p: [f64; 2]) -> f64 {
    let (mut inside, mut nearest2) = (false, f64::MAX);
    for (i, a) in ring.iter().enumerate() {
        let b = ring[(i + 1) % ring.len()];
        if (a[1] > p[1]) != (b[1] > p[1]) && p[0] < (b[0] - a[0]) * (p[1] - a[1]) / (b[1] - a[1]) + a[0] {
            inside = !inside;
        }
        let d = [b[0] - a[0], b[1] - a[1]];
        let len2 = d[0] * d[0] + d[1] * d[1];
        let t = if len2 > 0.0 { ((p[0] - a[0]) * d[0] + (p[1] - a[1]) * d[1]) / len2 } else { 0.0 }
            .clamp(0.0, 1.0);
        let off = [p[0] - a[0] - t * d[0], p[1] - a[1] - t * d[1]];
        nearest2 = nearest2.min(off[0] * off[0] + off[1] * off[1]);
    }
    let nearest = nearest2.sqrt();
    if inside { nearest } else { -nearest }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ring(points: &[[f64; 2]]) -> Vec<PointUm> {
        points.iter().map(|p| [(p[0] * UM_PER_M) as i64, (p[1] * UM_PER_M) as i64]).collect()
    }

    #[test]
    fn thin_small_and_roomy_outlines() {
        let wall = ring(&[[0.0, 0.0], [12.0, 0.0], [12.0, 0.4], [0.0, 0.4]]);
        let angle = ring(&[[0.0, 0.0], [12.0, 0.0], [12.0, 9.0], [11.6, 9.0], [11.6, 0.4], [0.0, 0.4]]);
        let column = ring(&[[0.0, 0.0], [1.4, 0.0], [1.4, 1.4], [0.0, 1.4]]);
        let thick = ring(&[[0.0, 0.0], [12.0, 0.0], [12.0, 1.2], [0.0, 1.2]]);
        let room = ring(&[[0.0, 0.0], [3.0, 0.0], [3.0, 4.0], [0.0, 4.0]]);
        for (r, solid) in [(&wall, true), (&angle, true), (&column, true), (&thick, false), (&room, false)] {
            assert_eq!(is_thin_or_small(r), solid, "{r:?}");
        }
        assert!((inner_radius_m(&wall) - 0.2).abs() < 0.01);
    }
}

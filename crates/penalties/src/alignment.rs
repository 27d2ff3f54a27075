//! Alignment with the drawing's main directions: the "ordered room layout" (spec section 5).

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec2;

use super::{Layout, WallPiece};

/// Walls whose directions differ by no more than this belong to one main direction (2°): draughting
/// inaccuracy, far below any turn an architect intends.
pub const DIRECTION_BAND_RAD: f64 = 2.0 * PI / 180.0;

/// A direction is a main one if at least this share of the total wall length runs along it.
pub const MAIN_DIRECTION_SHARE: f64 = 0.1;

/// A piece of a solid's outline counts if it is at least this share of the whole: so the sides of a slab
/// or a square column do, and the many short pieces of a round column do not.
pub const SOLID_SIDE_SHARE: f64 = 0.2;

/// `Σ L δ² / Σ L` over the walls that may move, δ the angle to the nearest main direction.
///
/// Walls that *may* move, not those that happen to stand elsewhere: so the value has no jump where a
/// parameter passes its identity.
#[derive(Clone, Debug, PartialEq)]
pub struct Alignment {
    directions_rad: Vec<f64>,
    /// Pieces that may move and have a direction.
    pieces: Vec<usize>,
}

impl Alignment {
    /// Finds the main directions of the initial layout.
    pub fn new(initial: &Layout<'_>) -> Self {
        let mut pieces = vec![];
        let mut start = 0;
        for group in initial.pieces.chunk_by(|p, q| p.solid.is_some() && p.solid == q.solid) {
            let outline_m: f64 = group.iter().map(WallPiece::length_m).sum();
            let counts = |p: &WallPiece| p.solid.is_none() || p.length_m() >= SOLID_SIDE_SHARE * outline_m;
            pieces.extend((start..).zip(group).filter(|(_, p)| p.is_moving && counts(p)).map(|(i, _)| i));
            start += group.len();
        }
        Self { directions_rad: main_directions_rad(initial), pieces }
    }

    /// The main directions, radians in [0, π), the longest first; empty for a plan without any.
    pub fn directions_rad(&self) -> &[f64] {
        &self.directions_rad
    }

    /// The penalty, rad², in [0, (π/2)²]; 0 where nothing moves or the plan has no main direction.
    pub fn measure_rad2(&self, now: &Layout<'_>) -> f64 {
        let (mut sum, mut length_m) = (0.0, 0.0);
        for piece in self.pieces.iter().map(|&i| &now.pieces[i]) {
            let l = piece.length_m();
            if l > 0.0 {
                let delta = self.off_direction_rad(direction_rad(piece.b - piece.a));
                sum += l * delta * delta;
                length_m += l;
            }
        }
        if length_m > 0.0 { sum / length_m } else { 0.0 }
    }

    fn off_direction_rad(&self, rad: f64) -> f64 {
        let nearest = self.directions_rad.iter().map(|&d| between_rad(d, rad).abs()).reduce(f64::min);
        nearest.unwrap_or(0.0)
    }
}

/// Direction of an undirected line, radians in [0, π).
fn direction_rad(v: DVec2) -> f64 {
    let rad = v.y.atan2(v.x).rem_euclid(PI);
    if rad >= PI { 0.0 } else { rad }
}

/// Smallest turn from one undirected direction to another, radians in (−π/2, π/2].
fn between_rad(from: f64, to: f64) -> f64 {
    let turn = (to - from).rem_euclid(PI);
    if turn > FRAC_PI_2 { turn - PI } else { turn }
}

/// Main directions: again and again the band that holds the most wall length, while it holds at least
/// [`MAIN_DIRECTION_SHARE`] of the whole. Radians in [0, π).
fn main_directions_rad(layout: &Layout<'_>) -> Vec<f64> {
    let mut walls: Vec<(f64, f64)> = layout
        .pieces
        .iter()
        .map(|p| (direction_rad(p.b - p.a), p.length_m()))
        .filter(|&(_, length_m)| length_m > 0.0)
        .collect();
    walls.sort_by(|p, q| p.0.total_cmp(&q.0).then(p.1.total_cmp(&q.1)));
    let total_m: f64 = walls.iter().map(|w| w.1).sum();
    let mut directions = Vec::new();
    while let Some((mean_rad, held_m)) = fullest_band(&walls) {
        if held_m < MAIN_DIRECTION_SHARE * total_m {
            break;
        }
        directions.push(mean_rad);
        walls.retain(|w| between_rad(mean_rad, w.0).abs() > DIRECTION_BAND_RAD);
    }
    directions
}

/// The band of width [`DIRECTION_BAND_RAD`] with the most length: its length-weighted mean direction
/// and that length. `walls`: (direction, length) by ascending direction. The first of equal bands wins.
fn fullest_band(walls: &[(f64, f64)]) -> Option<(f64, f64)> {
    let n = walls.len();
    let (mut best, mut end, mut held_m) = (None::<(usize, usize, f64)>, 0, 0.0);
    for start in 0..n {
        while end < start + n && (walls[end % n].0 - walls[start].0).rem_euclid(PI) <= DIRECTION_BAND_RAD {
            held_m += walls[end % n].1;
            end += 1;
        }
        if best.is_none_or(|b| held_m > b.2 * (1.0 + 1e-12)) {
            best = Some((start, end, held_m));
        }
        held_m -= walls[start].1;
    }
    let (start, end, _) = best?;
    let held_m: f64 = (start..end).map(|i| walls[i % n].1).sum();
    let turn: f64 = (start..end).map(|i| walls[i % n].1 * between_rad(walls[start].0, walls[i % n].0)).sum();
    Some(((walls[start].0 + turn / held_m).rem_euclid(PI), held_m))
}

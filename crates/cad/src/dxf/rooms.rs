//! Outlines of rooms, drawn round their floors: each side goes with the wall it lies on.

use std::collections::HashSet;

use glam::DVec2;

use super::ground::{Face, Ground, overlap};
use crate::drawing::{Drawing, RigidMotion};
use crate::plane::distance_to_segment;
use crate::room_outline::{ON_WALL_M, PARALLEL_SIN, Walls, Way, followed};

/// What moves by less stands, metres: coordinates are written to whole micrometres.
const STILL_M: f64 = 2e-6;

/// Faces beside a room.
struct Beside<'g> {
    faces: Vec<(&'g Face, Way)>,
    /// What is this near to a face lies on it, drawing units.
    near: f64,
}

impl Walls for Beside<'_> {
    fn way(&self, at: DVec2, along: DVec2) -> Option<Way> {
        let is_along =
            |f: &Face| (f.from[1] - f.from[0]).normalize_or_zero().perp_dot(along).abs() <= PARALLEL_SIN;
        let near = self.faces.iter().filter(|(f, _)| is_along(f));
        let near = near.map(|(f, way)| (distance_to_segment(at, f.from), *way));
        near.filter(|n| n.0 <= self.near).min_by(|a, b| a.0.total_cmp(&b.0)).map(|n| n.1)
    }
}

/// How what lies on a face goes, across it: along it nothing is held.
fn way_of(face: &Face, still: f64) -> Way {
    let [[a, b], [c, d]] = [face.from, face.to];
    let (Some(along), Some(after)) = ((b - a).try_normalize(), (d - c).try_normalize()) else {
        return Way::default();
    };
    if along.perp_dot(after).abs() * c.distance(d) > still {
        let turn_rad = along.angle_to(after);
        let shift = c - DVec2::from_angle(turn_rad).rotate(a);
        return Way { along: DVec2::ZERO, motion: Some(RigidMotion { turn_rad, shift }) };
    }
    let across = along.perp() * along.perp().dot(c - a);
    if across.length() <= still { Way::default() } else { Way { along: across, motion: None } }
}

/// The outline of a room as drawn.
pub(super) struct Outline<'a> {
    /// Its corners, drawing units.
    pub points: &'a [DVec2],
    /// Between which of them it is round.
    pub round: Vec<[usize; 2]>,
    /// Box round it.
    pub bounds: [DVec2; 2],
}

/// The corners of a room's outline after its walls went; nothing where none of its sides lies on what moves. `metres`: those of
/// a drawing unit.
///
/// # Errors
/// In words, why it cannot follow.
pub(super) fn room(
    outline: &Outline<'_>,
    moved: &Ground,
    (drawing, passed_over): (&Drawing, &HashSet<usize>),
    metres: f64,
) -> Result<Option<Vec<DVec2>>, String> {
    let near = ON_WALL_M / metres;
    let bounds = [outline.bounds[0] - near, outline.bounds[1] + near];
    if moved.bounds().is_none_or(|m| !overlap(bounds, m)) {
        return Ok(None);
    }
    let standing = Ground::standing(drawing, passed_over, bounds);
    let faces = moved.faces.iter().chain(&standing.faces);
    let walls = Beside { faces: faces.map(|f| (f, way_of(f, STILL_M / metres))).collect(), near };
    let points = followed(outline.points, &walls, metres)?;
    if points.iter().zip(outline.points).all(|(p, q)| p.distance(*q) * metres <= STILL_M) {
        return Ok(None);
    }
    let keeps = |[i, j]: [usize; 2]| {
        let length = |points: &[DVec2]| points[i].distance(points[j]);
        (length(&points) - length(outline.points)).abs() * metres <= STILL_M
    };
    if !outline.round.iter().copied().all(keeps) {
        return Err("a round side of it would change".into());
    }
    Ok(Some(points))
}

//! Outlines of rooms, drawn round their floors: each side goes with the wall it lies on.

use std::collections::HashSet;

use glam::DVec2;

use super::ground::{Face, Ground, overlap};
use super::poche::{Area, Following};
use crate::drawing::{Drawing, Edit, RigidMotion};
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

/// The outline of a room after its walls went; nothing where none of its sides lies on what moves.
///
/// # Errors
/// In words, why it cannot follow.
pub(super) fn room(
    area: &Area,
    moved: &Ground,
    (drawing, passed_over): (&Drawing, &HashSet<usize>),
    metres: f64,
) -> Result<Option<Following>, String> {
    let near = ON_WALL_M / metres;
    let bounds = [area.bounds[0] - near, area.bounds[1] + near];
    if moved.bounds().is_none_or(|m| !overlap(bounds, m)) {
        return Ok(None);
    }
    let standing = Ground::standing(drawing, passed_over, bounds);
    let faces = moved.faces.iter().chain(&standing.faces);
    let walls = Beside { faces: faces.map(|f| (f, way_of(f, STILL_M / metres))).collect(), near };
    let points = followed(&area.points, &walls, metres)?;
    if points.iter().zip(&area.points).all(|(p, q)| p.distance(*q) * metres <= STILL_M) {
        return Ok(None);
    }
    let keeps = |[i, j]: [usize; 2]| {
        let length = |points: &[DVec2]| points[i].distance(points[j]);
        (length(&points) - length(&area.points)).abs() * metres <= STILL_M
    };
    if !area.round().all(keeps) {
        return Err("a round side of it would change".into());
    }
    let corners = [area.points.clone(), points.clone()];
    Ok(Some(Following { corners, edit: Edit::Points { record: area.record, points } }))
}

//! Drawn shapes by the points that move them, and arcs by their bulge; drawing units.

use std::f64::consts::TAU;

use glam::DVec2;

use crate::drawing::Shape;

/// The points by which a shape is moved, drawing units: ends, polyline vertices, a circle's centre.
/// An arc's are its two ends.
pub fn control_points(shape: &Shape) -> Vec<DVec2> {
    match shape {
        Shape::Line { a, b } => vec![*a, *b],
        Shape::Polyline { vertices, .. } => vertices.iter().map(|v| v.at).collect(),
        Shape::Arc { centre, radius, start_rad, end_rad } => {
            [start_rad, end_rad].map(|t| *centre + DVec2::from_angle(*t) * *radius).to_vec()
        }
        Shape::Circle { centre, .. } => vec![*centre],
    }
}

/// One of [`control_points`], by its number; a number beyond the last counts as the last.
pub fn control_point(shape: &Shape, control: u32) -> DVec2 {
    match shape {
        Shape::Line { a, b } => {
            if control == 0 {
                *a
            } else {
                *b
            }
        }
        Shape::Polyline { vertices, .. } => {
            vertices.get(control as usize).or(vertices.last()).map_or(DVec2::ZERO, |v| v.at)
        }
        Shape::Arc { .. } => control_points(shape)[(control as usize).min(1)],
        Shape::Circle { centre, .. } => *centre,
    }
}

/// Anticlockwise sweep from `start` to `end`, in (0, 2π].
pub fn sweep_rad(start: f64, end: f64) -> f64 {
    let sweep = (end - start).rem_euclid(TAU);
    if sweep == 0.0 { TAU } else { sweep }
}

/// Centre, radius, start angle and signed sweep of a bulged piece; `None` for a straight one.
pub fn bulge_arc(a: DVec2, b: DVec2, bulge: f64) -> Option<(DVec2, f64, f64, f64)> {
    let chord = b - a;
    let length = chord.length();
    if bulge.abs() < 1e-9 || length == 0.0 || !bulge.is_finite() {
        return None;
    }
    let sweep = 4.0 * bulge.atan();
    let radius = length * (1.0 + bulge * bulge) / (4.0 * bulge.abs());
    let centre = (a + b) / 2.0 + chord.perp() * ((1.0 - bulge * bulge) / (4.0 * bulge));
    if !radius.is_finite() || !centre.is_finite() {
        return None;
    }
    Some((centre, radius, (a - centre).to_angle(), sweep))
}

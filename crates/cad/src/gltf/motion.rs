//! What edits of nodes and of pieces share: motions of the plan as motions of the world, and numbers as JSON writes them.

use glam::{DAffine3, DMat3, DVec3};

use super::json::Json;
use super::record::of_record;
use crate::drawing::RigidMotion;
use crate::splice::Splice;
use enfilade_report::{Error, Place};

/// Differences of numbers below this share are rounding.
const NOISE: f64 = 1e-14;

/// An edit that cannot be made.
pub(super) fn fault(file: &str, record: usize, why: &str) -> Error {
    let place = Place::file(file).entity(format!("/nodes/{}", of_record(record).0));
    Error::input("gltf-edit", place, format!("cannot be moved: {why}; nothing was written"))
}

/// The motion of the plan as one of the world, Y up.
pub(super) fn world_motion(motion: &RigidMotion) -> DAffine3 {
    let shift = DVec3::new(motion.shift.x, 0.0, -motion.shift.y);
    DAffine3::from_mat3_translation(DMat3::from_rotation_y(motion.turn_rad), shift)
}

/// Splices of the numbers that differ.
pub(super) fn numbers(old: &Json, new: &[f64]) -> Vec<Splice> {
    let differs =
        |(j, v): &(&Json, &f64)| j.number().is_none_or(|o| (o - **v).abs() > NOISE * o.abs().max(1.0));
    old.items().iter().zip(new).filter(differs).map(|(j, v)| Splice::new(j.span.clone(), text(*v))).collect()
}

/// A number as JSON writes it.
pub(super) fn text(v: f64) -> String {
    if v == 0.0 { "0".into() } else { format!("{v:?}").trim_end_matches(".0").to_string() }
}

/// From the plan's coordinates to the world, Y up.
pub(super) fn from_plan(x: f64, y: f64, z: f64) -> DVec3 {
    z_up().inverse().transform_point3(DVec3::new(x, y, z))
}

/// Y up to Z up, as seen from above.
pub(super) fn z_up() -> DAffine3 {
    DAffine3::from_mat3(DMat3::from_cols(DVec3::X, DVec3::Z, -DVec3::Y))
}

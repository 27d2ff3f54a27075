//! Moves of nodes to bytes: a node's transform changes, the rest of the file stays.

use glam::{DAffine3, DMat3, DMat4, DQuat};

use super::instances;
use super::json::{Json, Value};
use super::motion::{fault, numbers, text, world_motion};
use super::scene::{File, Shown, local, parts};
use crate::drawing::Edit;
use crate::splice::Splice;
use enfilade_report::Error;

/// Splices of the JSON text (counted from its start) that make an edit.
pub(super) fn edit(scene: &File<'_>, shown: &[Shown], edit: &Edit) -> Result<Vec<Splice>, Error> {
    let why = |text: &str| fault(scene.name, edit.record(), text);
    let Edit::Insert { record, motion } = edit else { return Err(why("a node moves as a whole")) };
    let node = scene.json.list("nodes").get(*record).ok_or_else(|| why("no such node"))?;
    let mut places = shown.iter().filter(|s| s.node == *record);
    let (Some(place), None) = (places.next(), places.next()) else {
        return Err(why("it is not shown exactly once"));
    };
    if instances::is_many(node) {
        return Err(why(instances::WHY));
    }
    if !motion.turn_rad.is_finite() || !motion.shift.is_finite() {
        return Err(why("the motion is not finite"));
    }
    let to_parent = place.parent.inverse();
    if !to_parent.is_finite() {
        return Err(why("its parent has no size"));
    }
    let world = world_motion(motion);
    let linear = DAffine3::from_mat3(world.matrix3);
    let turn = (to_parent * linear * place.parent).matrix3;
    let turn = if motion.turn_rad == 0.0 { DMat3::IDENTITY } else { turn };
    let old = local(node);
    // The place in the parent's own coordinates: exact where nothing turns.
    let at = if motion.turn_rad == 0.0 {
        old.translation + to_parent.matrix3 * world.translation
    } else {
        to_parent.transform_point3(world.transform_point3(place.parent.transform_point3(old.translation)))
    };
    if !at.is_finite() {
        return Err(why("its new place is beyond all numbers"));
    }
    if let Some(matrix) = node.get("matrix") {
        let new = DAffine3::from_mat3_translation(turn * old.matrix3, at);
        return Ok(numbers(matrix, &DMat4::from(new).to_cols_array()));
    }
    let mut out = Vec::new();
    member(node, "translation", &at.to_array(), &mut out);
    if motion.turn_rad != 0.0 {
        let (_, rotation, _) = parts(node);
        let rotation = (DQuat::from_mat3(&turn) * rotation).normalize();
        member(node, "rotation", &rotation.to_array(), &mut out);
    }
    Ok(out)
}

fn member(node: &Json, key: &str, new: &[f64], out: &mut Vec<Splice>) {
    match node.get(key) {
        Some(old) => out.extend(numbers(old, new)),
        None => {
            let list: Vec<String> = new.iter().map(|v| text(*v)).collect();
            let empty = matches!(&node.value, Value::Object(m) if m.is_empty());
            let comma = if empty { "" } else { "," };
            let at = node.span.start + 1;
            out.push(Splice::new(at..at, format!("\"{key}\":[{}]{comma}", list.join(","))));
        }
    }
}

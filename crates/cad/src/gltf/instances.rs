//! Meshes that one node shows many times (`EXT_mesh_gpu_instancing`).

use glam::{DAffine3, DQuat, DVec3};

use super::json::{Json, Value};
use super::limits::{INSTANCES_MAX, TRIANGLES_MAX};
use super::meshes::Why;
use super::scene::File;

/// Name of the extension.
pub(super) const EXTENSION: &str = "EXT_mesh_gpu_instancing";

/// Why what such a node shows stays: a transform of the node moves all of it.
pub(super) const WHY: &str = "it is one of many instances of a node (EXT_mesh_gpu_instancing)";

/// What a node says of its instances.
fn stated(node: &Json) -> Option<&Json> {
    node.get("extensions")?.get(EXTENSION)
}

/// Whether a node shows its mesh many times.
pub(super) fn is_many(node: &Json) -> bool {
    stated(node).is_some()
}

/// What was counted of instances in a scene so far.
#[derive(Default)]
pub(super) struct Count {
    instances: usize,
    triangles: usize,
}

impl Count {
    /// Adds some of a mesh.
    ///
    /// # Errors
    /// Which limit they pass; then they are not counted.
    fn add(&mut self, instances: usize, triangles: usize) -> Result<(), String> {
        let all = self.instances.saturating_add(instances);
        if all > INSTANCES_MAX {
            return Err(format!("found {all} instances up to here, expected at most {INSTANCES_MAX}"));
        }
        let faces = self.triangles.saturating_add(instances.saturating_mul(triangles));
        if faces > TRIANGLES_MAX {
            return Err(format!(
                "found {faces} triangles of instances up to here, expected at most {TRIANGLES_MAX}"
            ));
        }
        (self.instances, self.triangles) = (all, faces);
        Ok(())
    }
}

/// Where a node shows its mesh, in its own coordinates, a mesh of so many triangles; `None` where it does so once, at itself.
///
/// # Errors
/// Where the instances cannot be read, or are too many.
pub(super) fn places(
    scene: &File<'_>,
    node: usize,
    count: &mut Count,
    triangles: usize,
) -> Result<Option<Vec<DAffine3>>, Why> {
    let Some(told) = scene.json.list("nodes").get(node).and_then(stated) else { return Ok(None) };
    let pointer = format!("/nodes/{node}/extensions/{EXTENSION}/attributes");
    let why = |text: String| (pointer.clone(), text);
    let found = told.get("attributes").filter(|a| matches!(&a.value, Value::Object(m) if !m.is_empty()));
    let attributes =
        found.ok_or_else(|| why("found none, expected TRANSLATION, ROTATION or SCALE".into()))?;
    let number = number_of(scene, attributes).map_err(why)?;
    count.add(number, triangles).map_err(why)?;
    let values = |name: &str, width: usize| {
        let accessor = attributes.index(name);
        accessor.map(|a| scene.numbers(a, width, true)).transpose()
    };
    let (shifts, turns, sizes) = (values("TRANSLATION", 3)?, values("ROTATION", 4)?, values("SCALE", 3)?);
    let vector = |list: &Option<Vec<f64>>, i: usize, none: DVec3| {
        list.as_ref().map_or(none, |l| DVec3::from_slice(&l[3 * i..]))
    };
    let turn = |i: usize| {
        let read = turns.as_ref().map(|l| DQuat::from_slice(&l[4 * i..]));
        read.filter(|q| q.length_squared() > 0.0).map_or(DQuat::IDENTITY, DQuat::normalize)
    };
    let one = |i: usize| {
        let (size, shift) = (vector(&sizes, i, DVec3::ONE), vector(&shifts, i, DVec3::ZERO));
        DAffine3::from_scale_rotation_translation(size, turn(i), shift)
    };
    Ok(Some((0..number).map(one).collect()))
}

/// How many instances there are: every attribute says so, those of programs' own too.
fn number_of(scene: &File<'_>, attributes: &Json) -> Result<usize, String> {
    let Value::Object(members) = &attributes.value else { return Err("found no attributes".into()) };
    let mut number: Option<(usize, &str)> = None;
    for (name, value) in members {
        let accessor = value.as_index().and_then(|a| scene.json.list("accessors").get(a));
        let accessor = accessor.ok_or_else(|| {
            format!("{name}: found {}, expected the number of an accessor of the file", value.words())
        })?;
        let own = accessor.index("count").ok_or_else(|| format!("{name}: its accessor has no count"))?;
        match number {
            Some((first, of)) if first != own => {
                return Err(format!("found {first} of {of} and {own} of {name}, expected as many of each"));
            }
            _ => number = Some((own, name)),
        }
    }
    number.map(|(n, _)| n).ok_or_else(|| "found no attributes".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All instances of a scene count, and their triangles; what passes a limit does not.
    #[test]
    fn instances_and_their_triangles_are_bounded_together() {
        let mut count = Count::default();
        for (instances, triangles, is_taken) in [
            (INSTANCES_MAX - 2, 12, true),
            (3, 0, false),
            (1, TRIANGLES_MAX, false),
            (usize::MAX, usize::MAX, false),
            (2, 12, true),
            (1, 0, false),
        ] {
            assert_eq!(count.add(instances, triangles).is_ok(), is_taken, "{instances} of {triangles}");
        }
    }
}

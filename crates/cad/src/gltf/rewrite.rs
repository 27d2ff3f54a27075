//! Meshes that were cut, as the file has them afterwards: in place, or beside the old one where other nodes show that too.

use super::append::Append;
use super::component::TRIANGLES;
use super::json::{Json, Value};
use super::lists::without_items;
use super::scene::File;
use super::soup::{Blob, Part, write};
use crate::splice::{self, Splice};

/// Splices of the JSON text that give a node the mesh that was cut.
///
/// # Errors
/// Why the mesh is not written.
pub(super) fn changed(
    scene: &File<'_>,
    (append, blob): (&mut Append, &mut Blob),
    node: usize,
    parts: &[Part],
) -> Result<Vec<Splice>, String> {
    let stated = scene.json.list("nodes").get(node).and_then(|n| n.get("mesh")).ok_or("it has no mesh")?;
    let index = stated.as_index().ok_or("it has no mesh")?;
    let mesh = scene.json.list("meshes").get(index).ok_or("it has no mesh")?;
    let list = mesh.get("primitives").ok_or("it has no mesh")?;
    let gone: Vec<usize> = (0..parts.len()).filter(|k| parts[*k].is_gone()).collect();
    let mut splices = without_items(list, &gone);
    for (part, primitive) in parts.iter().zip(list.items()).filter(|(p, _)| p.is_changed && !p.is_gone()) {
        splices.extend(primitive_splices(&scene.json, (append, blob), part, primitive));
    }
    if splices.is_empty() || scene.nodes_of_mesh(index) == 1 {
        return Ok(splices);
    }
    let start = mesh.span.start;
    let moved = splices.into_iter().map(|s| Splice::new(s.start - start..s.end - start, s.with)).collect();
    let text = splice::apply(scene.name, "gltf-edit-twice", &scene.text()[mesh.span.clone()], moved);
    let text = text.ok().and_then(|t| String::from_utf8(t).ok()).ok_or("its mesh is no text")?;
    let new = append.push(&scene.json, "meshes", text);
    Ok(vec![Splice::new(stated.span.clone(), new.to_string())])
}

fn primitive_splices(
    root: &Json,
    (append, blob): (&mut Append, &mut Blob),
    part: &Part,
    primitive: &Json,
) -> Vec<Splice> {
    let (accessors, indices) = write(root, append, blob, part);
    let mut out = Vec::new();
    for (attribute, accessor) in part.attributes.iter().zip(accessors) {
        let old = primitive.get("attributes").and_then(|a| a.get(&attribute.name));
        out.extend(old.map(|old| Splice::new(old.span.clone(), accessor.to_string())));
    }
    match primitive.get("indices") {
        Some(old) => out.push(Splice::new(old.span.clone(), indices.to_string())),
        None => {
            let at = primitive.span.start + 1;
            let is_empty = matches!(&primitive.value, Value::Object(m) if m.is_empty());
            let comma = if is_empty { "" } else { "," };
            out.push(Splice::new(at..at, format!("\"indices\":{indices}{comma}")));
        }
    }
    // Strips and fans have become triangles.
    let mode = primitive.get("mode").filter(|m| m.as_index() != Some(TRIANGLES));
    out.extend(mode.map(|mode| Splice::new(mode.span.clone(), TRIANGLES.to_string())));
    out
}

//! What we add to a scene: nodes of ours with unlit, coloured meshes.

use std::collections::BTreeMap;

use super::append::{Append, Home, into_scene, joined, quoted};
use super::json::{Json, Value};
use super::motion::from_plan;
use super::scene::File;
use crate::drawing::{Addition, Mark};
use crate::splice::Splice;
use enfilade_report::Error;

/// Additions lie this far above the floor, so that it does not hide them.
const LIFT_M: f64 = 0.02;

/// One mesh: corners, colours and indices.
#[derive(Default)]
struct Mesh {
    points: Vec<[f32; 3]>,
    colours: Vec<[u8; 4]>,
    triangles: Vec<u32>,
    lines: Vec<u32>,
    text: Vec<String>,
}

/// Splices of the JSON text (counted from its start), and bytes to append to the binary chunk. `floor` is in units of
/// the scene, of which one has `metres`.
///
/// # Errors
/// `gltf-dangling` where the scene names what it does not have, and ours would take that place.
pub(super) fn splices(
    scene: &File<'_>,
    floor: f64,
    metres: f64,
    own: &[Addition],
) -> Result<(Vec<Splice>, Vec<u8>), Error> {
    let root = &scene.json;
    let mut home = Home::new(scene);
    let mut by_layer: BTreeMap<&str, Mesh> = BTreeMap::new();
    for addition in own {
        collect(by_layer.entry(&addition.layer).or_default(), addition, floor + LIFT_M / metres);
    }
    let mut append = Append::default();
    let mut nodes = Vec::new();
    let material = append.next(root, "materials");
    let has_mesh = by_layer.values().any(|m| !m.points.is_empty());
    if has_mesh {
        let unlit = r#"{"name":"EF-UNLIT","pbrMetallicRoughness":{"metallicFactor":0},"extensions":{"KHR_materials_unlit":{}},"doubleSided":true}"#;
        append.push(root, "materials", unlit.into());
        let name = r#""KHR_materials_unlit""#;
        let used =
            root.list("extensionsUsed").iter().any(|e| e.value == Value::Text("KHR_materials_unlit".into()));
        if !used {
            append.push(root, "extensionsUsed", name.into());
        }
    }
    for (layer, mesh) in &by_layer {
        let at = if mesh.points.is_empty() {
            String::new()
        } else {
            format!(",\"mesh\":{}", add_mesh(root, &mut append, &mut home, layer, mesh, material))
        };
        let told = if mesh.text.is_empty() {
            String::new()
        } else {
            format!(",\"note\":{}", quoted(&mesh.text.join("\n")))
        };
        let node = format!(
            "{{\"name\":{}{at},\"extras\":{{\"enfilade\":{{\"layer\":{}{told}}}}}}}",
            quoted(layer),
            quoted(layer)
        );
        nodes.push(append.push(root, "nodes", node).to_string());
    }
    let mut out = append.splices(scene)?;
    out.extend(into_scene(root, &nodes));
    out.extend(home.stated(root));
    Ok((joined(out), home.data))
}

fn collect(mesh: &mut Mesh, addition: &Addition, height: f64) {
    let [r, g, b] = addition.rgb;
    // Vertex colours are linear in the standard; viewers turn them back.
    let colour = [linear(r), linear(g), linear(b), 255];
    let first = mesh.points.len() as u32;
    let mut put = |p: glam::DVec2| {
        // JSON knows no infinity, and a scene may lie beyond what single precision holds.
        let at = from_plan(p.x, p.y, height).as_vec3().to_array().map(|v| v.clamp(f32::MIN, f32::MAX));
        mesh.points.push(at);
        mesh.colours.push(colour);
    };
    match &addition.mark {
        Mark::Fill { corners } => {
            corners.iter().for_each(|p| put(*p));
            mesh.triangles.extend([0, 1, 2, 0, 2, 3].map(|i| first + i));
        }
        Mark::Path { points, closed } => {
            points.iter().for_each(|p| put(*p));
            let n = points.len() as u32;
            let last = if *closed { n } else { n.saturating_sub(1) };
            mesh.lines.extend((0..last).flat_map(|i| [first + i, first + (i + 1) % n]));
        }
        Mark::Text { text, .. } => mesh.text.push(text.clone()),
    }
}

fn linear(c: u8) -> u8 {
    let v = f64::from(c) / 255.0;
    let v = if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) };
    (v * 255.0).round() as u8
}

fn add_mesh(
    root: &Json,
    append: &mut Append,
    home: &mut Home,
    layer: &str,
    mesh: &Mesh,
    material: usize,
) -> usize {
    let mut data: Vec<u8> = mesh.points.iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
    let colours_at = data.len();
    data.extend(mesh.colours.iter().flatten());
    let triangles_at = data.len();
    data.extend(mesh.triangles.iter().flat_map(|v| v.to_le_bytes()));
    let lines_at = data.len();
    data.extend(mesh.lines.iter().flat_map(|v| v.to_le_bytes()));
    let (buffer, start) = home.take(root, append, layer, &data);
    let n = mesh.points.len();
    let view = |append: &mut Append, from: usize, to: usize, target: u32| {
        let text = format!(
            "{{\"buffer\":{buffer},\"byteOffset\":{},\"byteLength\":{},\"target\":{target}}}",
            start + from,
            to - from
        );
        append.push(root, "bufferViews", text)
    };
    let points = view(append, 0, colours_at, 34962);
    let colours = view(append, colours_at, triangles_at, 34962);
    let bound = |pick: fn(f32, f32) -> f32, start: f32| {
        let fold = mesh
            .points
            .iter()
            .fold([start; 3], |m, p| [pick(m[0], p[0]), pick(m[1], p[1]), pick(m[2], p[2])]);
        fold.map(|v| format!("{v:?}")).join(",")
    };
    let (lo, hi) = (bound(f32::min, f32::INFINITY), bound(f32::max, f32::NEG_INFINITY));
    let position = append.push(
        root,
        "accessors",
        format!("{{\"bufferView\":{points},\"componentType\":5126,\"count\":{n},\"type\":\"VEC3\",\"min\":[{lo}],\"max\":[{hi}]}}"),
    );
    let colour = append.push(
        root,
        "accessors",
        format!("{{\"bufferView\":{colours},\"componentType\":5121,\"normalized\":true,\"count\":{n},\"type\":\"VEC4\"}}"),
    );
    let mut primitives = Vec::new();
    for (list, mode, from) in [(&mesh.triangles, 4, triangles_at), (&mesh.lines, 1, lines_at)] {
        if list.is_empty() {
            continue;
        }
        let of = view(append, from, from + 4 * list.len(), 34963);
        let indices = append.push(
            root,
            "accessors",
            format!(
                "{{\"bufferView\":{of},\"componentType\":5125,\"count\":{},\"type\":\"SCALAR\"}}",
                list.len()
            ),
        );
        primitives.push(format!(
            "{{\"attributes\":{{\"POSITION\":{position},\"COLOR_0\":{colour}}},\"indices\":{indices},\"material\":{material},\"mode\":{mode}}}"
        ));
    }
    append.push(
        root,
        "meshes",
        format!("{{\"name\":{},\"primitives\":[{}]}}", quoted(layer), primitives.join(",")),
    )
}

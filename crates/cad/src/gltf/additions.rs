//! What we add to a scene: nodes of ours with unlit, coloured meshes.

use std::collections::BTreeMap;

use base64::Engine;

use super::dangling::{reaches_beyond, taken};
use super::glb::fault;
use super::json::{Json, Value};
use super::motion::from_plan;
use super::scene::File;
use crate::drawing::{Addition, Mark};
use crate::splice::Splice;
use enfilade_report::Error;

/// Additions lie this far above the floor, so that it does not hide them.
const LIFT_M: f64 = 0.02;

/// Items to append to arrays of the root.
#[derive(Default)]
struct Append(BTreeMap<&'static str, Vec<String>>);

impl Append {
    /// Index that the next item of an array gets.
    fn next(&self, root: &Json, key: &'static str) -> usize {
        root.list(key).len() + self.0.get(key).map_or(0, Vec::len)
    }

    fn push(&mut self, root: &Json, key: &'static str, item: String) -> usize {
        let index = self.next(root, key);
        self.0.entry(key).or_default().push(item);
        index
    }
}

/// One mesh: corners, colours and indices.
#[derive(Default)]
struct Mesh {
    points: Vec<[f32; 3]>,
    colours: Vec<[u8; 4]>,
    triangles: Vec<u32>,
    lines: Vec<u32>,
    text: Vec<String>,
}

/// Where the data of our meshes goes: to the end of the binary chunk, else into a buffer of its own as text.
struct Home {
    /// Bytes that the binary chunk has.
    bin: Option<usize>,
    /// Bytes to append to it.
    data: Vec<u8>,
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
    let bin = scene.bin().map(<[u8]>::len).filter(|n| n % 4 == 0 && !reaches_beyond(root, *n));
    let mut home = Home { bin, data: Vec::new() };
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
    for (list, items) in &append.0 {
        if let Some(index) = taken(root, list, items.len()) {
            let text = "the scene names it and does not have it, and what is added would take its place";
            return Err(fault(scene.name, "gltf-dangling", &format!("/{list}/{index}"), text));
        }
    }
    let mut out: Vec<Splice> = append.0.iter().map(|(key, items)| into_array(root, key, items)).collect();
    out.extend(into_scene(root, &nodes));
    out.extend(home.stated(root));
    Ok((joined(out), home.data))
}

impl Home {
    /// Takes a mesh's data; the buffer it lies in, and from where on.
    fn take(&mut self, root: &Json, append: &mut Append, layer: &str, data: &[u8]) -> (usize, usize) {
        if let Some(bin) = self.bin {
            self.data.extend_from_slice(data);
            return (0, bin + self.data.len() - data.len());
        }
        let text = base64::engine::general_purpose::STANDARD.encode(data);
        let buffer = format!(
            "{{\"name\":{},\"byteLength\":{},\"uri\":\"data:application/octet-stream;base64,{text}\"}}",
            quoted(layer),
            data.len()
        );
        (append.push(root, "buffers", buffer), 0)
    }

    /// The new length of the first buffer.
    fn stated(&self, root: &Json) -> Option<Splice> {
        let length = self.bin.filter(|_| !self.data.is_empty())? + self.data.len();
        let old = root.list("buffers").first()?.get("byteLength")?;
        Some(Splice::new(old.span.clone(), length.to_string()))
    }
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

fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

/// Puts items at the end of an array of the root; makes the array where there is none.
fn into_array(root: &Json, key: &str, items: &[String]) -> Splice {
    match root.get(key) {
        Some(array) => {
            let at = array.items().last().map_or(array.span.start + 1, |last| last.span.end);
            let comma = if array.items().is_empty() { "" } else { "," };
            Splice::new(at..at, format!("{comma}{}", items.join(",")))
        }
        None => {
            let at = root.span.start + 1;
            Splice::new(at..at, format!("\"{key}\":[{}],", items.join(",")))
        }
    }
}

/// Shows the nodes in the scene.
fn into_scene(root: &Json, nodes: &[String]) -> Option<Splice> {
    let scene = root.list("scenes").get(root.index("scene").unwrap_or(0))?;
    // In a damaged scene that is none, or whose nodes are no list, nothing can be shown.
    if !matches!(scene.value, Value::Object(_)) {
        return None;
    }
    Some(match scene.get("nodes") {
        Some(list) if !matches!(list.value, Value::Array(_)) => return None,
        Some(list) => {
            let at = list.items().last().map_or(list.span.start + 1, |last| last.span.end);
            let comma = if list.items().is_empty() { "" } else { "," };
            Splice::new(at..at, format!("{comma}{}", nodes.join(",")))
        }
        None => {
            let at = scene.span.start + 1;
            let comma = if matches!(&scene.value, Value::Object(m) if m.is_empty()) { "" } else { "," };
            Splice::new(at..at, format!("\"nodes\":[{}]{comma}", nodes.join(",")))
        }
    })
}

/// Splices at one place made one, in their order.
fn joined(list: Vec<Splice>) -> Vec<Splice> {
    let mut out: Vec<Splice> = Vec::new();
    for splice in list {
        match out.iter_mut().find(|s| s.start == splice.start && s.end == splice.end) {
            Some(same) => same.with.extend(splice.with),
            None => out.push(splice),
        }
    }
    out
}

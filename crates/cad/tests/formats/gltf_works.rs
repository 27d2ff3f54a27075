//! Building works in a scene: solids stay closed, vertices keep what they carry, the rest of the file keeps its bytes.

use std::collections::BTreeMap;
use std::sync::Arc;

use base64::Engine;
use enfilade_cad::bearing::Bearing;
use enfilade_cad::drawing::{Drawing, Edit, EntityWork, Filling, Shape, Vertex};
use enfilade_cad::{ReadOptions, patch, read};
use enfilade_report::Report;
use glam::{DVec2, DVec3};
use serde_json::{Value, json};

/// Corners, and what each carries: its height as colour, its place along the wall as place in a picture.
struct Solid {
    corners: Vec<[f32; 3]>,
    indices: Vec<u16>,
}

/// Boxes in one mesh, faces outward: least corner and size, Y up.
fn boxes(all: &[[[f32; 3]; 2]]) -> Solid {
    let (mut corners, mut indices) = (Vec::new(), Vec::new());
    for [at, size] in all {
        let first = corners.len() as u16;
        for k in 0..8u16 {
            let on = |axis: usize| if k >> axis & 1 == 1 { at[axis] + size[axis] } else { at[axis] };
            corners.push([on(0), on(1), on(2)]);
        }
        let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        indices.extend(faces.iter().flat_map(|[a, b, c, d]| [a, b, c, a, c, d].map(|i| i + first)));
    }
    Solid { corners, indices }
}

/// What a scene's data has become.
#[derive(Default)]
struct Data {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Data {
    fn add(&mut self, bytes: &[u8], mut accessor: Value) -> usize {
        self.views.push(json!({"buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len()}));
        self.bytes.extend_from_slice(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        accessor["bufferView"] = json!(self.views.len() - 1);
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    /// A primitive of a solid, with normals, colours and places in a picture.
    fn primitive(&mut self, of: &Solid) -> Value {
        let n = of.corners.len();
        let floats = |values: Vec<f32>| values.iter().flat_map(|v| v.to_le_bytes()).collect::<Vec<u8>>();
        let bound = |pick: fn(f32, f32) -> f32| {
            [0, 1, 2].map(|k| of.corners.iter().map(|p| p[k]).reduce(pick).unwrap())
        };
        let vec = |kind: &str| json!({"componentType": 5126, "count": n, "type": kind});
        let mut place = vec("VEC3");
        (place["min"], place["max"]) = (json!(bound(f32::min)), json!(bound(f32::max)));
        let at = self.add(&floats(of.corners.concat()), place);
        let normal = self.add(&floats([0f32, 1.0, 0.0].repeat(n)), vec("VEC3"));
        let picture = self.add(&floats(of.corners.iter().flat_map(|p| [p[0], p[1]]).collect()), vec("VEC2"));
        let colours: Vec<u8> = of.corners.iter().flat_map(|p| [(p[1] * 80.0) as u8, 7, 9, 0]).collect();
        let colour = json!({"componentType": 5121, "normalized": true, "count": n, "type": "VEC4"});
        let colour = self.add(&colours, colour);
        let list: Vec<u8> = of.indices.iter().flat_map(|i| i.to_le_bytes()).collect();
        let accessor = json!({"componentType": 5123, "count": of.indices.len(), "type": "SCALAR"});
        let indices = self.add(&list, accessor);
        let attributes = json!({"POSITION": at, "NORMAL": normal, "TEXCOORD_0": picture, "COLOR_0": colour});
        json!({"attributes": attributes, "indices": indices, "material": 0})
    }

    fn scene(self, meshes: Value, nodes: Value, roots: Value) -> (Value, Vec<u8>) {
        let json = json!({
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": roots}], "nodes": nodes, "meshes": meshes,
            "materials": [{"name": "Plaster", "extras": {"kept": 1.50}}], "accessors": self.accessors,
            "bufferViews": self.views, "buffers": [{"byteLength": self.bytes.len()}],
        });
        (json, self.bytes)
    }
}

fn glb((json, data): &(Value, Vec<u8>)) -> Vec<u8> {
    let mut text = json.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut out = b"glTF".to_vec();
    let total = 28 + text.len() + data.len();
    [2, total as u32, text.len() as u32, 0x4E4F_534A].iter().for_each(|w: &u32| out.extend(w.to_le_bytes()));
    out.extend(text);
    [data.len() as u32, 0x004E_4942].iter().for_each(|w: &u32| out.extend(w.to_le_bytes()));
    out.extend(data);
    out
}

/// JSON and the data of all buffers.
///
/// The `gltf` crate takes it too.
fn opened(bytes: &[u8], beside: &[u8]) -> (Value, Vec<Vec<u8>>) {
    gltf::Gltf::from_slice(bytes).unwrap();
    let (text, bin) = if bytes.starts_with(b"glTF") {
        let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
        (&bytes[20..20 + length], &bytes[28 + length..])
    } else {
        (bytes, beside)
    };
    let json: Value = serde_json::from_slice(text).unwrap();
    let of = |b: &Value| match b["uri"].as_str().and_then(|u| u.split_once(";base64,")) {
        Some((_, data)) => base64::engine::general_purpose::STANDARD.decode(data).unwrap(),
        None => bin.to_vec(),
    };
    let buffers = json["buffers"].as_array().unwrap().iter().map(of).collect();
    (json, buffers)
}

fn index(v: &Value) -> usize {
    v.as_u64().unwrap() as usize
}

/// Values of an accessor; whole numbers as they are.
fn values((json, buffers): &(Value, Vec<Vec<u8>>), accessor: &Value) -> Vec<Vec<f64>> {
    let a = &json["accessors"][index(accessor)];
    let view = &json["bufferViews"][index(&a["bufferView"])];
    let width = ["SCALAR", "VEC2", "VEC3", "VEC4"].iter().position(|t| *t == a["type"]).unwrap() + 1;
    let size = match index(&a["componentType"]) {
        5121 => 1,
        5123 => 2,
        _ => 4,
    };
    let stride = view["byteStride"].as_u64().map_or(size * width, |s| s as usize);
    let start = view["byteOffset"].as_u64().unwrap_or(0) + a["byteOffset"].as_u64().unwrap_or(0);
    let data = &buffers[index(&view["buffer"])][start as usize..];
    let one = |b: &[u8]| match index(&a["componentType"]) {
        5121 => f64::from(b[0]),
        5123 => f64::from(u16::from_le_bytes([b[0], b[1]])),
        5125 => f64::from(u32::from_le_bytes(b[..4].try_into().unwrap())),
        _ => f64::from(f32::from_le_bytes(b[..4].try_into().unwrap())),
    };
    let vertex = |i: usize| (0..width).map(|k| one(&data[i * stride + k * size..])).collect();
    (0..index(&a["count"])).map(vertex).collect()
}

/// Volume of a mesh, and how far its faces are from closing.
fn volume(scene: &(Value, Vec<Vec<u8>>), mesh: usize) -> [f64; 2] {
    let (mut volume, mut open) = (0.0, DVec3::ZERO);
    for primitive in scene.0["meshes"][mesh]["primitives"].as_array().unwrap() {
        let at = values(scene, &primitive["attributes"]["POSITION"]);
        let at: Vec<DVec3> = at.iter().map(|p| DVec3::from_slice(p)).collect();
        let corners: Vec<usize> = match primitive.get("indices") {
            Some(list) => values(scene, list).iter().map(|i| i[0] as usize).collect(),
            None => (0..at.len()).collect(),
        };
        for c in corners.chunks_exact(3) {
            let [a, b, c] = [0, 1, 2].map(|k| at[c[k]]);
            volume += a.dot(b.cross(c)) / 6.0;
            open += (b - a).cross(c - a) / 2.0;
        }
    }
    [volume, open.length()]
}

fn read_as(file: &str, bytes: &[u8], options: &ReadOptions) -> Drawing {
    let mut report = Report::default();
    let drawing = read(file, bytes, options, &mut report).unwrap();
    let marks: Vec<_> = report.problems.iter().filter(|p| p.code == "gltf-marks").collect();
    assert!(marks.is_empty(), "{marks:?}");
    drawing
}

fn made(bytes: &[u8], edits: &[Edit]) -> Vec<u8> {
    patch("a.glb", bytes, &ReadOptions::default(), edits, &[]).unwrap()
}

fn work(record: usize, work: EntityWork) -> Edit {
    Edit::Work { record, work }
}

/// A stretch of the wall from the origin along x, 0.2 m thick, with its cover.
fn stretch(from: f64, to: f64) -> [DVec2; 4] {
    [[from, -0.02], [to, -0.02], [to, 0.22], [from, 0.22]].map(DVec2::from)
}

fn void(record: usize, filling: Filling) -> Edit {
    work(record, EntityWork::Void { gone: stretch(2.0, 3.0), filling })
}

fn ring(corners: [DVec2; 4]) -> Shape {
    let vertices = corners.iter().map(|at| Vertex { at: *at, bulge: 0.0 }).collect();
    Shape::Polyline { vertices, closed: true }
}

/// A wall of 5 m along x, and what else its mesh holds.
fn wall(more: &[[[f32; 3]; 2]]) -> Solid {
    boxes(&[&[[[0.0, 0.0, -0.2], [5.0, 2.8, 0.2]]], more].concat())
}

/// One wall, and another below the same parent.
fn house() -> (Value, Vec<u8>) {
    let mut data = Data::default();
    let (one, two) =
        (data.primitive(&wall(&[])), data.primitive(&boxes(&[[[0.0, 0.0, -4.0], [0.2, 2.8, 3.8]]])));
    let meshes = json!([{"name": "one", "primitives": [one]}, {"name": "two", "primitives": [two]}]);
    let nodes = json!([{"name": "Wall south", "mesh": 0}, {"name": "Wall west", "mesh": 1, "extras": {"a": 1}},
        {"name": "Ground floor", "children": [0, 1], "translation": [0.0, 0.0, 0.0]}]);
    data.scene(meshes, nodes, json!([2]))
}

/// Outlines of a layer, each by its box.
fn outlines(drawing: &Drawing, layer: &str) -> Vec<[[i64; 2]; 2]> {
    let box_of = |shape: &Shape| {
        let points = enfilade_cad::curve::control_points(shape);
        let [lo, hi] = enfilade_cad::plane::box_of(points.into_iter()).unwrap();
        [lo, hi].map(|p| [p.x, p.y].map(|v| (v * 1000.0).round() as i64))
    };
    let mut out: Vec<_> =
        drawing.entities.iter().filter(|e| e.layer == layer).map(|e| box_of(&e.shape)).collect();
    out.sort_unstable();
    out
}

/// Every member of the old JSON that no path of `but` begins is in the new one, and lists have only grown.
fn only(old: &Value, new: &Value, path: &str, but: &[&str]) {
    if but.iter().any(|b| path.starts_with(b)) {
        return;
    }
    match (old, new) {
        (Value::Object(a), Value::Object(b)) => {
            a.iter()
                .for_each(|(k, v)| only(v, b.get(k).unwrap_or(&Value::Null), &format!("{path}/{k}"), but));
        }
        (Value::Array(a), Value::Array(b)) => {
            assert!(a.len() <= b.len(), "{path}");
            a.iter().zip(b).enumerate().for_each(|(i, (a, b))| only(a, b, &format!("{path}/{i}"), but));
        }
        _ => assert_eq!(old, new, "{path}"),
    }
}

/// An opening, its head, its reveals; what is not in it keeps its numbers to the bit.
#[test]
fn a_solid_stays_closed_and_its_vertices_keep_what_they_carry() {
    let bytes = glb(&house());
    let before = opened(&bytes, &[]);
    for (filling, gone_m3) in [
        (Filling::Nothing, 0.2 * 2.1),
        (Filling::Gone, 0.2 * 2.8),
        (Filling::Door, 0.2 * 2.1),
        (Filling::Glass, 0.2 * 2.1),
    ] {
        let written = made(&bytes, &[void(0, filling)]);
        let after = opened(&written, &[]);
        let [volume_m3, open] = volume(&after, 0);
        assert!((volume_m3 - (5.0 * 0.2 * 2.8 - gone_m3)).abs() < 1e-5, "{filling:?} {volume_m3}");
        assert!(open < 1e-5, "{filling:?} {open}");
        let more = ["/meshes/0/primitives/0", "/buffers/0/byteLength"];
        let parent = ["/nodes/2/children"];
        only(&before.0, &after.0, "", &[&more[..], &parent[..]].concat());
        let has_box = matches!(filling, Filling::Door | Filling::Glass);
        assert_eq!(after.0["nodes"].as_array().unwrap().len(), 3 + usize::from(has_box));
        assert_eq!(after.1[0][..before.1[0].len()], before.1[0][..], "old data stays in place");
        let attributes = &after.0["meshes"][0]["primitives"][0]["attributes"];
        let of = |name: &str| values(&after, &attributes[name]);
        let (at, normals, pictures, colours) =
            (of("POSITION"), of("NORMAL"), of("TEXCOORD_0"), of("COLOR_0"));
        for (k, p) in at.iter().enumerate() {
            assert!((p[0] - pictures[k][0]).abs() < 1e-5 && (p[1] - pictures[k][1]).abs() < 1e-5, "{p:?}");
            assert!(
                (colours[k][0] - (p[1] * 80.0)).abs() <= 1.0 && colours[k][1..] == [7.0, 9.0, 0.0],
                "{p:?}"
            );
            assert!((DVec3::from_slice(&normals[k]).length() - 1.0).abs() < 1e-6);
        }
        // Reveals look into the opening: one jamb east, one west.
        let looks = |x: f64| normals.iter().filter(|n| n[0] == x).count();
        let (east, west) = (looks(1.0), looks(-1.0));
        assert!(east >= 4 && east == west, "{filling:?} {east} {west}");
        let drawing = read_as("a.glb", &written, &ReadOptions::default());
        let walls = [[[0, 0], [2000, 200]], [[0, 200], [200, 4000]], [[3000, 0], [5000, 200]]];
        assert_eq!(outlines(&drawing, "Wall south").len() + outlines(&drawing, "Wall west").len(), 3);
        let all = [outlines(&drawing, "Wall south"), outlines(&drawing, "Wall west")].concat();
        assert!(all.iter().all(|o| walls.contains(o)), "{all:?}");
        let boxes = [outlines(&drawing, "IfcDoor"), outlines(&drawing, "IfcWindow")].concat();
        assert_eq!(boxes, if has_box { vec![[[2000, 80], [3000, 120]]] } else { Vec::new() });
    }
}

/// A text with its data beside it or in it gets a buffer of its own.
#[test]
fn a_text_keeps_its_bytes_and_its_data() {
    let (mut json, data) = house();
    json["buffers"][0]["uri"] = json!("a.bin");
    let text = serde_json::to_string_pretty(&json).unwrap();
    let buffers: BTreeMap<String, Arc<[u8]>> = [("a.bin".to_string(), Arc::from(&data[..]))].into();
    let options = ReadOptions { buffers, ..ReadOptions::default() };
    let edits = [void(0, Filling::Door), work(1, EntityWork::Drop)];
    let written = patch("a.gltf", text.as_bytes(), &options, &edits, &[]).unwrap();
    let after = opened(&written, &data);
    assert_eq!(after.1.len(), 2);
    let [volume_m3, open] = volume(&after, 0);
    assert!((volume_m3 - (2.8 - 0.42)).abs() < 1e-5 && open < 1e-5);
    // Every line that no work changes stands as it stood.
    let new = String::from_utf8(written.clone()).unwrap();
    let lost = text.lines().filter(|l| !new.contains(*l)).count();
    assert!(lost <= 12, "{lost} lines: {new}");
    let drawing = read_as("a.gltf", &written, &options);
    assert!(outlines(&drawing, "Wall west").is_empty());
    assert_eq!(outlines(&drawing, "IfcDoor").len(), 1);
}

/// One mesh that two nodes show: the other one shows what it did. Mirrored ones have their reveals the right way round.
#[test]
fn a_shared_mesh_is_cut_for_one_node_alone() {
    let mut data = Data::default();
    let one = data.primitive(&wall(&[]));
    let nodes = json!([{"name": "Wall a", "mesh": 0}, {"name": "Wall b", "mesh": 0, "translation": [0, 0, -6]},
        {"name": "Wall c", "mesh": 0, "scale": [-1, 1, 1], "translation": [5, 0, -9]}]);
    let bytes = glb(&data.scene(json!([{"name": "one", "primitives": [one]}]), nodes, json!([0, 1, 2])));
    let before = opened(&bytes, &[]);
    let over = |y: f64| stretch(2.0, 3.0).map(|p| p + DVec2::new(0.0, y));
    for (node, y) in [(0, 0.0), (1, 6.0), (2, 9.0)] {
        let gone = over(y);
        let cut = work(node, EntityWork::Void { gone, filling: Filling::Nothing });
        let written = made(&bytes, &[cut]);
        let after = opened(&written, &[]);
        only(&before.0, &after.0, "", &[&format!("/nodes/{node}/mesh"), "/buffers/0/byteLength"]);
        assert_eq!(after.0["nodes"][node]["mesh"], 1);
        assert_eq!(volume(&after, 0), volume(&before, 0));
        let [volume_m3, open] = volume(&after, 1);
        assert!((volume_m3 - (2.8 - 0.42)).abs() < 1e-5 && open < 1e-5, "{node}: {volume_m3} {open}");
        // All three are cut in the plan at their own places.
        let drawing = read_as("a.glb", &written, &ReadOptions::default());
        assert_eq!(drawing.entities.len(), 4);
    }
}

/// A mesh of many walls: the one is cut, the others keep every corner; a piece leaves it by its faces.
#[test]
fn a_mesh_of_many_walls_is_cut_in_one_of_them() {
    let others = [
        [[0.0, 0.0, -4.0], [0.2, 2.8, 3.7]],
        [[2.4, 0.0, -4.0], [0.2, 2.8, 3.7]],
        [[0.0, 0.0, -9.0], [5.0, 2.8, 0.2]],
    ];
    let mut data = Data::default();
    let all = data.primitive(&wall(&others));
    let (json, bin) =
        data.scene(json!([{"primitives": [all]}]), json!([{"name": "walls", "mesh": 0}]), json!([0]));
    let bytes = glb(&(json, bin));
    let before = read_as("a.glb", &bytes, &ReadOptions::default());
    assert_eq!(before.entities.len(), 4);
    let record = |y: f64| {
        let is = |e: &&enfilade_cad::drawing::Entity| {
            let points = enfilade_cad::curve::control_points(&e.shape);
            points.iter().all(|p| (p.y - y).abs() <= 0.21)
        };
        before.entities.iter().find(is).unwrap().source.record
    };
    let written = made(&bytes, &[void(record(0.0), Filling::Nothing), work(record(9.0), EntityWork::Drop)]);
    let [volume_m3, open] = volume(&opened(&written, &[]), 0);
    let whole = 2.8 * (1.0 + 2.0 * 3.7 * 0.2);
    assert!((volume_m3 - (whole - 0.42)).abs() < 1e-5 && open < 1e-5, "{volume_m3} {whole}");
    let after = read_as("a.glb", &written, &ReadOptions::default());
    let expected = [
        [[0, 0], [2000, 200]],
        [[0, 300], [200, 4000]],
        [[2400, 300], [2600, 4000]],
        [[3000, 0], [5000, 200]],
    ];
    assert_eq!(outlines(&after, "walls"), expected);
}

/// What goes leaves its list, says so, and comes back by hand.
#[test]
fn what_is_demolished_leaves_the_scene_and_can_come_back() {
    let bytes = glb(&house());
    let before = read_as("a.glb", &bytes, &ReadOptions::default());
    let written = made(&bytes, &[work(1, EntityWork::Drop)]);
    let after = opened(&written, &[]);
    assert_eq!(after.0["nodes"][2]["children"], json!([0]));
    let said = json!({"enfilade": {"status": "demolish", "note": "hung in /nodes/2/children"}, "a": 1});
    assert_eq!(after.0["nodes"][1]["extras"], said);
    assert!(outlines(&read_as("a.glb", &written, &ReadOptions::default()), "Wall west").is_empty());
    // Back in its list it is drawn as demolished; without the word it is a wall.
    let (mut json, data) = (after.0, after.1[0].clone());
    json["nodes"][2]["children"] = json!([0, 1]);
    let gone = read_as("a.glb", &glb(&(json.clone(), data.clone())), &ReadOptions::default());
    assert_eq!((outlines(&gone, "Wall west").len(), outlines(&gone, "EF-DEMOLISHED").len()), (0, 1));
    json["nodes"][1]["extras"]["enfilade"] = json!({});
    let back = read_as("a.glb", &glb(&(json, data)), &ReadOptions::default());
    assert_eq!(back.entities, before.entities);
    // The last one takes its list with it.
    let none = opened(&made(&bytes, &[work(0, EntityWork::Drop), work(1, EntityWork::Drop)]), &[]);
    assert_eq!(none.0["nodes"][2].get("children"), None);
}

/// A partition as high as its like, of its material; in the gap of a door only up to its head.
#[test]
fn what_is_built_stands_like_its_neighbour() {
    let bytes = glb(&house());
    let new = ring([[1.0, 0.2], [1.1, 0.2], [1.1, 3.0], [1.0, 3.0]].map(DVec2::from));
    let written = made(&bytes, &[work(0, EntityWork::Build { shapes: vec![new] })]);
    let after = opened(&written, &[]);
    let [volume_m3, open] = volume(&after, 2);
    assert!((volume_m3 - 0.1 * 2.8 * 2.8).abs() < 1e-5 && open < 1e-5, "{volume_m3}");
    assert_eq!(after.0["meshes"][2]["primitives"][0]["material"], 0);
    assert_eq!(after.0["nodes"][2]["children"], json!([0, 1, 3]));
    let drawing = read_as("a.glb", &written, &ReadOptions::default());
    assert!(outlines(&drawing, "Wall south").contains(&[[1000, 200], [1100, 3000]]), "{drawing:?}");
    assert_eq!(drawing.built.len(), 1);
    let opened_up = made(&bytes, &[void(0, Filling::Door)]);
    let closed = ring([[2.0, 0.0], [3.0, 0.0], [3.0, 0.2], [2.0, 0.2]].map(DVec2::from));
    let closed = made(&opened_up, &[work(0, EntityWork::Build { shapes: vec![closed] })]);
    let after = opened(&closed, &[]);
    let [volume_m3, _] = volume(&after, 3);
    assert!((volume_m3 - 0.2 * 2.1).abs() < 1e-5, "{volume_m3}");
    assert_eq!(after.0["nodes"][3]["extras"]["enfilade"]["status"], "demolish", "the leaf goes");
}

type Change<'c> = &'c dyn Fn(&mut Value);

/// What is packed, or changes its shape, is not cut.
#[test]
fn what_cannot_be_cut_is_said() {
    let refused = |change: Change<'_>| {
        let (mut json, data) = house();
        change(&mut json);
        let bytes = glb(&(json, data));
        let result = patch("a.glb", &bytes, &ReadOptions::default(), &[void(0, Filling::Nothing)], &[]);
        result.unwrap_err().to_string()
    };
    let cases: [(Change<'_>, &str); 5] = [
        (&|j| j["meshes"][0]["primitives"][0]["targets"] = json!([{"POSITION": 0}]), "changes its shape"),
        (&|j| j["nodes"][0]["skin"] = json!(0), "skeleton"),
        (&|j| j["bufferViews"][0]["extensions"] = json!({"EXT_meshopt_compression": {}}), "packed"),
        (
            &|j| j["meshes"][0]["primitives"][0]["extensions"] = json!({"KHR_draco_mesh_compression": {}}),
            "draco",
        ),
        (&|j| j["animations"] = json!([{"channels": [{"target": {"node": 0}}]}]), "animated"),
    ];
    for (change, words) in cases {
        let said = refused(change);
        assert!(said.contains(words), "{said}");
    }
    let (json, data) = house();
    let away = work(0, EntityWork::Void { gone: stretch(7.0, 8.0), filling: Filling::Nothing });
    let refused = patch("a.glb", &glb(&(json, data)), &ReadOptions::default(), &[away], &[]);
    assert!(refused.unwrap_err().to_string().contains("no wall of its mesh stands there"));
}

/// A room that is one solid shows a face where a thin wall would stand: what is cut into that is a niche and no opening.
#[test]
fn a_cut_that_does_not_go_through_is_said() {
    let mut data = Data::default();
    let hull = data.primitive(&boxes(&[[[0.0, 0.0, -3.0], [5.0, 2.8, 3.0]]]));
    let meshes = json!([{"name": "hull", "primitives": [hull]}]);
    let hull = data.scene(meshes, json!([{"name": "Cube", "mesh": 0}]), json!([0]));
    for filling in [Filling::Nothing, Filling::Gone] {
        let refused = patch("a.glb", &glb(&hull), &ReadOptions::default(), &[void(0, filling)], &[]);
        assert!(refused.unwrap_err().to_string().contains("goes on beside the stretch"));
    }
}

/// A node, or one above it, says that its walls carry, however the program that wrote it writes flags.
#[test]
fn walls_that_carry_are_told_by_extras() {
    let bearing = |node: usize, extras: Value| {
        let (mut json, data) = house();
        json["nodes"][node]["extras"] = extras;
        read_as("a.glb", &glb(&(json, data)), &ReadOptions::default()).bearing
    };
    for yes in [json!(true), json!(1), json!("T"), json!("true")] {
        let found = bearing(0, json!({"LoadBearing": yes}));
        assert_eq!(found.into_iter().collect::<Vec<_>>(), [(0, Bearing::Stated)]);
    }
    for no in [json!(false), json!(0), json!("F"), json!(null)] {
        assert!(bearing(0, json!({"LoadBearing": no})).is_empty());
    }
    assert_eq!(bearing(2, json!({"LoadBearing": true})).len(), 2, "all that hangs on it");
    assert_eq!(bearing(1, json!({"FireRating": "REI 90"})).get(&1), Some(&Bearing::Fire));
}

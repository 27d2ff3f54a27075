//! glTF both ways: what is read of a small building, what a move changes, what is refused and in which words.

#![allow(clippy::unwrap_used)]

#[path = "gltf/pieces.rs"]
mod pieces;

use std::sync::Arc;

use base64::Engine;
use enfilade_cad::drawing::{Addition, Drawing, Edit, Entity, Mark, RigidMotion, Shape, Unit};
use enfilade_cad::{Completeness, ReadOptions};
use enfilade_report::{Error, Report, Severity};
use glam::DVec2;
use proptest::prelude::*;

const PAVILION: &[u8] = include_bytes!("../../../../samples/pavilion.glb");

fn read_as(file: &str, bytes: &[u8]) -> (Result<Drawing, Error>, Report) {
    let mut report = Report::default();
    (enfilade_cad::read(file, bytes, &ReadOptions::default(), &mut report), report)
}

fn read(bytes: &[u8]) -> Drawing {
    read_as("house.glb", bytes).0.unwrap()
}

fn patch(bytes: &[u8], edits: &[Edit], own: &[Addition]) -> Result<Vec<u8>, Error> {
    enfilade_cad::patch("house.glb", bytes, &ReadOptions::default(), edits, own)
}

fn points(e: &Entity) -> Vec<DVec2> {
    let Shape::Polyline { vertices, .. } = &e.shape else { return Vec::new() };
    vertices.iter().map(|v| v.at).collect()
}

fn u32_at(bytes: &[u8], at: usize) -> usize {
    u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize
}

/// JSON and binary data of the sample.
fn parts() -> (String, Vec<u8>) {
    let len = u32_at(PAVILION, 12);
    let json = String::from_utf8(PAVILION[20..20 + len].to_vec()).unwrap();
    (json, PAVILION[28 + len..].to_vec())
}

/// The sample as one text, its data embedded.
fn embedded() -> String {
    let (json, data) = parts();
    let text = base64::engine::general_purpose::STANDARD.encode(&data);
    json.replace(
        "\"buffers\":[{",
        &format!("\"buffers\":[{{\"uri\":\"data:application/octet-stream;base64,{text}\","),
    )
}

fn node(name: &str) -> usize {
    let json: serde_json::Value = serde_json::from_str(&parts().0).unwrap();
    json["nodes"].as_array().unwrap().iter().position(|n| n["name"] == name).unwrap()
}

#[test]
fn the_ground_floor_of_the_sample() {
    let (drawing, report) = read_as("house.glb", PAVILION);
    let drawing = drawing.unwrap();
    assert!(!report.is_degraded(), "{report:?}");
    let on = |layer: &str| drawing.entities.iter().filter(|e| e.layer == layer).count();
    assert_eq!((on("IfcWall"), on("IfcColumn"), on("IfcSpace"), on("EF-QUERY")), (21, 2, 2, 1));
    let marked: Vec<&str> = drawing.marked.iter().map(|m| m.name.as_str()).collect();
    assert_eq!(marked, ["cloakroom", "screen-1", "screen-2", "screen-3", "screen-4"]);
    assert_eq!(drawing.texts.iter().map(|t| t.text.as_str()).collect::<Vec<_>>(), ["Foyer", "Gallery"]);
    let text = read_as("house.gltf", embedded().as_bytes()).0.unwrap();
    assert_eq!(text.entities, drawing.entities);
}

#[test]
fn classes_and_storeys_come_from_the_ifc_beside_it() {
    let twin: &[u8] = include_bytes!("../../../../samples/pavilion.ifc");
    let (mut json, data) = parts();
    // As converters write it: nodes bear GlobalIds and nothing says what they are.
    for (name, global_id) in global_ids(twin) {
        json = json.replace(&format!("\"Ifc{name}\""), &format!("\"{global_id}\""));
    }
    let text = base64::engine::general_purpose::STANDARD.encode(&data);
    let json = json.replace("\"buffers\":[{", &format!("\"buffers\":[{{\"uri\":\"data:;base64,{text}\","));
    let known = Arc::new(enfilade_cad::ifc::inventory(twin, None));
    let options = |storey: Option<&str>| ReadOptions {
        twin: Some(Arc::clone(&known)),
        storey: storey.map(str::to_string),
        ..ReadOptions::default()
    };
    let read = |storey| {
        enfilade_cad::read("house.gltf", json.as_bytes(), &options(storey), &mut Report::default()).unwrap()
    };
    let count = |d: &Drawing| d.entities.iter().filter(|e| e.layer == "IfcWall").count();
    assert_eq!(count(&read(None)), 21);
    assert_eq!(count(&read(Some("Upper floor"))), 16);
    let mut report = Report::default();
    let _ = enfilade_cad::read("house.gltf", json.as_bytes(), &options(None), &mut report);
    let marks = report.problems.iter().find(|p| p.code == "gltf-ifc-marks").map(|p| p.text.clone());
    let bearing =
        twin.split(|b| *b == b';').filter(|i| i.windows(16).any(|w| w == b"'Pset_Enfilade',")).count();
    let told = format!(
        "{bearing} elements in the .ifc of the same name beside it bear Pset_Enfilade, and none of these marks"
    );
    assert!(
        bearing > 1 && marks.as_ref().is_some_and(|m| m.starts_with(&told)),
        "{marks:?}, expected {told}"
    );
    for (beside, why) in [
        (b"garbage".to_vec(), "cannot be read, or holds no element"),
        (twin.to_vec().replace_ids(), "it is of another building"),
    ] {
        let mut report = Report::default();
        let beside = Arc::new(enfilade_cad::ifc::inventory(&beside, None));
        let other = ReadOptions { twin: Some(beside), ..ReadOptions::default() };
        let _ = enfilade_cad::read("house.gltf", json.as_bytes(), &other, &mut report);
        let said = report.problems.iter().find(|p| p.code == "gltf-ifc").map(|p| p.text.clone());
        assert!(said.as_ref().is_some_and(|s| s.contains(why)), "{said:?}");
    }
    let names = enfilade_cad::storeys("house.gltf", json.as_bytes(), &options(None));
    assert_eq!(names.iter().map(|s| s.name.as_str()).collect::<Vec<_>>(), ["Ground floor", "Upper floor"]);
}

/// The sample with a member of a node more.
fn with_member(name: &str, member: &str) -> String {
    let named = format!("\"name\":\"{name}\"");
    let text = embedded();
    assert!(text.contains(&named));
    text.replacen(&named, &format!("{named},{member}"), 1)
}

/// A wall that a transform makes flat has no width or no height; it is not lower than the cut.
#[test]
fn a_wall_without_extent_is_told_as_such() {
    for (scale, says) in [("[0,1,1]", "no width"), ("[1,1,0]", "no width"), ("[1,0,1]", "no height")] {
        let text = with_member("IfcWall/screen-1", &format!("\"scale\":{scale}"));
        let (drawing, report) = read_as("house.gltf", text.as_bytes());
        assert_eq!(drawing.unwrap().entities.iter().filter(|e| e.layer == "IfcWall").count(), 20);
        let told: Vec<String> = report
            .problems
            .iter()
            .filter(|p| p.place.entity.contains("screen-1"))
            .map(ToString::to_string)
            .collect();
        assert!(
            told.len() == 1 && told[0].contains(says) && told[0].contains("left out"),
            "{scale} {told:?}"
        );
        assert!(!report.problems.iter().any(|p| p.code == "gltf-not-cut"), "{scale} {:?}", report.problems);
    }
    let low = with_member("IfcWall/screen-1", "\"scale\":[1,0.1,1]");
    let problems = read_as("house.gltf", low.as_bytes()).1.problems;
    assert!(
        problems.iter().any(|p| p.code == "gltf-not-cut") && problems.iter().all(|p| p.code != "gltf-mesh")
    );
}

/// With the building beside it, what is said of a node is said on the storey in which its element stands, and storeys are
/// found without their blanks.
#[test]
fn a_node_is_told_on_its_own_storey() {
    let twin: &[u8] = include_bytes!("../../../../samples/pavilion.ifc");
    let ids = global_ids(twin);
    for (name, own) in [("Wall/screen-1", "groundfloor"), ("Wall/screen-5", "upperfloor")] {
        let Some((_, global_id)) = ids.iter().find(|(n, _)| n == name) else { panic!("{ids:?}") };
        let mut text = with_member(&format!("Ifc{name}"), "\"scale\":[0,0,0]");
        for (name, global_id) in &ids {
            text = text.replace(&format!("\"Ifc{name}\""), &format!("\"{global_id}\""));
        }
        for storey in ["groundfloor", "upperfloor"] {
            let options = ReadOptions {
                twin: Some(Arc::new(enfilade_cad::ifc::inventory(twin, None))),
                storey: Some(storey.into()),
                ..ReadOptions::default()
            };
            let mut report = Report::default();
            enfilade_cad::read("house.gltf", text.as_bytes(), &options, &mut report).unwrap();
            let told = |code: &str| {
                let of = report.problems.iter().filter(|p| p.to_string().contains(global_id));
                of.filter(|p| p.code == code).count()
            };
            let expected = usize::from(storey == own);
            let found = (told("gltf-mesh"), told("gltf-marks"));
            assert_eq!(found, (expected, expected), "{name} on {storey}: {:?}", report.problems);
        }
    }
}

/// A door is in the wall that the IFC says, and goes with it.
#[test]
fn the_ifc_beside_it_says_in_which_wall_a_door_sits() {
    let [door, wall] = ["IfcWall/screen-1", "IfcWall/hall"];
    let options = enfilade_cad::gltf::ReadOptions {
        twin: Some(Arc::new(enfilade_cad::ifc::Inventory {
            classes: [(door.into(), "IfcDoor".into()), (wall.into(), "IfcWall".into())].into(),
            hosts: [(door.into(), wall.into()), ("IfcWall/hall".into(), "IfcWall/nowhere".into())].into(),
            ..Default::default()
        })),
        ..Default::default()
    };
    let drawing = enfilade_cad::gltf::read("house.glb", PAVILION, &options, &mut Report::default()).unwrap();
    assert_eq!(drawing.hosts, [(node(door), node(wall))].into());
}

/// The hosts of a building by name, as a scene beside it needs them.
#[test]
fn a_building_tells_hosts_by_name() {
    let told = enfilade_cad::ifc::inventory(include_bytes!("../../../../samples/pavilion.ifc"), None);
    assert!(!told.hosts.is_empty());
    for (filler, wall) in &told.hosts {
        assert!(["IfcDoor", "IfcWindow"].contains(&told.classes[filler].as_str()), "{filler}");
        assert!(told.classes[wall].starts_with("IfcWall"), "{wall}");
    }
}

/// An IFC with other `GlobalId`s.
trait OtherIds {
    fn replace_ids(self) -> Vec<u8>;
}

impl OtherIds for Vec<u8> {
    fn replace_ids(self) -> Vec<u8> {
        let text = String::from_utf8(self).unwrap();
        let other = |l: &str| match l.split_once("('") {
            Some((head, rest)) if rest.as_bytes().get(22) == Some(&b'\'') => {
                format!(
                    "{head}('3{}{}\n",
                    rest[..21].to_lowercase().replace(['0', '1', '2'], "z"),
                    &rest[22..]
                )
            }
            _ => format!("{l}\n"),
        };
        text.lines().map(other).collect::<String>().into_bytes()
    }
}

/// `Wall/screen-1` → `GlobalId`, of walls whose name is unique.
fn global_ids(ifc: &[u8]) -> Vec<(String, String)> {
    let text = String::from_utf8(ifc.to_vec()).unwrap();
    let wall = |l: &str| {
        let (_, rest) = l.split_once("=IFCWALL('")?;
        let name = rest.split('\'').nth(2)?;
        Some((format!("Wall/{name}"), rest[..22].to_string()))
    };
    text.lines().filter_map(wall).collect()
}

#[test]
fn a_move_changes_numbers_of_one_node() {
    let bytes_of = |e: Edit| patch(PAVILION, &[e], &[]).unwrap();
    let record = node("IfcWall/cloakroom");
    let motion = RigidMotion { turn_rad: 0.0, shift: DVec2::new(0.25, 0.5) };
    let bytes = bytes_of(Edit::Insert { record, motion });
    assert_eq!(u32_at(&bytes, 8), bytes.len());
    let (before, after) = (read(PAVILION), read(&bytes));
    for (a, b) in before.entities.iter().zip(&after.entities) {
        let expected = if a.source.record == record { motion.shift } else { DVec2::ZERO };
        assert!((points(b)[0] - points(a)[0] - expected).length() < 1e-9, "{:?}", a.source);
    }
    let (old, _) = parts();
    let new = String::from_utf8(bytes[20..20 + u32_at(&bytes, 12)].to_vec()).unwrap();
    assert_eq!(new.trim_end(), old.trim_end().replace("[0.3,0,-7.5]", "[0.55,0,-8]"));
    assert!(bytes.ends_with(&parts().1));
    assert!(patch(PAVILION, &[], &[]).unwrap() == PAVILION);
}

#[test]
fn additions_are_nodes_of_ours_and_are_not_read_as_walls() {
    let add = |layer: &str, mark| Addition { layer: layer.into(), rgb: [200, 30, 30], mark };
    let own = [
        add("EF-NOTE", Mark::Text { at: DVec2::ZERO, height: 0.1, text: "\"ä 壁\nb".into() }),
        add("EF-HEAT-DEGREE", Mark::Fill { corners: [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y] }),
        add("EF-MOVED", Mark::Path { points: vec![DVec2::ZERO, DVec2::X], closed: false }),
    ];
    let bytes = patch(PAVILION, &[], &own).unwrap();
    assert_eq!(read(&bytes).entities, read(PAVILION).entities);
    let json: serde_json::Value = serde_json::from_slice(&bytes[20..20 + u32_at(&bytes, 12)]).unwrap();
    let nodes = json["nodes"].as_array().unwrap();
    let mine: Vec<&str> = nodes.iter().rev().take(3).filter_map(|n| n["name"].as_str()).collect();
    assert_eq!(mine, ["EF-NOTE", "EF-MOVED", "EF-HEAT-DEGREE"]);
    let hanging: usize = nodes.iter().filter_map(|n| n["children"].as_array()).map(Vec::len).sum();
    assert_eq!(json["scenes"][0]["nodes"].as_array().unwrap().len(), nodes.len() - hanging);
    assert_eq!(json["extensionsUsed"], serde_json::json!(["KHR_materials_unlit"]));
    // Our data stands behind the scene's own in the binary chunk; data as text is for scenes without one.
    let data = &bytes[28 + u32_at(&bytes, 12)..];
    assert!(data.len() > parts().1.len() && data.starts_with(&parts().1));
    assert_eq!(json["buffers"].as_array().unwrap().len(), 1);
    assert_eq!(json["buffers"][0]["byteLength"], data.len());
    let text =
        enfilade_cad::patch("house.gltf", embedded().as_bytes(), &ReadOptions::default(), &[], &own).unwrap();
    let json: serde_json::Value = serde_json::from_slice(&text).unwrap();
    assert!(json["buffers"].as_array().unwrap().iter().all(|b| b["uri"].is_string()));
}

/// A GLB with three walls in one mesh, two primitives, and normals; the node is turned, scaled and shifted.
fn walls_of_one_mesh() -> Vec<u8> {
    let box_of = |x: f32, y: f32, w: f32, d: f32| -> Vec<[f32; 3]> {
        let ring = [[x, y], [x + w, y], [x + w, y + d], [x, y + d]];
        [0.0, 6.0].iter().flat_map(|h| ring.map(|p| [p[0], *h, -p[1]])).collect()
    };
    let walls = [box_of(0.0, 0.0, 8.0, 0.4), box_of(10.0, 0.0, 0.4, 8.0), box_of(2.0, 12.0, 8.0, 0.4)];
    let faces = [[0u16, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];
    let points = [[walls[0].clone(), walls[1].clone()].concat(), walls[2].clone()];
    let (mut data, mut views, mut accessors, mut primitives) =
        (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for points in &points {
        let n = points.len();
        let boxes = (0..n / 8).map(|b| 8 * b as u16);
        let quads = boxes.flat_map(|b| faces.map(|f| f.map(|i| i + b)));
        let indices: Vec<u16> = quads.flat_map(|[a, b, c, d]| [a, b, c, a, c, d]).collect();
        let bound =
            |pick: fn(f32, f32) -> f32| [0, 1, 2].map(|k| points.iter().map(|p| p[k]).reduce(pick).unwrap());
        let (lo, hi, k) = (bound(f32::min), bound(f32::max), accessors.len());
        let normals = points.iter().map(|_| [1f32, 0.0, 0.0]);
        let floats = points.iter().copied().chain(normals).flatten().flat_map(f32::to_le_bytes);
        let start = data.len();
        data.extend(floats.chain(indices.iter().flat_map(|i| i.to_le_bytes())));
        views.push(serde_json::json!({"buffer": 0, "byteOffset": start, "byteLength": data.len() - start}));
        let view = views.len() - 1;
        accessors.extend([
            serde_json::json!({"bufferView": view, "componentType": 5126, "count": n, "type": "VEC3", "min": lo, "max": hi}),
            serde_json::json!({"bufferView": view, "byteOffset": 12 * n, "componentType": 5126, "count": n, "type": "VEC3"}),
            serde_json::json!({"bufferView": view, "byteOffset": 24 * n, "componentType": 5123, "count": indices.len(), "type": "SCALAR"}),
        ]);
        primitives
            .push(serde_json::json!({"attributes": {"POSITION": k, "NORMAL": k + 1}, "indices": k + 2}));
    }
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let node = serde_json::json!({"name": "walls", "mesh": 0, "scale": [0.5, 0.5, 0.5], "rotation": [0, half, 0, half], "translation": [3, 0, 1]});
    let json = serde_json::json!({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [node],
        "meshes": [{"primitives": primitives}], "accessors": accessors, "bufferViews": views,
        "buffers": [{"byteLength": data.len()}],
    });
    let mut text = json.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let total = 28 + text.len() + data.len();
    let mut out = b"glTF".to_vec();
    [2, total as u32, text.len() as u32, 0x4E4F_534A].iter().for_each(|w: &u32| out.extend(w.to_le_bytes()));
    out.extend(text);
    [data.len() as u32, 0x004E_4942].iter().for_each(|w: &u32| out.extend(w.to_le_bytes()));
    out.extend(data);
    out
}

#[test]
fn walls_that_share_a_mesh_move_one_by_one() {
    let bytes = walls_of_one_mesh();
    let before = read(&bytes);
    let records: Vec<usize> = before.entities.iter().map(|e| e.source.record).collect();
    assert_eq!(before.entities.len(), 3, "{before:?}");
    assert!(before.entities.iter().all(|e| e.source.handle.as_deref() == Some("/nodes/0")));
    let motion = |turn_rad, x, y| RigidMotion { turn_rad, shift: DVec2::new(x, y) };
    for (which, motion) in
        [(0, motion(0.0, 0.25, -0.5)), (1, motion(0.3, 1.0, 2.0)), (2, motion(-1.0, 0.0, 0.0))]
    {
        let edit = [Edit::Insert { record: records[which], motion }];
        let moved = patch(&bytes, &edit, &[]).unwrap();
        let after = read(&moved);
        for (i, (a, b)) in before.entities.iter().zip(&after.entities).enumerate() {
            for (p, q) in points(a).into_iter().zip(points(b)) {
                let told = DVec2::from_angle(motion.turn_rad).rotate(p) + motion.shift;
                let told = if i == which { told } else { p };
                assert!((q - told).length() < 2e-6, "wall {i}: {p} to {q}, expected {told}");
            }
        }
        let (old, new) = (json_of(&bytes), json_of(&moved));
        assert_eq!(new["nodes"], old["nodes"]);
        for (a, b) in new["accessors"].as_array().unwrap().iter().zip(old["accessors"].as_array().unwrap()) {
            assert_eq!((&a["count"], &a["bufferView"]), (&b["count"], &b["bufferView"]));
        }
        // Of the data only the vertices of that wall differ: 8 of 24, positions and, turned, normals.
        let data = |bytes: &[u8]| bytes[28 + u32_at(bytes, 12)..].to_vec();
        let (old, new) = (data(&bytes), data(&moved));
        assert_eq!(old.len(), new.len());
        let words = old.chunks(4).zip(new.chunks(4)).filter(|(a, b)| a != b).count();
        let most = if motion.turn_rad == 0.0 { 8 * 3 } else { 8 * 6 };
        assert!((16..=most).contains(&words), "{words} numbers changed");
        assert_eq!(
            enfilade_cad::changes("house.glb", &bytes, &ReadOptions::default(), &edit).unwrap().records[0][0]
                .of
                .handle
                .as_deref(),
            Some("/nodes/0")
        );
    }
}

#[test]
fn bounds_of_moved_vertices_are_stated_anew() {
    let bytes = walls_of_one_mesh();
    let record = read(&bytes).entities[2].source.record;
    let motion = RigidMotion { turn_rad: 0.7, shift: DVec2::new(0.25, 0.5) };
    let moved = patch(&bytes, &[Edit::Insert { record, motion }], &[]).unwrap();
    let json = json_of(&moved);
    let data = &moved[28 + u32_at(&moved, 12)..];
    let start = json["bufferViews"][1]["byteOffset"].as_u64().unwrap() as usize;
    let float = |i: usize, k: usize| {
        let at = start + 12 * i + 4 * k;
        f64::from(f32::from_le_bytes(data[at..at + 4].try_into().unwrap()))
    };
    for k in 0..3 {
        let of = |pick: fn(f64, f64) -> f64| (0..8).map(|i| float(i, k)).reduce(pick).unwrap();
        assert_eq!(json["accessors"][3]["min"][k].as_f64(), Some(of(f64::min)));
        assert_eq!(json["accessors"][3]["max"][k].as_f64(), Some(of(f64::max)));
    }
}

#[test]
fn a_mesh_that_cannot_be_written_in_parts_moves_as_a_whole() {
    let bytes = walls_of_one_mesh();
    let text = String::from_utf8_lossy(&bytes).into_owned();
    let shared = json_of(&bytes);
    assert!(text.contains("\"walls\"") && shared["nodes"].as_array().unwrap().len() == 1);
    // A wall known by its class is one element, of however many parts.
    let classed = with_json(&bytes, |json| json["nodes"][0]["name"] = "IfcWall/all".into());
    let twice = with_json(&bytes, |json| {
        let mut other = json["nodes"][0].clone();
        other["translation"] = serde_json::json!([30, 0, 1]);
        json["nodes"].as_array_mut().unwrap().push(other);
        json["scenes"][0]["nodes"] = serde_json::json!([0, 1]);
    });
    for bytes in [classed, twice] {
        assert!(read(&bytes).entities.iter().all(|e| e.source.record < 2));
    }
}

/// What a damaged scene names and does not have must not become ours.
#[test]
fn additions_take_the_place_of_nothing_that_is_named() {
    let corners = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y];
    let own = [Addition { layer: "EF-HEAT".into(), rgb: [0; 3], mark: Mark::Fill { corners } }];
    let n_views = json_of(PAVILION)["bufferViews"].as_array().unwrap().len();
    let naming = |view: usize| with_json(PAVILION, |json| json["accessors"][0]["bufferView"] = view.into());
    let error = patch(&naming(n_views), &[], &own).unwrap_err();
    let place = format!("/bufferViews/{n_views}");
    assert_eq!(error.problem().map(|p| (p.code, p.place.entity.clone())), Some(("gltf-dangling", place)));
    assert!(patch(&naming(n_views + 1000), &[], &own).is_ok());
    assert!(patch(PAVILION, &[], &own).is_ok());
}

/// A scene higher than single precision reaches: what is added stays numbers that can be read again.
#[test]
fn a_scene_beyond_single_precision_takes_additions() {
    for height in [1e308, -1e308, 1e39] {
        let bytes = with_json(PAVILION, |json| {
            let roots: Vec<usize> = json["scenes"][0]["nodes"]
                .as_array()
                .unwrap()
                .iter()
                .map(|n| n.as_u64().unwrap() as usize)
                .collect();
            for root in roots {
                json["nodes"][root]["translation"] = serde_json::json!([0.0, height, 0.0]);
            }
        });
        let corners = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y];
        let own = [Addition { layer: "EF-HEAT".into(), rgb: [0; 3], mark: Mark::Fill { corners } }];
        let added = patch(&bytes, &[], &own).unwrap();
        assert!(json_of(&added)["nodes"].is_array(), "{height}");
        let (again, report) = read_as("house.glb", &added);
        assert!(again.is_ok(), "{height}: {again:?} {report:?}");
    }
}

fn json_of(bytes: &[u8]) -> serde_json::Value {
    serde_json::from_slice(&bytes[20..20 + u32_at(bytes, 12)]).unwrap()
}

/// A GLB with its JSON changed.
fn with_json(bytes: &[u8], change: impl Fn(&mut serde_json::Value)) -> Vec<u8> {
    let mut json = json_of(bytes);
    change(&mut json);
    let mut text = json.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let rest = &bytes[20 + u32_at(bytes, 12)..];
    let total = (20 + text.len() + rest.len()) as u32;
    let head = [&bytes[..8], &total.to_le_bytes(), &(text.len() as u32).to_le_bytes(), b"JSON"].concat();
    [head, text, rest.to_vec()].concat()
}

/// The standard forbids it; a move of the node would move both.
#[test]
fn a_node_that_hangs_in_the_scene_twice_does_not_move() {
    let of = |bytes: &[u8]| {
        let drawing = read(bytes);
        let mine = drawing.entities.iter().filter(|e| e.source.record == node("IfcWall/screen-1"));
        mine.map(|e| e.editable.moves_whole()).collect::<Vec<_>>()
    };
    assert!(of(PAVILION).iter().all(|moves| *moves));
    let twice = with_json(PAVILION, |json| {
        let scene = json["scenes"][0]["nodes"].as_array_mut().unwrap();
        scene.push(node("IfcWall/screen-1").into());
    });
    let moves = of(&twice);
    assert!(moves.len() >= 2 && !moves.iter().any(|m| *m), "{moves:?}");
}

/// Twenty levels, each naming the next twice, would be a million nodes.
#[test]
fn nodes_that_hang_twice_do_not_add_up() {
    let of = |levels: usize| {
        let scene = with_json(PAVILION, |json| {
            let nodes = json["nodes"].as_array_mut().unwrap();
            let first = nodes.len();
            for k in 0..levels {
                let child = if k + 1 < levels { first + k + 1 } else { node("IfcWall/screen-1") };
                nodes.push(serde_json::json!({ "name": "twice", "children": [child, child] }));
            }
            json["scenes"][0]["nodes"].as_array_mut().unwrap().push(first.into());
        });
        let (drawing, report) = read_as("house.glb", &scene);
        let said = report.problems.iter().any(|p| p.text.contains("hang in several nodes each"));
        (drawing.unwrap().entities.len(), said)
    };
    let (few, said) = of(3);
    assert!(!said && few > read(PAVILION).entities.len());
    let (many, said) = of(20);
    assert!(said && many < 2 * enfilade_cad::gltf::REPEATS_MAX, "{many}");
}

/// A bad text: what is changed in the sample, what must be said, whether the whole file is refused.
fn hazards() -> Vec<(&'static str, String, &'static str, bool)> {
    let text = embedded();
    let swap = |from: &str, to: &str| {
        assert!(text.contains(from), "{from}");
        text.replacen(from, to, 1)
    };
    let uri = {
        let start = text.find("\"uri\":\"").unwrap();
        let end = start + 7 + text[start + 7..].find('"').unwrap() + 1;
        text[start..end].to_string()
    };
    let other = |to: &str| swap(&uri, &format!("\"uri\":\"{to}\""));
    let mut out = Vec::new();
    for (path, says) in [
        (
            "../walls.bin",
            "/buffers/0: names \"../walls.bin\", which lies elsewhere, expected a file in or below the drawing's own folder; it is not opened",
        ),
        ("/etc/passwd", "/buffers/0: names \"/etc/passwd\", which lies elsewhere"),
        ("file:///etc/passwd", "/buffers/0: names \"file:///etc/passwd\", an address"),
        ("http://example.org/a.bin", "/buffers/0: names \"http://example.org/a.bin\", an address"),
        ("%2e%2e/a.bin", "/buffers/0: names \"%2e%2e/a.bin\", which lies elsewhere"),
        (
            "A..B.bin",
            "/buffers/0: names \"A..B.bin\", expected a file of at most 1073741824 bytes beside the drawing; put it there, or export as .glb",
        ),
    ] {
        out.push(("43 data in another file", other(path), says, true));
    }
    out.extend([
        (
            "43 data as text without end",
            other(&format!("data:;base64,{}", "A".repeat(enfilade_cad::gltf::DATA_MAX + 1))),
            "/buffers/0: data URIs of more than 67108864 characters; export as GLB",
            true,
        ),
        ("43 damaged data", other("data:;base64,@@"), "/buffers/0: its data URI is damaged", true),
        ("43 data too short", swap(&format!("{uri},\"byteLength\":"), &format!("{uri},\"byteLength\":9")), "expected 9", true),
        ("44 count of 4e9", swap("\"count\":", "\"count\":4000000000,\"x\":"), "/bufferViews/0: is shorter than what is read", false),
        ("44 view out of range", swap("\"bufferView\":0", "\"bufferView\":99999"), "/bufferViews/99999: does not exist", false),
        ("44 accessor out of range", swap("\"POSITION\":0", "\"POSITION\":99999"), "/accessors/99999: does not exist", false),
        ("44 offset that overflows", swap("\"bufferView\":0", "\"bufferView\":0,\"byteOffset\":8000000000000000"), "/bufferViews/0: is shorter than what is read", false),
        ("44 sparse without indices", swap("\"bufferView\":0", "\"bufferView\":0,\"sparse\":{\"count\":3}"), "/accessors/0: sparse: is incomplete", false),
        ("44 Draco required", swap("{\"asset\"", "{\"extensionsRequired\":[\"KHR_draco_mesh_compression\"],\"asset\""), "/extensionsRequired/0: the meshes are packed by KHR_draco_mesh_compression; export again without compression", true),
        ("44 meshopt required", swap("{\"asset\"", "{\"extensionsRequired\":[\"EXT_meshopt_compression\"],\"asset\""), "/extensionsRequired/0: the meshes are packed by EXT_meshopt_compression; export again without compression", true),
        ("44 ring of nodes", swap("{\"name\":\"IfcWall/south\",", "{\"children\":[0],\"name\":\"IfcWall/south\","), "nodes are children of each other in a ring: 0>0", false),
        ("44 not a number", swap("\"translation\":[0,0,-0.15]", "\"translation\":[NaN,0,-0.15]"), "found something that is no JSON value", true),
        ("44 nested 200,000 deep", swap("{\"asset\"", &format!("{{\"extras\":{}{},\"asset\"", "[".repeat(200_000), "]".repeat(200_000))), "JSON nested deeper than any scene is", true),
        ("a list that is none", swap("{\"asset\"", "{\"materials\":0,\"asset\""), "/materials: found something else, expected a list", true),
        ("version 1.0", swap("\"version\":\"2.0\"", "\"version\":\"1.0\""), "/asset/version: found version \"1.0\", expected glTF 2.0; export it again as glTF 2.0", true),
    ]);
    out
}

#[test]
fn bad_inputs_are_named_and_the_rest_is_read() {
    for (name, text, says, is_refused) in hazards() {
        let (drawing, report) = read_as("house.gltf", text.as_bytes());
        let said = match &drawing {
            Ok(_) => report.problems.iter().map(|p| format!("{p}\n")).collect(),
            Err(error) => error.to_string(),
        };
        assert!(said.contains(says), "{name}: expected {says:?}, found {said:.600}");
        assert_eq!(drawing.is_err(), is_refused, "{name}");
        assert!(is_refused || report.is_degraded(), "{name}: not stated as left out");
    }
}

#[test]
fn data_in_a_file_beside_the_scene_is_read_and_stays_there() {
    let (json, data) = parts();
    let json = json.replace("\"buffers\":[{", "\"buffers\":[{\"uri\":\"A..B%201.bin\",");
    assert_eq!(enfilade_cad::gltf::outer_files(json.as_bytes()).data, ["A..B 1.bin".to_string()].into());
    let options = |data: &[u8]| ReadOptions {
        buffers: [("A..B 1.bin".to_string(), data.into())].into(),
        ..ReadOptions::default()
    };
    let read_with = |text: &[u8], data: &[u8]| {
        enfilade_cad::read("house.gltf", text, &options(data), &mut Report::default())
    };
    assert_eq!(read_with(json.as_bytes(), &data).unwrap().entities, read(PAVILION).entities);
    let short = read_with(json.as_bytes(), &data[..100]).unwrap_err().to_string();
    assert!(short.contains("/buffers/0: found 100 bytes, expected"), "{short}");
    let record = node("IfcWall/cloakroom");
    let motion = RigidMotion { turn_rad: 0.0, shift: DVec2::new(0.25, 0.5) };
    let edits = [Edit::Insert { record, motion }];
    let bytes = enfilade_cad::patch("house.gltf", json.as_bytes(), &options(&data), &edits, &[]).unwrap();
    assert_eq!(String::from_utf8(bytes).unwrap(), json.replace("[0.3,0,-7.5]", "[0.55,0,-8]"));
}

#[test]
fn containers_that_lie_are_refused() {
    let with = |edit: &dyn Fn(&mut Vec<u8>)| {
        let mut bytes = PAVILION.to_vec();
        edit(&mut bytes);
        read_as("house.glb", &bytes).0.unwrap_err().to_string()
    };
    assert!(with(&|b| b.truncate(b.len() - 4)).contains("the file is damaged or not finished"));
    assert!(with(&|b| b.extend([0; 4])).contains("the file is damaged or not finished"));
    assert!(
        with(&|b| b[12..16].copy_from_slice(&u32::MAX.to_le_bytes())).contains("byte 12: a chunk is cut off")
    );
    let first = with(&|b| b[4] = 1);
    assert!(
        first.contains("found version 1 of GLB") && first.contains("export it again as glTF 2.0"),
        "{first}"
    );
    assert!(with(&|b| b[16..20].copy_from_slice(b"BIN\0")).contains("the first chunk is not JSON"));
    for cut in (0..PAVILION.len()).step_by(301) {
        assert_ne!(enfilade_cad::is_complete("house.glb", &PAVILION[..cut]), Completeness::Whole, "{cut}");
    }
    assert_eq!(enfilade_cad::is_complete("house.glb", PAVILION), Completeness::Whole);
}

#[test]
fn a_triangle_in_every_way_of_writing_it() {
    // One upright box of a wall, 2 m long, as plain, quantised, sparse and striped data.
    let corner = |i: usize| [(i & 1) * 2, (i >> 1 & 1) * 3, i >> 2 & 1];
    let floats: Vec<u8> = (0..8).flat_map(corner).flat_map(|v| (v as f32).to_le_bytes()).collect();
    let shorts: Vec<u8> = (0..8)
        .flat_map(|i| [corner(i).map(|v| v as u16).as_slice(), &[0]].concat())
        .flat_map(u16::to_le_bytes)
        .collect();
    let indices = [
        0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4, 2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3,
        7, 5u8,
    ];
    let sides = [4, 6, 5, 7, 1, 3, 0, 2, 4, 6u8];
    let scene = |data: &[u8], views: &str, position: &str, index: &str, mode: u32| {
        let text = base64::engine::general_purpose::STANDARD.encode(data);
        format!(
            r#"{{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[0]}}],"nodes":[{{"name":"wall","mesh":0}}],
            "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1,"mode":{mode}}}]}}],
            "accessors":[{{{position},"type":"VEC3"}},{{"componentType":5121,"type":"SCALAR",{index}}}],
            "bufferViews":[{views}],
            "buffers":[{{"byteLength":{},"uri":"data:application/octet-stream;base64,{text}"}}]}}"#,
            data.len()
        )
    };
    let plain = scene(
        &[&floats[..], &indices].concat(),
        r#"{"buffer":0,"byteLength":96},{"buffer":0,"byteOffset":96,"byteLength":36}"#,
        r#""bufferView":0,"componentType":5126,"count":8"#,
        r#""bufferView":1,"count":36"#,
        4,
    );
    let unsaid = scene(
        &[&shorts[..], &indices].concat(),
        r#"{"buffer":0,"byteLength":64,"byteStride":8},{"buffer":0,"byteOffset":64,"byteLength":36}"#,
        r#""bufferView":0,"componentType":5123,"count":8"#,
        r#""bufferView":1,"count":36"#,
        4,
    );
    let quantised =
        unsaid.replacen(r#"{"asset""#, r#"{"extensionsUsed":["KHR_mesh_quantization"],"asset""#, 1);
    let (drawing, report) = read_as("house.gltf", unsaid.as_bytes());
    let said = format!("{report:?}");
    assert!(drawing.is_ok_and(|d| d.entities.is_empty()), "{said}");
    assert!(
        said.contains("has positions of component type 5123, expected 5126, or KHR_mesh_quantization"),
        "{said}"
    );
    let all: Vec<u8> = (0..8).collect();
    let sparse = scene(
        &[&floats[..], &indices, &all].concat(),
        r#"{"buffer":0,"byteLength":96},{"buffer":0,"byteOffset":96,"byteLength":36},{"buffer":0,"byteOffset":132,"byteLength":8}"#,
        r#""componentType":5126,"count":8,"sparse":{"count":8,"indices":{"bufferView":2,"componentType":5121},"values":{"bufferView":0}}"#,
        r#""bufferView":1,"count":36"#,
        4,
    );
    let striped = scene(
        &[&floats[..], &sides].concat(),
        r#"{"buffer":0,"byteLength":96},{"buffer":0,"byteOffset":96,"byteLength":10}"#,
        r#""bufferView":0,"componentType":5126,"count":8"#,
        r#""bufferView":1,"count":10"#,
        5,
    );
    for (name, text) in [("plain", plain), ("quantised", quantised), ("sparse", sparse), ("striped", striped)]
    {
        let (drawing, report) = read_as("house.gltf", text.as_bytes());
        let drawing = drawing.unwrap();
        assert_eq!(drawing.entities.len(), 1, "{name}: {report:?}");
        let mut corners = points(&drawing.entities[0]);
        corners.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
        let expected = [(0.0, -1.0), (0.0, 0.0), (2.0, -1.0), (2.0, 0.0)].map(DVec2::from);
        assert!(corners.iter().zip(expected).all(|(a, b)| (*a - b).length() < 1e-12), "{name}: {corners:?}");
    }
}

/// Data beyond the stated bounds counts, and whoever believes the bounds sees something else: that is a warning.
#[test]
fn bounds_that_are_not_those_of_the_data_are_told() {
    let said = |max: serde_json::Value| {
        let bytes = with_json(PAVILION, |json| {
            for accessor in json["accessors"].as_array_mut().unwrap() {
                if accessor["type"] == "VEC3" && accessor.get("max").is_some() {
                    accessor["max"] = max.clone();
                }
            }
        });
        let (drawing, report) = read_as("house.glb", &bytes);
        drawing.unwrap();
        report
    };
    for max in [serde_json::json!([0, 0, 0]), serde_json::json!([1e30, 1e30, 1e30])] {
        let report = said(max);
        let found = report.problems.iter().any(|p| {
            p.code == "gltf-value" && p.severity == Severity::Warning && p.text.contains("/accessors/")
        });
        assert!(found, "{report:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn moves_are_written_as_told(which in 0usize..6, turn in -3.0..3.0f64, x in -5.0..5.0f64, y in -5.0..5.0f64) {
        let name = ["screen-1", "screen-2", "screen-3", "screen-4", "cloakroom", "hall"][which];
        let record = node(&format!("IfcWall/{name}"));
        let motion = RigidMotion { turn_rad: turn, shift: DVec2::new(x, y) };
        let bytes = patch(PAVILION, &[Edit::Insert { record, motion }], &[]).unwrap();
        let (before, after) = (read(PAVILION), read(&bytes));
        let own = |d: &Drawing| -> Vec<DVec2> {
            d.entities.iter().filter(|e| e.source.record == record).flat_map(points).collect()
        };
        // Slicing may start a ring elsewhere: every corner has its image.
        let images = own(&after);
        for a in own(&before) {
            let expected = DVec2::from_angle(turn).rotate(a) + motion.shift;
            prop_assert!(images.iter().any(|b| (*b - expected).length() < 1e-6), "{a}: {images:?}");
        }
        prop_assert_eq!(u32_at(&bytes, 8), bytes.len());
        prop_assert!(bytes.ends_with(&parts().1));
    }

    #[test]
    fn damaged_files_never_panic(at in 0usize..100_000, with in prop::collection::vec(any::<u8>(), 1..6)) {
        for (file, mut bytes) in [("house.glb", PAVILION.to_vec()), ("house.gltf", embedded().into_bytes())] {
            let at = at % bytes.len();
            let end = (at + with.len()).min(bytes.len());
            bytes.splice(at..end, with.iter().copied());
            let (once, twice) = (read_as(file, &bytes), read_as(file, &bytes));
            prop_assert_eq!(once.0.ok(), twice.0.ok());
            prop_assert_eq!(once.1, twice.1);
            prop_assert_eq!(enfilade_cad::patch(file, &bytes, &ReadOptions::default(), &[], &[]).unwrap(), bytes);
        }
    }
}

/// A scene in millimetres, against the standard: its walls say so, or the user, and heights and plan agree.
#[test]
fn heights_of_a_scene_are_in_the_unit_of_its_plan() {
    let large = with_json(PAVILION, |json| {
        let roots = json["scenes"][0]["nodes"].clone();
        let nodes = json["nodes"].as_array_mut().unwrap();
        nodes.push(serde_json::json!({"scale": [1000.0, 1000.0, 1000.0], "children": roots}));
        let top = nodes.len() - 1;
        json["scenes"][0]["nodes"] = serde_json::json!([top]);
    });
    let rounded = |d: &Drawing, metres: f64| -> Vec<(String, Vec<[i64; 2]>)> {
        let round = |p: DVec2| [p.x, p.y].map(|v| (v * metres * 1e4).round() as i64);
        d.entities.iter().map(|e| (e.layer.clone(), points(e).into_iter().map(round).collect())).collect()
    };
    let expected = rounded(&read(PAVILION), 1.0);
    let found = read(&large);
    assert_eq!(found.unit_by_heights.map(|u| u.name), Some("mm"));
    assert_eq!(rounded(&found, 1e-3), expected);
    let unit = Some(Unit { name: "mm", metres: 1e-3 });
    let options = ReadOptions { unit, ..ReadOptions::default() };
    let said = enfilade_cad::read("house.glb", &large, &options, &mut Report::default()).unwrap();
    assert_eq!((said.unit_by_heights, rounded(&said, 1e-3)), (None, expected));
    assert_eq!(read(PAVILION).unit_by_heights, None);
}

//! glTF: bad input has a JSON pointer and a reason, limits hold, and nothing but moved nodes changes.

use enfilade::formats::gltf::{self, ReadOptions};
use enfilade::plan::drawing::{Drawing, Edit, RigidMotion, Shape};
use enfilade::report::Report;
use glam::DVec2;
use serde_json::{Value, json};

use crate::building;

/// One wall of 4 by 0.2 by 3 m as JSON with its data inside, changed by `change`.
fn file(change: impl FnOnce(&mut Value)) -> String {
    let glb = building::glb(&[building::Wall {
        name: "W",
        ends: [[0.0, 0.0], [4.0, 0.0]],
        thickness: 0.2,
        holes: Vec::new(),
        moves: None,
    }]);
    let length = u32::from_le_bytes(glb[12..16].try_into().unwrap()) as usize;
    let mut json: Value = serde_json::from_slice(&glb[20..20 + length]).unwrap();
    let data = &glb[28 + length..];
    json["buffers"][0]["uri"] = format!("data:application/octet-stream;base64,{}", base64(data)).into();
    change(&mut json);
    json.to_string()
}

fn base64(data: &[u8]) -> String {
    use ::base64::Engine as _;
    ::base64::engine::general_purpose::STANDARD.encode(data)
}

fn read(text: &str) -> Result<(Drawing, String), String> {
    let mut report = Report::default();
    let drawing = gltf::read("w.gltf", text.as_bytes(), &ReadOptions::default(), &mut report);
    let said: Vec<String> = report.problems.iter().map(ToString::to_string).collect();
    drawing.map(|d| (d, said.join("\n"))).map_err(|e| e.to_string())
}

/// What is said of a file, whether it can be read or not.
fn said(change: impl FnOnce(&mut Value)) -> String {
    read(&file(change)).map_or_else(|e| e, |r| r.1)
}

#[track_caller]
fn assert_says(said: &str, words: &[&str]) {
    for word in words {
        assert!(said.contains(word), "{word:?} is not in:\n{said}");
    }
}

#[test]
fn a_plain_wall_is_read() {
    let (drawing, _) = read(&file(|_| ())).unwrap();
    let points: Vec<DVec2> = drawing
        .entities
        .iter()
        .filter(|e| e.source.record == 0)
        .flat_map(|e| match &e.shape {
            Shape::Polyline { vertices, .. } => vertices.iter().map(|v| v.at).collect(),
            _ => Vec::new(),
        })
        .collect();
    let lo = points.iter().fold(DVec2::MAX, |b, p| b.min(*p));
    let hi = points.iter().fold(DVec2::MIN, |b, p| b.max(*p));
    assert!(
        lo.distance(DVec2::new(0.0, -0.1)) < 1e-6 && hi.distance(DVec2::new(4.0, 0.1)) < 1e-6,
        "{lo} {hi}"
    );
}

#[test]
fn bad_accessors_have_their_pointer() {
    assert_says(
        &said(|j| j["accessors"][0]["count"] = 4_000_000_000_u64.into()),
        &["/bufferViews/0", "left out"],
    );
    assert_says(
        &said(|j| j["accessors"][0]["byteOffset"] = json!(18_446_744_073_709_551_615_u64)),
        &["/accessors/0"],
    );
    assert_says(&said(|j| j["accessors"][1]["bufferView"] = 99.into()), &["/bufferViews/99"]);
    assert_says(&said(|j| j["meshes"][0]["primitives"][0]["indices"] = 0.into()), &["/accessors/0"]);
    let sparse = |j: &mut Value| {
        j["accessors"][0]["sparse"] = json!({"count": 9, "indices": {"bufferView": 1, "componentType": 5123}, "values": {"bufferView": 77}});
    };
    assert_says(&said(sparse), &["/accessors/0", "sparse"]);
}

#[test]
fn packed_meshes_are_named_with_the_remedy() {
    for name in ["KHR_draco_mesh_compression", "EXT_meshopt_compression"] {
        let text = said(|j| j["extensionsRequired"] = json!([name]));
        assert_says(&text, &[name, "without compression", "/extensionsRequired/0", "nothing was done"]);
    }
    assert_says(&said(|j| j["asset"]["version"] = "1.0".into()), &["/asset/version", "expected glTF 2.0"]);
}

#[test]
fn files_beside_are_never_opened() {
    for uri in
        ["../secret.bin", "/etc/passwd", "file:///etc/passwd", "http://example.org/a.bin", "%2e%2e/a.bin"]
    {
        let text = said(|j| j["buffers"][0]["uri"] = uri.into());
        assert!(!text.is_empty(), "{uri}: nothing was said");
        assert!(!text.contains("root:"), "{text}");
    }
}

#[test]
fn rings_of_nodes_are_named_and_depth_is_bounded() {
    let ring = |j: &mut Value| {
        j["nodes"].as_array_mut().unwrap().extend([json!({"children": [2, 1]}), json!({"children": [1]})]);
        let n = j["nodes"].as_array().unwrap().len();
        j["scenes"][0]["nodes"] = json!([0, n - 2]);
        j["nodes"][n - 2]["children"] = json!([n - 1]);
        j["nodes"][n - 1]["children"] = json!([n - 2]);
    };
    assert_says(&said(ring), &["ring"]);
    let deep = |n: usize| {
        said(move |j| {
            let nodes = j["nodes"].as_array_mut().unwrap();
            let first = nodes.len();
            nodes.extend((0..n).map(|i| json!({"children": [first + i + 1]})));
            nodes.push(json!({"name": "end"}));
            j["scenes"][0]["nodes"] = json!([0, first]);
        })
    };
    assert!(!deep(100).contains("ring"));
    assert_says(&deep(gltf::DEPTH_MAX + 2), &["deeper than 10000"]);
}

#[test]
fn nodes_triangles_nesting_and_data_are_bounded() {
    let doubled = |j: &mut Value| {
        let nodes = j["nodes"].as_array_mut().unwrap();
        let first = nodes.len();
        nodes.extend((0..21).map(|i| json!({"children": [first + i + 1, first + i + 1]})));
        nodes.push(json!({}));
        j["scenes"][0]["nodes"] = json!([0, first]);
    };
    assert_says(&said(doubled), &[&format!("shown {} times more", gltf::REPEATS_MAX)]);
    let wide = |j: &mut Value| {
        let nodes = j["nodes"].as_array_mut().unwrap();
        let first = nodes.len();
        nodes.extend((0..gltf::NODES_MAX).map(|_| json!({})));
        j["scenes"][0]["nodes"] = (0..first + gltf::NODES_MAX).filter(|n| *n == 0 || *n >= first).collect();
    };
    assert_says(&said(wide), &[&format!("more than {} nodes", gltf::NODES_MAX)]);
    let many = |j: &mut Value| {
        j["accessors"][1] =
            json!({"componentType": 5125, "type": "SCALAR", "count": gltf::TRIANGLES_MAX + 1});
    };
    assert_says(&said(many), &["/accessors/1", "counts more"]);
    let nested = |n: usize| {
        file(|_| ()).replacen(
            "\"asset\"",
            &format!("\"extras\":{}1{},\"asset\"", "[".repeat(n), "]".repeat(n)),
            1,
        )
    };
    assert!(read(&nested(gltf::NESTING_MAX - 2)).is_ok());
    assert_says(&read(&nested(gltf::NESTING_MAX + 1)).unwrap_err(), &["nested deeper", "byte"]);
    assert!(read(&nested(200_000)).is_err());
    let text =
        said(|j| j["buffers"][0]["uri"] = format!("data:;base64,{}", "A".repeat(gltf::DATA_MAX + 4)).into());
    assert_says(&text, &["/buffers/0", "data URIs of more than"]);
}

#[test]
fn a_glb_that_lies_about_its_length_is_not_finished() {
    let mut glb = building::glb(&building::house());
    assert_eq!(gltf::incomplete(&glb), None);
    glb.push(0);
    assert!(gltf::incomplete(&glb).unwrap().contains("states"));
    let cut = &glb[..glb.len() / 2];
    assert!(gltf::read("h.glb", cut, &ReadOptions::default(), &mut Report::default()).is_err());
}

#[test]
fn a_moved_node_changes_its_transform_alone() {
    let glb = building::glb(&building::house());
    let options = ReadOptions::default();
    assert_eq!(gltf::patch("h.glb", &glb, &options, &[], &[]).unwrap(), glb);
    let node = building::house().iter().position(|w| w.name == "Screen A").unwrap();
    let motion = RigidMotion { turn_rad: 0.5, shift: DVec2::new(0.25, -0.5) };
    let edits = [Edit::Insert { record: node, motion }];
    let after = gltf::patch("h.glb", &glb, &options, &edits, &[]).unwrap();
    let json = |bytes: &[u8]| -> Value {
        let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
        serde_json::from_slice(&bytes[20..20 + length]).unwrap()
    };
    let (was, mut is) = (json(&glb), json(&after));
    for key in ["matrix", "translation", "rotation", "scale"] {
        is["nodes"][node].as_object_mut().unwrap().remove(key);
    }
    assert_eq!(was, is);
    let points = |bytes: &[u8]| -> Vec<DVec2> {
        let drawing = gltf::read("h.glb", bytes, &options, &mut Report::default()).unwrap();
        let of = drawing.entities.iter().filter(|e| e.source.record == node).map(|e| e.shape.clone());
        of.flat_map(|s| match s {
            Shape::Polyline { vertices, .. } => vertices.iter().map(|v| v.at).collect(),
            _ => Vec::new(),
        })
        .collect()
    };
    let go = |p: DVec2| DVec2::from_angle(0.5).rotate(p) + DVec2::new(0.25, -0.5);
    let (was, is) = (points(&glb), points(&after));
    assert!(!was.is_empty());
    for p in was {
        assert!(is.iter().any(|q| q.distance(go(p)) < 1e-6), "{p} not in {is:?}");
    }
}

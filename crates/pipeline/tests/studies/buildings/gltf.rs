//! glTF: bad input has a JSON pointer and a reason, limits hold, and nothing but moved nodes changes.

mod marks;

use enfilade_cad::drawing::{Drawing, Edit, Editable, RigidMotion, Shape};
use enfilade_cad::gltf::{self, ReadOptions};
use enfilade_config::{Partial, Settings};
use enfilade_pipeline::Input;
use enfilade_report::{Cancel, Report};
use glam::DVec2;
use serde_json::{Value, json};

use crate::buildings::building;

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

/// The scene hung below nodes that scale it, each below the next.
fn below(json: &mut Value, scales: &[[f64; 3]]) {
    for scale in scales {
        let nodes = json["nodes"].as_array().unwrap().len();
        let children = json["scenes"][0]["nodes"].clone();
        json["nodes"].as_array_mut().unwrap().push(json!({"scale": scale, "children": children}));
        json["scenes"][0]["nodes"] = json!([nodes]);
    }
}

/// What hangs below a mirror turns; what a turn would skew says so in words of a scene.
#[test]
fn what_hangs_below_scaled_nodes_turns_unless_it_would_be_skewed() {
    let motion = RigidMotion { turn_rad: 0.5, shift: DVec2::new(0.25, -0.5) };
    let edits = [Edit::Insert { record: 0, motion }];
    let points = |drawing: &Drawing| -> Vec<DVec2> {
        let shapes = drawing.entities.iter().filter(|e| e.source.record == 0).map(|e| e.shape.clone());
        let of = |shape| match shape {
            Shape::Polyline { vertices, .. } => vertices.iter().map(|v| v.at).collect(),
            _ => Vec::new(),
        };
        shapes.flat_map(of).collect()
    };
    for (scales, turnable) in [
        (&[[2.0, 2.0, 2.0], [-1.0, 1.0, 1.0]][..], true),
        (&[[1.0, 1.0, -1.0]], true),
        (&[[1.0, 2.0, 1.0]], true),
        (&[[1.0, 1.0, 2.0]], false),
        (&[[-2.0, 2.0, 1.0]], false),
    ] {
        let text = file(|j| below(j, scales));
        let before = read(&text).unwrap().0;
        let wall = before.entities.iter().find(|e| e.source.record == 0).unwrap();
        assert_eq!(wall.editable, Editable::WithInsert { turnable }, "{scales:?}");
        if !turnable {
            continue;
        }
        let moved = gltf::patch("w.gltf", text.as_bytes(), &ReadOptions::default(), &edits, &[]).unwrap();
        let after = read(std::str::from_utf8(&moved).unwrap()).unwrap().0;
        let after = points(&after);
        for p in points(&before) {
            let told = DVec2::from_angle(0.5).rotate(p) + motion.shift;
            assert!(after.iter().any(|q| q.distance(told) < 1e-6), "{scales:?}: {told} not in {after:?}");
        }
    }
    let glb = building::glb(&building::house());
    let length = u32::from_le_bytes(glb[12..16].try_into().unwrap()) as usize;
    let mut json: Value = serde_json::from_slice(&glb[20..20 + length]).unwrap();
    below(&mut json, &[[1.0, 1.0, 1.5]]);
    json["buffers"][0]["uri"] =
        format!("data:application/octet-stream;base64,{}", base64(&glb[28 + length..])).into();
    let text = json.to_string();
    let settings = Settings::new(Partial::default()).unwrap();
    let input = Input::new("h.gltf", text.as_bytes(), 1);
    let told = enfilade_pipeline::analyse(&input, &settings, &Cancel::default()).unwrap().0.report;
    let told: Vec<String> = told.problems.iter().map(ToString::to_string).collect();
    assert_says(&told.join("\n"), &["would turn it, but its node hangs below one that scales unevenly"]);
    assert!(!told.iter().any(|t| t.contains("INSERT")), "{told:?}");
}

/// A scene exported with Z up is read as it stands, and told.
#[test]
fn a_scene_with_z_up_is_told() {
    let glb = building::glb(&building::house());
    let length = u32::from_le_bytes(glb[12..16].try_into().unwrap()) as usize;
    let told = |turn: Value| {
        let mut json: Value = serde_json::from_slice(&glb[20..20 + length]).unwrap();
        let children = json["scenes"][0]["nodes"].clone();
        let nodes = json["nodes"].as_array_mut().unwrap();
        nodes.push(json!({"rotation": turn, "children": children}));
        json["scenes"][0]["nodes"] = json!([nodes.len() - 1]);
        json["buffers"][0]["uri"] =
            format!("data:application/octet-stream;base64,{}", base64(&glb[28 + length..])).into();
        read(&json.to_string()).map_or_else(|e| e, |r| r.1)
    };
    let half = std::f64::consts::FRAC_1_SQRT_2;
    assert_says(
        &told(json!([half, 0, 0, half])),
        &["the scene looks as if Z were up", "measure 3.00 along Z", "export it again with +Y up"],
    );
    for turn in [json!([0, 0, 0, 1]), json!([0, half, 0, half])] {
        assert!(!told(turn.clone()).contains("Z were up"), "{turn}");
    }
}

/// What cannot be read is left out with its node, its name and the reason, whatever is wrong with it.
#[test]
fn every_element_left_out_is_named() {
    type Change = fn(&mut Value);
    let cases: [(Change, &str); 16] = [
        (
            |j| j["accessors"][0]["count"] = 4_000_000_000_u64.into(),
            "mesh 0 cannot be read: /bufferViews/0: is shorter",
        ),
        (
            |j| j["accessors"][0]["byteOffset"] = "x".into(),
            "/accessors/0: has byteOffset \"x\", expected a whole number",
        ),
        (|j| j["accessors"][0]["bufferView"] = (-1).into(), "/accessors/0: has bufferView -1"),
        (|j| j["accessors"][0]["normalized"] = 1.into(), "/accessors/0: has a `normalized` that is neither"),
        (
            |j| j["accessors"][1]["componentType"] = 5126.into(),
            "/accessors/1: has indices of component type 5126",
        ),
        (|j| j["bufferViews"][0]["byteOffset"] = 9e18.into(), "/bufferViews/0: has byteOffset 9e18"),
        (|j| j["bufferViews"][0]["byteLength"] = Value::Null, "/bufferViews/0: has byteLength null"),
        (
            |j| j["bufferViews"][0]["byteStride"] = 1.into(),
            "/bufferViews/0: has byteStride 1, expected at least 12",
        ),
        (|j| j["meshes"][0]["primitives"][0]["mode"] = 1.into(), "points and lines alone"),
        (
            |j| j["meshes"][0]["primitives"][0]["mode"] = 7.into(),
            "/meshes/0/primitives/0: has mode 7, expected 0 to 6",
        ),
        (|j| j["meshes"][0]["primitives"][0]["mode"] = "x".into(), "has mode \"x\""),
        (|j| j["meshes"][0]["primitives"][0]["indices"] = "x".into(), "has indices \"x\""),
        (|j| j["meshes"][0]["primitives"] = json!([]), "/meshes/0: has no primitives"),
        (|j| j["nodes"][0]["mesh"] = 777.into(), "/meshes/777: does not exist"),
        (|j| j["nodes"][0]["scale"] = json!([0, 0, 0]), "it has no size"),
        (|j| j["nodes"][0]["translation"] = json!([1e308, 1e308, 0]), "it stands beyond all buildings"),
    ];
    for (change, why) in cases {
        let text = file(change);
        let (drawing, said) = read(&text).unwrap();
        assert!(drawing.entities.iter().all(|e| e.source.record != 0), "{why}: it was shown");
        let line = said.lines().find(|l| l.contains("/nodes/0 IfcWall/W: ")).unwrap_or_default();
        assert!(line.contains(why) && line.contains("left out"), "{why:?} is not in:\n{said}");
        assert!(read_report(&text).is_degraded(), "{why}");
    }
    let many = said(|j| {
        j["meshes"][0]["primitives"][0]["mode"] = 7.into();
        let nodes = j["nodes"].as_array_mut().unwrap();
        let first = nodes.len();
        nodes.extend((0..24).map(|_| json!({"name": "IfcWall/more", "mesh": 0})));
        j["scenes"][0]["nodes"] = (0..first + 24).collect();
    });
    assert_eq!(many.lines().filter(|l| l.contains("it is left out")).count(), 20, "{many}");
    assert_says(&many, &["5 more elements cannot be read and are left out"]);
}

fn read_report(text: &str) -> Report {
    let mut report = Report::default();
    let _ = gltf::read("w.gltf", text.as_bytes(), &ReadOptions::default(), &mut report);
    report
}

/// A value that is read as something else is said with what it is read as; the wall is there.
#[test]
fn a_value_read_as_something_else_is_named() {
    type Change = fn(&mut Value);
    let cases: [(Change, &str, bool); 15] = [
        (
            |j| j["nodes"][0]["translation"] = "x".into(),
            "/nodes/0/translation IfcWall/W: found \"x\", expected 3 numbers; read as if it were not there",
            true,
        ),
        (
            |j| j["nodes"][0]["scale"] = json!([1]),
            "/nodes/0/scale IfcWall/W: found [1], expected 3 numbers",
            true,
        ),
        (
            |j| j["nodes"][0]["matrix"] = json!([1, 1, 1]),
            "/nodes/0/matrix IfcWall/W: found [1, 1, 1], expected 16 numbers",
            true,
        ),
        (|j| j["nodes"][0]["rotation"] = json!([0, 0, 0, 0]), "read as no rotation", true),
        (|j| j["nodes"][0]["rotation"] = json!([0, 0, 0, 2]), "read as the same turn of length one", false),
        (
            |j| j["nodes"][0]["children"] = json!([0.5]),
            "/nodes/0/children/0 IfcWall/W: found 0.5, expected the number of a node; left out",
            true,
        ),
        (|j| j["nodes"][0]["children"] = 7.into(), "expected a list of nodes; nothing hangs there", true),
        (
            |j| j["nodes"][1]["mesh"] = "x".into(),
            "/nodes/1/mesh IfcColumn/Column: found \"x\", expected the number of a mesh; the node shows nothing",
            true,
        ),
        (
            |j| j["nodes"][1]["name"] = 5.into(),
            "/nodes/1/name: found 5, expected a text; the node has no name",
            false,
        ),
        (
            |j| j["scene"] = 9.into(),
            "/scene: found 9, expected a scene of the file; every node that hangs in no other is shown",
            true,
        ),
        (|j| j["scene"] = "x".into(), "the first scene is shown", true),
        (
            |j| j["buffers"][0]["byteLength"] = 1e18.into(),
            "/buffers/0/byteLength: found 1e18, expected a number of bytes",
            false,
        ),
        (
            |j| j["bufferViews"][0]["byteStride"] = 0.into(),
            "/bufferViews/0/byteStride: found 0, expected 4 to 252",
            false,
        ),
        (
            |j| j["extensionsRequired"] = json!(["KHR_texture_transform", "VENDOR_x"]),
            "/extensionsRequired/1: found \"VENDOR_x\", expected an extension that is known here; read without it",
            true,
        ),
        (
            |j| j["asset"]["minVersion"] = "2.1".into(),
            "/asset/minVersion: found \"2.1\", expected 2.0 at most",
            true,
        ),
    ];
    let plain = read(&file(|_| ())).unwrap();
    assert!(!plain.1.contains("expected"), "{}", plain.1);
    for (change, words, is_warned) in cases {
        let text = file(change);
        let (drawing, said) = read(&text).unwrap();
        assert_says(&said, &[words]);
        assert_eq!(read_report(&text).is_degraded(), is_warned, "{words}");
        let wall = drawing.entities.iter().find(|e| e.source.record == 0).unwrap();
        let is_kept = words.contains("/translation") || words.contains("/matrix");
        assert_eq!(matches!(wall.editable, Editable::No(_)), is_kept, "{words}");
    }
    let twice = said(|j| j["nodes"][0]["children"] = json!([1]));
    let words = "/nodes/1 IfcColumn/Column: hangs in several nodes, expected one; shown at every place, it does not move";
    assert_says(&twice, &[words]);
    let odd = said(|j| {
        let nodes = j["nodes"].as_array_mut().unwrap();
        let first = nodes.len();
        nodes.extend((0..25).map(|_| json!({"name": 5})));
        j["scenes"][0]["nodes"] = (0..first + 25).collect();
    });
    assert_says(&odd, &["5 more values are not what the standard allows"]);
}

/// A wall that ends below the cut is named as it is in an IFC.
#[test]
fn a_wall_below_the_cut_is_named() {
    let low = said(|j| {
        j["nodes"]
            .as_array_mut()
            .unwrap()
            .push(json!({"name": "IfcWall/low", "mesh": 0, "scale": [1, 0.3, 1]}))
    });
    assert!(!low.contains("do not reach"), "it is in no scene: {low}");
    let low = said(|j| {
        j["nodes"]
            .as_array_mut()
            .unwrap()
            .push(json!({"name": "IfcWall/low", "mesh": 0, "scale": [1, 0.3, 1]}));
        j["scenes"][0]["nodes"] = json!([0, 1, 2]);
    });
    assert_says(
        &low,
        &["1 wall does not reach the height of the cut and does not block sight: /nodes/2 IfcWall/low"],
    );
}

/// Marks on a node are those of all that hangs on it, and it moves as one.
#[test]
fn a_mark_holds_for_what_hangs_on_the_node() {
    let moved = json!({"enfilade": {"move": "x -1 1", "name": "screen"}});
    let nested = |marks: Value, inner: Value| {
        file(move |j| {
            j["nodes"][0] =
                json!({"name": "IfcWall/W", "extras": marks, "translation": [0, 0, 0], "children": [2, 3]});
            let parts = [
                json!({"mesh": 0, "extras": inner}),
                json!({"mesh": 0, "translation": [0, 9, 0], "name": "IfcWall/over"}),
            ];
            j["nodes"].as_array_mut().unwrap().extend(parts);
        })
    };
    let text = nested(moved.clone(), json!({}));
    let (drawing, _) = read(&text).unwrap();
    let marked: Vec<_> =
        drawing.marked.iter().map(|m| (m.name.as_str(), m.text.as_str(), m.record)).collect();
    assert_eq!(marked, [("screen", "x -1 1", 0)]);
    let wall = drawing.entities.iter().find(|e| e.source.record == 0).unwrap();
    assert_eq!((wall.layer.as_str(), wall.source.handle.as_deref()), ("IfcWall", Some("/nodes/0")));
    assert!(wall.editable.moves_whole());
    let motion = RigidMotion { turn_rad: 0.0, shift: DVec2::new(0.5, 0.25) };
    let edits = [Edit::Insert { record: 0, motion }];
    let bytes = gltf::patch("w.gltf", text.as_bytes(), &ReadOptions::default(), &edits, &[]).unwrap();
    let written: Value = serde_json::from_slice(&bytes).unwrap();
    assert_eq!(written["nodes"][0]["translation"], json!([0.5, 0, -0.25]));
    let rest = |v: &Value| (v["nodes"][2].clone(), v["nodes"][3].clone());
    assert_eq!(
        rest(&written),
        rest(&serde_json::from_str(&text).unwrap()),
        "what hangs on it stays as written"
    );

    let (drawing, _) = read(&nested(moved.clone(), json!({"enfilade": {"keep": true}}))).unwrap();
    let wall = drawing.entities.iter().find(|e| e.source.record == 0).unwrap();
    assert_eq!(
        wall.editable,
        Editable::No("extras.enfilade says keep".into()),
        "a part that stays holds the whole"
    );

    let (drawing, said) = read(&nested(moved.clone(), json!({"enfilade": {"move": "y -1 1"}}))).unwrap();
    assert_eq!(drawing.marked.len(), 1);
    assert_says(
        &said,
        &["/nodes/2: the move that extras.enfilade states is not used: it hangs on /nodes/0 IfcWall/W"],
    );

    let kept = json!({"enfilade": {"keep": true}});
    let (drawing, _) = read(&nested(kept, json!({}))).unwrap();
    let wall = drawing.entities.iter().find(|e| e.source.record == 2).unwrap();
    assert_eq!(
        wall.editable,
        Editable::No("extras.enfilade says keep".into()),
        "keep holds for what hangs on it"
    );

    // A group that two walls hang on: both move with it, and the mark alone names it.
    let group = file(|j| {
        j["nodes"]
            .as_array_mut()
            .unwrap()
            .push(json!({"children": [0, 1], "extras": {"enfilade": "x -1 1"}}));
        j["scenes"][0]["nodes"] = json!([2]);
    });
    let (drawing, said) = read(&group).unwrap();
    assert!(drawing.entities.iter().all(|e| e.source.record == 2), "{said}");
    assert_eq!(drawing.marked.iter().map(|m| m.text.as_str()).collect::<Vec<_>>(), ["x -1 1"]);
}

#[test]
fn marks_that_cannot_be_read_are_named() {
    let with = |marks: Value| read(&file(|j| j["nodes"][0]["extras"] = json!({"enfilade": marks}))).unwrap();
    for (marks, words) in [
        (
            json!(5),
            "extras.enfilade: found 5, expected an object such as {\"move\": \"x -1 1\"}; nothing is marked by it",
        ),
        (
            json!({"keep": "yes"}),
            "extras.enfilade.keep: found \"yes\", expected true or false; it is not used",
        ),
        (json!({"name": 7}), "extras.enfilade.name: found 7, expected a text; it is not used"),
        (
            json!({"query": 1}),
            "extras.enfilade.query: found 1, expected true, false or the name of a pair; it is not used",
        ),
        (
            json!({"foo": 1}),
            "extras.enfilade says \"foo\", expected one of move, name, keep, query, reference, open, remove, new, status; it is not used",
        ),
    ] {
        assert_says(&with(marks).1, &[&format!("/nodes/0 IfcWall/W: {words}")]);
    }
    // What is no text goes on as it stands, to be refused where moves are read.
    let (drawing, _) = with(json!({"move": 5}));
    assert_eq!(drawing.marked.iter().map(|m| m.text.as_str()).collect::<Vec<_>>(), ["5"]);
    let high = said(|j| {
        j["nodes"].as_array_mut().unwrap().push(
            json!({"name": "IfcWall/over", "mesh": 0, "translation": [0, 9, 0], "extras": {"enfilade": {"move": "x -1 1"}}}),
        );
        j["scenes"][0]["nodes"] = json!([0, 1, 2]);
    });
    let words = "the move that extras.enfilade states of /nodes/2 IfcWall/over is not used: nothing of it reaches the height";
    assert_says(&high, &[words]);
    let marks = json!({"enfilade": {"move": "x -1 1"}});
    for (node, words) in [
        (
            json!({"name": "empty", "extras": marks}),
            "empty: the move that extras.enfilade states is not used: neither it",
        ),
        (
            json!({"name": "IfcWall/0", "mesh": 0, "scale": [0, 0, 0], "extras": marks}),
            "used: what it shows is left out",
        ),
    ] {
        let told = said(|j| {
            j["nodes"].as_array_mut().unwrap().push(node);
            j["scenes"][0]["nodes"] = json!([0, 1, 2]);
        });
        assert_says(&told, &[words]);
        assert!(!told.contains("height of the cut and"), "{told}");
    }
}

/// What a mesh says holds for the nodes that show it; what says it elsewhere, or where it means nothing, is told.
#[test]
fn marks_that_mean_nothing_where_they_stand_are_named() {
    let moved = json!({"enfilade": {"move": "x -1 1", "name": "screen"}});
    let (drawing, told) = read(&file(|j| j["meshes"][0]["extras"] = moved.clone())).unwrap();
    let marked: Vec<_> = drawing.marked.iter().map(|m| (m.name.as_str(), m.is_named, m.record)).collect();
    assert_eq!(marked, [("screen", true, 0)], "{told}");
    // The node's own word is nearer.
    let (drawing, _) = read(&file(|j| {
        j["meshes"][0]["extras"] = moved.clone();
        j["nodes"][0]["extras"] = json!({"enfilade": "y -1 1"});
    }))
    .unwrap();
    assert_eq!(drawing.marked.iter().map(|m| m.text.as_str()).collect::<Vec<_>>(), ["y -1 1"]);
    let kept = read(&file(|j| j["meshes"][0]["extras"] = json!({"enfilade": {"keep": true}}))).unwrap().0;
    let wall = kept.entities.iter().find(|e| e.source.record == 0).unwrap();
    assert_eq!(wall.editable, Editable::No("extras.enfilade says keep".into()));

    let elsewhere = said(|j| {
        j["materials"] = json!([{"extras": {"enfilade": {"keep": true}}}]);
        j["scenes"][0]["extras"] = json!({"enfilade": {"query": true}});
        j["meshes"][0]["primitives"][0]["extras"] = moved.clone();
    });
    let words = "found extras.enfilade, expected it on a node or on its mesh; nothing is marked by it";
    for place in ["/materials/0", "/scenes/0", "/meshes/0/primitives/0"] {
        assert_says(&elsewhere, &[&format!("{place}: {words}")]);
    }

    let asked = json!({"enfilade": {"query": true}});
    let (drawing, told) = read(&file(|j| j["nodes"][0]["extras"] = asked.clone())).unwrap();
    assert!(
        drawing.entities.iter().all(|e| e.layer != "EF-QUERY"),
        "the inside of a wall is no place to stand"
    );
    assert_says(
        &told,
        &["/nodes/0 IfcWall/W: the query that extras.enfilade states is not used: it is a wall"],
    );
    // A group asks for its spaces, not for its walls.
    let group = |name: &str| {
        read(&file(|j| {
            j["nodes"][1]["name"] = name.into();
            j["nodes"].as_array_mut().unwrap().push(json!({"children": [0, 1], "extras": asked}));
            j["scenes"][0]["nodes"] = json!([2]);
        }))
        .unwrap()
    };
    let (drawing, told) = group("IfcSpace/Hall");
    let asked_of: Vec<_> =
        drawing.entities.iter().filter(|e| e.layer == "EF-QUERY").map(|e| e.source.record).collect();
    assert_eq!((asked_of, told.contains("is not used")), (vec![1], false), "{told}");
    assert_says(&group("IfcColumn/C").1, &["nothing of it is a space at the height of the cut"]);

    let both = said(|j| {
        for (n, way) in [(0, "x -1 1"), (1, "y -1 1")] {
            j["nodes"][n]["extras"] = json!({"enfilade": {"move": way, "name": "both"}});
        }
    });
    assert_says(
        &both,
        &["are both named \"both\" by extras.enfilade and move differently, \"x -1 1\" and \"y -1 1\""],
    );
}

/// What a mesh states and is read otherwise is told with the node that shows it.
#[test]
fn odd_values_of_meshes_are_named_with_their_node() {
    type Change = fn(&mut Value);
    let cases: [(Change, &str, bool); 9] = [
        (
            |j| j["accessors"][1]["count"] = (j["accessors"][1]["count"].as_u64().unwrap() - 1).into(),
            "/meshes/0/primitives/0: found 35 indices, expected a multiple of 3; the last two are left out",
            true,
        ),
        (
            |j| {
                j["meshes"][0]["primitives"][0]["mode"] = 5.into();
                j["accessors"][1]["count"] = 2.into();
            },
            "/meshes/0/primitives/0: found 2 indices, expected 3 at least; it shows nothing",
            true,
        ),
        (
            |j| j["accessors"][0]["normalized"] = true.into(),
            "/accessors/0: found `normalized` on component type 5126, expected it on whole numbers",
            false,
        ),
        (
            |j| j["accessors"][1]["normalized"] = true.into(),
            "/accessors/1: found `normalized` on indices, expected plain numbers",
            false,
        ),
        (
            |j| j["accessors"][0]["max"] = json!([9, 9, 9]),
            "/accessors/0: found max [9.0, 9.0, 9.0], expected [",
            true,
        ),
        (
            |j| j["accessors"][0]["min"] = json!([9, 9, 9]),
            "/accessors/0: found min [9.0, 9.0, 9.0], expected [",
            true,
        ),
        (
            |j| j["nodes"][0]["matrix"] = json!([1, 0, 0, 0.5, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]),
            "found a last row of 0.5, 0, 0, 1, expected 0, 0, 0, 1; read as if it were so, it stays where it is",
            true,
        ),
        (
            |j| j["buffers"][0]["byteLength"] = 7.into(),
            "/buffers/0/byteLength: found 7, expected at least the ",
            false,
        ),
        (
            |j| {
                j["nodes"].as_array_mut().unwrap().push(Value::Null);
                j["scenes"][0]["nodes"] = json!([0, 1, 2]);
            },
            "/nodes/2: found null, expected a node; it shows nothing",
            true,
        ),
    ];
    for (change, words, is_warned) in cases {
        let text = file(change);
        let (drawing, told) = read(&text).unwrap();
        assert_says(&told, &[words]);
        let line = told.lines().find(|l| l.contains(words)).unwrap();
        assert!(line.contains("/nodes/") || line.contains("/buffers/"), "{line}");
        assert_eq!(read_report(&text).is_degraded(), is_warned, "{told}");
        let wall = drawing.entities.iter().find(|e| e.source.record == 0);
        assert_eq!(wall.is_none(), words.contains("it shows nothing") && words.contains("meshes"), "{words}");
        if words.contains("last row") {
            assert!(
                matches!(wall.unwrap().editable, Editable::No(_)),
                "it would be written as what it is not"
            );
        }
    }
    let point = said(|j| j["accessors"][1]["count"] = 0.into());
    assert!(!point.contains("multiple of 3"), "{point}");
}

/// Where nodes bear GlobalIds alone, what is missing is said.
#[test]
fn a_scene_of_global_ids_says_what_it_lacks() {
    let ids = |j: &mut Value| {
        j["nodes"][0]["name"] = "0BTBFw6f90Nfh9rP1dlXr2".into();
        j["nodes"][1]["name"] = "0BTBFw6f90Nfh9rP1dlXr$".into();
    };
    assert_says(
        &said(ids),
        &[
            "everything that is cut blocks sight; 2 of 2 nodes are named by GlobalIds of an IFC",
            "that .ifc beside it",
        ],
    );
    let names = said(|j| {
        j["nodes"][0]["name"] = "Cube".into();
        j["nodes"][1]["name"] = "Box".into();
    });
    assert!(names.contains("everything that is cut blocks sight") && !names.contains("GlobalId"), "{names}");
}

/// A scene whose numbers can be no metres says so with the option that helps, and one that says nothing of walls is
/// believed.
#[test]
fn a_scene_in_an_unlikely_unit_is_named() {
    let scaled = |times: f64, names: [&'static str; 2]| {
        read(&file(move |j| {
            j["nodes"]
                .as_array_mut()
                .unwrap()
                .push(json!({"scale": [times, times, times], "children": [0, 1]}));
            j["scenes"][0]["nodes"] = json!([2]);
            names.iter().enumerate().for_each(|(i, n)| j["nodes"][i]["name"] = (*n).into());
        }))
        .unwrap()
    };
    let named = ["IfcWall/W", "IfcColumn/Column"];
    let (drawing, _) = scaled(1000.0, named);
    assert_eq!(drawing.unit_by_heights.map(|u| u.name), Some("mm"));
    assert_says(&drawing.declared_unit_words, &["in which it has walls 3000 m high"]);
    let (drawing, said) = scaled(0.001, named);
    assert_eq!(drawing.unit_by_heights, None);
    assert_says(
        &said,
        &["unit: walls 0.00300 m high in m, expected walls 2 to 6 m high; --unit 1000m reads it"],
    );
    let unnamed = ["Cube", "Box"];
    assert_says(
        &scaled(1000.0, unnamed).1,
        &["all of it is 3000 m high and ", "--unit mm reads it 3.00 m high"],
    );
    assert!(!scaled(1.0, unnamed).1.contains("--unit"));
}

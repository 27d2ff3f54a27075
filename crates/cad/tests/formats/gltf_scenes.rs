//! What a scene says of what is shown: hidden nodes, meshes shown many times, storeys.

use std::collections::BTreeMap;

use base64::Engine;
use enfilade_cad::drawing::{Addition, Drawing, Edit, Editable, EntityWork, Mark, RigidMotion};
use enfilade_cad::gltf::INSTANCES_MAX;
use enfilade_cad::{ReadOptions, StoreyInfo, patch, read, storeys};
use enfilade_report::Report;
use glam::DVec2;
use serde_json::{Value, json};

/// A scene of one cube of 1 m from its origin, shown by nodes; with accessors of more data.
#[derive(Default)]
struct Scene {
    nodes: Vec<Value>,
    roots: Option<Vec<usize>>,
    more: Vec<(Value, Vec<u8>)>,
}

/// A wall of a name: least corner and size in plan and height.
fn wall(name: &str, [x, y, z]: [f64; 3], [along, across, high]: [f64; 3]) -> Value {
    json!({"name": name, "mesh": 0, "translation": [x, z, -y], "scale": [along, high, -across]})
}

impl Scene {
    fn of(nodes: impl IntoIterator<Item = Value>) -> Self {
        Self { nodes: nodes.into_iter().collect(), ..Self::default() }
    }

    fn bytes(&self) -> Vec<u8> {
        let corners = (0..8u16).flat_map(|k| [0, 1, 2].map(|axis| f32::from(k >> axis & 1)));
        let mut data: Vec<u8> = corners.flat_map(f32::to_le_bytes).collect();
        let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6u16]];
        let corners = faces.iter().flat_map(|[a, b, c, d]| [*a, *b, *c, *a, *c, *d]);
        data.extend(corners.flat_map(u16::to_le_bytes));
        let mut views = vec![
            json!({"buffer": 0, "byteOffset": 0, "byteLength": 96}),
            json!({"buffer": 0, "byteOffset": 96, "byteLength": 72}),
        ];
        let mut accessors = vec![
            json!({"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 1]}),
            json!({"bufferView": 1, "componentType": 5123, "count": 36, "type": "SCALAR"}),
        ];
        for (accessor, bytes) in &self.more {
            views.push(json!({"buffer": 0, "byteOffset": data.len(), "byteLength": bytes.len()}));
            data.extend(bytes);
            data.resize(data.len().next_multiple_of(4), 0);
            let mut accessor = accessor.clone();
            accessor["bufferView"] = json!(views.len() - 1);
            accessors.push(accessor);
        }
        let length = data.len();
        let data = base64::engine::general_purpose::STANDARD.encode(data);
        let roots = self.roots.clone().unwrap_or_else(|| (0..self.nodes.len()).collect());
        let scene = json!({
            "asset": {"version": "2.0"}, "scenes": [{"nodes": roots}], "nodes": self.nodes,
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
            "accessors": accessors, "bufferViews": views,
            "buffers": [{"byteLength": length, "uri": format!("data:application/octet-stream;base64,{data}")}],
        });
        scene.to_string().into_bytes()
    }

    /// The drawing, and what was said by its codes.
    fn read(&self, storey: Option<&str>) -> (Drawing, BTreeMap<String, Vec<String>>) {
        let options = ReadOptions { storey: storey.map(Into::into), ..ReadOptions::default() };
        let mut report = Report::default();
        let drawing = read("a.gltf", &self.bytes(), &options, &mut report).unwrap();
        let mut told: BTreeMap<String, Vec<String>> = BTreeMap::new();
        report.problems.iter().for_each(|p| told.entry(p.code.to_string()).or_default().push(p.text.clone()));
        (drawing, told)
    }
}

/// Boxes of what is drawn, mm.
fn boxes(drawing: &Drawing) -> Vec<[i64; 4]> {
    let one = |e: &enfilade_cad::drawing::Entity| {
        let points = enfilade_cad::curve::control_points(&e.shape);
        let [lo, hi] = enfilade_cad::plane::box_of(points.into_iter()).unwrap();
        [lo.x, lo.y, hi.x, hi.y].map(|v| (v * 1000.0).round() as i64)
    };
    let mut out: Vec<_> = drawing.entities.iter().map(one).collect();
    out.sort_unstable();
    out
}

fn hiding(mut node: Value, visible: Value) -> Value {
    node["extensions"] = json!({"KHR_node_visibility": {"visible": visible}});
    node
}

#[test]
fn what_the_file_hides_is_not_read() {
    let walls =
        || [wall("Wall a", [0.0; 3], [4.0, 0.2, 2.8]), wall("Wall b", [0.0, 3.0, 0.0], [4.0, 0.2, 2.8])];
    let [a, b] = walls();
    for (nodes, roots, shown, told) in [
        (
            vec![a.clone(), hiding(b.clone(), json!(false))],
            vec![0, 1],
            1,
            Some("1 node with a mesh is left out"),
        ),
        (vec![a.clone(), hiding(b.clone(), json!(true))], vec![0, 1], 2, None),
        (
            vec![
                a.clone(),
                hiding(b.clone(), json!(true)),
                hiding(json!({"children": [1, 3]}), json!(false)),
                wall("Door", [0.0; 3], [1.0; 3]),
            ],
            vec![0, 2],
            1,
            Some("2 nodes with meshes are left out"),
        ),
        (vec![a, hiding(b, json!("no"))], vec![0, 1], 2, None),
    ] {
        let scene = Scene { nodes, roots: Some(roots), ..Scene::default() };
        let (drawing, said) = scene.read(None);
        assert_eq!(drawing.entities.len(), shown, "{said:?}");
        let hidden = said.get("gltf-hidden").map(|t| t[0].as_str());
        assert_eq!(hidden.is_some(), told.is_some(), "{said:?}");
        assert!(told.is_none_or(|t| hidden.is_some_and(|h| h.starts_with(t))), "{hidden:?}");
        let is_odd = scene.nodes.iter().any(|n| n["extensions"]["KHR_node_visibility"]["visible"] == "no");
        assert_eq!(said.contains_key("gltf-value"), is_odd, "{said:?}");
    }
}

/// A hidden node cannot be moved.
#[test]
fn what_is_hidden_does_not_move() {
    let [a, b] =
        [wall("Wall a", [0.0; 3], [4.0, 0.2, 2.8]), wall("Wall b", [0.0, 3.0, 0.0], [4.0, 0.2, 2.8])];
    let bytes = Scene::of([a, hiding(b, json!(false))]).bytes();
    let edit = moved(1);
    let error = patch("a.gltf", &bytes, &ReadOptions::default(), &[edit], &[]).unwrap_err().to_string();
    assert!(error.contains("it is not shown exactly once"), "{error}");
}

fn moved(record: usize) -> Edit {
    let motion = RigidMotion { turn_rad: 0.0, shift: DVec2::X };
    Edit::Insert { record, motion }
}

/// A node of columns of 0.3 m that an accessor of each name shows many times.
fn many(attributes: &[(&str, Value, Vec<u8>)]) -> Scene {
    let mut columns = wall("Columns", [10.0, 0.0, 0.0], [0.3, 0.3, 2.8]);
    let names = attributes.iter().enumerate().map(|(i, (name, ..))| ((*name).to_string(), json!(2 + i)));
    let names: serde_json::Map<String, Value> = names.collect();
    columns["extensions"] = json!({"EXT_mesh_gpu_instancing": {"attributes": names}});
    let more = attributes.iter().map(|(_, accessor, data)| (accessor.clone(), data.clone()));
    Scene { more: more.collect(), ..Scene::of([wall("Wall a", [0.0; 3], [4.0, 0.2, 2.8]), columns]) }
}

fn floats(values: &[f32]) -> Vec<u8> {
    values.iter().flat_map(|v| v.to_le_bytes()).collect()
}

fn accessor(kind: u32, count: usize, of: &str) -> Value {
    json!({"componentType": kind, "count": count, "type": of, "normalized": kind != 5126})
}

/// Two columns, in coordinates of their node, which is scaled by their size.
fn two() -> (&'static str, Value, Vec<u8>) {
    ("TRANSLATION", accessor(5126, 2, "VEC3"), floats(&[10.0, 0.0, 0.0, 20.0, 0.0, -10.0]))
}

#[test]
fn a_mesh_stands_at_each_of_its_instances_and_not_at_its_node() {
    // A quarter turn about the height takes a cube behind its origin: x to -z.
    let turn = |kind: u32, data: Vec<u8>| ("ROTATION", accessor(kind, 2, "VEC4"), data);
    let half = std::f32::consts::FRAC_1_SQRT_2;
    let none_and_quarter = [0.0, 0.0, 0.0, 1.0, 0.0, half, 0.0, half];
    let scaled = |most: f32| none_and_quarter.map(|v| (v * most).round() as i16);
    let bytes = scaled(127.0).iter().map(|v| *v as i8 as u8).collect();
    let shorts = scaled(32767.0).iter().flat_map(|v| v.to_le_bytes()).collect();
    let wall = [0, 0, 4000, 200];
    let straight = vec![wall, [13000, 0, 13300, 300], [16000, -3000, 16300, -2700]];
    let turned = vec![wall, [13000, 0, 13300, 300], [16000, -3300, 16300, -3000]];
    let size = ("SCALE", accessor(5126, 2, "VEC3"), floats(&[1.0, 1.0, 1.0, 2.0, 1.0, 1.0]));
    let wide = vec![wall, [13000, 0, 13300, 300], [16000, -3000, 16600, -2700]];
    for (attributes, expected) in [
        (vec![two()], straight),
        (vec![two(), turn(5126, floats(&none_and_quarter))], turned.clone()),
        (vec![two(), turn(5120, bytes)], turned.clone()),
        (vec![two(), turn(5122, shorts)], turned),
        (vec![two(), size], wide),
    ] {
        let scene = many(&attributes);
        let (drawing, said) = scene.read(None);
        let near = |a: &[i64; 4], b: &[i64; 4]| a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1);
        let found = boxes(&drawing);
        assert!(
            found.len() == expected.len() && found.iter().zip(&expected).all(|(a, b)| near(a, b)),
            "{found:?}"
        );
        assert!(!said.contains_key("gltf-mesh") && !said.contains_key("gltf-value"), "{said:?}");
    }
}

#[test]
fn instances_stay() {
    let scene = many(&[two()]);
    let (drawing, _) = scene.read(None);
    let held = drawing.entities.iter().filter(|e| e.source.record == 1);
    let why: Vec<_> = held.map(|e| e.editable.clone()).collect();
    let expected = Editable::No("it is one of many instances of a node (EXT_mesh_gpu_instancing)".into());
    assert_eq!(why, vec![expected; 2]);
    let drop = Edit::Work { record: 1, work: EntityWork::Drop };
    for edit in [moved(1), drop] {
        let error = patch("a.gltf", &scene.bytes(), &ReadOptions::default(), &[edit], &[]).unwrap_err();
        assert!(error.to_string().contains("one of many instances"), "{error}");
    }
}

#[test]
fn instances_that_cannot_be_read_are_told_and_stand_nowhere() {
    let empty = || accessor(5126, 0, "VEC3");
    let counted = |count: usize| ("TRANSLATION", accessor(5126, count, "VEC3"), floats(&[0.0; 6]));
    for (attributes, says) in [
        (vec![], "expected TRANSLATION, ROTATION or SCALE"),
        (vec![counted(9)], "is shorter than what is read from it"),
        (vec![("TRANSLATION", accessor(5126, 2, "VEC4"), floats(&[0.0; 8]))], "is of another type"),
        (vec![two(), ("SCALE", empty(), Vec::new())], "expected as many of each"),
        (vec![counted(INSTANCES_MAX + 1)], "expected at most 100000"),
    ] {
        let (drawing, said) = many(&attributes).read(None);
        assert_eq!(boxes(&drawing), [[0, 0, 4000, 200]], "{said:?}");
        assert!(said["gltf-mesh"].iter().any(|t| t.contains(says)), "{said:?}");
    }
}

/// Walls of a room on a floor, so many; names begin with a text.
fn room(name: &str, floor: f64, count: usize) -> Vec<Value> {
    let at = |i: usize| [0.0, 2.0 * i as f64, floor];
    (0..count)
        .map(|i| wall(&format!("{name} {}", char::from(b'a' + i as u8)), at(i), [6.0, 0.2, 2.8]))
        .collect()
}

/// Walls below groups of a name each.
fn grouped(groups: &[(&str, f64, usize)]) -> Scene {
    let mut scene = Scene::default();
    let mut roots = Vec::new();
    for (name, floor, count) in groups {
        let first = scene.nodes.len();
        scene.nodes.extend(room("Wall", *floor, *count));
        roots.push(scene.nodes.len());
        scene.nodes.push(json!({"name": name, "children": (first..first + count).collect::<Vec<_>>()}));
    }
    scene.nodes.push(json!({"name": "House at Level 3 Road", "children": roots}));
    Scene { roots: Some(vec![scene.nodes.len() - 1]), ..scene }
}

fn listed(found: &[StoreyInfo]) -> Vec<(String, i64, usize)> {
    found.iter().map(|s| (s.name.clone(), (s.floor_m * 100.0).round() as i64, s.walls)).collect()
}

fn found(scene: &Scene) -> Vec<(String, i64, usize)> {
    listed(&storeys("a.gltf", &scene.bytes(), &ReadOptions::default()))
}

#[test]
fn storeys_are_found_by_names_and_heights() {
    let walls = |list: &[(&str, f64, usize)]| Scene::of(list.iter().flat_map(|(n, z, c)| room(n, *z, *c)));
    let shelves = (0..4).map(|i| wall("Cube", [f64::from(i), 9.0, 3.0], [0.4, 0.4, 2.1]));
    let tower = [wall("Wall tall", [9.0, 0.0, 0.0], [1.0, 0.2, 5.8])];
    let parapets = (0..4).map(|i| wall("Wall", [0.0, f64::from(i), 3.0], [6.0, 0.2, 0.9]));
    for (scene, expected) in [
        (grouped(&[("Level 1", 0.0, 3), ("Level 2", 3.0, 4)]), vec![("Level 1", 0, 3), ("Level 2", 300, 4)]),
        (
            grouped(&[("1.OG", 2.8, 1), ("EG", 0.0, 2), ("2.OG", 5.6, 1)]),
            vec![("EG", 0, 2), ("1.OG", 280, 1), ("2.OG", 560, 1)],
        ),
        (
            grouped(&[("Ground floor", 0.0, 2), ("First floor", 3.0, 2)]),
            vec![("Ground floor", 0, 2), ("First floor", 300, 2)],
        ),
        (
            grouped(&[("Floor_01 walls", 0.0, 2), ("Floor_01 cores", 0.0, 1), ("Storey 2", 3.0, 2)]),
            vec![("Floor 01", 0, 3), ("Storey 2", 300, 2)],
        ),
        (
            grouped(&[("IfcBuildingStorey/Hall", 0.0, 2), ("IfcBuildingStorey/Attic", 3.0, 1)]),
            vec![("Hall", 0, 2), ("Attic", 300, 1)],
        ),
        (
            grouped(&[("Level -1", -3.0, 2), ("Level 1", 0.0, 3)]),
            vec![("Level -1", -300, 2), ("Level 1", 0, 3)],
        ),
        (grouped(&[("Level 1 west", 0.0, 2), ("Level 1 east", 1.4, 1)]), vec![]),
        (grouped(&[("Level 1", 0.0, 2), ("Level 2", 1.4, 1)]), vec![("Level 1", 0, 2), ("Level 2", 140, 1)]),
        (grouped(&[("Level 1", 0.0, 3)]), vec![]),
        (grouped(&[("First bedroom", 0.0, 2), ("Second bedroom", 3.0, 2)]), vec![]),
        (
            grouped(&[("Level 1", 0.0, 3), ("Attic room", 3.0, 3)]),
            vec![("Level 1", 0, 3), ("floor 2", 300, 3)],
        ),
        (walls(&[("Wall EG", 0.0, 3), ("Wall OG", 3.0, 2)]), vec![("EG", 0, 3), ("OG", 300, 2)]),
        (walls(&[("Wall", 0.0, 4), ("Wall up", 3.0, 3)]), vec![("floor 1", 0, 4), ("floor 2", 300, 3)]),
        (walls(&[("Wall", 0.0, 4), ("Wall up", 1.9, 3)]), vec![]),
        (walls(&[("Wall", 0.0, 4), ("Wall up", 3.0, 2)]), vec![]),
        (walls(&[("Cube", 0.0, 4), ("Cube up", 3.0, 4)]), vec![("floor 1", 0, 4), ("floor 2", 300, 4)]),
        (walls(&[("Cube", 0.0, 4), ("Cube up", 3.0, 2)]), vec![]),
        (
            walls(&[("Cube", 0.0, 5), ("Cube up", 3.1, 4), ("Cube top", 6.2, 3)]),
            vec![("floor 1", 0, 5), ("floor 2", 310, 4), ("floor 3", 620, 3)],
        ),
        (Scene::of(room("Cube", 0.0, 4).into_iter().chain(shelves)), vec![]),
        (Scene::of(room("Wall", 0.0, 4).into_iter().chain(parapets)), vec![]),
        (
            Scene::of(room("Wall", 0.0, 3).into_iter().chain(room("Wall", 3.0, 3)).chain(tower)),
            vec![("floor 1", 0, 4), ("floor 2", 300, 3)],
        ),
        (walls(&[("Wall", 0.0, 4), ("Column", 3.0, 4)]), vec![]),
        (
            Scene::of(
                room("Wall", 0.0, 3).into_iter().chain(room("Wall", 2.9, 2)).chain(room("Wall", 3.1, 2)),
            ),
            vec![("floor 1", 0, 3), ("floor 2", 290, 4)],
        ),
    ] {
        let expected: Vec<_> = expected.into_iter().map(|(n, z, w)| (n.to_string(), z, w)).collect();
        assert_eq!(found(&scene), expected, "{:?}", scene.nodes);
    }
}

/// The storey of most walls is read by default; names and numbers from the lowest take another.
#[test]
fn a_storey_is_chosen_by_name_or_number() {
    let scene = grouped(&[("Level 1", 0.0, 3), ("Level 2", 3.0, 4)]);
    let list = "storeys: 1 \"Level 1\" (floor 0.000 m, 3 walls), 2 \"Level 2\" (floor 3.000 m, 4 walls); \"Level 2\" has the \
                most walls and was taken, --storey NAME takes another";
    for (wanted, walls, storey, note) in [
        (None, 4, "Level 2", Some(list)),
        (Some("Level 1"), 3, "Level 1", None),
        (Some("level 1"), 3, "Level 1", None),
        (Some("2"), 4, "Level 2", None),
    ] {
        let (drawing, said) = scene.read(wanted);
        assert_eq!(drawing.entities.len(), walls, "{wanted:?}");
        assert_eq!(said.get("storey").map(|t| t[0].as_str()), note);
        let floor = if storey == "Level 1" { "0.000" } else { "3.000" };
        assert_eq!(
            said["storey-cut"],
            [format!("storey \"{storey}\" cut 1.50 m above its floor at {floor} m")]
        );
    }
    let options = ReadOptions { storey: Some("Attic".into()), ..ReadOptions::default() };
    let error = read("a.gltf", &scene.bytes(), &options, &mut Report::default()).unwrap_err().to_string();
    assert!(error.contains("storeys present, by number and name: 1 \"Level 1\" (floor"), "{error}");
}

/// A scene of one storey has none, and says so as before.
#[test]
fn a_scene_of_one_storey_has_no_storeys() {
    let (drawing, said) = grouped(&[("Level 1", 0.5, 3)]).read(None);
    assert_eq!(drawing.entities.len(), 3);
    assert_eq!(said["gltf-cut"], ["no storeys in glTF; cut 1.5 m above the floor found at 0.500 m"]);
    assert!(!said.contains_key("storey") && !said.contains_key("storey-cut"), "{said:?}");
}

/// What is low or flat in another storey than the one that is read is not told.
#[test]
fn other_storeys_are_not_told_of() {
    let mut scene = grouped(&[("Level 1", 0.0, 3), ("Level 2", 3.0, 4)]);
    let low = scene.nodes.len();
    scene.nodes.push(wall("Wall z", [0.0, 9.0, 0.0], [6.0, 0.2, 1.0]));
    let children = scene.nodes[3]["children"].as_array_mut().unwrap();
    children.push(json!(low));
    for (storey, is_told) in [("Level 1", true), ("Level 2", false)] {
        let (_, said) = scene.read(Some(storey));
        assert_eq!(said.contains_key("gltf-not-cut"), is_told, "{said:?}");
    }
}

/// What is added lies on the floor of the storey that was read, also where works have made another one that of most walls.
#[test]
fn additions_stay_on_the_storey_that_was_read() {
    let scene = grouped(&[("Level 1", 0.0, 3), ("Level 2", 3.0, 4)]);
    let drops = [4, 5].map(|record| Edit::Work { record, work: EntityWork::Drop });
    let own = Addition {
        layer: "EF-NOTE".into(),
        rgb: [0, 0, 0],
        mark: Mark::Path { points: vec![DVec2::ZERO, DVec2::X], closed: false },
    };
    let written = patch("a.gltf", &scene.bytes(), &ReadOptions::default(), &drops, &[own]).unwrap();
    let json: Value = serde_json::from_slice(&written).unwrap();
    let height =
        json["accessors"].as_array().unwrap().iter().find_map(|a| a["min"][1].as_f64().filter(|y| *y > 0.0));
    assert!(height.is_some_and(|y| (y - 3.02).abs() < 1e-3), "{height:?}");
}

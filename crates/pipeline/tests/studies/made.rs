//! Works of the list made in the drawing: read again they measure what the list says, and nothing else of the file changes.

use std::collections::BTreeMap;

use base64::Engine;
use enfilade_config::{Partial, Settings};
use enfilade_fixtures::sample;
use enfilade_overlay::works::WorkEntry;
use enfilade_pipeline::works::{MadeWorks, make_works, works_of};
use enfilade_pipeline::{Input, works};
use enfilade_report::{Cancel, Error};

fn settings() -> Settings {
    Settings::new(Partial::default()).unwrap()
}

/// The best work of each kind.
fn of_each_kind(file: &str) -> (Vec<u8>, BTreeMap<String, WorkEntry>) {
    let bytes = std::fs::read(sample(file)).unwrap();
    let input = Input::new(file, &bytes, 1);
    let (listed, _) = works_of(&input, &settings(), &Cancel::default()).unwrap();
    let mut out = BTreeMap::new();
    for work in listed.result.works {
        out.entry(work.kind.clone()).or_insert(work);
    }
    (bytes, out)
}

fn made(file: &str, bytes: &[u8], ids: &[usize]) -> Result<MadeWorks, Error> {
    make_works(&Input::new(file, bytes, 1), &settings(), ids, &Cancel::default())
}

/// Each kind once, alone: list and file differ by a tenth of a percent at most.
fn as_listed(file: &str, in_the_file: &[&str]) {
    let (bytes, kinds) = of_each_kind(file);
    assert!(kinds.len() >= 5, "{:?}", kinds.keys());
    for (kind, work) in &kinds {
        let made = made(file, &bytes, &[work.id]).unwrap();
        assert!((made.expected - made.gain).abs() < 1e-3, "{file} {kind}: {} {}", made.expected, made.gain);
        let is_in_the_file = made.tables.is_empty();
        assert_eq!(is_in_the_file, in_the_file.contains(&kind.as_str()), "{file} {kind}");
        assert_eq!(made.bytes == bytes, !is_in_the_file, "{file} {kind}");
        assert_eq!(made.report.problems.iter().any(|p| p.code == "work-decided"), !is_in_the_file);
    }
}

#[test]
fn works_are_cut_into_a_drawing() {
    as_listed("flat.dxf", &["open", "door", "widen", "remove", "close", "rehang", "glaze"]);
}

#[test]
fn openings_and_removals_are_written_into_a_building() {
    as_listed("flat.ifc", &["open", "door", "widen", "remove", "close", "rehang", "glaze"]);
}

/// What is new is placed by what it belongs to: an opening by its wall, a door by its opening, a wall by its storey.
#[test]
fn what_is_new_in_a_building_is_placed_by_what_it_belongs_to() {
    let (bytes, kinds) = of_each_kind("flat.ifc");
    for kind in ["open", "door", "glaze", "close"] {
        let made = made("flat.ifc", &bytes, &[kinds[kind].id]).unwrap();
        let (old, new) = (String::from_utf8_lossy(&bytes), String::from_utf8_lossy(&made.bytes).into_owned());
        let placed = new.lines().filter(|l| l.contains("=IFCLOCALPLACEMENT(") && !old.contains(*l));
        let placed: Vec<&str> = placed.collect();
        assert!(!placed.is_empty() && placed.iter().all(|l| l.contains("PLACEMENT(#")), "{kind}: {placed:?}");
    }
}

const OF_SCENES: [&str; 8] = ["open", "door", "widen", "remove", "close", "rehang", "glaze", "end"];

#[test]
fn works_are_cut_into_a_scene() {
    as_listed("flat.glb", &OF_SCENES);
    as_listed("pavilion.glb", &OF_SCENES);
}

/// JSON and binary data of a scene.
fn scene(bytes: &[u8]) -> (serde_json::Value, Vec<u8>) {
    let length = u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    (serde_json::from_slice(&bytes[20..20 + length]).unwrap(), bytes[28 + length..].to_vec())
}

/// A scene as text, its data embedded.
fn as_text((mut json, data): (serde_json::Value, Vec<u8>)) -> Vec<u8> {
    let text = base64::engine::general_purpose::STANDARD.encode(data);
    json["buffers"][0]["uri"] = format!("data:application/octet-stream;base64,{text}").into();
    serde_json::to_vec_pretty(&json).unwrap()
}

/// All walls of the flat in one mesh, which a text does not take apart: the works are cut into it.
#[test]
fn works_are_cut_into_one_mesh_of_all_walls() {
    let (mut json, data) = scene(&std::fs::read(sample("flat.glb")).unwrap());
    let is_wall = |n: &serde_json::Value| n["name"].as_str().is_some_and(|n| n.starts_with("Wall"));
    let nodes = json["nodes"].as_array().unwrap().clone();
    let walls: Vec<usize> = (0..nodes.len()).filter(|i| is_wall(&nodes[*i])).collect();
    let (joined, bytes) = one_mesh(&json, &data, &walls);
    json = joined;
    let text = as_text((json, bytes));
    let input = Input::new("flat.gltf", &text, 1);
    let (listed, _) = works_of(&input, &settings(), &Cancel::default()).unwrap();
    let mut seen = std::collections::BTreeSet::new();
    for work in listed.result.works.iter().filter(|w| seen.insert(w.kind.clone())) {
        let made = made("flat.gltf", &text, &[work.id]).unwrap();
        assert!(made.tables.is_empty(), "{}: {:?}", work.kind, made.report.problems);
        assert!((made.expected - made.gain).abs() < 1e-3, "{}: {} {}", work.kind, made.expected, made.gain);
    }
    assert!(seen.len() >= 6, "{seen:?}");
}

/// The first of some nodes shows the meshes of all, each where it stands; the others show nothing.
fn one_mesh(json: &serde_json::Value, data: &[u8], nodes: &[usize]) -> (serde_json::Value, Vec<u8>) {
    let (mut json, mut data) = (json.clone(), data.to_vec());
    let mut all = Vec::new();
    for n in nodes {
        let node = &json["nodes"][*n];
        assert!(
            node.get("rotation").is_none() && node.get("scale").is_none() && node.get("matrix").is_none()
        );
        let at = node.get("translation").map_or([0.0; 3], |t| [0, 1, 2].map(|k| t[k].as_f64().unwrap()));
        let mesh = node["mesh"].as_u64().unwrap() as usize;
        for mut primitive in json["meshes"][mesh]["primitives"].as_array().unwrap().clone() {
            let old = primitive["attributes"]["POSITION"].as_u64().unwrap() as usize;
            let mut accessor = json["accessors"][old].clone();
            let view = json["bufferViews"][accessor["bufferView"].as_u64().unwrap() as usize].clone();
            let of = |v: &serde_json::Value| v["byteOffset"].as_u64().unwrap_or(0) as usize;
            let (start, count) = (of(&view) + of(&accessor), accessor["count"].as_u64().unwrap() as usize);
            let moved: Vec<u8> = (0..3 * count)
                .flat_map(|i| {
                    let four = data[start + 4 * i..start + 4 * i + 4].try_into().unwrap();
                    (f64::from(f32::from_le_bytes(four)) + at[i % 3])
                        .to_string()
                        .parse::<f32>()
                        .unwrap()
                        .to_le_bytes()
                })
                .collect();
            data.resize(data.len().next_multiple_of(4), 0);
            let new = serde_json::json!({"buffer": 0, "byteOffset": data.len(), "byteLength": moved.len()});
            data.extend(moved);
            json["bufferViews"].as_array_mut().unwrap().push(new);
            for key in ["min", "max"] {
                let bound = [0, 1, 2].map(|k| accessor[key][k].as_f64().unwrap() + at[k]);
                accessor[key] = serde_json::json!(bound);
            }
            accessor["bufferView"] = (json["bufferViews"].as_array().unwrap().len() - 1).into();
            accessor["byteOffset"] = 0.into();
            json["accessors"].as_array_mut().unwrap().push(accessor);
            primitive["attributes"] =
                serde_json::json!({"POSITION": json["accessors"].as_array().unwrap().len() - 1});
            all.push(primitive);
        }
    }
    for n in nodes {
        json["nodes"][*n].as_object_mut().unwrap().remove("mesh");
    }
    let meshes = json["meshes"].as_array_mut().unwrap();
    meshes.push(serde_json::json!({"name": "walls", "primitives": all}));
    let index = meshes.len() - 1;
    json["nodes"][nodes[0]] = serde_json::json!({"name": "walls", "mesh": index});
    json["buffers"][0]["byteLength"] = data.len().into();
    (json, data)
}

/// What is not cut is decided beside the scene, and said.
#[test]
fn what_a_scene_cannot_hold_is_decided_beside_it() {
    let (bytes, kinds) = of_each_kind("flat.glb");
    let (mut json, data) = scene(&bytes);
    for mesh in json["meshes"].as_array_mut().unwrap() {
        let place = mesh["primitives"][0]["attributes"]["POSITION"].clone();
        mesh["primitives"][0]["targets"] = serde_json::json!([{"POSITION": place}]);
    }
    let bytes = as_text((json, data));
    for kind in ["open", "door", "glaze"] {
        let made = made("flat.gltf", &bytes, &[kinds[kind].id]).unwrap();
        assert!(!made.tables.is_empty() && made.bytes == bytes, "{kind}");
        assert!(made.report.problems.iter().any(|p| p.code == "work-decided"), "{kind}");
        assert!((made.expected - made.gain).abs() < 1e-3, "{kind}: {} {}", made.expected, made.gain);
    }
}

/// What is demolished goes to a layer of its own by one group; its other bytes stay.
#[test]
fn a_removal_changes_one_group_of_each_line() {
    let (bytes, kinds) = of_each_kind("flat.dxf");
    let made = made("flat.dxf", &bytes, &[kinds["remove"].id]).unwrap();
    let [old, new] = [&bytes, &made.bytes].map(|b| String::from_utf8_lossy(b).into_owned());
    let records = |text: &str, layer: &str| -> Vec<String> {
        let all = text.split("\n  0\n").map(str::to_owned);
        all.filter(|r| r.contains(&format!("\n  8\n{layer}\n"))).collect()
    };
    let gone = records(&new, "EF-DEMOLISHED");
    // Two faces of a partition with a door: its leaf and its swing go too; and the outline of it all.
    assert!(gone.len() >= 3, "{gone:?}");
    let lines: Vec<&String> = gone.iter().filter(|r| r.starts_with("LINE")).collect();
    assert!(lines.len() >= 2);
    for line in lines {
        let was = line.replace("\nEF-DEMOLISHED\n", "\nA-WALL-PART\n");
        assert!(old.contains(&was), "{line}");
    }
}

/// An outline of the whole house runs past its doors and windows; it does not go with them.
#[test]
fn what_only_runs_past_an_opening_stays() {
    let bytes = std::fs::read(sample("flat.dxf")).unwrap();
    let text = String::from_utf8(bytes).unwrap();
    let corners = [[4000.0, 6150.0], [9000.0, 6150.0], [9000.0, 12000.0], [4000.0, 12000.0]];
    let points: String = corners.iter().map(|[x, y]| format!(" 10\n{x}\n 20\n{y}\n")).collect();
    let outline = format!("LWPOLYLINE\n  5\nFFF0\n  8\nA-FOOTPRINT\n 90\n4\n 70\n1\n{points}  0\n");
    let at = text.find("  2\nENTITIES\n  0\n").unwrap() + "  2\nENTITIES\n  0\n".len();
    let drawn = [&text[..at], &outline, &text[at..]].concat();
    let input = Input::new("flat.dxf", drawn.as_bytes(), 1);
    let (listed, _) = works_of(&input, &settings(), &Cancel::default()).unwrap();
    let close = listed.result.works.iter().filter(|w| w.kind == "close" || w.kind == "widen");
    let mut marks = 0;
    for work in close {
        let made = made("flat.dxf", drawn.as_bytes(), &[work.id]).unwrap();
        let new = String::from_utf8(made.bytes).unwrap();
        assert!(new.contains("\n  5\nFFF0\n  8\nA-FOOTPRINT\n"), "{work:?}");
        marks += usize::from(new.contains("\nEF-DEMOLISHED\n"));
    }
    assert!(marks > 0);
}

/// Undone by hand: what lies on the layer goes back to where it was, what was drawn anew goes.
#[test]
fn a_wall_put_back_measures_as_before() {
    let (bytes, kinds) = of_each_kind("flat.dxf");
    let work = &kinds["remove"];
    let made = made("flat.dxf", &bytes, &[work.id]).unwrap();
    let text = String::from_utf8(made.bytes).unwrap();
    let back =
        text.split_inclusive("\n  0\n")
            .map(|r| {
                if r.starts_with("LINE") {
                    r.replace("\nEF-DEMOLISHED\n", "\nA-WALL-PART\n")
                } else {
                    r.into()
                }
            })
            .collect::<String>();
    let input = Input::new("flat.dxf", back.as_bytes(), 1);
    let (again, _) = works::works_of(&input, &settings(), &Cancel::default()).unwrap();
    let same = |w: &&WorkEntry| w.kind == "remove" && w.stretch == work.stretch;
    let found = again.result.works.iter().find(same).unwrap();
    let share = |w: &WorkEntry| w.gain["visibility"].share;
    assert!((share(found) - share(work)).abs() < 2e-3, "{} {}", share(found), share(work));
}

#[test]
fn a_number_that_the_list_lacks_is_refused() {
    let bytes = std::fs::read(sample("flat.dxf")).unwrap();
    for id in [0, 10_000] {
        assert!(matches!(made("flat.dxf", &bytes, &[id]), Err(Error::Usage(_))));
    }
    // Both cut the same wall.
    let (_, kinds) = of_each_kind("flat.dxf");
    let twice = kinds["open"].id;
    assert!(matches!(made("flat.dxf", &bytes, &[twice, twice]), Err(Error::Usage(_))));
}

/// What is demolished is no wall, whether it is still drawn or taken out.
#[test]
fn what_is_taken_out_changes_no_measure() {
    for file in ["flat.dxf", "flat.ifc"] {
        let (bytes, kinds) = of_each_kind(file);
        let made = made(file, &bytes, &[kinds["remove"].id]).unwrap().bytes;
        let (cleaned, count) = enfilade_cad::without_demolished(file, &made).unwrap();
        assert!(count > 0 && cleaned.len() < made.len(), "{file}");
        let mean = |bytes: &[u8]| {
            let input = Input::new(file, bytes, 1);
            enfilade_pipeline::analyse(&input, &settings(), &Cancel::default()).unwrap().0.result.mean
        };
        assert_eq!(mean(&cleaned), mean(&made), "{file}");
    }
}

/// A wall that ends at a door leaves no jamb in the air.
#[test]
fn a_wall_beside_doors_goes_as_listed() {
    let bytes = std::fs::read(sample("small-office.glb")).unwrap();
    let input = Input::new("small-office.glb", &bytes, 1);
    let (listed, _) = works_of(&input, &settings(), &Cancel::default()).unwrap();
    let at = |work: &WorkEntry, x: f64, y: f64| (work.stretch[0][0] - x).hypot(work.stretch[0][1] - y) < 0.1;
    for [x, y] in [[13.5, 4.95], [17.05, 4.95], [6.33, 4.95]] {
        let work = listed.result.works.iter().find(|w| w.kind == "remove" && at(w, x, y)).unwrap();
        let made = made("small-office.glb", &bytes, &[work.id]).unwrap();
        assert!(made.tables.is_empty());
        assert!((made.expected - made.gain).abs() < 1e-3, "{x} {y}: {} {}", made.expected, made.gain);
    }
}

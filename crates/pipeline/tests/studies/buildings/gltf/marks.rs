//! Marks of a scene that are not used: they are named, and nothing moves by default where one says what moves or stays.

use enfilade_cad::drawing::IdleMarks;
use enfilade_config::{Partial, Settings};
use enfilade_pipeline::Input;
use enfilade_report::Cancel;
use serde_json::{Value, json};

use super::{assert_says, file, read};
use crate::buildings::building;

/// A scene whose marks are none of moves, or say what stays and can be read, is as without them.
#[test]
fn a_mark_that_is_not_used_may_have_meant_what_moves() {
    let on_node = |mark: Value| file(|j| j["nodes"][0]["extras"] = mark);
    let ours = |mark: Value| on_node(json!({ "enfilade": mark }));
    let moves = json!({"enfilade": {"move": "x -1 1"}});
    let unshown = |node: Value| file(|j| j["nodes"].as_array_mut().unwrap().push(node));
    for (text, words, decides) in [
        (ours(json!({"moves": "x -1 1"})), "extras.enfilade says \"moves\", expected one of", true),
        (ours(json!(5)), "extras.enfilade: found 5", true),
        (ours(json!({"keep": "always"})), "extras.enfilade.keep: found \"always\"", true),
        (on_node(json!({"Enfilade": "x -1 1"})), "extras says \"Enfilade\", expected \"enfilade\"", true),
        (on_node(json!({"enfilade_move": "x -1 1"})), "extras says \"enfilade_move\"", true),
        (
            file(|j| j["materials"] = json!([{"extras": moves}])),
            "/materials/0: found extras.enfilade, expected it on a node or on its mesh",
            true,
        ),
        (
            file(|j| j["materials"] = json!([{"extras": {"enfilade": {"query": true}}}])),
            "/materials/0: found extras.enfilade",
            false,
        ),
        (
            unshown(json!({"name": "away", "mesh": 0, "extras": moves})),
            "/nodes/2 away: found extras.enfilade where the scene shows nothing",
            true,
        ),
        (
            file(|j| {
                let mut mesh = j["meshes"][0].clone();
                mesh["extras"] = moves.clone();
                j["meshes"].as_array_mut().unwrap().push(mesh);
            }),
            "/meshes/2: found extras.enfilade where the scene shows nothing",
            true,
        ),
        (
            file(|j| {
                let low = json!({"name": "IfcWall/low", "mesh": 0, "scale": [1, 0.3, 1], "extras": moves});
                j["nodes"].as_array_mut().unwrap().push(low);
                j["scenes"][0]["nodes"] = json!([0, 1, 2]);
            }),
            "is not used: nothing of it reaches the height of the cut",
            true,
        ),
        (ours(json!({"name": 7})), "extras.enfilade.name: found 7", false),
        (ours(json!({"query": 1})), "extras.enfilade.query: found 1", false),
        (ours(json!({"keep": true})), "", false),
        (ours(json!({"move": " "})), "", false),
        (unshown(json!({"name": "EF-HEAT", "extras": {"enfilade": {"layer": "EF-HEAT"}}})), "", false),
    ] {
        let (drawing, said) = read(&text).unwrap();
        assert_says(&said, &[words]);
        assert!(drawing.marked.is_empty(), "{words}");
        assert_eq!(drawing.idle_marks == IdleMarks::Unusable, decides, "{words}: {said}");
    }
}

/// A house of which one node is changed; what is said of it.
fn told(change: impl Fn(&mut Value)) -> Vec<String> {
    let walls = building::house().into_iter().map(|w| building::Wall { moves: None, ..w });
    let glb = building::glb(&walls.collect::<Vec<_>>());
    let length = u32::from_le_bytes(glb[12..16].try_into().unwrap()) as usize;
    let mut json: Value = serde_json::from_slice(&glb[20..20 + length]).unwrap();
    let data = super::base64(&glb[28 + length..]);
    json["buffers"][0]["uri"] = format!("data:application/octet-stream;base64,{data}").into();
    let screen = json["nodes"].as_array_mut().unwrap().iter_mut().find(|n| n["name"] == "IfcWall/Screen A");
    change(screen.unwrap());
    let settings = Settings::new(Partial { spacing: Some(0.8), ..Partial::default() }).unwrap();
    let text = json.to_string();
    let input = Input::new("house.gltf", text.as_bytes(), 1);
    let (outcome, _) = enfilade_pipeline::analyse(&input, &settings, &Cancel::default()).unwrap();
    outcome.report.problems.iter().map(|p| p.code.to_string()).collect()
}

#[test]
fn nothing_moves_by_default_beside_a_mark_that_is_not_used() {
    let has = |codes: &[String], code: &str| codes.iter().any(|c| c == code);
    let plain = told(|_| ());
    assert!(has(&plain, "default-moves") && !has(&plain, "moves-unread"), "{plain:?}");
    for mark in [json!({"enfilade": {"moves": "x -1 1"}}), json!({"Enfilade": {"move": "x -1 1"}})] {
        let codes = told(|node| node["extras"] = mark.clone());
        assert!(!has(&codes, "default-moves") && has(&codes, "moves-unread"), "{mark}: {codes:?}");
    }
    let low = told(|node| {
        node["extras"] = json!({"enfilade": {"move": "x -1 1"}});
        node["scale"] = json!([1, 0.3, 1]);
    });
    assert!(!has(&low, "default-moves") && has(&low, "moves-unread"), "{low:?}");
}

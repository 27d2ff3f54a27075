//! Walls that share a mesh: what of them moves as one, and that they are written as they were searched.

use enfilade_cad::ReadOptions;
use enfilade_cad::drawing::{Edit, RigidMotion, Shape};
use enfilade_config::{MoveTable, Partial, RegionTable, Settings};
use enfilade_pipeline::Input;
use enfilade_report::{Cancel, Report};
use glam::DVec2;

use super::{patch, points, read, u32_at, walls_of_one_mesh, with_json};

/// The pieces of its mesh are no elements of their own, at the cut or not, named or not.
#[test]
fn a_node_that_says_how_it_moves_is_one_group() {
    let bytes = walls_of_one_mesh();
    let (nameless, named) =
        (serde_json::json!("x -0.5 0.5"), serde_json::json!({"move": "x -0.5 0.5", "name": "a"}));
    let of_node = |mark: &serde_json::Value| {
        with_json(&bytes, |json| json["nodes"][0]["extras"] = serde_json::json!({"enfilade": mark}))
    };
    let of_mesh =
        with_json(&bytes, |json| json["meshes"][0]["extras"] = serde_json::json!({"enfilade": nameless}));
    for bytes in [of_node(&nameless), of_node(&named), of_mesh] {
        let before = read(&bytes);
        assert_eq!(before.entities.len(), 3);
        assert!(before.entities.iter().all(|e| e.source.record == 0), "{before:?}");
        assert_eq!(before.marked.iter().map(|m| m.record).collect::<Vec<_>>(), [0]);
        let motion = RigidMotion { turn_rad: 0.25, shift: DVec2::new(0.5, 0.0) };
        let moved = patch(&bytes, &[Edit::Insert { record: 0, motion }], &[]).unwrap();
        // Turned, the rings of one node may begin elsewhere.
        let after: Vec<DVec2> = read(&moved).entities.iter().flat_map(points).collect();
        for p in before.entities.iter().flat_map(points) {
            let told = DVec2::from_angle(motion.turn_rad).rotate(p) + motion.shift;
            assert!(after.iter().any(|q| (*q - told).length() < 2e-6), "{p} is not at {told} in {after:?}");
        }
        let data = |bytes: &[u8]| bytes[28 + u32_at(bytes, 12)..].to_vec();
        assert_eq!(data(&moved), data(&bytes), "the node moves, its vertices stay");
    }
}

/// Vertices have seven digits: a layout that the file cannot hold is never measured.
#[test]
fn what_is_searched_is_what_is_written() {
    let bytes = walls_of_one_mesh();
    let [lo, hi] = [[-3.0, -3.0], [9.0, 7.0]];
    let ring = vec![lo, [hi[0], lo[1]], hi, [lo[0], hi[1]]];
    let region = |kind: &str| RegionTable { kind: kind.into(), pair: None, points: ring.clone() };
    let table = MoveTable {
        name: None,
        moves: "x -20 20; y -20 20; rotate -90 90".into(),
        nodes: Vec::new(),
        handles: vec!["/nodes/0".into()],
        layers: Vec::new(),
        marker: None,
    };
    let partial = Partial {
        spacing: Some(1.0),
        regions: vec![region("query"), region("reference")],
        moves: vec![table],
        ..Partial::default()
    };
    let settings = Settings::new(partial).unwrap();
    let input = Input::new("house.glb", &bytes, 1);
    let (_, study) = enfilade_pipeline::analyse(&input, &settings, &Cancel::default()).unwrap();
    let (base, mut rounded) = (&study.base, 0);
    for p in [[13.377_7, -8.123_4, 0.0], [0.111_111, 17.3, 0.0], [7.654_321, 2.345_678, 33.3]] {
        let layout = base.moves.apply(&base.plan, &base.graph, &p);
        assert_eq!(layout.walls.iter().filter(|w| w.is_changed).count(), 3);
        let edit = |w: &enfilade_moves::MovedWall| Edit::Insert {
            record: base.plan.walls[w.wall as usize].source.record,
            motion: w.motion.unwrap(),
        };
        let edits: Vec<Edit> = layout.walls.iter().map(edit).collect();
        let moved = patch(&bytes, &edits, &[]).unwrap();
        let after = enfilade_cad::read("house.glb", &moved, &ReadOptions::default(), &mut Report::default());
        for (wall, e) in layout.walls.iter().zip(&after.unwrap().entities) {
            let (Shape::Polyline { vertices, .. }, RigidMotion { turn_rad, shift }) =
                (&base.plan.walls[wall.wall as usize].shape, wall.motion.unwrap())
            else {
                panic!("{wall:?}");
            };
            let um = |p: &DVec2| base.plan.frame.um_from_file(*p);
            assert_eq!(wall.trace.points, points(e).iter().map(um).collect::<Vec<_>>(), "{p:?}");
            let exact = vertices.iter().map(|v| DVec2::from_angle(turn_rad).rotate(v.at) + shift);
            rounded += exact.zip(&wall.trace.points).filter(|(p, held)| um(p) != **held).count();
        }
    }
    assert!(rounded > 0, "nothing that seven digits round was tried");
}

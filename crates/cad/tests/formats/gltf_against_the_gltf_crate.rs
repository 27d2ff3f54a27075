//! Where elements stand in the plan, against the `gltf` crate: it reads, checks and places every node by itself.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a failing helper fails the test")]

use std::collections::BTreeMap;

use enfilade_cad::curve::control_points;
use enfilade_cad::{ReadOptions, read};
use enfilade_report::Report;
use glam::{DMat4, DVec2, DVec3};

/// Single precision at the size of a building, metres.
const SAME_M: f64 = 1e-4;

/// Box of the plan of one node.
type Boxes = BTreeMap<usize, [DVec2; 2]>;

fn extend(boxes: &mut Boxes, node: usize, p: DVec2) {
    let known = boxes.entry(node).or_insert([p, p]);
    *known = [known[0].min(p), known[1].max(p)];
}

/// The nodes with meshes as the crate places them, seen from above.
fn theirs(bytes: &[u8]) -> Boxes {
    let scene = gltf::Gltf::from_slice(bytes).unwrap();
    let data = scene.blob.clone().unwrap();
    let mut out = Boxes::new();
    let mut left: Vec<(gltf::Node<'_>, DMat4)> =
        scene.default_scene().unwrap().nodes().map(|n| (n, DMat4::IDENTITY)).collect();
    while let Some((node, above)) = left.pop() {
        let own = glam::Mat4::from_cols_array_2d(&node.transform().matrix()).as_dmat4();
        let world = above * own;
        for primitive in node.mesh().iter().flat_map(gltf::Mesh::primitives) {
            let reader = primitive.reader(|_| Some(&data));
            for p in reader.read_positions().unwrap() {
                let at = world.transform_point3(DVec3::from_array(p.map(f64::from)));
                extend(&mut out, node.index(), DVec2::new(at.x, -at.z));
            }
        }
        left.extend(node.children().map(|c| (c, world)));
    }
    out
}

fn ours(file: &str, bytes: &[u8]) -> Boxes {
    let drawing = read(file, bytes, &ReadOptions::default(), &mut Report::default()).unwrap();
    let mut out = Boxes::new();
    for e in &drawing.entities {
        let path = enfilade_cad::gltf::path_of(e.source.record);
        let node = path.strip_prefix("/nodes/").unwrap().parse().unwrap();
        control_points(&e.shape).into_iter().for_each(|p| extend(&mut out, node, p));
    }
    out
}

#[test]
fn elements_stand_where_the_crate_places_them() {
    for file in ["flat.glb", "pavilion.glb", "school-wing.glb", "small-office.glb"] {
        let bytes = std::fs::read(enfilade_fixtures::sample(file)).unwrap();
        let (ours, theirs) = (ours(file, &bytes), theirs(&bytes));
        let mut whole = 0;
        for (node, [lo, hi]) in &ours {
            let [least, most] = theirs[node];
            let is_within = lo.cmpge(least - SAME_M).all() && hi.cmple(most + SAME_M).all();
            assert!(is_within, "{file}: node {node}: {lo} {hi}, {least} {most}");
            whole += usize::from(lo.distance(least) < SAME_M && hi.distance(most) < SAME_M);
        }
        // What is cut at the height of eyes is the whole element but for openings at an end, and for what is lower.
        assert!(ours.len() > 10 && whole * 10 > ours.len() * 7, "{file}: {whole} of {}", ours.len());
    }
}

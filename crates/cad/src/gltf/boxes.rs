//! What is built in a scene: upright boxes, each a node with a mesh of its own.

use glam::{DAffine3, DVec2, DVec3};

use super::append::{Append, quoted};
use super::json::{Json, Value};
use super::motion::{text, z_up};
use super::scene::File;
use super::soup::Blob;

/// What a new box is, and where it stands.
pub(super) struct NewBox<'b> {
    /// Name of its node; none where nothing has a name that says what it is.
    pub name: Option<&'b str>,
    /// Its corners, Z up, units of the scene.
    pub ring: [DVec2; 4],
    /// Its lower and its upper end.
    pub heights: [f64; 2],
    /// World transform of what it hangs on, Y up.
    pub parent: DAffine3,
    /// What it is made of.
    pub look: Look,
}

/// What something is made of.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Look {
    /// Index of the material.
    pub material: Option<usize>,
    /// Sets of coordinates of pictures that the material may ask for.
    pub pictures: usize,
}

impl Look {
    /// That of the first faces of a mesh.
    pub fn of(scene: &File<'_>, mesh: usize) -> Self {
        let found = scene.json.list("meshes").get(mesh).and_then(|m| m.list("primitives").first());
        let Some(primitive) = found else { return Self::default() };
        let named = match primitive.get("attributes").map(|a| &a.value) {
            Some(Value::Object(named)) => named.iter().filter(|(k, _)| k.starts_with("TEXCOORD_")).count(),
            _ => 0,
        };
        Self { material: primitive.index("material"), pictures: named }
    }
}

/// One vertex of a box: its place, the way out, and where on its face it is, metres of the scene.
struct Vertex {
    at: DVec3,
    out: DVec3,
    on: DVec2,
}

/// Adds the node and the mesh of a box; the index of the node.
pub(super) fn add(root: &Json, append: &mut Append, blob: &mut Blob, new: &NewBox<'_>) -> usize {
    let to_parent = new.parent.inverse() * z_up().inverse();
    let from = to_parent.transform_point3(new.ring[0].extend(new.heights[0]));
    let vertices = vertices(new);
    let to_normals = (z_up() * new.parent).matrix3.transpose();
    let places: Vec<f64> =
        vertices.iter().flat_map(|v| (to_parent.transform_point3(v.at) - from).to_array()).collect();
    let normals: Vec<f64> =
        vertices.iter().flat_map(|v| (to_normals * v.out).normalize_or_zero().to_array()).collect();
    let on: Vec<f64> = vertices.iter().flat_map(|v| v.on.to_array()).collect();
    let round = if new.parent.matrix3.determinant() < 0.0 { [0, 2, 1, 0, 3, 2] } else { [0, 1, 2, 0, 2, 3] };
    let indices: Vec<u32> = (0..6u32).flat_map(|face| round.map(|i| 4 * face + i)).collect();
    let mut attributes = vec![
        format!("\"POSITION\":{}", blob.floats(root, append, "POSITION", 3, &places)),
        format!("\"NORMAL\":{}", blob.floats(root, append, "NORMAL", 3, &normals)),
    ];
    if new.look.pictures > 0 {
        let accessor = blob.floats(root, append, "TEXCOORD", 2, &on);
        attributes.extend((0..new.look.pictures).map(|k| format!("\"TEXCOORD_{k}\":{accessor}")));
    }
    let indices = blob.indices(root, append, &indices);
    let material = new.look.material.map_or(String::new(), |m| format!(",\"material\":{m}"));
    let name = new.name.map_or(String::new(), |n| format!("\"name\":{},", quoted(n)));
    let mesh = format!(
        "{{{name}\"primitives\":[{{\"attributes\":{{{}}},\"indices\":{indices}{material}}}]}}",
        attributes.join(",")
    );
    let mesh = append.push(root, "meshes", mesh);
    let at = from.to_array().map(text).join(",");
    let node = format!(
        "{{{name}\"mesh\":{mesh},\"translation\":[{at}],\"extras\":{{\"enfilade\":{{\"status\":\"new\"}}}}}}"
    );
    append.push(root, "nodes", node)
}

/// Four vertices a face, each face seen from outside the way round that viewers want.
fn vertices(new: &NewBox<'_>) -> Vec<Vertex> {
    let mut ring = new.ring;
    let doubled: f64 = (0..4).map(|i| ring[i].perp_dot(ring[(i + 1) % 4])).sum();
    if doubled < 0.0 {
        ring.reverse();
    }
    let [low, high] = new.heights;
    let mut out = Vec::new();
    for k in 0..4 {
        let (a, b) = (ring[k], ring[(k + 1) % 4]);
        let (along, normal) = (a.distance(b), -(b - a).normalize_or_zero().perp().extend(0.0));
        for (p, u, z) in [(a, 0.0, low), (b, along, low), (b, along, high), (a, 0.0, high)] {
            out.push(Vertex { at: p.extend(z), out: normal, on: DVec2::new(u, z - low) });
        }
    }
    let lid = |z: f64, out: DVec3| move |p: DVec2| Vertex { at: p.extend(z), out, on: p };
    out.extend(ring.map(lid(high, DVec3::Z)));
    ring.reverse();
    out.extend(ring.map(lid(low, DVec3::NEG_Z)));
    out
}

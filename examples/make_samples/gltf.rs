//! The building as glTF 2.0: a node and a mesh for every wall, its doors and windows hanging on it, marks in
//! `extras.enfilade`.

use super::building::{Opening, Space, Wall, storeys};
use super::dxf::Point;

/// A box in the coordinates of its node: along the wall, up, and towards the reader.
type Block = [[f64; 2]; 3];

#[derive(Default)]
struct Writer {
    data: Vec<u8>,
    views: Vec<String>,
    accessors: Vec<String>,
    meshes: Vec<String>,
    nodes: Vec<Node>,
}

/// A node without its braces, and what hangs on it.
struct Node {
    text: String,
    children: Vec<usize>,
    is_child: bool,
}

impl Node {
    fn json(&self) -> String {
        let children: Vec<String> = self.children.iter().map(|c| c.to_string()).collect();
        match children.len() {
            0 => format!("{{{}}}", self.text),
            _ => format!(r#"{{{},"children":[{}]}}"#, self.text, children.join(",")),
        }
    }
}

const FACES: [[u32; 6]; 6] = [
    [0, 2, 1, 1, 2, 3],
    [4, 5, 6, 5, 7, 6],
    [0, 1, 4, 1, 5, 4],
    [2, 6, 3, 3, 6, 7],
    [0, 4, 2, 2, 4, 6],
    [1, 3, 5, 3, 7, 5],
];

impl Writer {
    fn view(&mut self, bytes: &[u8], target: u32) -> usize {
        let at = self.data.len();
        self.data.extend_from_slice(bytes);
        self.views.push(format!(
            r#"{{"buffer":0,"byteOffset":{at},"byteLength":{},"target":{target}}}"#,
            bytes.len()
        ));
        self.views.len() - 1
    }

    fn mesh(&mut self, name: &str, blocks: &[Block]) -> usize {
        let (mut points, mut indices): (Vec<[f32; 3]>, Vec<u32>) = (Vec::new(), Vec::new());
        for block in blocks {
            let first = points.len() as u32;
            for i in 0..8 {
                let pick = |axis: usize| block[axis][i >> axis & 1] as f32;
                points.push([pick(0), pick(1), pick(2)]);
            }
            indices.extend(FACES.iter().flatten().map(|c| first + c));
        }
        let bytes: Vec<u8> = points.iter().flatten().flat_map(|v| v.to_le_bytes()).collect();
        let view = self.view(&bytes, 34962);
        let bound = |pick: fn(f32, f32) -> f32| {
            let all = points.iter().copied().reduce(|a, b| [0, 1, 2].map(|k| pick(a[k], b[k])));
            all.unwrap_or_default().map(|v| format!("{v}")).join(",")
        };
        self.accessors.push(format!(
            r#"{{"bufferView":{view},"componentType":5126,"count":{},"type":"VEC3","min":[{}],"max":[{}]}}"#,
            points.len(),
            bound(f32::min),
            bound(f32::max)
        ));
        let bytes: Vec<u8> = indices.iter().flat_map(|v| v.to_le_bytes()).collect();
        let view = self.view(&bytes, 34963);
        self.accessors.push(format!(
            r#"{{"bufferView":{view},"componentType":5125,"count":{},"type":"SCALAR"}}"#,
            indices.len()
        ));
        let n = self.accessors.len();
        self.meshes.push(format!(
            r#"{{"name":"{name}","primitives":[{{"attributes":{{"POSITION":{}}},"indices":{}}}]}}"#,
            n - 2,
            n - 1
        ));
        self.meshes.len() - 1
    }

    fn node(&mut self, name: &str, (x, y): Point, z: f64, direction: Point, mesh: usize, extras: &str) {
        let turn = direction.1.atan2(direction.0) / 2.0;
        let rotation = if turn == 0.0 {
            String::new()
        } else {
            format!(r#","rotation":[0,{},0,{}]"#, turn.sin(), turn.cos())
        };
        let text =
            format!(r#""name":"{name}","mesh":{mesh},"translation":[{x},{z},{}]{rotation}{extras}"#, -y);
        self.nodes.push(Node { text, children: Vec::new(), is_child: false });
    }

    /// A door or a window on the node of its wall, as deep as that, as a frame is.
    fn filler(&mut self, wall: usize, name: &str, o: &Opening, half: f64) {
        let mesh = self.mesh(name, &[[[0.0, o.width], [0.0, o.height], [-half, half]]]);
        let class = if o.is_door { "IfcDoor" } else { "IfcWindow" };
        self.node(&format!("{class}/{name}"), (o.at, 0.0), o.sill, (1.0, 0.0), mesh, "");
        let own = self.nodes.len() - 1;
        self.nodes[own].is_child = true;
        self.nodes[wall].children.push(own);
    }

    fn wall(&mut self, w: &Wall, floor: f64) {
        let half = w.thickness / 2.0;
        let across = [-half, half];
        let mut blocks: Vec<Block> = Vec::new();
        let mut at = 0.0;
        for o in &w.openings {
            blocks.push([[at, o.at], [0.0, w.height], across]);
            let span = [o.at, o.at + o.width];
            if o.sill > 0.0 {
                blocks.push([span, [0.0, o.sill], across]);
            }
            blocks.push([span, [o.sill + o.height, w.height], across]);
            at = o.at + o.width;
        }
        blocks.push([[at, w.length()], [0.0, w.height], across]);
        let class = if w.is_column { "IfcColumn" } else { "IfcWall" };
        let mesh = self.mesh(w.name, &blocks);
        let extras = w.moves.map_or(String::new(), |m| {
            format!(r#","extras":{{"enfilade":{{"move":"{m}","name":"{}"}}}}"#, w.name)
        });
        self.node(&format!("{class}/{}", w.name), w.from, floor, w.direction(), mesh, &extras);
    }

    fn space(&mut self, s: &Space, floor: f64) {
        let (x, y) = (s.high.0 - s.low.0, s.high.1 - s.low.1);
        let mesh = self.mesh(s.name, &[[[0.0, x], [0.0, 2.9], [-y, 0.0]]]);
        let flags: Vec<&str> = [(s.is_query, r#""query":true"#), (s.is_reference, r#""reference":true"#)]
            .iter()
            .filter(|f| f.0)
            .map(|f| f.1)
            .collect();
        let extras = if flags.is_empty() {
            String::new()
        } else {
            format!(r#","extras":{{"enfilade":{{{}}}}}"#, flags.join(","))
        };
        self.node(&format!("IfcSpace/{}", s.name), s.low, floor, (1.0, 0.0), mesh, &extras);
    }
}

/// The building in the binary container.
pub fn building() -> Vec<u8> {
    let mut w = Writer::default();
    let mut filled: Vec<(usize, Wall)> = Vec::new();
    for storey in storeys() {
        for wall in storey.walls {
            filled.push((w.nodes.len(), wall));
            w.wall(&filled[filled.len() - 1].1, storey.floor);
        }
        storey.spaces.iter().for_each(|space| w.space(space, storey.floor));
    }
    for (node, wall) in &filled {
        for (i, o) in wall.openings.iter().enumerate() {
            let kind = if o.is_door { "door" } else { "window" };
            w.filler(*node, &format!("{}-{kind}-{}", wall.name, i + 1), o, wall.thickness / 2.0);
        }
    }
    let roots = (0..w.nodes.len()).filter(|i| !w.nodes[*i].is_child);
    let roots: Vec<String> = roots.map(|i| i.to_string()).collect();
    let nodes: Vec<String> = w.nodes.iter().map(Node::json).collect();
    let mut json = format!(
        concat!(
            r#"{{"asset":{{"version":"2.0","generator":"Enfilade samples"}},"scene":0,"#,
            r#""scenes":[{{"nodes":[{}]}}],"nodes":[{}],"meshes":[{}],"accessors":[{}],"#,
            r#""bufferViews":[{}],"buffers":[{{"byteLength":{}}}]}}"#
        ),
        roots.join(","),
        nodes.join(","),
        w.meshes.join(","),
        w.accessors.join(","),
        w.views.join(","),
        w.data.len()
    )
    .into_bytes();
    while json.len() % 4 != 0 {
        json.push(b' ');
    }
    let mut out = b"glTF\x02\0\0\0".to_vec();
    out.extend(((28 + json.len() + w.data.len()) as u32).to_le_bytes());
    for (kind, bytes) in [(b"JSON", &json), (b"BIN\0", &w.data)] {
        out.extend((bytes.len() as u32).to_le_bytes());
        out.extend(kind);
        out.extend(bytes);
    }
    out
}

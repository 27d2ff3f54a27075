//! A file taken apart: JSON, binary data, nodes with their place in the world.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};
use std::sync::{Arc, OnceLock};

use base64::Engine;
use glam::{DAffine3, DMat4, DQuat, DVec3};

use super::glb::{AGAIN, Chunk, chunks, fault};
use super::json::{Json, Value, parse};
use super::limits::{DATA_MAX, DEPTH_MAX, NODES_MAX, OUTER_MAX, REPEATS_MAX};
use crate::own_layers;
use enfilade_report::Error;

/// Data of a buffer, or why there is none.
pub(super) type Data<'a> = Result<Cow<'a, [u8]>, String>;

/// A file as read.
#[derive(Clone, Debug)]
pub(super) struct File<'a> {
    /// Name to show.
    pub name: &'a str,
    /// The whole file.
    pub bytes: &'a [u8],
    /// Chunks; empty for a `.gltf`.
    pub chunks: Vec<Chunk>,
    /// The JSON; spans count from the start of its text.
    pub json: Json,
    /// Data of every buffer, or why there is none.
    pub buffers: Vec<Data<'a>>,
    /// Who uses what, counted when it is first asked for.
    uses: OnceLock<Uses>,
}

/// How often meshes are shown, and by how many meshes vertex data is used.
#[derive(Clone, Debug, Default)]
struct Uses {
    nodes_of_mesh: HashMap<usize, usize>,
    meshes_of_accessor: HashMap<usize, usize>,
}

/// Vertex data that moves with a piece of a mesh.
pub(super) const VERTEX_DATA: [&str; 3] = ["POSITION", "NORMAL", "TANGENT"];

/// A node shown in the scene.
#[derive(Clone, Debug)]
pub(super) struct Shown {
    /// Its index.
    pub node: usize,
    /// World transform of its parent, Y up.
    pub parent: DAffine3,
    /// Its own world transform, Y up.
    pub world: DAffine3,
    /// The ways of all that is shown, and where its own ends: what hangs on one node shares the way to it.
    ways: Arc<Vec<Link>>,
    at: usize,
}

/// One node on the way from a root.
#[derive(Clone, Debug)]
struct Link {
    node: usize,
    /// The link of what it hangs on.
    above: Option<usize>,
    /// Whether it, or what it hangs on, is ours by its name.
    is_own: bool,
}

impl Shown {
    /// Nodes from the root, itself last.
    pub fn path(&self) -> Vec<usize> {
        let mut next = Some(self.at);
        let up = std::iter::from_fn(|| {
            let link = &self.ways[next?];
            next = link.above;
            Some(link.node)
        });
        let mut out: Vec<usize> = up.collect();
        out.reverse();
        out
    }

    /// Whether it, or what it hangs on, is ours by its name.
    pub fn is_own(&self) -> bool {
        self.ways[self.at].is_own
    }

    /// Names from the root, its own last; empty where a node has none.
    pub fn names<'j>(&'j self, scene: &'j File<'_>) -> impl DoubleEndedIterator<Item = &'j str> {
        let nodes = scene.json.list("nodes");
        self.path().into_iter().map(move |n| nodes[n].text("name").unwrap_or_default())
    }
}

/// What a scene shows, and what not.
#[derive(Clone, Debug)]
pub(super) struct Walked {
    /// Nodes that are shown, in the order of the file.
    pub shown: Vec<Shown>,
    /// What cannot be used and is left out, in words.
    pub odd: Vec<String>,
    /// Nodes with meshes that the file hides, each once (`KHR_node_visibility`).
    pub hidden: BTreeSet<usize>,
}

/// A node that is still to be looked at.
struct Open {
    node: usize,
    parent: DAffine3,
    /// The link of what it hangs on.
    above: Option<usize>,
    /// Nodes above it.
    depth: usize,
    /// Whether what it hangs on is hidden.
    is_hidden: bool,
}

impl Open {
    fn root(node: usize) -> Self {
        Self { node, parent: DAffine3::IDENTITY, above: None, depth: 0, is_hidden: false }
    }
}

/// Whether a node hides itself and all that hangs on it.
fn is_hiding(node: &Json) -> bool {
    visible(node).is_some_and(|v| v.value == Value::Bool(false))
}

/// What a node says of its visibility.
pub(super) fn visible(node: &Json) -> Option<&Json> {
    node.get("extensions")?.get("KHR_node_visibility")?.get("visible")
}

/// Members of the root that are lists; ours are put behind what is in them.
const LISTS: [&str; 9] = [
    "accessors",
    "bufferViews",
    "buffers",
    "extensionsRequired",
    "extensionsUsed",
    "materials",
    "meshes",
    "nodes",
    "scenes",
];

/// Compressions that are not unpacked.
const PACKED: [&str; 2] = ["KHR_draco_mesh_compression", "EXT_meshopt_compression"];

impl<'a> File<'a> {
    /// Takes a file apart; `beside`: files of data that lie beside it.
    pub fn open(
        name: &'a str,
        bytes: &'a [u8],
        beside: &'a BTreeMap<String, Arc<[u8]>>,
    ) -> Result<Self, Error> {
        let chunks = chunks(name, bytes)?;
        let span = match chunks.first() {
            Some(c) if c.kind == *b"JSON" => c.span.clone(),
            Some(_) => {
                return Err(fault(name, "gltf-glb", "", "the first chunk is not JSON, expected it first"));
            }
            None => 0..bytes.len(),
        };
        let json = parse(&bytes[span.clone()]).map_err(|(at, text)| {
            fault(name, "gltf-json", "", &format!("byte {}: found {text}", span.start + at))
        })?;
        let mut out = Self { name, bytes, chunks, json, buffers: Vec::new(), uses: OnceLock::new() };
        out.check()?;
        out.buffers = out.read_buffers(beside)?;
        Ok(out)
    }

    /// The text of the JSON.
    pub fn text(&self) -> &'a [u8] {
        match self.chunks.first() {
            Some(chunk) => &self.bytes[chunk.span.clone()],
            None => self.bytes,
        }
    }

    fn check(&self) -> Result<(), Error> {
        let version = self.json.get("asset").and_then(|a| a.text("version")).unwrap_or_default();
        if !version.starts_with("2.") && self.odd_version().is_none() {
            let text = format!("found version {version:?}, expected glTF 2.0; {AGAIN}");
            return Err(fault(self.name, "gltf-version", "/asset/version", &text));
        }
        let scenes = self
            .json
            .list("scenes")
            .iter()
            .enumerate()
            .map(|(i, s)| (format!("/scenes/{i}/nodes"), s.get("nodes")));
        let of_root = LISTS.iter().map(|key| (format!("/{key}"), self.json.get(key)));
        for (pointer, value) in of_root.chain(scenes) {
            if value.is_some_and(|v| !matches!(v.value, Value::Array(_))) {
                return Err(fault(self.name, "gltf-json", &pointer, "found something else, expected a list"));
            }
        }
        let required = self.json.list("extensionsRequired");
        for (i, e) in required.iter().enumerate() {
            if let Value::Text(name) = &e.value
                && PACKED.contains(&name.as_str())
            {
                let text = format!("the meshes are packed by {name}; export again without compression");
                return Err(fault(self.name, "gltf-packed", &format!("/extensionsRequired/{i}"), &text));
            }
        }
        Ok(())
    }

    /// A version that is no version, in a file laid out as 2.0 is (lists where 1.0 has objects).
    pub fn odd_version(&self) -> Option<&str> {
        let version = self.json.get("asset").and_then(|a| a.text("version"))?;
        let is_number = version.chars().next().is_some_and(|c| c.is_ascii_digit());
        let is_laid_out = !self.json.list("nodes").is_empty() && !self.json.list("accessors").is_empty();
        (!is_number && is_laid_out).then_some(version)
    }

    fn read_buffers(&self, beside: &'a BTreeMap<String, Arc<[u8]>>) -> Result<Vec<Data<'a>>, Error> {
        let mut out = Vec::new();
        let mut total = 0usize;
        for (i, buffer) in self.json.list("buffers").iter().enumerate() {
            let pointer = format!("/buffers/{i}");
            let stated = buffer.index("byteLength").unwrap_or(0);
            let data: Data<'a> = match buffer.text("uri") {
                None => {
                    let bin = self.chunks.iter().find(|c| c.kind == *b"BIN\0").filter(|_| i == 0);
                    bin.map(|c| Cow::Borrowed(&self.bytes[c.span.clone()]))
                        .ok_or_else(|| "has no data".into())
                }
                Some(uri) => match uri.strip_prefix("data:").and_then(|u| u.split_once(";base64,")) {
                    Some((_, text)) => {
                        total = total.saturating_add(text.len());
                        if total > DATA_MAX {
                            let text = format!("data URIs of more than {DATA_MAX} characters; export as GLB");
                            return Err(fault(self.name, "gltf-data", &pointer, &text));
                        }
                        let data = base64::engine::general_purpose::STANDARD.decode(text);
                        let data = data.map_err(|e| {
                            fault(self.name, "gltf-data", &pointer, &format!("its data URI is damaged: {e}"))
                        })?;
                        Ok(Cow::Owned(data))
                    }
                    None => outer(uri, beside),
                },
            };
            if let Ok(data) = data.as_ref()
                && data.len() < stated
            {
                let text = format!("found {} bytes, expected {stated}; the file is not finished", data.len());
                return Err(fault(self.name, "gltf-incomplete", &pointer, &text));
            }
            out.push(data);
        }
        Ok(out)
    }

    /// Nodes that hang in no other: of the scene that is shown, of the file where that names none.
    fn roots(&self) -> Vec<usize> {
        let nodes = self.json.list("nodes");
        let scene = self.json.index("scene").unwrap_or(0);
        match self.json.list("scenes").get(scene) {
            Some(s) => s.list("nodes").iter().filter_map(index).collect(),
            None => {
                let children: HashSet<usize> =
                    nodes.iter().flat_map(|p| p.list("children").iter().filter_map(index)).collect();
                (0..nodes.len()).filter(|n| !children.contains(n)).collect()
            }
        }
    }

    /// Nodes that the scene shows, in the order of the file.
    pub fn shown(&self) -> Vec<Shown> {
        self.walked().shown
    }

    /// Nodes of the shown scene in the order of the file; what hangs in a ring is left out and named, what is hidden is left
    /// out and gathered.
    pub fn walked(&self) -> Walked {
        let nodes = self.json.list("nodes");
        let roots = self.roots();
        let mut out: Vec<(usize, usize, [DAffine3; 2])> = Vec::new();
        let (mut odd, mut hidden) = (Vec::new(), BTreeSet::new());
        let (mut seen, mut repeats) = (vec![false; nodes.len()], 0);
        let mut ways: Vec<Link> = Vec::new();
        let mut open: Vec<Open> = roots.into_iter().rev().map(Open::root).collect();
        // The way to what is looked at, and which nodes are on it.
        let (mut path, mut is_on_path): (Vec<usize>, Vec<bool>) = (Vec::new(), vec![false; nodes.len()]);
        while let Some(Open { node: n, parent, above, depth, is_hidden }) = open.pop() {
            let Some(node) = nodes.get(n) else {
                odd.push(format!("/nodes/{n} does not exist; left out"));
                continue;
            };
            if depth > DEPTH_MAX {
                odd.push(format!(
                    "nodes hang deeper than {DEPTH_MAX} in each other; {} is left out",
                    self.named(n)
                ));
                continue;
            }
            path.drain(depth..).for_each(|left| is_on_path[left] = false);
            if is_on_path[n] {
                let ring: Vec<String> =
                    path.iter().skip_while(|p| **p != n).chain([&n]).map(ToString::to_string).collect();
                odd.push(format!("nodes are children of each other in a ring: {}; left out", ring.join(">")));
                continue;
            }
            repeats += usize::from(std::mem::replace(&mut seen[n], true));
            if repeats > REPEATS_MAX {
                odd.push(format!(
                    "/nodes/{n} and others hang in several nodes each, shown {REPEATS_MAX} times more than there are, \
                     expected one; the rest is left out"
                ));
                break;
            }
            if ways.len() >= NODES_MAX {
                odd.push(format!("more than {NODES_MAX} nodes are shown; the rest is left out"));
                break;
            }
            let world = parent * local(node);
            let is_hidden = is_hidden || is_hiding(node);
            path.push(n);
            is_on_path[n] = true;
            let at = ways.len();
            let is_own = own_layers::is_own(node.text("name").unwrap_or_default())
                || above.is_some_and(|link: usize| ways[link].is_own);
            ways.push(Link { node: n, above, is_own });
            let children = node.list("children").iter().filter_map(index).rev();
            open.extend(children.map(|child| Open {
                node: child,
                parent: world,
                above: Some(at),
                depth: depth + 1,
                is_hidden,
            }));
            if !is_hidden {
                out.push((at, n, [parent, world]));
            } else if node.index("mesh").is_some() && !is_own {
                hidden.insert(n);
            }
        }
        let ways = Arc::new(ways);
        let of = |(at, node, [parent, world]): (usize, usize, [DAffine3; 2])| Shown {
            node,
            parent,
            world,
            ways: Arc::clone(&ways),
            at,
        };
        let mut shown: Vec<Shown> = out.into_iter().map(of).collect();
        shown.sort_by_key(|s| s.node);
        // What hangs in two nodes is hidden only where both are.
        shown.iter().for_each(|s| {
            hidden.remove(&s.node);
        });
        Walked { shown, odd, hidden }
    }

    fn uses(&self) -> &Uses {
        self.uses.get_or_init(|| {
            let mut out = Uses::default();
            for mesh in self.json.list("nodes").iter().filter_map(|n| n.index("mesh")) {
                *out.nodes_of_mesh.entry(mesh).or_default() += 1;
            }
            for mesh in self.json.list("meshes") {
                let of = |p: &Json| p.get("attributes").map(|a| VERTEX_DATA.map(|n| a.index(n)));
                let used = mesh.list("primitives").iter().filter_map(of).flatten().flatten();
                for accessor in used.collect::<HashSet<usize>>() {
                    *out.meshes_of_accessor.entry(accessor).or_default() += 1;
                }
            }
            out
        })
    }

    /// How many nodes show a mesh.
    pub fn nodes_of_mesh(&self, mesh: usize) -> usize {
        self.uses().nodes_of_mesh.get(&mesh).copied().unwrap_or(0)
    }

    /// How many meshes use an accessor for vertex data.
    pub fn meshes_of_accessor(&self, accessor: usize) -> usize {
        self.uses().meshes_of_accessor.get(&accessor).copied().unwrap_or(0)
    }

    /// A node as messages name it: `/nodes/3 IfcWall/south`.
    pub fn named(&self, node: usize) -> String {
        let name = self.json.list("nodes").get(node).and_then(|n| n.text("name")).unwrap_or_default();
        format!("/nodes/{node} {name}").trim_end().to_string()
    }
}

fn index(json: &Json) -> Option<usize> {
    json.as_index()
}

/// A node's own transform.
pub(super) fn local(node: &Json) -> DAffine3 {
    if let Some(m) = node.numbers("matrix").filter(|m| m.len() == 16) {
        let mut columns = [0.0; 16];
        columns.copy_from_slice(&m);
        return DAffine3::from_mat4(DMat4::from_cols_array(&columns));
    }
    let (scale, rotation, translation) = parts(node);
    DAffine3::from_scale_rotation_translation(scale, rotation, translation)
}

/// Scale, rotation and translation of a node without a matrix.
pub(super) fn parts(node: &Json) -> (DVec3, DQuat, DVec3) {
    let vector = |key: &str, default: DVec3| match node.numbers(key).as_deref() {
        Some([x, y, z]) => DVec3::new(*x, *y, *z),
        _ => default,
    };
    let rotation = match node.numbers("rotation").as_deref() {
        Some([x, y, z, w]) => DQuat::from_xyzw(*x, *y, *z, *w),
        _ => DQuat::IDENTITY,
    };
    let rotation = if rotation.length_squared() > 0.0 { rotation.normalize() } else { DQuat::IDENTITY };
    (vector("scale", DVec3::ONE), rotation, vector("translation", DVec3::ZERO))
}

/// The data of a buffer in a file of its own.
fn outer<'a>(uri: &str, beside: &'a BTreeMap<String, Arc<[u8]>>) -> Data<'a> {
    let name = super::outer::name_of(uri)?;
    let found = beside.get(&name).map(|data| Cow::Borrowed(&**data));
    found.ok_or_else(|| {
        format!("names {name:?}, expected a file of at most {OUTER_MAX} bytes beside the drawing; put it there, or export as .glb")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn walked_of(nodes: &str) -> Walked {
        let text = format!(r#"{{"asset":{{"version":"2.0"}},"scenes":[{{"nodes":[0]}}],"nodes":[{nodes}]}}"#);
        File::open("a.gltf", text.as_bytes(), &BTreeMap::new()).unwrap().walked()
    }

    fn shown_of(nodes: &str) -> (Vec<Shown>, Vec<String>) {
        let walked = walked_of(nodes);
        (walked.shown, walked.odd)
    }

    /// What a node hides is hidden to the last leaf, whatever that says; what also hangs elsewhere is shown there.
    #[test]
    fn what_is_hidden_is_gathered_with_all_below() {
        let says =
            |visible: &str| format!(r#""extensions":{{"KHR_node_visibility":{{"visible":{visible}}}}}"#);
        let (no, yes) = (says("false"), says("true"));
        for (nodes, shown, hidden) in [
            (format!(r#"{{"children":[1]}},{{"mesh":0,{no}}}"#), vec![0], vec![1]),
            (format!(r#"{{"children":[1],{no}}},{{"children":[2]}},{{"mesh":0,{yes}}}"#), vec![], vec![2]),
            (
                format!(r#"{{"children":[1,2]}},{{"children":[3],{no}}},{{"children":[3]}},{{"mesh":0}}"#),
                vec![0, 2, 3],
                vec![],
            ),
            (format!(r#"{{"children":[1]}},{{"mesh":0,{yes}}}"#), vec![0, 1], vec![]),
            (format!(r#"{{"children":[1]}},{{"mesh":0,{}}}"#, says("0")), vec![0, 1], vec![]),
            (format!(r#"{{"children":[1]}},{{"name":"EF-MOVE","mesh":0,{no}}}"#), vec![0], vec![]),
        ] {
            let walked = walked_of(&nodes);
            assert_eq!(walked.shown.iter().map(|s| s.node).collect::<Vec<_>>(), shown, "{nodes}");
            assert_eq!(walked.hidden.into_iter().collect::<Vec<_>>(), hidden, "{nodes}");
        }
    }

    /// Every node of a deep chain is kept once, whatever hangs on it, and knows its way.
    #[test]
    fn ways_take_as_much_as_there_are_nodes() {
        let chain: Vec<String> = (1..=DEPTH_MAX).map(|i| format!(r#"{{"children":[{i}]}}"#)).collect();
        let (shown, odd) = shown_of(&format!("{},{{}}", chain.join(",")));
        assert_eq!((shown.len(), odd), (DEPTH_MAX + 1, Vec::new()));
        assert!(shown.iter().all(|s| Arc::ptr_eq(&s.ways, &shown[0].ways)));
        assert_eq!(shown[0].ways.len(), DEPTH_MAX + 1);
        assert_eq!(shown[DEPTH_MAX].path(), (0..=DEPTH_MAX).collect::<Vec<usize>>());
        let (shown, odd) = shown_of(&format!("{},{{\"children\":[0]}}", chain[..3].join(",")));
        assert_eq!((shown.len(), odd.len()), (4, 1));
        assert!(odd[0].contains("in a ring: 0>1>2>3>0"), "{odd:?}");
    }

    /// What hangs in two nodes has two ways, and is ours where either is.
    #[test]
    fn a_node_has_a_way_for_each_that_it_hangs_on() {
        let (shown, _) =
            shown_of(r#"{"children":[1,2]},{"children":[3]},{"name":"EF-MOVE","children":[3]},{"name":"a"}"#);
        let of: Vec<(Vec<usize>, bool)> = shown.iter().map(|s| (s.path(), s.is_own())).collect();
        let ways = [vec![0], vec![0, 1], vec![0, 2], vec![0, 1, 3], vec![0, 2, 3]];
        assert_eq!(of.iter().map(|o| o.0.clone()).collect::<Vec<_>>(), ways);
        assert_eq!(of.iter().map(|o| o.1).collect::<Vec<_>>(), [false, false, true, false, true]);
    }
}

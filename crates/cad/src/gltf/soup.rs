//! A mesh taken apart into triangles with all that their corners carry, to be cut, and put together again.

use glam::DVec3;

use super::append::Append;
use super::component::{FLOAT, TRIANGLES};
use super::json::{Json, Value};
use super::meshes::corners;
use super::pieces::Pieces;
use super::scene::File;

/// Values of every vertex of a primitive.
#[derive(Clone, Debug)]
pub(super) struct Attribute {
    /// Its name.
    pub name: String,
    /// Values a vertex.
    pub width: usize,
    /// Component type as written.
    kind: usize,
    is_normalised: bool,
}

impl Attribute {
    /// Whether values between two are no value of their own: numbers of features and what a program calls so.
    pub fn is_name(&self) -> bool {
        self.name.starts_with('_')
    }

    /// Whether it is a direction, of length one.
    pub fn is_direction(&self) -> bool {
        ["NORMAL", "TANGENT"].contains(&self.name.as_str()) && self.kind == FLOAT
    }
}

/// A face by its corners, and the connected piece of the mesh that it is of.
#[derive(Clone, Copy, Debug)]
pub(super) struct Face {
    /// Vertices of its primitive.
    pub corners: [u32; 3],
    /// As [`Pieces`] numbers them.
    pub piece: usize,
}

/// One primitive of a mesh.
#[derive(Clone, Debug)]
pub(super) struct Part {
    /// What a vertex carries, its place first.
    pub attributes: Vec<Attribute>,
    /// Values a vertex.
    pub width: usize,
    /// All of them, vertex by vertex.
    pub data: Vec<f64>,
    /// Its faces.
    pub faces: Vec<Face>,
    /// Whether they are others than in the file.
    pub is_changed: bool,
    /// Whether it has faces in the file: points and lines are left alone.
    has_faces: bool,
}

impl Part {
    /// What a vertex carries.
    pub fn vertex(&self, v: u32) -> &[f64] {
        &self.data[v as usize * self.width..][..self.width]
    }

    /// Where a vertex is, in coordinates of the mesh.
    pub fn at(&self, v: u32) -> DVec3 {
        DVec3::from_slice(self.vertex(v))
    }

    /// Adds a vertex.
    pub fn push(&mut self, vertex: &[f64]) -> u32 {
        self.data.extend_from_slice(vertex);
        (self.data.len() / self.width - 1) as u32
    }

    /// What a corner carries at a share of the way between two.
    pub fn between(&self, a: &[f64], b: &[f64], share: f64) -> Vec<f64> {
        let mut out: Vec<f64> = a.iter().zip(b).map(|(a, b)| a + (b - a) * share).collect();
        let mut at = 0;
        for attribute in &self.attributes {
            let own = at..at + attribute.width;
            if attribute.is_name() {
                out[own].copy_from_slice(if share < 0.5 {
                    &a[at..at + attribute.width]
                } else {
                    &b[at..at + attribute.width]
                });
            } else if attribute.is_direction() {
                let unit = DVec3::from_slice(&out[own.clone()]).normalize_or(DVec3::from_slice(&a[own]));
                out[at..at + 3].copy_from_slice(&unit.to_array());
            }
            at += attribute.width;
        }
        out
    }

    /// Whether nothing is left of its faces.
    pub fn is_gone(&self) -> bool {
        self.has_faces && self.faces.is_empty()
    }
}

/// Values a component type.
fn size(kind: usize) -> usize {
    match kind {
        5120 | 5121 => 1,
        5122 | 5123 => 2,
        _ => 4,
    }
}

/// Why a mesh that a node shows is not cut; `None` where it may be.
pub(super) fn refusal(scene: &File<'_>, mesh: usize) -> Option<String> {
    let primitives = scene.json.list("meshes").get(mesh)?.list("primitives");
    let members = |json: Option<&Json>| match json.map(|j| &j.value) {
        Some(Value::Object(members)) => members.iter().map(|(k, _)| k.clone()).collect(),
        _ => Vec::new(),
    };
    for primitive in primitives {
        let own = members(primitive.get("extensions"));
        if let Some(name) = own.iter().find(|e| *e != "KHR_materials_variants") {
            return Some(format!("its mesh is written with {name}"));
        }
        if primitive.get("targets").is_some() {
            return Some("its mesh changes its shape".into());
        }
        let attributes = primitive.get("attributes");
        if members(attributes).iter().any(|n| n.starts_with("JOINTS") || n.starts_with("WEIGHTS")) {
            return Some("its mesh follows a skeleton".into());
        }
        let Some(Value::Object(named)) = attributes.map(|a| &a.value) else { continue };
        let accessors = named.iter().filter_map(|(_, v)| v.as_index()).chain(primitive.index("indices"));
        for accessor in accessors.filter_map(|a| scene.json.list("accessors").get(a)) {
            let view = accessor.index("bufferView").and_then(|v| scene.json.list("bufferViews").get(v));
            if accessor.get("sparse").is_some() {
                return Some("its vertices are written sparsely".into());
            }
            if view.is_none_or(|v| v.get("extensions").is_some()) {
                return Some("its vertices are packed".into());
            }
        }
    }
    None
}

/// Takes a mesh apart.
///
/// # Errors
/// What cannot be read of it.
pub(super) fn parts(scene: &File<'_>, mesh: usize) -> Result<Vec<Part>, String> {
    let triangles = scene.triangles(mesh).map_err(|(_, why)| why)?;
    let pieces = Pieces::new(&triangles);
    let found = scene.json.list("meshes").get(mesh).ok_or("it has no mesh")?;
    found.list("primitives").iter().map(|p| part(scene, p, &pieces)).collect()
}

fn part(scene: &File<'_>, primitive: &Json, pieces: &Pieces) -> Result<Part, String> {
    let Some(Value::Object(named)) = primitive.get("attributes").map(|a| &a.value) else {
        return Err("it has no vertices".into());
    };
    let place = named.iter().find(|(k, _)| k == "POSITION").ok_or("it has no POSITION")?;
    let place = place.1.as_index().ok_or("it has no POSITION")?;
    let points = scene.points(place).map_err(|(_, why)| why)?;
    let mut attributes =
        vec![Attribute { name: "POSITION".into(), width: 3, kind: FLOAT, is_normalised: false }];
    let mut columns: Vec<Vec<f64>> = vec![points.iter().flat_map(|p| p.to_array()).collect()];
    for (name, value) in named.iter().filter(|(k, _)| k != "POSITION") {
        let index = value.as_index().ok_or_else(|| format!("its {name} cannot be read"))?;
        let (attribute, values) = column(scene, name, index)?;
        if values.len() != points.len() * attribute.width {
            return Err(format!("its {name} has another count than its vertices"));
        }
        attributes.push(attribute);
        columns.push(values);
    }
    let width = attributes.iter().map(|a| a.width).sum();
    let mut data = Vec::with_capacity(points.len() * width);
    for v in 0..points.len() {
        for (attribute, values) in attributes.iter().zip(&columns) {
            data.extend_from_slice(&values[v * attribute.width..][..attribute.width]);
        }
    }
    let indices = match primitive.index("indices") {
        Some(accessor) => scene.indices(accessor).map_err(|(_, why)| why)?,
        None => (0..points.len()).collect(),
    };
    let mode = primitive.index("mode").unwrap_or(TRIANGLES);
    let mut faces = Vec::new();
    for (k, c) in corners(mode, &indices).into_iter().enumerate() {
        // Every other triangle of a strip is turned round.
        let c = if mode == TRIANGLES + 1 && k % 2 == 1 { [c[1], c[0], c[2]] } else { c };
        let first = points.get(c[0]).ok_or("an index names a vertex that does not exist")?;
        let piece = pieces.of(*first).unwrap_or_default();
        faces.push(Face { corners: c.map(|i| i as u32), piece });
    }
    let has_faces = !faces.is_empty();
    Ok(Part { attributes, width, data, faces, is_changed: false, has_faces })
}

fn column(scene: &File<'_>, name: &str, accessor: usize) -> Result<(Attribute, Vec<f64>), String> {
    let found = scene.json.list("accessors").get(accessor).ok_or_else(|| format!("it has no {name}"))?;
    let width = match found.text("type") {
        Some("SCALAR") => 1,
        Some("VEC2") => 2,
        Some("VEC3") => 3,
        Some("VEC4") => 4,
        _ => return Err(format!("its {name} cannot be read")),
    };
    let kind = found.index("componentType").unwrap_or(FLOAT);
    let is_normalised = found.get("normalized").is_some_and(|n| n.value == Value::Bool(true));
    let values = scene.numbers(accessor, width, false).map_err(|(_, why)| why)?;
    Ok((Attribute { name: name.into(), width, kind, is_normalised }, values))
}

/// Data to be put behind that of the scene, and the views of it.
pub(super) struct Blob {
    /// The data; each view starts at a multiple of four.
    pub data: Vec<u8>,
    /// From, bytes, stride (0: none), target.
    views: Vec<[usize; 4]>,
    /// Index of the first view.
    first: usize,
}

/// Targets of views.
const VERTICES: usize = 34962;
const INDICES: usize = 34963;

impl Blob {
    /// Starts without data.
    pub fn new(scene: &File<'_>) -> Self {
        Self { data: Vec::new(), views: Vec::new(), first: scene.json.list("bufferViews").len() }
    }

    fn view(&mut self, data: &[u8], stride: usize, target: usize) -> usize {
        self.views.push([self.data.len(), data.len(), stride, target]);
        self.data.extend_from_slice(data);
        self.data.resize(self.data.len().next_multiple_of(4), 0);
        self.first + self.views.len() - 1
    }

    /// Indices of triangles: the accessor of them.
    pub fn indices(&mut self, root: &Json, append: &mut Append, list: &[u32]) -> usize {
        let data: Vec<u8> = list.iter().flat_map(|i| i.to_le_bytes()).collect();
        let view = self.view(&data, 0, INDICES);
        let text = format!(
            "{{\"bufferView\":{view},\"componentType\":5125,\"count\":{},\"type\":\"SCALAR\"}}",
            list.len()
        );
        append.push(root, "accessors", text)
    }

    /// Values of vertices: the accessor of them. Places have their bounds beside them.
    pub fn values(&mut self, root: &Json, append: &mut Append, of: &Attribute, values: &[f64]) -> usize {
        let (own, count) = (size(of.kind) * of.width, values.len() / of.width);
        let stride = own.next_multiple_of(4);
        let mut data = Vec::with_capacity(count * stride);
        for vertex in values.chunks_exact(of.width) {
            vertex.iter().for_each(|v| encode(*v, of.kind, &mut data));
            data.resize(data.len().next_multiple_of(4), 0);
        }
        let view = self.view(&data, if stride == own { 0 } else { stride }, VERTICES);
        let kind = if of.width == 1 { "SCALAR".into() } else { format!("VEC{}", of.width) };
        let normalised = if of.is_normalised { ",\"normalized\":true" } else { "" };
        let bounds = if of.name == "POSITION" { bounds(values) } else { String::new() };
        let text = format!(
            "{{\"bufferView\":{view},\"componentType\":{}{normalised},\"count\":{count},\"type\":\"{kind}\"{bounds}}}",
            of.kind
        );
        append.push(root, "accessors", text)
    }

    /// States the views of the data, which begins at a byte of a buffer.
    pub fn state(&self, root: &Json, append: &mut Append, (buffer, start): (usize, usize)) {
        for [from, bytes, stride, target] in &self.views {
            let stride = if *stride == 0 { String::new() } else { format!(",\"byteStride\":{stride}") };
            let at = start + from;
            let text = format!(
                "{{\"buffer\":{buffer},\"byteOffset\":{at},\"byteLength\":{bytes}{stride},\"target\":{target}}}"
            );
            append.push(root, "bufferViews", text);
        }
    }

    /// Floats of a name of the standard.
    pub fn floats(
        &mut self,
        root: &Json,
        append: &mut Append,
        name: &str,
        width: usize,
        values: &[f64],
    ) -> usize {
        let of = Attribute { name: name.into(), width, kind: FLOAT, is_normalised: false };
        self.values(root, append, &of, values)
    }
}

fn bounds(values: &[f64]) -> String {
    let bound = |pick: fn(f32, f32) -> f32, start: f32| {
        let all = values.chunks_exact(3).fold([start; 3], |m, p| [0, 1, 2].map(|k| pick(m[k], p[k] as f32)));
        all.map(|v| format!("{v:?}")).join(",")
    };
    let (lo, hi) = (bound(f32::min, f32::INFINITY), bound(f32::max, f32::NEG_INFINITY));
    format!(",\"min\":[{lo}],\"max\":[{hi}]")
}

fn encode(v: f64, kind: usize, out: &mut Vec<u8>) {
    match kind {
        5120 => out.extend((v.round() as i8).to_le_bytes()),
        5121 => out.push(v.round() as u8),
        5122 => out.extend((v.round() as i16).to_le_bytes()),
        5123 => out.extend((v.round() as u16).to_le_bytes()),
        5125 => out.extend((v.round() as u32).to_le_bytes()),
        _ => out.extend((v as f32).to_le_bytes()),
    }
}

/// Writes what a changed part has become: the accessors of its attributes in their order, and that of its indices.
pub(super) fn write(root: &Json, append: &mut Append, blob: &mut Blob, part: &Part) -> (Vec<usize>, usize) {
    let mut used: Vec<u32> = part.faces.iter().flat_map(|f| f.corners).collect();
    used.sort_unstable();
    used.dedup();
    let place = |v: u32| used.binary_search(&v).unwrap_or_default() as u32;
    let indices: Vec<u32> = part.faces.iter().flat_map(|f| f.corners.map(place)).collect();
    let (mut at, mut accessors) = (0, Vec::new());
    for attribute in &part.attributes {
        let own = at..at + attribute.width;
        let values: Vec<f64> = used.iter().flat_map(|v| &part.vertex(*v)[own.clone()]).copied().collect();
        accessors.push(blob.values(root, append, attribute, &values));
        at += attribute.width;
    }
    (accessors, blob.indices(root, append, &indices))
}

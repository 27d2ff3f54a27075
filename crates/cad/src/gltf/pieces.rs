//! Walls that share one mesh: its connected pieces, each moved by the vertices that are its own.

use std::collections::{BTreeSet, HashMap};

use glam::{DAffine3, DVec3};

use super::json::Value;
use super::limits::PIECES_MAX;
use super::motion::{fault, numbers, world_motion};
use super::record::of_record;
use super::scene::{File, Shown, VERTEX_DATA};
use crate::drawing::RigidMotion;
use crate::splice::Splice;
use enfilade_report::Error;

/// The pieces of a mesh: triangles that share a corner are of one.
pub(super) struct Pieces {
    /// Corner, to the last digit → piece; pieces are numbered as the mesh comes to them.
    of: HashMap<[u64; 3], usize>,
    /// How many there are.
    pub count: usize,
}

fn bits(p: DVec3) -> [u64; 3] {
    (p + DVec3::ZERO).to_array().map(f64::to_bits)
}

impl Pieces {
    /// Finds them.
    pub fn new(triangles: &[[DVec3; 3]]) -> Self {
        let mut corners: HashMap<[u64; 3], usize> = HashMap::new();
        let mut roots: Vec<usize> = Vec::new();
        for triangle in triangles {
            let ids = triangle.map(|p| {
                *corners.entry(bits(p)).or_insert_with(|| {
                    roots.push(roots.len());
                    roots.len() - 1
                })
            });
            let [a, b, c] = ids.map(|i| root(&mut roots, i));
            let least = a.min(b).min(c);
            [a, b, c].into_iter().for_each(|i| roots[i] = least);
        }
        let mut numbers: HashMap<usize, usize> = HashMap::new();
        for i in 0..roots.len() {
            let (r, next) = (root(&mut roots, i), numbers.len());
            numbers.entry(r).or_insert(next);
        }
        let count = numbers.len();
        let of = corners.into_iter().map(|(p, i)| (p, numbers[&root(&mut roots, i)])).collect();
        Self { of, count }
    }

    /// The piece that a corner belongs to.
    pub fn of(&self, p: DVec3) -> Option<usize> {
        self.of.get(&bits(p)).copied()
    }
}

fn root(roots: &mut [usize], mut i: usize) -> usize {
    while roots[i] != i {
        roots[i] = roots[roots[i]];
        i = roots[i];
    }
    i
}

/// Vertex data of floats in the binary chunk: where each vertex's starts.
struct Floats {
    accessor: usize,
    starts: Vec<usize>,
    width: usize,
}

impl File<'_> {
    /// The binary chunk, where the first buffer lies in it.
    pub fn bin(&self) -> Option<&[u8]> {
        let chunk = self.chunks.get(1).filter(|c| c.kind == *b"BIN\0")?;
        let first = self.json.list("buffers").first()?;
        first.get("uri").is_none().then(|| &self.bytes[chunk.span.clone()])
    }

    /// Plain floats of the first buffer; none of anything else.
    fn floats(&self, accessor: usize, width: usize) -> Option<Floats> {
        let found = self.json.list("accessors").get(accessor)?;
        let kind = if width == 3 { "VEC3" } else { "VEC4" };
        let is_plain = found.index("componentType") == Some(5126)
            && found.text("type") == Some(kind)
            && found.get("sparse").is_none();
        let view = self.json.list("bufferViews").get(found.index("bufferView").filter(|_| is_plain)?)?;
        if view.index("buffer") != Some(0) || view.get("extensions").is_some() {
            return None;
        }
        let stride = view.index("byteStride").filter(|s| *s > 0).unwrap_or(4 * width);
        let start =
            view.index("byteOffset").unwrap_or(0).checked_add(found.index("byteOffset").unwrap_or(0))?;
        let count = found.index("count")?;
        let end = start.checked_add(count.checked_sub(1)?.checked_mul(stride)?)?.checked_add(4 * width)?;
        let starts = (0..count).map(|i| start + i * stride).collect();
        (end <= self.bin()?.len()).then_some(Floats { accessor, starts, width })
    }

    /// Positions, normals and tangents of every primitive of a mesh that no other mesh uses; none where one of them
    /// cannot be written by itself.
    fn vertices(&self, mesh: usize) -> Option<Vec<[Option<Floats>; 3]>> {
        let own = self.json.list("meshes").get(mesh)?;
        let mut out = Vec::new();
        for primitive in own.list("primitives") {
            let attributes = primitive.get("attributes")?;
            if primitive.get("targets").is_some() || primitive.get("extensions").is_some() {
                return None;
            }
            let of = |name: &str, width: usize| match attributes.index(name) {
                Some(accessor) => self.floats(accessor, width).map(Some),
                None => Some(None),
            };
            out.push([Some(of("POSITION", 3)??), of("NORMAL", 3)?, of("TANGENT", 4)?]);
        }
        let all = own.list("primitives").iter().filter_map(|p| p.get("attributes"));
        let mut used = all.flat_map(|a| VERTEX_DATA.map(|n| a.index(n))).flatten();
        used.all(|a| self.meshes_of_accessor(a) == 1).then_some(out)
    }

    /// The pieces of a node's mesh where each can be moved by itself: plain vertices of its own in a GLB.
    pub fn pieces(&self, node: usize, triangles: &[[DVec3; 3]]) -> Option<Pieces> {
        let nodes = self.json.list("nodes");
        let mesh = nodes.get(node)?.index("mesh")?;
        if self.nodes_of_mesh(mesh) != 1 || nodes[node].get("skin").is_some() {
            return None;
        }
        self.vertices(mesh)?;
        let pieces = Pieces::new(triangles);
        (2..=PIECES_MAX).contains(&pieces.count).then_some(pieces)
    }
}

/// Moves of pieces, gathered: the binary chunk as it becomes.
pub(super) struct Mover<'s, 'a> {
    scene: &'s File<'a>,
    /// The binary chunk; empty as long as nothing has moved.
    pub bin: Vec<u8>,
    meshes: HashMap<usize, Pieces>,
    /// Accessors of positions that have changed.
    touched: BTreeSet<usize>,
}

impl<'s, 'a> Mover<'s, 'a> {
    /// Starts without a change.
    pub fn new(scene: &'s File<'a>) -> Self {
        Self { scene, bin: Vec::new(), meshes: HashMap::new(), touched: BTreeSet::new() }
    }

    /// Moves one piece of a node's mesh.
    pub fn edit(&mut self, shown: &[Shown], record: usize, motion: &RigidMotion) -> Result<(), Error> {
        let why = |text: &str| fault(self.scene.name, record, text);
        let (node, piece) = of_record(record);
        let place = shown.iter().find(|s| s.node == node).ok_or_else(|| why("no such node"))?;
        let mesh = self.scene.json.list("nodes").get(node).and_then(|n| n.index("mesh"));
        let mesh = mesh.ok_or_else(|| why("it has no mesh"))?;
        let vertices = self.scene.vertices(mesh).ok_or_else(|| why("its vertices cannot be written"))?;
        let bin = self.scene.bin().ok_or_else(|| why("its data lies in no binary chunk"))?;
        if !motion.turn_rad.is_finite() || !motion.shift.is_finite() {
            return Err(why("the motion is not finite"));
        }
        let back = place.world.inverse();
        if !back.is_finite() {
            return Err(why("it has no size"));
        }
        let world = world_motion(motion);
        let local = if motion.turn_rad == 0.0 {
            DAffine3::from_translation(back.matrix3 * world.translation)
        } else {
            back * world * place.world
        };
        if !self.meshes.contains_key(&mesh) {
            let triangles = self.scene.triangles(mesh).map_err(|(_, text)| why(&text))?;
            self.meshes.insert(mesh, Pieces::new(&triangles));
        }
        if self.bin.is_empty() {
            self.bin = bin.to_vec();
        }
        let Some(pieces) = self.meshes.get(&mesh) else { return Err(why("no such mesh")) };
        for [positions, normals, tangents] in &vertices {
            let Some(positions) = positions else { continue };
            let is_own: Vec<bool> =
                positions.starts.iter().map(|at| pieces.of(read(bin, *at)) == piece).collect();
            self.touched.insert(positions.accessor);
            let turned = local.matrix3;
            let upright = turned.inverse().transpose();
            rewrite(&mut self.bin, bin, positions, &is_own, |p| local.transform_point3(p));
            if motion.turn_rad != 0.0 {
                for (list, to) in [(normals, upright), (tangents, turned)] {
                    let Some(list) = list else { continue };
                    rewrite(&mut self.bin, bin, list, &is_own, |v| (to * v).normalize_or_zero());
                }
            }
        }
        Ok(())
    }

    /// Splices of the JSON text that state the bounds of what has moved.
    pub fn bounds(&self) -> Vec<Splice> {
        let mut out = Vec::new();
        for accessor in &self.touched {
            let (Some(floats), Some(stated)) =
                (self.scene.floats(*accessor, 3), self.scene.json.list("accessors").get(*accessor))
            else {
                continue;
            };
            let points = || floats.starts.iter().map(|at| read(&self.bin, *at));
            let lo = points().fold(DVec3::INFINITY, DVec3::min);
            let hi = points().fold(DVec3::NEG_INFINITY, DVec3::max);
            for (key, bound) in [("min", lo), ("max", hi)] {
                if let Some(list) = stated.get(key).filter(|l| matches!(l.value, Value::Array(_))) {
                    out.extend(numbers(list, &bound.to_array()));
                }
            }
        }
        out
    }
}

fn read(bin: &[u8], at: usize) -> DVec3 {
    let float = |i: usize| {
        let four = bin.get(at + 4 * i..at + 4 * i + 4).and_then(|b| b.try_into().ok());
        f64::from(four.map_or(f32::NAN, f32::from_le_bytes))
    };
    DVec3::new(float(0), float(1), float(2))
}

/// Writes the first three components of the vertices that are its own.
fn rewrite(to: &mut [u8], from: &[u8], list: &Floats, is_own: &[bool], map: impl Fn(DVec3) -> DVec3) {
    for (at, _) in list.starts.iter().zip(is_own).filter(|(_, own)| **own) {
        for (i, v) in map(read(from, *at)).to_array().into_iter().enumerate().take(list.width.min(3)) {
            to[at + 4 * i..at + 4 * i + 4].copy_from_slice(&(v as f32).to_le_bytes());
        }
    }
}

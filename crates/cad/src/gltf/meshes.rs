//! Triangles out of accessors: plain, quantised, interleaved and sparse ones.

use glam::DVec3;

use super::component::{FAN, FLOAT, TRIANGLES, WHOLE};
use super::json::{Json, Value};
use super::limits::TRIANGLES_MAX;
use super::scene::File;

/// What keeps a mesh from being read: JSON pointer and reason.
pub(super) type Why = (String, String);

impl File<'_> {
    /// Triangles of a mesh in its own coordinates.
    pub fn triangles(&self, mesh: usize) -> Result<Vec<[DVec3; 3]>, Why> {
        let pointer = format!("/meshes/{mesh}");
        let found = self
            .json
            .list("meshes")
            .get(mesh)
            .ok_or_else(|| (pointer.clone(), "does not exist".to_string()))?;
        let mut out = Vec::new();
        if found.list("primitives").is_empty() {
            return Err((pointer, "has no primitives".into()));
        }
        for (i, primitive) in found.list("primitives").iter().enumerate() {
            let pointer = format!("{pointer}/primitives/{i}");
            let packed =
                primitive.get("extensions").is_some_and(|e| e.get("KHR_draco_mesh_compression").is_some());
            let position = primitive.get("attributes").and_then(|a| a.index("POSITION"));
            let Some(position) = position.filter(|p| !packed || self.has_data(*p)) else {
                let why = if packed {
                    "is packed by KHR_draco_mesh_compression; export again without compression"
                } else {
                    "has no POSITION"
                };
                return Err((pointer, why.into()));
            };
            let points = self.points(position)?;
            let indices = match stated(primitive, "indices").map_err(|why| (pointer.clone(), why))? {
                Some(accessor) => self.indices(accessor)?,
                None => (0..points.len()).collect(),
            };
            let mode = stated(primitive, "mode").map_err(|why| (pointer.clone(), why))?.unwrap_or(TRIANGLES);
            if mode > FAN {
                return Err((pointer, format!("has mode {mode}, expected 0 to {FAN}")));
            }
            if out.len() + indices.len() / 3 > TRIANGLES_MAX {
                return Err((pointer, format!("has more than {TRIANGLES_MAX} triangles")));
            }
            for corner in corners(mode, &indices) {
                let triangle = corner.map(|c| points.get(c).copied());
                let [Some(a), Some(b), Some(c)] = triangle else {
                    return Err((pointer, "an index names a vertex that does not exist".into()));
                };
                out.push([a, b, c]);
            }
        }
        Ok(out)
    }

    fn has_data(&self, accessor: usize) -> bool {
        self.json.list("accessors").get(accessor).is_some_and(|a| a.index("bufferView").is_some())
    }

    /// Whether the file says that its positions may be whole numbers.
    fn is_quantised(&self) -> bool {
        let lists = ["extensionsRequired", "extensionsUsed"].into_iter();
        let mut names = lists.flat_map(|key| self.json.list(key));
        names.any(|name| matches!(&name.value, Value::Text(t) if t == "KHR_mesh_quantization"))
    }

    /// Corners of an accessor of positions.
    pub fn points(&self, accessor: usize) -> Result<Vec<DVec3>, Why> {
        let kind = self.json.list("accessors").get(accessor).and_then(|a| a.index("componentType"));
        let is_allowed = |k: usize| k == FLOAT || WHOLE.contains(&k) && self.is_quantised();
        if let Some(kind) = kind.filter(|k| !is_allowed(*k)) {
            let whole =
                if WHOLE.contains(&kind) { ", or KHR_mesh_quantization in extensionsUsed" } else { "" };
            let why = format!("has positions of component type {kind}, expected {FLOAT}{whole}");
            return Err((format!("/accessors/{accessor}"), why));
        }
        let flat = self.numbers(accessor, 3, true)?;
        if flat.iter().any(|v| !v.is_finite()) {
            return Err((format!("/accessors/{accessor}"), "has coordinates that are no numbers".into()));
        }
        Ok(flat.chunks_exact(3).map(|c| DVec3::new(c[0], c[1], c[2])).collect())
    }

    pub(super) fn indices(&self, accessor: usize) -> Result<Vec<usize>, Why> {
        let kind = self.json.list("accessors").get(accessor).and_then(|a| a.index("componentType"));
        if let Some(kind) = kind.filter(|k| ![5121, 5123, 5125].contains(k)) {
            let why = format!("has indices of component type {kind}, expected 5121, 5123 or 5125");
            return Err((format!("/accessors/{accessor}"), why));
        }
        Ok(self.numbers(accessor, 1, false)?.into_iter().map(|v| v as usize).collect())
    }

    /// All components of an accessor, sparse values put in; normalised where it says so and they may be.
    pub(super) fn numbers(
        &self,
        accessor: usize,
        width: usize,
        may_be_normalised: bool,
    ) -> Result<Vec<f64>, Why> {
        let pointer = format!("/accessors/{accessor}");
        let why = |text: &str| (pointer.clone(), text.to_string());
        let found = self.json.list("accessors").get(accessor).ok_or_else(|| why("does not exist"))?;
        let of_type = match found.text("type") {
            Some("SCALAR") => 1,
            Some("VEC2") => 2,
            Some("VEC3") => 3,
            Some("VEC4") => 4,
            _ => 0,
        };
        if of_type != width {
            return Err(why("is of another type than its use needs"));
        }
        let count = found.index("count").ok_or_else(|| why("has no count"))?;
        let kind = found.index("componentType").unwrap_or(0);
        let normalised = match found.get("normalized").map(|n| &n.value) {
            None => false,
            Some(Value::Bool(b)) => *b && may_be_normalised,
            Some(_) => return Err(why("has a `normalized` that is neither true nor false")),
        };
        let mut out = match stated(found, "bufferView").map_err(|text| why(&text))? {
            Some(view) => {
                let offset = stated(found, "byteOffset").map_err(|text| why(&text))?.unwrap_or(0);
                self.view(view, offset, count, width, kind, normalised)?
            }
            None if count > TRIANGLES_MAX => return Err(why("counts more than any scene has")),
            None => vec![0.0; count * width],
        };
        if let Some(sparse) = found.get("sparse") {
            self.sparse(sparse, &mut out, width, kind, normalised)
                .map_err(|(_, text)| why(&format!("sparse: {text}")))?;
        }
        Ok(out)
    }

    fn sparse(
        &self,
        sparse: &Json,
        out: &mut [f64],
        width: usize,
        kind: usize,
        normalised: bool,
    ) -> Result<(), Why> {
        let why = |text: &str| (String::new(), text.to_string());
        let count = sparse.index("count").ok_or_else(|| why("has no count"))?;
        let part = |key: &str, width: usize, kind: usize, normalised: bool| {
            let of = sparse.get(key).ok_or_else(|| why("is incomplete"))?;
            let view = of.index("bufferView").ok_or_else(|| why("is incomplete"))?;
            let kind = of.index("componentType").unwrap_or(kind);
            let offset = stated(of, "byteOffset").map_err(|text| why(&text))?.unwrap_or(0);
            self.view(view, offset, count, width, kind, normalised)
        };
        let indices = part("indices", 1, 0, false)?;
        let values = part("values", width, kind, normalised)?;
        for (i, value) in indices.iter().zip(values.chunks_exact(width)) {
            let at = *i as usize * width;
            let slot =
                out.get_mut(at..at + width).ok_or_else(|| why("names an element that does not exist"))?;
            slot.copy_from_slice(value);
        }
        Ok(())
    }

    fn view(
        &self,
        view: usize,
        offset: usize,
        count: usize,
        width: usize,
        kind: usize,
        normalised: bool,
    ) -> Result<Vec<f64>, Why> {
        let pointer = format!("/bufferViews/{view}");
        let why = |text: &str| (pointer.clone(), text.to_string());
        let found = self.json.list("bufferViews").get(view).ok_or_else(|| why("does not exist"))?;
        let buffer = found.index("buffer").ok_or_else(|| why("names no buffer"))?;
        let data = match self.buffers.get(buffer) {
            Some(Ok(data)) => data,
            Some(Err(text)) => return Err((format!("/buffers/{buffer}"), text.clone())),
            None => return Err(why("names a buffer that does not exist")),
        };
        let size = match kind {
            5120 | 5121 => 1,
            5122 | 5123 => 2,
            5125 | 5126 => 4,
            _ => return Err(why("is read with an unknown component type")),
        };
        let start = stated(found, "byteOffset").map_err(|text| why(&text))?.unwrap_or(0);
        let length = stated(found, "byteLength").map_err(|text| why(&text))?;
        let length = length.ok_or_else(|| why("has no byteLength"))?;
        let end = start.checked_add(length).filter(|e| *e <= data.len());
        let end = end.ok_or_else(|| why("reaches beyond its buffer"))?;
        let stride = stated(found, "byteStride").map_err(|text| why(&text))?;
        let stride = stride.filter(|s| *s > 0).unwrap_or(size * width);
        if stride < size * width {
            return Err(why(&format!("has byteStride {stride}, expected at least {}", size * width)));
        }
        let last = count
            .checked_sub(1)
            .map_or(Some(0), |n| n.checked_mul(stride)?.checked_add(size * width)?.checked_add(offset));
        if last.is_none_or(|l| start.checked_add(l).is_none_or(|l| l > end)) {
            return Err(why("is shorter than what is read from it"));
        }
        let mut out = Vec::with_capacity(count * width);
        for i in 0..count {
            for k in 0..width {
                let at = start + offset + i * stride + k * size;
                out.push(component(&data[at..at + size], kind, normalised));
            }
        }
        Ok(out)
    }
}

fn component(bytes: &[u8], kind: usize, normalised: bool) -> f64 {
    let (value, most) = match (kind, bytes) {
        (5120, [a]) => (f64::from(*a as i8), 127.0),
        (5121, [a]) => (f64::from(*a), 255.0),
        (5122, [a, b]) => (f64::from(i16::from_le_bytes([*a, *b])), 32767.0),
        (5123, [a, b]) => (f64::from(u16::from_le_bytes([*a, *b])), 65535.0),
        (5125, [a, b, c, d]) => return f64::from(u32::from_le_bytes([*a, *b, *c, *d])),
        (_, [a, b, c, d]) => return f64::from(f32::from_le_bytes([*a, *b, *c, *d])),
        _ => return f64::NAN,
    };
    if normalised { (value / most).max(-1.0) } else { value }
}

/// A member that is an index or a count, if it is stated; what it is where it is something else.
fn stated(json: &Json, key: &str) -> Result<Option<usize>, String> {
    let Some(value) = json.get(key) else { return Ok(None) };
    let number = value.as_index();
    number.map(Some).ok_or_else(|| format!("has {key} {}, expected a whole number", value.words()))
}

/// Corners of every triangle; points and lines have none.
pub(super) fn corners(mode: usize, indices: &[usize]) -> Vec<[usize; 3]> {
    match mode {
        4 => indices.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect(),
        5 => indices.windows(3).map(|c| [c[0], c[1], c[2]]).collect(),
        6 => indices.windows(2).skip(1).map(|c| [indices[0], c[0], c[1]]).collect(),
        _ => Vec::new(),
    }
}

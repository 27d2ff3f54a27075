//! What is put at the end of a scene's lists and of its data, whoever makes it.

use std::collections::BTreeMap;

use base64::Engine;

use super::dangling::{reaches_beyond, taken};
use super::glb::fault;
use super::json::{Json, Value};
use super::scene::File;
use crate::splice::Splice;
use enfilade_report::Error;

/// Items to append to arrays of the root.
#[derive(Default)]
pub(super) struct Append(BTreeMap<&'static str, Vec<String>>);

impl Append {
    /// Index that the next item of an array gets.
    pub fn next(&self, root: &Json, key: &'static str) -> usize {
        root.list(key).len() + self.0.get(key).map_or(0, Vec::len)
    }

    pub fn push(&mut self, root: &Json, key: &'static str, item: String) -> usize {
        let index = self.next(root, key);
        self.0.entry(key).or_default().push(item);
        index
    }

    /// Splices of the JSON text (counted from its start) that put them in.
    ///
    /// # Errors
    /// `gltf-dangling` where the scene names what it does not have, and ours would take that place.
    pub fn splices(&self, scene: &File<'_>) -> Result<Vec<Splice>, Error> {
        let root = &scene.json;
        for (list, items) in &self.0 {
            if let Some(index) = taken(root, list, items.len()) {
                let text = "the scene names it and does not have it, and what is added would take its place";
                return Err(fault(scene.name, "gltf-dangling", &format!("/{list}/{index}"), text));
            }
        }
        Ok(self.0.iter().map(|(key, items)| into_array(root, key, items)).collect())
    }
}

/// Where the data of our meshes goes: to the end of the binary chunk, else into a buffer of its own as text.
pub(super) struct Home {
    /// Bytes that the binary chunk has.
    bin: Option<usize>,
    /// Bytes to append to it.
    pub data: Vec<u8>,
}

impl Home {
    /// The end of the binary chunk, where there is one that nothing reaches beyond.
    pub fn new(scene: &File<'_>) -> Self {
        let bin = scene.bin().map(<[u8]>::len).filter(|n| n % 4 == 0 && !reaches_beyond(&scene.json, *n));
        Self { bin, data: Vec::new() }
    }

    /// Takes a mesh's data; the buffer it lies in, and from where on.
    pub fn take(&mut self, root: &Json, append: &mut Append, layer: &str, data: &[u8]) -> (usize, usize) {
        if let Some(bin) = self.bin {
            self.data.extend_from_slice(data);
            return (0, bin + self.data.len() - data.len());
        }
        let text = base64::engine::general_purpose::STANDARD.encode(data);
        let buffer = format!(
            "{{\"name\":{},\"byteLength\":{},\"uri\":\"data:application/octet-stream;base64,{text}\"}}",
            quoted(layer),
            data.len()
        );
        (append.push(root, "buffers", buffer), 0)
    }

    /// The new length of the first buffer.
    pub fn stated(&self, root: &Json) -> Option<Splice> {
        let length = self.bin.filter(|_| !self.data.is_empty())? + self.data.len();
        let old = root.list("buffers").first()?.get("byteLength")?;
        Some(Splice::new(old.span.clone(), length.to_string()))
    }
}

/// A text as JSON writes it.
pub(super) fn quoted(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

/// Puts items at the end of an array of the root; makes the array where it is missing.
pub(super) fn into_array(root: &Json, key: &str, items: &[String]) -> Splice {
    match root.get(key) {
        Some(array) => {
            let at = array.items().last().map_or(array.span.start + 1, |last| last.span.end);
            let comma = if array.items().is_empty() { "" } else { "," };
            Splice::new(at..at, format!("{comma}{}", items.join(",")))
        }
        None => {
            let at = root.span.start + 1;
            Splice::new(at..at, format!("\"{key}\":[{}],", items.join(",")))
        }
    }
}

/// Shows the nodes in the scene.
pub(super) fn into_scene(root: &Json, nodes: &[String]) -> Option<Splice> {
    let scene = root.list("scenes").get(root.index("scene").unwrap_or(0))?;
    // A damaged scene may be something else, or have nodes that are not a list: nothing can be shown there.
    if !matches!(scene.value, Value::Object(_)) {
        return None;
    }
    Some(match scene.get("nodes") {
        Some(list) if !matches!(list.value, Value::Array(_)) => return None,
        Some(list) => {
            let at = list.items().last().map_or(list.span.start + 1, |last| last.span.end);
            let comma = if list.items().is_empty() { "" } else { "," };
            Splice::new(at..at, format!("{comma}{}", nodes.join(",")))
        }
        None => {
            let at = scene.span.start + 1;
            let comma = if matches!(&scene.value, Value::Object(m) if m.is_empty()) { "" } else { "," };
            Splice::new(at..at, format!("\"nodes\":[{}]{comma}", nodes.join(",")))
        }
    })
}

/// Splices at one place made one, in their order.
pub(super) fn joined(list: Vec<Splice>) -> Vec<Splice> {
    let mut out: Vec<Splice> = Vec::new();
    for splice in list {
        match out.iter_mut().find(|s| s.start == splice.start && s.end == splice.end) {
            Some(same) => same.with.extend(splice.with),
            None => out.push(splice),
        }
    }
    out
}

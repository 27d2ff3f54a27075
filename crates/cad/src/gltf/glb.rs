//! The container of a binary scene: its header and its chunks.

use enfilade_report::{Error, Place};

/// A chunk of a GLB file: its kind and where its data stands.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Chunk {
    /// `JSON`, `BIN\0` or another.
    pub kind: [u8; 4],
    /// Its data.
    pub span: std::ops::Range<usize>,
}

/// The container of glTF 2.0; that of 1.0 is laid out otherwise.
const GLB_VERSION: usize = 2;

/// What helps where a file is of another version.
pub(super) const AGAIN: &str = "export it again as glTF 2.0";

/// A problem at a JSON pointer.
pub(super) fn fault(file: &str, code: &'static str, pointer: &str, text: &str) -> Error {
    Error::input(code, Place::file(file).entity(pointer), format!("{text}; nothing was done"))
}

/// Whether bytes are a GLB.
pub fn is_glb(bytes: &[u8]) -> bool {
    bytes.starts_with(b"glTF")
}

/// The JSON of a scene, if its first chunk is there.
pub(super) fn json_of(bytes: &[u8]) -> Option<&[u8]> {
    if !is_glb(bytes) {
        return Some(bytes);
    }
    let first = chunks("", bytes).ok()?.into_iter().next().filter(|c| c.kind == *b"JSON")?;
    bytes.get(first.span)
}

fn u32_at(bytes: &[u8], at: usize) -> Option<usize> {
    let four: [u8; 4] = bytes.get(at..at + 4)?.try_into().ok()?;
    Some(u32::from_le_bytes(four) as usize)
}

/// Length that a GLB states, if its header is there.
pub(super) fn stated_length(bytes: &[u8]) -> Option<usize> {
    u32_at(bytes, 8)
}

/// The chunks of a GLB; none of a `.gltf`.
pub(super) fn chunks(name: &str, bytes: &[u8]) -> Result<Vec<Chunk>, Error> {
    if !is_glb(bytes) {
        return Ok(Vec::new());
    }
    if let Some(version) = u32_at(bytes, 4).filter(|v| *v != GLB_VERSION) {
        let text = format!("byte 4: found version {version} of GLB, expected glTF 2.0; {AGAIN}");
        return Err(fault(name, "gltf-version", "", &text));
    }
    let stated = stated_length(bytes).unwrap_or(0);
    if stated != bytes.len() {
        let text = format!(
            "the header states {stated} bytes, found {}; the file is damaged or not finished",
            bytes.len()
        );
        return Err(fault(name, "gltf-incomplete", "", &text));
    }
    let (mut at, mut out) = (12, Vec::new());
    while at < bytes.len() {
        let cut = || fault(name, "gltf-glb", "", &format!("byte {at}: a chunk is cut off"));
        let len = u32_at(bytes, at).ok_or_else(cut)?;
        let kind: [u8; 4] = bytes.get(at + 4..at + 8).and_then(|k| k.try_into().ok()).ok_or_else(cut)?;
        let end = (at + 8).checked_add(len).filter(|e| *e <= bytes.len()).ok_or_else(cut)?;
        out.push(Chunk { kind, span: at + 8..end });
        at = end;
    }
    if out.is_empty() {
        return Err(fault(name, "gltf-glb", "", "no chunk, expected JSON"));
    }
    Ok(out)
}

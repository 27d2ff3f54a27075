//! glTF 2.0 and GLB: meshes cut at the height of the eyes to a drawing, and moves of nodes to bytes.
//!
//! The file stays bytes. [`read`] cuts every mesh whose node, mesh or material is named after walls above the
//! floor that most walls stand on; [`patch`] changes numbers of node transforms, or the vertices of one piece where
//! several walls share a mesh, and appends nodes of ours. JSON members, extras, unknown extensions and chunks stay as
//! they are, numbers as written.
//!
//! [`SourceRef::record`] is the node's index (of a piece see [`path_of`]), [`SourceRef::handle`] its JSON pointer; plan x is glTF's x, plan
//! y its −z, heights its y, all in metres as the standard says, unless the user
//! names another unit or no wall could be as high as the file's are.
//!
//! [`SourceRef::record`]: crate::drawing::SourceRef::record
//! [`SourceRef::handle`]: crate::drawing::SourceRef::handle

mod additions;
mod append;
mod bearing;
mod bodies;
mod body;
mod boxes;
mod caps;
mod clip;
mod component;
mod cutter;
mod dangling;
mod floors;
mod glb;
mod heights;
mod instances;
mod json;
mod levels;
mod limits;
mod lists;
mod marks;
mod meshes;
mod motion;
mod outer;
mod patch;
mod pieces;
mod primitives;
mod read;
mod record;
mod rewrite;
mod scale;
mod scene;
mod soup;
mod twin;
mod upright;
mod values;
mod works;

pub use bodies::is_global_id;
pub use glb::is_glb;
pub use limits::*;
pub use outer::{Outer, outer_files};
pub use read::{read, storeys};
pub use twin::uses_twin;

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use crate::drawing::{Addition, Edit, Unit};
use crate::ifc::Inventory;
use crate::splice::{self, Splice};
use enfilade_report::{Error, Report};
use scene::File;

/// Height of standing eyes above the floor.
pub const CUT_EYE_M: f64 = 1.5;

/// Height of the cut at which windows block.
pub const CUT_KNEE_M: f64 = 0.5;

/// How to read a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReadOptions {
    /// Cut at knee height.
    pub is_knee: bool,
    /// Whether the user names the walls: then layers keep their names.
    pub is_by_user: bool,
    /// Name of the storey, of those that `twin` knows, else of those of the scene itself; `None`: the one with most walls.
    pub storey: Option<String>,
    /// The user's word for the unit, which then stands above the standard's metre.
    pub unit: Option<Unit>,
    /// What the IFC beside the scene knows of its nodes by their names.
    pub twin: Option<Arc<Inventory>>,
    /// Files of data beside the scene, by name ([`outer_files`]).
    pub buffers: BTreeMap<String, Arc<[u8]>>,
    /// Pictures beside the scene, by name.
    pub pictures: BTreeSet<String>,
}

/// What is missing of a file that is not finished.
pub fn incomplete(bytes: &[u8]) -> Option<String> {
    if is_glb(bytes) {
        let stated = glb::stated_length(bytes).unwrap_or(0);
        let found = bytes.len();
        return (stated != found).then(|| format!("the header states {stated} bytes, found {found}"));
    }
    json::parse(bytes).err().map(|(at, text)| format!("byte {at}: found {text}"))
}

/// The scene with the moves made and the additions put in; no edits and no additions give the same bytes.
///
/// # Errors
/// [`Error::Input`] where an edit names no node that can move, and where the bytes are no glTF.
pub fn patch(
    file: &str,
    bytes: &[u8],
    options: &ReadOptions,
    edits: &[Edit],
    own: &[Addition],
) -> Result<Vec<u8>, Error> {
    if edits.is_empty() && own.is_empty() {
        return Ok(bytes.to_vec());
    }
    if edits.iter().any(Edit::is_work) {
        let (works, moves): (Vec<Edit>, Vec<Edit>) = edits.iter().cloned().partition(Edit::is_work);
        let moved = patch(file, bytes, options, &moves, &[])?;
        let worked = with_works(file, &moved, options, &works)?;
        return with_additions(file, &worked, options, &File::open(file, bytes, &options.buffers)?, own);
    }
    let scene = File::open(file, bytes, &options.buffers)?;
    let shown = scene.shown();
    let mut splices: Vec<Splice> = Vec::new();
    let mut pieces = pieces::Mover::new(&scene);
    for edit in edits {
        match edit {
            Edit::Insert { record, motion } if record::of_record(*record).1.is_some() => {
                pieces.edit(&shown, *record, motion)?;
            }
            _ => splices.extend(patch::edit(&scene, &shown, edit)?),
        }
    }
    splices.extend(pieces.bounds());
    let mut bin = Some(pieces.bin).filter(|b| !b.is_empty());
    if !own.is_empty() {
        let (floor, metres) = read::floor_of(&scene, &shown, options, &mut Report::default())?;
        let (json, data) = additions::splices(&scene, floor, metres, own)?;
        splices.extend(json);
        if !data.is_empty() {
            bin.get_or_insert_with(|| scene.bin().unwrap_or_default().to_vec()).extend(data);
        }
    }
    written(&scene, splices, bin)
}

/// The scene with additions put in, above the floor that was read before works changed which storey has most walls.
fn with_additions(
    file: &str,
    bytes: &[u8],
    options: &ReadOptions,
    before: &File<'_>,
    own: &[Addition],
) -> Result<Vec<u8>, Error> {
    if own.is_empty() {
        return Ok(bytes.to_vec());
    }
    let scene = File::open(file, bytes, &options.buffers)?;
    let (floor, metres) = read::floor_of(before, &before.shown(), options, &mut Report::default())?;
    let (splices, data) = additions::splices(&scene, floor, metres, own)?;
    let bin = (!data.is_empty()).then(|| [scene.bin().unwrap_or_default(), &data].concat());
    written(&scene, splices, bin)
}

/// The scene with building works made.
fn with_works(file: &str, bytes: &[u8], options: &ReadOptions, works: &[Edit]) -> Result<Vec<u8>, Error> {
    let scene = File::open(file, bytes, &options.buffers)?;
    let (splices, data) = works::made(&scene, options, works)?;
    let bin = (!data.is_empty()).then(|| [scene.bin().unwrap_or_default(), &data].concat());
    written(&scene, splices, bin)
}

/// The bytes with other JSON, and with another binary chunk where it has changed.
fn written(scene: &File<'_>, splices: Vec<Splice>, bin: Option<Vec<u8>>) -> Result<Vec<u8>, Error> {
    let json = splice::apply(scene.name, "gltf-edit-twice", scene.text(), splices)?;
    Ok(if scene.chunks.is_empty() { json } else { assembled(scene, json, bin) })
}

/// JSON pointer of the element with that [`SourceRef::record`].
///
/// [`SourceRef::record`]: crate::drawing::SourceRef::record
pub fn path_of(record: usize) -> String {
    format!("/nodes/{}", record::of_record(record).0)
}

/// A GLB with another JSON chunk, and another binary one where it has changed.
fn assembled(scene: &File<'_>, json: Vec<u8>, bin: Option<Vec<u8>>) -> Vec<u8> {
    let mut out = scene.bytes[..12].to_vec();
    add_chunk(&mut out, b"JSON", json, b' ');
    let mut rest = scene.chunks.first().map_or(scene.bytes.len(), |c| c.span.end);
    if let Some(bin) = bin {
        add_chunk(&mut out, b"BIN\0", bin, 0);
        rest = scene.chunks.get(1).map_or(rest, |c| c.span.end);
    }
    out.extend_from_slice(&scene.bytes[rest..]);
    let total = out.len() as u32;
    out[8..12].copy_from_slice(&total.to_le_bytes());
    out
}

/// Appends a chunk, padded to four bytes.
fn add_chunk(out: &mut Vec<u8>, kind: &[u8; 4], mut data: Vec<u8>, pad: u8) {
    data.resize(data.len().next_multiple_of(4), pad);
    out.extend_from_slice(&(data.len() as u32).to_le_bytes());
    out.extend_from_slice(kind);
    out.extend_from_slice(&data);
}

//! What names an element of the drawing in the user's own file.

use serde::{Deserialize, Serialize};

/// Which element of the file is meant, in the terms of its format.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum ElementRef {
    /// DXF.
    Dxf {
        /// Handle as written, upper case; `null` in files without handles.
        handle: Option<String>,
        /// Which group-0 record of the file, from 0.
        record: u64,
    },
    /// IFC.
    Ifc {
        /// `GlobalId`.
        global_id: String,
        /// Line number `#id`.
        id: u64,
    },
    /// glTF.
    Gltf {
        /// JSON pointer.
        path: String,
    },
    /// An element of several records (a DXF POLYLINE and its VERTEX records).
    Several(Vec<ElementRef>),
}

impl ElementRef {
    /// How people find it in the file: its handle, its line, its path.
    pub fn name(&self) -> String {
        match self {
            Self::Dxf { handle: Some(handle), .. } => handle.clone(),
            Self::Dxf { record, .. } => format!("record {record}"),
            Self::Ifc { id, .. } => format!("#{id}"),
            Self::Gltf { path } => path.clone(),
            Self::Several(all) => all.first().map(Self::name).unwrap_or_default(),
        }
    }
}

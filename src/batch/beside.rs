//! What lies beside a scene, as a job names or carries it.

use std::collections::BTreeMap;
use std::sync::Arc;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;
use serde::{Deserialize, Serialize};

use super::sha256_hex;
use enfilade_config::{Beside, Twin};

/// What a file beside a scene is to it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// The IFC of the same name.
    Twin,
    /// Data that a buffer names.
    Buffer,
    /// A picture that a texture names.
    Picture,
}

impl Kind {
    /// As it stands in a job.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Twin => "twin",
            Self::Buffer => "buffer",
            Self::Picture => "picture",
        }
    }
}

/// A file beside a scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FileBeside {
    /// What it is to the scene.
    pub kind: Kind,
    /// Its name as the scene has it; empty for the IFC, whose name is the scene's.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub name: String,
    /// SHA-256 of its bytes, unpacked, lower-case hexadecimal.
    pub sha256: String,
    /// Its bytes in base64, where machines share no folder.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub content: Option<String>,
}

/// All of it in a fixed order; with its bytes where it is to be carried.
pub(super) fn listed(beside: &Beside, embed: bool) -> Vec<FileBeside> {
    let of = |kind: Kind, name: &str, bytes: &[u8]| FileBeside {
        kind,
        name: name.into(),
        sha256: sha256_hex(bytes),
        content: embed.then(|| BASE64.encode(bytes)),
    };
    let twin = beside.twin.iter().map(|t| of(Kind::Twin, "", t.bytes()));
    let buffers = beside.buffers.iter().map(|(name, data)| of(Kind::Buffer, name, data));
    let pictures = beside.pictures.iter().map(|(name, data)| of(Kind::Picture, name, data));
    twin.chain(buffers).chain(pictures).collect()
}

/// What is carried.
///
/// # Errors
/// What is not as it was meant, in words.
pub(super) fn carried(files: &[FileBeside]) -> Result<Beside, String> {
    let mut out = Beside { twin: None, buffers: BTreeMap::new(), pictures: BTreeMap::new() };
    for file in files {
        let named = || format!("{} {:?} beside it", file.kind.name(), file.name);
        let text = file.content.as_deref().ok_or_else(|| format!("{}: found no content", named()))?;
        let bytes = BASE64.decode(text).map_err(|e| format!("{}: content is no base64: {e}", named()))?;
        if sha256_hex(&bytes) != file.sha256 {
            return Err(format!("{}: content is not what was meant; nothing was done", named()));
        }
        let bytes: Arc<[u8]> = bytes.into();
        match file.kind {
            Kind::Twin => out.twin = Some(Twin::from(bytes)),
            Kind::Buffer => drop(out.buffers.insert(file.name.clone(), bytes)),
            Kind::Picture => drop(out.pictures.insert(file.name.clone(), bytes)),
        }
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_lies_beside_is_carried_whole_or_refused() {
        let data =
            |text: &str| -> BTreeMap<String, Arc<[u8]>> { [("a.bin".into(), text.as_bytes().into())].into() };
        let beside =
            Beside { twin: Some(Twin::from(&b"ifc"[..])), buffers: data("one"), pictures: data("two") };
        let files = listed(&beside, true);
        assert_eq!(files.iter().map(|f| f.kind.name()).collect::<Vec<_>>(), ["twin", "buffer", "picture"]);
        assert_eq!(carried(&files), Ok(beside.clone()));
        assert!(carried(&listed(&beside, false)).unwrap_err().contains("found no content"));
        let mut other = files.clone();
        other[0].content = Some(BASE64.encode("ifd"));
        assert!(carried(&other).unwrap_err().contains("not what was meant"));
        other[1].content = Some("?".into());
        assert!(carried(&other[1..]).unwrap_err().contains("no base64"));
    }
}

//! Changed ranges of a file's bytes.

use enfilade_report::{Error, Place};

/// Bytes to put in place of a range of the original.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Splice {
    /// First byte replaced.
    pub start: usize,
    /// One past the last byte replaced.
    pub end: usize,
    /// What stands there instead.
    pub with: Vec<u8>,
}

impl Splice {
    /// Replaces a range by text.
    pub fn new(range: std::ops::Range<usize>, with: impl Into<Vec<u8>>) -> Self {
        Self { start: range.start, end: range.end, with: with.into() }
    }
}

/// Puts the splices into the bytes; two that overlap are two edits of one value.
pub(super) fn apply(
    file: &str,
    code: &'static str,
    bytes: &[u8],
    mut splices: Vec<Splice>,
) -> Result<Vec<u8>, Error> {
    splices.sort_by_key(|s| s.start);
    let added: usize = splices.iter().map(|s| s.with.len()).sum();
    let mut out = Vec::with_capacity(bytes.len() + added);
    let mut pos = 0;
    for splice in &splices {
        if splice.start < pos {
            let text = "two edits of one value, expected one edit an entity; nothing was written";
            return Err(Error::input(code, Place::file(file), text));
        }
        out.extend_from_slice(&bytes[pos..splice.start]);
        out.extend_from_slice(&splice.with);
        pos = splice.end;
    }
    out.extend_from_slice(&bytes[pos..]);
    Ok(out)
}

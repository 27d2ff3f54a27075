//! Exchange formats: one deep module a format, read and patch together, and the choice between them.

pub mod dxf;
pub mod ifc;
mod splice;

use std::borrow::Cow;

use crate::plan::drawing::{Addition, Drawing, Edit, Format, SourceRef};
use crate::report::{Error, Report};
pub use dxf::{ChangedRecord, Completeness};

/// How to read a drawing of any format.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ReadOptions {
    /// Takes DXF files of programs that never write `0/EOF`.
    pub accept_missing_eof: bool,
    /// Storey of a building; `None`: the one with most walls.
    pub storey: Option<String>,
    /// Height at which a building is cut.
    pub sight: ifc::Sight,
}

impl ReadOptions {
    fn dxf(&self) -> dxf::ReadOptions {
        dxf::ReadOptions { accept_missing_eof: self.accept_missing_eof, ..Default::default() }
    }

    fn ifc(&self) -> ifc::ReadOptions {
        ifc::ReadOptions { storey: self.storey.clone(), sight: self.sight }
    }
}

/// File name endings that are read, lower case.
pub const ENDINGS: [&str; 3] = ["dxf", "ifc", "ifczip"];

/// The format of a file: by its first bytes, else by its ending, else DXF.
pub fn format_of(file: &str, bytes: &[u8]) -> Format {
    let start = bytes.iter().position(|b| !b.is_ascii_whitespace()).unwrap_or(0);
    let head = bytes[start..].get(..16).unwrap_or(&bytes[start..]).to_ascii_uppercase();
    let head = head.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(&head);
    let ending = file.rsplit('.').next().unwrap_or_default().to_lowercase();
    if head.starts_with(b"ISO-10303-21") || ending.starts_with("ifc") { Format::Ifc } else { Format::Dxf }
}

/// The bytes that are read and patched: unpacked, and without result layers of ours.
pub fn plain<'a>(file: &str, bytes: &'a [u8]) -> Cow<'a, [u8]> {
    match format_of(file, bytes) {
        Format::Dxf => {
            let clean = dxf::strip_own(bytes);
            if clean.len() == bytes.len() { Cow::Borrowed(bytes) } else { Cow::Owned(clean) }
        }
        Format::Ifc => match ifc::is_zip(bytes).then(|| ifc::unzip(file, bytes)) {
            Some(Ok(unpacked)) => Cow::Owned(ifc::strip_own(&unpacked).into_owned()),
            _ => ifc::strip_own(bytes),
        },
    }
}

/// Reads a drawing.
///
/// # Errors
/// [`Error::Input`] when the bytes cannot be used; [`Error::Usage`] for a storey that is not there.
pub fn read(file: &str, bytes: &[u8], options: &ReadOptions, report: &mut Report) -> Result<Drawing, Error> {
    match format_of(file, bytes) {
        Format::Dxf => dxf::read(file, bytes, &options.dxf(), report),
        Format::Ifc if ifc::is_zip(bytes) => ifc::read(file, &ifc::unzip(file, bytes)?, &options.ifc(), report),
        Format::Ifc => ifc::read(file, bytes, &options.ifc(), report),
    }
}

/// The file's own bytes with the edits made and the additions put in.
///
/// # Errors
/// [`Error::Input`] where an edit does not fit what it names; nothing is to be written then.
pub fn patch(
    file: &str,
    bytes: &[u8],
    options: &ReadOptions,
    edits: &[Edit],
    additions: &[Addition],
) -> Result<Vec<u8>, Error> {
    match format_of(file, bytes) {
        Format::Dxf => dxf::patch(file, bytes, edits, additions),
        Format::Ifc => ifc::patch(file, bytes, &options.ifc(), edits, additions),
    }
}

/// What each edit changes: records of a DXF, products of a building.
///
/// # Errors
/// As [`patch`].
pub fn changed_records(file: &str, bytes: &[u8], edits: &[Edit]) -> Result<Vec<Vec<ChangedRecord>>, Error> {
    match format_of(file, bytes) {
        Format::Dxf => dxf::changed_records(file, bytes, edits),
        Format::Ifc => {
            let named = |p: ifc::MovedProduct| ChangedRecord { record: p.id as usize, handle: Some(p.global_id) };
            let moved = ifc::moved_products(file, bytes, edits)?;
            Ok(moved.into_iter().map(|list| list.into_iter().map(named).collect()).collect())
        }
    }
}

/// Ids of elements in the program that wrote the file.
pub fn host_ids(file: &str, bytes: &[u8], records: &[usize]) -> Vec<Option<String>> {
    match format_of(file, bytes) {
        Format::Dxf => dxf::host_ids(bytes, records),
        Format::Ifc => ifc::tags(bytes, records),
    }
}

/// Annotation that is tied to moved records and does not follow them.
///
/// # Errors
/// As reading.
pub fn dependents(
    file: &str,
    bytes: &[u8],
    options: &ReadOptions,
    moved: &[usize],
) -> Result<Vec<SourceRef>, Error> {
    match format_of(file, bytes) {
        Format::Dxf => {
            let drawing = dxf::read(file, bytes, &options.dxf(), &mut Report::default())?;
            dxf::dependents(file, bytes, &drawing, moved)
        }
        Format::Ifc => Ok(Vec::new()),
    }
}

/// Whether a file is whole.
pub fn is_complete(file: &str, bytes: &[u8]) -> Completeness {
    if bytes.is_empty() {
        return Completeness::Empty;
    }
    match format_of(file, bytes) {
        Format::Dxf => dxf::is_complete(bytes),
        Format::Ifc => match ifc::completeness(bytes) {
            ifc::Incomplete::No => Completeness::Whole,
            ifc::Incomplete::Because(why) => Completeness::Incomplete(why),
        },
    }
}

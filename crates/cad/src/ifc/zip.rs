//! `.ifczip`: one STEP file in a ZIP archive.

use std::io::Read;

use super::Incomplete;
use super::limits::{UNZIPPED_MAX, ZIP_RATIO_MAX};
use enfilade_report::{Error, Place};

/// Whether bytes are a ZIP archive.
pub fn is_zip(bytes: &[u8]) -> bool {
    bytes.starts_with(b"PK\x03\x04") || bytes.starts_with(b"PK\x05\x06")
}

/// What is expected in place of sizes for archives of more than 4 GiB, and what helps.
const PLAIN_ZIP: &str = "expected a plain ZIP file; unpack it and take the .ifc inside, or pack that again";

/// Whether the directory of an archive leaves its place or its length to a ZIP64 record.
fn is_zip64(bytes: &[u8]) -> bool {
    let Some(end) = directory_end(bytes) else { return false };
    let is_full = |at: usize, len: usize, full: u64| number(bytes, end + at, len) == Some(full);
    is_full(10, 2, u64::from(u16::MAX))
        || is_full(12, 4, u64::from(u32::MAX))
        || is_full(16, 4, u64::from(u32::MAX))
}

/// A file of an archive.
struct Entry {
    name: String,
    method: u16,
    packed: u64,
    unpacked: u64,
    crc: u32,
    at: usize,
}

/// Whether the archive's directory is there.
pub(super) fn completeness(bytes: &[u8]) -> Incomplete {
    match directory_end(bytes) {
        Some(_) => Incomplete::No,
        None => Incomplete::Because("found no directory at the end of the archive".into()),
    }
}

/// The IFC inside an archive.
///
/// # Errors
/// [`Error::Input`] for an archive without exactly one IFC file, and for one that unpacks to more than
/// [`UNZIPPED_MAX`] bytes or [`ZIP_RATIO_MAX`] times its size.
pub fn unzip(file: &str, bytes: &[u8]) -> Result<Vec<u8>, Error> {
    let fault = |text: String| Error::input("ifczip", Place::file(file), format!("{text}; nothing was done"));
    if is_zip64(bytes) {
        return Err(fault(format!("found an archive with its directory as ZIP64, {PLAIN_ZIP}")));
    }
    let entries =
        entries(bytes).ok_or_else(|| fault("found a damaged archive, expected a ZIP file".into()))?;
    let is_ifc = |e: &&Entry| e.name.to_lowercase().ends_with(".ifc");
    let mut found = entries.iter().filter(is_ifc);
    let (Some(entry), None) = (found.next(), found.next()) else {
        let n = entries.iter().filter(is_ifc).count();
        return Err(fault(format!("found {n} .ifc files in the archive, expected one")));
    };
    if [entry.packed, entry.unpacked, entry.at as u64].contains(&u64::from(u32::MAX)) {
        return Err(fault(format!("found {} with its sizes as ZIP64, {PLAIN_ZIP}", entry.name)));
    }
    if entry.unpacked > UNZIPPED_MAX
        || entry.unpacked > entry.packed.saturating_mul(ZIP_RATIO_MAX).max(1 << 20)
    {
        let text = format!(
            "{} is {} bytes packed and {} unpacked, expected at most {UNZIPPED_MAX} bytes and {ZIP_RATIO_MAX} times the packed size",
            entry.name, entry.packed, entry.unpacked
        );
        return Err(fault(text));
    }
    let data = data_of(bytes, entry).ok_or_else(|| fault(format!("{} is cut off", entry.name)))?;
    let mut out = Vec::new();
    match entry.method {
        0 => out.extend_from_slice(data),
        8 => {
            let mut reader = flate2::read::DeflateDecoder::new(data).take(entry.unpacked + 1);
            reader
                .read_to_end(&mut out)
                .map_err(|e| fault(format!("{} cannot be unpacked: {e}", entry.name)))?;
        }
        other => return Err(fault(format!("{} is packed by method {other}, expected 0 or 8", entry.name))),
    }
    if out.len() as u64 != entry.unpacked {
        return Err(fault(format!("{} unpacks to another size than stated", entry.name)));
    }
    let mut crc = flate2::Crc::new();
    crc.update(&out);
    if crc.sum() != entry.crc {
        let text = format!("{} is damaged: its checksum is not the one that the archive states", entry.name);
        return Err(fault(text));
    }
    Ok(out)
}

fn number(bytes: &[u8], at: usize, len: usize) -> Option<u64> {
    let part = bytes.get(at..at.checked_add(len)?)?;
    Some(part.iter().rev().fold(0, |sum, b| sum << 8 | u64::from(*b)))
}

fn directory_end(bytes: &[u8]) -> Option<usize> {
    let from = bytes.len().saturating_sub(66_000);
    bytes[from..].windows(4).rposition(|w| w == b"PK\x05\x06").map(|i| from + i)
}

fn entries(bytes: &[u8]) -> Option<Vec<Entry>> {
    let end = directory_end(bytes)?;
    let count = number(bytes, end + 10, 2)?;
    let mut at = number(bytes, end + 16, 4)? as usize;
    let mut out = Vec::new();
    for _ in 0..count {
        if bytes.get(at..at + 4)? != b"PK\x01\x02" {
            return None;
        }
        let [name, extra, comment] = [28, 30, 32].map(|o| number(bytes, at + o, 2).map(|v| v as usize));
        let (name, extra, comment) = (name?, extra?, comment?);
        out.push(Entry {
            name: String::from_utf8_lossy(bytes.get(at + 46..at + 46 + name)?).into_owned(),
            method: number(bytes, at + 10, 2)? as u16,
            packed: number(bytes, at + 20, 4)?,
            unpacked: number(bytes, at + 24, 4)?,
            crc: number(bytes, at + 16, 4)? as u32,
            at: number(bytes, at + 42, 4)? as usize,
        });
        at += 46 + name + extra + comment;
    }
    Some(out)
}

fn data_of<'a>(bytes: &'a [u8], entry: &Entry) -> Option<&'a [u8]> {
    let at = entry.at;
    if bytes.get(at..at + 4)? != b"PK\x03\x04" {
        return None;
    }
    let start = at + 30 + number(bytes, at + 26, 2)? as usize + number(bytes, at + 28, 2)? as usize;
    bytes.get(start..start.checked_add(entry.packed as usize)?)
}

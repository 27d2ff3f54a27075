//! What lies in a folder of results already: nothing equal is written twice, and what still holds stays.

use std::fs;
use std::path::{Path, PathBuf};

use super::{ANALYSIS_JSON, OutFile, read_own};

/// The files of an earlier analysis that one of `files` does not take the place of, as far as they still hold.
pub(super) fn kept_beside(folder: &Path, files: &[OutFile]) -> Vec<OutFile> {
    let sha256 = |json: &[u8]| {
        let value: serde_json::Value = serde_json::from_slice(json).ok()?;
        Some(value["input"]["sha256"].as_str()?.to_owned())
    };
    let now = files.iter().find(|f| f.path == Path::new(ANALYSIS_JSON)).and_then(|f| sha256(&f.bytes));
    let before = read_own(&folder.join(ANALYSIS_JSON)).ok().and_then(|bytes| sha256(&bytes));
    let is_same_drawing = now.is_some() && now == before;
    let kept = |entry: fs::DirEntry| {
        let path = PathBuf::from(entry.file_name());
        let is_picture = path.extension().is_some_and(|e| e == "png");
        let is_left = files.iter().all(|f| f.path != path) && (is_same_drawing || !is_picture);
        let is_file = entry.file_type().is_ok_and(|t| t.is_file());
        (is_left && is_file)
            .then(|| fs::read(entry.path()).ok().map(|bytes| OutFile::new(path, bytes)))
            .flatten()
    };
    let Ok(entries) = fs::read_dir(folder) else { return Vec::new() };
    entries.filter_map(Result::ok).filter_map(kept).collect()
}

/// Whether `folder` holds these files with these bytes and no others.
pub(super) fn holds_exactly(folder: &Path, files: &[OutFile]) -> bool {
    let is_equal = |f: &OutFile| has_bytes(&folder.join(&f.path), &f.bytes);
    count_files(folder) == Some(files.len()) && files.iter().all(is_equal)
}

/// Whether a file has these bytes; nothing else is opened, and no longer one is read.
pub(super) fn has_bytes(path: &Path, bytes: &[u8]) -> bool {
    fs::metadata(path).is_ok_and(|m| m.is_file() && m.len() == bytes.len() as u64)
        && fs::read(path).is_ok_and(|old| old == bytes)
}

fn count_files(folder: &Path) -> Option<usize> {
    let mut count = 0;
    for entry in fs::read_dir(folder).ok()? {
        let entry = entry.ok()?;
        count += if entry.file_type().ok()?.is_dir() { count_files(&entry.path())? } else { 1 };
    }
    Some(count)
}

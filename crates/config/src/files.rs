//! Which files beside a drawing are its settings.

use std::path::{Path, PathBuf};

/// Files that may hold settings of a drawing, the nearest first: its side-car and its own folder's file.
/// Commands and daemon both go by this.
pub fn settings_files(drawing: &Path) -> [PathBuf; 2] {
    [drawing.with_extension("enfilade.toml"), drawing.with_file_name("enfilade.toml")]
}

/// Whether a file of that name is the settings of some drawing, or was meant as such.
pub fn is_settings(path: &Path) -> bool {
    let name = path.file_name().unwrap_or_default().to_string_lossy().to_ascii_lowercase();
    let name = name.strip_suffix(".txt").unwrap_or(&name);
    let Some(before) = name.strip_suffix("enfilade.toml") else { return false };
    before.is_empty() || before.ends_with(['.', '-', '_'])
}

/// Names in a drawing's folder that are not read but were meant as its side-car, each with the name that is read.
/// `found` are names of files as they lie there, in any order.
pub fn unread_side_cars(drawing: &Path, found: &[String]) -> Vec<(String, String)> {
    let name = |p: &Path| p.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let [own, folder] = settings_files(drawing).map(|p| name(&p));
    let (whole, stem) =
        (name(drawing), drawing.file_stem().unwrap_or_default().to_string_lossy().into_owned());
    let meant = [
        (own.clone(), &own),
        (format!("{whole}.enfilade.toml"), &own),
        (format!("{whole}.enfilade"), &own),
        (format!("{own}.txt"), &own),
        (format!("{stem}-enfilade.toml"), &own),
        (format!("{stem}_enfilade.toml"), &own),
        (folder.clone(), &folder),
        (format!("{folder}.txt"), &folder),
    ];
    let reads = |n: &String| *n == own || *n == folder;
    let near = |n: &&String| {
        let right = meant.iter().find(|(m, _)| m.eq_ignore_ascii_case(n)).filter(|_| !reads(n));
        right.map(|(_, right)| ((*n).clone(), (*right).clone()))
    };
    let mut out: Vec<(String, String)> = found.iter().filter_map(|n| near(&n)).collect();
    out.sort();
    out
}

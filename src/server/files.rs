//! Files of results, found by looking through their folder: a name from outside never becomes a path.

use std::fs::{self, File};
use std::io::Read as _;
use std::path::{Path, PathBuf};

use crate::store::{SO_FAR, open_to_read};

/// Sets of results there: `analysis`, `round-01` …, `so-far`, rounds in the order of their numbers. Links are left out.
pub(super) fn sets(home: &Path) -> Vec<String> {
    let mut names: Vec<String> = entries(home, true).into_iter().map(|(name, _)| name).collect();
    names.retain(|n| n == "analysis" || n == SO_FAR || n.strip_prefix("round-").is_some_and(is_number));
    let number = |n: &String| n.strip_prefix("round-").and_then(|n| n.parse::<u64>().ok());
    names.sort_by(|a, b| number(a).cmp(&number(b)).then(a.cmp(b)));
    names
}

fn is_number(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit())
}

/// Names of the files of a set, in their order; `None` where there is no such set.
pub(super) fn names(home: &Path, set: &str) -> Option<Vec<String>> {
    if !sets(home).iter().any(|s| s == set) {
        return None;
    }
    let mut names: Vec<String> = entries(&home.join(set), false).into_iter().map(|(name, _)| name).collect();
    names.sort();
    Some(names)
}

/// Largest file that is handed out or read, bytes: pictures, reports and drawings of a round stay far below.
pub(super) const FILE_BYTES_MAX: u64 = 256 << 20;

/// What lies under a name.
#[derive(Debug)]
pub(super) enum Found<T> {
    /// A file; what was asked of it.
    File(T),
    /// A file of more than [`FILE_BYTES_MAX`].
    TooLarge,
    /// Everything that is not a plain file lying there.
    Nothing,
}

/// A file of a set, open, with its length.
pub(super) fn open(home: &Path, set: &str, name: &str) -> Found<(File, u64)> {
    if !sets(home).iter().any(|s| s == set) {
        return Found::Nothing;
    }
    let folder = home.join(set);
    let path = entries(&folder, false).into_iter().find(|(n, _)| n == name).map(|(_, path)| path);
    let file = path.and_then(|path| open_to_read(&path).ok());
    match file.and_then(|file| Some((file.metadata().ok()?.len(), file))) {
        Some((length, _)) if length > FILE_BYTES_MAX => Found::TooLarge,
        Some((length, file)) => Found::File((file, length)),
        None => Found::Nothing,
    }
}

/// Bytes of a file of a set; `None` for everything that is not a plain file lying there, or a large one.
pub(super) fn read(home: &Path, set: &str, name: &str) -> Option<Vec<u8>> {
    let Found::File((file, length)) = open(home, set, name) else { return None };
    let mut bytes = Vec::new();
    file.take(length).read_to_end(&mut bytes).ok()?;
    Some(bytes)
}

/// Folders, or plain files, of a folder that is no link itself; links in it are left out.
fn entries(folder: &Path, folders: bool) -> Vec<(String, PathBuf)> {
    if !fs::symlink_metadata(folder).is_ok_and(|m| m.is_dir()) {
        return Vec::new();
    }
    let Ok(entries) = fs::read_dir(folder) else { return Vec::new() };
    let kept = entries.flatten().filter(|e| {
        // The entry's own type: a link is neither.
        e.file_type().is_ok_and(|t| if folders { t.is_dir() } else { t.is_file() })
    });
    let named = kept.filter_map(|e| Some((e.file_name().to_str()?.to_owned(), e.path())));
    named.filter(|(name, _)| !name.starts_with('.')).collect()
}

/// The media type of a round's report: it is shown in an origin of its own.
pub(super) const REPORT: &str = "text/html; charset=utf-8";

/// The media type by the ending; what else could run in a browser is handed out as a download.
pub(super) fn kind(name: &str) -> (&'static str, bool) {
    match name.rsplit('.').next().unwrap_or_default() {
        _ if name == "report.html" => (REPORT, false),
        "png" => ("image/png", false),
        "json" => ("application/json", false),
        _ => ("application/octet-stream", true),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_plain_files_of_a_set_are_read() {
        let dir = tempfile::tempdir().unwrap();
        let home = dir.path().join("plan.enfilade");
        fs::create_dir_all(home.join("round-01/sub")).unwrap();
        fs::create_dir(home.join("round-x")).unwrap();
        fs::create_dir(home.join("other")).unwrap();
        fs::write(home.join("round-01/result.json"), "1").unwrap();
        fs::write(home.join("round-01/.hidden"), "1").unwrap();
        fs::write(home.join("status.json"), "1").unwrap();
        fs::write(dir.path().join("secret"), "1").unwrap();
        assert_eq!(sets(&home), ["round-01"]);
        for more in ["round-100", "round-99", "analysis", "so-far"] {
            fs::create_dir(home.join(more)).unwrap();
        }
        assert_eq!(sets(&home), ["analysis", "so-far", "round-01", "round-99", "round-100"]);
        assert_eq!(read(&home, "round-01", "result.json"), Some(b"1".to_vec()));
        for (set, name) in [
            ("round-01", "../status.json"),
            ("round-01", "../../secret"),
            ("round-01", "/etc/passwd"),
            ("round-01", ".hidden"),
            ("round-01", "sub"),
            ("round-01", ""),
            ("..", "secret"),
            (".", "status.json"),
            ("other", "x"),
        ] {
            assert_eq!(read(&home, set, name), None, "{set} {name}");
        }
    }

    /// Whoever may write to a shared folder must not fill the memory of this user's machine.
    #[test]
    fn a_file_too_large_is_not_read() {
        let dir = tempfile::tempdir().unwrap();
        fs::create_dir(dir.path().join("round-01")).unwrap();
        for (name, bytes) in [("result.json", FILE_BYTES_MAX + 1), ("a.png", 2 << 30), ("b.png", 10)] {
            File::create(dir.path().join("round-01").join(name)).unwrap().set_len(bytes).unwrap();
        }
        let found = |name| open(dir.path(), "round-01", name);
        assert!(matches!(found("a.png"), Found::TooLarge) && matches!(found("result.json"), Found::TooLarge));
        assert!(matches!(found("b.png"), Found::File((_, 10))) && matches!(found("c.png"), Found::Nothing));
        assert_eq!(read(dir.path(), "round-01", "result.json"), None);
        assert_eq!(read(dir.path(), "round-01", "b.png"), Some(vec![0; 10]));
    }

    #[cfg(unix)]
    #[test]
    fn links_are_never_followed() {
        use std::os::unix::fs::symlink;
        let dir = tempfile::tempdir().unwrap();
        fs::write(dir.path().join("secret"), "1").unwrap();
        let home = dir.path().join("plan.enfilade");
        fs::create_dir_all(home.join("round-01")).unwrap();
        symlink(dir.path().join("secret"), home.join("round-01/a.png")).unwrap();
        symlink(dir.path(), home.join("round-02")).unwrap();
        assert_eq!(read(&home, "round-01", "a.png"), None);
        assert_eq!(read(&home, "round-02", "secret"), None);
        symlink(&home, dir.path().join("linked")).unwrap();
        assert!(sets(&dir.path().join("linked")).is_empty());
    }
}

//! A log of lines that never grows without end.

use std::fs::File;
use std::io::Read as _;
use std::path::{Path, PathBuf};

use super::{Disk, SystemDisk, disk_error_here};
use enfilade_report::{Error, Place, printable};

/// Size from which a log is put aside, bytes.
pub const LOG_BYTES_MAX: u64 = 2 << 20;
/// Logs put aside that are kept: `watch.log.1` is the newest.
const KEPT: usize = 4;

/// What else helps where a log cannot be written: only `--log` says where it is.
const OR_OTHER_LOG: &str = " or name another file with --log";

/// An open log.
pub struct Log {
    path: PathBuf,
}

impl Log {
    /// Makes the log's folder where needed, but none above it.
    ///
    /// # Errors
    /// `not-a-log` where something else lies there; else from the disk.
    pub fn open(path: &Path) -> Result<Self, Error> {
        let folder = path.parent().filter(|f| !f.as_os_str().is_empty());
        if let Some(folder) = folder.filter(|f| !f.is_dir()) {
            SystemDisk
                .create_folder(folder)
                .map_err(|e| disk_error_here("making", folder, &e, OR_OTHER_LOG))?;
        }
        refuse_other(path)?;
        SystemDisk
            .append(path, b"", false)
            .map_err(|e| disk_error_here("writing", path, &e, OR_OTHER_LOG))?;
        Ok(Self { path: path.into() })
    }

    /// Adds a line; line ends in it are blanks. A full log is put aside first.
    ///
    /// # Errors
    /// From the disk.
    pub fn line(&self, text: &str) -> Result<(), Error> {
        if std::fs::metadata(&self.path).is_ok_and(|m| m.len() >= LOG_BYTES_MAX) {
            self.put_aside();
        }
        let line = format!("{}\n", printable(&text.replace(['\n', '\r'], " ")));
        let added = SystemDisk.append(&self.path, line.as_bytes(), false);
        added.map_err(|e| disk_error_here("writing", &self.path, &e, OR_OTHER_LOG))
    }

    /// Where this fails the log goes on in the same file.
    fn put_aside(&self) {
        for number in (0..KEPT).rev() {
            let _ = SystemDisk.rename(&self.numbered(number), &self.numbered(number + 1));
        }
    }

    fn numbered(&self, number: usize) -> PathBuf {
        let mut name = self.path.clone().into_os_string();
        if number > 0 {
            name.push(format!(".{number}"));
        }
        name.into()
    }
}

/// A line begins with its time: `2026-01-31T12:00:00Z `.
const TIME_OF_LINE: &[u8] = b"0000-00-00T00:00:00Z ";

/// What lies there and is no log of ours is never written to: it may be a drawing.
fn refuse_other(path: &Path) -> Result<(), Error> {
    let Ok(found) = std::fs::symlink_metadata(path) else { return Ok(()) };
    let is_other = found.is_file() && found.len() > 0 && !begins_with_a_time(path);
    if is_other || (!found.is_file() && !found.is_dir()) {
        let text = "--log: found something that is no log of this program, expected one or no file; nothing was done";
        return Err(Error::usage("not-a-log", Place::file(path.to_string_lossy()), text));
    }
    Ok(())
}

fn begins_with_a_time(path: &Path) -> bool {
    let mut head = [0; TIME_OF_LINE.len()];
    let read = File::open(path).and_then(|mut file| file.read_exact(&mut head));
    let is_like =
        |(found, like): (&u8, &u8)| if *like == b'0' { found.is_ascii_digit() } else { found == like };
    read.is_ok() && head.iter().zip(TIME_OF_LINE).all(is_like)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn a_log_that_cannot_be_written_is_no_log() {
        let dir = tempfile::tempdir().unwrap();
        let said = Log::open(dir.path()).err().unwrap().to_string();
        assert!(said.contains("--log") && !said.contains("--out"), "{said}");
        assert!(Log::open(&dir.path().join("watch.log")).is_ok());
        let far = dir.path().join("a/b/watch.log");
        assert!(Log::open(&far).is_err() && !dir.path().join("a").exists(), "only the last folder is made");
    }

    #[test]
    fn only_a_log_of_ours_is_added_to() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("watch.log");
        let table: [(&str, bool); 6] = [
            ("", true),
            ("2026-01-31T12:00:00Z watching /plans\n", true),
            ("0\nSECTION\n2\nHEADER\n", false),
            ("2026-01-31T12:00:00Z", false),
            ("my own notes", false),
            ("x", false),
        ];
        for (text, is_ours) in table {
            fs::write(&path, text).unwrap();
            match Log::open(&path) {
                Ok(_) => assert!(is_ours, "{text:?}"),
                Err(e) => assert!(!is_ours && e.problem().unwrap().code == "not-a-log", "{text:?}: {e}"),
            }
            assert_eq!(fs::read_to_string(&path).unwrap(), text);
        }
        // Whatever a link leads to is somebody's.
        #[cfg(unix)]
        {
            fs::write(&path, "").unwrap();
            let linked = dir.path().join("linked.log");
            std::os::unix::fs::symlink(&path, &linked).unwrap();
            assert_eq!(Log::open(&linked).err().unwrap().problem().unwrap().code, "not-a-log");
        }
    }

    #[test]
    fn a_full_log_is_put_aside_and_old_ones_go() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("deep/watch.log");
        let log = Log::open(&path).unwrap();
        for round in 0..KEPT + 3 {
            fs::write(&path, vec![b'x'; LOG_BYTES_MAX as usize]).unwrap();
            log.line(&format!("round {round}\nof many \x1b[31m")).unwrap();
            assert_eq!(fs::read_to_string(&path).unwrap(), format!("round {round} of many \\u{{1b}}[31m\n"));
        }
        assert_eq!(fs::read_dir(dir.path().join("deep")).unwrap().count(), KEPT + 1);
    }
}

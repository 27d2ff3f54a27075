//! A log of lines that never grows without end.

use std::path::{Path, PathBuf};

use super::{Disk, SystemDisk, disk_error};
use crate::report::{Error, printable};

/// Size from which a log is put aside, bytes.
pub const LOG_BYTES_MAX: u64 = 2 << 20;
/// Logs put aside that are kept: `watch.log.1` is the newest.
const KEPT: usize = 4;

/// An open log.
pub struct Log {
    path: PathBuf,
}

impl Log {
    /// Makes the log's folder where needed.
    ///
    /// # Errors
    /// From the disk.
    pub fn open(path: &Path) -> Result<Self, Error> {
        if let Some(folder) = path.parent() {
            SystemDisk.create_folders(folder).map_err(|e| disk_error("making", folder, &e))?;
        }
        SystemDisk.append(path, b"", false).map_err(|e| disk_error("writing", path, &e))?;
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
        added.map_err(|e| disk_error("writing", &self.path, &e))
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

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn a_log_that_cannot_be_written_is_no_log() {
        let dir = tempfile::tempdir().unwrap();
        assert!(Log::open(dir.path()).is_err());
        assert!(Log::open(&dir.path().join("watch.log")).is_ok());
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

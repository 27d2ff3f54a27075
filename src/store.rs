//! The only place that writes files: results appear whole or not at all.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

use crate::report::{Error, OutFile, Place};

/// The results folder of one drawing: `plan.enfilade/`.
pub struct Results(PathBuf);

impl Results {
    /// The results folder of `drawing`, beside it or below `out`.
    ///
    /// # Errors
    /// [`Error::Usage`] for a drawing without a name.
    pub fn of(drawing: &Path, out: Option<&Path>) -> Result<Self, Error> {
        let folder = drawing.with_extension("enfilade");
        let name = folder.file_name().map(PathBuf::from);
        let name = name.ok_or_else(|| Error::usage("drawing", place(drawing), "not a file name"))?;
        Ok(Self(out.map_or(folder, |o| o.join(name))))
    }

    /// Number of the next round.
    ///
    /// # Errors
    /// [`Error::Environment`] when the folder cannot be read.
    pub fn next_round(&self) -> Result<u32, Error> {
        Ok(self.rounds()?.last().copied().unwrap_or(0) + 1)
    }

    fn rounds(&self) -> Result<Vec<u32>, Error> {
        let entries = match fs::read_dir(&self.0) {
            Ok(entries) => entries,
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok(Vec::new()),
            Err(e) => return Err(failed(&self.0, &e)),
        };
        let number = |e: fs::DirEntry| e.file_name().to_str()?.strip_prefix("round-")?.parse().ok();
        let mut out: Vec<u32> = entries.flatten().filter_map(number).collect();
        out.sort_unstable();
        Ok(out)
    }

    /// Replaces `analysis/`.
    ///
    /// # Errors
    /// [`Error::Environment`].
    pub fn publish_analysis(&self, files: &[OutFile]) -> Result<PathBuf, Error> {
        let to = self.0.join("analysis");
        let made = self.make(files)?;
        if to.exists() {
            fs::remove_dir_all(&to).map_err(|e| failed(&to, &e))?;
        }
        fs::rename(made.keep(), &to).map_err(|e| failed(&to, &e))?;
        Ok(to)
    }

    /// Makes the next round's folder.
    ///
    /// # Errors
    /// [`Error::Environment`].
    pub fn publish_round(&self, files: &[OutFile]) -> Result<PathBuf, Error> {
        let to = self.0.join(format!("round-{:02}", self.next_round()?));
        fs::rename(self.make(files)?.keep(), &to).map_err(|e| failed(&to, &e))?;
        Ok(to)
    }

    fn make(&self, files: &[OutFile]) -> Result<tempfile::TempDir, Error> {
        fs::create_dir_all(&self.0).map_err(|e| failed(&self.0, &e))?;
        let temp =
            tempfile::Builder::new().prefix(".tmp-").tempdir_in(&self.0).map_err(|e| failed(&self.0, &e))?;
        for file in files {
            write_file(&temp.path().join(&file.path), &file.bytes)?;
        }
        Ok(temp)
    }

    /// result.json of a round, the newest by default.
    ///
    /// # Errors
    /// [`Error::Usage`] when there is none.
    pub fn read_round(&self, number: Option<u32>) -> Result<(u32, Vec<u8>), Error> {
        let newest = self.rounds()?.last().copied();
        let round = number.or(newest).ok_or_else(|| {
            Error::usage("no-round", place(&self.0), "no round yet; `enfilade run` makes one")
        })?;
        let path = self.0.join(format!("round-{round:02}/result.json"));
        fs::read(&path).map(|bytes| (round, bytes)).map_err(|e| failed(&path, &e))
    }
}

/// Writes a file through a temporary one beside it.
///
/// # Errors
/// [`Error::Environment`].
pub fn write_file(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    persist(path, bytes, true)
}

/// Writes a file that must not exist yet.
///
/// # Errors
/// [`Error::Environment`].
pub fn write_new(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    persist(path, bytes, false)
}

fn persist(path: &Path, bytes: &[u8], over: bool) -> Result<(), Error> {
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut temp = tempfile::NamedTempFile::new_in(folder).map_err(|e| failed(path, &e))?;
    temp.write_all(bytes).and_then(|()| temp.as_file().sync_all()).map_err(|e| failed(path, &e))?;
    let done = if over { temp.persist(path) } else { temp.persist_noclobber(path) };
    done.map(|_| ()).map_err(|e| failed(path, &e.error))
}

/// Writes an accepted candidate as `plan-r02.dxf` (r03, …) with its side-car.
///
/// # Errors
/// [`Error::Environment`].
pub fn write_accepted(drawing: &Path, bytes: &[u8], side_car: &[u8]) -> Result<(PathBuf, PathBuf), Error> {
    let stem = drawing.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
    let (base, last) = match stem.rsplit_once("-r") {
        Some((base, n)) if n.len() >= 2 && n.bytes().all(|b| b.is_ascii_digit()) => {
            (base.to_string(), n.parse().unwrap_or(1))
        }
        _ => (stem.clone(), 1u32),
    };
    let extension = drawing.extension().map(|e| e.to_string_lossy().into_owned()).unwrap_or_default();
    for round in last + 1.. {
        let path = drawing.with_file_name(format!("{base}-r{round:02}.{extension}"));
        if !path.exists() {
            let side = path.with_extension("enfilade.toml");
            write_file(&side, side_car)?;
            write_new(&path, bytes)?;
            return Ok((path, side));
        }
    }
    Err(Error::environment("accepted", place(drawing), "no free name"))
}

fn place(path: &Path) -> Place {
    Place::file(path.to_string_lossy())
}

fn failed(path: &Path, e: &std::io::Error) -> Error {
    Error::environment("write", place(path), format!("{e}; nothing was written"))
}

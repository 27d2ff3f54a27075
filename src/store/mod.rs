//! The only module that writes files: sets of outputs appear whole or not at all.
//!
//! [`Home`] is the result folder of one drawing (`plan.enfilade/`), [`Journal`] remembers across
//! crashes what was made from which content, [`Ownership`] keeps two daemons off one folder, and
//! [`Disk`] is the seam at which tests make every single write fail. Inputs are never written.

mod disk;
mod elsewhere;
mod journal;
mod log;
mod own;
mod owner;
mod there;

use std::ffi::{OsStr, OsString};
use std::fs::{self, File, TryLockError};
use std::io::{self, Write};
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use serde_json::Value;
use sha2::{Digest, Sha256};

pub use disk::{Disk, SystemDisk};
pub use elsewhere::{Claim, Records};
pub use journal::{Ended, Journal, Step};
pub use log::{LOG_BYTES_MAX, Log};
pub use owner::{
    FOLDER_OWNED, Lease, LeaseVerdict, Ownership, host_name, is_held, judge_lease, read_lease, refuse_nested,
};

pub use own::{led_beside, led_to, open_to_read, read_named, read_own};

pub use enfilade_report::OutFile;
use enfilade_report::{Error, Place};
use own::{open_own, planted_of, refuse_link, refuse_planted, write_into};
use there::{has_bytes, holds_exactly, kept_beside};

/// Code of the problem that a disk has no room.
pub const DISK_FULL: &str = "disk-full";
/// Code of the error where a link lies in the place of results.
pub const OUTPUT_IS_LINK: &str = "output-is-link";
/// What else helps where the program's own files of the user cannot be written: no option sends them elsewhere.
const OR_OWN_STATE: &str = ", or set XDG_STATE_HOME to a folder that may be written";
/// Suffix of the folder that holds a drawing's results.
pub const OUTPUT_SUFFIX: &str = ".enfilade";
/// Name of the state folder of a watched root.
pub const STATE_FOLDER: &str = ".enfilade";
/// Longest file name of the file systems in use, bytes (ext4, NTFS, APFS; hazard 17).
pub const MAX_NAME_BYTES: usize = 255;
/// Length of a side-car's extension, bytes: its drawing's name leaves room for it.
const SIDE_CAR_BYTES: usize = "enfilade.toml".len();
/// Free space wanted before a set is written, as a multiple of its size (hazard 20).
pub const FREE_SPACE_FACTOR: u64 = 2;
/// Free space left alone whatever is written, bytes (hazard 20).
pub const FREE_SPACE_FLOOR: u64 = 16 << 20;

const TEMP_PREFIX: &str = ".tmp-";
const OLD_ANALYSIS: &str = ".old-analysis";
const ANALYSIS: &str = "analysis";
const ANALYSIS_JSON: &str = "analysis.json";
/// Folder of the best of a search that goes on, or was stopped.
pub const SO_FAR: &str = "so-far";
const RESOLUTION: &str = "resolution";
const CLAIM: &str = ".drawing";
/// What a job remembers of itself until it is done.
const MEMORY: &str = ".search";

/// What was written: where, and the SHA-256 of its bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Written {
    /// Path relative to the set's folder.
    pub path: PathBuf,
    /// SHA-256, lower-case hexadecimal.
    pub sha256: String,
}

/// Where a drawing's results go.
#[derive(Clone, Debug, Default)]
pub struct Placing {
    /// Below this folder instead of beside the drawing.
    pub out_dir: Option<PathBuf>,
    /// Below this folder where the wanted place cannot be written.
    pub fallback_dir: Option<PathBuf>,
}

/// The result folder of one drawing, held under a lock against other processes.
pub struct Home {
    folder: PathBuf,
    disk: Arc<dyn Disk>,
    /// Released by the system when dropped, also by a killed process.
    _lock: File,
}

/// Numbers of the rounds in a result folder, rising. Rounds appear whole, so a job that works on the drawing is
/// no hindrance.
pub fn finished_rounds(folder: &Path) -> Vec<u32> {
    let Ok(entries) = fs::read_dir(folder) else { return Vec::new() };
    let mut numbers: Vec<u32> = entries.flatten().filter_map(|e| round_number(&e.file_name())).collect();
    numbers.sort_unstable();
    numbers
}

/// A set of files that lies on disk but is not yet visible; dropped unpublished, it vanishes.
pub struct Staged<'a> {
    home: &'a Home,
    temp: PathBuf,
    written: Vec<Written>,
}

impl Home {
    /// Finds or makes the result folder of `drawing`, locks it and sweeps what a crash left there.
    ///
    /// # Errors
    /// Those of [`find_folder`]; `drawing-busy` when another process works on the same drawing.
    pub fn open(disk: Arc<dyn Disk>, drawing: &Path, placing: &Placing) -> Result<Self, Error> {
        let folder = find_folder(&*disk, drawing, placing)?;
        Self::lock(disk, folder, drawing)
    }

    fn lock(disk: Arc<dyn Disk>, folder: PathBuf, meant: &Path) -> Result<Self, Error> {
        let path = folder.join(".lock");
        let open = open_own(&path, File::options().create(true).truncate(false).write(true));
        let lock = open.map_err(|e| disk_error("locking", &path, &e))?;
        match lock.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                let text = "another enfilade process is working on this drawing; wait for it or stop it";
                return Err(Error::environment("drawing-busy", shown(meant), text));
            }
            // A file system without locks: the lease of the watched root must do.
            Err(TryLockError::Error(e)) if e.kind() == io::ErrorKind::Unsupported => {}
            Err(TryLockError::Error(e)) => return Err(disk_error("locking", &path, &e)),
        }
        let home = Self { folder, disk, _lock: lock };
        home.sweep();
        Ok(home)
    }

    /// The same for a folder of results that belongs to no drawing's place: made, locked and swept.
    ///
    /// # Errors
    /// `drawing-busy` when another process works there; else from the disk.
    pub fn at(disk: Arc<dyn Disk>, folder: &Path) -> Result<Self, Error> {
        refuse_link(folder)?;
        disk.create_folders(folder).map_err(|e| disk_error("making", folder, &e))?;
        Self::lock(disk, folder.into(), folder)
    }

    /// The result folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Removes temporary folders of a run that was killed; an analysis that was being replaced is put
    /// back. What cannot be removed is harmless and stays.
    fn sweep(&self) {
        let old = self.folder.join(OLD_ANALYSIS);
        if old.is_dir() && !self.folder.join(ANALYSIS).exists() {
            let _ = self.disk.rename(&old, &self.folder.join(ANALYSIS));
        }
        let Ok(entries) = fs::read_dir(&self.folder) else { return };
        for entry in entries.flatten() {
            let name = entry.file_name();
            let is_left = name.as_encoded_bytes().starts_with(TEMP_PREFIX.as_bytes()) || name == OLD_ANALYSIS;
            if is_left {
                let is_folder = entry.file_type().is_ok_and(|t| t.is_dir());
                let _ = if is_folder {
                    self.disk.remove_folder(&entry.path())
                } else {
                    self.disk.remove_file(&entry.path())
                };
            }
        }
    }

    /// Writes a set of files where nobody sees it yet, and makes it durable.
    ///
    /// # Errors
    /// `bad-output-name` for a path that leaves the folder or appears twice; `disk-full`,
    /// `no-permission` and the like from the disk, which is left without a trace of the set.
    pub fn stage(&self, files: &[OutFile]) -> Result<Staged<'_>, Error> {
        self.stays()?;
        check_names(files)?;
        self.check_space(files)?;
        let temp = self.folder.join(format!("{TEMP_PREFIX}{}", unique()));
        let staged = Staged { home: self, temp, written: files.iter().map(written_of).collect() };
        staged.fill(files)?;
        Ok(staged)
    }

    fn check_space(&self, files: &[OutFile]) -> Result<(), Error> {
        let size: u64 = files.iter().map(|f| f.bytes.len() as u64).sum();
        let wanted = size * FREE_SPACE_FACTOR + FREE_SPACE_FLOOR;
        match self.disk.free_bytes(&self.folder) {
            Ok(free) if free < wanted => {
                let text = format!(
                    "{} MB are free and {} MB are wanted, {FREE_SPACE_FACTOR} times the {:.1} MB of the results and {} MB in \
                     reserve; free some space or send results elsewhere with --out",
                    free >> 20,
                    wanted.div_ceil(1 << 20),
                    size as f64 / f64::from(1 << 20),
                    FREE_SPACE_FLOOR >> 20
                );
                Err(Error::environment(DISK_FULL, shown(&self.folder), text))
            }
            // Where the system does not say, the write itself will.
            _ => Ok(()),
        }
    }

    /// The number that the next round will bear: one more than the highest name there.
    pub fn next_round(&self) -> u32 {
        self.rounds().last().map_or(1, |n| n.saturating_add(1))
    }

    /// Numbers of the rounds there, rising.
    pub fn rounds(&self) -> Vec<u32> {
        finished_rounds(&self.folder)
    }

    /// Puts `files` into `analysis/`, all or none. What else lies there stays, as what another analysis was asked for; pictures
    /// only where they are of the same drawing. Equal content is left untouched.
    ///
    /// # Errors
    /// As [`Home::stage`].
    pub fn publish_analysis(&self, files: &[OutFile]) -> Result<PathBuf, Error> {
        let kept = kept_beside(&self.folder.join(ANALYSIS), files);
        self.publish_folder(ANALYSIS, &[files, &kept].concat())
    }

    /// Makes `files` the content of `so-far/`, whole or not at all: what a search that goes on has found.
    ///
    /// # Errors
    /// As [`Home::stage`].
    pub fn publish_so_far(&self, files: &[OutFile]) -> Result<PathBuf, Error> {
        self.publish_folder(SO_FAR, files)
    }

    /// Takes `so-far/` away, once a round stands; one that cannot be removed is harmless and stays.
    pub fn drop_so_far(&self) {
        let folder = self.folder.join(SO_FAR);
        let is_folder = fs::symlink_metadata(&folder).is_ok_and(|m| m.is_dir());
        if is_folder {
            let _ = self.disk.remove_folder(&folder);
        }
    }

    /// Replaces the folder of the resolution study, whole or not at all.
    ///
    /// # Errors
    /// As [`Home::stage`].
    pub fn publish_resolution(&self, files: &[OutFile]) -> Result<PathBuf, Error> {
        self.publish_folder(RESOLUTION, files)
    }

    /// Makes `files` the content of the folder `name`, whole or not at all. Equal content is left untouched.
    ///
    /// # Errors
    /// As [`Home::stage`].
    pub fn publish_folder(&self, name: &str, files: &[OutFile]) -> Result<PathBuf, Error> {
        let target = self.folder.join(name);
        refuse_link(&target)?;
        if !holds_exactly(&target, files) {
            self.stage(files)?.replace(&target)?;
        }
        Ok(target)
    }

    /// What an earlier job remembered before it was killed; empty where nothing is.
    pub fn memory(&self) -> Vec<u8> {
        read_own(&self.folder.join(MEMORY)).unwrap_or_default()
    }

    /// Keeps what a job wants to find again should it be killed: in place of the old, or after it.
    ///
    /// # Errors
    /// As [`replace_file`].
    pub fn remember(&self, bytes: &[u8], is_anew: bool) -> Result<(), Error> {
        let path = self.folder.join(MEMORY);
        self.stays()?;
        refuse_planted(&path)?;
        if is_anew {
            return replace_file(&*self.disk, &path, bytes);
        }
        self.disk.append(&path, bytes, false).map_err(writing(&path))
    }

    /// The job is done: its memory goes.
    pub fn forget(&self) {
        let path = self.folder.join(MEMORY);
        if fs::symlink_metadata(&path).is_ok() {
            // What stays belongs to no later job, and says so by its key.
            let _ = self.disk.remove_file(&path);
        }
    }

    /// Replaces `status.json`.
    ///
    /// # Errors
    /// As [`write_json`].
    pub fn write_status(&self, status: &Value) -> Result<(), Error> {
        self.stays()?;
        write_json(&*self.disk, &self.folder.join("status.json"), status)
    }

    /// Refuses a link that took the folder's place while this runs.
    fn stays(&self) -> Result<(), Error> {
        refuse_link(&self.folder)
    }
}

impl Staged<'_> {
    /// What will appear.
    pub fn written(&self) -> &[Written] {
        &self.written
    }

    /// All bytes first, then all to the disk: the first wait takes the others along.
    fn fill(&self, files: &[OutFile]) -> Result<(), Error> {
        let disk = &*self.home.disk;
        disk.create_folder(&self.temp).map_err(writing(&self.temp))?;
        let mut folders = vec![self.temp.clone()];
        for file in files {
            let path = self.temp.join(&file.path);
            for folder in path.ancestors().skip(1).take_while(|f| f.starts_with(&self.temp)) {
                if !folders.iter().any(|f| f == folder) {
                    folders.push(folder.into());
                }
            }
            if let Some(parent) = path.parent() {
                disk.create_folders(parent).map_err(writing(parent))?;
            }
            disk.write_new(&path, &file.bytes).map_err(writing(&path))?;
        }
        for file in files {
            let path = self.temp.join(&file.path);
            disk.sync(&path).map_err(writing(&path))?;
        }
        folders.iter().try_for_each(|f| disk.sync(f).map_err(writing(f)))
    }

    /// Makes the set visible as `round-NN`.
    ///
    /// # Errors
    /// From the disk; also when somebody made a folder of that name meanwhile.
    pub fn publish_round(self, number: u32) -> Result<PathBuf, Error> {
        let disk = &*self.home.disk;
        let target = self.home.folder.join(round_name(number));
        disk.rename_new(&self.temp, &target).map_err(|e| disk_error("publishing", &target, &e))?;
        // The round is visible; a failing sync only means that a power cut might still undo it.
        let _ = disk.sync(&self.home.folder);
        Ok(target)
    }

    /// Puts the set in the place of the folder `target`. Where the system cannot exchange two folders
    /// at once, the old one is moved aside first; [`Home::sweep`] puts it back after a crash.
    fn replace(self, target: &Path) -> Result<(), Error> {
        let disk = &*self.home.disk;
        let fail = |e: io::Error| disk_error("publishing", target, &e);
        if fs::symlink_metadata(target).is_err() {
            disk.rename_new(&self.temp, target).map_err(fail)?;
        } else if let Err(error) = disk.exchange(&self.temp, target) {
            if error.kind() != io::ErrorKind::Unsupported {
                return Err(fail(error));
            }
            let old = self.home.folder.join(OLD_ANALYSIS);
            disk.rename(target, &old).map_err(fail)?;
            if let Err(error) = disk.rename_new(&self.temp, target) {
                let _ = disk.rename(&old, target);
                return Err(fail(error));
            }
            let _ = disk.remove_folder(&old);
        }
        let _ = disk.sync(&self.home.folder);
        Ok(())
    }
}

impl Drop for Staged<'_> {
    /// Removes the temporary folder: the unpublished set, or the old content after an exchange.
    fn drop(&mut self) {
        if self.temp.exists() {
            let _ = self.home.disk.remove_folder(&self.temp);
        }
    }
}

/// Name of a round's folder: `round-01`.
pub fn round_name(number: u32) -> String {
    format!("round-{number:02}")
}

fn round_number(name: &OsStr) -> Option<u32> {
    name.to_str()?.strip_prefix("round-")?.parse().ok()
}

/// The result folder of `drawing`, made if need be: `plan.enfilade`, or a longer name where that one
/// belongs to another drawing (`plan.ifc` beside `plan.dxf`), or a short one where names get too long.
///
/// # Errors
/// `output-is-link` where somebody planted a link; else from the disk (`no-permission`, `disk-full`, …).
pub fn find_folder(disk: &dyn Disk, drawing: &Path, placing: &Placing) -> Result<PathBuf, Error> {
    let beside = drawing.parent().unwrap_or(Path::new("."));
    let wanted = placing.out_dir.as_deref().unwrap_or(beside);
    match claim_folder(disk, drawing, wanted) {
        Err(Error::Environment(p)) if p.code == "no-permission" => match &placing.fallback_dir {
            Some(fallback) => claim_folder(disk, drawing, fallback),
            None => Err(Error::Environment(p)),
        },
        other => other,
    }
}

/// The result folder of `drawing` where there is one; nothing is made.
pub fn present_folder(drawing: &Path, placing: &Placing) -> Option<PathBuf> {
    let beside = drawing.parent().unwrap_or(Path::new("."));
    let bases = [Some(placing.out_dir.as_deref().unwrap_or(beside)), placing.fallback_dir.as_deref()];
    let name = drawing.file_name().unwrap_or(OsStr::new("drawing"));
    let is_ours = |base: &Path, folder: &Path| {
        let claim = if drawing.parent() == Some(base) { name } else { drawing.as_os_str() };
        refuse_link(folder).is_ok()
            && read_own(&folder.join(CLAIM)).is_ok_and(|c| c == claim.as_encoded_bytes())
    };
    let folders = bases
        .into_iter()
        .flatten()
        .flat_map(|base| folder_names(drawing).into_iter().map(move |n| (base, base.join(n))));
    folders.into_iter().find(|(base, folder)| is_ours(base, folder)).map(|(_, folder)| folder)
}

fn claim_folder(disk: &dyn Disk, drawing: &Path, base: &Path) -> Result<PathBuf, Error> {
    let is_beside = drawing.parent() == Some(base);
    let name = drawing.file_name().unwrap_or(OsStr::new("drawing"));
    let claim = if is_beside { name } else { drawing.as_os_str() };
    let mut last = base.to_path_buf();
    for name in folder_names(drawing) {
        let folder = base.join(name);
        refuse_link(&folder)?;
        make_folder(disk, &folder, is_beside).map_err(|e| disk_error("making", &folder, &e))?;
        if is_claimed_by(disk, &folder, claim.as_encoded_bytes(), base)? {
            return Ok(folder);
        }
        last = folder;
    }
    let text = "is in use for other drawings, and so are its other names; rename the drawing";
    Err(Error::environment("no-result-folder", shown(&last), text))
}

/// Beside a drawing only one level is made: a root that went away is not brought back by us.
fn make_folder(disk: &dyn Disk, folder: &Path, is_beside: bool) -> io::Result<()> {
    if !is_beside {
        return disk.create_folders(folder);
    }
    match disk.create_folder(folder) {
        Err(e) if e.kind() == io::ErrorKind::AlreadyExists && folder.is_dir() => Ok(()),
        other => other,
    }
}

/// Names a result folder may bear, the plainest first.
fn folder_names(drawing: &Path) -> Vec<OsString> {
    let (stem, name) = (drawing.file_stem().unwrap_or_default(), drawing.file_name().unwrap_or_default());
    let digest = sha256_hex(drawing.as_os_str().as_encoded_bytes());
    let with = |base: &OsStr, suffix: &str| {
        let mut out = base.to_os_string();
        out.push(suffix);
        out
    };
    let short: String = stem.to_string_lossy().chars().take(40).collect();
    let mut names = vec![with(stem, OUTPUT_SUFFIX), with(name, OUTPUT_SUFFIX)];
    names.retain(|n| n.len() <= MAX_NAME_BYTES);
    names.push(OsString::from(format!("{short}-{}{OUTPUT_SUFFIX}", &digest[..12])));
    names
}

/// Whether the folder belongs to the drawing of this claim; an unclaimed one, or one whose drawing is
/// gone, is taken over.
fn is_claimed_by(disk: &dyn Disk, folder: &Path, claim: &[u8], base: &Path) -> Result<bool, Error> {
    let path = folder.join(CLAIM);
    refuse_planted(&path)?;
    let present = read_own(&path).unwrap_or_default();
    if present == claim {
        return Ok(true);
    }
    let other = path_from_bytes(&present);
    let is_other_alive = !present.is_empty() && fs::symlink_metadata(base.join(other)).is_ok();
    if !is_other_alive {
        replace_file(disk, &path, claim)?;
    }
    Ok(!is_other_alive)
}

#[cfg(unix)]
fn path_from_bytes(bytes: &[u8]) -> PathBuf {
    use std::os::unix::ffi::OsStrExt;
    OsStr::from_bytes(bytes).into()
}

#[cfg(not(unix))]
fn path_from_bytes(bytes: &[u8]) -> PathBuf {
    String::from_utf8_lossy(bytes).into_owned().into()
}

/// Replaces a file of ours by one write and one rename. Equal content is left untouched, so that sync
/// clients have nothing to do (hazard 14). A device or a pipe is written into: renaming over `/dev/null` would
/// take it from everybody.
///
/// # Errors
/// `output-is-link` where somebody planted a link; else from the disk.
pub fn replace_file(disk: &dyn Disk, path: &Path, bytes: &[u8]) -> Result<(), Error> {
    refuse_link(path)?;
    if fs::symlink_metadata(path).is_ok_and(|found| !found.is_file() && !found.is_dir()) {
        return write_into(path, bytes).map_err(|e| disk_error("writing", path, &e));
    }
    if has_bytes(path, bytes) {
        return Ok(());
    }
    let temp = path.with_file_name(format!("{TEMP_PREFIX}{}", unique()));
    let outcome = disk.write_new(&temp, bytes).and_then(|()| disk.rename(&temp, path));
    outcome.map_err(|e| {
        let _ = disk.remove_file(&temp);
        disk_error("writing", path, &e)
    })
}

/// Replaces a file that only this user may read (a token); elsewhere than on Unix, as [`replace_file`].
///
/// # Errors
/// As [`replace_file`].
pub fn write_secret(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    refuse_link(path)?;
    let folder = path.parent().unwrap_or(Path::new("."));
    fs::create_dir_all(folder).map_err(|e| disk_error_here("making", folder, &e, OR_OWN_STATE))?;
    let temp = path.with_file_name(format!("{TEMP_PREFIX}{}", unique()));
    let mut options = File::options();
    options.write(true).create_new(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
    let outcome =
        options.open(&temp).and_then(|mut f| f.write_all(bytes)).and_then(|()| fs::rename(&temp, path));
    outcome.map_err(|e| {
        let _ = fs::remove_file(&temp);
        disk_error_here("writing", path, &e, OR_OWN_STATE)
    })
}

/// Replaces a JSON file of ours, indented, with a line end.
///
/// # Errors
/// As [`replace_file`]; `output-is-special` where somebody planted a pipe.
pub fn write_json(disk: &dyn Disk, path: &Path, value: &Value) -> Result<(), Error> {
    refuse_planted(path)?;
    replace_file(disk, path, format!("{value:#}\n").as_bytes())
}

/// Writes a new file, whole and durable; whatever is there already stays.
///
/// # Errors
/// `file-exists` when the name is taken; else from the disk.
pub fn write_new(disk: &dyn Disk, path: &Path, bytes: &[u8]) -> Result<(), Error> {
    let temp = path.with_file_name(format!("{TEMP_PREFIX}{}", unique()));
    let outcome = disk.write_new(&temp, bytes).and_then(|()| disk.sync(&temp));
    let outcome = outcome.and_then(|()| disk.rename_new(&temp, path));
    if let Some(parent) = path.parent() {
        let _ = disk.sync(parent);
    }
    outcome.map_err(|e| {
        let _ = disk.remove_file(&temp);
        disk_error_here("writing", path, &e, "")
    })
}

/// A drawing beside the one that it follows.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Revision {
    /// Where it lies.
    pub path: PathBuf,
    /// Whether it was not there before.
    pub is_new: bool,
}

/// Writes an accepted candidate beside its drawing: `plan-r02.dxf`, `-r03`, … whichever is free, or has these
/// bytes already: what was accepted before is not written twice. A name is free when nothing of that name lies
/// there, whatever its extension: `plan-r02.ifc` and a side-car `plan-r02.enfilade.toml` are somebody else's. A name
/// so long that drawing or side-car would have none that the system takes is cut.
///
/// # Errors
/// As [`write_new`].
pub fn write_revision(disk: &dyn Disk, drawing: &Path, bytes: &[u8]) -> Result<Revision, Error> {
    let (base, first) = revision_of(drawing);
    // What is written of an archive is the file in it.
    let is_archive = drawing.extension().is_some_and(|e| e.eq_ignore_ascii_case("ifczip"));
    let extension = if is_archive { OsStr::new("ifc") } else { drawing.extension().unwrap_or_default() };
    for number in first.. {
        let suffix = format!("-r{number:02}.");
        let ending = suffix.len() + extension.len().max(SIDE_CAR_BYTES);
        let mut name = cut(&base, MAX_NAME_BYTES.saturating_sub(ending));
        name.push(suffix);
        let stem = name.clone();
        name.push(extension);
        let path = drawing.with_file_name(name);
        // The bytes are looked at last each time: somebody may accept the same at this moment.
        let is_there = |path: &Path| has_bytes(path, bytes);
        let is_taken = is_taken(&path, &stem);
        if is_there(&path) {
            return Ok(Revision { path, is_new: false });
        }
        if is_taken {
            continue;
        }
        match write_new(disk, &path, bytes) {
            Ok(()) => return Ok(Revision { path, is_new: true }),
            Err(error) if error.problem().is_some_and(|p| p.code == "file-exists") => {
                if is_there(&path) {
                    return Ok(Revision { path, is_new: false });
                }
            }
            Err(error) => return Err(error),
        }
    }
    Err(Error::environment("no-free-name", shown(drawing), "has too many revisions"))
}

/// The beginning of a name, in at most so many bytes.
fn cut(name: &OsStr, bytes: usize) -> OsString {
    if name.len() <= bytes {
        return name.into();
    }
    let name = name.to_string_lossy();
    name[..name.floor_char_boundary(bytes)].into()
}

/// Whether a file begins with these letters (`plan-r02.`, in any case) where a new one would lie.
fn is_taken(path: &Path, stem: &OsStr) -> bool {
    let stem = stem.to_string_lossy().to_lowercase();
    let entries = path.parent().and_then(|folder| fs::read_dir(folder).ok());
    let mut names = entries.into_iter().flatten().flatten().map(|e| e.file_name());
    names.any(|n| n.to_string_lossy().to_lowercase().starts_with(&stem))
}

/// The name without its revision, and the number of the next: `plan` 2, `plan-r02` → `plan` 3.
fn revision_of(drawing: &Path) -> (OsString, u32) {
    let stem = drawing.file_stem().unwrap_or_default();
    let split = stem.to_str().and_then(|s| s.rsplit_once("-r"));
    let number = |n: &str| (n.len() >= 2).then(|| n.parse::<u32>().ok()).flatten();
    match split.and_then(|(base, n)| Some((base, number(n)?))) {
        Some((base, n)) if !base.is_empty() => (base.into(), n.saturating_add(1)),
        _ => (stem.into(), 2),
    }
}

/// The state folder of a watched root: `.enfilade` in it, or a folder of its own below `placing`'s
/// folders where the root cannot be written.
///
/// # Errors
/// From the disk, with what to do.
pub fn state_folder(disk: &dyn Disk, root: &Path, placing: &Placing) -> Result<PathBuf, Error> {
    let own = root.join(STATE_FOLDER);
    refuse_link(&own)?;
    let error = match disk.create_folders(&own).and_then(|()| probe(disk, &own)) {
        Ok(()) => return Ok(own),
        Err(e) => disk_error("making", &own, &e),
    };
    let digest = sha256_hex(root.as_os_str().as_encoded_bytes());
    let elsewhere = placing.out_dir.as_ref().or(placing.fallback_dir.as_ref());
    let Some(other) = elsewhere.map(|d| d.join(format!("{STATE_FOLDER}-{}", &digest[..12]))) else {
        return Err(error);
    };
    refuse_link(&other)?;
    disk.create_folders(&other).map_err(|e| disk_error("making", &other, &e))?;
    Ok(other)
}

/// Whether the folder can be written.
fn probe(disk: &dyn Disk, folder: &Path) -> io::Result<()> {
    let path = folder.join(format!("{TEMP_PREFIX}{}", unique()));
    disk.write_new(&path, b"")?;
    disk.remove_file(&path)
}

fn check_names(files: &[OutFile]) -> Result<(), Error> {
    let mut folded: Vec<String> = Vec::with_capacity(files.len());
    for file in files {
        let parts: Vec<Component<'_>> = file.path.components().collect();
        let is_plain = !parts.is_empty() && parts.iter().all(|c| matches!(c, Component::Normal(_)));
        let name = file.path.to_string_lossy().to_lowercase();
        if !is_plain || folded.contains(&name) {
            let text = "is no name for an output: plain names below the folder, each once, are";
            return Err(Error::environment("bad-output-name", shown(&file.path), text));
        }
        folded.push(name);
    }
    Ok(())
}

fn written_of(file: &OutFile) -> Written {
    Written { path: file.path.clone(), sha256: sha256_hex(&file.bytes) }
}

fn sha256_hex(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|b| format!("{b:02x}")).collect()
}

/// A name that no other writer uses at the same time.
fn unique() -> String {
    static NEXT: AtomicU64 = AtomicU64::new(0);
    format!("{}-{}", std::process::id(), NEXT.fetch_add(1, Ordering::Relaxed))
}

fn shown(path: &Path) -> Place {
    Place::file(path.display().to_string())
}

fn writing(path: &Path) -> impl FnOnce(io::Error) -> Error + '_ {
    move |e| disk_error("writing", path, &e)
}

/// An error of the disk in the user's words, with the remedy.
pub fn disk_error(doing: &str, path: &Path, error: &io::Error) -> Error {
    disk_error_here(doing, path, error, " or send results elsewhere with --out")
}

/// The same of a file that can lie nowhere else, or elsewhere by what `or_elsewhere` says.
fn disk_error_here(doing: &str, path: &Path, error: &io::Error, or_elsewhere: &str) -> Error {
    if let Some(planted) = planted_of(error) {
        return Error::environment(planted.code(), shown(path), planted.to_string());
    }
    use io::ErrorKind as K;
    let (code, remedy, or_elsewhere) = match error.kind() {
        K::StorageFull | K::QuotaExceeded | K::FileTooLarge => (DISK_FULL, "free some space", or_elsewhere),
        K::PermissionDenied | K::ReadOnlyFilesystem => ("no-permission", "allow writing there", or_elsewhere),
        K::AlreadyExists => ("file-exists", "the name is taken; what is there stays as it is", ""),
        K::InvalidFilename => ("name-too-long", "shorten the drawing's name", ""),
        K::NotFound | K::NotADirectory | K::StaleNetworkFileHandle => {
            ("folder-vanished", "the folder is not there: make it", or_elsewhere)
        }
        _ => ("disk-error", "look at the disk", or_elsewhere),
    };
    let text = format!("{doing} failed: {error}; {remedy}{or_elsewhere}");
    Error::environment(code, shown(path), text)
}

#[cfg(test)]
mod tests;

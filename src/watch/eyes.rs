//! Looking at the real folder: the notify back end, scans, stats and reads.
//!
//! On Linux every folder gets its own watch, so that our result folders and those left alone cost
//! none; elsewhere the root is watched with all below it. Every doubt (overflow, a watcher's error, a
//! folder that came or went) ends in a full scan, which the settle machine asks for.

use std::collections::BTreeMap;
use std::fs::{self, File, Metadata};
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::UNIX_EPOCH;

use notify::event::{AccessKind, AccessMode, EventKind};
use notify::{Config, ErrorKind, RecommendedWatcher, RecursiveMode, Watcher};
use sha2::{Digest, Sha256};

use super::{
    Checked, Completeness, ContentKey, EndMark, Event, Identity, Kind, MAX_DRAWING_BYTES, MAX_SCANNED_FILES,
    Names, Seen, Stat, Verdict, WatchSettings,
};
use enfilade_report::Error;

/// Whether each folder is watched by itself.
const WATCHES_SINGLE_FOLDERS: bool = cfg!(target_os = "linux");
/// A scan that arms new folders is repeated, so that nothing written in between is missed (hazard 9);
/// somebody who makes folders faster than this many rounds is left to the next scan.
const MAX_ARMING_ROUNDS: usize = 8;

type Armed = Arc<Mutex<BTreeMap<PathBuf, Identity>>>;

/// The watches on all roots.
pub struct Eyes {
    roots: Vec<Seeing>,
    watcher: Option<RecommendedWatcher>,
    armed: Armed,
    report: Box<dyn Fn(Event) + Send>,
}

struct Seeing {
    path: PathBuf,
    names: Names,
    is_polled: bool,
    is_cut_told: bool,
}

impl Eyes {
    /// Prepares the watches of canonical `roots`; nothing is armed before the first scan. Reports of
    /// the system go to `report`, from a thread of their own.
    ///
    /// # Errors
    /// `bad-glob` from the user's ignore list.
    pub fn new(
        roots: &[PathBuf],
        is_network: &[bool],
        settings: &WatchSettings,
        report: impl Fn(Event) + Send + Clone + 'static,
    ) -> Result<Self, Error> {
        let armed = Armed::default();
        let see = |(i, path): (usize, &PathBuf)| {
            let names = Names::new(path, settings.depth, &settings.extensions, &settings.ignore, roots)?;
            let is_polled = settings.poll || is_network.get(i).copied().unwrap_or(false);
            Ok(Seeing { path: path.clone(), names, is_polled, is_cut_told: false })
        };
        let roots = roots.iter().enumerate().map(see).collect::<Result<Vec<Seeing>, Error>>()?;
        let watcher = if roots.iter().all(|r| r.is_polled) {
            None
        } else {
            start_watcher(&roots, armed.clone(), report.clone())
        };
        Ok(Self { roots, watcher, armed, report: Box::new(report) })
    }

    /// Forgets the watches of a root whose folder was made anew; the next scan arms it again.
    pub fn rearm(&mut self, root: &Path) {
        self.disarm(|path, _| path.starts_with(root));
    }

    /// Ends the watches of the armed folders that are `stale`.
    fn disarm(&mut self, stale: impl Fn(&Path, &Identity) -> bool) {
        // The lock is let go of first: the system's thread may want it for an event, and answers an unwatch only after that.
        let mut gone = Vec::new();
        self.armed.lock().unwrap_or_else(PoisonError::into_inner).retain(|path, identity| {
            let is_stale = stale(path, identity);
            gone.extend(is_stale.then(|| path.clone()));
            !is_stale
        });
        for path in gone {
            if let Some(watcher) = &mut self.watcher {
                // The folder may be gone and its watch with it: there is nothing to do about that.
                let _ = watcher.unwatch(&path);
            }
        }
    }

    /// Arms the folders of `root` and lists the files in them; `None`: the root cannot be listed.
    pub fn scan(&mut self, root: &Path) -> Option<Vec<(PathBuf, Stat)>> {
        let index = self.roots.iter().position(|r| r.path == root)?;
        for _ in 0..MAX_ARMING_ROUNDS {
            let listing = list(&self.roots[index].path, &self.roots[index].names, MAX_SCANNED_FILES)?;
            if !self.arm(index, &listing.folders) {
                return Some(self.told_if_cut(index, listing));
            }
        }
        let listing = list(&self.roots[index].path, &self.roots[index].names, MAX_SCANNED_FILES)?;
        Some(self.told_if_cut(index, listing))
    }

    /// Says once that a root holds more files than are looked at.
    fn told_if_cut(&mut self, index: usize, listing: Listing) -> Vec<(PathBuf, Stat)> {
        let root = &mut self.roots[index];
        if listing.is_cut && !std::mem::replace(&mut root.is_cut_told, true) {
            (self.report)(Event::Crowded(root.path.clone()));
        }
        listing.files
    }

    /// Brings the watches in line with the folders that are there; whether a new one was armed.
    fn arm(&mut self, index: usize, folders: &BTreeMap<PathBuf, Identity>) -> bool {
        if self.watcher.is_none() || self.roots[index].is_polled {
            return false;
        }
        let path = self.roots[index].path.clone();
        self.disarm(|p, id| p.starts_with(&path) && folders.get(p) != Some(id));
        let root = &mut self.roots[index];
        let Some(watcher) = self.watcher.as_mut() else { return false };
        let locked = || self.armed.lock().unwrap_or_else(PoisonError::into_inner);
        let mode =
            if WATCHES_SINGLE_FOLDERS { RecursiveMode::NonRecursive } else { RecursiveMode::Recursive };
        let mut is_new = false;
        for (path, identity) in folders.iter().filter(|(p, _)| WATCHES_SINGLE_FOLDERS || **p == root.path) {
            // Noted before it is watched: a late word that its forerunner went takes the watch away and strikes the
            // note, so that the next scan arms it again.
            if locked().insert(path.clone(), *identity).is_some() {
                continue;
            }
            match watcher.watch(path, mode) {
                Ok(()) => is_new = true,
                Err(error) => {
                    locked().remove(path);
                    if !is_vanished(&error) {
                        root.is_polled = true;
                        (self.report)(Event::Blind(root.path.clone(), refusal(&error)));
                        return is_new;
                    }
                }
            }
        }
        is_new
    }
}

fn start_watcher(
    roots: &[Seeing],
    armed: Armed,
    report: impl Fn(Event) + Send + Clone + 'static,
) -> Option<RecommendedWatcher> {
    let tell = report.clone();
    let handler = move |event: notify::Result<notify::Event>| match event {
        Ok(event) => events_of(event, &armed).into_iter().for_each(&report),
        Err(error) => report(Event::Lost(error.to_string())),
    };
    match RecommendedWatcher::new(handler, Config::default().with_follow_symlinks(false)) {
        Ok(watcher) => Some(watcher),
        Err(error) => {
            roots.iter().for_each(|r| tell(Event::Blind(r.path.clone(), refusal(&error))));
            None
        }
    }
}

/// Our own words for one event of the system. Reading is no event; a watched folder that went is
/// disarmed at once, because its successor may bear the same inode number.
fn events_of(event: notify::Event, armed: &Armed) -> Vec<Event> {
    if event.need_rescan() {
        return vec![Event::Lost("more events than the system can hold".into())];
    }
    match event.kind {
        EventKind::Access(AccessKind::Close(AccessMode::Write)) => {}
        EventKind::Access(_) => return Vec::new(),
        EventKind::Remove(_) | EventKind::Modify(notify::event::ModifyKind::Name(_)) => {
            let mut armed = armed.lock().unwrap_or_else(PoisonError::into_inner);
            event.paths.iter().for_each(|path| {
                armed.remove(path);
            });
        }
        _ => {}
    }
    event.paths.into_iter().map(Event::Touched).collect()
}

fn is_vanished(error: &notify::Error) -> bool {
    match &error.kind {
        ErrorKind::PathNotFound | ErrorKind::WatchNotFound => true,
        ErrorKind::Io(e) => e.kind() == io::ErrorKind::NotFound,
        _ => false,
    }
}

/// What a refused watch means, with the remedy: the system's own words mislead ("no space left on
/// device" for a full watch table).
fn refusal(error: &notify::Error) -> String {
    const EMFILE: i32 = 24;
    const ENOSPC: i32 = 28;
    match &error.kind {
        ErrorKind::MaxFilesWatch => limit_text("fs.inotify.max_user_watches"),
        ErrorKind::Io(e) if e.raw_os_error() == Some(ENOSPC) => limit_text("fs.inotify.max_user_watches"),
        ErrorKind::Io(e) if e.raw_os_error() == Some(EMFILE) => limit_text("fs.inotify.max_user_instances"),
        _ => format!("the system refuses to watch it: {error}"),
    }
}

fn limit_text(setting: &str) -> String {
    format!("the system's limit on watched folders is reached; raise it with `sysctl {setting}`")
}

/// What a scan found.
struct Listing {
    /// The folders that are looked into.
    folders: BTreeMap<PathBuf, Identity>,
    /// The files in them, by name; and what bears a drawing's name and is none.
    files: Vec<(PathBuf, Stat)>,
    /// Whether there are more files than the limit.
    is_cut: bool,
}

fn list(root: &Path, names: &Names, limit: usize) -> Option<Listing> {
    let mut out = Listing { folders: BTreeMap::new(), files: Vec::new(), is_cut: false };
    let mut todo = vec![root.to_path_buf()];
    while let Some(folder) = todo.pop() {
        let (Some(identity), Ok(entries)) = (identity_of(&folder), fs::read_dir(&folder)) else {
            if folder == root {
                return None;
            }
            continue;
        };
        out.folders.insert(folder, identity);
        for entry in entries.flatten() {
            let path = entry.path();
            let Ok(kind) = entry.file_type() else { continue };
            let is_folder = kind.is_dir();
            if is_folder && names.folder_reason(&path).is_none() {
                todo.push(path.clone());
            }
            if is_folder && names.verdict(&path) != Verdict::Take {
                // A folder counts only where it bears a drawing's name.
            } else if !kind.is_file() && names.verdict(&path) != Verdict::Take {
                // Links, pipes and devices count only where they bear a drawing's name.
            } else if out.files.len() >= limit {
                out.is_cut = true;
            } else if let Seen::There(stat) = stat_of(&path) {
                out.files.push((path, stat));
            }
        }
    }
    out.files.sort_by(|a, b| a.0.cmp(&b.0));
    Some(out)
}

/// What the system says about a path, links not followed.
pub fn stat_of(path: &Path) -> Seen {
    match fs::symlink_metadata(path) {
        Ok(meta) => Seen::There(stat_from(&meta)),
        Err(e) if matches!(e.kind(), io::ErrorKind::NotFound | io::ErrorKind::NotADirectory) => Seen::Gone,
        Err(e) => Seen::Unreadable(e.to_string()),
    }
}

fn stat_from(meta: &Metadata) -> Stat {
    let kind = if meta.is_dir() {
        Kind::Folder
    } else if meta.is_symlink() {
        Kind::Link
    } else if !meta.is_file() {
        Kind::Other
    } else if is_placeholder(meta) {
        Kind::Placeholder
    } else {
        Kind::File
    };
    let mtime_ns = meta.modified().map(nanos_since_epoch).unwrap_or_default();
    let (ctime_ns, inode) = change_and_inode(meta);
    Stat { size: meta.len(), mtime_ns, ctime_ns, inode, kind }
}

fn nanos_since_epoch(time: std::time::SystemTime) -> i128 {
    match time.duration_since(UNIX_EPOCH) {
        Ok(after) => after.as_nanos() as i128,
        Err(before) => -(before.duration().as_nanos() as i128),
    }
}

#[cfg(unix)]
fn change_and_inode(meta: &Metadata) -> (i128, u64) {
    use std::os::unix::fs::MetadataExt;
    (i128::from(meta.ctime()) * 1_000_000_000 + i128::from(meta.ctime_nsec()), meta.ino())
}

#[cfg(not(unix))]
fn change_and_inode(_: &Metadata) -> (i128, u64) {
    (0, 0)
}

#[cfg(windows)]
fn is_placeholder(meta: &Metadata) -> bool {
    use std::os::windows::fs::MetadataExt;
    const FILE_ATTRIBUTE_OFFLINE: u32 = 0x1000;
    const FILE_ATTRIBUTE_RECALL_ON_DATA_ACCESS: u32 = 0x40_0000;
    meta.file_attributes() & (FILE_ATTRIBUTE_OFFLINE | FILE_ATTRIBUTE_RECALL_ON_DATA_ACCESS) != 0
}

#[cfg(target_os = "macos")]
fn is_placeholder(meta: &Metadata) -> bool {
    use std::os::macos::fs::MetadataExt;
    const SF_DATALESS: u32 = 0x4000_0000;
    meta.st_flags() & SF_DATALESS != 0
}

/// Linux has no mark for such files.
#[cfg(not(any(windows, target_os = "macos")))]
fn is_placeholder(_: &Metadata) -> bool {
    false
}

/// Which folder lies at `path`, links followed; `None`: there is none.
pub fn identity_of(path: &Path) -> Option<Identity> {
    let meta = fs::metadata(path).ok().filter(Metadata::is_dir)?;
    let born_ns = meta.created().map(nanos_since_epoch).unwrap_or_default();
    Some(Identity { device: device_of(&meta), inode: change_and_inode(&meta).1, born_ns })
}

#[cfg(unix)]
fn device_of(meta: &Metadata) -> u64 {
    std::os::unix::fs::MetadataExt::dev(meta)
}

#[cfg(not(unix))]
fn device_of(_: &Metadata) -> u64 {
    0
}

/// Whether a call failed as this program, or the whole system, may open no more files.
pub fn is_out_of_files(error: &io::Error) -> bool {
    const ENFILE: i32 = 23;
    const EMFILE: i32 = 24;
    const ERROR_TOO_MANY_OPEN_FILES: i32 = 4;
    let codes = if cfg!(windows) { [ERROR_TOO_MANY_OPEN_FILES; 2] } else { [ENFILE, EMFILE] };
    error.raw_os_error().is_some_and(|code| codes.contains(&code))
}

/// Reads a file through one handle and makes sure that nobody wrote meanwhile (hazard 25). A link is
/// followed: whoever names a file means what it leads to; watched folders do not offer links.
///
/// # Errors
/// The outcome of the look when there is no coherent content.
pub fn read_whole(path: &Path) -> Result<(Vec<u8>, Stat), Checked> {
    let refuse = |e: io::Error| match e.kind() {
        io::ErrorKind::NotFound => Checked::Gone,
        _ if is_held_by_writer(&e) => Checked::Changed,
        _ => Checked::Unreadable(e.to_string()),
    };
    let followed = fs::metadata(path).map_err(refuse)?;
    if !followed.is_file() {
        return Err(Checked::Unreadable("it is no file".into()));
    }
    if followed.len() > MAX_DRAWING_BYTES {
        let text = format!(
            "it has {} MB, expected at most {} MB (MAX_DRAWING_BYTES)",
            followed.len() >> 20,
            MAX_DRAWING_BYTES >> 20
        );
        return Err(Checked::Unreadable(text));
    }
    let mut file = open_at_once(path).map_err(refuse)?;
    let before = stat_from(&file.metadata().map_err(refuse)?);
    let mut bytes = Vec::with_capacity(before.size as usize);
    // A file that grows meanwhile is read again later, never without end.
    file.by_ref().take(before.size + 1).read_to_end(&mut bytes).map_err(refuse)?;
    let after = stat_from(&file.metadata().map_err(refuse)?);
    let named = stat_from(&fs::metadata(path).map_err(refuse)?);
    let is_same = before == after && bytes.len() as u64 == after.size && named == after;
    if is_same { Ok((bytes, after)) } else { Err(Checked::Changed) }
}

/// Bytes of a file beside a drawing; none of what is no file: a pipe would be waited for.
pub fn bytes_of(path: &Path) -> Option<Vec<u8>> {
    read_whole(path).ok().map(|(bytes, _)| bytes)
}

/// Opens for reading without waiting, should a pipe have taken the file's place.
#[cfg(unix)]
fn open_at_once(path: &Path) -> io::Result<File> {
    use std::os::unix::fs::OpenOptionsExt;
    let flags = rustix::fs::OFlags::NONBLOCK.bits() as i32;
    File::options().read(true).custom_flags(flags).open(path)
}

#[cfg(not(unix))]
fn open_at_once(path: &Path) -> io::Result<File> {
    File::open(path)
}

/// Windows lets a program keep others out while it writes: no matter of permission, only of time.
fn is_held_by_writer(error: &io::Error) -> bool {
    const ERROR_SHARING_VIOLATION: i32 = 32;
    const ERROR_LOCK_VIOLATION: i32 = 33;
    cfg!(windows) && matches!(error.raw_os_error(), Some(ERROR_SHARING_VIOLATION | ERROR_LOCK_VIOLATION))
}

/// Reads a quiet file and judges its completeness; with what its content is known by, empty where there is none. A panic
/// of the judge counts as incomplete.
pub fn read_settled(path: &Path, end_mark: EndMark, content_key: ContentKey) -> (Checked, String) {
    match read_whole(path) {
        Err(checked) => (checked, String::new()),
        Ok((bytes, stat)) => {
            let judge = std::panic::AssertUnwindSafe(|| end_mark(path, &bytes));
            let completeness = std::panic::catch_unwind(judge)
                .unwrap_or_else(|_| Completeness::Incomplete("its end could not be judged".into()));
            let key = content_key(path, &bytes);
            (Checked::Read { stat, sha256: sha256_hex(&bytes), completeness }, key)
        }
    }
}

/// SHA-256 of some bytes, lower-case hexadecimal.
pub fn sha256_hex(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|b| format!("{b:02x}")).collect()
}

/// Why events below `path` cannot be trusted: the kind of its drive; `None` on local drives (hazard 10).
#[cfg(target_os = "linux")]
pub fn network_reason(path: &Path) -> Option<String> {
    let magic = rustix::fs::statfs(path).ok()?.f_type as u64 & 0xFFFF_FFFF;
    network_name(magic).map(|name| format!("it lies on a {name} drive, which reports no changes of others"))
}

/// Names of the file systems whose changes may come from elsewhere, by their magic number.
#[cfg(target_os = "linux")]
fn network_name(magic: u64) -> Option<&'static str> {
    const NETWORK: &[(u64, &str)] = &[
        (0x6969, "NFS"),
        (0x517B, "SMB"),
        (0xFF53_4D42, "CIFS"),
        (0xFE53_4D42, "SMB"),
        (0x0102_1997, "9P"),
        (0x6573_5546, "FUSE"),
        (0x5346_414F, "AFS"),
        (0x00C3_6400, "Ceph"),
        (0x7375_7245, "Coda"),
        (0x564C, "NCP"),
        (0x0BD0_0BD0, "Lustre"),
        (0x786F_4256, "VirtualBox shared"),
        (0xBACB_ACBC, "VMware shared"),
    ];
    NETWORK.iter().find(|(m, _)| *m == magic).map(|(_, name)| *name)
}

/// Why events below `path` cannot be trusted: it is a share; `None` otherwise.
#[cfg(not(target_os = "linux"))]
pub fn network_reason(path: &Path) -> Option<String> {
    use std::path::{Component, Prefix};
    let is_share = matches!(path.components().next(), Some(Component::Prefix(p))
        if matches!(p.kind(), Prefix::UNC(..) | Prefix::VerbatimUNC(..)));
    is_share.then(|| "it lies on a network share, which may report no changes of others".into())
}

#[cfg(test)]
#[path = "eyes_tests.rs"]
mod tests;

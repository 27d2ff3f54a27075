//! The watched folder: which files are drawings, when a save is finished, what the system tells.
//!
//! [`Settle`] decides, as a pure state machine over events, looks at files and the clock;
//! [`Names`] says which names are taken up and why others are not; [`Eyes`] looks at the real
//! folder and is the only place that knows `notify`. Sources: `hazards.md` section 1.

mod eyes;
mod names;
mod settle;

use std::path::{Path, PathBuf};

pub use eyes::{
    Eyes, bytes_of, identity_of, is_out_of_files, network_reason, read_settled, read_whole, sha256_hex,
    stat_of,
};
pub use names::{
    IgnoreRule, Names, OUTPUT_SUFFIX, Verdict, builtin_ignores, has_data_beside, is_building_of, is_data,
    is_output_name, is_scene,
};
pub use settle::{Action, Event, Now, Settle};

use enfilade_report::{Error, Place};

/// Seconds without a change after which a local file counts as written (hazard 1).
pub const QUIET_SECS: f64 = 0.7;
/// The same where the format has no end mark and time is the only witness (hazard 1).
pub const QUIET_UNMARKED_SECS: f64 = 2.0;
/// The same on network drives, whose clients write in bursts (hazards 1 and 10).
pub const NETWORK_QUIET_SECS: f64 = 10.0;
/// How long a drawing may be missing in the middle of a save (hazard 4).
pub const GRACE_SECS: f64 = 5.0;
/// After this long an unfinished file is reported; the wait goes on (hazard 1).
pub const MAX_WAIT_SECS: f64 = 60.0;
/// Full look at the folder however quiet it is, for lost events and mmap writers (hazards 8, 16).
pub const RESCAN_SECS: f64 = 60.0;
/// Full look at the folder where no events can be trusted (hazard 10).
pub const POLL_SECS: f64 = 2.0;
/// Longest pause between two looks at a file that stays unfinished.
pub const MAX_BACKOFF_SECS: f64 = 600.0;
/// How long a drawing may be read before it is measured, seconds.
pub const READ_LIMIT_SECS: f64 = 300.0;
/// How long a job may take in all, seconds.
pub const JOB_LIMIT_SECS: f64 = 3600.0;
/// Larger drawings are refused by name of this limit (hazard 24).
pub const MAX_DRAWING_BYTES: u64 = 2 << 30;
/// Files looked at in one scan of a root; more is a folder nobody meant to watch (hazard 29).
pub const MAX_SCANNED_FILES: usize = 100_000;
/// A jump between the two clocks, or between two ticks, that means the machine slept (hazard 12).
pub const CLOCK_JUMP_SECS: f64 = 30.0;
/// How often a root is looked at to see that it is still the same folder (hazard 11).
pub const ROOT_LOOK_SECS: f64 = 1.0;

/// Whether a file's bytes are a whole drawing, judged by the end mark of its format.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Completeness {
    /// The end mark is there.
    Complete,
    /// The end mark is missing; the text says which.
    Incomplete(String),
    /// The format has none: [`QUIET_UNMARKED_SECS`] must do.
    NoEndMark,
}

/// Judges the bytes of a file by the end mark of its format; given by the caller, who knows formats.
pub type EndMark = fn(&Path, &[u8]) -> Completeness;

/// What the content of a file is known by: a digest of its bytes without the time at which they were written.
pub type ContentKey = fn(&Path, &[u8]) -> String;

/// How folders are watched and where results go.
#[derive(Clone, Debug)]
pub struct WatchSettings {
    /// Quiet time of local files, seconds.
    pub quiet_secs: f64,
    /// Quiet time on network drives, seconds.
    pub network_quiet_secs: f64,
    /// How long a drawing may vanish during a save, seconds.
    pub grace_secs: f64,
    /// When an unfinished file is reported, seconds.
    pub max_wait_secs: f64,
    /// Interval of full looks where events are trusted, seconds.
    pub rescan_secs: f64,
    /// Interval of full looks where they are not, seconds.
    pub poll_secs: f64,
    /// Trust no events anywhere: look every `poll_secs`.
    pub poll: bool,
    /// Levels of folders below a root that are watched too; 0: the root's own files only (hazard 29).
    pub depth: usize,
    /// Extensions of drawings, without dot, lower case.
    pub extensions: Vec<String>,
    /// Further names to leave alone (globs on the file name, or on the path below the root).
    pub ignore: Vec<String>,
    /// Results go below this folder instead of beside the drawing.
    pub out_dir: Option<PathBuf>,
    /// Results go here where the place beside the drawing cannot be written (hazard 19).
    pub fallback_dir: Option<PathBuf>,
    /// The user's folder in which daemons say where the state of roots lies that may not be written; `None`: nobody is
    /// told.
    pub records_dir: Option<PathBuf>,
    /// Watch even `/` or the home folder itself.
    pub force: bool,
    /// Newest saves first; otherwise in the order in which they settled (hazard 26).
    pub newest_first: bool,
    /// What else decides a result (the command line's settings): part of the key of a job, so that
    /// changed settings run a known drawing again.
    pub settings_key: String,
    /// Jobs at the same time; 0 counts as 1.
    pub jobs: usize,
    /// Memory for all jobs together, bytes; `None`: what the machine has.
    pub memory_bytes: Option<u64>,
    /// Memory for one job at most, bytes; `None`: most of that for all.
    pub job_memory_bytes: Option<u64>,
    /// A job that is still reading its drawing after so long is stopped and reported.
    pub read_limit_secs: f64,
    /// A job that runs longer is stopped and reported, so that it cannot block the others (hazard 23).
    pub job_limit_secs: f64,
    /// Interval of the sign of life in `owner.json`; three missed ones free a folder (hazard 21).
    pub heartbeat_secs: f64,
    /// First pause before a job that failed for want of disk or permission is tried again.
    pub retry_secs: f64,
    /// Tells whole files from half-written ones.
    pub end_mark: EndMark,
    /// Tells new contents from those that were only written again.
    pub content_key: ContentKey,
}

impl Default for WatchSettings {
    fn default() -> Self {
        Self {
            quiet_secs: QUIET_SECS,
            network_quiet_secs: NETWORK_QUIET_SECS,
            grace_secs: GRACE_SECS,
            max_wait_secs: MAX_WAIT_SECS,
            rescan_secs: RESCAN_SECS,
            poll_secs: POLL_SECS,
            poll: false,
            depth: 0,
            extensions: vec!["dxf".into()],
            ignore: Vec::new(),
            out_dir: None,
            fallback_dir: None,
            records_dir: None,
            force: false,
            newest_first: false,
            settings_key: String::new(),
            jobs: 1,
            memory_bytes: None,
            job_memory_bytes: None,
            read_limit_secs: READ_LIMIT_SECS,
            job_limit_secs: JOB_LIMIT_SECS,
            heartbeat_secs: 10.0,
            retry_secs: 10.0,
            end_mark: |_, _| Completeness::NoEndMark,
            content_key: |_, bytes| sha256_hex(bytes),
        }
    }
}

/// What the system says about one path; two equal values mean nobody wrote in between.
///
/// Times are only ever compared with earlier times of the same path, never with a clock (hazard 15).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stat {
    /// Length in bytes.
    pub size: u64,
    /// Modification time, nanoseconds since 1970 (may lie).
    pub mtime_ns: i128,
    /// Change time, nanoseconds since 1970 (0 where the system has none).
    pub ctime_ns: i128,
    /// Inode number (0 where the system has none).
    pub inode: u64,
    /// What lies there.
    pub kind: Kind,
}

/// What lies at a path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Kind {
    /// A regular file with its content at hand.
    #[default]
    File,
    /// A regular file whose content a cloud client would have to download first (hazard 13).
    Placeholder,
    /// A folder.
    Folder,
    /// A link: never followed (hazard 30).
    Link,
    /// A device, pipe or socket: never opened (hazard 30).
    Other,
}

/// The outcome of a look at a path.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Seen {
    /// Something lies there.
    There(Stat),
    /// Nothing lies there.
    Gone,
    /// The system refuses to say.
    Unreadable(String),
}

/// The outcome of reading a file that has been quiet.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Checked {
    /// The bytes were read, and the file was the same before and after.
    Read {
        /// The file while it was read.
        stat: Stat,
        /// SHA-256 of the bytes, lower-case hexadecimal.
        sha256: String,
        /// Whether the end mark is there.
        completeness: Completeness,
    },
    /// Somebody wrote while it was read (hazard 25).
    Changed,
    /// It is no longer there.
    Gone,
    /// It cannot be opened (hazard 19).
    Unreadable(String),
}

/// Which folder lies at a root: another value means another folder under the same name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Identity {
    /// Device number.
    pub device: u64,
    /// Inode number.
    pub inode: u64,
    /// When the folder was made, nanoseconds since 1970 (0 where the system does not say).
    pub born_ns: i128,
}

/// Makes the roots absolute and free of links, each once; refuses what nobody means to watch.
///
/// # Errors
/// `no-folder` for no root at all, `root-missing`, `root-no-folder`, and `root-too-wide` for `/`, a
/// drive or the home folder without `force` (hazard 29).
pub fn canonical_roots(roots: &[PathBuf], force: bool) -> Result<Vec<PathBuf>, Error> {
    let mut out: Vec<PathBuf> = Vec::new();
    for root in roots {
        let place = Place::file(root.display().to_string());
        let real = std::fs::canonicalize(root).map_err(|e| {
            Error::usage(
                "root-missing",
                place.clone(),
                format!("cannot be watched: {e}; give an existing folder"),
            )
        })?;
        if !real.is_dir() {
            let folder = root.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
            let text = format!(
                "is a file: watch its folder, {}; `enfilade run` takes a single drawing",
                folder.display()
            );
            return Err(Error::usage("root-no-folder", place, text));
        }
        if !force && is_too_wide(&real) {
            let text = "is too wide to watch; name the project folder, or insist with --force";
            return Err(Error::usage("root-too-wide", place, text));
        }
        if !out.contains(&real) {
            out.push(real);
        }
    }
    if out.is_empty() {
        return Err(Error::usage("no-folder", Place::default(), "no folder to watch was given"));
    }
    Ok(out)
}

fn is_too_wide(root: &Path) -> bool {
    let home = std::env::var_os("HOME").or_else(|| std::env::var_os("USERPROFILE")).map(PathBuf::from);
    let is_home = home.is_some_and(|h| std::fs::canonicalize(&h).unwrap_or(h) == root);
    root.parent().is_none() || is_home
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots_are_canonical_and_few() {
        let dir = tempfile::tempdir().unwrap();
        let a = dir.path().join("a");
        std::fs::create_dir(&a).unwrap();
        let twice = [a.clone(), dir.path().join("a/../a")];
        assert_eq!(canonical_roots(&twice, false).unwrap(), [std::fs::canonicalize(&a).unwrap()]);
        let code = |roots: &[PathBuf]| canonical_roots(roots, false).unwrap_err().problem().unwrap().code;
        assert_eq!(code(&[PathBuf::from("/")]), "root-too-wide");
        assert_eq!(code(&[dir.path().join("b")]), "root-missing");
        assert_eq!(code(&[]), "no-folder");
        std::fs::write(dir.path().join("f"), b"").unwrap();
        assert_eq!(code(&[dir.path().join("f")]), "root-no-folder");
        assert!(canonical_roots(&[PathBuf::from("/")], true).is_ok());
        let said = canonical_roots(&[dir.path().join("f")], false).unwrap_err().to_string();
        let want = format!("is a file: watch its folder, {}", dir.path().display());
        assert!(said.contains(&want), "{said}");
    }
}

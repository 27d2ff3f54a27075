//! The daemon: finished saves become jobs, a few at a time, and jobs become whole result folders.
//!
//! The job itself is given by the caller ([`RunJob`]); everything about folders, order, cancelling,
//! publishing and telling is here. [`watch()`] runs until stopped, [`run_once`] does the same job for one
//! drawing through the same code, [`status`] reads what a running daemon tells.

pub mod child;
mod hands;
mod heart;
mod job;
mod status;
mod turns;

use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::mpsc::RecvTimeoutError;
use std::sync::{Arc, mpsc};
use std::time::Duration;

use serde::{Deserialize, Serialize};
use serde_json::Value;

pub use crate::store::OutFile;
pub use crate::watch::WatchSettings;
#[cfg(feature = "page")]
pub(crate) use heart::{BY_THE_USER, CANCELLED_BEFORE};
pub use status::{rfc3339, status};

use crate::store::{Placing, SystemDisk, led_beside};
use crate::watch::{self, Checked};
use enfilade_report::{Cancel, Error, Place, Problem, one_line, printable};

/// One drawing to be worked on.
#[derive(Clone, Debug)]
pub struct JobRequest {
    /// Where it lies.
    pub drawing: PathBuf,
    /// Its bytes, read once; the file may have changed since.
    pub bytes: Arc<Vec<u8>>,
    /// SHA-256 of the bytes, lower-case hexadecimal.
    pub sha256: String,
    /// What the content is known by: see [`WatchSettings::content_key`]; empty: by `sha256`.
    pub content: String,
    /// Digest of what else decides its results; empty: nobody asks.
    pub config: String,
    /// What it may take of the machine.
    pub share: Share,
    /// Number of the round that the job makes; known once the job runs, 0 before.
    pub round: u32,
    /// What is asked of this round alone.
    pub asked: Asked,
    /// What a job on this drawing kept before it was killed; known once the job runs, empty before.
    pub earlier: Arc<Vec<u8>>,
    /// Its result folder; known once the job runs, empty before.
    pub results: PathBuf,
}

/// What a job may take of the machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Share {
    /// Memory, bytes; `None`: as the caller of the job says.
    pub memory_bytes: Option<u64>,
    /// Whether it gives way to others from the start, as it is known to take long.
    pub is_long: bool,
}

/// What a user asks of one round; where it says nothing, the settings hold.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Asked {
    /// Objectives and thresholds, as in settings.
    pub objective: Option<String>,
    /// The round whose options `pin` and `like` name; `None`: the newest.
    pub round: Option<u32>,
    /// Their options are those of the best so far, after so many evaluations: later it has others.
    pub so_far: Option<u64>,
    /// Options that stay, counted from 1; the others are found unlike them.
    pub pin: Vec<usize>,
    /// More like this option, counted from 1.
    pub like: Option<usize>,
}

/// What a user asks of a running daemon.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Order {
    /// Give up the job of this drawing, running or waiting; another content, or other settings, are a new job.
    Cancel(PathBuf),
    /// Another round of the drawing as it lies there, whatever was done before.
    Again {
        /// The drawing.
        drawing: PathBuf,
        /// What is asked of this round.
        asked: Asked,
    },
}

/// What a job tells while it runs.
#[derive(Clone, Debug)]
pub enum JobEvent {
    /// An object with `stage`, `done`, `total`, `evaluations`, `best`, `eta_secs`, as far as known.
    Progress(Value),
    /// Early results: published at once as the content of `analysis/`.
    Analysis(Vec<OutFile>),
    /// The best of the search so far: published at once as the content of `so-far/`, which the finished round
    /// replaces.
    SoFar {
        /// The files, as those of a round.
        files: Vec<OutFile>,
        /// As in [`JobEvent::Progress`]; the folder is added.
        progress: Value,
    },
    /// How much processor time it has taken so far.
    Worked(Duration),
    /// To be kept until the job is done, and given back as [`JobRequest::earlier`] should it be killed.
    Keep {
        /// The bytes.
        bytes: Vec<u8>,
        /// Whether they replace what was kept; else they follow it.
        is_anew: bool,
    },
}

impl JobEvent {
    /// Whether the drawing may not be understood yet when this comes.
    fn is_reading(&self) -> bool {
        match self {
            Self::Progress(value) => is_reading(value),
            Self::Worked(_) => true,
            _ => false,
        }
    }
}

/// Whether a step of progress is one of reading.
fn is_reading(progress: &Value) -> bool {
    progress["stage"] == "read"
}

/// What a job leaves.
#[derive(Clone, Debug, Default)]
pub struct JobOutput {
    /// The files of the round; empty: no round is made.
    pub files: Vec<OutFile>,
    /// Whether walls or requests were left out (exit code 1).
    pub is_degraded: bool,
    /// One line for the user.
    pub summary: String,
}

/// A job: from a drawing's bytes to files. It looks at the [`Cancel`] at least every 50 ms.
pub type RunJob =
    dyn Fn(&JobRequest, &mut dyn FnMut(JobEvent), &Cancel) -> Result<JobOutput, Error> + Send + Sync;

/// Reads the daemon's settings again, for one of the watched folders' own files has changed; `None` where what
/// was read before holds.
pub type Reread<'a> = dyn FnMut() -> Result<Option<WatchSettings>, Error> + 'a;

/// A finished job.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Done {
    /// The round's folder, or the result folder where no round was made.
    pub folder: PathBuf,
    /// Number of the round, if one was made.
    pub round: Option<u32>,
    /// Whether walls or requests were left out.
    pub is_degraded: bool,
    /// One line for the user.
    pub summary: String,
}

/// What the user is told.
#[derive(Clone, Debug)]
pub enum Notice {
    /// A root is watched, in this manner.
    Watching {
        /// The root.
        root: PathBuf,
        /// By events, or by polling and why.
        how: String,
    },
    /// The daemon's own settings were changed in this file, and hold from now on.
    Renewed(PathBuf),
    /// A root is out of reach; it is looked for.
    Offline(PathBuf),
    /// A root is back.
    Online(PathBuf),
    /// A file that looks like a drawing is left alone.
    Ignored {
        /// The file.
        path: PathBuf,
        /// Why.
        why: String,
    },
    /// A finished save waits for its turn, with this many others.
    Queued {
        /// The drawing.
        drawing: PathBuf,
        /// Drawings waiting, this one included.
        waiting: usize,
    },
    /// A drawing has its results already, from an earlier run.
    UpToDate {
        /// The drawing.
        drawing: PathBuf,
        /// Its result folder; `None` where the user removed it.
        folder: Option<PathBuf>,
        /// What came of it, as far as it is remembered.
        summary: String,
    },
    /// Where the results of a drawing lie that is not worked on.
    Results {
        /// The drawing.
        drawing: PathBuf,
        /// Its result folder.
        folder: PathBuf,
    },
    /// A drawing is gone; its results stay where they are.
    Removed(PathBuf),
    /// The job of a drawing began.
    Started(PathBuf),
    /// The job of a drawing goes on.
    Progress {
        /// The drawing.
        drawing: PathBuf,
        /// As in [`JobEvent::Progress`].
        value: Value,
    },
    /// Early results are to be seen.
    Analysis {
        /// The drawing.
        drawing: PathBuf,
        /// Where.
        folder: PathBuf,
    },
    /// The job of a drawing is done.
    Done {
        /// The drawing.
        drawing: PathBuf,
        /// What came of it.
        done: Done,
    },
    /// The job of a drawing was given up.
    Stopped {
        /// The drawing.
        drawing: PathBuf,
        /// Why, in words.
        why: &'static str,
    },
    /// The job of a drawing failed; the next one is taken up.
    Failed {
        /// The drawing.
        drawing: PathBuf,
        /// Why.
        problem: Problem,
        /// Seconds until it is tried again; `None`: at its next save.
        retry_secs: Option<f64>,
    },
    /// What was told before, as that a disk is still full: for the page alone.
    Again(Box<Notice>),
    /// Something worth knowing; the work goes on.
    Problem {
        /// The file or folder.
        path: PathBuf,
        /// What.
        problem: Problem,
    },
}

impl fmt::Display for Notice {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = |path: &Path| one_line(&path.to_string_lossy());
        match self {
            Self::Watching { root, how } => write!(f, "watching {} ({how})", name(root)),
            Self::Renewed(file) => write!(f, "{}: what it says of watching holds from now on", name(file)),
            Self::Offline(root) => write!(f, "{} is out of reach; waiting for it", name(root)),
            Self::Online(root) => write!(f, "{} is back", name(root)),
            Self::Ignored { path, why } => write!(f, "{} is left alone: {why}", name(path)),
            Self::Queued { drawing, waiting } => write!(f, "{} waits ({waiting} waiting)", name(drawing)),
            Self::UpToDate { drawing, .. } => write!(f, "{} is up to date", name(drawing)),
            Self::Results { drawing, .. } => write!(f, "{} has results of before", name(drawing)),
            Self::Removed(drawing) => write!(f, "{} is gone", name(drawing)),
            Self::Started(drawing) => write!(f, "{} started", name(drawing)),
            Self::Progress { drawing, value } => write!(f, "{} {value}", name(drawing)),
            Self::Analysis { folder, .. } => write!(f, "present layout measured: {}", name(folder)),
            Self::Done { done, .. } => write!(f, "{}: {}", name(&done.folder), printable(&done.summary)),
            Self::Stopped { drawing, why } => write!(f, "{} stopped: {why}", name(drawing)),
            Self::Failed { drawing, problem, retry_secs } => {
                write!(f, "{} failed: {problem}", name(drawing))?;
                retry_secs.map_or(Ok(()), |s| write!(f, "; tried again in {s:.0} s"))
            }
            Self::Again(notice) => notice.fmt(f),
            Self::Problem { problem, .. } => write!(f, "{problem}"),
        }
    }
}

/// Watches folders until `stop`: every finished save of a drawing becomes a job, `settings.jobs` at a time.
///
/// A newer save of the same drawing cancels its running job; its last results stay until the new ones
/// are whole. A failing or panicking job is reported and the next one taken up.
///
/// # Errors
/// [`Error::Usage`] for folders or patterns that cannot be watched, [`Error::Environment`]
/// (`folder-owned`, `folder-taken`) where another daemon has a folder, [`Error::Stopped`] in the end.
pub fn watch(
    roots: &[PathBuf],
    settings: &WatchSettings,
    run: Arc<RunJob>,
    show: &mut dyn FnMut(Notice),
    stop: &Cancel,
) -> Result<(), Error> {
    // Nobody orders: the other end is gone from the start.
    watch_with_orders(roots, settings, &mut || Ok(None), run, mpsc::channel().1, show, stop)
}

/// [`watch()`], and takes a user's orders and changed settings meanwhile.
///
/// # Errors
/// As [`watch()`].
pub fn watch_with_orders(
    roots: &[PathBuf],
    settings: &WatchSettings,
    reread: &mut Reread<'_>,
    run: Arc<RunJob>,
    orders: mpsc::Receiver<Order>,
    show: &mut dyn FnMut(Notice),
    stop: &Cancel,
) -> Result<(), Error> {
    let roots = watch::canonical_roots(roots, settings.force)?;
    heart::Heart::start(&roots, settings, run, orders, stop)?.beat_until(reread, show, stop)
}

/// How often a file that changes while it is read is read again before giving up.
const READ_ATTEMPTS: usize = 5;

/// Does the job for one drawing now, whatever was done before.
///
/// # Errors
/// Those of the job and of the disk; [`Error::Input`] for a file that cannot be read.
pub fn run_once(
    drawing: &Path,
    settings: &WatchSettings,
    run: &RunJob,
    show: &mut dyn FnMut(Notice),
    stop: &Cancel,
) -> Result<Done, Error> {
    let path = led_beside(&std::path::absolute(drawing).unwrap_or_else(|_| drawing.into()));
    let bytes = read_now(&path)?;
    let sha256 = watch::sha256_hex(&bytes);
    let placing = Placing { out_dir: settings.out_dir.clone(), fallback_dir: settings.fallback_dir.clone() };
    let request = JobRequest {
        drawing: path.clone(),
        bytes: Arc::new(bytes),
        sha256,
        content: String::new(),
        config: String::new(),
        share: Share::default(),
        round: 0,
        asked: Asked::default(),
        earlier: Arc::default(),
        results: PathBuf::new(),
    };
    show(Notice::Started(path.clone()));
    let mut tell = |told: job::Told| told.notice(&path).into_iter().for_each(&mut *show);
    let write_stopped = || status::write_end(&SystemDisk, &path, &placing, &request.sha256, &Error::Stopped);
    let outcome = until_stopped(stop, &write_stopped, || {
        job::perform(Arc::new(SystemDisk), &request, &placing, run, stop, &mut tell, &mut |_, _| Ok(()))
    });
    if let Err(error) = &outcome {
        status::write_end(&SystemDisk, &path, &placing, &request.sha256, error);
    }
    outcome
}

/// How often a stop request is looked at beside the job.
const STOP_PAUSE: Duration = Duration::from_millis(20);

/// Does `work`; where a stop is asked for meanwhile, `on_stop` happens at once, as a job that does not end soon is
/// left behind.
fn until_stopped<T>(stop: &Cancel, on_stop: &(dyn Fn() + Sync), work: impl FnOnce() -> T) -> T {
    let (done, is_done) = mpsc::channel::<()>();
    std::thread::scope(|scope| {
        scope.spawn(move || {
            while is_done.recv_timeout(STOP_PAUSE) == Err(RecvTimeoutError::Timeout) {
                if stop.is_stopped() {
                    return on_stop();
                }
            }
        });
        let out = work();
        drop(done);
        out
    })
}

fn read_now(path: &Path) -> Result<Vec<u8>, Error> {
    let place = Place::file(path.display().to_string());
    for _ in 0..READ_ATTEMPTS {
        match watch::read_whole(path) {
            Ok((bytes, _)) => return Ok(bytes),
            Err(Checked::Gone) => return Err(Error::input("no-such-file", place, "there is no such file")),
            Err(Checked::Unreadable(why)) => {
                return Err(Error::input("unreadable", place, format!("cannot be read: {why}")));
            }
            Err(_) => std::thread::sleep(std::time::Duration::from_millis(100)),
        }
    }
    Err(Error::input("still-changing", place, "is being written; run again when that has finished"))
}

#[cfg(test)]
mod tests;

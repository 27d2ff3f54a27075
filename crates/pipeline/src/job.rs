//! What a job is given, what it says while it runs, and what it hands out.

use std::borrow::Cow;
use std::sync::OnceLock;

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use enfilade_config::Settings;
use enfilade_report::{Cancel, Error, OutFile, Report};

/// A drawing to work on.
#[derive(Clone, Debug)]
pub struct Input<'a> {
    /// Path as the user would name it; its last part is shown in places.
    pub path: &'a str,
    /// The file without result layers of ours (a candidate used as the new plan has some).
    pub bytes: Cow<'a, [u8]>,
    /// The file as it lies on disk.
    whole: &'a [u8],
    sha256: OnceLock<String>,
    /// Number of the round that is made, from 1; shown only.
    pub round: u64,
    /// What an earlier start of the same job handed out as [`Event::Keep`], in order; empty: nothing.
    pub earlier: &'a [u8],
}

impl<'a> Input<'a> {
    /// Takes a file's bytes.
    pub fn new(path: &'a str, bytes: &'a [u8], round: u64) -> Self {
        let plain = enfilade_cad::plain(path, bytes);
        Self { path, bytes: plain, whole: bytes, sha256: OnceLock::new(), round, earlier: &[] }
    }

    /// Digest of the file as it lies on disk, lower-case hexadecimal; made when first asked for.
    pub fn sha256(&self) -> &str {
        let of = || Sha256::digest(self.whole).iter().map(|b| format!("{b:02x}")).collect();
        self.sha256.get_or_init(of)
    }

    /// Digest of the file without the time at which it was written: see [`enfilade_cad::timeless`].
    pub fn content(&self) -> String {
        enfilade_cad::timeless(std::path::Path::new(self.path), self.whole)
    }

    /// With what an earlier start of the same job handed out.
    pub fn going_on_from(self, earlier: &'a [u8]) -> Self {
        Self { earlier, ..self }
    }

    /// Name to show.
    pub fn file(&self) -> &'a str {
        self.path.rsplit(['/', '\\']).next().unwrap_or(self.path)
    }
}

/// How far a job is: the line of `--progress json`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Progress {
    /// `read`, `measure`, `optimise: degree`, `write` …
    pub stage: String,
    /// Steps done of this stage.
    pub done: u64,
    /// Steps of this stage, if known.
    pub total: Option<u64>,
    /// Layouts measured.
    pub evaluations: u64,
    /// Best value so far of what the stage optimises.
    pub best: Option<f64>,
    /// Parameters of the layout that has it, in the order of the moves table.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub best_parameters: Option<Vec<f64>>,
    /// Seconds left, if known.
    pub eta_secs: Option<f64>,
    /// Where the best so far was just written.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub folder: Option<String>,
}

/// What a running job says.
#[derive(Clone, Debug)]
pub enum Event {
    /// It got on.
    Progress(Progress),
    /// The heat maps of the present layout, to be shown before the search ends: files of `analysis/`.
    Analysis(Vec<OutFile>),
    /// The best so far of a search that goes on: files as of a round.
    SoFar {
        /// The files.
        files: Vec<OutFile>,
        /// How far the search was; its stage is `so-far`.
        progress: Progress,
    },
    /// To be kept until the job is done: given back as [`Input::earlier`], it spares measuring again.
    Keep(Keep),
}

/// A finished job.
#[derive(Clone, Debug)]
pub struct Outcome<T> {
    /// What it found.
    pub result: T,
    /// Files of the folder it makes.
    pub files: Vec<OutFile>,
    /// What was left out or assumed.
    pub report: Report,
}

/// Runs a job on as many threads as the settings say.
///
/// # Errors
/// [`Error::Environment`] when the threads cannot be started; what the job returns.
pub fn on_threads<T: Send>(
    settings: &Settings,
    job: impl FnOnce() -> Result<T, Error> + Send,
) -> Result<T, Error> {
    let threads = settings.threads.unwrap_or(0);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().map_err(|e| {
        Error::environment(
            "threads",
            Default::default(),
            format!("{threads} threads could not be started: {e}"),
        )
    })?;
    pool.install(job)
}

/// Bytes to keep until the job is done.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Keep {
    /// Whether they replace what was kept; else they follow it.
    pub is_anew: bool,
    /// The bytes.
    pub bytes: Vec<u8>,
}

/// A drawing and what is asked of it.
#[derive(Clone, Copy)]
pub(crate) struct Job<'a> {
    /// The drawing.
    pub(crate) input: &'a Input<'a>,
    /// What is asked.
    pub(crate) settings: &'a Settings,
}

/// Who follows a running job: is told of it, and may stop it.
pub(crate) struct Watch<'a> {
    /// Takes what the job says.
    pub(crate) show: &'a mut (dyn FnMut(Event) + Send),
    /// Whether it is to stop.
    pub(crate) cancel: &'a Cancel,
}

impl Watch<'_> {
    /// Says that a stage begins.
    pub(crate) fn stage(&mut self, stage: &str, total: Option<u64>) {
        self.progress(Progress { stage: stage.into(), total, ..Default::default() });
    }

    /// Says how far the job is.
    pub(crate) fn progress(&mut self, progress: Progress) {
        (self.show)(Event::Progress(progress));
    }
}

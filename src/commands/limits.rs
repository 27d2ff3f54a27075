//! Limits of time for commands that work on one drawing, as the daemon has them for its jobs: one of work for reading it,
//! one by the clock for the whole.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use super::beside::settings_partial;
use crate::cli::Common;
use crate::watch::{JOB_LIMIT_SECS, READ_LIMIT_SECS};
use crate::worked::Work;
use enfilade_config::{Partial, Settings};
use enfilade_report::{Cancel, Error, Place, complain};

/// A command that was told to end has so long to do it; then its process ends.
const PATIENCE: Duration = Duration::from_secs(5);

/// How often a reading is looked at.
const LOOK: Duration = Duration::from_millis(20);

/// Watches one command; dropped, it watches no more.
pub(super) struct Clock {
    cancel: Cancel,
    hit: Arc<Mutex<Option<Error>>>,
    tell: Option<mpsc::Sender<()>>,
    watcher: Option<JoinHandle<()>>,
}

/// What a command may take.
struct Limits {
    file: PathBuf,
    read: Duration,
    job: Duration,
}

/// Which limit a command hit.
enum Limit {
    Reading,
    Job,
}

impl Clock {
    /// Begins to watch; `seconds`: the budget of a search.
    ///
    /// # Errors
    /// Of the drawing's settings, and of `seconds` as the settings have them.
    pub(super) fn start(file: &Path, common: &Common, seconds: Option<f64>) -> Result<Self, Error> {
        Settings::new(Partial { seconds, ..Partial::default() })?;
        let said = settings_partial(file, Partial::default())?.watch.unwrap_or_default();
        let read = common.read_limit_secs.or(said.read_limit_secs).unwrap_or(READ_LIMIT_SECS);
        let job = common.job_limit_secs.or(said.job_limit_secs);
        let job = job.unwrap_or(JOB_LIMIT_SECS + seconds.unwrap_or(0.0));
        let [read, job] = [read, job].map(Duration::from_secs_f64);
        let (cancel, hit) = (Cancel::default(), Arc::default());
        let (tell, heard) = mpsc::channel();
        let (limits, its) = (Limits { file: file.into(), read, job }, (cancel.clone(), Arc::clone(&hit)));
        let watcher = std::thread::spawn(move || watch(&limits, &heard, &its.0, &its.1));
        Ok(Self { cancel, hit, tell: Some(tell), watcher: Some(watcher) })
    }

    /// The drawing is understood: only the limit of the whole holds from now on.
    pub(super) fn is_read(&self) {
        if let Some(tell) = &self.tell {
            // Nobody watches any more once a limit is hit.
            let _ = tell.send(());
        }
    }

    /// The outcome of the command, and what ended it where a limit did.
    pub(super) fn judge<T>(&self, outcome: Result<T, Error>) -> Result<T, Error> {
        let hit = || self.hit.lock().unwrap_or_else(PoisonError::into_inner).take();
        outcome.map_err(|e| if matches!(e, Error::Stopped) { hit().unwrap_or(e) } else { e })
    }

    /// Stops when `outer` does, or when a limit is hit.
    pub(super) fn within(&self, outer: &Cancel) -> Cancel {
        outer.also(&self.cancel)
    }
}

impl Drop for Clock {
    fn drop(&mut self) {
        self.tell = None;
        if let Some(watcher) = self.watcher.take() {
            let _ = watcher.join();
        }
    }
}

/// Waits for the ends that the limits allow; what is late is stopped, and what hears nothing ended with its reason.
fn watch(limits: &Limits, heard: &mpsc::Receiver<()>, cancel: &Cancel, hit: &Mutex<Option<Error>>) {
    let work = Work::begin();
    let mut is_read = false;
    let late = loop {
        let left = limits.job.saturating_sub(work.elapsed());
        let look = left.min(LOOK).min(limits.read);
        match heard.recv_timeout(if is_read { left } else { look }) {
            Ok(()) => is_read = true,
            Err(RecvTimeoutError::Disconnected) => return,
            Err(RecvTimeoutError::Timeout) if left.is_zero() => break late(limits, Limit::Job),
            Err(RecvTimeoutError::Timeout) if !is_read && work.is_over(limits.read) => {
                break late(limits, Limit::Reading);
            }
            Err(RecvTimeoutError::Timeout) => {}
        }
    };
    *hit.lock().unwrap_or_else(PoisonError::into_inner) = Some(late.clone());
    cancel.stop_keeping();
    let told = Instant::now();
    while let Ok(()) = heard.recv_timeout(PATIENCE.saturating_sub(told.elapsed())) {}
    if told.elapsed() >= PATIENCE {
        complain(format_args!("error: {late}"));
        std::process::exit(i32::from(late.exit_code()));
    }
}

fn late(limits: &Limits, limit: Limit) -> Error {
    let (code, what, took, key) = match limit {
        Limit::Reading => {
            let took = format!("{} s of work", limits.read.as_secs_f64());
            ("reading-too-long", "reading the drawing", took, "read-limit-secs")
        }
        Limit::Job => {
            ("job-too-long", "the job", format!("{} s", limits.job.as_secs_f64()), "job-limit-secs")
        }
    };
    let text = format!(
        "{what} took longer than the limit of {took} (--{key}, or {key} in [watch] of enfilade.toml) and was ended; \
         its results are not complete"
    );
    Error::input(code, Place::file(limits.file.to_string_lossy()), text)
}

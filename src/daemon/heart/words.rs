//! What the daemon says of roots and jobs, and how long it waits before it tries again.

use std::path::Path;
use std::time::Duration;

use super::super::WatchSettings;
use super::super::child::JOB_KILLED;
use crate::store::read_lease;
use enfilade_report::{Error, Place, Problem, Severity};

/// Longest pause before a job that failed for want of disk or permission is tried again.
const MAX_RETRY_SECS: f64 = 600.0;

/// Seconds until a job is tried again that failed so often before: twice as long each time.
pub(super) fn retry_pause(first_secs: f64, failures: u32) -> f64 {
    (first_secs * f64::from(1u32 << failures.min(10))).min(MAX_RETRY_SECS)
}

/// How a root is watched, for log, page and `status`.
pub(super) fn how_watched(settings: &WatchSettings, reason: Option<&str>) -> String {
    match reason {
        Some(why) => format!("polled every {} s: {why}", settings.poll_secs),
        None if settings.poll => format!("polled every {} s: asked for", settings.poll_secs),
        None => format!("by events, looked through every {} s", settings.rescan_secs),
    }
}

/// A drawing as a place.
pub(super) fn shown(drawing: &Path) -> Place {
    Place::file(drawing.file_name().unwrap_or_default().to_string_lossy())
}

pub(super) fn too_long(drawing: &Path, limit_secs: f64, has_best: bool) -> Error {
    let best = if has_best { "; its best so far is kept" } else { "" };
    let text =
        format!("the job ran longer than the limit of {limit_secs} s (job-limit-secs) and was stopped{best}");
    Error::input("job-too-long", shown(drawing), text)
}

pub(super) fn hung(drawing: &Path) -> Error {
    let text = "the job did not stop when asked to and was left behind; the next drawing is taken up";
    Error::input("job-hung", shown(drawing), text)
}

/// Why a job ended that nobody here told to end.
pub(super) fn told_to_end(drawing: &Path) -> Problem {
    let text = "the job's process was told to end, and not by the daemon".to_owned();
    Problem { code: JOB_KILLED, severity: Severity::Error, place: shown(drawing), text }
}

/// A job that is killed each time is not tried for ever.
pub(super) fn killed_too_often(problem: Problem, times: u32) -> Error {
    let text = format!(
        "{}, {times} times in a row; it is not tried again before its next save: free memory, give jobs less of it \
         (job-memory-mb) or a wider spacing",
        problem.text
    );
    Error::Input(Problem { text, ..problem })
}

pub(super) fn taken(root: &Path, state: &Path) -> Error {
    let who = read_lease(state).map_or_else(String::new, |l| format!(" (process {} on {})", l.pid, l.host));
    let text = format!("another daemon{who} has taken this folder; this one leaves it");
    Error::environment("folder-taken", Place::file(root.display().to_string()), text)
}

/// A time in words, to the unit that says enough.
pub(super) fn lasting(time: Duration) -> String {
    match time.as_secs() {
        secs @ 0..120 => format!("{secs} s"),
        secs @ 120..7200 => format!("{} min", secs / 60),
        secs => format!("{} h", secs / 3600),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_said_in_a_unit_that_says_enough() {
        let said = [0, 119, 120, 7199, 7200, 200_000].map(|secs| lasting(Duration::from_secs(secs)));
        assert_eq!(said, ["0 s", "119 s", "2 min", "119 min", "2 h", "55 h"]);
    }

    #[test]
    fn pauses_double_up_to_the_limit() {
        let pauses = [0, 1, 2, 5, 6, 31, u32::MAX].map(|failures| retry_pause(10.0, failures));
        assert_eq!(pauses, [10.0, 20.0, 40.0, 320.0, MAX_RETRY_SECS, MAX_RETRY_SECS, MAX_RETRY_SECS]);
        assert_eq!(retry_pause(2000.0, 0), MAX_RETRY_SECS);
    }
}

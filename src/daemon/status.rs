//! What is being done now, as JSON beside each drawing and in the state folder of each root.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{SystemTime, UNIX_EPOCH};

use serde_json::{Value, json};

use crate::store::{
    Disk, Placing, Records, SystemDisk, find_folder, finished_rounds, is_held, present_folder, read_lease,
    read_own, round_name, write_json,
};
use enfilade_report::{Error, Problem};

/// What the status of a drawing says besides its progress.
#[derive(Clone, Debug, Default)]
pub(super) struct Standing<'a> {
    pub state: &'a str,
    pub sha256: &'a str,
    /// What the content is known by where that is not its `sha256`.
    pub content: &'a str,
    /// Digest of what else decided its results.
    pub config: &'a str,
    pub round: Option<&'a str>,
    pub summary: Option<&'a str>,
    pub problems: &'a [Problem],
}

/// `status.json` of one drawing, `enfilade.status/1`. Keys of `progress` are repeated as they are.
pub(super) fn drawing_status(
    drawing: &Path,
    since: &str,
    standing: &Standing<'_>,
    progress: Option<&Value>,
) -> Value {
    let name = drawing.file_name().unwrap_or_default().to_string_lossy();
    let mut out = json!({
        "schema": "enfilade.status/1",
        "drawing": name,
        "sha256": standing.sha256,
        "state": standing.state,
        "since": since,
    });
    for key in ["stage", "done", "total", "evaluations", "best", "eta_secs"] {
        out[key] = progress.and_then(|p| p.get(key)).cloned().unwrap_or(Value::Null);
    }
    if let Some(questions) = progress.and_then(|p| p.get("questions")) {
        out["questions"] = questions.clone();
    }
    if !standing.content.is_empty() && standing.content != standing.sha256 {
        out["content"] = json!(standing.content);
    }
    if !standing.config.is_empty() {
        out["config"] = json!(standing.config);
    }
    out["round"] = json!(standing.round);
    out["summary"] = json!(standing.summary);
    out["problems"] = json!(standing.problems);
    out
}

/// Writes the status of a drawing that is not being worked on. What the disk refuses here it will
/// refuse the job too, which reports it.
pub(super) fn write_standing(disk: &dyn Disk, drawing: &Path, placing: &Placing, standing: &Standing<'_>) {
    if let Ok(folder) = find_folder(disk, drawing, placing) {
        let status = drawing_status(drawing, &rfc3339(SystemTime::now()), standing, None);
        let _ = write_json(disk, &folder.join("status.json"), &status);
    }
}

/// States of a round that was not finished. One that was asked for with wishes of its own is not asked for again.
pub(super) const UNFINISHED: [&str; 3] = ["running", "waiting", "stopped"];
/// The same and that of a job whose settings could not be read, which says nothing once they are mended.
pub(super) const UNFINISHED_OR_FAILED: [&str; 4] = ["running", "waiting", "stopped", "failed"];

/// Puts right what says of a content that is done that it is in one of some states.
pub(super) fn settle(
    disk: &dyn Disk,
    drawing: &Path,
    placing: &Placing,
    states: &[&str],
    (sha256, summary): (&str, &str),
) {
    let Some(folder) = present_folder(drawing, placing) else { return };
    let status = status_in(&folder);
    let is_stale = states.iter().any(|s| status["state"] == *s);
    if let (true, Some(newest)) = (is_stale, finished_rounds(&folder).last()) {
        let round = round_name(*newest);
        let done = Standing { state: "done", sha256, round: Some(&round), ..Standing::default() };
        write_standing(disk, drawing, placing, &Standing { summary: Some(summary), ..done });
    }
}

/// What waited, or was worked on, of a drawing that is gone does so no more.
pub(super) fn settle_gone(disk: &dyn Disk, drawing: &Path, placing: &Placing, why: &str) {
    settle_stopped(disk, drawing, placing, &["settling", "waiting", "running"], why);
}

/// Says of a drawing that it is stopped, and why, where it is said to be in one of some states.
pub(super) fn settle_stopped(disk: &dyn Disk, drawing: &Path, placing: &Placing, states: &[&str], why: &str) {
    let Some(folder) = present_folder(drawing, placing) else { return };
    let status = status_in(&folder);
    if states.iter().any(|s| status["state"] == *s) {
        let sha256 = status["sha256"].as_str().unwrap_or_default();
        let gone = Standing { state: "stopped", sha256, summary: Some(why), ..Standing::default() };
        write_standing(disk, drawing, placing, &gone);
    }
}

fn status_in(folder: &Path) -> Value {
    let status = read_own(&folder.join("status.json")).ok();
    status.and_then(|s| serde_json::from_slice(&s).ok()).unwrap_or_default()
}

/// Of which content the newest results in a result folder are, by what it is known by; `None` where none is known.
pub(super) fn content_of_results(folder: &Path) -> Option<String> {
    let status: Value = serde_json::from_slice(&read_own(&folder.join("status.json")).ok()?).ok()?;
    let key = status["content"].as_str().or(status["sha256"].as_str());
    (status["state"] == "done").then(|| key.map(str::to_owned))?
}

/// What the results beside a drawing say of this content and these settings: a sentence, and the newest round. The
/// round's own result has the content.
pub(super) fn result_of(folder: &Path, sha256: &str, config: &str) -> Option<(String, PathBuf)> {
    let status = status_in(folder);
    let is_it = status["state"] == "done" && status["config"] == config && !config.is_empty();
    let newest = finished_rounds(folder).last().filter(|_| is_it).map(|n| folder.join(round_name(*n)))?;
    let result: Value = serde_json::from_slice(&read_own(&newest.join("result.json")).ok()?).ok()?;
    let summary = status["summary"].as_str().unwrap_or_default().to_owned();
    (result["input"]["sha256"] == sha256).then_some((summary, newest))
}

/// Writes how a job without results ended.
pub(super) fn write_end(disk: &dyn Disk, drawing: &Path, placing: &Placing, sha256: &str, error: &Error) {
    let problems: Vec<Problem> = error.problem().cloned().into_iter().collect();
    let state = if matches!(error, Error::Stopped) { "stopped" } else { "failed" };
    let standing = Standing { state, sha256, problems: &problems, ..Standing::default() };
    write_standing(disk, drawing, placing, &standing);
}

/// With fewer bytes left a daemon cannot write its overview.
const OVERVIEW_BYTES: u64 = 64 << 10;

/// What daemons tell about these roots: one object a root, `{root, is_running, owner, state_folder, status, doubt}`; `status`
/// is the daemon's overview (`enfilade.daemon/1`), null where none ever ran; `doubt` says why what it tells may be of
/// an earlier time, null where nothing speaks against it. Of a root that cannot be
/// written the records in `records` say where its state lies.
pub fn status(roots: &[PathBuf], records: Option<&Path>) -> Vec<Value> {
    let records = Records::new(records.map(Path::to_path_buf));
    let one = |root: &PathBuf| {
        let real = std::fs::canonicalize(root).unwrap_or_else(|_| root.clone());
        let folder = records.state_of(&real);
        let text = read_own(&folder.join("status.json")).ok();
        let status: Value = text.and_then(|t| serde_json::from_slice(&t).ok()).unwrap_or_default();
        json!({
            "root": root.display().to_string(),
            "is_running": is_held(&folder) || records.is_watched(&real),
            "owner": read_lease(&folder).map(|l| json!(l)),
            "state_folder": folder.display().to_string(),
            "status": status,
            "doubt": doubt(SystemDisk.free_bytes(&folder).ok()),
        })
    };
    roots.iter().map(one).collect()
}

/// Why an overview may be old: nothing new can be written where so much is free.
fn doubt(free_bytes: Option<u64>) -> Option<&'static str> {
    let is_full = free_bytes.is_some_and(|free| free < OVERVIEW_BYTES);
    is_full.then_some("the disk is full, so what is told here may be of before it was: make room")
}

/// A time as RFC 3339 in UTC, to the second.
pub fn rfc3339(time: SystemTime) -> String {
    let secs = time.duration_since(UNIX_EPOCH).map_or(0, |d| d.as_secs());
    let (days, of_day) = (secs / 86_400, secs % 86_400);
    let (year, month, day) = civil_from_days(days);
    format!("{year:04}-{month:02}-{day:02}T{:02}:{:02}:{:02}Z", of_day / 3600, of_day / 60 % 60, of_day % 60)
}

/// Year, month and day of the Gregorian calendar, counted from 1970-01-01. Source: H. Hinnant,
/// "chrono-compatible low-level date algorithms".
fn civil_from_days(days: u64) -> (u64, u64, u64) {
    let shifted = days + 719_468;
    let (era, of_era) = (shifted / 146_097, shifted % 146_097);
    let year_of_era = (of_era - of_era / 1460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let month_from_march = (5 * of_year + 2) / 153;
    let day = of_year - (153 * month_from_march + 2) / 5 + 1;
    let month = if month_from_march < 10 { month_from_march + 3 } else { month_from_march - 9 };
    (era * 400 + year_of_era + u64::from(month <= 2), month, day)
}

/// The disk as shared by the daemon's threads.
pub(super) type SharedDisk = Arc<dyn Disk>;

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn a_killed_order_leaves_no_word_that_it_goes_on() {
        let dir = tempfile::tempdir().unwrap();
        let (drawing, placing) = (dir.path().join("plan.dxf"), Placing::default());
        let folder = dir.path().join("plan.enfilade");
        std::fs::write(&drawing, "EOF").unwrap();
        let says = || -> Value {
            serde_json::from_slice(&std::fs::read(folder.join("status.json")).unwrap()).unwrap()
        };
        for (state, rounds, settled) in [
            ("running", 0, "running"),
            ("failed", 1, "failed"),
            ("running", 2, "done"),
            ("waiting", 2, "done"),
            ("stopped", 2, "done"),
        ] {
            (1..=rounds).for_each(|n| std::fs::create_dir_all(folder.join(round_name(n))).unwrap());
            write_standing(&SystemDisk, &drawing, &placing, &Standing { state, ..Standing::default() });
            settle(&SystemDisk, &drawing, &placing, &UNFINISHED, ("ab", "5 options"));
            assert_eq!(says()["state"], settled, "{state}");
        }
        assert_eq!(
            (says()["round"].as_str(), says()["summary"].as_str()),
            (Some("round-02"), Some("5 options"))
        );
    }

    #[test]
    fn a_full_disk_makes_what_is_told_doubtful() {
        assert!(doubt(Some(0)).is_some() && doubt(Some(OVERVIEW_BYTES - 1)).is_some());
        assert_eq!((doubt(Some(OVERVIEW_BYTES)), doubt(None)), (None, None));
    }

    #[test]
    fn dates_are_right() {
        let at = |secs| rfc3339(UNIX_EPOCH + Duration::from_secs(secs));
        assert_eq!(at(0), "1970-01-01T00:00:00Z");
        assert_eq!(at(951_782_399), "2000-02-28T23:59:59Z");
        assert_eq!(at(951_782_400), "2000-02-29T00:00:00Z");
        assert_eq!(at(4_102_444_800), "2100-01-01T00:00:00Z");
        assert_eq!(at(1_795_230_245), "2026-11-21T03:04:05Z");
    }
}

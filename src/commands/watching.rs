//! `watch`, the jobs it starts, and `status`.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError, mpsc};
use std::time::SystemTime;

use serde_json::Value;

use super::{
    Choice, Which, accept_option, hold, named_folder, output_of, read_settings, round, settings_for,
};
use crate::cli::{ProgressArg, StatusArgs, WatchArgs};
use crate::daemon::child::{self, Limits};
use crate::daemon::{self, JobEvent, JobRequest, Notice, RunJob, WatchSettings};
use crate::output::{print, say};
use crate::server::{Door, Login, Page, Taken};
use crate::service::Folders;
use crate::store::{Disk as _, Log, SystemDisk, led_beside};
use crate::watch::{Completeness, canonical_roots};
use enfilade_config::{Partial, Settings, WatchTable};
use enfilade_overlay::result::to_json;
use enfilade_pipeline::accept::Chosen;
use enfilade_report::{Cancel, Error, Place, Problem, Severity, complain};

/// All jobs together may use this share of the machine's memory unless the settings say otherwise.
#[cfg(target_os = "linux")]
const MEMORY_SHARE: f64 = 0.9;
/// Jobs at once: as many as cores, within these.
const JOBS: [usize; 2] = [2, 4];

pub(super) fn watch(args: &WatchArgs, cancel: &Cancel) -> Result<u8, Error> {
    let partial = args.common.partial(Some(&args.search));
    Settings::new(partial.clone())?;
    canonical_roots(&args.looking.folders, args.looking.force)?;
    let mut said = Said::of(&args.looking.folders)?;
    let settings = watch_settings(args, &partial, said.clone());
    let limits = Arc::new(Mutex::new(limits(&partial, &settings)?));
    let held = Arc::clone(&limits);
    let job = move |request: &JobRequest, tell: &mut dyn FnMut(JobEvent), cancel: &Cancel| {
        let limits = held.lock().unwrap_or_else(PoisonError::into_inner).clone();
        child::run(&limits, request, tell, cancel)
    };
    let mut reread = || {
        let now = Said::of(&args.looking.folders)?;
        if now == said {
            return Ok(None);
        }
        let settings = watch_settings(args, &partial, now.clone());
        *limits.lock().unwrap_or_else(PoisonError::into_inner) = self::limits(&partial, &settings)?;
        said = now;
        Ok(Some(settings))
    };
    let (quiet, json) = (args.common.quiet, args.common.progress == Some(ProgressArg::Json));
    let log = args.log.as_deref().map(open_log).transpose()?;
    let (orders, ordered) = mpsc::channel();
    let accepted = |drawing: &Path, results: &Path, of: Taken, number: usize| {
        let which = match of {
            Taken::Round(n) => Which::Round(n),
            Taken::SoFar(n) => Which::SoFar(Some(n)),
        };
        let choice = Choice { of: which, chosen: Chosen::numbered(number), is_clean: false };
        accept_option(drawing, results, choice).map(|a| a.next)
    };
    let page =
        args.page.map(|port| Page::open(port, login_of(args), orders, Box::new(accepted))).transpose()?;
    if page.is_some() {
        Door::sweep();
    }
    let mut is_page_said = false;
    let mut show = |notice: Notice| {
        if let Some(page) = &page {
            if let Notice::Watching { root, .. } = &notice {
                announce(page, root, !std::mem::replace(&mut is_page_said, true));
            }
            page.take(&notice);
        }
        if args.desktop
            && let Notice::Done { drawing, done } = &notice
            && done.round.is_some()
        {
            let name = drawing.file_name().unwrap_or_default().to_string_lossy();
            crate::service::tell_user(&format!("{name}: options are ready"), &done.summary);
        }
        if let Some(log) = &log
            && !is_for_the_page_alone(&notice)
        {
            // A full disk shows in the jobs; the log is no reason to end.
            let _ = log.line(&format!("{} {notice}", daemon::rfc3339(SystemTime::now())));
        }
        show_notice(&notice, quiet, json);
    };
    unread_tables(&args.looking.folders).into_iter().for_each(&mut show);
    let run: Arc<RunJob> = Arc::new(job);
    match daemon::watch_with_orders(
        &args.looking.folders,
        &settings,
        &mut reread,
        run,
        ordered,
        &mut show,
        cancel,
    ) {
        Err(Error::Stopped) => Ok(Error::Stopped.exit_code()),
        other => other.map(|()| 0),
    }
}

/// Port and key that the page of the first folder had before.
fn login_of(args: &WatchArgs) -> Option<Login> {
    args.looking.folders.first().and_then(|root| Login::of(root))
}

/// Says where the page is, once the folder is ours: a daemon that is turned away must not hide the page of the other.
fn announce(page: &Page, root: &Path, is_first: bool) {
    let written = page.door().write(root).and_then(|()| page.login().write(root));
    if let Err(error) = written {
        complain(format_args!("warning: {error}; `enfilade open` will not find the page"));
    }
    if is_first {
        match page.link() {
            Ok(link) => say(&format!("page: {link}")),
            Err(error) => eprintln!("warning: {error}"),
        }
    }
}

/// The log that the service writes lies in a folder of the program, which is made with all above it.
fn open_log(path: &Path) -> Result<Log, Error> {
    let path = &led_beside(path);
    if let Some(own) = Folders::of_user().ok().filter(|f| f.log() == *path) {
        let place = || Place::file(own.state.to_string_lossy());
        let made = SystemDisk.create_folders(&own.state);
        made.map_err(|e| Error::environment("folder", place(), format!("making failed: {e}")))?;
    }
    Log::open(path)
}

fn is_for_the_page_alone(notice: &Notice) -> bool {
    matches!(
        notice,
        Notice::Progress { .. } | Notice::UpToDate { .. } | Notice::Results { .. } | Notice::Again(_)
    )
}

fn show_notice(notice: &Notice, quiet: bool, json: bool) {
    match notice {
        Notice::Progress { value, .. } if json => complain(value),
        _ if is_for_the_page_alone(notice) => {}
        Notice::Problem { problem, .. } if problem.severity == Severity::Info && !quiet => {
            complain(format_args!("note: {notice}"));
        }
        Notice::Problem { problem, .. } if problem.severity == Severity::Info => {}
        Notice::Failed { .. } | Notice::Problem { .. } => complain(format_args!("warning: {notice}")),
        _ if quiet => {}
        _ => say(&notice.to_string()),
    }
}

/// What `enfilade.toml` of the first watched folder says of the daemon; it holds for all of them.
#[derive(Clone, Debug, Default, PartialEq)]
struct Said {
    table: WatchTable,
    /// Where results go.
    out: Option<String>,
}

impl Said {
    fn of(folders: &[PathBuf]) -> Result<Self, Error> {
        let Some(first) = folders.first() else { return Ok(Self::default()) };
        let read = read_settings(&first.join("enfilade.toml"))?.unwrap_or_default();
        Ok(Self { table: read.watch.unwrap_or_default(), out: read.out })
    }
}

/// Says of which folders the `[watch]` table does not count.
fn unread_tables(folders: &[PathBuf]) -> Vec<Notice> {
    let Some((first, others)) = folders.split_first() else { return Vec::new() };
    let has_table = |file: &PathBuf| {
        read_settings(file).ok().flatten().is_some_and(|p| p.watch.is_some() || p.out.is_some())
    };
    let files = others.iter().map(|f| f.join("enfilade.toml")).filter(has_table);
    let text = format!(
        "what it says of `[watch]` and `out` does not count: that of {}, the first folder, holds for all",
        first.display()
    );
    files
        .map(|path| {
            let place = Place::file(path.to_string_lossy());
            let problem =
                Problem { code: "watch-unread", severity: Severity::Warning, place, text: text.clone() };
            Notice::Problem { path: path.parent().unwrap_or(&path).into(), problem }
        })
        .collect()
}

/// What the command line and the folder's settings say of the daemon.
fn watch_settings(args: &WatchArgs, partial: &Partial, said: Said) -> WatchSettings {
    let (base, table) = (WatchSettings::default(), said.table);
    let out = partial.out.clone().or(said.out);
    let ignore = table.ignore.unwrap_or_default().into_iter().chain(args.looking.ignore.iter().cloned());
    WatchSettings {
        quiet_secs: table.quiet_secs.unwrap_or(base.quiet_secs),
        network_quiet_secs: table.network_quiet_secs.unwrap_or(base.network_quiet_secs),
        grace_secs: table.grace_secs.unwrap_or(base.grace_secs),
        max_wait_secs: table.max_wait_secs.unwrap_or(base.max_wait_secs),
        rescan_secs: table.rescan_secs.unwrap_or(base.rescan_secs),
        poll_secs: table.poll_secs.unwrap_or(base.poll_secs),
        poll: args.looking.poll || table.poll.unwrap_or(base.poll),
        depth: args.looking.depth.or(table.depth).unwrap_or(base.depth),
        ignore: ignore.collect(),
        out_dir: out.as_deref().map(|o| named_folder(Path::new(o))),
        fallback_dir: args
            .looking
            .fallback
            .clone()
            .or(table.fallback.map(PathBuf::from))
            .map(|folder| named_folder(&folder)),
        records_dir: Folders::of_user().ok().map(|own| own.state),
        newest_first: table.newest_first.unwrap_or(base.newest_first),
        force: args.looking.force,
        jobs: table.jobs.unwrap_or_else(|| cores().clamp(JOBS[0], JOBS[1])),
        memory_bytes: table.memory_mb.map(megabytes).or_else(memory_share),
        job_memory_bytes: table.job_memory_mb.map(megabytes),
        read_limit_secs: table.read_limit_secs.unwrap_or(base.read_limit_secs),
        job_limit_secs: table.job_limit_secs.unwrap_or(base.job_limit_secs),
        content_key: enfilade_cad::timeless,
        settings_key: format!("{:?} {out:?}", partial.clone().deciding()),
        end_mark,
        extensions: enfilade_cad::ENDINGS.map(String::from).to_vec(),
        ..base
    }
}

/// The end mark of a drawing's format, for the watcher.
fn end_mark(path: &Path, bytes: &[u8]) -> Completeness {
    match enfilade_cad::is_complete(&path.to_string_lossy(), bytes) {
        enfilade_cad::Completeness::Whole => Completeness::Complete,
        enfilade_cad::Completeness::Incomplete(why) => Completeness::Incomplete(why),
        enfilade_cad::Completeness::Empty => Completeness::Incomplete("it is empty".into()),
    }
}

/// How a job's process is started, and what it may use.
fn limits(partial: &Partial, settings: &WatchSettings) -> Result<Limits, Error> {
    let fail = |e: &dyn std::fmt::Display| Error::environment("job-start", Place::default(), e.to_string());
    // On Linux the program that runs, even where a newer one lies at its path by now.
    let program = if cfg!(target_os = "linux") {
        PathBuf::from("/proc/self/exe")
    } else {
        std::env::current_exe().map_err(|e| fail(&e))?
    };
    Ok(Limits {
        program: program.into(),
        args: ["job-child", "--"].map(OsString::from).to_vec(),
        options: serde_json::to_value(partial).map_err(|e| fail(&e))?,
        memory_bytes: settings.job_memory_bytes.or(settings.memory_bytes),
        read_secs: Some(settings.read_limit_secs),
        cpu_secs: Some((settings.job_limit_secs * cores() as f64).ceil() as u64),
    })
}

fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

fn megabytes(mb: u64) -> u64 {
    mb.saturating_mul(1 << 20)
}

#[cfg(target_os = "linux")]
fn memory_share() -> Option<u64> {
    let info = rustix::system::sysinfo();
    let bytes = info.totalram as f64 * f64::from(info.mem_unit);
    Some((bytes * MEMORY_SHARE) as u64)
}

#[cfg(not(target_os = "linux"))]
fn memory_share() -> Option<u64> {
    None
}

/// One job in a process of its own: see [`child`].
pub(super) fn job_child(drawing: &Path, results: &Path) -> Result<u8, Error> {
    child::serve(drawing, results, |options| {
        let partial: Partial = serde_json::from_value(options)
            .map_err(|e| Error::usage("job-request", Place::default(), e.to_string()))?;
        let job = move |request: &JobRequest, tell: &mut dyn FnMut(JobEvent), cancel: &Cancel| {
            let asked = Partial { objective: request.asked.objective.clone(), ..Partial::default() };
            let mut partial = asked.over(partial.clone());
            hold(&mut partial, &request.results, &request.asked, Which::Newest)?;
            let (settings, _) = settings_for(&request.drawing, partial)?;
            let shown = request.drawing.to_string_lossy().into_owned();
            Ok(output_of(&round(&shown, request, &settings, tell, cancel)?))
        };
        Ok(Arc::new(job) as Arc<RunJob>)
    })?;
    Ok(0)
}

pub(super) fn status(args: &StatusArgs) -> Result<u8, Error> {
    let here = [PathBuf::from(".")];
    let folders = if args.folders.is_empty() { &here[..] } else { &args.folders };
    if let Some(missing) = folders.iter().find(|f| !f.is_dir()) {
        let text = "found no folder there, expected one that is or was watched; nothing was done";
        return Err(Error::usage("no-folder", Place::file(missing.to_string_lossy()), text));
    }
    if let Some((folder, e)) = folders.iter().find_map(|f| std::fs::read_dir(f).err().map(|e| (f, e))) {
        let text =
            format!("cannot be looked into ({e}), so what its daemon does is not known; nothing was done");
        return Err(Error::environment("unreadable", Place::file(folder.to_string_lossy()), text));
    }
    let records = Folders::of_user().ok().map(|own| own.state);
    let found = daemon::status(folders, records.as_deref());
    if args.json {
        print(&to_json(&found)?);
        return Ok(0);
    }
    for (root, folder) in found.iter().zip(folders) {
        let is_running = root["is_running"] == true;
        let runs = if is_running { "watched" } else { "not watched now" };
        say(&format!("{}: {runs}", root["root"].as_str().unwrap_or("?")));
        elsewhere(root, folder).iter().for_each(|state| say(&format!("  its state lies in {state}")));
        root["doubt"].as_str().iter().for_each(|why| say(&format!("  {why}")));
        status_lines(&root["status"], is_running).iter().for_each(|line| say(&format!("  {line}")));
    }
    Ok(0)
}

/// Where the state of a root lies, unless it lies in it.
pub(super) fn elsewhere(found: &Value, root: &Path) -> Option<String> {
    let root = std::fs::canonicalize(root).unwrap_or_else(|_| root.into());
    let state = found["state_folder"].as_str()?;
    (!Path::new(state).starts_with(root)).then(|| state.to_owned())
}

/// The daemon's overview in words: what it works on, what waits, what it waits for and why, what failed.
fn status_lines(status: &Value, is_running: bool) -> Vec<String> {
    let text = |v: &Value| v.as_str().unwrap_or("?").to_owned();
    let list = |key: &str| status[key].as_array().cloned().unwrap_or_default();
    let mut out = Vec::new();
    for root in list("roots").iter().filter(|r| r["is_offline"] == true) {
        out.push(format!("{}: out of reach; waiting for it", text(&root["root"])));
    }
    let running = if is_running { "running" } else { "was running when watching ended; begun again with it" };
    let runs = status["all_running"].as_array().cloned();
    let runs = runs.unwrap_or_else(|| vec![status["running"].clone()]);
    out.extend(runs.iter().filter_map(Value::as_str).map(|d| format!("{d}: {running}")));
    out.extend(list("waiting").iter().map(|d| format!("{}: waiting", text(d))));
    out.extend(beyond(status, "waiting").map(|n| format!("and {n} more waiting")));
    let stopped = list("cancelled").into_iter().map(|d| {
        format!(
            "{}: cancelled; a change of it or of its settings, or another round asked for, takes it up",
            text(&d)
        )
    });
    out.extend(stopped);
    out.extend(beyond(status, "cancelled").map(|n| format!("and {n} more cancelled")));
    for entry in list("failed") {
        let (drawing, problem) = (text(&entry["drawing"]), &entry["problem"]);
        let state = if problem["severity"] == "error" { "failed" } else { "not ready" };
        let place = place_within(&drawing, problem["place"].as_str().unwrap_or_default());
        out.push(format!(
            "{drawing}: {state}: {place}{} ({})",
            text(&problem["text"]),
            text(&problem["code"])
        ));
    }
    out.extend(beyond(status, "failed").map(|n| {
        format!("and {n} more failed or not ready: each has its reason in status.json of its own results")
    }));
    for entry in list("ignored") {
        out.push(format!("{}: left alone: {}", text(&entry["file"]), text(&entry["why"])));
    }
    out.extend(beyond(status, "ignored").map(|n| format!("and {n} more left alone")));
    if let Some(done) = status["done_count"].as_u64() {
        out.push(format!("done since {}: {done}", text(&status["since"])));
    }
    out
}

/// How many more of a kind there are than the overview lists; `None`: none.
fn beyond(status: &Value, kind: &str) -> Option<u64> {
    let listed = status[kind].as_array().map_or(0, Vec::len) as u64;
    let all = status[format!("{kind}_count")].as_u64()?;
    all.checked_sub(listed).filter(|more| *more > 0)
}

/// The place of a problem as the log has it, unless it says no more than the drawing's name does.
fn place_within(drawing: &str, place: &str) -> String {
    let is_drawing = place == drawing || Path::new(drawing).file_name().is_some_and(|n| n == place);
    if place.is_empty() || is_drawing { String::new() } else { format!("{place}: ") }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn status_names_what_runs_waits_and_failed() {
        let problem = |severity: &str, text: &str| json!({"code": "c", "severity": severity, "text": text});
        let status = json!({
            "roots": [{"root": "/w", "is_offline": false}, {"root": "/away", "is_offline": true}],
            "running": "/w/a.dxf", "waiting": ["/w/b.dxf"], "waiting_count": 1, "failed_count": 802, "since": "2026-01-01T00:00:00Z", "done_count": 7,
            "failed": [
                {"drawing": "/w/c.dxf", "problem": problem("error", "no wall")},
                {"drawing": "/w/d.dxf", "problem": problem("info", "no EOF yet")},
            ],
            "cancelled": ["/w/f.dxf"], "cancelled_count": 2,
            "ignored": [{"file": "/w/#e.dxf", "why": "a lock"}],
        });
        let want = [
            "/away: out of reach; waiting for it",
            "/w/a.dxf: running",
            "/w/b.dxf: waiting",
            "/w/f.dxf: cancelled; a change of it or of its settings, or another round asked for, takes it up",
            "and 1 more cancelled",
            "/w/c.dxf: failed: no wall (c)",
            "/w/d.dxf: not ready: no EOF yet (c)",
            "and 800 more failed or not ready: each has its reason in status.json of its own results",
            "/w/#e.dxf: left alone: a lock",
            "done since 2026-01-01T00:00:00Z: 7",
        ];
        assert_eq!(status_lines(&status, true), want);
        assert_eq!(
            status_lines(&status, false)[1],
            "/w/a.dxf: was running when watching ended; begun again with it"
        );
        assert!(status_lines(&Value::Null, false).is_empty());
    }

    #[test]
    fn status_says_where_a_problem_is() {
        let line = |place: &str| {
            let problem = json!({"code": "c", "severity": "error", "place": place, "text": "bad"});
            let failed = json!([{"drawing": "/w/a.dxf", "problem": problem}]);
            status_lines(&json!({"failed": failed}), true).concat()
        };
        assert_eq!(line("enfilade.toml:1"), "/w/a.dxf: failed: enfilade.toml:1: bad (c)");
        assert_eq!(line("a.dxf:595 LINE 2F"), "/w/a.dxf: failed: a.dxf:595 LINE 2F: bad (c)");
        for known in ["", "a.dxf", "/w/a.dxf"] {
            assert_eq!(line(known), "/w/a.dxf: failed: bad (c)", "{known}");
        }
    }

    #[test]
    fn what_is_not_listed_is_counted() {
        let status = |n: u64| json!({"waiting": ["a", "b"], "waiting_count": n});
        assert_eq!(beyond(&status(5), "waiting"), Some(3));
        assert_eq!(beyond(&status(2), "waiting"), None);
        assert_eq!(beyond(&status(0), "waiting"), None);
        assert_eq!(beyond(&json!({"failed": ["a"]}), "failed"), None, "of an earlier version");
    }
}

//! The daemon over real folders, with jobs made up by the tests. Time-outs are generous: they end a
//! test that failed, none waits for one to pass.

mod elsewhere;
mod endings;
mod owners;
mod refusals;
mod renewal;
mod together;

use std::collections::BTreeMap;
use std::fs;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use super::*;
use crate::watch::Completeness;
use enfilade_report::Severity;

const PATIENCE: Duration = Duration::from_secs(900);

/// Short times, and the end mark of a DXF in the simplest words.
fn settings() -> WatchSettings {
    WatchSettings {
        quiet_secs: 0.15,
        grace_secs: 1.0,
        max_wait_secs: 1.0,
        heartbeat_secs: 0.2,
        retry_secs: 0.2,
        end_mark: |_, bytes| {
            if bytes.ends_with(b"EOF\n") {
                Completeness::Complete
            } else {
                Completeness::Incomplete("no EOF".into())
            }
        },
        ..WatchSettings::default()
    }
}

/// The plain job: one candidate that holds the drawing's bytes.
fn echo(request: &JobRequest) -> JobOutput {
    let file = |name: &str, bytes: &[u8]| OutFile { path: name.into(), bytes: bytes.into() };
    let files = vec![file("result.json", request.sha256.as_bytes()), file("candidate-1.dxf", &request.bytes)];
    JobOutput { files, is_degraded: false, summary: "1 candidate".into() }
}

struct Daemon {
    root: PathBuf,
    _dir: tempfile::TempDir,
    stop: Cancel,
    said: Arc<Mutex<Vec<String>>>,
    jobs: Arc<AtomicUsize>,
    orders: mpsc::Sender<Order>,
    thread: Option<JoinHandle<Result<(), Error>>>,
}

impl Daemon {
    fn start(
        settings: WatchSettings,
        prepare: impl FnOnce(&Path),
        run: impl Fn(&JobRequest, &mut dyn FnMut(JobEvent), &Cancel) -> Result<JobOutput, Error>
        + Send
        + Sync
        + 'static,
    ) -> Self {
        Self::start_reading(settings, |_| Ok(None), prepare, run)
    }

    /// One whose own settings can change; they are read from its root.
    fn start_reading(
        settings: WatchSettings,
        reread: impl FnMut(&Path) -> Result<Option<WatchSettings>, Error> + Send + 'static,
        prepare: impl FnOnce(&Path),
        run: impl Fn(&JobRequest, &mut dyn FnMut(JobEvent), &Cancel) -> Result<JobOutput, Error>
        + Send
        + Sync
        + 'static,
    ) -> Self {
        let dir = tempfile::tempdir().unwrap();
        let root = fs::canonicalize(dir.path()).unwrap().join("w");
        fs::create_dir(&root).unwrap();
        prepare(&root);
        Self::start_at(dir, root, settings, reread, run)
    }

    /// One on a root that is there; `dir` goes with it.
    fn start_at(
        dir: tempfile::TempDir,
        root: PathBuf,
        settings: WatchSettings,
        mut reread: impl FnMut(&Path) -> Result<Option<WatchSettings>, Error> + Send + 'static,
        run: impl Fn(&JobRequest, &mut dyn FnMut(JobEvent), &Cancel) -> Result<JobOutput, Error>
        + Send
        + Sync
        + 'static,
    ) -> Self {
        let (stop, said, jobs) =
            (Cancel::default(), Arc::new(Mutex::new(Vec::new())), Arc::new(AtomicUsize::new(0)));
        let count = jobs.clone();
        let run: Arc<RunJob> =
            Arc::new(move |request: &JobRequest, tell: &mut dyn FnMut(JobEvent), cancel: &Cancel| {
                count.fetch_add(1, Ordering::SeqCst);
                run(request, tell, cancel)
            });
        let (roots, words, stopping) = ([root.clone()], said.clone(), stop.clone());
        let (orders, ordered) = mpsc::channel();
        let thread = thread::spawn(move || {
            let mut show = |notice: Notice| words.lock().unwrap().push(format!("{notice:?}"));
            let mut reread = || reread(&roots[0]);
            watch_with_orders(&roots, &settings, &mut reread, run, ordered, &mut show, &stopping)
        });
        let daemon = Self { root, _dir: dir, stop, said, jobs, orders, thread: Some(thread) };
        daemon.await_said("Watching", 1);
        daemon
    }

    fn echo() -> Self {
        Self::start(settings(), |_| {}, |request, _, _| Ok(echo(request)))
    }

    fn path(&self, name: &str) -> PathBuf {
        self.root.join(name)
    }

    fn save(&self, name: &str, text: &str) {
        fs::write(self.path(name), format!("{text} EOF\n")).unwrap();
    }

    fn count_said(&self, word: &str) -> usize {
        self.said.lock().unwrap().iter().filter(|s| s.contains(word)).count()
    }

    fn await_said(&self, word: &str, count: usize) {
        self.await_true(word, || self.count_said(word) >= count);
    }

    fn await_true(&self, what: &str, is_so: impl Fn() -> bool) {
        let start = Instant::now();
        while !is_so() {
            assert!(start.elapsed() < PATIENCE, "never: {what}; said {:#?}", self.said.lock().unwrap());
            assert!(!self.thread.as_ref().unwrap().is_finished(), "the daemon died: {what}");
            thread::sleep(Duration::from_millis(20));
        }
    }

    /// So many jobs have read their drawings: a job is said to have started before that, and what is saved in
    /// between takes its place.
    fn await_jobs(&self, count: usize) {
        self.await_true("the job", || self.jobs() >= count);
    }

    /// The result of a round, once it is there.
    fn await_round(&self, drawing: &str, round: u32) -> String {
        let path = self.path(&format!("{drawing}.enfilade/round-{round:02}/candidate-1.dxf"));
        self.await_true(&path.display().to_string(), || path.exists());
        fs::read_to_string(path).unwrap()
    }

    fn status(&self, drawing: &str) -> Value {
        let path = self.path(&format!("{drawing}.enfilade/status.json"));
        fs::read(path).ok().and_then(|b| serde_json::from_slice(&b).ok()).unwrap_or_default()
    }

    fn await_state(&self, drawing: &str, state: &str) -> Value {
        self.await_true(&format!("{drawing} {state}"), || self.status(drawing)["state"] == state);
        self.status(drawing)
    }

    /// Long enough for a save to become a job, many times over.
    fn rest(&self) {
        thread::sleep(Duration::from_millis(1200));
    }

    /// Waits for a job that outlived its daemon, and a little longer for what it might still do.
    fn await_dead_job(&self, is_over: impl Fn() -> bool) {
        let start = Instant::now();
        while !is_over() && start.elapsed() < PATIENCE {
            thread::sleep(Duration::from_millis(5));
        }
        thread::sleep(Duration::from_millis(300));
    }

    fn jobs(&self) -> usize {
        self.jobs.load(Ordering::SeqCst)
    }

    fn stop(mut self) -> Error {
        self.stop.stop();
        self.thread.take().unwrap().join().unwrap().unwrap_err()
    }
}

impl Drop for Daemon {
    fn drop(&mut self) {
        self.stop.stop();
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

/// Works until cancelled where the drawing says so.
fn slow(request: &JobRequest, cancel: &Cancel) -> Result<JobOutput, Error> {
    while request.bytes.starts_with(b"slow") {
        cancel.check()?;
        thread::sleep(Duration::from_millis(5));
    }
    Ok(echo(request))
}

#[test]
fn a_save_becomes_a_round() {
    let daemon = Daemon::echo();
    daemon.save("plan.dxf", "one");
    assert_eq!(daemon.await_round("plan", 1), "one EOF\n");
    let status = daemon.await_state("plan", "done");
    assert_eq!((status["round"].as_str(), status["drawing"].as_str()), (Some("round-01"), Some("plan.dxf")));
    daemon.save("plan.dxf", "two");
    assert_eq!(daemon.await_round("plan", 2), "two EOF\n");
    assert_eq!(fs::read_to_string(daemon.path("plan.dxf")).unwrap(), "two EOF\n");
    assert!(matches!(daemon.stop(), Error::Stopped));
}

/// Hazard 1: cut at every byte, the file is no job; whole, it is one.
#[test]
fn half_written_files_wait() {
    let daemon = Daemon::echo();
    let whole = b"0 SECTION 0 EOF\n";
    for cut in 0..whole.len() {
        fs::write(daemon.path(&format!("cut-{cut}.dxf")), &whole[..cut]).unwrap();
    }
    daemon.await_said("still-incomplete", whole.len());
    assert_eq!(daemon.jobs(), 0);
    assert_eq!(daemon.status("cut-3")["problems"][0]["code"], "still-incomplete");
    fs::write(daemon.path("cut-3.dxf"), whole).unwrap();
    daemon.await_round("cut-3", 1);
    daemon.rest();
    assert_eq!(daemon.jobs(), 1);
}

/// Hazards 3 and 4.
#[test]
fn rename_saves_are_seen_and_cancel_nothing_by_vanishing() {
    let daemon = Daemon::start(settings(), |_| {}, |request, _, cancel| slow(request, cancel));
    daemon.save("plan.dxf", "slow");
    daemon.await_jobs(1);
    fs::rename(daemon.path("plan.dxf"), daemon.path("plan.bak")).unwrap();
    thread::sleep(Duration::from_millis(400));
    assert_eq!(daemon.count_said("Stopped"), 0);
    daemon.save("sav123.tmp", "new");
    fs::rename(daemon.path("sav123.tmp"), daemon.path("plan.dxf")).unwrap();
    assert_eq!(daemon.await_round("plan", 1), "new EOF\n");
    assert_eq!((daemon.jobs(), daemon.count_said("Stopped {")), (2, 1));
    assert_eq!(daemon.count_said("a newer save, or other settings, take its place"), 1);
}

/// Hazards 1 and 27: what is saved over a drawing while its job runs, and is not whole, ends no job; but whose results
/// they are is said at once, at the end, and in the status, until the rest comes.
#[test]
fn results_say_that_the_drawing_has_changed_since() {
    let go_on = Cancel::default();
    let may_end = go_on.clone();
    let job = move |request: &JobRequest, _: &mut dyn FnMut(JobEvent), cancel: &Cancel| {
        while request.bytes.starts_with(b"one") && !may_end.is_stopped() {
            cancel.check()?;
            thread::sleep(Duration::from_millis(5));
        }
        Ok(echo(request))
    };
    let daemon = Daemon::start(settings(), |_| {}, job);
    daemon.save("plan.dxf", "one");
    daemon.await_jobs(1);
    fs::write(daemon.path("plan.dxf"), "two, and its end is miss").unwrap();
    daemon.await_said("the job that runs is of the content before", 2);
    go_on.stop();
    assert_eq!(daemon.await_round("plan", 1), "one EOF\n");
    daemon.await_said("results-of-earlier-content", 1);
    let status = daemon.await_state("plan", "done");
    assert_eq!(status["problems"][0]["code"], "results-of-earlier-content", "{status}");
    assert_eq!(
        (status["round"].as_str(), status["summary"].as_str()),
        (Some("round-01"), Some("1 candidate"))
    );
    daemon.save("plan.dxf", "two");
    assert_eq!(daemon.await_round("plan", 2), "two EOF\n");
    daemon.await_true("no problem", || daemon.status("plan")["problems"] == serde_json::json!([]));
}

/// Nothing of a name is obeyed by a terminal, and no name looks like more lines.
#[test]
fn notices_show_names_and_obey_none() {
    let drawing = PathBuf::from("a\nb\u{1b}[31m\u{202e}c.dxf");
    let problem = Problem {
        code: "c",
        severity: Severity::Warning,
        place: Place::file(drawing.to_string_lossy()),
        text: "line one\nline two \u{7}".into(),
    };
    let notices = [
        Notice::Started(drawing.clone()),
        Notice::Stopped { drawing: drawing.clone(), why: "w" },
        Notice::Failed { drawing: drawing.clone(), problem: problem.clone(), retry_secs: None },
        Notice::Problem { path: drawing, problem },
    ];
    for notice in notices {
        let text = notice.to_string();
        assert!(text.contains(r"a\nb\u{1b}[31m\u{202e}c.dxf"), "{text}");
        assert!(!text.contains(['\u{1b}', '\u{202e}', '\u{7}']), "{text}");
    }
}

/// Hazard 27: only the last content gets a full job, and nothing stale is published.
#[test]
fn a_save_storm_ends_in_one_full_job() {
    let daemon = Daemon::start(settings(), |_| {}, |request, _, cancel| slow(request, cancel));
    for i in 0..10 {
        daemon.save("plan.dxf", &format!("slow {i}"));
        thread::sleep(Duration::from_millis(if i % 2 == 0 { 60 } else { 500 }));
    }
    daemon.save("plan.dxf", "last");
    assert_eq!(daemon.await_round("plan", 1), "last EOF\n");
    daemon.rest();
    assert_eq!(daemon.count_said("Done {"), 1);
    assert!(!daemon.path("plan.enfilade/round-02").exists());
}

/// The last finished result stays until the new one is whole; early results come before the end.
#[test]
fn early_results_appear_while_the_job_runs() {
    let daemon = Daemon::start(
        settings(),
        |_| {},
        |request, tell, cancel| {
            tell(JobEvent::Progress(serde_json::json!({"stage": "measure", "done": 1, "total": 2})));
            tell(JobEvent::Analysis(vec![OutFile {
                path: "initial.png".into(),
                bytes: request.bytes.to_vec(),
            }]));
            slow(request, cancel)
        },
    );
    daemon.save("plan.dxf", "slow");
    let early = daemon.path("plan.enfilade/analysis/initial.png");
    daemon.await_true("early results", || early.exists());
    let status = daemon.await_state("plan", "running");
    assert_eq!((status["stage"].as_str(), status["total"].as_u64()), (Some("measure"), Some(2)));
    daemon.save("plan.dxf", "quick");
    daemon.await_round("plan", 1);
    assert_eq!(fs::read_to_string(early).unwrap(), "quick EOF\n");
}

/// Hazard 6.
#[test]
fn own_outputs_start_no_job_but_a_renamed_candidate_does() {
    let daemon = Daemon::echo();
    daemon.save("plan.dxf", "one");
    daemon.await_round("plan", 1);
    daemon.await_said("Done {", 1);
    let candidate = daemon.path("plan.enfilade/round-01/candidate-1.dxf");
    fs::copy(&candidate, daemon.path("candidate-1.dxf")).unwrap();
    daemon.await_said("copy of a result of ours", 1);
    assert_eq!(daemon.jobs(), 1);
    fs::copy(&candidate, daemon.path("plan2.dxf")).unwrap();
    daemon.await_round("plan2", 1);
    daemon.save("candidate-1.dxf", "a drawing of the architect's own");
    daemon.await_round("candidate-1", 1);
    daemon.rest();
    assert_eq!(daemon.jobs(), 3);
}

/// Hazards 7 and 28.
#[test]
fn known_content_is_not_worked_on_again() {
    let daemon = Daemon::echo();
    daemon.save("plan.dxf", "one");
    daemon.await_said("Done {", 1);
    for _ in 0..10 {
        daemon.save("plan.dxf", "one");
        thread::sleep(Duration::from_millis(40));
    }
    fs::remove_dir_all(daemon.path("plan.enfilade/round-01")).unwrap();
    daemon.rest();
    assert_eq!(daemon.jobs(), 1);
    fs::write(daemon.path("plan.enfilade.toml"), b"seed = 2\n").unwrap();
    daemon.await_said("Done {", 2);
}

#[test]
fn a_failing_and_a_panicking_job_stop_nobody() {
    let daemon = Daemon::start(
        settings(),
        |_| {},
        |request, _, _| {
            if request.bytes.starts_with(b"panic") {
                panic!("wall 7 is inside out");
            }
            if request.bytes.starts_with(b"bad") {
                return Err(Error::input(
                    "dxf-bad-number",
                    Place::line("b.dxf", 57),
                    "found x, expected a number",
                ));
            }
            Ok(echo(request))
        },
    );
    daemon.save("a.dxf", "panic");
    daemon.save("b.dxf", "bad");
    daemon.save("c.dxf", "good");
    daemon.await_round("c", 1);
    let status = daemon.await_state("a", "failed");
    assert_eq!(status["problems"][0]["code"], "job-panicked");
    assert!(status["problems"][0]["text"].as_str().unwrap().contains("wall 7 is inside out"));
    assert_eq!(daemon.await_state("b", "failed")["problems"][0]["place"], "b.dxf:57");
    daemon.save("a.dxf", "mended");
    daemon.await_round("a", 1);
    assert_eq!(daemon.jobs(), 4);
}

/// Hazard 23.
#[test]
fn a_job_that_hangs_is_left_behind() {
    let settings = WatchSettings { job_limit_secs: 0.5, ..settings() };
    let daemon = Daemon::start(
        settings,
        |_| {},
        |request, _, cancel| {
            if request.bytes.starts_with(b"deaf") {
                thread::sleep(Duration::from_secs(20));
            }
            slow(request, cancel)
        },
    );
    daemon.save("a.dxf", "deaf");
    daemon.await_jobs(1);
    daemon.save("b.dxf", "slow");
    daemon.save("c.dxf", "good");
    daemon.await_round("c", 1);
    assert_eq!(daemon.await_state("a", "failed")["problems"][0]["code"], "job-hung");
    assert_eq!(daemon.await_state("b", "failed")["problems"][0]["code"], "job-too-long");
}

/// Hazard 11: the root is deleted and made again.
#[test]
fn a_root_made_again_is_watched_again() {
    let daemon = Daemon::echo();
    daemon.save("plan.dxf", "one");
    daemon.await_said("Done {", 1);
    fs::remove_dir_all(&daemon.root).unwrap();
    daemon.await_said("Offline", 1);
    assert!(!daemon.root.exists(), "a root that went away is not brought back by us");
    fs::create_dir(&daemon.root).unwrap();
    daemon.await_said("Online", 1);
    daemon.save("plan.dxf", "two");
    assert_eq!(daemon.await_round("plan", 1), "two EOF\n");
}

/// Hazard 11: the drive returns with everything on it: nothing is done twice.
#[test]
fn a_root_that_returns_is_not_worked_on_again() {
    let daemon = Daemon::echo();
    daemon.save("plan.dxf", "one");
    daemon.await_said("Done {", 1);
    let away = daemon.root.with_extension("away");
    fs::rename(&daemon.root, &away).unwrap();
    daemon.await_said("Offline", 1);
    fs::rename(&away, &daemon.root).unwrap();
    daemon.await_said("Online", 1);
    daemon.save("new.dxf", "two");
    daemon.await_round("new", 1);
    daemon.rest();
    assert_eq!(daemon.jobs(), 2);
}

/// Hazard 21.
#[test]
fn the_second_daemon_is_turned_away() {
    let daemon = Daemon::echo();
    let run: Arc<RunJob> =
        Arc::new(|request: &JobRequest, _: &mut dyn FnMut(JobEvent), _: &Cancel| Ok(echo(request)));
    let second = watch(std::slice::from_ref(&daemon.root), &settings(), run, &mut |_| {}, &Cancel::default());
    let problem = second.unwrap_err().problem().unwrap().clone();
    assert_eq!((problem.code, problem.severity), ("folder-owned", Severity::Error));
    assert!(problem.text.contains(&std::process::id().to_string()), "{problem}");
    let told = status(std::slice::from_ref(&daemon.root), None);
    assert_eq!(told[0]["is_running"], true);
}

/// A stop is answered at once and leaves nothing half-written; the next start finishes the job.
#[test]
fn stopped_jobs_are_finished_by_the_next_start() {
    let daemon = Daemon::start(settings(), |_| {}, |request, _, cancel| slow(request, cancel));
    daemon.save("plan.dxf", "slow");
    daemon.await_jobs(1);
    daemon.stop.stop();
    daemon.await_true("stop", || daemon.count_said("Stopped") == 1);
    while daemon.thread.as_ref().is_some_and(|t| !t.is_finished()) {
        thread::sleep(Duration::from_millis(5));
    }
    assert_eq!(daemon.status("plan")["state"], "stopped");
    let jobs = Arc::new(AtomicUsize::new(0));
    let (count, stop) = (jobs.clone(), Cancel::default());
    let run: Arc<RunJob> = Arc::new(move |request: &JobRequest, _: &mut dyn FnMut(JobEvent), _: &Cancel| {
        count.fetch_add(1, Ordering::SeqCst);
        Ok(echo(request))
    });
    for _ in 0..2 {
        let stop = stop.clone();
        let mut show = |notice: Notice| {
            if matches!(notice, Notice::Done { .. }) {
                stop.stop()
            }
        };
        let once = Cancel::default();
        let (late, root) = (once.clone(), daemon.root.clone());
        let (run, settings) = (run.clone(), settings());
        let waiter = thread::spawn({
            let stop = stop.clone();
            move || {
                let start = Instant::now();
                while !stop.is_stopped() && start.elapsed() < PATIENCE {
                    thread::sleep(Duration::from_millis(10));
                }
                thread::sleep(Duration::from_millis(700));
                late.stop();
            }
        });
        let _ = watch(&[root], &settings, run, &mut show, &once);
        waiter.join().unwrap();
    }
    assert_eq!(jobs.load(Ordering::SeqCst), 1, "finished once by the second start, known to the third");
    assert!(daemon.path("plan.enfilade/round-01").exists());
}

/// A stop waits for no job that does not listen, and nothing of it is published afterwards.
#[test]
fn a_stop_does_not_wait_for_a_deaf_job() {
    let go_on = Arc::new(AtomicUsize::new(0));
    let gate = go_on.clone();
    let daemon = Daemon::start(
        settings(),
        |_| {},
        move |request, _, _| {
            while gate.load(Ordering::SeqCst) == 0 {
                thread::sleep(Duration::from_millis(5));
            }
            gate.fetch_add(1, Ordering::SeqCst);
            Ok(echo(request))
        },
    );
    daemon.save("plan.dxf", "deaf");
    daemon.await_jobs(1);
    let (root, start) = (daemon.root.clone(), Instant::now());
    daemon.stop.stop();
    while daemon.thread.as_ref().is_some_and(|t| !t.is_finished()) {
        assert!(start.elapsed() < PATIENCE, "the daemon waits for a deaf job");
        thread::sleep(Duration::from_millis(1));
    }
    println!("left after {:?}", start.elapsed());
    go_on.store(1, Ordering::SeqCst);
    daemon.await_dead_job(|| go_on.load(Ordering::SeqCst) > 1);
    assert!(!root.join("plan.enfilade/round-01").exists());
    assert_eq!(daemon.status("plan")["state"], "stopped");
}

/// Hazard 10: the same without any events.
#[test]
fn polling_does_the_same() {
    let settings = WatchSettings { poll: true, poll_secs: 0.2, ..settings() };
    let daemon = Daemon::start(settings, |_| {}, |request, _, _| Ok(echo(request)));
    daemon.save("plan.dxf", "one");
    daemon.await_round("plan", 1);
    daemon.save("plan.dxf", "two");
    assert_eq!(daemon.await_round("plan", 2), "two EOF\n");
}

/// Hazard 26: many at once: all done, in order, and the waiting ones say so.
#[test]
fn a_bulk_drop_is_done_in_order() {
    let order = Arc::new(Mutex::new(Vec::new()));
    let seen = order.clone();
    let daemon = Daemon::start(
        settings(),
        |root| {
            for i in 0..200 {
                fs::write(root.join(format!("p{i:03}.dxf")), format!("{i} EOF\n")).unwrap();
            }
        },
        move |request, _, _| {
            seen.lock().unwrap().push(request.drawing.clone());
            Ok(JobOutput { summary: "measured".into(), ..JobOutput::default() })
        },
    );
    daemon.await_said("Done {", 200);
    let order = order.lock().unwrap();
    assert!(order.is_sorted(), "{order:?}");
    assert_eq!(daemon.jobs(), 200);
}

/// Hazard 9: drawings that come while the daemon starts.
#[test]
fn files_made_during_the_start_are_found() {
    for _ in 0..5 {
        let daemon = Daemon::start(
            settings(),
            |root| {
                let path = root.join("plan.dxf");
                thread::spawn(move || fs::write(path, "one EOF\n").unwrap());
            },
            |request, _, _| Ok(echo(request)),
        );
        daemon.await_round("plan", 1);
    }
}

#[test]
fn subfolders_to_a_depth() {
    let settings = WatchSettings { depth: 2, ..settings() };
    let daemon = Daemon::start(settings, |_| {}, |request, _, _| Ok(echo(request)));
    fs::create_dir_all(daemon.path("a/b/c")).unwrap();
    for folder in ["", "a/", "a/b/", "a/b/c/"] {
        daemon.save(&format!("{folder}plan.dxf"), folder);
    }
    for folder in ["", "a/", "a/b/"] {
        daemon.await_round(&format!("{folder}plan"), 1);
    }
    daemon.rest();
    assert_eq!(daemon.jobs(), 3);
}

#[test]
fn results_elsewhere() {
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("out");
    let settings = WatchSettings { depth: 1, out_dir: Some(out.clone()), ..settings() };
    let daemon = Daemon::start(settings, |_| {}, |request, _, _| Ok(echo(request)));
    fs::create_dir(daemon.path("sub")).unwrap();
    daemon.save("plan.dxf", "a");
    daemon.save("sub/plan.dxf", "b");
    let both = [out.join("plan.enfilade/round-01"), out.join("sub/plan.enfilade/round-01")];
    daemon.await_true("both", || both.iter().all(|p| p.exists()));
    assert!(!daemon.path("plan.enfilade").exists());
}

#[test]
fn run_once_publishes_the_same_way() {
    let dir = tempfile::tempdir().unwrap();
    let drawing = dir.path().join("plan.dxf");
    let run = |request: &JobRequest, _: &mut dyn FnMut(JobEvent), _: &Cancel| {
        if request.bytes.starts_with(b"panic") { panic!("no") } else { Ok(echo(request)) }
    };
    let once = |stop: &Cancel| run_once(&drawing, &settings(), &run, &mut |_| {}, stop);
    assert_eq!(once(&Cancel::default()).unwrap_err().problem().unwrap().code, "no-such-file");
    fs::write(&drawing, b"one EOF\n").unwrap();
    let done = once(&Cancel::default()).unwrap();
    assert_eq!((done.round, done.summary.as_str()), (Some(1), "1 candidate"));
    assert_eq!(done.folder, dir.path().join("plan.enfilade/round-01"));
    assert_eq!(once(&Cancel::default()).unwrap().round, Some(2));
    let stopped = Cancel::default();
    stopped.stop();
    assert!(matches!(once(&stopped), Err(Error::Stopped)));
    fs::write(&drawing, b"panic").unwrap();
    assert_eq!(once(&Cancel::default()).unwrap_err().problem().unwrap().code, "job-panicked");
    let status: Value =
        serde_json::from_slice(&fs::read(dir.path().join("plan.enfilade/status.json")).unwrap()).unwrap();
    assert_eq!(status["state"], "failed");
    let rounds: BTreeMap<_, _> = fs::read_dir(dir.path().join("plan.enfilade"))
        .unwrap()
        .map(|e| e.unwrap())
        .map(|e| (e.file_name().into_string().unwrap(), ()))
        .filter(|(n, ())| !n.starts_with(".drawing") && !n.starts_with(".lock"))
        .collect();
    assert_eq!(rounds.into_keys().collect::<Vec<_>>(), ["round-01", "round-02", "status.json"]);
}

/// What is found so far is whole at any moment; the finished round takes its place, a stop leaves it.
#[test]
fn what_is_found_so_far_stands_until_the_round_does() {
    let dir = tempfile::tempdir().unwrap();
    let drawing = dir.path().join("plan.dxf");
    fs::write(&drawing, b"one EOF\n").unwrap();
    let so_far = dir.path().join("plan.enfilade/so-far");
    let stop = Cancel::default();
    let (folder, stopping) = (so_far.clone(), stop.clone());
    let run = move |request: &JobRequest, tell: &mut dyn FnMut(JobEvent), cancel: &Cancel| {
        for text in ["first", "second"] {
            let files = vec![OutFile { path: "result.json".into(), bytes: text.into() }];
            tell(JobEvent::SoFar { files, progress: serde_json::json!({"stage": "so-far", "done": 7}) });
            assert_eq!(fs::read_to_string(folder.join("result.json")).unwrap(), text);
        }
        if request.bytes.starts_with(b"stop") {
            stopping.stop();
        }
        cancel.check()?;
        Ok(echo(request))
    };
    let told = std::cell::RefCell::new(Vec::new());
    let mut show = |notice: Notice| {
        if let Notice::Progress { value, .. } = notice {
            told.borrow_mut().push(value);
        }
    };
    run_once(&drawing, &settings(), &run, &mut show, &stop).unwrap();
    assert!(dir.path().join("plan.enfilade/round-01").is_dir() && !so_far.exists());
    let last = told.borrow().last().cloned().unwrap();
    assert_eq!(last["folder"].as_str().map(PathBuf::from), Some(so_far.clone()));
    fs::write(&drawing, b"stop EOF\n").unwrap();
    assert!(matches!(run_once(&drawing, &settings(), &run, &mut |_| {}, &stop), Err(Error::Stopped)));
    assert!(so_far.join("result.json").is_file(), "the best so far outlives a stop");
}

/// A job that does not look at the stop request is left behind: its status says so all the same.
#[test]
fn a_stop_is_told_before_the_job_ends() {
    let dir = tempfile::tempdir().unwrap();
    let drawing = dir.path().join("plan.dxf");
    fs::write(&drawing, b"one EOF\n").unwrap();
    let status = dir.path().join("plan.enfilade/status.json");
    let state = move || -> Value {
        let text = fs::read(&status).unwrap_or_default();
        serde_json::from_slice::<Value>(&text).unwrap_or_default()["state"].clone()
    };
    let run = move |_: &JobRequest, tell: &mut dyn FnMut(JobEvent), cancel: &Cancel| {
        assert_eq!(state(), "running");
        cancel.stop();
        let begun = Instant::now();
        while state() != "stopped" && begun.elapsed() < PATIENCE {
            thread::sleep(Duration::from_millis(5));
        }
        tell(JobEvent::Progress(serde_json::json!({"stage": "late"})));
        assert_eq!(state(), "stopped");
        Err(Error::Stopped)
    };
    let done = run_once(&drawing, &settings(), &run, &mut |_| {}, &Cancel::default());
    assert!(matches!(done, Err(Error::Stopped)), "{done:?}");
}

/// Hazard 17: whatever a name is, its drawing gets its results, and the journal knows it again.
#[cfg(unix)]
#[test]
fn hostile_names() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;
    let long = format!("{}.dxf", "\u{e4}".repeat(125));
    let names: Vec<&[u8]> = vec![
        b"a\nb.dxf",
        b"-x.dxf",
        b"a;b.dxf",
        b"CON.dxf",
        b"b.dxf",
        b"B.dxf",
        b"bad\xff\xfe.dxf",
        long.as_bytes(),
        "e\u{301}.dxf".as_bytes(),
        "\u{e9}.dxf".as_bytes(),
        "\u{202e}fxd.dxf".as_bytes(),
        " .dxf".as_bytes(),
        "$(touch x).dxf".as_bytes(),
        "<img onerror>.dxf".as_bytes(),
        "\u{1f3db}.dxf".as_bytes(),
    ];
    let daemon = Daemon::start(settings(), |_| {}, |request, _, _| Ok(echo(request)));
    for name in &names {
        fs::write(daemon.path("").join(OsStr::from_bytes(name)), b"one EOF\n").unwrap();
    }
    daemon.await_said("Done {", names.len());
    let homes = fs::read_dir(&daemon.root).unwrap().map(|e| e.unwrap().path());
    let homes: Vec<PathBuf> = homes.filter(|p| p.join("round-01/candidate-1.dxf").exists()).collect();
    assert_eq!(homes.len(), names.len());
    for home in homes {
        let status: Value = serde_json::from_slice(&fs::read(home.join("status.json")).unwrap()).unwrap();
        assert_eq!(status["state"], "done");
    }
    daemon.rest();
    assert_eq!(daemon.jobs(), names.len());
}

/// Somebody planted a link where results would go: refused with words, the next drawing goes on.
#[cfg(unix)]
#[test]
fn planted_links_are_refused() {
    let elsewhere = tempfile::tempdir().unwrap();
    let target = elsewhere.path().to_path_buf();
    let settings = WatchSettings { retry_secs: 600.0, ..settings() };
    let plant = move |root: &Path| std::os::unix::fs::symlink(&target, root.join("a.enfilade")).unwrap();
    let daemon = Daemon::start(settings, plant, |request, _, _| Ok(echo(request)));
    daemon.save("a.dxf", "one");
    daemon.save("b.dxf", "two");
    daemon.await_round("b", 1);
    daemon.await_said("output-is-link", 1);
    assert_eq!(fs::read_dir(elsewhere.path()).unwrap().count(), 0);
}

//! A daemon in a process of its own, killed at any instant: what it leaves is whole, and the next start
//! finishes the work (contract P4, P6).
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::Arc;
use std::thread;
use std::time::{Duration, Instant};

use enfilade::daemon::{JobEvent, JobOutput, JobRequest, Notice, OutFile, RunJob, WatchSettings, watch};
use enfilade::watch::Completeness;
use enfilade_report::{Cancel, Error};
use rand::{RngExt, SeedableRng};

/// Names the folder to watch; without it the child's test does nothing.
const CHILD: &str = "ENFILADE_TEST_CHILD";
const DRAWINGS: usize = 12;
const KILLS: usize = 40;
const PATIENCE: Duration = Duration::from_secs(900);

fn settings() -> WatchSettings {
    WatchSettings {
        quiet_secs: 0.02,
        heartbeat_secs: 1.0,
        depth: 2,
        end_mark: |_, bytes| {
            if bytes.ends_with(b"EOF\n") {
                Completeness::Complete
            } else {
                Completeness::Incomplete("EOF".into())
            }
        },
        ..WatchSettings::default()
    }
}

/// A disk that is full at the start is waited for: a limit on the size of files, lifted while the daemon runs.
#[cfg(target_os = "linux")]
#[test]
fn a_disk_full_from_the_start_is_waited_for() {
    use std::io::{BufRead, BufReader};
    let dir = tempfile::tempdir().unwrap();
    let root = dir.path().join("w");
    fs::create_dir(&root).unwrap();
    fs::write(root.join("broken.dxf"), "no drawing\n  0\nEOF\n").unwrap();
    let mut watcher = Command::new("sh")
        .args(["-c", "ulimit -S -f 0; exec \"$0\" watch \"$1\" 2>&1", env!("CARGO_BIN_EXE_enfilade")])
        .arg(&root)
        .env("HOME", dir.path())
        .env("XDG_STATE_HOME", dir.path().join("state"))
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let pid = watcher.id().to_string();
    // One that never says what is waited for is ended, so that this test fails instead of waiting for ever.
    let (over, is_over) = std::sync::mpsc::channel::<()>();
    let late = pid.clone();
    let patience = thread::spawn(move || {
        if is_over.recv_timeout(PATIENCE) == Err(std::sync::mpsc::RecvTimeoutError::Timeout) {
            let _ = Command::new("kill").args(["-9", &late]).status();
        }
    });
    let mut lines = BufReader::new(watcher.stdout.take().unwrap()).lines();
    let mut until = |word: &str| lines.find_map(|l| l.ok().filter(|l| l.contains(word)));
    let full = until("free some space");
    let lift = Command::new("prlimit").args(["--pid", &pid, "--fsize=unlimited:unlimited"]).status().unwrap();
    let taken = until("its state can be kept by now");
    let worked_on = until("broken.dxf");
    drop(over);
    let _ = watcher.kill();
    watcher.wait().unwrap();
    patience.join().unwrap();
    assert!(full.is_some() && lift.success(), "{full:?} {lift:?}");
    assert!(taken.is_some() && worked_on.is_some(), "{taken:?} {worked_on:?}");
}

/// A set whose every file is told from every other's, large enough to be caught half-written.
fn files(request_sha256: &str, what: &str, count: usize) -> Vec<OutFile> {
    let file = |i: usize| OutFile {
        path: format!("candidate-{i}.dxf").into(),
        bytes: format!("{what} {i} {request_sha256}\n").repeat(500).into_bytes(),
    };
    (0..count).map(file).collect()
}

fn job(request: &JobRequest, tell: &mut dyn FnMut(JobEvent), cancel: &Cancel) -> Result<JobOutput, Error> {
    tell(JobEvent::Analysis(files(&request.sha256, "early", 3)));
    for done in 0..5 {
        tell(JobEvent::Progress(serde_json::json!({"stage": "search", "done": done, "total": 5})));
        thread::sleep(Duration::from_millis(5));
        cancel.check()?;
    }
    Ok(JobOutput { files: files(&request.sha256, "final", 8), is_degraded: false, summary: "8".into() })
}

/// The child: watches until it is killed. As a test of its own it passes at once.
#[test]
fn child() {
    let Some(root) = std::env::var_os(CHILD) else { return };
    let run: Arc<RunJob> = Arc::new(job);
    let mut show = |notice: Notice| println!("{notice}");
    let end = watch(&[PathBuf::from(root)], &settings(), run, &mut show, &Cancel::default());
    println!("{end:?}");
}

fn start_child(root: &Path) -> Child {
    Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "daemon::child", "--nocapture"])
        .env(CHILD, root)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap()
}

/// The visible folders of a drawing's results with the bytes of their files.
fn sets(home: &Path) -> BTreeMap<String, BTreeMap<PathBuf, Vec<u8>>> {
    let Ok(entries) = fs::read_dir(home) else { return BTreeMap::new() };
    let folders = entries.map(|e| e.unwrap().path()).filter(|p| p.is_dir());
    let name = |p: &Path| p.file_name().unwrap().to_str().unwrap().to_owned();
    let content = |folder: &Path| {
        let files = fs::read_dir(folder).unwrap().map(|e| e.unwrap().path());
        files.map(|p| (p.file_name().unwrap().into(), fs::read(&p).unwrap())).collect()
    };
    folders.map(|p| (name(&p), content(&p))).filter(|(n, _)| !n.starts_with('.')).collect()
}

fn as_set(files: Vec<OutFile>) -> BTreeMap<PathBuf, Vec<u8>> {
    files.into_iter().map(|f| (f.path, f.bytes)).collect()
}

fn sha256(bytes: &[u8]) -> String {
    enfilade::watch::sha256_hex(bytes)
}

/// Whatever is visible is whole and right; whether all of it is there.
fn check(root: &Path, kills: usize) -> bool {
    let mut is_complete = true;
    for i in 0..DRAWINGS {
        let drawing = root.join(format!("p{i}.dxf"));
        let hash = sha256(&fs::read(&drawing).unwrap());
        let home = drawing.with_extension("enfilade");
        let sets = sets(&home);
        for (name, set) in &sets {
            let want = match name.as_str() {
                "analysis" => as_set(files(&hash, "early", 3)),
                "round-01" => as_set(files(&hash, "final", 8)),
                other => panic!("{other} appeared after {kills} kills"),
            };
            assert!(*set == want, "{name} of {} is torn after {kills} kills", drawing.display());
        }
        if let Ok(status) = fs::read(home.join("status.json")) {
            serde_json::from_slice::<serde_json::Value>(&status).expect("a whole status.json");
        }
        is_complete &= sets.len() == 2;
    }
    is_complete
}

#[test]
fn killed_at_any_instant_it_leaves_whole_results_and_finishes_later() {
    let dir = tempfile::tempdir().unwrap();
    let root = fs::canonicalize(dir.path()).unwrap();
    for i in 0..DRAWINGS {
        fs::write(root.join(format!("p{i}.dxf")), format!("{i} EOF\n")).unwrap();
    }
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(1);
    let mut kills = 0;
    while kills < KILLS && !check(&root, kills) {
        let mut child = start_child(&root);
        thread::sleep(Duration::from_millis(rng.random_range(60..420)));
        child.kill().unwrap();
        child.wait().unwrap();
        kills += 1;
    }
    assert!(kills > 3, "the job was done before it could be disturbed");
    println!("killed {kills} times");
    let mut child = start_child(&root);
    let start = Instant::now();
    while !check(&root, kills) && start.elapsed() < PATIENCE {
        thread::sleep(Duration::from_millis(50));
    }
    // Time enough for a wrong second round to begin.
    thread::sleep(Duration::from_millis(500));
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(check(&root, kills), "not finished after {kills} kills");
}

/// A killed daemon's lock goes with it: the next one starts at once (hazard 21).
#[test]
fn the_lock_of_a_killed_daemon_is_free() {
    let dir = tempfile::tempdir().unwrap();
    let root = fs::canonicalize(dir.path()).unwrap();
    let mut child = start_child(&root);
    let owner = root.join(".enfilade/owner.json");
    let start = Instant::now();
    while !owner.exists() && start.elapsed() < PATIENCE {
        thread::sleep(Duration::from_millis(10));
    }
    let try_watch = || {
        let stop = Cancel::default();
        let mut show = |notice: Notice| {
            if matches!(notice, Notice::Watching { .. }) {
                stop.stop()
            }
        };
        watch(std::slice::from_ref(&root), &settings(), Arc::new(job), &mut show, &stop)
    };
    let refused = try_watch().unwrap_err();
    assert_eq!(refused.problem().map(|p| p.code), Some("folder-owned"));
    assert!(refused.to_string().contains(&child.id().to_string()), "{refused}");
    child.kill().unwrap();
    child.wait().unwrap();
    assert!(matches!(try_watch(), Err(Error::Stopped)));
}

/// How long the soak lasts; longer by `ENFILADE_SOAK_SECS`.
const SOAK_SECS: u64 = 30;

/// Chaos by a fixed seed: saves, deletions, folders moved, daemons killed. In the end the newest round
/// of every drawing is that of its last content, and all that is visible is whole.
#[test]
fn soak() {
    let secs = std::env::var("ENFILADE_SOAK_SECS").ok().and_then(|s| s.parse().ok()).unwrap_or(SOAK_SECS);
    let dir = tempfile::tempdir().unwrap();
    let root = fs::canonicalize(dir.path()).unwrap();
    fs::create_dir(root.join("sub")).unwrap();
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(7);
    let mut child = start_child(&root);
    let (start, mut steps) = (Instant::now(), 0);
    while start.elapsed() < Duration::from_secs(secs) {
        steps += 1;
        let folder = root.join(["", "sub", "moved"][rng.random_range(0..3)]);
        let path = folder.join(format!("p{}.dxf", rng.random_range(0..4)));
        match rng.random_range(0..20) {
            0 => drop(fs::remove_file(&path)),
            1 => drop(fs::rename(root.join("sub"), root.join("moved"))),
            2 => drop(fs::rename(root.join("moved"), root.join("sub"))),
            3 => {
                child.kill().unwrap();
                child.wait().unwrap();
                child = start_child(&root);
            }
            _ if folder.is_dir() => {
                crate::chaos::save(&path, format!("step {steps} EOF\n").as_bytes(), &mut rng)
            }
            _ => {}
        }
        thread::sleep(Duration::from_millis(rng.random_range(0..120)));
    }
    let drawings = final_drawings(&root);
    assert!(steps > 20 && !drawings.is_empty(), "{steps} steps, {} drawings", drawings.len());
    let start = Instant::now();
    let is_behind = |d: &&PathBuf| !is_newest_of(d);
    while drawings.iter().any(|d| is_behind(&d)) && start.elapsed() < PATIENCE {
        thread::sleep(Duration::from_millis(50));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    let behind: Vec<&PathBuf> = drawings.iter().filter(is_behind).collect();
    assert!(behind.is_empty(), "after {steps} steps not up to date: {behind:?}");
    drawings.iter().for_each(|d| assert_rounds_are_whole(d));
}

fn final_drawings(root: &Path) -> Vec<PathBuf> {
    let folders = ["", "sub", "moved"].map(|f| root.join(f));
    let files = folders.iter().filter_map(|f| fs::read_dir(f).ok()).flatten().map(|e| e.unwrap().path());
    files.filter(|p| p.extension().is_some_and(|e| e == "dxf")).collect()
}

fn is_newest_of(drawing: &Path) -> bool {
    let hash = sha256(&fs::read(drawing).unwrap());
    let sets = sets(&drawing.with_extension("enfilade"));
    let number = |name: &str| name.strip_prefix("round-").and_then(|n| n.parse::<u32>().ok());
    let newest = sets.iter().filter_map(|(n, set)| Some((number(n)?, set))).max_by_key(|(n, _)| *n);
    newest.is_some_and(|(_, set)| *set == as_set(files(&hash, "final", 8)))
}

/// Every set names one content throughout and has all its files.
fn assert_rounds_are_whole(drawing: &Path) {
    for (name, set) in sets(&drawing.with_extension("enfilade")) {
        let first = String::from_utf8(set.values().next().unwrap().clone()).unwrap();
        let words: Vec<&str> = first.lines().next().unwrap().split(' ').collect();
        let want = as_set(files(words[2], words[0], if name == "analysis" { 3 } else { 8 }));
        assert!(set == want, "{name} of {} is torn", drawing.display());
    }
}

//! Roots whose state cannot lie in them: `status` and other daemons find them all the same.

use super::*;

/// A file where the state folder would lie: nobody, not even root, makes it.
fn nowhere(root: &Path) {
    fs::write(root.join(".enfilade"), "").unwrap();
}

/// Code and words with which a daemon is turned away; `None`: it watches.
fn turned_away(root: &Path, settings: &WatchSettings) -> Option<(&'static str, String)> {
    let stop = Cancel::default();
    let mut show = |notice: Notice| {
        if matches!(notice, Notice::Watching { .. }) {
            stop.stop();
        }
    };
    let run: Arc<RunJob> =
        Arc::new(|request: &JobRequest, _: &mut dyn FnMut(JobEvent), _: &Cancel| Ok(echo(request)));
    let ended = watch(&[root.to_path_buf()], settings, run, &mut show, &stop).unwrap_err();
    ended.problem().map(|p| (p.code, format!("{ended}")))
}

/// Hazards 19 and 21: one daemon a root, and it is found, wherever its state lies.
#[test]
fn a_root_with_its_state_elsewhere_is_found_and_has_one_daemon() {
    let dir = tempfile::tempdir().unwrap();
    let records = dir.path().join("records");
    let with = |fallback: &str, depth: usize| WatchSettings {
        fallback_dir: Some(dir.path().join(fallback)),
        records_dir: Some(records.clone()),
        depth,
        ..settings()
    };
    let daemon = Daemon::start(with("a", 1), nowhere, |request, _, _| Ok(echo(request)));
    daemon.save("plan.dxf", "one");
    daemon.await_round("plan", 1);
    let root = daemon.root.clone();
    let told = || status(std::slice::from_ref(&root), Some(&records))[0].clone();
    daemon.await_true("the overview", || told()["status"]["done_count"] == 1);
    let state = PathBuf::from(told()["state_folder"].as_str().unwrap());
    assert!(told()["is_running"] == true && state.starts_with(dir.path().join("a")), "{}", told());
    assert_eq!(told()["owner"]["pid"], std::process::id());

    for fallback in ["a", "b"] {
        let (code, said) = turned_away(&root, &with(fallback, 0)).unwrap();
        let names = [root.display().to_string(), state.display().to_string(), std::process::id().to_string()];
        assert!(code == "folder-owned" && names.iter().all(|n| said.contains(n)), "{fallback}: {said}");
    }
    fs::create_dir(root.join("sub")).unwrap();
    assert_eq!(turned_away(&root.join("sub"), &with("b", 0)).map(|t| t.0), Some("folder-owned"));
    // Now that the root may be written, another would keep its state there.
    fs::remove_file(root.join(".enfilade")).unwrap();
    assert_eq!(turned_away(&root, &with("b", 0)).map(|t| t.0), Some("folder-owned"));
    assert!(!dir.path().join("b").exists() || fs::read_dir(dir.path().join("b")).unwrap().next().is_none());

    daemon.stop.stop();
    let start = Instant::now();
    while told()["is_running"] == true && start.elapsed() < PATIENCE {
        thread::sleep(Duration::from_millis(20));
    }
    assert_eq!(told()["is_running"], false);
    assert_eq!(told()["status"]["state"], "stopped", "what the last one told is still found");
    assert_eq!(turned_away(&root, &with("b", 0)), None);
    assert_eq!(told()["state_folder"], root.join(".enfilade").display().to_string());
    assert_eq!(fs::read_dir(&records).unwrap().count(), 0, "the record is over");
}

/// A fallback within the root is elsewhere too: the daemon beside it would keep its state at another place.
#[test]
fn a_fallback_within_the_root_is_found_too() {
    let (dir, aside) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
    let records = aside.path().join("records");
    let with = |fallback: &Path| WatchSettings {
        fallback_dir: Some(fallback.to_path_buf()),
        records_dir: Some(records.clone()),
        ..settings()
    };
    let root = fs::canonicalize(dir.path()).unwrap();
    nowhere(&root);
    let within = root.join("fallback");
    let run = |request: &JobRequest, _: &mut dyn FnMut(JobEvent), _: &Cancel| Ok(echo(request));
    let daemon = Daemon::start_at(dir, root.clone(), with(&within), |_| Ok(None), run);
    daemon.save("plan.dxf", "one");
    daemon.await_round("plan", 1);
    let told = status(std::slice::from_ref(&root), Some(&records))[0].clone();
    let state = told["state_folder"].as_str().unwrap();
    assert!(told["is_running"] == true && Path::new(state).starts_with(&within), "{told}");
    let (code, said) = turned_away(&root, &with(&aside.path().join("b"))).unwrap();
    assert!(code == "folder-owned" && said.contains(state), "{said}");
}

/// A root that another daemon watches from within is not taken with the state elsewhere.
#[test]
fn a_root_with_its_state_within_is_not_taken_from_elsewhere() {
    let dir = tempfile::tempdir().unwrap();
    let settings = WatchSettings { records_dir: Some(dir.path().join("records")), ..settings() };
    let daemon = Daemon::start(settings.clone(), |_| {}, |request, _, _| Ok(echo(request)));
    let records = crate::store::Records::new(settings.records_dir.clone());
    let me = crate::store::Lease { host: "h".into(), pid: 1, since: String::new(), beat: 0, depth: 0 };
    let (disk, beat): (status::SharedDisk, _) = (Arc::new(SystemDisk), Duration::from_millis(1));
    let claim = records.claim(&disk, &daemon.root, &dir.path().join("s"), me, beat, &Cancel::default());
    assert_eq!(claim.err().and_then(|e| e.problem().map(|p| p.code)), Some("folder-owned"));
}

/// Where no record can be kept the work goes on, and what that means is said.
#[test]
fn a_record_that_cannot_be_kept_is_said() {
    let dir = tempfile::tempdir().unwrap();
    fs::write(dir.path().join("records"), "").unwrap();
    let settings = WatchSettings {
        fallback_dir: Some(dir.path().join("a")),
        records_dir: Some(dir.path().join("records")),
        ..settings()
    };
    let daemon = Daemon::start(settings, nowhere, |request, _, _| Ok(echo(request)));
    daemon.await_said("watch-unrecorded", 1);
    daemon.save("plan.dxf", "one");
    daemon.await_round("plan", 1);
}

/// What ended daemons left is swept where the state it names is gone, and only there.
#[test]
fn records_of_what_is_gone_are_swept() {
    let dir = tempfile::tempdir().unwrap();
    let record = |name: &str, state: &Path| {
        fs::create_dir(dir.path().join(name)).unwrap();
        fs::write(dir.path().join(name).join("place"), state.as_os_str().as_encoded_bytes()).unwrap();
    };
    record("watched-1", &dir.path().join("gone"));
    record("watched-2", dir.path());
    record("other-3", &dir.path().join("gone"));
    crate::store::Records::new(Some(dir.path().into())).sweep(&SystemDisk);
    let left: Vec<bool> =
        ["watched-1", "watched-2", "other-3"].iter().map(|n| dir.path().join(n).exists()).collect();
    assert_eq!(left, [false, true, true]);
}

//! Who watches what, and what is remembered of it.

use super::*;

/// Hazard 21: one that meets the other's drawings is turned away as well, from above and from below.
#[test]
fn nested_folders_have_one_daemon() {
    let turned_away = |root: &Path, depth: usize| {
        let settings = WatchSettings { depth, ..settings() };
        let stop = Cancel::default();
        let mut show = |notice: Notice| {
            if matches!(notice, Notice::Watching { .. }) {
                stop.stop();
            }
        };
        let run: Arc<RunJob> =
            Arc::new(|request: &JobRequest, _: &mut dyn FnMut(JobEvent), _: &Cancel| Ok(echo(request)));
        let ended = watch(&[root.to_path_buf()], &settings, run, &mut show, &stop).unwrap_err();
        ended.problem().map(|p| (p.code, p.text.contains(&std::process::id().to_string())))
    };
    let settings = WatchSettings { depth: 1, ..settings() };
    let daemon = Daemon::start(settings, |_| {}, |request, _, _| Ok(echo(request)));
    fs::create_dir_all(daemon.path("a/b")).unwrap();
    assert_eq!(turned_away(&daemon.path("a"), 0), Some(("folder-owned", true)));
    assert_eq!(turned_away(&daemon.path("a/b"), 0), None, "too deep to be met");

    let outer = tempfile::tempdir().unwrap();
    let root = fs::canonicalize(outer.path()).unwrap();
    fs::create_dir_all(root.join("x/y")).unwrap();
    let run: Arc<RunJob> =
        Arc::new(|request: &JobRequest, _: &mut dyn FnMut(JobEvent), _: &Cancel| Ok(echo(request)));
    let stop = Cancel::default();
    thread::scope(|scope| {
        let inner = [root.join("x/y")];
        let (run, stop) = (run.clone(), &stop);
        scope.spawn(move || watch(&inner, &self::settings(), run, &mut |_| {}, stop));
        let lock = root.join("x/y/.enfilade/owner.json");
        let start = std::time::Instant::now();
        while !lock.exists() && start.elapsed() < PATIENCE {
            thread::sleep(Duration::from_millis(10));
        }
        let (near, deep) = (turned_away(&root, 1), turned_away(&root, 2));
        stop.stop();
        assert_eq!((near, deep), (None, Some(("folder-owned", true))));
    });
}

/// What failed stays failed over a restart, with its place; a drawing that goes is said to be gone.
#[test]
fn failures_are_remembered_over_a_restart() {
    let kept = tempfile::tempdir().unwrap();
    let root = fs::canonicalize(kept.path()).unwrap();
    fs::write(root.join("b.dxf"), "bad EOF\n").unwrap();
    fs::write(root.join("c.dxf"), "good EOF\n").unwrap();
    let said = |until: usize| {
        let (stop, lines) = (Cancel::default(), Mutex::new(Vec::new()));
        let run: Arc<RunJob> = Arc::new(|request: &JobRequest, _: &mut dyn FnMut(JobEvent), _: &Cancel| {
            if request.bytes.starts_with(b"bad") {
                return Err(Error::input("dxf-bad-number", Place::line("b.dxf", 57), "found x"));
            }
            Ok(echo(request))
        });
        let mut show = |notice: Notice| {
            let mut lines = lines.lock().unwrap();
            if matches!(notice, Notice::Failed { .. } | Notice::Done { .. } | Notice::UpToDate { .. }) {
                lines.push(format!("{notice:?}"));
            }
            if lines.len() == until {
                stop.stop();
            }
        };
        watch(std::slice::from_ref(&root), &settings(), run, &mut show, &stop).unwrap_err();
        lines.into_inner().unwrap()
    };
    said(2);
    let again = said(2).join("\n");
    assert!(again.contains("Failed") && again.contains("b.dxf:57") && again.contains("found x"), "{again}");
    assert!(again.contains("UpToDate") && again.contains("1 candidate"), "{again}");
}

/// A folder that is moved takes its results along. Back again, a drawing with a content that was done before is done
/// again where its newest results are of another; and only then.
#[test]
fn results_of_another_content_are_not_taken_for_those_of_a_drawing() {
    let kept = tempfile::tempdir().unwrap();
    let root = fs::canonicalize(kept.path()).unwrap();
    let (here, there) = (root.join("sub"), root.join("moved"));
    fs::create_dir(&here).unwrap();
    let depth_1 = WatchSettings { depth: 1, ..settings() };
    let run_until_done = || {
        let (stop, mut count) = (Cancel::default(), 0);
        let run: Arc<RunJob> =
            Arc::new(|request: &JobRequest, _: &mut dyn FnMut(JobEvent), _: &Cancel| Ok(echo(request)));
        let mut show = |notice: Notice| {
            count += usize::from(matches!(notice, Notice::Done { .. }));
            if matches!(notice, Notice::Done { .. } | Notice::UpToDate { .. }) {
                stop.stop();
            }
        };
        watch(std::slice::from_ref(&root), &depth_1, run, &mut show, &stop).unwrap_err();
        count
    };
    fs::write(here.join("plan.dxf"), "one EOF\n").unwrap();
    assert_eq!(run_until_done(), 1);
    fs::rename(&here, &there).unwrap();
    fs::write(there.join("plan.dxf"), "two EOF\n").unwrap();
    assert_eq!(run_until_done(), 1);
    fs::rename(&there, &here).unwrap();
    fs::write(here.join("plan.dxf"), "one EOF\n").unwrap();
    assert_eq!(run_until_done(), 1);
    let newest = fs::read_to_string(here.join("plan.enfilade/round-03/candidate-1.dxf")).unwrap();
    assert_eq!(newest, "one EOF\n");
    assert_eq!(run_until_done(), 0);
}

#[test]
fn a_drawing_that_goes_is_said_to_be_gone() {
    let daemon = Daemon::echo();
    daemon.save("plan.dxf", "one");
    daemon.await_said("Done {", 1);
    fs::remove_file(daemon.path("plan.dxf")).unwrap();
    daemon.await_said("Removed(", 1);
    assert!(daemon.path("plan.enfilade/round-01").exists());
}

/// The overview lists only so many of each kind, and counts all.
#[test]
fn the_overview_is_bounded() {
    const LISTED: usize = 200;
    let plant = |root: &Path| {
        fs::write(root.join("a.dxf"), "slow EOF\n").unwrap();
        for i in 0..=LISTED {
            fs::write(root.join(format!("b{i:03}.dxf")), "quick EOF\n").unwrap();
            fs::write(root.join(format!("#{i:03}.dxf")), "").unwrap();
        }
    };
    let daemon = Daemon::start(settings(), plant, |request, _, cancel| slow(request, cancel));
    let overview = || -> Value {
        let read = fs::read(daemon.path(".enfilade/status.json")).unwrap_or_default();
        serde_json::from_slice(&read).unwrap_or_default()
    };
    daemon.await_true("all waiting", || overview()["waiting_count"] == LISTED + 1);
    let overview = overview();
    assert_eq!(overview["ignored_count"], LISTED + 1);
    for kind in ["waiting", "ignored"] {
        assert_eq!(overview[kind].as_array().unwrap().len(), LISTED, "{kind}");
    }
}

/// Of several folders of one daemon each tells of its own drawings alone.
#[test]
fn each_folder_tells_of_its_own_drawings() {
    let kept = tempfile::tempdir().unwrap();
    let root = fs::canonicalize(kept.path()).unwrap();
    let roots = ["a", "b"].map(|name| root.join(name));
    for root in &roots {
        fs::create_dir(root).unwrap();
        for (name, text) in
            [("bad.dxf", "bad EOF\n"), ("good.dxf", "good EOF\n"), ("#left.dxf", ""), ("z.dxf", "slow EOF\n")]
        {
            fs::write(root.join(name), text).unwrap();
        }
    }
    let run: Arc<RunJob> = Arc::new(|request: &JobRequest, _: &mut dyn FnMut(JobEvent), cancel: &Cancel| {
        if request.bytes.starts_with(b"bad") {
            return Err(Error::input("dxf-bad-number", Place::line("bad.dxf", 57), "found x"));
        }
        slow(request, cancel)
    });
    // The first slow one runs for ever; of the other folder's, all that begin later wait.
    let (stop, watched) = (Cancel::default(), roots.clone());
    thread::scope(|scope| {
        scope.spawn(|| watch(&watched, &settings(), run, &mut |_| {}, &stop));
        let settled = |told: &Value| {
            let is_listed = |kind: &str| told["status"][kind].as_array().is_some_and(|l| !l.is_empty());
            let is_at_work = told["status"]["running"].is_string() || is_listed("waiting");
            is_at_work && is_listed("ignored")
        };
        let start = std::time::Instant::now();
        while !status(&roots, None).iter().all(settled) && start.elapsed() < PATIENCE {
            thread::sleep(Duration::from_millis(20));
        }
        let told = status(&roots, None);
        stop.stop();
        assert!(told.iter().all(settled), "{told:#?}");
        assert_eq!(told.iter().filter(|t| t["status"]["running"].is_string()).count(), 1, "{told:#?}");
        for (told, (own, other)) in told.iter().zip([("a", "b"), ("b", "a")]) {
            let mut told = told["status"].clone();
            assert_eq!(told["roots"].as_array().map(Vec::len), Some(2), "what is watched is told of all");
            told["roots"] = Value::Null;
            let text = told.to_string();
            let of = |name: &str| root.join(name).join("").display().to_string();
            assert!(text.contains(&of(own)) && !text.contains(&of(other)), "{own}: {text}");
            assert_eq!(told["ignored_count"], 1, "{own}: {text}");
        }
    });
}

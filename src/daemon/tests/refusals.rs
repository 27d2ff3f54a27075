//! Disks that refuse, files and folders that may not be read or written.

use super::*;

/// Hazards 20 and 30: what the disk refuses early stops the job at once and is said once, with the next try.
#[cfg(unix)]
#[test]
fn a_refusing_disk_is_said_once() {
    let elsewhere = tempfile::tempdir().unwrap();
    let target = elsewhere.path().to_path_buf();
    let plant = move |root: &Path| {
        fs::create_dir(root.join("plan.enfilade")).unwrap();
        std::os::unix::fs::symlink(&target, root.join("plan.enfilade/analysis")).unwrap();
    };
    let settings = WatchSettings { retry_secs: 600.0, ..settings() };
    let daemon = Daemon::start(settings, plant, |request, tell, cancel| {
        tell(JobEvent::Analysis(vec![OutFile::new("initial.png", "x")]));
        tell(JobEvent::Progress(serde_json::json!({"stage": "search"})));
        assert!(cancel.is_stopped(), "the job goes on for nothing");
        slow(request, cancel)
    });
    daemon.save("plan.dxf", "slow");
    daemon.await_said("Failed {", 1);
    daemon.rest();
    assert_eq!((daemon.count_said("output-is-link"), daemon.jobs()), (1, 1));
    assert_eq!(daemon.status("plan")["state"], "waiting");
}

/// A link that takes the place of a folder for results after the start leads nothing elsewhere: neither where results
/// go below it, nor in the midst of a job. Once it is gone, all goes on.
#[cfg(unix)]
#[test]
fn links_planted_after_the_start_are_refused() {
    use std::os::unix::fs::symlink;
    let elsewhere = tempfile::tempdir().unwrap();
    let dir = tempfile::tempdir().unwrap();
    let out = fs::canonicalize(dir.path()).unwrap().join("results");
    fs::create_dir(&out).unwrap();
    let (target, place) = (elsewhere.path().to_path_buf(), out.clone());
    let settings = WatchSettings { depth: 1, retry_secs: 0.5, out_dir: Some(out.clone()), ..settings() };
    let daemon = Daemon::start(
        settings,
        |root| fs::create_dir(root.join("sub")).unwrap(),
        move |request, _, _| {
            if request.bytes.starts_with(b"meanwhile") && !place.is_symlink() && target.exists() {
                fs::rename(&place, place.with_file_name("aside")).unwrap();
                symlink(&target, &place).unwrap();
            }
            Ok(echo(request))
        },
    );
    let nothing_there = || fs::read_dir(elsewhere.path()).unwrap().next().is_none();
    daemon.save("before.dxf", "a");
    daemon.await_true("the first", || out.join("before.enfilade/round-01").exists());
    symlink(elsewhere.path(), out.join("sub")).unwrap();
    daemon.save("sub/below.dxf", "b");
    daemon.await_said("output-is-link", 1);
    assert!(nothing_there());
    fs::remove_file(out.join("sub")).unwrap();
    daemon.await_true("below", || out.join("sub/below.enfilade/round-01").exists());
    daemon.save("planted.dxf", "meanwhile");
    daemon.await_true("the link", || out.is_symlink());
    let refused = daemon.count_said("output-is-link");
    daemon.await_said("output-is-link", refused + 1);
    daemon.rest();
    assert!(nothing_there());
    fs::remove_file(&out).unwrap();
    fs::rename(out.with_file_name("aside"), &out).unwrap();
    fs::remove_dir(elsewhere.path()).unwrap();
    daemon.await_true("planted", || out.join("planted.enfilade/round-01").exists());
}

/// Hazards 19 and 20: want of disk or permission passes.
#[test]
fn environment_failures_are_tried_again() {
    let attempts = AtomicUsize::new(0);
    let daemon = Daemon::start(
        settings(),
        |_| {},
        move |request, _, _| {
            if attempts.fetch_add(1, Ordering::SeqCst) < 2 {
                return Err(Error::environment("disk-full", Place::default(), "no space"));
            }
            Ok(echo(request))
        },
    );
    daemon.save("plan.dxf", "one");
    daemon.await_round("plan", 1);
    daemon.await_said("Done {", 1);
    assert_eq!((daemon.jobs(), daemon.count_said("Failed {")), (3, 2));
    assert_eq!(daemon.count_said("results-of-earlier-content"), 0, "the content never changed");
    let aloud = |word: &str| daemon.said.lock().unwrap().iter().filter(|s| s.starts_with(word)).count();
    assert_eq!(
        (aloud("Failed {"), aloud("Started("), daemon.count_said("room for results again")),
        (1, 1, 1)
    );
    daemon.await_true("no failure left", || {
        status(std::slice::from_ref(&daemon.root), None)[0]["status"]["failed"] == serde_json::json!([])
    });
}

/// Hazard 11: what waits when its folder goes waits for it; nothing is begun, and fails, meanwhile.
#[test]
fn what_waits_in_a_folder_that_is_away_is_not_begun() {
    let may_end = Arc::new(std::sync::atomic::AtomicBool::new(false));
    let ends = may_end.clone();
    let daemon = Daemon::start(
        settings(),
        |_| {},
        move |request, _, cancel| {
            while !ends.load(Ordering::SeqCst) && !cancel.is_stopped() {
                thread::sleep(Duration::from_millis(5));
            }
            Ok(echo(request))
        },
    );
    let names = ["a", "b", "c", "d"];
    names.iter().for_each(|name| daemon.save(&format!("{name}.dxf"), name));
    daemon.await_said("Queued {", names.len());
    daemon.await_jobs(1);
    let away = daemon.root.with_extension("away");
    fs::rename(&daemon.root, &away).unwrap();
    daemon.await_said("Offline", 1);
    // One; on a machine so busy that it counts as long, another was begun beside it.
    let begun = daemon.count_said("Started");
    may_end.store(true, Ordering::SeqCst);
    daemon.await_said("Failed {", begun);
    daemon.rest();
    assert_eq!((daemon.count_said("Started"), daemon.count_said("Failed {")), (begun, begun));
    assert!(begun < names.len());
    fs::rename(&away, &daemon.root).unwrap();
    daemon.await_round("d", 1);
}

/// Hazard 22: what a job kept is given back to the next that is started on the drawing, until one is done.
#[test]
fn what_a_job_keeps_is_given_back_after_a_stop() {
    let seen = Arc::new(Mutex::new(Vec::new()));
    let given = seen.clone();
    let daemon = Daemon::start(
        settings(),
        |_| {},
        move |request, tell, cancel| {
            given.lock().unwrap().push(String::from_utf8(request.earlier.to_vec()).unwrap());
            tell(JobEvent::Keep { bytes: b"one".to_vec(), is_anew: true });
            tell(JobEvent::Keep { bytes: b" two".to_vec(), is_anew: false });
            slow(request, cancel)
        },
    );
    daemon.save("plan.dxf", "slow");
    daemon.await_true("a memory", || {
        fs::read(daemon.path("plan.enfilade/.search")).is_ok_and(|b| b == b"one two")
    });
    daemon.save("plan.dxf", "quick");
    daemon.await_round("plan", 1);
    daemon.save("plan.dxf", "other");
    daemon.await_round("plan", 2);
    daemon.await_said("Done {", 2);
    assert_eq!(*seen.lock().unwrap(), ["", "one two", ""]);
    assert!(!daemon.path("plan.enfilade/.search").exists());
}

#[cfg(unix)]
fn set_mode(path: &Path, mode: u32) {
    use std::os::unix::fs::PermissionsExt;
    fs::set_permissions(path, fs::Permissions::from_mode(mode)).unwrap();
}

/// Whether permissions bind this user; they do not bind root.
#[cfg(unix)]
fn permissions_bind() -> bool {
    let dir = tempfile::tempdir().unwrap();
    set_mode(dir.path(), 0o555);
    let binds = fs::write(dir.path().join("x"), b"").is_err();
    set_mode(dir.path(), 0o755);
    if !binds {
        println!("skipped: permissions do not bind this user");
    }
    binds
}

/// Hazard 19: a drawing that may not be read is reported and taken up when it may.
#[cfg(unix)]
#[test]
fn an_unreadable_drawing_is_taken_up_when_it_may_be_read() {
    if !permissions_bind() {
        return;
    }
    let locked = |root: &Path| {
        fs::write(root.join("plan.dxf"), b"one EOF\n").unwrap();
        set_mode(&root.join("plan.dxf"), 0o000);
    };
    let daemon = Daemon::start(settings(), locked, |request, _, _| Ok(echo(request)));
    daemon.await_said("unreadable", 1);
    assert_eq!(daemon.status("plan")["problems"][0]["code"], "unreadable");
    set_mode(&daemon.path("plan.dxf"), 0o644);
    daemon.await_round("plan", 1);
}

/// Hazard 19: a folder that may not be written is watched with results elsewhere, or refused with words.
#[cfg(unix)]
#[test]
fn a_read_only_folder_needs_another_place_for_results() {
    if !permissions_bind() {
        return;
    }
    let read_only = |root: &Path| {
        fs::write(root.join("plan.dxf"), b"one EOF\n").unwrap();
        set_mode(root, 0o555);
    };
    let dir = tempfile::tempdir().unwrap();
    let fallback = dir.path().join("results");
    let with_fallback = WatchSettings { fallback_dir: Some(fallback.clone()), ..settings() };
    let daemon = Daemon::start(with_fallback, read_only, |request, _, _| Ok(echo(request)));
    let round = fallback.join("plan.enfilade/round-01");
    daemon.await_true("results in the fallback", || round.exists());
    let root = daemon.root.clone();
    let run: Arc<RunJob> =
        Arc::new(|request: &JobRequest, _: &mut dyn FnMut(JobEvent), _: &Cancel| Ok(echo(request)));
    let error =
        watch(std::slice::from_ref(&root), &settings(), run, &mut |_| {}, &Cancel::default()).unwrap_err();
    assert_eq!(error.problem().unwrap().code, "no-permission");
    assert!(error.to_string().contains("--out"), "{error}");
    set_mode(&root, 0o755);
}

/// Hazard 21: another machine has taken the folder: this daemon leaves it, and its job with it.
#[test]
fn a_taken_folder_is_left() {
    let mut daemon = Daemon::start(settings(), |_| {}, |request, _, cancel| slow(request, cancel));
    daemon.save("plan.dxf", "slow");
    daemon.await_jobs(1);
    let lease =
        serde_json::json!({"host": "elsewhere", "pid": 1, "since": "2026-01-01T00:00:00Z", "beat": 1});
    crate::store::write_json(&SystemDisk, &daemon.path(".enfilade/owner.json"), &lease).unwrap();
    let error = daemon.thread.take().unwrap().join().unwrap().unwrap_err();
    assert_eq!(error.problem().unwrap().code, "folder-taken");
    assert!(error.to_string().contains("elsewhere"), "{error}");
    assert_eq!(daemon.count_said("Stopped"), 1);
    assert!(daemon.path(".enfilade/owner.json").exists(), "the other's lease stays");
}

/// Hazard 30: links and pipes under the names of drawings, of their settings and of their data are named or passed
/// over, and hold up nobody.
#[cfg(unix)]
#[test]
fn pipes_and_links_hold_up_nobody() {
    let pipe = |path: &Path| {
        assert!(std::process::Command::new("mkfifo").arg(path).status().unwrap().success());
    };
    let settings = WatchSettings { extensions: vec!["dxf".into(), "gltf".into()], ..settings() };
    let plant = |root: &Path| {
        for name in ["pipe.dxf", "plan.enfilade.toml", "scene.bin"] {
            pipe(&root.join(name));
        }
        std::os::unix::fs::symlink("/etc/passwd", root.join("link.dxf")).unwrap();
        fs::create_dir_all(root.join("folder.dxf")).unwrap();
        fs::write(root.join("scene.gltf"), "{\"buffers\":[{\"uri\":\"scene.bin\"}]} EOF\n").unwrap();
    };
    let daemon = Daemon::start(settings, plant, |request, _, _| Ok(echo(request)));
    daemon.save("plan.dxf", "one");
    assert_eq!(daemon.await_round("plan", 1), "one EOF\n");
    daemon.await_round("scene", 1);
    pipe(&daemon.path("late.dxf"));
    daemon.await_said("late.dxf", 1);
    fs::create_dir(daemon.path("new.dxf")).unwrap();
    daemon.await_said("new.dxf", 1);
    for (name, why) in [
        ("pipe.dxf", "pipe"),
        ("link.dxf", "links are not followed"),
        ("late.dxf", "pipe"),
        ("folder.dxf", "a folder and no drawing"),
        ("new.dxf", "a folder and no drawing"),
    ] {
        let said = daemon.said.lock().unwrap().clone();
        let is_named = |s: &&String| s.starts_with("Ignored") && s.contains(name) && s.contains(why);
        assert_eq!(said.iter().filter(is_named).count(), 1, "{name}: {said:#?}");
    }
}

/// Hazard 30: pipes in the place of files of ours, as anybody may plant in a shared folder, are not waited for.
#[cfg(unix)]
#[test]
fn planted_pipes_hold_up_nobody() {
    let pipe = |path: &Path| {
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        assert!(std::process::Command::new("mkfifo").arg(path).status().unwrap().success());
    };
    let plant = move |root: &Path| {
        for (name, file) in [("a", ".drawing"), ("b", ".lock"), ("c", "status.json")] {
            pipe(&root.join(format!("{name}.enfilade/{file}")));
            fs::write(root.join(format!("{name}.dxf")), "one EOF\n").unwrap();
        }
        pipe(&root.join(".enfilade/status.json"));
    };
    let settings = WatchSettings { retry_secs: 600.0, ..settings() };
    let daemon = Daemon::start(settings.clone(), plant, |request, _, _| Ok(echo(request)));
    daemon.save("z.dxf", "one");
    daemon.await_round("z", 1);
    daemon.await_said("Failed {", 3);
    assert_eq!(daemon.count_said("output-is-special"), 3);
    let told = status(std::slice::from_ref(&daemon.root), None)[0].clone();
    assert_eq!((&told["is_running"], &told["status"]), (&Value::Bool(true), &Value::Null));
    for file in ["lock", "owner.json", "journal.jsonl"] {
        let root = daemon.path(file);
        pipe(&root.join(".enfilade").join(file));
        let (settings, roots, (send, ended)) = (settings.clone(), [root.clone()], mpsc::channel());
        thread::spawn(move || {
            let run: Arc<RunJob> =
                Arc::new(|r: &JobRequest, _: &mut dyn FnMut(JobEvent), _: &Cancel| Ok(echo(r)));
            send.send(watch(&roots, &settings, run, &mut |_| {}, &Cancel::default()).is_err())
        });
        assert_eq!(ended.recv_timeout(PATIENCE), Ok(true), "{file}");
        assert_eq!(status(&[root], None)[0]["is_running"], false, "{file}");
    }
}

/// Hazard 10: a file that is written under another of its names changes without an event. The next look through finds
/// it, says that the events cannot be trusted, and the folder is polled.
#[cfg(unix)]
#[test]
fn a_deaf_watch_is_polled_and_says_so() {
    let elsewhere = tempfile::tempdir().unwrap();
    let other_name = elsewhere.path().join("plan.dxf");
    fs::write(&other_name, "one EOF\n").unwrap();
    let linked = other_name.clone();
    let settings = WatchSettings { rescan_secs: 0.5, poll_secs: 0.3, ..settings() };
    let link = move |root: &Path| fs::hard_link(linked, root.join("plan.dxf")).unwrap();
    let daemon = Daemon::start(settings, link, |request, _, _| Ok(echo(request)));
    daemon.await_round("plan", 1);
    assert_eq!(daemon.count_said("watch-deaf"), 0);
    for (round, text) in [(2, "two EOF\n"), (3, "three EOF\n")] {
        fs::write(&other_name, text).unwrap();
        assert_eq!(daemon.await_round("plan", round), text);
    }
    assert_eq!(daemon.count_said("watch-deaf"), 1);
    let watched = || {
        let read = fs::read(daemon.path(".enfilade/status.json")).unwrap_or_default();
        serde_json::from_slice::<Value>(&read).map_or(Value::Null, |v| v["roots"][0]["watched"].clone())
    };
    daemon.await_true("the overview", || {
        watched().as_str().is_some_and(|how| how.contains("polled every 0.3 s"))
    });
}

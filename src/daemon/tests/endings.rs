//! Jobs that end otherwise than by themselves: killed, told to end from outside, cancelled, or beside settings half saved.

use super::*;
use crate::daemon::child::JOB_KILLED;
use crate::daemon::heart::MAX_QUEUE;

/// A job that the system kills each time is tried again, and not for ever.
#[test]
fn a_job_that_is_killed_is_tried_three_times() {
    let killed = || Error::environment(JOB_KILLED, Place::default(), "killed from outside");
    let daemon = Daemon::start(settings(), |_| {}, move |_, _, _| Err(killed()));
    daemon.save("plan.dxf", "one");
    daemon.await_said("3 times in a row", 1);
    daemon.rest();
    assert_eq!((daemon.jobs(), daemon.count_said("Failed {")), (3, 3));
    assert_eq!(daemon.status("plan")["state"], "failed");
}

/// A job that ends as if it was told to, and was not, is tried again with a reason.
#[test]
fn a_job_that_nobody_stopped_is_tried_again() {
    let attempts = AtomicUsize::new(0);
    let run = move |request: &JobRequest, _: &mut dyn FnMut(JobEvent), _: &Cancel| {
        let is_first = attempts.fetch_add(1, Ordering::SeqCst) == 0;
        if is_first { Err(Error::Stopped) } else { Ok(echo(request)) }
    };
    let daemon = Daemon::start(settings(), |_| {}, run);
    daemon.save("plan.dxf", "one");
    daemon.await_round("plan", 1);
    assert_eq!((daemon.count_said("not by the daemon"), daemon.count_said("Stopped {")), (1, 0));
}

/// Settings that cannot be read, half saved perhaps, end no job that runs; others do.
#[test]
fn settings_half_saved_end_no_job() {
    let daemon = Daemon::start(settings(), |_| {}, |request, _, cancel| slow(request, cancel));
    daemon.save("plan.dxf", "slow");
    daemon.await_jobs(1);
    fs::write(daemon.path("plan.enfilade.toml"), "members = [").unwrap();
    daemon.await_said("Queued {", 2);
    daemon.rest();
    assert_eq!((daemon.count_said("Stopped {"), daemon.jobs()), (0, 1));
    // Taken back, they are those of the job that runs.
    fs::remove_file(daemon.path("plan.enfilade.toml")).unwrap();
    daemon.rest();
    assert_eq!((daemon.count_said("Stopped {"), daemon.jobs()), (0, 1));
    fs::write(daemon.path("plan.enfilade.toml"), "members = 3\n").unwrap();
    daemon.await_said("take its place", 1);
}

/// Beside a drawing that is gone nothing says that it waits or is worked on.
#[test]
fn what_is_gone_waits_no_more() {
    let daemon = Daemon::start(settings(), |_| {}, |request, _, cancel| slow(request, cancel));
    daemon.save("runs.dxf", "slow");
    daemon.await_jobs(1);
    daemon.save("waits.dxf", "slow");
    daemon.await_true("waits", || daemon.path("waits.enfilade/status.json").exists());
    for name in ["waits", "runs"] {
        fs::remove_file(daemon.path(&format!("{name}.dxf"))).unwrap();
        daemon.await_true(name, || daemon.status(name)["state"] == "stopped");
        assert_eq!(daemon.status(name)["summary"], "the drawing was removed or has another name");
    }
}

/// A round that was asked for of what lies there no more is not done, and whoever asked is told so.
#[test]
fn an_order_that_a_save_makes_void_is_told() {
    let daemon = Daemon::start(settings(), |_| {}, |request, _, cancel| slow(request, cancel));
    let drawing = daemon.path("plan.dxf");
    let ask = || {
        let asked = Asked { objective: Some("degree max 0.5".into()), ..Asked::default() };
        daemon.orders.send(Order::Again { drawing: drawing.clone(), asked }).unwrap();
    };
    daemon.save("plan.dxf", "slow one");
    daemon.await_jobs(1);
    ask();
    daemon.await_said("Queued {", 2);
    daemon.save("plan.dxf", "slow two");
    daemon.await_said("ask for it again", 1);
    daemon.await_jobs(2);
    ask();
    daemon.await_said("Queued {", 4);
    fs::remove_file(&drawing).unwrap();
    daemon.await_said("Stopped { drawing", 4);
    assert_eq!(daemon.count_said("removed or has another name"), 2, "the job and the order");
    assert_eq!((daemon.count_said("ask for it again"), daemon.jobs()), (1, 2));
}

/// What the user cancels stays so at the next start, until it is saved anew.
#[test]
fn what_is_cancelled_stays_so() {
    let kept = tempfile::tempdir().unwrap();
    let root = fs::canonicalize(kept.path()).unwrap();
    let drawing = root.join("plan.dxf");
    fs::write(&drawing, "slow EOF\n").unwrap();
    // Watches until something is said; cancels as soon as a job starts.
    let watch_until = |word: &str| {
        let (orders, ordered) = mpsc::channel();
        let (stop, mut said) = (Cancel::default(), Vec::new());
        let run: Arc<RunJob> =
            Arc::new(|r: &JobRequest, _: &mut dyn FnMut(JobEvent), cancel: &Cancel| slow(r, cancel));
        let mut show = |notice: Notice| {
            if matches!(notice, Notice::Started(_)) {
                orders.send(Order::Cancel(drawing.clone())).unwrap();
            }
            said.push(format!("{notice:?}"));
            if said.last().is_some_and(|s| s.contains(word)) {
                stop.stop();
            }
        };
        let roots = [root.clone()];
        let mut reread = || Ok(None);
        let _ = watch_with_orders(&roots, &settings(), &mut reread, run, ordered, &mut show, &stop);
        said.concat()
    };
    assert!(watch_until("Stopped {").contains("Started"));
    let told = &status(std::slice::from_ref(&root), None)[0]["status"]["cancelled"];
    assert_eq!(*told, serde_json::json!([drawing.display().to_string()]));
    let again = watch_until("Stopped {");
    assert!(again.contains("cancelled before") && !again.contains("Started"), "{again}");
    fs::write(&drawing, "quick EOF\n").unwrap();
    assert!(watch_until("Started").contains("Queued"));
}

/// Who cancels waits for the best so far; a newer save does not, nor who cancels again.
#[test]
fn a_cancelled_search_leaves_its_best() {
    // Finds its best only once it is asked for it, and then never ends by itself.
    let run = |request: &JobRequest, tell: &mut dyn FnMut(JobEvent), cancel: &Cancel| {
        if !request.bytes.starts_with(b"slow and none") {
            tell(JobEvent::Progress(serde_json::json!({ "stage": "optimise" })));
        }
        let stopped = slow(request, cancel);
        if cancel.keeps_best() {
            let files = vec![OutFile::new("best.dxf", request.bytes.to_vec())];
            tell(JobEvent::SoFar { files, progress: serde_json::json!({ "stage": "so-far" }) });
        }
        while cancel.keeps_best() && request.bytes.starts_with(b"slow and on") {
            thread::sleep(Duration::from_millis(5));
        }
        stopped
    };
    let daemon = Daemon::start(settings(), |_| {}, run);
    let drawing = daemon.path("plan.dxf");
    let cancel = || daemon.orders.send(Order::Cancel(drawing.clone())).unwrap();
    let best = daemon.path("plan.enfilade/so-far/best.dxf");
    for (n, text) in ["slow and none", "slow", "slow and on", "slow and on again"].into_iter().enumerate() {
        daemon.save("plan.dxf", text);
        daemon.await_said("Started(", n + 1);
        daemon.await_said("optimise", n);
        cancel();
        match n {
            0 => daemon.await_said("why: \"cancelled\"", 1),
            1 => daemon.await_said("its best so far is kept", 1),
            _ => {
                daemon.await_true("the best", || fs::read_to_string(&best).is_ok_and(|t| t.starts_with(text)))
            }
        }
        match n {
            0 => assert!(!best.exists()),
            1 => assert_eq!(
                daemon.await_state("plan", "stopped")["summary"],
                "cancelled; its best so far is kept"
            ),
            2 => daemon.save("plan.dxf", "slow and on again"),
            _ => cancel(),
        }
    }
    daemon.await_said("its best so far is kept", 3);
    daemon.rest();
    assert_eq!((daemon.jobs(), daemon.count_said("Failed {"), daemon.count_said("Done {")), (4, 0, 0));
}

/// What was cancelled and is asked for again waits, and is no longer called cancelled.
#[test]
fn what_waits_is_not_called_cancelled() {
    let daemon = Daemon::start(settings(), |_| {}, |request, _, cancel| slow(request, cancel));
    let told = || status(std::slice::from_ref(&daemon.root), None)[0]["status"].clone();
    daemon.save("first.dxf", "slow");
    daemon.await_jobs(1);
    daemon.save("plan.dxf", "quick");
    daemon.await_said("Queued {", 2);
    let (drawing, asked) = (daemon.path("plan.dxf"), Asked::default());
    let named = serde_json::json!([drawing.display().to_string()]);
    daemon.orders.send(Order::Cancel(drawing.clone())).unwrap();
    daemon.await_true("cancelled", || told()["cancelled"] == named);
    daemon.orders.send(Order::Again { drawing, asked }).unwrap();
    daemon.await_true("waiting", || told()["waiting"] == named);
    assert_eq!((&told()["cancelled"], &told()["cancelled_count"]), (&serde_json::json!([]), &0.into()));
}

/// A job that is given up and fails of something else by then is not tried again, nor is its drawing listed.
#[test]
fn what_is_given_up_fails_no_more() {
    let run = |request: &JobRequest, _: &mut dyn FnMut(JobEvent), cancel: &Cancel| {
        let stopped = slow(request, cancel);
        stopped.map_err(|_| Error::environment("disk-full", Place::default(), "no room"))
    };
    let daemon = Daemon::start(settings(), |_| {}, run);
    for (name, why) in [("gone", "removed or has another name"), ("given-up", "why: \"cancelled\"")] {
        let drawing = daemon.path(&format!("{name}.dxf"));
        daemon.save(&format!("{name}.dxf"), "slow");
        daemon.await_said(&format!("Started({drawing:?}"), 1);
        match name {
            "gone" => fs::remove_file(&drawing).unwrap(),
            _ => daemon.orders.send(Order::Cancel(drawing)).unwrap(),
        }
        daemon.await_said(why, 1);
    }
    daemon.rest();
    assert_eq!((daemon.count_said("Failed {"), daemon.jobs()), (0, 2));
}

/// A round asked for of a drawing that is just being saved is dropped and told; that the file is not whole is told anew.
#[test]
fn an_order_of_half_a_save_is_told() {
    let daemon = Daemon::echo();
    let drawing = daemon.path("plan.dxf");
    daemon.save("plan.dxf", "one");
    daemon.await_said("Done {", 1);
    fs::write(&drawing, "half of tw").unwrap();
    daemon.await_said("is not whole yet", 1);
    let asked = Asked { objective: Some("degree max 0.5".into()), ..Asked::default() };
    daemon.orders.send(Order::Again { drawing: drawing.clone(), asked }).unwrap();
    daemon.await_said("ask for it again", 1);
    daemon.await_said("is not whole yet", 2);
    assert_eq!((daemon.jobs(), daemon.status("plan")["state"].as_str()), (1, Some("stopped")));
    daemon.save("plan.dxf", "two");
    assert_eq!(daemon.await_round("plan", 2), "two EOF\n");
}

/// Settings that cannot be read for a while fail what is done and what was cancelled; once they are mended, both are as
/// they were.
#[test]
fn mended_settings_do_nothing_again() {
    let run = |request: &JobRequest, _: &mut dyn FnMut(JobEvent), cancel: &Cancel| {
        let settings = fs::read_to_string(request.drawing.with_file_name("enfilade.toml"));
        match settings {
            Ok(text) if text.contains('[') => {
                Err(Error::usage("settings", Place::default(), "cannot be read"))
            }
            _ => slow(request, cancel),
        }
    };
    let daemon = Daemon::start(settings(), |_| {}, run);
    let say = |text: &str| fs::write(daemon.path("enfilade.toml"), text).unwrap();
    say("members = 3\n");
    daemon.save("done.dxf", "one");
    daemon.await_said("Done {", 1);
    daemon.save("given-up.dxf", "slow");
    daemon.await_said("Started(", 2);
    daemon.orders.send(Order::Cancel(daemon.path("given-up.dxf"))).unwrap();
    daemon.await_said("why: \"cancelled\"", 1);
    say("members = [\n");
    daemon.await_said("Failed {", 2);
    say("members = 3\n");
    daemon.await_said("UpToDate {", 1);
    daemon.await_said("cancelled before", 1);
    daemon.rest();
    assert_eq!((daemon.jobs(), daemon.count_said("Done {")), (4, 1), "two jobs, and two that failed");
    assert_eq!(
        (&daemon.status("done")["state"], &daemon.status("given-up")["state"]),
        (&"done".into(), &"stopped".into())
    );
    assert!(!daemon.path("done.enfilade/round-02").exists());
}

/// A scene is taken up again when the building beside it comes, changes or goes, and for no other.
#[test]
fn a_scene_is_taken_up_again_with_its_building() {
    let extensions = ["dxf", "ifc", "glb"].map(String::from).into();
    let settings = WatchSettings { extensions, ..settings() };
    let daemon = Daemon::start(settings, |_| {}, |request, _, _| Ok(echo(request)));
    daemon.save("house.glb", "scene");
    daemon.await_true("the scene", || daemon.jobs() == 1);
    let building = |text: &str| daemon.save("house.ifc", text);
    building("one");
    daemon.await_true("both", || daemon.jobs() == 3);
    daemon.save("other.ifc", "one");
    daemon.await_true("the other one", || daemon.jobs() == 4);
    building("two");
    daemon.await_true("both again", || daemon.jobs() == 6);
    fs::remove_file(daemon.path("house.ifc")).unwrap();
    daemon.await_true("the scene alone", || daemon.jobs() == 7);
    daemon.rest();
    assert_eq!(daemon.jobs(), 7);
}

/// Nobody asks for wishes again, so those for which there is no room are told; what waits is done.
#[test]
fn orders_beyond_the_queue_are_told() {
    let daemon = Daemon::start(settings(), |_| {}, |request, _, cancel| slow(request, cancel));
    let drawing = daemon.path("plan.dxf");
    daemon.save("plan.dxf", "slow");
    daemon.await_said("Started(", 1);
    for i in 0..MAX_QUEUE + 2 {
        let asked = Asked { objective: Some(format!("degree max 0.{i}")), ..Asked::default() };
        daemon.orders.send(Order::Again { drawing: drawing.clone(), asked }).unwrap();
    }
    daemon.await_said("too much waits already", 2);
    daemon.orders.send(Order::Cancel(drawing)).unwrap();
    daemon.await_said("why: \"cancelled\"", MAX_QUEUE + 1);
    daemon.rest();
    assert_eq!((daemon.count_said("too much waits already"), daemon.jobs()), (2, 1));
}

//! Several jobs at once, what they may take, and what is left of them where the journal is lost.

use super::*;

/// Works until it is let go, where the drawing says so.
fn gated(
    gate: &Cancel,
) -> impl Fn(&JobRequest, &mut dyn FnMut(JobEvent), &Cancel) -> Result<JobOutput, Error> + use<> {
    let gate = gate.clone();
    move |request, _, cancel| {
        while request.bytes.starts_with(b"heavy") && !gate.is_stopped() {
            cancel.check()?;
            thread::sleep(Duration::from_millis(5));
        }
        Ok(whole(request))
    }
}

/// A round whose result says of which content it is.
fn whole(request: &JobRequest) -> JobOutput {
    let result = serde_json::json!({"input": {"sha256": request.sha256}}).to_string();
    let file = |name: &str, bytes: &[u8]| OutFile { path: name.into(), bytes: bytes.into() };
    let files = vec![file("result.json", result.as_bytes()), file("candidate-1.dxf", &request.bytes)];
    JobOutput { files, is_degraded: false, summary: "1 option".into() }
}

/// A heavy drawing holds up no other, and the status shows each of them.
#[test]
fn a_heavy_drawing_blocks_no_other() {
    let gate = Cancel::default();
    let daemon = Daemon::start(WatchSettings { jobs: 2, ..settings() }, |_| {}, gated(&gate));
    daemon.save("heavy.dxf", "heavy");
    daemon.await_state("heavy", "running");
    for i in 0..5 {
        daemon.save(&format!("small-{i}.dxf"), "small");
    }
    (0..5).for_each(|i| drop(daemon.await_round(&format!("small-{i}"), 1)));
    assert_eq!(daemon.status("heavy")["state"], "running");
    let overview = || status(std::slice::from_ref(&daemon.root), None)[0]["status"].clone();
    daemon.await_true("heavy alone", || overview()["all_running"].as_array().is_some_and(|r| r.len() == 1));
    gate.stop();
    daemon.await_round("heavy", 1);
}

/// No more at once than is said, and the memory of each is its share.
#[test]
fn jobs_stay_within_their_number_and_memory() {
    let (now, most) = (Arc::new(AtomicUsize::new(0)), Arc::new(AtomicUsize::new(0)));
    let (going, peak) = (now.clone(), most.clone());
    let job = move |request: &JobRequest, _: &mut dyn FnMut(JobEvent), _: &Cancel| {
        peak.fetch_max(going.fetch_add(1, Ordering::SeqCst) + 1, Ordering::SeqCst);
        assert_eq!(request.share.memory_bytes, Some(1 << 30));
        thread::sleep(Duration::from_millis(50));
        going.fetch_sub(1, Ordering::SeqCst);
        Ok(whole(request))
    };
    let settings = WatchSettings { jobs: 3, memory_bytes: Some(4 << 30), ..settings() };
    let fill =
        |root: &Path| (0..12).for_each(|i| fs::write(root.join(format!("p{i}.dxf")), "x EOF\n").unwrap());
    let daemon = Daemon::start(settings, fill, job);
    daemon.await_said("Done {", 12);
    assert!((2..=3).contains(&most.load(Ordering::SeqCst)), "{most:?}");
}

/// A job that needs more than its share is done again with the most that one may have, once.
#[test]
fn more_memory_is_given_once() {
    let job = |request: &JobRequest, _: &mut dyn FnMut(JobEvent), _: &Cancel| {
        let had = request.share.memory_bytes.unwrap_or(0);
        if request.bytes.starts_with(b"never") || had <= 1 << 30 {
            return Err(Error::input("job-out-of-memory", Place::default(), format!("{had} are too few")));
        }
        Ok(whole(request))
    };
    let settings = WatchSettings { memory_bytes: Some(4 << 30), ..settings() };
    let daemon = Daemon::start(settings, |_| {}, job);
    daemon.save("plan.dxf", "hungry");
    daemon.await_round("plan", 1);
    daemon.save("other.dxf", "never");
    let ended = daemon.await_state("other", "failed");
    assert_eq!(ended["problems"][0]["text"], format!("{} are too few", 3u64 << 30));
    assert_eq!(daemon.jobs(), 4);
}

/// Reading has a limit of its own; what is understood in time may go on.
#[test]
fn reading_too_long_is_told_with_its_limit() {
    let job = |request: &JobRequest, tell: &mut dyn FnMut(JobEvent), cancel: &Cancel| {
        let stage = if request.bytes.starts_with(b"read") { "read" } else { "measure" };
        tell(JobEvent::Progress(serde_json::json!({ "stage": stage })));
        let began = Instant::now();
        while began.elapsed() < Duration::from_secs(2) || stage == "read" {
            cancel.check()?;
            thread::sleep(Duration::from_millis(5));
        }
        Ok(whole(request))
    };
    let daemon = Daemon::start(WatchSettings { read_limit_secs: 0.1, ..settings() }, |_| {}, job);
    daemon.save("a.dxf", "read");
    daemon.save("b.dxf", "good");
    let ended = daemon.await_state("a", "failed");
    assert_eq!(ended["problems"][0]["code"], "reading-too-long");
    assert!(ended["problems"][0]["text"].as_str().unwrap().contains("read-limit-secs"));
    daemon.await_round("b", 1);
}

/// The same content written again with another time stamp is no new job.
#[test]
fn a_new_time_stamp_is_no_new_round() {
    let content_key = |_: &Path, bytes: &[u8]| {
        let text = String::from_utf8_lossy(bytes);
        crate::watch::sha256_hex(text.split('@').next().unwrap_or_default().as_bytes())
    };
    let daemon = Daemon::start(
        WatchSettings { content_key, ..settings() },
        |_| {},
        |request, _, _| Ok(whole(request)),
    );
    daemon.save("plan.dxf", "one @ noon");
    daemon.await_said("Done {", 1);
    daemon.save("plan.dxf", "one @ midnight");
    daemon.await_said("UpToDate", 1);
    daemon.save("plan.dxf", "two @ midnight");
    assert_eq!(daemon.await_round("plan", 2), "two @ midnight EOF\n");
    assert_eq!(daemon.jobs(), 2);
}

/// A lost journal, and one of a later version, cost no round: the results beside the drawings say what was done.
#[test]
fn a_lost_journal_is_rebuilt_from_results() {
    let lose: [fn(&Path); 2] = [
        |journal| fs::remove_file(journal).unwrap(),
        |journal| fs::write(journal, "{\"v\":9,\"event\":\"finished\",\"drawing\":\"plan.dxf\"}\n").unwrap(),
    ];
    for lose in lose {
        let mut daemon = Daemon::start(settings(), |_| {}, |request, _, _| Ok(whole(request)));
        daemon.save("plan.dxf", "one");
        daemon.await_said("Done {", 1);
        daemon.stop.stop();
        daemon.thread.take().unwrap().join().unwrap().unwrap_err();
        lose(&daemon.root.join(".enfilade/journal.jsonl"));
        let (said, stop) = (Mutex::new(Vec::new()), Cancel::default());
        let run: Arc<RunJob> =
            Arc::new(|_: &JobRequest, _: &mut dyn FnMut(JobEvent), _: &Cancel| panic!("done again"));
        let mut show = |notice: Notice| {
            let text = format!("{notice:?}");
            if text.starts_with("UpToDate") || text.starts_with("Failed") {
                stop.stop();
            }
            said.lock().unwrap().push(text);
        };
        let _ = watch(std::slice::from_ref(&daemon.root), &settings(), run, &mut show, &stop);
        let said = said.into_inner().unwrap();
        assert!(said.iter().any(|s| s.starts_with("UpToDate") && s.contains("1 option")), "{said:?}");
        let journal = fs::read_to_string(daemon.root.join(".enfilade/journal.jsonl")).unwrap();
        assert!(journal.contains("\"finished\"") && journal.contains("\"outputs\""), "{journal}");
        assert_eq!(
            said.iter().any(|s| s.contains("journal-unknown")),
            journal.contains("\"v\":9"),
            "{said:?}"
        );
    }
}

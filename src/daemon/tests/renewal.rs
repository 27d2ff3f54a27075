//! Settings of the daemon that change while it runs.

use super::*;
use enfilade_config::Partial;

/// What the root's own file says, on top of the short times of these tests.
fn read(root: &Path) -> Result<Option<WatchSettings>, Error> {
    let text = fs::read_to_string(root.join("enfilade.toml")).unwrap_or_default();
    let table = Partial::from_toml("enfilade.toml", &text)?.watch.unwrap_or_default();
    let (ignore, depth) = (table.ignore.unwrap_or_default(), table.depth.unwrap_or(0));
    Ok(Some(WatchSettings { ignore, depth, ..settings() }))
}

#[test]
fn changed_settings_are_taken_up_while_it_runs() {
    let daemon = Daemon::start_reading(settings(), read, |_| {}, |request, _, _| Ok(echo(request)));
    let say = |text: &str| fs::write(daemon.path("enfilade.toml"), text).unwrap();
    fs::create_dir(daemon.path("sub")).unwrap();
    for name in ["plan.dxf", "draft-1.dxf", "sub/deep.dxf"] {
        daemon.save(name, "one");
    }
    daemon.await_said("Done {", 2);
    assert!(!daemon.path("sub/deep.enfilade").exists());

    say("[watch]\nignore = [\"draft-*\"]\ndepth = 1\n");
    daemon.await_said("Renewed(", 1);
    daemon.await_said("Done {", 3);
    daemon.await_round("sub/deep", 1);
    daemon.await_said("ignored by `draft-*`", 1);
    daemon.save("draft-2.dxf", "two");
    daemon.save("draft-1.dxf", "two");
    daemon.save("plan.dxf", "two");
    daemon.await_said("Done {", 4);
    let lease = fs::read_to_string(daemon.path(".enfilade/owner.json")).unwrap();
    assert!(lease.contains("\"depth\":1"), "{lease}");
    daemon.rest();
    assert_eq!(daemon.jobs.load(Ordering::SeqCst), 4, "a drawing was done again, or one that is left alone");

    // What cannot be taken up is said, and changes nothing.
    for (wrong, word) in [("[watch]\nignore = [\"a[\"]\n", "bad-glob"), ("[watch]\ndepht = 1\n", "depht")] {
        say(wrong);
        daemon.await_true(word, || {
            let said = daemon.said.lock().unwrap();
            said.iter().any(|s| s.contains(word) && s.contains("goes on as it was told before"))
        });
    }
    daemon.save("sub/deep.dxf", "two");
    daemon.await_round("sub/deep", 2);

    // Without the file everything is as at first: what was left alone is taken up.
    fs::remove_file(daemon.path("enfilade.toml")).unwrap();
    daemon.await_round("draft-2", 1);
    daemon.await_round("draft-1", 2);
    assert_eq!(daemon.count_said("Stopped {"), 0);
}

/// The job that runs is not given up for settings that do not concern it, and one that they leave alone is.
#[test]
fn changed_settings_leave_the_running_job_alone() {
    let daemon = Daemon::start_reading(
        settings(),
        read,
        |_| {},
        |request, _, cancel| {
            let gate = request.drawing.with_file_name("gate");
            while !gate.exists() {
                cancel.check()?;
                thread::sleep(Duration::from_millis(10));
            }
            Ok(echo(request))
        },
    );
    let say = |text: &str| fs::write(daemon.path("enfilade.toml"), text).unwrap();
    daemon.save("plan.dxf", "one");
    daemon.await_said("Started(", 1);
    daemon.save("next.dxf", "one");
    daemon.await_said("Queued {", 2);
    say("[watch]\ndepth = 1\n");
    daemon.await_said("Renewed(", 1);
    daemon.rest();
    assert_eq!((daemon.count_said("Stopped {"), daemon.count_said("Queued {")), (0, 2));
    say("[watch]\nignore = [\"plan*\"]\n");
    daemon.await_said("leave it alone from now on", 1);
    fs::write(daemon.path("gate"), "").unwrap();
    daemon.await_round("next", 1);
    daemon.await_said("Done {", 1);
    assert!(!daemon.path("plan.enfilade/round-01").exists());
    assert_eq!(daemon.count_said("Done {"), 1);
}

/// What was cancelled and is left alone from then on is no longer listed.
#[test]
fn what_is_left_alone_is_not_called_cancelled() {
    let daemon = Daemon::start_reading(settings(), read, |_| {}, |request, _, cancel| slow(request, cancel));
    let drawing = daemon.path("plan.dxf");
    let told = || status(std::slice::from_ref(&daemon.root), None)[0]["status"]["cancelled_count"].clone();
    daemon.save("plan.dxf", "slow");
    daemon.await_said("Started(", 1);
    daemon.orders.send(Order::Cancel(drawing)).unwrap();
    daemon.await_true("cancelled", || told() == 1);
    fs::write(daemon.path("enfilade.toml"), "[watch]\nignore = [\"plan*\"]\n").unwrap();
    daemon.await_true("forgotten", || told() == 0);
}

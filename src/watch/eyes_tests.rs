use super::*;
use std::sync::mpsc;
use std::time::Duration;

fn key(_: &Path, bytes: &[u8]) -> String {
    sha256_hex(bytes)
}

fn eyes(root: &Path, depth: usize) -> (Eyes, mpsc::Receiver<Event>) {
    let (send, receive) = mpsc::channel();
    let settings = WatchSettings { depth, ..WatchSettings::default() };
    let report = move |event| drop(send.send(event));
    (Eyes::new(&[root.into()], &[false], &settings, report).unwrap(), receive)
}

/// Waits for an event that names `path`.
fn await_touch(events: &mpsc::Receiver<Event>, path: &Path) -> bool {
    loop {
        match events.recv_timeout(Duration::from_secs(300)) {
            Ok(Event::Touched(p)) if p == path => return true,
            Ok(_) => {}
            Err(_) => return false,
        }
    }
}

#[test]
fn scan_lists_files_not_results_nor_links() {
    let dir = tempfile::tempdir().unwrap();
    let root = fs::canonicalize(dir.path()).unwrap();
    for folder in ["plan.enfilade", "sub/deep/deeper", ".git"] {
        fs::create_dir_all(root.join(folder)).unwrap();
        fs::write(root.join(folder).join("x.dxf"), b"").unwrap();
    }
    fs::write(root.join("plan.dxf"), b"").unwrap();
    fs::write(root.join("sub/s.dxf"), b"").unwrap();
    #[cfg(unix)]
    for (target, link) in
        [(root.as_path(), "loop"), (Path::new("/etc/passwd"), "p.dxf"), (Path::new("none"), "d.dxf")]
    {
        std::os::unix::fs::symlink(target, root.join(link)).unwrap();
    }
    fs::create_dir(root.join("folder.dxf")).unwrap();
    fs::write(root.join("folder.dxf/in.dxf"), b"").unwrap();
    let (mut eyes, _events) = eyes(&root, 1);
    let found = eyes.scan(&root).unwrap();
    let of = |wanted: Kind| -> Vec<PathBuf> {
        found.iter().filter(|(_, s)| s.kind == wanted).map(|(p, _)| p.clone()).collect()
    };
    assert_eq!(
        of(Kind::File),
        [root.join("folder.dxf/in.dxf"), root.join("plan.dxf"), root.join("sub/s.dxf")]
    );
    assert_eq!(of(Kind::Folder), [root.join("folder.dxf")], "it bears a drawing's name");
    if cfg!(unix) {
        assert_eq!(of(Kind::Link), [root.join("d.dxf"), root.join("p.dxf")]);
        assert_eq!(found.len(), 6, "{found:?}");
    }
    assert_eq!(eyes.scan(Path::new("/nowhere")), None);
}

#[test]
fn a_crowded_root_is_cut_and_told_once() {
    let dir = tempfile::tempdir().unwrap();
    let root = fs::canonicalize(dir.path()).unwrap();
    for i in 0..5 {
        fs::write(root.join(format!("{i}.dxf")), b"").unwrap();
    }
    let names = Names::new(&root, 0, &["dxf".into()], &[], &[]).unwrap();
    assert!(!list(&root, &names, 5).unwrap().is_cut);
    let (mut eyes, events) = eyes(&root, 0);
    for _ in 0..2 {
        let cut = list(&root, &names, 4).unwrap();
        assert!(cut.is_cut);
        assert_eq!(eyes.told_if_cut(0, cut).len(), 4);
    }
    let told: Vec<Event> = events.try_iter().collect();
    assert_eq!(told, [Event::Crowded(root.clone())]);
    let mut settle = super::super::Settle::new(&[root], &[], &WatchSettings::default()).unwrap();
    settle.on_event(Duration::ZERO, told.into_iter().next().unwrap());
    let said = settle.on_tick(super::super::Now::default());
    assert!(said.iter().any(
        |a| matches!(a, super::super::Action::Problem { problem, .. } if problem.code == "too-many-files")
    ));
}

#[test]
fn a_folder_made_again_is_seen_after_rearming() {
    let dir = tempfile::tempdir().unwrap();
    let root = fs::canonicalize(dir.path()).unwrap().join("w");
    fs::create_dir(&root).unwrap();
    let (mut eyes, events) = eyes(&root, 0);
    eyes.scan(&root).unwrap();
    fs::write(root.join("a.dxf"), b"a").unwrap();
    assert!(await_touch(&events, &root.join("a.dxf")));
    fs::remove_dir_all(&root).unwrap();
    assert!(await_touch(&events, &root));
    assert_eq!(eyes.scan(&root), None);
    fs::create_dir(&root).unwrap();
    eyes.rearm(&root);
    eyes.scan(&root).unwrap();
    fs::write(root.join("b.dxf"), b"b").unwrap();
    assert!(await_touch(&events, &root.join("b.dxf")));
}

/// While the system tells of files that come and go, watches are taken away and set again: neither waits for the other.
#[test]
fn arming_and_events_do_not_wait_for_each_other() {
    const TIMES: usize = 2000;
    let dir = tempfile::tempdir().unwrap();
    let root = fs::canonicalize(dir.path()).unwrap();
    let (mut eyes, events) = eyes(&root, 0);
    let (send, ended) = mpsc::channel();
    let arming = root.clone();
    std::thread::spawn(move || {
        for _ in 0..TIMES {
            eyes.rearm(&arming);
            eyes.scan(&arming).unwrap();
        }
        send.send(eyes).unwrap();
    });
    let start = std::time::Instant::now();
    let _eyes = loop {
        assert!(start.elapsed() < Duration::from_secs(300), "each waits for the other");
        fs::write(root.join("a.dxf"), b"a").unwrap();
        fs::remove_file(root.join("a.dxf")).unwrap();
        match ended.try_recv() {
            Ok(eyes) => break eyes,
            Err(mpsc::TryRecvError::Empty) => {}
            Err(mpsc::TryRecvError::Disconnected) => panic!("the arming thread died"),
        }
        // Or they pile up.
        events.try_iter().for_each(drop);
    };
    fs::write(root.join("b.dxf"), b"b").unwrap();
    assert!(await_touch(&events, &root.join("b.dxf")));
}

#[test]
fn new_folders_are_armed_by_the_next_scan() {
    let dir = tempfile::tempdir().unwrap();
    let root = fs::canonicalize(dir.path()).unwrap();
    let (mut eyes, events) = eyes(&root, 2);
    eyes.scan(&root).unwrap();
    fs::create_dir_all(root.join("a/b")).unwrap();
    assert!(await_touch(&events, &root.join("a")));
    eyes.scan(&root).unwrap();
    fs::write(root.join("a/b/c.dxf"), b"c").unwrap();
    assert!(await_touch(&events, &root.join("a/b/c.dxf")));
}

#[test]
fn reading_is_no_event() {
    let read = notify::Event::new(EventKind::Access(AccessKind::Close(AccessMode::Read)))
        .add_path("/w/a.dxf".into());
    assert_eq!(events_of(read, &Armed::default()), []);
    let written = notify::Event::new(EventKind::Access(AccessKind::Close(AccessMode::Write)))
        .add_path("/w/a.dxf".into());
    assert_eq!(events_of(written, &Armed::default()), [Event::Touched("/w/a.dxf".into())]);
}

#[test]
fn overflow_means_lost() {
    let event = notify::Event::new(EventKind::Other).set_flag(notify::event::Flag::Rescan);
    assert!(matches!(events_of(event, &Armed::default()).as_slice(), [Event::Lost(_)]));
}

#[test]
fn refusals_name_the_limit() {
    let text = |kind| refusal(&notify::Error::new(kind));
    assert!(text(ErrorKind::MaxFilesWatch).contains("max_user_watches"));
    assert!(text(ErrorKind::Io(io::Error::from_raw_os_error(28))).contains("max_user_watches"));
    assert!(text(ErrorKind::Io(io::Error::from_raw_os_error(24))).contains("max_user_instances"));
}

#[test]
fn a_read_is_whole_or_refused() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.dxf");
    assert_eq!(read_settled(&path, |_, _| Completeness::Complete, key).0, Checked::Gone);
    fs::write(&path, b"abc").unwrap();
    let Seen::There(stat) = stat_of(&path) else { panic!() };
    let sha256 = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad".to_owned();
    let completeness = Completeness::Complete;
    assert_eq!(
        read_settled(&path, |_, _| Completeness::Complete, key).0,
        Checked::Read { stat, sha256, completeness }
    );
}

/// Hazard 30: a pipe is known without opening it, and were it opened nobody would wait for its writer.
#[cfg(unix)]
#[test]
fn a_pipe_is_never_waited_for() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("plan.dxf");
    assert!(std::process::Command::new("mkfifo").arg(&path).status().unwrap().success());
    assert!(matches!(stat_of(&path), Seen::There(Stat { kind: Kind::Other, .. })));
    assert!(matches!(read_whole(&path), Err(Checked::Unreadable(_))));
    assert_eq!(bytes_of(&path), None);
    assert!(open_at_once(&path).is_ok());
}

#[test]
fn a_panicking_judge_means_incomplete() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.dxf");
    fs::write(&path, b"abc").unwrap();
    let checked = read_settled(&path, |_, _| panic!("judge"), key).0;
    assert!(
        matches!(checked, Checked::Read { completeness: Completeness::Incomplete(_), .. }),
        "{checked:?}"
    );
}

/// Same size and restored modification time: only the change time tells (hazard 15).
#[cfg(unix)]
#[test]
fn a_restored_mtime_is_still_a_change() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.dxf");
    fs::write(&path, b"abc").unwrap();
    let before = stat_of(&path);
    let mtime = fs::metadata(&path).unwrap().modified().unwrap();
    std::thread::sleep(Duration::from_millis(30));
    fs::write(&path, b"abd").unwrap();
    fs::File::options().write(true).open(&path).unwrap().set_modified(mtime).unwrap();
    assert_ne!(before, stat_of(&path));
}

/// Dates of broken clocks are only labels (hazard 15).
#[test]
fn odd_dates_are_taken_as_they_are() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.dxf");
    fs::write(&path, b"abc").unwrap();
    let hour = Duration::from_secs(3600);
    let dates =
        [UNIX_EPOCH, UNIX_EPOCH + hour * 1_130_000, std::time::SystemTime::now() + hour, UNIX_EPOCH - hour];
    for date in dates {
        fs::File::options().write(true).open(&path).unwrap().set_modified(date).unwrap();
        let Seen::There(stat) = stat_of(&path) else { panic!() };
        assert_eq!(stat.mtime_ns, nanos_since_epoch(date));
        assert!(matches!(read_settled(&path, |_, _| Completeness::Complete, key).0, Checked::Read { .. }));
    }
}

#[cfg(target_os = "linux")]
#[test]
fn network_drives_are_known() {
    for magic in [0x6969, 0xFF53_4D42, 0xFE53_4D42, 0x0102_1997, 0x6573_5546] {
        assert!(network_name(magic).is_some(), "{magic:x}");
    }
    for (local, magic) in
        [("ext4", 0xEF53), ("btrfs", 0x9123_683E), ("tmpfs", 0x0102_1994), ("xfs", 0x5846_5342)]
    {
        assert_eq!(network_name(magic), None, "{local}");
    }
}

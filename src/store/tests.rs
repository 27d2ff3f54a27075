use std::collections::BTreeMap;
use std::sync::Mutex;
use std::time::Duration;

use super::*;
use enfilade_report::{Cancel, Problem, Severity};

/// A disk whose k-th call fails, once or for ever after ("the process was killed there").
struct FaultyDisk {
    calls: Mutex<usize>,
    fail_at: usize,
    kind: io::ErrorKind,
    is_dead_after: bool,
}

impl FaultyDisk {
    fn new(fail_at: usize, kind: io::ErrorKind, is_dead_after: bool) -> Arc<Self> {
        Arc::new(Self { calls: Mutex::new(0), fail_at, kind, is_dead_after })
    }

    fn calls(&self) -> usize {
        *self.calls.lock().unwrap()
    }

    fn count(&self) -> io::Result<()> {
        let mut calls = self.calls.lock().unwrap();
        *calls += 1;
        let is_hit = *calls == self.fail_at || (self.is_dead_after && *calls > self.fail_at);
        if is_hit { Err(self.kind.into()) } else { Ok(()) }
    }
}

impl Disk for FaultyDisk {
    fn create_folder(&self, path: &Path) -> io::Result<()> {
        self.count()?;
        SystemDisk.create_folder(path)
    }
    fn create_folders(&self, path: &Path) -> io::Result<()> {
        self.count()?;
        SystemDisk.create_folders(path)
    }
    /// Fails with half of the bytes written, as a full disk does.
    fn write_new(&self, path: &Path, bytes: &[u8]) -> io::Result<()> {
        match self.count() {
            Ok(()) => SystemDisk.write_new(path, bytes),
            Err(e) if *self.calls.lock().unwrap() == self.fail_at => {
                SystemDisk.write_new(path, &bytes[..bytes.len() / 2]).and(Err(e))
            }
            Err(e) => Err(e),
        }
    }
    fn append(&self, path: &Path, bytes: &[u8], is_durable: bool) -> io::Result<()> {
        match self.count() {
            Ok(()) => SystemDisk.append(path, bytes, is_durable),
            Err(e) if *self.calls.lock().unwrap() == self.fail_at => {
                SystemDisk.append(path, &bytes[..bytes.len() / 2], false).and(Err(e))
            }
            Err(e) => Err(e),
        }
    }
    fn sync(&self, path: &Path) -> io::Result<()> {
        self.count()?;
        SystemDisk.sync(path)
    }
    fn rename(&self, from: &Path, to: &Path) -> io::Result<()> {
        self.count()?;
        SystemDisk.rename(from, to)
    }
    fn rename_new(&self, from: &Path, to: &Path) -> io::Result<()> {
        self.count()?;
        SystemDisk.rename_new(from, to)
    }
    fn exchange(&self, a: &Path, b: &Path) -> io::Result<()> {
        self.count()?;
        SystemDisk.exchange(a, b)
    }
    fn remove_folder(&self, path: &Path) -> io::Result<()> {
        self.count()?;
        SystemDisk.remove_folder(path)
    }
    fn remove_file(&self, path: &Path) -> io::Result<()> {
        self.count()?;
        SystemDisk.remove_file(path)
    }
    fn free_bytes(&self, path: &Path) -> io::Result<u64> {
        SystemDisk.free_bytes(path)
    }
}

/// A disk without the exchange of folders, as network drives are.
struct PlainDisk(Arc<FaultyDisk>);

impl Disk for PlainDisk {
    fn create_folder(&self, path: &Path) -> io::Result<()> {
        self.0.create_folder(path)
    }
    fn create_folders(&self, path: &Path) -> io::Result<()> {
        self.0.create_folders(path)
    }
    fn write_new(&self, path: &Path, bytes: &[u8]) -> io::Result<()> {
        self.0.write_new(path, bytes)
    }
    fn append(&self, path: &Path, bytes: &[u8], is_durable: bool) -> io::Result<()> {
        self.0.append(path, bytes, is_durable)
    }
    fn sync(&self, path: &Path) -> io::Result<()> {
        self.0.sync(path)
    }
    fn rename(&self, from: &Path, to: &Path) -> io::Result<()> {
        self.0.rename(from, to)
    }
    fn rename_new(&self, from: &Path, to: &Path) -> io::Result<()> {
        self.0.rename_new(from, to)
    }
    fn exchange(&self, _: &Path, _: &Path) -> io::Result<()> {
        Err(io::ErrorKind::Unsupported.into())
    }
    fn remove_folder(&self, path: &Path) -> io::Result<()> {
        self.0.remove_folder(path)
    }
    fn remove_file(&self, path: &Path) -> io::Result<()> {
        self.0.remove_file(path)
    }
    fn free_bytes(&self, path: &Path) -> io::Result<u64> {
        self.0.free_bytes(path)
    }
}

const NEVER: usize = usize::MAX;

fn sound() -> Arc<FaultyDisk> {
    FaultyDisk::new(NEVER, io::ErrorKind::Other, false)
}

fn out(path: &str, bytes: &[u8]) -> OutFile {
    OutFile { path: path.into(), bytes: bytes.into() }
}

fn set(tag: &str) -> Vec<OutFile> {
    vec![
        out("result.json", tag.as_bytes()),
        out("a/b.png", b"pixels"),
        out("candidate-1.dxf", tag.as_bytes()),
    ]
}

fn home(disk: Arc<dyn Disk>, drawing: &Path) -> Result<Home, Error> {
    Home::open(disk, drawing, &Placing::default())
}

fn code(error: &Error) -> &'static str {
    error.problem().unwrap().code
}

/// All files below a folder with their content, temporary ones and ours without meaning left out.
fn visible(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    fn walk(folder: &Path, root: &Path, out: &mut BTreeMap<PathBuf, Vec<u8>>) {
        let Ok(entries) = fs::read_dir(folder) else { return };
        for path in entries.map(|e| e.unwrap().path()) {
            let is_hidden = path.file_name().unwrap().to_string_lossy().starts_with('.');
            if is_hidden {
            } else if path.is_dir() {
                walk(&path, root, out);
            } else {
                out.insert(path.strip_prefix(root).unwrap().into(), fs::read(&path).unwrap());
            }
        }
    }
    let mut out = BTreeMap::new();
    walk(folder, folder, &mut out);
    out
}

fn has_temporary(folder: &Path) -> bool {
    fs::read_dir(folder).unwrap().any(|e| e.unwrap().file_name().to_string_lossy().starts_with(TEMP_PREFIX))
}

fn expected(folder: &str, files: &[OutFile]) -> BTreeMap<PathBuf, Vec<u8>> {
    files.iter().map(|f| (Path::new(folder).join(&f.path), f.bytes.clone())).collect()
}

#[test]
fn rounds_count_up() {
    let dir = tempfile::tempdir().unwrap();
    let home = home(sound(), &dir.path().join("plan.dxf")).unwrap();
    assert_eq!(home.next_round(), 1);
    home.stage(&set("a")).unwrap().publish_round(1).unwrap();
    fs::create_dir(home.folder().join("round-07")).unwrap();
    fs::create_dir(home.folder().join("round-x")).unwrap();
    assert_eq!((home.rounds(), home.next_round()), (vec![1, 7], 8));
    assert_eq!(visible(home.folder()), expected("round-01", &set("a")));
    let taken = home.stage(&set("b")).unwrap().publish_round(7).unwrap_err();
    assert_eq!(code(&taken), "file-exists");
    assert!(!has_temporary(home.folder()));
    assert_eq!(round_name(100), "round-100");
}

#[test]
fn analysis_is_replaced_whole_and_only_when_it_differs() {
    let dir = tempfile::tempdir().unwrap();
    let disk = sound();
    let home = home(disk.clone(), &dir.path().join("plan.dxf")).unwrap();
    home.publish_analysis(&set("a")).unwrap();
    let calls = disk.calls();
    home.publish_analysis(&set("a")).unwrap();
    assert_eq!(disk.calls(), calls, "equal content was rewritten");
    let fewer = &set("a")[..2];
    home.publish_analysis(fewer).unwrap();
    // What another analysis was asked for stays.
    assert_eq!(visible(home.folder()), expected("analysis", &set("a")));
    assert!(!has_temporary(home.folder()));
}

/// Every call of the disk fails in turn: the set is there whole or not at all, nothing is left over,
/// and the next attempt succeeds.
#[test]
fn a_failure_at_any_call_leaves_all_or_nothing() {
    for kind in [io::ErrorKind::StorageFull, io::ErrorKind::PermissionDenied] {
        let mut k = 0;
        loop {
            k += 1;
            let dir = tempfile::tempdir().unwrap();
            let drawing = dir.path().join("plan.dxf");
            fs::write(&drawing, b"input").unwrap();
            let before = home(sound(), &drawing).unwrap();
            before.publish_analysis(&set("old")).unwrap();
            drop(before);
            let disk = FaultyDisk::new(k, kind, false);
            let outcome = publish_both(disk.clone(), &drawing);
            let folder = dir.path().join("plan.enfilade");
            check_whole(&folder, &format!("call {k}, {kind:?}"));
            assert_eq!(fs::read(&drawing).unwrap(), b"input");
            if let Err(error) = outcome {
                assert!(matches!(error, Error::Environment(_)));
                assert!(["disk-full", "no-permission"].contains(&code(&error)), "{error}");
            }
            publish_both(sound(), &drawing).unwrap();
            assert!(!has_temporary(&folder), "call {k}");
            if disk.calls() < k {
                break;
            }
        }
        assert!(k > 15, "only {k} calls");
    }
}

/// The process dies at every call in turn (nothing works afterwards, nothing is cleaned up): the next
/// start finds whole sets only and sweeps the rest.
#[test]
fn a_kill_at_any_call_leaves_all_or_nothing() {
    for has_exchange in [true, false] {
        let mut k = 0;
        loop {
            k += 1;
            let dir = tempfile::tempdir().unwrap();
            let drawing = dir.path().join("plan.dxf");
            home(sound(), &drawing).unwrap().publish_analysis(&set("old")).unwrap();
            let faulty = FaultyDisk::new(k, io::ErrorKind::Other, true);
            let disk: Arc<dyn Disk> =
                if has_exchange { faulty.clone() } else { Arc::new(PlainDisk(faulty.clone())) };
            let _ = publish_both(disk, &drawing);
            let folder = dir.path().join("plan.enfilade");
            let again = home(sound(), &drawing).unwrap();
            check_whole(&folder, &format!("call {k}"));
            assert!(!has_temporary(&folder), "call {k}");
            drop(again);
            if faulty.calls() < k {
                break;
            }
        }
    }
}

fn publish_both(disk: Arc<dyn Disk>, drawing: &Path) -> Result<(), Error> {
    let home = home(disk, drawing)?;
    home.write_status(&serde_json::json!({"state": "running"}))?;
    home.publish_analysis(&set("new"))?;
    let number = home.next_round();
    home.stage(&set("round"))?.publish_round(number)?;
    home.write_status(&serde_json::json!({"state": "done"}))
}

/// The old or the new analysis, and no round or whole ones, and a status that parses.
fn check_whole(folder: &Path, at: &str) {
    let all = visible(folder);
    let below = |name: &str| -> BTreeMap<PathBuf, Vec<u8>> {
        all.iter().filter(|(p, _)| p.starts_with(name)).map(|(p, b)| (p.clone(), b.clone())).collect()
    };
    let analysis = below("analysis");
    let is_old_or_new = ["old", "new"].iter().any(|tag| analysis == expected("analysis", &set(tag)));
    assert!(is_old_or_new, "{at}: analysis {:?}", analysis.keys());
    for entry in fs::read_dir(folder).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        if name.starts_with("round-") {
            assert_eq!(below(&name), expected(&name, &set("round")), "{at}");
        }
    }
    if let Some(status) = all.get(Path::new("status.json")) {
        serde_json::from_slice::<Value>(status).unwrap();
    }
}

#[test]
fn a_dropped_set_vanishes() {
    let dir = tempfile::tempdir().unwrap();
    let home = home(sound(), &dir.path().join("plan.dxf")).unwrap();
    drop(home.stage(&set("a")).unwrap());
    assert!(visible(home.folder()).is_empty());
    assert!(!has_temporary(home.folder()));
}

#[test]
fn output_names_stay_below() {
    let dir = tempfile::tempdir().unwrap();
    let home = home(sound(), &dir.path().join("plan.dxf")).unwrap();
    for bad in ["../x", "/etc/x", "", ".", "a/../../b"] {
        let error = home.stage(&[out(bad, b"")]).err().unwrap();
        assert_eq!(code(&error), "bad-output-name", "{bad}");
    }
    // Two names that are one on other systems (hazard 18).
    let error = home.stage(&[out("a.png", b""), out("A.png", b"")]).err().unwrap();
    assert_eq!(code(&error), "bad-output-name");
}

#[test]
fn free_space_is_checked_before() {
    struct Full(FaultyDisk);
    let dir = tempfile::tempdir().unwrap();
    impl Disk for Full {
        fn create_folder(&self, path: &Path) -> io::Result<()> {
            assert!(!path.to_string_lossy().contains(TEMP_PREFIX), "written in spite of a full disk");
            self.0.create_folder(path)
        }
        fn create_folders(&self, path: &Path) -> io::Result<()> {
            self.0.create_folders(path)
        }
        fn write_new(&self, path: &Path, bytes: &[u8]) -> io::Result<()> {
            self.0.write_new(path, bytes)
        }
        fn append(&self, path: &Path, bytes: &[u8], is_durable: bool) -> io::Result<()> {
            self.0.append(path, bytes, is_durable)
        }
        fn sync(&self, path: &Path) -> io::Result<()> {
            self.0.sync(path)
        }
        fn rename(&self, from: &Path, to: &Path) -> io::Result<()> {
            self.0.rename(from, to)
        }
        fn rename_new(&self, from: &Path, to: &Path) -> io::Result<()> {
            self.0.rename_new(from, to)
        }
        fn exchange(&self, a: &Path, b: &Path) -> io::Result<()> {
            self.0.exchange(a, b)
        }
        fn remove_folder(&self, path: &Path) -> io::Result<()> {
            self.0.remove_folder(path)
        }
        fn remove_file(&self, path: &Path) -> io::Result<()> {
            self.0.remove_file(path)
        }
        fn free_bytes(&self, _: &Path) -> io::Result<u64> {
            Ok(FREE_SPACE_FLOOR)
        }
    }
    let disk =
        FaultyDisk { calls: Mutex::new(0), fail_at: NEVER, kind: io::ErrorKind::Other, is_dead_after: false };
    let home = home(Arc::new(Full(disk)), &dir.path().join("plan.dxf")).unwrap();
    assert_eq!(code(&home.stage(&set("a")).err().unwrap()), "disk-full");
}

#[test]
fn a_second_process_is_kept_out() {
    let dir = tempfile::tempdir().unwrap();
    let drawing = dir.path().join("plan.dxf");
    let first = home(sound(), &drawing).unwrap();
    assert_eq!(code(&home(sound(), &drawing).err().unwrap()), "drawing-busy");
    drop(first);
    home(sound(), &drawing).unwrap();
}

/// Hazard 18 and `plan.ifc` beside `plan.dxf`: each drawing has its own folder, and keeps it.
#[test]
fn every_drawing_has_its_own_folder() {
    let dir = tempfile::tempdir().unwrap();
    let find = |name: &str, placing: &Placing| {
        let drawing = dir.path().join(name);
        fs::create_dir_all(drawing.parent().unwrap()).unwrap();
        fs::write(&drawing, b"").unwrap();
        let folder = find_folder(&SystemDisk, &drawing, placing).unwrap();
        folder.file_name().unwrap().to_str().unwrap().to_owned()
    };
    let beside = Placing::default();
    assert_eq!(find("plan.dxf", &beside), "plan.enfilade");
    assert_eq!(find("plan.ifc", &beside), "plan.ifc.enfilade");
    assert_eq!(find("plan.dxf", &beside), "plan.enfilade");
    assert_eq!(find("Plan.dxf", &beside), "Plan.enfilade");
    fs::remove_file(dir.path().join("plan.dxf")).unwrap();
    assert_eq!(find("plan.dwg", &beside), "plan.enfilade", "a folder whose drawing is gone is free");
    let together = Placing { out_dir: Some(dir.path().join("out")), fallback_dir: None };
    let names: Vec<String> =
        ["x/plan.dxf", "y/plan.dxf", "z/plan.dxf"].iter().map(|n| find(n, &together)).collect();
    assert_eq!(names[..2], ["plan.enfilade", "plan.dxf.enfilade"]);
    assert!(names[2].starts_with("plan-") && names[2].ends_with(".enfilade"), "{}", names[2]);
    assert_eq!(find("z/plan.dxf", &together), names[2]);
}

#[test]
fn long_and_odd_names_work() {
    let dir = tempfile::tempdir().unwrap();
    let long = format!("{}.dxf", "ä".repeat(125));
    assert_eq!(long.len(), 254);
    let names = [
        long.as_str(),
        "a\nb.dxf",
        "-x.dxf",
        "a;b.dxf",
        "CON.dxf",
        "plan .dxf",
        "平面図.dxf",
        "e\u{301}.dxf",
        "\u{e9}.dxf",
    ];
    let mut folders = Vec::new();
    for name in names {
        let home = home(sound(), &dir.path().join(name)).unwrap();
        home.stage(&set("a")).unwrap().publish_round(1).unwrap();
        folders.push(home.folder().to_path_buf());
    }
    folders.sort();
    folders.dedup();
    assert_eq!(folders.len(), names.len());
}

#[cfg(unix)]
#[test]
fn a_pipe_is_written_into_and_stays() {
    use std::os::unix::fs::FileTypeExt;
    let dir = tempfile::tempdir().unwrap();
    let pipe = dir.path().join("pipe");
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let reader = std::thread::spawn({
        let pipe = pipe.clone();
        move || fs::read(pipe).unwrap()
    });
    replace_file(&SystemDisk, &pipe, b"picture").unwrap();
    assert_eq!(reader.join().unwrap(), b"picture");
    assert!(fs::symlink_metadata(&pipe).unwrap().file_type().is_fifo());
    assert_eq!(fs::read_dir(&dir).unwrap().count(), 1);
}

#[cfg(unix)]
#[test]
fn links_are_refused() {
    let dir = tempfile::tempdir().unwrap();
    let elsewhere = tempfile::tempdir().unwrap();
    let link = |name: &str| std::os::unix::fs::symlink(elsewhere.path(), dir.path().join(name)).unwrap();
    link("plan.enfilade");
    assert_eq!(code(&home(sound(), &dir.path().join("plan.dxf")).err().unwrap()), "output-is-link");
    let own = home(sound(), &dir.path().join("flat.dxf")).unwrap();
    link("flat.enfilade/analysis");
    link("flat.enfilade/status.json");
    assert_eq!(code(&own.publish_analysis(&set("a")).unwrap_err()), "output-is-link");
    assert_eq!(code(&own.write_status(&Value::Null).unwrap_err()), "output-is-link");
    link(".enfilade");
    let state = state_folder(&SystemDisk, dir.path(), &Placing::default()).unwrap_err();
    assert_eq!(code(&state), "output-is-link");
    assert_eq!(fs::read_dir(elsewhere.path()).unwrap().count(), 0);
}

/// Hazard 19: where the place beside the drawing cannot be written, the fallback is used, or the error
/// says what to do.
#[test]
fn a_read_only_place_has_a_fallback() {
    let dir = tempfile::tempdir().unwrap();
    let drawing = dir.path().join("plan.dxf");
    let refusing = || FaultyDisk::new(1, io::ErrorKind::PermissionDenied, false);
    let error = home(refusing(), &drawing).err().unwrap();
    assert_eq!(code(&error), "no-permission");
    assert!(error.to_string().contains("--out"));
    let placing = Placing { out_dir: None, fallback_dir: Some(dir.path().join("else")) };
    let home = Home::open(refusing(), &drawing, &placing).unwrap();
    assert_eq!(home.folder(), dir.path().join("else/plan.enfilade"));
    let state = state_folder(&*refusing(), dir.path(), &placing).unwrap();
    assert!(state.starts_with(dir.path().join("else")));
}

/// The same option accepted by several at one moment is one drawing, new to one of them.
#[test]
fn what_is_accepted_at_once_is_one_drawing() {
    for _ in 0..50 {
        let dir = tempfile::tempdir().unwrap();
        let accept = || write_revision(&SystemDisk, &dir.path().join("plan.dxf"), &[7; 9_000]).unwrap();
        let all: Vec<Revision> = std::thread::scope(|scope| {
            let threads: Vec<_> = (0..4).map(|_| scope.spawn(accept)).collect();
            threads.into_iter().map(|t| t.join().unwrap()).collect()
        });
        assert!(all.iter().all(|r| r.path.ends_with("plan-r02.dxf")), "{all:?}");
        assert_eq!(all.iter().filter(|r| r.is_new).count(), 1);
    }
}

#[test]
fn revisions_take_the_next_free_name() {
    let dir = tempfile::tempdir().unwrap();
    let write = |name: &str, bytes: &[u8]| {
        let Revision { path, is_new } = write_revision(&SystemDisk, &dir.path().join(name), bytes).unwrap();
        (path.file_name().unwrap().to_str().unwrap().to_owned(), is_new)
    };
    let new = |name: &str| (name.to_owned(), true);
    fs::write(dir.path().join("plan-r03.dxf"), b"mine").unwrap();
    assert_eq!(write("plan.dxf", b"one"), new("plan-r02.dxf"));
    assert_eq!(write("plan.dxf", b"two"), new("plan-r04.dxf"));
    // The same option again is the same file.
    assert_eq!(write("plan.dxf", b"two"), ("plan-r04.dxf".into(), false));
    assert_eq!(write("plan.dxf", b"one"), ("plan-r02.dxf".into(), false));
    assert_eq!(write("plan-r04.dxf", b"one"), new("plan-r05.dxf"));
    assert_eq!(write("a-r1.dxf", b"one"), new("a-r1-r02.dxf"));
    assert_eq!(write("-r02.dxf", b"one"), new("-r02-r02.dxf"));
    // A building of the same name and settings that somebody wrote keep theirs.
    assert_eq!(write("plan.ifc", b"house"), new("plan-r06.ifc"));
    assert_eq!(write("plan.ifc", b"house"), ("plan-r06.ifc".into(), false));
    assert_eq!(write("packed.ifczip", b"house"), new("packed-r02.ifc"));
    fs::write(dir.path().join("plan-r07.enfilade.toml"), b"# mine").unwrap();
    assert_eq!(write("plan.dxf", b"three"), new("plan-r08.dxf"));
    assert_eq!(fs::read(dir.path().join("plan-r03.dxf")).unwrap(), b"mine");
    assert!(!has_temporary(dir.path()));
}

/// What a killed job remembered is found again, also where the last of it is torn; a link is no memory.
#[test]
fn a_job_finds_its_memory_until_it_is_done() {
    let dir = tempfile::tempdir().unwrap();
    let drawing = dir.path().join("plan.dxf");
    let disk: Arc<dyn Disk> = Arc::new(SystemDisk);
    let open = || home(disk.clone(), &drawing).unwrap();
    assert!(open().memory().is_empty());
    open().remember(b"one", true).unwrap();
    open().remember(b" two", false).unwrap();
    assert_eq!(open().memory(), b"one two");
    open().remember(b"three", true).unwrap();
    assert_eq!(open().memory(), b"three");
    open().forget();
    assert!(open().memory().is_empty());
    #[cfg(unix)]
    {
        let elsewhere = dir.path().join("elsewhere");
        fs::write(&elsewhere, b"not ours").unwrap();
        std::os::unix::fs::symlink(&elsewhere, open().folder().join(MEMORY)).unwrap();
        assert!(open().memory().is_empty());
        for is_anew in [true, false] {
            assert_eq!(code(&open().remember(b"x", is_anew).unwrap_err()), "output-is-link");
        }
        assert_eq!(fs::read(&elsewhere).unwrap(), b"not ours");
    }
}

#[test]
fn too_large_a_memory_is_none_of_ours() {
    let dir = tempfile::tempdir().unwrap();
    let home = home(sound(), &dir.path().join("plan.dxf")).unwrap();
    home.remember(b"kept", true).unwrap();
    assert_eq!(home.memory(), b"kept");
    let file = File::options().write(true).open(home.folder().join(MEMORY)).unwrap();
    file.set_len(own::OWN_BYTES_MAX + 1).unwrap();
    assert!(home.memory().is_empty());
}

#[test]
fn equal_bytes_are_not_rewritten() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("status.json");
    write_json(&SystemDisk, &path, &serde_json::json!({"a": 1})).unwrap();
    let disk = sound();
    write_json(&*disk, &path, &serde_json::json!({"a": 1})).unwrap();
    assert_eq!(disk.calls(), 0);
    write_json(&*disk, &path, &serde_json::json!({"a": 2})).unwrap();
    assert_ne!(disk.calls(), 0);
}

const TIME: &str = "2026-01-01T00:00:00Z";

fn publishing(folder: &Path) -> Step {
    Step::Publishing { folder: folder.into(), outputs: vec!["0utput".into()] }
}

#[test]
fn the_journal_survives_a_restart() {
    let dir = tempfile::tempdir().unwrap();
    let open = || Journal::open(sound(), dir.path()).unwrap();
    let mut journal = open();
    let plan = Path::new("sub/plan.dxf");
    journal.append(plan, "a", "c", TIME, &Step::Started).unwrap();
    assert!(open().end_of(plan, "a", "c").is_none());
    journal.append(plan, "a", "c", TIME, &publishing(&dir.path().join("round-01"))).unwrap();
    assert!(open().end_of(plan, "a", "c").is_none(), "the folder never appeared");
    fs::create_dir(dir.path().join("round-01")).unwrap();
    assert!(open().end_of(plan, "a", "c").is_some(), "the folder is there");
    fs::remove_dir(dir.path().join("round-01")).unwrap();
    journal.append(plan, "a", "c", TIME, &Step::Finished("5 candidates".into())).unwrap();
    assert!(
        open().end_of(plan, "a", "c").is_some(),
        "results that the user deleted are not made again (hazard 28)"
    );
    for (sha, config) in [("b", "c"), ("a", "d")] {
        assert!(open().end_of(plan, sha, config).is_none());
    }
    assert!(open().is_output("0utput") && !open().is_output("a"));
    let problem =
        Problem { code: "x", severity: Severity::Error, place: Place::default(), text: "bad".into() };
    journal.append(plan, "b", "c", TIME, &Step::Failed(problem)).unwrap();
    let end = open().end_of(plan, "b", "c");
    assert!(matches!(end, Some(Ended::Failed(p)) if p.text == "bad"));
    assert_eq!(open().end_of(plan, "a", "c"), None);
    journal.append(plan, "b", "c", TIME, &Step::Cancelled).unwrap();
    assert_eq!(open().end_of(plan, "b", "c"), Some(Ended::Cancelled));
    journal.append(plan, "b", "c", TIME, &Step::Queued).unwrap();
    assert_eq!(open().end_of(plan, "b", "c"), None, "asked for again");
}

/// The journal cut at every byte: what was whole before the cut counts, and writing goes on.
#[test]
fn a_torn_journal_is_continued() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("journal.jsonl");
    let mut journal = Journal::open(sound(), dir.path()).unwrap();
    for name in ["a.dxf", "b.dxf"] {
        journal.append(Path::new(name), "s", "c", TIME, &Step::Finished(String::new())).unwrap();
    }
    let whole = fs::read(&path).unwrap();
    let first = whole.iter().position(|b| *b == b'\n').unwrap();
    for cut in 0..=whole.len() {
        fs::write(&path, &whole[..cut]).unwrap();
        let mut torn = Journal::open(sound(), dir.path()).unwrap();
        assert_eq!(torn.end_of(Path::new("a.dxf"), "s", "c").is_some(), cut >= first, "cut {cut}");
        torn.append(Path::new("c.dxf"), "s", "c", TIME, &Step::Finished(String::new())).unwrap();
        let again = Journal::open(sound(), dir.path()).unwrap();
        assert!(again.end_of(Path::new("c.dxf"), "s", "c").is_some(), "cut {cut}");
        assert_eq!(again.end_of(Path::new("a.dxf"), "s", "c").is_some(), cut >= first, "cut {cut}");
    }
}

#[test]
fn a_failed_append_spoils_no_later_line() {
    let dir = tempfile::tempdir().unwrap();
    let disk = FaultyDisk::new(1, io::ErrorKind::StorageFull, false);
    let mut journal = Journal::open(disk, dir.path()).unwrap();
    let step = Step::Finished(String::new());
    let error = journal.append(Path::new("a.dxf"), "s", "c", TIME, &step).unwrap_err();
    assert_eq!(code(&error), "disk-full");
    assert!(journal.end_of(Path::new("a.dxf"), "s", "c").is_some());
    journal.append(Path::new("b.dxf"), "s", "c", TIME, &step).unwrap();
    assert!(Journal::open(sound(), dir.path()).unwrap().end_of(Path::new("b.dxf"), "s", "c").is_some());
}

#[cfg(unix)]
#[test]
fn the_journal_keeps_names_that_are_no_text() {
    use std::os::unix::ffi::OsStrExt;
    let dir = tempfile::tempdir().unwrap();
    let odd = Path::new(OsStr::from_bytes(b"pl\xffan\n.dxf"));
    let mut journal = Journal::open(sound(), dir.path()).unwrap();
    journal.append(odd, "s", "c", TIME, &Step::Finished(String::new())).unwrap();
    assert!(Journal::open(sound(), dir.path()).unwrap().end_of(odd, "s", "c").is_some());
    assert_eq!(fs::read_to_string(dir.path().join("journal.jsonl")).unwrap().lines().count(), 1);
}

#[test]
fn a_long_journal_is_shortened_and_forgets_nothing() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("journal.jsonl");
    let mut journal = Journal::open(sound(), dir.path()).unwrap();
    for name in ["a.dxf", "b.dxf"] {
        journal.append(Path::new(name), "s", "c", TIME, &publishing(Path::new("/none"))).unwrap();
        journal.append(Path::new(name), "s", "c", TIME, &Step::Finished(String::new())).unwrap();
    }
    let mut text = fs::read_to_string(&path).unwrap();
    text.push_str(&text.clone().repeat((1 << 20) / text.len() + 1));
    fs::write(&path, &text).unwrap();
    let again = Journal::open(sound(), dir.path()).unwrap();
    assert!(fs::metadata(&path).unwrap().len() < 1000);
    for journal in [again, Journal::open(sound(), dir.path()).unwrap()] {
        assert!(
            journal.end_of(Path::new("a.dxf"), "s", "c").is_some()
                && journal.end_of(Path::new("b.dxf"), "s", "c").is_some()
        );
        assert!(journal.is_output("0utput"));
    }
}

fn lease(host: &str, pid: u32, beat: u64) -> Lease {
    Lease { host: host.into(), pid, since: TIME.into(), beat, depth: 0 }
}

#[test]
fn leases_are_judged_by_their_beat_alone() {
    let beat = Duration::from_secs(10);
    let (a, b) = (lease("x", 1, 1), lease("x", 1, 2));
    let judge = |first, now, secs| judge_lease(first, now, Duration::from_secs(secs), beat);
    assert_eq!(judge(None, None, 0), LeaseVerdict::Free);
    assert_eq!(judge(Some(&a), Some(&a), 0), LeaseVerdict::Wait);
    assert_eq!(judge(Some(&a), Some(&a), 29), LeaseVerdict::Wait);
    assert_eq!(judge(Some(&a), Some(&a), 30), LeaseVerdict::Free);
    assert_eq!(judge(Some(&a), Some(&b), 5), LeaseVerdict::Owned);
    assert_eq!(judge(Some(&a), None, 5), LeaseVerdict::Free);
    assert_eq!(judge(None, Some(&a), 5), LeaseVerdict::Owned);
}

#[test]
fn one_owner_a_folder() {
    let dir = tempfile::tempdir().unwrap();
    let beat = Duration::from_millis(50);
    let take = |me: Lease| Ownership::take(sound(), dir.path(), me, beat, &Cancel::default());
    let mut first = take(lease("here", 1, 0)).unwrap();
    let error = take(lease("here", 2, 0)).err().unwrap();
    assert_eq!(code(&error), "folder-owned");
    assert!(error.to_string().contains("process 1 on here"), "{error}");
    assert!(first.beat().unwrap());
    drop(first);
    assert_eq!(read_lease(dir.path()), None);
    // What a killed process of this machine leaves is no obstacle: its lock went with it.
    fs::write(dir.path().join("owner.json"), serde_json::to_vec(&lease("here", 7, 3)).unwrap()).unwrap();
    drop(take(lease("here", 2, 0)).unwrap());
    // A dead lease of another machine is waited for and then taken; that machine learns of it.
    fs::write(dir.path().join("owner.json"), serde_json::to_vec(&lease("there", 7, 3)).unwrap()).unwrap();
    let mut second = take(lease("here", 2, 0)).unwrap();
    fs::write(dir.path().join("owner.json"), serde_json::to_vec(&lease("there", 8, 0)).unwrap()).unwrap();
    assert!(!second.beat().unwrap());
    drop(second);
    assert_eq!(read_lease(dir.path()), Some(lease("there", 8, 0)), "another's lease is not removed");
}

#[test]
fn a_living_lease_of_another_machine_is_respected() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("owner.json");
    fs::write(&path, serde_json::to_vec(&lease("there", 7, 0)).unwrap()).unwrap();
    let beats = std::thread::spawn(move || {
        std::thread::sleep(Duration::from_millis(200));
        replace_file(&SystemDisk, &path, &serde_json::to_vec(&lease("there", 7, 1)).unwrap()).unwrap();
    });
    let beat = Duration::from_secs(60);
    let taken = Ownership::take(sound(), dir.path(), lease("here", 2, 0), beat, &Cancel::default());
    beats.join().unwrap();
    assert_eq!(code(&taken.err().unwrap()), "folder-owned");
}

#[test]
fn disk_errors_have_a_remedy() {
    for (errno, want) in [
        (28, "disk-full"),
        (13, "no-permission"),
        (30, "no-permission"),
        (36, "name-too-long"),
        (5, "disk-error"),
    ] {
        let error = disk_error("writing", Path::new("/x"), &io::Error::from_raw_os_error(errno));
        assert!(matches!(error, Error::Environment(_)));
        assert_eq!(code(&error), want, "{errno}");
    }
}

/// Results may go elsewhere; a file that the user asks for by its place may not, and no option is named that is not there.
#[test]
fn a_new_file_that_cannot_be_written_sends_no_results_elsewhere() {
    let dir = tempfile::tempdir().unwrap();
    let kind = io::ErrorKind::PermissionDenied;
    let disk = FaultyDisk { calls: Mutex::new(0), fail_at: 1, kind, is_dead_after: false };
    let said = write_new(&disk, &dir.path().join("enfilade.toml"), b"x").unwrap_err().to_string();
    assert!(said.ends_with("; allow writing there"), "{said}");
    assert!(disk_error("writing", dir.path(), &kind.into()).to_string().ends_with("--out"));
}

#[test]
fn a_name_as_long_as_the_system_takes_gets_a_folder_it_takes_too() {
    let folder = tempfile::tempdir().unwrap();
    let drawing = folder.path().join(format!("{}.dxf", "p".repeat(MAX_NAME_BYTES - 4)));
    fs::write(&drawing, "x").unwrap();
    let home = Home::open(Arc::new(SystemDisk), &drawing, &Placing::default()).unwrap();
    let name = home.folder().file_name().unwrap().len();
    assert!(name <= MAX_NAME_BYTES && home.folder().is_dir(), "{name} bytes");
}

#[test]
fn a_name_as_long_as_the_system_takes_has_revisions_with_side_cars() {
    let folder = tempfile::tempdir().unwrap();
    for stem in ["p".repeat(MAX_NAME_BYTES - 4), "é".repeat((MAX_NAME_BYTES - 4) / 2)] {
        let mut drawing = folder.path().join(format!("{stem}.dxf"));
        for bytes in [b"one", b"two"] {
            let next = write_revision(&SystemDisk, &drawing, bytes).unwrap().path;
            let beside = next.with_extension("enfilade.toml");
            fs::write(&beside, "").unwrap();
            assert!(beside.file_name().unwrap().len() >= MAX_NAME_BYTES - 1, "cut no further than needed");
            assert_eq!(fs::read(&next).unwrap(), bytes);
            drawing = next;
        }
        assert!(drawing.to_string_lossy().ends_with("-r03.dxf"), "{drawing:?}");
    }
}

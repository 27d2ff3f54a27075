//! Event scripts of `tests/data/watch/*.script` against a world of made-up files, without sleeping.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::time::Duration;

use super::*;

const STEP: Duration = Duration::from_millis(50);
const ROOT: &str = "/w";

#[derive(Clone, Debug)]
struct FakeFile {
    stat: Stat,
    content: String,
}

/// The folder as the script has it.
#[derive(Default)]
struct World {
    files: BTreeMap<PathBuf, FakeFile>,
    root: u64,
    writes: u64,
    sleep: Duration,
}

impl World {
    fn write(&mut self, path: &Path, content: &str) {
        self.writes += 1;
        let kind = match content.split(':').next() {
            Some("cloud") => Kind::Placeholder,
            Some("link") => Kind::Link,
            Some("pipe") => Kind::Other,
            _ => Kind::File,
        };
        let size = if content.starts_with("huge") { MAX_DRAWING_BYTES + 1 } else { content.len() as u64 };
        let time = i128::from(self.writes);
        let stat = Stat { size, mtime_ns: time, ctime_ns: time, inode: self.writes, kind };
        self.files.insert(path.into(), FakeFile { stat, content: content.into() });
    }

    fn look(&self, path: &Path) -> Seen {
        match self.files.get(path).filter(|_| self.root > 0) {
            Some(f) => Seen::There(f.stat),
            None => Seen::Gone,
        }
    }

    fn check(&self, path: &Path) -> Checked {
        let Some(f) = self.files.get(path).filter(|_| self.root > 0) else { return Checked::Gone };
        let (kind, text) = f.content.split_once(':').unwrap();
        let completeness = match kind {
            "whole" => Completeness::Complete,
            "bare" => Completeness::NoEndMark,
            "half" => Completeness::Incomplete("no EOF".into()),
            "locked" => return Checked::Unreadable("permission denied".into()),
            other => panic!("nobody should read {other}"),
        };
        Checked::Read { stat: f.stat, sha256: text.into(), completeness }
    }

    fn scan(&self) -> Option<Vec<(PathBuf, Stat)>> {
        (self.root > 0).then(|| self.files.iter().map(|(p, f)| (p.clone(), f.stat)).collect())
    }

    fn identity(&self) -> Option<Identity> {
        (self.root > 0).then_some(Identity { device: 1, inode: self.root, born_ns: 0 })
    }
}

struct Run {
    settle: Settle,
    world: World,
    now: Duration,
    said: Vec<(Duration, String)>,
    looks: usize,
}

impl Run {
    fn new(settings: &WatchSettings, is_network: bool) -> Self {
        let settle = Settle::new(&[ROOT.into()], &[is_network], settings).unwrap();
        let world = World { root: 1, ..World::default() };
        Self { settle, world, now: Duration::ZERO, said: Vec::new(), looks: 0 }
    }

    /// Runs to time `t`, carrying out every action at once.
    fn run_to(&mut self, t: Duration) {
        while self.now <= t {
            loop {
                let wall = self.now + self.world.sleep;
                let actions = self.settle.on_tick(Now { mono: self.now, wall });
                if actions.is_empty() {
                    break;
                }
                actions.into_iter().for_each(|a| self.carry_out(a));
            }
            self.now += STEP;
        }
    }

    fn carry_out(&mut self, action: Action) {
        let now = self.now;
        let name = |p: &Path| {
            let name = p.strip_prefix(ROOT).unwrap_or(p).display().to_string();
            if name.is_empty() { "root".into() } else { name }
        };
        let said = match action {
            Action::Look(path) => {
                self.looks += 1;
                return self.settle.on_stat(now, &path, self.world.look(&path));
            }
            Action::Check(path) => return self.settle.on_check(now, &path, self.world.check(&path)),
            Action::Scan(root) => return self.settle.on_scan(now, &root, self.world.scan()),
            Action::LookRoot(root) => return self.settle.on_root(now, &root, self.world.identity()),
            Action::Rearm(_) => "rearm".into(),
            Action::Ready { path, sha256 } => format!("ready {} {sha256}", name(&path)),
            Action::SettingsChanged(path) => format!("settings {}", name(&path)),
            Action::Removed(path) => format!("removed {}", name(&path)),
            Action::Ignored { path, .. } => format!("ignored {}", name(&path)),
            Action::IgnoredGone(path) => format!("ignored-gone {}", name(&path)),
            Action::Offline(_) => "offline".into(),
            Action::Online(_) => "online".into(),
            Action::Problem { path, problem } => format!("problem {} {}", name(&path), problem.code),
            Action::Resolved(path) => format!("resolved {}", name(&path)),
        };
        self.said.push((now, said));
    }

    /// One line of a script: `TIME VERB …`; time `start` is before the first tick.
    fn act(&mut self, verb: &str, words: &[&str]) {
        let path = |i: usize| Path::new(ROOT).join(words[i]);
        let mut touched = Vec::new();
        match verb {
            "write" => {
                self.world.write(&path(0), words[1]);
                touched.push(path(0));
            }
            "write-unseen" => self.world.write(&path(0), words[1]),
            "touch" => touched.push(path(0)),
            "remove" => {
                self.world.files.remove(&path(0)).unwrap();
                touched.push(path(0));
            }
            "remove-unseen" => drop(self.world.files.remove(&path(0)).unwrap()),
            "rename" => {
                let file = self.world.files.remove(&path(0)).unwrap();
                self.world.files.insert(path(1), file);
                touched.extend([path(0), path(1)]);
            }
            "root" => self.world.root = words[0].parse().unwrap(),
            "again" => self.settle.again(self.now, &path(0)),
            "lost" => self.settle.on_event(self.now, Event::Lost("test".into())),
            "blind" => self.settle.on_event(self.now, Event::Blind(ROOT.into(), "limit".into())),
            "sleep" => self.world.sleep += seconds(words[0]),
            "end" => {}
            other => panic!("unknown verb {other}"),
        }
        touched.into_iter().for_each(|p| self.settle.on_event(self.now, Event::Touched(p)));
    }
}

fn seconds(text: &str) -> Duration {
    Duration::from_secs_f64(text.parse().unwrap())
}

/// Runs one script and compares everything said with its `> TIME …` lines, in order, times to 0.06 s.
fn play(name: &str, text: &str) {
    let is_network = text.contains("; network");
    let extensions = vec![if text.contains("; scenes") { "gltf" } else { "dxf" }.to_owned()];
    let poll = text.contains("; poll");
    let settings = WatchSettings { poll, depth: 2, extensions, ..WatchSettings::default() };
    let mut run = Run::new(&settings, is_network);
    let mut want = Vec::new();
    for line in text.lines().filter(|l| !l.trim().is_empty() && !l.starts_with(';')) {
        let (words, is_want) = match line.strip_prefix("> ") {
            Some(rest) => (rest, true),
            None => (line, false),
        };
        let (time, rest) = words.split_once(' ').unwrap();
        if is_want {
            want.push((seconds(time), rest.trim().to_owned()));
            continue;
        }
        if time != "start" {
            run.run_to(seconds(time));
        }
        let words: Vec<&str> = rest.split_whitespace().collect();
        run.act(words[0], &words[1..]);
    }
    let texts = |v: &[(Duration, String)]| v.iter().map(|(_, s)| s.clone()).collect::<Vec<_>>();
    assert_eq!(texts(&run.said), texts(&want), "{name}: said {:?}", run.said);
    for ((got, said), (due, _)) in run.said.iter().zip(&want) {
        let off = got.as_secs_f64() - due.as_secs_f64();
        assert!(off.abs() <= 0.101, "{name}: `{said}` at {got:?}, wanted {due:?}");
    }
}

#[test]
fn scripts() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/watch");
    let mut count = 0;
    let mut paths: Vec<PathBuf> = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    paths.sort();
    for path in paths.iter().filter(|p| p.extension().is_some_and(|e| e == "script")) {
        play(&path.display().to_string(), &std::fs::read_to_string(path).unwrap());
        count += 1;
    }
    assert!(count >= 15, "{count} scripts");
}

/// An unfinished file is asked after ever more rarely, and never given up.
#[test]
fn waiting_backs_off() {
    let settings = WatchSettings { rescan_secs: 1e6, ..WatchSettings::default() };
    let mut run = Run::new(&settings, false);
    run.run_to(STEP);
    run.act("write", &["plan.dxf", "half:a"]);
    run.run_to(seconds("4000"));
    assert!(run.looks < 25, "{} looks in 4000 s", run.looks);
    assert!(run.looks > 12, "{} looks in 4000 s", run.looks);
    let before = run.looks;
    run.run_to(seconds("4000") + Duration::from_secs_f64(3.0 * MAX_BACKOFF_SECS));
    assert!((2..=6).contains(&(run.looks - before)), "the pause grows no longer than the limit");
    assert_eq!(run.settle.pending_count(), 1);
}

/// A folder that appears is scanned; other files that are no drawings cost one look a tick.
#[test]
fn a_new_folder_is_scanned_soon() {
    let settings = WatchSettings { depth: 1, ..WatchSettings::default() };
    let mut settle = Settle::new(&[ROOT.into()], &[], &settings).unwrap();
    let at = |ms: u64| Duration::from_millis(ms);
    let tick = |settle: &mut Settle, ms: u64| settle.on_tick(Now { mono: at(ms), wall: at(ms) });
    tick(&mut settle, 0);
    settle.on_scan(at(0), Path::new(ROOT), Some(Vec::new()));
    for (name, kind, is_scanned) in [("/w/log.txt", Kind::File, false), ("/w/v1.2", Kind::Folder, true)] {
        for _ in 0..100 {
            settle.on_event(at(100), Event::Touched(name.into()));
        }
        assert_eq!(tick(&mut settle, 100), [Action::Look(name.into())]);
        settle.on_stat(at(100), Path::new(name), Seen::There(Stat { kind, ..Stat::default() }));
        let later = tick(&mut settle, 400);
        assert_eq!(later.contains(&Action::Scan(ROOT.into())), is_scanned, "{name}: {later:?}");
    }
    assert_eq!(settle.pending_count(), 0);
}

/// Our own process stood still (hazard 12): as after a sleep of the machine, all is looked at.
#[test]
fn a_gap_between_ticks_is_a_sleep() {
    let mut settle = Settle::new(&[ROOT.into()], &[], &WatchSettings::default()).unwrap();
    let tick = |settle: &mut Settle, s: u64| {
        let t = Duration::from_secs(s);
        settle.on_tick(Now { mono: t, wall: t })
    };
    tick(&mut settle, 0);
    settle.on_scan(Duration::ZERO, Path::new(ROOT), Some(Vec::new()));
    assert!(!tick(&mut settle, 20).contains(&Action::Rearm(ROOT.into())));
    let after = tick(&mut settle, 55);
    assert!(
        after.contains(&Action::Rearm(ROOT.into())) && after.contains(&Action::Scan(ROOT.into())),
        "{after:?}"
    );
}

/// A storm of events costs one look a tick, not one an event.
#[test]
fn events_are_coalesced() {
    let mut run = Run::new(&WatchSettings::default(), false);
    run.run_to(STEP);
    for _ in 0..10_000 {
        run.act("touch", &["plan.dxf"]);
    }
    run.world.write(Path::new("/w/plan.dxf"), "whole:a");
    run.run_to(seconds("2"));
    assert_eq!(run.said.len(), 1);
    assert!(run.looks <= 3, "{} looks", run.looks);
}

/// An event that arrives while the bytes are read starts the wait anew.
#[test]
fn an_event_during_the_check_counts() {
    let mut settle = Settle::new(&[ROOT.into()], &[], &WatchSettings::default()).unwrap();
    let path = Path::new("/w/plan.dxf");
    let stat = Stat { size: 1, ..Stat::default() };
    let at = |s: f64| Duration::from_secs_f64(s);
    let tick = |settle: &mut Settle, s: f64| settle.on_tick(Now { mono: at(s), wall: at(s) });
    settle.on_event(at(0.0), Event::Touched(path.into()));
    tick(&mut settle, 0.0);
    settle.on_stat(at(0.0), path, Seen::There(stat));
    assert!(tick(&mut settle, 0.7).contains(&Action::Look(path.into())));
    settle.on_stat(at(0.7), path, Seen::There(stat));
    assert!(tick(&mut settle, 0.7).contains(&Action::Check(path.into())));
    settle.on_event(at(0.8), Event::Touched(path.into()));
    let read = || Checked::Read { stat, sha256: "a".into(), completeness: Completeness::Complete };
    settle.on_check(at(0.9), path, read());
    let is_ready = |actions: Vec<Action>| actions.iter().any(|a| matches!(a, Action::Ready { .. }));
    assert!(!is_ready(tick(&mut settle, 0.9)));
    assert!(tick(&mut settle, 1.6).contains(&Action::Look(path.into())));
    settle.on_stat(at(1.6), path, Seen::There(stat));
    settle.on_check(at(1.6), path, read());
    assert!(is_ready(tick(&mut settle, 1.6)));
}

/// The file that was read must be the one that was quiet.
#[test]
fn another_file_in_the_check_is_not_taken() {
    let mut settle = Settle::new(&[ROOT.into()], &[], &WatchSettings::default()).unwrap();
    let path = Path::new("/w/plan.dxf");
    let (old, new) = (Stat { size: 1, ..Stat::default() }, Stat { size: 2, ..Stat::default() });
    let at = |s: f64| Duration::from_secs_f64(s);
    settle.on_stat(at(0.0), path, Seen::There(old));
    settle.on_stat(at(0.7), path, Seen::There(old));
    let checked = Checked::Read { stat: new, sha256: "a".into(), completeness: Completeness::Complete };
    settle.on_check(at(0.8), path, checked);
    let actions = settle.on_tick(Now { mono: at(0.8), wall: at(0.8) });
    assert!(!actions.iter().any(|a| matches!(a, Action::Ready { .. })), "{actions:?}");
    assert_eq!(settle.pending_count(), 1);
}

proptest::proptest! {
    /// Whatever happens and whichever events are lost, after a scan's interval of peace each whole
    /// file's last content was reported last, no half file ever, and nothing twice in a row.
    #[test]
    fn every_whole_content_is_reported_at_last(
        steps in proptest::collection::vec((0u8..6, 0usize..3, 0u8..3, 0.05f64..3.0), 0..40),
    ) {
        let mut run = Run::new(&WatchSettings::default(), false);
        let names = ["a.dxf", "b.dxf", "c.dxf"];
        let mut t = 0.1;
        for (verb, file, content, pause) in steps {
            run.run_to(Duration::from_secs_f64(t));
            let there = run.world.files.contains_key(&Path::new(ROOT).join(names[file]));
            let content = ["whole:1", "half:1", "whole:2"][usize::from(content)];
            match verb {
                0 | 1 => run.act("write", &[names[file], content]),
                2 => run.act("write-unseen", &[names[file], content]),
                3 if there => run.act("remove", &[names[file]]),
                4 if there => run.act("rename", &[names[file], names[(file + 1) % 3]]),
                5 if there => run.act("remove-unseen", &[names[file]]),
                _ => {}
            }
            t += pause;
        }
        run.run_to(Duration::from_secs_f64(t + 200.0));
        for name in names {
            let said: Vec<&str> = run
                .said
                .iter()
                .filter_map(|(_, s)| s.strip_prefix(&format!("ready {name} ")))
                .collect();
            match run.world.files.get(&Path::new(ROOT).join(name)).map(|f| f.content.as_str()) {
                Some(content) if content.starts_with("whole:") => {
                    proptest::prop_assert_eq!(said.last().copied(), content.strip_prefix("whole:"));
                }
                _ => {}
            }
        }
        proptest::prop_assert!(run.said.iter().all(|(_, s)| !s.contains("half")));
    }
}

/// Each is said once; a folder with more of them than the limit is not said without end.
#[test]
fn only_so_many_are_said_to_be_left_alone() {
    let mut run = Run::new(&WatchSettings::default(), false);
    for i in 0..=MAX_IGNORED {
        let path = Path::new(ROOT).join(format!("#{i}.dxf"));
        run.settle.on_event(Duration::ZERO, Event::Touched(path.clone()));
        run.settle.on_event(Duration::ZERO, Event::Touched(path));
    }
    let said = run.settle.on_tick(Now::default());
    assert_eq!(said.iter().filter(|a| matches!(a, Action::Ignored { .. })).count(), MAX_IGNORED);
}

#[test]
fn a_crowded_folder_is_named_with_its_limit() {
    let mut run = Run::new(&WatchSettings::default(), false);
    run.settle.on_event(Duration::ZERO, Event::Crowded(ROOT.into()));
    let actions = run.settle.on_tick(Now::default());
    let says = |a: &Action| match a {
        Action::Problem { problem, .. } => problem.text.contains(&MAX_SCANNED_FILES.to_string()),
        _ => false,
    };
    assert!(actions.iter().any(says), "{actions:?}");
}

/// Too many open files are no word on the folder: it stays, is looked at again, and is said once (hazard 15).
#[test]
fn want_of_open_files_is_not_out_of_reach() {
    let root = PathBuf::from("/plans");
    let settings = WatchSettings { extensions: vec!["dxf".into()], ..WatchSettings::default() };
    let mut settle = Settle::new(std::slice::from_ref(&root), &[false], &settings).unwrap();
    let at = |secs| Now { mono: Duration::from_secs(secs), wall: Duration::from_secs(secs) };
    let identity = Identity { device: 1, inode: 1, born_ns: 1 };
    settle.on_tick(at(0));
    settle.on_root(at(0).mono, &root, Some(identity));
    for secs in 1..4 {
        let actions = settle.on_tick(at(secs));
        assert!(actions.iter().any(|a| matches!(a, Action::LookRoot(_))), "{secs}: {actions:?}");
        settle.on_strain(at(secs).mono, &root, "too many");
        let said = settle.on_tick(at(secs));
        let problems = said.iter().filter(|a| matches!(a, Action::Problem { .. })).count();
        assert_eq!(problems, usize::from(secs == 1), "{said:?}");
        assert!(!said.iter().any(|a| matches!(a, Action::Offline(_))), "{said:?}");
    }
    settle.on_root(at(4).mono, &root, Some(identity));
    let said = settle.on_tick(at(4));
    assert!(said.iter().any(|a| matches!(a, Action::Resolved(p) if *p == root)), "{said:?}");
}

//! The threads that wait for disks and jobs, so that the loop need not, and what they tell it.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Sender, SyncSender, TrySendError};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Instant, SystemTime};

use super::job::{self, Told};
use super::status::{SharedDisk, rfc3339};
use super::{Asked, Done, JobRequest, RunJob, Share, WatchSettings};
use crate::store::{Journal, Placing, Step, Written};
use crate::watch::{
    Action, Checked, ContentKey, Event, Eyes, Identity, Seen, Stat, bytes_of, has_data_beside, identity_of,
    is_building_of, is_out_of_files, is_output_name, is_scene, read_settled, read_whole, sha256_hex, stat_of,
};
use enfilade_cad::gltf::outer_files;
use enfilade_config::{Partial, settings_files};
use enfilade_report::{Cancel, Error};

pub(super) enum Message {
    Event(Event),
    /// By the looker of this number; those of an earlier one looked by other settings.
    Looked(u64, Looked),
    Told(u64, Told),
    Ended(u64, Outcome),
}

/// What the looker found.
pub(super) enum Looked {
    Seen(PathBuf, Seen),
    Checked(PathBuf, Checked, Content),
    Scanned(PathBuf, Option<Vec<(PathBuf, Stat)>>),
    Root(PathBuf, Option<Identity>),
    /// The root could not be looked into for want of files that may be open, in the system's words.
    Strained(PathBuf, String),
}

pub(super) enum Outcome {
    Ended(Result<Done, Error>),
    /// The file no longer has the content that was queued.
    Changed,
}

/// A content of a drawing, and what else decides its results.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(super) struct Content {
    /// SHA-256 of the bytes.
    pub sha256: String,
    /// The same without the time at which they were written: what the content is known by.
    pub key: String,
    /// See [`config_key`].
    pub config: String,
    pub bytes: u64,
}

impl Content {
    /// Whether a job of the one is a job of the other.
    pub fn is_same(&self, other: &Self) -> bool {
        self.key == other.key && self.config == other.config
    }
}

/// One drawing content to be worked on.
#[derive(Clone, Debug)]
pub(super) struct Waiting {
    pub drawing: PathBuf,
    pub of: Content,
    pub asked: Asked,
    pub since: Instant,
    pub not_before: Option<Instant>,
    pub failures: u32,
    /// Whether an ordinary share of the memory was too little.
    pub is_hungry: bool,
}

impl Waiting {
    pub fn new(drawing: PathBuf, of: Content, asked: Asked) -> Self {
        let since = Instant::now();
        Self { drawing, of, asked, since, not_before: None, failures: 0, is_hungry: false }
    }
}

pub(super) struct Task {
    pub id: u64,
    pub what: Waiting,
    pub below: PathBuf,
    pub placing: Placing,
    pub cancel: Cancel,
    pub journal: Arc<Mutex<Journal>>,
    pub share: Share,
    pub content_key: ContentKey,
}

/// Sends the system's reports on without ever blocking it; a full inbox means that all is looked at.
pub(super) fn reporter(
    send: SyncSender<Message>,
    is_flooded: Arc<AtomicBool>,
) -> impl Fn(Event) + Send + Clone + 'static {
    move |event| {
        if let Err(TrySendError::Full(_)) = send.try_send(Message::Event(event)) {
            is_flooded.store(true, Ordering::Relaxed);
        }
    }
}

/// The thread that touches the watched folders. It ends with its sender.
pub(super) fn start_looker(
    mut eyes: Eyes,
    settings: &WatchSettings,
    number: u64,
    send: SyncSender<Message>,
) -> Sender<Action> {
    let (to_looker, tasks) = mpsc::channel::<Action>();
    let (judge, settings_key) = ((settings.end_mark, settings.content_key), settings.settings_key.clone());
    thread::spawn(move || {
        for task in tasks {
            let answer = match task {
                Action::Look(path) => Looked::Seen(path.clone(), stat_of(&path)),
                Action::Check(path) => {
                    let (checked, key) = read_settled(&path, judge.0, judge.1);
                    let (sha256, bytes) = match &checked {
                        Checked::Read { sha256, stat, .. } => (sha256.clone(), stat.size),
                        _ => Default::default(),
                    };
                    let config = config_key(&path, &settings_key);
                    Looked::Checked(path, checked, Content { sha256, key, config, bytes })
                }
                Action::Scan(root) => Looked::Scanned(root.clone(), eyes.scan(&root)),
                Action::LookRoot(root) => look_at_root(root),
                Action::Rearm(root) => {
                    eyes.rearm(&root);
                    continue;
                }
                _ => continue,
            };
            if send.send(Message::Looked(number, answer)).is_err() {
                break;
            }
        }
    });
    to_looker
}

/// One that may not be looked into is out of reach like one that is gone.
fn look_at_root(root: PathBuf) -> Looked {
    match fs::read_dir(&root) {
        Err(e) if is_out_of_files(&e) => Looked::Strained(root, e.to_string()),
        entries => {
            let identity = identity_of(&root).filter(|_| entries.is_ok());
            Looked::Root(root, identity)
        }
    }
}

/// Runs a job on a thread of its own.
pub(super) fn start_job(disk: SharedDisk, task: Task, run: Arc<RunJob>, send: SyncSender<Message>) {
    thread::spawn(move || {
        let outcome = work(disk, &task, &*run, &send);
        // Nobody hears of a job that was left behind.
        let _ = send.send(Message::Ended(task.id, outcome));
    });
}

fn work(disk: SharedDisk, task: &Task, run: &RunJob, send: &SyncSender<Message>) -> Outcome {
    let Ok((bytes, _)) = read_whole(&task.what.drawing) else { return Outcome::Changed };
    if (task.content_key)(&task.what.drawing, &bytes) != task.what.of.key {
        return Outcome::Changed;
    }
    let request = JobRequest {
        drawing: task.what.drawing.clone(),
        sha256: sha256_hex(&bytes),
        bytes: Arc::new(bytes),
        content: task.what.of.key.clone(),
        config: task.what.of.config.clone(),
        share: task.share,
        round: 0,
        asked: task.what.asked.clone(),
        earlier: Arc::default(),
        results: PathBuf::new(),
    };
    let note = |step: &Step| {
        let time = rfc3339(SystemTime::now());
        let of = &task.what.of;
        open_journal(&task.journal).append(&task.below, &of.key, &of.config, &time, step)
    };
    let mut tell = |told| drop(send.send(Message::Told(task.id, told)));
    let mut before = |folder: &Path, written: &[Written]| {
        let drawings = written.iter().filter(|w| is_output_name(&w.path));
        let outputs = drawings.map(|w| w.sha256.clone()).collect();
        note(&Step::Publishing { folder: folder.into(), outputs })
    };
    let outcome = job::perform(disk, &request, &task.placing, run, &task.cancel, &mut tell, &mut before);
    let noted = match &outcome {
        Ok(done) => note(&Step::Finished(done.summary.clone())),
        Err(_) => Ok(()),
    };
    if let Err(error) = noted
        && let Some(problem) = error.problem()
    {
        tell(Told::Problem(problem.clone()));
    }
    Outcome::Ended(outcome)
}

pub(super) fn open_journal(journal: &Mutex<Journal>) -> MutexGuard<'_, Journal> {
    journal.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What besides its bytes decides a drawing's results: the program, the command line, what the settings files of
/// the drawing and of its folder say of results, and the data that a scene keeps beside it.
fn config_key(drawing: &Path, settings_key: &str) -> String {
    let [own, folder] = settings_files(drawing).map(|path| bytes_of(&path).unwrap_or_default());
    let (mark, said) = match [what_it_decides(&own), what_decides(&folder)] {
        [Ok(own), Ok(folder)] => ("", format!("{:?}", own.over(folder).deciding())),
        said => {
            (UNREADABLE, said.map(|s| s.map_or_else(|e| e, |p| format!("{:?}", p.deciding()))).join("\n"))
        }
    };
    let mut text = format!("{}\n{settings_key}\n{said}\n", enfilade_config::VERSION);
    for building in buildings_beside(drawing) {
        text.push_str(&format!(
            "{}\n",
            bytes_of(&building).map_or_else(|| "-".into(), |bytes| sha256_hex(&bytes))
        ));
    }
    let scene = if has_data_beside(drawing) { bytes_of(drawing).unwrap_or_default() } else { Vec::new() };
    for name in outer_files(&scene).data {
        let digest =
            bytes_of(&drawing.with_file_name(name)).map_or_else(|| "-".into(), |bytes| sha256_hex(&bytes));
        text.push_str(&format!("{digest}\n"));
    }
    format!("{mark}{}", sha256_hex(text.as_bytes()))
}

/// Before the key of settings that cannot be read.
const UNREADABLE: &str = "unreadable-";

/// Whether a key is of settings that cannot be read.
pub(super) fn is_unreadable(config: &str) -> bool {
    config.starts_with(UNREADABLE)
}

/// The buildings of the same name beside a scene, in the order of their names; none beside another drawing.
fn buildings_beside(drawing: &Path) -> Vec<PathBuf> {
    if !is_scene(drawing) {
        return Vec::new();
    }
    let entries = drawing.parent().and_then(|folder| std::fs::read_dir(folder).ok()).into_iter().flatten();
    let mut found: Vec<PathBuf> =
        entries.flatten().map(|e| e.path()).filter(|path| is_building_of(path, drawing)).collect();
    found.sort();
    found
}

/// The same of the settings of one drawing, which are refused where they speak of watching.
fn what_it_decides(bytes: &[u8]) -> Result<Partial, String> {
    let read = std::str::from_utf8(bytes).ok().and_then(|text| Partial::from_toml("", text).ok());
    read.filter(|p| p.watch.is_none()).ok_or_else(|| sha256_hex(bytes))
}

/// What a settings file says. One that cannot be read fails its jobs, each version anew: its digest; where a fault
/// lies in `[watch]` alone, what is done stays done.
fn what_decides(bytes: &[u8]) -> Result<Partial, String> {
    let without_watch = |text: &str| {
        let mut table: toml::Table = text.parse().ok()?;
        table.remove("watch")?;
        Partial::from_toml("", &table.to_string()).ok()
    };
    let read = |text| Partial::from_toml("", text).ok().or_else(|| without_watch(text));
    let read = std::str::from_utf8(bytes).ok().and_then(read);
    read.ok_or_else(|| sha256_hex(bytes))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A full inbox never blocks the system's thread; it means one look at everything (hazard 8).
    #[test]
    fn a_flood_of_events_is_one_flag() {
        let (send, inbox) = mpsc::sync_channel(10);
        let is_flooded = Arc::new(AtomicBool::new(false));
        let report = reporter(send, is_flooded.clone());
        for i in 0..50 {
            assert_eq!(is_flooded.load(Ordering::Relaxed), i > 10, "{i}");
            report(Event::Touched(format!("{i}.dxf").into()));
        }
        assert_eq!(inbox.try_iter().count(), 10);
        drop(inbox);
        report(Event::Lost(String::new()));
    }

    #[test]
    fn the_key_of_a_job_holds_all_its_settings() {
        let dir = tempfile::tempdir().unwrap();
        let drawing = dir.path().join("sub/plan.dxf");
        fs::create_dir(dir.path().join("sub")).unwrap();
        let mut keys = vec![config_key(&drawing, ""), config_key(&drawing, "--seed 2")];
        for (file, text) in [("sub/enfilade.toml", "seed = 1"), ("sub/plan.enfilade.toml", "seed = 2")] {
            fs::write(dir.path().join(file), text).unwrap();
            keys.push(config_key(&drawing, ""));
        }
        let last = keys.last().cloned();
        keys.sort();
        keys.dedup();
        assert_eq!(keys.len(), 4);
        // Those of other drawings and of folders above are not read by any command, and do not count.
        fs::write(dir.path().join("sub/other.enfilade.toml"), b"seed = 1").unwrap();
        fs::write(dir.path().join("enfilade.toml"), b"seed = 1").unwrap();
        assert_eq!(Some(config_key(&drawing, "")), last);
        // What says in its own file what holds anyway says nothing new.
        fs::write(dir.path().join("sub/plan.enfilade.toml"), b"seed = 1").unwrap();
        let repeated = config_key(&drawing, "");
        fs::remove_file(dir.path().join("sub/plan.enfilade.toml")).unwrap();
        assert_eq!(config_key(&drawing, ""), repeated);
    }

    /// What tells only how the folder is watched, how fast and where to makes no drawing new.
    #[test]
    fn the_key_of_a_job_holds_nothing_that_decides_no_result() {
        let dir = tempfile::tempdir().unwrap();
        let key = |text: &str| {
            fs::write(dir.path().join("enfilade.toml"), text).unwrap();
            config_key(&dir.path().join("plan.dxf"), "")
        };
        fs::remove_file(dir.path().join("enfilade.toml")).ok();
        let without = config_key(&dir.path().join("plan.dxf"), "");
        assert_eq!(key("# nothing yet\n[watch]\nquiet-secs = 2.0\n"), without);
        let same = [
            "seed = 1",
            "# by hand\nseed = 1\n",
            "seed = 1\n[watch]\nquite-secs = 2.0\n",
            "seed = 1\nthreads = 2\nbackend = \"cpu\"\nout = \"r\"\n[watch]\nquiet-secs = 2.0\n",
        ];
        assert!(same.iter().all(|text| key(text) == key("seed = 1")));
        let others = ["seed = 2", "seed = 1\nspacing = 0.5", "seed = ", "seed = x", ""];
        let keys: std::collections::BTreeSet<String> = others.iter().map(|t| key(t)).collect();
        assert!(keys.len() == others.len() && !keys.contains(&key("seed = 1")));
    }

    /// A building that comes beside a scene, or changes, is a new job of it; one of another name is not.
    #[test]
    fn the_key_of_a_scene_holds_the_building_beside_it() {
        let dir = tempfile::tempdir().unwrap();
        let put = |name: &str, text: &str| fs::write(dir.path().join(name), text).unwrap();
        for scene in ["house.glb", "house.gltf"] {
            let key = || config_key(&dir.path().join(scene), "");
            put("house.IFC", "a");
            let first = key();
            put("house.IFC", "b");
            assert_ne!(key(), first);
            put("house.IFC", "a");
            put("other.ifc", "c");
            put("house.dxf", "c");
            assert_eq!(key(), first);
            fs::remove_file(dir.path().join("house.IFC")).unwrap();
            assert_ne!(key(), first);
        }
    }

    /// Settings of one drawing that speak of watching are refused: they are as such that cannot be read.
    #[test]
    fn the_key_of_a_job_says_that_its_settings_are_refused() {
        let dir = tempfile::tempdir().unwrap();
        let drawing = dir.path().join("plan.dxf");
        let without = config_key(&drawing, "");
        fs::write(dir.path().join("plan.enfilade.toml"), "[watch]\nignore = [\"x\"]\n").unwrap();
        assert!(is_unreadable(&config_key(&drawing, "")) && !is_unreadable(&without));
    }

    /// Data that come after their scene, or change, are a new job of it.
    #[test]
    fn the_key_of_a_scene_holds_its_data() {
        let dir = tempfile::tempdir().unwrap();
        let scene = dir.path().join("house.gltf");
        fs::write(&scene, br#"{"buffers":[{"uri":"data/house%201.bin"},{"uri":"../other.bin"}]}"#).unwrap();
        fs::create_dir(dir.path().join("data")).unwrap();
        let mut keys = vec![config_key(&scene, "")];
        for data in [b"a", b"b"] {
            fs::write(dir.path().join("data/house 1.bin"), data).unwrap();
            keys.push(config_key(&scene, ""));
        }
        assert!(keys[0] != keys[1] && keys[1] != keys[2] && keys[0] != keys[2]);
        fs::write(dir.path().join("other.bin"), b"not named").unwrap();
        assert_eq!(config_key(&scene, ""), keys[2]);
    }
}

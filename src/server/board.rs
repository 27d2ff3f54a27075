//! What the page shows: the daemon's notices, gathered by drawing, and pushed to whoever listens.

use std::collections::{BTreeMap, VecDeque};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::SystemTime;

use serde_json::{Value, json};
use tokio::sync::broadcast;

use crate::daemon::{BY_THE_USER, CANCELLED_BEFORE, Notice, rfc3339};
use crate::store::SO_FAR;
use crate::watch::builtin_ignores;
use enfilade_report::one_line;

/// Lines of the log that are kept.
pub const LOG_LINES_MAX: usize = 500;
/// Points of a convergence curve that are kept; of a longer one every other goes.
pub const CURVE_POINTS_MAX: usize = 1_000;
/// Files left alone that are listed with their reasons; more are counted.
pub const IGNORED_MAX: usize = 200;
/// Pages listening at the same time.
pub const LISTENERS_MAX: usize = 32;
/// News a slow page may be behind before it has to load everything again.
const BACKLOG: usize = 256;

/// See the module.
pub struct Board {
    state: Mutex<State>,
    push: broadcast::Sender<String>,
}

#[derive(Default)]
struct State {
    drawings: BTreeMap<String, Entry>,
    roots: BTreeMap<PathBuf, Watched>,
    log: VecDeque<Value>,
    /// Files left alone, and why.
    ignored: BTreeMap<PathBuf, String>,
    ignored_count: usize,
}

/// A watched folder: by what means, and whether it is out of reach just now.
#[derive(Default)]
struct Watched {
    how: String,
    is_away: bool,
}

impl Watched {
    fn words(&self) -> &str {
        if self.is_away { "out of reach" } else { &self.how }
    }
}

struct Entry {
    path: PathBuf,
    /// The result folder.
    folder: Option<PathBuf>,
    state: &'static str,
    since: String,
    summary: String,
    problem: Value,
    progress: Value,
    /// Whether a job of it waits, also while one runs.
    is_queued: bool,
    /// Ordered through the page, and no word of the daemon on it yet.
    is_ordered: bool,
    /// After how many layouts the running search last wrote its best so far.
    so_far: Option<u64>,
    /// Layouts measured and the best value, by stage.
    curve: Vec<(String, u64, f64)>,
}

impl Default for Board {
    fn default() -> Self {
        Self { state: Mutex::default(), push: broadcast::channel(BACKLOG).0 }
    }
}

impl Board {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Takes a notice in.
    pub fn take(&self, notice: &Notice) {
        let (notice, is_known) = match notice {
            Notice::Again(told) => (&**told, true),
            notice => (notice, false),
        };
        let mut state = self.state();
        let mut news = Vec::new();
        let gone = match notice {
            Notice::Removed(path) | Notice::Ignored { path, .. } => Some(id_of(path)),
            _ => None,
        };
        let gone = gone.filter(|id| state.drawings.contains_key(id));
        let is_quiet =
            matches!(notice, Notice::Progress { .. } | Notice::UpToDate { .. } | Notice::Results { .. });
        if !is_known && !is_quiet {
            let line = json!({"time": rfc3339(SystemTime::now()), "text": notice.to_string()});
            if state.log.len() >= LOG_LINES_MAX {
                state.log.pop_front();
            }
            state.log.push_back(line.clone());
            news.push(json!({"kind": "log", "line": line}));
        }
        if let Some(id) = state.note(notice) {
            news.push(json!({"kind": "drawing", "drawing": state.drawings.get(&id).map(|e| e.brief(&id))}));
        }
        if let Some(id) = gone {
            news.push(json!({"kind": "gone", "id": id}));
        }
        if is_of_folders(notice) {
            news.push(json!({"kind": "folders"}));
        }
        drop(state);
        for n in news {
            // Nobody may be listening.
            let _ = self.push.send(n.to_string());
        }
    }

    /// A listener's end of the news; `None` where too many listen.
    pub(super) fn listen(&self) -> Option<broadcast::Receiver<String>> {
        (self.push.receiver_count() < LISTENERS_MAX).then(|| self.push.subscribe())
    }

    /// All drawings in brief, and the watched folders.
    pub(super) fn overview(&self) -> Value {
        let state = self.state();
        let drawings: Vec<Value> = state.drawings.iter().map(|(id, e)| e.brief(id)).collect();
        let roots: Vec<Value> =
            state.roots.iter().map(|(r, w)| json!({"root": shown(r), "how": w.words()})).collect();
        let ignored: Vec<Value> =
            state.ignored.iter().map(|(path, why)| json!({"file": shown(path), "why": why})).collect();
        let rules: Vec<Value> =
            builtin_ignores().iter().map(|r| json!({"glob": r.glob, "why": r.why})).collect();
        json!({
            "schema": "enfilade.page/1",
            "drawings": drawings,
            "roots": roots,
            "ignored": ignored,
            "ignored_count": state.ignored_count,
            "ignore_rules": rules,
        })
    }

    /// The log, oldest first.
    pub(super) fn log(&self) -> Value {
        json!(self.state().log)
    }

    /// One drawing with its curve.
    pub(super) fn drawing(&self, id: &str) -> Option<Value> {
        let state = self.state();
        let entry = state.drawings.get(id)?;
        let mut out = entry.brief(id);
        out["curve"] = json!(entry.curve);
        Some(out)
    }

    /// Whether a job of the drawing runs, waits, or is ordered and on its way.
    pub(super) fn is_busy(&self, id: &str) -> bool {
        self.state().drawings.get(id).is_some_and(|e| e.state == "running" || e.is_queued || e.is_ordered)
    }

    /// A round of the drawing is about to be ordered; the daemon's next word on the drawing answers it.
    pub(super) fn expect(&self, id: &str) {
        if let Some(entry) = self.state().drawings.get_mut(id) {
            entry.is_ordered = true;
        }
    }

    /// Where a drawing and its results lie.
    pub(super) fn paths(&self, id: &str) -> Option<(PathBuf, Option<PathBuf>)> {
        self.state().drawings.get(id).map(|e| (e.path.clone(), e.folder.clone()))
    }
}

/// Whether a notice changes what the page says of the watched folders and of what is left alone in them.
fn is_of_folders(notice: &Notice) -> bool {
    matches!(
        notice,
        Notice::Watching { .. }
            | Notice::Renewed(_)
            | Notice::Offline(_)
            | Notice::Online(_)
            | Notice::Ignored { .. }
    )
}

/// A path as the page shows it: no character in it is obeyed.
pub(super) fn shown(path: &Path) -> String {
    one_line(&path.to_string_lossy())
}

/// How requests name a drawing.
pub(super) fn id_of(path: &Path) -> String {
    crate::watch::sha256_hex(path.as_os_str().as_encoded_bytes())[..16].to_owned()
}

impl State {
    /// The id of the drawing that a notice concerns, once it is noted.
    fn note(&mut self, notice: &Notice) -> Option<String> {
        match notice {
            Notice::Watching { root, how } => {
                self.roots.entry(root.clone()).or_default().how.clone_from(how);
                None
            }
            Notice::Offline(root) | Notice::Online(root) => {
                self.roots.entry(root.clone()).or_default().is_away = matches!(notice, Notice::Offline(_));
                None
            }
            Notice::Renewed(_) => {
                self.ignored.clear();
                self.ignored_count = 0;
                None
            }
            Notice::Ignored { path, why } => {
                self.drawings.remove(&id_of(path));
                self.ignored_count += 1;
                if self.ignored.len() < IGNORED_MAX {
                    self.ignored.insert(path.clone(), why.clone());
                }
                None
            }
            Notice::UpToDate { drawing, folder, summary } => self.at(drawing, |e| {
                e.is_queued = false;
                e.set("done");
                e.folder.clone_from(folder);
                e.summary.clone_from(summary);
            }),
            Notice::Removed(drawing) => {
                self.drawings.remove(&id_of(drawing));
                None
            }
            Notice::Results { drawing, .. } if self.roots.contains_key(drawing) => None,
            Notice::Results { drawing, folder } => self.at(drawing, |e| e.folder = Some(folder.clone())),
            Notice::Queued { drawing, .. } => self.at(drawing, |e| {
                (e.is_queued, e.is_ordered) = (true, false);
                if e.state != "running" {
                    e.set("waiting");
                }
            }),
            Notice::Started(drawing) => self.at(drawing, |e| {
                e.is_queued = false;
                e.set("running");
                e.curve.clear();
            }),
            Notice::Progress { drawing, value } => self.at_known(drawing, |e| e.go_on(value)),
            Notice::Analysis { drawing, folder } => {
                self.at_known(drawing, |e| e.folder = folder.parent().map(Path::to_path_buf))
            }
            Notice::Done { drawing, done } => self.at_known(drawing, |e| {
                e.set("done");
                e.summary.clone_from(&done.summary);
                let round = done.round.and_then(|_| done.folder.parent());
                e.folder = Some(round.unwrap_or(&done.folder).to_path_buf());
                e.wait_if_queued();
            }),
            // The first word on a drawing after a start.
            Notice::Stopped { drawing, why } if *why == CANCELLED_BEFORE => self.at(drawing, |e| {
                e.set("stopped");
                e.summary = (*why).into();
            }),
            Notice::Stopped { drawing, why } => self.at_known(drawing, |e| {
                e.is_ordered = false;
                e.set("stopped");
                e.summary = (*why).into();
                e.is_queued &= !why.starts_with(BY_THE_USER);
                e.wait_if_queued();
            }),
            Notice::Again(told) => self.note(told),
            Notice::Failed { drawing, problem, retry_secs } => self.at(drawing, |e| {
                e.is_queued |= retry_secs.is_some();
                e.set(if retry_secs.is_some() { "waiting" } else { "failed" });
                e.problem = json!(problem);
            }),
            Notice::Problem { path, .. } if self.roots.contains_key(path) => None,
            Notice::Problem { path, problem } => self.at(path, |e| e.problem = json!(problem)),
        }
    }

    fn at(&mut self, path: &Path, change: impl FnOnce(&mut Entry)) -> Option<String> {
        let id = id_of(path);
        change(self.drawings.entry(id.clone()).or_insert_with(|| Entry::new(path)));
        Some(id)
    }

    /// What a job still says of a drawing that is gone or left alone by then brings it not back.
    fn at_known(&mut self, path: &Path, change: impl FnOnce(&mut Entry)) -> Option<String> {
        let id = id_of(path);
        self.drawings.get_mut(&id).map(change)?;
        Some(id)
    }
}

impl Entry {
    fn new(path: &Path) -> Self {
        Self {
            path: path.into(),
            folder: None,
            state: "waiting",
            since: rfc3339(SystemTime::now()),
            summary: String::new(),
            problem: Value::Null,
            progress: Value::Null,
            is_queued: false,
            is_ordered: false,
            so_far: None,
            curve: Vec::new(),
        }
    }

    fn set(&mut self, state: &'static str) {
        self.state = state;
        // What the last job said is no word on this one.
        if state != "done" {
            self.summary.clear();
        }
        self.since = rfc3339(SystemTime::now());
        self.progress = Value::Null;
        self.so_far = None;
        self.problem = Value::Null;
    }

    /// What ended makes room for the job that waits.
    fn wait_if_queued(&mut self) {
        if self.is_queued {
            self.set("waiting");
        }
    }

    fn go_on(&mut self, value: &Value) {
        self.progress = value.clone();
        let stage = value["stage"].as_str().unwrap_or_default();
        if stage == SO_FAR {
            self.so_far = value["evaluations"].as_u64();
            return;
        }
        if let (Some(n), Some(best)) = (value["evaluations"].as_u64(), value["best"].as_f64()) {
            if self.curve.len() >= CURVE_POINTS_MAX {
                let mut nth = 0;
                self.curve.retain(|_| {
                    nth += 1;
                    nth % 2 == 1
                });
            }
            self.curve.push((stage.into(), n, best));
        }
    }

    fn brief(&self, id: &str) -> Value {
        json!({
            "id": id,
            "name": shown(Path::new(self.path.file_name().unwrap_or_default())),
            "folder": shown(self.path.parent().unwrap_or(Path::new(""))),
            "state": self.state,
            "since": self.since,
            "summary": self.summary,
            "problem": self.problem,
            "progress": self.progress,
            "so_far": self.so_far,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::daemon::Done;
    use enfilade_report::{Place, Problem, Severity};

    #[test]
    fn names_are_shown_and_not_obeyed() {
        let board = Board::default();
        let drawing = PathBuf::from("/pl\u{1b}ans/\u{202e}fxd.thgir.dxf");
        board.take(&Notice::Watching { root: "/pl\u{1b}ans".into(), how: String::new() });
        board.take(&Notice::Started(drawing.clone()));
        let why = "no drawing".to_owned();
        board.take(&Notice::Ignored { path: "/pl\u{1b}ans/\u{2067}a.txt".into(), why });
        let found = board.overview();
        assert_eq!(found["drawings"][0]["name"], r"\u{202e}fxd.thgir.dxf");
        assert_eq!(found["drawings"][0]["folder"], r"/pl\u{1b}ans");
        assert_eq!(found["drawings"][0]["id"], id_of(&drawing), "the id is of the name as it is");
        assert_eq!(found["roots"][0]["root"], r"/pl\u{1b}ans");
        assert_eq!(found["ignored"][0]["file"], r"/pl\u{1b}ans/\u{2067}a.txt");
    }

    #[test]
    fn notices_become_states_and_news() {
        let board = Board::default();
        let mut news = board.listen().unwrap();
        let drawing = PathBuf::from("/plans/<img onerror>.dxf");
        let id = id_of(&drawing);
        let state = |board: &Board| board.drawing(&id).unwrap()["state"].as_str().unwrap().to_owned();
        let half = Problem {
            code: "incomplete",
            severity: Severity::Info,
            place: Place::default(),
            text: "is not whole yet".into(),
        };
        board.take(&Notice::Watching { root: "/plans".into(), how: String::new() });
        board.take(&Notice::Problem { path: "/plans".into(), problem: half.clone() });
        assert_eq!(board.overview()["drawings"], json!([]), "a watched folder is no drawing");
        board.take(&Notice::Problem { path: drawing.clone(), problem: half });
        assert_eq!(board.drawing(&id).unwrap()["problem"]["code"], "incomplete");
        board.take(&Notice::Queued { drawing: drawing.clone(), waiting: 1 });
        assert_eq!(board.drawing(&id).unwrap()["problem"], Value::Null);
        assert_eq!(state(&board), "waiting");
        board.take(&Notice::Started(drawing.clone()));
        let value = json!({"stage": "optimise", "evaluations": 7, "best": 0.5});
        board.take(&Notice::Progress { drawing: drawing.clone(), value });
        assert_eq!(board.drawing(&id).unwrap()["curve"], json!([["optimise", 7, 0.5]]));
        let folder = PathBuf::from("/plans/a.enfilade/round-01");
        let done = Done { folder, round: Some(1), is_degraded: false, summary: "5 options".into() };
        board.take(&Notice::Done { drawing: drawing.clone(), done });
        assert_eq!(state(&board), "done");
        assert_eq!(board.drawing(&id).unwrap()["summary"], "5 options");
        let (folder, summary) = (Some("/plans/a.enfilade".into()), "5 options".to_owned());
        board.take(&Notice::UpToDate { drawing: drawing.clone(), folder, summary });
        assert_eq!(board.drawing(&id).unwrap()["summary"], "5 options");
        board.take(&Notice::Started(drawing.clone()));
        assert_eq!(board.drawing(&id).unwrap()["summary"], "", "of the round before");
        assert_eq!(board.paths(&id), Some((drawing, Some("/plans/a.enfilade".into()))));
        assert!(news.try_recv().unwrap().contains("\"kind\":\"log\""));
        let why = "ignored by `a*`".to_owned();
        board.take(&Notice::Ignored { path: "/plans/<img onerror>.dxf".into(), why: why.clone() });
        assert_eq!(board.drawing(&id), None, "what is left alone is no drawing any more");
        let found = board.overview();
        assert_eq!(found["ignored"], json!([{"file": "/plans/<img onerror>.dxf", "why": why}]));
        assert!(found["ignore_rules"].as_array().unwrap().iter().any(|r| r["glob"] == "#*"));
        for n in 0..IGNORED_MAX {
            board.take(&Notice::Ignored { path: format!("/plans/~{n}.dxf").into(), why: why.clone() });
        }
        let found = board.overview();
        assert_eq!(found["ignored"].as_array().unwrap().len(), IGNORED_MAX);
        assert_eq!(found["ignored_count"], IGNORED_MAX + 1);
        board.take(&Notice::Renewed("/plans/enfilade.toml".into()));
        assert_eq!(board.overview()["ignored_count"], 0, "they are said again");
        assert_eq!(board.paths("no such id"), None);
    }

    #[test]
    fn what_was_told_before_shows_and_is_not_logged() {
        let board = Board::default();
        let drawing = PathBuf::from("/plans/a.dxf");
        let problem = Problem {
            code: "disk-full",
            severity: Severity::Error,
            place: Place::default(),
            text: "no room".into(),
        };
        let failed =
            || Notice::Failed { drawing: drawing.clone(), problem: problem.clone(), retry_secs: Some(1.0) };
        board.take(&failed());
        let id = id_of(&drawing);
        assert!(board.is_busy(&id), "it waits to be tried again");
        board.take(&Notice::Again(Box::new(Notice::Started(drawing.clone()))));
        assert_eq!(board.drawing(&id).unwrap()["state"], "running");
        board.take(&Notice::Again(Box::new(failed())));
        let found = board.drawing(&id).unwrap();
        assert_eq!((&found["state"], &found["problem"]["code"]), (&json!("waiting"), &json!("disk-full")));
        assert_eq!(board.log().as_array().unwrap().len(), 1);
    }

    /// What was ordered can be cancelled before the daemon has said a word on it.
    #[test]
    fn what_is_ordered_is_busy() {
        let board = Board::default();
        let drawing = PathBuf::from("/p.dxf");
        let id = id_of(&drawing);
        board.take(&Notice::UpToDate { drawing: drawing.clone(), folder: None, summary: String::new() });
        assert!(!board.is_busy(&id));
        board.expect(&id);
        assert!(board.is_busy(&id));
        board.take(&Notice::Stopped { drawing, why: BY_THE_USER });
        assert!(!board.is_busy(&id));
    }

    /// A drawing that goes is news of that drawing alone: whoever looks at another need not load everything again.
    #[test]
    fn what_goes_is_named() {
        let board = Board::default();
        let drawing = PathBuf::from("/p.dxf");
        board.take(&Notice::Started(drawing.clone()));
        let mut news = board.listen().unwrap();
        board.take(&Notice::Removed(drawing.clone()));
        board.take(&Notice::Removed(drawing.clone()));
        let said: Vec<Value> =
            std::iter::from_fn(|| news.try_recv().ok()).map(|n| serde_json::from_str(&n).unwrap()).collect();
        let others: Vec<&Value> = said.iter().filter(|n| n["kind"] != "log").collect();
        assert_eq!(others, [&json!({"kind": "gone", "id": id_of(&drawing)})]);
    }

    /// A folder that was away and came back is watched as before, or as was said meanwhile.
    #[test]
    fn a_folder_that_is_back_says_how_it_is_watched() {
        let board = Board::default();
        let root = PathBuf::from("/plans");
        let how = || board.overview()["roots"][0]["how"].as_str().unwrap().to_owned();
        let watching = |how: &str| Notice::Watching { root: root.clone(), how: how.into() };
        board.take(&watching("by events"));
        board.take(&Notice::Offline(root.clone()));
        assert_eq!(how(), "out of reach");
        board.take(&Notice::Online(root.clone()));
        assert_eq!(how(), "by events");
        board.take(&Notice::Offline(root.clone()));
        board.take(&watching("polled every 2 s"));
        assert_eq!(how(), "out of reach");
        board.take(&Notice::Online(root.clone()));
        assert_eq!(how(), "polled every 2 s");
    }

    /// What a job says after its drawing was removed, or left alone by new settings, brings it not back.
    #[test]
    fn what_is_gone_stays_gone() {
        let board = Board::default();
        let drawing = PathBuf::from("/p.dxf");
        let gone = [
            Notice::Removed(drawing.clone()),
            Notice::Ignored { path: drawing.clone(), why: "the settings say so".into() },
        ];
        for going in gone {
            board.take(&Notice::Started(drawing.clone()));
            board.take(&going);
            board.take(&Notice::Progress { drawing: drawing.clone(), value: json!({}) });
            board.take(&Notice::Stopped { drawing: drawing.clone(), why: BY_THE_USER });
            assert_eq!(board.overview()["drawings"], json!([]), "{going:?}");
        }
        board.take(&Notice::Stopped { drawing: drawing.clone(), why: CANCELLED_BEFORE });
        assert_eq!(board.overview()["drawings"][0]["state"], "stopped");
    }

    #[test]
    fn log_curve_and_listeners_are_bounded() {
        let board = Board::default();
        let drawing = PathBuf::from("/p.dxf");
        board.take(&Notice::Started(drawing.clone()));
        for n in 0..3 * CURVE_POINTS_MAX as u64 {
            let value = json!({"stage": "s", "evaluations": n, "best": 1.0});
            board.take(&Notice::Progress { drawing: drawing.clone(), value });
            board.take(&Notice::Stopped { drawing: drawing.clone(), why: "cancelled" });
        }
        let points = board.drawing(&id_of(&drawing)).unwrap()["curve"].as_array().unwrap().len();
        assert!(points <= CURVE_POINTS_MAX && points > CURVE_POINTS_MAX / 2 - 1, "{points}");
        assert_eq!(board.log().as_array().unwrap().len(), LOG_LINES_MAX);
        let held: Vec<_> = (0..LISTENERS_MAX).map(|_| board.listen().unwrap()).collect();
        assert!(board.listen().is_none());
        drop(held);
        assert!(board.listen().is_some());
    }
}

//! The daemon's loop: it decides and never waits. A looker thread touches the watched folders, each job runs on a
//! thread of its own; they answer by messages, so that a slow disk or job never delays a stop.

use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender, SyncSender};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use serde_json::{Value, json};

mod earlier;
mod orders;
mod overview;
mod renewal;
mod room;
mod running;
mod state;
mod words;

use running::Running;
use state::{State, is_waited_for};
use words::{how_watched, shown, taken};

use super::hands::{Content, Looked, Message, Waiting, is_unreadable, open_journal, reporter, start_looker};
use super::job::Told;
use super::status::{
    SharedDisk, Standing, UNFINISHED, UNFINISHED_OR_FAILED, content_of_results, rfc3339, settle, settle_gone,
    settle_stopped, write_standing,
};
use super::{Asked, Notice, Order, Reread, RunJob, WatchSettings};
use crate::store::{
    Ended, FOLDER_OWNED, Journal, Placing, Records, Step, SystemDisk, host_name, present_folder,
    refuse_nested, write_json,
};
use crate::watch::{
    Action, Event, Eyes, Now, Settle, builtin_ignores, has_data_beside, is_building_of, is_data,
    is_output_name, network_reason,
};
use enfilade_config::settings_files;
use enfilade_report::{Cancel, Error, KEEP_GRACE, Place, Problem, Severity};

/// Reports of the system waiting to be read; more mean "look at everything" (hazards 8 and 15).
/// The room for them is taken at once, so it is part of what an idle daemon holds.
const INBOX: usize = 8_192;
/// Drawings waiting for their turn; further ones are found again by the next scan (hazard 26).
pub(super) const MAX_QUEUE: usize = if cfg!(test) { 250 } else { 10_000 };
/// The loop turns at least this often while something is under way: settle times and stops are answered
/// this fast.
const BUSY_TICK: Duration = Duration::from_millis(50);
/// The same while nothing is.
const IDLE_TICK: Duration = Duration::from_millis(120);
/// The running job gets this long to notice a stop before the daemon leaves without it.
const STOP_PATIENCE: Duration = Duration::from_millis(120);
/// The overview is not rewritten more often.
const OVERVIEW_PAUSE: Duration = Duration::from_secs(1);
/// Why a job was given up, as the user reads it.
const NEWER_SAVE: &str = "a newer save, or other settings, take its place";
const NEWER_CONTENT: &str =
    "the drawing or its settings changed, and what was asked for is of the options before; ask for it again";
const REMOVED: &str = "the drawing was removed or has another name";
pub(crate) const BY_THE_USER: &str = "cancelled";
const BY_THE_USER_KEPT: &str = "cancelled; its best so far is kept";
pub(crate) const CANCELLED_BEFORE: &str =
    "cancelled before; a change of it or of its settings, or another round asked for, takes it up";
const TOO_MANY_WAIT: &str = "too much waits already; ask again when some of it is done";
const NOTHING_WHOLE: &str = "no whole file lies there to work on";
const DAEMON_ENDS: &str = "the daemon ends; the next start goes on with it";
/// Failures and left-alone files listed in the overview.
const MAX_LISTED: usize = 200;

struct Root {
    path: PathBuf,
    /// Why its events cannot be trusted; `None`: they can.
    unheard: Option<String>,
    how: String,
    is_offline: bool,
    state: Option<State>,
    /// The first of those left alone, and why.
    ignored: BTreeMap<PathBuf, String>,
    ignored_count: u64,
    done_count: u64,
}

pub(super) struct Heart {
    settings: WatchSettings,
    records: Records,
    disk: SharedDisk,
    run: Arc<RunJob>,
    settle: Settle,
    roots: Vec<Root>,
    /// What was read last of each drawing, until it is known to be ready.
    keys: BTreeMap<PathBuf, Content>,
    /// The last complete content of each drawing.
    contents: BTreeMap<PathBuf, Content>,
    /// How long the last job of each drawing took that came to an end, or has taken at least.
    took: BTreeMap<PathBuf, Duration>,
    orders: Receiver<Order>,
    queue: VecDeque<Waiting>,
    running: Vec<Running>,
    failed: BTreeMap<PathBuf, Problem>,
    /// Given up by the user, until their next job.
    cancelled: BTreeSet<PathBuf>,
    next_id: u64,
    send: SyncSender<Message>,
    inbox: Receiver<Message>,
    is_flooded: Arc<AtomicBool>,
    to_looker: Sender<Action>,
    /// Number of the looker whose answers count.
    looker: u64,
    /// Whether a root's own settings have changed since they were read.
    is_settings_stale: bool,
    start: Instant,
    since: String,
    last_beat: Instant,
    last_overview: Option<Instant>,
    is_overview_stale: bool,
    /// What is to be said of folders at the start: that they could not be taken, say.
    first_words: Vec<(PathBuf, Problem)>,
    /// Since when the disk of a root's results is full, as the user was told.
    full_since: BTreeMap<PathBuf, Instant>,
}

impl Heart {
    /// Takes the roots, replays their journals and starts the threads.
    pub(super) fn start(
        roots: &[PathBuf],
        settings: &WatchSettings,
        run: Arc<RunJob>,
        orders: Receiver<Order>,
        stop: &Cancel,
    ) -> Result<Self, Error> {
        let reasons: Vec<Option<String>> = roots.iter().map(|r| network_reason(r)).collect();
        let is_network: Vec<bool> = reasons.iter().map(Option::is_some).collect();
        let (send, inbox) = mpsc::sync_channel(INBOX);
        let is_flooded = Arc::new(AtomicBool::new(false));
        let report = reporter(send.clone(), is_flooded.clone());
        let eyes = Eyes::new(roots, &is_network, settings, report)?;
        let to_looker = start_looker(eyes, settings, 0, send.clone());
        let disk: SharedDisk = Arc::new(SystemDisk);
        let mut heart = Self {
            settle: Settle::new(roots, &is_network, settings)?,
            settings: settings.clone(),
            records: Records::new(settings.records_dir.clone()),
            disk,
            run,
            roots: Vec::new(),
            keys: BTreeMap::new(),
            contents: BTreeMap::new(),
            took: BTreeMap::new(),
            orders,
            queue: VecDeque::new(),
            running: Vec::new(),
            failed: BTreeMap::new(),
            cancelled: BTreeSet::new(),
            next_id: 0,
            send,
            inbox,
            is_flooded,
            to_looker,
            looker: 0,
            is_settings_stale: false,
            start: Instant::now(),
            since: rfc3339(SystemTime::now()),
            last_beat: Instant::now(),
            last_overview: None,
            is_overview_stale: true,
            first_words: Vec::new(),
            full_since: BTreeMap::new(),
        };
        heart.records.sweep(&*heart.disk);
        for (path, reason) in roots.iter().zip(reasons) {
            let state = match heart.take(path, stop) {
                Ok(mut state) => {
                    let words =
                        state.unrecorded.take().into_iter().chain(open_journal(&state.journal).unread());
                    heart.first_words.extend(words.map(|problem| (path.clone(), problem)));
                    Some(state)
                }
                // One folder that cannot be written holds up no other, and a full disk passes; every heartbeat tries again.
                Err(Error::Environment(problem)) if is_waited_for(roots.len(), problem.code) => {
                    heart.first_words.push((path.clone(), problem));
                    None
                }
                Err(error) => return Err(error),
            };
            let how = how_watched(settings, reason.as_deref());
            heart.roots.push(Root {
                path: path.clone(),
                unheard: reason,
                how,
                is_offline: false,
                state,
                ignored: BTreeMap::new(),
                ignored_count: 0,
                done_count: 0,
            });
        }
        Ok(heart)
    }

    /// The loop, until `stop` or until another daemon has taken a folder.
    pub(super) fn beat_until(
        mut self,
        reread: &mut Reread<'_>,
        show: &mut dyn FnMut(Notice),
        stop: &Cancel,
    ) -> Result<(), Error> {
        for root in &self.roots {
            show(Notice::Watching { root: root.path.clone(), how: root.how.clone() });
        }
        for (path, problem) in std::mem::take(&mut self.first_words) {
            show(Notice::Problem { path, problem });
        }
        while !stop.is_stopped() {
            let is_busy = !self.running.is_empty() || self.settle.pending_count() > 0;
            match self.inbox.recv_timeout(if is_busy { BUSY_TICK } else { IDLE_TICK }) {
                Ok(message) => self.take_in(message, show),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => break,
            }
            for _ in 0..INBOX {
                let Ok(message) = self.inbox.try_recv() else { break };
                self.take_in(message, show);
            }
            if let Err(error) = self.turn(show, stop) {
                self.leave(show);
                return Err(error);
            }
            if std::mem::take(&mut self.is_settings_stale) {
                self.renew(reread, show);
            }
        }
        self.leave(show);
        Err(Error::Stopped)
    }

    fn turn(&mut self, show: &mut dyn FnMut(Notice), stop: &Cancel) -> Result<(), Error> {
        let mono = self.start.elapsed();
        if self.is_flooded.swap(false, Ordering::Relaxed) {
            self.settle.on_event(mono, Event::Lost("more events than can be held".into()));
        }
        let wall = SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default();
        for action in self.settle.on_tick(Now { mono, wall }) {
            if stop.is_stopped() {
                return Ok(());
            }
            self.carry_out(action, show, stop);
        }
        while let Ok(order) = self.orders.try_recv() {
            self.obey(order, show);
        }
        self.watch_running(show);
        self.start_waiting(show);
        self.give_sign_of_life(show, stop)?;
        self.write_overview(false);
        Ok(())
    }

    fn take_in(&mut self, message: Message, show: &mut dyn FnMut(Notice)) {
        let now = self.start.elapsed();
        match message {
            Message::Event(event) => self.settle.on_event(now, event),
            Message::Looked(number, _) if number != self.looker => {}
            Message::Looked(_, Looked::Seen(path, seen)) => self.settle.on_stat(now, &path, seen),
            Message::Looked(_, Looked::Scanned(root, found)) => self.settle.on_scan(now, &root, found),
            Message::Looked(_, Looked::Root(root, identity)) => self.settle.on_root(now, &root, identity),
            Message::Looked(_, Looked::Strained(root, why)) => self.settle.on_strain(now, &root, &why),
            Message::Looked(_, Looked::Checked(path, checked, key)) => {
                self.keys.insert(path.clone(), key);
                self.settle.on_check(now, &path, checked);
            }
            Message::Told(id, Told::Worked(worked)) => {
                let running = self.running.iter_mut().find(|r| r.id == id);
                running.into_iter().for_each(|r| r.worked = Some(worked));
            }
            Message::Told(id, told) => {
                if let Some(running) = self.running.iter_mut().find(|r| r.id == id) {
                    running.is_reading &= told.is_reading();
                    running.is_searching |= told.is_searching();
                    running.has_best |= told.is_best();
                    if let Some(notice) = told.notice(&running.what.drawing) {
                        self.tell(notice, show);
                    }
                }
            }
            Message::Ended(id, outcome) => {
                if let Some(i) = self.running.iter().position(|r| r.id == id) {
                    let running = self.running.remove(i);
                    self.ended(running, outcome, show);
                }
            }
        }
    }

    fn carry_out(&mut self, action: Action, show: &mut dyn FnMut(Notice), stop: &Cancel) {
        match action {
            Action::Look(_) | Action::Check(_) | Action::Scan(_) | Action::LookRoot(_) => {
                // Fails only when the looker is gone, with the whole process.
                let _ = self.to_looker.send(action);
            }
            Action::Rearm(root) => {
                self.retake(&root, show, stop);
                let _ = self.to_looker.send(Action::Rearm(root));
            }
            Action::Ready { path, sha256 } => self.ready(path, sha256, show),
            Action::SettingsChanged(path) => self.settings_changed(&path),
            Action::Removed(path) => self.removed(&path, show),
            Action::Ignored { path, why } => {
                self.is_overview_stale = true;
                if let Some(root) = self.root_of_mut(&path) {
                    root.leave_alone(&path, &why);
                }
                show(Notice::Ignored { path, why });
            }
            Action::IgnoredGone(path) => {
                self.is_overview_stale = true;
                if let Some(root) = self.root_of_mut(&path) {
                    root.ignored.remove(&path);
                    root.ignored_count = root.ignored_count.saturating_sub(1);
                }
            }
            Action::Offline(root) => self.set_offline(root, true, show),
            Action::Online(root) => self.set_offline(root, false, show),
            Action::Problem { path, problem } => self.problem(path, problem, show),
            Action::Resolved(path) => {
                self.failed.remove(&path);
                self.is_overview_stale = true;
            }
        }
    }

    /// A side-car concerns its drawing, a folder's settings the drawings in it, data the scenes in and above its folder.
    fn settings_changed(&mut self, path: &Path) {
        let now = self.start.elapsed();
        let is_of_root = |r: &Root| settings_files(&r.path.join("any"))[1] == path;
        self.is_settings_stale |= self.roots.iter().any(is_of_root);
        let is_above = |d: &Path| d.parent().is_some_and(|folder| path.starts_with(folder));
        let is_its_data = |d: &Path| is_data(path) && has_data_beside(d) && is_above(d);
        let drawings = self.settle.settled_drawings();
        for drawing in
            drawings.iter().filter(|d| is_its_data(d) || settings_files(d).iter().any(|f| f == path))
        {
            self.settle.again(now, drawing);
        }
    }

    fn set_offline(&mut self, path: PathBuf, is_offline: bool, show: &mut dyn FnMut(Notice)) {
        if let Some(root) = self.roots.iter_mut().find(|r| r.path == path) {
            root.is_offline = is_offline;
            self.is_overview_stale = true;
        }
        show(if is_offline { Notice::Offline(path) } else { Notice::Online(path) });
    }

    /// The root may be another folder now: its lock and journal are those that lie there. While another
    /// daemon has it, its drawings wait; every heartbeat tries again.
    fn retake(&mut self, path: &Path, show: &mut dyn FnMut(Notice), stop: &Cancel) {
        let Some(i) = self.roots.iter().position(|r| r.path == path) else { return };
        let is_same = self.roots[i].state.as_mut().is_some_and(|s| {
            s.folder.starts_with(path) && s.folder.join("lock").exists() && s.beat().unwrap_or(false)
        });
        if is_same {
            return;
        }
        self.roots[i].state = None;
        match self.take(path, stop) {
            Ok(state) => self.roots[i].state = Some(state),
            Err(error) => {
                if let Some(problem) = error.problem() {
                    show(Notice::Problem { path: path.into(), problem: problem.clone() });
                }
            }
        }
    }

    fn problem(&mut self, path: PathBuf, mut problem: Problem, show: &mut dyn FnMut(Notice)) {
        let is_running = self.is_running(&path);
        // What passes by itself is said, and leaves nothing behind in the folder.
        let is_lasting = problem.severity > Severity::Info && !is_running;
        if is_lasting && self.roots.iter().all(|r| r.path != path) {
            let problems = [problem.clone()];
            let standing = Standing { state: "settling", problems: &problems, ..Standing::default() };
            write_standing(&*self.disk, &path, &self.placing_of(&path), &standing);
        }
        let is_of = |r: &&mut Root| r.path == path && problem.code.starts_with("watch-");
        if let Some(root) = self.roots.iter_mut().find(is_of) {
            root.how = problem.text.clone();
            show(Notice::Watching { root: path.clone(), how: root.how.clone() });
        }
        self.fail(&path, &problem);
        self.say_results(&path, show);
        if is_running {
            problem.text.push_str("; the job that runs is of the content before");
        }
        show(Notice::Problem { path, problem });
    }

    /// Says where results of before lie.
    fn say_results(&self, drawing: &Path, show: &mut dyn FnMut(Notice)) {
        if let Some(folder) = present_folder(drawing, &self.placing_of(drawing)) {
            show(Notice::Results { drawing: drawing.into(), folder });
        }
    }

    fn fail(&mut self, path: &Path, problem: &Problem) {
        self.failed.insert(path.into(), problem.clone());
        self.is_overview_stale = true;
    }

    /// A complete content: a job, unless it is ours, done, or being done.
    fn ready(&mut self, drawing: PathBuf, sha256: String, show: &mut dyn FnMut(Notice)) {
        self.failed.remove(&drawing);
        self.is_overview_stale = true;
        self.look_again_at_scenes(&drawing);
        let of = self.keys.remove(&drawing).unwrap_or_default();
        let below = self.below(&drawing);
        let Some(journal) = self.journal_of(&drawing) else {
            let later = self.start.elapsed() + Duration::from_secs_f64(self.settings.heartbeat_secs);
            return self.settle.again(later, &drawing);
        };
        if is_output_name(&drawing) && open_journal(&journal).is_output(&sha256) {
            let why = "copy of a result of ours; give it another name to work on it".into();
            return show(Notice::Ignored { path: drawing, why });
        }
        self.rebuild(&drawing, &of, show);
        let before = self.contents.insert(drawing.clone(), of.clone());
        let is_it = |w: &Waiting| w.drawing == drawing && w.of.is_same(&of);
        if self.queue.iter().any(|w| is_it(w) && w.not_before.is_none()) {
            return;
        }
        self.drop_waiting(&drawing, NEWER_CONTENT, show);
        if let Some(running) = self.running_of(&drawing) {
            let is_going = !running.cancel.is_stopped() || running.why == BY_THE_USER;
            let is_same_content = running.what.of.key == of.key && is_going;
            if is_same_content && running.what.of.config == of.config {
                return;
            }
            // Settings that cannot be read, half saved perhaps, fail in their turn and end nothing.
            if !(is_same_content && is_unreadable(&of.config)) {
                running.stop(NEWER_SAVE);
            }
        } else if let Some(end) = open_journal(&journal).end_of(&below, &of.key, &of.config)
            && !self.has_results_of_another(&drawing, &of)
        {
            let is_mended = before.is_some_and(|b| is_unreadable(&b.config));
            return self.ended_before(drawing, end, is_mended, show);
        }
        self.enqueue(Waiting::new(drawing, of, Asked::default()), show);
    }

    /// A building is read with the scenes of its name: they are taken up again when it comes, changes or goes.
    fn look_again_at_scenes(&mut self, building: &Path) {
        let drawings = self.settle.settled_drawings();
        for scene in drawings.iter().filter(|d| is_building_of(building, d)) {
            self.settle.again(self.start.elapsed(), scene);
        }
    }

    fn removed(&mut self, drawing: &Path, show: &mut dyn FnMut(Notice)) {
        self.look_again_at_scenes(drawing);
        self.drop_waiting(drawing, REMOVED, show);
        self.forget(drawing);
        if let Some(running) = self.running_of(drawing) {
            running.stop(REMOVED);
        }
        settle_gone(&*self.disk, drawing, &self.placing_of(drawing), REMOVED);
        show(Notice::Removed(drawing.into()));
    }

    /// Nothing is listed any more of a drawing that is gone or left alone.
    fn forget(&mut self, drawing: &Path) {
        self.failed.remove(drawing);
        self.cancelled.remove(drawing);
        self.keys.remove(drawing);
        self.contents.remove(drawing);
        self.is_overview_stale = true;
    }

    fn give_sign_of_life(&mut self, show: &mut dyn FnMut(Notice), stop: &Cancel) -> Result<(), Error> {
        if self.last_beat.elapsed().as_secs_f64() < self.settings.heartbeat_secs {
            return Ok(());
        }
        self.last_beat = Instant::now();
        self.forget_full_disks(show);
        for i in 0..self.roots.len() {
            let root = &mut self.roots[i];
            if root.is_offline {
                continue;
            }
            match &mut root.state {
                // A failing write is the disk's matter and shows elsewhere; a foreign lease is ours.
                Some(state) => {
                    if let Ok(false) = state.beat() {
                        return Err(taken(&root.path, &state.folder));
                    }
                }
                None => self.take_at_last(i, show, stop),
            }
        }
        Ok(())
    }

    /// Ends: the running jobs are stopped; nothing is published any more.
    fn leave(&mut self, show: &mut dyn FnMut(Notice)) {
        self.running.iter_mut().for_each(|running| running.stop(DAEMON_ENDS));
        let until = Instant::now() + STOP_PATIENCE;
        while !self.running.is_empty() {
            match self.inbox.recv_timeout(until.saturating_duration_since(Instant::now())) {
                Ok(message @ Message::Ended(..)) => self.take_in(message, show),
                Ok(_) => {}
                Err(_) => break,
            }
        }
        for running in std::mem::take(&mut self.running) {
            self.stopped(&running.what, running.why, show);
        }
        self.write_overview(true);
    }

    fn write_overview(&mut self, is_leaving: bool) {
        let is_soon = self.last_overview.is_some_and(|t| t.elapsed() < OVERVIEW_PAUSE);
        if !is_leaving && (!self.is_overview_stale || is_soon) {
            return;
        }
        self.is_overview_stale = false;
        self.last_overview = Some(Instant::now());
        for root in self.roots.iter().filter(|r| !r.is_offline) {
            if let Some(state) = &root.state {
                // Where this fails the jobs fail too, and say so.
                let _ = write_json(
                    &*self.disk,
                    &state.folder.join("status.json"),
                    &self.overview(root, is_leaving),
                );
            }
        }
    }

    fn root_of(&self, path: &Path) -> Option<&Root> {
        let holds = self.roots.iter().filter(|r| path.starts_with(&r.path));
        holds.max_by_key(|r| r.path.as_os_str().len())
    }

    fn root_of_mut(&mut self, path: &Path) -> Option<&mut Root> {
        let holds = self.roots.iter_mut().filter(|r| path.starts_with(&r.path));
        holds.max_by_key(|r| r.path.as_os_str().len())
    }

    fn journal_of(&self, drawing: &Path) -> Option<Arc<Mutex<Journal>>> {
        self.root_of(drawing).and_then(|r| r.state.as_ref()).map(|s| s.journal.clone())
    }

    fn below(&self, drawing: &Path) -> PathBuf {
        let root = self.root_of(drawing).map(|r| r.path.as_path()).unwrap_or(Path::new(""));
        drawing.strip_prefix(root).unwrap_or(drawing).to_path_buf()
    }

    fn placing_of(&self, drawing: &Path) -> Placing {
        let root = self.root_of(drawing).map_or_else(PathBuf::new, |r| r.path.clone());
        self.placing(&root, drawing)
    }

    /// Folders of a root are repeated below the folders given for results.
    fn placing(&self, root: &Path, drawing: &Path) -> Placing {
        let between = drawing.strip_prefix(root).ok().and_then(Path::parent).unwrap_or(Path::new(""));
        let at = |dir: &Option<PathBuf>| dir.as_ref().map(|d| d.join(between));
        Placing { out_dir: at(&self.settings.out_dir), fallback_dir: at(&self.settings.fallback_dir) }
    }

    /// Nothing of a round with wishes of its own, which is not asked for again after a kill, and nothing of settings
    /// that cannot be read: what ended before with those of before stays so once they are mended.
    fn note(&mut self, what: &Waiting, step: &Step, show: &mut dyn FnMut(Notice)) {
        if what.asked != Asked::default() || is_unreadable(&what.of.config) {
            return;
        }
        let Some(journal) = self.journal_of(&what.drawing) else { return };
        let time = rfc3339(SystemTime::now());
        let below = self.below(&what.drawing);
        let outcome = open_journal(&journal).append(&below, &what.of.key, &what.of.config, &time, step);
        if let Err(error) = outcome
            && let Some(problem) = error.problem()
        {
            self.tell(Notice::Problem { path: what.drawing.clone(), problem: problem.clone() }, show);
        }
    }
}

impl Root {
    fn leave_alone(&mut self, file: &Path, why: &str) {
        self.ignored_count += 1;
        if self.ignored.len() < MAX_LISTED {
            self.ignored.insert(file.into(), why.into());
        }
    }
}

//! When is a save finished? A pure state machine: events, looks and the clock go in, actions come out.
//!
//! A drawing is ready when its [`Stat`] has not changed for the quiet time, its end mark is there and
//! it could be read without anybody writing meanwhile. Whatever events get lost, full scans feed the
//! same machine, so every complete content is reported at last and once (contract P2, P3).

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::time::Duration;

use super::{
    CLOCK_JUMP_SECS, Checked, Completeness, Identity, Kind, MAX_BACKOFF_SECS, MAX_DRAWING_BYTES,
    MAX_SCANNED_FILES, Names, QUIET_UNMARKED_SECS, ROOT_LOOK_SECS, Seen, Stat, Verdict, WatchSettings,
    is_data,
};
use enfilade_report::{Error, Place, Problem, Severity};

/// Two readings of time, so that a sleep of the machine shows as a difference between them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Now {
    /// A clock that only runs forward; its origin means nothing.
    pub mono: Duration,
    /// Time since 1970 as the system believes it.
    pub wall: Duration,
}

/// What the system reported.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Event {
    /// Something happened to this path: made, written, renamed, removed.
    Touched(PathBuf),
    /// Events may have been lost, for this reason: look at everything.
    Lost(String),
    /// The system cannot watch this root (any more), for this reason: it is polled from now on.
    Blind(PathBuf, String),
    /// The root holds more files than [`super::MAX_SCANNED_FILES`]; the rest is not looked at.
    Crowded(PathBuf),
}

/// What the machine wants done; answers to the first four come back through `on_*`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Action {
    /// Look at the path and answer with [`Settle::on_stat`].
    Look(PathBuf),
    /// Read the path and answer with [`Settle::on_check`].
    Check(PathBuf),
    /// List the root (arming its folders first) and answer with [`Settle::on_scan`].
    Scan(PathBuf),
    /// Look whether the root is still the same folder and answer with [`Settle::on_root`].
    LookRoot(PathBuf),
    /// The root's watches are void: arm them anew. A scan follows.
    Rearm(PathBuf),
    /// A complete drawing with this content.
    Ready {
        /// The drawing.
        path: PathBuf,
        /// SHA-256 of its bytes.
        sha256: String,
    },
    /// Settings files of ours changed or went: drawings of the folder may have to run again.
    SettingsChanged(PathBuf),
    /// The drawing is gone for good (longer than the grace of a save).
    Removed(PathBuf),
    /// A file that looks like a drawing is left alone; said once a file.
    Ignored {
        /// The file.
        path: PathBuf,
        /// Why.
        why: String,
    },
    /// A file that was left alone is no longer there.
    IgnoredGone(PathBuf),
    /// The root cannot be reached; nothing is inferred about its files.
    Offline(PathBuf),
    /// The root is back.
    Online(PathBuf),
    /// Something the user should know about this path; the wait goes on.
    Problem {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        problem: Problem,
    },
    /// An earlier problem of this path has gone.
    Resolved(PathBuf),
}

/// Longest list of left-alone files kept to say each once.
const MAX_IGNORED: usize = 10_000;
/// Looks at a vanished drawing come this often during the grace.
const GRACE_LOOK_SECS: f64 = 1.0;
/// A folder that appeared is scanned this soon, together with its siblings.
const FOLDER_SCAN_SECS: f64 = 0.2;
/// Why what bears a drawing's name and is no file is left alone.
const A_LINK: &str =
    "a link, and links are not followed; put the drawing itself here, or watch the folder where it lies";
const A_PIPE: &str = "a pipe, socket or device and no file; it is never opened";
const A_FOLDER: &str = "a folder and no drawing; --depth looks at what lies in it";

#[derive(Debug)]
struct Root {
    path: PathBuf,
    names: Names,
    is_polled: bool,
    quiet: Duration,
    identity: Option<Identity>,
    is_offline: bool,
    next_scan: Duration,
    /// When the next scan comes where nothing happens.
    next_regular: Duration,
    /// Whether the newest scan had no other cause than the time.
    is_regular: bool,
    next_look: Duration,
    offline_pause: Duration,
    is_scanning: bool,
    is_looking: bool,
    /// Whether the newest look failed for want of files that may be open.
    is_strained: bool,
}

#[derive(Debug)]
struct Pending {
    stat: Option<Stat>,
    first: Duration,
    changed: Duration,
    next: Duration,
    pause: Duration,
    quiet: Duration,
    gone_since: Option<Duration>,
    is_asked: bool,
    is_noted: bool,
    is_told: bool,
    /// Whether a scan found the change, and no event has told of it yet.
    is_unheard: bool,
}

impl Root {
    /// Changes that a scan finds now prove nothing about the events: they may have been lost for this cause.
    fn scan_for_cause(&mut self, now: Duration) {
        self.next_scan = now;
        self.is_regular = false;
    }
}

/// The state of all files of all roots. Answers to its actions and reports of the system go in by
/// `on_*`; [`Settle::on_tick`] returns what is to be done. Times are values: no call sleeps.
#[derive(Debug)]
pub struct Settle {
    roots: Vec<Root>,
    pending: BTreeMap<PathBuf, Pending>,
    settled: BTreeMap<PathBuf, Stat>,
    ignored: BTreeSet<PathBuf>,
    unknown: BTreeSet<PathBuf>,
    out: Vec<Action>,
    last_tick: Option<Now>,
    settings: WatchSettings,
}

impl Settle {
    /// Starts with canonical `roots`; `is_network[i]` says that root i lies on a drive whose events
    /// cannot be trusted and whose writers need more quiet. The first tick asks for a scan of each.
    ///
    /// # Errors
    /// `bad-glob` from the user's ignore list.
    pub fn new(roots: &[PathBuf], is_network: &[bool], settings: &WatchSettings) -> Result<Self, Error> {
        let make = |(i, path): (usize, &PathBuf)| {
            let names = Names::new(path, settings.depth, &settings.extensions, &settings.ignore, roots)?;
            let is_network = is_network.get(i).copied().unwrap_or(false);
            let quiet = if is_network { settings.network_quiet_secs } else { settings.quiet_secs };
            Ok(Root {
                path: path.clone(),
                names,
                is_polled: settings.poll || is_network,
                quiet: Duration::from_secs_f64(quiet),
                identity: None,
                is_offline: false,
                next_scan: Duration::ZERO,
                next_regular: Duration::MAX,
                is_regular: false,
                next_look: Duration::ZERO,
                offline_pause: Duration::from_secs_f64(ROOT_LOOK_SECS),
                is_scanning: false,
                is_looking: false,
                is_strained: false,
            })
        };
        Ok(Self {
            roots: roots.iter().enumerate().map(make).collect::<Result<_, Error>>()?,
            pending: BTreeMap::new(),
            settled: BTreeMap::new(),
            ignored: BTreeSet::new(),
            unknown: BTreeSet::new(),
            out: Vec::new(),
            last_tick: None,
            settings: settings.clone(),
        })
    }

    /// Number of files that are being waited for.
    pub fn pending_count(&self) -> usize {
        self.pending.len()
    }

    /// Whether the root is out of reach.
    pub fn is_offline(&self, root: &Path) -> bool {
        self.roots.iter().any(|r| r.path == root && r.is_offline)
    }

    /// The settled drawings.
    pub fn settled_drawings(&self) -> Vec<PathBuf> {
        let is_drawing = |p: &&PathBuf| self.names_for(p).is_some_and(|n| n.verdict(p) == Verdict::Take);
        self.settled.keys().filter(is_drawing).cloned().collect()
    }

    /// Whether a path is left alone by its name or place; says so, once.
    pub fn leaves_alone(&mut self, path: &Path) -> bool {
        let Some(Verdict::Ignore(why)) = self.names_for(path).map(|n| n.verdict(path)) else { return false };
        self.tell_ignored(path.into(), why);
        true
    }

    /// The rules on names of the root that holds `path`.
    pub fn names_for(&self, path: &Path) -> Option<&Names> {
        self.root_of(path).map(|i| &self.roots[i].names)
    }

    /// Takes in a report of the system.
    pub fn on_event(&mut self, now: Duration, event: Event) {
        match event {
            Event::Lost(_) => self.roots.iter_mut().for_each(|r| r.scan_for_cause(now)),
            Event::Blind(root, why) => self.blind(now, &root, "watch-refused", why),
            Event::Crowded(root) => {
                let text = format!(
                    "holds more files than MAX_SCANNED_FILES ({MAX_SCANNED_FILES}); the rest is not looked at"
                );
                self.tell(&root, "too-many-files", text);
            }
            Event::Touched(path) => self.touched(now, path),
        }
    }

    /// Trusts no more events of a root.
    fn blind(&mut self, now: Duration, root: &Path, code: &'static str, why: String) {
        let Some(r) = self.roots.iter_mut().find(|r| r.path == root && !r.is_polled) else { return };
        r.is_polled = true;
        r.scan_for_cause(now);
        self.tell(root, code, format!("{why}; polled every {} s instead", self.settings.poll_secs));
    }

    /// Asks for the file to be judged anew although nothing happened to it.
    pub fn again(&mut self, now: Duration, path: &Path) {
        self.settled.remove(path);
        // What was said of it before is no word on what is found now.
        self.pending.remove(path);
        self.touched(now, path.into());
    }

    fn touched(&mut self, now: Duration, path: PathBuf) {
        let Some(i) = self.root_of(&path) else { return };
        if path == self.roots[i].path {
            self.roots[i].next_look = now;
            self.roots[i].next_scan = now;
            return;
        }
        match self.roots[i].names.verdict(&path) {
            Verdict::Take | Verdict::Settings => self.restart(now, path, i),
            Verdict::Ignore(why) => self.tell_ignored(path, why),
            Verdict::Other => self.maybe_folder(path, i),
        }
    }

    /// Something that is no drawing may be a folder whose files came without events of their own.
    fn maybe_folder(&mut self, path: PathBuf, i: usize) {
        if self.settings.depth > 0 && self.roots[i].names.folder_reason(&path).is_none() {
            self.unknown.insert(path);
        }
    }

    fn tell_ignored(&mut self, path: PathBuf, why: String) {
        if self.ignored.len() < MAX_IGNORED && self.ignored.insert(path.clone()) {
            self.out.push(Action::Ignored { path, why });
        }
    }

    /// What was left alone and is no longer there need not be listed.
    fn forget_ignored(&mut self, i: usize, found: &[(PathBuf, Stat)]) {
        let there: BTreeSet<&Path> = found.iter().map(|(path, _)| path.as_path()).collect();
        let gone = |path: &&PathBuf| self.root_of(path) == Some(i) && !there.contains(path.as_path());
        for path in self.ignored.iter().filter(gone).cloned().collect::<Vec<_>>() {
            self.ignored.remove(&path);
            self.out.push(Action::IgnoredGone(path));
        }
    }

    fn restart(&mut self, now: Duration, path: PathBuf, i: usize) {
        let quiet = self.roots[i].quiet;
        let p = self.pending.entry(path).or_insert_with(|| Pending::new(now, quiet));
        p.changed = now;
        p.next = now;
        p.pause = p.quiet;
        p.is_unheard = false;
    }

    /// Takes in the answer to [`Action::Look`], or what a scan saw.
    pub fn on_stat(&mut self, now: Duration, path: &Path, seen: Seen) {
        let Some(i) = self.root_of(path) else { return };
        if self.roots[i].is_offline {
            return;
        }
        match seen {
            Seen::There(stat) => self.there(now, path, stat, i),
            Seen::Gone => self.gone(now, path, i),
            Seen::Unreadable(why) => self.unreadable(now, path, &why),
        }
    }

    fn there(&mut self, now: Duration, path: &Path, stat: Stat, i: usize) {
        match stat.kind {
            Kind::Link => return self.no_file(path, A_LINK, i),
            Kind::Other => return self.no_file(path, A_PIPE, i),
            Kind::Folder => {
                // A scan lists one with a drawing's name each time: its files are looked for once.
                let is_known = self.ignored.contains(path);
                self.no_file(path, A_FOLDER, i);
                if is_known {
                    return;
                }
                let soon = now + Duration::from_secs_f64(FOLDER_SCAN_SECS);
                self.roots[i].next_scan = self.roots[i].next_scan.min(soon);
                return;
            }
            Kind::File | Kind::Placeholder => {}
        }
        if !matches!(self.roots[i].names.verdict(path), Verdict::Take | Verdict::Settings) {
            return;
        }
        if self.ignored.remove(path) {
            self.out.push(Action::IgnoredGone(path.into()));
        }
        let is_settled = self.settled.get(path) == Some(&stat);
        let Some(p) = self.pending.get_mut(path) else {
            if !is_settled {
                let mut p = Pending::new(now, self.roots[i].quiet);
                p.stat = Some(stat);
                p.next = now + p.quiet;
                self.pending.insert(path.into(), p);
            }
            return;
        };
        p.is_asked = false;
        p.gone_since = None;
        if is_settled && p.stat.is_none() {
            // The event was somebody reading, or our own look: nothing changed since it settled.
            self.pending.remove(path);
        } else if p.stat != Some(stat) {
            let is_first = p.stat.is_none() && p.changed + p.quiet > now;
            p.changed = if is_first { p.changed } else { now };
            p.stat = Some(stat);
            p.pause = p.quiet;
            p.next = p.changed + p.quiet;
        } else if now < p.changed + p.quiet {
            p.next = p.changed + p.quiet;
        } else {
            if std::mem::take(&mut p.is_unheard) {
                self.unheard(now, path, i);
            }
            self.quiet_enough(path, stat);
        }
    }

    /// What bears a drawing's name and is no file is never opened, only named (hazard 30).
    fn no_file(&mut self, path: &Path, why: &str, i: usize) {
        self.pending.remove(path);
        if self.settled.remove(path).is_some() {
            self.out.push(Action::Removed(path.into()));
            self.settings_touched(path);
        }
        if self.roots[i].names.verdict(path) == Verdict::Take {
            self.tell_ignored(path.into(), why.into());
        }
    }

    /// A change that only a regular scan found, and of which no event told since: the root's events cannot be
    /// trusted, whatever kind of drive it lies on (hazard 10). A file of our own would prove nothing: a change made
    /// on this machine is told of also where those of other machines are not.
    fn unheard(&mut self, now: Duration, path: &Path, i: usize) {
        let (root, name) = (self.roots[i].path.clone(), path.file_name().unwrap_or_default());
        let why = format!("{} changed, and the system did not say so", name.to_string_lossy());
        self.blind(now, &root, "watch-deaf", why);
    }

    /// Whether somebody who watches should have been told of what a scan found: the root's own files, and others
    /// where the same file has other content. Folders come and go with all that is in them.
    fn should_be_heard(&self, path: &Path, stat: &Stat, i: usize) -> bool {
        let r = &self.roots[i];
        let is_own = path.parent() == Some(r.path.as_path());
        let is_same_file = || self.settled.get(path).is_some_and(|old| old.inode == stat.inode);
        r.is_regular && !r.is_polled && (is_own || is_same_file())
    }

    fn quiet_enough(&mut self, path: &Path, stat: Stat) {
        // Data may be anybody's and of any size: only a scene that names them reads them.
        if is_data(path) && self.names_for(path).is_some_and(|n| n.verdict(path) == Verdict::Settings) {
            return self.settled_settings(path, stat);
        }
        let trouble = if stat.kind == Kind::Placeholder {
            Some((
                "online-only",
                "is stored online only; pin it in the cloud client to have it here".to_owned(),
            ))
        } else if stat.size > MAX_DRAWING_BYTES {
            let text =
                format!("has {} bytes, over the limit MAX_DRAWING_BYTES of {MAX_DRAWING_BYTES}", stat.size);
            Some(("file-too-large", text))
        } else {
            None
        };
        match trouble {
            Some((code, text)) => {
                self.pending.remove(path);
                self.settled.insert(path.into(), stat);
                self.tell(path, code, text);
            }
            None => {
                if let Some(p) = self.pending.get_mut(path) {
                    p.is_asked = true;
                }
                self.out.push(Action::Check(path.into()));
            }
        }
    }

    fn gone(&mut self, now: Duration, path: &Path, i: usize) {
        if self.ignored.remove(path) {
            self.pending.remove(path);
            self.out.push(Action::IgnoredGone(path.into()));
            return;
        }
        let was_known = self.settled.remove(path).is_some();
        if !self.pending.contains_key(path) && !was_known {
            return;
        }
        let grace = Duration::from_secs_f64(self.settings.grace_secs);
        let quiet = self.roots[i].quiet;
        let p = self.pending.entry(path.into()).or_insert_with(|| Pending::new(now, quiet));
        p.is_asked = false;
        p.stat = None;
        let since = *p.gone_since.get_or_insert(now);
        p.next = (now + Duration::from_secs_f64(GRACE_LOOK_SECS)).min(since + grace);
        if now >= since + grace {
            self.pending.remove(path);
            self.out.push(Action::Removed(path.into()));
            self.settings_touched(path);
        }
    }

    fn unreadable(&mut self, now: Duration, path: &Path, why: &str) {
        let max = Duration::from_secs_f64(MAX_BACKOFF_SECS);
        let Some(p) = self.pending.get_mut(path) else { return };
        p.is_asked = false;
        p.pause = (p.pause * 2).min(max);
        p.next = now + p.pause;
        if !std::mem::replace(&mut p.is_told, true) {
            self.tell(path, "unreadable", format!("cannot be read: {why}; tried again when that changes"));
        }
    }

    /// Takes in the answer to [`Action::Check`].
    pub fn on_check(&mut self, now: Duration, path: &Path, checked: Checked) {
        let Some(i) = self.root_of(path) else { return };
        let Some(p) = self.pending.get_mut(path) else { return };
        p.is_asked = false;
        match checked {
            Checked::Gone => self.gone(now, path, i),
            Checked::Unreadable(why) => self.unreadable(now, path, &why),
            Checked::Changed => {
                p.stat = None;
                p.changed = now;
                p.next = now;
            }
            Checked::Read { stat, .. } if p.stat != Some(stat) => {
                p.stat = Some(stat);
                p.changed = now;
                p.next = now + p.quiet;
            }
            Checked::Read { .. } if now < p.changed + p.quiet => p.next = p.changed + p.quiet,
            Checked::Read { stat, sha256, completeness } => self.read(now, path, stat, sha256, completeness),
        }
    }

    fn read(&mut self, now: Duration, path: &Path, stat: Stat, sha256: String, whole: Completeness) {
        let is_settings = self.names_for(path).is_some_and(|n| n.verdict(path) == Verdict::Settings);
        let unmarked = Duration::from_secs_f64(QUIET_UNMARKED_SECS.min(self.settings.quiet_secs * 3.0));
        let Some(p) = self.pending.get_mut(path) else { return };
        match whole {
            _ if is_settings => self.settled_settings(path, stat),
            Completeness::Incomplete(what) => self.incomplete(now, path, &what),
            Completeness::NoEndMark if now < p.changed + unmarked => p.next = p.changed + unmarked,
            _ => {
                let was_told = p.is_told;
                self.pending.remove(path);
                self.settled.insert(path.into(), stat);
                if was_told {
                    self.out.push(Action::Resolved(path.into()));
                }
                self.out.push(Action::Ready { path: path.into(), sha256 });
            }
        }
    }

    /// Settings have no end mark; a half-written one is an error of its drawing until the rest comes.
    fn settled_settings(&mut self, path: &Path, stat: Stat) {
        self.pending.remove(path);
        self.settled.insert(path.into(), stat);
        self.settings_touched(path);
    }

    fn incomplete(&mut self, now: Duration, path: &Path, what: &str) {
        let Some(p) = self.pending.get_mut(path) else { return };
        p.pause = (p.pause * 2).min(Duration::from_secs_f64(MAX_BACKOFF_SECS));
        p.next = now + p.pause;
        let late = p.first + Duration::from_secs_f64(self.settings.max_wait_secs);
        let is_news = !std::mem::replace(&mut p.is_noted, true);
        if now < late {
            p.next = p.next.min(late);
            if is_news {
                let text = format!("is not whole yet ({what}); waiting for the rest");
                self.say(path, Severity::Info, "incomplete", text);
            }
        } else if !std::mem::replace(&mut p.is_told, true) {
            let text =
                format!("is still incomplete ({what}); save it again if the program has finished writing");
            self.tell(path, "still-incomplete", text);
        }
    }

    /// Takes in what a scan of `root` found; `None`: the root is not there.
    pub fn on_scan(&mut self, now: Duration, root: &Path, found: Option<Vec<(PathBuf, Stat)>>) {
        let Some(i) = self.roots.iter().position(|r| r.path == root) else { return };
        self.roots[i].is_scanning = false;
        let Some(found) = found else {
            self.roots[i].next_look = now;
            return;
        };
        if self.roots[i].is_offline {
            return;
        }
        self.forget_ignored(i, &found);
        let mut seen = BTreeSet::new();
        for (path, stat) in found {
            match self.roots[i].names.verdict(&path) {
                Verdict::Take | Verdict::Settings => {
                    self.scanned(now, &path, stat, i);
                    seen.insert(path);
                }
                Verdict::Ignore(why) => self.tell_ignored(path, why),
                Verdict::Other => {}
            }
        }
        let missing: Vec<PathBuf> = self
            .settled
            .keys()
            .filter(|p| self.root_of(p) == Some(i) && !seen.contains(*p))
            .cloned()
            .collect();
        // A scan that could not enter a folder must not look like deletions: each is looked at.
        missing.into_iter().for_each(|path| self.restart(now, path, i));
    }

    /// A scan may be older than an event that came while it ran, so it starts a wait but ends none.
    fn scanned(&mut self, now: Duration, path: &Path, stat: Stat, i: usize) {
        match self.pending.get_mut(path) {
            None => {
                let should_be_heard = self.should_be_heard(path, &stat, i);
                self.there(now, path, stat, i);
                if let Some(p) = self.pending.get_mut(path) {
                    p.is_unheard = should_be_heard;
                }
            }
            Some(p) if p.stat != Some(stat) => p.next = p.next.min(now),
            Some(_) => {}
        }
    }

    /// Takes in the answer to [`Action::LookRoot`]; `None`: the root is not there.
    pub fn on_root(&mut self, now: Duration, root: &Path, identity: Option<Identity>) {
        let Some(i) = self.roots.iter().position(|r| r.path == root) else { return };
        let max = Duration::from_secs_f64(self.settings.rescan_secs.max(ROOT_LOOK_SECS));
        let r = &mut self.roots[i];
        r.is_looking = false;
        if std::mem::take(&mut r.is_strained) {
            self.out.push(Action::Resolved(root.into()));
        }
        let r = &mut self.roots[i];
        let Some(identity) = identity else {
            r.next_look = now + r.offline_pause;
            r.offline_pause = (r.offline_pause * 2).min(max);
            r.identity = None;
            if !std::mem::replace(&mut r.is_offline, true) {
                self.suspend(i);
            }
            return;
        };
        r.offline_pause = Duration::from_secs_f64(ROOT_LOOK_SECS);
        r.next_look = now + r.offline_pause;
        let is_another = r.identity.replace(identity).is_some_and(|old| old != identity);
        let is_back = std::mem::replace(&mut r.is_offline, false);
        if is_back {
            self.forget_pending(i);
            self.out.push(Action::Online(root.into()));
        }
        if is_another || is_back {
            self.roots[i].scan_for_cause(now);
            self.out.push(Action::Rearm(root.into()));
        }
    }

    /// Takes in that [`Action::LookRoot`] could not be answered: this program may open no more files. The folder is
    /// not the less there; said once, and tried again.
    pub fn on_strain(&mut self, now: Duration, root: &Path, why: &str) {
        let Some(r) = self.roots.iter_mut().find(|r| r.path == root) else { return };
        r.is_looking = false;
        r.next_look = now + Duration::from_secs_f64(ROOT_LOOK_SECS);
        if !std::mem::replace(&mut r.is_strained, true) {
            let text =
                format!("cannot be looked into just now, as too many files are open ({why}); tried again");
            self.tell(root, "files-used-up", text);
        }
    }

    /// A root went: what is known of its files is kept, what was awaited starts anew when it returns.
    fn suspend(&mut self, i: usize) {
        self.forget_pending(i);
        self.out.push(Action::Offline(self.roots[i].path.clone()));
    }

    fn forget_pending(&mut self, i: usize) {
        let lost: Vec<PathBuf> =
            self.pending.keys().filter(|p| self.root_of(p) == Some(i)).cloned().collect();
        for path in lost {
            self.pending.remove(&path);
        }
    }

    /// What is to be done now. Call at least every 100 ms while something is pending.
    pub fn on_tick(&mut self, now: Now) -> Vec<Action> {
        self.notice_jump(now);
        self.tick_roots(now.mono);
        self.out.extend(std::mem::take(&mut self.unknown).into_iter().map(Action::Look));
        for (path, p) in &mut self.pending {
            if p.next <= now.mono && !p.is_asked {
                p.is_asked = true;
                self.out.push(Action::Look(path.clone()));
            }
        }
        std::mem::take(&mut self.out)
    }

    fn tick_roots(&mut self, now: Duration) {
        for r in &mut self.roots {
            if r.next_look <= now && !r.is_looking {
                r.is_looking = true;
                self.out.push(Action::LookRoot(r.path.clone()));
            }
            if r.next_scan <= now && !r.is_scanning && !r.is_offline {
                r.is_scanning = true;
                r.is_regular = r.next_scan == r.next_regular;
                let pause = if r.is_polled { self.settings.poll_secs } else { self.settings.rescan_secs };
                r.next_scan = now + Duration::from_secs_f64(pause);
                r.next_regular = r.next_scan;
                self.out.push(Action::Scan(r.path.clone()));
            }
        }
    }

    /// After a sleep of the machine watches may be dead and events lost: everything is armed anew.
    fn notice_jump(&mut self, now: Now) {
        let Some(last) = self.last_tick.replace(now) else { return };
        let mono = now.mono.saturating_sub(last.mono).as_secs_f64();
        let wall = now.wall.as_secs_f64() - last.wall.as_secs_f64();
        if mono <= CLOCK_JUMP_SECS && (wall - mono).abs() <= CLOCK_JUMP_SECS {
            return;
        }
        for r in self.roots.iter_mut().filter(|r| !r.is_offline) {
            r.scan_for_cause(now.mono);
            self.out.push(Action::Rearm(r.path.clone()));
        }
    }

    fn tell(&mut self, path: &Path, code: &'static str, text: String) {
        self.say(path, Severity::Warning, code, text);
    }

    fn say(&mut self, path: &Path, severity: Severity, code: &'static str, text: String) {
        let place = Place::file(path.file_name().unwrap_or(path.as_os_str()).to_string_lossy());
        let problem = Problem { code, severity, place, text };
        self.out.push(Action::Problem { path: path.into(), problem });
    }

    fn settings_touched(&mut self, path: &Path) {
        if self.names_for(path).is_some_and(|n| n.verdict(path) == Verdict::Settings) {
            self.out.push(Action::SettingsChanged(path.into()));
        }
    }

    fn root_of(&self, path: &Path) -> Option<usize> {
        let holds = self.roots.iter().enumerate().filter(|(_, r)| path.starts_with(&r.path));
        holds.max_by_key(|(_, r)| r.path.as_os_str().len()).map(|(i, _)| i)
    }
}

impl Pending {
    fn new(now: Duration, quiet: Duration) -> Self {
        Self {
            stat: None,
            first: now,
            changed: now,
            next: now,
            pause: quiet,
            quiet,
            gone_since: None,
            is_asked: false,
            is_noted: false,
            is_told: false,
            is_unheard: false,
        }
    }
}

#[cfg(test)]
#[path = "settle_tests.rs"]
mod tests;

//! The jobs that run: which begin, how each ends, and what the user hears of it.

use super::super::child::{JOB_KILLED, OUT_OF_MEMORY, reading_too_long};
use super::super::hands::{Outcome, Task, start_job};
use super::super::turns::{self, Busy, Room, Wish};
use super::super::{Done, Share};
use super::words::{hung, killed_too_often, retry_pause, told_to_end, too_long};
use super::*;
use crate::store::round_name;
use crate::worked::WAITS_MAX;

/// A job that was told to stop and did not is left to itself after this long (hazard 23).
const HANG_PATIENCE: Duration = Duration::from_secs(5);
/// A job whose process is killed from outside is tried so often in all.
const KILLS_MAX: u32 = 3;
const TOO_LONG: &str = "it ran too long";
const READING_TOO_LONG: &str = "its drawing was read too long";
const MORE_MEMORY: &str = "it needs more memory, and begins again once that is free";
const GIVES_WAY: &str = "it takes long and gives way to shorter drawings; it goes on after them";

pub(super) struct Running {
    pub(super) id: u64,
    pub(super) what: Waiting,
    pub(super) cancel: Cancel,
    since: Instant,
    /// How much processor time it has taken, as it says itself.
    pub(super) worked: Option<Duration>,
    /// Whether its drawing is not understood yet.
    pub(super) is_reading: bool,
    /// Whether its search has begun.
    pub(super) is_searching: bool,
    /// Whether its best so far lies there.
    pub(super) has_best: bool,
    share: Share,
    stopped: Option<Instant>,
    /// Why it was told to stop.
    pub(super) why: &'static str,
}

impl Running {
    /// Its processor time; by the clock as long as it has said nothing.
    fn worked(&self) -> Duration {
        self.worked.unwrap_or_else(|| self.since.elapsed())
    }

    /// The first reason holds.
    pub(super) fn stop(&mut self, why: &'static str) {
        self.cancel.stop();
        self.stop_keeping(why);
    }

    /// The same, and the best so far of a search is waited for; asked for again, it is waited for no longer.
    pub(super) fn stop_keeping(&mut self, why: &'static str) {
        if self.cancel.is_stopped() || !self.is_searching {
            self.cancel.stop();
        }
        self.cancel.stop_keeping();
        if self.stopped.is_none() {
            (self.stopped, self.why) = (Some(Instant::now()), why);
        }
    }
}

impl Heart {
    /// The job of a drawing that runs.
    pub(super) fn running_of(&mut self, drawing: &Path) -> Option<&mut Running> {
        self.running.iter_mut().find(|r| r.what.drawing == drawing)
    }

    pub(super) fn is_running(&self, drawing: &Path) -> bool {
        self.running.iter().any(|r| r.what.drawing == drawing)
    }

    fn room(&self) -> Room {
        let s = &self.settings;
        Room { jobs: s.jobs.max(1), memory: s.memory_bytes, job_memory: s.job_memory_bytes }
    }

    fn busy(&self) -> Vec<Busy> {
        let one = |r: &Running| Busy {
            takes: self.estimate(&r.what),
            worked: r.worked(),
            memory: r.share.memory_bytes,
            is_ending: r.cancel.is_stopped(),
        };
        self.running.iter().map(one).collect()
    }

    fn estimate(&self, what: &Waiting) -> Duration {
        turns::estimate(what.of.bytes, self.took.get(&what.drawing).copied())
    }

    /// Those that may begin, by their places in the queue.
    fn wishes(&self) -> (Vec<usize>, Vec<Wish>) {
        let (now, room) = (Instant::now(), self.room());
        // Those of a root that is away wait for it: each would fail with a line of its own.
        let is_there = |w: &Waiting| self.root_of(&w.drawing).is_some_and(|r| !r.is_offline);
        let can_start = |w: &Waiting| {
            w.not_before.is_none_or(|t| t <= now)
                && is_there(w)
                && !self.is_running(&w.drawing)
                && self.journal_of(&w.drawing).is_some()
        };
        let wish = |w: &Waiting| Wish {
            takes: self.estimate(w),
            waited: w.since.elapsed(),
            memory: room.memory_for(w.of.bytes, w.is_hungry),
        };
        self.queue.iter().enumerate().filter(|(_, w)| can_start(w)).map(|(i, w)| (i, wish(w))).unzip()
    }

    /// Begins what has its turn; where all that run take long and something short waits, one of them gives way.
    pub(super) fn start_waiting(&mut self, show: &mut dyn FnMut(Notice)) {
        if self.queue.is_empty() {
            return;
        }
        loop {
            let ((places, wishes), busy, room) = (self.wishes(), self.busy(), self.room());
            let Some(i) = turns::next(&wishes, &busy, &room) else {
                if let Some(i) = turns::gives_way(&wishes, &busy, &room) {
                    self.running[i].stop(GIVES_WAY);
                }
                return;
            };
            let Some(what) = self.queue.remove(places[i]) else { return };
            self.begin(what, wishes[i], show);
        }
    }

    fn begin(&mut self, what: Waiting, wish: Wish, show: &mut dyn FnMut(Notice)) {
        let Some(journal) = self.journal_of(&what.drawing) else { return };
        // Why it failed before is over; messages from here on are about the file as it is now.
        self.failed.remove(&what.drawing);
        self.cancelled.remove(&what.drawing);
        self.note(&what, &Step::Started, show);
        self.next_id += 1;
        let (id, cancel) = (self.next_id, Cancel::default());
        let (below, placing) = (self.below(&what.drawing), self.placing_of(&what.drawing));
        let started = Notice::Started(what.drawing.clone());
        show(if self.waits_for_room(&what) { Notice::Again(Box::new(started)) } else { started });
        let share = Share { memory_bytes: wish.memory, is_long: wish.takes > turns::SHORT };
        let (what_runs, content_key) = (what.clone(), self.settings.content_key);
        let task =
            Task { id, what: what_runs, below, placing, cancel: cancel.clone(), journal, share, content_key };
        start_job(self.disk.clone(), task, self.run.clone(), self.send.clone());
        let since = Instant::now();
        self.running.push(Running {
            id,
            what,
            cancel,
            since,
            worked: None,
            is_reading: true,
            is_searching: false,
            has_best: false,
            share,
            stopped: None,
            why: "",
        });
        self.is_overview_stale = true;
    }

    /// How long the drawing takes, for the order of the next jobs.
    fn time(&mut self, running: &Running, outcome: &Outcome) {
        let is_known = matches!(outcome, Outcome::Ended(Ok(_)))
            || [GIVES_WAY, TOO_LONG, READING_TOO_LONG].contains(&running.why);
        if is_known {
            self.took.insert(running.what.drawing.clone(), running.worked());
        }
    }

    /// Whether a job that had too little memory can have more.
    fn gets_more(&self, what: &Waiting, share: Share) -> bool {
        let most = self.room().memory_for(what.of.bytes, true);
        !what.is_hungry && share.memory_bytes.is_some_and(|had| most.is_none_or(|most| most > had))
    }

    /// The job waits again, and begins from what it has kept.
    fn go_on_later(&mut self, what: Waiting, why: &'static str, show: &mut dyn FnMut(Notice)) {
        let drawing = what.drawing.clone();
        let is_replaced = self.queue.iter().any(|w| w.drawing == drawing);
        show(Notice::Stopped { drawing: drawing.clone(), why });
        if !is_replaced {
            self.enqueue(Waiting { since: what.since, not_before: None, ..what }, show);
        }
    }

    pub(super) fn ended(&mut self, running: Running, outcome: Outcome, show: &mut dyn FnMut(Notice)) {
        self.is_overview_stale = true;
        self.time(&running, &outcome);
        let is_kept = running.why == BY_THE_USER && running.has_best;
        let why = if is_kept { BY_THE_USER_KEPT } else { running.why };
        let what = running.what;
        match outcome {
            Outcome::Ended(Ok(done)) => {
                if let Some(root) = self.root_of_mut(&what.drawing) {
                    root.done_count += 1;
                }
                let drawing = what.drawing.clone();
                self.has_room(&drawing, running.since, show);
                show(Notice::Done { drawing, done: done.clone() });
                self.say_what_it_is_of(&what, &done, show);
            }
            Outcome::Changed => {
                let why = match why {
                    "" if what.asked != Asked::default() => NEWER_CONTENT,
                    "" => NEWER_SAVE,
                    why => why,
                };
                self.stopped(&what, why, show);
                self.settle.again(self.start.elapsed(), &what.drawing);
            }
            Outcome::Ended(Err(_)) if running.why == TOO_LONG => {
                let error = too_long(&what.drawing, self.settings.job_limit_secs, running.has_best);
                self.failed_for_good(what, error, show);
            }
            Outcome::Ended(Err(_)) if running.why == READING_TOO_LONG => {
                let error = reading_too_long(&what.drawing, self.settings.read_limit_secs);
                self.failed_for_good(what, error, show);
            }
            Outcome::Ended(Err(_)) if running.why == GIVES_WAY => self.go_on_later(what, GIVES_WAY, show),
            Outcome::Ended(Err(Error::Input(problem)))
                if problem.code == OUT_OF_MEMORY && self.gets_more(&what, running.share) =>
            {
                self.go_on_later(Waiting { is_hungry: true, ..what }, MORE_MEMORY, show);
            }
            // Whatever a job that was told to end fails of by then, it is not tried again.
            Outcome::Ended(Err(_)) if !why.is_empty() => self.stopped(&what, why, show),
            Outcome::Ended(Err(Error::Stopped)) => {
                self.retry(what.clone(), told_to_end(&what.drawing), show);
            }
            Outcome::Ended(Err(Error::Environment(problem)))
                if problem.code == JOB_KILLED && what.failures + 1 >= KILLS_MAX =>
            {
                self.failed_for_good(what, killed_too_often(problem, KILLS_MAX), show);
            }
            Outcome::Ended(Err(Error::Environment(problem))) => self.retry(what, problem, show),
            Outcome::Ended(Err(error)) => self.failed_for_good(what, error, show),
        }
    }

    /// A file that was overwritten while its job ran, and is not whole since: the results are of what lay there before.
    fn say_what_it_is_of(&mut self, what: &Waiting, done: &Done, show: &mut dyn FnMut(Notice)) {
        let Some(unfinished) = self.failed.get(&what.drawing) else { return };
        let text = format!(
            "the results are of the content before, which no longer lies there: the file {}",
            unfinished.text
        );
        let problem = Problem {
            code: "results-of-earlier-content",
            severity: Severity::Warning,
            place: shown(&what.drawing),
            text,
        };
        let round = done.round.map(round_name);
        let problems = [problem.clone()];
        let standing = Standing {
            state: "done",
            sha256: &what.of.sha256,
            content: &what.of.key,
            config: &what.of.config,
            round: round.as_deref(),
            summary: Some(&done.summary),
            problems: &problems,
        };
        write_standing(&*self.disk, &what.drawing, &self.placing_of(&what.drawing), &standing);
        show(Notice::Problem { path: what.drawing.clone(), problem });
    }

    pub(super) fn stopped(&mut self, what: &Waiting, why: &'static str, show: &mut dyn FnMut(Notice)) {
        let is_cancelled = [BY_THE_USER, BY_THE_USER_KEPT].contains(&why);
        self.note(what, if is_cancelled { &Step::Cancelled } else { &Step::Stopped }, show);
        let newer = self.queue.iter().find(|w| w.drawing == what.drawing);
        let (state, sha256) = newer.map_or(("stopped", &what.of.sha256), |w| ("waiting", &w.of.sha256));
        let standing = Standing { state, sha256, summary: Some(why), ..Standing::default() };
        let placing = self.placing_of(&what.drawing);
        if what.drawing.exists() {
            write_standing(&*self.disk, &what.drawing, &placing, &standing);
        } else {
            settle_gone(&*self.disk, &what.drawing, &placing, why);
        }
        if is_cancelled && newer.is_none() && self.contents.contains_key(&what.drawing) {
            self.cancelled.insert(what.drawing.clone());
        }
        show(Notice::Stopped { drawing: what.drawing.clone(), why });
    }

    pub(super) fn failed_for_good(&mut self, what: Waiting, error: Error, show: &mut dyn FnMut(Notice)) {
        let Some(problem) = error.problem().cloned() else { return };
        self.note(&what, &Step::Failed(problem.clone()), show);
        self.write_failure("failed", &what, &problem);
        show(Notice::Failed { drawing: what.drawing, problem, retry_secs: None });
    }

    /// Disk and permission may come back: the job waits, ever longer, and is tried again.
    pub(super) fn retry(&mut self, mut what: Waiting, problem: Problem, show: &mut dyn FnMut(Notice)) {
        let pause = retry_pause(self.settings.retry_secs, what.failures);
        self.write_failure("waiting", &what, &problem);
        self.tell(Notice::Failed { drawing: what.drawing.clone(), problem, retry_secs: Some(pause) }, show);
        if self.queue.iter().all(|w| w.drawing != what.drawing) {
            what.failures += 1;
            what.not_before = Some(Instant::now() + Duration::from_secs_f64(pause));
            self.queue.push_back(what);
        }
    }

    pub(super) fn write_failure(&mut self, state: &str, what: &Waiting, problem: &Problem) {
        self.fail(&what.drawing, problem);
        let problems = [problem.clone()];
        let standing =
            Standing { state, sha256: &what.of.sha256, problems: &problems, ..Standing::default() };
        write_standing(&*self.disk, &what.drawing, &self.placing_of(&what.drawing), &standing);
    }

    /// A job that runs too long is stopped, and one that reads its drawing too long: it counts its own work, the daemon
    /// those that wait. One that does not even stop is left to itself.
    pub(super) fn watch_running(&mut self, show: &mut dyn FnMut(Notice)) {
        let limit = Duration::from_secs_f64(self.settings.job_limit_secs);
        let reading = Duration::from_secs_f64(self.settings.read_limit_secs).saturating_mul(WAITS_MAX);
        for running in self.running.iter_mut().filter(|r| r.stopped.is_none()) {
            if running.since.elapsed() >= limit {
                running.stop_keeping(TOO_LONG);
            } else if running.is_reading && running.since.elapsed() >= reading {
                running.stop(READING_TOO_LONG);
            }
        }
        let is_deaf = |r: &Running| {
            let patience = HANG_PATIENCE + if r.cancel.keeps_best() { KEEP_GRACE } else { Duration::ZERO };
            r.stopped.is_some_and(|t| t.elapsed() >= patience)
        };
        while let Some(i) = self.running.iter().position(is_deaf) {
            let running = self.running.remove(i);
            let error = hung(&running.what.drawing);
            self.failed_for_good(running.what, error, show);
        }
    }
}

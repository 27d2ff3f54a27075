//! What the user orders of a drawing, and what becomes of orders that can no longer be carried out.

use super::*;

impl Heart {
    pub(super) fn obey(&mut self, order: Order, show: &mut dyn FnMut(Notice)) {
        match order {
            Order::Cancel(drawing) => self.cancel(drawing, show),
            Order::Again { drawing, asked } => {
                let Some(of) = self.contents.get(&drawing).cloned() else {
                    return show(Notice::Stopped { drawing, why: NOTHING_WHOLE });
                };
                // What was asked before in other words is done too, in its turn.
                let is_other = |w: &Waiting| w.asked != Asked::default() && w.asked != asked;
                self.queue.retain(|w| w.drawing != drawing || is_other(w));
                self.enqueue(Waiting::new(drawing, of, asked), show);
            }
        }
    }

    /// Gives up what runs, but for the best that it found so far, and all that waits, and says so of each.
    fn cancel(&mut self, drawing: PathBuf, show: &mut dyn FnMut(Notice)) {
        let (own, others) = std::mem::take(&mut self.queue).into_iter().partition(|w| w.drawing == drawing);
        self.queue = others;
        for waiting in Vec::from(own) {
            self.stopped(&waiting, BY_THE_USER, show);
        }
        if let Some(running) = self.running_of(&drawing) {
            running.stop_keeping(BY_THE_USER);
            // Also where the daemon is killed before the best so far is written.
            let what = running.what.clone();
            self.note(&what, &Step::Cancelled, show);
        }
        self.is_overview_stale = true;
    }

    /// Forgets what waits of a drawing; rounds with wishes of their own, which nobody asks for again, are told.
    pub(super) fn drop_waiting(&mut self, drawing: &Path, why: &'static str, show: &mut dyn FnMut(Notice)) {
        let of = |w: &&Waiting| w.drawing == drawing;
        let wishes = self.queue.iter().filter(of).filter(|w| w.asked != Asked::default()).count();
        self.queue.retain(|w| w.drawing != drawing);
        for _ in 0..wishes {
            show(Notice::Stopped { drawing: drawing.into(), why });
        }
    }

    pub(super) fn enqueue(&mut self, waiting: Waiting, show: &mut dyn FnMut(Notice)) {
        let drawing = waiting.drawing.clone();
        if self.queue.len() >= MAX_QUEUE {
            // Nobody asks for wishes again.
            if waiting.asked != Asked::default() {
                return show(Notice::Stopped { drawing, why: TOO_MANY_WAIT });
            }
            let later = self.start.elapsed() + Duration::from_secs_f64(self.settings.rescan_secs);
            return self.settle.again(later, &drawing);
        }
        self.cancelled.remove(&drawing);
        self.is_overview_stale = true;
        self.note(&waiting, &Step::Queued, show);
        if !self.running.is_empty() && !self.is_running(&drawing) {
            let standing = Standing { state: "waiting", sha256: &waiting.of.sha256, ..Standing::default() };
            write_standing(&*self.disk, &drawing, &self.placing_of(&drawing), &standing);
        }
        if self.settings.newest_first {
            self.queue.push_front(waiting);
        } else {
            self.queue.push_back(waiting);
        }
        show(Notice::Queued { drawing, waiting: self.queue.len() });
    }
}

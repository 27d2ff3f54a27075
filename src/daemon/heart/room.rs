//! A full disk is told when that begins and when it is over; in between the page and `status` know of it.

use super::words::lasting;
use super::*;
use crate::store::DISK_FULL;

impl Heart {
    /// Shows a notice, aloud unless it says of a full disk what was said before.
    pub(super) fn tell(&mut self, notice: Notice, show: &mut dyn FnMut(Notice)) {
        let full = match &notice {
            Notice::Failed { drawing: path, problem, .. } | Notice::Problem { path, problem } => {
                (problem.code == DISK_FULL).then(|| self.root_path_of(path))
            }
            _ => None,
        };
        let is_known = full.as_ref().is_some_and(|root| self.full_since.contains_key(root));
        if let Some(root) = full {
            self.full_since.entry(root).or_insert_with(Instant::now);
        }
        show(if is_known { Notice::Again(Box::new(notice)) } else { notice });
    }

    /// Whether a job only tries again whether there is room by now.
    pub(super) fn waits_for_room(&self, what: &Waiting) -> bool {
        what.failures > 0 && self.full_since.contains_key(&self.root_path_of(&what.drawing))
    }

    /// A job that began at `since` has written its results.
    pub(super) fn has_room(&mut self, drawing: &Path, since: Instant, show: &mut dyn FnMut(Notice)) {
        let root = self.root_path_of(drawing);
        if self.full_since.get(&root).is_some_and(|full| *full < since) {
            self.over(root, "there is room for results again", show);
        }
    }

    /// Where nothing waits any more, since it was cancelled or is gone, nobody finds out whether there is room.
    pub(super) fn forget_full_disks(&mut self, show: &mut dyn FnMut(Notice)) {
        let busy = self.queue.iter().chain(self.running.iter().map(|r| &r.what));
        let still: BTreeSet<PathBuf> = busy.map(|w| self.root_path_of(&w.drawing)).collect();
        let idle: Vec<PathBuf> = self.full_since.keys().filter(|r| !still.contains(*r)).cloned().collect();
        for root in idle {
            self.over(root, "nothing waits for room on the disk any more", show);
        }
    }

    fn over(&mut self, root: PathBuf, what: &str, show: &mut dyn FnMut(Notice)) {
        let Some(since) = self.full_since.remove(&root) else { return };
        let text = format!("{what}, after {}", lasting(since.elapsed()));
        let place = Place::file(root.to_string_lossy());
        let problem = Problem { code: "disk-has-room", severity: Severity::Info, place, text };
        show(Notice::Problem { path: root, problem });
    }

    fn root_path_of(&self, path: &Path) -> PathBuf {
        self.root_of(path).map_or_else(PathBuf::new, |r| r.path.clone())
    }
}

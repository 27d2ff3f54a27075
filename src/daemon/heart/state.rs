//! What the daemon holds of a root: its lock, its journal, and the word where they lie.

use super::*;
use crate::store::{Claim, DISK_FULL, Lease, Ownership, state_folder};

pub(super) struct State {
    pub(super) folder: PathBuf,
    ownership: Ownership,
    /// Held where the state lies outside of the root.
    record: Option<Ownership>,
    /// Why others will not find this daemon.
    pub(super) unrecorded: Option<Problem>,
    pub(super) journal: Arc<Mutex<Journal>>,
}

impl State {
    /// Gives a sign of life; `false`: another daemon has taken the root meanwhile.
    pub(super) fn beat(&mut self) -> Result<bool, Error> {
        if let Some(record) = &mut self.record
            && let Ok(false) = record.beat()
        {
            return Ok(false);
        }
        self.ownership.beat()
    }

    /// See [`Ownership::reach`].
    pub(super) fn reach(&mut self, depth: usize) {
        self.ownership.reach(depth);
        self.record.iter_mut().for_each(|record| record.reach(depth));
    }
}

/// Whether a root whose state cannot be kept at the start is tried again at every heartbeat: so that one folder holds up
/// no other, and because a full disk passes. What only the user can mend ends a daemon that has nothing else to watch.
pub(super) fn is_waited_for(root_count: usize, code: &str) -> bool {
    code != FOLDER_OWNED && (root_count > 1 || code == DISK_FULL)
}

impl Heart {
    /// Takes a root whose state could not be kept before, if it can be by now.
    pub(super) fn take_at_last(&mut self, i: usize, show: &mut dyn FnMut(Notice), stop: &Cancel) {
        let path = self.roots[i].path.clone();
        let Ok(state) = self.take(&path, stop) else { return };
        self.roots[i].state = Some(state);
        let text = "its state can be kept by now; its drawings are taken up".into();
        let place = Place::file(path.to_string_lossy());
        let problem = Problem { code: "watch-taken", severity: Severity::Info, place, text };
        show(Notice::Problem { path, problem });
    }

    pub(super) fn take(&self, root: &Path, stop: &Cancel) -> Result<State, Error> {
        let placing = self.placing(root, root);
        let own: Vec<&Path> = self.roots.iter().map(|r| r.path.as_path()).collect();
        refuse_nested(root, self.settings.depth, &own, &self.records)?;
        self.records.refuse_watched(root)?;
        let folder = state_folder(&*self.disk, root, &placing)?;
        let (host, pid, since) = (host_name(), std::process::id(), self.since.clone());
        let me = Lease { host, pid, since, beat: 0, depth: self.settings.depth };
        let heartbeat = Duration::from_secs_f64(self.settings.heartbeat_secs);
        let claim = self.records.claim(&self.disk, root, &folder, me.clone(), heartbeat, stop)?;
        let (record, unrecorded) = match claim {
            Claim::Plain => (None, None),
            Claim::Recorded(record) => (Some(record), None),
            Claim::Unrecorded(problem) => (None, Some(hidden(&folder, problem))),
        };
        let ownership = Ownership::take(self.disk.clone(), &folder, me, heartbeat, stop)?;
        let journal = Arc::new(Mutex::new(Journal::open(self.disk.clone(), &folder)?));
        Ok(State { folder, ownership, record, unrecorded, journal })
    }
}

fn hidden(state: &Path, problem: Problem) -> Problem {
    let text = format!(
        "that this daemon keeps its state in {} could not be noted ({}): `enfilade status` and other daemons will not \
         find it",
        state.display(),
        problem.text
    );
    Problem { code: "watch-unrecorded", severity: Severity::Warning, text, ..problem }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_passes_by_itself_is_waited_for() {
        for (count, code, is_waited) in [
            (1, DISK_FULL, true),
            (1, "no-permission", false),
            (2, "no-permission", true),
            (2, FOLDER_OWNED, false),
        ] {
            assert_eq!(is_waited_for(count, code), is_waited, "{count} {code}");
        }
    }
}

//! Roots that may not be written: their state lies elsewhere, and a record in a folder of the user says where. Without
//! it neither `status` nor a second daemon, whose state would lie at yet another place, could find the first.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use super::owner::{FOLDER_OWNED, Lease, Ownership, host_name, is_held, read_lease, who};
use super::{
    Disk, OR_OWN_STATE, STATE_FOLDER, disk_error_here, path_from_bytes, read_own, replace_file, sha256_hex,
    shown,
};
use enfilade_report::{Cancel, Error, Problem};

/// How the name of a record begins.
const RECORD_PREFIX: &str = "watched-";
/// Digits of the digest in its name.
const DIGITS: usize = 16;
/// The file of a record that holds where the state lies, as the system spells it.
const PLACE: &str = "place";

/// The records of a user on this machine: a home may be shared by several, on which one path is another folder.
#[derive(Clone, Debug, Default)]
pub struct Records {
    folder: Option<PathBuf>,
}

/// What a daemon holds of a root besides its state.
pub enum Claim {
    /// Nothing: the state lies in the root, or nobody keeps records.
    Plain,
    /// The record says where the state lies; nobody else can have it.
    Recorded(Ownership),
    /// The record cannot be written: others will not find this daemon, for this reason.
    Unrecorded(Problem),
}

impl Records {
    /// Those in this folder; `None`: none are kept.
    pub fn new(folder: Option<PathBuf>) -> Self {
        Self { folder }
    }

    fn of(&self, root: &Path) -> Option<PathBuf> {
        let key = [host_name().as_bytes(), b"\0", root.as_os_str().as_encoded_bytes()].concat();
        let name = format!("{RECORD_PREFIX}{}", &sha256_hex(&key)[..DIGITS]);
        self.folder.as_ref().map(|folder| folder.join(name))
    }

    /// The state folder of a root: that of the daemon that watches it, else that of the last one that did.
    pub fn state_of(&self, root: &Path) -> PathBuf {
        let own = root.join(STATE_FOLDER);
        let recorded = || place_in(&self.of(root)?);
        if is_held(&own) { own } else { recorded().unwrap_or(own) }
    }

    /// Whether a process of this machine watches the root, wherever its state lies.
    pub fn is_watched(&self, root: &Path) -> bool {
        self.watcher(root).is_some()
    }

    /// The state folder of the process that watches the root, and the folder that holds its lease.
    fn watcher(&self, root: &Path) -> Option<(PathBuf, PathBuf)> {
        let own = root.join(STATE_FOLDER);
        if is_held(&own) {
            return Some((own.clone(), own));
        }
        let record = self.of(root).filter(|record| is_held(record))?;
        Some((place_in(&record).unwrap_or(own), record))
    }

    /// The lease of a root that is watched.
    pub(super) fn held(&self, root: &Path) -> Option<Lease> {
        self.watcher(root).and_then(|(_, keeper)| read_lease(&keeper))
    }

    /// Refuses a root that another process of this machine watches, before anything is made for it.
    ///
    /// # Errors
    /// `folder-owned` names the process and where its state lies.
    pub fn refuse_watched(&self, root: &Path) -> Result<(), Error> {
        match self.watcher(root) {
            Some((state, keeper)) => Err(owned(root, &state, read_lease(&keeper).as_ref())),
            None => Ok(()),
        }
    }

    /// Takes a root whose state lies in `state` for this process, beside the state's own lock.
    ///
    /// # Errors
    /// `folder-owned` where another process watches the root with its state at another place; [`Error::Stopped`].
    pub fn claim(
        &self,
        disk: &Arc<dyn Disk>,
        root: &Path,
        state: &Path,
        me: Lease,
        heartbeat: Duration,
        stop: &Cancel,
    ) -> Result<Claim, Error> {
        if let Some((other, keeper)) = self.watcher(root).filter(|(other, _)| other != state) {
            return Err(owned(root, &other, read_lease(&keeper).as_ref()));
        }
        let Some(record) = self.of(root) else { return Ok(Claim::Plain) };
        if state == root.join(STATE_FOLDER) {
            // The last word on a root that could not be written is no longer true.
            if record.exists() && !is_held(&record) {
                let _ = disk.remove_folder(&record);
            }
            return Ok(Claim::Plain);
        }
        match record_of(disk, &record, state, me, heartbeat, stop) {
            Ok(ownership) => Ok(Claim::Recorded(ownership)),
            Err(Error::Environment(problem)) if problem.code == FOLDER_OWNED => Err(owned(
                root,
                &place_in(&record).unwrap_or_else(|| record.clone()),
                read_lease(&record).as_ref(),
            )),
            Err(Error::Environment(problem)) => Ok(Claim::Unrecorded(problem)),
            Err(other) => Err(other),
        }
    }

    /// Removes the records of ended daemons whose state is gone.
    pub fn sweep(&self, disk: &dyn Disk) {
        let entries = self.folder.as_ref().and_then(|folder| fs::read_dir(folder).ok());
        for entry in entries.into_iter().flatten().flatten() {
            let record = entry.path();
            let is_one = entry.file_name().to_string_lossy().starts_with(RECORD_PREFIX);
            if is_one && !is_held(&record) && place_in(&record).is_some_and(|state| !state.exists()) {
                let _ = disk.remove_folder(&record);
            }
        }
    }
}

fn record_of(
    disk: &Arc<dyn Disk>,
    record: &Path,
    state: &Path,
    me: Lease,
    heartbeat: Duration,
    stop: &Cancel,
) -> Result<Ownership, Error> {
    disk.create_folders(record).map_err(|e| disk_error_here("making", record, &e, OR_OWN_STATE))?;
    let ownership = Ownership::take(disk.clone(), record, me, heartbeat, stop)?;
    replace_file(&**disk, &record.join(PLACE), state.as_os_str().as_encoded_bytes())?;
    Ok(ownership)
}

fn place_in(record: &Path) -> Option<PathBuf> {
    read_own(&record.join(PLACE)).ok().map(|bytes| path_from_bytes(&bytes))
}

fn owned(root: &Path, state: &Path, lease: Option<&Lease>) -> Error {
    let place = if state == root.join(STATE_FOLDER) {
        String::new()
    } else {
        format!(", which keeps its state in {}", state.display())
    };
    let text = format!("is watched by {}{place}; stop that one first", who(lease));
    Error::environment(FOLDER_OWNED, shown(root), text)
}

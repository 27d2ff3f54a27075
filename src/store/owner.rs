//! One daemon a folder: a lock of the system, and on shares, where locks lie, a lease (hazard 21).

use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use super::own::{open_own, refuse_planted};
use super::{Disk, Records, disk_error, read_own, replace_file, shown};
use enfilade_report::{Cancel, Error};

/// A lease whose beat stands still for this many heartbeats is stale.
pub const MISSED_BEATS: u32 = 3;
/// Code of the problem that another process watches a folder.
pub const FOLDER_OWNED: &str = "folder-owned";
const LOOK_PAUSE: Duration = Duration::from_millis(50);

/// Who watches a folder: the content of `owner.json`.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Lease {
    /// Name of the machine.
    pub host: String,
    /// Process number there.
    pub pid: u32,
    /// When it began, RFC 3339.
    pub since: String,
    /// Rises with every sign of life. Clocks of two machines are never compared (hazard 15).
    pub beat: u64,
    /// Levels of folders below that it looks into.
    #[serde(default)]
    pub depth: usize,
}

/// What another's lease means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LeaseVerdict {
    /// Nobody holds the folder.
    Free,
    /// Too early to say: look again.
    Wait,
    /// Its owner lives.
    Owned,
}

/// Judges the lease of another machine: `first` as seen at the beginning, `now` after `waited`.
pub fn judge_lease(
    first: Option<&Lease>,
    now: Option<&Lease>,
    waited: Duration,
    heartbeat: Duration,
) -> LeaseVerdict {
    match (first, now) {
        (_, None) => LeaseVerdict::Free,
        (first, Some(_)) if first != now => LeaseVerdict::Owned,
        _ if waited >= heartbeat * MISSED_BEATS => LeaseVerdict::Free,
        _ => LeaseVerdict::Wait,
    }
}

/// The folder is ours until this is dropped.
pub struct Ownership {
    disk: Arc<dyn Disk>,
    path: PathBuf,
    lease: Lease,
    _lock: File,
}

impl Ownership {
    /// Takes the state folder of a watched root for this process. With a lease of another machine it
    /// waits up to three heartbeats for a sign of life; `stop` ends the wait.
    ///
    /// # Errors
    /// `folder-owned` names the owner; [`Error::Stopped`]; else from the disk.
    pub fn take(
        disk: Arc<dyn Disk>,
        folder: &Path,
        me: Lease,
        heartbeat: Duration,
        stop: &Cancel,
    ) -> Result<Self, Error> {
        let path = folder.join("owner.json");
        let (lock, is_locked) = lock(folder, &path)?;
        let rival = || read_lease(folder).filter(|l| !is_locked || l.host != me.host);
        let (first, start) = (rival(), Instant::now());
        loop {
            let now = rival();
            match judge_lease(first.as_ref(), now.as_ref(), start.elapsed(), heartbeat) {
                LeaseVerdict::Free => break,
                LeaseVerdict::Owned => return Err(owned(folder, now.as_ref())),
                LeaseVerdict::Wait => std::thread::sleep(LOOK_PAUSE),
            }
            stop.check()?;
        }
        let mut ownership = Self { disk, path, lease: me, _lock: lock };
        ownership.write()?;
        Ok(ownership)
    }

    /// Gives a sign of life; `false`: another machine has taken the folder meanwhile.
    ///
    /// # Errors
    /// From the disk; the next beat tries again.
    pub fn beat(&mut self) -> Result<bool, Error> {
        let present = self.path.parent().and_then(read_lease);
        if present.is_some_and(|l| (l.host.as_str(), l.pid) != (self.lease.host.as_str(), self.lease.pid)) {
            return Ok(false);
        }
        self.lease.beat += 1;
        self.write()?;
        Ok(true)
    }

    /// From the next sign of life on the lease says that so many levels of folders below are looked into.
    pub fn reach(&mut self, depth: usize) {
        self.lease.depth = depth;
    }

    fn write(&mut self) -> Result<(), Error> {
        let text = serde_json::to_string(&self.lease).unwrap_or_default();
        replace_file(&*self.disk, &self.path, format!("{text}\n").as_bytes())
    }
}

impl Drop for Ownership {
    fn drop(&mut self) {
        if self.path.parent().and_then(read_lease).as_ref() == Some(&self.lease) {
            let _ = self.disk.remove_file(&self.path);
        }
    }
}

/// The lock file, and whether it could be locked; where locks are unknown the lease alone decides.
fn lock(folder: &Path, owner: &Path) -> Result<(File, bool), Error> {
    let path = folder.join("lock");
    refuse_planted(owner)?;
    let open = open_own(&path, File::options().create(true).truncate(false).write(true));
    let file = open.map_err(|e| disk_error("locking", &path, &e))?;
    match file.try_lock() {
        Ok(()) => Ok((file, true)),
        Err(TryLockError::WouldBlock) => Err(owned(folder, read_lease(folder).as_ref())),
        Err(TryLockError::Error(e)) if e.kind() == io::ErrorKind::Unsupported => Ok((file, false)),
        Err(TryLockError::Error(e)) => Err(disk_error("locking", &path, &e)),
    }
}

/// The lease in a state folder, if there is one that can be read.
pub fn read_lease(folder: &Path) -> Option<Lease> {
    serde_json::from_slice(&read_own(&folder.join("owner.json")).ok()?).ok()
}

/// Refuses a root within a folder that another process of this machine watches deep enough to meet it, or with
/// such a folder within its own `depth`. `own` are the roots of this process; `records` say who watches roots that
/// may not be written.
///
/// # Errors
/// `folder-owned` names that folder and its owner.
pub fn refuse_nested(root: &Path, depth: usize, own: &[&Path], records: &Records) -> Result<(), Error> {
    let above = root.ancestors().enumerate().skip(1).filter(|(_, folder)| !own.contains(folder));
    for (levels, folder) in above {
        if let Some(lease) = records.held(folder).filter(|l| l.depth >= levels) {
            return Err(nested(root, "lies in", folder, &lease));
        }
    }
    match held_below(root, depth, own, records) {
        Some((folder, lease)) => Err(nested(root, "holds", &folder, &lease)),
        None => Ok(()),
    }
}

fn nested(root: &Path, how: &str, folder: &Path, lease: &Lease) -> Error {
    let text =
        format!("{how} {}, which is watched by {}; stop that one first", folder.display(), who(Some(lease)));
    Error::environment(FOLDER_OWNED, shown(root), text)
}

/// Whether a process of this machine, this one included, holds the lock of a state folder.
pub fn is_held(folder: &Path) -> bool {
    let path = folder.join("lock");
    // One that may only be read can be locked all the same.
    let open = open_own(&path, File::options().write(true));
    match open.or_else(|_| open_own(&path, File::options().read(true))) {
        Ok(lock) => matches!(lock.try_lock(), Err(TryLockError::WouldBlock)),
        Err(_) => false,
    }
}

fn held_below(root: &Path, depth: usize, own: &[&Path], records: &Records) -> Option<(PathBuf, Lease)> {
    if depth == 0 {
        return None;
    }
    let below = fs::read_dir(root).ok()?.filter_map(Result::ok);
    let folders = below.filter(|e| e.file_type().is_ok_and(|t| t.is_dir())).map(|e| e.path());
    folders.into_iter().find_map(|folder| {
        let lease = if own.contains(&folder.as_path()) { None } else { records.held(&folder) };
        lease.map(|l| (folder.clone(), l)).or_else(|| held_below(&folder, depth - 1, own, records))
    })
}

fn owned(folder: &Path, lease: Option<&Lease>) -> Error {
    let root = folder.parent().unwrap_or(folder);
    Error::environment(
        FOLDER_OWNED,
        shown(root),
        format!("is watched by {}; stop that one first", who(lease)),
    )
}

/// Name of this machine.
#[cfg(unix)]
pub fn host_name() -> String {
    rustix::system::uname().nodename().to_string_lossy().into_owned()
}

/// Name of this machine.
#[cfg(not(unix))]
pub fn host_name() -> String {
    std::env::var("COMPUTERNAME").unwrap_or_else(|_| "this machine".into())
}

pub(super) fn who(lease: Option<&Lease>) -> String {
    lease.map_or("another enfilade process".to_owned(), |l| {
        format!("enfilade process {} on {} (since {})", l.pid, l.host, l.since)
    })
}

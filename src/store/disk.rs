//! The few things asked of a disk, so that tests can make each of them fail.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::Path;

use super::own::{on_its_way, open_own};

/// What the store asks of a disk. Implementations: [`SystemDisk`], and in tests one that fails or
/// stops at the k-th call.
pub trait Disk: Send + Sync {
    /// Makes one folder; fails when the name is taken.
    ///
    /// # Errors
    /// The system's.
    fn create_folder(&self, path: &Path) -> io::Result<()>;
    /// Makes a folder and those above it, where missing.
    ///
    /// # Errors
    /// The system's.
    fn create_folders(&self, path: &Path) -> io::Result<()>;
    /// Writes a new file; fails when the name is taken, also by a link.
    ///
    /// # Errors
    /// The system's.
    fn write_new(&self, path: &Path, bytes: &[u8]) -> io::Result<()>;
    /// Appends to a file of ours, made if missing, and makes that durable if asked; never through a link or into a pipe.
    ///
    /// # Errors
    /// The system's.
    fn append(&self, path: &Path, bytes: &[u8], is_durable: bool) -> io::Result<()>;
    /// Makes a file's content, or a folder's names, durable.
    ///
    /// # Errors
    /// The system's.
    fn sync(&self, path: &Path) -> io::Result<()>;
    /// Renames, replacing a file of that name.
    ///
    /// # Errors
    /// The system's.
    fn rename(&self, from: &Path, to: &Path) -> io::Result<()>;
    /// Renames; fails with `AlreadyExists` when the name is taken.
    ///
    /// # Errors
    /// The system's.
    fn rename_new(&self, from: &Path, to: &Path) -> io::Result<()>;
    /// Exchanges two folders at once; `Unsupported` where the system cannot.
    ///
    /// # Errors
    /// The system's.
    fn exchange(&self, a: &Path, b: &Path) -> io::Result<()>;
    /// Removes a folder with all in it, links not followed.
    ///
    /// # Errors
    /// The system's.
    fn remove_folder(&self, path: &Path) -> io::Result<()>;
    /// Removes a file.
    ///
    /// # Errors
    /// The system's.
    fn remove_file(&self, path: &Path) -> io::Result<()>;
    /// Bytes that may still be written there.
    ///
    /// # Errors
    /// The system's.
    fn free_bytes(&self, path: &Path) -> io::Result<u64>;
}

/// The real disk. Each change is judged when it is made: a link on the way, planted since the start, is not followed.
#[derive(Clone, Copy, Debug, Default)]
pub struct SystemDisk;

impl Disk for SystemDisk {
    fn create_folder(&self, path: &Path) -> io::Result<()> {
        on_its_way(path)?;
        fs::create_dir(path)
    }

    fn create_folders(&self, path: &Path) -> io::Result<()> {
        on_its_way(&path.join("new"))?;
        fs::create_dir_all(path)
    }

    fn write_new(&self, path: &Path, bytes: &[u8]) -> io::Result<()> {
        on_its_way(path)?;
        File::options().write(true).create_new(true).open(path)?.write_all(bytes)
    }

    fn append(&self, path: &Path, bytes: &[u8], is_durable: bool) -> io::Result<()> {
        let mut file = open_own(path, File::options().append(true).create(true))?;
        file.write_all(bytes)?;
        if is_durable { file.sync_data() } else { Ok(()) }
    }

    fn sync(&self, path: &Path) -> io::Result<()> {
        on_its_way(path)?;
        let meta = fs::symlink_metadata(path)?;
        if meta.is_dir() {
            return sync_folder(path);
        }
        // Windows flushes only through handles that may write.
        open_own(path, File::options().read(true).write(true))?.sync_all()
    }

    fn rename(&self, from: &Path, to: &Path) -> io::Result<()> {
        both_on_their_way(from, to)?;
        fs::rename(from, to)
    }

    fn rename_new(&self, from: &Path, to: &Path) -> io::Result<()> {
        both_on_their_way(from, to)?;
        match rename_no_replace(from, to) {
            Err(e) if e.kind() == io::ErrorKind::Unsupported => rename_carefully(from, to),
            other => other,
        }
    }

    fn exchange(&self, a: &Path, b: &Path) -> io::Result<()> {
        both_on_their_way(a, b)?;
        exchange(a, b)
    }

    fn remove_folder(&self, path: &Path) -> io::Result<()> {
        on_its_way(path)?;
        fs::remove_dir_all(path)
    }

    fn remove_file(&self, path: &Path) -> io::Result<()> {
        on_its_way(path)?;
        fs::remove_file(path)
    }

    fn free_bytes(&self, path: &Path) -> io::Result<u64> {
        fs4::available_space(path)
    }
}

fn both_on_their_way(from: &Path, to: &Path) -> io::Result<()> {
    on_its_way(from)?;
    on_its_way(to)
}

/// For file systems without the system call: a file gets its new name as a second link, which fails
/// when the name is taken; a folder is renamed only onto nothing (or an empty folder).
fn rename_carefully(from: &Path, to: &Path) -> io::Result<()> {
    if fs::symlink_metadata(from)?.is_dir() {
        if fs::symlink_metadata(to).is_ok() {
            return Err(io::ErrorKind::AlreadyExists.into());
        }
        return fs::rename(from, to);
    }
    fs::hard_link(from, to)?;
    fs::remove_file(from)
}

#[cfg(unix)]
fn sync_folder(path: &Path) -> io::Result<()> {
    File::open(path)?.sync_all()
}

/// Other systems have no such call and keep names durable themselves.
#[cfg(not(unix))]
fn sync_folder(_: &Path) -> io::Result<()> {
    Ok(())
}

#[cfg(any(target_os = "linux", target_os = "macos"))]
fn rename_no_replace(from: &Path, to: &Path) -> io::Result<()> {
    rename_with(from, to, rustix::fs::RenameFlags::NOREPLACE)
}

#[cfg(any(target_os = "linux", target_os = "macos"))]
fn exchange(a: &Path, b: &Path) -> io::Result<()> {
    rename_with(a, b, rustix::fs::RenameFlags::EXCHANGE)
}

#[cfg(any(target_os = "linux", target_os = "macos"))]
fn rename_with(from: &Path, to: &Path, flags: rustix::fs::RenameFlags) -> io::Result<()> {
    use rustix::io::Errno;
    rustix::fs::renameat_with(rustix::fs::CWD, from, rustix::fs::CWD, to, flags).map_err(|e| match e {
        Errno::INVAL | Errno::NOSYS | Errno::NOTSUP => io::ErrorKind::Unsupported.into(),
        other => other.into(),
    })
}

#[cfg(not(any(target_os = "linux", target_os = "macos")))]
fn rename_no_replace(_: &Path, _: &Path) -> io::Result<()> {
    Err(io::ErrorKind::Unsupported.into())
}

#[cfg(not(any(target_os = "linux", target_os = "macos")))]
fn exchange(_: &Path, _: &Path) -> io::Result<()> {
    Err(io::ErrorKind::Unsupported.into())
}

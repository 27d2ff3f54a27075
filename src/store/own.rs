//! Files of ours in folders that others may write to: somebody may have planted a link, a pipe or a device in their place,
//! also while the program runs. Such a thing is never opened through, waited for or read without end.

use std::fmt;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Read as _, Write as _};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use super::{OUTPUT_IS_LINK, shown};
use enfilade_report::Error;

/// More than this is no file of ours.
pub(super) const OWN_BYTES_MAX: u64 = 1 << 30;
/// How long whoever reads a pipe may take to come.
const READER_TIME: Duration = Duration::from_secs(5);
/// Pause between two looks for that reader.
const LOOK_PAUSE: Duration = Duration::from_millis(20);

/// What lies in the place of a file of ours.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Planted {
    /// It leads elsewhere.
    Link,
    /// It lies behind this link.
    Behind(PathBuf),
    /// A pipe or a device.
    Special,
    /// A pipe that nobody reads, where the user wants one to be written into.
    Unread,
    /// More bytes than a file of ours ever has.
    Large(u64),
}

impl Planted {
    /// Code of the problem.
    pub fn code(&self) -> &'static str {
        match self {
            Self::Link | Self::Behind(_) => OUTPUT_IS_LINK,
            Self::Special | Self::Unread => "output-is-special",
            Self::Large(_) => "output-too-large",
        }
    }
}

impl fmt::Display for Planted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Link => {
                f.write_str("is a link; results are never written or read through links: remove it")
            }
            Self::Behind(link) => write!(
                f,
                "lies behind the link {}, which was not there at the start; results are never written or read \
                 through links: remove it, or start again if it is yours",
                link.display()
            ),
            Self::Special => f.write_str(
                "is a pipe or a device in the place of a file of ours, and was not opened: remove it",
            ),
            Self::Unread => f.write_str("is a pipe without a reader: start its reader first, or name a file"),
            Self::Large(bytes) => write!(
                f,
                "has {} MB, a file of ours at most {} MB, and was not read: move it away",
                bytes >> 20,
                OWN_BYTES_MAX >> 20
            ),
        }
    }
}

impl std::error::Error for Planted {}

impl From<Planted> for io::Error {
    fn from(planted: Planted) -> Self {
        Self::new(io::ErrorKind::InvalidInput, planted)
    }
}

/// What an error says of a planted thing, if it is of one.
pub(super) fn planted_of(error: &io::Error) -> Option<Planted> {
    error.get_ref().and_then(|e| e.downcast_ref()).cloned()
}

/// Refuses a path that a link on its way leads elsewhere. What the user names is resolved once, by [`led_to`]; a link
/// that is met later was planted.
///
/// # Errors
/// [`Planted::Behind`].
pub(super) fn on_its_way(path: &Path) -> io::Result<()> {
    first_link(path).map_or(Ok(()), |link| Err(Planted::Behind(link).into()))
}

/// The first link on the way to a path. In the system's topmost folder only the system makes links.
fn first_link(path: &Path) -> Option<PathBuf> {
    let is_link = |at: &&Path| fs::symlink_metadata(at).is_ok_and(|m| m.is_symlink());
    let is_of_system = |at: &Path| cfg!(unix) && at.parent() == Some(Path::new("/"));
    path.ancestors().skip(1).filter(|at| !is_of_system(at)).filter(is_link).last().map(Path::to_path_buf)
}

/// Where a folder that the user names lies at this moment, its links followed; where there are none, as it is named.
/// From then on, nothing is written behind a link of that way.
pub fn led_to(folder: &Path) -> PathBuf {
    let is_led = first_link(folder).is_some() || fs::symlink_metadata(folder).is_ok_and(|m| m.is_symlink());
    if !is_led {
        return folder.into();
    }
    let real = |at: &Path| {
        let rest = folder.strip_prefix(at).ok().filter(|rest| !rest.as_os_str().is_empty());
        fs::canonicalize(at).ok().map(|to| rest.map_or(to.clone(), |rest| to.join(rest)))
    };
    folder.ancestors().find_map(real).unwrap_or_else(|| folder.into())
}

/// As [`led_to`] of a file: its folder's links are followed, the file itself stays as it is named.
pub fn led_beside(file: &Path) -> PathBuf {
    match (file.parent(), file.file_name()) {
        (Some(folder), Some(name)) => led_to(folder).join(name),
        _ => file.into(),
    }
}

/// What lies there in the place of a file of ours; `None`: a file, a folder or nothing.
fn planted(path: &Path) -> Option<Planted> {
    let kind = fs::symlink_metadata(path).ok()?.file_type();
    if kind.is_symlink() {
        return Some(Planted::Link);
    }
    (!kind.is_file() && !kind.is_dir()).then_some(Planted::Special)
}

/// Refuses a link: whatever is written there would be written elsewhere.
///
/// # Errors
/// `output-is-link`.
pub(super) fn refuse_link(path: &Path) -> Result<(), Error> {
    let behind = first_link(path).map(Planted::Behind);
    refuse(path, behind.or_else(|| planted(path).filter(|p| *p == Planted::Link)))
}

/// As [`refuse_link`], for files that are ours alone: whoever opens a pipe waits for its other end.
///
/// # Errors
/// `output-is-link`, `output-is-special`.
pub(super) fn refuse_planted(path: &Path) -> Result<(), Error> {
    refuse_link(path)?;
    refuse(path, planted(path))
}

fn refuse(path: &Path, planted: Option<Planted>) -> Result<(), Error> {
    planted.map_or(Ok(()), |p| Err(Error::environment(p.code(), shown(path), p.to_string())))
}

/// Opens a file of ours, or makes it as `options` say: one that was planted a moment ago is not opened either.
///
/// # Errors
/// The system's; a [`Planted`] for what is no file.
pub(super) fn open_own(path: &Path, options: &mut OpenOptions) -> io::Result<File> {
    on_its_way(path)?;
    if let Some(planted) = planted(path) {
        return Err(planted.into());
    }
    at_once(options, true);
    // Links and pipes without a reader are errors of the system by now.
    let file = options.open(path).map_err(|e| planted(path).map_or(e, io::Error::from))?;
    let kind = file.metadata()?.file_type();
    if kind.is_file() || kind.is_dir() { Ok(file) } else { Err(Planted::Special.into()) }
}

/// Opening waits for nobody, and follows no link where it is asked so.
#[cfg(unix)]
fn at_once(options: &mut OpenOptions, no_link: bool) {
    use rustix::fs::OFlags;
    use std::os::unix::fs::OpenOptionsExt as _;
    let flags = if no_link { OFlags::NONBLOCK | OFlags::NOFOLLOW } else { OFlags::NONBLOCK };
    options.custom_flags(flags.bits() as i32);
}

#[cfg(not(unix))]
fn at_once(_: &mut OpenOptions, _: bool) {}

/// Opens a file of ours for reading.
///
/// # Errors
/// The system's; `InvalidInput` for a link, a pipe or a device.
pub fn open_to_read(path: &Path) -> io::Result<File> {
    open_own(path, File::options().read(true))
}

/// Reads a file of ours; anything else of its name, as a planted link or pipe, is neither followed nor waited for.
///
/// # Errors
/// The system's; `InvalidInput` for what is no file of ours.
pub fn read_own(path: &Path) -> io::Result<Vec<u8>> {
    whole(open_to_read(path)?)
}

/// As [`read_own`] of a file that the user names: whoever names a link means what it leads to.
///
/// # Errors
/// As [`read_own`].
pub fn read_named(path: &Path) -> io::Result<Vec<u8>> {
    read_own(&fs::canonicalize(path)?)
}

fn whole(file: File) -> io::Result<Vec<u8>> {
    let size = file.metadata()?.len();
    if size > OWN_BYTES_MAX {
        return Err(Planted::Large(size).into());
    }
    let mut bytes = Vec::with_capacity(usize::try_from(size).unwrap_or_default());
    file.take(OWN_BYTES_MAX).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Writes into a pipe or a device that the user named; a pipe's reader is waited for, but not for ever.
///
/// # Errors
/// The system's; a [`Planted`] for a pipe that nobody reads.
pub(super) fn write_into(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut options = File::options();
    at_once(options.write(true), false);
    let since = Instant::now();
    let mut file = loop {
        match options.open(path) {
            Err(e) if is_unread(&e) && since.elapsed() < READER_TIME => std::thread::sleep(LOOK_PAUSE),
            Err(e) if is_unread(&e) => return Err(Planted::Unread.into()),
            other => break other?,
        }
    };
    waits_again(&file)?;
    file.write_all(bytes)
}

#[cfg(unix)]
fn is_unread(error: &io::Error) -> bool {
    error.raw_os_error() == Some(rustix::io::Errno::NXIO.raw_os_error())
}

#[cfg(not(unix))]
fn is_unread(_: &io::Error) -> bool {
    false
}

/// Writing may wait for a slow reader.
#[cfg(unix)]
fn waits_again(file: &File) -> io::Result<()> {
    use rustix::fs::{OFlags, fcntl_getfl, fcntl_setfl};
    Ok(fcntl_setfl(file, fcntl_getfl(file)? - OFlags::NONBLOCK)?)
}

#[cfg(not(unix))]
fn waits_again(_: &File) -> io::Result<()> {
    Ok(())
}

#[cfg(unix)]
#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::{Disk as _, SystemDisk, disk_error, replace_file};

    fn pipe(path: &Path) {
        assert!(std::process::Command::new("mkfifo").arg(path).status().unwrap().success());
    }

    /// Whatever lies in the place of a file of ours, what is behind it stays, nobody waits, and the words help.
    #[test]
    fn nothing_is_opened_through_what_was_planted() {
        let dir = tempfile::tempdir().unwrap();
        let [drawing, link, dangling, fifo, large] =
            ["plan.dxf", "link", "dangling", "fifo", "large"].map(|name| dir.path().join(name));
        fs::write(&drawing, "a drawing").unwrap();
        std::os::unix::fs::symlink(&drawing, &link).unwrap();
        std::os::unix::fs::symlink(dir.path().join("new"), &dangling).unwrap();
        pipe(&fifo);
        File::create(&large).unwrap().set_len(3 << 30).unwrap();
        let said = |path: &Path, error: io::Error| disk_error("reading", path, &error).to_string();
        for (path, word) in [(&link, "is a link"), (&dangling, "is a link"), (&fifo, "is a pipe")] {
            let read = said(path, read_own(path).unwrap_err());
            let added = said(path, SystemDisk.append(path, b"line\n", true).unwrap_err());
            let synced = said(path, SystemDisk.sync(path).unwrap_err());
            for text in [read, added, synced] {
                assert!(text.contains(word) && text.contains("remove it"), "{text}");
                assert!(!text.contains("look at the disk"), "{text}");
            }
        }
        let text = said(&large, read_own(&large).unwrap_err());
        assert!(text.contains("3072 MB") && text.contains("move it away"), "{text}");
        assert_eq!(fs::read(&drawing).unwrap(), b"a drawing");
        assert!(!dir.path().join("new").exists());
        assert_eq!(read_named(&link).unwrap(), b"a drawing");
    }

    /// No change of the disk is made behind a link on the way, whatever it is; where the user names one, it is
    /// followed once.
    #[test]
    fn nothing_changes_behind_a_link_on_the_way() {
        let dir = tempfile::tempdir().unwrap();
        let at = |name: &str| fs::canonicalize(dir.path()).unwrap().join(name);
        fs::create_dir_all(at("elsewhere/old")).unwrap();
        fs::write(at("elsewhere/file"), "theirs").unwrap();
        fs::write(at("mine"), "mine").unwrap();
        std::os::unix::fs::symlink(at("elsewhere"), at("link")).unwrap();
        std::os::unix::fs::symlink(at("nowhere"), at("dangling")).unwrap();
        let (to, disk) = (|name: &str| at("link").join(name), SystemDisk);
        let tried: [(&str, io::Result<()>); 13] = [
            ("create_folder", disk.create_folder(&to("new"))),
            ("create_folders", disk.create_folders(&to("new/deep"))),
            ("create_folders of a link", disk.create_folders(&at("link"))),
            ("write_new", disk.write_new(&to("new"), b"x")),
            ("append", disk.append(&to("file"), b"x", true)),
            ("sync", disk.sync(&to("file"))),
            ("rename", disk.rename(&at("mine"), &to("file"))),
            ("rename from", disk.rename(&to("file"), &at("got"))),
            ("rename_new", disk.rename_new(&at("mine"), &to("new"))),
            ("exchange", disk.exchange(&at("mine"), &to("file"))),
            ("remove_folder", disk.remove_folder(&to("old"))),
            ("remove_file", disk.remove_file(&to("file"))),
            ("read", read_own(&to("file")).map(drop)),
        ];
        for (what, outcome) in tried {
            let Err(error) = outcome else { panic!("{what} was done") };
            let said = disk_error("writing", &to("file"), &error).to_string();
            assert!(said.contains("behind the link") && said.contains("remove it"), "{what}: {said}");
        }
        assert_eq!(fs::read(at("elsewhere/file")).unwrap(), b"theirs");
        assert_eq!(fs::read_dir(at("elsewhere")).unwrap().count(), 2);
        assert!(replace_file(&disk, &to("new"), b"x").is_err());
        for (named, real) in [
            (at("link"), at("elsewhere")),
            (to("a/b"), at("elsewhere/a/b")),
            (at("new/deep"), at("new/deep")),
            (at("dangling/a"), at("dangling/a")),
        ] {
            assert_eq!(led_to(&named), real);
        }
        assert_eq!(led_beside(&to("plan.dxf")), at("elsewhere/plan.dxf"));
        assert_eq!(led_beside(Path::new("plan.dxf")), Path::new("plan.dxf"));
        assert!(replace_file(&disk, &led_beside(&to("new")), b"x").is_ok());
    }

    /// A pipe that the user named and nobody reads is an error, and never waited for.
    #[test]
    fn a_pipe_without_a_reader_is_told() {
        let dir = tempfile::tempdir().unwrap();
        let fifo = dir.path().join("fifo");
        pipe(&fifo);
        let error = replace_file(&SystemDisk, &fifo, b"table").unwrap_err();
        assert!(error.to_string().contains("without a reader"), "{error}");
        assert_eq!(error.exit_code(), 4);
    }
}

//! `open`, `service`, `doctor`, `completions`, `man`: what surrounds the work.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use crate::cli::{self, InstallArgs, OpenArgs, ServiceArgs, ServiceCommand, ShellArg};
use crate::output::{print, say};
use crate::server::Door;
use crate::service::{self, Folders};
use crate::store::{Disk, SystemDisk};
use crate::watch::{canonical_roots, network_reason};
use enfilade_cad::ENDINGS;
use enfilade_engine::gpu::Gpu;
use enfilade_report::{Error, Place};

/// What opens an address in the user's browser, and its first arguments.
const BROWSER: (&str, &[&str]) = if cfg!(windows) {
    ("rundll32", &["url.dll,FileProtocolHandler"])
} else if cfg!(target_os = "macos") {
    ("open", &[])
} else {
    ("xdg-open", &[])
};
/// Less than this and results of a drawing of usual size find no room.
const FREE_BYTES_MIN: u64 = 50 << 20;
/// Fewer watches than this and a tree of drawings may not fit.
const WATCHES_MIN: u64 = 8192;

pub(super) fn open(args: &OpenArgs) -> Result<u8, Error> {
    if !args.folder.is_dir() {
        let text = "found no folder there, expected one that is watched; nothing was done";
        return Err(Error::usage("no-folder", Place::file(args.folder.display().to_string()), text));
    }
    let Some(door) = Door::find(&args.folder) else {
        let text = "no page of a daemon here; `enfilade watch --page DIR` opens one";
        return Err(Error::usage("no-page", Place::file(args.folder.display().to_string()), text));
    };
    if args.print {
        say(&door.link()?);
        return Ok(0);
    }
    let (program, first) = BROWSER;
    let started = Command::new(program)
        .args(first)
        .arg(door.write_opener()?)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status();
    if !started.is_ok_and(|s| s.success()) {
        let text = format!("no browser could be started by {program}; --print says the address");
        return Err(Error::environment("browser", Place::default(), text));
    }
    say(&format!("{} (a browser that shows nothing: --print says the address)", door.address));
    Ok(0)
}

pub(super) fn service(args: &ServiceArgs) -> Result<u8, Error> {
    let said = match &args.what {
        ServiceCommand::Install(args) => {
            let folders: Vec<PathBuf> = args.looking.folders.iter().map(|f| super::absolute(f)).collect();
            if let Some(missing) = folders.iter().find(|f| !f.is_dir()) {
                let place = Place::file(missing.display().to_string());
                return Err(Error::usage("not-a-folder", place, "is no folder; nothing was installed"));
            }
            canonical_roots(&folders, args.looking.force)?;
            service::install(&folders, &options_of(args))?
        }
        ServiceCommand::Status => service::status()?,
        ServiceCommand::Uninstall => service::uninstall()?,
    };
    say(&said);
    Ok(0)
}

/// The options of `watch` that the service is started with.
fn options_of(args: &InstallArgs) -> Vec<OsString> {
    let mut out: Vec<OsString> = Vec::new();
    let mut add = |name: &str, value: OsString| out.extend([name.into(), value]);
    args.looking.depth.iter().for_each(|levels| add("--depth", levels.to_string().into()));
    args.looking.ignore.iter().for_each(|glob| add("--ignore", glob.into()));
    args.out.iter().for_each(|folder| add("--out", super::absolute(folder).into()));
    let fallback = args.looking.fallback.iter();
    fallback.for_each(|folder| add("--fallback", super::absolute(folder).into()));
    let flags = [(args.looking.poll, "--poll"), (args.looking.force, "--force")];
    out.extend(flags.into_iter().filter(|(is_set, _)| *is_set).map(|(_, flag)| flag.into()));
    out
}

pub(super) fn doctor(folders: &[PathBuf]) -> Result<u8, Error> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    say(&format!("enfilade {}", enfilade_config::VERSION));
    say(&format!("cores: {cores}"));
    say(&format!("graphics card: {}", card_apart()));
    let mut is_well = true;
    let mut judge = |what: &str, verdict: Result<String, String>| match verdict {
        Ok(text) => say(&format!("{what}: {text}")),
        Err(remedy) => {
            is_well = false;
            say(&format!("{what}: PROBLEM: {remedy}"));
        }
    };
    judge("folders of the program", own_folders());
    judge(
        "file watches",
        watches(std::fs::read_to_string("/proc/sys/fs/inotify/max_user_watches").ok().as_deref()),
    );
    judge("user", user(is_root()));
    let state = service::status().unwrap_or_else(|e| e.to_string());
    judge("service", Ok(state));
    for folder in folders {
        judge(&folder.display().to_string(), watched(folder));
    }
    Ok(u8::from(!is_well))
}

/// What `doctor` asks of itself: the answer alone.
pub(super) fn card_alone() -> Result<u8, Error> {
    say(&card());
    Ok(0)
}

/// [`card`], asked in a process of its own: what a driver prints is no answer of ours, and one that crashes takes
/// nothing along.
fn card_apart() -> String {
    let ask = |program: PathBuf| {
        Command::new(program).args(["doctor", "--card"]).stdin(Stdio::null()).stderr(Stdio::null()).output()
    };
    match std::env::current_exe().and_then(ask) {
        Ok(answer) if answer.status.success() => String::from_utf8_lossy(&answer.stdout).trim().to_owned(),
        Ok(answer) => {
            format!("none that can be used: its driver ended badly ({}); the cores measure", answer.status)
        }
        Err(_) => card(),
    }
}

/// What `--backend auto` and `gpu` find.
fn card() -> String {
    match Gpu::shared(true) {
        Ok(gpu) if gpu.is_software() => {
            format!("none; {} imitates one, and is used with --backend gpu alone", gpu.name())
        }
        Ok(gpu) => format!("{}; used where it is faster than the cores", gpu.name()),
        Err(why) => format!("none that can be used: {why}; the cores measure"),
    }
}

fn own_folders() -> Result<String, String> {
    let f = Folders::of_user().map_err(|e| e.to_string())?;
    let shown = [("settings", &f.config), ("cache", &f.cache), ("state and logs", &f.state)];
    Ok(shown.map(|(what, path)| format!("{what} {}", path.display())).join(", "))
}

fn watches(limit: Option<&str>) -> Result<String, String> {
    match limit.and_then(|t| t.trim().parse::<u64>().ok()) {
        Some(n) if n < WATCHES_MIN => Err(format!(
            "the system allows {n}; folders beyond that are polled; raise fs.inotify.max_user_watches to {WATCHES_MIN}"
        )),
        Some(n) => Ok(format!("{n} allowed")),
        None => Ok("no limit known".into()),
    }
}

fn user(is_root: bool) -> Result<String, String> {
    if is_root {
        return Err("this is root; run the daemon as the user whose drawings it watches".into());
    }
    Ok("not root".into())
}

#[cfg(unix)]
fn is_root() -> bool {
    rustix::process::geteuid().is_root()
}

#[cfg(not(unix))]
fn is_root() -> bool {
    false
}

fn watched(folder: &Path) -> Result<String, String> {
    let meta = std::fs::metadata(folder).map_err(|e| format!("{e}; it is watched once it is there"))?;
    if !meta.is_dir() {
        return Err("is no folder; name the folder of the drawings".into());
    }
    let records = Folders::of_user().ok().map(|own| own.state);
    let found = crate::daemon::status(&[folder.to_path_buf()], records.as_deref());
    let is_running = found[0]["is_running"] == true;
    // A daemon that keeps its state elsewhere was told where results go.
    let elsewhere = super::watching::elsewhere(&found[0], folder).filter(|_| is_running);
    let unwritable = unwritable(folder).filter(|_| elsewhere.is_none());
    let faults: Vec<String> = unwritable.into_iter().chain(unreadable(folder)).collect();
    if !faults.is_empty() {
        return Err(faults.join("; "));
    }
    let runs = if is_running { "watched now" } else { "not watched now" };
    let how = network_reason(folder).map_or("events".to_owned(), |why| format!("polling, as {why}"));
    let page = if Door::find(folder).is_some() { "; its page is open" } else { "" };
    let state = elsewhere.map_or_else(String::new, |state| format!("; its state lies in {state}"));
    let said = format!("{runs}; watched by {how}{state}{page}");
    match failing(&found[0]["status"]).into_iter().chain(full(folder)).reduce(|a, b| format!("{a}; {b}")) {
        Some(faults) => Err(format!("{said}; {faults}")),
        None => Ok(said),
    }
}

/// How many drawings failed, and the first of them with its reason.
fn failing(overview: &serde_json::Value) -> Option<String> {
    let count = overview["failed_count"].as_u64().filter(|n| *n > 0)?;
    let first = overview["failed"].as_array().and_then(|all| all.first());
    let text = |key: &str| first.and_then(|f| f[key].as_str()).unwrap_or("?").to_owned();
    let why = first.and_then(|f| f["problem"]["text"].as_str()).unwrap_or("?");
    Some(format!("{count} failed, {}: {why}; `enfilade status` lists all", text("drawing")))
}

/// Whether the disk leaves a round too little.
fn full(folder: &Path) -> Option<String> {
    let free = SystemDisk.free_bytes(folder).ok().filter(|free| *free < FREE_BYTES_MIN)?;
    Some(format!("{} MB are free there, too few for results: make room", free >> 20))
}

/// Results lie beside the drawings, unless the settings name another folder for them.
fn unwritable(folder: &Path) -> Option<String> {
    let settings = super::read_settings(&folder.join("enfilade.toml")).ok().flatten();
    let names_a_place = |s: &enfilade_config::Partial| {
        s.out.is_some() || s.watch.as_ref().is_some_and(|w| w.fallback.is_some())
    };
    if may_write(folder) || settings.is_some_and(|s| names_a_place(&s)) {
        return None;
    }
    Some("cannot be written, so results find no place: allow it to the user of the daemon, or name another folder with --out or --fallback".into())
}

#[cfg(unix)]
fn may_write(folder: &Path) -> bool {
    use rustix::fs::{Access, access};
    access(folder, Access::WRITE_OK | Access::EXEC_OK).is_ok()
}

#[cfg(not(unix))]
fn may_write(folder: &Path) -> bool {
    std::fs::metadata(folder).is_ok_and(|m| !m.permissions().readonly())
}

/// What cannot be read: the folder, or the first of its drawings and how many others.
fn unreadable(folder: &Path) -> Option<String> {
    let entries = match std::fs::read_dir(folder) {
        Ok(entries) => entries.flatten(),
        Err(e) => return Some(format!("cannot be looked into ({e}): allow it to the user of the daemon")),
    };
    let files = entries.filter(|e| e.file_type().is_ok_and(|t| t.is_file())).map(|e| e.path());
    let is_drawing = |p: &PathBuf| {
        p.extension().is_some_and(|e| ENDINGS.iter().any(|known| e.eq_ignore_ascii_case(known)))
    };
    let mut closed: Vec<(PathBuf, std::io::Error)> =
        files.filter(is_drawing).filter_map(|p| std::fs::File::open(&p).err().map(|e| (p, e))).collect();
    closed.sort_by(|a, b| a.0.cmp(&b.0));
    let (first, why) = closed.first()?;
    let name = first.file_name().unwrap_or_default().to_string_lossy();
    let others = if closed.len() > 1 { format!(" and {} more", closed.len() - 1) } else { String::new() };
    Some(format!("{name}{others} cannot be read ({why}): allow reading to the user of the daemon"))
}

pub(super) fn completions(shell: ShellArg) -> Result<u8, Error> {
    print(&cli::completions(shell));
    Ok(0)
}

pub(super) fn man() -> Result<u8, Error> {
    let page = cli::man().map_err(|e| Error::environment("man", Place::default(), e.to_string()))?;
    print(&page);
    Ok(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(unix)]
    #[test]
    fn what_may_not_be_written_or_read_is_a_problem_with_a_remedy() {
        use std::fs::{Permissions, set_permissions, write};
        use std::os::unix::fs::PermissionsExt as _;
        let dir = tempfile::tempdir().unwrap();
        let drawing = dir.path().join("plan.DXF");
        write(&drawing, "0\nEOF\n").unwrap();
        assert!(watched(dir.path()).is_ok());
        let gone = unreadable(&dir.path().join("gone")).unwrap();
        assert!(gone.contains("allow"), "{gone}");
        set_permissions(&drawing, Permissions::from_mode(0o000)).unwrap();
        set_permissions(dir.path(), Permissions::from_mode(0o555)).unwrap();
        if rustix::process::geteuid().is_root() {
            println!("skipped: root may read and write everything");
            return;
        }
        let said = watched(dir.path()).unwrap_err();
        assert!(said.contains("--out") && said.contains("plan.DXF cannot be read"), "{said}");
        set_permissions(dir.path(), Permissions::from_mode(0o755)).unwrap();
    }

    /// What is asked of the service is what `watch` takes.
    #[test]
    fn the_service_watches_as_it_was_told() {
        use clap::Parser as _;
        let line = [
            "enfilade",
            "service",
            "install",
            "--depth",
            "2",
            "--ignore",
            "x*",
            "--out",
            "/r",
            "--fallback",
            "/f",
            "--poll",
            "--force",
            "/w",
        ];
        let cli::Command::Service(ServiceArgs { what: ServiceCommand::Install(args) }) =
            cli::Cli::try_parse_from(line).unwrap().command
        else {
            panic!("no install")
        };
        let options = options_of(&args);
        let expected =
            ["--depth", "2", "--ignore", "x*", "--out", "/r", "--fallback", "/f", "--poll", "--force"];
        assert_eq!(options, expected.map(OsString::from));
        let words = ["enfilade", "watch"].map(OsString::from).into_iter().chain(options);
        let cli::Command::Watch(watch) =
            cli::Cli::try_parse_from(words.chain(["--".into(), "/w".into()])).unwrap().command
        else {
            panic!("no watch")
        };
        let looking = watch.looking;
        assert_eq!((looking.depth, looking.ignore), (Some(2), vec!["x*".to_owned()]));
        assert!(looking.poll && looking.force);
        assert_eq!((watch.common.out, looking.fallback), (Some("/r".into()), Some("/f".into())));
    }

    #[test]
    fn failures_of_the_daemon_are_a_problem() {
        let overview = serde_json::json!({
            "failed_count": 2,
            "failed": [{"drawing": "plan.dxf", "problem": {"text": "no room"}}],
        });
        assert_eq!(failing(&overview).unwrap(), "2 failed, plan.dxf: no room; `enfilade status` lists all");
        assert_eq!(failing(&serde_json::json!({"failed_count": 0, "failed": []})), None);
        assert_eq!(failing(&serde_json::Value::Null), None);
    }

    #[test]
    fn root_is_a_problem() {
        assert!(user(true).unwrap_err().contains("as the user"));
        assert!(user(false).is_ok());
    }

    #[test]
    fn few_watches_are_a_problem_with_a_remedy() {
        assert!(watches(Some("8192\n")).is_ok());
        assert!(watches(None).is_ok());
        assert!(watches(Some("100")).unwrap_err().contains("max_user_watches"));
    }
}

//! The daemon as a service of the user's own: installed, asked for, taken away; and the folders it uses.
//!
//! systemd and launchd through `service-manager`, at the level of the user, never of the system; on Windows a
//! task at logon, as a Windows service would run as another user and not see the user's drives.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Stdio;

use directories::ProjectDirs;
use service_manager::{
    RestartPolicy, ServiceInstallCtx, ServiceLabel, ServiceLevel, ServiceManager, ServiceStartCtx,
    ServiceStatus, ServiceStatusCtx, ServiceStopCtx, ServiceUninstallCtx, TypedServiceManager,
};

use crate::store::{Disk as _, SystemDisk, led_to};
use enfilade_report::{Error, Place};

/// Name of the service.
const NAME: &str = "enfilade";
/// What [`status`] says where there is none.
const NOT_INSTALLED: &str = "not installed";
/// Takes a unit in that lies there already, and starts it.
const LATER: &str = "systemctl --user daemon-reload && systemctl --user enable --now enfilade";
/// Pause before a daemon that ended badly is started again.
const RESTART_SECS: u32 = 10;

/// Where the system expects a program's own files.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Folders {
    /// Settings.
    pub config: PathBuf,
    /// What may be deleted at any time.
    pub cache: PathBuf,
    /// What outlives a start: where pages are found, logs.
    pub state: PathBuf,
}

impl Folders {
    /// Those of the user who runs this.
    ///
    /// # Errors
    /// [`Error::Environment`] where the user has no home folder.
    pub fn of_user() -> Result<Self, Error> {
        let dirs = ProjectDirs::from("", "", NAME).ok_or_else(|| failed("no home folder; set HOME"))?;
        Ok(Self {
            config: dirs.config_dir().into(),
            cache: dirs.cache_dir().into(),
            state: led_to(dirs.state_dir().unwrap_or(dirs.data_local_dir())),
        })
    }

    /// The daemon's log, when it runs as a service.
    pub fn log(&self) -> PathBuf {
        self.state.join("watch.log")
    }
}

/// Installs the daemon for these folders, with these options of `watch`, and starts it. Says what was done.
///
/// # Errors
/// [`Error::Environment`] where the system has no service manager, or it refuses; it says what lies there since.
pub fn install(folders: &[PathBuf], options: &[OsString]) -> Result<String, Error> {
    let program = std::env::current_exe().map_err(|e| failed(&e.to_string()))?;
    let args = arguments(folders, options, &Folders::of_user()?.log());
    if cfg!(windows) {
        return call("schtasks", &windows_task(&program, &args)).map(|()| "a task at logon was made".into());
    }
    let before = unit_of_user().and_then(|file| std::fs::read_to_string(file).ok());
    let instead = before.map_or_else(String::new, |unit| instead_of(&unit));
    let (manager, label) = manager()?;
    let contents = cfg!(target_os = "linux").then(|| systemd_unit(&program, &args));
    let restart_policy = RestartPolicy::OnFailure {
        delay_secs: Some(RESTART_SECS),
        max_retries: None,
        reset_after_secs: None,
    };
    manager
        .install(ServiceInstallCtx {
            label: label.clone(),
            program,
            args,
            contents: contents.clone(),
            username: None,
            working_directory: None,
            environment: None,
            autostart: true,
            restart_policy,
        })
        .map_err(|e| not_installed(&one_line_of(&e), contents.as_deref(), &instead))?;
    manager.start(ServiceStartCtx { label }).map_err(|e| not_started(&one_line_of(&e), &instead))?;
    Ok(format!("the service is installed and started{instead}; it starts again with your session"))
}

/// What a refusal left behind: the unit may lie there although nobody took it in.
fn not_installed(why: &str, unit: Option<&str>, instead: &str) -> Error {
    let Some(file) = unit_of_user() else { return failed(why) };
    let is_written = unit.is_some() && std::fs::read_to_string(&file).ok().as_deref() == unit;
    if !is_written {
        return failed(&format!("{}: {why}; nothing was written or installed", file.display()));
    }
    half_done(&file, instead, "neither made to start with your sessions nor started", why)
}

/// The unit lies there and is taken in, and the service manager did not start it.
fn not_started(why: &str, instead: &str) -> Error {
    match unit_of_user() {
        Some(file) => half_done(&file, instead, "not started; it starts with your next session", why),
        None => failed(&format!(
            "installed{instead}; it starts with your next session, but was not started now: {why}"
        )),
    }
}

/// What was done, what was not and why, and how to do it later.
fn half_done(file: &Path, instead: &str, undone: &str, why: &str) -> Error {
    failed(&format!(
        "the service's unit is written to {}{instead}, but the service is {undone}: the service manager says \"{why}\". \
         Nothing watches now. When it can be reached: `{LATER}`. `enfilade service uninstall` takes the unit away",
        file.display()
    ))
}

/// The words of an error in one line.
fn one_line_of(error: &std::io::Error) -> String {
    error.to_string().split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Says which folders the service watched until now, by its unit.
fn instead_of(unit: &str) -> String {
    let line = unit.lines().find_map(|l| l.strip_prefix("ExecStart=")).unwrap_or_default();
    match line.split_once(" \"--\" ") {
        Some((_, folders)) => format!(" in place of the one that watched {folders}"),
        None => " in place of an earlier one".into(),
    }
}

/// Whether it is installed and runs, in words.
///
/// # Errors
/// As [`install`]; on Linux only where there is no home folder.
pub fn status() -> Result<String, Error> {
    if cfg!(windows) {
        let is_there = call("schtasks", &["/Query", "/TN", NAME].map(OsString::from)).is_ok();
        return Ok(if is_there { "installed" } else { NOT_INSTALLED }.into());
    }
    let asked = manager().and_then(|(manager, label)| {
        manager.status(ServiceStatusCtx { label }).map_err(|e| failed(&one_line_of(&e)))
    });
    match asked {
        Ok(ServiceStatus::NotInstalled) => Ok(NOT_INSTALLED.into()),
        Ok(ServiceStatus::Running) => Ok("running".into()),
        Ok(ServiceStatus::Stopped(why)) => {
            Ok(format!("installed, stopped {}", why.unwrap_or_default()).trim().into())
        }
        // Nobody can be asked: what lies there can be said all the same.
        Err(_) if cfg!(target_os = "linux") => Ok(without_manager(is_installed()?)),
        Err(e) => Err(e),
    }
}

fn without_manager(is_installed: bool) -> String {
    let state = if is_installed { "installed, but nothing starts it" } else { NOT_INSTALLED };
    format!("{state}: no service manager answers here; `enfilade watch` does the same in a terminal")
}

/// Whether it is installed: where its unit lies on Linux, even without a session to ask; else as [`status`].
fn is_installed() -> Result<bool, Error> {
    if cfg!(target_os = "linux") {
        let file = unit_of_user().ok_or_else(|| failed("no home folder; set HOME"))?;
        return Ok(file.symlink_metadata().is_ok());
    }
    status().map(|said| said != NOT_INSTALLED)
}

/// Where the unit of this user lies; `None` where the system has no units or the user no home folder.
fn unit_of_user() -> Option<PathBuf> {
    let dirs = cfg!(target_os = "linux").then(directories::BaseDirs::new)?;
    dirs.map(|dirs| unit_file(dirs.config_dir()))
}

/// Where `service-manager` puts the unit of the user.
fn unit_file(config: &Path) -> PathBuf {
    config.join("systemd/user").join(format!("{NAME}.service"))
}

/// Stops it and takes it away. Results and settings stay.
///
/// # Errors
/// As [`install`].
pub fn uninstall() -> Result<String, Error> {
    // Where nobody can be asked, taking it away says what is wrong.
    if !is_installed().unwrap_or(true) {
        return Ok("no service is installed; nothing was done".into());
    }
    if cfg!(windows) {
        call("schtasks", &["/Delete", "/TN", NAME, "/F"].map(OsString::from))?;
    } else {
        let (manager, label) = manager()?;
        // It may not run just now.
        let _ = manager.stop(ServiceStopCtx { label: label.clone() });
        if let Err(e) = manager.uninstall(ServiceUninstallCtx { label }) {
            return withdrawn(&one_line_of(&e));
        }
    }
    Ok("the service is removed; results and settings stay".into())
}

/// Takes the unit away where no service manager can be told.
fn withdrawn(why: &str) -> Result<String, Error> {
    let Some(file) = unit_of_user() else { return Err(failed(why)) };
    match SystemDisk.remove_file(&file) {
        Ok(()) => Ok(format!(
            "{} is removed, but no service manager could be told ({why}); results and settings stay",
            file.display()
        )),
        Err(e) => Err(failed(&format!("{}: {e}; {why}", file.display()))),
    }
}

fn manager() -> Result<(TypedServiceManager, ServiceLabel), Error> {
    let mut manager = TypedServiceManager::native().map_err(|e| failed(&e.to_string()))?;
    manager.set_level(ServiceLevel::User).map_err(|e| failed(&e.to_string()))?;
    let label: ServiceLabel = NAME.parse().map_err(|e: std::io::Error| failed(&e.to_string()))?;
    Ok((manager, label))
}

fn arguments(folders: &[PathBuf], options: &[OsString], log: &Path) -> Vec<OsString> {
    let mut args: Vec<OsString> = ["watch", "--page", "--notify", "--log"].map(OsString::from).to_vec();
    args.push(log.into());
    args.extend_from_slice(options);
    args.push("--".into());
    args.extend(folders.iter().map(|f| f.clone().into_os_string()));
    args
}

/// A unit of our own: the crate joins arguments by spaces, and folders may have spaces in their names. The daemon is
/// started again for as long as it takes, since a folder may lie on a drive that comes later; one that is told to stop
/// has not failed.
fn systemd_unit(program: &Path, args: &[OsString]) -> String {
    let stopped = Error::Stopped.exit_code();
    let words = std::iter::once(program.as_os_str()).chain(args.iter().map(OsString::as_os_str));
    let line: Vec<String> = words.map(|w| systemd_word(&w.to_string_lossy())).collect();
    format!(
        "[Unit]\nDescription=Enfilade watches folders of drawings\nStartLimitIntervalSec=0\n\n[Service]\nExecStart={}\nRestart=on-failure\n\
         RestartSec={RESTART_SECS}\nSuccessExitStatus={stopped}\nNoNewPrivileges=true\nNice=10\n\n\
         [Install]\nWantedBy=default.target\n",
        line.join(" ")
    )
}

/// Quoted as systemd.service(5) says, "Command lines": `%` and `$` stand for themselves only doubled.
fn systemd_word(word: &str) -> String {
    let mut out = String::from("\"");
    for c in word.chars() {
        match c {
            '"' | '\\' => out.extend(['\\', c]),
            '%' | '$' => out.extend([c, c]),
            '\n' => out.push_str("\\n"),
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

/// What shows a message on this user's desktop, by argument vectors, never through a shell; `None` where the
/// system brings nothing of the kind.
fn messenger(title: &str, text: &str) -> Option<(&'static str, Vec<String>)> {
    if cfg!(target_os = "linux") {
        // The text may carry markup; names of files are none.
        let plain = text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
        let args = ["--app-name=Enfilade", "--", title, &plain].map(String::from);
        return Some(("notify-send", args.into()));
    }
    let lines =
        ["on run argv", "display notification (item 2 of argv) with title (item 1 of argv)", "end run"];
    let script = lines.into_iter().flat_map(|line| ["-e", line]);
    let args = script.chain(["--", title, text]).map(String::from).collect();
    cfg!(target_os = "macos").then_some(("osascript", args))
}

/// Shows a message on the desktop, where there is one; waits for nothing.
pub fn tell_user(title: &str, text: &str) {
    let Some((program, args)) = messenger(title, text) else { return };
    let mut command = std::process::Command::new(program);
    command.args(args).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    if let Ok(mut child) = command.spawn() {
        std::thread::spawn(move || child.wait());
    }
}

/// Arguments of `schtasks` for a task at logon.
fn windows_task(program: &Path, args: &[OsString]) -> Vec<OsString> {
    let words = std::iter::once(program.as_os_str()).chain(args.iter().map(OsString::as_os_str));
    let line: Vec<String> = words.map(|w| format!("\"{}\"", w.to_string_lossy())).collect();
    let run = line.join(" ");
    ["/Create", "/F", "/SC", "ONLOGON", "/RL", "LIMITED", "/TN", NAME, "/TR", &run].map(OsString::from).into()
}

fn call(program: &str, args: &[OsString]) -> Result<(), Error> {
    let out = std::process::Command::new(program).args(args).output();
    let out = out.map_err(|e| failed(&format!("{program}: {e}")))?;
    let said = String::from_utf8_lossy(&out.stderr).trim().to_owned();
    if out.status.success() { Ok(()) } else { Err(failed(&format!("{program}: {said}"))) }
}

fn failed(why: &str) -> Error {
    let text = format!("{}; `enfilade watch` does the same in a terminal", why.trim());
    Error::environment("service", Place::default(), text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn folders_of_any_name_stay_one_word() {
        let folders = [PathBuf::from("/plans/My \"best\" 100% $HOME"), PathBuf::from("-x")];
        let options = ["--depth", "2"].map(OsString::from);
        let args = arguments(&folders, &options, Path::new("/log/watch.log"));
        assert_eq!(args[..5], ["watch", "--page", "--notify", "--log", "/log/watch.log"].map(OsString::from));
        assert_eq!(args[5..8], ["--depth", "2", "--"].map(OsString::from));
        let unit = systemd_unit(Path::new("/bin/enfilade"), &args);
        let line = unit.lines().find(|l| l.starts_with("ExecStart=")).unwrap();
        assert!(line.ends_with(r#""--" "/plans/My \"best\" 100%% $$HOME" "-x""#), "{line}");
        assert!(unit.lines().any(|l| l == "SuccessExitStatus=130"), "a stop is no failure: {unit}");
        assert_eq!(systemd_word("a\nb\\"), "\"a\\nb\\\\\"");
    }

    #[test]
    fn a_second_install_names_what_it_replaces() {
        let args = arguments(&["/plans/a".into(), "/b c".into()], &[], Path::new("/log/watch.log"));
        let unit = systemd_unit(Path::new("/bin/enfilade"), &args);
        assert_eq!(instead_of(&unit), r#" in place of the one that watched "/plans/a" "/b c""#);
        assert_eq!(instead_of("[Unit]"), " in place of an earlier one");
    }

    #[test]
    fn a_service_that_is_half_installed_says_what_is_left_to_do() {
        let file = Path::new("/c/systemd/user/enfilade.service");
        let error = half_done(file, " in place of an earlier one", "not started", "no bus");
        let said = error.to_string();
        for part in ["written to /c/systemd/user/enfilade.service in place", "not started", "no bus", LATER] {
            assert!(said.contains(part), "{part}: {said}");
        }
        assert!(said.contains("Nothing watches now") && LATER.ends_with(NAME), "{said}");
        assert_eq!(error.exit_code(), 4);
    }

    #[test]
    fn what_is_installed_is_said_without_a_service_manager() {
        assert!(without_manager(false).starts_with("not installed: no service manager"));
        assert!(without_manager(true).starts_with("installed, but nothing starts it"));
    }

    #[cfg(target_os = "linux")]
    #[test]
    fn a_message_is_text_whatever_it_says() {
        let (program, args) = messenger("-t", "<b>$(x) & y</b>").unwrap();
        assert_eq!(program, "notify-send");
        assert_eq!(args[1..], ["--", "-t", "&lt;b&gt;$(x) &amp; y&lt;/b&gt;"]);
    }

    #[test]
    fn the_task_of_windows_runs_as_the_user_at_logon() {
        let args = windows_task(Path::new("C:/e.exe"), &["watch".into(), "D:/my plans".into()]);
        assert!(args.windows(2).any(|w| w == ["/RL", "LIMITED"]));
        assert_eq!(args.last().unwrap(), "\"C:/e.exe\" \"watch\" \"D:/my plans\"");
    }
}

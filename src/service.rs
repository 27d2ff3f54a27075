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

use crate::report::{Error, Place};

/// Name of the service.
const NAME: &str = "enfilade";
/// What [`status`] says where there is none.
const NOT_INSTALLED: &str = "not installed";
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
            state: dirs.state_dir().unwrap_or(dirs.data_local_dir()).into(),
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
/// [`Error::Environment`] where the system has no service manager, or it refuses.
pub fn install(folders: &[PathBuf], options: &[OsString]) -> Result<String, Error> {
    let program = std::env::current_exe().map_err(|e| failed(&e.to_string()))?;
    let args = arguments(folders, options, &Folders::of_user()?.log());
    if cfg!(windows) {
        return call("schtasks", &windows_task(&program, &args)).map(|()| "a task at logon was made".into());
    }
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
            contents,
            username: None,
            working_directory: None,
            environment: None,
            autostart: true,
            restart_policy,
        })
        .map_err(|e| failed(&e.to_string()))?;
    manager.start(ServiceStartCtx { label }).map_err(|e| {
        let why = e.to_string();
        failed(&format!(
            "installed, and starts with your next session, but could not be started now: {}",
            why.trim()
        ))
    })?;
    Ok("the service is installed and started; it starts again with your session".into())
}

/// Whether it is installed and runs, in words.
///
/// # Errors
/// As [`install`].
pub fn status() -> Result<String, Error> {
    if cfg!(windows) {
        let is_there = call("schtasks", &["/Query", "/TN", NAME].map(OsString::from)).is_ok();
        return Ok(if is_there { "installed" } else { NOT_INSTALLED }.into());
    }
    let (manager, label) = manager()?;
    let found = manager.status(ServiceStatusCtx { label }).map_err(|e| failed(&e.to_string()))?;
    Ok(match found {
        ServiceStatus::NotInstalled => NOT_INSTALLED.into(),
        ServiceStatus::Running => "running".into(),
        ServiceStatus::Stopped(why) => format!("stopped {}", why.unwrap_or_default()).trim().into(),
    })
}

/// Whether it is installed: where its unit lies on Linux, even without a session to ask; else as [`status`].
fn is_installed() -> Result<bool, Error> {
    if cfg!(target_os = "linux") {
        let dirs = directories::BaseDirs::new().ok_or_else(|| failed("no home folder; set HOME"))?;
        return Ok(unit_file(dirs.config_dir()).symlink_metadata().is_ok());
    }
    status().map(|said| said != NOT_INSTALLED)
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
        manager.uninstall(ServiceUninstallCtx { label }).map_err(|e| failed(&e.to_string()))?;
    }
    Ok("the service is removed; results and settings stay".into())
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
/// started again for as long as it takes, since a folder may lie on a drive that comes later.
fn systemd_unit(program: &Path, args: &[OsString]) -> String {
    let words = std::iter::once(program.as_os_str()).chain(args.iter().map(OsString::as_os_str));
    let line: Vec<String> = words.map(|w| systemd_word(&w.to_string_lossy())).collect();
    format!(
        "[Unit]\nDescription=Enfilade watches folders of drawings\nStartLimitIntervalSec=0\n\n[Service]\nExecStart={}\nRestart=on-failure\n\
         RestartSec={RESTART_SECS}\nNoNewPrivileges=true\nNice=10\n\n\
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
        assert_eq!(systemd_word("a\nb\\"), "\"a\\nb\\\\\"");
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

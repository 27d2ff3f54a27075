//! Parses the command line, calls, and turns the outcome into an exit code.

use std::process::ExitCode;
use std::time::{Duration, Instant};

use enfilade::cli;
use enfilade::commands::{execute, keeps_best};
use enfilade_report::{Cancel, Error, KEEP_GRACE, complain};

/// A job that does not look at the stop request in this time is left behind: everything it stores
/// appears whole or not at all.
const STOP_GRACE: Duration = Duration::from_millis(150);

/// Signals this close are one.
const SAME_PRESS: Duration = Duration::from_millis(300);

const STOPPED: &str = "stopped; nothing half-written was left";

fn main() -> ExitCode {
    let cli = match cli::parse() {
        Ok(cli) => cli,
        Err(code) => return ExitCode::from(code),
    };
    let cancel = Cancel::default();
    let on_stop = cancel.clone();
    let mut asked: Option<Instant> = None;
    let handler = ctrlc::set_handler(move || {
        on_stop.stop_keeping();
        match asked.replace(Instant::now()) {
            // Some programs send the signal to a process and to its group.
            Some(before) if before.elapsed() < SAME_PRESS => {}
            None if keeps_best() => {
                complain("stopping; the best so far is written first; Ctrl-C once more ends at once");
                std::thread::spawn(|| end_after(KEEP_GRACE));
            }
            _ => end_after(STOP_GRACE),
        }
    });
    if let Err(e) = handler {
        complain(format_args!("note: Ctrl-C cannot be handled: {e}"));
    }
    if let Err(e) = refuse_too_large_files_by_error() {
        complain(format_args!("note: a limit on the size of files will end the program without a word: {e}"));
    }
    match execute(cli, &cancel) {
        Ok(code) => ExitCode::from(code),
        Err(Error::Stopped) => {
            complain(STOPPED);
            ExitCode::from(Error::Stopped.exit_code())
        }
        Err(e) => {
            complain(format_args!("error: {e}"));
            ExitCode::from(e.exit_code())
        }
    }
}

/// Ends the process, unless it has ended by then.
fn end_after(grace: Duration) {
    std::thread::sleep(grace);
    complain(STOPPED);
    std::process::exit(i32::from(Error::Stopped.exit_code()));
}

/// By default the system ends a program that writes beyond `ulimit -f`; with the signal taken the write fails
/// instead, and is told and cleaned up after like on a full disk.
#[cfg(unix)]
fn refuse_too_large_files_by_error() -> std::io::Result<()> {
    let seen = std::sync::Arc::default();
    signal_hook::flag::register(signal_hook::consts::SIGXFSZ, seen).map(drop)
}

#[cfg(not(unix))]
fn refuse_too_large_files_by_error() -> std::io::Result<()> {
    Ok(())
}

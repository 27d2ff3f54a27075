//! Options that commands share, where one of the commands would do nothing with them.

use crate::cli::Command;
use crate::report::{Error, Place};

/// Refuses an option that would be taken and do nothing, before anything is done.
///
/// # Errors
/// [`Error::Usage`], `option-idle`, with what serves instead.
pub(super) fn judge(command: &Command) -> Result<(), Error> {
    let found = match command {
        Command::Watch(a) if a.common.json.is_some() => Some((
            "watch",
            "--json",
            "`enfilade status --json` says what is done, --progress json how far it is",
        )),
        Command::Jobs(a) if a.common.json.is_some() => {
            Some(("jobs", "--json", "the list is JSON, one job a line, and --output names its file"))
        }
        Command::Jobs(a) if a.common.threads.is_some() => {
            Some(("jobs", "--threads", "each machine gives its own to `run-job`"))
        }
        Command::Jobs(a) if a.search.write_every.is_some() => {
            Some(("jobs", "--write-every", "a job has its results when it ends"))
        }
        _ => None,
    };
    let Some((command, option, instead)) = found else { return Ok(()) };
    let text = format!("{option}: `{command}` does nothing with it: {instead}; nothing was done");
    Err(Error::usage("option-idle", Place::default(), text))
}

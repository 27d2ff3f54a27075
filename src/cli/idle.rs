//! Options that commands share, where one of the commands would do nothing with them: refused, and shown nowhere.

use clap::ArgMatches;
use clap::parser::ValueSource;

use enfilade_report::{Error, Place};

/// A command, an option of its own or shared that it would do nothing with, and what serves instead.
struct Idle {
    command: &'static str,
    /// As clap knows it: `write_every` is `--write-every`.
    option: &'static str,
    instead: &'static str,
}

/// Every such option; help, manual, completions and the refusal all go by it.
const IDLE: [Idle; 16] = [
    Idle {
        command: "check",
        option: "out",
        instead: "it writes nothing but the picture that --preview names",
    },
    Idle { command: "check", option: "no_pictures", instead: "it draws none unless --preview names it" },
    Idle { command: "works", option: "no_pictures", instead: "it draws none unless --preview names it" },
    Idle { command: "brief", option: "no_pictures", instead: "it draws none unless --preview names it" },
    Idle { command: "resolution", option: "spacing", instead: "--spacings names those that are studied" },
    Idle {
        command: "watch",
        option: "json",
        instead: "`enfilade status --json` says what is done, --progress json how far it is",
    },
    Idle {
        command: "jobs",
        option: "json",
        instead: "the list is JSON, one job a line, and --output names its file",
    },
    Idle { command: "jobs", option: "threads", instead: "each machine gives its own to `run-job`" },
    Idle { command: "jobs", option: "write_every", instead: "a job has its results when it ends" },
    Idle { command: "jobs", option: "progress", instead: "`run-job --progress` says how far a job is" },
    Idle {
        command: "parts",
        option: "json",
        instead: "the list is JSON, one part a line, and --output names its file",
    },
    Idle { command: "parts", option: "threads", instead: "each machine gives its own to `run-job`" },
    Idle { command: "parts", option: "backend", instead: "parts are measured on the cores" },
    Idle {
        command: "parts",
        option: "read_limit_secs",
        instead: "the system that does the lines ends what is too long",
    },
    Idle {
        command: "parts",
        option: "job_limit_secs",
        instead: "the system that does the lines ends what is too long",
    },
    Idle { command: "parts", option: "progress", instead: "how many parts are done says how far it is" },
];

/// The commands as help and manual show them: without what they refuse.
pub(super) fn hidden(all: clap::Command) -> clap::Command {
    IDLE.iter()
        .fold(all, |all, idle| all.mut_subcommand(idle.command, |c| c.mut_arg(idle.option, |a| a.hide(true))))
}

/// The same for completions, which would name hidden options too.
pub(super) fn left_out(all: clap::Command) -> clap::Command {
    IDLE.iter().fold(all, |all, idle| {
        all.mut_subcommand(idle.command, |c| {
            let kept = c.get_arguments().filter(|a| a.get_id() != idle.option);
            let about = c.get_about().cloned().unwrap_or_default();
            clap::Command::new(idle.command).args(kept).about(about)
        })
    })
}

/// Refuses an option that would be taken and do nothing, before anything is done.
///
/// # Errors
/// [`Error::Usage`], `option-idle`, with what serves instead.
pub(super) fn judge(matches: &ArgMatches) -> Result<(), Error> {
    let Some((command, given)) = matches.subcommand() else { return Ok(()) };
    let is_given = |idle: &&Idle| {
        idle.command == command && given.value_source(idle.option) == Some(ValueSource::CommandLine)
    };
    let Some(Idle { option, instead, .. }) = IDLE.iter().find(is_given) else { return Ok(()) };
    let option = option.replace('_', "-");
    let text = format!("--{option}: `{command}` does nothing with it: {instead}; nothing was done");
    Err(Error::usage("option-idle", Place::default(), text))
}

//! `enfilade works`: what one building work would bring.

use super::limits::Clock;
use super::{exit_code, hand_json, open, say, settings_for, tell, write};
use crate::cli::WorksArgs;
use enfilade_overlay::works::{WorkEntry, WorksResult};
use enfilade_pipeline::Input;
use enfilade_report::{Cancel, Error};

/// Forbidden works that are listed: what a rule costs.
const FORBIDDEN_SHOWN: usize = 3;

pub(super) fn works(args: &WorksArgs, clock: &Clock, cancel: &Cancel) -> Result<u8, Error> {
    let (path, bytes) = open(&args.file)?;
    let settings = settings_for(&args.file, args.common.partial(None))?.0;
    let input = Input::new(&path, &bytes, 1);
    let (outcome, _) = enfilade_pipeline::on_threads(&settings, || {
        enfilade_pipeline::works::works_of(&input, &settings, cancel)
    })?;
    cancel.check()?;
    clock.is_read();
    if let (Some(to), Some(made)) =
        (&args.preview, outcome.files.iter().find(|f| f.path.as_os_str() == "works.png"))
    {
        write(to, &made.bytes)?;
    }
    if !hand_json(&args.common, &outcome.result)? && !args.common.quiet {
        tell_works(&outcome.result, args.most);
    }
    tell(&args.common, &outcome.report);
    Ok(exit_code(&outcome.report))
}

/// The ranked list in lines.
fn tell_works(result: &WorksResult, most: usize) {
    let allowed = result.different(true, most);
    let forbidden = result.different(false, FORBIDDEN_SHOWN);
    say(&format!("{} rooms, {} cells, spacing {} m", result.rooms.len(), result.cells, result.spacing_m));
    if allowed.is_empty() {
        say("No allowed work brings 0.5 % or more.");
    }
    for (i, work) in allowed.iter().enumerate() {
        say(&format!("{:>2}. {}{}", i + 1, result.line(work), effort(work)));
    }
    if !forbidden.is_empty() {
        say("Not offered:");
        forbidden.iter().for_each(|work| say(&format!("  – {}", result.line(work))));
    }
    say(&result.proof());
}

/// `; 1.8 m of wall goes, 0.9 m is built`.
fn effort(work: &WorkEntry) -> String {
    let e = &work.effort;
    match (e.demolished_m > 0.0, e.built_m > 0.0) {
        (true, true) => format!("; {:.1} m of wall goes, {:.1} m is built", e.demolished_m, e.built_m),
        (true, false) => format!("; {:.1} m of wall goes", e.demolished_m),
        (false, true) => format!("; {:.1} m is built", e.built_m),
        (false, false) => String::new(),
    }
}

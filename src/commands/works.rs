//! `enfilade works`: what one building work would bring.

use super::accepting::carry_on;
use super::limits::Clock;
use super::{absolute, exit_code, hand_json, open, say, settings_for, tell, write};
use crate::cli::WorksArgs;
use crate::store::{self, SystemDisk};
use enfilade_config::Settings;
use enfilade_overlay::works::{LEAST_SHOWN, WorksResult};
use enfilade_pipeline::Input;
use enfilade_report::{Cancel, Error};

/// Forbidden works that are listed: what a rule costs.
const FORBIDDEN_SHOWN: usize = 3;

pub(super) fn works(args: &WorksArgs, clock: &Clock, cancel: &Cancel) -> Result<u8, Error> {
    let (path, bytes) = open(&args.file)?;
    let settings = settings_for(&args.file, args.common.partial(None))?.0;
    let settings = Settings { pictures: args.preview.is_some(), ..settings };
    let input = Input::new(&path, &bytes, 1);
    if !args.make.is_empty() {
        return make(args, (&input, &settings), clock, cancel);
    }
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

/// Makes works of the list in a new drawing beside this one.
fn make(
    args: &WorksArgs,
    (input, settings): (&Input<'_>, &Settings),
    clock: &Clock,
    cancel: &Cancel,
) -> Result<u8, Error> {
    let made = enfilade_pipeline::on_threads(settings, || {
        enfilade_pipeline::works::make_works(input, settings, &args.make, cancel)
    })?;
    cancel.check()?;
    clock.is_read();
    let new = store::write_revision(&SystemDisk, &absolute(&args.file), &made.bytes)?;
    let side_car = carry_on(&args.file, &new, &made.tables)?;
    say(&format!("new drawing: {}", new.path.display()));
    if let Some(side_car) = side_car {
        say(&format!("its settings: {}", side_car.display()));
    }
    say(&format!("Read again: visibility {} (expected: {}).", percent(made.gain), percent(made.expected)));
    tell(&args.common, &made.report);
    Ok(exit_code(&made.report))
}

/// `+17.2 %`.
fn percent(share: f64) -> String {
    format!("{:+.1} %", 100.0 * share).replace('-', "−")
}

/// The ranked list in lines.
fn tell_works(result: &WorksResult, most: usize) {
    let allowed = result.different(true, most);
    let forbidden = result.different(false, FORBIDDEN_SHOWN);
    say(&format!("{} rooms, {} cells, spacing {} m", result.rooms.len(), result.cells, result.spacing_m));
    if allowed.is_empty() {
        say(&format!("No allowed work brings {:.1} % or more.", 100.0 * LEAST_SHOWN));
    }
    for work in &allowed {
        let effort = work.effort.words();
        let effort = if effort.is_empty() { effort } else { format!("; {effort}") };
        say(&format!("{:>3}. {}{effort}", work.id, result.line(work)));
    }
    if !forbidden.is_empty() {
        say("Not offered:");
        forbidden.iter().for_each(|work| say(&format!("  – {}", result.line(work))));
    }
    say(&result.proof());
    if let Some(first) = allowed.first() {
        say(&format!("To have one drawn: {}", result.making(&first.id.to_string())));
    }
}

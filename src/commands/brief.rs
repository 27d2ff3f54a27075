//! `enfilade brief`: whether the present layout has what is asked of its rooms.

use super::limits::Clock;
use super::{exit_code, hand_json, open, say, settings_for, tell, write};
use crate::cli::BriefArgs;
use enfilade_config::{BriefText, Partial};
use enfilade_pipeline::Input;
use enfilade_report::{Cancel, Error};

pub(super) fn brief(args: &BriefArgs, clock: &Clock, cancel: &Cancel) -> Result<u8, Error> {
    let (path, bytes) = open(&args.file)?;
    let asked = (!args.brief.is_empty()).then(|| BriefText::Text(args.brief.join("; ")));
    let partial = Partial { brief: asked, ..args.common.partial(None) };
    let settings = settings_for(&args.file, partial)?.0;
    let input = Input::new(&path, &bytes, 1);
    let outcome = enfilade_pipeline::on_threads(&settings, || {
        enfilade_pipeline::brief::brief_of(&input, &settings, args.preview.is_some(), cancel)
    })?;
    cancel.check()?;
    clock.is_read();
    if let (Some(to), Some(made)) = (&args.preview, outcome.files.first()) {
        write(to, &made.bytes)?;
    }
    if !hand_json(&args.common, &outcome.result)? && !args.common.quiet {
        say(&outcome.result.summary());
        outcome.result.items.iter().flat_map(|i| i.lines()).for_each(|line| say(&line));
    }
    tell(&args.common, &outcome.report);
    Ok(exit_code(&outcome.report))
}

//! What the report says of options that do what is forbidden unless it is allowed, beside joints, doors and crossings.

use crate::measure::study::Study;
use crate::write::made::Made;
use enfilade_config::{Allow, Settings};
use enfilade_report::{Place, Report, counted};

/// Names the options that leave narrow ways, or move walls into things, since that is allowed.
pub(crate) fn say_allowed(
    report: &mut Report,
    file: &str,
    study: &Study,
    settings: &Settings,
    made: &[Made],
) {
    let Allow { narrow_ways, things, .. } = settings.allow;
    if !narrow_ways && !things {
        return;
    }
    for (i, m) in made.iter().enumerate().filter(|(_, m)| m.moves_any()) {
        let faults = study.all_faults(&m.layout);
        let mut say = |code: &'static str, does: String, word: &str| {
            let text = format!("option {} {does}, as `--allow {word}` permits", i + 1);
            report.warn(code, Place::file(file), text);
        };
        if narrow_ways && faults.narrowed_m > 0.0 {
            say("options-narrow", "leaves a way below 0.9 m that was wider".into(), "narrow-ways");
        }
        if things && faults.struck > 0 {
            let what = counted(faults.struck as u64, "thing");
            say("options-struck", format!("moves walls into {what} that stand there"), "things");
        }
    }
}

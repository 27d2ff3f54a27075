//! What the report says of options that run walls through each other although nobody asked them not to.

use crate::measure::study::Study;
use crate::understand::faults::CROSSING_FREE_M;
use crate::understand::named;
use crate::write::made::Made;
use enfilade_config::{Held, Penalty, Settings};
use enfilade_report::Report;

/// Names for each option the walls that run through each other, unless overlap is weighed or limited.
pub(crate) fn say_overlaps(
    report: &mut Report,
    file: &str,
    study: &Study,
    settings: &Settings,
    made: &[Made],
) {
    let is_weighed = settings.penalties.iter().any(|(p, v)| *p == Penalty::Overlap && *v > 0.0);
    let is_limited = settings.limits.iter().any(|l| l.held == Held::Penalty(Penalty::Overlap));
    if is_weighed || is_limited {
        return;
    }
    for (i, m) in made.iter().enumerate() {
        let mut found = study.overlapping(&m.layout);
        if found.iter().map(|(_, by_m)| by_m).sum::<f64>() <= CROSSING_FREE_M {
            continue;
        }
        found.sort_by(|a, b| b.1.total_cmp(&a.1).then_with(|| a.0.cmp(&b.0)));
        // What the penalty counts is no depth, so no number is told.
        let ([a, b], _) = found[0];
        let is_moved = |w: u32| m.layout.walls.iter().any(|moved| moved.wall == w && moved.is_changed);
        let (mover, other) = if is_moved(a) { (a, b) } else { (b, a) };
        let plan = &study.base.plan;
        let place = |w: u32| named::place(file, plan, &plan.walls[w as usize]);
        let rest = match found.len() - 1 {
            0 => String::new(),
            1 => "; 1 more pair of walls does".into(),
            n => format!("; {n} more pairs of walls do"),
        };
        let text = format!(
            "option {} runs it through {}{rest}; --limit \"overlap <= 0\" allows none of it",
            i + 1,
            place(other)
        );
        report.warn("options-overlap", place(mover), text);
    }
}

//! What the report and an option's words say of doors that an option leaves narrower than they are drawn.

use crate::measure::study::Study;
use crate::understand::understood::Understood;
use crate::write::made::Made;
use enfilade_cad::drawing::place_in;
use enfilade_moves::Layout;
use enfilade_moves::narrowed::{Doors, Narrowed};
use enfilade_report::Report;

/// Doors that an option's words tell one by one.
const TOLD: usize = 3;

/// Names for each option the doors that it leaves narrower.
pub(crate) fn say_narrowed(report: &mut Report, file: &str, study: &Study, made: &[Made]) {
    let base = &study.base;
    for (i, m) in made.iter().enumerate() {
        for door in narrowed(base, &m.layout) {
            let text = format!(
                "option {}: {} is left {:.2} m wide, it was {:.2} m; narrower bounds, or --limit \"passage {:.2} m\", keep it",
                i + 1,
                door.place_words(),
                door.is_m,
                door.was_m,
                door.was_m
            );
            let wall = &base.plan.walls[door.by as usize];
            report.warn("options-door", place_in(file, &wall.source), text);
        }
    }
}

/// The same as sentences for the words of one option; empty for none.
pub(crate) fn narrowed_words(base: &Understood, layout: &Layout) -> String {
    let found = narrowed(base, layout);
    let door =
        |d: &Narrowed| format!("{} is left {:.2} m wide, it was {:.2} m", d.place_words(), d.is_m, d.was_m);
    let told: Vec<String> = found.iter().take(TOLD).map(door).collect();
    let more = match found.len().saturating_sub(TOLD) {
        0 => String::new(),
        1 => ", and 1 more door is narrower".into(),
        n => format!(", and {n} more doors are narrower"),
    };
    match told.as_slice() {
        [] => String::new(),
        all => format!(" Mind: {}{more}.", all.join(", ")),
    }
}

fn narrowed(base: &Understood, layout: &Layout) -> Vec<Narrowed> {
    Doors::new(&base.plan, &base.axes).narrowed(layout)
}

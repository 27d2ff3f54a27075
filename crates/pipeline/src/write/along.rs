//! What goes along with the walls of an option, and what stays behind.

use std::collections::{BTreeMap, BTreeSet};

use crate::understand::understood::Understood;
use crate::write::made::Made;
use enfilade_cad::drawing::{SourceRef, place_in};
use enfilade_moves::Layout;
use enfilade_moves::carried::{Carried, carried};
use enfilade_report::Report;

/// Names the texts at doors and windows that go with their wall: nobody can tell whether a text is the door's.
pub(crate) fn say_labels(base: &Understood, layout: &Layout, report: &mut Report) {
    // A text between two doors is the label of both.
    let mut told = BTreeSet::new();
    for label in &base.labels {
        let fitting = &base.fittings[label.fitting];
        let goes = matches!(carried(&base.plan, fitting, layout), Carried::Moves(..));
        if goes && told.insert(label.source.record) {
            let text = "It stands at a door or window that moves in an option. It stays as drawn and may be wrong there.";
            report.info("stale-annotation", place_in(&base.plan.file, &label.source), text);
        }
    }
}

/// Names the annotation that does not follow the moved walls: of one kind on one layer together.
pub(crate) fn say_stale(report: &mut Report, file: &str, found: &[SourceRef]) {
    let mut alike: Vec<Vec<&SourceRef>> = Vec::new();
    for s in found {
        match alike.iter_mut().find(|of| of[0].kind == s.kind && of[0].layer == s.layer) {
            Some(of) => of.push(s),
            None => alike.push(vec![s]),
        }
    }
    for of in alike {
        let text = match &of[1..] {
            [] => "It is tied to a wall that moves in an option. It stays as drawn and may be wrong there."
                .to_owned(),
            others => format!(
                "It and {} more {} of the layer ({}) are tied to walls that move in an option. They stay as drawn and may be \
                 wrong there.",
                others.len(),
                of[0].kind,
                named(others)
            ),
        };
        report.info("stale-annotation", place_in(file, of[0]), text);
    }
}

/// What goes along with the walls of an option, by layer, also what the plan does not show of a building; empty for
/// nothing.
pub(crate) fn goes_along_words(base: &Understood, made: &Made) -> String {
    // A door that slides was told as such.
    let follows = |record: usize| !made.layout.slides(&base.plan, record);
    let parts = base.fittings.iter().filter(|f| !f.is_furniture());
    let goes = parts.filter(|f| follows(f.source.record));
    let goes = goes.filter(|f| matches!(carried(&base.plan, f, &made.layout), Carried::Moves(..)));
    let mut records: BTreeMap<usize, &str> =
        goes.map(|f| (f.source.record, f.source.layer.as_str())).collect();
    let shown = records.len();
    let changed = made.changed.records.iter().flatten();
    for (record, class) in changed.filter_map(|c| Some((c.of.record, c.filler?))).filter(|c| follows(c.0)) {
        records.entry(record).or_insert(class);
    }
    let layers: BTreeSet<&str> = records.values().copied().collect();
    let layers: Vec<&str> = layers.into_iter().collect();
    let mut on = match layers.as_slice() {
        [layer] => format!("layer {layer}"),
        all => format!("layers {}", all.join(", ")),
    };
    match records.len() - shown {
        0 => {}
        unseen => on += &format!("; {unseen} of them not shown in this plan"),
    }
    match records.len() {
        0 => String::new(),
        1 => format!(" One part of a door or window moves with its wall ({on})."),
        n => format!(" {n} parts of doors and windows move with their walls ({on})."),
    }
}

/// The furniture that follows the walls of an option; empty for none.
pub(crate) fn furniture_words(base: &Understood, layout: &Layout) -> String {
    let furniture = base.fittings.iter().filter(|f| f.is_furniture());
    let goes = furniture.filter(|f| matches!(carried(&base.plan, f, layout), Carried::Moves(..))).count();
    match goes {
        0 => String::new(),
        1 => " One piece of furniture moves with the wall that it stands at.".into(),
        n => format!(" {n} pieces of furniture move with the walls that they stand at."),
    }
}

/// The walls of a building that the plan does not show and that change their length with those of an option; empty for
/// none.
pub(crate) fn unseen_words(made: &Made) -> String {
    let unseen = made.changed.records.iter().flatten().filter(|c| c.outlines.is_some());
    let walls: BTreeMap<usize, Option<&String>> = unseen.map(|c| (c.of.record, c.storey.as_ref())).collect();
    let storeys: BTreeSet<&String> = walls.values().flatten().copied().collect();
    let storeys: Vec<String> = storeys.into_iter().cloned().collect();
    let on = match storeys.as_slice() {
        [] => String::new(),
        [one] => format!(" (storey {one})"),
        all => format!(" (storeys {})", all.join(", ")),
    };
    match walls.len() {
        0 => String::new(),
        1 => format!(" One wall that this plan does not show{on} changes its length too."),
        n => format!(" {n} walls that this plan does not show{on} change their length too."),
    }
}

/// What somebody must look at before taking an option: parts of doors and windows that do not go with their wall.
pub(crate) fn stays_words(report: &Report) -> String {
    match report.problems.iter().filter(|p| p.code == OPENING_STAYS).count() {
        0 => String::new(),
        1 => " A part of a door or window stays behind: look at it before you take this option.".into(),
        n => {
            format!(" {n} parts of doors and windows stay behind: look at them before you take this option.")
        }
    }
}

/// Code of what says that a part of a door or window stays as drawn.
pub(crate) const OPENING_STAYS: &str = "opening-stays";

/// Records by their handles, else by their lines.
fn named(records: &[&SourceRef]) -> String {
    let name = |s: &&SourceRef| s.handle.clone().unwrap_or_else(|| format!("line {}", s.line));
    let mut names: Vec<String> = records.iter().take(HANDLES_MAX).map(name).collect();
    if records.len() > HANDLES_MAX {
        names.push(format!("and {} not listed", records.len() - HANDLES_MAX));
    }
    names.join(", ")
}

/// Most handles of annotation of one kind on one layer that are listed.
const HANDLES_MAX: usize = 200;

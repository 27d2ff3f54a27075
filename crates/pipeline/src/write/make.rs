//! Options made real: the drawing patched, read again and measured.

use crate::job::Job;
use crate::measure::study::Study;
use crate::read;
use crate::understand::edits::{edits_of, tied};
use crate::understand::understood::Understood;
use crate::write::made::Made;
use crate::write::{along, bounded};
use enfilade_cad::drawing::{Edit, place_in};
use enfilade_moves::Layout;
use enfilade_moves::carried::{Carried, carried};
use enfilade_report::{Error, Place, Report};

/// Patches the drawing, reads it again and measures from scratch: what is reported is what is written.
pub(crate) fn make(
    job: Job<'_>,
    study: &Study,
    name: &str,
    member: &enfilade_search::Member,
) -> Result<Made, Error> {
    let Job { input, settings } = job;
    let layout = study.base.moves.apply(&study.base.plan, &study.base.graph, &member.parameters);
    let options = read::read_options(settings);
    let mut edits = edits_of(&study.base, &layout);
    let tied = tied(job, &study.base, &edits)?;
    edits.extend(tied.following.iter().map(|f| f.edit.clone()));
    let changed = enfilade_cad::changes(input.file(), &input.bytes, &options, &edits)?;
    let bytes = enfilade_cad::patch(input.file(), &input.bytes, &options, &edits, &[])?;
    let worth = study.measure_written(&bytes, &layout, settings)?;
    let name = name.to_owned();
    let mut report = Report::default();
    let records: Vec<usize> = edits.iter().map(Edit::record).collect();
    let unseen = changed.records.iter().flatten().filter(|c| c.outlines.is_some()).map(|c| c.of.record);
    let rooms = changed.rooms.iter().map(|r| r.id as usize);
    let named: Vec<usize> = records.iter().copied().chain(unseen).chain(rooms).collect();
    let ids = enfilade_cad::host_ids(input.file(), &input.bytes, &named);
    let host_ids = named.iter().zip(ids).filter_map(|(r, id)| Some((*r as u64, id?))).collect();
    along::say_stale(&mut report, input.file(), &tied.stale);
    bounded::say(&mut report, input.file(), &changed);
    state_left_behind(&study.base, &layout, &mut report);
    let searched = study.measure(&member.parameters, &mut study.bench());
    let differs = worth.differences(&searched);
    if !differs.is_empty() {
        let differs: Vec<String> =
            differs.into_iter().map(|(what, new, old)| format!("{what} {new} instead of {old}")).collect();
        let text = format!(
            "{name} read again does not measure as in the search: {}; the values of the file are reported",
            differs.join(", ")
        );
        report.warn("written-differs", Place::file(input.file()), text);
    }
    let following = tied.following;
    Ok(Made { layout, member: member.clone(), worth, edits, following, changed, host_ids, report, name })
}

/// Doors and windows that cannot go with their wall.
pub(crate) fn state_left_behind(base: &Understood, layout: &Layout, report: &mut Report) {
    for fitting in &base.fittings {
        if let Carried::Stale(why) = carried(&base.plan, fitting, layout) {
            let text = format!(
                "is part of a door or window whose wall moves in an option, but {why}; it stays as drawn"
            );
            report.info(along::OPENING_STAYS, place_in(&base.plan.file, &fitting.source), text);
        }
    }
    along::say_labels(base, layout, report);
}

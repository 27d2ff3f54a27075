//! Options made real: the drawing patched, read again and measured.

use std::collections::BTreeMap;
use std::sync::Arc;

use rayon::prelude::*;

use crate::confirm::found::Found;
use crate::job::Job;
use crate::measure::study::Study;
use crate::read;
use crate::search::judged::pinned;
use crate::understand::edits::{edits_of, tied};
use crate::understand::understood::Understood;
use crate::works::Offer;
use crate::works::options::{BuildingOption, wanted};
use crate::write::made::Made;
use crate::write::{along, bounded};
use enfilade_cad::drawing::{Edit, place_in};
use enfilade_moves::Layout;
use enfilade_moves::carried::{Carried, carried};
use enfilade_overlay::result::{Explanation, Gains, Objective};
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
    Ok(Made {
        layout,
        member: member.clone(),
        worth,
        edits,
        following,
        changed,
        host_ids,
        report,
        name,
        explanation: Explanation::default(),
        gains: Gains::new(),
        brief: Vec::new(),
        built: None,
    })
}

/// An option of a round before it is made.
enum Choice<'a> {
    /// A layout of the search, by its place.
    Layout(&'a Found, usize),
    /// Works.
    Building(&'a Arc<BuildingOption>),
}

impl Choice<'_> {
    /// What it gains in all objectives together.
    fn total(&self, objectives: &[Objective]) -> f64 {
        let gains = match self {
            Self::Layout(found, i) => found.gains.get(*i),
            Self::Building(option) => Some(&option.gains),
        };
        let of = |o: &Objective| gains.and_then(|g| g.get(&o.name)).map_or(0.0, |g| g.share);
        objectives.iter().map(of).sum()
    }

    fn make(&self, job: Job<'_>, study: &Study, name: &str) -> Result<Made, Error> {
        match self {
            Self::Layout(found, i) => {
                let made = make(job, study, name, &found.members[*i])?;
                let explanation = found.explanations.get(*i).cloned().unwrap_or_default();
                Ok(Made { explanation, gains: found.gains.get(*i).cloned().unwrap_or_default(), ..made })
            }
            Self::Building(option) => Ok(building(study, name, option)),
        }
    }
}

/// The options of a round: those of the search, and those that build among them by what they gain. Those that are pinned
/// stand first; one of the search stays where there is any.
///
/// # Errors
/// As [`make`].
pub(crate) fn options(
    job: Job<'_>,
    study: &Study,
    (found, offer): (Option<&Found>, Option<&Offer>),
) -> Result<Vec<Made>, Error> {
    let settings = job.settings;
    let layouts = found.into_iter().flat_map(|f| (0..f.members.len()).map(move |i| Choice::Layout(f, i)));
    let mut all: Vec<Choice<'_>> = layouts.collect();
    if let Some(offer) = offer.filter(|o| !o.options.is_empty()) {
        let mut free = all.split_off(pinned(settings).min(all.len()));
        let room = wanted(settings).saturating_sub(all.len());
        // The best layout of the search is an idea of its own, whatever a wall less would bring, if there is room for two.
        let first = (room > 1 && !free.is_empty()).then(|| free.remove(0));
        free.extend(offer.options.iter().map(Choice::Building));
        let by_gain = |a: &Choice<'_>, b: &Choice<'_>| {
            b.total(&offer.objectives).total_cmp(&a.total(&offer.objectives))
        };
        free.sort_by(by_gain);
        free.truncate(room.saturating_sub(usize::from(first.is_some())));
        free.extend(first);
        free.sort_by(by_gain);
        all.extend(free);
    }
    let one = |(i, choice): (usize, &Choice<'_>)| choice.make(job, study, &format!("candidate-{}", i + 1));
    all.par_iter().enumerate().map(one).collect()
}

/// An option that builds, made already.
fn building(study: &Study, name: &str, option: &Arc<BuildingOption>) -> Made {
    let moves = &study.base.moves;
    let parameters = moves.identity();
    Made {
        layout: moves.apply(&study.base.plan, &study.base.graph, &parameters),
        member: enfilade_search::Member {
            parameters,
            values: option.values.clone(),
            violation: 0.0,
            within_threshold: option.is_within,
        },
        worth: option.worth.clone(),
        edits: Vec::new(),
        following: Vec::new(),
        changed: enfilade_cad::Changes::default(),
        host_ids: BTreeMap::new(),
        report: option.report.clone(),
        name: name.to_owned(),
        explanation: Explanation::default(),
        gains: option.gains.clone(),
        brief: Vec::new(),
        built: Some(Arc::clone(option)),
    }
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

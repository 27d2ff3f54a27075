//! Options made real: the drawing patched, read again and measured.

use std::collections::BTreeMap;
use std::sync::Arc;

use rayon::prelude::*;

use crate::confirm::found::Found;
use crate::confirm::ideas::{Experience, SAME_MAPS};
use crate::job::Job;
use crate::measure::study::Study;
use crate::read;
use crate::search::judged::pinned;
use crate::understand::edits::{edits_of, tied};
use crate::understand::understood::Understood;
use crate::works::{Moved, Offer};
use crate::works::{option::BuildingOption, options::wanted};
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
    let Shifted { edits, following, changed, host_ids, mut report } = shifted(job, study, &layout)?;
    let options = read::read_options(settings);
    let bytes = enfilade_cad::patch(input.file(), &input.bytes, &options, &edits, &[])?;
    let worth = study.measure_written(&bytes, &layout, settings)?;
    let name = name.to_owned();
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
        is_pinned: false,
        explanation: Explanation::default(),
        gains: Gains::new(),
        brief: Vec::new(),
        built: None,
    })
}

/// What a layout changes of a file.
#[derive(Default)]
struct Shifted {
    edits: Vec<Edit>,
    following: Vec<enfilade_cad::dxf::Following>,
    changed: enfilade_cad::Changes,
    host_ids: BTreeMap<u64, String>,
    report: Report,
}

fn shifted(job: Job<'_>, study: &Study, layout: &Layout) -> Result<Shifted, Error> {
    let Job { input, settings } = job;
    let mut edits = edits_of(&study.base, layout);
    let tied = tied(job, &study.base, &edits)?;
    edits.extend(tied.following.iter().map(|f| f.edit.clone()));
    let changed = enfilade_cad::changes(input.file(), &input.bytes, &read::read_options(settings), &edits)?;
    let mut report = Report::default();
    let records: Vec<usize> = edits.iter().map(Edit::record).collect();
    let unseen = changed.records.iter().flatten().filter(|c| c.outlines.is_some()).map(|c| c.of.record);
    let rooms = changed.rooms.iter().map(|r| r.id as usize);
    let named: Vec<usize> = records.iter().copied().chain(unseen).chain(rooms).collect();
    let ids = enfilade_cad::host_ids(input.file(), &input.bytes, &named);
    let host_ids = named.iter().zip(ids).filter_map(|(r, id)| Some((*r as u64, id?))).collect();
    along::say_stale(&mut report, input.file(), &tied.stale);
    bounded::say(&mut report, input.file(), &changed);
    state_left_behind(&study.base, layout, &mut report);
    Ok(Shifted { edits, following: tied.following, changed, host_ids, report })
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

    fn builds(&self) -> bool {
        matches!(self, Self::Building(_))
    }

    fn is_least(&self) -> bool {
        matches!(self, Self::Building(option) if option.is_least)
    }

    fn is_pinned_building(&self) -> bool {
        matches!(self, Self::Building(option) if option.is_pinned)
    }

    /// What people experience in it.
    fn experience(&self, study: &Study) -> Experience {
        match self {
            Self::Layout(found, i) => {
                Experience::of(study, &study.measure(&found.members[*i].parameters, &mut study.bench()))
            }
            Self::Building(option) => Experience::of(study, &option.worth),
        }
    }

    fn make(&self, job: Job<'_>, study: &Study, name: &str) -> Result<Made, Error> {
        match self {
            Self::Layout(found, i) => {
                let made = make(job, study, name, &found.members[*i])?;
                let explanation = found.explanations.get(*i).cloned().unwrap_or_default();
                let gains = found.gains.get(*i).cloned().unwrap_or_default();
                Ok(Made { explanation, gains, is_pinned: *i < pinned(job.settings), ..made })
            }
            Self::Building(option) => building(job, study, name, option),
        }
    }
}

/// The options of a round: those of the search, and those that build among them by what they gain. Those that are pinned
/// stand first; one of the search stays where there is any. And how many were left out since they are like one of these.
///
/// # Errors
/// As [`make`].
pub(crate) fn options(
    job: Job<'_>,
    study: &Study,
    (found, offer): (Option<&Found>, Option<&Offer>),
) -> Result<(Vec<Made>, usize), Error> {
    let settings = job.settings;
    let mut alike = 0;
    let layouts = found.into_iter().flat_map(|f| (0..f.members.len()).map(move |i| Choice::Layout(f, i)));
    let mut all: Vec<Choice<'_>> = layouts.collect();
    if let Some(offer) = offer.filter(|o| !o.options.is_empty()) {
        let mut free = all.split_off(pinned(settings).min(all.len()));
        let room = wanted(settings).saturating_sub(all.len());
        let (kept, building) =
            offer.options.iter().map(Choice::Building).partition(Choice::is_pinned_building);
        let kept: Vec<Choice<'_>> = kept;
        free.extend::<Vec<Choice<'_>>>(building);
        let by_gain = |a: &Choice<'_>, b: &Choice<'_>| {
            b.total(&offer.objectives).total_cmp(&a.total(&offer.objectives))
        };
        free.sort_by(by_gain);
        // Nor does the least change stand back for what brings more.
        if let Some(least) = free.iter().position(Choice::is_least) {
            let least = free.remove(least);
            free.insert(1.min(free.len()), least);
        }
        let (mut free, left_out) = apart(study, (kept, free), room);
        alike = left_out;
        let pins = free.iter().take_while(|c| c.is_pinned_building()).count();
        free[pins..].sort_by(by_gain);
        all.extend(free);
    }
    let one = |(i, choice): (usize, &Choice<'_>)| choice.make(job, study, &format!("candidate-{}", i + 1));
    let made: Result<Vec<Made>, Error> = all.par_iter().enumerate().map(one).collect();
    Ok((made?, alike))
}

/// Those kept, then the first that differ, at most so many, and how many were left out since they are like one of these. The best layout of the search is an idea of its own, whatever a wall less would
/// bring: it has the last place, if there is room for two.
fn apart<'a>(
    study: &Study,
    (kept, all): (Vec<Choice<'a>>, Vec<Choice<'a>>),
    room: usize,
) -> (Vec<Choice<'a>>, usize) {
    let mut alike = 0;
    let with_experience = |c: Choice<'a>| {
        let experience = c.experience(study);
        (c, experience)
    };
    let mut taken: Vec<(Choice<'a>, Experience)> = kept.into_iter().map(with_experience).collect();
    let pins = taken.len();
    let mut moving = None;
    for choice in all {
        let experience = choice.experience(study);
        let is_alike = |t: &(Choice<'a>, Experience)| {
            t.0.builds() != choice.builds() && t.1.likeness(&experience) > SAME_MAPS
        };
        if taken.iter().any(is_alike) {
            alike += 1;
            continue;
        }
        if taken.len() < room {
            taken.push((choice, experience));
        } else if moving.is_none() && !choice.builds() {
            moving = Some((choice, experience));
        }
    }
    if let Some(moving) = moving.filter(|_| room > 1 + pins && taken.iter().all(|t| t.0.builds())) {
        taken.pop();
        taken.push(moving);
    }
    (taken.into_iter().map(|t| t.0).collect(), alike)
}

/// An option that builds, made already.
fn building(job: Job<'_>, study: &Study, name: &str, option: &Arc<BuildingOption>) -> Result<Made, Error> {
    let Moved { parameters, layout } = option.moved.clone();
    let shifted = if option.moved.is_any() { shifted(job, study, &layout)? } else { Shifted::default() };
    let Shifted { edits, following, changed, host_ids, mut report } = shifted;
    report.extend(option.report.clone());
    Ok(Made {
        layout,
        member: enfilade_search::Member {
            parameters,
            values: option.values.clone(),
            violation: 0.0,
            within_threshold: option.is_within,
        },
        worth: option.worth.clone(),
        edits,
        following,
        changed,
        host_ids,
        report,
        name: name.to_owned(),
        is_pinned: option.is_pinned,
        explanation: Explanation { breaks: option.breaks.clone(), ..Explanation::default() },
        gains: option.gains.clone(),
        brief: Vec::new(),
        built: Some(Arc::clone(option)),
    })
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

//! The last stage, from what was found to the files of a round.

pub(crate) mod allowed;
pub(crate) mod along;
pub(crate) mod analysis;
pub(crate) mod asked;
pub(crate) mod beside;
pub(crate) mod bounded;
pub(crate) mod briefed;
pub(crate) mod changes;
pub(crate) mod check_picture;
pub(crate) mod diversity;
pub(crate) mod doors;
pub(crate) mod files;
pub mod geojson;
pub(crate) mod graph;
pub(crate) mod heat_maps;
pub(crate) mod joints;
pub(crate) mod leaving;
pub(crate) mod made;
pub(crate) mod make;
pub(crate) mod maps;
pub(crate) mod overlaps;
pub(crate) mod page;
pub(crate) mod places;
pub(crate) mod reading;
pub(crate) mod round_result;
pub(crate) mod show;
pub(crate) mod told;
pub(crate) mod traces;

use crate::brief::told::plan_from_metres;
use crate::confirm::found::Found;
use crate::job::{Job, Outcome};
use crate::round::Round;
use crate::search::brief::is_bare;
use crate::search::distance;
use crate::search::judged::is_firm;
use crate::understand::rooms::rooms_with_kinds;
use crate::works::{Listed, Offer};
use crate::write::diversity::{likeness, nearest};
use crate::write::made::Made;
use enfilade_overlay::brief::brief_png;
use enfilade_overlay::heat_map::DEFAULT_SIDE_PX;
use enfilade_overlay::result::{self, RoundResult};
use enfilade_report::{Error, OutFile, Place, Report};

/// The files of a round from what was found; of the present layout alone, where nothing was searched.
///
/// # Errors
/// Where a layout cannot be written or a picture cannot be made.
pub(crate) fn write(
    round: &Round<'_>,
    mut report: Report,
    found: Option<&Found>,
    offer: Option<&Offer>,
) -> Result<Outcome<RoundResult>, Error> {
    let Round { job, study, sensed, .. } = round;
    let (job, study) = (*job, *study);
    let Job { input, settings } = job;
    let card_trouble = found.and_then(|f| f.card_trouble.as_deref());
    if let Some(why) = study.card_trouble().or(card_trouble) {
        let text = format!("{why}; the cores measured the rest, with the same result");
        report.warn("backend-gave-up", Place::file(input.file()), text);
    }
    let works = offer.map(|o| &o.listed);
    let (made, alike) = make::options(job, study, (found, offer))?;
    let made = briefed::briefed(round, made, &mut report)?;
    let built = made.iter().filter(|m| m.built.is_some()).count();
    for m in &made {
        report.extend(m.report.clone());
    }
    let best = found.and_then(|f| f.best.as_ref());
    let best = best.map(|b| {
        let made = make::make(job, study, "best", &b.member)?;
        Ok::<_, Error>(Made { gains: b.gains.clone(), ..made })
    });
    let best = briefed::best(round, best.transpose()?, &mut report)?;
    joints::say_opened(&mut report, input.file(), study, &made);
    doors::say_narrowed(&mut report, input.file(), study, &made);
    overlaps::say_overlaps(&mut report, input.file(), study, settings, &made);
    allowed::say_allowed(&mut report, input.file(), study, settings, &made);
    leaving::say_leaving(&mut report, input.file(), study, &made);
    if let Some(held) = found.map(|f| f.held_back.trim()).filter(|h| !h.is_empty()) {
        report.info("moves-held", Place::file(input.file()), held);
    }
    told::say_pinned(&mut report, input.file(), &made);
    if let Some(found) = found {
        if is_firm(settings) && built < made.len() {
            told::say_out_of_reach(&mut report, input.file(), (study, settings), found);
        }
        if built < made.len() {
            told::say_below_present(&mut report, input.file(), &found.objectives, is_firm(settings));
        }
        told::say_options(&mut report, input.file(), study, settings, (found, made.len(), built, alike));
    }
    let wanted = distance::distance(study, settings) * (study.base.moves.parameters.len() as f64).sqrt();
    let share = found.filter(|_| built < made.len()).map_or(1.0, |f| f.threshold_share);
    let nearest = nearest(study, &made).map(|(pair, distance)| told::Nearest {
        distance,
        wanted,
        are_pinned: pair.into_iter().all(|i| made[i].is_pinned),
        has_ended: found.is_none_or(|f| f.has_ended),
    });
    told::say_lowered(&mut report, input.file(), share);
    let likeness = likeness(study, &made);
    if is_bare(settings) {
        told::say_alikeness(&mut report, input.file(), settings, nearest.as_ref());
    } else {
        let shared = if built > 0 { Vec::new() } else { told::shared_parts(&made) };
        let of = (input.file(), study.base.plan.format);
        told::say_likeness(&mut report, of, likeness, &shared);
    }
    told::say_free_of_modules(&mut report, input.file(), study, settings);
    let mut result = round_result::round_result(round, &report, (found, offer), (&made, best.as_ref()));
    result.questions = sensed.doubts.iter().map(|d| asked::entry(d, &study.base.plan)).collect();
    if found.is_none() && !result.questions.is_empty() {
        result.stopped_by = "questions are open: the present layout was measured".into();
    } else if found.is_none() && built > 0 {
        result.stopped_by = "nothing may move: building works were measured".into();
    }
    let shown: Vec<&Made> = made.iter().chain(&best).collect();
    let mut files = files::drawings(job, study, (&shown, works), &result)?;
    files.extend(beside::side_cars(job, study, &shown)?);
    let mut understood = None;
    if settings.pictures {
        files.extend(files::pictures(job, study, &shown)?);
        files.push(OutFile::new("convergence.png", files::convergence(found)?));
        files.push(OutFile::new("diversity.png", files::diversity(study, &made)?));
        let rooms = rooms_with_kinds(&study.base, sensed, job.settings)?;
        if !round.brief.is_empty() {
            let shown = show::check_picture(&study.base, sensed, &rooms);
            let to_plan = |p: [f64; 2]| plan_from_metres(&study.base, p);
            let png = brief_png(&shown, &round.brief, &to_plan, DEFAULT_SIDE_PX)?;
            files.push(OutFile::new("brief.png", png));
        }
        understood = Some(check_picture::check_picture(&study.base, sensed, &rooms)?);
    }
    let maps = maps::maps(study);
    let page = page::page(job, &result, (&files, &maps), (understood.as_deref(), works), (found, &made));
    files.extend(works.map(Listed::files).transpose()?.into_iter().flatten());
    files.push(OutFile::new("report.html", page));
    files.push(OutFile::new("result.json", result::to_json(&result)?));
    files.extend(files::lying_beside(settings, &files));
    files.sort_by(|a, b| a.path.cmp(&b.path));
    Ok(Outcome { result, files, report })
}

//! What options have of the brief of rooms, read again from their written files.

use std::collections::BTreeSet;

use rayon::prelude::*;

use crate::brief::checked;
use crate::job::{Input, Job};
use crate::read;
use crate::round::Round;
use crate::search::brief::is_bare;
use crate::understand::rooms::rooms_with_kinds;
use crate::understand::sensed::Sensed;
use crate::understand::understood;
use crate::works::Drawn;
use crate::write::made::Made;
use enfilade_brief::demand::Weight;
use enfilade_config::{Settings, WorkTable};
use enfilade_overlay::brief_item::BriefItem;
use enfilade_overlay::result::FrontPoint;
use enfilade_overlay::words::listed;
use enfilade_report::{Error, Place, Report, counted};

/// Items that are named one by one.
const TOLD: usize = 4;

/// The options with what they have of the brief. One that breaks a limit which the present layout keeps is left out, and
/// the report says so, unless it is pinned or the search is taken as it is.
///
/// # Errors
/// As reading the written drawing.
pub(crate) fn briefed(round: &Round<'_>, made: Vec<Made>, report: &mut Report) -> Result<Vec<Made>, Error> {
    if round.brief.is_empty() {
        return Ok(made);
    }
    let briefs: Vec<Vec<BriefItem>> =
        made.par_iter().map(|m| brief_of(round.job, m)).collect::<Result<_, Error>>()?;
    let mut broken: BTreeSet<String> = BTreeSet::new();
    let mut kept: Vec<(usize, Made)> = Vec::new();
    let all = made.len();
    for (i, (m, brief)) in made.into_iter().zip(briefs).enumerate() {
        let breaks = broken_limits(round, &brief);
        if breaks.is_empty() || m.is_pinned {
            kept.push((i, Made { brief, ..m }));
        } else {
            broken.extend(breaks);
        }
    }
    if kept.len() < all {
        let what = counted((all - kept.len()) as u64, "option");
        state_left_out(round, &what, &broken, report);
    }
    let places: Vec<usize> = kept.iter().map(|k| k.0).collect();
    let number = |was: usize| places.iter().position(|p| p + 1 == was).map(|p| p + 1);
    let renamed = |(i, (_, mut m)): (usize, (usize, Made))| {
        m.name = format!("candidate-{}", i + 1);
        m.explanation.nearest = m.explanation.nearest.and_then(number);
        m.explanation.from_nearest = m.explanation.from_nearest.filter(|_| m.explanation.nearest.is_some());
        m
    };
    Ok(kept.into_iter().enumerate().map(renamed).collect())
}

/// The points of the front that break no limit which the present layout keeps, numbered anew; the report says how many do.
///
/// # Errors
/// As reading the written drawing.
pub(crate) fn points(
    round: &Round<'_>,
    (points, drawn): (Vec<FrontPoint>, Vec<Option<Drawn>>),
    report: &mut Report,
) -> Result<Vec<FrontPoint>, Error> {
    if round.brief.is_empty() || drawn.len() != points.len() {
        return Ok(points);
    }
    let briefs: Vec<Option<Vec<BriefItem>>> = drawn
        .par_iter()
        .map(|d| d.as_ref().map(|d| brief_in(round.job, &d.bytes, &d.tables)).transpose())
        .collect::<Result<_, Error>>()?;
    let (mut kept, mut broken, all) = (Vec::new(), BTreeSet::new(), points.len());
    for (point, brief) in points.into_iter().zip(briefs) {
        let Some(brief) = brief else { continue };
        let breaks = broken_limits(round, &brief);
        if breaks.is_empty() {
            kept.push(FrontPoint { point: kept.len() + 1, ..point });
        }
        broken.extend(breaks);
    }
    if !broken.is_empty() {
        let what = counted((all - kept.len()) as u64, "point");
        state_left_out(round, &what, &broken, report);
    }
    Ok(kept)
}

/// The best layout with what it has of the brief, unless it breaks a limit which the present layout keeps; the report says
/// so.
///
/// # Errors
/// As reading the written drawing.
pub(crate) fn best(
    round: &Round<'_>,
    made: Option<Made>,
    report: &mut Report,
) -> Result<Option<Made>, Error> {
    let Some(made) = made else { return Ok(None) };
    if round.brief.is_empty() {
        return Ok(Some(made));
    }
    let brief = brief_of(round.job, &made)?;
    let broken: BTreeSet<String> = broken_limits(round, &brief).into_iter().collect();
    if broken.is_empty() {
        return Ok(Some(Made { brief, ..made }));
    }
    state_left_out(round, "the best layout", &broken, report);
    Ok(None)
}

/// The limits that an option breaks and the present layout keeps; nothing where the search is taken as it is.
fn broken_limits(round: &Round<'_>, brief: &[BriefItem]) -> Vec<String> {
    if is_bare(round.job.settings) {
        return Vec::new();
    }
    let is_limit = |b: &&BriefItem| b.weight == Weight::Limit.name();
    let kept: BTreeSet<&str> =
        round.brief.iter().filter(|b| b.verdict == "pass").map(|b| b.ask.as_str()).collect();
    // Without the wall between two rooms nobody can say what one of them has.
    let lost = newly(&round.brief, brief, "untold").filter(|b| kept.contains(b.ask.as_str()));
    newly(&round.brief, brief, "fail").chain(lost).filter(is_limit).map(|b| b.ask.clone()).collect()
}

fn state_left_out(round: &Round<'_>, what: &str, broken: &BTreeSet<String>, report: &mut Report) {
    let named: Vec<&str> = broken.iter().take(TOLD).map(String::as_str).collect();
    let more = if broken.len() > TOLD { ", …" } else { "" };
    let text = format!(
        "{what} left out: a limit of the brief that the present layout keeps would break: {}{more}",
        named.join("; ")
    );
    report.warn("options-brief", Place::file(round.job.input.file()), text);
}

/// The brief of an option, of its drawing read again.
fn brief_of(Job { input, settings }: Job<'_>, made: &Made) -> Result<Vec<BriefItem>, Error> {
    let options = read::read_options(settings);
    let (additions, tables) = match &made.built {
        Some(built) => (&built.additions[..], &built.tables[..]),
        None => (&[][..], &[][..]),
    };
    let bytes = enfilade_cad::patch(input.file(), &input.bytes, &options, &made.all_edits(), additions)?;
    brief_in(Job { input, settings }, &bytes, tables)
}

/// What a written drawing has of the brief.
fn brief_in(
    Job { input, settings }: Job<'_>,
    bytes: &[u8],
    tables: &[WorkTable],
) -> Result<Vec<BriefItem>, Error> {
    // Nothing is searched in it, so what may move is not asked.
    let own = Settings {
        works: [&settings.works[..], tables].concat(),
        moves: Vec::new(),
        ignore_move_markers: true,
        only_marked: true,
        ..settings.clone()
    };
    let input = Input::new(input.path, bytes, input.round);
    let mut silent = Report::default();
    let drawing = read::drawing(input.file(), &input.bytes, &own, &mut silent)?;
    let base = understood(&drawing, &own, &mut silent)?;
    let sensed = Sensed::new(&base, &own);
    let rooms = rooms_with_kinds(&base, &sensed, &own)?;
    let found = checked((&base, &sensed, &rooms), &input, &own, &mut silent)?;
    Ok(found.map_or(Vec::new(), |f| f.items))
}

/// The items that have a verdict in an option and had another at present.
fn newly<'a>(
    present: &'a [BriefItem],
    option: &'a [BriefItem],
    verdict: &'static str,
) -> impl Iterator<Item = &'a BriefItem> {
    let had = move |item: &BriefItem| present.iter().any(|p| p.ask == item.ask && p.verdict == verdict);
    option.iter().filter(move |item| item.verdict == verdict && !had(item))
}

/// What an option changes of the brief, as sentences; empty where nothing.
pub(crate) fn words(present: &[BriefItem], option: &[BriefItem]) -> String {
    let said = |verdict: &'static str| -> Vec<String> {
        newly(present, option, verdict).map(|i| format!("`{}`", i.ask)).take(TOLD).collect()
    };
    let (meets, breaks) = (said("pass"), said("fail"));
    let mut out = String::new();
    if !meets.is_empty() {
        out += &format!(" It meets {} of the brief now.", listed(&meets, "and"));
    }
    if !breaks.is_empty() {
        out += &format!(" It no longer meets {} of the brief.", listed(&breaks, "and"));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn item(ask: &str, verdict: &str) -> BriefItem {
        BriefItem { ask: ask.into(), verdict: verdict.into(), ..BriefItem::default() }
    }

    #[test]
    fn what_changes_of_the_brief_is_said() {
        let present = [item("a", "pass"), item("b", "fail"), item("c", "fail"), item("d", "untold")];
        let option = [item("a", "fail"), item("b", "pass"), item("c", "fail"), item("d", "untold")];
        assert_eq!(
            words(&present, &option),
            " It meets `b` of the brief now. It no longer meets `a` of the brief."
        );
        assert_eq!(words(&present, &present), "");
    }
}

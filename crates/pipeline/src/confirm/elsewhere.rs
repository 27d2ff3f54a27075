//! Other ideas on purpose: the best layouts often share one or two moves that hide all else, so the search looks again
//! without them.

use crate::confirm::found::shown;
use crate::confirm::refined::without_each;
use crate::search::brief::{Brief, is_bare};
use crate::search::budget::{SEARCHES, SHARE, together};
use crate::search::gain::total_gain;
use crate::search::judged::measured;
use enfilade_config::{Method, Mode};
use enfilade_report::{Cancel, Error};
use enfilade_search::{Evaluation, Point, Search};

/// … each without as many of them as bring this share of its gain, one after the other: two such searches share none.
const HIDING: f64 = 0.35;

/// … but no fewer, or nothing is learned.
const LEAST: u64 = 20;

/// What is found where the moves that the best layout gains most by are held back; nothing in a hurry, or where nothing gains.
///
/// # Errors
/// As [`Search::new`].
pub(crate) fn elsewhere(
    brief: &Brief<'_>,
    outcome: &enfilade_search::Outcome<'_>,
    cancel: &Cancel,
) -> Result<Vec<Point>, Error> {
    let is_wanted =
        brief.settings.mode == Mode::Diverse && brief.settings.members > 1 && !is_bare(brief.settings);
    if !is_wanted || brief.study.is_hurried() || outcome.best.violation > 0.0 {
        return Ok(vec![]);
    }
    let shown = shown(brief, outcome);
    let gain = |p: &Point| if p.violation == 0.0 { total_gain(&shown, &p.values) } else { f64::NEG_INFINITY };
    let Some(best) = outcome.archive.iter().max_by(|a, b| gain(a).total_cmp(&gain(b))) else {
        return Ok(vec![]);
    };
    let whole = gain(best);
    if whole <= 0.0 {
        return Ok(vec![]);
    }
    let units = brief.control.units();
    let cost = |(place, p): (usize, Point)| ((whole - gain(&p)).min(whole), &units[place].0);
    let mut order: Vec<(f64, &Vec<usize>)> = without_each(brief, best).into_iter().map(cost).collect();
    order.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut out = Vec::new();
    let mut left = order.iter();
    for _ in 0..SEARCHES {
        let (mut held, mut hidden) = (Vec::new(), 0.0);
        while hidden < HIDING * whole {
            let Some((costs, unit)) = left.next().filter(|(costs, _)| *costs > 0.0) else { return Ok(out) };
            held.extend(unit.iter().copied());
            hidden += costs;
        }
        out.extend(search_without(brief, best, &held, outcome.evaluations, cancel)?);
    }
    Ok(out)
}

/// A search from the best layout whose free parameters `held` are put back and stay there.
fn search_without(
    brief: &Brief<'_>,
    best: &Point,
    held: &[usize],
    measured_before: u64,
    cancel: &Cancel,
) -> Result<Vec<Point>, Error> {
    let Brief { control, settings, objectives, .. } = brief;
    let start = control.start();
    let (mut bounds, mut from) = (control.bounds(), best.parameters.clone());
    for &k in held {
        (bounds[k], from[k]) = ([start[k]; 2], start[k]);
    }
    let evaluations = ((measured_before as f64 * SHARE) as u64).max(LEAST);
    let mut search = Search::new(enfilade_search::Study {
        bounds,
        start: start.clone(),
        objectives: objectives.iter().map(|o| o.1.clone()).collect(),
        members: 1,
        d_min: 0.0,
        least_share: 1.0,
        seed: settings.seed,
        evaluations: Some(evaluations),
        method: Method::Default,
        mode: Mode::Best,
        batch: together(brief.study, settings),
        seeds: vec![from],
        pinned: 0,
    })?;
    loop {
        cancel.check()?;
        let asked = search.ask();
        if asked.is_empty() {
            break;
        }
        let permitted: Vec<Vec<f64>> = asked.iter().map(|p| control.permit(p)).collect();
        let told = measured(brief, &permitted).into_iter().zip(permitted);
        search.tell(&told.map(|(e, at)| Evaluation { at: Some(at), ..e }).collect::<Vec<_>>());
    }
    Ok(search.outcome().archive.to_vec())
}

//! Options that build: sets of works that differ, made in the drawing, read again and confirmed.

use super::Listed;
use super::builder::{Builder, Set};
use super::made::Drawn;
use super::option::{BuildingOption, Judges};
use super::overhead::Overhead;
use crate::confirm::confirmed;
use crate::confirm::ideas::SAME_MAPS;
use crate::job::Job;
use crate::search::judged::is_firm;
use crate::understand::understood::Understood;
use enfilade_config::{Mode, Settings};
use enfilade_overlay::built::{OptionWork, titles};
use enfilade_overlay::result::FrontPoint;
use enfilade_overlay::result::{Gains, Objective};
use enfilade_report::{Cancel, Error, Place, Report};
use rayon::prelude::*;
use std::sync::Mutex;

/// Whether works are looked for as options: where nobody said what may move, or somebody allowed works. Whoever lets nothing
/// move but what is marked, and marks nothing, has said nothing of works.
pub(crate) fn are_wanted(base: &Understood) -> bool {
    let is_allowed = !base.plan.markers.allowed.is_empty();
    is_allowed || base.moves.are_default
}

/// What was found of works together.
#[derive(Default)]
pub(crate) struct Offered {
    /// The options, the best first; none that reads otherwise than meant.
    pub(crate) options: Vec<BuildingOption>,
    /// The front of gain against effort, the cheapest first.
    pub(crate) front: Vec<FrontPoint>,
    /// The drawings of its points, where they are asked for; none of one that cannot be made.
    pub(crate) drawn: Vec<Option<Drawn>>,
}

/// The options that build, and the front that they are taken from.
///
/// # Errors
/// [`Error::Stopped`].
pub(crate) fn options(
    job: Job<'_>,
    judges: Judges<'_>,
    (listed, layouts, is_briefed): (&Listed, &[Vec<f64>], bool),
    report: &mut Report,
    cancel: &Cancel,
) -> Result<Offered, Error> {
    let mut builder = Builder { job, judges, listed, layouts, known: Mutex::default(), overhead: None };
    let wanted = wanted(job.settings);
    builder.say_budget(report);
    let pinned = builder.pinned(report);
    let (mut sets, front) = builder.sets(cancel)?;
    sets.retain(|s| pinned.iter().all(|p| p.works != s.works || p.moved != s.moved));
    cancel.check()?;
    if !(sets.is_empty() && front.is_empty() && pinned.is_empty()) {
        builder.overhead = Overhead::of(job, judges.study);
    }
    let builder = builder;
    let (least, mut left): (Vec<Set>, Vec<Set>) = sets.into_iter().partition(|s| s.is_least && wanted > 1);
    let mut taking = Taking { builder: &builder, taken: Vec::new(), made: Vec::new(), withheld: 0 };
    taking.keep(pinned, report);
    taking.fill(&mut left, wanted - least.len(), cancel)?;
    taking.take(least, cancel)?;
    taking.fill(&mut left, wanted, cancel)?;
    let Taking { mut made, withheld, .. } = taking;
    if withheld > 0 {
        let text = format!(
            "Options left out because the drawing cannot hold their works, or reads otherwise with them: {withheld}."
        );
        report.info("works-withheld", Place::file(job.input.file()), text);
    }
    let total = |o: &BuildingOption| confirmed::total(judges.objectives, &o.gains);
    let by_gain = |a: &BuildingOption, b: &BuildingOption| total(b).total_cmp(&total(a));
    made.sort_by(|a, b| b.is_pinned.cmp(&a.is_pinned).then_with(|| by_gain(a, b)));
    let points_sure = front.iter().zip(builder.gains(&front)).filter(|(_, g)| builder.is_sure(g));
    let points_sure: Vec<(&Set, Gains)> = points_sure.collect();
    let points = points_sure.iter().enumerate();
    let mut points: Vec<FrontPoint> =
        points.map(|(i, (set, gain))| builder.point(i + 1, set, gain.clone())).collect();
    tell_apart(&mut made, &mut points);
    let sets: Vec<&Set> = points_sure.iter().map(|p| p.0).collect();
    let drawn = if is_briefed { sets.par_iter().map(|s| builder.drawn(s)).collect() } else { Vec::new() };
    Ok(Offered { options: made, front: points, drawn })
}

/// Says that there are points to choose from.
pub(crate) fn say_front(points: &[FrontPoint], file: &str, report: &mut Report) {
    let [first, .., last] = points else { return };
    let ends = [first, last].map(|p| format!("{:.1} m of wall", p.effort.length_m()));
    let text = format!(
        "What more works bring: {} points, from {} to {}; the page lists them, `enfilade accept FILE --point N` takes one.",
        points.len(),
        ends[0],
        ends[1]
    );
    report.info("works-front", Place::file(file), text);
}

/// Says of works with the same name where they are.
fn tell_apart(options: &mut [BuildingOption], points: &mut [FrontPoint]) {
    let all = options.iter().flat_map(|o| &o.works).chain(points.iter().flat_map(|p| &p.works));
    let known: Vec<(String, [[f64; 2]; 2])> = all.map(|w| (w.words.clone(), w.stretch)).collect();
    let place = |works: &mut Vec<OptionWork>| {
        for w in works.iter_mut() {
            if known.iter().any(|(words, stretch)| *words == w.words && *stretch != w.stretch) {
                w.words += &w.place_words();
            }
        }
        titles(works)
    };
    options.iter_mut().for_each(|o| o.title = place(&mut o.works));
    points.iter_mut().for_each(|p| p.words = place(&mut p.works));
}

/// Options that are wanted.
pub(crate) fn wanted(settings: &Settings) -> usize {
    if settings.mode == Mode::Best { 1 } else { settings.members }
}

/// Options on their way.
struct Taking<'a> {
    builder: &'a Builder<'a>,
    /// The sets that are options.
    taken: Vec<Set>,
    made: Vec<BuildingOption>,
    /// How many the drawing cannot hold.
    withheld: usize,
}

impl Taking<'_> {
    /// Takes the first sets that differ from those before, until there are so many options or none is left.
    fn fill(&mut self, left: &mut Vec<Set>, wanted: usize, cancel: &Cancel) -> Result<(), Error> {
        while self.made.len() < wanted {
            let (next, others) = unlike(std::mem::take(left), &self.taken, wanted - self.made.len());
            *left = others;
            if next.is_empty() {
                break;
            }
            self.take(next, cancel)?;
        }
        Ok(())
    }

    /// Takes what somebody pinned, whatever it gains; says what the drawing cannot hold any more.
    fn keep(&mut self, pinned: Vec<Set>, report: &mut Report) {
        let gains = self.builder.gains(&pinned);
        for (set, gains) in pinned.into_iter().zip(gains) {
            match self.builder.make(&set, gains) {
                Some(option) => {
                    self.taken.push(set);
                    self.made.push(option);
                }
                None => self.builder.say_unpinned(&set, report),
            }
        }
    }

    /// Takes those of some sets whose gain is sure and which can be made.
    fn take(&mut self, sets: Vec<Set>, cancel: &Cancel) -> Result<(), Error> {
        let gains = self.builder.gains(&sets);
        cancel.check()?;
        let sure = sets.into_iter().zip(gains).filter(|(s, g)| s.is_legal && self.builder.is_sure(g));
        let sure: Vec<(Set, Gains)> = sure.collect();
        let turn: Vec<Option<BuildingOption>> =
            sure.par_iter().map(|(set, gains)| self.builder.make(set, gains.clone())).collect();
        for ((set, _), option) in sure.into_iter().zip(turn) {
            self.withheld += usize::from(option.is_none());
            let option = option.filter(|o| o.is_within);
            self.taken.extend(option.is_some().then_some(set));
            self.made.extend(option);
        }
        Ok(())
    }
}

/// The first sets that keep the limits and differ from those taken and from each other, and all behind them.
fn unlike(sets: Vec<Set>, taken: &[Set], most: usize) -> (Vec<Set>, Vec<Set>) {
    let mut out: Vec<Set> = Vec::new();
    let mut sets = sets.into_iter().filter(|s| s.is_legal);
    while out.len() < most {
        let Some(set) = sets.next() else { break };
        let is_alike = |o: &Set| o.works == set.works || o.experience.likeness(&set.experience) > SAME_MAPS;
        if !taken.iter().chain(&out).any(is_alike) {
            out.push(set);
        }
    }
    (out, sets.collect())
}

/// Objectives with limits that options which build keep too, where thresholds yield.
pub(crate) fn lowered(
    mut objectives: Vec<Objective>,
    options: &[BuildingOption],
    settings: &Settings,
) -> Vec<Objective> {
    for (i, o) in objectives.iter_mut().enumerate().filter(|_| !is_firm(settings)) {
        o.limit = o.limit_with(options.iter().map(|b| b.values[i]));
    }
    objectives
}

//! Options that build: sets of works that differ, made in the drawing, read again and confirmed.

use super::edits::{built_axis, filling, outlines, thickness_m};
use super::made::Together;
use super::{Floor, Listed, shown};
use crate::confirm::confirmed;
use crate::confirm::ideas::{Experience, SAME_MAPS};
use crate::confirm::refined::{RESERVES, STRIPPED};
use crate::job::Job;
use crate::measure::study::Study;
use crate::measure::worth::Worth;
use crate::search::brief::Aims;
use crate::search::judged::{evaluation, gained, is_firm};
use crate::understand::understood::Understood;
use enfilade_cad::drawing::{Addition, Edit, Filling};
use enfilade_config::{Mode, Settings, WorkTable};
use enfilade_engine::geometry::Segment;
use enfilade_overlay::built::{BuiltWall, Effort, OptionWork, titles};
use enfilade_overlay::picture::{PlanPicture, Stroke};
use enfilade_overlay::result::{Gains, Objective};
use enfilade_overlay::works::{LEAST_SHOWN, WorkEntry};
use enfilade_report::{Cancel, Error, Place, Report};
use enfilade_works::{RoomId, Work};
use glam::DVec2;
use rayon::prelude::*;

/// Single works that are looked at, the best of each pair of rooms: for speed alone, more than are ever shown.
const SINGLES: usize = 12;
/// The best of these of which pairs are looked at: for speed alone, ten pairs at most.
const PAIRED: usize = 5;

/// An option that builds.
pub(crate) struct BuildingOption {
    /// Its works, as `result.json` has them.
    pub(crate) works: Vec<OptionWork>,
    /// Their names in one line.
    pub(crate) title: String,
    /// Whether more of a private room is seen while its door stands open.
    shows_private: bool,
    /// What they cost together.
    pub(crate) effort: Effort,
    /// Of the objectives, as the layouts of the search have them.
    pub(crate) values: Vec<f64>,
    /// Whether it keeps the thresholds of the search.
    pub(crate) is_within: bool,
    /// Confirmed gains.
    pub(crate) gains: Gains,
    /// What the file is worth, read again.
    pub(crate) worth: Worth,
    /// How the works are written.
    pub(crate) edits: Vec<Edit>,
    /// What was demolished, drawing units.
    pub(crate) additions: Vec<Addition>,
    /// What the drawing cannot hold: decided in the side-car.
    pub(crate) tables: Vec<WorkTable>,
    /// What goes, and what is built, plan frame.
    pub(crate) strokes: Vec<Stroke>,
    /// The plan with the works.
    pub(crate) picture: PlanPicture,
    /// What there is to say.
    pub(crate) report: Report,
}

/// Said of works that are allowed since doors of private rooms are shut.
const SHOWS_PRIVATE: &str = "It shows more of a private room while that room's door stands open";

impl BuildingOption {
    /// `An opening of 1.8 m between kitchen and living room; visibility +9 % (8 to 10 %). 1.8 m of wall goes.`
    pub(crate) fn words(&self, gains: &str) -> String {
        let first = [self.title.as_str(), gains].into_iter().filter(|l| !l.is_empty());
        let first = first.collect::<Vec<_>>().join("; ");
        std::iter::once(first).chain(self.costs()).map(|s| s + ".").collect::<Vec<_>>().join(" ")
    }

    /// The same in lines for the note in the drawing.
    pub(crate) fn note_lines(&self, gains: &str) -> Vec<String> {
        let first = [self.title.as_str(), gains].into_iter().filter(|l| !l.is_empty()).map(str::to_owned);
        first.chain(self.costs()).collect()
    }

    /// What it costs.
    fn costs(&self) -> impl Iterator<Item = String> {
        let private = if self.shows_private { SHOWS_PRIVATE } else { "" };
        [self.effort.words(), private.to_owned()].into_iter().filter(|s| !s.is_empty())
    }
}

/// Whether works are looked for as options: where nobody said what may move, or somebody allowed works. Whoever lets nothing
/// move but what is marked, and marks nothing, has said nothing of works.
pub(crate) fn are_wanted(base: &Understood) -> bool {
    let is_allowed = !base.plan.markers.allowed.is_empty();
    is_allowed || base.moves.are_default
}

/// Works that are made together, with what is known of them on the lattice shown.
#[derive(Clone)]
struct Set {
    /// Places in the list, ascending.
    works: Vec<usize>,
    lines: Vec<Segment>,
    gain: f64,
    /// Mean degree with it.
    degree: f64,
    /// Whether it keeps the limits.
    is_legal: bool,
    experience: Experience,
}

/// What options that build are judged by.
#[derive(Clone, Copy)]
pub(crate) struct Judges<'a> {
    /// On the lattice that is shown.
    pub(crate) study: &'a Study,
    /// On the lattices that are searched on.
    pub(crate) trial: &'a Study,
    /// What is asked for.
    pub(crate) objectives: &'a Aims,
    /// The same as results tell it, with what options keep.
    pub(crate) told: &'a [Objective],
}

/// Finds sets of works.
struct Builder<'a> {
    job: Job<'a>,
    judges: Judges<'a>,
    listed: &'a Listed,
}

/// The options that build, the best first; none that reads otherwise than meant.
///
/// # Errors
/// [`Error::Stopped`].
pub(crate) fn options(
    job: Job<'_>,
    judges: Judges<'_>,
    listed: &Listed,
    report: &mut Report,
    cancel: &Cancel,
) -> Result<Vec<BuildingOption>, Error> {
    let Judges { study, objectives, .. } = judges;
    let builder = Builder { job, judges, listed };
    let wanted = wanted(job.settings);
    builder.say_budget(report);
    let sets = unlike(builder.sets(cancel)?, wanted + RESERVES);
    cancel.check()?;
    let gains = confirmed::gains_of(study, job.settings, objectives, sets.len(), &|on| {
        sets.par_iter().map(|s| on.measure_walls(&s.lines)).collect()
    });
    cancel.check()?;
    let sure = sets.iter().zip(gains);
    let sure: Vec<_> =
        sure.filter(|(_, g)| confirmed::is_confirmed(objectives, g, job.settings.least_gain)).collect();
    let made: Vec<Option<BuildingOption>> =
        sure.into_par_iter().map(|(set, gains)| builder.make(set, gains)).collect();
    let withheld = made.iter().filter(|m| m.is_none()).count();
    if withheld > 0 {
        let text = format!(
            "Options left out because the drawing cannot hold their works, or reads otherwise with them: {withheld}."
        );
        report.info("works-withheld", Place::file(job.input.file()), text);
    }
    let mut out: Vec<BuildingOption> = made.into_iter().flatten().filter(|o| o.is_within).collect();
    out.sort_by(|a, b| {
        confirmed::total(objectives, &b.gains).total_cmp(&confirmed::total(objectives, &a.gains))
    });
    out.truncate(wanted);
    tell_apart(&mut out);
    Ok(out)
}

/// Says of options with the same name where their works are.
fn tell_apart(options: &mut [BuildingOption]) {
    let names: Vec<String> = options.iter().map(|o| o.title.clone()).collect();
    for option in options.iter_mut() {
        if names.iter().filter(|n| **n == option.title).count() > 1 {
            option.works.iter_mut().for_each(|w| w.words += &w.place_words());
            option.title = titles(&option.works);
        }
    }
}

/// Options that are wanted.
pub(crate) fn wanted(settings: &Settings) -> usize {
    if settings.mode == Mode::Best { 1 } else { settings.members }
}

/// The sets that keep the limits and differ from those before. One of several works is an idea of its own, however alike
/// what is seen: it costs more and brings more. A second one would share its best works.
fn unlike(sets: Vec<Set>, most: usize) -> Vec<Set> {
    let mut out: Vec<Set> = Vec::new();
    for set in sets.into_iter().filter(|s| s.is_legal) {
        let is_several = set.works.len() > 1;
        let is_alike = |o: &Set| match is_several || o.works.len() > 1 {
            true => is_several && o.works.len() > 1,
            false => o.experience.likeness(&set.experience) > SAME_MAPS,
        };
        if out.len() < most && !out.iter().any(is_alike) {
            out.push(set);
        }
    }
    out
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

impl Builder<'_> {
    fn floor(&self) -> &Floor {
        &self.listed.floor
    }

    fn work(&self, place: usize) -> &Work {
        &self.listed.found[place]
    }

    /// Whether the budget holds works together.
    fn is_within_budget(&self, works: &[usize]) -> bool {
        let entries = works.iter().filter_map(|w| self.listed.result.works.get(*w));
        self.job.settings.budget.holds(works.len(), entries.map(|e| e.effort.length_m()).sum())
    }

    /// Says what costs more than the budget holds.
    fn say_budget(&self, report: &mut Report) {
        let dear = |e: &WorkEntry| e.is_allowed && !self.is_within_budget(&[e.id - 1]);
        let count = self.listed.result.works.iter().filter(|e| dear(e)).count();
        let result = &self.listed.result;
        let Some(best) = result.different_of(1, dear).first().map(|e| result.line(e)) else { return };
        let text = format!(
            "Works that cost more than `--budget \"{}\"`: {count}. The best of them: {best}.",
            self.job.settings.budget
        );
        report.info("works-budget", Place::file(self.job.input.file()), text);
    }

    /// Single works by what they gain, then the best pair and what a third adds to it; all that gain.
    fn sets(&self, cancel: &Cancel) -> Result<Vec<Set>, Error> {
        let may = |e: &WorkEntry| e.is_allowed && self.is_within_budget(&[e.id - 1]);
        let entries = self.listed.result.different_of(SINGLES, may);
        let singles: Vec<Vec<usize>> = entries.iter().map(|e| vec![e.id - 1]).collect();
        let singles = self.measured(singles);
        cancel.check()?;
        let best: Vec<usize> = singles.iter().take(PAIRED).map(|s| s.works[0]).collect();
        let pairs = best.iter().enumerate().flat_map(|(i, a)| best[i + 1..].iter().map(|b| [*a, *b]));
        let pairs = pairs.filter(|p| self.go_together(p[0], p[1]) && self.is_within_budget(p));
        let pairs = pairs.map(|p| p.to_vec()).collect();
        let mut sets = self.longer(self.measured(pairs), &singles);
        cancel.check()?;
        if let Some(pair) = sets.first().cloned() {
            let third = best.iter().filter(|c| pair.works.iter().all(|w| self.go_together(*w, **c)));
            let triples = third.map(|c| [&pair.works[..], &[*c]].concat());
            let triples = triples.filter(|t| self.is_within_budget(t)).collect();
            let triples = self.longer(self.measured(triples), std::slice::from_ref(&pair));
            sets.splice(0..0, triples);
        }
        // The room that one more set takes is the last single's.
        let free = wanted(self.job.settings).saturating_sub(1).min(singles.len());
        let mut out = singles;
        out.splice(free..free, sets);
        Ok(out)
    }

    /// Those of longer sets in which each work more brings its share, over the best set that they hold.
    fn longer(&self, sets: Vec<Set>, shorter: &[Set]) -> Vec<Set> {
        let holds = |set: &Set, part: &Set| part.works.iter().all(|w| set.works.contains(w));
        let pays = |set: &Set| {
            let parts = shorter.iter().filter(|s| holds(set, s)).map(|s| s.gain);
            set.gain * (1.0 - STRIPPED) >= parts.fold(0.0, f64::max)
        };
        sets.into_iter().filter(pays).collect()
    }

    /// Whether two works touch neither the same wall nor join the same rooms.
    fn go_together(&self, a: usize, b: usize) -> bool {
        let (a, b) = (self.work(a), self.work(b));
        let sorted = |mut pair: [Option<RoomId>; 2]| {
            pair.sort_unstable();
            pair
        };
        a.walls.iter().all(|w| !b.walls.contains(w)) && sorted(a.rooms) != sorted(b.rooms)
    }

    /// Sets with what they gain, those that gain most first.
    fn measured(&self, sets: Vec<Vec<usize>>) -> Vec<Set> {
        let Self { job: Job { settings, .. }, judges: Judges { study, objectives, .. }, .. } = *self;
        let one = |works: Vec<usize>| {
            let drawn = self.floor().obstacles.segments.clone();
            let lines = works.iter().fold(drawn, |lines, w| self.work(*w).change.apply(&lines));
            let worth = study.measure_walls(&lines);
            // A pair may keep a limit that neither of the two keeps alone.
            let is_legal = evaluation(study, settings, objectives, &worth).violation == 0.0;
            let gain = gained(study, settings, objectives, &worth);
            let (degree, experience) = (worth.seen.means.degree, Experience::of(study, &worth));
            Set { works, lines, gain, degree, is_legal, experience }
        };
        let found: Vec<Set> = sets.into_par_iter().map(one).collect();
        let mut out: Vec<Set> = found.into_iter().filter(|s| s.gain > 0.0).collect();
        // What shows more of a private room, if only through its open door, comes last.
        let shows = |s: &Set| s.works.iter().any(|w| self.work(*w).shows_through_doors);
        out.sort_by(|a, b| shows(a).cmp(&shows(b)).then_with(|| b.gain.total_cmp(&a.gain)));
        out
    }

    /// The drawing with a set; `None` where it cannot be made, or reads otherwise than meant.
    fn make(&self, set: &Set, gains: Gains) -> Option<BuildingOption> {
        let Self { job, judges: Judges { study, trial, told, objectives }, .. } = *self;
        let works: Vec<(usize, &Work)> = set.works.iter().map(|w| (w + 1, self.work(*w))).collect();
        let made = Together::make(job, (study, self.floor()), &works).ok()?;
        let worth = study.measure_walls(&made.lines);
        if (worth.seen.means.degree - set.degree).abs() > LEAST_SHOWN * study.initial.seen.means.degree {
            return None;
        }
        let entries: Vec<&WorkEntry> =
            set.works.iter().filter_map(|w| self.listed.result.works.get(*w)).collect();
        let values = evaluation(trial, job.settings, objectives, &trial.measure_walls(&made.lines)).values;
        let (plain, walls) = (works.iter().map(|w| w.1).collect::<Vec<_>>(), &self.floor().walls);
        let none = Effort::default();
        let told_works: Vec<OptionWork> =
            works.iter().zip(&entries).map(|((_, work), entry)| self.told(work, entry)).collect();
        Some(BuildingOption {
            title: titles(&told_works),
            works: told_works,
            effort: entries.iter().fold(none, |all, e| all.and(&e.effort)),
            // Thresholds that yield are lowered to what options keep.
            is_within: !is_firm(job.settings) || told.iter().zip(&values).all(|(o, v)| o.keeps(*v)),
            values,
            gains,
            worth,
            strokes: shown::strokes(&study.base, walls, &plain),
            picture: shown::picture(&study.base, walls, &plain),
            shows_private: plain.iter().any(|w| w.shows_through_doors),
            edits: made.written.edits,
            additions: made.written.additions,
            tables: made.written.tables,
            report: made.report,
        })
    }

    /// A work as `result.json` has it.
    fn told(&self, work: &Work, entry: &WorkEntry) -> OptionWork {
        let (base, walls) = (&self.judges.study.base, &self.floor().walls);
        let mm = |v: f64| (v * 1e3).round() / 1e3 + 0.0;
        let at = |p: DVec2| base.plan.frame.drawing_m_from_plan(p).map(mm);
        let built = built_axis(base, work)
            .map(|axis| BuiltWall { ends: axis.map(at), thickness_m: mm(thickness_m(base, walls, work)) });
        let opening = work.opening.and_then(|k| base.axes.openings.get(k));
        let filling = match filling(work) {
            Filling::Door => "door",
            Filling::Glass => "glass",
            Filling::Nothing | Filling::Gone => "nothing",
        };
        OptionWork {
            kind: entry.kind.clone(),
            words: self.listed.result.title(entry),
            stretch: entry.stretch,
            width_m: entry.width_m,
            rooms: entry.rooms,
            elements: entry.wall.clone(),
            effort: entry.effort,
            demolished: outlines(base, walls, work).into_iter().map(|o| o.map(at)).collect(),
            built: built.into_iter().collect(),
            filling: filling.into(),
            opening: opening.map(|o| o.jambs.map(|j| at(j.at * base.plan.human_scale))),
        }
    }
}

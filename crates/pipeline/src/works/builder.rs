//! Finds sets of works, measures them, and makes options of them.

use super::edits::{built_axis, filling, outlines, thickness_m};
use super::made::{Drawn, Moved, Together};
use super::option::{BuildingOption, Judges};
use super::overhead::Overhead;
use super::sets::{BEST, Counted, MOST, Sets, front, paying, sort};
use super::{Floor, Listed, shown, whole_mm};
use crate::confirm::confirmed;
use crate::confirm::ideas::Experience;
use crate::confirm::refined::{LEAST_CHANGE, STRIPPED};
use crate::job::Job;
use crate::measure::obstacles::stopping;
use crate::search::judged::{evaluation, gained, is_firm};
use crate::write::{show, traces};
use enfilade_cad::drawing::Filling;
use enfilade_config::Mode;
use enfilade_engine::geometry::Segment;
use enfilade_overlay::built::{BuiltWall, Effort, OptionWork, titles};
use enfilade_overlay::result::{FrontPoint, Gains, Numbers};
use enfilade_overlay::works::{LEAST_SHOWN, WorkEntry};
use enfilade_report::{Cancel, Error, Place, Report};
use enfilade_works::{Work, WorkKind};
use glam::DVec2;
use rayon::prelude::*;
use std::sync::{Mutex, OnceLock, PoisonError};

/// Single works that are measured in all that is asked for, the best of each pair of rooms: for speed alone.
const SINGLES: usize = 12;
/// Sets of two and of three that are, the best: for speed alone.
const TOGETHER: usize = 5;
/// Sets of two and of three that are counted in other sizes, the best: for speed alone.
const SEEDS: [usize; 2] = [5, 2];
/// Sizes that each of their works is tried in, as far apart in gain as they go: for speed alone.
const SIZES: usize = 5;
/// Points of the front of gain against effort.
const POINTS: usize = 8;
/// From one point to the next at least this share of the most is gained: nobody pays for a smaller step.
const POINT_STEP: f64 = 0.05;

/// Works that are made together, with their measures on the lattice shown.
#[derive(Clone)]
pub(super) struct Set {
    /// Places in the list, ascending.
    pub(super) works: Vec<usize>,
    /// Wall that goes and wall that is built, metres.
    pub(super) effort_m: f64,
    /// What moves besides.
    pub(super) moved: Moved,
    /// What stops sight with them, drawing frame, micrometres.
    pub(super) lines: Vec<Segment>,
    /// Sum of the relative gains in all objectives.
    pub(super) gain: f64,
    /// Means of the layout with them.
    pub(super) mean: Numbers,
    /// Mean degree with it.
    pub(super) degree: f64,
    /// Whether it keeps the limits.
    pub(super) is_legal: bool,
    /// Whether it is the least that brings half of what the best does.
    pub(super) is_least: bool,
    /// Whether somebody pinned it.
    pub(super) is_pinned: bool,
    pub(super) experience: Experience,
}

/// What a set does: its works, and the parameters of what moves.
type Asked = (Vec<usize>, Vec<f64>);

impl Set {
    fn asked(&self) -> Asked {
        (self.works.clone(), self.moved.parameters.clone())
    }
}

/// Every work that gains alone, the sets of those among which sets are looked for, and the best of these in other sizes: all
/// that the budget holds, those that show most first.
///
/// # Errors
/// [`Error::Stopped`].
fn in_sizes(
    sets: &Sets<'_>,
    (among, gaining): (&[usize], &[usize]),
    cancel: &Cancel,
) -> Result<Vec<Counted>, Error> {
    let counted = paying(sets.all(among, cancel)?, STRIPPED);
    let singles = sets.singles(gaining);
    let mut all = [&counted[..], &singles].concat();
    let like = |w: &usize| -> Vec<Counted> {
        singles.iter().filter(|s| sets.joins_same(*w, s.works[0])).cloned().collect()
    };
    let sizes = |w: &usize| front(&like(w), 0.0, SIZES).iter().map(|s| s.works[0]).collect();
    for (count, seeds) in [(2, SEEDS[0]), (3, SEEDS[1])] {
        for seed in counted.iter().filter(|s| s.works.len() == count).take(seeds) {
            all.extend(sets.sizes(&seed.works.iter().map(sizes).collect::<Vec<_>>(), cancel)?);
        }
    }
    sort(&mut all);
    all.retain(|s| sets.is_within(s));
    Ok(all)
}

/// Those of sets that gain more than all cheaper ones in what is asked for, the cheapest first.
fn rising(mut sets: Vec<Set>) -> Vec<Set> {
    sets.sort_by(|a, b| a.effort_m.total_cmp(&b.effort_m));
    let mut most = 0.0;
    sets.retain(|s| {
        s.gain > most && {
            most = s.gain;
            true
        }
    });
    sets
}

/// Finds sets of works.
pub(super) struct Builder<'a> {
    pub(super) job: Job<'a>,
    pub(super) judges: Judges<'a>,
    pub(super) listed: &'a Listed,
    /// The layouts that the search found, the best first.
    pub(super) layouts: &'a [Vec<f64>],
    /// What sets gain that were confirmed already: options are points of the front too.
    pub(super) known: Mutex<Vec<(Asked, Gains)>>,
    /// The storey above, where there is one.
    pub(super) overhead: Option<Overhead>,
}

impl<'a> Builder<'a> {
    pub(super) fn floor(&self) -> &'a Floor {
        &self.listed.floor
    }

    pub(super) fn work(&self, place: usize) -> &Work {
        &self.listed.found[place]
    }

    /// Whether the budget holds a work alone.
    fn is_within_budget(&self, entry: &WorkEntry) -> bool {
        self.job.settings.budget.holds(1, entry.effort.length_m())
    }

    /// What sets gain, each confirmed once.
    pub(super) fn gains(&self, sets: &[Set]) -> Vec<Gains> {
        let Judges { study, objectives, .. } = self.judges;
        // Locked for a moment only: what is measured between takes all threads.
        let known = || self.known.lock().unwrap_or_else(PoisonError::into_inner);
        let of = |s: &Set| known().iter().find(|k| k.0 == s.asked()).map(|k| k.1.clone());
        let new: Vec<&Set> = sets.iter().filter(|s| of(s).is_none()).collect();
        let gains = confirmed::gains_of(study, self.job.settings, objectives, new.len(), &|on| {
            new.par_iter().map(|s| on.measure_built(&s.moved.layout, &s.lines)).collect()
        });
        known().extend(new.iter().map(|s| s.asked()).zip(gains));
        sets.iter().map(|s| of(s).unwrap_or_default()).collect()
    }

    pub(super) fn is_sure(&self, gains: &Gains) -> bool {
        confirmed::is_confirmed(self.judges.objectives, gains, self.job.settings.least_gain)
    }

    /// Says what costs more than the budget holds.
    pub(super) fn say_budget(&self, report: &mut Report) {
        let dear = |e: &WorkEntry| e.is_allowed && !self.is_within_budget(e);
        let count = self.listed.result.works.iter().filter(|e| dear(e)).count();
        let result = &self.listed.result;
        let Some(best) = result.different_of(1, dear).first().map(|e| result.line(e)) else { return };
        let text = format!(
            "Single works that cost more than `--budget \"{}\"`: {count}. The best of them: {best}.",
            self.job.settings.budget
        );
        report.info("works-budget", Place::file(self.job.input.file()), text);
    }

    /// Sets in the order in which they are options: those that gain most first, the least change that brings half last, whose
    /// place is kept. And the front of gain against effort.
    pub(super) fn sets(&self, cancel: &Cancel) -> Result<(Vec<Set>, Vec<Set>), Error> {
        let may = |e: &WorkEntry| e.is_allowed;
        let result = &self.listed.result;
        let most = BEST / self.judges.study.thinned();
        let places = |of: Vec<&WorkEntry>| of.iter().map(|e| e.id - 1).collect::<Vec<_>>();
        let (among, gaining) = (places(result.different_of(most, may)), places(result.gaining(may)));
        let site = self.floor().site(self.judges.study);
        let works = &self.listed.found;
        let alone: Vec<OnceLock<i64>> = works.iter().map(|_| OnceLock::new()).collect();
        let sets = Sets { site: &site, works, budget: self.job.settings.budget, alone: &alone };
        let all = in_sizes(&sets, (&among, &gaining), cancel)?;
        let is_whole = |w: &usize| self.work(*w).kind == WorkKind::Remove && !among.contains(w);
        let small = all.iter().filter(|s| !s.works.iter().any(is_whole)).cloned();
        let small = sets.different(paying(small.collect(), STRIPPED));
        let best = |count: usize| {
            let of = small.iter().filter(move |s| s.works.len() == count);
            of.filter(|s| !sets.show_more_together(&s.works)).take(TOGETHER)
        };
        let alone = small.iter().filter(|s| s.works.len() == 1).take(SINGLES);
        let several: Vec<Counted> = (2..=MOST).flat_map(best).chain(alone).cloned().collect();
        cancel.check()?;
        let mut sets_found = self.measured(several);
        cancel.check()?;
        let points = front(&all, POINT_STEP, POINTS);
        let points = points.into_iter().filter(|s| !sets.show_more_together(&s.works)).collect();
        let points = rising(self.measured(points).into_iter().filter(|s| s.is_legal).collect());
        if self.job.settings.mode == Mode::Best {
            sets_found.splice(0..0, points.last().cloned());
        }
        if let Some(more) = self.with_moves(&sets_found, cancel)? {
            sets_found.insert(0, more);
        }
        let legal = sets_found.iter().filter(|s| s.is_legal);
        if let Some(best) = legal.reduce(|a, b| if b.gain > a.gain { b } else { a }) {
            let brings_half = |s: &&Set| s.gain >= LEAST_CHANGE * best.gain;
            let least = points.iter().find(brings_half).filter(|s| s.effort_m < best.effort_m);
            let least = least.map(|s| Set { is_least: true, ..s.clone() });
            sets_found.retain(|s| least.as_ref().is_none_or(|l| l.works != s.works || s.moved.is_any()));
            sets_found.extend(least);
        }
        Ok((sets_found, points))
    }

    /// Sets with what they gain, those that gain most first.
    fn measured(&self, sets: Vec<Counted>) -> Vec<Set> {
        let study = self.judges.study;
        let still = Moved::none(&study.base);
        let one = |set: Counted| self.set(set.works, set.effort_m, still.clone());
        let found: Vec<Set> = sets.into_par_iter().map(one).collect();
        let mut out: Vec<Set> = found.into_iter().filter(|s| s.gain > 0.0).collect();
        // What shows more of a private room, if only through its open door, comes last.
        let shows = |s: &Set| s.works.iter().any(|w| self.work(*w).shows_through_doors);
        out.sort_by(|a, b| shows(a).cmp(&shows(b)).then_with(|| b.gain.total_cmp(&a.gain)));
        out
    }

    /// Works, and what moves beside them, measured.
    pub(super) fn set(&self, works: Vec<usize>, effort_m: f64, moved: Moved) -> Set {
        let Self { job: Job { settings, .. }, judges: Judges { study, objectives, .. }, .. } = *self;
        let drawn = stopping(&study.base, &moved.layout);
        let lines = works.iter().fold(drawn, |lines, w| self.work(*w).change.apply(&lines));
        let worth = study.measure_built(&moved.layout, &lines);
        // A pair may keep a limit that neither of the two keeps alone.
        let is_legal = evaluation(study, settings, objectives, &worth).violation == 0.0;
        let gain = gained(study, settings, objectives, &worth);
        let (degree, experience) = (worth.seen.means.degree, Experience::of(study, &worth));
        let mean = show::mean_numbers(study, &worth);
        Set {
            works,
            effort_m,
            moved,
            lines,
            gain,
            mean,
            degree,
            is_legal,
            is_least: false,
            is_pinned: false,
            experience,
        }
    }

    /// A point of the front.
    pub(super) fn point(&self, point: usize, set: &Set, gain: Gains) -> FrontPoint {
        let works = self.told_all(set);
        let effort = works.iter().fold(Effort::default(), |all, w| all.and(&w.effort));
        let effort =
            Effort { demolished_m: whole_mm(effort.demolished_m), built_m: whole_mm(effort.built_m) };
        let shows_private = set.works.iter().any(|w| self.work(*w).shows_through_doors);
        let mean = set.mean.clone();
        FrontPoint { point, words: titles(&works), gain, mean, effort, shows_private, works, option: None }
    }

    /// The drawing with a set; none where it cannot be made.
    pub(super) fn drawn(&self, set: &Set) -> Option<Drawn> {
        let works: Vec<(usize, &Work)> = set.works.iter().map(|w| (w + 1, self.work(*w))).collect();
        let made = Together::make(self.job, (self.judges.study, self.floor()), &works, &set.moved).ok()?;
        Some(Drawn { bytes: made.bytes, tables: made.written.tables })
    }

    pub(super) fn told_all(&self, set: &Set) -> Vec<OptionWork> {
        let told = |w: &usize| self.told(self.work(*w), &self.listed.result.works[*w]);
        set.works.iter().map(told).collect()
    }

    /// The drawing with a set; `None` where it cannot be made, or reads otherwise than meant.
    pub(super) fn make(&self, set: &Set, gains: Gains) -> Option<BuildingOption> {
        let Self { job, judges: Judges { study, trial, told, objectives }, .. } = *self;
        let works: Vec<(usize, &Work)> = set.works.iter().map(|w| (w + 1, self.work(*w))).collect();
        let made = Together::make(job, (study, self.floor()), &works, &set.moved).ok()?;
        let layout = &set.moved.layout;
        let worth = study.measure_built(layout, &made.lines);
        if (worth.seen.means.degree - set.degree).abs() > LEAST_SHOWN * study.initial.seen.means.degree {
            return None;
        }
        let values =
            evaluation(trial, job.settings, objectives, &trial.measure_built(layout, &made.lines)).values;
        let (plain, walls) = (works.iter().map(|w| w.1).collect::<Vec<_>>(), &self.floor().walls);
        let told_works = self.told_all(set);
        Some(BuildingOption {
            title: titles(&told_works),
            effort: told_works.iter().fold(Effort::default(), |all, w| all.and(&w.effort)),
            works: told_works,
            is_least: set.is_least,
            is_pinned: set.is_pinned,
            breaks: if set.is_pinned { self.broken(set, &worth) } else { Vec::new() },
            // Thresholds that yield are lowered to what options keep.
            is_within: set.is_pinned
                || !is_firm(job.settings)
                || told.iter().zip(&values).all(|(o, v)| o.keeps(*v)),
            values,
            gains,
            worth,
            strokes: [shown::strokes(&study.base, walls, &plain), traces::of(&study.base, layout).now]
                .concat(),
            picture: shown::picture(&study.base, walls, &plain, &set.moved),
            moved: set.moved.clone(),
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
        let at = |p: DVec2| base.plan.frame.drawing_m_from_plan(p).map(whole_mm);
        let built = built_axis(base, work).map(|axis| BuiltWall {
            ends: axis.map(at),
            thickness_m: whole_mm(thickness_m(base, walls, work)),
        });
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
            above: self.overhead.as_ref().and_then(|o| o.over(base, &outlines(base, walls, work))),
        }
    }
}

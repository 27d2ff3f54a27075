//! From what a search measured to what is shown: the best ranked on more lattices, ideas that differ, each without the
//! moves that bring nothing, and confirmed on lattices of their own.

use crate::confirm::confirmed;
use crate::confirm::ideas::{Experience, SAME_MAPS, Stance, moves_visibly};
use crate::confirm::sound::is_sound;
use crate::confirm::stripped::Stripper;
use crate::measure::lattices;
use crate::measure::seen::Use;
use crate::measure::study::Study;
use crate::measure::worth::Worth;
use crate::search::brief::Brief;
use crate::search::budget;
use crate::search::gain::total_gain;
use crate::search::judged::{evaluation, gained, is_firm, pinned};
use enfilade_overlay::result::{Gains, Objective};
use enfilade_search::{Member, Outcome, Point, normalised_distance};

/// Share of the best gain, all objectives together, that an option keeps at least where nobody stated thresholds.
const YIELDING_SHARE: f64 = 0.5;
/// Layouts whose experience is looked at, the best of all that keep the thresholds, …
const EXPERIENCED: usize = 200;
/// … the same of those looked for beside the search, …
const EXPERIENCED_BESIDE: usize = 50;
/// … and the best of these, of which each is looked at without one move after the other; …
const TAKEN_APART: usize = 4;
/// … layouts of these that are ranked again. On large plans fewer of each, as the search measures fewer; but twice as many are
/// ranked as are wanted.
const RANKED: usize = 32;
/// From so many layouts on the lattices that they are ranked on are prepared: gallery, museum hall and flat, 19 to 32 layouts,
/// 6 to 60 ms to prepare and 3 to 30 ms less for each (`BENCHMARKS.md`).
const PREPARED: usize = 16;
/// Lattices that layouts are ranked on, heat by heat: from one to the next the better half goes on …
const HEATS: [usize; 3] = [2, 2, 4];
const _: () = assert!(HEATS[0] + HEATS[1] + HEATS[2] == lattices::RANKED as usize);
/// … and at least so many, or all that are wanted.
const FINALISTS: usize = 8;
/// Ideas taken beyond those wanted, for those that are not confirmed.
pub(crate) const RESERVES: usize = 2;
/// Share of an option's gain that moves may cost together which are taken back: a tenth is what a fifth wall must bring.
pub(crate) const STRIPPED: f64 = 0.1;
/// What the least change brings of the best layout's gain: half of it.
pub(crate) const LEAST_CHANGE: f64 = 0.5;
/// Points taken for their gain stand at least so far from each other, as a share of the largest distance.
const APART: f64 = 0.05;

/// See the module.
#[derive(Default)]
pub(crate) struct Refined {
    /// The options: pinned first, then the best first.
    pub(crate) members: Vec<Member>,
    /// Of every option.
    pub(crate) gains: Vec<Gains>,
    /// The best layout of all with its gains, all its moves as the search found them; another where that one gains nothing
    /// for sure.
    pub(crate) best: Option<(Member, Gains)>,
    /// Ideas left out since they are experienced as others are.
    pub(crate) alike: usize,
    /// Ideas left out since their gain was not confirmed.
    pub(crate) unconfirmed: usize,
}

/// A layout with what people experience in it.
struct Idea {
    member: Member,
    experience: Experience,
    stance: Stance,
}

impl Idea {
    fn of(brief: &Brief<'_>, member: Member, worth: &Worth) -> Self {
        let base = &brief.study.base;
        let layout = base.moves.apply(&base.plan, &base.graph, &member.parameters);
        Self {
            experience: Experience::of(brief.study, worth),
            stance: Stance::of(brief.study, &layout),
            member,
        }
    }

    /// How alike two are: 1 where nobody could tell them apart.
    fn likeness(&self, other: &Self) -> f64 {
        let is_same = self.stance.overlays(&other.stance);
        if is_same { 1.0 } else { self.experience.likeness(&other.experience) }
    }
}

/// The options of a finished search, and of `others` that were looked for beside it.
pub(crate) fn refined(
    brief: &Brief<'_>,
    outcome: &Outcome<'_>,
    others: &[Point],
    shown: &[Objective],
) -> Refined {
    let pins = pinned(brief.settings).min(outcome.members.len());
    let whole = |m: &Member| Member { parameters: brief.control.expand(&m.parameters), ..m.clone() };
    let kept: Vec<Member> = outcome.members[..pins].iter().map(whole).collect();
    let stripper = Stripper { brief, shown, thresholds: &outcome.thresholds };
    let ranked = ranked(brief, pool(brief, outcome, others, shown, &stripper));
    let sure_gain = |(m, g): &(Member, Gains)| {
        confirmed::sure_gain(brief.objectives, g).filter(|_| is_sound(brief, &m.parameters))
    };
    let is_confirmed =
        |found: &(Member, Gains)| sure_gain(found).is_some_and(|g| g >= brief.settings.least_gain);
    let mut out = Refined::default();
    let mut layouts = kept;
    let best = ranked.first().map(|r| r.member.clone());
    if let Some(best) = &best {
        let wanted = brief.settings.members - pins + RESERVES;
        let (ideas, alike) = unlike(brief, &layouts, ranked, wanted);
        out.alike = alike;
        let mut options =
            Options { stripper: &stripper, left: ideas.into_iter(), taken: Vec::new(), alike: 0 };
        let free = brief.settings.members - pins;
        options.take((free - 1).max(1));
        if free > 1 {
            options.take_least(best);
        }
        options.take(free);
        layouts.extend(options.members(0));
        layouts.push(best.clone());
        let mut all = with_gains(brief, layouts);
        let of_all = all[pins..].iter().filter(|f| sure_gain(f).is_some_and(|g| g >= confirmed::BEST_MIN));
        let total = |found: &(Member, Gains)| confirmed::total(brief.objectives, &found.1);
        let surest = of_all.max_by(|a, b| total(a).total_cmp(&total(b))).cloned();
        out.best = all.pop().filter(is_confirmed).or(surest);
        let mut shown = all.split_off(pins);
        let wanted = shown.len();
        shown.retain(is_confirmed);
        out.unconfirmed = wanted - shown.len();
        options.take(wanted + out.unconfirmed);
        let instead = with_gains(brief, options.members(wanted)).into_iter();
        shown.extend(instead.filter(is_confirmed));
        shown.sort_by(|a, b| {
            confirmed::total(brief.objectives, &b.1).total_cmp(&confirmed::total(brief.objectives, &a.1))
        });
        out.alike += options.alike;
        all.extend(shown);
        (out.members, out.gains) = all.into_iter().unzip();
    } else {
        (out.members, out.gains) = with_gains(brief, layouts).into_iter().unzip();
    }
    out
}

/// Ideas on their way to options: each without the moves that bring nothing, and unlike those before.
struct Options<'a, 'b> {
    stripper: &'a Stripper<'b>,
    left: std::vec::IntoIter<Member>,
    taken: Vec<Idea>,
    /// Ideas left out since they are like one before.
    alike: usize,
}

impl Options<'_, '_> {
    /// Takes ideas until there are so many, or none is left.
    fn take(&mut self, wanted: usize) {
        while self.taken.len() < wanted {
            let Some(next) = self.left.next() else { return };
            let idea = self.stripped(&next, STRIPPED);
            if self.taken.iter().all(|t| t.likeness(&idea) <= SAME_MAPS) {
                self.taken.push(idea);
            } else {
                self.alike += 1;
            }
        }
    }

    /// Takes the least change that brings half of what the best layout gains, behind the first. What moves less than
    /// another is an idea of its own, however alike what is seen.
    fn take_least(&mut self, best: &Member) {
        let least = self.stripped(best, LEAST_CHANGE);
        let control = self.stripper.brief.control;
        let groups = |i: &Idea| control.moved_groups(&control.reduce(&i.member.parameters));
        let is_no_less = |t: &Idea| t.likeness(&least) > SAME_MAPS && groups(&least) >= groups(t);
        if !self.taken.iter().any(is_no_less) {
            self.taken.insert(1.min(self.taken.len()), least);
        }
    }

    /// A layout without the moves that bring nothing; as it was where a limit would be broken on the lattice shown.
    fn stripped(&self, member: &Member, cost: f64) -> Idea {
        let Brief { study, settings, objectives, .. } = self.stripper.brief;
        let stripped = self.stripper.strip(member, cost);
        let worth = study.measure(&stripped.parameters, &mut study.bench());
        if evaluation(study, settings, objectives, &worth).violation == 0.0 {
            return Idea::of(self.stripper.brief, stripped, &worth);
        }
        let worth = study.measure(&member.parameters, &mut study.bench());
        Idea::of(self.stripper.brief, member.clone(), &worth)
    }

    fn members(&self, from: usize) -> Vec<Member> {
        self.taken.iter().skip(from).map(|i| i.member.clone()).collect()
    }
}

/// Layouts with what they surely gain.
fn with_gains(brief: &Brief<'_>, layouts: Vec<Member>) -> Vec<(Member, Gains)> {
    if layouts.is_empty() {
        return Vec::new();
    }
    let vectors: Vec<Vec<f64>> = layouts.iter().map(|m| m.parameters.clone()).collect();
    let gains = confirmed::gains(brief.study, brief.settings, brief.objectives, &vectors);
    layouts.into_iter().zip(gains).collect()
}

/// Layouts worth ranking: those of the search's own choice, and of all that keep the thresholds by turns the best that is not
/// near another and the one that is experienced least like all others.
fn pool(
    brief: &Brief<'_>,
    outcome: &Outcome<'_>,
    others: &[Point],
    shown: &[Objective],
    stripper: &Stripper<'_>,
) -> Vec<Member> {
    let bounds = brief.control.bounds();
    let apart = APART * (bounds.len() as f64).sqrt();
    let pins = pinned(brief.settings).min(outcome.members.len());
    let gain = |p: &Point| total_gain(shown, &p.values);
    // Nobody stated thresholds: half of the best gain is worth another idea.
    let least = if is_firm(brief.settings) { f64::INFINITY } else { YIELDING_SHARE * gain(&outcome.best) };
    let is_kept = |p: &&Point| {
        let is_worth = || stripper.keeps_penalty(&p.values) && gain(p) >= least;
        p.violation == 0.0 && (stripper.keeps(&p.values) || is_worth())
    };
    let effort = budget::effort(brief.study);
    let some = |most: usize| (most as f64 * effort).ceil() as usize;
    let best_of = |of: &[Point], most: usize| {
        let mut kept: Vec<Point> = of.iter().filter(is_kept).cloned().collect();
        kept.sort_by(|a, b| gain(b).total_cmp(&gain(a)));
        kept.truncate(most);
        kept
    };
    let mut kept = best_of(outcome.archive, some(EXPERIENCED));
    let without = without_one(brief, &kept[..kept.len().min(some(TAKEN_APART))]);
    kept.extend(without.into_iter().filter(|p| is_kept(&p)));
    kept.extend(best_of(others, some(EXPERIENCED_BESIDE)));
    kept.sort_by(|a, b| gain(b).total_cmp(&gain(a)));
    let maps = experiences(brief, &kept);
    let mut out: Vec<Member> = outcome.members[pins..].to_vec();
    let distance = |p: &Point, to: &[f64]| normalised_distance(&bounds, &p.parameters, to);
    let nearest = |p: &Point| out.iter().map(|o| distance(p, &o.parameters)).fold(f64::INFINITY, f64::min);
    let mut distances: Vec<f64> = kept.iter().map(nearest).collect();
    let mut likeness = vec![f64::NEG_INFINITY; kept.len()];
    let mut turn = 0..;
    let wanted = brief.settings.members + RESERVES;
    let most = (some(RANKED).max(2 * wanted).min(RANKED) / brief.study.thinned()).max(wanted);
    while out.len() < most {
        let mut left = (0..kept.len()).filter(|i| distances[*i] > apart);
        let next = if turn.next().is_some_and(|t: usize| t.is_multiple_of(2)) {
            left.next()
        } else {
            left.min_by(|a, b| likeness[*a].total_cmp(&likeness[*b]))
        };
        let Some(next) = next else { break };
        let Point { parameters, values, violation } = kept[next].clone();
        for (i, p) in kept.iter().enumerate() {
            distances[i] = distances[i].min(distance(p, &parameters));
            likeness[i] = likeness[i].max(maps[i].likeness(&maps[next]));
        }
        let within_threshold = stripper.keeps(&values);
        out.push(Member { parameters, values, violation, within_threshold });
    }
    let whole = |m: Member| Member { parameters: brief.control.expand(&m.parameters), ..m };
    let all = out.into_iter().map(whole);
    all.filter(|m| moves_visibly(brief.study, &m.parameters)).collect()
}

/// Layouts with one move of each taken back: what the best have in common hides other ideas.
fn without_one(brief: &Brief<'_>, best: &[Point]) -> Vec<Point> {
    let mut out: Vec<Point> = Vec::new();
    for point in best {
        for (_, other) in without_each(brief, point) {
            if !out.contains(&other) {
                out.push(other);
            }
        }
    }
    out
}

/// A layout without the moves of each unit of the control that it moves, one after the other, with the unit's place.
pub(crate) fn without_each(brief: &Brief<'_>, point: &Point) -> Vec<(usize, Point)> {
    let Brief { trial, settings, control, objectives, .. } = brief;
    let start = control.start();
    let back = |(place, (unit, _)): (usize, &(Vec<usize>, usize))| {
        let mut free = point.parameters.clone();
        unit.iter().for_each(|&k| free[k] = start[k]);
        let free = control.permit(&free);
        (free != point.parameters).then_some((place, free))
    };
    let moved: Vec<(usize, Vec<f64>)> = control.units().iter().enumerate().filter_map(back).collect();
    let vectors: Vec<Vec<f64>> = moved.iter().map(|(_, free)| control.expand(free)).collect();
    let worths = trial.measure_all(&vectors);
    let point = |((place, parameters), worth): ((usize, Vec<f64>), &Worth)| {
        let found = evaluation(trial, settings, objectives, worth);
        (place, Point { parameters, values: found.values, violation: found.violation })
    };
    moved.into_iter().zip(&worths).map(point).collect()
}

/// What people experience in layouts, on one of the lattices that were searched on: a coarse look tells maps apart.
fn experiences(brief: &Brief<'_>, points: &[Point]) -> Vec<Experience> {
    let Brief { study, settings, control, .. } = brief;
    let vectors: Vec<Vec<f64>> = points.iter().map(|p| control.expand(&p.parameters)).collect();
    let coarse = study.on_lattices(
        settings,
        &lattices::searched(study, settings)[..1],
        Use::Search(lattices::drawn(settings)),
    );
    let on = coarse.as_ref().unwrap_or(study);
    on.measure_all(&vectors).iter().map(|worth| Experience::of(on, worth)).collect()
}

/// A layout that is ranked.
struct Ranked {
    member: Member,
    /// On the lattice shown.
    here: Worth,
    /// Sum of what it gains on each of the lattices that it was measured on.
    gained: f64,
    /// How many they were.
    lattices: usize,
}

impl Ranked {
    /// What it gains on average.
    fn gain(&self) -> f64 {
        self.gained / self.lattices.max(1) as f64
    }
}

/// Layouts by what they gain on lattices of their own, the best first; none that breaks a limit there or on the lattice
/// shown. They are raced: the better half goes on to more lattices.
fn ranked(brief: &Brief<'_>, pool: Vec<Member>) -> Vec<Ranked> {
    let Brief { study, settings, objectives, .. } = brief;
    let is_allowed = |on: &Study, worth: &Worth| evaluation(on, settings, objectives, worth).violation == 0.0;
    let vectors =
        |of: &[Ranked]| -> Vec<Vec<f64>> { of.iter().map(|r| r.member.parameters.clone()).collect() };
    let all: Vec<Vec<f64>> = pool.iter().map(|m| m.parameters.clone()).collect();
    let here = study.measure_all(&all);
    let new = |(member, here): (Member, Worth)| Ranked { member, here, gained: 0.0, lattices: 0 };
    let mut racing: Vec<Ranked> = pool.into_iter().zip(here).map(new).collect();
    racing.retain(|r| is_allowed(study, &r.here) && is_sound(brief, &r.member.parameters));
    let at = lattices::ranked(study, settings);
    let drawn = lattices::drawn(settings);
    let mut fallen: Vec<Ranked> = Vec::new();
    let mut begin = 0;
    let end = at.len() / study.thinned();
    for heat in HEATS {
        let use_for = if racing.len() < PREPARED { Use::Few(drawn) } else { Use::Search(drawn) };
        let others = study.on_lattices(settings, &at[begin..begin + heat], use_for);
        let on = others.as_ref().unwrap_or(study);
        let worths = on.measure_all(&vectors(&racing));
        let judged = racing.into_iter().zip(worths).filter(|(_, worth)| is_allowed(on, worth));
        let measured = |(mut r, worth): (Ranked, Worth)| {
            r.gained += heat as f64 * self::gained(on, settings, objectives, &worth);
            r.lattices += heat;
            r
        };
        racing = judged.map(measured).collect();
        racing.sort_by(|a, b| b.gain().total_cmp(&a.gain()));
        begin += heat;
        if begin >= end {
            break;
        }
        let kept = racing.len().div_ceil(2).max(FINALISTS).max(settings.members + RESERVES);
        let behind = racing.split_off(racing.len().min(kept));
        fallen.splice(0..0, behind);
    }
    racing.extend(fallen);
    racing
}

/// So many ideas unlike those pinned: the first of all and then by turns the one least like those taken; and how many of the
/// wanted are missing because what is left is like them.
fn unlike(brief: &Brief<'_>, pinned: &[Member], ranked: Vec<Ranked>, wanted: usize) -> (Vec<Member>, usize) {
    let mut left: Vec<Idea> = ranked.into_iter().map(|r| Idea::of(brief, r.member, &r.here)).collect();
    let mut taken = ideas(brief, pinned.to_vec());
    let likeness = |idea: &Idea, taken: &[Idea]| {
        taken.iter().map(|t| idea.likeness(t)).fold(f64::NEG_INFINITY, f64::max)
    };
    left.retain(|idea| likeness(idea, &taken) <= SAME_MAPS);
    while taken.len() < pinned.len() + wanted && !left.is_empty() {
        let all: Vec<f64> = left.iter().map(|idea| likeness(idea, &taken)).collect();
        let least_like = (0..left.len()).min_by(|a, b| all[*a].total_cmp(&all[*b]));
        let next = if taken.len() == pinned.len() { 0 } else { least_like.unwrap_or(0) };
        if all[next] > SAME_MAPS {
            break;
        }
        taken.push(left.remove(next));
    }
    let missing = if left.is_empty() { 0 } else { pinned.len() + wanted - taken.len() };
    (taken.drain(pinned.len()..).map(|i| i.member).collect(), missing)
}

fn ideas(brief: &Brief<'_>, members: Vec<Member>) -> Vec<Idea> {
    let vectors: Vec<Vec<f64>> = members.iter().map(|m| m.parameters.clone()).collect();
    let worths = brief.study.measure_all(&vectors);
    members.into_iter().zip(&worths).map(|(m, worth)| Idea::of(brief, m, worth)).collect()
}

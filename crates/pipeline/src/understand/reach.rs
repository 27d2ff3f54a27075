//! Ways of marks that end at what a builder would refuse, each told with what stands in the way and how far it goes.

use std::collections::{BTreeMap, BTreeSet};

use crate::understand::faults::{CROSSING_FREE_M, Fault, Guards, is_gated};
use crate::understand::named;
use crate::understand::pieces::Pieces;
use crate::understand::understood::Understood;
use enfilade_cad::drawing::place_in;
use enfilade_config::Settings;
use enfilade_moves::doorways::is_worth_moving;
use enfilade_moves::{Layout, Moves, Parameter};
use enfilade_overlay::words::listed;
use enfilade_penalties::Overlap;
use enfilade_plan::markers::{Clause, Group, Kind};
use enfilade_report::{Place, Report, counted};

/// Places of a shift lie no farther apart than this, metres of a person, those of a turn than this, degrees, those of a
/// scaling than this; and are no more than so many.
const STEP_M: f64 = 0.05;
const STEP_DEG: f64 = 2.0;
const STEP_SCALE: f64 = 0.02;
const STEPS_MAX: usize = 40;

/// Halvings between the farthest good place found and the bad one beyond it.
const HALVINGS: usize = 8;

/// A way ends at whole thousandths of its unit, if that is a metre, a foot, a degree or a factor.
const PARTS: f64 = 1e3;

/// Other parameters of a group that are tried at their bounds beside one.
const BESIDE: usize = 2;

/// What decides how far ways go.
struct Walk<'a> {
    base: &'a Understood,
    pieces: Pieces,
    guards: Guards,
    /// Nothing where walls may run through each other.
    crossings: Option<Overlap>,
}

/// The moves of marks with ways that end where nothing beyond can be built: whatever stands at the far end is allowed, or
/// the way ends before it. A place on the way may still be forbidden; the search keeps off it. Its mark gets a note.
pub(crate) fn within_reach<'a>(
    base: &Understood,
    groups: impl Iterator<Item = &'a Group> + Clone,
    settings: &Settings,
    report: &mut Report,
) -> Moves {
    let mut moves = base.moves.clone();
    let mut without_way = Vec::new();
    for Ended { parameter, clause, faults } in ended(base, settings) {
        let p = &base.moves.parameters[parameter];
        let group = groups.clone().find(|g| g.name == p.group_name);
        let place =
            group.map_or_else(|| Place::file(&base.plan.file), |g| place_in(&base.plan.file, &g.source));
        let text = words(base, p, &clause, &faults);
        // Marks are drawn generously: that less of a way can be built is no fault, that none can is.
        if has_way(&clause) {
            report.info("move-shortened", place, text);
        } else {
            report.warn("move-shortened", place, text);
            without_way.push(parameter);
        }
        moves.parameters[parameter].clause = clause;
    }
    moves.leave_out(&without_way);
    moves
}

/// The default moves with ways that end in the same way. Nobody stated more; those with no way worth a parameter are left
/// out, and named.
pub(crate) fn defaults_within_reach(base: &Understood, settings: &Settings, report: &mut Report) -> Moves {
    let mut moves = base.moves.clone();
    let mut without_way = Vec::new();
    for Ended { parameter, clause, .. } in ended(base, settings) {
        if !is_worth_moving(&clause, base.plan.human_scale) {
            without_way.push(parameter);
        }
        moves.parameters[parameter].clause = clause;
    }
    let names: Vec<String> =
        without_way.iter().map(|i| base.moves.parameters[*i].group_name.clone()).collect();
    moves.leave_out(&without_way);
    if !names.is_empty() {
        let text = format!(
            "{} of what could move by default {} without a way that can be built ({}); {} left",
            names.len(),
            if names.len() == 1 { "is" } else { "are" },
            listed(&names, "and"),
            counted(moves.parameters.len() as u64, "parameter")
        );
        report.info("default-moves-ways", Place::file(&base.plan.file), text);
    }
    moves
}

/// A parameter whose way ends before its bounds.
struct Ended {
    parameter: usize,
    clause: Clause,
    /// What is wrong beyond.
    faults: Vec<Fault>,
}

/// The parameters whose ways end before their bounds. What is linked follows another group, so that its way alone says
/// nothing; nor does a wall that may move itself.
fn ended(base: &Understood, settings: &Settings) -> Vec<Ended> {
    if !is_gated(base, settings) {
        return Vec::new();
    }
    let pieces = Pieces::new(base);
    let guards = Guards::new(base, &pieces.drawn, settings);
    let drawn = enfilade_penalties::Layout { pieces: &pieces.drawn };
    let crossings = (!settings.allow.crossings).then(|| Overlap::new(&drawn));
    let walk = Walk { base, pieces, guards, crossings };
    let is_linked = |p: &Parameter| settings.links.iter().any(|l| l.groups.contains(&p.group_name));
    let of = |parameter: usize| {
        let p = &base.moves.parameters[parameter];
        let bounds = [p.clause.lower, p.clause.upper];
        let ends = if is_linked(p) { [None, None] } else { bounds.map(|end| walk.end(parameter, end)) };
        let [lower, upper] = [0, 1].map(|k| ends[k].as_ref().map_or(bounds[k], |e| e.0));
        let clause = Clause { lower, upper, ..p.clause.clone() };
        let faults = ends.into_iter().flatten().flat_map(|e| e.1).collect();
        (clause != p.clause).then_some(Ended { parameter, clause, faults })
    };
    (0..base.moves.parameters.len()).filter_map(of).collect()
}

/// Whether a clause takes its group anywhere.
fn has_way(clause: &Clause) -> bool {
    let still = clause.kind.identity();
    clause.lower != still || clause.upper != still
}

impl Walk<'_> {
    /// Where the way of a parameter ends before a bound, and what is wrong beyond; nothing where the bound can be built.
    fn end(&self, i: usize, bound: f64) -> Option<(f64, Vec<Fault>)> {
        let clause = &self.base.moves.parameters[i].clause;
        let still = clause.kind.identity();
        let mut wrong = self.wrong(i, bound);
        if bound == still || wrong.is_empty() {
            return None;
        }
        let step = match clause.kind {
            Kind::Rotate(_) => STEP_DEG.to_radians() / clause.si_per_unit,
            Kind::Scale(_) => STEP_SCALE,
            _ => STEP_M * self.base.plan.human_scale / clause.si_per_unit,
        };
        let steps = ((bound - still).abs() / step).ceil().clamp(1.0, STEPS_MAX as f64) as usize;
        let at = |k: usize| still + (bound - still) * k as f64 / steps as f64;
        let mut good = 0;
        for k in (1..steps).rev() {
            let found = self.wrong(i, at(k));
            if found.is_empty() {
                good = k;
                break;
            }
            wrong = found;
        }
        let (mut good, mut bad) = (at(good), at(good + 1));
        for _ in 0..HALVINGS {
            let middle = f64::midpoint(good, bad);
            let found = self.wrong(i, middle);
            if found.is_empty() {
                good = middle;
            } else {
                (bad, wrong) = (middle, found);
            }
        }
        // So far a wall may reach into another one, or a joint open, without a fault.
        let is_way = match clause.kind {
            Kind::Rotate(_) | Kind::Scale(_) => true,
            _ => (good - still).abs() * clause.si_per_unit > CROSSING_FREE_M * self.base.plan.human_scale,
        };
        let way = if is_way { ((good - still) * PARTS).trunc() / PARTS } else { 0.0 };
        Some((still + way + 0.0, wrong))
    }

    /// What is wrong with one parameter at a value, the others as drawn, or of its own group at a bound: the least of it.
    fn wrong(&self, i: usize, value: f64) -> Vec<Fault> {
        let moves = &self.base.moves;
        let of_group = |k: &usize| *k != i && moves.parameters[*k].group == moves.parameters[i].group;
        let beside: Vec<usize> = (0..moves.parameters.len()).filter(of_group).take(BESIDE).collect();
        let mut least: Option<Vec<Fault>> = None;
        for combination in 0..3usize.pow(beside.len() as u32) {
            let mut p = moves.identity();
            p[i] = value;
            for (n, k) in beside.iter().enumerate() {
                let Clause { lower, upper, .. } = moves.parameters[*k].clause;
                p[*k] = [p[*k], lower, upper][combination / 3usize.pow(n as u32) % 3];
            }
            let found = self.found(&moves.apply(&self.base.plan, &self.base.graph, &p));
            if found.is_empty() {
                return found;
            }
            if least.as_ref().is_none_or(|l| found.len() < l.len()) {
                least = Some(found);
            }
        }
        least.unwrap_or_default()
    }

    /// What is wrong with a layout between what it moves and what cannot move itself.
    fn found(&self, layout: &Layout) -> Vec<Fault> {
        let changed: BTreeSet<u32> = layout.walls.iter().filter(|w| w.is_changed).map(|w| w.wall).collect();
        let stays = |w: u32| self.base.moves.walls.binary_search(&w).is_err();
        let holds = |pair: [u32; 2]| pair.iter().all(|w| changed.contains(w) || stays(*w));
        self.guards.found((self.base, &self.pieces, self.crossings.as_ref()), layout, &holds)
    }
}

/// What a way ends at, in words.
fn words(base: &Understood, p: &Parameter, clause: &Clause, faults: &[Fault]) -> String {
    let plan = &base.plan;
    let wall = |w: u32| named::short(plan, &plan.walls[w as usize]);
    let of_record = |r: usize| plan.walls.iter().position(|w| w.source.record == r).map(|w| wall(w as u32));
    let told = |fault: &Fault| match *fault {
        Fault::Opened(o) => match of_record(o.other) {
            Some(other) => format!("open its joint with {other} by {:.2} m", o.by_m),
            None => format!("open a joint by {:.2} m", o.by_m),
        },
        Fault::Crossing([a, b]) => format!("run {} through {}", wall(a), wall(b)),
        Fault::Narrow([a, b]) => format!("leave less than 0.9 m between {} and {}", wall(a), wall(b)),
        Fault::Struck(_) => "run into something that stands there".to_owned(),
    };
    // One of each kind says what the others would.
    let mut first: BTreeMap<&str, String> = BTreeMap::new();
    for fault in faults {
        first.entry(fault.word()).or_insert_with(|| told(fault));
    }
    let words: Vec<&str> = first.keys().copied().collect();
    let words = if words.len() > 1 { format!("\"{}\"", words.join(", ")) } else { words.concat() };
    let rest = if has_way(clause) { format!("it moves by `{clause}` alone") } else { "it stays".to_owned() };
    format!(
        "group {:?}: `{}` goes farther than can be built: it would {}; {rest}; `--allow {words}` takes it on",
        p.group_name,
        p.clause,
        listed(&first.into_values().collect::<Vec<_>>(), "and")
    )
}

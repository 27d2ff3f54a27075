//! An option without what brings nothing: moves whose return costs next to nothing go back, what remains goes to round
//! lengths and angles.

use crate::search::brief::Brief;
use crate::search::gain::total_gain;
use crate::search::judged::evaluation;
use enfilade_moves::Parameter;
use enfilade_overlay::result::Objective;
use enfilade_plan::markers::Kind;
use enfilade_search::{Member, Sense};

/// Lengths to which moves are rounded, metres: the coarse ones where they cost little, else the finest …
const LENGTHS_M: [f64; 3] = [0.1, 0.05, 0.01];
/// … in drawings by the inch: 4, 2 and 1 inches …
const LENGTHS_INCHES_M: [f64; 3] = [0.1016, 0.0508, 0.0254];
/// … and angles, degrees.
const ANGLES_DEG: [f64; 3] = [90.0, 15.0, 1.0];

/// The last of these.
const FINEST: usize = 2;

/// Share of a gain that rounding may cost beside what stripping does.
const ROUNDING_COST: f64 = 0.02;

/// What layouts are held against while they are stripped.
pub(crate) struct Stripper<'a> {
    pub(crate) brief: &'a Brief<'a>,
    /// With their values of the present layout.
    pub(crate) shown: &'a [Objective],
    /// The thresholds of the search, as measured.
    pub(crate) thresholds: &'a [f64],
}

/// A layout on its way to fewer moves.
#[derive(Clone)]
struct State {
    free: Vec<f64>,
    member: Member,
    gain: f64,
}

impl Stripper<'_> {
    /// The layout with as few moves as keep its gain but for a share of it, none of them odd; it keeps the thresholds
    /// that it kept.
    pub(crate) fn strip(&self, member: &Member, cost: f64) -> Member {
        let free = self.brief.control.reduce(&member.parameters);
        let begun = State { free, member: member.clone(), gain: total_gain(self.shown, &member.values) };
        if begun.gain <= 0.0 {
            return begun.member;
        }
        let least = begun.gain * (1.0 - cost);
        let stripped = self.without_idle(begun, least);
        let gain = stripped.gain;
        self.rounded(stripped, least.min(gain * (1.0 - ROUNDING_COST))).member
    }

    /// Takes back what costs least first, as long as enough is left.
    fn without_idle(&self, from: State, least: f64) -> State {
        let start = self.brief.control.start();
        let back = |free: &[f64], unit: &[usize]| {
            let mut out = free.to_vec();
            unit.iter().for_each(|&k| out[k] = start[k]);
            out
        };
        let units = self.brief.control.units().iter().map(|u| &u.0);
        let moved: Vec<&Vec<usize>> = units.filter(|u| u.iter().any(|&k| from.free[k] != start[k])).collect();
        let tried = self.judged(&from, moved.iter().map(|u| back(&from.free, u)).collect());
        let mut order: Vec<(f64, &Vec<usize>)> =
            tried.iter().zip(&moved).filter_map(|(s, u)| Some((s.as_ref()?.gain, *u))).collect();
        order.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut now = from;
        for (_, unit) in order {
            now = self.if_enough(&now, back(&now.free, unit), least).unwrap_or(now);
        }
        now
    }

    /// Brings every move to round numbers, or a part of it back, as long as enough is left.
    fn rounded(&self, from: State, least: f64) -> State {
        let control = self.brief.control;
        let start = control.start();
        let parameter = |k: usize| &self.brief.study.base.moves.parameters[control.parameter(k)];
        let round = |free: &[f64], of: &[usize], step: usize| {
            let mut out = free.to_vec();
            for &k in of {
                let module = module(parameter(k), step);
                out[k] = module.map_or(free[k], |m| start[k] + ((free[k] - start[k]) / m).round() * m);
            }
            out
        };
        let all: Vec<usize> = (0..start.len()).collect();
        let mut now = self.if_enough(&from, round(&from.free, &all, FINEST), least).unwrap_or(from);
        for (unit, _) in control.units() {
            for &k in unit.iter().filter(|_| unit.len() > 1) {
                let mut without = now.free.clone();
                without[k] = start[k];
                now = self.if_enough(&now, without, least).unwrap_or(now);
            }
            let coarser =
                (0..FINEST).find_map(|step| self.if_enough(&now, round(&now.free, unit, step), least));
            now = coarser.unwrap_or(now);
        }
        now
    }

    /// What free parameters are worth where they are others, still move something, and gain enough.
    fn if_enough(&self, now: &State, free: Vec<f64>, least: f64) -> Option<State> {
        if free == now.free {
            return None;
        }
        let next = self.judged(now, vec![free]).pop().flatten();
        next.filter(|s| s.gain >= least && s.free != self.brief.control.start())
    }

    /// Free parameters as the rules allow them, with what they are worth; none that breaks a limit, or a threshold that
    /// was kept before.
    fn judged(&self, before: &State, free: Vec<Vec<f64>>) -> Vec<Option<State>> {
        let Brief { trial, settings, control, objectives, .. } = self.brief;
        let bounds = control.bounds();
        let within = |q: Vec<f64>| -> Vec<f64> {
            let q: Vec<f64> = q.iter().zip(&bounds).map(|(v, [lo, hi])| v.clamp(*lo, *hi)).collect();
            control.permit(&q)
        };
        let free: Vec<Vec<f64>> = free.into_iter().map(within).collect();
        let layouts: Vec<Vec<f64>> = free.iter().map(|q| control.expand(q)).collect();
        let worths = trial.measure_all(&layouts);
        let state = |((worth, free), parameters)| {
            let found = evaluation(trial, settings, objectives, &worth);
            let within_threshold = self.keeps(&found.values);
            let is_kept =
                within_threshold || !before.member.within_threshold && self.keeps_penalty(&found.values);
            let is_allowed = found.violation == 0.0 && is_kept;
            let gain = total_gain(self.shown, &found.values);
            let member =
                Member { parameters, values: found.values, violation: found.violation, within_threshold };
            is_allowed.then_some(State { free, member, gain })
        };
        worths.into_iter().zip(free).zip(layouts).map(state).collect()
    }

    /// Whether values keep every threshold.
    pub(crate) fn keeps(&self, values: &[f64]) -> bool {
        self.keeps_of(values, |_| true)
    }

    /// Whether values have no more penalty than is allowed.
    pub(crate) fn keeps_penalty(&self, values: &[f64]) -> bool {
        self.keeps_of(values, |o| o.name == "penalty")
    }

    fn keeps_of(&self, values: &[f64], is_asked: impl Fn(&Objective) -> bool) -> bool {
        let sides = self.shown.iter().zip(values).zip(self.thresholds);
        sides.into_iter().filter(|((o, _), _)| is_asked(o)).all(|((o, v), limit)| match o.sense {
            Sense::Max => v >= limit,
            Sense::Min => v <= limit,
        })
    }
}

/// What a parameter is rounded to, in its own unit: from coarse (0) to fine (2); none for scales.
fn module(parameter: &Parameter, step: usize) -> Option<f64> {
    let clause = &parameter.clause;
    let si = match clause.kind {
        Kind::Scale(_) => return None,
        Kind::Rotate(_) => ANGLES_DEG[step].to_radians(),
        _ if matches!(clause.unit.as_str(), "in" | "ft") => LENGTHS_INCHES_M[step],
        _ => LENGTHS_M[step],
    };
    Some(si / clause.si_per_unit)
}

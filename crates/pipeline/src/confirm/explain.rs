//! Why an option is good: which of its moves bring the gain, how far it stands from the others, and what
//! it gave up.

use rayon::prelude::*;

use crate::measure::study::Study;
use crate::search::gain::total_gain;
use enfilade_moves::control::{Breach, Control};
use enfilade_overlay::result::{Explanation, Numbers, Objective, Part, Sense};
use enfilade_search::normalised_distance;

/// Moves of an option that are tried without, the largest first: each costs a measurement.
const TRIED: usize = 8;
/// Moves that are told.
const TOLD: usize = 3;
/// A move that brings less than this share of the gain is not told.
const SMALLEST_SHARE: f64 = 0.05;

/// Objective values of a parameter vector, in the order of the objectives.
pub type Measured<'a> = dyn Fn(&[f64]) -> Vec<f64> + Sync + 'a;

/// Explains the option `index` among all, each given by its full parameters.
pub fn explain(
    study: &Study,
    control: &Control,
    objectives: &[Objective],
    options: &[Vec<f64>],
    index: usize,
    measured: &Measured<'_>,
) -> Explanation {
    let bounds = study.base.moves.bounds();
    let p = &options[index];
    let others = options.iter().enumerate().filter(|(i, _)| *i != index);
    let nearest = others
        .map(|(i, o)| (i + 1, normalised_distance(&bounds, p, o)))
        .reduce(|a, b| if b.1 < a.1 { b } else { a });
    let values = measured(p);
    Explanation {
        breaks: Vec::new(),
        parts: parts(study, control, objectives, p, &values, measured),
        from_present: normalised_distance(&bounds, p, &study.base.moves.identity()),
        nearest: nearest.map(|n| n.0),
        from_nearest: nearest.map(|n| n.1),
        kept: kept(objectives, &values),
    }
}

/// For every objective but the penalty, the share of the best gain found that the option keeps.
fn kept(objectives: &[Objective], values: &[f64]) -> Numbers {
    let share = |(o, v): (&Objective, &f64)| Some((o.name.clone(), gained(o, *v)?));
    Numbers::of(objectives.iter().zip(values).filter_map(share))
}

/// The share of the best gain found; none for penalties and where nothing was gained.
fn gained(o: &Objective, value: f64) -> Option<f64> {
    let best = o.best?;
    let reach = if o.sense == Sense::Max { best - o.initial } else { o.initial - best };
    let own = if o.sense == Sense::Max { value - o.initial } else { o.initial - value };
    (o.name != "penalty" && reach > 0.0).then(|| own / reach)
}

/// Leaves one move out after the other and measures what of the gain is lost.
fn parts(
    study: &Study,
    control: &Control,
    objectives: &[Objective],
    p: &[f64],
    values: &[f64],
    measured: &Measured<'_>,
) -> Vec<Part> {
    let gain = |values: &[f64]| total_gain(objectives, values);
    let whole = gain(values);
    if whole <= 0.0 {
        return Vec::new();
    }
    let is_unlinked = control.breaches(p).iter().any(|b| matches!(b, Breach::Links(_)));
    let mut out: Vec<Part> =
        if is_unlinked { without_groups(study, p) } else { without_units(study, control, p) }
            .into_par_iter()
            .map(|(name, groups, rest)| Part { name, groups, lost: (whole - gain(&measured(&rest))) / whole })
            .collect();
    out.retain(|part| part.lost >= SMALLEST_SHARE);
    out.sort_by(|a, b| b.lost.total_cmp(&a.lost));
    out.truncate(TOLD);
    out
}

/// Name, number of groups, and the layout without them, of every unit that moves, what is linked together, the largest first.
fn without_units(study: &Study, control: &Control, p: &[f64]) -> Vec<(String, u64, Vec<f64>)> {
    let (q, start, bounds) = (control.reduce(p), control.start(), control.bounds());
    let share = |unit: &(Vec<usize>, usize)| {
        let of = |&k: &usize| (q[k] - start[k]).abs() / (bounds[k][1] - bounds[k][0]).max(f64::MIN_POSITIVE);
        unit.0.iter().map(of).fold(0.0, f64::max)
    };
    let mut moved: Vec<&(Vec<usize>, usize)> = control.units().iter().filter(|u| share(u) > 0.0).collect();
    moved.sort_by(|a, b| share(b).total_cmp(&share(a)));
    moved.truncate(TRIED);
    let without = |unit: &&(Vec<usize>, usize)| {
        let mut rest = q.clone();
        unit.0.iter().for_each(|&k| rest[k] = start[k]);
        let name = study.base.moves.parameters[control.parameter(unit.0[0])].group_name.clone();
        (name, unit.1 as u64, control.expand(&rest))
    };
    moved.iter().map(without).collect()
}

/// The same of every group by itself: of a pinned layout that does not keep the links, which would put what follows elsewhere.
fn without_groups(study: &Study, p: &[f64]) -> Vec<(String, u64, Vec<f64>)> {
    let moves = &study.base.moves;
    let (identity, bounds) = (moves.identity(), moves.bounds());
    let mut groups: Vec<usize> = moves.parameters.iter().map(|m| m.group).collect();
    groups.dedup();
    let of = |group: usize| (0..p.len()).filter(move |&k| moves.parameters[k].group == group);
    let share = |group: usize| {
        let part =
            |k: usize| (p[k] - identity[k]).abs() / (bounds[k][1] - bounds[k][0]).max(f64::MIN_POSITIVE);
        of(group).map(part).fold(0.0, f64::max)
    };
    groups.retain(|&g| share(g) > 0.0);
    groups.sort_by(|&a, &b| share(b).total_cmp(&share(a)));
    groups.truncate(TRIED);
    let without = |&group: &usize| {
        let mut rest = p.to_vec();
        of(group).for_each(|k| rest[k] = identity[k]);
        let name = of(group).next().map_or_else(String::new, |k| moves.parameters[k].group_name.clone());
        (name, 1, rest)
    };
    groups.iter().map(without).collect()
}

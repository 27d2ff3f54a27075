//! What the architect decides about the parameters: links, modules, how many groups may move, where to
//! look. The search works on the free parameters; the others follow.

use glam::DVec2;

use super::{Moves, Parameter};
use enfilade_plan::markers::Kind;
use enfilade_report::counted;

/// How far an option may stand from the one it shall be like, as a share of each parameter's width.
pub const LIKE_SHARE: f64 = 0.15;
/// Two directions count as one (or as opposite) up to this difference of their cosine from ±1.
const SAME_DIRECTION: f64 = 1e-6;

/// Groups that move together, by their names; the first leads.
#[derive(Clone, Debug, PartialEq)]
pub struct Link {
    /// Names of the groups.
    pub groups: Vec<String>,
    /// Factors of shifts along x and y from the leader to the others: `[-1, 1]` mirrors left to right.
    pub mirror: [f64; 2],
    /// Whether first and last are free and those between keep their share of the way.
    pub is_row: bool,
}

/// Everything decided, as the settings have it. Vectors hold one value a parameter of [`Moves`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Rules {
    /// Groups that move together.
    pub links: Vec<Link>,
    /// Module of shifts, metres.
    pub length_m: Option<f64>,
    /// Module of turns, radians.
    pub angle_rad: Option<f64>,
    /// Most groups that may move at once.
    pub most_groups: Option<usize>,
    /// The option near which all are looked for.
    pub like: Option<Vec<f64>>,
    /// Options that are allowed as they are.
    pub pinned: Vec<Vec<f64>>,
}

/// Parameters under rules.
#[derive(Clone, Debug)]
pub struct Control {
    /// Indices of the free parameters, ascending.
    free: Vec<usize>,
    /// For every parameter its displacement as a sum of `factor · displacement` of free ones (numbers
    /// into `free`), in the own units of both.
    ties: Vec<Vec<(usize, f64)>>,
    identity: Vec<f64>,
    bounds: Vec<[f64; 2]>,
    /// Bounds of the free parameters that all that follow them allow.
    free_bounds: Vec<[f64; 2]>,
    /// Module of every free parameter, own unit; 0: none.
    steps: Vec<f64>,
    /// Ways of the free parameters that count as none, own unit.
    least: Vec<f64>,
    rows: Vec<Row>,
    /// Free parameters that move as one, with the number of groups they move.
    units: Vec<(Vec<usize>, usize)>,
    most_groups: Option<usize>,
    window: Option<Vec<[f64; 2]>>,
    /// Free parameters of every pinned option, and all of them as they were pinned.
    pinned: Vec<(Vec<f64>, Vec<f64>)>,
}

/// What an option does that the rules do not allow.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Breach {
    /// These parameters lie beyond their bounds.
    Bounds(Vec<usize>),
    /// These parameters stand between the steps of their module.
    Module(Vec<usize>),
    /// So many groups move, more than may.
    Moves(usize),
    /// These parameters do not follow what they are linked to.
    Links(Vec<usize>),
}

/// A value that is off by less than this share of its parameter's width keeps its rule.
const RULE_TOLERANCE: f64 = 1e-6;

/// First and last of a row, as numbers of free parameters.
#[derive(Clone, Copy, Debug)]
struct Row {
    first: usize,
    last: usize,
    /// Displacement of the last in its own unit that one unit of the first corresponds to.
    ratio: f64,
    /// Spaces between first and last.
    parts: f64,
}

impl Control {
    /// Puts the parameters under rules.
    ///
    /// # Errors
    /// In words: an unknown group, clauses that cannot follow each other, vectors of another length.
    pub fn new(moves: &Moves, rules: &Rules) -> Result<Self, String> {
        let count = moves.parameters.len();
        let vectors = rules.pinned.iter().chain(&rules.like);
        if let Some(v) = vectors.into_iter().find(|v| v.len() != count) {
            return Err(format!(
                "an option of {}, the drawing has {count}",
                counted(v.len() as u64, "parameter")
            ));
        }
        let mut draft = Draft::new(&moves.parameters);
        for link in &rules.links {
            draft.link(link)?;
        }
        let free: Vec<usize> = (0..count).filter(|&i| draft.ties[i].is_none()).collect();
        let number = |i: usize| free.binary_search(&i).unwrap_or(0);
        let own = |i: usize| vec![(number(i), 1.0)];
        let of = |(i, tie): (usize, &Option<Vec<(usize, f64)>>)| match tie {
            Some(terms) => terms.iter().map(|(leader, f)| (number(*leader), *f)).collect(),
            None => own(i),
        };
        let ties: Vec<Vec<(usize, f64)>> = draft.ties.iter().enumerate().map(of).collect();
        let free_bounds: Vec<[f64; 2]> = free.iter().map(|&i| draft.bounds[i]).collect();
        let step = |i: &usize| {
            let p = &moves.parameters[*i];
            let module = match p.clause.kind {
                Kind::Rotate(_) => rules.angle_rad,
                Kind::Scale(_) => None,
                _ => rules.length_m,
            };
            module.map_or(0.0, |m| m / p.clause.si_per_unit)
        };
        let least = |i: &usize| {
            let clause = &moves.parameters[*i].clause;
            let is_way = !matches!(clause.kind, Kind::Rotate(_) | Kind::Scale(_));
            if is_way { moves.least_m / clause.si_per_unit } else { 0.0 }
        };
        let pick = |v: &Vec<f64>| -> Vec<f64> { free.iter().map(|&i| v[i]).collect() };
        let window = rules.like.as_ref().map(|like| {
            let around = |(v, [lo, hi]): (f64, &[f64; 2])| {
                let reach = LIKE_SHARE * (hi - lo);
                [(v - reach).clamp(*lo, *hi), (v + reach).clamp(*lo, *hi)]
            };
            let all = like.iter().copied().zip(&moves.bounds()).map(around).collect::<Vec<[f64; 2]>>();
            let windows = pick(like).into_iter().zip(&free_bounds).map(around).enumerate();
            windows
                .map(|(k, own)| followed(k, own, &all, &ties, &free, &moves.identity()))
                .collect::<Vec<_>>()
        });
        let rows = draft.rows.iter().map(|r| Row { first: number(r.first), last: number(r.last), ..*r });
        let mut out = Self {
            rows: rows.collect(),
            steps: free.iter().map(step).collect(),
            least: free.iter().map(least).collect(),
            units: units(moves, &draft.leaders, &free),
            identity: moves.identity(),
            bounds: moves.bounds(),
            most_groups: rules.most_groups,
            pinned: vec![],
            window,
            free_bounds,
            ties,
            free,
        };
        if let Some(like) = &rules.like {
            out.window_in_steps(&out.reduce(like));
        }
        if let (Some(like), Some(most)) = (&rules.like, rules.most_groups) {
            let moved = out.moved_groups(&out.reduce(like));
            if moved > most {
                return Err(format!(
                    "the option to stay like moves {}, at most {most} may move",
                    counted(moved as u64, "group")
                ));
            }
        }
        out.pinned = rules.pinned.iter().map(|whole| (out.reduce(whole), whole.clone())).collect();
        Ok(out)
    }

    /// Brings the window to the steps of the modules in it; where none is, to the one nearest to the option itself.
    fn window_in_steps(&mut self, like: &[f64]) {
        let Some(mut window) = self.window.take() else { return };
        for (k, own) in window.iter_mut().enumerate() {
            let (step, identity) = (self.steps[k], self.identity[self.free[k]]);
            if step == 0.0 {
                continue;
            }
            let [least, most] = steps_between(*own, identity, step);
            let nearest = self.snapped(k, like[k]);
            *own = if least > most { [nearest; 2] } else { [least, most].map(|n| identity + n * step) };
        }
        self.window = Some(window);
    }

    /// Bounds of the free parameters, each in its own unit.
    pub fn bounds(&self) -> Vec<[f64; 2]> {
        self.free_bounds.clone()
    }

    /// The drawing as it is, free parameters.
    pub fn start(&self) -> Vec<f64> {
        self.free.iter().map(|&i| self.identity[i]).collect()
    }

    /// The free parameters of a full vector, inside their bounds.
    pub fn reduce(&self, p: &[f64]) -> Vec<f64> {
        self.free.iter().zip(&self.free_bounds).map(|(&i, [lo, hi])| p[i].clamp(*lo, *hi)).collect()
    }

    /// The full vector that free parameters stand for, inside all bounds.
    pub fn expand(&self, q: &[f64]) -> Vec<f64> {
        let pinned = self.pinned.iter().find(|p| p.0[..] == *q);
        pinned.map_or_else(|| self.tied(q), |(_, whole)| whole.clone())
    }

    /// The full vector whose linked parameters follow the free ones.
    fn tied(&self, q: &[f64]) -> Vec<f64> {
        let moved = |k: usize| q[k] - self.identity[self.free[k]];
        let of = |(i, tie): (usize, &Vec<(usize, f64)>)| {
            if let [(k, 1.0)] = tie[..]
                && self.free[k] == i
            {
                return q[k];
            }
            let sum: f64 = tie.iter().map(|(k, f)| f * moved(*k)).sum();
            (self.identity[i] + sum).clamp(self.bounds[i][0], self.bounds[i][1])
        };
        self.ties.iter().enumerate().map(of).collect()
    }

    /// What moves as one: the free parameters of each unit, and how many groups it moves.
    pub fn units(&self) -> &[(Vec<usize>, usize)] {
        &self.units
    }

    /// Which parameter a free one is.
    pub fn parameter(&self, free: usize) -> usize {
        self.free[free]
    }

    /// The nearest free parameters that the rules allow.
    pub fn permit(&self, q: &[f64]) -> Vec<f64> {
        let mut out = q.to_vec();
        if self.pinned.iter().any(|p| p.0[..] == *q) {
            return out;
        }
        if let Some(window) = &self.window {
            for (v, [lo, hi]) in out.iter_mut().zip(window) {
                *v = v.clamp(*lo, *hi);
            }
        }
        self.snap(&mut out);
        self.hold_still(&mut out);
        out
    }

    /// Brings free parameters to their modules.
    fn snap(&self, q: &mut [f64]) {
        for (k, v) in q.iter_mut().enumerate() {
            *v = self.snapped(k, *v);
        }
        for row in &self.rows {
            q[row.last] = self.even(row, q);
        }
    }

    /// What a full vector does that modules, links and the number of moves do not allow.
    pub fn breaches(&self, p: &[f64]) -> Vec<Breach> {
        let is_off = |i: usize, a: f64, b: f64| {
            (a - b).abs() > RULE_TOLERANCE * (self.bounds[i][1] - self.bounds[i][0])
        };
        let q = self.reduce(p);
        let mut snapped = q.clone();
        self.snap(&mut snapped);
        let is_beyond = |i: usize| is_off(i, p[i], p[i].clamp(self.bounds[i][0], self.bounds[i][1]));
        let beyond: Vec<usize> = (0..p.len()).filter(|&i| is_beyond(i)).collect();
        let off_module = (0..q.len())
            .map(|k| (k, self.free[k]))
            .filter(|&(k, i)| self.steps[k] > 0.0 && !is_beyond(i) && is_off(i, q[k], snapped[k]));
        let tied = self.tied(&q);
        let astray = (0..p.len()).filter(|&i| !is_beyond(i) && is_off(i, p[i], tied[i]));
        let mut still = q.clone();
        self.hold_still(&mut still);
        let mut out = Vec::new();
        if still != q {
            out.push(Breach::Moves(self.moved_groups(&q)));
        }
        out.extend((!beyond.is_empty()).then_some(Breach::Bounds(beyond)));
        let modules: Vec<usize> = off_module.map(|(_, i)| i).collect();
        let links: Vec<usize> = astray.collect();
        out.extend((!modules.is_empty()).then_some(Breach::Module(modules)));
        out.extend((!links.is_empty()).then_some(Breach::Links(links)));
        out
    }

    /// Parameters with room to move that has no step of their module in it.
    pub fn without_a_step(&self) -> Vec<usize> {
        let is_stuck = |k: &usize| {
            let ([lo, hi], step) = (self.free_bounds[*k], self.steps[*k]);
            let is_none =
                || steps_between([lo, hi], self.identity[self.free[*k]], step).iter().all(|n| n.abs() < 1.0);
            hi > lo && step > 0.0 && is_none()
        };
        (0..self.free.len()).filter(is_stuck).map(|k| self.free[k]).collect()
    }

    /// Whether free parameters are those of a pinned option that breaks a rule.
    pub fn pinned_breaks(&self, q: &[f64]) -> bool {
        self.pinned.iter().any(|(own, whole)| own[..] == *q && !self.breaches(whole).is_empty())
    }

    /// How many groups free parameters move.
    pub fn moved_groups(&self, q: &[f64]) -> usize {
        let start = self.start();
        let moves = |unit: &&(Vec<usize>, usize)| unit.0.iter().any(|&k| q[k] != start[k]);
        self.units.iter().filter(moves).map(|unit| unit.1).sum()
    }

    /// The multiple of the module that is nearest and inside the bounds; without a module the value itself, where it
    /// is a move at all.
    fn snapped(&self, k: usize, value: f64) -> f64 {
        let (step, identity) = (self.steps[k], self.identity[self.free[k]]);
        let [lo, hi] = self.free_bounds[k];
        if step == 0.0 {
            let is_none = (value - identity).abs() < self.least[k] && (lo..=hi).contains(&identity);
            return if is_none { identity } else { value.clamp(lo, hi) };
        }
        let [least, most] = steps_between([lo, hi], identity, step);
        // A step that reaches a bound may pass it by the last digit.
        (identity + ((value - identity) / step).round().clamp(least, most) * step).clamp(lo, hi)
    }

    /// The last of a row where every space between keeps the module.
    fn even(&self, row: &Row, q: &[f64]) -> f64 {
        let step = self.steps[row.last];
        if step == 0.0 {
            return q[row.last];
        }
        let moved = |k: usize| q[k] - self.identity[self.free[k]];
        let first = moved(row.first) * row.ratio;
        let each = step * row.parts;
        let spaces = (moved(row.last) - first) / each;
        let [lo, hi] = self.free_bounds[row.last];
        let even =
            self.identity[self.free[row.last]] + first + (spaces + spaces.signum() * 1e-9).trunc() * each;
        let is_noise = |bound: f64| (even - bound).abs() <= STEP_SLACK * each.abs();
        if is_noise(lo) || is_noise(hi) { even.clamp(lo, hi) } else { even }
    }

    /// Leaves all but the farthest moved groups as drawn.
    fn hold_still(&self, q: &mut [f64]) {
        let Some(most) = self.most_groups else { return };
        let start = self.start();
        let share = |unit: &(Vec<usize>, usize)| {
            let of = |&k: &usize| {
                let width = self.free_bounds[k][1] - self.free_bounds[k][0];
                if width > 0.0 { (q[k] - start[k]).abs() / width } else { 0.0 }
            };
            unit.0.iter().map(of).fold(0.0, f64::max)
        };
        let shares: Vec<f64> = self.units.iter().map(share).collect();
        let mut order: Vec<usize> = (0..self.units.len()).filter(|&u| shares[u] > 0.0).collect();
        order.sort_by(|&a, &b| shares[b].total_cmp(&shares[a]).then(a.cmp(&b)));
        let mut moved = 0;
        for u in order {
            let (parameters, groups) = &self.units[u];
            if moved + groups <= most {
                moved += groups;
            } else {
                parameters.iter().for_each(|&k| q[k] = start[k]);
            }
        }
    }
}

/// Sets of free parameters that move as one, and how many groups each moves.
fn units(moves: &Moves, leaders: &[Option<usize>], free: &[usize]) -> Vec<(Vec<usize>, usize)> {
    let mut of_group: Vec<usize> = (0..moves.groups.len()).collect();
    for (p, leader) in moves.parameters.iter().zip(leaders) {
        if let Some(leader) = leader {
            let (to, from) = (of_group[moves.parameters[*leader].group], of_group[p.group]);
            of_group.iter_mut().filter(|u| **u == from).for_each(|u| *u = to);
        }
    }
    let unit = |u: usize| {
        let of = |k: &usize| of_group[moves.parameters[free[*k]].group] == u;
        let parameters: Vec<usize> = (0..free.len()).filter(of).collect();
        (parameters, of_group.iter().filter(|o| **o == u).count())
    };
    (0..moves.groups.len()).map(unit).filter(|u| !u.0.is_empty()).collect()
}

/// The ties while links are added.
struct Draft<'a> {
    parameters: &'a [Parameter],
    ties: Vec<Option<Vec<(usize, f64)>>>,
    /// With which parameter each moves as one; rows: the last with the first too.
    leaders: Vec<Option<usize>>,
    bounds: Vec<[f64; 2]>,
    rows: Vec<Row>,
}

impl<'a> Draft<'a> {
    fn new(parameters: &'a [Parameter]) -> Self {
        let bounds = parameters.iter().map(|p| [p.clause.lower, p.clause.upper]).collect();
        let count = parameters.len();
        Self { parameters, ties: vec![None; count], leaders: vec![None; count], bounds, rows: vec![] }
    }

    fn link(&mut self, link: &Link) -> Result<(), String> {
        let of = |name: &String| -> Result<Vec<usize>, String> {
            let named = |i: &usize| self.parameters[*i].group_name == *name;
            let found: Vec<usize> = (0..self.parameters.len()).filter(named).collect();
            if found.is_empty() { Err(self.unknown(name)) } else { Ok(found) }
        };
        let groups: Vec<Vec<usize>> = link.groups.iter().map(of).collect::<Result<_, _>>()?;
        let Some((first, others)) = groups.split_first() else { return Ok(()) };
        let mut partners = Vec::new();
        for (name, group) in link.groups[1..].iter().zip(others) {
            partners.push(self.partners(first, group, link).ok_or_else(|| {
                let leader = &link.groups[0];
                let why = self.unlike(first, group, link);
                format!("{name:?} cannot follow {leader:?}: {why}")
            })?);
        }
        for (m, &leader) in first.iter().enumerate() {
            let followers: Vec<(usize, f64)> = partners.iter().map(|p| p[m]).collect();
            if link.is_row {
                self.tie_row(leader, &followers);
            } else {
                followers.iter().for_each(|&(i, factor)| self.tie(leader, i, factor));
            }
        }
        Ok(())
    }

    fn unknown(&self, name: &str) -> String {
        let mut known: Vec<&str> = Vec::new();
        for p in self.parameters {
            if !known.contains(&&*p.group_name) {
                known.push(&p.group_name);
            }
        }
        match known.as_slice() {
            [] => format!("no group {name:?} that may move; there is none at all"),
            known => format!("no group {name:?} that may move; there are {}", known.join(", ")),
        }
    }

    /// For every parameter of the leader the one of a group that follows it, with the factor from the
    /// leader's displacement to its own.
    fn partners(&self, leader: &[usize], group: &[usize], link: &Link) -> Option<Vec<(usize, f64)>> {
        let mut left = group.to_vec();
        let mut out = Vec::new();
        for &l in leader {
            let found = left.iter().position(|&i| self.factor(l, i, link).is_some())?;
            let i = left.remove(found);
            out.push((i, self.factor(l, i, link)?));
        }
        left.is_empty().then_some(out)
    }

    /// Why the moves of a group have no partners among those of the leader.
    fn unlike(&self, leader: &[usize], group: &[usize], link: &Link) -> &'static str {
        let kinds = |of: &[usize]| {
            let kind = |&i: &usize| match self.parameters[i].clause.kind {
                Kind::Rotate(_) => 1,
                Kind::Scale(_) => 2,
                _ => 0,
            };
            let mut kinds: Vec<u8> = of.iter().map(kind).collect();
            kinds.sort_unstable();
            kinds
        };
        if kinds(leader) != kinds(group) {
            "their moves are not of the same kinds"
        } else if link.mirror == [1.0, 1.0] {
            "they shift in different directions"
        } else {
            "the directions in which they shift are not mirror images"
        }
    }

    fn factor(&self, leader: usize, follower: usize, link: &Link) -> Option<f64> {
        let [l, f] = [leader, follower].map(|i| &self.parameters[i].clause);
        let units = l.si_per_unit / f.si_per_unit;
        match (l.kind, f.kind) {
            (Kind::Rotate(_), Kind::Rotate(_)) => Some(units * link.mirror[0] * link.mirror[1]),
            (Kind::Scale(_), Kind::Scale(_)) => Some(units),
            (l, f) => {
                let along = direction(f)?.dot(direction(l)? * DVec2::from(link.mirror));
                ((along.abs() - 1.0).abs() < SAME_DIRECTION).then_some(units * along.signum())
            }
        }
    }

    /// `i` follows `leader`, which keeps inside what `i` may do.
    fn tie(&mut self, leader: usize, i: usize, factor: f64) {
        self.narrow(leader, i, factor);
        self.ties[i] = Some(vec![(leader, factor)]);
        self.leaders[i] = Some(leader);
    }

    fn tie_row(&mut self, first: usize, followers: &[(usize, f64)]) {
        let Some((&(last, ratio), between)) = followers.split_last() else { return };
        let parts = followers.len() as f64;
        for (n, &(i, factor)) in between.iter().enumerate() {
            let share = (n + 1) as f64 / parts;
            self.narrow(first, i, factor);
            self.narrow(last, i, factor / ratio);
            self.ties[i] = Some(vec![(first, (1.0 - share) * factor), (last, share * factor / ratio)]);
            self.leaders[i] = Some(first);
        }
        // Snapping steps the last from the first: the first must stay where the last may go.
        self.narrow(first, last, ratio);
        self.leaders[last] = Some(first);
        self.rows.push(Row { first, last, ratio, parts });
    }

    fn narrow(&mut self, leader: usize, i: usize, factor: f64) {
        let [l, f] = [leader, i].map(|k| &self.parameters[k].clause);
        let ends = [f.lower, f.upper].map(|b| l.kind.identity() + (b - f.kind.identity()) / factor);
        let [lo, hi] = self.bounds[leader];
        self.bounds[leader] = [lo.max(ends[0].min(ends[1])), hi.min(ends[0].max(ends[1]))];
    }
}

/// The way a shift goes; `None` for turns and scales.
fn direction(kind: Kind) -> Option<DVec2> {
    match kind {
        Kind::X => Some(DVec2::X),
        Kind::Y => Some(DVec2::Y),
        Kind::Along(rad) => Some(DVec2::from_angle(rad)),
        Kind::Rotate(_) | Kind::Scale(_) => None,
    }
}

/// A bound that a step misses by less than this share of it is reached: bounds are differences of rounded numbers.
const STEP_SLACK: f64 = 1e-9;

/// The fewest and the most steps from `identity` within bounds; the fewest are more where there is none.
fn steps_between([lo, hi]: [f64; 2], identity: f64, step: f64) -> [f64; 2] {
    [((lo - identity) / step - STEP_SLACK).ceil(), ((hi - identity) / step + STEP_SLACK).floor()]
}

/// The part of a free parameter's window in which all that follow it alone stay in theirs; all of it where there is none.
fn followed(
    free: usize,
    own: [f64; 2],
    windows: &[[f64; 2]],
    ties: &[Vec<(usize, f64)>],
    parameters: &[usize],
    identity: &[f64],
) -> [f64; 2] {
    let still = identity[parameters[free]];
    let narrowed = ties.iter().enumerate().fold(own, |[lo, hi], (i, tie)| match tie[..] {
        [(k, factor)] if k == free && factor != 0.0 => {
            let [a, b] = windows[i].map(|v| still + (v - identity[i]) / factor);
            [lo.max(a.min(b)), hi.min(a.max(b))]
        }
        _ => [lo, hi],
    });
    if narrowed[0] <= narrowed[1] { narrowed } else { own }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::NodeGroup;
    use enfilade_plan::markers::Clause;

    fn clause(kind: Kind, [lower, upper]: [f64; 2]) -> Clause {
        Clause { kind, lower, upper, unit: "m".into(), si_per_unit: 1.0 }
    }

    /// Groups a, b, c of x and a turn each.
    fn three() -> Moves {
        let mut moves = Moves::default();
        for (group, (name, reach)) in [("a", 1.0), ("b", 0.5), ("c", 2.0)].into_iter().enumerate() {
            for clause in [clause(Kind::X, [-reach, 1.0]), clause(Kind::Rotate(None), [-0.2, 0.3])] {
                moves.parameters.push(Parameter {
                    group_name: name.into(),
                    group,
                    stated: [clause.lower, clause.upper],
                    clause,
                });
            }
            moves.groups.push(NodeGroup { nodes: vec![], handles: vec![], slots: vec![] });
        }
        moves
    }

    /// 17 steps of 0.1 are more than 1.7 by the last digit: no layout lies beyond its bounds for that.
    #[test]
    fn a_step_that_reaches_a_bound_stays_within_it() {
        let mut moves = three();
        for (n, p) in moves.parameters.iter_mut().enumerate() {
            let reach = (n as f64 + 12.0) / 10.0;
            (p.clause.lower, p.clause.upper) = (-reach, reach);
        }
        let rules = Rules { length_m: Some(0.1), angle_rad: Some(0.1), ..Rules::default() };
        let control = Control::new(&moves, &rules).unwrap();
        for far in [-9.0, 9.0] {
            let q = control.permit(&vec![far; control.start().len()]);
            for (v, [lo, hi]) in q.iter().zip(control.bounds()) {
                assert!((lo..=hi).contains(v), "{v} beyond {lo} .. {hi}");
            }
        }
    }

    #[test]
    fn a_pinned_option_stays_as_it_is_and_what_it_breaks_is_told() {
        let pinned = vec![0.25, 0.1, 0.3, 0.0, 0.4, 0.0];
        let rules = Rules {
            links: vec![link(&["a", "c"], [1.0, 1.0], false)],
            length_m: Some(0.1),
            most_groups: Some(2),
            pinned: vec![pinned.clone()],
            ..Rules::default()
        };
        let control = Control::new(&three(), &rules).unwrap();
        let q = control.reduce(&pinned);
        assert_eq!(control.permit(&q), q);
        assert_eq!(control.expand(&q), pinned);
        let told = [Breach::Moves(3), Breach::Module(vec![0]), Breach::Links(vec![4, 5])];
        assert_eq!(control.breaches(&pinned), told);
        assert!(control.pinned_breaks(&q) && !control.pinned_breaks(&control.start()));
        let kept = control.expand(&control.permit(&[0.31, 0.1, 0.0, 0.0]));
        assert_eq!(control.breaches(&kept), []);
        let beyond = [1.5, 0.0, 0.0, 0.0, 0.0, 0.0];
        assert_eq!(
            Control::new(&three(), &Rules::default()).unwrap().breaches(&beyond),
            [Breach::Bounds(vec![0])]
        );
    }

    #[test]
    fn bounds_without_a_step_of_the_module_are_known() {
        let rules = Rules { length_m: Some(1.0), angle_rad: Some(0.31), ..Rules::default() };
        let control = Control::new(&three(), &rules).unwrap();
        assert_eq!(control.without_a_step(), [1, 3, 5]);
    }

    fn link(groups: &[&str], mirror: [f64; 2], is_row: bool) -> Link {
        Link { groups: groups.iter().map(|g| (*g).to_owned()).collect(), mirror, is_row }
    }

    #[test]
    fn linked_groups_share_what_all_of_them_may_do() {
        let rules = Rules { links: vec![link(&["a", "b"], [-1.0, 1.0], false)], ..Rules::default() };
        let control = Control::new(&three(), &rules).unwrap();
        assert_eq!(control.bounds().len(), 4);
        assert_eq!(control.bounds()[0], [-1.0, 0.5]);
        assert_eq!(control.expand(&[-0.25, 0.1, 1.0, 0.0]), [-0.25, 0.1, 0.25, -0.1, 1.0, 0.0]);
    }

    #[test]
    fn what_cannot_follow_is_named() {
        let wrong =
            |link| Control::new(&three(), &Rules { links: vec![link], ..Rules::default() }).unwrap_err();
        assert!(wrong(link(&["a", "d"], [1.0, 1.0], false)).contains("no group \"d\""));
        let mut moves = three();
        moves.parameters[2].clause.kind = Kind::Y;
        let rules = Rules { links: vec![link(&["a", "b"], [1.0, 1.0], false)], ..Rules::default() };
        let why = Control::new(&moves, &rules).unwrap_err();
        assert!(why.ends_with("cannot follow \"a\": they shift in different directions"), "{why}");
        moves.parameters[2].clause.kind = Kind::Rotate(None);
        let why = Control::new(&moves, &rules).unwrap_err();
        assert!(why.ends_with("their moves are not of the same kinds"), "{why}");
        moves.parameters[2].clause.kind = Kind::Along(0.5);
        let rules = Rules { links: vec![link(&["a", "b"], [1.0, -1.0], false)], ..Rules::default() };
        let why = Control::new(&moves, &rules).unwrap_err();
        assert!(why.ends_with("are not mirror images"), "{why}");
        let rules = Rules { like: Some(vec![0.0]), ..Rules::default() };
        assert!(Control::new(&three(), &rules).is_err());
    }

    /// Bounds left over by an accepted option are differences of rounded numbers.
    #[test]
    fn a_step_that_ends_at_a_bound_fits() {
        let mut moves = three();
        moves.parameters[0].clause.upper = 0.3 - 0.2;
        let rules = Rules { length_m: Some(0.1), ..Rules::default() };
        let control = Control::new(&moves, &rules).unwrap();
        assert!((control.permit(&[1.0, 0.0, 0.0, 0.0, 0.0, 0.0])[0] - 0.1).abs() < 1e-12);
        assert!(!control.without_a_step().contains(&0));
    }

    #[test]
    fn what_follows_and_what_keeps_a_module_stays_like_the_option_too() {
        let moves = three();
        let like = vec![0.3, 0.0, 0.3, 0.0, 0.0, 0.0];
        let is_near = |p: &[f64], i: usize| {
            let [lo, hi] = moves.bounds()[i];
            (p[i] - like[i]).abs() <= LIKE_SHARE * (hi - lo) + 1e-12
        };
        let links = vec![link(&["a", "b"], [1.0, 1.0], false)];
        let linked = Rules { links, like: Some(like.clone()), ..Rules::default() };
        let wide = Rules { length_m: Some(0.7), like: Some(like.clone()), ..Rules::default() };
        let snapped = Rules { length_m: Some(0.05), ..wide.clone() };
        for rules in [linked, snapped] {
            let control = Control::new(&moves, &rules).unwrap();
            for far in [-3.0, 3.0] {
                let p = control.expand(&control.permit(&vec![far; control.start().len()]));
                assert!((0..6).all(|i| is_near(&p, i)), "{p:?}");
            }
        }
        // No step of so wide a module lies near: the nearest is taken, whatever is asked for.
        let control = Control::new(&moves, &wide).unwrap();
        for far in [-3.0, 3.0] {
            assert_eq!(control.permit(&[far; 6])[0], 0.0);
        }
    }

    proptest! {
        #[test]
        fn what_is_permitted_keeps_every_rule(
            q in prop::collection::vec(-2.0..2.0f64, 6),
            module in prop::option::of(0.01..0.4f64),
            most in prop::option::of(1..4usize),
            linked in 0..4usize,
            near in any::<bool>(),
        ) {
            let moves = three();
            let links = match linked {
                0 => vec![],
                1 => vec![link(&["a", "b", "c"], [1.0, 1.0], true)],
                2 => vec![link(&["b", "c"], [1.0, 1.0], false)],
                _ => vec![link(&["a", "c"], [-1.0, 1.0], false)],
            };
            let like = near.then(|| vec![0.3, 0.1, 0.2, 0.0, -0.4, 0.2]);
            let rules = Rules { links, length_m: module, most_groups: most, like, ..Rules::default() };
            let control = Control::new(&moves, &rules);
            if near && most.is_some_and(|m| m < 3) {
                prop_assert!(control.is_err_and(|why| why.contains("moves 3 groups")));
                return Ok(());
            }
            let control = control.unwrap();
            let q = control.permit(&q[..control.start().len()]);
            for (v, [lo, hi]) in q.iter().zip(control.bounds()) {
                prop_assert!((lo..=hi).contains(v), "{q:?} beyond {lo} .. {hi}");
            }
            let p = control.expand(&q);
            for (v, [lo, hi]) in p.iter().zip(moves.bounds()) {
                prop_assert!((lo - 1e-12..=hi + 1e-12).contains(v), "{p:?}");
            }
            if let Some(module) = module {
                for v in p.iter().step_by(2) {
                    prop_assert!(((v / module).round() * module - v).abs() < 1e-9, "{p:?} {module}");
                }
            }
            if let Some(most) = most {
                let moved = p.chunks(2).filter(|c| c.iter().any(|v| *v != 0.0)).count();
                prop_assert!(moved <= most, "{p:?}");
            }
            if linked == 1 {
                prop_assert!((p[0] + p[4] - 2.0 * p[2]).abs() < 1e-9, "{p:?}");
            }
            prop_assert_eq!(control.permit(&q), q);
        }
    }
}

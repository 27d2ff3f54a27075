//! Clauses that move nothing: each is tried along its way, with all others as drawn and at their bounds.

use std::collections::BTreeMap;

use glam::DVec2;

use super::{Moves, Parameter, step_of};
use enfilade_plan::Plan;
use enfilade_plan::graph::Graph;
use enfilade_plan::markers::Kind;

/// Where on its way a parameter is tried, as shares: at both bounds, and where no whole or half turn ends.
const TRIED: [f64; 3] = [0.0, 0.37, 1.0];

/// Why a parameter moves nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Idle {
    /// Corners of thick walls stay on the faces they meet.
    HeldByFaces,
    /// What is turned or scaled is one point, or round.
    OnePoint,
    /// The bounds leave no way.
    NoWay,
}

impl Moves {
    /// The parameters that take no corner as far as a move is, wherever the others stand at their bounds, each with why.
    pub fn idle(&self, plan: &Plan, graph: &Graph) -> Vec<(usize, Idle)> {
        let bounds = self.bounds();
        let others: [Vec<f64>; 3] =
            [self.identity(), bounds.iter().map(|b| b[0]).collect(), bounds.iter().map(|b| b[1]).collect()];
        let is_idle = |i: &usize| !others.iter().any(|p| self.moves_a_corner(plan, graph, (*i, p)));
        (0..self.parameters.len()).filter(is_idle).map(|i| (i, self.why_idle(plan, graph, i))).collect()
    }

    /// Whether one parameter takes a corner anywhere, the others being as in `p`.
    fn moves_a_corner(&self, plan: &Plan, graph: &Graph, (i, p): (usize, &[f64])) -> bool {
        let clause = &self.parameters[i].clause;
        let at = |value: f64| {
            let mut p = p.to_vec();
            p[i] = value;
            self.placed(plan, graph, &p).at
        };
        let still = at(clause.kind.identity());
        let differs = |now: &BTreeMap<u32, Vec<DVec2>>| {
            let both = still.iter().flat_map(|(w, points)| points.iter().zip(&now[w]));
            both.into_iter().any(|(a, b)| a.distance(*b) >= self.least_m)
        };
        TRIED.iter().any(|share| differs(&at(clause.lower + share * (clause.upper - clause.lower))))
    }

    fn why_idle(&self, plan: &Plan, graph: &Graph, i: usize) -> Idle {
        let Parameter { clause, group, .. } = &self.parameters[i];
        let group = &self.groups[*group];
        let goes = |value: f64| {
            let step = step_of(&self.parameters[i], value, || self.centroid(graph, group, &self.start), plan);
            !self.is_none(group, &step, &self.start)
        };
        let values = TRIED.map(|share| clause.lower + share * (clause.upper - clause.lower));
        if values.iter().any(|v| goes(*v)) {
            return Idle::HeldByFaces;
        }
        let has_way = values.iter().any(|v| *v != clause.kind.identity());
        match clause.kind {
            Kind::Rotate(_) | Kind::Scale(_) if has_way => Idle::OnePoint,
            _ => Idle::NoWay,
        }
    }
}

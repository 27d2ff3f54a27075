//! How much of a plan was understood.

use enfilade::plan::axes::{AxisGraph, NodeKind, OpeningKind};
use glam::DVec2;

use super::plans::{Kind, Plan};

/// Nodes nearer than this are the same.
pub const NODE_M: f64 = 0.02;
/// Openings whose centres and widths differ by less than this are the same.
pub const OPENING_M: f64 = 0.05;

/// Found and true things.
#[derive(Clone, Copy, Debug, Default)]
pub struct Count {
    pub right: usize,
    pub found: usize,
    pub truth: usize,
}

impl Count {
    /// Harmonic mean of precision and recall; 1 where there is nothing to find and nothing was found.
    pub fn f1(&self) -> f64 {
        if self.found + self.truth == 0 {
            1.0
        } else {
            2.0 * self.right as f64 / (self.found + self.truth) as f64
        }
    }

    pub fn add(&mut self, other: Self) {
        self.right += other.right;
        self.found += other.found;
        self.truth += other.truth;
    }
}

/// Scores of one or more plans.
#[derive(Clone, Copy, Debug, Default)]
pub struct Score {
    pub nodes: Count,
    pub edges: Count,
    pub openings: Count,
    /// Edges found whose thickness is right within 10 mm.
    pub thickness: Count,
}

impl Score {
    pub fn add(&mut self, other: Self) {
        self.nodes.add(other.nodes);
        self.edges.add(other.edges);
        self.openings.add(other.openings);
        self.thickness.add(other.thickness);
    }

    pub fn holds(&self) -> bool {
        self.nodes.f1() >= 0.97 && self.edges.f1() >= 0.97 && self.openings.f1() >= 0.95
    }
}

/// Compares what was found with the plan. `has_thickness`: whether the drawing shows it.
pub fn score(plan: &Plan, found: &AxisGraph, has_thickness: bool) -> Score {
    let mut out = Score::default();
    let nearest = |p: DVec2, is_column: bool| {
        let of_kind = |n: &usize| matches!(found.nodes[*n].kind, NodeKind::Column(_)) == is_column;
        let all = (0..found.nodes.len()).filter(of_kind).map(|n| (found.nodes[n].at.distance(p), n));
        all.min_by(|a, b| a.0.total_cmp(&b.0)).filter(|n| n.0 <= NODE_M).map(|n| n.1)
    };
    let truth: Vec<usize> = {
        let mut used: Vec<usize> = plan.walls.iter().flat_map(|w| w.nodes).collect();
        used.sort_unstable();
        used.dedup();
        used
    };
    let mut match_of = vec![None; plan.nodes.len()];
    for n in &truth {
        match_of[*n] = nearest(plan.nodes[*n], false);
    }
    let columns = plan.columns.iter().filter(|c| nearest(c.centre(), true).is_some()).count();
    let mut matched: Vec<usize> = match_of.iter().flatten().copied().collect();
    matched.sort_unstable();
    matched.dedup();
    out.nodes = Count {
        right: matched.len() + columns,
        found: found.nodes.len(),
        truth: truth.len() + plan.columns.len(),
    };
    let mut free: Vec<bool> = vec![true; found.edges.len()];
    for w in &plan.walls {
        let [Some(a), Some(b)] = w.nodes.map(|n| match_of[n]) else { continue };
        let is_it = |e: &usize| {
            let [c, d] = found.edges[*e].nodes.map(|n| n as usize);
            free[*e] && ((a, b) == (c, d) || (a, b) == (d, c))
        };
        if let Some(e) = (0..found.edges.len()).find(is_it) {
            free[e] = false;
            out.edges.right += 1;
            let t = found.edges[e].thickness_m;
            out.thickness.right += usize::from(!has_thickness || (t - w.thickness).abs() < 0.01);
        }
    }
    out.edges.found = found.edges.len();
    out.edges.truth = plan.walls.len();
    out.thickness.found = out.edges.right;
    out.thickness.truth = out.edges.right;
    out.openings = openings(plan, found);
    out
}

fn openings(plan: &Plan, found: &AxisGraph) -> Count {
    let mut right = 0;
    for g in &plan.gaps {
        let way = super::plans::Arc::new(plan.nodes[g.nodes[0]], plan.nodes[g.nodes[1]], g.bulge);
        let kind = match g.kind {
            Kind::Door => OpeningKind::Door,
            Kind::Window => OpeningKind::Window,
            Kind::Passage => OpeningKind::Passage,
        };
        let is_it = |o: &&enfilade::plan::axes::Opening| {
            o.kind == kind
                && o.centre.distance(way.at(0.5)) < OPENING_M
                && (o.width_m - way.length()).abs() < OPENING_M
        };
        right += usize::from(found.openings.iter().any(|o| is_it(&o)));
    }
    Count { right, found: found.openings.len(), truth: plan.gaps.len() }
}

/// What was missed and what was made up, in words.
pub fn explain(plan: &Plan, found: &AxisGraph) -> Vec<String> {
    let mut out = Vec::new();
    let used: Vec<usize> = plan.walls.iter().flat_map(|w| w.nodes).collect();
    for (i, p) in plan.nodes.iter().enumerate().filter(|(i, _)| used.contains(i)) {
        let nearest = found.nodes.iter().map(|n| n.at.distance(*p)).fold(f64::MAX, f64::min);
        if nearest > NODE_M {
            out.push(format!("node {i} {p:.3} missed, nearest {nearest:.3} m away"));
        }
    }
    for n in &found.nodes {
        let nearest = plan.nodes.iter().map(|p| n.at.distance(*p));
        let nearest =
            nearest.chain(plan.columns.iter().map(|c| c.centre().distance(n.at))).fold(f64::MAX, f64::min);
        if nearest > NODE_M {
            out.push(format!("node {:.3} {:?} made up", n.at, n.kind));
        }
    }
    for g in &plan.gaps {
        let [a, b] = g.nodes.map(|n| plan.nodes[n]);
        out.push(format!("truth: {:?} at {:.3} width {:.3}", g.kind, a.midpoint(b), a.distance(b)));
    }
    for o in &found.openings {
        out.push(format!("found: {:?} at {:.3} width {:.3}: {}", o.kind, o.centre, o.width_m, o.evidence));
    }
    out
}

//! How much of a plan was understood.

use enfilade_cad::drawing::Drawing;
use enfilade_plan::axes::{AxisGraph, NodeKind, OpeningKind};
use enfilade_plan::{PlanOptions, understand};
use enfilade_report::Report;
use glam::DVec2;

use super::plans::{Arc, Column, Kind, Plan};
use super::styles::Office;

/// Nodes nearer than this are the same.
pub const NODE_M: f64 = 0.02;
/// Openings whose centres and widths differ by less than this are the same.
pub const OPENING_M: f64 = 0.05;

/// Largest relative error of the mean degree.
pub const DEGREE_SHARE: f64 = 0.02;
/// Distance of the places whose degree is measured.
const PLACES_M: f64 = 0.8;
/// Places nearer to a wall than this are left out.
const CLEAR_M: f64 = 0.15;

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
    /// Largest relative difference of the mean degree past the axes found from that past the true ones.
    pub degree_error: f64,
}

impl Score {
    pub fn add(&mut self, other: Self) {
        self.nodes.add(other.nodes);
        self.edges.add(other.edges);
        self.openings.add(other.openings);
        self.thickness.add(other.thickness);
        self.degree_error = self.degree_error.max(other.degree_error);
    }

    pub fn holds(&self) -> bool {
        self.nodes.f1() >= 0.97
            && self.edges.f1() >= 0.97
            && self.openings.f1() >= 0.95
            && self.degree_error <= DEGREE_SHARE
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
    out.degree_error = degree_error(plan, found);
    out
}

/// Whether a drawing's unit is the one that it was drawn in, whatever the file says.
pub fn has_right_unit(drawing: &Drawing, office: &Office) -> bool {
    let plan = understand(drawing, &PlanOptions::default(), &mut Report::default());
    plan.is_ok_and(|p| p.unit.unit.metres == office.unit_m)
}

type Piece = [DVec2; 2];

fn pieces_of(a: DVec2, b: DVec2, bulge: f64) -> Vec<Piece> {
    let way = Arc::new(a, b, bulge);
    let n = if bulge == 0.0 { 1 } else { 24 };
    let at = |k: usize| way.at(k as f64 / f64::from(n));
    (0..n as usize).map(|k| [at(k), at(k + 1)]).collect()
}

fn ring_pieces(ring: &[DVec2]) -> impl Iterator<Item = Piece> + '_ {
    (0..ring.len()).map(|i| [ring[i], ring[(i + 1) % ring.len()]])
}

/// How far the mean degree of places in a plan is off if its walls stand on the axes found.
fn degree_error(plan: &Plan, found: &AxisGraph) -> f64 {
    let mut truth: Vec<Piece> = plan
        .walls
        .iter()
        .flat_map(|w| pieces_of(plan.nodes[w.nodes[0]], plan.nodes[w.nodes[1]], w.bulge))
        .collect();
    let mut seen: Vec<Piece> = Vec::new();
    for e in &found.edges {
        let [a, b] = found.ends(e);
        seen.extend(pieces_of(a, b, e.bulge));
    }
    for c in &plan.columns {
        match c {
            Column::Box { corners } => truth.extend(ring_pieces(corners)),
            Column::Round { centre, radius } => {
                let ring: Vec<DVec2> =
                    (0..24).map(|k| *centre + DVec2::from_angle(f64::from(k) * 0.2618) * *radius).collect();
                truth.extend(ring_pieces(&ring));
            }
        }
    }
    for n in &found.nodes {
        if let NodeKind::Column(ring) = &n.kind {
            seen.extend(ring_pieces(ring));
        }
    }
    let places = places(&truth);
    let degree = |walls: &[Piece]| {
        let sees = |i: usize, j: usize| !walls.iter().any(|w| cross([places[i], places[j]], *w));
        (0..places.len()).map(|i| (i + 1..places.len()).filter(|j| sees(i, *j)).count()).sum::<usize>() as f64
    };
    (degree(&seen) / degree(&truth) - 1.0).abs()
}

/// A lattice over the box of the walls, away from them.
fn places(walls: &[Piece]) -> Vec<DVec2> {
    let ends = || walls.iter().flatten();
    let lo = ends().fold(DVec2::MAX, |m, p| m.min(*p));
    let count = ((ends().fold(DVec2::MIN, |m, p| m.max(*p)) - lo) / PLACES_M).floor();
    let all = (0..count.x as u32).flat_map(|i| (0..count.y as u32).map(move |j| (i, j)));
    let at = all.map(|(i, j)| lo + (DVec2::new(f64::from(i), f64::from(j)) + 0.37) * PLACES_M);
    at.filter(|p| walls.iter().all(|w| distance(*p, *w) > CLEAR_M)).collect()
}

fn distance(p: DVec2, [a, b]: Piece) -> f64 {
    let t = ((p - a).dot(b - a) / (b - a).length_squared().max(1e-12)).clamp(0.0, 1.0);
    p.distance(a.lerp(b, t))
}

fn cross([a, b]: Piece, [c, d]: Piece) -> bool {
    let side = |p: DVec2, q: DVec2, r: DVec2| (q - p).perp_dot(r - p) >= 0.0;
    side(a, b, c) != side(a, b, d) && side(c, d, a) != side(c, d, b)
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
        let is_it = |o: &&enfilade_plan::axes::Opening| {
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
        out.push(format!("found: {:?} at {:.3} width {:.3}: {:?}", o.kind, o.centre, o.width_m, o.shown));
    }
    out
}

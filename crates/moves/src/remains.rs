//! What remains of the sides of walls between two joints, and between a joint and the next opening, however they are drawn.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;

use super::joined::{SIDE_SIN, along};
use enfilade_cad::drawing::Editable;
use enfilade_plan::Plan;
use enfilade_plan::axes::{AxisGraph, Edge, FaceRef};
use enfilade_plan::graph::Handle;
use enfilade_plan::sizes::ERROR_GAP_M;
use enfilade_plan::structure::{face_handles, handle_at};

/// What must remain of a side, metres of a person. A side that is drawn shorter may not become shorter still.
pub(super) const REST_M: f64 = 0.1;

/// Rounding of places, metres.
pub(super) const NOISE_M: f64 = 1e-6;

/// Where control points stand, by wall; plan frame, metres.
type Places = BTreeMap<u32, Vec<DVec2>>;

/// A drawn side by the control points of its ends.
pub(super) type Stretch = [Handle; 2];

/// The sides of walls that some moves may make longer or shorter, each from one joint or jamb to the next.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Stretches {
    /// With where their ends stand as drawn.
    list: Vec<(Stretch, [DVec2; 2])>,
    /// [`REST_M`] in metres of the plan.
    rest_m: f64,
}

impl Stretches {
    /// Those at control points that move.
    pub fn new(plan: &Plan, axes: &AxisGraph, moves: &BTreeSet<Handle>) -> Self {
        let mut out = parts(plan, axes);
        let walls: BTreeSet<u32> = moves.iter().map(|h| h.0).collect();
        out.extend(walls.into_iter().flat_map(|w| sides_of_body(plan, w)));
        out.retain(|side| side.iter().any(|h| moves.contains(h)));
        let drawn = |side: Stretch| (side, side.map(|h| handle_at(plan, h) * plan.human_scale));
        Self { list: out.into_iter().map(drawn).collect(), rest_m: REST_M * plan.human_scale }
    }

    /// By how much each side is shorter than drawn where control points stand at some places, metres; negative where it is
    /// longer.
    pub fn shrunk(&self, now: &Places) -> Vec<f64> {
        let of = |(side, drawn): &(Stretch, [DVec2; 2])| {
            let at = |k: usize| now.get(&side[k].0).map_or(drawn[k], |p| p[side[k].1 as usize]);
            let (was, is) = (drawn[1] - drawn[0], at(1) - at(0));
            was.try_normalize().map_or(0.0, |along| was.length() - is.dot(along))
        };
        self.list.iter().map(of).collect()
    }

    /// Each side with how much shorter it may become, metres.
    pub fn rooms(&self) -> impl Iterator<Item = (&Stretch, f64)> {
        self.list.iter().map(|(side, [a, b])| (side, (a.distance(*b) - self.rest_m).max(0.0)))
    }
}

/// What of the sides of walls is taken by one move after another.
#[derive(Clone, Debug, Default)]
pub(super) struct Ledger(BTreeMap<Stretch, f64>);

impl Ledger {
    /// Takes as much of each side as a move does at most; the first side of which too little is left.
    pub fn take(&mut self, sides: &Stretches, most: &[f64]) -> Option<Stretch> {
        let mut out = None;
        for ((side, room), more) in sides.rooms().zip(most).filter(|s| *s.1 > NOISE_M) {
            let taken = self.0.entry(*side).or_default();
            *taken += more;
            if *taken > room + NOISE_M {
                out = out.or(Some(*side));
            }
        }
        out
    }

    /// The share of a way on which each side becomes so much shorter that the rest of them allows.
    pub fn share(&self, sides: &Stretches, shrunk: &[f64]) -> f64 {
        let left = |(side, room): (&Stretch, f64)| (room - self.0.get(side).copied().unwrap_or(0.0)).max(0.0);
        let shares = sides.rooms().map(left).zip(shrunk).filter(|(_, by)| **by > NOISE_M);
        shares.map(|(left, by)| (left + NOISE_M) / by).fold(1.0, f64::min)
    }
}

/// The sides of straight walls, or the lines that draw them, from one corner on them to the next: also from where another
/// wall ends at a side that is drawn past it.
fn parts(plan: &Plan, axes: &AxisGraph) -> BTreeSet<Stretch> {
    let mut out = BTreeSet::new();
    let ends = ends_on_sides(plan, axes);
    for e in axes.edges.iter().filter(|e| e.bulge == 0.0) {
        for f in e.left.iter().chain(&e.right) {
            let Ok([a, b]) = <Stretch>::try_from(face_handles(plan, *f)) else { continue };
            let from = handle_at(plan, a);
            let place = |h: &Handle| handle_at(plan, *h).distance_squared(from);
            let mut all: Vec<Handle> = ends.get(f).into_iter().flatten().copied().chain([a, b]).collect();
            all.sort_by(|g, h| place(g).total_cmp(&place(h)).then(g.cmp(h)));
            // Two corners of one end are as far apart as it is thick.
            let is_side = |w: &&[Handle]| w[0].0 != w[1].0 || w.contains(&a) && w.contains(&b);
            out.extend(all.windows(2).filter(is_side).map(|w| [w[0], w[1]]));
        }
    }
    out
}

/// The corners of walls that end at a drawn side between its own corners, by that side.
fn ends_on_sides(plan: &Plan, axes: &AxisGraph) -> BTreeMap<FaceRef, BTreeSet<Handle>> {
    let mut at_node = vec![Vec::new(); axes.nodes.len()];
    for e in axes.edges.iter().filter(|e| e.bulge == 0.0) {
        e.nodes.iter().for_each(|n| at_node[*n as usize].push(e));
    }
    let mut out: BTreeMap<FaceRef, BTreeSet<Handle>> = BTreeMap::new();
    for (n, around) in (0u32..).zip(&at_node) {
        for (ending, through) in around.iter().flat_map(|e| around.iter().map(move |f| (*e, *f))) {
            let corners = corners_at(plan, axes, ending, n);
            // A line drawn as wide as a wall is its axis: what ends at the wall stops half its width before.
            let half = if through.left == through.right { through.thickness_m / 2.0 } else { 0.0 };
            for f in through.left.iter().chain(&through.right) {
                let [Some(a), Some(b)] =
                    [0, 1].map(|k| face_handles(plan, *f).get(k).map(|h| handle_at(plan, *h)))
                else {
                    continue;
                };
                let along = (b - a).normalize_or_zero();
                let is_on = |h: &&Handle| {
                    let p = handle_at(plan, **h) - a;
                    let x = p.dot(along);
                    h.0 != f.0
                        && along.perp_dot(p).abs() <= ERROR_GAP_M + half
                        && (ERROR_GAP_M..=a.distance(b) - ERROR_GAP_M).contains(&x)
                };
                let on: Vec<Handle> = corners.iter().filter(is_on).copied().collect();
                // What runs along the side is its own other face, or a lining.
                if on.len() == corners.len() && !on.is_empty() {
                    out.entry(*f).or_default().extend(on);
                }
            }
        }
    }
    out
}

/// The corners of a wall's two sides that are nearer to one of its nodes.
fn corners_at(plan: &Plan, axes: &AxisGraph, edge: &Edge, node: u32) -> Vec<Handle> {
    let at = axes.nodes[node as usize].at;
    let far = |h: &Handle| handle_at(plan, *h).distance(at);
    let of = |f: &FaceRef| face_handles(plan, *f).into_iter().min_by(|g, h| far(g).total_cmp(&far(h)));
    edge.left.iter().chain(&edge.right).filter_map(of).collect()
}

/// The sides of a wall that can change its length, from its ends to what is next on it.
fn sides_of_body(plan: &Plan, w: u32) -> Vec<Stretch> {
    let wall = &plan.walls[w as usize];
    let (Editable::Wall { .. }, Some(along)) = (&wall.editable, along(plan, &[w])) else { return Vec::new() };
    let points = enfilade_cad::curve::control_points(&wall.shape);
    let n = points.len();
    let is_side = |c: &usize| {
        let way = plan.frame.plan_from_file(points[(c + 1) % n]) - plan.frame.plan_from_file(points[*c]);
        way.perp_dot(along).abs() <= SIDE_SIN * way.length()
    };
    (0..n).filter(is_side).map(|c| [(w, c as u32), (w, ((c + 1) % n) as u32)]).collect()
}

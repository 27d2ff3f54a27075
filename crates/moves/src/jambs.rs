//! Ways that end before a door becomes narrower: those of marks where a joint would pass a jamb, those of default moves
//! wherever a door would lose width.

use std::collections::BTreeSet;

use glam::DVec2;

use super::doorways::{is_worth_moving, meet};
use super::narrowed::{Doors, NARROWER_M, Narrowed, at_m, box_round};
use super::{Layout, MovedWall, Moves};
use enfilade_cad::plane::box_of;
use enfilade_engine::geometry::Segment;
use enfilade_plan::Plan;
use enfilade_plan::axes::AxisGraph;
use enfilade_plan::graph::Graph;
use enfilade_plan::markers::{Clause, Kind};

/// What stays between a joint and the jamb that it may not pass, metres of a person.
pub const JAMB_REST_M: f64 = 0.01;

/// Places of a shift lie no farther apart than this, metres, those of a turn than this, degrees, and are no more than so
/// many.
const STEP_M: f64 = 0.25;
const STEP_DEG: f64 = 5.0;
const STEPS_MAX: usize = 40;

/// A shift ends at whole millimetres of a person, a turn at whole degrees.
const PARTS_OF_M: f64 = 1e3;
const PARTS_OF_DEG: f64 = 1.0;

/// Halvings between the last good place and the first bad one: to less than a micrometre.
const HALVINGS: usize = 20;

/// A way that was shortened so that a joint does not pass a door's jamb.
#[derive(Clone, Debug, PartialEq)]
pub struct Shortened {
    /// Index into [`Moves::parameters`].
    pub parameter: usize,
    /// The clause as it was stated.
    pub stated: Clause,
    /// The door it would have narrowed first, as at the first place tried beyond.
    pub door: Narrowed,
}

/// What was done to default moves so that doors stay as wide as they are drawn: indices into [`Moves::parameters`].
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct KeptWide {
    /// Those whose way ends earlier.
    pub shorter: BTreeSet<usize>,
    /// Those of them with no way left that is worth a parameter.
    pub without_way: BTreeSet<usize>,
}

/// Where a way ends.
struct Stop {
    /// The bound in the clause's own unit; `None` where what moves stands at the jamb already.
    bound: Option<f64>,
    /// The door, as at the first place tried beyond.
    door: Narrowed,
}

impl Moves {
    /// Shortens shifts of the user's that, all else as drawn, would take something between the jambs of a door: a joint
    /// may not pass the jamb. Where the door or a jamb of it moves, that is what was asked for; what stands at the jamb
    /// from the start may well be the jamb.
    pub fn keep_doors_wide(&mut self, plan: &Plan, graph: &Graph, axes: &AxisGraph) -> Vec<Shortened> {
        let doors = Doors::new(plan, axes);
        if doors.doors.is_empty() {
            return Vec::new();
        }
        let entered =
            |layout: &Layout| doors.narrowed(layout).into_iter().find(|n| n.is_entered && !n.has_moved);
        let mut out = Vec::new();
        for i in 0..self.parameters.len() {
            let stated = self.parameters[i].clause.clone();
            if !matches!(stated.kind, Kind::X | Kind::Y | Kind::Along(_)) {
                continue;
            }
            let mut clause = stated.clone();
            let mut met = None;
            for (bound, end) in [(&mut clause.lower, stated.lower), (&mut clause.upper, stated.upper)] {
                let mut at = self.identity();
                at[i] = end;
                if !doors.is_near(&self.apply(plan, graph, &at)) {
                    continue;
                }
                let stop = self.stop((plan, graph), (i, end), &self.identity(), &entered);
                if let Some(Stop { bound: Some(way), door }) = stop {
                    (*bound, met) = (way, Some(door));
                }
            }
            if let Some(door) = met {
                self.parameters[i].clause = clause;
                out.push(Shortened { parameter: i, stated, door });
            }
        }
        out
    }

    /// Shortens default moves that would leave a door or a window narrower in any way, alone or with one other: nobody asked for
    /// it. Of two that do it together, the later one gives way.
    pub fn keep_doors_as_drawn(&mut self, plan: &Plan, graph: &Graph, axes: &AxisGraph) -> KeptWide {
        let doors = Doors::and_windows(plan, axes);
        let mut out = KeptWide::default();
        if doors.doors.is_empty() {
            return out;
        }
        let near = self.doors_near(plan, graph, &doors);
        for i in 0..self.parameters.len() {
            let at = self.identity();
            let own = &near[self.parameters[i].group];
            self.keep_one((plan, graph), (&doors, own), (i, &at), &mut out);
        }
        for i in 1..self.parameters.len() {
            for j in 0..i {
                let [own, other] = [i, j].map(|k| &near[self.parameters[k].group]);
                let both: BTreeSet<usize> = own.intersection(other).copied().collect();
                let Clause { lower, upper, .. } = self.parameters[j].clause;
                for end in [lower, upper] {
                    let mut at = self.identity();
                    if both.is_empty() || end == at[j] {
                        continue;
                    }
                    at[j] = end;
                    self.keep_one((plan, graph), (&doors, &both), (i, &at), &mut out);
                }
            }
        }
        let is_none = |i: &usize| !is_worth_moving(&self.parameters[*i].clause, plan.human_scale);
        out.without_way = out.shorter.iter().copied().filter(is_none).collect();
        out
    }

    /// Shortens one way so that some doors stay as wide as they are drawn, all else standing as in `at`.
    fn keep_one(
        &mut self,
        (plan, graph): (&Plan, &Graph),
        (doors, which): (&Doors<'_>, &BTreeSet<usize>),
        (i, at): (usize, &[f64]),
        out: &mut KeptWide,
    ) {
        let found = |layout: &Layout| doors.narrowed_of(layout, which.iter().copied()).into_iter().next();
        let Clause { kind, lower, upper, .. } = self.parameters[i].clause;
        if which.is_empty() || matches!(kind, Kind::Scale(_)) {
            return;
        }
        let way = |end: f64| self.stop((plan, graph), (i, end), at, &found).map(|s| s.bound.unwrap_or(0.0));
        let shorter = [lower, upper].map(way);
        let clause = &mut self.parameters[i].clause;
        for (bound, way) in [&mut clause.lower, &mut clause.upper].into_iter().zip(shorter) {
            if let Some(way) = way {
                *bound = way;
                out.shorter.insert(i);
            }
        }
    }

    /// How far one parameter goes towards a bound, all else standing as in `at`, before a door is found narrower; `None`
    /// where none is.
    fn stop(
        &self,
        (plan, graph): (&Plan, &Graph),
        (i, end): (usize, f64),
        at: &[f64],
        found: &dyn Fn(&Layout) -> Option<Narrowed>,
    ) -> Option<Stop> {
        let clause = &self.parameters[i].clause;
        let (per_unit, step, rest, parts) = match clause.kind {
            Kind::Rotate(_) => (1.0, STEP_DEG, 0.0, PARTS_OF_DEG),
            _ => (clause.si_per_unit / plan.human_scale, STEP_M, NARROWER_M + JAMB_REST_M, PARTS_OF_M),
        };
        let found_at = |value: f64| {
            let mut p = at.to_vec();
            p[i] = value;
            found(&self.apply(plan, graph, &p))
        };
        let steps = ((end * per_unit).abs() / step).ceil().clamp(1.0, STEPS_MAX as f64) as usize;
        let at = |k: usize| end * k as f64 / steps as f64;
        let (k, door) = (1..=steps).find_map(|k| found_at(at(k)).map(|door| (k, door)))?;
        let (mut good, mut bad) = (at(k - 1), at(k));
        for _ in 0..HALVINGS {
            let middle = f64::midpoint(good, bad);
            *(if found_at(middle).is_some() { &mut bad } else { &mut good }) = middle;
        }
        let far = (good * per_unit).abs() - rest;
        let way = (far * parts).floor() / parts / per_unit;
        // No −0: it would be told so.
        Some(Stop { bound: (far > 0.0).then_some(way.copysign(end) + 0.0), door })
    }

    /// The doors at which each group moves anything within its bounds, wherever the others take those doors.
    fn doors_near(&self, plan: &Plan, graph: &Graph, doors: &Doors<'_>) -> Vec<BTreeSet<usize>> {
        let still: Vec<[DVec2; 2]> = doors.doors.iter().map(|d| d.at).collect();
        // How far all groups together take the jambs of each door at most.
        let mut reach = vec![[DVec2::ZERO; 2]; still.len()];
        let mut by_group: Vec<(Vec<[DVec2; 2]>, BTreeSet<usize>)> = Vec::new();
        for group in 0..self.groups.len() {
            let layouts: Vec<Layout> = self.corners_of(group).map(|p| self.apply(plan, graph, &p)).collect();
            let changed = layouts.iter().flat_map(|l| &l.walls).filter(|w| w.is_changed);
            let boxes = changed.flat_map(|w| changed_boxes(plan, w)).collect();
            let mut along = BTreeSet::new();
            for (d, door) in doors.doors.iter().enumerate() {
                let places = layouts.iter().map(|l| door.place(plan, l));
                let steps = places.flat_map(|at| [at[0] - still[d][0], at[1] - still[d][1]]);
                let [lo, hi] = box_of(steps.chain([DVec2::ZERO])).unwrap_or_default();
                reach[d] = [reach[d][0] + lo, reach[d][1] + hi];
                if lo != hi {
                    along.insert(d);
                }
            }
            by_group.push((boxes, along));
        }
        let swept = |d: usize| {
            let [lo, hi] = box_round(&doors.doors[d], still[d]);
            [lo + reach[d][0], hi + reach[d][1]]
        };
        let is_near = |boxes: &[[DVec2; 2]], d: usize| boxes.iter().any(|b| meet(*b, swept(d)));
        let of_group = |(boxes, along): (Vec<[DVec2; 2]>, BTreeSet<usize>)| {
            (0..still.len()).filter(|d| along.contains(d) || is_near(&boxes, *d)).collect()
        };
        by_group.into_iter().map(of_group).collect()
    }
}

/// Boxes round the pieces of a wall that its move changes, as drawn and now, metres of a person.
fn changed_boxes(plan: &Plan, wall: &MovedWall) -> Vec<[DVec2; 2]> {
    let drawn = plan.walls[wall.wall as usize].trace.segments().map(|s| s.2);
    let both = drawn.zip(wall.trace.segments().map(|s| s.2)).filter(|(was, is)| was != is);
    let ends = |s: Segment| [s.a, s.b].map(|p| at_m(plan, p));
    both.filter_map(|(was, is)| box_of(ends(was).into_iter().chain(ends(is)))).collect()
}

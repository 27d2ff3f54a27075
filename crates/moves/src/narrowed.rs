//! Doors that a layout leaves narrower than they are drawn.

use std::collections::BTreeMap;

use glam::DVec2;

use super::Layout;
use super::doorways::{Doorway, doors, meet, seen};
use super::sliding::clipped;
use enfilade_cad::plane::box_of;
use enfilade_engine::geometry::PointUm;
use enfilade_plan::axes::{AxisGraph, OpeningKind};
use enfilade_plan::curve::Trace;
use enfilade_plan::{Plan, Wall};

/// A door counts as narrower where it loses more than this, metres of a person.
pub const NARROWER_M: f64 = 0.005;

/// What lies this far beyond a wall's faces still stands in its door: an end that only touches.
const TOUCH_M: f64 = 0.005;

/// Widths of a door's span that differ by less are one.
const SAME_M: f64 = 1e-3;

/// A door that a layout leaves narrower.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Narrowed {
    /// Its middle as drawn, drawing units.
    pub at: DVec2,
    /// Its clear width as drawn and in the layout, metres.
    pub was_m: f64,
    /// See [`Narrowed::was_m`].
    pub is_m: f64,
    /// A moved wall that reaches into it, else one of its jambs: an index into [`Plan::walls`].
    pub by: u32,
    /// Whether its jambs stand as far apart as drawn: something comes to stand between them.
    pub is_entered: bool,
    /// Whether it stands elsewhere than drawn.
    pub has_moved: bool,
}

impl Narrowed {
    /// Which door it is: where it stands, in the drawing's own coordinates.
    pub fn place_words(&self) -> String {
        let [x, y] = [self.at.x, self.at.y].map(|v| (v * 100.0).round() / 100.0 + 0.0);
        format!("the door at {x}, {y}")
    }
}

/// The doors of a plan.
pub struct Doors<'a> {
    plan: &'a Plan,
    pub(super) doors: Vec<Doorway>,
    /// Boxes of all walls as drawn, metres of a person.
    boxes: Vec<[DVec2; 2]>,
}

impl<'a> Doors<'a> {
    /// The doors that the file names, else those that are understood.
    pub fn new(plan: &'a Plan, axes: &AxisGraph) -> Self {
        let of = |w: &Wall| box_of(w.trace.points.iter().map(|p| at_m(plan, *p))).unwrap_or_default();
        Self { plan, doors: doors(plan, axes), boxes: plan.walls.iter().map(of).collect() }
    }

    /// The same with the windows: no default move leaves a wall standing before one.
    pub fn and_windows(plan: &'a Plan, axes: &AxisGraph) -> Self {
        let mut out = Self::new(plan, axes);
        out.doors.extend(seen(plan, axes, OpeningKind::Window));
        out
    }

    /// Whether what a layout changes comes near a door on its way from where it is drawn.
    pub(super) fn is_near(&self, layout: &Layout) -> bool {
        let Some(hull) = self.hull(layout) else { return false };
        let places = |d: &Doorway| [d.at, d.place(self.plan, layout)];
        self.doors.iter().any(|d| places(d).into_iter().any(|at| meet(box_round(d, at), hull)))
    }

    /// The doors that a layout leaves narrower, in their order.
    pub fn narrowed(&self, layout: &Layout) -> Vec<Narrowed> {
        self.narrowed_of(layout, 0..self.doors.len())
    }

    /// The same of some doors.
    pub(super) fn narrowed_of(&self, layout: &Layout, which: impl Iterator<Item = usize>) -> Vec<Narrowed> {
        let Some(hull) = self.hull(layout) else { return Vec::new() };
        let now: BTreeMap<u32, &Trace> =
            layout.walls.iter().filter(|w| w.is_changed).map(|w| (w.wall, &w.trace)).collect();
        let near = which.map(|d| &self.doors[d]).filter_map(|d| {
            let at = d.place(self.plan, layout);
            (meet(box_round(d, d.at), hull) || meet(box_round(d, at), hull)).then_some((d, at))
        });
        near.filter_map(|(d, at)| self.is_narrower(d, at, &now)).collect()
    }

    fn is_narrower(&self, door: &Doorway, at: [DVec2; 2], now: &BTreeMap<u32, &Trace>) -> Option<Narrowed> {
        let scale = self.plan.human_scale;
        let was = widest(&self.within(door, door.at, &BTreeMap::new()), door.at[0].distance(door.at[1]));
        let inside = self.within(door, at, now);
        let span = at[0].distance(at[1]);
        let is_turned_over = (at[1] - at[0]).dot(door.at[1] - door.at[0]) < 0.0
            && (span - door.at[0].distance(door.at[1])).abs() > SAME_M;
        let is = if is_turned_over { 0.0 } else { widest(&inside, span) };
        if is > was - NARROWER_M {
            return None;
        }
        let reaches = |(w, [lo, hi]): &&(u32, [f64; 2])| {
            now.contains_key(w) && *hi > NARROWER_M && *lo < span - NARROWER_M
        };
        let jamb = || door.jamb_walls().find(|w| now.contains_key(w));
        let by = inside.iter().find(reaches).map(|i| i.0).or_else(jamb);
        Some(Narrowed {
            at: self.plan.frame.file_from_plan(door.at[0].midpoint(door.at[1]) * scale),
            was_m: was * scale,
            is_m: is * scale,
            by: by.or_else(|| now.keys().next().copied())?,
            is_entered: (span - door.at[0].distance(door.at[1])).abs() <= SAME_M,
            has_moved: (0..2).any(|i| at[i].distance(door.at[i]) > SAME_M),
        })
    }

    /// What stands between the jambs of a door, from the first of them on: the walls and where.
    fn within(
        &self,
        door: &Doorway,
        [a, b]: [DVec2; 2],
        now: &BTreeMap<u32, &Trace>,
    ) -> Vec<(u32, [f64; 2])> {
        let (along, width) = ((b - a).normalize_or_zero(), a.distance(b));
        // Across and along, so that what is clipped is the depth of the wall.
        let local = |p: DVec2| DVec2::new(along.perp_dot(p - a), (p - a).dot(along));
        let deep = door.half + TOUCH_M;
        let round = box_round(door, [a, b]);
        let mut out = Vec::new();
        for (w, wall) in self.plan.walls.iter().enumerate() {
            let is_far = !meet(self.boxes[w], round);
            let w = w as u32;
            if is_far && !now.contains_key(&w) || door.is_own_wall(self.plan, w) {
                continue;
            }
            let trace = now.get(&w).copied().unwrap_or(&wall.trace);
            for (part, (_, _, s)) in trace.segments().enumerate() {
                let [p, q] = [s.a, s.b].map(|p| at_m(self.plan, p));
                let found = clipped(local(p), local(q), -deep, deep);
                let Some([lo, hi]) = found.filter(|_| !door.is_own_piece((w, part as u32))) else { continue };
                if hi > 0.0 && lo < width {
                    out.push((w, [lo.max(0.0), hi.min(width)]));
                }
            }
        }
        out
    }

    /// Box of what a layout changes, as drawn and now, metres of a person; `None` where nothing moves.
    fn hull(&self, layout: &Layout) -> Option<[DVec2; 2]> {
        let changed = layout.walls.iter().filter(|w| w.is_changed);
        let both =
            changed.flat_map(|w| w.trace.points.iter().chain(&self.plan.walls[w.wall as usize].trace.points));
        box_of(both.map(|p| at_m(self.plan, *p)))
    }
}

/// A point in metres of a person.
pub(super) fn at_m(plan: &Plan, p: PointUm) -> DVec2 {
    plan.frame.plan_from_um(p) / plan.human_scale
}

/// Box round a door at one place.
pub(super) fn box_round(door: &Doorway, [a, b]: [DVec2; 2]) -> [DVec2; 2] {
    let far = DVec2::splat(door.half + TOUCH_M);
    [a.min(b) - far, a.max(b) + far]
}

/// The widest stretch between two jambs in which nothing stands.
fn widest(inside: &[(u32, [f64; 2])], width: f64) -> f64 {
    let mut taken: Vec<[f64; 2]> = inside.iter().map(|i| i.1).collect();
    taken.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let (mut free, mut reached) = (0.0_f64, 0.0_f64);
    for [lo, hi] in taken {
        free = free.max(lo - reached);
        reached = reached.max(hi);
    }
    free.max(width - reached)
}

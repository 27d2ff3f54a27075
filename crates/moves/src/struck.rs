//! What stands in rooms and is struck by walls that a layout moves: stairs, fixtures, furniture.

use std::borrow::Cow;
use std::collections::BTreeSet;

use glam::DVec2;

use super::carried::{Carried, carried};
use super::{Layout, MovedWall, Moves};
use enfilade_cad::plane::distance_to_segment;
use enfilade_engine::geometry::{PointUm, Segment, Side, UM_PER_M, side_of_ring};
use enfilade_plan::Plan;
use enfilade_plan::curve::{Trace, trace as trace_of};
use enfilade_plan::fittings::{Fitting, FittingKind};
use enfilade_plan::obstacles::{Obstacle, ObstacleKind};

/// Nothing moves farther by default, metres of a person: what is beyond is not looked at.
const REACH_M: f64 = 2.0;

/// What comes no deeper touches, micrometres: rounding, and things that stand at a wall.
const DEPTH_UM: f64 = 5_000.0;

/// A thing near a wall that may move.
#[derive(Clone, Debug)]
struct Near {
    /// Index into [`Plan::walls`].
    wall: u32,
    /// Its record.
    record: usize,
    pieces: Vec<Segment>,
    /// How often the wall runs through it as drawn.
    drawn: usize,
}

/// Furniture that may follow a wall.
#[derive(Clone, Debug)]
struct Carriable {
    fitting: Fitting,
    /// Its box as drawn.
    outline: Trace,
    /// What it could run into: the pieces of walls and things, the walls with their indices, and how often it runs through
    /// each as drawn.
    beside: Vec<(Option<u32>, Vec<Segment>, usize)>,
}

/// The things that moving walls could strike, and the furniture that follows them.
#[derive(Clone, Debug, Default)]
pub struct Struck {
    near: Vec<Near>,
    carriable: Vec<Carriable>,
}

impl Struck {
    /// Those near walls that may move; what goes with doors and walls strikes nothing, but furniture does.
    pub fn new(plan: &Plan, moves: &Moves, fittings: &[Fitting]) -> Self {
        let fitted: BTreeSet<usize> = fittings.iter().map(|f| f.source.record).collect();
        let things = plan.obstacles.iter();
        let things = things.filter(|o| o.kind != ObstacleKind::Door && !fitted.contains(&o.record));
        let boxed = |o: &'_ Obstacle| box_of(o.pieces.iter().flat_map(|s| [s.a, s.b]));
        let things: Vec<_> = things.filter_map(|o| Some((o, boxed(o)?))).collect();
        let reach = (REACH_M * plan.human_scale * UM_PER_M) as i64;
        let is_near = |own: [PointUm; 2], at: [PointUm; 2]| {
            (0..2).all(|k| own[0][k] - reach <= at[1][k] && at[0][k] - reach <= own[1][k])
        };
        let mut near = Vec::new();
        for wall in &moves.walls {
            let trace = &plan.walls[*wall as usize].trace;
            let Some(own) = box_of(trace.points.iter().copied()) else { continue };
            for (thing, _) in things.iter().filter(|t| is_near(own, t.1)) {
                let (record, pieces) = (thing.record, thing.pieces.clone());
                let drawn = through(trace, &pieces);
                near.push(Near { wall: *wall, record, pieces, drawn });
            }
        }
        let pieces_of = |t: &Trace| t.segments().map(|s| s.2).collect::<Vec<Segment>>();
        let handles: BTreeSet<_> = moves.handles().copied().collect();
        let may_go = |f: &&Fitting| match &f.kind {
            FittingKind::Furniture(sides) => sides.iter().flatten().any(|h| handles.contains(h)),
            FittingKind::Part | FittingKind::Loose => false,
        };
        let carriable = fittings.iter().filter(may_go).filter_map(|f| {
            let outline = trace_of(&f.shape, &plan.frame);
            let own = box_of(outline.points.iter().copied())?;
            let walls = (0u32..).zip(&plan.walls).map(|(w, wall)| (Some(w), pieces_of(&wall.trace)));
            let others = things.iter().map(|(thing, _)| (None, thing.pieces.clone()));
            let furniture = fittings.iter().filter(|o| o.is_furniture() && o.source != f.source);
            let furniture = furniture.map(|o| (None, pieces_of(&trace_of(&o.shape, &plan.frame))));
            let all = walls.chain(others).chain(furniture);
            let here = all.filter(|(_, pieces)| {
                box_of(pieces.iter().flat_map(|s| [s.a, s.b])).is_some_and(|at| is_near(own, at))
            });
            let beside = here.map(|(wall, pieces)| {
                let drawn = through(&outline, &pieces);
                (wall, pieces, drawn)
            });
            Some(Carriable { fitting: f.clone(), beside: beside.collect(), outline })
        });
        Self { near, carriable: carriable.collect() }
    }

    /// The things that a layout strikes, by record; furniture that follows and runs into something counts as struck.
    pub fn by(&self, plan: &Plan, layout: &Layout) -> BTreeSet<usize> {
        let moved = layout.walls.iter().filter(|w| w.is_changed);
        let of = |w: u32| {
            let from = self.near.partition_point(|n| n.wall < w);
            self.near[from..].iter().take_while(move |n| n.wall == w)
        };
        let strikes = |m: &&MovedWall, n: &&Near| through(&m.trace, &n.pieces) > n.drawn;
        let by_walls = moved.flat_map(|m| of(m.wall).filter(move |n| strikes(&m, n)).map(|n| n.record));
        let carried = self.carriable.iter().filter(|c| c.strikes(plan, layout));
        by_walls.chain(carried.map(|c| c.fitting.source.record)).collect()
    }
}

impl Carriable {
    /// Whether it runs into something where a layout has it, or a wall into it.
    fn strikes(&self, plan: &Plan, layout: &Layout) -> bool {
        let outline = match carried(plan, &self.fitting, layout) {
            Carried::Moves(shape, _) => Cow::Owned(trace_of(&shape, &plan.frame)),
            Carried::Stays | Carried::Stale(_) => Cow::Borrowed(&self.outline),
        };
        let is_still = matches!(outline, Cow::Borrowed(_));
        self.beside.iter().any(|(wall, pieces, drawn)| {
            let moved = wall.and_then(|w| layout.walls.iter().find(|m| m.wall == w && m.is_changed));
            match moved {
                Some(m) => through(&outline, &m.trace.segments().map(|s| s.2).collect::<Vec<_>>()) > *drawn,
                None => !is_still && through(&outline, pieces) > *drawn,
            }
        })
    }
}

/// How often a wall runs through the pieces of a thing, and how many of their ends stand in it.
fn through(trace: &Trace, pieces: &[Segment]) -> usize {
    let crossed = |p: &Segment| trace.segments().filter(|(.., s)| passes(*s, *p) && passes(*p, *s)).count();
    let is_deep = |at: &PointUm| {
        trace.is_closed
            && side_of_ring(&trace.points, *at) == Side::Inside
            && trace.segments().all(|(.., s)| distance(s, *at) > DEPTH_UM)
    };
    pieces.iter().map(|p| crossed(p) + usize::from(is_deep(&p.a))).sum()
}

fn v(from: PointUm, to: PointUm) -> DVec2 {
    DVec2::new((to[0] - from[0]) as f64, (to[1] - from[1]) as f64)
}

/// Whether the ends of a piece lie on both sides of the line of another, each deep enough.
fn passes(line: Segment, piece: Segment) -> bool {
    let Some(along) = v(line.a, line.b).try_normalize() else { return false };
    let [p, q] = [piece.a, piece.b].map(|at| along.perp_dot(v(line.a, at)));
    p.min(q) < -DEPTH_UM && p.max(q) > DEPTH_UM
}

fn distance(s: Segment, at: PointUm) -> f64 {
    distance_to_segment(DVec2::ZERO, [v(at, s.a), v(at, s.b)])
}

/// Two corners of the box round some points.
pub(super) fn box_of(points: impl Iterator<Item = PointUm>) -> Option<[PointUm; 2]> {
    points.fold(None, |found: Option<[PointUm; 2]>, p| {
        let [lo, hi] = found.unwrap_or([p; 2]);
        Some([[lo[0].min(p[0]), lo[1].min(p[1])], [hi[0].max(p[0]), hi[1].max(p[1])]])
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_stands_at_a_wall_is_struck_once_the_wall_runs_into_it() {
        let m = UM_PER_M as i64;
        let ring = |y: i64| {
            let points = vec![[0, y], [5 * m, y], [5 * m, y + m / 10], [0, y + m / 10]];
            Trace { control: vec![Some(0), Some(1), Some(2), Some(3)], points, is_closed: true }
        };
        // A cabinet of 1 m by 0.6 m whose back stands at the wall's upper face.
        let corners = [[m, m / 10], [2 * m, m / 10], [2 * m, 7 * m / 10], [m, 7 * m / 10]];
        let cabinet: Vec<Segment> =
            (0..4).map(|i| Segment { a: corners[i], b: corners[(i + 1) % 4] }).collect();
        let drawn = through(&ring(0), &cabinet);
        assert_eq!(drawn, 0);
        assert_eq!(through(&ring(-m / 5), &cabinet), 0, "away from it");
        assert_eq!(through(&ring(1), &cabinet), 0, "rounding");
        for by in [m / 20, m / 5, m / 2] {
            assert!(through(&ring(by), &cabinet) > drawn, "{by}");
        }
    }
}

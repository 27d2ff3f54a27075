//! What stands in rooms and is struck by walls that a layout moves: stairs, fixtures, furniture.

use std::collections::BTreeSet;

use super::{Layout, Moves};
use crate::plan::Plan;
use crate::plan::curve::Trace;
use crate::plan::fittings::Fitting;
use crate::plan::geometry::{PointUm, Segment, UM_PER_M, segments_touch};
use crate::plan::obstacles::ObstacleKind;

/// Nothing moves farther by default, metres of a person: what is beyond is not looked at.
const REACH_M: f64 = 2.0;

/// A thing near a wall that may move, which it does not touch as drawn.
#[derive(Clone, Debug)]
struct Near {
    /// Index into [`Plan::walls`].
    wall: u32,
    /// Its record.
    record: usize,
    pieces: Vec<Segment>,
}

/// The things that moving walls could strike.
#[derive(Clone, Debug, Default)]
pub struct Struck(Vec<Near>);

impl Struck {
    /// Those near walls that may move; what goes with doors and walls strikes nothing.
    pub fn new(plan: &Plan, moves: &Moves, fittings: &[Fitting]) -> Self {
        let fitted: BTreeSet<usize> = fittings.iter().map(|f| f.source.record).collect();
        let things =
            plan.obstacles.iter().filter(|o| o.kind != ObstacleKind::Door && !fitted.contains(&o.record));
        let things: Vec<_> =
            things.filter_map(|o| Some((o, box_of(o.pieces.iter().flat_map(|s| [s.a, s.b]))?))).collect();
        let reach = (REACH_M * plan.human_scale * UM_PER_M) as i64;
        let mut out = Vec::new();
        for wall in &moves.walls {
            let trace = &plan.walls[*wall as usize].trace;
            let Some(own) = box_of(trace.points.iter().copied()) else { continue };
            for (thing, at) in &things {
                let is_near = (0..2).all(|k| own[0][k] - reach <= at[1][k] && at[0][k] - reach <= own[1][k]);
                if is_near && !touches(trace, &thing.pieces) {
                    out.push(Near { wall: *wall, record: thing.record, pieces: thing.pieces.clone() });
                }
            }
        }
        Self(out)
    }

    /// The things that a layout strikes, by record.
    pub fn by(&self, layout: &Layout) -> BTreeSet<usize> {
        let moved = layout.walls.iter().filter(|w| w.is_changed);
        let of = |w: u32| {
            let from = self.0.partition_point(|n| n.wall < w);
            self.0[from..].iter().take_while(move |n| n.wall == w)
        };
        moved.flat_map(|m| of(m.wall).filter(|n| touches(&m.trace, &n.pieces)).map(|n| n.record)).collect()
    }
}

fn touches(trace: &Trace, pieces: &[Segment]) -> bool {
    trace.segments().any(|(.., s)| pieces.iter().any(|p| segments_touch(s, *p)))
}

/// Two corners of the box round some points.
pub(super) fn box_of(points: impl Iterator<Item = PointUm>) -> Option<[PointUm; 2]> {
    points.fold(None, |found: Option<[PointUm; 2]>, p| {
        let [lo, hi] = found.unwrap_or([p; 2]);
        Some([[lo[0].min(p[0]), lo[1].min(p[1])], [hi[0].max(p[0]), hi[1].max(p[1])]])
    })
}

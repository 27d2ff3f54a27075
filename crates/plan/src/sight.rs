//! What of the drawn walls stops sight, and what stops it although nothing is drawn (spec 1, openings).
//!
//! Doors and passages are open at every level. Windows are open at eye level and stop sight at knee level. Sight ends where
//! the building does: nobody is seen out of one window and in at another unless the ground between them is measured.
//! Gaps of drawing error are closed.

use std::collections::BTreeMap;

use glam::DVec2;

use super::Plan;
use super::axes::{AxisGraph, FaceRef, Opening, OpeningKind};
use enfilade_cad::curve::control_points;
use enfilade_cad::drawing::Shape;
use enfilade_engine::geometry::{PointUm, Segment, UM_PER_M};

/// Open parts shorter than this are none, as a share of the piece.
const SHARE_MIN: f64 = 1e-9;

/// How far beside what closes a gap its two sides are looked for, metres of a person: the nearest that is no wall.
const BESIDE_M: [f64; 3] = [0.3, 0.6, 0.9];

/// Which parts of the drawn pieces stop sight.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sight {
    /// Open parts of a piece as shares of its length, ascending, apart from each other.
    open: BTreeMap<FaceRef, Vec<[f64; 2]>>,
    /// What stops sight beside the drawn pieces, drawing frame, micrometres.
    pub closed: Vec<Segment>,
    /// Where it ends because the building does, drawing frame, micrometres.
    pub ends: Vec<Segment>,
}

impl Sight {
    /// Decides for all walls of a plan.
    pub fn new(plan: &Plan, axes: &AxisGraph, is_knee: bool) -> Self {
        let mut out = Self::default();
        let segment = |a: DVec2, b: DVec2| Segment {
            a: plan.frame.um_from_plan(a * plan.human_scale),
            b: plan.frame.um_from_plan(b * plan.human_scale),
        };
        for opening in &axes.openings {
            if opening.kind == OpeningKind::Window && is_knee {
                out.closed.push(segment(opening.jambs[0].at, opening.jambs[1].at));
                continue;
            }
            for face in opening.faces.iter().filter(|f| !plan.reading.firm.contains(&f.0)) {
                out.open.entry(*face).or_default().push([0.0, 1.0]);
            }
            for face in &opening.through {
                out.open.entry(*face).or_default().extend(share(plan, *face, opening));
            }
        }
        if !is_knee {
            for face in axes.see_through.iter().filter(|f| !plan.reading.firm.contains(&f.0)) {
                out.open.entry(*face).or_default().push([0.0, 1.0]);
            }
        }
        out.open.values_mut().for_each(|spans| *spans = united(spans));
        out.open.retain(|_, spans| !spans.is_empty());
        out.closed.extend(axes.closures.iter().map(|c| segment(c.a, c.b)));
        out
    }

    /// Whether any drawn piece is open.
    pub fn has_open(&self) -> bool {
        !self.open.is_empty()
    }

    /// Ends sight where the building ends: at doors, windows and what else closes its gaps, where what lies on one side of
    /// them is measured and what lies on the other is not. `closings`: lines across them, drawing frame, micrometres.
    pub fn end_outdoors(
        &mut self,
        closings: &[Segment],
        human_scale: f64,
        side: impl Fn(PointUm) -> Option<bool>,
    ) {
        let is_outer = |s: &&Segment| {
            let [dx, dy] = [0, 1].map(|k| (s.b[k] - s.a[k]) as f64);
            let length = dx.hypot(dy).max(1.0);
            let beside = |sign: f64| {
                BESIDE_M.iter().find_map(|m| {
                    let out = sign * m * human_scale * UM_PER_M / length;
                    let at = |k: usize, d: f64| i64::midpoint(s.a[k], s.b[k]) + (d * out).round() as i64;
                    side([at(0, -dy), at(1, dx)])
                })
            };
            matches!((beside(1.0), beside(-1.0)), (Some(true), Some(false)) | (Some(false), Some(true)))
        };
        self.ends.extend(closings.iter().filter(is_outer));
    }

    /// Lets whole walls stop sight: doors and glass that are named as walls.
    pub fn close(&mut self, is_closed: impl Fn(u32) -> bool) {
        self.open.retain(|(wall, _), _| !is_closed(*wall));
    }

    /// The parts of a drawn piece that stop sight. `s` is the piece, or one of its chords.
    pub fn blocking(&self, face: FaceRef, s: Segment) -> impl Iterator<Item = Segment> + '_ {
        let spans: &[[f64; 2]] = self.open.get(&face).map_or(&[], Vec::as_slice);
        (0..=spans.len()).filter_map(move |i| {
            let from = if i == 0 { 0.0 } else { spans[i - 1][1] };
            let to = spans.get(i).map_or(1.0, |span| span[0]);
            let is_part = to - from > SHARE_MIN || spans.is_empty();
            is_part.then(|| Segment { a: at(s, from), b: at(s, to) })
        })
    }
}

fn at(s: Segment, share: f64) -> [i64; 2] {
    if share <= 0.0 {
        return s.a;
    }
    if share >= 1.0 {
        return s.b;
    }
    [0, 1].map(|k| s.a[k] + ((s.b[k] - s.a[k]) as f64 * share).round() as i64)
}

/// The part of a straight piece that lies between the jambs of an opening.
fn share(plan: &Plan, (wall, part): FaceRef, opening: &Opening) -> Option<[f64; 2]> {
    let shape = &plan.walls[wall as usize].shape;
    if let Shape::Polyline { vertices, .. } = shape
        && vertices.get(part as usize)?.bulge != 0.0
    {
        return None;
    }
    let points = control_points(shape);
    let ends = [*points.get(part as usize)?, points[(part as usize + 1) % points.len()]];
    let [a, b] = ends.map(|p| plan.frame.plan_from_file(p) / plan.human_scale);
    let d = b - a;
    let along = |p: DVec2| (p - a).dot(d) / d.length_squared();
    let [s, t] = opening.jambs.map(|j| along(j.at).clamp(0.0, 1.0));
    (d.length_squared() > 0.0 && s != t).then_some([s.min(t), s.max(t)])
}

/// Overlapping spans joined, ascending.
fn united(spans: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut sorted = spans.to_vec();
    sorted.sort_by(|x, y| x[0].total_cmp(&y[0]));
    let mut out: Vec<[f64; 2]> = Vec::new();
    for s in sorted {
        match out.last_mut() {
            Some(last) if s[0] <= last[1] => last[1] = last[1].max(s[1]),
            _ => out.push(s),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sight(spans: &[[f64; 2]]) -> Sight {
        let open = BTreeMap::from([((0, 0), united(spans))]);
        Sight { open, ..Sight::default() }
    }

    #[test]
    fn a_piece_is_open_between_jambs_and_closed_elsewhere() {
        let whole = Segment { a: [0, 0], b: [10_000_000, 0] };
        let parts = |spans: &[[f64; 2]]| -> Vec<[i64; 2]> {
            sight(spans).blocking((0, 0), whole).map(|s| [s.a[0], s.b[0]]).collect()
        };
        assert_eq!(parts(&[]), [[0, 10_000_000]]);
        assert_eq!(parts(&[[0.2, 0.3]]), [[0, 2_000_000], [3_000_000, 10_000_000]]);
        assert_eq!(parts(&[[0.25, 0.5], [0.2, 0.3]]), [[0, 2_000_000], [5_000_000, 10_000_000]]);
        assert_eq!(parts(&[[0.0, 0.5]]), [[5_000_000, 10_000_000]]);
        assert!(parts(&[[0.0, 1.0]]).is_empty());
        assert_eq!(sight(&[[0.2, 0.3]]).blocking((0, 1), whole).count(), 1);
        for (closed, count) in [(0, 1), (1, 2)] {
            let mut sight = sight(&[[0.2, 0.3]]);
            sight.close(|wall| wall == closed);
            assert_eq!(sight.blocking((0, 0), whole).count(), count);
        }
    }
}

//! Where something that cannot stand elsewhere keeps people from a wall: nobody makes an opening there.

use enfilade_engine::geometry::Segment;
use enfilade_plan::Plan;
use enfilade_plan::obstacles::{BEFORE_DOOR_M, ObstacleKind};
use glam::DVec2;

use crate::walls::Wall;

/// Stretches of a wall before which something fixed stands, on either side, metres along it; ascending and apart.
pub(crate) fn blocked_m(plan: &Plan, wall: &Wall) -> Vec<[f64; 2]> {
    let fixed = plan.obstacles.iter().filter(|o| o.kind == ObstacleKind::Fixed);
    let mut all: Vec<[f64; 2]> =
        fixed.flat_map(|o| &o.pieces).filter_map(|s| before(plan, wall, *s)).collect();
    all.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut out: Vec<[f64; 2]> = Vec::new();
    for next in all {
        match out.last_mut().filter(|last| next[0] <= last[1]) {
            Some(last) => last[1] = last[1].max(next[1]),
            None => out.push(next),
        }
    }
    out
}

/// The part of a piece that stands before a wall, along it.
fn before(plan: &Plan, wall: &Wall, piece: Segment) -> Option<[f64; 2]> {
    let [a, b] = [piece.a, piece.b].map(|p| {
        let d = plan.frame.plan_from_um(p) - wall.at;
        DVec2::new(d.dot(wall.along), wall.along.perp_dot(d))
    });
    let reach = wall.thickness_m / 2.0 + BEFORE_DOOR_M * plan.human_scale;
    // The share of the piece that lies within reach of the axis.
    let [mut from, mut to] = [0.0f64, 1.0];
    let rise = b.y - a.y;
    for (limit, is_upper) in [(reach, true), (-reach, false)] {
        let (at_a, at_b) = if is_upper { (limit - a.y, limit - b.y) } else { (a.y - limit, b.y - limit) };
        if at_a < 0.0 && at_b < 0.0 {
            return None;
        }
        if at_a < 0.0 {
            from = from.max((limit - a.y) / rise);
        } else if at_b < 0.0 {
            to = to.min((limit - a.y) / rise);
        }
    }
    let along = [from, to].map(|t| a.x + (b.x - a.x) * t);
    let [lo, hi] = [along[0].min(along[1]), along[0].max(along[1])];
    (from <= to && hi >= 0.0 && lo <= wall.length_m).then_some([lo, hi])
}

/// The longest run of a stretch before which nothing stands.
pub(crate) fn free_run_m(blocked: &[[f64; 2]], [from, to]: [f64; 2]) -> f64 {
    let mut at = from;
    let mut longest: f64 = 0.0;
    for [start, end] in blocked.iter().filter(|b| b[1] > from && b[0] < to) {
        longest = longest.max(start - at);
        at = at.max(*end);
    }
    longest.max(to - at)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_free_run_of_a_stretch() {
        let blocked = [[1.0, 1.5], [3.0, 3.2]];
        for (stretch, free) in [
            ([0.0, 0.9], 0.9),
            ([0.5, 2.9], 1.4),
            ([1.1, 1.4], 0.0),
            ([1.2, 2.1], 0.6),
            ([0.0, 4.0], 1.5),
            ([3.1, 4.0], 0.8),
        ] {
            let found = free_run_m(&blocked, stretch);
            assert!((found - free).abs() < 1e-9, "{stretch:?}: {found}");
        }
        assert_eq!(free_run_m(&[], [1.0, 3.0]), 2.0);
    }
}

//! Minimum passage width: walls that move must not narrow a way between walls below it.

use super::pairs::{Aabb, BoxGrid, sweep};
use super::{Layout, Meeting, TOUCH_M, WallPiece, common_length_m, meeting};
use enfilade_cad::plane::is_inside_ring;
use glam::DVec2;

/// Metres by which passages have become too narrow, over all pairs of walls of which one may move.
///
/// A passage is the shortest line between two walls where no third wall stands across it. It is too
/// narrow by what its width lacks to the wanted width; where it was narrower than that before, to the
/// width it had: what the drawing has is nobody's fault. It leaves and reaches walls on their free sides: what the body
/// of a wall fills does not count, whether that is drawn as two faces, a box or one outline with all others.
/// Two walls that come to touch close the passage, which `disconnection` judges.
#[derive(Clone, Debug)]
pub struct Passage {
    width_m: f64,
    within: Option<Vec<Vec<DVec2>>>,
    initial: Vec<WallPiece>,
    moving: Vec<usize>,
    fixed: Vec<usize>,
    fixed_grid: BoxGrid,
}

impl Passage {
    /// For a wanted width, metres, > 0; `within`: outlines, metres, plan frame, in one of which a passage must lie or
    /// reach to count.
    pub fn new(initial: &Layout<'_>, width_m: f64, within: Option<Vec<Vec<DVec2>>>) -> Self {
        let pieces = initial.pieces;
        let (moving, fixed): (Vec<_>, Vec<_>) = (0..pieces.len()).partition(|&i| pieces[i].is_moving);
        let boxes =
            fixed.iter().map(|&i| Aabb::of_segment(pieces[i].ends(), width_m + pieces[i].half_m)).collect();
        Self { width_m, within, initial: pieces.to_vec(), moving, fixed, fixed_grid: BoxGrid::new(boxes) }
    }

    /// The penalty, metres, ≥ 0. `now` lists the pieces of the initial layout in the same order.
    pub fn measure_m(&self, now: &Layout<'_>) -> f64 {
        let mut sum_m = 0.0;
        self.for_each_pair(now, |_, missing_m| sum_m += missing_m);
        sum_m
    }

    /// What the penalty counts, pair by pair: the two pieces that stand too near, and by how many metres.
    pub fn pairs_m(&self, now: &Layout<'_>) -> Vec<([usize; 2], f64)> {
        let mut out = Vec::new();
        self.for_each_pair(now, |pair, missing_m| out.extend((missing_m > 0.0).then_some((pair, missing_m))));
        out
    }

    /// Calls `visit` with every two pieces between which a way may be too narrow, and by how much it is.
    fn for_each_pair(&self, now: &Layout<'_>, mut visit: impl FnMut([usize; 2], f64)) {
        let around = |far_m: f64| {
            let of = |&i: &usize| Aabb::of_segment(now.pieces[i].ends(), far_m + now.pieces[i].half_m);
            self.moving.iter().map(of).collect::<Vec<Aabb>>()
        };
        let (boxes, wide) = (around(0.0), around(self.width_m / 2.0));
        let mut missing = |i: usize, j: usize| visit([i, j], self.missing_m(now.pieces, i, j));
        for (k, aabb) in boxes.iter().enumerate() {
            self.fixed_grid.visit(aabb, |f| missing(self.moving[k], self.fixed[f]));
        }
        sweep(&wide, |i, j| missing(self.moving[i], self.moving[j]));
    }

    fn missing_m(&self, now: &[WallPiece], i: usize, j: usize) -> f64 {
        let (p, q) = (&now[i], &now[j]);
        let halves_m = p.half_m + q.half_m;
        let clear_m = |p: &WallPiece, q: &WallPiece| match meeting(p.ends(), q.ends()) {
            Meeting::Apart(gap_m) if gap_m > halves_m + TOUCH_M => Some(gap_m - halves_m),
            _ => None,
        };
        let Some(gap_m) = clear_m(p, q) else { return 0.0 };
        if p.nodes.iter().any(|n| q.nodes.contains(n)) || gap_m >= self.width_m || !are_open(p, q) {
            return 0.0;
        }
        let was_m = clear_m(&self.initial[i], &self.initial[j]).unwrap_or(0.0);
        let missing_m = was_m.min(self.width_m) - gap_m;
        if missing_m > TOUCH_M && self.counts(p.ends(), q.ends()) && self.is_free(now, i, j) {
            missing_m
        } else {
            0.0
        }
    }

    /// Whether the narrow stretch between two walls lies in the outlines or reaches into one.
    fn counts(&self, p: [DVec2; 2], q: [DVec2; 2]) -> bool {
        let Some(outlines) = &self.within else { return true };
        let stretch = self.stretch(p, q);
        let reaches = |ring: &Vec<DVec2>| {
            let meets = |s: [DVec2; 2]| sides(ring).any(|r| !matches!(meeting(s, r), Meeting::Apart(_)));
            sides(&stretch).any(meets)
                || is_inside_ring(ring, stretch[0])
                || is_inside_ring(&stretch, ring[0])
        };
        outlines.iter().filter(|ring| !ring.is_empty()).any(reaches)
    }

    /// Where two walls stand nearer than the wanted width, as the ring of the shortest lines from their ends.
    fn stretch(&self, p: [DVec2; 2], q: [DVec2; 2]) -> [DVec2; 4] {
        let from = [(p[0], q), (p[1], q), (q[0], p), (q[1], p)].map(|(x, s)| (x, nearest(x, s)));
        let lines = [from[0], from[1], (from[2].1, from[2].0), (from[3].1, from[3].0)];
        let along = |line: &(DVec2, DVec2)| line.0.dot(p[1] - p[0]);
        let narrow = lines.into_iter().filter(|l| l.0.distance(l.1) < self.width_m);
        let mut narrow: Vec<(DVec2, DVec2)> = narrow.collect();
        narrow.sort_by(|a, b| along(a).total_cmp(&along(b)));
        let shortest = shortest(p, q);
        let first = narrow.first().copied().unwrap_or((shortest[0], shortest[1]));
        let last = narrow.last().copied().unwrap_or(first);
        [first.0, last.0, last.1, first.1]
    }

    /// Whether no third wall stands across the shortest line between two, or runs along it: between a wall and the jamb
    /// that ends the next one lies a wall, and nobody goes there. What meets it at its ends alone is the next side of one of
    /// the two.
    fn is_free(&self, now: &[WallPiece], i: usize, j: usize) -> bool {
        let line = shortest(now[i].ends(), now[j].ends());
        let stands_across = |k: usize| {
            let ends = now[k].ends();
            let is_in_it = || common_length_m(line, ends).is_some_and(|m| m > TOUCH_M);
            k != i && k != j && (meets_within(line, ends) || is_in_it())
        };
        let mut free = !self.moving.iter().any(|&k| stands_across(k));
        if free {
            self.fixed_grid.visit(&Aabb::of_segment(line, 0.0), |f| free &= !stands_across(self.fixed[f]));
        }
        free
    }
}

/// Whether a piece meets a line anywhere but at the line's ends.
fn meets_within(line: [DVec2; 2], piece: [DVec2; 2]) -> bool {
    let (u, v) = (line[1] - line[0], piece[1] - piece[0]);
    let turn = u.perp_dot(v);
    let between = piece[0] - line[0];
    let (s, t) = (between.perp_dot(v) / turn, between.perp_dot(u) / turn);
    let at_m = s * u.length();
    turn != 0.0 && (TOUCH_M..=u.length() - TOUCH_M).contains(&at_m) && (0.0..=1.0).contains(&t)
}

/// Whether the shortest line between two pieces runs outside the bodies of their walls where it leaves them.
fn are_open(p: &WallPiece, q: &WallPiece) -> bool {
    let [a, b] = shortest(p.ends(), q.ends());
    let is_free = |w: &WallPiece, out: DVec2| {
        let into = w.into_body().map_or(0.0, |n| n.dot(out));
        into <= INTO_BODY * out.length()
    };
    is_free(p, b - a) && is_free(q, a - b)
}

/// A line runs into a wall where the sine of its angle to the face is more than this: faces are drawn a little askew.
const INTO_BODY: f64 = 0.02;

/// The shortest line between two segments that do not meet, from `p` to `q`. Between parallel ones it is the middle of all
/// that are as short: those at their ends may run along the wall at which both stand.
fn shortest(p: [DVec2; 2], q: [DVec2; 2]) -> [DVec2; 2] {
    let from = p.map(|x| [x, nearest(x, q)]);
    let to = q.map(|x| [nearest(x, p), x]);
    let lines = [from[0], from[1], to[0], to[1]];
    let length_m = |line: &[DVec2; 2]| line[0].distance(line[1]);
    let least_m = lines.iter().map(length_m).fold(f64::INFINITY, f64::min);
    let mut tied = lines.iter().filter(|line| length_m(line) <= least_m + TOUCH_M);
    let first = *tied.next().unwrap_or(&lines[0]);
    // Of the lines at both ends of an overlap the outermost two have its middle between them.
    let farthest =
        tied.fold(
            first,
            |far, line| if line[0].distance(first[0]) > far[0].distance(first[0]) { *line } else { far },
        );
    [first[0].midpoint(farthest[0]), first[1].midpoint(farthest[1])]
}

/// The point of a segment that is nearest to `x`.
fn nearest(x: DVec2, s: [DVec2; 2]) -> DVec2 {
    let along = s[1] - s[0];
    let square = along.length_squared();
    let t = if square > 0.0 { ((x - s[0]).dot(along) / square).clamp(0.0, 1.0) } else { 0.0 };
    s[0] + along * t
}

/// The sides of a ring that is not closed by a repeated point.
fn sides(ring: &[DVec2]) -> impl Iterator<Item = [DVec2; 2]> {
    (0..ring.len()).map(|i| [ring[i], ring[(i + 1) % ring.len()]])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::BodySide;

    fn wall(a: [f64; 2], b: [f64; 2], node: u32, is_moving: bool) -> WallPiece {
        WallPiece {
            a: a.into(),
            b: b.into(),
            nodes: [node, node + 1],
            is_moving,
            solid: None,
            bar: None,
            body: None,
            half_m: 0.0,
        }
    }

    /// A fixed wall up to (0, 0), and a moving one that goes on from (x, 0).
    fn door(x: f64) -> Vec<WallPiece> {
        vec![wall([-3.0, 0.0], [0.0, 0.0], 0, false), wall([x, 0.0], [4.0, 0.0], 2, true)]
    }

    fn missing(initial: &[WallPiece], now: &[WallPiece]) -> f64 {
        Passage::new(&Layout { pieces: initial }, 0.9, None).measure_m(&Layout { pieces: now })
    }

    /// Two partitions that stand at one wall leave a slot, and that wall does not fill it.
    #[test]
    fn a_slot_between_walls_that_stand_at_one_wall_is_a_way() {
        let room = |x: f64| {
            let mut all = vec![wall([x, 0.0], [x, 5.0], 0, true), wall([4.0, 0.0], [4.0, 5.0], 2, false)];
            all.push(wall([0.0, 0.0], [9.0, 0.0], 4, false));
            all
        };
        assert_eq!(missing(&room(1.0), &room(3.0)), 0.0);
        assert!((missing(&room(1.0), &room(3.3)) - 0.2).abs() < 1e-12);
    }

    /// A wall's two faces, 0.1 m apart, of which one alone moves; and a corner that comes nearer to the jamb at which the
    /// next wall ends.
    #[test]
    fn what_a_wall_fills_is_no_way() {
        let face = |y: f64, is_moving: bool, node: u32| {
            let wall = wall([0.0, y], [4.0, y], node, is_moving);
            let body = if node == 0 { BodySide::Left } else { BodySide::Right };
            WallPiece { body: Some(body), ..wall }
        };
        let faces = |y: f64| vec![face(y, true, 0), face(0.1, false, 2)];
        assert_eq!(missing(&faces(0.0), &faces(0.05)), 0.0);
        let alone = |y: f64| faces(y).into_iter().map(|w| WallPiece { body: None, ..w }).collect::<Vec<_>>();
        assert!(missing(&alone(0.0), &alone(0.05)) > 0.0, "of two walls it is one");
        // From the corner at x the next wall's face runs to its jamb at 0.6.
        let stub = |x: f64| {
            let mut all = vec![wall([x, 0.0], [x, 4.0], 0, true), wall([0.6, 0.0], [0.6, -0.2], 2, false)];
            all.push(WallPiece { nodes: [0, 2], ..wall([x, 0.0], [0.6, 0.0], 0, true) });
            all
        };
        assert_eq!(missing(&stub(0.0), &stub(0.3)), 0.0);
        let open = |x: f64| stub(x)[..2].to_vec();
        assert!(missing(&open(0.0), &open(0.3)) > 0.0, "without that face it is a way");
    }

    #[test]
    fn a_door_counts_what_it_lacks() {
        assert!((missing(&door(1.0), &door(0.7)) - 0.2).abs() < 1e-12);
        assert_eq!(missing(&door(1.0), &door(0.9)), 0.0);
        assert_eq!(missing(&door(1.0), &door(0.0)), 0.0, "closed is no narrow passage");
        assert_eq!(missing(&door(0.7), &door(0.7)), 0.0, "as drawn");
        assert_eq!(missing(&door(0.7), &door(0.8)), 0.0, "wider than drawn");
        assert!((missing(&door(0.7), &door(0.6)) - 0.1).abs() < 1e-12);
    }

    #[test]
    fn where_a_place_is_named_passages_elsewhere_do_not_count() {
        let missing = |place: [f64; 4]| {
            let [x0, y0, x1, y1] = place;
            let ring = [[x0, y0], [x1, y0], [x1, y1], [x0, y1]].map(DVec2::from).to_vec();
            let (initial, now) = (door(1.0), door(0.7));
            let passage = Passage::new(&Layout { pieces: &initial }, 0.9, Some(vec![ring]));
            passage.measure_m(&Layout { pieces: &now })
        };
        for (place, counts) in [
            ([-1.0, -1.0, 2.0, 1.0], true),
            ([0.3, -1.0, 0.4, 1.0], true),
            ([0.6, -1.0, 2.0, 1.0], true),
            ([0.8, -1.0, 2.0, 1.0], false),
            ([-1.0, 0.5, 2.0, 1.0], false),
        ] {
            assert_eq!(missing(place) > 0.19, counts, "{place:?}");
        }
        // Along two walls side by side the passage is as long as they are.
        let corridor =
            |x: f64| vec![wall([0.0, 0.0], [0.0, 9.0], 0, false), wall([x, 9.0], [x, 0.0], 2, true)];
        for (y, counts) in [(0.2, true), (4.0, true), (8.5, true), (9.5, false)] {
            let ring = vec![DVec2::new(0.3, y), DVec2::new(0.4, y), DVec2::new(0.4, y + 0.1)];
            let passage = Passage::new(&Layout { pieces: &corridor(1.0) }, 0.9, Some(vec![ring]));
            assert_eq!(passage.measure_m(&Layout { pieces: &corridor(0.7) }) > 0.19, counts, "{y}");
        }
    }

    #[test]
    fn behind_a_third_wall_there_is_no_passage() {
        let with = |x: f64| {
            let mut all = door(x);
            all.push(wall([0.3, -1.0], [0.3, 1.0], 4, false));
            all
        };
        // The third wall leaves 0.4 m to the moving end, not the 0.7 m to the fixed one.
        assert!((missing(&with(1.2), &with(0.7)) - 0.5).abs() < 1e-12);
    }
}

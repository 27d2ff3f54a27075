//! How deep walls stand in solids: what an outline hides altogether crosses nothing.

use std::ops::Range;

use glam::DVec2;

use super::pairs::{Aabb, BoxGrid, sweep};
use super::{Layout, TOUCH_M, WallPiece, is_convex};

/// The solids of a layout, and the other pieces, each a body of its own. A body is named by its first piece.
#[derive(Clone, Debug)]
pub struct Bodies {
    moving: Vec<Body>,
    standing: Vec<Placed>,
    standing_grid: BoxGrid,
    /// The body of every piece.
    of_piece: Vec<usize>,
}

#[derive(Clone, Debug)]
struct Body {
    pieces: Range<usize>,
    is_solid: bool,
}

/// A body where it stands.
#[derive(Clone, Debug)]
struct Placed {
    name: usize,
    is_solid: bool,
    aabb: Aabb,
    corners: Vec<DVec2>,
    /// Convex parts that make up the body; found when they are asked for.
    parts: Option<Vec<Vec<DVec2>>>,
}

impl Bodies {
    /// Sorts what may move from what stands. Where there is no solid, there is nothing to stand in.
    pub fn new(initial: &Layout<'_>) -> Self {
        let all = bodies(initial.pieces);
        let mut of_piece = vec![0; initial.pieces.len()];
        all.iter().for_each(|b| of_piece[b.pieces.clone()].fill(b.pieces.start));
        let may_move = |b: &Body| initial.pieces[b.pieces.clone()].iter().any(|p| p.is_moving);
        let (mut moving, standing): (Vec<_>, Vec<_>) = all.into_iter().partition(may_move);
        let is_solid_moving = moving.iter().any(|b| b.is_solid);
        let can_meet = |b: &Body| b.is_solid || is_solid_moving;
        let standing: Vec<Placed> =
            standing.iter().filter(|b| can_meet(b)).map(|b| b.placed(initial.pieces)).collect();
        if !is_solid_moving && standing.is_empty() {
            moving.clear();
        }
        let standing_grid = BoxGrid::new(standing.iter().map(|b| b.aabb).collect());
        let mut out = Self { moving, standing, standing_grid, of_piece };
        out.standing.iter_mut().for_each(Placed::cut);
        out
    }

    /// The body that a piece belongs to.
    pub fn of(&self, piece: usize) -> usize {
        self.of_piece[piece]
    }

    /// Calls `visit([i, j], metres)`, i < j, for every two bodies, one of them a solid, of which one may move and
    /// stands in the other; `is_known` says which pairs are not looked at.
    pub fn for_each(
        &self,
        pieces: &[WallPiece],
        is_known: impl Fn([usize; 2]) -> bool,
        mut visit: impl FnMut([usize; 2], f64),
    ) {
        let mut now: Vec<Placed> = self.moving.iter().map(|b| b.placed(pieces)).collect();
        let mut near = Vec::new();
        for (k, p) in now.iter().enumerate() {
            self.standing_grid.visit(&p.aabb, |f| near.push((k, f, true)));
        }
        let boxes: Vec<Aabb> = now.iter().map(|b| b.aabb).collect();
        sweep(&boxes, |i, j| near.push((i, j, false)));
        for (i, j, stands) in near {
            let other = if stands { &self.standing[j] } else { &now[j] };
            let names = [now[i].name.min(other.name), now[i].name.max(other.name)];
            if !(now[i].is_solid || other.is_solid) || is_known(names) {
                continue;
            }
            now[i].cut();
            if !stands {
                now[j].cut();
            }
            let other = if stands { &self.standing[j] } else { &now[j] };
            let depth_m = now[i].depth_m(other);
            if depth_m > TOUCH_M {
                visit(names, depth_m);
            }
        }
    }
}

/// The solids, and every other piece by itself.
fn bodies(pieces: &[WallPiece]) -> Vec<Body> {
    let mut out = Vec::new();
    let mut start = 0;
    for run in pieces.chunk_by(|p, q| p.solid == q.solid) {
        let end = start + run.len();
        match run[0].solid {
            Some(_) => out.push(Body { pieces: start..end, is_solid: true }),
            None => out.extend((start..end).map(|i| Body { pieces: i..i + 1, is_solid: false })),
        }
        start = end;
    }
    out
}

impl Body {
    fn placed(&self, pieces: &[WallPiece]) -> Placed {
        let own = &pieces[self.pieces.clone()];
        let corners: Vec<DVec2> =
            if self.is_solid { own.iter().map(|p| p.a).collect() } else { own[0].ends().to_vec() };
        let aabb = Aabb::of_points(&corners, 0.0);
        Placed { name: self.pieces.start, is_solid: self.is_solid, aabb, corners, parts: None }
    }
}

impl Placed {
    /// Finds the convex parts.
    fn cut(&mut self) {
        if self.parts.is_none() {
            let is_whole = !self.is_solid || is_convex(&self.corners);
            self.parts = Some(if is_whole { vec![self.corners.clone()] } else { triangles(&self.corners) });
        }
    }

    /// By how much one of two bodies would have to draw back to leave the other: that of the convex parts that stand
    /// deepest in each other.
    fn depth_m(&self, other: &Self) -> f64 {
        let parts = |b: &'_ Self| b.parts.clone().unwrap_or_default();
        let theirs = parts(other);
        let pairs = parts(self).into_iter().flat_map(|p| theirs.iter().map(move |q| depth_m(&p, q)));
        pairs.fold(0.0, f64::max)
    }
}

/// The shortest way by which one of two convex outlines leaves the other, metres; 0 where they have no inner point in
/// common. It is across an edge of one of them.
fn depth_m(p: &[DVec2], q: &[DVec2]) -> f64 {
    let mut least_m = f64::INFINITY;
    for ring in [p, q] {
        for (a, b) in ring.iter().zip(ring.iter().cycle().skip(1)) {
            let Some(across) = (*b - *a).try_normalize().map(DVec2::perp) else { continue };
            let (p, q) = (reach(p, across), reach(q, across));
            least_m = least_m.min(p[1] - q[0]).min(q[1] - p[0]);
            if least_m <= TOUCH_M {
                return 0.0;
            }
        }
    }
    if least_m.is_finite() { least_m } else { 0.0 }
}

/// How far points reach in a direction.
fn reach(points: &[DVec2], direction: DVec2) -> [f64; 2] {
    let along = points.iter().map(|p| p.dot(direction));
    along.fold([f64::INFINITY, f64::NEG_INFINITY], |[lo, hi], v| [lo.min(v), hi.max(v)])
}

/// The triangles of an outline, by cutting off its ears; of one that crosses itself, what can be cut off.
fn triangles(ring: &[DVec2]) -> Vec<Vec<DVec2>> {
    let area: f64 = ring.iter().zip(ring.iter().cycle().skip(1)).map(|(a, b)| a.perp_dot(*b)).sum();
    let mut left = ring.to_vec();
    if area < 0.0 {
        left.reverse();
    }
    let mut out = Vec::new();
    while left.len() > 3 {
        let count = left.len();
        let corners = |i: usize| [left[(i + count - 1) % count], left[i], left[(i + 1) % count]];
        let Some(ear) = (0..count).find(|&i| is_ear(&left, corners(i))) else { break };
        out.push(corners(ear).to_vec());
        left.remove(ear);
    }
    if left.len() == 3 {
        out.push(left);
    }
    out
}

/// Whether three corners in turn of a ring that runs anticlockwise can be cut off.
fn is_ear(ring: &[DVec2], [a, b, c]: [DVec2; 3]) -> bool {
    let turn = |p: DVec2, q: DVec2, r: DVec2| (q - p).perp_dot(r - p);
    let is_in = |p: &DVec2| {
        let is_corner = *p == a || *p == b || *p == c;
        !is_corner && turn(a, b, *p) >= 0.0 && turn(b, c, *p) >= 0.0 && turn(c, a, *p) >= 0.0
    };
    turn(a, b, c) >= 0.0 && !ring.iter().any(is_in)
}

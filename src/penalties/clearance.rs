//! Clearance: room between walls to build and to pass (spec section 5; paper: Penalty Metrics).

use super::capsule::overlap_m2;
use super::pairs::{Aabb, BoxGrid, sweep};
use super::{Layout, Meeting, TOUCH_M, WallPiece, meeting};
use glam::DVec2;

/// The paper's radius r of the disc that widens each wall, metres.
pub const RADIUS_M: f64 = 0.5;

/// `clr = Σ_{i<j} A((w_i ⊕ D_r) ∩ (w_j ⊕ D_r))` over pairs of walls that do not touch and of which one
/// may move. The penalty is `clr²`; this measures clr.
///
/// A wall is one piece, or several that go straight on through nodes where nothing else meets; both
/// that and touching are judged in the layout measured.
#[derive(Clone, Debug)]
pub struct Clearance {
    radius_m: f64,
    /// Chains with at least one piece that may move, each piece with whether it runs backwards.
    chains: Vec<Chain>,
    fixed: Vec<Wall>,
    fixed_grid: BoxGrid,
}

/// Pieces joined end to end by nodes at which exactly two pieces meet.
#[derive(Clone, Debug)]
struct Chain {
    links: Vec<Link>,
    /// Whether the last piece joins the first.
    is_ring: bool,
}

#[derive(Clone, Copy, Debug)]
struct Link {
    piece: usize,
    /// Whether it runs from `b` to `a`.
    is_reversed: bool,
}

/// A straight wall of the layout measured.
#[derive(Clone, Copy, Debug)]
struct Wall {
    ends: [DVec2; 2],
    /// Nodes at both ends.
    nodes: [u32; 2],
    is_moving: bool,
}

impl Clearance {
    /// Sorts the walls of the initial layout into those that may move and those that stand.
    pub fn new(initial: &Layout<'_>, radius_m: f64) -> Self {
        let (chains, standing): (Vec<_>, Vec<_>) = chains(initial.pieces)
            .into_iter()
            .partition(|c| c.links.iter().any(|l| initial.pieces[l.piece].is_moving));
        let fixed = walls(&standing, initial.pieces);
        let boxes = fixed.iter().map(|w| Aabb::of_segment(w.ends, radius_m)).collect();
        Self { radius_m, chains, fixed, fixed_grid: BoxGrid::new(boxes) }
    }

    /// clr of a layout, m², ≥ 0. `now` lists the pieces of the initial layout in the same order.
    pub fn measure_m2(&self, now: &Layout<'_>) -> f64 {
        let walls = walls(&self.chains, now.pieces);
        let boxes: Vec<Aabb> = walls.iter().map(|w| Aabb::of_segment(w.ends, self.radius_m)).collect();
        let mut clr_m2 = 0.0;
        for (wall, aabb) in walls.iter().zip(&boxes).filter(|(w, _)| w.is_moving) {
            self.fixed_grid.visit(aabb, |i| clr_m2 += self.pair_m2(wall, &self.fixed[i]));
        }
        sweep(&boxes, |i, j| {
            if walls[i].is_moving || walls[j].is_moving {
                clr_m2 += self.pair_m2(&walls[i], &walls[j]);
            }
        });
        clr_m2
    }

    fn pair_m2(&self, p: &Wall, q: &Wall) -> f64 {
        if p.nodes.iter().any(|n| q.nodes.contains(n)) {
            return 0.0;
        }
        match meeting(p.ends, q.ends) {
            Meeting::Apart(gap_m) if gap_m < 2.0 * self.radius_m => overlap_m2(p.ends, q.ends, self.radius_m),
            _ => 0.0,
        }
    }
}

/// The straight walls that chains consist of now.
fn walls(chains: &[Chain], pieces: &[WallPiece]) -> Vec<Wall> {
    let mut walls = Vec::with_capacity(chains.len());
    for chain in chains {
        chain.add_walls(pieces, &mut walls);
    }
    walls
}

impl Link {
    fn wall(self, pieces: &[WallPiece]) -> Wall {
        let WallPiece { a, b, nodes: [m, n], is_moving } = pieces[self.piece];
        let (ends, nodes) = if self.is_reversed { ([b, a], [n, m]) } else { ([a, b], [m, n]) };
        Wall { ends, nodes, is_moving }
    }
}

impl Wall {
    /// Takes the next wall as its own continuation.
    fn extend(&mut self, next: &Wall) {
        self.ends[1] = next.ends[1];
        self.nodes[1] = next.nodes[1];
        self.is_moving |= next.is_moving;
    }
}

impl Chain {
    fn add_walls(&self, pieces: &[WallPiece], walls: &mut Vec<Wall>) {
        let start = walls.len();
        for link in &self.links {
            let next = link.wall(pieces);
            match walls[start..].last_mut() {
                Some(last) if goes_straight_on(last.ends, next.ends) => last.extend(&next),
                _ => walls.push(next),
            }
        }
        if self.is_ring
            && let [first, .., last] = walls[start..]
            && goes_straight_on(last.ends, first.ends)
        {
            walls[start] = last;
            walls[start].extend(&first);
            walls.pop();
        }
    }
}

/// Whether two pieces joined at `p[1] == q[0]` are one straight wall.
fn goes_straight_on(p: [DVec2; 2], q: [DVec2; 2]) -> bool {
    let (whole, first, second) = (q[1] - p[0], p[1] - p[0], q[1] - q[0]);
    first.dot(second) >= 0.0 && whole.perp_dot(first).abs() <= TOUCH_M * whole.length()
}

/// All pieces as chains, in the order of their first pieces.
fn chains(pieces: &[WallPiece]) -> Vec<Chain> {
    let joints = Joints::new(pieces);
    let mut is_used = vec![false; pieces.len()];
    let mut chains = Vec::new();
    for start in 0..pieces.len() {
        if is_used[start] {
            continue;
        }
        let first = joints.chain_start(pieces, start);
        let mut chain = Chain { links: vec![], is_ring: false };
        let mut link = Some(first);
        while let Some(l) = link.filter(|l| !is_used[l.piece]) {
            is_used[l.piece] = true;
            chain.links.push(l);
            link = joints.next(pieces, l);
        }
        chain.is_ring = link.is_some_and(|l| l.piece == first.piece);
        chains.push(chain);
    }
    chains
}

/// Which piece ends meet at which node.
struct Joints {
    /// (node, piece, which end), ascending.
    ends: Vec<(u32, usize, usize)>,
}

impl Joints {
    fn new(pieces: &[WallPiece]) -> Self {
        let mut ends: Vec<_> = (0..pieces.len())
            .flat_map(|i| [(pieces[i].nodes[0], i, 0), (pieces[i].nodes[1], i, 1)])
            .collect();
        ends.sort_unstable();
        Self { ends }
    }

    /// The piece that goes on where `link` ends, if exactly two pieces meet there.
    fn next(&self, pieces: &[WallPiece], link: Link) -> Option<Link> {
        let far = usize::from(!link.is_reversed);
        let node = pieces[link.piece].nodes[far];
        let from = self.ends.partition_point(|e| e.0 < node);
        let here = &self.ends[from..][..self.ends[from..].partition_point(|e| e.0 == node)];
        let [p, q] = here else { return None };
        let &(_, piece, end) = if (p.1, p.2) == (link.piece, far) { q } else { p };
        (piece != link.piece).then_some(Link { piece, is_reversed: end == 1 })
    }

    /// The far end of the chain through `piece`, looking back along it; in a ring the piece itself.
    fn chain_start(&self, pieces: &[WallPiece], piece: usize) -> Link {
        let mut back = Link { piece, is_reversed: true };
        while let Some(next) = self.next(pieces, back) {
            if next.piece == piece {
                return Link { piece, is_reversed: false };
            }
            back = next;
        }
        Link { piece: back.piece, is_reversed: !back.is_reversed }
    }
}

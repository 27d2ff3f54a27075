//! Clearance: room between walls to build and to pass (spec section 5; paper: Penalty Metrics).

use glam::DVec2;

use super::pairs::{Aabb, BoxGrid, sweep};
use super::rounded::{hull_overlap_m2, ring_overlap_m2};
use super::{Layout, Meeting, TOUCH_M, WallPiece, is_convex, is_inside, meeting};

/// The paper's radius r of the disc that widens each wall, metres.
pub const RADIUS_M: f64 = 0.5;

/// `clr = Σ_{i<j} A((w_i ⊕ D_r) ∩ (w_j ⊕ D_r))` over pairs of walls that do not touch and of which one
/// may move. The penalty is `clr²`; this measures clr.
///
/// A wall is one piece, or several that go straight on through nodes where nothing else meets, or a
/// solid as a whole, with what is inside; both that and touching are judged in the layout measured.
/// What is drawn with two faces is one wall too: its faces are no pair, and of its pairs with another
/// wall the largest counts, that of the faces that look at each other, as if both were outlines; where
/// any two faces touch, the walls adjoin.
#[derive(Clone, Debug)]
pub struct Clearance {
    radius_m: f64,
    /// Chains and solids with at least one piece that may move.
    moving: Moving,
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

/// What may move, as numbers of pieces.
#[derive(Clone, Debug)]
struct Moving {
    chains: Vec<Chain>,
    solids: Vec<std::ops::Range<usize>>,
}

/// A wall of the layout measured.
#[derive(Clone, Debug)]
struct Wall {
    form: Form,
    is_moving: bool,
    /// The thick wall that it is a face of.
    bar: Option<u32>,
}

#[derive(Clone, Debug)]
enum Form {
    /// Both ends, and the nodes there.
    Straight { ends: [DVec2; 2], nodes: [u32; 2] },
    /// The corners.
    Solid(Vec<DVec2>),
}

impl Clearance {
    /// Sorts the walls of the initial layout into those that may move and those that stand.
    pub fn new(initial: &Layout<'_>, radius_m: f64) -> Self {
        let may_move = |piece: usize| initial.pieces[piece].is_moving;
        let (chains, standing_chains) =
            chains(initial.pieces).into_iter().partition(|c| c.links.iter().any(|l| may_move(l.piece)));
        let (solids, standing_solids) =
            solids(initial.pieces).into_iter().partition(|s| s.clone().any(may_move));
        let fixed = Moving { chains: standing_chains, solids: standing_solids }.walls(initial.pieces);
        let boxes = fixed.iter().map(|w| Aabb::of_points(w.points(), radius_m)).collect();
        Self { radius_m, moving: Moving { chains, solids }, fixed, fixed_grid: BoxGrid::new(boxes) }
    }

    /// clr of a layout, m², ≥ 0. `now` lists the pieces of the initial layout in the same order.
    pub fn measure_m2(&self, now: &Layout<'_>) -> f64 {
        let walls = self.moving.walls(now.pieces);
        let boxes: Vec<Aabb> = walls.iter().map(|w| Aabb::of_points(w.points(), self.radius_m)).collect();
        let mut sum = Sum::default();
        for (k, (wall, aabb)) in walls.iter().zip(&boxes).enumerate().filter(|(_, (w, _))| w.is_moving) {
            self.fixed_grid.visit(aabb, |i| {
                let names = [wall.name(k), self.fixed[i].name(walls.len() + i)];
                sum.add(names, || self.pair_m2(wall, &self.fixed[i]));
            });
        }
        sweep(&boxes, |i, j| {
            if walls[i].is_moving || walls[j].is_moving {
                let names = [walls[i].name(i), walls[j].name(j)];
                sum.add(names, || self.pair_m2(&walls[i], &walls[j]));
            }
        });
        sum.total_m2()
    }

    /// What two walls share of their widened ground; `None` where they adjoin.
    fn pair_m2(&self, p: &Wall, q: &Wall) -> Option<f64> {
        let gap_m = p.gap_m(q)?;
        Some(if gap_m >= 2.0 * self.radius_m {
            0.0
        } else if p.is_convex() && q.is_convex() {
            hull_overlap_m2(p.points(), q.points(), self.radius_m)
        } else {
            ring_overlap_m2(p.points(), q.points(), self.radius_m)
        })
    }
}

/// Which wall a form is or belongs to: thick walls by their number, others by their place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Name {
    Bar(u32),
    Alone(usize),
}

/// The sum over pairs of walls so far.
#[derive(Debug, Default)]
struct Sum {
    /// Of pairs of walls that are one form each.
    alone_m2: f64,
    /// Of pairs of forms of which one at least is the face of a thick wall; ∞ where they adjoin.
    of_faces: Vec<([Name; 2], f64)>,
}

impl Sum {
    fn add(&mut self, names: [Name; 2], pair_m2: impl FnOnce() -> Option<f64>) {
        match names {
            [Name::Alone(_), Name::Alone(_)] => self.alone_m2 += pair_m2().unwrap_or(0.0),
            [p, q] if p == q => {}
            [p, q] => self.of_faces.push(([p.min(q), p.max(q)], pair_m2().unwrap_or(f64::INFINITY))),
        }
    }

    /// Of two walls the largest pair of forms counts, and none where they adjoin.
    fn total_m2(mut self) -> f64 {
        self.of_faces.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let walls = self.of_faces.chunk_by(|a, b| a.0 == b.0);
        let largest = walls.filter_map(|pairs| pairs.last()).map(|pair| pair.1);
        self.alone_m2 + largest.filter(|m2| m2.is_finite()).sum::<f64>()
    }
}

impl Moving {
    fn walls(&self, pieces: &[WallPiece]) -> Vec<Wall> {
        let mut walls = Vec::with_capacity(self.chains.len() + self.solids.len());
        for chain in &self.chains {
            chain.add_walls(pieces, &mut walls);
        }
        walls.extend(self.solids.iter().map(|solid| {
            let outline = &pieces[solid.clone()];
            let corners = outline.iter().map(|p| p.a).collect();
            Wall { form: Form::Solid(corners), is_moving: outline.iter().any(|p| p.is_moving), bar: None }
        }));
        walls
    }
}

impl Link {
    fn ends(self, pieces: &[WallPiece]) -> ([DVec2; 2], [u32; 2]) {
        let WallPiece { a, b, nodes: [m, n], .. } = pieces[self.piece];
        if self.is_reversed { ([b, a], [n, m]) } else { ([a, b], [m, n]) }
    }
}

impl Wall {
    /// The wall that this is or belongs to, `place` among all forms.
    fn name(&self, place: usize) -> Name {
        self.bar.map_or(Name::Alone(place), Name::Bar)
    }

    fn points(&self) -> &[DVec2] {
        match &self.form {
            Form::Straight { ends, .. } => ends,
            Form::Solid(corners) => corners,
        }
    }

    fn edges(&self) -> impl Iterator<Item = [DVec2; 2]> {
        let points = self.points();
        let count = if let Form::Solid(corners) = &self.form { corners.len() } else { 1 };
        (0..count).map(move |i| [points[i], points[(i + 1) % points.len()]])
    }

    /// Whether it is solid and another wall begins inside.
    fn holds(&self, other: &Wall) -> bool {
        matches!(&self.form, Form::Solid(corners) if is_inside(corners, other.points()[0]))
    }

    /// Distance to another wall; `None` where they touch or run into each other.
    fn gap_m(&self, other: &Wall) -> Option<f64> {
        if let (Form::Straight { nodes: p, .. }, Form::Straight { nodes: q, .. }) = (&self.form, &other.form)
            && p.iter().any(|n| q.contains(n))
        {
            return None;
        }
        if self.holds(other) || other.holds(self) {
            return None;
        }
        let mut least_m = f64::INFINITY;
        for p in self.edges() {
            for q in other.edges() {
                let Meeting::Apart(gap_m) = meeting(p, q) else { return None };
                least_m = least_m.min(gap_m);
            }
        }
        Some(least_m)
    }

    /// Whether no corner turns inwards, but for rounding.
    fn is_convex(&self) -> bool {
        let Form::Solid(corners) = &self.form else { return true };
        is_convex(corners)
    }
}

impl Chain {
    /// Adds the straight walls that the chain consists of now.
    fn add_walls(&self, pieces: &[WallPiece], walls: &mut Vec<Wall>) {
        let mut runs: Vec<Run> = Vec::with_capacity(self.links.len());
        for link in &self.links {
            let (ends, nodes) = link.ends(pieces);
            let WallPiece { is_moving, bar, .. } = pieces[link.piece];
            let next = Run { ends, nodes, is_moving, bar };
            match runs.last_mut() {
                Some(last) if goes_straight_on(last.ends, next.ends) => last.extend(&next),
                _ => runs.push(next),
            }
        }
        if self.is_ring
            && let [first, .., last] = &mut runs[..]
            && goes_straight_on(last.ends, first.ends)
        {
            last.extend(first);
            runs.swap_remove(0);
        }
        walls.extend(runs.iter().map(|&Run { ends, nodes, is_moving, bar }| Wall {
            form: Form::Straight { ends, nodes },
            is_moving,
            bar,
        }));
    }
}

/// Pieces in line so far.
struct Run {
    ends: [DVec2; 2],
    nodes: [u32; 2],
    is_moving: bool,
    bar: Option<u32>,
}

impl Run {
    /// Takes the next pieces as its own continuation.
    fn extend(&mut self, next: &Run) {
        self.ends[1] = next.ends[1];
        self.nodes[1] = next.nodes[1];
        self.is_moving |= next.is_moving;
        self.bar = self.bar.or(next.bar);
    }
}

/// The pieces of each solid.
fn solids(pieces: &[WallPiece]) -> Vec<std::ops::Range<usize>> {
    let mut found = vec![];
    let mut start = 0;
    for group in pieces.chunk_by(|p, q| p.solid == q.solid) {
        let end = start + group.len();
        if group[0].solid.is_some() {
            found.push(start..end);
        }
        start = end;
    }
    found
}

/// Whether two pieces joined at `p[1] == q[0]` are one straight wall.
fn goes_straight_on(p: [DVec2; 2], q: [DVec2; 2]) -> bool {
    let (whole, first, second) = (q[1] - p[0], p[1] - p[0], q[1] - q[0]);
    first.dot(second) >= 0.0 && whole.perp_dot(first).abs() <= TOUCH_M * whole.length()
}

/// All pieces but those of solids as chains, in the order of their first pieces.
fn chains(pieces: &[WallPiece]) -> Vec<Chain> {
    let joints = Joints::new(pieces);
    let mut is_used = vec![false; pieces.len()];
    let mut chains = Vec::new();
    for start in 0..pieces.len() {
        if is_used[start] || pieces[start].solid.is_some() {
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

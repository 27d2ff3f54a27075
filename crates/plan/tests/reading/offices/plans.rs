//! Plans whose graph is known: twenty made from seeds.

use glam::DVec2;

use super::Dice;

/// A wall from node to node.
#[derive(Clone, Copy, Debug)]
pub struct Wall {
    pub nodes: [usize; 2],
    pub thickness: f64,
    /// tan(sweep / 4), 0 for straight.
    pub bulge: f64,
}

/// What is in a gap.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    Door,
    Window,
    Passage,
}

/// A gap between two nodes (its jambs).
#[derive(Clone, Copy, Debug)]
pub struct Gap {
    pub nodes: [usize; 2],
    pub kind: Kind,
    pub thickness: f64,
    /// Bulge of the wall through the gap.
    pub bulge: f64,
}

/// A column.
#[derive(Clone, Debug)]
pub enum Column {
    Round { centre: DVec2, radius: f64 },
    Box { corners: Vec<DVec2> },
}

impl Column {
    pub fn centre(&self) -> DVec2 {
        match self {
            Self::Round { centre, .. } => *centre,
            Self::Box { corners } => corners.iter().sum::<DVec2>() / corners.len() as f64,
        }
    }
}

/// A plan as its architect means it, metres.
#[derive(Clone, Debug, Default)]
pub struct Plan {
    pub name: String,
    pub nodes: Vec<DVec2>,
    pub walls: Vec<Wall>,
    pub gaps: Vec<Gap>,
    pub columns: Vec<Column>,
}

/// All plans.
pub fn all() -> Vec<Plan> {
    (0..20).map(plan).collect()
}

/// Plan number `n`: what it has follows from the number.
pub fn plan(n: u64) -> Plan {
    let mut dice = Dice::new(1000 + n);
    let mut draft = Draft::new(&mut dice, n);
    draft.rooms(&mut dice);
    if n % 4 == 3 {
        draft.bow(&mut dice);
    }
    draft.cut(&mut dice);
    draft.stand(&mut dice, n);
    let mut plan = draft.plan;
    plan.name = format!("plan {n:02}");
    // Quarter, odd turns, and a wedge for the skew ones.
    let turn: f64 = match n % 5 {
        1 => 0.35,
        2 => 1.2,
        4 => std::f64::consts::FRAC_PI_2,
        _ => 0.0,
    };
    let place = |p: DVec2| DVec2::from_angle(turn).rotate(p) + DVec2::new(40.0, -25.0);
    plan.nodes.iter_mut().for_each(|p| *p = place(*p));
    for c in &mut plan.columns {
        match c {
            Column::Round { centre, .. } => *centre = place(*centre),
            Column::Box { corners } => corners.iter_mut().for_each(|p| *p = place(*p)),
        }
    }
    plan
}

/// A wall with what will be cut from it.
struct Draft {
    plan: Plan,
    xs: Vec<f64>,
    ys: Vec<f64>,
    outer_m: f64,
    inner_m: [f64; 2],
    wedge: f64,
    shear: f64,
}

impl Draft {
    fn new(dice: &mut Dice, n: u64) -> Self {
        let mut line = |count: u64| {
            let mut at = 0.0;
            let mut out = vec![0.0];
            for _ in 0..count {
                at += (dice.between(3.2, 6.0) * 100.0).round() / 100.0;
                out.push(at);
            }
            out
        };
        let (xs, ys) = (line(2 + n % 3), line(2 + (n / 3) % 2));
        let skew = n % 3 == 2;
        Self {
            plan: Plan::default(),
            xs,
            ys,
            outer_m: [0.3, 0.365, 0.24, 0.4][n as usize % 4],
            inner_m: [0.1, [0.15, 0.115, 0.2][n as usize % 3]],
            wedge: if skew { 0.012 } else { 0.0 },
            shear: if skew { 0.2 } else { 0.0 },
        }
    }

    fn node(&mut self, at: DVec2) -> usize {
        match self.plan.nodes.iter().position(|p| p.distance(at) < 1e-6) {
            Some(i) => i,
            None => {
                self.plan.nodes.push(at);
                self.plan.nodes.len() - 1
            }
        }
    }

    fn at(&self, i: usize, j: usize) -> DVec2 {
        let (x, y) = (self.xs[i], self.ys[j]);
        DVec2::new(x * (1.0 + self.wedge * y) + self.shear * y, y)
    }

    /// Outer walls, and inner walls on the grid lines with some left out.
    fn rooms(&mut self, dice: &mut Dice) {
        let (nx, ny) = (self.xs.len() - 1, self.ys.len() - 1);
        let mut has: Vec<Vec<[bool; 2]>> = vec![vec![[false; 2]; ny + 1]; nx + 1];
        for (i, column) in has.iter_mut().enumerate() {
            for (j, ways) in column.iter_mut().enumerate() {
                ways[0] = i < nx && (j == 0 || j == ny || dice.chance(0.75));
                ways[1] = j < ny && (i == 0 || i == nx || dice.chance(0.75));
            }
        }
        for j in 0..=ny {
            let t = if j == 0 || j == ny { self.outer_m } else { self.inner_m[j % 2] };
            let points: Vec<(usize, usize)> = (0..=nx).map(|i| (i, j)).collect();
            self.line(&has, &points, 0, t);
        }
        for i in 0..=nx {
            let t = if i == 0 || i == nx { self.outer_m } else { self.inner_m[(i + 1) % 2] };
            let points: Vec<(usize, usize)> = (0..=ny).map(|j| (i, j)).collect();
            self.line(&has, &points, 1, t);
        }
    }

    /// Walls along one grid line, from junction to junction.
    fn line(&mut self, has: &[Vec<[bool; 2]>], points: &[(usize, usize)], way: usize, thickness: f64) {
        let mut start: Option<usize> = None;
        for k in 0..points.len() {
            let (i, j) = points[k];
            let (before, after) = (start.is_some(), has[i][j][way] && k + 1 < points.len());
            let crossed = if way == 0 {
                has[i][j][1] || (j > 0 && has[i][j - 1][1])
            } else {
                has[i][j][0] || (i > 0 && has[i - 1][j][0])
            };
            if before
                && (!after || crossed)
                && let Some(from) = start.take()
            {
                let ends = [self.at(points[from].0, points[from].1), self.at(i, j)];
                let nodes = ends.map(|p| self.node(p));
                self.plan.walls.push(Wall { nodes, thickness, bulge: 0.0 });
            }
            if after && start.is_none() {
                start = Some(k);
            }
        }
    }

    /// Makes some walls round: outer ones outwards.
    fn bow(&mut self, dice: &mut Dice) {
        let middle = self.plan.nodes.iter().sum::<DVec2>() / self.plan.nodes.len() as f64;
        let mut left = 3;
        let outer = self.outer_m;
        for w in &mut self.plan.walls {
            let [a, b] = w.nodes.map(|n| self.plan.nodes[n]);
            if left > 0 && w.thickness == outer && dice.chance(0.5) {
                let out = (b - a).perp_dot(middle - a) > 0.0;
                let bulge = dice.between(0.12, 0.35);
                w.bulge = if out { bulge } else { -bulge };
                left -= 1;
            }
        }
    }

    /// Cuts doors, windows and passages into the walls.
    fn cut(&mut self, dice: &mut Dice) {
        for w in std::mem::take(&mut self.plan.walls) {
            let outer = w.thickness == self.outer_m;
            let a = Arc::new(self.plan.nodes[w.nodes[0]], self.plan.nodes[w.nodes[1]], w.bulge);
            let length = a.length();
            let kind = match (outer, dice.below(10)) {
                (true, 0) => Kind::Door,
                (true, 1..=6) => Kind::Window,
                (false, 0..=5) => Kind::Door,
                (false, 6) => Kind::Passage,
                _ => {
                    self.plan.walls.push(w);
                    continue;
                }
            };
            let width = match kind {
                Kind::Door => [0.76, 0.885, 1.01][dice.below(3) as usize],
                Kind::Window => [0.8, 1.2, 1.51, 2.01][dice.below(4) as usize],
                Kind::Passage => dice.between(0.8, 1.6),
            };
            let room = length - width - 1.2;
            if room <= 0.0 {
                self.plan.walls.push(w);
                continue;
            }
            let from = 0.6 + room * dice.between(0.0, 1.0);
            let jambs = [from, from + width].map(|s| a.at(s / length)).map(|p| self.node(p));
            let part = |s: f64| (w.bulge.atan() * s / length).tan();
            self.plan.walls.push(Wall { nodes: [w.nodes[0], jambs[0]], bulge: part(from), ..w });
            self.plan.walls.push(Wall {
                nodes: [jambs[1], w.nodes[1]],
                bulge: part(length - from - width),
                ..w
            });
            let gap = Gap { nodes: jambs, kind, thickness: w.thickness, bulge: part(width) };
            self.plan.gaps.push(gap);
        }
    }

    /// Columns and free-standing walls in the rooms.
    fn stand(&mut self, dice: &mut Dice, n: u64) {
        for i in 0..self.xs.len() - 1 {
            for j in 0..self.ys.len() - 1 {
                let middle =
                    (self.at(i, j) + self.at(i + 1, j) + self.at(i, j + 1) + self.at(i + 1, j + 1)) / 4.0;
                match dice.below(6) {
                    0 if n.is_multiple_of(2) => {
                        let side = dice.between(0.25, 0.5);
                        let turn = DVec2::from_angle(dice.between(0.0, 0.7));
                        let corner = |x: f64, y: f64| middle + turn.rotate(DVec2::new(x, y) * side / 2.0);
                        let corners =
                            vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)];
                        self.plan.columns.push(Column::Box { corners });
                    }
                    1 if n.is_multiple_of(2) => {
                        let radius = dice.between(0.12, 0.3);
                        self.plan.columns.push(Column::Round { centre: middle, radius });
                    }
                    2 => {
                        let u = DVec2::from_angle(dice.between(0.0, 3.0)) * dice.between(0.6, 0.9);
                        let nodes = [middle - u, middle + u].map(|p| self.node(p));
                        self.plan.walls.push(Wall { nodes, thickness: self.inner_m[0], bulge: 0.0 });
                    }
                    _ => {}
                }
            }
        }
    }
}

/// A straight or round way from a to b.
#[derive(Clone, Copy, Debug)]
pub struct Arc {
    pub a: DVec2,
    pub b: DVec2,
    pub bulge: f64,
}

impl Arc {
    pub fn new(a: DVec2, b: DVec2, bulge: f64) -> Self {
        Self { a, b, bulge }
    }

    pub fn is_line(&self) -> bool {
        self.bulge.abs() < 1e-9
    }

    pub fn radius(&self) -> f64 {
        self.a.distance(self.b) * (1.0 + self.bulge * self.bulge) / (4.0 * self.bulge.abs())
    }

    pub fn centre(&self) -> DVec2 {
        let q = self.bulge;
        self.a.midpoint(self.b) + (self.b - self.a).perp() * ((1.0 - q * q) / (4.0 * q))
    }

    pub fn sweep(&self) -> f64 {
        4.0 * self.bulge.atan()
    }

    pub fn length(&self) -> f64 {
        if self.is_line() { self.a.distance(self.b) } else { self.radius() * self.sweep().abs() }
    }

    /// Point at a share of the way.
    pub fn at(&self, share: f64) -> DVec2 {
        if self.is_line() {
            return self.a.lerp(self.b, share);
        }
        let c = self.centre();
        c + DVec2::from_angle(self.sweep() * share).rotate(self.a - c)
    }

    /// Unit vector ahead at a share of the way.
    pub fn ahead(&self, share: f64) -> DVec2 {
        if self.is_line() {
            return (self.b - self.a).normalize();
        }
        let out = (self.at(share) - self.centre()).normalize();
        out.perp() * self.bulge.signum()
    }

    /// The way with its ends elsewhere on the same line or circle moved `left` metres to the left.
    pub fn beside(&self, a: DVec2, b: DVec2) -> Self {
        if self.is_line() {
            return Self::new(a, b, 0.0);
        }
        let c = self.centre();
        let turn = (a - c).angle_to(b - c);
        let turn =
            if turn * self.bulge < 0.0 { turn + std::f64::consts::TAU * self.bulge.signum() } else { turn };
        Self::new(a, b, (turn / 4.0).tan())
    }
}

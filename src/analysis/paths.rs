//! Shortest and straightest paths through the visibility graph, and step depth from chosen cells.
//!
//! Definitions, names and the order of relaxation are depthmapX's, single-precision sums included, so
//! that values can be compared cell by cell. Angles count 1 for a right angle.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashSet};

use rayon::prelude::*;

use crate::plan::geometry::UM_PER_M;

use super::graph::Graph;
use super::measures::{Column, UNDEFINED, transpose};
use super::{Lattice, Obstacles};

/// Where a path may turn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Turning {
    /// At every cell: the shortest paths of the visibility graph.
    Everywhere,
    /// depthmapX's rule: at cells whose own square, or one of the eight squares around it, a wall
    /// touches.
    #[default]
    AtWalls,
}

/// Paths over one graph; share it between threads.
pub struct Paths<'a> {
    lattice: &'a Lattice,
    graph: &'a Graph,
    /// Whether paths may turn, by rank.
    turns: Vec<bool>,
    /// Column and row from the lower left vertex, by rank.
    cells: Vec<[i32; 2]>,
    /// Angle of every offset in the box, by row, then column; empty if there are too many.
    angles: Vec<f64>,
    size: [i32; 2],
}

impl<'a> Paths<'a> {
    /// `obstacles` are those of the graph; they say where the walls stand.
    pub fn new(lattice: &'a Lattice, graph: &'a Graph, obstacles: &Obstacles, turning: Turning) -> Self {
        let walls = match turning {
            Turning::Everywhere => HashSet::new(),
            Turning::AtWalls => wall_squares(lattice, obstacles),
        };
        let turns_at = |&v: &u32| {
            let [c, r] = lattice.cells[v as usize];
            let around = (-1..=1).flat_map(|x| (-1..=1).map(move |y| [c + x, r + y]));
            turning == Turning::Everywhere || around.into_iter().any(|cell| walls.contains(&cell))
        };
        let local = |&v: &u32| graph.tiles.local(lattice.cells[v as usize]).map(|c| c as i32);
        let size = graph.tiles.size_cells.map(|n| n as i32);
        let mut new = Self {
            lattice,
            graph,
            turns: graph.tiles.vertex_of.iter().map(turns_at).collect(),
            cells: graph.tiles.vertex_of.iter().map(local).collect(),
            angles: Vec::new(),
            size,
        };
        let [w, h] = size.map(i64::from);
        if (2 * w + 1).saturating_mul(2 * h + 1) <= MAX_ANGLES {
            let offsets = (-size[1]..=size[1]).flat_map(|y| (-size[0]..=size[0]).map(move |x| [x, y]));
            new.angles = offsets.map(angle_of).collect();
        }
        new
    }

    /// `Metric Mean Shortest-Path Angle`, `… Distance`, `Metric Mean Straight-Line Distance` (metres),
    /// `Metric Node Count`; means include the vertex itself. Paths longer than `radius_m` do not count.
    pub fn metric_columns(&self, radius_m: Option<f64>) -> Vec<Column> {
        let names = [
            "Metric Mean Shortest-Path Angle",
            "Metric Mean Shortest-Path Distance",
            "Metric Mean Straight-Line Distance",
            "Metric Node Count",
        ];
        let row = |walk: &mut Walk, v: usize| {
            let root = self.graph.tiles.rank_of[v];
            walk.metric(self, &[root], self.radius(radius_m));
            let mut sums = [0f32; 3];
            for &rank in &walk.done {
                let i = rank as usize;
                sums[0] += walk.angle[i];
                sums[1] += (f64::from(walk.cost[i]) * self.spacing_m()) as f32;
                sums[2] += (self.cells_apart(root, rank) * self.spacing_m()) as f32;
            }
            let n = walk.done.len() as f64;
            let [angle, length, straight] = sums.map(|sum| f64::from(sum) / n);
            [angle, length, straight, n]
        };
        self.all(names, radius_m, row)
    }

    /// `Angular Mean Depth`, `Angular Node Count`, `Angular Total Depth`. Paths of more than `radius`
    /// right angles do not count.
    pub fn angular_columns(&self, radius: Option<f64>) -> Vec<Column> {
        let names = ["Angular Mean Depth", "Angular Node Count", "Angular Total Depth"];
        let row = |walk: &mut Walk, v: usize| {
            walk.angular(self, &[self.graph.tiles.rank_of[v]], radius.unwrap_or(f64::INFINITY));
            let total = f64::from(walk.done.iter().map(|&rank| walk.cost[rank as usize]).sum::<f32>());
            let n = walk.done.len() as f64;
            [total / n, n, total]
        };
        self.all(names, radius, row)
    }

    /// Visual, metric (metres) and angular depth of every vertex from the nearest of some vertices;
    /// [`UNDEFINED`] where there is no way.
    pub fn step_columns(&self, from: &[u32]) -> Vec<Column> {
        let roots: Vec<u32> = from.iter().map(|&v| self.graph.tiles.rank_of[v as usize]).collect();
        let mut walk = Walk::new(self.graph);
        let column = |name: &str, by_rank: &dyn Fn(usize) -> f64| {
            let value = |&rank: &u32| by_rank(rank as usize);
            let values = self.graph.tiles.rank_of.iter().map(value).collect();
            Column { name: name.to_string(), values }
        };
        let levels = self.levels(&roots);
        let mut columns = vec![column("Visual Step Depth", &|rank| levels[rank])];
        walk.metric(self, &roots, f64::INFINITY);
        let defined = |walk: &Walk, rank: usize, value: f64| {
            if walk.cost[rank].is_finite() { value } else { UNDEFINED }
        };
        columns.push(column("Metric Step Shortest-Path Angle", &|r| defined(&walk, r, walk.angle[r].into())));
        let length = |r: usize| f64::from(walk.cost[r]) * self.spacing_m();
        columns.push(column("Metric Step Shortest-Path Length", &|r| defined(&walk, r, length(r))));
        walk.angular(self, &roots, f64::INFINITY);
        columns.push(column("Angular Step Depth", &|r| defined(&walk, r, walk.cost[r].into())));
        columns
    }

    fn levels(&self, roots: &[u32]) -> Vec<f64> {
        let mut level = vec![UNDEFINED; self.graph.len()];
        let mut queue: std::collections::VecDeque<u32> = roots.iter().copied().collect();
        roots.iter().for_each(|&r| level[r as usize] = 0.0);
        while let Some(at) = queue.pop_front() {
            let next = level[at as usize] + 1.0;
            self.graph.for_each_rank(at as usize, |to| {
                if level[to] == UNDEFINED {
                    level[to] = next;
                    queue.push_back(to as u32);
                }
            });
        }
        level
    }

    fn all<const K: usize>(
        &self,
        names: [&str; K],
        radius: Option<f64>,
        row: impl Fn(&mut Walk, usize) -> [f64; K] + Sync + Send,
    ) -> Vec<Column> {
        let n = self.graph.len();
        let rows: Vec<[f64; K]> = (0..n).into_par_iter().map_init(|| Walk::new(self.graph), row).collect();
        let suffix = radius.map(|r| format!(" R{r}")).unwrap_or_default();
        transpose(names.map(|name| format!("{name}{suffix}")), &rows)
    }

    fn radius(&self, radius_m: Option<f64>) -> f64 {
        radius_m.map_or(f64::INFINITY, |r| r / self.spacing_m())
    }

    fn spacing_m(&self) -> f64 {
        self.lattice.spacing_um as f64 / UM_PER_M
    }

    #[inline(always)]
    fn offset(&self, from: u32, to: u32) -> [i32; 2] {
        let (a, b) = (self.cells[from as usize], self.cells[to as usize]);
        [b[0] - a[0], b[1] - a[1]]
    }

    #[inline(always)]
    fn cells_apart(&self, a: u32, b: u32) -> f64 {
        let [x, y] = self.offset(a, b).map(f64::from);
        (x * x + y * y).sqrt()
    }

    /// Direction from one cell to another, radians.
    #[inline(always)]
    fn direction(&self, from: u32, to: u32) -> f64 {
        let [x, y] = self.offset(from, to);
        let at = (y + self.size[1]) as usize * (2 * self.size[0] + 1) as usize + (x + self.size[0]) as usize;
        self.angles.get(at).copied().unwrap_or_else(|| angle_of([x, y]))
    }
}

/// Offsets whose angles are tabulated, at most: 32 MB.
const MAX_ANGLES: i64 = 1 << 22;

fn angle_of([x, y]: [i32; 2]) -> f64 {
    f64::from(y).atan2(f64::from(x))
}

/// How far a path turns from one direction to another, in right angles.
#[inline(always)]
fn turn(before: f64, after: f64) -> f32 {
    let apart = (after - before).abs();
    let apart = apart.min(std::f64::consts::TAU - apart);
    (apart / std::f64::consts::FRAC_PI_2) as f32
}

/// No predecessor.
const START: u32 = u32::MAX;

/// Cost in the bits of a non-negative f32 above the vertex, and the predecessor's vertex.
type Step = Reverse<(u64, u32)>;

/// Bands of cost to one cell of length, and to one right angle.
const BANDS_PER_CELL: f32 = 2.0;
const BANDS_PER_RIGHT_ANGLE: f32 = 64.0;

/// Bands that are told apart; what costs more waits in the last one.
const BANDS_MAX: usize = 1 << 16;

/// Steps in the order of their cost. Only those of the band at hand are sorted; what a better way has
/// overtaken by then is never sorted at all.
#[derive(Default)]
struct Queue {
    now: BinaryHeap<Step>,
    later: Vec<Vec<(u64, u32)>>,
    band: usize,
    /// Bands that hold anything end before this one.
    end: usize,
    bands_per_cost: f32,
}

impl Queue {
    fn clear(&mut self, bands_per_cost: f32) {
        self.now.clear();
        self.later[..self.end].iter_mut().for_each(Vec::clear);
        (self.band, self.end, self.bands_per_cost) = (0, 0, bands_per_cost);
    }

    #[inline(always)]
    fn push(&mut self, cost: f32, step: (u64, u32)) {
        let band = ((cost * self.bands_per_cost) as usize).min(BANDS_MAX - 1);
        if band <= self.band {
            self.now.push(Reverse(step));
            return;
        }
        if band >= self.end {
            self.end = band + 1;
            if self.later.len() < self.end {
                self.later.resize_with(self.end, Vec::new);
            }
        }
        self.later[band].push(step);
    }

    /// The cheapest step; `is_current` tells which ones no better way has overtaken.
    #[inline(always)]
    fn pop(&mut self, is_current: impl Fn(u64) -> bool) -> Option<(u64, u32)> {
        while self.now.is_empty() {
            self.band += 1;
            if self.band >= self.end {
                return None;
            }
            let band = self.later[self.band].drain(..).filter(|step| is_current(step.0));
            self.now.extend(band.map(Reverse));
        }
        self.now.pop().map(|Reverse(step)| step)
    }
}

/// Buffers of one worker, by rank; what a walk touched is listed in `touched`.
struct Walk {
    cost: Vec<f32>,
    /// Angle turned along the metric path.
    angle: Vec<f32>,
    /// Predecessor, where the walk has been.
    before: Vec<u32>,
    /// Cells not left yet, by tile.
    open: Vec<u64>,
    done: Vec<u32>,
    touched: Vec<u32>,
    queue: Queue,
}

impl Walk {
    fn new(graph: &Graph) -> Self {
        let n = graph.len();
        Self {
            cost: vec![f32::INFINITY; n],
            angle: vec![0.0; n],
            before: vec![START; n],
            open: graph.tiles.occupied.clone(),
            done: Vec::new(),
            touched: Vec::new(),
            queue: Queue::default(),
        }
    }

    fn begin(&mut self, paths: &Paths<'_>, roots: &[u32], bands_per_cost: f32) {
        for rank in self.touched.drain(..) {
            self.cost[rank as usize] = f32::INFINITY;
        }
        self.open.copy_from_slice(&paths.graph.tiles.occupied);
        self.done.clear();
        self.queue.clear(bands_per_cost);
        for &root in roots {
            self.reach(paths, root, START, 0.0);
        }
    }

    fn reach(&mut self, paths: &Paths<'_>, rank: u32, from: u32, cost: f32) {
        if self.cost[rank as usize] == f32::INFINITY {
            self.touched.push(rank);
        }
        self.cost[rank as usize] = cost;
        let vertex = |r: u32| if r == START { START } else { paths.graph.tiles.vertex_of[r as usize] };
        let key = u64::from(cost.to_bits()) << 32 | u64::from(vertex(rank));
        self.queue.push(cost, (key, vertex(from)));
    }

    /// The next cell to leave, with its cost and predecessor.
    fn next(&mut self, paths: &Paths<'_>, radius: f64) -> Option<(f32, u32, u32)> {
        loop {
            let costs = &self.cost;
            let ranks = &paths.graph.tiles.rank_of;
            let is_current =
                |key: u64| costs[ranks[key as u32 as usize] as usize].to_bits() == (key >> 32) as u32;
            let (key, from) = self.queue.pop(is_current)?;
            let cost = f32::from_bits((key >> 32) as u32);
            let rank = paths.graph.tiles.rank_of[key as u32 as usize];
            if f64::from(cost) > radius {
                return None;
            }
            let (tile, bit) = paths.graph.tiles.slot_of[rank as usize];
            if self.open[tile as usize] >> bit & 1 == 1 {
                self.open[tile as usize] &= !(1 << bit);
                self.done.push(rank);
                let from = if from == START { START } else { paths.graph.tiles.rank_of[from as usize] };
                self.before[rank as usize] = from;
                return Some((cost, rank, from));
            }
        }
    }

    /// Shortest paths, cost in cells.
    fn metric(&mut self, paths: &Paths<'_>, roots: &[u32], radius: f64) {
        self.walk::<true>(paths, roots, radius);
    }

    /// Straightest paths, cost in right angles.
    fn angular(&mut self, paths: &Paths<'_>, roots: &[u32], radius: f64) {
        self.walk::<false>(paths, roots, radius);
    }

    fn walk<const METRIC: bool>(&mut self, paths: &Paths<'_>, roots: &[u32], radius: f64) {
        #[cfg(target_arch = "x86_64")]
        if is_x86_feature_detected!("popcnt") {
            // SAFETY: the processor has just been asked.
            #[allow(unsafe_code)]
            return unsafe { self.walk_popcnt::<METRIC>(paths, roots, radius) };
        }
        self.walk_in::<METRIC>(paths, roots, radius);
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "popcnt")]
    fn walk_popcnt<const METRIC: bool>(&mut self, paths: &Paths<'_>, roots: &[u32], radius: f64) {
        self.walk_in::<METRIC>(paths, roots, radius);
    }

    #[inline(always)]
    fn walk_in<const METRIC: bool>(&mut self, paths: &Paths<'_>, roots: &[u32], radius: f64) {
        self.begin(paths, roots, if METRIC { BANDS_PER_CELL } else { BANDS_PER_RIGHT_ANGLE });
        while let Some((cost, at, from)) = self.next(paths, radius) {
            let heading = if from == START { None } else { Some(paths.direction(from, at)) };
            if METRIC {
                self.angle[at as usize] = heading.map_or(0.0, |h| {
                    let first = self.before[from as usize];
                    let turned = if first == START { 0.0 } else { turn(paths.direction(first, from), h) };
                    self.angle[from as usize] + turned
                });
            }
            if cost == 0.0 || paths.turns[at as usize] {
                self.relax::<METRIC>(paths, cost, (at, from), heading);
            }
        }
    }

    /// Offers a way through `at` to the cells it sees. Those its predecessor sees as well are passed
    /// over: the way there without the detour is no longer and turns no more.
    #[inline(always)]
    fn relax<const METRIC: bool>(
        &mut self,
        paths: &Paths<'_>,
        cost: f32,
        (at, from): (u32, u32),
        heading: Option<f64>,
    ) {
        let graph = paths.graph;
        let (tiles, masks) = graph.row(at as usize);
        let (before_tiles, before_masks) =
            if from == START { (&[][..], &[][..]) } else { graph.row(from as usize) };
        let mut before = 0;
        for (&t, &mask) in tiles.iter().zip(masks) {
            while before < before_tiles.len() && before_tiles[before] < t {
                before += 1;
            }
            let known = if before_tiles.get(before) == Some(&t) { before_masks[before] } else { 0 };
            let mut bits = mask & self.open[t as usize] & !known;
            while bits != 0 {
                let bit = bits.trailing_zeros();
                bits &= bits - 1;
                let to = graph.tiles.rank(t, bit);
                if METRIC {
                    self.offer_length(paths, cost, [at, to as u32]);
                } else {
                    self.offer_turn(paths, cost, [at, to as u32], heading);
                }
            }
        }
    }

    #[inline(always)]
    fn offer_length(&mut self, paths: &Paths<'_>, cost: f32, [at, to]: [u32; 2]) {
        let apart = paths.cells_apart(at, to);
        if f64::from(cost) + apart < f64::from(self.cost[to as usize]) {
            self.reach(paths, to, at, cost + apart as f32);
        }
    }

    #[inline(always)]
    fn offer_turn(&mut self, paths: &Paths<'_>, cost: f32, [at, to]: [u32; 2], heading: Option<f64>) {
        if cost < self.cost[to as usize] {
            let turned = heading.map_or(0.0, |h| turn(h, paths.direction(at, to)));
            if cost + turned < self.cost[to as usize] {
                self.reach(paths, to, at, cost + turned);
            }
        }
    }
}

/// Cells whose closed square a wall touches, around the lattice.
fn wall_squares(lattice: &Lattice, obstacles: &Obstacles) -> HashSet<[i32; 2]> {
    let s = lattice.spacing_um as f64;
    let extreme = |k: usize| {
        let values = lattice.cells.iter().map(|c| c[k]);
        (values.clone().min().unwrap_or(0) - 1, values.max().unwrap_or(0) + 1)
    };
    let (columns, rows) = (extreme(0), extreme(1));
    let mut squares = HashSet::new();
    for segment in &obstacles.segments {
        let place = |p: [i64; 2]| [0, 1].map(|k| (p[k] - lattice.origin_um[k]) as f64 / s);
        let (mut a, mut b) = (place(segment.a), place(segment.b));
        if b[1] < a[1] {
            (a, b) = (b, a);
        }
        let whole = |x: f64, limits: (i32, i32)| (x as i32).clamp(limits.0, limits.1);
        if b[1] < f64::from(rows.0) - 0.5 || a[1] > f64::from(rows.1) + 0.5 {
            continue;
        }
        for row in whole((a[1] - 0.5).ceil(), rows)..=whole((b[1] + 0.5).floor(), rows) {
            let at = |y: f64| {
                let t = if b[1] > a[1] { ((y - a[1]) / (b[1] - a[1])).clamp(0.0, 1.0) } else { 0.0 };
                a[0] + (b[0] - a[0]) * t
            };
            let (mut x0, mut x1) = (at(f64::from(row) - 0.5), at(f64::from(row) + 0.5));
            if a[1] == b[1] {
                (x0, x1) = (a[0], b[0]);
            }
            let (lo, hi) = (x0.min(x1), x0.max(x1));
            if hi < f64::from(columns.0) - 0.5 || lo > f64::from(columns.1) + 0.5 {
                continue;
            }
            let cells = whole((lo - 0.5).ceil(), columns)..=whole((hi + 0.5).floor(), columns);
            squares.extend(cells.map(|column| [column, row]));
        }
    }
    squares
}

#[cfg(test)]
mod tests {
    use super::super::{fixtures, visibility};
    use super::*;
    use crate::plan::geometry::Segment;

    /// Lengths, counts and angular depth agree to the last digits of float32. The angle turned along
    /// the metric path depends on which of several equally short paths is taken, which the
    /// reference does not tell: those means agree to 3 %, and over all vertices to 0.1 %.
    #[test]
    fn paths_equal_depthmapx() {
        let Some((lattice, obstacles, header, rows)) = fixtures::n900() else { return };
        let graph = visibility::visibility_graph(&lattice, &obstacles);
        let paths = Paths::new(&lattice, &graph, &obstacles, Turning::AtWalls);
        let seed = rows.iter().position(|r| r[0] == 131_074.0).unwrap() as u32;
        let mut columns = paths.metric_columns(None);
        columns.extend(paths.angular_columns(None));
        columns.push(paths.step_columns(&[seed]).remove(0));
        assert_eq!(columns.len(), 8);
        for column in columns {
            let k = header.iter().position(|h| *h == column.name).unwrap();
            let limit = if column.name.ends_with("Shortest-Path Angle") { 3e-2 } else { 1e-6 };
            let (mut ours_sum, mut theirs_sum) = (0.0, 0.0);
            for (v, row) in rows.iter().enumerate() {
                let (ours, theirs) = (column.values[v], row[k]);
                let error = (ours - theirs).abs() / theirs.abs().max(1e-3);
                assert!(error <= limit, "{} of {}: {ours} {theirs}", column.name, row[0]);
                ours_sum += ours;
                theirs_sum += theirs;
            }
            let error: f64 = ours_sum / theirs_sum - 1.0;
            assert!(error.abs() < 1e-3, "{}: {error}", column.name);
        }
    }

    #[test]
    fn around_a_corner() {
        // A screen over the middle column leaves the top row open: the way round turns twice at 45 degrees.
        let cells = (0..3).flat_map(|c| (0..2).map(move |r| [c, r])).collect();
        let lattice = fixtures::lattice(1_000_000, [0, 0], cells);
        let wall = Segment { a: [1_000_000, -500_000], b: [1_000_000, 500_000] };
        let obstacles = Obstacles { segments: vec![wall], blind: vec![] };
        let graph = visibility::visibility_graph(&lattice, &obstacles);
        let paths = Paths::new(&lattice, &graph, &obstacles, Turning::Everywhere);
        let columns = paths.step_columns(&[0]);
        let value = |name: &str, v: usize| columns.iter().find(|c| c.name == name).unwrap().values[v];
        assert_eq!(value("Visual Step Depth", 4), 2.0);
        assert!((value("Metric Step Shortest-Path Length", 4) - 2.0 * 2f64.sqrt()).abs() < 1e-6);
        assert!((value("Metric Step Shortest-Path Angle", 4) - 1.0).abs() < 1e-6);
        assert!((value("Angular Step Depth", 4) - 1.0).abs() < 1e-6);
        assert_eq!(value("Visual Step Depth", 2), UNDEFINED);
        let near = paths.metric_columns(Some(1.2));
        assert_eq!(near.iter().find(|c| c.name == "Metric Node Count R1.2").unwrap().values[0], 2.0);
    }
}

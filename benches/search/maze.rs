//! The paper's maze as a fast test problem for the search: 14 sliding doors, 1 m cells.
//!
//! Only what the search needs of the engine, for axis-parallel walls: the score of a layout to about
//! 1e-4 (clearance by quadrature, all counts exact). Checked against `maze_a.expected.json` at start.

use std::collections::HashMap;
use std::path::Path;

use super::problem::{Problem, Worth};

type Wall = [f64; 4];

/// One door of the maze: the gap between two jambs in a horizontal wall.
struct Door {
    y: f64,
    left: f64,
    right: f64,
    bounds: [f64; 2],
}

/// A pair of cells and the doors their line of sight has to pass.
struct Pair {
    cells: [u16; 2],
    passes: std::ops::Range<u32>,
}

#[derive(Clone, Copy)]
struct Pass {
    door: u32,
    span: [f32; 2],
    crosses: bool,
}

/// The maze, ready to be measured.
pub struct Maze {
    walls: Vec<Wall>,
    moved: Vec<[Option<usize>; 2]>,
    doors: Vec<Door>,
    query: Vec<usize>,
    reference: Vec<bool>,
    pairs: Vec<Pair>,
    passes: Vec<Pass>,
    groups: Vec<std::ops::Range<usize>>,
    near: Vec<[usize; 2]>,
    merged: Vec<Merged>,
    reached: Vec<Bits>,
    initial: [f64; 3],
    length: f64,
}

struct Merged {
    wall: Wall,
    door: [Option<usize>; 2],
}

const WORDS: usize = 7;
type Bits = [u64; WORDS];
const CENTRE: [f64; 2] = [0.47, 0.37];

struct Entity {
    kind: String,
    layer: String,
    text: String,
    xs: Vec<f64>,
    ys: Vec<f64>,
}

fn entities(path: &Path) -> Vec<Entity> {
    let text = std::fs::read_to_string(path).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    let mut out: Vec<Entity> = vec![];
    let mut in_entities = false;
    for pair in lines.chunks_exact(2) {
        let (code, value) = (pair[0].trim(), pair[1].trim());
        match code {
            "2" if value == "ENTITIES" => in_entities = true,
            "0" if in_entities && value == "ENDSEC" => break,
            "0" if in_entities => out.push(Entity {
                kind: value.into(),
                layer: String::new(),
                text: String::new(),
                xs: vec![],
                ys: vec![],
            }),
            _ => {
                if let Some(e) = out.last_mut() {
                    match code {
                        "8" => e.layer = value.into(),
                        "1" => e.text = value.into(),
                        "10" | "11" => e.xs.push(value.parse().unwrap()),
                        "20" | "21" => e.ys.push(value.parse().unwrap()),
                        _ => {}
                    }
                }
            }
        }
    }
    out
}

fn contains(polygon: &Entity, x: f64, y: f64) -> bool {
    let range = |v: &[f64]| v.iter().fold((f64::MAX, f64::MIN), |(a, b), &c| (a.min(c), b.max(c)));
    let ((x0, x1), (y0, y1)) = (range(&polygon.xs), range(&polygon.ys));
    (x0..=x1).contains(&x) && (y0..=y1).contains(&y)
}

impl Maze {
    /// Reads `maze_a.dxf` from the folder of reference plans.
    pub fn read(folder: &Path) -> Self {
        let all = entities(&folder.join("maze_a.dxf"));
        let boxes: Vec<&Entity> =
            all.iter().filter(|e| e.kind == "LWPOLYLINE" && e.layer == "EF-MOVE").collect();
        let walls: Vec<Wall> = all
            .iter()
            .filter(|e| e.kind == "LINE" && e.layer == "WALLS")
            .map(|e| [e.xs[0], e.ys[0], e.xs[1], e.ys[1]])
            .collect();
        let door_of = |x: f64, y: f64| boxes.iter().position(|b| contains(b, x, y));
        let moved: Vec<_> = walls.iter().map(|w| [door_of(w[0], w[1]), door_of(w[2], w[3])]).collect();
        let doors = boxes.iter().map(|b| door(b, &all, &walls)).collect();
        let (cells, query, reference) = lattice(&all);
        let mut maze = Self {
            merged: merge(&walls, &moved),
            length: walls.iter().map(length).sum(),
            pairs: vec![],
            passes: vec![],
            groups: vec![],
            near: vec![],
            walls,
            moved,
            doors,
            query,
            reference,
            reached: vec![],
            initial: [0.0; 3],
        };
        maze.find_pairs(&cells);
        maze.near = near(&maze.merged);
        let (means, reached) = maze.measure(&vec![0.0; maze.doors.len()]);
        maze.initial = means;
        maze.reached = reached;
        maze
    }

    fn find_pairs(&mut self, cells: &[[f64; 2]]) {
        let both = self.walls.iter().zip(&self.moved);
        let fixed: Vec<Wall> = both.filter(|(_, m)| **m == [None, None]).map(|(w, _)| *w).collect();
        for u in 0..cells.len() {
            for v in u + 1..cells.len() {
                let (a, b) = (cells[u], cells[v]);
                if fixed.iter().all(|w| !blocks(w, a, b)) {
                    let from = self.passes.len() as u32;
                    let mut passes: Vec<Pass> =
                        (0..self.doors.len()).filter_map(|d| self.pass(d, a, b)).collect();
                    passes.sort_by_key(|p| !p.crosses);
                    self.passes.extend(passes);
                    self.pairs
                        .push(Pair { cells: [u as u16, v as u16], passes: from..self.passes.len() as u32 });
                }
            }
        }
        self.sort_pairs();
    }

    /// Pairs by the first door whose wall they cross, then by where; the others last.
    fn sort_pairs(&mut self) {
        let passes = &self.passes;
        let doors = self.doors.len();
        let first =
            |p: &Pair| passes[p.passes.start as usize..p.passes.end as usize].first().filter(|p| p.crosses);
        let key = |p: &Pair| first(p).map_or((doors, 0.0), |p| (p.door as usize, p.span[0]));
        self.pairs.sort_by(|a, b| key(a).0.cmp(&key(b).0).then(key(a).1.total_cmp(&key(b).1)));
        let at = |d: usize| self.pairs.partition_point(|p| key(p).0 < d);
        self.groups = (0..=doors).map(|d| at(d)..at(d + 1)).collect();
        let mut sorted = vec![];
        for pair in &mut self.pairs {
            let from = sorted.len() as u32;
            sorted.extend_from_slice(&self.passes[pair.passes.start as usize..pair.passes.end as usize]);
            pair.passes = from..sorted.len() as u32;
        }
        self.passes = sorted;
    }

    /// The part of a line of sight within a door's band (its jambs' height, its half of the plan).
    fn pass(&self, d: usize, a: [f64; 2], b: [f64; 2]) -> Option<Pass> {
        let door = &self.doors[d];
        let half = if door.left < 10.0 { [0.0, 10.0] } else { [10.0, 20.0] };
        let band = [door.y - 0.25, door.y + 0.25];
        let (mut t0, mut t1) = (0.0f64, 1.0f64);
        for (axis, range) in [(0, half), (1, band)] {
            let delta = b[axis] - a[axis];
            if delta == 0.0 {
                if a[axis] < range[0] || a[axis] > range[1] {
                    return None;
                }
            } else {
                let (s, e) = ((range[0] - a[axis]) / delta, (range[1] - a[axis]) / delta);
                t0 = t0.max(s.min(e));
                t1 = t1.min(s.max(e));
            }
        }
        if t0 > t1 {
            return None;
        }
        let at = |t: f64, axis: usize| a[axis] + t * (b[axis] - a[axis]);
        let (x0, x1, y0, y1) = (at(t0, 0), at(t1, 0), at(t0, 1), at(t1, 1));
        let crosses = (y0.min(y1)..=y0.max(y1)).contains(&door.y);
        Some(Pass { door: d as u32, span: [x0.min(x1) as f32, x0.max(x1) as f32], crosses })
    }

    /// Means of degree, depth and entropy, and what each query cell reaches.
    fn measure(&self, shift: &[f64]) -> ([f64; 3], Vec<Bits>) {
        let mut rows = vec![[0u64; WORDS]; self.reference.len()];
        let gaps: Vec<[f32; 2]> =
            self.doors.iter().zip(shift).map(|(d, s)| [(d.left + s) as f32, (d.right + s) as f32]).collect();
        let is_free = |p: &Pass| {
            let [left, right] = gaps[p.door as usize];
            if p.crosses {
                left < p.span[0] && p.span[1] < right
            } else {
                let misses = |x: f32| x < p.span[0] || x > p.span[1];
                misses(left) && misses(right)
            }
        };
        for (group, door) in self.groups.iter().zip(0..) {
            let pairs = &self.pairs[group.clone()];
            let (from, to) = if door < gaps.len() {
                let first = |p: &Pair| self.passes[p.passes.start as usize].span[0];
                (
                    pairs.partition_point(|p| first(p) <= gaps[door][0]),
                    pairs.partition_point(|p| first(p) < gaps[door][1]),
                )
            } else {
                (0, pairs.len())
            };
            for pair in &pairs[from..to] {
                if self.passes[pair.passes.start as usize..pair.passes.end as usize].iter().all(is_free) {
                    let [u, v] = pair.cells.map(usize::from);
                    rows[u][v / 64] |= 1 << (v % 64);
                    rows[v][u / 64] |= 1 << (u % 64);
                }
            }
        }
        let mut means = [0.0; 3];
        let mut reached = vec![];
        for &root in &self.query {
            let (degree, depth, entropy, seen) = self.tree(&rows, root);
            means[0] += degree;
            means[1] += depth;
            means[2] += entropy;
            reached.push(seen);
        }
        (means.map(|m| m / self.query.len() as f64), reached)
    }

    fn tree(&self, rows: &[Bits], root: usize) -> (f64, f64, f64, Bits) {
        let degree = (0..self.reference.len())
            .filter(|&v| self.reference[v] && rows[root][v / 64] >> (v % 64) & 1 == 1)
            .count() as f64;
        let mut seen = [0u64; WORDS];
        seen[root / 64] |= 1 << (root % 64);
        let mut front = seen;
        let mut levels = vec![];
        loop {
            let mut next = [0u64; WORDS];
            for (w, &word) in front.iter().enumerate() {
                let mut word = word;
                while word != 0 {
                    let v = w * 64 + word.trailing_zeros() as usize;
                    word &= word - 1;
                    next.iter_mut().zip(&rows[v]).for_each(|(n, r)| *n |= r);
                }
            }
            let mut count = 0;
            for (n, s) in next.iter_mut().zip(&mut seen) {
                *n &= !*s;
                *s |= *n;
                count += n.count_ones();
            }
            if count == 0 {
                break;
            }
            levels.push(f64::from(count));
            front = next;
        }
        let total: f64 = levels.iter().sum();
        let entropy = levels.iter().map(|n| -(n / total) * (n / total).log2()).sum();
        (degree, levels.len() as f64, entropy, seen)
    }

    /// `clr` of the spec by quadrature.
    fn clearance(&self, shift: &[f64]) -> f64 {
        let at = |m: &Merged| {
            let by = |d: Option<usize>| d.map_or(0.0, |d| shift[d]);
            [m.wall[0] + by(m.door[0]), m.wall[1], m.wall[2] + by(m.door[1]), m.wall[3]]
        };
        let walls: Vec<Wall> = self.merged.iter().map(at).collect();
        let mut sum = 0.0;
        for &[i, j] in &self.near {
            let (a, b) = (&walls[i], &walls[j]);
            let square = square_gap(a, b);
            if square > 0.0 && square < 1.0 {
                sum += shared_area(a, b);
            }
        }
        sum
    }

    /// Score and disconnection of a layout.
    fn score(&self, shift: &[f64]) -> (f64, f64) {
        let (m, reached) = self.measure(shift);
        let r = |k: usize| (m[k] - self.initial[k]) / self.initial[k];
        let clearance = self.clearance(shift);
        let length: f64 = self
            .walls
            .iter()
            .zip(&self.moved)
            .map(|(w, m)| {
                let by = |d: Option<usize>| d.map_or(0.0, |d| shift[d]);
                length(&[w[0] + by(m[0]), w[1], w[2] + by(m[1]), w[3]])
            })
            .sum();
        let lost: u32 = reached
            .iter()
            .zip(&self.reached)
            .flat_map(|(now, then)| now.iter().zip(then).map(|(n, t)| (t & !n).count_ones()))
            .sum();
        let penalty = clearance * clearance + (length - self.length).abs();
        let disconnection = (f64::from(lost) / (self.query.len() * self.reference.len()) as f64).powi(2);
        (r(0) - r(1) - r(2) - penalty, disconnection)
    }

    /// What the reference says of the present layout, to see that this evaluator is the maze.
    pub fn check(&self) {
        let zero = vec![0.0; self.doors.len()];
        let ([k, d, h], _) = self.measure(&zero);
        let close = |a: f64, b: f64, tolerance: f64| assert!((a - b).abs() < tolerance, "{a} {b}");
        close(k, 16.833_333_333_333_332, 1e-9);
        close(d, 7.958_333_333_333_333, 1e-9);
        close(h, 2.891_277_257_146_546, 1e-9);
        close(self.clearance(&zero), 1.519_074_446_1, 2e-4);
        assert_eq!((self.reference.len(), self.query.len()), (416, 24));
    }
}

impl Problem for Maze {
    fn name(&self) -> &'static str {
        "maze"
    }
    fn bounds(&self) -> Vec<[f64; 2]> {
        self.doors.iter().map(|d| d.bounds).collect()
    }
    fn start(&self) -> Vec<f64> {
        vec![0.0; self.doors.len()]
    }
    fn worth(&self, p: &[f64]) -> Worth {
        let (score, violation) = self.score(p);
        Worth::plain(score, violation)
    }
}

fn door(marker: &Entity, all: &[Entity], walls: &[Wall]) -> Door {
    let text = all
        .iter()
        .find(|e| e.kind == "TEXT" && contains(marker, e.xs[0], e.ys[0]))
        .map(|e| e.text.clone())
        .unwrap();
    let numbers: Vec<f64> = text.split_whitespace().skip(1).map(|t| t.parse().unwrap()).collect();
    let jambs: Vec<f64> =
        walls.iter().filter(|w| w[0] == w[2] && contains(marker, w[0], w[1])).map(|w| w[0]).collect();
    Door {
        y: (marker.ys[0] + marker.ys[2]) / 2.0,
        left: jambs.iter().copied().fold(f64::MAX, f64::min),
        right: jambs.iter().copied().fold(f64::MIN, f64::max),
        bounds: [numbers[0], numbers[1]],
    }
}

fn lattice(all: &[Entity]) -> (Vec<[f64; 2]>, Vec<usize>, Vec<bool>) {
    let on = |layer: &str, x: f64, y: f64| all.iter().any(|e| e.layer == layer && contains(e, x, y));
    let (mut cells, mut query, mut reference) = (vec![], vec![], vec![]);
    for col in -2..30 {
        for row in -2..30 {
            let (x, y) = (CENTRE[0] + f64::from(col), CENTRE[1] + f64::from(row));
            let (q, r) = (on("EF-QUERY", x, y), on("EF-REFERENCE", x, y));
            if q || r {
                if q {
                    query.push(cells.len());
                }
                cells.push([x, y]);
                reference.push(r);
            }
        }
    }
    (cells, query, reference)
}

fn length(w: &Wall) -> f64 {
    (w[2] - w[0]).hypot(w[3] - w[1])
}

fn blocks(w: &Wall, a: [f64; 2], b: [f64; 2]) -> bool {
    let side =
        |p: [f64; 2], q: [f64; 2], r: [f64; 2]| (q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0]);
    let (c, d) = ([w[0], w[1]], [w[2], w[3]]);
    side(a, b, c) * side(a, b, d) <= 0.0 && side(c, d, a) * side(c, d, b) <= 0.0
}

/// Joins collinear walls at nodes where only two of them meet.
fn merge(walls: &[Wall], moved: &[[Option<usize>; 2]]) -> Vec<Merged> {
    let key = |x: f64, y: f64| ((x * 1e6).round() as i64, (y * 1e6).round() as i64);
    let mut degree: HashMap<(i64, i64), usize> = HashMap::new();
    for w in walls {
        *degree.entry(key(w[0], w[1])).or_default() += 1;
        *degree.entry(key(w[2], w[3])).or_default() += 1;
    }
    let mut out: Vec<Merged> = walls.iter().zip(moved).map(|(w, m)| Merged { wall: *w, door: *m }).collect();
    let mut i = 0;
    while i < out.len() {
        let ends = |m: &Merged| [(m.wall[0], m.wall[1], m.door[0]), (m.wall[2], m.wall[3], m.door[1])];
        let found = (i + 1..out.len()).find_map(|j| {
            for (k, a) in ends(&out[i]).iter().enumerate() {
                for (l, b) in ends(&out[j]).iter().enumerate() {
                    let same_axis = (out[i].wall[0] == out[i].wall[2]) == (out[j].wall[0] == out[j].wall[2]);
                    if key(a.0, a.1) == key(b.0, b.1) && degree[&key(a.0, a.1)] == 2 && same_axis {
                        return Some((j, k, l));
                    }
                }
            }
            None
        });
        if let Some((j, k, l)) = found {
            let (a, b) = (ends(&out[i])[1 - k], ends(&out[j])[1 - l]);
            out[i] = Merged { wall: [a.0, a.1, b.0, b.1], door: [a.2, b.2] };
            out.remove(j);
        } else {
            i += 1;
        }
    }
    out
}

fn sorted(w: &Wall) -> Wall {
    [w[0].min(w[2]), w[1].min(w[3]), w[0].max(w[2]), w[1].max(w[3])]
}

/// Pairs of walls that a shift along x can bring near each other, one of which can move.
fn near(merged: &[Merged]) -> Vec<[usize; 2]> {
    let mut out = vec![];
    for (i, a) in merged.iter().enumerate() {
        for (j, b) in merged.iter().enumerate().skip(i + 1) {
            let (s, t) = (sorted(&a.wall), sorted(&b.wall));
            let moves = a.door != [None, None] || b.door != [None, None];
            if moves && s[1] - t[3] < 1.0 && t[1] - s[3] < 1.0 {
                out.push([i, j]);
            }
        }
    }
    out
}

fn square_gap(a: &Wall, b: &Wall) -> f64 {
    let (a, b) = (sorted(a), sorted(b));
    let gap = |lo: usize| (a[lo] - b[lo + 2]).max(b[lo] - a[lo + 2]).max(0.0);
    gap(0).powi(2) + gap(1).powi(2)
}

/// Area common to the 0.5 m surroundings of two axis-parallel walls.
fn shared_area(a: &Wall, b: &Wall) -> f64 {
    const R: f64 = 0.5;
    const STEPS: usize = 100;
    let (a, b) = (sorted(a), sorted(b));
    let (y0, y1) = (a[1].max(b[1]) - R, a[3].min(b[3]) + R);
    if y1 <= y0 {
        return 0.0;
    }
    let span = |w: &Wall, y: f64| {
        let dy = (w[1] - y).max(y - w[3]).max(0.0);
        let h = (R * R - dy * dy).max(0.0).sqrt();
        (w[0] - h, w[2] + h)
    };
    let (mid, half) = ((y0 + y1) / 2.0, (y1 - y0) / 2.0);
    let mut sum = 0.0;
    for k in 0..STEPS {
        let angle = (k as f64 + 0.5) * std::f64::consts::PI / STEPS as f64;
        let y = mid - half * angle.cos();
        let ((a0, a1), (b0, b1)) = (span(&a, y), span(&b, y));
        sum += (a1.min(b1) - a0.max(b0)).max(0.0) * angle.sin();
    }
    sum * half * std::f64::consts::PI / STEPS as f64
}

//! Isovists: the polygon that is seen from a cell centre, and its measures (depthmapX's definitions).
//!
//! The obstacles stand in a tree of half planes, visited from near to far; each takes its part of the
//! directions that nothing nearer has taken, until none is left. The box of everything closes the view
//! where the plan is open.

use rayon::prelude::*;

use crate::plan::geometry::{Segment, UM_PER_M};

use super::measures::{Column, UNDEFINED, transpose};
use super::visibility::seeing_cells;
use super::{Lattice, Obstacles};

/// Directions nearer to each other than this count as one; a full turn is 4. A gap of 1 µm seen from
/// 200 m is wider; two walls that meet in a corner leave less.
const SAME_DIRECTION: f64 = 1e-9;

/// Radial edges shorter than this, metres, come from rounding.
const SAME_PLACE_M: f64 = 1e-7;

/// Walls tried as the splitter of a half of the tree.
const SPLITTERS: usize = 8;

/// Distance of the closing box from everything, metres.
const MARGIN_M: f64 = 1.0;

const NONE: u32 = u32::MAX;

type Point = [f64; 2];

/// Area, perimeter (metres), compactness, occlusivity, radials and drift of every vertex's isovist;
/// [`UNDEFINED`] for vertices that see nothing because an obstacle covers them.
pub fn isovist_columns(lattice: &Lattice, obstacles: &Obstacles) -> Vec<Column> {
    let names = [
        "Isovist Area",
        "Isovist Compactness",
        "Isovist Drift Angle",
        "Isovist Drift Magnitude",
        "Isovist Max Radial",
        "Isovist Min Radial",
        "Isovist Occlusivity",
        "Isovist Perimeter",
    ];
    let all: Vec<u32> = (0..lattice.cells.len() as u32).collect();
    transpose(names.map(String::from), &isovists(lattice, obstacles, &all))
}

/// Area (m²), perimeter (m), compactness, occlusivity, drift, longest and shortest radial (m) of the
/// isovists of the query vertices, in their order; 0 for those that see nothing.
pub fn query_isovists(lattice: &Lattice, obstacles: &Obstacles) -> Vec<[f64; 7]> {
    let rows = isovists(lattice, obstacles, &lattice.query);
    let value = |v: f64| if v == UNDEFINED || !v.is_finite() { 0.0 } else { v };
    rows.into_iter().map(|r| [r[0], r[7], r[1], r[6], r[3], r[4], r[5]].map(value)).collect()
}

/// The values of [`isovist_columns`] for some vertices.
fn isovists(lattice: &Lattice, obstacles: &Obstacles, vertices: &[u32]) -> Vec<[f64; 8]> {
    let sees = seeing_cells(lattice, obstacles);
    let origin = lattice.cells.first().map_or([0, 0], |_| lattice.centre_um(0));
    let local = |p: [i64; 2]| [0, 1].map(|k| (p[k] - origin[k]) as f64 / UM_PER_M);
    let centres: Vec<Point> = (0..lattice.cells.len()).map(|v| local(lattice.centre_um(v))).collect();
    let tree = Tree::new(obstacles.segments.iter().map(|s: &Segment| [local(s.a), local(s.b)]), &centres);
    let row = |view: &mut View, v: &u32| {
        if sees[*v as usize] { view.measures(&tree, centres[*v as usize]) } else { [UNDEFINED; 8] }
    };
    vertices.par_iter().map_init(View::default, row).collect()
}

/// A wall or a part of one, and what stands on either side of its line.
struct Node {
    wall: [Point; 2],
    left: u32,
    right: u32,
    /// Box of the whole subtree.
    low: Point,
    high: Point,
}

struct Tree {
    nodes: Vec<Node>,
    root: u32,
}

impl Tree {
    fn new(walls: impl Iterator<Item = [Point; 2]>, centres: &[Point]) -> Self {
        let mut walls: Vec<_> = walls.filter(|w| w[0] != w[1]).collect();
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for p in walls.iter().flatten().chain(centres) {
            for k in 0..2 {
                low[k] = low[k].min(p[k] - MARGIN_M);
                high[k] = high[k].max(p[k] + MARGIN_M);
            }
        }
        let corners = [low, [high[0], low[1]], high, [low[0], high[1]]];
        walls.extend((0..4).map(|i| [corners[i], corners[(i + 1) % 4]]));
        let mut tree = Self { nodes: Vec::with_capacity(walls.len() * 2), root: NONE };
        tree.root = tree.grow(walls);
        tree
    }

    fn grow(&mut self, walls: Vec<[Point; 2]>) -> u32 {
        let Some(at) = splitter(&walls) else { return NONE };
        let wall = walls[at];
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for p in walls.iter().flatten() {
            for k in 0..2 {
                low[k] = low[k].min(p[k]);
                high[k] = high[k].max(p[k]);
            }
        }
        let (mut left, mut right) = (Vec::new(), Vec::new());
        for (i, other) in walls.into_iter().enumerate() {
            if i != at {
                split(wall, other, &mut left, &mut right);
            }
        }
        let node = self.nodes.len();
        self.nodes.push(Node { wall, left: NONE, right: NONE, low, high });
        let (left, right) = (self.grow(left), self.grow(right));
        self.nodes[node].left = left;
        self.nodes[node].right = right;
        node as u32
    }
}

/// The wall, of a few spread over the list, whose line cuts fewest and halves best.
fn splitter(walls: &[[Point; 2]]) -> Option<usize> {
    let tried = walls.len().min(SPLITTERS);
    (0..tried).map(|i| i * walls.len() / tried).min_by_key(|&at| {
        let (mut left, mut right, mut cut) = (0i64, 0i64, 0i64);
        for other in walls.iter().take(256) {
            match sides(walls[at], *other) {
                (l, r) if l && r => cut += 1,
                (true, _) => left += 1,
                _ => right += 1,
            }
        }
        3 * cut + (left - right).abs()
    })
}

/// On which sides of a wall's line another reaches.
fn sides(wall: [Point; 2], other: [Point; 2]) -> (bool, bool) {
    let [a, b] = other.map(|p| offset(wall, p));
    (a.max(b) > SAME_PLACE_M, a.min(b) < -SAME_PLACE_M)
}

/// Distance of a point from the wall's line, positive on its left.
fn offset(wall: [Point; 2], p: Point) -> f64 {
    let along = minus(wall[1], wall[0]);
    cross(along, minus(p, wall[0])) / along[0].hypot(along[1])
}

fn split(wall: [Point; 2], other: [Point; 2], left: &mut Vec<[Point; 2]>, right: &mut Vec<[Point; 2]>) {
    match sides(wall, other) {
        (true, true) => {
            let [a, b] = other.map(|p| offset(wall, p));
            let t = a / (a - b);
            let middle = [0, 1].map(|k| other[0][k] + (other[1][k] - other[0][k]) * t);
            let parts = if a > 0.0 { [left, right] } else { [right, left] };
            let [first, second] = parts;
            first.push([other[0], middle]);
            second.push([middle, other[1]]);
        }
        (_, true) => right.push(other),
        _ => left.push(other),
    }
}

/// What one viewer sees: buffers of one worker.
#[derive(Default)]
struct View {
    /// Directions nothing has taken yet, ascending.
    gaps: Vec<[f64; 2]>,
    next_gaps: Vec<[f64; 2]>,
    /// Directions from, to, and the wall seen there.
    seen: Vec<(f64, f64, u32)>,
}

impl View {
    fn measures(&mut self, tree: &Tree, viewer: Point) -> [f64; 8] {
        self.gaps.clear();
        self.gaps.push([0.0, 4.0]);
        self.seen.clear();
        self.visit(tree, tree.root, viewer);
        self.seen.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
        let edges = self.seen.iter().map(|&(from, to, node)| {
            let wall = tree.nodes[node as usize].wall.map(|p| minus(p, viewer));
            [hit(wall, from), hit(wall, to)]
        });
        polygon_measures(edges)
    }

    fn visit(&mut self, tree: &Tree, at: u32, viewer: Point) {
        if at == NONE || self.gaps.is_empty() {
            return;
        }
        let node = &tree.nodes[at as usize];
        if self.hides(minus(node.low, viewer), minus(node.high, viewer)) {
            return;
        }
        let [a, b] = node.wall.map(|p| minus(p, viewer));
        let side = cross(a, b);
        let (near, far) = if side > 0.0 { (node.left, node.right) } else { (node.right, node.left) };
        self.visit(tree, near, viewer);
        let (from, to) = if side > 0.0 { (direction(a), direction(b)) } else { (direction(b), direction(a)) };
        if side != 0.0 && from <= to {
            self.take(from, to, at);
        } else if side != 0.0 {
            self.take(from, 4.0, at);
            self.take(0.0, to, at);
        }
        self.visit(tree, far, viewer);
    }

    /// Whether nearer walls have taken all directions of a box.
    fn hides(&self, low: Point, high: Point) -> bool {
        if low[0] <= 0.0 && high[0] >= 0.0 && low[1] <= 0.0 && high[1] >= 0.0 {
            return false;
        }
        let corners = [low, [high[0], low[1]], high, [low[0], high[1]]].map(direction);
        let least = corners.iter().copied().fold(4.0, f64::min);
        let most = corners.iter().copied().fold(0.0, f64::max);
        let open = |from: f64, to: f64| self.gaps.iter().any(|g| g[0] < to && g[1] > from);
        if most - least <= 2.0 {
            return !open(least, most);
        }
        let from = corners.iter().copied().filter(|d| *d > 2.0).fold(4.0, f64::min);
        let to = corners.iter().copied().filter(|d| *d <= 2.0).fold(0.0, f64::max);
        !open(from, 4.0) && !open(0.0, to)
    }

    /// Gives the free directions between two to a wall.
    fn take(&mut self, from: f64, to: f64, wall: u32) {
        if !self.gaps.iter().any(|g| g[0] < to && g[1] > from) {
            return;
        }
        self.next_gaps.clear();
        for &[lo, hi] in &self.gaps {
            let (start, end) = (lo.max(from), hi.min(to));
            if end <= start {
                self.next_gaps.push([lo, hi]);
                continue;
            }
            self.seen.push((start, end, wall));
            if start - lo > SAME_DIRECTION {
                self.next_gaps.push([lo, start]);
            }
            if hi - end > SAME_DIRECTION {
                self.next_gaps.push([end, hi]);
            }
        }
        std::mem::swap(&mut self.gaps, &mut self.next_gaps);
    }
}

/// Measures of the polygon whose solid edges, seen from the origin, follow each other anticlockwise.
fn polygon_measures(edges: impl Iterator<Item = [Point; 2]> + Clone) -> [f64; 8] {
    let (mut area, mut perimeter, mut occlusivity) = (0.0, 0.0, 0.0);
    let (mut centroid, mut max_radial, mut min_radial) = ([0.0; 2], 0.0f64, f64::INFINITY);
    let mut last = edges.clone().last().map_or([0.0; 2], |e| e[1]);
    for [p, q] in edges {
        let radial = length(minus(p, last));
        if radial > SAME_PLACE_M {
            occlusivity += radial;
        }
        perimeter += radial + length(minus(q, p));
        let twice = cross(p, q);
        area += twice / 2.0;
        (0..2).for_each(|k| centroid[k] += twice * (p[k] + q[k]) / 6.0);
        max_radial = max_radial.max(length(p)).max(length(q));
        min_radial = min_radial.min(distance_to(p, q));
        last = q;
    }
    let drift = centroid.map(|c| c / area);
    let angle = drift[1].atan2(drift[0]).to_degrees();
    let compactness = 4.0 * std::f64::consts::PI * area / (perimeter * perimeter);
    let angle = if angle < 0.0 { angle + 360.0 } else { angle };
    [area, compactness, angle, length(drift), max_radial, min_radial, occlusivity, perimeter]
}

/// Distance of the origin from the piece between two points.
fn distance_to(p: Point, q: Point) -> f64 {
    let along = minus(q, p);
    let square = along[0] * along[0] + along[1] * along[1];
    let t = if square > 0.0 { -(p[0] * along[0] + p[1] * along[1]) / square } else { 0.0 };
    let t = t.clamp(0.0, 1.0);
    length([p[0] + along[0] * t, p[1] + along[1] * t])
}

/// A direction as a number from 0 to 4 that grows anticlockwise from +x like the angle.
fn direction([x, y]: Point) -> f64 {
    let sum = x.abs() + y.abs();
    if sum == 0.0 {
        return 0.0;
    }
    let turn = y / sum;
    if x < 0.0 {
        2.0 - turn
    } else if y < 0.0 {
        4.0 + turn
    } else {
        turn
    }
}

/// Where the ray of a direction meets the wall's line.
fn hit(wall: [Point; 2], direction: f64) -> Point {
    let ray = match direction {
        d if d < 1.0 => [1.0 - d, d],
        d if d < 2.0 => [1.0 - d, 2.0 - d],
        d if d < 3.0 => [d - 3.0, 2.0 - d],
        d => [d - 3.0, d - 4.0],
    };
    let along = minus(wall[1], wall[0]);
    let t = cross(wall[0], along) / cross(ray, along);
    ray.map(|r| r * t)
}

fn minus(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1]]
}

fn cross(a: Point, b: Point) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

fn length(a: Point) -> f64 {
    a[0].hypot(a[1])
}

#[cfg(test)]
mod tests {
    use super::super::fixtures;
    use super::*;

    fn value(columns: &[Column], name: &str, v: usize) -> f64 {
        columns.iter().find(|c| c.name == name).unwrap().values[v]
    }

    fn room(walls: &[[i64; 4]], cells: Vec<[i32; 2]>) -> Vec<Column> {
        let m = |v: i64| v * 1_000_000;
        let segment = |w: &[i64; 4]| Segment { a: [m(w[0]), m(w[1])], b: [m(w[2]), m(w[3])] };
        let obstacles = Obstacles { segments: walls.iter().map(segment).collect(), blind: vec![] };
        isovist_columns(&fixtures::lattice(1_000_000, [0, 0], cells), &obstacles)
    }

    const BOX: [[i64; 4]; 4] = [[0, 0, 8, 0], [8, 0, 8, 4], [8, 4, 0, 4], [0, 4, 0, 0]];

    #[test]
    fn an_empty_room_is_its_own_isovist() {
        let columns = room(&BOX, vec![[2, 1]]);
        let expect = [
            ("Isovist Area", 32.0),
            ("Isovist Perimeter", 24.0),
            ("Isovist Occlusivity", 0.0),
            ("Isovist Min Radial", 1.0),
            ("Isovist Max Radial", 45f64.sqrt()),
            ("Isovist Drift Magnitude", 5f64.sqrt()),
            ("Isovist Drift Angle", 0.5f64.atan().to_degrees()),
        ];
        for (name, expected) in expect {
            assert!((value(&columns, name, 0) - expected).abs() < 1e-9, "{name}");
        }
    }

    #[test]
    fn a_screen_hides_what_lies_behind_it() {
        // From (2, 2) a screen at x = 4 between y = 1 and y = 3 hides a wedge that widens to the far wall.
        let mut walls = BOX.to_vec();
        walls.push([4, 1, 4, 3]);
        let columns = room(&walls, vec![[2, 2], [4, 2]]);
        let hidden = 2.0 * (2.0 + 4.0) / 2.0 + 2.0 * 4.0;
        assert!((value(&columns, "Isovist Area", 0) - (32.0 - hidden)).abs() < 1e-9);
        assert!((value(&columns, "Isovist Occlusivity", 0) - 2.0 * 5f64.sqrt()).abs() < 1e-9);
        assert_eq!(value(&columns, "Isovist Area", 1), UNDEFINED);
    }

    #[test]
    fn isovists_equal_depthmapx() {
        let Some((lattice, obstacles, header, rows)) = fixtures::n900() else { return };
        for column in isovist_columns(&lattice, &obstacles) {
            let k = header.iter().position(|h| *h == column.name).unwrap();
            for (v, row) in rows.iter().enumerate() {
                let (ours, theirs) = (column.values[v], row[k]);
                let error = (ours - theirs).abs() / theirs.abs().max(1e-3);
                assert!(error <= 1e-4, "{} of {}: {ours} {theirs}", column.name, row[0]);
            }
        }
    }
}

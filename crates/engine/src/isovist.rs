//! Isovists: the polygon that is seen from a cell centre, and its measures (depthmapX's definitions).
//!
//! The obstacles stand in a tree of half planes, visited from near to far; each takes its part of the
//! directions that nothing nearer has taken, until none is left. The box of everything closes the view
//! where the plan is open.
//!
//! Coordinates are whole micrometres, so differences are exact and `direction` never turns the order of
//! two of them over; on which side of a wall a viewer stands is decided exactly. A wall that a viewer sees
//! edge-on hides nothing.

use enfilade_brief::column::DRIFT_ANGLE;
use enfilade_brief::{Measure, column_of};
use rayon::prelude::*;

use crate::geometry::{Segment, UM_PER_M};

use super::measures::{Column, UNDEFINED, transpose};
use super::visibility::seeing_cells;
use super::{Lattice, Obstacles};

/// Where two walls cross is known to this, micrometres.
const CROSSING_UM: f64 = 1e-3;

/// A cross product of exact differences is right to this part of its two products' sum.
const CROSS_ERROR: f64 = 4e-16;

/// A ray that leaves a wall by less than this part of its length meets it nowhere in particular.
const EDGE_ON: f64 = 1e-6;

/// A wall takes less than half a turn, 2: ends in the wrong order by less than this were rounded.
const ROUNDED_TURN: f64 = 1.0;

/// Radial edges shorter than this, metres, come from rounding.
const SAME_PLACE_M: f64 = 1e-7;

/// Walls tried as the splitter of a half of the tree.
const SPLITTERS: usize = 8;

/// Distance of the closing box from everything, micrometres.
const MARGIN_UM: f64 = UM_PER_M;

const NONE: u32 = u32::MAX;

type Point = [f64; 2];

/// Area, perimeter (metres), compactness, occlusivity, radials and drift of every vertex's isovist;
/// [`UNDEFINED`] for vertices that see nothing because an obstacle covers them.
pub fn isovist_columns(lattice: &Lattice, obstacles: &Obstacles) -> Vec<Column> {
    let all: Vec<u32> = (0..lattice.cells.len() as u32).collect();
    isovist_columns_from(&isovists(lattice, obstacles, &all))
}

/// [`isovist_columns`] from the rows of all vertices.
pub fn isovist_columns_from(rows: &[[f64; 8]]) -> Vec<Column> {
    let names = [
        column_of(Measure::IsovistArea),
        column_of(Measure::IsovistCompactness),
        DRIFT_ANGLE,
        column_of(Measure::IsovistDrift),
        column_of(Measure::IsovistMaxRadial),
        column_of(Measure::IsovistMinRadial),
        column_of(Measure::IsovistOcclusivity),
        column_of(Measure::IsovistPerimeter),
    ];
    transpose(names.map(String::from), rows)
}

/// Area (m²), perimeter (m), compactness, occlusivity, drift, longest and shortest radial (m) of the
/// isovists of the query vertices, in their order; 0 for those that see nothing.
pub fn query_isovists(lattice: &Lattice, obstacles: &Obstacles) -> Vec<[f64; 7]> {
    let rows = isovists(lattice, obstacles, &lattice.query);
    let value = |v: f64| if v == UNDEFINED { 0.0 } else { v };
    rows.into_iter().map(|r| [r[0], r[7], r[1], r[6], r[3], r[4], r[5]].map(value)).collect()
}

/// The values of [`isovist_columns`] for some vertices.
pub fn isovists(lattice: &Lattice, obstacles: &Obstacles, vertices: &[u32]) -> Vec<[f64; 8]> {
    let sees = seeing_cells(lattice, obstacles);
    let origin = lattice.cells.first().map_or([0, 0], |_| lattice.centre_um(0));
    let local = |p: [i64; 2]| [0, 1].map(|k| (p[k] - origin[k]) as f64);
    let centres: Vec<Point> = (0..lattice.cells.len()).map(|v| local(lattice.centre_um(v))).collect();
    let tree = Tree::new(obstacles.segments.iter().map(|s: &Segment| [local(s.a), local(s.b)]), &centres);
    let row = |view: &mut View, v: &u32| {
        if sees[*v as usize] { view.measures(&tree, centres[*v as usize]) } else { [UNDEFINED; 8] }
    };
    vertices.par_iter().map_init(View::default, row).collect()
}

/// A wall, or what crossings have left of it.
#[derive(Clone, Copy)]
struct Piece {
    /// The whole wall, between whole micrometres.
    wall: [Point; 2],
    ends: [Point; 2],
    /// The wall whose line an end was cut at: that end is rounded.
    cut_at: [Option<[Point; 2]>; 2],
}

/// A piece of a wall and what stands on either side of the wall's line.
struct Node {
    piece: Piece,
    left: u32,
    right: u32,
    /// Box of the whole subtree, whole micrometres.
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
                low[k] = low[k].min(p[k] - MARGIN_UM);
                high[k] = high[k].max(p[k] + MARGIN_UM);
            }
        }
        let corners = [low, [high[0], low[1]], high, [low[0], high[1]]];
        walls.extend((0..4).map(|i| [corners[i], corners[(i + 1) % 4]]));
        let mut tree = Self { nodes: Vec::with_capacity(walls.len() * 2), root: NONE };
        let whole = |wall| Piece { wall, ends: wall, cut_at: [None; 2] };
        tree.root = tree.grow(walls.into_iter().map(whole).collect());
        tree
    }

    fn grow(&mut self, pieces: Vec<Piece>) -> u32 {
        let Some(at) = splitter(&pieces) else { return NONE };
        let piece = pieces[at];
        let (low, high) = bounds(&pieces);
        let (mut left, mut right) = (Vec::new(), Vec::new());
        for (i, other) in pieces.into_iter().enumerate() {
            if i != at {
                split(piece.wall, other, &mut left, &mut right);
            }
        }
        let node = self.nodes.len();
        self.nodes.push(Node { piece, left: NONE, right: NONE, low, high });
        let (left, right) = (self.grow(left), self.grow(right));
        self.nodes[node].left = left;
        self.nodes[node].right = right;
        node as u32
    }
}

/// The box of some pieces, wider by a micrometre at crossings: no rounding takes a piece out of it.
fn bounds(pieces: &[Piece]) -> (Point, Point) {
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for piece in pieces {
        for (p, cut_at) in piece.ends.iter().zip(piece.cut_at) {
            let spare = f64::from(u8::from(cut_at.is_some()));
            for k in 0..2 {
                low[k] = low[k].min(p[k].floor() - spare);
                high[k] = high[k].max(p[k].ceil() + spare);
            }
        }
    }
    (low, high)
}

/// The piece, of a few spread over the list, whose line cuts fewest and halves best.
fn splitter(pieces: &[Piece]) -> Option<usize> {
    let tried = pieces.len().min(SPLITTERS);
    (0..tried).map(|i| i * pieces.len() / tried).min_by_key(|&at| {
        let (mut left, mut right, mut cut) = (0i64, 0i64, 0i64);
        for other in pieces.iter().take(256) {
            match offsets(pieces[at].wall, other) {
                [a, b] if a.max(b) > 0.0 && a.min(b) < 0.0 => cut += 1,
                [a, b] if a.max(b) > 0.0 => left += 1,
                _ => right += 1,
            }
        }
        3 * cut + (left - right).abs()
    })
}

/// How far the ends of a piece lie to the left of a wall's line: exactly 0, or of the right sign.
fn offsets(wall: [Point; 2], piece: &Piece) -> [f64; 2] {
    let along = minus(wall[1], wall[0]);
    let whole = piece.wall.map(|p| exact_cross(along, minus(p, wall[0])));
    let least = CROSSING_UM * length(along);
    let offset = |k: usize| {
        if piece.cut_at[k].is_none() {
            return whole[k];
        }
        let rounded = cross(along, minus(piece.ends[k], wall[0]));
        let (low, high) = (whole[0].min(whole[1]), whole[0].max(whole[1]));
        if rounded.abs() < least { 0.0 } else { rounded.clamp(low, high) }
    };
    [offset(0), offset(1)]
}

fn split(wall: [Point; 2], other: Piece, left: &mut Vec<Piece>, right: &mut Vec<Piece>) {
    let [a, b] = offsets(wall, &other);
    if a.max(b) <= 0.0 {
        right.push(other);
    } else if a.min(b) >= 0.0 {
        left.push(other);
    } else {
        let [start, end] = other.ends;
        let t = a / (a - b);
        let middle = [0, 1].map(|k| start[k] + (end[k] - start[k]) * t);
        let [first, second] = if a > 0.0 { [left, right] } else { [right, left] };
        first.push(Piece { ends: [start, middle], cut_at: [other.cut_at[0], Some(wall)], ..other });
        second.push(Piece { ends: [middle, end], cut_at: [Some(wall), other.cut_at[1]], ..other });
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
            let wall = tree.nodes[node as usize].piece.wall.map(|p| minus(p, viewer));
            [from, to].map(|direction| hit(wall, direction).map(|um| um / UM_PER_M))
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
        let [a, b] = node.piece.wall.map(|p| minus(p, viewer));
        let side = exact_cross(a, b);
        let (near, far) = if side > 0.0 { (node.left, node.right) } else { (node.right, node.left) };
        self.visit(tree, near, viewer);
        if side != 0.0 {
            let [mut from, mut to] = directions(&node.piece, viewer);
            if side < 0.0 {
                std::mem::swap(&mut from, &mut to);
            }
            if from <= to {
                self.take(from, to, at);
            } else if from - to > ROUNDED_TURN {
                self.take(from, 4.0, at);
                self.take(0.0, to, at);
            }
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
            if start > lo {
                self.next_gaps.push([lo, start]);
            }
            if hi > end {
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
    let drift = centroid.map(|c| if area > 0.0 { c / area } else { 0.0 });
    let angle = drift[1].atan2(drift[0]).to_degrees();
    let compactness = 4.0 * std::f64::consts::PI * area / (perimeter * perimeter);
    let angle = if angle < 0.0 { (angle + 360.0) % 360.0 } else { angle };
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

/// The directions of a piece's ends; crossings lie between the ends of the wall, whatever rounding says.
fn directions(piece: &Piece, viewer: Point) -> [f64; 2] {
    if piece.cut_at == [None; 2] {
        return piece.ends.map(|p| direction(minus(p, viewer)));
    }
    let [a, b] = piece.wall.map(|p| direction(minus(p, viewer)));
    let (low, high) = (a.min(b), a.max(b));
    [0, 1].map(|k| {
        let d = end_direction(piece, k, viewer);
        if high - low <= 2.0 {
            d.clamp(low, high)
        } else if d <= low || d >= high {
            d
        } else if d - low < high - d {
            low
        } else {
            high
        }
    })
}

/// The direction of an end; where a viewer stands in line with the wall that cut it, exactly that wall's.
fn end_direction(piece: &Piece, end: usize, viewer: Point) -> f64 {
    let own = direction(minus(piece.ends[end], viewer));
    let Some([a, b]) = piece.cut_at[end].map(|wall| wall.map(|p| minus(p, viewer))) else { return own };
    if exact_cross(a, b) != 0.0 {
        return own;
    }
    let along = minus(b, a);
    let [ahead, behind] = [along, along.map(|v| -v)].map(direction);
    let off = (own - ahead).abs();
    if off.min(4.0 - off) < 1.0 { ahead } else { behind }
}

/// Where the ray of a direction meets a wall that takes it.
fn hit(wall: [Point; 2], towards: f64) -> Point {
    let ray = match towards {
        d if d < 1.0 => [1.0 - d, d],
        d if d < 2.0 => [1.0 - d, 2.0 - d],
        d if d < 3.0 => [d - 3.0, 2.0 - d],
        d => [d - 3.0, d - 4.0],
    };
    let along = minus(wall[1], wall[0]);
    let leaves = cross(ray, along);
    if leaves.abs() < EDGE_ON * (along[0].abs() + along[1].abs())
        && let Some(&end) = wall.iter().find(|p| direction(**p) == towards)
    {
        return end;
    }
    let part = (cross(wall[0], ray) / leaves).clamp(0.0, 1.0);
    if part.is_nan() { wall[0] } else { [0, 1].map(|k| wall[0][k] + along[k] * part) }
}

/// The cross product of whole numbers: 0 only if it is, else of the right sign.
fn exact_cross(a: Point, b: Point) -> f64 {
    let (plus, less) = (a[0] * b[1], a[1] * b[0]);
    let value = plus - less;
    if value.abs() > CROSS_ERROR * (plus.abs() + less.abs()) {
        return value;
    }
    let whole = |v: f64| v as i128;
    (whole(a[0]) * whole(b[1]) - whole(a[1]) * whole(b[0])) as f64
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
    use proptest::prelude::*;

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

    /// Side of a cell of the drawings below, micrometres.
    const GRID_UM: i64 = 100_000;

    const ROOM: [[i64; 4]; 4] = [[0, 0, 13, 0], [13, 0, 13, 11], [13, 11, 0, 11], [0, 11, 0, 0]];

    type Whole = [i128; 2];

    fn turn(a: Whole, b: Whole) -> i128 {
        a[0] * b[1] - a[1] * b[0]
    }

    /// Measures of one isovist by whole numbers, with all that any two walls do to each other.
    fn slow_measures(walls: &[[i64; 4]], viewer: [i64; 2]) -> [f64; 8] {
        let [x, y] = viewer.map(i128::from);
        let near = |w: &[i64; 4]| {
            let [a, b, c, d] = w.map(i128::from);
            [[a - x, b - y], [c - x, d - y]]
        };
        let walls: Vec<[Whole; 2]> = walls.iter().map(near).collect();
        let along = |w: &[Whole; 2]| [w[1][0] - w[0][0], w[1][1] - w[0][1]];
        let mut ends: Vec<Whole> = walls.iter().flatten().copied().collect();
        for (v, w) in walls.iter().flat_map(|v| walls.iter().map(move |w| (v, w))) {
            // Where the lines cross, times `whole`.
            let (d, e) = (along(v), along(w));
            let whole = turn(d, e);
            let part = turn([w[0][0] - v[0][0], w[0][1] - v[0][1]], e);
            if whole != 0 {
                ends.push([0, 1].map(|k| (v[0][k] * whole + d[k] * part) * whole.signum()));
            }
        }
        let upper = |d: &Whole| d[1] > 0 || (d[1] == 0 && d[0] > 0);
        ends.retain(|d| *d != [0, 0]);
        ends.sort_by(|a, b| upper(b).cmp(&upper(a)).then(turn(*b, *a).cmp(&0)));
        ends.dedup_by(|a, b| upper(a) == upper(b) && turn(*a, *b) == 0);
        let mut edges = Vec::new();
        for (i, &from) in ends.iter().enumerate() {
            let to = ends[(i + 1) % ends.len()];
            let size = |d: Whole| d[0].abs() + d[1].abs();
            let ray = [0, 1].map(|k| from[k] * size(to) + to[k] * size(from));
            let seen = walls.iter().filter(|w| {
                let (a, b) = (turn(ray, w[0]), turn(ray, w[1]));
                let side = turn(w[0], w[1]);
                (a < 0 && b > 0 && side > 0) || (a > 0 && b < 0 && side < 0)
            });
            // The nearest: least side ÷ turn of the ray and the wall, both of one sign.
            let reach = |w: &[Whole; 2]| (turn(w[0], w[1]), turn(ray, along(w)));
            let wall = seen.min_by(|v, w| {
                let ((a, b), (c, d)) = (reach(v), reach(w));
                (a * d * (b * d).signum()).cmp(&(c * b * (b * d).signum()))
            });
            let wall = wall.expect("the room is closed");
            let place = |d: Whole| {
                let (side, leaves) = (turn(wall[0], wall[1]), turn(d, along(wall)));
                d.map(|k| (k * side) as f64 / leaves as f64 * GRID_UM as f64 / UM_PER_M)
            };
            edges.push([place(from), place(to)]);
        }
        polygon_measures(edges.into_iter())
    }

    fn close(a: f64, b: f64) -> bool {
        (a - b).abs() <= 1e-6 * a.abs().max(1.0)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(96))]

        /// Cells in line with oblique walls, at their ends and where they cross, at two scales.
        #[test]
        fn isovists_equal_whole_numbers(
            walls in prop::collection::vec(prop::array::uniform4(0i64..12), 1..7),
        ) {
            let walls: Vec<_> = ROOM.into_iter().chain(walls).collect();
            let cells: Vec<[i32; 2]> = (1..12).flat_map(|x| (1..11).map(move |y| [x, y])).collect();
            let columns = |um: i64| {
                let segment = |w: &[i64; 4]| Segment { a: [w[0] * um, w[1] * um], b: [w[2] * um, w[3] * um] };
                let obstacles = Obstacles { segments: walls.iter().map(segment).collect(), blind: vec![] };
                let lattice = fixtures::lattice(um, [0, 0], cells.clone());
                let rows = isovists(&lattice, &obstacles, &lattice.query);
                (lattice, rows)
            };
            let (lattice, rows) = columns(GRID_UM);
            let (_, larger) = columns(GRID_UM * 10);
            for (v, row) in rows.iter().enumerate().filter(|(_, row)| row[0] != UNDEFINED) {
                let at = lattice.centre_um(v).map(|um| um / GRID_UM);
                let slow = slow_measures(&walls, at);
                let scales = [100.0, 1.0, 1.0, 10.0, 10.0, 10.0, 10.0, 10.0];
                for k in 0..8 {
                    if k == 2 {
                        // No angle where the drift is nothing; a full turn is none.
                        let off = (row[2] - slow[2]).abs();
                        prop_assert!((0.0..360.0).contains(&row[2]));
                        prop_assert!(row[3] < 1e-6 || off.min(360.0 - off) < 1e-3, "{at:?}: {row:?} {slow:?}");
                        continue;
                    }
                    prop_assert!(row[k].is_finite() && close(row[k], slow[k]), "{k} at {at:?}: {row:?} {slow:?}");
                    prop_assert!(close(row[k] * scales[k], larger[v][k]), "{k} at {at:?}: {row:?}");
                }
            }
        }
    }

    /// A wall that cells stand in line with, in a room that no cell grid fits.
    #[test]
    fn a_wall_seen_edge_on_hides_nothing() {
        let room = [[0, 0, 117, 0], [117, 0, 117, 83], [117, 83, 0, 83], [0, 83, 0, 0], [100, 40, 110, 30]];
        let segment = |w: &[i64; 4]| {
            let [a, b, c, d] = w.map(|v| v * GRID_UM);
            Segment { a: [a, b], b: [c, d] }
        };
        let obstacles = Obstacles { segments: room.iter().map(segment).collect(), blind: vec![] };
        let cells = (0..16).flat_map(|x| (0..11).map(move |y| [x, y])).collect();
        let lattice = fixtures::lattice(700_000, [700_000, 700_000], cells);
        for (v, row) in isovists(&lattice, &obstacles, &lattice.query).iter().enumerate() {
            let [x, y] = lattice.centre_um(v);
            if x + y == 14_000_000 && row[0] != UNDEFINED {
                assert!(
                    (row[0] - 11.7 * 8.3).abs() < 1e-9 && (row[7] - 40.0).abs() < 1e-9,
                    "{x} {y}: {row:?}"
                );
            }
            assert!(row.iter().all(|v| v.is_finite()), "{x} {y}: {row:?}");
        }
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

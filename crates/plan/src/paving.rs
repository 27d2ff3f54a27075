//! Paving and ceiling grids drawn among walls: many small equal cells side by side both ways. They are no
//! walls.

use std::collections::BTreeMap;

use glam::DVec2;

use super::parallels::Straight;
use crate::sizes::{COLLINEAR_M, ERROR_GAP_M};

/// Sides of a cell, metres: a mosaic's to a slab's; no room is so small.
const CELL_M: [f64; 2] = [0.1, 1.6];

/// Cells both ways that make a grid: more than shelves, cabins or panes have.
const CELLS_MIN: usize = 4;

/// Grid lines run at right angles within this, radians.
const SQUARE_RAD: f64 = 0.01;

/// A line of a grid by its direction: along it and across.
#[derive(Clone, Copy)]
struct Side {
    index: usize,
    from: f64,
    offset: f64,
    length: f64,
}

/// Indices of the lines (metres) that draw grids, among lines that nobody calls walls: with all that is cut off of a
/// grid's joints at both its ends; ascending.
pub(super) fn find_joints(lines: &[Straight]) -> Vec<usize> {
    found(lines, true)
}

fn found(lines: &[Straight], with_joints: bool) -> Vec<usize> {
    let mut is_grid = vec![false; lines.len()];
    for along in directions(lines) {
        let sides: [Vec<Side>; 2] = [along, along.perp()].map(|u| sides(lines, u));
        let grids = [equal_cells(&sides[0]), equal_cells(&sides[1])];
        if grids.iter().all(Vec::is_empty) {
            continue;
        }
        for (own, grid) in sides.iter().zip(&grids) {
            grid.iter().for_each(|s| is_grid[own[*s].index] = true);
        }
        let lattices = [0, 1].map(|k| Lattice::of(&sides[k], &grids[k]));
        if let [Some(x), Some(y)] = lattices {
            cut_cells(&sides, &[x, y], with_joints).into_iter().for_each(|i| is_grid[i] = true);
        }
    }
    (0..lines.len()).filter(|i| is_grid[*i]).collect()
}

/// Directions that many short lines have, within a quarter turn.
fn directions(lines: &[Straight]) -> Vec<DVec2> {
    let mut bins: BTreeMap<i64, (usize, f64)> = BTreeMap::new();
    for line in lines.iter().filter(|l| (CELL_M[0]..=CELL_M[1]).contains(&l.length())) {
        let angle = line.direction_rad().rem_euclid(std::f64::consts::FRAC_PI_2);
        let bin = bins.entry((angle / SQUARE_RAD).round() as i64).or_default();
        *bin = (bin.0 + 1, bin.1 + angle);
    }
    let many = bins.into_values().filter(|(n, _)| *n >= 2 * CELLS_MIN * CELLS_MIN);
    many.map(|(n, sum)| DVec2::from_angle(sum / n as f64)).collect()
}

/// Lines along a direction, up to a cell long.
fn sides(lines: &[Straight], u: DVec2) -> Vec<Side> {
    let side = |(index, l): (usize, &Straight)| {
        let length = l.length();
        let is_along = (l.b - l.a).perp_dot(u).abs() <= SQUARE_RAD * length;
        let from = l.a.dot(u).min(l.b.dot(u));
        (is_along && length <= CELL_M[1]).then(|| Side {
            index,
            from,
            offset: u.perp_dot((l.a + l.b) / 2.0),
            length,
        })
    };
    lines.iter().enumerate().filter_map(side).collect()
}

/// Those sides that are equally long and hang together, end to end and side by side, over enough cells.
fn equal_cells(sides: &[Side]) -> Vec<usize> {
    let step = |v: f64| (v / COLLINEAR_M).round() as i64;
    // By place: the lower end of a side, in steps; looked up in the steps around.
    let mut at: BTreeMap<[i64; 2], Vec<usize>> = BTreeMap::new();
    let mut columns: BTreeMap<[i64; 2], Vec<usize>> = BTreeMap::new();
    for (i, s) in sides.iter().enumerate().filter(|(_, s)| s.length >= CELL_M[0]) {
        at.entry([step(s.offset), step(s.from)]).or_default().push(i);
        columns.entry([step(s.from), step(s.length)]).or_default().push(i);
    }
    columns.values_mut().for_each(|c| c.sort_by(|i, j| sides[*i].offset.total_cmp(&sides[*j].offset)));
    let is_equal = |i: usize, j: usize| (sides[i].length - sides[j].length).abs() <= COLLINEAR_M;
    let mut root: Vec<usize> = (0..sides.len()).collect();
    for (key, here) in &at {
        for &i in here {
            let end = step(sides[i].from + sides[i].length);
            let joint = step(ERROR_GAP_M);
            for row in key[0] - 1..=key[0] + 1 {
                let after = at.range([row, end - 1]..=[row, end + joint]).flat_map(|(_, list)| list);
                after.filter(|j| is_equal(i, **j)).for_each(|j| join(&mut root, i, *j));
            }
        }
    }
    for [from, length] in columns.keys() {
        let near = (from - 1..=from + 1).flat_map(|f| (length - 1..=length + 1).map(move |l| [f, l]));
        let mut column: Vec<usize> = near.filter_map(|key| columns.get(&key)).flatten().copied().collect();
        column.sort_by(|i, j| sides[*i].offset.total_cmp(&sides[*j].offset).then(i.cmp(j)));
        for pair in column.windows(2) {
            if sides[pair[1]].offset - sides[pair[0]].offset <= CELL_M[1] {
                join(&mut root, pair[0], pair[1]);
            }
        }
    }
    let mut groups: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for i in 0..sides.len() {
        groups.entry(find_root(&mut root, i)).or_default().push(i);
    }
    let is_grid = |g: &Vec<usize>| {
        let count = |value: fn(&Side) -> f64| {
            let mut places: Vec<i64> =
                g.iter().map(|i| (value(&sides[*i]) / CELL_M[0]).round() as i64).collect();
            places.sort_unstable();
            places.dedup();
            places.len()
        };
        g.len() >= CELLS_MIN * CELLS_MIN && count(|s| s.from) >= CELLS_MIN && count(|s| s.offset) > CELLS_MIN
    };
    groups.into_values().filter(is_grid).flatten().collect()
}

fn find_root(root: &mut [usize], mut i: usize) -> usize {
    while root[i] != i {
        root[i] = root[root[i]];
        i = root[i];
    }
    i
}

fn join(root: &mut [usize], a: usize, b: usize) {
    let (a, b) = (find_root(root, a), find_root(root, b));
    root[a.max(b)] = a.min(b);
}

/// Where the cells of a grid begin and end along one direction, everywhere on the sheet.
struct Lattice {
    start: f64,
    cell: f64,
    pitch: f64,
}

impl Lattice {
    /// From the grid's sides in this direction.
    fn of(sides: &[Side], grid: &[usize]) -> Option<Self> {
        let middle = |mut values: Vec<f64>| {
            values.sort_by(f64::total_cmp);
            values.get(values.len() / 2).copied()
        };
        let cell = middle(grid.iter().map(|i| sides[*i].length).collect())?;
        let mut from: Vec<f64> = grid.iter().map(|i| sides[*i].from).collect();
        from.sort_by(f64::total_cmp);
        let steps = from.windows(2).map(|w| w[1] - w[0]);
        let pitch = middle(
            steps.filter(|d| *d > cell - COLLINEAR_M && *d < cell + ERROR_GAP_M + COLLINEAR_M).collect(),
        )?;
        Some(Self { start: *from.first()?, cell, pitch })
    }

    /// Whether a cell begins or ends at a place.
    fn holds(&self, at: f64) -> bool {
        let rest = (at - self.start).rem_euclid(self.pitch);
        [0.0, self.cell, self.pitch].iter().any(|r| (rest - r).abs() <= COLLINEAR_M)
    }
}

/// Short lines that begin or end where cells do: cells cut at an edge, the same grid in the next room,
/// joints; `with_joints`: wherever they begin and end on one.
fn cut_cells(sides: &[Vec<Side>; 2], lattices: &[Lattice; 2], with_joints: bool) -> Vec<usize> {
    let mut out = Vec::new();
    for k in 0..2 {
        let (along, across) = (&lattices[k], &lattices[1 - k]);
        let sign = if k == 0 { 1.0 } else { -1.0 };
        let is_cell = |s: &&Side| {
            let ends = [s.from, s.from + s.length].map(|v| along.holds(v));
            let is_joint = across.holds(sign * s.offset);
            ends[0] && ends[1] || is_joint && (with_joints || ends[0] || ends[1])
        };
        out.extend(sides[k].iter().filter(is_cell).map(|s| s.index));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(x0: f64, y0: f64, x1: f64, y1: f64) -> Straight {
        Straight { entity: 0, a: DVec2::new(x0, y0), b: DVec2::new(x1, y1) }
    }

    fn cells(nx: u32, ny: u32, size: f64, joint: f64) -> Vec<Straight> {
        let mut out = Vec::new();
        for (i, j) in (0..nx).flat_map(|i| (0..ny).map(move |j| (f64::from(i), f64::from(j)))) {
            let (x, y) = (i * (size + joint), j * (size + joint));
            let (r, t) = (x + size, y + size);
            out.extend([line(x, y, r, y), line(r, y, r, t), line(r, t, x, t), line(x, t, x, y)]);
        }
        out
    }

    #[test]
    fn slabs_are_a_grid_and_walls_on_them_are_none() {
        for (joint, turn) in [(0.0, 0.0), (0.01, 0.0), (0.01, 0.3)] {
            let mut lines = cells(6, 5, 0.99, joint);
            let grid = lines.len();
            lines.extend([line(0.5, 1.2, 4.5, 1.2), line(0.5, 1.36, 4.5, 1.36), line(0.5, 1.2, 0.5, 1.36)]);
            let turned = |p: DVec2| DVec2::from_angle(turn).rotate(p);
            lines.iter_mut().for_each(|l| (l.a, l.b) = (turned(l.a), turned(l.b)));
            assert_eq!(found(&lines, false), (0..grid).collect::<Vec<_>>(), "{joint} {turn}");
        }
    }

    #[test]
    fn what_walls_leave_of_a_joint_is_of_the_grid_where_nobody_calls_it_a_wall() {
        let mut lines = cells(6, 5, 0.99, 0.01);
        let grid = lines.len();
        // Both lines of a joint, cut at both ends, and a pane beside it.
        lines.extend([1.99, 2.0, 2.3].map(|x| line(x, 2.2, x, 2.7)));
        assert_eq!(found(&lines, false), (0..grid).collect::<Vec<_>>());
        assert_eq!(find_joints(&lines), (0..grid + 2).collect::<Vec<_>>());
    }

    #[test]
    fn rooms_and_cabins_are_no_grid() {
        assert!(found(&cells(6, 5, 3.5, 0.15), false).is_empty());
        assert!(found(&cells(12, 1, 0.95, 0.02), false).is_empty());
        assert!(found(&cells(9, 2, 0.95, 0.02), false).is_empty());
    }
}

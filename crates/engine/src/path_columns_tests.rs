//! Paths against a plain walk, cell by cell: one heap in which every cell waits, and lists made by asking everyone.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use proptest::prelude::*;

use super::lanes::Path;
use super::offsets::{direction_of, length_of, turn};
use super::paths::{Paths, Turning};
use super::{Lattice, Obstacles, fixtures, visibility};
use crate::geometry::Segment;

/// Ways of two pieces that differ by less are both kept, cells.
const TIED_CELLS: f32 = 1e-3;

/// A graph by vertex, and what paths go by.
struct Plan<'a> {
    cells: &'a [[i32; 2]],
    sees: Vec<Vec<bool>>,
    may_turn: Vec<bool>,
    spacing_m: f64,
    /// The shortest way of two pieces from each vertex to each that it does not see.
    best: Vec<Vec<f32>>,
}

impl<'a> Plan<'a> {
    fn new(lattice: &'a Lattice, paths: &Paths<'_>) -> Self {
        let n = lattice.cells.len();
        let mut sees = vec![vec![false; n]; n];
        (0..n).for_each(|u| paths.graph.for_each_neighbour(u as u32, |v| sees[u][v as usize] = true));
        let may_turn = paths.slot_of_vertex.iter().map(|&slot| paths.may_turn(slot)).collect();
        let spacing_m = lattice.spacing_um as f64 / 1e6;
        let mut plan =
            Self { cells: &lattice.cells, sees, may_turn, spacing_m, best: vec![vec![f32::INFINITY; n]; n] };
        for a in 0..n {
            for t in (0..n).filter(|&t| plan.sees[a][t] && plan.may_turn[t]) {
                for v in plan.beyond(Some(a), t) {
                    plan.best[a][v] = plan.best[a][v].min(plan.way(a, t, v));
                }
            }
        }
        plan
    }

    fn offset(&self, a: usize, b: usize) -> [i32; 2] {
        [0, 1].map(|k| self.cells[b][k] - self.cells[a][k])
    }

    fn length(&self, a: usize, b: usize) -> f64 {
        length_of(self.offset(a, b))
    }

    fn turn(&self, a: usize, t: usize, v: usize) -> f32 {
        turn(direction_of(self.offset(a, t)), direction_of(self.offset(t, v)))
    }

    fn way(&self, a: usize, t: usize, v: usize) -> f32 {
        self.length(a, t) as f32 + self.length(t, v) as f32
    }

    /// What `t` sees and the cell before it does not.
    fn beyond(&self, a: Option<usize>, t: usize) -> Vec<usize> {
        let is_new = |&v: &usize| self.sees[t][v] && a.is_none_or(|a| a != v && !self.sees[a][v]);
        (0..self.cells.len()).filter(is_new).collect()
    }

    /// What the way from `a` to `t` offers to shortest paths.
    fn leads(&self, a: usize, t: usize) -> Vec<usize> {
        let is_short = |&v: &usize| self.way(a, t, v) < self.best[a][v] + TIED_CELLS;
        if self.may_turn[t] { self.beyond(Some(a), t).into_iter().filter(is_short).collect() } else { vec![] }
    }

    /// Mean turn, length, straight length and number of what is reached by shortest paths, in that order.
    fn shortest(&self, root: usize, radius_m: Option<f64>) -> [f64; 4] {
        let n = self.cells.len();
        let limit = radius_m.map_or(f64::INFINITY, |r| r / self.spacing_m);
        let (mut cost, mut before) = (vec![f32::INFINITY; n], vec![root; n]);
        let (mut list, mut angle) = (vec![vec![]; n], vec![0f32; n]);
        let (mut heap, mut sums, mut count) = (BinaryHeap::new(), [0f32; 3], 0.0);
        let mut left = vec![false; n];
        cost[root] = 0.0;
        list[root] = self.beyond(None, root);
        heap.push(Reverse((0u32, root)));
        while let Some(Reverse((bits, at))) = heap.pop() {
            if left[at] || f32::from_bits(bits) != cost[at] {
                continue;
            }
            if f64::from(cost[at]) > limit {
                break;
            }
            left[at] = true;
            let a = before[at];
            if a != root {
                angle[at] = angle[a] + self.turn(before[a], a, at);
            }
            sums[0] += angle[at];
            sums[1] += (f64::from(cost[at]) * self.spacing_m) as f32;
            sums[2] += (self.length(root, at) * self.spacing_m) as f32;
            count += 1.0;
            for v in list[at].clone() {
                if f64::from(cost[at]) + self.length(at, v) >= f64::from(cost[v]) {
                    continue;
                }
                let new = cost[at] + self.length(at, v) as f32;
                let leads = self.leads(at, v);
                if new != cost[v] || !leads.is_empty() {
                    list[v] = leads;
                }
                (cost[v], before[v]) = (new, at);
                heap.push(Reverse((new.to_bits(), v)));
            }
        }
        let [angle, length, straight] = sums.map(|sum| f64::from(sum) / count);
        [angle, length, straight, count]
    }

    /// Mean turn, number and total of what is reached by straightest paths.
    fn straightest(&self, root: usize, radius: Option<f64>) -> [f64; 3] {
        let n = self.cells.len();
        let (mut cost, mut before, mut left) = (vec![f32::INFINITY; n], vec![None; n], vec![false; n]);
        let (mut heap, mut costs) = (BinaryHeap::new(), vec![]);
        cost[root] = 0.0;
        heap.push(Reverse((0u32, root)));
        while let Some(Reverse((bits, at))) = heap.pop() {
            if left[at] || f32::from_bits(bits) != cost[at] {
                continue;
            }
            if f64::from(cost[at]) > radius.unwrap_or(f64::INFINITY) {
                break;
            }
            left[at] = true;
            costs.push(cost[at]);
            if cost[at] != 0.0 && !self.may_turn[at] {
                continue;
            }
            for v in self.beyond(before[at], at) {
                let new = cost[at] + before[at].map_or(0.0, |a| self.turn(a, at, v));
                if new < cost[v] {
                    (cost[v], before[v]) = (new, Some(at));
                    heap.push(Reverse((new.to_bits(), v)));
                }
            }
        }
        let total = f64::from(costs.iter().sum::<f32>());
        let count = costs.len() as f64;
        [total / count, count, total]
    }
}

/// Plans with walls on and beside the cells, at several spacings.
fn plans() -> impl Strategy<Value = (Lattice, Obstacles)> {
    let wall = ((0i64..30, 0i64..30), (-8i64..9, -8i64..9), 0..3u8);
    let walls = prop::collection::vec(wall, 0..40);
    (walls, 1i64..100_000, 4i32..17, 4i32..15, any::<u64>()).prop_map(|(walls, scale, w, h, holes)| {
        let spacing = 12 * scale;
        let segment = |((x, y), (dx, dy), kind): ((i64, i64), (i64, i64), u8)| {
            let a = [x * 6 * scale, y * 6 * scale];
            let by = [if kind == 0 { 0 } else { dx * 8 * scale }, if kind == 1 { 0 } else { dy * 8 * scale }];
            Segment { a, b: [a[0] + by[0], a[1] + by[1]] }
        };
        let keep = |c: i32, r: i32| holes.rotate_left((c * 7 + r * 13) as u32 & 63) & 7 != 0;
        let cells = (0..w).flat_map(|c| (0..h).map(move |r| [c, r])).filter(|c| keep(c[0], c[1])).collect();
        let obstacles = Obstacles { segments: walls.into_iter().map(segment).collect(), blind: vec![] };
        (fixtures::lattice(spacing, [0, 0], cells), obstacles)
    })
}

/// Every root, radius and instruction set.
fn check((lattice, obstacles): (Lattice, Obstacles), turning: Turning) -> Result<(), TestCaseError> {
    let graph = visibility::visibility_graph(&lattice, &obstacles);
    let mut paths = Paths::new(&lattice, &graph, &obstacles, turning);
    let plan = Plan::new(&lattice, &paths);
    for (cells, turns) in [(None, None), (Some(6.5), Some(0.8))] {
        let radius_m = cells.map(|cells: f64| cells * plan.spacing_m);
        let shortest: Vec<_> = (0..graph.len()).map(|root| plan.shortest(root, radius_m)).collect();
        let straightest: Vec<_> = (0..graph.len()).map(|root| plan.straightest(root, turns)).collect();
        for path in Path::available() {
            paths.path = path;
            for (k, column) in paths.metric_columns(radius_m).into_iter().enumerate() {
                let expected: Vec<f64> = shortest.iter().map(|row| row[k]).collect();
                prop_assert_eq!(column.values, expected, "{}", column.name);
            }
            for (k, column) in paths.angular_columns(turns).into_iter().enumerate() {
                let expected: Vec<f64> = straightest.iter().map(|row| row[k]).collect();
                prop_assert_eq!(column.values, expected, "{}", column.name);
            }
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, ..ProptestConfig::default() })]

    #[test]
    fn paths_equal_a_plain_walk(plan in plans()) {
        check(plan, Turning::AtWalls)?;
    }

    #[test]
    fn paths_that_turn_everywhere_equal_a_plain_walk(plan in plans()) {
        check(plan, Turning::Everywhere)?;
    }

    /// Ways round rooms have many pieces, and many are as long as another.
    #[test]
    fn paths_through_mazes_equal_a_plain_walk(plan in fixtures::mazes(14)) {
        check(plan, Turning::AtWalls)?;
    }
}

//! Shortest and straightest paths through the visibility graph, and step depth from chosen cells.
//!
//! Definitions, names and the order of relaxation are depthmapX's, single-precision sums included, so
//! that values can be compared cell by cell. Angles count 1 for a right angle.

use enfilade_brief::column::{
    ANGULAR_NODE_COUNT, ANGULAR_STEP_DEPTH, METRIC_NODE_COUNT, METRIC_STEP_LENGTH, METRIC_STEP_TURN,
    VISUAL_STEP_DEPTH,
};
use enfilade_brief::{Measure, column_of};
use rayon::prelude::*;

use super::bundle::{Bundle, ROOTS};
use super::corners::{Corners, STRAIGHTEST_MAX};
use super::measures::{Column, UNDEFINED, transpose};
use super::offsets::turn;
use super::order::Order;
use super::paths::Paths;
use super::queue::{Key, cost_of};
use super::shortest::Shortest;
use super::straightest::Straightest;

impl Paths<'_> {
    /// `Metric Mean Shortest-Path Turn`, `… Distance`, `Metric Mean Straight-Line Distance` (metres),
    /// `Metric Node Count`; means include the vertex itself. Paths longer than `radius_m` do not count.
    pub fn metric_columns(&self, radius_m: Option<f64>) -> Vec<Column> {
        metric_columns_from(&self.metric_rows(&self.all(), radius_m), radius_m)
    }

    /// The values of [`metric_columns`](Self::metric_columns) for some vertices.
    pub fn metric_rows(&self, vertices: &[u32], radius_m: Option<f64>) -> Vec<[f64; 4]> {
        let limit = self.radius(radius_m);
        let Some(corners) = Corners::shortest(self) else { return self.metric_rows_apart(vertices, limit) };
        let walk = || (Bundle::new(self, &corners), Order::default(), Turns::new(self));
        let row = |(walk, order, turns): &mut (Bundle, Order, Turns), some: &[u32]| {
            let roots: Vec<u32> = some.iter().map(|v| self.slot_of_vertex[*v as usize]).collect();
            walk.walk(self, &corners, &roots, limit);
            let of = |(lane, root): (usize, &u32)| {
                let (ways, most) = (walk.ways(lane), (walk.highest(lane), limit));
                let reached = order.by_cost(self, walk.reached(), |slot| ways[slot as usize].cost, most);
                turns.row(self, reached, *root, |slot| ways[slot as usize].before)
            };
            roots.iter().enumerate().map(of).collect::<Vec<_>>()
        };
        self.rows(vertices, ROOTS, walk, row)
    }

    /// `Angular Mean Depth`, `Angular Node Count`, `Angular Total Depth`. Paths of more than `radius`
    /// right angles do not count.
    pub fn angular_columns(&self, radius: Option<f64>) -> Vec<Column> {
        angular_columns_from(&self.angular_rows(&self.all(), radius), radius)
    }

    /// The values of [`angular_columns`](Self::angular_columns) for some vertices.
    pub fn angular_rows(&self, vertices: &[u32], radius: Option<f64>) -> Vec<[f64; 3]> {
        let limit = radius.unwrap_or(f64::INFINITY);
        let corners = Corners::straightest(self, STRAIGHTEST_MAX);
        let row = |walk: &mut Straightest, some: &[u32]| {
            let of = |v: &u32| {
                walk.walk(self, corners.as_ref(), &[self.slot_of_vertex[*v as usize]], limit);
                let total = f64::from(walk.reached.iter().sum::<f32>());
                let n = walk.reached.len() as f64;
                [total / n, n, total]
            };
            some.iter().map(of).collect()
        };
        self.rows(vertices, 1, || Straightest::new(self), row)
    }

    /// Visual, metric (metres) and angular depth of every vertex from the nearest of some vertices;
    /// [`UNDEFINED`] where there is no way.
    pub fn step_columns(&self, from: &[u32]) -> Vec<Column> {
        let column = |name: &str, of_slot: &dyn Fn(u32) -> Option<f64>| {
            let values = self.slot_of_vertex.iter().map(|&slot| of_slot(slot).unwrap_or(UNDEFINED)).collect();
            Column { name: name.to_string(), values }
        };
        let steps = self.graph.steps_from(from);
        let seen = |slot: u32| {
            let steps = steps[self.vertex_of_slot[slot as usize] as usize];
            (steps != u32::MAX).then(|| f64::from(steps))
        };
        let cost_in = |costs: &[f32], slot: u32| Some(costs[slot as usize]).filter(|c| c.is_finite());
        let mut columns = vec![column(VISUAL_STEP_DEPTH, &seen)];
        let roots: Vec<u32> = from.iter().map(|&v| self.slot_of_vertex[v as usize]).collect();
        let mut walk = Shortest::new(self);
        walk.walk(self, &roots, f64::INFINITY);
        let turned = |slot| cost_in(&walk.cost, slot).map(|_| f64::from(walk.turned(self, slot)));
        columns.push(column(METRIC_STEP_TURN, &turned));
        let length = |slot| cost_in(&walk.cost, slot).map(|cost| f64::from(cost) * self.spacing_m());
        columns.push(column(METRIC_STEP_LENGTH, &length));
        let mut walk = Straightest::new(self);
        walk.walk(self, None, &roots, f64::INFINITY);
        columns.push(column(ANGULAR_STEP_DEPTH, &|slot| cost_in(&walk.cost, slot).map(f64::from)));
        columns
    }

    /// As [`metric_rows`](Self::metric_rows), root by root.
    fn metric_rows_apart(&self, vertices: &[u32], limit: f64) -> Vec<[f64; 4]> {
        let walk = || (Shortest::new(self), Order::default(), Turns::new(self));
        let row = |(walk, order, turns): &mut (Shortest, Order, Turns), some: &[u32]| {
            let of = |v: &u32| {
                let root = self.slot_of_vertex[*v as usize];
                walk.walk(self, &[root], limit);
                let highest = walk.reached().iter().map(|slot| walk.cost[*slot as usize]).fold(0.0, f32::max);
                let reached =
                    order.by_cost(self, walk.reached(), |slot| walk.cost[slot as usize], (highest, limit));
                turns.row(self, reached, root, |slot| walk.before(slot))
            };
            some.iter().map(of).collect()
        };
        self.rows(vertices, 1, walk, row)
    }

    /// What is walked from some vertices, so many at once, in their order.
    fn rows<W, const K: usize>(
        &self,
        vertices: &[u32],
        at_once: usize,
        walk: impl Fn() -> W + Sync + Send,
        rows: impl Fn(&mut W, &[u32]) -> Vec<[f64; K]> + Sync + Send,
    ) -> Vec<[f64; K]> {
        // Neighbours in a quarter of a tile follow one another: their walks go through the same lists, which stay in the
        // cache.
        let place = |i: &usize| {
            let slot = self.slot_of_vertex[vertices[*i] as usize];
            (slot >> 6, slot >> 5 & 1, slot >> 2 & 1, slot)
        };
        let mut order: Vec<usize> = (0..vertices.len()).collect();
        order.sort_unstable_by_key(place);
        let sorted: Vec<u32> = order.iter().map(|&i| vertices[i]).collect();
        let of = |walk: &mut W, some: &[u32]| rows(walk, some);
        let found: Vec<Vec<[f64; K]>> = sorted.par_chunks(at_once).map_init(walk, of).collect();
        let mut out = vec![[0.0; K]; vertices.len()];
        order.into_iter().zip(found.into_iter().flatten()).for_each(|(i, row)| out[i] = row);
        out
    }

    fn all(&self) -> Vec<u32> {
        (0..self.graph.len() as u32).collect()
    }

    fn radius(&self, radius_m: Option<f64>) -> f64 {
        radius_m.map_or(f64::INFINITY, |r| r / self.spacing_m())
    }
}

/// What ways turned when they reached a cell, by slot: the angle so far, and the direction of the last piece.
struct Turns {
    angle: Vec<f32>,
    heading: Vec<f64>,
}

impl Turns {
    fn new(paths: &Paths<'_>) -> Self {
        let slots = paths.vertex_of_slot.len();
        Self { angle: vec![0.0; slots], heading: vec![0.0; slots] }
    }

    /// Mean turn, length, straight length and number of what one root reaches, in the order of its cost.
    #[inline(always)]
    fn row(
        &mut self,
        paths: &Paths<'_>,
        reached: &[Key],
        root: u32,
        before: impl Fn(u32) -> u32,
    ) -> [f64; 4] {
        let spacing_m = paths.spacing_m();
        let in_metres = |cells: f64| (cells * spacing_m) as f32;
        let mut sums = [0f32; 3];
        // Ways turn for nothing at their root.
        (self.angle[root as usize], self.heading[root as usize]) = (f32::NEG_INFINITY, 0.0);
        for &key in reached.iter().skip(1) {
            let slot = paths.slot_of_vertex[key as u32 as usize];
            let before = before(slot);
            let heading = paths.direction(before, slot);
            let angle = self.angle[before as usize] + turn(self.heading[before as usize], heading);
            let angle = if angle > 0.0 { angle } else { 0.0 };
            (self.angle[slot as usize], self.heading[slot as usize]) = (angle, heading);
            sums[0] += angle;
            sums[1] += in_metres(f64::from(cost_of(key)));
            sums[2] += in_metres(paths.length(root, slot));
        }
        let n = reached.len() as f64;
        let [angle, length, straight] = sums.map(|sum| f64::from(sum) / n);
        [angle, length, straight, n]
    }
}

/// [`Paths::metric_columns`] from the rows of all vertices.
pub fn metric_columns_from(rows: &[[f64; 4]], radius_m: Option<f64>) -> Vec<Column> {
    let names = [
        column_of(Measure::MetricAngle),
        column_of(Measure::MetricDistance),
        column_of(Measure::MetricStraight),
        METRIC_NODE_COUNT,
    ];
    named_rows(names, rows, radius_m)
}

/// [`Paths::angular_columns`] from the rows of all vertices.
pub fn angular_columns_from(rows: &[[f64; 3]], radius: Option<f64>) -> Vec<Column> {
    let names = [column_of(Measure::AngularDepth), ANGULAR_NODE_COUNT, column_of(Measure::AngularTotal)];
    named_rows(names, rows, radius)
}

fn named_rows<const K: usize>(names: [&str; K], rows: &[[f64; K]], radius: Option<f64>) -> Vec<Column> {
    let suffix = radius.map(|r| format!(" R{r}")).unwrap_or_default();
    transpose(names.map(|name| format!("{name}{suffix}")), rows)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::lanes::Path;
    use super::super::paths::Turning;
    use super::super::{Lattice, Obstacles};
    use super::super::{fixtures, visibility};
    use super::*;
    use crate::geometry::Segment;

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
            let theirs = column.name.replace("Shortest-Path Turn", "Shortest-Path Angle");
            let k = header.iter().position(|h| *h == theirs).unwrap();
            let limit = if theirs != column.name { 3e-2 } else { 1e-6 };
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
        assert_eq!(value(VISUAL_STEP_DEPTH, 4), 2.0);
        assert!((value(METRIC_STEP_LENGTH, 4) - 2.0 * 2f64.sqrt()).abs() < 1e-6);
        assert!((value(METRIC_STEP_TURN, 4) - 1.0).abs() < 1e-6);
        assert!((value(ANGULAR_STEP_DEPTH, 4) - 1.0).abs() < 1e-6);
        assert_eq!(value(VISUAL_STEP_DEPTH, 2), UNDEFINED);
        let near = paths.metric_columns(Some(1.2));
        assert_eq!(near.iter().find(|c| c.name == "Metric Node Count R1.2").unwrap().values[0], 2.0);
    }

    /// Plans with walls on and beside the cells, in a box that is not a multiple of a tile.
    fn plans() -> impl Strategy<Value = (Lattice, Obstacles)> {
        let wall = ((0i64..40, 0i64..40), (-8i64..9, -8i64..9), 0..3u8);
        prop::collection::vec(wall, 0..40).prop_map(|walls| {
            let segment = |((x, y), (dx, dy), kind): ((i64, i64), (i64, i64), u8)| {
                let a = [x * 6, y * 6];
                let by = [if kind == 0 { 0 } else { dx * 8 }, if kind == 1 { 0 } else { dy * 8 }];
                Segment { a, b: [a[0] + by[0], a[1] + by[1]] }
            };
            let cells = (0..21).flat_map(|c| (0..19).map(move |r| [c, r])).collect();
            let segments = walls.into_iter().map(segment).collect();
            (fixtures::lattice(12, [0, 0], cells), Obstacles { segments, blind: vec![] })
        })
    }

    /// Costs from a root by going through all cells in the order of their cost, every neighbour asked.
    fn by_dijkstra(paths: &Paths<'_>, lattice: &Lattice, root: u32, is_metric: bool) -> Vec<f64> {
        let n = lattice.cells.len();
        let (mut cost, mut before, mut left) = (vec![f32::INFINITY; n], vec![u32::MAX; n], vec![false; n]);
        cost[root as usize] = 0.0;
        let offset = |a: u32, b: u32| {
            let (a, b) = (lattice.cells[a as usize], lattice.cells[b as usize]);
            [f64::from(b[0] - a[0]), f64::from(b[1] - a[1])]
        };
        let direction = |a, b| offset(a, b)[1].atan2(offset(a, b)[0]) / std::f64::consts::FRAC_PI_2;
        while let Some(at) = (0..n)
            .filter(|&v| !left[v] && cost[v].is_finite())
            .min_by(|&a, &b| cost[a].total_cmp(&cost[b]).then(a.cmp(&b)))
        {
            left[at] = true;
            let slot = paths.slot_of_vertex[at];
            let may_turn = paths.turns[slot as usize >> 6] >> (slot & 63) & 1 == 1;
            if cost[at] != 0.0 && !may_turn {
                continue;
            }
            paths.graph.for_each_neighbour(at as u32, |to| {
                let [x, y] = offset(at as u32, to);
                let by = if is_metric {
                    (x * x + y * y).sqrt()
                } else if before[at] == u32::MAX {
                    0.0
                } else {
                    let apart: f64 = (direction(at as u32, to) - direction(before[at], at as u32)).abs();
                    apart.min(4.0 - apart)
                };
                let new = cost[at] + by as f32;
                let is_better = if is_metric {
                    f64::from(cost[at]) + by < f64::from(cost[to as usize])
                } else {
                    new < cost[to as usize]
                };
                if !left[to as usize] && is_better {
                    (cost[to as usize], before[to as usize]) = (new, at as u32);
                }
            });
        }
        cost.into_iter().map(f64::from).collect()
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]

        /// Lists of corners against none, every instruction set against every other, and all against a
        /// plain search.
        #[test]
        fn every_way_of_walking_is_one((lattice, obstacles) in plans(), everywhere in any::<bool>()) {
            let turning = if everywhere { Turning::Everywhere } else { Turning::AtWalls };
            let graph = visibility::visibility_graph(&lattice, &obstacles);
            let mut paths = Paths::new(&lattice, &graph, &obstacles, turning);
            let corners = Corners::shortest(&paths).unwrap();
            let (mut walk, mut bundle) = (Shortest::new(&paths), Bundle::new(&paths, &corners));
            let slots: Vec<u32> = (0..graph.len()).step_by(37).map(|v| paths.slot_of_vertex[v]).collect();
            let near = |a: f64, b: f64| a == b || (a - b).abs() < 1e-4;
            for roots in slots.chunks(ROOTS) {
                bundle.walk(&paths, &corners, roots, f64::INFINITY);
                for (lane, root) in roots.iter().enumerate() {
                    walk.walk(&paths, &[*root], f64::INFINITY);
                    let vertex = paths.vertex_of_slot[*root as usize];
                    let expected = by_dijkstra(&paths, &lattice, vertex, true);
                    let mut costs = vec![f32::INFINITY; graph.len()];
                    for &slot in bundle.reached() {
                        let cost = bundle.ways(lane)[slot as usize].cost;
                        costs[paths.vertex_of_slot[slot as usize] as usize] = cost;
                    }
                    for (v, &expected) in expected.iter().enumerate() {
                        let plain = walk.cost[paths.slot_of_vertex[v] as usize];
                        prop_assert!(near(f64::from(plain), expected));
                        prop_assert_eq!(costs[v].to_bits(), plain.to_bits(), "lanes and one root");
                    }
                }
            }
            let best: Vec<Column> = paths.angular_columns(None);
            for path in Path::available() {
                paths.path = path;
                prop_assert_eq!(&paths.angular_columns(None), &best);
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 12, ..ProptestConfig::default() })]

        /// Graphs too large for lists of straightest paths have the same angles, every instruction set.
        #[test]
        fn straightest_paths_need_no_lists((lattice, obstacles) in plans(), everywhere in any::<bool>()) {
            let turning = if everywhere { Turning::Everywhere } else { Turning::AtWalls };
            let graph = visibility::visibility_graph(&lattice, &obstacles);
            let mut paths = Paths::new(&lattice, &graph, &obstacles, turning);
            let corners = Corners::straightest(&paths, usize::MAX);
            let cells = corners.as_ref().map_or(0, Corners::len);
            prop_assert!(cells == 0 || Corners::straightest(&paths, cells - 1).is_none());
            prop_assert!(cells == 0 || cells > STRAIGHTEST_MAX || Corners::straightest(&paths, cells).is_some());
            let mut walk = Straightest::new(&paths);
            for root in (0..lattice.cells.len() as u32).step_by(37) {
                let slot = [paths.slot_of_vertex[root as usize]];
                for path in Path::available() {
                    paths.path = path;
                    walk.walk(&paths, None, &slot, f64::INFINITY);
                    let plain = walk.reached.clone();
                    walk.walk(&paths, corners.as_ref(), &slot, f64::INFINITY);
                    prop_assert_eq!(&walk.reached, &plain);
                }
            }
        }
    }
}

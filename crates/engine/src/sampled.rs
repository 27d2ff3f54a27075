//! Measures of the breadth-first trees estimated from some of them.
//!
//! Cells that no view joins are areas of their own, so every area has roots of its own: as many as its share of the
//! cells, and at least [`AREA_ROOTS`]. Within an area every cell is as likely a root as any other.

use std::collections::BTreeMap;

use enfilade_brief::column::MEAN_DEPTH_INTERVAL;
use enfilade_brief::{Measure, column_of};
use rayon::prelude::*;

use super::forest::level_counts_by_rank;
use super::graph::Graph;
use super::measures::{
    Column, GLOBAL_NAMES, Means, UNDEFINED, entropy_bits, integration, means, relativised_entropy,
};
use super::tiles::Tiles;
use super::{Lattice, Tally};

/// Fewest roots of an area with as many cells: of two, a root itself would know only one other.
pub const AREA_ROOTS: usize = 3;

/// Columns estimated from some roots.
#[derive(Clone, Debug, PartialEq)]
pub struct Sampled {
    /// The columns.
    pub columns: Vec<Column>,
    /// How many roots they come from.
    pub roots: usize,
}

/// Whether a column of [`sampled_columns`] is an estimate: node counts are exact.
pub fn is_estimated(column: &str) -> bool {
    column == MEAN_DEPTH_INTERVAL || (column != column_of(Measure::Reach) && GLOBAL_NAMES.contains(&column))
}

/// Roots among some vertices, ascending, area by area; `component` is the area of every vertex.
fn draw(component: &[u32], among: &[u32], roots: usize, seed: u64) -> Vec<Vec<u32>> {
    let mut areas: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    among.iter().for_each(|&v| areas.entry(component[v as usize]).or_default().push(v));
    let share = |cells: usize| (roots as u128 * cells as u128 / among.len().max(1) as u128) as usize;
    let drawn = areas.into_values().map(|mut area| {
        area.sort_unstable_by_key(|&v| (mix(seed ^ mix(u64::from(v))), v));
        area.truncate(share(area.len()).max(AREA_ROOTS));
        area.sort_unstable();
        area
    });
    drawn.collect()
}

/// [`global_columns`](super::measures::global_columns) estimated from about `roots` vertices drawn without
/// replacement, for graphs too large to walk from everywhere, and half the width of the 95 % confidence interval of
/// the mean depth. Node counts are exact. The same seed draws the same roots.
pub fn sampled_columns(graph: &Graph, roots: usize, seed: u64) -> Sampled {
    let all: Vec<u32> = (0..graph.len() as u32).collect();
    let component = graph.components();
    let mut drawn = draw(&component, &all, roots, seed);
    // A cell that sees no other is known without a tree.
    drawn.retain(|area| area.len() > 1);
    let drawn = drawn.concat();
    let by_rank = level_counts_by_rank(graph, &drawn);
    let mut size = vec![0u32; graph.len()];
    component.iter().for_each(|&c| size[c as usize] += 1);
    let row = |v: usize| {
        let rank = graph.tiles.rank_of[v] as usize;
        let mut levels: Vec<u32> = by_rank.iter().map(|level| level[rank]).collect();
        while levels.last() == Some(&0) {
            levels.pop();
        }
        sampled_row(&levels, size[component[v] as usize])
    };
    let rows: Vec<[f64; 8]> = (0..graph.len()).into_par_iter().map(row).collect();
    let names = GLOBAL_NAMES.into_iter().chain([MEAN_DEPTH_INTERVAL]).map(String::from);
    let column = |(k, name)| Column { name, values: rows.iter().map(|row: &[f64; 8]| row[k]).collect() };
    Sampled { columns: names.enumerate().map(column).collect(), roots: drawn.len() }
}

/// One vertex from the levels of a sample of its component's `size` vertices.
fn sampled_row(levels: &[u32], size: u32) -> [f64; 8] {
    let sum = |power: i32| {
        levels.iter().zip(1..).map(|(&n, l)| f64::from(n) * f64::from(l).powi(power)).sum::<f64>()
    };
    let (sample, others) = (sum(0), f64::from(size) - 1.0);
    if sample == 0.0 {
        let undefined = UNDEFINED;
        return [undefined, undefined, undefined, undefined, undefined, others + 1.0, undefined, undefined];
    }
    let depth = sum(1) / sample;
    let variance = variance_of_mean(sample, others, sum(2) / sample - depth * depth);
    let half_width = variance.map_or(UNDEFINED, |v| student(sample - 1.0) * v.sqrt());
    let [hh, p, tekl] = integration(others + 1.0, depth * others);
    let relativised = relativised_entropy(levels, depth);
    [entropy_bits(levels), hh, p, tekl, depth, others + 1.0, relativised, half_width]
}

/// Variance of the mean of `n` of `all` values which vary by `spread` (mean square); none for one of several. Values
/// that are all alike do not show that all others are: then as if one more were 1 away.
fn variance_of_mean(n: f64, all: f64, spread: f64) -> Option<f64> {
    if n >= all {
        return Some(0.0);
    }
    if n < 2.0 {
        return None;
    }
    let alike = 1.0 / (n + 1.0);
    let one = if spread > 1e-12 { spread * n / (n - 1.0) } else { alike };
    Some(one / n * (1.0 - n / all))
}

/// Student's factor of a 95 % interval, by degrees of freedom.
pub fn student(freedom: f64) -> f64 {
    const FEW: [f64; 10] = [12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228];
    let whole = freedom.max(1.0).floor();
    match FEW.get(whole as usize - 1) {
        Some(&factor) => factor,
        // Cornish and Fisher's series.
        None => 1.959_964 + 2.372_3 / whole + 2.822_5 / (whole * whole),
    }
}

/// splitmix64: a number that looks drawn, the same on every machine.
fn mix(seed: u64) -> u64 {
    let mut z = seed.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

/// Query vertices whose trees were walked, for means over all of them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sample {
    /// Their positions within the region of query, ascending.
    pub places: Vec<u32>,
    /// Cells of every area, and its positions in `places`.
    areas: Vec<(usize, Vec<usize>)>,
}

impl Sample {
    /// So many of the query vertices, each as likely as any other, spread evenly over the floor: means over them are means
    /// over all, and what one of them has its neighbours have much alike.
    pub fn even(lattice: &Lattice, roots: usize, seed: u64) -> Self {
        let mut place = vec![u32::MAX; lattice.cells.len()];
        lattice.query.iter().zip(0..).for_each(|(v, i)| place[*v as usize] = i);
        // Tiles lie along a curve that leaves none of a neighbourhood out.
        let along = Tiles::new(lattice).vertex_of.into_iter().map(|v| place[v as usize]);
        let along: Vec<u32> = along.filter(|i| *i != u32::MAX).collect();
        let roots = roots.min(along.len());
        let step = along.len() as f64 / roots.max(1) as f64;
        let first = mix(seed) as f64 / u64::MAX as f64 * step;
        let at = |k: usize| along[((first + k as f64 * step) as usize).min(along.len() - 1)];
        let mut places: Vec<u32> = (0..roots).map(at).collect();
        places.sort_unstable();
        places.dedup();
        let areas = vec![(along.len(), (0..places.len()).collect())];
        Self { places, areas }
    }

    /// About `roots` of the query vertices that are not `blind`, in every area as many as its share and a few at least.
    pub fn draw(lattice: &Lattice, component: &[u32], blind: &[u32], roots: usize, seed: u64) -> Self {
        let mut is_blind = vec![false; component.len()];
        blind.iter().for_each(|&v| is_blind[v as usize] = true);
        let among: Vec<u32> = lattice.query.iter().copied().filter(|&v| !is_blind[v as usize]).collect();
        let drawn = draw(component, &among, roots, seed);
        let mut cells: BTreeMap<u32, usize> = BTreeMap::new();
        among.iter().for_each(|&v| *cells.entry(component[v as usize]).or_default() += 1);
        let mut roots: Vec<u32> = drawn.concat();
        roots.sort_unstable();
        let place = |v: &u32| roots.binary_search(v).unwrap_or_default();
        let areas = cells.into_values().zip(&drawn);
        let areas = areas.map(|(cells, area)| (cells, area.iter().map(place).collect())).collect();
        let in_query = |v: &u32| lattice.query.binary_search(v).unwrap_or_default() as u32;
        Self { places: roots.iter().map(in_query).collect(), areas }
    }

    /// The mean over all query vertices that are not covered and half the width of its 95 % interval, from the values of the
    /// roots; NaN of those that are. An area is covered by as large a share as its roots are.
    fn estimate(&self, values: &[f64]) -> [f64; 2] {
        let free = |(cells, own): &(usize, Vec<usize>)| {
            let known: Vec<f64> = own.iter().map(|&i| values[i]).filter(|v| !v.is_nan()).collect();
            let cells = *cells as f64 * known.len() as f64 / own.len().max(1) as f64;
            (!known.is_empty()).then_some((cells, known))
        };
        let areas: Vec<(f64, Vec<f64>)> = self.areas.iter().filter_map(free).collect();
        let all = areas.iter().map(|a| a.0).sum::<f64>().max(1.0);
        let (mut mean, mut variance, mut freedom) = (0.0, 0.0, 0.0);
        for (cells, known) in &areas {
            let (n, share) = (known.len() as f64, cells / all);
            let own_mean = known.iter().sum::<f64>() / n;
            let spread = known.iter().map(|v| (v - own_mean).powi(2)).sum::<f64>() / n;
            mean += share * own_mean;
            variance += share * share * variance_of_mean(n, *cells, spread).unwrap_or(0.0);
            freedom += n - 1.0;
        }
        [mean, student(freedom) * variance.sqrt()]
    }

    /// [`means`] of a tally that has trees of the roots alone, and half the widths of the 95 % intervals of depth and
    /// entropy: degrees are exact. `covered` are positions within the region of query, ascending, that do not count.
    pub fn means(&self, tally: &Tally, covered: &[u32]) -> (Means, [f64; 2]) {
        let mut rows = Vec::with_capacity(tally.depth.len());
        let mut at = 0;
        for &depth in &tally.depth {
            rows.push((f64::from(depth), entropy_bits(&tally.levels[at..at + depth as usize])));
            at += depth as usize;
        }
        let of = |f: fn(&(f64, f64)) -> f64| {
            let value = |i: &u32| match covered.binary_search(i) {
                Ok(_) => f64::NAN,
                Err(_) => f(&rows[*i as usize]),
            };
            self.estimate(&self.places.iter().map(value).collect::<Vec<f64>>())
        };
        let ([depth, depth_off], [entropy, entropy_off]) = (of(|r| r.0), of(|r| r.1));
        (Means { depth, entropy, ..means(tally, covered.len()) }, [depth_off, entropy_off])
    }
}

#[cfg(test)]
mod tests {
    use super::super::measures::global_columns;
    use super::super::{Obstacles, fixtures, forest, visibility};
    use super::*;
    use crate::geometry::Segment;

    /// A sample of everything is the whole; a smaller one is near it, as often as its interval says.
    #[test]
    fn sampled_roots_estimate_the_whole() {
        let Some((lattice, obstacles, ..)) = fixtures::n900() else { return };
        let graph = visibility::visibility_graph(&lattice, &obstacles);
        let exact = global_columns(&lattice, &graph, None);
        let whole = sampled_columns(&graph, 900, 1).columns;
        for (a, b) in exact.iter().zip(&whole) {
            assert_eq!(a.name, b.name);
            for (x, y) in a.values.iter().zip(&b.values) {
                assert!((x - y).abs() <= 1e-12 * x.abs(), "{}: {x} {y}", a.name);
            }
        }
        assert!(whole[7].values.iter().all(|w| *w == 0.0));
        let sampled = sampled_columns(&graph, 150, 1);
        assert_eq!(sampled, sampled_columns(&graph, 150, 1));
        let Sampled { columns: part, roots } = sampled;
        assert_eq!(roots, 150);
        let depth = |c: &[Column]| c.iter().find(|c| c.name == "Visual Mean Depth").unwrap().values.clone();
        let (true_depth, guess) = (depth(&exact), depth(&part));
        let within = (0..900).filter(|&v| (true_depth[v] - guess[v]).abs() <= part[7].values[v]).count();
        assert!(within >= 700, "{within} of 900");
    }

    /// A building of 24 × 24 cells in a row of rooms, and a smaller one of 12 × 10 beside it that no view reaches.
    fn two_buildings() -> (Lattice, Graph) {
        let of = |x: i32, w: i32, h: i32| (0..w).flat_map(move |c| (0..h).map(move |r| [x + c, r]));
        let mut walls = vec![[275, -50, 275, 300]];
        for k in 1..6 {
            // A way through now at one end, now at the other.
            let off = if k % 2 == 0 { 60 } else { 0 };
            walls.push([k * 40 - 5, -50 + off, k * 40 - 5, 180 + off]);
        }
        for k in 1..4 {
            let off = if k % 2 == 0 { 70 } else { 0 };
            walls.push([295 + k * 30, -50 + off, 295 + k * 30, 75 + off]);
        }
        let segments = walls.into_iter().map(|[a, b, c, d]| Segment { a: [a, b], b: [c, d] }).collect();
        let lattice = fixtures::lattice(10, [0, 0], of(0, 24, 24).chain(of(30, 12, 10)).collect());
        let graph = visibility::visibility_graph(&lattice, &Obstacles { segments, blind: vec![] });
        (lattice, graph)
    }

    /// In every area, with few roots as with many, the interval holds the mean depth about as often as it says.
    #[test]
    fn intervals_hold_in_every_area() {
        let (lattice, graph) = two_buildings();
        let exact = &global_columns(&lattice, &graph, None)[4].values;
        let component = graph.components();
        for roots in [2, 6, 20, 60] {
            let mut held = BTreeMap::<u32, [usize; 2]>::new();
            for seed in 0..40 {
                let sampled = sampled_columns(&graph, roots, seed);
                let [depth, off] = [4, 7].map(|k| &sampled.columns[k].values);
                for v in 0..graph.len() {
                    let count = held.entry(component[v]).or_default();
                    assert!(off[v] >= 0.0 && depth[v] >= 1.0, "{v}: {} ± {}", depth[v], off[v]);
                    count[0] += usize::from((depth[v] - exact[v]).abs() <= off[v] + 1e-9);
                    count[1] += 1;
                }
            }
            assert_eq!(held.len(), 2);
            assert!(held.values().all(|[held, all]| held * 100 >= all * 90), "{roots}: {held:?}");
        }
    }

    #[test]
    fn every_area_has_roots_of_its_own() {
        let component = [vec![0; 90], vec![90; 8], vec![98; 2]].concat();
        let all: Vec<u32> = (0..100).collect();
        let counts = |roots| draw(&component, &all, roots, 5).iter().map(Vec::len).collect::<Vec<_>>();
        assert_eq!(counts(2), [AREA_ROOTS, AREA_ROOTS, 2]);
        assert_eq!(counts(50), [45, 4, 2]);
        assert_eq!(counts(usize::MAX), [90, 8, 2]);
        assert_ne!(draw(&component, &all, 50, 5), draw(&component, &all, 50, 6));
    }

    #[test]
    fn one_of_several_has_no_interval() {
        assert_eq!(sampled_row(&[0, 1], 9)[7], UNDEFINED);
        assert_eq!(sampled_row(&[0, 1], 2)[7], 0.0);
        assert!(sampled_row(&[0, 3], 9)[7] > 0.0, "all alike says little of the rest");
        assert!((student(20.0) - 2.086).abs() < 2e-3 && (student(11.0) - 2.201).abs() < 3e-3);
    }

    /// Means from trees of some query vertices: with all of them the exact ones, else within the interval.
    #[test]
    fn means_are_estimated_from_roots_too() {
        let (lattice, graph) = two_buildings();
        let component = graph.components();
        let exact = means(&forest::tally(&lattice, &graph, None), 0);
        let estimate = |roots: usize, seed: u64| {
            let sample = Sample::draw(&lattice, &component, &[], roots, seed);
            let tally = forest::tally_of(&lattice, &graph, Some(&sample.places), None);
            sample.means(&tally, &[])
        };
        let (whole, off) = estimate(usize::MAX, 1);
        assert!((whole.depth - exact.depth).abs() < 1e-9 && (whole.entropy - exact.entropy).abs() < 1e-9);
        assert_eq!((whole.degree, off), (exact.degree, [0.0, 0.0]));
        let mut held = [0, 0];
        for seed in 0..60 {
            let (guess, off) = estimate(24, seed);
            held[0] += usize::from((guess.depth - exact.depth).abs() <= off[0]);
            held[1] += usize::from((guess.entropy - exact.entropy).abs() <= off[1]);
        }
        assert!(held.iter().all(|h| *h >= 53), "{held:?} of 60");
    }

    /// Whoever stands where a wall comes to stand has no view, and counts no more in the estimate than in the mean.
    #[test]
    fn covered_roots_do_not_count() {
        let (lattice, graph) = two_buildings();
        let mut tally = forest::tally(&lattice, &graph, None);
        let covered: Vec<u32> = (0..lattice.query.len() as u32).step_by(3).collect();
        let mut levels = Vec::new();
        let mut at = 0;
        for (i, depth) in tally.depth.iter_mut().enumerate() {
            let own = &tally.levels[at..at + *depth as usize];
            at += own.len();
            if i % 3 == 0 { *depth = 0 } else { levels.extend(own) }
        }
        tally.levels = levels;
        let exact = means(&tally, covered.len());
        let (whole, _) = Sample::even(&lattice, usize::MAX, 1).means(&tally, &covered);
        assert!((whole.entropy - exact.entropy).abs() < 1e-9 && (whole.depth - exact.depth).abs() < 1e-9);
        let few: Vec<f64> =
            (0..40).map(|seed| Sample::even(&lattice, 200, seed).means(&tally, &covered).0.entropy).collect();
        let mean = few.iter().sum::<f64>() / 40.0;
        assert!((mean / exact.entropy - 1.0).abs() < 0.02, "{mean} {}", exact.entropy);
    }
}

//! The measures (spec section 4), under depthmapX's column names and definitions.

use enfilade_brief::column::VISUAL_ENTROPY;
use enfilade_brief::{Measure, column_of};
use rayon::prelude::*;

use crate::geometry::UM_PER_M;

use super::forest::{level_counts, level_counts_beyond};
use super::graph::Graph;
use super::{Lattice, Tally};

/// What a column holds where a measure has no value, as in depthmapX.
pub const UNDEFINED: f64 = -1.0;

/// Means over the query vertices: the objectives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Means {
    /// Neighbours in the region of reference.
    pub degree: f64,
    /// All neighbours.
    pub degree_all: f64,
    /// Last level of the breadth-first tree.
    pub depth: f64,
    /// Entropy of the levels, bits.
    pub entropy: f64,
}

impl Means {
    /// The mean of each over several measurements, at least one.
    pub fn mean(all: Vec<Self>) -> Self {
        let n = all.len().max(1) as f64;
        let mean = |of: fn(&Self) -> f64| all.iter().map(of).sum::<f64>() / n;
        Self {
            degree: mean(|m| m.degree),
            degree_all: mean(|m| m.degree_all),
            depth: mean(|m| m.depth),
            entropy: mean(|m| m.entropy),
        }
    }
}

/// Means of a tally over the query vertices but the `covered`, summed in vertex order: those see nothing because a
/// wall stands on them. All 0 without other vertices.
pub fn means(tally: &Tally, covered: usize) -> Means {
    let n = tally.depth.len().saturating_sub(covered).max(1) as f64;
    let mean = |values: &[u32]| values.iter().map(|&v| u64::from(v)).sum::<u64>() as f64 / n;
    let mut entropy = 0.0;
    let mut at = 0;
    for &depth in &tally.depth {
        entropy += entropy_bits(&tally.levels[at..at + depth as usize]);
        at += depth as usize;
    }
    Means {
        degree: mean(&tally.degree),
        degree_all: mean(&tally.degree_all),
        depth: mean(&tally.depth),
        entropy: entropy / n,
    }
}

/// `−Σ p_j log2 p_j` over the vertices per level 1.., bits; 0 if there are none (spec section 4).
pub fn entropy_bits(levels: &[u32]) -> f64 {
    let total: u64 = levels.iter().map(|&n| u64::from(n)).sum();
    let term = |&n: &u32| {
        let p = f64::from(n) / total as f64;
        if n == 0 { 0.0 } else { -p * p.log2() }
    };
    // A sum of nothing but −0 is −0.
    levels.iter().map(term).sum::<f64>() + 0.0
}

/// One measure of every vertex.
#[derive(Clone, Debug, PartialEq)]
pub struct Column {
    /// depthmapX's name, with ` R<r>` where a radius was set.
    pub name: String,
    /// One value a vertex, [`UNDEFINED`] where there is none.
    pub values: Vec<f64>,
}

/// All columns of the graph alone: [`local_columns`], then [`global_columns`].
pub fn columns(lattice: &Lattice, graph: &Graph, radius: Option<u32>) -> Vec<Column> {
    let mut all = local_columns(lattice, graph);
    all.extend(global_columns(lattice, graph, radius));
    all
}

/// Columns of the graph near a vertex.
pub const LOCAL_NAMES: [&str; 6] = [
    column_of(Measure::Connectivity),
    column_of(Measure::FirstMoment),
    column_of(Measure::SecondMoment),
    column_of(Measure::Clustering),
    column_of(Measure::Control),
    column_of(Measure::Controllability),
];

/// Connectivity, point moments (metres, square metres), clustering coefficient, control, controllability.
pub fn local_columns(lattice: &Lattice, graph: &Graph) -> Vec<Column> {
    local_columns_of(lattice, graph, |_| true)
}

/// Those of [`local_columns`] that are wanted by name; what only others need is not computed.
pub fn local_columns_of(lattice: &Lattice, graph: &Graph, wanted: impl Fn(&str) -> bool) -> Vec<Column> {
    let [connectivity, first, second, clustering, control, controllability] = LOCAL_NAMES.map(&wanted);
    let all: Vec<u32> = (0..graph.len() as u32).collect();
    let levels = if controllability { level_counts(graph, &all, 2) } else { Vec::new() };
    let common = if clustering || controllability { common_neighbours(graph) } else { Vec::new() };
    let near = |v: u32| {
        let (shared, met) = common.get(graph.tiles.rank_of[v as usize] as usize).copied().unwrap_or_default();
        // Seen from some neighbour: the vertex itself, neighbours with a neighbour in common, two steps away.
        let beyond = levels.get(v as usize).and_then(|levels| levels.get(1)).copied().unwrap_or(0);
        (shared, 1 + met + beyond)
    };
    let mut share = vec![0.0; graph.tiles.count() * 64];
    for (&(tile, bit), &degree) in graph.tiles.slot_of.iter().zip(&graph.degree) {
        share[tile as usize * 64 + usize::from(bit)] = 1.0 / f64::from(degree);
    }
    let spacing_m = lattice.spacing_um as f64 / UM_PER_M;
    let row = |&v: &u32| local_row(graph, &share, spacing_m, v, near(v));
    let degree = |&v: &u32| [f64::from(graph.degree(v)), 0.0, 0.0, 0.0, 0.0, 0.0];
    let is_degree_alone = connectivity && !(first || second || clustering || control || controllability);
    let rows: Vec<[f64; 6]> =
        if is_degree_alone { all.iter().map(degree).collect() } else { all.par_iter().map(row).collect() };
    let mut columns = transpose(LOCAL_NAMES.map(String::from), &rows);
    columns.retain(|column| wanted(&column.name));
    columns
}

/// By rank: neighbours in common with its neighbours, summed over them, and the neighbours that have any.
fn common_neighbours(graph: &Graph) -> Vec<(u64, u32)> {
    let ranks: Vec<usize> = (0..graph.len()).collect();
    let share = ranks.len().div_ceil(SHARES_PER_THREAD * rayon::current_num_threads()).max(1);
    let count = |ranks: &[usize]| {
        let mut found = vec![(0, 0); graph.len()];
        let mut own = vec![0; graph.tiles.count()];
        ranks.iter().for_each(|&rank| count_common(graph, rank, &mut own, &mut found));
        found
    };
    let add = |mut a: Vec<(u64, u32)>, b: Vec<(u64, u32)>| {
        a.iter_mut().zip(b).for_each(|(a, b)| *a = (a.0 + b.0, a.1 + b.1));
        a
    };
    let whole = ranks.par_chunks(share).map(count).reduce_with(add);
    whole.unwrap_or_default()
}

/// Low ranks have more pairs to count than high ones: shares small enough to even that out.
const SHARES_PER_THREAD: usize = 4;

fn count_common(graph: &Graph, rank: usize, own: &mut [u64], found: &mut [(u64, u32)]) {
    #[cfg(target_arch = "x86_64")]
    if is_x86_feature_detected!("popcnt") && is_x86_feature_detected!("bmi1") {
        // SAFETY: the processor has just been asked.
        #[allow(unsafe_code)]
        return unsafe { count_common_popcnt(graph, rank, own, found) };
    }
    count_common_in(graph, rank, own, found);
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "popcnt,bmi1")]
fn count_common_popcnt(graph: &Graph, rank: usize, own: &mut [u64], found: &mut [(u64, u32)]) {
    count_common_in(graph, rank, own, found);
}

/// Adds the pairs of `rank` and its later neighbours for both of them. Plain loops, no closures: they are
/// compiled for the caller's instruction set. `own` is all 0 before and after.
#[inline(always)]
fn count_common_in(graph: &Graph, rank: usize, own: &mut [u64], found: &mut [(u64, u32)]) {
    let (tiles, masks) = graph.row(rank);
    for (&t, &mask) in tiles.iter().zip(masks) {
        own[t as usize] = mask;
    }
    let (tile, bit) = graph.tiles.slot_of[rank];
    for (&t, &mask) in tiles.iter().zip(masks).skip_while(|(t, _)| **t < tile) {
        let mut later = if t == tile { mask & (u64::MAX << bit) } else { mask };
        while later != 0 {
            let other = graph.tiles.rank(t, later.trailing_zeros());
            later &= later - 1;
            let (tiles, masks) = graph.row(other);
            let mut common = 0;
            for (&t, &mask) in tiles.iter().zip(masks) {
                common += u64::from((mask & own[t as usize]).count_ones());
            }
            for end in [rank, other] {
                found[end] = (found[end].0 + common, found[end].1 + u32::from(common > 0));
            }
        }
    }
    for &t in tiles {
        own[t as usize] = 0;
    }
}

/// One vertex from what its neighbours have in common with it, and how many vertices they reach together.
/// `share` is what every cell, tile by tile, gives to the control of each that it sees.
fn local_row(
    graph: &Graph,
    share: &[f64],
    spacing_m: f64,
    v: u32,
    (shared, reached): (u64, u32),
) -> [f64; 6] {
    let degree = graph.degree(v);
    if degree == 0 {
        return [0.0, 0.0, 0.0, UNDEFINED, UNDEFINED, UNDEFINED];
    }
    let (mut control, mut moments) = (0.0, [0.0, 0.0]);
    let rank = graph.tiles.rank_of[v as usize] as usize;
    let (own_tile, own_bit) = graph.tiles.slot_of[rank];
    let corner = |tile: u32| graph.tiles.tile_at[tile as usize].map(|c| f64::from(c) * 8.0);
    let own = [0, 3].map(|shift| f64::from(own_bit >> shift & 7));
    let (tiles, masks) = graph.row(rank);
    for (&t, &mask) in tiles.iter().zip(masks) {
        let off = [0, 1].map(|k| corner(t)[k] - corner(own_tile)[k] - own[k]);
        let share = &share[t as usize * 64..][..64];
        let mut bits = mask;
        while bits != 0 {
            let bit = bits.trailing_zeros();
            bits &= bits - 1;
            control += share[bit as usize & 63];
            let (dx, dy) = (off[0] + f64::from(bit & 7), off[1] + f64::from(bit >> 3));
            moments[0] += (dx * dx + dy * dy).sqrt();
            moments[1] += dx * dx + dy * dy;
        }
    }
    let (s, d) = (spacing_m, f64::from(degree));
    let clustering = if degree > 1 { shared as f64 / (d * (d - 1.0)) } else { UNDEFINED };
    [d, moments[0] * s, moments[1] * s * s, clustering, control, d / f64::from(reached)]
}

/// Columns of the breadth-first trees.
pub const GLOBAL_NAMES: [&str; 7] = [
    VISUAL_ENTROPY,
    column_of(Measure::Integration),
    column_of(Measure::IntegrationPValue),
    column_of(Measure::IntegrationTekl),
    column_of(Measure::MeanDepth),
    column_of(Measure::Reach),
    column_of(Measure::RelativisedEntropy),
];

/// Measures of the breadth-first trees; with a radius only levels up to it count.
pub fn global_columns(lattice: &Lattice, graph: &Graph, radius: Option<u32>) -> Vec<Column> {
    global_columns_beside(lattice, graph, |_| None, radius)
}

/// [`global_columns`] where some trees are `known` in full, by vertex.
pub fn global_columns_beside<'a>(
    lattice: &Lattice,
    graph: &Graph,
    known: impl Fn(u32) -> Option<&'a [u32]>,
    radius: Option<u32>,
) -> Vec<Column> {
    let most = radius.unwrap_or(u32::MAX);
    let near = |levels: &'a [u32]| &levels[..levels.len().min(most as usize)];
    let mut rows = vec![[UNDEFINED; 7]; graph.len()];
    let mut rest = Vec::new();
    for (v, row) in rows.iter_mut().enumerate() {
        match known(v as u32) {
            Some(levels) => *row = global_row(near(levels)),
            None => rest.push(v as u32),
        }
    }
    for (&v, levels) in rest.iter().zip(level_counts_beyond(lattice, graph, &rest, most)) {
        rows[v as usize] = global_row(&levels);
    }
    named_rows(&rows, radius)
}

fn named_rows(rows: &[[f64; 7]], radius: Option<u32>) -> Vec<Column> {
    let suffix = radius.map(|r| format!(" R{r}")).unwrap_or_default();
    transpose(GLOBAL_NAMES.map(|n| format!("{n}{suffix}")), rows)
}

/// Mean level of the vertices reached, from the vertices per level 1..; 0 if there are none.
pub fn mean_depth(levels: &[u32]) -> f64 {
    let reached: u64 = levels.iter().map(|&n| u64::from(n)).sum();
    let total: u64 = levels.iter().zip(1..).map(|(&n, l)| l * u64::from(n)).sum();
    total as f64 / reached.max(1) as f64
}

/// One vertex from its level counts, in the order of [`global_columns`]: entropy, integration (HH, P-value,
/// Tekl), mean depth, node count, relativised entropy; [`UNDEFINED`] where there is none.
pub fn global_row(levels: &[u32]) -> [f64; 7] {
    let reached: u64 = levels.iter().map(|&n| u64::from(n)).sum();
    let total: u64 = levels.iter().zip(1..).map(|(&n, l)| l * u64::from(n)).sum();
    let n = (reached + 1) as f64;
    if reached == 0 {
        return [UNDEFINED, UNDEFINED, UNDEFINED, UNDEFINED, UNDEFINED, n, UNDEFINED];
    }
    let depth = mean_depth(levels);
    let [hh, p, tekl] = integration(n, total as f64);
    [entropy_bits(levels), hh, p, tekl, depth, n, relativised_entropy(levels, depth)]
}

/// Integration by the D-value, the P-value and Teklenburg's formula, of a vertex in a system of `n`
/// vertices whose depths add up to `total`.
pub(super) fn integration(n: f64, total: f64) -> [f64; 3] {
    let others = n - 1.0;
    if n <= 2.0 || total <= others {
        return [UNDEFINED; 3];
    }
    let asymmetry = 2.0 * (total / others - 1.0) / (n - 2.0);
    let pairs = others * (n - 2.0);
    let d_value = 2.0 * (n * (((n + 2.0) / 3.0).log2() - 1.0) + 1.0) / pairs;
    let p_value = 2.0 * (n - n.log2() - 1.0) / pairs;
    let deep = total - others;
    let tekl = if deep > 1.0 { (0.5 * (n - 2.0)).ln() / deep.ln() } else { UNDEFINED };
    [d_value / asymmetry, p_value / asymmetry, tekl]
}

/// `Σ p_k log2(p_k / q_k)`, `q_k = d^k / (k+1)! · e^−d`, as depthmapX computes it.
pub(super) fn relativised_entropy(levels: &[u32], depth: f64) -> f64 {
    let total: u64 = levels.iter().map(|&n| u64::from(n)).sum();
    let mut log_q = -depth * std::f64::consts::LOG2_E;
    let mut sum = 0.0;
    for (k, &n) in (1..).zip(levels) {
        log_q += depth.log2() - f64::from(k + 1).log2();
        let p = f64::from(n) / total as f64;
        sum += p * (p.log2() - log_q);
    }
    sum
}

pub(super) fn transpose<const K: usize>(names: [String; K], rows: &[[f64; K]]) -> Vec<Column> {
    let column = |(k, name)| Column { name, values: rows.iter().map(|row| row[k]).collect() };
    names.into_iter().enumerate().map(column).collect()
}

#[cfg(test)]
#[path = "measures_tests.rs"]
mod tests;

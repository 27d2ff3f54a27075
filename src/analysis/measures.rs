//! The measures (spec section 4), under depthmapX's column names and definitions.

use rayon::prelude::*;

use crate::plan::geometry::UM_PER_M;

use super::forest::level_counts;
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

/// Means of a tally, summed in vertex order; all 0 without query vertices.
pub fn means(tally: &Tally) -> Means {
    let n = tally.depth.len().max(1) as f64;
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
    levels.iter().map(term).sum()
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
    all.extend(global_columns(graph, radius));
    all
}

/// Connectivity, point moments (metres, square metres), clustering coefficient, control, controllability.
pub fn local_columns(lattice: &Lattice, graph: &Graph) -> Vec<Column> {
    let names = [
        "Connectivity",
        "Point First Moment",
        "Point Second Moment",
        "Visual Clustering Coefficient",
        "Visual Control",
        "Visual Controllability",
    ];
    let scratch = || (vec![0u64; graph.tiles.count()], vec![0u64; graph.tiles.count()]);
    let row = |scratch: &mut (Vec<u64>, Vec<u64>), v: usize| local_row(lattice, graph, v as u32, scratch);
    let rows: Vec<[f64; 6]> = (0..graph.len()).into_par_iter().map_init(scratch, row).collect();
    transpose(names.map(String::from), &rows)
}

fn local_row(lattice: &Lattice, graph: &Graph, v: u32, scratch: &mut (Vec<u64>, Vec<u64>)) -> [f64; 6] {
    let degree = graph.degree(v);
    if degree == 0 {
        return [0.0, 0.0, 0.0, UNDEFINED, UNDEFINED, UNDEFINED];
    }
    let (own, union) = scratch;
    let rank = graph.tiles.rank_of[v as usize] as usize;
    let (tiles, masks) = graph.row(rank);
    for (&t, &mask) in tiles.iter().zip(masks) {
        own[t as usize] = mask;
    }
    let (mut shared, mut control, mut moments) = (0u64, 0.0, [0.0, 0.0]);
    let [c, r] = lattice.cells[v as usize];
    graph.for_each_rank(rank, |k| {
        let (tiles, masks) = graph.row(k);
        for (&t, &mask) in tiles.iter().zip(masks) {
            shared += u64::from((mask & own[t as usize]).count_ones());
            union[t as usize] |= mask;
        }
        control += 1.0 / f64::from(graph.degree[k]);
        let [kc, kr] = lattice.cells[graph.tiles.vertex_of[k] as usize];
        let (dx, dy) = (f64::from(kc) - f64::from(c), f64::from(kr) - f64::from(r));
        moments[0] += (dx * dx + dy * dy).sqrt();
        moments[1] += dx * dx + dy * dy;
    });
    let reached: u32 = union.iter_mut().map(|m| std::mem::take(m).count_ones()).sum();
    tiles.iter().for_each(|&t| own[t as usize] = 0);
    let (s, d) = (lattice.spacing_um as f64 / UM_PER_M, f64::from(degree));
    let clustering = if degree > 1 { shared as f64 / (d * (d - 1.0)) } else { UNDEFINED };
    [d, moments[0] * s, moments[1] * s * s, clustering, control, d / f64::from(reached)]
}

/// Measures of the breadth-first trees; with a radius only levels up to it count.
pub fn global_columns(graph: &Graph, radius: Option<u32>) -> Vec<Column> {
    let names = [
        "Visual Entropy",
        "Visual Integration [HH]",
        "Visual Integration [P-value]",
        "Visual Integration [Tekl]",
        "Visual Mean Depth",
        "Visual Node Count",
        "Visual Relativised Entropy",
    ];
    let all: Vec<u32> = (0..graph.len() as u32).collect();
    let levels = level_counts(graph, &all, radius.unwrap_or(u32::MAX));
    let rows: Vec<[f64; 7]> = levels.iter().map(|l| global_row(l)).collect();
    let suffix = radius.map(|r| format!(" R{r}")).unwrap_or_default();
    transpose(names.map(|n| format!("{n}{suffix}")), &rows)
}

/// One vertex from its level counts, in the order of [`global_columns`].
fn global_row(levels: &[u32]) -> [f64; 7] {
    let reached: u64 = levels.iter().map(|&n| u64::from(n)).sum();
    let total: u64 = levels.iter().zip(1..).map(|(&n, l)| l * u64::from(n)).sum();
    let n = (reached + 1) as f64;
    if reached == 0 {
        return [UNDEFINED, UNDEFINED, UNDEFINED, UNDEFINED, UNDEFINED, n, UNDEFINED];
    }
    let depth = total as f64 / reached as f64;
    let mut integration = [UNDEFINED; 3];
    if reached > 1 && total > reached {
        let asymmetry = 2.0 * (depth - 1.0) / (n - 2.0);
        let pairs = (n - 1.0) * (n - 2.0);
        let d_value = 2.0 * (n * (((n + 2.0) / 3.0).log2() - 1.0) + 1.0) / pairs;
        let p_value = 2.0 * (n - n.log2() - 1.0) / pairs;
        integration[0] = d_value / asymmetry;
        integration[1] = p_value / asymmetry;
        if total > reached + 1 {
            integration[2] = (0.5 * (n - 2.0)).ln() / ((total - reached) as f64).ln();
        }
    }
    let [hh, p, tekl] = integration;
    [entropy_bits(levels), hh, p, tekl, depth, n, relativised_entropy(levels, depth)]
}

/// `Σ p_k log2(p_k / q_k)`, `q_k = d^k / (k+1)! · e^−d`, as depthmapX computes it.
fn relativised_entropy(levels: &[u32], depth: f64) -> f64 {
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

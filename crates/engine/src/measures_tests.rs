use std::collections::BTreeSet;

use proptest::prelude::*;

use super::*;
use crate::{fixtures, forest, visibility};

#[test]
fn entropy_of_known_distributions() {
    assert_eq!(entropy_bits(&[]), 0.0);
    assert_eq!(entropy_bits(&[7]), 0.0);
    assert!(entropy_bits(&[7]).is_sign_positive() && entropy_bits(&[]).is_sign_positive(), "-0 in tables");
    assert_eq!(entropy_bits(&[4, 4]), 1.0);
    assert_eq!(entropy_bits(&[2, 1, 1]), 1.5);
}

#[test]
fn an_isolated_vertex_counts_itself_and_has_no_depth() {
    let row = global_row(&[]);
    assert_eq!(row[5], 1.0);
    assert_eq!(row[4], UNDEFINED);
}

/// Column by column against depthmapX 0.8.0, which stores float32.
#[test]
fn columns_equal_depthmapx() {
    let Some((lattice, obstacles, header, rows)) = fixtures::n900() else { return };
    let graph = visibility::visibility_graph(&lattice, &obstacles);
    for column in columns(&lattice, &graph, None) {
        let k = header.iter().position(|h| *h == column.name).unwrap();
        for (v, row) in rows.iter().enumerate() {
            let (ours, theirs) = (column.values[v], row[k]);
            let error = (ours - theirs).abs() / theirs.abs().max(1e-30);
            assert!(error <= 1e-6, "{} of {}: {ours} {theirs}", column.name, row[0]);
        }
    }
}

#[test]
fn radius_cuts_the_levels() {
    let Some((lattice, obstacles, ..)) = fixtures::n900() else { return };
    let graph = visibility::visibility_graph(&lattice, &obstacles);
    let near = global_columns(&lattice, &graph, Some(1));
    let count = near.iter().find(|c| c.name == "Visual Node Count R1").unwrap();
    for v in 0..graph.len() {
        assert_eq!(count.values[v], f64::from(graph.degree(v as u32)) + 1.0);
    }
}

#[test]
fn means_add_up() {
    let Some((lattice, obstacles, ..)) = fixtures::n900() else { return };
    let graph = visibility::visibility_graph(&lattice, &obstacles);
    let tally = forest::tally(&lattice, &graph, None);
    let all = means(&tally, 0);
    assert_eq!(all.degree_all * 900.0, 2.0 * graph.edge_count() as f64);
    assert_eq!(tally.levels.len() as u32, tally.depth.iter().sum::<u32>());
}

/// Trees that are known already are not walked again.
#[test]
fn columns_beside_known_trees_are_the_same() {
    let Some((mut lattice, obstacles, ..)) = fixtures::n900() else { return };
    lattice.query.retain(|v| v % 3 != 1);
    let graph = visibility::visibility_graph(&lattice, &obstacles);
    let tally = forest::tally(&lattice, &graph, None);
    let trees = tally.trees(&lattice);
    assert_eq!(
        global_columns_beside(&lattice, &graph, |v| trees[v as usize], None),
        global_columns(&lattice, &graph, None)
    );
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

    /// Clustering, control and controllability by their definitions, neighbour by neighbour.
    #[test]
    fn local_measures_by_definition((lattice, obstacles) in fixtures::plans()) {
        let graph = visibility::visibility_graph(&lattice, &obstacles);
        let near: Vec<BTreeSet<u32>> = (0..graph.len() as u32)
            .map(|v| (0..graph.len() as u32).filter(|&u| graph.sees(u, v)).collect())
            .collect();
        let columns = local_columns(&lattice, &graph);
        for column in &columns {
            let alone = local_columns_of(&lattice, &graph, |name| name == column.name);
            prop_assert_eq!(&alone, std::slice::from_ref(column));
        }
        for (v, own) in near.iter().enumerate() {
            let d = own.len() as f64;
            let among = own.iter().map(|&u| near[u as usize].intersection(own).count()).sum::<usize>() as f64;
            let reached: BTreeSet<u32> = own.iter().flat_map(|&u| near[u as usize].iter().copied()).collect();
            let clustering = if own.len() > 1 { among / (d * (d - 1.0)) } else { UNDEFINED };
            let controllability = if own.is_empty() { UNDEFINED } else { d / reached.len() as f64 };
            prop_assert_eq!(columns[0].values[v], d);
            prop_assert_eq!(columns[3].values[v], clustering);
            prop_assert_eq!(columns[5].values[v], controllability);
            let control: f64 = own.iter().map(|&u| 1.0 / near[u as usize].len() as f64).sum();
            let error = (columns[4].values[v] - if own.is_empty() { UNDEFINED } else { control }).abs();
            prop_assert!(error <= 1e-12 * d.max(1.0), "control of {}: off by {}", v, error);
        }
    }
}

//! Stars against waves.

use proptest::prelude::*;

use super::super::forest::by_waves;
#[cfg(target_arch = "x86_64")]
use super::super::lanes::x86::Avx2;
use super::super::lanes::{Portable, Vector};
use super::super::{Obstacles, fixtures, visibility};
use super::*;
use crate::geometry::Segment;

fn ways() -> Vec<Way> {
    let lanes = |path| [64, 512].map(|lanes| (path, lanes));
    let all = Path::available().into_iter().flat_map(lanes);
    all.flat_map(|(path, lanes)| [true, false].map(|by_halls| Way { path, lanes, by_halls, lanes_min: 1 }))
        .collect()
}

/// All levels in the order of the roots.
fn levels_by(way: Way, graph: &Graph, roots: &[u32]) -> Option<Vec<Vec<u32>>> {
    levels_in_shares(way, graph, roots, 1)
}

/// The same, made in so many shares; every root is in one of them.
fn levels_in_shares(way: Way, graph: &Graph, roots: &[u32], shares: u32) -> Option<Vec<Vec<u32>>> {
    let mut levels = vec![None; roots.len()];
    for share in Share::all(shares) {
        for (place, own) in level_counts_by(way, graph, roots, share)? {
            assert!(levels[place as usize].replace(own).is_none());
        }
    }
    levels.into_iter().collect()
}

fn waves_of(path: Path, graph: &Graph, roots: &[u32]) -> Vec<Vec<u32>> {
    let mut waves = by_waves(path, graph, roots, u32::MAX, Share::WHOLE);
    waves.sort_unstable_by_key(|w| w.0);
    waves.into_iter().map(|w| w.1).collect()
}

/// Every way has the levels of waves; without halls it may leave the graph to them.
fn check(graph: &Graph, roots: &[u32]) -> Result<(), TestCaseError> {
    let waves = waves_of(Path::Portable, graph, roots);
    for way in ways() {
        match levels_by(way, graph, roots) {
            Some(stars) => prop_assert!(stars == waves, "{:?}", way),
            None => prop_assert!(!way.by_halls, "{:?}", way),
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    #[test]
    fn degenerate_plans_have_the_levels_of_waves((lattice, obstacles) in fixtures::plans()) {
        let graph = visibility::visibility_graph(&lattice, &obstacles);
        check(&graph, &lattice.query)?;
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 8, ..ProptestConfig::default() })]

    #[test]
    fn mazes_have_the_levels_of_waves((lattice, obstacles) in fixtures::mazes(45)) {
        let graph = visibility::visibility_graph(&lattice, &obstacles);
        check(&graph, &lattice.query)?;
        let some: Vec<u32> = lattice.query.iter().copied().filter(|v| v % 7 < 3).rev().collect();
        check(&graph, &some)?;
    }
}

/// Every path reads from the views of two tiles, made once and turned, what the rows of the graph say.
fn check_views(graph: &Graph) -> Result<(), TestCaseError> {
    let sight = sight::Sight::new(graph);
    for rank in 0..graph.len() {
        let (tile, bit) = graph.tiles.slot_of[rank];
        let (tiles, masks) = graph.row(rank);
        for (to, near) in sight.of(tile as usize).iter().zip(sight.near(tile as usize)) {
            let seen = tiles.binary_search(to).map_or(0, |at| masks[at]);
            let (seeing, views) = sight.views(near);
            let own = if *to == tile { 1 << bit } else { 0 };
            let read = |union: u64| (union | own) == (seen | own);
            if near.sees_all() {
                prop_assert!(graph.degree[rank] == 0 || (near.any | own) == (seen | own));
                continue;
            }
            prop_assert!(read(Portable::union_by(views, seeing, 1 << bit)));
            #[cfg(target_arch = "x86_64")]
            if Path::available().contains(&Path::Avx2) {
                prop_assert!(read(Avx2::union_by(views, seeing, 1 << bit)));
            }
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    #[test]
    fn views_are_the_rows_of_the_graph((lattice, obstacles) in fixtures::mazes(30)) {
        let graph = visibility::visibility_graph(&lattice, &obstacles);
        check_views(&graph)?;
        check_views(&halls::by_halls(&graph))?;
    }
}

/// Rooms of 8 by 7 cells with doors, where far tiles rest; every way, any number of threads.
#[test]
fn rooms_have_the_levels_of_waves() {
    let (lattice, obstacles) = fixtures::rooms(16, 5);
    let graph = visibility::visibility_graph(&lattice, &obstacles);
    let waves = waves_of(Path::Portable, &graph, &lattice.query);
    let deepest = waves.iter().map(Vec::len).max();
    assert!(deepest >= Some(8), "{deepest:?}");
    for way in ways() {
        for threads in [1, 3] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            let stars = pool.install(|| levels_by(way, &graph, &lattice.query));
            assert!(stars.as_ref() == Some(&waves), "{way:?}");
        }
        let stars = levels_in_shares(way, &graph, &lattice.query, 3);
        assert!(stars.as_ref() == Some(&waves), "{way:?} in shares");
    }
}

/// A winding corridor there and back: cells of one square lie more than 64 steps apart, and stars without halls must
/// leave it to the waves.
#[test]
fn a_corridor_there_and_back_has_the_levels_of_waves() {
    let cells: Vec<[i32; 2]> = (0..300).flat_map(|c| (0..8).map(move |r| [c, r])).collect();
    let between = Segment { a: [-5, 35], b: [2_960, 35] };
    let wall = |i: i64| {
        let (low, high) = if i % 2 == 0 { (-1, 25) } else { (5, 34) };
        [0, 40].map(|up| Segment { a: [i * 10 + 5, low + up], b: [i * 10 + 5, high + up] })
    };
    let segments = (0..295).flat_map(wall).chain([between]).collect();
    let lattice = fixtures::lattice(10, [0, 0], cells);
    let graph = visibility::visibility_graph(&lattice, &Obstacles { segments, blind: vec![7] });
    let waves = waves_of(Path::best(), &graph, &lattice.query);
    assert!(waves[0].len() > 128, "{}", waves[0].len());
    let way = |by_halls| Way { path: Path::best(), lanes: 64, by_halls, lanes_min: 1 };
    assert!(levels_by(way(false), &graph, &lattice.query).is_none());
    assert!(levels_by(way(true), &graph, &lattice.query) == Some(waves));
}

//! Stages "frontier" and "levels": the breadth-first forest of all query vertices, as level counts.

use std::collections::VecDeque;
use std::sync::Mutex;

use rayon::prelude::*;

use super::graph::Graph;
use super::lanes::LANES;
use super::lanes::Path;
use super::relays::Relays;
use super::shares::{Share, Trees};
use super::stars;
use super::wave::Wave;
use super::{Lattice, Tally};

/// Vertices on level 1, 2, … of the breadth-first tree of each root (distinct), up to `max_level`: by stars where
/// they are faster, otherwise by waves.
pub(super) fn level_counts(graph: &Graph, roots: &[u32], max_level: u32) -> Vec<Vec<u32>> {
    in_order(level_counts_of(graph, roots, max_level, Share::WHOLE))
}

/// [`level_counts`] of the roots of a share, by their places among `roots`: the shares are of what is walked together.
fn level_counts_of(graph: &Graph, roots: &[u32], max_level: u32, share: Share) -> Vec<(u32, Vec<u32>)> {
    let by_stars = if max_level == u32::MAX { stars::level_counts(graph, roots, share) } else { None };
    by_stars.unwrap_or_else(|| by_waves(Path::best(), graph, roots, max_level, share))
}

fn in_order(mut trees: Vec<(u32, Vec<u32>)>) -> Vec<Vec<u32>> {
    trees.sort_unstable_by_key(|tree| tree.0);
    trees.into_iter().map(|tree| tree.1).collect()
}

/// [`level_counts`] over the stairs of a lattice too.
pub(super) fn level_counts_beyond(
    lattice: &Lattice,
    graph: &Graph,
    roots: &[u32],
    max_level: u32,
) -> Vec<Vec<u32>> {
    in_order(level_counts_beyond_of(lattice, graph, roots, max_level, Share::WHOLE))
}

/// [`level_counts_beyond`] of the roots of a share, by their places among `roots`.
pub(super) fn level_counts_beyond_of(
    lattice: &Lattice,
    graph: &Graph,
    roots: &[u32],
    max_level: u32,
    share: Share,
) -> Vec<(u32, Vec<u32>)> {
    let mut trees = level_counts_of(graph, roots, max_level, share);
    if let Some(beyond) = &lattice.beyond {
        let own = trees.iter_mut().map(|(place, levels)| (roots[*place as usize], levels));
        beyond.add_to(&beyond.steps(graph), own, max_level);
    }
    trees
}

/// [`level_counts_of`] by waves: shares are of whole waves.
pub(super) fn by_waves(
    path: Path,
    graph: &Graph,
    roots: &[u32],
    max_level: u32,
    share: Share,
) -> Vec<(u32, Vec<u32>)> {
    let relays = Relays::new(graph);
    let order = walking_order(graph, roots);
    let batches: Vec<&[(u32, u32)]> = order.chunks(LANES).collect();
    // One wave a thread, whatever way the batches are handed out.
    let idle = Mutex::new(Vec::new());
    let walk = |batch: &&[(u32, u32)]| {
        let taken = idle.lock().ok().and_then(|mut waves| waves.pop());
        let mut wave = taken.unwrap_or_else(|| Wave::new(&relays, path));
        let ranks: Vec<u32> = batch.iter().map(|b| b.0).collect();
        let levels = wave.levels(&ranks, max_level);
        if let Ok(mut waves) = idle.lock() {
            waves.push(wave);
        }
        batch.iter().map(|b| b.1).zip(levels).collect()
    };
    let walked: Vec<Vec<(u32, Vec<u32>)>> = share.of(&batches).par_iter().map(walk).collect();
    walked.into_iter().flatten().collect()
}

/// Vertices on level 1, 2, … of the tree of each root, by waves whatever the plan: to compare with.
pub fn levels_by_waves(graph: &Graph, roots: &[u32]) -> Vec<Vec<u32>> {
    in_order(by_waves(Path::best(), graph, roots, u32::MAX, Share::WHOLE))
}

/// How many of the roots reach each rank on level 1, 2, …, level by level.
pub(super) fn level_counts_by_rank(graph: &Graph, roots: &[u32]) -> Vec<Vec<u32>> {
    let relays = Relays::new(graph);
    let ranks: Vec<u32> = walking_order(graph, roots).into_iter().map(|r| r.0).collect();
    let batches: Vec<&[u32]> = ranks.chunks(LANES).collect();
    // One share of the batches a thread: each share holds counts for every rank.
    let share = batches.len().div_ceil(rayon::current_num_threads()).max(1);
    let count = |batches: &[&[u32]]| {
        let mut wave = Wave::new(&relays, Path::best());
        let mut levels = Vec::new();
        batches.iter().for_each(|batch| wave.levels_by_rank(batch, &mut levels));
        levels
    };
    let add = |mut a: Vec<Vec<u32>>, mut b: Vec<Vec<u32>>| {
        if a.len() < b.len() {
            std::mem::swap(&mut a, &mut b);
        }
        for (a, b) in a.iter_mut().zip(b) {
            a.iter_mut().zip(b).for_each(|(a, b)| *a += b);
        }
        a
    };
    batches.par_chunks(share).map(count).reduce(Vec::new, add)
}

/// Roots as (rank, place in `roots`), those within a short walk of each other next to each other: their
/// waves arrive together, so that a vertex is visited on fewer levels.
fn walking_order(graph: &Graph, roots: &[u32]) -> Vec<(u32, u32)> {
    let mut place = vec![u32::MAX; graph.len()];
    for (i, &v) in roots.iter().enumerate() {
        place[graph.tiles.rank_of[v as usize] as usize] = i as u32;
    }
    let mut order = Vec::with_capacity(roots.len());
    let mut is_met = vec![false; graph.len()];
    let mut queue = VecDeque::new();
    // Met when a batch was full, but not walked: the next batches start there.
    let mut border = VecDeque::new();
    let mut all = 0..graph.len() as u32;
    while let Some(seed) = border.pop_front().or_else(|| all.next()) {
        if std::mem::replace(&mut is_met[seed as usize], true) {
            continue;
        }
        queue.push_back(seed);
        let full = (order.len() / LANES + 1) * LANES;
        while let Some(at) = queue.pop_front() {
            if place[at as usize] != u32::MAX {
                order.push((at, place[at as usize]));
            }
            graph.for_each_beside(at as usize, |to| {
                if !std::mem::replace(&mut is_met[to], true) {
                    queue.push_back(to as u32);
                }
            });
            if order.len() == full {
                break;
            }
        }
        for rank in queue.drain(..) {
            is_met[rank as usize] = false;
            border.push_back(rank);
        }
    }
    order
}

/// Levels, degrees and cut-off vertices of the query region. Breadth-first trees run over all of `V`, and over stairs.
///
/// `initial` is the layout against which cut-off vertices are counted; without it `disconnected` is 0.
pub fn tally(lattice: &Lattice, graph: &Graph, initial: Option<Initial<'_>>) -> Tally {
    tally_of(lattice, graph, None, initial)
}

/// [`tally`] with trees of some positions in the region of query alone, ascending; the others have no levels.
pub fn tally_of(
    lattice: &Lattice,
    graph: &Graph,
    places: Option<&[u32]>,
    initial: Option<Initial<'_>>,
) -> Tally {
    let mut tally = degrees(lattice, graph);
    match places {
        None => {
            for levels in level_counts_beyond(lattice, graph, &lattice.query, u32::MAX) {
                tally.depth.push(levels.len() as u32);
                tally.levels.extend(levels);
            }
        }
        Some(places) => {
            let roots: Vec<u32> = places.iter().map(|&i| lattice.query[i as usize]).collect();
            tally.depth = vec![0; lattice.query.len()];
            for (&i, levels) in places.iter().zip(level_counts_beyond(lattice, graph, &roots, u32::MAX)) {
                tally.depth[i as usize] = levels.len() as u32;
                tally.levels.extend(levels);
            }
        }
    }
    cut_off(tally, lattice, graph, initial)
}

/// [`tally`] with trees that were walked before.
pub(super) fn tally_from(lattice: &Lattice, graph: &Graph, trees: &Trees, initial: Initial<'_>) -> Tally {
    let mut tally = degrees(lattice, graph);
    for v in &lattice.query {
        let levels = trees.levels(*v).unwrap_or_default();
        tally.depth.push(levels.len() as u32);
        tally.levels.extend(levels);
    }
    cut_off(tally, lattice, graph, Some(initial))
}

/// Who is seen by each vertex of the region of query, and no tree.
fn degrees(lattice: &Lattice, graph: &Graph) -> Tally {
    let reference = graph.tile_masks(|v| lattice.is_reference[v as usize]);
    let mut tally = Tally::default();
    for &v in &lattice.query {
        let (tiles, masks) = graph.row(graph.tiles.rank_of[v as usize] as usize);
        let seen = tiles.iter().zip(masks).map(|(&t, m)| (m & reference[t as usize]).count_ones()).sum();
        tally.degree.push(seen);
        tally.degree_all.push(graph.degree(v));
    }
    tally
}

fn cut_off(tally: Tally, lattice: &Lattice, graph: &Graph, initial: Option<Initial<'_>>) -> Tally {
    let lost = initial.map(|initial| disconnected(&lattice.query, &initial, &graph.components()));
    Tally { disconnected: lost.unwrap_or(0), ..tally }
}

/// What cut-off vertices are counted against.
#[derive(Clone, Copy, Debug)]
pub struct Initial<'a> {
    /// The [`Graph::components`] of the initial layout.
    pub components: &'a [u32],
    /// Vertices that a solid covers in the layout measured: where a wall stands is no space that it cuts
    /// off, or no solid could ever move.
    pub covered: &'a [u32],
}

/// Σ over query vertices of the vertices that shared their component initially and do not now; covered
/// vertices are left out on both sides.
pub(super) fn disconnected(query: &[u32], initial: &Initial<'_>, now: &[u32]) -> u64 {
    if initial.components == now {
        return 0;
    }
    let mut is_covered = vec![false; now.len()];
    initial.covered.iter().for_each(|&v| is_covered[v as usize] = true);
    let was = initial.components;
    let mut pairs: Vec<(u32, u32)> =
        (0..now.len()).filter(|&v| !is_covered[v]).map(|v| (was[v], now[v])).collect();
    pairs.sort_unstable();
    let count = |from: (u32, u32), to: (u32, u32)| {
        (pairs.partition_point(|p| *p <= to) - pairs.partition_point(|p| *p < from)) as u64
    };
    let lost = |&v: &u32| {
        let (a, b) = (was[v as usize], now[v as usize]);
        count((a, 0), (a, u32::MAX)) - count((a, b), (a, b))
    };
    query.iter().filter(|&&v| !is_covered[v as usize]).map(lost).sum()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::{Obstacles, fixtures, visibility};
    use super::*;
    use crate::geometry::Segment;

    /// One queue a root.
    fn by_queue(graph: &Graph, root: u32) -> Vec<u32> {
        let mut level = vec![u32::MAX; graph.len()];
        let mut queue = std::collections::VecDeque::from([root]);
        let mut counts = Vec::new();
        level[root as usize] = 0;
        while let Some(u) = queue.pop_front() {
            let next = level[u as usize] + 1;
            graph.for_each_neighbour(u, |v| {
                if level[v as usize] == u32::MAX {
                    level[v as usize] = next;
                    counts.resize(next as usize, 0);
                    counts[next as usize - 1] += 1;
                    queue.push_back(v);
                }
            });
        }
        counts
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 8, ..ProptestConfig::default() })]

        #[test]
        fn every_path_walks_like_a_queue((lattice, obstacles) in fixtures::mazes(30), cut in 1u32..5) {
            let graph = visibility::visibility_graph(&lattice, &obstacles);
            let all: Vec<u32> = (0..graph.len() as u32).collect();
            let expected: Vec<_> = all.iter().map(|&v| by_queue(&graph, v)).collect();
            for path in Path::available() {
                let halves = Share::all(2).flat_map(|half| by_waves(path, &graph, &all, u32::MAX, half));
                prop_assert_eq!(&in_order(halves.collect()), &expected);
            }
            let some: Vec<u32> = all.iter().copied().filter(|v| v % 3 == 1).rev().collect();
            let near = level_counts(&graph, &some, cut);
            for (levels, &v) in near.iter().zip(&some) {
                let full = &expected[v as usize];
                prop_assert_eq!(&levels[..], &full[..full.len().min(cut as usize)]);
            }
        }
    }

    #[test]
    fn a_corridor_has_as_many_levels_as_corners() {
        // A zigzag of 40 cells' width: walls from alternate sides leave one cell of passage.
        let cells: Vec<[i32; 2]> = (0..300).flat_map(|c| (0..4).map(move |r| [c, r])).collect();
        let wall = |i: i64| {
            let (lo, hi) = if i % 2 == 0 { (-1, 25) } else { (5, 31) };
            Segment { a: [i * 10 + 5, lo], b: [i * 10 + 5, hi] }
        };
        let obstacles = Obstacles { segments: (0..299).map(wall).collect(), blind: vec![] };
        let graph = visibility::visibility_graph(&fixtures::lattice(10, [0, 0], cells), &obstacles);
        let levels = level_counts(&graph, &[0], u32::MAX);
        assert_eq!(levels[0], by_queue(&graph, 0));
        assert!(levels[0].len() > 64, "{}", levels[0].len());
    }

    #[test]
    fn cut_off_vertices_are_counted_per_query_vertex() {
        // Initially {0,1,2,3} and {4}; now {0,1}, {2}, {3,4}: 0 loses two, 2 loses three, 4 none.
        let against = |covered| Initial { components: &[0, 0, 0, 0, 4], covered };
        assert_eq!(disconnected(&[0, 2, 4], &against(&[]), &[0, 0, 2, 3, 3]), 5);
        assert_eq!(disconnected(&[0, 2, 4], &against(&[2]), &[0, 0, 2, 3, 3]), 1);
        assert_eq!(disconnected(&[0, 2, 4], &against(&[2, 3]), &[0, 0, 2, 3, 3]), 0);
        assert_eq!(disconnected(&[0, 2, 4], &against(&[]), &[0, 0, 0, 0, 4]), 0);
    }
}

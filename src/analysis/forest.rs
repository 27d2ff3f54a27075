//! Stages "frontier" and "levels": the breadth-first forest of all query vertices, as level counts.

use rayon::prelude::*;

use super::graph::{Graph, for_each_bit};
use super::{Lattice, Tally};

/// Roots handed to one worker at a time.
const ROOTS: usize = 64;

/// Level counts of one root, `levels[j]` vertices on level `j + 1`, and what a walk needs.
struct Walk<'a> {
    graph: &'a Graph,
    unseen: Vec<u64>,
    frontier: Vec<u32>,
    next: Vec<u32>,
}

impl<'a> Walk<'a> {
    fn new(graph: &'a Graph) -> Self {
        Self { graph, unseen: graph.tiles.occupied.clone(), frontier: Vec::new(), next: Vec::new() }
    }

    fn levels(&mut self, root: usize, max_level: u32, levels: &mut Vec<u32>) {
        let tiles = &self.graph.tiles;
        self.unseen.copy_from_slice(&tiles.occupied);
        let (tile, bit) = tiles.slot_of[root];
        self.unseen[tile as usize] &= !(1 << bit);
        self.frontier.clear();
        self.frontier.push(root as u32);
        for _ in 0..max_level {
            self.next.clear();
            for &at in &self.frontier {
                let (row_tiles, masks) = self.graph.row(at as usize);
                for (&t, &mask) in row_tiles.iter().zip(masks) {
                    let fresh = mask & self.unseen[t as usize];
                    self.unseen[t as usize] &= !fresh;
                    for_each_bit(fresh, |bit| self.next.push(tiles.rank(t, bit) as u32));
                }
            }
            if self.next.is_empty() {
                break;
            }
            levels.push(self.next.len() as u32);
            std::mem::swap(&mut self.frontier, &mut self.next);
        }
    }
}

/// Vertices on level 1, 2, … of the breadth-first tree of each root, up to `max_level`.
pub(super) fn level_counts(graph: &Graph, roots: &[u32], max_level: u32) -> Vec<Vec<u32>> {
    let walk = |roots: &[u32]| {
        let mut walk = Walk::new(graph);
        let one = |&v: &u32| {
            let mut levels = Vec::new();
            walk.levels(graph.tiles.rank_of[v as usize] as usize, max_level, &mut levels);
            levels
        };
        roots.iter().map(one).collect::<Vec<_>>()
    };
    roots.par_chunks(ROOTS).flat_map_iter(walk).collect()
}

/// Levels, degrees and cut-off vertices of the query region. Breadth-first trees run over all of `V`.
///
/// `initial_components` are the [`Graph::components`] of the initial layout; without them
/// `disconnected` is 0.
pub fn tally(lattice: &Lattice, graph: &Graph, initial_components: Option<&[u32]>) -> Tally {
    let reference = graph.tile_masks(|v| lattice.is_reference[v as usize]);
    let mut tally = Tally::default();
    for &v in &lattice.query {
        let (tiles, masks) = graph.row(graph.tiles.rank_of[v as usize] as usize);
        let seen = tiles.iter().zip(masks).map(|(&t, m)| (m & reference[t as usize]).count_ones()).sum();
        tally.degree.push(seen);
        tally.degree_all.push(graph.degree(v));
    }
    for levels in level_counts(graph, &lattice.query, u32::MAX) {
        tally.depth.push(levels.len() as u32);
        tally.levels.extend(levels);
    }
    if let Some(initial) = initial_components {
        tally.disconnected = disconnected(&lattice.query, initial, &graph.components());
    }
    tally
}

/// Σ over query vertices of the vertices that shared their component initially and do not now.
pub(super) fn disconnected(query: &[u32], initial: &[u32], now: &[u32]) -> u64 {
    if initial == now {
        return 0;
    }
    let mut pairs: Vec<(u32, u32)> = initial.iter().copied().zip(now.iter().copied()).collect();
    pairs.sort_unstable();
    let count = |from: (u32, u32), to: (u32, u32)| {
        (pairs.partition_point(|p| *p <= to) - pairs.partition_point(|p| *p < from)) as u64
    };
    let lost = |&v: &u32| {
        let (a, b) = (initial[v as usize], now[v as usize]);
        count((a, 0), (a, u32::MAX)) - count((a, b), (a, b))
    };
    query.iter().map(lost).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cut_off_vertices_are_counted_per_query_vertex() {
        // Initially {0,1,2,3} and {4}; now {0,1}, {2}, {3,4}: 0 loses two, 2 loses three, 4 none.
        assert_eq!(disconnected(&[0, 2, 4], &[0, 0, 0, 0, 4], &[0, 0, 2, 3, 3]), 5);
        assert_eq!(disconnected(&[0, 2, 4], &[0, 0, 0, 0, 4], &[0, 0, 0, 0, 4]), 0);
    }
}

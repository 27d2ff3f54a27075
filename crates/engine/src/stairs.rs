//! Storeys over one another: steps beyond the stairs of the one that is measured.
//!
//! A stair joins two storeys: each of its vertices on one is a step from each of its vertices on the other. Trees that
//! begin on the measured storey go over its stairs to every other one, and on over theirs. What is seen, and a way
//! between two vertices of the measured storey, stay on it.

use std::collections::{BTreeMap, VecDeque};

use super::Tally;
use super::graph::Graph;

/// Steps to what is not reached.
pub(super) const NEVER: u32 = u32::MAX;

/// A stair between two storeys, by their places in a list: its vertices on either.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Stair {
    /// The storeys.
    pub storeys: [usize; 2],
    /// Its vertices on the first and on the second, distinct.
    pub vertices: [Vec<u32>; 2],
}

impl Stair {
    /// Its sides as (storey, place in `vertices`), the one on `storey` first; none where it does not lead there.
    fn from(&self, storey: usize) -> Option<[(usize, usize); 2]> {
        let at = self.storeys.iter().position(|s| *s == storey)?;
        Some([at, 1 - at].map(|k| (self.storeys[k], k)))
    }
}

/// Vertices that are alike from the measured storey: how many steps they are from each of its stairs, and how many there are.
pub type Far = Vec<(Vec<u32>, u32)>;

/// What lies beyond the stairs of the measured storey.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Beyond {
    /// The vertices of each stair on the measured storey, ascending.
    pub stairs: Vec<Vec<u32>>,
    /// In steps from each of these stairs, at least 1.
    pub far: Far,
}

/// What lies beyond the stairs of the storey `own`, in steps from each stair that leads there, in their order. `graphs`:
/// who sees whom on every storey that is counted; that of `own` is not asked.
pub fn far(graphs: &[Option<&Graph>], stairs: &[Stair], own: usize) -> Far {
    let mut at: BTreeMap<(usize, u32), Vec<usize>> = BTreeMap::new();
    for (i, stair) in stairs.iter().enumerate().filter(|(_, s)| !s.storeys.contains(&own)) {
        for (storey, vertices) in stair.storeys.iter().zip(&stair.vertices) {
            vertices.iter().for_each(|v| at.entry((*storey, *v)).or_default().push(i));
        }
    }
    let leading = stairs.iter().filter_map(|s| Some((s, s.from(own)?[1])));
    let steps: Vec<Vec<Vec<u32>>> =
        leading.map(|(s, (storey, k))| walk(graphs, stairs, &at, (storey, &s.vertices[k]))).collect();
    let mut out: BTreeMap<Vec<u32>, u32> = BTreeMap::new();
    for (storey, graph) in graphs.iter().enumerate().filter(|(storey, _)| *storey != own) {
        for v in 0..graph.map_or(0, Graph::len) {
            let from_each: Vec<u32> = steps.iter().map(|s| s[storey][v]).collect();
            if from_each.iter().any(|s| *s != NEVER) {
                *out.entry(from_each).or_default() += 1;
            }
        }
    }
    out.into_iter().collect()
}

/// Steps to every vertex of every storey: one to those that a stair leads to, then by sight and over the stairs at vertices.
fn walk(
    graphs: &[Option<&Graph>],
    stairs: &[Stair],
    at: &BTreeMap<(usize, u32), Vec<usize>>,
    (storey, first): (usize, &[u32]),
) -> Vec<Vec<u32>> {
    let mut steps: Vec<Vec<u32>> = graphs.iter().map(|g| vec![NEVER; g.map_or(0, Graph::len)]).collect();
    let mut queue = VecDeque::new();
    let mut reach = |storey: usize, v: u32, step: u32, queue: &mut VecDeque<(usize, u32, u32)>| {
        let sees = |graph: &Graph| graph.degree(v) > 0;
        if let Some(known) = steps[storey].get_mut(v as usize)
            && *known == NEVER
            && graphs[storey].is_some_and(sees)
        {
            *known = step;
            queue.push_back((storey, v, step));
        }
    };
    first.iter().for_each(|v| reach(storey, *v, 1, &mut queue));
    while let Some((storey, v, step)) = queue.pop_front() {
        if let Some(graph) = graphs[storey] {
            graph.for_each_neighbour(v, |to| reach(storey, to, step + 1, &mut queue));
        }
        for &i in at.get(&(storey, v)).into_iter().flatten() {
            if let Some([_, (other, k)]) = stairs[i].from(storey) {
                stairs[i].vertices[k].iter().for_each(|to| reach(other, *to, step + 1, &mut queue));
            }
        }
    }
    steps
}

impl Beyond {
    /// Steps from each stair to every vertex of the measured storey. Who sees nobody stands on none.
    pub(super) fn steps(&self, graph: &Graph) -> Vec<Vec<u32>> {
        let from = |stair: &Vec<u32>| {
            let seeing: Vec<u32> = stair.iter().copied().filter(|v| graph.degree(*v) > 0).collect();
            graph.steps_from(&seeing)
        };
        self.stairs.iter().map(from).collect()
    }

    /// How many vertices there are.
    pub fn vertices(&self) -> u64 {
        self.far.iter().map(|(_, count)| u64::from(*count)).sum()
    }

    /// Adds what is reached over the stairs to the vertices per level 1.. of some roots, up to `max_level`. `steps`: from
    /// each stair to every vertex.
    pub(super) fn add_to<'a>(
        &self,
        steps: &[Vec<u32>],
        trees: impl Iterator<Item = (u32, &'a mut Vec<u32>)>,
        max_level: u32,
    ) {
        // Few vertices differ in their steps to the stairs.
        let mut known: BTreeMap<Vec<u32>, Vec<u32>> = BTreeMap::new();
        for (root, levels) in trees {
            let to_stairs: Vec<u32> = steps.iter().map(|s| s[root as usize]).collect();
            let added =
                known.entry(to_stairs).or_insert_with_key(|to_stairs| self.levels(to_stairs, max_level));
            if levels.len() < added.len() {
                levels.resize(added.len(), 0);
            }
            levels.iter_mut().zip(&*added).for_each(|(own, more)| *own += more);
        }
    }

    /// Vertices per level 1.. of who is so many steps from each stair.
    fn levels(&self, to_stairs: &[u32], max_level: u32) -> Vec<u32> {
        let mut out = Vec::new();
        for (from_stairs, count) in &self.far {
            let ways = to_stairs.iter().zip(from_stairs).filter(|(a, b)| **a != NEVER && **b != NEVER);
            let Some(level) =
                ways.map(|(a, b)| a.saturating_add(*b)).min().filter(|level| *level <= max_level)
            else {
                continue;
            };
            let level = level as usize;
            if out.len() < level {
                out.resize(level, 0);
            }
            out[level - 1] += count;
        }
        out
    }

    /// [`add_to`](Self::add_to) for every tree of a tally; who sees nobody keeps none.
    pub(super) fn add_to_tally(&self, steps: &[Vec<u32>], query: &[u32], tally: &mut Tally) {
        let mut at = 0;
        let mut trees: Vec<Vec<u32>> = Vec::with_capacity(query.len());
        for depth in &tally.depth {
            trees.push(tally.levels[at..at + *depth as usize].to_vec());
            at += *depth as usize;
        }
        self.add_to(steps, query.iter().copied().zip(&mut trees), NEVER);
        tally.depth = trees.iter().map(|t| t.len() as u32).collect();
        tally.levels = trees.into_iter().flatten().collect();
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::{Lattice, Obstacles, fixtures, forest, visibility};
    use super::*;

    /// Levels of a root of the first storey in one graph of all: by a queue over pairs, ways between two vertices of
    /// the first storey by sight alone.
    fn by_queue(graphs: &[&Graph], stairs: &[Stair], root: u32) -> Vec<u32> {
        let own = graphs[0].steps_from(&[root]);
        let mut steps: Vec<Vec<u32>> = graphs.iter().map(|g| vec![NEVER; g.len()]).collect();
        steps[0] = own;
        loop {
            let mut is_new = false;
            let mut relax = |steps: &mut Vec<Vec<u32>>, s: usize, v: u32, step: u32| {
                if s != 0 && graphs[s].degree(v) > 0 && step < steps[s][v as usize] {
                    steps[s][v as usize] = step;
                    is_new = true;
                }
            };
            for s in 0..graphs.len() {
                for v in 0..graphs[s].len() as u32 {
                    let at = steps[s][v as usize];
                    if at == NEVER || graphs[s].degree(v) == 0 {
                        continue;
                    }
                    let mut seen = Vec::new();
                    graphs[s].for_each_neighbour(v, |to| seen.push(to));
                    seen.into_iter().for_each(|to| relax(&mut steps, s, to, at + 1));
                    for stair in stairs {
                        for k in [0, 1] {
                            if stair.storeys[k] == s && stair.vertices[k].contains(&v) {
                                for to in &stair.vertices[1 - k] {
                                    relax(&mut steps, stair.storeys[1 - k], *to, at + 1);
                                }
                            }
                        }
                    }
                }
            }
            if !is_new {
                break;
            }
        }
        let mut levels = Vec::new();
        for (s, of) in steps.iter().enumerate() {
            for (v, step) in of.iter().enumerate() {
                if *step != NEVER && *step > 0 && !(s == 0 && v as u32 == root) {
                    levels.resize(levels.len().max(*step as usize), 0);
                    levels[*step as usize - 1] += 1;
                }
            }
        }
        levels
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

        /// Three storeys and stairs anywhere, against one walk through all of them.
        #[test]
        fn trees_go_over_stairs(
            storeys in prop::collection::vec(fixtures::mazes(9), 3),
            places in prop::collection::vec((0usize..3, 1usize..3, prop::collection::vec(any::<(u32, u32)>(), 1..4)), 1..4),
        ) {
            let graphs: Vec<Graph> = storeys.iter().map(|(l, o)| visibility::visibility_graph(l, o)).collect();
            let graphs: Vec<&Graph> = graphs.iter().collect();
            let stair = |(a, up, vertices): &(usize, usize, Vec<(u32, u32)>)| {
                let pair = [*a, (*a + up) % 3];
                let side = |k: usize| {
                    let of = |v: &(u32, u32)| [v.0, v.1][k] % graphs[pair[k]].len() as u32;
                    let mut side: Vec<u32> = vertices.iter().map(of).collect();
                    side.sort_unstable();
                    side.dedup();
                    side
                };
                Stair { storeys: pair, vertices: [side(0), side(1)] }
            };
            let stairs: Vec<Stair> = places.iter().map(stair).collect();
            let own: Vec<Vec<u32>> =
                stairs.iter().filter_map(|s| Some(s.vertices[s.from(0)?[0].1].clone())).collect();
            let beyond = Beyond { stairs: own, far: far(&graphs.iter().copied().map(Some).collect::<Vec<_>>(), &stairs, 0) };
            let joined = Lattice { beyond: Some(beyond.into()), ..storeys[0].0.clone() };
            let tally = forest::tally(&joined, graphs[0], None);
            let mut at = 0;
            for (v, depth) in joined.query.iter().zip(&tally.depth) {
                let levels = &tally.levels[at..at + *depth as usize];
                at += *depth as usize;
                if graphs[0].degree(*v) > 0 {
                    prop_assert_eq!(levels, by_queue(&graphs, &stairs, *v));
                }
            }
        }
    }

    /// Four vertices in a row on either storey, a stair at one end: who stands at it is a step from above.
    #[test]
    fn a_stair_is_one_step() {
        let row = |n: i32| fixtures::lattice(10, [0, 0], (0..n).map(|c| [c, 0]).collect());
        let (below, above) = (row(4), row(2));
        let [on, over] = [&below, &above].map(|l| visibility::visibility_graph(l, &Obstacles::default()));
        let stairs = [Stair { storeys: [0, 1], vertices: [vec![3], vec![0]] }];
        let beyond = Beyond { stairs: vec![vec![3]], far: far(&[None, Some(&over)], &stairs, 0) };
        assert_eq!(beyond.far, [(vec![1], 1), (vec![2], 1)]);
        assert_eq!(beyond.vertices(), 2);
        let tally = forest::tally(&Lattice { beyond: Some(beyond.into()), ..below }, &on, None);
        assert_eq!(tally.depth, [3, 3, 3, 2]);
        assert_eq!(tally.levels, [3, 1, 1, 3, 1, 1, 3, 1, 1, 4, 1]);
    }
}

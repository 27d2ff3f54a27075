//! What begins at every vertex by itself, in parts that are joined: trees, ways, isovists, sight lines.
//!
//! A part has whole numbers, or the values of its vertices themselves: joined they are what one machine has, bit for bit.

use super::forest::level_counts_beyond_of;
use super::graph::Graph;
use super::isovist::isovists;
use super::paths::{Paths, Turning};
use super::shares::{Share, Trees};
use super::through::sight_lines;
use super::{Lattice, Obstacles};

/// What of a graph is wanted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wanted {
    /// Trees of all vertices, not of those in the region of query alone.
    pub every_tree: bool,
    /// Shortest ways, up to some metres where that is said.
    pub metric: Option<Option<f64>>,
    /// Straightest ways, up to some right angles where that is said.
    pub angular: Option<Option<f64>>,
    /// Isovists.
    pub isovists: bool,
    /// Sight lines over every vertex.
    pub through: bool,
}

/// Values of some vertices.
pub type Rows<T> = Vec<(u32, T)>;

/// A part: what begins at the vertices of a share.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Part {
    /// Vertices on level 1, 2, … of their trees.
    pub trees: Rows<Vec<u32>>,
    /// As [`Paths::metric_rows`].
    pub metric: Rows<[f64; 4]>,
    /// As [`Paths::angular_rows`].
    pub angular: Rows<[f64; 3]>,
    /// As [`isovists`].
    pub isovists: Rows<[f64; 8]>,
    /// As [`sight_lines`], by vertex; empty where none are wanted.
    pub through: Vec<u64>,
}

/// The part that is a share. `obstacles` are those of the graph.
pub fn part(
    (lattice, graph, obstacles): (&Lattice, &Graph, &Obstacles),
    wanted: &Wanted,
    share: Share,
) -> Part {
    let roots = roots_of(lattice, wanted);
    let trees = level_counts_beyond_of(lattice, graph, &roots, u32::MAX, share);
    // Neighbours on the floor follow each other.
    let own = share.of(&graph.tiles.vertex_of);
    let paths = || Paths::new(lattice, graph, obstacles, Turning::default());
    let mut part = Part {
        trees: trees.into_iter().map(|(place, levels)| (roots[place as usize], levels)).collect(),
        ..Part::default()
    };
    part.trees.sort_unstable_by_key(|tree| tree.0);
    if let Some(radius_m) = wanted.metric {
        part.metric = rows(own, paths().metric_rows(own, radius_m));
    }
    if let Some(radius) = wanted.angular {
        part.angular = rows(own, paths().angular_rows(own, radius));
    }
    if wanted.isovists {
        part.isovists = rows(own, isovists(lattice, obstacles, own));
    }
    if wanted.through {
        part.through = sight_lines(lattice, graph, own);
    }
    part
}

fn roots_of(lattice: &Lattice, wanted: &Wanted) -> Vec<u32> {
    if wanted.every_tree { (0..lattice.cells.len() as u32).collect() } else { lattice.query.clone() }
}

fn rows<T>(vertices: &[u32], values: Vec<T>) -> Rows<T> {
    let mut rows: Rows<T> = vertices.iter().copied().zip(values).collect();
    rows.sort_unstable_by_key(|row| row.0);
    rows
}

/// All parts joined.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Walked {
    /// The trees.
    pub trees: Trees,
    /// By vertex, as all others; none where it was not wanted.
    pub metric: Option<Vec<[f64; 4]>>,
    /// Straightest ways.
    pub angular: Option<Vec<[f64; 3]>>,
    /// Isovists.
    pub isovists: Option<Vec<[f64; 8]>>,
    /// Sight lines over every vertex.
    pub through: Option<Vec<u64>>,
}

/// Parts that are being joined, of so many vertices.
#[derive(Debug, Default)]
pub struct Joining {
    trees: Vec<Option<Vec<u32>>>,
    metric: Vec<Option<[f64; 4]>>,
    angular: Vec<Option<[f64; 3]>>,
    isovists: Vec<Option<[f64; 8]>>,
    through: Vec<u64>,
}

impl Joining {
    /// Nothing yet of a lattice of so many vertices.
    pub fn new(vertices: usize) -> Self {
        Self {
            trees: vec![None; vertices],
            metric: vec![None; vertices],
            angular: vec![None; vertices],
            isovists: vec![None; vertices],
            through: Vec::new(),
        }
    }

    /// Takes in a part; whether all its vertices are of the lattice and were in no other.
    pub fn add(&mut self, part: Part) -> bool {
        let vertices = self.trees.len();
        let is_sized = part.through.is_empty() || part.through.len() == vertices;
        if !part.through.is_empty() {
            self.through.resize(vertices, 0);
        }
        self.through.iter_mut().zip(&part.through).for_each(|(all, own)| *all = all.saturating_add(*own));
        is_sized
            && put(&mut self.trees, part.trees)
            && put(&mut self.metric, part.metric)
            && put(&mut self.angular, part.angular)
            && put(&mut self.isovists, part.isovists)
    }

    /// What was joined; of what is missing of some vertices there is nothing, but trees by vertex.
    pub fn joined(self) -> Walked {
        Walked {
            trees: Trees::new(self.trees),
            metric: all_of(self.metric),
            angular: all_of(self.angular),
            isovists: all_of(self.isovists),
            through: (!self.through.is_empty()).then_some(self.through),
        }
    }
}

fn put<T>(into: &mut [Option<T>], rows: Rows<T>) -> bool {
    let place = |(v, value): (u32, T)| into.get_mut(v as usize).is_some_and(|at| at.replace(value).is_none());
    rows.into_iter().all(place)
}

fn all_of<T>(values: Vec<Option<T>>) -> Option<Vec<T>> {
    values.into_iter().collect()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::isovist::{isovist_columns, isovist_columns_from};
    use super::super::measures::{global_columns, global_columns_beside};
    use super::super::path_columns::{angular_columns_from, metric_columns_from};
    use super::super::stairs::Beyond;
    use super::super::through::{through_vision_column, through_vision_column_from};
    use super::super::{fixtures, visibility};
    use super::*;

    proptest! {
        #![proptest_config(ProptestConfig { cases: 16, ..ProptestConfig::default() })]

        /// Any number of parts, joined in any order, has the columns of one machine, bit for bit.
        #[test]
        fn parts_have_the_columns_of_the_whole(
            (mut lattice, obstacles) in fixtures::mazes(24),
            (shares, every_tree, stairs) in (1u32..9, any::<bool>(), any::<bool>()),
            radius in prop_oneof![Just(None), Just(Some(3.0))],
        ) {
            lattice.query.retain(|v| v % 4 != 1);
            if stairs {
                let far = vec![(vec![1], 2), (vec![2], 5)];
                lattice.beyond = Some(Beyond { stairs: vec![vec![0, 1]], far }.into());
            }
            let graph = visibility::visibility_graph(&lattice, &obstacles);
            let here = (&lattice, &graph, &obstacles);
            let wanted = Wanted {
                every_tree, metric: Some(radius), angular: Some(radius), isovists: true, through: true,
            };
            let mut joining = Joining::new(graph.len());
            let parts: Vec<Part> = Share::all(shares).map(|share| part(here, &wanted, share)).collect();
            for part in parts.into_iter().rev() {
                prop_assert!(joining.add(part));
            }
            let walked = joining.joined();
            prop_assert!(roots_of(&lattice, &wanted).iter().all(|v| walked.trees.levels(*v).is_some()));
            let paths = Paths::new(&lattice, &graph, &obstacles, Turning::default());
            prop_assert_eq!(metric_columns_from(&walked.metric.unwrap(), radius), paths.metric_columns(radius));
            prop_assert_eq!(angular_columns_from(&walked.angular.unwrap(), radius), paths.angular_columns(radius));
            prop_assert_eq!(isovist_columns_from(&walked.isovists.unwrap()), isovist_columns(&lattice, &obstacles));
            let through = through_vision_column_from(&walked.through.unwrap());
            prop_assert_eq!(through, through_vision_column(&lattice, &graph));
            for levels in [None, Some(1), Some(3)] {
                let beside = global_columns_beside(&lattice, &graph, |v| walked.trees.levels(v), levels);
                prop_assert_eq!(beside, global_columns(&lattice, &graph, levels));
            }
        }
    }

    /// A part that is missing, is there twice or is of another lattice is no part of a whole.
    #[test]
    fn parts_are_a_whole_once() {
        let (lattice, obstacles) = fixtures::rooms(3, 2);
        let graph = visibility::visibility_graph(&lattice, &obstacles);
        let wanted = Wanted { metric: Some(None), ..Wanted::default() };
        let of = |share: Share| part((&lattice, &graph, &obstacles), &wanted, share);
        let [a, b] = [0, 1].map(|number| of(Share::new(number, 2).unwrap()));
        let mut some = Joining::new(graph.len());
        assert!(some.add(a.clone()) && !some.add(a.clone()));
        let some = some.joined();
        assert!(some.metric.is_none() && lattice.query.iter().any(|v| some.trees.levels(*v).is_none()));
        assert!(!Joining::new(graph.len() / 2).add(b.clone()));
        let mut all = Joining::new(graph.len());
        assert!(all.add(b) && all.add(a));
        assert!(all.joined().metric.is_some());
    }
}

//! Visibility-graph analysis: the lattice, who sees whom, the breadth-first forest, the measures.
//!
//! Works on whole micrometres and cell numbers only; knows no walls, files or optimisers.
//!
//! Six cells of a square metre, and a screen between the two of the lower row on the left:
//!
//! ```
//! use enfilade_engine::geometry::Segment;
//! use enfilade_engine::measures::columns;
//! use enfilade_engine::visibility::visibility_graph;
//! use enfilade_engine::{Lattice, Obstacles};
//!
//! let cells: Vec<[i32; 2]> = (0..3).flat_map(|column| [[column, 0], [column, 1]]).collect();
//! let lattice = Lattice {
//!     spacing_um: 1_000_000,
//!     origin_um: [0, 0],
//!     cells,
//!     query: (0..6).collect(),
//!     is_reference: vec![true; 6],
//!     beyond: None,
//! };
//! let screen = Segment { a: [500_000, -500_000], b: [500_000, 500_000] };
//! let graph = visibility_graph(&lattice, &Obstacles { segments: vec![screen], blind: vec![] });
//!
//! // Behind the screen only the cell above is seen; from there it is a step to three, and two to the last.
//! assert_eq!((graph.degree(0), graph.degree(1)), (1, 4));
//! let measured = columns(&lattice, &graph, None);
//! let depth = measured.iter().find(|c| c.name == "Visual Mean Depth").map(|c| c.values[0]);
//! assert_eq!(depth, Some((1.0 + 3.0 * 2.0 + 3.0) / 5.0));
//! ```

pub mod lattice;

pub use region::Region;

use std::sync::Arc;

use geometry::{PointUm, Segment};

mod bit_rows;
mod bundle;
mod corners;
mod dense;
pub mod evaluator;
#[cfg(test)]
pub(crate) mod fixtures;
pub mod forest;
pub mod geometry;
#[cfg(feature = "gpu")]
pub mod gpu;
#[cfg(not(feature = "gpu"))]
#[path = "no_gpu.rs"]
pub mod gpu;
pub mod graph;
mod halves;
pub mod interior;
pub mod isovist;
mod lanes;
pub mod measures;
mod offsets;
mod order;
pub mod path_columns;
#[cfg(test)]
mod path_columns_tests;
pub mod paths;
mod queue;
mod refusal;
mod region;
mod relays;
pub mod sampled;
pub mod shares;
mod shortest;
pub mod stairs;
mod stars;
mod straightest;
mod strips;
pub mod through;
mod tiles;
pub mod visibility;
pub mod walked;
mod wave;

/// The cells of a study: a square lattice, the vertices `V = V_q ∪ V_r` on it, and both regions.
///
/// Cell `[col, row]` has its centre at `origin_um + [col, row] * spacing_um`. Vertices are sorted by
/// column, then row (depthmapX's `Ref` order); all other arrays index into `cells`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Lattice {
    /// Distance between neighbouring centres, > 0, micrometres.
    pub spacing_um: i64,
    /// Centre of cell `[0, 0]`.
    pub origin_um: PointUm,
    /// Column and row of every vertex.
    pub cells: Vec<[i32; 2]>,
    /// Vertices of the region of query, ascending.
    pub query: Vec<u32>,
    /// Whether each vertex lies in the region of reference.
    pub is_reference: Vec<bool>,
    /// Other storeys of the building, over stairs; none: trees stay on these cells.
    pub beyond: Option<Arc<stairs::Beyond>>,
}

impl Lattice {
    /// Centre of vertex `v`.
    pub fn centre_um(&self, v: usize) -> PointUm {
        let [c, r] = self.cells[v];
        [
            self.origin_um[0] + i64::from(c) * self.spacing_um,
            self.origin_um[1] + i64::from(r) * self.spacing_um,
        ]
    }
}

/// What one layout does to the query region; everything an objective needs, as integers.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Neighbours within `V_r`, per query vertex.
    pub degree: Vec<u32>,
    /// All neighbours, per query vertex.
    pub degree_all: Vec<u32>,
    /// Last level that is not empty, per query vertex (0: isolated).
    pub depth: Vec<u32>,
    /// Vertices per level 1.. of each query vertex, concatenated; `depth[i]` entries belong to `i`.
    pub levels: Vec<u32>,
    /// Σ over query vertices of the vertices reached in the initial layout and not now.
    pub disconnected: u64,
}

impl Tally {
    /// The trees by vertex of the lattice, none of those outside the region of query.
    pub fn trees(&self, lattice: &Lattice) -> Vec<Option<&[u32]>> {
        let mut trees = vec![None; lattice.cells.len()];
        let mut at = 0;
        for (v, depth) in lattice.query.iter().zip(&self.depth) {
            trees[*v as usize] = self.levels.get(at..at + *depth as usize);
            at += *depth as usize;
        }
        trees
    }
}

/// Sight-blocking input of one layout.
#[derive(Clone, Debug, Default)]
pub struct Obstacles {
    /// Segments that block sight, touch counts.
    pub segments: Vec<Segment>,
    /// Vertices that see nothing because a solid covers them or a wall that moves stands on them.
    pub blind: Vec<u32>,
}

//! Evaluation of many layouts of one plan: what never moves is prepared once.

use std::sync::Arc;

use crate::plan::geometry::Segment;

use super::forest::tally;
use super::visibility::visibility_graph_serial;
use super::{Lattice, Obstacles, Tally};

/// Evaluates layouts that share a lattice and the walls that do not move; share it between threads
/// and give each thread a [`Scratch`].
pub struct Evaluator {
    lattice: Arc<Lattice>,
    fixed: Vec<Segment>,
    initial: Tally,
    initial_components: Vec<u32>,
}

/// Buffers of one thread.
pub struct Scratch {
    obstacles: Obstacles,
}

impl Evaluator {
    /// `fixed` blocks sight in every layout; `initial_moving` is the rest of the initial layout,
    /// against which cut-off vertices are counted.
    pub fn new(lattice: Arc<Lattice>, fixed: &[Segment], initial_moving: &Obstacles) -> Self {
        let mut new = Self {
            lattice,
            fixed: fixed.to_vec(),
            initial: Tally::default(),
            initial_components: Vec::new(),
        };
        let mut scratch = new.scratch();
        new.fill(initial_moving, &mut scratch);
        let graph = visibility_graph_serial(&new.lattice, &scratch.obstacles);
        new.initial_components = graph.components();
        new.initial = tally(&new.lattice, &graph, Some(&new.initial_components));
        new
    }

    /// Buffers for one thread.
    pub fn scratch(&self) -> Scratch {
        Scratch { obstacles: Obstacles::default() }
    }

    /// The initial layout.
    pub fn initial(&self) -> &Tally {
        &self.initial
    }

    /// The same bits as [`tally`] of the whole layout's visibility graph; single-threaded.
    pub fn evaluate(&self, moving: &Obstacles, scratch: &mut Scratch) -> Tally {
        self.fill(moving, scratch);
        let graph = visibility_graph_serial(&self.lattice, &scratch.obstacles);
        tally(&self.lattice, &graph, Some(&self.initial_components))
    }

    fn fill(&self, moving: &Obstacles, scratch: &mut Scratch) {
        let all = &mut scratch.obstacles;
        all.segments.clear();
        all.segments.extend_from_slice(&self.fixed);
        all.segments.extend_from_slice(&moving.segments);
        all.blind.clone_from(&moving.blind);
    }
}

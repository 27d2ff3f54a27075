//! Stands where [`gpu`](crate::gpu) does in a build without graphics cards: the same calls, and always a refusal.

use std::sync::Arc;

pub use crate::refusal::Refusal;

/// There is none.
pub enum Gpu {}

impl Gpu {
    /// Refuses.
    ///
    /// # Errors
    /// Always: this build has no support for graphics cards.
    pub fn shared(_software: bool) -> Result<Arc<Self>, Refusal> {
        Err(Refusal::Absent("this build of the program uses no graphics card (feature `gpu`)".into()))
    }

    /// Name of the adapter.
    pub fn name(&self) -> &str {
        match *self {}
    }

    /// Whether the adapter is one in software.
    pub fn is_software(&self) -> bool {
        match *self {}
    }
}

/// Trees on a card.
pub mod forest {
    use std::sync::Arc;

    use super::Gpu;
    use crate::graph::Graph;
    use crate::{Lattice, Obstacles, Tally};

    /// There is none.
    pub enum CardForest {}

    impl CardForest {
        /// Never called: nothing gives a [`Gpu`].
        ///
        /// # Errors
        /// None.
        pub fn new(
            gpu: Arc<Gpu>,
            _lattice: Arc<Lattice>,
            _graph: &Graph,
            _components: Option<&[u32]>,
            _layouts: u32,
        ) -> Result<Self, String> {
            match *gpu {}
        }

        /// The card.
        pub fn gpu(&self) -> &Gpu {
            match *self {}
        }

        /// Tallies of some layouts.
        ///
        /// # Errors
        /// None.
        pub fn tallies(&self, _layouts: &[Obstacles]) -> Result<Vec<Tally>, String> {
            match *self {}
        }
    }
}

//! What was measured of present layouts elsewhere, in parts: found again by what the parts were made of.

use std::sync::Arc;

use sha2::{Digest, Sha256};

use enfilade_engine::walked::Walked;
use enfilade_engine::{Lattice, Obstacles};

/// Digest of cells, regions, stairs and what blocks sight: equal where a part has the same values.
pub type Print = [u8; 32];

/// The [`Print`] of a lattice; `obstacles` in the order in which the study has them.
pub(crate) fn print(lattice: &Lattice, obstacles: &Obstacles) -> Print {
    let mut hash = Sha256::new();
    let mut put = |values: &mut dyn Iterator<Item = i64>| {
        let mut count = 0u64;
        for value in values {
            hash.update(value.to_le_bytes());
            count += 1;
        }
        hash.update(count.to_le_bytes());
    };
    let [x, y] = lattice.origin_um;
    put(&mut [lattice.spacing_um, x, y].into_iter());
    put(&mut lattice.cells.iter().flatten().map(|c| i64::from(*c)));
    put(&mut lattice.query.iter().map(|v| i64::from(*v)));
    put(&mut obstacles.segments.iter().flat_map(|s| [s.a, s.b]).flatten());
    put(&mut obstacles.blind.iter().map(|v| i64::from(*v)));
    if let Some(beyond) = &lattice.beyond {
        for stair in &beyond.stairs {
            put(&mut stair.iter().map(|v| i64::from(*v)));
        }
        for (steps, count) in &beyond.far {
            put(&mut steps.iter().chain([count]).map(|v| i64::from(*v)));
        }
    }
    hash.finalize().into()
}

/// All parts of an analysis, joined.
#[derive(Clone, Debug, Default)]
pub struct Known(pub(crate) Vec<(Print, Arc<Walked>)>);

impl Known {
    /// What was walked of a lattice; none where that is not of the parts, or not all of it.
    pub(crate) fn of(&self, print: &Print, lattice: &Lattice) -> Option<Arc<Walked>> {
        let found = &self.0.iter().find(|(own, _)| own == print)?.1;
        let is_whole = lattice.query.iter().all(|v| found.trees.levels(*v).is_some());
        is_whole.then(|| Arc::clone(found))
    }
}

/// Whose breadth-first trees a look at the present layout walks.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Forest<'a> {
    /// Everyone's.
    Every,
    /// About so many, from which depth and entropy are estimated.
    Roots(usize),
    /// Nobody's: the cells and who sees whom are asked for alone.
    Nobody,
    /// Everyone's, walked before.
    Known(&'a Known),
}

impl Forest<'_> {
    /// How many roots are asked for, where not everyone is one.
    pub(crate) fn roots(self) -> Option<usize> {
        if let Self::Roots(roots) = self { Some(roots) } else { None }
    }
}

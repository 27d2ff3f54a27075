//! Other storeys of the building, where steps are counted over the stairs: what trees of the measured one reach on them.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::sync::{Arc, Mutex};

use rayon::prelude::*;

use crate::understand::understood::Understood;
use enfilade_config::Settings;
use enfilade_engine::geometry::PointUm;
use enfilade_engine::lattice::CellIndex;
use enfilade_engine::stairs::{Beyond, Far, Stair, far};
use enfilade_engine::visibility::Graph;

/// A storey as it is drawn, ready to be laid out with cells.
pub(crate) struct Floor {
    /// What `--storey` calls it.
    pub key: String,
    pub base: Arc<Understood>,
    pub settings: Settings,
}

/// Where a stair stands on two storeys, by their places in the list.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Footprint {
    pub storeys: [usize; 2],
    /// Its outline, drawing frame.
    pub ring: Vec<PointUm>,
}

impl Footprint {
    fn vertices(&self, cells: &CellIndex) -> Vec<u32> {
        let mut out = Vec::new();
        cells.vertices_in(&self.ring, &mut out);
        out.sort_unstable();
        out
    }
}

/// The storeys of a building from the lowest, with their stairs.
pub(crate) struct Building {
    pub floors: Vec<Floor>,
    pub stairs: Vec<Footprint>,
    /// Whether these are all its storeys: of very many the nearest are joined.
    pub is_whole: bool,
}

/// Spacing and centre of cells.
pub(crate) type Cells = (i64, PointUm);

/// The building of a storey that is measured.
#[derive(Clone)]
pub struct Floors {
    building: Arc<Building>,
    /// Which of its floors is measured.
    own: usize,
    /// What lies beyond, by spacing and centre of the cells.
    known: Arc<Mutex<BTreeMap<Cells, Arc<Laid>>>>,
}

/// The other storeys on one lattice.
pub(crate) struct Laid {
    far: Far,
    /// Those that stairs lead to, ascending.
    reached: Vec<usize>,
    /// The stairs of the measured storey.
    stairs: Vec<Footprint>,
}

impl Laid {
    /// What lies beyond the stairs of the measured storey, of which these are the cells; none where no stair stands on
    /// any.
    pub fn beyond(&self, cells: &CellIndex) -> Option<Beyond> {
        let stairs: Vec<Vec<u32>> = self.stairs.iter().map(|s| s.vertices(cells)).collect();
        let stands = stairs.iter().any(|s| !s.is_empty()) && !self.far.is_empty();
        stands.then(|| Beyond { stairs, far: self.far.clone() })
    }
}

/// What lays out the other storeys, where steps are counted over the stairs: only for cells that there are.
pub(crate) type Over<'a> = &'a (dyn Fn() -> Option<Arc<Laid>> + Sync);

/// The storeys that stairs lead to from one, over others too; where it is left itself is asked of its own cells.
fn joined(stairs: &[Stair], own: usize) -> Vec<usize> {
    let stands = |s: &&Stair| (0..2).all(|k| s.storeys[k] == own || !s.vertices[k].is_empty());
    let standing: Vec<&Stair> = stairs.iter().filter(stands).collect();
    let mut reached = BTreeSet::from([own]);
    for _ in &standing {
        for s in standing.iter().filter(|s| s.storeys.iter().any(|i| reached.contains(i))).collect::<Vec<_>>()
        {
            reached.extend(s.storeys);
        }
    }
    reached.remove(&own);
    reached.into_iter().collect()
}

impl fmt::Debug for Floors {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Floors").field("own", &self.own).field("stairs", &self.building.stairs).finish()
    }
}

impl Floors {
    pub(crate) fn new(building: Arc<Building>, own: usize) -> Self {
        Self { building, own, known: Arc::default() }
    }

    /// The same building, another storey of it measured; none of a name that it has not, nor where others may be nearer to
    /// that one.
    pub(crate) fn on(&self, key: &str) -> Option<Self> {
        if !self.building.is_whole {
            return None;
        }
        let own = self.building.floors.iter().position(|f| f.key == key)?;
        Some(Self::new(Arc::clone(&self.building), own))
    }

    /// Whether it has stairs to other storeys.
    pub(crate) fn has_stairs(&self) -> bool {
        self.building.stairs.iter().any(|s| s.storeys.contains(&self.own))
    }

    /// The storey above the measured one.
    pub(crate) fn above(&self) -> Option<(String, Arc<Understood>)> {
        let floor = self.building.floors.get(self.own + 1)?;
        Some((floor.key.clone(), Arc::clone(&floor.base)))
    }

    /// The storeys that the stairs lead to, over others too, on the first lattice that was laid.
    pub(crate) fn reached(&self) -> Vec<&str> {
        let known = self.known.lock().ok().and_then(|known| known.values().next().cloned());
        let reached = known.map_or_else(Vec::new, |k| k.reached.clone());
        reached.into_iter().filter_map(|i| Some(self.building.floors.get(i)?.key.as_str())).collect()
    }

    /// The other storeys on cells of a spacing and a centre, micrometres of the drawing frame; `lay` tells who sees whom on one of
    /// them, none where it has no such cells.
    pub(crate) fn laid(
        &self,
        at: Cells,
        lay: impl Fn(&Floor) -> Option<(Graph, CellIndex)> + Sync,
    ) -> Arc<Laid> {
        if let Some(known) = self.known.lock().ok().and_then(|known| known.get(&at).cloned()) {
            return known;
        }
        let Building { floors, stairs, .. } = &*self.building;
        let others = floors.par_iter().enumerate().map(|(i, f)| if i == self.own { None } else { lay(f) });
        let laid: Vec<Option<(Graph, CellIndex)>> = others.collect();
        let stair = |s: &Footprint| {
            let vertices = s.storeys.map(|i| laid[i].as_ref().map_or_else(Vec::new, |l| s.vertices(&l.1)));
            Stair { storeys: s.storeys, vertices }
        };
        let ties: Vec<Stair> = stairs.iter().map(stair).collect();
        let graphs: Vec<Option<&Graph>> = laid.iter().map(|l| l.as_ref().map(|l| &l.0)).collect();
        let found = Arc::new(Laid {
            far: far(&graphs, &ties, self.own),
            reached: joined(&ties, self.own),
            stairs: stairs.iter().filter(|s| s.storeys.contains(&self.own)).cloned().collect(),
        });
        if let Ok(mut known) = self.known.lock() {
            known.insert(at, Arc::clone(&found));
        }
        found
    }
}

//! What people see: the unnamed pair of regions and every named one, each with its own cells and graph.
//!
//! A named pair measures exactly what it would measure if its regions were the only ones drawn.

use std::sync::Arc;

use crate::measure::floors::Over;
use crate::measure::known::{Known, Print, print};
use crate::measure::obstacles::blind;
use crate::understand::understood::Understood;
use enfilade_config::{Measure, Source};
use enfilade_engine::evaluator::Evaluator;
use enfilade_engine::geometry::UM_PER_M;
use enfilade_engine::gpu::Gpu;
use enfilade_engine::isovist::query_isovists;
use enfilade_engine::lattice::{CellIndex, Ground, lattice};
use enfilade_engine::measures::{Column, Means, local_columns, means};
use enfilade_engine::paths::{Paths, Turning};
use enfilade_engine::shares::Trees;
use enfilade_engine::through::through_vision_column;
use enfilade_engine::visibility::{Graph, bytes_beyond, visibility_graph};
use enfilade_engine::walked::Walked;
use enfilade_engine::{Lattice, Obstacles, Tally};
use enfilade_moves::Layout;
use enfilade_report::{Error, Place, Report};

/// Most memory that a run may take for its visibility graph, bytes: 100,000 vertices fit that all see each other, and
/// a million where few do. More would be taken from the machine until it stops.
pub const GRAPH_BYTES_MAX: u64 = 8 << 30;

/// Share of [`GRAPH_BYTES_MAX`] that a spacing which is recommended may take.
const ADVISED_SHARE: f64 = 0.8;
/// By how much a spacing that would not do yet is widened.
const WIDER: f64 = 1.1;
/// Cells from which on a card that is asked for walks the trees of the present layout: a core takes a tenth of a second or
/// more for so many.
const CARD_CELLS_MIN: usize = 15_000;
/// Spacings tried for one to recommend.
const TRIES: usize = 8;

/// Refuses a lattice whose graph under what never moves would take more memory than [`GRAPH_BYTES_MAX`].
fn refuse_dense(lattice: &Lattice, ground: &Ground<'_>) -> Result<(), Error> {
    let Some(bytes) = bytes_of(lattice, ground, GRAPH_BYTES_MAX) else { return Ok(()) };
    let gib = |bytes: u64| bytes as f64 / (1u64 << 30) as f64;
    let text = format!(
        "spacing {} m gives {} vertices that see so many others that with their visibility graph a run would take about \
         {:.1} GiB, expected at most {} GiB; nothing was measured; choose a larger --spacing (about {} m would do) or \
         smaller regions (EF-QUERY and EF-REFERENCE, --query)",
        lattice.spacing_um as f64 / UM_PER_M,
        lattice.cells.len(),
        gib(bytes),
        gib(GRAPH_BYTES_MAX),
        format!("{:.3}", advised_m(bytes, ground)).trim_end_matches('0').trim_end_matches('.')
    );
    Err(Error::input("graph-bytes-max", Place::file(ground.file), text))
}

fn bytes_of(lattice: &Lattice, ground: &Ground<'_>, limit: u64) -> Option<u64> {
    bytes_beyond(lattice, &Obstacles { segments: ground.fixed.to_vec(), blind: Vec::new() }, limit)
}

/// A spacing, metres, at which a run takes well less than [`GRAPH_BYTES_MAX`], where `bytes` are needed now.
fn advised_m(bytes: u64, ground: &Ground<'_>) -> f64 {
    let most = ADVISED_SHARE * GRAPH_BYTES_MAX as f64;
    // Vertices grow with the square of the fineness, and so does what each of them sees, at most.
    let mut wider = ground.spacing_um as f64 / UM_PER_M * (bytes as f64 / most).powf(0.25);
    for _ in 0..TRIES {
        let digit = 10f64.powf(wider.log10().floor() - 1.0);
        wider = (wider / digit).ceil() * digit;
        let spacing_um = (wider * UM_PER_M).round() as i64;
        let coarser = lattice(&Ground { spacing_um, ..ground.clone() }, &mut Report::default());
        if coarser.is_ok_and(|l| bytes_of(&l, ground, most as u64).is_none()) {
            break;
        }
        wider *= WIDER;
    }
    wider
}

/// What a region of query has in one layout.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Seen {
    /// Integer results of every query vertex.
    pub tally: Tally,
    /// Positions within the region of query of the vertices that what moves covers, ascending: floor that is
    /// not there, of no measure.
    pub covered: Vec<u32>,
    /// Means over the query vertices that are not covered.
    pub means: Means,
    /// Where trees were walked from some roots alone: what the tally has of them, and how sure the means are.
    pub estimated: Option<Estimated>,
    /// Area, perimeter, compactness, occlusivity, drift, longest and shortest radial of the isovist of every
    /// query vertex; empty unless asked for.
    pub isovists: Vec<[f64; 7]>,
    /// Measures of the stored graph that were asked for, one value a query vertex, [`UNDEFINED`](enfilade_engine::measures::UNDEFINED) where there is
    /// none: so that two measurements can be compared.
    pub columns: Vec<(Measure, Vec<f64>)>,
}

/// What is known where trees were walked from some roots alone.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Estimated {
    /// Positions of the roots within the region of query, ascending.
    pub places: Vec<u32>,
    /// Half the widths of the 95 % intervals of mean depth and mean entropy.
    pub half_widths: [f64; 2],
}

/// A pair of regions made ready to be measured.
pub(crate) struct Scene {
    pub lattice: Arc<Lattice>,
    pub cells: CellIndex,
    pub components: Vec<u32>,
    pub evaluator: Evaluator,
    /// Edges of the present layout's visibility graph, each pair once.
    pub edges: u64,
    /// What is asked for beyond the tally.
    asked: Vec<Measure>,
    /// What was walked elsewhere.
    pub walked: Option<Arc<Walked>>,
    /// What parts of it are known by; none where it is neither done nor joined in parts.
    pub print: Option<Print>,
}

impl Scene {
    pub fn new(
        ground: &Ground<'_>,
        base: &Understood,
        identity: &Layout,
        asked: Vec<Measure>,
        (use_for, over, card): (Use<'_>, Over<'_>, Option<&Arc<Gpu>>),
        report: &mut Report,
    ) -> Result<Self, Error> {
        let mut lattice = lattice(ground, report)?;
        refuse_dense(&lattice, ground)?;
        let cells = CellIndex::new(&lattice);
        lattice.beyond = over().and_then(|laid| laid.beyond(&cells)).map(Arc::new);
        let lattice = Arc::new(lattice);
        let segments = ground.movable.to_vec();
        let moving = Obstacles { blind: blind(base, identity, &cells, &segments), segments };
        let in_parts = matches!(use_for, Use::Views | Use::Known(_));
        let print = in_parts.then(|| {
            let segments = [ground.fixed, &moving.segments].concat();
            print(&lattice, &Obstacles { segments, blind: moving.blind.clone() })
        });
        let walked = match (use_for, &print) {
            (Use::Known(known), Some(print)) => {
                Some(known.of(print, &lattice).ok_or_else(|| other_parts(ground))?)
            }
            _ => None,
        };
        let on_cores = || match use_for {
            Use::Views => Evaluator::unmeasured(Arc::clone(&lattice), ground.fixed, &moving),
            Use::Known(_) => {
                let trees = walked.as_deref().map(|w| &w.trees);
                Evaluator::walked(
                    Arc::clone(&lattice),
                    ground.fixed,
                    &moving,
                    trees.unwrap_or(&Trees::default()),
                )
            }
            Use::Roots(roots, seed) => {
                Evaluator::sampled(Arc::clone(&lattice), ground.fixed, &moving, (roots, seed))
            }
            Use::Search(roots) => {
                Evaluator::new(Arc::clone(&lattice), ground.fixed, &moving, own_roots(&lattice, roots))
            }
            Use::Few(roots) => {
                Evaluator::unprepared(Arc::clone(&lattice), ground.fixed, &moving, own_roots(&lattice, roots))
            }
        };
        let card =
            card.filter(|_| matches!(use_for, Use::Search(None)) && lattice.cells.len() >= CARD_CELLS_MIN);
        let on_card = card.map(|gpu| Evaluator::on_card(gpu, Arc::clone(&lattice), ground.fixed, &moving));
        let evaluator = match on_card {
            Some(Ok(walked)) => walked,
            Some(Err(why)) => {
                let text =
                    format!("{why}; the cores walk the trees of the present layout, with the same result");
                report.warn("backend-gpu", Place::file(ground.file), text);
                on_cores()
            }
            None => on_cores(),
        };
        let (edges, components) = (evaluator.initial_edges(), evaluator.initial_components().to_vec());
        let asked = if matches!(use_for, Use::Views) { Vec::new() } else { asked };
        Ok(Self { lattice, cells, components, evaluator, edges, asked, walked, print })
    }

    /// A layout's tally with what else is asked for; `blind` are the vertices that it covers, ascending,
    /// `obstacles` those of the whole layout.
    pub fn seen(&self, tally: Tally, blind: &[u32], obstacles: impl FnOnce() -> Obstacles) -> Seen {
        let covered = self.covered(blind);
        let sample = self.evaluator.sample();
        let (means, estimated) = match sample.map(|s| (s.means(&tally, &covered), s.places.clone())) {
            Some(((means, half_widths), places)) => (means, Some(Estimated { places, half_widths })),
            None => (means(&tally, covered.len()), None),
        };
        let mut out = Seen { means, estimated, tally, covered, ..Seen::default() };
        if self.asked.is_empty() {
            return out;
        }
        let obstacles = obstacles();
        if self.asked.iter().any(|m| m.source() == Source::Isovist) {
            out.isovists = query_isovists(&self.lattice, &obstacles);
        }
        if self.asked.iter().any(|m| m.source().is_of_graph()) {
            out.columns = self.columns(&visibility_graph(&self.lattice, &obstacles), &obstacles);
        }
        out
    }

    /// Where blind vertices stand within the region of query.
    fn covered(&self, blind: &[u32]) -> Vec<u32> {
        let place = |v: &u32| self.lattice.query.binary_search(v).ok().map(|i| i as u32);
        blind.iter().filter_map(place).collect()
    }

    fn columns(&self, graph: &Graph, obstacles: &Obstacles) -> Vec<(Measure, Vec<f64>)> {
        let wants = |source| self.asked.iter().any(|m| m.source() == source);
        let paths = || Paths::new(&self.lattice, graph, obstacles, Turning::default());
        let mut all: Vec<Column> = Vec::new();
        if wants(Source::Graph) {
            all.extend(local_columns(&self.lattice, graph));
        }
        if wants(Source::Metric) {
            all.extend(paths().metric_columns(None));
        }
        if wants(Source::Angular) {
            all.extend(paths().angular_columns(None));
        }
        if wants(Source::Through) {
            all.push(through_vision_column(&self.lattice, graph));
        }
        let of = |m: &Measure| {
            let column = all.iter().find(|c| m.column() == Some(c.name.as_str()))?;
            Some((*m, self.lattice.query.iter().map(|v| column.values[*v as usize]).collect()))
        };
        self.asked.iter().filter_map(of).collect()
    }
}

fn other_parts(ground: &Ground<'_>) -> Error {
    let text = "the parts are of other cells or walls than are found here: one of the two was made by another build of the \
                program, or on another kind of machine; nothing was written; make all parts anew with this program";
    Error::input("parts-other", Place::file(ground.file), text)
}

/// Roots drawn anew for every lattice, or their errors would not go out against each other; none where they are all.
fn own_roots(lattice: &Lattice, drawn: Drawn) -> Drawn {
    let [x, y] = lattice.origin_um.map(|v| v as u64);
    let seed_of = |seed: u64| seed ^ x.rotate_left(20) ^ y.rotate_left(42);
    drawn.filter(|(most, _)| *most < lattice.query.len()).map(|(most, seed)| (most, seed_of(seed)))
}

/// About how many roots of trees are drawn, and by which seed; none: all cells are roots.
pub type Drawn = Option<(usize, u64)>;

/// What a lattice is measured for.
#[derive(Clone, Copy, Debug)]
pub enum Use<'a> {
    /// The present layout alone, by breadth-first trees of about so many roots, drawn by a seed.
    Roots(usize, u64),
    /// Few layouts: by what they change.
    Few(Drawn),
    /// Many layouts.
    Search(Drawn),
    /// Nothing: who sees whom in the present layout is asked for.
    Views,
    /// The present layout alone, whose trees were walked before.
    Known(&'a Known),
}

#[cfg(test)]
mod tests {
    use super::*;
    use enfilade_engine::Region;

    /// An empty hall of some metres each way, at a spacing of one.
    fn hall(side: i64) -> Result<(), Error> {
        let far = side * 1_000_000;
        let ring = [Region::Ring(vec![[0, 0], [far, 0], [far, far], [0, far]])];
        let ground = Ground {
            file: "hall.dxf",
            spacing_um: 1_000_000,
            centre_um: [500_000, 500_000],
            query: &ring,
            reference: &ring,
            seeds_um: &[],
            seeds_by_cell: false,
            seed_names: &[],
            fixed: &[],
            movable: &[],
            fixed_solids: &[],
            interior: None,
            solid_across_um: 0,
        };
        let lattice = lattice(&ground, &mut Report::default())?;
        assert_eq!(lattice.cells.len() as i64, side * side);
        refuse_dense(&lattice, &ground)
    }

    #[test]
    fn a_graph_beyond_graph_bytes_max_is_refused_before_it_is_made() {
        assert!(hall(317).is_ok(), "100,000 vertices that all see each other");
        let said = hall(400).unwrap_err().to_string();
        for words in [
            "hall.dxf",
            "spacing 1 m gives 160000 vertices",
            &format!("GiB, expected at most {} GiB", GRAPH_BYTES_MAX >> 30),
            "nothing was measured; choose a larger --spacing (about 1.3 m would do)",
        ] {
            assert!(said.contains(words), "{said}");
        }
        let advised: f64 = said.split("(about ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
        let coarser = hall((400.0 / advised) as i64);
        assert!(coarser.is_ok(), "what is recommended is taken");
    }
}

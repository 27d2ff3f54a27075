//! Evaluation of many layouts of one plan: what never moves is prepared once.

use std::sync::{Arc, OnceLock};

use crate::geometry::Segment;

use super::dense::{Broad, Dense, DenseScratch};
use super::forest::{Initial, tally_from, tally_of};
use super::gpu::Gpu;
use super::gpu::forest::CardForest;
use super::graph::Graph;
use super::sampled::Sample;
use super::shares::Trees;
use super::visibility::{Vista, visibility_graph, visibility_graph_serial};
use super::{Lattice, Obstacles, Tally};

/// Evaluates layouts that share a lattice and the walls that do not move; share it between threads
/// and give each thread a [`Scratch`].
///
/// Lattices whose box holds up to 4,096 cells are evaluated on dense rows prepared for the fixed walls, larger ones
/// on their visibility graph under these; those of more than about 20,000 vertices, and coordinates beyond about
/// 10⁹ m, from scratch.
pub struct Evaluator {
    lattice: Arc<Lattice>,
    fixed: Vec<Segment>,
    dense: Option<Dense>,
    /// Where there is no `dense`.
    broad: Option<Broad>,
    initial: Tally,
    initial_components: Vec<u32>,
    initial_edges: u64,
    /// What moves, in the initial layout.
    initial_moving: Obstacles,
    /// The initial layout, which others that are measured from scratch are compared with.
    present: OnceLock<(Vista, Graph)>,
    /// Whose trees alone are walked; none: everyone's.
    sample: Option<Sample>,
    card: Option<CardForest>,
}

/// Lattices of more vertices keep no graph to compare with: of so many that all see each other it takes 75 MB, 12 bytes for
/// each vertex and each tile of 64.
const KEPT_MAX: usize = 20_000;

/// How roots are drawn: about how many, and by which seed.
enum Draw {
    /// In every area, for a look at one layout.
    InAreas(usize, u64),
    /// Spread evenly, for means that are compared between layouts.
    Even(usize, u64),
}

/// Roots whose trees are walked on the cores as well where a card walks all: one wave.
const COMPARED: usize = 512;

/// Why a graphics card is not asked.
const OVER_STAIRS: &str = "steps over stairs are counted on the cores alone";

fn differs(gpu: &Gpu) -> String {
    format!("{} measures the present layout differently", gpu.name())
}

/// A tally of all trees with those at some places alone, ascending.
fn with_trees_of(mut tally: Tally, places: &[u32]) -> Tally {
    let all = std::mem::take(&mut tally.levels);
    let mut at = 0;
    for (i, depth) in tally.depth.iter_mut().enumerate() {
        let own = &all[at..at + *depth as usize];
        at += own.len();
        match places.binary_search(&(i as u32)) {
            Ok(_) => tally.levels.extend(own),
            Err(_) => *depth = 0,
        }
    }
    tally
}

/// Buffers of one thread, for one evaluator.
pub struct Scratch {
    dense: DenseScratch,
}

impl Evaluator {
    /// `fixed` blocks sight in every layout; `initial_moving` is the rest of the initial layout,
    /// against which cut-off vertices are counted. With trees of about so many roots, drawn by a seed, where that many are
    /// named.
    pub fn new(
        lattice: Arc<Lattice>,
        fixed: &[Segment],
        initial_moving: &Obstacles,
        roots: Option<(usize, u64)>,
    ) -> Self {
        let mut new = Self::prepared(lattice, fixed, initial_moving);
        new.begin(initial_moving, roots.map(|(n, seed)| Draw::Even(n, seed)));
        if let (Some(dense), Some(sample)) = (&mut new.dense, &new.sample) {
            dense.set_roots(&sample.places);
        }
        new
    }

    /// [`new`](Self::new) with all trees of the initial layout walked on a graphics card. Those of some roots are walked on
    /// the cores too, and must be the same.
    ///
    /// # Errors
    /// Why the card cannot, in words for the report.
    pub fn on_card(
        gpu: &Arc<Gpu>,
        lattice: Arc<Lattice>,
        fixed: &[Segment],
        initial_moving: &Obstacles,
    ) -> Result<Self, String> {
        if lattice.beyond.is_some() {
            return Err(OVER_STAIRS.into());
        }
        let mut new = Self::prepared(lattice, fixed, initial_moving);
        let graph = new.look(initial_moving);
        new.initial = new.walked_on_card(gpu, &graph)?;
        Ok(new)
    }

    fn prepared(lattice: Arc<Lattice>, fixed: &[Segment], initial_moving: &Obstacles) -> Self {
        let mut scratch = Scratch { dense: DenseScratch::default() };
        let (mut dense, mut broad) = (None, None);
        // What nothing is prepared for needs no graph, which may be large.
        if Broad::fits(&lattice) {
            let under_fixed = Obstacles { segments: fixed.to_vec(), blind: Vec::new() };
            let under_fixed = visibility_graph_serial(&lattice, &under_fixed);
            dense = Dense::new(&lattice, &under_fixed);
            broad = if dense.is_none() { Broad::new(&lattice, &under_fixed) } else { None };
        }
        let dense = dense.and_then(|mut d| d.set_initial(initial_moving, &mut scratch.dense).then_some(d));
        Self { dense, broad, ..Self::bare(lattice, fixed) }
    }

    /// An evaluator for few layouts, which are measured by what they change: to prepare more takes as long as some dozens of
    /// them. With trees of about so many roots, drawn by a seed, where that many are named.
    pub fn unprepared(
        lattice: Arc<Lattice>,
        fixed: &[Segment],
        initial_moving: &Obstacles,
        roots: Option<(usize, u64)>,
    ) -> Self {
        let mut new = Self::bare(lattice, fixed);
        let graph = new.begin(initial_moving, roots.map(|(n, seed)| Draw::Even(n, seed)));
        if new.lattice.cells.len() <= KEPT_MAX {
            new.present = (new.vista(), graph).into();
        }
        new
    }

    /// An evaluator for a look at the initial layout alone: trees of about so many roots, drawn by a seed.
    pub fn sampled(
        lattice: Arc<Lattice>,
        fixed: &[Segment],
        initial_moving: &Obstacles,
        roots: (usize, u64),
    ) -> Self {
        let mut new = Self::bare(lattice, fixed);
        new.begin(initial_moving, Some(Draw::InAreas(roots.0, roots.1)));
        new
    }

    /// An evaluator for a look at the initial layout alone, whose trees were walked before: of every vertex in the region of
    /// query.
    pub fn walked(
        lattice: Arc<Lattice>,
        fixed: &[Segment],
        initial_moving: &Obstacles,
        trees: &Trees,
    ) -> Self {
        let mut new = Self { initial_moving: initial_moving.clone(), ..Self::bare(lattice, fixed) };
        let graph = visibility_graph(&new.lattice, &new.whole(initial_moving));
        new.initial_components = graph.components();
        new.initial_edges = graph.edge_count();
        new.initial = tally_from(&new.lattice, &graph, trees, new.against(initial_moving));
        new
    }

    /// An evaluator that has measured nothing, to ask who sees whom: see [`with_present`](Self::with_present).
    pub fn unmeasured(lattice: Arc<Lattice>, fixed: &[Segment], initial_moving: &Obstacles) -> Self {
        let tally = Tally { depth: vec![0; lattice.query.len()], ..Tally::default() };
        Self { initial: tally, initial_moving: initial_moving.clone(), ..Self::bare(lattice, fixed) }
    }

    fn bare(lattice: Arc<Lattice>, fixed: &[Segment]) -> Self {
        Self {
            lattice,
            fixed: fixed.to_vec(),
            dense: None,
            broad: None,
            initial: Tally::default(),
            initial_components: Vec::new(),
            initial_edges: 0,
            initial_moving: Obstacles::default(),
            present: OnceLock::new(),
            sample: None,
            card: None,
        }
    }

    /// Measures the initial layout, with trees of all roots or of those drawn; its graph.
    fn begin(&mut self, moving: &Obstacles, draw: Option<Draw>) -> Graph {
        let graph = self.look(moving);
        self.sample = draw.map(|draw| match draw {
            Draw::InAreas(roots, seed) => {
                Sample::draw(&self.lattice, &self.initial_components, &moving.blind, roots, seed)
            }
            Draw::Even(roots, seed) => Sample::even(&self.lattice, roots, seed),
        });
        self.initial = self.tally(&graph, moving);
        graph
    }

    /// Who sees whom in the initial layout.
    fn look(&mut self, moving: &Obstacles) -> Graph {
        self.initial_moving = moving.clone();
        let graph = visibility_graph(&self.lattice, &self.whole(moving));
        self.initial_components = graph.components();
        self.initial_edges = graph.edge_count();
        graph
    }

    /// All trees, by a graphics card that agrees with the cores on some.
    fn walked_on_card(&self, gpu: &Arc<Gpu>, graph: &Graph) -> Result<Tally, String> {
        let card = CardForest::new(Arc::clone(gpu), Arc::clone(&self.lattice), graph, None, 1)?;
        let tally = card.tallies(&[Obstacles::default()])?.pop().unwrap_or_default();
        let roots = self.lattice.query.len();
        let places: Vec<u32> = (0..roots as u32).step_by(roots.div_ceil(COMPARED)).collect();
        if with_trees_of(tally.clone(), &places) != tally_of(&self.lattice, graph, Some(&places), None) {
            return Err(differs(gpu));
        }
        Ok(tally)
    }

    /// The initial layout to look at.
    fn vista(&self) -> Vista {
        Vista::new(Arc::clone(&self.lattice), self.whole(&self.initial_moving))
    }

    /// What the initial layout and who sees whom in it are asked for; both are kept for the next time, unless they are large.
    pub fn with_present<T>(&self, ask: impl FnOnce(&Vista, &Graph) -> T) -> T {
        if let Some((vista, graph)) = self.present.get() {
            return ask(vista, graph);
        }
        // Made before it is locked: whoever waits in a lock may be handed work that wants it too.
        let vista = self.vista();
        let graph = vista.graph();
        if self.lattice.cells.len() > KEPT_MAX {
            return ask(&vista, &graph);
        }
        let (vista, graph) = self.present.get_or_init(|| (vista, graph));
        ask(vista, graph)
    }

    /// The tally of any layout, whatever walls it has, those that never move in others too: at the cost of what it changes.
    pub fn evaluate_walls(&self, obstacles: &Obstacles) -> Tally {
        let changed = |vista: &Vista, graph: &Graph| vista.changed(graph, obstacles);
        let graph = match self.lattice.cells.len() > KEPT_MAX {
            true => visibility_graph(&self.lattice, obstacles),
            false => self.with_present(changed),
        };
        self.tally(&graph, obstacles)
    }

    fn tally(&self, graph: &Graph, moving: &Obstacles) -> Tally {
        let places = self.sample.as_ref().map(|s| s.places.as_slice());
        tally_of(&self.lattice, graph, places, Some(self.against(moving)))
    }

    fn against<'a>(&'a self, moving: &'a Obstacles) -> Initial<'a> {
        Initial { components: &self.initial_components, covered: &moving.blind }
    }

    /// Edges of the initial layout's visibility graph, each pair once.
    pub fn initial_edges(&self) -> u64 {
        self.initial_edges
    }

    /// Component of every vertex in the initial layout.
    pub fn initial_components(&self) -> &[u32] {
        &self.initial_components
    }

    /// Buffers for one thread.
    pub fn scratch(&self) -> Scratch {
        Scratch { dense: DenseScratch::default() }
    }

    /// Whose trees are walked, where not everyone's are.
    pub fn sample(&self) -> Option<&Sample> {
        self.sample.as_ref()
    }

    /// The initial layout.
    pub fn initial(&self) -> &Tally {
        &self.initial
    }

    /// The same bits as [`tally_of`] the whole layout's visibility graph, with the trees that are walked here.
    pub fn evaluate(&self, moving: &Obstacles, scratch: &mut Scratch) -> Tally {
        let dense = self.dense.as_ref().and_then(|d| Some((d, d.evaluate(moving, &mut scratch.dense)?)));
        let Some((dense, mut tally)) = dense else { return self.evaluate_whole(moving, scratch) };
        if let Some(beyond) = &self.lattice.beyond {
            let steps: Vec<Vec<u32>> =
                beyond.stairs.iter().map(|s| dense.steps_from(s, &scratch.dense)).collect();
            beyond.add_to_tally(&steps, &self.lattice.query, &mut tally);
            return self.of_roots(tally);
        }
        tally
    }

    /// Measures batches of up to `layouts` on a graphics card from now on, once it has measured the initial
    /// layout as the cores did.
    ///
    /// # Errors
    /// Why the card cannot, in words for the report; the cores go on.
    pub fn attach(&mut self, gpu: Arc<Gpu>, initial_moving: &Obstacles, layouts: u32) -> Result<(), String> {
        if self.lattice.beyond.is_some() {
            return Err(OVER_STAIRS.into());
        }
        let components = Some(self.initial_components.as_slice());
        let under_fixed = Obstacles { segments: self.fixed.clone(), blind: Vec::new() };
        let under_fixed = visibility_graph(&self.lattice, &under_fixed);
        let card = CardForest::new(gpu, Arc::clone(&self.lattice), &under_fixed, components, layouts)?;
        let found = card.tallies(std::slice::from_ref(initial_moving))?;
        if found.into_iter().map(|t| self.of_roots(t)).ne([self.initial.clone()]) {
            return Err(differs(card.gpu()));
        }
        self.card = Some(card);
        Ok(())
    }

    /// Measures on the cores alone from now on.
    pub fn detach(&mut self) {
        self.card = None;
    }

    /// The same bits as [`evaluate`](Self::evaluate) of each layout, all at once on the graphics card; none
    /// without one.
    ///
    /// # Errors
    /// Why the card failed; the cores can still do it.
    pub fn evaluate_on_card(&self, layouts: &[Obstacles]) -> Option<Result<Vec<Tally>, String>> {
        let tallies = |card: &CardForest| {
            let all = card.tallies(layouts)?;
            Ok(all.into_iter().map(|t| self.of_roots(t)).collect())
        };
        self.card.as_ref().map(tallies)
    }

    /// A tally of all trees, with those alone that are walked here.
    fn of_roots(&self, tally: Tally) -> Tally {
        match &self.sample {
            Some(sample) => with_trees_of(tally, &sample.places),
            None => tally,
        }
    }

    fn evaluate_whole(&self, moving: &Obstacles, scratch: &mut Scratch) -> Tally {
        let shaded = self.broad.as_ref().and_then(|broad| broad.graph(moving, &mut scratch.dense));
        let graph = shaded.unwrap_or_else(|| {
            let obstacles = self.whole(moving);
            match self.present.get() {
                Some((vista, graph)) => vista.changed(graph, &obstacles),
                None => visibility_graph_serial(&self.lattice, &obstacles),
            }
        });
        self.tally(&graph, moving)
    }

    /// All that stops sight where this moves.
    fn whole(&self, moving: &Obstacles) -> Obstacles {
        let segments = [&self.fixed[..], &moving.segments].concat();
        Obstacles { segments, blind: moving.blind.clone() }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::super::fixtures;
    use super::super::lanes::Path;
    use super::super::stairs::Beyond;
    use super::*;

    /// Wall ends on halves of a cell of 12 µm, now and then a micrometre beside them.
    fn segments(most: usize) -> impl Strategy<Value = Vec<Segment>> {
        let ordinate =
            (-3i64..54, 0..8u8, -1i64..2).prop_map(|(k, odd, off)| k * 6 + if odd == 0 { off } else { 0 });
        let point = [ordinate.clone(), ordinate];
        let segment = (point.clone(), point, 0..4u8).prop_map(|(a, b, kind)| match kind {
            0 => Segment { a, b: [b[0], a[1]] },
            1 => Segment { a, b: [a[0], b[1]] },
            2 => Segment { a, b: [a[0] + (b[1] - a[1]), b[1]] },
            _ => Segment { a, b },
        });
        prop::collection::vec(segment, 0..most)
    }

    fn stretched(s: Segment, by: i64) -> Segment {
        let [a, b] = [s.a, s.b].map(|p| [p[0] * by, p[1]]);
        Segment { a, b }
    }

    proptest! {
        #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

        /// Dense rows against the sweep and the waves with every instruction set, on tall and wide grids of one to
        /// four cache lines a row, lines of one and of two words.
        #[test]
        fn evaluates_as_from_scratch(
            fixed in segments(8),
            initial in segments(4),
            layouts in prop::collection::vec((segments(6), prop::collection::vec(0u32..40, 0..3)), 3),
            size in prop_oneof![3 => (6i32..28, 7i32..28), 1 => (60i32..80, 7i32..9)],
            (holes, few) in (any::<u64>(), prop_oneof![2 => Just(0usize), 1 => 1usize..30]),
            stairs in prop::collection::vec((prop::collection::vec(0u32..40, 1..4), 1u32..5, 1u32..9), 0..3),
        ) {
            let wide = |of: Vec<Segment>| of.into_iter().map(|s| stretched(s, if size.0 > 28 { 3 } else { 1 })).collect();
            let [fixed, initial]: [Vec<Segment>; 2] = [fixed, initial].map(wide);
            let keep = |c: i32, r: i32| holes.rotate_left((c * 5 + r * 11) as u32 & 63) & 7 != 0;
            let cells = (0..size.0).flat_map(|c| (0..size.1).map(move |r| [c, r]));
            let mut lattice = fixtures::lattice(12, [0, 0], cells.filter(|c| keep(c[0], c[1]) || c[0] < 7).collect());
            lattice.query.retain(|v| v % 3 != 1);
            lattice.is_reference.iter_mut().enumerate().for_each(|(v, r)| *r = v % 5 != 2);
            lattice.beyond = (!stairs.is_empty()).then(|| {
                let far = |(i, (_, steps, count)): (usize, &(Vec<u32>, u32, u32))| {
                    let from = |k: usize| if k == i { *steps } else { stairs[k].1 + 3 };
                    ((0..stairs.len()).map(from).collect(), *count)
                };
                let far = stairs.iter().enumerate().map(far).collect();
                Beyond { stairs: stairs.iter().map(|s| s.0.clone()).collect(), far }.into()
            });
            let lattice = Arc::new(lattice);
            let initial = Obstacles { segments: initial, blind: vec![] };
            let roots = (few > 0).then_some((few, 7));
            let mut evaluator = Evaluator::new(lattice, &fixed, &initial, roots);
            prop_assert!(evaluator.dense.is_some());
            let mut scratch = evaluator.scratch();
            prop_assert_eq!(&evaluator.evaluate(&initial, &mut scratch), evaluator.initial());
            let unprepared = Evaluator::unprepared(Arc::clone(&evaluator.lattice), &fixed, &initial, roots);
            let mut stood: Vec<Segment> = vec![];
            for (segments, blind) in layouts {
                // Walls of the layout before that stay where they are, among others that do not.
                let kept = stood.iter().step_by(2).copied();
                let segments: Vec<Segment> = kept.chain(wide(segments)).collect();
                stood.clone_from(&segments);
                let moving = Obstacles { segments, blind };
                let whole = evaluator.evaluate_whole(&moving, &mut evaluator.scratch());
                prop_assert_eq!(&unprepared.evaluate(&moving, &mut unprepared.scratch()), &whole);
                prop_assert_eq!(&evaluator.evaluate_walls(&evaluator.whole(&moving)), &whole);
                for path in Path::available() {
                    evaluator.dense.iter_mut().for_each(|dense| dense.path = path);
                    prop_assert_eq!(&evaluator.evaluate(&moving, &mut scratch), &whole, "{:?}", path);
                }
            }
        }
    }

    #[test]
    fn beyond_the_limits_it_evaluates_from_scratch() {
        let cells: Vec<[i32; 2]> = (0..65).flat_map(|c| (0..65).map(move |r| [c, r])).collect();
        let lattice = Arc::new(fixtures::lattice(10, [0, 0], cells));
        let wall = |x: i64| Obstacles { segments: vec![Segment { a: [x, -5], b: [x, 655] }], blind: vec![] };
        let evaluator = Evaluator::new(lattice.clone(), &[], &wall(55), None);
        assert!(evaluator.dense.is_none());
        let tally = evaluator.evaluate(&wall(66), &mut evaluator.scratch());
        assert_eq!(tally.degree.len(), lattice.cells.len());
        let small = Arc::new(fixtures::lattice(10, [0, 0], vec![[0, 0], [3, 0], [0, 4]]));
        let evaluator = Evaluator::new(small, &[], &wall(55), None);
        let far =
            Obstacles { segments: vec![Segment { a: [-(1 << 60), 5], b: [1 << 60, 5] }], blind: vec![] };
        let tally = evaluator.evaluate(&far, &mut evaluator.scratch());
        assert_eq!((tally.depth, tally.disconnected), (vec![1, 0, 1], 4));
    }
}

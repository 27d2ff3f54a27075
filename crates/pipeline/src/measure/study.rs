//! A drawing made ready to be measured: plan, graph, moves, lattice, evaluator, penalties.

use std::sync::{Arc, Mutex, OnceLock};

use glam::DVec2;
use rayon::prelude::*;

use crate::measure::floors::{Floor, Floors, Over};
use crate::measure::known::Forest;
use crate::measure::look::{Bench, Look, SeenOn, state_asked};
use crate::measure::obstacles::{blind, fixed_parts, moving_segments, stopping};
use crate::measure::seen::Scene;
use crate::measure::worth::Worth;
use crate::measure::{aims, spacing};
use crate::understand::faults::{Guards, PASSAGE_WIDTH_M};
use crate::understand::pieces::Pieces;
use crate::understand::regions::state_interior;
use crate::understand::understood::Understood;
use enfilade_config::{Aggregate, Aim, Measure, PairName, Settings};
use enfilade_engine::geometry::{PointUm, UM_PER_M};
use enfilade_engine::gpu::Gpu;
use enfilade_engine::lattice::{CellIndex, Ground};
use enfilade_engine::visibility::{Graph, Vista, visibility_graph};
use enfilade_engine::walked::Walked;
use enfilade_engine::{Lattice, Obstacles};
use enfilade_moves::Layout;
use enfilade_penalties::{Alignment, Clearance, Overlap, Passage, RoomArea, WallLength, WallPiece};
use enfilade_plan::axes::Opening;
use enfilade_plan::outline::SOLID_ACROSS_M;
use enfilade_plan::{Plan, markers};
use enfilade_report::{Error, Place, Report};

pub use crate::measure::look::LatticeAt;
pub use crate::measure::look::Pair;
pub use crate::measure::seen::Use;

/// Radius r of the clearance penalty (spec 5).
pub const CLEARANCE_RADIUS_M: f64 = 0.5;

/// A study: one drawing with its lattices, ready to measure any layout of its moves. What a layout is worth is the mean
/// over the lattices; what its cells have is known where there is one.
pub struct Study {
    /// What was understood.
    pub base: Arc<Understood>,
    /// Its building, where steps are counted over the stairs.
    pub(crate) floors: Option<Floors>,
    /// The cells of the first lattice.
    pub lattice: Arc<Lattice>,
    /// Spacing of these cells, metres.
    pub spacing_m: f64,
    /// How many roots of trees were asked for; none: every cell is one.
    pub roots: Option<usize>,
    /// The present layout.
    pub initial: Worth,
    /// Edges of its visibility graph, each pair once.
    pub edges: u64,
    /// What is measured beyond the three means.
    pub aims: Vec<Aim>,
    /// Never empty.
    pub(super) looks: Vec<Look>,
    pub(super) gpu: Option<Arc<Gpu>>,
    /// Why the graphics card gave up, if it did.
    pub(super) card_trouble: OnceLock<String>,
    /// Set where the time stated is too short: what is measured after the search is measured less finely.
    pub(super) hurried: OnceLock<()>,
    /// The same study on the lattices that gains are confirmed on, coarse and fine, once they are wanted: with time, and in a
    /// hurry.
    pub(super) confirming: [OnceLock<[Vec<Study>; 2]>; 2],
    /// Memory of threads that do not measure at the moment.
    pub(super) benches: Mutex<Vec<Bench>>,
    pub(super) pieces: Pieces,
    pub(super) guards: Guards,
    pub(super) clearance: Clearance,
    pub(super) wall_length: WallLength,
    pub(super) alignment: Alignment,
    pub(super) overlap: Overlap,
    pub(super) passages: Vec<Passage>,
    pub(super) rooms: Option<RoomArea>,
}

/// In a hurry layouts ranked on, works counted and paired, and cells confirmed on are so many times fewer: `ensal` within 5 s
/// takes half the time by it, and has as many options.
const THINNED: usize = 4;

impl Study {
    /// Lays the lattice and measures the present layout, within its building where steps are counted over the stairs; with
    /// the breadth-first trees that are asked for: unless they are everyone's, for a look at the present layout alone.
    ///
    /// # Errors
    /// [`Error::Input`] when no cell is left, a limit is passed or what is known is of other cells.
    pub(crate) fn from_roots(
        (base, floors): (Understood, Option<Floors>),
        settings: &Settings,
        forest: Forest<'_>,
        report: &mut Report,
    ) -> Result<Self, Error> {
        let spacing_m = spacing::choose_m(&base, settings);
        let spacing_um = (spacing_m * UM_PER_M).round() as i64;
        let centre_um = settings.lattice_centre_m.unwrap_or_default().map(|v| (v * UM_PER_M).round() as i64);
        let at = LatticeAt { spacing_um, centre_um };
        let use_for = match forest {
            Forest::Every => Use::Search(None),
            Forest::Roots(roots) => Use::Roots(roots, settings.seed),
            Forest::Nobody => Use::Views,
            Forest::Known(known) => Use::Known(known),
        };
        let study = Self::on((Arc::new(base), floors), settings, &[at], (use_for, spacing_m), report)?;
        if !matches!(use_for, Use::Views) {
            study.state_blind(report);
        }
        Ok(study)
    }

    /// From now on what is confirmed, ranked and counted is so on fewer and coarser lattices.
    pub(crate) fn hurry(&self) {
        self.hurried.get_or_init(|| ());
    }

    /// Whether time is short.
    pub(crate) fn is_hurried(&self) -> bool {
        self.hurried.get().is_some()
    }

    /// By how much what is measured after the search is divided.
    pub(crate) fn thinned(&self) -> usize {
        if self.is_hurried() { THINNED } else { 1 }
    }

    /// The same study on other lattices; counts of cells are told in cells of this one's first lattice.
    ///
    /// # Errors
    /// [`Error::Input`] when no cell is left or a limit is passed.
    pub fn on_lattices(
        &self,
        settings: &Settings,
        lattices: &[LatticeAt],
        use_for: Use<'_>,
    ) -> Result<Self, Error> {
        let base = (Arc::clone(&self.base), self.floors.clone());
        Self::on(base, settings, lattices, (use_for, self.spacing_m), &mut Report::default())
    }

    /// Measures batches on the graphics card of another study, where that has one and it agrees with the cores here too.
    pub fn share_card(&mut self, of: &Self) {
        of.gpu.iter().for_each(|gpu| drop(self.attach(Arc::clone(gpu))));
    }

    /// What it is for, and the spacing in whose cells counts are told.
    fn on(
        (base, floors): (Arc<Understood>, Option<Floors>),
        settings: &Settings,
        lattices: &[LatticeAt],
        (use_for, unit_m): (Use<'_>, f64),
        report: &mut Report,
    ) -> Result<Self, Error> {
        let pieces = Pieces::new(&base);
        let (fixed, fixed_solids) = fixed_parts(&base, &pieces.moves);
        let identity = base.moves.apply(&base.plan, &base.graph, &base.moves.identity());
        let movable = moving_segments(&base, &identity, &pieces.moves);
        let seeds_um: Vec<PointUm> =
            settings.seed_points.iter().map(|p| base.plan.frame.um_from_file(DVec2::from(*p))).collect();
        let seed_names: Vec<String> =
            settings.seed_points.iter().map(|p| format!("{},{}", p[0], p[1])).collect();
        let ground = |at: &LatticeAt| Ground {
            file: &base.plan.file,
            spacing_um: at.spacing_um,
            centre_um: near(at.centre_um, at.spacing_um, &base.plan),
            query: &base.plan.markers.query,
            reference: &base.plan.markers.reference,
            seeds_um: &seeds_um,
            seeds_by_cell: settings.reading.as_drawn == Some(true),
            seed_names: &seed_names,
            fixed: &fixed,
            movable: &movable,
            fixed_solids: &fixed_solids,
            interior: base.interior.as_ref().filter(|_| base.plan.markers.needs_interior()),
            solid_across_um: (SOLID_ACROSS_M * base.plan.human_scale * UM_PER_M).round() as i64,
        };
        let look = |at: &LatticeAt| {
            let mut own = Report::default();
            let ground = ground(at);
            let cells = (ground.spacing_um, ground.centre_um);
            let over = || floors.as_ref().map(|f| f.laid(cells, Self::lay(*at)));
            let use_for = (use_for, &over as Over<'_>, unit_m);
            let look = Look::new(&ground, &base, &identity, settings, use_for, &mut own);
            look.map(|look| (look, own))
        };
        let looks: Vec<(Look, Report)> = lattices.par_iter().map(look).collect::<Result<_, _>>()?;
        let (looks, reports): (Vec<Look>, Vec<Report>) = looks.into_iter().unzip();
        reports.into_iter().for_each(|own| report.extend(own));
        let first = &looks[0];
        let spacing_m = lattices[0].spacing_um as f64 / UM_PER_M;
        let under = blind(&base, &identity, &first.main.cells, &movable);
        spacing::state(&base, settings, spacing_m, [first.main.lattice.cells.len(), under.len()], report);
        state_interior(&base, settings, report);
        state_asked(&base, &first.pairs, settings, report)?;
        let layout = enfilade_penalties::Layout { pieces: &pieces.drawn };
        let mut study = Self {
            clearance: Clearance::new(&layout, CLEARANCE_RADIUS_M * base.plan.human_scale),
            wall_length: WallLength::new(&layout),
            alignment: Alignment::new(&layout),
            overlap: Overlap::new(&layout),
            passages: aims::passages(settings, PASSAGE_WIDTH_M * base.plan.human_scale)
                .into_iter()
                .map(|(width_m, place)| {
                    Passage::new(&layout, width_m, place.map(|name| outlines_of(&base.plan, name)))
                })
                .collect(),
            rooms: aims::asks_for_rooms(settings).then(|| rooms(&base, &layout, report)),
            guards: Guards::new(&base, &pieces.drawn, settings),
            aims: aims::aims(settings),
            initial: Worth::default(),
            edges: first.main.edges,
            lattice: Arc::clone(&first.main.lattice),
            looks,
            gpu: None,
            base: Arc::clone(&base),
            floors: floors.clone(),
            spacing_m,
            roots: if let Use::Roots(n, _) = use_for { Some(n) } else { None },
            card_trouble: OnceLock::new(),
            hurried: OnceLock::new(),
            confirming: [OnceLock::new(), OnceLock::new()],
            benches: Mutex::default(),
            pieces,
        };
        let initial = |look: &Look| {
            let of = |scene: &Scene| {
                let obstacles = study.obstacles(&identity, &scene.cells);
                let blind = obstacles.blind.clone();
                scene.seen(scene.evaluator.initial().clone(), &blind, || obstacles)
            };
            SeenOn { main: of(&look.main), pairs: look.pairs.iter().map(|p| of(&p.scene)).collect() }
        };
        let seen = study.looks.par_iter().map(initial).collect();
        study.initial = study.worth(seen, &study.pieces.drawn, &identity);
        Ok(study)
    }

    /// How another storey of the building is laid out: who sees whom on a lattice.
    fn lay(at: LatticeAt) -> impl Fn(&Floor) -> Option<(Graph, CellIndex)> + Sync {
        move |floor| {
            let told = (Use::Views, at.spacing_um as f64 / UM_PER_M);
            let base = (Arc::clone(&floor.base), None);
            let on = Self::on(base, &floor.settings, &[at], told, &mut Report::default()).ok()?;
            Some((visibility_graph(&on.lattice, &on.initial_obstacles()), CellIndex::new(&on.lattice)))
        }
    }

    /// What of the first lattice was walked elsewhere.
    pub(crate) fn walked(&self) -> Option<&Walked> {
        self.looks[0].main.walked.as_deref()
    }

    /// The unnamed pair of regions and the named ones, on the first lattice.
    pub(crate) fn scenes(&self) -> impl Iterator<Item = &Scene> {
        std::iter::once(&self.looks[0].main).chain(self.pairs().iter().map(|p| &p.scene))
    }

    /// The named pairs of regions, on the first lattice.
    pub fn pairs(&self) -> &[Pair] {
        &self.looks[0].pairs
    }

    fn state_blind(&self, report: &mut Report) {
        let named = self.pairs().iter().zip(&self.initial.pairs).map(|(p, s)| (format!("-{}", p.name), s));
        let all = std::iter::once((String::new(), &self.initial.seen)).chain(named);
        for (name, _) in all.filter(|(_, seen)| seen.means.degree == 0.0) {
            let text = format!(
                "nobody in the region of query sees any of the region of reference: its degree is 0, and nothing that counts \
                 what is seen tells layouts apart; \
                 check where EF-QUERY{name} and EF-REFERENCE{name} stand"
            );
            report.warn("query-sees-nothing", Place::file(&self.base.plan.file), text);
        }
    }

    /// Change of the room that has lost most, and of the one that has gained most, as shares of their areas.
    pub fn room_extremes(&self, worth: &Worth) -> [f64; 2] {
        self.rooms.as_ref().map_or([0.0; 2], |r| r.extremes(&worth.rooms_m2))
    }

    /// What a layout has of a measure of cells; NaN for `score` and `penalty`.
    pub fn value(&self, worth: &Worth, aim: Aim) -> f64 {
        if let Some(i) = self.aims.iter().position(|a| *a == aim) {
            return worth.aims[i];
        }
        let means = &self.seen_of(worth, aim.pair).means;
        match (aim.measure, aim.aggregate) {
            (Measure::Degree, Aggregate::Mean) => means.degree,
            (Measure::Depth, Aggregate::Mean) => means.depth,
            (Measure::Entropy, Aggregate::Mean) => means.entropy,
            _ => f64::NAN,
        }
    }

    /// What the present layout has of a measure, also of one that is not among the aims; of one lattice.
    pub fn mean_of_cells(&self, aim: Aim) -> f64 {
        let known = self.value(&self.initial, aim);
        if !known.is_nan() {
            return known;
        }
        let values = aims::cell_values(self.seen_of(&self.initial, aim.pair), aim.measure);
        self.looks[0].told(aim.measure, aims::together(values, aim.aggregate))
    }

    /// Σ v_j g_j.
    pub fn penalty(&self, worth: &Worth, settings: &Settings) -> f64 {
        settings.penalties.iter().map(|(p, v)| v * worth.penalty(*p)).sum()
    }

    /// Σ w_k (f_k − f_k⁰)/|f_k⁰| − Σ v_j g_j (`interface.md`; divisor 1 where f_k⁰ = 0).
    pub fn score(&self, worth: &Worth, settings: &Settings) -> f64 {
        let gain = |(aim, w): &(Aim, f64)| {
            let zero = self.value(&self.initial, *aim);
            w * (self.value(worth, *aim) - zero) / divisor(zero)
        };
        settings.score.iter().map(gain).sum::<f64>() - self.penalty(worth, settings)
    }

    /// What blocks sight in the present layout.
    pub fn initial_obstacles(&self) -> Obstacles {
        let identity = self.base.moves.apply(&self.base.plan, &self.base.graph, &self.base.moves.identity());
        self.obstacles(&identity, &self.looks[0].main.cells)
    }

    /// What the present layout on the first lattice and who sees whom in it are asked for.
    pub(crate) fn with_present<T>(&self, ask: impl FnOnce(&Vista, &Graph) -> T) -> T {
        self.looks[0].main.evaluator.with_present(ask)
    }

    /// What blocks sight in a layout, all walls together, and which of some cells it covers.
    pub(super) fn obstacles(&self, layout: &Layout, cells: &CellIndex) -> Obstacles {
        let segments = stopping(&self.base, layout);
        Obstacles { blind: blind(&self.base, layout, cells, &segments), segments }
    }

    /// All pieces of the present layout that can move or not, as segments to show.
    pub fn all_pieces(&self) -> &[WallPiece] {
        &self.pieces.drawn
    }
}

/// Outlines of the regions of a name as they are drawn, metres, plan frame.
fn outlines_of(plan: &Plan, name: PairName) -> Vec<Vec<DVec2>> {
    let is_own = |pair: &&markers::Pair| pair.name.parse() == Ok(name);
    let drawn = plan.markers.pairs.iter().filter(is_own).flat_map(|p| p.query.iter().chain(&p.reference));
    drawn.map(|r| r.outline().into_iter().map(|p| plan.frame.plan_from_um(p)).collect()).collect()
}

/// |f⁰|, or 1 where it is 0.
pub fn divisor(initial: f64) -> f64 {
    if initial == 0.0 { 1.0 } else { initial.abs() }
}

/// How far a door's jamb is closed to either side of the wall's axis, as a share of its thickness.
const JAMB_SHARE: f64 = 0.52;

/// The rooms of the present layout, doors, windows and passages closed.
fn rooms(base: &Understood, initial: &enfilade_penalties::Layout<'_>, report: &mut Report) -> RoomArea {
    let scale = base.plan.human_scale;
    // Where the ends of a wall's two faces are open, floor would go round the door through the wall.
    let closed = |o: &Opening| {
        let [a, b] = o.jambs.each_ref().map(|j| j.at * scale);
        let across =
            (b - a).try_normalize().unwrap_or_default().perp() * (o.thickness_m * scale * JAMB_SHARE);
        [[a, b], [a - across, a + across], [b - across, b + across]]
    };
    let closings: Vec<[DVec2; 2]> = base.axes.openings.iter().flat_map(closed).collect();
    let rooms = RoomArea::new(initial, &closings, scale);
    let areas: Vec<String> = rooms.initial_m2().iter().map(|a| format!("{a:.1}")).collect();
    let text = match areas.len() {
        0 => "no room found: the walls and the doors between them enclose no floor; room-area has nothing to keep"
            .to_owned(),
        n => format!("rooms, with doors and passages closed: {n}, of {} m²", areas.join(", ")),
    };
    report.info("rooms", Place::file(&base.plan.file), text);
    rooms
}

/// The lattice centre moved by whole cells near the drawing, so that cell numbers stay small.
fn near(centre_um: PointUm, spacing_um: i64, plan: &Plan) -> PointUm {
    let o = plan.frame.origin_um;
    [0, 1].map(|k| centre_um[k] + (o[k] - centre_um[k]).div_euclid(spacing_um) * spacing_um)
}

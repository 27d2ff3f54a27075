//! One lattice of a study, and what several of them say together.
//!
//! Which cell centres happen to be free decides nothing where a value is the mean over shifted lattices.

use std::sync::Arc;

use crate::measure::floors::Over;
use crate::measure::seen::{Scene, Seen, Use};
use crate::understand::understood::Understood;
use enfilade_config::{Backend, Measure, PairName, Settings, Source};
use enfilade_engine::Lattice;
use enfilade_engine::evaluator::Scratch;
use enfilade_engine::geometry::{PointUm, UM_PER_M};
use enfilade_engine::gpu::Gpu;
use enfilade_engine::lattice::Ground;
use enfilade_engine::measures::Means;
use enfilade_moves::Layout;
use enfilade_penalties::WallPiece;
use enfilade_report::{Error, Place, Report};

/// Where a lattice lies: distance and centre of cells, µm of the drawing frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LatticeAt {
    /// Distance of the centres, > 0.
    pub spacing_um: i64,
    /// Some cell's centre.
    pub centre_um: PointUm,
}

/// A named pair of regions.
pub struct Pair {
    /// Its name.
    pub name: PairName,
    pub(crate) scene: Scene,
}

impl Pair {
    /// Its cells.
    pub fn lattice(&self) -> &Lattice {
        &self.scene.lattice
    }
}

/// One lattice, with what the unnamed and the named pairs of regions have on it.
pub(crate) struct Look {
    pub main: Scene,
    pub pairs: Vec<Pair>,
    /// Its spacing over the one in whose cells counts are told.
    coarseness: f64,
}

/// Memory for measuring one layout on one lattice.
pub(crate) struct Scratches {
    pub main: Scratch,
    pub pairs: Vec<Scratch>,
}

impl Look {
    pub fn new(
        ground: &Ground<'_>,
        base: &Understood,
        identity: &Layout,
        settings: &Settings,
        (use_for, over, unit_m): (Use<'_>, Over<'_>, f64),
        report: &mut Report,
    ) -> Result<Self, Error> {
        // Where no card answers, `backend::choose` says why.
        let is_asked = settings.backend == Backend::Gpu && matches!(use_for, Use::Search(None));
        let card = is_asked.then(|| Gpu::shared(true).ok()).flatten();
        let use_for = (use_for, over, card.as_ref());
        let main = Scene::new(ground, base, identity, asked(settings, None), use_for, report)?;
        let pairs = pairs(base, ground, identity, settings, use_for, report)?;
        Ok(Self { main, pairs, coarseness: ground.spacing_um as f64 / UM_PER_M / unit_m })
    }

    pub fn scratches(&self) -> Scratches {
        Scratches {
            main: self.main.evaluator.scratch(),
            pairs: self.pairs.iter().map(|p| p.scene.evaluator.scratch()).collect(),
        }
    }

    /// A value of one cell or one region in the unit in which it is told: counts grow as cells become smaller.
    pub fn told(&self, measure: Measure, value: f64) -> f64 {
        match measure.power_of_spacing() {
            0 => value,
            power => value * self.coarseness.powi(power),
        }
    }

    pub(crate) fn told_means(&self, m: &Means) -> Means {
        Means {
            degree: self.told(Measure::Degree, m.degree),
            degree_all: self.told(Measure::Connectivity, m.degree_all),
            ..*m
        }
    }
}

/// What is seen on one lattice.
#[derive(Default)]
pub(crate) struct SeenOn {
    /// By the unnamed pair of regions.
    pub main: Seen,
    /// By the named ones.
    pub pairs: Vec<Seen>,
}

/// The named pairs of a plan on a lattice.
pub(crate) fn pairs(
    base: &Understood,
    ground: &Ground<'_>,
    identity: &Layout,
    settings: &Settings,
    use_for: (Use<'_>, Over<'_>, Option<&Arc<Gpu>>),
    report: &mut Report,
) -> Result<Vec<Pair>, Error> {
    let markers = &base.plan.markers;
    let mut out = Vec::new();
    for pair in &markers.pairs {
        let name: PairName = match pair.name.parse() {
            Ok(name) => name,
            Err(why) => {
                report.warn("pair-name", Place::file(&base.plan.file), format!("{why}; it is left out"));
                continue;
            }
        };
        let [query, reference] = markers.regions_of(pair);
        let own = Ground { query, reference, ..ground.clone() };
        let asked = asked(settings, Some(name));
        // What there is to say of the interior was said of the unnamed pair.
        let scene = Scene::new(&own, base, identity, asked, use_for, &mut Report::default());
        let scene = scene.map_err(|e| {
            let text = format!("the regions named {name}: {e}");
            Error::input("pair", Place::file(&base.plan.file), text)
        })?;
        out.push(Pair { name, scene });
    }
    Ok(out)
}

/// Measures beyond the tally that the settings ask of a pair, each once.
pub(crate) fn asked(settings: &Settings, pair: Option<PairName>) -> Vec<Measure> {
    let mut out = Vec::new();
    for aim in crate::measure::aims::aims(settings).into_iter().filter(|a| a.pair == pair) {
        if aim.measure.source() != Source::Forest && !out.contains(&aim.measure) {
            out.push(aim.measure);
        }
    }
    out
}

/// Says which objectives make every layout take longer, and checks that the pairs they name are drawn.
///
/// # Errors
/// [`Error::Usage`] for a pair that is not drawn, with those that are.
pub(crate) fn state_asked(
    base: &Understood,
    pairs: &[Pair],
    settings: &Settings,
    report: &mut Report,
) -> Result<(), Error> {
    let aims = crate::measure::aims::aims(settings);
    let is_drawn = |name: PairName| pairs.iter().any(|p| p.name == name);
    let places = || settings.limits.iter().filter_map(|l| Some((l.to_string(), l.place?)));
    let asked = aims.iter().filter_map(|a| Some((a.to_string(), a.pair?))).chain(places());
    if let Some((aim, _)) = asked.into_iter().find(|(_, name)| !is_drawn(*name)) {
        let names: Vec<String> = pairs.iter().map(|p| p.name.to_string()).collect();
        let there = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
        let text = format!(
            "{aim}: no pair of regions of this name, pairs drawn: {there}; draw EF-QUERY-NAME and EF-REFERENCE-NAME \
             (what is not drawn is the unnamed region, or the interior); nothing was done"
        );
        return Err(Error::usage("pair", Place::file(&base.plan.file), text));
    }
    let is_asked =
        |name: PairName| aims.iter().any(|a| a.pair == Some(name)) || places().any(|l| l.1 == name);
    for pair in pairs.iter().filter(|p| !is_asked(p.name)) {
        let text = format!(
            "the regions named {} are measured and shown; no objective, score or limit names them: degree@{} would",
            pair.name, pair.name
        );
        report.info("pair-unasked", Place::file(&base.plan.file), text);
    }
    for aim in &aims {
        if let Some(cost) = aim.measure.source().cost() {
            let text = format!("{aim} {cost}, in every layout that is measured: the search takes longer");
            report.info("costly-measure", Place::file(&base.plan.file), text);
        }
    }
    Ok(())
}

/// Reusable memory of one thread that measures.
pub struct Bench {
    pub(crate) scratches: Vec<Scratches>,
    pub(crate) pieces: Vec<WallPiece>,
}

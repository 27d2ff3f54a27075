//! One lattice of a study, and what several of them say together.
//!
//! Which cell centres happen to be free decides nothing where a value is the mean over shifted lattices.

use crate::measure::aims;
use crate::measure::seen;
use crate::measure::seen::Scene;
use crate::measure::seen::Seen;
use crate::measure::study::Study;
use crate::measure::study::Worth;
use crate::understand::understood::Understood;
use enfilade_config::{Aim, Measure, PairName, Settings};
use enfilade_engine::Lattice;
use enfilade_engine::evaluator::Scratch;
use enfilade_engine::geometry::{PointUm, UM_PER_M};
use enfilade_engine::lattice::Ground;
use enfilade_engine::measures::Means;
use enfilade_moves::Layout;
use enfilade_penalties::disconnection;
use enfilade_report::{Error, Report};

/// Where a lattice lies: distance and centre of cells, µm of the drawing frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LatticeAt {
    /// Distance of the centres, > 0.
    pub spacing_um: i64,
    /// Some cell's centre.
    pub centre_um: PointUm,
}

/// What a lattice is measured for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Use {
    /// The present layout alone, by breadth-first trees of about so many roots, drawn by a seed.
    Roots(usize, u64),
    /// Few layouts: nothing is prepared.
    Few,
    /// Many layouts.
    Search,
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
        (use_for, unit_m): (Use, f64),
        report: &mut Report,
    ) -> Result<Self, Error> {
        let main = Scene::new(ground, base, identity, seen::asked(settings, None), use_for, report)?;
        let pairs = seen::pairs(base, ground, identity, settings, use_for, report)?;
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

    fn told_means(&self, m: &Means) -> Means {
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

/// Takes in what is seen on every lattice: as it is where there is one, else its means.
pub(crate) fn take_means(study: &Study, seen: Vec<SeenOn>, worth: &mut Worth) {
    let looks = &study.looks;
    let share = |(look, seen): (&Look, &SeenOn)| {
        let lattice = &look.main.lattice;
        let (query, all) = (lattice.query.len(), lattice.cells.len());
        let lost = seen.main.tally.disconnected;
        [disconnection(lost, query, all), lost as f64 / (query as f64 * all as f64)]
    };
    let shares: Vec<[f64; 2]> = looks.iter().zip(&seen).map(share).collect();
    let n = looks.len() as f64;
    [worth.disconnection, worth.cut_off] = [0, 1].map(|k| shares.iter().map(|s| s[k]).sum::<f64>() / n);
    let aim = |a: &Aim, look: &Look, on: &SeenOn| {
        let named = a.pair.and_then(|name| study.pairs().iter().position(|p| p.name == name));
        let of = named.and_then(|i| on.pairs.get(i)).unwrap_or(&on.main);
        look.told(a.measure, aims::together(aims::cell_values(of, a.measure), a.aggregate))
    };
    let mean = |a: &Aim| looks.iter().zip(&seen).map(|(l, s)| aim(a, l, s)).sum::<f64>() / n;
    worth.aims = study.aims.iter().map(mean).collect();
    if let [look] = looks.as_slice() {
        SeenOn { main: worth.seen, pairs: worth.pairs } = seen.into_iter().next().unwrap_or_default();
        let all = std::iter::once(&mut worth.seen).chain(&mut worth.pairs);
        all.for_each(|seen| seen.means = look.told_means(&seen.means));
        return;
    }
    let mean = |of: &dyn Fn(&SeenOn) -> Means| {
        let all = looks.iter().zip(&seen).map(|(look, seen)| look.told_means(&of(seen)));
        Seen { means: Means::mean(all.collect()), ..Seen::default() }
    };
    worth.seen = mean(&|s| s.main.means);
    worth.pairs = (0..study.pairs().len()).map(|i| mean(&|s| s.pairs[i].means)).collect();
}

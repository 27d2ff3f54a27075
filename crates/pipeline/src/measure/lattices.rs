//! Which lattices layouts are measured on.
//!
//! One lattice measures a layout and the chance of which of its cell centres are free. The mean over lattices shifted by a
//! rank-1 rule, (i/K, 3i/K) of the spacing, errs a third as much at the same cost: the K shifts have K different
//! abscissae and ordinates, where a grid of shifts has only √K of each (`BENCHMARKS.md`, "Gains").

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use crate::measure::aims;
use crate::measure::look::LatticeAt;
use crate::measure::seen::{Drawn, Use};
use crate::measure::spacing::DOOR_SPACING_M;
use crate::measure::study::Study;
use enfilade_config::{Aggregate, Settings};
use enfilade_engine::geometry::UM_PER_M;

/// Lattices of a search, √2 times as wide as the one that is shown: together they cost what that one costs. Where doors keep
/// them from being so wide, fewer.
const SEARCHED: u32 = 4;
/// … but never fewer than these.
const SEARCHED_LEAST: u32 = 2;
/// Lattices on which the best layouts found are ranked.
pub(crate) const RANKED: u32 = 8;
/// Lattices on which gains are confirmed, coarse and fine: a fine one costs sixteen coarse ones and varies half as much.
const CONFIRMING: [u32; 2] = [12, 4];
/// The finer lattices that gains are confirmed on have no more vertices, unless the one shown has: four times those of most
/// houses. What so many cells have on average hangs little on where they lie, and what twice as many cost is four times as much.
const VERTICES_MAX: f64 = 8_000.0;

/// Roots of trees on each lattice that layouts are compared on: of four lattices some thousands, the same for all layouts.
/// What they add to a confirmed interval is a few hundredths of its width (`BENCHMARKS.md`).
const ROOTS: usize = 1024;

/// The roots of layouts that are compared by means over several lattices; all, where anything but a mean is asked for.
pub(crate) fn drawn(settings: &Settings) -> Drawn {
    let is_mean = aims::aims(settings).iter().all(|a| a.aggregate == Aggregate::Mean);
    is_mean.then_some((ROOTS, settings.seed))
}

/// What lattices are for: each purpose has its own, so that nothing is confirmed where it was sought.
#[derive(Clone, Copy)]
enum Purpose {
    Search = 1,
    Rank = 2,
    Coarse = 3,
    Fine = 4,
}

/// For a search.
pub(crate) fn searched(study: &Study, settings: &Settings) -> Vec<LatticeAt> {
    let door_m = DOOR_SPACING_M * study.base.plan.human_scale;
    let wide_m = (study.spacing_m * std::f64::consts::SQRT_2).min(door_m.max(study.spacing_m));
    // What one costs grows with the square of its cells.
    let afforded = (wide_m / study.spacing_m).powi(4).round() as u32;
    shifted(settings, Purpose::Search, wide_m, afforded.clamp(SEARCHED_LEAST, SEARCHED))
}

/// A coarser spacing than the one shown, for telling its bias: lattices, and f / (c − f) of both.
pub(crate) fn coarser(study: &Study, settings: &Settings) -> (Vec<LatticeAt>, f64) {
    let wide = std::f64::consts::SQRT_2;
    (shifted(settings, Purpose::Coarse, study.spacing_m * wide, RANKED), 1.0 / (wide - 1.0))
}

/// For ranking what a search found.
pub(crate) fn ranked(study: &Study, settings: &Settings) -> Vec<LatticeAt> {
    shifted(settings, Purpose::Rank, study.spacing_m, RANKED)
}

/// The study on each of the lattices that gains are confirmed on, coarse and fine; none where one has no cells. They are
/// made once a study, by the settings of its round: what a round confirms, it confirms on the same. What is written on the
/// way may come before a hurry.
pub(crate) fn confirming<'s>(study: &'s Study, settings: &Settings) -> &'s [Vec<Study>; 2] {
    let made = &study.confirming[usize::from(study.is_hurried())];
    if made.get().is_none() {
        let on = |at: &LatticeAt| study.on_lattices(settings, &[*at], Use::Few(drawn(settings))).ok();
        let all = confirmed_at(study, settings).map(|all| all.par_iter().filter_map(on).collect());
        // Whoever was first made the same.
        drop(made.set(all));
    }
    made.get_or_init(Default::default)
}

/// For confirming gains: some at a spacing and some at half of it, where the lattice shown is not too fine for that: in
/// a hurry sooner.
fn confirmed_at(study: &Study, settings: &Settings) -> [Vec<LatticeAt>; 2] {
    let vertices = study.lattice.cells.len() as f64;
    let finer = (VERTICES_MAX / study.thinned() as f64 / vertices).sqrt().clamp(1.0, 2.0);
    let fine_m = study.spacing_m / finer;
    let [coarse, fine] = CONFIRMING;
    [(Purpose::Coarse, 2.0 * fine_m, coarse), (Purpose::Fine, fine_m, fine)]
        .map(|(purpose, spacing_m, count)| shifted(settings, purpose, spacing_m, count))
}

/// `count` lattices by the rank-1 rule, all shifted by a share of the spacing that the seed draws.
fn shifted(settings: &Settings, purpose: Purpose, spacing_m: f64, count: u32) -> Vec<LatticeAt> {
    let mut rng = ChaCha8Rng::seed_from_u64(settings.seed);
    rng.set_stream(purpose as u64);
    let drawn: [f64; 2] = [rng.random(), rng.random()];
    let origin = settings.lattice_centre_m.unwrap_or_default();
    let at = |i: u32| {
        let turn = [f64::from(i), f64::from(3 * i)].map(|k| k / f64::from(count));
        let centre = [0, 1].map(|k| origin[k] + (drawn[k] + turn[k]).fract() * spacing_m);
        LatticeAt {
            spacing_um: (spacing_m * UM_PER_M).round() as i64,
            centre_um: centre.map(|v| (v * UM_PER_M).round() as i64),
        }
    };
    (0..count).map(at).collect()
}

/// The study on the lattices that layouts are searched on, on the same graphics card; none where these have no cells.
pub(crate) fn trial(study: &Study, settings: &Settings) -> Option<Study> {
    let use_for = Use::Search(drawn(settings));
    let mut trial = study.on_lattices(settings, &searched(study, settings), use_for).ok()?;
    trial.share_card(study);
    Some(trial)
}

//! How many layouts a search may measure.

use super::{Settings, Study};

/// Evaluations of a study whose user names no budget: this many query–vertex pairs in all …
const PAIRS_BUDGET: f64 = 3.0e9;
/// … but within these bounds.
const EVALUATIONS: [f64; 2] = [200.0, 1_000.0];

/// The number stated, else by how much measuring one costs.
pub(super) fn budget(study: &Study, settings: &Settings) -> u64 {
    let pairs = study.lattice.cells.len() as f64 * study.lattice.query.len() as f64;
    settings.evaluations.unwrap_or((PAIRS_BUDGET / pairs).clamp(EVALUATIONS[0], EVALUATIONS[1]) as u64)
}

/// Most layouts of a search that ends when it has converged, where no number is stated.
const CONVERGING_MAX: u64 = 20_000;

/// The most of a search that ends when it has converged.
pub(super) fn most(settings: &Settings) -> u64 {
    settings.evaluations.unwrap_or(CONVERGING_MAX)
}

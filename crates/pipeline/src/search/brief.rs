//! What a search works with.

use crate::job::Input;
use crate::measure::study::Study;
use enfilade_config::{Aim, Method, Settings};
use enfilade_moves::control::Control;

/// A sum of penalties up to this counts as none when it is an objective of its own: written coordinates are
/// rounded to 1 µm, so that a turned wall never keeps its length exactly, and a drawing without any penalty
/// would otherwise allow no turn at all. Results report what was measured.
pub const PENALTY_FREE: f64 = 0.05;

/// Objectives as the user and as the search know them.
pub(crate) type Aims = [(Aim, enfilade_search::Objective)];

/// What a search works with.
pub(crate) struct Brief<'a> {
    /// The drawing.
    pub(crate) input: &'a Input<'a>,
    /// On the lattice that is shown.
    pub(crate) study: &'a Study,
    /// On the lattices that are searched on; the same one where the problem is bare.
    pub(crate) trial: &'a Study,
    pub(crate) settings: &'a Settings,
    pub(crate) control: &'a Control,
    pub(crate) objectives: &'a Aims,
}

/// Whether a search is the bare problem: one lattice, options by the distance of their parameters.
pub(crate) fn is_bare(settings: &Settings) -> bool {
    settings.raw || settings.method == Method::Paper
}

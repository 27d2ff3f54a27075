//! What a layout is worth.

use crate::measure::seen::Seen;
use crate::understand::faults::Faults;
use enfilade_config::Penalty;

/// Everything that one layout is worth.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Worth {
    /// What the unnamed pair of regions sees.
    pub seen: Seen,
    /// What the named pairs see, in the order of [`Study::pairs`].
    pub pairs: Vec<Seen>,
    /// g_j in the order of [`Penalty::ALL`]: clr² (m⁴), |ΔS| (m), alignment (rad²), overlap (m), passage (m),
    /// floor that rooms have lost (m²).
    pub penalties: [f64; 6],
    /// Length of all walls, m.
    pub wall_total_m: f64,
    /// By how much passages have become too narrow, m, for each width asked for; empty where none is.
    pub passages_m: Vec<f64>,
    /// Areas of the rooms, m²; empty unless asked for.
    pub rooms_m2: Vec<f64>,
    /// The aims of the settings beyond the three means, in the order of [`Study::aims`].
    pub aims: Vec<f64>,
    /// clr, m².
    pub clearance_m2: f64,
    /// What a builder would refuse.
    pub faults: Faults,
    /// (Σ u_i / (|V_q||V|))².
    pub disconnection: f64,
    /// Σ u_i / (|V_q||V|).
    pub cut_off: f64,
}

impl Worth {
    /// Takes in that works made the walls longer or shorter, metres. Limits hold it. No penalty counts it: each work states
    /// its own cost.
    pub(crate) fn built(&mut self, more_m: f64) {
        self.wall_total_m += more_m;
    }

    /// One penalty g_j.
    pub fn penalty(&self, penalty: Penalty) -> f64 {
        self.penalties[Penalty::ALL.iter().position(|p| *p == penalty).unwrap_or(0)]
    }
}

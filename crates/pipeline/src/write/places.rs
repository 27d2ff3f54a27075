//! Places and numbers as results write them.

use glam::DVec2;

use enfilade_engine::geometry::PointUm;
use enfilade_plan::Plan;

/// A share rounded as far as it is known.
pub(crate) fn share(value: f64) -> f64 {
    (value * 1e3).round() / 1e3 + 0.0
}

/// Places in drawing units, rounded.
pub(crate) struct Places<'a> {
    plan: &'a Plan,
    grains: f64,
}

impl<'a> Places<'a> {
    pub fn new(plan: &'a Plan) -> Self {
        let digits = (plan.frame.metres_per_unit / GRAIN_M).log10().ceil();
        Self { plan, grains: 10f64.powf(digits.clamp(0.0, 12.0)) }
    }

    pub fn file(&self, p: DVec2) -> [f64; 2] {
        p.to_array().map(|v| (v * self.grains).round() / self.grains + 0.0)
    }

    pub fn um(&self, p: PointUm) -> [f64; 2] {
        self.file(self.plan.frame.file_from_um(p))
    }

    /// From metres of a person.
    pub fn person(&self, p: DVec2) -> [f64; 2] {
        self.file(self.plan.frame.file_from_plan(p * self.plan.human_scale))
    }

    pub(crate) fn ring(&self, ring: &[PointUm]) -> Vec<[f64; 2]> {
        ring.iter().map(|p| self.um(*p)).collect()
    }
}

pub(crate) fn round_mm(metres: f64) -> f64 {
    (metres * 1e4).round() / 1e4
}

/// Places are told to this, metres.
pub(crate) const GRAIN_M: f64 = 1e-6;

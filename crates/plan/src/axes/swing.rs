//! The swing of a door: how large one is, where its leaf hangs, and where it may close.

use std::ops::RangeInclusive;

use glam::DVec2;

use super::Path;

/// Widths of door leaves, and radii of their swings, metres of a person: from a cupboard's to a gate's.
pub const LEAF_M: RangeInclusive<f64> = 0.4..=1.6;

/// How far the swing of a leaf that is drawn open turns at least.
const TURN_MIN_RAD: f64 = 0.5;

/// A leaf that turns farther opens to both sides, and closes in the middle of its swing.
pub(super) const BOTH_WAYS_RAD: f64 = 2.2;

/// No leaf turns so far: half round, and what tracing adds.
pub(super) const TURN_END_RAD: f64 = 3.3;

/// An arc as large as the swing of a door.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Swing {
    /// Where the leaf hangs.
    pub hinge: DVec2,
    /// How wide the leaf is, metres of a person.
    pub radius: f64,
    start_rad: f64,
    sweep_rad: f64,
}

impl Swing {
    /// That of a piece, if its size is one of doors.
    pub fn of(path: &Path) -> Option<Self> {
        Self::of_any_size(path).filter(|s| LEAF_M.contains(&s.radius))
    }

    /// The same of a symbol that stands in a gap, which says how wide the door is: some draw the swing smaller.
    pub fn of_any_size(path: &Path) -> Option<Self> {
        let Path::Arc { centre, radius, start_rad, sweep_rad } = *path else { return None };
        let turns = (TURN_MIN_RAD..TURN_END_RAD).contains(&sweep_rad);
        turns.then_some(Self { hinge: centre, radius, start_rad, sweep_rad })
    }

    /// Whether its leaf opens to both sides.
    pub fn is_both_ways(&self) -> bool {
        self.sweep_rad > BOTH_WAYS_RAD
    }

    /// Where the drawn swing ends: open and closed.
    pub fn ends(&self) -> [DVec2; 2] {
        [self.start_rad, self.start_rad + self.sweep_rad].map(|at| self.at(at))
    }

    /// Where the leaf may close: at either end, or in the middle where it opens to both sides.
    pub fn tips(&self) -> Vec<DVec2> {
        let middle = self.at(self.start_rad + self.sweep_rad / 2.0);
        self.ends().into_iter().chain(self.is_both_ways().then_some(middle)).collect()
    }

    /// Whether another swing hangs and is wide as this one, up to `slack` metres.
    pub fn is_like(&self, other: &Self, slack: f64) -> bool {
        self.hinge.distance(other.hinge) <= slack && (self.radius - other.radius).abs() <= slack
    }

    fn at(&self, angle_rad: f64) -> DVec2 {
        self.hinge + DVec2::from_angle(angle_rad) * self.radius
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use super::*;

    fn arc(radius: f64, sweep_rad: f64) -> Option<Swing> {
        Swing::of(&Path::Arc { centre: DVec2::ZERO, radius, start_rad: 0.0, sweep_rad })
    }

    #[test]
    fn an_arc_as_large_as_a_door_is_a_swing() {
        for (radius, sweep, is_one) in [
            (0.9, FRAC_PI_2, true),
            (*LEAF_M.start(), FRAC_PI_2, true),
            (*LEAF_M.start() - 0.01, FRAC_PI_2, false),
            (*LEAF_M.end(), FRAC_PI_2, true),
            (*LEAF_M.end() + 0.01, FRAC_PI_2, false),
            (0.9, TURN_MIN_RAD, true),
            (0.9, TURN_MIN_RAD - 0.01, false),
            (0.9, PI, true),
            (0.9, TURN_END_RAD, false),
        ] {
            assert_eq!(arc(radius, sweep).is_some(), is_one, "{radius} {sweep}");
        }
        assert_eq!(Swing::of(&Path::Line { a: DVec2::ZERO, b: DVec2::X }), None);
    }

    #[test]
    fn a_leaf_closes_where_its_swing_ends_or_between() {
        let tips = |sweep| arc(1.0, sweep).map(|s| s.tips().len());
        assert_eq!([FRAC_PI_2, BOTH_WAYS_RAD, BOTH_WAYS_RAD + 0.01].map(tips), [Some(2), Some(2), Some(3)]);
        let middle = arc(1.0, PI).map(|s| s.tips()[2]);
        assert!(middle.is_some_and(|p| p.distance(DVec2::Y) < 1e-9));
    }
}

//! An end of a wall that follows what it stands at.

use glam::DVec2;

use super::CROSSING_MIN_RAD;
use super::bars::Moving;
use enfilade_cad::curve::control_points;
use enfilade_engine::geometry::PointUm;
use enfilade_plan::Plan;
use enfilade_plan::graph::Handle;

/// An end that goes less far than this share of a shift stays.
const STILL: f64 = 1e-6;

/// An end of a wall that follows a group.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Follower {
    /// The group that it follows.
    pub group: usize,
    /// Record of its wall.
    pub record: usize,
    /// Which of its two ends.
    pub end: usize,
    /// The control points of that end.
    pub handles: Vec<Handle>,
    /// Unit vector along its wall, from the first end to the second, plan frame.
    pub along: DVec2,
    /// Unit normal of the wall that is followed.
    pub normal: DVec2,
}

impl Follower {
    /// How far the end goes along its own wall where the wall it ends at shifts: its face stays on the other's.
    pub fn way(&self, shift: DVec2) -> f64 {
        let across = self.normal.dot(self.along);
        if across.abs() < CROSSING_MIN_RAD.sin() {
            return shift.dot(self.along);
        }
        shift.dot(self.normal) / across
    }

    /// Where its control points stand.
    pub fn corners(&self, plan: &Plan) -> Vec<PointUm> {
        self.handles.iter().map(|h| place_um(plan, *h)).collect()
    }

    /// Whether its group ever shifts it.
    pub fn is_moved(&self, moving: Moving<'_>) -> bool {
        moving.shifts(self.group).any(|(direction, _)| self.way(direction).abs() > STILL)
    }
}

/// Where a control point is drawn.
pub(super) fn place_um(plan: &Plan, (wall, corner): Handle) -> PointUm {
    plan.frame.um_from_file(control_points(&plan.walls[wall as usize].shape)[corner as usize])
}

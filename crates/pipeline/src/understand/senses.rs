//! What an entity is taken for.

use enfilade_cad::roles::Role;
use enfilade_plan::Plan;
use enfilade_plan::reading::RoleSense;

/// What nothing names and is taken as a wall for its looks.
const UNNAMED_WALL: RoleSense = RoleSense { role: Role::Wall, confidence: 0.6 };

/// The sense of an entity of a drawing; what draws a wall of the plan and is taken for nothing is a wall.
pub(crate) fn of_entity(plan: &Plan, entity: usize, is_picked: bool) -> RoleSense {
    match plan.reading.senses.get(entity) {
        Some(sense) if sense.role != Role::Unknown || !is_picked => *sense,
        None if !is_picked => RoleSense { role: Role::Unknown, confidence: 0.5 },
        _ => UNNAMED_WALL,
    }
}

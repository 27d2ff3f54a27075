//! A drawing that is understood as a brief sees it.

use crate::brief::marks::exits;
use crate::understand::rooms::Room;
use crate::understand::sensed::{OpenGap, Sensed};
use crate::understand::understood::Understood;
use enfilade_demands::{Building, Opening};
use enfilade_engine::geometry::{PointUm, UM_PER_M};
use enfilade_plan::axes::OpeningKind;
use enfilade_plan::floor::Beside;
use enfilade_plan::obstacles::ObstacleKind;

/// The building: rooms, openings, what stands in the way.
pub(super) fn building(base: &Understood, sensed: &Sensed, rooms: &[Room]) -> Building {
    let beside = sensed.floor.iter().flat_map(|f| &f.beside).copied();
    let beside = beside.chain(std::iter::repeat([Beside::Nothing; 2]));
    let opening = |(gap, beside): (&OpenGap, [Beside; 2])| Opening {
        kind: gap.kind,
        jambs: gap.gap.jambs,
        thickness_m: gap.gap.thickness_um / UM_PER_M,
        width_m: gap.width_m,
        beside,
        leaves: leaves(base, gap),
        record: gap.named,
    };
    let is_fixed = |o: &&enfilade_plan::obstacles::Obstacle| o.kind == ObstacleKind::Fixed;
    let mut out = Building {
        rooms: rooms.iter().map(room).collect(),
        openings: sensed.gaps.iter().zip(beside).map(opening).collect(),
        exits: Vec::new(),
        things: base.plan.obstacles.iter().filter(is_fixed).flat_map(|o| o.pieces.clone()).collect(),
        um_per_unit: base.plan.frame.metres_per_unit * UM_PER_M,
    };
    out.exits = exits(base, &out);
    out
}

fn room(room: &Room) -> enfilade_demands::Room {
    enfilade_demands::Room {
        name: room.name.clone(),
        kind: room.found.kind,
        is_sure: room.found.is_sure,
        area: room.area.clone(),
    }
}

/// What is drawn in a door and takes ground from a room: closed outlines of its leaves.
fn leaves(base: &Understood, gap: &OpenGap) -> Vec<Vec<PointUm>> {
    let Some(opening) = gap.opening.filter(|_| gap.kind == OpeningKind::Door) else { return Vec::new() };
    let mut walls: Vec<u32> = base.axes.openings[opening].faces.iter().map(|f| f.0).collect();
    walls.sort_unstable();
    walls.dedup();
    let traces = walls.into_iter().filter_map(|w| base.plan.walls.get(w as usize)).map(|w| &w.trace);
    traces.filter(|t| t.is_closed && t.points.len() > 2).map(|t| t.points.clone()).collect()
}

//! A drawing that is understood as a brief sees it.

use crate::brief::marks::exits;
use crate::understand::rooms::Room;
use crate::understand::sensed::{OpenGap, Sensed};
use crate::understand::understood::Understood;
use enfilade_demands::{Building, Opening};
use enfilade_engine::geometry::{PointUm, UM_PER_M};
use enfilade_plan::axes::OpeningKind;
use enfilade_plan::curve::Trace;
use enfilade_plan::floor::Beside;
use enfilade_plan::obstacles::ObstacleKind;
use glam::DVec2;

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

/// Longest and shortest leaf and the thickest, metres of a person: as doors without swings are told by (`leaves` of the
/// plan).
const LEAF_M: [f64; 2] = [0.55, 1.3];
const THICK_M: f64 = 0.07;
/// A leaf is as long as its opening is wide but for its frame, and hangs this near to a jamb beside its wall, metres.
const FRAME_M: f64 = 0.1;

/// What is drawn in a door and takes ground from a room: leaves that stand open, as closed outlines.
fn leaves(base: &Understood, gap: &OpenGap) -> Vec<Vec<PointUm>> {
    if gap.kind != OpeningKind::Door {
        return Vec::new();
    }
    let scale = base.plan.human_scale;
    let metres = |p: PointUm| DVec2::new(p[0] as f64, p[1] as f64) / UM_PER_M;
    let jambs = gap.gap.jambs.map(metres);
    let reach = gap.gap.thickness_um / UM_PER_M / 2.0 + FRAME_M * scale;
    let is_leaf = |t: &&Trace| {
        let [Some(long), Some(short)] = [0, 1].map(|k| side_m(t, k)) else { return false };
        let is_slip = (LEAF_M[0] * scale..=LEAF_M[1] * scale).contains(&long) && short <= THICK_M * scale;
        let hangs = |j: DVec2| t.points.iter().any(|p| metres(*p).distance(j) <= reach);
        is_slip && (long - gap.width_m).abs() <= FRAME_M * scale && jambs.into_iter().any(hangs)
    };
    let drawn = base.left_out.iter().map(|l| &l.0).chain(base.plan.walls.iter().map(|w| &w.trace));
    drawn.filter(|t| t.is_closed && t.points.len() == 4).filter(is_leaf).map(|t| t.points.clone()).collect()
}

/// The longer or the shorter side of an outline of four corners, metres; nothing where it is no rectangle nearly.
fn side_m(trace: &Trace, rank: usize) -> Option<f64> {
    let at = |k: usize| DVec2::new(trace.points[k % 4][0] as f64, trace.points[k % 4][1] as f64) / UM_PER_M;
    let sides: Vec<f64> = (0..4).map(|k| at(k).distance(at(k + 1))).collect();
    let is_even = (sides[0] - sides[2]).abs() < THICK_M / 2.0 && (sides[1] - sides[3]).abs() < THICK_M / 2.0;
    let [long, short] = [sides[0].max(sides[1]), sides[0].min(sides[1])];
    is_even.then_some(if rank == 0 { long } else { short })
}

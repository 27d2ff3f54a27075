//! Rooms as works see them.

use enfilade_engine::Lattice;
use enfilade_engine::geometry::{PointUm, Side, side_of_ring};
use enfilade_plan::floor::Area;
use enfilade_plan::kinds::RoomKind;

/// A room, by its place in the list of rooms.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct RoomId(pub usize);

/// What works need to know of a room.
#[derive(Clone, Debug, PartialEq)]
pub struct Room {
    /// Where it is.
    pub area: Area,
    /// What people call it; empty where nothing does.
    pub name: String,
    /// What it is for; it says too whether nothing more of it may be seen from elsewhere.
    pub kind: RoomKind,
    /// Its dwelling, where there are several.
    pub dwelling: Option<usize>,
}

/// The room at a place, drawing frame.
pub fn room_at(rooms: &[Room], at: PointUm) -> Option<RoomId> {
    rooms.iter().position(|r| is_in(&r.area, at)).map(RoomId)
}

fn is_in(area: &Area, at: PointUm) -> bool {
    let inside = |ring: &[PointUm]| ring.len() > 2 && side_of_ring(ring, at) != Side::Outside;
    let in_hole = |ring: &Vec<PointUm>| ring.len() > 2 && side_of_ring(ring, at) == Side::Inside;
    inside(&area.outline) && !area.holes.iter().any(in_hole)
}

/// The room of every vertex of a lattice.
pub fn rooms_of(lattice: &Lattice, rooms: &[Room]) -> Vec<Option<RoomId>> {
    (0..lattice.cells.len()).map(|v| room_at(rooms, lattice.centre_um(v))).collect()
}

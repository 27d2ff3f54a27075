//! A storey as a brief sees it: rooms, what joins them, where it is left.

use enfilade_engine::geometry::{PointUm, Segment};
use enfilade_plan::axes::OpeningKind;
use enfilade_plan::floor::{Area, Beside};
use enfilade_plan::kinds::RoomKind;

/// A room, by its place in [`Building::rooms`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct RoomId(pub usize);

/// A door, window or passage, by its place in [`Building::openings`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct OpeningId(pub usize);

/// A room.
#[derive(Clone, Debug, PartialEq)]
pub struct Room {
    /// What it is called.
    pub name: Option<String>,
    /// What it is for.
    pub kind: RoomKind,
    /// Whether that is more than a guess.
    pub is_sure: bool,
    /// Its floor.
    pub area: Area,
}

/// A door, window or passage.
#[derive(Clone, Debug, PartialEq)]
pub struct Opening {
    /// What it is.
    pub kind: OpeningKind,
    /// Its jambs, on the axis of its wall.
    pub jambs: [PointUm; 2],
    /// Thickness of its wall, metres.
    pub thickness_m: f64,
    /// Between its jambs, metres.
    pub width_m: f64,
    /// What lies to its left and to its right, seen from its first to its second jamb.
    pub beside: [Beside; 2],
    /// The leaf as it is drawn, where it takes ground from a room.
    pub leaves: Vec<Vec<PointUm>>,
    /// Record of the door or window, where the file calls it so.
    pub record: Option<usize>,
}

/// Where one leaves the storey.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Exit {
    /// The ends of a line that one reaches; both may be one point.
    pub line: [PointUm; 2],
    /// The door that it is, where it is one.
    pub opening: Option<OpeningId>,
}

/// A storey. Points lie in the drawing frame, micrometres.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Building {
    /// The rooms, as `check` numbers them from 1.
    pub rooms: Vec<Room>,
    /// The openings, as `check` lists them.
    pub openings: Vec<Opening>,
    /// Where one leaves it; empty: by the doors to the outside, else by those of stairs.
    pub exits: Vec<Exit>,
    /// What stands in the rooms and cannot stand elsewhere.
    pub things: Vec<Segment>,
    /// Micrometres in a drawing unit, for places of a brief; 0 is taken as a metre.
    pub um_per_unit: f64,
}

impl Building {
    /// A room.
    pub fn room(&self, id: RoomId) -> &Room {
        &self.rooms[id.0]
    }

    /// Openings at a room, with the side that it lies on: 0 left, 1 right.
    pub(crate) fn openings_of(&self, room: RoomId) -> impl Iterator<Item = (OpeningId, usize)> + '_ {
        self.openings.iter().enumerate().flat_map(move |(k, o)| {
            let sides = (0..2).filter(move |s| o.beside[*s] == Beside::Room(room.0));
            sides.map(move |s| (OpeningId(k), s))
        })
    }

    /// The room beyond an opening.
    pub(crate) fn beyond(&self, opening: OpeningId, side: usize) -> Option<RoomId> {
        match self.openings[opening.0].beside[1 - side] {
            Beside::Room(r) => Some(RoomId(r)),
            _ => None,
        }
    }
}

impl Opening {
    /// Whether one goes through it.
    pub fn is_way(&self) -> bool {
        self.kind != OpeningKind::Window
    }

    /// Whether it leads out of the building.
    pub fn is_outer(&self) -> bool {
        let is_room = |b: &Beside| matches!(b, Beside::Room(_));
        self.beside.contains(&Beside::Outside) && self.beside.iter().any(is_room)
    }
}

//! Rules that forbid a work where nobody said otherwise (`docs/works.md`).

use enfilade_cad::bearing::Bearing;
use enfilade_plan::Plan;
use enfilade_plan::kinds::RoomKind;

use crate::rooms::{Room, RoomId};
use crate::walls::Wall;

/// Walls at least this thick carry, in plans that also have thinner ones: bearing inner masonry is built from 175 mm on
/// (EN 1996-1-1/NA, table NA.11), partitions are of 50 to 150 mm.
pub const CARRIES_M: f64 = 0.17;
/// Walls thicker than this carry in any plan.
pub const CARRIES_ALWAYS_M: f64 = 0.3;
/// A wall is a thick one beside walls of at most so much of its thickness.
const THINNER_SHARE: f64 = 0.75;

/// Why a work is forbidden.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Rule {
    /// The wall has the outside, or no room, on one side.
    Outer,
    /// The wall is thick enough to carry.
    Thick,
    /// Something says that the wall is structure.
    Structure(Bearing),
    /// It would open a room that stays private.
    Private(RoomId),
    /// More of a private room would be seen from elsewhere.
    ShowsPrivate,
    /// It would join two dwellings.
    Dwellings,
    /// A mark keeps the wall.
    Kept,
    /// Marks say what is allowed, and this is not among it.
    Unmarked,
    /// It would take a room's last door.
    LastDoor(RoomId),
    /// Something that cannot stand elsewhere stands before it.
    Blocked,
}

impl Rule {
    /// Its code in JSON.
    pub fn code(self) -> &'static str {
        match self {
            Self::Outer => "outer-wall",
            Self::Thick => "thick-wall",
            Self::Structure(Bearing::Party) => "party-wall",
            Self::Structure(Bearing::Fire | Bearing::NamedFire) => "fire-wall",
            Self::Structure(Bearing::Core) => "core-wall",
            Self::Structure(Bearing::Stacked) => "stacked-wall",
            Self::Structure(_) => "bearing-wall",
            Self::Private(_) => "private-room",
            Self::ShowsPrivate => "shows-private-room",
            Self::Dwellings => "between-dwellings",
            Self::Kept => "kept",
            Self::Unmarked => "not-marked",
            Self::LastDoor(_) => "last-door",
            Self::Blocked => "blocked",
        }
    }
}

/// What is said of walls by their thickness, in one plan.
pub struct Thickness {
    thinnest_m: f64,
    scale: f64,
}

impl Thickness {
    /// Of a plan's inner walls; the thinnest that at least a tenth of their length has.
    pub fn new(plan: &Plan, inner: &[&Wall]) -> Self {
        let mut by_thickness: Vec<(f64, f64)> =
            inner.iter().filter(|w| w.thickness_m > 0.0).map(|w| (w.thickness_m, w.length_m)).collect();
        by_thickness.sort_by(|a, b| a.0.total_cmp(&b.0));
        let all: f64 = by_thickness.iter().map(|t| t.1).sum();
        let mut below = 0.0;
        let thinnest = by_thickness.iter().find(|t| {
            below += t.1;
            below >= 0.1 * all
        });
        Self { thinnest_m: thinnest.map_or(0.0, |t| t.0), scale: plan.human_scale }
    }

    /// Whether a wall is thick enough to carry.
    pub fn carries(&self, wall: &Wall) -> bool {
        let t = wall.thickness_m / self.scale;
        let has_thinner = self.thinnest_m > 0.0 && self.thinnest_m <= THINNER_SHARE * wall.thickness_m;
        t > CARRIES_ALWAYS_M || (t >= CARRIES_M && has_thinner)
    }
}

/// What forbids to open a wall between two rooms.
pub fn between(
    wall: &Wall,
    thickness: &Thickness,
    is_kept: bool,
    rooms: &[Room],
    pair: [Option<RoomId>; 2],
) -> Vec<Rule> {
    let mut out = Vec::new();
    if is_kept {
        out.push(Rule::Kept);
    }
    out.extend(wall.bearing.map(Rule::Structure));
    let [Some(a), Some(b)] = pair else {
        out.push(Rule::Outer);
        return out;
    };
    if wall.bearing.is_none() && thickness.carries(wall) {
        out.push(Rule::Thick);
    }
    let outside = |r: RoomId| rooms[r.0].kind == RoomKind::Outside;
    if outside(a) || outside(b) {
        out.push(Rule::Outer);
    }
    let dwellings = [a, b].map(|r| rooms[r.0].dwelling);
    if let [Some(x), Some(y)] = dwellings
        && x != y
    {
        out.push(Rule::Dwellings);
    }
    if a != b {
        out.extend([a, b].into_iter().filter(|r| rooms[r.0].kind.is_private()).map(Rule::Private));
    }
    out
}

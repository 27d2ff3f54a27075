//! What a building's file asks of its own rooms and doors.

/// What is asked of a space or a door.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WishKind {
    /// `NetPlannedArea`: floor, square metres.
    PlannedAreaM2(f64),
    /// `OccupancyNumber`: people.
    Occupants(u32),
    /// `IsOutlookDesirable`: a view to the outside.
    Outlook,
    /// `FireExit`: one leaves the building through it.
    FireExit,
    /// `HandicapAccessible`: wheelchairs get there.
    Accessible,
}

impl WishKind {
    /// The property that says it.
    pub fn name(self) -> &'static str {
        match self {
            Self::PlannedAreaM2(_) => "NetPlannedArea",
            Self::Occupants(_) => "OccupancyNumber",
            Self::Outlook => "IsOutlookDesirable",
            Self::FireExit => "FireExit",
            Self::Accessible => "HandicapAccessible",
        }
    }
}

/// Something that a file asks of an element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wish {
    /// Record of the space or door.
    pub record: usize,
    /// What is asked.
    pub kind: WishKind,
}

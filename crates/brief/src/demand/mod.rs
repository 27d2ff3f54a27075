//! What a brief can ask of rooms: one [table](DEMANDS) of kinds, and the words in which an item is said.
//!
//! ```
//! use enfilade_brief::demand::{Demand, DemandKind, Weight};
//!
//! let said: Demand = "goal: kitchen area min 8 m2".parse()?;
//! assert_eq!((said.kind, said.weight), (DemandKind::Area, Weight::Goal));
//! assert_eq!((said.subject.as_str(), said.bound.least), ("kitchen", Some(8.0)));
//! assert_eq!(said.to_string(), "goal: kitchen area min 8 m2");
//! # Ok::<(), String>(())
//! ```

mod parse;
mod said;

use serde::{Deserialize, Serialize};

pub use parse::demands;

/// How much an item weighs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Weight {
    /// It must hold.
    #[default]
    Limit,
    /// It should hold.
    Goal,
    /// It is worth knowing.
    Note,
}

impl Weight {
    /// All, the heaviest first.
    pub const ALL: [Self; 3] = [Self::Limit, Self::Goal, Self::Note];

    /// As written before an item.
    pub fn name(self) -> &'static str {
        match self {
            Self::Limit => "limit",
            Self::Goal => "goal",
            Self::Note => "note",
        }
    }
}

/// What is asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum DemandKind {
    /// Floor of a room, by its outline.
    Area,
    /// Diameter of the largest circle in a room.
    Width,
    /// Longer side of the smallest rectangle round a room by its shorter one.
    Proportion,
    /// At least one door or passage.
    HasDoor,
    /// At least one window to the outside.
    HasWindow,
    /// A wall or an opening in common.
    NextTo,
    /// Neither.
    NotNextTo,
    /// A door or opening leads there, directly or through rooms that are named.
    ReachedFrom,
    /// None does.
    NotReachedFrom,
    /// Share of a room that is seen from a room or a place.
    SeenFrom,
    /// The same, to be kept small.
    NotSeenFrom,
    /// Horizontal angle of window that is seen from the places of a room.
    SightOut,
    /// Walk from the farthest place of a room to an exit.
    WayOut,
    /// The same through walls, in a straight line.
    StraightOut,
    /// How far one walks before there is a choice of two directions.
    DeadEnd,
    /// Clear width of doors, or of the ways through a room.
    ClearWidth,
    /// Narrowest door on the way out, by the number of people.
    WideFor,
    /// A circle to turn in with a wheelchair.
    TurningCircle,
    /// Free wall beside the handle of a door.
    BesideHandle,
}

/// Of what a value is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DemandUnit {
    /// Square metres.
    M2,
    /// Metres.
    M,
    /// Degrees.
    Deg,
    /// A share, shown in per cent.
    Share,
    /// A ratio.
    Ratio,
    /// A number of things.
    Count,
}

/// What stands behind the word of an item.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wants {
    /// A bound: `min 8 m2`.
    Bound,
    /// Nothing.
    Nothing,
    /// Other rooms, or a place.
    Other,
    /// A number of people.
    People,
}

/// A kind of item.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DemandEntry {
    /// The kind.
    pub kind: DemandKind,
    /// Its word in an item.
    pub word: &'static str,
    /// What it is called in sentences.
    pub plain: &'static str,
    /// Unit of its values.
    pub unit: DemandUnit,
    /// What stands behind the word.
    pub wants: Wants,
}

const fn entry(
    kind: DemandKind,
    word: &'static str,
    plain: &'static str,
    unit: DemandUnit,
    wants: Wants,
) -> DemandEntry {
    DemandEntry { kind, word, plain, unit, wants }
}

/// All kinds of items.
pub const DEMANDS: [DemandEntry; 19] = [
    entry(DemandKind::Area, "area", "area", DemandUnit::M2, Wants::Bound),
    entry(DemandKind::Width, "width", "widest circle inside", DemandUnit::M, Wants::Bound),
    entry(DemandKind::Proportion, "proportion", "long side by short side", DemandUnit::Ratio, Wants::Bound),
    entry(DemandKind::HasDoor, "has-door", "doors and passages", DemandUnit::Count, Wants::Nothing),
    entry(DemandKind::HasWindow, "has-window", "windows to the outside", DemandUnit::Count, Wants::Nothing),
    entry(DemandKind::NextTo, "next-to", "wall in common", DemandUnit::M, Wants::Other),
    entry(DemandKind::NotNextTo, "not-next-to", "wall in common", DemandUnit::M, Wants::Other),
    entry(DemandKind::ReachedFrom, "reached-from", "doors on the way", DemandUnit::Count, Wants::Other),
    entry(
        DemandKind::NotReachedFrom,
        "not-reached-from",
        "doors on the way",
        DemandUnit::Count,
        Wants::Other,
    ),
    entry(DemandKind::SeenFrom, "seen-from", "share that is seen", DemandUnit::Share, Wants::Other),
    entry(DemandKind::NotSeenFrom, "not-seen-from", "share that is seen", DemandUnit::Share, Wants::Other),
    entry(DemandKind::SightOut, "sight-out", "angle of window seen", DemandUnit::Deg, Wants::Bound),
    entry(DemandKind::WayOut, "way-out", "walk to an exit", DemandUnit::M, Wants::Bound),
    entry(DemandKind::StraightOut, "straight-out", "straight line to an exit", DemandUnit::M, Wants::Bound),
    entry(DemandKind::DeadEnd, "dead-end", "walk without a choice", DemandUnit::M, Wants::Bound),
    entry(DemandKind::ClearWidth, "clear-width", "clear width", DemandUnit::M, Wants::Bound),
    entry(DemandKind::WideFor, "wide-for", "narrowest door on the way out", DemandUnit::M, Wants::People),
    entry(DemandKind::TurningCircle, "turning-circle", "circle to turn in", DemandUnit::M, Wants::Bound),
    entry(DemandKind::BesideHandle, "beside-handle", "wall beside the handle", DemandUnit::M, Wants::Bound),
];

impl DemandKind {
    /// Its row of the table.
    pub fn entry(self) -> &'static DemandEntry {
        let row = DEMANDS.iter().find(|e| e.kind == self);
        row.unwrap_or(&DEMANDS[0])
    }

    /// Whether passing needs the opposite of its positive word.
    pub fn is_negative(self) -> bool {
        matches!(self, Self::NotNextTo | Self::NotReachedFrom | Self::NotSeenFrom)
    }
}

/// Between what a value should lie, in the unit of its kind.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Bound {
    /// At least this.
    pub least: Option<f64>,
    /// At most this.
    pub most: Option<f64>,
    /// What was planned, where the bound stands for that.
    pub planned: Option<f64>,
}

/// How far a planned area may be missed. No standard says it; offers of building firms often allow three to five per cent.
pub const PLANNED_SHARE: f64 = 0.05;

impl Bound {
    /// The bound of a planned value.
    pub fn planned(value: f64) -> Self {
        let [least, most] = [1.0 - PLANNED_SHARE, 1.0 + PLANNED_SHARE].map(|by| Some(value * by));
        Self { least, most, planned: Some(value) }
    }

    /// Whether a value keeps it, to within a tolerance for what is rounded.
    pub fn holds(self, value: f64, tolerance: f64) -> bool {
        self.least.is_none_or(|l| value >= l - tolerance) && self.most.is_none_or(|m| value <= m + tolerance)
    }
}

/// Which of the values over the places of a room counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Over {
    /// The one in the middle.
    #[default]
    Median,
    /// The best place.
    Best,
    /// The worst place.
    Least,
}

impl Over {
    /// All.
    pub const ALL: [Self; 3] = [Self::Median, Self::Best, Self::Least];

    /// As written in an item.
    pub fn name(self) -> &'static str {
        match self {
            Self::Median => "median",
            Self::Best => "best",
            Self::Least => "least",
        }
    }
}

/// From where something is seen or reached.
#[derive(Clone, Debug, PartialEq)]
pub enum From {
    /// Rooms, by number, name or kind.
    Rooms(String),
    /// A place, drawing units; with the direction in which one looks and the field, degrees, where they are said.
    Place {
        /// Where.
        at: [f64; 2],
        /// Anticlockwise from +x, and how wide the view is in all.
        facing: Option<[f64; 2]>,
    },
}

/// One item of a brief.
#[derive(Clone, Debug, PartialEq)]
pub struct Demand {
    /// How much it weighs.
    pub weight: Weight,
    /// Rooms or doors that it is asked of: number, name or kind; `rooms`, `doors`, `doors of kitchen`.
    pub subject: String,
    /// What is asked.
    pub kind: DemandKind,
    /// Between what the value should lie.
    pub bound: Bound,
    /// From where, or next to what.
    pub other: Option<From>,
    /// Rooms that the way may lead through; empty: none.
    pub through: Vec<String>,
    /// Whether doors are shut while one looks.
    pub is_shut: bool,
    /// Which place of a room counts.
    pub over: Over,
    /// How many people.
    pub people: Option<u32>,
}

/// A word of a brief that is no item by itself.
#[derive(Clone, Debug, PartialEq)]
pub enum Clause {
    /// An item.
    Demand(Demand),
    /// A rule set, by its name.
    Rule(String),
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_kind_has_one_row_and_one_word() {
        for (i, row) in DEMANDS.iter().enumerate() {
            assert_eq!(row.kind.entry(), row);
            assert!(DEMANDS[..i].iter().all(|r| r.word != row.word && r.kind != row.kind), "{}", row.word);
        }
    }

    #[test]
    fn a_bound_holds_between_its_ends() {
        let planned = Bound::planned(10.0);
        assert!(planned.holds(9.5, 1e-9) && planned.holds(10.5, 1e-9));
        assert!(!planned.holds(9.4, 0.0) && !planned.holds(10.6, 0.0));
        assert!(Bound::default().holds(f64::MAX, 0.0));
    }
}

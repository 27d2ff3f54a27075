//! What rooms are for: by their names, by what stands in them, else by size, doors and place.
//!
//! Nothing is opened into a private room, so a bedroom taken for a living room costs more than a place that is not
//! offered: a guess leans towards what is private, and says that it is one.

mod dwellings;
mod evidence;
mod things;
mod words;

use std::fmt;
use std::str::FromStr;

use super::axes::OpeningKind;
use super::floor::{Area, Beside};
use enfilade_cad::things::ThingKind;
pub use things::{Thing, find as find_things, furniture};
pub use words::{NameFound, dwelling_of_name, kind_of_name};

/// What a room is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum RoomKind {
    /// With tub or shower, with or without a toilet.
    Bath,
    /// With a toilet alone.
    Wc,
    /// To sleep in.
    Bedroom,
    /// To cook in.
    Kitchen,
    /// To live in; with a kitchen or a table too.
    Living,
    /// To eat in.
    Dining,
    /// Behind the entrance, or a room from which others are reached.
    Hall,
    /// Long and narrow, with the doors of other rooms.
    Corridor,
    /// A stair and its landings.
    Stair,
    /// For things.
    Storage,
    /// To work in.
    Office,
    /// To meet in.
    Meeting,
    /// Of patients.
    Ward,
    /// To teach in.
    Class,
    /// Of machines, pipes, lifts, laundry.
    Plant,
    /// Of cars.
    Garage,
    /// To be received or to wait in.
    Reception,
    /// To change clothes in.
    Changing,
    /// Balcony, terrace, court.
    Outside,
    /// None of these, or unknown.
    Other,
}

impl RoomKind {
    /// All kinds.
    pub const ALL: [Self; 20] = [
        Self::Bath,
        Self::Wc,
        Self::Bedroom,
        Self::Kitchen,
        Self::Living,
        Self::Dining,
        Self::Hall,
        Self::Corridor,
        Self::Stair,
        Self::Storage,
        Self::Office,
        Self::Meeting,
        Self::Ward,
        Self::Class,
        Self::Plant,
        Self::Garage,
        Self::Reception,
        Self::Changing,
        Self::Outside,
        Self::Other,
    ];

    /// Name in files and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Bath => "bath",
            Self::Wc => "wc",
            Self::Bedroom => "bedroom",
            Self::Kitchen => "kitchen",
            Self::Living => "living",
            Self::Dining => "dining",
            Self::Hall => "hall",
            Self::Corridor => "corridor",
            Self::Stair => "stair",
            Self::Storage => "storage",
            Self::Office => "office",
            Self::Meeting => "meeting",
            Self::Ward => "ward",
            Self::Class => "class",
            Self::Plant => "plant",
            Self::Garage => "garage",
            Self::Reception => "reception",
            Self::Changing => "changing",
            Self::Outside => "outside",
            Self::Other => "other",
        }
    }

    /// What a room of it is, in words: `a bedroom`.
    pub fn words(self) -> &'static str {
        match self {
            Self::Bath => "a bathroom",
            Self::Wc => "a WC",
            Self::Bedroom => "a bedroom",
            Self::Kitchen => "a kitchen",
            Self::Living => "a living room",
            Self::Dining => "a dining room",
            Self::Hall => "a hall",
            Self::Corridor => "a corridor",
            Self::Stair => "a stair",
            Self::Storage => "a storage room",
            Self::Office => "an office",
            Self::Meeting => "a meeting room",
            Self::Ward => "a ward",
            Self::Class => "a classroom",
            Self::Plant => "a plant room",
            Self::Garage => "a garage",
            Self::Reception => "a reception",
            Self::Changing => "a changing room",
            Self::Outside => "outside",
            Self::Other => "another room",
        }
    }

    /// Whether nothing is opened into it unless somebody says so: no more of it is seen from elsewhere than today.
    pub fn is_private(self) -> bool {
        matches!(
            self,
            Self::Bath
                | Self::Wc
                | Self::Bedroom
                | Self::Storage
                | Self::Plant
                | Self::Changing
                | Self::Garage
                | Self::Stair
        )
    }

    /// Whether it is of a building that people live in.
    fn is_of_dwelling(self) -> bool {
        matches!(self, Self::Bedroom | Self::Living | Self::Bath)
    }

    /// Whether it is of a building that people work or learn in.
    fn is_of_work(self) -> bool {
        matches!(self, Self::Office | Self::Meeting | Self::Class | Self::Ward | Self::Reception)
    }
}

impl fmt::Display for RoomKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for RoomKind {
    type Err = String;

    /// Reads a kind: its name, or a word that rooms of it are called by.
    ///
    /// # Errors
    /// What was found and what is expected.
    fn from_str(text: &str) -> Result<Self, String> {
        let folded = enfilade_cad::names::folded(text);
        let named = Self::ALL.into_iter().find(|k| k.name() == folded);
        named.or_else(|| kind_of_name(text).map(|found| found.kind)).ok_or_else(|| {
            let all = Self::ALL.map(Self::name).join(", ");
            format!("found {text:?}, expected one of {all}")
        })
    }
}

/// What speaks for the kind of a room.
#[derive(Clone, Debug, PartialEq)]
pub enum Evidence {
    /// The user says so.
    Said,
    /// The word of its name that says so.
    Name(String),
    /// So many of these stand in it.
    Things(ThingKind, usize),
    /// Its floor, m² of a person, its doors and passages, and its windows.
    Shape {
        /// Floor.
        area_m2: f64,
        /// Doors and passages.
        doors: usize,
        /// Windows.
        windows: usize,
    },
}

/// The kind of a room, and why.
#[derive(Clone, Debug, PartialEq)]
pub struct RoomKindFound {
    /// What it is for.
    pub kind: RoomKind,
    /// Whether that is certain enough to act on without asking.
    pub is_sure: bool,
    /// What speaks for it.
    pub evidence: Vec<Evidence>,
    /// The dwelling that it is part of, from 0; `None`: of none, of several, or unknown.
    pub dwelling: Option<usize>,
}

impl RoomKindFound {
    /// Whether nothing is opened into it unless somebody says so.
    pub fn is_private(&self) -> bool {
        self.kind.is_private()
    }

    fn new(kind: RoomKind, is_sure: bool, evidence: Vec<Evidence>) -> Self {
        Self { kind, is_sure, evidence, dwelling: None }
    }
}

/// An opening and what it joins.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Way {
    /// Door, window or passage.
    pub kind: OpeningKind,
    /// What lies on its two sides, as in [`super::floor::Floor::beside`].
    pub beside: [Beside; 2],
}

/// What is known of the rooms of a floor. Lists by room have one entry for each.
#[derive(Clone, Copy, Debug)]
pub struct RoomsKnown<'a> {
    /// The rooms.
    pub rooms: &'a [Area],
    /// The name of each.
    pub names: &'a [Option<String>],
    /// All that is written in each.
    pub texts: &'a [Vec<String>],
    /// The openings.
    pub ways: &'a [Way],
    /// What stands on the floor.
    pub things: &'a [Thing],
    /// Kinds that the user states, by room.
    pub said: &'a [(usize, RoomKind)],
    /// Metres of the plan in a metre of a person.
    pub human_scale: f64,
}

/// The kind and the dwelling of every room.
pub fn kinds_of_rooms(known: &RoomsKnown<'_>) -> Vec<RoomKindFound> {
    let seen = evidence::seen(known);
    let mut found: Vec<Option<RoomKindFound>> =
        (0..known.rooms.len()).map(|room| stated(known, room, &seen[room])).collect();
    let usage = evidence::Usage::of(&found, &seen);
    for (found, room) in found.iter_mut().zip(&seen) {
        let known = found.take().map(|f| usage.adapted(f));
        *found = Some(known.unwrap_or_else(|| evidence::by_shape(room, &usage)));
    }
    let mut found: Vec<RoomKindFound> = found.into_iter().flatten().collect();
    let dwellings = dwellings::dwellings(known, &found);
    found.iter_mut().zip(dwellings).for_each(|(f, d)| f.dwelling = d);
    found
}

/// What the user, its name, what is written in it or what stands in it says of a room.
fn stated(known: &RoomsKnown<'_>, room: usize, seen: &evidence::RoomSeen) -> Option<RoomKindFound> {
    if let Some((_, kind)) = known.said.iter().rev().find(|(r, _)| *r == room) {
        return Some(RoomKindFound::new(*kind, true, vec![Evidence::Said]));
    }
    let name = known.names.get(room).and_then(Option::as_deref);
    let named = name.and_then(kind_of_name);
    let written = || {
        let texts = known.texts.get(room).into_iter().flatten().filter(|t| words::is_short(t));
        texts.filter_map(|t| kind_of_name(t)).filter(|f| f.is_sure).min_by_key(|f| words::rank(f.kind))
    };
    let by_words = named.clone().filter(|n| n.is_sure).or_else(written).or(named);
    let by_name = |n: words::NameFound| RoomKindFound::new(n.kind, n.is_sure, vec![Evidence::Name(n.word)]);
    match by_words {
        Some(n) if n.is_sure => Some(by_name(n)),
        by_words => match (evidence::by_things(seen), by_words) {
            (Some(found), by_words) if found.is_sure || by_words.is_none() => Some(found),
            (_, by_words) => by_words.map(by_name),
        },
    }
}

#[cfg(test)]
mod tests;

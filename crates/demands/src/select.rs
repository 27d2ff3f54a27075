//! Which rooms and doors a word means: a number, a name, a kind, or nearly one of them.

use std::collections::BTreeSet;

use enfilade_plan::kinds::{RoomKind, kind_of_name};

use crate::building::{Building, OpeningId, RoomId};

/// Names that are alike to this share are one, a slip of the hand apart: `kichen` is 0.95.
const ALIKE: f64 = 0.9;

/// Word for all rooms that are inside.
const ALL_ROOMS: [&str; 2] = ["rooms", "all"];

/// Rooms that a word means, in their order; or why it means no room.
pub(crate) fn rooms(building: &Building, word: &str) -> Result<Vec<RoomId>, String> {
    let word = word.trim().to_lowercase();
    let all = || (0..building.rooms.len()).map(RoomId);
    let kind = |id: &RoomId| building.room(*id).kind;
    if ALL_ROOMS.contains(&word.as_str()) {
        let inside: Vec<RoomId> = all().filter(|id| kind(id) != RoomKind::Outside).collect();
        return if inside.is_empty() { Err("No room was found.".into()) } else { Ok(inside) };
    }
    if let Ok(number) = word.trim_start_matches('#').parse::<usize>() {
        let id = number.checked_sub(1).filter(|n| *n < building.rooms.len()).map(RoomId);
        return id.map(|id| vec![id]).ok_or_else(|| format!("There is no room {number}."));
    }
    let name = |id: RoomId| building.room(id).name.as_ref().map(|n| n.to_lowercase());
    let named = |is: &dyn Fn(&str) -> bool| -> Vec<RoomId> {
        all().filter(|id| name(*id).is_some_and(|n| is(&n))).collect()
    };
    let of_kind = |wanted: RoomKind| all().filter(|id| kind(id) == wanted).collect::<Vec<_>>();
    let exact_kind = RoomKind::ALL.into_iter().find(|k| k.name() == word);
    let by_kind = || exact_kind.or_else(|| kind_of_name(&word).map(|f| f.kind)).map(of_kind);
    let has_word = |n: &str| n.split(|c: char| !c.is_alphanumeric()).any(|w| w == word);
    let is_alike = |n: &str| strsim::jaro_winkler(n, &word) >= ALIKE;
    let near_kind = || {
        let alike = RoomKind::ALL.into_iter().find(|k| is_alike(k.name()));
        alike.map(of_kind).unwrap_or_default()
    };
    // A room that is called as its kind is one of them: `bedroom` means BEDROOM and BEDROOM 2.
    let exactly = || {
        let named = named(&|n| n == word);
        let of_kind = exact_kind.filter(|_| !named.is_empty()).map(of_kind).unwrap_or_default();
        let both: BTreeSet<usize> = named.iter().chain(&of_kind).map(|id| id.0).collect();
        both.into_iter().map(RoomId).collect()
    };
    let tries: [&dyn Fn() -> Vec<RoomId>; 5] =
        [&exactly, &|| by_kind().unwrap_or_default(), &|| named(&has_word), &|| named(&is_alike), &near_kind];
    let found = tries.iter().map(|t| t()).find(|r| !r.is_empty());
    found.ok_or_else(|| missing(&word, exact_kind))
}

fn missing(word: &str, kind: Option<RoomKind>) -> String {
    match kind {
        Some(kind) => format!(
            "No room is {} by its name or its looks; `--room N={}` says which is.",
            kind.words(),
            kind.name()
        ),
        None => format!("No room is called `{word}`, and it is no kind of room."),
    }
}

/// Doors and passages that a word means.
pub(crate) fn doors(building: &Building, word: &str) -> Result<Vec<OpeningId>, String> {
    let lower = word.trim().to_lowercase();
    let all = (0..building.openings.len()).map(OpeningId);
    let ways = all.filter(|id| building.openings[id.0].is_way() && joins_a_room(building, *id));
    let found: Vec<OpeningId> = match lower.strip_prefix("doors of ") {
        Some(of) => {
            let rooms = rooms(building, of)?;
            ways.filter(|id| rooms.iter().any(|r| building.openings_of(*r).any(|o| o.0 == *id))).collect()
        }
        None => ways.collect(),
    };
    if found.is_empty() { Err("There is no door.".into()) } else { Ok(found) }
}

/// Whether a word means doors.
pub(crate) fn is_of_doors(word: &str) -> bool {
    let lower = word.trim().to_lowercase();
    lower == "doors" || lower.starts_with("doors of ")
}

fn joins_a_room(building: &Building, id: OpeningId) -> bool {
    (0..2).any(|side| building.beyond(id, side).is_some())
}

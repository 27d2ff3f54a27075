//! The rooms of a plan with what they are for.

use crate::understand::sensed::Sensed;
use crate::understand::understood::Understood;
use enfilade_config::Settings;
use enfilade_engine::geometry::{PointUm, Side, side_of_ring};
use enfilade_plan::floor::{Area, name_of_rooms, texts_in_rooms};
use enfilade_plan::kinds::{RoomKind, RoomKindFound, RoomsKnown, Way, kinds_of_rooms};
use enfilade_plan::reading::questions::{Doubt, room_questions};
use enfilade_report::{Error, Place};

/// A room with what it is called and what it is for.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Room {
    /// Its floor, drawing frame.
    pub area: Area,
    /// What it is called.
    pub name: Option<String>,
    /// What it is for.
    pub found: RoomKindFound,
}

/// The rooms in the order in which `check` numbers them.
///
/// # Errors
/// [`Error::Usage`] where a correction names a room that is not there, or a kind that is none.
pub(crate) fn rooms_with_kinds(
    base: &Understood,
    sensed: &Sensed,
    settings: &Settings,
) -> Result<Vec<Room>, Error> {
    let rooms = sensed.floor.as_ref().map_or(&[][..], |f| &f.rooms);
    let said = said(base, rooms.len(), settings)?;
    let names = names(base, sensed);
    let beside = sensed.floor.iter().flat_map(|f| &f.beside);
    let ways: Vec<Way> =
        sensed.gaps.iter().zip(beside).map(|(g, b)| Way { kind: g.kind, beside: *b }).collect();
    let found = kinds_of_rooms(&RoomsKnown {
        rooms,
        names: &names,
        texts: &texts_in_rooms(rooms, &base.texts, &base.plan.frame),
        ways: &ways,
        things: &base.things,
        said: &said,
        human_scale: base.plan.human_scale,
    });
    let all = rooms.iter().zip(names).zip(found);
    Ok(all.map(|((area, name), found)| Room { area: area.clone(), name, found }).collect())
}

/// What the rooms are called: by the texts that stand in them, else by the space of the building that they are part of.
pub(crate) fn names(base: &Understood, sensed: &Sensed) -> Vec<Option<String>> {
    let Some(floor) = &sensed.floor else { return Vec::new() };
    let mut names = name_of_rooms(&floor.rooms, &base.texts, &base.plan.frame);
    for (name, room) in names.iter_mut().zip(&floor.rooms).filter(|(n, _)| n.is_none()) {
        let around = |(ring, _): &&(Vec<PointUm>, String)| side_of_ring(ring, room.at) == Side::Inside;
        *name = base.spaces.iter().find(around).map(|s| s.1.clone());
    }
    names
}

/// What should be asked about rooms of which the kind is a guess.
pub(crate) fn questions(rooms: &[Room]) -> Vec<Doubt> {
    let known: Vec<_> = rooms.iter().map(|r| (r.area.area_m2, r.name.is_some(), &r.found)).collect();
    room_questions(&known)
}

/// The kinds that the settings state, by room from 0.
fn said(base: &Understood, rooms: usize, settings: &Settings) -> Result<Vec<(usize, RoomKind)>, Error> {
    let one = |said: &enfilade_config::RoomText| {
        let number = said.number();
        let room = (1..=rooms).contains(&number).then(|| number - 1).ok_or_else(|| {
            let there =
                if rooms == 0 { "no room was found".into() } else { format!("expected 1 to {rooms}") };
            let text = format!("--room {said}: there is no room {number}, {there}; nothing was done");
            Error::usage("room-number", Place::file(&base.plan.file), text)
        })?;
        let kind = said.kind().parse().map_err(|why: String| {
            let text = format!("--room {said}: {why}; nothing was done");
            Error::usage("room-kind", Place::file(&base.plan.file), text)
        })?;
        Ok((room, kind))
    };
    settings.reading.rooms.iter().map(one).collect()
}

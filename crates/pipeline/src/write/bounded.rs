//! Rooms of a building that the walls of an option bound: which follow, and what of them stays as the file states it.

use crate::measure::study::Study;
use crate::write::made::Made;
use crate::write::show::{self, metres};
use enfilade_cad::Changes;
use enfilade_cad::ifc::BoundedRoom;
use enfilade_overlay::result;
use enfilade_report::{Place, Report};

/// Most rooms that are named.
const NAMED: usize = 6;

/// Rooms whose outlines follow, each with its corners before and afterwards.
pub(crate) fn changes(study: &Study, made: &Made) -> Vec<result::Change> {
    let plan = &study.base.plan;
    let of = |room: &BoundedRoom| {
        let [from, to] = room.outlines.as_ref().ok()?.each_ref().map(|points| metres(plan, points));
        let element = show::element_of(plan.format, Some(room.global_id.clone()), room.id as usize);
        let host_id = made.host_ids.get(&room.id).cloned();
        Some(result::Change { element, host_id, from, to, follows: true })
    };
    made.changed.rooms.iter().filter_map(of).collect()
}

/// Says which rooms stay as drawn, which of their figures and boundaries stay as stated, and which of walls.
pub(crate) fn say(report: &mut Report, file: &str, changed: &Changes) {
    say_walls(report, file, changed);
    let rooms = &changed.rooms;
    for room in rooms {
        if let Err(why) = &room.outlines {
            let text = format!(
                "The room {} stays as drawn, although a wall beside it moves in an option: {why}. Its outline, area and \
                 boundaries are wrong there.",
                room.name
            );
            report.info("room-stays", place(file, room), text);
        }
    }
    let is_stale =
        |room: &&BoundedRoom| room.outlines.is_ok() && (room.boundaries > 0 || !room.quantities.is_empty());
    let stale: Vec<&BoundedRoom> = rooms.iter().filter(is_stale).collect();
    if let Some(first) = stale.first() {
        let mut names: Vec<&str> = stale.iter().take(NAMED).map(|r| r.name.as_str()).collect();
        if stale.len() > NAMED {
            names.push("…");
        }
        let text = format!(
            "Rooms whose outlines follow their walls in an option: {} ({}). Their space boundaries and other stated figures \
             stay as they are. Pset_Enfilade_Result of each room lists them. Compute them anew in your program.",
            stale.len(),
            names.join(", ")
        );
        report.info("room-figures-stay", place(file, first), text);
    }
}

fn say_walls(report: &mut Report, file: &str, changed: &Changes) {
    let Some(first) = changed.figures.first() else { return };
    let mut names: Vec<&str> = changed.figures.iter().flat_map(|f| &f.names).map(String::as_str).collect();
    names.sort_unstable();
    names.dedup();
    let count = changed.figures.len();
    let text = format!(
        "{} in an option a length that the file does not state: {} stay as they are. Pset_Enfilade_Result of each lists \
         them. Compute them anew in your program.",
        if count == 1 {
            "One element of a wall has".into()
        } else {
            format!("{count} elements of walls have")
        },
        names.join(", ")
    );
    let place = Place { file: file.into(), line: None, entity: first.global_id.clone() };
    report.info("wall-figures-stay", place, text);
}

fn place(file: &str, room: &BoundedRoom) -> Place {
    Place { file: file.into(), line: None, entity: room.global_id.clone() }
}

//! What is found for one item: one evaluation for every kind.

mod bare;
mod doors;
mod links;
mod out;
mod sight;
mod widths;

#[cfg(test)]
pub(crate) use bare::{circle, smallest_box};
pub(crate) use out::width_for;

use enfilade_brief::demand::{Bound, Demand, DemandKind, From};

use crate::answer::{Asked, Finding, Verdict};
use crate::building::RoomId;
use crate::select;
use crate::site::Site;

/// Values nearer than this to a bound keep it, in the unit of the value: what rounding to micrometres leaves.
const ROUNDING: f64 = 1e-4;

/// Everything that is found for an item, place by place.
pub(crate) fn findings(site: &Site<'_>, asked: &Asked) -> Vec<Finding> {
    let demand = &asked.demand;
    let found = match &asked.ground {
        Some(ground) => sight::ground_seen(site, demand, ground),
        None if select::is_of_doors(&demand.subject) => of_doors(site, demand),
        None => of_rooms(site, demand),
    };
    found.unwrap_or_else(|why| vec![Finding::untold(why)])
}

fn of_doors(site: &Site<'_>, demand: &Demand) -> Result<Vec<Finding>, String> {
    let doors = select::doors(site.building, &demand.subject)?;
    match demand.kind {
        DemandKind::ClearWidth => Ok(doors.iter().map(|d| doors::clear_width(site, demand, *d)).collect()),
        DemandKind::BesideHandle => {
            let all: Vec<Finding> =
                doors.iter().flat_map(|d| doors::beside_handle(site, demand, *d)).collect();
            if all.is_empty() { Err("There is no door with a leaf.".into()) } else { Ok(all) }
        }
        _ => Err(format!("`{}` is asked of rooms, not of doors.", demand.kind.entry().word)),
    }
}

fn of_rooms(site: &Site<'_>, demand: &Demand) -> Result<Vec<Finding>, String> {
    let rooms = select::rooms(site.building, &demand.subject)?;
    let others = match &demand.other {
        Some(From::Rooms(word)) => select::rooms(site.building, word)?,
        _ => Vec::new(),
    };
    let rooms: Vec<RoomId> = rooms.into_iter().filter(|r| !others.contains(r)).collect();
    let each = |one: &dyn Fn(RoomId) -> Finding| Ok(rooms.iter().map(|r| one(*r)).collect());
    let found: Result<Vec<Finding>, String> = match demand.kind {
        DemandKind::Area => each(&|r| bare::area(site, demand, r)),
        DemandKind::Width => each(&|r| bare::width(site, demand, r)),
        DemandKind::Proportion => each(&|r| bare::proportion(site, demand, r)),
        DemandKind::HasDoor => each(&|r| bare::has_door(site, r)),
        DemandKind::HasWindow => each(&|r| bare::has_window(site, r)),
        DemandKind::TurningCircle => each(&|r| bare::turning_circle(site, demand, r)),
        DemandKind::NextTo | DemandKind::NotNextTo => each(&|r| links::next_to(site, demand, r, &others)),
        DemandKind::ReachedFrom | DemandKind::NotReachedFrom => links::reached(site, demand, &rooms, &others),
        DemandKind::SeenFrom | DemandKind::NotSeenFrom => sight::seen(site, demand, &rooms, &others),
        DemandKind::SightOut => each(&|r| sight::out(site, demand, r)),
        DemandKind::WayOut => out::walked(site, demand, &rooms),
        DemandKind::StraightOut => out::straight(site, demand, &rooms),
        DemandKind::DeadEnd => out::dead_end(site, demand, &rooms),
        DemandKind::WideFor => out::wide_for(site, demand, &rooms),
        DemandKind::ClearWidth => each(&|r| widths::of_ways(site, demand, r)),
        DemandKind::BesideHandle => {
            let doors = rooms.iter().flat_map(|r| site.building.openings_of(*r)).map(|o| o.0);
            Ok(doors.flat_map(|d| doors::beside_handle(site, demand, d)).collect())
        }
    };
    Ok(found?.into_iter().map(|f| guessed(site, demand, f)).collect())
}

/// Says where a room was chosen for a kind that is a guess.
fn guessed(site: &Site<'_>, demand: &Demand, mut finding: Finding) -> Finding {
    let Some(room) = finding.rooms.first().map(|r| site.building.room(*r)) else { return finding };
    let is_by_kind = room.kind.name() == demand.subject.to_lowercase();
    if is_by_kind && !room.is_sure {
        let said = format!("Probably {}.", room.kind.words());
        finding.note = Some(finding.note.map_or(said.clone(), |n| format!("{said} {n}")));
    }
    finding
}

/// Whether a value keeps a bound.
fn judged(bound: Bound, value: f64) -> Verdict {
    judged_to(bound, value, ROUNDING)
}

/// Whether a value that is found to within a tolerance keeps a bound.
fn judged_to(bound: Bound, value: f64, tolerance: f64) -> Verdict {
    if bound.holds(value, tolerance) { Verdict::Pass } else { Verdict::Fail }
}

//! What a drawing itself asks: marks on layers of ours, and properties of a building's spaces and doors.

use crate::understand::understood::Understood;
use enfilade_brief::demand::{Bound, Demand, DemandKind, From, Weight};
use enfilade_cad::wish::WishKind;
use enfilade_demands::{Asked, Building, Exit, OpeningId, Origin, RoomId};
use enfilade_engine::geometry::{PointUm, Segment, Side, segments_touch, side_of_ring};
use enfilade_plan::asked::{AskedKind, AskedMark};

/// Exits by the marks of a drawing, else by the fire exits of its doors.
pub(super) fn exits(base: &Understood, building: &Building) -> Vec<Exit> {
    let marks = base.plan.markers.asked.iter().filter(|m| m.kind == AskedKind::Exit);
    let marked: Vec<Exit> = marks.filter_map(|m| exit_of(building, m)).collect();
    if !marked.is_empty() {
        return marked;
    }
    let fire = base.wishes.iter().filter(|w| w.kind == WishKind::FireExit).map(|w| w.record);
    let doors: Vec<usize> = fire.collect();
    let is_fire = |k: &usize| building.openings[*k].record.is_some_and(|r| doors.contains(&r));
    (0..building.openings.len()).filter(is_fire).map(|k| exit_at(building, k)).collect()
}

fn exit_at(building: &Building, opening: usize) -> Exit {
    Exit { line: building.openings[opening].jambs, opening: Some(OpeningId(opening)) }
}

/// The door that a mark lies at, or else the line that it is.
fn exit_of(building: &Building, mark: &AskedMark) -> Option<Exit> {
    let points = &mark.points;
    let is_at = |k: &usize| {
        let o = &building.openings[*k];
        let [a, b] = o.jambs;
        let middle = [0, 1].map(|i| i64::midpoint(a[i], b[i]));
        let crosses =
            points.windows(2).any(|w| segments_touch(Segment { a, b }, Segment { a: w[0], b: w[1] }));
        o.is_way() && (crosses || mark.is_closed && side_of_ring(points, middle) != Side::Outside)
    };
    match (0..building.openings.len()).find(is_at) {
        Some(k) => Some(exit_at(building, k)),
        None => Some(Exit { line: [*points.first()?, *points.get(1)?], opening: None }),
    }
}

/// Items of marks that say what is seen.
pub(super) fn of_marks(base: &Understood) -> impl Iterator<Item = Asked> + '_ {
    base.plan.markers.asked.iter().filter_map(|mark| {
        let (kind, from, layer) = match &mark.kind {
            AskedKind::See(from) => (DemandKind::SeenFrom, from, "EF-SEE"),
            AskedKind::Hide(from) => (DemandKind::NotSeenFrom, from, "EF-HIDE"),
            AskedKind::Exit => return None,
        };
        let other = Some(From::Rooms(from.clone()));
        let demand = Demand { other, ..item("ground", kind, Bound::default()) };
        Some(Asked { demand, origin: Origin::Drawing(layer.into()), ground: Some(mark.points.clone()) })
    })
}

/// Items that the properties of spaces and doors ask; the people of all spaces need doors that are wide enough.
pub(super) fn of_wishes(base: &Understood, building: &Building) -> Vec<Asked> {
    let mut out = Vec::new();
    let mut people = 0;
    for wish in &base.wishes {
        if let WishKind::Occupants(n) = wish.kind {
            people += if room_of(base, building, wish.record).is_some() { n } else { 0 };
        }
        let Some(demand) = demand_of(base, building, wish.record, wish.kind) else { continue };
        out.push(Asked { demand, origin: Origin::Drawing(wish.kind.name().into()), ground: None });
    }
    if people > 0 {
        let wide = item("rooms", DemandKind::WideFor, Bound::default());
        let demand = Demand { people: Some(people), ..wide };
        out.push(Asked { demand, origin: Origin::Drawing("OccupancyNumber".into()), ground: None });
    }
    out
}

/// Turning circle of a wheelchair and clear width of its doors, metres: DIN 18040-2 (September 2011), 5.1 and table 1.
const TURNING_M: f64 = 1.5;
const WHEELCHAIR_DOOR_M: f64 = 0.9;
/// The least sight angle of a view: EN 17037:2018+A1:2021, table A.5.
const OUTLOOK_DEG: f64 = 14.0;

fn demand_of(base: &Understood, building: &Building, record: usize, kind: WishKind) -> Option<Demand> {
    let least = |v: f64| Bound { least: Some(v), ..Bound::default() };
    let room = room_of(base, building, record);
    let number = room.map(|r| (r.0 + 1).to_string());
    Some(match kind {
        WishKind::PlannedAreaM2(area) => item(&number?, DemandKind::Area, Bound::planned(area)),
        WishKind::Outlook => item(&number?, DemandKind::SightOut, least(OUTLOOK_DEG)),
        WishKind::Accessible => match number {
            Some(number) => item(&number, DemandKind::TurningCircle, least(TURNING_M)),
            None => {
                let opening = building.openings.iter().find(|o| o.record == Some(record))?;
                let room = (0..2).find_map(|s| match opening.beside[s] {
                    enfilade_plan::floor::Beside::Room(r) => Some(r),
                    _ => None,
                })?;
                item(&format!("doors of {}", room + 1), DemandKind::ClearWidth, least(WHEELCHAIR_DOOR_M))
            }
        },
        WishKind::Occupants(_) | WishKind::FireExit => return None,
    })
}

fn item(subject: &str, kind: DemandKind, bound: Bound) -> Demand {
    Demand {
        weight: Weight::Limit,
        subject: subject.to_owned(),
        kind,
        bound,
        other: None,
        through: Vec::new(),
        is_shut: false,
        over: Default::default(),
        people: None,
    }
}

/// The room that a space is: its outline holds the middle of the room.
fn room_of(base: &Understood, building: &Building, record: usize) -> Option<RoomId> {
    let rings = || base.space_rings.iter().filter(|s| s.0 == record).map(|s| &s.1);
    let holds = |at: PointUm| rings().any(|ring| side_of_ring(ring, at) == Side::Inside);
    building.rooms.iter().position(|r| holds(r.area.at)).map(RoomId)
}

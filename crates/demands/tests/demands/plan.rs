//! Plans for tests, in metres.

use enfilade_brief::demand::Demand;
use enfilade_demands::{Answer, Asked, Building, Opening, Room, Verdict, check};
use enfilade_engine::geometry::PointUm;
use enfilade_plan::axes::OpeningKind;
use enfilade_plan::floor::{Area, Beside};
use enfilade_plan::kinds::RoomKind;

pub fn um(p: [f64; 2]) -> PointUm {
    p.map(|v| (v * 1e6).round() as i64)
}

/// A room by its outline.
pub fn room(name: &str, kind: RoomKind, outline: &[[f64; 2]]) -> Room {
    let at = outline[0];
    let outline: Vec<PointUm> = outline.iter().map(|p| um(*p)).collect();
    let area = Area { outline, holes: Vec::new(), area_m2: 0.0, at: um(at) };
    let name = (!name.is_empty()).then(|| name.to_owned());
    Room { name, kind, is_sure: true, area }
}

/// A rectangle from its lower left to its upper right corner.
pub fn boxed([x0, y0]: [f64; 2], [x1, y1]: [f64; 2]) -> [[f64; 2]; 4] {
    [[x0, y0], [x1, y0], [x1, y1], [x0, y1]]
}

/// An opening: its jambs on the axis, the thickness of its wall, what lies to its left and to its right.
pub fn opening(kind: OpeningKind, jambs: [[f64; 2]; 2], thickness_m: f64, beside: [Beside; 2]) -> Opening {
    let [a, b] = jambs;
    let width_m = (b[0] - a[0]).hypot(b[1] - a[1]);
    Opening { kind, jambs: jambs.map(um), thickness_m, width_m, beside, leaves: Vec::new(), record: None }
}

/// A hall of 2 × 6 m with its entrance in the south. East of it lie a kitchen of 3 × 2.9 m with a window, and a bath of
/// 3 × 3 m; a storage stands alone.
pub fn flat() -> Building {
    use OpeningKind::{Door, Window};
    let [hall, kitchen, bath] = [0, 1, 2].map(Beside::Room);
    Building {
        rooms: vec![
            room("Hall", RoomKind::Hall, &boxed([0.0, 0.0], [2.0, 6.0])),
            room("Kitchen", RoomKind::Kitchen, &boxed([2.1, 3.1], [5.1, 6.0])),
            room("Bath", RoomKind::Bath, &boxed([2.1, 0.0], [5.1, 3.0])),
            room("Box room", RoomKind::Storage, &boxed([8.0, 0.0], [9.0, 4.0])),
        ],
        openings: vec![
            opening(Door, [[2.05, 4.0], [2.05, 4.9]], 0.1, [hall, kitchen]),
            opening(Door, [[2.05, 1.0], [2.05, 1.8]], 0.1, [hall, bath]),
            opening(Door, [[0.5, -0.15], [1.5, -0.15]], 0.3, [hall, Beside::Outside]),
            opening(Window, [[5.25, 4.0], [5.25, 5.5]], 0.3, [kitchen, Beside::Outside]),
        ],
        ..Building::default()
    }
}

/// The answer to one item.
pub fn answer(building: &Building, item: &str) -> Answer {
    let demand: Demand = item.parse().unwrap();
    check(building, &[Asked::said(demand)]).remove(0)
}

/// Its verdict and the value at the first place.
pub fn first(building: &Building, item: &str) -> (Verdict, Option<f64>) {
    let answer = answer(building, item);
    (answer.verdict, answer.findings.first().and_then(|f| f.measured))
}

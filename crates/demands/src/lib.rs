//! The brief of rooms: what is asked of rooms, doors and ways, and whether a layout has it.
//!
//! Every item is checked on exact polygons: outlines of rooms, joined by their openings. It passes, it fails, or a plan
//! cannot tell. Nothing is searched here, and nothing written.
//!
//! A room of 4 × 3 m, of which somebody wants 13 m²:
//!
//! ```
//! use enfilade_brief::demand::Demand;
//! use enfilade_demands::{Asked, Building, Room, Verdict, check};
//! use enfilade_plan::floor::Area;
//! use enfilade_plan::kinds::RoomKind;
//!
//! let outline = [[0, 0], [4, 0], [4, 3], [0, 3]].map(|p: [i64; 2]| p.map(|v| v * 1_000_000)).to_vec();
//! let area = Area { outline, holes: vec![], area_m2: 12.0, at: [2_000_000, 1_500_000] };
//! let room = Room { name: Some("Kitchen".into()), kind: RoomKind::Kitchen, is_sure: true, area };
//! let building = Building { rooms: vec![room], ..Building::default() };
//!
//! let asked: Demand = "kitchen area min 13 m2".parse()?;
//! let answers = check(&building, &[Asked::said(asked)]);
//! assert_eq!(answers[0].verdict, Verdict::Fail);
//! assert!((answers[0].findings[0].measured.unwrap() - 12.0).abs() < 1e-6);
//! # Ok::<(), String>(())
//! ```

use enfilade_brief::demand::{Bound, Demand, DemandKind};

mod answer;
mod building;
mod fence;
mod items;
mod peak;
mod polygon;
mod rules;
mod select;
#[cfg(test)]
mod shapely_tests;
mod site;
mod view;
mod walk;

pub use answer::{Answer, Asked, Finding, Mark, Origin, Verdict};
pub use building::{Building, Exit, Opening, OpeningId, Room, RoomId};
pub use rules::{RuleSet, rule_names, rule_set};

/// Between what the value of an item should lie: as it is said, or as its kind has it.
pub fn bound_of(demand: &Demand) -> Bound {
    let least = demand.people.and_then(items::width_for);
    if demand.kind == DemandKind::WideFor { Bound { least, ..demand.bound } } else { demand.bound }
}

/// Checks items on a building, in their order.
pub fn check(building: &Building, asked: &[Asked]) -> Vec<Answer> {
    let site = site::Site::new(building);
    asked.iter().map(|a| Answer::new(a.clone(), items::findings(&site, a))).collect()
}

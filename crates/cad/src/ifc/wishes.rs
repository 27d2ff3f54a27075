//! What the standard's property sets of spaces and doors ask: planned areas, people, a view, exits, access.

use super::building::Building;
use super::step::{Arg, Step, Value};
use crate::wish::{Wish, WishKind};

/// Keywords of what may be asked of.
const ASKED: [&str; 3] = ["IFCSPACE", "IFCDOOR", "IFCDOORSTANDARDCASE"];

/// Property sets of the standard begin so.
const STANDARD: &str = "Pset_";

/// What all spaces and doors ask, in the order of the file.
pub(super) fn wishes(b: &Building<'_, '_>) -> Vec<Wish> {
    let mut out: Vec<Wish> = Vec::new();
    let elements = ASKED.iter().flat_map(|k| b.step.all(k)).map(|i| i.id);
    for id in elements {
        let sets = [b.model.properties.get(&id), b.model.of_types.get(&id)];
        for set in sets.into_iter().flatten().flatten() {
            for kind in in_set(b.step, *set, b.units.area_m2) {
                // What an element says itself counts before what its type says.
                let is_known = |w: &Wish| w.record == id as usize && w.kind.name() == kind.name();
                if !out.iter().rev().take_while(|w| w.record == id as usize).any(is_known) {
                    out.push(Wish { record: id as usize, kind });
                }
            }
        }
    }
    out
}

fn in_set(step: &Step<'_>, set: u64, m2: f64) -> Vec<WishKind> {
    let args = step.args(set);
    let is_standard = args.get(2).and_then(|a| step.text(a)).is_some_and(|n| n.starts_with(STANDARD));
    let properties = args.get(4).filter(|_| is_standard).map(Arg::ids).unwrap_or_default();
    let said = |property: u64| {
        let of = step.args(property);
        let name = of.first().and_then(|a| step.text(a))?;
        wish(name.trim(), of.get(2)?, m2)
    };
    properties.into_iter().filter_map(said).collect()
}

/// Largest planned area that is believed, m²: a hall of ten hectares.
const AREA_MAX_M2: f64 = 1e5;

fn wish(name: &str, value: &Arg, m2: f64) -> Option<WishKind> {
    let flag = || is_true(&value.value);
    match name {
        "NetPlannedArea" => {
            let area = number(&value.value)? * m2;
            (area > 0.0 && area <= AREA_MAX_M2).then_some(WishKind::PlannedAreaM2(area))
        }
        "OccupancyNumber" => {
            let count = number(&value.value).filter(|n| *n >= 1.0 && *n <= 1e6)?;
            Some(WishKind::Occupants(count as u32))
        }
        "IsOutlookDesirable" => flag().then_some(WishKind::Outlook),
        "FireExit" => flag().then_some(WishKind::FireExit),
        "HandicapAccessible" => flag().then_some(WishKind::Accessible),
        _ => None,
    }
}

fn number(value: &Value) -> Option<f64> {
    match value {
        Value::Number(n) => Some(*n),
        Value::Typed(_, inner) => number(&inner.first()?.value),
        _ => None,
    }
}

fn is_true(value: &Value) -> bool {
    match value {
        Value::Enum(e) => e == "T",
        Value::Typed(_, inner) => inner.first().is_some_and(|a| is_true(&a.value)),
        _ => false,
    }
}

//! Units of a project.

use super::step::{Arg, Step};
use crate::drawing::Unit;

/// Lengths by name, metres.
const NAMED: &[(&str, f64)] = &[
    ("mm", 0.001),
    ("cm", 0.01),
    ("dm", 0.1),
    ("m", 1.0),
    ("km", 1000.0),
    ("in", 0.0254),
    ("ft", 0.3048),
    ("US survey ft", 1200.0 / 3937.0),
    ("yd", 0.9144),
];

/// What the project says about units.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Units {
    /// Unit of length, if one is stated.
    pub length: Option<Unit>,
    /// The file's words for it.
    pub length_words: String,
    /// Radians in one unit of plane angle.
    pub radians: f64,
    /// Square metres in one unit of area.
    pub area_m2: f64,
}

/// Reads the units of the first project.
pub(super) fn units(step: &Step<'_>) -> Units {
    let mut out =
        Units { length: None, length_words: "no unit of length".into(), radians: 1.0, area_m2: 1.0 };
    let assignment = step
        .all("IFCPROJECT")
        .chain(step.all("IFCPROJECTLIBRARY"))
        .find_map(|p| step.args_of(p).get(8)?.id());
    let assignment = assignment.or_else(|| step.all("IFCUNITASSIGNMENT").next().map(|u| u.id));
    let list = assignment.map(|a| step.args(a)).and_then(|a| Some(a.first()?.ids())).unwrap_or_default();
    for id in list {
        let args = step.args(id);
        let is = |kind: &str| args.get(1).is_some_and(|a| a.is(kind));
        if is("LENGTHUNIT")
            && let Some(metres) = factor(step, id, 0).filter(|m| m.is_finite() && *m > 0.0)
        {
            out.length = Some(Unit { name: name_of(metres), metres });
            out.length_words = words(step, id, &args);
        } else if is("PLANEANGLEUNIT")
            && let Some(radians) = factor(step, id, 0).filter(|r| r.is_finite() && *r > 0.0)
        {
            out.radians = radians;
        } else if is("AREAUNIT")
            && let Some(m2) = area_factor(step, id, 0).filter(|m| m.is_finite() && *m > 0.0)
        {
            out.area_m2 = m2;
        }
    }
    out
}

fn name_of(metres: f64) -> &'static str {
    let near = |(_, m): &&(&str, f64)| (metres / m - 1.0).abs() < 1e-6;
    NAMED.iter().find(near).map_or("unit", |(name, _)| name)
}

fn words(step: &Step<'_>, id: u64, args: &[Arg]) -> String {
    let keyword = step.keyword(id);
    if keyword == "IFCSIUNIT" {
        let part = |i: usize| match args.get(i).map(|a| &a.value) {
            Some(super::step::Value::Enum(e)) => e.to_lowercase(),
            _ => String::new(),
        };
        return format!("IfcSIUnit {}{}", part(2), part(3));
    }
    let name = args.get(2).and_then(|a| step.text(a)).unwrap_or_default();
    format!("IfcConversionBasedUnit {name}")
}

/// Metres or radians in one of a unit.
fn factor(step: &Step<'_>, id: u64, depth: usize) -> Option<f64> {
    let args = step.args(id);
    match &*step.keyword(id) {
        "IFCSIUNIT" => {
            let super::step::Value::Enum(name) = &args.get(3)?.value else { return None };
            let base = matches!(name.to_ascii_uppercase().as_str(), "METRE" | "RADIAN");
            let prefix = match &args.get(2)?.value {
                super::step::Value::Enum(p) => prefix(p)?,
                _ => 1.0,
            };
            base.then_some(prefix)
        }
        "IFCCONVERSIONBASEDUNIT" | "IFCCONVERSIONBASEDUNITWITHOFFSET" if depth < 8 => {
            let measure = step.args(args.get(3)?.id()?);
            Some(measure.first()?.number()? * factor(step, measure.get(1)?.id()?, depth + 1)?)
        }
        _ => None,
    }
}

/// Square metres in one of a unit. A prefix is that of the metre.
fn area_factor(step: &Step<'_>, id: u64, depth: usize) -> Option<f64> {
    let args = step.args(id);
    match &*step.keyword(id) {
        "IFCSIUNIT" => {
            let by = match &args.get(2)?.value {
                super::step::Value::Enum(p) => prefix(p)?,
                _ => 1.0,
            };
            args.get(3)?.is("SQUARE_METRE").then_some(by * by)
        }
        "IFCCONVERSIONBASEDUNIT" | "IFCCONVERSIONBASEDUNITWITHOFFSET" if depth < 8 => {
            let measure = step.args(args.get(3)?.id()?);
            Some(measure.first()?.number()? * area_factor(step, measure.get(1)?.id()?, depth + 1)?)
        }
        _ => None,
    }
}

fn prefix(name: &str) -> Option<f64> {
    let power = match name.to_ascii_uppercase().as_str() {
        "EXA" => 18,
        "PETA" => 15,
        "TERA" => 12,
        "GIGA" => 9,
        "MEGA" => 6,
        "KILO" => 3,
        "HECTO" => 2,
        "DECA" => 1,
        "DECI" => -1,
        "CENTI" => -2,
        "MILLI" => -3,
        "MICRO" => -6,
        "NANO" => -9,
        "PICO" => -12,
        "FEMTO" => -15,
        "ATTO" => -18,
        _ => return None,
    };
    // 1e-3 is a better milli than 10 to the power of -3.
    format!("1e{power}").parse().ok()
}

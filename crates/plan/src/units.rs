//! Which unit a drawing is in: the user's word, heights of a building, else all evidence ([`super::reading::unit`]); and the
//! scale of a plan that is smaller than a building.

use super::frame::{BUILT_SIZE_M, SMALL_PLAN_M, UnitChoice, human_scale, scales, two_digits};
use super::reading::UnitSense;
use super::reading::clues::Clues;
use super::reading::unit::{self, Said, sense, sense_of, weigh};
use crate::sizes::{LAYERED_MAX_M, THICKNESS_MIN_M};
use enfilade_cad::drawing::{Drawing, Entity, Format, Unit};
use enfilade_cad::units::UNITS;

/// Thicknesses of walls, metres: a board to old masonry.
const THICK_M: [f64; 2] = [0.06, LAYERED_MAX_M];

/// Plans longer than this are never taken at an unknown scale.
const SCALELESS_MAX_M: f64 = 30.0;

/// The thickness that walls drawn at another scale are taken to have.
const USUAL_WALL_M: f64 = 0.15;

/// The width that a leaf is taken to have where the scale is found by it.
const USUAL_LEAF_M: f64 = 0.9;

/// Faces in pairs, and their share of all length, by which even a small drawing shows how thick its walls are.
const PAIRS_FEW: usize = 4;
const PAIRS_FEW_SHARE: f64 = 0.6;

/// Metres of the plan in one metre of a person, for plans drawn at an unknown scale (illustrations): decided by
/// the scale at which its doors are as wide as doors in a plan smaller than a building, by the thickness of the walls
/// where they are drawn with one, else by the plan's size ([`human_scale`]). What an IFC or a glTF says is believed
/// from the length of one wall on.
pub fn person_scale(drawing: &Drawing, walls: &[&Entity], extent_units: f64, unit: Unit) -> f64 {
    let size_m = extent_units * unit.metres;
    let is_stated = drawing.format != Format::Dxf && size_m >= BUILT_SIZE_M[0];
    if size_m >= SCALELESS_MAX_M || is_stated {
        return 1.0;
    }
    let seen = Clues::new(drawing, walls);
    if let Some(scale) =
        printed_at(&seen, unit).filter(|_| size_m < SMALL_PLAN_M && drawing.format == Format::Dxf)
    {
        return 1.0 / scale;
    }
    let is_thick = seen.gaps.len() >= PAIRS_FEW && seen.paired_share >= PAIRS_FEW_SHARE;
    let has_thickness = is_thick || unit::says_thickness(&seen);
    let thickness_m = seen.middle_gap().filter(|_| has_thickness).map(|t| t * unit.metres);
    match thickness_m {
        Some(t) if is_in(t, THICK_M) => 1.0,
        // Walls in layers are drawn with lines nearer to one another than faces are.
        Some(_) if size_m >= SMALL_PLAN_M && unit::doors(&seen, unit.metres) > 0.0 => 1.0,
        Some(t) if t > 0.0 && t < THICKNESS_MIN_M && size_m >= SMALL_PLAN_M => two_digits(t / USUAL_WALL_M),
        _ => human_scale(size_m),
    }
}

/// Whether plans drawn in this unit are printed at this scale.
pub(super) fn is_printed(unit: Unit, scale: f64) -> bool {
    unit.name != "units" && scales(unit).contains(&scale)
}

fn is_in(value: f64, range: [f64; 2]) -> bool {
    (range[0]..=range[1]).contains(&value)
}

/// Decides the unit: the user's word, else the one that what the file says and what is drawn make the likeliest; and how
/// sure that is.
pub fn choose(drawing: &Drawing, user: Option<Unit>, walls: &[&Entity]) -> (UnitChoice, UnitSense) {
    let said = &drawing.declared_unit_words;
    let sure =
        |code: &'static str| UnitSense { confidence: 1.0, reasons: vec![code], ..UnitSense::default() };
    if let Some(unit) = user {
        let what = match unit.name {
            "units" => format!("one drawing unit is {} m", unit.metres),
            name => name.into(),
        };
        let reason = format!("{what} as --unit or the settings file says (the file: {said})");
        return (UnitChoice { unit, reason, is_assumed: false }, sure("user"));
    }
    let seen = Clues::new(drawing, walls);
    if let Some(unit) = drawing.unit_by_heights {
        let words = words(&seen, unit);
        let reason = format!(
            "{} assumed by the height of the walls ({said}): then {words}; --unit overrides it",
            unit.name
        );
        return (UnitChoice { unit, reason, is_assumed: true }, sure("heights"));
    }
    let declared = drawing.declared_unit;
    let weighed = weigh(&seen, Said { declared, is_metric: drawing.written.is_metric });
    let likeliest = weighed.first().map_or(UNITS[0], |w| w.unit);
    // A building's heights were taken in the unit that its file or its format states.
    if let Some(unit) = declared.filter(|d| drawing.format != Format::Dxf || *d == likeliest) {
        let (mut reason, found) =
            (format!("{} by {said}; {}", unit.name, words(&seen, unit)), sense(&weighed));
        if unit != likeliest {
            let name = likeliest.name;
            reason += &format!("; in {name} {}: --unit {name} reads it so", words(&seen, likeliest));
            // An IFC's unit was held against the heights of its walls; a scene has its from the standard, not from its author.
            let found = match drawing.format {
                Format::Ifc => sure("header"),
                _ => sense_of(&weighed, unit),
            };
            return (UnitChoice { unit, reason, is_assumed: false }, found);
        }
        return (UnitChoice { unit, reason, is_assumed: false }, found);
    }
    let then = words(&seen, likeliest);
    let reason = match declared {
        Some(declared) => format!(
            "{} assumed although the file says {} ({said}): then {then}; in {} {}; --unit overrides it",
            likeliest.name,
            declared.name,
            declared.name,
            words(&seen, declared)
        ),
        None => format!("{} assumed ({said}): then {then}; --unit overrides it", likeliest.name),
    };
    (UnitChoice { unit: likeliest, reason, is_assumed: true }, sense(&weighed))
}

/// The scale at which a plan that is drawn as large as its paper is printed, of those that make a building of doors, walls
/// and size: one that is written, else the one by which leaves are as wide as usual. Without doors the only one written.
fn printed_at(seen: &Clues, unit: Unit) -> Option<f64> {
    let is_building = |scale: &f64| unit::is_building(seen, unit.metres * scale);
    let said: Vec<f64> = seen.scales.iter().copied().filter(is_building).collect();
    let leaves = seen.leaves();
    let Some(leaf_m) = leaves.get(leaves.len() / 2).map(|l| l * unit.metres) else {
        return said.first().copied().filter(|_| said.len() == 1);
    };
    let off = |scale: &f64| (leaf_m * scale / USUAL_LEAF_M).ln().abs();
    let nearest = |all: &[f64]| all.iter().copied().min_by(|a, b| off(a).total_cmp(&off(b)));
    nearest(&said).or_else(|| nearest(&scales(unit)).filter(is_building))
}

/// What a unit makes of what is drawn, in plain words.
fn words(seen: &Clues, unit: Unit) -> String {
    let mut words = vec![format!("the walls are {:.1} m long", seen.extent * unit.metres)];
    if let Some(d) = seen.middle_gap().filter(|_| unit::says_thickness(seen)) {
        words.push(format!("wall faces {:.2} m apart", d * unit.metres));
    }
    let leaves = seen.leaves();
    if let Some(middle) = leaves.get(leaves.len() / 2).map(|l| l * unit.metres) {
        words.push(match leaves.len() {
            1 => format!("1 door leaf of about {middle:.2} m"),
            n => format!("{n} door leaves of about {middle:.2} m"),
        });
    }
    words.join(", ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reading::clues::{Gap, Swing};
    use enfilade_cad::units::unit_by_name;

    fn unit(name: &str) -> Unit {
        unit_by_name(name).unwrap()
    }

    /// A plan in the millimetres of its paper: the scale is that which makes doors as wide as doors.
    #[test]
    fn doors_tell_the_scale_of_a_printed_plan() {
        for (scale, name) in
            [(50.0, "mm"), (100.0, "mm"), (200.0, "mm"), (100.0, "cm"), (96.0, "in"), (48.0, "in")]
        {
            let times = 1.0 / (unit(name).metres * scale);
            let swing = Swing { radius: 0.9 * times, has_leaf: true };
            let gap = Gap { nearest: 0.2 * times, beyond: Vec::new(), length: 4.0 * times };
            let mut seen = Clues {
                swings: vec![(swing, 5)],
                gaps: vec![gap; 20],
                paired_share: 0.9,
                extent: 14.0 * times,
                largest: 14.0 * times,
                ..Clues::default()
            };
            assert_eq!(printed_at(&seen, unit(name)), Some(scale), "{scale} {name}");
            seen.swings.clear();
            assert_eq!(printed_at(&seen, unit(name)), None);
            // What is written decides, where it makes a building.
            seen.scales = vec![scale * 1.2];
            assert_eq!(printed_at(&seen, unit(name)), Some(scale * 1.2));
            seen.scales = vec![scale, scale * 1.2];
            assert_eq!(printed_at(&seen, unit(name)), None, "either");
            seen.scales = vec![scale * 1.2, scale * 30.0];
            assert_eq!(printed_at(&seen, unit(name)), Some(scale * 1.2), "the other makes none");
        }
    }
}

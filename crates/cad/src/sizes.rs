//! Whether a building can be in the unit that its file states, by what its elements measure: heights and thicknesses
//! of walls, widths of doors, heights of storeys.
//!
//! A stated unit is believed as long as the walls can be that high in it. Where they cannot, the unit in which they can
//! is taken: no building has walls of three millimetres, and one read so shows nothing. Where they only might, or where
//! no unit that has a name helps, the file is believed and the doubt is told with the `--unit` that answers it.

use super::drawing::Unit;
use super::units::{HEIGHT_BELIEVED_M, implausible_by_heights};
use crate::units::UNITS;

/// Height of an opening above the floor, metres: that of a door (DIN 18100: 2.125 and less).
pub(crate) const OPENING_HEIGHT_M: f64 = 2.1;

/// Thickness of a leaf or a pane, metres: that of an inner door (DIN 68706-1: 39 to 42 mm).
pub(crate) const LEAF_M: f64 = 0.04;

/// How far below the floor of the storey an opening begins, metres: walls stand on the slab, and floors on a screed on its
/// insulation (DIN 18560-2: 45 mm and more, on 20 to 50).
pub(crate) const BELOW_FLOOR_M: f64 = 0.1;

/// An outline whose every inner point lies this near to it is solid.
pub const SOLID_HALF_WIDTH_M: f64 = 0.5;

/// What is measured, and what it usually is, metres.
const WITNESSES: [(&str, [f64; 2]); 4] = [
    ("walls {} high", [2.0, 6.0]),
    ("doors {} wide", [0.5, 2.5]),
    ("storeys {} high", [2.0, 6.0]),
    ("walls {} thick", [0.05, 0.8]),
];

/// Before a unit that walls could be high in is doubted, another must have so many witnesses more, and it so many at most.
const AGAINST_MIN: usize = 2;
const FOR_MAX: usize = 1;

/// Whole scenes in which nothing has a name, metres: heights that are believed, and heights and lengths that are usual.
const SCENE_BELIEVED_M: [f64; 2] = [1.0, 1_000.0];
const SCENE_USUAL_M: [[f64; 2]; 2] = [[2.2, 40.0], [4.0, 400.0]];

/// Powers of ten that are tried where no unit with a name helps.
const POWERS: std::ops::RangeInclusive<i32> = -9..=9;

/// Sizes of a building's elements, in its own unit.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sizes {
    /// Heights of walls.
    pub wall_heights: Vec<f64>,
    /// Widths of doors.
    pub door_widths: Vec<f64>,
    /// Heights of storeys, floor to floor.
    pub storey_heights: Vec<f64>,
    /// Thicknesses of walls.
    pub thicknesses: Vec<f64>,
    /// Height and length of everything, where nothing says what a wall is.
    pub scene: Option<[f64; 2]>,
}

/// What sizes say of a stated unit.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// It can be.
    Believed,
    /// It cannot be; the unit that is taken, and what stands against the stated one.
    Instead(Unit, String),
    /// It hardly can be: what stands against it, and the option that reads it otherwise.
    Doubted(String),
}

impl Sizes {
    /// Holds a stated unit against them.
    pub fn verdict(&self, stated: Unit) -> Verdict {
        if let Some(scene) = self.scene {
            return of_scene(scene, stated);
        }
        let middles = self.middles();
        let fits = |metres: f64| middles.iter().filter(|(_, m, usual)| is_in(m * metres, *usual)).count();
        if let Some(unit) = implausible_by_heights(&self.wall_heights, stated) {
            return Verdict::Instead(unit, words(&middles, stated.metres));
        }
        let is_impossible =
            middle(&self.wall_heights).is_some_and(|h| !is_in(h * stated.metres, HEIGHT_BELIEVED_M));
        let least = if is_impossible { 1 } else { AGAINST_MIN };
        let own = fits(stated.metres);
        match best(&fits).filter(|(_, metres)| own <= FOR_MAX && fits(*metres) >= own + least) {
            Some((option, metres)) => Verdict::Doubted(format!(
                "{} in {}, expected {}; --unit {option} reads it with {}",
                words(&middles, stated.metres),
                stated.name,
                usual_words(&middles),
                words(&middles, metres)
            )),
            None => Verdict::Believed,
        }
    }

    /// Of every witness that speaks its words, its middle and what is usual.
    fn middles(&self) -> Vec<(&'static str, f64, [f64; 2])> {
        let all = [&self.wall_heights, &self.door_widths, &self.storey_heights, &self.thicknesses];
        let of = |(list, (words, usual)): (&&Vec<f64>, (&'static str, [f64; 2]))| {
            Some((words, middle(list)?, usual))
        };
        all.iter().zip(WITNESSES).filter_map(of).collect()
    }
}

/// The unit with a name, else the power of ten, in which most fits; as `--unit` takes it, and its metres.
fn best(fits: &impl Fn(f64) -> usize) -> Option<(String, f64)> {
    let named = UNITS.into_iter().map(|u| (u.name.to_string(), u.metres));
    let powers = POWERS.map(|p| (format!("{}m", 10f64.powi(p)), 10f64.powi(p)));
    let all: Vec<(String, f64)> = named.chain(powers).collect();
    // The first of equals: units by how usual they are, powers after them.
    all.into_iter().rev().max_by_key(|(_, metres)| fits(*metres))
}

fn of_scene(scene: [f64; 2], stated: Unit) -> Verdict {
    let [height, length] = scene;
    if is_in(height * stated.metres, SCENE_BELIEVED_M) || height <= 0.0 {
        return Verdict::Believed;
    }
    let fits = |metres: f64| {
        scene.iter().zip(SCENE_USUAL_M).filter(|(size, usual)| is_in(*size * metres, *usual)).count()
    };
    let Some((option, metres)) = best(&fits).filter(|(_, metres)| fits(*metres) > 0) else {
        return Verdict::Believed;
    };
    let told = |metres: f64| format!("{} high and {} long", shown(height * metres), shown(length * metres));
    let [lo, hi] = SCENE_USUAL_M[0];
    Verdict::Doubted(format!(
        "all of it is {} in {}, expected {lo} to {hi} m high; --unit {option} reads it {}",
        told(stated.metres),
        stated.name,
        told(metres)
    ))
}

fn words(middles: &[(&str, f64, [f64; 2])], metres: f64) -> String {
    let of = |(words, middle, _): &(&str, f64, [f64; 2])| words.replace("{}", &shown(middle * metres));
    middles.iter().map(of).collect::<Vec<_>>().join(", ")
}

fn usual_words(middles: &[(&str, f64, [f64; 2])]) -> String {
    let of = |(words, _, [lo, hi]): &(&str, f64, [f64; 2])| words.replace("{}", &format!("{lo} to {hi} m"));
    middles.iter().map(of).collect::<Vec<_>>().join(", ")
}

/// A length with three digits.
fn shown(metres: f64) -> String {
    let digits = (2.0 - metres.abs().max(1e-9).log10().floor()).clamp(0.0, 9.0) as usize;
    format!("{metres:.digits$} m")
}

fn middle(sizes: &[f64]) -> Option<f64> {
    let mut known: Vec<f64> = sizes.iter().copied().filter(|h| h.is_finite() && *h > 0.0).collect();
    known.sort_by(f64::total_cmp);
    known.get(known.len() / 2).copied()
}

fn is_in(value: f64, range: [f64; 2]) -> bool {
    (range[0]..=range[1]).contains(&value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::unit_by_name;

    fn house(times: f64) -> Sizes {
        Sizes {
            wall_heights: vec![2.7 * times; 3],
            door_widths: vec![0.9 * times],
            storey_heights: vec![3.0 * times],
            thicknesses: vec![0.2 * times],
            scene: None,
        }
    }

    #[test]
    fn a_unit_in_which_walls_cannot_stand_is_replaced() {
        let unit = |name| unit_by_name(name).unwrap();
        for (real, stated) in [("m", "mm"), ("mm", "m"), ("cm", "m"), ("m", "cm"), ("in", "mm"), ("mm", "in")]
        {
            let sizes = house(1.0 / unit(real).metres);
            assert_eq!(sizes.verdict(unit(real)), Verdict::Believed, "{real}");
            let Verdict::Instead(found, words) = sizes.verdict(unit(stated)) else {
                panic!("{real} as {stated}: {:?}", sizes.verdict(unit(stated)))
            };
            assert_eq!(found.name, real, "{real} as {stated}");
            assert!(words.contains("walls ") && words.contains("doors "), "{words}");
        }
    }

    #[test]
    fn a_unit_that_might_be_is_believed_and_doubted() {
        let unit = |name| unit_by_name(name).unwrap();
        let Verdict::Doubted(words) = house(1.0).verdict(unit("ft")) else { panic!() };
        assert!(words.starts_with("walls 0.823 m high") && words.contains("--unit m reads it"), "{words}");
        let alone = Sizes { wall_heights: vec![2.7], ..Sizes::default() };
        assert_eq!(alone.verdict(unit("ft")), Verdict::Believed, "one witness is none");
        let tiny = Sizes { wall_heights: vec![2.7e-3], ..Sizes::default() };
        for sizes in [house(1e-3), tiny] {
            let Verdict::Doubted(words) = sizes.verdict(unit("m")) else { panic!() };
            assert!(words.contains("--unit 1000m reads it"), "{words}");
        }
        assert_eq!(unit("1000m").metres, 1000.0);
        assert_eq!(Sizes::default().verdict(unit("mm")), Verdict::Believed);
    }

    #[test]
    fn a_scene_without_names_speaks_by_its_height() {
        let of = |height: f64, length: f64| {
            Sizes { scene: Some([height, length]), ..Sizes::default() }.verdict(UNITS[0])
        };
        for height in [1.0, 8.0, 1_000.0, 0.0] {
            assert_eq!(of(height, 20.0), Verdict::Believed, "{height}");
        }
        for (height, length, words) in [
            (8_000.0, 20_000.0, "--unit mm reads it 8.00 m high and 20.0 m long"),
            (2_600.0, 1_800.0, "--unit cm reads it 26.0 m high and 18.0 m long"),
            (0.008, 0.02, "--unit 1000m reads it 8.00 m high"),
        ] {
            assert!(matches!(of(height, length), Verdict::Doubted(w) if w.contains(words)), "{words}");
        }
    }
}

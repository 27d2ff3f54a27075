//! Units that a drawing can be in, by name and by the heights of a building.

use crate::drawing::Unit;

/// Units the user can name, and the order in which a missing one is tried.
pub const UNITS: [Unit; 5] = [
    Unit { name: "m", metres: 1.0 },
    Unit { name: "mm", metres: 0.001 },
    Unit { name: "cm", metres: 0.01 },
    Unit { name: "in", metres: 0.0254 },
    Unit { name: "ft", metres: 0.3048 },
];

/// A unit by the name used on the command line, in markers and side-cars.
///
/// A number before it makes a unit of its own: `25m` says that one drawing unit is 25 m.
pub fn unit_by_name(name: &str) -> Option<Unit> {
    let letters = name.find(|c: char| c.is_ascii_alphabetic())?;
    let base = UNITS.into_iter().find(|u| u.name == &name[letters..])?;
    if letters == 0 {
        return Some(base);
    }
    let factor = name[..letters].trim().parse::<f64>().ok().filter(|f| f.is_finite() && *f > 0.0)?;
    Some(Unit { name: "units", metres: factor * base.metres })
}

/// Heights of walls, metres: those of which a stated unit is believed, and those by which one is found.
pub const HEIGHT_BELIEVED_M: [f64; 2] = [0.3, 60.0];

const HEIGHT_USUAL_M: [f64; 2] = [2.0, 6.0];

/// The height that walls have where none of the units makes them as high as usual.
const HEIGHT_M: f64 = 2.7;

/// The unit of a building by the heights of its walls (file units): the first in which the middle one is usual, else
/// the one in which it comes nearest to a storey. `None` without heights.
pub fn by_heights(heights: &[f64]) -> Option<Unit> {
    let middle = middle_height(heights)?;
    let off = |u: &Unit| (middle * u.metres / HEIGHT_M).ln().abs();
    let usual = UNITS.into_iter().find(|u| is_in(middle * u.metres, HEIGHT_USUAL_M));
    usual.or_else(|| UNITS.into_iter().min_by(|a, b| off(a).total_cmp(&off(b))))
}

/// The unit by the heights of walls where they cannot be as high as the stated one makes them.
pub fn implausible_by_heights(heights: &[f64], stated: Unit) -> Option<Unit> {
    let middle = middle_height(heights).filter(|h| !is_in(h * stated.metres, HEIGHT_BELIEVED_M))?;
    by_heights(&[middle]).filter(|u| is_in(middle * u.metres, HEIGHT_BELIEVED_M))
}

fn middle_height(heights: &[f64]) -> Option<f64> {
    let mut known: Vec<f64> = heights.iter().copied().filter(|h| h.is_finite() && *h > 0.0).collect();
    known.sort_by(f64::total_cmp);
    known.get(known.len() / 2).copied()
}

fn is_in(value: f64, range: [f64; 2]) -> bool {
    (range[0]..=range[1]).contains(&value)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit(name: &str) -> Unit {
        unit_by_name(name).unwrap()
    }

    #[test]
    fn the_height_of_walls_tells_the_unit() {
        for (heights, expected) in [
            (vec![2.6, 2.6, 5.0], "m"),
            (vec![3200.0, 2700.0, 400.0], "mm"),
            (vec![270.0], "cm"),
            (vec![120.0], "in"),
            (vec![9.0, 9.0, f64::NAN, 0.0], "ft"),
        ] {
            assert_eq!(by_heights(&heights).map(|u| u.name), Some(expected), "{heights:?}");
        }
        assert_eq!(by_heights(&[0.0, f64::INFINITY]), None);
        let doubted = |h: f64| implausible_by_heights(&[h], unit("m")).map(|u| u.name);
        assert_eq!((doubted(2700.0), doubted(1.0), doubted(40.0)), (Some("mm"), None, None));
        assert_eq!(doubted(0.027), None, "no unit makes a model as high as a house");
    }
}

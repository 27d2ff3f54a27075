//! Building works of an option, as programs that make them need them.

use serde::{Deserialize, Serialize};

use super::element::ElementRef;

/// What a work costs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Effort {
    /// Wall that is demolished, metres.
    pub demolished_m: f64,
    /// Wall that is built, metres.
    pub built_m: f64,
}

impl Effort {
    /// `1.8 m of wall goes, 0.9 m is built`; empty for nothing.
    pub fn words(&self) -> String {
        match (self.demolished_m > 0.0, self.built_m > 0.0) {
            (true, true) => {
                format!("{:.1} m of wall goes, {:.1} m is built", self.demolished_m, self.built_m)
            }
            (true, false) => format!("{:.1} m of wall goes", self.demolished_m),
            (false, true) => format!("{:.1} m is built", self.built_m),
            (false, false) => String::new(),
        }
    }

    /// Wall that goes or is built, metres.
    pub fn length_m(&self) -> f64 {
        self.demolished_m + self.built_m
    }

    /// Both together.
    #[must_use]
    pub fn and(self, other: &Self) -> Self {
        Self { demolished_m: self.demolished_m + other.demolished_m, built_m: self.built_m + other.built_m }
    }
}

/// A building work of an option, as a program that makes it needs it. Metres in the drawing frame.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct OptionWork {
    /// As in `works.json`.
    pub kind: String,
    /// Its name: `An opening of 1.8 m between kitchen and living room`.
    pub words: String,
    /// Ends of the stretch on the wall's axis.
    pub stretch: [[f64; 2]; 2],
    /// Clear width, or length.
    pub width_m: f64,
    /// The rooms on both sides, by their `id` in `works.json`; `null`: none.
    pub rooms: [Option<usize>; 2],
    /// What draws its wall.
    pub elements: Vec<ElementRef>,
    /// What it costs.
    pub effort: Effort,
    /// Outlines of what goes: along one face, and back along the other.
    pub demolished: Vec<[[f64; 2]; 4]>,
    /// What is walled up or newly built.
    pub built: Vec<BuiltWall>,
    /// What stands in a new opening: `nothing`, `door`, `glass`.
    pub filling: String,
    /// Jambs of the opening that it closes, widens or takes a door from.
    pub opening: Option<[[f64; 2]; 2]>,
    /// What stands on the storey above over wall that goes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub above: Option<Above>,
}

/// Walls of the storey above that stand over wall that a work takes away.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Above {
    /// The storey, as `--storey` names it.
    pub storey: String,
    /// What draws them.
    pub elements: Vec<ElementRef>,
    /// Length over which they do, metres.
    pub length_m: f64,
}

/// Says over how much of the wall that several works take away walls of the storey above stand: empty over none.
pub fn above_words(works: &[OptionWork]) -> String {
    let all: Vec<&Above> = works.iter().filter_map(|w| w.above.as_ref()).collect();
    let Some(first) = all.first() else { return String::new() };
    let length_m: f64 = all.iter().map(|a| a.length_m).sum();
    let mut names: Vec<String> = all.iter().flat_map(|a| &a.elements).map(ElementRef::name).collect();
    names.sort();
    names.dedup();
    let more = names.len().saturating_sub(ABOVE_NAMED);
    names.truncate(ABOVE_NAMED);
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    format!("Over {length_m:.1} m of it walls of storey {:?} stand: {}{more}", first.storey, names.join(", "))
}

/// Walls above that are named one by one.
const ABOVE_NAMED: usize = 3;

impl OptionWork {
    /// Where it is, behind its name: `, at 12.3, 4.5 m`, the middle of its stretch.
    pub fn place_words(&self) -> String {
        let [x, y] = [0, 1].map(|k| f64::midpoint(self.stretch[0][k], self.stretch[1][k]));
        // Never −0.
        let tenth = |v: f64| (v * 10.0).round() / 10.0 + 0.0;
        format!(", at {:.1}, {:.1} m", tenth(x), tenth(y)).replace('-', "−")
    }
}

/// The names of several works in one line: `An opening of 1.8 m between …; a door of 0.9 m in …`.
pub fn titles(works: &[OptionWork]) -> String {
    let title = |(i, w): (usize, &OptionWork)| {
        let mut letters = w.words.chars();
        match (i, letters.next()) {
            (1.., Some(first)) => first.to_lowercase().chain(letters).collect(),
            _ => w.words.clone(),
        }
    };
    works.iter().enumerate().map(title).collect::<Vec<_>>().join("; ")
}

/// Said of works that are allowed since doors of private rooms are shut.
pub const SHOWS_PRIVATE: &str = "It shows more of a private room while that room's door stands open";

/// A straight wall that is built. Metres in the drawing frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BuiltWall {
    /// Ends of its axis.
    pub ends: [[f64; 2]; 2],
    /// Distance of its faces, 0 for a single line.
    pub thickness_m: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_work_says_where_it_is() {
        let of = |stretch| OptionWork { stretch, ..OptionWork::default() }.place_words();
        assert_eq!(of([[1.0, -2.0], [2.5, -2.0]]), ", at 1.8, −2.0 m");
        assert_eq!(of([[-0.02, 0.0], [0.0, 0.0]]), ", at 0.0, 0.0 m");
    }
}

//! What stays unless somebody says otherwise: walls that carry, that hold fire up, that part dwellings.

use std::collections::BTreeMap;

use super::names::folded;

/// Why a wall is part of the structure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Bearing {
    /// The file says that it carries.
    Stated,
    /// The file says how long it holds fire up.
    Fire,
    /// Its name, its type, its material or its layer says that it carries.
    Named,
    /// The same of fire.
    NamedFire,
    /// The same of parting dwellings.
    Party,
    /// It stands at a stair or a lift.
    Core,
    /// It stands between columns.
    Columns,
    /// It stands over a wall of the storey below, or under one of the storey above.
    Stacked,
}

impl Bearing {
    /// In plain words, after a number of walls.
    pub fn words(self) -> &'static str {
        match self {
            Self::Stated => "load-bearing by their property",
            Self::Fire => "with a fire rating",
            Self::Named => "load-bearing by their name, material or layer",
            Self::NamedFire => "fire walls by their name or layer",
            Self::Party => "party walls by their name or layer",
            Self::Core => "round a stair or a lift",
            Self::Columns => "between columns",
            Self::Stacked => "over or under another wall",
        }
    }
}

/// Words by which people say that a wall does not carry, as in `nichttragend`.
const DENIALS: &[&str] = &["nicht", "non", "not ", "niet", "no portante", "sin carga", "unbelast"];

/// Words of walls that carry, folded; they may stand within others.
const CARRYING: &[&str] = &[
    "tragend",
    "loadbearing",
    "load bearing",
    "load-bearing",
    "stahlbeton",
    "reinforced concrete",
    "shear wall",
    "structural",
    "porteur",
    "portante",
    "muro de carga",
    "dragend",
    "strc",
];

/// Words of walls that hold fire up.
const FIRE: &[&str] = &[
    "brandwand",
    "fire wall",
    "firewall",
    "fire-wall",
    "fire rated",
    "fire-rated",
    "coupe-feu",
    "tagliafuoco",
];

/// Words of walls between dwellings.
const PARTY: &[&str] =
    &["party wall", "wohnungstrenn", "demising", "mitoyen", "woningscheidend", "medianera"];

/// What a name says.
pub fn by_name(name: &str) -> Option<Bearing> {
    let name = folded(&name.replace('_', " "));
    let has = |words: &[&str]| words.iter().any(|w| name.contains(w));
    if has(CARRYING) && !has(DENIALS) {
        return Some(Bearing::Named);
    }
    has(FIRE).then_some(Bearing::NamedFire).or(has(PARTY).then_some(Bearing::Party))
}

/// How many walls stay and why, in plain words; `None` where none does.
pub fn words(bearing: &BTreeMap<usize, Bearing>) -> Option<String> {
    let mut counts: BTreeMap<Bearing, usize> = BTreeMap::new();
    bearing.values().for_each(|b| *counts.entry(*b).or_default() += 1);
    let parts: Vec<String> = counts.iter().map(|(b, n)| format!("{n} {}", b.words())).collect();
    (!parts.is_empty()).then(|| {
        format!("structure that stays by default: {} (--allow structure frees it)", parts.join(", "))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_say_what_carries() {
        for (name, expected) in [
            ("Beton tragend", Some(Bearing::Named)),
            ("Mauerwerk nichttragend", None),
            ("Wand nicht tragend 11,5", None),
            ("Interior - Non-Load-Bearing", None),
            ("A-WALL-STRC", Some(Bearing::Named)),
            ("Party Wall - CMU Residential Unit Dimising Wall", Some(Bearing::Party)),
            ("BRANDWAND F90", Some(Bearing::NamedFire)),
            ("A-WALL", None),
            ("Fireplace", None),
        ] {
            assert_eq!(by_name(name), expected, "{name}");
        }
    }
}

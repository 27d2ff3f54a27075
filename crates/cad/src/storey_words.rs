//! Names that say of which storey something is: `WALL-EG`, `1.OG`, `Level 2`, `Ground floor`.

/// Words that name a storey, lower case.
const STOREYS: &[&str] = &["basement", "rdc"];

/// How words that name a storey end: `erdgeschoss`.
const ENDINGS: &[&str] = &["geschoss", "geschoß"];

/// Words that name a storey and other things too, as a first bedroom: lower case.
const ORDINALS: &[&str] = &[
    "ground", "first", "second", "third", "fourth", "fifth", "1st", "2nd", "3rd", "4th", "5th", "upper",
    "lower", "top",
];

/// Of these the ones that name a storey only beside a word for one: `upper floor`, not `upper`.
const ONLY_BESIDE: &[&str] = &["fourth", "fifth", "4th", "5th", "upper", "lower", "top"];

/// What names a storey behind its number: `1OG`, `2F`, `2階`.
const NUMBERED: &[&str] = &["eg", "og", "ug", "kg", "dg", "f", "fl", "階"];

/// What names one without a number too.
const UNNUMBERED: &[&str] = &["eg", "og", "ug", "kg", "dg"];

/// Of these the ones that a building has several of: `1.OG`, `OG 2`.
const SEVERAL: &[&str] = &["og", "ug", "obergeschoss", "obergeschoß", "untergeschoss", "untergeschoß"];

/// What names a storey before its number: `LEVEL-1`, `floor 02`.
const LEVELS: &[&str] = &[
    "level",
    "floor",
    "storey",
    "story",
    "etage",
    "étage",
    "stock",
    "geschoss",
    "niveau",
    "piano",
    "piso",
    "planta",
    "nivel",
    "andar",
    "verdieping",
];

/// A name that has a storey in it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct StoreyName {
    /// The words for the storey, as written, one blank between them: `Level 1`.
    pub storey: String,
    /// The other words, lower case, one blank between them.
    pub rest: String,
    /// Whether nothing else can be meant: `first` may be the first of anything, `first floor` not.
    pub is_sure: bool,
}

/// The storey that a name has in it, if it has one.
pub fn storey_name(name: &str) -> Option<StoreyName> {
    let written: Vec<&str> = name.split(|c: char| !c.is_alphanumeric()).filter(|w| !w.is_empty()).collect();
    let lower: Vec<String> = written.iter().map(|w| w.to_lowercase()).collect();
    let words: Vec<&str> = lower.iter().map(String::as_str).collect();
    let taken = (0..words.len()).find_map(|i| named_at(&words, i))?;
    let is_sure = taken.iter().any(|k| !ORDINALS.contains(&words[*k]));
    let rest = (0..words.len()).filter(|k| !taken.contains(k)).map(|k| words[k]);
    Some(StoreyName {
        storey: taken.iter().map(|k| written[*k]).collect::<Vec<_>>().join(" "),
        rest: rest.collect::<Vec<_>>().join(" "),
        is_sure,
    })
}

fn is_number(word: &str) -> bool {
    !word.is_empty() && word.chars().all(|c| c.is_ascii_digit())
}

/// The words, by their places, that name a storey with the one at a place.
fn named_at(words: &[&str], i: usize) -> Option<Vec<usize>> {
    let word = words[i];
    let before = i.checked_sub(1).filter(|k| is_number(words[*k]));
    let after = Some(i + 1).filter(|k| words.get(*k).is_some_and(|w| is_number(w)));
    let level_after = Some(i + 1).filter(|k| words.get(*k).is_some_and(|w| LEVELS.contains(w)));
    let digits = word.trim_start_matches(|c: char| c.is_ascii_digit());
    let has_digits = digits.len() < word.len();
    let ends_in_number = |starts: &[&str]| starts.iter().any(|l| word.strip_prefix(l).is_some_and(is_number));
    if LEVELS.contains(&word) {
        return after.map(|k| vec![i, k]).or_else(|| before.map(|k| vec![k, i]));
    }
    if SEVERAL.contains(&word) {
        let number = before.or(after);
        return Some(number.map_or_else(|| vec![i], |k| vec![i.min(k), i.max(k)]));
    }
    if ORDINALS.contains(&word) {
        let alone = (!ONLY_BESIDE.contains(&word)).then(|| vec![i]);
        return level_after.map(|k| vec![i, k]).or(alone);
    }
    let is_one = STOREYS.contains(&word)
        || ENDINGS.iter().any(|e| word.ends_with(e))
        || UNNUMBERED.contains(&word)
        || has_digits && NUMBERED.contains(&digits)
        || ends_in_number(LEVELS)
        || ends_in_number(UNNUMBERED);
    is_one.then(|| vec![i])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn storeys_are_read_from_names_of_layers_and_of_gltf_nodes() {
        for (name, expected) in [
            ("WALL-EG", Some(("EG", "wall", true))),
            ("Wände 1OG", Some(("1OG", "wände", true))),
            ("Wände 1.OG", Some(("1 OG", "wände", true))),
            ("OG 2", Some(("OG 2", "", true))),
            ("UG1", Some(("UG1", "", true))),
            ("2. Obergeschoss", Some(("2 Obergeschoss", "", true))),
            ("2. Etage", Some(("2 Etage", "", true))),
            ("A-WALL-2F", Some(("2F", "a wall", true))),
            ("A_WALL_LEVEL_02", Some(("LEVEL 02", "a wall", true))),
            ("level1-walls", Some(("level1", "walls", true))),
            ("Floor_01", Some(("Floor 01", "", true))),
            ("Storey 2", Some(("Storey 2", "", true))),
            ("Ground floor", Some(("Ground floor", "", true))),
            ("Upper floor", Some(("Upper floor", "", true))),
            ("4th Floor", Some(("4th Floor", "", true))),
            ("A-WALL-First", Some(("First", "a wall", false))),
            ("Second bedroom", Some(("Second", "bedroom", false))),
            ("3. Stock", Some(("3 Stock", "", true))),
            ("Niveau 2", Some(("Niveau 2", "", true))),
            ("Untergeschoß", Some(("Untergeschoß", "", true))),
            ("FIRST", Some(("FIRST", "", false))),
            ("Upper cabinets", None),
            ("A-WALL-2", None),
            ("WALL-P1", None),
            ("wall high", None),
            ("Piano", None),
            ("Floor", None),
        ] {
            let found = storey_name(name);
            let found = found.as_ref().map(|s| (s.storey.as_str(), s.rest.as_str(), s.is_sure));
            assert_eq!(found, expected, "{name}");
        }
    }
}

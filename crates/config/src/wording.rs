//! What is wrong with a settings file, in the words of those who write one.

/// The words of the reader of TOML and ours for them.
const WORDS: [(&str, &str); 10] = [
    (
        "data did not match any variant of untagged enum ViewText",
        "expected a name, a number or a box, [xmin, ymin, xmax, ymax]",
    ),
    ("invalid type: ", "found "),
    ("invalid value: ", "found "),
    ("missing field ", "missing key "),
    ("expected usize", "expected a whole number of 0 or more"),
    ("expected u64", "expected a whole number of 0 or more"),
    ("expected f64", "expected a number"),
    ("expected a sequence", "expected a list, [...]"),
    ("expected an array of length 2", "expected a pair of numbers, [x, y]"),
    ("expected a boolean", "expected true or false"),
];

/// What a value is written like, where the reader of TOML took it for the beginning of another.
const VALUES: &str = "numbers stand bare, texts in quotes, yes and no are true and false";

/// Edits that turn an unknown key into a known one, at most.
const SUGGESTED_EDITS: usize = 3;

/// A message of the reader of TOML as a person would say it; an unknown key gets the nearest known one.
pub(super) fn plain(message: &str) -> String {
    if let Some((unknown, known)) = unknown_field(message) {
        return unknown_key(unknown, &known);
    }
    let text = WORDS.iter().fold(message.to_owned(), |text, (theirs, ours)| text.replace(theirs, ours));
    if is_of_a_value(message) { format!("{text}; {VALUES}") } else { text }
}

/// What there is instead of a key that is not known, the nearest first.
pub(super) fn unknown_key(unknown: &str, known: &[&str]) -> String {
    let near = known.iter().map(|k| (strsim::damerau_levenshtein(unknown, k), *k)).min();
    let near = near.filter(|(edits, _)| *edits <= SUGGESTED_EDITS);
    let meant = near.map_or_else(String::new, |(_, k)| format!("did you mean `{k}`? "));
    format!("unknown key `{unknown}`; {meant}known are {}", known.join(", "))
}

/// Whether a value could not even be told: a text without quotes is taken for the beginning of a boolean or a number.
fn is_of_a_value(message: &str) -> bool {
    ["invalid boolean", "invalid float", "must be quoted"].iter().any(|said| message.contains(said))
}

/// The key at which a text of settings goes wrong, as it is written there.
pub(super) fn key_at(text: &str, at: usize) -> Option<&str> {
    let rest = text.get(at..)?.trim_start_matches(['[', ' ']);
    let key = &rest[..rest.find(['=', ']', '\n', '\r']).unwrap_or(rest.len())].trim();
    (!key.is_empty()).then_some(*key)
}

fn unknown_field(message: &str) -> Option<(&str, Vec<&str>)> {
    let mut quoted = message.strip_prefix("unknown field ")?.split('`').skip(1).step_by(2);
    Some((quoted.next()?, quoted.collect()))
}

/// Line, counted from 1, on which a key is set.
pub(super) fn line_of_key(text: &str, key: &str) -> Option<usize> {
    let sets = |line: &str| {
        line.trim_start().strip_prefix(key).is_some_and(|rest| rest.trim_start().starts_with('='))
    };
    text.lines().position(sets).map(|at| at + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_readers_words_become_ours() {
        let said = "invalid type: string \"five\", expected usize";
        assert_eq!(plain(said), "found string \"five\", expected a whole number of 0 or more");
        let said = "unknown field `membres`, expected one of `unit`, `members`";
        assert_eq!(plain(said), "unknown key `membres`; did you mean `members`? known are unit, members");
        let said = "unknown field `colour-of-doors`, expected `unit` or `members`";
        assert_eq!(plain(said), "unknown key `colour-of-doors`; known are unit, members");
    }

    #[test]
    fn a_text_without_quotes_is_told_what_values_look_like() {
        for text in ["evaluations = thirty", "unit = mm", "members = none", "only-marked = yes"] {
            let error = toml::from_str::<toml::Table>(text).unwrap_err();
            let said = plain(error.message());
            assert!(said.contains("texts in quotes"), "{text}: {said}");
        }
        let error = toml::from_str::<toml::Table>("a = 1\na = 2").unwrap_err();
        assert!(!plain(error.message()).contains("quotes"), "{}", error.message());
    }

    #[test]
    fn a_key_is_found_where_it_is_set() {
        let text = "# unit\nunits = 3\n  unit = \"m\"\n";
        assert_eq!(line_of_key(text, "unit"), Some(3));
        assert_eq!(line_of_key(text, "seed"), None);
    }
}

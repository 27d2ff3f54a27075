//! Layers of ours: the user's marks, what results are drawn on, and names that were meant to be marks.

use super::names::base_name;

/// Region of query.
pub const QUERY: &str = "EF-QUERY";
/// Region of reference.
pub const REFERENCE: &str = "EF-REFERENCE";
/// Groups that may move.
pub const MOVE: &str = "EF-MOVE";
/// Words that clauses of moves begin with.
pub const CLAUSES: [&str; 6] = ["x", "y", "along", "rotate", "scale", "name"];
/// What must stay.
pub const KEEP: &str = "EF-KEEP";
/// Stretches of wall that are to be opened.
pub const OPEN: &str = "EF-OPEN";
/// Pieces of wall that are to go.
pub const REMOVE: &str = "EF-REMOVE";
/// Walls that are to be built.
pub const NEW: &str = "EF-NEW";
/// What was demolished: no wall any more.
pub const DEMOLISHED: &str = "EF-DEMOLISHED";
/// Where one leaves the building.
pub const EXIT: &str = "EF-EXIT";
/// Ground that is to be seen from the rooms that the layer's name says: `EF-SEE-hall`.
pub const SEE: &str = "EF-SEE";
/// Ground that is not to be seen from them: `EF-HIDE-hall`.
pub const HIDE: &str = "EF-HIDE";
/// All layers of marks.
pub const MARKS: [&str; 7] = [MOVE, KEEP, QUERY, REFERENCE, OPEN, REMOVE, NEW];

/// Moved elements are traced here.
pub const MOVED: &str = "EF-MOVED";
/// Where they stood.
pub const BEFORE: &str = "EF-BEFORE";
/// What moved and what it gains.
pub const NOTE: &str = "EF-NOTE";
/// What one opening in each wall would bring.
pub const WORKS: &str = "EF-WORKS";
/// Layers of items of the brief start so, with the number of the item behind.
pub const BRIEF_PREFIX: &str = "EF-BRIEF-";
/// Layers of coloured cells start so.
pub const HEAT_PREFIX: &str = "EF-HEAT-";

/// Colour of moved elements.
pub const MOVED_RGB: [u8; 3] = [0xd5, 0x00, 0x5f];
/// Colour of where they stood.
pub const BEFORE_RGB: [u8; 3] = [0x8c, 0x90, 0x98];
/// Yellow of what is demolished, as conversion plans have it.
pub const DEMOLISHED_RGB: [u8; 3] = [0xf2, 0xb5, 0x00];
/// Colour of words.
pub const NOTE_RGB: [u8; 3] = [0x00, 0x50, 0x82];

/// Shortest beginning of a mark's name that counts as it.
const BEGINNING_MIN: usize = 3;

/// A layer's name as marks are known by it: without the prefix of a bound or attached reference, without blanks
/// around it.
pub fn bare(layer: &str) -> &str {
    base_name(layer).trim()
}

/// The pair that a layer's name says, lower case: `EF-QUERY-Entrance` is the region of query of `entrance`.
/// CAD programs that allow it may write `EF-QUERY:Entrance`.
pub fn pair_of(layer: &str, kind: &str) -> Option<String> {
    let (head, rest) = layer.split_at_checked(kind.len())?;
    let name = rest.strip_prefix(['-', ':', '_'])?.trim();
    let folded = name.to_lowercase().replace(char::is_whitespace, "-");
    (head.eq_ignore_ascii_case(kind) && !folded.is_empty()).then_some(folded)
}

/// The last name that the clauses of a move give: `name WORD`.
pub fn name_in(text: &str) -> Option<String> {
    let clauses = text.split([';', '\n']).map(|c| c.split_whitespace().collect::<Vec<_>>());
    let mut named = clauses.filter(|words| words.len() > 1 && words[0].eq_ignore_ascii_case("name"));
    named.next_back().map(|words| words[1..].join(" "))
}

/// Whether results are drawn on a layer (the user's marks are not).
pub fn is_result(layer: &str) -> bool {
    let begins = |prefix: &str| layer.get(..prefix.len()).is_some_and(|p| p.eq_ignore_ascii_case(prefix));
    begins(HEAT_PREFIX)
        || begins(BRIEF_PREFIX)
        || [MOVED, BEFORE, NOTE, WORKS].iter().any(|l| l.eq_ignore_ascii_case(layer))
}

/// Whether a layer holds marks of the user's.
pub fn is_marker(layer: &str) -> bool {
    let name = bare(layer);
    MARKS.iter().any(|m| m.eq_ignore_ascii_case(name))
        || EXIT.eq_ignore_ascii_case(name)
        || [QUERY, REFERENCE, SEE, HIDE].iter().any(|m| pair_of(name, m).is_some())
}

/// Whether a layer holds what was demolished.
pub fn is_demolished(layer: &str) -> bool {
    bare(layer).eq_ignore_ascii_case(DEMOLISHED)
}

/// Whether a layer is one of ours: marks, results, and what was meant to be marks.
pub fn is_own(layer: &str) -> bool {
    let name = bare(layer);
    let begins = name.get(..2).is_some_and(|p| p.eq_ignore_ascii_case("EF"));
    begins && (is_marker(name) || is_result(name) || is_demolished(name) || meant(name).is_some())
}

/// The layer of marks that a name was meant to be: `EF_MOVE`, `EF MOVE`, `EF-MOVE-1`, `EF-MOV` are meant as `EF-MOVE`.
/// None for a name that is read, and for one of results.
pub fn meant(layer: &str) -> Option<&'static str> {
    let name = bare(layer);
    if !name.get(..2)?.eq_ignore_ascii_case("EF") || is_marker(name) || is_result(name) || is_demolished(name)
    {
        return None;
    }
    let letters = |s: &str| s.chars().filter(|c| c.is_alphanumeric()).collect::<String>().to_lowercase();
    let rest = letters(&name[2..]);
    let is_near = |kind: &&&str| {
        let kind = letters(&kind[2..]);
        let is_beginning = rest.chars().count() >= BEGINNING_MIN && kind.starts_with(&rest);
        let is_slip = kind.chars().count() > BEGINNING_MIN && is_one_slip(&rest, &kind);
        rest.starts_with(&kind) || is_beginning || is_slip
    };
    MARKS.iter().find(is_near).copied()
}

/// Whether two words differ by one letter: another, one too many, one too few, or two exchanged.
fn is_one_slip(a: &str, b: &str) -> bool {
    let [a, b]: [Vec<char>; 2] = [a, b].map(|s| s.chars().collect());
    let same = a.iter().zip(&b).take_while(|(x, y)| x == y).count();
    let ends = |i: usize, j: usize| a.get(i..).is_some_and(|rest| b.get(j..) == Some(rest));
    let exchanged = a.len() > same + 1
        && b.len() > same + 1
        && [a[same], a[same + 1]] == [b[same + 1], b[same]]
        && ends(same + 2, same + 2);
    a != b && (ends(same + 1, same + 1) || ends(same + 1, same) || ends(same, same + 1) || exchanged)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_were_meant_to_be_marks() {
        let cases = [
            ("EF_MOVE", Some(MOVE)),
            ("EF MOVE", Some(MOVE)),
            ("EFMOVE", Some(MOVE)),
            ("EF-MOVE-1", Some(MOVE)),
            ("xref$0$EF_MOVE", Some(MOVE)),
            ("EF-MOEV", Some(MOVE)),
            ("ef-quer", Some(QUERY)),
            ("EF-KEEPS", Some(KEEP)),
            ("EF-REF", Some(REFERENCE)),
            ("EF-QUERYING", Some(QUERY)),
            ("EF-MOVE", None),
            (" ef-move ", None),
            ("xref$0$EF-MOVE", None),
            ("EF-OPENING", Some(OPEN)),
            ("EF_REMOVE", Some(REMOVE)),
            ("EF NEW", Some(NEW)),
            ("EF-NET", None),
            ("EF-EXIT", None),
            ("ef-see-hall", None),
            ("EF-HIDE_bath", None),
            ("EF-open", None),
            ("EF-QUERY_2", None),
            ("EF-MOVED", None),
            ("EF-FURN", None),
            ("EF-NOTE-MY", None),
            ("EF", None),
            ("EFFLUENT", None),
            ("REMOVE", None),
        ];
        for (layer, expected) in cases {
            assert_eq!(meant(layer), expected, "{layer}");
        }
        for layer in ["EF-FURN", "EF-NOTE-MY", "EF-NET", "EFFLUENT", "é"] {
            assert!(!is_own(layer), "{layer}");
        }
        for layer in
            ["EF-NOTE", "ef-heat-degree", "EF-BRIEF-12", "xref$0$EF-MOVE", "EF_KEEP", "ef-query:hall"]
        {
            assert!(is_own(layer), "{layer}");
        }
    }
}

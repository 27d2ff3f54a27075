//! Lengths and areas as people write them: `3,50`, `12'-6"`, `28.51 m²`, `A: 12.4`, `14'2'' x 12'4''`.

/// Metres in an inch.
const INCH_M: f64 = 0.0254;

/// Square metres in a square foot.
const SQUARE_FOOT_M2: f64 = 0.092_903_04;

/// Longest text of which a whole length is read; longer ones are notes.
const LENGTH_CHARS_MAX: usize = 16;

/// Words for areas with the square metres of one, behind or before the number.
const AREAS: [(&str, f64); 18] = [
    ("m²", 1.0),
    ("m2", 1.0),
    ("m^2", 1.0),
    ("㎡", 1.0),
    ("mq", 1.0),
    ("qm", 1.0),
    ("sqm", 1.0),
    ("sq.m", 1.0),
    ("sq m", 1.0),
    ("м²", 1.0),
    ("м2", 1.0),
    ("平米", 1.0),
    ("sq ft", SQUARE_FOOT_M2),
    ("sq.ft", SQUARE_FOOT_M2),
    ("sqft", SQUARE_FOOT_M2),
    ("ft²", SQUARE_FOOT_M2),
    ("ft2", SQUARE_FOOT_M2),
    ("sf", SQUARE_FOOT_M2),
];

/// Words that introduce an area in square metres, before `:` or `=`.
const INTRODUCING: [&str; 11] =
    ["a", "f", "s", "area", "fläche", "flaeche", "nf", "ngf", "superficie", "sup", "surface"];

/// A length as it is written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Length {
    /// With its unit, metres.
    Metres(f64),
    /// A number alone.
    Bare {
        /// The number.
        value: f64,
        /// Digits behind its point, without zeros at the end.
        decimals: usize,
    },
}

/// The length that a whole text states, > 0.
pub fn length(text: &str) -> Option<Length> {
    let text = text.trim();
    if text.is_empty() || text.chars().count() > LENGTH_CHARS_MAX {
        return None;
    }
    let marks = marks(text);
    if marks.contains(['\'', '"']) {
        return imperial(&marks).map(Length::Metres);
    }
    let start = marks.find(|c: char| c.is_ascii_digit())?;
    let (value, decimals, rest) = number(&marks[start..])?;
    if value <= 0.0 || rest.contains(|c: char| c.is_ascii_digit()) {
        return None;
    }
    Some(match rest.trim() {
        "m" => Length::Metres(value),
        "cm" => Length::Metres(value * 0.01),
        "mm" => Length::Metres(value * 0.001),
        _ => Length::Bare { value, decimals },
    })
}

/// The area that a line of a text states, square metres, > 0; a room's length by its width too.
pub fn area_m2(text: &str) -> Option<f64> {
    text.lines().find_map(|line| of_line(&line.to_lowercase()).or_else(|| by_sides(line)))
}

/// Whether a text states a length in feet or inches.
pub fn is_imperial(text: &str) -> bool {
    let marks = marks(text.trim());
    marks.contains(['\'', '"']) && imperial(&marks).is_some()
}

/// How many metres a text says that one on paper stands for, whole and more than 1: `1:600`, `Scale 1 : 50`, `M=1:100`. The
/// first that it names; a line that states an area (`Room 1: 12 m²`) names none.
pub fn printed_scale(text: &str) -> Option<f64> {
    text.lines().filter(|line| area_m2(line).is_none()).find_map(scale_in)
}

fn scale_in(line: &str) -> Option<f64> {
    let of = |(at, _): (usize, &str)| {
        let before = line[..at].trim_end().strip_suffix('1')?;
        let is_one = !before.ends_with(|c: char| c.is_ascii_digit() || ".,:/".contains(c));
        let (scale, decimals, rest) = number(line[at + 1..].trim_start())?;
        let is_whole = decimals == 0 && !rest.starts_with([':', '.', ',']);
        (is_one && is_whole && scale > 1.0).then_some(scale)
    };
    line.match_indices(':').find_map(of)
}

/// Primes as ASCII marks, commas between digits as points.
fn marks(text: &str) -> String {
    let plain = text.replace(['’', '′', '´'], "'").replace(['”', '″', '“'], "\"").replace("''", "\"");
    plain.replace(',', ".")
}

/// The number at the start of a text, its decimals and what follows.
fn number(text: &str) -> Option<(f64, usize, &str)> {
    let is_part = |c: char| c.is_ascii_digit() || c == '.';
    let end = text.find(|c: char| !is_part(c)).unwrap_or(text.len());
    let digits = text[..end].trim_end_matches('.');
    let value = digits.parse().ok()?;
    let decimals = digits.split_once('.').map_or(0, |(_, d)| d.trim_end_matches('0').len());
    Some((value, decimals, &text[digits.len()..]))
}

/// Feet and inches with marks: `12'-6"`, `8'1`, `37"`, `3'-1 1/2"`.
fn imperial(text: &str) -> Option<f64> {
    let text = text.trim_start_matches(|c: char| !c.is_ascii_digit());
    let (first, _, rest) = number(text)?;
    let (feet, rest) = match rest.trim_start().strip_prefix('\'') {
        Some(rest) => (first, rest.trim_start_matches([' ', '-'])),
        None => (0.0, text),
    };
    let inches = rest.trim().trim_end_matches('"');
    let mut sum = 0.0;
    for part in inches.split([' ', '-']).filter(|p| !p.is_empty()) {
        sum += match part.split_once('/') {
            Some((a, b)) => a.parse::<f64>().ok()? / b.parse::<f64>().ok().filter(|b| *b > 0.0)?,
            None => part.parse().ok()?,
        };
    }
    let metres = (12.0 * feet + sum) * INCH_M;
    (metres > 0.0).then_some(metres)
}

/// An area with its word, lower case.
fn of_line(line: &str) -> Option<f64> {
    let line = line.replace(',', ".");
    let mut from = 0;
    while let Some(start) = line[from..].find(|c: char| c.is_ascii_digit()).map(|i| from + i) {
        let (value, _, rest) = number(&line[start..])?;
        let is_own = !line[..start].ends_with(|c: char| c.is_alphanumeric() || c == '^');
        if is_own && value > 0.0 {
            let behind = rest.trim_start();
            let is_word = |w: &str| {
                behind.strip_prefix(w).is_some_and(|more| !more.starts_with(|c: char| c.is_alphanumeric()))
            };
            let before = introduction(&line[..start]);
            let area = AREAS.iter().find(|(w, _)| is_word(w));
            if let Some((_, m2)) = area.or_else(|| AREAS.iter().find(|(w, _)| before == Some(w))) {
                return Some(value * m2);
            }
            if before.is_some_and(|w| INTRODUCING.contains(&w))
                && !behind.starts_with(|c: char| c.is_alphanumeric())
            {
                return Some(value);
            }
        }
        from = line.len() - rest.len();
    }
    None
}

/// The word before a number that `:` or `=` joins to it: `a` of `A: 12.4`, `m2` of `area (m2) : 2.7`.
fn introduction(before: &str) -> Option<&str> {
    let before = before.trim_end().strip_suffix([':', '='])?.trim_end().trim_end_matches([')', ']']);
    before.rsplit(|c: char| c.is_whitespace() || "([".contains(c)).next()
}

/// Length by width: `14'2'' x 12'4''`, `4,20 x 3,10 m`.
fn by_sides(line: &str) -> Option<f64> {
    let (a, b) = line.split_once(['x', 'X', '×'])?;
    let metres = |text: &str| match length(text)? {
        Length::Metres(m) => Some(m),
        Length::Bare { value, decimals } => (decimals > 0 && value < 100.0).then_some(value),
    };
    Some(metres(a)? * metres(b)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_read_as_they_are_written() {
        let bare = |value, decimals| Some(Length::Bare { value, decimals });
        for (text, expected) in [
            ("3,50", bare(3.5, 1)),
            ("3.515", bare(3.515, 3)),
            ("4500", bare(4500.0, 0)),
            ("R1.08", bare(1.08, 2)),
            ("7.24 m", Some(Length::Metres(7.24))),
            ("12'-6\"", Some(Length::Metres(150.0 * INCH_M))),
            ("14'2''", Some(Length::Metres(170.0 * INCH_M))),
            ("8'1", Some(Length::Metres(97.0 * INCH_M))),
            ("37\"", Some(Length::Metres(37.0 * INCH_M))),
            ("1'-1 1/2\"", Some(Length::Metres(13.5 * INCH_M))),
            ("1:100", None),
            ("2.5/3", None),
            ("living room", None),
            ("", None),
            ("0", None),
        ] {
            assert_eq!(length(text), expected, "{text}");
        }
        assert!(is_imperial("3'-1\"") && !is_imperial("don't") && !is_imperial("3.5"));
    }

    #[test]
    fn scales_are_read_as_they_are_written() {
        for (text, expected) in [
            ("1:600", Some(600.0)),
            ("Ground floor, scale 1 : 50", Some(50.0)),
            ("M=1:100 (A3)", Some(100.0)),
            ("11:20", None),
            ("1:05", Some(5.0)),
            ("01:30:15", None),
            ("1:2.5", None),
            ("1:1", None),
            ("Room 1: 12 m²", None),
            ("Kitchen 1: 9 m²\nScale 1:20", Some(20.0)),
            ("no scale", None),
        ] {
            assert_eq!(printed_scale(text), expected, "{text}");
        }
    }

    #[test]
    fn areas_are_read_as_they_are_written() {
        for (text, expected) in [
            ("28.51 m²", Some(28.51)),
            ("mq=28,51", Some(28.51)),
            ("Küche\nA: 12.4", Some(12.4)),
            ("면적(M2) : 2.70", Some(2.7)),
            ("AREA 366 SF(34sqm)", Some(366.0 * SQUARE_FOOT_M2)),
            ("12m2", Some(12.0)),
            ("4.20 x 3.10", Some(4.2 * 3.1)),
            ("5' x 8'", Some(40.0 * SQUARE_FOOT_M2)),
            ("M 1:100", None),
            ("room 12", None),
            ("Box 3", None),
            ("A4", None),
        ] {
            let found = area_m2(text);
            let is_same = match (found, expected) {
                (Some(a), Some(b)) => (a - b).abs() < 1e-6,
                (a, b) => a == b,
            };
            assert!(is_same, "{text}: {found:?}");
        }
    }
}

//! What is measured in plain words, and how numbers are written for people.

use enfilade_brief::{Growth, Measure};

pub use enfilade_brief::Wording;

/// What results name beside the measures: the penalties, and means under names of their own.
const OWN: &[Wording] = &[
    Wording {
        key: "degree_all",
        plain: "Visibility of all",
        technical: "degree, all cells",
        unit: "m² seen",
        meaning: "How much of the whole plan that is measured can be seen from a spot, not of the region of \
                  reference alone.",
        more_less: ["", ""],
    },
    Wording {
        key: "clearance_m2",
        plain: "Tight spots",
        technical: "clearance",
        unit: "m²",
        meaning: "The area in which two walls that do not touch come closer than 1 m to each other, \
                  counted for every such pair of which one can move.",
        more_less: ["more tight spots", "fewer tight spots"],
    },
    Wording {
        key: "wall_length_m",
        plain: "Wall added or lost",
        technical: "wall length",
        unit: "m",
        meaning: "By how much the total length of walls differs from the present layout.",
        more_less: ["", ""],
    },
    Wording {
        key: "alignment",
        plain: "Out of line",
        technical: "alignment",
        unit: "rad²",
        meaning: "How far the moved walls turn away from the main directions of the drawing.",
        more_less: ["less aligned", "better aligned"],
    },
    Wording {
        key: "disconnection",
        plain: "Cut-off space",
        technical: "disconnection",
        unit: "",
        meaning: "Space that can be reached today and could not be reached any more. Options with any \
                  are turned down.",
        more_less: ["space is cut off", ""],
    },
    Wording {
        key: "overlap",
        plain: "Walls crossing",
        technical: "overlap",
        unit: "",
        meaning: "Walls that cross each other and did not before.",
        more_less: ["walls cross", ""],
    },
    Wording {
        key: "passage_m",
        plain: "Passages narrowed",
        technical: "passage",
        unit: "m",
        meaning: "By how much ways between walls have become narrower than 0.9 m, or than they were where \
                  they were narrower already, summed over all of them.",
        more_less: ["narrower passages", "fewer narrow passages"],
    },
    Wording {
        key: "room_area_m2",
        plain: "Room lost",
        technical: "room area",
        unit: "m²",
        meaning: "The floor that rooms have lost, doors and passages taken as closed, summed over all rooms; what others gain does not make up for it.",
        more_less: ["rooms lose floor", "rooms keep their floor"],
    },
    Wording {
        key: "mean_depth",
        plain: "Mean distance in views",
        technical: "mean depth",
        unit: "steps",
        meaning: "The number of straight views it takes on average to reach the other spots.",
        more_less: ["more turns", "fewer turns"],
    },
];

/// What pages explain first: what nearly every one of them has, then floor area.
const FIRST: [&str; 19] = [
    "degree",
    "degree_all",
    "depth",
    "entropy",
    "score",
    "clearance_m2",
    "wall_length_m",
    "alignment",
    "disconnection",
    "overlap",
    "passage_m",
    "mean-depth",
    "reach",
    "isovist-area",
    "isovist-perimeter",
    "isovist-compactness",
    "isovist-occlusivity",
    "room_area_m2",
    "connectivity",
];
/// What they explain last.
const LAST: [&str; 3] = ["integration", "mean_depth", "clustering"];

/// Everything that has plain words, in the order in which pages explain it: between the first and the last in that of
/// the table.
pub fn wordings() -> impl Iterator<Item = &'static Wording> {
    let named = |keys: &'static [&'static str]| keys.iter().filter_map(|key| wording(key));
    let rest = measures().chain(OWN).filter(|w| !FIRST.contains(&w.key) && !LAST.contains(&w.key));
    named(&FIRST).chain(rest).chain(named(&LAST))
}

fn measures() -> impl Iterator<Item = &'static Wording> {
    enfilade_brief::entries().map(|e| &e.words)
}

/// The wording of a measure, by its name in result.json.
pub fn wording(key: &str) -> Option<&'static Wording> {
    measures().chain(OWN).find(|w| w.key == key)
}

/// Whether a measure is told in sentences: it has words for more and less of it.
pub fn is_told(key: &str) -> bool {
    wording(key).is_some_and(|w| w.more_less != ["", ""])
}

/// Whether a measure counts cells, which people are told as area.
pub fn counts_cells(key: &str) -> bool {
    let key = key.strip_suffix(CHANGE).unwrap_or(key);
    let base = parts(key).0;
    base == "degree_all" || Measure::by_name(base).is_some_and(|m| m.entry().growth == Growth::Cells)
}

/// What ends the key of a map of how a measure changes.
pub const CHANGE: &str = "-change";

/// A name fit to show: the plain one, else the key with spaces and a capital.
pub fn plain_name(key: &str) -> String {
    if let Some(measure) = key.strip_suffix(CHANGE) {
        return format!("Change of {}", plain_name(measure).to_lowercase());
    }
    let (base, part) = parts(key);
    match wording(base) {
        Some(w) => format!("{}{part}", w.plain),
        None => sentence_case(key).replace('@', ", "),
    }
}

/// The measure of a key, and of which of its cells it tells: `degree-p10` is the degree, `, lowest 10 %`;
/// `degree@main-hall` is the degree, ` (main hall)`.
pub fn parts(key: &str) -> (&str, String) {
    if let Some((key, pair)) = key.split_once('@') {
        let (base, part) = parts(key);
        return (base, format!("{part} ({})", pair.replace(['-', '_'], " ")));
    }
    let percent = |how: &str| how.strip_prefix('p').and_then(|p| p.parse::<u8>().ok());
    match key.rsplit_once('-') {
        Some((base, "min")) => (base, ", least".to_owned()),
        Some((base, "max")) => (base, ", most".to_owned()),
        Some((base, how)) => match percent(how) {
            Some(50) => (base, ", median".to_owned()),
            Some(p) if p > 50 => (base, format!(", highest {} %", 100u8.saturating_sub(p))),
            Some(p) => (base, format!(", lowest {p} %")),
            None => (key, String::new()),
        },
        None => (key, String::new()),
    }
}

/// `door-3` → `Door 3`. Names with spaces are left alone but for the capital.
pub fn sentence_case(name: &str) -> String {
    let name: Vec<char> = name.trim().chars().collect();
    let is_digit = |i: Option<usize>| i.and_then(|i| name.get(i)).is_some_and(char::is_ascii_digit);
    let between_digits = |i: usize| is_digit(i.checked_sub(1)) && is_digit(Some(i + 1));
    let spaced = name.iter().enumerate().map(|(i, &c)| match c {
        '-' if between_digits(i) => '-',
        '-' | '_' => ' ',
        other => other,
    });
    let spaced: String = spaced.collect();
    let mut letters = spaced.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// Figures below are the rounding of coordinates, a micrometre each, added up over the walls of a layout.
const NOISE: f64 = 1e-5;

/// A number with about three significant digits, thin spaces between thousands and a true minus;
/// `–` if it does not exist.
pub fn number(value: f64) -> String {
    let size = value.abs();
    let decimals = match size {
        s if !s.is_finite() => return "–".to_owned(),
        s if s >= 99.95 || s == 0.0 => 0,
        s if s >= 9.995 => 1,
        s if s >= 0.0995 => 2,
        s if s >= 0.000_995 => 4,
        s if s < NOISE => return "0".to_owned(),
        _ => return format!("{value:.1e}").replace('-', "−"),
    };
    fixed(value, decimals)
}

/// Decimals beyond which numbers are not told apart.
const APART_DECIMALS_MAX: usize = 9;

/// Numbers as [`number`] writes them, with as many decimals more as it takes to tell each from the next.
pub fn numbers_apart<const N: usize>(values: [f64; N]) -> [String; N] {
    let differ = |texts: &[String; N]| (1..N).all(|i| values[i - 1] == values[i] || texts[i - 1] != texts[i]);
    let plain = values.map(number);
    let mut ways =
        std::iter::once(plain.clone()).chain((0..=APART_DECIMALS_MAX).map(|d| values.map(|v| fixed(v, d))));
    ways.find(differ).unwrap_or(plain)
}

/// A number with that many decimals, thin spaces between thousands and a true minus.
pub fn fixed(value: f64, decimals: usize) -> String {
    let text = format!("{:.decimals$}", value.abs());
    let (whole, rest) = text.split_at(text.find('.').unwrap_or(text.len()));
    let is_zero = text.chars().all(|c| c == '0' || c == '.');
    let sign = if value < 0.0 && !is_zero { "−" } else { "" };
    format!("{sign}{}{rest}", grouped(whole))
}

/// A number without needless zeros: two decimals below 10, one below 100, none above.
pub fn short(value: f64) -> String {
    let size = value.abs();
    trimmed(value, usize::from(size < 9.995) + usize::from(size < 99.95))
}

/// A number with at most so many decimals, none of them a zero that ends it.
pub fn trimmed(value: f64, decimals: usize) -> String {
    let text = fixed(value, decimals);
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

fn grouped(digits: &str) -> String {
    if digits.len() < 5 {
        return digits.to_owned();
    }
    let mut out = String::new();
    for (i, c) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            out.push('\u{202f}');
        }
        out.push(c);
    }
    out
}

/// The change in per cent with its sign: `+18 %`, `−9 %`, `±0 %`; `None` if the base is 0 or a value
/// does not exist.
pub fn percent_change(from: f64, to: f64) -> Option<String> {
    let change = (to - from) / from.abs() * 100.0;
    if from == 0.0 || !change.is_finite() {
        return None;
    }
    let decimals = usize::from(change.abs() < 9.95);
    let text = fixed(change.abs(), decimals);
    let is_zero = text.chars().all(|c| c == '0' || c == '.');
    let sign = if is_zero {
        "±"
    } else if change < 0.0 {
        "−"
    } else {
        "+"
    };
    let text = if is_zero { "0" } else { text.trim_end_matches(".0") };
    Some(format!("{sign}{text} %"))
}

/// Round values that divide a range evenly (1-2-5 times a power of ten), at most `most` + 1.
pub fn ticks(lo: f64, hi: f64, most: usize) -> Vec<f64> {
    let span = hi - lo;
    if !(span > 0.0 && span.is_finite()) || most == 0 {
        return if lo.is_finite() { vec![lo] } else { Vec::new() };
    }
    let step = nice_at_least(span / most as f64);
    let (first, last) = ((lo / step - 1e-9).ceil() as i64, (hi / step + 1e-9).floor() as i64);
    (first..=last).map(|k| k as f64 * step).collect()
}

/// The smallest of 1, 2, 5 times a power of ten that is at least `size` (> 0).
pub fn nice_at_least(size: f64) -> f64 {
    let power = 10f64.powi(size.log10().floor() as i32);
    [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .map(|m| m * power)
        .find(|v| *v >= size * (1.0 - 1e-9))
        .unwrap_or(power * 10.0)
}

/// The largest of 1, 2, 5 times a power of ten that is at most `size` (> 0).
pub fn nice_at_most(size: f64) -> f64 {
    let power = 10f64.powi(size.log10().floor() as i32);
    [5.0, 2.0, 1.0].into_iter().map(|m| m * power).find(|v| *v <= size * (1.0 + 1e-9)).unwrap_or(power)
}

/// Writes ticks with the decimals their step needs.
pub fn tick_labels(ticks: &[f64]) -> Vec<String> {
    let step = ticks.windows(2).map(|w| w[1] - w[0]).fold(f64::INFINITY, f64::min);
    if !step.is_finite() {
        return ticks.iter().map(|t| number(*t)).collect();
    }
    let decimals = (-step.log10()).ceil().clamp(0.0, 9.0) as usize;
    ticks.iter().map(|t| fixed(*t, decimals)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_as_people_write_them() {
        let cases = [
            (0.0, "0"),
            (-0.0, "0"),
            (1.0, "1.00"),
            (16.8333, "16.8"),
            (-2.308, "−2.31"),
            (1234.4, "1234"),
            (12_345.6, "12\u{202f}346"),
            (1_234_567.0, "1\u{202f}234\u{202f}567"),
            (0.05, "0.0500"),
            (2e-5, "2.0e−5"),
            (-1.6e-7, "0"),
            (1.4e-6, "0"),
            (f64::NAN, "–"),
        ];
        for (value, expected) in cases {
            assert_eq!(number(value), expected, "{value}");
        }
        assert_eq!(fixed(-0.001, 2), "0.00");
        assert_eq!([1.2, -10.0, 12.34, 100.4, 0.004].map(short), ["1.2", "−10", "12.3", "100", "0"]);
    }

    #[test]
    fn changes_carry_their_sign() {
        assert_eq!(percent_change(10.0, 11.8).as_deref(), Some("+18 %"));
        assert_eq!(percent_change(10.0, 9.13).as_deref(), Some("−8.7 %"));
        assert_eq!(percent_change(-2.0, -1.0).as_deref(), Some("+50 %"));
        assert_eq!(percent_change(10.0, 10.0).as_deref(), Some("±0 %"));
        assert_eq!(percent_change(0.0, 1.0), None);
    }

    #[test]
    fn ticks_are_round_and_inside() {
        assert_eq!(ticks(0.0, 10.0, 5), [0.0, 2.0, 4.0, 6.0, 8.0, 10.0]);
        assert_eq!(tick_labels(&ticks(0.1, 0.32, 5)), ["0.10", "0.15", "0.20", "0.25", "0.30"]);
        assert_eq!(ticks(3.0, 3.0, 5), [3.0]);
        assert_eq!((nice_at_most(37.0), nice_at_least(37.0)), (20.0, 50.0));
        assert_eq!((nice_at_most(0.5), nice_at_least(0.5)), (0.5, 0.5));
    }

    #[test]
    fn everything_is_explained_once() {
        let keys: Vec<&str> = wordings().map(|w| w.key).collect();
        assert_eq!((&keys[..FIRST.len()], &keys[keys.len() - LAST.len()..]), (&FIRST[..], &LAST[..]));
        assert_eq!(keys.len(), measures().count() + OWN.len());
        assert_eq!(keys.iter().collect::<std::collections::BTreeSet<_>>().len(), keys.len());
    }

    #[test]
    fn names_become_readable() {
        assert_eq!(sentence_case("door-3"), "Door 3");
        assert_eq!(sentence_case("wall-3-4"), "Wall 3-4");
        assert_eq!(plain_name("depth"), "Most steps");
        assert_eq!(plain_name("max_radial"), "Max radial");
        assert_eq!(plain_name("degree-p10@main-hall"), "Visibility, lowest 10 % (main hall)");
        assert_eq!(plain_name("degree-p90"), "Visibility, highest 10 %");
        assert_eq!(plain_name("degree-p50"), "Visibility, median");
        assert_eq!(plain_name("isovist-max-radial"), "Longest view");
    }
}

//! What moved and what it gains, in plain words: EF-NOTE, the report and `words` in result.json.

use std::borrow::Cow;

use super::measure::{
    fixed, is_told, number, parts as base, percent_change, plain_name, sentence_case, short, trimmed, wording,
};
use super::result::{Explanation, Gain, Gains, MoveEntry, MoveKind, Numbers, Part, Sense};

/// Moves told one by one; the rest is counted.
const MOVES_TOLD: usize = 4;
/// A move smaller than this share of its range is not worth a word.
pub const SMALLEST_SHARE: f64 = 0.005;
const EIGHTHS: [&str; 8] =
    ["east", "north-east", "north", "north-west", "west", "south-west", "south", "south-east"];

/// The largest moves and what the measures gain in one sentence; then which moves bring it, what was given up
/// for it, and how unlike the other layouts it is, a sentence each.
///
/// `Door 3 slides 1.2 m east, Kiosk turns 12° anticlockwise; visibility +18 %, accessibility: depth
/// −9 % (fewer turns), evenness +2 %. Putting Door 3 back costs 54 % of its gain over the present layout. …`
pub fn words(moves: &[MoveEntry], parameters: &[f64], gains: &str, explanation: &Explanation) -> String {
    let first = note_lines(moves, parameters, gains, &explanation.parts).join("; ");
    let sentences = std::iter::once(first).chain(explained(explanation));
    sentences.filter(|s| !s.is_empty()).map(|s| s + ".").collect::<Vec<_>>().join(" ")
}

/// The same moves with directions by where north is, `north_deg` anticlockwise from the plan's up, as words tell them.
pub fn by_north(moves: &[MoveEntry], north_deg: f64) -> Cow<'_, [MoveEntry]> {
    if north_deg == 0.0 {
        return Cow::Borrowed(moves);
    }
    let turned = |m: &MoveEntry| {
        let deg = match m.kind {
            MoveKind::X => Some(0.0),
            MoveKind::Y => Some(90.0),
            MoveKind::Along => m.direction_deg,
            MoveKind::Rotate | MoveKind::Scale => return m.clone(),
        };
        MoveEntry { kind: MoveKind::Along, direction_deg: deg.map(|d| d - north_deg), ..m.clone() }
    };
    Cow::Owned(moves.iter().map(turned).collect())
}

/// Which way a positive value of a shift goes, and which way a negative one.
pub fn directions(deg: f64) -> [&'static str; 2] {
    [compass(deg), compass(deg + 180.0)]
}

/// What moved and what it gains: `words` without the sentences on why, for one line of a log or a message.
pub fn headline<'a>(words: &'a str, explanation: &Explanation) -> &'a str {
    let why = explained(explanation).into_iter().next();
    why.and_then(|why| words.split_once(&format!(". {why}"))).map_or(words, |(first, _)| first)
}

/// The same in lines: what moved, then what it gains.
pub fn note_lines(moves: &[MoveEntry], parameters: &[f64], gains: &str, bringing: &[Part]) -> Vec<String> {
    let lines = [moved(moves, parameters, bringing), gains.to_owned()];
    lines.into_iter().filter(|l| !l.is_empty()).collect()
}

/// Why the option is good, in lines: what it breaks though it was pinned, which moves bring the gain.
pub fn explained(explanation: &Explanation) -> Vec<String> {
    [breaks(explanation), parts(explanation)].into_iter().filter(|l| !l.is_empty()).collect()
}

/// What a pinned option is kept in spite of; empty where it keeps everything.
fn breaks(explanation: &Explanation) -> String {
    match explanation.breaks.as_slice() {
        [] => String::new(),
        broken => format!("Kept because it is pinned, though it breaks {}", listed(broken, "and")),
    }
}

/// `Putting Door 3 back costs 54 % of its gain over the present layout, putting Kiosk back 31 %`, and which moves it
/// cannot do without at all; empty where no move counts by itself.
pub fn parts(explanation: &Explanation) -> String {
    let name = |p: &super::result::Part| {
        let linked = if p.groups > 1 { " and what is linked with it" } else { "" };
        sentence_case(&p.name) + linked
    };
    let (vital, others): (Vec<_>, Vec<_>) = explanation.parts.iter().partition(|p| p.lost > 1.0);
    let vital = listed(&vital.into_iter().map(name).collect::<Vec<_>>(), "or");
    let costs = others.iter().enumerate().map(|(i, p)| {
        let (name, share) = (name(p), percent(p.lost));
        let of = if i == 0 { " of its gain over the present layout" } else { "" };
        let verb = if i == 0 { " costs" } else { "" };
        format!("putting {name} back{verb} {share}{of}")
    });
    let costs = costs.collect::<Vec<_>>().join(", ");
    let worse = if vital.is_empty() {
        String::new()
    } else {
        format!("putting {vital} back makes it worse than the present layout")
    };
    let all: Vec<String> = [worse, costs].into_iter().filter(|t| !t.is_empty()).collect();
    capitalised(&all.join("; "))
}

/// `a, b or c`.
pub fn listed(names: &[String], word: &str) -> String {
    match names {
        [before @ .., last] if !before.is_empty() => format!("{} {word} {last}", before.join(", ")),
        _ => names.concat(),
    }
}

fn capitalised(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// A measure in a sentence.
fn told_name(key: &str) -> String {
    plain_name(key).to_lowercase()
}

fn percent(share: f64) -> String {
    format!("{} %", fixed(share * 100.0, 0))
}

/// What moved, the largest moves (as a share of their range) first; those that bring the gain are told however small.
pub fn moved(moves: &[MoveEntry], parameters: &[f64], bringing: &[Part]) -> String {
    let names: Vec<String> = bringing.iter().map(|p| sentence_case(&p.name)).collect();
    let mut groups = grouped(moves, parameters, &names);
    groups.sort_by(|a, b| b.share.total_cmp(&a.share));
    let told = if groups.len() == MOVES_TOLD + 1 { MOVES_TOLD + 1 } else { MOVES_TOLD };
    let (shown, left): (Vec<_>, Vec<_>) =
        groups.iter().enumerate().partition(|(i, g)| *i < told || names.contains(&g.name));
    let mut parts: Vec<String> =
        shown.iter().map(|(_, g)| format!("{} {}", g.name, listed(&g.clauses, "and"))).collect();
    match left.len() {
        0 => {}
        1 => parts.push("and 1 smaller move".into()),
        more => parts.push(format!("and {more} smaller moves")),
    }
    if parts.is_empty() { "Nothing moves".to_owned() } else { parts.join(", ") }
}

/// Names of the groups that move, the largest moves (as a share of their range) first.
pub fn movers(moves: &[MoveEntry], parameters: &[f64]) -> Vec<String> {
    let mut groups = grouped(moves, parameters, &[]);
    groups.sort_by(|a, b| b.share.total_cmp(&a.share));
    groups.into_iter().map(|g| g.name).collect()
}

/// What is surely gained, in the order of `initial`: `visibility +9 % (7 to 11 %), steps −4 % (3 to 5 %), evenness unchanged (−1 to 2 %)`.
pub fn confirmed(initial: &Numbers, gains: &Gains) -> String {
    let listed = initial.0.iter().map(|(key, _)| key).filter(|key| gains.contains_key(*key));
    let others = gains.keys().filter(|key| initial.get(key).is_none());
    let one = |key: &String| format!("{} {}", told_name(key), gain_words(key, &gains[key]));
    listed.chain(others).map(one).collect::<Vec<_>>().join(", ")
}

/// `+9 % (7 to 11 %)`: the change as the measure shows it, and what it surely is; `unchanged (−1 to 2 %)` where nobody can
/// tell. A score's is a difference, without per cent. In tenths where the interval is narrow, or would seem to reach 0.
pub fn gain_words(key: &str, gain: &Gain) -> String {
    let is_unsure = gain.low <= 0.0 && gain.high >= 0.0;
    let is_near_none = !is_unsure && gain.low.abs().min(gain.high.abs()) < TENTHS_BELOW;
    let (times, digits, unit) = match key {
        "score" => (1.0, 2, ""),
        _ => (100.0, usize::from(gain.high - gain.low < TENTHS_BELOW || is_near_none), " %"),
    };
    let told = |share: f64| fixed(share * times, digits);
    let turned = if gain.sense == Sense::Max { 1.0 } else { -1.0 };
    let [low, high] = if turned > 0.0 { [gain.low, gain.high] } else { [-gain.high, -gain.low] };
    // Rounding makes the interval wider, never narrower.
    let step = 10_f64.powi(digits as i32) * times;
    let low = told(((low * step + NOISE).floor()) / step);
    let range = format!("({low} to {}{unit})", told((high * step - NOISE).ceil() / step));
    if is_unsure {
        return format!("unchanged {range}");
    }
    let sign = if turned * gain.share > 0.0 { "+" } else { "" };
    format!("{sign}{}{unit} {range}", told(turned * gain.share))
}

/// Steps of the last digit that differ by less are one: binary computing leaves as much.
const NOISE: f64 = 1e-6;

/// Per cents are told in tenths where the interval is narrower than this.
const TENTHS_BELOW: f64 = 0.01;

/// What the measures gain: `visibility +18 %, depth −9 % (fewer turns), …`.
pub fn gains(initial: &Numbers, now: &Numbers) -> String {
    let gain = |(key, from): &(String, f64)| {
        let to = now.get(key)?;
        let from_none = || (*from == 0.0 && to != 0.0).then(|| format!("from 0 to {}", number(to)));
        let change = percent_change(*from, to).or_else(from_none)?;
        let known = wording(base(key).0).filter(|w| is_told(w.key))?;
        let name = told_name(key);
        let why = if to > *from { known.more_less[0] } else { known.more_less[1] };
        let of_pair = key.split_once('@').map_or("degree".to_owned(), |(_, pair)| format!("degree@{pair}"));
        let why = if now.get(&of_pair) == Some(0.0) { "nothing is seen" } else { why };
        let why = if change.starts_with('±') || base(key).0 == "degree" { "" } else { why };
        let why = if why.is_empty() { String::new() } else { format!(" ({why})") };
        Some(format!("{name} {change}{why}"))
    };
    initial.0.iter().filter_map(gain).collect::<Vec<_>>().join(", ")
}

/// A group with what its clauses do.
struct Group {
    name: String,
    clauses: Vec<String>,
    share: f64,
}

/// Clauses that do something, joined by the names of their groups, in order of appearance.
fn grouped(moves: &[MoveEntry], parameters: &[f64], bringing: &[String]) -> Vec<Group> {
    let mut out: Vec<Group> = Vec::new();
    let system = System::of(moves);
    for (entry, &value) in moves.iter().zip(parameters) {
        let share = (value - entry.kind.identity()).abs() / (entry.upper - entry.lower).abs();
        let name = sentence_case(&entry.name);
        let least = if bringing.contains(&name) { ROUNDING_SHARE } else { SMALLEST_SHARE };
        if !share.is_finite() || share < least {
            continue;
        }
        let clause = clause(entry, value, system);
        match out.iter_mut().find(|g| g.name == name) {
            Some(group) => {
                group.share = group.share.max(share);
                let is_slide = |text: &String| text.starts_with(SLIDES);
                let again =
                    clause.strip_prefix(SLIDES).filter(|_| group.clauses.last().is_some_and(is_slide));
                group.clauses.push(again.map_or_else(|| clause.clone(), str::to_owned));
            }
            None => out.push(Group { name, clauses: vec![clause], share }),
        }
    }
    out
}

/// What is left of a range when a bound of an earlier round is read again.
const ROUNDING_SHARE: f64 = 1e-6;

const SLIDES: &str = "slides ";

/// What one clause does: `slides 1.2 m east`.
fn clause(entry: &MoveEntry, value: f64, system: System) -> String {
    let far = length(value.abs(), &entry.unit, system);
    match entry.kind {
        MoveKind::X => format!("{SLIDES}{far} {}", if value < 0.0 { "west" } else { "east" }),
        MoveKind::Y => format!("{SLIDES}{far} {}", if value < 0.0 { "south" } else { "north" }),
        MoveKind::Along => match entry.direction_deg {
            Some(deg) => format!("{SLIDES}{far} {}", compass(if value < 0.0 { deg + 180.0 } else { deg })),
            None => format!("{SLIDES}{far} {}", if value < 0.0 { "back" } else { "forth" }),
        },
        MoveKind::Rotate => {
            let deg = if entry.unit == "rad" { value.to_degrees() } else { value };
            let way = if deg < 0.0 { "clockwise" } else { "anticlockwise" };
            format!("turns {}° {way}", short((deg.abs() * 10.0).round() / 10.0))
        }
        MoveKind::Scale => {
            let percent = (value - 1.0) * 100.0;
            let what = if percent < 0.0 { "shrinks" } else { "grows" };
            format!("{what} by {} %", short((percent.abs() * 10.0).round() / 10.0))
        }
    }
}

/// The value of one parameter for a table: `+1.2 m`, `−12°`, `× 1.08`, `–` where nothing moves.
pub fn parameter(entry: &MoveEntry, value: f64) -> String {
    if value == entry.kind.identity() {
        return "–".to_owned();
    }
    let sign = if value < 0.0 { "−" } else { "+" };
    match entry.kind {
        MoveKind::X | MoveKind::Y | MoveKind::Along => {
            let system = System::of(std::slice::from_ref(entry));
            format!("{sign}{}", length(value.abs(), &entry.unit, system))
        }
        MoveKind::Rotate => {
            let deg = if entry.unit == "rad" { value.to_degrees() } else { value };
            format!("{sign}{}°", short((deg.abs() * 10.0).round() / 10.0))
        }
        MoveKind::Scale => format!("× {}", fixed(value, 2)),
    }
}

/// The bounds of a move: `−32 cm to +5.5 m`.
pub fn range(entry: &MoveEntry) -> String {
    let bound = |value: f64| match entry.kind {
        MoveKind::Scale => format!("× {}", fixed(value, 2)),
        _ if value == 0.0 => "0".to_owned(),
        _ => parameter(entry, value),
    };
    format!("{} to {}", bound(entry.lower), bound(entry.upper))
}

/// In which units lengths are told: one system a sentence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum System {
    Metric,
    Imperial,
    /// The entry's own unit, where it is no known one.
    Own,
}

impl System {
    /// That of the first move by a length.
    fn of(moves: &[MoveEntry]) -> Self {
        let system = |e: &MoveEntry| match metres(&e.unit) {
            Some(_) if matches!(e.unit.as_str(), "in" | "ft") => Some(Self::Imperial),
            Some(_) => Some(Self::Metric),
            None => None,
        };
        moves.iter().find_map(system).unwrap_or(Self::Own)
    }
}

/// Nearer than this to a whole number of millimetres, in millimetres, a length is one.
const WHOLE_MM: f64 = 1e-6;
const METRES_PER_INCH: f64 = 0.0254;
const INCHES_PER_FOOT: f64 = 12.0;
/// Lengths below are told in tenths of an inch, longer ones in whole inches.
const TENTHS_BELOW_INCHES: f64 = 3.0;

/// Metres in one of a unit of length; none where it is no known one.
fn metres(unit: &str) -> Option<f64> {
    match unit {
        "mm" => Some(0.001),
        "cm" => Some(0.01),
        "m" => Some(1.0),
        "in" => Some(METRES_PER_INCH),
        "ft" => Some(METRES_PER_INCH * INCHES_PER_FOOT),
        _ => None,
    }
}

/// A length for people: metres, centimetres or millimetres, feet and inches, or a unit that is not known.
fn length(size: f64, unit: &str, system: System) -> String {
    let Some(per_unit) = metres(unit).filter(|_| system != System::Own) else {
        return format!("{} {unit}", short(size)).trim_end().to_owned();
    };
    let metres = size * per_unit;
    if system == System::Imperial {
        return feet(metres / METRES_PER_INCH);
    }
    // A module's steps are told as they are, 12.5 cm.
    let millimetres = (metres * 1e3).round();
    let is_whole = (metres * 1e3 - millimetres).abs() < WHOLE_MM;
    match metres {
        _ if is_whole && millimetres >= 1e3 => format!("{} m", trimmed(millimetres / 1e3, 3)),
        _ if is_whole && millimetres >= 10.0 => format!("{} cm", trimmed(millimetres / 10.0, 1)),
        m if m >= 0.995 => format!("{} m", short(m)),
        m if m >= 0.0095 => format!("{} cm", fixed(m * 100.0, 0)),
        m => format!("{} mm", short((m * 1e4).round() / 10.0)),
    }
}

/// `16 ft 2 in`, `9 in`, `1.5 in`.
fn feet(inches: f64) -> String {
    if inches < 0.095 {
        return format!("{} in", short((inches * 1e3).round() / 1e3));
    }
    if inches < TENTHS_BELOW_INCHES {
        return format!("{} in", short((inches * 10.0).round() / 10.0));
    }
    let whole = inches.round();
    let (feet, rest) = ((whole / INCHES_PER_FOOT).floor(), whole % INCHES_PER_FOOT);
    match (feet, rest) {
        (0.0, _) => format!("{} in", fixed(rest, 0)),
        (_, 0.0) => format!("{} ft", fixed(feet, 0)),
        _ => format!("{} ft {} in", fixed(feet, 0), fixed(rest, 0)),
    }
}

/// The eighth of the compass of a direction, degrees anticlockwise from east.
pub fn compass(deg: f64) -> &'static str {
    EIGHTHS[((deg / 45.0).round() as i64).rem_euclid(8) as usize]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn entry(name: &str, kind: MoveKind, bounds: [f64; 2], unit: &str) -> MoveEntry {
        MoveEntry {
            name: name.to_owned(),
            kind,
            lower: bounds[0],
            upper: bounds[1],
            unit: unit.to_owned(),
            direction_deg: None,
            elements: Vec::new(),
            geometry: String::new(),
        }
    }

    #[test]
    fn what_begins_at_nothing_is_told_as_it_is() {
        let of = |v: f64| Numbers::of([("degree-p10@exit", v), ("depth", 8.0)]);
        assert_eq!(
            gains(&of(0.0), &of(2.0)),
            "visibility, lowest 10 % (exit) from 0 to 2.00, most steps ±0 %"
        );
        assert_eq!(gains(&of(0.0), &of(0.0)), "most steps ±0 %");
    }

    #[test]
    fn no_length_is_told_as_nothing() {
        let metric = |m: f64| length(m, "m", System::Metric);
        let told = [0.0005, 0.004, 0.0096, 0.014, 0.99, 1.0].map(metric);
        assert_eq!(told, ["0.5 mm", "4 mm", "1 cm", "1.4 cm", "99 cm", "1 m"]);
        // Steps of a module, also where they come of a sum.
        let steps = [0.125, 0.1 + 0.2, 1.125, 0.1251, 1.1251].map(metric);
        assert_eq!(steps, ["12.5 cm", "30 cm", "1.125 m", "13 cm", "1.13 m"]);
        assert_eq!(length(0.0005 / 0.3048, "ft", System::Imperial), "0.02 in");
    }

    #[test]
    fn gains_are_told_with_what_is_known_of_them() {
        let gain = |share, low, high, sense| Gain { share, low, high, sense };
        let cases = [
            (gain(0.09, 0.07, 0.11, Sense::Max), "+9 % (7 to 11 %)"),
            (gain(0.04, 0.032, 0.041, Sense::Min), "−4.0 % (−4.1 to −3.2 %)"),
            (gain(0.004, -0.012, 0.02, Sense::Max), "unchanged (−2 to 2 %)"),
            (gain(0.0139, 0.0056, 0.0221, Sense::Max), "+1.4 % (0.5 to 2.3 %)"),
            (gain(-0.05, -0.08, -0.02, Sense::Max), "−5 % (−8 to −2 %)"),
            (gain(-0.05, -0.08, -0.02, Sense::Min), "+5 % (2 to 8 %)"),
        ];
        for (gain, words) in cases {
            assert_eq!(gain_words("degree", &gain), words);
        }
        assert_eq!(gain_words("score", &cases[0].0), "+0.09 (0.07 to 0.11)");
        let gains = Gains::from([("mean-depth".into(), cases[1].0), ("degree".into(), cases[0].0)]);
        let initial = Numbers::of([("degree", 10.0), ("depth", 3.0), ("mean-depth", 2.0)]);
        assert_eq!(confirmed(&initial, &gains), "visibility +9 % (7 to 11 %), steps −4.0 % (−4.1 to −3.2 %)");
    }

    #[test]
    fn a_door_and_a_kiosk() {
        let moves = [
            entry("door-3", MoveKind::X, [-2.0, 2.0], "m"),
            entry("kiosk", MoveKind::Rotate, [-15.0, 15.0], "deg"),
            entry("kiosk", MoveKind::Y, [-1000.0, 1000.0], "mm"),
        ];
        let initial = Numbers::of([("degree", 100.0), ("depth", 8.0), ("entropy", 2.5)]);
        let now = Numbers::of([("degree", 118.0), ("depth", 7.25), ("entropy", 2.5)]);
        assert_eq!(
            words(&moves, &[1.2, -12.0, 350.0], &gains(&initial, &now), &Explanation::default()),
            "Kiosk turns 12° clockwise and slides 35 cm north, Door 3 slides 1.2 m east; \
             visibility +18 %, most steps −9.4 % (fewer turns), evenness ±0 %."
        );
    }

    #[test]
    fn many_moves_are_counted_and_tiny_ones_left_out() {
        let moves: Vec<MoveEntry> =
            (1..=9).map(|i| entry(&format!("wall {i}"), MoveKind::X, [-1.0, 1.0], "m")).collect();
        let values = [0.1, 0.9, 0.0, 0.2, 0.3, 1e-4, 0.4, 0.5, 0.6];
        assert_eq!(
            moved(&moves, &values, &[]),
            "Wall 2 slides 90 cm east, Wall 9 slides 60 cm east, Wall 8 slides 50 cm east, \
             Wall 7 slides 40 cm east, and 3 smaller moves"
        );
        assert_eq!(moved(&moves, &[0.0; 9], &[]), "Nothing moves");
        // What brings the gain is told, however little it moves.
        let bring = |name: &str| Part { name: name.into(), groups: 1, lost: 0.5 };
        let bringing = [bring("wall 6"), bring("wall 1")];
        let mut values = values;
        values[5] = 0.004;
        assert_eq!(
            moved(&moves, &values, &bringing),
            "Wall 2 slides 90 cm east, Wall 9 slides 60 cm east, Wall 8 slides 50 cm east, \
             Wall 7 slides 40 cm east, Wall 1 slides 10 cm east, Wall 6 slides 4 mm east, and 2 smaller moves"
        );
    }

    #[test]
    fn an_explanation_says_what_is_lost() {
        let part =
            |name: &str, groups, lost| super::super::result::Part { name: name.to_owned(), groups, lost };
        let mut e = Explanation {
            breaks: vec![],
            parts: vec![part("door-3", 1, 0.54), part("kiosk", 2, 0.314)],
            from_present: 1.0,
            nearest: Some(2),
            from_nearest: Some(0.756),
            kept: Numbers::default(),
        };
        assert_eq!(
            explained(&e),
            ["Putting Door 3 back costs 54 % of its gain over the present layout, \
              putting Kiosk and what is linked with it back 31 %"]
        );
        assert!(words(&[], &[], "", &e).contains("Putting Door 3 back"));
        // What rounding left of a bound over rounds is no move.
        let turned =
            [entry("a", MoveKind::X, [-2.0, 2.0], "m"), entry("a", MoveKind::Rotate, [-15.0, 15.0], "deg")];
        let bring = [part("a", 1, 0.5)];
        assert_eq!(moved(&turned, &[1.2, 3.55e-15], &bring), "A slides 1.2 m east");
        // A name may hold what looks like the end of a sentence.
        let moves = [entry("St. Luke", MoveKind::X, [-2.0, 2.0], "m")];
        assert_eq!(
            headline(&words(&moves, &[1.2], "", &e), &e),
            note_lines(&moves, &[1.2], "", &[]).join("; ")
        );
        e.parts = vec![part("wall-2", 1, 1.7), part("door-4", 1, 1.2), part("door-1", 1, 0.08)];
        assert_eq!(
            explained(&e),
            ["Putting Wall 2 or Door 4 back makes it worse than the present layout; \
              putting Door 1 back costs 8 % of its gain over the present layout"]
        );
    }

    #[test]
    fn lengths_in_one_sentence_are_of_one_system() {
        let moves = [
            entry("wall-3-4", MoveKind::X, [-20.0, 20.0], "ft"),
            entry("wall-3-4", MoveKind::Y, [-20.0, 20.0], "in"),
            entry("wall-3-4", MoveKind::Rotate, [-15.0, 15.0], "deg"),
            entry("door-1", MoveKind::X, [-5.0, 5.0], "m"),
        ];
        assert_eq!(
            moved(&moves, &[16.17, 1.54, 10.0, -0.45], &[]),
            "Wall 3-4 slides 16 ft 2 in east, 1.5 in north and turns 10° anticlockwise, Door 1 slides 1 ft 6 in west"
        );
        let metric: Vec<MoveEntry> = moves.into_iter().rev().collect();
        assert_eq!(
            moved(&metric, &[-0.45, 0.0, 10.0, 2.0], &[]),
            "Wall 3-4 slides 25.4 cm north and 61 cm east, Door 1 slides 45 cm west"
        );
    }

    #[test]
    fn directions_follow_the_north_of_the_plan() {
        let mut along = entry("c", MoveKind::Along, [-1.0, 1.0], "m");
        along.direction_deg = Some(45.0);
        let moves =
            [entry("a", MoveKind::X, [-1.0, 1.0], "m"), entry("b", MoveKind::Y, [-1.0, 1.0], "m"), along];
        let told = |north_deg: f64| moved(&by_north(&moves, north_deg), &[0.5, -0.5, 0.5], &[]);
        assert_eq!(told(0.0), "A slides 50 cm east, B slides 50 cm south, C slides 50 cm north-east");
        assert_eq!(told(-17.2), told(0.0), "nearest of eight");
        // North is to the left: what goes to the right goes south.
        assert_eq!(told(90.0), "A slides 50 cm south, B slides 50 cm west, C slides 50 cm south-east");
        assert_eq!(told(-50.0), "A slides 50 cm north-east, B slides 50 cm south-east, C slides 50 cm north");
        assert_eq!(directions(90.0 - 180.0), ["south", "north"]);
    }

    #[test]
    fn clauses_name_direction_and_unit() {
        let mut along = entry("a", MoveKind::Along, [-1.0, 1.0], "ft");
        let clause = |entry: &MoveEntry, value| clause(entry, value, System::of(std::slice::from_ref(entry)));
        assert_eq!(clause(&along, -0.5), "slides 6 in back");
        along.direction_deg = Some(30.0);
        assert_eq!(clause(&along, -0.5), "slides 6 in south-west");
        assert_eq!(clause(&entry("a", MoveKind::Scale, [0.8, 1.2], ""), 0.92), "shrinks by 8 %");
        assert_eq!(
            clause(&entry("a", MoveKind::Rotate, [-1.0, 1.0], "rad"), 0.1),
            "turns 5.7° anticlockwise"
        );
        assert_eq!(clause(&entry("a", MoveKind::X, [-1.0, 1.0], "ells"), 2.0), "slides 2 ells east");
        assert_eq!(parameter(&entry("a", MoveKind::Scale, [0.8, 1.2], ""), 1.0), "–");
        assert_eq!(parameter(&entry("a", MoveKind::Y, [-1.0, 1.0], "m"), -0.25), "−25 cm");
        assert_eq!(range(&entry("a", MoveKind::Y, [0.0, 1500.0], "mm")), "0 to +1.5 m");
        assert_eq!(range(&entry("a", MoveKind::Scale, [0.8, 1.0], "")), "× 0.80 to × 1.00");
    }
}

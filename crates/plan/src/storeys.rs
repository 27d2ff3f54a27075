//! Storeys drawn over one another, each on a layer of its own: they are read as one plan, and the user is told.

use std::collections::BTreeMap;

use glam::DVec2;

use super::parallels::pieces;
use enfilade_cad::drawing::{Drawing, Entity};
use enfilade_cad::names::base_name;
use enfilade_cad::plane::{box_of, shared_of_boxes};
use enfilade_report::{Place, Report};

/// Words that name a storey, lower case.
const STOREYS: &[&str] = &[
    "erdgeschoss",
    "erdgeschoß",
    "obergeschoss",
    "obergeschoß",
    "dachgeschoss",
    "dachgeschoß",
    "kellergeschoss",
    "untergeschoss",
    "ground",
    "first",
    "second",
    "third",
    "1st",
    "2nd",
    "3rd",
    "basement",
    "rdc",
];

/// What names a storey behind its number: `1OG`, `2F`, `2階`.
const NUMBERED: &[&str] = &["eg", "og", "ug", "kg", "dg", "f", "fl", "階"];

/// What names one without a number too.
const UNNUMBERED: &[&str] = &["eg", "og", "ug", "kg", "dg"];

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
    "piano",
    "planta",
    "nivel",
    "andar",
    "verdieping",
];

/// Fewest straight pieces that are a storey's walls.
const PIECES_MIN: usize = 8;

/// Storeys lie over one another where their boxes share this much of the smaller one.
const SHARED_MIN: f64 = 0.5;

/// Says which layers of walls draw storeys over one another, and how to read one alone. `walls`: those that were taken.
pub(super) fn warn(drawing: &Drawing, walls: &[&Entity], report: &mut Report) {
    let mut by_layer: BTreeMap<&str, Vec<&Entity>> = BTreeMap::new();
    walls.iter().for_each(|w| by_layer.entry(&w.layer).or_default().push(w));
    let mut storeys: BTreeMap<String, Vec<(&str, [DVec2; 2])>> = BTreeMap::new();
    for (layer, walls) in by_layer {
        let Some(rest) = without_storey(layer) else { continue };
        let pieces = pieces(walls.into_iter());
        let extent = box_of(pieces.iter().flat_map(|p| [p.a, p.b])).filter(|_| pieces.len() >= PIECES_MIN);
        storeys.entry(rest).or_default().extend(extent.map(|e| (layer, e)));
    }
    for same in storeys.values() {
        let pairs = same.iter().enumerate().flat_map(|(i, a)| same[i + 1..].iter().map(move |b| (a, b)));
        let Some((a, b)) = pairs.into_iter().find(|(a, b)| shared_of_boxes(a.1, b.1) >= SHARED_MIN) else {
            continue;
        };
        let text = format!(
            "layers {:?} and {:?} draw two storeys over one another, read as one plan; --wall-layer {:?} reads one alone",
            a.0, b.0, a.0
        );
        report.warn("storeys-overlaid", Place::file(&drawing.file), text);
    }
}

/// A layer's name without the word for the storey, if it has one.
fn without_storey(layer: &str) -> Option<String> {
    let lower = base_name(layer).to_lowercase();
    let words: Vec<&str> = lower.split(|c: char| !c.is_alphanumeric()).filter(|w| !w.is_empty()).collect();
    let is_number = |w: &str| !w.is_empty() && w.chars().all(|c| c.is_ascii_digit());
    for (i, word) in words.iter().enumerate() {
        let digits = word.trim_start_matches(|c: char| c.is_ascii_digit());
        let has_digits = digits.len() < word.len();
        let is_one = STOREYS.contains(word)
            || has_digits && NUMBERED.contains(&digits)
            || UNNUMBERED.contains(word)
            || LEVELS.iter().any(|l| word.strip_prefix(l).is_some_and(is_number));
        let is_level = LEVELS.contains(word) && words.get(i + 1).is_some_and(|w| is_number(w));
        if is_one || is_level {
            let taken = i..=i + usize::from(is_level);
            let rest = words.iter().enumerate().filter(|(k, _)| !taken.contains(k));
            return Some(rest.map(|w| *w.1).collect::<Vec<_>>().join(" "));
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use enfilade_cad::drawing::{Editable, Shape, SourceRef};

    #[test]
    fn storeys_are_read_from_layers() {
        for (layer, expected) in [
            ("WALL-EG", Some("wall")),
            ("Wände 1OG", Some("wände")),
            ("x$0$A-WALL-2F", Some("a wall")),
            ("A_WALL_LEVEL_02", Some("a wall")),
            ("level1-walls", Some("walls")),
            ("A-WALL-First", Some("a wall")),
            ("A-WALL-2", None),
            ("WALL-P1", None),
            ("wall high", None),
            ("Piano", None),
        ] {
            assert_eq!(without_storey(layer).as_deref(), expected, "{layer}");
        }
    }

    /// Warnings for storeys of `pieces` lines each, the second `beside` to the right of the first, both 8 wide.
    fn warnings(layers: [&str; 2], pieces: usize, beside: f64) -> usize {
        let line = |layer: &str, x: f64, i: usize| {
            let y = i as f64;
            let [a, b] = [DVec2::new(x, y), DVec2::new(x + 8.0, y)];
            Entity {
                source: SourceRef {
                    record: 0,
                    handle: None,
                    line: 0,
                    kind: "LINE".into(),
                    layer: layer.into(),
                },
                layer: layer.into(),
                shape: Shape::Line { a, b },
                editable: Editable::Free,
                blocks: Vec::new(),
                origin: Default::default(),
            }
        };
        let x = [0.0, beside];
        let all = (0..2).flat_map(|k| (0..pieces).map(move |i| line(layers[k], x[k], i)));
        let drawing = Drawing::of(all.collect());
        let mut report = Report::default();
        warn(&drawing, &drawing.entities.iter().collect::<Vec<_>>(), &mut report);
        report.problems.len()
    }

    #[test]
    fn storeys_over_one_another_are_named() {
        assert_eq!(warnings(["WALL-EG", "WALL-OG"], PIECES_MIN, 0.0), 1);
        assert_eq!(warnings(["WALL-EG", "WALL-OG"], PIECES_MIN - 1, 0.0), 0);
        assert_eq!(warnings(["WALL-EG", "WALL-OG"], 20, 8.0 * (1.0 - SHARED_MIN) - 0.1), 1);
        assert_eq!(warnings(["WALL-EG", "WALL-OG"], 20, 8.0 * (1.0 - SHARED_MIN) + 0.1), 0, "side by side");
        assert_eq!(warnings(["WALL-EG", "COLS-OG"], 20, 0.0), 0);
        assert_eq!(warnings(["WALL-1", "WALL-2"], 20, 0.0), 0, "no storeys");
    }
}

//! What rooms are called: the texts that stand in them.

use std::collections::{BTreeMap, BTreeSet};

use super::Area;
use crate::frame::Frame;
use crate::kinds::kind_of_name;
use enfilade_cad::drawing::Text;
use enfilade_cad::ifc::{SPACE_LAYER, ZONE_LAYER};
use enfilade_cad::own_layers;
use enfilade_engine::geometry::{PointUm, Side, side_of_ring};

/// Fewest letters of a room's name: marks of doors and windows have fewer.
const LETTERS_MIN: usize = 3;

/// A layer with more texts in a room than one loses so much of its claim to name rooms, for each.
const SURPLUS: f64 = 0.5;

/// What the texts of one layer call the rooms, by room: names with their distances from its middle.
type Named = BTreeMap<usize, Vec<(f64, String)>>;

/// For every room the text in it that names it, of the layer that names most rooms and little else. Where that layer names
/// another room, two letters that stand alone in one name it too: `HW`.
pub fn name_of_rooms(rooms: &[Area], texts: &[Text], frame: &Frame) -> Vec<Option<String>> {
    let mut layers: BTreeMap<&str, Named> = BTreeMap::new();
    let mut abbreviated: BTreeMap<(&str, usize), Vec<(f64, String)>> = BTreeMap::new();
    for text in of_rooms(texts) {
        let short = || short_name_in(&text.text).filter(|_| text.layer == SPACE_LAYER);
        let at = frame.um_from_file(text.at);
        let Some(room) = rooms.iter().position(|r| r.holds(at)) else { continue };
        let far =
            middle(&rooms[room]).map_or(f64::MAX, |m| ((m[0] - at[0]) as f64).hypot((m[1] - at[1]) as f64));
        if let Some(name) = name_in(&text.text).or_else(short) {
            layers.entry(&text.layer).or_default().entry(room).or_default().push((far, name));
        } else if let Some(name) = abbreviation_in(&text.text) {
            abbreviated.entry((&text.layer, room)).or_default().push((far, name));
        }
    }
    let claim = |named: &Named| {
        let surplus: usize = named.values().map(|texts| texts.len() - 1).sum();
        named.len() as f64 - SURPLUS * surplus as f64
    };
    let mut layers: Vec<(&str, Named)> = layers.into_iter().collect();
    layers.sort_by(|a, b| claim(&b.1).total_cmp(&claim(&a.1)));
    if let Some((layer, named)) = layers.first_mut() {
        let of_layer = abbreviated.into_iter().filter(|((of, _), names)| of == layer && names.len() == 1);
        for ((_, room), names) in of_layer {
            named.entry(room).or_insert(names);
        }
    }
    let nearest =
        |texts: &Vec<(f64, String)>| texts.iter().min_by(|a, b| a.0.total_cmp(&b.0)).map(|t| t.1.clone());
    (0..rooms.len()).map(|room| layers.iter().find_map(|(_, named)| nearest(named.get(&room)?))).collect()
}

/// Everything that is written in each room, marks of ours left out.
pub fn texts_in_rooms(rooms: &[Area], texts: &[Text], frame: &Frame) -> Vec<Vec<String>> {
    let mut out = vec![Vec::new(); rooms.len()];
    for text in of_rooms(texts) {
        let at = frame.um_from_file(text.at);
        if let Some(room) = rooms.iter().position(|r| r.holds(at)) {
            out[room].extend(text.text.lines().map(|l| l.trim().to_owned()));
        }
    }
    out
}

/// The texts that may name rooms: none of ours, and of a zone only where its space has no name of its own.
fn of_rooms(texts: &[Text]) -> impl Iterator<Item = &Text> {
    let has_letter = |t: &&Text| t.text.chars().any(char::is_alphabetic);
    let spaces = texts.iter().filter(|t| t.layer == SPACE_LAYER).filter(has_letter);
    let named: BTreeSet<usize> = spaces.map(|t| t.source.record).collect();
    let is_above = move |t: &&Text| t.layer == ZONE_LAYER && named.contains(&t.source.record);
    texts.iter().filter(|t| !own_layers::is_own(&t.layer)).filter(move |t| !is_above(t))
}

/// The last line with a letter: of a space, whose name is one however short it is, behind its number.
fn short_name_in(text: &str) -> Option<String> {
    let mut lines = text.lines().map(str::trim).filter(|line| line.chars().any(char::is_alphabetic));
    lines.next_back().map(str::to_owned)
}

/// What is written on stairs, at levels and at axes, in two letters.
const MARKS: [&str; 6] = ["UP", "DN", "FL", "EL", "CL", "TY"];

/// A text that is two letters and no more.
fn abbreviation_in(text: &str) -> Option<String> {
    let text = text.trim();
    let is_short = text.chars().count() == 2 && text.chars().all(char::is_alphabetic);
    (is_short && !MARKS.contains(&text.to_uppercase().as_str())).then(|| text.to_owned())
}

/// Longest line that is looked up among the words for rooms, letters.
const LOOKED_UP_MAX: usize = 40;

/// The name in a text: its first line that is no number, area or mark. A short one has to be a word for a room: `WC`.
pub fn name_in(text: &str) -> Option<String> {
    let is_name = |line: &&str| {
        let letters = line.chars().filter(|c| c.is_alphabetic()).count();
        let digits = line.chars().filter(char::is_ascii_digit).count();
        let is_written_out = letters >= LETTERS_MIN && letters > digits;
        let is_known = || letters > 1 && line.len() <= LOOKED_UP_MAX && kind_of_name(line).is_some();
        let is_joined = || line.chars().any(|c| c.is_alphabetic() && !c.is_ascii() && u32::from(c) > 0x2e80);
        is_written_out || is_joined() || is_known()
    };
    text.lines().map(str::trim).find(is_name).map(|line| without_area(line).to_owned())
}

/// Units of areas as they stand behind a room's name, lower case.
const AREAS: [&str; 9] = ["m2", "m²", "m^2", "㎡", "qm", "mq", "sqm", "sqft", "sf"];

/// A line without the area at its end: `WC 3.0 m²`.
fn without_area(line: &str) -> &str {
    let lower = line.to_lowercase();
    let Some(unit) = AREAS.iter().find(|u| lower.ends_with(**u)).filter(|_| lower.len() == line.len()) else {
        return line;
    };
    let number = line[..line.len() - unit.len()].trim_end();
    let head = number.trim_end_matches(|c: char| c.is_ascii_digit() || matches!(c, '.' | ','));
    let name = head.trim_end_matches(|c: char| c.is_whitespace() || "=:(,;-–/".contains(c));
    if head.len() < number.len() && name.chars().any(char::is_alphabetic) { name } else { line }
}

impl Area {
    /// Whether a point lies in it.
    pub fn holds(&self, at: PointUm) -> bool {
        self.outline.len() > 2
            && side_of_ring(&self.outline, at) == Side::Inside
            && self.holes.iter().all(|h| side_of_ring(h, at) == Side::Outside)
    }
}

fn middle(room: &Area) -> Option<PointUm> {
    let bound = |k: usize| {
        let all = || room.outline.iter().map(|p| p[k]);
        Some(i64::midpoint(all().min()?, all().max()?))
    };
    Some([bound(0)?, bound(1)?])
}

#[cfg(test)]
mod tests {
    use enfilade_cad::drawing::{SourceRef, Text};
    use enfilade_cad::ifc::{SPACE_LAYER, ZONE_LAYER};
    use glam::DVec2;

    use super::{name_in, of_rooms, short_name_in};

    /// A space has its own name before that of its zone, however short; where it has a number alone, its zone's.
    #[test]
    fn a_zone_names_no_space_that_has_a_name() {
        let text = |record: usize, layer: &str, text: &str| Text {
            source: SourceRef { record, handle: None, line: 0, kind: "IfcSpace".into(), layer: layer.into() },
            layer: layer.into(),
            at: DVec2::ZERO,
            text: text.into(),
        };
        let texts = [
            text(1, SPACE_LAYER, "661\nGT"),
            text(1, ZONE_LAYER, "Common Area"),
            text(2, SPACE_LAYER, "662"),
            text(2, ZONE_LAYER, "Office 01"),
        ];
        let left: Vec<&str> = of_rooms(&texts).map(|t| t.text.as_str()).collect();
        assert_eq!(left, ["661\nGT", "662", "Office 01"]);
        assert_eq!(name_in(left[0]).or_else(|| short_name_in(left[0])).as_deref(), Some("GT"));
        assert_eq!(short_name_in(left[1]), None);
    }

    #[test]
    fn numbers_areas_and_marks_name_no_room() {
        for (text, name) in [
            ("Bedroom", Some("Bedroom")),
            ("Room 12\n12.5 m²", Some("Room 12")),
            ("12.5 m²\nKitchen", Some("Kitchen")),
            ("会议室", Some("会议室")),
            ("D1", None),
            ("W-02", None),
            ("14,20 mq", None),
            ("2.45", None),
            ("WC", Some("WC")),
            ("WC 3.0 m2", Some("WC")),
            ("WC\n3.0 m²", Some("WC")),
            ("Bad: 12,50 m²", Some("Bad")),
            ("Kü", Some("Kü")),
            ("BR 2", Some("BR 2")),
            ("T3", None),
            ("A2", None),
            ("EI 30", None),
        ] {
            assert_eq!(name_in(text).as_deref(), name, "{text}");
        }
    }
}

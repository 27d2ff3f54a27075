//! What rooms are called: the texts that stand in them.

use std::collections::BTreeMap;

use super::Area;
use crate::frame::Frame;
use enfilade_cad::drawing::Text;
use enfilade_cad::own_layers;
use enfilade_engine::geometry::{PointUm, Side, side_of_ring};

/// Fewest letters of a room's name: marks of doors and windows have fewer.
const LETTERS_MIN: usize = 3;

/// A layer with more texts in a room than one loses so much of its claim to name rooms, for each.
const SURPLUS: f64 = 0.5;

/// What the texts of one layer call the rooms, by room: names with their distances from its middle.
type Named = BTreeMap<usize, Vec<(f64, String)>>;

/// For every room the text in it that names it, of the layer that names most rooms and little else.
pub fn name_of_rooms(rooms: &[Area], texts: &[Text], frame: &Frame) -> Vec<Option<String>> {
    let mut layers: BTreeMap<&str, Named> = BTreeMap::new();
    for text in texts.iter().filter(|t| !own_layers::is_own(&t.layer)) {
        let Some(name) = name_in(&text.text) else { continue };
        let at = frame.um_from_file(text.at);
        if let Some(room) = rooms.iter().position(|r| is_in(r, at)) {
            let far = middle(&rooms[room])
                .map_or(f64::MAX, |m| ((m[0] - at[0]) as f64).hypot((m[1] - at[1]) as f64));
            layers.entry(&text.layer).or_default().entry(room).or_default().push((far, name));
        }
    }
    let claim = |named: &Named| {
        let surplus: usize = named.values().map(|texts| texts.len() - 1).sum();
        named.len() as f64 - SURPLUS * surplus as f64
    };
    let mut layers: Vec<_> = layers.into_values().collect();
    layers.sort_by(|a, b| claim(b).total_cmp(&claim(a)));
    let nearest =
        |texts: &Vec<(f64, String)>| texts.iter().min_by(|a, b| a.0.total_cmp(&b.0)).map(|t| t.1.clone());
    (0..rooms.len()).map(|room| layers.iter().find_map(|named| nearest(named.get(&room)?))).collect()
}

/// The name in a text: its first line that is no number, area or mark.
fn name_in(text: &str) -> Option<String> {
    let is_name = |line: &&str| {
        let letters = line.chars().filter(|c| c.is_alphabetic()).count();
        let digits = line.chars().filter(char::is_ascii_digit).count();
        let is_written_out = letters >= LETTERS_MIN && letters > digits;
        is_written_out || line.chars().any(|c| c.is_alphabetic() && !c.is_ascii() && u32::from(c) > 0x2e80)
    };
    text.lines().map(str::trim).find(is_name).map(str::to_owned)
}

fn is_in(room: &Area, at: PointUm) -> bool {
    room.outline.len() > 2
        && side_of_ring(&room.outline, at) == Side::Inside
        && room.holes.iter().all(|h| side_of_ring(h, at) == Side::Outside)
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
    use super::name_in;

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
        ] {
            assert_eq!(name_in(text).as_deref(), name, "{text}");
        }
    }
}

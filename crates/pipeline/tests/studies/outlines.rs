//! A house of closed outlines, its doors drawn over them; what texts call its rooms, and what is missing of it.

use enfilade_config::{Partial, Settings};
use enfilade_fixtures::corridor::{Rect, corners, drawing, line, polyline};
use enfilade_overlay::reading::Reading;
use enfilade_pipeline::Input;
use enfilade_report::Report;

/// Inner outlines of three rooms, metres, and names in them.
const ROOMS: [(Rect, &str); 3] = [
    ([0.25, 0.25, 5.85, 6.75], "LIVING"),
    ([5.97, 3.56, 9.75, 6.75], "KITCHEN"),
    ([5.97, 0.25, 9.75, 3.44], "BEDROOM"),
];

fn text(layer: &str, [x0, y0, x1, y1]: Rect, words: &str) -> String {
    let at = [f64::midpoint(x0, x1), f64::midpoint(y0, y1)];
    format!("0|TEXT|8|{layer}|10|{}|20|{}|40|0.2|1|{words}|", at[0], at[1])
}

/// The house with these names of rooms, and doors from the living room into the others.
fn house(names: [&str; 3]) -> String {
    let rings = ROOMS.iter().map(|(ring, _)| polyline("WALLS", &corners(*ring), true));
    let outer = polyline("WALLS", &corners([0.0, 0.0, 10.0, 7.0]), true);
    let door = |y: f64| {
        let leaf = line("DOORS", [5.97, y, 6.87, y]);
        leaf + &format!("0|ARC|8|DOORS|10|5.97|20|{y}|40|0.9|50|270|51|360|")
    };
    let texts = ROOMS.iter().zip(names).map(|((ring, _), name)| text("NAMES", *ring, name));
    rings.chain([outer, door(5.4), door(2.4)]).chain(texts).collect()
}

fn read(entities: &str) -> (Reading, Report) {
    let text = drawing(entities);
    let outcome = enfilade_pipeline::check(
        &Input::new("plan.dxf", text.as_bytes(), 1),
        &Settings::new(Partial::default()).unwrap(),
    )
    .unwrap();
    (outcome.result.reading.unwrap(), outcome.report)
}

fn names(reading: &Reading) -> Vec<&str> {
    let mut names: Vec<&str> = reading.rooms.iter().map(|r| r.name.as_str()).collect();
    names.sort_unstable();
    names
}

#[test]
fn doors_drawn_over_closed_outlines_open_them() {
    let (reading, _) = read(&house(ROOMS.map(|r| r.1)));
    let widths: Vec<f64> =
        reading.openings.iter().filter(|o| o.kind == "door").map(|o| (o.width_m * 10.0).round()).collect();
    assert_eq!(widths, [9.0, 9.0]);
    assert!(reading.rooms.iter().all(|r| !r.doors.is_empty()), "{:?}", reading.rooms);
}

/// What speaks against the ways into rooms is counted and said; it makes the reading less sure.
#[test]
fn rooms_that_nobody_enters_are_told() {
    let whole = house(ROOMS.map(|r| r.1));
    let without = |y: &str| {
        let parts = whole.split("0|LINE|8|DOORS").filter(|p| !p.contains(y)).collect::<Vec<_>>();
        parts.join("0|LINE|8|DOORS")
    };
    let told = |report: &Report| {
        let of = report.problems.iter().find(|p| p.code == "ways-in-doubt");
        of.map(|p| p.text.clone())
    };
    let (sure, report) = read(&whole);
    assert_eq!(told(&report), None);
    let (unsure, report) = read(&without("|20|2.4|"));
    let text = told(&report).unwrap();
    assert!(text.contains("nobody can enter 1 of 3 rooms; look"), "{text}");
    assert!(
        unsure.sure.rooms.unwrap() < 0.65 && sure.sure.rooms.unwrap() > 0.8,
        "{:?} {:?}",
        sure.sure,
        unsure.sure
    );
}

/// A word alone says so; what speaks of a door to the court, or of the storey, does not.
#[test]
fn floor_that_a_text_calls_a_court_is_outdoors() {
    for (name, is_outdoors) in
        [("COURTYARD", true), ("Patio 1", true), ("PATIO DOOR", false), ("Garden view", false)]
    {
        let (reading, report) = read(&house(["LIVING", "KITCHEN", name]));
        let measured = reading.rooms.iter().any(|r| r.outline.iter().any(|p| p[0] > 9.0 && p[1] < 3.0));
        assert_eq!(measured, !is_outdoors, "{name}");
        let said = report.problems.iter().filter(|p| p.code == "outdoors-called").count();
        assert_eq!(said, usize::from(is_outdoors), "{name}");
    }
    // Nothing else is left then.
    let (reading, _) = read(&house(["COURTYARD"; 3]));
    assert_eq!(reading.rooms.len(), 3);
}

#[test]
fn two_letters_name_a_room_where_others_have_names() {
    assert_eq!(names(&read(&house(["LIVING", "KITCHEN", "HW"])).0), ["HW", "KITCHEN", "LIVING"]);
    assert_eq!(names(&read(&house(["LIVING", "KITCHEN", "UP"])).0), ["", "KITCHEN", "LIVING"]);
    assert_eq!(names(&read(&house(["HW", "AB", "XY"])).0), ["", "", ""], "marks alone name nothing");
}

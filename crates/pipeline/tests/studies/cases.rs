//! One quirk a file, as drawings have them: what is read of each, and what is said.

use enfilade_config::{Partial, Settings};
use enfilade_fixtures::shared;
use enfilade_overlay::result::CheckResult;
use enfilade_pipeline::{Input, Outcome};
use enfilade_report::{Cancel, Error};

/// What is understood of a file with a storey chosen, by its name below `cases`.
fn checked(file: &str, bytes: &[u8], storey: Option<&str>) -> Result<Outcome<CheckResult>, Error> {
    let said = Partial { storey: storey.map(String::from), ..Partial::default() };
    enfilade_pipeline::check(&Input::new(file, bytes, 1), &Settings::new(said)?)
}

/// Rooms by name or kind with their areas to a tenth, the largest first: `LIVING 39.3, KITCHEN 27.7`.
fn rooms(result: &CheckResult) -> String {
    let mut all: Vec<(String, f64)> = result
        .reading
        .as_ref()
        .map_or_else(Vec::new, |reading| reading.rooms.iter().map(|r| (r.name.clone(), r.area_m2)).collect());
    all.sort_by(|a, b| b.1.total_cmp(&a.1).then_with(|| a.0.cmp(&b.0)));
    let words: Vec<String> =
        all.iter().map(|(name, area)| format!("{name} {area:.1}").trim().to_owned()).collect();
    words.join(", ")
}

/// The bytes of a shared file, where it is there.
fn case(file: &str) -> Option<Vec<u8>> {
    shared(&format!("cases/{file}")).map(|path| std::fs::read(path).unwrap())
}

/// A code, and a piece of what is said with it.
type Said = Option<(&'static str, &'static str)>;

/// Each file, the storey asked for, its rooms, and what is said of it.
const READ: [(&str, Option<&str>, &str, Said); 23] = [
    ("01-xclip-clipped-floor.dxf", None, "LIVING 39.3", Some(("dxf-clipped", "block FLOOR is clipped"))),
    ("03-mark-text-attrib.dxf", None, "LIVING 39.3, KITCHEN 27.7, BEDROOM 27.1", None),
    ("04-two-storeys-z.dxf", None, "39.3, 27.7, 27.1", Some(("storey", "\"floor 2\" (floor 3.000 m"))),
    ("04-two-storeys-z.dxf", Some("2"), "38.6, 28.6, 26.9", None),
    ("20-gpu-instancing.gltf", None, "39.5, 27.2, 27.1", None),
    ("21-node-visibility.gltf", None, "39.3, 27.7, 27.1", Some(("gltf-hidden", "Wall hidden option"))),
    ("22-two-levels.glb", None, "", Some(("storey", "1 \"Level 1\""))),
    ("22-two-levels.glb", Some("Level 1"), "39.3, 27.7, 27.1", None),
    ("02-room-names-attrib.dxf", None, "LIVING 39.3, KITCHEN 27.7, BEDROOM 27.1", None),
    ("07-archicad-wall-blocks.dxf", None, "LIVING 39.3, KITCHEN 27.7, BEDROOM 27.1", None),
    ("08-room-wc.dxf", None, "Wohnen 39.3, WC 27.7, Bad 27.1", None),
    ("11-demolish-status.ifc", None, "39.3, 27.7, 27.1", None),
    (
        "12-storey-placement-zero.ifc",
        Some("Level 1"),
        "",
        Some(("storey-floor", "states 3.000 m as its elevation")),
    ),
    (
        "13-mapconversion-north.ifc",
        None,
        "Living 39.3, Kitchen 27.7, Bedroom 27.1",
        Some(("true-north", "40.0° to the right")),
    ),
    ("14-two-buildings.ifc", Some("1"), "39.3, 27.7, 27.1", Some(("ifc-buildings", "\"Haus B\""))),
    ("14-two-buildings.ifc", Some("2"), "39.3, 27.7, 27.0", Some(("ifc-buildings", "\"Haus A\""))),
    ("15-lining-over-door.ifc", None, "39.3, 27.5, 27.1", Some(("ifc-door-covered", "\"Lining P1"))),
    ("16-projection.ifc", None, "39.3, 27.7, 26.7", None),
    ("17-zone-names.ifc", None, "CHIMIE 39.3, WC 27.7, BACTERIOLOGIE 27.1", None),
    ("18-garden-court.ifc", None, "HALL 242.2", None),
    ("19-screen-with-hole.ifc", None, "39.3, 27.6, 27.1", None),
    ("24-roomboxes-doorlines.dxf", None, "Living 37.6, Bedroom 25.4, Kitchen 25.4", None),
    ("25-doors-in-uncut-walls.ifc", None, "Living 39.3, Kitchen 27.7, Bedroom 27.1", None),
];

#[test]
fn each_file_is_read_as_it_is_meant() {
    let mut wrong = Vec::new();
    for (file, storey, expected, said) in READ {
        let Some(bytes) = case(file) else { return };
        let Outcome { result, report, .. } = checked(file, &bytes, storey).unwrap();
        let found = rooms(&result);
        if !expected.is_empty() && found != expected {
            wrong.push(format!("{file} {storey:?}: rooms {found}, expected {expected}"));
        }
        let is_said = |(code, part): (&str, &str)| {
            report.problems.iter().any(|p| p.code == code && p.text.contains(part))
        };
        if let Some(said) = said.filter(|s| !is_said(*s)) {
            wrong.push(format!("{file}: {said:?} is not said"));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Doors, windows and moves where they are what matters.
#[test]
fn doors_windows_and_moves_are_those_of_the_file() {
    let Some(bytes) = case("07-archicad-wall-blocks.dxf") else { return };
    let result = checked("07.dxf", &bytes, None).unwrap().result;
    assert_eq!((result.doors, result.windows), (3, 5));
    let Some(bytes) = case("12-storey-placement-zero.ifc") else { return };
    let result = checked("12.ifc", &bytes, Some("Level 1")).unwrap().result;
    assert_eq!(result.wall_elements, 8);
    let Some(bytes) = case("09-rotated-freestanding.dxf") else { return };
    let moves = checked("09.dxf", &bytes, None).unwrap().result.moves;
    let mut screen: Vec<f64> =
        moves.iter().filter(|m| m.name == "element-1").filter_map(|m| m.direction_deg).collect();
    screen.iter_mut().for_each(|deg| *deg = deg.rem_euclid(180.0).round());
    screen.sort_by(f64::total_cmp);
    assert_eq!(screen, [30.0, 120.0]);
}

/// Where the walls lie in another file, the refusal names it and the cure.
#[test]
fn drawings_without_their_walls_are_refused() {
    for (file, named) in
        [("05-xref-walls-furniture.dxf", "bind the xref GF"), ("06-xref-two-layers.dxf", "ARCH-BASE.dwg")]
    {
        let Some(bytes) = case(file) else { return };
        let error = checked(file, &bytes, None).unwrap_err().to_string();
        assert!(error.contains(named), "{error}");
    }
}

/// Rooms that are drawn each with walls of their own are joined by their doors, which are as wide as their leaves.
#[test]
fn doors_between_boxes_open_both_walls() {
    let Some(bytes) = case("24-roomboxes-doorlines.dxf") else { return };
    let result = checked("24.dxf", &bytes, None).unwrap().result;
    let openings = result.reading.map_or_else(Vec::new, |r| r.openings);
    let doors: Vec<f64> = openings.iter().filter(|o| o.kind == "door").map(|o| o.width_m).collect();
    assert_eq!(doors.iter().filter(|w| (*w - 0.914).abs() < 0.001).count(), 3, "{doors:?}");
    let settings = Settings::new(Partial::default()).unwrap();
    let input = Input::new("24.dxf", &bytes, 1);
    let (outcome, _) = enfilade_pipeline::analyse(&input, &settings, &Cancel::default()).unwrap();
    let codes: Vec<&str> = outcome.report.problems.iter().map(|p| p.code).collect();
    assert!(!codes.contains(&"cut-off-areas"), "{codes:?}");
}

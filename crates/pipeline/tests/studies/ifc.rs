//! IFC both ways: what is read of a small building, what a move changes, what is refused and in which words.

#![allow(clippy::unwrap_used)]

#[allow(dead_code)]
#[path = "../../../../examples/make_samples/building.rs"]
mod building;
#[allow(dead_code)]
#[path = "../../../../examples/make_samples/dxf.rs"]
mod dxf;
#[allow(dead_code)]
#[path = "../../../../examples/make_samples/ifc.rs"]
mod sample;

#[path = "ifc/rings.rs"]
mod rings;
#[path = "ifc/rooms.rs"]
mod rooms;
#[path = "ifc/slots.rs"]
mod slots;
#[path = "ifc/storeys.rs"]
mod storeys;
#[path = "ifc/told.rs"]
mod told;
#[path = "ifc/unseen.rs"]
mod unseen;

use std::io::Write;

use enfilade_cad::drawing::{Addition, Drawing, Edit, Editable, Entity, Mark, RigidMotion, Shape, Unit};
use enfilade_cad::{Completeness, ReadOptions, ifc};
use enfilade_config::{Partial, Settings};
use enfilade_pipeline::Input;
use enfilade_report::{Cancel, Error, Report};
use glam::DVec2;
use proptest::prelude::*;

fn read_with(bytes: &[u8], options: &ReadOptions) -> (Result<Drawing, Error>, Report) {
    let mut report = Report::default();
    (enfilade_cad::read("house.ifc", bytes, options, &mut report), report)
}

fn read(bytes: &[u8]) -> Drawing {
    read_with(bytes, &ReadOptions::default()).0.unwrap()
}

fn patch(bytes: &[u8], edits: &[Edit], own: &[Addition]) -> Result<Vec<u8>, Error> {
    enfilade_cad::patch("house.ifc", bytes, &ReadOptions::default(), edits, own)
}

fn points(e: &Entity) -> Vec<DVec2> {
    let Shape::Polyline { vertices, .. } = &e.shape else { return Vec::new() };
    vertices.iter().map(|v| v.at).collect()
}

fn on<'d>(drawing: &'d Drawing, layer: &str) -> Vec<&'d Entity> {
    drawing.entities.iter().filter(|e| e.layer == layer).collect()
}

/// Instance of the element with that name.
fn named(text: &str, name: &str) -> usize {
    let line = text
        .lines()
        .find(|l| l.contains(&format!("'{name}'")) && (l.contains("=IFCWALL(") || l.contains("=IFCCOLUMN(")));
    line.unwrap()[1..].split('=').next().unwrap().parse().unwrap()
}

fn shift(record: usize, x: f64, y: f64) -> Edit {
    Edit::Insert { record, motion: RigidMotion { turn_rad: 0.0, shift: DVec2::new(x, y) } }
}

fn pavilion() -> String {
    sample::building(false)
}

/// The end mark closes the file by its letters, and stands within an instance: whatever is added would lie behind it.
#[test]
fn an_end_within_an_instance_is_none() {
    let whole = include_str!("../../../../samples/pavilion.ifc");
    let data = &whole[..whole.rfind("ENDSEC;").unwrap()];
    let odd = format!("{data}#900000=IFCTEXT('a;\nENDSEC;\n#900001=('b\nEND-ISO-10303-21;\n");
    let read = |text: &str| {
        enfilade_cad::read("house.ifc", text.as_bytes(), &ReadOptions::default(), &mut Report::default())
    };
    assert!(read(whole).is_ok());
    let error = read(&odd).unwrap_err();
    assert_eq!(error.problem().map(|p| p.code), Some("ifc-syntax"), "{error}");
    assert!(error.to_string().contains("END-ISO-10303-21"), "{error}");
}

#[test]
fn the_ground_floor_of_the_sample() {
    let text = pavilion();
    let (drawing, report) = read_with(text.as_bytes(), &ReadOptions::default());
    let drawing = drawing.unwrap();
    assert!(!report.is_degraded(), "{report:?}");
    // 4 outer walls in 12 pieces, the hall in 3, the cloakroom in 2, four screens.
    assert_eq!(on(&drawing, "IfcWall").len(), 12 + 3 + 2 + 4);
    assert_eq!(on(&drawing, "IfcColumn").len(), 2);
    assert_eq!(on(&drawing, "IfcDoor").len(), 4);
    assert_eq!(on(&drawing, "IfcWindow").len(), 7);
    assert_eq!(on(&drawing, "IfcSpace").len(), 2);
    assert_eq!(on(&drawing, "EF-QUERY").len(), 1);
    assert_eq!(
        drawing.texts.iter().map(|t| t.text.as_str()).collect::<Vec<_>>(),
        ["Foyer\nFoyer", "Gallery\nGallery"]
    );
    let marked: Vec<&str> = drawing.marked.iter().map(|m| m.name.as_str()).collect();
    assert_eq!(marked, ["cloakroom", "screen-1", "screen-2", "screen-3", "screen-4"]);
    let tags = enfilade_cad::host_ids("house.ifc", text.as_bytes(), &[named(&text, "screen-1")]);
    assert!(tags[0].as_ref().is_some_and(|t| t.starts_with('1')), "{tags:?}");
}

#[test]
fn a_building_is_counted_by_the_classes_of_its_file() {
    let text = pavilion();
    let count = |class: &str| text.matches(&format!("={class}(")).count() as u64;
    let (storeys, elements) =
        enfilade_cad::Opened::new("house.ifc", text.as_bytes()).unwrap().building(&ReadOptions::default());
    let expected = ifc::Elements {
        storeys: 2,
        walls: count("IFCWALL") + count("IFCWALLSTANDARDCASE"),
        columns: count("IFCCOLUMN"),
        doors: count("IFCDOOR"),
        windows: count("IFCWINDOW"),
        spaces: count("IFCSPACE"),
    };
    assert_eq!((storeys.len(), elements), (2, Some(expected)));
    assert!(expected.walls > 0 && expected.doors > 0 && expected.windows > 0 && expected.columns > 0);
    assert_eq!(
        enfilade_cad::Opened::new("plan.dxf", b"").unwrap().building(&ReadOptions::default()),
        (Vec::new(), None)
    );
}

#[test]
fn storeys_read_together_are_those_read_apart() {
    let text = pavilion();
    let of = |name: &str| ReadOptions { storey: Some(name.into()), ..ReadOptions::default() };
    let options = [of("Upper floor"), of("Ground floor"), of("attic")];
    let together = enfilade_cad::Opened::new("house.ifc", text.as_bytes()).unwrap().read_all(&options);
    assert_eq!(together.len(), options.len());
    for (options, (drawing, report)) in options.iter().zip(together) {
        let (apart, own) = read_with(text.as_bytes(), options);
        assert_eq!((drawing.ok(), report), (apart.ok(), own));
    }
}

#[test]
fn storeys_by_name_and_at_the_height_of_the_knees() {
    let text = pavilion();
    let upper = ReadOptions { storey: Some("upper floor".into()), ..ReadOptions::default() };
    let drawing = read_with(text.as_bytes(), &upper).0.unwrap();
    assert_eq!((on(&drawing, "IfcWall").len(), on(&drawing, "IfcWindow").len()), (12 + 3 + 1, 8));
    let wrong = ReadOptions { storey: Some("attic".into()), ..ReadOptions::default() };
    let error = read_with(text.as_bytes(), &wrong).0.unwrap_err().to_string();
    assert!(
        error.contains(
            "no such storey, storeys present, by number and name: 1 \"Ground floor\" (floor 0.000 m, "
        ),
        "{error}"
    );
    let knee = ReadOptions { sight: ifc::Sight::Knee, ..ReadOptions::default() };
    let drawing = read_with(text.as_bytes(), &knee).0.unwrap();
    assert_eq!((on(&drawing, "IfcWindow").len(), on(&drawing, "IfcDoor").len()), (0, 4));
    let names: Vec<String> =
        enfilade_cad::storeys("house.ifc", text.as_bytes(), &knee).into_iter().map(|s| s.name).collect();
    assert_eq!(names, ["Ground floor", "Upper floor"]);
}

#[test]
fn doors_follow_their_wall_wherever_they_are_placed() {
    for in_world in [false, true] {
        let text = sample::building(in_world);
        let wall = named(&text, "cloakroom");
        let before = read(text.as_bytes());
        let bytes = patch(text.as_bytes(), &[shift(wall, 250.0, 500.0)], &[]).unwrap();
        let after = read(&bytes);
        assert_eq!(before.entities.len(), after.entities.len());
        let mut moved = 0;
        for (a, b) in before.entities.iter().zip(&after.entities) {
            let by = points(b)[0] - points(a)[0];
            let follows =
                a.source.record == wall || a.layer == "IfcDoor" && (points(a)[0].y - 7500.0).abs() < 100.0;
            let expected = if follows { DVec2::new(250.0, 500.0) } else { DVec2::ZERO };
            assert!((by - expected).length() < 1e-6, "in_world {in_world}: {:?} moved by {by}", a.source);
            moved += usize::from(follows);
        }
        assert_eq!(moved, 3, "two pieces of the wall and its door");
        let edits = [shift(wall, 1.0, 0.0)];
        let products = enfilade_cad::changes("house.ifc", text.as_bytes(), &ReadOptions::default(), &edits)
            .unwrap()
            .records;
        assert_eq!(products[0].len(), 3, "wall, opening, door: {products:?}");
        assert!(products[0].iter().all(|p| p.of.handle.as_ref().is_some_and(|h| h.len() == 22)));
    }
}

#[test]
fn a_point_that_two_walls_share_is_copied() {
    let text = pavilion();
    let id = |needle: &str| {
        let line = text.lines().find(|l| l.contains(needle)).unwrap();
        line.split('=').next().unwrap().to_string()
    };
    let (one, other) =
        (id("IFCCARTESIANPOINT((2000.,4000.,0.))"), id("IFCCARTESIANPOINT((10000.,3200.,0.))"));
    let shared =
        text.replace(&format!("IFCAXIS2PLACEMENT3D({other},"), &format!("IFCAXIS2PLACEMENT3D({one},"));
    assert_ne!(shared, text);
    let (mover, stays) = (named(&text, "screen-1"), named(&text, "screen-2"));
    let bytes = patch(shared.as_bytes(), &[shift(mover, 300.0, 0.0)], &[]).unwrap();
    let (before, after) = (read(shared.as_bytes()), read(&bytes));
    let of = |d: &Drawing, r: usize| points(d.entities.iter().find(|e| e.source.record == r).unwrap());
    assert_eq!(of(&before, stays), of(&after, stays));
    assert_eq!(of(&before, mover)[0] + DVec2::new(300.0, 0.0), of(&after, mover)[0]);
    assert!(
        String::from_utf8(bytes).unwrap().contains(&format!("{one}=IFCCARTESIANPOINT((2000.,4000.,0.));"))
    );
}

#[test]
fn what_is_added_comes_off_again() {
    let text = pavilion();
    let add = |layer: &str, mark| Addition { layer: layer.into(), rgb: [200, 30, 30], mark };
    let own = [
        add("EF-NOTE", Mark::Text { at: DVec2::ZERO, height: 100.0, text: "it's ä 壁\nb".into() }),
        add("EF-HEAT-DEGREE", Mark::Fill { corners: [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y] }),
        add("EF-MOVED", Mark::Path { points: vec![DVec2::ZERO, DVec2::X], closed: true }),
    ];
    for schema in ["IFC2X3", "IFC4", "IFC4X3_ADD2"] {
        let text = text.replace("'IFC4'", &format!("'{schema}'"));
        let wall = named(&text, "screen-1");
        let edits = [shift(wall, 10.0, 0.0)];
        let (bare, full) = (patch(text.as_bytes(), &edits, &[]), patch(text.as_bytes(), &edits, &own));
        let full = full.unwrap();
        assert_eq!(ifc::strip_own(&full), bare.unwrap(), "{schema}");
        assert_eq!(read(&full).entities.len(), read(text.as_bytes()).entities.len());
        let written = String::from_utf8(full).unwrap();
        assert!(written.contains("'Pset_Enfilade_Result'") && written.contains("'EF-HEAT-DEGREE'"));
        assert!(patch(text.as_bytes(), &[], &[]).unwrap() == text.as_bytes());
    }
}

#[test]
fn lines_end_as_in_the_file() {
    for end in ["\n", "\r\n", "\r"] {
        let text = pavilion().replace('\n', end);
        let mark = Mark::Path { points: vec![DVec2::ZERO, DVec2::X], closed: false };
        let own = [Addition { layer: "EF-MOVED".into(), rgb: [200, 30, 30], mark }];
        let written = String::from_utf8(patch(text.as_bytes(), &[], &own).unwrap()).unwrap();
        let lines = written.replace(end, "|");
        assert!(!lines.contains(['\r', '\n']), "{end:?}");
        assert!(lines.ends_with("|ENDSEC;|END-ISO-10303-21;|"));
        assert_eq!(ifc::strip_own(written.as_bytes()), text.as_bytes());
    }
}

/// One bad input: what is done to the sample, and what must be said of it.
struct Hazard {
    name: &'static str,
    bytes: Vec<u8>,
    says: &'static str,
    /// Whether the file is refused; else the rest of it is read.
    is_refused: bool,
}

fn hazard(name: &'static str, text: impl Into<Vec<u8>>, says: &'static str, is_refused: bool) -> Hazard {
    Hazard { name, bytes: text.into(), says, is_refused }
}

/// The sample with the placement of a screen replaced by that text, and instances added.
fn with_placement(of: &str, placement: &str, added: &str) -> String {
    let text = pavilion();
    let line = text.lines().find(|l| l.contains(&format!("'{of}'"))).unwrap();
    let new = {
        let mut parts: Vec<&str> = line.split(',').collect();
        let at = parts.iter().position(|p| p.starts_with('#') && !p.contains('=')).unwrap();
        parts[at] = placement;
        parts.join(",")
    };
    text.replace(line, &new).replace("ENDSEC;\nEND-ISO", &format!("{added}ENDSEC;\nEND-ISO"))
}

fn placements() -> Vec<Hazard> {
    let axes = "#90000=IFCCARTESIANPOINT((0.,0.,0.));\n#90001=IFCAXIS2PLACEMENT3D(#90000,$,$);\n";
    let ring = format!(
        "{axes}#90004=IFCLOCALPLACEMENT(#90005,#90001);\n#90005=IFCLOCALPLACEMENT(#90006,#90001);\n\
         #90006=IFCLOCALPLACEMENT(#90005,#90001);\n"
    );
    let mut chain = axes.to_string();
    chain.push_str("#100000=IFCLOCALPLACEMENT($,#90001);\n");
    for i in 1..200_000 {
        chain.push_str(&format!("#{}=IFCLOCALPLACEMENT(#{},#90001);\n", 100_000 + i, 99_999 + i));
    }
    let flat = |axis: &str, reference: &str| {
        let directions = format!("#90002=IFCDIRECTION({axis});\n#90003=IFCDIRECTION({reference});\n");
        let own = "#90004=IFCAXIS2PLACEMENT3D(#90000,#90002,#90003);\n#90005=IFCLOCALPLACEMENT($,#90004);\n";
        with_placement("screen-1", "#90005", &format!("{axes}{directions}{own}"))
    };
    vec![
        hazard(
            "38 ring of placements",
            with_placement("screen-1", "#90004", &ring),
            "placements are relative to each other in a ring: #90005>#90006>#90005; this part of it is left out",
            false,
        ),
        hazard(
            "38 chain of 200,000 placements",
            with_placement("screen-1", "#299999", &chain),
            "a chain of more than 1000 placements starts at #299999; this part of it is left out",
            false,
        ),
        hazard(
            "39 dangling",
            with_placement("screen-1", "#77777", ""),
            "#77777 does not exist; this part of it",
            false,
        ),
        hazard(
            "40 direction without length",
            flat("(0.,0.,0.)", "(1.,0.,0.)"),
            "#90002 IFCDIRECTION has no length, expected a direction",
            false,
        ),
        hazard(
            "40 direction of one ratio",
            flat("(0.)", "(1.,0.,0.)"),
            "#90002 IFCDIRECTION has not two or three ratios",
            false,
        ),
        hazard(
            "40 both axes along one line",
            flat("(1.,0.,0.)", "(1.,0.,0.)"),
            "#90004 IFCAXIS2PLACEMENT3D has its two axes along one line",
            false,
        ),
    ]
}

fn syntax() -> Vec<Hazard> {
    let text = pavilion();
    let added = |lines: &str| text.replace("ENDSEC;\nEND-ISO", &format!("{lines}\nENDSEC;\nEND-ISO"));
    let first = text.lines().find(|l| l.starts_with("#1=")).unwrap();
    let screen = text.lines().find(|l| l.contains("'screen-1'")).unwrap();
    let twin = text.lines().find(|l| l.contains("'screen-2'")).unwrap();
    let id_of = |line: &str| line[line.find('\'').unwrap() + 1..][..22].to_string();
    let same_id = text.replace(&id_of(twin), &id_of(screen));
    vec![
        hazard("39 number twice", added(first), "#1 is given 2 times, expected each number once", false),
        hazard("39 GlobalId twice", same_id, "is given to several elements, expected one", false),
        hazard(
            "39 huge number",
            added("#99999999999999999999=IFCWALL($);"),
            "found a number after `#` of 19 digits or more, expected at most 4611686018427387902; export the file with smaller numbers; the instance is left out",
            false,
        ),
        hazard(
            "39 number with a sign",
            added("#+29=IFCWALL($);"),
            "#29 is given 2 times, expected each number once",
            false,
        ),
        hazard(
            "39 missing parenthesis",
            added("#90000=IFCWALL('a',$;"),
            "found an instance that does not end with `);`; the instance is left out",
            false,
        ),
        hazard(
            "39 unclosed text",
            added("#90000=IFCWALL('a,$);"),
            "a text without its closing quote, expected `'`; nothing was done",
            true,
        ),
        hazard(
            "39 200,000 parentheses",
            added(&format!("#90000=IFCWALL({}{});", "(".repeat(200_000), ")".repeat(200_000))),
            "found parentheses nested deeper than any schema has them; the instance is left out",
            false,
        ),
        hazard(
            "39 unclosed comment",
            added("/* no end"),
            "a comment that does not end; nothing was done",
            true,
        ),
    ]
}

fn zipped(text: &[u8], claimed: Option<u32>) -> Vec<u8> {
    let mut packer = flate2::write::DeflateEncoder::new(Vec::new(), flate2::Compression::best());
    packer.write_all(text).unwrap();
    let packed = packer.finish().unwrap();
    let size = claimed.unwrap_or(text.len() as u32);
    let name = b"house.ifc";
    let mut crc = flate2::Crc::new();
    crc.update(text);
    // Version, flags, method 8, time, date, checksum; sizes; lengths of name and extra field.
    let fields = [
        &[20, 0, 0, 0, 8, 0, 0, 0, 0, 0][..],
        &crc.sum().to_le_bytes(),
        &(packed.len() as u32).to_le_bytes(),
        &size.to_le_bytes(),
        &(name.len() as u16).to_le_bytes(),
        &[0, 0],
    ]
    .concat();
    let mut out = [b"PK\x03\x04", &fields[..], name, &packed].concat();
    let at = out.len() as u32;
    out.extend([b"PK\x01\x02\x14\0", &fields[..], &[0; 14], name].concat());
    let len = out.len() as u32 - at;
    out.extend(b"PK\x05\x06\0\0\0\0\x01\0\x01\0");
    out.extend([&len.to_le_bytes()[..], &at.to_le_bytes(), &[0, 0]].concat());
    out
}

fn kinds() -> Vec<Hazard> {
    let text = pavilion();
    let bomb = zipped(&vec![b' '; 64 << 20], None);
    vec![
        hazard(
            "41 another schema",
            text.replace("'IFC4'", "'AP214'"),
            "found schema \"AP214\", expected IFC2X3, IFC4 or IFC4X3; nothing was done",
            true,
        ),
        hazard(
            "41 no schema",
            text.replace("FILE_SCHEMA(('IFC4'));\n", ""),
            "found no schema, expected IFC2X3, IFC4 or IFC4X3",
            true,
        ),
        hazard(
            "41 ifcXML",
            "<?xml version=\"1.0\"?><ifcXML/>",
            "found IFC as XML, expected a STEP file (.ifc)",
            true,
        ),
        hazard("41 zip bomb", bomb, "times the packed size; nothing was done", true),
        hazard(
            "41 zip that lies",
            zipped(text.as_bytes(), Some(100)),
            "unpacks to another size than stated",
            true,
        ),
        hazard(
            "41 zip cut off",
            zipped(text.as_bytes(), None)[..2000].to_vec(),
            "found a damaged archive, expected a ZIP file",
            true,
        ),
        hazard(
            "no end",
            text.replace("END-ISO-10303-21;\n", ""),
            "found no END-ISO-10303-21; at its end",
            true,
        ),
    ]
}

#[test]
fn bad_inputs_are_named_and_the_rest_is_read() {
    let whole = read(pavilion().as_bytes()).entities.len();
    for h in placements().into_iter().chain(syntax()).chain(kinds()) {
        let (drawing, report) = read_with(&h.bytes, &ReadOptions::default());
        let said = match &drawing {
            Ok(_) => report.problems.iter().map(|p| format!("{p}\n")).collect(),
            Err(error) => error.to_string(),
        };
        assert!(said.contains(h.says), "{}: expected {:?}, found {said}", h.name, h.says);
        assert_eq!(drawing.is_err(), h.is_refused, "{}: {said}", h.name);
        if let Ok(drawing) = drawing {
            assert!(report.is_degraded(), "{}: not stated as left out", h.name);
            assert!(drawing.entities.len() + 1 >= whole, "{}: more than one wall is missing", h.name);
            assert_eq!(patch(&h.bytes, &[], &[]).unwrap(), h.bytes, "{}", h.name);
        }
    }
}

#[test]
fn faults_are_named_by_line_and_byte() {
    let text = pavilion();
    let added = |line: &str| text.replace("ENDSEC;\nEND-ISO", &format!("{line}\nENDSEC;\nEND-ISO"));
    let cases = [
        ("#90000=IFCWALL('a',$;", '(', "an instance that does not end with `);`"),
        ("#90000=IFCWALL('a',1e);", '1', "a value that is no number"),
        ("#90000=IFCWALL('a' $);", '$', "two values without a comma between them"),
        ("#90000=IFCWALL('a',#);", '#', "a `#` without a number"),
        ("#90000 IFCWALL('a');", 'I', "no `=` after the number of an instance"),
    ];
    for (line, odd, says) in cases {
        let bytes = added(line);
        let start = bytes.find(line).unwrap();
        let at = start + line.rfind(odd).unwrap();
        let report = read_with(bytes.as_bytes(), &ReadOptions::default()).1;
        let fault = report.problems.iter().find(|p| p.code == "ifc-instance").unwrap();
        assert_eq!(fault.text, format!("byte {at}: found {says}; the instance is left out"));
        assert_eq!(fault.place.line, Some(bytes[..at].matches('\n').count() + 1), "{line}");
    }
}

#[test]
fn numbers_given_twice_are_read_and_never_written() {
    for h in syntax().into_iter().filter(|h| h.name.ends_with("twice")) {
        let drawing = read(&h.bytes);
        let screen = named(&pavilion(), "screen-1");
        let editable = &drawing.entities.iter().find(|e| e.source.record == screen).unwrap().editable;
        assert!(matches!(editable, Editable::No(_)), "{}: {editable:?}", h.name);
        let error = patch(&h.bytes, &[shift(screen, 1.0, 0.0)], &[]).unwrap_err().to_string();
        assert!(error.contains("cannot be moved: the file gives"), "{}: {error}", h.name);
    }
}

#[test]
fn odd_but_legal_text_reads_the_same() {
    let text = pavilion();
    let expected = read(text.as_bytes());
    let (head, rest) = text.split_once("DATA;\n").unwrap();
    let (data, tail) = rest.split_once("ENDSEC;").unwrap();
    let backwards: String = data.lines().rev().map(|l| format!("{l}\n")).collect();
    let backwards = format!("{head}DATA;\n{backwards}ENDSEC;{tail}");
    let same_points = |d: &Drawing| {
        let key = |d: &Drawing| {
            let mut all: Vec<String> = d
                .entities
                .iter()
                .map(|e| format!("{} {} {:?}", e.source.record, e.layer, points(e)))
                .collect();
            all.sort();
            all
        };
        assert_eq!(key(d), key(&expected));
    };
    same_points(&read(backwards.as_bytes()));
    same_points(&read(text.replace("=IFCWALL(", "=ifcwall(").as_bytes()));
    same_points(&read(text.replace('\n', "\r\n").as_bytes()));
    same_points(&read(text.replace("=IFCWALL(", " =\n IFCWALL /* a ; comment ' */ (").as_bytes()));
    same_points(&read(&zipped(text.as_bytes(), None)));
}

#[test]
fn a_file_cut_anywhere_is_not_whole() {
    let text = pavilion();
    let end = text.trim_end().len();
    for cut in (0..end).step_by(97).chain(end - 20..end) {
        let found = enfilade_cad::is_complete("house.ifc", &text.as_bytes()[..cut]);
        assert_ne!(found, Completeness::Whole, "cut at byte {cut}");
    }
    assert_eq!(enfilade_cad::is_complete("house.ifc", text.as_bytes()), Completeness::Whole);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Any motion of any element: it alone stands elsewhere, as told, and only its own instances change.
    #[test]
    fn moves_are_written_as_told(which in 0usize..8, turn in -3.0..3.0f64, x in -5e3..5e3f64, y in -5e3..5e3f64, in_world: bool) {
        let text = sample::building(in_world);
        let name = ["screen-1", "screen-2", "screen-3", "screen-4", "column-1", "cloakroom", "hall", "east"][which];
        let wall = named(&text, name);
        let motion = RigidMotion { turn_rad: turn, shift: DVec2::new(x, y) };
        let bytes = patch(text.as_bytes(), &[Edit::Insert { record: wall, motion }], &[]).unwrap();
        let (before, after) = (read(text.as_bytes()), read(&bytes));
        let own = |d: &Drawing| -> Vec<DVec2> {
            d.entities.iter().filter(|e| e.source.record == wall).flat_map(points).collect()
        };
        for (a, b) in own(&before).into_iter().zip(own(&after)) {
            let expected = DVec2::from_angle(turn).rotate(a) + motion.shift;
            prop_assert!((b - expected).length() < 1e-6, "{a} to {b}, expected {expected}");
        }
        let others = |d: &Drawing| -> Vec<(usize, Vec<DVec2>)> {
            let fixed = d.entities.iter().filter(|e| e.source.record != wall && e.layer == "IfcWall");
            fixed.map(|e| (e.source.record, points(e))).collect()
        };
        prop_assert_eq!(others(&before), others(&after));
        let written = String::from_utf8(bytes).unwrap();
        let changed = text.lines().zip(written.lines()).filter(|(a, b)| a != b).count();
        prop_assert!(changed <= 24, "{changed} lines changed");
    }

    /// Any damage: an answer or an error, the same twice, and no edit gives the same bytes.
    #[test]
    fn damaged_files_never_panic(at in 0usize..60_000, with in prop::collection::vec(any::<u8>(), 1..6)) {
        let mut bytes = pavilion().into_bytes();
        let at = at % bytes.len();
        let end = (at + with.len()).min(bytes.len());
        bytes.splice(at..end, with);
        let (once, twice) = (read_with(&bytes, &ReadOptions::default()), read_with(&bytes, &ReadOptions::default()));
        prop_assert_eq!(once.0.ok(), twice.0.ok());
        prop_assert_eq!(once.1, twice.1);
        prop_assert_eq!(patch(&bytes, &[], &[]).unwrap(), bytes);
    }
}

/// A data section that nobody closed: what is written stands in it all the same.
#[test]
fn a_missing_endsec_does_not_lose_what_is_added() {
    let text = pavilion();
    let at = text.rfind("ENDSEC;").unwrap();
    let open = format!("{}{}", &text[..at], &text[at + "ENDSEC;".len()..]);
    let note = Addition {
        layer: "EF-NOTE".into(),
        rgb: [0, 0, 0],
        mark: Mark::Text { at: DVec2::ZERO, height: 1.0, text: "ours".into() },
    };
    let options = ReadOptions::default();
    let written = enfilade_cad::patch("house.ifc", open.as_bytes(), &options, &[], &[note]).unwrap();
    assert!(written.trim_ascii_end().ends_with(b"END-ISO-10303-21;") && written.len() > open.len());
    assert!(!read_with(&written, &options).0.unwrap().entities.is_empty());
}

#[test]
fn spaces_are_known_by_their_zones() {
    let text = pavilion();
    let space = text.lines().find(|l| l.contains("=IFCSPACE(")).unwrap();
    let id: usize = space[1..].split('=').next().unwrap().parse().unwrap();
    // The zones hold each other: nobody goes round in them.
    let zones = format!(
        "#90001=IFCZONE('3ZoneGlobalId000000001',$,'Public',$,$);\n\
         #90002=IFCZONE('3ZoneGlobalId000000002',$,'Whole house',$,$);\n\
         #90003=IFCRELASSIGNSTOGROUP('3ZoneGlobalId000000003',$,$,$,(#{id}),$,#90001);\n\
         #90004=IFCRELASSIGNSTOGROUP('3ZoneGlobalId000000004',$,$,$,(#90001),$,#90002);\n\
         #90005=IFCRELASSIGNSTOGROUP('3ZoneGlobalId000000005',$,$,$,(#90002),$,#90001);\n\
         #90006=IFCPROPERTYSINGLEVALUE('Keep',$,IFCBOOLEAN(.T.),$);\n\
         #90007=IFCPROPERTYSET('3ZoneGlobalId000000006',$,'Pset_Enfilade',$,(#90006));\n\
         #90008=IFCRELDEFINESBYPROPERTIES('3ZoneGlobalId000000007',$,$,$,(#90002),#90007);\nENDSEC;\nEND-ISO"
    );
    let zoned = text.replace("ENDSEC;\nEND-ISO", &zones);
    let (plain, drawing) = (read(text.as_bytes()), read(zoned.as_bytes()));
    let names = |d: &Drawing| -> Vec<(usize, String)> {
        let of = d.texts.iter().filter(|t| t.layer == "IfcZone");
        of.map(|t| (t.source.record, t.text.clone())).collect()
    };
    assert!(names(&plain).is_empty() && on(&plain, "EF-KEEP").is_empty());
    assert_eq!(names(&drawing), [(id, "Public\nWhole house".to_string())]);
    let kept: Vec<usize> = on(&drawing, "EF-KEEP").iter().map(|e| e.source.record).collect();
    assert_eq!(kept, [id]);
}

/// One end of a rectangle cannot move where nothing says where its middle is.
#[test]
fn a_rectangle_without_a_position_keeps_its_length() {
    let text = include_str!("../../../../fuzz/corpus/ifc/bodies.ifc");
    let grows = |text: &str| {
        let drawing = read(text.as_bytes());
        drawing.entities.iter().filter(|e| matches!(e.editable, Editable::Wall { .. })).count()
    };
    let without = text.replacen("#25,4000.0,", "$,4000.0,", 1);
    assert!(without != text);
    assert!(grows(&without) < grows(text));
}

#[test]
fn a_wall_beyond_all_buildings_is_left_out() {
    let text = include_str!("../../../../fuzz/corpus/ifc/bodies.ifc");
    let far =
        text.replacen("#20=IFCCARTESIANPOINT((0.,0.,0.));", "#20=IFCCARTESIANPOINT((1.E+300,0.,0.));", 1);
    let (drawing, report) = read_with(far.as_bytes(), &ReadOptions::default());
    assert!(format!("{report:?}").contains("it lies beyond all buildings"), "{report:?}");
    let walls = |drawing: &Drawing| on(drawing, "IfcWallStandardCase").len();
    assert!(walls(&drawing.unwrap()) < walls(&read(text.as_bytes())));
}

/// Layers and corners of everything read, metres.
fn shapes(drawing: &Drawing, metres: f64) -> Vec<(String, Vec<[i64; 2]>)> {
    let round = |p: DVec2| [p.x, p.y].map(|v| (v * metres * 1e6).round() as i64);
    drawing.entities.iter().map(|e| (e.layer.clone(), points(e).into_iter().map(round).collect())).collect()
}

/// The plan and the heights are in one unit: the user's, the file's, or that in which walls are as high as walls are.
#[test]
fn heights_are_in_the_unit_of_the_plan() {
    let text = pavilion();
    let whole = shapes(&read(text.as_bytes()), 1e-3);
    let bare = text.replace("IFCUNITASSIGNMENT((#1,#2))", "IFCUNITASSIGNMENT((#2))");
    let unsaid = read(bare.as_bytes());
    assert_eq!((unsaid.declared_unit, unsaid.unit_by_heights.map(|u| u.name)), (None, Some("mm")));
    assert_eq!(shapes(&unsaid, 1e-3), whole);
    let wrong = text.replace(".LENGTHUNIT.,.MILLI.,.METRE.", ".LENGTHUNIT.,$,.METRE.");
    let millimetre = Some(Unit { name: "mm", metres: 1e-3 });
    for text in [bare, wrong] {
        let options = ReadOptions { unit: millimetre, ..ReadOptions::default() };
        let (drawing, report) = read_with(text.as_bytes(), &options);
        assert_eq!(shapes(&drawing.unwrap(), 1e-3), whole);
        assert!(report.problems.iter().any(|p| p.text.contains("cut 1.50 m above")), "{report:?}");
        let floors = enfilade_cad::storeys("house.ifc", text.as_bytes(), &options);
        assert_eq!(floors.iter().map(|s| s.floor_m).collect::<Vec<_>>(), [0.0, 3.2]);
    }
}

/// What stands between the last instance and ENDSEC stays there, and what is ours before it.
#[test]
fn nothing_of_ours_stands_between_a_last_comment_and_endsec() {
    let text = pavilion();
    let at = text.rfind("ENDSEC;").unwrap();
    let one_line = text.replace('\n', "");
    let commented = format!("{}/* the last word */\nENDSEC;{}", &text[..at], &text[at + 7..]);
    let mark = Mark::Path { points: vec![DVec2::ZERO, DVec2::X], closed: false };
    let own = [Addition { layer: "EF-MOVED".into(), rgb: [200, 30, 30], mark }];
    for text in [text, one_line, commented] {
        let data = text.rfind(");").unwrap() + 2;
        for edits in [vec![], vec![shift(named_in(&text, "screen-1"), 10.0, 0.0)]] {
            let bare = patch(text.as_bytes(), &edits, &[]).unwrap();
            let full = patch(text.as_bytes(), &edits, &own).unwrap();
            assert!(full.ends_with(&text.as_bytes()[data..]), "{}", String::from_utf8_lossy(&full));
            assert!(bare.ends_with(&text.as_bytes()[data..]));
            assert_eq!(ifc::strip_own(&full), bare);
        }
    }
}

/// Instance of the wall with that name, however lines end.
fn named_in(text: &str, name: &str) -> usize {
    let statement = text.split(';').find(|s| s.contains(&format!("'{name}'")) && s.contains("=IFCWALL("));
    statement.unwrap().trim().trim_start_matches('#').split('=').next().unwrap().parse().unwrap()
}

fn with_instances(text: &str, added: &str) -> String {
    text.replace("ENDSEC;\nEND-ISO", &format!("{added}ENDSEC;\nEND-ISO"))
}

#[test]
fn a_part_of_itself_is_shown_and_named() {
    let text = pavilion();
    let whole = read(text.as_bytes()).entities.len();
    let [a, b] = ["screen-1", "screen-2"].map(|n| named(&text, n));
    let rel = |id: u64, one: usize, part: usize| {
        format!("#{id}=IFCRELAGGREGATES('R{id}',$,$,$,#{one},(#{part}));\n")
    };
    for (added, said) in [
        (rel(90000, a, a), format!("it is a part of itself (#{a}>#{a})")),
        (rel(90000, a, b) + &rel(90001, b, a), format!("it is a part of itself (#{a}>#{b}>#{a})")),
    ] {
        let (drawing, report) = read_with(with_instances(&text, &added).as_bytes(), &ReadOptions::default());
        assert_eq!(drawing.unwrap().entities.len(), whole);
        assert!(report.is_degraded() && report.problems.iter().any(|p| p.text.contains(&said)), "{report:?}");
    }
    // A part of a part is shown with the whole.
    let added = rel(90000, a, b) + &rel(90001, b, named(&text, "screen-3"));
    let drawing = read(with_instances(&text, &added).as_bytes());
    let outlines = drawing.entities.iter().filter(|e| e.source.record == a).count();
    assert_eq!((outlines, drawing.entities.len()), (3, whole));
    // One that cannot be placed is named with its whole.
    let line = text.lines().find(|l| l.starts_with(&format!("#{b}="))).unwrap();
    let mut values: Vec<&str> = line.split(',').collect();
    let not_a_place = format!("#{a}");
    values[5] = &not_a_place;
    let broken = text.replace(line, &values.join(","));
    let (drawing, report) =
        read_with(with_instances(&broken, &rel(90000, a, b)).as_bytes(), &ReadOptions::default());
    assert_eq!(drawing.unwrap().entities.len(), whole - 1);
    let said = format!("its part #{b}: ");
    assert!(report.problems.iter().any(|p| p.text.starts_with(&said)), "{report:?}");
}

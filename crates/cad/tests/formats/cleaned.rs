//! What is demolished, taken out for good: what stands only for it goes too, everything else keeps its bytes.

#![allow(clippy::unwrap_used, reason = "a failing helper fails the test")]

use std::collections::BTreeSet;

use crate::dxf_patch::{ascii, binary, pairs, variants};
use crate::support::read_whole;
use enfilade_cad::drawing::{Addition, Edit, EntityWork, Mark};
use enfilade_cad::dxf::{patch, sheet, without_demolished};
use enfilade_cad::own_layers::DEMOLISHED;
use enfilade_cad::units::unit_by_name;
use enfilade_cad::{ReadOptions, read};
use enfilade_fixtures::sample;
use enfilade_report::Report;
use glam::DVec2;

/// A drawing in parts: as they are, and as they are to be.
const PARTS: [(&str, &str); 14] = [
    ("0|SECTION|2|HEADER|9|$ACADVER|1|AC1018|9|$HANDSEED|5|A0|0|ENDSEC|", "="),
    ("0|SECTION|2|TABLES|0|TABLE|2|LAYER|5|2|", "="),
    ("70|2|0|LAYER|5|11|2|0|70|0|", "70|1|0|LAYER|5|11|2|0|70|0|"),
    ("0|LAYER|5|12|2|EF-DEMOLISHED|70|0|62|2|", ""),
    ("0|ENDTAB|0|ENDSEC|0|SECTION|2|BLOCKS|0|BLOCK|5|20|8|0|2|W|70|0|", "="),
    ("0|LINE|5|21|8|EF-DEMOLISHED|10|0.0|20|0.0|11|1.0|21|0.0|", ""),
    ("0|ENDBLK|5|22|8|0|0|ENDSEC|0|SECTION|2|ENTITIES|", "="),
    (
        "0|LINE|5|31|102|{ACAD_REACTORS|330|32|102|}|8|WALL|10|0.0|20|0.0|11|1.0|21|0.0|",
        "0|LINE|5|31|8|WALL|10|0.0|20|0.0|11|1.0|21|0.0|",
    ),
    ("0|LWPOLYLINE|5|32|8|ef-demolished|90|2|70|0|10|0.0|20|1.0|10|1.0|20|1.0|", ""),
    (
        "0|HATCH|5|33|8|WALL|2|SOLID|70|1|71|1|91|1|92|3|97|1|330|32|75|0|76|1|98|0|1005|32|",
        "0|HATCH|5|33|8|WALL|2|SOLID|70|1|71|0|91|1|92|3|97|0|75|0|76|1|98|0|1005|0|",
    ),
    ("0|INSERT|5|34|8|EF-DEMOLISHED|66|1|2|W|10|0.0|20|0.0|0|ATTRIB|5|35|8|0|1|x|0|SEQEND|5|36|8|0|", ""),
    (
        "0|ENDSEC|0|SECTION|2|OBJECTS|0|DICTIONARY|5|40|3|all|350|41|3|some|350|42|",
        "0|ENDSEC|0|SECTION|2|OBJECTS|0|DICTIONARY|5|40|3|some|350|42|",
    ),
    (
        "0|GROUP|5|41|330|40|340|32|340|34|0|GROUP|5|42|330|40|340|31|340|32|0|SORTENTSTABLE|5|43|331|32|5|1|331|31|5|2|0|DICTIONARY|5|44|330|32|0|XRECORD|5|45|330|44|",
        "0|GROUP|5|42|330|40|340|31|0|SORTENTSTABLE|5|43|331|31|5|2|",
    ),
    ("0|ENDSEC|0|EOF|", "="),
];

#[test]
fn what_stands_only_for_what_is_demolished_goes_too() {
    let whole = |k: usize| -> String {
        let parts = PARTS.iter().map(|(old, new)| if k == 1 && *new != "=" { *new } else { *old });
        parts.collect::<String>().trim_end_matches('|').to_owned()
    };
    let [old, new] = [0, 1].map(|k| pairs(&whole(k)));
    for write in [|p: &_| ascii(p, "\n"), |p: &_| ascii(p, "\r\n"), |p: &_| binary(p, true)] {
        let (cleaned, count) = without_demolished("plan.dxf", &write(&old)).unwrap();
        assert_eq!(count, 3);
        assert_eq!(String::from_utf8_lossy(&cleaned), String::from_utf8_lossy(&write(&new)));
        assert_eq!(without_demolished("plan.dxf", &cleaned).unwrap(), (cleaned, 0));
    }
}

/// A layer that something else names stays: here the current one of the drawing.
#[test]
fn the_layer_stays_where_it_is_used() {
    let head = "0|SECTION|2|HEADER|9|$CLAYER|8|EF-DEMOLISHED|0|ENDSEC|0|SECTION|2|TABLES|0|TABLE|2|LAYER|70|1|0|LAYER|2|EF-DEMOLISHED|70|0|0|ENDTAB|0|ENDSEC|0|SECTION|2|ENTITIES|";
    let line = "0|LINE|8|EF-DEMOLISHED|10|0.0|20|0.0|11|1.0|21|0.0|";
    let [old, new] = [line, ""].map(|line| ascii(&pairs(&format!("{head}{line}0|ENDSEC|0|EOF")), "\n"));
    assert_eq!(without_demolished("plan.dxf", &old).unwrap(), (new, 1));
}

/// What was dropped, with its outline, in every version.
#[test]
fn what_is_dropped_goes_in_every_version() {
    for (name, bytes) in variants() {
        let (before, _) = read_whole(&name, &bytes);
        let arc = before.entities.iter().find(|e| e.source.kind == "ARC").unwrap().source.record;
        let drop = Edit::Work { record: arc, work: EntityWork::Drop };
        let points = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]].map(DVec2::from).to_vec();
        let mark = Mark::Path { points, closed: true };
        let outline = Addition { layer: DEMOLISHED.into(), rgb: [242, 181, 0], mark };
        let written = patch(&name, &bytes, &[drop], &[outline]).unwrap();
        let (cleaned, count) = without_demolished(&name, &written).unwrap();
        assert_eq!(count, 2, "{name}");
        let (after, report) = read_whole(&name, &cleaned);
        assert!(!report.is_degraded(), "{name}: {:?}", report.problems);
        let shapes = |of: &enfilade_cad::drawing::Drawing| -> Vec<String> {
            let others = of.entities.iter().filter(|e| e.source.kind != "ARC");
            others.map(|e| format!("{} {:?} {:?}", e.layer, e.source.handle, e.shape)).collect()
        };
        assert_eq!(shapes(&after), shapes(&before), "{name}");
        assert_eq!(after.entities.len() + 1, before.entities.len(), "{name}");
    }
}

/// A wall and a door go; every number that is left stands for something.
#[test]
fn an_element_goes_out_of_a_building() {
    let bytes = std::fs::read(sample("flat.ifc")).unwrap();
    let text = String::from_utf8(bytes.clone()).unwrap();
    let id = |name: &str| -> usize {
        let line = text.lines().find(|l| l.contains(&format!("'{name}'"))).unwrap();
        line[1..line.find('=').unwrap()].parse().unwrap()
    };
    let drop = |name: &str| Edit::Work { record: id(name), work: EntityWork::Drop };
    let options = ReadOptions::default();
    let edits = [drop("Wall-006"), drop("Door-09")];
    let written = enfilade_cad::patch("flat.ifc", &bytes, &options, &edits, &[]).unwrap();
    let (cleaned, count) = enfilade_cad::without_demolished("flat.ifc", &written).unwrap();
    assert_eq!(count, 2);
    let after = String::from_utf8(cleaned.clone()).unwrap();
    let numbers = |line: &str| -> Vec<u64> {
        let plain: String = line.split('\'').step_by(2).collect();
        let found = plain.split('#').skip(1);
        found.filter_map(|t| t.split(|c: char| !c.is_ascii_digit()).next()?.parse().ok()).collect()
    };
    let lines = || after.lines().filter(|l| l.starts_with('#'));
    let defined: BTreeSet<u64> = lines().map(|l| numbers(l)[0]).collect();
    assert!(lines().flat_map(numbers).all(|n| defined.contains(&n)));
    // The opening of the door is left; all else is as it was, but for shorter lists.
    for gone in ["'Wall-006'", "'Door-09'", "'DEMOLISH'"] {
        assert!(
            text.matches(gone).count() == usize::from(gone != "'DEMOLISH'") && !after.contains(gone),
            "{gone}"
        );
    }
    assert_eq!(text.matches("IFCOPENINGELEMENT(").count(), after.matches("IFCOPENINGELEMENT(").count());
    let is_list = |l: &str| l.contains("=IFCREL");
    assert!(lines().filter(|l| !is_list(l)).all(|l| text.contains(l)));
    assert_eq!(enfilade_cad::without_demolished("flat.ifc", &cleaned).unwrap(), (cleaned, 0));
    let read = |bytes: &[u8]| read("flat.ifc", bytes, &options, &mut Report::default()).unwrap();
    let layers = |bytes: &[u8]| read(bytes).entities.iter().filter(|e| e.layer != DEMOLISHED).count();
    assert_eq!(layers(&written), read(after.as_bytes()).entities.len());
}

#[test]
fn a_scene_keeps_all() {
    let bytes = std::fs::read(sample("flat.glb")).unwrap();
    assert_eq!(enfilade_cad::without_demolished("flat.glb", &bytes).unwrap(), (bytes, 0));
}

/// Notes of a drawing in one of their own lie where they lie in it, in its unit.
#[test]
fn notes_stand_in_a_drawing_of_their_own() {
    let corner = |x: f64, y: f64| DVec2::new(512_000.25 + x, 5_400_000.5 + y);
    let mark = Mark::Path { points: vec![corner(0.0, 0.0), corner(4.0, 3.0)], closed: false };
    let text = Mark::Text { at: corner(1.0, 1.0), height: 0.2, text: "one\ntwo".into() };
    let additions = [("WALL-NOTE", mark), ("EF-NOTE", text)].map(|(layer, mark)| Addition {
        layer: layer.into(),
        rgb: [1, 2, 3],
        mark,
    });
    for (name, code) in [("mm", "4"), ("m", "6"), ("ft", "2"), ("25m", "0")] {
        let bytes = sheet(unit_by_name(name).unwrap(), &additions).unwrap();
        let written = String::from_utf8(bytes.clone()).unwrap();
        assert!(written.contains(&format!("$INSUNITS\n70\n{code}\n")) && !written.contains('{'), "{name}");
        let (drawing, report) = read_whole("notes.dxf", &bytes);
        assert!(!report.is_degraded(), "{:?}", report.problems);
        let [line] = &drawing.entities[..] else { panic!("{:?}", drawing.entities) };
        assert_eq!(enfilade_cad::curve::control_points(&line.shape), [corner(0.0, 0.0), corner(4.0, 3.0)]);
        assert_eq!(written.matches("\nTEXT\n").count(), 2);
    }
}

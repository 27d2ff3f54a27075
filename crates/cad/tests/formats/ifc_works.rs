//! Works in a building: what is new has the type and the layers of what is like it, and nothing else of the file changes.

#![allow(clippy::unwrap_used, reason = "a failing helper fails the test")]

use enfilade_cad::drawing::{Edit, EntityWork, Filling, Shape, Vertex};
use enfilade_cad::{ReadOptions, patch, read, without_demolished};
use enfilade_fixtures::sample;
use enfilade_report::Report;
use glam::DVec2;

/// A partition of 100 mm of the flat, of type 367 and of the layers 373, along y; and one along x.
const PARTITION: usize = 366;
const ALONG_X: usize = 420;

fn flat() -> String {
    String::from_utf8(std::fs::read(sample("flat.ifc")).unwrap()).unwrap()
}

fn made(text: &str, edits: &[Edit]) -> String {
    let bytes = patch("flat.ifc", text.as_bytes(), &ReadOptions::default(), edits, &[]).unwrap();
    String::from_utf8(bytes).unwrap()
}

/// A wall between two points, so thick.
fn build(record: usize, [a, b]: [[f64; 2]; 2], thick: f64) -> Edit {
    let [a, b] = [a, b].map(DVec2::from);
    let off = (b - a).normalize().perp() * thick / 2.0;
    let vertices = [a - off, b - off, b + off, a + off].map(|at| Vertex { at, bulge: 0.0 }).to_vec();
    let work = EntityWork::Build { shapes: vec![Shape::Polyline { vertices, closed: true }] };
    Edit::Work { record, work }
}

/// A door in the partition along x.
fn door(width: f64) -> Edit {
    let [from, to] = [7000.0, 7000.0 + width];
    let gone = [[from, 6130.0], [to, 6130.0], [to, 6270.0], [from, 6270.0]].map(DVec2::from);
    Edit::Work { record: ALONG_X, work: EntityWork::Void { gone, filling: Filling::Door } }
}

/// Lines that were there and are not now, each with what stands in its place; and lines that are new.
fn changes(old: &str, new: &str) -> (Vec<(String, String)>, Vec<String>) {
    let number = |l: &str| l.split('=').next().unwrap_or_default().to_owned();
    let (mut changed, mut at) = (Vec::new(), new.lines());
    let mut added = Vec::new();
    for line in old.lines() {
        let next = at.by_ref().find(|n| {
            let is_same = number(n) == number(line);
            if !is_same {
                added.push((*n).to_owned());
            }
            is_same
        });
        let next = next.unwrap_or_else(|| panic!("{line} is gone"));
        if next != line {
            changed.push((line.to_owned(), next.to_owned()));
        }
    }
    (changed, added)
}

/// The number of the new instance of a class.
fn new_of(added: &[String], class: &str) -> String {
    let line = added.iter().find(|l| l.contains(&format!("={class}("))).unwrap();
    line.split('=').next().unwrap().to_owned()
}

fn has(added: &[String], class: &str, words: &str) -> bool {
    added.iter().any(|l| l.contains(&format!("={class}(")) && l.contains(words))
}

#[test]
fn a_new_wall_has_the_type_and_the_layers_of_its_like() {
    let old = flat();
    for (record, ends) in
        [(PARTITION, [[2000.0, 1000.0], [2000.0, 3000.0]]), (ALONG_X, [[9000.0, 1000.0], [7000.0, 1000.0]])]
    {
        let (changed, added) = changes(&old, &made(&old, &[build(record, ends, 100.0)]));
        let wall = new_of(&added, "IFCWALL");
        let [(was, is)] = changed.as_slice() else { panic!("{changed:?}") };
        assert_eq!(
            *is,
            was.replace("#514),#367", &format!("#514,{wall}),#367")),
            "the list of its type grows"
        );
        assert!(was.contains("IFCRELDEFINESBYTYPE"));
        assert!(has(&added, "IFCRELASSOCIATESMATERIAL", &format!("({wall}),#373")), "{added:#?}");
        assert!(has(&added, "IFCSHAPEREPRESENTATION", "'Axis','Curve2D'"));
        assert!(has(&added, "IFCPROPERTYENUMERATEDVALUE", "IFCLABEL('NEW')"));
    }
}

/// The reference line of a new wall runs as that of its like, its layers about it.
#[test]
fn the_layers_of_a_new_wall_lie_about_its_axis() {
    let old = flat().replace("#372,.AXIS2.,.POSITIVE.,-50.,$", "#372,.AXIS2.,.POSITIVE.,0.,$");
    // Drawn against the way that its like runs: its layers lie to the left of that, so its line on the right face.
    let new = made(&old, &[build(ALONG_X, [[9000.0, 1000.0], [7000.0, 1000.0]], 100.0)]);
    let (_, added) = changes(&old, &new);
    assert!(has(&added, "IFCCARTESIANPOINT", "((2000.,0.))"), "{added:#?}");
    assert!(has(&added, "IFCCARTESIANPOINT", "((2000.,100.))"), "{added:#?}");
    let drawing = read("flat.ifc", new.as_bytes(), &ReadOptions::default(), &mut Report::default()).unwrap();
    let corner = |at: [f64; 2]| {
        let points = drawing.entities.iter().flat_map(|e| match &e.shape {
            Shape::Polyline { vertices, .. } => vertices.iter().map(|v| v.at).collect(),
            _ => Vec::new(),
        });
        points.into_iter().any(|p| p.distance(DVec2::from(at)) < 1e-6)
    };
    assert!(corner([7000.0, 950.0]) && corner([9000.0, 1050.0]), "it stands where it was said");
}

#[test]
fn a_wall_of_another_thickness_has_no_type_and_no_layers() {
    let old = flat();
    let (changed, added) =
        changes(&old, &made(&old, &[build(PARTITION, [[2000.0, 1000.0], [2000.0, 3000.0]], 150.0)]));
    assert!(changed.is_empty(), "{changed:?}");
    assert!(added.iter().all(|l| !l.contains("IFCRELASSOCIATESMATERIAL")));
}

/// On the CAD layer of its like, whether that names the shown body or its item.
#[test]
fn a_new_wall_is_on_the_cad_layer_of_its_like() {
    for (named, class) in [("#364", "IFCSHAPEREPRESENTATION"), ("#363", "IFCEXTRUDEDAREASOLID")] {
        let layer =
            format!("#9000=IFCPRESENTATIONLAYERASSIGNMENT('A-WALL',$,({named}),'id');\nENDSEC;\nEND-ISO");
        let old = flat().replace("ENDSEC;\nEND-ISO", &layer);
        assert!(old.contains("#9000="));
        let (_, added) =
            changes(&old, &made(&old, &[build(PARTITION, [[2000.0, 1000.0], [2000.0, 3000.0]], 100.0)]));
        let body = added.iter().filter(|l| l.contains(&format!("={class}("))).find(|l| !l.contains("'Axis'"));
        let body = body.unwrap().split('=').next().unwrap();
        assert!(
            has(&added, "IFCPRESENTATIONLAYERASSIGNMENT", &format!("('A-WALL',$,({body}),'id')")),
            "{added:#?}"
        );
    }
}

/// One type, several new elements, a wall and doors among them: each list grows once.
#[test]
fn a_new_door_has_the_type_of_a_door_as_wide() {
    let old = flat();
    let (changed, added) = changes(&old, &made(&old, &[door(885.0)]));
    let leaf = new_of(&added, "IFCDOOR");
    let [(_, is)] = changed.as_slice() else { panic!("{changed:?}") };
    assert!(is.contains("IFCRELDEFINESBYTYPE") && is.contains(&format!(",{leaf}),#")), "{is}");
    let (changed, added) = changes(&old, &made(&old, &[door(950.0)]));
    assert!(changed.is_empty() && has(&added, "IFCDOOR", ",.DOOR.,.NOTDEFINED.,$"), "no door is as wide");
    let two = [
        build(PARTITION, [[2000.0, 1000.0], [2000.0, 3000.0]], 100.0),
        build(ALONG_X, [[7000.0, 1000.0], [9000.0, 1000.0]], 100.0),
    ];
    let (changed, _) = changes(&old, &made(&old, &two));
    assert_eq!(changed.len(), 1);
    assert_eq!(changed[0].1.matches('#').count(), changed[0].0.matches('#').count() + 2);
}

/// What was built, demolished and taken out leaves the list of its type as it was.
#[test]
fn what_was_built_and_goes_leaves_nothing() {
    let old = flat();
    let new = made(&old, &[build(PARTITION, [[2000.0, 1000.0], [2000.0, 3000.0]], 100.0)]);
    let wall = new_of(&changes(&old, &new).1, "IFCWALL");
    let record = wall[1..].parse().unwrap();
    let gone = made(&new, &[Edit::Work { record, work: EntityWork::Drop }]);
    let (cleaned, count) = without_demolished("flat.ifc", gone.as_bytes()).unwrap();
    assert_eq!(count, 1);
    let cleaned = String::from_utf8(cleaned).unwrap();
    assert_eq!(changes(&old, &cleaned).0, Vec::new());
}

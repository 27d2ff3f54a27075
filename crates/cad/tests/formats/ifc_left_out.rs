//! What a building says of itself that is not in the plan: what is temporary, ground in the open air.

#![allow(clippy::unwrap_used, reason = "a failing helper fails the test")]

use enfilade_cad::drawing::Drawing;
use enfilade_cad::{ReadOptions, read, without_demolished};
use enfilade_fixtures::sample;
use enfilade_report::{Report, Severity};

/// A partition of the flat, and a wall along x with a door in it.
const PARTITION: usize = 366;
const ALONG_X: usize = 420;

fn flat() -> String {
    String::from_utf8(std::fs::read(sample("flat.ifc")).unwrap()).unwrap()
}

/// The flat with a `Status` of some walls.
fn with_status(status: &str, walls: &str) -> String {
    let more = format!(
        "#990001=IFCPROPERTYENUMERATEDVALUE('Status',$,(IFCLABEL('{status}')),$);\n\
         #990002=IFCPROPERTYSET('0aaaaaaaaaaaaaaaaaaaaa',$,'Pset_WallCommon',$,(#990001));\n\
         #990003=IFCRELDEFINESBYPROPERTIES('1aaaaaaaaaaaaaaaaaaaaa',$,$,$,({walls}),#990002);\n"
    );
    let text = flat();
    let at = text.rfind("ENDSEC;").unwrap();
    format!("{}{more}{}", &text[..at], &text[at..])
}

/// The drawing, and what is said under a code.
fn said(text: &str, code: &str) -> (Drawing, Vec<(Severity, String)>) {
    let mut report = Report::default();
    let drawing = read("flat.ifc", text.as_bytes(), &ReadOptions::default(), &mut report).unwrap();
    let own = report.problems.into_iter().filter(|p| p.code == code);
    (drawing, own.map(|p| (p.severity, p.text)).collect())
}

#[test]
fn what_is_temporary_is_left_out_and_listed() {
    let code = "ifc-temporary";
    let of = |drawing: &Drawing, record: usize| drawing.entities.iter().any(|e| e.source.record == record);
    let (drawing, told) = said(&with_status("EXISTING", "#366"), code);
    assert!(of(&drawing, PARTITION) && told.is_empty(), "{told:?}");
    let doors = |drawing: &Drawing| drawing.entities.iter().filter(|e| e.layer == "IfcDoor").count();
    let all = doors(&drawing);
    let text = with_status("TEMPORARY", "#366,#420");
    let (drawing, told) = said(&text, code);
    assert!(!of(&drawing, PARTITION) && !of(&drawing, ALONG_X));
    assert!(doors(&drawing) < all, "the door of a temporary wall goes with it");
    let list = "2 elements with the Status TEMPORARY left out: #366 \"Wall-006\", #420 \"Wall-009\"; another Status takes them in";
    assert_eq!(told, [(Severity::Info, list.to_string())]);
    // Nothing was demolished, so that cleaning leaves it in the file.
    assert_eq!(without_demolished("flat.ifc", text.as_bytes()).unwrap().1, 0);
}

#[test]
fn a_space_in_the_open_air_is_named() {
    let text = flat();
    let external = text.replacen("'Hall',.ELEMENT.,.INTERNAL.", "'Hall',.ELEMENT.,.EXTERNAL.", 1);
    assert_ne!(text, external);
    let code = "ifc-outdoors";
    assert_eq!(said(&text, code).1, []);
    let words = "space \"01 Hall\" is EXTERNAL, in the open air; the ground on it is not measured; --inside X,Y takes it in";
    assert_eq!(said(&external, code).1, [(Severity::Info, words.to_string())]);
}

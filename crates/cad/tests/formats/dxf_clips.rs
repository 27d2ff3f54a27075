//! Clipped INSERTs (XCLIP): what they show, and that nothing of them is edited by itself.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a failing helper fails the test")]

use std::fmt::Write as _;

use crate::support::read_whole;
use enfilade_cad::curve::control_points;
use enfilade_cad::drawing::{Drawing, Editable};
use enfilade_cad::dxf::patch;

/// One of each kind: a line, a closed polyline, an arc, a filled area and a text.
const ROOM: &str = "0|LINE|5|A0|8|WALL|10|0|20|0|11|10|21|0\
    |0|LWPOLYLINE|5|A1|8|WALL|90|4|70|1|10|0|20|1|10|10|20|1|10|10|20|2|10|0|20|2\
    |0|ARC|5|A2|8|DOOR|10|5|20|5|40|2|50|0|51|180\
    |0|SOLID|5|A3|8|FILL|10|0|20|3|11|10|21|3|12|0|22|4|13|10|23|4\
    |0|TEXT|5|A4|8|NOTE|10|9|20|9|40|1|1|east";

fn lines(text: &str) -> String {
    text.split('|').map(|line| format!("{line}\n")).collect()
}

/// A filter whose matrices map with these rows of x and y: the block from the world, the boundary from the world.
fn filter(points: &[[f64; 2]], switch: &str, rows: [[f64; 6]; 2]) -> String {
    let mut out =
        format!("0|SPATIAL_FILTER|5|E4|330|E3|100|AcDbFilter|100|AcDbSpatialFilter|70|{}", points.len());
    for [x, y] in points {
        let _ = write!(out, "|10|{x}|20|{y}");
    }
    let _ = write!(out, "|210|0|220|0|230|1|11|0|21|0|31|0|71|{switch}");
    for [a, b, c, d, e, f] in rows {
        let _ = write!(out, "|40|{a}|40|{b}|40|0|40|{c}|40|{d}|40|{e}|40|0|40|{f}|40|0|40|0|40|1|40|0");
    }
    out
}

const SAME: [f64; 6] = [1.0, 0.0, 0.0, 0.0, 1.0, 0.0];

/// A file with one INSERT of [`ROOM`] at `placed`, clipped by a filter and what else stands among the objects.
fn clipped(placed: &str, filter: &str, others: &str) -> Vec<u8> {
    let dictionary = |handle: &str, name: &str, value: &str| {
        format!("0|DICTIONARY|5|{handle}|330|0|100|AcDbDictionary|281|1|3|{name}|360|{value}")
    };
    let text = format!(
        "0|SECTION|2|HEADER|9|$ACADVER|1|AC1024|0|ENDSEC|0|SECTION|2|BLOCKS|0|BLOCK|8|0|2|R|70|0|10|0|20|0|{ROOM}|0|ENDBLK\
         |0|ENDSEC|0|SECTION|2|ENTITIES|0|INSERT|5|F0|102|{{ACAD_XDICTIONARY|360|0E2|102|}}|8|W|2|R|{placed}|0|ENDSEC\
         |0|SECTION|2|OBJECTS|{}|{}|{filter}{others}|0|ENDSEC|0|EOF",
        dictionary("E2", "ACAD_FILTER", "E3"),
        dictionary("E3", "SPATIAL", "E4")
    );
    lines(&text).into_bytes()
}

/// Handle, lowest and highest x and y of all that is drawn.
fn drawn(drawing: &Drawing) -> Vec<(String, [f64; 4])> {
    let all = drawing.entities.iter().chain(&drawing.fills);
    let of = |e: &enfilade_cad::drawing::Entity| {
        let points = control_points(&e.shape);
        let pick = |f: fn(f64, f64) -> f64, axis: usize| {
            let value = points.iter().map(|p| p[axis]).reduce(f).unwrap();
            (value * 1e6).round() / 1e6 + 0.0
        };
        let extent = [pick(f64::min, 0), pick(f64::min, 1), pick(f64::max, 0), pick(f64::max, 1)];
        (e.origin.handle.clone().unwrap(), extent)
    };
    all.map(of).collect()
}

fn read(bytes: &[u8]) -> (Drawing, Vec<String>) {
    let (drawing, report) = read_whole("t.dxf", bytes);
    let said = report.problems.iter().filter(|p| p.code.starts_with("dxf-clip"));
    (drawing, said.map(|p| format!("{}: {}", p.code, p.text)).collect())
}

fn said(left_out: usize) -> Vec<String> {
    vec![format!(
        "dxf-clipped: block R is clipped (XCLIP): {left_out} of its 5 entities lie outside the boundary; left out of the plan, kept in \
         the file"
    )]
}

#[test]
fn what_lies_outside_is_not_shown_and_what_crosses_is_cut() {
    let west = [[-1.0, -1.0], [5.0, 10.0]];
    let (drawing, notes) = read(&clipped("10|0|20|0", &filter(&west, "1", [SAME, SAME]), ""));
    let parts = [
        ("A0", [0.0, 0.0, 5.0, 0.0]),
        ("A1", [0.0, 1.0, 5.0, 2.0]),
        ("A2", [3.0, 5.0, 5.0, 7.0]),
        ("A3", [0.0, 3.0, 5.0, 4.0]),
    ];
    assert_eq!(drawn(&drawing), parts.map(|(handle, extent)| (handle.to_owned(), extent)));
    assert_eq!((drawing.texts.len(), notes), (0, said(1)));
    let held = Editable::No("its block is clipped (XCLIP)".into());
    assert!(drawing.entities.iter().all(|e| e.editable == held), "{:?}", drawing.entities);
}

/// The same boundary in other words: a polygon, one in coordinates of the world with the INSERT where it stood, one whose own
/// axes are turned, and an INSERT that moved afterwards.
#[test]
fn a_boundary_is_taken_in_its_own_coordinates() {
    let placed = "10|100|20|50|50|90";
    // Where the INSERT was: x and y of the block from those of the world.
    let block_from_world = [0.0, 1.0, -50.0, -1.0, 0.0, 100.0];
    let clip_from_world = [0.0, 1.0, 7.0, -1.0, 0.0, 3.0];
    // Block x −1 … 5, y −1 … 10 in the world: x 90 … 101, y 49 … 55.
    let in_world = [[90.0, 49.0], [101.0, 55.0]];
    let of_clip = in_world.map(|[x, y]: [f64; 2]| [y + 7.0, 3.0 - x]);
    let moved = "10|200|20|50|50|90";
    let polygon = [[-1.0, -1.0], [5.0, -1.0], [5.0, 10.0], [-1.0, 10.0]];
    let cases = [
        (placed, filter(&polygon, "1", [SAME, SAME]), 0.0),
        (placed, filter(&in_world, "1", [block_from_world, SAME]), 0.0),
        (placed, filter(&of_clip, "1", [block_from_world, clip_from_world]), 0.0),
        (moved, filter(&in_world, "1", [block_from_world, SAME]), 100.0),
    ];
    for (placed, filter, shift) in cases {
        let (drawing, notes) = read(&clipped(placed, &filter, ""));
        let parts = [
            ("A0", [100.0 + shift, 50.0, 100.0 + shift, 55.0]),
            ("A1", [98.0 + shift, 50.0, 99.0 + shift, 55.0]),
            ("A2", [93.0 + shift, 53.0, 95.0 + shift, 55.0]),
            ("A3", [96.0 + shift, 50.0, 97.0 + shift, 55.0]),
        ];
        assert_eq!(drawn(&drawing), parts.map(|(handle, extent)| (handle.to_owned(), extent)), "{filter}");
        assert_eq!((drawing.texts.len(), notes), (0, said(1)), "{filter}");
    }
}

/// An inverted clip shows what lies outside: of the inner boundary that newer programs state.
#[test]
fn an_inverted_clip_shows_the_rest() {
    let west = [[-1.0, -1.0], [5.0, 10.0]];
    let inverted = "|0|DICTIONARY|5|E5|330|E4|3|ACAD_XREC_ROUNDTRIP|360|E6\
        |0|XRECORD|5|E6|280|1|102|ACAD_INVERTEDCLIP_ROUNDTRIP|10|-1|20|-1|30|0|10|5|20|10|30|0\
        |102|ACAD_INVERTEDCLIP_ROUNDTRIP_COMPARE|10|-9|20|-9|30|0";
    let own = filter(&[[-100.0, -100.0], [100.0, 100.0]], "1", [SAME, SAME]);
    for own in [filter(&west, "1", [SAME, SAME]), own] {
        let own = own.replacen("|330|E3", "|102|{ACAD_XDICTIONARY|360|E5|102|}|330|E3", 1);
        let (drawing, notes) = read(&clipped("10|0|20|0", &own, inverted));
        let parts = [
            ("A0", [5.0, 0.0, 10.0, 0.0]),
            ("A1", [5.0, 1.0, 10.0, 2.0]),
            ("A2", [5.0, 5.0, 7.0, 7.0]),
            ("A3", [5.0, 3.0, 10.0, 4.0]),
        ];
        assert_eq!(drawn(&drawing), parts.map(|(handle, extent)| (handle.to_owned(), extent)));
        assert_eq!((drawing.texts.len(), notes), (1, said(0)));
    }
}

/// Nothing is clipped where the clip is off, nor where it cannot be read; that is said. A clip round everything cuts nothing.
#[test]
fn without_a_boundary_all_is_shown() {
    let west = [[-1.0, -1.0], [5.0, 10.0]];
    let flat = [0.0; 6];
    let why = |why: &str| {
        vec![format!(
            "dxf-clip: its clip (XCLIP), found a boundary that cannot be read: {why}; all of the block is shown"
        )]
    };
    let round = [[-1.0, -1.0], [11.0, 11.0]];
    let whole = filter(&west, "1", [SAME, SAME]);
    for (filter, expected) in [
        (filter(&west, "0", [SAME, SAME]), Vec::new()),
        (filter(&west[..1], "1", [SAME, SAME]), why("it encloses nothing")),
        (filter(&[[1.0, 1.0], [1.0, 5.0]], "1", [SAME, SAME]), why("it encloses nothing")),
        (filter(&west, "1", [SAME, flat]), why("its matrices do not lie in the plane of the plan")),
        (whole.replacen("|40|1", "|41|1", 1), why("its two matrices are not there")),
        (whole.replacen("|20|-1", "|21|-1", 1), why("a point of it is no pair of numbers")),
        (filter(&round, "1", [SAME, SAME]), said(0)),
    ] {
        let (drawing, notes) = read(&clipped("10|0|20|0", &filter, ""));
        let whole = [
            ("A0", [0.0, 0.0, 10.0, 0.0]),
            ("A1", [0.0, 1.0, 10.0, 2.0]),
            ("A2", [3.0, 5.0, 7.0, 5.0]),
            ("A3", [0.0, 3.0, 10.0, 4.0]),
        ];
        assert_eq!(drawn(&drawing), whole.map(|(handle, extent)| (handle.to_owned(), extent)), "{filter}");
        assert_eq!((drawing.texts.len(), notes), (1, expected), "{filter}");
        // Where a clip is on, nothing is edited by itself.
        let is_off = filter.contains("|71|0|");
        assert!(drawing.entities.iter().all(|e| (e.insert().is_none()) == is_off), "{filter}");
    }
}

#[test]
fn a_clipped_file_keeps_its_bytes() {
    let bytes = clipped("10|0|20|0", &filter(&[[-1.0, -1.0], [5.0, 10.0]], "1", [SAME, SAME]), "");
    assert_eq!(patch("t.dxf", &bytes, &[], &[]).unwrap(), bytes);
}

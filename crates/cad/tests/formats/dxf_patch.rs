//! Writing back: what an edit may touch, what an addition brings, in every version and in binary too.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a failing helper fails the test")]

use std::collections::HashSet;

use crate::support::{additions_for, edits_of, moved_shape, read_whole};
use enfilade_cad::drawing::{Addition, Drawing, Edit, Editable, Entity, Mark, RigidMotion, Shape, Vertex};
use enfilade_cad::dxf::{Completeness, Tied, changed_records, host_ids, is_complete, patch, strip_own, tied};
use enfilade_cad::own_layers::is_result;
use glam::DVec2;
use proptest::prelude::*;

/// Pairs as ASCII lines: code, value.
pub(crate) type Pairs = Vec<(i32, String)>;

pub(crate) fn pairs(text: &str) -> Pairs {
    let lines: Vec<&str> = text.split('|').collect();
    lines.chunks(2).map(|pair| (pair[0].parse().unwrap(), pair[1].to_owned())).collect()
}

pub(crate) fn ascii(pairs: &Pairs, line_end: &str) -> Vec<u8> {
    pairs
        .iter()
        .map(|(code, value)| format!("{code:>3}{line_end}{value}{line_end}"))
        .collect::<String>()
        .into_bytes()
}

pub(crate) fn binary(pairs: &Pairs, wide: bool) -> Vec<u8> {
    let mut out = b"AutoCAD Binary DXF\r\n\x1a\0".to_vec();
    for (code, value) in pairs {
        match (wide, *code) {
            (true, code) => out.extend((code as u16).to_le_bytes()),
            (false, code) if code < 255 => out.push(code as u8),
            (false, code) => out.extend([255, code as u8, (code >> 8) as u8]),
        }
        match code {
            10..=59 | 210..=239 => out.extend(value.parse::<f64>().unwrap().to_le_bytes()),
            60..=79 | 370..=389 | 1060..=1070 => out.extend(value.parse::<i16>().unwrap().to_le_bytes()),
            90..=99 | 420..=429 | 1071 => out.extend(value.parse::<i32>().unwrap().to_le_bytes()),
            _ => out.extend([value.as_bytes(), b"\0"].concat()),
        }
    }
    out
}

const ENTITIES: &str = "0|LINE|5|A0|8|WALL|10|1.5|20|-2.0|30|0.0|11|4.25|21|0.1|31|0.0|1001|REVIT|1070|1|1071|8\
    |0|LWPOLYLINE|5|A1|8|WALL|90|3|70|1|38|2.5|10|0.0|20|0.0|42|0.5|10|3.0|20|0.0|10|3.0|20|2.0|42|-1.0\
    |0|LWPOLYLINE|5|A2|8|WALL|90|2|70|0|10|7.0|20|1.0|42|0.25|10|9.0|20|1.0|210|0.0|220|0.0|230|-1.0\
    |0|POLYLINE|5|A3|8|WALL|66|1|10|0.0|20|0.0|30|0.0|70|0|0|VERTEX|5|A4|8|WALL|10|5.0|20|5.0|42|0.3\
    |0|VERTEX|5|A5|8|WALL|10|6.0|20|5.0|0|SEQEND|5|A6|8|WALL\
    |0|ARC|5|A7|8|DOOR|10|2.0|20|8.0|40|0.9|50|350.0|51|80.0\
    |0|ARC|5|A8|8|DOOR|10|2.0|20|8.0|40|0.9|50|350.0|51|80.0|210|0.0|220|0.0|230|-1.0\
    |0|CIRCLE|5|A9|8|COLUMN|10|12.0|20|3.0|40|0.2\
    |0|INSERT|5|AA|8|DOOR|66|1|2|B|10|3.0|20|4.0|41|-1.0|42|1.0|50|30.0\
    |0|ATTRIB|5|AB|8|DOOR|10|3.1|20|4.1|40|0.2|1|T1|2|NO|50|30.0|72|1|11|3.2|21|4.1|0|SEQEND|5|AC|8|DOOR\
    |0|ELLIPSE|5|AE|8|WALL|10|1.0|20|9.0|30|0.0|11|2.0|21|0.5|31|0.0|40|0.5|41|0.0|42|6.283185307179586\
    |0|SPLINE|5|AF|8|WALL|70|8|71|2|40|0.0|40|0.0|40|0.0|40|1.0|40|1.0|40|1.0|12|1.0|22|0.0|32|0.0|10|0.0|20|0.0|10|2.0|20|4.0|10|5.0|20|0.0\
    |0|POLYLINE|5|B0|8|WALL|66|1|10|0.0|20|0.0|30|0.0|70|2|0|VERTEX|5|B1|8|WALL|10|5.0|20|5.0|42|0.3|70|2|50|45.0\
    |0|VERTEX|5|B2|8|WALL|10|6.0|20|5.0|70|1|50|0.0|0|SEQEND|5|B3|8|WALL\
    |0|INSERT|5|AD|8|DOOR|2|B|10|5.0|20|4.0|50|0.0|210|0.0|220|0.0|230|-1.0";

/// A drawing of this version, with or without handles and a layer table.
fn drawing(version: &str, has_handles: bool, has_layers: bool) -> Pairs {
    let mut text = format!("0|SECTION|2|HEADER|9|$ACADVER|1|{version}|9|$INSUNITS|70|6");
    if has_handles {
        text += "|9|$HANDSEED|5|80";
    }
    text += "|0|ENDSEC";
    if has_layers {
        text += "|0|SECTION|2|TABLES|0|TABLE|2|LAYER|5|2|70|1|0|LAYER|5|10|2|0|70|0|62|7|6|Continuous|370|-3|390|F|0|ENDTAB|0|ENDSEC";
    }
    text += "|0|SECTION|2|BLOCKS|0|BLOCK|5|11|8|0|2|B|70|0|10|0.5|20|0.0|0|LINE|5|12|8|0|10|0.0|20|0.0|11|1.0|21|0.0|0|ENDBLK|5|13|8|0|0|ENDSEC";
    let text = format!("{text}|0|SECTION|2|ENTITIES|{ENTITIES}|0|ENDSEC|0|EOF");
    let is_handle = |(code, value): &(i32, String)| matches!(code, 5 | 390) && !value.starts_with('$');
    pairs(&text).into_iter().filter(|pair| has_handles || !is_handle(pair)).collect()
}

fn rigid() -> impl Strategy<Value = RigidMotion> {
    let values = (-3.0f64..3.0, -50.0f64..50.0, -50.0f64..50.0, 0..3);
    values.prop_map(|(turn, x, y, kind)| RigidMotion {
        turn_rad: if kind == 0 { 0.0 } else { turn },
        shift: if kind == 1 { DVec2::ZERO } else { DVec2::new(x, y) },
    })
}

/// The drawings every writing test goes through.
pub(crate) fn variants() -> Vec<(String, Vec<u8>)> {
    let mut out = Vec::new();
    for version in ["AC1006", "AC1009", "AC1012", "AC1014", "AC1015", "AC1018", "AC1021", "AC1032"] {
        for (has_handles, has_layers) in [(true, true), (true, false), (false, true), (false, false)] {
            let pairs = drawing(version, has_handles, has_layers);
            let name = format!("{version} handles {has_handles} layers {has_layers}");
            out.push((format!("{name} LF"), ascii(&pairs, "\n")));
            out.push((format!("{name} CRLF"), ascii(&pairs, "\r\n")));
            out.push((format!("{name} binary"), binary(&pairs, version >= "AC1012")));
        }
    }
    out
}

pub(crate) fn distance(a: &Shape, b: &Shape) -> f64 {
    let angle = |x: f64, y: f64| ((x - y) / 2.0).sin().abs();
    match (a, b) {
        (Shape::Line { a, b }, Shape::Line { a: c, b: d }) => a.distance(*c).max(b.distance(*d)),
        (Shape::Circle { centre: a, radius: r }, Shape::Circle { centre: b, radius: s }) => {
            a.distance(*b).max((r - s).abs())
        }
        (
            Shape::Arc { centre: a, radius: r, start_rad: f, end_rad: t },
            Shape::Arc { centre: b, radius: s, start_rad: g, end_rad: u },
        ) => a.distance(*b).max((r - s).abs()).max(angle(*f, *g)).max(angle(*t, *u)),
        (Shape::Polyline { vertices: v, closed: c }, Shape::Polyline { vertices: w, closed: d }) => {
            assert_eq!((c, v.len()), (d, w.len()));
            let apart = |(v, w): (&Vertex, &Vertex)| v.at.distance(w.at).max((v.bulge - w.bulge).abs());
            v.iter().zip(w).map(apart).fold(0.0, f64::max)
        }
        _ => f64::INFINITY,
    }
}

/// What a drawing must look like after the edits of `chosen` records.
fn assert_moved(
    before: &Drawing,
    after: &Drawing,
    chosen: &HashSet<usize>,
    motion: &RigidMotion,
    name: &str,
) {
    assert_eq!(before.entities.len(), after.entities.len(), "{name}");
    for (b, a) in before.entities.iter().zip(&after.entities) {
        assert_eq!((&b.source, &b.layer, &b.editable), (&a.source, &a.layer, &a.editable), "{name}");
        let (expected, allowed) = if chosen.contains(&b.source.record) {
            (moved_shape(&b.shape, motion), 1e-9)
        } else {
            (b.shape.clone(), 0.0)
        };
        let off = distance(&expected, &a.shape);
        assert!(off <= allowed, "{name}: {:?} {off} {expected:?} {:?}", b.source, a.shape);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    /// Law 1: an edit changes its own geometry values and no other byte, and reads back as asked.
    #[test]
    fn edits_change_what_they_name(motion in rigid(), step in 1usize..4) {
        for (name, bytes) in variants() {
            let (before, _) = read_whole(&name, &bytes);
            let edits = edits_of(&before, step, motion);
            let patched = patch(&name, &bytes, &edits, &[]).unwrap();
            let (after, _) = read_whole(&name, &patched);
            let chosen: HashSet<usize> = edits.iter().map(Edit::record).collect();
            assert_moved(&before, &after, &chosen, &motion, &name);
            let changed: HashSet<usize> =
                changed_records(&name, &bytes, &edits).unwrap().into_iter().flatten().map(|c| c.record).collect();
            if name.ends_with("binary") {
                prop_assert_eq!(patched.len(), bytes.len());
                continue;
            }
            let (old, new) = (String::from_utf8(bytes).unwrap(), String::from_utf8(patched).unwrap());
            let (old, new): (Vec<&str>, Vec<&str>) = (old.split('\n').collect(), new.split('\n').collect());
            prop_assert_eq!(old.len(), new.len());
            let mut record = 0;
            for (i, (o, n)) in old.iter().zip(&new).enumerate() {
                let code: i32 = old[i - i % 2].trim().parse().unwrap_or(0);
                record += usize::from(i % 2 == 0 && code == 0 && i > 0);
                let may_change = i % 2 == 1 && matches!(code, 10..=18 | 20..=28 | 42 | 50 | 51) && changed.contains(&record);
                prop_assert!(o == n || may_change, "{} line {}: {} became {}", name, i + 1, o, n);
            }
        }
    }
}

/// The attribute of a block goes with its INSERT, and is named among the changed records.
#[test]
fn attributes_follow_their_insert() {
    let bytes = ascii(&drawing("AC1015", true, true), "\n");
    let (before, _) = read_whole("plan.dxf", &bytes);
    let insert = before.entities.iter().find(|e| e.source.handle.as_deref() == Some("AA")).unwrap();
    let motion = RigidMotion { turn_rad: 0.0, shift: DVec2::new(1.0, 0.0) };
    let edit = Edit::Insert { record: insert.source.record, motion };
    let handles: Vec<Vec<Option<String>>> = changed_records("plan.dxf", &bytes, std::slice::from_ref(&edit))
        .unwrap()
        .into_iter()
        .map(|records| records.into_iter().map(|r| r.handle).collect())
        .collect();
    assert_eq!(handles, [[Some("AA".to_owned()), Some("AB".to_owned())]]);
    let patched = String::from_utf8(patch("plan.dxf", &bytes, &[edit], &[]).unwrap()).unwrap();
    let expected = String::from_utf8(bytes)
        .unwrap()
        .replace("\n3.0\n 20\n4.0", "\n4.0\n 20\n4.0")
        .replace("\n3.1\n", "\n4.1\n")
        .replace("\n3.2\n", "\n4.2\n");
    assert_eq!(patched, expected);
}

/// A plane that lies flat but for rounding moves nothing by its height, and the least numbers stay as they are.
#[test]
fn what_lies_flat_is_written_back_as_it_was() {
    let planes =
        [("0.0", "1e-76", "-1.0"), ("1e-7", "0.0", "1.0"), ("0.0", "-1e-7", "-0.5"), ("1e-320", "0", "2")];
    for (x, y, z) in planes {
        for height in ["3.0", "1e6", "-2500"] {
            for at in ["0.0", "1e-320", "4.9e-324", "-3e-300", "7.25"] {
                let plane = format!("210|{x}|220|{y}|230|{z}");
                let text = format!(
                    "0|SECTION|2|ENTITIES|0|LWPOLYLINE|8|WALL|90|2|38|{height}|10|{at}|20|{at}|10|{at}|20|0.0|{plane}\
                     |0|CIRCLE|8|WALL|10|{at}|20|{at}|30|{height}|40|0.5|{plane}|0|ENDSEC|0|EOF"
                );
                for bytes in [ascii(&pairs(&text), "\n"), binary(&pairs(&text), false)] {
                    let (drawing, _) = read_whole("plan.dxf", &bytes);
                    let is_free = |e: &&Entity| e.editable == Editable::Free;
                    let edits: Vec<Edit> = drawing.entities.iter().filter(is_free).map(unmoved).collect();
                    assert_eq!(edits.len(), 2);
                    let back = patch("plan.dxf", &bytes, &edits, &[]).unwrap();
                    assert!(back == bytes, "{plane} at height {height}, {at}");
                }
            }
        }
    }
}

fn unmoved(entity: &Entity) -> Edit {
    Edit::Shape { record: entity.source.record, shape: entity.shape.clone() }
}

#[test]
fn edits_that_do_not_fit_are_refused() {
    let bytes = ascii(&drawing("AC1015", true, true), "\n");
    let (before, _) = read_whole("plan.dxf", &bytes);
    let record = |handle: &str| {
        before.entities.iter().find(|e| e.source.handle.as_deref() == Some(handle)).unwrap().source.record
    };
    let line = Shape::Line { a: DVec2::ZERO, b: DVec2::X };
    let vertex = |x: f64, bulge: f64| Vertex { at: DVec2::new(x, 0.0), bulge };
    let polyline = |vertices: Vec<Vertex>| Shape::Polyline { vertices, closed: true };
    let turn = RigidMotion { turn_rad: 0.5, shift: DVec2::ZERO };
    let nothing = "nothing was written";
    let cases = vec![
        (
            vec![Edit::Shape { record: record("A9"), shape: line.clone() }],
            format!("CIRCLE A9: the edit of record 22: its kind and the new shape differ; {nothing}"),
        ),
        (
            vec![Edit::Shape { record: record("A1"), shape: polyline(vec![vertex(0.0, 0.0)]) }],
            format!("LWPOLYLINE A1: the edit of record 14: the number of vertices differs; {nothing}"),
        ),
        (
            vec![Edit::Shape {
                record: record("A1"),
                shape: polyline(vec![vertex(0.0, 0.5), vertex(1.0, 2.0), vertex(2.0, -1.0)]),
            }],
            format!(
                "LWPOLYLINE A1: the edit of record 14: a straight piece has no bulge to change; {nothing}"
            ),
        ),
        (
            vec![Edit::Shape { record: record("A0"), shape: Shape::Line { a: DVec2::NAN, b: DVec2::X } }],
            format!("LINE A0: the edit of record 13: the new coordinates are not finite; {nothing}"),
        ),
        (
            vec![Edit::Insert { record: record("A0"), motion: turn }],
            format!("LINE A0: the edit of record 13: it is nothing that moves as a whole; {nothing}"),
        ),
        (
            vec![Edit::Shape { record: 3, shape: line.clone() }],
            "no entity of model space stands there".into(),
        ),
        (
            vec![Edit::Shape { record: 3000, shape: line.clone() }],
            format!("plan.dxf: the edit of record 3000: no entity of model space stands there; {nothing}"),
        ),
        (
            vec![Edit::Shape { record: record("A0"), shape: line.clone() }; 2],
            format!("plan.dxf: two edits of one value, expected one edit an entity; {nothing}"),
        ),
    ];
    for (edits, expected) in cases {
        let error = patch("plan.dxf", &bytes, &edits, &[]).expect_err(&expected).to_string();
        assert!(error.contains(&expected), "{error}\nexpected {expected}");
    }
}

/// What was added is there, on its layer, with handles nobody has; taking it out leaves what was.
#[test]
fn additions_come_and_go() {
    for (name, bytes) in variants() {
        let (before, _) = read_whole(&name, &bytes);
        let additions = additions_for(&before);
        let patched = patch(&name, &bytes, &[], &additions).unwrap();
        assert_eq!(is_complete(&patched), Completeness::Whole, "{name}");
        let (after, report) = read_whole(&name, &patched);
        assert_eq!(report.problems, [], "{name}");
        assert!(after.fills.is_empty(), "{name}: ours are no walls");
        let (ours, theirs): (Vec<_>, Vec<_>) = after.entities.iter().partition(|e| is_result(&e.layer));
        assert_eq!(theirs.len(), before.entities.len(), "{name}");
        let layers: Vec<&str> = ours.iter().map(|e| e.layer.as_str()).collect();
        assert_eq!(layers, ["EF-MOVED", "EF-BEFORE"], "{name}");
        let (Mark::Path { points, .. }, Shape::Polyline { vertices, closed }) =
            (&additions[1].mark, &ours[1].shape)
        else {
            panic!()
        };
        assert_eq!(
            (vertices.iter().map(|v| v.at).collect::<Vec<_>>(), *closed),
            (points.clone(), true),
            "{name}"
        );
        let texts: Vec<&str> = after.texts.iter().map(|t| t.text.as_str()).collect();
        assert_eq!(texts, ["Tür 3: +0.50 m → 100 %", "壁 %%d ^ \\U+00FC"], "{name}");
        assert_eq!(after.layers.len() - before.layers.len(), 4, "{name}");

        let stripped = strip_own(&patched);
        let has_handles = name.contains("handles true");
        if !has_handles {
            assert_eq!(stripped, bytes, "{name}");
            let is_ascii = !name.ends_with("binary");
            assert!(
                !is_ascii || !String::from_utf8_lossy(&patched).replace('\r', "").contains("\n  5\n"),
                "{name}"
            );
        } else if name.ends_with("LF") && !name.ends_with("CRLF") {
            let text = String::from_utf8_lossy(&patched).into_owned();
            let handles: Vec<&str> =
                text.split("\n  5\n").skip(2).map(|rest| rest.lines().next().unwrap()).collect();
            let distinct: HashSet<&str> = handles.iter().copied().collect();
            assert_eq!(distinct.len(), handles.len(), "{name}: {handles:?}");
            let hex = |text: &str| u64::from_str_radix(text, 16).unwrap();
            let next = text.split("$HANDSEED\n  5\n").nth(1).and_then(|rest| rest.lines().next()).unwrap();
            assert!(distinct.iter().all(|h| hex(h) < hex(next)), "{name}: seed {next}");
            let clean = String::from_utf8_lossy(&stripped).replace(&format!("\n{next}\n"), "\n80\n");
            assert_eq!(clean.as_bytes(), bytes, "{name}");
        }
    }
}

/// Hazard 25: handles beyond 64 bit are stepped over, and a lying `$HANDSEED` is not followed.
#[test]
fn fresh_handles_are_fresh() {
    let text = String::from_utf8(ascii(&drawing("AC1015", true, true), "\n")).unwrap();
    let text = text
        .replace("\nA9\n", "\n123456789ABCDEF01\n")
        .replace("\nA8\n", "\nFFFFFFFFFFFFFFFF\n")
        .replace("\n1071\n8\n", "\n1005\nC7\n");
    let add = Addition {
        layer: "EF-NOTE".into(),
        rgb: [255, 0, 0],
        mark: Mark::Text { at: DVec2::ZERO, height: 1.0, text: "a".into() },
    };
    let patched = String::from_utf8(patch("plan.dxf", text.as_bytes(), &[], &[add]).unwrap()).unwrap();
    let last = patched.split("\n  0\nTEXT\n").nth(1).unwrap();
    assert!(
        last.starts_with("  5\nC9\n"),
        "after C7, which XDATA names, comes the layer and then the text: {last}"
    );
    assert!(patched.contains("$HANDSEED\n  5\nCA\n"));
}

#[test]
fn additions_that_cannot_be_drawn_are_refused() {
    let bytes = ascii(&drawing("AC1015", true, true), "\n");
    let marks = [
        Mark::Path { points: vec![DVec2::ZERO], closed: false },
        Mark::Fill { corners: [DVec2::NAN; 4] },
        Mark::Text { at: DVec2::ZERO, height: 0.0, text: "a".into() },
    ];
    for mark in marks {
        let error =
            patch("plan.dxf", &bytes, &[], &[Addition { layer: "EF-NOTE".into(), rgb: [0; 3], mark }])
                .expect_err("refused");
        assert_eq!(
            error.to_string(),
            "plan.dxf: what is to be added on EF-NOTE has no finite coordinates or no size; nothing was written"
        );
    }
}

fn without_lines(mut drawing: Drawing) -> Drawing {
    let shapes = drawing.entities.iter_mut().chain(&mut drawing.fills).map(|e| &mut e.source);
    shapes
        .chain(drawing.texts.iter_mut().chain(&mut drawing.tags).map(|t| &mut t.source))
        .for_each(|s| s.line = 0);
    drawing
}

/// Binary drawings say the same as ASCII ones, but for lines, which they have none.
#[test]
fn binary_reads_as_ascii_does() {
    for version in ["AC1009", "AC1015"] {
        let pairs = drawing(version, true, true);
        let (a, _) = read_whole("plan.dxf", &ascii(&pairs, "\n"));
        let (b, _) = read_whole("plan.dxf", &binary(&pairs, version == "AC1015"));
        assert!(b.entities.iter().all(|e| e.source.line == 0), "a binary file has no lines");
        assert_eq!(without_lines(a.clone()), without_lines(b));
        assert!(a.entities.iter().any(|e| e.editable == Editable::WithInsert { turnable: true }));
    }
    let whole = binary(&drawing("AC1015", true, true), true);
    for cut in 1..whole.len() {
        assert_ne!(is_complete(&whole[..cut]), Completeness::Empty);
        let end = cut >= whole.len() - 1;
        assert_eq!(is_complete(&whole[..cut]) == Completeness::Whole, end, "cut at {cut} of {}", whole.len());
    }
}

#[test]
fn what_hangs_on_a_wall_is_named() {
    let annotation = "0|DIMENSION|5|C0|8|DIM|10|9.0|20|9.0|13|1.5|23|-2.0|14|20.0|24|20.0\
        |0|DIMENSION|5|C1|8|DIM|10|1.5|20|-2.0|13|1.6|23|-2.0|14|20.0|24|20.0\
        |0|HATCH|5|C2|8|FILL|10|0.0|20|0.0|30|0.0|91|1|92|7|73|1|93|3|10|4.25|20|0.1|10|30.0|20|0.0|10|30.0|20|9.0|97|0|75|0|98|1|10|1.5|20|-2.0\
        |0|HATCH|5|C3|8|FILL|10|1.5|20|-2.0|30|0.0|91|1|92|7|93|1|10|40.0|20|0.1|97|1|330|A0|75|0\
        |0|HATCH|5|C4|8|FILL|10|1.5|20|-2.0|30|0.0|91|1|92|7|93|1|10|40.0|20|0.1|97|1|330|A1|75|0|98|1|10|1.5|20|-2.0\
        |0|LEADER|5|C5|8|NOTE|10|2.875|20|-0.95|10|50.0|20|50.0|0|LEADER|5|C6|8|NOTE|10|50.0|20|50.0|10|1.5|20|-2.0\
        |0|DIMENSION|5|C7|8|DIM|13|70.0|23|0.0|14|80.0|24|0.0";
    let association = "0|SECTION|2|OBJECTS|0|DIMASSOC|5|D0|330|D1|100|AcDbDimAssoc|330|C7|331|A0|0|ENDSEC|";
    let mut pairs_of = drawing("AC1015", true, true);
    let end = pairs_of.len() - 2;
    pairs_of.splice(end..end, pairs(annotation));
    let end = pairs_of.len() - 1;
    pairs_of.splice(end..end, pairs(association.trim_end_matches('|')));
    let bytes = ascii(&pairs_of, "\n");
    let (read, _) = read_whole("plan.dxf", &bytes);
    let wall = read.entities[0].source.record;
    let found = tied_to(&bytes, &read, &[wall], DVec2::X).stale;
    let handles: Vec<&str> = found.iter().filter_map(|source| source.handle.as_deref()).collect();
    assert_eq!(handles, ["C0", "C2", "C3", "C5", "C7"]);
    assert_eq!((found[0].kind.as_str(), found[0].layer.as_str()), ("DIMENSION", "DIM"));
    assert_eq!(tied_to(&bytes, &read, &[], DVec2::X), Tied::default());
}

#[test]
fn host_ids_are_repeated() {
    let mut pairs_of = drawing("AC1015", true, true);
    let own = pairs("1001|OTHER|1000|no|1001|ENFILADE|1000|3f2a-wall-7");
    let before_arc = pairs_of.iter().position(|(_, value)| value == "ARC").unwrap();
    pairs_of.splice(before_arc..before_arc, own);
    for bytes in [ascii(&pairs_of, "\r\n"), binary(&pairs_of, true)] {
        let (read, _) = read_whole("plan.dxf", &bytes);
        let records: Vec<usize> = read.entities.iter().map(|e| e.source.record).take(3).collect();
        let ids = host_ids(&bytes, &[records[0], records[1], records[0] + 6, 9999]);
        assert_eq!(ids, [Some("8".to_owned()), None, Some("3f2a-wall-7".to_owned()), None]);
    }
}

/// What fills the ground between the faces of a wall would stay where the wall was.
#[test]
fn what_fills_a_moved_wall_is_named() {
    let line = |handle: &str, [x0, y0, x1, y1]: [f64; 4]| {
        format!("0|LINE|5|{handle}|8|A-WALL|10|{x0}|20|{y0}|11|{x1}|21|{y1}|")
    };
    let quad = |kind: &str, handle: &str, [x0, y0, x1, y1]: [f64; 4]| {
        format!("0|{kind}|5|{handle}|8|FILL|10|{x0}|20|{y0}|11|{x1}|21|{y0}|12|{x0}|22|{y1}|13|{x1}|23|{y1}|")
    };
    let wide = |handle: &str, x: f64, width: f64| {
        format!("0|LWPOLYLINE|5|{handle}|8|FILL|90|2|70|0|43|{width}|10|{x}|20|0.05|10|{x}|20|3.95|")
    };
    let text = [
        line("A0", [2.0, 0.0, 2.0, 4.0]),
        line("A1", [2.1, 0.0, 2.1, 4.0]),
        line("A2", [7.0, 0.0, 7.0, 4.0]),
        line("A3", [7.1, 0.0, 7.1, 4.0]),
        quad("SOLID", "B0", [2.0, 0.0, 2.1, 4.0]),
        quad("TRACE", "B1", [2.02, 0.0, 2.08, 3.98]),
        wide("B2", 2.05, 0.09),
        quad("SOLID", "B3", [7.0, 0.0, 7.1, 4.0]),
        wide("B4", 7.05, 0.1),
        quad("SOLID", "B5", [2.1, 0.0, 7.0, 0.1]),
        quad("SOLID", "B6", [3.0, 1.0, 3.1, 2.0]),
    ]
    .concat();
    let bytes = format!("0|SECTION|2|ENTITIES|{text}0|ENDSEC|0|EOF|").replace('|', "\n").into_bytes();
    let (read, _) = read_whole("plan.dxf", &bytes);
    let record = |handle: &str| {
        read.entities.iter().find(|e| e.source.handle.as_deref() == Some(handle)).unwrap().source.record
    };
    let found = tied_to(&bytes, &read, &[record("A0"), record("A1")], DVec2::X);
    let handles: Vec<&str> = found.stale.iter().filter_map(|source| source.handle.as_deref()).collect();
    assert_eq!(handles, ["B1", "B2"]);
    let corners = [[2.0, 0.0], [2.1, 0.0], [2.1, 4.0], [2.0, 4.0]].map(DVec2::from);
    // What lies between walls ends at the moved face.
    let shifts =
        found.following.iter().map(|f| f.corners[1].iter().zip(&f.corners[0]).map(|(q, p)| q.x - p.x));
    let shifts: Vec<Vec<f64>> = shifts.map(Iterator::collect).collect();
    assert_eq!(shifts, [[1.0; 4], [1.0, 0.0, 0.0, 1.0]]);
    assert_eq!(found.following[0].corners, [corners.to_vec(), corners.map(|p| p + DVec2::X).to_vec()]);
}

/// What hangs on lines that are shifted.
fn tied_to(bytes: &[u8], read: &Drawing, records: &[usize], shift: DVec2) -> Tied {
    let edit = |&record: &usize| {
        let shape = match &read.entities.iter().find(|e| e.source.record == record).unwrap().shape {
            Shape::Line { a, b } => Shape::Line { a: *a + shift, b: *b + shift },
            other => panic!("{other:?}"),
        };
        Edit::Shape { record, shape }
    };
    let edits: Vec<Edit> = records.iter().map(edit).collect();
    tied("plan.dxf", bytes, read, &edits, (&HashSet::new(), 1.0)).unwrap()
}

/// A wall between two others, of which the left one ends at it, and a column, all filled in every way: each fill goes with
/// what bounds it as far as that says where, and keeps its bytes otherwise.
#[test]
fn what_fills_a_wall_goes_with_it() {
    let line = |handle: &str, [x0, y0, x1, y1]: [f64; 4]| {
        format!("0|LINE|5|{handle}|8|A-WALL|10|{x0}|20|{y0}|11|{x1}|21|{y1}|")
    };
    let ring = |points: &[[f64; 2]]| {
        let corners: String = points.iter().map(|[x, y]| format!("10|{x}|20|{y}|")).collect();
        format!("92|2|72|0|73|1|93|{}|{corners}97|0|", points.len())
    };
    let edges = |points: &[[f64; 2]]| {
        let next = points.iter().cycle().skip(1);
        let each = points.iter().zip(next);
        let edges: String =
            each.map(|([a, b], [c, d])| format!("72|1|10|{a}|20|{b}|11|{c}|21|{d}|")).collect();
        format!("92|0|93|{}|{edges}97|1|330|A0|", points.len())
    };
    let hatch = |handle: &str, kind: &str, outlines: &[String]| {
        let paths = outlines.concat();
        format!(
            "0|HATCH|5|{handle}|8|FILL|10|0.0|20|0.0|30|0.0|2|ANSI31|70|{kind}|71|1|91|{}|{paths}75|0|76|1|98|1|10|4.05|20|1.0|",
            outlines.len()
        )
    };
    // The wall at x 4.0 to 4.1; the left one from 1.0 to its face, at y 2.0 to 2.2; static lines at y 0 and 4.
    let wall = [[4.0, 0.0], [4.1, 0.0], [4.1, 4.0], [4.0, 4.0]];
    let left = [[1.0, 2.0], [4.0, 2.0], [4.0, 2.2], [1.0, 2.2]];
    let off = [[4.0, 0.0], [4.1, 0.0], [4.1, 3.9], [4.05, 4.3]];
    let other = [[8.0, 0.0], [9.0, 0.0], [9.0, 4.0]];
    let whole = |r: f64| format!("92|0|93|1|72|2|10|12.0|20|2.0|40|{r}|50|0.0|51|360.0|73|1|97|0|");
    let bulged = |points: &[[f64; 2]], y: &str| ring(points).replacen(y, &format!("{y}42|0.5|"), 1);
    let text = [
        line("A0", [4.0, 0.0, 4.0, 4.0]),
        line("A1", [4.1, 0.0, 4.1, 4.0]),
        line("A2", [1.0, 2.0, 4.0, 2.0]),
        line("A3", [1.0, 2.2, 4.0, 2.2]),
        line("A4", [0.0, 0.0, 9.0, 0.0]),
        line("A5", [0.0, 4.0, 9.0, 4.0]),
        line("A6", [1.0, 2.0, 1.0, 2.2]),
        line("A7", [9.0, 0.0, 9.0, 4.0]),
        "0|CIRCLE|5|A8|8|A-WALL|10|12.0|20|2.0|40|0.2|".into(),
        hatch("B0", "0", &[ring(&wall)]),
        hatch("B1", "1", &[edges(&wall), ring(&left)]),
        hatch("B2", "1", &[whole(0.2)]),
        hatch("B3", "1", &[bulged(&wall, "20|0|")]),
        hatch("B4", "1", &[ring(&off)]),
        hatch("B5", "1", &[ring(&other)]),
        hatch("B6", "1", &[whole(0.15)]),
        hatch("B7", "1", &[ring(&wall).replace("10|4", "10|-4")]) + "210|0.0|220|0.0|230|-1.0|",
        hatch("B8", "1", &[ring(&wall)]).replace("8|FILL", "8|EF-HEAT-DEGREE"),
        hatch("BA", "1", &[bulged(&left, "20|2|")]),
        "0|SOLID|5|B9|8|FILL|10|4.0|20|0.0|11|4.1|21|0.0|12|4.0|22|4.0|13|4.1|23|4.0|".into(),
    ]
    .concat();
    let bytes = format!("0|SECTION|2|ENTITIES|{text}0|ENDSEC|0|EOF|").replace('|', "\n").into_bytes();
    let (read, _) = read_whole("plan.dxf", &bytes);
    let record = |handle: &str| {
        read.entities.iter().find(|e| e.source.handle.as_deref() == Some(handle)).unwrap().source.record
    };
    let to = |handle: &str, [x0, y0, x1, y1]: [f64; 4]| Edit::Shape {
        record: record(handle),
        shape: Shape::Line { a: DVec2::new(x0, y0), b: DVec2::new(x1, y1) },
    };
    let aside = RigidMotion { turn_rad: 0.0, shift: DVec2::new(0.0, 1.0) };
    let mut edits = vec![
        to("A0", [4.5, 0.0, 4.5, 4.0]),
        to("A1", [4.6, 0.0, 4.6, 4.0]),
        to("A2", [1.0, 2.0, 4.5, 2.0]),
        to("A3", [1.0, 2.2, 4.5, 2.2]),
        Edit::Insert { record: record("A8"), motion: aside },
    ];
    let found = tied("plan.dxf", &bytes, &read, &edits, (&HashSet::new(), 1.0)).unwrap();
    let stale: Vec<&str> = found.stale.iter().filter_map(|s| s.handle.as_deref()).collect();
    assert_eq!(stale, ["B4", "B6", "BA"], "a corner on nothing, another radius, a bulge that would change");
    assert_eq!(found.following.len(), 6);
    edits.pop();
    edits.push(Edit::Shape {
        record: record("A8"),
        shape: Shape::Circle { centre: DVec2::new(12.0, 3.0), radius: 0.2 },
    });
    edits.extend(found.following.iter().map(|f| f.edit.clone()));
    let written = String::from_utf8(patch("plan.dxf", &bytes, &edits, &[]).unwrap()).unwrap();
    let moved = |points: &[[f64; 2]]| {
        points.iter().map(|[x, y]| [if *x >= 4.0 { x + 0.5 } else { *x }, *y]).collect()
    };
    let (wall, left): (Vec<[f64; 2]>, Vec<[f64; 2]>) = (moved(&wall), moved(&left));
    let seed = "10|4.05|20|1.0|";
    let expected = [
        hatch("B0", "0", &[ring(&wall)]).replace(seed, "10|4.55|20|1.0|"),
        hatch("B1", "1", &[edges(&wall), ring(&left)]),
        hatch("B2", "1", &[whole(0.2).replace("20|2.0", "20|3.0")]).replace(seed, "10|4.05|20|2.0|"),
        hatch("B3", "1", &[bulged(&wall, "20|0|")]).replace(seed, "10|4.55|20|1.0|"),
        hatch("B7", "1", &[ring(&wall).replace("10|4", "10|-4")]).replace(seed, "10|3.55|20|1.0|")
            + "210|0.0|220|0.0|230|-1.0|",
        "0|SOLID|5|B9|8|FILL|10|4.5|20|0.0|11|4.6|21|0.0|12|4.5|22|4.0|13|4.6|23|4.0|".into(),
    ];
    for record in expected {
        assert!(written.contains(&record.replace('|', "\n")), "{record}\n{written}");
    }
    // A round column that moves alone takes its fill along.
    let alone = tied("plan.dxf", &bytes, &read, &edits[4..5], (&HashSet::new(), 1.0)).unwrap().following;
    let to = [vec![DVec2::new(12.0, 2.0)], vec![DVec2::new(12.0, 3.0)]];
    assert_eq!(alone.into_iter().map(|f| f.corners).collect::<Vec<_>>(), [to]);
    let unmoved: HashSet<usize> = found.following.iter().map(|f| f.edit.record()).take(1).collect();
    let held = tied("plan.dxf", &bytes, &read, &edits[..5], (&unmoved, 1.0)).unwrap();
    assert_eq!(held.following.len(), 5);
    assert!(held.stale.iter().any(|s| s.handle.as_deref() == Some("B0")));
}

/// The outline of a room goes with the walls it is drawn on where every corner is certain, and is named where several corners
/// are on what moves away; what is drawn elsewhere, or is no room, keeps still.
#[test]
fn outlines_of_rooms_go_with_their_walls() {
    let line = |handle: &str, [x0, y0, x1, y1]: [f64; 4]| {
        format!("0|LINE|5|{handle}|8|A-WALL|10|{x0}|20|{y0}|11|{x1}|21|{y1}|")
    };
    let ring = |handle: &str, layer: &str, points: &[[f64; 2]]| {
        let corners: String = points.iter().map(|[x, y]| format!("10|{x}|20|{y}|")).collect();
        format!("0|LWPOLYLINE|5|{handle}|8|{layer}|90|{}|70|1|43|0.0|{corners}", points.len())
    };
    let room = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]];
    let beside = [[4.1, 0.0], [9.0, 0.0], [9.0, 4.0], [4.1, 4.0]];
    // More of its side lies on no wall than on the one that moves.
    let off = [[0.0, 2.5], [4.0, 2.5], [4.0, 9.0], [0.3, 9.0]];
    let free = [[1.0, 1.0], [4.0, 1.0], [2.0, 2.0]];
    // A fill lies on the room's outline as well as on the walls.
    let fill = |points: &[[f64; 2]]| {
        let corners: String = points.iter().map(|[x, y]| format!("10|{x}|20|{y}|")).collect();
        format!(
            "0|HATCH|5|D0|8|COLOR|10|0.0|20|0.0|30|0.0|2|SOLID|70|1|71|1|91|1|92|2|72|0|73|1|93|4|{corners}97|1|330|B1|75|0|"
        )
    };
    let leader = "0|MULTILEADER|5|C0|8|NOTE|300|CONTEXT_DATA{|10|7|20|7|302|LEADER{|10|8|20|8|304|LEADER_LINE{|10|4|20|1|30|0|\
                  91|0|305|}|303|}|301|}|";
    let far = leader.replace("5|C0", "5|C1").replace("10|4|20|1", "10|5|20|1");
    let text = [
        line("A0", [4.0, 0.0, 4.0, 4.0]),
        line("A1", [4.1, 0.0, 4.1, 4.0]),
        line("A2", [0.0, 0.0, 9.0, 0.0]),
        line("A3", [0.0, 4.0, 9.0, 4.0]),
        line("A4", [0.0, 0.0, 0.0, 4.0]),
        line("A5", [9.0, 0.0, 9.0, 4.0]),
        ring("B0", "AREA-ASSIGN", &room),
        ring("B1", "AREA-ASSIGN", &beside),
        ring("B2", "AREA-ASSIGN", &off),
        ring("B3", "AREA-ASSIGN", &free),
        ring("B4", "A-FURN", &room),
        ring("B5", "EF-QUERY", &room),
        leader.into(),
        far,
        fill(&beside),
    ];
    let bytes =
        format!("0|SECTION|2|ENTITIES|{}0|ENDSEC|0|EOF|", text.concat()).replace('|', "\n").into_bytes();
    let (read, _) = read_whole("plan.dxf", &bytes);
    let on_walls = read.entities.iter().filter(|e| e.layer == "A-WALL").map(|e| e.source.record);
    let held: HashSet<usize> = on_walls.collect();
    let shifted = |handle: &str| {
        let e = read.entities.iter().find(|e| e.source.handle.as_deref() == Some(handle)).unwrap();
        let Shape::Line { a, b } = e.shape else { panic!("{e:?}") };
        Edit::Shape {
            record: e.source.record,
            shape: Shape::Line { a: a + DVec2::X * 0.5, b: b + DVec2::X * 0.5 },
        }
    };
    let mut edits = vec![shifted("A0"), shifted("A1")];
    let found = tied("plan.dxf", &bytes, &read, &edits, (&held, 1.0)).unwrap();
    let stale: Vec<&str> = found.stale.iter().filter_map(|s| s.handle.as_deref()).collect();
    assert_eq!(stale, ["B2", "B4", "C0"]);
    edits.extend(found.following.iter().map(|f| f.edit.clone()));
    let written = String::from_utf8(patch("plan.dxf", &bytes, &edits, &[]).unwrap()).unwrap();
    let moved = [
        ring("B0", "AREA-ASSIGN", &[[0.0, 0.0], [4.5, 0.0], [4.5, 4.0], [0.0, 4.0]]),
        ring("B1", "AREA-ASSIGN", &[[4.6, 0.0], [9.0, 0.0], [9.0, 4.0], [4.6, 4.0]]),
        fill(&[[4.6, 0.0], [9.0, 0.0], [9.0, 4.0], [4.6, 4.0]]),
    ];
    for record in text[8..14].iter().chain(&moved) {
        assert!(written.contains(&record.replace('|', "\n")), "{record}\n{written}");
    }
}

/// Rooms are often drawn by hand, beside their walls by a finger's breadth and across doors: each side keeps its distance.
#[test]
fn rooms_drawn_by_hand_go_with_their_walls() {
    let line = |handle: &str, [x0, y0, x1, y1]: [f64; 4]| {
        format!("0|LINE|5|{handle}|8|A-WALL|10|{x0}|20|{y0}|11|{x1}|21|{y1}|")
    };
    let text = [
        line("A0", [4.0, 0.0, 4.0, 1.5]),
        line("A1", [4.0, 2.5, 4.0, 4.0]),
        line("A2", [0.0, 0.0, 9.0, 0.0]),
        line("A3", [0.0, 4.0, 9.0, 4.0]),
        line("A4", [0.0, 0.0, 0.0, 4.0]),
        // Its first corner is drawn twice; its walls are 0.015 m off.
        "0|LWPOLYLINE|5|B0|8|AREA-ASSIGN|90|5|70|1|43|0.0|10|0.0|20|0.015|10|3.985|20|0.0|10|3.99|20|4.0|10|0.0|20|4.0|\
         10|0.0|20|0.015|"
            .into(),
    ];
    let bytes =
        format!("0|SECTION|2|ENTITIES|{}0|ENDSEC|0|EOF|", text.concat()).replace('|', "\n").into_bytes();
    let (read, _) = read_whole("plan.dxf", &bytes);
    let walls = || read.entities.iter().filter(|e| e.layer == "A-WALL");
    let held: HashSet<usize> = walls().map(|e| e.source.record).collect();
    let shifted = |e: &enfilade_cad::drawing::Entity| {
        let Shape::Line { a, b } = e.shape else { panic!("{e:?}") };
        let shape = Shape::Line { a: a + DVec2::X * 0.5, b: b + DVec2::X * 0.5 };
        Edit::Shape { record: e.source.record, shape }
    };
    let edits: Vec<Edit> = walls().take(2).map(shifted).collect();
    let found = tied("plan.dxf", &bytes, &read, &edits, (&held, 1.0)).unwrap();
    assert!(found.stale.is_empty());
    let [_, after] = &found.following[0].corners;
    let expected = [[0.0, 0.015], [4.485, -0.001882], [4.49, 4.0], [0.0, 4.0], [0.0, 0.015]];
    let is_near = |(p, q): (&DVec2, &[f64; 2])| p.distance(DVec2::from(*q)) < 1e-4;
    assert!(after.iter().zip(&expected).all(is_near), "{after:?}");
    assert_eq!(after[3], DVec2::new(0.0, 4.0), "what stays keeps its bits");
    // With units of ten metres it is a hand's breadth off.
    let found = tied("plan.dxf", &bytes, &read, &edits, (&held, 10.0)).unwrap();
    assert!(found.following.is_empty());
}

/// A floor whose edge runs on past the end of a wall's face would turn askew with the one corner that lies on it: it stays and
/// is named. With a corner at that end too, what crosses the opening would be askew.
#[test]
fn fills_that_run_on_past_a_face_stay() {
    let line = |handle: &str, [x0, y0, x1, y1]: [f64; 4]| {
        format!("0|LINE|5|{handle}|8|A-WALL|10|{x0}|20|{y0}|11|{x1}|21|{y1}|")
    };
    let fill = |handle: &str, points: &[[f64; 2]]| {
        let corners: String = points.iter().map(|[x, y]| format!("10|{x}|20|{y}|")).collect();
        let n = points.len();
        format!(
            "0|HATCH|5|{handle}|8|F|10|0.0|20|0.0|30|0.0|2|SOLID|70|1|71|1|91|1|92|2|72|0|73|1|93|{n}|{corners}97|0|75|0|"
        )
    };
    let text = [
        line("A0", [5.0, 0.0, 5.0, 6.5]),
        line("A1", [5.1, 0.0, 5.1, 6.5]),
        line("A2", [5.0, 6.5, 5.1, 6.5]),
        line("A3", [0.0, 0.0, 9.0, 0.0]),
        line("A4", [0.0, 8.0, 9.0, 8.0]),
        line("A5", [0.0, 0.0, 0.0, 8.0]),
        fill("B0", &[[0.0, 0.0], [5.0, 0.0], [5.0, 8.0], [0.0, 8.0]]),
        fill("B1", &[[0.0, 0.0], [5.0, 0.0], [5.0, 6.5], [5.0, 8.0], [0.0, 8.0]]),
        fill("B2", &[[5.0, 0.0], [5.1, 0.0], [5.1, 6.5], [5.0, 6.5]]),
    ];
    let bytes =
        format!("0|SECTION|2|ENTITIES|{}0|ENDSEC|0|EOF|", text.concat()).replace('|', "\n").into_bytes();
    let (read, _) = read_whole("plan.dxf", &bytes);
    let record = |handle: &str| {
        read.entities.iter().find(|e| e.source.handle.as_deref() == Some(handle)).unwrap().source.record
    };
    let found = tied_to(&bytes, &read, &["A0", "A1", "A2"].map(record), DVec2::X * 0.5);
    let stale: Vec<&str> = found.stale.iter().filter_map(|s| s.handle.as_deref()).collect();
    assert_eq!((stale, found.following.len()), (vec!["B0", "B1"], 1));
}

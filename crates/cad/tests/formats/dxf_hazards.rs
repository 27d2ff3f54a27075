//! Bad input: what is said about it, word for word, and that what can be read is read.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a failing helper fails the test")]

use enfilade_cad::drawing::{Drawing, Edit, Editable, Shape};
use enfilade_cad::dxf::{
    Completeness, Limits, MAX_BLOCK_DEPTH, MAX_EXPANDED_SEGMENTS, ReadOptions, is_complete, patch, read,
};
use enfilade_report::{Error, Report};
use glam::DVec2;

/// Lines joined by LF, written here with `|` between them.
fn lines(text: &str) -> String {
    text.split('|').map(|line| format!("{line}\n")).collect()
}

/// A drawing with these entities and blocks, R2010 in millimetres.
fn drawing(blocks: &str, entities: &str) -> String {
    let part = |text: &str| if text.is_empty() { String::new() } else { lines(text) };
    lines("0|SECTION|2|HEADER|9|$ACADVER|1|AC1024|9|$INSUNITS|70|4|0|ENDSEC")
        + &lines("0|SECTION|2|BLOCKS")
        + &part(blocks)
        + &lines("0|ENDSEC|0|SECTION|2|ENTITIES")
        + &part(entities)
        + &lines("0|ENDSEC|0|EOF")
}

const WALL: &str = "0|LINE|5|2F3|8|A-WALL|10|0.0|20|0.0|11|5.0|21|0.0";

fn read_with(bytes: &[u8], options: &ReadOptions) -> (Result<Drawing, Error>, Vec<String>) {
    let mut report = Report::default();
    let result = read("plan.dxf", bytes, options, &mut report);
    (result, report.problems.iter().map(|p| format!("{} {:?} {p}", p.code, p.severity)).collect())
}

fn read_plain(bytes: &[u8]) -> (Result<Drawing, Error>, Vec<String>) {
    read_with(bytes, &ReadOptions::default())
}

/// The one reason why a file is refused.
fn refusal(bytes: &[u8]) -> String {
    let error = read_plain(bytes).0.expect_err("must be refused");
    assert_eq!(error.exit_code(), 2);
    let problem = error.problem().unwrap();
    format!("{} {problem}", problem.code)
}

/// What is said about a drawing of one good wall and something else, and how many shapes it has.
fn findings(blocks: &str, entities: &str) -> (usize, Vec<String>) {
    let text = drawing(blocks, &format!("{WALL}|{entities}"));
    let (result, problems) = read_plain(text.as_bytes());
    (result.unwrap_or_else(|e| panic!("{e}")).entities.len(), problems)
}

#[test]
fn files_that_are_not_taken_say_why() {
    let good = drawing("", WALL);
    let with = |from: &str, to: &str| good.replace(from, to).into_bytes();
    let utf16: Vec<u8> = good.encode_utf16().flat_map(u16::to_le_bytes).collect();
    let guess = "the file was not read, because a guess could move a wall. Correct this line or export the drawing again";
    let group = "the file was not read, because nothing after this line is sure. A text of several lines or a hand \
                 edit does this: export the drawing again";
    let incomplete = "not read. Save or export it again; if its program never writes EOF, say --accept-missing-eof or set \
         accept-missing-eof = true";
    let cases: Vec<(&str, Vec<u8>, String)> = vec![
        ("1 empty", vec![], "dxf-empty plan.dxf: the file is empty, found 0 bytes, expected a DXF drawing; nothing was read".into()),
        ("1 blank", b" \r\n\0".to_vec(), "dxf-empty plan.dxf: the file is empty, found 4 bytes, all of them blanks, expected a DXF drawing; nothing was read".into()),
        ("2 cut", good.as_bytes()[..good.len() - 5].to_vec(), format!("dxf-incomplete plan.dxf:41: the drawing is incomplete: it ends with `0`, expected 0/EOF at the end; {incomplete}")),
        ("3 no EOF", good.as_bytes()[..good.len() - 6].to_vec(), format!("dxf-incomplete plan.dxf:40: the drawing is incomplete: it ends with `ENDSEC`, expected 0/EOF at the end; {incomplete}")),
        ("5 group code", with("8\nA-WALL\n", "1\ntwo\nlines\n8\nA-WALL\n"), format!("dxf-group-code plan.dxf:31: the group code, found `lines`, expected a whole number from -5 to 1071; {group}")),
        ("6 blank in a number", with("11\n5.0", "11\n1.0E 20"), format!("dxf-bad-number plan.dxf:36 LINE 2F3 layer A-WALL: group 11, found `1.0E 20`, expected a number like 1.5; {guess}")),
        ("7 decimal comma", with("11\n5.0", "11\n1,5"), format!("dxf-bad-number plan.dxf:36 LINE 2F3 layer A-WALL: group 11, found `1,5`, expected a number like 1.5; {guess}")),
        ("10 odd lines", with("0\nEOF", "8\n0\nEOF"), "dxf-odd-lines plan.dxf:43: the last line, found an odd number of lines, expected pairs of group code and value; not read. Save or export the drawing again".into()),
        ("28 UTF-16", utf16.clone(), "dxf-utf16 plan.dxf: the encoding, found UTF-16, expected ASCII, a code page or UTF-8; not read. An editor saved it so: save it as UTF-8, or export the drawing again".into()),
        ("28 UTF-16 with BOM", [&[0xff, 0xfe], &utf16[..]].concat(), "dxf-utf16 plan.dxf: the encoding, found UTF-16, expected ASCII, a code page or UTF-8; not read. An editor saved it so: save it as UTF-8, or export the drawing again".into()),
        ("29 DWG", b"AC1032\0\0\0\0\0\x01".to_vec(), "dxf-other-format plan.dxf: the file, found a DWG R2018 (AC1032), expected a DXF; not read. Save it as DXF in the CAD program, or convert it with the ODA File Converter or LibreDWG".into()),
        ("29 PDF", b"%PDF-1.7\n%\xe2\xe3".to_vec(), "dxf-other-format plan.dxf: the file, found a PDF, expected a DXF; not read. Export DXF from the program that drew it; a PDF holds no walls to write back to".into()),
        ("29 ZIP", b"PK\x03\x04\x14\0\0\0".to_vec(), "dxf-other-format plan.dxf: the file, found a ZIP archive, expected a DXF; not read. Unpack it and take the DXF inside; an FCStd or IFCZIP is opened by its own program".into()),
        ("26 DXB", b"AutoCAD DXB 1.0\r\n\x1a\0".to_vec(), "dxf-other-format plan.dxf: the file, found a DXB (AutoCAD binary drawing interchange), expected a DXF; not read. Load it with DXBIN and save it as DXF".into()),
        ("no entities", lines("0|SECTION|2|HEADER|0|ENDSEC|0|EOF").into_bytes(), "dxf-no-entities plan.dxf: its sections, found no ENTITIES, expected one with the drawn entities; not read".into()),
    ];
    for (name, bytes, expected) in cases {
        assert_eq!(refusal(&bytes), expected, "{name}");
        let is_partial = name.starts_with("2 ") || name.starts_with("3 ");
        assert_eq!(matches!(is_complete(&bytes), Completeness::Incomplete(_)), is_partial, "{name}");
    }
}

#[test]
fn entities_that_cannot_be_trusted_are_left_out_by_name() {
    let kept = "left out of the plan, kept in the file";
    let limit = "expected finite numbers up to 1e12 drawing units";
    let spline = |values: &str| format!("0|SPLINE|5|2F4|8|W|{values}");
    let cases: Vec<(&str, String, String)> = vec![
        ("8 NaN", "0|LINE|5|2F4|8|W|10|nan|20|0|11|1|21|1".into(), format!("dxf-bad-coordinate Warning plan.dxf:39 LINE 2F4 layer W: its coordinates, found NaN 0, {limit}; {kept}")),
        ("8 C NaN", "0|LINE|5|2F4|8|W|10|-1.#IND|20|0|11|1|21|1".into(), format!("dxf-bad-coordinate Warning plan.dxf:39 LINE 2F4 layer W: its coordinates, found NaN 0, {limit}; {kept}")),
        ("8 infinite", "0|CIRCLE|5|2F4|8|W|10|1e999|20|0|40|1".into(), format!("dxf-bad-coordinate Warning plan.dxf:39 CIRCLE 2F4 layer W: its coordinates, found inf 0, {limit}; {kept}")),
        ("8 NaN in a curve", "0|ELLIPSE|5|2F4|8|W|10|nan|20|0|11|1|21|0|40|0.5".into(), format!("dxf-bad-coordinate Warning plan.dxf:39 ELLIPSE 2F4 layer W: its coordinates, found NaN 0, {limit}; {kept}")),
        ("9 huge", "0|LINE|5|2F4|8|W|10|0|20|0|11|2e12|21|1".into(), format!("dxf-bad-coordinate Warning plan.dxf:39 LINE 2F4 layer W: its coordinates, found 2000000000000 1, {limit}; {kept}")),
        ("13 negative array", "0|INSERT|5|2F4|8|W|2|B|10|0|20|0|70|-5".into(), "dxf-bad-array Warning plan.dxf:39 INSERT 2F4 layer W: its columns and rows, found -5 and 1, expected 1 or more; left out".into()),
        ("17 missing block", "0|INSERT|5|2F4|8|W|2|NONE|10|0|20|0".into(), "dxf-missing-block Warning plan.dxf:39 INSERT 2F4 layer W: block NONE, found no such block; the INSERT shows nothing, kept in the file".into()),
        ("18 zero scale", "0|INSERT|5|2F4|8|W|2|B|10|0|20|0|41|0".into(), "dxf-zero-scale Warning plan.dxf:39 INSERT 2F4 layer W: its scale, found 0, expected another factor; left out".into()),
        ("18 scale of almost nothing", "0|INSERT|5|2F4|8|W|2|B|10|0|20|0|41|1e-12".into(), "dxf-zero-scale Warning plan.dxf:39 INSERT 2F4 layer W: its scale, found 0.000000000001, expected another factor; left out".into()),
        ("18 tilted", "0|INSERT|5|2F4|8|W|2|B|10|0|20|0|210|1|220|0|230|0".into(), "dxf-tilted-insert Warning plan.dxf:39 INSERT 2F4 layer W: its extrusion, found [1, 0, 0], expected up or down; left out".into()),
        ("20 no vertices", "0|LWPOLYLINE|5|2F4|8|W|90|4|70|1".into(), "dxf-vertex-count Warning plan.dxf:39 LWPOLYLINE 2F4 layer W: its vertices, found 0, expected 1 to 100000; left out of the plan".into()),
        ("21 bulge", "0|LWPOLYLINE|5|2F4|8|W|90|2|70|0|10|0|20|0|42|1e9|10|1|20|0".into(), format!("dxf-bad-bulge Warning plan.dxf:39 LWPOLYLINE 2F4 layer W: group 42, found a bulge of 1000000000, expected at most 1e6; {kept}")),
        ("20 vertices stated", "0|LWPOLYLINE|5|2F4|8|W|90|7|70|0|10|0|20|0|10|1|20|0".into(), "dxf-vertices-stated Info plan.dxf:39 LWPOLYLINE 2F4 layer W: group 90, found 7, expected 2, the number of its vertices; read with those that are there".into()),
        ("23 degree 0", spline("71|0|40|0|40|1|10|0|20|0"), format!("dxf-bad-spline Warning plan.dxf:39 SPLINE 2F4 layer W: its degree is not between 1 and 25; {kept}")),
        ("23 knots", spline("71|1|40|0|40|2|40|1|40|3|10|0|20|0|10|1|20|0"), format!("dxf-bad-spline Warning plan.dxf:39 SPLINE 2F4 layer W: its knots do not rise; {kept}")),
        ("23 arc without radius", "0|ARC|5|2F4|8|W|10|0|20|0|40|0|50|0|51|9".into(), "dxf-bad-radius Warning plan.dxf:39 ARC 2F4 layer W: its radius, found 0, expected more than 0; left out".into()),
        ("24 duplicate handle", "0|POINT|5|2F3|8|W|10|0|20|0".into(), "dxf-duplicate-handle Info plan.dxf:39 POINT 2F3 layer W: its handle, found also at line 25, expected each once; both are kept, told apart by their lines".into()),
        ("31 proxies", "0|AEC_WALL|5|2F4|8|W|0|AEC_WALL|5|2F5|8|W|0|ACAD_PROXY_ENTITY|5|2F6".into(), format!("dxf-proxy Warning plan.dxf: ACAD_PROXY_ENTITY (1), AEC_WALL (2): objects that only their own program can draw; {kept}. If walls are among them, export with AECTOACAD or as plain DXF")),
        ("32 hatch", "0|HATCH|5|2F4|8|W|92|1|72|0|0|DIMENSION|5|2F5".into(), "dxf-kinds-left-out Info plan.dxf: DIMENSION (1), HATCH (1): not lines of a plan; not used, kept in the file".into()),
        ("33 image", "0|IMAGE|5|2F4|8|W|340|1F".into(), "dxf-kinds-left-out Info plan.dxf: IMAGE (1): not lines of a plan; not used, kept in the file".into()),
        ("solids", "0|3DSOLID|5|2F4|8|W".into(), format!("dxf-solid Warning plan.dxf: 3DSOLID (1): {kept}")),
        ("missing group", "0|LINE|5|2F4|8|W|10|1|20|2|11|3".into(), "dxf-missing-value Warning plan.dxf:39 LINE 2F4 layer W: its points, found not all of the groups 10, 20, 11, 21; left out".into()),
    ];
    let block = "0|BLOCK|8|0|2|B|70|0|10|0|20|0|0|LINE|8|0|10|0|20|0|11|1|21|0|0|ENDBLK";
    for (name, entities, expected) in cases {
        let text = drawing("", &format!("{WALL}|{entities}"));
        let at = drawing(block, &format!("{WALL}|{entities}"));
        let (_, problems) = read_plain(at.as_bytes());
        let offset = block.split('|').count();
        let shift = |words: &str| {
            let moved = words.replace("plan.dxf:39", &format!("plan.dxf:{}", 39 + offset));
            moved.replace("line 25", &format!("line {}", 25 + offset))
        };
        assert_eq!(problems, [shift(&expected)], "{name}, {text}");
        let count = if name.ends_with("stated") { 2 } else { 1 };
        assert_eq!(read_plain(at.as_bytes()).0.unwrap().entities.len(), count, "{name}");
    }
}

/// Filled areas that one plain outline bounds are kept apart from what is drawn.
#[test]
fn filled_areas_are_read_by_their_outline() {
    let hatch =
        |fill: &str| format!("0|HATCH|5|2F4|8|COLS|10|0|20|0|30|0|2|SOLID|{fill}|75|0|76|1|98|1|10|9|20|9");
    let corners: String = (0..65).map(|k| format!("|10|{k}|20|{}", k % 2)).collect();
    let polyline = "92|3|72|0|73|1|93|4|10|3|20|3|10|7|20|3|10|7|20|7|10|3|20|7|97|0";
    let edges = "92|1|93|3|72|1|10|0|20|0|11|4|21|0|72|1|10|4|20|0|11|4|21|4|72|1|10|4|20|4|11|0|21|0|97|0";
    let round = "92|1|93|1|72|2|10|5|20|6|40|2|50|0|51|360|73|1|97|0";
    let solid = "0|SOLID|8|COLS|10|0|20|0|11|4|21|0|12|0|22|4|13|4|23|4";
    // What, the record, and corners or centre of the area it shows.
    #[allow(clippy::type_complexity)]
    let cases: [(&str, String, Option<&[[f64; 2]]>); 9] = [
        (
            "polyline",
            hatch(&format!("70|1|71|0|91|1|{polyline}")),
            Some(&[[3.0, 3.0], [7.0, 3.0], [7.0, 7.0], [3.0, 7.0]]),
        ),
        ("edges", hatch(&format!("70|1|71|0|91|1|{edges}")), Some(&[[0.0, 0.0], [4.0, 0.0], [4.0, 4.0]])),
        ("round", hatch(&format!("70|1|71|0|91|1|{round}")), Some(&[[5.0, 6.0]])),
        ("solid", solid.into(), Some(&[[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]])),
        ("a pattern", hatch(&format!("70|0|71|0|91|1|{polyline}")), None),
        ("two outlines", hatch(&format!("70|1|71|0|91|2|{polyline}|{polyline}")), None),
        ("a spline", hatch("70|1|71|0|91|1|92|1|93|1|72|4|94|3|97|0"), None),
        ("no number", hatch("70|1|71|0|91|1|92|3|72|0|73|1|93|3|10|x|20|3|10|7|20|3|10|7|20|7|97|0"), None),
        ("too many corners", hatch(&format!("70|1|71|0|91|1|92|3|72|0|73|1|93|65{corners}|97|0")), None),
    ];
    for (what, record, outline) in cases {
        let text = drawing("", &format!("{WALL}|{record}"));
        let found = read_plain(text.as_bytes()).0.unwrap_or_else(|e| panic!("{what}: {e}"));
        assert_eq!(found.entities.len(), 1, "{what}");
        let points: Option<Vec<[f64; 2]>> = found.fills.first().map(|e| match &e.shape {
            Shape::Polyline { vertices, .. } => vertices.iter().map(|v| v.at.to_array()).collect(),
            Shape::Circle { centre, .. } => vec![centre.to_array()],
            other => panic!("{other:?}"),
        });
        assert_eq!(points.as_deref(), outline, "{what}");
    }
    let many = format!("{WALL}{}", format!("|{solid}").repeat(20_001));
    assert_eq!(read_plain(drawing("", &many).as_bytes()).0.unwrap().fills.len(), 20_000);
}

#[test]
fn odd_polylines_are_read_as_far_as_they_go() {
    let vertex = |x: f64| format!("0|VERTEX|8|W|10|{x}|20|0");
    let open = format!("0|POLYLINE|5|2F4|8|W|66|1|70|0|{}|{}", vertex(0.0), vertex(1.0));
    let (count, problems) = findings("", &format!("{open}|{WALL}").replace("|5|2F3", ""));
    assert_eq!(count, 3, "hazard 22: the POLYLINE ends where its vertices end");
    let said = "dxf-no-seqend Info plan.dxf:39 POLYLINE 2F4 layer W: its end, found no SEQEND, expected one after the last VERTEX; read up to there";
    assert_eq!(problems, [said]);
    let lying = "0|LWPOLYLINE|5|2F4|8|W|90|2000000000|70|0|10|0|20|0|10|1|20|0";
    let said = "dxf-vertices-stated Info plan.dxf:39 LWPOLYLINE 2F4 layer W: group 90, found 2000000000, expected 2, the number \
                of its vertices; read with those that are there";
    assert_eq!(findings("", lying), (2, vec![said.into()]), "hazard 19: the count is not believed");
    let single = "0|LWPOLYLINE|5|2F4|8|W|90|1|70|0|10|0|20|0";
    assert_eq!(findings("", single), (2, vec![]), "hazard 20: one vertex is a point");
}

fn block(name: &str, inside: &str) -> String {
    format!("0|BLOCK|8|0|2|{name}|70|0|10|0|20|0|{inside}|0|ENDBLK")
}

fn insert(name: &str) -> String {
    format!("0|INSERT|8|W|2|{name}|10|0|20|0")
}

/// Hazards 12–16: nothing unfolds without end, and the INSERT that would is named.
#[test]
fn blocks_unfold_within_their_budget() {
    let line = "0|LINE|8|0|10|0|20|0|11|1|21|0";
    let doubling: Vec<String> = (0..30)
        .map(|i| {
            block(
                &format!("D{i}"),
                &format!("{}|{}", insert(&format!("D{}", i + 1)), insert(&format!("D{}", i + 1))),
            )
        })
        .chain([block("D30", line)])
        .collect();
    let chain: Vec<String> = (0..5000)
        .map(|i| block(&format!("K{i}"), &insert(&format!("K{}", i + 1))))
        .chain([block("K5000", line)])
        .collect();
    let budget = "expected at most 1000000 in all; the INSERT is left out of the plan, kept in the file";
    let cases: Vec<(&str, String, String, String)> = vec![
        ("12", doubling.join("|"), insert("D0"), format!("dxf-expansion-budget: block D0 shown 1 x 1 times would draw 1073741824 pieces, {budget}")),
        ("13", block("A", line), insert("A") + "|70|32767|71|32767|44|1|45|1", format!("dxf-expansion-budget: block A shown 32767 x 32767 times would draw 1073676289 pieces, {budget}")),
        ("14", block("A", &format!("{line}|{}", insert("A"))), insert("a"), "dxf-block-cycle: a block includes itself: A > A; the INSERT is left out".into()),
        ("15", format!("{}|{}", block("A", &insert("B")), block("B", &insert("A"))), insert("A"), "dxf-block-cycle: a block includes itself: A > B > A; the INSERT is left out".into()),
        ("16", chain.join("|"), insert("K0"), "dxf-block-depth: block K0 nests 5001 levels deep, expected at most 100; the INSERT is left out".into()),
        ("33", "0|BLOCK|8|0|2|X|70|4|10|0|20|0|1|\\\\server\\share\\x.dwg|0|ENDBLK".into(), insert("X"), "dxf-external-reference: block X is the external file \\\\server\\share\\x.dwg; never opened, left out of the plan; bind the xref X in your CAD program (XREF, Bind) and save again".into()),
    ];
    for (name, blocks, entities, expected) in cases {
        let (count, problems) = findings(&blocks, &entities);
        let said: Vec<String> = problems
            .iter()
            .map(|p| {
                let (code, rest) = p.split_once(" Warning plan.dxf:").unwrap();
                let (place, words) = rest.split_once(": ").unwrap();
                assert!(place.ends_with("INSERT layer W"), "{place}");
                format!("{code}: {words}")
            })
            .collect();
        assert_eq!((count, said), (1, vec![expected]), "hazard {name}");
    }
    let zero = insert("A") + "|70|0|71|0|44|5|45|5";
    assert_eq!(findings(&block("A", line), &zero), (2, vec![]), "hazard 13: 0 columns are 1");
}

#[test]
fn each_limit_trips() {
    let wall = drawing("", WALL);
    let line = "0|LINE|8|0|10|0|20|0|11|1|21|0";
    let array = drawing(&block("A", line), &(insert("A") + "|70|3|71|2|44|1|45|1"));
    let nested = drawing(&format!("{}|{}", block("A", &insert("B")), block("B", line)), &insert("A"));
    let twice = drawing("", &[line; 3].join("|"));
    let four = drawing("", "0|LWPOLYLINE|8|W|10|0|20|0|10|1|20|0|10|2|20|0|42|3|10|3|20|0");
    let bad = drawing("", &["0|CIRCLE|8|W|10|0|20|0|40|0"; 5].join("|"));
    let base = Limits::default();
    assert_eq!((base.max_expanded_segments, base.max_block_depth), (MAX_EXPANDED_SEGMENTS, MAX_BLOCK_DEPTH));
    type Case<'c> = (&'c str, &'c String, Limits, &'c str);
    let cases: Vec<Case<'_>> = vec![
        ("file", &wall, Limits { max_file_bytes: wall.len() - 1, ..base }, "dxf-file-too-big"),
        ("line", &wall, Limits { max_line_bytes: 7, ..base }, "dxf-line-too-long"),
        ("segments", &array, Limits { max_expanded_segments: 5, ..base }, "dxf-expansion-budget"),
        ("entities", &twice, Limits { max_entities: 1, ..base }, "dxf-too-many"),
        ("entities of blocks", &array, Limits { max_entities: 5, ..base }, "dxf-too-many"),
        ("depth", &nested, Limits { max_block_depth: 1, ..base }, "dxf-block-depth"),
        ("vertices", &four, Limits { max_vertices: 3, ..base }, "dxf-vertex-count"),
        ("coordinate", &wall, Limits { max_coordinate_m: 0.004, ..base }, "dxf-bad-coordinate"),
        ("bulge", &four, Limits { max_bulge: 2.5, ..base }, "dxf-bad-bulge"),
    ];
    for (name, text, limits, code) in cases {
        let (result, problems) = read_plain(text.as_bytes());
        assert!(result.is_ok() && problems.is_empty(), "{name}: {problems:?}");
        let (result, problems) =
            read_with(text.as_bytes(), &ReadOptions { limits, ..ReadOptions::default() });
        let said =
            result.err().and_then(|e| e.problem().map(|p| p.code.to_owned())).or(problems.first().cloned());
        assert!(said.as_ref().is_some_and(|said| said.starts_with(code)), "{name}: {said:?}");
    }
    let (_, problems) = read_with(
        bad.as_bytes(),
        &ReadOptions { limits: Limits { max_notes: 2, ..base }, ..ReadOptions::default() },
    );
    assert_eq!(problems.len(), 3);
    assert_eq!(
        problems[2],
        "dxf-bad-radius Warning plan.dxf: 3 more findings of the kind dxf-bad-radius, not listed one by one"
    );
}

/// Hazards 11 and 20: what is beyond a limit is refused or left out by the limit's name.
#[test]
fn limits_are_named() {
    let text = drawing("", &format!("{WALL}|0|TEXT|5|2F4|8|T|10|0|20|0|40|1|1|{}", "x".repeat(300)));
    let limits = Limits { max_line_bytes: 256, ..Limits::default() };
    let error =
        read_with(text.as_bytes(), &ReadOptions { limits, ..ReadOptions::default() }).0.expect_err("");
    assert_eq!(
        error.to_string(),
        "plan.dxf:52: a value, found 300 bytes in one line, expected at most 256 (MAX_LINE_BYTES); not read"
    );
    let vertices: String = (0..9).map(|i| format!("|10|{i}|20|0")).collect();
    let text = drawing("", &format!("{WALL}|0|LWPOLYLINE|5|2F4|8|W|90|9|70|0{vertices}"));
    let limits = Limits { max_vertices: 8, ..Limits::default() };
    let (result, problems) = read_with(text.as_bytes(), &ReadOptions { limits, ..ReadOptions::default() });
    assert_eq!(result.unwrap().entities.len(), 1);
    let said = "dxf-vertex-count Warning plan.dxf:39 LWPOLYLINE 2F4 layer W: its vertices, found 9, expected 1 to 8; \
                left out of the plan";
    assert_eq!(problems, [said]);
}

/// Hazard 18: what a mirrored, stretched or turned over INSERT shows lies where a CAD program shows it.
#[test]
fn inserts_are_transformed_or_left_out() {
    let line = "0|LINE|8|0|10|1|20|0|11|1|21|2";
    let arc = "0|ARC|8|0|10|0|20|0|40|1|50|0|51|90";
    let at = |more: &str, inside: &str| -> Shape {
        let text = drawing(&block("A", inside), &(insert("A") + more));
        let (result, problems) = read_plain(text.as_bytes());
        assert_eq!(problems, [""; 0]);
        result.unwrap().entities[0].shape.clone()
    };
    let ends = |shape: Shape| {
        let Shape::Line { a, b } = shape else { panic!("{shape:?}") };
        [a.x, a.y, b.x, b.y].map(|v| (v * 1e9).round() / 1e9)
    };
    assert_eq!(ends(at("|41|-1", line)), [-1.0, 0.0, -1.0, 2.0]);
    assert_eq!(ends(at("|41|2|42|3", line)), [2.0, 0.0, 2.0, 6.0]);
    assert_eq!(ends(at("|50|90", line)), [0.0, 1.0, -2.0, 1.0]);
    assert_eq!(ends(at("|210|0|220|0|230|-1", line)), [-1.0, 0.0, -1.0, 2.0]);
    let Shape::Arc { start_rad, end_rad, .. } = at("|41|-1", arc) else { panic!("a mirrored arc is an arc") };
    let [start, end] = [start_rad, end_rad].map(|a| (a.to_degrees().rem_euclid(360.0) * 1e6).round() / 1e6);
    assert_eq!([start, end], [90.0, 180.0]);
    let Shape::Polyline { vertices, .. } = at("|41|2|42|1", arc) else { panic!("a stretched arc is traced") };
    let [first, last] = [vertices[0].at, vertices[vertices.len() - 1].at];
    assert!(first.distance(DVec2::new(2.0, 0.0)) < 1e-9 && last.distance(DVec2::Y) < 1e-9);
}

/// Hazards 25 and 26: handles of any length and none, versions from R10 to R2018 and unknown ones.
#[test]
fn versions_and_handles_are_read_as_they_are() {
    for (version, words) in [
        ("AC1006", "AC1006 (R10)"),
        ("AC1009", "AC1009 (R12)"),
        ("AC1014", "AC1014 (R14)"),
        ("AC1032", "AC1032 (R2018)"),
        ("AC1099", "AC1099 (unknown)"),
        ("AC1002", "AC1002 (before R12)"),
    ] {
        let text = drawing("", WALL).replace("AC1024", version);
        let (result, problems) = read_plain(text.as_bytes());
        assert_eq!((result.unwrap().version.as_str(), problems), (words, vec![]));
    }
    for handle in ["123456789ABCDEF0123", "0", "-1", "xyz"] {
        let text = drawing("", &WALL.replace("2F3", handle));
        let (result, problems) = read_plain(text.as_bytes());
        let entities = result.unwrap().entities;
        let expected = handle.to_ascii_uppercase();
        assert_eq!((entities[0].source.handle.as_deref(), problems), (Some(expected.as_str()), vec![]));
    }
    let text = drawing("", &WALL.replace("|5|2F3", ""));
    let (result, problems) = read_plain(text.as_bytes());
    assert_eq!((result.unwrap().entities[0].source.handle.clone(), problems), (None, vec![]));
}

/// Hazard 11: a line of 100 kB is nothing special.
#[test]
fn long_lines_are_read() {
    let text = drawing("", &format!("{WALL}|0|TEXT|8|T|10|0|20|0|40|1|1|{}", "x".repeat(100_000)));
    let (result, problems) = read_plain(text.as_bytes());
    assert_eq!((result.unwrap().texts[0].text.len(), problems), (100_000, vec![]));
}

/// Hazard 2: of a drawing cut at any byte nothing is taken, and the watcher knows it.
#[test]
fn a_drawing_cut_anywhere_is_incomplete() {
    let text = drawing(&block("A", "0|LINE|8|0|10|0|20|0|11|1|21|0"), &format!("{WALL}|{}", insert("A")))
        .replace('\n', "\r\n");
    let whole = text.trim_end().len();
    for cut in 0..whole {
        let bytes = &text.as_bytes()[..cut];
        let expected = if cut == 0 { "dxf-empty" } else { "dxf-incomplete" };
        assert!(refusal(bytes).starts_with(expected), "cut at {cut}");
        assert_ne!(is_complete(bytes), Completeness::Whole, "cut at {cut}");
        let options = ReadOptions { accept_missing_eof: true, ..ReadOptions::default() };
        let _ = read_with(bytes, &options);
    }
    for cut in whole..=text.len() {
        assert!(read_plain(&text.as_bytes()[..cut]).0.is_ok(), "cut at {cut}");
    }
}

/// Hazards 3 and 4: a missing end mark is taken when asked for; bytes after it are kept.
#[test]
fn the_end_mark_may_be_missing_or_followed() {
    let text = drawing("", WALL);
    let open = &text.as_bytes()[..text.len() - 6];
    let (result, problems) =
        read_with(open, &ReadOptions { accept_missing_eof: true, ..ReadOptions::default() });
    assert_eq!(result.unwrap().entities.len(), 1);
    let said = "dxf-missing-eof Warning plan.dxf:41: its end, found no 0/EOF, expected one; read nevertheless because accept_missing_eof is set";
    assert_eq!(problems, [said]);
    for tail in [vec![0; 100_000], b"\x1a".repeat(3), b"junk\nmore".to_vec()] {
        let bytes = [text.as_bytes(), &tail].concat();
        let (result, problems) = read_plain(&bytes);
        let drawing = result.unwrap();
        let is_quiet = tail.contains(&0x1a);
        assert_eq!(problems.is_empty(), is_quiet, "{problems:?}");
        if !is_quiet {
            assert_eq!(
                problems[0],
                format!(
                    "dxf-bytes-after-eof Warning plan.dxf:43: after 0/EOF, found {} more bytes, expected none; not read, kept in every output",
                    tail.len()
                )
            );
        }
        let shape = Shape::Line { a: DVec2::ZERO, b: DVec2::new(5.0, 1.0) };
        let patched = patch(
            "plan.dxf",
            &bytes,
            &[Edit::Shape { record: drawing.entities[0].source.record, shape }],
            &[],
        )
        .unwrap();
        assert!(patched.ends_with(&tail));
    }
}

/// Hazard 28: line ends of every kind, mixed, and a byte order mark: the same drawing, kept exactly.
#[test]
fn line_ends_and_marks_do_not_matter() {
    let text = drawing("", WALL);
    let expected = read_plain(text.as_bytes()).0.unwrap();
    let mut turn = 0;
    let mixed: String = text
        .chars()
        .map(|c| {
            turn = (turn + usize::from(c == '\n')) % 3;
            if c == '\n' { ["\n", "\r\n", "\r"][turn].to_owned() } else { c.to_string() }
        })
        .collect();
    for text in [
        text.replace('\n', "\r\n"),
        text.replace('\n', "\r"),
        text.replace('\n', "\r\r\n"),
        mixed,
        format!("\u{feff}{text}"),
        format!("999\nmade by hand\n{text}"),
    ] {
        let (result, problems) = read_plain(text.as_bytes());
        let mut drawing = result.unwrap();
        let record = drawing.entities[0].source.record;
        drawing.entities[0].source.line = expected.entities[0].source.line;
        assert_eq!((drawing.entities, problems), (expected.entities.clone(), vec![]), "{text:?}");
        let shape = Shape::Line { a: DVec2::ZERO, b: DVec2::new(7.5, 0.0) };
        let patched = patch("plan.dxf", text.as_bytes(), &[Edit::Shape { record, shape }], &[]).unwrap();
        assert_eq!(String::from_utf8(patched).unwrap(), text.replacen("5.0", "7.5", 1));
    }
}

/// Hazard 36: far from the origin nothing is lost, and only the moved digits change.
#[test]
fn coordinates_far_away_keep_their_digits() {
    let text = drawing("", "0|LINE|5|2F3|8|W|10|568053.449|20|5774347.227|11|568058.449|21|5774347.227");
    let drawing = read_plain(text.as_bytes()).0.unwrap();
    let Shape::Line { a, b } = drawing.entities[0].shape else { panic!() };
    let shift = DVec2::new(0.5, 0.0);
    let edit = Edit::Shape {
        record: drawing.entities[0].source.record,
        shape: Shape::Line { a: a + shift, b: b + shift },
    };
    let patched = String::from_utf8(patch("plan.dxf", text.as_bytes(), &[edit], &[]).unwrap()).unwrap();
    assert_eq!(patched, text.replace("568053.449", "568053.949").replace("568058.449", "568058.949"));
}

/// Hazard 30: layers as the table says, names as they are.
#[test]
fn layers_are_as_the_table_says() {
    let layer = |name: &str, flags: i32, colour: i32| {
        lines(&format!("0|LAYER|2|{name}|70|{flags}|62|{colour}|6|CONTINUOUS"))
    };
    let names = ["0", "xref|A-WALL".replace('|', "\u{1}").as_str(), "../../x", "=cmd", "W\u{e4}nde"]
        .map(str::to_owned);
    let mut table = lines("0|SECTION|2|TABLES|0|TABLE|2|LAYER|70|5");
    for (i, name) in names.iter().enumerate() {
        table += &layer(name, [0, 1, 4, 0, 5][i], if i == 3 { -7 } else { 7 });
    }
    table += &lines("0|ENDTAB|0|ENDSEC");
    let body = drawing("", "0|LINE|8|w\u{c4}NDE|10|0|20|0|11|1|21|0|0|LINE|8|NEW|10|0|20|0|11|1|21|0");
    let text =
        body.replacen("0\nSECTION\n2\nBLOCKS", &(table + "0\nSECTION\n2\nBLOCKS"), 1).replace('\u{1}', "|");
    let drawing = read_plain(text.as_bytes()).0.unwrap();
    let flags: Vec<(String, [bool; 3])> =
        drawing.layers.iter().map(|l| (l.name.clone(), [l.is_off, l.is_frozen, l.is_locked])).collect();
    let (t, f) = (true, false);
    let expected = [
        ("0", [f, f, f]),
        ("xref|A-WALL", [f, t, f]),
        ("../../x", [f, f, t]),
        ("=cmd", [t, f, f]),
        ("Wände", [f, t, t]),
        ("NEW", [f, f, f]),
    ];
    assert_eq!(flags, expected.map(|(name, flags)| (name.to_owned(), flags)));
    assert_eq!(drawing.entities[0].layer, "Wände", "names differ by more than case");
}

/// Hazards 18 and 24 for writing back: what is shown through one INSERT moves with it, the rest says why not.
#[test]
fn what_can_be_written_back_is_said() {
    let line = "0|LINE|8|0|10|0|20|0|11|1|21|0";
    let turned = insert("A") + "|50|30";
    let array = insert("A") + "|70|2|44|5";
    let ellipse = "0|ELLIPSE|5|2FC|8|W|10|0|20|0|11|2|21|0|40|0.5";
    let text = drawing(&block("A", line), &[WALL, &insert("A"), &turned, &array, ellipse].join("|"));
    let (result, problems) = read_plain(text.as_bytes());
    assert_eq!(problems, [""; 0]);
    let editable: Vec<Editable> = result.unwrap().entities.into_iter().map(|e| e.editable).collect();
    let no = |reason: &str| Editable::No(reason.to_owned());
    let expected = [
        Editable::Free,
        Editable::WithInsert { turnable: false },
        Editable::WithInsert { turnable: true },
        no("it is shown by an INSERT with rows and columns"),
        no("it is shown by an INSERT with rows and columns"),
        Editable::WithInsert { turnable: true },
    ];
    assert_eq!(editable, expected);
}

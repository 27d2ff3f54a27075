//! What a drawing says beside its lines: files that it refers to, and texts of marks that are attributes.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a failing helper fails the test")]

use enfilade_cad::dxf::{ReadOptions, read};
use enfilade_cad::roles::Role;
use enfilade_plan::{Plan, PlanOptions, understand};
use enfilade_report::{Error, Report};

fn lines(text: &str) -> String {
    text.split('|').map(|line| format!("{line}\n")).collect()
}

/// A closed box, metres.
fn ring(layer: &str, [x, y, to_x, to_y]: [f64; 4]) -> String {
    format!(
        "|0|LWPOLYLINE|8|{layer}|90|4|70|1|10|{x}|20|{y}|10|{to_x}|20|{y}|10|{to_x}|20|{to_y}|10|{x}|20|{to_y}"
    )
}

fn plan(blocks: &str, entities: &str) -> Result<(Plan, Report), Error> {
    let text = lines(&format!(
        "0|SECTION|2|HEADER|9|$ACADVER|1|AC1024|9|$INSUNITS|70|6|0|ENDSEC|0|SECTION|2|BLOCKS{blocks}|0|ENDSEC\
         |0|SECTION|2|ENTITIES{entities}|0|ENDSEC|0|EOF"
    ));
    let mut report = Report::default();
    let drawing = read("t.dxf", text.as_bytes(), &ReadOptions::default(), &mut report).unwrap();
    understand(&drawing, &PlanOptions::default(), &mut report).map(|plan| (plan, report))
}

/// Three cupboards on the only layer with lines.
fn cupboards(layer: &str) -> String {
    [[1.0, 1.0, 2.6, 1.8], [5.0, 1.0, 6.6, 1.8], [9.0, 5.0, 10.6, 5.8]].map(|r| ring(layer, r)).concat()
}

const FILE: &str = "|0|BLOCK|8|0|2|GF|70|4|10|0|20|0|1|../base/ground-floor.dwg|0|ENDBLK";
const SHOWN: &str = "|0|INSERT|8|0|2|GF|10|0|20|0";

/// The walls stand in a file that was left out: nothing else is taken for them, and the refusal names it with its cure.
#[test]
fn a_refusal_names_the_files_that_are_left_out() {
    let cure = |name: &str, path: &str| {
        format!(
            "block {name} is the external file {path}; never opened, left out of the plan; bind the xref {name} in your CAD \
             program (XREF, Bind) and save again"
        )
    };
    let own = cure("GF", "../base/ground-floor.dwg");
    let sheet = "|0|BLOCK|8|0|2|SHEET|70|4|10|0|20|0|1|sheet.dwg|0|ENDBLK";
    let nested = "|0|BLOCK|8|0|2|ALL|70|0|10|0|20|0|0|INSERT|8|0|2|GF|10|0|20|0|0|ENDBLK";
    let cases = [
        (FILE.to_owned(), SHOWN.to_owned(), "A-FURN", format!("{own}; besides it ")),
        (FILE.to_owned(), SHOWN.to_owned(), "0", format!("{own}; besides it ")),
        (FILE.to_owned() + nested, SHOWN.replace("GF", "ALL"), "A-FURN", format!("{own}; besides it ")),
        (
            FILE.to_owned() + sheet,
            SHOWN.to_owned() + &SHOWN.replace("GF", "SHEET"),
            "A-FURN",
            format!("{own}; {}; besides them ", cure("SHEET", "sheet.dwg")),
        ),
        (String::new(), String::new(), "A-FURN", String::new()),
    ];
    for (blocks, inserts, layer, why) in cases {
        let error = plan(&blocks, &(inserts + &cupboards(layer))).unwrap_err().to_string();
        let expected =
            format!("{why}no entity on a wall layer, layers present: {layer} (3); nothing was measured");
        assert!(error.contains(&expected), "{error}\n{expected}");
    }
    assert!(plan("", &cupboards("PLAN 3")).is_ok(), "the only layer, of which the name says nothing");
}

/// Where no wall is drawn, rooms end at their outlines; beside walls these are rooms alone.
#[test]
fn outlines_of_rooms_are_walls_where_nothing_else_is() {
    let rooms = [[0.0, 0.0, 4.0, 5.0], [4.0, 0.0, 9.0, 5.0], [0.0, 5.0, 9.0, 9.0]];
    let rings: String = rooms.iter().enumerate().map(|(i, r)| ring(&format!("Room_{}", i + 1), *r)).collect();
    let (read, _) = plan("", &rings).unwrap();
    assert_eq!(read.walls.len(), 3);
    assert!(read.senses.iter().all(|s| s.role == Role::Wall && s.confidence < 0.5), "{:?}", read.senses);
    let walled = rings + &ring("WALL", [-0.2, -0.2, 9.2, 9.2]);
    assert_eq!(plan("", &walled).unwrap().0.walls.len(), 1);
}

/// A mark says how it moves by an attribute as well as by a text, on the layer of the attribute or of its INSERT.
#[test]
fn an_attribute_says_how_a_mark_moves() {
    let walls = ring("WALL", [0.0, 0.0, 8.0, 0.3]) + &ring("WALL", [4.0, 3.0, 4.15, 6.0]);
    let block = "|0|BLOCK|8|0|2|NOTE|70|2|10|0|20|0|0|ATTDEF|8|0|10|0|20|0|1|x|2|MOVES|70|0|0|ENDBLK";
    let tag = |insert: &str, attribute: &str, hidden: i32| {
        format!(
            "|0|INSERT|8|{insert}|66|1|2|NOTE|10|4|20|4|0|ATTRIB|8|{attribute}|10|4|20|4|40|0.2|1|x -1m 1m|2|MOVES|70|{hidden}\
             |0|SEQEND|8|{insert}"
        )
    };
    for (insert, attribute, hidden, moves) in [
        ("EF-MOVE", "EF-MOVE", 0, 1),
        ("EF-MOVE", "0", 0, 1),
        ("ef-move", "A-ANNO", 0, 1),
        ("A-ANNO", "EF-MOVE", 0, 1),
        ("A-ANNO", "0", 0, 0),
        ("EF-MOVE", "0", 1, 0),
    ] {
        let mark = ring("EF-MOVE", [3.5, 2.5, 4.5, 6.5]);
        let (plan, report) = plan(block, &(walls.clone() + &mark + &tag(insert, attribute, hidden))).unwrap();
        let clauses: Vec<usize> = plan.markers.groups.iter().map(|g| g.clauses.len()).collect();
        assert_eq!(clauses, vec![1; moves], "{insert} {attribute} {hidden}: {:?}", report.problems);
    }
    // Of several lines.
    let within = "|70|0|101|Embedded Object|10|4|20|4|1|x -1m 1m\\Py -2m 2m|0|SEQEND";
    let several = tag("EF-MOVE", "0", 0).replacen(
        "|1|x -1m 1m|2|MOVES|70|0|0|SEQEND",
        &format!("|1||2|MOVES{within}"),
        1,
    );
    let (plan, _) =
        plan(block, &(walls.clone() + &ring("EF-MOVE", [3.5, 2.5, 4.5, 6.5]) + &several)).unwrap();
    assert_eq!(plan.markers.groups.iter().map(|g| g.clauses.len()).collect::<Vec<_>>(), [2]);
}

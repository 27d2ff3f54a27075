//! What a CAD program does not show is hidden here too, and listed: layers frozen on paper, invisible entities, INSERTs.

#![allow(clippy::unwrap_used, reason = "a failing helper fails the test")]

use crate::support::read_whole;
use enfilade_cad::drawing::Drawing;
use enfilade_report::Severity;

fn lines(text: &str) -> String {
    text.split('|').map(|line| format!("{line}\n")).collect()
}

/// Layers with handles: walls 1A, walls 1B, nothing that is known 1C (off), 1D (frozen).
const LAYERS: &str = "0|LAYER|5|1A|2|WALL|70|0|62|7|0|LAYER|5|1b|2|WALL-OPTION|70|0|62|7\
    |0|LAYER|5|1C|2|PLAN-B|70|0|62|-7|0|LAYER|5|1D|2|PLAN-C|70|1|62|7";

fn wall(layer: &str, more: &str) -> String {
    format!("|0|LINE|8|{layer}{more}|10|0.0|20|0.0|11|9000.0|21|0.0")
}

fn bytes(blocks: &str, entities: &str) -> Vec<u8> {
    let text = format!(
        "0|SECTION|2|HEADER|9|$ACADVER|1|AC1024|9|$INSUNITS|70|4|0|ENDSEC|0|SECTION|2|TABLES|0|TABLE|2|LAYER|70|4|{LAYERS}\
         |0|ENDTAB|0|ENDSEC|0|SECTION|2|BLOCKS{blocks}|0|ENDSEC|0|SECTION|2|ENTITIES{entities}|0|ENDSEC|0|EOF"
    );
    lines(&text).into_bytes()
}

fn block(name: &str, inside: &str) -> String {
    format!("|0|BLOCK|8|0|2|{name}|70|0|10|0|20|0{inside}|0|ENDBLK")
}

/// Names of the layers that are frozen.
fn frozen(drawing: &Drawing) -> Vec<&str> {
    drawing.layers.iter().filter(|l| l.is_frozen).map(|l| l.name.as_str()).collect()
}

/// A viewport that shows model space from 0 to 10,000, with more groups.
fn viewport(more: &str) -> String {
    format!("|0|VIEWPORT|8|0|67|1|10|150|20|100|40|200|41|200|68|2|69|3|12|5000|22|0|45|10000{more}")
}

#[test]
fn a_layer_that_every_viewport_freezes_is_frozen() {
    let walls = wall("WALL", "") + &wall("WALL-OPTION", "");
    let freezing = viewport("|331|1B");
    let sheet = viewport("").replace("|69|3|", "|69|1|");
    let paper = |inside: &str| block("*Paper_Space0", inside);
    let hidden = ["WALL-OPTION", "PLAN-C"];
    let shown = ["PLAN-C"];
    for (what, blocks, viewports, expected) in [
        ("none", String::new(), String::new(), &shown[..]),
        ("the sheet alone", String::new(), sheet.replace("|45|", "|331|1B|45|"), &shown),
        ("one", String::new(), sheet + &freezing, &hidden),
        ("hard pointer", String::new(), viewport("|341|1b"), &hidden),
        ("by name", String::new(), viewport("|1001|ACAD|1000|MVIEW|1002|{|1003|WALL-option|1002|}"), &hidden),
        ("two", String::new(), freezing.repeat(2), &hidden),
        ("two sheets", paper(&freezing), freezing.clone(), &hidden),
        ("two that differ", String::new(), freezing.clone() + &viewport(""), &shown),
        ("another sheet", paper(&viewport("|331|1A")), freezing.clone(), &shown),
        ("one that is off", String::new(), freezing.clone() + &viewport("|90|131072"), &hidden),
        ("a view from the side", String::new(), freezing.clone() + &viewport("|16|1|26|0|36|0"), &hidden),
        ("another place", String::new(), freezing.clone() + &viewport("").replace("5000", "90000"), &hidden),
        ("without walls", String::new(), freezing.clone() + &viewport("|331|1A|331|1B"), &hidden),
        ("all walls", String::new(), viewport("|331|1A|331|1B"), &shown),
    ] {
        let (drawing, _) = read_whole("t.dxf", &bytes(&blocks, &(walls.clone() + &viewports)));
        assert_eq!(frozen(&drawing), expected, "{what}");
        assert_eq!(drawing.entities.len(), 2, "{what}");
    }
}

/// Marks are hidden on sheets of paper as a matter of course.
#[test]
fn marks_that_viewports_freeze_are_read() {
    let mark = "|0|LWPOLYLINE|8|EF-QUERY|90|3|70|1|10|0|20|0|10|1|20|0|10|1|20|1";
    let all = wall("WALL", "") + mark + &viewport("|1001|ACAD|1000|MVIEW|1003|EF-QUERY");
    let (drawing, _) = read_whole("t.dxf", &bytes("", &all));
    assert_eq!(frozen(&drawing), ["PLAN-C"]);
}

fn insert(name: &str, layer: &str, more: &str) -> String {
    format!("|0|INSERT|8|{layer}|2|{name}|10|0|20|0{more}")
}

#[test]
fn what_is_hidden_otherwise_is_listed() {
    let blocks = block("W", &wall("WALL", ""))
        + &block("BARE", &wall("0", ""))
        + &block("CHAIR", &wall("FURNITURE", ""))
        + &block("STATES", &(wall("0", "|60|1") + &wall("WALL", "|60|1") + &wall("WALL", "")))
        + &block("OUTER", &(insert("W", "PLAN-C", "") + &wall("WALL", "")));
    let words = |list: &str| {
        format!(
            "the drawing hides what may be walls: {list}; left out of the plan; show it if it should be measured"
        )
    };
    for (what, entities, list) in [
        ("nothing", insert("W", "WALL", ""), ""),
        ("invisible", wall("WALL", "|60|1").repeat(2), "2 invisible on \"WALL\""),
        ("invisible furniture", wall("FURNITURE", "|60|1"), ""),
        ("on paper", wall("WALL", "|60|1|67|1"), ""),
        ("an INSERT", insert("W", "WALL", "|60|1"), "1 invisible on \"WALL\""),
        ("frozen", insert("W", "PLAN-C", ""), "1 in blocks on the hidden layer \"PLAN-C\""),
        ("frozen furniture", insert("CHAIR", "PLAN-C", ""), ""),
        (
            "layer 0 in a frozen one",
            insert("BARE", "PLAN-C", ""),
            "1 in blocks on the hidden layer \"PLAN-C\"",
        ),
        (
            "layer 0 in one that is off",
            insert("BARE", "PLAN-B", ""),
            "1 in blocks on the hidden layer \"PLAN-B\"",
        ),
        ("walls in one that is off", insert("W", "PLAN-B", ""), ""),
        ("states of a block", insert("STATES", "DOORS", "").repeat(2), "1 invisible on \"WALL\""),
        ("frozen within", insert("OUTER", "WALL", ""), "1 in blocks on the hidden layer \"PLAN-C\""),
    ] {
        let (_, report) = read_whole("t.dxf", &bytes(&blocks, &entities));
        let found = report.problems.iter().filter(|p| p.code == "dxf-hidden");
        let found: Vec<_> = found.map(|p| (p.severity, p.text.clone())).collect();
        let expected: Vec<_> =
            Some((Severity::Info, words(list))).filter(|_| !list.is_empty()).into_iter().collect();
        assert_eq!(found, expected, "{what}");
    }
    let (drawing, _) = read_whole("t.dxf", &bytes(&blocks, &insert("OUTER", "WALL", "")));
    assert_eq!(drawing.entities.len(), 1, "what hangs on a frozen INSERT is not shown");
}

#[test]
fn constant_attributes_are_texts() {
    let room = |flags: i32, more: &str| {
        let text = format!("|0|ATTDEF|8|0|10|0|20|0|40|200|1|Kitchen|2|NAME|70|{flags}{more}");
        let (drawing, _) =
            read_whole("t.dxf", &bytes(&block("ROOM", &text), &insert("ROOM", "NAMES", "|10|2000|20|3000")));
        drawing.texts.iter().map(|t| format!("{} {} {}", t.layer, t.text, t.at)).collect::<Vec<_>>()
    };
    assert_eq!(room(2, ""), ["NAMES Kitchen [2000, 3000]"]);
    assert_eq!(room(10, ""), ["NAMES Kitchen [2000, 3000]"]);
    for (flags, more) in [(0, ""), (3, ""), (2, "|60|1")] {
        assert!(room(flags, more).is_empty(), "{flags} {more}");
    }
}

/// Solids are named in a block too.
#[test]
fn solids_in_blocks_are_named() {
    let solids = block("S", "|0|3DSOLID|8|WALL|70|1|0|BODY|8|WALL|70|1|0|REGION|8|WALL|70|1");
    let (drawing, report) = read_whole("t.dxf", &bytes(&solids, &insert("S", "WALL", "")));
    let of: Vec<(&str, &str)> = drawing.undrawn.iter().map(|u| (u.layer.as_str(), u.kind.as_str())).collect();
    assert_eq!(of, [("WALL", "3DSOLID"), ("WALL", "BODY"), ("WALL", "REGION")]);
    let said = report.problems.iter().find(|p| p.code == "dxf-solid").unwrap();
    assert!(said.text.starts_with("3DSOLID (1), BODY (1), REGION (1): "), "{}", said.text);
}

/// A ring of walls with more groups, and one thing more of walls.
fn storey(more: &str, thing: &str) -> Vec<u8> {
    let side = |[a, b, c, d]: [i32; 4]| format!("|0|LINE|8|WALL{more}|10|{a}|20|{b}|11|{c}|21|{d}");
    let ring = [[0, 0, 10_000, 0], [10_000, 0, 10_000, 8000], [10_000, 8000, 0, 8000], [0, 8000, 0, 0]];
    bytes("", &(ring.map(side).concat() + thing))
}

/// How many entities are left, and what is said.
fn cut(bytes: &[u8]) -> (usize, Vec<String>) {
    let (drawing, report) = read_whole("t.dxf", bytes);
    let said = report.problems.iter().filter(|p| p.code == "dxf-not-cut").map(|p| p.text.clone());
    (drawing.entities.len(), said.collect())
}

#[test]
fn walls_that_are_not_cut_are_left_out_and_listed() {
    let words = |list: &str| {
        vec![format!("not at the height of the eyes: {list}; left out of the plan, kept in the file")]
    };
    let line =
        |z: i32, thick: &str| format!("|0|LINE|8|WALL{thick}|10|3000|20|1000|30|{z}|11|3000|21|5000|31|{z}");
    let (flat, tall) = ("", "|39|2700");
    let (below, above) = (words("1 wall below it on \"WALL\""), words("1 wall above it on \"WALL\""));
    for (what, walls, thing, left, said) in [
        ("as high as the others", tall, line(0, tall), 5, vec![]),
        ("a parapet", tall, line(0, "|39|900"), 4, below.clone()),
        ("a parapet below the floor", tall, line(900, "|39|-900"), 4, below.clone()),
        ("without a thickness", tall, line(0, flat), 5, vec![]),
        ("upside down", tall, line(0, "|39|-900|210|0|220|0|230|-1"), 4, below),
        ("a beam", tall, line(2500, "|39|200"), 4, above.clone()),
        ("a flat beam", tall, line(2500, flat), 4, above.clone()),
        ("low walls alone", "|39|900", line(0, "|39|300"), 5, vec![]),
        ("few are thick", flat, line(0, "|39|900"), 5, vec![]),
        ("flat and a storey above", flat, line(5800, flat), 4, above),
        ("flat and on a step", flat, line(1200, flat), 5, vec![]),
        ("flat and above the sea", flat, line(412_000, flat), 5, vec![]),
        ("flat and on the walls", flat, line(2900, flat), 5, vec![]),
        ("beside the plan", flat, line(5800, flat).replace("3000", "13000"), 5, vec![]),
        ("much of the plan", flat, line(5800, flat).repeat(4), 8, vec![]),
    ] {
        assert_eq!(cut(&storey(walls, &thing)), (left, said), "{what}");
    }
}

/// At the height of the knees a parapet is a wall.
#[test]
fn a_parapet_is_cut_at_the_height_of_the_knees() {
    use enfilade_cad::dxf::{ReadOptions, read};
    use enfilade_cad::ifc::Sight;

    let bytes = storey("|39|2700", "|0|LINE|8|WALL|39|900|10|3000|20|1000|11|3000|21|5000");
    let left = |sight: Sight| {
        let options = ReadOptions { sight, ..ReadOptions::default() };
        read("t.dxf", &bytes, &options, &mut Default::default()).unwrap().entities.len()
    };
    assert_eq!([Sight::Eye, Sight::Knee].map(left), [4, 5]);
}

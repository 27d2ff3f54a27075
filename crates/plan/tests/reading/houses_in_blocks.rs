//! A house that is drawn in a block is understood as a loose one, and its walls move.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a failing helper fails the test")]

use enfilade_cad::drawing::{Drawing, Editable};
use enfilade_cad::dxf::{ReadOptions, read};
use enfilade_plan::axes::OpeningKind;
use enfilade_plan::{Plan, PlanOptions, fittings, structure, understand};
use enfilade_report::Report;

/// Faces of outer walls with a door and a window, of a partition with a door, and of a wall that stands free, metres.
const WALLS: [[f64; 4]; 28] = [
    [0.0, 0.0, 2.0, 0.0],
    [3.0, 0.0, 10.0, 0.0],
    [10.0, 0.0, 10.0, 3.0],
    [10.0, 5.0, 10.0, 8.0],
    [10.0, 8.0, 0.0, 8.0],
    [0.0, 8.0, 0.0, 0.0],
    [0.3, 0.3, 2.0, 0.3],
    [3.0, 0.3, 4.9, 0.3],
    [5.1, 0.3, 9.7, 0.3],
    [9.7, 0.3, 9.7, 3.0],
    [9.7, 5.0, 9.7, 7.7],
    [9.7, 7.7, 5.1, 7.7],
    [4.9, 7.7, 0.3, 7.7],
    [0.3, 7.7, 0.3, 0.3],
    [2.0, 0.0, 2.0, 0.3],
    [3.0, 0.0, 3.0, 0.3],
    [9.7, 3.0, 10.0, 3.0],
    [9.7, 5.0, 10.0, 5.0],
    [4.9, 0.3, 4.9, 3.0],
    [5.1, 0.3, 5.1, 3.0],
    [4.9, 3.0, 5.1, 3.0],
    [4.9, 3.9, 4.9, 7.7],
    [5.1, 3.9, 5.1, 7.7],
    [4.9, 3.9, 5.1, 3.9],
    [6.5, 4.0, 8.2, 4.0],
    [8.2, 4.0, 8.2, 4.15],
    [8.2, 4.15, 6.5, 4.15],
    [6.5, 4.15, 6.5, 4.0],
];

/// Panes of the window, and the leaves of the doors.
const PANES: [[f64; 4]; 2] = [[9.8, 3.0, 9.8, 5.0], [9.9, 3.0, 9.9, 5.0]];
const LEAVES: [[f64; 4]; 2] = [[5.0, 3.0, 5.9, 3.0], [2.0, 0.3, 2.0, 1.3]];

fn line(layer: &str, [a, b, c, d]: [f64; 4]) -> String {
    format!("0\nLINE\n8\n{layer}\n10\n{a}\n20\n{b}\n11\n{c}\n21\n{d}\n")
}

fn lines(layer: &str, all: &[[f64; 4]]) -> String {
    all.iter().map(|l| line(layer, *l)).collect()
}

fn house() -> String {
    let swing =
        |x: f64, y: f64, r: f64| format!("0\nARC\n8\nDOOR\n10\n{x}\n20\n{y}\n40\n{r}\n50\n0\n51\n90\n");
    lines("WALL", &WALLS)
        + &swing(5.0, 3.0, 0.9)
        + &swing(2.0, 0.3, 1.0)
        + &lines("DOOR", &LEAVES)
        + &lines("WINDOW", &PANES)
}

fn block(name: &str, inside: &str) -> String {
    format!("0\nBLOCK\n8\n0\n2\n{name}\n70\n0\n10\n1\n20\n2\n{inside}0\nENDBLK\n")
}

fn insert(name: &str, x: f64, more: &str) -> String {
    format!("0\nINSERT\n8\n0\n2\n{name}\n10\n{x}\n20\n-3\n{more}")
}

fn drawing(blocks: &str, entities: &str) -> String {
    let head = "0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1024\n9\n$INSUNITS\n70\n6\n0\nENDSEC\n";
    format!(
        "{head}0\nSECTION\n2\nBLOCKS\n{blocks}0\nENDSEC\n0\nSECTION\n2\nENTITIES\n{entities}0\nENDSEC\n0\nEOF\n"
    )
}

struct Read {
    drawing: Drawing,
    plan: Plan,
}

fn understood(text: &str) -> Read {
    let mut report = Report::default();
    let drawing = read("plan.dxf", text.as_bytes(), &ReadOptions::default(), &mut report).unwrap();
    let plan = understand(&drawing, &PlanOptions::default(), &mut report).unwrap();
    Read { drawing, plan }
}

#[test]
fn doors_and_windows_in_a_block_are_found_as_loose_ones() {
    let once = block("H", &house());
    let nested = format!("{once}{}", block("O", &insert("H", 4.0, "41\n-1\n50\n30\n")));
    let cases = [
        ("loose", drawing("", &house()), true),
        ("once", drawing(&once, &insert("H", 0.0, "")), true),
        ("turned over", drawing(&once, &insert("H", 0.0, "210\n0\n220\n0\n230\n-1\n")), true),
        ("nested, mirrored, turned", drawing(&nested, &insert("O", 50.0, "50\n120\n")), true),
        ("twice", drawing(&once, &(insert("H", 0.0, "") + &insert("H", 40.0, ""))), false),
        ("one over the other", drawing(&once, &(insert("H", 0.0, "") + &insert("H", 0.0, ""))), false),
        ("array", drawing(&once, &insert("H", 0.0, "70\n2\n44\n40\n")), false),
    ];
    for (name, text, is_free) in cases {
        let read = understood(&text);
        let (axes, marked) = structure::axes(&read.plan, &read.drawing);
        let count = |kind: OpeningKind| axes.openings.iter().filter(|o| o.kind == kind).count();
        let found = [OpeningKind::Door, OpeningKind::Window, OpeningKind::Passage].map(count);
        assert_eq!(found, [2, 1, 0], "{name}");
        assert_eq!(read.plan.walls.iter().all(|w| w.editable == Editable::Free), is_free, "{name}");
        // Where they move with their INSERT, nothing goes along one by one.
        let fittings = fittings::fittings(&read.plan, &read.drawing, &axes, &marked);
        assert_eq!(fittings.len(), if is_free { 6 } else { 0 }, "{name}");
    }
}

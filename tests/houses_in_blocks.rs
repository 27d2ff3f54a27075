//! A house that is drawn in a block is understood as a loose one, and its walls move.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a failing helper fails the test")]

use std::fmt::Write;

use enfilade::formats::dxf::{ReadOptions, patch, read};
use enfilade::moves::Moves;
use enfilade::moves::carried::{Carried, carried};
use enfilade::plan::axes::OpeningKind;
use enfilade::plan::curve::control_points;
use enfilade::plan::drawing::{Drawing, Edit, Editable};
use enfilade::plan::graph::Graph;
use enfilade::plan::{Plan, PlanOptions, fittings, structure, understand};
use enfilade::report::Report;

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
    report: Report,
}

fn understood(text: &str) -> Read {
    let mut report = Report::default();
    let drawing = read("plan.dxf", text.as_bytes(), &ReadOptions::default(), &mut report).unwrap();
    let plan = understand(&drawing, &PlanOptions::default(), &mut report).unwrap();
    Read { drawing, plan, report }
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

/// The bytes with the free wall moved as far as its mark allows.
fn moved(text: &str, read: &mut Read) -> String {
    let graph = Graph::new(&read.plan);
    let (axes, marked) = structure::axes(&read.plan, &read.drawing);
    let moves = Moves::from_markers(&read.plan, &graph, &axes, &mut read.report);
    let p: Vec<f64> = moves.bounds().iter().map(|b| b[1]).collect();
    let layout = moves.apply(&read.plan, &graph, &p);
    let record = |w: u32| read.plan.walls[w as usize].source.record;
    let mut edits: Vec<Edit> = layout
        .walls
        .iter()
        .filter(|w| w.is_changed)
        .map(|w| Edit::Shape { record: record(w.wall), shape: w.shape.clone() })
        .collect();
    for f in fittings::fittings(&read.plan, &read.drawing, &axes, &marked) {
        if let Carried::Moves(shape, _) = carried(&read.plan, &f, &layout) {
            edits.push(Edit::Shape { record: f.source.record, shape });
        }
    }
    assert!(edits.len() >= 4, "{:?}", read.report);
    String::from_utf8(patch("plan.dxf", text.as_bytes(), &edits, &[]).unwrap()).unwrap()
}

/// Programs that draw a plan of solids write the view as one block and the section as another over it: a wall that
/// moves leaves no copy of itself in the view, and the result is read as what it was.
#[test]
fn a_view_goes_with_the_section_that_lies_over_it() {
    // As many as a drawing has that is no sketch.
    let chopped = |[a, b, c, d]: [f64; 4]| {
        let at = move |i: i32| [a + (c - a) * f64::from(i) / 6.0, b + (d - b) * f64::from(i) / 6.0];
        (0..6).map(move |i| [at(i)[0], at(i)[1], at(i + 1)[0], at(i + 1)[1]])
    };
    let walls: Vec<[f64; 4]> = WALLS.into_iter().flat_map(chopped).collect();
    let fan = |i: i32| {
        [10.5, 0.037 * f64::from(i), 10.6 + 0.007 * f64::from(i), 7.0 + 0.001 * f64::from(i * i % 97)]
    };
    let more: Vec<[f64; 4]> = (0..200).map(fan).collect();
    let turned: Vec<[f64; 4]> = walls.iter().map(|[a, b, c, d]| [*c, *d, *a, *b]).collect();
    let blocks =
        block("VIEW", &(lines("0", &turned) + &lines("0", &more))) + &block("CUT", &lines("0", &walls));
    let mut mark = String::from("0\nLWPOLYLINE\n8\nEF-MOVE\n90\n4\n70\n1\n");
    for (x, y) in [(5.3, -1.2), (7.4, -1.2), (7.4, -0.6), (5.3, -0.6)] {
        write!(mark, "10\n{x}\n20\n{y}\n").unwrap();
    }
    mark += "0\nTEXT\n8\nEF-MOVE\n10\n5.4\n20\n-0.9\n40\n0.1\n1\nx -0.5 0.5; rotate -15 15\n";
    let text = drawing(&blocks, &(insert("VIEW", 0.0, "") + &insert("CUT", 0.0, "") + &mark));
    let mut before = understood(&text);
    let says = |read: &Read| read.report.problems.iter().any(|p| p.code == "section-over-view");
    assert!(says(&before) && before.plan.walls.len() == walls.len(), "{:?}", before.report);
    let after = understood(&moved(&text, &mut before));
    assert!(says(&after) && after.plan.walls.len() == walls.len(), "{:?}", after.report);
    let of = |read: &Read, name: &str| -> Vec<_> {
        let own = read.drawing.entities.iter().filter(|e| e.blocks == [name]);
        own.map(|e| control_points(&e.shape)).collect()
    };
    let (cut, view) = (of(&after, "CUT"), of(&after, "VIEW"));
    let differ = cut.iter().zip(of(&before, "CUT")).filter(|(a, b)| *a != b).count();
    assert_eq!(differ, 24, "the four faces of the free wall");
    for (a, b) in cut.iter().zip(&view) {
        assert_eq!([a[0], a[1]], [b[1], b[0]]);
    }
}

//! One flat in the habits of draughtsmen: what slides, and how far, does not depend on how its walls are drawn.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a failing helper fails the test")]

use enfilade_config::{Partial, Settings};
use enfilade_fixtures::corridor::{Rect, corners, drawing, line, polyline};
use enfilade_overlay::result::CheckResult;
use enfilade_pipeline::Input;
use enfilade_pipeline::works::{make_works, works_of};
use enfilade_report::Cancel;

/// The walls of the flat as boxes: outer ones with the front door's gap, and three partitions, each with a gap of 0.9 m.
const WALLS: [Rect; 11] = [
    [0.0, 0.0, 1.0, 0.3],
    [2.0, 0.0, 9.0, 0.3],
    [0.0, 6.7, 9.0, 7.0],
    [0.0, 0.3, 0.3, 6.7],
    [8.7, 0.3, 9.0, 6.7],
    [4.0, 0.3, 4.1, 5.2],
    [4.0, 6.1, 4.1, 6.7],
    [4.1, 3.4, 4.6, 3.5],
    [5.5, 3.4, 8.7, 3.5],
    [6.5, 3.5, 6.6, 3.8],
    [6.5, 4.7, 6.6, 6.7],
];

/// The same in one outline: no wall of it is closed against another.
const OUTLINE: [[f64; 2]; 36] = [
    [0.0, 0.0],
    [0.0, 7.0],
    [9.0, 7.0],
    [9.0, 0.0],
    [2.0, 0.0],
    [2.0, 0.3],
    [4.0, 0.3],
    [4.0, 5.2],
    [4.1, 5.2],
    [4.1, 3.5],
    [4.6, 3.5],
    [4.6, 3.4],
    [4.1, 3.4],
    [4.1, 0.3],
    [8.7, 0.3],
    [8.7, 3.4],
    [5.5, 3.4],
    [5.5, 3.5],
    [6.5, 3.5],
    [6.5, 3.8],
    [6.6, 3.8],
    [6.6, 3.5],
    [8.7, 3.5],
    [8.7, 6.7],
    [6.6, 6.7],
    [6.6, 4.7],
    [6.5, 4.7],
    [6.5, 6.7],
    [4.1, 6.7],
    [4.1, 6.1],
    [4.0, 6.1],
    [4.0, 6.7],
    [0.3, 6.7],
    [0.3, 0.3],
    [1.0, 0.3],
    [1.0, 0.0],
];

fn boxes(of: impl Fn(Rect) -> String) -> String {
    WALLS.into_iter().map(of).collect()
}

fn sides(ring: &[[f64; 2]]) -> String {
    let next = ring.iter().cycle().skip(1);
    ring.iter().zip(next).map(|(a, b)| line("A-WALL", [a[0], a[1], b[0], b[1]])).collect()
}

fn ring(r: Rect) -> String {
    polyline("A-WALL", &corners(r), true)
}

/// The axis of a box from end to end, and its thickness.
fn axis([x0, y0, x1, y1]: Rect) -> ([[f64; 2]; 2], f64) {
    let (x, y) = (f64::midpoint(x0, x1), f64::midpoint(y0, y1));
    if x1 - x0 > y1 - y0 { ([[x0, y], [x1, y]], y1 - y0) } else { ([[x, y0], [x, y1]], x1 - x0) }
}

/// A polyline as wide as the wall.
fn wide(r: Rect) -> String {
    let (ends, width) = axis(r);
    polyline("A-WALL", &ends, false).replace("|70|0|", &format!("|70|0|43|{width}|"))
}

/// Two leaves with a cavity between them, where the wall is a partition.
fn leaves(r: Rect) -> String {
    let [x0, y0, x1, y1] = r;
    match axis(r) {
        (_, t) if t > 0.2 => ring(r),
        ([a, b], _) if a[1] == b[1] => ring([x0, y0, x1, y0 + 0.04]) + &ring([x0, y0 + 0.06, x1, y1]),
        _ => ring([x0, y0, x0 + 0.04, y1]) + &ring([x0 + 0.06, y0, x1, y1]),
    }
}

/// What a mark of a metre both ways leaves of a wall, by its box, its text and how far it goes.
const MARKS: [(Rect, &str, [f64; 2]); 3] = [
    ([3.9, 0.2, 4.2, 6.8], "x", [-1.0, 0.4]),
    ([3.95, 3.3, 8.8, 3.6], "y", [-1.0, 0.2]),
    ([6.4, 3.45, 6.7, 6.8], "x", [-0.9, 1.0]),
];

/// What moves by default: names and ways.
const DEFAULTS: [(&str, [f64; 2]); 6] = [
    ("wall-1", [-0.6, 0.4]),
    ("door-1", [-0.5, 0.5]),
    ("wall-2", [-0.6, 0.2]),
    ("door-2", [0.0, 0.5]),
    ("wall-3", [-0.4, 0.6]),
    ("door-3", [0.0, 0.5]),
];

fn check(entities: &str) -> CheckResult {
    let settings = Settings::new(Partial::default()).unwrap();
    let mut text = drawing(entities);
    if entities.contains("INSERT") {
        let section = "0\nSECTION\n2\nENTITIES";
        text = text.replace(section, &(blocks().replace('|', "\n") + section));
    }
    enfilade_pipeline::check(&Input::new("flat.dxf", text.as_bytes(), 1), &settings).unwrap().result
}

fn ways(result: &CheckResult) -> Vec<(String, [f64; 2])> {
    let rounded = |v: f64| (v * 1e3).round() / 1e3;
    result.moves.iter().map(|m| (m.name.clone(), [rounded(m.lower), rounded(m.upper)])).collect()
}

fn marked(entities: &str, (outline, way, _): (Rect, &str, [f64; 2])) -> CheckResult {
    let [x, y] = [outline[0] + 0.01, f64::midpoint(outline[1], outline[3])];
    let text = format!("0|TEXT|8|EF-MOVE|10|{x}|20|{y}|40|0.1|1|{way} -1 1|");
    check(&(entities.to_owned() + &polyline("EF-MOVE", &corners(outline), true) + &text))
}

/// Every wall as a block of its own.
fn blocks() -> String {
    let block = |(i, r): (usize, Rect)| {
        let [w, h] = [r[2] - r[0], r[3] - r[1]];
        let own = polyline("A-WALL", &corners([0.0, 0.0, w, h]), true);
        format!("0|BLOCK|2|W{i}|10|0|20|0|{own}0|ENDBLK|")
    };
    let all: String = WALLS.into_iter().enumerate().map(block).collect();
    format!("0|SECTION|2|BLOCKS|{all}0|ENDSEC|")
}

fn inserts() -> String {
    let insert = |(i, r): (usize, Rect)| format!("0|INSERT|8|A-WALL|2|W{i}|10|{}|20|{}|50|0|", r[0], r[1]);
    WALLS.into_iter().enumerate().map(insert).collect()
}

/// A straight multiline of two faces.
fn multiline(r: Rect) -> String {
    let ([[x0, y0], [x1, y1]], t) = axis(r);
    let (dx, dy) = if y0 == y1 { (1, 0) } else { (0, 1) };
    let corner = |x: f64, y: f64| {
        let face = |side: f64| format!("74|2|41|{}|41|0|75|0|", side * t / 2.0);
        format!("11|{x}|21|{y}|12|{dx}|22|{dy}|13|{}|23|{dx}|{}{}", -dy, face(1.0), face(-1.0))
    };
    format!(
        "0|MLINE|8|A-WALL|2|STANDARD|40|{t}|70|1|71|1|72|2|73|2|10|{x0}|20|{y0}|{}{}",
        corner(x0, y0),
        corner(x1, y1)
    )
}

#[test]
fn a_flat_moves_alike_however_it_is_drawn() {
    let drawn = [
        ("boxes", boxes(ring)),
        ("boxes of lines", boxes(|r| sides(&corners(r)))),
        ("face lines", sides(&OUTLINE)),
        ("one outline", polyline("A-WALL", &OUTLINE, true)),
        ("two leaves", boxes(leaves)),
        ("blocks", inserts()),
    ];
    for (name, entities) in &drawn {
        let expected: Vec<(String, [f64; 2])> = DEFAULTS.map(|(n, way)| (n.to_owned(), way)).to_vec();
        assert_eq!(ways(&check(entities)), expected, "{name}");
        for mark in MARKS {
            let [(_, way)] = &ways(&marked(entities, mark))[..] else { panic!("{name} {mark:?}") };
            let differs = (0..2).any(|k| (way[k] - mark.2[k]).abs() > 0.002);
            assert!(!differs, "{name} {mark:?}: {way:?}");
        }
    }
}

/// The ends of multilines follow the wall that they stand at, however that one is drawn, and other walls follow them.
#[test]
fn multilines_follow_and_are_followed() {
    let is_upright = |r: &Rect| r[0] == 4.0;
    let is_beyond = |r: &Rect| [4.1, 5.5, 6.5].contains(&r[0]);
    let some = |is_one: &dyn Fn(&Rect) -> bool, other: fn(Rect) -> String| {
        boxes(|r| if is_one(&r) { multiline(r) } else { other(r) })
    };
    let drawn = [
        ("all", boxes(multiline)),
        ("at boxes", some(&is_beyond, ring)),
        ("at boxes of lines", some(&is_beyond, |r| sides(&corners(r)))),
        ("beside boxes", some(&is_upright, ring)),
    ];
    for (name, entities) in &drawn {
        for mark in MARKS {
            let [(_, way)] = &ways(&marked(entities, mark))[..] else { panic!("{name} {mark:?}") };
            assert!((0..2).all(|k| (way[k] - mark.2[k]).abs() < 0.001), "{name} {mark:?}: {way:?}");
        }
    }
}

/// Openings and removals are made in the multilines themselves, and measure what was told.
#[test]
fn multilines_are_cut() {
    let text = drawing(&boxes(multiline));
    let (settings, cancel) = (Settings::new(Partial::default()).unwrap(), Cancel::default());
    let input = Input::new("flat.dxf", text.as_bytes(), 1);
    let (listed, _) = works_of(&input, &settings, &cancel).unwrap();
    for kind in ["open", "widen", "remove", "close"] {
        let work = listed.result.works.iter().find(|w| w.kind == kind).unwrap();
        let made = make_works(&input, &settings, &[work.id], &cancel).unwrap();
        assert!(made.tables.is_empty(), "{kind} {:?}", made.report.problems);
        assert!((made.expected - made.gain).abs() < 1e-3, "{kind}: {} {}", made.expected, made.gain);
    }
}

/// Lines drawn as wide as walls, and walls of single lines: joints lie on the axes there.
#[test]
fn a_flat_of_axes_moves_nearly_alike() {
    let single = |r: Rect| {
        let ([[x0, y0], [x1, y1]], t) = axis(r);
        // Single lines meet in their axes.
        let ends = |v: f64| match (v * 100.0).round() as i64 {
            30 if t < 0.2 || x0 == x1 => 0.15,
            670 if t < 0.2 || x0 == x1 => 6.85,
            870 => 8.85,
            410 => 4.05,
            350 => 3.45,
            0 if t > 0.2 => 0.15,
            900 if t > 0.2 => 8.85,
            _ => v,
        };
        line("A-WALL", [ends(x0), ends(y0), ends(x1), ends(y1)])
    };
    for (name, entities, slack) in [("wide", boxes(wide), 0.06), ("single", boxes(single), 0.06)] {
        let found = ways(&check(&entities));
        assert_eq!(found.len(), DEFAULTS.len(), "{name}: {found:?}");
        for ((other, way), (expected, wanted)) in found.iter().zip(DEFAULTS) {
            let is_near = (0..2).all(|k| (way[k] - wanted[k]).abs() < slack);
            assert!(other == expected && is_near, "{name} {other}: {way:?} for {wanted:?}");
        }
    }
}

/// A cupboard that stands at a partition follows it up to what stands before it; a built-in one holds the wall.
#[test]
fn furniture_goes_along_with_its_wall() {
    let with = |block: &str, at: [f64; 2], more: &str| {
        let insert = format!("0|INSERT|5|AB|8|A-FURN|2|{block}|10|{}|20|{}|50|0|", at[0], at[1]);
        let entities = boxes(ring) + &insert + more;
        let ring = polyline("0", &corners([0.0, 0.0, 0.6, 1.2]), true);
        let blocks = format!("0|SECTION|2|BLOCKS|0|BLOCK|2|{block}|10|0|20|0|{ring}0|ENDBLK|0|ENDSEC|");
        let text = drawing(&entities).replace('\n', "|");
        let text =
            text.replace("0|SECTION|2|ENTITIES", &(blocks + "0|SECTION|2|ENTITIES")).replace('|', "\n");
        let settings = Settings::new(Partial::default()).unwrap();
        let result =
            enfilade_pipeline::check(&Input::new("flat.dxf", text.as_bytes(), 1), &settings).unwrap();
        let (moves, ways) = (&result.result.moves, ways(&result.result));
        let is_it = |k: &usize| moves[*k].name.starts_with("wall") && ways[*k].1[1] == 0.4;
        (0..moves.len()).find(is_it).map(|k| ways[k].1)
    };
    let alone = Some([-0.6, 0.4]);
    assert_eq!(with("WARDROBE", [3.4, 1.0], ""), alone);
    assert_eq!(with("WARDROBE", [2.0, 1.0], ""), alone, "it stands free");
    assert_eq!(with("KITCHEN-UNIT", [3.4, 1.0], ""), None);
    // A table before it ends its way.
    let table = line("A-FURN", [3.1, 1.2, 3.1, 1.9]);
    assert_eq!(with("WARDROBE", [3.4, 1.0], &table), Some([-0.25, 0.4]));
}

//! What strangers do with the program: names that are almost right, drawings of their own on our layers, texts at doors.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a failing helper fails the test")]

use std::fmt::Write;
use std::time::{Duration, Instant};

use enfilade_cad::drawing::{Addition, Mark};
use enfilade_cad::dxf::{ReadOptions, patch, read, strip_own};
use enfilade_cad::own_layers::{BEFORE, BEFORE_RGB, MOVED, MOVED_RGB, NOTE, NOTE_RGB};
use enfilade_config::{Partial, Settings};
use enfilade_overlay::result::{CheckResult, MoveEntry};
use enfilade_pipeline::Input;
use enfilade_report::{Cancel, Report};
use glam::DVec2;

/// A drawing in metres with `entities`, in lines joined by `|`.
fn drawing(entities: &str) -> String {
    let text = format!(
        "0|SECTION|2|HEADER|9|$ACADVER|1|AC1024|9|$INSUNITS|70|6|0|ENDSEC|0|SECTION|2|ENTITIES|{entities}0|ENDSEC|0|EOF|"
    );
    text.replace('|', "\n")
}

fn line(layer: &str, [x0, y0, x1, y1]: [f64; 4]) -> String {
    format!("0|LINE|8|{layer}|10|{x0}|20|{y0}|11|{x1}|21|{y1}|")
}

fn ring(layer: &str, [x0, y0, x1, y1]: [f64; 4]) -> String {
    let mut out = format!("0|LWPOLYLINE|8|{layer}|90|4|70|1|");
    for [x, y] in [[x0, y0], [x1, y0], [x1, y1], [x0, y1]] {
        write!(out, "10|{x}|20|{y}|").unwrap();
    }
    out
}

fn text(layer: &str, [x, y]: [f64; 2], words: &str) -> String {
    format!("0|TEXT|8|{layer}|10|{x}|20|{y}|40|0.1|1|{words}|")
}

/// A room of 10 x 8 m with a wall of two faces that stands free.
fn room() -> String {
    let walls = [[0.0, 0.0, 10.0, 0.0], [10.0, 0.0, 10.0, 8.0], [10.0, 8.0, 0.0, 8.0], [0.0, 8.0, 0.0, 0.0]];
    let free = [[4.0, 4.0, 6.0, 4.0], [4.0, 4.1, 6.0, 4.1]];
    walls.into_iter().chain(free).map(|w| line("WALL", w)).collect()
}

fn check(file: &str) -> enfilade_pipeline::Outcome<CheckResult> {
    let settings = Settings::new(Partial::default()).unwrap();
    enfilade_pipeline::check(&Input::new("plan.dxf", file.as_bytes(), 1), &settings).unwrap()
}

fn said(report: &Report, code: &str) -> Vec<String> {
    report.problems.iter().filter(|p| p.code == code).map(ToString::to_string).collect()
}

/// One count of columns for people and for programs, and walls told apart from what draws them.
#[test]
fn json_counts_what_the_text_counts() {
    let column = |x: f64| {
        let [a, b] = [x, x + 0.3];
        let sides = [[a, 2.0, b, 2.0], [b, 2.0, b, 2.3], [b, 2.3, a, 2.3], [a, 2.3, a, 2.0]];
        sides.map(|s| line("COLUMNS", s)).concat()
    };
    let result = check(&drawing(&(room() + &column(2.0) + &column(7.0)))).result;
    assert_eq!((result.walls, result.wall_elements, result.columns), (14, 14, 2), "{:?}", result.statements);
    let told = format!("{} walls and {} columns understood", result.walls_understood, result.columns);
    assert!(result.statements.iter().any(|s| s.starts_with(&told)), "{told}: {:?}", result.statements);
}

/// A mark on a layer with a name that is almost right: a bound drawing's is the layer itself; of any other it is said
/// where, and how it is spelt, and nothing moves by default.
#[test]
fn marks_on_misnamed_layers_are_not_passed_over() {
    let marked = |layer: &str| {
        let mark = ring(layer, [3.5, 3.5, 6.5, 4.5]) + &text(layer, [4.0, 4.3], "x -1 1");
        check(&drawing(&(room() + &mark)))
    };
    for layer in ["EF-MOVE", "ef-move ", "xref$0$EF-MOVE", "xref$0$ef-move"] {
        let done = marked(layer);
        assert_eq!(done.result.moves.len(), 1, "{layer}: {:?}", done.report);
        assert_eq!(said(&done.report, "marker-misnamed"), [""; 0]);
    }
    for layer in ["EF_MOVE", "EF MOVE", "EFMOVE", "EF-MOVE-1", "xref$0$EF_MOVE"] {
        let done = marked(layer);
        assert!(done.result.moves.is_empty(), "{layer}: {:?}", done.report);
        let expected = format!(
            "plan.dxf:91 LWPOLYLINE layer {layer}: found the layer {layer:?}, expected EF-MOVE, spelt so; what is drawn \
             there is not read, and nothing moves by default"
        );
        assert_eq!(said(&done.report, "marker-misnamed"), [expected]);
        assert_eq!(said(&done.report, "moves-unread").len(), 1);
    }
    let done = marked("EF-FURN");
    assert!(said(&done.report, "marker-misnamed").is_empty());
    let furniture = done.result.layers.iter().find(|l| l.name == "EF-FURN").unwrap();
    assert_eq!(furniture.taken_as, "ignored", "{}", furniture.reason);
    assert!(!furniture.reason.contains("our "), "{}", furniture.reason);
}

/// Only what we drew comes off our layers.
#[test]
fn what_others_drew_on_our_layers_stays() {
    let own = text(NOTE, [1.0, 1.0], "my own note")
        + &line(NOTE, [1.0, 1.0, 2.0, 1.0])
        + &ring(MOVED, [1.0, 1.0, 2.0, 2.0])
        + "0|TEXT|8|EF-NOTE|62|1|10|1|20|2|40|0.1|1|in red|"
        + &ring("EF-HEAT-DEGREE", [1.0, 1.0, 2.0, 2.0]);
    let file = drawing(&(room() + &own));
    assert_eq!(strip_own(file.as_bytes()), file.as_bytes());
    let path = |x: f64| Mark::Path { points: vec![DVec2::ZERO, DVec2::new(x, 1.0)], closed: false };
    let add = |layer: &str, rgb, mark| Addition { layer: layer.into(), rgb, mark };
    let corners = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y];
    let words = || Mark::Text { at: DVec2::ZERO, height: 0.1, text: "a\nb".into() };
    let ours = [
        add(MOVED, MOVED_RGB, path(1.0)),
        add(BEFORE, BEFORE_RGB, path(2.0)),
        add(NOTE, NOTE_RGB, words()),
        add("EF-HEAT-DEGREE", [1, 2, 3], Mark::Fill { corners }),
        add("EF-HEAT-DEGREE", NOTE_RGB, words()),
    ];
    for version in ["AC1009", "AC1024"] {
        let file = file.replace("AC1024", version);
        let with = patch("plan.dxf", file.as_bytes(), &[], &ours).unwrap();
        assert!(with.len() > file.len());
        let without = String::from_utf8(strip_own(&with)).unwrap();
        assert_eq!(without, file, "{version}");
        let texts =
            read("plan.dxf", without.as_bytes(), &ReadOptions::default(), &mut Report::default()).unwrap();
        assert!(texts.texts.iter().any(|t| t.text == "my own note"), "{version}");
    }
}

/// A drawing with blocks before its entities.
fn with_blocks(blocks: &str, entities: &str) -> String {
    let blocks = format!("0|SECTION|2|BLOCKS|{blocks}0|ENDSEC|").replace('|', "\n");
    let entities_begin = "0\nSECTION\n2\nENTITIES\n";
    drawing(entities).replacen(entities_begin, &(blocks + entities_begin), 1)
}

fn block(name: &str, inside: &str) -> String {
    format!("0|BLOCK|8|0|2|{name}|70|0|10|0|20|0|{inside}0|ENDBLK|8|0|")
}

fn insert(name: &str, [x, y]: [f64; 2]) -> String {
    format!("0|INSERT|8|WALL|2|{name}|10|{x}|20|{y}|")
}

/// Walls that only a block shows which includes itself: that is the reason, and its place.
#[test]
fn a_block_that_includes_itself_is_the_reason() {
    let inside = |other: &str| line("WALL", [0.0, 0.0, 5.0, 0.0]) + &insert(other, [0.0, 0.0]);
    let file = with_blocks(&(block("A", &inside("B")) + &block("B", &inside("A"))), &insert("A", [0.0, 0.0]));
    let settings = Settings::new(Partial::default()).unwrap();
    let error = enfilade_pipeline::check(&Input::new("plan.dxf", file.as_bytes(), 1), &settings).unwrap_err();
    assert_eq!(
        error.to_string(),
        "plan.dxf:101 INSERT layer WALL: a block includes itself: A > B > A; the INSERT is left out; besides it no \
         entity on a wall layer, layers present: none; nothing was measured; name the layer of the walls with \
         --wall-layer NAME"
    );
}

/// A clause that one wall cannot follow is left out alone. Minus signs are read as word processors set them.
#[test]
fn a_turn_that_a_block_cannot_take_is_left_out_alone() {
    let faces = line("WALL", [0.0, 0.0, 2.0, 0.0]) + &line("WALL", [0.0, 0.1, 2.0, 0.1]);
    let moves = |clauses: &str| {
        let mark = ring("EF-MOVE", [3.5, 5.5, 6.5, 6.5]) + &text("EF-MOVE", [4.0, 6.3], clauses);
        let entities = room() + &insert("S", [4.0, 6.0]) + &insert("S", [7.5, 6.0]) + &mark;
        let done = check(&with_blocks(&block("S", &faces), &entities));
        let told = |m: &MoveEntry| format!("{:?} {} {}", m.kind, m.lower, m.upper);
        (done.result.moves.iter().map(told).collect::<Vec<_>>(), done.report)
    };
    let (kinds, report) = moves("x −1 1; y -1 1; rotate –15 15");
    assert_eq!(kinds, ["X -1 1", "Y -1 1"], "{report:?}");
    let why = said(&report, "move-clause-unused");
    assert!(
        matches!(&why[..], [one] if one.ends_with("its turn is left out, its other moves stay")),
        "{why:?}"
    );
    assert!(said(&report, "wall-stays").is_empty());
    let (kinds, report) = moves("rotate -15 15");
    assert!(kinds.is_empty() && !said(&report, "wall-stays").is_empty(), "{report:?}");
}

/// An outline that crosses itself is named; one that merely touches itself is not.
#[test]
fn an_outline_that_crosses_itself_is_named() {
    let outline = |points: &[[f64; 2]]| {
        let head = format!("0|LWPOLYLINE|8|EF-QUERY|90|{}|70|1|", points.len());
        let mark = points.iter().fold(head, |out, [x, y]| out + &format!("10|{x}|20|{y}|"));
        said(&check(&drawing(&(room() + &mark))).report, "marker-crossed").len()
    };
    assert_eq!(outline(&[[1.0, 1.0], [3.0, 3.0], [3.0, 1.0], [1.0, 3.0]]), 1);
    assert_eq!(outline(&[[1.0, 1.0], [3.0, 1.0], [3.0, 3.0], [1.0, 3.0]]), 0);
    let touching = [[1.0, 1.0], [3.0, 1.0], [2.0, 2.0], [3.0, 3.0], [1.0, 3.0], [2.0, 2.0]];
    assert_eq!(outline(&touching), 0);
}

/// What is drawn at an unknown scale is told in the metres that its unit states.
#[test]
fn thicknesses_are_told_in_the_drawings_metres() {
    let thick = |scale: f64| {
        let side = |s: [f64; 4]| line("WALL", s.map(|v| v * scale));
        let wall = |[a, b, c, d]: [f64; 4]| {
            [[a, b, c, b], [c, b, c, d], [c, d, a, d], [a, d, a, b]].map(side).concat()
        };
        let walls =
            [[0.0, 0.0, 12.0, 0.2], [0.0, 7.8, 12.0, 8.0], [0.0, 0.2, 0.2, 7.8], [11.8, 0.2, 12.0, 7.8]];
        let partition =
            [3.0, 6.0, 9.0].into_iter().flat_map(|x| [[x, 0.2, x + 0.2, 3.0], [x, 3.9, x + 0.2, 7.8]]);
        let result =
            check(&drawing(&walls.into_iter().chain(partition).map(wall).collect::<String>())).result;
        assert!(!result.statements.is_empty());
        result.statements.join("\n")
    };
    assert!(thick(1.0).contains("wall thicknesses: 0.20 m ("), "{}", thick(1.0));
    assert!(thick(0.05).contains("wall thicknesses: 0.010 m ("), "{}", thick(0.05));
}

/// A text at a door that goes along with its wall is named: it stays.
#[test]
fn texts_at_a_door_that_moves_are_named() {
    let wall = |[a, b, c, d]: [f64; 4]| {
        [[a, b, c, b], [c, b, c, d], [c, d, a, d], [a, d, a, b]].map(|s| line("WALL", s)).concat()
    };
    let outer = [[0.0, 0.0, 10.0, 0.3], [0.0, 7.7, 10.0, 8.0], [0.0, 0.3, 0.3, 7.7], [9.7, 0.3, 10.0, 7.7]];
    let partition = [[5.0, 0.3, 5.1, 3.0], [5.0, 3.9, 5.1, 7.7]];
    let walls: String = outer.into_iter().chain(partition).map(wall).collect();
    let door = line("DOOR", [5.1, 3.0, 6.0, 3.0]) + "0|ARC|8|DOOR|10|5.1|20|3.0|40|0.9|50|0|51|90|";
    let mark = ring("EF-MOVE", [4.8, 0.2, 5.2, 7.8]) + &text("EF-MOVE", [4.9, 1.0], "x 0 1");
    let words = text("TEXT", [5.4, 3.2], "D1") + &text("TEXT", [8.0, 6.0], "Room");
    let file = drawing(&(walls + &door + &mark + &words));
    let partial = Partial { spacing: Some(0.5), evaluations: Some(40), ..Partial::default() };
    let settings = Settings::new(partial).unwrap();
    let input = Input::new("plan.dxf", file.as_bytes(), 1);
    let done =
        enfilade_pipeline::run(&input, &settings, Instant::now(), &mut |_| {}, &Cancel::default()).unwrap();
    let told = said(&done.report, "stale-annotation");
    assert!(matches!(&told[..], [one] if one.contains("TEXT layer TEXT: ")), "{told:?} {:?}", done.report);
}

/// A wall that stands free, with a door as a block in it.
fn walls_with_a_block(rotation: &str, how: &str) -> String {
    let block = "0|SECTION|2|BLOCKS|0|BLOCK|8|0|2|DR|70|0|10|0|20|0|30|0|3|DR|0|LINE|8|0|10|0|20|0|11|0|21|0.9|\
                 0|ARC|8|0|10|0|20|0|40|0.9|50|0|51|90|0|ENDBLK|0|ENDSEC|";
    let walls =
        room_of(&[[0.0, 0.0, 12.0, 8.0], [0.3, 0.3, 11.7, 7.7], [3.0, 3.4, 5.0, 3.6], [5.9, 3.4, 8.0, 3.6]]);
    let door = format!("0|INSERT|8|A-DOOR|2|DR|10|5|20|3.6|30|0|{rotation}");
    let mark = ring("EF-MOVE", [2.8, 2.4, 8.2, 4.9]) + &text("EF-MOVE", [3.0, 4.4], how);
    let file = drawing(&(walls + &door + &mark));
    file.replacen("0\nSECTION\n2\nENTITIES", &(block.replace('|', "\n") + "0\nSECTION\n2\nENTITIES"), 1)
}

fn room_of(rings: &[[f64; 4]]) -> String {
    rings.iter().map(|r| ring("A-WALL", *r)).collect()
}

/// A door whose block has no rotation to change stays behind where its wall turns: that is said at the mark beforehand.
#[test]
fn what_would_stay_behind_is_said_at_the_mark() {
    let told = |rotation: &str, how: &str| {
        let done = check(&walls_with_a_block(rotation, how));
        assert_eq!(done.result.moves.len(), 1, "{:?}", done.report);
        said(&done.report, "move-leaves-behind")
    };
    let [behind] = told("", "rotate -25 25").try_into().unwrap();
    for words in
        ["LWPOLYLINE layer EF-MOVE: group", "INSERT of layer A-DOOR in line", "no rotation value", "0.001°"]
    {
        assert!(behind.contains(words), "{words}: {behind}");
    }
    assert_eq!(told("50|0|", "rotate -25 25"), [""; 0]);
    assert_eq!(told("", "x -0.5 0.5"), [""; 0]);
}

/// Where all that is drawn lies beyond the limit of coordinates, that is what is said, and where.
#[test]
fn walls_beyond_the_limit_are_said_to_be_too_far() {
    let far = [[3e12, 0.0, 3e12, 8.0], [3e12, 8.0, 3.1e12, 8.0]];
    let file = drawing(&far.into_iter().map(|w| line("WALL", w)).collect::<String>());
    let settings = Settings::new(Partial::default()).unwrap();
    let e = enfilade_pipeline::check(&Input::new("plan.dxf", file.as_bytes(), 1), &settings)
        .unwrap_err()
        .to_string();
    assert!(e.starts_with("plan.dxf:19 LINE layer WALL: its coordinates, found 3000000000000 0"), "{e}");
    assert!(e.contains("and so are others") && e.ends_with("move the drawing near its zero point"), "{e}");
}

/// What stays because a part of it is held is not said to stay for its doors.
#[test]
fn what_is_held_by_keep_is_said_to_be_held() {
    let faces = [[0.3, 0.3, 3.94, 6.7], [4.06, 3.56, 9.7, 6.7]];
    let lower = [[4.06, 0.3, 9.7, 0.3], [9.7, 0.3, 9.7, 3.44], [4.06, 0.3, 4.06, 3.44]];
    let doors =
        [[4.06, 3.44, 5.5, 3.44], [6.4, 3.44, 9.7, 3.44], [5.5, 3.44, 5.5, 3.56], [6.4, 3.44, 6.4, 3.56]];
    let split = [[4.06, 3.56, 5.5, 3.56], [6.4, 3.56, 9.7, 3.56]];
    let sides = [[4.06, 3.56, 4.06, 6.7], [4.06, 6.7, 9.7, 6.7], [9.7, 6.7, 9.7, 3.56]];
    let lines = lower.iter().chain(&doors).chain(&split).chain(&sides).map(|w| line("A-WALL", *w));
    let walls = room_of(&[[0.0, 0.0, 10.0, 7.0], faces[0]]) + &lines.collect::<String>();
    let swing =
        "0|ARC|8|A-DOOR|10|5.5|20|3.56|40|0.9|50|0|51|90|0|LINE|8|A-DOOR|10|5.5|20|3.56|11|5.5|21|4.46|";
    let kept =
        |keep: &str| said(&check(&drawing(&(walls.clone() + swing + keep))).report, "default-moves-stay");
    assert_eq!(kept(""), [""; 0]);
    let held = kept(&ring("EF-KEEP", [3.0, 0.2, 5.0, 7.5]));
    assert!(
        matches!(held.as_slice(), [one] if one.contains("because EF-KEEP holds a part of them")),
        "{held:?}"
    );
}

/// What is drawn with gaps lies above or is to go, by the line's own type or its layer's; a type that only bears another
/// name has none. Where all walls are drawn so, or a whole layer named after them, they are walls.
#[test]
fn lines_with_gaps_are_no_walls() {
    let tables = |layer: &str| {
        let types = [("HIDDEN", 2), ("Style 1", 0)];
        let types = types.map(|(name, pieces)| format!("0|LTYPE|2|{name}|70|0|73|{pieces}|40|1.0|")).concat();
        format!(
            "0|SECTION|2|TABLES|0|TABLE|2|LTYPE|{types}0|ENDTAB|0|TABLE|2|LAYER|0|LAYER|2|UPPER|70|0|6|HIDDEN|\
             0|LAYER|2|INNER WALLS|70|0|6|HIDDEN|0|LAYER|2|WALL|70|0|6|{layer}|0|ENDTAB|0|ENDSEC|0|SECTION|2|ENTITIES|"
        )
        .replace('|', "\n")
    };
    let walls = |layer: &str, across: String| {
        let file = drawing(&(room() + &across));
        let file = file.replace("0\nSECTION\n2\nENTITIES\n", &tables(layer));
        check(&file).result.wall_elements
    };
    let across = line("WALL", [0.0, 2.0, 10.0, 2.0]);
    let of_type = |name: &str| across.replacen("8|WALL|", &format!("8|WALL|6|{name}|"), 1);
    assert_eq!(walls("CONTINUOUS", across.clone()), 7);
    assert_eq!(walls("CONTINUOUS", of_type("HIDDEN")), 6);
    assert_eq!(walls("CONTINUOUS", of_type("Style 1")), 7);
    assert_eq!(walls("CONTINUOUS", line("UPPER", [0.0, 2.0, 10.0, 2.0])), 6);
    assert_eq!(walls("CONTINUOUS", line("INNER WALLS", [0.0, 2.0, 10.0, 2.0])), 7);
    assert_eq!(walls("HIDDEN", across), 7);
}

/// A wall that may lose its whole length keeps some: a file holds no wall of no length, and no round ends for it.
#[test]
fn no_wall_shrinks_to_a_point() {
    let mark = ring("EF-MOVE", [5.8, 3.8, 6.2, 4.3]) + &text("EF-MOVE", [5.9, 4.25], "x -2 0");
    let file = drawing(&(room() + &mark));
    let settings = Settings::new(Partial {
        evaluations: Some(80),
        penalty: Some("none".into()),
        allow: Some("open-joints, narrow-ways".into()),
        pictures: Some(false),
        ..Partial::default()
    })
    .unwrap();
    let input = Input::new("plan.dxf", file.as_bytes(), 1);
    let done =
        enfilade_pipeline::run(&input, &settings, Instant::now(), &mut |_| {}, &Cancel::default()).unwrap();
    let shortened = done.result.candidates.iter().any(|c| !c.changes.is_empty());
    assert!(shortened, "{:?}", done.report);
}

/// A time stated that is too short comes with a word on what it changes.
#[test]
fn too_little_time_is_told() {
    let mark = ring("EF-MOVE", [3.5, 3.5, 6.5, 4.5]) + &text("EF-MOVE", [4.0, 4.3], "x -1 1");
    let file = drawing(&(room() + &mark));
    let with = |seconds: Option<f64>| {
        let partial = Partial { seconds, evaluations: Some(8), pictures: Some(false), ..Partial::default() };
        let settings = Settings::new(partial).unwrap();
        let input = Input::new("plan.dxf", file.as_bytes(), 1);
        // The time was up before it began.
        let started = Instant::now() - Duration::from_secs(10);
        let done =
            enfilade_pipeline::run(&input, &settings, started, &mut |_| {}, &Cancel::default()).unwrap();
        said(&done.report, "hurried").len()
    };
    assert_eq!((with(Some(5.0)), with(None)), (1, 0));
}

//! Odd drawings that are read: what is taken as walls and in which unit, and what is said about it, word for
//! word.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a failing helper fails the test")]

use std::fmt::Write;
use std::time::Instant;

use enfilade_cad::drawing::{Edit, Shape};
use enfilade_cad::dxf::{ReadOptions, patch, read};
use enfilade_config::{Partial, Settings};
use enfilade_engine::interior::Interior;
use enfilade_pipeline::Input;
use enfilade_plan::axes::AxisGraph;
use enfilade_plan::{Plan, PlanOptions, drawn, infill, structure, understand};
use enfilade_report::{Cancel, Error, Report};
use glam::DVec2;

/// A drawing of lines `(layer, [x0, y0, x1, y1])`; `header` and `layers` in lines joined by `|`.
fn drawing(header: &str, layers: &str, lines: &[(&str, [f64; 4])]) -> String {
    let split =
        |text: &str| text.split('|').filter(|l| !l.is_empty()).fold(String::new(), |s, l| s + l + "\n");
    let mut out = split("0|SECTION|2|HEADER") + &split(header) + &split("0|ENDSEC");
    if !layers.is_empty() {
        out += &(split("0|SECTION|2|TABLES|0|TABLE|2|LAYER|70|9")
            + &split(layers)
            + &split("0|ENDTAB|0|ENDSEC"));
    }
    out += &split("0|SECTION|2|ENTITIES");
    for (layer, [x0, y0, x1, y1]) in lines {
        write!(out, "0\nLINE\n8\n{layer}\n10\n{x0}\n20\n{y0}\n11\n{x1}\n21\n{y1}\n").unwrap();
    }
    out + &split("0|ENDSEC|0|EOF")
}

const METRES: &str = "9|$ACADVER|1|AC1024|9|$INSUNITS|70|6";

fn plan_of(bytes: &[u8], options: &PlanOptions) -> (Result<Plan, Error>, Vec<String>) {
    let mut report = Report::default();
    let drawing = read("plan.dxf", bytes, &ReadOptions::default(), &mut report).expect("it is read");
    let plan = understand(&drawing, options, &mut report);
    (plan, report.problems.iter().map(|p| format!("{} {:?} {p}", p.code, p.severity)).collect())
}

fn plain(text: &str) -> (Result<Plan, Error>, Vec<String>) {
    plan_of(text.as_bytes(), &PlanOptions::default())
}

fn refusal(text: &str, options: &PlanOptions) -> String {
    let error = plan_of(text.as_bytes(), options).0.expect_err("must be refused");
    assert_eq!(error.exit_code(), 2);
    error.to_string()
}

fn layer(name: &str, flags: i32, colour: i32) -> String {
    format!("0|LAYER|2|{name}|70|{flags}|62|{colour}|6|CONTINUOUS|")
}

/// The four walls of a room on a layer, one line a wall, metres.
fn room(on: &'static str) -> Vec<(&'static str, [f64; 4])> {
    [[0.0, 0.0, 9.0, 0.0], [9.0, 0.0, 9.0, 9.0], [9.0, 9.0, 0.0, 9.0], [0.0, 9.0, 0.0, 0.0]]
        .map(|l| (on, l))
        .to_vec()
}

/// Hazard 34: no layer has walls, and the user hears which layers there are.
#[test]
fn without_walls_the_layers_are_listed() {
    let none = PlanOptions::default();
    let two =
        [("ROOF", [0.0, 0.0, 5.0, 0.0]), ("EAVES", [0.0, 0.0, 5.0, 0.0]), ("EAVES", [0.0, 3.0, 5.0, 9.0])];
    let end = "nothing was measured; name the layer of the walls with --wall-layer NAME";
    assert_eq!(
        refusal(&drawing(METRES, "", &two), &none),
        format!("plan.dxf: no entity on a wall layer, layers present: EAVES (2), ROOF (1); {end}")
    );
    assert_eq!(
        refusal(&drawing(METRES, "", &[]), &none),
        format!("plan.dxf: no entity on a wall layer, layers present: none; {end}")
    );
    let many: Vec<(String, [f64; 4])> =
        (0..15).map(|i| (format!("DIM{i:02}"), [0.0, f64::from(i), 5.0, f64::from(i * i)])).collect();
    let many: Vec<(&str, [f64; 4])> = many.iter().map(|(l, p)| (l.as_str(), *p)).collect();
    let named: Vec<String> = (0..12).map(|i| format!("DIM{i:02} (1)")).collect();
    assert_eq!(
        refusal(&drawing(METRES, "", &many), &PlanOptions { wall_layers: vec!["WALL*".into()], ..none }),
        format!(
            "plan.dxf: no entity on a wall layer, layers present: {} and 3 more; {end}",
            named.join(", ")
        )
    );
}

/// Where walls are drawn as something else than lines, or on a sheet of paper, that is said with what to do.
#[test]
fn what_is_drawn_otherwise_is_listed_where_no_walls_are_found() {
    let others = "0|HATCH|8|WALL|92|1|72|0|0|MLINE|8|WALL|0|MLINE|8|A-WALL|0|3DFACE|8|WALL\
        |0|LINE|67|1|8|WALL|10|0|20|0|11|5|21|0|0|LINE|67|1|8|WALL|10|0|20|0|11|0|21|5|0|ENDSEC|0|EOF\n";
    let text = drawing(METRES, "", &[]).replacen("0\nENDSEC\n0\nEOF\n", &others.replace('|', "\n"), 1);
    assert_eq!(
        refusal(&text, &PlanOptions::default()),
        "plan.dxf: no entity on a wall layer, layers present: none; not lines: 1 MLINE on A-WALL, 1 3DFACE on WALL, 1 HATCH \
         on WALL, 1 MLINE on WALL; on a sheet of paper: 2 LINE on WALL; nothing was measured; explode filled areas, \
         multilines and faces, or draw their outlines as lines; copy what is drawn on a sheet of paper to model space; \
         name the layer of the walls with --wall-layer NAME"
    );
}

/// Who marks a wall means all the others to stay: where a mark cannot be read, nothing moves by default.
#[test]
fn marks_that_cannot_be_read_let_nothing_move() {
    let mut lines = room("WALL");
    lines.extend([("WALL", [4.0, 4.0, 6.0, 4.0]), ("WALL", [4.0, 5.0, 6.0, 5.0])]);
    let ring = "0|LWPOLYLINE|8|EF-MOVE|90|4|70|1|10|3.5|20|3.5|10|6.5|20|3.5|10|6.5|20|5.5|10|3.5|20|5.5";
    let says = |text: &str| format!("{ring}|0|TEXT|8|EF-MOVE|10|4.0|20|4.5|40|0.1|1|{text}");
    let cases = [
        (String::new(), true, ""),
        ("0|LINE|8|WALL|10|9.0|20|9.0|11|9.0|21|8.0".into(), true, ""),
        (ring.into(), false, "move-without-text"),
        (says("z -1 1"), false, "move-clause"),
        (says("x 1 -1"), false, "move-clause"),
        (says("x nan 1"), false, "move-clause"),
        (says("x -1e9 1e9"), false, "move-clause"),
        (says("x -1 1").replacen("70|1", "70|0", 1), false, "marker-open"),
        ("0|TEXT|8|EF-MOVE|10|4.0|20|4.5|40|0.1|1|x -1 1".into(), false, "move-text-alone"),
        ("0|POINT|8|EF-MOVE|10|4.0|20|4.5".into(), false, "moves-unread"),
        ("0|LWPOLYLINE|8|EF-MOVE|90|1|70|1|10|nan|20|0".into(), false, "dxf-bad-coordinate"),
        (says("x -1 1"), true, ""),
    ];
    for (mark, moves, said) in cases {
        let mut text = drawing(METRES, "", &lines);
        if !mark.is_empty() {
            let end = format!("{mark}|0|ENDSEC|0|EOF\n").replace('|', "\n");
            text = text.replacen("0\nENDSEC\n0\nEOF\n", &end, 1);
        }
        let settings = Settings::new(Partial::default()).unwrap();
        let done = enfilade_pipeline::check(&Input::new("plan.dxf", text.as_bytes(), 1), &settings).unwrap();
        assert_eq!(!done.result.moves.is_empty(), moves, "{mark}: {:?}", done.report);
        let codes: Vec<&str> = done.report.problems.iter().map(|p| p.code).collect();
        assert_eq!(codes.contains(&"moves-unread"), !moves, "{mark}: {codes:?}");
        assert!(said.is_empty() || codes.contains(&said), "{mark}: {codes:?}");
        assert!(moves || !codes.contains(&"default-moves"), "{mark}: {codes:?}");
    }
}

/// Hazard 30: walls that are off or frozen are not taken, and that is said; locked ones are measured and
/// stay; of a bound drawing the name after its prefix counts; the user's wildcards go before all names.
#[test]
fn layers_are_taken_as_a_cad_user_expects() {
    let off = [layer("A-WALL", 0, -7), layer("WAND", 1, 7)].concat();
    let lines =
        [room("A-WALL"), room("WAND"), vec![("EAVES", [0.0, 0.0, 5.0, 0.0]), ("ROOF", [1.0; 4])]].concat();
    assert_eq!(
        refusal(&drawing(METRES, &off, &lines), &PlanOptions::default()),
        "plan.dxf: no entity on a wall layer (off or frozen: A-WALL, WAND), layers present: A-WALL (4), WAND (4), \
         EAVES (1), ROOF (1); nothing was measured; switch what is off on and thaw what is frozen in the drawing, or \
         name another layer with --wall-layer NAME"
    );
    let locked = layer("house$0$A-WALL", 4, 7);
    let lines =
        [room("house$0$A-WALL"), room("site|A-WALL-PATT"), room("../../x"), room("=cmd|' /C calc'!A0")];
    let text = drawing(METRES, &locked, &lines.concat());
    let plan = plain(&text).0.unwrap();
    let roles: Vec<(&str, &str)> = plan.layers.iter().map(|l| (l.name.as_str(), l.role)).collect();
    let expected = [
        ("../../x", "ignored"),
        ("=cmd|' /C calc'!A0", "ignored"),
        ("house$0$A-WALL", "wall"),
        ("site|A-WALL-PATT", "ignored"),
    ];
    assert_eq!(roles, expected);
    let locked = plan.walls.iter().all(|w| {
        w.editable == enfilade_cad::drawing::Editable::No("its layer \"house$0$A-WALL\" is locked".into())
    });
    assert!(locked && plan.walls.len() == 4);
    let options =
        PlanOptions { wall_layers: vec!["=CMD*".into(), "../*/x".into()], ..PlanOptions::default() };
    let plan = plan_of(text.as_bytes(), &options).0.unwrap();
    assert_eq!((plan.walls.len(), plan.layers.iter().filter(|l| l.role == "wall").count()), (8, 2));
}

/// Hazard 30: a hundred thousand layers are no trouble.
#[test]
fn a_hundred_thousand_layers_are_read() {
    let names: Vec<String> = (0..100_000).map(|i| format!("L{i}")).collect();
    let mut lines: Vec<(&str, [f64; 4])> = names.iter().map(|n| (n.as_str(), [0.0, 0.0, 1.0, 1.0])).collect();
    lines.extend(room("Mur"));
    let plan = plain(&drawing(METRES, "", &lines)).0.unwrap();
    assert_eq!((plan.walls.len(), plan.layers.len()), (4, 100_001));
}

/// Hazard 27: names in many code pages are read, decide the walls, and are left to the byte.
#[test]
fn layer_names_of_many_code_pages_are_understood_and_kept() {
    let header = |version: &str, page: &str| match page {
        "" => format!("9|$ACADVER|1|{version}|9|$INSUNITS|70|6"),
        page => format!("9|$ACADVER|1|{version}|9|$DWGCODEPAGE|3|{page}|9|$INSUNITS|70|6"),
    };
    let cases: [(&str, &str, &[u8], &str); 8] = [
        ("AC1015", "ANSI_1252", b"W\xe4nde", "Wände"),
        ("AC1015", "ANSI_932", b"\x95\xc7", "壁"),
        ("AC1009", "", b"_0-9_\x95\xc7__\x91\x8b", "_0-9_壁__窓"),
        ("AC1015", "ANSI_936", b"\xc7\xbd", "墙"),
        ("AC1021", "ANSI_1252", "Wände".as_bytes(), "Wände"),
        ("AC1015", "ANSI_1252", b"W\\U+00E4nde", "Wände"),
        ("AC1021", "ANSI_1252", b"W\xe4nde", "Wände"),
        ("AC1015", "ANSI_1251", b"\xd1\xf2\xe5\xed\xfb", "Стены"),
    ];
    for (version, page, name, expected) in cases {
        let text = drawing(&header(version, page), "", &room("@@")).into_bytes();
        let mut bytes = Vec::new();
        let mut rest = &text[..];
        while let Some(at) = rest.windows(2).position(|w| w == b"@@") {
            bytes.extend([&rest[..at], name].concat());
            rest = &rest[at + 2..];
        }
        bytes.extend(rest);
        let (plan, _) = plan_of(&bytes, &PlanOptions::default());
        let plan = plan.unwrap_or_else(|e| panic!("{expected} in {page}: {e}"));
        assert_eq!(
            (plan.layers[0].name.as_str(), plan.layers[0].role),
            (expected, "wall"),
            "{version} {page}"
        );
        let shape = Shape::Line { a: DVec2::ZERO, b: DVec2::new(7.5, 0.0) };
        let edit = Edit::Shape { record: plan.walls[0].source.record, shape };
        let patched = patch("plan.dxf", &bytes, &[edit], &[]).unwrap();
        let at = bytes.windows(5).position(|w| w == b"11\n9\n").unwrap();
        assert_eq!(patched, [&bytes[..at], b"11\n7.5\n", &bytes[at + 5..]].concat(), "{version} {page}");
    }
}

/// A house of 12 by 8 m with walls of 0.2 m and four doors, times `units` drawing units a metre.
fn house(header: &str, units: f64) -> String {
    let mut lines: Vec<[f64; 4]> = Vec::new();
    let mut wall = |x0: f64, y0: f64, x1: f64, y1: f64| {
        lines.extend([[x0, y0, x1, y0], [x1, y0, x1, y1], [x1, y1, x0, y1], [x0, y1, x0, y0]]);
    };
    wall(0.0, 0.0, 12.0, 0.2);
    wall(0.0, 7.8, 12.0, 8.0);
    wall(0.0, 0.2, 0.2, 7.8);
    wall(11.8, 0.2, 12.0, 7.8);
    for x in [3.0, 6.0, 9.0] {
        wall(x, 0.2, x + 0.2, 3.0);
        wall(x, 3.9, x + 0.2, 7.8);
    }
    let mut walls: Vec<(&str, [f64; 4])> = lines.iter().map(|l| ("WALL", l.map(|v| v * units))).collect();
    let leaves = [3.1, 6.1, 9.1].map(|x| ("DOOR", [x, 3.0, x + 0.9, 3.0].map(|v| v * units)));
    walls.extend(leaves);
    let text = drawing(header, "", &walls);
    let arcs: String = [3.1, 6.1, 9.1]
        .iter()
        .map(|x| {
            format!(
                "0\nARC\n8\nDOOR\n10\n{}\n20\n{}\n40\n{}\n50\n0\n51\n90\n",
                x * units,
                3.0 * units,
                0.9 * units
            )
        })
        .collect();
    text.replacen("0\nENDSEC\n0\nEOF", &(arcs + "0\nENDSEC\n0\nEOF"), 1)
}

/// Hazard 35: a missing or wrong unit is decided by what is drawn, and said; the user's word goes first.
#[test]
fn units_are_decided_by_what_is_drawn() {
    let header = |code: i32| format!("9|$ACADVER|1|AC1024|9|$INSUNITS|70|{code}");
    let seen = "the walls are 12.0 m long, wall faces 0.20 m apart, 3 door leaves of about 0.90 m";
    let cases = [
        (
            0,
            1.0,
            "m",
            format!(
                "unit-assumed Info plan.dxf: unit: m assumed ($INSUNITS 0, no $MEASUREMENT): then {seen}; --unit overrides it"
            ),
        ),
        (
            0,
            1000.0,
            "mm",
            format!(
                "unit-assumed Info plan.dxf: unit: mm assumed ($INSUNITS 0, no $MEASUREMENT): then {seen}; --unit overrides it"
            ),
        ),
        (
            4,
            1.0,
            "m",
            format!(
                "unit-assumed Info plan.dxf: unit: m assumed although the file says mm ($INSUNITS 4, no $MEASUREMENT): then {seen}; in mm the walls are 0.0 m long, wall faces 0.00 m apart, 3 door leaves of about 0.00 m; --unit overrides it"
            ),
        ),
        (
            6,
            1000.0,
            "mm",
            format!(
                "unit-assumed Info plan.dxf: unit: mm assumed although the file says m ($INSUNITS 6, no $MEASUREMENT): then {seen}; in m the walls are 12000.0 m long, wall faces 200.00 m apart, 3 door leaves of about 900.00 m; --unit overrides it"
            ),
        ),
        (
            4,
            1.0 / 0.0254,
            "in",
            format!(
                "unit-assumed Info plan.dxf: unit: in assumed although the file says mm ($INSUNITS 4, no $MEASUREMENT): then {seen}; in mm the walls are 0.5 m long, wall faces 0.01 m apart, 3 door leaves of about 0.04 m; --unit overrides it"
            ),
        ),
        (
            2,
            1.0 / 0.3048,
            "ft",
            format!("unit Info plan.dxf: unit: ft by $INSUNITS 2, no $MEASUREMENT; {seen}"),
        ),
    ];
    for (code, units, name, said) in cases {
        let (plan, problems) = plain(&house(&header(code), units));
        assert_eq!(plan.unwrap().unit.unit.name, name);
        assert_eq!(problems, [said]);
    }
    let options = PlanOptions { unit: enfilade_cad::units::unit_by_name("cm"), ..PlanOptions::default() };
    let (plan, problems) = plan_of(house(&header(4), 1000.0).as_bytes(), &options);
    assert_eq!(plan.unwrap().unit.unit.name, "cm");
    assert_eq!(
        problems,
        [
            "unit Info plan.dxf: unit: cm as --unit or the settings file says (the file: $INSUNITS 4, no $MEASUREMENT)"
        ]
    );
}

/// Hazard 37: what is drawn twice, in overlapping parts, with no length or a hair apart gives the same
/// walls, and the tolerance is said.
#[test]
fn slips_of_the_hand_change_no_wall() {
    let clean: Vec<[f64; 4]> = vec![
        [0.0, 0.0, 9.0, 0.0],
        [9.0, 0.0, 9.0, 9.0],
        [9.0, 9.0, 0.0, 9.0],
        [0.0, 9.0, 0.0, 0.0],
        [4.0, 0.0, 4.0, 6.0],
    ];
    let mut slips = clean.clone();
    slips[0] = [0.0, 0.0, 5.0, 0.0];
    slips.extend([[4.5, 0.0, 9.0, 0.0], [9.0, 0.0, 9.0, 9.0], [3.0, 3.0, 3.0, 3.0]]);
    slips[2] = [9.0, 9.0 + 1e-9, 0.0, 9.0 + 1e-9];
    slips[4] = [4.0, 0.012, 4.0, 6.0];
    let graph = |lines: &[[f64; 4]]| {
        let lines: Vec<(&str, [f64; 4])> = lines.iter().map(|l| ("WALL", *l)).collect();
        let mut report = Report::default();
        let text = drawing(METRES, "", &lines);
        let drawing = read("plan.dxf", text.as_bytes(), &ReadOptions::default(), &mut report).unwrap();
        let plan = understand(&drawing, &PlanOptions::default(), &mut report).unwrap();
        AxisGraph::new(&drawn::drawn(&plan, &drawing).0)
    };
    let shape = |g: &AxisGraph| {
        let cm = |v: f64| (v * 100.0).round() as i64;
        let mut walls: Vec<Vec<[i64; 2]>> =
            g.edges.iter().map(|e| g.ends(e).map(|p| [cm(p.x), cm(p.y)]).to_vec()).collect();
        walls.iter_mut().for_each(|w| w.sort_unstable());
        walls.sort();
        walls
    };
    let (clean, slips) = (graph(&clean), graph(&slips));
    assert_eq!(shape(&clean), shape(&slips));
    assert_eq!(clean.edges.len(), 6);
}

/// A piece of wall forgotten far off is no part of the plan, whatever else is drawn between.
#[test]
fn pieces_forgotten_on_the_sheet_are_left_out() {
    let mut lines: Vec<(&str, [f64; 4])> = Vec::new();
    for (i, j) in (0..6).flat_map(|i| (0..5).map(move |j| (f64::from(i) * 4.0, f64::from(j) * 4.0))) {
        let sides = [[0.0, 0.0, 4.0, 0.0], [4.0, 0.0, 4.0, 4.0], [4.0, 4.0, 0.0, 4.0], [0.0, 4.0, 0.0, 0.0]];
        lines.extend(sides.map(|[x0, y0, x1, y1]| ("WALL", [x0 + i, y0 + j, x1 + i, y1 + j])));
    }
    let between = (0..30).map(|k| ("PATH", [24.0 + 1.5 * f64::from(k), 0.0, 25.5 + 1.5 * f64::from(k), 0.0]));
    lines.extend(between);
    lines.push(("WALL", [69.0, 0.0, 69.5, 0.2]));
    let (plan, problems) = plain(&drawing(METRES, "", &lines));
    assert_eq!(plan.unwrap().walls.len(), 120);
    let said = "stray-walls Info plan.dxf: 1 wall element lies far from the plan and is left out; --view all takes \
                it in";
    assert!(problems.contains(&said.to_string()), "{problems:?}");
}

/// Hazard 32: what hangs on a wall that moves keeps its bytes and is named, once for the whole round; a hatch with
/// an unknown kind of edge is no trouble.
#[test]
fn annotation_of_a_moved_wall_is_named() {
    let mut lines = room("WALL");
    lines.push(("WALL", [4.0, 3.0, 4.0, 6.0]));
    let text = drawing("9|$ACADVER|1|AC1024|9|$INSUNITS|70|6", "", &lines);
    let annotation = "0|DIMENSION|5|C0|8|DIM|13|4.0|23|3.0|14|0.0|24|3.0\
        |0|DIMENSION|5|C1|8|DIM|13|0.0|23|0.0|14|9.0|24|0.0\
        |0|HATCH|5|C2|8|FILL|91|1|92|0|93|1|72|0|10|4.0|20|4.5|97|0|75|0\
        |0|LEADER|5|C3|8|NOTE|10|4.0|20|6.0|10|7.0|20|7.0\
        |0|HATCH|5|C6|8|FILL|91|1|92|0|93|1|72|0|10|4.0|20|4.0|97|0|75|0\
        |0|HATCH|5|C7|8|FILL|91|1|92|0|93|1|72|0|10|4.0|20|3.5|97|0|75|0\
        |0|LWPOLYLINE|5|C4|8|EF-MOVE|90|4|70|1|10|3.5|20|2.5|10|4.5|20|2.5|10|4.5|20|6.5|10|3.5|20|6.5\
        |0|TEXT|5|C5|8|EF-MOVE|10|4.0|20|4.0|40|0.1|1|x -1 1|0|ENDSEC|0|EOF\n";
    let text = text.replacen("0\nENDSEC\n0\nEOF\n", &annotation.replace('|', "\n"), 1);
    let partial = Partial { spacing: Some(1.0), evaluations: Some(5), ..Partial::default() };
    let settings = Settings::new(partial).unwrap();
    let input = Input::new("plan.dxf", text.as_bytes(), 1);
    let done =
        enfilade_pipeline::run(&input, &settings, Instant::now(), &mut |_| {}, &Cancel::default()).unwrap();
    let line = |handle: &str| {
        let at = text.find(&format!("\n5\n{handle}\n")).unwrap();
        // The record begins with its 0, two lines above the handle's code.
        text[..at].lines().count() - 1
    };
    let said: Vec<String> = done
        .report
        .problems
        .iter()
        .filter(|p| p.code == "stale-annotation")
        .map(ToString::to_string)
        .collect();
    let expected =
        [("DIMENSION C0 layer DIM", ""), ("HATCH C2 layer FILL", "(C6, C7)"), ("LEADER C3 layer NOTE", "")]
            .map(|(e, others)| (format!("plan.dxf:{} {e}: ", line(e.split(' ').nth(1).unwrap())), others));
    let holds = |(said, (place, others)): (&String, &(String, &str))| {
        said.starts_with(place) && said.contains(others)
    };
    assert!(said.len() == expected.len() && said.iter().zip(&expected).all(holds), "{said:?}");
    let written = done.files.iter().find(|f| f.path.ends_with("candidate-1.dxf")).unwrap();
    let written = String::from_utf8_lossy(&written.bytes).into_owned();
    for record in annotation.split("|0|").take(6) {
        let record = record.trim_start_matches("0|").replace('|', "\n");
        assert!(written.contains(&record), "{record}");
    }
}

/// Posts every 2 m round `[x, y]` to `[x + w, y + h]`, and the two faces of the walls between them.
fn timber_storey([x, y]: [f64; 2], [w, h]: [i32; 2]) -> Vec<(&'static str, [f64; 4])> {
    let round = (0..w / 2).map(|i| [2 * i, 0]).chain((0..h / 2).map(|j| [w, 2 * j]));
    let round = round.chain((0..w / 2).map(|i| [w - 2 * i, h])).chain((0..h / 2).map(|j| [0, h - 2 * j]));
    let posts: Vec<DVec2> = round.map(|[i, j]| DVec2::new(x + f64::from(i), y + f64::from(j))).collect();
    let mut lines = Vec::new();
    for (i, p) in posts.iter().enumerate() {
        let corners =
            [[-0.06, -0.06], [0.06, -0.06], [0.06, 0.06], [-0.06, 0.06]].map(|c| *p + DVec2::from(c));
        lines.extend((0..4).map(|k| {
            let (a, b) = (corners[k], corners[(k + 1) % 4]);
            ("_0-3_柱", [a.x, a.y, b.x, b.y])
        }));
        let q = posts[(i + 1) % posts.len()];
        let along = (q - *p).normalize() * 0.06;
        lines.extend([-0.04, 0.04].map(|s| {
            let (a, b) = (*p + along + along.perp() * s / 0.06, q - along + along.perp() * s / 0.06);
            ("_0-2_", [a.x, a.y, b.x, b.y])
        }));
    }
    lines
}

/// Two storeys near each other are two drawings however large the elevations below them are, and the plan is where
/// columns are cut.
#[test]
fn storeys_over_one_another_are_told_apart() {
    let mut lines = timber_storey([0.0, 12.0], [12, 8]);
    lines.extend(timber_storey([4.0, 2.0], [8, 6]));
    for k in 0..150 {
        let x = 0.4 * f64::from(k);
        lines.extend([[x, -30.0, x, -14.0], [x, -30.0, x + 0.4, -30.0]].map(|l| ("_0-9_壁", l)));
    }
    let text = drawing(METRES, "", &lines);
    let views = |view: Option<&str>| {
        let options = PlanOptions { view: view.map(Into::into), ..PlanOptions::default() };
        let plan = plan_of(text.as_bytes(), &options).0.unwrap();
        let chosen: Vec<usize> = plan.views.iter().filter(|v| v.is_chosen).map(|v| v.number).collect();
        let on = |layer: &str| plan.walls.iter().filter(|w| w.source.layer == layer).count();
        (plan.views.len(), chosen, on("_0-3_柱"), on("_0-9_壁") > 0)
    };
    assert_eq!(views(None), (3, vec![1], 80, false));
    assert_eq!(views(Some("2")), (3, vec![2], 56, false));
    assert_eq!(views(Some("3")), (3, vec![3], 0, true));
}

/// Two faces of a wall 10 cm apart, beside the line from `a` to `b`.
fn faces(on: &'static str, a: [f64; 2], b: [f64; 2]) -> [(&'static str, [f64; 4]); 2] {
    let (a, b) = (DVec2::from(a), DVec2::from(b));
    let o = (b - a).normalize().perp() * 0.05;
    [o, -o].map(|o| (on, [a.x + o.x, a.y + o.y, b.x + o.x, b.y + o.y]))
}

/// A room of glass before the walls lies inside, whether its glass begins with a pane beside the wall, at the wall's end
/// or on its face; glass that hangs together with nothing, an elevation, does not.
#[test]
fn a_room_of_glass_lies_inside() {
    let rest = [[0.0, 8.5, 12.0, 8.5], [12.0, 8.5, 12.0, 5.0]];
    let by_pane: Vec<[f64; 4]> =
        [[0.0, 5.0, 0.0, 5.9], [0.0, 5.9, 0.0, 8.5]].into_iter().chain(rest).collect();
    let by_end: Vec<[f64; 4]> = [[0.0, 5.0, 0.0, 8.5]].into_iter().chain(rest).collect();
    let front = [([0.0, 5.0], [5.0, 5.0]), ([7.0, 5.0], [12.0, 5.0])];
    let by_face = [[1.0, 5.05, 1.0, 8.5], [1.0, 8.5, 11.0, 8.5], [11.0, 8.5, 11.0, 5.05]];
    glass_lies_inside(&by_pane, &[], 12.0 * 8.5);
    glass_lies_inside(&by_end, &[], 12.0 * 8.5);
    glass_lies_inside(&by_face, &front, 12.0 * 5.0 + 10.0 * 3.5);
}

fn glass_lies_inside(glass: &[[f64; 4]], more: &[([f64; 2], [f64; 2])], area_m2: f64) {
    let mut lines = Vec::new();
    let walls = [([0.0, 5.0], [0.0, 0.0]), ([0.0, 0.0], [12.0, 0.0]), ([12.0, 0.0], [12.0, 5.0])];
    for (a, b) in walls.iter().chain(more) {
        lines.extend(faces("A-WALL", *a, *b));
    }
    let apart =
        [[15.0, 0.0, 17.0, 0.0], [17.0, 0.0, 17.0, 4.0], [17.0, 4.0, 15.0, 4.0], [15.0, 4.0, 15.0, 0.0]];
    lines.extend(glass.iter().chain(&apart).map(|l| ("A-GLAZ", *l)));
    let text = drawing(METRES, "", &lines);
    let drawing = read("plan.dxf", text.as_bytes(), &ReadOptions::default(), &mut Report::default()).unwrap();
    let plan = understand(&drawing, &PlanOptions::default(), &mut Report::default()).unwrap();
    let (axes, _) = structure::axes(&plan, &drawing);
    let closings = infill::infill_lines(&plan, &drawing, &axes);
    let walls: Vec<_> = plan.walls.iter().flat_map(|w| w.trace.segments().map(|s| s.2)).collect();
    let inside = Interior::new(&walls, &closings, plan.human_scale).unwrap();
    assert!((inside.area_m2() - area_m2).abs() < 3.0, "{} {area_m2}", inside.area_m2());
    let [lo, hi] = inside.extent_um().unwrap();
    let size = [0, 1].map(|k| (hi[k] - lo[k]) as f64 / 1e6);
    assert!((size[0] - 12.1).abs() < 0.2 && (size[1] - 8.55).abs() < 0.2, "{size:?}");
}

/// Layers of walls that are off or frozen are named, aloud where no other is.
#[test]
fn layers_of_walls_that_are_hidden_are_named() {
    let mut lines = room("WALL");
    lines.extend(room("A-MISC"));
    for (flags, colour) in [(1, 7), (0, -7)] {
        let layers = layer("WALL", flags, colour) + &layer("A-MISC", 0, 7);
        let (plan, said) = plain(&drawing(METRES, &layers, &lines));
        assert!(plan.is_ok());
        let hidden = "plan.dxf: 1 layer of walls is off or frozen and left out: \"WALL\" (4 elements); switch on or thaw what \
                      should be measured";
        assert!(said.contains(&format!("walls-hidden Warning {hidden}")), "{said:#?}");
        lines.extend(room("WALL-2"));
        let (_, said) = plain(&drawing(METRES, &layers, &lines));
        assert!(said.contains(&format!("walls-hidden Info {hidden}")), "{said:#?}");
        lines.truncate(8);
    }
}

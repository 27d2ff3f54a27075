//! Storeys that a drawing shows over one another: one is read, the others are named; small heights change nothing.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a failing helper fails the test")]

use enfilade_cad::drawing::Drawing;
use enfilade_cad::{Opened, ReadOptions, patch, read};
use enfilade_report::{Error, Report};

fn lines(text: &str) -> String {
    text.split('|').map(|line| format!("{line}\n")).collect()
}

/// How the walls of one storey are drawn, and at which height.
#[derive(Clone, Copy)]
enum Way {
    Lines,
    Polylines,
    OldPolylines,
    TurnedOver,
    InSpace,
    Block,
    /// In a block at a height of its own, with its base point there.
    RaisedBlock,
}

const WAYS: [Way; 7] = [
    Way::Lines,
    Way::Polylines,
    Way::OldPolylines,
    Way::TurnedOver,
    Way::InSpace,
    Way::Block,
    Way::RaisedBlock,
];

fn sides(z: f64, [x, y]: [f64; 2], [w, h]: [f64; 2], rise: f64) -> String {
    let corner = [[x, y], [x + w, y], [x + w, y + h], [x, y + h]];
    let side = |i: usize| {
        let ([a, b], [c, d]) = (corner[i], corner[(i + 1) % 4]);
        format!("|0|LINE|8|A-WALL|10|{a}|20|{b}|30|{z}|11|{c}|21|{d}|31|{}", z + rise)
    };
    (0..4).map(side).collect()
}

/// An outer and an inner ring of walls, of `size`; blocks and entities.
fn storey(name: &str, way: Way, z: f64, at: [f64; 2], size: f64) -> [String; 2] {
    let inner = [at[0] + 0.03 * size, at[1] + 0.03 * size];
    let rings = [(at, [size, size]), (inner, [0.94 * size, 0.94 * size])];
    let all = |one: &dyn Fn([f64; 2], [f64; 2]) -> String| -> String {
        rings.iter().map(|(at, size)| one(*at, *size)).collect()
    };
    let corners = |sign: f64, [x, y]: [f64; 2], [w, h]: [f64; 2], vertex: &dyn Fn(f64, f64) -> String| {
        let all = [[x, y], [x + w, y], [x + w, y + h], [x, y + h]];
        all.iter().map(|[x, y]| vertex(sign * x, *y)).collect::<String>()
    };
    let light = |sign: f64, more: &str| {
        all(&|at, size| {
            let corners = corners(sign, at, size, &|x, y| format!("|10|{x}|20|{y}"));
            format!("|0|LWPOLYLINE|8|A-WALL|90|4|70|1|38|{}{corners}{more}", sign * z)
        })
    };
    let old = |flags: i32, own: f64| {
        all(&|at, size| {
            let corners =
                corners(1.0, at, size, &|x, y| format!("|0|VERTEX|8|A-WALL|10|{x}|20|{y}|30|{z}|70|{flags}"));
            format!(
                "|0|POLYLINE|8|A-WALL|66|1|10|0|20|0|30|{own}|70|{}{corners}|0|SEQEND|8|A-WALL",
                flags / 4 + 1
            )
        })
    };
    let block = |base: f64, inside: f64, insert: f64| {
        let inside = all(&|at, size| sides(inside, at, size, 0.0));
        let block = format!("|0|BLOCK|8|0|2|{name}|70|0|10|0|20|0|30|{base}{inside}|0|ENDBLK");
        [block, format!("|0|INSERT|8|0|2|{name}|10|0|20|0|30|{insert}")]
    };
    let loose = |entities: String| [String::new(), entities];
    match way {
        Way::Lines => loose(all(&|at, size| sides(z, at, size, 0.0))),
        Way::Polylines => loose(light(1.0, "")),
        Way::TurnedOver => loose(light(-1.0, "|210|0|220|0|230|-1")),
        Way::OldPolylines => loose(old(0, z)),
        Way::InSpace => loose(old(32, 0.0)),
        Way::Block => block(0.0, 0.0, z),
        Way::RaisedBlock => block(z, z, z),
    }
}

fn file(unit: Option<i32>, parts: &[[String; 2]]) -> Vec<u8> {
    let unit = unit.map(|u| format!("|9|$INSUNITS|70|{u}")).unwrap_or_default();
    let [blocks, entities] = [0, 1].map(|i| parts.iter().map(|p| p[i].as_str()).collect::<String>());
    lines(&format!(
        "0|SECTION|2|HEADER|9|$ACADVER|1|AC1024{unit}|0|ENDSEC|0|SECTION|2|BLOCKS{blocks}|0|ENDSEC\
         |0|SECTION|2|ENTITIES{entities}|0|ENDSEC|0|EOF"
    ))
    .into_bytes()
}

fn text(layer: &str, said: &str, z: f64) -> [String; 2] {
    [String::new(), format!("|0|TEXT|8|{layer}|10|1|20|1|30|{z}|40|0.1|1|{said}")]
}

fn options(storey: Option<&str>) -> ReadOptions {
    ReadOptions { storey: storey.map(str::to_owned), ..ReadOptions::default() }
}

fn read_storey(bytes: &[u8], storey: Option<&str>) -> Result<(Drawing, Vec<String>), Error> {
    let mut report = Report::default();
    let drawing = read("t.dxf", bytes, &options(storey), &mut report)?;
    Ok((drawing, report.problems.iter().map(|p| format!("{}: {}", p.code, p.text)).collect()))
}

fn names(bytes: &[u8]) -> Vec<String> {
    let found = Opened::new("t.dxf", bytes).unwrap().building(&options(None)).0;
    found.iter().map(|s| format!("{} {:.3} {}", s.name, s.floor_m, s.walls)).collect()
}

#[test]
fn of_storeys_over_one_another_one_is_read() {
    for (i, (lower, upper)) in WAYS.into_iter().flat_map(|a| WAYS.map(|b| (a, b))).enumerate() {
        for (unit, metre) in
            [(Some(4), 1000.0), (Some(6), 1.0), (None, 1000.0), (None, 1.0), (Some(2), 1.0 / 0.3048)]
        {
            let bytes = file(
                unit,
                &[
                    storey("EG", lower, 0.0, [0.0, 0.0], 10.0 * metre),
                    storey("OG", upper, 3.0 * metre, [0.0, 0.0], 9.0 * metre),
                    text("NOTE", "below", 1.0 * metre),
                    text("NOTE", "above", 3.0 * metre),
                ],
            );
            let found = names(&bytes);
            assert_eq!(found.len(), 2, "case {i}, {unit:?}: {found:?}");
            assert!(
                found[0].starts_with("floor 1 0.000 ") && found[1].starts_with("floor 2 3.000 "),
                "{found:?}"
            );
            for (storey, width, note) in
                [("1", 10.0, "below"), ("floor 2", 9.0, "above"), ("storey-2", 9.0, "above")]
            {
                let (drawing, said) = read_storey(&bytes, Some(storey)).unwrap();
                let points =
                    drawing.entities.iter().flat_map(|e| enfilade_cad::curve::control_points(&e.shape));
                let widest = points.map(|p| p.x).fold(0.0, f64::max) / metre;
                assert!((widest - width).abs() < 1e-9, "case {i}, {unit:?}, storey {storey}: {widest}");
                let texts: Vec<&str> = drawing.texts.iter().map(|t| t.text.as_str()).collect();
                assert_eq!((texts, said), (vec![note], vec![]), "case {i}");
            }
        }
    }
}

#[test]
fn the_one_with_most_walls_is_read_and_all_are_named() {
    let size = 10_000.0;
    let more = [String::new(), sides(3000.0, [2000.0, 2000.0], [100.0, 4000.0], 0.0)];
    let ground = storey("EG", Way::Lines, 0.0, [0.0, 0.0], size);
    let upper = storey("OG", Way::Lines, 3000.0, [0.0, 0.0], size);
    let words = |upper: usize, taken: usize| {
        vec![format!(
            "storey: storeys: 1 \"floor 1\" (floor 0.000 m, 8 walls), 2 \"floor 2\" (floor 3.000 m, {upper} walls); \"floor {taken}\" \
             has the most walls and was taken, --storey NAME takes another"
        )]
    };
    let equal = file(Some(4), &[ground.clone(), upper.clone()]);
    let (drawing, said) = read_storey(&equal, None).unwrap();
    assert_eq!((drawing.entities.len(), said), (8, words(8, 1)));
    let bytes = file(Some(4), &[ground, upper, more]);
    let (drawing, said) = read_storey(&bytes, None).unwrap();
    assert_eq!((drawing.entities.len(), said), (12, words(12, 2)));
    let error = read_storey(&bytes, Some("attic")).unwrap_err().to_string();
    assert!(
        error.contains(
            "--storey \"attic\": no such storey, storeys present, by number and name: 1 \"floor 1\""
        ),
        "{error}"
    );
    assert_eq!(patch("t.dxf", &bytes, &options(Some("2")), &[], &[]).unwrap(), bytes);
}

/// Marks that all lie on the ground belong to the storey that is read; at several heights each to its own.
#[test]
fn marks_on_the_ground_are_those_of_the_storey_that_is_read() {
    let two = [0.0, 3000.0].map(|z| storey("X", Way::Lines, z, [0.0, 0.0], 10_000.0));
    let marks = |heights: &[f64]| {
        let marks: Vec<_> = heights.iter().map(|z| text("EF-MOVE", "x -1m 1m", *z)).collect();
        let bytes = file(Some(4), &[&two[..], &marks[..]].concat());
        ["1", "2"].map(|storey| read_storey(&bytes, Some(storey)).unwrap().0.texts.len())
    };
    assert_eq!((marks(&[0.0]), marks(&[0.0, 0.0]), marks(&[0.0, 3000.0, 3000.0])), ([1, 1], [2, 2], [1, 2]));
}

/// What is no pile of storeys is read as ever, whatever heights it states.
#[test]
fn other_heights_change_nothing() {
    let walls = |z: f64, at: [f64; 2]| storey("X", Way::Lines, z, at, 10_000.0);
    let rising = [String::new(), sides(0.0, [0.0, 0.0], [9000.0, 9000.0], 3000.0)];
    let stray = [String::new(), sides(3000.0, [0.0, 0.0], [10.0, 10.0], 0.0)];
    let few = [String::new(), "|0|LINE|8|A-WALL|10|0|20|0|30|3000|11|9999|21|0|31|3000".repeat(3)];
    let door =
        |z: f64| [String::new(), format!("|0|LINE|8|DOOR|10|0|20|0|30|{z}|11|9999|21|0|31|{z}").repeat(40)];
    let o = [0.0, 0.0];
    for (what, parts) in [
        ("flat", vec![walls(0.0, o), walls(0.0, o)]),
        ("all at one height", vec![walls(3000.0, o), walls(3000.0, o)]),
        ("a platform", vec![walls(0.0, o), walls(1500.0, o)]),
        ("above the sea", vec![walls(0.0, o), walls(412_000.0, o)]),
        ("beside one another", vec![walls(0.0, o), walls(3000.0, [20_000.0, 0.0])]),
        ("a model of lines", vec![walls(0.0, o), walls(3000.0, o), rising]),
        ("short strays", vec![walls(0.0, o), stray.clone(), stray]),
        ("few strays", vec![walls(0.0, o), few]),
        ("doors alone", vec![walls(0.0, o), door(3000.0)]),
    ] {
        let bytes = file(Some(4), &parts);
        let count = parts.iter().map(|p| p[1].matches("|0|LINE|").count()).sum::<usize>();
        for storey in [None, Some("2")] {
            let (drawing, said) = read_storey(&bytes, storey).unwrap();
            assert_eq!((drawing.entities.len(), said), (count, vec![]), "{what}");
        }
        assert_eq!(names(&bytes), Vec::<String>::new(), "{what}");
    }
}

/// Walls of one plan that lie at two heights by slips complete each other, and stand nowhere over one another.
#[test]
fn walls_that_complete_each_other_are_one_plan() {
    let outer =
        [String::new(), sides(2.7, [0.0, 0.0], [12.0, 9.0], 0.0) + &sides(2.7, [0.3, 0.3], [11.4, 8.4], 0.0)];
    let partition = |x: f64| format!("|0|LINE|8|A-WALL|10|{x}|20|0.8|30|0|11|{x}|21|8.2|31|0");
    let inner = [String::new(), [4.0, 4.1, 6.0, 6.1, 8.0, 8.1].map(partition).concat()];
    let bytes = file(Some(6), &[outer, inner]);
    let (drawing, said) = read_storey(&bytes, None).unwrap();
    assert_eq!(drawing.entities.len(), 14, "{said:?}");
    assert!(said.iter().all(|s| !s.starts_with("storey")), "{said:?}");
}

/// What is drawn on a storey lies at its height, and is read with it alone.
#[test]
fn additions_lie_on_the_storey_that_is_read() {
    use enfilade_cad::drawing::{Addition, Mark};
    use glam::DVec2;

    let [low, high] = [0.0, 3.0].map(|z| storey("W", Way::Lines, z, [0.0, 0.0], 10.0));
    let bytes = file(Some(6), &[low, high]);
    let path = Mark::Path { points: vec![DVec2::new(1.0, 1.0), DVec2::new(2.0, 1.0)], closed: false };
    let addition = Addition { layer: "EF-NEW".into(), rgb: [0; 3], mark: path };
    let written = patch("t.dxf", &bytes, &options(Some("2")), &[], &[addition]).unwrap();
    let on = |storey: &str| {
        let (drawing, _) = read_storey(&written, Some(storey)).unwrap();
        drawing.entities.iter().filter(|e| e.layer == "EF-NEW").count()
    };
    assert_eq!([on("1"), on("2")], [0, 1]);
}

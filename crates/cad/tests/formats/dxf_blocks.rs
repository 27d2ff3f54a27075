//! Blocks that are shown once: what they hold is changed in their definition, and read again where it was meant.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a failing helper fails the test")]

use crate::support::{moved_shape, read_whole};
use enfilade_cad::curve::control_points;
use enfilade_cad::drawing::{Drawing, Edit, Editable, Entity, RigidMotion, Shape};
use enfilade_cad::dxf::{changed_records, patch};
use enfilade_report::Severity;
use glam::DVec2;
use proptest::prelude::*;

fn lines(text: &str) -> String {
    text.split('|').map(|line| format!("{line}\n")).collect()
}

fn drawing(blocks: &[String], entities: &str) -> Vec<u8> {
    let blocks: String = blocks.iter().map(|b| lines(b)).collect();
    let text = lines(
        "0|SECTION|2|HEADER|9|$ACADVER|1|AC1024|9|$INSUNITS|70|4|0|ENDSEC|0|SECTION|2|TABLES\
         |0|TABLE|2|LAYER|70|1|0|LAYER|2|ICE|70|1|62|7|0|ENDTAB|0|ENDSEC|0|SECTION|2|BLOCKS",
    ) + &blocks
        + &lines("0|ENDSEC|0|SECTION|2|ENTITIES")
        + &lines(entities)
        + &lines("0|ENDSEC|0|EOF");
    text.into_bytes()
}

fn block(name: &str, inside: &str) -> String {
    format!("0|BLOCK|8|0|2|{name}|70|0|10|0|20|0|{inside}|0|ENDBLK")
}

fn insert(name: &str) -> String {
    format!("0|INSERT|5|F{name}|8|W|2|{name}|10|0|20|0")
}

/// One of every kind that is edited by itself, millimetres, a house across.
const HOUSE: &str = "0|LINE|5|A0|8|WALL|10|0.0|20|0.0|30|0.0|11|10000.25|21|0.1|31|0.0\
    |0|LWPOLYLINE|5|A1|8|WALL|90|3|70|1|10|0.0|20|0.0|10|3000.0|20|0.0|10|3000.0|20|2000.0\
    |0|LWPOLYLINE|5|A2|8|WALL|90|2|70|0|10|7000.0|20|1000.0|42|0.25|10|9000.0|20|1000.0|210|0.0|220|0.0|230|-1.0\
    |0|POLYLINE|5|A3|8|WALL|66|1|10|0.0|20|0.0|30|0.0|70|0|0|VERTEX|5|A4|8|WALL|10|5000.0|20|5000.0|42|0.3\
    |0|VERTEX|5|A5|8|WALL|10|6000.0|20|5000.0|0|SEQEND|5|A6|8|WALL\
    |0|ARC|5|A7|8|DOOR|10|2000.0|20|8000.0|40|900.0|50|350.0|51|80.0\
    |0|ARC|5|A8|8|DOOR|10|2000.0|20|8000.0|40|900.0|50|350.0|51|80.0|210|0.0|220|0.0|230|-1.0\
    |0|CIRCLE|5|A9|8|COLUMN|10|1200.0|20|3000.0|40|200.0\
    |0|SPLINE|5|AA|8|WALL|71|1|40|0|40|0|40|1|40|1|10|100.0|20|100.0|10|200.0|20|300.0";

const LINE: &str = "0|LINE|5|B0|8|WALL|10|0|20|0|11|9000|21|0";

/// How one INSERT of a chain shows the next block.
#[derive(Clone, Debug)]
struct Link {
    base: [f64; 2],
    at: [f64; 2],
    scale: [f64; 2],
    turn_deg: f64,
    is_turned_over: bool,
}

fn link() -> impl Strategy<Value = Link> {
    let place = || [-30_000.0..30_000.0f64, -30_000.0..30_000.0];
    let scale = (0.05..20.0f64, any::<[bool; 2]>(), 0.2..5.0f64, any::<bool>());
    (place(), place(), scale, prop_oneof![Just(0.0), Just(90.0), -200.0..200.0f64], any::<bool>()).prop_map(
        |(base, at, (size, is_mirrored, stretch, is_stretched), turn_deg, is_turned_over)| {
            let signs = is_mirrored.map(|m| if m { -1.0 } else { 1.0 });
            let stretch = if is_stretched { stretch } else { 1.0 };
            Link { base, at, scale: [size * signs[0], size * stretch * signs[1]], turn_deg, is_turned_over }
        },
    )
}

fn chain(links: &[Link]) -> Vec<u8> {
    let inserted = |i: usize, l: &Link| {
        let normal = if l.is_turned_over { "|210|0|220|0|230|-1" } else { "" };
        let ([x, y], [sx, sy], turn) = (l.at, l.scale, l.turn_deg);
        format!("0|INSERT|5|F{i}|8|W|2|K{i}|10|{x}|20|{y}|41|{sx}|42|{sy}|50|{turn}{normal}")
    };
    let block = |i: usize, inside: String| {
        let [x, y] = links[i].base;
        format!("0|BLOCK|8|0|2|K{i}|70|0|10|{x}|20|{y}|{inside}|0|ENDBLK")
    };
    let blocks: Vec<String> = (0..links.len())
        .map(|i| block(i, links.get(i + 1).map_or_else(|| HOUSE.to_owned(), |l| inserted(i + 1, l))))
        .collect();
    drawing(&blocks, &inserted(0, &links[0]))
}

fn largest(shape: &Shape) -> f64 {
    control_points(shape).iter().map(|p| p.abs().max_element()).fold(1.0, f64::max)
}

/// The largest distance between two shapes' corners.
fn apart(a: &Shape, b: &Shape) -> f64 {
    let (a, b) = (control_points(a), control_points(b));
    assert_eq!(a.len(), b.len());
    a.iter().zip(&b).map(|(p, q)| p.distance(*q)).fold(0.0, f64::max)
}

fn edit_of(e: &Entity, motion: &RigidMotion) -> Option<Edit> {
    let record = e.source.record;
    match &e.editable {
        Editable::Free => Some(Edit::Shape { record, shape: moved_shape(&e.shape, motion) }),
        Editable::WithInsert { turnable: true } => Some(Edit::Insert { record, motion: *motion }),
        Editable::WithInsert { .. } if motion.turn_rad == 0.0 => {
            Some(Edit::Insert { record, motion: *motion })
        }
        _ => None,
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]

    /// Every entity comes back where it was meant to, by less than a tenth of a micrometre; the others do not stir.
    #[test]
    fn what_a_chain_shows_is_moved_in_its_definition(
        links in proptest::collection::vec(link(), 1..4),
        turns in any::<bool>(),
        shift in [-5_000.0..5_000.0f64, -5_000.0..5_000.0],
        which in 0usize..8,
    ) {
        let bytes = chain(&links);
        let (before, _) = read_whole("plan.dxf", &bytes);
        prop_assert_eq!(before.entities.len(), 8);
        let same: Vec<Edit> = before.entities.iter().filter(|e| e.editable == Editable::Free).map(|e| {
            Edit::Shape { record: e.source.record, shape: e.shape.clone() }
        }).collect();
        prop_assert!(same.len() >= 2, "straight lines are edited under any map");
        prop_assert!(patch("plan.dxf", &bytes, &same, &[]).unwrap() == bytes);
        let motion = RigidMotion { turn_rad: if turns { 0.7 } else { 0.0 }, shift: DVec2::from_array(shift) };
        let moved = &before.entities[which];
        let Some(edit) = edit_of(moved, &motion) else {
            return Ok(());
        };
        let (after, _) = read_whole("plan.dxf", &patch("plan.dxf", &bytes, &[edit], &[]).unwrap());
        for (i, (a, b)) in after.entities.iter().zip(&before.entities).enumerate() {
            prop_assert_eq!(&a.source.handle, &b.source.handle);
            if i == which {
                let off = apart(&a.shape, &moved_shape(&b.shape, &motion));
                prop_assert!(off < 1e-4 + 1e-13 * largest(&b.shape), "{} {:?}", off, b);
            } else {
                prop_assert_eq!(&a.shape, &b.shape);
            }
        }
    }

    /// A vertex that did not move keeps its values to the byte. In a block shown a million times as large, less than a unit is
    /// less than the digits that are written.
    #[test]
    fn one_vertex_moves_alone(links in proptest::collection::vec(link(), 1..4), by in 1.0..900.0f64) {
        let bytes = chain(&links);
        let (before, _) = read_whole("plan.dxf", &bytes);
        let mut shape = before.entities[1].shape.clone();
        let Shape::Polyline { vertices, .. } = &mut shape else { panic!("{shape:?}") };
        vertices[1].at += DVec2::new(by, -by);
        let edit = Edit::Shape { record: before.entities[1].source.record, shape: shape.clone() };
        let patched = patch("plan.dxf", &bytes, &[edit], &[]).unwrap();
        let split = |b: &[u8]| String::from_utf8(b.to_vec()).unwrap().lines().map(str::to_owned).collect::<Vec<_>>();
        let (old, new) = (split(&bytes), split(&patched));
        prop_assert_eq!(old.len(), new.len());
        let differ: Vec<&str> = old.iter().zip(&new).filter(|(a, b)| a != b).map(|(a, _)| a.as_str()).collect();
        prop_assert!(!differ.is_empty() && differ.len() <= 2, "{:?}", differ);
        prop_assert!(differ.iter().all(|v| ["3000.0", "0.0"].contains(v)), "{:?}", differ);
        let (after, _) = read_whole("plan.dxf", &patched);
        prop_assert!(apart(&after.entities[1].shape, &shape) < 1e-4 + 1e-13 * largest(&shape));
    }
}

fn no(reason: &str) -> Editable {
    Editable::No(reason.to_owned())
}

fn whole(turnable: bool) -> Editable {
    Editable::WithInsert { turnable }
}

/// What every entity says of its record, its handle and how it is written back, and what is said of the blocks.
fn said(blocks: &[String], entities: &str) -> (Vec<(String, Editable)>, Vec<String>) {
    let (drawing, report) = read_whole("plan.dxf", &drawing(blocks, entities));
    let of = |e: Entity| (format!("{} {}", e.source.kind, e.source.handle.unwrap_or_default()), e.editable);
    let words = report.problems.iter().filter(|p| p.severity == Severity::Info || p.code.contains("block"));
    (drawing.entities.into_iter().map(of).collect(), words.map(|p| format!("{} {p}", p.code)).collect())
}

#[test]
fn only_what_is_shown_once_is_edited_by_itself() {
    let house = block("A", LINE);
    let arc = block("A", "0|ARC|5|B1|8|WALL|10|0|20|0|40|9000|50|0|51|90");
    let line = |editable: Editable| vec![("LINE B0".to_owned(), editable)];
    let by_insert = |editable: Editable| vec![("INSERT FA".to_owned(), editable)];
    let again = |n: usize, line: usize| {
        format!(
            "dxf-block-shown-again plan.dxf:{line} INSERT FA layer W: block A is shown by {n} INSERTs, expected one: what \
             it shows moves only as a whole"
        )
    };
    let one = std::slice::from_ref(&house);
    let turned = insert("A") + "|50|30";
    let flagged = |flags: &str| [house.replace("|70|0|10", &format!("|70|{flags}|10"))];
    let (made, bound) = (flagged("1"), flagged("16"));
    let twice = || [by_insert(whole(false)), by_insert(whole(false))].concat();
    let unused = [house.clone(), block("B", &insert("A"))];
    let array = no("it is shown by an INSERT with rows and columns");
    let stretched = no("it is round and its INSERT stretches it more one way than the other");
    type Case<'c> = (&'c str, &'c [String], String, Vec<(String, Editable)>, Vec<String>);
    let cases: Vec<Case<'_>> = vec![
        ("once", one, insert("A"), line(Editable::Free), vec![]),
        ("turned", one, turned.clone(), line(Editable::Free), vec![]),
        ("twice", one, insert("A") + "|" + &insert("A"), twice(), vec![again(2, 75)]),
        (
            "again on paper",
            one,
            insert("A") + "|" + &insert("A") + "|67|1",
            by_insert(whole(false)),
            vec![again(2, 75)],
        ),
        (
            "again in a block that nothing shows",
            &unused,
            insert("A"),
            by_insert(whole(false)),
            vec![again(2, 101)],
        ),
        (
            "array",
            one,
            insert("A") + "|70|2|44|20000",
            [by_insert(array.clone()), by_insert(array)].concat(),
            vec![],
        ),
        ("anonymous", &made, turned, by_insert(whole(true)), vec![]),
        ("of an xref", &bound, insert("A"), by_insert(whole(false)), vec![]),
        ("stretched line", one, insert("A") + "|41|2|42|1", line(Editable::Free), vec![]),
        (
            "stretched arc",
            std::slice::from_ref(&arc),
            insert("A") + "|41|2|42|1",
            vec![("ARC B1".into(), stretched)],
            vec![],
        ),
        (
            "mirrored arc",
            std::slice::from_ref(&arc),
            insert("A") + "|41|-2|42|2",
            vec![("ARC B1".into(), Editable::Free)],
            vec![],
        ),
        (
            "on a frozen layer",
            one,
            insert("A").replace("|8|W|", "|8|ICE|"),
            by_insert(whole(false)),
            vec![
                "dxf-hidden plan.dxf: the drawing hides what may be walls: 1 in blocks on the hidden layer \"ICE\"; left out of \
                 the plan; show it if it should be measured"
                    .to_owned(),
            ],
        ),
        ("flat", one, insert("A") + "|41|1e5|42|1", by_insert(whole(false)), vec![]),
        ("far away", one, "0|INSERT|5|FA|8|W|2|A|10|9.1e10|20|0".into(), by_insert(whole(false)), vec![]),
    ];
    for (name, blocks, entities, expected, words) in cases {
        let (found, problems) = said(blocks, &entities);
        let problems: Vec<String> =
            problems.into_iter().filter(|p| !p.contains("duplicate-handle")).collect();
        assert_eq!((found, problems), (expected, words), "{name}");
    }
    let doubled = [house.clone(), house];
    assert_eq!(said(&doubled, &insert("A")).0, by_insert(whole(false)), "two blocks of one name");
}

/// A door, a column or a cupboard goes with all that its INSERT shows; so does what a mark encloses wholly.
#[test]
fn things_and_what_a_mark_encloses_move_as_a_whole() {
    let many: Vec<String> =
        (0..20).map(|y| format!("0|LINE|8|WALL|10|0|20|{0}|11|9000|21|{0}", y * 100)).collect();
    let many = many.join("|");
    let leaf = |length: f64| block("D", &format!("0|LINE|5|C0|8|DOOR|10|0|20|0|11|{length}|21|0"));
    let of_last = |blocks: &[String], entities: &str| said(blocks, entities).0.pop().unwrap();
    let (own, with) = (("LINE C0".to_owned(), Editable::Free), ("INSERT FD".to_owned(), whole(false)));
    for (length, expected) in [(2250.0, &with), (2251.0, &own)] {
        let entities = format!("{many}|{}", insert("D"));
        assert_eq!(&of_last(&[leaf(length)], &entities), expected, "{length}");
    }
    // An eighth of what is drawn is no thing, however short.
    let few = |n: usize| many.split("|0|LINE").take(n).collect::<Vec<_>>().join("|0|LINE");
    for (n, expected) in [(7, &own), (8, &with)] {
        assert_eq!(&of_last(&[leaf(900.0)], &format!("{}|{}", few(n), insert("D"))), expected, "{n}");
    }
    // In a house that is shown once, the INSERT in its definition moves.
    let house = [leaf(900.0), block("H", &format!("{many}|{}", insert("D")))];
    assert_eq!(of_last(&house, &insert("H")), with);
    let mark = |x: f64| {
        let corners = [(-1.0, -1.0), (x, -1.0), (x, 3000.0), (-1.0, 3000.0)];
        let corners: String = corners.iter().map(|(x, y)| format!("|10|{x}|20|{y}")).collect();
        format!("0|LWPOLYLINE|8|ef-move|90|4|70|1{corners}|{}", insert("H"))
    };
    let first = |x: f64| said(&[block("H", &many)], &mark(x)).0[1].1.clone();
    assert_eq!((first(9001.0), first(8999.0)), (whole(false), Editable::Free));
}

/// A thing in a house that is shown once moves by the INSERT in the definition, mirrored and scaled as that is.
#[test]
fn an_insert_in_a_definition_moves_as_it_is_shown() {
    let many: Vec<String> =
        (0..20).map(|y| format!("0|LINE|8|WALL|10|0|20|{0}|11|9000|21|{0}", y * 100)).collect();
    let door = "0|INSERT|5|FD|8|W|2|D|10|100|20|200|50|15";
    let blocks = [
        block("D", "0|LINE|5|C0|8|DOOR|10|0|20|0|11|900|21|0|0|ARC|8|DOOR|10|0|20|0|40|900|50|0|51|90"),
        block("H", &format!("{}|{door}", many.join("|"))),
    ];
    let bytes = drawing(&blocks, "0|INSERT|5|FH|8|W|2|H|10|-4000|20|700|41|-2|42|2|50|40");
    let (before, _) = read_whole("plan.dxf", &bytes);
    let is_door = |e: &&Entity| e.source.handle.as_deref() == Some("FD");
    let doors = |d: &Drawing| d.entities.iter().filter(is_door).cloned().collect::<Vec<_>>();
    assert_eq!(doors(&before).len(), 2);
    for turn_rad in [0.0, 0.4] {
        let motion = RigidMotion { turn_rad, shift: DVec2::new(300.0, -20.0) };
        let edit = Edit::Insert { record: doors(&before)[0].source.record, motion };
        let named = changed_records("plan.dxf", &bytes, std::slice::from_ref(&edit)).unwrap();
        assert_eq!(named[0].iter().filter_map(|r| r.handle.as_deref()).collect::<Vec<_>>(), ["FD"]);
        let (after, _) = read_whole("plan.dxf", &patch("plan.dxf", &bytes, &[edit], &[]).unwrap());
        for (a, b) in doors(&after).iter().zip(doors(&before)) {
            assert!(apart(&a.shape, &moved_shape(&b.shape, &motion)) < 1e-6, "{a:?}");
        }
    }
    // What is shown twice is nobody's to edit.
    let bytes = drawing(&[block("A", LINE)], &(insert("A") + "|" + &insert("A")));
    let edit = Edit::Shape { record: 9, shape: Shape::Line { a: DVec2::ZERO, b: DVec2::X } };
    assert_eq!(
        patch("plan.dxf", &bytes, &[edit], &[]).unwrap_err().to_string(),
        "plan.dxf:53 LINE B0: the edit of record 9: no entity stands there that is shown exactly once; nothing was written"
    );
}

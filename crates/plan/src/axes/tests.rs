//! What is understood of small plans. Whole plans in the styles of offices: `tests/understanding.rs`.

use super::*;
use crate::sizes::CAVITY_MAX_M;

/// Lines of a wall each.
pub fn lines(all: &[[f64; 4]]) -> Drawn {
    let face = |(i, l): (usize, &[f64; 4])| Face {
        wall: i as u32,
        part: 0,
        path: Path::Line { a: DVec2::new(l[0], l[1]), b: DVec2::new(l[2], l[3]) },
        role: Role::Wall,
        is_closed: false,
        width_m: 0.0,
    };
    Drawn { faces: all.iter().enumerate().map(face).collect(), marks: Vec::new() }
}

fn at(graph: &AxisGraph, x: f64, y: f64) -> &Node {
    let p = DVec2::new(x, y);
    graph
        .nodes
        .iter()
        .find(|n| n.at.distance(p) < 1e-6)
        .unwrap_or_else(|| panic!("no node at {p}: {graph:#?}"))
}

#[test]
fn a_corner_of_two_faces() {
    let graph = AxisGraph::new(&lines(&[
        [0.0, 0.0, 5.0, 0.0],
        [0.2, 0.2, 5.0, 0.2],
        [0.0, 0.0, 0.0, 4.0],
        [0.2, 0.2, 0.2, 4.0],
        [5.0, 0.0, 5.0, 0.2],
        [0.0, 4.0, 0.2, 4.0],
    ]));
    assert_eq!(at(&graph, 0.1, 0.1).kind, NodeKind::Corner);
    assert_eq!(at(&graph, 5.0, 0.1).faces, [(4, 0)]);
    assert_eq!((graph.nodes.len(), graph.edges.len(), graph.openings.len()), (3, 2, 0));
    assert!(graph.edges.iter().all(|e| (e.thickness_m - 0.2).abs() < 1e-9));
    assert_eq!(graph.leftovers, []);
}

#[test]
fn a_tee_whose_stem_interrupts_one_face() {
    let graph = AxisGraph::new(&lines(&[
        [0.0, 0.0, 6.0, 0.0],
        [0.0, 0.3, 2.0, 0.3],
        [2.1, 0.3, 6.0, 0.3],
        [2.0, 0.3, 2.0, 3.0],
        [2.1, 0.3, 2.1, 3.0],
    ]));
    assert_eq!(at(&graph, 2.05, 0.15).kind, NodeKind::Tee);
    assert_eq!((graph.nodes.len(), graph.edges.len()), (4, 3));
}

#[test]
fn a_gap_of_a_hand_is_closed_and_a_passage_stays() {
    let faces = |gap: f64| {
        [[0.0, 0.0, 3.0, 0.0], [0.0, 0.1, 3.0, 0.1], [3.0 + gap, 0.0, 6.0, 0.0], [3.0 + gap, 0.1, 6.0, 0.1]]
    };
    let slip = AxisGraph::new(&lines(&faces(0.015)));
    assert_eq!((slip.edges.len(), slip.openings.len(), slip.closures.len()), (1, 0, 2));
    let passage = AxisGraph::new(&lines(&faces(0.9)));
    assert_eq!((passage.edges.len(), passage.openings.len()), (2, 1));
    assert_eq!(passage.openings[0].kind, OpeningKind::Passage);
    assert!((passage.openings[0].width_m - 0.9).abs() < 1e-9);
}

/// A wall 6 m long drawn through, with two lines across it 1.2 m apart.
fn through() -> Drawn {
    lines(&[
        [0.0, 0.0, 6.0, 0.0],
        [0.0, 0.2, 6.0, 0.2],
        [2.0, 0.0, 2.0, 0.2],
        [3.2, 0.0, 3.2, 0.2],
        [0.0, 0.0, 0.0, 0.2],
        [6.0, 0.0, 6.0, 0.2],
    ])
}

pub fn mark(path: Path, role: Role) -> Mark {
    Mark { paths: vec![path], role, group: 0, is_named: false }
}

#[test]
fn lines_across_a_wall_are_jambs_only_with_a_window_between_them() {
    assert_eq!(AxisGraph::new(&through()).openings, []);
    let mut drawn = through();
    let pane = Path::Line { a: DVec2::new(2.0, 0.1), b: DVec2::new(3.2, 0.1) };
    drawn.marks.push(mark(pane, Role::Unknown));
    let graph = AxisGraph::new(&drawn);
    assert_eq!((graph.edges.len(), graph.openings.len()), (2, 1));
    let opening = &graph.openings[0];
    assert_eq!((opening.kind, &opening.marks), (OpeningKind::Window, &vec![0]));
    assert_eq!(opening.through, [(0, 0), (1, 0)]);
    assert!(opening.centre.distance(DVec2::new(2.6, 0.1)) < 1e-6);
}

/// A door drawn as a box over a wall that goes on below it; a leaf that stands open along one face is no opening.
#[test]
fn a_box_of_a_door_over_a_wall_is_an_opening() {
    let along = |y: f64| mark(Path::Line { a: DVec2::new(2.0, y), b: DVec2::new(2.9, y) }, Role::Door);
    let found = |marks: Vec<Mark>| {
        let mut drawn = lines(&[[0.0, 0.0, 6.0, 0.0], [0.0, 0.2, 6.0, 0.2]]);
        drawn.marks = marks;
        let graph = AxisGraph::new(&drawn);
        graph.openings.iter().map(|o| (o.kind, (o.width_m * 100.0).round())).collect::<Vec<_>>()
    };
    assert_eq!(found(vec![along(-0.02), along(0.22)]), [(OpeningKind::Door, 90.0)]);
    assert_eq!(found(vec![along(0.22), along(0.25)]), []);
    assert_eq!(found(vec![along(0.02), along(0.4)]), []);
}

/// Glass that hangs together from one jamb to the other before the wall is a bay window, in one piece or in several; what
/// ends at one jamb alone, or lies before the gap without reaching it, is none.
#[test]
fn glass_before_a_gap_from_jamb_to_jamb_is_a_bay_window() {
    let corners = [[2.0, 0.2], [2.3, 0.8], [3.7, 0.8], [4.0, 0.2]].map(DVec2::from);
    let sides: Vec<Path> = corners.windows(2).map(|w| Path::Line { a: w[0], b: w[1] }).collect();
    let found = |marks: Vec<Mark>| {
        let mut drawn = lines(&[
            [0.0, 0.0, 2.0, 0.0],
            [0.0, 0.2, 2.0, 0.2],
            [2.0, 0.0, 2.0, 0.2],
            [4.0, 0.0, 4.0, 0.2],
            [4.0, 0.0, 6.0, 0.0],
            [4.0, 0.2, 6.0, 0.2],
        ]);
        drawn.marks = marks;
        let graph = AxisGraph::new(&drawn);
        let [opening] = graph.openings.as_slice() else { panic!("{:?}", graph.openings) };
        (opening.kind, opening.marks.clone())
    };
    let of = |paths: &[Path], role: Role| Mark { paths: paths.to_vec(), ..mark(paths[0], role) };
    let apart: Vec<Mark> =
        sides.iter().enumerate().map(|(i, s)| Mark { group: i as u32, ..mark(*s, Role::Glazing) }).collect();
    assert_eq!(found(vec![of(&sides, Role::Glazing)]), (OpeningKind::Window, vec![0]));
    assert_eq!(found(apart.clone()), (OpeningKind::Window, vec![0, 1, 2]));
    assert_eq!(found(apart[..2].to_vec()), (OpeningKind::Passage, vec![]));
    assert_eq!(found(apart[1..2].to_vec()), (OpeningKind::Passage, vec![]));
    assert_eq!(found(vec![of(&sides, Role::Unknown)]), (OpeningKind::Passage, vec![]));
}

#[test]
fn a_swing_makes_a_door_of_a_gap_and_of_a_wall_drawn_through() {
    let swing = Path::Arc {
        centre: DVec2::new(2.0, 0.2),
        radius: 0.9,
        start_rad: 0.0,
        sweep_rad: std::f64::consts::FRAC_PI_2,
    };
    let faces = [[0.0, 0.0, 6.0, 0.0], [0.0, 0.2, 6.0, 0.2]];
    let gap = [[0.0, 0.0, 2.0, 0.0], [0.0, 0.2, 2.0, 0.2], [2.9, 0.0, 6.0, 0.0], [2.9, 0.2, 6.0, 0.2]];
    for mut drawn in [lines(&faces), lines(&gap)] {
        drawn.marks.push(mark(swing, Role::Unknown));
        let graph = AxisGraph::new(&drawn);
        assert_eq!((graph.edges.len(), graph.openings.len()), (2, 1));
        assert_eq!(graph.openings[0].kind, OpeningKind::Door);
        assert!((graph.openings[0].width_m - 0.9).abs() < 1e-9);
    }
}

#[test]
fn treads_are_no_walls() {
    let treads: Vec<[f64; 4]> =
        (0..9).map(|k| [0.0, 0.28 * f64::from(k), 1.2, 0.28 * f64::from(k)]).collect();
    let mut all = vec![[-3.0, -1.0, 5.0, -1.0], [-3.0, -1.2, 5.0, -1.2]];
    all.extend(treads);
    let graph = AxisGraph::new(&lines(&all));
    assert_eq!((graph.edges.len(), graph.leftovers.len()), (1, 9));
}

#[test]
fn the_order_of_the_lines_does_not_matter() {
    let mut all = vec![
        [0.0, 0.0, 6.0, 0.0],
        [0.0, 0.3, 2.0, 0.3],
        [2.1, 0.3, 6.0, 0.3],
        [2.0, 0.3, 2.0, 3.0],
        [2.1, 0.3, 2.1, 3.0],
    ];
    let sorted = |lines_of: &[[f64; 4]]| {
        let mut at: Vec<[i64; 2]> = AxisGraph::new(&lines(lines_of))
            .nodes
            .iter()
            .map(|n| [(n.at.x * 1e6).round() as i64, (n.at.y * 1e6).round() as i64])
            .collect();
        at.sort_unstable();
        at
    };
    let first = sorted(&all);
    all.reverse();
    for l in &mut all {
        *l = [l[2], l[3], l[0], l[1]];
    }
    assert_eq!(sorted(&all), first);
}

#[test]
fn nothing_drawn_gives_nothing() {
    let graph = AxisGraph::new(&Drawn::default());
    assert_eq!((graph.nodes.len(), graph.edges.len()), (0, 0));
}

/// A gap that lies in a pier leads nowhere; one before which a wall stands on one side alone may be a way round it.
#[test]
fn a_gap_in_a_pier_is_no_passage() {
    let gap = |beside: &[f64]| {
        let mut all = vec![
            [0.0, 0.0, 3.0, 0.0],
            [0.0, 0.2, 3.0, 0.2],
            [3.9, 0.0, 7.0, 0.0],
            [3.9, 0.2, 7.0, 0.2],
            [3.0, 0.0, 3.0, 0.2],
            [3.9, 0.0, 3.9, 0.2],
        ];
        all.extend(beside.iter().map(|y| [2.9, *y, 4.0, *y]));
        let graph = AxisGraph::new(&lines(&all));
        graph.openings.iter().filter(|o| (o.centre.x - 3.45).abs() < 0.1).count()
    };
    assert_eq!(gap(&[]), 1);
    assert_eq!(gap(&[-0.34, 0.54]), 0);
    assert_eq!(gap(&[-0.34]), 1);
    assert_eq!(gap(&[-0.36, 0.54]), 1);
}

/// A door whose frame is let into both jambs and stands before both faces is a door, however thick its wall is.
#[test]
fn a_door_drawn_round_its_gap_is_no_passage() {
    for thick in [0.2, 0.3, 0.5] {
        let (a, b) = (3.0, 4.0);
        let mut drawn = lines(&[
            [0.0, 0.0, a, 0.0],
            [0.0, thick, a, thick],
            [a, 0.0, a, thick],
            [b, 0.0, 8.0, 0.0],
            [b, thick, 8.0, thick],
            [b, 0.0, b, thick],
        ]);
        let kinds = |drawn: &Drawn| AxisGraph::new(drawn).openings.iter().map(|o| o.kind).collect::<Vec<_>>();
        assert_eq!(kinds(&drawn), [OpeningKind::Passage]);
        let corners = [[a, 0.0], [b, 0.0], [b, thick], [a, thick]];
        let outer = [[-0.05, -0.05], [0.05, -0.05], [0.05, 0.05], [-0.05, 0.05]];
        let corner = |i: usize| DVec2::from(corners[i % 4]) + DVec2::from(outer[i % 4]);
        let mut door = mark(Path::Line { a: corner(0), b: corner(1) }, Role::Door);
        door.paths.extend((1..4).map(|i| Path::Line { a: corner(i), b: corner(i + 1) }));
        drawn.marks = vec![door];
        assert_eq!(kinds(&drawn), [OpeningKind::Door], "{thick}");
    }
}

/// Stubs as long as they are thick, between two doors at a tee: both are wall wherever they stand on the sheet, though
/// their length is then a hair more or less than their thickness.
#[test]
fn stubs_as_long_as_thick_are_wall_wherever_they_stand() {
    let plan = [
        [0.0, 0.0, 2.0, 0.0],
        [0.0, 0.1, 2.0, 0.1],
        [2.0, 0.0, 2.0, 0.1],
        [2.7, 0.0, 2.7, 0.1],
        [2.7, 0.1, 2.8, 0.1],
        [2.7, 0.0, 3.0, 0.0],
        [2.8, 0.1, 2.8, 3.0],
        [2.9, 0.1, 2.9, 3.0],
        [2.9, 0.1, 3.0, 0.1],
        [3.0, 0.0, 3.0, 0.1],
        [3.7, 0.0, 3.7, 0.1],
        [3.7, 0.0, 6.0, 0.0],
        [3.7, 0.1, 6.0, 0.1],
    ];
    for k in 0..200 {
        let (x, y) = (f64::from(k).mul_add(0.917, -61.3), f64::from(k).mul_add(-1.303, 88.7));
        let graph = AxisGraph::new(&lines(&plan.map(|[a, b, c, d]| [a + x, b + y, c + x, d + y])));
        assert_eq!(graph.openings.len(), 2, "{x} {y}: {:?}", graph.openings);
    }
}

/// A post before a wall and a lining at the wall's end leave no door between them along the wall's face.
#[test]
fn a_gap_along_the_face_of_a_wall_is_no_opening() {
    let faces = [
        [0.0, 0.0, 0.0, 5.0],
        [0.1, 0.0, 0.1, 5.0],
        [0.0, 0.0, 0.1, 0.0],
        [0.0, 5.0, 0.1, 5.0],
        [0.1, 0.5, 0.13, 0.5],
        [0.13, 0.5, 0.13, 0.9],
        [0.1, 0.9, 0.13, 0.9],
        [0.1, 2.5, 0.13, 2.5],
        [0.13, 2.5, 0.13, 2.9],
        [0.1, 2.9, 0.13, 2.9],
        [0.1, 0.5, 0.1, 0.9],
        [0.1, 2.5, 0.1, 2.9],
    ];
    let beside = AxisGraph::new(&lines(&faces));
    assert_eq!(beside.openings, []);
    let free = AxisGraph::new(&lines(&faces[4..]));
    assert_eq!(free.openings.len(), 1, "without the wall it is one");
}

/// A wall that swings like a wave, each face traced by chords of its own, in either direction and in any order: one chain
/// of thick walls from end to end without an opening.
#[test]
fn a_free_curve_is_one_wall_however_its_faces_were_traced() {
    let wave = |u: f64| {
        let turn = std::f64::consts::TAU * u;
        let slope = DVec2::new(14.0, 2.0 * std::f64::consts::TAU * turn.cos());
        (DVec2::new(14.0 * u, 2.0 * turn.sin()), slope.normalize().perp())
    };
    let face = |side: f64, chords: usize, shift: f64| {
        let share = |k: usize| if k == 0 || k == chords { k as f64 } else { k as f64 + shift };
        let at = |k: usize| {
            let (p, out) = wave(share(k) / chords as f64);
            p + out * (0.1 * side)
        };
        (0..chords).map(|k| [at(k).x, at(k).y, at(k + 1).x, at(k + 1).y]).collect::<Vec<_>>()
    };
    let length_m: f64 =
        (0..1000).map(|k| wave(k as f64 / 1e3).0.distance(wave((k + 1) as f64 / 1e3).0)).sum();
    for (chords, other, shift) in [(36, 36, 0.3), (36, 31, 0.0), (40, 29, 0.4), (70, 41, 0.3), (90, 40, 0.0)]
    {
        let mut drawn = face(1.0, chords, 0.0);
        drawn.extend(face(-1.0, other, shift).into_iter().rev().map(|[a, b, c, d]| [c, d, a, b]));
        for turned in [false, true] {
            if turned {
                drawn.reverse();
            }
            let graph = AxisGraph::new(&lines(&drawn));
            let what = format!("{chords} and {other} chords, {shift}");
            assert!(graph.openings.is_empty() && graph.leftovers.is_empty(), "{what}");
            assert!(graph.edges.iter().all(|e| (e.thickness_m - 0.2).abs() < 0.013), "{what}");
            let ends = graph.nodes.iter().filter(|n| n.kind == NodeKind::End).count();
            assert_eq!((ends, graph.nodes.len()), (2, graph.edges.len() + 1), "{what}");
            let of = |e: &Edge| {
                let [a, b] = graph.ends(e);
                let half_sweep = 2.0 * e.bulge.atan();
                let bent = if e.bulge == 0.0 { 1.0 } else { half_sweep / half_sweep.sin() };
                a.distance(b) * bent
            };
            let walls_m: f64 = graph.edges.iter().map(of).sum();
            assert!((walls_m / length_m - 1.0).abs() < 0.01, "{walls_m} of {length_m}: {what}");
        }
    }
}

/// A window that begins at a wall's end and turns away from its line does not reach as far as the next wall beyond.
#[test]
fn a_window_is_as_wide_as_its_glass() {
    let found = |glass: [f64; 4]| {
        let mut drawn = lines(&[
            [0.0, 0.0, 4.0, 0.0],
            [0.0, 0.2, 4.0, 0.2],
            [4.0, 0.0, 4.0, 0.2],
            [8.0, -3.0, 8.0, 3.0],
            [8.2, -3.0, 8.2, 3.0],
        ]);
        let [a, b, c, d] = glass;
        let paths = vec![Path::Line { a: DVec2::new(a, b), b: DVec2::new(c, d) }];
        drawn.marks.push(Mark { paths, role: Role::Window, group: 0, is_named: true });
        AxisGraph::new(&drawn).openings.len()
    };
    assert_eq!(found([4.0, 0.1, 8.0, 0.1]), 1);
    assert_eq!(found([4.0, 0.1, 4.4, 0.14]), 0);
}

/// Two boxes so far apart, the second so deep, and a door on the edge of the first: its swing at half its size. Whether the
/// door leads through the far side of the second, and how wide it is.
fn through_boxes(apart: f64, depth: f64) -> (bool, f64) {
    let ring = |wall: u32, [low, high]: [f64; 2]| {
        let corners = [[0.0, low], [6.0, low], [6.0, high], [0.0, high]].map(DVec2::from);
        let side = move |part: usize| Face {
            wall,
            part: part as u32,
            path: Path::Line { a: corners[part], b: corners[(part + 1) % 4] },
            role: Role::Wall,
            is_closed: true,
            width_m: 0.0,
        };
        (0..4).map(side)
    };
    let faces = ring(0, [0.0, 0.15]).chain(ring(1, [0.15 + apart, 0.15 + apart + depth])).collect();
    let hinge = DVec2::new(2.0, 0.15);
    let leaf = Path::Line { a: hinge, b: hinge + DVec2::X * 0.9 };
    let swing =
        Path::Arc { centre: hinge, radius: 0.45, start_rad: 0.0, sweep_rad: std::f64::consts::FRAC_PI_2 };
    let marks = vec![mark(leaf, Role::Door), mark(swing, Role::Door)];
    let graph = AxisGraph::new(&Drawn { faces, marks });
    let door = graph.openings.iter().find(|o| o.kind == OpeningKind::Door);
    (door.is_some_and(|d| d.through.contains(&(1, 2))), door.map_or(0.0, |d| d.width_m))
}

#[test]
fn a_door_leads_through_a_wall_that_abuts_and_through_no_block() {
    let (is_through, width_m) = through_boxes(0.0, 0.15);
    assert!(is_through && (width_m - 0.9).abs() < 1e-6, "{width_m}");
    assert!(!through_boxes(0.0, 0.7).0);
    // The two leaves of a wall.
    assert!(through_boxes(CAVITY_MAX_M - 0.01, 0.1).0);
    assert!(!through_boxes(CAVITY_MAX_M + 0.01, 0.1).0);
}

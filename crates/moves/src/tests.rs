//! Parameters move what they say, where they say, and nothing else.

mod doors;
mod joints;
mod slots;

use std::collections::BTreeSet;

use glam::DVec2;

mod beside;

use super::control::{Control, Rules};
use super::defaults::{self, GROUPS_MAX, PIECES_MAX, SHIFT_M};
use super::sizes::{PARTITION_THICKNESS_MAX_M, SLIDE_M, WALL_THICKNESS_MAX_M};
use super::{Layout, MOVE_MIN_M, Moves, NodeGroup};
use enfilade_cad::bearing::Bearing;
use enfilade_cad::drawing::{Drawing, Editable, Format, Shape};
use enfilade_engine::interior::Interior;
use enfilade_fixtures::{Draw, empty as drawing, source};
use enfilade_plan::graph::Graph;
use enfilade_plan::markers::{Clause, Group, Kind};
use enfilade_plan::{DOOR_LAYER, Plan, PlanOptions, fittings, structure, understand};
use enfilade_report::Report;

fn marked(drawing: &Drawing) -> (Plan, Graph, Moves, Report) {
    let mut report = Report::default();
    let plan = understand(drawing, &PlanOptions::default(), &mut report).unwrap();
    let graph = Graph::new(&plan);
    let (axes, _) = structure::axes(&plan, drawing);
    let moves = Moves::from_markers(&plan, &graph, &axes, &mut report);
    (plan, graph, moves, report)
}

fn by_default(drawing: &Drawing) -> (Plan, Graph, Moves) {
    let mut report = Report::default();
    let plan = understand(drawing, &PlanOptions::default(), &mut report).unwrap();
    let graph = Graph::new(&plan);
    let walls: Vec<_> = plan.walls.iter().flat_map(|w| w.trace.segments().map(|s| s.2)).collect();
    let interior = Interior::new(&walls, &[], plan.human_scale).unwrap();
    let (axes, marked) = structure::axes(&plan, drawing);
    let fittings = fittings::fittings(&plan, drawing, &axes, &marked);
    let groups = defaults::groups(&plan, &graph, &axes, (&interior, &[], &fittings), &mut report);
    let moves = Moves::new(&plan, &graph, &axes, &groups, &mut report);
    (plan, graph, moves)
}

fn line_of(layout: &Layout, i: usize) -> [f64; 4] {
    match layout.walls[i].shape {
        Shape::Line { a, b } => [a.x, a.y, b.x, b.y],
        ref other => panic!("{other:?}"),
    }
}

fn assert_near(found: [f64; 4], expected: [f64; 4]) {
    let near = found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 2e-6);
    assert!(near, "{found:?}, expected {expected:?}");
}

#[test]
fn clauses_apply_in_order_and_units_are_converted() {
    let mut d = drawing("mm", 0.001);
    d.room(20_000.0, 10_000.0);
    d.line(4_000.0, 4_000.0, 6_000.0, 4_000.0);
    d.group([3_000.0, 3_000.0], [7_000.0, 5_000.0], "x -1500 2m; y -1 1; rotate -90 90; name screen");
    let (plan, graph, moves, report) = marked(&d);
    assert_eq!(moves.bounds(), [[-1.5, 2.0], [-1.0, 1.0], [-90.0, 90.0]]);
    let units: Vec<&str> = moves.parameters.iter().map(|p| p.clause.unit.as_str()).collect();
    assert_eq!(units, ["m", "mm", "deg"]);
    assert_eq!(moves.parameters[0].group_name, "screen");
    let layout = moves.apply(&plan, &graph, &[1.0, 0.0, 90.0]);
    assert_near(line_of(&layout, 0), [6_000.0, 3_000.0, 6_000.0, 5_000.0]);
    assert!(!report.is_degraded());
}

#[test]
fn the_identity_changes_nothing_to_the_bit() {
    let mut d = drawing("in", 0.0254);
    d.room(800.0, 400.0);
    d.line(100.123456789, 100.0, 200.0, 133.3333333333);
    d.group([90.0, 90.0], [210.0, 140.0], "x -10 10; rotate -15 15; scale 0.5 2");
    let (plan, graph, moves, _) = marked(&d);
    let layout = moves.apply(&plan, &graph, &moves.identity());
    assert!(layout.walls.iter().all(|w| !w.is_changed));
    assert_eq!(layout.walls[0].shape, plan.walls[1].shape);
    let far = moves.apply(&plan, &graph, &[3.0, 0.0, 1.0]);
    let traced = &far.walls[0].trace.points;
    let again: Vec<_> = enfilade_plan::curve::trace(&far.walls[0].shape, &plan.frame).points;
    assert_eq!(traced, &again, "what is searched is what is written");
}

#[test]
fn an_end_moves_and_the_wall_stretches() {
    let mut d = drawing("m", 1.0);
    d.room(20.0, 10.0);
    d.line(5.0, 0.0, 5.0, 6.0);
    d.group([4.5, 5.5], [5.5, 6.5], "along 90 -1 2");
    let (plan, graph, moves, _) = marked(&d);
    assert_near(line_of(&moves.apply(&plan, &graph, &[2.0]), 0), [5.0, 0.0, 5.0, 8.0]);
}

#[test]
fn nodes_that_meet_move_together_and_keep_holds() {
    let mut d = drawing("m", 1.0);
    d.room(20.0, 10.0);
    d.line(5.0, 2.0, 8.0, 2.0);
    d.line(8.0, 2.0000005, 8.0, 6.0);
    d.line(12.0, 2.0, 12.0, 6.0);
    d.ring("EF-KEEP", &[[11.0, 1.0], [13.0, 1.0], [13.0, 7.0], [11.0, 7.0]]);
    d.group([7.0, 1.5], [12.5, 2.5], "x -1 1");
    let (plan, graph, moves, _) = marked(&d);
    let layout = moves.apply(&plan, &graph, &[1.0]);
    assert_eq!(layout.walls.len(), 2, "the kept wall is no part of it");
    assert_near(line_of(&layout, 0), [5.0, 2.0, 9.0, 2.0]);
    assert_near(line_of(&layout, 1), [9.0, 2.0, 8.0, 6.0]);
}

#[test]
fn what_cannot_be_written_back_stays_with_its_reason() {
    let mut d = drawing("m", 1.0);
    d.room(20.0, 10.0);
    d.add("WALLS", Shape::Arc { centre: DVec2::new(10.0, 5.0), radius: 1.0, start_rad: 0.0, end_rad: 3.0 });
    d.add("WALLS", Shape::Circle { centre: DVec2::new(15.0, 5.0), radius: 0.3 }).editable =
        Editable::No("it is a spline".into());
    d.group([10.5, 4.5], [15.5, 5.5], "x -1 1");
    let (_, _, moves, report) = marked(&d);
    assert!(moves.parameters.is_empty());
    let said: String = report.problems.iter().map(|p| format!("{p}\n")).collect();
    assert!(said.contains("an arc moves only as a whole") && said.contains("it is a spline"), "{said}");
}

#[test]
fn a_group_inside_what_is_kept_is_told() {
    let mut d = drawing("m", 1.0);
    d.room(20.0, 10.0);
    d.line(5.0, 4.0, 5.0, 6.0);
    d.line(10.0, 4.0, 10.0, 6.0);
    d.ring("EF-KEEP", &[[4.0, 3.0], [6.0, 3.0], [6.0, 7.0], [4.0, 7.0]]);
    d.ring("EF-KEEP", &[[9.0, 5.0], [11.0, 5.0], [11.0, 7.0], [9.0, 7.0]]);
    d.group([4.5, 3.5], [5.5, 6.5], "x -1 1; name held");
    d.group([9.5, 3.5], [10.5, 6.5], "x -1 1; name half");
    let (_, _, moves, report) = marked(&d);
    assert_eq!(moves.parameters.iter().map(|p| p.group_name.as_str()).collect::<Vec<_>>(), ["half"]);
    let said: String = report.problems.iter().map(|p| format!("{p}\n")).collect();
    assert!(
        said.contains("group \"held\": all its wall ends lie inside EF-KEEP; nothing moves here"),
        "{said}"
    );
    assert!(said.contains("group \"half\": 1 of its 2 wall ends lie inside EF-KEEP and stay"), "{said}");
}

#[test]
fn the_gap_in_one_face_of_a_thick_wall_is_no_door() {
    // Two faces with a gap; then the same with the second face unbroken.
    for second in [&[[0.0, 9.0], [10.0, 20.0]][..], &[[0.0, 20.0]][..]] {
        let mut d = drawing("m", 1.0);
        d.room(20.0, 10.0);
        for [from, to] in [[0.0, 9.0], [10.0, 20.0]] {
            d.line(from, 5.0, to, 5.0);
        }
        for [from, to] in second {
            d.line(*from, 5.2, *to, 5.2);
        }
        let (_, _, moves) = by_default(&d);
        let doors: BTreeSet<usize> = (0..moves.parameters.len())
            .filter(|p| moves.parameters[*p].group_name.starts_with("door"))
            .map(|p| moves.parameters[p].group)
            .collect();
        for group in &doors {
            let walls: BTreeSet<u32> = moves.groups[*group].handles.iter().map(|h| h.0).collect();
            assert_eq!(walls.len(), 4, "both faces on both sides: {walls:?}");
        }
        assert!(doors.len() <= 1, "{doors:?}");
    }
}

#[test]
fn an_arc_moves_as_a_whole() {
    let mut d = drawing("m", 1.0);
    d.room(20.0, 10.0);
    d.add("WALLS", Shape::Arc { centre: DVec2::new(10.0, 5.0), radius: 1.0, start_rad: 0.0, end_rad: 3.0 });
    d.group([8.0, 3.0], [12.0, 7.0], "x -1 1; rotate -90 90 about 10,5");
    let (plan, graph, moves, _) = marked(&d);
    let layout = moves.apply(&plan, &graph, &[1.0, 90.0]);
    let Shape::Arc { centre, radius, start_rad, .. } = layout.walls[0].shape else { panic!() };
    assert!(centre.distance(DVec2::new(10.0, 6.0)) < 2e-6 && radius == 1.0);
    assert!((start_rad - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
}

#[test]
fn bad_clauses_are_named_and_the_rest_is_used() {
    for (text, part) in [
        ("x 1 2; y -1 1", "leave out 0"),
        ("x 1 -1; y -1 1", "lower bound first"),
        ("x -1cubits 1; y -1 1", "cubits"),
        ("wobble; y -1 1", "expected `x LOW HIGH`"),
        ("scale -1 2; y -1 1", "above 0"),
        ("rotate -5 5 around 1,2; y -1 1", "about X,Y"),
    ] {
        let mut d = drawing("m", 1.0);
        d.room(20.0, 10.0);
        d.line(5.0, 5.0, 8.0, 5.0);
        d.group([4.0, 4.0], [9.0, 6.0], text);
        let (_, _, moves, report) = marked(&d);
        assert_eq!(moves.parameters.len(), 1, "{text}");
        let said: String = report.problems.iter().map(|p| format!("{p}\n")).collect();
        assert!(said.contains(part) && said.contains("plan.dxf:901"), "{text}: {said}");
    }
}

#[test]
fn groups_of_one_name_are_told_apart() {
    let mut d = drawing("m", 1.0);
    d.room(20.0, 10.0);
    for (i, name) in ["screen", "Screen 2", "Screen", "move-5"].into_iter().enumerate() {
        let x = 2.0 + 4.0 * i as f64;
        d.line(x, 4.0, x, 6.0);
        d.group([x - 1.0, 3.0], [x + 1.0, 7.0], &format!("x -1 1; name {name}"));
    }
    d.line(18.0, 4.0, 18.0, 6.0);
    d.group([17.0, 3.0], [19.0, 7.0], "x -1 1");
    let (_, _, moves, report) = marked(&d);
    let names: Vec<&str> = moves.parameters.iter().map(|p| p.group_name.as_str()).collect();
    assert_eq!(names, ["screen", "Screen 2", "Screen 3", "move-5", "move-5 2"]);
    let said: Vec<String> = report.problems.iter().map(|p| p.to_string()).collect();
    assert_eq!(said.len(), 3, "{said:?}");
    assert!(said[1].contains("plan.dxf:") && said[1].contains("found the name \"Screen\""), "{said:?}");
}

#[test]
fn free_standing_walls_and_doors_move_by_default() {
    let mut d = drawing("m", 1.0);
    d.room(20.0, 10.0);
    d.line(10.0, 0.0, 10.0, 4.0);
    d.line(10.0, 5.0, 10.0, 10.0);
    d.line(4.0, 4.0, 6.0, 4.0);
    d.line(4.0, 4.0 + WALL_THICKNESS_MAX_M / 3.0, 6.0, 4.0 + WALL_THICKNESS_MAX_M / 3.0);
    let (_, _, moves) = by_default(&d);
    let names: Vec<String> =
        moves.parameters.iter().map(|p| format!("{} {}", p.group_name, p.clause.kind.name())).collect();
    assert_eq!(names, ["element-1 x", "element-1 y", "element-1 rotate", "wall-1 x", "door-1 y"]);
    assert_eq!(moves.bounds()[0], [-SHIFT_M, SHIFT_M]);
    assert_eq!(moves.bounds()[4], [-SLIDE_M, SLIDE_M]);
    assert_eq!(moves.groups[0].handles.len(), 4, "both faces of the wall move together");
}

#[test]
fn the_shell_and_rooms_stay_by_default() {
    let mut d = drawing("m", 1.0);
    d.room(20.0, 10.0);
    d.ring("WALLS", &[[5.0, 3.0], [9.0, 3.0], [9.0, 7.0], [5.0, 7.0]]);
    d.line(0.0, 8.0, 3.0, 8.0);
    let (plan, _, moves) = by_default(&d);
    let names: Vec<&str> = moves.parameters.iter().map(|p| p.group_name.as_str()).collect();
    assert!(names.iter().all(|n| n.starts_with("wall-")), "a room is no element: {names:?}");
    let is_shell = |w: &u32| plan.walls[*w as usize].trace.points.contains(&[0, 0]);
    assert!(!moves.walls.iter().any(is_shell), "{names:?}");
}

#[test]
fn default_moves_are_few() {
    let mut d = drawing("m", 1.0);
    d.room(100.0, 100.0);
    for i in 0..20 {
        let x = 5.0 + 4.5 * f64::from(i);
        d.line(x, 40.0, x, 42.0);
    }
    assert_eq!(by_default(&d).2.groups.len(), GROUPS_MAX);
    // Apart from one another: lines drawn over one another take their own time to be read.
    for i in 0..=PIECES_MAX {
        if i == PIECES_MAX / 200 {
            assert!(!by_default(&d).2.parameters.is_empty(), "few enough");
        }
        let (x, y) = (1.0 + (i % 140) as f64 * 0.7, 3.0 + (i / 140) as f64 * 0.9);
        d.line(x, y, x, y + 0.5);
    }
    assert!(by_default(&d).2.parameters.is_empty(), "too many pieces to look at pairwise");
}

/// A partition between walls of which one runs askew slides along both, and stays as thick as it is.
#[test]
fn a_partition_slides_along_a_wall_that_runs_askew() {
    let mut d = drawing("m", 1.0);
    let corners = [[0.0, 0.0], [12.0, 0.0], [12.0, 9.0], [0.0, 6.0]];
    d.ring("WALLS", &corners);
    d.ring("WALLS", &[[0.2, 0.2], [11.8, 0.2], [11.8, 8.743_844_71], [0.2, 5.843_844_71]]);
    let north = |x: f64| 5.843_844_71 + (x - 0.2) * 0.25;
    for x in [5.95, 6.05] {
        d.line(x, 0.2, x, north(x));
    }
    let (plan, graph, moves) = by_default(&d);
    let slide = moves.parameters.iter().position(|p| p.group_name.starts_with("wall"));
    let slide = slide.expect("it slides");
    assert!(matches!(moves.parameters[slide].clause.kind, enfilade_plan::markers::Kind::X));
    let mut p = moves.identity();
    p[slide] = 0.5;
    let layout = moves.apply(&plan, &graph, &p);
    for (wall, x) in [(2, 6.45), (3, 6.55)] {
        let moved = layout.walls.iter().find(|w| w.wall == wall).unwrap();
        let Shape::Line { a, b } = moved.shape else { panic!("{:?}", moved.shape) };
        assert!(a.distance(DVec2::new(x, 0.2)) < 2e-6, "{a}");
        assert!(b.distance(DVec2::new(x, north(x))) < 2e-6, "{b}, expected {}", north(x));
    }
}

/// A house of 12 by 6 m with two faces a wall and an upright partition of 0.1 m at x = 6; the walls that it joins
/// run askew by `slope`, their inner faces cut where it joins.
fn house_with_partition(slope: f64) -> Drawing {
    let mut d = drawing("m", 1.0);
    let south = |x: f64| 0.2 + (x - 0.2) * slope;
    let north = |x: f64| south(x) + 5.6;
    let (low, high) = (|x: f64| south(x) - 0.2, |x: f64| north(x) + 0.2);
    d.ring("WALLS", &[[0.0, low(0.0)], [12.0, low(12.0)], [12.0, high(12.0)], [0.0, high(0.0)]]);
    d.line(0.2, south(0.2), 0.2, north(0.2));
    d.line(11.8, south(11.8), 11.8, north(11.8));
    for [a, b] in [[0.2, 5.95], [6.05, 11.8]] {
        d.line(a, south(a), b, south(b));
        d.line(a, north(a), b, north(b));
    }
    for x in [5.95, 6.05] {
        d.line(x, south(x), x, north(x));
    }
    d
}

fn way_of_partition(d: &Drawing) -> Option<[f64; 2]> {
    let moves = by_default(d).2;
    let slide = moves.parameters.iter().find(|p| p.group_name.starts_with("wall"))?;
    Some([slide.clause.lower, slide.clause.upper])
}

#[test]
fn a_partition_keeps_off_stairs_and_stays_where_one_stands_at_it() {
    let stair = |x: f64| {
        let mut d = house_with_partition(0.0);
        for k in 0..8 {
            let y = 1.0 + 0.28 * f64::from(k);
            d.add("FLOOR", Shape::Line { a: DVec2::new(x, y), b: DVec2::new(x + 1.2, y) });
        }
        way_of_partition(&d)
    };
    assert_eq!(way_of_partition(&house_with_partition(0.0)), Some([-0.6, 0.6]));
    assert_eq!(stair(8.0), Some([-0.6, 0.6]), "far away");
    assert_eq!(stair(6.4), Some([-0.6, 0.3]), "up to a hand before its treads");
    assert_eq!(stair(6.05), None, "it bears the stair");
}

/// A house of 12 by 6 m, its north wall in one piece, and a partition that ends 0.3 m before it.
#[test]
fn a_partition_that_ends_at_a_column_stays() {
    let column_at = |x: f64| {
        let mut d = drawing("m", 1.0);
        d.room(12.0, 6.0);
        d.line(0.2, 0.2, 0.2, 5.8);
        d.line(11.8, 0.2, 11.8, 5.8);
        d.line(0.2, 5.8, 11.8, 5.8);
        for [a, b] in [[0.2, 5.95], [6.05, 11.8]] {
            d.line(a, 0.2, b, 0.2);
        }
        for x in [5.95, 6.05] {
            d.line(x, 0.2, x, 5.5);
        }
        d.line(5.95, 5.5, 6.05, 5.5);
        d.ring("WALLS", &[[x - 0.15, 5.5], [x + 0.15, 5.5], [x + 0.15, 5.8], [x - 0.15, 5.8]]);
        by_default(&d).2.parameters.len()
    };
    assert!(column_at(3.0) > 0);
    assert_eq!(column_at(6.0), 0);
}

/// A door between a partition's side and the end of a wall that stands upright to it.
#[test]
fn a_door_at_a_partitions_side_goes_along_with_its_width() {
    let mut d = house_with_partition(0.0);
    for y in [2.95, 3.05] {
        d.line(7.0, y, 11.8, y);
    }
    d.line(7.0, 2.95, 7.0, 3.05);
    let quarter = std::f64::consts::FRAC_PI_2;
    let centre = DVec2::new(7.0, 3.05);
    d.add("DOORS", Shape::Arc { centre, radius: 0.95, start_rad: 2.0 * quarter, end_rad: 3.0 * quarter });
    let (plan, graph, moves) = by_default(&d);
    let slide = moves.parameters.iter().position(|p| p.group_name.starts_with("wall")).expect("it slides");
    let mut p = moves.identity();
    p[slide] = 0.5;
    let layout = moves.apply(&plan, &graph, &p);
    let ends: Vec<f64> = layout
        .walls
        .iter()
        .filter_map(|w| match w.shape {
            Shape::Line { a, b } if (a.y - 3.0).abs() < 0.1 && (b.y - 3.0).abs() < 0.1 => Some(a.x),
            _ => None,
        })
        .collect();
    assert_eq!(ends.len(), 3, "both faces and the end of the wall beyond the door: {ends:?}");
    assert!(ends.iter().all(|x| (x - 7.5).abs() < 2e-6), "{ends:?}");
}

#[test]
fn a_part_of_a_partition_stays_where_a_line_is_drawn_into_its_doorway() {
    let sliding = |into_doorway: Option<f64>| {
        let mut d = beside::house_with_gap();
        let quarter = std::f64::consts::FRAC_PI_2;
        let centre = DVec2::new(6.05, 2.0);
        d.add("DOORS", Shape::Arc { centre, radius: 0.9, start_rad: 0.0, end_rad: quarter });
        if let Some(y) = into_doorway {
            d.line(6.0, y, 7.5, y);
        }
        by_default(&d).2.parameters.iter().filter(|p| p.group_name.starts_with("wall")).count()
    };
    // The line parts the partition in two; the part whose end is the door's jamb stays.
    assert_eq!(sliding(None), 1);
    for y in [2.1, 2.2, 2.8, 2.85] {
        assert_eq!(sliding(Some(y)), 1, "{y}");
    }
}

#[test]
fn a_face_cut_by_a_sliding_partition_does_not_bend() {
    let d = house_with_partition(0.015);
    let (plan, graph, moves) = by_default(&d);
    let slide = moves.parameters.iter().position(|p| p.group_name.starts_with("wall")).expect("it slides");
    let mut p = moves.identity();
    p[slide] = 0.5;
    let layout = moves.apply(&plan, &graph, &p);
    let mut seen = 0;
    for moved in &layout.walls {
        let Shape::Line { a, b } = moved.shape else { continue };
        if (a.y > 4.0) == (b.y > 4.0) {
            seen += 1;
            for q in [a, b] {
                let above = q.y - 0.2 - (q.x - 0.2) * 0.015;
                assert!(above.abs().min((above - 5.6).abs()) < 2e-6, "{q} has left its face");
            }
        }
    }
    assert_eq!(seen, 4, "both parts of both inner faces are stretched");
}

/// Two outer walls, a partition between them and two walls that end at it: as of a building, each moves whole and can
/// change its length. The second of the two has an opening.
fn joined() -> Drawing {
    let mut d = drawing("m", 1.0);
    d.room(20.0, 10.0);
    let mut bar = |record: usize, corners: &[[f64; 2]], ends: [&[u32]; 2]| {
        d.ring("WALLS", corners);
        let e = d.entities.last_mut().unwrap();
        e.source.record = record;
        e.editable = Editable::Wall { ends: ends.map(<[u32]>::to_vec), free: [f64::INFINITY; 2] };
    };
    let block = |x: [f64; 2], y: [f64; 2]| [[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]];
    bar(1, &block([8.0, 8.2], [0.0, 10.0]), [&[0, 1], &[2, 3]]);
    bar(2, &block([5.0, 8.0], [3.0, 3.2]), [&[0, 3], &[1, 2]]);
    bar(3, &block([8.2, 9.5], [6.0, 6.2]), [&[0, 3], &[]]);
    bar(3, &block([10.5, 12.0], [6.0, 6.2]), [&[], &[1, 2]]);
    d
}

fn moved_by(d: &Drawing, record: usize, clauses: &[(Kind, f64, f64)]) -> (Plan, Graph, Moves, Report) {
    let mut report = Report::default();
    let plan = understand(d, &PlanOptions::default(), &mut report).unwrap();
    let graph = Graph::new(&plan);
    let (axes, _) = structure::axes(&plan, d);
    let clause = |c: &(Kind, f64, f64)| Clause {
        kind: c.0,
        lower: c.1,
        upper: c.2,
        unit: "m".into(),
        si_per_unit: 1.0,
    };
    let own = (0..plan.walls.len()).filter(|w| plan.walls[*w].source.record == record);
    let mut nodes: Vec<u32> = own.flat_map(|w| graph.control_nodes[w].clone()).collect();
    nodes.sort_unstable();
    nodes.dedup();
    let group = Group {
        name: "partition".into(),
        outline: enfilade_engine::Region::Ring(Vec::new()),
        clauses: clauses.iter().map(clause).collect(),
        source: source(record, "WALLS"),
    };
    let moves = Moves::new(&plan, &graph, &axes, &[(group, nodes)], &mut report);
    (plan, graph, moves, report)
}

/// The box of what a record shows in a layout: lowest and highest x, then y.
fn box_of_record(plan: &Plan, layout: &Layout, record: usize) -> [f64; 4] {
    let shapes = plan.walls.iter().enumerate().filter(|(_, w)| w.source.record == record);
    let shape = |(w, wall): (usize, &enfilade_plan::Wall)| {
        layout.walls.iter().find(|m| m.wall == w as u32).map_or(wall.shape.clone(), |m| m.shape.clone())
    };
    let points: Vec<DVec2> =
        shapes.map(shape).flat_map(|s| enfilade_cad::curve::control_points(&s)).collect();
    let [lo, hi] = enfilade_cad::plane::box_of(points.into_iter()).unwrap();
    [lo.x, hi.x, lo.y, hi.y]
}

#[test]
fn walls_that_end_at_one_that_shifts_go_along() {
    let (plan, graph, moves, report) = moved_by(&joined(), 1, &[(Kind::X, -1.0, 1.0), (Kind::Y, -0.5, 0.5)]);
    assert!(!report.is_degraded(), "{report:?}");
    let layout = moves.apply(&plan, &graph, &[0.75, 0.25]);
    assert_near(box_of_record(&plan, &layout, 1), [8.75, 8.95, 0.25, 10.25]);
    // Along their own axes alone; the piece beyond the opening stays.
    assert_near(box_of_record(&plan, &layout, 2), [5.0, 8.75, 3.0, 3.2]);
    assert_near(box_of_record(&plan, &layout, 3), [8.95, 12.0, 6.0, 6.2]);
    let of = |record: usize| -> Vec<Option<[f64; 2]>> {
        let own = layout.walls.iter().filter(|m| plan.walls[m.wall as usize].source.record == record);
        own.map(|m| m.ends).collect()
    };
    assert_eq!((of(1), of(2), of(3)), (vec![None], vec![Some([0.0, 0.75])], vec![Some([0.75, 0.0])]));
    let still = moves.apply(&plan, &graph, &moves.identity());
    assert!(still.walls.iter().all(|w| !w.is_changed && w.ends.is_none()));
}

#[test]
fn a_joint_follows_the_face_it_stands_on() {
    // A partition at 60 degrees, and a wall that ends on it mitred.
    let mut d = drawing("m", 1.0);
    d.room(20.0, 10.0);
    let t = 3f64.sqrt();
    let on = |y: f64| [8.0 + y / t, y];
    let mut bar = |record: usize, corners: &[[f64; 2]], ends: [&[u32]; 2]| {
        d.ring("WALLS", corners);
        let e = d.entities.last_mut().unwrap();
        e.source.record = record;
        e.editable = Editable::Wall { ends: ends.map(<[u32]>::to_vec), free: [f64::INFINITY; 2] };
    };
    let beyond = |y: f64| [on(y)[0] + 0.4, y];
    bar(1, &[on(0.0), beyond(0.0), beyond(10.0), on(10.0)], [&[0, 1], &[2, 3]]);
    bar(2, &[[5.0, 3.0], on(3.0), on(3.2), [5.0, 3.2]], [&[0, 3], &[1, 2]]);
    let (plan, graph, moves, _) = moved_by(&d, 1, &[(Kind::Y, -0.5, 0.5)]);
    let layout = moves.apply(&plan, &graph, &[0.3]);
    let own = layout.walls.iter().find(|m| plan.walls[m.wall as usize].source.record == 2).unwrap();
    let points = enfilade_cad::curve::control_points(&own.shape);
    // The face y = √3 (x − 8) rose by 0.3.
    for c in [1, 2] {
        assert!((points[c].y - 0.3 - t * (points[c].x - 8.0)).abs() < 1e-6, "{points:?}");
        assert!((points[c].y - [3.0, 3.2][c - 1]).abs() < 1e-12);
    }
}

#[test]
fn a_wall_keeps_something_between_its_joints_and_openings() {
    // 0.1 m remain of the wall that follows, and before the opening in it.
    let as_far = [(-2.8, 1.1, [-2.8, 1.1]), (-3.2, 1.0, [-2.9, 1.0]), (-1.0, 1.5, [-1.0, 1.2])];
    for (lower, upper, wanted) in as_far {
        let (_, _, moves, report) = moved_by(&joined(), 1, &[(Kind::X, lower, upper)]);
        let [[low, high]] = moves.bounds()[..] else { panic!("{report:?}") };
        assert!((low - wanted[0]).abs() < 0.004 && low >= wanted[0] - 1e-9, "{low} {wanted:?}");
        assert!((high - wanted[1]).abs() < 0.004 && high <= wanted[1] + 1e-9, "{high} {wanted:?}");
        assert_eq!(moves.parameters[0].stated, [lower, upper]);
        let said = report
            .problems
            .iter()
            .any(|p| p.code == "move-shortened" && p.text.contains("less than 0.1 m of the wall"));
        assert_eq!(said, wanted != [lower, upper], "{report:?}");
    }
    // What turns takes nobody along.
    let (plan, graph, moves, _) =
        moved_by(&joined(), 1, &[(Kind::X, -1.0, 1.0), (Kind::Rotate(None), -0.1, 0.1)]);
    let layout = moves.apply(&plan, &graph, &[0.5, 0.0]);
    assert_near(box_of_record(&plan, &layout, 2), [5.0, 8.0, 3.0, 3.2]);
}

#[test]
fn partitions_slide_by_default_with_the_walls_that_end_at_them() {
    let mut d = joined();
    let (plan, _, moves) = by_default(&d);
    let slides = |plan: &Plan, moves: &Moves, record: usize| -> Option<[f64; 2]> {
        let is_own = |g: &NodeGroup| {
            g.handles.first().is_some_and(|h| plan.walls[h.0 as usize].source.record == record)
        };
        let group = moves.groups.iter().position(is_own)?;
        moves.bounds().get(moves.parameters.iter().position(|p| p.group == group)?).copied()
    };
    assert_eq!(slides(&plan, &moves, 1), Some([-0.6, 0.6]));
    // Walls that cannot change their length hold it.
    for e in d.entities.iter_mut().filter(|e| e.source.record > 1) {
        e.editable = Editable::WithInsert { turnable: true };
    }
    let (plan, _, moves) = by_default(&d);
    assert_eq!(slides(&plan, &moves, 1), None);
}

/// A room of 20 by 10 m with walls as of a building: record, from and to in x, in y.
fn building(walls: &[(usize, [f64; 2], [f64; 2])]) -> Drawing {
    let mut d = drawing("m", 1.0);
    d.room(20.0, 10.0);
    for (record, x, y) in walls {
        let is_upright = y[1] - y[0] > x[1] - x[0];
        d.ring("WALLS", &[[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]]);
        let e = d.entities.last_mut().unwrap();
        e.source.record = *record;
        let ends = if is_upright { [vec![0, 1], vec![2, 3]] } else { [vec![0, 3], vec![1, 2]] };
        e.editable = Editable::Wall { ends, free: [f64::INFINITY; 2] };
    }
    d
}

/// Bounds of the first clause that moves a record.
fn bounds_of(plan: &Plan, moves: &Moves, record: usize) -> Option<[f64; 2]> {
    let is_own = |g: &NodeGroup| plan.walls[g.handles[0].0 as usize].source.record == record;
    let group = moves.groups.iter().position(is_own)?;
    moves.bounds().get(moves.parameters.iter().position(|p| p.group == group)?).copied()
}

#[test]
fn what_carries_stays_by_default() {
    let slides = |thickness: f64, bearing: Option<usize>| {
        let mut d =
            building(&[(1, [8.0, 8.0 + thickness], [0.0, 10.0]), (2, [8.0 + thickness, 12.0], [4.0, 4.2])]);
        d.bearing.extend(bearing.map(|record| (record, Bearing::Stated)));
        let (plan, _, moves) = by_default(&d);
        bounds_of(&plan, &moves, 1)
    };
    assert_eq!(slides(0.2, None), Some([-0.6, 0.6]));
    assert!(slides(PARTITION_THICKNESS_MAX_M, None).is_some());
    assert_eq!(slides(PARTITION_THICKNESS_MAX_M + 0.05, None), None);
    assert_eq!(slides(0.2, Some(1)), None);
    assert_eq!(slides(0.2, Some(2)), None, "it would take an end of the structure along");
}

#[test]
fn what_a_wall_ends_at_does_not_follow_it() {
    // A lining, half in a thick wall, ends at two partitions that end at the thick wall.
    let d = building(&[
        (1, [5.0, 5.5], [0.0, 10.0]),
        (2, [5.5, 9.0], [3.0, 3.2]),
        (3, [5.5, 9.0], [7.0, 7.2]),
        (4, [5.45, 5.6], [3.2, 7.0]),
    ]);
    let (plan, graph, moves, _) = moved_by(&d, 4, &[(Kind::X, 0.0, 1.0)]);
    let layout = moves.apply(&plan, &graph, &[0.5]);
    assert_near(box_of_record(&plan, &layout, 4), [5.95, 6.1, 3.2, 7.0]);
    for (record, y) in [(2, [3.0, 3.2]), (3, [7.0, 7.2])] {
        assert_near(box_of_record(&plan, &layout, record), [5.5, 9.0, y[0], y[1]]);
    }
    // In the thick wall, at its face, and a hand's breadth before it.
    for (x, slides) in [(5.45, false), (5.5, false), (5.7, true)] {
        let lining = (4, [x, x + 0.15], [3.2, 7.0]);
        let d = building(&[
            (1, [5.0, 5.5], [0.0, 10.0]),
            (2, [5.5, 9.0], [3.0, 3.2]),
            (3, [5.5, 9.0], [7.0, 7.2]),
            lining,
        ]);
        let (plan, _, moves) = by_default(&d);
        assert_eq!(bounds_of(&plan, &moves, 4).is_some(), slides, "{x}");
    }
}

#[test]
fn no_end_is_drawn_back_behind_a_wall_that_stands_at_it() {
    // Wall 2 ends at wall 1 in a corner; wall 3 stands on the other side of it, 0.7 m from its end: 0.1 m stay between.
    let walls = [(1, [8.0, 8.2], [0.0, 3.0]), (2, [0.0, 8.2], [3.0, 3.2]), (3, [7.4, 7.5], [3.2, 10.0])];
    let d = building(&walls);
    for (lower, is_shorter) in [(-0.6, false), (-0.75, true)] {
        let (_, _, moves, report) = moved_by(&d, 1, &[(Kind::X, lower, 0.5)]);
        assert!((-0.6..-0.59).contains(&moves.bounds()[0][0]), "{:?}", moves.bounds());
        let said = |p: &enfilade_report::Problem| p.text.contains("less than 0.1 m of the wall");
        assert_eq!(report.problems.iter().any(said), is_shorter, "{report:?}");
    }
    // Both slide by default, each as far as the other leaves it.
    let (plan, _, moves) = by_default(&d);
    let both = [1, 3].map(|record| bounds_of(&plan, &moves, record));
    assert_eq!(both, [Some([-0.2, 0.6]), Some([-0.6, 0.4])]);
    // Without the wall that stands there, the whole way.
    let (plan, _, moves) = by_default(&building(&walls[..2]));
    assert_eq!(bounds_of(&plan, &moves, 1), Some([-0.6, 0.6]));
}

/// A partition at x = 8 between two walls; how far it slides with a door of some width before it.
#[test]
fn the_space_before_doors_stays_free() {
    let beside = |doors: &[([f64; 2], [f64; 2])]| {
        let mut d = building(&[(1, [8.0, 8.2], [0.0, 10.0])]);
        for (x, y) in doors {
            d.ring(DOOR_LAYER, &[[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]]);
        }
        let (plan, _, moves) = by_default(&d);
        assert_eq!(plan.doors.len(), doors.len());
        bounds_of(&plan, &moves, 1).map(|b| b.map(|v| (v * 1e3).round() / 1e3))
    };
    assert_eq!(beside(&[]), Some([-0.6, 0.6]));
    // In the wall that the partition ends at: it stops at the jamb, here 0.3 m to the east.
    assert_eq!(beside(&[([8.5, 9.3], [9.9, 10.0])]), Some([-0.6, 0.3]));
    // Facing it, 1.2 m away: 0.9 m stay free before a narrow door, as much as it is wide before a wide one.
    assert_eq!(beside(&[([9.4, 9.5], [4.0, 4.8])]), Some([-0.6, 0.3]));
    assert_eq!(beside(&[([9.4, 9.5], [4.0, 5.1])]), Some([-0.6, 0.09]));
    // It stands nearer at the start: no nearer than that.
    assert_eq!(beside(&[([8.8, 8.9], [4.0, 4.8])]), Some([-0.6, 0.0]));
    // Between two of them there is no way left.
    assert_eq!(beside(&[([8.8, 8.9], [4.0, 4.8]), ([7.3, 7.4], [4.0, 4.8])]), None);
    // A door of its own goes along, and the space before it ends at what stands there.
    let with_own = |is_door: bool| {
        let mut d = building(&[(1, [8.0, 8.2], [0.0, 10.0]), (2, [9.15, 9.35], [4.0, 5.0])]);
        d.entities.last_mut().unwrap().editable = Editable::No("it stands".into());
        if is_door {
            d.ring(DOOR_LAYER, &[[8.0, 4.2], [8.2, 4.2], [8.2, 5.0], [8.0, 5.0]]);
            d.entities.last_mut().unwrap().source.record = 70;
            d.hosts.insert(70, 1);
        }
        let (plan, _, moves) = by_default(&d);
        bounds_of(&plan, &moves, 1).unwrap()
    };
    let (door, none) = (with_own(true), with_own(false));
    assert_eq!((door[0], none[0]), (-0.6, -0.6));
    assert!(door[1] <= 0.05 + 1e-9 && none[1] > 0.1, "{door:?} {none:?}");
}

/// What moves by less than [`MOVE_MIN_M`] stays to the bit, and the search is told that it does.
#[test]
fn a_way_too_short_is_no_move() {
    let mut d = drawing("m", 1.0);
    d.line(0.0, 0.0, 10.0, 0.0);
    d.group([9.5, -0.5], [10.5, 0.5], "x -1 1");
    let (plan, graph, moves, _) = marked(&d);
    for (way, is_move) in [(MOVE_MIN_M * 0.9, false), (MOVE_MIN_M * 1.1, true)] {
        for sign in [-1.0, 1.0] {
            assert_eq!(moves.apply(&plan, &graph, &[way * sign]).walls[0].is_changed, is_move, "{way}");
            let control = Control::new(&moves, &Rules::default()).unwrap();
            assert_eq!(control.permit(&[way * sign]) != [0.0], is_move, "{way}");
        }
    }
}

/// One wall that reaches as far as the earth takes neither time nor memory.
#[test]
fn walls_that_reach_too_far_have_no_default_moves() {
    let plan = |far: f64| {
        let mut d = drawing("m", 1.0);
        d.room(10.0, 10.0);
        d.line(4.0, 5.0, 6.0, 5.0);
        d.line(0.0, 20.0, far, 20.0 + far);
        by_default(&d)
    };
    let near = (super::neighbours::SQUARES_MAX * 0.5).sqrt();
    assert!(!plan(near).2.parameters.is_empty());
    assert!(plan(near * 10.0).2.parameters.is_empty());
    assert!(plan(1e9).2.parameters.is_empty());
}

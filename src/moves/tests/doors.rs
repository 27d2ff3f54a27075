//! Doors slide to the side on which there is room, and blocks of rooms are no free-standing elements.

use std::f64::consts::FRAC_PI_2;

use super::*;
use crate::moves::narrowed::{Doors, Narrowed};
use crate::plan::curve::control_points;

/// A house whose partition at x = 6 has a gap of 0.9 m that begins `stub` beyond the south wall.
fn house_with_door(stub: f64) -> Drawing {
    let mut d = drawing("m", 1.0);
    d.ring("WALLS", &[[0.0, 0.0], [12.0, 0.0], [12.0, 6.0], [0.0, 6.0]]);
    d.line(0.2, 0.2, 0.2, 5.8);
    d.line(11.8, 0.2, 11.8, 5.8);
    for [a, b] in [[0.2, 5.95], [6.05, 11.8]] {
        d.line(a, 0.2, b, 0.2);
        d.line(a, 5.8, b, 5.8);
    }
    let [from, to] = [0.2 + stub, 1.1 + stub];
    for x in [5.95, 6.05] {
        d.line(x, 0.2, x, from);
        d.line(x, to, x, 5.8);
    }
    d.line(5.95, from, 6.05, from);
    d.line(5.95, to, 6.05, to);
    d
}

fn way_of_door(moves: &Moves) -> Option<[f64; 2]> {
    let door = moves.parameters.iter().find(|p| p.group_name.starts_with("door"))?;
    Some([door.clause.lower, door.clause.upper])
}

#[test]
fn a_door_slides_to_the_side_with_room() {
    for (stub, expected) in [(0.09, [0.0, 0.5]), (0.3, [-0.2, 0.5]), (2.0, [-0.5, 0.5]), (4.6, [-0.5, 0.0])] {
        let (plan, graph, moves) = by_default(&house_with_door(stub));
        let way = way_of_door(&moves).unwrap_or_else(|| panic!("{stub}: no door moves"));
        assert!(way.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6), "{stub}: {way:?}");
        // The joint beside the door stays where it is, however short the wall between them.
        let parameter = moves.parameters.iter().position(|p| p.group_name.starts_with("door")).unwrap();
        let mut at = moves.identity();
        at[parameter] = if way[1] > 0.1 { way[1] } else { way[0] };
        let layout = moves.apply(&plan, &graph, &at);
        let joints = |shape: &Shape| {
            let at_joint = |p: &DVec2| (p.y - 0.2).abs() < 1e-9 || (p.y - 5.8).abs() < 1e-9;
            control_points(shape).iter().filter(|p| at_joint(p)).count()
        };
        let drawn: usize = layout.walls.iter().map(|w| joints(&plan.walls[w.wall as usize].shape)).sum();
        let moved: usize = layout.walls.iter().map(|w| joints(&w.shape)).sum();
        assert_eq!(drawn, moved, "{stub}");
    }
}

/// What is deep both ways holds rooms; a long screen does not.
#[test]
fn a_block_of_rooms_is_no_element() {
    let elements = |wide: f64, deep: f64| {
        let mut d = drawing("m", 1.0);
        d.room(40.0, 40.0);
        let (x, y) = (10.0 + wide, 10.0 + deep);
        for [a, b, c, e] in
            [[10.0, 10.0, x, 10.0], [x, 10.0, x, y], [x, y, 10.0, y], [10.0, y, 10.0, y - 0.4]]
        {
            d.line(a, b, c, e);
        }
        by_default(&d).2.parameters.iter().filter(|p| p.group_name.starts_with("element")).count()
    };
    assert_eq!((elements(5.9, 5.9), elements(12.0, 5.9), elements(6.1, 6.1)), (3, 3, 0));
}

/// A partition at the end of a wall that carries would take that end along.
#[test]
fn a_partition_at_the_end_of_a_carrying_wall_stays() {
    let with = |thick: f64| {
        let mut d = drawing("m", 1.0);
        d.ring("WALLS", &[[0.0, 0.0], [12.0, 0.0], [12.0, 6.0], [0.0, 6.0]]);
        let east = 7.0 + thick;
        d.line(0.2, 0.2, 7.0, 0.2);
        d.line(east, 0.2, 11.8, 0.2);
        d.line(11.8, 0.2, 11.8, 5.8);
        d.line(11.8, 5.8, 0.2, 5.8);
        d.line(0.2, 5.8, 0.2, 3.0);
        d.line(0.2, 2.9, 0.2, 0.2);
        d.line(0.2, 3.0, east, 3.0);
        d.line(0.2, 2.9, 7.0, 2.9);
        d.line(7.0, 2.9, 7.0, 0.2);
        d.line(east, 3.0, east, 0.2);
        let moves = by_default(&d).2;
        moves.parameters.iter().filter(|p| p.clause.kind == Kind::Y).count()
    };
    assert_eq!((with(0.1), with(0.5)), (1, 0));
}

/// A corridor wall at y = 4 with a door of 1 m from x = 5 on, and a partition that meets it at x = 3.5.
fn partition_beside_a_door(is_joined: bool, (lo, hi): ([f64; 2], [f64; 2]), how: &str) -> Drawing {
    let mut d = drawing("m", 1.0);
    d.room(12.0, 8.0);
    match is_joined {
        true => {
            d.line(0.0, 4.0, 3.5, 4.0);
            d.line(3.5, 4.0, 5.0, 4.0);
        }
        false => d.line(0.0, 4.0, 5.0, 4.0),
    }
    d.line(6.0, 4.0, 12.0, 4.0);
    d.line(3.5, 0.0, 3.5, 4.0);
    let start = DVec2::new(5.0, 4.0);
    d.add("DOOR", Shape::Arc { centre: start, radius: 1.0, start_rad: 0.0, end_rad: FRAC_PI_2 });
    d.add("DOOR", Shape::Line { a: start, b: start + DVec2::Y });
    d.group(lo, hi, how);
    d
}

fn kept_wide(drawing: &Drawing) -> (Vec<[f64; 2]>, Vec<Narrowed>) {
    let mut report = Report::default();
    let plan = understand(drawing, &PlanOptions::default(), &mut report).unwrap();
    let graph = Graph::new(&plan);
    let (axes, _) = structure::axes(&plan, drawing);
    let mut moves = Moves::from_markers(&plan, &graph, &axes, &mut report);
    let upper: Vec<f64> = moves.bounds().iter().map(|b| b[1]).collect();
    let told = moves.keep_doors_wide(&plan, &graph, &axes);
    let doors = Doors::new(&plan, &axes);
    assert_eq!(told.is_empty(), moves.bounds().iter().map(|b| b[1]).eq(upper.iter().copied()));
    for end in [0, 1] {
        let at: Vec<f64> = moves.bounds().iter().map(|b| b[end]).collect();
        let entered = doors
            .narrowed(&moves.apply(&plan, &graph, &at))
            .into_iter()
            .any(|n| n.is_entered && !n.has_moved);
        assert!(!entered, "at its bounds");
    }
    (moves.bounds(), doors.narrowed(&moves.apply(&plan, &graph, &upper)))
}

/// A joint that slides along a wall with a door ends before the door, be it drawn as a joint or not; so it would leave
/// the door 0.7 m wide.
#[test]
fn a_joint_does_not_pass_a_jamb() {
    let wall = ([3.3, -0.1], [3.8, 4.1]);
    for is_joined in [true, false] {
        let (bounds, beyond) = kept_wide(&partition_beside_a_door(is_joined, wall, "x -1.5 1.8"));
        assert_eq!(bounds[0][0], -1.5);
        assert!((bounds[0][1] - 1.5).abs() < 0.02 && bounds[0][1] < 1.5, "{bounds:?}");
        let [door] = beyond.as_slice() else { panic!("{beyond:?}") };
        assert!((door.was_m - 1.0).abs() < 1e-9 && (door.is_m - 0.7).abs() < 1e-6, "{door:?}");
        assert_eq!(door.place_words(), "the door at 5.5, 4");
    }
    let (bounds, beyond) = kept_wide(&partition_beside_a_door(true, wall, "x -1.5 1.2"));
    assert_eq!((bounds, beyond), (vec![[-1.5, 1.2]], vec![]));
}

/// A door that is marked with both its jambs goes as far as it is told, over the end of a partition too.
#[test]
fn a_marked_door_goes_as_far_as_it_is_told() {
    let both = ([4.9, 3.9], [6.1, 4.1]);
    let (bounds, _) = kept_wide(&partition_beside_a_door(true, both, "x -2 0.3"));
    assert_eq!(bounds, [[-2.0, 0.3]]);
}

/// Whoever marks a jamb alone has the door made narrower; the options say it.
#[test]
fn a_jamb_that_is_marked_itself_moves_as_it_says() {
    let jamb = ([4.9, 3.9], [5.1, 4.1]);
    let (bounds, beyond) = kept_wide(&partition_beside_a_door(true, jamb, "x -0.3 0.3"));
    assert_eq!(bounds, [[-0.3, 0.3]]);
    assert!(matches!(beyond.as_slice(), [d] if !d.is_entered && (d.is_m - 0.7).abs() < 1e-6), "{beyond:?}");
}

/// Default moves before and after they are kept from narrowing doors.
fn as_drawn(drawing: &Drawing) -> (Vec<(String, [f64; 2])>, Vec<(String, [f64; 2])>, Vec<String>) {
    let (plan, graph, mut moves) = by_default(drawing);
    let (axes, _) = structure::axes(&plan, drawing);
    let all = |moves: &Moves| -> Vec<(String, [f64; 2])> {
        moves.parameters.iter().map(|p| (p.group_name.clone(), [p.clause.lower, p.clause.upper])).collect()
    };
    let before = all(&moves);
    let kept = moves.keep_doors_as_drawn(&plan, &graph, &axes);
    let out = kept.without_way.iter().map(|i| moves.parameters[*i].group_name.clone()).collect();
    println!("{before:?}\n{:?} {kept:?}", all(&moves));
    let doors = Doors::new(&plan, &axes);
    for (k, d) in doors.doors.iter().enumerate() {
        println!(
            "  door {k} at {:?} jambs {:?}",
            d.at,
            axes.openings.iter().map(|o| o.jambs).collect::<Vec<_>>()
        );
        for i in 0..before.len() {
            for e in 0..2 {
                let mut at = moves.identity();
                at[i] = before[i].1[e];
                let l = moves.apply(&plan, &graph, &at);
                println!(
                    "   {} {:?} {:?} -> {:?}",
                    moves.parameters[i].group_name,
                    moves.parameters[i].clause.kind,
                    at[i],
                    d.place(&plan, &l)
                );
            }
        }
    }
    for i in 0..before.len() {
        for j in 0..before.len() {
            for b in 0..4 {
                let mut at = moves.identity();
                at[i] = before[i].1[b & 1];
                at[j] = before[j].1[b >> 1];
                for n in doors.narrowed(&moves.apply(&plan, &graph, &at)) {
                    println!("{i} {j} {b} {n:?}");
                }
            }
        }
    }
    (before, all(&moves), out)
}

#[test]
fn probe_defaults() {
    // a: building, door of the file in the wall at the north.
    for east in [8.6, 8.5, 8.45, 8.31, 8.25, 8.2] {
        let mut d = building(&[(1, [8.0, 8.2], [0.0, 10.0])]);
        d.ring(DOOR_LAYER, &[[east, 9.9], [east + 0.9, 9.9], [east + 0.9, 10.1], [east, 10.1]]);
        d.entities.last_mut().unwrap().source.record = 70;
        println!("A {east}");
        as_drawn(&d);
    }
    // b: corner door
    for gap in [0.9, 1.6] {
        let mut d = drawing("m", 1.0);
        d.ring("WALLS", &[[0.0, 0.0], [12.0, 0.0], [12.0, 6.0], [0.0, 6.0]]);
        d.line(0.2, 0.2, 0.2, 5.8);
        for [a, b] in [[0.2, 5.95], [6.05, 11.8]] {
            d.line(a, 0.2, b, 0.2);
            d.line(a, 5.8, b, 5.8);
        }
        d.line(5.95, 0.2, 5.95, 5.8);
        d.line(6.05, 0.2, 6.05, 5.8);
        let e = 6.05 + gap;
        d.line(11.8, 0.2, 11.8, 2.95);
        d.line(11.8, 3.05, 11.8, 5.8);
        d.line(e, 2.95, 11.8, 2.95);
        d.line(e, 3.05, 11.8, 3.05);
        d.line(e, 2.95, e, 3.05);
        d.add(
            "DOOR",
            Shape::Arc {
                centre: DVec2::new(e, 3.0),
                radius: gap,
                start_rad: FRAC_PI_2,
                end_rad: 2.0 * FRAC_PI_2,
            },
        );
        d.add("DOOR", Shape::Line { a: DVec2::new(e, 3.0), b: DVec2::new(e, 3.0 + gap) });
        println!("B {gap}");
        as_drawn(&d);
    }
    // c: door in partition and T-joint
    for (from, yw) in [(3.5, 2.0), (3.5, 2.5), (3.3, 2.6)] {
        let mut d = drawing("m", 1.0);
        d.ring("WALLS", &[[0.0, 0.0], [12.0, 0.0], [12.0, 6.0], [0.0, 6.0]]);
        d.line(11.8, 0.2, 11.8, 5.8);
        d.line(6.05, 0.2, 11.8, 0.2);
        d.line(6.05, 5.8, 11.8, 5.8);
        let to = from + 0.9;
        let (a, b) = (yw - 0.05, yw + 0.05);
        d.line(0.2, 0.2, 5.95, 0.2);
        d.line(5.95, 0.2, 5.95, a);
        d.line(5.95, a, 0.2, a);
        d.line(0.2, a, 0.2, 0.2);
        d.line(0.2, 5.8, 5.95, 5.8);
        d.line(0.2, 5.8, 0.2, b);
        d.line(0.2, b, 5.95, b);
        d.line(5.95, b, 5.95, from);
        d.line(5.95, to, 5.95, 5.8);
        d.line(6.05, 0.2, 6.05, from);
        d.line(6.05, to, 6.05, 5.8);
        d.line(5.95, from, 6.05, from);
        d.line(5.95, to, 6.05, to);
        d.add(
            "DOOR",
            Shape::Arc { centre: DVec2::new(6.0, to), radius: 0.9, start_rad: -FRAC_PI_2, end_rad: 0.0 },
        );
        d.add("DOOR", Shape::Line { a: DVec2::new(6.0, to), b: DVec2::new(6.9, to) });
        println!("C {from} {yw}");
        as_drawn(&d);
    }
}

//! Doors slide to the side on which there is room, and blocks of rooms are no free-standing elements.

use std::f64::consts::{FRAC_PI_2, PI};

use super::*;
use crate::Parameter;
use crate::narrowed::{Doors, Narrowed};
use enfilade_cad::curve::control_points;

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

/// A joint that slides along a wall with a door ends 0.1 m before the door, be it drawn as a joint or not.
#[test]
fn a_joint_does_not_pass_a_jamb() {
    let wall = ([3.3, -0.1], [3.8, 4.1]);
    for is_joined in [true, false] {
        let (bounds, beyond) = kept_wide(&partition_beside_a_door(is_joined, wall, "x -1.5 1.8"));
        assert_eq!(bounds[0][0], -1.5);
        assert!((bounds[0][1] - 1.4).abs() < 0.02 && bounds[0][1] <= 1.4, "{bounds:?}");
        assert_eq!(beyond, []);
    }
    let (bounds, beyond) = kept_wide(&partition_beside_a_door(true, wall, "x -1.5 1.2"));
    assert_eq!((bounds, beyond), (vec![[-1.5, 1.2]], vec![]));
}

/// A door that is marked with both its jambs ends 0.1 m before the next joint.
#[test]
fn a_marked_door_does_not_pass_a_joint() {
    let both = ([4.9, 3.9], [6.1, 4.1]);
    for is_joined in [true, false] {
        let (bounds, _) = kept_wide(&partition_beside_a_door(is_joined, both, "x -2 0.3"));
        assert!((bounds[0][0] + 1.4).abs() < 0.02 && bounds[0][0] >= -1.4, "{bounds:?}");
        assert_eq!(bounds[0][1], 0.3);
    }
}

/// Whoever marks a jamb alone has the door made narrower; the options say it.
#[test]
fn a_jamb_that_is_marked_itself_moves_as_it_says() {
    let jamb = ([4.9, 3.9], [5.1, 4.1]);
    let (bounds, beyond) = kept_wide(&partition_beside_a_door(true, jamb, "x -0.3 0.3"));
    assert_eq!(bounds, [[-0.3, 0.3]]);
    assert!(matches!(beyond.as_slice(), [d] if !d.is_entered && (d.is_m - 0.7).abs() < 1e-6), "{beyond:?}");
}

/// A partition at x = 8 that ends at a corridor wall with doors of 0.9 m, each from such an x on.
fn partition_at_a_corridor(doors: &[f64]) -> Drawing {
    let mut d = building(&[(1, [8.0, 8.2], [0.0, 6.0]), (2, [0.0, 20.0], [6.0, 6.2])]);
    for (from, record) in doors.iter().zip(70..) {
        d.ring(DOOR_LAYER, &[[*from, 6.0], [from + 0.9, 6.0], [from + 0.9, 6.2], [*from, 6.2]]);
        d.entities.last_mut().unwrap().source.record = record;
        d.hosts.insert(record, 2);
    }
    d
}

/// A door of 1 m between the side of a partition at x = 6 and the end of a wall east of it.
fn door_in_a_corner() -> Drawing {
    let mut d = drawing("m", 1.0);
    d.ring("WALLS", &[[0.0, 0.0], [12.0, 0.0], [12.0, 6.0], [0.0, 6.0]]);
    d.line(0.2, 0.2, 0.2, 5.8);
    for [a, b] in [[0.2, 5.95], [6.05, 11.8]] {
        d.line(a, 0.2, b, 0.2);
        d.line(a, 5.8, b, 5.8);
    }
    for x in [5.95, 6.05] {
        d.line(x, 0.2, x, 5.8);
    }
    for [a, b] in [[0.2, 2.95], [3.05, 5.8]] {
        d.line(11.8, a, 11.8, b);
    }
    for y in [2.95, 3.05] {
        d.line(7.05, y, 11.8, y);
    }
    d.line(7.05, 2.95, 7.05, 3.05);
    let hinge = DVec2::new(7.05, 3.0);
    d.add("DOOR", Shape::Arc { centre: hinge, radius: 1.0, start_rad: FRAC_PI_2, end_rad: PI });
    d.add("DOOR", Shape::Line { a: hinge, b: hinge + DVec2::Y });
    d
}

/// A partition with a door at x = 6 and a wall that ends at it from the west, all of them but one line.
fn door_beside_a_sliding_wall(from: f64, y: f64) -> Drawing {
    let mut d = drawing("m", 1.0);
    let (to, a, b) = (from + 0.9, y - 0.05, y + 0.05);
    d.ring("WALLS", &[[0.0, 0.0], [12.0, 0.0], [12.0, 6.0], [0.0, 6.0]]);
    let corners = [
        [5.95, to],
        [5.95, 5.8],
        [0.2, 5.8],
        [0.2, b],
        [5.95, b],
        [5.95, from],
        [6.05, from],
        [6.05, 0.2],
        [11.8, 0.2],
        [11.8, 5.8],
        [6.05, 5.8],
        [6.05, to],
    ];
    d.ring("WALLS", &corners);
    d.ring("WALLS", &[[0.2, 0.2], [5.95, 0.2], [5.95, a], [0.2, a]]);
    let hinge = DVec2::new(6.0, to);
    d.add("DOOR", Shape::Arc { centre: hinge, radius: 0.9, start_rad: -FRAC_PI_2, end_rad: 0.0 });
    d.add("DOOR", Shape::Line { a: hinge, b: hinge + DVec2::X * 0.9 });
    d
}

/// Bounds by name.
type Ways = Vec<(String, [f64; 2])>;

/// The ways of a drawing's default moves as they are made, and as they are once no door becomes narrower at the bounds of
/// any two of them; and the names of those without way.
fn kept_as_drawn(drawing: &Drawing) -> (Ways, Ways, Vec<String>) {
    let (plan, graph, mut moves) = by_default(drawing);
    let (axes, _) = structure::axes(&plan, drawing);
    let ways = |moves: &Moves| -> Ways {
        let of = |p: &Parameter| (p.group_name.clone(), [p.clause.lower, p.clause.upper]);
        moves.parameters.iter().map(of).collect()
    };
    let made = ways(&moves);
    let kept = moves.keep_doors_as_drawn(&plan, &graph, &axes);
    let now = ways(&moves);
    assert!(kept.without_way.is_subset(&kept.shorter));
    assert!((0..now.len()).all(|i| kept.shorter.contains(&i) == (made[i] != now[i])), "{made:?} {now:?}");
    let doors = Doors::and_windows(&plan, &axes);
    let ends = || (0..now.len()).flat_map(|i| [(i, 0), (i, 1)]);
    for (a, b) in ends().flat_map(|a| ends().map(move |b| (a, b))) {
        let mut at = moves.identity();
        [a, b].iter().for_each(|(i, end)| at[*i] = now[*i].1[*end]);
        assert_eq!(doors.narrowed(&moves.apply(&plan, &graph, &at)), [], "{at:?}");
    }
    let out = kept.without_way.iter().map(|i| now[*i].0.clone()).collect();
    (made, now, out)
}

fn way_of(ways: &Ways, name: &str) -> [f64; 2] {
    ways.iter().find(|w| w.0 == name).map(|w| w.1.map(|v| (v * 1e3).round() / 1e3)).unwrap()
}

/// A partition that moves by default ends 0.1 m before the jamb of a door in the wall it slides along; with too little way
/// left it stays.
#[test]
fn a_default_move_ends_before_a_jamb() {
    let at = |doors: &[f64]| {
        let (_, now, out) = kept_as_drawn(&partition_at_a_corridor(doors));
        assert!(out.is_empty(), "{now:?}");
        // The corridor wall is longer.
        now.last().map(|w| way_of(&now, &w.0))
    };
    assert_eq!(at(&[8.6]), Some([-0.6, 0.3]));
    assert_eq!(at(&[8.41]), Some([-0.6, 0.11]));
    assert_eq!(at(&[8.31]), Some([-0.6, 0.01]));
    assert_eq!(at(&[8.21]), Some([-0.6, 0.0]));
    assert_eq!(at(&[8.21, 7.01]), None);
}

/// A door whose one jamb stands on the side of the partition that moves goes along with it, as wide as it is; marked alone,
/// the partition leaves it wider or narrower.
#[test]
fn a_jamb_on_the_side_of_a_wall_goes_with_it() {
    let d = door_in_a_corner();
    let (made, now, out) = kept_as_drawn(&d);
    assert_eq!((way_of(&made, "wall-1"), &out), ([-0.6, 0.6], &vec![]));
    assert_eq!(made, now);
    let mut alone = d;
    alone.group([5.9, 0.1], [6.1, 5.9], "x -0.3 0.4");
    let (bounds, beyond) = kept_wide(&alone);
    assert_eq!(bounds, [[-0.3, 0.4]]);
    assert!(matches!(beyond.as_slice(), [d] if !d.is_entered && (d.is_m - 0.6).abs() < 1e-6), "{beyond:?}");
}

/// A door and a wall that slide towards each other: 0.1 m of the wall between them stay, the door gives way.
#[test]
fn two_default_moves_do_not_meet_in_a_door() {
    for (wall, door) in [(2.5, [-0.25, 0.5]), (2.0, [-0.5, 0.5])] {
        let (made, now, out) = kept_as_drawn(&door_beside_a_sliding_wall(3.5, wall));
        assert_eq!((way_of(&made, "wall-1"), way_of(&made, "door-1")), ([-0.6, 0.6], door), "{wall}");
        assert_eq!((&made, out.as_slice()), (&now, &[][..]));
    }
}

/// A wall with a door that turns as one leaves its door as wide as it is, however thick it is and wherever the middle of
/// the turn stands, also where the one jamb is the side of a wall that turns along.
#[test]
fn a_rigid_turn_keeps_a_door_as_wide() {
    for (thick, about, is_corner) in
        [(0.06, "6.5,3.5", false), (0.12, "7.8,3.1", false), (0.25, "6.5,3.5", false), (0.12, "5,4", true)]
    {
        let mut d = drawing("m", 1.0);
        d.room(13.0, 9.0);
        let (low, high) = (3.5 - thick / 2.0, 3.5 + thick / 2.0);
        let ring = |x0: f64, x1: f64| [[x0, low], [x1, low], [x1, high], [x0, high]];
        match is_corner {
            false => d.ring("WALLS", &ring(4.0, 6.05)),
            true => d.ring("WALLS", &[[5.93, 2.5], [6.05, 2.5], [6.05, 4.5], [5.93, 4.5]]),
        }
        d.ring("WALLS", &ring(6.95, 9.0));
        let hinge = DVec2::new(6.95, high);
        d.add("DOOR", Shape::Arc { centre: hinge, radius: 0.9, start_rad: FRAC_PI_2, end_rad: PI });
        d.add("DOOR", Shape::Line { a: hinge, b: hinge + DVec2::Y * 0.9 });
        d.group([3.8, 2.3], [9.2, 4.9], &format!("rotate -40 40 about {about}"));
        let plan = understand(&d, &PlanOptions::default(), &mut Report::default()).unwrap();
        let graph = Graph::new(&plan);
        let (axes, _) = structure::axes(&plan, &d);
        let moves = Moves::from_markers(&plan, &graph, &axes, &mut Report::default());
        let doors = Doors::new(&plan, &axes);
        assert_eq!((doors.doors.len(), moves.parameters.len()), (1, 1), "{thick}");
        for turn in [-40.0, -25.0, 3.0, 25.0, 40.0] {
            let layout = moves.apply(&plan, &graph, &[turn]);
            assert_eq!(doors.narrowed(&layout), [], "{thick} {turn}");
            let [a, b] = doors.doors[0].place(&plan, &layout);
            let was = doors.doors[0].at[0].distance(doors.doors[0].at[1]);
            assert!((a.distance(b) - was).abs() < 1e-4, "{thick} {turn}: {} {was}", a.distance(b));
        }
    }
}

//! Doors slide to the side on which there is room, and blocks of rooms are no free-standing elements.

use super::*;
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

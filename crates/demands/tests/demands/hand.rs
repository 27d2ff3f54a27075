//! For every kind of item a plan that passes and one that fails, worked out by hand.

use enfilade_demands::{Building, Exit, Verdict};
use enfilade_engine::geometry::Segment;
use enfilade_plan::axes::OpeningKind;
use enfilade_plan::floor::Beside;
use enfilade_plan::kinds::RoomKind;

use crate::plan::{answer, boxed, first, flat, opening, room, um};

/// What is promised: a centimetre, a tenth of a degree.
const LENGTH_M: f64 = 0.01;
const ANGLE_DEG: f64 = 0.1;

fn near(building: &Building, item: &str, verdict: Verdict, value: f64, by: f64) {
    let (found, measured) = first(building, item);
    assert_eq!(found, verdict, "{item}: {measured:?}");
    let measured = measured.unwrap_or_else(|| panic!("{item} has a value"));
    assert!((measured - value).abs() <= by, "{item}: {measured}, by hand {value}");
}

#[test]
fn areas_and_shapes() {
    let flat = flat();
    near(&flat, "kitchen area min 8.7 m2", Verdict::Pass, 8.7, 1e-6);
    near(&flat, "kitchen area min 8.8 m2", Verdict::Fail, 8.7, 1e-6);
    near(&flat, "kitchen area max 8 m2", Verdict::Fail, 8.7, 1e-6);
    near(&flat, "kitchen area planned 9 m2", Verdict::Pass, 8.7, 1e-6);
    near(&flat, "kitchen area planned 10 m2", Verdict::Fail, 8.7, 1e-6);
    near(&flat, "kitchen width min 2.9 m", Verdict::Pass, 2.9, LENGTH_M);
    near(&flat, "kitchen width min 3 m", Verdict::Fail, 2.9, LENGTH_M);
    // As wide as it is built is wide enough.
    near(&flat, "hall width min 2 m", Verdict::Pass, 2.0, LENGTH_M);
    near(&flat, "\"Box room\" width min 1 m", Verdict::Pass, 1.0, LENGTH_M);
    near(&flat, "hall proportion max 3", Verdict::Pass, 3.0, 1e-6);
    near(&flat, "\"Box room\" proportion max 3", Verdict::Fail, 4.0, 1e-6);
}

#[test]
fn doors_and_windows() {
    let flat = flat();
    near(&flat, "bath has-door", Verdict::Pass, 1.0, 0.0);
    near(&flat, "storage has-door", Verdict::Fail, 0.0, 0.0);
    near(&flat, "kitchen has-window", Verdict::Pass, 1.0, 0.0);
    near(&flat, "bath has-window", Verdict::Fail, 0.0, 0.0);
    // Its entrance may be of glass.
    near(&flat, "hall has-window", Verdict::Untold, 0.0, 0.0);
}

#[test]
fn neighbours_and_ways_between_them() {
    let flat = flat();
    near(&flat, "kitchen next-to bath", Verdict::Pass, 3.0, 1e-6);
    near(&flat, "kitchen next-to storage", Verdict::Fail, 0.0, 1e-6);
    near(&flat, "kitchen not-next-to bath", Verdict::Fail, 3.0, 1e-6);
    near(&flat, "kitchen not-next-to storage", Verdict::Pass, 0.0, 1e-6);
    near(&flat, "kitchen reached-from hall", Verdict::Pass, 1.0, 0.0);
    assert_eq!(first(&flat, "kitchen reached-from bath").0, Verdict::Fail);
    near(&flat, "kitchen reached-from bath through hall", Verdict::Pass, 2.0, 0.0);
    near(&flat, "kitchen reached-from bath through any", Verdict::Pass, 2.0, 0.0);
    assert_eq!(first(&flat, "storage reached-from hall through any").0, Verdict::Fail);
    assert_eq!(first(&flat, "kitchen not-reached-from bath").0, Verdict::Pass);
    assert_eq!(first(&flat, "kitchen not-reached-from hall").0, Verdict::Fail);
}

/// Through the door of 0.8 m in a wall of 0.1 m, from a metre before it: the far jambs lie 1.1 m away, so the view opens by
/// 0.4 in 1.1. Above the axis it is a trapezium of 0.4 and 1.4909 m over 3 m; below it the wall at 1.4 m cuts off a
/// triangle of 0.0909 × 0.25 / 2.
#[test]
fn what_is_seen_of_a_room() {
    let flat = flat();
    let above = f64::midpoint(0.4, 0.4 / 1.1 * 4.1) * 3.0;
    let below = above - (0.4 / 1.1 * 4.1 - 1.4) * 0.25 / 2.0;
    let share = (above + below) / 9.0;
    near(&flat, "bath seen-from 1,1.4 min 60 %", Verdict::Pass, share, 1e-4);
    near(&flat, "bath seen-from 1,1.4 min 65 %", Verdict::Fail, share, 1e-4);
    near(&flat, "bath not-seen-from 1,1.4", Verdict::Fail, share, 1e-4);
    near(&flat, "bath not-seen-from 1,1.4 doors-shut", Verdict::Pass, 0.0, 0.0);
    // Whoever limits what is seen does not ask that it be seen.
    near(&flat, "bath seen-from 1,1.4 facing 180 max 10 %", Verdict::Pass, 0.0, 1e-9);
    near(&flat, "bath seen-from 1,1.4 max 10 %", Verdict::Fail, share, 1e-4);
    // Facing east one sees all of it, facing west nothing, facing north the upper half.
    near(&flat, "bath seen-from 1,1.4 facing 0 min 60 %", Verdict::Pass, share, 1e-4);
    near(&flat, "bath seen-from 1,1.4 facing 180", Verdict::Fail, 0.0, 1e-9);
    near(&flat, "bath seen-from 1,1.4 facing 90", Verdict::Pass, above / 9.0, 1e-4);
    assert_eq!(first(&flat, "bath not-seen-from kitchen doors-shut").0, Verdict::Pass);
    assert_eq!(first(&flat, "bath not-seen-from hall").0, Verdict::Fail);
    assert_eq!(first(&flat, "storage not-seen-from hall").0, Verdict::Pass);
    assert_eq!(first(&flat, "bath seen-from 7,7").0, Verdict::Untold);
}

/// The places of the kitchen lie at x = 2.25 … 4.95 and y = 3.35 … 5.75. Best is 0.45 m before the outer line of the
/// window, 0.85 and 0.65 m from its ends. From the corner (4.95, 3.35) the inner jamb hides all but its last 0.2 m.
#[test]
fn the_angle_of_a_window() {
    let flat = flat();
    let best = ((0.85_f64 / 0.45).atan() + (0.65_f64 / 0.45).atan()).to_degrees();
    let least = ((2.15_f64 / 0.45).atan() - (0.65_f64 / 0.15).atan()).to_degrees();
    near(&flat, "kitchen sight-out best min 54 deg", Verdict::Pass, best, ANGLE_DEG);
    near(&flat, "kitchen sight-out best min 120 deg", Verdict::Fail, best, ANGLE_DEG);
    near(&flat, "kitchen sight-out least min 14 deg", Verdict::Fail, least, ANGLE_DEG);
    near(&flat, "bath sight-out min 14 deg", Verdict::Fail, 0.0, 0.0);
    assert_eq!(first(&flat, "hall sight-out min 1 deg").0, Verdict::Untold);
}

/// From the far corner of the bath past the jamb (2, 1), round the corner of the entrance (1.5, 0), and 0.15 m to the axis of
/// its wall. The kitchen alike, past (2, 4).
#[test]
fn ways_out() {
    let flat = flat();
    let first_leg = 3.1_f64.hypot(2.0);
    let bath = first_leg + 0.5_f64.hypot(1.0) + 0.15;
    let kitchen = first_leg + 0.5_f64.hypot(4.0) + 0.15;
    near(&flat, "bath way-out max 5 m", Verdict::Pass, bath, LENGTH_M);
    near(&flat, "bath way-out max 4.9 m", Verdict::Fail, bath, LENGTH_M);
    near(&flat, "kitchen way-out max 10 m", Verdict::Pass, kitchen, LENGTH_M);
    let straight = 3.6_f64.hypot(6.15);
    near(&flat, "kitchen straight-out max 35 m", Verdict::Pass, straight, LENGTH_M);
    near(&flat, "kitchen straight-out max 7 m", Verdict::Fail, straight, LENGTH_M);
    assert_eq!(first(&flat, "storage way-out max 100 m").0, Verdict::Fail);
    assert_eq!(first(&flat, "storage straight-out max 100 m").0, Verdict::Fail);
    // With one exit there is never a choice.
    near(&flat, "bath dead-end max 5 m", Verdict::Pass, bath, LENGTH_M);
}

/// A corridor of 20 × 2 m with an exit at each end, and a branch of 2 × 8 m in its middle. Along the side of the branch one
/// way leads straight on and the other to the far corner, 2 m across: 45° apart 2 m before the corridor, 6 m from the end.
fn tee() -> Building {
    let outline = [
        [0.0, 0.0],
        [20.0, 0.0],
        [20.0, 2.0],
        [11.0, 2.0],
        [11.0, 10.0],
        [9.0, 10.0],
        [9.0, 2.0],
        [0.0, 2.0],
    ];
    let exit = |x: f64| Exit { line: [um([x, 0.0]), um([x, 2.0])], opening: None };
    Building {
        rooms: vec![room("", RoomKind::Corridor, &outline)],
        exits: vec![exit(0.0), exit(20.0)],
        ..Building::default()
    }
}

#[test]
fn dead_ends() {
    let tee = tee();
    near(&tee, "corridor dead-end max 6.1 m", Verdict::Pass, 6.0, LENGTH_M);
    near(&tee, "corridor dead-end max 5.9 m", Verdict::Fail, 6.0, LENGTH_M);
    // Farthest is the middle of its end, where both ways are as long: past a corner 1 m across, and 9 m on.
    near(&tee, "corridor way-out max 18 m", Verdict::Pass, 9.0 + 1.0_f64.hypot(8.0), LENGTH_M);
    let mut closed = tee;
    closed.rooms.push(room("", RoomKind::Storage, &boxed([30.0, 0.0], [32.0, 2.0])));
    assert_eq!(first(&closed, "storage dead-end max 6 m").0, Verdict::Fail);
}

#[test]
fn where_no_exit_is_known_nothing_is_told() {
    let mut flat = flat();
    flat.openings.remove(2);
    assert_eq!(first(&flat, "rooms way-out max 35 m").0, Verdict::Untold);
    // A stair is an exit then, by its doors.
    flat.rooms[2].kind = RoomKind::Stair;
    assert_eq!(first(&flat, "hall way-out max 35 m").0, Verdict::Pass);
}

/// An opening of 0.9 m has at least 0.826 m clear.
#[test]
fn clear_widths() {
    let flat = flat();
    let verdict = |item: &str| answer(&flat, item).findings.iter().map(|f| f.verdict).collect::<Vec<_>>();
    assert_eq!(verdict("doors clear-width min 0.7 m"), [Verdict::Pass; 3]);
    assert_eq!(verdict("doors clear-width min 0.9 m"), [Verdict::Untold, Verdict::Fail, Verdict::Pass]);
    assert_eq!(verdict("doors of kitchen clear-width min 0.9 m"), [Verdict::Untold]);
    assert_eq!(verdict("doors clear-width max 0.95 m")[2], Verdict::Fail);
    // Five people need 0.875 m, twenty a metre.
    near(&flat, "hall wide-for 5 people", Verdict::Pass, 1.0, 1e-9);
    near(&flat, "kitchen wide-for 5 people", Verdict::Untold, 0.9, 1e-9);
    near(&flat, "bath wide-for 5 people", Verdict::Fail, 0.8, 1e-9);
    assert_eq!(first(&flat, "bath wide-for 500 people").0, Verdict::Untold);
}

/// A corridor of 10 × 2 m with a pier of 1 × 0.8 m at its side.
#[test]
fn a_pier_narrows_a_corridor() {
    let pier =
        [[0.0, 0.0], [4.0, 0.0], [4.0, 0.8], [5.0, 0.8], [5.0, 0.0], [10.0, 0.0], [10.0, 2.0], [0.0, 2.0]];
    let end = |x: f64, beside| opening(OpeningKind::Door, [[x, 0.5], [x, 1.5]], 0.1, beside);
    let corridor = |outline: &[[f64; 2]]| Building {
        rooms: vec![room("", RoomKind::Corridor, outline)],
        openings: vec![
            end(-0.05, [Beside::Outside, Beside::Room(0)]),
            end(10.05, [Beside::Room(0), Beside::Outside]),
        ],
        ..Building::default()
    };
    near(&corridor(&pier), "corridor clear-width min 1.1 m", Verdict::Pass, 1.2, LENGTH_M);
    near(&corridor(&pier), "corridor clear-width min 1.5 m", Verdict::Fail, 1.2, LENGTH_M);
    let plain = boxed([0.0, 0.0], [10.0, 2.0]);
    near(&corridor(&plain), "corridor clear-width min 1.5 m", Verdict::Pass, 2.0, LENGTH_M);
}

#[test]
fn room_to_turn() {
    let mut flat = flat();
    near(&flat, "hall turning-circle min 1.5 m", Verdict::Pass, 2.0, LENGTH_M);
    near(&flat, "storage turning-circle min 1.5 m", Verdict::Fail, 1.0, LENGTH_M);
    // In a bare bath it fits; what will stand there is not drawn.
    near(&flat, "bath turning-circle min 1.5 m", Verdict::Untold, 3.0, LENGTH_M);
    // A bench along its middle leaves 1.4 m on one side and 1.6 m on the other.
    let bench = |y: f64| Segment { a: um([2.1, y]), b: um([5.1, y]) };
    flat.things = vec![bench(1.4)];
    near(&flat, "bath turning-circle min 1.5 m", Verdict::Pass, 1.6, LENGTH_M);
    near(&flat, "bath turning-circle min 1.7 m", Verdict::Fail, 1.6, LENGTH_M);
}

/// The doors of the flat have a metre and more beside them. One stands 0.1 m from a corner: it depends on its leaf.
#[test]
fn wall_beside_handles() {
    let mut flat = flat();
    near(&flat, "doors of bath beside-handle min 0.5 m", Verdict::Pass, 1.0, LENGTH_M);
    let corner = [[2.05, 0.1], [2.05, 0.9]];
    flat.openings[1] = opening(OpeningKind::Door, corner, 0.1, [Beside::Room(0), Beside::Room(2)]);
    near(&flat, "doors of bath beside-handle min 0.5 m", Verdict::Untold, 0.1, LENGTH_M);
    let leaf = |y: f64| boxed([2.1, y], [2.9, y + 0.04]).map(um).to_vec();
    flat.openings[1].leaves = vec![leaf(0.86)];
    near(&flat, "doors of bath beside-handle min 0.5 m", Verdict::Fail, 0.1, LENGTH_M);
    flat.openings[1].leaves = vec![leaf(0.1)];
    assert_eq!(first(&flat, "doors of bath beside-handle min 0.5 m").0, Verdict::Pass);
}

/// A leaf that stands open is drawn as a notch in its room: the floor under it counts.
#[test]
fn the_floor_under_a_leaf_counts() {
    let mut flat = flat();
    let notched =
        [[2.1, 0.0], [5.1, 0.0], [5.1, 3.0], [2.1, 3.0], [2.1, 1.8], [2.9, 1.8], [2.9, 1.76], [2.1, 1.76]];
    flat.rooms[2] = room("Bath", RoomKind::Bath, &notched);
    near(&flat, "bath area min 9 m2", Verdict::Fail, 9.0 - 0.8 * 0.04, 1e-6);
    flat.openings[1].leaves = vec![boxed([2.1, 1.76], [2.9, 1.8]).map(um).to_vec()];
    near(&flat, "bath area min 9 m2", Verdict::Pass, 9.0, 1e-6);
}

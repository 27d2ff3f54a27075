//! What stands beside walls holds them or ends their ways, and what stands near others does not stand free.

use super::*;
use enfilade_plan::obstacles::{LINE_MAX_M, OUTLINE_MAX_M2};

/// The partition at x = 6 with something drawn east of it.
fn beside(draw: impl Fn(&mut Drawing)) -> Option<[f64; 2]> {
    let mut d = house_with_partition(0.0);
    draw(&mut d);
    way_of_partition(&d)
}

fn outline(layer: &'static str, x: [f64; 2], y: [f64; 2]) -> impl Fn(&mut Drawing) {
    move |d| d.ring(layer, &[[x[0], y[0]], [x[1], y[0]], [x[1], y[1]], [x[0], y[1]]])
}

const FREE: Option<[f64; 2]> = Some([-0.6, 0.6]);
const ENDED: Option<[f64; 2]> = Some([-0.6, 0.3]);

#[test]
fn a_partition_keeps_off_what_stands_on_the_floor() {
    for layer in ["0", "A-CASE", "MACHINES", "A-FLOR"] {
        assert_eq!(beside(outline(layer, [6.4, 7.0], [1.0, 3.0])), ENDED, "{layer}");
        assert_eq!(beside(outline(layer, [6.06, 7.0], [1.0, 3.0])), None, "{layer}: it stands at the wall");
        assert_eq!(beside(outline(layer, [5.5, 7.0], [1.0, 3.0])), None, "{layer}: it stands in the wall");
    }
    for layer in ["A-NOTE", "A-DIMS", "AREA-GROSS", "A-GRID"] {
        assert_eq!(beside(outline(layer, [6.4, 7.0], [1.0, 3.0])), FREE, "{layer}");
    }
}

#[test]
fn outlines_of_rooms_and_long_lines_are_no_things() {
    let high = |area: f64| [1.0, 1.0 + area / 2.0];
    assert_eq!(beside(outline("0", [6.4, 8.4], high(OUTLINE_MAX_M2 - 0.01))), ENDED);
    assert_eq!(beside(outline("0", [6.4, 8.4], high(OUTLINE_MAX_M2 + 0.01))), FREE);
    let line = |length: f64| {
        beside(|d| {
            d.add("0", Shape::Line { a: DVec2::new(6.4, 0.4), b: DVec2::new(6.4, 0.4 + length) });
        })
    };
    assert_eq!(line(LINE_MAX_M - 0.01), ENDED);
    assert_eq!(line(LINE_MAX_M + 0.01), FREE);
}

#[test]
fn a_cross_over_a_lift_holds_the_walls_of_its_shaft() {
    let cross = |x: f64| {
        beside(|d| {
            for [a, b] in [[0.2, 2.8], [2.8, 0.2]] {
                d.add("A-FLOR", Shape::Line { a: DVec2::new(x, a), b: DVec2::new(x + 1.5, b) });
            }
        })
    };
    assert_eq!(cross(6.05), None);
    assert_eq!(cross(6.4), ENDED);
    assert_eq!(cross(9.0), FREE);
    // A lift's door stays where it is.
    let with = |x: f64| {
        let mut d = house_with_gap();
        for [a, b] in [[1.0, 4.0], [4.0, 1.0]] {
            d.add("A-FLOR", Shape::Line { a: DVec2::new(x, a), b: DVec2::new(x + 2.0, b) });
        }
        groups_named(&d, "door").0
    };
    assert_eq!((with(6.05), with(9.0)), (0, 1));
}

/// A building of 18 by 6 m with partitions at x = 4, 9 and 14 of their own thicknesses.
fn partitions_of(thick: [f64; 3]) -> usize {
    let mut d = drawing("m", 1.0);
    d.room(18.0, 6.0);
    d.line(0.3, 0.3, 0.3, 5.7);
    d.line(17.7, 0.3, 17.7, 5.7);
    let mut from = 0.3;
    for (x, t) in [4.0, 9.0, 14.0].into_iter().zip(thick) {
        for y in [0.3, 5.7] {
            d.line(from, y, x - t / 2.0, y);
        }
        for side in [-t / 2.0, t / 2.0] {
            d.line(x + side, 0.3, x + side, 5.7);
        }
        from = x + t / 2.0;
    }
    for y in [0.3, 5.7] {
        d.line(from, y, 17.7, y);
    }
    by_default(&d).2.groups.len()
}

#[test]
fn what_is_far_thicker_than_the_other_partitions_carries() {
    assert_eq!(partitions_of([0.1, 0.1, 0.1]), 3);
    assert_eq!(partitions_of([0.1, 0.1, 0.19]), 3);
    assert_eq!(partitions_of([0.1, 0.1, 0.21]), 2);
    assert_eq!(partitions_of([0.15, 0.15, 0.29]), 3, "no more than twice as thick");
    assert_eq!(partitions_of([0.15, 0.15, 0.31]), 2);
    assert_eq!(partitions_of([0.06, 0.06, 0.19]), 3, "too thin to carry, whatever the others are");
}

/// A building of 12 by 6 m with a partition at x = 6 that has a gap from y = 2 to 2.9.
pub(super) fn house_with_gap() -> Drawing {
    let mut d = drawing("m", 1.0);
    d.room(12.0, 6.0);
    for x in [0.2, 11.8] {
        d.line(x, 0.2, x, 5.8);
    }
    for (y, [a, b]) in [0.2, 5.8].iter().flat_map(|y| [(*y, [0.2, 5.95]), (*y, [6.05, 11.8])]) {
        d.line(a, y, b, y);
    }
    for x in [5.95, 6.05] {
        d.line(x, 0.2, x, 2.0);
        d.line(x, 2.9, x, 5.8);
    }
    for y in [2.0, 2.9] {
        d.line(5.95, y, 6.05, y);
    }
    d
}

/// How many groups of a word there are, and the bounds of the first.
fn groups_named(d: &Drawing, word: &str) -> (usize, Option<[f64; 2]>) {
    let moves = by_default(d).2;
    let named: Vec<_> = moves.parameters.iter().filter(|p| p.group_name.starts_with(word)).collect();
    (named.len(), named.first().map(|p| [p.clause.lower, p.clause.upper]))
}

fn swing(d: &mut Drawing) {
    let quarter = std::f64::consts::FRAC_PI_2;
    let centre = DVec2::new(6.05, 2.0);
    d.add("DOORS", Shape::Arc { centre, radius: 0.9, start_rad: 0.0, end_rad: quarter });
}

#[test]
fn a_wall_with_a_window_is_an_outer_wall() {
    let mut d = house_with_gap();
    assert_eq!(groups_named(&d, "wall").0, 1);
    for x in [5.98, 6.02] {
        d.add("WINDOWS", Shape::Line { a: DVec2::new(x, 2.0), b: DVec2::new(x, 2.9) });
    }
    assert_eq!(groups_named(&d, "wall").0, 0);
}

#[test]
fn what_would_leave_a_part_of_its_door_behind_stays() {
    let mut d = house_with_gap();
    swing(&mut d);
    assert_eq!((groups_named(&d, "wall").0, groups_named(&d, "door").0), (1, 1));
    // A leaf in its pocket that is not told as part of the door.
    d.add("DOORS", Shape::Line { a: DVec2::new(6.0, 1.0), b: DVec2::new(6.0, 1.95) });
    assert_eq!((groups_named(&d, "wall").0, groups_named(&d, "door").0), (0, 0));
}

#[test]
fn a_door_slides_up_to_what_stands_at_its_wall() {
    let with = |y: f64| {
        let mut d = house_with_gap();
        outline("0", [6.1, 6.7], [y, y + 0.8])(&mut d);
        groups_named(&d, "door").1
    };
    assert_eq!(with(4.5), Some([-0.5, 0.5]));
    assert_eq!(with(3.2), Some([-0.5, 0.3]));
    assert_eq!(with(2.95), None, "it stands in the doorway");
}

#[test]
fn what_reaches_far_beyond_an_opening_is_no_part_of_it() {
    let records = |x: [f64; 2], y: [f64; 2]| {
        let mut d = house_with_gap();
        outline("GLAZING", x, y)(&mut d);
        let record = d.entities.len() - 1;
        let mut report = Report::default();
        let plan = understand(&d, &PlanOptions::default(), &mut report).unwrap();
        let (axes, marked) = structure::axes(&plan, &d);
        let found = fittings::fittings(&plan, &d, &axes, &marked);
        found.iter().filter(|f| f.source.record == record).count()
    };
    assert_eq!(records([5.98, 6.02], [2.0, 2.9]), 1, "a pane");
    assert_eq!(records([6.0, 11.0], [0.5, 5.5]), 0, "an outline of a room that runs through the gap");
}

#[test]
fn an_element_stands_free_of_walls_and_things() {
    let element = |to: f64, desk: Option<f64>| {
        let mut d = drawing("m", 1.0);
        d.room(20.0, 10.0);
        d.line(10.0, 0.0, 10.0, 10.0);
        for y in [4.0, 4.2] {
            d.line(4.0, y, to, y);
        }
        if let Some(x) = desk {
            outline("0", [x, x + 1.0], [3.0, 5.0])(&mut d);
        }
        groups_named(&d, "element")
    };
    let gap = defaults::STANDS_FREE_M;
    assert_eq!(element(10.0 - gap - 0.01, None).0, 3);
    assert_eq!(element(10.0 - gap + 0.01, None).0, 0);
    assert_eq!(element(6.0, None), (3, Some([-SHIFT_M, SHIFT_M])));
    let (count, x) = element(6.0, Some(6.6));
    assert!(count > 0 && x.is_some_and(|x| x[0] == -SHIFT_M && x[1] <= 0.55), "{count} {x:?}");
    assert_eq!(element(6.0, Some(6.04)).0, 0, "a desk stands at it");
}

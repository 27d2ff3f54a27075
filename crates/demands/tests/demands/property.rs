//! What holds on any plan.

use enfilade_demands::{Building, Exit, Verdict};
use enfilade_plan::kinds::RoomKind;
use proptest::prelude::*;

use crate::plan::{answer, first, room, um};

/// A room round a centre, star-shaped: eight corners at 2 to 6 m.
fn star() -> impl Strategy<Value = Vec<[f64; 2]>> {
    prop::collection::vec(2.0_f64..6.0, 8).prop_map(|radii| {
        let corner = |(k, r): (usize, &f64)| {
            let (sin, cos) = (std::f64::consts::TAU * k as f64 / 8.0).sin_cos();
            [(10.0 + r * cos) * 1e3, (10.0 + r * sin) * 1e3].map(|v| v.round() / 1e3)
        };
        radii.iter().enumerate().map(corner).collect()
    })
}

fn hall(outline: &[[f64; 2]]) -> Building {
    let exit = Exit { line: [um(outline[0]); 2], opening: None };
    Building { rooms: vec![room("", RoomKind::Hall, outline)], exits: vec![exit], ..Building::default() }
}

fn value(building: &Building, item: &str) -> f64 {
    first(building, item).1.unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, ..ProptestConfig::default() })]

    #[test]
    fn a_walk_is_no_shorter_than_a_straight_line(outline in star()) {
        let hall = hall(&outline);
        let [walk, straight] = ["way-out", "straight-out"].map(|w| value(&hall, &format!("hall {w} max 1 m")));
        prop_assert!(walk >= straight - 0.01);
    }

    #[test]
    fn turned_and_moved_plans_have_the_same_values(outline in star(), turn in 0.0_f64..6.0) {
        let (sin, cos) = turn.sin_cos();
        let moved: Vec<[f64; 2]> =
            outline.iter().map(|[x, y]| [x * cos - y * sin + 300.0, x * sin + y * cos - 70.0]).collect();
        for item in ["area min 1 m2", "width min 1 m", "proportion max 2", "way-out max 9 m"] {
            let item = format!("hall {item}");
            let [here, there] = [hall(&outline), hall(&moved)].map(|h| value(&h, &item));
            prop_assert!((here - there).abs() < 0.011, "{item}: {here} {there}");
        }
    }

    #[test]
    fn who_stands_in_the_middle_of_a_star_sees_all_of_it(outline in star()) {
        let hall = hall(&outline);
        let found = answer(&hall, "hall seen-from 10,10 min 99.99 %");
        prop_assert_eq!(found.verdict, Verdict::Pass);
    }
}

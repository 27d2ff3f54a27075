//! Plans drawn in the styles of many offices give the same graph. All of them: `benches/understanding.rs`.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use crate::offices::plans::Kind;
use crate::offices::score::{explain, has_right_unit, score};
use crate::offices::styles::{LAYERS, Office, STYLES, Style, UNITS, draw, drawn};
use enfilade_plan::axes::AxisGraph;

fn check(numbers: &[u64], noise: bool) {
    for n in numbers {
        let plan = crate::offices::plans::plan(*n);
        for style in STYLES {
            let layers = *n as usize % LAYERS.len();
            let office = Office { layers, blocks: n % 2 == 1, ..Office::new(style, noise) };
            let graph = AxisGraph::new(&drawn(&draw(&plan, &office, *n), &office));
            let s = score(&plan, &graph, style != Style::CentreLines);
            assert!(s.holds(), "{} {style:?}: {s:?}\n{}", plan.name, explain(&plan, &graph).join("\n"));
            // Without a door one line a wall shows nothing but its size: then the file is believed.
            let has_door = plan.gaps.iter().any(|g| g.kind == Kind::Door);
            let shows_unit = style != Style::CentreLines || has_door;
            for (unit_m, declared) in UNITS.into_iter().filter(|_| shows_unit) {
                let office = Office { unit_m, declared, ..office };
                let is_right = has_right_unit(&draw(&plan, &office, *n), &office);
                assert!(is_right, "{} {style:?}: drawn in {unit_m}, declared {declared:?}", plan.name);
            }
            assert!(s.thickness.f1() > 0.97, "{} {style:?}: {s:?}", plan.name);
        }
    }
}

#[test]
fn plans_as_meant() {
    check(&[0, 2, 7, 11], false);
}

#[test]
fn plans_with_slips_of_the_hand() {
    check(&[1, 5, 8, 14], true);
}

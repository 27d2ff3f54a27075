//! One house in the habits of offices: swings of many chords, windows as rectangles, leaves without swings, frames on the
//! walls' layer, slips of the hand. Each is understood like the others.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a failing helper fails the test")]

use enfilade_cad::dxf::{ReadOptions, read};
use enfilade_config::{Partial, Settings};
use enfilade_fixtures::corridor::{
    Rect, WINDOWS, corners, doors, drawing, leaf, line, panes, polyline, swings, walls,
};
use enfilade_moves::defaults::GROUPS_MAX;
use enfilade_overlay::result::CheckResult;
use enfilade_pipeline::{Input, Outcome};
use enfilade_plan::{PlanOptions, fittings, structure, understand};
use enfilade_report::Error;
use enfilade_report::{Cancel, Report};

fn try_check(entities: &str) -> Result<Outcome<CheckResult>, Error> {
    let settings = Settings::new(Partial::default()).unwrap();
    enfilade_pipeline::check(&Input::new("plan.dxf", drawing(entities).as_bytes(), 1), &settings)
}

fn check(entities: &str) -> CheckResult {
    try_check(entities).unwrap().result
}

/// What is understood of the house drawn as it should be.
const WHOLE: &str = "40 walls and 0 columns understood; 8 doors, 7 windows, 0 passages";

fn understood(result: &CheckResult) -> &str {
    result.statements.iter().find(|s| s.contains("understood")).unwrap()
}

#[test]
fn the_house_as_it_should_be() {
    let result = check(&(walls("A-WALL") + &panes("A-GLAZ") + &swings("A-DOOR")));
    assert_eq!(understood(&result), WHOLE);
    assert_eq!(result.moves.len(), GROUPS_MAX);
}

/// All that lies on the layer of the walls is smaller than what can be measured.
#[test]
fn specks_are_no_walls() {
    for (x, y) in [(0.0003, 0.0), (0.0, 0.0), (0.0009, 0.0009)] {
        let speck = line("A-WALL", [3.0, 3.0, 3.0 + x, 3.0 + y]);
        let error = try_check(&speck).unwrap_err();
        assert!(error.to_string().starts_with("plan.dxf: no entity"), "{error}");
        assert_eq!(error.exit_code(), 2);
    }
    assert!(try_check(&line("A-WALL", [3.0, 3.0, 3.0011, 3.0])).is_ok());
}

/// The lines of a window on its jambs are no window of the pier beside it.
#[test]
fn windows_drawn_as_rectangles_are_all_found() {
    for share in [[0.0, 1.0], [0.4, 0.6], [0.0, 0.3]] {
        let boxes = WINDOWS.map(|[x0, y0, x1, y1]| {
            let [low, high] = share.map(|s| y0 + s * (y1 - y0));
            corners([x0, low, x1, high])
        });
        let rings: String = boxes.iter().map(|b| polyline("A-GLAZ", b, true)).collect();
        let side = |b: &[[f64; 2]; 4], k: usize| {
            let ([x0, y0], [x1, y1]) = (b[k], b[(k + 1) % 4]);
            line("A-GLAZ", [x0, y0, x1, y1])
        };
        let sides: String = boxes.iter().flat_map(|b| (0..4).map(move |k| side(b, k))).collect();
        for windows in [rings, sides] {
            let result = check(&(walls("A-WALL") + &windows + &swings("A-DOOR")));
            assert_eq!(understood(&result), WHOLE, "{share:?}");
            assert_eq!(result.moves.len(), GROUPS_MAX);
        }
    }
}

/// How many panes of glass go along with walls, and how many of the last entities.
fn carried(entities: &str, last: usize) -> (usize, usize) {
    let mut report = Report::default();
    let drawing =
        read("plan.dxf", drawing(entities).as_bytes(), &ReadOptions::default(), &mut report).unwrap();
    let plan = understand(&drawing, &PlanOptions::default(), &mut report).unwrap();
    let (axes, marked) = structure::axes(&plan, &drawing);
    let fittings = fittings::fittings(&plan, &drawing, &axes, &marked);
    let goes_along = |record: usize| fittings.iter().any(|f| f.source.record == record);
    let last = &drawing.entities[drawing.entities.len() - last..];
    (
        fittings.iter().filter(|f| f.source.layer == "A-GLAZ").count(),
        last.iter().filter(|e| goes_along(e.source.record)).count(),
    )
}

/// Leaf and swing go along together, whatever the swing is drawn as and wherever.
#[test]
fn a_swing_of_chords_goes_with_its_leaf() {
    let leaves: String = doors().iter().map(|d| leaf("A-WALL", d, 1.0)).collect();
    let house = walls("A-WALL") + &panes("A-GLAZ");
    for chords in [6, 24] {
        let swings: String = doors().iter().map(|d| polyline("A-WALL", &d.swing(chords), false)).collect();
        let entities = house.clone() + &swings + &leaves;
        assert_eq!(understood(&check(&entities)), WHOLE, "{chords}");
        let (panes, doors_last) = carried(&entities, 2 * doors().len());
        assert_eq!((panes, doors_last), (3 * WINDOWS.len(), 2 * doors().len()), "{chords}");
    }
}

/// A leaf alone is a door where it is as long as the gap at whose jamb it hangs.
#[test]
fn leaves_without_swings_are_doors() {
    let slip = |layer: &str| -> String {
        let ring = |d: &enfilade_fixtures::corridor::Door| {
            let ([hx, hy], [ex, ey]) = (d.hinge, d.leaf_end(1.0));
            let [tx, ty] = [0, 1].map(|k| 0.04 * (d.tip[k] - d.hinge[k]) / d.width());
            polyline(layer, &[[hx, hy], [ex, ey], [ex + tx, ey + ty], [hx + tx, hy + ty]], true)
        };
        doors().iter().map(ring).collect()
    };
    let open =
        |layer: &str, share: f64| -> String { doors().iter().map(|d| leaf(layer, d, share)).collect() };
    for [wall, glass, door] in [["A-WALL", "A-GLAZ", "A-DOOR"]] {
        let house = walls(wall) + &panes(glass);
        for leaves in [open(door, 1.0), open(door, 0.5), slip(door)] {
            let entities = house.clone() + &leaves;
            let result = check(&entities);
            assert_eq!(understood(&result), WHOLE, "{door}");
            assert_eq!(result.moves.len(), GROUPS_MAX, "{door}");
            let doors = doors().len();
            assert_eq!(carried(&entities, doors), (3 * WINDOWS.len(), doors), "{door}");
        }
    }
}

/// A rectangle with screens in it is the outer wall of a gallery.
#[test]
fn the_outer_wall_of_a_gallery_stays() {
    let outer = polyline("0", &corners([0.0, 0.0, 20.0, 14.0]), true);
    let single =
        [[4.0, 4.0, 4.0, 10.0], [8.0, 4.0, 14.0, 4.0], [16.0, 4.0, 16.0, 10.0], [8.0, 10.0, 14.0, 10.0]];
    let lines: String = single.into_iter().map(|s| line("0", s)).collect();
    assert_eq!(check(&(outer + &lines)).wall_elements, 5);
}

/// Faces that a hand drew some millimetres askew: doors go along by default nonetheless.
#[test]
fn slips_of_the_hand_hold_no_door_back() {
    let slip = |k: usize| ((k * 7919 % 101) as f64 / 50.0 - 1.0) * 0.003;
    let askew = |(i, f): (usize, Rect)| line("A-WALL", [0, 1, 2, 3].map(|k| f[k] + slip(4 * i + k)));
    let house: String = enfilade_fixtures::corridor::faces().into_iter().enumerate().map(askew).collect();
    let entities = house + &panes("A-GLAZ") + &swings("A-DOOR");
    let result = check(&entities);
    assert_eq!(understood(&result), WHOLE);
    assert_eq!(result.moves.len(), GROUPS_MAX);
    let problems = try_check(&entities).unwrap().report.problems;
    assert!(problems.iter().all(|p| p.code != "default-moves-stay"), "{problems:?}");
}

/// A free-standing column is no floor, and moves as far, whether it is one outline or four lines.
#[test]
fn a_column_of_lines_is_one_drawn_as_an_outline() {
    let ring = corners([2.0, 1.6, 2.8, 2.4]);
    let sides: String = (0..4)
        .map(|k| {
            let ([x0, y0], [x1, y1]) = (ring[k], ring[(k + 1) % 4]);
            line("A-WALL", [x0, y0, x1, y1])
        })
        .collect();
    let settings = |more: Partial| {
        Settings::new(Partial { spacing: Some(0.4), penalty: Some("none".into()), ..more }).unwrap()
    };
    let [of_lines, of_outline] = [sides, polyline("A-WALL", &ring, true)].map(|column| {
        let house = walls("A-WALL") + &panes("A-GLAZ") + &swings("A-DOOR") + &column;
        // Without a region and with one, which the column stands in.
        let region = polyline("EF-QUERY", &corners([0.5, 0.5, 4.7, 3.7]), true);
        [house.clone(), house + &region].map(|entities| {
            let text = drawing(&entities);
            let input = Input::new("plan.dxf", text.as_bytes(), 1);
            let done = enfilade_pipeline::analyse(&input, &settings(Partial::default()), &Cancel::default())
                .unwrap();
            let search = settings(Partial {
                evaluations: Some(15),
                seed: Some(1),
                members: Some(2),
                objective: Some("degree max 0.01".into()),
                ..Partial::default()
            });
            let now = std::time::Instant::now();
            let found =
                enfilade_pipeline::run(&input, &search, now, &mut |_| (), &Cancel::default()).unwrap();
            let parameters: Vec<_> = found.result.candidates.iter().map(|c| c.parameters.clone()).collect();
            (done.0.result.mean, parameters)
        })
    });
    assert_eq!(of_lines, of_outline);
    assert!(of_lines.iter().all(|of| !of.1.is_empty()));
}

/// How many lines of the only layer are read as glass, where a window is drawn as its panes between two jambs.
fn panes_on(layer: &str, turn_deg: f64) -> usize {
    let (sin, cos) = turn_deg.to_radians().sin_cos();
    let turned = |x: f64, y: f64| [x * cos - y * sin, x * sin + y * cos];
    let side = |[x0, y0, x1, y1]: [f64; 4]| {
        let ([a, b], [c, d]) = (turned(x0, y0), turned(x1, y1));
        line(layer, [a, b, c, d])
    };
    let jambs = [4.0, 5.5].map(|x| [x, 0.0, x, 0.3]);
    let faces = [[0.0, 4.0], [5.5, 10.0]].map(|[a, b]| [[a, 0.0, b, 0.0], [a, 0.3, b, 0.3]]);
    let rest = [
        [10.0, 0.0, 10.0, 7.0],
        [9.7, 0.3, 9.7, 6.7],
        [10.0, 7.0, 0.0, 7.0],
        [9.7, 6.7, 0.3, 6.7],
        [0.0, 7.0, 0.0, 0.0],
        [0.3, 6.7, 0.3, 0.3],
    ];
    let panes = [0.0, 0.15, 0.3].map(|y| [4.0, y, 5.5, y]);
    let all = faces.concat().into_iter().chain(jambs).chain(rest).chain(panes);
    let result = check(&all.map(side).collect::<String>());
    assert_eq!(result.windows, 1, "{layer}");
    result.reading.unwrap().entities.iter().filter(|e| e.role == "window").count()
}

/// Lines from jamb to jamb of a window are glass, unless their layer is named after walls.
#[test]
fn what_runs_through_a_window_is_glass() {
    for turn_deg in [0.0, 1.0, 17.0, 45.0] {
        assert_eq!((panes_on("10", turn_deg), panes_on("A-WALL", turn_deg)), (3, 0), "{turn_deg}");
    }
}

/// A window drawn on the layer of the walls between their faces, which run through: two lines across and two along, however
/// far apart, be it as far as a partition is thick.
#[test]
fn windows_in_walls_drawn_through_are_found() {
    let outline = |rect: Rect| -> String {
        let around = corners(rect);
        (0..4)
            .map(|k| [around[k], around[(k + 1) % 4]].concat().try_into().unwrap())
            .map(|l| line("A-WALL", l))
            .collect()
    };
    let house = |[w, h]: [f64; 2]| outline([0.0, 0.0, w, h]) + &outline([0.3, 0.3, w - 0.3, h - 0.3]);
    let window = |apart: f64| {
        let [inner, outer] = [9.85 - apart / 2.0, 9.85 + apart / 2.0];
        let across = [2.5, 4.0].map(|y| [9.7, y, 10.0, y]);
        let along = [inner, outer].map(|x| [x, 2.5, x, 4.0]);
        across.into_iter().chain(along).map(|l| line("A-WALL", l)).collect::<String>()
    };
    let plain = house([10.0, 7.0]) + &outline([3.94, 0.3, 4.06, 6.7]);
    assert_eq!(check(&plain).windows, 0);
    for apart in [0.04, 0.05, 0.06, 0.07, 0.1, 0.12] {
        assert_eq!(check(&(plain.clone() + &window(apart))).windows, 1, "{apart}");
    }
    // Radiators before a wall, as far from its face as a partition is thick.
    let radiator = |x: f64| outline([x, 0.35, x + 1.2, 0.45]) + &line("A-WALL", [x, 0.4, x + 1.2, 0.4]);
    let heated = house([12.0, 8.0]) + &outline([5.0, 0.3, 5.15, 5.0]) + &radiator(1.0) + &radiator(7.0);
    assert_eq!(check(&heated).windows, 0);
}

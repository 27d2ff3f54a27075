//! Doors of a building that slide along their walls with their openings.

use super::*;
use enfilade_cad::curve::control_points;
use enfilade_cad::drawing::Slot;
use enfilade_engine::Region;
use enfilade_plan::markers::read_clauses;

/// A corridor wall from x = 0 to 20 at y = 6, with doors that begin and end at such places, and other walls.
fn corridor(doors: &[[f64; 2]], walls: &[(usize, [f64; 2], [f64; 2])]) -> Drawing {
    let mut d = building(walls);
    let (host, [low, high]) = (50, [6.0, 6.2]);
    let ring = |x: [f64; 2]| [[x[0], low], [x[1], low], [x[1], high], [x[0], high]];
    let places: Vec<f64> = [0.0].into_iter().chain(doors.iter().flatten().copied()).chain([20.0]).collect();
    for (k, piece) in places.chunks(2).enumerate() {
        d.ring("WALLS", &ring([piece[0], piece[1]]));
        let e = d.entities.last_mut().unwrap();
        e.source.record = host;
        let first = if k == 0 { vec![0, 3] } else { Vec::new() };
        let second = if k == doors.len() { vec![1, 2] } else { Vec::new() };
        e.editable = Editable::Wall { ends: [first, second], free: [f64::INFINITY; 2] };
    }
    for (k, x) in doors.iter().enumerate() {
        let closing = 70 + k;
        d.ring(DOOR_LAYER, &ring(*x));
        d.entities.last_mut().unwrap().source.record = closing;
        d.hosts.insert(closing, host);
        let corners = ring(*x).map(DVec2::from);
        d.slots.push(Slot {
            source: source(80 + k, DOOR_LAYER),
            host,
            closing: source(closing, DOOR_LAYER),
            outline: corners.to_vec(),
            jambs: [vec![corners[0], corners[3]], vec![corners[1], corners[2]]],
            along: DVec2::X,
            free: [places[2 * k] - x[0], places[2 * k + 3] - x[1]],
        });
    }
    d
}

/// Bounds of the doors by default, in their order.
fn ways(d: &Drawing) -> Vec<[f64; 2]> {
    let (plan, _, moves) = by_default(d);
    assert_eq!(plan.slots.len(), d.slots.len());
    let all = moves.parameters.iter().zip(moves.bounds());
    let doors = all.filter(|(p, _)| !moves.groups[p.group].slots.is_empty());
    doors.map(|(_, b)| b.map(|v| (v * 1e3).round() / 1e3)).collect()
}

#[test]
fn a_door_slides_with_its_opening_and_its_wall_stays() {
    let d = corridor(&[[9.0, 9.9]], &[]);
    let (plan, graph, moves) = by_default(&d);
    assert_eq!(ways(&d), [[-0.5, 0.5]]);
    let slides = |k: usize| !moves.groups[moves.parameters[k].group].slots.is_empty();
    for by in [-0.5, 0.0, 0.3] {
        let at: Vec<f64> = (0..moves.parameters.len()).map(|k| if slides(k) { by } else { 0.0 }).collect();
        let layout = moves.apply(&plan, &graph, &at);
        assert_eq!(layout.walls.len(), 2);
        for wall in &layout.walls {
            let own = &plan.walls[wall.wall as usize];
            assert!(!wall.is_rebuilt() && wall.motion.is_none() && wall.ends.is_none());
            assert_eq!(wall.is_changed, by != 0.0);
            for (p, q) in control_points(&own.shape).iter().zip(control_points(&wall.shape)) {
                let is_side = p.x > 1.0 && p.x < 19.0;
                let expected = if is_side { *p + DVec2::X * by } else { *p };
                assert!(q.distance(expected) < 1e-9, "{p} to {q}");
            }
        }
        assert_eq!(layout.slid(0).map(|s| s.x), (by != 0.0).then_some(by));
    }
}

#[test]
fn doors_of_one_wall_share_what_is_between_them() {
    assert_eq!(ways(&corridor(&[[9.0, 9.9], [10.5, 11.4]], &[])), [[-0.5, 0.25], [-0.25, 0.5]]);
    // A pier as narrow as one may be.
    assert_eq!(ways(&corridor(&[[9.0, 9.9], [10.0, 10.9]], &[])), [[-0.5, 0.0], [0.0, 0.5]]);
}

#[test]
fn a_door_stops_before_what_stands_at_its_wall() {
    // A partition that ends at the corridor, 0.3 m east of the door, and stays since it carries.
    let mut d = corridor(&[[9.0, 9.9]], &[(1, [10.2, 10.4], [0.0, 6.0])]);
    d.bearing.insert(1, Bearing::Stated);
    let [way] = ways(&d)[..] else { panic!("one door") };
    assert!(way[0] == -0.5 && (0.2..=0.3).contains(&way[1]), "{way:?}");
    // A wall that carries has no door that slides, nor has an opening as wide as a gate.
    let mut d = corridor(&[[9.0, 9.9]], &[]);
    d.bearing.insert(50, Bearing::Stated);
    assert_eq!(ways(&d), Vec::<[f64; 2]>::new());
    assert_eq!(ways(&corridor(&[[9.0, 12.0]], &[])), Vec::<[f64; 2]>::new());
}

/// A wall that slides takes the end of the corridor along; enough of that is left beside the door, wherever both go.
#[test]
fn a_door_and_the_end_of_its_wall_leave_enough_between_them() {
    let mut d = corridor(&[[17.5, 18.4]], &[(1, [19.0, 19.2], [0.0, 10.0])]);
    for e in d.entities.iter_mut().filter(|e| e.source.record == 50) {
        let Shape::Polyline { vertices, .. } = &mut e.shape else { continue };
        vertices.iter_mut().filter(|v| v.at.x == 20.0).for_each(|v| v.at.x = 19.0);
    }
    d.slots[0].free[1] = 0.6;
    let (plan, graph, moves) = by_default(&d);
    let all: Vec<(bool, [f64; 2])> = moves
        .parameters
        .iter()
        .zip(moves.bounds())
        .map(|(p, b)| (!moves.groups[p.group].slots.is_empty(), b))
        .collect();
    assert!(all.iter().any(|a| a.0) && all.iter().any(|a| !a.0), "{all:?}");
    // Both towards each other.
    let p: Vec<f64> = all.iter().map(|(is_door, b)| if *is_door { b[1] } else { b[0] }).collect();
    let layout = moves.apply(&plan, &graph, &p);
    let own = layout.walls.iter().filter(|w| plan.walls[w.wall as usize].source.record == 50);
    let least = own.map(|w| {
        let x: Vec<f64> = control_points(&w.shape).iter().map(|p| p.x).collect();
        x.iter().copied().fold(f64::MIN, f64::max) - x.iter().copied().fold(f64::MAX, f64::min)
    });
    assert!(least.fold(f64::MAX, f64::min) >= 0.1 - 1e-6, "{all:?}");
}

/// What a user says of a door holds as far as its wall goes; a turn means nothing.
#[test]
fn a_marked_door_ends_before_its_wall_does() {
    let d = corridor(&[[9.0, 9.9]], &[]);
    let mut report = Report::default();
    let plan = understand(&d, &PlanOptions::default(), &mut report).unwrap();
    let (graph, (axes, _)) = (Graph::new(&plan), structure::axes(&plan, &d));
    let clauses = read_clauses("x -30 30; rotate -15 15; y -1 1", &d, &plan.frame).unwrap();
    let group = Group {
        name: "door".into(),
        outline: Region::Ring(Vec::new()),
        clauses,
        source: plan.slots[0].source.clone(),
    };
    let moves = Moves::new(&plan, &graph, &axes, &[(group, Vec::new())], &mut report);
    let bounds: Vec<[f64; 2]> = moves.bounds().iter().map(|b| b.map(|v| (v * 1e6).round() / 1e6)).collect();
    assert_eq!(bounds, [[-8.9, 10.0], [-1.0, 1.0]]);
    let codes: Vec<&str> = report.problems.iter().map(|p| p.code).collect();
    assert!(codes.contains(&"move-shortened") && codes.contains(&"move-clause-unused"), "{codes:?}");
    // Across its wall it goes nowhere.
    let across = moves.apply(&plan, &graph, &[0.0, 0.8]);
    assert!(across.walls.iter().all(|w| !w.is_changed));
}

//! What is counted for all places at once is what each place gives when it is measured alone.

#![allow(clippy::unwrap_used)]

use enfilade_cad::drawing::Drawing;
use enfilade_engine::geometry::Segment;
use enfilade_engine::visibility::{Vista, visibility_graph};
use enfilade_engine::{Lattice, Obstacles};
use enfilade_fixtures::{Draw, empty};
use enfilade_plan::axes::AxisGraph;
use enfilade_plan::floor::Area;
use enfilade_plan::kinds::RoomKind;
use enfilade_plan::{Plan, PlanOptions, structure, understand};
use enfilade_report::Report;
use enfilade_works::counts::{Present, counts};
use enfilade_works::rooms::rooms_of;
use enfilade_works::walls::{WallEnd, walls};
use enfilade_works::{Change, Room, Rule, Site, Work, WorkKind, Works, works};

/// Two rooms side by side, 10 × 5 m, walls of 0.3 m, a partition of 0.1 m at x = 6 with a door of 0.9 m at its foot. With a
/// text, a mark round the partition and what lies left of it says that.
fn house(mark: Option<&str>) -> (Drawing, Plan, AxisGraph) {
    let mut d = empty("m", 1.0);
    if let Some(text) = mark {
        d.group([-0.5, -0.5], [7.0, 5.5], text);
    }
    d.ring("WALLS", &[[-0.3, -0.3], [10.3, -0.3], [10.3, 5.3], [-0.3, 5.3]]);
    for [ax, ay, bx, by] in [
        [0.0, 0.0, 10.0, 0.0],
        [10.0, 0.0, 10.0, 5.0],
        [10.0, 5.0, 6.05, 5.0],
        [5.95, 5.0, 0.0, 5.0],
        [0.0, 5.0, 0.0, 0.0],
        [5.95, 1.2, 5.95, 5.0],
        [6.05, 1.2, 6.05, 5.0],
        [5.95, 1.2, 6.05, 1.2],
        [5.95, 0.3, 6.05, 0.3],
        [5.95, 0.0, 5.95, 0.3],
        [6.05, 0.0, 6.05, 0.3],
    ] {
        d.line(ax, ay, bx, by);
    }
    let plan = understand(&d, &PlanOptions::default(), &mut Report::default()).unwrap();
    let (axes, _) = structure::axes(&plan, &d);
    (d, plan, axes)
}

fn room(x: [f64; 2], kind: RoomKind) -> Room {
    let um = |v: f64| (v * 1e6).round() as i64;
    let outline = [[x[0], 0.0], [x[1], 0.0], [x[1], 5.0], [x[0], 5.0]].map(|p| p.map(um)).to_vec();
    let at = [um((x[0] + x[1]) / 2.0), um(2.5)];
    let area = Area { outline, area_m2: (x[1] - x[0]) * 5.0, at, ..Area::default() };
    Room { area, name: String::new(), kind, dwelling: None }
}

fn lattice() -> Lattice {
    let cells: Vec<[i32; 2]> =
        (0..20).flat_map(|c| (0..10).map(move |r| [c, r])).filter(|c| c[0] != 11 && c[0] != 12).collect();
    Lattice {
        spacing_um: 500_000,
        origin_um: [230_000, 210_000],
        query: (0..cells.len() as u32).collect(),
        is_reference: vec![true; cells.len()],
        beyond: None,
        cells,
    }
}

fn degrees(lattice: &Lattice, segments: Vec<Segment>) -> u64 {
    let graph = visibility_graph(lattice, &Obstacles { segments, blind: Vec::new() });
    (0..graph.len() as u32).map(|v| u64::from(graph.degree(v))).sum()
}

#[test]
fn every_opening_gains_what_it_is_counted_for() {
    let (_, plan, axes) = house(None);
    let segments: Vec<Segment> = plan.walls.iter().flat_map(|w| w.trace.segments().map(|s| s.2)).collect();
    let (lattice, rooms) =
        (lattice(), [room([0.0, 5.95], RoomKind::Living), room([6.05, 10.0], RoomKind::Kitchen)]);
    let obstacles = Obstacles { segments: segments.clone(), blind: Vec::new() };
    let vista = Vista::new(lattice.clone().into(), obstacles);
    let graph = vista.graph();
    let (room_of, is_query) = (rooms_of(&lattice, &rooms), vec![true; lattice.cells.len()]);
    let present = Present {
        plan: &plan,
        lattice: &lattice,
        vista: &vista,
        graph: &graph,
        rooms: &rooms,
        room_of: &room_of,
        is_query: &is_query,
        shut: &[],
    };
    let walls = walls(&plan, &axes);
    let partition = walls
        .iter()
        .find(|w| w.thickness_m < 0.15 && w.length_m > 3.0)
        .unwrap_or_else(|| panic!("{walls:#?}"));
    assert!(partition.ends.iter().any(|e| matches!(e, WallEnd::Opening(_))), "{partition:?}");
    let [lo, hi] = partition.free(1.0);
    let through = present.through(partition, [lo, hi]);
    let now = degrees(&lattice, segments.clone());
    let mut different = std::collections::BTreeSet::new();
    for width in [0.9, 1.8] {
        let places = ((hi - lo - width) / 0.1 + 1e-6) as usize + 1;
        let all = counts(&through, lo, 0.1, places, width);
        for k in 0..places {
            let from = lo + 0.1 * k as f64;
            let stretch = [from, from + width];
            let change = Change {
                demolished: vec![partition.quad(&plan, stretch)],
                built: partition.jambs(&plan, stretch).to_vec(),
            };
            assert_eq!(
                degrees(&lattice, change.apply(&segments)) - now,
                all.gained[k],
                "{width} m at {from}"
            );
            different.insert(all.gained[k]);
        }
    }
    assert!(different.len() > 5, "places differ: {different:?}");
}

fn found(rooms: &[Room]) -> Vec<(WorkKind, i64, Vec<Rule>)> {
    let works = found_where(rooms, None).works;
    works.into_iter().map(|w| (w.kind, w.gained, w.forbidden_by)).collect()
}

fn found_where(rooms: &[Room], mark: Option<&str>) -> Works {
    let (_, plan, axes) = house(mark);
    let segments: Vec<Segment> = plan.walls.iter().flat_map(|w| w.trace.segments().map(|s| s.2)).collect();
    let lattice = lattice();
    let obstacles = Obstacles { segments: segments.clone(), blind: Vec::new() };
    let vista = Vista::new(lattice.clone().into(), obstacles);
    let graph = vista.graph();
    let (room_of, is_query) = (rooms_of(&lattice, rooms), vec![true; lattice.cells.len()]);
    let present = Present {
        plan: &plan,
        lattice: &lattice,
        vista: &vista,
        graph: &graph,
        rooms,
        room_of: &room_of,
        is_query: &is_query,
        shut: &[],
    };
    let walls = walls(&plan, &axes);
    let kept_m = vec![Vec::new(); walls.len()];
    let site = Site { present, axes: &axes, walls: &walls, kept_m: &kept_m };
    let all = works(&site, &|| false);
    let now = degrees(&lattice, segments.clone()) as i64;
    for work in &all.works {
        let then = degrees(&lattice, work.change.apply(&segments)) as i64;
        assert_eq!(then - now, work.gained, "{:?} {:?}", work.kind, work.stretch);
    }
    all
}

/// Where marks allow works, these and no others are offered, of the widths that they say; a mark stands above what the
/// program guesses of privacy.
#[test]
fn marks_say_what_is_allowed() {
    let rooms = [room([0.0, 5.95], RoomKind::Living), room([6.05, 10.0], RoomKind::Bedroom)];
    let all = found_where(&rooms, Some("open 1.5m; remove; add; end -0.5m 0"));
    let allowed: Vec<&Work> = all.works.iter().filter(|w| w.forbidden_by.is_empty()).collect();
    assert!(allowed.iter().any(|w| w.kind == WorkKind::Open), "{allowed:?}");
    for work in &allowed {
        match work.kind {
            WorkKind::Open => assert!((work.width_m - 1.5).abs() < 1e-9, "{work:?}"),
            WorkKind::Remove => {}
            WorkKind::Add => assert!(work.gained < 0 && work.rooms[0] == work.rooms[1], "{work:?}"),
            other => panic!("{other:?} was not marked"),
        }
    }
    assert!(
        allowed.iter().any(|w| w.kind == WorkKind::Remove) && allowed.iter().any(|w| w.kind == WorkKind::Add)
    );
    let others = all.works.iter().filter(|w| !w.forbidden_by.is_empty());
    assert!(others.clone().all(|w| w.forbidden_by.contains(&Rule::Unmarked)) && others.count() > 3);
    let unmarked = found_where(&rooms, None).works;
    assert!(unmarked.iter().all(|w| !w.forbidden_by.contains(&Rule::Unmarked) && w.kind != WorkKind::Add));
}

/// A mark on a wall allows nothing on the wall at which it ends, on whose face its end is drawn.
#[test]
fn the_end_of_a_wall_marks_nothing_of_the_wall_that_it_meets() {
    let (mut d, ..) = house(None);
    d.ring("WALLS", &[[6.05, 2.4], [9.0, 2.4], [9.0, 2.5], [6.05, 2.5]]);
    let plan = understand(&d, &PlanOptions::default(), &mut Report::default()).unwrap();
    let (axes, _) = structure::axes(&plan, &d);
    let spur = plan.walls.iter().map(|w| w.source.record).max().unwrap();
    let walls = walls(&plan, &axes);
    let (across, partition): (Vec<_>, Vec<_>) = walls.iter().partition(|w| w.along.x.abs() > 0.5);
    assert!(across.iter().any(|w| w.markable.contains(&spur)), "the spur itself");
    assert!(partition.iter().any(|w| w.records.contains(&spur)), "its end is drawn on the partition");
    assert!(partition.iter().all(|w| !w.markable.contains(&spur)));
    assert!(partition.iter().any(|w| !w.markable.is_empty()));
}

#[test]
fn every_work_gains_what_it_is_said_to() {
    let works = found(&[room([0.0, 5.95], RoomKind::Living), room([6.05, 10.0], RoomKind::Kitchen)]);
    let has = |kind| works.iter().find(|w| w.0 == kind && w.2.is_empty());
    for kind in [WorkKind::Open, WorkKind::Door, WorkKind::Glaze, WorkKind::Widen, WorkKind::Remove] {
        assert!(has(kind).is_some_and(|w| w.1 > 0), "{kind:?}: {works:?}");
    }
    let removed = has(WorkKind::Remove).unwrap().1;
    assert!(works.iter().all(|w| w.1 <= removed), "nothing shows more than no wall at all");
    let closed = works.iter().find(|w| w.0 == WorkKind::Close).unwrap();
    assert!(closed.1 < 0 && closed.2.iter().any(|r| matches!(r, Rule::LastDoor(_))));
}

#[test]
fn nothing_is_opened_into_a_private_room() {
    let works = found(&[room([0.0, 5.95], RoomKind::Living), room([6.05, 10.0], RoomKind::Bedroom)]);
    assert!(works.iter().filter(|w| w.1 > 0).all(|w| !w.2.is_empty()), "{works:?}");
}

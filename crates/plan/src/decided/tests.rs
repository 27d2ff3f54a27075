use super::*;
use crate::{PlanOptions, understand};
use enfilade_cad::drawing::Text;
use enfilade_engine::geometry::UM_PER_M;
use enfilade_fixtures::{empty, source};

fn entity(record: usize, layer: &str, points: &[[f64; 2]], closed: bool) -> Entity {
    let vertices = points.iter().map(|p| Vertex { at: DVec2::from(*p), bulge: 0.0 }).collect();
    Entity {
        source: source(record, layer),
        layer: layer.into(),
        shape: Shape::Polyline { vertices, closed },
        editable: Editable::Free,
        blocks: Vec::new(),
        origin: Default::default(),
    }
}

/// Two rooms of 4 m by 5 m; the partition is drawn by its faces, from x = 3.95 to 4.05.
fn rooms() -> Vec<Entity> {
    vec![
        entity(0, "WALLS", &[[0.0, 0.0], [8.0, 0.0], [8.0, 5.0], [0.0, 5.0]], true),
        entity(1, "WALLS", &[[3.95, 0.0], [3.95, 5.0]], false),
        entity(2, "WALLS", &[[4.05, 0.0], [4.05, 5.0]], false),
    ]
}

fn text(layer: &str, at: [f64; 2], text: &str) -> Text {
    Text { source: source(90, layer), layer: layer.into(), at: DVec2::from(at), text: text.into() }
}

fn understood(entities: Vec<Entity>, texts: Vec<Text>) -> (Plan, Report) {
    let mut drawing = empty("m", 1.0);
    (drawing.entities, drawing.texts) = (entities, texts);
    let mut report = Report::default();
    let plan = understand(&drawing, &PlanOptions::default(), &mut report).unwrap();
    (plan, report)
}

/// The pieces of all walls on a vertical line, ascending, metres.
fn on_line(plan: &Plan, x: f64) -> Vec<[f64; 2]> {
    let um = (x * UM_PER_M).round() as i64;
    let of = plan.walls.iter().flat_map(|w| w.trace.segments().map(|s| s.2).collect::<Vec<_>>());
    let of = of.filter(|s| s.a[0] == um && s.b[0] == um && s.a[1] != s.b[1]);
    let mut out: Vec<[f64; 2]> =
        of.map(|s| [s.a[1].min(s.b[1]), s.a[1].max(s.b[1])].map(|v| v as f64 / UM_PER_M)).collect();
    out.sort_by(|a, b| a[0].total_cmp(&b[0]));
    out
}

#[test]
fn a_box_across_a_wall_opens_it_and_closes_its_ends() {
    let mut entities = rooms();
    entities.push(entity(3, "EF-OPEN", &[[3.7, 2.0], [4.3, 2.0], [4.3, 3.2], [3.7, 3.2]], true));
    let (plan, report) = understood(entities, Vec::new());
    for x in [3.95, 4.05] {
        assert_eq!(on_line(&plan, x), [[0.0, 2.0], [3.2, 5.0]], "{x}");
    }
    let caps = plan.walls.iter().flat_map(|w| w.trace.segments().map(|s| s.2).collect::<Vec<_>>());
    let mut caps: Vec<i64> =
        caps.filter(|s| s.a[1] == s.b[1] && (s.a[0] - s.b[0]).abs() == 100_000).map(|s| s.a[1]).collect();
    caps.sort_unstable();
    assert_eq!(caps, [2_000_000, 3_200_000]);
    assert_eq!(plan.decided.len(), 1);
    assert_eq!(plan.decided[0].kind, DecidedKind::Open(Fill::Nothing));
    assert_eq!(plan.decided[0].demolished.len(), 2);
    assert!(report.problems.iter().any(|p| p.code == "decided-works"), "{report:?}");
    assert!(plan.walls.iter().filter(|w| w.source.record > 0).all(|w| matches!(w.editable, Editable::No(_))));
}

#[test]
fn a_slanting_box_still_opens_straight_and_a_said_width_counts() {
    let mut entities = rooms();
    entities.push(entity(3, "EF-OPEN", &[[3.6, 2.1], [4.4, 1.9], [4.4, 3.1], [3.6, 3.3]], true));
    let (plan, _) = understood(entities, vec![text("EF-OPEN", [4.0, 2.5], "door 0.9m")]);
    let [left, right] = [on_line(&plan, 3.95), on_line(&plan, 4.05)];
    assert_eq!(left, right);
    assert!((left[1][0] - left[0][1] - 0.9).abs() < 1e-6, "{left:?}");
    assert_eq!(plan.decided[0].kind, DecidedKind::Open(Fill::Door));
}

#[test]
fn outlines_are_divided_and_pieces_inside_a_box_are_removed() {
    let mut entities = rooms();
    entities.truncate(1);
    entities.push(entity(1, "WALLS", &[[3.95, 0.0], [4.05, 0.0], [4.05, 5.0], [3.95, 5.0]], true));
    entities.push(entity(2, "EF-OPEN", &[[3.7, 1.0], [4.3, 1.0], [4.3, 2.0], [3.7, 2.0]], true));
    entities.push(entity(3, "EF-REMOVE", &[[3.5, 4.0], [4.5, 4.0], [4.5, 4.9], [3.5, 4.9]], true));
    let (plan, _) = understood(entities, Vec::new());
    assert_eq!(on_line(&plan, 3.95), [[0.0, 1.0], [2.0, 4.0], [4.9, 5.0]]);
    assert!(plan.walls.iter().filter(|w| w.source.record == 1).all(|w| w.is_solid));
    assert_eq!(plan.decided.iter().map(|d| d.kind.name()).collect::<Vec<_>>(), ["open", "remove"]);
}

#[test]
fn a_line_on_ef_new_is_a_wall_as_thick_as_its_text_says_or_as_partitions_are() {
    let mut entities = rooms();
    entities.push(entity(3, "EF-NEW", &[[0.0, 2.0], [3.95, 2.0]], false));
    let (plan, _) = understood(entities.clone(), vec![text("EF-NEW", [1.0, 2.3], "15cm")]);
    let wall = plan.walls.last().unwrap();
    let ys: Vec<i64> = wall.trace.points.iter().map(|p| p[1]).collect();
    assert_eq!((ys.iter().max(), ys.iter().min(), wall.is_solid), (Some(&2_075_000), Some(&1_925_000), true));
    let (plan, _) = understood(entities, Vec::new());
    let ys: Vec<i64> = plan.walls.last().unwrap().trace.points.iter().map(|p| p[1]).collect();
    assert_eq!(ys.iter().max().unwrap() - ys.iter().min().unwrap(), 100_000);
}

#[test]
fn marks_that_meet_nothing_are_said() {
    let mut entities = rooms();
    entities.push(entity(3, "EF-OPEN", &[[1.0, 1.0], [2.0, 1.0], [2.0, 2.0], [1.0, 2.0]], true));
    entities.push(entity(4, "EF-REMOVE", &[[1.0, 1.0], [2.0, 1.0]], false));
    let (plan, report) = understood(entities, Vec::new());
    assert!(plan.decided.is_empty());
    let codes: Vec<&str> = report.problems.iter().map(|p| p.code).collect();
    assert!(codes.contains(&"decided-idle") && codes.contains(&"marker-open"), "{codes:?}");
}

#[test]
fn texts_are_read_as_people_write_them() {
    for (words, fill, width) in [
        ("door", Fill::Door, None),
        ("Door 0.9m", Fill::Door, Some(0.9)),
        ("glass", Fill::Glass, None),
        ("900mm", Fill::Nothing, Some(0.9)),
        ("", Fill::Nothing, None),
    ] {
        let said = said(words, 1.0).unwrap();
        assert_eq!((said.fill, said.width_m), (fill, width), "{words}");
    }
    assert!(said("wide", 1.0).is_err() && said("-1m", 1.0).is_err());
}

/// Both faces of a wall, with their outline, are one removal; a wall elsewhere is another.
#[test]
fn what_is_demolished_is_counted_by_works() {
    let mut entities = rooms();
    let gone = [
        (3, [[2.0, 0.0], [2.0, 2.0]], false),
        (4, [[2.1, 0.0], [2.1, 2.0]], false),
        (5, [[2.0, 0.0], [2.1, 2.0]], true),
        (6, [[6.0, 0.0], [6.0, 2.0]], false),
    ];
    entities.extend(gone.map(|(k, points, closed)| entity(k, "EF-DEMOLISHED", &points, closed)));
    let (plan, report) = understood(entities, Vec::new());
    assert_eq!(plan.decided.len(), 4);
    let said = report.problems.iter().find(|p| p.code == "decided-works").unwrap();
    assert!(said.text.starts_with("2 removals decided"), "{}", said.text);
}

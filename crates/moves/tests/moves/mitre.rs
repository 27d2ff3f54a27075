//! Thick walls of which one joint moves: thickness, joints and every other byte stay.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a failing helper fails the test")]

use std::fmt::Write;

use enfilade_cad::curve::control_points;
use enfilade_cad::drawing::{Drawing, Edit};
use enfilade_cad::dxf::{ReadOptions, patch, read};
use enfilade_moves::{MOVE_MIN_M, Moves};
use enfilade_plan::axes::AxisGraph;
use enfilade_plan::graph::Graph;
use enfilade_plan::{Plan, PlanOptions, structure, understand};
use enfilade_report::Report;
use glam::DVec2;
use proptest::prelude::*;

/// How far a corner may lie from where it should, metres: it is snapped to whole micrometres before and after the
/// move (0.7 µm each), and where two lines meet askew both count.
const SNAP_M: f64 = 4e-6;

/// What the same can do to a wall's thickness.
const THICKNESS_M: f64 = 3e-6;

/// How offices draw a wall.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Style {
    /// A LINE a face.
    Lines,
    /// Two closed polylines round the room.
    Rings,
    /// A closed polyline a wall, mitred.
    Outlines,
}

/// A room of four walls and a partition from the middle of its south to the middle of its north wall.
#[derive(Clone, Copy, Debug)]
struct Room {
    corners: [DVec2; 4],
    thick: f64,
    style: Style,
}

/// The partition's thickness.
const THIN: f64 = 0.1;

fn crossing(p: DVec2, d: DVec2, q: DVec2, e: DVec2) -> DVec2 {
    p + d * ((q - p).perp_dot(e) / d.perp_dot(e))
}

impl Room {
    /// The ring of the faces at a distance from the axes, positive outwards.
    fn ring(&self, by: f64) -> [DVec2; 4] {
        let c = self.corners;
        std::array::from_fn(|i| {
            let (d, e) = ((c[i] - c[(i + 3) % 4]).normalize(), (c[(i + 1) % 4] - c[i]).normalize());
            crossing(c[i] - d.perp() * by, d, c[i] - e.perp() * by, e)
        })
    }

    /// The faces of the partition, from south to north.
    fn partition(&self) -> [[DVec2; 2]; 2] {
        let inner = self.ring(-self.thick / 2.0);
        let [a, b] = [inner[0].midpoint(inner[1]), inner[2].midpoint(inner[3])];
        let d = (b - a).normalize();
        [-THIN / 2.0, THIN / 2.0].map(|o| {
            let p = a + d.perp() * o;
            [crossing(p, d, inner[0], inner[1] - inner[0]), crossing(p, d, inner[2], inner[3] - inner[2])]
        })
    }

    fn dxf(&self, round: DVec2, text: &str) -> String {
        let (outer, inner) = (self.ring(self.thick / 2.0), self.ring(-self.thick / 2.0));
        let mut out = String::from(
            "0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1024\n9\n$INSUNITS\n70\n6\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n",
        );
        let line = |out: &mut String, [p, q]: [DVec2; 2]| {
            write!(out, "0\nLINE\n8\nWALL\n10\n{}\n20\n{}\n11\n{}\n21\n{}\n", p.x, p.y, q.x, q.y).unwrap();
        };
        let ring = |out: &mut String, layer: &str, points: &[DVec2]| {
            write!(out, "0\nLWPOLYLINE\n8\n{layer}\n90\n{}\n70\n1\n", points.len()).unwrap();
            points.iter().for_each(|p| write!(out, "10\n{}\n20\n{}\n", p.x, p.y).unwrap());
        };
        let [west, east] = self.partition();
        match self.style {
            Style::Lines => {
                for face in [outer, inner] {
                    (0..4).for_each(|i| line(&mut out, [face[i], face[(i + 1) % 4]]));
                }
                [west, east].into_iter().for_each(|l| line(&mut out, l));
            }
            Style::Rings => {
                [outer, inner].iter().for_each(|face| ring(&mut out, "WALL", face));
                [west, east].into_iter().for_each(|l| line(&mut out, l));
            }
            Style::Outlines => {
                for i in 0..4 {
                    let j = (i + 1) % 4;
                    ring(&mut out, "WALL", &[outer[i], outer[j], inner[j], inner[i]]);
                }
                ring(&mut out, "WALL", &[west[0], east[0], east[1], west[1]]);
            }
        }
        let half = DVec2::splat(0.75);
        let [a, c] = [round - half, round + half];
        ring(&mut out, "EF-MOVE", &[a, DVec2::new(c.x, a.y), c, DVec2::new(a.x, c.y)]);
        write!(out, "0\nTEXT\n8\nEF-MOVE\n10\n{}\n20\n{}\n40\n0.1\n1\n{text}\n", round.x, round.y).unwrap();
        out + "0\nENDSEC\n0\nEOF\n"
    }
}

struct Read {
    drawing: Drawing,
    plan: Plan,
    axes: AxisGraph,
    moves: Moves,
    graph: Graph,
    said: String,
}

fn understood(text: &str) -> Read {
    let mut report = Report::default();
    let drawing = read("plan.dxf", text.as_bytes(), &ReadOptions::default(), &mut report).unwrap();
    let plan = understand(&drawing, &PlanOptions::default(), &mut report).unwrap();
    let graph = Graph::new(&plan);
    let (axes, _) = structure::axes(&plan, &drawing);
    let moves = Moves::from_markers(&plan, &graph, &axes, &mut report);
    let said = report.problems.iter().map(|p| format!("{} {p}\n", p.code)).collect();
    Read { drawing, plan, axes, moves, graph, said }
}

/// The drawing with the layout written, as text.
fn written(text: &str, base: &Read, p: &[f64]) -> String {
    let layout = base.moves.apply(&base.plan, &base.graph, p);
    let changed = layout.walls.iter().filter(|w| w.is_changed);
    let edits: Vec<Edit> = changed
        .map(|w| Edit::Shape {
            record: base.plan.walls[w.wall as usize].source.record,
            shape: w.shape.clone(),
        })
        .collect();
    String::from_utf8(patch("plan.dxf", text.as_bytes(), &edits, &[]).unwrap()).unwrap()
}

/// The drawn pieces of the walls as segments.
fn pieces(read: &Read) -> Vec<[DVec2; 2]> {
    let mut out = Vec::new();
    for e in read.drawing.entities.iter().filter(|e| e.layer == "WALL") {
        let points = control_points(&e.shape);
        let n = points.len();
        let last = if n > 2 { n } else { n - 1 };
        out.extend((0..last).map(|i| [points[i], points[(i + 1) % n]]));
    }
    out
}

/// Whether some drawn piece runs along a line between two points, or the other way.
fn has_piece(all: &[[DVec2; 2]], [a, b]: [DVec2; 2], near: f64) -> bool {
    let is = |p: DVec2, q: DVec2| p.distance(a) < near && q.distance(b) < near;
    all.iter().any(|[p, q]| is(*p, *q) || is(*q, *p))
}

/// Only numbers differ, and only those of walls.
fn assert_only_walls_differ(before: &str, after: &str) {
    let (before, after): (Vec<&str>, Vec<&str>) = (before.lines().collect(), after.lines().collect());
    assert_eq!(before.len(), after.len());
    let mut layer = "";
    for (i, pair) in before.chunks(2).enumerate() {
        if pair[0] == "8" {
            layer = pair[1];
        }
        if pair[1] != after[2 * i + 1] {
            assert!(layer == "WALL" && ["10", "20", "11", "21"].contains(&pair[0]), "line {}", 2 * i + 2);
        }
        assert_eq!(pair[0], after[2 * i]);
    }
}

fn style() -> impl Strategy<Value = Style> {
    prop_oneof![Just(Style::Lines), Just(Style::Rings), Just(Style::Outlines)]
}

fn room() -> impl Strategy<Value = Room> {
    let slip = || (-1.0..1.0, -1.0..1.0).prop_map(|(x, y)| DVec2::new(x, y));
    ([slip(), slip(), slip(), slip()], 0.12..0.4, style(), 0.0..1.5).prop_map(
        |(slips, thick, style, turn)| {
            let square = [[0.0, 0.0], [9.0, 0.0], [9.0, 7.0], [0.0, 7.0]].map(DVec2::from);
            let at =
                |i: usize| DVec2::from_angle(turn).rotate(square[i] + slips[i]) + DVec2::new(20.0, -30.0);
            Room { corners: std::array::from_fn(at), thick, style }
        },
    )
}

/// Ways to go, some of them too short to be one.
fn way() -> impl Strategy<Value = f64> {
    prop_oneof![7 => -0.6..0.6, 1 => -2.0 * MOVE_MIN_M..2.0 * MOVE_MIN_M]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_corner_moves_and_all_joints_hold(room in room(), k in 0usize..4, x in way(), y in way()) {
        let text = room.dxf(room.corners[k], "x -0.6 0.6; y -0.6 0.6");
        let base = understood(&text);
        prop_assert_eq!(base.moves.parameters.len(), 2, "{}", &base.said);
        let p = [x, y];
        let after = written(&text, &base, &p);
        assert_only_walls_differ(&text, &after);
        let again = understood(&after);
        let all = pieces(&again);
        // The same room drawn anew with its corner elsewhere has the same faces, to the micrometre.
        let mut meant = room;
        meant.corners[k] += DVec2::from(p.map(|way| if way.abs() < MOVE_MIN_M { 0.0 } else { way }));
        for by in [room.thick / 2.0, -room.thick / 2.0] {
            let ring = meant.ring(by);
            for i in 0..4 {
                prop_assert!(has_piece(&all, [ring[i], ring[(i + 1) % 4]], SNAP_M), "face {} at {}: {:?}", i, by, all);
            }
        }
        // The partition stands on its own lines and reaches the inner faces as they are now.
        let inner = meant.ring(-room.thick / 2.0);
        for [a, b] in room.partition() {
            let south = crossing(a, b - a, inner[0], inner[1] - inner[0]);
            let north = crossing(a, b - a, inner[2], inner[3] - inner[2]);
            prop_assert!(has_piece(&all, [south, north], SNAP_M), "partition {:?}: {:?}", [south, north], all);
        }
        let corner = meant.corners[k];
        let far = |q: &DVec2| q.distance(corner);
        let nodes: Vec<DVec2> = again.axes.nodes.iter().map(|n| again.plan.frame.file_from_plan(n.at)).collect();
        let nearest = nodes.iter().map(far).fold(f64::MAX, f64::min);
        prop_assert!(nearest < 1e-3, "axis node {nearest} m from where it should be");
    }

    #[test]
    fn a_partition_slides_by_one_end_on_a_wall_that_stands(room in room(), way in -0.6f64..0.6) {
        let [west, east] = room.partition();
        let end = west[0].midpoint(east[0]);
        let south = room.corners[1] - room.corners[0];
        let text = room.dxf(end, &format!("along {} -0.6 0.6", south.to_angle().to_degrees()));
        let base = understood(&text);
        prop_assert_eq!(base.moves.parameters.len(), 1, "{}", &base.said);
        let after = written(&text, &base, &[way]);
        assert_only_walls_differ(&text, &after);
        let again = understood(&after);
        let all = pieces(&again);
        for by in [room.thick / 2.0, -room.thick / 2.0] {
            let ring = room.ring(by);
            prop_assert!((0..4).all(|i| has_piece(&all, [ring[i], ring[(i + 1) % 4]], 1e-9)), "the room stands");
        }
        let inner = room.ring(-room.thick / 2.0);
        let on = |p: DVec2, i: usize| {
            (inner[i + 1] - inner[i]).normalize().perp_dot(p - inner[i]).abs() < SNAP_M
        };
        let faces: Vec<[DVec2; 2]> = all
            .iter()
            .map(|[p, q]| if on(*p, 0) { [*p, *q] } else { [*q, *p] })
            .filter(|[p, q]| on(*p, 0) && on(*q, 2) && p.distance(*q) > 2.0)
            .filter(|[p, q]| !inner.iter().any(|c| c.distance(*p) < 0.5 || c.distance(*q) < 0.5))
            .collect();
        prop_assert_eq!(faces.len(), 2, "both faces reach both walls: {:?}", all);
        let d = (faces[0][1] - faces[0][0]).normalize();
        for p in faces[1] {
            let apart = d.perp_dot(p - faces[0][0]).abs();
            prop_assert!((apart - THIN).abs() < THICKNESS_M, "{apart}");
        }
        let moved = faces[0][0].midpoint(faces[1][0]).distance(end);
        prop_assert!((moved - way.abs()).abs() < 0.05, "{moved} instead of {way}");
    }
}

/// A wall that stands free, one end of which turns about the other or leaves: its end stays square.
#[test]
fn a_free_end_stays_square() {
    for style in [Style::Lines, Style::Outlines] {
        let corners = [[0.0, 0.0], [9.0, 0.0], [9.0, 7.0], [0.0, 7.0]].map(DVec2::from);
        let room = Room { corners, thick: 0.3, style };
        let mut text = room.dxf(DVec2::new(2.0, 5.0), "x -1 1; y -1 0.5");
        let ring = [[1.9, 2.0], [2.1, 2.0], [2.1, 5.0], [1.9, 5.0]];
        let drawn = match style {
            Style::Outlines => {
                let start = String::from("0\nLWPOLYLINE\n8\nWALL\n90\n4\n70\n1\n");
                ring.iter().fold(start, |s, [x, y]| s + &format!("10\n{x}\n20\n{y}\n"))
            }
            _ => (0..4).fold(String::new(), |s, i| {
                let ([a, b], [c, d]) = (ring[i], ring[(i + 1) % 4]);
                s + &format!("0\nLINE\n8\nWALL\n10\n{a}\n20\n{b}\n11\n{c}\n21\n{d}\n")
            }),
        };
        text = text.replacen("0\nLWPOLYLINE\n8\nEF-MOVE", &format!("{drawn}0\nLWPOLYLINE\n8\nEF-MOVE"), 1);
        let base = understood(&text);
        let after = written(&text, &base, &[0.8, -0.4]);
        let all = pieces(&understood(&after));
        let along = (DVec2::new(2.8, 4.6) - DVec2::new(2.0, 2.0)).normalize();
        let [foot, head] = [DVec2::new(2.0, 2.0), DVec2::new(2.8, 4.6)];
        let side = along.perp() * 0.1;
        for s in [side, -side] {
            assert!(has_piece(&all, [foot + s, head + s], SNAP_M), "{style:?} {s}: {all:?}");
        }
        for end in [foot, head] {
            assert!(has_piece(&all, [end - side, end + side], SNAP_M), "{style:?}: {all:?}");
        }
    }
}

/// Where a bound would make a mitre run away, or a wall end before it begins, the way ends before it and says why.
#[test]
fn a_way_ends_before_a_joint_breaks() {
    let corners = [[0.0, 0.0], [9.0, 0.0], [9.0, 7.0], [0.0, 7.0]].map(DVec2::from);
    let room = Room { corners, thick: 0.3, style: Style::Lines };
    for (moves, why) in [
        ("x 0 60; y 0 0.1", "would make walls meet at less than 12°, where no mitre holds"),
        ("y -6.9 0", "would make a wall shorter than its joints need"),
    ] {
        let base = understood(&room.dxf(corners[2], moves));
        let text = format!("group \"move-1\" {why} at its bounds; it moves by `");
        assert!(base.said.contains("move-shortened") && base.said.contains(&text), "{}", base.said);
        let shorter = |p: &enfilade_moves::Parameter| {
            let (now, then) = (p.clause.upper - p.clause.lower, p.stated[1] - p.stated[0]);
            now < then && now > 0.2 * then
        };
        assert!(base.moves.parameters.iter().any(shorter), "{:?}", base.moves.parameters);
    }
    let base = understood(&room.dxf(corners[2], "x -1 1; y -1 1"));
    assert_eq!(base.moves.parameters.len(), 2, "{}", base.said);
}

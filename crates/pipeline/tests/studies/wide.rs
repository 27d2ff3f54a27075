//! Walls drawn as wide polylines, and ground that layers say is outdoors.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a failing helper fails the test")]

use std::fmt::Write;
use std::time::Instant;

use enfilade_cad::dxf::{ReadOptions, read};
use enfilade_config::{Partial, Settings};
use enfilade_overlay::result::RoundResult;
use enfilade_pipeline::{Input, Outcome};
use enfilade_plan::{Plan, PlanOptions, understand, wide};
use enfilade_report::{Cancel, Report};
use serde_json::Value;

/// How a polyline's width is written.
#[derive(Clone, Copy)]
enum Width {
    /// Group 43 of an LWPOLYLINE.
    Constant(f64),
    /// Groups 40 and 41 of every vertex of an LWPOLYLINE.
    ByVertex(f64, f64),
    /// Groups 40 and 41 of a POLYLINE, for all its vertices.
    Old(f64),
}

#[derive(Default)]
struct Sheet(String);

impl Sheet {
    fn line(mut self, layer: &str, width: Option<Width>, closed: bool, points: &[[f64; 2]]) -> Self {
        let flag = i32::from(closed);
        if let Some(Width::Old(w)) = width {
            write!(self.0, "0\nPOLYLINE\n8\n{layer}\n66\n1\n70\n{flag}\n40\n{w}\n41\n{w}\n").unwrap();
            for [x, y] in points {
                write!(self.0, "0\nVERTEX\n8\n{layer}\n10\n{x}\n20\n{y}\n").unwrap();
            }
            write!(self.0, "0\nSEQEND\n8\n{layer}\n").unwrap();
            return self;
        }
        write!(self.0, "0\nLWPOLYLINE\n8\n{layer}\n90\n{}\n70\n{flag}\n", points.len()).unwrap();
        if let Some(Width::Constant(w)) = width {
            write!(self.0, "43\n{w}\n").unwrap();
        }
        for [x, y] in points {
            write!(self.0, "10\n{x}\n20\n{y}\n").unwrap();
            if let Some(Width::ByVertex(from, to)) = width {
                write!(self.0, "40\n{from}\n41\n{to}\n").unwrap();
            }
        }
        self
    }

    fn text(mut self, layer: &str, [x, y]: [f64; 2], text: &str) -> Self {
        write!(self.0, "0\nTEXT\n8\n{layer}\n10\n{x}\n20\n{y}\n40\n0.1\n1\n{text}\n").unwrap();
        self
    }

    fn dxf(&self) -> String {
        format!(
            "0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1024\n9\n$INSUNITS\n70\n6\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n\
             {}0\nENDSEC\n0\nEOF\n",
            self.0
        )
    }
}

/// A house of 12 by 6 m, its walls 0.3 m thick, with a partition that is drawn to the walls' faces and has a door gap.
fn house(outer: Option<Width>, inner: Option<Width>) -> Sheet {
    Sheet::default()
        .line("WALL", outer, true, &[[0.15, 0.15], [11.85, 0.15], [11.85, 5.85], [0.15, 5.85]])
        .line("WALL", inner, false, &[[6.0, 0.3], [6.0, 2.25]])
        .line("WALL", inner, false, &[[6.0, 3.25], [6.0, 5.7]])
}

fn plan(sheet: &Sheet) -> Plan {
    let mut report = Report::default();
    let drawing =
        read("plan.dxf", sheet.dxf().as_bytes(), &ReadOptions::default(), &mut report).expect("it is read");
    understand(&drawing, &PlanOptions::default(), &mut report).expect("it is understood")
}

fn run(sheet: &Sheet) -> Outcome<RoundResult> {
    let partial = Partial {
        spacing: Some(0.5),
        evaluations: Some(20),
        only_marked: Some(true),
        raw: Some(true),
        seed: Some(3),
        ..Partial::default()
    };
    let text = sheet.dxf();
    let input = Input::new("plan.dxf", text.as_bytes(), 1);
    let settings = Settings::new(partial).unwrap();
    enfilade_pipeline::run(&input, &settings, Instant::now(), &mut |_| {}, &Cancel::default()).unwrap()
}

fn vertices(done: &Outcome<RoundResult>) -> u64 {
    let file = done.files.iter().find(|f| f.path.ends_with("result.json")).unwrap();
    let json: Value = serde_json::from_slice(&file.bytes).unwrap();
    json["counts"]["vertices"].as_u64().unwrap()
}

#[test]
fn a_polyline_as_wide_as_a_wall_has_the_walls_thickness() {
    let widths = |w: Option<Width>| -> Vec<i64> {
        plan(&house(Some(Width::Constant(0.3)), w)).walls.iter().map(|w| w.width_um).collect()
    };
    assert_eq!(widths(Some(Width::Constant(0.1))), [300_000, 100_000, 100_000]);
    assert_eq!(widths(Some(Width::ByVertex(0.1, 0.1))), [300_000, 100_000, 100_000]);
    assert_eq!(widths(Some(Width::Old(0.1))), [300_000, 100_000, 100_000]);
    let [thinnest, widest] = wide::WIDTH_M;
    // A pen, an arrow, a road.
    for no_wall in [
        Width::Constant(0.99 * thinnest),
        Width::ByVertex(0.1, 0.0),
        Width::ByVertex(0.0, 0.0),
        Width::Old(1.01 * widest),
    ] {
        assert_eq!(widths(Some(no_wall)), [300_000, 0, 0]);
    }
    assert_eq!(widths(None), [300_000, 0, 0]);
    // Of a column the pen draws the outline.
    let column = [[2.0, 2.0], [2.4, 2.0], [2.4, 2.4], [2.0, 2.4]];
    let column = house(None, None).line("WALL", Some(Width::Constant(0.1)), true, &column);
    assert!(plan(&column).walls.iter().all(|w| w.width_um == 0));
}

/// Cells of half a metre: 23 by 11 between the outer walls' faces, 9 of them under the partition.
#[test]
fn nobody_stands_on_the_ground_of_a_wide_polyline() {
    let wide = run(&house(Some(Width::Constant(0.3)), Some(Width::Constant(0.1))));
    assert_eq!(vertices(&wide), 23 * 11 - 9);
    let said = "plan.dxf: 3 walls are polylines drawn 0.10 to 0.30 m wide: they stop sight at their sides and cover \
                the ground between them";
    assert!(wide.report.problems.iter().any(|p| p.to_string() == said), "{:?}", wide.report.problems);
    // Wider than the distance of the cells.
    let thick = run(&house(Some(Width::Constant(0.3)), Some(Width::Constant(0.6))));
    assert_eq!(vertices(&thick), 23 * 11 - 9);
    let thick = run(&house(Some(Width::Constant(0.3)), Some(Width::Constant(0.8))).line(
        "WALL",
        Some(Width::Constant(0.8)),
        false,
        &[[9.25, 0.3], [9.25, 5.7]],
    ));
    assert_eq!(vertices(&thick), 23 * 11 - 9 - 2 * 11, "two rows of cells lie within it");
}

/// What is written of a wide wall that moves is its axis, and its width goes along: the file measures what the layout did.
#[test]
fn a_wide_polyline_moves_by_its_axis() {
    let sheet = house(Some(Width::Constant(0.3)), Some(Width::Constant(0.2)))
        .line("EF-MOVE", None, true, &[[5.5, 0.2], [6.5, 0.2], [6.5, 5.8], [5.5, 5.8]])
        .text("EF-MOVE", [6.0, 2.75], "x -1.2 1.2");
    let done = run(&sheet);
    let codes: Vec<&str> = done.report.problems.iter().map(|p| p.code).collect();
    assert!(!codes.contains(&"written-differs"), "{:?}", done.report.problems);
    let before = plan(&sheet);
    let mut moved = 0;
    for file in done
        .files
        .iter()
        .filter(|f| f.path.to_string_lossy().contains("candidate-") && f.path.ends_with("candidate-1.dxf"))
    {
        let mut report = Report::default();
        let drawing = read("plan.dxf", &file.bytes, &ReadOptions::default(), &mut report).unwrap();
        let after = understand(&drawing, &PlanOptions::default(), &mut report).unwrap();
        assert_eq!(after.walls.len(), before.walls.len());
        for (a, b) in after.walls.iter().zip(&before.walls) {
            assert_eq!((a.width_um, a.trace.points.len()), (b.width_um, b.trace.points.len()));
            moved += usize::from(a.trace != b.trace);
        }
    }
    assert_eq!(moved, 2, "both parts of the partition");
}

/// Before the house, between two walls that stand out, a terrace: its outline says that it is no room.
#[test]
fn outlines_on_layers_of_terraces_are_outdoors() {
    let house = || {
        let walls: [&[[f64; 2]]; 4] = [
            &[[5.0, 0.0], [0.0, 0.0], [0.0, 5.0], [12.0, 5.0], [12.0, 0.0], [6.0, 0.0]],
            &[[0.0, 0.0], [0.0, -2.0], [8.0, -2.0]],
            &[[9.0, -2.0], [12.0, -2.0], [12.0, 0.0]],
            &[[3.0, 5.0], [3.0, 2.0]],
        ];
        walls.iter().fold(Sheet::default(), |s, w| s.line("WALL", None, false, w))
    };
    let terrace = [[0.0, -2.0], [12.0, -2.0], [12.0, 0.0], [0.0, 0.0]];
    let [untold, told] =
        [house(), house().line("A-Terrasse", None, true, &terrace)].map(|sheet| vertices(&run(&sheet)));
    // A row of cells lies under the wall within the house, and in either door stands one.
    let room = 23 * 9 - 6;
    assert!((room..=room + 1).contains(&told), "{told}");
    assert!(untold >= room + 23 * 3, "{untold}");
}

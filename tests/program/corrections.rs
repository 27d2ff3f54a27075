//! What the user corrects changes what it names and nothing else (`docs/corrections.md`).

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a failing helper fails the test")]

use std::fmt::Write;
use std::path::{Path, PathBuf};

use enfilade::batch::Job;
use enfilade_config::{Partial, Settings};
use enfilade_pipeline::{Input, Study};
use enfilade_plan::axes::OpeningKind;
use enfilade_plan::reading::corrections::Finding;
use enfilade_report::{Cancel, Error};

/// Lines `(handle, layer, [x0, y0, x1, y1])` in metres, and what else stands among the entities.
fn drawing(lines: &[(&str, &str, [f64; 4])], more: &str) -> String {
    let mut out =
        String::from("0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1024\n9\n$INSUNITS\n70\n6\n0\nENDSEC\n");
    out += "0\nSECTION\n2\nENTITIES\n";
    for (handle, layer, [x0, y0, x1, y1]) in lines {
        write!(out, "0\nLINE\n5\n{handle}\n8\n{layer}\n10\n{x0}\n20\n{y0}\n11\n{x1}\n21\n{y1}\n").unwrap();
    }
    out + more + "0\nENDSEC\n0\nEOF\n"
}

/// A hall of 10 by 6 m, its corner at `x`.
fn hall(x: f64) -> Vec<(&'static str, &'static str, [f64; 4])> {
    vec![
        ("A1", "WALLS", [x, 0.0, x + 10.0, 0.0]),
        ("A2", "WALLS", [x + 10.0, 0.0, x + 10.0, 6.0]),
        ("A3", "WALLS", [x + 10.0, 6.0, x, 6.0]),
        ("A4", "WALLS", [x, 6.0, x, 0.0]),
    ]
}

fn settings(toml: &str) -> Settings {
    let said = Partial::from_toml("plan.enfilade.toml", &format!("spacing = 0.5\n{toml}")).unwrap();
    Settings::new(said).unwrap()
}

fn studied(text: &str, toml: &str) -> Result<Study, Error> {
    let input = Input::new("plan.dxf", text.as_bytes(), 1);
    Ok(enfilade_pipeline::analyse(&input, &settings(toml), &Cancel::default())?.1)
}

fn study(text: &str, corrections: &str) -> Study {
    studied(text, &format!("only-marked = true\n[reading]\n{corrections}\n")).unwrap()
}

fn walls(study: &Study) -> String {
    study
        .base
        .plan
        .walls
        .iter()
        .map(|w| w.source.handle.clone().unwrap_or_default())
        .collect::<Vec<_>>()
        .join(" ")
}

fn findings(study: &Study) -> &[Finding] {
    &study.base.plan.reading.findings
}

/// A hall that a line on a layer without a telling name parts, with two sticks in it.
fn parted() -> String {
    let mut lines = hall(0.0);
    lines.push(("B1", "L7", [5.0, 0.0, 5.0, 6.0]));
    lines.push(("B2", "L7", [2.0, 2.0, 2.0, 3.0]));
    lines.push(("C1", "WALLS", [8.0, 2.0, 8.0, 3.0]));
    drawing(&lines, "")
}

#[test]
fn layers_and_handles_become_walls_and_no_walls() {
    let text = parted();
    for (corrections, expected) in [
        ("", "A1 A2 A3 A4 C1"),
        ("wall = [\"layer:l?\"]", "A1 A2 A3 A4 B1 B2 C1"),
        ("wall = [\"handle:b1\"]", "A1 A2 A3 A4 B1 C1"),
        ("not_wall = [\"handle:C1\"]", "A1 A2 A3 A4"),
        ("wall = [\"layer:L7\"]\nnot_wall = [\"handle:B2\"]", "A1 A2 A3 A4 B1 C1"),
        ("not_wall = [\"layer:L7\"]\nwall = [\"handle:B2\"]", "A1 A2 A3 A4 B2 C1"),
        ("wall = [\"layer:L*\"]\nnot_wall = [\"layer:L7\"]", "A1 A2 A3 A4 C1"),
    ] {
        let study = study(&text, corrections);
        assert_eq!((walls(&study).as_str(), findings(&study)), (expected, &[][..]), "{corrections}");
    }
    let [open, closed] = ["", "wall = [\"handle:B1\"]"].map(|c| study(&text, c).edges);
    assert!(closed < open, "{closed} {open}: it stops sight");
}

#[test]
fn a_selector_without_a_match_names_the_nearest() {
    let study = study(&parted(), "wall = [\"layer:WALS\"]\nnot_wall = [\"handle:FF\"]");
    let unmatched = |selector: &str, nearest: Option<&str>| Finding::Unmatched {
        selector: selector.into(),
        nearest: nearest.map(Into::into),
    };
    assert_eq!(findings(&study), [unmatched("layer:WALS", Some("WALLS")), unmatched("handle:FF", None)]);
}

/// Walls of two faces, one with a gap of 0.9 m that a line on the wall's own layer closes.
fn gap(layer: &'static str) -> String {
    let mut lines = hall(0.0);
    for (handle, line) in [
        ("B1", [-0.2, -0.2, 10.2, -0.2]),
        ("B2", [10.2, -0.2, 10.2, 6.2]),
        ("B3", [10.2, 6.2, -0.2, 6.2]),
        ("B4", [-0.2, 6.2, -0.2, -0.2]),
    ] {
        lines.push((handle, "WALLS", line));
    }
    for (k, x) in [("D1", 4.9), ("D2", 5.1)] {
        lines.push((k, "WALLS", [x, 0.0, x, 2.5]));
        lines.push((k, "WALLS", [x, 3.4, x, 6.0]));
    }
    lines.push(("D3", "WALLS", [4.9, 2.5, 5.1, 2.5]));
    lines.push(("D4", "WALLS", [4.9, 3.4, 5.1, 3.4]));
    lines.push(("E1", layer, [5.0, 2.5, 5.0, 3.4]));
    drawing(&lines, "")
}

#[test]
fn doors_and_windows_are_what_the_user_says() {
    let kinds = |study: &Study| study.base.axes.openings.iter().map(|o| o.kind).collect::<Vec<_>>();
    for layer in ["WALLS", "L9", "FURNITURE"] {
        let door = study(&gap(layer), "door = [\"handle:E1\"]");
        assert_eq!((kinds(&door), walls(&door).contains("E1")), (vec![OpeningKind::Door], false), "{layer}");
        let window = study(&gap(layer), "window = [\"handle:E1\"]");
        assert_eq!(kinds(&window), [OpeningKind::Window], "{layer}");
        let knee = studied(&gap(layer), "level = \"knee\"\n[reading]\nwindow = [\"handle:E1\"]").unwrap();
        let wall = study(&gap(layer), "wall = [\"handle:E1\"]");
        assert!(walls(&wall).contains("E1") && wall.edges < window.edges, "{layer}");
        assert!(knee.edges < window.edges, "{layer}: a window stops sight at the knee");
        assert_eq!(window.edges, door.edges, "{layer}");
    }
}

#[test]
fn the_floor_is_inside_and_outside_where_the_user_says() {
    // A hall in two parts, and a court of 4 by 4 m with a gate of 3.2 m.
    let mut lines = hall(0.0);
    lines.push(("B1", "WALLS", [5.0, 0.0, 5.0, 6.0]));
    lines.push(("C1", "WALLS", [10.0, 4.0, 14.0, 4.0]));
    lines.push(("C2", "WALLS", [14.0, 4.0, 14.0, 3.6]));
    lines.push(("C3", "WALLS", [14.0, 0.4, 14.0, 0.0]));
    lines.push(("C4", "WALLS", [14.0, 0.0, 10.0, 0.0]));
    let text = drawing(&lines, "");
    let cells = |corrections: &str| study(&text, corrections).lattice.cells.len();
    assert_eq!(cells(""), 2 * 9 * 11);
    let more = cells("inside = [[12.0, 2.0]]");
    // Sixteen square metres of court, less the cells at its walls.
    assert!((2 * 9 * 11 + 40..=2 * 9 * 11 + 64).contains(&more), "{more}");
    assert_eq!(cells("outside = [[2.0, 2.0]]"), 9 * 11);
    let open = study(&text, "inside = [[20.0, 2.0]]");
    assert_eq!(findings(&open), [Finding::Open { at: [20.0, 2.0] }]);
    let overruled = studied(&text, "seed-point = [[2.0, 2.0]]\n[reading]\ninside = [[12.0, 2.0]]").unwrap();
    assert_eq!(findings(&overruled), [Finding::Overruled]);
}

#[test]
fn a_box_reads_what_lies_in_it() {
    let mut lines = hall(0.0);
    for (handle, layer, line) in hall(40.0) {
        lines.push((if handle == "A1" { "F1" } else { "F2" }, layer, line));
    }
    let text = drawing(&lines, "");
    let of = |view: &str| walls(&study(&text, view));
    assert_eq!(of("view = [-1, -1, 11, 7]"), "A1 A2 A3 A4");
    assert_eq!(of("view = [51, 7, 39, -1]"), "F1 F2 F2 F2");
    assert_eq!(of("view = [-1, -1, 60, 7]"), "A1 A2 A3 A4 F1 F2 F2 F2");
    // Three of its walls alone enclose nothing.
    assert!(studied(&text, "[reading]\nview = [-1, -1, 11, 5]").is_err());
    let one = drawing(&hall(0.0), "");
    assert_eq!(walls(&study(&one, "view = 1")), "A1 A2 A3 A4");
}

#[test]
fn as_drawn_every_line_stops_sight() {
    let closed = study(&gap("L9"), "as_drawn = true");
    assert!(walls(&closed).contains("E1") && closed.base.axes.openings.is_empty());
    let named = "wall-layer = [\"WALLS\"]\n[reading]\nas_drawn = true\n";
    let open = studied(&gap("L9"), named).unwrap();
    assert!(!walls(&open).contains("E1") && open.edges > closed.edges);
}

/// What depthmapX fills from either point of this plan at this spacing.
#[allow(clippy::approx_constant, reason = "a place, not an angle")]
#[test]
fn as_drawn_counts_the_cells_of_depthmapx() {
    let shared = std::env::var_os("ENFILADE_SHARED")
        .map_or_else(|| enfilade_fixtures::repository("../shared"), PathBuf::from);
    let Ok(bytes) = std::fs::read(shared.join("data/dxf/gallery_depthmapx.dxf")) else {
        eprintln!("skipped: gallery_depthmapx.dxf is not there");
        return;
    };
    for seed in [[3.0, 6.28], [3.0, 6.3]] {
        let said = Partial { seed_point: Some(vec![seed]), spacing: Some(0.04), ..Partial::default() };
        let as_drawn = Partial::from_toml("a", "[reading]\nunit = \"m\"\nas_drawn = true").unwrap();
        let settings = Settings::new(said.over(as_drawn)).unwrap();
        let input = Input::new("gallery.dxf", &bytes, 1);
        let study = enfilade_pipeline::analyse(&input, &settings, &Cancel::default()).unwrap().1;
        assert_eq!(study.lattice.cells.len(), 4332, "{seed:?}");
    }
}

/// One vertex, or several at one place, on layers of every role: nothing changes and a finding names it.
#[test]
fn shapes_of_no_size_are_ignored_on_every_layer() {
    let poly = |n: usize, closed: u8, layer: &str| {
        let vertices = "10\n0.1\n20\n4.5\n42\n1\n".repeat(n);
        format!("0\nLWPOLYLINE\n5\nFE\n8\n{layer}\n90\n{n}\n70\n{closed}\n{vertices}")
    };
    let spline = |layer: &str| {
        let knots = "40\n0\n".repeat(4) + &"40\n1\n".repeat(4);
        let points = "10\n0.1\n20\n4.5\n".repeat(4);
        format!("0\nSPLINE\n5\nFE\n8\n{layer}\n70\n8\n71\n3\n72\n8\n73\n4\n74\n0\n{knots}{points}")
    };
    let plain = study(&drawing(&hall(0.0), ""), "");
    for layer in ["WALLS", "DOORS", "WINDOWS", "GLAZING", "COLUMNS", "FURNITURE", "STAIRS", "XYZ"] {
        let odd = [poly(1, 0, layer), poly(1, 1, layer), poly(2, 1, layer), poly(3, 0, layer), spline(layer)];
        for (k, odd) in odd.iter().enumerate() {
            let text = drawing(&hall(0.0), odd);
            let input = Input::new("plan.dxf", text.as_bytes(), 1);
            let (done, study) =
                enfilade_pipeline::analyse(&input, &settings(""), &Cancel::default()).unwrap();
            assert_eq!((walls(&study), study.edges), (walls(&plain), plain.edges), "{layer} {k}");
            let said: Vec<&str> =
                done.report.problems.iter().map(|p| p.code).filter(|c| *c == "dots").collect();
            assert_eq!(said, ["dots"], "{layer} {k}");
        }
    }
}

#[test]
fn results_and_jobs_carry_corrections() {
    let said = "[reading]\nnot_wall = [\"block:SINK*\"]\ninside = [[1.5, 2.0]]\nas_drawn = true\n";
    let partial = Partial::from_toml("plan.enfilade.toml", said).unwrap();
    let settings = Settings::new(partial.clone()).unwrap();
    let value = serde_json::to_value(&settings).unwrap();
    assert_eq!(value["reading"]["not_wall"][0], "block:SINK*");
    assert_eq!(serde_json::from_value::<Settings>(value).unwrap(), settings);
    let job = Job::new(Path::new("plan.dxf"), b"", partial.clone(), Path::new("out"), true).unwrap();
    let again = Job::from_json(&job.to_line().unwrap()).unwrap();
    assert_eq!(again.settings, partial);
    let plain = Job::new(Path::new("plan.dxf"), b"", Partial::default(), Path::new("out"), true).unwrap();
    assert_ne!(plain.id, job.id);
}

//! `analyse`: where its tables go, and what it says of estimates.

#![allow(clippy::unwrap_used, reason = "a failing helper fails the test")]

use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

use enfilade_fixtures::corridor::{SIZE, drawing, line, panes, polyline, swings, walls};

fn enfilade(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_enfilade")).args(args).output().unwrap()
}

fn sample(name: &str) -> String {
    enfilade_fixtures::repository("samples").join(name).to_string_lossy().into_owned()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn json(path: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

/// Tables may go into the folder of the heat maps, which is put in place whole, and to standard output.
#[test]
fn tables_stay_where_they_are_sent() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_string_lossy().into_owned();
    let made = folder.path().join("gallery.enfilade/analysis");
    let (cells, edges) = (made.join("c.csv"), made.join("e.csv"));
    let gallery = sample("gallery.dxf");
    let analyse = |more: &[&str]| {
        let done = enfilade(&[&["analyse", &gallery, "--spacing", "1", "--out", &out], more].concat());
        assert!(done.status.success(), "{}", text(&done.stderr));
        text(&done.stdout)
    };
    for _ in 0..2 {
        analyse(&["--cells", &cells.to_string_lossy(), "--edges", &edges.to_string_lossy()]);
        assert!(made.join("degree.png").is_file() && edges.is_file());
        let told = analyse(&["--cells", "-"]);
        assert!(cells.is_file(), "an analysis takes nothing away that another asked for");
        assert!(told.starts_with("Ref,x,y,") && !told.contains("heat maps"), "{told}");
    }
    assert!(!Path::new("-").exists());
}

/// A name in `.geojson` has the same values as the CSV, on squares of the spacing round the same centres.
#[test]
fn tables_go_into_a_gis() {
    let folder = tempfile::tempdir().unwrap();
    let [out, csv, cells, edges] = ["", "c.csv", "c.geojson", "e.geojson"]
        .map(|name| folder.path().join(name).to_string_lossy().into_owned());
    let gallery = sample("gallery.dxf");
    let measured = ["analyse", &gallery, "--spacing", "1", "--out", &out, "--measures", "connectivity"];
    for tables in [&["--cells", &csv][..], &["--cells", &cells, "--edges", &edges]] {
        let done = enfilade(&[&measured[..], tables].concat());
        assert!(done.status.success(), "{}", text(&done.stderr));
    }
    let table = std::fs::read_to_string(&csv).unwrap();
    let names: Vec<&str> = table.lines().next().unwrap().split(',').collect();
    assert_eq!(names, ["Ref", "x", "y", "Connectivity", "Degree", "Depth", "Entropy"]);
    let map = json(Path::new(&cells));
    let features = map["features"].as_array().unwrap();
    assert_eq!(features.len(), table.lines().count() - 1);
    let unit_m = map["metres_per_unit"].as_f64().unwrap();
    let mut degrees = 0.0;
    for (line, feature) in table.lines().skip(1).zip(features) {
        let values: Vec<Option<f64>> = line.split(',').map(|v| v.parse().ok()).collect();
        for (name, value) in names.iter().zip(&values) {
            assert_eq!(feature["properties"][name].as_f64(), *value, "{name}");
        }
        let corner = |i: usize, k: usize| feature["geometry"]["coordinates"][0][i][k].as_f64().unwrap();
        for k in 0..2 {
            let middle = f64::midpoint(corner(0, k), corner(2, k));
            assert!((middle - values[1 + k].unwrap()).abs() < 1e-9 / unit_m);
            assert!((corner(2, k) - corner(0, k) - 1.0 / unit_m).abs() < 1e-9 / unit_m);
        }
        degrees += values[3].unwrap();
    }
    let pairs = json(Path::new(&edges))["features"].as_array().unwrap().len();
    assert_eq!(pairs as f64 * 2.0, degrees);
}

/// What is estimated says so: on standard output, in the result, with its interval beside it.
#[test]
fn estimates_are_called_estimates() {
    let folder = tempfile::tempdir().unwrap();
    let [out, csv, result] =
        ["", "cells.csv", "a.json"].map(|n| folder.path().join(n).to_string_lossy().into_owned());
    let gallery = sample("gallery.dxf");
    let args = ["analyse", &gallery, "--spacing", "0.5", "--out", &out, "--cells", &csv];
    let on_card = enfilade(&[&args[..], &["--roots", "20", "--backend", "gpu"]].concat());
    assert!(text(&on_card.stderr).contains("no graphics card was asked"), "{}", text(&on_card.stderr));
    let json_to = format!("--json={result}");
    let roots = ["--roots", "20", "--measures", "Visual Mean Depth", &json_to];
    let told = enfilade(&[&args[..], &roots].concat());
    assert!(told.status.success(), "{}", text(&told.stderr));
    assert!(text(&told.stdout).contains("depth and entropy estimated from "), "{}", text(&told.stdout));
    let found = json(Path::new(&result));
    let roots = found["estimated_from_roots"].as_u64().unwrap();
    assert!((15..40).contains(&roots), "{roots}");
    let table = std::fs::read_to_string(&csv).unwrap();
    let mut lines = table.lines();
    assert_eq!(lines.next(), Some("Ref,x,y,Visual Mean Depth,Visual Mean Depth CI95,Degree,Depth,Entropy"));
    let walked = lines.filter(|l| !l.ends_with(",,")).count() as u64;
    assert_eq!(walked, roots, "only roots have a tree of their own");
    assert!(enfilade(&[&args[..], &[&json_to]].concat()).status.success());
    let exact = json(Path::new(&result));
    assert!(exact.get("estimated_from_roots").is_none() && exact.get("mean_ci95").is_none());
    for key in ["depth", "entropy"] {
        let off = (found["mean"][key].as_f64().unwrap() - exact["mean"][key].as_f64().unwrap()).abs();
        assert!(off <= 2.0 * found["mean_ci95"][key].as_f64().unwrap(), "{key}: {off}");
    }
    assert_eq!(found["mean"]["degree"], exact["mean"]["degree"]);
}

/// Two rooms of 6 by 8 m with a wall between that has a gap of some metres, and a door that nothing closes.
fn two_rooms(gap: f64) -> String {
    let walls = [
        [0.0, 0.0, 12.0, 0.0],
        [12.0, 0.0, 12.0, 8.0],
        [12.0, 8.0, 0.0, 8.0],
        [0.0, 8.0, 0.0, 0.0],
        [6.0, 0.0, 6.0, 4.0],
        [6.0, 4.0 + gap, 6.0, 7.1],
    ];
    drawing(&walls.map(|w| line("WALLS", w)).concat())
}

/// A gap that is closed for sight is told wherever something is measured, with its place.
#[test]
fn closed_gaps_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().to_string_lossy().into_owned();
    let plan = folder.path().join("slit.dxf").to_string_lossy().into_owned();
    let told = |gap: f64, args: &[&str]| {
        std::fs::write(&plan, two_rooms(gap)).unwrap();
        let more: &[&str] = if args == ["check"] { &[] } else { &["--spacing", "0.5", "--out", &out] };
        let done = enfilade(&[args, &[&plan], more].concat());
        text(&done.stderr) + &text(&done.stdout)
    };
    let place = "1 gap between walls in line, up to 0.032 m wide, taken as drawing error and closed for sight: at 6,4.01 ";
    for args in [&["analyse"][..], &["run", "--evaluations", "20", "--verbose"], &["check"]] {
        let said = told(0.02, args);
        assert!(said.contains(place), "{args:?}: {said}");
    }
    assert!(told(0.02, &["check"]).contains("1 gap of drawing error (up to 0.032 m) closed"));
    assert!(!told(0.04, &["analyse"]).contains("closed for sight"));
}

/// A name that is no measure is refused, whatever begins like it; decimals of a radius are metres or right angles.
#[test]
fn measures_and_radii_are_taken_by_their_word() {
    let folder = tempfile::tempdir().unwrap();
    let [out, csv, plan] =
        ["", "c.csv", "two.dxf"].map(|n| folder.path().join(n).to_string_lossy().into_owned());
    std::fs::write(&plan, two_rooms(2.0)).unwrap();
    let analyse = |more: &[&str]| {
        let args = ["analyse", &plan, "--spacing", "1", "--out", &out, "--cells", &csv];
        let done = enfilade(&[&args[..], more].concat());
        let header = std::fs::read_to_string(&csv).unwrap_or_default().lines().next().map(str::to_owned);
        (done.status.code(), text(&done.stderr), header.unwrap_or_default())
    };
    let visual = analyse(&["--measures", "visual"]);
    assert_eq!(visual.0, Some(0), "{}", visual.1);
    assert_eq!(visual.2, analyse(&["--measures", "graph"]).2);
    assert!(
        visual.2.contains("Visual Integration [HH]") && visual.2.contains("Connectivity"),
        "{}",
        visual.2
    );
    let (code, said, _) = analyse(&["--measures", "visual node"]);
    assert!(code == Some(3) && said.contains("expected all, graph (or visual)"), "{said}");
    let (code, said, header) = analyse(&["--measures", "metric,angular", "--radius", "2.5"]);
    assert!(code == Some(0) && header.contains("Metric Node Count R2.5,"), "{said} {header}");
    let (code, said, _) = analyse(&["--radius", "2.5"]);
    assert!(
        code == Some(3) && said.contains("expected a whole number: graph measures count steps"),
        "{said}"
    );
}

/// A seed where nobody can stand is named with the reason, and so is one that regions make useless.
#[test]
fn seeds_that_do_nothing_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let [out, plan, drawn] =
        ["", "two.dxf", "drawn.dxf"].map(|n| folder.path().join(n).to_string_lossy().into_owned());
    std::fs::write(&plan, two_rooms(2.0)).unwrap();
    let region = [[1.0, 1.0], [5.0, 1.0], [5.0, 7.0], [1.0, 7.0]];
    let marks = polyline("EF-QUERY", &region, true) + &polyline("EF-REFERENCE", &region, true);
    let walls = [[0.0, 0.0, 12.0, 0.0], [12.0, 0.0, 12.0, 8.0], [12.0, 8.0, 0.0, 8.0], [0.0, 8.0, 0.0, 0.0]];
    std::fs::write(&drawn, drawing(&(walls.map(|w| line("WALLS", w)).concat() + &marks))).unwrap();
    let said = |plan: &str, seeds: &[&str]| {
        let seeds: Vec<String> = seeds.iter().map(|s| format!("--seed-point={s}")).collect();
        let seeds: Vec<&str> = seeds.iter().map(String::as_str).collect();
        let done = enfilade(&[&["analyse", plan, "--spacing", "0.7", "--out", &out], &seeds[..]].concat());
        (done.status.code(), text(&done.stderr))
    };
    let (code, told) = said(&plan, &["6,2"]);
    assert!(
        code == Some(2) && told.contains("two.dxf: --seed-point 6,2 lies on a wall; nothing was measured"),
        "{told}"
    );
    let (code, told) = said(&plan, &["3,3", "6,2"]);
    assert!(code == Some(1) && told.contains("--seed-point 6,2 lies on a wall; it is left out"), "{told}");
    assert_eq!(said(&plan, &["3,3"]).0, Some(0));
    let (code, told) = said(&drawn, &["3,3"]);
    assert!(code == Some(1) && told.contains("the seed changes nothing"), "{told}");
}

/// Ground under a wall is no floor, whether the wall may move or not, and however many others join it.
#[test]
fn what_may_move_changes_nothing_that_is_measured() {
    let folder = tempfile::tempdir().unwrap();
    let house = walls("A-WALL") + &panes("A-GLAZ") + &swings("A-DOOR");
    let [w, h] = SIZE;
    let around = [[-1.0, -1.0], [w + 1.0, -1.0], [w + 1.0, h + 1.0], [-1.0, h + 1.0]];
    let kept = house.clone() + &polyline("EF-KEEP", &around, true);
    let measured = |name: &str, entities: &str| {
        let [plan, out, csv] = ["dxf", "out", "csv"]
            .map(|e| folder.path().join(format!("{name}.{e}")).to_string_lossy().into_owned());
        std::fs::write(&plan, drawing(entities)).unwrap();
        // A row of cells in the middle of a wall that three others join.
        let done = enfilade(&["analyse", &plan, "--spacing", "0.395", "--out", &out, "--cells", &csv]);
        let result = json(&folder.path().join(format!("{name}.out/{name}.enfilade/analysis/analysis.json")));
        assert!(!text(&done.stderr).contains("no view joins"), "{}", text(&done.stderr));
        (result["mean"].clone(), std::fs::read_to_string(csv).unwrap())
    };
    let (free, held) = (measured("free", &house), measured("held", &kept));
    assert_eq!(free.0, held.0);
    let degrees =
        |csv: &str| -> Vec<String> { csv.lines().map(|l| l.split_once(',').unwrap().1.to_owned()).collect() };
    assert_eq!(degrees(&free.1), degrees(&held.1));
}

/// Whoever opens a pipe waits for its other end; what is no file is named at once.
#[cfg(unix)]
#[test]
fn what_is_no_file_is_never_waited_for() {
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("pipe.dxf");
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    for path in [pipe.as_path(), folder.path()] {
        let done = enfilade(&["check", &path.to_string_lossy()]);
        assert!(text(&done.stderr).contains("expected a file"), "{}", text(&done.stderr));
    }
    let large = folder.path().join("large.dxf");
    std::fs::File::create(&large).unwrap().set_len(enfilade::watch::MAX_DRAWING_BYTES + 1).unwrap();
    let done = enfilade(&["check", &large.to_string_lossy()]);
    assert!(text(&done.stderr).contains("expected at most 2048 MB"), "{}", text(&done.stderr));
}

/// A measure that is an objective and asked for by name too has one picture.
#[test]
fn an_objective_that_is_asked_for_by_name_is_drawn_once() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::copy(sample("gallery.dxf"), folder.path().join("gallery.dxf")).unwrap();
    std::fs::write(folder.path().join("enfilade.toml"), "objective = \"isovist-area max 0.7\"\n").unwrap();
    let gallery = folder.path().join("gallery.dxf").to_string_lossy().into_owned();
    let done = enfilade(&["analyse", &gallery, "--spacing", "1", "--measures", "isovist"]);
    assert!(done.status.success(), "{}", text(&done.stderr));
    assert!(folder.path().join("gallery.enfilade/analysis/isovist-area.png").is_file());
}

//! What the architect decides, from the drawing to the written option: pairs of regions, links, modules,
//! limits, pinned options, what is found so far.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::time::Instant;

use enfilade::config::{Partial, Settings};
use enfilade::pipeline::{self, Event, Input};
use enfilade::report::{Cancel, OutFile};
use serde_json::Value;

/// An R12 drawing in metres, put together piece by piece.
#[derive(Clone, Default)]
struct Plan(String);

impl Plan {
    fn wall(mut self, [x, y, u, v]: [f64; 4]) -> Self {
        self.0.push_str(&format!("0\nLINE\n8\nWALL\n10\n{x}\n20\n{y}\n11\n{u}\n21\n{v}\n"));
        self
    }

    fn room(self, [x, y, u, v]: [f64; 4]) -> Self {
        self.wall([x, y, u, y]).wall([u, y, u, v]).wall([u, v, x, v]).wall([x, v, x, y])
    }

    fn ring(mut self, layer: &str, [x, y, u, v]: [f64; 4]) -> Self {
        self.0.push_str(&format!("0\nPOLYLINE\n8\n{layer}\n66\n1\n70\n1\n"));
        for [x, y] in [[x, y], [u, y], [u, v], [x, v]] {
            self.0.push_str(&format!("0\nVERTEX\n8\n{layer}\n10\n{x}\n20\n{y}\n"));
        }
        self.0.push_str(&format!("0\nSEQEND\n8\n{layer}\n"));
        self
    }

    /// A wall with a box round it that says how it moves.
    fn moving(self, wall: [f64; 4], how: &str) -> Self {
        let [x, y, u, v] = wall;
        let mut out =
            self.wall(wall).ring("EF-MOVE", [x.min(u) - 0.2, y.min(v) - 0.2, x.max(u) + 0.2, y.max(v) + 0.2]);
        let at = [f64::midpoint(x, u), f64::midpoint(y, v)];
        out.0.push_str(&format!("0\nTEXT\n8\nEF-MOVE\n10\n{}\n20\n{}\n40\n0.2\n1\n{how}\n", at[0], at[1]));
        out
    }

    fn text(&self) -> String {
        format!("0\nSECTION\n2\nENTITIES\n{}0\nENDSEC\n0\nEOF\n", self.0)
    }
}

/// A hall with three free-standing walls.
fn hall(how: [&str; 3]) -> Plan {
    let plan = Plan::default().room([0.0, 0.0, 20.0, 10.0]);
    let plan = plan.moving([5.0, 2.0, 5.0, 8.0], &format!("{}; name a", how[0]));
    let plan = plan.moving([10.0, 2.0, 10.0, 8.0], &format!("{}; name b", how[1]));
    plan.moving([15.0, 2.0, 15.0, 8.0], &format!("{}; name c", how[2]))
}

fn enfilade(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_enfilade")).args(args).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn json(path: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

/// A folder with a drawing in it.
struct Desk {
    folder: tempfile::TempDir,
}

impl Desk {
    fn new(plan: &Plan) -> Self {
        let desk = Self { folder: tempfile::tempdir().unwrap() };
        desk.draw(plan);
        desk
    }

    fn draw(&self, plan: &Plan) {
        std::fs::write(self.drawing(), plan.text()).unwrap();
    }

    fn drawing(&self) -> PathBuf {
        self.folder.path().join("plan.dxf")
    }

    fn side_car(&self, toml: &str) {
        std::fs::write(self.folder.path().join("plan.enfilade.toml"), toml).unwrap();
    }

    fn call(&self, command: &str, more: &[&str]) -> Output {
        let drawing = self.drawing().to_string_lossy().into_owned();
        let spacing: &[&str] = if more.contains(&"--spacing") { &[] } else { &["--spacing", "0.5"] };
        enfilade(&[&[command, &drawing, "--unit", "m", "-q"], spacing, more].concat())
    }

    /// Runs a round; its folder.
    fn run(&self, round: u32, more: &[&str]) -> PathBuf {
        let done = self.call(
            "run",
            &[if more.contains(&"--evaluations") { &[] } else { &["--evaluations", "60"][..] }, more]
                .concat(),
        );
        let at = self.folder.path().join(format!("plan.enfilade/round-{round:02}"));
        assert!(at.is_dir(), "{more:?}: {}", text(&done.stderr));
        at
    }
}

/// Ends of the walls as they stand in a written drawing, in its own order.
fn walls(file: &Path) -> Vec<[f64; 4]> {
    let text = std::fs::read_to_string(file).unwrap();
    let lines: Vec<&str> = text.lines().map(str::trim).collect();
    let pairs: Vec<(&str, &str)> = lines.chunks_exact(2).map(|p| (p[0], p[1])).collect();
    let mut out = Vec::new();
    for record in pairs.split(|p| p.0 == "0") {
        let value = |code: &str| record.iter().find(|p| p.0 == code).map(|p| p.1);
        if value("8") == Some("WALL") && value("11").is_some() {
            out.push(["10", "20", "11", "21"].map(|c| value(c).unwrap().parse().unwrap()));
        }
    }
    out
}

/// The three inner walls of every option of a round, read from the written drawings.
fn options(round: &Path) -> Vec<[[f64; 4]; 3]> {
    let result = json(&round.join("result.json"));
    let files = result["candidates"].as_array().unwrap().iter().map(|c| c["file"].as_str().unwrap());
    let found: Vec<_> = files.map(|f| walls(&round.join(f))).map(|w| [w[4], w[5], w[6]]).collect();
    assert!(!found.is_empty(), "{}", result["problems"]);
    found
}

fn is_multiple(value: f64, module: f64) -> bool {
    ((value / module).round() * module - value).abs() < 2e-6
}

#[test]
fn a_named_pair_measures_what_it_would_alone() {
    let art = ([0.5, 0.5, 3.0, 3.0], [17.0, 0.5, 19.5, 3.0]);
    let exit = [17.0, 7.0, 19.5, 9.5];
    let base = hall(["x -2 2", "x -2 2; rotate -20 20", "x -2 2"]);
    let both = base
        .clone()
        .ring("EF-QUERY-Art", art.0)
        .ring("EF-REFERENCE-Art", art.1)
        .ring("EF-REFERENCE-Exit", exit);
    let desk = Desk::new(&both);
    let mean = |more: &[&str]| -> Value {
        let done = desk.call("analyse", &[&["--json", "-"], more].concat());
        assert!(done.status.success(), "{}", text(&done.stderr));
        serde_json::from_slice::<Value>(&done.stdout).unwrap()["mean"].clone()
    };
    let named = mean(&[]);
    desk.draw(&base.clone().ring("EF-QUERY", art.0).ring("EF-REFERENCE", art.1));
    let alone = mean(&[]);
    desk.draw(&base.clone().ring("EF-REFERENCE", exit));
    let from_everywhere = mean(&[]);
    for key in ["degree", "depth", "entropy"] {
        assert_eq!(named[format!("{key}@art")], alone[key], "{key}");
        assert_eq!(named[format!("{key}@exit")], from_everywhere[key], "{key}");
    }
    desk.draw(&base);
    let none = mean(&[]);
    assert_eq!(named["degree"], none["degree"], "what has no name is measured as without names");
    desk.side_car(&format!(
        "[[region]]\nkind = \"query\"\npair = \"art\"\npoints = {}\n[[region]]\nkind = \"reference\"\npair = \"Art\"\npoints = {}\n",
        corners(art.0),
        corners(art.1)
    ));
    assert_eq!(mean(&[])["degree@art"], alone["degree"], "by the side-car");
}

fn corners([x, y, u, v]: [f64; 4]) -> String {
    format!("[[{x}, {y}], [{u}, {y}], [{u}, {v}], [{x}, {v}]]")
}

#[test]
fn two_pairs_are_improved_at_once() {
    let plan = hall(["x -2 2", "x -2 2; rotate -20 20", "x -2 2"]);
    let plan =
        plan.ring("EF-QUERY-art", [0.5, 0.5, 3.0, 3.0]).ring("EF-REFERENCE-art", [17.0, 0.5, 19.5, 3.0]);
    let plan = plan.ring("EF-REFERENCE-exit", [17.0, 7.0, 19.5, 9.5]);
    let desk = Desk::new(&plan);
    let wanted =
        ["--objective", "degree@art max 0.5, degree-p10@exit max 0.3", "--limit", "degree@exit -20%"];
    let round = desk.run(1, &wanted);
    let result = json(&round.join("result.json"));
    assert_eq!(result["objectives"][1]["name"], "degree@art");
    let present = result["initial"]["mean"]["degree@art"].as_f64().unwrap();
    let first = &result["candidates"][0];
    assert!(first["mean"]["degree@art"].as_f64().unwrap() > present, "{first}");
    assert!(first["mean"]["degree-p10@exit"].is_number() && first["mean"]["entropy@exit"].is_number());
    assert!(first["words"].as_str().unwrap().contains("visibility (art) +"), "{}", first["words"]);
    for name in ["initial-degree-art.png", "candidate-1-degree-exit.png", "candidate-1-degree.png"] {
        assert!(round.join(name).is_file(), "{name}");
    }
    let page = std::fs::read_to_string(round.join("report.html")).unwrap();
    assert!(page.contains("Visibility (art)") && page.contains("degree@art max 0.5"));
    assert!(std::fs::read_to_string(round.join("candidate-1.dxf")).unwrap().contains("EF-HEAT-DEGREE-EXIT"));
    let refused = desk.call("run", &["--objective", "degree@door max 0.5"]);
    assert_eq!(refused.status.code(), Some(3));
    assert!(text(&refused.stderr).contains("pairs drawn: art, exit"), "{}", text(&refused.stderr));
}

#[test]
fn written_walls_stand_on_the_module() {
    let desk = Desk::new(&hall(["x -2 2; y -1 1", "x -2 2; rotate -40 40", "x -2 2"]));
    let round = desk.run(1, &["--objective", "degree max 0.3", "--snap", "0.25 m, 15 deg"]);
    for [a, b, c] in options(&round) {
        for (wall, [x, y]) in [(a, [5.0, 2.0]), (c, [15.0, 2.0])] {
            assert!(is_multiple(wall[0] - x, 0.25) && is_multiple(wall[1] - y, 0.25), "{wall:?}");
            assert!((wall[2] - wall[0]).abs() < 1e-6 && (wall[3] - wall[1] - 6.0).abs() < 1e-6, "{wall:?}");
        }
        let turn = (b[3] - b[1]).atan2(b[2] - b[0]).to_degrees() - 90.0;
        assert!(((turn / 15.0).round() * 15.0 - turn).abs() < 1e-4, "{b:?} {turn}");
        assert!(is_multiple(f64::midpoint(b[0], b[2]) - 10.0, 0.25), "{b:?}");
    }
}

#[test]
fn written_walls_keep_their_links() {
    let desk = Desk::new(&hall(["x -2 2", "x -2 2", "x -1 1.5"]));
    let along = |w: [f64; 4], x: f64| w[0] - x;
    let wish = ["--objective", "degree max 0.2"];
    let round = desk.run(1, &[&wish[..], &["--link", "mirror-x: a, c"]].concat());
    for [a, _, c] in options(&round) {
        assert!((along(a, 5.0) + along(c, 15.0)).abs() < 2e-6, "{a:?} {c:?}");
    }
    let round = desk.run(2, &[&wish[..], &["--link", "same: a, c"]].concat());
    for [a, _, c] in options(&round) {
        assert!((along(a, 5.0) - along(c, 15.0)).abs() < 2e-6, "{a:?} {c:?}");
        assert!(
            (-1.0 - 2e-6..=1.5 + 2e-6).contains(&along(a, 5.0)),
            "the leader keeps inside what all may do"
        );
    }
    let round = desk.run(3, &[&wish[..], &["--link", "equal: a, b, c", "--snap", "0.1 m"]].concat());
    for [a, b, c] in options(&round) {
        assert!((b[0] - a[0] - (c[0] - b[0])).abs() < 2e-6, "{a:?} {b:?} {c:?}");
        assert!(is_multiple(along(b, 10.0), 0.1));
    }
    let round = desk.run(4, &[&wish[..], &["--most-moves", "1"]].concat());
    for walls in options(&round) {
        let moved = walls.iter().zip([5.0, 10.0, 15.0]).filter(|(w, x)| (w[0] - x).abs() > 1e-6).count();
        assert!(moved <= 1, "{walls:?}");
    }
}

/// Two rooms parted by a wall with a door, and a wall that comes near another.
fn flat() -> Plan {
    let plan = Plan::default().room([0.0, 0.0, 10.0, 6.0]);
    let plan = plan.moving([4.0, 0.0, 4.0, 2.4], "x -2 2; name low");
    plan.moving([4.0, 3.4, 4.0, 6.0], "x -2 2; name high")
}

#[test]
fn rooms_keep_their_area() {
    let desk = Desk::new(&flat());
    let wish = ["--objective", "degree max 0.1", "--link", "same: low, high", "--distance", "0.05"];
    // So light that the hard limit decides, not the penalty that must not grow.
    let held = ["--penalty", "room-area 0.001", "--limit", "room-area -20%"];
    let round = desk.run(1, &[&wish[..], &held].concat());
    let result = json(&round.join("result.json"));
    let stated = result["problems"].as_array().unwrap().iter().find(|p| p["code"] == "rooms").unwrap();
    assert!(stated["text"].as_str().unwrap().contains(": 2, of "), "{stated}");
    assert_eq!(result["initial"]["penalty"]["room_area_m2"], 0.0);
    let candidates = result["candidates"].as_array().unwrap();
    assert!(!candidates.is_empty());
    for c in candidates {
        let [x, lost] = [
            walls(&round.join(c["file"].as_str().unwrap()))[4][0],
            c["penalty"]["room_area_m2"].as_f64().unwrap(),
        ];
        assert!((lost - (x - 4.0).abs() * 6.0).abs() < 0.12, "{x}: {lost}");
        assert!((3.2 - 0.02..=5.2 + 0.02).contains(&x), "no room may lose more than a fifth: {x}");
    }
}

#[test]
fn rooms_of_thick_walls_are_parted_by_their_doors() {
    let plan = Plan::default().room([0.0, 0.0, 10.0, 6.0]).room([0.3, 0.3, 9.7, 5.7]);
    let faces = [[4.8, 0.3, 4.8, 2.5], [4.8, 3.5, 4.8, 5.7], [5.2, 0.3, 5.2, 2.5], [5.2, 3.5, 5.2, 5.7]];
    let plan = faces.into_iter().fold(plan, Plan::wall);
    let desk = Desk::new(&plan.moving([2.0, 2.0, 2.0, 3.0], "x -0.5 0.5"));
    let round = desk.run(1, &["--penalty", "room-area 1", "--objective", "degree max 0.1"]);
    let result = json(&round.join("result.json"));
    let problems = result["problems"].as_array().unwrap();
    let stated = problems.iter().find(|p| p["code"] == "rooms").unwrap()["text"].as_str().unwrap();
    assert!(stated.contains(": 2, of "), "{stated}");
    for c in result["candidates"].as_array().unwrap() {
        assert!(
            c["penalty"]["room_area_m2"].as_f64().unwrap() < 0.1,
            "a screen inside a room takes no floor"
        );
    }
}

#[test]
fn passages_stay_as_wide_as_asked() {
    let plan = Plan::default().room([0.0, 0.0, 10.0, 6.0]).wall([6.0, 0.0, 6.0, 4.0]);
    let desk = Desk::new(&plan.moving([4.0, 1.5, 4.0, 6.0], "x -1 1.9; name screen"));
    let wish = ["--objective", "degree max 0", "--distance", "0.05"];
    let round = desk.run(1, &[&wish[..], &["--limit", "passage 1.2 m"]].concat());
    let result = json(&round.join("result.json"));
    for c in result["candidates"].as_array().unwrap() {
        let x = walls(&round.join(c["file"].as_str().unwrap()))[5][0];
        assert!(6.0 - x >= 1.2 - 1e-5, "{x}");
    }
    assert!(!result["candidates"].as_array().unwrap().is_empty());
}

/// `passage@NAME` holds where a region of that name is drawn, and nowhere else.
#[test]
fn passages_are_kept_wide_where_it_is_asked() {
    let plan = Plan::default().room([0.0, 0.0, 10.0, 6.0]).wall([6.0, 0.0, 6.0, 4.0]);
    let plan = plan.moving([4.0, 1.5, 4.0, 6.0], "x -1 1.9; name screen");
    let wish = ["--objective", "degree max 0", "--distance", "0.05", "--limit"];
    let nearest = |at: [f64; 4]| {
        let desk = Desk::new(&plan.clone().ring("EF-QUERY-here", at));
        let round = desk.run(1, &[&wish[..], &["passage@here 1.2 m"]].concat());
        let result = json(&round.join("result.json"));
        let options = result["candidates"].as_array().unwrap().clone();
        let gap = |c: &Value| 6.0 - walls(&round.join(c["file"].as_str().unwrap()))[5][0];
        options.iter().map(gap).fold(f64::INFINITY, f64::min)
    };
    assert!(nearest([4.5, 2.0, 5.8, 3.5]) >= 1.2 - 1e-5, "the region lies in the passage");
    assert!(nearest([0.5, 0.5, 2.0, 2.0]) < 1.2, "it lies elsewhere");
    let desk = Desk::new(&plan.ring("EF-QUERY-there", [0.5, 0.5, 2.0, 2.0]));
    let refused = desk.call("run", &["--limit", "passage@here 1.2 m"]);
    let said = text(&refused.stderr);
    assert!(
        said.contains("passage@here 1.2 m: no pair of regions of this name, pairs drawn: there"),
        "{said}"
    );
}

/// A layout that hides all of what an objective looks at is none, however few the views to what is not seen.
#[test]
fn what_is_looked_at_stays_in_sight() {
    let plan = Plan::default().room([0.0, 0.0, 20.0, 10.0]);
    let plan = plan.wall([10.0, 0.0, 10.0, 4.25]).wall([10.0, 5.75, 10.0, 10.0]);
    let plan = plan.moving([9.6, 1.0, 9.6, 4.0], "y 0 3; name screen");
    let plan =
        plan.ring("EF-REFERENCE-nook", [12.0, 1.0, 19.0, 9.0]).ring("EF-QUERY-nook", [1.0, 3.0, 3.0, 7.0]);
    let round = Desk::new(&plan);
    let result = json(&round.run(1, &["--objective", "depth@nook min 0.5"]).join("result.json"));
    assert!(result["initial"]["mean"]["degree@nook"].as_f64().unwrap() > 0.0);
    for c in result["candidates"].as_array().unwrap() {
        assert!(c["mean"]["degree@nook"].as_f64().unwrap() > 0.0, "{}", c["words"]);
    }
}

/// Where few walls may move at once, options are asked to stand only so far apart as two such layouts can.
#[test]
fn few_moves_leave_less_room_between_options() {
    let desk = Desk::new(&hall(["x -2 2", "x -2 2", "x -2 2"]));
    let wanted = |round: u32, more: &[&str]| {
        let round =
            desk.run(round, &[&["--distance", "0.8", "--objective", "degree max 0.5"][..], more].concat());
        let problems = json(&round.join("result.json"))["problems"].clone();
        let alike = problems.as_array().unwrap().iter().find(|p| p["code"] == "options-alike").cloned();
        alike.expect("so far apart no two options stand")["text"].as_str().unwrap().to_owned()
    };
    assert!(wanted(1, &[]).contains("1.386 was wanted"));
    assert!(wanted(2, &["--most-moves", "1"]).contains("0.800 was wanted"));
    assert!(wanted(3, &["--most-moves", "2"]).contains("1.131 was wanted"));
}

/// Floor that a moved thick wall covers is no floor: an option is worth what its drawing is found to be worth.
#[test]
fn a_written_option_is_measured_as_it_was_found() {
    let folder = tempfile::tempdir().unwrap();
    let sample = Path::new(env!("CARGO_MANIFEST_DIR")).join("samples/pavilion.dxf");
    let drawing = folder.path().join("pavilion.dxf");
    std::fs::copy(sample, &drawing).unwrap();
    let asked =
        ["--spacing", "0.5", "--objective", "depth min 0.9", "--evaluations", "120", "--members", "3"];
    let ran = enfilade(&[&["run", drawing.to_str().unwrap(), "-q"], &asked[..]].concat());
    assert!(ran.status.code().unwrap() <= 1, "{}", text(&ran.stderr));
    let round = folder.path().join("pavilion.enfilade/round-01");
    let result = json(&round.join("result.json"));
    let options = result["candidates"].as_array().unwrap();
    let mut measured = 0;
    for (k, option) in options.iter().enumerate() {
        let written = round.join(format!("candidate-{}.dxf", k + 1));
        let copy = folder.path().join(format!("option-{k}.dxf"));
        std::fs::copy(written, &copy).unwrap();
        let seen = enfilade(&["analyse", copy.to_str().unwrap(), "--spacing", "0.5", "--json", "-", "-q"]);
        let seen: Value = serde_json::from_slice(&seen.stdout).unwrap();
        let [stated, found] = [&option["mean"], &seen["mean"]];
        for name in ["degree", "depth", "entropy"] {
            let [a, b] = [stated, found].map(|m| m[name].as_f64().unwrap());
            assert!((a - b).abs() < 1e-9, "option {}: {name} stated {a}, found {b}", k + 1);
        }
        measured += 1;
    }
    assert!(measured > 0);
}

/// Cells whose centres a moved wall touches are no floor that is cut off.
#[test]
fn a_wall_may_stand_on_the_centres_of_cells() {
    let plan = Plan::default().room([0.0, 0.0, 20.0, 10.0]);
    let desk = Desk::new(&plan.moving([4.5, 2.0, 4.5, 8.0], "x 0 1.5; name a"));
    let rules = ["--spacing", "1", "--lattice-centre", "0,0", "--snap", "1.5 m", "--evaluations", "10"];
    let moved = |objective: &str, round: u32| {
        let at = desk.run(round, &[&rules[..], &["--objective", objective]].concat());
        let result = json(&at.join("result.json"));
        let options = result["candidates"].as_array().unwrap().clone();
        options
            .iter()
            .any(|c| c["parameters"][0].as_f64() == Some(1.5) && !c["changes"].as_array().unwrap().is_empty())
    };
    assert_ne!(
        moved("degree max 0", 1),
        moved("degree min 0", 2),
        "it is better or worse, and may stand there"
    );
}

/// What cannot be kept is said before anything is done.
#[test]
fn pins_and_likes_that_cannot_be_kept_are_refused() {
    let desk = Desk::new(&hall(["x -1 1", "x -1 1", "x -1 1"]));
    desk.run(1, &["--objective", "degree max 0.3"]);
    for (asked, says) in [
        (&["--pin", "1", "--mode", "best"][..], "mode best"),
        (&["--pin", "1", "--method", "paper"], "method paper"),
        (&["--like", "1", "--most-moves", "1"], "at most 1 may move"),
    ] {
        let done = desk.call("run", asked);
        assert!(done.status.code() > Some(1), "{asked:?}");
        assert!(text(&done.stderr).contains(says), "{asked:?}: {}", text(&done.stderr));
    }
}

#[test]
fn every_measure_of_the_engine_can_be_an_objective() {
    let desk = Desk::new(&hall(["x -2 2", "x -2 2", "x -2 2"]));
    let wish = "integration max 0.2, metric-distance min 0, angular-depth-p90 min 0, through-vision max 0, \
                control max 0, clustering min 0, isovist-max-radial-p50 max 0";
    let round = desk.run(1, &["--spacing", "1", "--objective", wish, "--evaluations", "20"]);
    let result = json(&round.join("result.json"));
    let names =
        ["integration", "metric-distance", "angular-depth-p90", "through-vision", "control", "clustering"];
    for name in names {
        assert!(result["initial"]["mean"][name].as_f64().unwrap() > 0.0, "{name}");
        let drawn = result["candidates"].as_array().unwrap().iter().all(|c| c["mean"][name].is_number());
        assert!(drawn, "{name}");
    }
    let problems = result["problems"].as_array().unwrap();
    assert!(!problems.iter().any(|p| p["code"] == "written-differs"), "{problems:?}");
    let costs = problems.iter().filter(|p| p["code"] == "costly-measure").count();
    assert_eq!(costs, 6, "all but integration say what they cost: {problems:?}");
    assert!(round.join("initial-metric-distance.png").is_file());
    let csv = desk.folder.path().join("cells.csv").to_string_lossy().into_owned();
    let done = desk.call("analyse", &["--spacing", "1", "--measures", "all", "--cells", &csv]);
    assert!(done.status.success(), "{}", text(&done.stderr));
    let table = std::fs::read_to_string(&csv).unwrap();
    let head: Vec<&str> = table.lines().next().unwrap().split(',').collect();
    for (column, name) in [
        ("Visual Integration [HH]", "integration"),
        ("Metric Mean Shortest-Path Distance", "metric-distance"),
        ("Through vision", "through-vision"),
        ("Visual Control", "control"),
        ("Visual Clustering Coefficient", "clustering"),
    ] {
        let at = head.iter().position(|h| *h == column).unwrap();
        // −1 stands where a cell has no such value, and what a wall stands on has no degree; the mean leaves both out.
        let values: Vec<f64> = table
            .lines()
            .skip(1)
            .filter(|l| !l.ends_with(",,,"))
            .map(|l| l.split(',').nth(at).unwrap().parse().unwrap())
            .filter(|v| *v != -1.0)
            .collect();
        assert!(!values.is_empty(), "{column}");
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let found = result["initial"]["mean"][name].as_f64().unwrap();
        assert!((mean - found).abs() < 1e-9 * mean.abs().max(1.0), "{column}: {mean} {found}");
    }
}

#[test]
fn a_pinned_option_that_no_longer_fits_is_named() {
    let drawn = hall(["x -2 2", "x -2 2", "x -2 2"]);
    let desk = Desk::new(&drawn);
    desk.run(1, &["--objective", "degree max 0.3"]);
    let refused = |plan: Plan, what: &str| {
        desk.draw(&plan);
        let done = desk.call("run", &["--pin", "1", "--evaluations", "20"]);
        let said = text(&done.stderr);
        assert_eq!(done.status.code(), Some(3), "{said}");
        assert!(said.contains(what), "{said}");
    };
    refused(hall(["y -2 2", "x -2 2", "x -2 2"]), "a (x) may not move any more");
    refused(hall(["x -2 2; name d", "x 0 0.001", "x -2 2"]), "and may now be between 0 and 0.001 m");
    let elsewhere = Plan(drawn.0.replace("10\n5\n20\n2\n11\n5\n21\n8", "10\n5.05\n20\n2\n11\n5.05\n21\n8"));
    refused(elsewhere, "a (x) moves other corners than then");
    let more = drawn.clone().moving([2.0, 2.0, 2.0, 4.0], "x -0.5 0.5; name new");
    desk.draw(&more);
    let round = desk.run(2, &["--pin", "1", "--like", "1", "--evaluations", "20"]);
    let then = json(&desk.folder.path().join("plan.enfilade/round-01/result.json"));
    let now = json(&round.join("result.json"));
    let [then, now] = [then, now].map(|r| r["candidates"][0]["parameters"].as_array().unwrap().clone());
    assert_eq!((&then[..], &now[3]), (&now[..3], &Value::from(0.0)), "a new move stays as drawn");
}

/// A pinned option is kept as it was, whatever is asked now, and everything says what it breaks.
#[test]
fn a_pinned_option_that_breaks_what_is_asked_now_is_kept_and_named() {
    let desk = Desk::new(&hall(["x -2 2", "x -2 2", "x -2 2"]));
    let first = json(&desk.run(1, &["--objective", "degree max 0.3"]).join("result.json"));
    let option = first["candidates"][0].clone();
    assert!(option["explanation"].get("breaks").is_none());
    let degree = option["mean"]["degree"].as_f64().unwrap();
    let more = format!("degree >= {}", degree * 2.0);
    let asked = |round: u32, rules: &[&str], word: &str| {
        let at = desk.run(round, &[&["--pin", "1", "--evaluations", "40"], rules].concat());
        let result = json(&at.join("result.json"));
        let kept = &result["candidates"][0];
        assert_eq!(kept["parameters"], option["parameters"], "{rules:?}");
        assert_eq!(kept["within_threshold"], false);
        let breaks = kept["explanation"]["breaks"].to_string();
        let problems = result["problems"].to_string();
        let [page, note] =
            ["report.html", "candidate-1.dxf"].map(|f| text(&std::fs::read(at.join(f)).unwrap()));
        assert!(breaks.contains(word) && problems.contains(word), "{rules:?}: {breaks} {problems}");
        assert!(kept["words"].as_str().unwrap().contains("Kept because it is pinned, though it breaks"));
        assert!(page.contains("Kept because it is pinned") && note.contains("pinned"), "{rules:?}");
        for other in result["candidates"].as_array().unwrap().iter().skip(1) {
            assert!(other["explanation"].get("breaks").is_none(), "{rules:?}");
        }
        desk.run(round + 1, &["--objective", "degree max 0.3"]);
        let again =
            json(&desk.folder.path().join(format!("plan.enfilade/round-{:02}/result.json", round + 1)));
        assert_eq!(again["candidates"], first["candidates"], "the same again, to pin from");
    };
    asked(2, &["--most-moves", "1"], "most-moves 1");
    asked(4, &["--snap", "0.7 m"], "snap 0.7 m");
    asked(6, &["--link", "mirror-x: a, b"], "linked");
    asked(8, &["--limit", &more], "degree");
}

/// What was asked for firmly is kept as result.json states it, and what nobody can keep is said.
#[test]
fn options_keep_firm_thresholds_as_they_are_stated() {
    let desk = Desk::new(&hall(["x -2 2; rotate -40 40", "x -2 2; rotate -40 40", "x -2 2; y -1 1"]));
    for seed in 1..=4 {
        let asked = "degree max 0.6, entropy min 0.4, depth-p90 min 0.3";
        let at = desk.run(seed, &["--objective", asked, "--seed", &seed.to_string(), "--evaluations", "90"]);
        let result = json(&at.join("result.json"));
        let options = result["candidates"].as_array().unwrap();
        assert!(!options.is_empty());
        for o in result["objectives"].as_array().unwrap().iter().skip(1) {
            let of = |key: &str| o[key].as_f64().unwrap();
            let name = o["name"].as_str().unwrap();
            let sign = if o["sense"] == "max" { 1.0 } else { -1.0 };
            let [initial, reachable, limit] = ["initial", "reachable", "limit"].map(|k| sign * of(k));
            let is_said = result["problems"].to_string().contains("out-of-reach");
            assert!(reachable > initial || is_said, "{o}");
            let range = (reachable - initial).max(0.02 * initial.abs());
            if reachable > initial {
                assert!((limit - (reachable - (1.0 - of("threshold")) * range)).abs() < 1e-9, "{o}");
            }
            for option in options {
                let value = sign * option["mean"][name].as_f64().unwrap();
                assert!(value >= limit - 1e-9, "seed {seed}: {value} of {name}, {o}");
            }
        }
    }
}

/// A round without options answers whatever is asked of it in plain words.
#[test]
fn a_round_without_options_can_be_asked_for_them() {
    let desk = Desk::new(&hall(["x -2 2", "x -2 2", "x -2 2"]));
    let result = json(&desk.run(1, &["--limit", "degree >= +500%"]).join("result.json"));
    assert_eq!(result["candidates"].as_array().unwrap().len(), 0);
    let objective = &result["objectives"][1];
    assert!(["best", "reachable", "limit"].iter().all(|k| objective[k].is_null()), "{objective}");
    let problems = result["problems"].to_string();
    assert!(problems.contains("keeps every hard limit") && problems.contains("it has"), "{problems}");
    let drawing = desk.drawing().to_string_lossy().into_owned();
    for (arguments, words) in [
        (&["accept", &drawing, "0"][..], "found no layout better than the present one"),
        (&["accept", &drawing, "1"], "has no options"),
        (&["run", &drawing, "--pin", "1"], "has no options"),
        (&["run", &drawing, "--like", "1"], "has no options"),
    ] {
        let done = enfilade(arguments);
        let said = text(&done.stderr);
        assert_eq!(done.status.code(), Some(3), "{said}");
        assert!(said.contains(words) && !said.contains("null"), "{arguments:?}: {said}");
    }
}

/// What a stopped search leaves in so-far/ can be accepted, pinned and liked.
#[test]
fn the_best_so_far_can_be_taken() {
    let desk = Desk::new(&hall(["x -2 2", "x -2 2", "x -2 2"]));
    let round = desk.run(1, &["--objective", "degree max 0.3"]);
    let so_far = round.with_file_name("so-far");
    let drawing = desk.drawing().to_string_lossy().into_owned();
    let refused = enfilade(&["accept", &drawing, "1", "--so-far"]);
    assert_eq!(refused.status.code(), Some(3), "{}", text(&refused.stderr));
    assert!(text(&refused.stderr).contains("--write-every"), "{}", text(&refused.stderr));
    // As a stop leaves it: no round, its files in so-far.
    std::fs::rename(&round, &so_far).unwrap();
    let parameters = |at: &Path| json(&at.join("result.json"))["candidates"][0]["parameters"].clone();
    for (arguments, is_new) in
        [(&["accept", &drawing, "1"][..], true), (&["accept", &drawing, "1", "--so-far"], false)]
    {
        let done = enfilade(arguments);
        let said = text(&done.stdout);
        assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
        assert!(said.contains("option 1 of the best so far") && said.contains("before") != is_new, "{said}");
    }
    let car = std::fs::read_to_string(desk.folder.path().join("plan-r02.enfilade.toml")).unwrap();
    assert!(car.contains("so-far = true"), "{car}");
    let next = enfilade(&["run", &drawing.replace("plan.dxf", "plan-r02.dxf"), "--evaluations", "20", "-q"]);
    assert!(next.status.success(), "{}", text(&next.stderr));
    let page = desk.folder.path().join("plan-r02.enfilade/round-01/report.html");
    assert!(std::fs::read_to_string(page).unwrap().contains("Best so far of a stopped search: plan.dxf"));
    let other = enfilade(&[
        "run",
        &drawing.replace("plan.dxf", "plan-r02.dxf"),
        "--evaluations",
        "20",
        "-q",
        "--spacing",
        "0.6",
    ]);
    assert!(other.status.success(), "{}", text(&other.stderr));
    let [same, changed] = [1, 2].map(|n| {
        let at = desk.folder.path().join(format!("plan-r02.enfilade/round-0{n}/report.html"));
        std::fs::read_to_string(at).unwrap().contains("Spacing or regions have changed")
    });
    assert_eq!((same, changed), (false, true));
    let pinned = parameters(&so_far);
    let next = desk.run(1, &["--pin", "1", "--so-far", "--evaluations", "20"]);
    assert_eq!(parameters(&next), pinned);
    assert!(!so_far.exists(), "the finished round takes its place");
}

/// What nobody stated is not stated in the side-car, so that what is stated later is firm.
#[test]
fn an_accepted_drawing_leaves_open_what_nobody_stated() {
    for (stated, objective, thresholds) in [
        (&[][..], None, None),
        (&["--objective", "degree max 0.5"], Some("degree max 0.5"), Some("firm")),
        (&["--thresholds", "firm"], Some("degree max 0.7, depth min 0.7, entropy max 0.7"), Some("firm")),
        (
            &["--objective", "degree max 0.5", "--thresholds", "yielding"],
            Some("degree max 0.5"),
            Some("yielding"),
        ),
    ] {
        let desk = Desk::new(&hall(["x -2 2", "x -2 2", "x -2 2"]));
        desk.run(1, &[stated, &["--evaluations", "40"]].concat());
        let drawing = desk.drawing().to_string_lossy().into_owned();
        assert!(enfilade(&["accept", &drawing, "1"]).status.success(), "{stated:?}");
        let car = std::fs::read_to_string(desk.folder.path().join("plan-r02.enfilade.toml")).unwrap();
        let car: toml::Table = car.parse().unwrap();
        let has = |key: &str| car.get(key).map(|v| v.as_str().unwrap().to_owned());
        assert_eq!((has("objective").as_deref(), has("thresholds").as_deref()), (objective, thresholds));
    }
}

#[test]
fn an_accepted_option_begins_with_what_survives() {
    let desk = Desk::new(&hall(["x -2 2", "x -2 2", "x -2 2"]));
    desk.run(1, &["--objective", "degree max 0.3"]);
    let drawing = desk.drawing().to_string_lossy().into_owned();
    assert!(enfilade(&["accept", &drawing, "1"]).status.success());
    let next = desk.folder.path().join("plan-r02.dxf").to_string_lossy().into_owned();
    let car = desk.folder.path().join("plan-r02.enfilade.toml");
    let told = |want: bool| {
        let done = enfilade(&["run", &next, "--evaluations", "20"]);
        let said = text(&done.stderr);
        assert!(matches!(done.status.code(), Some(0 | 1)), "{said}");
        assert_eq!(said.contains("do not fit the drawing as a whole"), want, "{said}");
    };
    told(false);
    let side_car = std::fs::read_to_string(&car).unwrap();
    assert!(side_car.contains("[[warm-move]]"), "{side_car}");
    let at = side_car.find("[[move]]\n").unwrap();
    let changed =
        format!("{}{}", &side_car[..at], side_car[at..].replacen("name = \"a\"", "name = \"door\"", 1));
    std::fs::write(&car, changed).unwrap();
    told(true);
}

#[test]
fn what_is_found_so_far_is_a_whole_round_and_disturbs_nothing() {
    let plan = hall(["x -2 2", "x -2 2", "x -2 2"]).text();
    let run = |every: Option<f64>| {
        let partial = Partial {
            unit: Some("m".into()),
            spacing: Some(1.0),
            evaluations: Some(5),
            ..Partial::default()
        };
        let settings = Settings { write_every_secs: every, ..Settings::new(partial).unwrap() };
        let input = Input::new("plan.dxf", plan.as_bytes(), 1);
        let mut so_far: Vec<(Vec<OutFile>, u64)> = Vec::new();
        let mut show = |event: Event| {
            if let Event::SoFar { files, progress } = event {
                assert_eq!(progress.stage, "so-far");
                so_far.push((files, progress.evaluations));
            }
        };
        let done = pipeline::run(&input, &settings, Instant::now(), &mut show, &Cancel::default()).unwrap();
        (so_far, done)
    };
    let (written, done) = run(Some(0.0));
    let (none, same) = run(None);
    assert!(none.is_empty());
    assert!(written.len() >= 2, "{}", written.len());
    for (files, evaluations) in &written {
        let of = |name: &str| files.iter().find(|f| f.path.as_os_str() == name);
        let result: Value = serde_json::from_slice(&of("result.json").unwrap().bytes).unwrap();
        assert_eq!(result["evaluations"].as_u64(), Some(*evaluations));
        assert_eq!(result["stopped_by"], "the search had not ended; this is the best so far");
        assert!(of("report.html").is_some() && of("initial.dxf").is_some());
    }
    let drawings = |files: &[OutFile]| -> Vec<OutFile> {
        files
            .iter()
            .filter(|f| f.path.extension().is_some_and(|e| e == "dxf" || e == "html"))
            .cloned()
            .collect()
    };
    assert_eq!(drawings(&done.files), drawings(&same.files));
}

/// Where nobody said what moves, no option runs a wall through another; where somebody did, it is the user's affair.
#[test]
fn default_moves_run_no_wall_through_another() {
    let crossings = |is_marked: bool| -> Vec<f64> {
        let plan = Plan::default().room([0.0, 0.0, 20.0, 10.0]).wall([10.0, 0.0, 10.0, 5.0]);
        let plan = [[5.0, 3.0, 9.5, 3.0], [10.5, 3.0, 15.0, 3.0]].into_iter().fold(plan, |plan, wall| {
            if is_marked { plan.moving(wall, "x -1 1; y -1 1; turn -15 15") } else { plan.wall(wall) }
        });
        let desk = Desk::new(&plan);
        let round = desk.run(1, &["--evaluations", "150", "--penalty", "none"]);
        let result = json(&round.join("result.json"));
        let options = result["candidates"].as_array().unwrap();
        options.iter().map(|c| c["penalty"]["overlap"].as_f64().unwrap()).collect()
    };
    let [default, marked] = [false, true].map(crossings);
    assert!(default.len() > 1 && default.iter().all(|m| *m <= 0.02), "{default:?}");
    assert!(marked.iter().any(|m| *m > 0.1), "{marked:?}");
}

/// A search that ends when it has converged: after a while, and long before the most it may take.
#[test]
fn a_search_ends_when_little_is_to_come() {
    let desk = Desk::new(&hall(["x -2 2", "x -1 1", "x -1 1"]));
    let wish = ["--until-converged", "--spacing", "1", "--evaluations"];
    let result = |n: u32, most| json(&desk.run(n, &[&wish[..], &[most]].concat()).join("result.json"));
    let (enough, cut) = (result(1, "9000"), result(2, "50"));
    assert!((120..8000).contains(&enough["evaluations"].as_u64().unwrap()), "{}", enough["evaluations"]);
    assert!(enough["stopped_by"].as_str().unwrap().contains("about 95 %"), "{}", enough["stopped_by"]);
    assert!(cut["stopped_by"].as_str().unwrap().contains("used up"), "{}", cut["stopped_by"]);
}

/// What is reported as the best gains no less than any option, whichever method found them.
#[test]
fn the_best_is_no_worse_than_an_option() {
    let desk = Desk::new(&hall(["x -2 2; y -1 1", "x -2 2; rotate -40 40", "x -2 2"]));
    let paper = ["--method", "paper", "--objective", "score max 0.7", "--limit", "wall-length -0%"];
    let result = json(&desk.run(1, &[&paper[..], &["--spacing", "1"]].concat()).join("result.json"));
    let score = |v: &Value| v["score"].as_f64().unwrap();
    let options = result["candidates"].as_array().unwrap();
    assert!(!options.is_empty() && options.iter().all(|o| score(o) <= score(&result["best"])), "{result}");
    let best = ["--mode", "best", "--most-moves", "2", "--snap", "0.1 m, 5 deg", "--spacing", "1"];
    let result = json(&desk.run(2, &best).join("result.json"));
    assert_eq!(result["best"]["option"], 1, "{}", result["best"]);
}

/// A round without options leaves those of the round before to be pinned.
#[test]
fn options_of_the_round_before_an_empty_one_are_pinned() {
    let desk = Desk::new(&hall(["x -2 2"; 3]));
    let result = |round: u32, more: &[&str]| json(&desk.run(round, more).join("result.json"));
    let first = result(1, &["--spacing", "1"]);
    let none = result(2, &["--spacing", "1", "--limit", "degree >= 1000"])["candidates"].clone();
    let third = result(3, &["--spacing", "1", "--pin", "1"])["candidates"][0].clone();
    assert!(none == Value::Array(vec![]) && third["parameters"] == first["candidates"][0]["parameters"]);
}

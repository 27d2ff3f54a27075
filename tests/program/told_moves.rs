//! What marks ask for and cannot have, or have at a price, is told: clauses that move nothing, walls that run through
//! others, solids that stand in solids.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a failing helper fails the test")]

use std::fmt::Write;
use std::process::Command;

use serde_json::Value;

/// An R12 drawing in metres, put together piece by piece.
#[derive(Default)]
struct Plan(String);

impl Plan {
    fn line(mut self, [x, y, u, v]: [f64; 4]) -> Self {
        write!(self.0, "0\nLINE\n8\nWALL\n10\n{x}\n20\n{y}\n11\n{u}\n21\n{v}\n").unwrap();
        self
    }

    fn ring(self, layer: &str, [x, y, u, v]: [f64; 4]) -> Self {
        self.outline(layer, &[[x, y], [u, y], [u, v], [x, v]])
    }

    fn outline(mut self, layer: &str, corners: &[[f64; 2]]) -> Self {
        write!(self.0, "0\nPOLYLINE\n8\n{layer}\n66\n1\n70\n1\n").unwrap();
        for [x, y] in corners {
            write!(self.0, "0\nVERTEX\n8\n{layer}\n10\n{x}\n20\n{y}\n").unwrap();
        }
        write!(self.0, "0\nSEQEND\n8\n{layer}\n").unwrap();
        self
    }

    fn mark(self, ring: [f64; 4], how: &str) -> Self {
        let mut out = self.ring("EF-MOVE", ring);
        let at = [f64::midpoint(ring[0], ring[2]), f64::midpoint(ring[1], ring[3])];
        write!(out.0, "0\nTEXT\n8\nEF-MOVE\n10\n{}\n20\n{}\n40\n0.2\n1\n{how}\n", at[0], at[1]).unwrap();
        out
    }

    /// A round of this drawing: its result.
    fn run(&self, more: &[&str]) -> Value {
        let folder = tempfile::tempdir().unwrap();
        let drawing = folder.path().join("plan.dxf");
        std::fs::write(&drawing, format!("0\nSECTION\n2\nENTITIES\n{}0\nENDSEC\n0\nEOF\n", self.0)).unwrap();
        let drawing = drawing.to_string_lossy().into_owned();
        let common = ["run", &drawing, "--unit", "m", "-q", "--spacing", "0.5"];
        let done =
            Command::new(env!("CARGO_BIN_EXE_enfilade")).args([&common[..], more].concat()).output().unwrap();
        let result = folder.path().join("plan.enfilade/round-01/result.json");
        let words = String::from_utf8_lossy(&done.stderr).into_owned();
        serde_json::from_slice(&std::fs::read(result).expect(&words)).unwrap()
    }
}

/// The texts of one code.
fn told(result: &Value, code: &str) -> Vec<String> {
    let problems = result["problems"].as_array().unwrap().iter().filter(|p| p["code"] == code);
    problems.map(|p| format!("{}", p)).collect()
}

/// Two screens in a hall, each above a column that it can hide.
fn columns(is_marked: bool) -> Plan {
    let mut plan = Plan::default().ring("WALL", [0.0, 0.0, 12.0, 8.0]);
    plan = plan.ring("WALL", [0.3, 0.3, 11.7, 7.7]);
    for x in [3.0, 8.0] {
        plan = plan.ring("COLUMN", [x - 0.2, 2.8, x + 0.2, 3.2]);
        let screen = [x - 0.8, 3.55, x + 0.8, 4.35];
        plan = plan.ring("WALL", screen);
        if is_marked {
            plan = plan.mark([x - 0.9, 3.5, x + 0.9, 4.4], "y -1.2 0.1");
        }
    }
    plan
}

/// A screen on a column hides it and opens the view: an option all the same only where that is allowed, and then told.
#[test]
fn a_screen_that_hides_a_column_is_told() {
    let allowed = "crossings, things, narrow-ways";
    let wish = ["--evaluations", "80", "--penalty", "none", "--allow", allowed];
    let result = columns(true).run(&wish);
    let hides = |o: &&Value| o["parameters"].as_array().unwrap().iter().any(|p| p.as_f64().unwrap() < -0.4);
    let options = result["candidates"].as_array().unwrap();
    assert!(options.iter().any(|o| hides(&o)), "{result}");
    for (i, option) in options.iter().enumerate() {
        let overlap = option["penalty"]["overlap"].as_f64().unwrap();
        assert_eq!(hides(&option), overlap > 0.02, "{option}");
        let of = format!("option {} runs it through plan.dxf:", i + 1);
        let told = told(&result, "options-overlap");
        assert_eq!(told.iter().any(|t| t.contains(&of) && t.contains("COLUMN")), overlap > 0.02, "{told:?}");
        // What the penalty counts is no depth.
        assert!(told.iter().all(|t| !t.contains(" m;") && t.contains("overlap <= 0")), "{told:?}");
    }
    let held = columns(true).run(&[&wish[..], &["--limit", "overlap <= 0"]].concat());
    assert!(held["candidates"].as_array().unwrap().iter().all(|o| !hides(&o)), "{held}");
    assert!(told(&held, "options-overlap").is_empty());
}

/// A partition between two walls, drawn face by face, its ends where they are.
fn partition(how: &[&str]) -> Plan {
    let faces = [
        [0.3, 0.3, 6.0, 0.3],
        [6.1, 0.3, 11.7, 0.3],
        [11.7, 0.3, 11.7, 7.7],
        [11.7, 7.7, 6.1, 7.7],
        [6.0, 7.7, 0.3, 7.7],
        [0.3, 7.7, 0.3, 0.3],
        [6.0, 0.3, 6.0, 7.7],
        [6.1, 0.3, 6.1, 7.7],
    ];
    let plan = Plan::default().ring("WALL", [0.0, 0.0, 12.0, 8.0]);
    let plan = faces.into_iter().fold(plan, Plan::line);
    how.iter().fold(plan, |plan, how| plan.mark([5.8, 0.2, 6.3, 7.8], how))
}

/// What the user asked for and nothing follows is no parameter: options differ in what moves.
#[test]
fn a_clause_that_moves_nothing_is_named() {
    let wish = ["--evaluations", "20"];
    let result = partition(&["x -1 1; y -1 1"]).run(&wish);
    let idle = told(&result, "move-idle");
    assert!(idle.len() == 1 && idle[0].contains("`y -1 m to 1 m` moves nothing: corners"), "{idle:?}");
    assert!(idle[0].contains("EF-MOVE") && !idle[0].contains("nothing moves here"), "{idle:?}");
    let kinds = |r: &Value| -> Vec<String> {
        r["moves"].as_array().unwrap().iter().map(|m| m["kind"].as_str().unwrap().into()).collect()
    };
    assert_eq!(kinds(&result), ["x"]);
    // A turn and a shift together move what the shift alone does not.
    let turned = partition(&["y -1 1; rotate -5 5"]).run(&wish);
    assert_eq!(kinds(&turned), ["y", "rotate"]);
    let none = partition(&["scale 0.8 1.2"]).run(&wish);
    let idle = told(&none, "move-idle");
    assert!(idle.len() == 1 && idle[0].contains("nothing moves here"), "{idle:?}");
    assert_eq!(none["candidates"], Value::Array(vec![]));
}

/// A corridor wall with a door of 1 m from x = 5 on, and a partition that meets it at x = 3.5.
fn corridor(mark: [f64; 4], how: &str) -> Plan {
    let walls = [[0.0, 4.0, 3.5, 4.0], [3.5, 4.0, 5.0, 4.0], [6.0, 4.0, 12.0, 4.0], [3.5, 0.0, 3.5, 4.0]];
    let mut plan = walls.into_iter().fold(Plan::default().ring("WALL", [0.0, 0.0, 12.0, 8.0]), Plan::line);
    write!(plan.0, "0\nARC\n8\nDOOR\n10\n5\n20\n4\n40\n1\n50\n0\n51\n90\n").unwrap();
    write!(plan.0, "0\nLINE\n8\nDOOR\n10\n5\n20\n4\n11\n5\n21\n5\n").unwrap();
    plan.mark(mark, how)
}

/// A joint stays 0.1 m before a door's jamb, and the mark gets a note; a jamb marked by itself narrows its door, and
/// every option that does says so.
#[test]
fn a_door_is_not_made_narrower_in_silence() {
    let wish = ["--evaluations", "40", "--objective", "degree min 0.5", "--raw"];
    let result = corridor([3.3, -0.1, 3.8, 4.1], "name part; x -1.5 1.8").run(&wish);
    let shorter = told(&result, "move-shortened");
    let says = ["less than 0.1 m of the wall #8", "`x -1.5 m to 1.4 m` alone", "EF-MOVE"];
    assert!(shorter.len() == 1 && says.iter().all(|s| shorter[0].contains(s)), "{shorter:?}");
    assert_eq!(result["moves"][0]["upper"].as_f64(), Some(1.4));
    assert!(told(&result, "options-door").is_empty());

    let result = corridor([4.9, 3.9, 5.1, 4.1], "name jamb; x 0 0.5").run(&wish);
    assert!(told(&result, "move-shortened").is_empty());
    let doors = told(&result, "options-door");
    let options = result["candidates"].as_array().unwrap();
    assert!(!options.is_empty());
    for (i, option) in options.iter().enumerate() {
        let left =
            format!("is left {:.2} m wide, it was 1.00 m", 1.0 - option["parameters"][0].as_f64().unwrap());
        let of = format!("option {}: the door at 5.5, 4 {left}", i + 1);
        assert!(doors.iter().any(|d| d.contains(&of)), "{of}: {doors:?}");
        assert!(option["words"].as_str().unwrap().contains(&left), "{option}");
    }
}

/// A way ends where nothing beyond can be built, and says what stands there; the word that permits it takes it on.
#[test]
fn a_way_ends_where_nothing_beyond_can_be_built() {
    let room = Plan::default().ring("WALL", [0.0, 0.0, 12.0, 8.0]).line([6.0, 2.0, 6.0, 6.0]);
    let plan = room.mark([5.8, 1.8, 6.2, 6.2], "x -5.8 5.8; name part");
    let result = plan.run(&["--evaluations", "20"]);
    let told_now = told(&result, "move-shortened");
    let says = ["`x -5.8 m to 5.8 m`", "less than 0.9 m between", "--allow narrow-ways"];
    assert!(told_now.len() == 1 && says.iter().all(|s| told_now[0].contains(s)), "{told_now:?}");
    let bounds = |r: &Value| ["lower", "upper"].map(|k| r["moves"][0][k].as_f64().unwrap());
    let [lower, upper] = bounds(&result);
    assert!((-5.1..-5.09).contains(&lower) && (5.09..=5.1).contains(&upper), "{lower} {upper}");
    let allowed = plan.run(&["--evaluations", "20", "--allow", "narrow-ways"]);
    assert_eq!(bounds(&allowed), [-5.8, 5.8]);
    assert!(told(&allowed, "move-shortened").is_empty());
}

/// A link of walls none of which moves does nothing, and is named.
#[test]
fn a_link_of_what_does_not_move_is_named() {
    let mut plan = Plan::default().ring("WALL", [0.0, 0.0, 20.0, 10.0]);
    for (x, how) in [(5.0, "x 0 0.0001; name a"), (10.0, "x 0 0.0001; name b"), (15.0, "x -1 1; name c")] {
        plan = plan.line([x, 2.0, x, 8.0]).mark([x - 0.2, 1.8, x + 0.2, 8.2], how);
    }
    let result = plan.run(&["--evaluations", "20", "--link", "same: a, b"]);
    let links = told(&result, "link-idle");
    assert!(
        links.len() == 1 && links[0].contains("link `same: a, b`: nothing that it names moves"),
        "{links:?}"
    );
    assert_eq!(result["moves"].as_array().unwrap().len(), 1);
}

/// A partition with a door of 0.9 m from y = 3.5 on, and a wall that ends at it 0.95 m south of the door.
fn door_beside_a_wall() -> Plan {
    let west = [[5.95, 4.4], [5.95, 5.8], [0.2, 5.8], [0.2, 2.55], [5.95, 2.55], [5.95, 3.5]];
    let east = [[6.05, 3.5], [6.05, 0.2], [11.8, 0.2], [11.8, 5.8], [6.05, 5.8], [6.05, 4.4]];
    let mut plan = Plan::default().ring("WALL", [0.0, 0.0, 12.0, 6.0]);
    plan = plan.outline("WALL", &[west, east].concat()).ring("WALL", [0.2, 0.2, 5.95, 2.45]);
    write!(plan.0, "0\nARC\n8\nDOOR\n10\n6\n20\n4.4\n40\n0.9\n50\n270\n51\n0\n").unwrap();
    write!(plan.0, "0\nLINE\n8\nDOOR\n10\n6\n20\n4.4\n11\n6.9\n21\n4.4\n").unwrap();
    plan
}

/// Where nothing is marked no option leaves a door narrower, whatever moves together: 0.1 m of the wall beside it stay.
#[test]
fn no_default_move_makes_a_door_narrower() {
    // As searched, so that the bounds alone keep the door.
    let result = door_beside_a_wall().run(&["--evaluations", "60", "--objective", "degree min 0.2", "--raw"]);
    let door = result["moves"].as_array().unwrap().iter().find(|m| m["name"] == "door-1").unwrap();
    assert!((door["lower"].as_f64().unwrap() + 0.25).abs() < 0.0015, "{door}");
    assert!(told(&result, "default-moves-doors").is_empty());
    assert!(!result["candidates"].as_array().unwrap().is_empty());
    assert!(told(&result, "options-door").is_empty());
}

/// A round of a sample of which no mark is left; `mark`: what its marks are called.
fn unmarked(name: &str, mark: &[u8]) -> Value {
    let folder = tempfile::tempdir().unwrap();
    let samples = enfilade_fixtures::repository("samples");
    let mut bytes = std::fs::read(samples.join(name)).unwrap();
    let places: Vec<usize> = (0..bytes.len()).filter(|i| bytes[*i..].starts_with(mark)).collect();
    assert!(!places.is_empty(), "{name} has marks");
    places.into_iter().for_each(|at| bytes[at..at + mark.len()].fill(b'U'));
    std::fs::write(folder.path().join(name), bytes).unwrap();
    let few = ["--evaluations", "8", "--members", "30", "--spacing", "0.8", "-q"];
    let mut run = Command::new(env!("CARGO_BIN_EXE_enfilade"));
    let done = run.arg("run").arg(folder.path().join(name)).args(few).output().unwrap();
    let stem = name.split('.').next().unwrap();
    let result = folder.path().join(format!("{stem}.enfilade/round-01/result.json"));
    let words = String::from_utf8_lossy(&done.stderr).into_owned();
    serde_json::from_slice(&std::fs::read(result).expect(&words)).unwrap()
}

/// What is said of moves is in the words of the user's own program.
#[test]
fn each_program_is_told_in_its_own_words() {
    for (name, mark, moves, keeps) in [
        ("office.dxf", "EF-MOVE", "EF-MOVE", "EF-KEEP"),
        ("pavilion.ifc", "Pset_Enfilade", "Pset_Enfilade", "Keep in Pset_Enfilade"),
        ("pavilion.glb", "enfilade", "extras.enfilade", "keep in extras.enfilade"),
    ] {
        let result = unmarked(name, mark.as_bytes());
        let by_default = told(&result, "default-moves");
        let says = format!("; {moves} says it better, {keeps} holds");
        assert!(by_default.iter().any(|t| t.contains(&says)), "{by_default:?}");
        let why = ["few-options", "options-left-out", "no-option", "no-move"]
            .map(|code| told(&result, code))
            .concat();
        assert!(why.iter().any(|t| t.contains(moves)), "{name}: {why:?}");
        let all = result["problems"].to_string();
        let is_of_layers = all.contains("EF-MOVE") || all.contains("EF-KEEP");
        assert!(name.ends_with("dxf") || !is_of_layers, "{all}");
    }
}

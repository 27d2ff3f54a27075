//! A desk with a drawing made here, and the program run on it.

// Every suite uses some of it.
#![allow(dead_code)]
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

/// An R12 drawing in metres, put together piece by piece.
#[derive(Clone, Default)]
pub struct Plan(pub String);

impl Plan {
    pub fn wall(mut self, [x, y, u, v]: [f64; 4]) -> Self {
        self.0.push_str(&format!("0\nLINE\n8\nWALL\n10\n{x}\n20\n{y}\n11\n{u}\n21\n{v}\n"));
        self
    }

    pub fn room(self, [x, y, u, v]: [f64; 4]) -> Self {
        self.wall([x, y, u, y]).wall([u, y, u, v]).wall([u, v, x, v]).wall([x, v, x, y])
    }

    pub fn ring(mut self, layer: &str, [x, y, u, v]: [f64; 4]) -> Self {
        self.0.push_str(&format!("0\nPOLYLINE\n8\n{layer}\n66\n1\n70\n1\n"));
        for [x, y] in [[x, y], [u, y], [u, v], [x, v]] {
            self.0.push_str(&format!("0\nVERTEX\n8\n{layer}\n10\n{x}\n20\n{y}\n"));
        }
        self.0.push_str(&format!("0\nSEQEND\n8\n{layer}\n"));
        self
    }

    /// A wall with a box round it that says how it moves.
    pub fn moving(self, wall: [f64; 4], how: &str) -> Self {
        let [x, y, u, v] = wall;
        let mut out =
            self.wall(wall).ring("EF-MOVE", [x.min(u) - 0.2, y.min(v) - 0.2, x.max(u) + 0.2, y.max(v) + 0.2]);
        let at = [f64::midpoint(x, u), f64::midpoint(y, v)];
        out.0.push_str(&format!("0\nTEXT\n8\nEF-MOVE\n10\n{}\n20\n{}\n40\n0.2\n1\n{how}\n", at[0], at[1]));
        out
    }

    pub fn text(&self) -> String {
        format!("0\nSECTION\n2\nENTITIES\n{}0\nENDSEC\n0\nEOF\n", self.0)
    }
}

/// A hall with three free-standing walls.
pub fn hall(how: [&str; 3]) -> Plan {
    let plan = Plan::default().room([0.0, 0.0, 20.0, 10.0]);
    let plan = plan.moving([5.0, 2.0, 5.0, 8.0], &format!("{}; name a", how[0]));
    let plan = plan.moving([10.0, 2.0, 10.0, 8.0], &format!("{}; name b", how[1]));
    plan.moving([15.0, 2.0, 15.0, 8.0], &format!("{}; name c", how[2]))
}

pub fn enfilade(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_enfilade")).args(args).output().unwrap()
}

pub fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

pub fn json(path: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

/// A folder with a drawing in it.
pub struct Desk {
    pub folder: tempfile::TempDir,
}

impl Desk {
    pub fn new(plan: &Plan) -> Self {
        let desk = Self { folder: tempfile::tempdir().unwrap() };
        desk.draw(plan);
        desk
    }

    pub fn draw(&self, plan: &Plan) {
        std::fs::write(self.drawing(), plan.text()).unwrap();
    }

    pub fn drawing(&self) -> PathBuf {
        self.folder.path().join("plan.dxf")
    }

    pub fn side_car(&self, toml: &str) {
        std::fs::write(self.folder.path().join("plan.enfilade.toml"), toml).unwrap();
    }

    pub fn call(&self, command: &str, more: &[&str]) -> Output {
        let drawing = self.drawing().to_string_lossy().into_owned();
        let spacing: &[&str] = if more.contains(&"--spacing") { &[] } else { &["--spacing", "0.5"] };
        enfilade(&[&[command, &drawing, "--unit", "m", "-q"], spacing, more].concat())
    }

    /// Runs a round; its folder.
    pub fn run(&self, round: u32, more: &[&str]) -> PathBuf {
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
pub fn walls(file: &Path) -> Vec<[f64; 4]> {
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
pub fn options(round: &Path) -> Vec<[[f64; 4]; 3]> {
    let result = json(&round.join("result.json"));
    let files = result["candidates"].as_array().unwrap().iter().map(|c| c["file"].as_str().unwrap());
    let found: Vec<_> = files.map(|f| walls(&round.join(f))).map(|w| [w[4], w[5], w[6]]).collect();
    assert!(!found.is_empty(), "{}", result["problems"]);
    found
}

pub fn is_multiple(value: f64, module: f64) -> bool {
    ((value / module).round() * module - value).abs() < 2e-6
}

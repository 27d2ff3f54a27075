//! The daemon left running: at rest with a thousand drawings, from a save to its job, many drawings at once.
//!
//! `cargo bench --bench daemon [-- idle | saves | drop | heavy]`; Linux, since processor time and memory are read from `/proc`.
//! `idle` takes about 11 GB in the temporary folder while it runs (`TMPDIR` names another), `drop` half of it.
//! Processor time is that of the daemon alone: jobs are processes of their own.

#![allow(clippy::unwrap_used, missing_docs)]

use std::fs;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{self, Receiver};
use std::thread;
use std::time::{Duration, Instant};

/// Drawings at rest, and the folders they lie in.
const IDLE: [usize; 2] = [1_000, 200];
/// Seconds at rest that are measured, after so many in which it comes to rest.
const IDLE_SECS: [u64; 2] = [30, 120];
/// Saves of one drawing.
const SAVES: usize = 20;
/// Drawings dropped at once.
const DROPPED: usize = 500;
/// Drawings at once, the heavy ones among them, and the lines of a heavy one.
const MIXED: [usize; 3] = [20, 3, 20_000];
/// Without a line of the daemon for so long the measurement ends.
const PATIENCE: Duration = Duration::from_secs(120);

fn main() {
    let asked: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    let is_asked = |name: &str| asked.is_empty() || asked.iter().any(|a| a == name);
    for (name, measure) in
        [("saves", saves as fn()), ("drop", drop_at_once), ("heavy", among_heavy), ("idle", idle)]
    {
        if is_asked(name) {
            measure();
        }
    }
}

/// A daemon in a folder of its own, and its lines with the moment at which each came.
struct Watched {
    root: tempfile::TempDir,
    child: Child,
    lines: Receiver<(Instant, String)>,
}

impl Watched {
    fn new(fill: impl FnOnce(&Path), options: &[&str]) -> Self {
        let root = tempfile::tempdir().unwrap();
        fill(root.path());
        let mut child = Command::new(env!("CARGO_BIN_EXE_enfilade"))
            .args(["watch", "--backend", "cpu", "--evaluations", "1"])
            .args(options)
            .arg(root.path())
            .env("HOME", root.path().join(".home"))
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let (send, lines) = mpsc::channel();
        let from = BufReader::new(child.stdout.take().unwrap());
        thread::spawn(move || {
            from.lines().map_while(Result::ok).try_for_each(|l| send.send((Instant::now(), l)))
        });
        let out = Self { root, child, lines };
        out.until(1, |l| l.starts_with("watching "));
        out
    }

    fn drawing(&self, name: &str) -> PathBuf {
        self.root.path().join(name)
    }

    /// When the last of `count` such lines came.
    fn until(&self, count: usize, is_such: impl Fn(&str) -> bool) -> Instant {
        let mut left = count;
        loop {
            let (when, line) = self.lines.recv_timeout(PATIENCE).unwrap();
            left -= usize::from(is_such(&line));
            if left == 0 {
                return when;
            }
        }
    }

    /// Resident memory, MB.
    fn resident_mb(&self) -> f64 {
        let status = fs::read_to_string(format!("/proc/{}/status", self.child.id())).unwrap();
        let line = status.lines().find(|l| l.starts_with("VmRSS:")).unwrap();
        line.split_whitespace().nth(1).unwrap().parse::<f64>().unwrap() * 1024.0 / 1e6
    }

    /// Processor time spent, seconds.
    fn spent_secs(&self) -> f64 {
        let stat = fs::read_to_string(format!("/proc/{}/stat", self.child.id())).unwrap();
        let fields: Vec<&str> = stat[stat.rfind(')').unwrap() + 2..].split_whitespace().collect();
        let ticks: f64 = [11, 12].iter().map(|i| fields[*i].parse::<f64>().unwrap()).sum();
        ticks / rustix::param::clock_ticks_per_second() as f64
    }
}

impl Drop for Watched {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn is_round(line: &str) -> bool {
    line.contains("/round-")
}

/// A hall of 8 by 6 m with a screen; each number another hall.
fn hall(number: usize) -> String {
    let far = 8.0 + 1e-3 * number as f64;
    let lines =
        [[0., 0., far, 0.], [far, 0., far, 6.], [far, 6., 0., 6.], [0., 6., 0., 0.], [3., 2., 3., 4.]];
    let line = |[x, y, u, v]: &[f64; 4]| format!("0\nLINE\n8\nA-WALL\n10\n{x}\n20\n{y}\n11\n{u}\n21\n{v}\n");
    let walls: String = lines.iter().map(line).collect();
    format!("0\nSECTION\n2\nENTITIES\n{walls}0\nENDSEC\n0\nEOF\n")
}

fn saves() {
    let watched = Watched::new(|root| fs::write(root.join("plan.dxf"), hall(0)).unwrap(), &[]);
    watched.until(1, is_round);
    let mut all: Vec<f64> = (1..=SAVES)
        .map(|n| {
            let saved = Instant::now();
            fs::write(watched.drawing("plan.dxf"), hall(n)).unwrap();
            let started = watched.until(1, |l| l.ends_with(" started"));
            watched.until(1, is_round);
            (started - saved).as_secs_f64()
        })
        .collect();
    all.sort_by(f64::total_cmp);
    println!(
        "save to start of job, {SAVES} saves: {:.3} to {:.3} s, median {:.3} s",
        all[0],
        all[SAVES - 1],
        all[SAVES / 2]
    );
}

fn drop_at_once() {
    let watched = Watched::new(|root| fs::create_dir(root.join("plans")).unwrap(), &["--depth", "1"]);
    let before = watched.resident_mb();
    let began = Instant::now();
    for n in 0..DROPPED {
        fs::write(watched.drawing(&format!("plans/{n}.dxf")), hall(n)).unwrap();
    }
    let first = DROPPED / 10;
    watched.until(first, is_round);
    let (early, mut most) = (watched.resident_mb(), 0.0_f64);
    let mut ended = began;
    for _ in first..DROPPED {
        ended = watched.until(1, is_round);
        most = most.max(watched.resident_mb());
    }
    println!(
        "{DROPPED} drawings at once: all done in {:.1} s; resident {before:.1} MB before, {early:.1} after {first}, {:.1} after all, {most:.1} at most",
        (ended - began).as_secs_f64(),
        watched.resident_mb()
    );
}

/// So many lines without any order: no building, and long to understand.
fn thicket(lines: usize) -> String {
    let mut state = 1u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as f64 / f64::from(1u32 << 31) * 100.0
    };
    let mut line =
        || format!("0\nLINE\n8\nA-WALL\n10\n{}\n20\n{}\n11\n{}\n21\n{}\n", next(), next(), next(), next());
    let walls: String = (0..lines).map(|_| line()).collect();
    format!("0\nSECTION\n2\nENTITIES\n{walls}0\nENDSEC\n0\nEOF\n")
}

/// How long small drawings take at once, and among heavy ones: about twice as long at most.
fn among_heavy() {
    let [all, heavy, lines] = MIXED;
    let of_small = |heavy: usize| {
        let watched = Watched::new(|root| fs::create_dir(root.join("plans")).unwrap(), &["--depth", "1"]);
        let began = Instant::now();
        for n in 0..heavy {
            fs::write(watched.drawing(&format!("plans/heavy-{n}.dxf")), thicket(lines)).unwrap();
        }
        for n in 0..all - MIXED[1] {
            fs::write(watched.drawing(&format!("plans/small-{n}.dxf")), hall(n)).unwrap();
        }
        let ended = watched.until(all - MIXED[1], |l| is_round(l) && l.contains("small-"));
        (ended - began).as_secs_f64()
    };
    let [alone, among] = [0, heavy].map(of_small);
    println!(
        "{} small drawings: {alone:.1} s alone, {among:.1} s among {heavy} of {lines} lines each",
        all - heavy
    );
}

fn idle() {
    let [drawings, folders] = IDLE;
    let fill = |root: &Path| {
        for n in 0..drawings {
            let folder = root.join(format!("{}", n % folders));
            fs::create_dir_all(&folder).unwrap();
            fs::write(folder.join(format!("{n}.dxf")), hall(n)).unwrap();
        }
    };
    let watched = Watched::new(fill, &["--depth", "2", "--page"]);
    watched.until(drawings, is_round);
    thread::sleep(Duration::from_secs(IDLE_SECS[0]));
    let (began, spent) = (Instant::now(), watched.spent_secs());
    thread::sleep(Duration::from_secs(IDLE_SECS[1]));
    let share = (watched.spent_secs() - spent) / began.elapsed().as_secs_f64();
    println!(
        "idle, {drawings} drawings in {folders} folders, {} s: {:.3} % of a core, {:.1} MB resident",
        IDLE_SECS[1],
        100.0 * share,
        watched.resident_mb()
    );
}

//! Thread-CPU time of one evaluation of each penalty on a maze with sliding doors.
//!
//! `cargo bench --bench penalties`

use std::hint::black_box;

use enfilade_penalties::clearance::RADIUS_M;
use enfilade_penalties::{Alignment, Clearance, Layout, Overlap, WallLength, WallPiece};
use glam::{DVec2, dvec2};
use rustix::time::{ClockId, clock_gettime};

const REPEATS: u32 = 20_000;

fn main() {
    for corridors in [7, 28] {
        let pieces = maze(corridors);
        let layout = Layout { pieces: &pieces };
        println!(
            "maze of {} walls, {} of which may move",
            pieces.len(),
            pieces.iter().filter(|p| p.is_moving).count()
        );
        let clearance = Clearance::new(&layout, RADIUS_M);
        row("clearance", || clearance.measure_m2(black_box(&layout)));
        let overlap = Overlap::new(&layout);
        row("overlap", || overlap.measure_m(black_box(&layout)));
        let alignment = Alignment::new(&layout);
        row("alignment", || alignment.measure_rad2(black_box(&layout)));
        let wall_length = WallLength::new(&layout);
        row("wall length", || wall_length.measure_m(black_box(&layout)));
    }
}

fn row(name: &str, work: impl Fn() -> f64) {
    let start = thread_secs();
    let sum: f64 = (0..REPEATS).map(|_| work()).sum();
    let micros = (thread_secs() - start) * 1e6 / f64::from(REPEATS);
    println!("  {name:<12}{micros:>8.2} µs  (value {:.6})", sum / f64::from(REPEATS));
}

fn thread_secs() -> f64 {
    let now = clock_gettime(ClockId::ThreadCPUTime);
    now.tv_sec as f64 + now.tv_nsec as f64 * 1e-9
}

/// Walls every 2.5 m in two halves, each with a door gap whose jambs stick out; some jambs come within a
/// metre of another wall.
fn maze(corridors: u32) -> Vec<WallPiece> {
    let mut nodes: Vec<DVec2> = vec![];
    let mut pieces = vec![];
    let mut wall = |a: DVec2, b: DVec2, is_moving: bool| {
        let nodes = [a, b].map(|p| {
            let known = nodes.iter().position(|&n| n == p);
            let number = known.unwrap_or_else(|| {
                nodes.push(p);
                nodes.len() - 1
            });
            number as u32
        });
        pieces.push(WallPiece { a, b, nodes, is_moving, solid: None, bar: None, body: None, half_m: 0.0 });
    };
    for row in 0..=corridors + 1 {
        let y = 2.5 * f64::from(row);
        for half in [0.0, 10.0] {
            if row == 0 || row > corridors {
                wall(dvec2(half, y), dvec2(half + 10.0, y), false);
                continue;
            }
            let jamb = half + 0.4 + 0.7 * f64::from((row * 5 + half as u32) % 10);
            for (jamb, end) in [(jamb, half), (jamb + 2.5, half + 10.0)] {
                wall(dvec2(end, y), dvec2(jamb, y), true);
                wall(dvec2(jamb, y - 0.25), dvec2(jamb, y), true);
                wall(dvec2(jamb, y), dvec2(jamb, y + 0.25), true);
            }
        }
        if row > 0 {
            for x in [0.0, 10.0, 20.0] {
                wall(dvec2(x, y - 2.5), dvec2(x, y), false);
            }
        }
    }
    pieces
}

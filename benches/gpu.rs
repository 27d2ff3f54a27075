//! The graphics card beside one core: all trees of a building, and populations of layouts.
//!
//! `cargo bench --bench gpu [-- software] [-- million]`. Processor milliseconds of the whole process and milliseconds by the
//! clock, the least of some runs, results compared with `==` first. Takes the graphics card, or with `software` whatever
//! adapter there is; says why where none answers. A software adapter imitates a card on the cores: its figures say nothing of
//! a card. With one, 10,000 to a million cells have all their roots, otherwise as many as the row says.

#![allow(clippy::expect_used)]

use std::sync::Arc;
use std::time::Instant;

use enfilade_engine::evaluator::Evaluator;
use enfilade_engine::forest::tally;
use enfilade_engine::geometry::Segment;
use enfilade_engine::gpu::Gpu;
use enfilade_engine::gpu::forest::CardForest;
use enfilade_engine::visibility::visibility_graph;
use enfilade_engine::{Lattice, Obstacles};
use rustix::time::{ClockId, clock_gettime};

/// Runs of which the least counts.
const RUNS: usize = 5;

fn main() {
    let asked = |what: &str| std::env::args().any(|a| a == what);
    let gpu = match Gpu::shared(asked("software")) {
        Ok(gpu) => gpu,
        Err(why) => return println!("nothing measured: {why}"),
    };
    println!("{}{}", gpu.name(), if gpu.is_software() { " (software)" } else { "" });
    for (side, room, layouts) in [(30, 10, 64), (50, 10, 64), (100, 10, 64), (99, 33, 64)] {
        let few = if side < 50 { 16 } else { 4 };
        population_row(&gpu, (side, room), if gpu.is_software() { few } else { layouts });
    }
    for (side, room, roots) in [(30, 5, 900), (100, 8, 1024), (99, 33, 1024), (316, 8, 256)] {
        forest_row(&gpu, (side, room), roots);
    }
    if asked("million") || !gpu.is_software() {
        forest_row(&gpu, (1000, 8), 64);
    }
}

/// Trees of all vertices of a plan as it stands, or with a software adapter of some.
fn forest_row(gpu: &Arc<Gpu>, (side, room): (i32, i32), roots: usize) {
    let (lattice, segments) = rooms(side, room);
    let mut lattice = (*lattice).clone();
    let n = lattice.cells.len();
    if gpu.is_software() {
        lattice.query.retain(|v| (*v as usize * roots) % n < roots);
    }
    let lattice = Arc::new(lattice);
    let obstacles = Obstacles { segments, blind: vec![] };
    let core = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    let graph = visibility_graph(&lattice, &obstacles);
    let runs = if n < 50_000 { RUNS } else { 1 };
    let on_core = least(runs, || core.install(|| tally(&lattice, &graph, None)));
    let expected = core.install(|| tally(&lattice, &graph, None));
    let started = Instant::now();
    let card =
        CardForest::new(Arc::clone(gpu), Arc::clone(&lattice), &graph, None, 1).expect("a plan that fits");
    let upload = millis(started);
    let unmoved = [Obstacles::default()];
    assert!(card.tallies(&unmoved).expect("the card") == [expected.clone()], "the card differs");
    let on_card = least(runs, || card.tallies(&unmoved).expect("the card"));
    println!(
        "trees: {n} vertices of mean degree {:.0}, {} roots, {} levels: card {on_card}, upload {upload:.1}; one core {on_core}",
        2.0 * graph.edge_count() as f64 / n as f64,
        lattice.query.len(),
        expected.depth.iter().max().unwrap_or(&0),
    );
}

/// A population over a plan, half of its vertices roots, 16 walls moving.
fn population_row(gpu: &Arc<Gpu>, (side, room): (i32, i32), layouts: u32) {
    let (lattice, mut fixed) = rooms(side, room);
    let mut lattice = (*lattice).clone();
    lattice.query.retain(|v| v % 2 == 0);
    let n = lattice.cells.len();
    let moving = fixed.split_off(fixed.len() - 16);
    let layout = |k: u32| {
        let shift = |(i, s): (usize, &Segment)| {
            let by = |axis: u32| {
                (i64::from(k) * 7_919_113 + i as i64 * 104_729 + i64::from(axis) * 15_485_863) % 900_001
            };
            s.shifted([by(0), by(1)])
        };
        Obstacles { segments: moving.iter().enumerate().map(shift).collect(), blind: vec![] }
    };
    let mut evaluator = Evaluator::new(Arc::new(lattice), &fixed, &layout(0), None);
    evaluator.attach(Arc::clone(gpu), &layout(0), layouts).expect("a plan that fits");
    let population: Vec<Obstacles> = (0..layouts).map(layout).collect();
    let mut scratch = evaluator.scratch();
    let mut all = || population.iter().map(|l| evaluator.evaluate(l, &mut scratch)).collect::<Vec<_>>();
    let expected = all();
    let on_core = least(RUNS, all).over(layouts);
    let card = || evaluator.evaluate_on_card(&population).expect("attached").expect("the card");
    assert!(card() == expected, "the card differs");
    let on_card = least(if n < 2_000 { RUNS } else { 2 }, card).over(layouts);
    println!("population of {layouts}, {n} vertices: a layout: card {on_card}; one core {on_core}");
}

/// Milliseconds of the process and by the clock.
struct Cost {
    processor: f64,
    clock: f64,
}

impl Cost {
    fn over(self, parts: u32) -> Self {
        Self { processor: self.processor / f64::from(parts), clock: self.clock / f64::from(parts) }
    }
}

impl std::fmt::Display for Cost {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:.3} ms ({:.3} of processor)", self.clock, self.processor)
    }
}

/// The least of some runs.
fn least<T>(runs: usize, mut work: impl FnMut() -> T) -> Cost {
    let processor = || {
        let t = clock_gettime(ClockId::ProcessCPUTime);
        t.tv_sec as f64 * 1e3 + t.tv_nsec as f64 / 1e6
    };
    let mut cost = Cost { processor: f64::INFINITY, clock: f64::INFINITY };
    for _ in 0..runs {
        let (before, started) = (processor(), Instant::now());
        std::hint::black_box(work());
        cost.clock = cost.clock.min(millis(started));
        cost.processor = cost.processor.min(processor() - before);
    }
    cost
}

fn millis(started: Instant) -> f64 {
    started.elapsed().as_secs_f64() * 1e3
}

/// Square rooms of `room` cells with a door to each side, on a square of `side` cells of a metre.
fn rooms(side: i32, room: i32) -> (Arc<Lattice>, Vec<Segment>) {
    const M: i64 = 1_000_000;
    let cells: Vec<[i32; 2]> = (0..side).flat_map(|c| (0..side).map(move |r| [c, r])).collect();
    let mut walls = Vec::new();
    for i in (room..side).step_by(room as usize) {
        let at = i64::from(i) * M - M / 2 + 3;
        for j in (0..side).step_by(room as usize) {
            let (from, to) = (i64::from(j) * M - M / 2, i64::from(j + room) * M - M / 2);
            let door = from + i64::from(room) * M * i64::from(1 + (i * 7 + j * 3) % 5) / 7;
            for (a, b) in [(from, door), (door + 3 * M / 2, to)] {
                walls.push(Segment { a: [at, a], b: [at, b] });
                walls.push(Segment { a: [a, at], b: [b, at] });
            }
        }
    }
    let n = cells.len() as u32;
    let (query, is_reference) = ((0..n).collect(), vec![true; n as usize]);
    (Arc::new(Lattice { spacing_um: M, origin_um: [0, 0], cells, query, is_reference, beyond: None }), walls)
}

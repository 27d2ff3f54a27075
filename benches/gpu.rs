//! The graphics card beside one core: the whole forest of a building, and populations of layouts.
//!
//! `cargo bench --bench gpu`. Wall-clock milliseconds, medians, results compared with `==` first. Takes
//! the graphics card, or with `-- software` whatever adapter there is; says why if there is none.

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

fn main() {
    let software = std::env::args().any(|a| a == "software");
    let gpu = match Gpu::shared(software) {
        Ok(gpu) => gpu,
        Err(why) => return println!("nothing measured: {why}"),
    };
    println!("{}{}", gpu.name(), if gpu.is_software() { " (software)" } else { "" });
    for (side, room) in [(30, 5), (50, 8), (100, 8), (99, 33)] {
        forest_row(&gpu, side, room);
    }
    for layouts in [1, 16, 64] {
        population_row(&gpu, layouts);
    }
}

/// Graph and level counts of all vertices.
fn forest_row(gpu: &Arc<Gpu>, side: i32, room: i32) {
    let (lattice, segments) = rooms(side, room);
    let obstacles = [Obstacles { segments, blind: vec![] }];
    let core = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    let started = Instant::now();
    let expected = core.install(|| tally(&lattice, &visibility_graph(&lattice, &obstacles[0]), None));
    let core_ms = millis(started);
    let card =
        CardForest::new(Arc::clone(gpu), Arc::clone(&lattice), &[], None, 1).expect("a plan that fits");
    assert_eq!(card.tallies(&obstacles).expect("the card"), std::slice::from_ref(&expected));
    let card_ms = median(|| card.tallies(&obstacles).expect("the card"));
    println!(
        "forest: {} vertices, {} walls, mean degree {:.0}: card {card_ms:.2} ms, one core {core_ms:.2} ms",
        lattice.cells.len(),
        obstacles[0].segments.len(),
        expected.degree_all.iter().map(|&d| f64::from(d)).sum::<f64>() / lattice.cells.len() as f64
    );
}

/// A population over a plan of about 900 vertices, half of them roots, 16 walls moving.
fn population_row(gpu: &Arc<Gpu>, layouts: u32) {
    let (lattice, mut fixed) = rooms(30, 10);
    let mut lattice = (*lattice).clone();
    lattice.query.retain(|v| v % 2 == 0);
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
    let started = Instant::now();
    let expected: Vec<_> = population.iter().map(|l| evaluator.evaluate(l, &mut scratch)).collect();
    let core_ms = millis(started) / f64::from(layouts);
    let on_card = || evaluator.evaluate_on_card(&population).expect("attached").expect("the card");
    assert_eq!(on_card(), expected);
    let card_ms = median(on_card) / f64::from(layouts);
    println!("population of {layouts}: card {card_ms:.4} ms an evaluation, one core {core_ms:.4} ms");
}

fn median<T>(work: impl Fn() -> T) -> f64 {
    let mut times: Vec<f64> = (0..7)
        .map(|_| {
            let started = Instant::now();
            std::hint::black_box(work());
            millis(started)
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times[3]
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

//! How much of twenty plans is understood, drawn in the styles of many offices.
//!
//! `cargo bench --bench understanding`; `-- N STYLE` shows the misses of one plan.

#![allow(clippy::unwrap_used, missing_docs)]

#[path = "../crates/plan/tests/reading/offices/mod.rs"]
mod offices;

use std::time::Instant;

use enfilade_plan::axes::{AxisGraph, Drawn, Face};
use offices::score::{Score, explain, has_right_unit, score};
use offices::styles::{LAYERS, Office, STYLES, Style, UNITS, draw, drawn};

fn main() {
    let words: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with("--")).collect();
    if let [n, style, rest @ ..] = words.as_slice() {
        return show(n.parse().unwrap(), style, !rest.is_empty());
    }
    println!(
        "{:<14} {:<6} {:>7} {:>7} {:>9} {:>10} {:>12} {:>7} {:>9}",
        "style", "noise", "nodes", "edges", "openings", "thickness", "degree off by", "unit", "ms/plan"
    );
    for style in STYLES {
        for noise in [false, true] {
            let mut sum = Score::default();
            let mut seconds = 0.0;
            let mut bad = Vec::new();
            let (mut units, mut right) = (0, 0);
            for (n, plan) in offices::plans::all().iter().enumerate() {
                let layers = n % LAYERS.len();
                let office = Office { layers, blocks: n % 2 == 1, ..Office::new(style, noise) };
                let input = drawn(&draw(plan, &office, n as u64), &office);
                let start = Instant::now();
                let graph = AxisGraph::new(&input);
                seconds += start.elapsed().as_secs_f64();
                for (unit_m, declared) in UNITS {
                    let office = Office { unit_m, declared, ..office };
                    units += 1;
                    right += usize::from(has_right_unit(&draw(plan, &office, n as u64), &office));
                }
                let s = score(plan, &graph, style != Style::CentreLines);
                if !s.holds() {
                    bad.push(n);
                }
                sum.add(s);
            }
            println!(
                "{:<14} {:<6} {:>7.3} {:>7.3} {:>9.3} {:>10.3} {:>11.2} % {:>4}/{} {:>9.2}  {:?}",
                format!("{style:?}"),
                noise,
                sum.nodes.f1(),
                sum.edges.f1(),
                sum.openings.f1(),
                sum.thickness.f1(),
                100.0 * sum.degree_error,
                right,
                units,
                50.0 * seconds,
                bad
            );
        }
    }
    large();
}

/// Time for a large drawing: the plans side by side until there are fifty thousand pieces.
fn large() {
    let office = Office::new(Style::Exploded, true);
    let mut all = Drawn::default();
    let mut copies = 0;
    while all.faces.len() < 50_000 {
        let mut plan = offices::plans::plan(copies % 20);
        let shift = glam::DVec2::new(60.0 * (copies % 15) as f64, 60.0 * (copies / 15) as f64);
        plan.nodes.iter_mut().for_each(|p| *p += shift);
        plan.columns.clear();
        let more = drawn(&draw(&plan, &office, copies), &office);
        let walls = all.faces.len() as u32;
        all.faces.extend(more.faces.into_iter().map(|f| Face { wall: f.wall + walls, ..f }));
        all.marks.extend(more.marks);
        copies += 1;
    }
    let start = Instant::now();
    let graph = AxisGraph::new(&all);
    println!(
        "{} pieces and {} marks: {:.0} ms, {} walls",
        all.faces.len(),
        all.marks.len(),
        1e3 * start.elapsed().as_secs_f64(),
        graph.edges.len()
    );
}

/// What was missed in one plan.
fn show(n: usize, style: &str, noise: bool) {
    let style = STYLES.into_iter().find(|s| format!("{s:?}") == style).unwrap();
    let plan = offices::plans::plan(n as u64);
    let office = Office { layers: n % LAYERS.len(), blocks: n % 2 == 1, ..Office::new(style, noise) };
    let input = drawn(&draw(&plan, &office, n as u64), &office);
    let graph = AxisGraph::new(&input);
    explain(&plan, &graph).iter().chain(&graph.statements).for_each(|l| println!("{l}"));
}

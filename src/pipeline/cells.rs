//! `analyse --cells` and `--edges`: every cell and every sight line as CSV.

use std::fmt::Write;

use super::study::Study;
use crate::analysis::measures::{columns, entropy_bits};
use crate::analysis::visibility::{Graph, visibility_graph};

/// depthmapX's `Ref`: `(column << 16) + row`, counted from the cell at or below the drawing's lower left
/// corner.
fn references(study: &Study) -> Vec<i64> {
    let lattice = &study.lattice;
    let corner = |k: usize| {
        let walls = study.base.plan.walls.iter().flat_map(|w| w.trace.points.iter());
        let lo = walls.map(|p| p[k]).min().unwrap_or(lattice.origin_um[k]);
        (lo - lattice.origin_um[k]).div_euclid(lattice.spacing_um)
    };
    let first = [corner(0), corner(1)];
    lattice
        .cells
        .iter()
        .map(|c| ((i64::from(c[0]) - first[0]) << 16) + (i64::from(c[1]) - first[1]))
        .collect()
}

/// One line a vertex: `Ref,x,y` (drawing units), depthmapX's columns, then Degree, Depth, Entropy (empty
/// outside the region of query). Values depthmapX leaves undefined are −1.
pub fn cells_csv(study: &Study, radius: Option<u32>) -> String {
    let graph = graph(study);
    let columns = columns(&study.lattice, &graph, radius);
    let mut own = vec![None; study.lattice.cells.len()];
    let tally = &study.initial.tally;
    let mut at = 0;
    for (i, v) in study.lattice.query.iter().enumerate() {
        let depth = tally.depth[i];
        let levels = &tally.levels[at..at + depth as usize];
        at += depth as usize;
        own[*v as usize] = Some((tally.degree[i], depth, entropy_bits(levels)));
    }
    let names: Vec<&str> = columns.iter().map(|c| c.name.as_str()).collect();
    let mut out = format!("Ref,x,y,{},Degree,Depth,Entropy\n", names.join(","));
    for (v, reference) in references(study).into_iter().enumerate() {
        let at = study.base.plan.frame.file_from_um(study.lattice.centre_um(v));
        let _ = write!(out, "{reference},{},{}", at.x, at.y);
        for column in &columns {
            let _ = write!(out, ",{}", column.values[v]);
        }
        let _ = match own[v] {
            Some((degree, depth, entropy)) => writeln!(out, ",{degree},{depth},{entropy}"),
            None => writeln!(out, ",,,"),
        };
    }
    out
}

/// `RefFrom,RefTo`, each pair once, sorted.
pub fn edges_csv(study: &Study) -> String {
    let graph = graph(study);
    let references = references(study);
    let mut out = String::from("RefFrom,RefTo\n");
    for v in 0..graph.len() as u32 {
        let mut later = Vec::new();
        graph.for_each_neighbour(v, |u| {
            if u > v {
                later.push(references[u as usize]);
            }
        });
        later.sort_unstable();
        for to in later {
            let _ = writeln!(out, "{},{to}", references[v as usize]);
        }
    }
    out
}

fn graph(study: &Study) -> Graph {
    visibility_graph(&study.lattice, &study.initial_obstacles())
}

//! `analyse --cells` and `--edges`: every cell and every sight line as CSV.

use std::fmt::Write;

use glam::DVec2;

use super::study::Study;
use crate::analysis::isovist::isovist_columns;
use crate::analysis::measures::{Column, entropy_bits, global_columns, local_columns, sampled_columns};
use crate::analysis::paths::{Paths, Turning};
use crate::analysis::through::through_vision_column;
use crate::analysis::visibility::{Graph, visibility_graph};
use crate::analysis::{Lattice, Obstacles};
use crate::report::{Error, Place};

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

/// What is measured per cell, beside Degree, Depth and Entropy.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CellOptions {
    /// Families (`graph`, `isovist`, `metric`, `angular`, `through`), `all`, or names of columns; empty:
    /// `graph`.
    pub measures: Vec<String>,
    /// Steps (graph), right angles (angular) and metres (metric) beyond which nothing counts.
    pub radius: Option<u32>,
    /// Estimate the measures of the breadth-first trees from this many roots.
    pub roots: Option<usize>,
    /// Points to measure step depth from, drawing units.
    pub step_from: Vec<[f64; 2]>,
    /// Draws the roots.
    pub seed: u64,
}

/// Families of columns, with how their columns' names begin; all others are of the graph.
const FAMILIES: [(&str, &str); 5] = [
    ("graph", ""),
    ("isovist", "isovist"),
    ("metric", "metric"),
    ("angular", "angular"),
    ("through", "through"),
];

fn family_of(column: &str) -> &'static str {
    let name = column.to_lowercase();
    FAMILIES[1..].iter().find(|(_, start)| name.starts_with(start)).map_or("graph", |f| f.0)
}

/// The columns asked for, depthmapX's names, values by vertex.
///
/// # Errors
/// [`Error::Usage`] for a measure that does not exist and a step point that no vertex is near.
pub fn measure_cells(study: &Study, options: &CellOptions) -> Result<Vec<Column>, Error> {
    let graph = graph(study);
    let asked = |family: &str| {
        let named = options.measures.iter().any(|m| {
            m.eq_ignore_ascii_case("all")
                || m.eq_ignore_ascii_case(family)
                || (FAMILIES.iter().all(|f| !m.eq_ignore_ascii_case(f.0)) && family_of(m) == family)
        });
        named || (options.measures.is_empty() && family == "graph")
    };
    let obstacles = study.initial_obstacles();
    let lattice = &study.lattice;
    let paths = || Paths::new(lattice, &graph, &obstacles, Turning::default());
    let all = all_columns((lattice, &graph, &obstacles), options, asked);
    let mut kept = chosen(all, &options.measures)?;
    if !options.step_from.is_empty() {
        let from: Result<Vec<u32>, Error> = options.step_from.iter().map(|p| vertex_at(study, *p)).collect();
        kept.extend(paths().step_columns(&from?));
    }
    Ok(kept)
}

/// The columns of the families asked for, all of them.
fn all_columns(
    (lattice, graph, obstacles): (&Lattice, &Graph, &Obstacles),
    options: &CellOptions,
    asked: impl Fn(&str) -> bool,
) -> Vec<Column> {
    let mut all = Vec::new();
    if asked("graph") {
        all.extend(local_columns(lattice, graph));
        all.extend(match options.roots {
            Some(roots) => sampled_columns(graph, roots, options.seed),
            None => global_columns(graph, options.radius),
        });
    }
    if asked("isovist") {
        all.extend(isovist_columns(lattice, obstacles));
    }
    let paths = || Paths::new(lattice, graph, obstacles, Turning::default());
    if asked("metric") {
        all.extend(paths().metric_columns(options.radius.map(f64::from)));
    }
    if asked("angular") {
        all.extend(paths().angular_columns(options.radius.map(f64::from)));
    }
    if asked("through") {
        all.push(through_vision_column(lattice, graph));
    }
    all
}

fn chosen(all: Vec<Column>, measures: &[String]) -> Result<Vec<Column>, Error> {
    let is_family =
        |m: &String| m.eq_ignore_ascii_case("all") || FAMILIES.iter().any(|f| m.eq_ignore_ascii_case(f.0));
    let fits = |column: &str, m: &String| {
        column.eq_ignore_ascii_case(m)
            || (column.len() > m.len()
                && column.is_char_boundary(m.len())
                && column[..m.len()].eq_ignore_ascii_case(m)
                && column[m.len()..].starts_with(" R"))
    };
    for m in measures.iter().filter(|m| !is_family(m)) {
        if !all.iter().any(|c| fits(&c.name, m)) {
            let names: Vec<&str> =
                all.iter().map(|c| c.name.as_str()).filter(|c| family_of(c) == family_of(m)).collect();
            let text = format!(
                "--measures: found {m:?}, expected all, graph, isovist, metric, angular, through or one of {}; \
                 nothing was done",
                names.join(", ")
            );
            return Err(Error::usage("measures", Place::default(), text));
        }
    }
    let wanted = |c: &Column| {
        measures.is_empty()
            || measures.iter().any(|m| {
                m.eq_ignore_ascii_case("all")
                    || m.eq_ignore_ascii_case(family_of(&c.name))
                    || fits(&c.name, m)
            })
    };
    Ok(all.into_iter().filter(wanted).collect())
}

/// The vertex whose cell holds a point of the drawing.
fn vertex_at(study: &Study, at: [f64; 2]) -> Result<u32, Error> {
    let um = study.base.plan.frame.um_from_file(DVec2::from(at));
    let lattice = &study.lattice;
    let half = lattice.spacing_um / 2 + 1;
    let inside = |&v: &usize| {
        let centre = lattice.centre_um(v);
        (centre[0] - um[0]).abs() <= half && (centre[1] - um[1]).abs() <= half
    };
    let found = (0..lattice.cells.len()).find(inside);
    found.map(|v| v as u32).ok_or_else(|| {
        let text = format!(
            "--step-from {},{}: no measured cell there (drawing units); nothing was done",
            at[0], at[1]
        );
        Error::usage("step-from", Place::file(&study.base.plan.file), text)
    })
}

/// One line a vertex: `Ref,x,y` (drawing units), the columns, then Degree, Depth, Entropy (empty
/// outside the region of query and under a wall that can move). Values depthmapX leaves undefined are −1.
pub fn cells_csv(study: &Study, columns: &[Column]) -> String {
    let mut own = vec![None; study.lattice.cells.len()];
    let tally = &study.initial.seen.tally;
    let mut at = 0;
    for (i, v) in study.lattice.query.iter().enumerate() {
        let depth = tally.depth[i];
        let levels = &tally.levels[at..at + depth as usize];
        at += depth as usize;
        if study.initial.seen.covered.binary_search(&(i as u32)).is_ok() {
            continue;
        }
        own[*v as usize] = Some((tally.degree[i], depth, entropy_bits(levels)));
    }
    let mut out = String::from("Ref,x,y,");
    for column in columns {
        let _ = write!(out, "{},", column.name);
    }
    out.push_str("Degree,Depth,Entropy\n");
    for (v, reference) in references(study).into_iter().enumerate() {
        let at = study.base.plan.frame.file_from_um(study.lattice.centre_um(v));
        let _ = write!(out, "{reference},{},{}", at.x, at.y);
        for column in columns {
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

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::overlay::glossary;
    use crate::plan::geometry::Segment;

    /// Every column that can be made has an entry in plain words, and every entry a column.
    #[test]
    fn every_measure_is_explained() {
        let cells: Vec<[i32; 2]> = (0..6).flat_map(|c| (0..4).map(move |r| [c, r])).collect();
        let lattice = Lattice {
            spacing_um: 1_000_000,
            origin_um: [0, 0],
            query: (0..cells.len() as u32).collect(),
            is_reference: vec![true; cells.len()],
            cells,
        };
        let wall = Segment { a: [2_500_000, -500_000], b: [2_500_000, 2_500_000] };
        let obstacles = Obstacles { segments: vec![wall], blind: vec![] };
        let graph = visibility_graph(&lattice, &obstacles);
        let mut names = vec!["Degree".to_string(), "Depth".into(), "Entropy".into()];
        for (radius, roots) in [(None, None), (Some(3), None), (None, Some(9))] {
            let options = CellOptions { radius, roots, ..CellOptions::default() };
            let columns = all_columns((&lattice, &graph, &obstacles), &options, |_| true);
            names.extend(columns.into_iter().map(|c| c.name));
        }
        let paths = Paths::new(&lattice, &graph, &obstacles, Turning::default());
        names.extend(paths.step_columns(&[0]).into_iter().map(|c| c.name));
        let explained: BTreeSet<&str> =
            names.iter().map(|n| glossary::entry_of(n).unwrap_or_else(|| panic!("{n}")).name).collect();
        assert_eq!(explained, glossary::ENTRIES.iter().map(|e| e.name).collect());
    }
}

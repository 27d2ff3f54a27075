//! `analyse --cells` and `--edges`: every cell and every sight line as CSV.

use std::fmt::Write;

use glam::DVec2;

use crate::measure::study::Study;
use enfilade_brief::{Measure, column_of};
use enfilade_engine::geometry::{PointUm, Segment, UM_PER_M, segments_touch};
use enfilade_engine::isovist::{isovist_columns, isovist_columns_from};
use enfilade_engine::measures::{
    Column, GLOBAL_NAMES, LOCAL_NAMES, UNDEFINED, entropy_bits, global_columns_beside, local_columns_of,
};
use enfilade_engine::path_columns::{angular_columns_from, metric_columns_from};
use enfilade_engine::paths::{Paths, Turning};
use enfilade_engine::sampled::{is_estimated, sampled_columns};
use enfilade_engine::through::{through_vision_column, through_vision_column_from};
use enfilade_engine::visibility::{Graph, visibility_graph};
use enfilade_engine::walked::{Walked, Wanted};
use enfilade_engine::{Lattice, Obstacles};
use enfilade_overlay::glossary;
use enfilade_overlay::result::Numbers;
use enfilade_report::{Error, Place, counted};

/// depthmapX's `Ref`: `(column << 16) + row`, counted from the cell nearest to the lower left corner of the walls,
/// of two equally near ones the lower (left).
pub(crate) fn references(study: &Study) -> Vec<i64> {
    let lattice = &study.lattice;
    let corner = |k: usize| {
        let walls = study.base.plan.walls.iter().flat_map(|w| w.trace.points.iter());
        let lo = walls.map(|p| p[k]).min().unwrap_or(lattice.origin_um[k]);
        nearest_cell(lo - lattice.origin_um[k], lattice.spacing_um)
    };
    let first = [corner(0), corner(1)];
    lattice
        .cells
        .iter()
        .map(|c| ((i64::from(c[0]) - first[0]) << 16) + (i64::from(c[1]) - first[1]))
        .collect()
}

/// The cell whose centre is nearest to a place, of two equally near ones the lower.
fn nearest_cell(at_um: i64, spacing_um: i64) -> i64 {
    -(spacing_um - 2 * at_um).div_euclid(2 * spacing_um)
}

/// What is measured per cell, beside Degree, Depth and Entropy.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CellOptions {
    /// Families (`graph` or `visual`, `isovist`, `metric`, `angular`, `through`), `all`, or names of columns; empty:
    /// `graph`.
    pub measures: Vec<String>,
    /// Steps (graph: a whole number), right angles (angular) and metres (metric) beyond which nothing counts.
    pub radius: Option<f64>,
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
    ("through", "sight lines"),
];

/// Another name of the graph's family, after how most of its columns begin.
const VISUAL: &str = "visual";

/// Columns that stand in every table.
const ALWAYS: [&str; 3] =
    [column_of(Measure::Degree), column_of(Measure::Depth), column_of(Measure::Entropy)];

fn family_of(column: &str) -> &'static str {
    let name = column.to_lowercase();
    FAMILIES[1..].iter().find(|(_, start)| name.starts_with(start)).map_or("graph", |f| f.0)
}

/// What was measured per cell.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Measured {
    /// depthmapX's names, values by vertex.
    pub columns: Vec<Column>,
    /// How many breadth-first trees their columns are estimated from; none: all.
    pub roots: Option<usize>,
}

impl Measured {
    /// Headline of a column's heat map.
    pub fn title(&self, column: &str) -> String {
        match self.roots.filter(|_| is_estimated(column)) {
            Some(roots) => format!("{column} (estimated from {})", counted(roots as u64, "root")),
            None => column.to_owned(),
        }
    }

    /// What a cell without a value is called in its legend.
    pub fn no_value(&self, column: &str) -> &'static str {
        match self.roots {
            Some(_) if is_estimated(column) => "no value: sees all roots at once, or nothing",
            _ => glossary::no_value(column),
        }
    }
}

/// The columns asked for.
///
/// # Errors
/// [`Error::Usage`] for a measure that does not exist, a radius of no whole steps and a step point that no vertex is near.
pub fn measure_cells(study: &Study, options: &CellOptions) -> Result<Measured, Error> {
    let options = &options.by_family();
    let graph = graph(study);
    let asked = |family: &str| options.asks_for(family);
    options.judge_radius()?;
    if options.roots.is_some() && asked("graph") && study.lattice.beyond.is_some() {
        let text = "--roots estimates trees of one storey, and --over-stairs counts on others too; leave one of them away; \
                    nothing was done";
        return Err(Error::usage("roots", Place::default(), text));
    }
    let obstacles = study.initial_obstacles();
    let lattice = &study.lattice;
    let paths = || Paths::new(lattice, &graph, &obstacles, Turning::default());
    let walked = study.walked();
    let trees = match walked {
        Some(walked) => (0..graph.len() as u32).map(|v| walked.trees.levels(v)).collect(),
        None if study.roots.is_none() => study.initial.seen.tally.trees(lattice),
        None => vec![None; graph.len()],
    };
    let mut measured = all_columns((lattice, &graph, &obstacles), (&trees, walked), options, asked);
    measured.columns = chosen(measured.columns, &options.measures)?;
    if !options.step_from.is_empty() {
        let from: Result<Vec<u32>, Error> =
            options.step_from.iter().map(|p| vertex_at(study, &obstacles, *p)).collect();
        measured.columns.extend(paths().step_columns(&from?));
    }
    leave_out(&mut measured.columns, &obstacles.blind);
    Ok(measured)
}

/// Measures asked for, with families by their first name.
fn by_family(measures: &[String]) -> Vec<String> {
    let name = |m: &String| if m.eq_ignore_ascii_case(VISUAL) { FAMILIES[0].0.to_owned() } else { m.clone() };
    measures.iter().map(name).collect()
}

/// Takes the values from vertices that a wall which may move covers: they are no floor.
fn leave_out(columns: &mut [Column], blind: &[u32]) {
    for column in columns {
        blind.iter().for_each(|v| column.values[*v as usize] = UNDEFINED);
    }
}

/// What a family has of one way to every cell: without a value where a cell reaches itself alone, since no way to
/// oneself is a mean, and the shortest of all.
fn of_ways(mut columns: Vec<Column>) -> Vec<Column> {
    let Some(count) = columns.iter().position(|c| c.name.contains(NODE_COUNT)) else { return columns };
    let is_alone: Vec<bool> = columns[count].values.iter().map(|n| *n <= 1.0).collect();
    for column in columns.iter_mut().filter(|c| !c.name.contains(NODE_COUNT)) {
        for (value, _) in column.values.iter_mut().zip(&is_alone).filter(|(_, is_alone)| **is_alone) {
            *value = UNDEFINED;
        }
    }
    columns
}

/// What every column that counts the cells of its family's means has in its name.
const NODE_COUNT: &str = "Node Count";

impl CellOptions {
    fn by_family(&self) -> Self {
        Self { measures: by_family(&self.measures), ..self.clone() }
    }

    /// Whether columns of a family are asked for; families have their first names.
    fn asks_for(&self, family: &str) -> bool {
        let named = self.measures.iter().any(|m| {
            m.eq_ignore_ascii_case("all")
                || m.eq_ignore_ascii_case(family)
                || (FAMILIES.iter().all(|f| !m.eq_ignore_ascii_case(f.0)) && family_of(m) == family)
        });
        named || (self.measures.is_empty() && family == "graph")
    }

    fn asks_for_trees(&self) -> bool {
        self.asks_for("graph") && !names_only(&self.measures, &LOCAL_NAMES)
    }

    fn judge_radius(&self) -> Result<(), Error> {
        let Some(radius) = self.radius.filter(|r| r.fract() != 0.0 && self.asks_for_trees()) else {
            return Ok(());
        };
        let text = format!(
            "--radius: found {radius}, expected a whole number: graph measures count steps (--measures metric or angular \
             takes metres or right angles, with decimals); nothing was done"
        );
        Err(Error::usage("radius", Place::default(), text))
    }

    /// What of them begins at every vertex by itself, and can be measured in parts.
    ///
    /// # Errors
    /// [`Error::Usage`] for a measure that does not exist and a radius of no whole steps.
    pub(crate) fn wanted(&self) -> Result<Wanted, Error> {
        let own = self.by_family();
        own.judge_radius()?;
        let all = enfilade_brief::columns().map(|c| Column { name: c.name.into(), values: Vec::new() });
        chosen(all.collect(), &own.measures)?;
        let way = |family: &str| own.asks_for(family).then_some(own.radius);
        Ok(Wanted {
            // Within a radius trees are small.
            every_tree: own.asks_for_trees() && own.radius.is_none(),
            metric: way("metric"),
            angular: way("angular"),
            isovists: own.asks_for("isovist"),
            through: own.asks_for("through"),
        })
    }
}

/// The columns of the families asked for, all of them; of what was walked elsewhere nothing is walked again, nor are
/// trees that are known, by vertex.
fn all_columns(
    (lattice, graph, obstacles): (&Lattice, &Graph, &Obstacles),
    (trees, walked): (&[Option<&[u32]>], Option<&Walked>),
    options: &CellOptions,
    asked: impl Fn(&str) -> bool,
) -> Measured {
    let (mut all, mut drawn) = (Vec::new(), None);
    if asked("graph") && !names_only(&options.measures, &GLOBAL_NAMES) {
        let are_named = names_only(&options.measures, &[LOCAL_NAMES.as_slice(), &GLOBAL_NAMES].concat());
        let named = |name: &str| options.measures.iter().any(|m| m.eq_ignore_ascii_case(name));
        all.extend(local_columns_of(lattice, graph, |name| !are_named || named(name)));
    }
    if asked("graph") && !names_only(&options.measures, &LOCAL_NAMES) {
        all.extend(match options.roots {
            Some(roots) => {
                let sampled = sampled_columns(graph, roots, options.seed);
                drawn = Some(sampled.roots);
                sampled.columns
            }
            // Whole, or it was refused.
            None => {
                let radius = options.radius.map(|r| r as u32);
                global_columns_beside(lattice, graph, |v| trees[v as usize], radius)
            }
        });
    }
    let radius = options.radius;
    if asked("isovist") {
        let known = walked.and_then(|w| w.isovists.as_ref()).map(|rows| isovist_columns_from(rows));
        all.extend(known.unwrap_or_else(|| isovist_columns(lattice, obstacles)));
    }
    let paths = || Paths::new(lattice, graph, obstacles, Turning::default());
    if asked("metric") {
        let known = walked.and_then(|w| w.metric.as_ref()).map(|rows| metric_columns_from(rows, radius));
        all.extend(of_ways(known.unwrap_or_else(|| paths().metric_columns(radius))));
    }
    if asked("angular") {
        let known = walked.and_then(|w| w.angular.as_ref()).map(|rows| angular_columns_from(rows, radius));
        all.extend(of_ways(known.unwrap_or_else(|| paths().angular_columns(radius))));
    }
    if asked("through") {
        let known = walked.and_then(|w| w.through.as_ref()).map(|counts| through_vision_column_from(counts));
        all.push(known.unwrap_or_else(|| through_vision_column(lattice, graph)));
    }
    Measured { columns: all, roots: drawn }
}

/// Whether all that is asked for of the graph are columns of some names: the others need not be made.
fn names_only(measures: &[String], names: &[&str]) -> bool {
    let mut of_graph = measures.iter().filter(|m| family_of(m) == "graph").peekable();
    of_graph.peek().is_some() && of_graph.all(|m| names.iter().any(|n| m.eq_ignore_ascii_case(n)))
}

fn chosen(all: Vec<Column>, measures: &[String]) -> Result<Vec<Column>, Error> {
    let is_family =
        |m: &String| m.eq_ignore_ascii_case("all") || FAMILIES.iter().any(|f| m.eq_ignore_ascii_case(f.0));
    for m in measures.iter().filter(|m| !is_family(m)) {
        if !all.iter().any(|c| fits(&c.name, m)) {
            let of_family: Vec<&str> = enfilade_brief::columns()
                .map(|c| c.name)
                .filter(|n| !n.contains("Step") && !ALWAYS.contains(n) && !n.ends_with("CI95"))
                .filter(|n| family_of(m) == "graph" || family_of(n) == family_of(m))
                .collect();
            let text = format!(
                "--measures: found {m:?}, expected all, graph (or visual), isovist, metric, angular, through or one of {}; \
                 nothing was done",
                of_family.join(", ")
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

/// Whether a column is of a measure: its own, within some radius, or the interval of its estimate.
fn fits(column: &str, measure: &str) -> bool {
    let Some((name, rest)) = column.split_at_checked(measure.len()) else { return false };
    let is_radius = || rest.strip_prefix(" R").is_some_and(|radius| radius.parse::<f64>().is_ok());
    name.eq_ignore_ascii_case(measure) && (rest.is_empty() || rest == " CI95" || is_radius())
}

/// How far from a step point its cell may be, spacings: as far as the cells beside the one that holds it.
const STEP_REACH: f64 = 1.5;

/// The nearest vertex that sees a point of the drawing.
fn vertex_at(study: &Study, obstacles: &Obstacles, at: [f64; 2]) -> Result<u32, Error> {
    let um = study.base.plan.frame.um_from_file(DVec2::from(at));
    let reach_um = study.lattice.spacing_um as f64 * STEP_REACH;
    seen_vertex(&study.lattice, obstacles, um, reach_um).map_err(|why| {
        let text = format!("--step-from {},{}: {why} (drawing units); nothing was done", at[0], at[1]);
        Error::usage("step-from", Place::file(&study.base.plan.file), text)
    })
}

/// The nearest vertex within reach to which nothing stands in the way; of several the first.
fn seen_vertex(
    lattice: &Lattice,
    obstacles: &Obstacles,
    um: PointUm,
    reach_um: f64,
) -> Result<u32, &'static str> {
    let distance_um = |v: u32| {
        let centre = lattice.centre_um(v as usize);
        (centre[0] as f64 - um[0] as f64).hypot(centre[1] as f64 - um[1] as f64)
    };
    let all = (0..lattice.cells.len() as u32).filter(|v| obstacles.blind.binary_search(v).is_err());
    let mut near: Vec<(f64, u32)> =
        all.map(|v| (distance_um(v), v)).filter(|(d, _)| *d <= reach_um).collect();
    if near.is_empty() {
        return Err("no measured cell there");
    }
    near.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    let is_free = |&(_, v): &(f64, u32)| {
        let way = Segment { a: um, b: lattice.centre_um(v as usize) };
        !obstacles.segments.iter().any(|s| segments_touch(way, *s))
    };
    let seen = near.into_iter().find(is_free).map(|(_, v)| v);
    seen.ok_or("no measured cell there without a wall between, expected a point that a cell beside it sees")
}

/// Means of columns over the region of query, without cells that have no value.
pub(crate) fn means(study: &Study, measured: &Measured) -> Numbers {
    let mean = |column: &Column| {
        let values = study.lattice.query.iter().map(|v| column.values[*v as usize]);
        let known: Vec<f64> = values.filter(|v| v.is_finite() && *v != UNDEFINED).collect();
        (!known.is_empty()).then(|| (column.name.clone(), known.iter().sum::<f64>() / known.len() as f64))
    };
    Numbers(measured.columns.iter().filter_map(mean).collect())
}

/// Every vertex but those that a wall which may move covers, with its values: a table by columns.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cells {
    /// Which vertices of the lattice they are, ascending.
    pub vertex: Vec<u32>,
    /// depthmapX's `Ref`.
    pub reference: Vec<i64>,
    /// Centres, whole micrometres, drawing frame.
    pub centre_um: Vec<PointUm>,
    /// The columns, then Degree, Depth, Entropy (not a number outside the region of query; Depth and Entropy also where
    /// no tree was walked because they are estimated). Values depthmapX leaves undefined are [`UNDEFINED`].
    pub columns: Vec<Column>,
}

impl Cells {
    /// The x and the y of every cell, by columns: metres of the drawing frame, or drawing units as `--cells` writes them.
    pub fn places(&self, study: &Study, in_metres: bool) -> [Vec<f64>; 2] {
        let frame = study.base.plan.frame;
        let at = |um: &PointUm| match in_metres {
            true => um.map(|v| v as f64 / UM_PER_M),
            false => frame.file_from_um(*um).to_array(),
        };
        let of = |k: usize| self.centre_um.iter().map(|um| at(um)[k]).collect();
        [of(0), of(1)]
    }

    /// Puts another value where a measure has none.
    pub fn undefined_as(&mut self, none: f64) {
        let values = self.columns.iter_mut().flat_map(|c| &mut c.values);
        values.filter(|v| **v == UNDEFINED).for_each(|v| *v = none);
    }
}

/// The table of the present layout with these columns, whose values are by vertex.
pub fn cells(study: &Study, mut columns: Vec<Column>) -> Cells {
    columns.extend(own_columns(study));
    let blind = study.initial_obstacles().blind;
    let is_floor = |v: u32| blind.binary_search(&v).is_err();
    let vertex: Vec<u32> = (0..study.lattice.cells.len() as u32).filter(|v| is_floor(*v)).collect();
    let mut reference = references(study);
    if !blind.is_empty() {
        for column in &mut columns {
            column.values = vertex.iter().map(|v| column.values[*v as usize]).collect();
        }
        reference = vertex.iter().map(|v| reference[*v as usize]).collect();
    }
    let centre_um = vertex.iter().map(|v| study.lattice.centre_um(*v as usize)).collect();
    Cells { vertex, reference, centre_um, columns }
}

/// Degree, Depth and Entropy by vertex.
fn own_columns(study: &Study) -> [Column; 3] {
    let mut own =
        ALWAYS.map(|name| Column { name: name.into(), values: vec![f64::NAN; study.lattice.cells.len()] });
    let tally = &study.initial.seen.tally;
    let places = study.initial.seen.estimated.as_ref().map(|e| &e.places);
    let mut at = 0;
    for (i, v) in study.lattice.query.iter().enumerate() {
        let depth = tally.depth[i];
        let levels = &tally.levels[at..at + depth as usize];
        at += depth as usize;
        if study.initial.seen.covered.binary_search(&(i as u32)).is_ok() {
            continue;
        }
        own[0].values[*v as usize] = f64::from(tally.degree[i]);
        if places.is_none_or(|p| p.binary_search(&(i as u32)).is_ok()) {
            own[1].values[*v as usize] = f64::from(depth);
            own[2].values[*v as usize] = entropy_bits(levels);
        }
    }
    own
}

/// One line a cell: `Ref,x,y` (drawing units) and the columns; Degree, Depth and Entropy empty where they are not known.
pub fn cells_csv(study: &Study, cells: &Cells) -> String {
    let mut out = String::from("Ref,x,y");
    for column in &cells.columns {
        let _ = write!(out, ",{}", column.name);
    }
    out.push('\n');
    let [xs, ys] = cells.places(study, false);
    for (row, reference) in cells.reference.iter().enumerate() {
        let _ = write!(out, "{reference},{},{}", xs[row], ys[row]);
        for (k, value) in cells.columns.iter().map(|c| c.values[row]).enumerate() {
            let is_empty = value.is_nan() && k + ALWAYS.len() >= cells.columns.len();
            let _ = if is_empty { write!(out, ",") } else { write!(out, ",{value}") };
        }
        out.push('\n');
    }
    out
}

/// Who sees whom among the rows of [`Cells`], as compressed sparse rows; nobody sees oneself.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Views {
    /// Where the entries of each row begin, and behind the last where they end.
    pub start: Vec<i64>,
    /// Rows that are seen, ascending within each row.
    pub seen: Vec<i32>,
}

/// The visibility graph of the present layout.
pub fn views(study: &Study, cells: &Cells) -> Views {
    let graph = graph(study);
    let mut row_of = vec![-1; graph.len()];
    cells.vertex.iter().zip(0..).for_each(|(v, row)| row_of[*v as usize] = row);
    let mut out = Views { start: vec![0], seen: Vec::with_capacity(2 * graph.edge_count() as usize) };
    for v in &cells.vertex {
        let from = out.seen.len();
        graph.for_each_neighbour(*v, |u| out.seen.push(row_of[u as usize]));
        out.seen[from..].sort_unstable();
        out.start.push(out.seen.len() as i64);
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

    /// Every column that can be made has an entry in plain words, and every entry a column.
    /// As depthmapX 0.8 counts, for plans that begin there.
    #[test]
    fn references_count_from_the_nearest_cell() {
        let cells =
            [(370, 1), (5_810, 12), (-7_610, -15), (-3_130, -6), (250, 0), (-250, -1), (750, 1), (0, 0)];
        for (at_mm, cell) in cells {
            assert_eq!(nearest_cell(at_mm * 1_000, 500_000), cell, "{at_mm} mm");
        }
    }

    #[test]
    fn every_measure_is_explained() {
        let cells: Vec<[i32; 2]> = (0..6).flat_map(|c| (0..4).map(move |r| [c, r])).collect();
        let lattice = Lattice {
            spacing_um: 1_000_000,
            origin_um: [0, 0],
            query: (0..cells.len() as u32).collect(),
            is_reference: vec![true; cells.len()],
            beyond: None,
            cells,
        };
        let wall = Segment { a: [2_500_000, -500_000], b: [2_500_000, 2_500_000] };
        let obstacles = Obstacles { segments: vec![wall], blind: vec![] };
        let graph = visibility_graph(&lattice, &obstacles);
        let mut names = vec!["Degree".to_string(), "Depth".into(), "Entropy".into()];
        for (radius, roots) in [(None, None), (Some(3.0), None), (None, Some(9))] {
            let options = CellOptions { radius, roots, ..CellOptions::default() };
            let made = all_columns(
                (&lattice, &graph, &obstacles),
                (&vec![None; graph.len()], None),
                &options,
                |_| true,
            );
            names.extend(made.columns.into_iter().map(|c| c.name));
        }
        let paths = Paths::new(&lattice, &graph, &obstacles, Turning::default());
        names.extend(paths.step_columns(&[0]).into_iter().map(|c| c.name));
        let explained: BTreeSet<&str> =
            names.iter().map(|n| glossary::entry_of(n).unwrap_or_else(|| panic!("{n}")).name).collect();
        assert_eq!(explained, enfilade_brief::columns().map(|c| c.name).collect());
    }

    /// A step point starts on its own side of a wall, beside cells if it is in none.
    #[test]
    fn a_step_point_takes_the_nearest_cell_that_sees_it() {
        let cells: Vec<[i32; 2]> = (0..4).flat_map(|c| (0..2).map(move |r| [c, r])).collect();
        let is_reference = vec![true; cells.len()];
        let lattice = Lattice {
            spacing_um: 1000,
            origin_um: [0, 0],
            query: vec![],
            beyond: None,
            is_reference,
            cells: cells.clone(),
        };
        let wall = Segment { a: [1400, -500], b: [1400, 1500] };
        let obstacles = Obstacles { segments: vec![wall], blind: vec![6] };
        let at = |p: PointUm| seen_vertex(&lattice, &obstacles, p, 1500.0).map(|v| cells[v as usize]);
        assert_eq!(at([1390, 100]), Ok([1, 0]));
        assert_eq!(at([1410, 100]), Ok([2, 0]), "the wall is between it and the cell that holds it");
        assert_eq!(at([-900, -900]), Ok([0, 0]), "in no cell, but beside one");
        assert_eq!(at([3300, 100]), Ok([3, 1]), "its own cell sees nothing");
        assert_eq!(at([9000, 0]), Err("no measured cell there"));
        assert!(at([1400, 0]).is_err_and(|why| why.contains("wall between")));
    }

    /// Naming a column that needs no trees spares them, and the other way round.
    #[test]
    fn only_what_is_named_is_made() {
        let only = |measures: &[&str], names: &[&str]| {
            names_only(&measures.iter().map(ToString::to_string).collect::<Vec<_>>(), names)
        };
        assert!(only(&["visual mean depth", "isovist"], &GLOBAL_NAMES));
        assert!(only(&["Connectivity"], &LOCAL_NAMES) && !only(&["Connectivity"], &GLOBAL_NAMES));
        for both in
            [&["graph"][..], &["all"], &[], &["Connectivity", "Visual Entropy"], &["foo"], &["metric"]]
        {
            assert!(!only(both, &GLOBAL_NAMES) && !only(both, &LOCAL_NAMES), "{both:?}");
        }
    }

    #[test]
    fn an_estimate_is_called_so_in_its_title() {
        let measured = Measured { roots: Some(20), ..Measured::default() };
        assert_eq!(measured.title("Visual Mean Depth"), "Visual Mean Depth (estimated from 20 roots)");
        assert_eq!(measured.title("Visual Node Count"), "Visual Node Count");
        assert_eq!(measured.title("Isovist Area"), "Isovist Area");
        assert!(measured.no_value("Visual Integration [HH]").contains("all roots at once"));
        assert_eq!(measured.no_value("Isovist Area"), glossary::no_value("Isovist Area"));
        assert_eq!(Measured::default().title("Visual Mean Depth"), "Visual Mean Depth");
    }

    /// A suffix of a radius is a number: "Visual" is not "Visual Relativised Entropy" within a radius.
    #[test]
    fn a_name_is_a_whole_name() {
        for m in ["Visual Node Count", "visual node count", "Visual Node Count R3"] {
            assert!(fits("Visual Node Count R3", m), "{m}");
        }
        assert!(fits("Metric Node Count R2.5", "metric node count"));
        for (column, m) in [
            ("Visual Relativised Entropy", "Visual"),
            ("Visual Node Count R3", "Visual Node"),
            ("Visual Mean Depth CI95", "Visual"),
            ("Metric Node Count", "ä"),
        ] {
            assert!(!fits(column, m), "{column} {m}");
        }
        assert_eq!(by_family(&["VISUAL".into(), "visual mean depth".into()]), ["graph", "visual mean depth"]);
    }

    /// Who is alone has no mean of ways, and what a wall covers has nothing at all; counts are counts.
    #[test]
    fn cells_without_others_are_not_the_best_of_all() {
        // The third column is walled in alone; the last cell is covered.
        let lattice = Lattice {
            spacing_um: 1_000_000,
            origin_um: [0, 0],
            cells: (0..4).map(|c| [c, 0]).collect(),
            beyond: None,
            query: (0..4).collect(),
            is_reference: vec![true; 4],
        };
        let wall = |x: i64| Segment { a: [x, -500_000], b: [x, 500_000] };
        let obstacles = Obstacles { segments: vec![wall(1_500_000), wall(2_500_000)], blind: vec![3] };
        let graph = visibility_graph(&lattice, &obstacles);
        let options =
            CellOptions { measures: vec!["metric".into(), "angular".into()], ..CellOptions::default() };
        let asked = |family: &str| family == "metric" || family == "angular";
        let mut columns = all_columns((&lattice, &graph, &obstacles), (&[], None), &options, asked).columns;
        leave_out(&mut columns, &obstacles.blind);
        assert_eq!(columns.len(), 7);
        for column in &columns {
            let is_count = column.name.contains(NODE_COUNT);
            assert!(column.values[0] >= 0.0 && column.values[1] >= 0.0, "{column:?}");
            assert_eq!(column.values[2], if is_count { 1.0 } else { UNDEFINED }, "{column:?}");
            assert_eq!(column.values[3], UNDEFINED, "{column:?}");
        }
    }

    #[test]
    fn intervals_go_with_what_they_are_of() {
        let column = |name: &str| Column { name: name.into(), values: vec![] };
        let all = || ["Visual Mean Depth", "Visual Mean Depth CI95", "Connectivity"].map(column).to_vec();
        let kept = chosen(all(), &["visual mean depth".into()]).unwrap();
        assert_eq!(kept.len(), 2);
        let Err(Error::Usage(refused)) = chosen(all(), &["foo".into()]) else { panic!("foo is measured") };
        for name in ["Visual Mean Depth", "Isovist Area", "Angular Mean Depth", "Sight Lines Through"] {
            assert!(refused.text.contains(name), "{}", refused.text);
        }
    }
}

//! The resolution study (spec 8; paper: Critical Resolution): the measures over a series of spacings, and
//! the coarsest spacing from which they no longer change.

use std::collections::BTreeMap;
use std::fmt::Write;

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde::{Deserialize, Serialize};

use crate::job::{Event, Input, Job, Outcome, Progress};
use crate::measure::known::Forest;
use crate::measure::study::Study;
use crate::measure::{estimate, spacing};
use crate::read;
use crate::storeys::together;
use crate::understand::understood;
use crate::understand::understood::Understood;
use crate::write::show;
use enfilade_config::Settings;
use enfilade_engine::lattice::floor_on_walls;
use enfilade_overlay::chart::{Panel, resolution_png};
use enfilade_overlay::heat_map::DEFAULT_SIDE_PX;
use enfilade_overlay::measure::{counts_cells, fixed, parts, plain_name, wording};
use enfilade_overlay::result::{self, Interval, ProblemEntry};
use enfilade_report::{Cancel, Error, OutFile, Place, Report, counted};

/// Value of the `schema` key.
pub const SCHEMA: &str = "enfilade.resolution/1";
/// Change, relative to the finest lattice, up to which a measure counts as unchanged.
pub const TOLERANCE: f64 = 0.03;
/// Layouts sampled where moves are given, as the paper has it.
pub const SAMPLES: usize = 10;
/// A lattice of fewer vertices than this says nothing.
const VERTICES_MIN: f64 = 30.0;
/// The finest lattice of the default series.
const VERTICES_MAX: f64 = 16_000.0;
/// Change of a measure between neighbouring spacings, relative, that is called a jump.
const JUMP: f64 = 0.15;

/// A floor that changes by more than this between two lattices explains what changes with it.
const FLOOR_CHANGE: f64 = 0.05;
/// Cells of the floor whose centres lie on walls: by how much their share must differ between two lattices to explain
/// what changes.
const LOST_CHANGE: f64 = 0.05;
/// What sets a lattice off walls that are drawn in whole centimetres, at any spacing in whole centimetres.
const ODD_CENTRE: &str = "--lattice-centre 0.137,0.083";
/// What the columns of the present layout are called.
const PRESENT: &str = "the drawing as it is";

/// What is studied.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Spacings, metres; empty: a series that suits the plan.
    pub spacings_m: Vec<f64>,
    /// See [`TOLERANCE`].
    pub tolerance: f64,
    /// See [`SAMPLES`].
    pub samples: usize,
}

/// One measure at one spacing over the sampled layouts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// Of the present layout.
    pub initial: f64,
    /// Mean over the sampled layouts (the present one where nothing moves).
    pub mean: f64,
    /// Standard deviation over the sampled layouts.
    pub deviation: f64,
}

/// One spacing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Metres.
    pub spacing_m: f64,
    /// Vertices of the lattice.
    pub vertices: usize,
    /// Areas of the present layout that no view joins, cells that see no other left out.
    pub areas: usize,
    /// Cells of the present layout's floor whose centres lie on a wall: they are not measured.
    #[serde(default)]
    pub on_walls: usize,
    /// Area seen from a vertex, m²: degree × spacing².
    pub visible_m2: Spread,
    /// Depth, steps.
    pub depth: Spread,
    /// Entropy, bits.
    pub entropy: Spread,
    /// Of the drawing as it is: means over eight lattices of this spacing, shifted, with their 95 % intervals, by the names that
    /// they have in `mean` of the other results.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub estimate: BTreeMap<String, Interval>,
}

/// `resolution.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ResolutionResult {
    /// [`SCHEMA`].
    pub schema: String,
    /// The drawing.
    pub input: result::Input,
    /// Coarsest spacing first.
    pub rows: Vec<Row>,
    /// The tolerance used.
    pub tolerance: f64,
    /// Layouts sampled; 0 where nothing moves.
    #[serde(default)]
    pub samples: usize,
    /// Coarsest spacing from which no measure changes by more than the tolerance; none where only the
    /// finest is left.
    pub critical_m: Option<f64>,
    /// Jumps between neighbouring spacings, in words, with what the lattice makes of the plan there.
    pub jumps: Vec<String>,
    /// What was left out or assumed.
    pub problems: Vec<ProblemEntry>,
}

/// Measures the present layout and samples of the moves over a series of spacings.
///
/// # Errors
/// What reading returns; [`Error::Usage`] for fewer than two usable spacings; [`Error::Stopped`].
pub fn resolution(
    input: &Input<'_>,
    settings: &Settings,
    options: &Options,
    show: &mut (dyn FnMut(Event) + Send),
    cancel: &Cancel,
) -> Result<Outcome<ResolutionResult>, Error> {
    let settings = &*crate::read::query::for_its_storey(input, settings)?;
    let mut report = Report::default();
    crate::read::state_unread(input, settings, &mut report);
    let base = understood(
        &read::drawing(input.file(), &input.bytes, settings, &mut report)?,
        settings,
        &mut report,
    )?;
    let floors = together::floors(Job { input, settings }, &base, &mut report)?;
    let series = series(&base, options, input.file())?;
    let samples = sampled(&base.moves.bounds(), options.samples, settings.seed);
    let plan = base.plan.clone();
    let mut rows = Vec::new();
    for (i, spacing_m) in series.iter().enumerate() {
        cancel.check()?;
        let progress = Progress {
            stage: format!("spacing {spacing_m} m"),
            done: i as u64,
            total: Some(series.len() as u64),
            ..Default::default()
        };
        show(Event::Progress(progress));
        let one = Settings { spacing_m: Some(*spacing_m), ..settings.clone() };
        let within = (base.clone(), floors.clone());
        match Study::from_roots(within, &one, Forest::Every, &mut Report::default()) {
            Ok(study) => rows
                .push(Row { estimate: estimate::at_spacing(&study, &one), ..row(&study, &samples, cancel)? }),
            Err(Error::Stopped) => return Err(Error::Stopped),
            Err(e) => report.warn(
                "spacing-skipped",
                Place::file(input.file()),
                format!("spacing {spacing_m} m: {e}"),
            ),
        }
    }
    let critical_m = critical(&rows, options.tolerance);
    let result = ResolutionResult {
        schema: SCHEMA.into(),
        input: show::input(&plan, input),
        tolerance: options.tolerance,
        samples: samples.len(),
        critical_m,
        jumps: jumps(&rows),
        problems: report.problems.iter().map(Into::into).collect(),
        rows,
    };
    let mut files = vec![
        OutFile::new("resolution.json", result::to_json(&result)?),
        OutFile::new("resolution.csv", csv(&result.rows)),
    ];
    if settings.pictures {
        files.push(OutFile::new("resolution.png", plot(&result)?));
    }
    Ok(Outcome { result, files, report })
}

/// The spacings studied, coarsest first.
fn series(base: &Understood, options: &Options, file: &str) -> Result<Vec<f64>, Error> {
    let area_m2 = spacing::area_m2(base);
    let usable = |s: f64| {
        let vertices = area_m2 / (s * s);
        (VERTICES_MIN..=VERTICES_MAX).contains(&vertices)
    };
    let mut out: Vec<f64> = if options.spacings_m.is_empty() {
        spacing::SERIES_M.iter().copied().filter(|s| usable(*s)).collect()
    } else {
        options.spacings_m.clone()
    };
    out.sort_by(|a, b| b.total_cmp(a));
    out.dedup();
    if out.len() < 2 {
        let text = format!(
            "resolution study: found {} for {area_m2:.0} m², expected at least 2; nothing was done; \
             name them with --spacings",
            counted(out.len() as u64, "usable spacing")
        );
        return Err(Error::usage("spacings", Place::file(file), text));
    }
    Ok(out)
}

/// Parameter vectors drawn evenly within the bounds; the same seed draws the same ones.
fn sampled(bounds: &[[f64; 2]], samples: usize, seed: u64) -> Vec<Vec<f64>> {
    if bounds.is_empty() {
        return Vec::new();
    }
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let mut one = || bounds.iter().map(|[lo, hi]| lo + (hi - lo) * rng.random::<f64>()).collect();
    (0..samples).map(|_| one()).collect()
}

fn row(study: &Study, samples: &[Vec<f64>], cancel: &Cancel) -> Result<Row, Error> {
    let cell_m2 = study.spacing_m * study.spacing_m;
    let numbers =
        |means: &enfilade_engine::measures::Means| [means.degree * cell_m2, means.depth, means.entropy];
    let initial = numbers(&study.initial.seen.means);
    let mut bench = study.bench();
    let mut found = Vec::new();
    for p in samples {
        cancel.check()?;
        found.push(numbers(&study.measure(p, &mut bench).seen.means));
    }
    if found.is_empty() {
        found.push(initial);
    }
    let spread = |k: usize| {
        let n = found.len() as f64;
        let mean = found.iter().map(|f| f[k]).sum::<f64>() / n;
        let deviation = (found.iter().map(|f| (f[k] - mean).powi(2)).sum::<f64>() / n).sqrt();
        Spread { initial: initial[k], mean, deviation }
    };
    Ok(Row {
        spacing_m: study.spacing_m,
        vertices: study.lattice.cells.len(),
        areas: study.cut_off().areas + 1,
        on_walls: floor_on_walls(&study.lattice, &study.initial_obstacles().segments),
        visible_m2: spread(0),
        depth: spread(1),
        entropy: spread(2),
        estimate: BTreeMap::new(),
    })
}

const NAMES: [&str; 3] = ["visible area", "depth", "entropy"];

impl Row {
    fn spreads(&self) -> [Spread; 3] {
        [self.visible_m2, self.depth, self.entropy]
    }
}

fn change(from: f64, to: f64) -> f64 {
    if from == to { 0.0 } else { (to - from).abs() / from.abs().max(to.abs()) }
}

/// The coarsest spacing all whose finer ones agree with the finest within the tolerance; at least one
/// finer spacing must have confirmed it.
fn critical(rows: &[Row], tolerance: f64) -> Option<f64> {
    let finest = rows.last()?.spreads();
    let agrees = |r: &&Row| {
        r.spreads()
            .iter()
            .zip(&finest)
            .all(|(a, b)| change(a.mean, b.mean) <= tolerance && change(a.initial, b.initial) <= tolerance)
    };
    let steady: Vec<&Row> = rows.iter().rev().take_while(agrees).collect();
    (steady.len() > 1).then(|| steady.last().map(|r| r.spacing_m)).flatten()
}

fn jumps(rows: &[Row]) -> Vec<String> {
    let mut out = Vec::new();
    for pair in rows.windows(2) {
        for (k, name) in NAMES.iter().enumerate() {
            let (a, b) = (pair[0].spreads()[k].initial, pair[1].spreads()[k].initial);
            if change(a, b) > JUMP {
                let [from, to] = [pair[0].spacing_m, pair[1].spacing_m];
                let why = why_it_jumps(&pair[0], &pair[1]);
                out.push(format!(
                    "{PRESENT}: {name} jumps from {a:.3} at {from} m to {b:.3} at {to} m: {why}"
                ));
            }
        }
    }
    out
}

/// What differs between two lattices of one plan, as far as it is known.
fn why_it_jumps(coarse: &Row, fine: &Row) -> String {
    let floor = |r: &Row| r.vertices as f64 * r.spacing_m * r.spacing_m;
    if coarse.areas != fine.areas {
        return format!(
            "what no view joins is {} at the coarser and {} at the finer: one of them misses a passage, or a wall",
            counted(coarse.areas as u64, "area"),
            counted(fine.areas as u64, "area")
        );
    }
    let lost = |r: &Row| r.on_walls as f64 / (r.vertices + r.on_walls).max(1) as f64;
    if (lost(coarse) - lost(fine)).abs() > LOST_CHANGE {
        let most = if lost(coarse) > lost(fine) { coarse } else { fine };
        return format!(
            "at {} m {} of the floor lie with their centres on walls and are not measured, a share of {:.0} % (at the \
             other spacing {:.0} %): lines of the lattice run along walls; {ODD_CENTRE} sets it off them",
            most.spacing_m,
            counted(most.on_walls as u64, "cell"),
            100.0 * lost(most),
            100.0 * lost(coarse).min(lost(fine))
        );
    }
    if change(floor(coarse), floor(fine)) > FLOOR_CHANGE {
        return format!(
            "the coarser lattice measures {:.1} m² of floor, the finer {:.1} m², since whole cells count",
            floor(coarse),
            floor(fine)
        );
    }
    "cells of the coarser one are wide beside what stands in the way".into()
}

fn plot(result: &ResolutionResult) -> Result<Vec<u8>, Error> {
    let legend = [PRESENT.to_owned(), format!("{}, with deviations", sampled_name(result.samples))];
    let has_samples = result.samples > 0;
    let legend = if has_samples { &legend[..] } else { &legend[..1] };
    resolution_png(&panels(&result.rows, has_samples), legend, result.critical_m, DEFAULT_SIDE_PX)
}

fn panels(rows: &[Row], has_samples: bool) -> Vec<Panel> {
    let names = ["Visible area (m²)", "Most steps (tree depth)", "Evenness (entropy, bits)"];
    let panel = |(k, name): (usize, &str)| {
        let points = || rows.iter().rev().map(|r| (r.spacing_m, r.spreads()[k]));
        Panel {
            name: name.into(),
            points: points().map(|(s, v)| [s, v.initial, 0.0]).collect(),
            sampled: points().filter(|_| has_samples).map(|(s, v)| [s, v.mean, v.deviation]).collect(),
        }
    };
    names.into_iter().enumerate().map(panel).collect()
}

fn sampled_name(samples: usize) -> String {
    match samples {
        1 => "1 layout moved at random".into(),
        n => format!("mean of {n} layouts moved at random"),
    }
}

/// The study in words, a line each: what it found of the drawing as it is, beside means over the sampled layouts.
pub fn words(result: &ResolutionResult) -> Vec<String> {
    const MEASURES: &str = "visible m²      depth    entropy";
    let measures = |v: [f64; 3]| format!("{:>10.2}  {:>9.3}  {:>9.4}", v[0], v[1], v[2]);
    let wide = MEASURES.chars().count();
    let sampled = sampled_name(result.samples);
    let has_samples = result.samples > 0;
    let row = |lattice: &str, present: &str, sampled: &str| {
        let beside = if has_samples { format!("    {sampled}") } else { String::new() };
        format!("{lattice:>20}   {present:wide$}{beside}").trim_end().to_owned()
    };
    let mut out = vec![row("", PRESENT, &sampled), row("spacing m   vertices", MEASURES, MEASURES)];
    for r in &result.rows {
        let [present, means] =
            [|s: Spread| s.initial, |s: Spread| s.mean].map(|of| measures(r.spreads().map(of)));
        out.push(row(&format!("{:>9}  {:>9}", r.spacing_m, r.vertices), &present, &means));
    }
    if result.rows.iter().any(|r| !r.estimate.is_empty()) {
        out.push("Means of the drawing as it is over eight shifted lattices, 95 %:".into());
        out.extend(result.rows.iter().filter_map(shifted_words));
    }
    out.extend(result.jumps.iter().cloned());
    let of = |and: &str| match has_samples {
        false => format!("of {PRESENT}"),
        true => format!("of {PRESENT} {and} the {sampled}"),
    };
    let percent = 100.0 * result.tolerance;
    out.push(match result.critical_m {
        Some(s) => format!(
            "from {s} m on, a finer lattice changes no measure {} by more than {percent} %",
            of("or of")
        ),
        None if result.rows.len() < 2 => {
            "fewer than two spacings could be studied: nothing was compared".into()
        }
        None => format!(
            "no spacing studied is fine enough: measures {} still change by more than {percent} %",
            of("or of")
        ),
    });
    out
}

/// `0.4 m: visibility 71.0 ± 0.6 m², steps 1.69 ± 0.01 steps`.
fn shifted_words(row: &Row) -> Option<String> {
    let cell_m2 = row.spacing_m * row.spacing_m;
    let one = |(key, of): (&String, &Interval)| {
        let times = if counts_cells(key) { cell_m2 } else { 1.0 };
        let half = (of.high - of.low) / 2.0 * times;
        let digits = (-half.max(1e-6).log10()).ceil().clamp(0.0, 4.0) as usize + 1;
        let unit = wording(parts(key).0).map_or("", |w| w.bare_unit());
        format!(
            "{} {} ± {} {unit}",
            plain_name(key).to_lowercase(),
            fixed(of.value * times, digits),
            fixed(half, digits)
        )
    };
    let told: Vec<String> = row.estimate.iter().map(one).collect();
    (!told.is_empty()).then(|| format!("{:>9} m: {}", row.spacing_m, told.join(", ")))
}

fn csv(rows: &[Row]) -> String {
    let mut out = String::from("spacing_m,vertices");
    for name in ["visible_m2", "depth", "entropy"] {
        let _ = write!(out, ",{name}_initial,{name}_mean,{name}_deviation");
    }
    out.push('\n');
    for r in rows {
        let _ = write!(out, "{},{}", r.spacing_m, r.vertices);
        for s in r.spreads() {
            let _ = write!(out, ",{},{},{}", s.initial, s.mean, s.deviation);
        }
        out.push('\n');
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(spacing_m: f64, depth: f64) -> Row {
        let spread = |v: f64| Spread { initial: v, mean: v, deviation: 0.0 };
        Row {
            spacing_m,
            vertices: (8.0 / spacing_m / spacing_m) as usize,
            areas: 1,
            on_walls: 0,
            visible_m2: spread(10.0),
            depth: spread(depth),
            entropy: spread(1.0),
            estimate: BTreeMap::new(),
        }
    }

    #[test]
    fn the_critical_spacing_is_the_coarsest_from_which_nothing_changes() {
        let rows = [at(2.0, 3.0), at(1.0, 2.03), at(0.5, 2.01), at(0.25, 2.0)];
        assert_eq!(critical(&rows, 0.02), Some(1.0));
        assert_eq!(critical(&rows, 0.001), None);
        assert_eq!(jumps(&rows).len(), 1);
        assert!(jumps(&rows)[0].ends_with("stands in the way"), "{:?}", jumps(&rows));
        // An agreement that a finer spacing breaks again is none.
        let rows = [at(2.0, 2.0), at(1.0, 3.0), at(0.5, 2.0), at(0.25, 2.0)];
        assert_eq!(critical(&rows, 0.02), Some(0.5));
    }

    #[test]
    fn a_jump_is_explained_by_what_the_lattices_make_of_the_plan() {
        let rows = [at(2.0, 3.0), Row { areas: 2, ..at(1.0, 2.0) }, Row { vertices: 100, ..at(0.5, 3.0) }];
        let [parted, joined] = [&jumps(&rows)[0], &jumps(&rows)[1]];
        assert!(parted.contains("1 area at the coarser and 2 areas at the finer"), "{parted}");
        assert!(joined.contains("2 areas at the coarser and 1 area at the finer"), "{joined}");
        let rows = [at(1.0, 3.0), Row { vertices: 100, ..at(0.5, 2.0) }];
        assert!(
            jumps(&rows)[0].contains("measures 8.0 m² of floor, the finer 25.0 m²"),
            "{:?}",
            jumps(&rows)
        );
    }

    /// Half the lines of one lattice run along walls: that, and not the width of its cells, is why.
    #[test]
    fn lines_of_a_lattice_along_walls_are_blamed_for_what_they_cost() {
        let rows = [at(1.0, 3.0), Row { on_walls: 16, ..at(0.5, 2.0) }, at(0.25, 3.0)];
        let found = jumps(&rows);
        for jump in &found {
            assert!(
                jump.contains("at 0.5 m 16 cells of the floor lie with their centres on walls"),
                "{jump}"
            );
            assert!(jump.contains("a share of 33 %") && jump.ends_with("sets it off them"), "{jump}");
            assert!(jump.contains("--lattice-centre"), "{jump}");
        }
        assert_eq!(found.len(), 2);
    }

    fn result(rows: Vec<Row>, samples: usize) -> ResolutionResult {
        let input = result::Input {
            path: "plan.dxf".into(),
            sha256: String::new(),
            content: String::new(),
            format: String::new(),
            unit: String::new(),
            unit_reason: String::new(),
            north_deg: 0.0,
        };
        ResolutionResult {
            schema: SCHEMA.into(),
            input,
            critical_m: critical(&rows, TOLERANCE),
            jumps: jumps(&rows),
            rows,
            tolerance: TOLERANCE,
            samples,
            problems: Vec::new(),
        }
    }

    /// The table has what the sentences below it speak of, and both say which layouts they mean.
    #[test]
    fn present_values_and_means_are_told_apart() {
        let row = |s: f64, depth: f64| {
            let depth = Spread { initial: depth, mean: depth + 2.0, deviation: 0.1 };
            Row { depth, ..at(s, 0.0) }
        };
        let rows = vec![row(2.0, 3.0), row(1.0, 2.0), row(0.5, 2.0)];
        let told = words(&result(rows.clone(), 10));
        assert_eq!(
            told[..3].iter().map(String::as_str).collect::<Vec<_>>(),
            [
                "                       the drawing as it is                mean of 10 layouts moved at random",
                "spacing m   vertices   visible m²      depth    entropy    visible m²      depth    entropy",
                "        2          2        10.00      3.000     1.0000         10.00      5.000     1.0000",
            ]
        );
        assert!(
            told[5].starts_with("the drawing as it is: depth jumps from 3.000 at 2 m to 2.000"),
            "{told:?}"
        );
        let last = told.last().unwrap();
        assert!(
            last.contains(
                "no measure of the drawing as it is or of the mean of 10 layouts moved at random by more"
            ),
            "{last}"
        );
        let still = words(&result(rows, 0));
        assert!(still[1].ends_with("entropy") && still[1].matches("depth").count() == 1, "{still:?}");
        assert!(!still.concat().contains("random"), "{still:?}");
    }

    #[test]
    fn the_same_seed_draws_the_same_layouts_within_bounds() {
        let bounds = [[-1.0, 2.0], [0.0, 0.5]];
        let drawn = sampled(&bounds, 10, 4);
        assert_eq!(drawn, sampled(&bounds, 10, 4));
        assert!(drawn.iter().all(|p| p.iter().zip(bounds).all(|(v, [lo, hi])| (lo..=hi).contains(v))));
        assert!(sampled(&[], 10, 4).is_empty());
    }
}

//! One job from bytes to files: the only place where the siblings meet.
//!
//! Bytes and settings in; files to write, progress and problems out. Clock, seed and stop request are
//! inputs; nothing here touches a disk.

pub mod accept;
mod confirm;
mod job;
mod measure;
mod read;
pub mod resolution;
mod round;
mod search;
mod storeys;
mod understand;
mod write;

use std::time::Instant;


use enfilade_cad::Opened;
use enfilade_config::{PairName, Settings};
use enfilade_engine::measures::{Column, UNDEFINED};
use enfilade_engine::sampled::AREA_ROOTS;
use enfilade_overlay::heat_map::DEFAULT_SIDE_PX;
use enfilade_overlay::result::{self, AnalysisResult, CheckResult};
use enfilade_overlay::{HeatMap, Palette, PlanPicture, Scale, check_png, glossary, heat_map_png};
use enfilade_report::{Cancel, Error, OutFile, Place, Report, counted};
pub use job::{Event, Input, Keep, Outcome, Progress, on_threads};
pub use measure::cells;
pub use measure::look::LatticeAt;
pub use measure::seen::Use;
pub use measure::study::Study;
use measure::{aims, backend, estimate};
pub use read::read_options;
use read::state_unread;
pub use understand::fits::moves_of;
use understand::sensed;
use understand::{understood, understood::Understood};
pub use write::geojson;
use write::{graph, reading, show};

/// What [`check_with`] makes besides its result.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Extras {
    /// `check.png`, and `storey-N/check.png` of the other storeys.
    pub picture: bool,
    /// `graph.json` and `graph.graphml`.
    pub graph: bool,
}

/// What the program understands, with picture and graph.
///
/// # Errors
/// As [`check_with`].
pub fn check(input: &Input<'_>, settings: &Settings) -> Result<Outcome<CheckResult>, Error> {
    check_with(input, settings, Extras { picture: true, graph: true })
}

/// `enfilade check`: what the program understands.
///
/// # Errors
/// [`Error::Input`] when the drawing cannot be read.
pub fn check_with(
    input: &Input<'_>,
    settings: &Settings,
    extras: Extras,
) -> Result<Outcome<CheckResult>, Error> {
    let settings = &*read::query::on_storey_of_query(input, settings)?;
    let mut report = Report::default();
    state_unread(input, settings, &mut report);
    let opened = Opened::new(input.file(), &input.bytes)?;
    let drawing = opened.read(&read::read_options(settings), &mut report)?;
    let base = understood(&drawing, settings, &mut report)?;
    let mut result = show::check(&base, &report);
    let sensed = sensed::Sensed::new(&base, settings);
    result.reading = Some(reading::reading(&base, &drawing, &sensed));
    let mut files = Vec::new();
    if extras.picture {
        files.push(OutFile::new("check.png", check_picture(&base, &sensed)?));
    }
    if extras.graph {
        let graph = graph::graph(&base, &sensed, &reading::names(&base, &sensed));
        files.push(OutFile::new("graph.json", result::to_json(&graph)?));
        files.push(OutFile::new("graph.graphml", graph.to_graphml()));
    }
    let drawn = extras.picture.then_some(&mut files);
    (result.building, result.storeys) = storeys::check(&opened, settings, &base, drawn, &mut report);
    Ok(Outcome { result, files, report })
}

fn check_picture(base: &Understood, sensed: &sensed::Sensed) -> Result<Vec<u8>, Error> {
    let picture = show::check_picture(base, sensed, &reading::names(base, sensed));
    check_png(&picture, &base.plan.file, &reading::headline(base, sensed).words(), DEFAULT_SIDE_PX)
}

/// `enfilade analyse`: measures the present layout; the files of `analysis/`.
///
/// # Errors
/// [`Error::Input`] when the drawing cannot be read or no cell is left; [`Error::Stopped`].
pub fn analyse(
    input: &Input<'_>,
    settings: &Settings,
    cancel: &Cancel,
) -> Result<(Outcome<AnalysisResult>, Study), Error> {
    analyse_from(input, settings, None, &mut || {}, cancel)
}

/// [`analyse`] with breadth-first trees of about so many roots: what is told of depth and entropy is estimated.
/// `understood` is called once the drawing is, before it is measured.
///
/// # Errors
/// As [`analyse`].
pub fn analyse_from(
    input: &Input<'_>,
    settings: &Settings,
    roots: Option<usize>,
    understood: &mut (dyn FnMut() + Send),
    cancel: &Cancel,
) -> Result<(Outcome<AnalysisResult>, Study), Error> {
    let settings = &*read::query::on_storey_of_query(input, settings)?;
    let (mut outcome, study) = analyse_storey(input, settings, roots, understood, cancel)?;
    if roots.is_none() {
        outcome.result.estimate = estimate::present(&study, settings);
        tell_anew(&mut outcome)?;
    }
    add_storeys(input, settings, &study, &mut outcome, cancel)?;
    Ok((outcome, study))
}

/// Measures the other storeys of a building; `true` where there are any.
fn add_storeys(
    input: &Input<'_>,
    settings: &Settings,
    study: &Study,
    outcome: &mut Outcome<AnalysisResult>,
    cancel: &Cancel,
) -> Result<bool, Error> {
    let Outcome { result, files, report } = outcome;
    result.storeys = storeys::analyse(input, settings, study, files, report, cancel)?;
    if outcome.result.storeys.is_empty() {
        return Ok(false);
    }
    tell_anew(outcome)?;
    Ok(true)
}

/// Writes the result of an analysis again, of which more is known now.
fn tell_anew(outcome: &mut Outcome<AnalysisResult>) -> Result<(), Error> {
    outcome.files.retain(|f| f.path.as_os_str() != "analysis.json");
    outcome.files.push(OutFile::new("analysis.json", result::to_json(&outcome.result)?));
    Ok(())
}

/// Adds the columns that were asked for to an analysis: their means and a heat map of each.
///
/// # Errors
/// Where a picture cannot be drawn.
pub fn add_columns(
    input: &Input<'_>,
    settings: &Settings,
    (study, measured): (&Study, &cells::Measured),
    outcome: &mut Outcome<AnalysisResult>,
) -> Result<(), Error> {
    outcome.files.extend(column_pictures(input, settings, study, measured)?);
    outcome.result.columns = cells::means(study, measured);
    tell_anew(outcome)
}

/// Measures the storey that the settings name, or the one with most walls.
fn analyse_storey(
    input: &Input<'_>,
    settings: &Settings,
    roots: Option<usize>,
    understood: &mut (dyn FnMut() + Send),
    cancel: &Cancel,
) -> Result<(Outcome<AnalysisResult>, Study), Error> {
    let (study, report) = measure_storey(input, settings, roots, understood, cancel)?;
    let outcome = analysis_of(input, settings, &study, report)?;
    Ok((outcome, study))
}

/// Reads a drawing and measures its present layout as [`analyse_from`] does, and draws nothing: for whoever asks for
/// values alone. Of a building with several storeys the one that is analysed.
///
/// # Errors
/// As [`analyse`].
pub fn measure(
    input: &Input<'_>,
    settings: &Settings,
    roots: Option<usize>,
    understood: &mut (dyn FnMut() + Send),
    cancel: &Cancel,
) -> Result<(Study, Report), Error> {
    measure_storey(input, &*read::query::on_storey_of_query(input, settings)?, roots, understood, cancel)
}

/// A study of the storey, and what there is to say of it.
fn measure_storey(
    input: &Input<'_>,
    settings: &Settings,
    roots: Option<usize>,
    understood: &mut (dyn FnMut() + Send),
    cancel: &Cancel,
) -> Result<(Study, Report), Error> {
    let mut report = Report::default();
    state_unread(input, settings, &mut report);
    let base = understand::understood(
        &read::drawing(input.file(), &input.bytes, settings, &mut report)?,
        settings,
        &mut report,
    )?;
    understood();
    cancel.check()?;
    let mut study = Study::from_roots(base, settings, roots, &mut report)?;
    match roots {
        None => backend::choose(&mut study, settings.backend, input, &mut report),
        Some(asked) => {
            backend::state_unused(settings.backend, input, &mut report);
            state_estimated(&study, asked, input, &mut report);
        }
    }
    state_cut_off(&study, input, &mut report);
    cancel.check()?;
    Ok((study, report))
}

/// The plan of a study as it is shown: strokes and regions, plan frame.
pub fn picture(study: &Study) -> PlanPicture {
    show::picture(&study.base)
}

fn state_estimated(study: &Study, asked: usize, input: &Input<'_>, report: &mut Report) {
    let Some(estimated) = &study.initial.seen.estimated else { return };
    let text = format!(
        "depth and entropy are estimated from {} ({asked} asked for; every area that no view joins to the rest has at \
         least {AREA_ROOTS}, or all its cells); no map of either was made: --measures graph shows estimates for every cell",
        counted(estimated.places.len() as u64, "root")
    );
    report.info("estimated", Place::file(input.file()), text);
}

fn state_cut_off(study: &Study, input: &Input<'_>, report: &mut Report) {
    let cut_off = study.cut_off();
    if cut_off.areas > 0 {
        let text = format!(
            "areas that no view joins to the largest one: {}, with {} in all; their measures are those of their own area. \
             Cells that see no other at all: {}; measures that need another cell are −1 there",
            cut_off.areas,
            counted(cut_off.cells as u64, "cell"),
            cut_off.alone
        );
        report.info("cut-off-areas", Place::file(input.file()), text);
    }
}

fn analysis_of(
    input: &Input<'_>,
    settings: &Settings,
    study: &Study,
    report: Report,
) -> Result<Outcome<AnalysisResult>, Error> {
    let result = analysis_result(input, study, &report);
    let picture = show::picture(&study.base);
    let mut files = vec![OutFile::new("analysis.json", result::to_json(&result)?)];
    let mut jobs = show::maps(study);
    jobs.retain(|m| m.measure.is_of_cells() && (study.roots.is_none() || !aims::is_of_trees(m.measure)));
    let pictures = rayon_map(&jobs, |m| {
        let values = show::values(study, &study.initial, *m, settings);
        let scale = Scale::of(values.iter().copied().filter(|v| v.is_finite()));
        let look = MapLook { title: m.title(), unit: m.unit(), scale, palette: show::palette(settings) };
        heat_map(study, &picture, (m.pair, &values), &look, &format!("{}, as drawn", input.file()))
    });
    for (m, png) in jobs.iter().zip(pictures) {
        files.push(OutFile::new(format!("{}.png", m.file()), png?));
    }
    let sensed = sensed::Sensed::new(&study.base, settings);
    files.push(OutFile::new("check.png", check_picture(&study.base, &sensed)?));
    Ok(Outcome { result, files, report })
}

fn analysis_result(input: &Input<'_>, study: &Study, report: &Report) -> AnalysisResult {
    AnalysisResult {
        schema: result::ANALYSIS_SCHEMA.into(),
        version: enfilade_config::VERSION.into(),
        input: show::input(&study.base.plan, input),
        spacing_m: study.spacing_m,
        lattice_centre: lattice_centre(study),
        counts: show::counts(study, study.edges),
        mean: show::mean_numbers(study, &study.initial),
        columns: Default::default(),
        estimated_from_roots: study.initial.seen.estimated.as_ref().map(|e| e.places.len() as u64),
        mean_ci95: show::mean_half_widths(study),
        estimate: Default::default(),
        penalty: show::penalty_numbers(&study.initial),
        storeys: Vec::new(),
        problems: report.problems.iter().map(Into::into).collect(),
    }
}

fn lattice_centre(study: &Study) -> [f64; 2] {
    study.lattice.origin_um.map(|v| v as f64 / 1e6)
}

/// How values become a heat map.
struct MapLook {
    title: String,
    unit: &'static str,
    scale: Scale,
    palette: Palette,
}

/// One heat map of a layout's values over the cells of a pair.
fn heat_map(
    study: &Study,
    picture: &PlanPicture,
    (pair, values): (Option<PairName>, &[f64]),
    look: &MapLook,
    subtitle: &str,
) -> Result<Vec<u8>, Error> {
    let map = HeatMap {
        picture,
        cells: &show::cells(study, pair, values),
        spacing_m: study.spacing_m,
        scale: look.scale,
        title: &look.title,
        subtitle,
        unit: look.unit,
        no_value: "not measured",
        palette: look.palette,
    };
    heat_map_png(&map, DEFAULT_SIDE_PX)
}

/// How a column is shown as a heat map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColumnLook {
    /// What one unit of it is; empty for plain numbers.
    pub unit: &'static str,
    /// Range of the colours.
    pub scale: Scale,
    /// Colours.
    pub palette: Palette,
}

/// How a column of this name and with these values is shown; directions have a full turn of colours.
pub fn column_look(name: &str, values: &[f64], settings: &Settings) -> ColumnLook {
    let unit = glossary::entry_of(name).map_or("", |e| e.unit);
    if unit == glossary::DEGREES {
        return ColumnLook { unit, scale: Scale { lo: 0.0, hi: 360.0 }, palette: Palette::Cyclic };
    }
    let known = values.iter().copied().filter(|v| *v != UNDEFINED);
    ColumnLook { unit, scale: Scale::of(known), palette: show::palette(settings) }
}

/// A heat map of each column over the present layout: files of `analysis/`, named after the columns.
///
/// # Errors
/// When a picture cannot be made.
fn column_pictures(
    input: &Input<'_>,
    settings: &Settings,
    study: &Study,
    measured: &cells::Measured,
) -> Result<Vec<OutFile>, Error> {
    let picture = show::picture(&study.base);
    let subtitle = format!("{}, as drawn", input.file());
    let one = |column: &Column| {
        let look = column_look(&column.name, &column.values, settings);
        let map = HeatMap {
            picture: &picture,
            scale: look.scale,
            cells: &show::column_cells(study, column),
            spacing_m: study.spacing_m,
            title: &measured.title(&column.name),
            subtitle: &subtitle,
            unit: look.unit,
            no_value: measured.no_value(&column.name),
            palette: look.palette,
        };
        Ok(OutFile::new(format!("{}.png", show::slug(&column.name)), heat_map_png(&map, DEFAULT_SIDE_PX)?))
    };
    rayon_map(&measured.columns, one).into_iter().collect()
}

fn rayon_map<A: Sync, B: Send>(items: &[A], f: impl Fn(&A) -> B + Sync + Send) -> Vec<B> {
    use rayon::prelude::*;
    items.par_iter().map(f).collect()
}

/// `enfilade run`: the whole job; the files of one round.
///
/// A stop request ends the job without a round; what was handed out as analysis stays.
///
/// # Errors
/// [`Error::Input`] when the drawing cannot be read or no cell is left; [`Error::Stopped`].
pub fn run(
    input: &Input<'_>,
    settings: &Settings,
    started: Instant,
    show: &mut (dyn FnMut(Event) + Send),
    cancel: &Cancel,
) -> Result<Outcome<result::RoundResult>, Error> {
    show(Event::Progress(Progress { stage: "read".into(), ..Default::default() }));
    let settings = &*read::query::on_storey_of_query(input, settings)?;
    let mut understood = || show(Event::Progress(Progress { stage: "measure".into(), ..Default::default() }));
    let (mut analysis, study) = analyse_storey(input, settings, None, &mut understood, cancel)?;
    show(Event::Analysis(analysis.files.clone()));
    if add_storeys(input, settings, &study, &mut analysis, cancel)? {
        show(Event::Analysis(analysis.files));
    }
    round::run(input, settings, &study, analysis.report, started, show, cancel)
}

//! The files of `analysis/`.

use rayon::prelude::*;

use crate::job::{Input, Job, Outcome};
use crate::measure::aims;
use crate::measure::study::Study;
use crate::storeys::together::over_stairs;
use crate::understand::rooms::rooms_with_kinds;
use crate::understand::sensed;
use crate::write::check_picture::check_picture;
use crate::write::heat_maps::{MapLook, heat_map};
use crate::write::maps;
use crate::write::show::{self, lattice_centre};
use enfilade_overlay::Scale;
use enfilade_overlay::result::{self, AnalysisResult};
use enfilade_report::{Error, OutFile, Report};

pub(crate) fn analysis_of(
    job: Job<'_>,
    study: &Study,
    report: Report,
) -> Result<Outcome<AnalysisResult>, Error> {
    let Job { input, settings } = job;
    let result = analysis_result(input, study, &report);
    let mut files = vec![OutFile::new("analysis.json", result::to_json(&result)?)];
    if settings.pictures {
        files.extend(pictures(job, study)?);
    }
    Ok(Outcome { result, files, report })
}

/// A heat map of every measure, and what was understood.
fn pictures(Job { input, settings }: Job<'_>, study: &Study) -> Result<Vec<OutFile>, Error> {
    let picture = show::picture(&study.base);
    let mut files = Vec::new();
    let mut jobs = maps::maps(study);
    jobs.retain(|m| m.measure.is_of_cells() && (study.roots.is_none() || !aims::is_of_trees(m.measure)));
    let pictures: Vec<_> = jobs
        .par_iter()
        .map(|m| {
            let values = maps::values(study, &study.initial, *m, settings);
            let scale = Scale::of(values.iter().copied().filter(|v| v.is_finite()));
            let look = MapLook { title: m.title(), unit: m.unit(), scale, palette: maps::palette(settings) };
            heat_map(study, &picture, (m.pair, &values), &look, &format!("{}, as drawn", input.file()))
        })
        .collect();
    for (m, png) in jobs.iter().zip(pictures) {
        files.push(OutFile::new(format!("{}.png", m.file()), png?));
    }
    let sensed = sensed::Sensed::new(&study.base, settings);
    files.push(OutFile::new(
        "check.png",
        check_picture(&study.base, &sensed, &rooms_with_kinds(&study.base, &sensed, settings)?)?,
    ));
    Ok(files)
}

pub(crate) fn analysis_result(input: &Input<'_>, study: &Study, report: &Report) -> AnalysisResult {
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
        over_stairs: over_stairs(study),
        storeys: Vec::new(),
        problems: report.problems.iter().map(Into::into).collect(),
    }
}

/// Writes the result of an analysis again, of which more is known now.
pub(crate) fn tell_anew(outcome: &mut Outcome<AnalysisResult>) -> Result<(), Error> {
    outcome.files.retain(|f| f.path.as_os_str() != "analysis.json");
    outcome.files.push(OutFile::new("analysis.json", result::to_json(&outcome.result)?));
    Ok(())
}

//! `analyse`: the present layout measured, of a building every storey.

use std::path::PathBuf;

use crate::job::{Input, Job, Outcome};
use crate::measure::known::{Forest, Known};
use crate::measure::study::Study;
use crate::measure::{cells, estimate};
use crate::storey::{analyse_storey, measure_storey};
use crate::write::analysis::tell_anew;
use crate::write::heat_maps::column_pictures;
use crate::{read, storeys};
use enfilade_config::Settings;
use enfilade_overlay::result::AnalysisResult;
use enfilade_report::{Cancel, Error, Report};

/// `enfilade analyse`: measures the present layout; the files of `analysis/`.
///
/// # Errors
/// [`Error::Input`] when the drawing cannot be read or no cell is left; [`Error::Stopped`].
pub fn analyse(
    input: &Input<'_>,
    settings: &Settings,
    cancel: &Cancel,
) -> Result<(Outcome<AnalysisResult>, Study), Error> {
    analyse_with(input, settings, Depth::default(), &mut || {}, cancel)
}

/// How thoroughly the present layout is measured.
#[derive(Clone, Copy, Debug)]
pub struct Depth<'a> {
    /// Breadth-first trees of about so many roots, from which depth and entropy are estimated; none: from every cell.
    pub roots: Option<usize>,
    /// Whether other lattices tell how sure the means are; not where they are estimated.
    pub intervals: bool,
    /// What was measured elsewhere in [parts](crate::parts), and is joined here.
    pub known: Option<&'a Known>,
}

impl Default for Depth<'_> {
    fn default() -> Self {
        Self { roots: None, intervals: true, known: None }
    }
}

impl<'a> Depth<'a> {
    fn forest(self) -> Forest<'a> {
        match (self.known, self.roots) {
            (Some(known), _) => Forest::Known(known),
            (None, Some(roots)) => Forest::Roots(roots),
            (None, None) => Forest::Every,
        }
    }
}

/// [`analyse`], as thoroughly as is asked. `understood` is called once the drawing is, before it is measured.
///
/// # Errors
/// As [`analyse`].
pub fn analyse_with(
    input: &Input<'_>,
    settings: &Settings,
    depth: Depth<'_>,
    understood: &mut (dyn FnMut() + Send),
    cancel: &Cancel,
) -> Result<(Outcome<AnalysisResult>, Study), Error> {
    let settings = &*read::query::for_its_storey(input, settings)?;
    let job = Job { input, settings };
    let forest = depth.forest();
    let (mut outcome, study) = analyse_storey(job, (forest, None), understood, cancel)?;
    if depth.intervals && forest.roots().is_none() {
        outcome.result.estimate = estimate::present(&study, settings);
        tell_anew(&mut outcome)?;
    }
    add_storeys(job, (&study, forest), &mut outcome, cancel)?;
    Ok((outcome, study))
}

/// Measures the other storeys of a building; `true` where there are any.
pub(crate) fn add_storeys(
    job: Job<'_>,
    (study, forest): (&Study, Forest<'_>),
    outcome: &mut Outcome<AnalysisResult>,
    cancel: &Cancel,
) -> Result<bool, Error> {
    let Outcome { result, files, report } = outcome;
    result.storeys = storeys::analyse(job, (study, forest), files, report, cancel)?;
    if outcome.result.storeys.is_empty() {
        return Ok(false);
    }
    tell_anew(outcome)?;
    Ok(true)
}

/// Adds the columns that were asked for to an analysis: their means and, where pictures are drawn, a heat map of each.
///
/// # Errors
/// Where a picture cannot be drawn.
pub fn add_columns(
    input: &Input<'_>,
    settings: &Settings,
    (study, measured): (&Study, &cells::Measured),
    outcome: &mut Outcome<AnalysisResult>,
) -> Result<(), Error> {
    if settings.pictures {
        // A measure that is an objective too has its picture.
        let there: Vec<PathBuf> = outcome.files.iter().map(|f| f.path.clone()).collect();
        let pictures = column_pictures(Job { input, settings }, study, measured)?;
        outcome.files.extend(pictures.into_iter().filter(|p| !there.contains(&p.path)));
    }
    outcome.result.columns = cells::means(study, measured);
    tell_anew(outcome)
}

/// Reads a drawing and measures its present layout as [`analyse_with`] does, and draws nothing: for whoever asks for
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
    let settings = &*read::query::for_its_storey(input, settings)?;
    let forest = Depth { roots, ..Depth::default() }.forest();
    measure_storey(Job { input, settings }, (forest, None), understood, cancel)
}

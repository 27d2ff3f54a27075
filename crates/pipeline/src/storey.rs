//! One storey from its bytes to its analysis.

use crate::job::{Job, Outcome};
use crate::measure::floors::Floors;
use crate::measure::known::Forest;
use crate::measure::study::Study;
use crate::read::{self, state_unread};
use crate::storeys::together;
use crate::write::analysis::analysis_of;
use crate::{measure, understand};
use enfilade_overlay::result::AnalysisResult;
use enfilade_report::{Cancel, Error, Report};

/// Measures the storey that the settings name, or the one with most walls; within its building, where that is known already.
pub(crate) fn analyse_storey(
    job: Job<'_>,
    (forest, floors): (Forest<'_>, Option<Floors>),
    understood: &mut (dyn FnMut() + Send),
    cancel: &Cancel,
) -> Result<(Outcome<AnalysisResult>, Study), Error> {
    let (study, report) = measure_storey(job, (forest, floors), understood, cancel)?;
    let outcome = analysis_of(job, &study, report)?;
    Ok((outcome, study))
}

/// A study of the storey, and what there is to say of it.
pub(crate) fn measure_storey(
    job: Job<'_>,
    (forest, floors): (Forest<'_>, Option<Floors>),
    understood: &mut (dyn FnMut() + Send),
    cancel: &Cancel,
) -> Result<(Study, Report), Error> {
    let mut report = Report::default();
    let Job { input, settings } = job;
    state_unread(input, settings, &mut report);
    let drawing = read::drawing(input.file(), &input.bytes, settings, &mut report)?;
    let base = understand::understood(&drawing, settings, &mut report)?;
    understood();
    cancel.check()?;
    let floors = match floors {
        Some(floors) => Some(floors),
        None => together::floors(job, &base, &mut report)?,
    };
    let study = measure::measure(job, (base, floors), forest, &mut report)?;
    together::state(&study, &mut report);
    cancel.check()?;
    Ok((study, report))
}

//! The third stage, from what is understood to a study: lattices laid, the present layout measured.

pub(crate) mod aims;
pub(crate) mod alike;
pub(crate) mod backend;
pub(crate) mod card;
pub mod cells;
pub(crate) mod estimate;
pub(crate) mod floors;
pub(crate) mod known;
pub(crate) mod lattices;
pub(crate) mod limits;
pub(crate) mod look;
pub(crate) mod measuring;
pub(crate) mod obstacles;
pub(crate) mod ruler;
pub(crate) mod seen;
pub(crate) mod spacing;
pub(crate) mod study;
pub(crate) mod worth;
pub(crate) mod written;

use crate::job::{Input, Job};
use crate::measure::floors::Floors;
use crate::measure::known::Forest;
use crate::measure::study::Study;
use crate::understand::understood::Understood;
use enfilade_engine::sampled::AREA_ROOTS;
use enfilade_report::{Error, Place, Report, counted};

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

/// A study of what is understood, within its building where steps are counted over the stairs, on the graphics card where
/// the settings ask for it; with the trees that are asked for.
///
/// # Errors
/// As [`Study::from_roots`].
pub(crate) fn measure(
    job: Job<'_>,
    base: (Understood, Option<Floors>),
    forest: Forest<'_>,
    report: &mut Report,
) -> Result<Study, Error> {
    let Job { input, settings } = job;
    let mut study = Study::from_roots(base, settings, forest, report)?;
    match forest {
        Forest::Nobody => return Ok(study),
        Forest::Every => backend::choose(&mut study, settings.backend, input, report),
        Forest::Roots(asked) => {
            backend::state_unused(settings.backend, input, report);
            state_estimated(&study, asked, input, report);
        }
        Forest::Known(_) => {}
    }
    state_cut_off(&study, input, report);
    Ok(study)
}

//! Works of the list made real: written, read again, measured from scratch.

use super::edits::{Written, beside, written};
use super::{Found, find};
use crate::analyse::measure;
use crate::job::{Input, Job};
use crate::read;
use enfilade_config::{Settings, WorkTable};
use enfilade_engine::Obstacles;
use enfilade_engine::visibility::visibility_graph;
use enfilade_plan::view_box;
use enfilade_report::{Cancel, Error, Place, Report};
use enfilade_works::counts::degrees;

/// A gain that differs by more from what was told is told of: more than the jambs of one opening hide.
const DIFFERS: f64 = 0.005;

/// Works of a drawing as they were made.
#[derive(Clone, Debug)]
pub struct MadeWorks {
    /// The drawing with them.
    pub bytes: Vec<u8>,
    /// Works that the drawing cannot hold, for the side-car of the new drawing.
    pub tables: Vec<WorkTable>,
    /// What they were said to bring together, a share of the visible area; of one alone what its list says.
    pub told: f64,
    /// What they bring, of the file read again, over the cells of the layout before.
    pub gain: f64,
    /// What there is to say.
    pub report: Report,
}

/// Makes works of the list by their numbers, all in one drawing.
///
/// # Errors
/// [`Error::Usage`] for a number that the list does not have; as [`measure`].
pub fn make_works(
    input: &Input<'_>,
    settings: &Settings,
    ids: &[usize],
    cancel: &Cancel,
) -> Result<MadeWorks, Error> {
    let (study, mut report) = measure(input, settings, None, &mut || {}, cancel)?;
    let Found { walls, listed, .. } = find(Job { input, settings }, &study, cancel)?;
    let mut drawing = read::drawing(input.file(), &input.bytes, settings, &mut Report::default())?;
    drawing = view_box::within(&drawing, settings.view.as_deref()).into_owned();
    let options = read::read_options(settings);
    let mut all = Written::default();
    let (mut told, mut segments) = (0.0, study.initial_obstacles().segments);
    for id in ids {
        let work = id.checked_sub(1).and_then(|i| listed.get(i)).ok_or_else(|| {
            let text = format!("--make {id}: the list has works 1 to {}; nothing was written", listed.len());
            Error::usage("work", Place::default(), text)
        })?;
        let mut one = written(&study.base, (&drawing, &input.bytes), &walls, work);
        if let Err(e) = enfilade_cad::patch(input.file(), &input.bytes, &options, &one.edits, &[]) {
            one = beside(&study.base.plan, &walls, work, e.to_string());
        }
        if let Some(why) = &one.why {
            let text = format!(
                "work {id} is written into the file of settings beside the new drawing, as a decided work: {why}"
            );
            report.info("work-decided", Place::file(input.file()), text);
        }
        let twice = one.edits.iter().find(|e| all.edits.iter().any(|o| o.record() == e.record()));
        if twice.is_some() {
            let text = format!("work {id} changes what another one changes; make one after the other");
            return Err(Error::usage("work", Place::default(), text));
        }
        all.edits.extend(one.edits);
        all.additions.extend(one.additions);
        all.tables.extend(one.tables);
        segments = work.change.apply(&segments);
    }
    let bytes = enfilade_cad::patch(input.file(), &input.bytes, &options, &all.edits, &all.additions)?;
    let cells = |segments| {
        let obstacles = Obstacles { segments, blind: study.initial_obstacles().blind };
        degrees(&study.lattice, &visibility_graph(&study.lattice, &obstacles)) as f64
    };
    let now = cells(study.initial_obstacles().segments).max(1.0);
    told += cells(segments) / now - 1.0;
    let mut works = settings.works.clone();
    works.extend(all.tables.iter().cloned());
    let again = Settings { works, ..settings.clone() };
    let new = Input::new(input.path, &bytes, input.round);
    let (then, _) = measure(&new, &again, None, &mut || {}, cancel)?;
    let gain = cells(then.initial_obstacles().segments) / now - 1.0;
    if (gain - told).abs() > DIFFERS {
        let text = format!(
            "the new drawing is read otherwise than the one before also where nothing was changed: visibility {:+.1} %, \
             told {:+.1} %; look at `check` of both",
            100.0 * gain,
            100.0 * told
        );
        report.warn("work-differs", Place::file(input.file()), text);
    }
    Ok(MadeWorks { bytes, tables: all.tables, told, gain, report })
}

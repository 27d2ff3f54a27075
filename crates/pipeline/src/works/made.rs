//! Works of the list made real: written, read again, measured from scratch.

use super::edits::{Written, beside, written};
use super::{Floor, listed};
use crate::analyse::measure;
use crate::job::Input;
use crate::measure::study::Study;
use crate::read;
use enfilade_config::{Settings, WorkTable};
use enfilade_engine::Obstacles;
use enfilade_engine::visibility::visibility_graph;
use enfilade_overlay::works::LEAST_SHOWN;
use enfilade_plan::view_box;
use enfilade_report::{Cancel, Error, Place, Report};
use enfilade_works::Work;
use enfilade_works::counts::degrees;

/// Works of a drawing as they were made.
#[derive(Clone, Debug)]
pub struct MadeWorks {
    /// The drawing with them.
    pub bytes: Vec<u8>,
    /// Works that the drawing cannot hold, for the side-car of the new drawing.
    pub tables: Vec<WorkTable>,
    /// What the list leads to expect of them together, a share of the visible area.
    pub expected: f64,
    /// What they bring, of the file read again, over the cells of the layout before.
    pub gain: f64,
    /// What there is to say.
    pub report: Report,
}

/// Makes works of the list by their numbers, all in one drawing.
///
/// # Errors
/// [`Error::Usage`] for a number that the list does not have, and for works that change the same entity; as [`measure`].
pub fn make_works(
    input: &Input<'_>,
    settings: &Settings,
    ids: &[usize],
    cancel: &Cancel,
) -> Result<MadeWorks, Error> {
    let (study, mut report) = measure(input, settings, None, &mut || {}, cancel)?;
    let floor = Floor::of(&study, settings)?;
    let found = floor.works(&study, cancel)?;
    let listed = listed(&found.works);
    let works = ids.iter().map(|id| {
        let work = id.checked_sub(1).and_then(|i| listed.get(i).copied());
        work.map(|work| (*id, work)).ok_or_else(|| {
            let text = format!("--make {id}: the list has works 1 to {}; nothing was written", listed.len());
            Error::usage("work", Place::default(), text)
        })
    });
    let works = works.collect::<Result<Vec<_>, _>>()?;
    let all = together((input, settings), (&study, &floor), &works, &mut report)?;
    let options = read::read_options(settings);
    let bytes = enfilade_cad::patch(input.file(), &input.bytes, &options, &all.edits, &all.additions)?;
    let again = Settings { works: [&settings.works[..], &all.tables].concat(), ..settings.clone() };
    let (then, _) = measure(&Input::new(input.path, &bytes, input.round), &again, None, &mut || {}, cancel)?;
    let now = floor.obstacles.segments.clone();
    let planned = works.iter().fold(now.clone(), |segments, (_, work)| work.change.apply(&segments));
    // Over the cells of the layout before.
    let sights = |segments| {
        let obstacles = Obstacles { segments, blind: floor.obstacles.blind.clone() };
        degrees(&study.lattice, &visibility_graph(&study.lattice, &obstacles)) as f64
    };
    let before = sights(now).max(1.0);
    let [expected, gain] =
        [planned, then.initial_obstacles().segments].map(|segments| sights(segments) / before - 1.0);
    if (gain - expected).abs() >= LEAST_SHOWN {
        let text = format!(
            "The program reads the new drawing differently also where nothing changed: visibility {:+.1} %, \
             expected {:+.1} %. Compare `check` of both.",
            100.0 * gain,
            100.0 * expected
        );
        report.warn("work-differs", Place::file(input.file()), text);
    }
    Ok(MadeWorks { bytes, tables: all.tables, expected, gain, report })
}

/// All works as one set of changes.
fn together(
    (input, settings): (&Input<'_>, &Settings),
    (study, floor): (&Study, &Floor),
    works: &[(usize, &Work)],
    report: &mut Report,
) -> Result<Written, Error> {
    let drawing = read::drawing(input.file(), &input.bytes, settings, &mut Report::default())?;
    // As it was understood: marks name its entities by their place.
    let drawing = view_box::within(&drawing, settings.view.as_deref());
    let options = read::read_options(settings);
    let mut all = Written::default();
    for (id, work) in works {
        let mut one = written(&study.base, (&drawing, &input.bytes), &floor.walls, work);
        if let Err(e) = enfilade_cad::patch(input.file(), &input.bytes, &options, &one.edits, &[]) {
            one = beside(&study.base, &floor.walls, work, e.to_string());
        }
        if let Some(why) = &one.why {
            let text = format!("The side-car of the new drawing decides work {id}: {why}.");
            report.info("work-decided", Place::file(input.file()), text);
        }
        if one.edits.iter().any(|e| all.edits.iter().any(|o| o.record() == e.record())) {
            let text = format!("work {id} changes the same entity as another one; make one after the other");
            return Err(Error::usage("work", Place::default(), text));
        }
        all.edits.extend(one.edits);
        all.additions.extend(one.additions);
        all.tables.extend(one.tables);
    }
    Ok(all)
}

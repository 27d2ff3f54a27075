//! `brief`: whether the present layout has what is asked of its rooms.

mod asked;
mod building;
mod marks;
pub(crate) mod told;

use crate::job::{Input, Outcome};
use crate::read::{self, state_unread};
use crate::understand::rooms::{Room, rooms_with_kinds};
use crate::understand::sensed::Sensed;
use crate::understand::understood;
use crate::understand::understood::Understood;
use crate::write::show;
use asked::asked;
use building::building;
use enfilade_config::Settings;
use enfilade_overlay::brief::{BriefResult, brief_png};
use enfilade_overlay::heat_map::DEFAULT_SIDE_PX;
use enfilade_report::{Cancel, Error, OutFile, Place, Report, counted};

/// Checks the brief of rooms on a drawing. Files: `brief.png`, where it is wanted.
///
/// # Errors
/// [`Error::Input`] when the drawing cannot be read; [`Error::Usage`] where nothing is asked, or a rule set is not there.
pub fn brief_of(
    input: &Input<'_>,
    settings: &Settings,
    has_picture: bool,
    cancel: &Cancel,
) -> Result<Outcome<BriefResult>, Error> {
    let settings = &*read::query::for_its_storey(input, settings)?;
    let mut report = Report::default();
    state_unread(input, settings, &mut report);
    let drawing = read::drawing(input.file(), &input.bytes, settings, &mut report)?;
    let base = understood(&drawing, settings, &mut report)?;
    cancel.check()?;
    let sensed = Sensed::new(&base, settings);
    let rooms = rooms_with_kinds(&base, &sensed, settings)?;
    let result = checked((&base, &sensed, &rooms), input, settings, &mut report)?.ok_or_else(|| {
        let text = "nothing is asked: expected --brief, [brief] in the settings, or marks in the drawing; nothing was done";
        Error::usage("brief-empty", Place::file(input.file()), text)
    })?;
    let mut files = Vec::new();
    if has_picture {
        let picture = show::check_picture(&base, &sensed, &rooms);
        let to_plan = |p: [f64; 2]| told::plan_from_metres(&base, p);
        files.push(OutFile::new("brief.png", brief_png(&picture, &result.items, &to_plan, DEFAULT_SIDE_PX)?));
    }
    Ok(Outcome { result, files, report })
}

/// The brief of a drawing that is understood; `None` where nothing is asked.
pub(crate) fn checked(
    (base, sensed, rooms): (&Understood, &Sensed, &[Room]),
    input: &Input<'_>,
    settings: &Settings,
    report: &mut Report,
) -> Result<Option<BriefResult>, Error> {
    let building = building(base, sensed, rooms);
    let mut asked = asked(base, settings, report)?;
    asked.extend(marks::of_marks(base));
    asked.extend(marks::of_wishes(base, &building));
    if asked.is_empty() {
        return Ok(None);
    }
    if building.rooms.is_empty() {
        let text = "No room was found, so no item of the brief can be told.";
        report.warn("brief-rooms", Place::file(&base.plan.file), text);
    }
    let answers = enfilade_demands::check(&building, &asked);
    let result = told::result(base, input, &building, &answers);
    let failed = result.items.iter().filter(|i| i.verdict == "fail" && i.weight == "limit").count();
    if failed > 0 {
        let text = format!("The present layout breaks {} of its brief.", counted(failed as u64, "limit"));
        report.info("brief-broken", Place::file(&base.plan.file), text);
    }
    Ok(Some(result))
}

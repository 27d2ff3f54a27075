//! `check`: what the program understands.

use crate::job::{Input, Outcome};
use crate::read::{self, state_unread};
use crate::storeys;
use crate::understand::rooms::{names, rooms_with_kinds};
use crate::understand::{sensed, understood};
use crate::write::{check_picture, graph, reading, show};
use enfilade_cad::Opened;
use enfilade_config::Settings;
use enfilade_overlay::result::{self, CheckResult};
use enfilade_report::{Error, OutFile, Report};

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
    let settings = &*read::query::for_its_storey(input, settings)?;
    let mut report = Report::default();
    state_unread(input, settings, &mut report);
    let opened = Opened::new(input.file(), &input.bytes)?;
    let mut drawing = opened.read(&read::read_options(settings), &mut report)?;
    read::works::add(&mut drawing, settings)?;
    read::state_unused_storey(input.file(), &input.bytes, settings, &mut report);
    let base = understood(&drawing, settings, &mut report)?;
    let sensed = sensed::Sensed::new(&base, settings);
    sensed.tell(input.file(), &mut report);
    let mut result = show::check(&base, &report);
    let rooms = rooms_with_kinds(&base, &sensed, settings)?;
    result.reading = Some(reading::reading(&base, &drawing, (&sensed, &rooms)));
    let mut files = Vec::new();
    if extras.picture {
        files.push(OutFile::new("check.png", check_picture::check_picture(&base, &sensed, &rooms)?));
    }
    if extras.graph {
        let graph = graph::graph(&base, &sensed, &names(&base, &sensed));
        files.push(OutFile::new("graph.json", result::to_json(&graph)?));
        files.push(OutFile::new("graph.graphml", graph.to_graphml()));
    }
    let drawn = extras.picture.then_some(&mut files);
    (result.building, result.storeys) = storeys::check(&opened, settings, &base, drawn, &mut report);
    Ok(Outcome { result, files, report })
}

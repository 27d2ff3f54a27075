//! The first stage, from bytes to a drawing.

pub(crate) mod query;
pub(crate) mod storey;
pub(crate) mod works;

use crate::job::Input;
use enfilade_cad::drawing::{Drawing, Format};
use enfilade_cad::ifc;
use enfilade_cad::layers::WallLayers;
use enfilade_cad::units::unit_by_name;
use enfilade_config::{Level, Settings};
use enfilade_report::{Error, Place, Report};

/// How the settings want a file read.
pub fn read_options(settings: &Settings) -> enfilade_cad::ReadOptions {
    let sight = if settings.level == Level::Knee { ifc::Sight::Knee } else { ifc::Sight::Eye };
    enfilade_cad::ReadOptions {
        accept_missing_eof: settings.accept_missing_eof,
        storey: settings.storey.clone(),
        sight,
        unit: settings.unit.as_deref().and_then(unit_by_name),
        is_by_user: !settings.wall_layers.is_empty(),
        is_glass_wall: is_glass_wall(settings),
        twin: settings.beside.twin.as_ref().map(|t| t.known(|bytes| ifc::inventory(bytes, None))),
        buffers: settings.beside.buffers.clone(),
        pictures: settings.beside.pictures.keys().cloned().collect(),
    }
}

/// Whether the user names curtain walls as walls.
fn is_glass_wall(settings: &Settings) -> bool {
    let layers = WallLayers::new(&settings.wall_layers).ok().filter(WallLayers::is_by_user);
    layers.is_some_and(|l| l.reason("IfcCurtainWall").is_some())
}

/// Reads a drawing, of a building the storey that the settings name, or the one with most walls.
///
/// # Errors
/// What [`enfilade_cad::read`] returns.
pub(crate) fn drawing(
    file: &str,
    bytes: &[u8],
    settings: &Settings,
    report: &mut Report,
) -> Result<Drawing, Error> {
    let mut drawing = enfilade_cad::read(file, bytes, &read_options(settings), report)?;
    works::add(&mut drawing, settings)?;
    state_unused_storey(file, bytes, settings, report);
    Ok(drawing)
}

/// Says where a storey was asked for that the drawing has no other than.
pub(crate) fn state_unused_storey(file: &str, bytes: &[u8], settings: &Settings, report: &mut Report) {
    let Some(storey) = &settings.storey else { return };
    let is_dxf = enfilade_cad::format_of(file, bytes) == Format::Dxf;
    if is_dxf && enfilade_cad::storeys(file, bytes, &read_options(settings)).is_empty() {
        let text = format!(
            "storey {storey:?} was asked for, but this DXF has no storeys at heights of their own; all of it is read"
        );
        report.warn("storey-unused", Place::file(file), text);
    }
}

/// Says what lies beside the drawing, was meant as its settings, and is not read; and which storey was taken for the
/// settings.
pub(crate) fn state_unread(input: &Input<'_>, settings: &Settings, report: &mut Report) {
    if let Some(why) = &settings.tables_left {
        report.info("storey-tables", Place::file(input.file()), why.clone());
    }
    if let Some(why) = &settings.storey_taken {
        report.info("storey-of-query", Place::file(input.file()), why.as_str());
    }
    for (found, right) in &settings.unread {
        let text = format!(
            "{found} lies beside it and is not read: settings of this drawing are read from a file named {right}; \
             rename it"
        );
        report.warn("side-car-name", Place::file(input.file()), text);
    }
}

//! Heat maps of a layout.

use rayon::prelude::*;

use crate::job::Job;
use crate::measure::cells;
use crate::measure::study::Study;
use crate::write::{maps, show};
use enfilade_config::{PairName, Settings};
use enfilade_engine::measures::{Column, UNDEFINED};
use enfilade_overlay::heat_map::DEFAULT_SIDE_PX;
use enfilade_overlay::picture::PlanPicture;
use enfilade_overlay::{HeatMap, Palette, Scale, glossary, heat_map_png};
use enfilade_report::{Error, OutFile};

/// How values become a heat map.
pub(crate) struct MapLook {
    pub(crate) title: String,
    pub(crate) unit: &'static str,
    pub(crate) scale: Scale,
    pub(crate) palette: Palette,
}

/// One heat map of a layout's values over the cells of a pair.
pub(crate) fn heat_map(
    study: &Study,
    picture: &PlanPicture,
    (pair, values): (Option<PairName>, &[f64]),
    look: &MapLook,
    subtitle: &str,
) -> Result<Vec<u8>, Error> {
    let map = HeatMap {
        picture,
        cells: &maps::cells(study, pair, values),
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
    if unit == enfilade_brief::column::DEGREES {
        return ColumnLook { unit, scale: Scale { lo: 0.0, hi: 360.0 }, palette: Palette::Cyclic };
    }
    let known = values.iter().copied().filter(|v| *v != UNDEFINED);
    ColumnLook { unit, scale: Scale::of(known), palette: maps::palette(settings) }
}

/// A heat map of each column over the present layout: files of `analysis/`, named after the columns.
///
/// # Errors
/// When a picture cannot be made.
pub(crate) fn column_pictures(
    job: Job<'_>,
    study: &Study,
    measured: &cells::Measured,
) -> Result<Vec<OutFile>, Error> {
    let Job { input, settings } = job;
    let picture = show::picture(&study.base);
    let subtitle = format!("{}, as drawn", input.file());
    let one = |column: &Column| {
        let look = column_look(&column.name, &column.values, settings);
        let map = HeatMap {
            picture: &picture,
            scale: look.scale,
            cells: &maps::column_cells(study, column),
            spacing_m: study.spacing_m,
            title: &measured.title(&column.name),
            subtitle: &subtitle,
            unit: look.unit,
            no_value: measured.no_value(&column.name),
            palette: look.palette,
        };
        Ok(OutFile::new(format!("{}.png", maps::slug(&column.name)), heat_map_png(&map, DEFAULT_SIDE_PX)?))
    };
    measured.columns.par_iter().map(one).collect::<Vec<_>>().into_iter().collect()
}

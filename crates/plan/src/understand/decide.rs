//! What is decided of a drawing before anything is made of it: unit, drawing of the sheet, walls, and what everything is.

use std::borrow::Cow;
use std::collections::BTreeSet;

use glam::DVec2;

use super::refusal::no_walls;
use crate::frame::{self, UnitChoice};
use crate::reading::corrections::{Said, with_walls, without_others};
use crate::reading::{Reading, UnitSense};
use crate::sizes::ZERO_M;
use crate::views::{View, beside_plans};
use crate::{LayerUse, PlanOptions, choice, dots, fills, storeys, units};
use enfilade_cad::drawing::{Drawing, Entity, Format};
use enfilade_cad::plane::box_of;
use enfilade_report::{Error, Report};

/// What was decided. Nothing of it is changed afterwards.
pub(super) struct Decision<'d> {
    /// The drawing, with filled areas among its entities where walls are drawn by them.
    pub drawing: Cow<'d, Drawing>,
    /// Which of its entities are walls, ascending.
    pub picked: Vec<usize>,
    /// The box of the walls, drawing units.
    pub extent: [DVec2; 2],
    /// The unit.
    pub unit: UnitChoice,
    /// What everything is, with how sure the unit is.
    pub reading: Reading,
    /// The drawings of the sheet.
    pub views: Vec<View>,
    /// Records of the user's marks on drawings that are not read.
    pub unused_marks: BTreeSet<usize>,
    /// What became of every layer.
    pub layers: Vec<LayerUse>,
}

impl<'d> Decision<'d> {
    /// Decides: unit and walls together, then which drawing of the sheet is meant, then what the user corrects.
    pub fn new(drawing: &'d Drawing, options: &PlanOptions, report: &mut Report) -> Result<Self, Error> {
        let drawing = fills::joined(drawing, options);
        let said = options.corrections.said(&drawing);
        dots::state(&drawing, report);
        let mut chosen = choice::choose_walls(&drawing, (options, &said), report)?;
        let Read { extent, unit, sense, reading } = read(&drawing, (options, &said), &mut chosen, report)?;
        let metres = unit.unit.metres;
        let choice::Taken { walls: mut picked, views, unused_marks } =
            choice::choose_view(&drawing, options, &chosen, metres, report)?;
        let is_read_now = options.senses.is_none() && !options.corrections.as_drawn;
        let reading =
            if is_read_now { reading.without_beside(&beside_plans(&drawing, &views)) } else { reading };
        let of_view = picked.clone();
        let drawing = fills::take(drawing, options, &mut chosen, &mut picked, metres, report)?;
        let said = options.corrections.said(&drawing);
        if options.picked.is_none() {
            without_others(&said, &mut picked);
            with_walls(&said, &mut picked, |i| of_view.binary_search(&i).is_ok());
        }
        let walls: Vec<&Entity> = picked.iter().map(|i| &drawing.entities[*i]).collect();
        choice::state_columns_only(&drawing, options, &walls, report);
        if options.is_our_choice() && drawing.format == Format::Dxf {
            storeys::warn(&drawing, &walls, report);
        }
        let extent = extent_of(&walls).unwrap_or(extent);
        let findings = options.corrections.idle(&drawing);
        let reading = Reading { unit: sense, findings, ..reading.corrected(said, &picked) };
        let layers = chosen.layers;
        Ok(Self { drawing, picked, extent, unit, reading, views, unused_marks, layers })
    }
}

/// What a drawing was taken for, with its unit.
struct Read {
    /// The box of the walls, drawing units.
    extent: [DVec2; 2],
    unit: UnitChoice,
    sense: UnitSense,
    reading: Reading,
}

/// Most times that the walls are looked at in the unit that those found before ask for.
const LOOKS_MAX: usize = 3;

/// Unit and walls together: first the unit by all that is drawn, then the walls in it, until the walls ask for the unit
/// that they were found in.
fn read(
    drawing: &Drawing,
    (options, said): (&PlanOptions, &Said),
    chosen: &mut choice::Chosen,
    report: &Report,
) -> Result<Read, Error> {
    let mut by_size = choice::for_size(drawing, options, chosen);
    let is_unnamed = chosen.walls.is_empty() && drawing.format == Format::Dxf && options.is_our_choice();
    let mut before = None;
    let mut out: Option<Read> = None;
    for _ in 0..LOOKS_MAX {
        let walls = choice::entities(drawing, &by_size);
        let (extent, (unit, sense)) = sized(drawing, options, (chosen, &walls), report)?;
        let longer = (extent[1] - extent[0]).max_element();
        let is_whole = longer * unit.unit.metres >= frame::SMALL_PLAN_M;
        // Lines of frames and furniture lie nearer to one another than the faces of walls: only walls tell a scale.
        let scale = match out.is_none() && is_whole {
            true => 1.0,
            false => units::person_scale(drawing, &walls, longer, unit.unit),
        };
        let metres = unit.unit.metres / scale;
        if let Some(found) = out.as_mut().filter(|_| before == Some(metres)) {
            (found.extent, found.unit, found.sense) = (extent, unit, sense);
            break;
        }
        before = Some(metres);
        let reading = match &options.senses {
            Some(kept) => Reading::again(drawing, kept),
            None if options.corrections.as_drawn => Reading::by_names(drawing),
            None if is_unnamed => Reading::new(drawing, metres).with_rooms_as_walls(),
            None => Reading::new(drawing, metres),
        };
        choice::take_read(drawing, options, &reading, chosen);
        choice::correct(drawing, said, &mut chosen.walls);
        if chosen.walls.is_empty() {
            return Err(no_walls(drawing, chosen, report));
        }
        out = Some(Read { extent, unit, sense, reading });
        if by_size == chosen.walls {
            break;
        }
        by_size.clone_from(&chosen.walls);
    }
    out.ok_or_else(|| no_walls(drawing, chosen, report))
}

/// The box of the walls, drawing units, and the unit with how sure it is.
fn sized(
    drawing: &Drawing,
    options: &PlanOptions,
    (chosen, walls): (&choice::Chosen, &[&Entity]),
    report: &Report,
) -> Result<([DVec2; 2], (UnitChoice, UnitSense)), Error> {
    let Some(extent) = extent_of(walls) else { return Err(no_walls(drawing, chosen, report)) };
    let size = (extent[1] - extent[0]).max_element();
    let unit = units::choose(drawing, options.unit, walls);
    match size * unit.0.unit.metres < ZERO_M {
        true => Err(no_walls(drawing, chosen, report)),
        false => Ok((extent, unit)),
    }
}

fn extent_of(walls: &[&Entity]) -> Option<[DVec2; 2]> {
    box_of(walls.iter().flat_map(|e| enfilade_cad::curve::control_points(&e.shape)))
}

//! From a drawing to the plan: what is decided, then what is made of it.

mod decide;
mod refusal;

use std::collections::BTreeSet;

use crate::frame::{BUILT_SIZE_M, Frame, PLAUSIBLE_SIZE_M, UnitChoice};
use crate::{
    DOOR_LAYER, DrawnBy, NamedDoor, OPENING_LAYER, Plan, PlanOptions, Plug, Wall, allowed, asked, choice,
    crowd, curve, decided, markers, obstacles, outdoors, outline, slots, units, wide,
};
use decide::Decision;
use enfilade_cad::drawing::{Drawing, Editable, Entity, Format};
use enfilade_report::{Error, Place, Report};

/// Understands a drawing.
///
/// # Errors
/// [`Error::Input`] when no layer carries walls (the message lists the layers there are), or their lines cross too often;
/// [`Error::Usage`] for a layer pattern that cannot be read, or a view that is not there.
pub fn understand(drawing: &Drawing, options: &PlanOptions, report: &mut Report) -> Result<Plan, Error> {
    let Decision { drawing, picked, extent, unit, reading, views, unused_marks, layers } =
        Decision::new(drawing, options, report)?;
    let (drawing, as_drawn) = (&*drawing, options.corrections.as_drawn);
    let entities: Vec<&Entity> = picked.iter().map(|i| &drawing.entities[*i]).collect();
    let longer = (extent[1] - extent[0]).max_element();
    let frame = Frame::new(unit.unit.metres, extent);
    let human_scale = match as_drawn {
        true => 1.0,
        false => units::person_scale(drawing, &entities, longer, unit.unit),
    };
    state_unit(drawing, &unit, longer * unit.unit.metres, human_scale, report);
    let mut markers = markers::read(drawing, options, &unused_marks, &frame, report);
    markers.asked = asked::read(drawing, &unused_marks, &frame);
    markers.allowed.extend(allowed::stated(drawing, unit.unit.metres, report));
    let is_wall = |i: usize| picked.binary_search(&i).is_ok();
    let (mut obstacles, outdoors) = match as_drawn {
        true => Default::default(),
        false => (
            obstacles::find(drawing, &reading, &picked, unit.unit.metres / human_scale, &frame),
            outdoors::find(drawing, is_wall, &frame, human_scale),
        ),
    };
    let records: BTreeSet<usize> = entities.iter().map(|w| w.source.record).collect();
    obstacles.extend(obstacles::known(drawing, &frame, |record| records.contains(&record)));
    let mut walls = walls_of(drawing, &entities, &frame)?;
    match drawing.format {
        _ if as_drawn => {}
        Format::Dxf => outline::mark_solids(&mut walls, &markers),
        _ => outline::mark_bodies(&mut walls),
    }
    if !as_drawn {
        wide::mark(&mut walls, &entities, drawing, (&frame, human_scale), report);
    }
    let scale = decided::Scale { frame: &frame, human_scale };
    let works = decided::demolish(&mut walls, drawing, &unused_marks, scale, report);
    let slots = slots::of(drawing, &walls, &frame);
    reading.findings.iter().for_each(|f| f.tell(&drawing.file, report));
    let mut bearing = drawing.structure();
    bearing.retain(|record, _| records.contains(record));
    let mut plan = Plan {
        file: drawing.file.clone(),
        format: drawing.format,
        version: drawing.version.clone(),
        unit,
        frame,
        walls,
        picked: choice::ordinals(drawing, &picked),
        markers,
        layers,
        views,
        human_scale,
        plugs: plugs(drawing, &works, &slots, &frame),
        doors: doors(drawing, &works, &slots, &frame),
        slots,
        bearing,
        obstacles,
        outdoors,
        senses: reading.kept(drawing),
        reading,
        north_deg: drawing.north_deg,
        decided: works,
    };
    decided::build(&mut plan, drawing, &unused_marks, report);
    Ok(plan)
}

/// The walls that entities draw, in their order.
fn walls_of(drawing: &Drawing, entities: &[&Entity], frame: &Frame) -> Result<Vec<Wall>, Error> {
    let is_locked = |e: &Entity| drawing.layers.iter().any(|l| l.is_locked && l.name == e.layer);
    let drawn = entities.iter().enumerate();
    let mut walls: Vec<Wall> =
        drawn.map(|(k, e)| wall_of(e, frame, is_locked(e), DrawnBy::Picked(k))).collect();
    crowd::refuse(&walls, &drawing.file)?;
    walls.iter_mut().for_each(|w| w.single = drawing.singles.get(&w.source.record).copied());
    Ok(walls)
}

/// What closes the openings of walls that the file names. An opening that nothing fills is shown under its wall.
fn plugs(drawing: &Drawing, works: &[decided::Decided], slots: &[slots::Slot], frame: &Frame) -> Vec<Plug> {
    let of = |e: &Entity| {
        let unfilled = || (e.layer == OPENING_LAYER).then_some(e.source.record);
        let host = drawing.hosts.get(&e.source.record).copied().or_else(unfilled)?;
        Some(Plug { host, outline: curve::trace(&e.shape, frame), slot: slots::closed_by(slots, e) })
    };
    drawing.entities.iter().filter(|e| !decided::is_gone(works, e)).filter_map(of).collect()
}

/// The doors that the file calls so.
fn doors(
    drawing: &Drawing,
    works: &[decided::Decided],
    slots: &[slots::Slot],
    frame: &Frame,
) -> Vec<NamedDoor> {
    let doors = drawing.entities.iter().filter(|e| e.layer == DOOR_LAYER && !decided::is_gone(works, e));
    let of = |e: &Entity| NamedDoor {
        host: drawing.hosts.get(&e.source.record).copied(),
        outline: curve::trace(&e.shape, frame),
        slot: slots::closed_by(slots, e),
    };
    doors.map(of).collect()
}

/// A wall on a locked layer is measured and stays: the user locked it against changes.
fn wall_of(entity: &Entity, frame: &Frame, is_locked: bool, drawn_by: DrawnBy) -> Wall {
    let editable = match &entity.editable {
        Editable::No(why) => Editable::No(why.clone()),
        _ if is_locked => Editable::No(format!("its layer {:?} is locked", entity.layer)),
        other => other.clone(),
    };
    Wall {
        source: entity.source.clone(),
        editable,
        shape: entity.shape.clone(),
        trace: curve::trace(&entity.shape, frame),
        is_solid: false,
        width_um: 0,
        single: None,
        drawn_by,
    }
}

fn state_unit(drawing: &Drawing, unit: &UnitChoice, size_m: f64, human_scale: f64, report: &mut Report) {
    let place = Place::file(&drawing.file);
    report.info(
        if unit.is_assumed { "unit-assumed" } else { "unit" },
        place.clone(),
        format!("unit: {}", unit.reason),
    );
    let [lo, hi] = match drawing.format {
        Format::Dxf => PLAUSIBLE_SIZE_M,
        _ => BUILT_SIZE_M,
    };
    let is_believed = (lo..=hi).contains(&size_m);
    if is_believed && human_scale == 1.0 {
        return;
    }
    let seen = match is_believed {
        false => format!(
            "the drawing is {size_m:.3} m long when read in {}, expected {lo} to {hi} m for a building",
            unit.unit.name
        ),
        true => format!(
            "the drawing is {size_m:.1} m long when read in {}, and its walls are too thin for that: it is an \
             illustration of unknown scale",
            unit.unit.name
        ),
    };
    let done = match human_scale == 1.0 {
        true => "read as stated".to_string(),
        false => format!(
            "read as stated, doors and default moves taken in proportion (a person's metre as {human_scale} m)"
        ),
    };
    // What one unit is at the scale that was found: a person would say it so.
    let scale = (1.0 / human_scale).round();
    let example = match (drawing.format, units::is_printed(unit.unit, scale)) {
        (Format::Dxf, true) => {
            format!("--unit {scale}{0}: one drawing unit is {scale} {0}, as at 1:{scale}", unit.unit.name)
        }
        _ => "--unit 25m: one drawing unit is 25 m".into(),
    };
    let text = format!("{seen}; {done}; --unit overrides it ({example})");
    report.info("unit-implausible", place, text);
}

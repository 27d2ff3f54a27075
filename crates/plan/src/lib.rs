//! The model: a plan in metres, and how it is understood from a drawing.
//!
//! Whoever holds a [`Plan`] need not think any more about: units, layers, blocks, codes of a format,
//! coordinates far from zero, curves (they are traced to straight pieces), or shapes of no size.
//!
//! A room of four walls, drawn in metres:
//!
//! ```
//! use enfilade_plan::{PlanOptions, understand};
//! use enfilade_report::Report;
//!
//! let corners = [[0, 0], [4, 0], [4, 3], [0, 3], [0, 0]];
//! let line = |ends: &[[i32; 2]]| {
//!     let [[ax, ay], [bx, by]] = [ends[0], ends[1]];
//!     format!("0\nLINE\n8\nWALLS\n10\n{ax}\n20\n{ay}\n11\n{bx}\n21\n{by}\n")
//! };
//! let walls: String = corners.windows(2).map(line).collect();
//! let header = "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n6\n0\nENDSEC\n";
//! let dxf = format!("{header}0\nSECTION\n2\nENTITIES\n{walls}0\nENDSEC\n0\nEOF\n");
//!
//! let mut report = Report::default();
//! let drawing = enfilade_cad::read("room.dxf", dxf.as_bytes(), &Default::default(), &mut report)?;
//! let plan = understand(&drawing, &PlanOptions::default(), &mut report)?;
//! assert_eq!(plan.walls.len(), 4);
//! # Ok::<(), enfilade_report::Error>(())
//! ```

pub mod allowed;
pub mod asked;
pub mod at_walls;
pub mod axes;
pub mod body_sides;
pub mod by_place;
mod choice;
mod crowd;
pub mod curve;
pub mod decided;
pub mod dots;
pub mod drawn;
mod fills;
pub mod fittings;
pub mod floor;
pub mod frame;
pub mod graph;
pub mod hidden;
pub mod infill;
pub mod kinds;
pub mod labels;
mod leaves;
mod length;
pub mod markers;
pub mod obstacles;
mod on_sheet;
mod outdoors;
pub mod outline;
pub mod parallels;
mod paving;
pub mod reading;
mod repeats;
pub mod rooms;
mod rounds;
pub mod sight;
pub mod sizes;
pub mod slots;
mod stairs;
mod storeys;
pub mod structure;
pub mod units;
pub mod view_box;
pub mod view_names;
pub mod views;
pub mod wide;

use enfilade_cad::plane::box_of;
use std::collections::BTreeMap;

use glam::DVec2;

use crate::sizes::ZERO_M;
use curve::Trace;
use enfilade_cad::drawing::{Drawing, Editable, Entity, Format, Shape, Single, SourceRef, Unit};
use enfilade_cad::{bearing, own_layers};
use enfilade_engine::geometry::PointUm;
use enfilade_report::{Error, Place, Problem, Report};
use frame::{BUILT_SIZE_M, Frame, PLAUSIBLE_SIZE_M, UnitChoice};
use markers::Markers;
use reading::corrections::{Corrections, with_walls, without_others};
use views::View;

/// One drawn wall element: a line, an outline, an arc, a column.
#[derive(Clone, Debug, PartialEq)]
pub struct Wall {
    /// Where it stands in the file.
    pub source: SourceRef,
    /// How it can be written back.
    pub editable: Editable,
    /// As drawn, drawing units.
    pub shape: Shape,
    /// As straight pieces, drawing frame, micrometres.
    pub trace: Trace,
    /// Whether its closed outline is filled: a column, or a wall drawn as an outline (spec 3).
    pub is_solid: bool,
    /// Width of a polyline that is drawn as wide as a wall is thick, micrometres; 0 of anything else ([`wide`]).
    pub width_um: i64,
    /// Where the file holds its corners in single precision once they move: in what frame.
    pub single: Option<Single>,
    /// What draws it.
    pub drawn_by: DrawnBy,
}

/// What draws a wall; of one that a decided work cuts, several walls have the same.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DrawnBy {
    /// An entity: its place in [`Plan::picked`].
    Picked(usize),
    /// A mark on `EF-NEW`: the index of its entity in the drawing.
    Mark(usize),
}

/// What closes an opening of a wall.
#[derive(Clone, Debug, PartialEq)]
pub struct Plug {
    /// [`SourceRef::record`] of the wall.
    pub host: usize,
    /// Its outline.
    pub outline: Trace,
    /// The opening that it goes with, where that can slide: its place in [`Plan::slots`].
    pub slot: Option<usize>,
}

/// Layer of the doors of a building.
pub const DOOR_LAYER: &str = "IfcDoor";

/// Layer of a building's openings that nothing fills.
pub const OPENING_LAYER: &str = "IfcOpeningElement";

/// A door that the file calls so.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedDoor {
    /// [`SourceRef::record`] of the wall it sits in, where the file says it.
    pub host: Option<usize>,
    /// What it closes.
    pub outline: Trace,
    /// The opening that it goes with, where that can slide: its place in [`Plan::slots`].
    pub slot: Option<usize>,
}

/// What became of one layer.
#[derive(Clone, Debug, PartialEq)]
pub struct LayerUse {
    /// Decoded name.
    pub name: String,
    /// Shapes and texts on it; of a building its elements.
    pub entities: usize,
    /// `wall`, `low`, `marker`, `own`, `hidden` or `ignored`.
    pub role: &'static str,
    /// Why, in plain words.
    pub why: String,
}

/// A plan as understood. See the module page.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// File name to show in places.
    pub file: String,
    /// Format the drawing came from.
    pub format: Format,
    /// Version of the format in its own words.
    pub version: String,
    /// Unit and why.
    pub unit: UnitChoice,
    /// Drawing units ↔ drawing frame ↔ plan frame.
    pub frame: Frame,
    /// Wall elements in file order.
    pub walls: Vec<Wall>,
    /// Which entities the walls are: ordinals among the drawing's entities that are not on layers of
    /// ours. With them in [`PlanOptions::picked`] a changed copy gives the same walls.
    pub picked: Vec<usize>,
    /// The user's marks.
    pub markers: Markers,
    /// Building works that are decided; the walls are as they will be.
    pub decided: Vec<decided::Decided>,
    /// What became of every layer that holds something.
    pub layers: Vec<LayerUse>,
    /// The drawings of the sheet, at least one; one of them was read unless `--view all` was said.
    pub views: Vec<View>,
    /// Metres of the plan in one metre of a person; 1 unless the plan is far too small
    /// ([`frame::human_scale`]).
    pub human_scale: f64,
    /// Doors and windows in walls that the file names.
    pub plugs: Vec<Plug>,
    /// The doors of a building, where the file calls them so.
    pub doors: Vec<NamedDoor>,
    /// Openings that can slide along their walls.
    pub slots: Vec<slots::Slot>,
    /// Records of walls that stay unless somebody says otherwise, and why; empty where they may move as well.
    pub bearing: BTreeMap<usize, bearing::Bearing>,
    /// What stands in the rooms: what slides must not run into it.
    pub obstacles: Vec<obstacles::Obstacle>,
    /// Ground that layers say is outdoors, rings in the drawing frame, micrometres: no interior.
    pub outdoors: Vec<Vec<PointUm>>,
    /// What every entity was taken for, and how sure that is.
    pub reading: reading::Reading,
    /// The same of what is not ours, for [`PlanOptions::senses`].
    pub senses: Vec<reading::RoleSense>,
    /// Where north is: degrees anticlockwise from up.
    pub north_deg: f64,
}

/// The user's word on how to read a drawing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PlanOptions {
    /// `--unit`.
    pub unit: Option<Unit>,
    /// `--wall-layer`, globs.
    pub wall_layers: Vec<String>,
    /// `--query-layer` instead of `EF-QUERY`.
    pub query_layer: Option<String>,
    /// `--reference-layer` instead of `EF-REFERENCE`.
    pub reference_layer: Option<String>,
    /// `--view`: name or number of a drawing on the sheet, `all`, or a box round it.
    pub view: Option<String>,
    /// `--level knee`: low walls and glazing block too.
    pub is_knee_level: bool,
    /// The walls by [`Plan::picked`] of an earlier reading; nothing is chosen then.
    pub picked: Option<Vec<usize>>,
    /// What everything was taken for in an earlier reading ([`reading::Reading::kept`]).
    pub senses: Option<Vec<reading::RoleSense>>,
    /// What the user says of entities and of the floor.
    pub corrections: Corrections,
}

impl PlanOptions {
    /// Whether a choice is ours: the user named no layers of walls, and nothing was chosen before.
    fn is_our_choice(&self) -> bool {
        self.picked.is_none() && self.wall_layers.is_empty() && !self.corrections.as_drawn
    }
}

/// Understands a drawing.
///
/// # Errors
/// [`Error::Input`] when no layer carries walls (the message lists the layers there are), or their lines cross too often;
/// [`Error::Usage`] for a layer pattern that cannot be read, or a view that is not there.
pub fn understand(drawing: &Drawing, options: &PlanOptions, report: &mut Report) -> Result<Plan, Error> {
    let drawing = fills::joined(drawing, options);
    let (said, as_drawn) = (options.corrections.said(&drawing), options.corrections.as_drawn);
    dots::state(&drawing, report);
    let mut chosen = choice::choose_walls(&drawing, (options, &said), report)?;
    let Read { extent, unit, sense, reading } = read(&drawing, (options, &said), &mut chosen, report)?;
    let choice::Taken { walls: mut picked, views, unused_marks } =
        choice::choose_view(&drawing, options, &chosen, unit.unit.metres, report)?;
    let reading = match options.senses {
        None if !as_drawn => reading.without_beside(&views::beside_plans(&drawing, &views)),
        _ => reading,
    };
    let of_view = picked.clone();
    let is_our_choice = options.is_our_choice();
    let drawing = fills::take(drawing, options, &mut chosen, &mut picked, unit.unit.metres, report)?;
    let said = options.corrections.said(&drawing);
    if options.picked.is_none() {
        without_others(&said, &mut picked);
        with_walls(&said, &mut picked, |i| of_view.binary_search(&i).is_ok());
    }
    let walls: Vec<&Entity> = picked.iter().map(|i| &drawing.entities[*i]).collect();
    choice::state_columns_only(&drawing, options, &walls, report);
    if is_our_choice && drawing.format == Format::Dxf {
        storeys::warn(&drawing, &walls, report);
    }
    let extent = extent_of(&walls).unwrap_or(extent);
    let frame = Frame::new(unit.unit.metres, extent);
    let size_m = (extent[1] - extent[0]).max_element() * unit.unit.metres;
    let human_scale = match as_drawn {
        true => 1.0,
        false => units::person_scale(&drawing, &walls, (extent[1] - extent[0]).max_element(), unit.unit),
    };
    state_unit(&drawing, &unit, size_m, human_scale, report);
    let mut markers = markers::read(&drawing, options, &unused_marks, &frame, report);
    markers.asked = asked::read(&drawing, &unused_marks, &frame);
    markers.allowed.extend(allowed::stated(&drawing, unit.unit.metres, report));
    let is_wall = |i: usize| picked.binary_search(&i).is_ok();
    let (obstacles, outdoors) = match as_drawn {
        true => Default::default(),
        false => (
            obstacles::find(&drawing, &reading, &picked, unit.unit.metres / human_scale, &frame),
            outdoors::find(&drawing, is_wall, &frame, human_scale),
        ),
    };
    let mut obstacles = obstacles;
    let records: std::collections::BTreeSet<usize> = walls.iter().map(|w| w.source.record).collect();
    obstacles.extend(obstacles::known(&drawing, &frame, |record| records.contains(&record)));
    let is_locked = |e: &Entity| drawing.layers.iter().any(|l| l.is_locked && l.name == e.layer);
    let entities = walls;
    let drawn = entities.iter().enumerate();
    let mut walls: Vec<Wall> =
        drawn.map(|(k, e)| wall_of(e, &frame, is_locked(e), DrawnBy::Picked(k))).collect();
    crowd::refuse(&walls, &drawing.file)?;
    walls.iter_mut().for_each(|w| w.single = drawing.singles.get(&w.source.record).copied());
    match drawing.format {
        _ if as_drawn => {}
        Format::Dxf => outline::mark_solids(&mut walls, &markers),
        _ => outline::mark_bodies(&mut walls),
    }
    if !as_drawn {
        wide::mark(&mut walls, &entities, &drawing, (&frame, human_scale), report);
    }
    let scale = decided::Scale { frame: &frame, human_scale };
    let works = decided::demolish(&mut walls, &drawing, &unused_marks, scale, report);
    let slots = slots::of(&drawing, &walls, &frame);
    let findings = options.corrections.idle(&drawing);
    findings.iter().for_each(|f| f.tell(&drawing.file, report));
    let reading = reading::Reading { unit: sense, findings, ..reading.corrected(said, &picked) };
    let senses = reading.kept(&drawing);
    let mut plan = Plan {
        file: drawing.file.clone(),
        format: drawing.format,
        version: drawing.version.clone(),
        unit,
        frame,
        walls,
        picked: choice::ordinals(&drawing, &picked),
        markers,
        layers: chosen.layers,
        views,
        human_scale,
        plugs: plugs(&drawing, &works, &slots, &frame),
        doors: doors(&drawing, &works, &slots, &frame),
        slots,
        bearing: walls_of(drawing.structure(), &entities),
        obstacles,
        outdoors,
        reading,
        senses,
        north_deg: drawing.north_deg,
        decided: works,
    };
    decided::build(&mut plan, &drawing, &unused_marks, report);
    Ok(plan)
}

/// Those of some records that are walls of the plan.
fn walls_of<T>(mut of: BTreeMap<usize, T>, walls: &[&Entity]) -> BTreeMap<usize, T> {
    let records: std::collections::BTreeSet<usize> = walls.iter().map(|w| w.source.record).collect();
    of.retain(|record, _| records.contains(record));
    of
}

/// What a drawing was taken for, with its unit.
struct Read {
    /// The box of the walls, drawing units.
    extent: [DVec2; 2],
    unit: UnitChoice,
    sense: reading::UnitSense,
    reading: reading::Reading,
}

/// Most times that the walls are looked at in the unit that those found before ask for.
const LOOKS_MAX: usize = 3;

/// Unit and walls together: first the unit by all that is drawn, then the walls in it, until the walls ask for the unit
/// that they were found in.
fn read(
    drawing: &Drawing,
    (options, said): (&PlanOptions, &reading::corrections::Said),
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
            Some(kept) => reading::Reading::again(drawing, kept),
            None if options.corrections.as_drawn => reading::Reading::by_names(drawing),
            None if is_unnamed => reading::Reading::new(drawing, metres).with_rooms_as_walls(),
            None => reading::Reading::new(drawing, metres),
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
) -> Result<([DVec2; 2], (UnitChoice, reading::UnitSense)), Error> {
    let Some(extent) = extent_of(walls) else { return Err(no_walls(drawing, chosen, report)) };
    let size = (extent[1] - extent[0]).max_element();
    let unit = units::choose(drawing, options.unit, walls);
    match size * unit.0.unit.metres < ZERO_M {
        true => Err(no_walls(drawing, chosen, report)),
        false => Ok((extent, unit)),
    }
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

fn extent_of(walls: &[&Entity]) -> Option<[DVec2; 2]> {
    box_of(walls.iter().flat_map(|e| enfilade_cad::curve::control_points(&e.shape)))
}

/// Problems of readers by which whole blocks are left out.
const BLOCKS_LEFT_OUT: [&str; 4] =
    ["dxf-block-cycle", "dxf-block-depth", "dxf-expansion-budget", "dxf-external-reference"];

/// Most of them that a refusal names.
const LEFT_OUT_TOLD: usize = 3;

/// What is said of an entity with coordinates that no plan can have.
const TOO_FAR: &str = "dxf-bad-coordinate";

fn no_walls(drawing: &Drawing, chosen: &choice::Chosen, report: &Report) -> Error {
    let layers = &chosen.layers;
    let mut by_size: Vec<&LayerUse> =
        layers.iter().filter(|l| l.role != "own" && l.role != "marker").collect();
    by_size.sort_by_key(|l| std::cmp::Reverse(l.entities));
    let shown: Vec<String> =
        by_size.iter().take(LISTED_MAX).map(|l| format!("{} ({})", l.name, l.entities)).collect();
    let more = by_size.len().saturating_sub(LISTED_MAX);
    let mut list = if shown.is_empty() { "none".to_string() } else { shown.join(", ") };
    if more > 0 {
        list.push_str(&format!(" and {more} more"));
    }
    let hidden: Vec<&str> = layers.iter().filter(|l| l.role == "hidden").map(|l| l.name.as_str()).collect();
    let hint =
        if hidden.is_empty() { String::new() } else { format!(" (off or frozen: {})", hidden.join(", ")) };
    let remedy = match hidden[..] {
        [] => "name the layer of the walls with --wall-layer NAME",
        _ => {
            "switch what is off on and thaw what is frozen in the drawing, or name another layer with --wall-layer NAME"
        }
    };
    let (others, help) = undrawn_words(drawing);
    let mut left_out: Vec<&Problem> =
        report.problems.iter().filter(|p| BLOCKS_LEFT_OUT.contains(&p.code)).collect();
    left_out.dedup_by_key(|p| &p.text);
    let mut far = report.problems.iter().filter(|p| p.code == TOO_FAR);
    if let (true, Some(first)) = (left_out.is_empty(), far.next()) {
        let others = if far.next().is_some() { ", and so are others" } else { "" };
        let text = format!(
            "{}{others}; nothing was measured, since no other walls were found; move the drawing near its zero point",
            first.text
        );
        return Error::input("no-walls", first.place.clone(), text);
    }
    let told: Vec<&str> = left_out.iter().take(LEFT_OUT_TOLD).map(|p| p.text.as_str()).collect();
    let why = match told.len() {
        0 => String::new(),
        1 => format!("{}; besides it ", told[0]),
        _ => format!("{}; besides them ", told.join("; ")),
    };
    let place = left_out.first().map_or_else(|| Place::file(&drawing.file), |p| p.place.clone());
    let longer = if chosen.walls.is_empty() { "" } else { "longer than a millimetre " };
    let text = format!(
        "{why}no entity {longer}on a wall layer{hint}, layers present: {list}{others}; nothing was measured; {help}{remedy}"
    );
    Error::input("no-walls", place, text)
}

/// What is drawn and gives no lines of walls, by layer and kind, and what to do about it; empty where there is nothing.
fn undrawn_words(drawing: &Drawing) -> (String, String) {
    let mut counts: BTreeMap<(bool, &str, &str), usize> = BTreeMap::new();
    for u in &drawing.undrawn {
        *counts.entry((u.is_on_paper, &u.layer, &u.kind)).or_default() += u.count;
    }
    for fill in drawing.fills.iter().filter(|f| !own_layers::is_own(&f.layer)) {
        *counts.entry((false, &fill.layer, &fill.source.kind)).or_default() += 1;
    }
    let (mut words, mut help) = (String::new(), String::new());
    let told = [
        (false, "not lines", "explode filled areas, multilines and faces, or draw their outlines as lines; "),
        (true, "on a sheet of paper", "copy what is drawn on a sheet of paper to model space; "),
    ];
    for (on_paper, what, todo) in told {
        let of = counts.iter().filter(|((p, ..), _)| *p == on_paper);
        let list: Vec<String> = of.map(|((_, layer, kind), n)| format!("{n} {kind} on {layer}")).collect();
        if list.is_empty() {
            continue;
        }
        let more = list.len().saturating_sub(LISTED_MAX);
        words += &format!("; {what}: {}", list[..list.len() - more].join(", "));
        if more > 0 {
            words += &format!(" and {more} more kinds");
        }
        help += todo;
    }
    (words, help)
}

/// Most layers, or kinds on them, that are listed where no walls are found.
const LISTED_MAX: usize = 12;

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

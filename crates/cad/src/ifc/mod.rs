//! IFC: a storey of a building to a drawing, and moves of its elements to bytes.
//!
//! The file stays bytes. [`read`] cuts every wall and column at the height of the eyes (or knees) above the
//! floor of one storey: the cut is the outline that blocks sight, less the openings of doors and windows.
//! [`patch`] gives moved elements, with all that hangs on them, other placements, and walls that change their length
//! other points of their ends; what others use of these is copied first. Everything else stays as it is.
//!
//! [`SourceRef::record`] is the instance number, [`SourceRef::handle`] the `GlobalId`, the layer the class.
//! Coordinates are the world's, in the file's unit of length. IFC2X3, IFC4 and IFC4X3; `.ifczip` too.
//!
//! [`SourceRef::record`]: crate::drawing::SourceRef::record
//! [`SourceRef::handle`]: crate::drawing::SourceRef::handle

mod additions;
mod alike;
mod body;
mod building;
mod clean;
mod floors;
mod footprint;
mod geo;
mod heights;
mod instance;
mod length;
mod limits;
mod marks;
mod model;
mod number;
mod patch;
mod phase;
mod placed;
mod plain;
mod profile;
mod quantity;
mod read;
mod reshape;
mod rooms;
mod standing;
mod step;
mod structure;
mod units;
mod unseen;
mod wishes;
mod works;
mod zip;

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet, HashMap};

use building::Building;
pub use footprint::Parting;
use glam::DVec2;
pub use limits::*;
pub use marks::KEEPS;
use rayon::prelude::*;
pub use read::{CLOSING_LAYERS, OUTDOORS_LAYER, SPACE_LAYER, ZONE_LAYER};
pub use unseen::UnseenJoint;
pub use zip::{is_zip, unzip};

use crate::drawing::{Addition, Drawing, Edit, Unit};
use crate::splice::{self, Splice};
pub use crate::step_text::decoded;
use crate::{SpaceNames, StoreyInfo};
use enfilade_report::{Error, Place, Report};
use step::{Fault, Step, line_of};

/// Height of standing eyes above the floor.
pub const CUT_EYE_M: f64 = 1.5;

/// Height of the cut at which windows block.
pub const CUT_KNEE_M: f64 = 0.5;

/// Stands before everything that is ours in a file.
const OWN_MARK: &[u8] = b"/* Enfilade: results from here on */";

/// At which height is looked.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sight {
    /// Windows are seen through.
    #[default]
    Eye,
    /// Windows block.
    Knee,
}

impl Sight {
    /// Height of the cut above a storey's floor, metres.
    pub fn above_m(self) -> f64 {
        match self {
            Self::Eye => CUT_EYE_M,
            Self::Knee => CUT_KNEE_M,
        }
    }
}

/// How to read a building.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReadOptions {
    /// Name of the storey; `None`: the one with most walls.
    pub storey: Option<String>,
    /// Height of the cut.
    pub sight: Sight,
    /// The user's word for the unit, which then stands above the file's.
    pub unit: Option<Unit>,
    /// Whether the glass of curtain walls stops sight.
    pub is_glass_wall: bool,
}

/// A product that an edit moves.
#[derive(Clone, Debug, PartialEq)]
pub struct MovedProduct {
    /// Instance number.
    pub id: u64,
    /// Its `GlobalId`.
    pub global_id: String,
    /// Its class where it is a door or a window.
    pub filler: Option<&'static str>,
    /// Of a wall that is not in the plan and only changes its length, its outline before and after, file units.
    pub outlines: Option<[Vec<DVec2>; 2]>,
    /// The storey of such a wall, where it stands in one.
    pub storey: Option<String>,
}

/// A room that a moved wall bounds.
#[derive(Clone, Debug, PartialEq)]
pub struct BoundedRoom {
    /// Its instance.
    pub id: u64,
    /// Its `GlobalId`.
    pub global_id: String,
    /// Its name.
    pub name: String,
    /// Its outline as drawn and afterwards, file units; or why it stays as drawn.
    pub outlines: Result<[Vec<DVec2>; 2], String>,
    /// Stated areas and volumes that stay as they are.
    pub quantities: Vec<String>,
    /// How many of its space boundaries lie on walls that change; they stay as they are.
    pub boundaries: usize,
}

/// Figures that the file states of an element that becomes longer or shorter, and that stay as they are.
#[derive(Clone, Debug, PartialEq)]
pub struct StaleFigures {
    /// Its instance.
    pub id: u64,
    /// Its `GlobalId`.
    pub global_id: String,
    /// What they are called.
    pub names: Vec<String>,
}

/// The building without the elements that are demolished, by their own property sets or those of their type, and how many
/// those were.
///
/// # Errors
/// [`Error::Input`] where the bytes are no IFC, or one number is given to several instances.
pub fn without_demolished(file: &str, bytes: &[u8]) -> Result<(Vec<u8>, usize), Error> {
    let step = open(file, bytes)?;
    clean::without_demolished(&Building::new(file, &step, None))
}

/// What edits change beside what they name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Effects {
    /// For every edit the products it moves, the edited one first. Of several edits of one wall the first names the
    /// unseen walls that go along.
    pub moved: Vec<Vec<MovedProduct>>,
    /// Rooms that moved walls bound.
    pub rooms: Vec<BoundedRoom>,
    /// Figures of walls that change their length.
    pub figures: Vec<StaleFigures>,
    /// Joints with walls that are not in the plan and stay.
    pub unseen: Vec<UnseenJoint>,
}

/// Schemas that are read.
const SCHEMAS: [&str; 3] = ["IFC2X", "IFC4", "IFC4X"];

/// A file taken apart once, to be read as often as wanted.
#[derive(Clone, Debug)]
pub struct Opened<'a> {
    file: &'a str,
    step: Step<'a>,
}

impl<'a> Opened<'a> {
    /// Takes a file apart; `file` is its name to show.
    ///
    /// # Errors
    /// [`Error::Input`] where the bytes are no whole STEP file or the schema is none of IFC's.
    pub fn new(file: &'a str, bytes: &'a [u8]) -> Result<Self, Error> {
        Ok(Self { file, step: open(file, bytes)? })
    }

    /// Reads one storey.
    ///
    /// # Errors
    /// [`Error::Usage`] where the storey is not there.
    pub fn read(&self, options: &ReadOptions, report: &mut Report) -> Result<Drawing, Error> {
        say_more(self.file, &self.step, report);
        read::read_storey(&Building::new(self.file, &self.step, options.unit), options, report)
    }

    /// Reads several storeys in one unit, each into a report of its own.
    ///
    /// # Errors
    /// For each as [`Self::read`].
    pub fn read_all(&self, options: &[ReadOptions]) -> Vec<(Result<Drawing, Error>, Report)> {
        let Some(first) = options.first() else { return Vec::new() };
        let building = Building::new(self.file, &self.step, first.unit);
        let one = |o: &ReadOptions| {
            let mut report = Report::default();
            say_more(self.file, &self.step, &mut report);
            (read::read_storey(&building, o, &mut report), report)
        };
        options.par_iter().map(one).collect()
    }

    /// Storeys from the lowest, and how much there is of what.
    pub fn building(&self, unit: Option<Unit>) -> (Vec<StoreyInfo>, Elements) {
        (storeys(&Building::new(self.file, &self.step, unit)), Elements::of(&self.step))
    }
}

/// Reads one storey.
///
/// # Errors
/// [`Error::Input`] where the bytes are no whole STEP file or the schema is none of IFC's;
/// [`Error::Usage`] for a storey that is not there.
pub fn read(file: &str, bytes: &[u8], options: &ReadOptions, report: &mut Report) -> Result<Drawing, Error> {
    Opened::new(file, bytes)?.read(options, report)
}

fn storeys(building: &Building<'_, '_>) -> Vec<StoreyInfo> {
    let metres = building.geo.metres;
    let storey = |s: &model::Storey| StoreyInfo {
        name: s.name.clone(),
        building: building.building_name(s),
        floor_m: s.floor * metres,
        walls: s.walls,
        top_m: s.top.map(|top| top * metres),
    };
    building.model.storeys.iter().map(storey).collect()
}

/// Whether the bytes are IFC in its other form, which is not read.
pub fn is_xml(bytes: &[u8]) -> bool {
    let head: String = String::from_utf8_lossy(&bytes[..bytes.len().min(400)]).to_lowercase();
    let is_xml = head.contains("<?xml") && head.contains("ifc");
    is_xml || head.contains("<ifcxml") || head.contains(":ifcxml")
}

fn open<'a>(file: &str, bytes: &'a [u8]) -> Result<Step<'a>, Error> {
    if is_xml(bytes) {
        let text = "found IFC as XML, expected a STEP file (.ifc); nothing was done; export as IFC instead of ifcXML";
        return Err(Error::input("ifc-xml", Place::file(file), text));
    }
    let step = Step::read(bytes).map_err(|fault| fault_error(file, bytes, &fault))?;
    if let Incomplete::Because(why) = completeness(bytes) {
        let text = format!("{why}; it is not finished; nothing was done");
        return Err(Error::input("ifc-incomplete", Place::file(file), text));
    }
    if step.data_end == bytes.len() {
        let text = "its end stands within a text or an instance that was begun before, expected the data to end \
                    before END-ISO-10303-21; nothing was done";
        return Err(Error::input("ifc-syntax", Place::file(file), text));
    }
    if !SCHEMAS.iter().any(|s| step.schema.starts_with(s)) {
        let found =
            if step.schema.is_empty() { "no schema".into() } else { format!("schema {:?}", step.schema) };
        let text = format!("found {found}, expected IFC2X3, IFC4 or IFC4X3; nothing was done");
        return Err(Error::input("ifc-schema", Place::file(file), text));
    }
    Ok(step)
}

/// The mark that ends a file.
const END: &[u8] = b"END-ISO-10303-21";

/// Says that something follows the end, as a second file does.
fn say_more(file: &str, step: &Step<'_>, report: &mut Report) {
    let tail = &step.bytes[step.data_end..];
    let Some(mark) = tail.windows(END.len()).position(|w| w.eq_ignore_ascii_case(END)) else { return };
    let after = &tail[mark + END.len()..];
    let more = after.iter().position(|b| *b == b';').map_or(after, |at| &after[at + 1..]).trim_ascii();
    if more.iter().any(|b| *b != 0) {
        let place = Place::line(file, line_of(step.bytes, step.data_end + mark));
        let text = format!(
            "after END-ISO-10303-21;, found {} more bytes, expected none; not read, kept in every output",
            more.len()
        );
        report.warn("ifc-bytes-after-end", place, text);
    }
}

fn fault_error(file: &str, bytes: &[u8], fault: &Fault) -> Error {
    let place = Place::line(file, line_of(bytes, fault.at));
    Error::input("ifc-syntax", place, format!("byte {}: {}; nothing was done", fault.at, fault.text))
}

/// Whether a file is whole.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Incomplete {
    /// It is.
    No,
    /// It is not.
    Because(String),
}

/// Whether the end mark `END-ISO-10303-21;` closes the file.
pub fn completeness(bytes: &[u8]) -> Incomplete {
    if zip::is_zip(bytes) {
        return zip::completeness(bytes);
    }
    let tail = &bytes[bytes.len().saturating_sub(4096)..];
    let text: Vec<u8> =
        tail.iter().rev().skip_while(|b| b.is_ascii_whitespace() || **b == 0).copied().collect();
    let text: Vec<u8> = text.into_iter().rev().filter(|b| !b.is_ascii_whitespace()).collect();
    if bytes.is_empty() {
        Incomplete::Because("it is empty".into())
    } else if text.to_ascii_uppercase().ends_with(b"END-ISO-10303-21;") {
        Incomplete::No
    } else {
        Incomplete::Because("found no END-ISO-10303-21; at its end, expected it as the last line".into())
    }
}

/// The building with the moves made and the additions put in; no edits and no additions give the same bytes.
///
/// Moved elements take along their openings, what fills them, their parts and coverings. Additions stand
/// after a comment of ours at the end of the data, see [`strip_own`].
///
/// # Errors
/// [`Error::Input`] where an edit names nothing that can move, and where the bytes are no IFC.
pub fn patch(
    file: &str,
    bytes: &[u8],
    options: &ReadOptions,
    edits: &[Edit],
    own: &[Addition],
) -> Result<Vec<u8>, Error> {
    if edits.is_empty() && own.is_empty() {
        return Ok(bytes.to_vec());
    }
    let step = open(file, bytes)?;
    let building = Building::new(file, &step, options.unit);
    let mut mover = patch::Mover::new(&building, options, edits);
    let mut figures = Vec::new();
    for edit in edits.iter().filter(|e| !e.is_work()) {
        figures.extend(mover.edit(edit)?.figures);
    }
    let rooms = mover.rooms();
    let next = mover.next_id();
    let (mut splices, mut added) = (mover.splices, mover.added);
    let works = works::text(&building, options, next, edits)?;
    added.extend(works.added);
    splices.extend(works.splices);
    let end = line_end(bytes);
    let text = match own {
        [] => Vec::new(),
        _ => additions::text(&building, options, works.next, (edits, &rooms, &figures), own)?,
    };
    if !text.is_empty() {
        added.extend([OWN_MARK, end].concat());
        added.extend(text);
    }
    // Before whatever stands between the last instance and ENDSEC: a comment there stays with ENDSEC.
    let at = instances_end(&step);
    let added = [end, added.strip_suffix(end).unwrap_or(&added)].concat();
    splices.push(Splice::new(at..at, if added.len() > end.len() { added } else { Vec::new() }));
    splice::apply(file, "ifc-edit-twice", bytes, splices)
}

/// What edits change beside what they name.
///
/// # Errors
/// As [`patch`].
pub fn effects(file: &str, bytes: &[u8], options: &ReadOptions, edits: &[Edit]) -> Result<Effects, Error> {
    let step = open(file, bytes)?;
    let building = Building::new(file, &step, options.unit);
    let mut mover = patch::Mover::new(&building, options, edits);
    let named = |id: u64, outlines: Option<[Vec<DVec2>; 2]>| {
        let global_id = step.args(id).first().and_then(|a| step.text(a)).unwrap_or_default();
        let filler = building.model.filler(id).map(|f| f.class);
        let storey = outlines.as_ref().and_then(|_| building.storey_name(id));
        MovedProduct { id, global_id, filler, outlines, storey }
    };
    let (mut moved, mut figures) = (Vec::new(), Vec::new());
    for edit in edits {
        let found = mover.edit(edit)?;
        figures.extend(found.figures.into_iter().map(|(id, names)| StaleFigures {
            id,
            global_id: named(id, None).global_id,
            names,
        }));
        let on_tails = found.tails.iter().flat_map(|t| length::grows(&building, t.id).into_iter().skip(1));
        let whole: Vec<u64> = found.products.iter().copied().chain(on_tails).collect();
        let tails = found.tails.into_iter().map(|t| named(t.id, Some(t.outlines)));
        moved.push(whole.into_iter().map(|id| named(id, None)).chain(tails).collect());
    }
    let bounded = |room: rooms::Room| BoundedRoom {
        id: room.id,
        global_id: step.args(room.id).first().and_then(|a| step.text(a)).unwrap_or_default(),
        name: building
            .model
            .product(room.id)
            .map_or_else(String::new, |p| building.space_names(p).names.join(" ")),
        outlines: room.outlines,
        quantities: room.quantities,
        boundaries: room.boundaries,
    };
    let rooms = mover.rooms().into_iter().map(bounded).collect();
    Ok(Effects { moved, rooms, figures, unseen: unseen::left(&building, options, edits) })
}

/// How many elements of a kind a whole file has, subtypes counted in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Elements {
    /// `IfcBuildingStorey`.
    pub storeys: u64,
    /// `IfcWall`.
    pub walls: u64,
    /// `IfcColumn`.
    pub columns: u64,
    /// `IfcDoor`.
    pub doors: u64,
    /// `IfcWindow`.
    pub windows: u64,
    /// `IfcSpace`.
    pub spaces: u64,
}

impl Elements {
    fn of(step: &Step<'_>) -> Self {
        let count = |kinds: &[&str]| kinds.iter().map(|k| step.all(k).count() as u64).sum();
        Self {
            storeys: count(&["IFCBUILDINGSTOREY"]),
            walls: count(&["IFCWALL", "IFCWALLSTANDARDCASE", "IFCWALLELEMENTEDCASE"]),
            columns: count(&["IFCCOLUMN", "IFCCOLUMNSTANDARDCASE"]),
            doors: count(&["IFCDOOR", "IFCDOORSTANDARDCASE"]),
            windows: count(&["IFCWINDOW", "IFCWINDOWSTANDARDCASE"]),
            spaces: count(&["IFCSPACE"]),
        }
    }
}

/// What a building has.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Inventory {
    /// How much there is of what.
    pub elements: Elements,
    /// `GlobalId` → class.
    pub classes: BTreeMap<String, String>,
    /// `GlobalId` of a door or window → that of the wall in whose opening it sits.
    pub hosts: BTreeMap<String, String>,
    /// Storeys from the lowest.
    pub storeys: Vec<StoreyInfo>,
    /// `GlobalId` of an element → the storey in which it stands, its place in `storeys`.
    pub storey_of: BTreeMap<String, usize>,
    /// `GlobalId` of a space → what it is called.
    pub spaces: BTreeMap<String, SpaceNames>,
    /// How many elements, spaces and zones bear marks.
    pub marked: usize,
}

/// How many elements, spaces and zones bear a `Pset_Enfilade`.
fn count_marked(building: &Building<'_, '_>) -> usize {
    let step = building.step;
    let is_ours = |i: &&step::Instance| {
        step.args_of(i).get(2).and_then(|a| step.text(a)).is_some_and(|n| model::is_ours(&n))
    };
    let sets: BTreeSet<u64> = step.all("IFCPROPERTYSET").filter(is_ours).map(|i| i.id).collect();
    building.model.properties.values().filter(|of| of.iter().any(|s| sets.contains(s))).count()
}

/// Classes, hosts and storeys of a building; nothing of a file that cannot be read.
pub fn inventory(bytes: &[u8], unit: Option<Unit>) -> Inventory {
    let Ok(step) = open("", bytes) else { return Inventory::default() };
    let building = Building::new("", &step, unit);
    let products = building.model.products.iter().chain(&building.model.fillers);
    let mut classes: BTreeMap<String, String> = BTreeMap::new();
    for i in step.all("IFCSLAB").chain(step.all("IFCCOVERING")).chain(step.all("IFCROOF")) {
        if let Some(global_id) = step.args_of(i).first().and_then(|a| step.text(a)) {
            classes.insert(global_id, "IfcSlab".into());
        }
    }
    classes.extend(products.map(|p| (p.global_id.clone(), p.class.to_string())));
    let by_id: BTreeMap<u64, &str> = {
        let all = building.model.products.iter().chain(&building.model.fillers);
        all.map(|p| (p.id, p.global_id.as_str())).collect()
    };
    let name = |id: &u64| by_id.get(id).map(|n| (*n).to_owned());
    let hosts = building.model.hosts();
    let hosts = hosts.iter().filter_map(|(filler, wall)| Some((name(filler)?, name(wall)?))).collect();
    let spaces = building.model.products.iter().filter(|p| p.class == "IfcSpace");
    let spaces = spaces.map(|p| (p.global_id.clone(), building.space_names(p))).collect();
    let place: HashMap<u64, usize> =
        building.model.storeys.iter().enumerate().map(|(i, s)| (s.id, i)).collect();
    let standing = |p: &model::Product| {
        let of = building.model.storey_of(p.id)?;
        Some((p.global_id.clone(), *place.get(&of)?))
    };
    let storey_of =
        building.model.products.iter().chain(&building.model.fillers).filter_map(standing).collect();
    Inventory {
        elements: Elements::of(&step),
        classes,
        hosts,
        storeys: storeys(&building),
        storey_of,
        spaces,
        marked: count_marked(&building),
    }
}

/// `Tag` of products: the element's id in the program that wrote the file; the `GlobalId` where there is none.
pub fn tags(bytes: &[u8], ids: &[usize]) -> Vec<Option<String>> {
    let Ok(step) = Step::read(bytes) else { return vec![None; ids.len()] };
    let tag = |id: &usize| {
        let args = step.args(*id as u64);
        [7, 0].iter().find_map(|i| args.get(*i).and_then(|a| step.text(a)).filter(|t| !t.trim().is_empty()))
    };
    ids.iter().map(tag).collect()
}

/// Where the last instance before the end of the data ends, behind its semicolon; where there is none, that end.
fn instances_end(step: &Step<'_>) -> usize {
    let inside = step.instances.iter().rev().find(|i| i.span.end <= step.data_end);
    inside.map_or(step.data_end, |i| i.span.end)
}

/// The bytes without what [`patch`] added.
pub fn strip_own(bytes: &[u8]) -> Cow<'_, [u8]> {
    let Some(at) = memchr::memmem::rfind(bytes, OWN_MARK) else {
        return Cow::Borrowed(bytes);
    };
    let Ok(step) = Step::read(bytes) else { return Cow::Borrowed(bytes) };
    let end = instances_end(&step);
    if end <= at {
        return Cow::Borrowed(bytes);
    }
    // Behind a semicolon stands the one line end that was added, whichever is the file's: some mix them.
    let before = bytes[..at].strip_suffix(b"\n").unwrap_or(&bytes[..at]);
    let before = before.strip_suffix(b"\r").unwrap_or(before);
    Cow::Owned([before, &bytes[end..]].concat())
}

/// How lines end in a file.
fn line_end(bytes: &[u8]) -> &'static [u8] {
    match bytes.iter().position(|b| *b == b'\n') {
        Some(at) if at > 0 && bytes[at - 1] == b'\r' => b"\r\n",
        None if bytes.contains(&b'\r') => b"\r",
        _ => b"\n",
    }
}

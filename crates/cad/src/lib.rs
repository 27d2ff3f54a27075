//! Exchange formats: one deep module a format, read and patch together, and the choice between them.
//!
//! A wall is opened, moved at one end and written; nothing else changes:
//!
//! ```
//! use enfilade_cad::drawing::{Edit, Shape};
//! use enfilade_cad::{ReadOptions, patch, read};
//! use enfilade_report::Report;
//!
//! let dxf = "0\nSECTION\n2\nENTITIES\n0\nLINE\n8\nWALLS\n10\n0.0\n20\n0.0\n11\n4.0\n21\n0.0\n0\nENDSEC\n0\nEOF\n";
//! let options = ReadOptions::default();
//! let drawing = read("room.dxf", dxf.as_bytes(), &options, &mut Report::default())?;
//!
//! let wall = &drawing.entities[0];
//! let Shape::Line { a, mut b } = wall.shape.clone() else { panic!("a line was drawn") };
//! b.x = 5.5;
//! let edit = Edit::Shape { record: wall.source.record, shape: Shape::Line { a, b } };
//! let written = patch("room.dxf", dxf.as_bytes(), &options, &[edit], &[])?;
//!
//! assert_eq!(String::from_utf8_lossy(&written), dxf.replace("4.0", "5.5"));
//! # Ok::<(), enfilade_report::Error>(())
//! ```

pub mod bearing;
pub mod curve;
pub mod drawing;
pub mod dxf;
mod foreign;
mod giants;
pub mod gltf;
pub mod ifc;
pub mod layers;
pub mod marking;
pub mod names;
pub mod own_layers;
mod phase;
pub mod plane;
mod region;
pub mod rings;
pub mod roles;
mod room_outline;
pub mod sizes;
mod splice;
mod stamp;
mod step_text;
pub mod storey_words;
mod storeys;
pub mod things;
pub mod units;
pub mod wish;

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::sync::Arc;

use glam::DVec2;

use crate::drawing::{Addition, Drawing, Edit, Format, Unit};
pub use dxf::{ChangedRecord, Completeness};
use enfilade_report::{Error, Place, Report};
pub use stamp::timeless;
pub use storeys::*;

/// How to read a drawing of any format.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReadOptions {
    /// Takes DXF files of programs that never write `0/EOF`.
    pub accept_missing_eof: bool,
    /// Storey of a building; `None`: the one with most walls.
    pub storey: Option<String>,
    /// Height at which a building is cut.
    pub sight: ifc::Sight,
    /// The user's word for the unit of a building: its heights are taken in it too.
    pub unit: Option<Unit>,
    /// Whether the user names the layers that carry walls.
    pub is_by_user: bool,
    /// Whether the glass of curtain walls stops sight: the user names them as walls.
    pub is_glass_wall: bool,
    /// What the IFC that a glTF was made from knows: classes and storeys by `GlobalId`.
    pub twin: Option<Arc<ifc::Inventory>>,
    /// Files of data beside a scene, by name ([`gltf::outer_files`]).
    pub buffers: BTreeMap<String, Arc<[u8]>>,
    /// Pictures beside a scene, by name.
    pub pictures: BTreeSet<String>,
}

/// What a space is called.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SpaceNames {
    /// Its own names, the short one first.
    pub names: Vec<String>,
    /// Those of the zones that it is in.
    pub zones: Vec<String>,
}

impl ReadOptions {
    fn dxf(&self) -> dxf::ReadOptions {
        dxf::ReadOptions {
            accept_missing_eof: self.accept_missing_eof,
            unit_of_heights: self.unit,
            storey: self.storey.clone(),
            sight: self.sight,
            ..Default::default()
        }
    }

    /// Height of the cut above a storey's floor, metres.
    pub fn cut_m(&self) -> f64 {
        self.sight.above_m()
    }

    fn gltf(&self) -> gltf::ReadOptions {
        gltf::ReadOptions {
            is_knee: self.sight == ifc::Sight::Knee,
            is_by_user: self.is_by_user,
            storey: self.storey.clone(),
            unit: self.unit,
            twin: self.twin.clone(),
            buffers: self.buffers.clone(),
            pictures: self.pictures.clone(),
        }
    }

    fn ifc(&self) -> ifc::ReadOptions {
        ifc::ReadOptions {
            storey: self.storey.clone(),
            sight: self.sight,
            unit: self.unit,
            is_glass_wall: self.is_glass_wall,
        }
    }
}

/// File name endings that are read, lower case.
pub const ENDINGS: [&str; 5] = ["dxf", "ifc", "ifczip", "gltf", "glb"];

/// The format of a file: by its first bytes, else by its ending, else DXF.
pub fn format_of(file: &str, bytes: &[u8]) -> Format {
    let start = bytes.iter().position(|b| !b.is_ascii_whitespace()).unwrap_or(0);
    let head = bytes[start..].get(..16).unwrap_or(&bytes[start..]).to_ascii_uppercase();
    let head = head.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(&head);
    let ending = file.rsplit('.').next().unwrap_or_default().to_lowercase();
    match ending.as_str() {
        _ if gltf::is_glb(bytes) => Format::Glb,
        _ if head.starts_with(b"ISO-10303-21") => Format::Ifc,
        "glb" => Format::Glb,
        "gltf" => Format::Gltf,
        e if e.starts_with("ifc") => Format::Ifc,
        _ => Format::Dxf,
    }
}

/// The bytes that are read and patched: unpacked, and without result layers of ours.
pub fn plain<'a>(file: &str, bytes: &'a [u8]) -> Cow<'a, [u8]> {
    match format_of(file, bytes) {
        Format::Dxf => {
            let clean = dxf::strip_own(bytes);
            if clean.len() == bytes.len() { Cow::Borrowed(bytes) } else { Cow::Owned(clean) }
        }
        Format::Ifc => match ifc::is_zip(bytes).then(|| ifc::unzip(file, bytes)) {
            Some(Ok(unpacked)) => Cow::Owned(ifc::strip_own(&unpacked).into_owned()),
            _ => ifc::strip_own(bytes),
        },
        Format::Gltf | Format::Glb => Cow::Borrowed(bytes),
    }
}

/// Reads a drawing.
///
/// # Errors
/// [`Error::Input`] when the bytes cannot be used; [`Error::Usage`] for a storey that is not there.
pub fn read(file: &str, bytes: &[u8], options: &ReadOptions, report: &mut Report) -> Result<Drawing, Error> {
    let format = format_of(file, bytes);
    if let Some((what, hint)) = no_building(format, bytes) {
        let text = format!("the file, found {what}, expected a building (IFC or glTF); not read. {hint}");
        return Err(Error::input("other-format", Place::file(file), text));
    }
    let mut drawing = match format {
        Format::Dxf => dxf::read(file, bytes, &options.dxf(), report),
        Format::Ifc if ifc::is_zip(bytes) => {
            ifc::read(file, &ifc::unzip(file, bytes)?, &options.ifc(), report)
        }
        Format::Ifc => ifc::read(file, bytes, &options.ifc(), report),
        Format::Gltf | Format::Glb => gltf::read(file, bytes, &options.gltf(), report),
    }?;
    giants::leave_out(&mut drawing, report);
    Ok(drawing)
}

/// A drawing taken apart once, to be read as often as wanted.
#[derive(Clone, Debug)]
pub struct Opened<'a> {
    file: &'a str,
    bytes: &'a [u8],
    /// Of an IFC that is not packed.
    ifc: Option<ifc::Opened<'a>>,
}

impl<'a> Opened<'a> {
    /// Takes a drawing apart where that is most of the work; `file` is its name to show.
    ///
    /// # Errors
    /// [`Error::Input`] when an IFC cannot be used; of the other formats, reading says so.
    pub fn new(file: &'a str, bytes: &'a [u8]) -> Result<Self, Error> {
        let format = format_of(file, bytes);
        let is_plain_ifc =
            format == Format::Ifc && !ifc::is_zip(bytes) && no_building(format, bytes).is_none();
        let ifc = is_plain_ifc.then(|| ifc::Opened::new(file, bytes)).transpose()?;
        Ok(Self { file, bytes, ifc })
    }

    /// Reads it.
    ///
    /// # Errors
    /// As the function [`read`].
    pub fn read(&self, options: &ReadOptions, report: &mut Report) -> Result<Drawing, Error> {
        let Some(ifc) = &self.ifc else { return read(self.file, self.bytes, options, report) };
        let mut drawing = ifc.read(&options.ifc(), report)?;
        giants::leave_out(&mut drawing, report);
        Ok(drawing)
    }

    /// Reads one drawing for each of the options, each with a report of its own.
    ///
    /// # Errors
    /// For each as the function [`read`].
    pub fn read_all(&self, options: &[ReadOptions]) -> Vec<(Result<Drawing, Error>, Report)> {
        if let Some(ifc) = &self.ifc {
            let options: Vec<ifc::ReadOptions> = options.iter().map(ReadOptions::ifc).collect();
            let mut read = ifc.read_all(&options);
            for (drawing, report) in &mut read {
                drawing.iter_mut().for_each(|d| giants::leave_out(d, report));
            }
            return read;
        }
        let one = |o: &ReadOptions| {
            let mut report = Report::default();
            (self.read(o, &mut report), report)
        };
        options.iter().map(one).collect()
    }

    /// Storeys of a building from the lowest, and what it has; nothing where the file (or the IFC beside it)
    /// knows none. Of a scene without an IFC: those that its nodes are named by, or that its walls stand on.
    pub fn building(&self, options: &ReadOptions) -> (Vec<StoreyInfo>, Option<ifc::Elements>) {
        if let Some(ifc) = &self.ifc {
            let (storeys, elements) = ifc.building(options.unit);
            return (storeys, Some(elements));
        }
        match (format_of(self.file, self.bytes), &options.twin) {
            (Format::Dxf, _) => (dxf::storeys(self.file, self.bytes, &options.dxf()), None),
            (Format::Ifc, _) => {
                let found = ifc::inventory(&plain(self.file, self.bytes), options.unit);
                (found.storeys, Some(found.elements))
            }
            (Format::Gltf | Format::Glb, twin) => {
                let own = options.gltf();
                let twin = twin.as_ref().filter(|_| gltf::uses_twin(self.file, self.bytes, &own));
                (gltf::storeys(self.file, self.bytes, &own), twin.map(|t| t.elements))
            }
        }
    }
}

/// Storeys of a building from the lowest; none where the file (or the IFC beside it) knows none.
pub fn storeys(file: &str, bytes: &[u8], options: &ReadOptions) -> Vec<StoreyInfo> {
    Opened::new(file, bytes).map_or_else(|_| Vec::new(), |opened| opened.building(options).0)
}

/// The file's own bytes with the edits made and the additions put in.
///
/// # Errors
/// [`Error::Input`] where an edit does not fit what it names; nothing is to be written then.
pub fn patch(
    file: &str,
    bytes: &[u8],
    options: &ReadOptions,
    edits: &[Edit],
    additions: &[Addition],
) -> Result<Vec<u8>, Error> {
    // What moves by nothing keeps its bytes, however its numbers are written.
    let edits: Vec<Edit> = edits.iter().filter(|e| !e.is_still()).cloned().collect();
    let edits = edits.as_slice();
    match format_of(file, bytes) {
        Format::Dxf => dxf::patch_read(file, bytes, &options.dxf(), edits, additions),
        Format::Ifc => ifc::patch(file, bytes, &options.ifc(), edits, additions),
        Format::Gltf | Format::Glb => gltf::patch(file, bytes, &options.gltf(), edits, additions),
    }
}

/// The bytes without what was demolished, and how many entities or elements that was. A scene keeps all.
///
/// # Errors
/// [`Error::Input`] where the bytes are none of their format; nothing is to be written then.
pub fn without_demolished(file: &str, bytes: &[u8]) -> Result<(Vec<u8>, usize), Error> {
    match format_of(file, bytes) {
        Format::Dxf => dxf::without_demolished(file, bytes),
        Format::Ifc => ifc::without_demolished(file, bytes),
        Format::Gltf | Format::Glb => Ok((bytes.to_vec(), 0)),
    }
}

/// A record that differs, as results name it.
#[derive(Clone, Debug, PartialEq)]
pub struct Changed {
    /// Its number and name.
    pub of: ChangedRecord,
    /// Its class where it is a door or a window of a building.
    pub filler: Option<&'static str>,
    /// Of a wall that the plan does not show, its outline before and after, drawing units.
    pub outlines: Option<[Vec<DVec2>; 2]>,
    /// The storey of such a wall.
    pub storey: Option<String>,
}

/// What edits change: for every edit the records of a DXF or the products of a building, and joints with walls that the
/// plan does not show and that stay.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Changes {
    /// For every edit what differs.
    pub records: Vec<Vec<Changed>>,
    /// Rooms of a building that moved walls bound.
    pub rooms: Vec<ifc::BoundedRoom>,
    /// Figures of walls that change their length.
    pub figures: Vec<ifc::StaleFigures>,
    /// Joints of walls that the plan does not show.
    pub unseen: Vec<ifc::UnseenJoint>,
}

/// What edits change.
///
/// # Errors
/// As [`patch`].
pub fn changes(file: &str, bytes: &[u8], options: &ReadOptions, edits: &[Edit]) -> Result<Changes, Error> {
    let plain = |of: ChangedRecord| Changed { of, filler: None, outlines: None, storey: None };
    let records = match format_of(file, bytes) {
        Format::Dxf => {
            let found = dxf::changed_records(file, bytes, edits)?;
            found.into_iter().map(|list| list.into_iter().map(plain).collect()).collect()
        }
        Format::Ifc => {
            let found = ifc::effects(file, bytes, &options.ifc(), edits)?;
            let named = |p: ifc::MovedProduct| {
                let of = ChangedRecord { record: p.id as usize, handle: Some(p.global_id) };
                Changed { of, filler: p.filler, outlines: p.outlines, storey: p.storey }
            };
            let records = found.moved.into_iter().map(|list| list.into_iter().map(named).collect());
            let (rooms, figures, unseen) = (found.rooms, found.figures, found.unseen);
            return Ok(Changes { records: records.collect(), rooms, figures, unseen });
        }
        Format::Gltf | Format::Glb => {
            let of = |e: &Edit| ChangedRecord { record: e.record(), handle: Some(gltf::path_of(e.record())) };
            edits.iter().map(|e| vec![plain(of(e))]).collect()
        }
    };
    Ok(Changes { records, ..Changes::default() })
}

/// Ids of elements in the program that wrote the file.
pub fn host_ids(file: &str, bytes: &[u8], records: &[usize]) -> Vec<Option<String>> {
    match format_of(file, bytes) {
        Format::Dxf => dxf::host_ids(bytes, records),
        Format::Ifc => ifc::tags(bytes, records),
        Format::Gltf | Format::Glb => vec![None; records.len()],
    }
}

/// What is tied to the records that `edits` change: filled areas that go along, none of `held`, and annotation that does not
/// follow. Buildings and scenes have none. `metres`: those of a drawing unit.
///
/// # Errors
/// As reading.
pub fn tied(
    file: &str,
    bytes: &[u8],
    options: &ReadOptions,
    edits: &[Edit],
    (held, metres): (&HashSet<usize>, f64),
) -> Result<dxf::Tied, Error> {
    match format_of(file, bytes) {
        Format::Dxf => {
            let drawing = dxf::read(file, bytes, &options.dxf(), &mut Report::default())?;
            dxf::tied(file, bytes, &drawing, edits, (held, metres))
        }
        Format::Ifc | Format::Gltf | Format::Glb => Ok(dxf::Tied::default()),
    }
}

/// What the bytes are, where a file with the name of a building is none. DXF has its own words for it.
fn no_building(format: Format, bytes: &[u8]) -> Option<(String, &'static str)> {
    match format {
        Format::Dxf => None,
        Format::Glb if gltf::is_glb(bytes) => None,
        Format::Ifc if ifc::is_zip(bytes) || ifc::is_xml(bytes) => None,
        Format::Ifc | Format::Gltf | Format::Glb => {
            foreign::as_utf16(bytes).or_else(|| foreign::kind_of(bytes))
        }
    }
}

/// Whether a file is whole.
pub fn is_complete(file: &str, bytes: &[u8]) -> Completeness {
    if bytes.is_empty() {
        return Completeness::Empty;
    }
    let format = format_of(file, bytes);
    let is_building_as_xml = format == Format::Ifc && ifc::is_xml(bytes);
    if is_building_as_xml || no_building(format, bytes).is_some() {
        // Nothing will make it one: reading refuses it by name.
        return Completeness::Whole;
    }
    match format {
        Format::Dxf => dxf::is_complete(bytes),
        Format::Ifc => match ifc::completeness(bytes) {
            ifc::Incomplete::No => Completeness::Whole,
            ifc::Incomplete::Because(why) => Completeness::Incomplete(why),
        },
        Format::Gltf | Format::Glb => {
            gltf::incomplete(bytes).map_or(Completeness::Whole, Completeness::Incomplete)
        }
    }
}

//! Edits and additions to bytes: only the values that differ are replaced.

use std::borrow::Cow;
use std::f64::consts::PI;

use glam::DVec2;

use super::ReadOptions;
use super::additions::{self, Writer};
use super::blocks::Blocks;
use super::curves::is_upright;
use super::fields::{
    Fields, attributes, handle_of, has_embedded_object, lwpolyline_vertices, point_slots, polyline_records,
};
use super::header::Header;
use super::limits::Limits;
use super::opened::Place as Placed;
use super::poche::points_of;
use super::read::{fault_error, floor_of};
use super::reader::Reader;
use super::tokens::{Form, Kind, Tokens, kind_of, number_text, tokenize, trim};
use crate::drawing::{Addition, Edit, RigidMotion, Shape, Vertex};
use crate::splice::{Splice, apply};
use enfilade_report::{Error, Place, Report};

/// Differences below this many times the rounding step of an entity's largest coordinate are what
/// changing frames leaves behind, no move.
const NOISE_STEPS: f64 = 4.0;

/// Differences of angles below this (degrees; 0.2 µm at 10 km) are rounding, no turn.
const NOISE_DEG: f64 = 1e-9;

/// A record whose values an edit changes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ChangedRecord {
    /// Which group-0 record of the file, from 0.
    pub record: usize,
    /// Its handle, if it has one.
    pub handle: Option<String>,
}

/// The drawing with the edits made and the additions put on their layers.
///
/// Only values that differ are replaced, line ends and everything else stay; no edits and no additions
/// give the same bytes. Additions get fresh handles (`$HANDSEED` follows) and, where the file has a
/// layer table, layers of their own. A file without a layer table (allowed in R12) gets none: CAD
/// programs make a layer where an entity names one.
///
/// # Errors
/// [`Error::Input`] where an edit does not fit the record it names, asks for a value the record does not
/// have (a bulge, a rotation), or is not finite; and where the bytes are no DXF.
pub fn patch(file: &str, bytes: &[u8], edits: &[Edit], additions: &[Addition]) -> Result<Vec<u8>, Error> {
    patch_read(file, bytes, &ReadOptions::default(), edits, additions)
}

/// [`patch`] of a drawing as it was read: what is drawn anew lies on the floor of the storey.
///
/// # Errors
/// As [`patch`].
pub fn patch_read(
    file: &str,
    bytes: &[u8],
    options: &ReadOptions,
    edits: &[Edit],
    additions: &[Addition],
) -> Result<Vec<u8>, Error> {
    if edits.is_empty() && additions.is_empty() {
        return Ok(bytes.to_vec());
    }
    let tokens = tokens_of(file, bytes)?;
    let writer = writer_for(file, &tokens, edits, additions)?;
    let mut writer = writer.map(|writer| writer.on(floor_of(file, bytes, &tokens, options)));
    let mut splices: Vec<Splice> =
        edit_splices(file, &tokens, edits, writer.as_mut())?.into_iter().flatten().map(|(_, s)| s).collect();
    if let Some(writer) = writer {
        additions::splice_in(file, additions, writer, &mut splices)?;
    }
    apply(file, "dxf-edit-twice", bytes, splices)
}

/// The records each edit changes, in file order: a POLYLINE's are its VERTEX records, an INSERT's also
/// its attributes. An edit that changes nothing has none.
///
/// # Errors
/// As [`patch`].
pub fn changed_records(file: &str, bytes: &[u8], edits: &[Edit]) -> Result<Vec<Vec<ChangedRecord>>, Error> {
    let tokens = tokens_of(file, bytes)?;
    let mut writer = writer_for(file, &tokens, edits, &[])?;
    let splices = edit_splices(file, &tokens, edits, writer.as_mut())?;
    let named = |splices: Vec<(usize, Splice)>| {
        let mut records: Vec<usize> = splices.into_iter().map(|(record, _)| record).collect();
        records.dedup();
        records
            .into_iter()
            .map(|record| ChangedRecord { record, handle: handle_of(&tokens, record) })
            .collect()
    };
    Ok(splices.into_iter().map(named).collect())
}

/// A writer where anything is drawn.
fn writer_for<'t, 'a>(
    file: &str,
    tokens: &'t Tokens<'a>,
    edits: &[Edit],
    additions: &[Addition],
) -> Result<Option<Writer<'t, 'a>>, Error> {
    let is_drawn = !additions.is_empty() || edits.iter().any(Edit::is_work);
    is_drawn.then(|| Writer::for_file(file, tokens)).transpose()
}

/// The pairs of a file that is to be written.
pub(super) fn tokens_of<'a>(file: &str, bytes: &'a [u8]) -> Result<Tokens<'a>, Error> {
    let options = ReadOptions { limits: Limits::default(), ..ReadOptions::default() };
    tokenize(bytes, &options.limits).map_err(|fault| fault_error(file, bytes, fault, &options))
}

type RecordSplices = Vec<(usize, Splice)>;

fn edit_splices<'t, 'a>(
    file: &str,
    tokens: &'t Tokens<'a>,
    edits: &[Edit],
    mut writer: Option<&mut Writer<'t, 'a>>,
) -> Result<Vec<RecordSplices>, Error> {
    let section = tokens.section(b"ENTITIES").unwrap_or(0..0);
    let edits = definition_edits(file, tokens, edits)?;
    let edits = edits.as_ref();
    let defined = tokens.section(b"BLOCKS").unwrap_or(0..0);
    let is_moved =
        |of: usize| edits.iter().any(|e| matches!(e, Edit::Insert { record, .. } if *record == of));
    let ends_of = |of: usize| {
        edits.iter().find_map(|e| match e {
            Edit::Ends { record, by } if *record == of => Some(*by),
            _ => None,
        })
    };
    edits
        .iter()
        .map(|edit| {
            let record = &edit.record();
            let mut editor = Editor { file, tokens, record: *record, noise: 0.0, out: Vec::new() };
            if !section.contains(record) && !defined.contains(record) {
                return Err(editor.fault("no entity of model space stands there"));
            }
            match edit {
                Edit::Shape { shape, .. } => editor.shape(shape)?,
                Edit::Insert { motion, .. } => match ends_of(*record) {
                    Some(by) => editor.multiline(Some(motion), by)?,
                    None => editor.insert(motion)?,
                },
                Edit::Points { points, .. } => editor.points(points)?,
                // With its motion, which says all.
                Edit::Ends { .. } if is_moved(*record) => {}
                Edit::Ends { by, .. } => editor.multiline(None, *by)?,
                Edit::Work { work, .. } => match writer.as_deref_mut() {
                    Some(writer) => editor.work(work, writer)?,
                    None => return Err(editor.fault("nothing can be drawn here")),
                },
            }
            Ok(editor.out)
        })
        .collect()
}

/// The edits, those of what a block shows once as edits of its definition.
fn definition_edits<'e>(
    file: &str,
    tokens: &Tokens<'_>,
    edits: &'e [Edit],
) -> Result<Cow<'e, [Edit]>, Error> {
    let Some(defined) = tokens.section(b"BLOCKS") else { return Ok(Cow::Borrowed(edits)) };
    if !edits.iter().any(|e| defined.contains(&e.record())) {
        return Ok(Cow::Borrowed(edits));
    }
    let (header, mut report) = (Header::read(tokens), Report::default());
    let options = ReadOptions::default();
    let mut reader = Reader::new(file, tokens, &header, &options, &mut report);
    let blocks = Blocks::find(&reader)?;
    let mut inner = |edit: &Edit| {
        let record = edit.record();
        if !defined.contains(&record) {
            return Ok(edit.clone());
        }
        let editor = Editor { file, tokens, record, noise: 0.0, out: Vec::new() };
        let place = Placed::of(&mut reader, &blocks, record);
        let place = place.ok_or_else(|| editor.fault("no entity stands there that is shown exactly once"))?;
        let changed = match edit {
            Edit::Shape { shape, .. } => {
                let drawn = Placed::drawn(&mut reader, record);
                let back = drawn.and_then(|drawn| place.shape_back(shape, &drawn));
                let back = back.ok_or_else(|| editor.fault("its kind and the new shape differ"))?;
                Edit::Shape { record, shape: back }
            }
            Edit::Insert { motion, .. } => {
                let motion = place.motion_back(motion);
                let motion =
                    motion.ok_or_else(|| editor.fault("what shows it stretches it: it does not turn"))?;
                Edit::Insert { record, motion }
            }
            Edit::Work { work, .. } => {
                let work = place.work_back(work).ok_or_else(|| editor.fault("what shows it stretches it"))?;
                Edit::Work { record, work }
            }
            Edit::Ends { .. } | Edit::Points { .. } => edit.clone(),
        };
        Ok(changed)
    };
    Ok(Cow::Owned(edits.iter().map(&mut inner).collect::<Result<_, Error>>()?))
}

/// One edit of one entity.
pub(super) struct Editor<'t, 'a> {
    file: &'t str,
    pub(super) tokens: &'t Tokens<'a>,
    pub(super) record: usize,
    /// Differences up to this, drawing units, are none.
    noise: f64,
    pub(super) out: RecordSplices,
}

impl Editor<'_, '_> {
    pub(super) fn fault(&self, reason: &str) -> Error {
        let text = format!("the edit of record {}: {reason}; nothing was written", self.record);
        let is_record = self.record < self.tokens.records.len();
        let line = is_record.then(|| self.tokens.line(self.tokens.span(self.record).start));
        let entity = if is_record {
            let name = super::tokens::shown(self.tokens.name(self.record));
            handle_of(self.tokens, self.record).map_or(name.clone(), |handle| format!("{name} {handle}"))
        } else {
            String::new()
        };
        Error::input("dxf-edit", Place { file: self.file.into(), line, entity }, text)
    }

    pub(super) fn number(&self, index: usize) -> Result<f64, Error> {
        let number = self.tokens.number(&self.tokens.pairs[index]);
        number.ok_or_else(|| self.fault("a value to change is no number"))
    }

    /// Whether the record's plane is turned over, so that x and angles run the other way.
    pub(super) fn is_mirrored(&self, fields: &Fields<'_, '_>) -> Result<bool, Error> {
        let value = |code| fields.index(code).map(|i| self.number(i)).transpose();
        let (x, y, z) = (value(210)?, value(220)?, value(230)?);
        if x.is_none() && y.is_none() && z.is_none() {
            return Ok(false);
        }
        let extrusion = glam::DVec3::new(x.unwrap_or(0.0), y.unwrap_or(0.0), z.unwrap_or(1.0));
        if !is_upright(extrusion) {
            return Err(self.fault("it is drawn in a tilted plane"));
        }
        Ok(extrusion.z < 0.0)
    }

    /// Sets the noise level from the coordinates an edit deals with.
    pub(super) fn listen(&mut self, points: impl IntoIterator<Item = DVec2>) -> Result<(), Error> {
        let mut largest: f64 = 0.0;
        for p in points {
            if !p.is_finite() {
                return Err(self.fault("the new coordinates are not finite"));
            }
            largest = largest.max(p.abs().max_element());
        }
        self.noise = NOISE_STEPS * f64::EPSILON * largest;
        Ok(())
    }

    /// Replaces the number of a pair.
    fn write(&mut self, record: usize, index: usize, value: f64) {
        let pair = &self.tokens.pairs[index];
        let raw = self.tokens.raw(pair);
        let (start, len) = match self.tokens.form {
            Form::Binary { .. } => (pair.start as usize, raw.len()),
            Form::Ascii => {
                let value = trim(raw);
                (pair.start as usize + (value.as_ptr() as usize - raw.as_ptr() as usize), value.len())
            }
        };
        let with = match self.tokens.form {
            Form::Binary { .. } if kind_of(pair.code) == Kind::Double => value.to_le_bytes().to_vec(),
            _ => number_text(value).into_bytes(),
        };
        self.out.push((record, Splice { start, end: start + len, with }));
    }

    /// Writes a length where it differs from the one that stands there.
    fn length(&mut self, record: usize, index: Option<usize>, new: f64) -> Result<(), Error> {
        let index = index.ok_or_else(|| self.fault("it has no value where one must change"))?;
        if (self.number(index)? - new).abs() > self.noise {
            self.write(record, index, new);
        }
        Ok(())
    }

    /// Writes a world point at groups `code`, `code + 10`.
    fn point(
        &mut self,
        fields: &Fields<'_, '_>,
        code: i32,
        new: DVec2,
        is_mirrored: bool,
    ) -> Result<(), Error> {
        let x = if is_mirrored { -new.x } else { new.x };
        self.length(fields.record, fields.index(code), x)?;
        self.length(fields.record, fields.index(code + 10), new.y)
    }

    /// Writes an angle (degrees, the record's own direction) where it differs by more than full turns.
    fn angle(
        &mut self,
        fields: &Fields<'_, '_>,
        code: i32,
        new_deg: f64,
        default_deg: f64,
    ) -> Result<(), Error> {
        let index = fields.index(code);
        let old = index.map_or(Ok(default_deg), |i| self.number(i))?;
        let difference = (new_deg - old).rem_euclid(360.0);
        if difference.min(360.0 - difference) <= NOISE_DEG.max(NOISE_STEPS * f64::EPSILON * old.abs()) {
            return Ok(());
        }
        let index = index.ok_or_else(|| self.fault("it has no value for the angle that must change"))?;
        if !new_deg.is_finite() {
            return Err(self.fault("the new angle is not finite"));
        }
        self.write(fields.record, index, new_deg.rem_euclid(360.0));
        Ok(())
    }

    fn bulge(&mut self, record: usize, index: Option<usize>, new: f64) -> Result<(), Error> {
        let old = index.map_or(Ok(0.0), |i| self.number(i))?;
        if (new - old).abs() <= NOISE_STEPS * f64::EPSILON * old.abs().max(1.0) {
            return Ok(());
        }
        let index = index.ok_or_else(|| self.fault("a straight piece has no bulge to change"))?;
        if !new.is_finite() {
            return Err(self.fault("the new bulge is not finite"));
        }
        self.write(record, index, new);
        Ok(())
    }

    pub(super) fn shape(&mut self, shape: &Shape) -> Result<(), Error> {
        let fields = Fields::of(self.tokens, self.record);
        match (self.tokens.name(self.record), shape) {
            (b"LINE", Shape::Line { a, b }) => {
                self.listen([*a, *b])?;
                self.point(&fields, 10, *a, false)?;
                self.point(&fields, 11, *b, false)
            }
            (b"LWPOLYLINE", Shape::Polyline { vertices, .. }) => self.lwpolyline(&fields, vertices),
            (b"POLYLINE", Shape::Polyline { vertices, .. }) => self.polyline(&fields, vertices),
            (b"CIRCLE", Shape::Circle { centre, radius }) => {
                let is_mirrored = self.is_mirrored(&fields)?;
                self.listen([*centre, DVec2::splat(*radius)])?;
                self.point(&fields, 10, *centre, is_mirrored)?;
                self.length(self.record, fields.index(40), *radius)
            }
            (b"ARC", Shape::Arc { centre, radius, start_rad, end_rad }) => {
                let is_mirrored = self.is_mirrored(&fields)?;
                self.listen([*centre, DVec2::splat(*radius)])?;
                self.point(&fields, 10, *centre, is_mirrored)?;
                self.length(self.record, fields.index(40), *radius)?;
                let (start, end) =
                    if is_mirrored { (PI - end_rad, PI - start_rad) } else { (*start_rad, *end_rad) };
                self.angle(&fields, 50, start.to_degrees(), 0.0)?;
                self.angle(&fields, 51, end.to_degrees(), 360.0)
            }
            _ => Err(self.fault("its kind and the new shape differ")),
        }
    }

    fn lwpolyline(&mut self, fields: &Fields<'_, '_>, vertices: &[Vertex]) -> Result<(), Error> {
        let slots = lwpolyline_vertices(self.tokens, self.record);
        if slots.len() != vertices.len() {
            return Err(self.fault("the number of vertices differs"));
        }
        let side = if self.is_mirrored(fields)? { -1.0 } else { 1.0 };
        self.listen(vertices.iter().map(|v| v.at))?;
        for (slot, v) in slots.iter().zip(vertices) {
            self.length(self.record, Some(slot.x), v.at.x * side)?;
            self.length(self.record, slot.y, v.at.y)?;
            self.bulge(self.record, slot.bulge, v.bulge * side)?;
        }
        Ok(())
    }

    fn polyline(&mut self, fields: &Fields<'_, '_>, vertices: &[Vertex]) -> Result<(), Error> {
        let (records, _, _) = polyline_records(self.tokens, self.record);
        if records.len() != vertices.len() {
            return Err(self.fault("the number of vertices differs"));
        }
        let flags = fields.pair(70).and_then(|p| self.tokens.integer(p)).unwrap_or(0);
        let is_mirrored = flags & 8 == 0 && self.is_mirrored(fields)?;
        let side = if is_mirrored { -1.0 } else { 1.0 };
        self.listen(vertices.iter().map(|v| v.at))?;
        for (record, v) in records.zip(vertices) {
            let vertex = Fields::of(self.tokens, record);
            self.point(&vertex, 10, v.at, is_mirrored)?;
            self.bulge(record, vertex.index(42), v.bulge * side)?;
        }
        Ok(())
    }

    fn insert(&mut self, motion: &RigidMotion) -> Result<(), Error> {
        let record = self.record;
        match self.tokens.name(record) {
            b"INSERT" => {
                self.rigid(record, motion, &[10], &[])?;
                for record in attributes(self.tokens, record) {
                    if has_embedded_object(self.tokens, record) {
                        return Err(
                            self.fault("it has an attribute of several lines, which would stay behind")
                        );
                    }
                    self.rigid(record, motion, &[10, 11], &[])?;
                }
                Ok(())
            }
            b"SPLINE" | b"MLINE" => self.rigid(record, motion, &[10, 11], &[12, 13]),
            b"ELLIPSE" => self.rigid(record, motion, &[10], &[11]),
            b"POLYLINE" => {
                let fields = Fields::of(self.tokens, record);
                if [210, 220, 230].iter().any(|&code| fields.index(code).is_some()) {
                    return Err(self.fault("it is a fitted curve in a plane of its own"));
                }
                let (vertices, _, _) = polyline_records(self.tokens, record);
                vertices.into_iter().try_for_each(|vertex| self.rigid(vertex, motion, &[10], &[]))
            }
            _ => Err(self.fault("it is nothing that moves as a whole")),
        }
    }

    /// Moves both ends of a straight multiline along it, and then all of it.
    fn multiline(&mut self, motion: Option<&RigidMotion>, by: [f64; 2]) -> Result<(), Error> {
        let record = self.record;
        let slots = match self.tokens.name(record) {
            b"MLINE" => point_slots(self.tokens, record, 11),
            _ => Vec::new(),
        };
        let [first, last] = slots[..] else {
            return Err(self.fault("it has no ends of its own to move"));
        };
        let still = RigidMotion { turn_rad: 0.0, shift: DVec2::ZERO };
        let motion = motion.unwrap_or(&still);
        let at = |editor: &mut Self, (x, y): (usize, Option<usize>)| {
            let y = y.ok_or_else(|| editor.fault("it has a point without y"))?;
            Ok::<_, Error>((x, y, DVec2::new(editor.number(x)?, editor.number(y)?)))
        };
        let ends = [at(self, first)?, at(self, last)?];
        let along = (ends[1].2 - ends[0].2).normalize_or_zero();
        let turn = DVec2::from_angle(motion.turn_rad);
        let fields = Fields::of(self.tokens, record);
        // Its start is said twice.
        let start = fields.index(10).map(|x| (x, fields.index(20)));
        let start = start.map(|slot| at(self, slot)).transpose()?;
        for ((x, y, old), by) in ends.into_iter().zip(by).chain(start.map(|s| (s, by[0]))) {
            let new = turn.rotate(old + along * by) + motion.shift;
            self.listen([old, new])?;
            self.length(record, Some(x), new.x)?;
            self.length(record, Some(y), new.y)?;
        }
        if motion.turn_rad != 0.0 {
            let turned = RigidMotion { shift: DVec2::ZERO, ..*motion };
            self.rigid(record, &turned, &[], &[12, 13])?;
        }
        Ok(())
    }

    /// Writes the points of a filled area.
    pub(super) fn points(&mut self, points: &[DVec2]) -> Result<(), Error> {
        let slots = points_of(self.tokens, self.record).unwrap_or_default();
        if slots.is_empty() || slots.len() != points.len() {
            return Err(self.fault("it is no filled area of so many points"));
        }
        let side = if self.is_mirrored(&Fields::of(self.tokens, self.record))? { -1.0 } else { 1.0 };
        self.listen(points.iter().copied())?;
        for (slot, p) in slots.iter().zip(points) {
            self.length(self.record, Some(slot.x), p.x * side)?;
            self.length(self.record, Some(slot.y), p.y)?;
        }
        Ok(())
    }

    /// Moves all points at `codes` (where present), turns the directions at `directions`, and turns the
    /// rotation of one record.
    fn rigid(
        &mut self,
        record: usize,
        motion: &RigidMotion,
        codes: &[i32],
        directions: &[i32],
    ) -> Result<(), Error> {
        let fields = Fields::of(self.tokens, record);
        let is_world = matches!(self.tokens.name(record), b"SPLINE" | b"ELLIPSE" | b"MLINE");
        let has_many = matches!(self.tokens.name(record), b"SPLINE" | b"MLINE");
        let is_mirrored = match self.tokens.name(record) {
            b"VERTEX" => false,
            // World coordinates whatever the plane; only to turn them it must lie flat.
            _ if is_world && motion.turn_rad == 0.0 => false,
            _ => self.is_mirrored(&fields)? && !is_world,
        };
        let side = if is_mirrored { -1.0 } else { 1.0 };
        let turn = DVec2::from_angle(motion.turn_rad);
        for &code in codes.iter().chain(directions) {
            let slots = match fields.index(code) {
                _ if has_many => point_slots(self.tokens, record, code),
                Some(x) => vec![(x, fields.index(code + 10))],
                None if code == 10 => return Err(self.fault("it has no insertion point to change")),
                None => Vec::new(),
            };
            let shift = if directions.contains(&code) { DVec2::ZERO } else { motion.shift };
            for (x, y) in slots {
                let y = y.ok_or_else(|| self.fault("it has a point without y"))?;
                let old = DVec2::new(self.number(x)? * side, self.number(y)?);
                let new = turn.rotate(old) + shift;
                self.listen([old, new])?;
                self.length(record, Some(x), new.x * side)?;
                self.length(record, Some(y), new.y)?;
            }
        }
        // A vertex has a direction only where the curve was fitted through it (flag 2).
        let flags = fields.pair(70).and_then(|p| self.tokens.integer(p)).unwrap_or(0);
        let has_direction = self.tokens.name(record) != b"VERTEX" || flags & 2 != 0;
        if is_world || motion.turn_rad == 0.0 || !has_direction {
            return Ok(());
        }
        let old_deg = fields.index(50).map_or(Ok(0.0), |i| self.number(i))?;
        self.angle(&fields, 50, old_deg + side * motion.turn_rad.to_degrees(), 0.0)
    }
}

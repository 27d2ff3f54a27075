//! Building works in a drawing: entities that end at an opening or go, and lines that are drawn with the properties of
//! others.

use std::ops::Range;

use glam::DVec2;

use super::additions::{Writer, count_splice, value_splice};
use super::fields::{
    Fields, attributes, constant_width, handle_of, lwpolyline_vertices, own_pairs, polyline_records,
};
use super::patch::Editor;
use super::tokens::Tokens;
use crate::drawing::{EntityWork, RigidMotion, Shape, Vertex};
use crate::own_layers::DEMOLISHED;
use crate::splice::Splice;
use enfilade_report::Error;

/// Groups that say how an entity looks, in the order in which they are written: paper space, layer, line type, colour, line
/// weight, scale of the line type, true colour, colour book, transparency.
pub(super) const LOOK: [i32; 9] = [67, 8, 6, 62, 370, 48, 420, 430, 440];
/// Groups of an LWPOLYLINE's vertices: place, widths, bulge, number; some programs write a height too.
const OF_VERTEX: [i32; 7] = [10, 20, 30, 40, 41, 42, 91];

impl Editor<'_, '_> {
    /// Makes a building work on the entity.
    pub(super) fn work(&mut self, work: &EntityWork, writer: &mut Writer<'_, '_>) -> Result<(), Error> {
        match work {
            EntityWork::Cut { parts } => self.cut(parts, writer),
            EntityWork::Void { gone, .. } => self.refill(gone, writer),
            EntityWork::Drop => self.drop(),
            EntityWork::Copy { motion } => self.copy(motion, writer),
            EntityWork::Build { shapes } => self.build(shapes, writer),
        }
    }

    /// What stays of a line: the first part in its own record, the others in new ones behind it.
    fn cut(&mut self, parts: &[Shape], writer: &mut Writer<'_, '_>) -> Result<(), Error> {
        let fields = Fields::of(self.tokens, self.record);
        if self.is_mirrored(&fields)? {
            return Err(self.fault("it is drawn in a plane that is turned over"));
        }
        match (self.tokens.name(self.record), parts) {
            (b"MLINE", _) => return self.multiline_anew(parts, writer),
            (b"LINE", [first @ Shape::Line { .. }, ..]) => self.shape(first)?,
            (b"LWPOLYLINE", [Shape::Polyline { vertices, closed }, ..]) => {
                self.vertices_anew(vertices, *closed, writer)?;
            }
            (b"POLYLINE", [Shape::Polyline { vertices, closed }, ..]) => {
                self.records_anew(&fields, vertices, *closed, writer)?;
            }
            _ => return Err(self.fault("it is no line that can be cut")),
        }
        self.build(&parts[1..], writer)
    }

    /// New entities behind this one, with its properties.
    fn build(&mut self, shapes: &[Shape], writer: &mut Writer<'_, '_>) -> Result<(), Error> {
        for shape in shapes {
            let points = crate::curve::control_points(shape);
            self.listen(points)?;
            match shape {
                Shape::Line { a, b } => self.line(*a, *b, writer),
                Shape::Polyline { vertices, closed } => self.polyline_like(vertices, *closed, writer),
                Shape::Arc { centre, radius, start_rad, end_rad } => {
                    self.arc(*centre, *radius, [*start_rad, *end_rad], writer);
                }
                Shape::Circle { .. } => return Err(self.fault("a circle is not drawn anew")),
            }
        }
        self.put_behind(writer);
        Ok(())
    }

    /// Puts what was written behind the entity.
    pub(super) fn put_behind(&mut self, writer: &mut Writer<'_, '_>) {
        let (at, with) = (self.tokens.record_start(self.records().end), writer.take());
        if !with.is_empty() {
            self.out.push((self.record, Splice { start: at, end: at, with }));
        }
    }

    /// Another INSERT of the same block, without attributes: they say what the first one is.
    fn copy(&mut self, motion: &RigidMotion, writer: &mut Writer<'_, '_>) -> Result<(), Error> {
        let fields = Fields::of(self.tokens, self.record);
        if self.tokens.name(self.record) != b"INSERT" {
            return Err(self.fault("it is no block"));
        }
        if self.is_mirrored(&fields)? {
            return Err(self.fault("it is drawn in a plane that is turned over"));
        }
        let number = |code: i32| fields.index(code).map(|i| self.number(i)).transpose();
        let (Some(x), Some(y)) = (number(10)?, number(20)?) else {
            return Err(self.fault("it has no place"));
        };
        let at = DVec2::from_angle(motion.turn_rad).rotate(DVec2::new(x, y)) + motion.shift;
        let at = DVec2::new(tidy(at.x), tidy(at.y));
        let turned_deg = tidy(number(50)?.unwrap_or(0.0) + motion.turn_rad.to_degrees());
        self.listen([at])?;
        self.begin("INSERT", self.record, writer);
        self.subclass(self.record, "AcDbBlockReference", writer);
        for (_, pair) in own_pairs(self.tokens, self.record) {
            match pair.code {
                10 => writer.float(10, at.x),
                20 => writer.float(20, at.y),
                2 | 30 | 41..=43 | 210 | 220 | 230 => writer.raw(pair.code, self.tokens.raw(pair)),
                _ => {}
            }
        }
        writer.float(50, turned_deg.rem_euclid(360.0));
        self.put_behind(writer);
        Ok(())
    }

    /// To the layer of what is demolished, with all its records.
    pub(super) fn drop(&mut self) -> Result<(), Error> {
        for record in self.records() {
            match Fields::of(self.tokens, record).index(8) {
                Some(index) => {
                    let splice = value_splice(self.tokens, index, DEMOLISHED.as_bytes());
                    self.out.push((record, splice));
                }
                None if record == self.record => return Err(self.fault("it has no layer to change")),
                None => {}
            }
        }
        Ok(())
    }

    /// The entity with the vertices or attributes that belong to it.
    fn records(&self) -> Range<usize> {
        let end = match self.tokens.name(self.record) {
            b"POLYLINE" => polyline_records(self.tokens, self.record).1,
            b"INSERT" => {
                let end = attributes(self.tokens, self.record).end;
                let has_end = end > self.record + 1 && end < self.tokens.records.len();
                end + usize::from(has_end && self.tokens.name(end) == b"SEQEND")
            }
            _ => self.record + 1,
        };
        self.record..end
    }

    /// Replaces the vertices of an LWPOLYLINE.
    fn vertices_anew(
        &mut self,
        vertices: &[Vertex],
        is_closed: bool,
        writer: &mut Writer<'_, '_>,
    ) -> Result<(), Error> {
        self.listen(vertices.iter().map(|v| v.at))?;
        let own: Vec<(usize, i32)> = own_pairs(self.tokens, self.record).map(|(i, p)| (i, p.code)).collect();
        let first = own.iter().find(|p| p.1 == 10).map(|p| p.0);
        let last = own.iter().filter(|p| OF_VERTEX.contains(&p.1)).map(|p| p.0).next_back();
        let (Some(first), Some(last)) = (first, last) else { return Err(self.fault("it has no vertices")) };
        let is_vertex = |i: usize| OF_VERTEX.contains(&self.tokens.pairs[i].code);
        if !(first..=last).all(is_vertex) {
            return Err(self.fault("something else stands between its vertices"));
        }
        let slots = lwpolyline_vertices(self.tokens, self.record).len();
        let width = self.width_of_vertices(slots)?;
        let height = own.iter().find(|p| p.1 == 30).map(|p| self.tokens.raw(&self.tokens.pairs[p.0]));
        write_vertices(vertices, height, width, writer);
        let (start, end) = (self.tokens.pair_start(first), self.tokens.pair_start(last + 1));
        let with = writer.take();
        self.out.push((self.record, Splice { start, end, with }));
        let fields = Fields::of(self.tokens, self.record);
        let count = own.iter().find(|p| p.1 == 90).map(|p| p.0);
        let difference = vertices.len() as i64 - slots as i64;
        if let Some(splice) = count.and_then(|i| count_splice(self.tokens, i, difference)) {
            self.out.push((self.record, splice));
        }
        self.set_closed(&fields, is_closed);
        Ok(())
    }

    /// The width that every vertex states for itself, if any does.
    fn width_of_vertices(&self, count: usize) -> Result<Option<f64>, Error> {
        let stated = own_pairs(self.tokens, self.record).filter(|(_, p)| matches!(p.code, 40 | 41)).count();
        if stated == 0 {
            return Ok(None);
        }
        let width = constant_width(self.tokens, self.record).filter(|_| stated == 2 * count);
        let are_zero = own_pairs(self.tokens, self.record)
            .filter(|(_, p)| matches!(p.code, 40 | 41))
            .all(|(_, p)| self.tokens.number(p) == Some(0.0));
        match width {
            Some(width) => Ok(Some(width)),
            None if are_zero => Ok(None),
            None => Err(self.fault("its width changes along it")),
        }
    }

    /// Replaces the VERTEX records of a POLYLINE.
    fn records_anew(
        &mut self,
        fields: &Fields<'_, '_>,
        vertices: &[Vertex],
        is_closed: bool,
        writer: &mut Writer<'_, '_>,
    ) -> Result<(), Error> {
        self.listen(vertices.iter().map(|v| v.at))?;
        let (records, _, _) = polyline_records(self.tokens, self.record);
        if records.is_empty() {
            return Err(self.fault("it has no vertices"));
        }
        let pattern = records.start;
        vertices.iter().for_each(|v| self.vertex(pattern, *v, writer));
        let (start, end) = (self.tokens.record_start(records.start), self.tokens.record_start(records.end));
        let with = writer.take();
        self.out.push((self.record, Splice { start, end, with }));
        self.set_closed(fields, is_closed);
        Ok(())
    }

    fn set_closed(&mut self, fields: &Fields<'_, '_>, is_closed: bool) {
        let Some(index) = fields.index(70) else { return };
        let flags = self.tokens.integer(&self.tokens.pairs[index]).unwrap_or(0);
        let new = flags & !1 | i64::from(is_closed);
        if new != flags
            && let Some(splice) = count_splice(self.tokens, index, new - flags)
        {
            self.out.push((self.record, splice));
        }
    }

    /// The beginning of an entity like this one.
    pub(super) fn begin(&self, kind: &str, record: usize, writer: &mut Writer<'_, '_>) {
        let tokens: &Tokens<'_> = self.tokens;
        writer.text(0, kind);
        if handle_of(tokens, record).is_some() {
            writer.handle();
        }
        let owner = own_pairs(tokens, record).find(|(_, p)| p.code == 330);
        if let Some((_, pair)) = owner {
            writer.bytes(330, tokens.value(pair));
        }
        let has_subclasses = own_pairs(tokens, record).any(|(_, p)| p.code == 100);
        if has_subclasses {
            writer.text(100, "AcDbEntity");
        }
        for code in LOOK {
            if let Some((_, pair)) = own_pairs(tokens, record).find(|(_, p)| p.code == code) {
                writer.raw(code, tokens.raw(pair));
            }
        }
    }

    /// Subclass markers stand where the pattern has them.
    pub(super) fn subclass(&self, record: usize, name: &str, writer: &mut Writer<'_, '_>) {
        if own_pairs(self.tokens, record).any(|(_, p)| p.code == 100) {
            writer.text(100, name);
        }
    }

    fn line(&self, a: DVec2, b: DVec2, writer: &mut Writer<'_, '_>) {
        self.begin("LINE", self.record, writer);
        self.subclass(self.record, "AcDbLine", writer);
        let z = self.height(writer.floor());
        for (code, p) in [(10, a), (11, b)] {
            writer.float(code, p.x);
            writer.float(code + 10, p.y);
            writer.float(code + 20, z);
        }
    }

    fn arc(&self, centre: DVec2, radius: f64, ends_rad: [f64; 2], writer: &mut Writer<'_, '_>) {
        self.begin("ARC", self.record, writer);
        self.subclass(self.record, "AcDbCircle", writer);
        writer.float(10, centre.x);
        writer.float(20, centre.y);
        writer.float(30, self.height(writer.floor()));
        writer.float(40, radius);
        self.subclass(self.record, "AcDbArc", writer);
        writer.float(50, ends_rad[0].to_degrees().rem_euclid(360.0));
        writer.float(51, ends_rad[1].to_degrees().rem_euclid(360.0));
    }

    /// Its height where it is a line, else that of the floor.
    fn height(&self, floor: f64) -> f64 {
        let code = match self.tokens.name(self.record) {
            b"LINE" | b"ARC" | b"CIRCLE" => 30,
            b"LWPOLYLINE" => 38,
            _ => return floor,
        };
        let pair = own_pairs(self.tokens, self.record).find(|(_, p)| p.code == code);
        pair.and_then(|(_, p)| self.tokens.number(p)).unwrap_or(0.0)
    }

    fn polyline_like(&self, vertices: &[Vertex], is_closed: bool, writer: &mut Writer<'_, '_>) {
        if self.tokens.name(self.record) == b"POLYLINE" {
            return self.old_polyline_like(vertices, is_closed, writer);
        }
        self.begin("LWPOLYLINE", self.record, writer);
        self.subclass(self.record, "AcDbPolyline", writer);
        writer.int(90, vertices.len() as i32);
        writer.int(70, i32::from(is_closed));
        let own = |code: i32| own_pairs(self.tokens, self.record).find(|(_, p)| p.code == code);
        for code in [38, 39] {
            if let Some((_, pair)) = own(code) {
                writer.raw(code, self.tokens.raw(pair));
            }
        }
        let width = constant_width(self.tokens, self.record);
        if let Some(width) = width {
            writer.float(43, width);
        }
        write_vertices(vertices, None, None, writer);
    }

    fn old_polyline_like(&self, vertices: &[Vertex], is_closed: bool, writer: &mut Writer<'_, '_>) {
        let (records, end, has_end) = polyline_records(self.tokens, self.record);
        self.begin("POLYLINE", self.record, writer);
        let mut is_flagged = false;
        for (_, pair) in own_pairs(self.tokens, self.record) {
            let is_look = LOOK.contains(&pair.code) || matches!(pair.code, 0 | 5 | 330);
            let text = self.tokens.value(pair);
            match pair.code {
                100 if text == b"AcDbEntity" => {}
                70 => {
                    is_flagged = true;
                    let flags = self.tokens.integer(pair).unwrap_or(0) & !1 | i64::from(is_closed);
                    writer.int(70, flags as i32);
                }
                _ if !is_look => writer.raw(pair.code, self.tokens.raw(pair)),
                _ => {}
            }
        }
        if !is_flagged && is_closed {
            writer.int(70, 1);
        }
        vertices.iter().for_each(|v| self.vertex(records.start, *v, writer));
        let pattern = if has_end { end - 1 } else { records.start };
        self.begin("SEQEND", pattern, writer);
    }

    /// A VERTEX record like another.
    fn vertex(&self, pattern: usize, v: Vertex, writer: &mut Writer<'_, '_>) {
        self.begin("VERTEX", pattern, writer);
        let mut is_placed = false;
        for (_, pair) in own_pairs(self.tokens, pattern) {
            let is_look = LOOK.contains(&pair.code) || matches!(pair.code, 0 | 5 | 330);
            match pair.code {
                100 if self.tokens.value(pair) == b"AcDbEntity" => {}
                10 => {
                    is_placed = true;
                    writer.float(10, v.at.x);
                }
                20 => writer.float(20, v.at.y),
                42 | 50 | 91 => {}
                _ if !is_look => writer.raw(pair.code, self.tokens.raw(pair)),
                _ => {}
            }
        }
        if !is_placed {
            writer.float(10, v.at.x);
            writer.float(20, v.at.y);
        }
        if v.bulge != 0.0 {
            writer.float(42, v.bulge);
        }
    }
}

/// A new number without the noise of sums: to a billionth of a drawing unit or of a degree.
fn tidy(value: f64) -> f64 {
    const BY: f64 = 1e9;
    (value * BY).round() / BY
}

/// Vertices of an LWPOLYLINE; `height` as another one has it, drawing units.
fn write_vertices(
    vertices: &[Vertex],
    height: Option<&[u8]>,
    width: Option<f64>,
    writer: &mut Writer<'_, '_>,
) {
    for v in vertices {
        writer.float(10, v.at.x);
        writer.float(20, v.at.y);
        if let Some(height) = height {
            writer.raw(30, height);
        }
        for code in [40, 41] {
            if let Some(width) = width {
                writer.float(code, width);
            }
        }
        if v.bulge != 0.0 {
            writer.float(42, v.bulge);
        }
    }
}

//! One record to one item: a shape seen from above, a text, or an INSERT.

use glam::{DVec2, DVec3};

use super::curves::{self, is_upright, mapped, ocs_to_world};
use super::fields::{
    Fields, attributes, constant_width, has_embedded_object, lwpolyline_vertices, own_pairs, point_slots,
    polyline_records,
};
use super::reader::Reader;
use super::text::{plain_mtext, plain_text};
use super::tokens::Pair;
use crate::drawing::{Editable, Shape, SourceRef, Text, Vertex};
use crate::own_layers::is_own;
use enfilade_report::{Error, Severity};

/// What a record draws, in the coordinates of its block or of model space.
#[derive(Clone, Debug)]
pub(super) enum Body {
    /// A drawn shape and how it can be written back when it stands in model space itself.
    Shape(Shape, Editable),
    /// A filled area.
    Fill(Shape),
    /// A text at its insertion point.
    Text(DVec2, String),
    /// A block shown.
    Insert(Insert),
}

/// A record that draws something.
#[derive(Clone, Debug)]
pub(super) struct Item {
    /// The record.
    pub record: usize,
    /// Index of its layer.
    pub layer: u32,
    /// What it draws.
    pub body: Body,
}

/// An INSERT smaller than this shows nothing: a millimetre of a kilometre is a millionth.
const SCALE_MIN: f64 = 1e-9;

/// An INSERT, in its own object coordinates.
#[derive(Clone, Debug)]
pub(super) struct Insert {
    /// Block name, decoded.
    pub block: String,
    /// Whether the extrusion is −z, so that x is mirrored.
    pub is_mirrored: bool,
    /// Insertion point.
    pub at: DVec2,
    /// Scale factors of x and y.
    pub scale: DVec2,
    /// Rotation.
    pub rotation_rad: f64,
    /// Columns and rows, at least 1.
    pub count: [u64; 2],
    /// Distance of columns and rows.
    pub spacing: DVec2,
    /// Whether the record and its attributes have values to write for the place (10, 20) and for the
    /// rotation (50).
    pub has_values: [bool; 2],
}

/// Kinds that draw nothing of a plan, or annotation: left out without a word when alone.
const SILENT: [&[u8]; 8] =
    [b"ATTRIB", b"ATTDEF", b"SEQEND", b"VIEWPORT", b"POINT", b"VERTEX", b"ENDSEC", b"ENDBLK"];

/// Kinds that belong to another record or end something, and show nothing themselves.
const PARTS: [&[u8]; 8] =
    [b"ATTRIB", b"ATTDEF", b"SEQEND", b"VIEWPORT", b"VERTEX", b"ENDSEC", b"ENDBLK", b"BLOCK"];

/// Why an entity is left out: code and text.
pub(super) type Skip = (&'static str, String);

fn skip<T>(code: &'static str, text: impl Into<String>) -> Result<Result<T, Skip>, Error> {
    Ok(Err((code, text.into())))
}

impl<'a> Reader<'a, '_> {
    /// Items of the records of one block or of the ENTITIES section.
    pub fn items(&mut self, records: std::ops::Range<usize>) -> Result<Vec<Item>, Error> {
        let mut out = Vec::new();
        let mut record = records.start;
        while record < records.end {
            let mut next = record + 1;
            let tokens = self.tokens;
            let fields = Fields::of(tokens, record);
            let name = tokens.name(record);
            if name == b"POLYLINE" {
                next = polyline_records(tokens, record).1;
            }
            self.check_handle(&fields);
            let is_on_paper = self.int(&fields, 67, 0)? != 0;
            let is_drawn = !is_on_paper && self.int(&fields, 60, 0)? == 0;
            if !is_drawn && !is_on_paper {
                let layer = self.layer(&fields);
                self.count_invisible(&fields, layer);
            }
            if is_drawn && !PARTS.contains(&name) {
                self.keep_record(record);
            }
            if is_drawn && name == b"MLINE" {
                self.add_multiline(&fields, &mut out)?;
                record = next;
                continue;
            }
            let body = if is_drawn { self.body(name, &fields)? } else { None };
            let is_undrawn = matches!(body, None | Some(Err(_))) && (is_drawn || is_on_paper);
            match body {
                Some(Ok(body)) => {
                    if matches!(name, b"LWPOLYLINE" | b"POLYLINE") {
                        self.widths.extend(constant_width(tokens, record).map(|width| (record, width)));
                    }
                    let layer = self.layer(&fields);
                    out.push(Item { record, layer, body });
                }
                Some(Err((code, text))) => {
                    self.layer(&fields);
                    self.warn(code, record, text);
                }
                None => {}
            }
            if is_undrawn && !PARTS.contains(&name) {
                self.count_undrawn(&fields, is_on_paper);
            }
            record = next;
        }
        Ok(out)
    }

    fn add_multiline(&mut self, fields: &Fields<'_, 'a>, out: &mut Vec<Item>) -> Result<(), Error> {
        let (record, layer) = (fields.record, self.layer(fields));
        match self.multiline(fields)? {
            Ok(bodies) => out.extend(bodies.into_iter().map(|body| Item { record, layer, body })),
            Err((code, text)) => {
                self.warn(code, record, text);
                self.count_undrawn(fields, false);
            }
        }
        Ok(())
    }

    fn body(&mut self, name: &[u8], fields: &Fields<'_, 'a>) -> Result<Option<Result<Body, Skip>>, Error> {
        let body = match name {
            b"LINE" => self.line(fields)?,
            b"LWPOLYLINE" => self.lwpolyline(fields)?,
            b"POLYLINE" => self.polyline(fields)?,
            b"ARC" | b"CIRCLE" => self.arc(fields, name == b"ARC")?,
            b"ELLIPSE" => self.ellipse(fields)?,
            b"SPLINE" => self.spline(fields)?,
            b"INSERT" => self.insert(fields)?,
            b"TEXT" => self.text(fields)?,
            b"MTEXT" => self.mtext(fields)?,
            b"ATTDEF" if self.is_constant(fields)? => self.constant(fields)?,
            _ if SILENT.contains(&name) => return Ok(None),
            _ => {
                if let Some(shape) = self.fill(name, fields) {
                    return Ok(Some(self.checked(Body::Fill(shape))));
                }
                *self.left_out.entry(super::tokens::shown(name)).or_default() += 1;
                return Ok(None);
            }
        };
        Ok(Some(body.and_then(|body| self.checked(body))))
    }

    /// Leaves out shapes with NaN, infinite or absurd coordinates.
    pub(super) fn checked(&self, body: Body) -> Result<Body, Skip> {
        let bad = match &body {
            Body::Shape(shape, _) | Body::Fill(shape) => self.insane_point(shape),
            Body::Text(at, _) => Some(*at).filter(|&p| !self.is_sane(p)),
            Body::Insert(i) => [i.at, i.scale, DVec2::new(i.rotation_rad, 0.0), i.spacing]
                .into_iter()
                .find(|&p| !self.is_sane(p)),
        };
        match bad {
            None => Ok(body),
            Some(p) => {
                let limit = self.max_coordinate;
                let text = format!(
                    "its coordinates, found {} {}, expected finite numbers up to {limit:e} drawing units; left \
                     out of the plan, kept in the file",
                    p.x, p.y
                );
                Err(("dxf-bad-coordinate", text))
            }
        }
    }

    /// The first point of a shape that no plan can have.
    pub fn insane_point(&self, shape: &Shape) -> Option<DVec2> {
        let is_bad = |p: &DVec2| !self.is_sane(*p);
        match shape {
            Shape::Line { a, b } => [*a, *b].into_iter().find(is_bad),
            Shape::Polyline { vertices, .. } => vertices.iter().map(|v| v.at).find(is_bad),
            Shape::Circle { centre, radius } => {
                [*centre, *centre + DVec2::splat(*radius), DVec2::splat(*radius)].into_iter().find(is_bad)
            }
            Shape::Arc { centre, radius, start_rad, end_rad } => {
                let angles = DVec2::new(*start_rad, *end_rad);
                [*centre, DVec2::splat(*radius), angles].into_iter().find(is_bad)
            }
        }
    }

    fn line(&self, fields: &Fields<'_, '_>) -> Result<Result<Body, Skip>, Error> {
        if [10, 20, 11, 21].iter().any(|&code| fields.pair(code).is_none()) {
            return skip(
                "dxf-missing-value",
                "its points, found not all of the groups 10, 20, 11, 21; left out",
            );
        }
        let (a, b) = (self.point(fields, 10)?.truncate(), self.point(fields, 11)?.truncate());
        Ok(Ok(Body::Shape(Shape::Line { a, b }, Editable::Free)))
    }

    /// A planar shape from its object coordinates.
    pub(super) fn planar(&self, shape: Shape, extrusion: DVec3, elevation: f64) -> Body {
        if extrusion == DVec3::Z {
            return Body::Shape(shape, Editable::Free);
        }
        let map = ocs_to_world(extrusion, elevation);
        let editable = if is_upright(extrusion) {
            Editable::Free
        } else {
            Editable::No("it is drawn in a tilted plane".into())
        };
        Body::Shape(mapped(&shape, &map, self.five_mm), editable)
    }

    fn lwpolyline(&mut self, fields: &Fields<'_, '_>) -> Result<Result<Body, Skip>, Error> {
        let record = fields.record;
        let slots = lwpolyline_vertices(self.tokens, record);
        let number = |index: usize| self.number(&self.tokens.pairs[index], record);
        let mut vertices = Vec::with_capacity(slots.len());
        for slot in &slots {
            let Some(y) = slot.y else {
                return skip("dxf-missing-value", "a vertex, found group 10 without group 20; left out");
            };
            let bulge = slot.bulge.map_or(Ok(0.0), number)?;
            vertices.push(Vertex { at: DVec2::new(number(slot.x)?, number(y)?), bulge });
        }
        if let Err(fault) = self.check_vertices(&vertices) {
            return Ok(Err(fault));
        }
        let stated = own_pairs(self.tokens, record).find(|(_, p)| p.code == 90);
        let stated = stated.and_then(|(_, p)| self.tokens.integer(p));
        if let Some(stated) = stated.filter(|n| *n != vertices.len() as i64) {
            let text = format!(
                "group 90, found {stated}, expected {}, the number of its vertices; read with those that are there",
                vertices.len()
            );
            self.note("dxf-vertices-stated", Severity::Info, record, text);
        }
        let closed = self.int(fields, 70, 0)? & 1 != 0;
        let elevation = self.float(fields, 38, 0.0)?;
        let extrusion = self.extrusion(fields)?;
        Ok(Ok(self.planar(Shape::Polyline { vertices, closed }, extrusion, elevation)))
    }

    pub(super) fn check_vertices(&self, vertices: &[Vertex]) -> Result<(), Skip> {
        let count = vertices.len();
        if count == 0 || count > self.limits.max_vertices {
            let limit = self.limits.max_vertices;
            return Err((
                "dxf-vertex-count",
                format!("its vertices, found {count}, expected 1 to {limit}; left out of the plan"),
            ));
        }
        match vertices.iter().find(|v| !v.bulge.is_finite() || v.bulge.abs() > self.limits.max_bulge) {
            Some(v) => Err((
                "dxf-bad-bulge",
                format!(
                    "group 42, found a bulge of {}, expected at most {:e}; left out of the plan, kept in the file",
                    v.bulge, self.limits.max_bulge
                ),
            )),
            None => Ok(()),
        }
    }

    fn polyline(&mut self, fields: &Fields<'_, 'a>) -> Result<Result<Body, Skip>, Error> {
        let flags = self.int(fields, 70, 0)?;
        if flags & (16 | 64) != 0 {
            return skip("dxf-mesh", "it is a mesh, expected a line; left out of the plan, kept in the file");
        }
        let (records, _, has_seqend) = polyline_records(self.tokens, fields.record);
        let mut vertices = Vec::with_capacity(records.len());
        let (total, mut can_turn) = (records.len(), true);
        for record in records {
            let vertex = Fields::of(self.tokens, record);
            let vertex_flags = self.int(&vertex, 70, 0)?;
            let direction = vertex.pair(50).and_then(|p| self.tokens.number(p));
            can_turn &= vertex_flags & 2 == 0 || direction.is_some_and(f64::is_finite);
            if vertex.pair(10).is_none() || vertex.pair(20).is_none() {
                return skip("dxf-missing-value", "a VERTEX, found no group 10 or 20; left out");
            }
            let at = self.point(&vertex, 10)?.truncate();
            if vertex_flags & 16 != 0 && at.is_finite() {
                continue;
            }
            vertices.push(Vertex { at, bulge: self.float(&vertex, 42, 0.0)? });
        }
        if let Err(fault) = self.check_vertices(&vertices) {
            return Ok(Err(fault));
        }
        if !has_seqend {
            let text = "its end, found no SEQEND, expected one after the last VERTEX; read up to there";
            self.note("dxf-no-seqend", Severity::Info, fields.record, text);
        }
        let is_fitted = flags & 6 != 0 || vertices.len() != total;
        let shape = Shape::Polyline { vertices, closed: flags & 1 != 0 };
        let mut body = if flags & 8 != 0 {
            Body::Shape(shape, Editable::Free)
        } else {
            let elevation = self.float(fields, 30, 0.0)?;
            self.planar(shape, self.extrusion(fields)?, elevation)
        };
        if is_fitted && let Body::Shape(_, editable) = &mut body {
            let moves = *editable == Editable::Free
                && [210, 220, 230].iter().all(|&code| fields.pair(code).is_none());
            *editable = if moves {
                Editable::WithInsert { turnable: can_turn }
            } else {
                Editable::No("it is a fitted curve that is not drawn in the plane of the plan".into())
            };
        }
        Ok(Ok(body))
    }

    fn arc(&self, fields: &Fields<'_, '_>, is_arc: bool) -> Result<Result<Body, Skip>, Error> {
        if [10, 20, 40].iter().any(|&code| fields.pair(code).is_none()) {
            return skip(
                "dxf-missing-value",
                "its centre and radius, found not all of the groups 10, 20, 40; left out",
            );
        }
        let (at, radius) = (self.point(fields, 10)?, self.float(fields, 40, 0.0)?);
        if radius <= 0.0 {
            return skip(
                "dxf-bad-radius",
                format!("its radius, found {radius}, expected more than 0; left out"),
            );
        }
        let (centre, elevation) = (at.truncate(), at.z);
        let shape = if is_arc {
            let start_rad = self.float(fields, 50, 0.0)?.to_radians();
            Shape::Arc { centre, radius, start_rad, end_rad: self.float(fields, 51, 360.0)?.to_radians() }
        } else {
            Shape::Circle { centre, radius }
        };
        let mut body = self.planar(shape, self.extrusion(fields)?, elevation);
        let has_angles = !is_arc || (fields.pair(50).is_some() && fields.pair(51).is_some());
        if !has_angles && let Body::Shape(_, editable) = &mut body {
            *editable = Editable::No("it has no angles to write to".into());
        }
        Ok(Ok(body))
    }

    fn ellipse(&self, fields: &Fields<'_, '_>) -> Result<Result<Body, Skip>, Error> {
        if [10, 20, 11, 21].iter().any(|&code| fields.pair(code).is_none()) {
            return skip(
                "dxf-missing-value",
                "its axes, found not all of the groups 10, 20, 11, 21; left out",
            );
        }
        let (centre, major) = (self.point(fields, 10)?, self.point(fields, 11)?);
        let extrusion = self.extrusion(fields)?;
        let ratio = self.float(fields, 40, 1.0)?;
        let params = [self.float(fields, 41, 0.0)?, self.float(fields, 42, std::f64::consts::TAU)?];
        let values = [ratio, params[0], params[1], major.x, major.y];
        if values.iter().any(|v| !v.is_finite()) || major.length() == 0.0 || ratio.abs() > 1e6 {
            let text = format!("its axes, found {major} and ratio {ratio}, expected an ellipse; left out");
            return skip("dxf-bad-ellipse", text);
        }
        let shape = curves::ellipse(centre, major, ratio, extrusion, params, self.five_mm);
        Ok(Ok(Body::Shape(shape, as_a_whole(extrusion))))
    }

    fn spline(&self, fields: &Fields<'_, '_>) -> Result<Result<Body, Skip>, Error> {
        let (mut knots, mut weights) = (Vec::new(), Vec::new());
        for (_, pair) in own_pairs(self.tokens, fields.record) {
            match pair.code {
                40 => knots.push(self.number(pair, fields.record)?),
                41 => weights.push(self.number(pair, fields.record)?),
                _ => {}
            }
        }
        let (Some(control), Some(fit), Some(tangents)) =
            (self.points(fields, &[10])?, self.points(fields, &[11])?, self.points(fields, &[12, 13])?)
        else {
            return skip("dxf-missing-value", "one of its points, found an x without a y; left out");
        };
        if let Some(&p) = control.iter().chain(&fit).chain(&tangents).find(|&&p| !self.is_sane(p)) {
            return Ok(self.checked(Body::Text(p, String::new())));
        }
        let degree = usize::try_from(self.int(fields, 71, 3)?).unwrap_or(0);
        let points = if control.is_empty() && fit.len() >= 2 {
            let tangents = match tangents[..] {
                [start, end] => [Some(start), Some(end)],
                _ => [None, None],
            };
            Ok(curves::fit_spline(&fit, tangents, self.five_mm))
        } else {
            curves::spline(degree, &knots, &control, &weights, self.five_mm)
        };
        let points = match points {
            Ok(points) => points,
            Err(reason) => {
                return skip("dxf-bad-spline", format!("{reason}; left out of the plan, kept in the file"));
            }
        };
        let is_ring = points.len() > 2 && points[0].distance(points[points.len() - 1]) == 0.0;
        let points = if is_ring { &points[1..] } else { &points[..] };
        let shape = curves::polyline(points.iter().copied(), is_ring);
        Ok(Ok(Body::Shape(shape, as_a_whole(self.extrusion(fields)?))))
    }

    /// All points of a record at the groups `codes` and `codes + 10`; `None` where one has no y.
    fn points(&self, fields: &Fields<'_, '_>, codes: &[i32]) -> Result<Option<Vec<DVec2>>, Error> {
        let mut out = Vec::new();
        for (x, y) in codes.iter().flat_map(|&code| point_slots(self.tokens, fields.record, code)) {
            let Some(y) = y else { return Ok(None) };
            let number = |index: usize| self.number(&self.tokens.pairs[index], fields.record);
            out.push(DVec2::new(number(x)?, number(y)?));
        }
        Ok(Some(out))
    }

    /// Whether an attribute of an INSERT can follow it, and whether it can turn with it.
    fn attribute_follows(&self, record: usize) -> [bool; 2] {
        let fields = Fields::of(self.tokens, record);
        let has = |code: i32| fields.pair(code).is_some();
        let is_number =
            |code: i32| fields.pair(code).is_none_or(|p| self.tokens.number(p).is_some_and(f64::is_finite));
        let is_plain = [10, 20, 11, 21, 50, 210, 220, 230].into_iter().all(is_number)
            && self.extrusion(&fields).is_ok_and(is_upright)
            && !has_embedded_object(self.tokens, record);
        [is_plain && has(10) && has(20) && has(11) == has(21), has(50)]
    }

    fn insert(&self, fields: &Fields<'_, '_>) -> Result<Result<Body, Skip>, Error> {
        let Some(name) = fields.value(2) else {
            return skip("dxf-missing-value", "its block, found no group 2; left out");
        };
        let extrusion = self.extrusion(fields)?;
        if !is_upright(extrusion) {
            return skip(
                "dxf-tilted-insert",
                format!("its extrusion, found {extrusion}, expected up or down; left out"),
            );
        }
        let scale = DVec2::new(self.float(fields, 41, 1.0)?, self.float(fields, 42, 1.0)?);
        if scale.abs().min_element() < SCALE_MIN {
            let found = if scale.x.abs() < SCALE_MIN { scale.x } else { scale.y };
            let text = format!("its scale, found {found}, expected another factor; left out");
            return skip("dxf-zero-scale", text);
        }
        let count = [self.int(fields, 70, 1)?, self.int(fields, 71, 1)?];
        if count.iter().any(|&n| n < 0) {
            let text = format!(
                "its columns and rows, found {} and {}, expected 1 or more; left out",
                count[0], count[1]
            );
            return skip("dxf-bad-array", text);
        }
        let has = |code: i32| fields.pair(code).is_some();
        let attributes = attributes(self.tokens, fields.record).map(|record| self.attribute_follows(record));
        let has_values =
            attributes.fold([has(10) && has(20), has(50)], |all, one| [all[0] && one[0], all[1] && one[1]]);
        Ok(Ok(Body::Insert(Insert {
            block: self.page.decode(name),
            is_mirrored: extrusion.z < 0.0,
            at: self.point(fields, 10)?.truncate(),
            scale,
            rotation_rad: self.float(fields, 50, 0.0)?.to_radians(),
            count: count.map(|n| n.max(1) as u64),
            spacing: DVec2::new(self.float(fields, 44, 0.0)?, self.float(fields, 45, 0.0)?),
            has_values,
        })))
    }

    fn text(&self, fields: &Fields<'_, '_>) -> Result<Result<Body, Skip>, Error> {
        let is_aligned = self.int(fields, 72, 0)? != 0 || self.int(fields, 73, 0)? != 0;
        let code = if is_aligned && fields.pair(11).is_some() { 11 } else { 10 };
        let at = self.point(fields, code)?;
        let map = ocs_to_world(self.extrusion(fields)?, at.z);
        let raw = fields.pair(1).map_or(&b""[..], |p| self.tokens.raw(p));
        let text = plain_text(&self.page.decode(raw)).trim().to_owned();
        Ok(Ok(Body::Text(map.transform_point2(at.truncate()), text)))
    }

    /// Whether the definition of an attribute shows its own text in every INSERT: constant, not invisible, in a block. In
    /// model space it shows its tag.
    fn is_constant(&self, fields: &Fields<'_, '_>) -> Result<bool, Error> {
        const INVISIBLE: i64 = 1;
        const CONSTANT: i64 = 2;
        let is_in_block = self.tokens.section(b"BLOCKS").is_some_and(|s| s.contains(&fields.record));
        Ok(is_in_block && self.int(fields, 70, 0)? & (INVISIBLE | CONSTANT) == CONSTANT)
    }

    fn constant(&self, fields: &Fields<'_, '_>) -> Result<Result<Body, Skip>, Error> {
        let text = self.text(fields)?;
        Ok(text.map(|body| match (body, self.lines_of(fields.record)) {
            (Body::Text(at, _), Some(lines)) => Body::Text(at, lines),
            (body, _) => body,
        }))
    }

    /// The attributes that an INSERT of a layer shows, each on a layer that is named as its tag; what cannot be read of them
    /// is left out. Those on a layer of ours, their own or that of the INSERT, are texts there.
    pub fn tags(&self, insert: usize, layer: u32) -> Vec<Text> {
        let one = |record: usize| {
            let fields = Fields::of(self.tokens, record);
            let flag = |code: i32| self.int(&fields, code, 0).unwrap_or(0);
            let body = self.text(&fields).ok()?.and_then(|body| self.checked(body)).ok()?;
            let Body::Text(at, own) = body else { return None };
            let text = self.lines_of(record).unwrap_or(own);
            let tag = self.page.decode(fields.value(2)?);
            let is_shown = flag(70) & 1 == 0 && flag(60) == 0 && !text.is_empty();
            let own = self.page.decode(fields.value(8).unwrap_or(b"0"));
            let marked = [own, self.layers.name(layer).to_owned()].into_iter().find(|l| is_own(l));
            let on = marked.unwrap_or(tag);
            let source = SourceRef { layer: on.clone(), ..self.source(record, layer) };
            is_shown.then_some(Text { source, layer: on, at, text })
        };
        attributes(self.tokens, insert).filter_map(one).collect()
    }

    fn mtext(&self, fields: &Fields<'_, '_>) -> Result<Result<Body, Skip>, Error> {
        let at = self.point(fields, 10)?.truncate();
        let text = self.joined(own_pairs(self.tokens, fields.record).map(|(_, pair)| pair));
        Ok(Ok(Body::Text(at, text)))
    }

    /// The text of an attribute of several lines: that of the MTEXT within it.
    fn lines_of(&self, attribute: usize) -> Option<String> {
        let within = self.tokens.record(attribute).iter().skip_while(|p| p.code != 101);
        let text = self.joined(within.take_while(|p| p.code < 1000));
        (!text.is_empty()).then_some(text)
    }

    /// The text of an MTEXT, of which long ones stand in several groups.
    fn joined<'p>(&self, pairs: impl Iterator<Item = &'p Pair>) -> String {
        let parts = pairs.filter(|p| matches!(p.code, 1 | 3)).map(|p| self.tokens.raw(p));
        let raw = parts.collect::<Vec<_>>().concat();
        plain_mtext(&self.page.decode(&raw)).trim().to_owned()
    }
}

/// What was read as polylines and is written otherwise: it moves as a whole, and turns where its plane lies flat.
pub(super) fn as_a_whole(extrusion: DVec3) -> Editable {
    Editable::WithInsert { turnable: is_upright(extrusion) }
}

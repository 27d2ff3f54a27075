//! Filled areas: HATCH with a solid fill and one outline, SOLID and TRACE.

use glam::DVec2;

use super::boundary::{Piece, boundary};
use super::entity::Body;
use super::fields::{Fields, own_pairs};
use super::reader::Reader;
use crate::drawing::{Editable, Entity, Origin, Shape, SourceRef, Vertex};
use crate::own_layers;

/// Most corners of a filled area that is looked at: columns have fewer.
const FILL_CORNERS_MAX: usize = 64;

/// Most filled areas of a drawing that are looked at: beyond them they are pictures.
const FILLS_MAX: usize = 20_000;

impl Reader<'_, '_> {
    /// The outline of a filled area as seen from above; `None` where it has several, holes, too many corners, a
    /// value that cannot be read, or no plain fill.
    pub(super) fn fill(&self, name: &[u8], fields: &Fields<'_, '_>) -> Option<Shape> {
        let (shape, elevation_code) = match name {
            b"HATCH" => (self.hatch(fields)?, 30),
            b"SOLID" | b"TRACE" => (self.solid(fields)?, 38),
            _ => return None,
        };
        if let Shape::Polyline { vertices, .. } = &shape {
            self.check_vertices(vertices).ok()?;
        }
        let elevation = self.float(fields, elevation_code, 0.0).ok()?;
        match self.planar(shape, self.extrusion(fields).ok()?, elevation) {
            Body::Shape(shape, _) => Some(shape),
            _ => None,
        }
    }

    /// Keeps a filled area; none of our own layers, and no more than [`FILLS_MAX`].
    pub(super) fn add_fill(
        &mut self,
        (source, origin): (SourceRef, Origin),
        layer: String,
        shape: Shape,
        blocks: Vec<String>,
    ) {
        if own_layers::is_own(&layer) || self.fills.len() >= FILLS_MAX {
            return;
        }
        let editable = Editable::No("it is drawn as a filled area, without a line".into());
        self.fills.push(Entity { source, layer, shape, editable, blocks, origin });
    }

    /// Corners 10, 11, 13, 12 in their order round the area.
    fn solid(&self, fields: &Fields<'_, '_>) -> Option<Shape> {
        let mut corners: Vec<DVec2> = Vec::new();
        for code in [10, 11, 13, 12] {
            if fields.pair(code).is_none() || fields.pair(code + 10).is_none() {
                continue;
            }
            let at = self.point(fields, code).ok()?.truncate();
            if corners.last() != Some(&at) {
                corners.push(at);
            }
        }
        (corners.len() > 2).then(|| ring(corners.into_iter().map(|at| Vertex { at, bulge: 0.0 }).collect()))
    }

    fn hatch(&self, fields: &Fields<'_, '_>) -> Option<Shape> {
        let first = |code: i32| {
            let (_, pair) = own_pairs(self.tokens, fields.record).find(|(_, p)| p.code == code)?;
            self.tokens.number(pair)
        };
        let is_solid_with_one_outline = first(70)? == 1.0 && first(91)? == 1.0;
        if !is_solid_with_one_outline {
            return None;
        }
        let found = boundary(self.tokens, fields.record, FILL_CORNERS_MAX)?;
        let [outline] = &found.outlines[..] else { return None };
        if let [Piece::Arc { centre, radius, angles_deg: [from, to], .. }] = outline[..] {
            let is_round = (to - from).abs() >= 360.0 - 1e-6 && radius > 0.0;
            return is_round.then_some(Shape::Circle { centre: centre.point(self.tokens)?, radius });
        }
        let corner = |piece: &Piece| match *piece {
            Piece::Corner { at, bulge } => Some(Vertex { at: at.point(self.tokens)?, bulge }),
            Piece::Line { start, .. } => Some(Vertex { at: start.point(self.tokens)?, bulge: 0.0 }),
            Piece::Arc { .. } | Piece::Curve => None,
        };
        outline.iter().map(corner).collect::<Option<Vec<_>>>().filter(|v| v.len() > 2).map(ring)
    }
}

fn ring(mut vertices: Vec<Vertex>) -> Shape {
    if vertices.len() > 3 && vertices.first().map(|v| v.at) == vertices.last().map(|v| v.at) {
        vertices.pop();
    }
    Shape::Polyline { vertices, closed: true }
}

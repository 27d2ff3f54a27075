//! Filled areas: HATCH with a solid fill and one outline, SOLID and TRACE.

use glam::DVec2;

use super::entity::Body;
use super::fields::{Fields, own_pairs};
use super::reader::Reader;
use crate::plan::drawing::{Editable, Entity, Shape, SourceRef, Vertex};
use crate::plan::own_layers;

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
    pub(super) fn add_fill(&mut self, source: SourceRef, layer: String, shape: Shape, blocks: Vec<String>) {
        if own_layers::is_own(&layer) || self.fills.len() >= FILLS_MAX {
            return;
        }
        let editable = Editable::No("it is drawn as a filled area, without a line".into());
        self.fills.push(Entity { source, layer, shape, editable, blocks });
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
        let path = self.hatch_path(fields.record)?;
        match path.edges[..] {
            [Edge::Arc { centre, radius, sweep_deg }] if sweep_deg.abs() >= 360.0 - 1e-6 && radius > 0.0 => {
                Some(Shape::Circle { centre, radius })
            }
            [] if path.vertices.len() > 2 => Some(ring(path.vertices)),
            ref edges => {
                let starts = edges.iter().map(|e| match e {
                    Edge::Line { start } => Some(Vertex { at: *start, bulge: 0.0 }),
                    Edge::Arc { .. } => None,
                });
                starts.collect::<Option<Vec<_>>>().filter(|v| v.len() > 2).map(ring)
            }
        }
    }

    /// The one outline of a hatch; `None` where it has more corners than are looked at, or curves of other kinds.
    fn hatch_path(&self, record: usize) -> Option<Path> {
        let mut path = Path::default();
        let (mut is_polyline, mut edge, mut x, mut is_open) = (false, Open::default(), None, false);
        for (_, pair) in own_pairs(self.tokens, record) {
            if !is_open {
                is_open = pair.code == 91;
                continue;
            }
            let value = || self.tokens.number(pair);
            match pair.code {
                92 => is_polyline = value()? as i64 & 2 != 0,
                75 | 97 => break,
                72 if !is_polyline => {
                    path.close(&mut edge);
                    edge.kind = value()? as i64;
                    if !matches!(edge.kind, 1 | 2) {
                        return None;
                    }
                }
                10 => x = Some(value()?),
                20 => {
                    let Some(x) = x.take() else { continue };
                    let at = DVec2::new(x, value()?);
                    if is_polyline { path.vertices.push(Vertex { at, bulge: 0.0 }) } else { edge.at = at }
                }
                42 if is_polyline => {
                    if let Some(last) = path.vertices.last_mut() {
                        last.bulge = value()?;
                    }
                }
                40 => edge.radius = value()?,
                50 => edge.angles_deg[0] = value()?,
                51 => edge.angles_deg[1] = value()?,
                _ => {}
            }
            if path.vertices.len() + path.edges.len() > FILL_CORNERS_MAX {
                return None;
            }
        }
        path.close(&mut edge);
        Some(path)
    }
}

/// An outline as it is read: corners of a polyline, or edges.
#[derive(Default)]
struct Path {
    vertices: Vec<Vertex>,
    edges: Vec<Edge>,
}

enum Edge {
    Line { start: DVec2 },
    Arc { centre: DVec2, radius: f64, sweep_deg: f64 },
}

/// The edge that is being read: 0 none, 1 a line, 2 an arc.
#[derive(Default)]
struct Open {
    kind: i64,
    at: DVec2,
    radius: f64,
    angles_deg: [f64; 2],
}

impl Path {
    fn close(&mut self, edge: &mut Open) {
        let Open { kind, at, radius, angles_deg: [from, to] } = std::mem::take(edge);
        match kind {
            1 => self.edges.push(Edge::Line { start: at }),
            2 => self.edges.push(Edge::Arc { centre: at, radius, sweep_deg: to - from }),
            _ => {}
        }
    }
}

fn ring(mut vertices: Vec<Vertex>) -> Shape {
    if vertices.len() > 3 && vertices.first().map(|v| v.at) == vertices.last().map(|v| v.at) {
        vertices.pop();
    }
    Shape::Polyline { vertices, closed: true }
}

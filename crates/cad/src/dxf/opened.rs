//! Blocks that are shown once: what they hold is changed where they are defined.

use glam::{DAffine2, DVec2};

use super::blocks::{Blocks, copies, placement};
use super::curves::{mapped, similarity};
use super::entity::{Body, Item};
use super::reader::Reader;
use super::sheet::is_regular;
use crate::curve::control_points;
use crate::drawing::{EntityWork, RigidMotion, Shape, Vertex};

/// Differences below this many rounding steps of the largest coordinate are what going there and back leaves.
const BACK_STEPS: f64 = 32.0;

/// Where the definition of a block lies that is shown once: its coordinates to those of model space.
pub(super) struct Place {
    map: DAffine2,
}

impl Place {
    /// The place of the definition that holds a record; `None` where it is not shown exactly once.
    pub fn of(reader: &mut Reader<'_, '_>, blocks: &Blocks, record: usize) -> Option<Self> {
        let mut way = Vec::new();
        let mut record = record;
        let section = reader.tokens.section(b"ENTITIES")?;
        while !section.contains(&record) {
            let block = blocks.list.iter().find(|b| b.records.contains(&record))?;
            if !block.is_plain || block.inserts != 1 || way.len() >= reader.limits.max_block_depth {
                return None;
            }
            record = block.insert;
            let item = item_at(reader, record)?;
            let Body::Insert(insert) = item.body else { return None };
            if copies(&insert) > 1 {
                return None;
            }
            way.push(placement(&insert, block.base, [0, 0]));
        }
        // In the order of reading, so that the same numbers come out.
        let map = way.into_iter().rev().fold(DAffine2::IDENTITY, |outer, inner| outer * inner);
        is_regular(&map).then_some(Self { map })
    }

    /// Where a point of the definition lies in model space.
    pub fn at(&self, p: DVec2) -> DVec2 {
        self.map.transform_point2(p)
    }

    /// A motion of model space as one of the definition; `None` where it turns what would have to be stretched.
    pub fn motion_back(&self, motion: &RigidMotion) -> Option<RigidMotion> {
        let inner = self.map.matrix2.inverse();
        if motion.turn_rad == 0.0 {
            return Some(RigidMotion { turn_rad: 0.0, shift: inner * motion.shift });
        }
        let side = similarity(&self.map)?.signum();
        let zero = self.map.translation;
        let moved = DVec2::from_angle(motion.turn_rad).rotate(zero) + motion.shift;
        Some(RigidMotion { turn_rad: side * motion.turn_rad, shift: inner * (moved - zero) })
    }

    /// The entity of a record as its definition draws it.
    pub fn drawn(reader: &mut Reader<'_, '_>, record: usize) -> Option<Shape> {
        match item_at(reader, record)?.body {
            Body::Shape(shape, _) => Some(shape),
            _ => None,
        }
    }

    /// A building work in model space as one in the definition; `None` where something would have to be stretched.
    pub fn work_back(&self, work: &EntityWork) -> Option<EntityWork> {
        let all = |shapes: &[Shape]| shapes.iter().map(|s| self.new_back(s)).collect::<Option<Vec<_>>>();
        Some(match work {
            EntityWork::Cut { parts } => EntityWork::Cut { parts: all(parts)? },
            EntityWork::Build { shapes } => EntityWork::Build { shapes: all(shapes)? },
            EntityWork::Copy { motion } => EntityWork::Copy { motion: self.motion_back(motion)? },
            EntityWork::Void { gone, filling } => {
                let back = self.map.inverse();
                EntityWork::Void { gone: gone.map(|p| back.transform_point2(p)), filling: *filling }
            }
            EntityWork::Drop => EntityWork::Drop,
        })
    }

    /// A line of model space, newly drawn, as one of the definition; `None` of an arc that would have to be stretched.
    fn new_back(&self, new: &Shape) -> Option<Shape> {
        let back = self.map.inverse();
        match new {
            Shape::Arc { .. } | Shape::Circle { .. } if similarity(&self.map).is_none() => None,
            _ => Some(mapped(new, &back, None)),
        }
    }

    /// A shape of model space as one of the definition, where it was `drawn`; what did not change comes out as it was.
    pub fn shape_back(&self, new: &Shape, drawn: &Shape) -> Option<Shape> {
        let old = mapped(drawn, &self.map, None);
        let points = Points { place: self, largest: largest(new).max(largest(drawn)) };
        let one = |new: f64, old: f64, drawn: f64, back: f64| if new == old { drawn } else { back };
        match (new, &old, drawn) {
            (Shape::Line { a, b }, Shape::Line { a: a0, b: b0 }, Shape::Line { a: a1, b: b1 }) => {
                Some(Shape::Line { a: points.back(*a, *a0, *a1), b: points.back(*b, *b0, *b1) })
            }
            (
                Shape::Polyline { vertices, closed },
                Shape::Polyline { vertices: old, .. },
                Shape::Polyline { vertices: drawn, .. },
            ) if vertices.len() == old.len() && old.len() == drawn.len() => {
                let side = self.map.matrix2.determinant().signum();
                let vertex = |((v, v0), v1): ((&Vertex, &Vertex), &Vertex)| Vertex {
                    at: points.back(v.at, v0.at, v1.at),
                    bulge: one(v.bulge, v0.bulge, v1.bulge, v.bulge * side),
                };
                let vertices = vertices.iter().zip(old).zip(drawn).map(vertex).collect();
                Some(Shape::Polyline { vertices, closed: *closed })
            }
            (
                Shape::Circle { centre, radius },
                Shape::Circle { centre: c0, radius: r0 },
                Shape::Circle { centre: c1, radius: r1 },
            ) => {
                let scale = similarity(&self.map)?.abs();
                Some(Shape::Circle {
                    centre: points.back(*centre, *c0, *c1),
                    radius: one(*radius, *r0, *r1, radius / scale),
                })
            }
            (
                Shape::Arc { centre, radius, start_rad, end_rad },
                Shape::Arc { centre: c0, radius: r0, start_rad: s0, end_rad: e0 },
                Shape::Arc { centre: c1, radius: r1, start_rad: s1, end_rad: e1 },
            ) => {
                let scale = similarity(&self.map)?;
                let x = self.map.matrix2.x_axis;
                let turn = x.y.atan2(x.x);
                let (start_rad, end_rad) = if scale < 0.0 {
                    (one(*end_rad, *e0, *s1, turn - end_rad), one(*start_rad, *s0, *e1, turn - start_rad))
                } else {
                    (one(*start_rad, *s0, *s1, start_rad - turn), one(*end_rad, *e0, *e1, end_rad - turn))
                };
                let centre = points.back(*centre, *c0, *c1);
                let radius = one(*radius, *r0, *r1, radius / scale.abs());
                Some(Shape::Arc { centre, radius, start_rad, end_rad })
            }
            _ => None,
        }
    }
}

fn item_at(reader: &mut Reader<'_, '_>, record: usize) -> Option<Item> {
    reader.items(record..record + 1).ok()?.into_iter().next()
}

/// The largest coordinate of a shape.
fn largest(shape: &Shape) -> f64 {
    control_points(shape).into_iter().map(|p| p.abs().max_element()).fold(0.0, f64::max)
}

/// Points on their way back to a definition.
struct Points<'p> {
    place: &'p Place,
    /// Largest coordinate there and here.
    largest: f64,
}

impl Points<'_> {
    /// Where a point goes in the definition that was `drawn` there and `old` here.
    fn back(&self, new: DVec2, old: DVec2, drawn: DVec2) -> DVec2 {
        let map = &self.place.map;
        if new == old {
            return drawn;
        }
        let inner = map.matrix2.inverse();
        // By its way, which is exact where the map only shifts and turns over.
        let to = drawn + inner * (new - old);
        let size = inner.x_axis.abs().max(inner.y_axis.abs()).max_element();
        let step =
            BACK_STEPS * f64::EPSILON * (self.largest + map.translation.abs().max_element()) * size.max(1.0);
        DVec2::select((to - drawn).abs().cmple(DVec2::splat(step)), drawn, to)
    }
}

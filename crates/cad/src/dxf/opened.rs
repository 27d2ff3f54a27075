//! Blocks that are shown once: what they hold is changed where they are defined.

use glam::{DAffine2, DVec2};

use super::blocks::{Blocks, copies, placement};
use super::curves::{mapped, similarity};
use super::entity::{Body, Item};
use super::reader::Reader;
use crate::curve::control_points;
use crate::drawing::{Editable, RigidMotion, Shape, Vertex};
use crate::own_layers::MOVE;
use crate::own_layers::bare;
use crate::plane::{box_of, is_inside_ring};

/// What is at most this long beside all that model space shows, and draws less than [`THING_PIECES`] of it, is a thing:
/// a door, a column, a cupboard. It moves as a whole.
const THING_SIZE: f64 = 0.25;

/// See [`THING_SIZE`]: several houses on one sheet are shorter, but each draws much of it.
const THING_PIECES: f64 = 0.125;

/// Most by which INSERTs may stretch a block more one way than another: beyond it nothing comes back exactly.
const STRETCH_MAX: f64 = 1e4;

/// Coordinates may be this many times as large as what a block draws: beyond it rounding shows.
const AWAY_MAX: f64 = 1e7;

/// Differences below this many rounding steps of the largest coordinate are what going there and back leaves.
const BACK_STEPS: f64 = 32.0;

/// How what an INSERT shows is written back.
#[derive(Clone, Debug)]
pub(super) enum How<'i> {
    /// Each entity in the definition of its block.
    Own,
    /// All of it with an INSERT.
    With {
        /// The INSERT.
        insert: &'i Item,
        /// Whether it moves and turns.
        editable: Editable,
    },
}

/// What model space shows in all.
#[derive(Default)]
pub(super) struct Sheet {
    /// Drawn pieces.
    pub pieces: u64,
    extent: Option<[DVec2; 2]>,
    /// Outlines of the user's moves.
    moves: Vec<Shape>,
}

impl Sheet {
    /// Adds a shape that stands in model space itself.
    pub fn add_drawn(&mut self, layer: &str, shape: &Shape) {
        if bare(layer).eq_ignore_ascii_case(MOVE) {
            self.moves.push(shape.clone());
            return;
        }
        self.pieces = self.pieces.saturating_add(super::blocks::pieces(shape));
        control_points(shape).into_iter().for_each(|p| self.add_corner(p));
    }

    /// Adds a corner of what an INSERT shows.
    pub fn add_corner(&mut self, p: DVec2) {
        self.extent = Some(self.extent.map_or([p, p], |[lo, hi]| [lo.min(p), hi.max(p)]));
    }

    /// The outlines of the user's moves: what one encloses wholly moves as a whole.
    pub fn moves(&self) -> impl Iterator<Item = &Shape> {
        self.moves.iter()
    }

    /// Whether what an INSERT shows in a box is small beside the rest. So is taken what lies so far from zero that it
    /// would not come back exactly.
    pub fn is_thing(&self, corners: &[DVec2], pieces: u64) -> bool {
        let draws_little = (pieces as f64) < THING_PIECES * self.pieces as f64;
        let Some([lo, hi]) = box_of(corners.iter().copied()) else { return true };
        let is_near = lo.abs().max(hi.abs()).max_element() <= AWAY_MAX * (hi - lo).max_element();
        self.is_short(corners) && draws_little || !is_near
    }

    /// Whether a box is short beside what model space shows: nobody expects parts of it to move.
    pub fn is_short(&self, corners: &[DVec2]) -> bool {
        let boxes = (box_of(corners.iter().copied()), self.extent);
        let (Some([lo, hi]), Some([from, to])) = boxes else { return true };
        (hi - lo).max_element() <= THING_SIZE * (to - from).max_element()
    }
}

/// Whether a point lies within an outline, bulges taken as straight.
pub(super) fn encloses(outline: &Shape, p: DVec2) -> bool {
    match outline {
        Shape::Circle { centre, radius } => centre.distance(p) <= *radius,
        Shape::Polyline { vertices, .. } => {
            is_inside_ring(&vertices.iter().map(|v| v.at).collect::<Vec<_>>(), p)
        }
        Shape::Line { .. } | Shape::Arc { .. } => false,
    }
}

/// Whether a map can be taken back without loss.
pub(super) fn is_regular(map: &DAffine2) -> bool {
    let [x, y] = [map.matrix2.x_axis, map.matrix2.y_axis];
    let size = x.abs().max(y.abs()).max_element();
    let stretch = size * size / map.matrix2.determinant().abs();
    map.is_finite() && stretch <= STRETCH_MAX && map.inverse().is_finite()
}

/// How an entity of a block that is shown once is written back.
pub(super) fn own_editable(drawn: &Shape, editable: &Editable, map: &DAffine2) -> Editable {
    let is_straight = match drawn {
        Shape::Line { .. } => true,
        Shape::Polyline { vertices, .. } => vertices.iter().all(|v| v.bulge == 0.0),
        Shape::Arc { .. } | Shape::Circle { .. } => false,
    };
    match editable {
        Editable::Free if !is_straight && similarity(map).is_none() => {
            Editable::No("it is round and its INSERT stretches it more one way than the other".into())
        }
        Editable::WithInsert { turnable } => {
            Editable::WithInsert { turnable: *turnable && similarity(map).is_some() }
        }
        other => other.clone(),
    }
}

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

//! What edits move and what stands: where each corner and straight piece is drawn and where it is afterwards.

use std::collections::HashSet;

use glam::DVec2;

use crate::curve::control_points;
use crate::drawing::{Drawing, Edit, RigidMotion, Shape};
use crate::plane::{box_of, distance_to_segment};

/// What fills may lie on: where it is drawn and where it is afterwards.
#[derive(Default)]
pub(super) struct Ground {
    pub nodes: Vec<Node>,
    pub faces: Vec<Face>,
    pub discs: Vec<Disc>,
}

/// A control point.
pub(super) struct Node {
    pub from: DVec2,
    pub to: DVec2,
}

/// A straight piece.
pub(super) struct Face {
    pub from: [DVec2; 2],
    pub to: [DVec2; 2],
}

/// A circle that keeps its size.
pub(super) struct Disc {
    pub centre: DVec2,
    pub radius: f64,
    pub shift: DVec2,
}

impl Ground {
    pub fn moved(drawing: &Drawing, edits: &[Edit]) -> Self {
        let mut ground = Self::default();
        for edit in edits {
            let mut shown = drawing.entities.iter().filter(|e| e.source.record == edit.record());
            match edit {
                Edit::Shape { shape, .. } => {
                    if let (Some(e), None) = (shown.next(), shown.next()) {
                        ground.add(&e.shape, shape);
                    }
                }
                Edit::Insert { motion, .. } => {
                    shown.for_each(|e| ground.add(&e.shape, &carried(&e.shape, motion)))
                }
                Edit::Ends { .. } | Edit::Points { .. } | Edit::Work { .. } => {}
            }
        }
        ground
    }

    /// What no edit changes, within bounds.
    pub fn standing(drawing: &Drawing, edited: &HashSet<usize>, bounds: [DVec2; 2]) -> Self {
        let mut ground = Self::default();
        let others = drawing.entities.iter().filter(|e| !edited.contains(&e.source.record));
        for e in others.filter(|e| box_of(reach(&e.shape).into_iter()).is_some_and(|b| overlap(b, bounds))) {
            ground.add(&e.shape, &e.shape);
        }
        ground
    }

    fn add(&mut self, from: &Shape, to: &Shape) {
        let (before, after) = (control_points(from), control_points(to));
        if before.len() != after.len() {
            return;
        }
        let places = || before.iter().zip(&after).map(|(&from, &to)| Node { from, to });
        match (from, to) {
            (Shape::Circle { centre, radius }, Shape::Circle { centre: to, radius: after }) => {
                if radius == after {
                    self.discs.push(Disc { centre: *centre, radius: *radius, shift: *to - *centre });
                }
                return;
            }
            (Shape::Line { a, b }, Shape::Line { a: c, b: d }) => {
                self.faces.push(Face { from: [*a, *b], to: [*c, *d] });
            }
            (Shape::Polyline { vertices, closed }, Shape::Polyline { .. }) => {
                let pieces = if *closed { vertices.len() } else { vertices.len().saturating_sub(1) };
                for i in (0..pieces).filter(|&i| vertices[i].bulge == 0.0) {
                    let j = (i + 1) % vertices.len();
                    self.faces.push(Face { from: [before[i], before[j]], to: [after[i], after[j]] });
                }
            }
            _ => {}
        }
        self.nodes.extend(places());
    }

    /// Whether a point lies on it as drawn and not afterwards.
    pub fn leaves(&self, p: DVec2, tolerance: f64) -> bool {
        let mut nodes = self.nodes.iter().filter(|n| n.from.distance(p) <= tolerance).peekable();
        if nodes.peek().is_some() {
            return nodes.any(|n| n.from.distance(n.to) > tolerance);
        }
        let on = |f: &&Face| distance_to_segment(p, f.from) <= tolerance;
        self.faces.iter().filter(on).any(|f| distance_to_line(p, f.to) > tolerance)
    }

    /// Adds an outline that follows, before and after.
    pub fn add_ring(&mut self, [before, after]: &[Vec<DVec2>; 2]) {
        self.nodes.extend(before.iter().zip(after).map(|(&from, &to)| Node { from, to }));
    }

    pub fn bounds(&self) -> Option<[DVec2; 2]> {
        let round = self.discs.iter().flat_map(|d| [d.centre - d.radius, d.centre + d.radius]);
        box_of(self.nodes.iter().map(|n| n.from).chain(round))
    }
}

impl Face {
    /// Where a point on it goes if the piece moves without changing its length.
    pub fn carried(&self, p: DVec2, tolerance: f64) -> Option<DVec2> {
        let [[a, b], [c, d]] = [self.from, self.to];
        let keeps_its_length = (a.distance(b) - c.distance(d)).abs() <= tolerance;
        let along = (p - a).dot(b - a) / (b - a).length_squared();
        keeps_its_length.then(|| c + (d - c) * along + (p - (a + (b - a) * along)))
    }

    pub fn crosses(&self, other: &Self) -> bool {
        let direction = |f: &Self| (f.from[1] - f.from[0]).normalize_or_zero();
        direction(self).perp_dot(direction(other)).abs() > CROSSING_SINE
    }
}

/// Lines at a smaller angle than this have no crossing that could be trusted (5°).
const CROSSING_SINE: f64 = 0.087;

pub(super) fn crossing([a, b]: [DVec2; 2], [c, d]: [DVec2; 2]) -> Option<DVec2> {
    let (u, v) = (b - a, d - c);
    let across = u.perp_dot(v);
    let is_clear = across.abs() > CROSSING_SINE * u.length() * v.length();
    is_clear.then(|| a + u * ((c - a).perp_dot(v) / across))
}

pub(super) fn distance_to_line(p: DVec2, [a, b]: [DVec2; 2]) -> f64 {
    (b - a).normalize_or_zero().perp_dot(p - a).abs()
}

fn carried(shape: &Shape, motion: &RigidMotion) -> Shape {
    let turn = DVec2::from_angle(motion.turn_rad);
    let at = |p: DVec2| turn.rotate(p) + motion.shift;
    match shape {
        Shape::Line { a, b } => Shape::Line { a: at(*a), b: at(*b) },
        Shape::Polyline { vertices, closed } => {
            let mut vertices = vertices.clone();
            vertices.iter_mut().for_each(|v| v.at = at(v.at));
            Shape::Polyline { vertices, closed: *closed }
        }
        Shape::Circle { centre, radius } => Shape::Circle { centre: at(*centre), radius: *radius },
        Shape::Arc { centre, radius, start_rad, end_rad } => Shape::Arc {
            centre: at(*centre),
            radius: *radius,
            start_rad: start_rad + motion.turn_rad,
            end_rad: end_rad + motion.turn_rad,
        },
    }
}

/// Points that lie at the outside of a shape.
fn reach(shape: &Shape) -> Vec<DVec2> {
    match shape {
        Shape::Circle { centre, radius } => vec![*centre - *radius, *centre + *radius],
        other => control_points(other),
    }
}

pub(super) fn overlap([a, b]: [DVec2; 2], [c, d]: [DVec2; 2]) -> bool {
    a.cmple(d).all() && c.cmple(b).all()
}

//! What model space shows in all, and how what its INSERTs show is written back.

use glam::{DAffine2, DVec2};

use super::curves::similarity;
use super::entity::Item;
use crate::curve::control_points;
use crate::drawing::{Editable, Shape};
use crate::own_layers::{MOVE, bare};
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
    /// Box round it.
    pub extent: Option<[DVec2; 2]>,
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
        self.pieces = self.pieces.saturating_add(pieces(shape));
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

    /// Whether what an INSERT shows in a box is small beside the rest.
    pub fn is_small(&self, corners: &[DVec2], pieces: u64) -> bool {
        self.is_short(corners) && (pieces as f64) < THING_PIECES * self.pieces as f64
    }

    /// Whether what an INSERT shows in a box lies so far from zero that it would not come back exactly.
    pub fn is_away(&self, corners: &[DVec2]) -> bool {
        let Some([lo, hi]) = box_of(corners.iter().copied()) else { return true };
        lo.abs().max(hi.abs()).max_element() > AWAY_MAX * (hi - lo).max_element()
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
        // Its ends would have to be measured in the block's own units.
        Editable::Wall { .. } => Editable::WithInsert { turnable: similarity(map).is_some() },
        other => other.clone(),
    }
}

/// Pieces of a shape, as the expansion budget counts them.
pub(super) fn pieces(shape: &Shape) -> u64 {
    match shape {
        Shape::Polyline { vertices, .. } => vertices.len() as u64,
        _ => 1,
    }
}

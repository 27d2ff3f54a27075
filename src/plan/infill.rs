//! Walls between columns: where only columns are named, the lines that run from column to column are the walls.
//!
//! Timber houses are drawn so: posts on a layer of their own, the infill on one without a telling name.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;

use super::choice::{Chosen, Hidden};
use super::curve::control_points;
use super::drawing::{Drawing, Entity, Format, Shape};
use super::roles::{Role, role_by_name};
use super::{PlanOptions, box_of, own_layers};
use crate::report::{Place, Report};

/// A line that ends this near to a corner of a column ends at it, metres.
const AT_COLUMN_M: f64 = 0.15;

/// Shorter lines are no infill, metres.
const LENGTH_MIN_M: f64 = 0.3;

/// A layer of infill has at least this many lines among the columns, of which this share runs from one to the next.
const LINES_MIN: usize = 8;
const BETWEEN_SHARE: f64 = 0.6;

/// Takes layers of infill in, where nothing but columns was found.
pub(super) fn take(
    drawing: &Drawing,
    options: &PlanOptions,
    chosen: &mut Chosen,
    picked: &mut Vec<usize>,
    metres_per_unit: f64,
    report: &mut Report,
) {
    let is_asked = options.is_our_choice();
    let is_column = |i: &usize| role_by_name(&drawing.entities[*i].layer).0 == Role::Column;
    if drawing.format != Format::Dxf || !is_asked || picked.is_empty() || !picked.iter().all(is_column) {
        return;
    }
    let columns = Corners::new(drawing, picked, AT_COLUMN_M / metres_per_unit);
    let corners = picked.iter().flat_map(|i| control_points(&drawing.entities[*i].shape));
    let Some([lo, hi]) = box_of(corners) else { return };
    // What another drawing of the sheet shows says nothing of this one.
    let is_among = |a: DVec2, b: DVec2| a.midpoint(b).cmpge(lo).all() && a.midpoint(b).cmple(hi).all();
    let hidden = Hidden::new(drawing);
    let mut found: BTreeMap<&str, (usize, Vec<usize>)> = BTreeMap::new();
    for (i, e) in drawing.entities.iter().enumerate() {
        let is_open = role_by_name(&e.layer).0 == Role::Unknown && !own_layers::is_own(&e.layer);
        let Some([a, b]) = ends(e).filter(|_| is_open && !hidden.entity(e)) else { continue };
        let layer = found.entry(&e.layer).or_default();
        if a.distance(b) * metres_per_unit >= LENGTH_MIN_M && is_among(a, b) {
            layer.0 += 1;
            if columns.has(a) && columns.has(b) {
                layer.1.push(i);
            }
        }
    }
    let is_infill = |(all, between): &(usize, Vec<usize>)| {
        between.len() >= LINES_MIN && between.len() as f64 >= BETWEEN_SHARE * *all as f64
    };
    for (name, (_, between)) in found.into_iter().filter(|(_, layer)| is_infill(layer)) {
        let why =
            format!("only columns are named, and {} of its lines run from column to column", between.len());
        let text = format!("layer {name:?}: {why}; taken as walls; --wall-layer overrides it");
        report.info("walls-assumed", Place::file(&drawing.file), text);
        chosen.layers.iter_mut().filter(|l| l.name == name).for_each(|l| {
            l.role = "wall";
            l.why.clone_from(&why);
        });
        picked.extend(between);
    }
    picked.sort_unstable();
}

/// Ends of a straight piece.
fn ends(e: &Entity) -> Option<[DVec2; 2]> {
    match &e.shape {
        Shape::Line { a, b } => Some([*a, *b]),
        Shape::Polyline { vertices, closed: false } if vertices.len() == 2 => {
            Some([vertices[0].at, vertices[1].at])
        }
        _ => None,
    }
}

/// Corners of columns by place.
struct Corners {
    size: f64,
    cells: BTreeSet<[i64; 2]>,
}

impl Corners {
    fn new(drawing: &Drawing, picked: &[usize], size: f64) -> Self {
        let corners = picked.iter().flat_map(|i| control_points(&drawing.entities[*i].shape));
        Self { size, cells: corners.map(|p| Self::cell(p, size)).collect() }
    }

    fn cell(p: DVec2, size: f64) -> [i64; 2] {
        (p / size).floor().as_i64vec2().to_array()
    }

    /// Whether a corner stands beside a point: in its cell of the raster or one next to it.
    fn has(&self, p: DVec2) -> bool {
        let [x, y] = Self::cell(p, self.size);
        let beside = (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| [x + dx, y + dy]));
        beside.into_iter().any(|cell| self.cells.contains(&cell))
    }
}

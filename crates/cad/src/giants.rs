//! Shapes so large that they are slips of the pen: one vertex far away, a circle round the earth.
//!
//! One of them would stretch every raster and box until nothing of the building is left to see.

use std::f64::consts::PI;

use glam::DVec2;

use super::curve::{bulge_arc, control_points, sweep_rad};
use super::drawing::{Drawing, Entity, Shape, Undrawn};
use super::own_layers::is_own;
use crate::drawing::place;
use crate::plane::box_of;
use enfilade_report::{Place, Report};

/// A shape is a giant where it is this many times as large as [`REACHED_SHARE`] of the drawing reaches: ten
/// kilometres in a house of ten metres.
const GIANT_TIMES: f64 = 1_000.0;

/// The share of all shapes, the nearest first, that say how far the drawing reaches.
const REACHED_SHARE: f64 = 0.75;

/// The smallest giant is this many times as large as the next smaller shape: sizes that go on without a gap are drawn on
/// purpose, however small what most of them belong to.
const GAP_TIMES: f64 = 10.0;

/// Fewest shapes that say how far a drawing reaches.
const SHAPES_MIN: usize = 4;

/// Most giants that are named one by one.
const NAMED_MAX: usize = 20;

/// Leaves out the shapes that are out of all proportion, each by name; they stay in the file.
pub fn leave_out(drawing: &mut Drawing, report: &mut Report) {
    let Some(reach) = reach(drawing) else { return };
    let limit = GIANT_TIMES * reach;
    let Some(smallest) = smallest_giant(drawing, limit) else { return };
    let is_giant = |e: &Entity| !is_own(&e.layer) && size(&e.shape) >= smallest;
    let mut found = 0;
    for e in drawing.entities.iter().chain(&drawing.fills).filter(|e| is_giant(e)) {
        found += 1;
        if found > NAMED_MAX {
            continue;
        }
        let text = format!(
            "its size, found {:.1e} drawing units, expected at most {limit:.1e}: most of the drawing lies within {reach:.1e} of \
             its middle; left out of the plan, kept in the file",
            size(&e.shape)
        );
        report.warn("giant-shape", place(drawing, &e.source), text);
    }
    if found > NAMED_MAX {
        let text = format!("{} more shapes as much too large, not listed one by one", found - NAMED_MAX);
        report.warn("giant-shape", Place::file(&drawing.file), text);
    }
    let of = |e: &Entity| Undrawn {
        layer: e.layer.clone(),
        kind: e.source.kind.clone(),
        is_on_paper: false,
        count: 1,
    };
    drawing.undrawn.extend(drawing.entities.iter().filter(|e| is_giant(e)).map(of));
    drawing.entities.retain(|e| !is_giant(e));
    drawing.fills.retain(|e| !is_giant(e));
}

/// Size of the smallest giant, if there are any.
fn smallest_giant(drawing: &Drawing, limit: f64) -> Option<f64> {
    let shapes = drawing.entities.iter().chain(&drawing.fills).filter(|e| !is_own(&e.layer));
    let mut sizes: Vec<f64> = shapes.map(|e| size(&e.shape)).collect();
    sizes.sort_by(f64::total_cmp);
    sizes.windows(2).find(|w| w[1] > limit && w[1] > GAP_TIMES * w[0]).map(|w| w[1])
}

/// How far from its middle most of the drawing reaches, drawing units; `None` where too little is drawn to tell.
fn reach(drawing: &Drawing) -> Option<f64> {
    let shapes = || drawing.entities.iter().filter(|e| !is_own(&e.layer)).map(|e| &e.shape);
    let mut middles: Vec<DVec2> = shapes().filter_map(middle).collect();
    if middles.len() < SHAPES_MIN {
        return None;
    }
    let mut median = |pick: fn(&DVec2) -> f64| {
        let half = middles.len() / 2;
        let by = |a: &DVec2, b: &DVec2| pick(a).total_cmp(&pick(b));
        pick(middles.select_nth_unstable_by(half, by).1)
    };
    let centre = DVec2::new(median(|p| p.x), median(|p| p.y));
    let far = |s: &Shape| middle(s).map(|m| m.distance(centre) + size(s) / 2.0);
    let mut reaches: Vec<f64> = shapes().filter_map(far).collect();
    let at = ((reaches.len() - 1) as f64 * REACHED_SHARE) as usize;
    let reach = *reaches.select_nth_unstable_by(at, f64::total_cmp).1;
    (reach > 0.0).then_some(reach)
}

fn middle(shape: &Shape) -> Option<DVec2> {
    box_of(control_points(shape).into_iter()).map(|[lo, hi]| lo.midpoint(hi))
}

/// How far a shape reaches from one end to the other, at least; drawing units.
fn size(shape: &Shape) -> f64 {
    let arc = |radius: f64, sweep: f64| 2.0 * radius * (sweep.min(PI) / 2.0).sin();
    match shape {
        Shape::Circle { radius, .. } => 2.0 * radius,
        Shape::Arc { radius, start_rad, end_rad, .. } => arc(*radius, sweep_rad(*start_rad, *end_rad)),
        Shape::Line { a, b } => a.distance(*b),
        Shape::Polyline { vertices, closed } => {
            let next = vertices.iter().skip(1).chain(vertices.first().filter(|_| *closed));
            let arcs = vertices.iter().zip(next).filter_map(|(v, w)| bulge_arc(v.at, w.at, v.bulge));
            let widest = arcs.map(|(_, radius, _, sweep)| arc(radius, sweep.abs())).fold(0.0, f64::max);
            box_of(vertices.iter().map(|v| v.at)).map_or(0.0, |[lo, hi]| (hi - lo).length()).max(widest)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drawing::{Editable, SourceRef, Vertex};

    fn entity(record: usize, shape: Shape) -> Entity {
        let layer = "WALL".to_string();
        let source =
            SourceRef { record, handle: None, line: 10 * record, kind: "LINE".into(), layer: layer.clone() };
        Entity {
            source,
            layer,
            shape,
            editable: Editable::Free,
            blocks: Vec::new(),
            origin: Default::default(),
        }
    }

    /// A house of 10 m in millimetres with one shape more: which records are left, and what is said.
    fn left(shape: Shape) -> (usize, Vec<String>) {
        let corner = [[0.0, 0.0], [1e4, 0.0], [1e4, 8e3], [0.0, 8e3]].map(DVec2::from);
        let wall = |i: usize| entity(i, Shape::Line { a: corner[i], b: corner[(i + 1) % 4] });
        let mut drawing = Drawing::of((0..4).map(wall).chain([entity(4, shape)]).collect());
        let mut report = Report::default();
        leave_out(&mut drawing, &mut report);
        (drawing.entities.len(), report.problems.iter().map(ToString::to_string).collect())
    }

    #[test]
    fn what_is_out_of_all_proportion_is_left_out_by_name() {
        let at = |x: f64| DVec2::new(x, 4e3);
        let line = |x: f64| Shape::Line { a: at(0.0), b: at(x) };
        let bulged = |bulge: f64| Shape::Polyline {
            vertices: vec![Vertex { at: at(0.0), bulge }, Vertex { at: at(10.0), bulge: 0.0 }],
            closed: false,
        };
        let arc = |radius: f64, end_rad: f64| Shape::Arc { centre: at(0.0), radius, start_rad: 0.0, end_rad };
        // The limit stands near 9e6: a thousand times as far as the walls reach from the middle.
        for (shape, is_giant) in [
            (line(8e6), false),
            (line(6e8), true),
            (line(1e12), true),
            (Shape::Circle { centre: at(5e3), radius: 1e5 }, false),
            (Shape::Circle { centre: at(5e3), radius: 1e7 }, true),
            (Shape::Circle { centre: at(5e11), radius: 300.0 }, false),
            (bulged(1.0), false),
            (bulged(1e4), false),
            (bulged(1e7), true),
            (arc(1e9, 1e-4), false),
            (arc(1e9, 1.0), true),
        ] {
            let (count, said) = left(shape.clone());
            assert_eq!((count, said.len()), if is_giant { (4, 1) } else { (5, 0) }, "{shape:?}: {said:?}");
            assert!(
                !is_giant || said[0].starts_with("plan.dxf:40 LINE layer WALL: its size, found "),
                "{said:?}"
            );
        }
    }

    #[test]
    fn where_most_is_large_nothing_is_left_out() {
        let mut drawing = Drawing::of(
            (0..8)
                .map(|i| {
                    entity(
                        i,
                        Shape::Line { a: DVec2::ZERO, b: DVec2::new(if i < 3 { 1.0 } else { 1e9 }, 0.0) },
                    )
                })
                .collect(),
        );
        let mut report = Report::default();
        leave_out(&mut drawing, &mut report);
        assert_eq!((drawing.entities.len(), report.problems.len()), (8, 0));
        let line = |k: usize| Shape::Line { a: DVec2::ZERO, b: DVec2::new(4f64.powi(k as i32), 0.0) };
        drawing.entities = (0..100).map(|i| entity(i, line(i.saturating_sub(89)))).collect();
        leave_out(&mut drawing, &mut report);
        assert_eq!(drawing.entities.len(), 100, "sizes without a gap");
        drawing.entities.truncate(3);
        drawing.entities[2].shape = Shape::Circle { centre: DVec2::ZERO, radius: 1e9 };
        leave_out(&mut drawing, &mut report);
        assert_eq!(drawing.entities.len(), 3, "three shapes say nothing of how far a drawing reaches");
    }
}

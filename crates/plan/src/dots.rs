//! Shapes of no size: polylines of one vertex, splines and lines that end where they begin. They draw nothing.

use std::collections::BTreeMap;

use enfilade_cad::curve::control_points;
use enfilade_cad::drawing::{Drawing, Entity, Shape};
use enfilade_cad::own_layers::is_own;
use enfilade_report::{Report, counted};

/// Whether a shape draws no line.
pub(super) fn is_dot(shape: &Shape) -> bool {
    is_within(shape, 0.0)
}

/// Whether a shape of straight pieces reaches no farther than so many drawing units from where it begins.
pub fn is_within(shape: &Shape, reach: f64) -> bool {
    let is_straight = matches!(shape, Shape::Line { .. } | Shape::Polyline { .. });
    let points = control_points(shape);
    is_straight && points.iter().all(|p| p.distance(points[0]) <= reach)
}

/// Says for each layer how many shapes of no size lie on it, at the first of them (`dots`).
pub(super) fn state(drawing: &Drawing, report: &mut Report) {
    let dots = drawing.entities.iter().filter(|e| !is_own(&e.layer) && is_dot(&e.shape));
    let mut of_layer: BTreeMap<&str, (&Entity, u64)> = BTreeMap::new();
    dots.for_each(|e| of_layer.entry(&e.layer).or_insert((e, 0)).1 += 1);
    for (layer, (first, count)) in of_layer {
        let them = if count == 1 { "It was ignored." } else { "They were ignored; this is the first." };
        let text = format!("{} on layer {layer:?} without length. {them}", counted(count, "shape"));
        report.info("dots", enfilade_cad::drawing::place(drawing, &first.source), text);
    }
}

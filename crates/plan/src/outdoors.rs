//! Ground that the drawing says is outdoors: outlines on layers named after terraces, balconies, courtyards; of a building
//! what its file calls so.

use super::curve;
use super::frame::Frame;
use super::hidden::Hidden;
use enfilade_cad::drawing::{Drawing, Entity, Format, Shape};
use enfilade_cad::ifc::OUTDOORS_LAYER;
use enfilade_cad::names::is_outdoors;
use enfilade_engine::geometry::{PointUm, UM_PER_M};

/// Smaller outlines are pots, tables and names, m² of a person.
const AREA_MIN_M2: f64 = 2.0;

/// Most outlines that are looked at.
const RINGS_MAX: usize = 500;

/// The closed outlines on such layers that are shown and no walls, drawing frame, micrometres.
pub(super) fn find(
    drawing: &Drawing,
    is_wall: impl Fn(usize) -> bool,
    frame: &Frame,
    human_scale: f64,
) -> Vec<Vec<PointUm>> {
    let is_named = |e: &Entity| match drawing.format {
        Format::Dxf => is_outdoors(&e.layer),
        Format::Ifc => e.layer == OUTDOORS_LAYER,
        Format::Gltf | Format::Glb => false,
    };
    let hidden = Hidden::new(drawing);
    let is_outline = |(i, e): &(usize, &Entity)| {
        let is_closed = matches!(e.shape, Shape::Polyline { closed: true, .. } | Shape::Circle { .. });
        is_closed && !is_wall(*i) && is_named(e) && !hidden.entity(e)
    };
    let shown = drawing.entities.iter().enumerate().filter(is_outline);
    let rings = shown.map(|(_, e)| curve::trace(&e.shape, frame).points);
    let least = AREA_MIN_M2 * (human_scale * UM_PER_M).powi(2);
    rings.filter(|ring| ring.len() > 2 && area(ring) >= least).take(RINGS_MAX).collect()
}

fn area(ring: &[PointUm]) -> f64 {
    let next = ring.iter().cycle().skip(1);
    let at = |p: &PointUm| [0, 1].map(|k| (p[k] - ring[0][k]) as f64);
    let twice: f64 =
        ring.iter().zip(next).map(|(p, q)| (at(p), at(q))).map(|(p, q)| p[0] * q[1] - p[1] * q[0]).sum();
    twice.abs() / 2.0
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use enfilade_cad::drawing::{Editable, SourceRef, Vertex};

    const METRES: Frame = Frame { metres_per_unit: 1.0, origin_um: [0, 0] };

    /// A square on a layer of terraces.
    fn square(side: f64) -> Entity {
        let corners = [[0.0, 0.0], [side, 0.0], [side, side], [0.0, side]];
        let source = SourceRef {
            record: 0,
            handle: None,
            line: 0,
            kind: "LWPOLYLINE".into(),
            layer: "Terrace".into(),
        };
        Entity {
            source,
            layer: "Terrace".into(),
            shape: Shape::Polyline {
                vertices: corners.map(|p| Vertex { at: DVec2::from(p), bulge: 0.0 }).to_vec(),
                closed: true,
            },
            editable: Editable::Free,
            blocks: Vec::new(),
            origin: Default::default(),
        }
    }

    #[test]
    fn pots_are_no_terraces_and_more_outlines_than_the_limit_are_not_looked_at() {
        let least = AREA_MIN_M2.sqrt();
        let drawing = Drawing::of(vec![square(0.99 * least), square(1.01 * least), square(9.0)]);
        assert_eq!(find(&drawing, |i| i == 2, &METRES, 1.0).len(), 1);
        assert_eq!(find(&drawing, |_| false, &METRES, 1.0).len(), 2);
        let many = Drawing::of(vec![square(3.0); RINGS_MAX + 1]);
        assert_eq!(find(&many, |_| false, &METRES, 1.0).len(), RINGS_MAX);
    }
}

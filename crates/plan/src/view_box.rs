//! A box round the drawing that is meant: only what lies in it is read.

use std::borrow::Cow;

use glam::DVec2;

use super::by_place::gap;
use super::view_names::Title;
use super::views::View;
use enfilade_cad::curve::control_points;
use enfilade_cad::drawing::{Drawing, Entity, Layer, Shape};
use enfilade_cad::own_layers::is_own;
use enfilade_cad::plane::box_of;

/// The layer, switched off, of what lies outside the box.
const OUTSIDE: &str = "(outside the view)";

/// The box that `--view` states as `xmin,ymin,xmax,ymax`, drawing units; its corners in any order.
pub fn stated(view: Option<&str>) -> Option<[DVec2; 2]> {
    let numbers: Option<Vec<f64>> = view?.split(',').map(|n| n.trim().parse().ok()).collect();
    let [x0, y0, x1, y1] = numbers?.try_into().ok()?;
    let (p, q) = (DVec2::new(x0, y0), DVec2::new(x1, y1));
    (p.is_finite() && q.is_finite()).then(|| [p.min(q), p.max(q)])
}

/// The drawing with all that does not lie wholly in the stated box switched off, so that places and numbers of entities
/// stay. Marks of ours stay as they are.
pub fn within<'a>(drawing: &'a Drawing, view: Option<&str>) -> Cow<'a, Drawing> {
    let Some([lo, hi]) = stated(view) else { return Cow::Borrowed(drawing) };
    let is_in = |[a, b]: [DVec2; 2]| a.cmpge(lo).all() && b.cmple(hi).all();
    let mut out = drawing.clone();
    for e in out.entities.iter_mut().chain(&mut out.fills).filter(|e| !is_own(&e.layer)) {
        if !extent(e).is_some_and(is_in) {
            OUTSIDE.clone_into(&mut e.layer);
        }
    }
    for text in out.texts.iter_mut().filter(|t| !is_own(&t.layer) && !is_in([t.at, t.at])) {
        OUTSIDE.clone_into(&mut text.layer);
    }
    out.layers.push(Layer { name: OUTSIDE.into(), is_off: true, is_frozen: true, is_locked: false });
    Cow::Owned(out)
}

/// The box as the one drawing that is read.
pub(super) fn view([lo, hi]: [DVec2; 2], wall_pieces: usize) -> View {
    View {
        number: 1,
        name: "box".into(),
        extent: [lo, hi],
        wall_pieces,
        column_pieces: 0,
        swings: 0,
        kind: Title::Plan,
        is_chosen: true,
        why: "--view states its box".into(),
        confidence: 1.0,
    }
}

/// Whether a mark with some box has a part in the stated one.
pub(super) fn meets(stated: &[DVec2; 2], mark: &[DVec2; 2]) -> bool {
    gap(stated, mark) == 0.0
}

/// The box of an entity, a circle's too.
pub(super) fn extent(e: &Entity) -> Option<[DVec2; 2]> {
    let round = match e.shape {
        Shape::Circle { centre, radius } => vec![centre - radius, centre + radius],
        _ => Vec::new(),
    };
    box_of(control_points(&e.shape).into_iter().chain(round))
}

//! Texts that stand at doors and windows.

use glam::DVec2;

use super::Plan;
use super::fittings::Fitting;
use enfilade_cad::curve::control_points;
use enfilade_cad::drawing::{Drawing, Shape, SourceRef};
use enfilade_cad::own_layers;
use enfilade_cad::plane::box_of;

/// A text farther than this beyond the box of a door's part belongs to something else, metres of a person.
const BESIDE_M: f64 = 0.15;

/// A text at a part of a door or window.
#[derive(Clone, Debug, PartialEq)]
pub struct Label {
    /// The text.
    pub source: SourceRef,
    /// The part nearest to it, an index into the fittings.
    pub fitting: usize,
}

/// Texts at parts of doors and windows, those that are shown by such a part left out; in the order of the file.
pub fn labels(plan: &Plan, drawing: &Drawing, fittings: &[Fitting]) -> Vec<Label> {
    let beside = BESIDE_M * plan.human_scale / plan.frame.metres_per_unit;
    let boxes: Vec<Option<[DVec2; 2]>> = fittings.iter().map(|f| extent(&f.shape)).collect();
    let texts = drawing.texts.iter().filter(|t| !own_layers::is_own(&t.layer));
    let at_one = texts.filter_map(|t| {
        let gap = |b: &[DVec2; 2]| (t.at - t.at.clamp(b[0], b[1])).length();
        let near = boxes.iter().enumerate().filter_map(|(i, b)| b.as_ref().map(|b| (gap(b), i)));
        let (gap, fitting) = near.min_by(|a, b| a.0.total_cmp(&b.0))?;
        let is_shown = fittings.iter().any(|f| f.source.record == t.source.record);
        (gap <= beside && !is_shown).then(|| Label { source: t.source.clone(), fitting })
    });
    at_one.collect()
}

fn extent(shape: &Shape) -> Option<[DVec2; 2]> {
    match shape {
        Shape::Circle { centre, radius } => Some([*centre - *radius, *centre + *radius]),
        _ => box_of(control_points(shape).into_iter()),
    }
}

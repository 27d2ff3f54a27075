//! In what a scene measures: metres as the standard says, unless its walls cannot be so high.

use glam::DVec3;

use super::ReadOptions;
use super::bodies::SCENE_LAYER;
use super::body::Body;
use crate::drawing::Unit;
use crate::sizes::{Sizes, Verdict};

/// The unit of the standard.
pub(super) const METRE: Unit = Unit { name: "m", metres: 1.0 };

/// In what a scene measures.
pub(super) struct Scale {
    /// Metres in one unit.
    pub metres: f64,
    /// The unit, where the walls cannot be as high as they are in metres.
    pub by_heights: Option<Unit>,
    /// The standard's words for its unit, and what stands against it.
    pub words: String,
    /// Why metres are doubted.
    pub doubt: Option<String>,
}

impl Scale {
    /// By the user's word, by the standard, or by how high walls are.
    pub fn of(bodies: &[Body<'_>], options: &ReadOptions) -> Self {
        let words = "the standard (metres, Y up)".to_string();
        let believed = Self { metres: 1.0, by_heights: None, words: words.clone(), doubt: None };
        if let Some(unit) = options.unit {
            return Self { metres: unit.metres, ..believed };
        }
        match sizes(bodies).verdict(METRE) {
            Verdict::Believed => believed,
            Verdict::Instead(unit, against) => Self {
                metres: unit.metres,
                by_heights: Some(unit),
                words: format!("{words}, in which it has {against}"),
                ..believed
            },
            Verdict::Doubted(text) => Self { doubt: Some(text), ..believed },
        }
    }
}

/// What elements measure, units of the scene.
fn sizes(bodies: &[Body<'_>]) -> Sizes {
    let is_scene = bodies.iter().any(|b| b.layer == SCENE_LAYER);
    let points = || bodies.iter().flat_map(|b| b.triangles.iter().flatten());
    let low = points().fold(DVec3::INFINITY, |lo, p| lo.min(*p));
    let size = points().fold(DVec3::NEG_INFINITY, |hi, p| hi.max(*p)) - low;
    // The width of a door is the diagonal of its box, whichever way it stands; its depth is little beside it.
    let width = |b: &Body<'_>| {
        let points = b.triangles.iter().flatten().map(|p| p.truncate());
        crate::plane::box_of(points).map(|[lo, hi]| hi.distance(lo))
    };
    Sizes {
        wall_heights: bodies.iter().filter(|b| b.is_wall).map(|b| b.high - b.low).collect(),
        door_widths: bodies.iter().filter(|b| b.layer == "IfcDoor").filter_map(width).collect(),
        scene: is_scene.then_some([size.z, size.x.max(size.y)]),
        ..Sizes::default()
    }
}

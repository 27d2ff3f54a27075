//! A drawing of what we add and of nothing else, to be attached to another one as a reference.

use glam::DVec2;

use super::header::code_of;
use super::patch::patch;
use crate::drawing::{Addition, Mark, Unit};
use enfilade_report::Error;

/// R2010 with nothing in it. Words in braces are filled in.
const EMPTY: &str = include_str!("empty.dxf");

/// A DXF of the additions alone, drawing units, with `unit` as the unit of its header: 0, none, where that knows it not.
/// The first view shows all of it.
///
/// # Errors
/// [`Error::Input`] where an addition has no finite coordinates or no size.
pub fn sheet(unit: Unit, additions: &[Addition]) -> Result<Vec<u8>, Error> {
    let points = || additions.iter().flat_map(|a| corners(&a.mark)).copied().filter(|p| p.is_finite());
    let low = points().reduce(DVec2::min).unwrap_or(DVec2::ZERO);
    let high = points().reduce(DVec2::max).unwrap_or(DVec2::ONE);
    let (middle, size) = ((low + high) / 2.0, (high - low).max_element().max(f64::MIN_POSITIVE));
    let mut text = EMPTY.replace("{unit}", &code_of(unit).to_string());
    let numbers = [
        ("{low-x}", low.x),
        ("{low-y}", low.y),
        ("{high-x}", high.x),
        ("{high-y}", high.y),
        ("{middle-x}", middle.x),
        ("{middle-y}", middle.y),
        ("{size}", size),
    ];
    for (word, value) in numbers {
        text = text.replace(word, &super::tokens::number_text(value));
    }
    patch("notes.dxf", text.as_bytes(), &[], additions)
}

fn corners(mark: &Mark) -> &[DVec2] {
    match mark {
        Mark::Path { points, .. } => points,
        Mark::Fill { corners } => corners,
        Mark::Text { at, .. } => std::slice::from_ref(at),
    }
}

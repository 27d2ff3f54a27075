//! How high and how large the elements of a building are.

use super::Sight;
use super::building::Building;
use super::model::{Product, Storey, body_items, layer_reach};
use crate::sizes::Sizes;
use glam::DAffine3;

/// Elements of a kind by whose sizes a stated unit is judged: the middle of so many is that of all.
const SIZED_MAX: usize = 200;

/// Where a door states its width (`OverallWidth`).
const DOOR_WIDTH: usize = 9;

/// Heights of a storey's floor and of its cut, file units.
pub(super) fn heights(b: &Building<'_, '_>, storey: Option<&Storey>, sight: Sight) -> (f64, f64) {
    let above = sight.above_m() / b.geo.metres;
    let floor = storey.map_or_else(|| lowest(b, above), |s| s.floor);
    (floor, floor + above)
}

/// The floor of a building without storeys: of all heights at which walls start, the one above which most
/// walls are cut.
fn lowest(b: &Building<'_, '_>, above: f64) -> f64 {
    let spans = wall_spans(b, usize::MAX);
    let sorted = |k: usize| {
        let mut values: Vec<f64> = spans.iter().filter(|s| s[0] < s[1]).map(|s| s[k]).collect();
        values.sort_by(f64::total_cmp);
        values
    };
    let (lows, highs) = (sorted(0), sorted(1));
    let cut = |floor: f64| {
        let z = floor + above;
        lows.partition_point(|v| *v < z) - highs.partition_point(|v| *v <= z)
    };
    let floors = spans.iter().map(|s| s[0]);
    floors.max_by(|a, b| cut(*a).cmp(&cut(*b)).then(b.total_cmp(a))).unwrap_or(0.0)
}

/// What elements measure, file units.
pub(super) fn sizes(b: &Building<'_, '_>) -> Sizes {
    let walls = b.model.products.iter().filter(|p| p.class.starts_with("IfcWall")).take(SIZED_MAX);
    let thickness = |p: &Product| layer_reach(b.step, &b.model, p.id).map(|[left, right]| right - left);
    let doors = b.model.fillers.iter().filter(|p| p.class == "IfcDoor").take(SIZED_MAX);
    let width = |p: &Product| b.step.args(p.id).get(DOOR_WIDTH)?.number();
    Sizes {
        wall_heights: wall_spans(b, SIZED_MAX).iter().map(|s| s[1] - s[0]).collect(),
        door_widths: doors.filter_map(width).collect(),
        storey_heights: b.model.storeys.windows(2).map(|s| s[1].floor - s[0].floor).collect(),
        thicknesses: walls.filter_map(thickness).collect(),
        scene: None,
    }
}

/// Lowest and highest point of the first walls with a body, file units.
pub(super) fn wall_spans(b: &Building<'_, '_>, most: usize) -> Vec<[f64; 2]> {
    let mut spans: Vec<[f64; 2]> = Vec::new();
    for p in b.model.products.iter().filter(|p| p.class.starts_with("IfcWall")).take(most) {
        let world = p.placement.map_or(Ok(DAffine3::IDENTITY), |m| b.geo.placement(m));
        let items = p.shape.and_then(|s| body_items(b.step, s).ok());
        if let (Ok(world), Some(items)) = (world, items) {
            let reach = items.iter().filter_map(|i| b.geo.reach(*i, &world, 0).ok());
            let span =
                reach.fold([f64::INFINITY, f64::NEG_INFINITY], |s, r| [s[0].min(r[0]), s[1].max(r[1])]);
            spans.extend(Some(span).filter(|s| s[0].is_finite()));
        }
    }
    spans
}

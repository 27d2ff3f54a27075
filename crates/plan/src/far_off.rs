//! Walls of a building that stand where nothing else of it is.

use glam::DVec2;

use super::on_sheet::middle;
use enfilade_cad::curve::control_points;
use enfilade_cad::drawing::Entity;
use enfilade_cad::plane::box_of;

/// In a building a wall is a slip if it stands this many times farther from the middle of most than most of them reach,
/// and farther than [`FAR_M`].
const FAR_TIMES: f64 = 20.0;
/// What stands nearer to the middle of a building is never far off, metres: sites with several houses are smaller.
pub const FAR_M: f64 = 250.0;

/// The share of a building's outlines, the nearest first, that say how far it reaches; fewer than so many say nothing.
const REACHED_SHARE: f64 = 0.75;
const OUTLINES_MIN: usize = 4;

/// Which walls of a building stand where nothing else of it is: one would stretch everything until the building is a dot.
pub fn far_off(walls: &[&Entity], metres_per_unit: f64) -> Vec<bool> {
    let middles: Vec<DVec2> = walls.iter().map(|w| middle(&w.shape)).collect();
    if middles.len() < OUTLINES_MIN {
        return vec![false; walls.len()];
    }
    let at = |share: f64, mut values: Vec<f64>| {
        let k = ((values.len() - 1) as f64 * share) as usize;
        *values.select_nth_unstable_by(k, f64::total_cmp).1
    };
    let pick = |pick: fn(&DVec2) -> f64| at(0.5, middles.iter().map(pick).collect());
    let centre = DVec2::new(pick(|p| p.x), pick(|p| p.y));
    let boxes = || walls.iter().map(|w| box_of(control_points(&w.shape).into_iter()));
    let farthest =
        |[lo, hi]: [DVec2; 2]| (centre - lo).abs().max((hi - centre).abs()).length() * metres_per_unit;
    let reach = at(REACHED_SHARE, boxes().flatten().map(farthest).collect());
    let limit = (FAR_TIMES * reach).max(FAR_M);
    let nearest = |[lo, hi]: [DVec2; 2]| (centre.clamp(lo, hi) - centre).length() * metres_per_unit;
    boxes().map(|b| b.is_some_and(|b| nearest(b) > limit)).collect()
}

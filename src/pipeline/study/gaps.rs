//! Gaps that are closed for sight although nothing is drawn there, in words.

use glam::DVec2;

use crate::plan::Plan;
use crate::plan::axes::AxisGraph;
use crate::plan::axes::tolerances::ERROR_GAP_M;
use crate::report::{Place, Report, counted};

/// How many gaps are named by their place.
const TOLD: usize = 3;

/// Says how many gaps of drawing error are closed, and where the first are, drawing units.
pub(super) fn state_closed(plan: &Plan, axes: &AxisGraph, report: &mut Report) {
    let places: Vec<DVec2> = axes
        .closures
        .iter()
        .map(|c| plan.frame.file_from_um(plan.frame.um_from_plan((c.a + c.b) / 2.0 * plan.human_scale)))
        .collect();
    if places.is_empty() {
        return;
    }
    let told: Vec<String> =
        places.iter().take(TOLD).map(|p| format!("{},{}", short(p.x), short(p.y))).collect();
    let more = if places.len() > TOLD { ", …" } else { "" };
    let text = format!(
        "{} between walls in line, up to {} m wide, taken as drawing error and closed for sight: at {}{more} (drawing units); \
         a gap to be seen through is drawn wider",
        counted(places.len() as u64, "gap"),
        short(ERROR_GAP_M * plan.human_scale),
        told.join(" and ")
    );
    report.info("gaps-closed", Place::file(&plan.file), text);
}

/// Four decimals at most.
fn short(v: f64) -> f64 {
    (v * 1e4).round() / 1e4 + 0.0
}

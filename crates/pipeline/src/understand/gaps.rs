//! Gaps that are closed for sight although nothing is drawn there, in words.

use crate::understand::understood::{Understood, closed_that_stay};
use enfilade_engine::geometry::Segment;
use enfilade_plan::sizes::ERROR_GAP_M;
use enfilade_report::{Place, Report, counted};

/// How many gaps are named by their place.
const TOLD: usize = 3;

/// Says how many gaps of drawing error are closed, and where the first are, drawing units; and how many are not, since a
/// wall that may move ends there.
pub(crate) fn state_closed(base: &Understood, report: &mut Report) {
    let plan = &base.plan;
    let um = |p| plan.frame.um_from_plan(p * plan.human_scale);
    let stay = closed_that_stay(base);
    let gaps = base.axes.closures.iter().map(|c| Segment { a: um(c.a), b: um(c.b) });
    let (closed, open): (Vec<Segment>, Vec<Segment>) = gaps.partition(|gap| stay.contains(gap));
    if closed.is_empty() {
        return;
    }
    let place = |s: &Segment| {
        let [a, b] = [s.a, s.b].map(|p| plan.frame.file_from_um(p));
        let middle = (a + b) / 2.0;
        format!("{},{}", short(middle.x), short(middle.y))
    };
    let told: Vec<String> = closed.iter().take(TOLD).map(place).collect();
    let more = if closed.len() > TOLD { ", …" } else { "" };
    let beside = match open.len() {
        0 => String::new(),
        n => format!("; {} where a wall ends that may move left open", counted(n as u64, "such gap")),
    };
    let text = format!(
        "{} between walls in line, up to {} m wide, taken as drawing error and closed for sight: at {}{more} (drawing \
         units){beside}; a gap to be seen through is drawn wider",
        counted(closed.len() as u64, "gap"),
        short(ERROR_GAP_M * plan.human_scale),
        told.join(" and ")
    );
    report.info("gaps-closed", Place::file(&plan.file), text);
}

/// Four decimals at most.
fn short(v: f64) -> f64 {
    (v * 1e4).round() / 1e4 + 0.0
}

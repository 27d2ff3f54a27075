//! What is said of options that take walls out of the building altogether: a slip in a mark, mostly.

use glam::DVec2;

use crate::measure::study::Study;
use crate::understand::named;
use crate::write::made::Made;
use enfilade_cad::plane::box_of;
use enfilade_moves::{Layout, MovedWall};
use enfilade_plan::Plan;
use enfilade_report::Report;

/// Walls of an option that end up farther from the building than it is long, and how far, metres; the farthest first.
fn leaving<'l>(plan: &Plan, layout: &'l Layout) -> Vec<(&'l MovedWall, f64)> {
    let at = |p: &[i64; 2]| plan.frame.plan_from_um(*p);
    let walls = plan.walls.iter().flat_map(|w| &w.trace.points);
    let Some([lo, hi]) = box_of(walls.map(at)) else { return Vec::new() };
    let far = |m: &'l MovedWall| {
        let [a, b] = box_of(m.trace.points.iter().map(at))?;
        let middle: DVec2 = a.midpoint(b);
        Some((m, middle.distance(middle.clamp(lo, hi))))
    };
    let changed = layout.walls.iter().filter(|m| m.is_changed);
    let mut out: Vec<_> = changed.filter_map(far).filter(|(_, m)| *m > lo.distance(hi)).collect();
    out.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.wall.cmp(&b.0.wall)));
    out
}

/// The same as a sentence among an option's words; empty for none.
pub(crate) fn leaving_words(plan: &Plan, layout: &Layout) -> String {
    match leaving(plan, layout).first() {
        Some((_, far_m)) => {
            format!(" What moves is thrown out of the building, {far_m:.0} m away from it: see to its mark.")
        }
        None => String::new(),
    }
}

/// Names the farthest such wall of every option.
pub(crate) fn say_leaving(report: &mut Report, file: &str, study: &Study, made: &[Made]) {
    let plan = &study.base.plan;
    for (i, m) in made.iter().enumerate() {
        let Some((wall, far_m)) = leaving(plan, &m.layout).first().copied() else { continue };
        let text = format!(
            "option {} takes it {far_m:.0} m away from the building, farther than that is long; expected a move within it: \
             look at the bounds of its mark, and at the point that it turns about",
            i + 1
        );
        report.warn("options-leaving", named::place(file, plan, &plan.walls[wall.wall as usize]), text);
    }
}

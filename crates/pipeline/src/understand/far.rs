//! Turns and scales about a point that is far off the building: mostly a point in other coordinates.

use enfilade_cad::drawing::place_in;
use enfilade_cad::plane::box_of;
use enfilade_overlay::words::compass;
use enfilade_plan::Plan;
use enfilade_plan::markers::{Group, Kind};
use enfilade_report::Report;

/// Names the clauses whose point is farther from the building than that is long.
pub(crate) fn state_far_centres<'a>(
    groups: impl Iterator<Item = &'a Group>,
    plan: &Plan,
    report: &mut Report,
) {
    let walls = plan.walls.iter().flat_map(|w| &w.trace.points);
    let Some([lo, hi]) = box_of(walls.map(|p| plan.frame.plan_from_um(*p))) else { return };
    for group in groups {
        for clause in &group.clauses {
            let (what, about) = match clause.kind {
                Kind::Rotate(Some(p)) => ("turns", p),
                Kind::Scale(Some(p)) => ("is scaled", p),
                _ => continue,
            };
            let at = plan.frame.plan_from_file(about);
            let way = at - at.clamp(lo, hi);
            if way.length() <= lo.distance(hi) {
                continue;
            }
            let middle = plan.frame.file_from_um(plan.frame.um_from_plan(lo.midpoint(hi)));
            let [x, y] = middle.to_array().map(|v| (v * 100.0).round() / 100.0 + 0.0);
            let text = format!(
                "group {:?} {what} about {}, {}, which is {:.0} m {} of the building, farther off than that is long; expected a \
                 point near it, whose middle is at {x}, {y} in the drawing's coordinates: it is thrown far rather than turned",
                group.name,
                about.x,
                about.y,
                way.length(),
                compass(way.to_angle().to_degrees()),
            );
            report.warn("move-far-centre", place_in(&plan.file, &group.source), text);
        }
    }
}

//! Default moves that would leave a door or a window behind are none.

use crate::moves::Moves;
use crate::moves::carried::{Carried, carried};
use crate::plan::Plan;
use crate::plan::axes::AxisGraph;
use crate::plan::fittings::Fitting;
use crate::plan::graph::Graph;
use crate::plan::markers::Group;
use crate::report::{Place, Report};

/// Names that are told one by one.
const TOLD: usize = 6;

/// The groups with which all doors and windows go along to both ends of their ways; the others stay and are named.
pub(super) fn whole_moves(
    plan: &Plan,
    graph: &Graph,
    axes: &AxisGraph,
    fittings: &[Fitting],
    groups: Vec<(Group, Vec<u32>)>,
    report: &mut Report,
) -> Vec<(Group, Vec<u32>)> {
    let leaves_behind = |group: &(Group, Vec<u32>)| {
        let alone = Moves::new(plan, graph, axes, std::slice::from_ref(group), &mut Report::default());
        let bounds = alone.bounds();
        [0, 1].iter().any(|end| {
            let at: Vec<f64> = bounds.iter().map(|b| b[*end]).collect();
            let layout = alone.apply(plan, graph, &at);
            fittings.iter().any(|f| matches!(carried(plan, f, &layout), Carried::Stale(_)))
        })
    };
    let (stay, move_whole): (Vec<_>, Vec<_>) = groups.into_iter().partition(leaves_behind);
    if !stay.is_empty() {
        let names: Vec<&str> = stay.iter().take(TOLD).map(|g| g.0.name.as_str()).collect();
        let more = if stay.len() > TOLD { ", …" } else { "" };
        let text = format!(
            "{} of the walls and doors that could move by default stay, because a door or window beside them could not \
             go along ({}{more}); EF-MOVE moves them all the same",
            stay.len(),
            names.join(", ")
        );
        report.info("default-moves-stay", Place::file(&plan.file), text);
    }
    move_whole
}

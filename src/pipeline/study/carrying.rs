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

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::*;
    use crate::config::{Partial, Settings};
    use crate::pipeline::study;

    /// Whatever moves by default takes its doors and windows along, to both ends of its way.
    #[test]
    fn default_moves_leave_no_door_behind() {
        let Some(shared) = std::env::var_os("ENFILADE_SHARED") else {
            eprintln!("skipped: ENFILADE_SHARED names no folder with the drawings");
            return;
        };
        for (name, may_move) in [("us_house_bishop", 8), ("gama_house_librecad", 2)] {
            let file = format!("{name}.dxf");
            let bytes = std::fs::read(PathBuf::from(&shared).join("data/dxf").join(&file)).unwrap();
            let settings = Settings::new(Partial::default()).unwrap();
            let mut report = Report::default();
            let base = study::read(&file, &bytes, &settings, &mut report).unwrap();
            let (bounds, identity) = (base.moves.bounds(), base.moves.identity());
            assert!(bounds.len() >= may_move, "{name}: {} parameters", bounds.len());
            assert!(!base.fittings.is_empty(), "{name}");
            assert!(report.problems.iter().any(|p| p.code == "default-moves-stay"), "{name}");
            for (k, end) in bounds.iter().enumerate().flat_map(|(k, b)| b.map(|end| (k, end))) {
                let mut p = identity.clone();
                p[k] = end;
                let layout = base.moves.apply(&base.plan, &base.graph, &p);
                for fitting in &base.fittings {
                    let outcome = carried(&base.plan, fitting, &layout);
                    let group = &base.moves.parameters[k].group_name;
                    assert!(!matches!(outcome, Carried::Stale(_)), "{name} {group}: {outcome:?}");
                }
            }
        }
    }
}

//! Default moves that would leave a door or a window behind are none.

use std::collections::BTreeSet;

use enfilade_cad::drawing::Format;
use enfilade_moves::Moves;
use enfilade_moves::carried::{Carried, carried};
use enfilade_plan::Plan;
use enfilade_plan::axes::AxisGraph;
use enfilade_plan::fittings::Fitting;
use enfilade_plan::graph::{Graph, Handle};
use enfilade_plan::markers::Group;
use enfilade_report::{Place, Report};

/// Most groups whose bounds are tried in every combination.
const GROUPS_TRIED: usize = 4;

/// Names that are told one by one.
const TOLD: usize = 6;

/// The groups with which all doors and windows go along to both ends of their ways, alone and together with any other
/// that moves a wall at the same door or window; the others stay and are named.
pub(crate) fn whole_moves(
    plan: &Plan,
    graph: &Graph,
    axes: &AxisGraph,
    fittings: &[Fitting],
    groups: Vec<(Group, Vec<u32>)>,
    report: &mut Report,
) -> Vec<(Group, Vec<u32>)> {
    let moves = |groups: &[(Group, Vec<u32>)]| Moves::new(plan, graph, axes, groups, &mut Report::default());
    let leaves_behind = |moves: &Moves| {
        corners(moves).iter().any(|at| {
            let layout = moves.apply(plan, graph, at);
            fittings.iter().any(|f| matches!(carried(plan, f, &layout), Carried::Stale(_)))
        })
    };
    let at_jambs = |moves: &Moves| -> BTreeSet<usize> {
        let handles: BTreeSet<&Handle> = moves.handles().collect();
        let is_at = |f: &Fitting| f.jambs.iter().flatten().any(|h| handles.contains(h));
        (0..fittings.len()).filter(|i| is_at(&fittings[*i])).collect()
    };
    let is_kept = |n: &u32| {
        let at = plan.frame.um_from_plan(graph.nodes[*n as usize]);
        plan.markers.keep.iter().any(|r| r.contains(at))
    };
    // What is held, and what a door or window holds.
    let mut stay: [Vec<Group>; 2] = Default::default();
    let mut move_whole: Vec<(Group, Vec<u32>)> = Vec::new();
    let mut taken: Vec<BTreeSet<usize>> = Vec::new();
    for group in groups {
        let alone = moves(std::slice::from_ref(&group));
        let own = at_jambs(&alone);
        let tears = leaves_behind(&alone)
            || move_whole.iter().zip(&taken).any(|(other, theirs)| {
                !own.is_disjoint(theirs) && leaves_behind(&moves(&[other.clone(), group.clone()]))
            });
        if tears {
            stay[usize::from(!group.1.iter().any(is_kept))].push(group.0);
        } else {
            move_whole.push(group);
            taken.push(own);
        }
    }
    let [held, torn] = stay;
    let words = plan.format.marking();
    let why = format!(
        "{} holds a part of them, and the doors and windows beside them would not go along",
        words.kept_region
    );
    state_staying(&held, (&why, &format!("without that {} they move", words.keeps)), plan, report);
    let why = "a door or window beside them could not go along";
    state_staying(&torn, (why, &marks_win(plan)), plan, report);
    move_whole
}

/// The groups that change no wall of the structure, not even by taking its end along; the others stay and are named. In a
/// drawing of lines a wall is many, and a line of one that carries may end at another: there the axes have decided.
pub(crate) fn without_structure(
    plan: &Plan,
    graph: &Graph,
    axes: &AxisGraph,
    groups: Vec<(Group, Vec<u32>)>,
    report: &mut Report,
) -> Vec<(Group, Vec<u32>)> {
    if plan.format == Format::Dxf || plan.bearing.is_empty() {
        return groups;
    }
    let changes_structure = |group: &(Group, Vec<u32>)| {
        let alone = Moves::new(plan, graph, axes, std::slice::from_ref(group), &mut Report::default());
        let records = alone.walls.iter().map(|w| plan.walls[*w as usize].source.record);
        records.into_iter().any(|r| plan.bearing.contains_key(&r))
    };
    let (stay, move_on): (Vec<_>, Vec<_>) = groups.into_iter().partition(changes_structure);
    let stay: Vec<Group> = stay.into_iter().map(|g| g.0).collect();
    let why = "a wall that carries would change with them";
    state_staying(&stay, (why, &marks_win(plan)), plan, report);
    move_on
}

/// What moves all the same what stays by default.
fn marks_win(plan: &Plan) -> String {
    format!("{} moves them all the same", plan.format.marking().moves)
}

/// Names groups that stay, if any: why, and what would make them move.
fn state_staying(stay: &[Group], (why, instead): (&str, &str), plan: &Plan, report: &mut Report) {
    if stay.is_empty() {
        return;
    }
    let names: Vec<&str> = stay.iter().take(TOLD).map(|g| g.name.as_str()).collect();
    let more = if stay.len() > TOLD { ", …" } else { "" };
    let text = format!(
        "{} of the walls and doors that could move by default stay, because {why} ({}{more}); {instead}",
        stay.len(),
        names.join(", ")
    );
    report.info("default-moves-stay", Place::file(&plan.file), text);
}

/// The places where every group stands with all its parameters at their lower or their upper bounds, in any combination.
fn corners(moves: &Moves) -> Vec<Vec<f64>> {
    let bounds = moves.bounds();
    let corner = |bits: u32| {
        let at = moves.parameters.iter().zip(&bounds).map(|(p, b)| b[(bits >> p.group & 1) as usize]);
        at.collect()
    };
    (0..1u32 << moves.groups.len().min(GROUPS_TRIED)).map(corner).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::read;
    use crate::understand::understood;
    use enfilade_config::{Partial, Settings};

    /// Whatever moves by default takes its doors and windows along, to both ends of its way.
    #[test]
    fn default_moves_leave_no_door_behind() {
        let Some(data) = enfilade_fixtures::shared("data") else { return };
        let drawings = [
            ("us_house_bishop", 4, false),
            ("gama_house_librecad", 1, true),
            ("potynobg_pianta_house", 2, false),
            ("pms_building001_floor3_aia", 9, true),
        ];
        for (name, may_move, some_stay) in drawings {
            let file = format!("{name}.dxf");
            let bytes = std::fs::read(data.join("dxf").join(&file)).unwrap();
            let settings = Settings::new(Partial::default()).unwrap();
            let mut report = Report::default();
            let base = understood(
                &read::drawing(&file, &bytes, &settings, &mut report).unwrap(),
                &settings,
                &mut report,
            )
            .unwrap();
            let (bounds, identity) = (base.moves.bounds(), base.moves.identity());
            assert!(bounds.len() >= may_move, "{name}: {} parameters", bounds.len());
            assert!(!base.fittings.is_empty(), "{name}");
            let stay = report.problems.iter().any(|p| p.code == "default-moves-stay");
            assert_eq!(stay, some_stay, "{name}");
            let at = |k: usize, end: f64| {
                let mut p = identity.clone();
                p[k] = end;
                p
            };
            let each = bounds.iter().enumerate().flat_map(|(k, b)| b.map(|end| at(k, end)));
            let all = [0, 1].map(|end| bounds.iter().map(|b| b[end]).collect::<Vec<f64>>());
            for p in each.chain(all) {
                let layout = base.moves.apply(&base.plan, &base.graph, &p);
                for fitting in &base.fittings {
                    let outcome = carried(&base.plan, fitting, &layout);
                    assert!(!matches!(outcome, Carried::Stale(_)), "{name} {p:?}: {outcome:?}");
                }
            }
        }
    }
}

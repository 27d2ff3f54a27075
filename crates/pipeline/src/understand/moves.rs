//! What may move: as a side-car, the file itself or marks say, else by default.

use crate::understand::jambs::keeping_doors;
use crate::understand::marked::{
    self, side_car_groups, state_left, state_passed_over, state_unread_marks, state_unread_moves,
};
use crate::understand::{building, carrying};
use enfilade_cad::drawing::Drawing;
use enfilade_config::{MoveTable, Settings};
use enfilade_engine::geometry::Segment;
use enfilade_engine::interior::Interior;
use enfilade_moves::{Moves, defaults, say_kept};
use enfilade_plan::Plan;
use enfilade_plan::allowed::is_of_works_alone;
use enfilade_plan::axes::AxisGraph;
use enfilade_plan::fittings::Fitting;
use enfilade_plan::graph::Graph;
use enfilade_plan::markers::Group;
use enfilade_report::{Error, Place, Report};

/// What is known of a plan before its moves.
pub(crate) struct Known<'a> {
    pub(crate) plan: &'a Plan,
    pub(crate) graph: &'a Graph,
    pub(crate) axes: &'a AxisGraph,
    pub(crate) interior: Option<&'a Interior>,
    pub(crate) fittings: &'a [Fitting],
    /// What is drawn between walls.
    pub(crate) infill: &'a [Segment],
}

/// Moves of a drawing, and the groups that somebody stated.
///
/// # Errors
/// [`Error::Usage`] for moves of a side-car that the drawing has no place for.
pub(crate) fn moves(
    drawing: &Drawing,
    known: &Known<'_>,
    settings: &Settings,
    report: &mut Report,
) -> Result<(Moves, Vec<Group>), Error> {
    let Known { plan, graph, axes, interior, fittings, infill } = *known;
    let named = |groups: Vec<(Group, Vec<u32>)>| groups.into_iter().map(|g| g.0).collect();
    let tables: Vec<MoveTable> =
        settings.moves.iter().filter(|t| !is_of_works_alone(&t.moves)).cloned().collect();
    if !tables.is_empty() {
        state_passed_over(drawing, plan, &tables, report);
        let (groups, records) = side_car_groups(drawing, plan, graph, (&tables, true), report)?;
        groups.iter().for_each(|(group, nodes)| say_kept(plan, graph, group, nodes, report));
        let moves = Moves::of_records(plan, graph, axes, (&groups, &records), report);
        return Ok((moves, named(groups)));
    }
    if building::movers(drawing).next().is_some() && !settings.ignore_move_markers {
        let stated = building::marked_moves(drawing);
        let (groups, records) = side_car_groups(drawing, plan, graph, (&stated, false), report)?;
        if groups.is_empty() {
            state_unread_marks(drawing.format.marking().moves, plan, report);
        }
        let moves = Moves::of_records(plan, graph, axes, (&groups, &records), report);
        return Ok((moves, named(groups)));
    }
    if !plan.markers.groups.is_empty() && !settings.ignore_move_markers {
        let moves = Moves::from_markers(plan, graph, axes, report);
        return Ok((moves, plan.markers.groups.clone()));
    }
    if marked::is_any(drawing, plan) && !settings.ignore_move_markers {
        state_unread_moves(drawing, plan, report);
        return Ok(Default::default());
    }
    if settings.only_marked {
        let text = "nothing is marked to move, and only what is marked may: the present layout is measured";
        report.info("nothing-marked", Place::file(&plan.file), text);
        let mut none = Moves::default();
        none.are_default = true;
        return Ok((none, Vec::new()));
    }
    match interior {
        Some(interior) if !settings.ignore_move_markers && settings.reading.as_drawn != Some(true) => {
            let groups = defaults::groups(plan, graph, axes, (interior, infill, fittings), report);
            let found = groups.iter().map(|(g, _)| g.clauses.len()).sum();
            let groups = carrying::whole_moves(plan, graph, axes, fittings, groups, report);
            let groups = keeping_doors(groups, (plan, graph, axes), report);
            let groups = carrying::without_structure(plan, graph, axes, groups, report);
            let mut own = Report::default();
            let mut moves = Moves::new(plan, graph, axes, &groups, &mut own);
            // A way that nobody stated ends where it must.
            own.problems.retain(|p| p.code != "move-shortened");
            report.extend(own);
            moves.are_default = true;
            state_left(&moves, (&groups, found), (plan, graph), report);
            Ok((moves, Vec::new()))
        }
        _ => Ok(Default::default()),
    }
}

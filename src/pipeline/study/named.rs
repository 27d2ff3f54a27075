//! Groups that are named rather than drawn: by tables of a side-car, or by what a file states of its own elements.

use std::collections::BTreeSet;

use glam::DVec2;

use crate::config::MoveTable;
use crate::pipeline::building;
use crate::plan::drawing::{Drawing, Format};
use crate::plan::graph::Graph;
use crate::plan::layers::WallLayers;
use crate::plan::markers::{self, Group, place_in};
use crate::plan::{Plan, Region};
use crate::report::{Error, Place, Report};

/// Side-car nodes are found again within this distance.
pub const SIDE_CAR_NODE_M: f64 = 0.005;

/// By group its nodes, and the records that alone move with it, where elements of a building are named.
type Named = (Vec<(Group, Vec<u32>)>, Vec<Option<BTreeSet<usize>>>);

/// The moves that a file states of its own elements and that can be read; the others are named, and their walls stay.
pub(super) fn readable(drawing: &Drawing, plan: &Plan, report: &mut Report) -> Vec<MoveTable> {
    let states = if drawing.format == Format::Ifc { "Pset_Enfilade" } else { "extras.enfilade" };
    let is_readable = |table: &MoveTable| {
        let Err(why) = markers::read_clauses(&table.moves, drawing, &plan.frame) else { return true };
        let is_of_it = |h: &Option<String>| table.handles.contains(h.as_ref().unwrap_or(&String::new()));
        for mark in drawing.marked.iter().filter(|m| m.text == table.moves && is_of_it(&m.source.handle)) {
            let text = format!("{states} states the move {why}; it stays as drawn");
            report.warn("move-mark", place_in(&plan.file, &mark.source), text);
        }
        false
    };
    building::marked_moves(drawing).into_iter().filter(is_readable).collect()
}

/// Groups of the walls that tables name.
///
/// # Errors
/// [`Error::Usage`] for clauses and layers that cannot be read.
pub(super) fn groups(
    drawing: &Drawing,
    plan: &Plan,
    graph: &Graph,
    moves: &[MoveTable],
    report: &mut Report,
) -> Result<Named, Error> {
    let mut out = Named::default();
    let is_dxf = drawing.format == Format::Dxf;
    for (i, table) in moves.iter().enumerate() {
        let name = table.name.clone().unwrap_or_else(|| format!("move-{}", i + 1));
        let nodes =
            markers::nodes_of(table.nodes.iter().map(|p| DVec2::from(*p)), plan, graph, SIDE_CAR_NODE_M);
        let mut nodes = nodes.unwrap_or_else(|p| {
            let text = format!(
                "[[move]] {name:?}: no wall end within {} mm of {:?}, {:?}; that node is left out",
                SIDE_CAR_NODE_M * 1e3,
                p.x,
                p.y
            );
            report.warn("move-node", Place::file(&plan.file), text);
            Vec::new()
        });
        let layers = WallLayers::new(&table.layers)?;
        let mut records = BTreeSet::new();
        for (w, wall) in plan.walls.iter().enumerate() {
            let by_handle =
                wall.source.handle.as_ref().is_some_and(|h| {
                    table.handles.iter().any(|t| t == h || is_dxf && t.eq_ignore_ascii_case(h))
                });
            if by_handle || (layers.is_by_user() && layers.reason(&wall.source.layer).is_some()) {
                nodes.extend(&graph.control_nodes[w]);
                records.insert(wall.source.record);
            }
        }
        nodes.sort_unstable();
        nodes.dedup();
        let clauses = markers::read_clauses(&table.moves, drawing, &plan.frame).map_err(|why| {
            Error::usage("move", Place::default(), format!("[[move]] {name:?}: {why}; nothing was done"))
        })?;
        let Some(first) = nodes.first() else {
            report.warn(
                "move-empty",
                Place::file(&plan.file),
                format!("[[move]] {name:?} names no wall of the drawing; nothing moves here"),
            );
            continue;
        };
        let first = graph.handles[*first as usize][0].0;
        let own = plan.walls.iter().find(|w| records.contains(&w.source.record));
        let source = own.unwrap_or(&plan.walls[first as usize]).source.clone();
        out.0.push((Group { name, outline: Region::Ring(Vec::new()), clauses, source }, nodes));
        out.1.push(Some(records).filter(|_| !is_dxf && table.nodes.is_empty()));
    }
    Ok(out)
}

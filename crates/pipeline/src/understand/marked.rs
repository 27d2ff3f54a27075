//! Moves that somebody states: a side-car's, a building's; and what is said where marks hold everything.

use std::collections::BTreeSet;

use glam::DVec2;

use crate::understand::behind::state_left_behind;
use crate::understand::building::movers;
use crate::understand::far::state_far_centres;
use crate::understand::idle::without_idle;
use crate::understand::jambs::ending_at_jambs;
use crate::understand::reach::within_reach;
use crate::understand::understood::Understood;
use enfilade_cad::drawing::{Drawing, Editable, Format, IdleMarks, place_in};
use enfilade_cad::ifc::KEEPS;
use enfilade_cad::layers::WallLayers;
use enfilade_cad::plane::box_of;
use enfilade_config::{MoveTable, Settings};
use enfilade_engine::Region;
use enfilade_moves::Moves;
use enfilade_plan::allowed::{self, Allowed, AllowedAt};
use enfilade_plan::graph::Graph;
use enfilade_plan::markers::{self, Group};
use enfilade_plan::slots::Slot;
use enfilade_plan::{Plan, Wall};
use enfilade_report::{Error, Place, Report, counted};

/// Whether anybody said in the drawing what moves or stays, so that it can be used or not: then nothing moves by default.
pub(crate) fn is_any(drawing: &Drawing, plan: &Plan) -> bool {
    let allows_works_alone = !drawing.marked.is_empty() && movers(drawing).next().is_none();
    let is_marked = drawing.idle_marks != IdleMarks::None && !allows_works_alone;
    plan.markers.is_move_drawn || movers(drawing).next().is_some() || is_marked
}

/// Says so where marks were made and none can be used: nobody who marks a wall means all the others.
pub(crate) fn state_unread_marks(marks: &str, plan: &Plan, report: &mut Report) {
    let text = format!(
        "nothing moves, the present layout is measured: what may move is said by {marks} here, and none of it can be used \
         as it stands (see the warnings); correct it, or take it away and walls move by default"
    );
    report.warn("moves-unread", Place::file(&plan.file), text);
}

/// The same where not even one could be taken up; where all that is marked stands on other storeys, that is no fault.
pub(crate) fn state_unread_moves(drawing: &Drawing, plan: &Plan, report: &mut Report) {
    if plan.markers.is_move_drawn || drawing.idle_marks != IdleMarks::Elsewhere {
        return state_unread_marks(drawing.format.marking().moves, plan, report);
    }
    let text = format!(
        "nothing moves on this storey, the present layout is measured: what may move is said by {} of other storeys",
        drawing.format.marking().moves
    );
    report.info("moves-elsewhere", Place::file(&plan.file), text);
}

/// Names what a mark of a building keeps and what could not move anyway, since it is no wall of the plan.
pub(crate) fn state_idle_keeps(drawing: &Drawing, plan: &Plan, report: &mut Report) {
    let mut seen: BTreeSet<usize> = plan.walls.iter().map(|w| w.source.record).collect();
    for e in &drawing.entities {
        let is_kept = matches!(&e.editable, Editable::No(why) if why == KEEPS) && e.layer == e.source.kind;
        // What stands in a wall keeps the wall.
        let is_of_walls = ["Wall", "Column", "Door", "Window"].iter().any(|k| e.source.kind.contains(k));
        if is_kept && !is_of_walls && seen.insert(e.source.record) {
            let text = "Keep of Pset_Enfilade: it is no wall of this plan, expected a wall, a column or a space; it would \
                        not move anyway";
            report.warn("ifc-marks", place_in(&drawing.file, &e.source), text);
        }
    }
}

/// Says so where marks of what may move are passed over, since the file of settings beside the drawing says it.
pub(crate) fn state_passed_over(drawing: &Drawing, plan: &Plan, moves: &[MoveTable], report: &mut Report) {
    state_edited(plan, moves, report);
    if is_any(drawing, plan) {
        let marks = drawing.format.marking().moves;
        let text = format!(
            "{marks} is passed over here: the [[move]] tables of the file of settings beside the drawing say what may move, and how \
             far; change them there, or delete them, and ignore-move-markers with them, to have {marks} read again"
        );
        report.info("marks-passed-over", Place::file(&plan.file), text);
    }
}

/// Names the markers that were drawn or changed since the drawing was accepted: what the side-car says of them wins.
fn state_edited(plan: &Plan, moves: &[MoveTable], report: &mut Report) {
    // Without any, a person wrote the tables and knows what they say.
    if moves.iter().all(|m| m.marker.is_none()) {
        return;
    }
    for group in &plan.markers.groups {
        let says = marker_words(plan, group);
        let own = moves.iter().find(|m| m.name.as_ref() == Some(&group.name));
        if own.is_some_and(|m| m.marker.as_ref().is_none_or(|known| *known == says)) {
            continue;
        }
        let instead = match own {
            Some(table) => format!("moves as the [[move]] table of that name says, `{}`", table.moves),
            None => "no [[move]] table is of that name, so it does not move".into(),
        };
        let text = format!(
            "group {:?} says {says} on layer {}: drawn or changed since the drawing was accepted, and not counted, since the \
             file of settings beside it wins: {instead}; change that table, or delete all [[move]] tables and \
             ignore-move-markers there to have the markers count",
            group.name, group.source.layer
        );
        report.warn("marks-edited", place_in(&plan.file, &group.source), text);
    }
}

/// What a marker says and where it is drawn, in its own unit and the drawing's coordinates.
pub fn marker_words(plan: &Plan, group: &Group) -> String {
    let clauses: Vec<String> = group.clauses.iter().map(ToString::to_string).collect();
    let corners = group.outline.outline().into_iter().map(|p| plan.frame.file_from_um(p));
    let rounded = |v: f64| (v * 1e3).round() / 1e3 + 0.0;
    let round = box_of(corners).map_or_else(String::new, |[lo, hi]| {
        let [a, b, c, d] = [lo.x, lo.y, hi.x, hi.y].map(rounded);
        format!(" in {a}, {b} to {c}, {d}")
    });
    format!("`{}`{round}", clauses.join("; "))
}

/// Says so where a region of what stays holds what would move by default, and how many of the parameters `found` are left where anything
/// stays.
pub(crate) fn state_left(
    moves: &Moves,
    (groups, found): (&[(Group, Vec<u32>)], usize),
    (plan, graph): (&Plan, &Graph),
    report: &mut Report,
) {
    let is_kept = |n: &u32| {
        let at = plan.frame.um_from_plan(graph.nodes[*n as usize]);
        plan.markers.keep.iter().any(|r| r.contains(at))
    };
    let held = groups.iter().filter(|(_, nodes)| nodes.iter().all(is_kept)).count();
    let told = report.problems.iter_mut().rev().find(|p| p.code == "default-moves");
    let Some(told) = told.filter(|_| moves.parameters.len() < found) else { return };
    let words = plan.format.marking();
    if held == 0 {
        told.text += &format!(
            "; some of them stay all the same, left: {}",
            counted(moves.parameters.len() as u64, "parameter")
        );
    } else if moves.parameters.is_empty() {
        told.text = format!(
            "nothing may move, the present layout is measured: {}, and {} holds all {held} elements, walls and doors that \
             would move by default",
            plan.markers.unmarked_words(words.moves),
            words.kept_region
        );
    } else {
        told.text += &format!(
            "; {} holds {held} of them here, left: {}",
            words.kept_region,
            counted(moves.parameters.len() as u64, "parameter")
        );
    }
}

/// The moves of marks as they are taken up: ways end where nothing beyond can be built, and what moves nothing is no
/// parameter.
pub(crate) fn taken_up(
    base: &mut Understood,
    groups: &[Group],
    settings: &Settings,
    report: &mut Report,
) -> Moves {
    state_far_centres(groups.iter(), &base.plan, report);
    if !settings.allow.narrow_ways {
        let known = (&base.plan, &base.graph, &base.axes);
        base.moves = ending_at_jambs(base.moves.clone(), groups.iter(), known, report);
    }
    let moves = within_reach(base, groups.iter(), settings, report);
    let Understood { plan, graph, fittings, .. } = &*base;
    let moves = without_idle(moves, groups.iter(), (plan, graph), settings, report);
    state_left_behind(&moves, groups.iter(), (plan, graph), fittings, report);
    state_structure(&moves, plan, report);
    moves
}

/// Names the walls of the structure that marks move all the same.
fn state_structure(moves: &Moves, plan: &Plan, report: &mut Report) {
    let mut told: BTreeSet<usize> = BTreeSet::new();
    for wall in moves.walls.iter().map(|w| &plan.walls[*w as usize]) {
        let record = wall.source.record;
        if let Some(bearing) = plan.bearing.get(&record).filter(|_| told.insert(record)) {
            let text = format!(
                "a mark moves it or its end, and it is one of the walls {}: by default it stays",
                bearing.words()
            );
            report.info("structure-moves", place_in(&plan.file, &wall.source), text);
        }
    }
}

/// Side-car nodes are found again within this distance.
pub const SIDE_CAR_NODE_M: f64 = 0.005;

/// By group its nodes, and the records that alone move with it, where elements of a building are named.
type Named = (Vec<(Group, Vec<u32>)>, Vec<Option<BTreeSet<usize>>>);

pub(crate) fn side_car_groups(
    drawing: &Drawing,
    plan: &Plan,
    graph: &Graph,
    (moves, is_side_car): (&[MoveTable], bool),
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
        let named = named_walls(plan, table)?;
        nodes.extend(named.iter().flat_map(|w| &graph.control_nodes[*w]));
        let mut records: BTreeSet<usize> = named.iter().map(|w| plan.walls[*w].source.record).collect();
        // Where the table names walls, their openings go with them.
        let is_named = |s: &&Slot| records.is_empty() && s.is_named(|h| table.handles.contains(h));
        let slots: Vec<&Slot> = plan.slots.iter().filter(is_named).collect();
        let sides = slots.iter().flat_map(|s| s.jambs.iter().flatten());
        nodes.extend(sides.map(|(w, c)| graph.control_nodes[*w as usize][*c as usize]));
        records.extend(slots.iter().map(|s| s.source.record));
        nodes.sort_unstable();
        nodes.dedup();
        let clauses = match markers::read_clauses(&table.moves, drawing, &plan.frame) {
            Ok(clauses) => clauses,
            Err(why) if is_side_car => {
                let text = format!("[[move]] {name:?}: {why}; nothing was done");
                return Err(Error::usage("move", Place::default(), text));
            }
            Err(why) => {
                say_of_marks(drawing, table, ("move-clause", &format!("{why}; it stays")), report);
                continue;
            }
        };
        let Some(first) = nodes.first() else {
            if is_side_car {
                let text = format!("[[move]] {name:?} names no wall of the drawing; nothing moves here");
                report.warn("move-empty", Place::file(&plan.file), text);
            } else {
                let text = "it is no wall of this plan, nor a door whose wall is alike on both sides of it; nothing moves by it";
                say_of_marks(drawing, table, ("move-empty", text), report);
            }
            continue;
        };
        let first = graph.handles[*first as usize][0].0;
        let own = plan.walls.iter().find(|w| records.contains(&w.source.record));
        let wall = || &own.unwrap_or(&plan.walls[first as usize]).source;
        let source = slots.first().map_or_else(wall, |s| &s.source).clone();
        out.0.push((Group { name, outline: Region::Ring(Vec::new()), clauses, source }, nodes));
        out.1.push(Some(records).filter(|_| !is_dxf && table.nodes.is_empty()));
    }
    Ok(out)
}

/// The walls that a table names by handle or by layer, by index.
fn named_walls(plan: &Plan, table: &MoveTable) -> Result<Vec<usize>, Error> {
    let layers = WallLayers::new(&table.layers)?;
    let is_dxf = plan.format == Format::Dxf;
    let is_same = |t: &String, h: &String| t == h || is_dxf && t.eq_ignore_ascii_case(h);
    let is_named = |wall: &Wall| {
        wall.source.handle.as_ref().is_some_and(|h| table.handles.iter().any(|t| is_same(t, h)))
            || layers.is_by_user() && layers.reason(&wall.source.layer).is_some()
    };
    Ok((0..plan.walls.len()).filter(|w| is_named(&plan.walls[*w])).collect())
}

/// The works that tables of the side-car allow, on the walls that they name or of which they name both ends.
///
/// # Errors
/// [`Error::Usage`] for a work that cannot be read.
pub(crate) fn side_car_works(
    plan: &Plan,
    graph: &Graph,
    settings: &Settings,
    report: &mut Report,
) -> Result<Vec<Allowed>, Error> {
    let mut out = Vec::new();
    for (i, table) in settings.moves.iter().enumerate() {
        let name = || table.name.clone().unwrap_or_else(|| format!("move-{}", i + 1));
        let works = allowed::works_in(&table.moves, plan.frame.metres_per_unit).map_err(|why| {
            Error::usage("move", Place::default(), format!("[[move]] {:?}: {why}; nothing was done", name()))
        })?;
        if works.is_empty() {
            continue;
        }
        let points = table.nodes.iter().map(|p| DVec2::from(*p));
        let ends = markers::nodes_of(points, plan, graph, SIDE_CAR_NODE_M).unwrap_or_default();
        let is_between = |w: &usize| graph.control_nodes[*w].iter().all(|n| ends.binary_search(n).is_ok());
        let mut walls = named_walls(plan, table)?;
        walls.extend((0..plan.walls.len()).filter(|w| !ends.is_empty() && is_between(w)));
        if walls.is_empty() {
            let text =
                format!("[[move]] {:?} names no wall of the drawing; no work is allowed by it", name());
            report.warn("move-empty", Place::file(&plan.file), text);
        }
        let records: BTreeSet<usize> = walls.iter().map(|w| plan.walls[*w].source.record).collect();
        out.extend(records.into_iter().map(|r| Allowed { at: AllowedAt::Record(r), works: works.clone() }));
    }
    Ok(out)
}

/// Says something of every element that states a move, at its place.
fn say_of_marks(
    drawing: &Drawing,
    table: &MoveTable,
    (code, why): (&'static str, &str),
    report: &mut Report,
) {
    let states = drawing.format.marking().moves;
    let is_of_it = |h: &Option<String>| table.handles.contains(h.as_ref().unwrap_or(&String::new()));
    for mark in drawing.marked.iter().filter(|m| m.text == table.moves && is_of_it(&m.source.handle)) {
        let text = format!("Move of {states}: {why}");
        report.warn(code, place_in(&drawing.file, &mark.source), text);
    }
}

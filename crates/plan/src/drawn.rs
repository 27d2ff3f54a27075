//! What the axis graph is understood from: the pieces of all walls, and the entities that may be part of a door or a window.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;

use super::Plan;
use super::axes::evidence::trace;
use super::axes::swing::Swing;
use super::axes::{Drawn, Face, Mark, Path, Role, paths_of};
use super::dots;
use super::leaves;
use super::parallels::Straight;
use super::paving;
use super::reading::Names;
use super::rounds;
use crate::sizes::{FRAME_M, ZERO_M};
use enfilade_cad::drawing::{Drawing, Entity, Shape};
use enfilade_cad::own_layers;
use enfilade_cad::roles::{self, role_by_name};
use enfilade_engine::geometry::UM_PER_M;

/// What the axis graph is understood from: all pieces of the walls, and the entities that may be part of
/// a door or a window; for every mark the index of its entity.
pub fn drawn(plan: &Plan, drawing: &Drawing) -> (Drawn, Vec<usize>) {
    let mut marked = Vec::new();
    let place = |p: DVec2| plan.frame.plan_from_file(p) / plan.human_scale;
    let mut out = Drawn::default();
    let layers_used: BTreeSet<&str> = plan.walls.iter().map(|w| w.source.layer.as_str()).collect();
    let of_columns: BTreeSet<&str> =
        layers_used.into_iter().filter(|l| role_by_name(l).0 == roles::Role::Column).collect();
    for (w, wall) in plan.walls.iter().enumerate() {
        let mut faces = faces_of(&wall.shape, w as u32, place);
        let width_m = wall.width_um as f64 / UM_PER_M / plan.human_scale;
        faces.iter_mut().for_each(|f| f.width_m = width_m);
        if of_columns.contains(wall.source.layer.as_str()) {
            faces.iter_mut().for_each(|f| f.role = Role::Column);
        }
        out.faces.extend(faces);
    }
    let walls = DrawnWalls::new(plan, drawing);
    let is_other = |(i, e): &(usize, &Entity)| {
        !walls.contains(*i, e) && !own_layers::is_own(&e.layer) && !dots::is_dot(&e.shape) && !plan.is_gone(e)
    };
    let others = drawing.entities.iter().enumerate().filter(is_other);
    let others: Vec<(usize, &Entity, Vec<Path>)> =
        others.map(|(i, e)| (i, e, swing_or(paths_of(&e.shape, place)))).collect();
    let leaves = leaves_alone(plan, &out.faces, &others);
    let mut names = Names::default();
    for (i, entity, paths) in others {
        let paths = leaves.get(&i).map_or(paths, |swing| vec![*swing]);
        if let Some(role) = mark_role(plan, i, &paths) {
            let group = walls.fitting_block(entity).map_or(i, |record| drawing.entities.len() + record);
            let is_named = mark_role_of(names.of(entity).role) == Some(role);
            out.marks.push(Mark { paths, role, group: group as u32, is_named });
            marked.push(i);
        }
    }
    leave_paving(&mut out.marks, &mut marked);
    join_swings(drawing, &walls, &mut out.marks, &marked);
    let records = drawing.entities.iter().map(|e| e.source.record).max().unwrap_or(0);
    for (k, (path, role, entity)) in plan.decided_fills().enumerate() {
        // Numbers beyond those of all entities and blocks.
        let group = (drawing.entities.len() + records + 1 + k) as u32;
        out.marks.push(Mark { paths: vec![path], role, group, is_named: true });
        marked.push(entity);
    }
    (out, marked)
}

/// The swings of leaves that are drawn without them, by entity.
fn leaves_alone(
    plan: &Plan,
    faces: &[Face],
    others: &[(usize, &Entity, Vec<Path>)],
) -> BTreeMap<usize, Path> {
    let lines = |p: &Path, thing: usize, is_wall: bool| -> Vec<leaves::Piece> {
        trace(p).windows(2).map(|w| leaves::Piece { ends: [w[0], w[1]], thing, is_wall }).collect()
    };
    let of_walls = faces.iter().flat_map(|f| lines(&f.path, usize::MAX, true));
    let beside = others.iter().flat_map(|(i, _, paths)| paths.iter().map(move |p| (*i, p)));
    let beside = beside.filter(|(_, p)| matches!(p, Path::Line { .. })).flat_map(|(i, p)| lines(p, i, false));
    let drawn: Vec<Swing> = others.iter().flat_map(|o| &o.2).filter_map(Swing::of).collect();
    let is_drawn =
        |arc: &Path| Swing::of(arc).is_some_and(|s| drawn.iter().any(|other| s.is_like(other, FRAME_M)));
    let may_hang = others.iter().filter(|o| may_be_leaf(plan.reading.role(o.0)));
    let may_hang: Vec<(usize, Vec<Path>)> = may_hang.map(|(i, _, paths)| (*i, paths.clone())).collect();
    let found = leaves::hung(of_walls.chain(beside), &may_hang);
    let new = found.into_iter().filter(|(_, swing)| !is_drawn(swing));
    new.map(|(of, swing)| (of[0], swing)).collect()
}

/// Whether what was taken for this may be a leaf without its swing.
fn may_be_leaf(role: roles::Role) -> bool {
    matches!(role, roles::Role::Door | roles::Role::Unknown)
}

/// Which entities of a drawing the walls of its plan are.
pub(super) struct DrawnWalls<'a> {
    entities: BTreeSet<usize>,
    records: BTreeSet<(usize, &'a str)>,
}

impl<'a> DrawnWalls<'a> {
    /// Finds them.
    pub fn new(plan: &'a Plan, drawing: &Drawing) -> Self {
        let foreign: Vec<usize> = (0..drawing.entities.len())
            .filter(|i| !own_layers::is_own(&drawing.entities[*i].layer))
            .collect();
        Self {
            entities: plan.picked.iter().filter_map(|p| foreign.get(*p).copied()).collect(),
            records: plan.walls.iter().map(|w| (w.source.record, w.source.layer.as_str())).collect(),
        }
    }

    /// Whether an entity is one of them, or of the same element; what a block shows beside its walls is not.
    pub fn contains(&self, i: usize, e: &Entity) -> bool {
        self.entities.contains(&i)
            || e.blocks.is_empty() && self.records.contains(&(e.source.record, e.source.layer.as_str()))
    }

    /// The INSERT that shows an entity, unless it shows walls too: then it is no door and no window.
    fn fitting_block(&self, e: &Entity) -> Option<usize> {
        let holds_walls =
            |record: usize| self.records.range((record, "")..).next().is_some_and(|r| r.0 == record);
        e.insert().filter(|record| !holds_walls(*record))
    }
}

/// Gives every part of a swing that is drawn in parts, in one block or on one layer, the whole swing's arc.
fn join_swings(drawing: &Drawing, walls: &DrawnWalls<'_>, marks: &mut [Mark], marked: &[usize]) {
    let mut together: BTreeMap<(Option<usize>, &str), Vec<usize>> = BTreeMap::new();
    for (m, mark) in marks.iter().enumerate() {
        let entity = &drawing.entities[marked[m]];
        if matches!(mark.role, Role::Door | Role::Unknown) {
            together.entry((walls.fitting_block(entity), &entity.layer)).or_default().push(m);
        }
    }
    for of_one in together.into_values() {
        let parts: Vec<&[Path]> = of_one.iter().map(|m| marks[*m].paths.as_slice()).collect();
        for (row, arc) in
            rounds::arcs_in_parts(&parts).into_iter().filter(|(_, arc)| Swing::of(arc).is_some())
        {
            row.iter().for_each(|k| marks[of_one[*k]].paths = vec![arc]);
        }
    }
}

/// The pieces of a wall; `place` turns its points into metres of a person.
pub(super) fn faces_of(shape: &Shape, wall: u32, place: impl Fn(DVec2) -> DVec2) -> Vec<Face> {
    let paths = paths_of(shape, place);
    let meets = |first: &Path, last: &Path| first.ends()[0].distance(last.ends()[1]) <= ZERO_M;
    let is_closed = matches!(shape, Shape::Circle { .. } | Shape::Polyline { closed: true, .. })
        || paths.len() > 2 && meets(&paths[0], &paths[paths.len() - 1]);
    let face = |(part, path): (usize, Path)| Face {
        wall,
        part: part as u32,
        path,
        role: Role::Wall,
        is_closed,
        width_m: 0.0,
    };
    paths.into_iter().enumerate().map(face).collect()
}

/// Takes joints of a floor out of the marks: one that ends at a wall and a column is no pane between them.
fn leave_paving(marks: &mut Vec<Mark>, marked: &mut Vec<usize>) {
    let line = |(entity, m): (usize, &Mark)| match m.paths[..] {
        [Path::Line { a, b }] if m.role == Role::Unknown => Some(Straight { entity, a, b }),
        _ => None,
    };
    let lines: Vec<Straight> = marks.iter().enumerate().filter_map(line).collect();
    let joints: BTreeSet<usize> = paving::find_joints(&lines).into_iter().map(|i| lines[i].entity).collect();
    let is_kept = |i: &usize| !joints.contains(i);
    *marked = (0..marked.len()).filter(is_kept).map(|i| marked[i]).collect();
    *marks = (0..marks.len()).filter(is_kept).map(|i| marks[i].clone()).collect();
}

/// The arc of a door's swing where chords trace one, else the pieces as they are.
pub(super) fn swing_or(paths: Vec<Path>) -> Vec<Path> {
    match rounds::as_arc(&paths) {
        Some(arc) if Swing::of(&arc).is_some() => vec![arc],
        _ => paths,
    }
}

/// What an entity says about an opening: by what it was taken for, else by its shape.
fn mark_role(plan: &Plan, i: usize, paths: &[Path]) -> Option<Role> {
    let role = plan.reading.role(i);
    let tells = |p: &Path| match p {
        Path::Arc { .. } => Swing::of(p).is_some(),
        Path::Line { .. } => role == roles::Role::Unknown,
    };
    mark_role_of(role).or_else(|| paths.iter().any(tells).then_some(Role::Unknown))
}

/// What a part of a door or a window is among the marks.
fn mark_role_of(role: roles::Role) -> Option<Role> {
    match role {
        roles::Role::Door => Some(Role::Door),
        roles::Role::Window | roles::Role::Glazing => Some(Role::Window),
        _ => None,
    }
}

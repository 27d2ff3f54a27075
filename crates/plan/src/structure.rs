//! The walls of a plan as bodies: what the axis graph says of them, joined to what can be written back.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;

use super::Plan;
use super::axes::evidence::trace;
use super::axes::near::Buckets;
use super::axes::tolerances::{BOTH_WAYS_RAD, ERROR_GAP_M, SWING_MAX_RAD};
use super::axes::{
    AxisGraph, Drawn, Edge, Face, FaceRef, Mark, NodeKind, Opening, OpeningKind, Path, Role, paths_of,
};
use super::curve::trace as trace_of;
use super::dots;
use super::graph::Handle;
use super::hidden::Hidden;
use super::leaves;
use super::parallels::Straight;
use super::paving;
use super::reading::Names;
use super::rooms;
use super::rounds;
use enfilade_cad::curve::{control_point, control_points};
use enfilade_cad::drawing::{Drawing, Entity, Format, Shape};
use enfilade_cad::own_layers;
use enfilade_cad::plane::box_of;
use enfilade_cad::roles::{self, role_by_name};
use enfilade_engine::geometry::{PointUm, Segment, UM_PER_M};

/// Radii of arcs that may be door swings, metres of a person.
pub const SWING_RADIUS_M: [f64; 2] = [0.5, 1.6];

/// What covers ground by its lines: a thick straight wall, by the two ends of its left face and of its right face in ring
/// order, or a column.
#[derive(Clone, Debug, PartialEq)]
pub struct Body {
    /// Its corners, in order round it.
    pub corners: Vec<Handle>,
    /// Of a wall the distance of its faces, micrometres; a column has none.
    pub thickness_um: Option<f64>,
}

/// A body's ends are at most this many times as wide as it is thick: mitred, not two faces torn apart.
const END_WIDTH_MAX: f64 = 1.6;

impl Body {
    /// The ring of its corners; `at` says where a control point stands. `None` where its faces do not end
    /// side by side: one of them runs on beyond the wall, and what lies between them is no body.
    pub fn ring(&self, at: impl FnMut(Handle) -> PointUm) -> Option<Vec<PointUm>> {
        let ring: Vec<PointUm> = self.corners.iter().copied().map(at).collect();
        let (Some(thickness_um), [p, q, r, s]) = (self.thickness_um, ring.as_slice()) else {
            return Some(ring);
        };
        let width = |p: &PointUm, q: &PointUm| ((p[0] - q[0]) as f64).hypot((p[1] - q[1]) as f64);
        let is_wide = |w: f64| w > END_WIDTH_MAX * thickness_um;
        (!is_wide(width(p, s)) && !is_wide(width(q, r))).then_some(ring)
    }
}

/// Shortest wall on either side of a window in a wall that is drawn through: a box with lines in it is a radiator.
const BESIDE_WINDOW_M: f64 = 0.2;

/// The axis graph of a plan, and for every mark that it was understood from the index of its entity.
pub fn axes(plan: &Plan, drawing: &Drawing) -> (AxisGraph, Vec<usize>) {
    let (drawn, marked) = drawn(plan, drawing);
    let mut axes = AxisGraph::new(&drawn);
    // Where wall lines run through and nothing shows a door or a window, there is no gap.
    let goes_on = |node: u32| {
        let beyond = axes.edges.iter().filter(|e| e.nodes.contains(&node)).map(|e| {
            let [a, b] = axes.ends(e);
            a.distance(b)
        });
        beyond.fold(0.0, f64::max) >= BESIDE_WINDOW_M
    };
    let is_window = |o: &Opening| {
        let is_between = o.jambs.iter().all(|j| j.edge.is_some() || j.node.is_some_and(goes_on));
        // The wall's own faces are no panes.
        let has_panes = o.faces.iter().any(|f| !o.through.contains(f));
        o.kind == OpeningKind::Window && has_panes && is_between
    };
    let shows: Vec<bool> =
        axes.openings.iter().map(|o| o.through.is_empty() || !o.marks.is_empty() || is_window(o)).collect();
    let mut shows = shows.into_iter();
    axes.openings.retain(|_| shows.next().unwrap_or(true));
    leave_uncut(plan, &drawn, &mut axes);
    rooms::open_touching(plan, &mut axes);
    axes.count_again();
    (axes, marked)
}

/// Where most doors stand in gaps of their walls, a swing before a wall that runs on shows no door in it, unless lines across
/// the wall end it on both sides: it belongs to another storey. In other drawings walls are drawn through.
fn leave_uncut(plan: &Plan, drawn: &Drawn, axes: &mut AxisGraph) {
    let mut near = Buckets::new(0.5);
    let lines = drawn.faces.iter().map(|f| f.path).chain(drawn.marks.iter().flat_map(|m| m.paths.clone()));
    let lines: Vec<[DVec2; 2]> = lines.filter(|p| matches!(p, Path::Line { .. })).map(|p| p.ends()).collect();
    lines.iter().enumerate().for_each(|(i, [a, b])| near.add(i as u32, &[a.midpoint(*b)]));
    let is_across = |at: DVec2, along: DVec2, thickness_m: f64| {
        let reach = DVec2::splat(2.0 * ERROR_GAP_M);
        near.near(at - reach, at + reach).into_iter().any(|i| {
            let [a, b] = lines[i as usize];
            a.midpoint(b).distance(at) <= 2.0 * ERROR_GAP_M
                && (a.distance(b) - thickness_m).abs() <= 2.0 * ERROR_GAP_M
                && (b - a).normalize_or_zero().dot(along).abs() <= ACROSS_COS
        })
    };
    let is_framed = |o: &Opening| {
        let [from, to] = o.jambs.map(|j| j.at);
        let along = (to - from).normalize_or_zero();
        o.thickness_m > 0.0 && [from, to].into_iter().all(|at| is_across(at, along, o.thickness_m))
    };
    let is_uncut = |o: &Opening| {
        let [from, to] = o.jambs.map(|j| j.at);
        let side = |f: &FaceRef| {
            let piece = face_handles(plan, *f).first().map(|h| handle_at(plan, *h));
            piece.map(|p| (to - from).perp_dot(p - from) > 0.0)
        };
        let sides: BTreeSet<bool> = o.through.iter().filter_map(side).collect();
        let is_through = sides.len() == 2 || o.thickness_m == 0.0 && !o.through.is_empty();
        o.kind == OpeningKind::Door && is_through && !is_framed(o)
    };
    let in_gaps = |o: &&Opening| o.kind == OpeningKind::Door && o.through.is_empty();
    let uncut = axes.openings.iter().filter(|o| is_uncut(o)).count();
    if uncut < axes.openings.iter().filter(in_gaps).count() {
        axes.openings.retain(|o| !is_uncut(o));
    }
}

/// What lies across a wall is turned from it by more than this: the cosine.
const ACROSS_COS: f64 = 0.2;

/// Ends of a polyline nearer than this are one: it is closed although it does not say so.
const CLOSED_M: f64 = 0.001;

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

/// How far the hinge and the radius of a swing lie from those of its leaf at most, metres of a person.
const OWN_SWING_M: f64 = 0.15;

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
    let may_hang: Vec<&(usize, &Entity, Vec<Path>)> =
        others.iter().filter(|o| may_be_leaf(plan.reading.role(o.0))).collect();
    let (slips, whole) = drawn_by_lines(&may_hang);
    let whole_of = |i: usize| whole.get(&i).copied().unwrap_or(i);
    let beside = beside.map(|p| leaves::Piece { thing: whole_of(p.thing), ..p });
    let pieces = leaves::Pieces::new(of_walls.chain(beside));
    let drawn: Vec<&Path> = others.iter().flat_map(|o| &o.2).filter(|p| is_swing(p)).collect();
    let is_like = |p: &Path, q: &Path| match (p, q) {
        (Path::Arc { centre, radius, .. }, Path::Arc { centre: at, radius: other, .. }) => {
            centre.distance(*at) <= OWN_SWING_M && (radius - other).abs() <= OWN_SWING_M
        }
        _ => false,
    };
    let alone = may_hang.iter().filter(|(i, ..)| !whole.contains_key(i)).map(|(i, _, paths)| (*i, paths));
    let all = alone.chain(slips.iter().map(|(i, paths)| (*i, paths)));
    let swings = all.filter_map(|(i, paths)| Some((i, pieces.swing(paths, i)?)));
    swings.filter(|(_, swing)| !drawn.iter().any(|p| is_like(p, swing))).collect()
}

/// Leaves drawn as slips of four lines, by the entity of the first, and for each of their entities which that is.
fn drawn_by_lines(
    all: &[&(usize, &Entity, Vec<Path>)],
) -> (BTreeMap<usize, Vec<Path>>, BTreeMap<usize, usize>) {
    let line = |(i, _, paths): &&(usize, &Entity, Vec<Path>)| match paths[..] {
        [Path::Line { a, b }] => Some((*i, [a, b])),
        _ => None,
    };
    let (entities, lines): (Vec<usize>, Vec<[DVec2; 2]>) = all.iter().filter_map(line).unzip();
    let (mut slips, mut whole) = (BTreeMap::new(), BTreeMap::new());
    for (of, ring) in leaves::slips(&lines) {
        let first = entities[of[0]];
        let side = |k: usize| Path::Line { a: ring[k], b: ring[(k + 1) % ring.len()] };
        slips.insert(first, (0..ring.len()).map(side).collect());
        whole.extend(of.map(|k| (entities[k], first)));
    }
    (slips, whole)
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
        for (row, arc) in rounds::arcs_in_parts(&parts).into_iter().filter(|(_, arc)| is_swing(arc)) {
            row.iter().for_each(|k| marks[of_one[*k]].paths = vec![arc]);
        }
    }
}

/// The pieces of a wall; `place` turns its points into metres of a person.
pub(super) fn faces_of(shape: &Shape, wall: u32, place: impl Fn(DVec2) -> DVec2) -> Vec<Face> {
    let paths = paths_of(shape, place);
    let meets = |first: &Path, last: &Path| first.ends()[0].distance(last.ends()[1]) <= CLOSED_M;
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

/// How far beyond the walls what fills their openings may lie, metres of a person: sills, bays.
const BEYOND_WALLS_M: f64 = 1.0;

/// Glass that hangs together with such goes on farther out, up to this share of the longer side of the walls' box:
/// a room of glass before the walls.
const BEYOND_SHARE: f64 = 0.5;

/// Ends of glass nearer than this to glass hang together with it, metres of a person.
const HANGING_M: f64 = 0.1;

/// Most lines beyond the walls that are looked at.
const FAR_MAX: usize = 400;

/// How far beside a wall's faces lines still belong to a window in it, metres of a person: sills, frames.
const SILL_M: f64 = 0.3;

/// What fills the gaps between walls, drawing frame: straight lines of doors, windows and glass by the names of
/// their layers and blocks, and from the hinge of every door's swing to its ends. It closes the outline when it is
/// asked what lies inside, where an opening was not understood; those that were close themselves.
pub fn infill_lines(plan: &Plan, drawing: &Drawing, axes: &AxisGraph) -> Vec<Segment> {
    if drawing.format != Format::Dxf {
        return Vec::new();
    }
    let place = |p: DVec2| plan.frame.plan_from_file(p) / plan.human_scale;
    let points = plan.walls.iter().flat_map(|w| control_points(&w.shape)).map(place);
    let Some([lo, hi]) = box_of(points) else { return Vec::new() };
    let hidden = Hidden::new(drawing);
    let walls = DrawnWalls::new(plan, drawing);
    let lies_within = |s: &[DVec2; 2], beyond: f64| {
        s.iter().all(|p| p.cmpge(lo - beyond).all() && p.cmple(hi + beyond).all())
    };
    let widest = BEYOND_WALLS_M.max(BEYOND_SHARE * (hi - lo).max_element());
    let mut out: Vec<[DVec2; 2]> = Vec::new();
    let shown = drawing.entities.iter().enumerate();
    let shown = shown.filter(|(i, e)| !walls.contains(*i, e) && !plan.is_gone(e));
    for (i, e) in shown.filter(|(_, e)| !hidden.entity(e)) {
        let role = plan.reading.role(i);
        let by_name = fills(role);
        let may_swing = by_name || matches!(role, roles::Role::Wall | roles::Role::Unknown);
        for path in swing_or(paths_of(&e.shape, place)) {
            match path {
                Path::Line { a, b } if by_name => out.push([a, b]),
                Path::Arc { centre, radius, start_rad, sweep_rad } if may_swing && is_swing(&path) => {
                    // A leaf that turns to both sides closes between its ends.
                    let middle = centre + DVec2::from_angle(start_rad + sweep_rad / 2.0) * radius;
                    let shut = path.ends().into_iter().chain((sweep_rad > BOTH_WAYS_RAD).then_some(middle));
                    out.extend(shut.map(|p| [centre, p]));
                }
                _ => {}
            }
        }
    }
    out.retain(|s| lies_within(s, widest) && !axes.openings.iter().any(|o| lies_in(s, o)));
    let (near, far) = out.into_iter().partition(|s| lies_within(s, BEYOND_WALLS_M));
    let walls = plan.walls.iter().flat_map(|w| w.trace.segments());
    let walls = walls.map(|(_, _, s)| [s.a, s.b].map(|p| plan.frame.plan_from_um(p) / plan.human_scale));
    let out = with_hanging(near, far, &walls.collect::<Vec<_>>());
    let um = |p: DVec2| plan.frame.um_from_plan(p * plan.human_scale);
    out.into_iter().map(|[a, b]| Segment { a: um(a), b: um(b) }).collect()
}

/// Lines near the walls, and of those far from them the ones that hang together with these or with a wall.
fn with_hanging(mut near: Vec<[DVec2; 2]>, far: Vec<[DVec2; 2]>, walls: &[[DVec2; 2]]) -> Vec<[DVec2; 2]> {
    if far.len() > FAR_MAX {
        return near;
    }
    let (at_walls, mut far): (Vec<_>, Vec<_>) =
        far.into_iter().partition(|s| walls.iter().any(|w| hangs_at(s, w)));
    near.extend(at_walls);
    let mut from = 0;
    while from < near.len() {
        let (hanging, rest) = far.into_iter().partition(|s| near[from..].iter().any(|t| hangs_at(s, t)));
        far = rest;
        from = near.len();
        near.extend::<Vec<[DVec2; 2]>>(hanging);
    }
    near
}

/// Whether one of two lines ends at the other.
fn hangs_at(s: &[DVec2; 2], t: &[DVec2; 2]) -> bool {
    let at = |p: DVec2, [a, b]: [DVec2; 2]| {
        let d = b - a;
        let share = (p - a).dot(d) / d.length_squared().max(f64::MIN_POSITIVE);
        p.distance(a + d * share.clamp(0.0, 1.0)) <= HANGING_M
    };
    s.iter().any(|p| at(*p, *t)) || t.iter().any(|p| at(*p, *s))
}

/// Whether it fills gaps between walls.
fn fills(role: roles::Role) -> bool {
    matches!(role, roles::Role::Door | roles::Role::Window | roles::Role::Glazing)
}

/// Whether the middle of a line lies in an opening or just beside it.
fn lies_in([a, b]: &[DVec2; 2], opening: &Opening) -> bool {
    let [from, to] = opening.jambs.map(|j| j.at);
    let along = (to - from).normalize_or_zero();
    let p = a.midpoint(*b) - from;
    (-SILL_M..=from.distance(to) + SILL_M).contains(&p.dot(along))
        && along.perp_dot(p).abs() <= opening.thickness_m / 2.0 + SILL_M
}

/// The lines of windows and glass that are shown, drawing frame: they stop people, and sight at the height of a knee.
/// What stands in an understood opening is closed with it.
pub fn glass_lines(plan: &Plan, drawing: &Drawing, axes: &AxisGraph) -> Vec<Segment> {
    let (hidden, walls) = (Hidden::new(drawing), DrawnWalls::new(plan, drawing));
    let is_drawn = |(i, e): &(usize, &Entity)| {
        is_glass(plan, *i)
            && !hidden.entity(e)
            && !walls.contains(*i, e)
            && !plan.is_gone(e)
            && drawing.format == Format::Dxf
    };
    let shown = drawing.entities.iter().enumerate().filter(is_drawn);
    let lines =
        shown.flat_map(|(_, e)| trace_of(&e.shape, &plan.frame).segments().map(|s| s.2).collect::<Vec<_>>());
    let at = |p: PointUm| plan.frame.plan_from_um(p) / plan.human_scale;
    lines.filter(|s| !axes.openings.iter().any(|o| lies_in(&[at(s.a), at(s.b)], o))).collect()
}

/// Whether an entity, by its index, was taken for a window or glass.
pub fn is_glass(plan: &Plan, i: usize) -> bool {
    matches!(plan.reading.role(i), roles::Role::Window | roles::Role::Glazing)
}

/// The arc of a door's swing where chords trace one, else the pieces as they are.
pub(super) fn swing_or(paths: Vec<Path>) -> Vec<Path> {
    match rounds::as_arc(&paths) {
        Some(arc) if is_swing(&arc) => vec![arc],
        _ => paths,
    }
}

/// Whether an arc may be the swing of a door, by its size.
fn is_swing(path: &Path) -> bool {
    matches!(path, Path::Arc { radius, sweep_rad, .. }
        if (SWING_RADIUS_M[0]..=SWING_RADIUS_M[1]).contains(radius) && (0.5..=SWING_MAX_RAD).contains(sweep_rad))
}

/// What an entity says about an opening: by what it was taken for, else by its shape.
fn mark_role(plan: &Plan, i: usize, paths: &[Path]) -> Option<Role> {
    let role = plan.reading.role(i);
    let tells = |p: &Path| match p {
        Path::Arc { .. } => is_swing(p),
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

/// The thick straight walls of an axis graph, and its columns that are drawn by single lines. What another wall's joint
/// divides into edges, while a face runs on past it, is one wall.
pub fn bodies(plan: &Plan, axes: &AxisGraph) -> Vec<Body> {
    let walls = lengths(axes).into_iter().filter_map(|edges| body(plan, axes, &edges));
    walls.chain(columns(plan, axes).filter_map(|(ring, faces)| column(plan, ring, faces))).collect()
}

/// Thick straight edges that go on in one line past a node with one face: each list is one wall.
fn lengths(axes: &AxisGraph) -> Vec<Vec<&Edge>> {
    let straight: Vec<&Edge> = axes.edges.iter().filter(|e| e.thickness_m > 0.0 && e.bulge == 0.0).collect();
    let mut at_node: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    for (i, e) in straight.iter().enumerate() {
        e.nodes.iter().for_each(|n| at_node.entry(*n).or_default().push(i));
    }
    let goes_on = |e: &Edge, f: &Edge| {
        e.nodes[1] == f.nodes[0]
            && (e.left.iter().any(|s| f.left.contains(s)) || e.right.iter().any(|s| f.right.contains(s)))
    };
    let mut is_begun = vec![false; straight.len()];
    let mut out = Vec::new();
    let has_before = |i: usize| {
        at_node[&straight[i].nodes[0]].iter().any(|&j| j != i && goes_on(straight[j], straight[i]))
    };
    for first in (0..straight.len()).filter(|&i| !has_before(i)).chain(0..straight.len()) {
        let mut wall = Vec::new();
        let mut next = Some(first).filter(|&i| !is_begun[i]);
        while let Some(i) = next {
            is_begun[i] = true;
            wall.push(straight[i]);
            let beyond = at_node[&straight[i].nodes[1]].iter();
            next = beyond.copied().find(|&j| !is_begun[j] && goes_on(straight[i], straight[j]));
        }
        if !wall.is_empty() {
            out.push(wall);
        }
    }
    out
}

/// Rings and faces of the columns of which no outline says by itself that it is solid.
fn columns<'a>(plan: &'a Plan, axes: &'a AxisGraph) -> impl Iterator<Item = (&'a [DVec2], &'a [FaceRef])> {
    axes.nodes.iter().filter_map(|node| match &node.kind {
        NodeKind::Column(ring) if !node.faces.iter().any(|f| plan.walls[f.0 as usize].is_solid) => {
            Some((ring.as_slice(), node.faces.as_slice()))
        }
        _ => None,
    })
}

fn column(plan: &Plan, ring: &[DVec2], faces: &[FaceRef]) -> Option<Body> {
    let handles: Vec<(DVec2, Handle)> =
        faces.iter().flat_map(|f| face_handles(plan, *f)).map(|h| (handle_at(plan, h), h)).collect();
    let corner = |p: &DVec2| {
        let near = handles.iter().map(|(at, h)| (at.distance(*p), *h)).filter(|h| h.0 <= ERROR_GAP_M);
        Some(near.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))?.1)
    };
    let corners: Option<Vec<Handle>> = ring.iter().map(corner).collect();
    Some(Body { corners: corners?, thickness_um: None })
}

fn body(plan: &Plan, axes: &AxisGraph, edges: &[&Edge]) -> Option<Body> {
    let (first, last) = (edges.first()?, edges.last()?);
    let [a, b] = [axes.ends(first)[0], axes.ends(last)[1]];
    let along = |p: DVec2| (p - a).dot(b - a);
    let side = |faces: fn(&Edge) -> &Vec<FaceRef>| -> Option<[Handle; 2]> {
        let ends = edges.iter().flat_map(|e| faces(e)).flat_map(|f| face_handles(plan, *f));
        let mut ends: Vec<(f64, Handle)> = ends.map(|h| (along(handle_at(plan, h)), h)).collect();
        ends.sort_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
        Some([ends.first()?.1, ends.last()?.1])
    };
    let ([l0, l1], [r0, r1]) = (side(|e| &e.left)?, side(|e| &e.right)?);
    let thickest_m = edges.iter().map(|e| e.thickness_m).fold(0.0, f64::max);
    let thickness_um = thickest_m * plan.human_scale * UM_PER_M;
    Some(Body { corners: vec![l0, l1, r1, r0], thickness_um: Some(thickness_um) })
}

/// Walls thicker than this are bodies only if they are [`SLENDER`]: two faces so far apart may be a small room.
const STOUT_M: f64 = 0.45;

/// A slender wall is at least this many times as long as thick.
const SLENDER: f64 = 2.5;

/// The ground that straight thick walls stand on, openings left out, and columns of single lines: rings in the drawing
/// frame, micrometres.
///
/// Only walls of which one side stays, all its drawn pieces, are taken: where the other side moves, it is a joint
/// that slides along the wall. Of a column all stay.
pub fn footprints(plan: &Plan, axes: &AxisGraph, stays: impl Fn(FaceRef) -> bool) -> Vec<Vec<PointUm>> {
    let um = |p: DVec2| plan.frame.um_from_plan(p * plan.human_scale);
    let still = columns(plan, axes).filter(|(_, faces)| faces.iter().all(|f| stays(*f)));
    let mut out: Vec<Vec<PointUm>> = still.map(|(ring, _)| ring.iter().map(|p| um(*p)).collect()).collect();
    for edge in axes.edges.iter().filter(|e| e.thickness_m > 0.0 && e.bulge == 0.0) {
        let holds = |side: &[FaceRef]| side.iter().all(|f| stays(*f));
        if edge.left.is_empty() || edge.right.is_empty() || !(holds(&edge.left) || holds(&edge.right)) {
            continue;
        }
        let [a, b] = axes.ends(edge);
        if edge.thickness_m > STOUT_M && a.distance(b) < SLENDER * edge.thickness_m {
            continue;
        }
        let half = (b - a).normalize_or_zero().perp() * (edge.thickness_m / 2.0);
        for [from, to] in closed_parts(axes, edge) {
            let [p, q] = [from, to].map(|t| a.lerp(b, t));
            out.push([p + half, q + half, q - half, p - half].map(um).to_vec());
        }
    }
    out
}

/// The parts of a straight wall between the openings it runs through, as shares of its length.
fn closed_parts(axes: &AxisGraph, edge: &Edge) -> Vec<[f64; 2]> {
    let [a, b] = axes.ends(edge);
    let share = |p: DVec2| (p - a).dot(b - a) / (b - a).length_squared();
    let is_own = |f: &FaceRef| edge.left.contains(f) || edge.right.contains(f);
    let mut open: Vec<[f64; 2]> = axes
        .openings
        .iter()
        .filter(|o| o.through.iter().any(is_own))
        .map(|o| o.jambs.map(|j| share(j.at)))
        .map(|[s, t]| [s.min(t), s.max(t)])
        .collect();
    open.sort_by(|x, y| x[0].total_cmp(&y[0]));
    let mut out = Vec::new();
    let mut at = 0.0;
    for [s, t] in open {
        if s > at {
            out.push([at, s.min(1.0)]);
        }
        at = t.max(at);
    }
    if at < 1.0 {
        out.push([at, 1.0]);
    }
    out
}

/// The thick wall that each drawn face and each face's end belongs to, numbered from 0: edges on which one
/// face lies are one wall.
pub fn thick_walls(axes: &AxisGraph) -> BTreeMap<FaceRef, u32> {
    let mut out: BTreeMap<FaceRef, u32> = BTreeMap::new();
    let mut root: Vec<u32> = (0..axes.edges.len() as u32).collect();
    let find = |root: &[u32], mut i: u32| {
        while root[i as usize] != i {
            i = root[i as usize];
        }
        i
    };
    let thick = || axes.edges.iter().enumerate().filter(|(_, e)| e.thickness_m > 0.0);
    for (i, edge) in thick() {
        for face in edge.left.iter().chain(&edge.right).chain(&edge.inner) {
            let first = *out.entry(*face).or_insert(i as u32);
            let (a, b) = (find(&root, first), find(&root, i as u32));
            root[a.max(b) as usize] = a.min(b);
        }
    }
    for (i, edge) in thick() {
        let ends = edge.nodes.iter().flat_map(|n| &axes.nodes[*n as usize].faces);
        for face in ends {
            out.entry(*face).or_insert(i as u32);
        }
    }
    out.values_mut().for_each(|wall| *wall = find(&root, *wall));
    out
}

/// Where a control point stands, metres of a person.
pub fn handle_at(plan: &Plan, (wall, control): Handle) -> DVec2 {
    let p = control_point(&plan.walls[wall as usize].shape, control);
    plan.frame.plan_from_file(p) / plan.human_scale
}

/// How far from a node the corners of a wall's end may lie along the wall.
const END_REACH_M: f64 = 0.06;

/// The control points of an edge's faces that stand at one of its nodes; none where the faces run on. Of a short face
/// both ends lie near the node: the nearer one stands at it.
pub fn end_handles(plan: &Plan, axes: &AxisGraph, edge: &Edge, node: u32) -> Vec<Handle> {
    let [a, b] = axes.ends(edge);
    let at = axes.nodes[node as usize].at;
    let along = (b - a).normalize_or_zero();
    let reach = END_REACH_M + edge.thickness_m / 2.0;
    let far = |h: &Handle| (handle_at(plan, *h) - at).dot(along).abs();
    let faces = edge.left.iter().chain(&edge.right).chain(&edge.inner);
    let standing = faces.flat_map(|f| {
        let mut ends = face_handles(plan, *f);
        if let [Some(a), Some(b)] = [0, 1].map(|k| ends.get(k).map(far))
            && (a - b).abs() > CLOSED_M
        {
            ends.swap_remove(usize::from(a < b));
        }
        ends
    });
    standing.filter(|h| far(h) <= reach).collect()
}

/// The control points at the ends of a straight drawn piece.
pub fn face_handles(plan: &Plan, (wall, part): FaceRef) -> Vec<Handle> {
    match &plan.walls[wall as usize].shape {
        Shape::Line { .. } => vec![(wall, 0), (wall, 1)],
        Shape::Polyline { vertices, .. } => {
            vec![(wall, part), (wall, (part + 1) % vertices.len() as u32)]
        }
        Shape::Arc { .. } | Shape::Circle { .. } => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Glass beyond the walls that hangs together is followed to its end, until there is too much of it to be glass.
    #[test]
    fn more_lines_beyond_the_walls_than_the_limit_are_not_looked_at() {
        let chain = |count: usize| -> Vec<[DVec2; 2]> {
            (1..=count).rev().map(|i| [i as f64, i as f64 + 1.0].map(|x| DVec2::new(x, 0.0))).collect()
        };
        let near = vec![[DVec2::ZERO, DVec2::X]];
        assert_eq!(with_hanging(near.clone(), chain(FAR_MAX), &[]).len(), 1 + FAR_MAX);
        assert_eq!(with_hanging(near.clone(), chain(FAR_MAX + 1), &[]), near);
    }
}

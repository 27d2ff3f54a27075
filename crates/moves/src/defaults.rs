//! What moves when the user marked nothing (spec 9): free-standing elements, and door gaps.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;

use super::axial::{Axial, Stays, told};
use super::doorways::Doorways;
use super::furniture::{self, Element};
use super::neighbours::{Neighbours, Piece, SQUARES_MAX};
use super::remains::REST_M;
use super::sizes::{DOOR_WIDTH_M, SLIDE_M, SLIDE_MIN_M, TOUCH_M, WALL_THICKNESS_MAX_M};
use super::sliding::{Sliding, upright, whole_mm};
use super::things::Things;
use enfilade_cad::drawing::{Editable, SourceRef};
use enfilade_cad::marking::Marking;
use enfilade_cad::plane::{box_of, distance_to_segment};
use enfilade_engine::Region;
use enfilade_engine::geometry::{PointUm, Segment, UM_PER_M, segments_touch};
use enfilade_engine::interior::Interior;
use enfilade_plan::Plan;
use enfilade_plan::axes::{AxisGraph, Jamb, NodeKind, OpeningKind};
use enfilade_plan::fittings::{Fitting, jambs_of};
use enfilade_plan::graph::Graph;
use enfilade_plan::markers::{Clause, Group, Kind, Markers};
use enfilade_report::{Place, Report, counted};

/// How far a free-standing element shifts in x and y.
pub const SHIFT_M: f64 = 1.0;
/// How far a free-standing element turns.
pub const TURN_DEG: f64 = 15.0;
/// The same in a plan of right angles, where nothing stands askew.
const RIGHT_DEG: f64 = 90.0;
/// How far an element must stay inside the building to count as free-standing.
const INSIDE_MARGIN_M: f64 = 0.3;
/// No other wall, door, window or glass is nearer than this to what stands free.
pub const STANDS_FREE_M: f64 = 0.3;
/// A free-standing element is at most this share of the building's longer side.
const ELEMENT_SHARE_MAX: f64 = 0.5;
/// What is larger than this both ways is no element but a block of rooms, metres of a person.
const ELEMENT_DEPTH_MAX_M: f64 = 6.0;
/// What is no larger is a post, or a pair of them: it carries.
const POST_MAX_M: f64 = 0.6;
/// Nor does a column move that is no larger.
const COLUMN_MAX_M: f64 = 1.0;
/// Directions whose cosine is smaller cross at right angles.
const CROSSING_COS: f64 = 0.02;
/// Most groups made by default: more than that nobody tells apart, and no small budget finds good layouts.
pub const GROUPS_MAX: usize = 12;
/// Most wall pieces looked at pairwise for doors and neighbours.
pub const PIECES_MAX: usize = 20_000;
/// Groups for [`super::Moves::new`]: elements, the largest first, walls that slide between others, the
/// longest first, then doors from left to right. `infill`: what is drawn between walls, drawing frame; a wall near
/// which such a line ends is no element. `fittings`: the parts of doors and windows, which go with their walls.
pub fn groups(
    plan: &Plan,
    graph: &Graph,
    axes: &AxisGraph,
    (interior, infill, fittings): (&Interior, &[Segment], &[Fitting]),
    report: &mut Report,
) -> Vec<(Group, Vec<u32>)> {
    let pieces = pieces(plan, graph);
    let (place, words) = (Place::file(&plan.file), plan.format.marking());
    if pieces.len() > PIECES_MAX {
        let text = format!(
            "{} wall pieces, expected at most {PIECES_MAX} for default moves; to say what may move, {}",
            pieces.len(),
            words.order
        );
        report.info("default-moves", place, text);
        return Vec::new();
    }
    let squares = Neighbours::squares(&pieces);
    if squares > SQUARES_MAX {
        let text = format!(
            "the wall pieces reach over {squares:.0e} squares of {} m, expected at most {SQUARES_MAX:.0e} for default moves; \
             to say what may move, {}",
            Neighbours::SIZE_M,
            words.order
        );
        report.info("default-moves", place, text);
        return Vec::new();
    }
    let neighbours = Neighbours::new(&pieces);
    let mut at_openings = walls_at_openings(axes);
    at_openings.extend(walls_at_infill(plan, infill, &pieces, &neighbours));
    at_openings.extend(carrying(plan));
    let held = Held { walls: at_openings, columns: columns(axes) };
    let things = Things::new(plan, fittings);
    let (elements, posts) = elements(plan, graph, axes, interior, &held, &pieces, &neighbours);
    let axial = Axial::new(plan, graph, axes, interior, (&pieces, &neighbours, &things));
    let mut doors = axial.doors();
    // What was looked at in thick walls was found or refused there.
    let taken = nodes_at_openings(plan, graph, axes);
    let simple = simple_doors(plan, graph, axes, interior, (&pieces, &neighbours));
    doors.extend(simple.into_iter().filter(|d| d.nodes.iter().all(|n| !taken.contains(n))));
    let (sliding, stays) = axial.partitions();
    let named = |list: Vec<Sliding>, word: &str| -> Vec<(Group, Vec<u32>)> {
        let group = |(i, s): (usize, Sliding)| s.group(plan, graph, format!("{word}-{}", i + 1));
        list.into_iter().enumerate().map(group).collect()
    };
    let (found, walls) = ((elements.len(), doors.len()), named(sliding, "wall"));
    let sliding = walls.len();
    let (mut taken, mut doorways) = (Taken::default(), Doorways::new(plan, graph, axes, &things));
    let mut out: Vec<(Group, Vec<u32>)> = Vec::new();
    for (group, nodes) in by_turns([elements, walls, named(doors, "door")]) {
        if out.len() == GROUPS_MAX || !taken.is_free(&group, &nodes) {
            continue;
        }
        if let Some(group) = doorways.shortened(&group, &nodes) {
            taken.take(&group, &nodes);
            out.push((group, nodes));
        }
    }
    let parameters: usize = out.iter().map(|g| g.0.clauses.len()).sum();
    let standing = match posts {
        0 => String::new(),
        1 => format!("; 1 post up to {} m stays", (POST_MAX_M * plan.human_scale * 1e4).round() / 1e4),
        n => format!("; {n} posts up to {} m stay", (POST_MAX_M * plan.human_scale * 1e4).round() / 1e4),
    };
    let text = match found {
        (0, 0) if sliding == 0 => nothing_moves(&plan.markers, words, &stays) + &standing,
        (e, d) => format!(
            "{}: {} (±{} m) and {} (±{} m along their wall){} \
             were found, {} of them with {} may move (at most {GROUPS_MAX}), none through another \
             wall{}{standing}; {} says it better, {} holds things still",
            plan.markers.unmarked_words(words.moves),
            counted(e as u64, "free-standing element"),
            SHIFT_M * plan.human_scale,
            counted(d as u64, "door gap"),
            SLIDE_M * plan.human_scale,
            if sliding == 0 {
                String::new()
            } else {
                format!(" and {} that can slide between others", counted(sliding as u64, "wall"))
            },
            out.len(),
            counted(parameters as u64, "parameter"),
            doorways.words(),
            words.moves,
            words.keeps
        ),
    };
    report.info("default-moves", place, text);
    out
}

/// The groups of several lists: the first of each, then the second of each.
fn by_turns(lists: [Vec<(Group, Vec<u32>)>; 3]) -> Vec<(Group, Vec<u32>)> {
    let mut lists = lists.map(Vec::into_iter);
    let most = lists.iter().map(ExactSizeIterator::len).max().unwrap_or(0);
    (0..most).flat_map(|_| lists.iter_mut().filter_map(Iterator::next).collect::<Vec<_>>()).collect()
}

/// What to do where nothing moves by default, and why nothing does.
fn nothing_moves(markers: &Markers, words: &Marking, stays: &[Stays]) -> String {
    let why = match told(stays) {
        none if none.is_empty() => "no thick straight wall was found".to_string(),
        told => told,
    };
    format!(
        "nothing may move, the present layout is measured: {} ({}, and no free-standing element or door gap in the \
         drawing; {why})",
        words.order,
        markers.unmarked_words(words.moves)
    )
}

/// In which directions each node moves already. A node may move twice, at right angles: a wall that
/// slides with the wall that it ends at in tow.
#[derive(Default)]
struct Taken(BTreeMap<u32, Vec<Option<DVec2>>>);

impl Taken {
    /// The one direction in which a group moves.
    fn direction(group: &Group) -> Option<DVec2> {
        match group.clauses.as_slice() {
            [clause] => match clause.kind {
                Kind::X => Some(DVec2::X),
                Kind::Y => Some(DVec2::Y),
                Kind::Along(angle) => Some(DVec2::from_angle(angle)),
                Kind::Rotate(_) | Kind::Scale(_) => None,
            },
            _ => None,
        }
    }

    /// Takes nodes for a group.
    fn take(&mut self, group: &Group, nodes: &[u32]) {
        let direction = Self::direction(group);
        nodes.iter().for_each(|n| self.0.entry(*n).or_default().push(direction));
    }

    /// Whether none of the nodes would move twice in one direction.
    fn is_free(&self, group: &Group, nodes: &[u32]) -> bool {
        let direction = Self::direction(group);
        let crosses = |other: &Option<DVec2>| match (direction, other) {
            (Some(a), Some(b)) => a.dot(*b).abs() < CROSSING_COS,
            _ => false,
        };
        nodes.iter().all(|n| self.0.get(n).is_none_or(|list| list.iter().all(crosses)))
    }
}

/// Pieces in metres of a person, so that all sizes above mean what they say in a plan of unknown scale.
fn pieces(plan: &Plan, graph: &Graph) -> Vec<Piece> {
    let mut out = Vec::new();
    for (w, wall) in plan.walls.iter().enumerate() {
        let nodes = &graph.trace_nodes[w];
        for (i, j, s) in wall.trace.segments() {
            let [a, b] = [s.a, s.b].map(|p| plan.frame.plan_from_um(p) / plan.human_scale);
            out.push(Piece { wall: w as u32, nodes: [nodes[i], nodes[j]], a, b });
        }
    }
    out
}

struct Union(Vec<u32>);

impl Union {
    fn root(&mut self, mut i: u32) -> u32 {
        while self.0[i as usize] != i {
            self.0[i as usize] = self.0[self.0[i as usize] as usize];
            i = self.0[i as usize];
        }
        i
    }

    fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b) as usize] = a.min(b);
    }
}

/// What holds elements still.
struct Held {
    /// Walls at doors, windows and glass.
    walls: BTreeSet<u32>,
    /// The walls that draw each column.
    columns: Vec<BTreeSet<u32>>,
}

impl Held {
    /// Whether an element stays: it ends at an opening, or a column, which carries, is part of it.
    fn holds(&self, element: &[u32]) -> bool {
        let has_column = |c: &BTreeSet<u32>| {
            let own = element.iter().filter(|w| c.contains(w)).count();
            own > 0 && own < element.len()
        };
        element.iter().any(|w| self.walls.contains(w)) || self.columns.iter().any(has_column)
    }

    /// Whether an element is a column and nothing else.
    fn is_column(&self, element: &[u32]) -> bool {
        self.columns.iter().any(|c| element.iter().all(|w| c.contains(w)))
    }
}

/// Walls of the structure.
fn carrying(plan: &Plan) -> impl Iterator<Item = u32> {
    (0u32..).zip(&plan.walls).filter(|(_, w)| plan.bearing.contains_key(&w.source.record)).map(|(i, _)| i)
}

/// The walls that draw each column.
fn columns(axes: &AxisGraph) -> Vec<BTreeSet<u32>> {
    let columns = axes.nodes.iter().filter(|n| matches!(n.kind, NodeKind::Column(_)));
    columns.map(|n| n.faces.iter().map(|f| f.0).collect()).collect()
}

/// Walls that a door or a window sits in, or ends at: what joins them to others is drawn on other layers.
fn walls_at_openings(axes: &AxisGraph) -> BTreeSet<u32> {
    let filled = axes.openings.iter().filter(|o| o.kind != OpeningKind::Passage);
    let jambs: Vec<&Jamb> = filled.flat_map(|o| &o.jambs).collect();
    let nodes: BTreeSet<u32> = jambs.iter().filter_map(|j| j.node).collect();
    let mut edges: BTreeSet<u32> = jambs.iter().filter_map(|j| j.edge).collect();
    let ends = axes.edges.iter().enumerate().filter(|(_, e)| e.nodes.iter().any(|n| nodes.contains(n)));
    edges.extend(ends.map(|(i, _)| i as u32));
    let edges = edges.into_iter().map(|e| &axes.edges[e as usize]);
    let of_edges = edges.flat_map(|e| e.left.iter().chain(&e.right).chain(&e.inner));
    // Caps, and the columns that a door hangs at.
    let of_nodes = nodes.iter().flat_map(|n| &axes.nodes[*n as usize].faces);
    of_edges.chain(of_nodes).map(|f| f.0).collect()
}

/// Nodes at the jambs of all openings in thick walls.
fn nodes_at_openings(plan: &Plan, graph: &Graph, axes: &AxisGraph) -> BTreeSet<u32> {
    let thick = axes.openings.iter().filter(|o| o.thickness_m > 0.0);
    let handles = thick.flat_map(|o| jambs_of(plan, axes, o)).flatten();
    handles.map(|(w, c)| graph.control_nodes[w as usize][c as usize]).collect()
}

/// Walls near which glass, a window or a leaf ends.
fn walls_at_infill<'a>(
    plan: &Plan,
    infill: &[Segment],
    pieces: &'a [Piece],
    neighbours: &'a Neighbours,
) -> impl Iterator<Item = u32> + use<'a> {
    let scale = plan.human_scale;
    let ends: Vec<DVec2> =
        infill.iter().flat_map(|s| [s.a, s.b]).map(|p| plan.frame.plan_from_um(p) / scale).collect();
    ends.into_iter().flat_map(move |p| {
        let end = Piece { wall: u32::MAX, nodes: [u32::MAX; 2], a: p, b: p };
        let near = neighbours.around(p, p).map(|j| &pieces[j as usize]);
        near.filter(move |q| distance(&end, q) <= STANDS_FREE_M).map(|q| q.wall).collect::<Vec<_>>()
    })
}

/// Free-standing elements, the largest first, and the number of posts, which stay.
fn elements(
    plan: &Plan,
    graph: &Graph,
    axes: &AxisGraph,
    interior: &Interior,
    held: &Held,
    pieces: &[Piece],
    neighbours: &Neighbours,
) -> (Vec<(Group, Vec<u32>)>, usize) {
    let mut union = Union((0..plan.walls.len() as u32).collect());
    let mut by_node: BTreeMap<u32, u32> = BTreeMap::new();
    let mut by_record: BTreeMap<usize, u32> = BTreeMap::new();
    for (w, wall) in plan.walls.iter().enumerate() {
        if wall.editable.moves_whole() {
            union.join(*by_record.entry(wall.source.record).or_insert(w as u32), w as u32);
        }
    }
    for p in pieces {
        for n in p.nodes {
            let first = *by_node.entry(n).or_insert(p.wall);
            union.join(first, p.wall);
        }
    }
    for (i, p) in pieces.iter().enumerate() {
        let own = union.root(p.wall);
        let is_new = |j: &u32| *j as usize > i && union.root(pieces[*j as usize].wall) != own;
        let mut beside: Vec<u32> = neighbours.around(p.a.min(p.b), p.a.max(p.b)).filter(is_new).collect();
        beside.sort_unstable();
        beside.dedup();
        for q in beside.into_iter().map(|j| &pieces[j as usize]) {
            if distance(p, q) <= TOUCH_M || are_faces(p, q) {
                union.join(p.wall, q.wall);
            }
        }
    }
    let mut clusters: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for w in 0..plan.walls.len() as u32 {
        clusters.entry(union.root(w)).or_default().push(w);
    }
    let all = box_of(pieces.iter().flat_map(|p| [p.a, p.b])).unwrap_or_default();
    let longest = (all[1] - all[0]).max_element();
    let mut found: Vec<Element> = Vec::new();
    let mut posts = 0;
    let right_angles = furniture::right_angles(plan);
    let shifts = furniture::shifts(right_angles);
    for walls in clusters.values() {
        let points = || walls.iter().flat_map(|w| &plan.walls[*w as usize].trace.points);
        let [lo, hi] = box_of(points().map(|p| plan.frame.plan_from_um(*p))).unwrap_or_default();
        let encloses = walls.iter().any(|w| {
            let wall = &plan.walls[*w as usize];
            wall.trace.is_closed && !wall.is_solid
        });
        let is_inside = points().all(|p| interior.depth_m(*p) > INSIDE_MARGIN_M * plan.human_scale);
        let size = (hi - lo) / plan.human_scale;
        let is_held = held.holds(walls);
        let is_block =
            size.max_element() > ELEMENT_SHARE_MAX * longest || size.min_element() > ELEMENT_DEPTH_MAX_M;
        if encloses || is_held || !is_inside || is_block {
            continue;
        }
        if size.max_element() <= if held.is_column(walls) { COLUMN_MAX_M } else { POST_MAX_M } {
            posts += 1;
            continue;
        }
        if !stands_free(walls, axes, pieces, neighbours) {
            continue;
        }
        let mut nodes: Vec<u32> =
            walls.iter().flat_map(|w| graph.control_nodes[*w as usize].clone()).collect();
        nodes.sort_unstable();
        nodes.dedup();
        let editable = |w: &u32| &plan.walls[*w as usize].editable;
        if walls.iter().any(|w| matches!(editable(w), Editable::No(_))) {
            continue;
        }
        // What cannot turn still shifts: no turn is asked of it, as of what is round.
        let is_stiff = walls.iter().any(|w| matches!(editable(w), Editable::WithInsert { turnable: false }));
        let is_round = nodes.len() == 1 || is_stiff;
        let turn_deg = (!is_round).then_some(if right_angles.is_some() { RIGHT_DEG } else { TURN_DEG });
        let source = plan.walls[walls[0] as usize].source.clone();
        found.push(Element { bounds: [lo, hi], nodes, turn_deg, source });
    }
    let mut found = furniture::in_rows(found, plan.human_scale);
    let size = |e: &Element| (e.bounds[1] - e.bounds[0]).length();
    found.sort_by(|a, b| size(b).total_cmp(&size(a)).then_with(|| a.nodes.cmp(&b.nodes)));
    let named = found.into_iter().enumerate().map(|(i, e)| {
        let mut group =
            group(&e.source, e.bounds, plan, element_clauses(shifts, e.turn_deg, plan.human_scale));
        group.name = format!("element-{}", i + 1);
        (group, e.nodes)
    });
    (named.collect(), posts)
}

/// Whether neither another wall nor a door or window is near the ends of an element's pieces.
fn stands_free(walls: &[u32], axes: &AxisGraph, pieces: &[Piece], neighbours: &Neighbours) -> bool {
    let own: BTreeSet<u32> = walls.iter().copied().collect();
    let filled: Vec<[DVec2; 2]> = axes
        .openings
        .iter()
        .filter(|o| o.kind != OpeningKind::Passage)
        .map(|o| o.jambs.map(|j| j.at))
        .collect();
    let mut ends = pieces.iter().filter(|p| own.contains(&p.wall)).flat_map(|p| [p.a, p.b]);
    ends.all(|p| {
        let end = Piece { wall: u32::MAX, nodes: [u32::MAX; 2], a: p, b: p };
        let mut near = neighbours.around(p, p).map(|j| &pieces[j as usize]);
        near.all(|q| own.contains(&q.wall) || distance(&end, q) > STANDS_FREE_M)
            && filled.iter().all(|o| distance_to_segment(p, *o) > STANDS_FREE_M)
    })
}

fn element_clauses(shifts: [Kind; 2], turn_deg: Option<f64>, scale: f64) -> Vec<Clause> {
    let far = SHIFT_M * scale;
    let metres = |kind| Clause { kind, lower: -far, upper: far, unit: "m".into(), si_per_unit: 1.0 };
    let turn = |far: f64| Clause {
        kind: Kind::Rotate(None),
        lower: -far,
        upper: far,
        unit: "deg".into(),
        si_per_unit: 1f64.to_radians(),
    };
    shifts.map(metres).into_iter().chain(turn_deg.map(turn)).collect()
}

fn group(source: &SourceRef, [lo, hi]: [DVec2; 2], plan: &Plan, clauses: Vec<Clause>) -> Group {
    let corners = [lo, DVec2::new(hi.x, lo.y), hi, DVec2::new(lo.x, hi.y)];
    let ring = corners.map(|p| plan.frame.um_from_plan(p)).to_vec();
    Group { name: String::new(), outline: Region::Ring(ring), clauses, source: source.clone() }
}

/// A wall end that looks into a gap.
struct End {
    /// One node (a line's end) or the two corners of an end face.
    nodes: Vec<u32>,
    at: DVec2,
    /// Unit vector out of the wall, into the gap.
    out: DVec2,
    /// Length of the wall behind, up to the next node.
    behind_m: f64,
}

/// Faces of thick walls: one of them alone is no wall.
fn faces(axes: &AxisGraph) -> BTreeSet<u32> {
    let thick = axes.edges.iter().filter(|e| e.thickness_m > 0.0);
    thick.flat_map(|e| e.left.iter().chain(&e.right).chain(&e.inner)).map(|f| f.0).collect()
}

/// Whether another end stands beside this one and looks the same way: two faces of one wall, drawn apart.
fn has_twin(e: &End, ends: &[End]) -> bool {
    ends.iter().any(|o| {
        let to = o.at - e.at;
        e.out.dot(o.out) > 0.99
            && (TOUCH_M..=WALL_THICKNESS_MAX_M).contains(&to.perp_dot(e.out).abs())
            && to.dot(e.out).abs() < WALL_THICKNESS_MAX_M
    })
}

/// Gaps between two wall ends that face each other, whatever the walls are drawn as. The gap in one face of
/// a thick wall is none: the other face would stay.
fn simple_doors(
    plan: &Plan,
    graph: &Graph,
    axes: &AxisGraph,
    interior: &Interior,
    (pieces, neighbours): (&[Piece], &Neighbours),
) -> Vec<Sliding> {
    let faces = faces(axes);
    let all = ends(plan, graph, pieces);
    let is_whole = |e: &End| {
        let walls = || e.nodes.iter().flat_map(|n| &graph.handles[*n as usize]).map(|h| h.0);
        let is_face = e.nodes.len() == 1 && (walls().any(|w| faces.contains(&w)) || has_twin(e, &all));
        let may_move = |w: &enfilade_plan::Wall| {
            w.editable == Editable::Free && !plan.bearing.contains_key(&w.source.record)
        };
        !is_face && walls().all(|w| may_move(&plan.walls[w as usize]))
    };
    let ends: Vec<&End> = all.iter().filter(|e| is_whole(e)).collect();
    let mut found: Vec<Sliding> = Vec::new();
    for (i, e) in ends.iter().enumerate() {
        let facing = |(_, f): &(usize, &&End)| {
            let to = f.at - e.at;
            let along = to.dot(e.out);
            (DOOR_WIDTH_M[0]..=DOOR_WIDTH_M[1]).contains(&along)
                && to.perp_dot(e.out).abs() < TOUCH_M
                && e.out.dot(f.out) < -0.99
        };
        let nearest = ends.iter().enumerate().filter(facing);
        let Some((j, f)) =
            nearest.min_by(|(_, a), (_, b)| a.at.distance(e.at).total_cmp(&b.at.distance(e.at)))
        else {
            continue;
        };
        let middle = e.at.midpoint(f.at);
        let is_inside = [-1.0, 1.0].iter().all(|s| {
            let side = (middle + e.out.perp() * (*s * 0.8)) * plan.human_scale;
            interior.depth_m(plan.frame.um_from_plan(side)) > INSIDE_MARGIN_M * plan.human_scale
        });
        if j <= i || !is_inside || !is_free(e, f, plan, pieces, neighbours) {
            continue;
        }
        let room = |behind_m: f64| whole_mm(SLIDE_M.min(behind_m - REST_M).max(0.0));
        let (back, forth) = (room(e.behind_m), room(f.behind_m));
        if back + forth >= 2.0 * SLIDE_MIN_M {
            let mut nodes: Vec<u32> = e.nodes.iter().chain(&f.nodes).copied().collect();
            nodes.sort_unstable();
            nodes.dedup();
            let (direction, is_turned) = upright(e.out);
            let way = if is_turned { [-forth, back] } else { [-back, forth] };
            let way = way.map(|v| v * plan.human_scale + 0.0);
            let size = e.at.distance(f.at);
            found.push(Sliding { nodes, direction, way, at: middle, size, slot: None, wall: None });
        }
    }
    found.sort_by(|a, b| a.at.x.total_cmp(&b.at.x).then(a.at.y.total_cmp(&b.at.y)));
    found
}

fn ends(plan: &Plan, graph: &Graph, pieces: &[Piece]) -> Vec<End> {
    let mut at_node: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
    for (i, p) in pieces.iter().enumerate() {
        p.nodes.iter().for_each(|n| at_node.entry(*n).or_default().push(i));
    }
    let is_control = |n: u32| (n as usize) < graph.nodes.len();
    let away = |i: usize, n: u32| {
        let p = &pieces[i];
        if p.nodes[0] == n { p.a - p.b } else { p.b - p.a }
    };
    let mut out = Vec::new();
    for (n, around) in &at_node {
        if let ([i], true) = (around.as_slice(), is_control(*n)) {
            let d = away(*i, *n);
            if d.length() > REST_M {
                out.push(End {
                    nodes: vec![*n],
                    at: graph.nodes[*n as usize] / plan.human_scale,
                    out: d.normalize(),
                    behind_m: d.length(),
                });
            }
        }
    }
    for (i, p) in pieces.iter().enumerate() {
        let width = p.a.distance(p.b);
        if !(0.01..=WALL_THICKNESS_MAX_M).contains(&width) || !p.nodes.iter().all(|n| is_control(*n)) {
            continue;
        }
        let side = |n: u32| match at_node[&n].as_slice() {
            [x, y] => Some(away(if *x == i { *y } else { *x }, n)),
            _ => None,
        };
        let (Some(u), Some(v)) = (side(p.nodes[0]), side(p.nodes[1])) else { continue };
        let across = (p.b - p.a) / width;
        let (ul, vl) = (u.length(), v.length());
        let is_end =
            ul > width && vl > width && u.dot(v) > 0.999 * ul * vl && u.dot(across).abs() < 0.02 * ul;
        if is_end {
            out.push(End {
                nodes: p.nodes.to_vec(),
                at: p.a.midpoint(p.b),
                out: u / ul,
                behind_m: ul.min(vl),
            });
        }
    }
    out
}

/// Whether no wall stands in the gap between two ends.
fn is_free(e: &End, f: &End, plan: &Plan, pieces: &[Piece], neighbours: &Neighbours) -> bool {
    let inset = e.out * 0.02;
    let um = |p: DVec2| -> PointUm { plan.frame.um_from_plan(p * plan.human_scale) };
    let gap = Segment { a: um(e.at + inset), b: um(f.at - inset) };
    neighbours.near(e.at.min(f.at), e.at.max(f.at)).iter().all(|i| {
        let p = &pieces[*i as usize];
        !segments_touch(gap, Segment { a: um(p.a), b: um(p.b) })
    })
}

fn distance(p: &Piece, q: &Piece) -> f64 {
    let um = |v: DVec2| [(v.x * UM_PER_M).round() as i64, (v.y * UM_PER_M).round() as i64];
    if segments_touch(Segment { a: um(p.a), b: um(p.b) }, Segment { a: um(q.a), b: um(q.b) }) {
        return 0.0;
    }
    let to = |v: DVec2, s: &Piece| {
        let d = s.b - s.a;
        let t = if d.length_squared() > 0.0 {
            ((v - s.a).dot(d) / d.length_squared()).clamp(0.0, 1.0)
        } else {
            0.0
        };
        v.distance(s.a + d * t)
    };
    to(p.a, q).min(to(p.b, q)).min(to(q.a, p)).min(to(q.b, p))
}

/// Whether two pieces are the two faces of one wall: parallel, near, side by side.
fn are_faces(p: &Piece, q: &Piece) -> bool {
    let (u, v) = (p.b - p.a, q.b - q.a);
    let (ul, vl) = (u.length(), v.length());
    if ul < 1e-6 || vl < 1e-6 || u.perp_dot(v).abs() > 0.01 * ul * vl {
        return false;
    }
    let u = u / ul;
    let offset = (q.a - p.a).perp_dot(u).abs();
    let (s, t) = ((q.a - p.a).dot(u), (q.b - p.a).dot(u));
    let overlap = s.max(t).min(ul) - s.min(t).max(0.0);
    offset <= WALL_THICKNESS_MAX_M && overlap > 0.5 * ul.min(vl)
}

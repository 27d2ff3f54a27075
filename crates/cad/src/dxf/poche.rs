//! Poché: what fills the ground between the faces of a wall goes along with it, corner by corner, and so does what is drawn
//! round a room.

use std::collections::HashSet;

use glam::DVec2;

use super::boundary::{At, Boundary, Piece, boundary, quad};
use super::curves::is_upright;
use super::fields::{Fields, VertexSlots, lwpolyline_vertices, own_pairs};
use super::ground::{Face, Ground, crossing, distance_to_line, overlap};
use super::header::Header;
use super::rooms::{self, room};
use super::tokens::{Pair, Tokens};
use crate::drawing::{Drawing, Edit, Entity, Shape, SourceRef};
use crate::own_layers::is_own;
use crate::plane::{box_of, distance_to_segment};
use crate::roles::{Role, role_by_name};

/// A corner is on what lies within this much of it, in parts of the smaller side of the box round the fill.
const ON_SHARE: f64 = 1e-4;

/// Most pieces of the outlines of a HATCH that goes along: beyond them it is a picture.
pub(super) const PIECES_MAX: usize = 4096;

/// Kinds of filled areas.
pub(super) const FILLS: [&[u8]; 3] = [b"HATCH", b"SOLID", b"TRACE"];

/// Corners of a closed polyline on faces that moved that make it the outline of a room.
const CORNERS_LEFT_MIN: usize = 2;

/// A filled area, or the outline of a room, that goes along with what an edit moves.
#[derive(Clone, Debug, PartialEq)]
pub struct Following {
    /// New places of its points.
    pub edit: Edit,
    /// Its corners as drawn and after, drawing units.
    pub corners: [Vec<DVec2>; 2],
}

/// The HATCH, SOLID and TRACE of model space of which every corner lies on what `edits` move or on what stands, and for
/// which both say where it is afterwards; in file order, none of `held`. An outline that would turn over stays. The closed
/// LWPOLYLINE of a layer of rooms follows by its sides what is `held` alone: rooms do not hold each other. Besides,
/// the rooms that lie on what moves and cannot follow. `metres`: those of a drawing unit.
pub(super) fn following(
    tokens: &Tokens<'_>,
    drawing: &Drawing,
    edits: &[Edit],
    (held, metres): (&HashSet<usize>, f64),
) -> (Vec<Following>, Vec<usize>) {
    let mut moved = Ground::moved(drawing, edits);
    if moved.bounds().is_none() {
        return Default::default();
    }
    let page = Header::read(tokens).page(tokens);
    let mut edited: HashSet<usize> = edits.iter().map(Edit::record).collect();
    let is_free = |record: &usize| !held.contains(record) && !edited.contains(record);
    let layer = |record: usize| {
        let layer = own_pairs(tokens, record).find(|(_, p)| p.code == 8);
        layer.map_or_else(String::new, |(_, p)| page.decode(tokens.value(p)))
    };
    let section = tokens.section(b"ENTITIES").unwrap_or(0..0);
    let is_fill = |record: &usize| FILLS.contains(&tokens.name(*record)) && !is_own(&layer(*record));
    let is_room =
        |record: &usize| is_closed_polyline(tokens, *record) && role_by_name(&layer(*record)).0 == Role::Room;
    let fills: Vec<usize> = section.clone().filter(is_free).filter(is_fill).collect();
    let outlines: Vec<usize> = section.filter(is_free).filter(is_room).collect();
    let shown = drawing.entities.iter().map(|e| e.source.record);
    let others: HashSet<usize> = shown.filter(|r| !held.contains(r)).chain(edited.clone()).collect();
    let (mut out, mut left) = (Vec::new(), Vec::new());
    for record in outlines {
        let Some(area) = Area::read(tokens, record) else { continue };
        let (points, bounds) = (&area.points, area.bounds);
        let outline = rooms::Outline { points, round: area.round().collect(), bounds };
        match room(&outline, &moved, (drawing, &others), metres) {
            Ok(new) => out.extend(new.map(|new| Following {
                corners: [area.points.clone(), new.clone()],
                edit: Edit::Points { record, points: new },
            })),
            Err(_) => left.push(record),
        }
    }
    // What fills a room lies on its outline as well as on the walls.
    for room in &out {
        moved.add_ring(&room.corners);
        edited.insert(room.edit.record());
    }
    let fill = |record: usize| Area::read(tokens, record)?.following(&moved, drawing, &edited);
    out.extend(fills.into_iter().filter_map(fill));
    out.sort_by_key(|f| f.edit.record());
    (out, left)
}

fn is_closed_polyline(tokens: &Tokens<'_>, record: usize) -> bool {
    let is_closed =
        |(_, p): (usize, &Pair)| p.code == 70 && tokens.integer(p).is_some_and(|flags| flags & 1 != 0);
    tokens.name(record) == b"LWPOLYLINE" && own_pairs(tokens, record).any(is_closed)
}

/// The closed polylines, none of `held`, of which several corners lie on faces that `edits` take from under them: rooms, and
/// what else is drawn round the floor. Those of doors and windows are theirs.
pub(super) fn left_on_faces<'d>(
    drawing: &'d Drawing,
    edits: &[Edit],
    held: &HashSet<usize>,
) -> impl Iterator<Item = &'d SourceRef> {
    let moved = Ground::moved(drawing, edits);
    let edited: HashSet<usize> = edits.iter().map(Edit::record).collect();
    let is_free = |e: &Entity| {
        let record = e.source.record;
        let is_part = matches!(role_by_name(&e.layer).0, Role::Door | Role::Window | Role::Wall);
        e.insert().is_none() && !held.contains(&record) && !edited.contains(&record) && !is_part
    };
    let is_left = |e: &Entity| {
        let Shape::Polyline { vertices, closed: true } = &e.shape else { return false };
        let corners: Vec<DVec2> = vertices.iter().map(|v| v.at).collect();
        let (Some(around), Some(ground)) = (box_of(corners.iter().copied()), moved.bounds()) else {
            return false;
        };
        let tolerance = ON_SHARE * (around[1] - around[0]).min_element();
        let left = || corners.iter().filter(|p| moved.leaves(**p, tolerance)).count();
        overlap(around, ground) && left() >= CORNERS_LEFT_MIN
    };
    let found: Vec<&SourceRef> =
        drawing.entities.iter().filter(|e| is_free(e) && is_left(e)).map(|e| &e.source).collect();
    found.into_iter()
}

/// Pairs of the points of the filled area at `record`, in the order in which [`Edit::Points`] names them.
pub(super) fn points_of(tokens: &Tokens<'_>, record: usize) -> Option<Vec<At>> {
    match tokens.name(record) {
        b"SOLID" | b"TRACE" => Some(quad(tokens, record)),
        b"HATCH" => Some(Area::of_hatch(&boundary(tokens, record, PIECES_MAX)?).0),
        b"LWPOLYLINE" => Some(Area::of_hatch(&ring(tokens, record)?).0),
        _ => None,
    }
}

/// The vertices of a polyline as an outline.
fn ring(tokens: &Tokens<'_>, record: usize) -> Option<Boundary> {
    let corner = |v: VertexSlots| {
        let bulge = v.bulge.map_or(Some(0.0), |i| tokens.number(&tokens.pairs[i]))?;
        Some(Piece::Corner { at: At { x: v.x, y: v.y? }, bulge })
    };
    let vertices = lwpolyline_vertices(tokens, record);
    let outline: Vec<Piece> = vertices.into_iter().map(corner).collect::<Option<_>>()?;
    let is_ring = (3..=PIECES_MAX).contains(&outline.len());
    is_ring.then(|| Boundary { outlines: vec![outline], seeds: Vec::new() })
}

/// Places of the points of a filled area, and what its outlines are made of.
struct Area {
    record: usize,
    /// As seen from above, drawing units; in the order of [`points_of`].
    points: Vec<DVec2>,
    outlines: Vec<Outline>,
    /// Points that lie inside.
    seeds: Vec<usize>,
    /// Box round the outlines.
    bounds: [DVec2; 2],
    tolerance: f64,
}

/// One outline of an area, by the numbers of its points.
#[derive(Default)]
struct Outline {
    corners: Vec<usize>,
    /// Corners between which the outline is round: they keep their distance.
    round: Vec<[usize; 2]>,
    arcs: Vec<Arc>,
    has_curves: bool,
}

struct Arc {
    centre: usize,
    radius: f64,
    /// From the centre; none of a whole circle.
    ends: Option<[DVec2; 2]>,
}

impl Area {
    fn read(tokens: &Tokens<'_>, record: usize) -> Option<Self> {
        let (slots, outlines, seeds) = match tokens.name(record) {
            b"SOLID" | b"TRACE" => {
                let slots = quad(tokens, record);
                let corners = match slots.len() {
                    4 => vec![0, 1, 3, 2],
                    3 => vec![0, 1, 2],
                    _ => return None,
                };
                (slots, vec![Outline { corners, ..Outline::default() }], Vec::new())
            }
            b"HATCH" => Self::of_hatch(&boundary(tokens, record, PIECES_MAX)?),
            b"LWPOLYLINE" => Self::of_hatch(&ring(tokens, record)?),
            _ => return None,
        };
        let side = side_of(tokens, record)?;
        if side < 0.0 && outlines.iter().any(|o| !o.arcs.is_empty()) {
            return None;
        }
        let at = |slot: &At| slot.point(tokens).map(|p| DVec2::new(p.x * side, p.y));
        let points: Vec<DVec2> = slots.iter().map(at).collect::<Option<_>>()?;
        if points.iter().any(|p| !p.is_finite()) {
            return None;
        }
        let mut area = Self { record, points, outlines, seeds, bounds: [DVec2::ZERO; 2], tolerance: 0.0 };
        let arcs = area.outlines.iter().flat_map(|o| &o.arcs);
        let round = arcs.flat_map(|a| [-a.radius, a.radius].map(|r| area.points[a.centre] + r));
        let corners = area.outlines.iter().flat_map(|o| &o.corners).map(|&i| area.points[i]);
        let [low, high] = box_of(corners.chain(round))?;
        area.tolerance = ON_SHARE * (high - low).min_element();
        area.bounds = [low - area.tolerance, high + area.tolerance];
        Some(area)
    }

    /// The pairs of all points, the outlines by their numbers, and those of the points inside.
    fn of_hatch(found: &Boundary) -> (Vec<At>, Vec<Outline>, Vec<usize>) {
        let mut slots: Vec<At> = Vec::new();
        let mut add = |at: At| {
            slots.push(at);
            slots.len() - 1
        };
        let mut outlines = Vec::new();
        for pieces in &found.outlines {
            let mut outline = Outline::default();
            let mut bulges = Vec::new();
            for piece in pieces {
                match *piece {
                    Piece::Corner { at, bulge } => {
                        outline.corners.push(add(at));
                        bulges.push(bulge);
                    }
                    Piece::Line { start, end } => outline.corners.extend([add(start), add(end)]),
                    Piece::Arc { centre, radius, angles_deg, is_clockwise } => {
                        outline.arcs.push(Arc::new(add(centre), radius, angles_deg, is_clockwise));
                    }
                    Piece::Curve => outline.has_curves = true,
                }
            }
            let corners = &outline.corners;
            let round = (0..bulges.len()).filter(|&i| bulges[i] != 0.0);
            outline.round = round.map(|i| [corners[i], corners[(i + 1) % bulges.len()]]).collect();
            outlines.push(outline);
        }
        let seeds = found.seeds.iter().map(|&at| add(at)).collect();
        (slots, outlines, seeds)
    }

    fn following(&self, moved: &Ground, drawing: &Drawing, edited: &HashSet<usize>) -> Option<Following> {
        if !overlap(self.bounds, moved.bounds()?) {
            return None;
        }
        let standing = Ground::standing(drawing, edited, self.bounds);
        let new = self.moved(&[moved, &standing])?;
        let corners = |points: &[DVec2]| self.bound().map(|i| points[i]).collect();
        Some(Following {
            corners: [corners(&self.points), corners(&new)],
            edit: Edit::Points { record: self.record, points: new },
        })
    }

    /// New places of all points; `None` where one is uncertain, or none moves.
    fn moved(&self, grounds: &[&Ground]) -> Option<Vec<DVec2>> {
        let mut new = self.points.clone();
        for outline in &self.outlines {
            if outline.has_curves {
                return None;
            }
            for &i in &outline.corners {
                new[i] = place(grounds, self.points[i], self.tolerance)?;
            }
            for arc in &outline.arcs {
                new[arc.centre] += arc.shift(grounds, self.points[arc.centre], self.tolerance)?;
            }
            let stays_round = outline.round.iter().all(|&[a, b]| {
                let length = |points: &[DVec2]| points[a].distance(points[b]);
                (length(&new) - length(&self.points)).abs() <= self.tolerance
            });
            if !stays_round
                || !self.keeps_its_side(outline, &new)
                || !self.keeps_its_edges(grounds, outline, &new)
            {
                return None;
            }
        }
        let shifts: Vec<DVec2> = self.bound().map(|i| new[i] - self.points[i]).collect();
        let first = *shifts.first()?;
        if shifts.iter().all(|s| s.length() <= self.tolerance) {
            return None;
        }
        if shifts.iter().all(|s| s.distance(first) <= self.tolerance) {
            self.seeds.iter().for_each(|&i| new[i] += first);
        }
        Some(new)
    }

    /// Points by which the outlines are made: corners, and the centres of arcs.
    fn bound(&self) -> impl Iterator<Item = usize> {
        self.outlines.iter().flat_map(|o| o.corners.iter().copied().chain(o.arcs.iter().map(|a| a.centre)))
    }

    /// Whether every edge keeps its direction or turns with a face on which it lies whole, or all of the outline turns as one:
    /// an edge that runs on past the end of a face would go astray.
    fn keeps_its_edges(&self, grounds: &[&Ground], outline: &Outline, new: &[DVec2]) -> bool {
        let corners = &outline.corners;
        let (old, tolerance) = (&self.points, self.tolerance);
        let as_far =
            |i: usize, j: usize| (new[i].distance(new[j]) - old[i].distance(old[j])).abs() <= tolerance;
        let edges = || (0..corners.len()).map(|k| (corners[k], corners[(k + 1) % corners.len()]));
        if edges().all(|(i, j)| as_far(i, j)) && corners.iter().all(|&i| as_far(corners[0], i)) {
            return true;
        }
        edges().all(|(i, j)| {
            let along = (old[j] - old[i]).normalize_or_zero();
            let step = new[j] - new[i];
            let is_parallel = along.perp_dot(step).abs() <= tolerance && along.dot(step) >= -tolerance;
            let on = |f: &Face| {
                [i, j].iter().all(|&k| {
                    distance_to_segment(old[k], f.from) <= tolerance
                        && distance_to_line(new[k], f.to) <= tolerance
                })
            };
            is_parallel || grounds.iter().flat_map(|g| &g.faces).any(on)
        })
    }

    /// Pairs of corners between which an outline is round.
    fn round(&self) -> impl Iterator<Item = [usize; 2]> {
        self.outlines.iter().flat_map(|o| o.round.iter().copied())
    }

    fn keeps_its_side(&self, outline: &Outline, new: &[DVec2]) -> bool {
        let area = |points: &[DVec2]| -> f64 {
            let corner =
                |k: usize| points[outline.corners[k % outline.corners.len()]] - points[outline.corners[0]];
            (0..outline.corners.len()).map(|k| corner(k).perp_dot(corner(k + 1))).sum()
        };
        outline.corners.len() < 3 || area(&self.points) * area(new) > 0.0
    }
}

impl Arc {
    fn new(centre: usize, radius: f64, [from, to]: [f64; 2], is_clockwise: bool) -> Self {
        let side = if is_clockwise { -1.0 } else { 1.0 };
        let end = |deg: f64| radius * DVec2::from_angle(side * deg.to_radians());
        let is_whole = (to - from).abs() >= 360.0 - 1e-6;
        Self { centre, radius, ends: (!is_whole).then(|| [end(from), end(to)]) }
    }

    /// How far it goes as a whole: with both its ends, or with the circle on which it lies.
    fn shift(&self, grounds: &[&Ground], centre: DVec2, tolerance: f64) -> Option<DVec2> {
        let Some(ends) = self.ends else {
            let mut alike = grounds.iter().flat_map(|g| &g.discs).filter(|d| {
                d.centre.distance(centre) <= tolerance && (d.radius - self.radius).abs() <= tolerance
            });
            let shift = alike.next()?.shift;
            return alike.all(|d| d.shift.distance(shift) <= tolerance).then_some(shift);
        };
        let [a, b] = ends.map(|end| Some(place(grounds, centre + end, tolerance)? - (centre + end)));
        (a?.distance(b?) <= tolerance).then_some(a?)
    }
}

/// Where a point goes: with the control points it lies on, else with the straight pieces it lies on, or with the crossing of
/// two of them; `None` where it lies on nothing or they do not agree.
fn place(grounds: &[&Ground], p: DVec2, tolerance: f64) -> Option<DVec2> {
    let mut nodes = grounds.iter().flat_map(|g| &g.nodes).filter(|n| n.from.distance(p) <= tolerance);
    if let Some(first) = nodes.next() {
        let shift = first.to - first.from;
        let agrees = nodes.all(|n| (n.to - n.from).distance(shift) <= tolerance);
        return agrees.then(|| first.to + (p - first.from));
    }
    let on: Vec<&Face> = grounds
        .iter()
        .flat_map(|g| &g.faces)
        .filter(|f| distance_to_segment(p, f.from) <= tolerance)
        .collect();
    let first = on.first()?;
    if let Some(to) = first.carried(p, tolerance)
        && on.iter().all(|f| f.carried(p, tolerance).is_some_and(|q| q.distance(to) <= tolerance))
    {
        return Some(to);
    }
    let other = on.iter().find(|f| first.crosses(f))?;
    let to = crossing(first.to, other.to)?;
    on.iter().all(|f| distance_to_line(to, f.to) <= tolerance).then_some(to)
}

/// -1 where the record's plane is turned over; `None` where it is tilted or cannot be read.
fn side_of(tokens: &Tokens<'_>, record: usize) -> Option<f64> {
    let fields = Fields::of(tokens, record);
    let value = |code: i32, or: f64| fields.pair(code).map_or(Some(or), |p| tokens.number(p));
    let extrusion = glam::DVec3::new(value(210, 0.0)?, value(220, 0.0)?, value(230, 1.0)?);
    is_upright(extrusion).then(|| extrusion.z.signum())
}

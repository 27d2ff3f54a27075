//! Partitions and columns on layers of something else: where the walls have layers of their own, and pairs of lines
//! like walls lie on the layer of the doors, or on one whose name says nothing, or columns on that of the doors.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;

use super::axes::{Drawn, Face, columns_of};
use super::choice::{Chosen, Hidden};
use super::curve::control_points;
use super::drawing::{Drawing, Entity, Shape};
use super::parallels::{Piece, nearest_parallels, pieces};
use super::roles::{Role, role_by_name};
use super::structure::{faces_of, is_of_windows_too};
use super::{box_of, own_layers};
use crate::report::{Place, Report};

/// Distances of a partition's faces, metres: leaves of doors are thinner, cupboards deeper.
const THICKNESS_M: [f64; 2] = [0.06, 0.3];

/// Shorter faces are frames and leaves, metres.
const LENGTH_MIN_M: f64 = 1.0;

/// Fewest faces of partitions on a layer.
const FACES_MIN: usize = 4;

/// A layer without a telling name is one of partitions if this share of its length is faces of some.
const PAIRED_SHARE: f64 = 0.8;

/// How far beyond the walls partitions may lie, metres.
const BEYOND_M: f64 = 1.0;

/// Those that hang together with the walls lie farther out, up to this share of the longer side of the walls' box:
/// rooms behind a front of which the walls are a part.
const BEYOND_SHARE: f64 = 1.0;

/// Lines that end nearer to another hang together with it, metres: what a frame or a finish leaves between them.
const HANGING_M: f64 = 0.15;

/// Lines whose distance is smaller are one, and ends that meet, metres.
const SAME_M: f64 = 0.005;

/// What closes the gap of a wall goes on in that wall at both ends: along the same direction, by the sine, no
/// farther beside it, beginning no farther away, metres.
const ALONG_SIN: f64 = 0.05;
const BESIDE_M: f64 = 0.35;
const NEAR_END_M: f64 = 0.15;

/// Least ground of a column, square metres: frames and jambs have less.
const COLUMN_M2: f64 = 0.04;

/// Square of a column's outline as a multiple of its ground, at most: 16 for a square, more for what is long.
const COLUMN_COMPACT: f64 = 18.0;

/// A column is alike from both sides: opposite every corner lies another, metres.
const OPPOSITE_M: f64 = 0.03;

/// Most comparisons of faces with walls; beyond them nothing is looked for.
const COMPARED_MAX: usize = 50_000_000;

/// Takes such partitions into `picked` (ascending) and says so.
pub(super) fn take(
    drawing: &Drawing,
    chosen: &mut Chosen,
    picked: &mut Vec<usize>,
    metres_per_unit: f64,
    report: &mut Report,
) {
    let walls = pieces(picked.iter().map(|i| &drawing.entities[*i]));
    let Some([lo, hi]) = box_of(walls.iter().flat_map(|p| [p.a, p.b])) else { return };
    let beyond = DVec2::splat(BEYOND_M / metres_per_unit);
    let widest = beyond.max(DVec2::splat(BEYOND_SHARE * (hi - lo).max_element()));
    let boxes = [[lo - beyond, hi + beyond], [lo - widest, hi + widest]];
    let search = Search { drawing, walls: &walls, boxes, unit_m: metres_per_unit };
    for (layer, found) in search.by_layer(chosen) {
        let info = |code, text: String| report.info(code, Place::file(&drawing.file), text);
        found.say(&layer, info);
        if let Some(l) = chosen.layers.iter_mut().find(|l| l.name == layer) {
            l.why = format!("{}; {} on it are taken as walls", l.why, found.words());
            if role_by_name(&layer).0 == Role::Unknown {
                l.role = "wall";
                l.why =
                    format!("its name says nothing; {} lines on it draw partitions", found.partitions.len());
            }
        }
        picked.extend(found.partitions.iter().chain(&found.columns));
    }
    picked.sort_unstable();
    picked.dedup();
}

/// What was found on a layer, by numbers of entities, each in one list.
#[derive(Default)]
struct Found {
    partitions: Vec<usize>,
    columns: Vec<usize>,
}

impl Found {
    /// How much of what, in plain words.
    fn words(&self) -> String {
        let counts = [(self.partitions.len(), "partitions"), (self.columns.len(), "columns")];
        let some = counts.iter().filter(|(n, _)| *n > 0).map(|(n, what)| format!("{n} lines of {what}"));
        some.collect::<Vec<_>>().join(" and ")
    }

    fn say(&self, layer: &str, mut info: impl FnMut(&'static str, String)) {
        if !self.partitions.is_empty() {
            let text = format!(
                "layer {layer:?}: {} of its lines run in pairs as far apart as the faces of walls, and in no gap of a \
                 wall: partitions; taken as walls; --wall-layer overrides it",
                self.partitions.len()
            );
            info("partitions-astray", text);
        }
        if !self.columns.is_empty() {
            let text = format!(
                "layer {layer:?}: {} of its lines draw small closed outlines alike from both sides: columns; taken as \
                 walls; --wall-layer overrides it",
                self.columns.len()
            );
            info("columns-astray", text);
        }
    }
}

struct Search<'a> {
    drawing: &'a Drawing,
    walls: &'a [Piece],
    /// Where partitions may lie; where those may that hang together with the walls.
    boxes: [[DVec2; 2]; 2],
    unit_m: f64,
}

impl Search<'_> {
    fn by_layer(&self, chosen: &Chosen) -> BTreeMap<String, Found> {
        let hidden = Hidden::new(self.drawing);
        let open: BTreeSet<&str> =
            chosen.layers.iter().filter(|l| l.role == "ignored").map(|l| l.name.as_str()).collect();
        let open: BTreeSet<&str> = open.into_iter().filter(|l| may_hold(l)).collect();
        let is_open = |e: &Entity| {
            open.contains(e.layer.as_str())
                && !own_layers::is_own(&e.layer)
                && !hidden.entity(e)
                && e.insert().is_none()
        };
        let all = self.drawing.entities.iter().enumerate().filter(|(_, e)| is_open(e)).map(|(i, _)| i);
        let mut by_layer: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
        for i in self.near_or_hanging(all) {
            by_layer.entry(&self.drawing.entities[i].layer).or_default().push(i);
        }
        let found = by_layer.into_iter().map(|(layer, entities)| (layer, self.found(layer, &entities)));
        let some = found.filter(|(_, f)| !f.partitions.is_empty() || !f.columns.is_empty());
        some.map(|(layer, f)| (layer.to_string(), f)).collect()
    }

    /// Those of some entities that lie near the walls, or farther out on a layer of doors and hang together with
    /// them; ascending.
    fn near_or_hanging(&self, all: impl Iterator<Item = usize>) -> Vec<usize> {
        let is_of_doors = |i: &usize| role_by_name(&self.drawing.entities[*i].layer).0 == Role::Door;
        let (mut near, mut far): (Vec<usize>, Vec<usize>) =
            all.filter(|i| self.is_in(1, *i)).partition(|i| self.is_in(0, *i));
        far.retain(is_of_doors);
        let drawn = |i: &usize| pieces(std::iter::once(&self.drawing.entities[*i]));
        let mut far: Vec<(usize, Vec<Piece>)> = far.iter().map(|i| (*i, drawn(i))).collect();
        if far.len() * (self.walls.len() + near.len() + far.len()) > COMPARED_MAX {
            return near;
        }
        let mut grown: Vec<Piece> = self.walls.to_vec();
        grown.extend(near.iter().flat_map(drawn));
        while !grown.is_empty() {
            let hangs = |own: &[Piece]| own.iter().any(|p| grown.iter().any(|q| self.hangs_at(p, q)));
            let (hanging, rest): (Vec<_>, Vec<_>) = far.into_iter().partition(|(_, own)| hangs(own));
            far = rest;
            near.extend(hanging.iter().map(|h| h.0));
            grown = hanging.into_iter().flat_map(|h| h.1).collect();
        }
        near.sort_unstable();
        near
    }

    /// Whether one of two lines ends beside the other.
    fn hangs_at(&self, p: &Piece, q: &Piece) -> bool {
        let at = |end: DVec2, s: &Piece| {
            let d = s.b - s.a;
            let share = (end - s.a).dot(d) / d.length_squared().max(f64::MIN_POSITIVE);
            end.distance(s.a + d * share.clamp(0.0, 1.0)) * self.unit_m <= HANGING_M
        };
        at(p.a, q) || at(p.b, q) || at(q.a, p) || at(q.b, p)
    }

    fn is_in(&self, which: usize, entity: usize) -> bool {
        let [lo, hi] = self.boxes[which];
        let points = control_points(&self.drawing.entities[entity].shape);
        points.into_iter().all(|p| p.cmpge(lo).all() && p.cmple(hi).all())
    }

    /// The entities on a layer that draw partitions, all of them or those on a layer of doors, and columns there.
    fn found(&self, layer: &str, entities: &[usize]) -> Found {
        let is_of_doors = role_by_name(layer).0 == Role::Door;
        let columns = if is_of_doors { self.columns(entities) } else { Vec::new() };
        let faces = self.faces(entities);
        if faces.len() < FACES_MIN {
            return Found { columns, partitions: Vec::new() };
        }
        if !is_of_doors {
            let all: f64 = entities.iter().map(|i| length(&self.drawing.entities[*i].shape)).sum();
            let paired: f64 = faces.iter().map(Piece::length).sum();
            let partitions = if paired >= PAIRED_SHARE * all { entities.to_vec() } else { Vec::new() };
            return Found { partitions, columns };
        }
        let ends: Vec<DVec2> = faces.iter().flat_map(|f| [f.a, f.b]).collect();
        let drawn: BTreeSet<usize> = faces.iter().map(|f| entities[f.entity]).collect();
        let is_cap = |i: &usize| {
            let own = pieces(std::iter::once(&self.drawing.entities[*i]));
            let meets = |p: DVec2| ends.iter().any(|e| e.distance(p) * self.unit_m <= SAME_M);
            matches!(own[..], [p] if p.length() * self.unit_m <= THICKNESS_M[1] && meets(p.a) && meets(p.b))
        };
        let is_taken = |i: &usize| (drawn.contains(i) || is_cap(i)) && !columns.contains(i);
        Found { partitions: entities.iter().copied().filter(is_taken).collect(), columns }
    }

    /// The entities that draw small compact outlines, each alike from both sides.
    fn columns(&self, entities: &[usize]) -> Vec<usize> {
        let origin = self.boxes[0][0];
        let place = |p: DVec2| (p - origin) * self.unit_m;
        let shapes = entities.iter().map(|i| &self.drawing.entities[*i].shape).enumerate();
        let straight = shapes.filter(|(_, s)| !matches!(s, Shape::Circle { .. }));
        let faces: Vec<Face> = straight.flat_map(|(k, s)| faces_of(s, k as u32, place)).collect();
        let rings = columns_of(&Drawn { faces, marks: Vec::new() });
        let found: BTreeSet<usize> = rings
            .iter()
            .filter(|(ring, _)| is_column(ring))
            .flat_map(|(_, faces)| faces.iter().map(|f| entities[f.0 as usize]))
            .collect();
        found.into_iter().collect()
    }

    /// Long pieces beside another at a wall's distance that fill no gap of a wall; [`Piece::entity`] is a place in
    /// `entities`.
    fn faces(&self, entities: &[usize]) -> Vec<Piece> {
        let all = pieces(entities.iter().map(|i| &self.drawing.entities[*i]));
        let long: Vec<Piece> = all.into_iter().filter(|p| p.length() * self.unit_m >= LENGTH_MIN_M).collect();
        if long.len() * self.walls.len() > COMPARED_MAX {
            return Vec::new();
        }
        let [least, most] = THICKNESS_M;
        let beside = nearest_parallels(&long, SAME_M / self.unit_m);
        let is_face = |d: &Option<f64>| d.is_some_and(|d| (least..=most).contains(&(d * self.unit_m)));
        let faces = long.iter().zip(&beside).filter(|(_, d)| is_face(d)).map(|(p, _)| *p);
        faces.filter(|p| !self.fills_gap(p)).collect()
    }

    fn fills_gap(&self, p: &Piece) -> bool {
        self.goes_on(p.a, p.a - p.b) && self.goes_on(p.b, p.b - p.a)
    }

    /// Whether a wall begins near an end and goes on in its direction.
    fn goes_on(&self, end: DVec2, out: DVec2) -> bool {
        let out = out.normalize_or_zero();
        self.walls.iter().any(|w| {
            let [a, b] = [w.a, w.b].map(|q| (q - end) * self.unit_m);
            let (from, to) = (a.dot(out).min(b.dot(out)), a.dot(out).max(b.dot(out)));
            (b - a).normalize_or_zero().perp_dot(out).abs() <= ALONG_SIN
                && from.abs() <= NEAR_END_M
                && to > NEAR_END_M
                && [a, b].iter().all(|q| out.perp_dot(*q).abs() <= BESIDE_M)
        })
    }
}

/// Whether partitions are looked for on a layer: one of doors alone, or one whose name says nothing.
fn may_hold(layer: &str) -> bool {
    match role_by_name(layer).0 {
        Role::Door => !is_of_windows_too(layer),
        role => role == Role::Unknown,
    }
}

/// Whether an outline, in metres, is that of a column and of no leaf, frame or sector of a swing.
pub(super) fn is_column(ring: &[DVec2]) -> bool {
    let sides = || (0..ring.len()).map(|i| [ring[i], ring[(i + 1) % ring.len()]]);
    let length: f64 = sides().map(|[a, b]| a.distance(b)).sum();
    let ground = sides().map(|[a, b]| (a - ring[0]).perp_dot(b - ring[0]) / 2.0).sum::<f64>().abs();
    let Some([lo, hi]) = box_of(ring.iter().copied()) else { return false };
    let opposite = |p: &DVec2| lo + hi - *p;
    ground >= COLUMN_M2
        && length * length <= COLUMN_COMPACT * ground
        && ring.iter().all(|p| ring.iter().any(|q| q.distance(opposite(p)) <= OPPOSITE_M))
}

/// Length of what is drawn, drawing units.
fn length(shape: &Shape) -> f64 {
    match shape {
        Shape::Arc { radius, start_rad, end_rad, .. } => {
            radius * (end_rad - start_rad).rem_euclid(std::f64::consts::TAU)
        }
        Shape::Circle { radius, .. } => radius * std::f64::consts::TAU,
        Shape::Line { a, b } => a.distance(*b),
        Shape::Polyline { .. } => control_points(shape).windows(2).map(|w| w[0].distance(w[1])).sum(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan::drawing::{Editable, SourceRef};

    fn line(i: usize) -> Entity {
        let at = |y: f64| DVec2::new(i as f64 * 0.2, y);
        Entity {
            source: SourceRef {
                record: i,
                handle: None,
                line: 0,
                kind: "LINE".into(),
                layer: "Doors".into(),
            },
            layer: "Doors".into(),
            shape: Shape::Line { a: at(0.0), b: at(4.0) },
            editable: Editable::Free,
            blocks: Vec::new(),
            origin: Default::default(),
        }
    }

    /// Comparisons grow with the square of what is drawn: beyond the limit nothing is looked for, and nothing waits.
    #[test]
    fn more_comparisons_than_the_limit_are_not_made() {
        let most = (1..).take_while(|n| n * (n + 1) <= COMPARED_MAX).last().unwrap();
        let wall = |y: f64| Piece { a: DVec2::new(0.0, y), b: DVec2::new(1e4, y), entity: 0 };
        let near_none = [DVec2::splat(-2.0), DVec2::splat(-1.0)];
        let all = [DVec2::splat(-1e5), DVec2::splat(1e5)];
        for (count, is_looked_at) in [(most, true), (most + 1, false)] {
            let drawing = Drawing::of((0..count).map(line).collect());
            let walls = [wall(0.0)];
            let search = Search { drawing: &drawing, walls: &walls, boxes: [near_none, all], unit_m: 1.0 };
            assert_eq!(search.near_or_hanging(0..count).len(), if is_looked_at { count } else { 0 });
        }
        let drawing = Drawing::of((0..100).map(line).collect());
        let entities: Vec<usize> = (0..100).collect();
        for (count, is_looked_at) in [(COMPARED_MAX / 100, true), (COMPARED_MAX / 100 + 1, false)] {
            let walls = vec![wall(-9.0); count];
            let search = Search { drawing: &drawing, walls: &walls, boxes: [all, all], unit_m: 1.0 };
            assert_eq!(search.faces(&entities).len(), if is_looked_at { 100 } else { 0 });
        }
    }
}

//! Partitions on layers of something else: where the walls have layers of their own, and pairs of lines like walls
//! lie on the layer of the doors, or on one whose name says nothing.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;

use super::choice::{Chosen, Hidden};
use super::curve::control_points;
use super::drawing::{Drawing, Entity, Shape};
use super::parallels::{Piece, nearest_parallels, pieces};
use super::roles::{Role, role_by_name};
use super::structure::is_of_windows_too;
use super::{box_of, layers};
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

/// Lines whose distance is smaller are one, and ends that meet, metres.
const SAME_M: f64 = 0.005;

/// What closes the gap of a wall goes on in that wall at both ends: along the same direction, by the sine, no
/// farther beside it, beginning no farther away, metres.
const ALONG_SIN: f64 = 0.05;
const BESIDE_M: f64 = 0.35;
const NEAR_END_M: f64 = 0.15;

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
    let search = Search { drawing, walls: &walls, box_: [lo - beyond, hi + beyond], unit_m: metres_per_unit };
    let taken = search.by_layer(chosen);
    for (layer, found) in taken {
        let text = format!(
            "layer {layer:?}: {} of its lines run in pairs as far apart as the faces of walls, and in no gap of a wall: \
             partitions; taken as walls; --wall-layer overrides it",
            found.len()
        );
        report.info("partitions-astray", Place::file(&drawing.file), text);
        if let Some(l) = chosen.layers.iter_mut().find(|l| l.name == layer) {
            l.why = format!("{}; {} lines of partitions on it are taken as walls", l.why, found.len());
            if role_by_name(&layer).0 == Role::Unknown {
                l.role = "wall";
                l.why = format!("its name says nothing; {} lines on it draw partitions", found.len());
            }
        }
        picked.extend(found);
    }
    picked.sort_unstable();
    picked.dedup();
}

struct Search<'a> {
    drawing: &'a Drawing,
    walls: &'a [Piece],
    box_: [DVec2; 2],
    unit_m: f64,
}

impl Search<'_> {
    fn by_layer(&self, chosen: &Chosen) -> BTreeMap<String, Vec<usize>> {
        let hidden = Hidden::new(self.drawing);
        let open: BTreeSet<&str> =
            chosen.layers.iter().filter(|l| l.role == "ignored").map(|l| l.name.as_str()).collect();
        let mut by_layer: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
        for (i, e) in self.drawing.entities.iter().enumerate() {
            let is_open = open.contains(e.layer.as_str()) && !layers::is_own(&e.layer) && !hidden.entity(e);
            if is_open && e.blocks.is_empty() && self.is_near(e) {
                by_layer.entry(&e.layer).or_default().push(i);
            }
        }
        let found = by_layer.into_iter().map(|(layer, entities)| (layer, self.partitions(layer, &entities)));
        found.filter(|(_, f)| !f.is_empty()).map(|(layer, f)| (layer.to_string(), f)).collect()
    }

    fn is_near(&self, e: &Entity) -> bool {
        let [lo, hi] = self.box_;
        control_points(&e.shape).into_iter().all(|p| p.cmpge(lo).all() && p.cmple(hi).all())
    }

    /// The entities on a layer that draw partitions: all of them, or those on a layer of doors.
    fn partitions(&self, layer: &str, entities: &[usize]) -> Vec<usize> {
        let role = role_by_name(layer).0;
        let is_of_doors = role == Role::Door && !is_of_windows_too(layer);
        if !is_of_doors && role != Role::Unknown {
            return Vec::new();
        }
        let faces = self.faces(entities);
        if faces.len() < FACES_MIN {
            return Vec::new();
        }
        if !is_of_doors {
            let all: f64 = entities.iter().map(|i| length(&self.drawing.entities[*i].shape)).sum();
            let paired: f64 = faces.iter().map(Piece::length).sum();
            return if paired >= PAIRED_SHARE * all { entities.to_vec() } else { Vec::new() };
        }
        let ends: Vec<DVec2> = faces.iter().flat_map(|f| [f.a, f.b]).collect();
        let drawn: BTreeSet<usize> = faces.iter().map(|f| entities[f.entity]).collect();
        let is_cap = |i: &usize| {
            let own = pieces(std::iter::once(&self.drawing.entities[*i]));
            let meets = |p: DVec2| ends.iter().any(|e| e.distance(p) * self.unit_m <= SAME_M);
            matches!(own[..], [p] if p.length() * self.unit_m <= THICKNESS_M[1] && meets(p.a) && meets(p.b))
        };
        entities.iter().copied().filter(|i| drawn.contains(i) || is_cap(i)).collect()
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

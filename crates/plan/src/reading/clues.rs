//! What a drawing shows that has a known size in metres: doors, walls, the building, letters, what is written.
//!
//! Everything is in drawing units: a clue says how long something is drawn, [`super::unit`] what that makes likely.

use std::collections::BTreeMap;

use glam::DVec2;

use super::lengths::{Length, area_m2, is_imperial, length, printed_scale};
use super::scene::chord_arc;
use crate::parallels::{Piece, parallels, pieces};
use enfilade_cad::curve::{bulge_arc, sweep_rad};
use enfilade_cad::drawing::{Drawing, Entity, Shape};
use enfilade_cad::plane::box_of;

/// How many lines to either side of a face are looked at: a finish, the core, the other finish.
const LINES_OF_WALL: usize = 3;

/// A swing sweeps about a quarter turn.
const SWING_RAD: [f64; 2] = [1.0, 1.75];

/// How near a leaf's length and foot are to radius and centre, as a share of the radius.
const LEAF_SLACK: f64 = 0.12;

/// Radii nearer than this share are those of one kind of door.
const SAME_RADIUS: f64 = 0.03;

/// Cells along a sheet in which its drawings are told apart before the unit is known: a plan's rooms hang together in
/// them, its neighbours stand farther off.
const SHEET_CELLS: f64 = 96.0;

/// Most rooms with a written area that are looked at: each looks at every line.
const ROOMS_MAX: usize = 60;

/// Most closed lines that a text is asked to lie in.
const RINGS_MAX: usize = 4_000;

/// A door's arc and whether its leaf is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Swing {
    /// Radius, drawing units.
    pub radius: f64,
    /// Whether a straight piece as long runs from its centre to the arc.
    pub has_leaf: bool,
}

/// A face and the lines beside it, drawing units.
#[derive(Clone, Debug, PartialEq)]
pub struct Gap {
    /// Distance of the nearest parallel line.
    pub nearest: f64,
    /// Those of the next ones, of which one may be the wall's other face.
    pub beyond: Vec<f64>,
    /// How long the face is.
    pub length: f64,
}

/// A dimension with its text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stated {
    /// What it measures, drawing units.
    pub measured: f64,
    /// What is written.
    pub written: Length,
}

/// A room whose area is written in it.
#[derive(Clone, Debug, PartialEq)]
pub struct Room {
    /// As written, square metres.
    pub area_m2: f64,
    /// Width by height of the free space round the text, square drawing units; `None` where a side is open.
    pub round_text: Option<f64>,
    /// Areas of the closed lines round the text, square drawing units.
    pub rings: Vec<f64>,
}

/// What a drawing shows. See the module page.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Clues {
    /// Arcs that may be door swings, one of every radius, with how many there are.
    pub swings: Vec<(Swing, usize)>,
    /// Faces of walls with the lines beside them.
    pub gaps: Vec<Gap>,
    /// Share of the walls' length that has a second face.
    pub paired_share: f64,
    /// Share of the walls' box that lies between neighbouring faces.
    pub between_share: f64,
    /// Longer side of the box round all walls.
    pub extent: f64,
    /// Longer side of the largest drawing of the sheet.
    pub largest: f64,
    /// Dimensions of which the text states a length.
    pub stated: Vec<Stated>,
    /// Rooms with a written area.
    pub rooms: Vec<Room>,
    /// Middle height of letters, where there are texts.
    pub letters: Option<f64>,
    /// How many texts state feet or inches.
    pub imperial: usize,
    /// Scales that its texts say it is printed at, each once, ascending: metres for one on paper.
    pub scales: Vec<f64>,
}

impl Clues {
    /// Looks at the lines taken for walls, and at the whole drawing for everything else.
    pub fn new(drawing: &Drawing, walls: &[&Entity]) -> Self {
        let found = pieces(walls.iter().copied());
        let bounds = box_of(found.iter().flat_map(|p| [p.a, p.b]));
        let extent = bounds.map_or(0.0, |[lo, hi]| (hi - lo).max_element());
        let (gaps, paired_share) = gaps(&found, extent);
        let ground = bounds.map_or(0.0, |[lo, hi]| (hi - lo).element_product());
        let between = gaps.iter().map(|g| g.nearest * g.length).sum::<f64>() / 2.0;
        let texts = drawing.texts.iter().map(|t| t.text.as_str());
        let dimensions = &drawing.written.dimensions;
        let stated = dimensions
            .iter()
            .filter_map(|d| length(&d.text).map(|written| Stated { measured: d.measured, written }));
        Self {
            swings: swings(drawing),
            paired_share,
            between_share: if ground > 0.0 { between / ground } else { 0.0 },
            extent,
            largest: bounds.map_or(0.0, |b| largest(&found, b)),
            stated: stated.collect(),
            rooms: rooms(drawing, &found),
            letters: middle(drawing.written.heights.clone()),
            imperial: texts
                .chain(dimensions.iter().map(|d| d.text.as_str()))
                .filter(|t| is_imperial(t))
                .count(),
            scales: printed_scales(drawing),
            gaps,
        }
    }

    /// The middle distance of faces, weighted by length; drawing units.
    pub fn middle_gap(&self) -> Option<f64> {
        let mut by_length: Vec<(f64, f64)> = self.gaps.iter().map(|g| (g.nearest, g.length)).collect();
        by_length.sort_by(|a, b| a.0.total_cmp(&b.0));
        let half = by_length.iter().map(|g| g.1).sum::<f64>() / 2.0;
        let mut sum = 0.0;
        let middle = by_length.iter().find(|g| {
            sum += g.1;
            sum >= half
        });
        middle.map(|g| g.0)
    }

    /// Radii of the swings with a leaf, as often as they are drawn, ascending.
    pub fn leaves(&self) -> Vec<f64> {
        let with_leaf = self.swings.iter().filter(|(s, _)| s.has_leaf);
        let mut out: Vec<f64> = with_leaf.flat_map(|(s, n)| std::iter::repeat_n(s.radius, *n)).collect();
        out.sort_by(f64::total_cmp);
        out
    }
}

fn printed_scales(drawing: &Drawing) -> Vec<f64> {
    let mut out: Vec<f64> = drawing.texts.iter().filter_map(|t| printed_scale(&t.text)).collect();
    out.sort_by(f64::total_cmp);
    out.dedup();
    out
}

fn middle(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied()
}

/// Faces longer than the distance to the line beside them, and their share of all length.
fn gaps(found: &[Piece], extent: f64) -> (Vec<Gap>, f64) {
    let total: f64 = found.iter().map(Piece::length).sum();
    let of = |(piece, mut lines): (&Piece, Vec<f64>)| {
        lines.sort_by(f64::total_cmp);
        let nearest = *lines.first().filter(|d| piece.length() > **d)?;
        Some(Gap { nearest, beyond: lines.split_off(1), length: piece.length() })
    };
    let out: Vec<Gap> =
        found.iter().zip(parallels(found, extent * 1e-6, LINES_OF_WALL)).filter_map(of).collect();
    let paired: f64 = out.iter().map(|g| g.length).sum();
    (out, if total > 0.0 { paired / total } else { 0.0 })
}

/// Longer side of the box of what hangs together in coarse cells and has the most pieces.
fn largest(found: &[Piece], [lo, hi]: [DVec2; 2]) -> f64 {
    let cell = (hi - lo).max_element() / SHEET_CELLS;
    if cell <= 0.0 {
        return 0.0;
    }
    let at = |p: DVec2| ((p - lo) / cell).floor().as_i64vec2().to_array();
    let mut cells: BTreeMap<[i64; 2], [DVec2; 2]> = BTreeMap::new();
    let mut counts: BTreeMap<[i64; 2], usize> = BTreeMap::new();
    for p in found {
        *counts.entry(at(p.a.midpoint(p.b))).or_default() += 1;
        let steps = (p.length() / cell * 2.0).ceil().max(1.0) as usize;
        for q in (0..=steps).map(|i| p.a.lerp(p.b, i as f64 / steps as f64)) {
            let own = cells.entry(at(q)).or_insert([q, q]);
            *own = [own[0].min(q), own[1].max(q)];
        }
    }
    let mut best = (0, 0.0);
    while let Some((start, first)) = cells.pop_first() {
        let (mut stack, mut extent, mut count) = (vec![start], first, 0);
        while let Some([x, y]) = stack.pop() {
            count += counts.get(&[x, y]).copied().unwrap_or(0);
            for next in (-1..=1).flat_map(|i| (-1..=1).map(move |j| [x + i, y + j])) {
                if let Some(more) = cells.remove(&next) {
                    extent = [extent[0].min(more[0]), extent[1].max(more[1])];
                    stack.push(next);
                }
            }
        }
        if count > best.0 {
            best = (count, (extent[1] - extent[0]).max_element());
        }
    }
    best.1
}

/// The rooms in which an area is written.
fn rooms(drawing: &Drawing, walls: &[Piece]) -> Vec<Room> {
    let written = drawing.texts.iter().filter_map(|t| Some((t.at, area_m2(&t.text)?)));
    let written: Vec<(DVec2, f64)> = written.take(ROOMS_MAX).collect();
    if written.is_empty() {
        return Vec::new();
    }
    let rings: Vec<Vec<DVec2>> = drawing.entities.iter().filter_map(ring).take(RINGS_MAX).collect();
    let of = |(at, area_m2): (DVec2, f64)| {
        let round = rings.iter().filter(|r| enfilade_cad::plane::is_inside_ring(r, at));
        Room { area_m2, round_text: free_round(walls, at), rings: round.map(|r| ring_area(r)).collect() }
    };
    written.into_iter().map(of).collect()
}

/// The corners of a closed line.
fn ring(e: &Entity) -> Option<Vec<DVec2>> {
    let Shape::Polyline { vertices, closed } = &e.shape else { return None };
    let mut out: Vec<DVec2> = vertices.iter().map(|v| v.at).collect();
    let returns = out.len() > 3 && out.first() == out.last();
    if returns {
        out.pop();
    }
    (out.len() > 2 && (*closed || returns)).then_some(out)
}

fn ring_area(ring: &[DVec2]) -> f64 {
    let twice = (0..ring.len()).map(|i| ring[i].perp_dot(ring[(i + 1) % ring.len()]));
    (twice.sum::<f64>() / 2.0).abs()
}

/// Width by height of the free space between walls round a point.
fn free_round(walls: &[Piece], at: DVec2) -> Option<f64> {
    let mut free = [f64::INFINITY; 4];
    for p in walls {
        for k in 0..2 {
            let (a, b) = (p.a[k] - at[k], p.b[k] - at[k]);
            if (a > 0.0) != (b > 0.0) {
                let across = p.a[1 - k] + (p.b[1 - k] - p.a[1 - k]) * a / (a - b) - at[1 - k];
                let side = &mut free[2 * k + usize::from(across > 0.0)];
                *side = side.min(across.abs());
            }
        }
    }
    let area = (free[0] + free[1]) * (free[2] + free[3]);
    (area.is_finite() && area > 0.0).then_some(area)
}

/// Arcs that sweep about a quarter turn, one of every radius.
fn swings(drawing: &Drawing) -> Vec<(Swing, usize)> {
    let arcs: Vec<(DVec2, f64)> = drawing.entities.iter().flat_map(arcs_of).collect();
    if arcs.is_empty() {
        return Vec::new();
    }
    // Pieces by their length in steps of 5 %, so that an arc looks only at those as long as it is wide.
    let step = |length: f64| (length.ln() / 0.05).floor() as i64;
    let radii: std::collections::BTreeSet<i64> =
        arcs.iter().flat_map(|a| (-3..=3).map(|k| step(a.1) + k)).collect();
    let mut by_length: BTreeMap<i64, Vec<Piece>> = BTreeMap::new();
    for piece in pieces(drawing.entities.iter()) {
        let length = piece.length();
        if length > 0.0 && radii.contains(&step(length)) {
            by_length.entry(step(length)).or_default().push(piece);
        }
    }
    let has_leaf = |centre: DVec2, radius: f64| {
        let slack = LEAF_SLACK * radius;
        let near = (-3..=3).filter_map(|k| by_length.get(&(step(radius) + k))).flatten();
        let mut leaves = near.filter(|p| (p.length() - radius).abs() <= slack);
        leaves.any(|p| p.a.distance(centre) <= slack || p.b.distance(centre) <= slack)
    };
    let mut out: BTreeMap<(i64, bool), (Swing, usize)> = BTreeMap::new();
    for (centre, radius) in arcs {
        let has_leaf = has_leaf(centre, radius);
        let key = ((radius.ln() / SAME_RADIUS).round() as i64, has_leaf);
        out.entry(key).or_insert((Swing { radius, has_leaf }, 0)).1 += 1;
    }
    out.into_values().collect()
}

/// Centres and radii of an entity's arcs that may be swings.
fn arcs_of(e: &Entity) -> Vec<(DVec2, f64)> {
    let is_swing = |sweep: f64| (SWING_RAD[0]..=SWING_RAD[1]).contains(&sweep.abs());
    match &e.shape {
        Shape::Arc { centre, radius, start_rad, end_rad } if is_swing(sweep_rad(*start_rad, *end_rad)) => {
            vec![(*centre, *radius)]
        }
        Shape::Polyline { vertices, closed } => {
            let arcs = vertices.windows(2).filter_map(|v| bulge_arc(v[0].at, v[1].at, v[0].bulge));
            if vertices.iter().any(|v| v.bulge != 0.0) {
                return arcs
                    .filter(|arc| is_swing(arc.3))
                    .map(|(centre, radius, ..)| (centre, radius))
                    .collect();
            }
            let again = vertices.first().filter(|_| *closed);
            let corners: Vec<DVec2> = vertices.iter().chain(again).map(|v| v.at).collect();
            let chords = chord_arc(&corners, *closed).filter(|arc| is_swing(arc.sweep_rad));
            chords.map(|arc| (arc.centre, arc.radius)).into_iter().collect()
        }
        _ => Vec::new(),
    }
}

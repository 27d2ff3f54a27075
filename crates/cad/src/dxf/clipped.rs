//! Shapes cut at a boundary.

use std::f64::consts::TAU;

use glam::DVec2;

use super::clip::Clip;
use crate::curve::{bulge_arc, control_points, sweep_rad};
use crate::drawing::{Shape, Vertex};
use crate::region::{Region, Rule};

/// The share of a piece below which it only touches what is shown.
const TOUCH: f64 = 1e-9;

/// What of a shape is shown.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Seen {
    /// All of it.
    Whole,
    /// These parts; none at all where the list is empty.
    Parts(Vec<Shape>),
}

/// A piece of a shape, from 0 at its start to 1 at its end.
#[derive(Clone, Copy)]
enum Piece {
    Straight([DVec2; 2]),
    Round { centre: DVec2, radius: f64, start_rad: f64, sweep_rad: f64 },
}

/// What a clip shows of a drawn shape.
pub(super) fn seen(clip: &Clip, shape: &Shape) -> Seen {
    match shape {
        Shape::Line { a, b } => {
            let piece = Piece::Straight([*a, *b]);
            of_ranges(&piece.shown(clip), |[s, t]| Shape::Line { a: piece.at(s), b: piece.at(t) })
        }
        Shape::Arc { centre, radius, start_rad, end_rad } => {
            round(clip, *centre, *radius, [*start_rad, sweep_rad(*start_rad, *end_rad)])
        }
        Shape::Circle { centre, radius } => round(clip, *centre, *radius, [0.0, TAU]),
        Shape::Polyline { vertices, closed } => polyline(clip, vertices, *closed),
    }
}

/// What a clip shows of a filled area, bulges taken as straight where it is cut.
pub(super) fn seen_of_fill(clip: &Clip, shape: &Shape) -> Seen {
    let is_round = matches!(shape, Shape::Circle { .. } | Shape::Arc { .. });
    let corners = control_points(shape);
    let encloses = |p: &DVec2| crate::plane::is_inside_ring(&corners, *p);
    // A boundary within an area crosses none of its sides.
    let is_whole = seen(clip, shape) == Seen::Whole && (is_round || !clip.ring.iter().any(encloses));
    if is_whole {
        return Seen::Whole;
    }
    if is_round {
        return Seen::Parts(Vec::new());
    }
    let region = |points: &[DVec2]| Region::ring(points.iter().map(DVec2::to_array).collect());
    let rule = if clip.is_inverted { Rule::Difference } else { Rule::Intersection };
    let cut = region(&corners).combine(&region(&clip.ring), rule);
    let outer = cut.shapes.into_iter().filter_map(|rings| rings.into_iter().next());
    let closed = |ring: Vec<[f64; 2]>| {
        let vertices = ring.into_iter().map(|p| Vertex { at: DVec2::from(p), bulge: 0.0 }).collect();
        Shape::Polyline { vertices, closed: true }
    };
    Seen::Parts(outer.map(closed).collect())
}

fn of_ranges(ranges: &[[f64; 2]], part: impl Fn([f64; 2]) -> Shape) -> Seen {
    match ranges {
        [[0.0, 1.0]] => Seen::Whole,
        _ => Seen::Parts(ranges.iter().map(|range| part(*range)).collect()),
    }
}

fn round(clip: &Clip, centre: DVec2, radius: f64, [start_rad, sweep_rad]: [f64; 2]) -> Seen {
    let piece = Piece::Round { centre, radius, start_rad, sweep_rad };
    of_ranges(&piece.shown(clip), |[s, t]| {
        let angle = |t: f64| start_rad + t * sweep_rad;
        Shape::Arc { centre, radius, start_rad: angle(s), end_rad: angle(t) }
    })
}

fn polyline(clip: &Clip, vertices: &[Vertex], is_closed: bool) -> Seen {
    let next = vertices.iter().skip(1).chain(vertices.first().filter(|_| is_closed && vertices.len() > 1));
    let pieces: Vec<(Piece, f64)> =
        vertices.iter().zip(next).map(|(v, w)| (Piece::between(v, w.at), v.bulge)).collect();
    let shown: Vec<Vec<[f64; 2]>> = pieces.iter().map(|(piece, _)| piece.shown(clip)).collect();
    let is_whole = match vertices {
        [only] => clip.shows(only.at),
        _ => shown.iter().all(|ranges| ranges[..] == [[0.0, 1.0]]),
    };
    if is_whole {
        return Seen::Whole;
    }
    let mut chains: Vec<Vec<Vertex>> = Vec::new();
    let mut goes_on = false;
    for ((piece, bulge), ranges) in pieces.iter().zip(&shown) {
        for &[s, t] in ranges {
            let ends = [(s, part_of_bulge(*bulge, t - s)), (t, 0.0)];
            let [start, end] = ends.map(|(t, bulge)| Vertex { at: piece.at(t), bulge });
            match chains.last_mut().filter(|_| goes_on && s == 0.0) {
                Some(chain) => {
                    chain.pop();
                    chain.extend([start, end]);
                }
                None => chains.push(vec![start, end]),
            }
            goes_on = t == 1.0;
        }
        goes_on &= !ranges.is_empty();
    }
    let begins = shown.first().and_then(|r| r.first()).is_some_and(|r| r[0] == 0.0);
    if is_closed && goes_on && begins && chains.len() > 1 {
        let first = chains.remove(0);
        if let Some(last) = chains.last_mut() {
            last.pop();
            last.extend(first);
        }
    }
    Seen::Parts(chains.into_iter().map(|vertices| Shape::Polyline { vertices, closed: false }).collect())
}

/// The bulge of a share of a bulged piece.
fn part_of_bulge(bulge: f64, share: f64) -> f64 {
    if share == 1.0 { bulge } else { (bulge.atan() * share).tan() }
}

impl Piece {
    fn between(v: &Vertex, end: DVec2) -> Self {
        match bulge_arc(v.at, end, v.bulge) {
            Some((centre, radius, start_rad, sweep_rad)) => {
                Self::Round { centre, radius, start_rad, sweep_rad }
            }
            None => Self::Straight([v.at, end]),
        }
    }

    fn at(&self, t: f64) -> DVec2 {
        match *self {
            // The ends exactly, so that a part that reaches one ends where the piece does.
            Self::Straight([_, b]) if t == 1.0 => b,
            Self::Straight([a, b]) => a + (b - a) * t,
            Self::Round { centre, radius, start_rad, sweep_rad } => {
                centre + radius * DVec2::from_angle(start_rad + t * sweep_rad)
            }
        }
    }

    /// The stretches of it that a clip shows, ascending; those that touch are one.
    fn shown(&self, clip: &Clip) -> Vec<[f64; 2]> {
        let mut cuts: Vec<f64> = clip.sides().flat_map(|side| self.crossings(side)).collect();
        cuts.retain(|t| *t > 0.0 && *t < 1.0);
        cuts.extend([0.0, 1.0]);
        cuts.sort_by(f64::total_cmp);
        cuts.dedup();
        let mut out: Vec<[f64; 2]> = Vec::new();
        for w in cuts.windows(2).filter(|w| clip.shows(self.at(w[0].midpoint(w[1])))) {
            match out.last_mut().filter(|last| last[1] == w[0]) {
                Some(last) => last[1] = w[1],
                None => out.push([w[0], w[1]]),
            }
        }
        out.retain(|[s, t]| t - s > TOUCH);
        out
    }

    /// Where it meets a segment.
    fn crossings(&self, [p, q]: [DVec2; 2]) -> Vec<f64> {
        let along = q - p;
        match *self {
            Self::Straight([a, b]) => {
                let (own, across) = (b - a, (b - a).perp_dot(along));
                // Along one line the ends of the segment part what is shown from what is not.
                if across == 0.0 {
                    return [p, q].map(|end| (end - a).dot(own) / own.length_squared()).to_vec();
                }
                let u = (p - a).perp_dot(own) / across;
                let t = (p - a).perp_dot(along) / across;
                if (0.0..=1.0).contains(&u) { vec![t] } else { Vec::new() }
            }
            Self::Round { centre, radius, start_rad, sweep_rad } => {
                let (from, length) = (p - centre, along.length_squared());
                let half = from.dot(along) / length;
                let under = half * half - (from.length_squared() - radius * radius) / length;
                if under.is_nan() || under < 0.0 {
                    return Vec::new();
                }
                let both = [-half - under.sqrt(), -half + under.sqrt()];
                let on = both.into_iter().filter(|u| (0.0..=1.0).contains(u)).map(|u| from + along * u);
                let turned = |at: DVec2| {
                    let turn = (at.to_angle() - start_rad) * sweep_rad.signum();
                    turn.rem_euclid(TAU) / sweep_rad.abs()
                };
                on.map(turned).collect()
            }
        }
    }
}

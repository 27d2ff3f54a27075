//! Walls cut by the ground of a decided work.

use glam::DVec2;

use super::Scale;
use crate::Wall;
use crate::curve::{self, Trace};
use crate::frame::Frame;
use enfilade_cad::drawing::{Editable, Shape, Vertex};
use enfilade_cad::plane::is_inside_ring;
use enfilade_cad::rings;

/// Faces of one wall are at most this far apart, metres of a person: its end is closed between them.
const FACES_APART_M: f64 = 0.6;

/// Pieces shorter than this are rounding, metres.
const PIECE_MIN_M: f64 = 1e-6;

/// How far beyond the faces of a wall the ground of an opening reaches, as a share of what it opens across.
const BEYOND_SHARE: f64 = 0.5;

/// The stretch of wall that an outline opens.
pub(super) struct Stretch {
    /// Ground of the opening: a rectangle along the wall.
    pub ground: Vec<DVec2>,
    /// Middles of its two sides.
    pub jambs: [DVec2; 2],
}

/// What was cut away.
#[derive(Default)]
pub(super) struct Gone {
    /// Pieces of wall.
    pub pieces: Vec<Trace>,
    /// Whether the ground lies inside a wall without reaching through.
    pub is_inside: bool,
}

/// The pieces of a wall, drawing units; corners as they are drawn, to the last digit.
fn pieces(wall: &Wall, frame: &Frame) -> Vec<[DVec2; 2]> {
    let exact = |shape: &Shape| match shape {
        Shape::Line { a, b } => Some(vec![*a, *b]),
        Shape::Polyline { vertices, .. } if vertices.iter().all(|v| v.bulge == 0.0) => {
            Some(vertices.iter().map(|v| v.at).collect())
        }
        _ => None,
    };
    let traced = || wall.trace.points.iter().map(|p| frame.file_from_um(*p)).collect();
    let points: Vec<DVec2> = exact(&wall.shape).unwrap_or_else(traced);
    let n = points.len();
    let count = if wall.trace.is_closed { n } else { n.saturating_sub(1) };
    (0..count).map(|i| [points[i], points[(i + 1) % n]]).collect()
}

/// The parts of a piece outside a ring and inside it, as shares of its length.
fn parts([a, b]: [DVec2; 2], ring: &[DVec2]) -> Vec<(bool, [f64; 2])> {
    let d = b - a;
    let mut at = vec![0.0, 1.0];
    for (i, p) in ring.iter().enumerate() {
        let e = ring[(i + 1) % ring.len()] - *p;
        let cross = d.perp_dot(e);
        if cross == 0.0 {
            continue;
        }
        let (s, t) = ((*p - a).perp_dot(e) / cross, (*p - a).perp_dot(d) / cross);
        if (0.0..=1.0).contains(&t) && s > 0.0 && s < 1.0 {
            at.push(s);
        }
    }
    at.sort_by(f64::total_cmp);
    let spans = at.windows(2).filter(|w| w[1] > w[0]).map(|w| {
        let is_inside = is_inside_ring(ring, a + d * (w[0] + w[1]) / 2.0);
        (is_inside, [w[0], w[1]])
    });
    spans.fold(Vec::new(), |mut out: Vec<(bool, [f64; 2])>, (is_inside, span)| {
        match out.last_mut() {
            Some((last, before)) if *last == is_inside => before[1] = span[1],
            _ => out.push((is_inside, span)),
        }
        out
    })
}

/// The stretch of the wall under an outline: along the longest piece of wall in it, as long as the pieces of that wall
/// are in it, or as wide as is said, in the middle. `width` in drawing units.
pub(super) fn stretch(
    walls: &[Wall],
    outline: &[DVec2],
    width: Option<f64>,
    frame: &Frame,
) -> Option<Stretch> {
    let all = walls.iter().flat_map(|w| pieces(w, frame));
    let inside: Vec<[DVec2; 2]> = all
        .flat_map(|piece| {
            let [a, b] = piece;
            let of = parts(piece, outline).into_iter().filter(|p| p.0);
            of.map(move |(_, [s, t])| [a.lerp(b, s), a.lerp(b, t)]).collect::<Vec<_>>()
        })
        .collect();
    let longest = inside.iter().max_by(|p, q| p[0].distance(p[1]).total_cmp(&q[0].distance(q[1])))?;
    let along = (longest[1] - longest[0]).try_normalize()?;
    let is_along = |p: &&[DVec2; 2]| {
        let d = (p[1] - p[0]).normalize_or_zero();
        d.dot(along).abs() > PARALLEL_COS
    };
    let spans = |u: DVec2| {
        let of = inside.iter().filter(is_along).flatten().map(|p| p.dot(u));
        of.fold([f64::MAX, f64::MIN], |[lo, hi], v| [lo.min(v), hi.max(v)])
    };
    let ([mut from, mut to], [low, high]) = (spans(along), spans(along.perp()));
    if let Some(width) = width {
        let middle = f64::midpoint(from, to);
        (from, to) = (middle - width / 2.0, middle + width / 2.0);
    }
    let reach =
        outline.iter().map(|p| p.dot(along.perp())).fold([low, high], |[lo, hi], v| [lo.min(v), hi.max(v)]);
    let beyond = ((high - low) * BEYOND_SHARE).min(f64::max(low - reach[0], reach[1] - high).max(0.0));
    let (low_out, high_out) = (low - beyond.max(PIECE_MIN_M), high + beyond.max(PIECE_MIN_M));
    let at = |s: f64, t: f64| along * s + along.perp() * t;
    let middle = f64::midpoint(low, high);
    Some(Stretch {
        ground: vec![at(from, low_out), at(to, low_out), at(to, high_out), at(from, high_out)],
        jambs: [at(from, middle), at(to, middle)],
    })
}

/// Pieces of one wall differ less than 5° in direction.
const PARALLEL_COS: f64 = 0.996;

/// Cuts the walls by a ground, and closes the ends of those that are drawn by their faces.
pub(super) fn cut(walls: &mut Vec<Wall>, ground: &[DVec2], layer: &str, scale: Scale<'_>) -> Gone {
    let unit = scale.frame.metres_per_unit;
    let mut gone = Gone::default();
    let mut out = Vec::with_capacity(walls.len());
    // Where faces cross the sides of the ground: side, place along it, the wall.
    let mut crossings: Vec<(usize, f64, Wall)> = Vec::new();
    let why = format!("a decided work on {layer} cuts it");
    let trace = |s: &Shape| curve::trace(s, scale.frame);
    for wall in walls.drain(..) {
        let all = pieces(&wall, scale.frame);
        let meets = all.iter().any(|p| parts(*p, ground).iter().any(|(is_inside, _)| *is_inside));
        let piece = |shape: Shape| Wall {
            editable: Editable::No(why.clone()),
            trace: trace(&shape),
            shape,
            source: wall.source.clone(),
            single: None,
            ..wall.clone()
        };
        if wall.is_solid && wall.trace.is_closed {
            let ring: Vec<DVec2> = all.iter().map(|p| p[0]).collect();
            let divided = rings::divide(&ring, ground);
            gone.is_inside |= divided.has_hole;
            if !meets && divided.inside.is_empty() || divided.has_hole {
                out.push(wall);
                continue;
            }
            gone.pieces.extend(divided.inside.into_iter().map(|r| trace(&ring_shape(r))));
            out.extend(divided.outside.into_iter().map(|r| piece(ring_shape(r))));
            continue;
        }
        if !meets {
            out.push(wall);
            continue;
        }
        let (outside, inside) = runs(&all, ground, PIECE_MIN_M / unit);
        gone.pieces.extend(inside.into_iter().map(|r| trace(&line_shape(r))));
        if wall.width_um == 0 {
            crossings.extend(
                crossed(&all, ground).into_iter().map(|(side, t)| (side, t, piece(wall.shape.clone()))),
            );
        }
        out.extend(outside.into_iter().map(|r| piece(line_shape(r))));
    }
    let apart = FACES_APART_M / scale.unit_m();
    out.extend(ends(crossings, ground, apart, trace));
    *walls = out;
    gone
}

fn vertices(points: Vec<DVec2>) -> Vec<Vertex> {
    points.into_iter().map(|at| Vertex { at, bulge: 0.0 }).collect()
}

fn ring_shape(points: Vec<DVec2>) -> Shape {
    Shape::Polyline { vertices: vertices(points), closed: true }
}

fn line_shape(points: Vec<DVec2>) -> Shape {
    match points[..] {
        [a, b] => Shape::Line { a, b },
        _ => Shape::Polyline { vertices: vertices(points), closed: false },
    }
}

/// Joined pieces outside a ring, and inside it.
fn runs(all: &[[DVec2; 2]], ring: &[DVec2], least: f64) -> (Vec<Vec<DVec2>>, Vec<Vec<DVec2>>) {
    let mut out: [Vec<Vec<DVec2>>; 2] = Default::default();
    for [a, b] in all {
        for (is_inside, [s, t]) in parts([*a, *b], ring) {
            let (from, to) = (a.lerp(*b, s), if t == 1.0 { *b } else { a.lerp(*b, t) });
            let list = &mut out[usize::from(is_inside)];
            match list.last_mut() {
                Some(run) if run.last() == Some(&from) => run.push(to),
                _ => list.push(vec![from, to]),
            }
        }
    }
    for list in &mut out {
        // Of a closed line the last run goes on with the first.
        if let [first, .., last] = &mut list[..]
            && last.last() == first.first()
        {
            last.extend(first.drain(1..));
            list.remove(0);
        }
        list.retain(|run| run.windows(2).map(|w| w[0].distance(w[1])).sum::<f64>() > least);
    }
    let [outside, inside] = out;
    (outside, inside)
}

/// Where a line crosses the sides of a ring: the side, and how far along it, drawing units.
fn crossed(all: &[[DVec2; 2]], ring: &[DVec2]) -> Vec<(usize, f64)> {
    let mut out = Vec::new();
    for [a, b] in all {
        let d = *b - *a;
        for (side, p) in ring.iter().enumerate() {
            let e = ring[(side + 1) % ring.len()] - *p;
            let cross = d.perp_dot(e);
            if cross == 0.0 {
                continue;
            }
            let (s, t) = ((*p - *a).perp_dot(e) / cross, (*p - *a).perp_dot(d) / cross);
            if (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t) {
                out.push((side, t * e.length()));
            }
        }
    }
    out
}

/// Lines that close the ends of walls between their faces.
fn ends(
    mut crossings: Vec<(usize, f64, Wall)>,
    ring: &[DVec2],
    apart: f64,
    trace: impl Fn(&Shape) -> Trace,
) -> Vec<Wall> {
    crossings.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let mut out = Vec::new();
    for pair in crossings.windows(2) {
        let ((side, s, wall), (other, t, _)) = (&pair[0], &pair[1]);
        if side != other || t - s > apart || t <= s {
            continue;
        }
        let p = ring[*side];
        let along = (ring[(side + 1) % ring.len()] - p).normalize_or_zero();
        let shape = Shape::Line { a: p + along * *s, b: p + along * *t };
        out.push(Wall { trace: trace(&shape), shape, ..wall.clone() });
    }
    out
}

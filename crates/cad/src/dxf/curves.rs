//! Shapes under affine maps, and curves as polylines.

use std::f64::consts::TAU;

use glam::{DAffine2, DMat2, DVec2, DVec3};

use super::limits::MAX_CURVE_PIECES;
use crate::drawing::{Shape, Vertex};

/// Relative difference of lengths below which a map counts as a similarity.
const SIMILARITY_TOLERANCE: f64 = 1e-9;

/// Largest deviation of a curve from its polyline in metres, where the unit is known.
pub(super) const CURVE_TOLERANCE_M: f64 = 0.005;

/// Largest deviation in parts of the curve's size: 5 mm on a curve of 2.5 m.
const CURVE_TOLERANCE_COARSE: f64 = 0.002;

/// Smallest deviation asked for in parts of the curve's size, so that a wrong unit does not cut a
/// curve into thousands of pieces.
const CURVE_TOLERANCE_FINE: f64 = 1e-5;

/// Allowed deviation, drawing units, of a curve of this size when 5 mm are `five_mm` drawing units.
pub(super) fn tolerance(size: f64, five_mm: Option<f64>) -> f64 {
    let coarse = size * CURVE_TOLERANCE_COARSE;
    // Not clamp, which panics where a size is NaN.
    five_mm.unwrap_or(coarse).max(size * CURVE_TOLERANCE_FINE).min(coarse)
}

/// The direction of an extrusion vector of any finite length, +z for a zero one.
pub(super) fn unit_normal(extrusion: DVec3) -> DVec3 {
    (extrusion / extrusion.abs().max_element()).normalize_or(DVec3::Z)
}

/// Axes of the object coordinate system of an extrusion vector (DXF reference, arbitrary axis algorithm).
pub(super) fn ocs_axes(extrusion: DVec3) -> [DVec3; 3] {
    let n = unit_normal(extrusion);
    let near_z = n.x.abs() < 1.0 / 64.0 && n.y.abs() < 1.0 / 64.0;
    let x = if near_z { DVec3::Y.cross(n) } else { DVec3::Z.cross(n) }.normalize();
    [x, n.cross(x), n]
}

/// How far the z of a unit normal may be from ±1 in a plane that lies flat: a tilt of 1.4 µm in a metre.
const UPRIGHT_TOLERANCE: f64 = 1e-12;

/// Whether an extrusion is +z or −z; what little it leans by counts as nothing.
pub(super) fn is_upright(extrusion: DVec3) -> bool {
    extrusion.is_finite() && unit_normal(extrusion).z.abs() > 1.0 - UPRIGHT_TOLERANCE
}

/// Seen from above, where the plane of an extrusion at this elevation lies: object to world xy. A flat plane is
/// kept or turned over, exactly, so that a value that does not move is written back as it was.
pub(super) fn ocs_to_world(extrusion: DVec3, elevation: f64) -> DAffine2 {
    if is_upright(extrusion) {
        let side = if extrusion.z < 0.0 { -1.0 } else { 1.0 };
        return DAffine2::from_scale(DVec2::new(side, 1.0));
    }
    let [x, y, n] = ocs_axes(extrusion);
    DAffine2::from_mat2_translation(DMat2::from_cols(x.truncate(), y.truncate()), n.truncate() * elevation)
}

/// Whether a map keeps angles; then its scale, negative if it mirrors.
pub(super) fn similarity(map: &DAffine2) -> Option<f64> {
    let (x, y) = (map.matrix2.x_axis, map.matrix2.y_axis);
    let size = x.length_squared().max(y.length_squared());
    let is_similar = (x.length_squared() - y.length_squared()).abs() <= SIMILARITY_TOLERANCE * size
        && x.dot(y).abs() <= SIMILARITY_TOLERANCE * size;
    (is_similar && size > 0.0).then(|| size.sqrt().copysign(map.matrix2.determinant()))
}

/// The shape under a map; circles and arcs stay such under similarities, else they become polylines.
pub(super) fn mapped(shape: &Shape, map: &DAffine2, five_mm: Option<f64>) -> Shape {
    let at = |p: DVec2| map.transform_point2(p);
    if let Shape::Line { a, b } = shape {
        return Shape::Line { a: at(*a), b: at(*b) };
    }
    let Some(scale) = similarity(map) else {
        return flattened_under(shape, map, five_mm);
    };
    match shape {
        Shape::Line { a, b } => Shape::Line { a: at(*a), b: at(*b) },
        Shape::Polyline { vertices, closed } => Shape::Polyline {
            vertices: vertices
                .iter()
                .map(|v| Vertex { at: at(v.at), bulge: v.bulge * scale.signum() })
                .collect(),
            closed: *closed,
        },
        Shape::Circle { centre, radius } => {
            Shape::Circle { centre: at(*centre), radius: radius * scale.abs() }
        }
        Shape::Arc { centre, radius, start_rad, end_rad } => {
            let turned = |angle: f64| turned_angle(angle, map, scale);
            let (start, end) = (turned(*start_rad), turned(*end_rad));
            let (start_rad, end_rad) = if scale < 0.0 { (end, start) } else { (start, end) };
            Shape::Arc { centre: at(*centre), radius: radius * scale.abs(), start_rad, end_rad }
        }
    }
}

/// An angle under a similarity of this signed scale; exact where the map does not turn.
fn turned_angle(angle: f64, map: &DAffine2, scale: f64) -> f64 {
    let x = map.matrix2.x_axis;
    let turn = x.y.atan2(x.x);
    if scale < 0.0 { turn - angle } else { turn + angle }
}

fn flattened_under(shape: &Shape, map: &DAffine2, five_mm: Option<f64>) -> Shape {
    let (curve, closed) = match shape {
        Shape::Polyline { vertices, closed } if vertices.iter().all(|v| v.bulge == 0.0) => {
            (vertices.iter().map(|v| v.at).collect(), *closed)
        }
        Shape::Polyline { vertices, closed } => (flattened_bulges(vertices, *closed, map, five_mm), *closed),
        Shape::Circle { centre, radius } => (arc_points(*centre, *radius, 0.0, TAU, map, five_mm), true),
        Shape::Arc { centre, radius, start_rad, end_rad } => {
            let sweep = sweep_of(*start_rad, *end_rad);
            (arc_points(*centre, *radius, *start_rad, sweep, map, five_mm), false)
        }
        Shape::Line { a, b } => (vec![*a, *b], false),
    };
    polyline(curve.into_iter().map(|p| map.transform_point2(p)), closed)
}

/// Anticlockwise sweep between two angles in (0, 2π]; equal angles are a full turn.
pub(super) fn sweep_of(start_rad: f64, end_rad: f64) -> f64 {
    let sweep = (end_rad - start_rad).rem_euclid(TAU);
    if sweep == 0.0 { TAU } else { sweep }
}

/// A polyline of straight pieces.
pub(super) fn polyline(points: impl IntoIterator<Item = DVec2>, closed: bool) -> Shape {
    Shape::Polyline { vertices: points.into_iter().map(|at| Vertex { at, bulge: 0.0 }).collect(), closed }
}

/// Points of an arc in its own coordinates, dense enough for its image under `map`. A full turn leaves
/// out its last point.
fn arc_points(
    centre: DVec2,
    radius: f64,
    start: f64,
    sweep: f64,
    map: &DAffine2,
    five_mm: Option<f64>,
) -> Vec<DVec2> {
    let m = map.matrix2;
    let reach = radius * m.x_axis.length().hypot(m.y_axis.length());
    let pieces = pieces_of(reach, sweep, five_mm);
    let last = if sweep.abs() >= TAU { pieces } else { pieces + 1 };
    (0..last).map(|i| centre + radius * DVec2::from_angle(start + sweep * i as f64 / pieces as f64)).collect()
}

/// Pieces for a sweep of a curve whose second derivative by angle is at most `reach`: the chord of a
/// step h is off by at most reach·h²/8.
pub(super) fn pieces_of(reach: f64, sweep: f64, five_mm: Option<f64>) -> usize {
    let allowed = tolerance(2.0 * reach, five_mm);
    let step = (8.0 * allowed / reach).sqrt();
    ((sweep.abs() / step).ceil() as usize).clamp(2, MAX_CURVE_PIECES)
}

fn flattened_bulges(vertices: &[Vertex], closed: bool, map: &DAffine2, five_mm: Option<f64>) -> Vec<DVec2> {
    let mut out = Vec::new();
    for (i, v) in vertices.iter().enumerate() {
        out.push(v.at);
        let next = vertices[(i + 1) % vertices.len()].at;
        if v.bulge == 0.0 || next == v.at || (i + 1 == vertices.len() && !closed) {
            continue;
        }
        let (centre, radius, start, sweep) = bulge_arc(v.at, next, v.bulge);
        let points = arc_points(centre, radius, start, sweep, map, five_mm);
        out.extend_from_slice(points.get(1..points.len().saturating_sub(1)).unwrap_or_default());
    }
    out
}

/// Centre, radius, start angle and signed sweep of the arc of a bulge.
pub(super) fn bulge_arc(a: DVec2, b: DVec2, bulge: f64) -> (DVec2, f64, f64, f64) {
    let chord = b - a;
    let centre = (a + b) / 2.0 + chord.perp() * ((1.0 - bulge * bulge) / (4.0 * bulge));
    let from = a - centre;
    (centre, from.length(), from.y.atan2(from.x), 4.0 * bulge.atan())
}

/// An ellipse or elliptic arc from its DXF values (world coordinates, parameters anticlockwise about
/// the extrusion) as a polyline seen from above.
pub(super) fn ellipse(
    centre: DVec3,
    major: DVec3,
    ratio: f64,
    extrusion: DVec3,
    params: [f64; 2],
    five_mm: Option<f64>,
) -> Shape {
    let minor = unit_normal(extrusion).cross(major) * ratio;
    let span = params[1] - params[0];
    let is_full = (span.abs() - TAU).abs() < 1e-9 || span == 0.0;
    let sweep = if is_full { TAU } else { span.rem_euclid(TAU) };
    let pieces = pieces_of(major.length().max(minor.length()), sweep, five_mm);
    let last = if is_full { pieces } else { pieces + 1 };
    let at = |i: usize| {
        let t = params[0] + sweep * i as f64 / pieces as f64;
        (centre + major * t.cos() + minor * t.sin()).truncate()
    };
    polyline((0..last).map(at), is_full)
}

/// Why a spline cannot be drawn.
pub(super) type SplineFault = &'static str;

/// A B-spline (rational where `weights` is not empty) as a polyline.
pub(super) fn spline(
    degree: usize,
    knots: &[f64],
    control: &[DVec2],
    weights: &[f64],
    five_mm: Option<f64>,
) -> Result<Vec<DVec2>, SplineFault> {
    check_spline(degree, knots, control, weights)?;
    let allowed = tolerance(extent(control), five_mm);
    let at = |t: f64| de_boor(degree, knots, control, weights, t);
    let mut out = vec![at(knots[degree])];
    for span in degree..control.len() {
        let (from, to) = (knots[span], knots[span + 1]);
        if to > from {
            let end = at(if span + 1 == control.len() { to } else { to.next_down().max(from) });
            let start = *out.last().unwrap_or(&end);
            subdivide(&at, (from, start), (to, end), allowed, 9, &mut out);
        }
    }
    merge_collinear(&mut out);
    Ok(out)
}

fn check_spline(degree: usize, knots: &[f64], control: &[DVec2], weights: &[f64]) -> Result<(), SplineFault> {
    let finite = |values: &[f64]| values.iter().all(|v| v.is_finite());
    if !(1..=25).contains(&degree) {
        return Err("its degree is not between 1 and 25");
    }
    if control.len() <= degree {
        return Err("it has too few control points for its degree");
    }
    if knots.len() != control.len() + degree + 1 {
        return Err("its number of knots does not fit its control points");
    }
    if !finite(knots) || knots.windows(2).any(|w| w[1] < w[0]) || knots[degree] >= knots[control.len()] {
        return Err("its knots do not rise");
    }
    if !weights.is_empty()
        && (weights.len() != control.len() || !finite(weights) || weights.iter().any(|&w| w <= 0.0))
    {
        return Err("its weights are not positive numbers, one a control point");
    }
    Ok(())
}

/// Point of a B-spline at `t` (de Boor's algorithm in homogeneous coordinates).
fn de_boor(degree: usize, knots: &[f64], control: &[DVec2], weights: &[f64], t: f64) -> DVec2 {
    let n = control.len();
    let span = knots[degree..=n].partition_point(|&k| k <= t).max(1) - 1 + degree;
    let span = span.min(n - 1);
    let weight = |i: usize| weights.get(i).copied().unwrap_or(1.0);
    let mut d: Vec<DVec3> =
        (span - degree..=span).map(|i| (control[i] * weight(i)).extend(weight(i))).collect();
    for r in 1..=degree {
        for j in (r..=degree).rev() {
            let (lo, hi) = (knots[span - degree + j], knots[span + 1 + j - r]);
            let alpha = if hi > lo { (t - lo) / (hi - lo) } else { 0.0 };
            d[j] = d[j - 1] * (1.0 - alpha) + d[j] * alpha;
        }
    }
    d[degree].truncate() / d[degree].z
}

/// Adds points until every quarter point of a piece lies within `allowed` of its chord.
fn subdivide(
    at: &impl Fn(f64) -> DVec2,
    from: (f64, DVec2),
    to: (f64, DVec2),
    allowed: f64,
    depth: usize,
    out: &mut Vec<DVec2>,
) {
    let t = |part: f64| from.0 + (to.0 - from.0) * part;
    let is_flat =
        || [0.25, 0.5, 0.75].iter().all(|&k| distance_to_chord(at(t(k)), from.1, to.1) <= allowed / 2.0);
    if depth == 0 || out.len() >= MAX_CURVE_PIECES * 16 || is_flat() {
        out.push(to.1);
        return;
    }
    let middle = (t(0.5), at(t(0.5)));
    subdivide(at, from, middle, allowed, depth - 1, out);
    subdivide(at, middle, to, allowed, depth - 1, out);
}

fn distance_to_chord(p: DVec2, a: DVec2, b: DVec2) -> f64 {
    let chord = b - a;
    let along = ((p - a).dot(chord) / chord.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    p.distance(a + chord * along)
}

/// Drops points that lie on the chord of their neighbours.
fn merge_collinear(points: &mut Vec<DVec2>) {
    points.dedup();
    let allowed = extent(points) * 1e-9;
    let mut kept: Vec<DVec2> = Vec::with_capacity(points.len());
    for &p in points.iter() {
        while kept.len() >= 2 {
            let (a, b) = (kept[kept.len() - 2], kept[kept.len() - 1]);
            if distance_to_chord(b, a, p) > allowed {
                break;
            }
            kept.pop();
        }
        kept.push(p);
    }
    *points = kept;
}

/// The smooth curve through fit points: a natural cubic spline over chord length, with the end tangents
/// where they are given.
pub(super) fn fit_spline(points: &[DVec2], tangents: [Option<DVec2>; 2], five_mm: Option<f64>) -> Vec<DVec2> {
    let mut fit = points.to_vec();
    fit.dedup();
    if fit.len() < 3 && tangents == [None, None] || fit.len() < 2 {
        return fit;
    }
    let lengths: Vec<f64> = fit.windows(2).map(|w| w[0].distance(w[1])).collect();
    let slopes = spline_slopes(&fit, &lengths, tangents);
    let allowed = tolerance(extent(&fit), five_mm);
    let mut out = vec![fit[0]];
    for i in 0..lengths.len() {
        let (a, b, h) = (fit[i], fit[i + 1], lengths[i]);
        let (ta, tb) = (slopes[i] * h, slopes[i + 1] * h);
        let at = |t: f64| {
            let (t2, t3) = (t * t, t * t * t);
            a * (2.0 * t3 - 3.0 * t2 + 1.0)
                + ta * (t3 - 2.0 * t2 + t)
                + b * (3.0 * t2 - 2.0 * t3)
                + tb * (t3 - t2)
        };
        subdivide(&at, (0.0, a), (1.0, b), allowed, 9, &mut out);
    }
    merge_collinear(&mut out);
    out
}

/// Derivatives by length at the fit points (tridiagonal system of the C² cubic spline).
fn spline_slopes(fit: &[DVec2], h: &[f64], tangents: [Option<DVec2>; 2]) -> Vec<DVec2> {
    let n = fit.len();
    let secant = |i: usize| (fit[i + 1] - fit[i]) / h[i];
    let (mut diagonal, mut upper, mut right) = (vec![0.0; n], vec![0.0; n], vec![DVec2::ZERO; n]);
    for i in 0..n {
        let (lower, mid, up, rhs) = if i == 0 {
            match tangents[0].and_then(DVec2::try_normalize) {
                Some(t) => (0.0, 1.0, 0.0, t),
                None => (0.0, 2.0, 1.0, secant(0) * 3.0),
            }
        } else if i == n - 1 {
            match tangents[1].and_then(DVec2::try_normalize) {
                Some(t) => (0.0, 1.0, 0.0, t),
                None => (1.0, 2.0, 0.0, secant(n - 2) * 3.0),
            }
        } else {
            let rhs = (secant(i - 1) * h[i] + secant(i) * h[i - 1]) * 3.0;
            (h[i], 2.0 * (h[i - 1] + h[i]), h[i - 1], rhs)
        };
        let ratio = if i == 0 { 0.0 } else { lower / diagonal[i - 1] };
        diagonal[i] = mid - if i == 0 { 0.0 } else { ratio * upper[i - 1] };
        upper[i] = up;
        right[i] = rhs - if i == 0 { DVec2::ZERO } else { right[i - 1] * ratio };
    }
    for i in (0..n).rev() {
        let after = if i + 1 < n { right[i + 1] * upper[i] } else { DVec2::ZERO };
        right[i] = (right[i] - after) / diagonal[i];
    }
    right
}

/// How far points reach about their middle: the same for a curve however it is turned, so that a moved
/// curve is cut into the same pieces.
fn extent(points: &[DVec2]) -> f64 {
    let middle = points.iter().sum::<DVec2>() / points.len().max(1) as f64;
    2.0 * points.iter().map(|p| p.distance(middle)).fold(0.0, f64::max)
}

#[cfg(test)]
#[path = "curves_tests.rs"]
mod tests;

//! Drawn shapes to straight pieces: the one place where arcs become chords.
//!
//! Works on shapes in drawing units and returns points of the drawing frame on whole micrometres, so
//! that a shape written to a file and read again gives the very same pieces.

use enfilade_cad::curve::{bulge_arc, sweep_rad};
use std::f64::consts::TAU;

use glam::DVec2;

use super::frame::Frame;
use enfilade_cad::drawing::{Shape, Vertex};
use enfilade_engine::geometry::{PointUm, Segment};

/// Largest distance between an arc and its chords.
pub const CHORD_ERROR_M: f64 = 0.005;

/// Most chords of one full circle; reached only by arcs of some hundred metres radius.
pub const CHORDS_PER_TURN_MAX: usize = 720;

/// Fewest chords of one full circle, for small columns.
const CHORDS_PER_TURN_MIN: usize = 16;

/// A shape as straight pieces, with the pieces' ends that are control points of the shape marked.
#[derive(Clone, Debug, PartialEq)]
pub struct Trace {
    /// Points in order, drawing frame, whole micrometres; a closed trace does not repeat the first.
    pub points: Vec<PointUm>,
    /// For each point the control point it is ([`enfilade_cad::curve::control_points`] order), if it is one.
    pub control: Vec<Option<u32>>,
    /// Whether the last point is joined with the first.
    pub is_closed: bool,
}

impl Trace {
    /// The pieces in order; a single point gives one piece of no length.
    pub fn segments(&self) -> impl Iterator<Item = (usize, usize, Segment)> + '_ {
        let n = self.points.len();
        let count = if n == 1 {
            1
        } else if self.is_closed {
            n
        } else {
            n - 1
        };
        (0..count).map(move |i| {
            let j = (i + 1) % n;
            (i, j, Segment { a: self.points[i], b: self.points[j] })
        })
    }
}

/// A shape as straight pieces within [`CHORD_ERROR_M`].
pub fn trace(shape: &Shape, frame: &Frame) -> Trace {
    let mut out = Trace { points: Vec::new(), control: Vec::new(), is_closed: false };
    let mut push = |p: DVec2, control: Option<u32>| {
        out.points.push(frame.um_from_file(p));
        out.control.push(control);
    };
    match shape {
        Shape::Line { a, b } => {
            push(*a, Some(0));
            push(*b, Some(1));
        }
        Shape::Polyline { vertices, closed } => {
            trace_polyline(vertices, *closed, frame, &mut push);
            out.is_closed = *closed && vertices.len() > 1;
        }
        Shape::Arc { centre, radius, start_rad, end_rad } => {
            let sweep = sweep_rad(*start_rad, *end_rad);
            let n = chords(*radius, sweep, frame);
            for i in 0..=n {
                let control = if i == 0 {
                    Some(0)
                } else if i == n {
                    Some(1)
                } else {
                    None
                };
                push(*centre + DVec2::from_angle(start_rad + sweep * i as f64 / n as f64) * *radius, control);
            }
        }
        Shape::Circle { centre, radius } => {
            let n = chords(*radius, TAU, frame);
            for i in 0..n {
                push(*centre + DVec2::from_angle(TAU * i as f64 / n as f64) * *radius, None);
            }
            out.is_closed = true;
        }
    }
    out
}

/// A shape as straight pieces, as many as `like` has: for measures that compare layouts piece by piece.
///
/// `shape` is a moved version of the shape that gave `like`.
pub fn trace_like(shape: &Shape, like: &Trace, frame: &Frame) -> Trace {
    let own = trace(shape, frame);
    if own.points.len() == like.points.len() {
        return own;
    }
    let Shape::Polyline { vertices, .. } = shape else { return own };
    if vertices.len() != like.control.iter().flatten().count() {
        return Trace { points: resampled(&own.points, &like.points), ..like.clone() };
    }
    let mut out = Trace { points: Vec::new(), ..like.clone() };
    let mut i = 0;
    while i < like.control.len() {
        let inner = like.control[i + 1..].iter().take_while(|c| c.is_none()).count();
        let v = like.control[i].map_or(0, |c| c as usize);
        let (from, to) = (vertices[v], vertices[(v + 1) % vertices.len()]);
        out.points.push(frame.um_from_file(from.at));
        let arc = bulge_arc(from.at, to.at, from.bulge);
        for k in 1..=inner {
            let t = k as f64 / (inner + 1) as f64;
            let at = match arc {
                Some((centre, radius, start, sweep)) => {
                    centre + DVec2::from_angle(start + sweep * t) * radius
                }
                None => from.at.lerp(to.at, t),
            };
            out.points.push(frame.um_from_file(at));
        }
        i += inner + 1;
    }
    out
}

/// As many points as `like`, on the line through `points` and at the same shares of its length.
fn resampled(points: &[PointUm], like: &[PointUm]) -> Vec<PointUm> {
    let place = |p: &PointUm| DVec2::new(p[0] as f64, p[1] as f64);
    let shares = |line: &[PointUm]| -> Vec<f64> {
        let steps = line.windows(2).map(|w| place(&w[0]).distance(place(&w[1])));
        let mut out = vec![0.0];
        steps.for_each(|step| out.push(out[out.len() - 1] + step));
        let whole = out[out.len() - 1].max(1.0);
        out.into_iter().map(|s| s / whole).collect()
    };
    let own = shares(points);
    let at = |share: f64| {
        let i = own.partition_point(|s| *s <= share).clamp(1, (points.len() - 1).max(1));
        let (Some(a), Some(b)) = (points.get(i - 1), points.get(i)) else { return points[0] };
        let t = (share - own[i - 1]) / (own[i] - own[i - 1]).max(f64::MIN_POSITIVE);
        place(a).lerp(place(b), t.clamp(0.0, 1.0)).round().to_array().map(|v| v as i64)
    };
    shares(like).into_iter().map(at).collect()
}

fn trace_polyline(
    vertices: &[Vertex],
    closed: bool,
    frame: &Frame,
    push: &mut impl FnMut(DVec2, Option<u32>),
) {
    for (i, v) in vertices.iter().enumerate() {
        push(v.at, Some(i as u32));
        let next = match vertices.get(i + 1) {
            Some(next) => next,
            None if closed => &vertices[0],
            None => break,
        };
        if let Some((centre, radius, start, sweep)) = bulge_arc(v.at, next.at, v.bulge) {
            let n = chords(radius, sweep.abs(), frame);
            for k in 1..n {
                push(centre + DVec2::from_angle(start + sweep * k as f64 / n as f64) * radius, None);
            }
        }
    }
}

fn chords(radius: f64, sweep_rad: f64, frame: &Frame) -> usize {
    let radius_m = radius * frame.metres_per_unit;
    let half_angle = (1.0 - (CHORD_ERROR_M / radius_m).min(1.0)).acos();
    let per_turn = (std::f64::consts::PI / half_angle).ceil() as usize;
    let per_turn = per_turn.clamp(CHORDS_PER_TURN_MIN, CHORDS_PER_TURN_MAX);
    ((per_turn as f64 * sweep_rad / TAU).ceil() as usize).max(1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    const METRES: Frame = Frame { metres_per_unit: 1.0, origin_um: [0, 0] };

    /// Largest distance of an arc's chords from the arc, metres.
    fn chord_error(trace: &Trace, centre: DVec2, radius: f64) -> f64 {
        let middle = |s: Segment| {
            DVec2::new((s.a[0] + s.b[0]) as f64 / 2e6, (s.a[1] + s.b[1]) as f64 / 2e6).distance(centre)
        };
        trace.segments().map(|(_, _, s)| (radius - middle(s)).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn chords_stay_near_their_arc() {
        for radius in [0.1, 0.5, 3.0, 40.0] {
            let centre = DVec2::new(12.0, -7.0);
            let circle = trace(&Shape::Circle { centre, radius }, &METRES);
            assert!(chord_error(&circle, centre, radius) <= CHORD_ERROR_M + 2e-6, "{radius}");
            let arc = Shape::Arc { centre, radius, start_rad: 0.3, end_rad: 0.3 + PI };
            assert!(chord_error(&trace(&arc, &METRES), centre, radius) <= CHORD_ERROR_M + 2e-6);
        }
        let huge = trace(&Shape::Circle { centre: DVec2::ZERO, radius: 1e6 }, &METRES);
        assert_eq!(huge.points.len(), CHORDS_PER_TURN_MAX);
    }

    #[test]
    fn a_line_is_sampled_like_another_without_losing_its_ends() {
        let line = |x: &[i64]| x.iter().map(|x| [*x, 0]).collect::<Vec<PointUm>>();
        let sampled = resampled(&line(&[0, 100, 400, 1000]), &line(&[0, 25, 50]));
        assert_eq!(sampled, line(&[0, 500, 1000]));
        assert_eq!(resampled(&line(&[7]), &line(&[0, 50])), line(&[7, 7]));
    }

    #[test]
    fn a_bulge_of_one_is_half_a_circle() {
        let (a, b) = (DVec2::new(1.0, 0.0), DVec2::new(3.0, 0.0));
        let (centre, radius, _, sweep) = bulge_arc(a, b, 1.0).unwrap();
        assert!(centre.distance(DVec2::new(2.0, 0.0)) < 1e-12 && (radius - 1.0).abs() < 1e-12);
        assert!((sweep - PI).abs() < 1e-12);
        assert!(
            bulge_arc(a, b, 0.0).is_none()
                && bulge_arc(a, a, 1.0).is_none()
                && bulge_arc(a, b, f64::NAN).is_none()
        );
        let shape = |b: DVec2| Shape::Polyline {
            vertices: vec![Vertex { at: a, bulge: 1.0 }, Vertex { at: b, bulge: 0.0 }],
            closed: false,
        };
        let trace_a = trace(&shape(b), &METRES);
        assert!(
            trace_a.points.iter().any(|p| p[1] < -990_000),
            "a positive bulge runs anticlockwise: below the chord"
        );
        let longer = trace_like(&shape(DVec2::new(9.0, 0.0)), &trace_a, &METRES);
        assert_eq!((longer.points.len(), longer.control.len()), (trace_a.points.len(), trace_a.points.len()));
        assert!(chord_error(&longer, DVec2::new(5.0, 0.0), 4.0) < 0.1);
    }
}

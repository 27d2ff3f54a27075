//! Round pieces drawn by chords: what a program wrote as a spline or a polyline where another draws an arc.

use std::f64::consts::{PI, TAU};

use glam::DVec2;

use super::axes::Path;

/// Fewest chords that are an arc; fewer may be a polygon.
const CHORDS_MIN: usize = 4;

/// How far corners may lie from the circle, as a share of its radius.
const FIT_SHARE: f64 = 0.02;

/// Ends of chords nearer than this share of the first chord are one.
const JOINED_SHARE: f64 = 1e-3;

/// The arc that pieces in a row trace, of less than a full turn; one arc is itself.
pub(super) fn as_arc(paths: &[Path]) -> Option<Path> {
    if let [arc @ Path::Arc { .. }] = paths {
        return Some(*arc);
    }
    let points = chain(paths)?;
    if points.len() <= CHORDS_MIN {
        return None;
    }
    let (first, last) = (points[0], points[points.len() - 1]);
    let (centre, radius) = circle(first, points[points.len() / 2], last)?;
    let is_on = |p: &DVec2| ((p.distance(centre) - radius) / radius).abs() <= FIT_SHARE;
    let turns: Vec<f64> = points.windows(2).map(|w| (w[0] - centre).angle_to(w[1] - centre)).collect();
    let goes_on = |left: bool| turns.iter().all(|t| (*t > 0.0) == left && t.abs() < PI / 2.0);
    let sweep: f64 = turns.iter().sum();
    if !points.iter().all(is_on) || !goes_on(sweep > 0.0) || sweep.abs() >= TAU {
        return None;
    }
    let start = if sweep > 0.0 { first } else { last };
    Some(Path::Arc { centre, radius, start_rad: (start - centre).to_angle(), sweep_rad: sweep.abs() })
}

/// The corners of straight pieces that follow each other.
fn chain(paths: &[Path]) -> Option<Vec<DVec2>> {
    let mut out: Vec<DVec2> = Vec::with_capacity(paths.len() + 1);
    for path in paths {
        let Path::Line { a, b } = *path else { return None };
        match out.last() {
            None => out.push(a),
            Some(last) if last.distance(a) > JOINED_SHARE * a.distance(b) => return None,
            Some(_) => {}
        }
        out.push(b);
    }
    Some(out)
}

/// Centre and radius of the circle through three points.
fn circle(a: DVec2, b: DVec2, c: DVec2) -> Option<(DVec2, f64)> {
    let (u, v) = (b - a, c - a);
    let turn = 2.0 * u.perp_dot(v);
    let offset = DVec2::new(
        v.y * u.length_squared() - u.y * v.length_squared(),
        u.x * v.length_squared() - v.x * u.length_squared(),
    ) / turn;
    let radius = offset.length();
    (radius.is_finite() && radius > 0.0).then_some((a + offset, radius))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn traced(start: f64, sweep: f64, chords: usize) -> Vec<Path> {
        let at = |k: usize| {
            DVec2::new(3.0, -2.0) + DVec2::from_angle(start + sweep * k as f64 / chords as f64) * 0.9
        };
        (0..chords).map(|k| Path::Line { a: at(k), b: at(k + 1) }).collect()
    }

    #[test]
    fn chords_of_a_swing_are_its_arc_whichever_way_they_run() {
        for (start, sweep) in [(0.3, 1.5), (1.8, -1.5), (-3.0, 2.9)] {
            let Some(Path::Arc { centre, radius, start_rad, sweep_rad }) = as_arc(&traced(start, sweep, 6))
            else {
                panic!("{start} {sweep}");
            };
            assert!(centre.distance(DVec2::new(3.0, -2.0)) < 1e-9 && (radius - 0.9).abs() < 1e-9);
            let from = if sweep > 0.0 { start } else { start + sweep };
            assert!(1.0 - (start_rad - from).cos() < 1e-9, "{start_rad} {from}");
            assert!((sweep_rad - sweep.abs()).abs() < 1e-9);
        }
    }

    #[test]
    fn polygons_zigzags_and_straight_lines_are_no_arc() {
        let line =
            |x0: f64, y0: f64, x1: f64, y1: f64| Path::Line { a: DVec2::new(x0, y0), b: DVec2::new(x1, y1) };
        assert_eq!(as_arc(&traced(0.0, 1.5, 3)), None);
        let straight: Vec<Path> = (0..6).map(|k| line(f64::from(k), 0.0, f64::from(k + 1), 0.0)).collect();
        assert_eq!(as_arc(&straight), None);
        let zigzag: Vec<Path> = (0..6)
            .map(|k| line(f64::from(k), f64::from(k % 2), f64::from(k + 1), f64::from((k + 1) % 2)))
            .collect();
        assert_eq!(as_arc(&zigzag), None);
        let mut torn = traced(0.0, 1.5, 8);
        torn.remove(3);
        assert_eq!(as_arc(&torn), None);
    }
}

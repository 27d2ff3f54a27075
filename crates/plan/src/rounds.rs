//! Round pieces drawn by chords: what a program wrote as a spline or a polyline where another draws an arc.

use std::f64::consts::{PI, TAU};

use glam::DVec2;

use super::axes::Path;
use super::axes::near::Buckets;
use crate::sizes::COLLINEAR_M;

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

/// They turn by less than this where they meet: the cosine.
const PARTS_COS: f64 = 0.86;

/// A part is the edge of a leaf if it is shorter than this share of the part of the swing beside it.
const EDGE_SHARE: f64 = 0.5;

/// What is longer is no part of a swing, metres of a person.
const PART_MAX_M: f64 = 1.6;

/// Arcs drawn in parts, each a thing of its own: the places in `parts` of those that follow each other, ascending, and
/// the arc that they trace together.
pub(super) fn arcs_in_parts(parts: &[&[Path]]) -> Vec<(Vec<usize>, Path)> {
    let is_short = |p: &[Path]| (0.0..=PART_MAX_M).contains(&p.iter().map(Path::length_m).sum());
    let ends: Vec<Option<[End; 2]>> = parts.iter().map(|p| ends_of(p).filter(|_| is_short(p))).collect();
    let mut near = Buckets::new(0.25);
    for (i, e) in ends.iter().enumerate() {
        e.iter().flatten().for_each(|e| near.add(i as u32, &[e.at]));
    }
    let next = |i: usize, k: usize| -> Option<(usize, usize)> {
        let from = ends[i]?[k];
        let all = near.near(from.at, from.at).into_iter().map(|j| j as usize).filter(|j| *j != i);
        let all = all.flat_map(|j| [(j, 0), (j, 1)]);
        let mut on = all.filter(|(j, f)| ends[*j].is_some_and(|e| from.goes_on(&e[*f])));
        on.next().filter(|_| on.next().is_none())
    };
    let mut is_seen = vec![false; parts.len()];
    let mut out = Vec::new();
    for i in 0..parts.len() {
        // From one end of a row to the other.
        let Some(first) = (0..2).find(|k| next(i, 1 - *k).is_none() && next(i, *k).is_some()) else {
            continue;
        };
        let (mut row, mut at) = (Vec::new(), Some((i, 1 - first)));
        while let Some((part, enters)) = at.filter(|(part, _)| !is_seen[*part]) {
            is_seen[part] = true;
            row.push((part, walked(parts[part], enters)));
            at = next(part, 1 - enters).filter(|on| next(on.0, on.1) == Some((part, 1 - enters)));
        }
        out.extend(arc_of(&row));
    }
    out
}

/// The arc of a row of parts, without its first or last one where these are edges of the leaf: far shorter than the
/// part beside them.
fn arc_of(row: &[(usize, Vec<Path>)]) -> Option<(Vec<usize>, Path)> {
    let length = |part: &(usize, Vec<Path>)| part.1.iter().map(Path::length_m).sum::<f64>();
    let is_edge = |part, beside| length(part) < EDGE_SHARE * length(beside);
    let part = match row {
        [a, b, .., c, d] => &row[usize::from(is_edge(a, b))..row.len() - usize::from(is_edge(d, c))],
        [a, b, c] => &row[usize::from(is_edge(a, b))..3 - usize::from(is_edge(c, b) && !is_edge(a, b))],
        [_, _] => row,
        _ => return None,
    };
    let paths: Vec<Path> = part.iter().flat_map(|p| p.1.iter().copied()).collect();
    let mut places: Vec<usize> = part.iter().map(|p| p.0).collect();
    places.sort_unstable();
    Some((places, as_arc(&paths)?))
}

/// An end of something drawn, and the direction out of it.
#[derive(Clone, Copy)]
struct End {
    at: DVec2,
    out: DVec2,
}

impl End {
    /// Whether another thing goes on where this one ends.
    fn goes_on(&self, other: &Self) -> bool {
        self.at.distance(other.at) <= COLLINEAR_M && self.out.dot(other.out) < -PARTS_COS
    }
}

fn ends_of(paths: &[Path]) -> Option<[End; 2]> {
    let points = chain(paths)?;
    let ([first, second, ..], [.., before, last]) = (points.as_slice(), points.as_slice()) else {
        return None;
    };
    let end = |at: &DVec2, before: &DVec2| Some(End { at: *at, out: (at - before).try_normalize()? });
    Some([end(first, second)?, end(last, before)?])
}

/// The pieces of a part from one of its ends to the other, each turned to run that way if it is straight.
fn walked(paths: &[Path], enters: usize) -> Vec<Path> {
    if enters == 0 {
        return paths.to_vec();
    }
    let turned = paths.iter().rev().map(|p| match *p {
        Path::Line { a, b } => Path::Line { a: b, b: a },
        arc => arc,
    });
    turned.collect()
}

/// Points along pieces that follow each other, whichever way arcs among them run.
fn chain(paths: &[Path]) -> Option<Vec<DVec2>> {
    let mut out: Vec<DVec2> = Vec::with_capacity(paths.len() + 1);
    for (i, path) in paths.iter().enumerate() {
        let mut points = points_of(path);
        let near = JOINED_SHARE * path.length_m();
        let begins_at = |p: &[DVec2], q: DVec2| p[0].distance(q) <= near;
        let is_turned = match (out.last(), paths.get(i + 1)) {
            (Some(last), _) => !begins_at(&points, *last),
            (None, Some(next)) => next.ends().iter().any(|e| begins_at(&points, *e)),
            (None, None) => false,
        };
        if is_turned && matches!(path, Path::Arc { .. }) {
            points.reverse();
        }
        match out.last() {
            None => out.extend(points),
            Some(last) if !begins_at(&points, *last) => return None,
            Some(_) => out.extend(&points[1..]),
        }
    }
    Some(out)
}

/// Its ends; points between them too where it is round.
fn points_of(path: &Path) -> Vec<DVec2> {
    match *path {
        Path::Line { a, b } => vec![a, b],
        Path::Arc { centre, radius, start_rad, sweep_rad } => {
            let at = |k: usize| start_rad + sweep_rad * k as f64 / CHORDS_MIN as f64;
            (0..=CHORDS_MIN).map(|k| centre + DVec2::from_angle(at(k)) * radius).collect()
        }
    }
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
    fn a_swing_in_several_arcs_is_one_whichever_way_they_run() {
        let arc = |from: f64, to: f64| Path::Arc {
            centre: DVec2::new(3.0, -2.0),
            radius: 0.9,
            start_rad: from,
            sweep_rad: to - from,
        };
        let parts = [arc(0.2, 0.8), arc(0.8, 1.3), arc(1.3, 1.7)];
        let turned: Vec<Path> = parts.iter().rev().copied().collect();
        for paths in [parts.to_vec(), turned] {
            let Some(Path::Arc { centre, radius, start_rad, sweep_rad }) = as_arc(&paths) else {
                panic!("{paths:?}");
            };
            assert!(centre.distance(DVec2::new(3.0, -2.0)) < 1e-9 && (radius - 0.9).abs() < 1e-9);
            assert!((start_rad - 0.2).abs() < 1e-9 && (sweep_rad - 1.5).abs() < 1e-9);
        }
        assert_eq!(as_arc(&[parts[0], parts[2]]), None);
        let leaf = Path::Line { a: DVec2::new(3.0, -2.0), b: parts[0].ends()[0] };
        assert_eq!(as_arc(&[leaf, parts[0]]), None);
    }

    #[test]
    fn a_swing_in_parts_is_one_arc_in_any_order() {
        let mut parts: Vec<Vec<Path>> = traced(0.3, 1.5, 9).into_iter().map(|p| vec![p]).collect();
        parts.swap(0, 5);
        parts.swap(2, 7);
        if let Path::Line { a, b } = parts[3][0] {
            parts[3] = vec![Path::Line { a: b, b: a }];
        }
        // The leaf, which meets the swing at its tip and does not go on; its thickness does.
        let hinge = DVec2::new(3.0, -2.0);
        let tip = hinge + DVec2::from_angle(0.3) * 0.9;
        parts.push(vec![Path::Line { a: hinge, b: tip }]);
        parts.push(vec![Path::Line { a: tip, b: tip - DVec2::from_angle(0.3).perp() * 0.04 }]);
        let found = arcs_in_parts(&parts.iter().map(Vec::as_slice).collect::<Vec<_>>());
        let [(row, Path::Arc { centre, radius, start_rad, sweep_rad })] = found.as_slice() else {
            panic!("{found:?}");
        };
        assert_eq!(row, &(0..9).collect::<Vec<usize>>());
        assert!(centre.distance(hinge) < 1e-9 && (radius - 0.9).abs() < 1e-9);
        assert!((start_rad - 0.3).abs() < 1e-9 && (sweep_rad - 1.5).abs() < 1e-9);
        parts.remove(4);
        let torn = arcs_in_parts(&parts.iter().map(Vec::as_slice).collect::<Vec<_>>());
        assert!(
            torn.iter().all(|(_, arc)| matches!(arc, Path::Arc { sweep_rad, .. } if *sweep_rad < 1.2)),
            "{torn:?}"
        );
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

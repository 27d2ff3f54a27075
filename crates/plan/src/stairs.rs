//! Stairs drawn on a wall layer: flights of equal parallel treads, the string between two flights, winders.
//! They are no walls.

use glam::DVec2;

use super::parallels::Straight;
use crate::sizes::{ERROR_GAP_M, LAYERED_MAX_M, THICKNESS_MIN_M};

/// Distance of two treads (the going), metres: ladders to terraces.
const GOING_M: [f64; 2] = [0.2, 0.42];

/// Goings of one flight differ by at most this, or by [`GOING_SHARE`].
const GOING_SLACK_M: f64 = 0.015;

/// See [`GOING_SLACK_M`].
const GOING_SHARE: f64 = 0.06;

/// Shortest tread, metres.
const TREAD_MIN_M: f64 = 0.6;

/// How far apart the ends of treads that follow each other on a string lie, as a share of their length.
const LIKE_SHARE: f64 = 0.1;

/// Where a flight is cut a tread is at least so much of the one before.
const CUT_SHARE: f64 = 0.5;

/// Treads that make a flight by themselves: more equal distances than thick walls side by side have.
const TREADS_MIN: usize = 5;

/// Treads that make a flight beside another of the same going.
const TREADS_BESIDE_MIN: usize = 3;

/// Flights of one stair are at most this far apart, metres.
const BESIDE_M: f64 = 0.6;

/// Shortest string or winder; what is shorter may be a jamb.
const PART_MIN_M: f64 = 0.4;

/// A line that runs through this many treads shows the way up.
const CROSSED_MIN: usize = 3;

/// Treads whose directions differ by less are parallel.
const PARALLEL_RAD: f64 = 0.015;

/// Most treads looked ahead for the next one; keeps hatches near-linear.
const LOOK_MAX: usize = 64;

/// Among more lines no stairs are looked for.
const LINES_MAX: usize = 20_000;

/// Treads in a row.
struct Flight {
    /// Indices into the lines.
    treads: Vec<usize>,
    going: f64,
    /// Unit vector along the treads.
    along: DVec2,
}

/// Indices of the lines (metres) that draw stairs, ascending.
pub(super) fn find(lines: &[Straight]) -> Vec<usize> {
    if lines.len() > LINES_MAX {
        return Vec::new();
    }
    let chains = chains(lines);
    let (mut flights, short): (Vec<Flight>, Vec<Flight>) =
        chains.into_iter().partition(|f| f.treads.len() >= TREADS_MIN);
    let beside: Vec<Flight> =
        short.into_iter().filter(|f| flights.iter().any(|g| is_beside(lines, f, g))).collect();
    flights.extend(beside);
    let mut is_stair = vec![false; lines.len()];
    flights.iter().flat_map(|f| &f.treads).for_each(|t| is_stair[*t] = true);
    flights.iter_mut().for_each(|f| end_at_walls(lines, f, &mut is_stair));
    // What is known as part of the stair is no second face of a line beside it.
    loop {
        let inside: Vec<usize> = flights.iter().flat_map(|f| within(lines, f, &flights, &is_stair)).collect();
        if inside.is_empty() {
            break;
        }
        inside.into_iter().for_each(|i| is_stair[i] = true);
    }
    (0..lines.len()).filter(|i| is_stair[*i]).collect()
}

/// Rows of equal parallel lines, at least [`TREADS_BESIDE_MIN`] long; a line stands in one row.
fn chains(lines: &[Straight]) -> Vec<Flight> {
    let mut order: Vec<(f64, usize)> = (0..lines.len())
        .filter(|i| lines[*i].length() >= TREAD_MIN_M)
        .map(|i| (lines[i].direction_rad(), i))
        .collect();
    order.sort_by(|x, y| x.0.total_cmp(&y.0).then(x.1.cmp(&y.1)));
    let mut out = Vec::new();
    for same in order.chunk_by(|x, y| y.0 - x.0 < PARALLEL_RAD / 4.0) {
        let along = DVec2::from_angle(same[same.len() / 2].0);
        let mut rungs: Vec<Rung> = same.iter().map(|(_, i)| Rung::new(*i, &lines[*i], along)).collect();
        rungs.sort_by(|x, y| x.offset.total_cmp(&y.offset).then(x.index.cmp(&y.index)));
        out.extend(rows(&rungs, along));
    }
    out
}

/// A line by what the treads of a flight have in common.
struct Rung {
    index: usize,
    offset: f64,
    middle: f64,
    length: f64,
}

impl Rung {
    fn new(index: usize, line: &Straight, along: DVec2) -> Self {
        let middle = (line.a + line.b) / 2.0;
        Self { index, offset: along.perp().dot(middle), middle: along.dot(middle), length: line.length() }
    }

    /// Whether another may follow it: both end on one string, and a line where the flight is cut shortens no tread to
    /// less than [`CUT_SHARE`] of the one before.
    fn is_like(&self, other: &Self) -> bool {
        let (short, long) = (self.length.min(other.length), self.length.max(other.length));
        let slack = LIKE_SHARE * long;
        let apart = |end: f64| {
            (self.middle + end * self.length / 2.0 - other.middle - end * other.length / 2.0).abs() <= slack
        };
        short >= CUT_SHARE * long && (apart(-1.0) || apart(1.0))
    }
}

fn rows(rungs: &[Rung], along: DVec2) -> Vec<Flight> {
    let mut is_taken = vec![false; rungs.len()];
    let next = |i: usize, is_taken: &[bool], going: Option<f64>| {
        let ahead = (i + 1..rungs.len()).take_while(|j| *j <= i + LOOK_MAX);
        let fits = |j: &usize| {
            let g = rungs[*j].offset - rungs[i].offset;
            let is_going = match going {
                Some(h) => (g - h).abs() <= GOING_SLACK_M.max(GOING_SHARE * h),
                None => (GOING_M[0]..=GOING_M[1]).contains(&g),
            };
            is_going && !is_taken[*j] && rungs[i].is_like(&rungs[*j])
        };
        ahead.filter(fits).min_by(|j, k| rungs[*j].offset.total_cmp(&rungs[*k].offset))
    };
    let mut out = Vec::new();
    for first in 0..rungs.len() {
        let Some(second) = (!is_taken[first]).then(|| next(first, &is_taken, None)).flatten() else {
            continue;
        };
        let going = rungs[second].offset - rungs[first].offset;
        let mut row = vec![first, second];
        while let Some(j) = next(row[row.len() - 1], &is_taken, Some(going)) {
            row.push(j);
        }
        if row.len() >= TREADS_BESIDE_MIN {
            row.iter().for_each(|r| is_taken[*r] = true);
            out.push(Flight { treads: row.iter().map(|r| rungs[*r].index).collect(), going, along });
        }
    }
    out
}

/// A flight fills its well, so the wall at its end stands where the next tread would: it has a second face behind it.
fn end_at_walls(lines: &[Straight], flight: &mut Flight, is_stair: &mut [bool]) {
    // Of a wall that stands behind the last tread the face beside it has one of its own, and nearer. A jamb is no face.
    let is_wall = |t: &usize| {
        let behind = face_beside(lines, *t, is_stair, lines[*t].length() / 2.0);
        behind
            .is_some_and(|(face, d)| face_beside(lines, face, is_stair, 0.0).is_none_or(|(_, own)| own >= d))
    };
    let (first, last) =
        (flight.treads.first().is_some_and(is_wall), flight.treads.last().is_some_and(is_wall));
    let walls = [first.then(|| flight.treads.remove(0)), last.then(|| flight.treads.pop()).flatten()];
    walls.into_iter().flatten().for_each(|t| is_stair[t] = false);
}

/// The box of a flight along and across its treads, as seen in the frame of `along`.
fn box_in(lines: &[Straight], flight: &Flight, along: DVec2) -> [DVec2; 2] {
    let local = |p: DVec2| DVec2::new(p.dot(along), p.dot(along.perp()));
    let ends = flight.treads.iter().flat_map(|t| [lines[*t].a, lines[*t].b]);
    ends.map(local).fold([DVec2::MAX, DVec2::MIN], |[lo, hi], p| [lo.min(p), hi.max(p)])
}

fn is_beside(lines: &[Straight], f: &Flight, g: &Flight) -> bool {
    let ([alo, ahi], [blo, bhi]) = (box_in(lines, f, g.along), box_in(lines, g, g.along));
    let gap = (alo - bhi).max(blo - ahi).max(DVec2::ZERO).length();
    (f.going - g.going).abs() <= GOING_SLACK_M.max(GOING_SHARE * g.going) && gap <= BESIDE_M
}

/// What else of a stair is drawn: lines inside the box of its flights that are no face of a wall, and
/// the line on which treads end from both sides.
fn within(lines: &[Straight], flight: &Flight, all: &[Flight], is_stair: &[bool]) -> Vec<usize> {
    let along = flight.along;
    let near = all.iter().filter(|g| is_beside(lines, g, flight) || std::ptr::eq(*g, flight));
    let near: Vec<&Flight> = near.collect();
    let boxes = near.iter().map(|g| box_in(lines, g, along));
    let [lo, hi] = boxes.fold([DVec2::MAX, DVec2::MIN], |[lo, hi], b| [lo.min(b[0]), hi.max(b[1])]);
    let local = |p: DVec2| DVec2::new(p.dot(along), p.dot(along.perp()));
    let is_in = |p: DVec2, slack: f64| {
        let q = local(p);
        q.cmpge(lo - slack).all() && q.cmple(hi + slack).all()
    };
    let is_inside = |line: &Straight, slack: f64| is_in(line.a, slack) && is_in(line.b, slack);
    let is_more = |i: &usize| {
        let line = &lines[*i];
        // What is short may be a jamb, unless it lies well among the treads: the head of an arrow.
        let is_part = is_inside(line, -ERROR_GAP_M)
            || line.length() >= PART_MIN_M && is_inside(line, flight.going / 2.0);
        let is_long = line.length() >= PART_MIN_M;
        !is_stair[*i]
            && (is_part && face_beside(lines, *i, is_stair, 0.0).is_none()
                || is_long && (is_string(lines, line, &near) || crossed(lines, line, &near) >= CROSSED_MIN))
    };
    (0..lines.len()).filter(is_more).collect()
}

/// The nearest line that is no tread, is longer than `least`, and runs beside a line at a wall's thickness, and how far
/// from it.
fn face_beside(lines: &[Straight], i: usize, is_stair: &[bool], least: f64) -> Option<(usize, f64)> {
    let line = &lines[i];
    let (length, u) = (line.length(), (line.b - line.a).normalize_or_zero());
    let face = |(j, other): (usize, &Straight)| {
        let v = (other.b - other.a).normalize_or_zero();
        let (s, t) = ((other.a - line.a).dot(u), (other.b - line.a).dot(u));
        let shared = s.max(t).min(length) - s.min(t).max(0.0);
        let apart = u.perp_dot(other.a - line.a).abs();
        let is_face = j != i
            && !is_stair[j]
            && other.length() > least
            && u.perp_dot(v).abs() < 4.0 * PARALLEL_RAD
            && (THICKNESS_MIN_M..=LAYERED_MAX_M).contains(&apart)
            && shared > 0.5 * length.min(other.length());
        is_face.then_some((j, apart))
    };
    lines.iter().enumerate().filter_map(face).min_by(|a, b| a.1.total_cmp(&b.1))
}

/// How many treads a line runs through.
fn crossed(lines: &[Straight], line: &Straight, flights: &[&Flight]) -> usize {
    let through = |p: DVec2, q: DVec2, a: DVec2, b: DVec2| {
        let u = (q - p).normalize_or_zero();
        let (s, t) = (u.perp_dot(a - p), u.perp_dot(b - p));
        s.min(t) < -ERROR_GAP_M && s.max(t) > ERROR_GAP_M
    };
    let treads = flights.iter().flat_map(|f| &f.treads).map(|t| &lines[*t]);
    treads.filter(|t| through(t.a, t.b, line.a, line.b) && through(line.a, line.b, t.a, t.b)).count()
}

/// Whether treads of two flights end on a line from both sides.
fn is_string(lines: &[Straight], line: &Straight, flights: &[&Flight]) -> bool {
    let (length, u) = (line.length(), (line.b - line.a).normalize_or_zero());
    let mut sides = [0usize; 2];
    for tread in flights.iter().flat_map(|f| &f.treads).map(|t| &lines[*t]) {
        for (end, other) in [(tread.a, tread.b), (tread.b, tread.a)] {
            let s = (end - line.a).dot(u);
            let is_on = u.perp_dot(end - line.a).abs() <= ERROR_GAP_M
                && (-ERROR_GAP_M..=length + ERROR_GAP_M).contains(&s);
            if is_on && (tread.b - tread.a).normalize_or_zero().dot(u).abs() < 0.5 {
                sides[usize::from(u.perp_dot(other - line.a) > 0.0)] += 1;
            }
        }
    }
    sides.iter().all(|n| *n + 1 >= TREADS_BESIDE_MIN)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(x0: f64, y0: f64, x1: f64, y1: f64) -> Straight {
        Straight { entity: 0, a: DVec2::new(x0, y0), b: DVec2::new(x1, y1) }
    }

    /// A stair of two flights with a string and two winders in a well of walls 0.15 m thick.
    fn stair() -> (Vec<Straight>, usize) {
        let mut lines = vec![
            line(0.0, -1.0, 0.0, 5.0),
            line(-0.15, -1.0, -0.15, 5.0),
            line(2.0, -1.0, 2.0, 5.0),
            line(2.15, -1.0, 2.15, 5.0),
            line(0.0, -0.1, 2.0, -0.1),
            line(0.0, -0.25, 2.0, -0.25),
            line(-0.15, 1.0, 0.0, 1.0),
        ];
        let walls = lines.len();
        lines.extend((0..9).map(|i| line(1.0, 0.1 + 0.28 * f64::from(i), 2.0, 0.1 + 0.28 * f64::from(i))));
        lines.extend((3..6).map(|i| line(0.0, 0.1 + 0.28 * f64::from(i), 1.0, 0.1 + 0.28 * f64::from(i))));
        lines.extend([line(1.5, 0.0, 1.5, 3.1), line(1.5, 2.2, 1.6, 2.0)]);
        lines.extend([line(1.0, 0.9, 1.0, 3.2), line(1.0, 0.9, 0.0, 0.4), line(1.0, 0.9, 0.4, 0.0)]);
        (lines, walls)
    }

    #[test]
    fn a_stair_is_found_and_its_walls_are_none() {
        let (lines, walls) = stair();
        let turned = |t: f64| -> Vec<Straight> {
            let turn = |p: DVec2| DVec2::from_angle(t).rotate(p) + DVec2::new(3.0, 7.0);
            lines.iter().map(|l| Straight { a: turn(l.a), b: turn(l.b), ..*l }).collect()
        };
        for t in [0.0, 0.17, 1.3, std::f64::consts::FRAC_PI_2] {
            assert_eq!(find(&turned(t)), (walls..lines.len()).collect::<Vec<_>>(), "turned by {t}");
        }
    }

    #[test]
    fn walls_side_by_side_are_no_stair() {
        let walls: Vec<Straight> = [0.0, 0.3, 3.0, 3.3, 6.0, 6.3].map(|y| line(0.0, y, 4.0, y)).to_vec();
        assert!(find(&walls).is_empty());
        let layers: Vec<Straight> = [0.0, 0.1, 0.16, 0.4, 0.415].map(|y| line(0.0, y, 4.0, y)).to_vec();
        assert!(find(&layers).is_empty());
    }
}

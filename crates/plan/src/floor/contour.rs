//! Outlines of parts of a raster, put back onto the lines by which the parts were bounded.

use enfilade_cad::plane::ring_area;
use std::collections::HashMap;

use glam::DVec2;

/// Corners of a traced outline nearer to its sides than this are none, pixels.
const SMOOTH_PX: f64 = 1.2;

/// A side lies on a line that runs so near to it, pixels, and at most so askew (sine; of short sides).
const NEAR_PX: f64 = 2.5;
const ASKEW: f64 = 0.15;
const ASKEW_SHORT: f64 = 0.5;

/// Sides shorter than this are short, pixels; without a line of their own they are where two others meet.
const SHORT_PX: f64 = 4.0;
const NO_SIDE_PX: f64 = 2.5;

/// Two sides are one if they turn less than this (sine) and lie so near, pixels.
const SAME_SIN: f64 = 0.02;
const SAME_PX: f64 = 0.7;

/// Where two sides meet farther from the traced corner than this, pixels, they are joined by a third.
const MEET_PX: f64 = 6.0;

/// Most by which putting sides onto lines may change the area, pixels for each pixel of the outline; beyond it the traced
/// outline stands.
const OFF_PX: f64 = 1.5;

/// A grid of pixels: `part` of each (0: none) and the line drawn through it (0: none, else its index + 1).
pub struct Traced<'a> {
    /// Pixels up; pixel `c * rows + r`.
    pub rows: usize,
    /// Part of every pixel.
    pub part: &'a [u32],
    /// Line through every pixel.
    pub line: &'a [u32],
    /// The lines, pixels.
    pub lines: &'a [[DVec2; 2]],
}

/// Outline of one part, pixels: rings anticlockwise outside and clockwise round holes.
pub type Rings = Vec<Vec<DVec2>>;

/// A side of a pixel at the edge of its part, the part to the left, with the line beyond it.
#[derive(Clone, Copy)]
struct Step {
    from: [i32; 2],
    towards: u8,
    line: u32,
}

/// East, north, west, south.
const TOWARDS: [[i32; 2]; 4] = [[1, 0], [0, 1], [-1, 0], [0, -1]];

impl Step {
    fn to(&self) -> [i32; 2] {
        let [x, y] = TOWARDS[usize::from(self.towards)];
        [self.from[0] + x, self.from[1] + y]
    }
}

/// The outlines of all parts, by part − 1.
pub fn outlines(traced: &Traced<'_>, parts: usize) -> Vec<Rings> {
    let mut steps: Vec<Vec<Step>> = vec![Vec::new(); parts];
    let (rows, cols) = (traced.rows as i32, (traced.part.len() / traced.rows.max(1)) as i32);
    let at = |c: i32, r: i32| {
        let is_in = (0..cols).contains(&c) && (0..rows).contains(&r);
        is_in.then(|| (c * rows + r) as usize)
    };
    for (i, part) in traced.part.iter().enumerate().filter(|(_, part)| **part > 0) {
        let (c, r) = (i as i32 / rows, i as i32 % rows);
        let sides = [
            ([c, r], [c, r - 1]),
            ([c + 1, r], [c + 1, r]),
            ([c + 1, r + 1], [c, r + 1]),
            ([c, r + 1], [c - 1, r]),
        ];
        for (towards, (from, beyond)) in sides.into_iter().enumerate() {
            let other = at(beyond[0], beyond[1]);
            if other.is_none_or(|j| traced.part[j] != *part) {
                let line = other.map_or(0, |j| traced.line[j]);
                steps[*part as usize - 1].push(Step { from, towards: towards as u8, line });
            }
        }
    }
    steps
        .into_iter()
        .map(|of_one| rings(of_one).iter().map(|ring| snapped(ring, traced.lines)).collect())
        .collect()
}

/// Chains the sides of pixels; where four meet, the way keeps to its own pixel.
fn rings(steps: Vec<Step>) -> Vec<Vec<Step>> {
    let mut leaving: HashMap<[i32; 2], Vec<usize>> = HashMap::new();
    for (k, step) in steps.iter().enumerate() {
        leaving.entry(step.from).or_default().push(k);
    }
    let mut is_used = vec![false; steps.len()];
    let mut out = Vec::new();
    for start in 0..steps.len() {
        let (mut ring, mut next) = (Vec::new(), Some(start));
        while let Some(k) = next.filter(|k| !is_used[*k]) {
            is_used[k] = true;
            ring.push(steps[k]);
            let open = leaving.get(&steps[k].to()).into_iter().flatten().filter(|j| !is_used[**j]);
            let left = (steps[k].towards + 1) % 4;
            next = open.copied().min_by_key(|j| steps[*j].towards != left);
        }
        if ring.len() > 2 {
            out.push(ring);
        }
    }
    out
}

/// One side of a polygon: on which line it lies, and where it was traced.
#[derive(Clone, Copy)]
struct Side {
    at: DVec2,
    along: DVec2,
    traced: [DVec2; 2],
    is_on_line: bool,
}

impl Side {
    fn off(&self, p: DVec2) -> f64 {
        self.along.perp_dot(p - self.at)
    }

    fn foot(&self, p: DVec2) -> DVec2 {
        p - self.along.perp() * self.off(p)
    }

    fn is_same(&self, other: &Self) -> bool {
        self.along.perp_dot(other.along).abs() < SAME_SIN
            && self.along.dot(other.along) > 0.0
            && self.off(other.at).abs() < SAME_PX
    }
}

fn snapped(ring: &[Step], lines: &[[DVec2; 2]]) -> Vec<DVec2> {
    let points: Vec<DVec2> =
        ring.iter().map(|s| DVec2::new(f64::from(s.from[0]), f64::from(s.from[1]))).collect();
    let corners = smoothed(&points);
    let plain: Vec<DVec2> = corners.iter().map(|k| points[*k]).collect();
    let mut sides: Vec<Side> = Vec::new();
    for (n, from) in corners.iter().enumerate() {
        let to = corners[(n + 1) % corners.len()];
        let count = (to + ring.len() - from) % ring.len();
        let steps = (0..count).map(|k| &ring[(from + k) % ring.len()]);
        let side = side([points[*from], points[to]], steps, lines);
        match sides.last_mut().filter(|last| last.is_same(&side)) {
            Some(last) => last.traced[1] = side.traced[1],
            None => sides.push(side),
        }
    }
    if let [first, .., last] = &sides[..]
        && last.is_same(first)
    {
        let from = last.traced[0];
        sides.pop();
        sides[0].traced[0] = from;
    }
    let all = sides.len();
    let is_kept = |s: &Side| s.is_on_line || s.traced[0].distance(s.traced[1]) >= NO_SIDE_PX;
    let kept: Vec<Side> = sides.into_iter().filter(|s| all < 4 || is_kept(s)).collect();
    if kept.len() < 3 {
        return plain;
    }
    let out: Vec<DVec2> =
        (0..kept.len()).flat_map(|k| meeting(&kept[k], &kept[(k + 1) % kept.len()])).collect();
    if (ring_area(&out) - ring_area(&plain)).abs() > OFF_PX * ring.len() as f64 { plain } else { out }
}

/// The side between two corners, on the line that most of it runs along.
fn side<'s>(traced: [DVec2; 2], steps: impl Iterator<Item = &'s Step>, lines: &[[DVec2; 2]]) -> Side {
    let (mut votes, along) = (HashMap::<u32, usize>::new(), (traced[1] - traced[0]).normalize_or_zero());
    steps.filter(|s| s.line > 0).for_each(|s| *votes.entry(s.line - 1).or_default() += 1);
    let length = traced[0].distance(traced[1]);
    let askew = if length < SHORT_PX { ASKEW_SHORT } else { ASKEW };
    let middle = traced[0].midpoint(traced[1]);
    let on = |line: u32| {
        let [a, b] = lines[line as usize];
        let mut direction = (b - a).normalize_or_zero();
        if direction.dot(along) < 0.0 {
            direction = -direction;
        }
        let side = Side { at: a, along: direction, traced, is_on_line: true };
        let is_so = direction != DVec2::ZERO
            && direction.perp_dot(along).abs() <= askew
            && side.off(middle).abs() <= NEAR_PX;
        is_so.then_some(side)
    };
    let best = votes.iter().filter_map(|(line, n)| Some((on(*line)?, *n, *line)));
    // Of equals the first line, so that the outcome is the same every time.
    let best = best.max_by_key(|(_, n, line)| (*n, std::cmp::Reverse(*line)));
    best.map_or(Side { at: traced[0], along, traced, is_on_line: false }, |b| b.0)
}

/// Where two sides meet: one corner, or two where they run nearly the same way.
fn meeting(one: &Side, next: &Side) -> Vec<DVec2> {
    let corner = one.traced[1].midpoint(next.traced[0]);
    let sine = one.along.perp_dot(next.along);
    if sine.abs() > ASKEW / 2.0 {
        let p = one.at + one.along * (next.along.perp_dot(one.at - next.at) / sine);
        if p.distance(corner) <= MEET_PX {
            return vec![p];
        }
    }
    vec![one.foot(one.traced[1]), next.foot(next.traced[0])]
}

/// Indices of the corners that are left when steps of pixels are smoothed (Douglas & Peucker 1973), ascending.
fn smoothed(points: &[DVec2]) -> Vec<usize> {
    let far_from = |p: DVec2| {
        let distances = points.iter().map(|q| q.distance_squared(p));
        distances.enumerate().max_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |m| m.0)
    };
    let first = far_from(points[0]);
    let second = far_from(points[first]);
    let (lo, hi) = (first.min(second), first.max(second));
    let mut kept = vec![lo, hi];
    let mut open = vec![(lo, hi), (hi, lo + points.len())];
    while let Some((from, to)) = open.pop() {
        let at = |k: usize| points[k % points.len()];
        let off = |k: usize| enfilade_cad::plane::distance_to_segment(at(k), [at(from), at(to)]);
        let worst = (from + 1..to).map(|k| (k, off(k))).max_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((k, _)) = worst.filter(|w| w.1 > SMOOTH_PX) {
            kept.push(k % points.len());
            open.extend([(from, k), (k, to)]);
        }
    }
    kept.sort_unstable();
    kept.dedup();
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A room of 40 × 30 pixels with a column in it, all lines a third of a pixel off the raster.
    #[test]
    fn sides_lie_on_the_lines_and_holes_turn_the_other_way() {
        let (cols, rows) = (60, 50);
        let ring = |x0: f64, y0: f64, x1: f64, y1: f64| {
            let at = [[x0, y0], [x1, y0], [x1, y1], [x0, y1]].map(DVec2::from);
            [0, 1, 2, 3].map(|k| [at[k], at[(k + 1) % 4]])
        };
        let lines = [ring(5.3, 6.3, 45.3, 36.3), ring(20.3, 15.3, 26.3, 21.3)].concat();
        let mut line = vec![0; cols * rows];
        for (k, [a, b]) in lines.iter().enumerate() {
            for t in 0..=200 {
                let p = a.lerp(*b, f64::from(t) / 200.0);
                line[p.x as usize * rows + p.y as usize] = k as u32 + 1;
            }
        }
        let is_in = |i: usize, lo: [usize; 2], hi: [usize; 2]| {
            let (c, r) = (i / rows, i % rows);
            (lo[0]..=hi[0]).contains(&c) && (lo[1]..=hi[1]).contains(&r)
        };
        let part =
            |i: usize| u32::from(line[i] == 0 && is_in(i, [6, 7], [44, 35]) && !is_in(i, [20, 15], [26, 21]));
        let part: Vec<u32> = (0..cols * rows).map(part).collect();
        let found = outlines(&Traced { rows, part: &part, line: &line, lines: &lines }, 1);
        let mut areas: Vec<f64> = found[0].iter().map(|r| ring_area(r)).collect();
        areas.sort_by(f64::total_cmp);
        assert_eq!(found[0].iter().map(Vec::len).collect::<Vec<_>>(), [4, 4]);
        assert!((areas[0] + 36.0).abs() < 1e-9 && (areas[1] - 1200.0).abs() < 1e-9, "{areas:?}");
    }
}

//! Curves that were traced by chords: arcs fitted to chains of short pieces.

use std::collections::HashSet;

use glam::DVec2;

use super::carrier::Carrier;
use super::near::{Buckets, Squares};
use super::offset::{Chord, Guides};
use super::runs::Loose;
use super::spans::{self, Span};
use super::{Drawn, Path};
use crate::sizes::{
    CHORD_MAX_M, CHORD_TURN_MAX_RAD, CIRCLE_FIT_M, COLLINEAR_M, OPENING_MAX_M, SAGITTA_MAX_M, ZERO_M,
};

/// Fewest chords of a curve; three of equal turn may be a bay window.
const CHORDS_MIN: usize = 4;
/// Two chords that turn less than this are one chord that was split.
const STRAIGHT_RAD: f64 = 0.004;
/// Largest radius of a wall.
const RADIUS_MAX_M: f64 = 300.0;

/// Turns faces into loose pieces, chains of chords into arcs. `faces` are indices of [`Drawn::faces`].
pub fn find(drawn: &Drawn, faces: Vec<u32>) -> Vec<Loose> {
    let mut out = Vec::new();
    let mut chords: Vec<Chord> = Vec::new();
    for f in faces {
        let path = &drawn.faces[f as usize].path;
        match path {
            Path::Line { a, b } if (ZERO_M..CHORD_MAX_M).contains(&a.distance(*b)) => {
                chords.push((f, [*a, *b]))
            }
            _ if path.length_m() <= ZERO_M => {
                let end = path.ends()[0];
                let carrier = Carrier::Line { origin: end, dir: DVec2::X };
                out.push(Loose { faces: vec![f], carrier, span: [0.0, 0.0] });
            }
            _ => {
                let (carrier, span) = Carrier::of(path);
                out.push(Loose { faces: vec![f], carrier, span });
            }
        }
    }
    let mut used = vec![false; chords.len()];
    let mut guides = Guides::new();
    for chain in longest_first(&chords, chains(&chords)) {
        let fitted = fit_chain(&chords, &chain);
        let pieces = with_chords(&chords, &chain, &fitted);
        let cut = guides.follow(&stretched(&chords, &chain), &pieces);
        guides.add(cut.as_ref().unwrap_or(&pieces));
        let kept = cut.unwrap_or(fitted);
        let taken: HashSet<u32> = kept.iter().flat_map(|l| l.faces.iter().copied()).collect();
        chain.iter().filter(|s| taken.contains(&chords[s.0].0)).for_each(|s| used[s.0] = true);
        out.extend(kept);
    }
    adopt(&chords, &mut used, &mut out);
    for ((f, [a, b]), _) in chords.iter().zip(&used).filter(|(_, used)| !**used) {
        out.push(Loose { faces: vec![*f], carrier: Carrier::line(*a, *b), span: [0.0, a.distance(*b)] });
    }
    out
}

/// Chains by their length, in an order that their numbers do not change.
fn longest_first(chords: &[Chord], mut chains: Vec<Vec<Step>>) -> Vec<Vec<Step>> {
    let length = |chain: &Vec<Step>| {
        spans::tidy(chain.iter().map(|s| chords[s.0].1[0].distance(chords[s.0].1[1])).sum::<f64>())
    };
    let place = |chain: &Vec<Step>| {
        let at = chain.iter().flat_map(|s| chords[s.0].1).reduce(DVec2::min).unwrap_or_default();
        [at.x, at.y].map(spans::tidy)
    };
    chains.sort_by(|a, b| {
        let [p, q] = [a, b].map(place);
        length(b).total_cmp(&length(a)).then(p[0].total_cmp(&q[0])).then(p[1].total_cmp(&q[1]))
    });
    chains
}

/// The chords of a chain in its direction.
fn stretched(chords: &[Chord], chain: &[Step]) -> Vec<Chord> {
    chain.iter().map(|s| (chords[s.0].0, [0, 1].map(|end| point(chords, *s, end)))).collect()
}

/// Arcs of a chain, and its other chords each for itself.
fn with_chords(chords: &[Chord], chain: &[Step], arcs: &[Loose]) -> Vec<Loose> {
    let taken: HashSet<u32> = arcs.iter().flat_map(|l| l.faces.iter().copied()).collect();
    let rest = chain.iter().map(|s| &chords[s.0]).filter(|c| !taken.contains(&c.0));
    let straight = rest.map(|(f, [a, b])| Loose {
        faces: vec![*f],
        carrier: Carrier::line(*a, *b),
        span: [0.0, a.distance(*b)],
    });
    arcs.iter().cloned().chain(straight).collect()
}

/// Chords too few for a circle of their own that lie on one that was found: the rest of a wall beyond a
/// window.
fn adopt(chords: &[Chord], used: &mut [bool], out: &mut Vec<Loose>) {
    let circles: Vec<(Carrier, Span)> =
        out.iter().filter(|l| l.faces.len() >= CHORDS_MIN).map(|l| (l.carrier, l.span)).collect();
    let mut places = Buckets::new(CHORD_MAX_M);
    for (c, (_, [a, b])) in chords.iter().enumerate() {
        places.add(c as u32, &[a.midpoint(*b)]);
    }
    for (carrier, span) in circles {
        let Carrier::Circle { centre, radius, .. } = carrier else { continue };
        let half_turn = std::f64::consts::PI * radius;
        let around = [(span[0] - OPENING_MAX_M).max(-half_turn), (span[1] + OPENING_MAX_M).min(half_turn)];
        for c in places.along(&carrier.points(around), CHORD_MAX_M / 2.0) {
            let c = c as usize;
            let (f, [a, b]) = &chords[c];
            let sagitta = carrier.offset_of(a.midpoint(*b));
            if used[c]
                || [a, b].iter().any(|p| carrier.offset_of(**p).abs() > COLLINEAR_M)
                || !(-SAGITTA_MAX_M..=0.0).contains(&sagitta)
            {
                continue;
            }
            used[c] = true;
            out.push(arc_of([centre.x, centre.y, radius], &[(*a, 0), (*b, 1)], vec![*f]));
        }
    }
}

/// A step of a chain: which chord, and whether it is walked from its second end.
type Step = (usize, bool);

fn point(chords: &[Chord], (c, turned): Step, end: usize) -> DVec2 {
    chords[c].1[if turned { 1 - end } else { end }]
}

/// Ends of chords by place.
struct Ends<'a> {
    chords: &'a [Chord],
    squares: Squares<(usize, usize)>,
}

impl<'a> Ends<'a> {
    fn key(p: DVec2) -> [i64; 2] {
        [(p.x / COLLINEAR_M).floor() as i64, (p.y / COLLINEAR_M).floor() as i64]
    }

    fn new(chords: &'a [Chord]) -> Self {
        let mut squares: Squares<(usize, usize)> = Squares::default();
        for (i, (_, ends)) in chords.iter().enumerate() {
            for (e, p) in ends.iter().enumerate() {
                squares.entry(Self::key(*p)).or_default().push((i, e));
            }
        }
        Self { chords, squares }
    }

    /// The step that goes on from the end of `step` with a small turn, if it is the only one.
    fn next(&self, step: Step) -> Option<Step> {
        let (from, to) = (point(self.chords, step, 0), point(self.chords, step, 1));
        let k = Self::key(to);
        let mut found: Option<Step> = None;
        for dx in -1..=1 {
            for dy in -1..=1 {
                for (c, e) in self.squares.get(&[k[0] + dx, k[1] + dy]).into_iter().flatten() {
                    let ends = self.chords[*c].1;
                    if *c == step.0 || ends[*e].distance(to) > COLLINEAR_M {
                        continue;
                    }
                    let far = ends[1 - *e];
                    let is_twin = far.distance(from) <= COLLINEAR_M;
                    let turn = (to - from).angle_to(far - to).abs();
                    if is_twin || turn > CHORD_TURN_MAX_RAD {
                        continue;
                    }
                    let is_same =
                        found.is_some_and(|s| point(self.chords, s, 1).distance(far) <= COLLINEAR_M);
                    if is_same {
                        continue;
                    }
                    if found.is_some() {
                        return None;
                    }
                    found = Some((*c, *e == 1));
                }
            }
        }
        found
    }
}

/// Chains of chords that turn little from one to the next.
fn chains(chords: &[Chord]) -> Vec<Vec<Step>> {
    let ends = Ends::new(chords);
    let mut seen = vec![false; chords.len()];
    let mut out = Vec::new();
    for start in 0..chords.len() {
        if seen[start] {
            continue;
        }
        seen[start] = true;
        let mut back = walk(&ends, (start, true), &mut seen);
        back.reverse();
        let mut chain: Vec<Step> = back.into_iter().map(|(c, turned)| (c, !turned)).collect();
        chain.push((start, false));
        chain.extend(walk(&ends, (start, false), &mut seen));
        if chain.len() >= CHORDS_MIN {
            out.push(chain);
        }
    }
    out
}

fn walk(ends: &Ends<'_>, from: Step, seen: &mut [bool]) -> Vec<Step> {
    let mut out = Vec::new();
    let mut at = from;
    while let Some(next) = ends.next(at) {
        if seen[next.0] {
            break;
        }
        seen[next.0] = true;
        out.push(next);
        at = next;
    }
    out
}

/// Cuts a chain into the longest arcs that fit.
fn fit_chain(chords: &[Chord], chain: &[Step]) -> Vec<Loose> {
    let mut out = Vec::new();
    let mut corners: Vec<(DVec2, usize)> = vec![(point(chords, chain[0], 0), 0)];
    for (k, pair) in chain.windows(2).enumerate() {
        let [u, v] = [pair[0], pair[1]].map(|s| point(chords, s, 1) - point(chords, s, 0));
        if u.angle_to(v).abs() > STRAIGHT_RAD {
            corners.push((point(chords, pair[0], 1), k + 1));
        }
    }
    corners.push((point(chords, chain[chain.len() - 1], 1), chain.len()));
    let mut i = 0;
    while i + CHORDS_MIN < corners.len() {
        let Some((carrier, n)) = longest_arc(&corners[i..]) else {
            i += 1;
            continue;
        };
        let steps = &chain[corners[i].1..corners[i + n].1];
        let faces = steps.iter().map(|s| chords[s.0].0).collect();
        out.push(arc_of(carrier, &corners[i..=i + n], faces));
        i += n;
    }
    out
}

/// The circle through the most corners from the first one on, and how many chords it takes.
fn longest_arc(corners: &[(DVec2, usize)]) -> Option<([f64; 3], usize)> {
    let mut best = None;
    let mut n = CHORDS_MIN;
    while n < corners.len() {
        match circle_of(&corners[..=n]) {
            Some(circle) => best = Some((circle, n)),
            None => break,
        }
        n += 1;
    }
    best
}

/// Circle through first, middle and last corner if all corners and chords lie near it.
fn circle_of(corners: &[(DVec2, usize)]) -> Option<[f64; 3]> {
    let (a, b, c) = (corners[0].0, corners[corners.len() / 2].0, corners[corners.len() - 1].0);
    let closed = a.distance(c) <= COLLINEAR_M;
    let c = if closed { corners[corners.len() / 4].0 } else { c };
    let (u, v) = (b - a, c - a);
    let d = 2.0 * u.perp_dot(v);
    if d.abs() < 1e-12 {
        return None;
    }
    let w = DVec2::new(
        v.y * u.length_squared() - u.y * v.length_squared(),
        u.x * v.length_squared() - v.x * u.length_squared(),
    ) / d;
    let (centre, radius) = (a + w, w.length());
    let fits = |p: DVec2, tolerance: f64| (p.distance(centre) - radius).abs() <= tolerance;
    let near = corners.iter().all(|(p, _)| fits(*p, CIRCLE_FIT_M))
        && corners.windows(2).all(|p| fits(p[0].0.midpoint(p[1].0), SAGITTA_MAX_M));
    let turn: f64 = corners.windows(3).map(|p| (p[1].0 - p[0].0).angle_to(p[2].0 - p[1].0)).sum();
    (near && radius < RADIUS_MAX_M && turn.abs() > 0.05).then_some([centre.x, centre.y, radius])
}

fn arc_of([x, y, radius]: [f64; 3], corners: &[(DVec2, usize)], faces: Vec<u32>) -> Loose {
    let centre = DVec2::new(x, y);
    let sweep: f64 = corners.windows(2).map(|p| (p[0].0 - centre).angle_to(p[1].0 - centre)).sum();
    let start = (corners[0].0 - centre).to_angle();
    let start_rad = if sweep < 0.0 { start + sweep } else { start };
    let (carrier, span) = Carrier::of(&Path::Arc { centre, radius, start_rad, sweep_rad: sweep.abs() });
    Loose { faces, carrier, span }
}

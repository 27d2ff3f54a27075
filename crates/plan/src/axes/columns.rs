//! Columns: small closed boxes and circles, whether drawn as one shape or as four lines.

use std::collections::BTreeMap;

use glam::DVec2;

use super::near::Buckets;
use super::{AxisGraph, Drawn, FaceRef, Path, Role};
use crate::sizes::{COLLINEAR_M, COLUMN_ASPECT_MAX, COLUMN_MAX_M, ERROR_GAP_M, ZERO_M};

/// How much of its box a column fills that nobody calls one; crosses and steel profiles fill less.
const FILL_MIN: f64 = 0.5;
/// Points by which a round column is given.
const ROUND_POINTS: usize = 24;
/// Most pieces of an outline: four sides and four cut or rounded corners.
const PIECES_MAX: usize = 8;
/// Largest radius of a rounded corner; larger arcs are leaves of doors.
const CORNER_RADIUS_MAX_M: f64 = 0.3;

/// A column.
#[derive(Clone, Debug)]
pub struct Column {
    pub centre: DVec2,
    pub ring: Vec<DVec2>,
    pub faces: Vec<FaceRef>,
}

/// Takes the columns out of the drawn faces; gives the indices of the other faces.
pub fn take(drawn: &Drawn, _out: &mut AxisGraph) -> (Vec<Column>, Vec<u32>) {
    let mut shapes: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for (i, f) in drawn.faces.iter().enumerate() {
        if f.is_closed {
            shapes.entry(f.wall).or_default().push(i as u32);
        }
    }
    let mut is_taken = vec![false; drawn.faces.len()];
    let mut out: Vec<Column> = Vec::new();
    for faces in shapes.values() {
        let Some(column) = column_of(drawn, faces) else { continue };
        faces.iter().for_each(|f| is_taken[*f as usize] = true);
        add(&mut out, column);
    }
    for (faces, twins) in boxes_of_lines(drawn, &is_taken) {
        let Some(mut column) = column_of(drawn, &faces) else { continue };
        column
            .faces
            .extend(twins.iter().map(|f| (drawn.faces[*f as usize].wall, drawn.faces[*f as usize].part)));
        faces.iter().chain(&twins).for_each(|f| is_taken[*f as usize] = true);
        add(&mut out, column);
    }
    let rest = (0..drawn.faces.len() as u32).filter(|f| !is_taken[*f as usize]).collect();
    (out, rest)
}

/// Adds a column, or its faces to the same column drawn twice.
fn add(all: &mut Vec<Column>, column: Column) {
    match all.iter_mut().find(|c| c.centre.distance(column.centre) < ERROR_GAP_M) {
        Some(twin) => twin.faces.extend(column.faces),
        None => all.push(column),
    }
}

/// The column that closed faces draw, in ring order, if they do.
fn column_of(drawn: &Drawn, faces: &[u32]) -> Option<Column> {
    let all = || faces.iter().map(|f| &drawn.faces[*f as usize]);
    let refs = all().map(|f| (f.wall, f.part)).collect();
    if let (1, Some(Path::Arc { centre, radius, .. })) = (faces.len(), all().next().map(|f| f.path)) {
        let ring = |k: usize| {
            let t = std::f64::consts::TAU * k as f64 / ROUND_POINTS as f64;
            centre + DVec2::from_angle(t) * radius
        };
        let ring = (0..ROUND_POINTS).map(ring).collect();
        return (2.0 * radius <= COLUMN_MAX_M).then_some(Column { centre, ring, faces: refs });
    }
    let ring = ring_of(all().map(|f| f.path.ends()).collect())?;
    let (centre, area) = centroid(&ring)?;
    let (long, short) = box_of(&ring)?;
    let said = all().any(|f| f.role == Role::Column);
    let slim = if said { 3.0 * COLUMN_ASPECT_MAX } else { COLUMN_ASPECT_MAX };
    let is_full = said || area >= FILL_MIN * long * short;
    let is_column = long <= COLUMN_MAX_M && long <= slim * short && is_full;
    is_column.then_some(Column { centre, ring, faces: refs })
}

/// Corners in order from pieces in order, each in any direction.
fn ring_of(pieces: Vec<[DVec2; 2]>) -> Option<Vec<DVec2>> {
    let pieces: Vec<[DVec2; 2]> = pieces.into_iter().filter(|p| p[0].distance(p[1]) > ZERO_M).collect();
    let (first, second) = (pieces.first()?, pieces.get(1)?);
    let touches = |p: DVec2| second.iter().any(|q| q.distance(p) < ERROR_GAP_M);
    let mut at = if touches(first[1]) { first[1] } else { first[0] };
    let mut ring = vec![at];
    for p in &pieces[1..] {
        at = if p[0].distance(at) <= p[1].distance(at) { p[1] } else { p[0] };
        ring.push(at);
    }
    Some(ring)
}

fn centroid(ring: &[DVec2]) -> Option<(DVec2, f64)> {
    let base = ring[0];
    let (mut sum, mut area) = (DVec2::ZERO, 0.0);
    for (i, p) in ring.iter().enumerate() {
        let (p, q) = (*p - base, ring[(i + 1) % ring.len()] - base);
        let c = p.perp_dot(q);
        area += c / 2.0;
        sum += (p + q) * (c / 6.0);
    }
    (area.abs() > 1e-6).then(|| (base + sum / area, area.abs()))
}

/// Sides of the narrowest box along one of the ring's pieces, the longer first.
fn box_of(ring: &[DVec2]) -> Option<(f64, f64)> {
    let mut best: Option<(f64, f64)> = None;
    for (i, p) in ring.iter().enumerate() {
        let u = (ring[(i + 1) % ring.len()] - *p).try_normalize()?;
        let along = |v: DVec2| {
            let (lo, hi) =
                ring.iter().map(|q| q.dot(v)).fold((f64::MAX, f64::MIN), |b, x| (b.0.min(x), b.1.max(x)));
            hi - lo
        };
        let (a, b) = (along(u), along(u.perp()));
        if best.is_none_or(|(l, s)| a * b < l * s) {
            best = Some((a.max(b), a.min(b)));
        }
    }
    best
}

/// A ring of lines, and lines drawn twice over it.
type Ring = (Vec<u32>, Vec<u32>);

/// Sets of lines, and arcs round their corners, that close small rings and meet nothing else.
fn boxes_of_lines(drawn: &Drawn, is_taken: &[bool]) -> Vec<Ring> {
    let is_short = |f: &u32| {
        let face = &drawn.faces[*f as usize];
        !is_taken[*f as usize] && !face.is_closed && is_part(&face.path)
    };
    let short: Vec<u32> = (0..drawn.faces.len() as u32).filter(is_short).collect();
    let mut buckets = Buckets::new(0.5);
    for (i, f) in drawn.faces.iter().enumerate() {
        f.path.ends().iter().for_each(|e| buckets.add(i as u32, &[*e]));
    }
    let mut seen = vec![false; drawn.faces.len()];
    let mut out = Vec::new();
    for f in short {
        if !seen[f as usize]
            && let Some(ring) = box_from(drawn, &buckets, f)
            && ring.0.iter().all(|r| !seen[*r as usize] && !is_taken[*r as usize])
        {
            ring.0.iter().chain(&ring.1).for_each(|r| seen[*r as usize] = true);
            out.push(ring);
        }
    }
    out
}

/// Whether a piece may be a side or a rounded corner of a column.
fn is_part(path: &Path) -> bool {
    (ZERO_M..=COLUMN_MAX_M).contains(&path.length_m())
        && match path {
            Path::Line { .. } => true,
            Path::Arc { radius, sweep_rad, .. } => {
                *radius <= CORNER_RADIUS_MAX_M && *sweep_rad < std::f64::consts::PI
            }
        }
}

/// Walks from piece to piece until the ring closes after three to eight of them. What is drawn on a layer of columns
/// closes a ring whatever else ends at its corners.
fn box_from(drawn: &Drawn, buckets: &Buckets, first: u32) -> Option<Ring> {
    let ends = |f: u32| drawn.faces[f as usize].path.ends();
    let is_twin = |f: u32, g: u32| {
        let (p, q) = (ends(f), ends(g));
        p == q
            || (p[0].distance(q[0]) < COLLINEAR_M && p[1].distance(q[1]) < COLLINEAR_M)
            || (p[0].distance(q[1]) < COLLINEAR_M && p[1].distance(q[0]) < COLLINEAR_M)
    };
    let role = |f: u32| drawn.faces[f as usize].role;
    let is_other = |g: u32| role(first) == Role::Column && role(g) != Role::Column;
    let mut ring = vec![first];
    let mut twins = Vec::new();
    let mut at = ends(first)[1];
    loop {
        let last = ring[ring.len() - 1];
        let mut next: Option<u32> = None;
        for g in buckets.near(at, at) {
            if !ends(g).iter().any(|e| e.distance(at) < ERROR_GAP_M) || g == last || is_other(g) {
                continue;
            }
            if is_twin(last, g) || (g != first && is_twin(first, g)) || next.is_some_and(|n| is_twin(n, g)) {
                twins.push(g);
            } else if next.is_some() {
                return None;
            } else {
                next = Some(g);
            }
        }
        let next = next?;
        if next == first || (ring.len() > 2 && is_twin(next, first)) {
            break;
        }
        let face = &drawn.faces[next as usize];
        if ring.contains(&next) || ring.len() >= PIECES_MAX || face.is_closed || !is_part(&face.path) {
            return None;
        }
        let [a, b] = ends(next);
        at = if a.distance(at) <= b.distance(at) { b } else { a };
        ring.push(next);
    }
    twins.retain(|t| !ring.contains(t));
    twins.sort_unstable();
    twins.dedup();
    (ring.len() >= 3).then_some((ring, twins))
}

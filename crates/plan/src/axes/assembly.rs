//! Axes: strips and single lines put in rows on common lines, with what lies between them.

use glam::DVec2;

use super::axis::{Axis, Spare};
use super::carrier::Carrier;
use super::evidence::Evidence;
use super::near::Buckets;
use super::runs::{Groups, Run};
use super::spans::{self, Span};
use super::strips::Paired;
use super::swing::Swing;
use super::{AxisGraph, Drawn, Leftover, Path, cuts};
use crate::sizes::{
    CROSSING_MIN_RAD, ERROR_GAP_M, ONE_SIDED_GAP_M, OPENING_MAX_M, PASSAGE_MAX_M, THICKNESS_MAX_M,
};

/// Axes whose lines lie this near, with like thickness, are in one row.
const ROW_M: f64 = 0.015;
/// Thicknesses in one row differ by at most this, or by [`ROW_THICKNESS_SHARE`].
const ROW_THICKNESS_M: f64 = 0.02;
/// See [`ROW_THICKNESS_M`].
const ROW_THICKNESS_SHARE: f64 = 0.12;
/// A drawing with less than this share of its faces in pairs is one of single lines.
const PAIRED_SHARE_MIN: f64 = 0.25;
/// Shortest single line that is a wall among walls drawn with two faces.
const SINGLE_MIN_M: f64 = 0.8;
/// Shortest remainder of a face beyond its pair that is a wall drawn with one line.
const REMAINDER_MIN_M: f64 = 1.2;
/// Thinnest wall that can have window lines between its faces.
const BAND_MIN_M: f64 = 0.05;

/// The axes of a drawing.
#[derive(Debug)]
pub struct Axes {
    pub axes: Vec<Axis>,
    pub spares: Vec<Spare>,
}

/// Puts strips and single lines in rows.
pub fn axes(drawn: &Drawn, paired: Paired, out: &mut AxisGraph) -> Axes {
    let paired_m: f64 = paired.strips.iter().map(|s| 2.0 * spans::length(s.span)).sum();
    let drawn_m: f64 = paired.runs.iter().map(Run::length).sum();
    let is_single_lines = paired_m < PAIRED_SHARE_MIN * drawn_m;
    if is_single_lines && drawn_m > 0.0 {
        out.statements.push("walls are drawn as single lines".into());
        out.thicknesses.clear();
    }
    let mut axes = if is_single_lines { Vec::new() } else { strip_axes(&paired) };
    let (mut spares, mut stood_in_rows) = (Vec::new(), Vec::new());
    for r in 0..paired.runs.len() {
        single_axes((drawn, &paired), r, is_single_lines, &mut axes, &mut spares, &mut stood_in_rows);
    }
    let mut axes = rows(axes);
    take_panes(&mut axes, &mut spares);
    fit_ends_to_caps(&mut axes, &spares);
    cuts::free_panes(drawn, &mut axes, &mut spares);
    let axes = cuts::cut(axes, &spares, &Evidence::new(drawn, &spares));
    for f in stood_in_rows {
        let reason = "it stands in a row of equal lines, such as treads of a stair";
        out.leftovers.push(Leftover { face: drawn.face_ref(f), reason });
    }
    note_leftovers(drawn, &axes, &spares, out);
    Axes { axes, spares }
}

fn strip_axes(paired: &Paired) -> Vec<Axis> {
    let refs = |r: u32, carrier: &Carrier, span: Span| {
        let run = &paired.runs[r as usize];
        faces_of(run, run.carrier.span_of(carrier, span))
    };
    let axis = |s: &super::strips::Strip| Axis {
        carrier: s.carrier,
        span: s.span,
        thickness: s.thickness,
        role: paired.runs[s.sides[0] as usize].role,
        sides: [0, 1].map(|k: usize| {
            let all = std::iter::once(s.sides[k]).chain(s.more[k].iter().copied());
            all.flat_map(|r| refs(r, &s.carrier, s.span)).collect()
        }),
        inner: s.inner.iter().flat_map(|r| refs(*r, &s.carrier, s.span)).collect(),
        runs: s.sides.to_vec(),
        row: 0,
    };
    paired.strips.iter().map(axis).collect()
}

/// Drawn pieces of a run within a span of it.
fn faces_of(run: &Run, span: Span) -> Vec<u32> {
    let inside = run.faces.iter().filter(|(_, s)| spans::overlap(*s, span).is_some());
    let mut out: Vec<u32> = inside.map(|(f, _)| *f).collect();
    out.sort_unstable();
    out.dedup();
    out
}

/// What of a run no strip uses becomes an axis of its own, or a spare line.
fn single_axes(
    (drawn, paired): (&Drawn, &Paired),
    r: usize,
    is_single_lines: bool,
    axes: &mut Vec<Axis>,
    spares: &mut Vec<Spare>,
    stood_in_rows: &mut Vec<u32>,
) {
    let run = &paired.runs[r];
    let is_cap = paired.is_cap[r] && !is_single_lines;
    let taken: &[Span] = if is_single_lines { &[] } else { &paired.used[r] };
    for span in spans::without(run.span, taken) {
        let is_whole = span == run.span;
        let is_between = span[0] > run.span[0] && span[1] < run.span[1];
        let least = match () {
            () if is_single_lines => 0.01,
            () if is_whole => SINGLE_MIN_M,
            () if is_between => PASSAGE_MAX_M,
            () => REMAINDER_MIN_M,
        };
        let faces = faces_of(run, span);
        if paired.in_row[r] {
            stood_in_rows.extend(faces);
            continue;
        }
        if is_cap || is_leaf_swing(run) || spans::length(span) < least {
            if is_whole || is_between || is_cap {
                spares.push(Spare { carrier: run.carrier, span, faces, is_cap });
            }
            continue;
        }
        axes.push(Axis {
            carrier: run.carrier,
            span,
            // A line drawn as wide as a wall is its axis.
            thickness: faces.iter().map(|f| drawn.faces[*f as usize].width_m).fold(0.0, f64::max),
            role: run.role,
            sides: [faces.clone(), faces],
            inner: Vec::new(),
            runs: vec![r as u32],
            row: 0,
        });
    }
}

/// Whether a run by itself looks like the swing of a door.
fn is_leaf_swing(run: &Run) -> bool {
    let Carrier::Circle { centre, radius, .. } = run.carrier else { return false };
    let arc = Path::Arc { centre, radius, start_rad: 0.0, sweep_rad: run.length() / radius };
    Swing::of(&arc).is_some_and(|s| !s.is_both_ways())
}

/// Gathers axes on common lines, and joins those in a row that only one face interrupts.
fn rows(mut axes: Vec<Axis>) -> Vec<Axis> {
    axes.sort_by(|a, b| spans::length(b.span).total_cmp(&spans::length(a.span)));
    let mut buckets = Buckets::new(2.0);
    for (i, a) in axes.iter().enumerate() {
        buckets.add(i as u32, &a.carrier.points(a.span));
    }
    let mut groups = Groups::new(axes.len());
    for (i, a) in axes.iter().enumerate() {
        for reach in [[a.span[0] - OPENING_MAX_M, a.span[0]], [a.span[1], a.span[1] + OPENING_MAX_M]] {
            for j in buckets.along(&a.carrier.points(reach), ROW_M) {
                let j = j as usize;
                if j != i && is_one_row(&axes[i.min(j)], &axes[i.max(j)]) {
                    groups.join(i, j);
                }
            }
        }
    }
    let mut members: Vec<Vec<usize>> = vec![Vec::new(); axes.len()];
    for i in 0..axes.len() {
        members[groups.root(i)].push(i);
    }
    let mut out = Vec::new();
    for (row, m) in members.iter().filter(|m| !m.is_empty()).enumerate() {
        out.extend(row_of(m.iter().map(|i| axes[*i].clone()).collect(), row));
    }
    out
}

fn is_one_row(a: &Axis, b: &Axis) -> bool {
    let apart = (a.thickness - b.thickness).abs();
    if a.role != b.role
        || (a.thickness == 0.0) != (b.thickness == 0.0)
        || apart > ROW_THICKNESS_M.max(ROW_THICKNESS_SHARE * a.thickness)
        || a.carrier.is_line() != b.carrier.is_line()
    {
        return false;
    }
    if let (Carrier::Circle { centre: c, .. }, Carrier::Circle { centre: d, .. }) = (a.carrier, b.carrier)
        && c.distance(d) > 4.0 * ROW_M
    {
        return false;
    }
    let ends = b.span.map(|s| a.carrier.offset_of(b.carrier.at(s)).abs());
    if ends[0].max(ends[1]) > ROW_M {
        return false;
    }
    let s = a.carrier.span_of(&b.carrier, b.span);
    spans::overlap(s, [a.span[0] - OPENING_MAX_M, a.span[1] + OPENING_MAX_M]).is_some()
}

fn row_of(members: Vec<Axis>, row: usize) -> Vec<Axis> {
    let carrier = members[0].carrier;
    let mut all: Vec<Axis> = members
        .into_iter()
        .map(|mut a| {
            let turned = a.carrier.is_line() && a.carrier.tangent(0.0).dot(carrier.tangent(0.0)) < 0.0;
            if turned {
                a.sides.swap(0, 1);
            }
            let span = carrier.span_of(&a.carrier, a.span);
            Axis { carrier, span, row, ..a }
        })
        .collect();
    all.sort_by(|a, b| spans::tidy(a.span[0]).total_cmp(&spans::tidy(b.span[0])));
    let mut out: Vec<Axis> = Vec::new();
    for a in all {
        match out.last_mut() {
            Some(last) if goes_on(last, &a) => {
                last.span[1] = last.span[1].max(a.span[1]);
                for k in 0..2 {
                    last.sides[k].extend(&a.sides[k]);
                    last.sides[k].sort_unstable();
                    last.sides[k].dedup();
                }
                last.inner.extend(&a.inner);
                last.runs.extend(&a.runs);
            }
            _ => out.push(a),
        }
    }
    out
}

/// Whether the wall goes on from one axis to the next in its row.
fn goes_on(a: &Axis, b: &Axis) -> bool {
    let gap = b.span[0] - a.span[1];
    let one_face_goes_on = a.thickness > 0.0 && a.runs.iter().any(|r| b.runs.contains(r));
    gap <= ERROR_GAP_M || (one_face_goes_on && gap <= ONE_SIDED_GAP_M)
}

/// Axes that run in a gap of a thicker wall, between its faces, are panes and sills, not walls.
fn take_panes(axes: &mut Vec<Axis>, spares: &mut Vec<Spare>) {
    let mut buckets = Buckets::new(1.0);
    for (i, a) in axes.iter().enumerate() {
        buckets.add(i as u32, &a.carrier.points(a.span));
    }
    let mut is_pane = vec![false; axes.len()];
    for w in axes.windows(2) {
        let gap = [w[0].span[1], w[1].span[0]];
        if w[0].row != w[1].row || w[0].thickness < BAND_MIN_M || spans::length(gap) > OPENING_MAX_M {
            continue;
        }
        for j in buckets.along(&w[0].carrier.points(gap), THICKNESS_MAX_M / 2.0) {
            let b = &axes[j as usize];
            if b.row != w[0].row && b.thickness < w[0].thickness && lies_in_band(&w[0], gap, b) {
                is_pane[j as usize] = true;
            }
        }
    }
    let mut kept = Vec::new();
    for (a, is_pane) in axes.drain(..).zip(is_pane) {
        if is_pane {
            let faces = a.sides.concat().into_iter().chain(a.inner).collect();
            spares.push(Spare { carrier: a.carrier, span: a.span, faces, is_cap: false });
        } else {
            kept.push(a);
        }
    }
    *axes = kept;
}

fn lies_in_band(wall: &Axis, gap: Span, other: &Axis) -> bool {
    let s = wall.carrier.span_of(&other.carrier, other.span);
    let half = wall.thickness / 2.0 + ERROR_GAP_M;
    let along = other.carrier.tangent(other.span[0]).perp_dot(wall.carrier.tangent(gap[0])).abs();
    s[0] > gap[0] - 0.1
        && s[1] < gap[1] + 0.1
        && other.span.iter().all(|e| wall.carrier.offset_of(other.carrier.at(*e)).abs() <= half)
        && (along < CROSSING_MIN_RAD || !wall.carrier.is_line())
}

/// A wall ends at its cap, however exactly its faces end there.
fn fit_ends_to_caps(axes: &mut [Axis], spares: &[Spare]) {
    let mut buckets = Buckets::new(0.5);
    let middle = |s: &Spare| s.carrier.at((s.span[0] + s.span[1]) / 2.0);
    for (i, s) in spares.iter().enumerate() {
        if s.is_cap {
            buckets.add(i as u32, &[middle(s)]);
        }
    }
    for a in axes.iter_mut().filter(|a| a.thickness > 0.0) {
        for e in 0..2 {
            let end = a.carrier.at(a.span[e]);
            let reach = DVec2::splat(2.0 * ERROR_GAP_M);
            let at = buckets.near(end - reach, end + reach).into_iter().map(|s| middle(&spares[s as usize]));
            let far = |p: &DVec2| spans::tidy(p.distance(end));
            let at = at.filter(|p| far(p) < 1.2 * ERROR_GAP_M);
            if let Some(p) = at.min_by(|p, q| far(p).total_cmp(&far(q))) {
                a.span[e] = a.carrier.s_of(p);
            }
        }
    }
}

fn note_leftovers(drawn: &Drawn, axes: &[Axis], spares: &[Spare], out: &mut AxisGraph) {
    let mut is_used = vec![false; drawn.faces.len()];
    for f in axes.iter().flat_map(|a| a.sides.iter().flatten().chain(&a.inner)) {
        is_used[*f as usize] = true;
    }
    for f in spares.iter().filter(|s| !s.is_cap).flat_map(|s| &s.faces) {
        if !is_used[*f as usize] {
            let reason = "it is short and no second face runs beside it";
            out.leftovers.push(Leftover { face: drawn.face_ref(*f), reason });
        }
    }
}

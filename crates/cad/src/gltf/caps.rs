//! Reveals: the new faces where a box was cut out of a solid.

use glam::DVec3;

use super::cutter::Cut;
use super::soup::{Face, Part};

/// More lines of a slice are not held against each other: no wall has as many.
const LINES_MAX: usize = 400;

/// Where a face of the mesh crosses a side of the box.
#[derive(Clone, Debug)]
struct Line {
    /// Primitive, and piece of the mesh.
    part: usize,
    piece: usize,
    /// Ends in the side, by the first coordinate ascending.
    ends: [[f64; 2]; 2],
    /// What the ends carry.
    data: [Vec<f64>; 2],
    /// Which way the face goes round, where it counts just inside the side and just outside it.
    turn: i32,
    counts: [bool; 2],
}

impl Line {
    fn at(&self, u: f64) -> f64 {
        let [a, b] = self.ends;
        a[1] + (b[1] - a[1]) * self.share(u)
    }

    fn share(&self, u: f64) -> f64 {
        let [a, b] = self.ends;
        ((u - a[0]) / (b[0] - a[0])).clamp(0.0, 1.0)
    }
}

/// A side of the box with all that crosses it.
pub(super) struct Slice {
    axis: usize,
    at: f64,
    out: f64,
    lines: Vec<Line>,
}

/// The two axes in which a side is seen.
fn quad_axes(axis: usize) -> [usize; 2] {
    match axis {
        0 => [1, 2],
        1 => [0, 2],
        _ => [0, 1],
    }
}

impl Slice {
    /// A side that nothing crosses yet.
    pub fn new((axis, at, out): (usize, f64, f64)) -> Self {
        Self { axis, at, out, lines: Vec::new() }
    }

    /// Adds a line of a face.
    pub fn add(&mut self, cut: &Cut<'_>, part: usize, piece: usize, data: [Vec<f64>; 2], counts: [bool; 2]) {
        let [u, v] = quad_axes(self.axis);
        let place = |d: &Vec<f64>| cut.to_box.transform_point3(DVec3::from_slice(&d[..3]));
        let ends = [place(&data[0]), place(&data[1])].map(|p| [p[u], p[v]]);
        let [a, b] = data;
        let line = if ends[0][0] <= ends[1][0] {
            Line { part, piece, ends, data: [a, b], turn: 1, counts }
        } else {
            Line { part, piece, ends: [ends[1], ends[0]], data: [b, a], turn: -1, counts }
        };
        self.lines.push(line);
    }

    /// Closes what was cut in this side.
    pub fn close(&self, cut: &Cut<'_>, parts: &mut [Part]) {
        let height = self.size(cut)[1];
        self.each_filled(cut, |span, [low, high]| self.quad(cut, parts, (span, height), [low, high]));
    }

    /// How much of its length stands in solid at a height: of a side along a wall that is what lies beyond the wall.
    pub fn solid_at(&self, cut: &Cut<'_>, at: f64) -> f64 {
        let mut out = 0.0;
        self.each_filled(cut, |[from, to], [low, high]| {
            let middle = from.midpoint(to);
            out += if low.at(middle) < at && high.at(middle) > at { to - from } else { 0.0 };
        });
        out
    }

    fn size(&self, cut: &Cut<'_>) -> [f64; 2] {
        quad_axes(self.axis).map(|k| cut.size()[k])
    }

    /// All between two lines where there is solid on both sides, piece by piece along the side.
    fn each_filled(&self, cut: &Cut<'_>, mut go: impl FnMut([f64; 2], [&Line; 2])) {
        let [width, height] = self.size(cut);
        let breaks = self.breaks(width, height);
        for pair in breaks.windows(2).filter(|p| p[1] - p[0] > cut.near) {
            let middle = pair[0].midpoint(pair[1]);
            let mut crossed: Vec<&Line> =
                self.lines.iter().filter(|l| l.ends[0][0] < middle && l.ends[1][0] > middle).collect();
            crossed.sort_by(|a, b| a.at(middle).total_cmp(&b.at(middle)));
            for [low, high] in filled(&crossed) {
                if high.at(middle).min(height) - low.at(middle).max(0.0) > cut.near {
                    go([pair[0], pair[1]], [low, high]);
                }
            }
        }
    }

    /// Where a line starts, ends, crosses another or leaves the side: between two of them nothing changes.
    fn breaks(&self, width: f64, height: f64) -> Vec<f64> {
        let mut out = vec![0.0, width];
        for line in &self.lines {
            let [a, b] = line.ends;
            out.extend([a[0], b[0]]);
            for v in [0.0, height] {
                if (a[1] - v) * (b[1] - v) < 0.0 {
                    out.push(a[0] + (b[0] - a[0]) * (v - a[1]) / (b[1] - a[1]));
                }
            }
        }
        if self.lines.len() <= LINES_MAX {
            for (i, a) in self.lines.iter().enumerate() {
                out.extend(self.lines[..i].iter().filter_map(|b| crossing(a, b)));
            }
        }
        out.retain(|u| (0.0..=width).contains(u));
        out.sort_by(f64::total_cmp);
        out
    }

    /// One face of four corners, between two lines; its material is that of the lower one.
    fn quad(
        &self,
        cut: &Cut<'_>,
        parts: &mut [Part],
        (span, height): ([f64; 2], f64),
        [low, high]: [&Line; 2],
    ) {
        let part = &mut parts[low.part];
        let corner = |part: &Part, u: f64, is_high: bool| {
            let (bottom, top) = (low.at(u), high.at(u));
            let v = if is_high { top.min(height) } else { bottom.max(0.0) };
            let base = part.between(&low.data[0], &low.data[1], low.share(u));
            let share = if top > bottom { (v - bottom) / (top - bottom) } else { 0.0 };
            let data = if low.part == high.part {
                let over = part.between(&high.data[0], &high.data[1], high.share(u));
                part.between(&base, &over, share)
            } else {
                base
            };
            self.placed(cut, part, [u, v], data)
        };
        let mut vertices = [(span[0], false), (span[1], false), (span[1], true), (span[0], true)]
            .map(|(u, is_high)| corner(part, u, is_high));
        // Seen along the axis the first goes round as a right-handed frame has it, but across the wall.
        let is_round = if self.axis == 1 { self.out > 0.0 } else { self.out < 0.0 };
        if is_round == cut.is_mirrored {
            vertices.reverse();
        }
        let [a, b, c, d] = vertices.map(|v| part.push(&v));
        part.is_changed = true;
        let faces = [[a, b, c], [a, c, d]].map(|corners| Face { corners, piece: low.piece });
        part.faces.extend(faces);
    }

    /// What a corner of a new face carries: its place, and the directions of the side.
    fn placed(&self, cut: &Cut<'_>, part: &Part, [u, v]: [f64; 2], mut data: Vec<f64>) -> Vec<f64> {
        let axes = quad_axes(self.axis);
        let mut place = DVec3::ZERO;
        (place[self.axis], place[axes[0]], place[axes[1]]) = (self.at, u, v);
        data[..3].copy_from_slice(&cut.to_box.inverse().transform_point3(place).to_array());
        let (mut normal, mut along) = (DVec3::ZERO, DVec3::ZERO);
        (normal[self.axis], along[axes[0]]) = (-self.out, 1.0);
        // Normals of the mesh are the transposed way back of those of the box.
        let normal = (cut.to_box.matrix3.transpose() * normal).normalize_or_zero();
        let along = (cut.to_box.matrix3.inverse() * along).normalize_or_zero();
        let mut at = 0;
        for attribute in &part.attributes {
            let own = match attribute.name.as_str() {
                _ if !attribute.is_direction() => None,
                "NORMAL" => Some(normal),
                _ => Some(along),
            };
            if let Some(own) = own {
                data[at..at + 3].copy_from_slice(&own.to_array());
            }
            at += attribute.width;
        }
        data
    }
}

/// The pairs of lines between which there is solid on both sides of a cut; none where the faces do not close.
fn filled<'l>(crossed: &[&'l Line]) -> Vec<[&'l Line; 2]> {
    let sum = |counts: usize| -> i32 { crossed.iter().filter(|l| l.counts[counts]).map(|l| l.turn).sum() };
    let number = |counts: usize| crossed.iter().filter(|l| l.counts[counts]).count();
    let is_turned = sum(0) == 0 && sum(1) == 0;
    if !is_turned && (number(0) % 2 == 1 || number(1) % 2 == 1) {
        return Vec::new();
    }
    let (mut wound, mut out) = ([0i32; 2], Vec::new());
    for (k, line) in crossed.iter().enumerate() {
        for (own, _) in wound.iter_mut().zip(line.counts).filter(|(_, counts)| *counts) {
            *own = if is_turned { *own + line.turn } else { 1 - *own };
        }
        if let (true, Some(next)) = (wound.iter().all(|w| *w != 0), crossed.get(k + 1)) {
            out.push([*line, *next]);
        }
    }
    out
}

/// Where two lines cross.
fn crossing(a: &Line, b: &Line) -> Option<f64> {
    let (from, to) = (a.ends[0][0].max(b.ends[0][0]), a.ends[1][0].min(b.ends[1][0]));
    if from >= to {
        return None;
    }
    let (s, t) = (a.at(from) - b.at(from), a.at(to) - b.at(to));
    (s * t < 0.0).then(|| from + (to - from) * s / (s - t))
}

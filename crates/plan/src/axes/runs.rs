//! Runs: drawn pieces on one line or circle that touch or overlap, taken as one face.

use std::collections::HashMap;

use glam::DVec2;

use super::carrier::Carrier;
use super::near::Buckets;
use super::spans::{self, Span};
use super::{AxisGraph, Closure, Drawn, Leftover, Role};
use crate::sizes::{COLLINEAR_M, ERROR_GAP_M, ZERO_M};

/// A piece before merging: a face, or an arc fitted to several faces.
#[derive(Clone, Debug)]
pub struct Loose {
    /// Indices of [`Drawn::faces`].
    pub faces: Vec<u32>,
    pub carrier: Carrier,
    pub span: Span,
}

impl Loose {
    /// Equal for pieces that are drawn in the same place, and may be one face.
    fn key(&self, drawn: &Drawn) -> (bool, Role, [[u64; 2]; 3]) {
        let [from, to] = self.span.map(|s| self.carrier.at(s));
        let middle = self.carrier.at((self.span[0] + self.span[1]) / 2.0);
        let bits = [from, to, middle].map(|p| (p + 0.0).to_array().map(f64::to_bits));
        (self.carrier.is_line(), drawn.faces[self.faces[0] as usize].role, bits)
    }
}

/// One face of a wall, however many pieces it was drawn with.
#[derive(Clone, Debug)]
pub struct Run {
    pub carrier: Carrier,
    pub span: Span,
    /// Indices of [`Drawn::faces`] with where they lie, in order of the span.
    pub faces: Vec<(u32, Span)>,
    pub role: Role,
}

impl Run {
    pub fn length(&self) -> f64 {
        spans::length(self.span)
    }

    pub fn ends(&self) -> [DVec2; 2] {
        [self.carrier.at(self.span[0]), self.carrier.at(self.span[1])]
    }
}

/// Merges loose pieces to runs, longest first.
pub fn merge(drawn: &Drawn, loose: Vec<Loose>, out: &mut AxisGraph) -> Vec<Run> {
    let (mut pieces, nothing): (Vec<Loose>, Vec<Loose>) =
        loose.into_iter().partition(|p| spans::length(p.span) > ZERO_M);
    for f in nothing.iter().flat_map(|p| &p.faces) {
        let face = &drawn.faces[*f as usize];
        out.leftovers.push(Leftover { face: (face.wall, face.part), reason: "it has no length" });
    }
    pieces.sort_by(|a, b| spans::length(b.span).total_cmp(&spans::length(a.span)));
    let mut groups = Groups::new(pieces.len());
    let mut buckets = Buckets::new(1.0);
    // What is drawn several times is looked at once.
    let mut first: HashMap<_, usize> = HashMap::new();
    let mut once: Vec<usize> = Vec::new();
    for (i, p) in pieces.iter().enumerate() {
        let known = *first.entry(p.key(drawn)).or_insert(i);
        if known == i {
            buckets.add(i as u32, &p.carrier.points(p.span));
            once.push(i);
        } else {
            groups.join(known, i);
        }
    }
    for i in once {
        let p = &pieces[i];
        let reach = DVec2::splat(ERROR_GAP_M);
        for end in [p.carrier.at(p.span[0]), p.carrier.at(p.span[1])] {
            for j in buckets.near(end - reach, end + reach) {
                let j = j as usize;
                if j != i && is_one_line(&pieces[j.min(i)], &pieces[j.max(i)], drawn) {
                    groups.join(i, j);
                }
            }
        }
    }
    let mut members: Vec<Vec<usize>> = vec![Vec::new(); pieces.len()];
    for i in 0..pieces.len() {
        members[groups.root(i)].push(i);
    }
    members.iter().filter(|m| !m.is_empty()).map(|m| run_of(drawn, &pieces, m, out)).collect()
}

/// Whether the shorter piece `q` lies on the line of `p` and touches it.
fn is_one_line(p: &Loose, q: &Loose, drawn: &Drawn) -> bool {
    let role = |l: &Loose| drawn.faces[l.faces[0] as usize].role;
    if p.carrier.is_line() != q.carrier.is_line() || role(p) != role(q) {
        return false;
    }
    let ends = [q.carrier.at(q.span[0]), q.carrier.at(q.span[1])];
    let tolerance = if p.carrier.is_line() { COLLINEAR_M } else { 2.0 * COLLINEAR_M };
    if ends.iter().any(|e| p.carrier.offset_of(*e).abs() > tolerance) {
        return false;
    }
    if let (Carrier::Circle { centre: c, .. }, Carrier::Circle { centre: d, .. }) = (p.carrier, q.carrier)
        && c.distance(d) > 0.05
    {
        return false;
    }
    let s = p.carrier.span_of(&q.carrier, q.span);
    s[0] <= p.span[1] + ERROR_GAP_M && s[1] >= p.span[0] - ERROR_GAP_M
}

fn run_of(drawn: &Drawn, pieces: &[Loose], members: &[usize], out: &mut AxisGraph) -> Run {
    let first = &pieces[members[0]];
    let carrier = first.carrier;
    let mut faces: Vec<(u32, Span)> = Vec::new();
    let mut parts: Vec<Span> = Vec::new();
    for m in members {
        let s = carrier.span_of(&pieces[*m].carrier, pieces[*m].span);
        faces.extend(pieces[*m].faces.iter().map(|f| (*f, s)));
        parts.push(s);
    }
    faces.sort_by(|a, b| spans::tidy(a.1[0]).total_cmp(&spans::tidy(b.1[0])).then(a.0.cmp(&b.0)));
    let parts = spans::joined(parts, ZERO_M);
    for w in parts.windows(2) {
        out.closures.push(Closure { a: carrier.at(w[0][1]), b: carrier.at(w[1][0]) });
    }
    let span = [parts[0][0], parts[parts.len() - 1][1]];
    Run { carrier, span, faces, role: drawn.faces[first.faces[0] as usize].role }
}

/// Sets that grow together.
pub struct Groups(Vec<usize>);

impl Groups {
    pub fn new(count: usize) -> Self {
        Self((0..count).collect())
    }

    pub fn root(&mut self, mut i: usize) -> usize {
        while self.0[i] != i {
            self.0[i] = self.0[self.0[i]];
            i = self.0[i];
        }
        i
    }

    pub fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b)] = a.min(b);
    }
}

//! Offset curves: of a wall that follows no single circle, both faces are cut at the same places.
//!
//! Circles fitted to either face alone begin and end where its own corners happen to lie, so they face each other with
//! other centres. What runs beside a face at a constant distance lies on circles about that face's centres and on parallels
//! to its straight pieces: the second face is cut so.

use glam::DVec2;

use super::carrier::Carrier;
use super::near::Buckets;
use super::runs::Loose;
use super::spans::{self, Span};
use crate::sizes::{
    CIRCLE_FIT_M, CONCENTRIC_M, ERROR_GAP_M, SAGITTA_MAX_M, SKEW_RAD, THICKNESS_MAX_M, THICKNESS_MIN_M,
};

/// How far corners of the second face may lie from what is parallel to the first: the first one's own error twice.
const OFFSET_FIT_M: f64 = 2.0 * CIRCLE_FIT_M;
/// A chord and what it runs beside differ by at most this angle: half of what chords of a traced curve turn.
const BESIDE_RAD: f64 = 0.28;
/// The second face is cut anew if that pairs more of it by this factor.
const WORTH: f64 = 1.1;

/// A chord of a face: its entity and its ends in the order of the chain.
pub type Chord = (u32, [DVec2; 2]);

/// Pieces of faces beside which others may run.
#[derive(Debug)]
pub struct Guides {
    pieces: Vec<(Carrier, Span)>,
    near: Buckets,
}

impl Guides {
    pub fn new() -> Self {
        Self { pieces: Vec::new(), near: Buckets::new(2.0 * THICKNESS_MAX_M) }
    }

    pub fn add(&mut self, pieces: &[Loose]) {
        for piece in pieces {
            self.near.add(self.pieces.len() as u32, &piece.carrier.points(piece.span));
            self.pieces.push((piece.carrier, piece.span));
        }
    }

    /// The nearest piece beside which a chord runs at a wall's thickness.
    fn beside(&self, [a, b]: [DVec2; 2]) -> Option<u32> {
        let middle = a.midpoint(b);
        let reach = DVec2::splat(THICKNESS_MAX_M);
        let along = (b - a).normalize_or_zero();
        let near = self.near.near(middle - reach, middle + reach).into_iter().filter_map(|g| {
            let (carrier, span) = &self.pieces[g as usize];
            let (s, apart) = (carrier.s_of(middle), spans::tidy(carrier.offset_of(middle).abs()));
            let is_beside = (span[0] - ERROR_GAP_M..=span[1] + ERROR_GAP_M).contains(&s)
                && (THICKNESS_MIN_M..=THICKNESS_MAX_M).contains(&apart)
                && carrier.tangent(s).perp_dot(along).abs() < BESIDE_RAD.sin();
            is_beside.then_some((apart, g))
        });
        near.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))).map(|(_, g)| g)
    }

    /// How much of a piece runs beside others on one centre, or straight beside straight ones.
    fn paired_m(&self, carrier: &Carrier, span: Span) -> f64 {
        let near = self.near.along(&carrier.points(span), THICKNESS_MAX_M).into_iter();
        let beside: Vec<Span> = near
            .filter_map(|g| {
                let (other, s) = &self.pieces[g as usize];
                let is_parallel = match (carrier, other) {
                    (Carrier::Line { dir: u, .. }, Carrier::Line { dir: v, .. }) => {
                        u.perp_dot(*v).abs() <= SKEW_RAD
                    }
                    (Carrier::Circle { centre: c, .. }, Carrier::Circle { centre: d, .. }) => {
                        c.distance(*d) <= CONCENTRIC_M
                    }
                    _ => false,
                };
                let shared = spans::overlap(carrier.span_of(other, *s), span).filter(|_| is_parallel)?;
                let middle = carrier.at((shared[0] + shared[1]) / 2.0);
                let apart = other.offset_of(middle).abs();
                (THICKNESS_MIN_M..=THICKNESS_MAX_M).contains(&apart).then_some(shared)
            })
            .collect();
        spans::covered(span, &beside)
    }

    /// The chords of a chain cut as what they run beside; `None` where `own`, the pieces fitted to them alone, are
    /// paired as well.
    pub fn follow(&self, chain: &[Chord], own: &[Loose]) -> Option<Vec<Loose>> {
        let stretches = self.stretches(chain);
        let apart: Vec<Option<f64>> = stretches.iter().map(|s| self.apart(s)).collect();
        let cut = stretches.iter().enumerate().filter_map(|(i, stretch)| {
            // Without a corner of its own it lies as its neighbours do.
            let near = [apart[..i].iter().rev().flatten().next(), apart[i + 1..].iter().flatten().next()];
            let near: Vec<f64> = near.into_iter().flatten().copied().collect();
            let mean = (!near.is_empty()).then(|| near.iter().sum::<f64>() / near.len() as f64);
            self.parallel(stretch, apart[i].or(mean)?)
        });
        let cut: Vec<Loose> = cut.collect();
        let cut_m: f64 = cut.iter().map(|l| spans::length(l.span)).sum();
        let own_m: f64 = own.iter().map(|l| self.paired_m(&l.carrier, l.span)).sum();
        (cut_m > WORTH * own_m).then_some(cut)
    }

    /// What of a chain runs beside one piece after another.
    fn stretches(&self, chain: &[Chord]) -> Vec<Stretch> {
        let parts: Vec<Part> = chain.iter().flat_map(|chord| self.parts(chord)).collect();
        let beside: Vec<Option<u32>> = parts.iter().map(|p| self.beside(p.ends)).collect();
        let mut out = Vec::new();
        let mut from = 0;
        while from < parts.len() {
            let to = from + beside[from..].iter().take_while(|g| **g == beside[from]).count();
            if let Some(piece) = beside[from] {
                let around = [from.checked_sub(1), Some(to)];
                let goes_on = around.map(|k| k.is_some_and(|k| beside.get(k).is_some_and(Option::is_some)));
                out.push(Stretch { piece, parts: parts[from..to].to_vec(), goes_on });
            }
            from = to;
        }
        out
    }

    /// A chord cut where a piece beside it ends.
    fn parts(&self, &(face, [a, b]): &Chord) -> Vec<Part> {
        let reach = DVec2::splat(THICKNESS_MAX_M);
        let length = a.distance(b);
        let along = (b - a).normalize_or_zero();
        let near = self.near.near(a.min(b) - reach, a.max(b) + reach).into_iter();
        let ends = near.flat_map(|g| {
            let (carrier, span) = &self.pieces[g as usize];
            span.map(|s| (carrier.at(s), carrier.tangent(s)))
        });
        let mut cuts: Vec<f64> = ends
            .filter_map(|(p, tangent)| {
                // Square to the guide, to where the chord runs.
                let turn = tangent.dot(along);
                let s = (p - a).dot(tangent) / turn;
                let apart = (a + along * s).distance(p);
                let is_beside =
                    turn.abs() > BESIDE_RAD.cos() && (THICKNESS_MIN_M..=THICKNESS_MAX_M).contains(&apart);
                (is_beside && s > ERROR_GAP_M && s < length - ERROR_GAP_M).then_some(s)
            })
            .collect();
        cuts.sort_by(f64::total_cmp);
        cuts.dedup_by(|s, last| *s - *last < ERROR_GAP_M);
        let stops: Vec<f64> = std::iter::once(0.0).chain(cuts).chain([length]).collect();
        let last = stops.len() - 1;
        let at = |k: usize| if k == last { b } else { a + along * stops[k] };
        (0..last)
            .map(|k| Part { face, ends: [at(k), at(k + 1)], is_corner: [k == 0, k + 1 == last] })
            .collect()
    }

    /// How far from its piece the corners of a stretch lie; `None` without any, or where they do not agree.
    fn apart(&self, stretch: &Stretch) -> Option<f64> {
        let (carrier, span) = &self.pieces[stretch.piece as usize];
        let corners =
            stretch.parts.iter().flat_map(|p| (0..2).filter(|&k| p.is_corner[k]).map(|k| p.ends[k]));
        let is_in = |p: &DVec2| (span[0] - ERROR_GAP_M..=span[1] + ERROR_GAP_M).contains(&carrier.s_of(*p));
        let all: Vec<f64> = corners.filter(is_in).map(|p| carrier.offset_of(p).abs()).collect();
        let mean = all.iter().sum::<f64>() / all.len() as f64;
        (!all.is_empty() && all.iter().all(|a| (a - mean).abs() <= OFFSET_FIT_M)).then_some(mean)
    }

    /// A stretch as a parallel to its piece, up to the end of that where the chain goes on beside another.
    fn parallel(&self, stretch: &Stretch, apart: f64) -> Option<Loose> {
        let (carrier, span) = &self.pieces[stretch.piece as usize];
        let parts = &stretch.parts;
        let middles: Vec<f64> =
            parts.iter().map(|p| carrier.offset_of(p.ends[0].midpoint(p.ends[1]))).collect();
        let offset = apart.copysign(middles[0]);
        if middles.iter().any(|m| (m - offset).abs() > SAGITTA_MAX_M + OFFSET_FIT_M) {
            return None;
        }
        let [first, last] = [parts[0].ends[0], parts[parts.len() - 1].ends[1]].map(|p| carrier.s_of(p));
        let ends = if first <= last { [0, 1] } else { [1, 0] };
        let mut own = [first, last];
        for k in (0..2).filter(|k| stretch.goes_on[*k]) {
            own[k] = span[ends[k]];
        }
        let own = [own[0].min(own[1]), own[0].max(own[1])];
        let (carrier, scale) = beside(carrier, offset)?;
        let mut faces: Vec<u32> = parts.iter().map(|p| p.face).collect();
        faces.dedup();
        Some(Loose { faces, carrier, span: own.map(|s| s * scale) })
    }
}

/// Parts of chords one after another beside one piece, and whether the chain goes on beside others at either end.
struct Stretch {
    piece: u32,
    parts: Vec<Part>,
    goes_on: [bool; 2],
}

/// A part of a chord, and which of its ends are the chord's own.
#[derive(Clone)]
struct Part {
    face: u32,
    ends: [DVec2; 2],
    is_corner: [bool; 2],
}

/// What runs beside a carrier, and how much longer it is for the same turn.
fn beside(carrier: &Carrier, offset: f64) -> Option<(Carrier, f64)> {
    match *carrier {
        Carrier::Line { origin, dir } => {
            Some((Carrier::Line { origin: origin + dir.perp() * offset, dir }, 1.0))
        }
        Carrier::Circle { centre, radius, base_rad } => {
            let wide = radius + offset;
            (wide > THICKNESS_MIN_M)
                .then_some((Carrier::Circle { centre, radius: wide, base_rad }, wide / radius))
        }
    }
}

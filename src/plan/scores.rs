//! How much the lines of a layer look like walls, where no name says it.

use std::collections::BTreeMap;

use glam::DVec2;

use super::box_of;
use super::drawing::{Drawing, Entity};
use super::parallels::{Piece, nearest_parallels, pieces};

/// Distances of wall faces as a share of the longer side of the drawing: a board in a hall to thick
/// walls of a small house.
const PAIR_SHARE: [f64; 2] = [0.0005, 0.06];

/// Ends nearer than this share of the drawing meet.
const MEET_SHARE: f64 = 0.0005;

/// Lines of a layer look like walls from this score on; others than the best are taken too when they
/// come near it and are mostly pairs.
const SCORE_MIN: f64 = 0.4;
const NEAR_BEST: f64 = 0.7;
const PAIRED_MIN: f64 = 0.5;

/// What speaks for walls, shares from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Score {
    /// Length that has a parallel neighbour at a wall's distance.
    paired: f64,
    /// Ends that meet another end.
    joined: f64,
    /// Share of all length on these layers.
    length: f64,
    /// Its box against that of the whole drawing, longer side.
    hull: f64,
}

impl Score {
    /// The whole, 0 to 1.
    pub fn total(&self) -> f64 {
        self.hull * (0.5 * self.paired + 0.3 * self.joined + 0.2 * self.length)
    }

    /// Whether the layer is taken, `best` being the highest score.
    pub fn is_taken(&self, best: f64) -> bool {
        let total = self.total();
        total >= SCORE_MIN && (total >= best || total >= NEAR_BEST * best && self.paired >= PAIRED_MIN)
    }

    /// In plain words.
    pub fn words(&self) -> String {
        let percent = |v: f64| (v * 100.0).round();
        format!(
            "{} % of their length in pairs, {} % of their ends joined, {} % of all length, over {} % of the \
             drawing (score {:.2})",
            percent(self.paired),
            percent(self.joined),
            percent(self.length),
            percent(self.hull),
            self.total()
        )
    }
}

/// Scores of some layers.
pub(super) fn wall_scores<'a>(drawing: &Drawing, layers: &[&'a str]) -> BTreeMap<&'a str, Score> {
    let on = |layer: &str| -> Vec<Piece> {
        let entities: Vec<&Entity> = drawing.entities.iter().filter(|e| e.layer == layer).collect();
        pieces(entities.into_iter())
    };
    let by_layer: Vec<(&str, Vec<Piece>)> = layers.iter().map(|l| (*l, on(l))).collect();
    let ends = |p: &Piece| [p.a, p.b];
    let Some(whole) = box_of(by_layer.iter().flat_map(|l| l.1.iter().flat_map(ends))) else {
        return BTreeMap::new();
    };
    let extent = (whole[1] - whole[0]).max_element();
    let all: f64 = by_layer.iter().flat_map(|l| &l.1).map(Piece::length).sum();
    let scored = by_layer.into_iter().filter_map(|(layer, pieces)| {
        let own = box_of(pieces.iter().flat_map(ends))?;
        let length: f64 = pieces.iter().map(Piece::length).sum();
        let score = Score {
            paired: paired(&pieces, extent) / length.max(f64::MIN_POSITIVE),
            joined: joined(&pieces, extent * MEET_SHARE),
            length: length / all.max(f64::MIN_POSITIVE),
            hull: (own[1] - own[0]).max_element() / extent.max(f64::MIN_POSITIVE),
        };
        Some((layer, score))
    });
    scored.collect()
}

fn paired(pieces: &[Piece], extent: f64) -> f64 {
    let range = PAIR_SHARE.map(|s| s * extent);
    let seen = pieces.iter().zip(nearest_parallels(pieces, range[0]));
    seen.filter(|(p, d)| d.is_some_and(|d| d <= range[1] && p.length() > d)).map(|(p, _)| p.length()).sum()
}

fn joined(pieces: &[Piece], reach: f64) -> f64 {
    let cell = |p: DVec2| [(p.x / reach).round() as i64, (p.y / reach).round() as i64];
    let mut ends: BTreeMap<[i64; 2], usize> = BTreeMap::new();
    for p in pieces.iter().flat_map(|p| [p.a, p.b]) {
        *ends.entry(cell(p)).or_default() += 1;
    }
    let meeting: usize = ends.values().filter(|n| **n > 1).sum();
    meeting as f64 / (2 * pieces.len()).max(1) as f64
}

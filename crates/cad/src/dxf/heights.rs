//! How high what a drawing shows lies.

use std::collections::HashMap;

use super::blocks::Blocks;
use super::fields::{Fields, polyline_records};
use super::tokens::Tokens;
use crate::drawing::{Origin, Text};

/// Most INSERTs within one another that a height is followed through.
const WAY_MAX: usize = 100;

/// Whether anything in the blocks or in model space states a height.
pub(super) fn is_raised(tokens: &Tokens<'_>) -> bool {
    is_any(tokens, |code| matches!(code, 30 | 38))
}

/// Whether anything in the blocks or in model space is drawn with a thickness.
pub(super) fn is_thick(tokens: &Tokens<'_>) -> bool {
    is_any(tokens, |code| code == 39)
}

fn is_any(tokens: &Tokens<'_>, is_asked: fn(i32) -> bool) -> bool {
    let sections = [&b"BLOCKS"[..], b"ENTITIES"].into_iter().filter_map(|name| tokens.section(name));
    let mut pairs = sections.flatten().flat_map(|record| tokens.record(record));
    pairs.any(|p| is_asked(p.code) && tokens.number(p).is_some_and(|z| z != 0.0))
}

/// Heights of what a file shows, drawing units of model space.
pub(super) struct Heights<'t, 'a> {
    tokens: &'t Tokens<'a>,
    blocks: &'t Blocks,
    /// What INSERTs multiply heights by and add to them.
    through: HashMap<usize, [f64; 2]>,
}

impl<'t, 'a> Heights<'t, 'a> {
    /// Heights of a file with these blocks.
    pub fn new(tokens: &'t Tokens<'a>, blocks: &'t Blocks) -> Self {
        Self { tokens, blocks, through: HashMap::new() }
    }

    /// The lowest and the highest height of what a record draws where the INSERTs on the way show it.
    pub fn of(&mut self, origin: &Origin) -> [f64; 2] {
        let own = self.own(origin.record);
        self.shown(own, origin)
    }

    /// The same with the thickness (39) in which it is drawn upright, and whether it has one.
    pub fn reach(&mut self, origin: &Origin) -> ([f64; 2], bool) {
        let fields = Fields::of(self.tokens, origin.record);
        let is_extruded = matches!(
            self.tokens.name(origin.record),
            b"LINE" | b"LWPOLYLINE" | b"POLYLINE" | b"ARC" | b"CIRCLE"
        );
        let thick = if is_extruded { self.number(&fields, 39, 0.0) } else { 0.0 };
        let up = if self.number(&fields, 230, 1.0) < 0.0 { -thick } else { thick };
        let [a, b] = self.own(origin.record);
        let [low, high] = [a.min(b), a.max(b)];
        (self.shown([low + up.min(0.0), high + up.max(0.0)], origin), thick != 0.0)
    }

    /// Heights in a block or in model space as the INSERTs on the way show them.
    fn shown(&mut self, own: [f64; 2], origin: &Origin) -> [f64; 2] {
        let ends = origin.inserts.iter().rev().fold(own, |ends, insert| {
            let [by, shift] = self.through(*insert);
            ends.map(|z| by * z + shift)
        });
        [ends[0].min(ends[1]), ends[0].max(ends[1])]
    }

    /// The height of a text; of one that moves with an INSERT that of the INSERT.
    pub fn of_text(&mut self, text: &Text) -> f64 {
        let mut record = text.source.record;
        let mut z = self.own(record)[0];
        for _ in 0..WAY_MAX {
            let Some(block) = self.blocks.list.iter().find(|b| b.records.contains(&record)) else { break };
            record = block.insert;
            let [by, shift] = self.through(record);
            z = by * z + shift;
        }
        z
    }

    /// The ends of what a record draws, in its block or in model space.
    fn own(&self, record: usize) -> [f64; 2] {
        let fields = Fields::of(self.tokens, record);
        let kind = self.tokens.name(record);
        let is_in_space = kind == b"POLYLINE" && self.number(&fields, 70, 0.0) as i64 & 8 != 0;
        // Coordinates of the world; the others lie in a plane of their own.
        let is_of_world =
            is_in_space || matches!(kind, b"LINE" | b"MTEXT" | b"SPLINE" | b"ELLIPSE" | b"MLINE");
        let ends = match kind {
            b"LINE" => [30, 31].map(|code| self.number(&fields, code, 0.0)),
            b"LWPOLYLINE" => [self.number(&fields, 38, 0.0); 2],
            _ if is_in_space => self.ends_of_vertices(record),
            _ => [self.number(&fields, 30, 0.0); 2],
        };
        let is_turned_over = !is_of_world && self.number(&fields, 230, 1.0) < 0.0;
        if is_turned_over { ends.map(|z| -z) } else { ends }
    }

    fn ends_of_vertices(&self, record: usize) -> [f64; 2] {
        let vertices = polyline_records(self.tokens, record).0;
        let heights = vertices.map(|v| self.number(&Fields::of(self.tokens, v), 30, 0.0));
        heights.map(|z| [z; 2]).reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]).unwrap_or_default()
    }

    /// What an INSERT makes of heights in its block.
    fn through(&mut self, insert: usize) -> [f64; 2] {
        if let Some(known) = self.through.get(&insert) {
            return *known;
        }
        let by = self.number(&Fields::of(self.tokens, insert), 43, 1.0);
        let base = self.blocks.of_insert(insert).map(|b| Fields::of(self.tokens, b.records.start - 1));
        let base = base.map_or(0.0, |fields| self.number(&fields, 30, 0.0));
        let made = [by, self.own(insert)[0] - by * base];
        self.through.insert(insert, made);
        made
    }

    fn number(&self, fields: &Fields<'_, '_>, code: i32, default: f64) -> f64 {
        fields.pair(code).and_then(|p| self.tokens.number(p)).filter(|z| z.is_finite()).unwrap_or(default)
    }
}

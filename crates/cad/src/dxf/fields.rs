//! One record's own group codes: XDATA, application groups and embedded objects left aside.

use super::tokens::{Pair, Tokens};

/// Codes 0–79 have slots of their own; 210, 220, 230 follow.
const SLOTS: usize = 83;
const EMPTY: u32 = u32::MAX;

fn slot_of(code: i32) -> Option<usize> {
    match code {
        0..=79 => Some(code as usize),
        210 | 220 | 230 => Some(80 + (code as usize - 210) / 10),
        _ => None,
    }
}

/// The last value of each code of a record.
pub(super) struct Fields<'t, 'a> {
    tokens: &'t Tokens<'a>,
    /// The record.
    pub record: usize,
    slots: [u32; SLOTS],
}

impl<'t, 'a> Fields<'t, 'a> {
    /// Looks through a record once.
    pub fn of(tokens: &'t Tokens<'a>, record: usize) -> Self {
        let mut slots = [EMPTY; SLOTS];
        for (index, pair) in own_pairs(tokens, record) {
            if let Some(slot) = slot_of(pair.code) {
                slots[slot] = index as u32;
            }
        }
        Self { tokens, record, slots }
    }

    /// Index of the last pair with this code.
    pub fn index(&self, code: i32) -> Option<usize> {
        let index = self.slots[slot_of(code)?];
        (index != EMPTY).then_some(index as usize)
    }

    /// The last pair with this code.
    pub fn pair(&self, code: i32) -> Option<&'t Pair> {
        self.tokens.pairs.get(self.index(code)?)
    }

    /// Its value as written, trimmed.
    pub fn value(&self, code: i32) -> Option<&'a [u8]> {
        self.pair(code).map(|p| self.tokens.value(p))
    }
}

/// Pairs of a record that are the entity's own, with their indices.
pub(super) fn own_pairs<'t>(
    tokens: &'t Tokens<'_>,
    record: usize,
) -> impl Iterator<Item = (usize, &'t Pair)> {
    let mut in_group = false;
    tokens
        .span(record)
        .map(|i| (i, &tokens.pairs[i]))
        .take_while(|(_, p)| p.code < 1000 && p.code != 101)
        .filter(move |(_, p)| {
            if p.code == 102 {
                in_group = tokens.value(p).starts_with(b"{");
                return false;
            }
            !in_group
        })
}

/// Pair indices of one vertex of an LWPOLYLINE.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct VertexSlots {
    /// Group 10.
    pub x: usize,
    /// Group 20.
    pub y: Option<usize>,
    /// Group 42.
    pub bulge: Option<usize>,
}

/// Vertices of an LWPOLYLINE: each group 10 starts one. The count in group 90 is not believed.
pub(super) fn lwpolyline_vertices(tokens: &Tokens<'_>, record: usize) -> Vec<VertexSlots> {
    let mut out: Vec<VertexSlots> = Vec::new();
    for (index, pair) in own_pairs(tokens, record) {
        match (pair.code, out.last_mut()) {
            (10, _) => out.push(VertexSlots { x: index, y: None, bulge: None }),
            (20, Some(vertex)) => vertex.y = Some(index),
            (42, Some(vertex)) => vertex.bulge = Some(index),
            _ => {}
        }
    }
    out
}

/// The width in which a polyline is drawn all along, drawing units, where it has one: group 43 of an LWPOLYLINE, else
/// groups 40 and 41 of every vertex, for which those of a POLYLINE stand where a vertex has none.
pub(super) fn constant_width(tokens: &Tokens<'_>, record: usize) -> Option<f64> {
    let of = |record: usize, code: i32| -> Vec<f64> {
        let own = own_pairs(tokens, record).filter(|(_, p)| p.code == code);
        own.filter_map(|(_, p)| tokens.number(p)).collect()
    };
    let widths: Vec<f64> = match tokens.name(record) {
        b"POLYLINE" => {
            let stated = [40, 41].map(|code| of(record, code).last().copied().unwrap_or(0.0));
            let vertices = polyline_records(tokens, record).0;
            let own = |v: usize| [0, 1].map(|k| of(v, 40 + k).last().copied().unwrap_or(stated[k as usize]));
            vertices.flat_map(own).collect()
        }
        _ => match of(record, 43)[..] {
            [.., width] if width != 0.0 => vec![width],
            _ => {
                let count = lwpolyline_vertices(tokens, record).len();
                let both = [of(record, 40), of(record, 41)];
                if both.iter().any(|w| w.len() != count) { Vec::new() } else { both.concat() }
            }
        },
    };
    let first = *widths.first()?;
    (first.is_finite() && first > 0.0 && widths.iter().all(|w| *w == first)).then_some(first)
}

/// The VERTEX records of the POLYLINE at `record`, the first record after it and its SEQEND, and
/// whether the SEQEND is there.
pub(super) fn polyline_records(tokens: &Tokens<'_>, record: usize) -> (std::ops::Range<usize>, usize, bool) {
    let mut end = record + 1;
    while end < tokens.records.len() && tokens.name(end) == b"VERTEX" {
        end += 1;
    }
    let has_seqend = end < tokens.records.len() && tokens.name(end) == b"SEQEND";
    (record + 1..end, end + usize::from(has_seqend), has_seqend)
}

/// Pair indices of all points of a record at groups `code`, `code + 10`.
pub(super) fn point_slots(tokens: &Tokens<'_>, record: usize, code: i32) -> Vec<(usize, Option<usize>)> {
    let mut out: Vec<(usize, Option<usize>)> = Vec::new();
    for (index, pair) in own_pairs(tokens, record) {
        if pair.code == code {
            out.push((index, None));
        } else if pair.code == code + 10
            && let Some((_, y)) = out.last_mut()
        {
            *y = Some(index);
        }
    }
    out
}

/// The ATTRIB records that follow an INSERT.
pub(super) fn attributes(tokens: &Tokens<'_>, insert: usize) -> std::ops::Range<usize> {
    let mut end = insert + 1;
    while end < tokens.records.len() && tokens.name(end) == b"ATTRIB" {
        end += 1;
    }
    insert + 1..end
}

/// Whether a record carries another object with coordinates of its own (group 101).
pub(super) fn has_embedded_object(tokens: &Tokens<'_>, record: usize) -> bool {
    let own = own_pairs(tokens, record).count();
    tokens.record(record).iter().any(|p| p.code == 101) && own > 0
}

/// The record's handle as written, upper case (group 5, in a DIMSTYLE 105).
pub(super) fn handle_of(tokens: &Tokens<'_>, record: usize) -> Option<String> {
    let code = if tokens.name(record) == b"DIMSTYLE" { 105 } else { 5 };
    let pair = tokens.record(record).iter().find(|p| p.code == code)?;
    let text = String::from_utf8_lossy(tokens.value(pair)).to_ascii_uppercase();
    (!text.is_empty()).then_some(text)
}

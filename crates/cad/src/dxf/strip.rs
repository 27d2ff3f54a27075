//! Takes our result layers out of a drawing that comes back with them.

use super::additions::{LayerTable, count_splice};
use super::colour::nearest_index;
use super::fields::{Fields, polyline_records};
use super::header::Header;
use super::limits::Limits;
use super::tokens::{Tokens, tokenize};
use crate::own_layers::{BEFORE, BEFORE_RGB, MOVED, MOVED_RGB, NOTE, NOTE_RGB, is_result};
use crate::splice::{Splice, apply};

/// The drawing without what we drew on our result layers and, where nothing else uses them, without
/// those layers. What somebody else drew there, markers, `$HANDSEED` and everything else stay as they are.
/// Bytes that are no DXF, or hold nothing of ours, come back as they are.
pub fn strip_own(bytes: &[u8]) -> Vec<u8> {
    let Ok(tokens) = tokenize(bytes, &Limits::default()) else { return bytes.to_vec() };
    let page = Header::read(&tokens).page(&tokens);
    let name = |record: usize, code: i32| Fields::of(&tokens, record).value(code).map(|n| page.decode(n));
    let is_own = |record: usize| name(record, 8).is_some_and(|layer| is_ours(&tokens, record, &layer));
    let mut splices = Vec::new();
    let section = tokens.section(b"ENTITIES").unwrap_or(0..0);
    let mut removed = vec![false; tokens.records.len()];
    for record in section {
        if !removed[record] && is_own(record) {
            let end = if tokens.name(record) == b"POLYLINE" {
                polyline_records(&tokens, record).1
            } else {
                record + 1
            };
            removed[record..end].fill(true);
            splices.push(cut(&tokens, record, end));
        }
    }
    if let Some(table) = LayerTable::find_with(&tokens, page) {
        let is_used = |layer: &[u8]| {
            (0..tokens.records.len())
                .filter(|&r| !removed[r])
                .any(|r| Fields::of(&tokens, r).value(8) == Some(layer))
        };
        let layers = table.layers.clone().filter(|&r| name(r, 2).is_some_and(|n| is_result(&n)));
        let unused: Vec<usize> =
            layers.filter(|&r| Fields::of(&tokens, r).value(2).is_some_and(|name| !is_used(name))).collect();
        splices.extend(unused.iter().map(|&record| cut(&tokens, record, record + 1)));
        let count = Fields::of(&tokens, table.head).index(70).filter(|_| !unused.is_empty());
        splices.extend(count.and_then(|i| count_splice(&tokens, i, -(unused.len() as i64))));
    }
    apply("", "dxf-edit-twice", bytes, splices).unwrap_or_else(|_| bytes.to_vec())
}

/// Whether we drew an entity of a layer: of the kinds that we draw there, and in our very colour. CAD programs keep both;
/// nobody who draws there himself comes upon both, since what is drawn takes the colour of its layer.
fn is_ours(tokens: &Tokens<'_>, record: usize, layer: &str) -> bool {
    if !is_result(layer) {
        return false;
    }
    let is_text = tokens.name(record) == b"TEXT";
    let is_path = [&b"LWPOLYLINE"[..], b"POLYLINE"].contains(&tokens.name(record));
    let on = |own: &str| own.eq_ignore_ascii_case(layer);
    match () {
        () if on(MOVED) => is_path && has_colour(tokens, record, MOVED_RGB),
        () if on(BEFORE) => is_path && has_colour(tokens, record, BEFORE_RGB),
        () if on(NOTE) || is_text => is_text && has_colour(tokens, record, NOTE_RGB),
        () => tokens.name(record) == b"SOLID" && colours(tokens, record).iter().any(Option::is_some),
    }
}

/// True colour and number of the colour of an entity, where it has its own.
fn colours(tokens: &Tokens<'_>, record: usize) -> [Option<i64>; 2] {
    let fields = Fields::of(tokens, record);
    let number = |code: i32| fields.index(code).and_then(|i| tokens.integer(&tokens.pairs[i]));
    [number(420), number(62).filter(|n| (1..=255).contains(n))]
}

/// Whether an entity has a colour: the true one where it is told, else the nearest with a number.
fn has_colour(tokens: &Tokens<'_>, record: usize, rgb: [u8; 3]) -> bool {
    let [r, g, b] = rgb.map(i64::from);
    match colours(tokens, record) {
        [Some(own), _] => own == (r << 16 | g << 8 | b),
        [None, own] => own == Some(i64::from(nearest_index(rgb))),
    }
}

fn cut(tokens: &Tokens<'_>, from: usize, to: usize) -> Splice {
    let end = if to < tokens.records.len() { tokens.record_start(to) } else { tokens.end };
    Splice { start: tokens.record_start(from), end, with: Vec::new() }
}

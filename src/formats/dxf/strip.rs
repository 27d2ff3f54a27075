//! Takes our result layers out of a drawing that comes back with them.

use super::additions::{LayerTable, count_splice};
use super::fields::{Fields, polyline_records};
use super::header::Header;
use super::limits::Limits;
use super::tokens::{Tokens, tokenize};
use crate::formats::splice::{Splice, apply};

/// Layers on which results are drawn, in upper case; [`HEAT_PREFIX`] besides.
const RESULT_LAYERS: [&str; 3] = ["EF-MOVED", "EF-BEFORE", "EF-NOTE"];

/// Heat map layers start so.
const HEAT_PREFIX: &str = "EF-HEAT-";

/// Whether a layer is one that results are drawn on (the user's markers are not).
pub fn is_result_layer(name: &str) -> bool {
    let name = name.to_uppercase();
    RESULT_LAYERS.contains(&name.as_str()) || name.starts_with(HEAT_PREFIX)
}

/// The drawing without the entities of our result layers and, where nothing else uses them, without
/// those layers. Markers, `$HANDSEED` and everything else stay as they are. Bytes that are no DXF, or
/// hold nothing of ours, come back as they are.
pub fn strip_own(bytes: &[u8]) -> Vec<u8> {
    let Ok(tokens) = tokenize(bytes, &Limits::default()) else { return bytes.to_vec() };
    let page = Header::read(&tokens).page(&tokens);
    let is_own = |record: usize, code: i32| {
        let name = Fields::of(&tokens, record).value(code);
        name.is_some_and(|name| is_result_layer(&page.decode(name)))
    };
    let mut splices = Vec::new();
    let section = tokens.section(b"ENTITIES").unwrap_or(0..0);
    let mut removed = vec![false; tokens.records.len()];
    for record in section {
        if !removed[record] && is_own(record, 8) {
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
        let layers = table.layers.clone().filter(|&r| is_own(r, 2));
        let unused: Vec<usize> =
            layers.filter(|&r| Fields::of(&tokens, r).value(2).is_some_and(|name| !is_used(name))).collect();
        splices.extend(unused.iter().map(|&record| cut(&tokens, record, record + 1)));
        let count = Fields::of(&tokens, table.head).index(70).filter(|_| !unused.is_empty());
        splices.extend(count.and_then(|i| count_splice(&tokens, i, -(unused.len() as i64))));
    }
    apply("", "dxf-edit-twice", bytes, splices).unwrap_or_else(|_| bytes.to_vec())
}

fn cut(tokens: &Tokens<'_>, from: usize, to: usize) -> Splice {
    let end = if to < tokens.records.len() { tokens.record_start(to) } else { tokens.end };
    Splice { start: tokens.record_start(from), end, with: Vec::new() }
}

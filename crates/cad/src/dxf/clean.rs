//! Takes what was demolished out of a drawing, with what stands only for it.

use std::collections::{BTreeMap, BTreeSet, HashSet};

use super::additions::{LayerTable, count_splice, value_splice};
use super::fields::{Fields, attributes, own_pairs, polyline_records};
use super::header::Header;
use super::patch::tokens_of;
use super::text::CodePage;
use super::tokens::Tokens;
use crate::own_layers::is_demolished;
use crate::splice::{Splice, apply};
use enfilade_report::Error;

/// Records that belong to the one before them.
const BELONGING: [&[u8]; 3] = [b"VERTEX", b"ATTRIB", b"SEQEND"];
/// Records that only list others: one name less.
const LISTS: [&[u8]; 4] = [b"GROUP", b"VIEWPORT", b"IDBUFFER", b"LAYER_FILTER"];

/// The drawing without the entities of the layer of what was demolished, in blocks too, and how many those were. Groups
/// and dictionaries no longer name them; what belonged to them alone goes too. The layer goes where nothing else
/// uses it.
///
/// # Errors
/// [`Error::Input`] where the bytes are no DXF.
pub fn without_demolished(file: &str, bytes: &[u8]) -> Result<(Vec<u8>, usize), Error> {
    let tokens = tokens_of(file, bytes)?;
    let mut cleaning = Cleaning::new(&tokens);
    let count = cleaning.entities();
    if count == 0 {
        return Ok((bytes.to_vec(), 0));
    }
    while cleaning.dependents() {}
    cleaning.layer();
    for record in (0..tokens.records.len()).filter(|&r| !cleaning.removed[r]).collect::<Vec<_>>() {
        cleaning.pointers(record);
    }
    let splices = cleaning.into_splices();
    Ok((apply(file, "dxf-edit-twice", bytes, splices)?, count))
}

/// What goes.
struct Cleaning<'t, 'a> {
    tokens: &'t Tokens<'a>,
    page: CodePage,
    /// By record.
    removed: Vec<bool>,
    /// Handles of what goes.
    gone: HashSet<u64>,
    /// Single pairs that go.
    pairs: BTreeSet<usize>,
    /// Counts that fall, by their pair.
    less: BTreeMap<usize, i64>,
    splices: Vec<Splice>,
}

fn hex(value: &[u8]) -> Option<u64> {
    u64::from_str_radix(std::str::from_utf8(value).ok()?, 16).ok()
}

/// Whether a group names another object.
fn is_pointer(code: i32) -> bool {
    matches!(code, 320..=369 | 390..=399 | 480 | 481 | 1005)
}

impl<'t, 'a> Cleaning<'t, 'a> {
    fn new(tokens: &'t Tokens<'a>) -> Self {
        Self {
            tokens,
            page: Header::read(tokens).page(tokens),
            removed: vec![false; tokens.records.len()],
            gone: HashSet::new(),
            pairs: BTreeSet::new(),
            less: BTreeMap::new(),
            splices: Vec::new(),
        }
    }

    fn remove(&mut self, record: usize) {
        self.removed[record] = true;
        self.gone.extend(super::fields::handle_of(self.tokens, record).and_then(|h| hex(h.as_bytes())));
    }

    /// Marks the entities of the layer with the records that belong to them; how many.
    fn entities(&mut self) -> usize {
        let tokens = self.tokens;
        let sections = [&b"ENTITIES"[..], b"BLOCKS"].map(|name| tokens.section(name).unwrap_or(0..0));
        let mut count = 0;
        for record in sections.into_iter().flatten() {
            let name = tokens.name(record);
            let is_other = BELONGING.contains(&name) || matches!(name, b"BLOCK" | b"ENDBLK");
            let layer = Fields::of(tokens, record).value(8).map(|layer| self.page.decode(layer));
            if is_other || !layer.is_some_and(|layer| is_demolished(&layer)) {
                continue;
            }
            count += 1;
            (record..end_of(tokens, record)).for_each(|r| self.remove(r));
        }
        count
    }

    /// Marks objects that what goes owns, ties of dimensions to it, and groups of nothing else; whether there were any.
    fn dependents(&mut self) -> bool {
        let before = self.gone.len();
        for record in self.tokens.section(b"OBJECTS").unwrap_or(0..0) {
            if !self.removed[record] && self.depends(record) {
                self.remove(record);
            }
        }
        self.gone.len() > before
    }

    fn depends(&self, record: usize) -> bool {
        let is_gone = |code: i32| {
            let own = own_pairs(self.tokens, record).filter(move |(_, p)| p.code == code);
            own.map(|(_, p)| hex(self.tokens.value(p)).is_some_and(|h| self.gone.contains(&h)))
        };
        let mut members = is_gone(340).peekable();
        match self.tokens.name(record) {
            b"GROUP" if members.peek().is_some() && members.all(|gone| gone) => true,
            b"DIMASSOC" if is_gone(331).any(|gone| gone) => true,
            // The first of them is the owner.
            _ => is_gone(330).next().unwrap_or(false),
        }
    }

    /// Takes the layer away where nothing is left that names it.
    fn layer(&mut self) {
        let Some(table) = LayerTable::find_with(self.tokens, self.page) else { return };
        let layer = |value: &[u8]| is_demolished(&self.page.decode(value));
        let is_used = (0..self.tokens.records.len()).filter(|&r| !self.removed[r]).any(|r| {
            let pairs = self.tokens.record(r).iter();
            pairs.filter(|p| matches!(p.code, 8 | 1003)).any(|p| layer(self.tokens.value(p)))
        });
        let is_named = |&r: &usize| Fields::of(self.tokens, r).value(2).is_some_and(layer);
        let entries: Vec<usize> = table.layers.clone().filter(|r| !is_used && is_named(r)).collect();
        if let Some(count) = Fields::of(self.tokens, table.head).index(70)
            && !entries.is_empty()
        {
            *self.less.entry(count).or_default() += entries.len() as i64;
        }
        entries.into_iter().for_each(|r| self.remove(r));
    }

    /// Lets nothing in a record name what goes.
    fn pointers(&mut self, record: usize) {
        let tokens = self.tokens;
        let mut group: Option<usize> = None;
        for i in tokens.span(record) {
            let pair = &tokens.pairs[i];
            match pair.code {
                102 if tokens.value(pair).starts_with(b"{") => group = Some(i),
                102 => {
                    let inner = group.take().map(|open| open + 1..i).filter(|inner| !inner.is_empty());
                    if let Some(inner) = inner.filter(|inner| inner.clone().all(|k| self.pairs.contains(&k)))
                    {
                        self.pairs.extend([inner.start - 1, i]);
                    }
                }
                code if is_pointer(code)
                    && hex(tokens.value(pair)).is_some_and(|h| self.gone.contains(&h)) =>
                {
                    self.pointer(record, i, group.is_some());
                }
                _ => {}
            }
        }
    }

    /// One group that names what goes: out of a list, else nothing is named.
    fn pointer(&mut self, record: usize, i: usize, is_in_group: bool) {
        let tokens = self.tokens;
        let code = |i: usize| tokens.pairs.get(i).map(|p| p.code);
        let name = tokens.name(record);
        match (name, tokens.pairs[i].code) {
            _ if is_in_group => drop(self.pairs.insert(i)),
            (b"DICTIONARY" | b"ACDBDICTIONARYWDFLT", 350 | 360) if code(i - 1) == Some(3) => {
                self.pairs.extend([i - 1, i]);
            }
            (b"SORTENTSTABLE", 331) if code(i + 1) == Some(5) => self.pairs.extend([i, i + 1]),
            (b"HATCH", 330) => {
                self.pairs.insert(i);
                self.boundary(record, i);
            }
            (_, 330 | 331 | 340 | 341) if LISTS.contains(&name) => drop(self.pairs.insert(i)),
            _ => self.splices.push(value_splice(tokens, i, b"0")),
        }
    }

    /// A hatch has one line less that it follows: it follows none any more.
    fn boundary(&mut self, record: usize, i: usize) {
        let (tokens, span) = (self.tokens, self.tokens.span(record));
        let is = |k: usize, code: i32| tokens.pairs[k].code == code;
        if let Some(count) = (span.start..i).rev().find(|k| is(*k, 97)) {
            *self.less.entry(count).or_default() += 1;
        }
        if let Some(follows) = span.clone().find(|k| is(*k, 71)) {
            let on = tokens.integer(&tokens.pairs[follows]).unwrap_or(0);
            self.less.insert(follows, on);
        }
    }

    fn into_splices(mut self) -> Vec<Splice> {
        let tokens = self.tokens;
        let start = |record: usize| {
            if record < tokens.records.len() { tokens.record_start(record) } else { tokens.end }
        };
        let removed = (0..self.removed.len()).filter(|&r| self.removed[r]);
        let records = removed.map(|r| Splice::new(start(r)..start(r + 1), ""));
        let pairs =
            self.pairs.iter().map(|&i| Splice::new(tokens.pair_start(i)..tokens.pair_start(i + 1), ""));
        let less = self.less.iter().filter_map(|(&i, by)| count_splice(tokens, i, -by));
        self.splices.extend(records.chain(pairs).chain(less));
        self.splices
    }
}

/// One past the last record of an entity.
fn end_of(tokens: &Tokens<'_>, record: usize) -> usize {
    match tokens.name(record) {
        b"POLYLINE" => polyline_records(tokens, record).1,
        b"INSERT" => {
            let end = attributes(tokens, record).end;
            let has_end = end > record + 1 && end < tokens.records.len();
            end + usize::from(has_end && tokens.name(end) == b"SEQEND")
        }
        _ => record + 1,
    }
}

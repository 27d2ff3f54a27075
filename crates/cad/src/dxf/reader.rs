//! What all parts of the reader share: the tokens, the decoded names, and where findings go.

use std::collections::{BTreeMap, HashMap, HashSet};

use glam::{DVec2, DVec3};

use super::fields::{Fields, handle_of};
use super::header::{Header, is_sane};
use super::limits::Limits;
use super::text::CodePage;
use super::tokens::{Pair, Tokens, shown};
use crate::drawing::{Entity, Layer, Origin, Pen, Record, SourceRef, Undrawn};
use enfilade_report::{Error, Place, Report, Severity};

/// One reading of one file.
pub(super) struct Reader<'a, 'r> {
    /// File name for places.
    pub file: &'a str,
    /// The file as pairs.
    pub tokens: &'a Tokens<'a>,
    /// Its code page.
    pub page: CodePage,
    /// The limits in force.
    pub limits: Limits,
    /// Five millimetres in drawing units, where the unit is known.
    pub five_mm: Option<f64>,
    /// Largest sane coordinate, drawing units.
    pub max_coordinate: f64,
    /// The layers met so far.
    pub layers: Layers<'a>,
    /// Names of the types of line that have gaps or not, and of the layers whose lines have, in capitals.
    dashed: Dashed,
    /// First record of each handle among the entities.
    pub handles: HashMap<&'a [u8], usize>,
    /// Filled areas met so far.
    pub fills: Vec<Entity>,
    /// Widths of polylines met so far, by record.
    pub widths: BTreeMap<usize, f64>,
    /// Record kinds left out, with their numbers.
    pub left_out: BTreeMap<String, usize>,
    /// What is drawn and no line of the plan, by layer, kind and whether it stands on paper.
    pub undrawn: BTreeMap<(&'a [u8], &'a [u8], bool), usize>,
    /// External files that are shown and were not opened.
    pub unbound: usize,
    /// What is hidden and may be a wall.
    pub unseen: Unseen,
    /// Records met so far that draw something, on no paper.
    pub records: Vec<Record>,
    report: &'r mut Report,
    note_counts: BTreeMap<&'static str, usize>,
}

/// What is hidden, by what hides it and by layer.
#[derive(Default)]
pub(super) struct Unseen {
    /// Invisible themselves (group 60).
    pub invisible: BTreeMap<u32, usize>,
    /// In blocks whose INSERTs stand on a hidden layer.
    pub in_blocks: BTreeMap<u32, usize>,
}

/// What draws lines with gaps, in capitals.
#[derive(Default)]
struct Dashed {
    /// Whether a type of line has gaps.
    types: HashMap<Vec<u8>, bool>,
    /// Layers whose lines have gaps unless they say otherwise.
    layers: HashSet<Vec<u8>>,
}

impl Dashed {
    /// Whether a type of line is another than the usual ones, and whether it has gaps, on a layer if it leaves it to
    /// that. One that the file does not describe has.
    fn draws(&self, line: &[u8], layer: Option<&[u8]>) -> [bool; 2] {
        match line {
            b"" | b"BYLAYER" => [false, layer.is_some_and(|l| self.layers.contains(&capitals(l)))],
            b"BYBLOCK" | b"CONTINUOUS" => [false; 2],
            name => [true, self.types.get(name).copied().unwrap_or(true)],
        }
    }
}

fn capitals(name: &[u8]) -> Vec<u8> {
    name.trim_ascii().to_ascii_uppercase()
}

/// Layers by name; names differ by more than case.
#[derive(Default)]
pub(super) struct Layers<'a> {
    /// Table order, then those only used.
    pub list: Vec<Layer>,
    by_name: HashMap<String, u32>,
    by_bytes: HashMap<&'a [u8], u32>,
}

impl<'a> Layers<'a> {
    /// Index of the layer of this name, added if new.
    pub fn index(&mut self, bytes: &'a [u8], page: CodePage) -> u32 {
        if let Some(&index) = self.by_bytes.get(bytes) {
            return index;
        }
        let name = page.decode(bytes);
        let next = self.list.len() as u32;
        let index = *self.by_name.entry(name.to_uppercase()).or_insert(next);
        if index == next {
            self.list.push(Layer { name, is_off: false, is_frozen: false, is_locked: false });
        }
        self.by_bytes.insert(bytes, index);
        index
    }

    /// Index of the layer of a name in capitals.
    pub fn of_name(&self, capitals: &str) -> Option<u32> {
        self.by_name.get(capitals).copied()
    }

    /// Name of a layer.
    pub fn name(&self, index: u32) -> &str {
        &self.list[index as usize].name
    }
}

impl<'a, 'r> Reader<'a, 'r> {
    /// Starts a reading.
    pub fn new(
        file: &'a str,
        tokens: &'a Tokens<'a>,
        header: &Header,
        options: &super::ReadOptions,
        report: &'r mut Report,
    ) -> Self {
        let unit = options.unit.or(header.unit());
        Self {
            file,
            tokens,
            page: header.page(tokens),
            limits: options.limits,
            five_mm: unit.map(|unit| super::curves::CURVE_TOLERANCE_M / unit.metres),
            max_coordinate: header.max_coordinate(options.unit, options.limits.max_coordinate_m),
            layers: Layers::default(),
            dashed: Dashed::default(),
            handles: HashMap::new(),
            fills: Vec::new(),
            widths: BTreeMap::new(),
            left_out: BTreeMap::new(),
            undrawn: BTreeMap::new(),
            unbound: 0,
            unseen: Unseen::default(),
            records: Vec::new(),
            report,
            note_counts: BTreeMap::new(),
        }
    }

    /// Where a record stands: `plan.dxf:57 LINE 2F3 layer A-WALL`.
    pub fn place(&self, record: usize) -> Place {
        let fields = Fields::of(self.tokens, record);
        let mut words = shown(self.tokens.name(record));
        if let Some(handle) = handle_of(self.tokens, record) {
            words += &format!(" {handle}");
        }
        if let Some(layer) = fields.value(8) {
            words += &format!(" layer {}", self.page.decode(layer));
        }
        let place = self.tokens.place(self.file, self.tokens.span(record).start);
        if !place.entity.is_empty() {
            words = format!("{} {words}", place.entity);
        }
        place.entity(words)
    }

    /// A finding at a record; of one kind only the first few are listed.
    pub fn note(&mut self, code: &'static str, severity: Severity, record: usize, text: impl Into<String>) {
        let count = self.note_counts.entry(code).or_default();
        *count += 1;
        if *count <= self.limits.max_notes {
            let place = self.place(record);
            self.report.add(code, severity, place, text);
        }
    }

    /// A finding about the whole file.
    pub fn note_file(&mut self, code: &'static str, severity: Severity, text: impl Into<String>) {
        self.report.add(code, severity, Place::file(self.file), text);
    }

    /// Something left out, at a record.
    pub fn warn(&mut self, code: &'static str, record: usize, text: impl Into<String>) {
        self.note(code, Severity::Warning, record, text);
    }

    /// Says how many findings were not listed.
    pub fn finish_notes(&mut self) {
        for (code, count) in std::mem::take(&mut self.note_counts) {
            if let Some(more) = count.checked_sub(self.limits.max_notes).filter(|&more| more > 0) {
                let severity = self.report.problems.iter().find(|p| p.code == code).map(|p| p.severity);
                let text = format!("{more} more findings of the kind {code}, not listed one by one");
                self.report.add(code, severity.unwrap_or(Severity::Info), Place::file(self.file), text);
            }
        }
    }

    /// A number that must be one: NaN and infinities pass, text does not.
    pub fn number(&self, pair: &Pair, record: usize) -> Result<f64, Error> {
        self.tokens.number(pair).ok_or_else(|| self.bad(pair, record, "a number like 1.5"))
    }

    /// A group of a record as a number.
    pub fn float(&self, fields: &Fields<'_, '_>, code: i32, default: f64) -> Result<f64, Error> {
        fields.pair(code).map_or(Ok(default), |pair| self.number(pair, fields.record))
    }

    /// A group of a record as a whole number.
    pub fn int(&self, fields: &Fields<'_, '_>, code: i32, default: i64) -> Result<i64, Error> {
        let Some(pair) = fields.pair(code) else { return Ok(default) };
        self.tokens.integer(pair).ok_or_else(|| self.bad(pair, fields.record, "a whole number"))
    }

    /// Groups `code`, `code + 10`, `code + 20` as a point; missing ones are 0.
    pub fn point(&self, fields: &Fields<'_, '_>, code: i32) -> Result<DVec3, Error> {
        Ok(DVec3::new(
            self.float(fields, code, 0.0)?,
            self.float(fields, code + 10, 0.0)?,
            self.float(fields, code + 20, 0.0)?,
        ))
    }

    /// The extrusion vector, +z where none is given.
    pub fn extrusion(&self, fields: &Fields<'_, '_>) -> Result<DVec3, Error> {
        if fields.pair(230).is_none() && fields.pair(210).is_none() && fields.pair(220).is_none() {
            return Ok(DVec3::Z);
        }
        Ok(DVec3::new(
            self.float(fields, 210, 0.0)?,
            self.float(fields, 220, 0.0)?,
            self.float(fields, 230, 1.0)?,
        ))
    }

    fn bad(&self, pair: &Pair, record: usize, expected: &str) -> Error {
        let index = (pair as *const Pair as usize - self.tokens.pairs.as_ptr() as usize) / size_of::<Pair>();
        let mut place = self.place(record);
        place.line = place.line.map(|_| self.tokens.line(index) + 1);
        let found = shown(self.tokens.value(pair));
        let text = format!(
            "group {}, found `{found}`, expected {expected}; the file was not read, because a guess could \
             move a wall. Correct this line or export the drawing again",
            pair.code
        );
        Error::input("dxf-bad-number", place, text)
    }

    /// Whether a point is finite and within the coordinate limit.
    pub fn is_sane(&self, p: DVec2) -> bool {
        is_sane(p, self.max_coordinate)
    }

    /// Layer of a record: group 8, `0` where it is missing.
    pub fn layer(&mut self, fields: &Fields<'_, 'a>) -> u32 {
        self.layers.index(fields.value(8).unwrap_or(b"0"), self.page)
    }

    /// Counts a record that is drawn and gives no line of the plan.
    pub fn count_undrawn(&mut self, fields: &Fields<'_, 'a>, is_on_paper: bool) {
        let (layer, name) = (fields.value(8).unwrap_or(b"0"), self.tokens.name(fields.record));
        *self.undrawn.entry((layer, name, is_on_paper)).or_default() += 1;
    }

    /// What was counted so far, by layer and kind; the counts start again.
    pub fn take_undrawn(&mut self) -> Vec<Undrawn> {
        let counted = std::mem::take(&mut self.undrawn).into_iter();
        let of = |((layer, name, is_on_paper), count)| Undrawn {
            layer: self.page.decode(layer),
            kind: shown(name),
            is_on_paper,
            count,
        };
        let mut out: Vec<Undrawn> = counted.map(of).collect();
        out.sort();
        out
    }

    /// Says so where a handle stands a second time.
    pub fn check_handle(&mut self, fields: &Fields<'_, 'a>) {
        let Some(handle) = fields.value(5) else { return };
        let first = *self.handles.entry(handle).or_insert(fields.record);
        if first != fields.record {
            let other = self.tokens.place("", self.tokens.span(first).start);
            let other = other.line.map_or(other.entity, |line| format!("line {line}"));
            let text = format!(
                "its handle, found also at {other}, expected each once; both are kept, told apart by their lines"
            );
            self.note("dxf-duplicate-handle", Severity::Info, fields.record, text);
        }
    }

    /// Keeps a record that draws something.
    pub fn keep_record(&mut self, record: usize) {
        let (handle, kind) = (handle_of(self.tokens, record), shown(self.tokens.name(record)));
        self.records.push(Record { record, handle, kind });
    }

    /// The join to the file for a record.
    pub fn source(&self, record: usize, layer: u32) -> SourceRef {
        SourceRef {
            record,
            handle: handle_of(self.tokens, record),
            line: self.tokens.source_line(record),
            kind: shown(self.tokens.name(record)),
            layer: self.layers.name(layer).to_owned(),
        }
    }

    /// The record that draws something, with its pen.
    pub fn origin(&self, record: usize) -> Origin {
        let fields = Fields::of(self.tokens, record);
        let number = |code: i32| fields.pair(code).and_then(|p| self.tokens.integer(p));
        // 256 and −1 leave it to the layer.
        let said = |code: i32, range: std::ops::Range<i64>| {
            number(code).filter(|n| range.contains(n)).map_or(0, |n| n as u16 + 1)
        };
        let line = capitals(fields.value(6).unwrap_or_default());
        let [is_own_line, has_gaps] = self.dashed.draws(&line, fields.value(8));
        let pen = Pen { colour: said(62, 0..256), weight: said(370, 0..1000), is_own_line };
        Origin { record, handle: handle_of(self.tokens, record), pen, has_gaps, inserts: Vec::new() }
    }

    /// Reads the LAYER table.
    pub fn read_layers(&mut self) {
        let Some(tables) = self.tokens.section(b"TABLES") else { return };
        for record in tables.clone().filter(|r| self.tokens.name(*r) == b"LTYPE") {
            let fields = Fields::of(self.tokens, record);
            let pieces = fields.pair(73).and_then(|p| self.tokens.integer(p)).unwrap_or(0);
            if let Some(name) = fields.value(2) {
                self.dashed.types.insert(capitals(name), pieces > 0);
            }
        }
        for record in tables.filter(|r| self.tokens.name(*r) == b"LAYER") {
            let fields = Fields::of(self.tokens, record);
            let Some(name) = fields.value(2) else { continue };
            if self.dashed.draws(&capitals(fields.value(6).unwrap_or_default()), None)[1] {
                self.dashed.layers.insert(capitals(name));
            }
            let index = self.layers.index(name, self.page) as usize;
            let int = |code| fields.pair(code).and_then(|p| self.tokens.integer(p)).unwrap_or(0);
            let layer = &mut self.layers.list[index];
            layer.is_off = int(62) < 0;
            layer.is_frozen = int(70) & 1 != 0;
            layer.is_locked = int(70) & 4 != 0;
        }
    }
}

//! What we add to a drawing: entities on our layers, the layers, and handles for both.

use std::collections::HashSet;

use glam::DVec2;

use super::colour::nearest_index;
use super::fields::{Fields, handle_of, own_pairs};
use super::header::Header;
use super::text::{CodePage, text_value};
use super::tokens::{Form, Kind, Tokens, kind_of, number_text, trim};
use crate::drawing::{Addition, Mark};
use crate::splice::Splice;
use enfilade_report::{Error, Place};

/// Handles from here on are no counter of any program; they are stepped over, not followed.
const MAX_COUNTED_HANDLE: u64 = 1 << 48;

/// Distance of text lines in letter heights.
const LINE_PITCH: f64 = 1.5;

/// Adds the splices that put `additions` into the file. What was drawn beside them with the same writer has its handles
/// before theirs.
pub(super) fn splice_in<'t, 'a>(
    file: &str,
    additions: &[Addition],
    mut writer: Writer<'t, 'a>,
    splices: &mut Vec<Splice>,
) -> Result<(), Error> {
    let tokens = writer.tokens;
    let header = Header::read(tokens);
    let fault =
        |text: String| Error::input("dxf-addition", Place::file(file), text + "; nothing was written");
    if let Some(bad) = additions.iter().find(|a| !is_drawable(&a.mark)) {
        return Err(fault(format!(
            "what is to be added on {} has no finite coordinates or no size",
            bad.layer
        )));
    }
    let layers = LayerTable::find(tokens, &writer);
    splices.extend(layers.map(|table| table.with_layers_of(additions, &mut writer)).unwrap_or_default());
    for addition in additions {
        writer.entity(addition);
    }
    let at = tokens.record_start(writer.section_end);
    splices.push(Splice { start: at, end: at, with: writer.take() });
    splices.extend(writer.seed_splice(&header));
    Ok(())
}

fn is_drawable(mark: &Mark) -> bool {
    let finite = |points: &[DVec2]| points.iter().all(|p| p.is_finite());
    match mark {
        Mark::Path { points, .. } => points.len() >= 2 && finite(points),
        Mark::Fill { corners } => finite(corners),
        Mark::Text { at, height, .. } => at.is_finite() && height.is_finite() && *height > 0.0,
    }
}

/// Writes pairs as the file writes them.
pub(super) struct Writer<'t, 'a> {
    /// The record behind the last entity.
    section_end: usize,
    tokens: &'t Tokens<'a>,
    page: CodePage,
    out: Vec<u8>,
    line_end: &'static [u8],
    is_padded: bool,
    /// R13 and later: subclass markers.
    has_subclasses: bool,
    /// R2000 and later: LWPOLYLINE and owners.
    is_modern: bool,
    /// R2004 and later.
    has_true_colour: bool,
    /// Where handles are used: the next one and those taken.
    handles: Option<Handles>,
    owner: Option<Vec<u8>>,
    /// Height of what is drawn, drawing units.
    floor: f64,
}

struct Handles {
    next: u64,
    taken: HashSet<u64>,
}

impl Handles {
    /// Handles of a whole file, pointers to objects that do not exist included.
    fn of(tokens: &Tokens<'_>, header: &Header) -> Self {
        let hex = |value: &[u8]| u64::from_str_radix(std::str::from_utf8(value).ok()?, 16).ok();
        let seed = header.handseed.and_then(|i| hex(tokens.value(&tokens.pairs[i]))).unwrap_or(1);
        let mut taken = HashSet::new();
        let mut record_is_dimstyle = false;
        for (i, pair) in tokens.pairs.iter().enumerate() {
            let is_handle = match pair.code {
                0 => {
                    record_is_dimstyle = tokens.value(pair) == b"DIMSTYLE";
                    false
                }
                5 => !record_is_dimstyle && header.handseed != Some(i),
                105 | 320..=369 | 390..=399 | 480 | 481 | 1005 => true,
                _ => false,
            };
            if is_handle {
                taken.extend(hex(tokens.value(pair)));
            }
        }
        let used = taken.iter().filter(|&&h| h < MAX_COUNTED_HANDLE).max().map_or(1, |h| h + 1);
        let seed = if seed < MAX_COUNTED_HANDLE { seed } else { 1 };
        Self { next: seed.max(used), taken }
    }

    fn fresh(&mut self) -> u64 {
        while self.taken.contains(&self.next) {
            self.next += 1;
        }
        self.next += 1;
        self.next - 1
    }
}

impl<'t, 'a> Writer<'t, 'a> {
    /// A writer for a file.
    ///
    /// # Errors
    /// [`Error::Input`] where it has no section of entities to add to.
    pub fn for_file(file: &str, tokens: &'t Tokens<'a>) -> Result<Self, Error> {
        let section = tokens.section(b"ENTITIES").filter(|s| s.end < tokens.records.len());
        let Some(section) = section else {
            let text = "the drawing has no ENTITIES section to add to; nothing was written";
            return Err(Error::input("dxf-addition", Place::file(file), text));
        };
        Ok(Self::new(tokens, &Header::read(tokens), &section))
    }

    /// What was written since the last time.
    pub fn take(&mut self) -> Vec<u8> {
        std::mem::take(&mut self.out)
    }

    /// A value as another pair of the file has it.
    pub fn raw(&mut self, code: i32, value: &[u8]) {
        self.code(code);
        self.out.extend_from_slice(value);
        let end: &[u8] = match self.tokens.form {
            Form::Ascii => self.line_end,
            Form::Binary { .. } if kind_of(code) == Kind::Text => b"\0",
            Form::Binary { .. } => b"",
        };
        self.out.extend_from_slice(end);
    }

    fn new(tokens: &'t Tokens<'a>, header: &Header, section: &std::ops::Range<usize>) -> Self {
        let version = header.version.as_str();
        let first_line = tokens.bytes.iter().position(|&b| b == b'\n' || b == b'\r').unwrap_or(0);
        let line_end: &[u8] = match tokens.bytes.get(first_line..) {
            Some([b'\r', b'\n', ..]) => b"\r\n",
            Some([b'\r', b'\r', b'\n', ..]) => b"\r\r\n",
            Some([b'\r', ..]) => b"\r",
            _ => b"\n",
        };
        let code_start = tokens.records.first().map_or(0, |_| tokens.record_start(0));
        let in_use = |mut records: std::ops::Range<usize>| records.any(|r| handle_of(tokens, r).is_some());
        // A file without a single handle gets none of whatever version it says it is: readers number such
        // entities themselves, and would give ours to another.
        let has_handles = header.has_handling
            || in_use(section.clone())
            || version >= "AC1012" && in_use(tokens.section(b"TABLES").unwrap_or(0..0));
        Self {
            section_end: section.end,
            tokens,
            page: header.page(tokens),
            out: Vec::new(),
            line_end,
            is_padded: tokens.bytes.get(code_start) == Some(&b' '),
            has_subclasses: version >= "AC1012",
            is_modern: version >= "AC1015",
            has_true_colour: version >= "AC1018",
            handles: has_handles.then(|| Handles::of(tokens, header)),
            owner: model_space_owner(tokens, section).filter(|_| version >= "AC1015"),
            floor: 0.0,
        }
    }

    /// The same for what lies on a floor at a height.
    pub fn on(self, floor: f64) -> Self {
        Self { floor, ..self }
    }

    /// Height of what is drawn, drawing units.
    pub fn floor(&self) -> f64 {
        self.floor
    }

    fn code(&mut self, code: i32) {
        match self.tokens.form {
            Form::Ascii => {
                let text = if self.is_padded { format!("{code:>3}") } else { code.to_string() };
                self.out.extend_from_slice(text.as_bytes());
                self.out.extend_from_slice(self.line_end);
            }
            Form::Binary { wide: false } if code < 255 => self.out.push(code as u8),
            Form::Binary { wide } => {
                if !wide {
                    self.out.push(255);
                }
                self.out.extend_from_slice(&(code as u16).to_le_bytes());
            }
        }
    }

    pub fn bytes(&mut self, code: i32, value: &[u8]) {
        self.code(code);
        self.out.extend_from_slice(value);
        let end: &[u8] = if self.tokens.form == Form::Ascii { self.line_end } else { b"\0" };
        self.out.extend_from_slice(end);
    }

    pub fn text(&mut self, code: i32, value: &str) {
        self.bytes(code, value.as_bytes());
    }

    pub fn float(&mut self, code: i32, value: f64) {
        if self.tokens.form == Form::Ascii {
            self.text(code, &number_text(value));
        } else {
            self.code(code);
            self.out.extend_from_slice(&value.to_le_bytes());
        }
    }

    pub fn int(&mut self, code: i32, value: i32) {
        if self.tokens.form == Form::Ascii {
            self.text(code, &value.to_string());
            return;
        }
        self.code(code);
        match kind_of(code) {
            Kind::Int32 => self.out.extend_from_slice(&value.to_le_bytes()),
            _ => self.out.extend_from_slice(&(value as i16).to_le_bytes()),
        }
    }

    fn point(&mut self, code: i32, at: DVec2) {
        self.float(code, at.x);
        self.float(code + 10, at.y);
        self.float(code + 20, self.floor);
    }

    pub fn handle(&mut self) {
        if let Some(handle) = self.handles.as_mut().map(Handles::fresh) {
            self.text(5, &format!("{handle:X}"));
        }
    }

    fn subclass(&mut self, name: &str) {
        if self.has_subclasses {
            self.text(100, name);
        }
    }

    /// The groups every entity starts with.
    fn begin(&mut self, kind: &str, addition: &Addition) {
        self.text(0, kind);
        self.handle();
        if let Some(owner) = self.owner.clone() {
            self.bytes(330, &owner);
        }
        self.subclass("AcDbEntity");
        let layer = self.page.encode(&addition.layer);
        self.bytes(8, &layer);
        if kind == "SEQEND" {
            return;
        }
        self.int(62, i32::from(nearest_index(addition.rgb)));
        if self.has_true_colour {
            let [r, g, b] = addition.rgb.map(i32::from);
            self.int(420, r << 16 | g << 8 | b);
        }
    }

    fn entity(&mut self, addition: &Addition) {
        match &addition.mark {
            Mark::Path { points, closed } if self.is_modern => {
                self.begin("LWPOLYLINE", addition);
                self.subclass("AcDbPolyline");
                self.int(90, points.len() as i32);
                self.int(70, i32::from(*closed));
                if self.floor != 0.0 {
                    self.float(38, self.floor);
                }
                for p in points {
                    self.float(10, p.x);
                    self.float(20, p.y);
                }
            }
            Mark::Path { points, closed } => self.old_polyline(addition, points, *closed),
            Mark::Fill { corners: [a, b, c, d] } => {
                self.begin("SOLID", addition);
                self.subclass("AcDbTrace");
                for (code, corner) in [(10, a), (11, b), (12, d), (13, c)] {
                    self.point(code, *corner);
                }
            }
            Mark::Text { at, height, text } => {
                for (i, line) in text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty()) {
                    self.begin("TEXT", addition);
                    self.subclass("AcDbText");
                    self.point(10, *at - DVec2::Y * (height * LINE_PITCH * i as f64));
                    self.float(40, *height);
                    let value = self.page.encode(&text_value(line));
                    self.bytes(1, &value);
                    self.subclass("AcDbText");
                }
            }
        }
    }

    fn old_polyline(&mut self, addition: &Addition, points: &[DVec2], closed: bool) {
        self.begin("POLYLINE", addition);
        self.subclass("AcDb2dPolyline");
        self.int(66, 1);
        self.point(10, DVec2::ZERO);
        self.int(70, i32::from(closed));
        for p in points {
            self.begin("VERTEX", addition);
            self.subclass("AcDbVertex");
            self.subclass("AcDb2dVertex");
            self.point(10, *p);
        }
        self.begin("SEQEND", addition);
    }

    /// Brings `$HANDSEED` past the handles given out.
    fn seed_splice(&self, header: &Header) -> Option<Splice> {
        let next = self.handles.as_ref()?.next;
        Some(value_splice(self.tokens, header.handseed?, format!("{next:X}").as_bytes()))
    }
}

/// Replaces the text of a value, its padding kept.
pub(super) fn value_splice(tokens: &Tokens<'_>, index: usize, with: &[u8]) -> Splice {
    let pair = &tokens.pairs[index];
    let raw = tokens.raw(pair);
    let value = trim(raw);
    let start = pair.start as usize + (value.as_ptr() as usize - raw.as_ptr() as usize);
    Splice { start, end: start + value.len(), with: with.to_vec() }
}

/// Replaces a count by itself plus `by`.
pub(super) fn count_splice(tokens: &Tokens<'_>, index: usize, by: i64) -> Option<Splice> {
    let pair = &tokens.pairs[index];
    let is_wide = kind_of(pair.code) == Kind::Int32;
    let most = if is_wide { i32::MAX.into() } else { i16::MAX.into() };
    let count = (tokens.integer(pair)? + by).clamp(0, most);
    let with = match tokens.form {
        Form::Ascii => return Some(value_splice(tokens, index, count.to_string().as_bytes())),
        Form::Binary { .. } if is_wide => (count as i32).to_le_bytes().to_vec(),
        Form::Binary { .. } => (count as i16).to_le_bytes().to_vec(),
    };
    Some(Splice { start: pair.start as usize, end: pair.end as usize, with })
}

/// Handle of model space's block record: from the table, else what the entities say.
fn model_space_owner(tokens: &Tokens<'_>, section: &std::ops::Range<usize>) -> Option<Vec<u8>> {
    let is_model = |record: &usize| {
        let fields = Fields::of(tokens, *record);
        fields.value(2).is_some_and(|name| name.eq_ignore_ascii_case(b"*Model_Space"))
    };
    let table = tokens.section(b"TABLES").unwrap_or(0..0);
    let record = table.filter(|&r| tokens.name(r) == b"BLOCK_RECORD").find(is_model);
    if let Some(handle) = record.and_then(|r| handle_of(tokens, r)) {
        return Some(handle.into_bytes());
    }
    let in_model = |r: &usize| Fields::of(tokens, *r).pair(67).is_none();
    let owner =
        |r: usize| own_pairs(tokens, r).find(|(_, p)| p.code == 330).map(|(_, p)| tokens.value(p).to_vec());
    section.clone().filter(in_model).find_map(owner)
}

/// The LAYER table.
pub(super) struct LayerTable {
    /// Its TABLE record.
    pub head: usize,
    /// Its LAYER records.
    pub layers: std::ops::Range<usize>,
    names: HashSet<String>,
}

impl LayerTable {
    fn find(tokens: &Tokens<'_>, writer: &Writer<'_, '_>) -> Option<Self> {
        Self::find_with(tokens, writer.page)
    }

    /// Finds the table; `None` where the file has none or it does not end.
    pub fn find_with(tokens: &Tokens<'_>, page: CodePage) -> Option<Self> {
        let section = tokens.section(b"TABLES")?;
        let is_layer_table =
            |&r: &usize| tokens.name(r) == b"TABLE" && Fields::of(tokens, r).value(2) == Some(b"LAYER");
        let head = section.clone().find(is_layer_table)?;
        let end = (head + 1..section.end).find(|&r| tokens.name(r) != b"LAYER")?;
        if tokens.name(end) != b"ENDTAB" {
            return None;
        }
        let names = (head + 1..end).filter_map(|r| Fields::of(tokens, r).value(2));
        let names = names.map(|name| page.decode(name).to_uppercase()).collect();
        Some(Self { head, layers: head + 1..end, names })
    }

    /// The record of layer `0`, or the first: the pattern for new ones.
    fn pattern(&self, tokens: &Tokens<'_>) -> Option<usize> {
        let is_zero = |&r: &usize| Fields::of(tokens, r).value(2) == Some(b"0");
        self.layers.clone().find(is_zero).or(self.layers.clone().next())
    }

    fn with_layers_of(mut self, additions: &[Addition], writer: &mut Writer<'_, '_>) -> Vec<Splice> {
        let tokens = writer.tokens;
        let mut added = 0;
        for addition in additions {
            if self.names.insert(addition.layer.to_uppercase()) {
                self.layer(addition, writer);
                added += 1;
            }
        }
        if added == 0 {
            return Vec::new();
        }
        let at = tokens.record_start(self.layers.end);
        let records = Splice { start: at, end: at, with: std::mem::take(&mut writer.out) };
        let count = Fields::of(tokens, self.head).index(70).and_then(|i| count_splice(tokens, i, added));
        [records].into_iter().chain(count).collect()
    }

    fn layer(&self, addition: &Addition, writer: &mut Writer<'_, '_>) {
        let tokens = writer.tokens;
        let pattern = self.pattern(tokens);
        let of_pattern = |code: i32| {
            let record = pattern?;
            own_pairs(tokens, record).find(|(_, p)| p.code == code).map(|(_, p)| tokens.value(p))
        };
        writer.text(0, "LAYER");
        if writer.has_subclasses || of_pattern(5).is_some() {
            writer.handle();
        }
        if let Some(table) =
            handle_of(tokens, self.head).filter(|_| writer.is_modern || of_pattern(330).is_some())
        {
            writer.text(330, &table);
        }
        writer.subclass("AcDbSymbolTableRecord");
        writer.subclass("AcDbLayerTableRecord");
        let name = writer.page.encode(&addition.layer);
        writer.bytes(2, &name);
        writer.int(70, 0);
        writer.int(62, i32::from(nearest_index(addition.rgb)));
        let is_continuous = |name: &&[u8]| name.eq_ignore_ascii_case(b"CONTINUOUS");
        writer.bytes(6, of_pattern(6).filter(is_continuous).unwrap_or(b"CONTINUOUS"));
        if of_pattern(370).is_some() {
            writer.int(370, -3);
        }
        for code in [390, 347, 348] {
            if let Some(value) = of_pattern(code) {
                writer.bytes(code, value);
            }
        }
    }
}

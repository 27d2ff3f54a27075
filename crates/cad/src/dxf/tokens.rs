//! Bytes to group codes and value spans, ASCII and binary alike.
//!
//! Nothing is decoded here but the group codes: a value stays a span of the original bytes until
//! somebody asks for it as a number or text, so what nobody asks for cannot be misread or changed.

use std::ops::Range;

use super::limits::Limits;
use enfilade_report::Place;

/// First 22 bytes of a binary DXF.
pub(crate) const BINARY_SENTINEL: &[u8] = b"AutoCAD Binary DXF\r\n\x1a\0";

/// UTF-8 byte order mark.
pub(super) const BOM: &[u8] = b"\xef\xbb\xbf";

/// Largest group code of the format (1071, an XDATA integer).
pub(super) const MAX_GROUP_CODE: i32 = 1071;

/// Smallest group code of the format (−5, an APP marker).
pub(super) const MIN_GROUP_CODE: i32 = -5;

/// One group code with the span of its value; in ASCII the span is the line without its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Pair {
    /// Group code.
    pub code: i32,
    /// First byte of the value.
    pub start: u32,
    /// One past the last byte of the value.
    pub end: u32,
}

/// How the pairs are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Form {
    /// Two lines a pair.
    Ascii,
    /// Binary; `wide` group codes take two bytes (R13 and later), narrow ones one (R12).
    Binary {
        /// Two-byte group codes.
        wide: bool,
    },
}

/// How a binary DXF stores the value of a group code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// NUL-terminated string.
    Text,
    /// Little-endian 64-bit float.
    Double,
    /// Little-endian 16-bit integer.
    Int16,
    /// Little-endian 32-bit integer.
    Int32,
    /// Little-endian 64-bit integer.
    Int64,
    /// One byte.
    Byte,
    /// A length byte and that many bytes.
    Chunk,
}

/// Value type by group code (DXF reference, "Group Codes in Numerical Order").
pub(super) fn kind_of(code: i32) -> Kind {
    match code {
        10..=59 | 110..=149 | 210..=239 | 460..=469 | 1010..=1059 => Kind::Double,
        60..=79 | 170..=179 | 270..=289 | 370..=389 | 400..=409 | 1060..=1070 => Kind::Int16,
        90..=99 | 420..=429 | 440..=459 | 1071 => Kind::Int32,
        160..=169 => Kind::Int64,
        290..=299 => Kind::Byte,
        310..=319 | 1004 => Kind::Chunk,
        _ => Kind::Text,
    }
}

/// A file as pairs, grouped into records by group code 0.
pub(super) struct Tokens<'a> {
    /// The whole file.
    pub bytes: &'a [u8],
    /// All pairs up to and including `0/EOF`.
    pub pairs: Vec<Pair>,
    /// Index of the first pair of each record.
    pub records: Vec<u32>,
    /// How the file is written.
    pub form: Form,
    /// Whether `0/EOF` was met.
    pub has_eof: bool,
    /// One past the last byte of the last pair, its line end included.
    pub end: usize,
}

/// Why bytes are no pairs; `pair` counts from 0.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Fault {
    /// A line where a group code must stand holds something else.
    GroupCode { pair: usize, byte: usize, text: String },
    /// A group code without a value.
    OddLines { pair: usize, byte: usize },
    /// A line longer than the limit.
    LongLine { pair: usize, bytes: usize },
    /// The file is longer than the limit.
    TooBig,
    /// It has more records, or pairs, than the limit of that name.
    TooMany { what: &'static str, most: usize, limit: &'static str },
}

/// Trims blanks and control characters of both ends.
pub(super) fn trim(mut value: &[u8]) -> &[u8] {
    while let [first, rest @ ..] = value
        && *first <= b' '
    {
        value = rest;
    }
    while let [rest @ .., last] = value
        && *last <= b' '
    {
        value = rest;
    }
    value
}

/// Groups the bytes into pairs and records, up to `0/EOF` or the end.
pub(super) fn tokenize<'a>(bytes: &'a [u8], limits: &Limits) -> Result<Tokens<'a>, Fault> {
    if bytes.len() > limits.max_file_bytes {
        return Err(Fault::TooBig);
    }
    let form = form_of(bytes);
    let mut tokens = Tokens { bytes, pairs: Vec::new(), records: Vec::new(), form, has_eof: false, end: 0 };
    tokens.pairs.reserve((bytes.len() / 14).min(limits.max_pairs));
    match form {
        Form::Ascii => tokens.scan_ascii(limits)?,
        Form::Binary { wide } => tokens.scan_binary(wide, limits)?,
    }
    Ok(tokens)
}

/// ASCII, or binary with one- or two-byte group codes.
pub(super) fn form_of(bytes: &[u8]) -> Form {
    match bytes.strip_prefix(BINARY_SENTINEL) {
        Some([255, ..]) => Form::Binary { wide: false },
        Some([0, second, ..]) if *second != 0 => Form::Binary { wide: false },
        Some(_) => Form::Binary { wide: true },
        None => Form::Ascii,
    }
}

/// End of the line that starts at `pos`, and where the next one starts. Lines end with LF, CRLF,
/// CR CR LF or a lone CR, mixed freely.
fn line_end(bytes: &[u8], pos: usize) -> (usize, usize) {
    let Some(len) = bytes[pos..].iter().position(|&b| b == b'\n' || b == b'\r') else {
        return (bytes.len(), bytes.len());
    };
    let end = pos + len;
    let next = match &bytes[end..] {
        [b'\r', b'\n', ..] => end + 2,
        [b'\r', b'\r', b'\n', ..] => end + 3,
        _ => end + 1,
    };
    (end, next)
}

/// How many lines the bytes are.
pub(super) fn lines_of(bytes: &[u8]) -> usize {
    let (mut pos, mut lines) = (0, 0);
    while pos < bytes.len() {
        pos = line_end(bytes, pos).1;
        lines += 1;
    }
    lines
}

fn group_code(line: &[u8]) -> Option<i32> {
    let line = trim(line);
    let (negative, digits) = match line {
        [b'-', rest @ ..] => (true, rest),
        [b'+', rest @ ..] => (false, rest),
        _ => (false, line),
    };
    if digits.is_empty() || digits.len() > 9 {
        return None;
    }
    let mut code = 0i32;
    for &d in digits {
        code = code * 10 + i32::from(d.is_ascii_digit().then(|| d - b'0')?);
    }
    let code = if negative { -code } else { code };
    (MIN_GROUP_CODE..=MAX_GROUP_CODE).contains(&code).then_some(code)
}

impl<'a> Tokens<'a> {
    fn scan_ascii(&mut self, limits: &Limits) -> Result<(), Fault> {
        let bytes = self.bytes;
        let mut pos = if bytes.starts_with(BOM) { BOM.len() } else { 0 };
        while pos < bytes.len() {
            let pair = self.pairs.len();
            let (code_end, value_start) = line_end(bytes, pos);
            let Some(code) = group_code(&bytes[pos..code_end]) else {
                if value_start >= bytes.len() && trim(&bytes[pos..]).is_empty() {
                    break;
                }
                let text = shown(&bytes[pos..code_end]);
                return Err(Fault::GroupCode { pair, byte: pos, text });
            };
            if value_start >= bytes.len() {
                return Err(Fault::OddLines { pair, byte: pos });
            }
            let (end, next) = line_end(bytes, value_start);
            if end - value_start > limits.max_line_bytes {
                return Err(Fault::LongLine { pair, bytes: end - value_start });
            }
            pos = next;
            self.within(limits)?;
            if self.push(code, value_start, end, next) {
                break;
            }
        }
        Ok(())
    }

    fn scan_binary(&mut self, wide: bool, limits: &Limits) -> Result<(), Fault> {
        let bytes = self.bytes;
        let mut pos = BINARY_SENTINEL.len();
        while pos < bytes.len() {
            let pair = self.pairs.len();
            let cut = Fault::OddLines { pair, byte: pos };
            let (code, value_start) = match (wide, &bytes[pos..]) {
                (true, [lo, hi, ..]) => (i32::from(u16::from_le_bytes([*lo, *hi])), pos + 2),
                (false, [255, lo, hi, ..]) => (i32::from(u16::from_le_bytes([*lo, *hi])), pos + 3),
                (false, [code, ..]) if *code != 255 => (i32::from(*code), pos + 1),
                _ => return Err(cut),
            };
            if code > MAX_GROUP_CODE {
                return Err(Fault::GroupCode { pair, byte: pos, text: code.to_string() });
            }
            let Some((value, next)) = binary_value(bytes, code, value_start) else {
                return Err(cut);
            };
            pos = next;
            self.within(limits)?;
            if self.push(code, value.start, value.end, next) {
                break;
            }
        }
        Ok(())
    }

    /// Whether one more may be added.
    fn within(&self, limits: &Limits) -> Result<(), Fault> {
        let (records, pairs) = (limits.max_records, limits.max_pairs);
        if self.records.len() >= records {
            return Err(Fault::TooMany { what: "records", most: records, limit: "MAX_RECORDS" });
        }
        if self.pairs.len() >= pairs {
            return Err(Fault::TooMany {
                what: "pairs of group code and value",
                most: pairs,
                limit: "MAX_PAIRS",
            });
        }
        Ok(())
    }

    /// Adds a pair; true when it is `0/EOF`.
    fn push(&mut self, code: i32, start: usize, end: usize, next: usize) -> bool {
        if code == 0 {
            self.records.push(self.pairs.len() as u32);
        }
        self.pairs.push(Pair { code, start: start as u32, end: end as u32 });
        self.end = next;
        self.has_eof = code == 0 && trim(&self.bytes[start..end]) == b"EOF";
        self.has_eof
    }

    /// Value of a pair as written, blanks trimmed (a binary number: its raw bytes).
    pub fn value(&self, pair: &Pair) -> &'a [u8] {
        let raw = &self.bytes[pair.start as usize..pair.end as usize];
        if self.form == Form::Ascii || kind_of(pair.code) == Kind::Text { trim(raw) } else { raw }
    }

    /// Value of a pair without its line end, blanks kept.
    pub fn raw(&self, pair: &Pair) -> &'a [u8] {
        &self.bytes[pair.start as usize..pair.end as usize]
    }

    /// Pairs of a record, the group-0 pair first.
    pub fn record(&self, record: usize) -> &[Pair] {
        &self.pairs[self.span(record)]
    }

    /// Pair indices of a record.
    pub fn span(&self, record: usize) -> Range<usize> {
        let next = self.records.get(record + 1).map_or(self.pairs.len(), |&p| p as usize);
        self.records[record] as usize..next
    }

    /// Name of a record, e.g. `LINE`.
    pub fn name(&self, record: usize) -> &'a [u8] {
        self.value(&self.pairs[self.records[record] as usize])
    }

    /// First byte of a record: that of its group code.
    pub fn record_start(&self, record: usize) -> usize {
        self.pair_start(self.records[record] as usize)
    }

    /// First byte of a pair, or one past the last.
    pub fn pair_start(&self, index: usize) -> usize {
        match index {
            0 => self.head(),
            after => self.pair_end(after - 1),
        }
    }

    /// Where the first pair starts.
    fn head(&self) -> usize {
        match self.form {
            Form::Binary { .. } => BINARY_SENTINEL.len(),
            Form::Ascii if self.bytes.starts_with(BOM) => BOM.len(),
            Form::Ascii => 0,
        }
    }

    /// One past the last byte of a pair, its line end included.
    pub fn pair_end(&self, pair: usize) -> usize {
        let end = self.pairs[pair].end as usize;
        match self.form {
            Form::Ascii => line_end(self.bytes, end).1,
            Form::Binary { .. } if kind_of(self.pairs[pair].code) == Kind::Text => end + 1,
            Form::Binary { .. } => end,
        }
    }

    /// Line of a pair's group code, from 1; for a binary file the line it would have in ASCII.
    pub fn line(&self, pair: usize) -> usize {
        2 * pair + 1
    }

    /// Where a pair starts: its line, or its byte in a binary file, which has no lines.
    pub fn place(&self, file: &str, pair: usize) -> Place {
        if self.form == Form::Ascii {
            return Place::line(file, self.line(pair));
        }
        let byte = if pair == 0 { self.head() } else { self.pair_end(pair - 1) };
        Place::file(file).entity(format!("byte {byte}"))
    }

    /// [`SourceRef::line`](crate::drawing::SourceRef::line) of a record.
    pub fn source_line(&self, record: usize) -> usize {
        if self.form == Form::Ascii { self.line(self.span(record).start) } else { 0 }
    }

    /// The value as a number; `None` where it is none. NaN and infinities are numbers here.
    pub fn number(&self, pair: &Pair) -> Option<f64> {
        if self.form == Form::Ascii {
            return parse_number(self.value(pair));
        }
        let raw = self.raw(pair);
        match kind_of(pair.code) {
            Kind::Double => Some(f64::from_le_bytes(raw.try_into().ok()?)),
            Kind::Text => parse_number(trim(raw)),
            Kind::Chunk => None,
            _ => self.integer(pair).map(|i| i as f64),
        }
    }

    /// The value as a whole number (`7` or `7.0`).
    pub fn integer(&self, pair: &Pair) -> Option<i64> {
        let raw = self.raw(pair);
        if self.form != Form::Ascii {
            match kind_of(pair.code) {
                Kind::Int16 => return Some(i16::from_le_bytes(raw.try_into().ok()?).into()),
                Kind::Int32 => return Some(i32::from_le_bytes(raw.try_into().ok()?).into()),
                Kind::Int64 => return Some(i64::from_le_bytes(raw.try_into().ok()?)),
                Kind::Byte => return raw.first().map(|&b| b.into()),
                Kind::Double | Kind::Chunk => return None,
                Kind::Text => {}
            }
        }
        let text = std::str::from_utf8(trim(raw)).ok()?;
        text.parse().ok().or_else(|| {
            let number: f64 = text.parse().ok()?;
            (number.fract() == 0.0 && number.abs() < 1e15).then_some(number as i64)
        })
    }

    /// Records `from..to` between a `SECTION` of this name (its own record excluded) and its `ENDSEC`.
    pub fn section(&self, name: &[u8]) -> Option<Range<usize>> {
        let start = (0..self.records.len()).find(|&r| self.is_section(r, name))?;
        let end = (start + 1..self.records.len())
            .find(|&r| matches!(self.name(r), b"ENDSEC" | b"EOF" | b"SECTION"))
            .unwrap_or(self.records.len());
        Some(start + 1..end)
    }

    /// Whether a record opens the section of this name.
    pub fn is_section(&self, record: usize, name: &[u8]) -> bool {
        self.name(record) == b"SECTION"
            && self.record(record).iter().find(|p| p.code == 2).is_some_and(|p| self.value(p) == name)
    }
}

fn binary_value(bytes: &[u8], code: i32, start: usize) -> Option<(Range<usize>, usize)> {
    let fixed = |len: usize| (start + len <= bytes.len()).then_some((start..start + len, start + len));
    match kind_of(code) {
        Kind::Double | Kind::Int64 => fixed(8),
        Kind::Int32 => fixed(4),
        Kind::Int16 => fixed(2),
        Kind::Byte => fixed(1),
        Kind::Chunk => {
            let end = start + 1 + usize::from(*bytes.get(start)?);
            (end <= bytes.len()).then_some((start + 1..end, end))
        }
        Kind::Text => {
            let len = bytes.get(start..)?.iter().position(|&b| b == 0)?;
            Some((start..start + len, start + len + 1))
        }
    }
}

/// A decimal number, or what C libraries print for NaN and infinity; blanks inside, decimal commas
/// and anything else are no number.
pub(super) fn parse_number(value: &[u8]) -> Option<f64> {
    let text = std::str::from_utf8(value).ok()?;
    if let Ok(number) = text.parse() {
        return Some(number);
    }
    let lower = text.trim_start_matches(['-', '+']).to_ascii_lowercase();
    let is_c_nan = lower.starts_with("1.#") || lower.starts_with("nan(");
    is_c_nan.then_some(f64::NAN)
}

/// A value for a message: lossy, at most 40 characters.
pub(super) fn shown(value: &[u8]) -> String {
    // What is no UTF-8 is shown by its bytes: nothing is guessed, nothing is hidden.
    let chunks = value[..value.len().min(200)].utf8_chunks();
    let text: String =
        chunks.map(|c| c.valid().to_owned() + &c.invalid().escape_ascii().to_string()).collect();
    let clean: String = text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    if clean.chars().count() <= 40 { clean } else { clean.chars().take(39).collect::<String>() + "…" }
}

/// The shortest decimal that reads back as the same number, never with an exponent.
pub(super) fn number_text(value: f64) -> String {
    let text = format!("{value}");
    if text.contains('.') { text } else { text + ".0" }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn group_codes_beyond_the_last_are_no_dxf() {
        let file = |code: i32| format!("{code}\n1\n0\nEOF\n");
        assert!(tokenize(file(MAX_GROUP_CODE).as_bytes(), &Limits::default()).is_ok());
        assert!(tokenize(file(MAX_GROUP_CODE + 1).as_bytes(), &Limits::default()).is_err());
    }

    /// However many there are, the memory for them is bounded by limits that are named.
    #[test]
    fn too_many_records_and_pairs_are_refused() {
        let text = "0\nLINE\n10\n1\n".repeat(10) + "0\nEOF\n";
        let limits = |max_records, max_pairs| Limits { max_records, max_pairs, ..Limits::default() };
        let limit = |limits: Limits| match tokenize(text.as_bytes(), &limits) {
            Err(Fault::TooMany { limit, .. }) => limit,
            _ => "",
        };
        assert_eq!(
            (limit(limits(11, 21)), limit(limits(10, 21)), limit(limits(11, 20))),
            ("", "MAX_RECORDS", "MAX_PAIRS")
        );
    }
}

//! STEP physical files (ISO 10303-21) as byte spans: instances, their arguments, nothing decoded twice.

use std::borrow::Cow;
use std::cmp::Ordering;
use std::collections::HashMap;
use std::ops::Range;

use memchr::{memchr, memchr_iter, memchr2, memchr3};
use rayon::prelude::*;

pub(super) use super::instance::{Arg, Fault, Instance, Value};
use super::limits::{INSTANCE_BYTES_MAX, INSTANCE_MAX, LARGE_ID, NESTING_MAX, within};
use super::plain;

/// Parts of a large file that are taken apart at once: the same on every machine.
const PARTS: usize = 16;

/// Smaller parts are not worth a cut.
const PART_BYTES_MIN: usize = 64 << 10;

/// Bytes that an instance has at least, nearly always.
const INSTANCE_BYTES: usize = 40;

/// Bytes for which line ends are counted together.
const LINE_BLOCK: usize = 16 << 10;

/// A file split into instances.
#[derive(Clone, Debug)]
pub(super) struct Step<'a> {
    /// The whole file.
    pub bytes: &'a [u8],
    /// In file order.
    pub instances: Vec<Instance>,
    /// Upper-case keyword → indices, file order.
    by_keyword: HashMap<Cow<'a, [u8]>, Vec<u32>>,
    /// First schema name, upper case; empty if none is stated.
    pub schema: String,
    /// Where `ENDSEC` of the last DATA section starts, or, where that is missing, what ends the file.
    pub data_end: usize,
    /// Numbers given twice.
    pub duplicates: Vec<u64>,
    /// Instances that could not be split, with the reason.
    pub broken: Vec<Fault>,
    by_id: Ids,
    /// Line ends before each block of [`LINE_BLOCK`] bytes.
    line_ends: Vec<usize>,
}

/// Number → index of the last instance that has it.
#[derive(Clone, Debug)]
enum Ids {
    /// Numbers without large gaps: at its place the index and one, 0 for none.
    Dense(Vec<u32>),
    /// Numbers far apart.
    Sparse(HashMap<u64, u32>),
}

impl Ids {
    /// Numbers per instance up to which a table is smaller than a map.
    const GAPS: u64 = 8;

    fn new(instances: &[Instance]) -> Self {
        let largest = instances.iter().map(|i| i.id).max().unwrap_or(0);
        if largest / Self::GAPS <= instances.len() as u64 {
            Self::Dense(vec![0; largest as usize + 1])
        } else {
            Self::Sparse(HashMap::with_capacity(instances.len()))
        }
    }

    fn get(&self, id: u64) -> Option<usize> {
        match self {
            Self::Dense(at) => at.get(usize::try_from(id).ok()?)?.checked_sub(1).map(|i| i as usize),
            Self::Sparse(at) => at.get(&id).map(|i| *i as usize),
        }
    }

    /// Whether the number was taken before.
    fn insert(&mut self, id: u64, index: u32) -> bool {
        match self {
            Self::Dense(at) => std::mem::replace(&mut at[id as usize], index + 1) != 0,
            Self::Sparse(at) => at.insert(id, index).is_some(),
        }
    }
}

impl<'a> Step<'a> {
    /// Splits a file.
    pub fn read(bytes: &'a [u8]) -> Result<Self, Fault> {
        let mut scan = Scan { bytes, at: 0 };
        let schema = scan.header()?;
        let mut out = Self {
            bytes,
            instances: Vec::new(),
            by_keyword: HashMap::new(),
            schema,
            data_end: bytes.len(),
            duplicates: Vec::new(),
            broken: Vec::new(),
            by_id: Ids::Dense(Vec::new()),
            line_ends: line_ends(bytes),
        };
        out.sections(&mut scan)?;
        out.broken.sort_by_key(|f| f.at);
        out.index();
        Ok(out)
    }

    /// Goes through the sections and takes the instances of each apart.
    fn sections(&mut self, scan: &mut Scan<'a>) -> Result<(), Fault> {
        let (mut in_data, mut is_first) = (true, true);
        loop {
            scan.skip_blank()?;
            let at = scan.at;
            match scan.peek() {
                None => return Ok(()),
                Some(b'#') if in_data => self.take(scan, std::mem::take(&mut is_first))?,
                Some(_) => {
                    let end = scan.statement()?;
                    let word = upper_word(&scan.bytes[at..end]);
                    match word.as_str() {
                        "ENDSEC" => {
                            if in_data {
                                self.data_end = at;
                            }
                            in_data = false;
                        }
                        "DATA" => {
                            in_data = true;
                            self.data_end = self.bytes.len();
                        }
                        "END" if scan.bytes[at..end].to_ascii_uppercase().starts_with(b"END-ISO") => {
                            if in_data {
                                self.data_end = at;
                            }
                            return Ok(());
                        }
                        _ if in_data => {
                            self.broken.push(scan.fault(at, "text that is no instance, expected `#id=`"))
                        }
                        _ => {}
                    }
                }
            }
        }
    }

    /// Takes instances apart up to the first thing that is none: parts of a large file at once, cut where a line begins
    /// with `#`. A part whose cut lay inside an instance is taken apart again from that instance's end.
    fn take(&mut self, scan: &mut Scan<'a>, is_first: bool) -> Result<(), Fault> {
        // Only the first run of instances is cut: a file of many short ones would be cut anew for each.
        let cuts = if is_first { cuts(self.bytes, scan.at) } else { vec![scan.at] };
        let until = |k: usize| cuts.get(k + 1).copied().unwrap_or(self.bytes.len());
        let parts: Vec<Part> =
            (0..cuts.len()).into_par_iter().map(|k| Part::read(self.bytes, cuts[k], until(k))).collect();
        self.instances.reserve(parts.iter().map(|p| p.instances.len()).sum());
        for (k, part) in parts.into_iter().enumerate() {
            let part = match scan.at.cmp(&cuts[k]) {
                Ordering::Equal => part,
                Ordering::Greater if scan.at < until(k) => Part::read(self.bytes, scan.at, until(k)),
                Ordering::Greater => continue,
                Ordering::Less => break,
            };
            self.instances.extend(part.instances);
            within(self.instances.len(), scan.at)?;
            self.broken.extend(part.broken);
            scan.at = part.end?;
        }
        Ok(())
    }

    fn index(&mut self) {
        const RECENT: usize = 256;
        self.by_id = Ids::new(&self.instances);
        let mut lists: Vec<Vec<u32>> = vec![Vec::new()];
        let mut of_keyword: HashMap<Cow<'a, [u8]>, usize> = HashMap::from([(Cow::Borrowed(&b""[..]), 0)]);
        let mut recent: Vec<(Cow<'a, [u8]>, usize)> = vec![(Cow::Borrowed(b""), 0); RECENT];
        for (i, instance) in self.instances.iter().enumerate() {
            if self.by_id.insert(instance.id, i as u32) {
                self.duplicates.push(instance.id);
            }
            let keyword = upper(&self.bytes[instance.keyword.clone()]);
            // Hashed once a keyword, nearly: those of one length and last letters are mostly one.
            let slot = &mut recent
                [(keyword.len() * 7 + keyword.iter().rev().nth(4).map_or(0, |b| *b as usize)) % RECENT];
            if slot.0 != keyword {
                let next = lists.len();
                let list = *of_keyword.entry(keyword.clone()).or_insert(next);
                if list == next {
                    lists.push(Vec::new());
                }
                *slot = (keyword, list);
            }
            lists[slot.1].push(i as u32);
        }
        self.by_keyword =
            of_keyword.into_iter().map(|(k, list)| (k, std::mem::take(&mut lists[list]))).collect();
    }

    /// The instance with that number (the last one of several).
    pub fn get(&self, id: u64) -> Option<&Instance> {
        self.by_id.get(id).map(|i| &self.instances[i])
    }

    /// Instances of a keyword, file order.
    pub fn all(&self, keyword: &str) -> impl Iterator<Item = &Instance> {
        self.by_keyword.get(keyword.as_bytes()).into_iter().flatten().map(|i| &self.instances[*i as usize])
    }

    /// Keyword of an instance, upper case.
    pub fn keyword(&self, id: u64) -> Cow<'a, str> {
        match self.get(id).map(|i| upper(&self.bytes[i.keyword.clone()])) {
            Some(Cow::Borrowed(word)) => String::from_utf8_lossy(word),
            Some(Cow::Owned(word)) => String::from_utf8_lossy(&word).into_owned().into(),
            None => "".into(),
        }
    }

    /// Arguments of an instance; none where it does not exist or its text is no list.
    pub fn args(&self, id: u64) -> Vec<Arg> {
        self.get(id).map_or_else(Vec::new, |i| self.args_of(i))
    }

    /// Arguments of an instance.
    pub fn args_of(&self, instance: &Instance) -> Vec<Arg> {
        let mut at = instance.args.start;
        list::<true>(self.bytes, &mut at, instance.args.end, 0).unwrap_or_default()
    }

    /// The instances that the list of an instance's first argument names, or that argument itself does.
    pub fn first_ids(&self, id: u64) -> Vec<u64> {
        self.plain_ids(id).unwrap_or_else(|| {
            let args = self.args(id);
            args.first().map(|a| a.id().map_or_else(|| a.ids(), |id| vec![id])).unwrap_or_default()
        })
    }

    /// `#1` or `(#1,#2)` at the start of the arguments, without anything between; none where it is written otherwise.
    fn plain_ids(&self, id: u64) -> Option<Vec<u64>> {
        let text = &self.bytes[self.get(id)?.args.clone()];
        let is_list = text.first() == Some(&b'(');
        let mut at = usize::from(is_list);
        let mut out = Vec::new();
        loop {
            at = text.get(at).filter(|b| **b == b'#').map(|_| at + 1)?;
            out.push(whole_number(text, &mut at)?);
            match (text.get(at), is_list) {
                (Some(b','), true) => at += 1,
                (Some(b')'), true) | (None | Some(b','), false) => return Some(out),
                _ => return None,
            }
        }
    }

    /// The numbers of a list of two or three that is an instance's only argument; none where it is written otherwise.
    pub fn coordinates(&self, id: u64) -> Option<[Option<f64>; 3]> {
        let text = &self.bytes[self.get(id)?.args.clone()];
        let inner = text.strip_prefix(b"(")?.strip_suffix(b")")?;
        let mut out = [None; 3];
        let (mut at, mut i) = (0, 0);
        loop {
            let end = memchr(b',', &inner[at..]).map_or(inner.len(), |n| at + n);
            *out.get_mut(i)? = Some(real(&inner[at..end])?);
            if end == inner.len() {
                return out[1].map(|_| out);
            }
            (at, i) = (end + 1, i + 1);
        }
    }

    /// Line of a byte, from 1.
    pub fn line(&self, at: usize) -> usize {
        let at = at.min(self.bytes.len());
        let block = (at / LINE_BLOCK).min(self.line_ends.len() - 1);
        self.line_ends[block] + line_of(&self.bytes[block * LINE_BLOCK..], at - block * LINE_BLOCK)
    }

    /// A text argument, escapes decoded.
    pub fn text(&self, arg: &Arg) -> Option<String> {
        match &arg.value {
            Value::Text => Some(crate::step_text::decode(&self.bytes[arg.span.start + 1..arg.span.end - 1])),
            Value::Typed(_, args) => self.text(args.first()?),
            _ => None,
        }
    }

    /// The largest number in use.
    pub fn largest_id(&self) -> u64 {
        self.instances.iter().map(|i| i.id).max().unwrap_or(0)
    }
}

/// Line ends before each block of [`LINE_BLOCK`] bytes, and before an empty first one.
fn line_ends(bytes: &[u8]) -> Vec<usize> {
    let mut sum = 0;
    let blocks = bytes.chunks(LINE_BLOCK).map(|block| {
        let before = sum;
        sum += memchr_iter(b'\n', block).count();
        before
    });
    let out: Vec<usize> = blocks.collect();
    if out.is_empty() { vec![0] } else { out }
}

/// A keyword in upper case, as nearly all files have it.
fn upper(word: &[u8]) -> Cow<'_, [u8]> {
    if word.iter().any(u8::is_ascii_lowercase) {
        Cow::Owned(word.to_ascii_uppercase())
    } else {
        Cow::Borrowed(word)
    }
}

/// Line of a byte, from 1.
pub(super) fn line_of(bytes: &[u8], at: usize) -> usize {
    memchr_iter(b'\n', &bytes[..at.min(bytes.len())]).count() + 1
}

/// Where a large file is cut to be taken apart at once, the start first.
fn cuts(bytes: &[u8], start: usize) -> Vec<usize> {
    let size = (bytes.len() - start).div_ceil(PARTS);
    let mut out = vec![start];
    if size < PART_BYTES_MIN {
        return out;
    }
    let lines = memchr::memmem::Finder::new(b"\n#");
    for k in 1..PARTS {
        let from = (start + k * size).max(out[out.len() - 1]);
        let Some(found) = lines.find(&bytes[from.min(bytes.len())..]) else { break };
        out.push(from + found + 1);
    }
    out
}

/// Instances between two places of a file.
struct Part {
    instances: Vec<Instance>,
    broken: Vec<Fault>,
    /// Where the next thing stands: at or behind the end that was asked for, or something that is no instance.
    end: Result<usize, Fault>,
}

impl Part {
    fn read(bytes: &[u8], from: usize, until: usize) -> Self {
        let instances = Vec::with_capacity((until - from) / INSTANCE_BYTES);
        let mut out = Self { instances, broken: Vec::new(), end: Ok(from) };
        let mut scan = Scan { bytes, at: from };
        out.end = out.fill(&mut scan, until).map(|()| scan.at);
        out
    }

    fn fill(&mut self, scan: &mut Scan<'_>, until: usize) -> Result<(), Fault> {
        loop {
            scan.skip_blank()?;
            if scan.at >= until || scan.peek() != Some(b'#') {
                return Ok(());
            }
            if let Some(instance) = plain::instance(scan.bytes, scan.at) {
                scan.at = instance.span.end;
                self.instances.push(instance);
                continue;
            }
            let at = scan.at;
            let end = scan.statement()?;
            if end - at > INSTANCE_BYTES_MAX {
                self.broken.push(scan.fault(at, "an instance of more bytes than any building has"));
                continue;
            }
            match instance(scan.bytes, at..end) {
                Ok(instance) => self.instances.push(instance),
                Err(fault) => self.broken.push(fault),
            }
        }
    }
}

struct Scan<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Scan<'_> {
    fn peek(&self) -> Option<u8> {
        self.bytes.get(self.at).copied()
    }

    fn fault(&self, at: usize, text: &str) -> Fault {
        Fault { at, text: format!("found {text}") }
    }

    /// Goes past white space and comments.
    fn skip_blank(&mut self) -> Result<(), Fault> {
        loop {
            match self.peek() {
                Some(b) if b.is_ascii_whitespace() || b == 0 => self.at += 1,
                Some(b'/') if self.bytes.get(self.at + 1) == Some(&b'*') => self.comment()?,
                _ => return Ok(()),
            }
        }
    }

    fn comment(&mut self) -> Result<(), Fault> {
        let start = self.at;
        let end = memchr::memmem::find(&self.bytes[start + 2..], b"*/");
        self.at =
            end.map(|e| start + 2 + e + 2).ok_or_else(|| self.fault(start, "a comment that does not end"))?;
        Ok(())
    }

    /// Goes past the next `;` outside texts and comments; its end.
    fn statement(&mut self) -> Result<usize, Fault> {
        let start = self.at;
        while let Some(next) = memchr3(b';', b'\'', b'/', &self.bytes[self.at..]) {
            self.at += next;
            match self.bytes[self.at] {
                b';' => {
                    self.at += 1;
                    return Ok(self.at);
                }
                b'\'' => self.string()?,
                _ if self.bytes.get(self.at + 1) == Some(&b'*') => self.comment()?,
                _ => self.at += 1,
            }
        }
        self.at = self.bytes.len();
        Err(self.fault(start, "an instance without `;`, expected `;` before the end of the file"))
    }

    /// Goes past a text; `''` is a quote inside it.
    fn string(&mut self) -> Result<(), Fault> {
        let start = self.at;
        self.at = string_end(self.bytes, start)
            .ok_or_else(|| self.fault(start, "a text without its closing quote, expected `'`"))?;
        Ok(())
    }

    /// Reads the header up to DATA; the schema's name.
    fn header(&mut self) -> Result<String, Fault> {
        let mut schema = String::new();
        if self.bytes.starts_with(b"\xEF\xBB\xBF") {
            self.at = 3;
        }
        self.skip_blank()?;
        let head = self.bytes.get(self.at..self.at + 12).unwrap_or_default();
        if !head.eq_ignore_ascii_case(b"ISO-10303-21") {
            return Err(self.fault(self.at, "no `ISO-10303-21;`, expected a STEP physical file"));
        }
        loop {
            self.skip_blank()?;
            let at = self.at;
            if self.peek().is_none() {
                return Err(self.fault(at, "no DATA section"));
            }
            let end = self.statement()?;
            match upper_word(&self.bytes[at..end]).as_str() {
                "DATA" => return Ok(schema),
                "FILE_SCHEMA" => {
                    let text = &self.bytes[at..end];
                    let mut parts = text.split(|b| *b == b'\'');
                    schema = parts
                        .nth(1)
                        .map_or_else(String::new, |s| String::from_utf8_lossy(s).trim().to_ascii_uppercase());
                }
                _ => {}
            }
        }
    }
}

/// One past the closing quote of the text that starts at `start`.
fn string_end(bytes: &[u8], start: usize) -> Option<usize> {
    let mut at = start + 1;
    loop {
        at += memchr2(b'\'', b'\\', bytes.get(at..)?)?;
        match bytes[at] {
            b'\'' if bytes.get(at + 1) == Some(&b'\'') => at += 2,
            b'\'' => return Some(at + 1),
            // The byte after \S\ stands for another letter, a quote too (ISO 8859).
            b'\\' if bytes.get(at + 1) == Some(&b'S') && bytes.get(at + 2) == Some(&b'\\') => at += 4,
            _ => at += 1,
        }
    }
}

fn upper_word(text: &[u8]) -> String {
    let end = text.iter().position(|b| !(b.is_ascii_alphanumeric() || *b == b'_')).unwrap_or(text.len());
    String::from_utf8_lossy(&text[..end]).to_ascii_uppercase()
}

/// Number, keyword and opening parenthesis of an instance.
fn head(bytes: &[u8], span: Range<usize>) -> Result<(u64, Range<usize>, usize), Fault> {
    let fault = |at: usize, text: &str| Fault { at, text: format!("found {text}") };
    let mut at = span.start + 1;
    blank(bytes, &mut at, span.end);
    if bytes[at..span.end].starts_with(b"+") {
        at += 1;
    }
    let has_digits = bytes[at..span.end].first().is_some_and(u8::is_ascii_digit);
    let id = whole_number(&bytes[..span.end], &mut at).filter(|id| *id <= INSTANCE_MAX);
    let why = if has_digits { LARGE_ID } else { "no number after `#`, expected a positive whole number" };
    let id = id.ok_or_else(|| fault(span.start, why))?;
    blank(bytes, &mut at, span.end);
    if bytes.get(at) != Some(&b'=') {
        return Err(fault(at, "no `=` after the number of an instance"));
    }
    at += 1;
    blank(bytes, &mut at, span.end);
    let start = at;
    while bytes[at..span.end].first().is_some_and(|b| b.is_ascii_alphanumeric() || *b == b'_') {
        at += 1;
    }
    let keyword = start..at;
    blank(bytes, &mut at, span.end);
    if bytes.get(at) != Some(&b'(') {
        return Err(fault(at, "no `(` after the keyword of an instance"));
    }
    Ok((id, keyword, at))
}

/// Digits as a number; none where there are no digits, or more than a number has.
fn whole_number(bytes: &[u8], at: &mut usize) -> Option<u64> {
    let start = *at;
    let mut value = 0u64;
    while let Some(digit) = bytes.get(*at).map(|b| b.wrapping_sub(b'0')).filter(|d| *d < 10) {
        value = value.checked_mul(10)?.checked_add(u64::from(digit))?;
        *at += 1;
    }
    (*at > start).then_some(value)
}

/// Splits `#id = KEYWORD ( … ) ;`.
fn instance(bytes: &[u8], span: Range<usize>) -> Result<Instance, Fault> {
    let fault = |at: usize, text: &str| Fault { at, text: format!("found {text}") };
    let (id, keyword, open) = head(bytes, span.clone())?;
    let mut close = open + 1;
    list::<false>(bytes, &mut close, span.end - 1, 0).map_err(|(at, text)| fault(at, text))?;
    let mut end = close + 1;
    blank(bytes, &mut end, span.end);
    if bytes[..span.end].get(close) != Some(&b')') || bytes[..span.end].get(end) != Some(&b';') {
        return Err(fault(open, "an instance that does not end with `);`"));
    }
    Ok(Instance { id, span, keyword, args: open + 1..close })
}

fn blank(bytes: &[u8], at: &mut usize, end: usize) {
    while *at < end {
        let b = bytes[*at];
        if b > b' ' && b != b'/' {
            return;
        }
        if b.is_ascii_whitespace() || b == 0 {
            *at += 1;
        } else if bytes[*at..end].starts_with(b"/*") {
            *at = bytes[*at..end].windows(2).position(|w| w == b"*/").map_or(end, |i| *at + i + 2);
        } else {
            return;
        }
    }
}

type Broken = (usize, &'static str);

/// Arguments up to `end` or the closing parenthesis at this level; checked alone where they are not to `KEEP`.
fn list<const KEEP: bool>(
    bytes: &[u8],
    at: &mut usize,
    end: usize,
    depth: usize,
) -> Result<Vec<Arg>, Broken> {
    if depth > NESTING_MAX {
        return Err((*at, "parentheses nested deeper than any schema has them"));
    }
    let mut out = Vec::new();
    blank(bytes, at, end);
    if *at >= end || bytes[*at] == b')' {
        return Ok(out);
    }
    loop {
        let arg = value::<KEEP>(bytes, at, end, depth)?;
        if KEEP {
            out.push(arg);
        }
        blank(bytes, at, end);
        match bytes[*at..end].first() {
            None | Some(b')') => return Ok(out),
            Some(b',') => *at += 1,
            Some(_) if depth == 0 && bytes[*at..end].first().is_some_and(u8::is_ascii_alphabetic) => {}
            Some(_) => return Err((*at, "two values without a comma between them")),
        }
    }
}

fn value<const KEEP: bool>(bytes: &[u8], at: &mut usize, end: usize, depth: usize) -> Result<Arg, Broken> {
    blank(bytes, at, end);
    let start = *at;
    let value = match bytes[start..end].first() {
        None => return Err((start, "no value where one must stand")),
        Some(b'$' | b'*') => {
            *at += 1;
            Value::Null
        }
        Some(b'#') => {
            *at += 1;
            let has_digits = bytes[*at..end].first().is_some_and(u8::is_ascii_digit);
            let id = whole_number(&bytes[..end], at);
            Value::Ref(id.ok_or((start, if has_digits { LARGE_ID } else { "a `#` without a number" }))?)
        }
        Some(b'\'') => {
            *at =
                string_end(bytes, start).filter(|e| *e <= end).ok_or((start, "a text that does not end"))?;
            Value::Text
        }
        Some(b'"') => {
            let close = bytes[start + 1..end].iter().position(|b| *b == b'"');
            *at = close.map(|c| start + c + 2).ok_or((start, "a binary that does not end"))?;
            Value::Null
        }
        Some(b'.') if !bytes.get(start + 1).is_some_and(u8::is_ascii_digit) => {
            let close = bytes[start + 1..end].iter().position(|b| *b == b'.');
            let close = close.ok_or((start, "a name in dots that does not end"))?;
            *at = start + close + 2;
            Value::Enum(kept::<KEEP>(&bytes[start + 1..start + 1 + close]))
        }
        Some(b'(') => {
            *at += 1;
            Value::List(inner::<KEEP>(bytes, at, end, depth)?)
        }
        Some(b) if b.is_ascii_alphabetic() => {
            while bytes[*at..end].first().is_some_and(|b| b.is_ascii_alphanumeric() || *b == b'_') {
                *at += 1;
            }
            let word = kept::<KEEP>(&bytes[start..*at]).to_ascii_uppercase();
            blank(bytes, at, end);
            if bytes[*at..end].first() != Some(&b'(') {
                return Err((start, "a word where a value must stand"));
            }
            *at += 1;
            Value::Typed(word, inner::<KEEP>(bytes, at, end, depth)?)
        }
        Some(_) => {
            while bytes[*at..end].first().is_some_and(|b| b.is_ascii_alphanumeric() || b"+-.".contains(b)) {
                *at += 1;
            }
            let text = &bytes[start..*at];
            let number = if !KEEP && is_plain_number(text) { Some(0.0) } else { number(text) };
            Value::Number(number.ok_or((start, "a value that is no number"))?)
        }
    };
    Ok(Arg { span: start..*at, value })
}

fn kept<const KEEP: bool>(text: &[u8]) -> String {
    if KEEP { String::from_utf8_lossy(text).into_owned() } else { String::new() }
}

fn number(text: &[u8]) -> Option<f64> {
    std::str::from_utf8(text).ok()?.parse::<f64>().ok().filter(|v| v.is_finite())
}

/// A number of nothing but digits, sign, point and exponent.
fn real(word: &[u8]) -> Option<f64> {
    let is_number = |b: &u8| b.is_ascii_digit() || b"+-.eE".contains(b);
    plain_real(word).or_else(|| number(word).filter(|_| word.iter().all(is_number)))
}

/// The number of few digits with a point among them: a whole number and a power of ten, both exact, so their quotient
/// is the nearest (W. D. Clinger, How to read floating point numbers accurately, PLDI 1990).
fn plain_real(word: &[u8]) -> Option<f64> {
    const DIGITS_MAX: usize = 15;
    const TENS: [f64; DIGITS_MAX + 1] =
        [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15];
    let (digits, sign) = word.strip_prefix(b"-").map_or((word, 1.0), |d| (d, -1.0));
    let (mut whole, mut decimals) = (0u64, None);
    for (i, b) in digits.iter().enumerate() {
        match b {
            b'0'..=b'9' => whole = whole * 10 + u64::from(b - b'0'),
            b'.' if decimals.is_none() && i > 0 => decimals = Some(digits.len() - 1 - i),
            _ => return None,
        }
        if i > DIGITS_MAX {
            return None;
        }
    }
    let decimals = decimals.filter(|_| digits.len() <= DIGITS_MAX + 1)?;
    Some(sign * (whole as f64 / TENS[decimals]))
}

/// Whether digits, a sign and one point are all there is: a number without having to be read.
fn is_plain_number(text: &[u8]) -> bool {
    let digits = text.strip_prefix(b"-").unwrap_or(text);
    let points = digits.iter().filter(|b| **b == b'.').count();
    digits.first().is_some_and(u8::is_ascii_digit)
        && digits.len() < 64
        && points < 2
        && digits.iter().all(|b| b.is_ascii_digit() || *b == b'.')
}

fn inner<const KEEP: bool>(
    bytes: &[u8],
    at: &mut usize,
    end: usize,
    depth: usize,
) -> Result<Vec<Arg>, Broken> {
    let open = *at;
    let items = list::<KEEP>(bytes, at, end, depth + 1)?;
    if bytes[*at..end].first() != Some(&b')') {
        return Err((open, "a `(` without its `)`"));
    }
    *at += 1;
    Ok(items)
}

#[cfg(test)]
#[path = "step_tests.rs"]
mod tests;

//! Is the file all there, and is it a DXF at all?

use super::tokens::{BINARY_SENTINEL, Form, form_of};
use crate::foreign::kind_of;

/// Whether the end mark of the format stands at the end of the bytes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Completeness {
    /// The end mark is there (or the bytes are another format, which reading then refuses by name).
    Whole,
    /// It is not; the reason in plain words.
    Incomplete(String),
    /// There is nothing but blanks.
    Empty,
}

/// How far before the end the end mark is looked for: some programs leave NULs or junk behind it.
pub const TAIL_BYTES: usize = 1 << 20;

/// Looks for `0/EOF` in the tail of the file. Cheap: at most `TAIL_BYTES` are looked at, except for
/// padding of NULs and blanks, which is skipped however long.
pub fn is_complete(bytes: &[u8]) -> Completeness {
    if foreign(bytes).is_some() {
        return Completeness::Whole;
    }
    let padding = |b: &u8| *b == 0 || *b == 0x1a || b.is_ascii_whitespace();
    let Some(last) = bytes.iter().rposition(|b| !padding(b)) else {
        return Completeness::Empty;
    };
    let is_binary = matches!(form_of(bytes), Form::Binary { .. });
    let start = last.saturating_sub(TAIL_BYTES);
    let tail = &bytes[start..(last + 2).min(bytes.len())];
    let mut end = tail.len();
    while let Some(at) = tail[..end].windows(3).rposition(|w| w == b"EOF") {
        if if is_binary { is_binary_mark(tail, at) } else { is_mark(tail, at) } {
            return Completeness::Whole;
        }
        end = at + 2;
    }
    let line =
        bytes[..=last].iter().rev().take(200).position(|&b| b == b'\n' || b == b'\r').unwrap_or(last + 1);
    let found = if is_binary || BINARY_SENTINEL.starts_with(bytes) {
        "the end of a binary DXF without the end mark".to_owned()
    } else {
        format!("it ends with `{}`", super::tokens::shown(&bytes[last + 1 - line.min(last + 1)..=last]))
    };
    Completeness::Incomplete(found)
}

/// Whether the `EOF` at `at` is a line of its own after a line `0`.
fn is_mark(tail: &[u8], at: usize) -> bool {
    let is_end = |b: &u8| matches!(b, b'\n' | b'\r');
    let after = tail[at + 3..].iter().find(|b| **b != b' ' && **b != b'\t');
    let before = tail[..at].trim_ascii_end();
    let own_line = tail[before.len()..at].iter().any(is_end);
    let code_line = before.iter().rposition(is_end).map_or(before, |n| &before[n + 1..]);
    after.is_none_or(|b| is_end(b) || *b == 0 || *b == 0x1a)
        && own_line
        && matches!(code_line.trim_ascii(), b"0" | b"\xef\xbb\xbf0")
}

/// Whether the `EOF` at `at` is a NUL-terminated string after group code 0.
fn is_binary_mark(tail: &[u8], at: usize) -> bool {
    tail.get(at + 3).is_none_or(|&b| b == 0) && at > 0 && tail[at - 1] == 0
}

/// What the bytes are, if they are surely no DXF: problem code and text.
pub(super) fn foreign(bytes: &[u8]) -> Option<(&'static str, String)> {
    let other = |what: &str, hint: &str| {
        Some(("dxf-other-format", format!("the file, found {what}, expected a DXF; not read. {hint}")))
    };
    match bytes {
        [b'P', b'K', 3 | 5, 4 | 6, ..] => other(
            "a ZIP archive",
            "Unpack it and take the DXF inside; an FCStd or IFCZIP is opened by its own program",
        ),
        _ if bytes.starts_with(b"ISO-10303-21") => {
            other("an IFC or STEP file", "Give it its own extension, .ifc")
        }
        _ if bytes.starts_with(b"glTF") => other("a glTF binary", "Give it its own extension, .glb"),
        [0xff, 0xfe, ..] | [0xfe, 0xff, ..] => Some(utf16()),
        [_, 0, _, 0, _, 0, ..] | [0, _, 0, _, 0, _, ..] if bytes.iter().take(64).any(|&b| b != 0) => {
            Some(utf16())
        }
        _ if matches!(form_of(bytes), Form::Binary { .. }) => None,
        _ => kind_of(bytes).and_then(|(what, hint)| other(&what, hint)),
    }
}

fn utf16() -> (&'static str, String) {
    let text = "the encoding, found UTF-16, expected ASCII, a code page or UTF-8; not read. An editor saved it so: \
                save it as UTF-8, or export the drawing again";
    ("dxf-utf16", text.to_owned())
}

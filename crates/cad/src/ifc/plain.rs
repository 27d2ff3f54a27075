//! Instances as nearly all files write them, taken apart in one go: `#12=IFCWALL('…',#5,$,(1.,2.));`.
//!
//! What is written otherwise (comments, small letters, complex instances) or wrong is nobody's business here: it is
//! left to the slower way, which also says what is wrong with it.

use std::ops::Range;

use memchr::memchr2;

use super::instance::Instance;
use super::limits::{INSTANCE_BYTES_MAX, NESTING_MAX};

/// Digits of a number that surely fits.
const DIGITS_MAX: usize = 17;

/// The instance that starts at `at` with its `#`, and where it ends with `;`.
pub(super) fn instance(bytes: &[u8], at: usize) -> Option<Instance> {
    let (id, next) = digits(bytes, at + 1)?;
    let next = blank(bytes, next);
    let start = blank(bytes, (bytes.get(next) == Some(&b'=')).then_some(next + 1)?);
    let end = word(bytes, start)?;
    let open = blank(bytes, end);
    let close = (bytes.get(open) == Some(&b'(')).then(|| close(bytes, open + 1))??;
    let end_of = blank(bytes, close + 1);
    let is_ended = bytes.get(end_of) == Some(&b';') && end_of - at < INSTANCE_BYTES_MAX;
    let span: Range<usize> = at..end_of + 1;
    is_ended.then_some(Instance { id, span, keyword: start..end, args: open + 1..close })
}

/// Where the list closes whose first argument starts at `at`.
fn close(bytes: &[u8], mut at: usize) -> Option<usize> {
    let mut depth = 0;
    // Whether a value must come, and whether the list may end before one.
    let (mut wants, mut may_end) = (true, true);
    loop {
        let b = *bytes.get(at)?;
        match b {
            b',' if !wants => (wants, may_end) = (true, false),
            b')' if !wants || may_end => {
                if depth == 0 {
                    return Some(at);
                }
                depth -= 1;
                (wants, may_end) = (false, false);
            }
            b' ' | b'\n' | b'\r' | b'\t' => {}
            _ if !wants => return None,
            b'(' => {
                depth += 1;
                may_end = true;
                if depth >= NESTING_MAX {
                    return None;
                }
            }
            b'A'..=b'Z' => {
                at = word(bytes, at)?;
                // Its list follows at once.
                if bytes.get(at) != Some(&b'(') {
                    return None;
                }
                continue;
            }
            _ => {
                at = value(bytes, at, b)?;
                (wants, may_end) = (false, false);
                continue;
            }
        }
        at += 1;
    }
}

/// One past a value that is neither a list nor typed.
fn value(bytes: &[u8], at: usize, first: u8) -> Option<usize> {
    match first {
        b'#' => Some(digits(bytes, at + 1)?.1),
        b'$' | b'*' => Some(at + 1),
        b'\'' => text(bytes, at + 1),
        b'.' => {
            let end = word(bytes, at + 1)?;
            (bytes.get(end) == Some(&b'.')).then_some(end + 1)
        }
        b'-' => number(bytes, at + 1),
        _ => number(bytes, at),
    }
}

/// One past the closing quote of a text without escapes of the byte kind; `at` is one past its first quote.
fn text(bytes: &[u8], mut at: usize) -> Option<usize> {
    loop {
        at += memchr2(b'\'', b'\\', bytes.get(at..)?)?;
        match (bytes[at], bytes.get(at + 1)?) {
            (b'\'', b'\'') => at += 2,
            (b'\'', _) => return Some(at + 1),
            (_, b'S') => return None,
            _ => at += 1,
        }
    }
}

/// One past digits with a point and an exponent of at most two digits.
fn number(bytes: &[u8], at: usize) -> Option<usize> {
    let mut end = run(bytes, at);
    if end == at || end - at > DIGITS_MAX {
        return None;
    }
    if bytes.get(end) == Some(&b'.') {
        end = run(bytes, end + 1);
    }
    if bytes.get(end) == Some(&b'E') {
        let sign = usize::from(matches!(bytes.get(end + 1), Some(b'-' | b'+')));
        let from = end + 1 + sign;
        end = run(bytes, from);
        if !(1..=2).contains(&(end - from)) {
            return None;
        }
    }
    Some(end)
}

fn digits(bytes: &[u8], at: usize) -> Option<(u64, usize)> {
    let end = run(bytes, at);
    let is_plain = (1..=DIGITS_MAX).contains(&(end - at));
    is_plain.then(|| (bytes[at..end].iter().fold(0, |n, b| n * 10 + u64::from(b - b'0')), end))
}

/// One past the digits from here on.
fn run(bytes: &[u8], mut at: usize) -> usize {
    while bytes.get(at).is_some_and(u8::is_ascii_digit) {
        at += 1;
    }
    at
}

/// One past a word of large letters.
fn word(bytes: &[u8], at: usize) -> Option<usize> {
    let mut end = at;
    while bytes.get(end).is_some_and(|b| matches!(b, b'A'..=b'Z' | b'0'..=b'9' | b'_')) {
        end += 1;
    }
    (end > at && bytes[at].is_ascii_uppercase()).then_some(end)
}

/// Past spaces and line ends.
fn blank(bytes: &[u8], mut at: usize) -> usize {
    while matches!(bytes.get(at), Some(b' ' | b'\n' | b'\r' | b'\t')) {
        at += 1;
    }
    at
}

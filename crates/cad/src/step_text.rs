//! Texts of a STEP file: the escapes `\X2\…\X0\`, `\X4\…\X0\`, `\X\hh`, `\S\c`, `''` and `\\`.

/// A text with the escapes of a STEP file, as somebody copies it out of one.
pub fn decoded(text: &str) -> String {
    decode(text.as_bytes())
}

/// Decodes the bytes between the quotes; bytes that are no ASCII are taken as UTF-8, else as Latin-1 or Shift-JIS.
pub(super) fn decode(raw: &[u8]) -> String {
    let mut out = String::new();
    // What stands byte for byte, some of it escaped: only together it tells which code page it is.
    let mut run = Run::default();
    let mut at = 0;
    while at < raw.len() {
        let rest = &raw[at..];
        match rest {
            [b'\'', b'\'', ..] | [b'\\', b'\\', ..] => {
                run.bytes.push(rest[0]);
                at += 2;
            }
            [b'\\', b'S', b'\\', c, ..] => {
                run.is_escaped = true;
                run.bytes.push(c.wrapping_add(128));
                at += 4;
            }
            [b'\\', b'X', b'\\', a, b, ..] => {
                if let Some(code) = hex(&[*a, *b]) {
                    run.is_escaped = true;
                    run.bytes.push(code as u8);
                }
                at += 5;
            }
            [b'\\', b'X', n @ (b'2' | b'4'), b'\\', ..] => {
                run.end(&mut out);
                let end = rest.windows(4).position(|w| w == b"\\X0\\").unwrap_or(rest.len());
                wide(&rest[4..end.max(4)], if *n == b'2' { 4 } else { 8 }, &mut out);
                at += (end + 4).min(rest.len());
            }
            [b'\\', b'P', _, b'\\', ..] => {
                run.end(&mut out);
                at += 4;
            }
            _ => {
                let len = rest[1..].iter().position(|b| b"\\'".contains(b)).map_or(rest.len(), |i| i + 1);
                run.bytes.extend_from_slice(&rest[..len]);
                at += len;
            }
        }
    }
    run.end(&mut out);
    out
}

/// Bytes that follow each other.
#[derive(Default)]
struct Run {
    bytes: Vec<u8>,
    /// Whether one of them stands as `\X\hh` or `\S\c`, which is Latin-1 by the standard and never UTF-8.
    is_escaped: bool,
}

impl Run {
    fn end(&mut self, out: &mut String) {
        match std::str::from_utf8(&self.bytes) {
            Ok(text) if !self.is_escaped || self.bytes.is_ascii() => out.push_str(text),
            _ => out.push_str(&illegal(&self.bytes)),
        }
        *self = Self::default();
    }
}

/// Bytes that the standard forbids and programs write: Shift-JIS where Latin-1 would be control codes.
fn illegal(raw: &[u8]) -> String {
    let latin = || raw.iter().map(|b| char::from(*b)).collect();
    if !raw.iter().any(|b| (0x80..0xA0).contains(b)) {
        return latin();
    }
    let (text, _, is_damaged) = encoding_rs::SHIFT_JIS.decode(raw);
    if is_damaged { latin() } else { text.into_owned() }
}

fn wide(digits: &[u8], width: usize, out: &mut String) {
    let units: Vec<u32> = digits.chunks(width).filter_map(hex).collect();
    if width == 8 {
        out.extend(units.into_iter().filter_map(char::from_u32));
    } else {
        let units = units.into_iter().map(|u| u as u16);
        out.extend(char::decode_utf16(units).map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER)));
    }
}

fn hex(digits: &[u8]) -> Option<u32> {
    u32::from_str_radix(std::str::from_utf8(digits).ok()?, 16).ok()
}

/// A text as STEP writes it, quotes included.
pub(super) fn encode(text: &str) -> String {
    let mut out = String::from("'");
    for c in text.chars() {
        match c {
            '\'' => out.push_str("''"),
            '\\' => out.push_str("\\\\"),
            ' '..='~' => out.push(c),
            c if (c as u32) < 0x20 => out.push_str(&format!("\\X\\{:02X}", c as u32)),
            c if (c as u32) < 0x10000 => out.push_str(&format!("\\X2\\{:04X}\\X0\\", c as u32)),
            c => out.push_str(&format!("\\X4\\{:08X}\\X0\\", c as u32)),
        }
    }
    out.push('\'');
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn escapes_both_ways() {
        for (raw, text) in [
            (&b"W\\X2\\00E4\\X0\\nde"[..], "Wände"),
            (b"it''s", "it's"),
            (b"\\S\\d", "ä"),
            (b"\\X\\E4", "ä"),
            (b"\\X4\\0001F3DB\\X0\\", "\u{1f3db}"),
            (b"a\\\\b", "a\\b"),
            (b"1\x8aK", "1階"),
            (b"1\\X\\8aK", "1階"),
            (b"\\X\\89\\S\\.\\X\\8D\\S\\* - Story", "屋根 - Story"),
            (b"\\X\\89\\X\\AE\\X\\8D\\X\\AA - Story", "屋根 - Story"),
            (b"\\X\\C3\\X\\A4", "Ã¤"),
            ("plain ä".as_bytes(), "plain ä"),
            (b"\\X2\\00E4", "ä"),
        ] {
            assert_eq!(decode(raw), text);
            let written = encode(text);
            assert_eq!(decode(&written.as_bytes()[1..written.len() - 1]), text);
        }
    }
}

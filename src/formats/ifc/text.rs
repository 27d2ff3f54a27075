//! Texts of a STEP file: the escapes `\X2\…\X0\`, `\X4\…\X0\`, `\X\hh`, `\S\c`, `''` and `\\`.

/// Decodes the bytes between the quotes; bytes that are no ASCII are taken as UTF-8, else as Latin-1.
pub(super) fn decode(raw: &[u8]) -> String {
    let mut out = String::new();
    let mut at = 0;
    while at < raw.len() {
        let rest = &raw[at..];
        match rest {
            [b'\'', b'\'', ..] => {
                out.push('\'');
                at += 2;
            }
            [b'\\', b'\\', ..] => {
                out.push('\\');
                at += 2;
            }
            [b'\\', b'S', b'\\', c, ..] => {
                out.push(char::from(c.wrapping_add(128)));
                at += 4;
            }
            [b'\\', b'X', b'\\', a, b, ..] => {
                out.extend(hex(&[*a, *b]).and_then(char::from_u32));
                at += 5;
            }
            [b'\\', b'X', n @ (b'2' | b'4'), b'\\', ..] => {
                let end = rest.windows(4).position(|w| w == b"\\X0\\").unwrap_or(rest.len());
                wide(&rest[4..end.max(4)], if *n == b'2' { 4 } else { 8 }, &mut out);
                at += (end + 4).min(rest.len());
            }
            [b'\\', b'P', _, b'\\', ..] => at += 4,
            _ => {
                let len = rest[1..].iter().position(|b| b"\\'".contains(b)).map_or(rest.len(), |i| i + 1);
                match std::str::from_utf8(&rest[..len]) {
                    Ok(text) => out.push_str(text),
                    Err(_) => out.push_str(&illegal(&rest[..len])),
                }
                at += len;
            }
        }
    }
    out
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
            ("plain ä".as_bytes(), "plain ä"),
            (b"\\X2\\00E4", "ä"),
        ] {
            assert_eq!(decode(raw), text);
            let written = encode(text);
            assert_eq!(decode(&written.as_bytes()[1..written.len() - 1]), text);
        }
    }
}

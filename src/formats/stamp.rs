//! What a content is known by: a program that only writes a file again changes its time stamp, and nothing that is drawn.

use std::borrow::Cow;
use std::ops::Range;
use std::path::Path;

use sha2::{Digest, Sha256};

use super::{format_of, ifc};
use crate::plan::drawing::Format;

/// The stamps stand in the first bytes of a file.
const HEAD_BYTES: usize = 1 << 20;
/// Variables of a DXF's header that change whenever it is saved.
const VARIABLES: [&[u8]; 7] =
    [b"$TDCREATE", b"$TDUCREATE", b"$TDUPDATE", b"$TDUUPDATE", b"$TDINDWG", b"$TDUSRTIMER", b"$VERSIONGUID"];

/// SHA-256 of a drawing without the time at which it was written, lower-case hexadecimal; where it has no stamp, that
/// of its bytes. A packed building is known by what is packed.
pub fn timeless(path: &Path, bytes: &[u8]) -> String {
    let file = path.to_string_lossy();
    let packed = ifc::is_zip(bytes).then(|| ifc::unzip(&file, bytes).ok()).flatten();
    let bytes = packed.map_or(Cow::Borrowed(bytes), Cow::Owned);
    let head = &bytes[..bytes.len().min(HEAD_BYTES)];
    let stamps = match format_of(&file, &bytes) {
        Format::Dxf => variables(head),
        Format::Ifc => file_name(head).into_iter().collect(),
        Format::Gltf | Format::Glb => asset(head).into_iter().collect(),
    };
    let (mut digest, mut at) = (Sha256::new(), 0);
    for stamp in stamps {
        digest.update(&bytes[at..stamp.start]);
        at = stamp.end;
    }
    digest.update(&bytes[at..]);
    digest.finalize().iter().map(|b| format!("{b:02x}")).collect()
}

/// The values of the variables: the second line after each name.
fn variables(head: &[u8]) -> Vec<Range<usize>> {
    let (mut out, mut at, mut since_name) = (Vec::new(), 0, None);
    for line in head.split_inclusive(|b| *b == b'\n') {
        let text = line.trim_ascii();
        since_name = match since_name {
            Some(0) => Some(1),
            Some(_) => {
                out.push(at..at + line.len());
                None
            }
            None => VARIABLES.contains(&text).then_some(0),
        };
        at += line.len();
        if text == b"ENDSEC" {
            break;
        }
    }
    out
}

/// The second text of `FILE_NAME('plan.ifc','2026-01-01T00:00:00',…`.
fn file_name(head: &[u8]) -> Option<Range<usize>> {
    let entry = memchr::memmem::find(head, b"FILE_NAME")?;
    let text = |from: usize| {
        let open = from + memchr::memchr(b'\'', &head[from..])?;
        let mut close = open + 1;
        loop {
            close += memchr::memchr(b'\'', &head[close..])?;
            // A quote that is written twice is one in the text.
            if head.get(close + 1) != Some(&b'\'') {
                return Some(open..close + 1);
            }
            close += 2;
        }
    };
    text(text(entry)?.end)
}

/// The object `"asset"` of a scene: what wrote it, and when.
fn asset(head: &[u8]) -> Option<Range<usize>> {
    let key = memchr::memmem::find(head, b"\"asset\"")?;
    let open = key + memchr::memchr(b'{', &head[key..])?;
    let (mut depth, mut is_text, mut i) = (0usize, false, open);
    while i < head.len() {
        match head[i] {
            b'\\' if is_text => i += 1,
            b'"' => is_text = !is_text,
            b'{' if !is_text => depth += 1,
            b'}' if !is_text => {
                depth -= 1;
                if depth == 0 {
                    return Some(open..i + 1);
                }
            }
            _ => {}
        }
        i += 1;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key(name: &str, text: &str) -> String {
        timeless(Path::new(name), text.as_bytes())
    }

    /// A stamp makes no other content; anything else does.
    #[test]
    fn what_is_only_written_again_is_the_same() {
        let dxf = |time: &str, x: &str| {
            format!(
                "  0\r\nSECTION\r\n  2\r\nHEADER\r\n  9\r\n$TDUPDATE\r\n 40\r\n{time}\r\n  9\r\n$TDINDWG\r\n 40\r\n{time}\r\n\
                 9\r\n$VERSIONGUID\r\n  2\r\n{{{time}}}\r\n  0\r\nENDSEC\r\n  0\r\nLINE\r\n 10\r\n{x}\r\n  0\r\nEOF\r\n"
            )
        };
        let ifc = |time: &str, x: &str| {
            format!(
                "ISO-10303-21;\nHEADER;\nFILE_NAME('o''plan.ifc', '{time}',('a'),('b'),'c','d','');\nENDSEC;\nDATA;\n\
                 #1=IFCX({x});\nENDSEC;\nEND-ISO-10303-21;\n"
            )
        };
        let gltf = |time: &str, x: &str| {
            format!(
                "{{\"asset\":{{\"version\":\"2.0\",\"generator\":\"a \\\"}}b\\\" {time}\",\"extras\":{{\"at\":1}}}},\"nodes\":[{x}]}}"
            )
        };
        for (name, file) in
            [("plan.dxf", &dxf as &dyn Fn(&str, &str) -> String), ("plan.ifc", &ifc), ("plan.gltf", &gltf)]
        {
            let first = key(name, &file("2460000.5", "1"));
            assert_eq!(key(name, &file("2460001.25", "1")), first, "{name}");
            assert_ne!(key(name, &file("2460000.5", "2")), first, "{name}");
        }
    }

    /// Without a stamp the content is known by its bytes, cut or odd as they may be.
    #[test]
    fn without_a_stamp_all_bytes_count() {
        for text in
            ["", "0\nEOF\n", "ISO-10303-21;FILE_NAME('", "{\"asset\":{\"a\":\"\\", "9\n$TDUPDATE\n40\n"]
        {
            for name in ["a.dxf", "a.ifc", "a.gltf"] {
                assert_eq!(key(name, text), crate::watch::sha256_hex(text.as_bytes()), "{name} {text}");
            }
        }
    }
}

//! What a content is known by: a program that only writes a file again changes its time stamp, and nothing that is drawn.

use std::borrow::Cow;
use std::ops::Range;
use std::path::Path;

use sha2::{Digest, Sha256};

use super::dxf::BINARY_SENTINEL;
use super::{format_of, ifc};
use crate::drawing::Format;

/// The stamps stand in the first bytes of a file.
const HEAD_BYTES: usize = 1 << 20;
/// Variables of a DXF's header that change whenever it is saved: times, its number, the next free handle.
const VARIABLES: [&[u8]; 8] = [
    b"$TDCREATE",
    b"$TDUCREATE",
    b"$TDUPDATE",
    b"$TDUUPDATE",
    b"$TDINDWG",
    b"$TDUSRTIMER",
    b"$VERSIONGUID",
    b"$HANDSEED",
];
/// The lines before the time at which ezdxf last wrote a file, from its OBJECTS or, in R12, from data of a block.
const BEFORE_WRITTEN: [&[&[u8]]; 2] =
    [&[b"DictionaryVariables", b"280", b"0", b"1"], &[b"1000", b"WRITTEN_BY_EZDXF", b"1000"]];

/// SHA-256 of a drawing without the time at which it was written, lower-case hexadecimal; where it has no stamp, that
/// of its bytes. A packed building is known by what is packed.
pub fn timeless(path: &Path, bytes: &[u8]) -> String {
    let file = path.to_string_lossy();
    let packed = ifc::is_zip(bytes).then(|| ifc::unzip(&file, bytes).ok()).flatten();
    let bytes = packed.map_or(Cow::Borrowed(bytes), Cow::Owned);
    let head = &bytes[..bytes.len().min(HEAD_BYTES)];
    let parts = match format_of(&file, &bytes) {
        Format::Dxf if head.starts_with(BINARY_SENTINEL) => without(&bytes, &binary_variables(head)),
        Format::Dxf => without(&bytes, &[variables(head), written(&bytes)].concat()),
        Format::Ifc => {
            let mut stamps: Vec<Range<usize>> = file_name(head).into_iter().collect();
            stamps.extend(owner_histories(&bytes));
            without(&bytes, &stamps)
        }
        Format::Gltf => scene(&bytes),
        Format::Glb => chunks(&bytes).unwrap_or_else(|| vec![&bytes]),
    };
    let mut digest = Sha256::new();
    parts.into_iter().for_each(|part| digest.update(part));
    digest.finalize().iter().map(|b| format!("{b:02x}")).collect()
}

/// What is left of the bytes without the stamps, which stand in order.
fn without<'a>(bytes: &'a [u8], stamps: &[Range<usize>]) -> Vec<&'a [u8]> {
    let starts = std::iter::once(0).chain(stamps.iter().map(|s| s.end));
    let ends = stamps.iter().map(|s| s.start).chain([bytes.len()]);
    starts.zip(ends).filter_map(|(start, end)| bytes.get(start..end)).collect()
}

/// The values of the variables: the second line after each name, which itself follows a group code 9.
fn variables(head: &[u8]) -> Vec<Range<usize>> {
    let (mut out, mut at, mut since_name) = (Vec::new(), 0, None);
    let mut before: &[u8] = b"";
    for line in head.split_inclusive(|b| *b == b'\n') {
        let text = line.trim_ascii();
        since_name = match since_name {
            Some(0) => Some(1),
            Some(_) => {
                out.push(at..at + line.len());
                None
            }
            None => (before == b"9" && VARIABLES.contains(&text)).then_some(0),
        };
        at += line.len();
        before = text;
        if text == b"ENDSEC" {
            break;
        }
    }
    out
}

/// Lines such as `1.4.5 @ 2026-11-27T17:15:10.227587+00:00`, where ezdxf has them.
fn written(bytes: &[u8]) -> Vec<Range<usize>> {
    let line_of = |at: usize| {
        let start = memchr::memrchr(b'\n', &bytes[..at]).map_or(0, |n| n + 1);
        let end = memchr::memchr(b'\n', &bytes[at..]).map_or(bytes.len(), |n| at + n);
        start..end
    };
    let is_behind = |from: usize, before: &&[&[u8]]| {
        let mut start = from;
        before.iter().rev().all(|text| {
            let Some(line) = start.checked_sub(1).map(line_of) else { return false };
            start = line.start;
            bytes[line].trim_ascii() == *text
        })
    };
    let found = memchr::memmem::find_iter(bytes, b" @ ").map(line_of);
    let is_time = |line: &Range<usize>| {
        let text = bytes[line.clone()].trim_ascii();
        text.iter().all(|b| b.is_ascii_digit() || b".@-+:T ab".contains(b))
    };
    found.filter(|line| is_time(line) && BEFORE_WRITTEN.iter().any(|b| is_behind(line.start, b))).collect()
}

/// The values of the variables of a binary file: eight bytes of a number, or a text to its zero.
fn binary_variables(head: &[u8]) -> Vec<Range<usize>> {
    let end = memchr::memmem::find(head, b"ENDSEC\0").unwrap_or(head.len());
    let head = &head[..end];
    // The first group code is 0: a second zero is its second byte.
    let is_wide = head.get(BINARY_SENTINEL.len() + 1) == Some(&0);
    let code_bytes = if is_wide { 2 } else { 1 };
    let mut out: Vec<Range<usize>> = Vec::new();
    for name in VARIABLES {
        let key = [if is_wide { &[9, 0][..] } else { &[9] }, name, &[0]].concat();
        let Some(found) = memchr::memmem::find(head, &key) else { continue };
        let value = found + key.len() + code_bytes;
        let length = match head.get(found + key.len()) {
            Some(40) => Some(size_of::<f64>()),
            _ => head.get(value..).and_then(|rest| memchr::memchr(0, rest)),
        };
        out.extend(length.map(|l| value..value + l).filter(|r| r.end <= head.len()));
    }
    out.sort_by_key(|r| r.start);
    out
}

/// Times of change and of creation in `IFCOWNERHISTORY(#5,#6,$,.ADDED.,1767225600,$,$,1767225600)`: the fifth and the
/// eighth value.
fn owner_histories(bytes: &[u8]) -> Vec<Range<usize>> {
    const NAME: &[u8] = b"IFCOWNERHISTORY";
    let mut out = Vec::new();
    for found in memchr::memmem::find_iter(bytes, NAME) {
        let open = found + NAME.len();
        let Some(close) = memchr::memchr(b')', &bytes[open..]).map(|n| open + n) else { break };
        let Some(list) = bytes[open..close].trim_ascii_start().strip_prefix(b"(") else { continue };
        let mut at = close - list.len();
        let values: Vec<Range<usize>> = list
            .split(|b| *b == b',')
            .map(|value| {
                let from = at;
                at += value.len() + 1;
                from..from + value.len()
            })
            .collect();
        // A quote begins a text: what stands there is no list of this kind.
        if values.len() == 8 && !list.contains(&b'\'') {
            out.extend([values[4].clone(), values[7].clone()]);
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

/// A scene without what wrote it, and when: of its `asset` the versions alone count.
fn scene(json: &[u8]) -> Vec<&[u8]> {
    let Some(asset) = member(json, b"asset") else { return vec![json] };
    let inner = &json[asset.clone()];
    let versions = [b"version".as_slice(), b"minVersion"].into_iter().filter_map(|key| member(inner, key));
    let mut out = vec![&json[..asset.start]];
    out.extend(versions.map(|r| &inner[r]));
    out.push(&json[asset.end..]);
    out
}

/// Scene and data of a GLB without the lengths that follow from what wrote it; `None` where its chunks do not fit.
fn chunks(bytes: &[u8]) -> Option<Vec<&[u8]>> {
    const HEADER: usize = 12;
    let u32_at = |at: usize| Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?) as usize);
    let mut out = vec![bytes.get(..HEADER - 4)?];
    let mut at = HEADER;
    while at < bytes.len() {
        let (start, kind) = (at + 8, bytes.get(at + 4..at + 8)?);
        at = start.checked_add(u32_at(at)?)?;
        let data = bytes.get(start..at)?;
        out.push(kind);
        // The spaces that fill it up follow its length.
        if kind == b"JSON" { out.extend(scene(data.trim_ascii_end())) } else { out.push(data) }
    }
    Some(out)
}

/// The value of a key of the outermost object; what lies deeper has keys of its own.
fn member(json: &[u8], key: &[u8]) -> Option<Range<usize>> {
    let (mut depth, mut i, mut value) = (0usize, 0, None);
    while i < json.len() {
        match json[i] {
            b'"' => {
                let open = i + 1;
                i = open;
                while *json.get(i)? != b'"' {
                    i += if json[i] == b'\\' { 2 } else { 1 };
                }
                let after = json[i + 1..].trim_ascii_start();
                if depth == 1 && value.is_none() && json[open..i] == *key && after.starts_with(b":") {
                    value = Some(json.len() - after.len() + 1);
                }
            }
            b'{' | b'[' => depth += 1,
            b',' | b'}' if depth == 1 && value.is_some() => return value.map(|from| from..i),
            b'}' | b']' => depth = depth.checked_sub(1)?,
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

    /// ezdxf says among the objects, or beside a block of R12, when it wrote.
    #[test]
    fn times_of_ezdxf_are_stamps() {
        let new = |time: &str, x: &str| {
            key(
                "a.dxf",
                &format!(
                    "  0\nDICTIONARYVAR\n100\nDictionaryVariables\n280\n0\n  1\n{time}\n  0\nLINE\n 10\n{x}\n"
                ),
            )
        };
        let old = |time: &str| {
            key("a.dxf", &format!("1001\nEZDXF\n1000\nWRITTEN_BY_EZDXF\n1000\n{time}\n  0\nEOF\n"))
        };
        let text = |time: &str| key("a.dxf", &format!("  0\nTEXT\n  1\n{time}\n  0\nEOF\n"));
        let times = ["1.4.5 @ 2026-11-27T17:15:10.227587+00:00", "1.5b1 @ 2026-11-28T07:15:10+00:00"];
        assert_eq!(new(times[0], "1"), new(times[1], "1"));
        assert_eq!(old(times[0]), old(times[1]));
        assert_ne!(new(times[0], "1"), new(times[0], "2"));
        assert_ne!(new("door @ 1", "1"), new("door @ 2", "1"));
        assert_ne!(text(times[0]), text(times[1]));
    }

    /// A name that only looks like that of a stamp hides nothing that follows it.
    #[test]
    fn what_is_named_like_a_stamp_counts() {
        type Made = fn(&str) -> String;
        let table: [(&str, Made); 5] = [
            ("a.gltf", |x| format!("{{\"nodes\":[{{\"name\":\"asset\",\"extras\":{{\"x\":{x}}}}}]}}")),
            ("a.gltf", |x| {
                format!("{{\"nodes\":[{{\"asset\":{{\"x\":{x}}}}}],\"asset\":{{\"generator\":\"a\"}}}}")
            }),
            ("a.gltf", |x| format!("{{\"extras\":\"asset\",\"nodes\":[{{\"x\":{x}}}]}}")),
            ("a.gltf", |x| format!("{{\"asset\":{{\"generator\":\"a\",\"version\":\"{x}.0\"}}}}")),
            ("a.dxf", |x| format!("  0\nTEXT\n  1\n$TDUPDATE\n 10\n{x}\n  0\nEOF\n")),
        ];
        for (name, file) in table {
            assert_ne!(key(name, &file("1")), key(name, &file("2")), "{}", file("1"));
        }
        let late =
            |time: &str| key("a.gltf", &format!("{{\"nodes\":[],\"asset\":{{\"generator\":\"{time}\"}}}}"));
        assert_eq!(late("1"), late("22"));
    }

    /// Who last touched an element, and when, is no other building.
    #[test]
    fn times_of_owners_are_stamps() {
        let ifc = |changed: &str, made: &str, user: &str| {
            let text = format!(
                "ISO-10303-21;\nDATA;\n#1= IFCOWNERHISTORY(#{user},#6,$,.ADDED.,{changed},$,$, {made});\n\
                 #2=IFCWALL('IFCOWNERHISTORY');\n#3=IFCOWNERHISTORY(#5,#6,$,.ADDED.,$,$,$,{made});\nENDSEC;\n"
            );
            key("a.ifc", &text)
        };
        assert_eq!(ifc("1767225600", "1", "5"), ifc("$", "1767225601", "5"));
        assert_ne!(ifc("1", "1", "5"), ifc("1", "1", "7"));
    }

    /// A binary file has its times as numbers of eight bytes, behind group codes of one byte or two.
    #[test]
    fn times_of_binary_files_are_stamps() {
        for is_wide in [true, false] {
            let file = |time: f64, x: f64| {
                let mut out = BINARY_SENTINEL.to_vec();
                let mut put = |code: u8, value: &[u8]| {
                    out.push(code);
                    out.extend(is_wide.then_some(0));
                    out.extend_from_slice(value);
                };
                put(0, b"SECTION\0");
                put(2, b"HEADER\0");
                put(9, b"$TDUPDATE\0");
                put(40, &time.to_le_bytes());
                put(9, b"$VERSIONGUID\0");
                put(2, format!("{{{time}}}\0").as_bytes());
                put(0, b"ENDSEC\0");
                put(0, b"LINE\0");
                put(10, &x.to_le_bytes());
                timeless(Path::new("a.dxf"), &out)
            };
            assert_eq!(file(2_460_000.5, 1.0), file(2_460_001.25, 1.0), "{is_wide}");
            assert_ne!(file(2_460_000.5, 1.0), file(2_460_000.5, 2.0), "{is_wide}");
        }
    }

    /// What wrote a GLB has a name of any length; scene and data count.
    #[test]
    fn what_wrote_a_glb_is_a_stamp() {
        let glb = |generator: &str, node: &str, data: u8| {
            let mut json =
                format!("{{\"asset\":{{\"generator\":\"{generator}\"}},\"nodes\":[{node}]}}").into_bytes();
            json.resize(json.len().next_multiple_of(4), b' ');
            let chunk = |kind: &[u8], data: &[u8]| [&(data.len() as u32).to_le_bytes(), kind, data].concat();
            let body = [chunk(b"JSON", &json), chunk(b"BIN\0", &[data; 4])].concat();
            let length = (body.len() as u32 + 12).to_le_bytes();
            let whole = [b"glTF\x02\0\0\0".as_slice(), &length, &body].concat();
            timeless(Path::new("a.glb"), &whole)
        };
        let first = glb("a", "1", 1);
        assert_eq!(glb("another program, 2026", "1", 1), first);
        assert_ne!(glb("a", "2", 1), first);
        assert_ne!(glb("a", "1", 2), first);
    }

    /// Without a stamp the content is known by its bytes, cut or odd as they may be.
    #[test]
    fn without_a_stamp_all_bytes_count() {
        for text in
            ["", "0\nEOF\n", "ISO-10303-21;FILE_NAME('", "{\"asset\":{\"a\":\"\\", "9\n$TDUPDATE\n40\n"]
        {
            for name in ["a.dxf", "a.ifc", "a.gltf"] {
                let whole: String = Sha256::digest(text).iter().map(|b| format!("{b:02x}")).collect();
                assert_eq!(key(name, text), whole, "{name} {text}");
            }
        }
    }
}

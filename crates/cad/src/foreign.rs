//! What a file is that is no drawing: by the marks that other kinds of files begin with.

use super::dxf;

/// So many bytes from the start are judged.
pub const HEAD_BYTES: usize = 1024;
/// Text has none of the control characters that count here; a file with more than one in so many bytes is none.
const BYTES_PER_CONTROL: usize = 32;
/// Fewer say nothing: a stray one comes from an old code page.
const CONTROLS_MIN: usize = 4;

/// First bytes of other kinds of files, what they are, and what helps.
const KINDS: [(&[u8], &str, &str); 21] = [
    (b"%PDF", "a PDF", "Export DXF from the program that drew it; a PDF holds no walls to write back to"),
    (b"AutoCAD DXB", "a DXB (AutoCAD binary drawing interchange)", "Load it with DXBIN and save it as DXF"),
    (b"\x89PNG\r\n\x1a\n", "a PNG picture", PICTURE),
    (b"\xff\xd8\xff", "a JPEG picture", PICTURE),
    (b"GIF8", "a GIF picture", PICTURE),
    (b"II*\0", "a TIFF picture", PICTURE),
    (b"MM\0*", "a TIFF picture", PICTURE),
    (b"BM", "a bitmap picture", PICTURE),
    (b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", "an OLE container (Revit, old Office)", EXPORT),
    (b"\x1f\x8b", "a gzip archive", UNPACK),
    (b"7z\xbc\xaf\x27\x1c", "a 7z archive", UNPACK),
    (b"Rar!\x1a\x07", "a RAR archive", UNPACK),
    (b"\xfd7zXZ\0", "an xz archive", UNPACK),
    (b"BZh", "a bzip2 archive", UNPACK),
    (b"\x28\xb5\x2f\xfd", "a Zstandard archive", UNPACK),
    (b"\x7fELF", "a program", EXPORT),
    (b"MZ", "a program", EXPORT),
    (b"SQLite format 3\0", "a database", EXPORT),
    (b"{\\rtf", "a text with formats (RTF)", EXPORT),
    (b"%!PS", "PostScript", EXPORT),
    (b"!<arch>", "a library or package", EXPORT),
];
const PICTURE: &str = "A picture has no walls to move; export the drawing itself";
const UNPACK: &str = "Unpack it and take the drawing inside";
const EXPORT: &str = "Export the drawing from the program that has it";

/// Text that other kinds begin with, lower case, after blanks.
const TEXTS: [(&[u8], &str, &str); 4] = [
    (b"<!doctype html", "a web page", "A download may need a login: open it in a browser"),
    (b"<html", "a web page", "A download may need a login: open it in a browser"),
    (b"<svg", "an SVG picture", PICTURE),
    (b"<?xml", "XML", EXPORT),
];

/// What the bytes are, if they are surely no DXF, IFC or glTF, and what helps. An archive that may hold a drawing
/// is left to its format, and so is the drawing of another format.
pub(super) fn kind_of(bytes: &[u8]) -> Option<(String, &'static str)> {
    if let Some(version) = dwg_version(bytes) {
        let hint = "Save it as DXF in the CAD program, or convert it with the ODA File Converter or LibreDWG";
        return Some((
            format!("a DWG {} ({version})", dxf::release_of(&version).unwrap_or("of an unknown release")),
            hint,
        ));
    }
    let found =
        KINDS.iter().find(|(mark, ..)| bytes.starts_with(mark) && !is_short_mark_of_text(mark, bytes));
    let text = bytes.trim_ascii_start();
    let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
    let starts = |mark: &[u8]| text.get(..mark.len()).is_some_and(|t| t.eq_ignore_ascii_case(mark));
    let found = found.or_else(|| TEXTS.iter().find(|(mark, ..)| starts(mark)));
    let named = found.map(|&(_, what, hint)| (what.to_owned(), hint));
    named
        .or_else(|| is_binary(bytes).then(|| ("binary data that is no drawing".into(), EXPORT)))
        .or_else(|| is_other_text(text).then(|| ("text that is no drawing".into(), EXPORT)))
}

/// What stands near the beginning of every drawing.
const DRAWINGS: [&str; 7] = ["SECTION", "ISO-10303", "asset", "glTF", "PK", "AutoCAD", "STEP"];

/// Whether the first line is written to its end and begins no drawing: no group code, no word of another format.
fn is_other_text(text: &[u8]) -> bool {
    let head = String::from_utf8_lossy(&text[..text.len().min(HEAD_BYTES)]);
    let Some((first, _)) = head.split_once('\n') else { return false };
    let is_code = first.trim().parse::<i32>().is_ok();
    !is_code
        && !text.contains(&0)
        && !head.trim_start().starts_with('{')
        && !DRAWINGS.iter().any(|d| head.contains(d))
}

/// Letters of two bytes by which a text without a byte order mark is known.
const WIDE_LETTERS: usize = 4;

/// Whether a text has two bytes a letter, as Windows writes "Unicode", and what helps.
pub(super) fn as_utf16(bytes: &[u8]) -> Option<(String, &'static str)> {
    let has_mark = bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff");
    let head = bytes.get(..2 * WIDE_LETTERS).unwrap_or_default();
    let is_wide = |zero: usize| {
        let of = |p: &[u8]| p[zero] == 0 && p[1 - zero].is_ascii() && p[1 - zero] != 0;
        !head.is_empty() && head.chunks_exact(2).all(of)
    };
    let hint = "Save it as UTF-8 or ASCII in a text editor, or export it again";
    (has_mark || is_wide(0) || is_wide(1)).then(|| ("text as UTF-16 (two bytes a letter)".into(), hint))
}

/// Whether a mark of two letters may be the start of a text.
fn is_short_mark_of_text(mark: &[u8], bytes: &[u8]) -> bool {
    mark.len() < 3 && mark.is_ascii() && bytes.iter().take(HEAD_BYTES).all(|b| b.is_ascii() && *b != 0)
}

/// Whether there are control characters as no text has. NULs do not count: a writer may reserve its room with them.
fn is_binary(bytes: &[u8]) -> bool {
    let head = &bytes[..bytes.len().min(HEAD_BYTES)];
    let is_odd = |b: &&u8| matches!(b, 1..=8 | 14..=25 | 27..=31 | 127);
    let odd = head.iter().filter(is_odd).count();
    odd >= CONTROLS_MIN && odd * BYTES_PER_CONTROL > head.len()
}

fn dwg_version(bytes: &[u8]) -> Option<String> {
    let digits = bytes.strip_prefix(b"AC1")?.get(..3)?;
    let is_dwg = bytes.len() > 6 && digits.iter().all(u8::is_ascii_digit);
    is_dwg.then(|| format!("AC1{}", String::from_utf8_lossy(digits)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Completeness, ReadOptions, is_complete, read};
    use enfilade_report::Report;
    use proptest::prelude::*;

    /// Under the name of any format: it is not waited for, and reading says what it is.
    fn refusal(bytes: &[u8]) -> Option<[String; 4]> {
        let one = |file: &str| {
            assert_eq!(is_complete(file, bytes), Completeness::Whole, "{file} is waited for");
            read(file, bytes, &ReadOptions::default(), &mut Report::default()).unwrap_err().to_string()
        };
        kind_of(bytes).map(|_| ["plan.dxf", "plan.ifc", "plan.gltf", "plan.glb"].map(one))
    }

    #[test]
    fn a_building_as_utf16_is_called_so() {
        let text = "ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\nENDSEC;\nEND-ISO-10303-21;\n";
        let little: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
        let big: Vec<u8> = text.encode_utf16().flat_map(u16::to_be_bytes).collect();
        for bytes in [&little, &big, &[b"\xff\xfe", &little[..]].concat(), &[b"\xfe\xff", &big[..]].concat()]
        {
            for name in ["plan.ifc", "plan.gltf"] {
                let error = read(name, bytes, &ReadOptions::default(), &mut Report::default()).unwrap_err();
                let said = error.to_string();
                assert!(said.contains("found text as UTF-16") && said.contains("Save it as UTF-8"), "{said}");
                assert_eq!(is_complete(name, bytes), Completeness::Whole, "nothing makes it one");
            }
        }
        assert_eq!(as_utf16(text.as_bytes()), None);
        assert_eq!(as_utf16(b""), None);
    }

    #[test]
    fn other_files_are_named() {
        for (mark, what, _) in KINDS.into_iter().chain(TEXTS) {
            let bytes = [mark, &[0, 200, 1, 9][..]].concat();
            for text in refusal(&bytes).unwrap() {
                assert!(text.contains(what), "{what}: {text}");
            }
        }
        for text in refusal(b"AC1032\0\0\0\0").unwrap() {
            assert!(text.contains("a DWG R2018 (AC1032)"), "{text}");
        }
        let building =
            b"<?xml version=\"1.0\"?>\n<ifc:ifcXML xmlns=\"http://www.buildingsmart-tech.org/ifcXML\">";
        assert!(refusal(building).unwrap()[1].contains("found IFC as XML"));
        for text in refusal(b"milk\nbread\n").unwrap() {
            assert!(text.contains("text that is no drawing"), "{text}");
        }
        let page = b" \r\n<!DOCTYPE html><title>Log in</title>";
        assert!(refusal(page).unwrap()[0].contains("a web page"));
    }

    #[test]
    fn controls_are_counted_to_the_last_one() {
        let with = |controls: usize| [vec![7; controls], vec![b'a'; 64]].concat();
        assert_eq!(kind_of(&with(CONTROLS_MIN - 1)), None);
        assert!(kind_of(&with(CONTROLS_MIN)).is_some());
        let far = |length: usize| [vec![b'a'; length - CONTROLS_MIN], vec![7; CONTROLS_MIN]].concat();
        assert!(kind_of(&far(CONTROLS_MIN * BYTES_PER_CONTROL - 1)).is_some());
        assert_eq!(kind_of(&far(CONTROLS_MIN * BYTES_PER_CONTROL)), None);
        let late = [vec![b'a'; HEAD_BYTES], vec![7; HEAD_BYTES]].concat();
        assert_eq!(kind_of(&late), None);
    }

    #[test]
    fn drawings_and_their_beginnings_are_none() {
        for bytes in [
            &b"  0\nSECTION\n"[..],
            b"999\nBMW works\n",
            b"milk, br",
            b"/* by hand */\nISO-10303-21;\n",
            b"\n{\n\"asset\":",
            b"AutoCAD Binary DXF\r\n\x1a\0\0SECTION\0",
            b"ISO-10303-21;",
            b"{\"asset\":",
            b"glTF\x02\0\0\0",
            b"PK\x03\x04",
            b"AC1",
            b"MZ",
            b"",
            &[0; 2000],
        ] {
            assert_eq!(kind_of(bytes), None, "{}", bytes.escape_ascii());
        }
    }

    proptest! {
        /// Noise of any bytes is named and not waited for.
        #[test]
        fn noise_is_binary(bytes in prop::collection::vec(any::<u8>(), 600..1500)) {
            prop_assert!(kind_of(&bytes).is_some());
        }
    }
}

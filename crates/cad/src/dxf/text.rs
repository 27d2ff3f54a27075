//! Code pages, and the codes that CAD programs put into texts.

use encoding_rs::{Encoding, SHIFT_JIS, UTF_8, WINDOWS_1252};

/// How the strings of a file are encoded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct CodePage {
    /// The encoding tried first.
    pub encoding: &'static Encoding,
    /// What is tried for strings that the first one does not know.
    pub fallback: &'static Encoding,
    /// Whether the file states it, by version or by `$DWGCODEPAGE`.
    pub is_stated: bool,
}

/// Code page of a file: UTF-8 from 2007 on, else `$DWGCODEPAGE`, else a guess over `samples` (the
/// file's strings that hold non-ASCII bytes): UTF-8 if all are valid, Shift_JIS if the others are valid
/// and look Japanese, else Windows-1252. A file of 2007 or later with other bytes in it is of a program
/// that wrote its old code page on: that is the fallback.
pub(super) fn code_page<'a>(
    version: &str,
    stated: Option<&str>,
    samples: impl Iterator<Item = &'a [u8]> + Clone,
) -> CodePage {
    let stated = stated.and_then(encoding_by_name);
    let guess = || {
        let others = samples.clone().filter(|s| std::str::from_utf8(s).is_err());
        match others.clone().next() {
            None if samples.clone().next().is_some() => UTF_8,
            Some(_) if looks_like_shift_jis(others) => SHIFT_JIS,
            _ => WINDOWS_1252,
        }
    };
    let own = stated.unwrap_or_else(guess);
    if version >= "AC1021" {
        let fallback = if own == UTF_8 { WINDOWS_1252 } else { own };
        return CodePage { encoding: UTF_8, fallback, is_stated: true };
    }
    CodePage { encoding: own, fallback: WINDOWS_1252, is_stated: stated.is_some() }
}

/// Encoding of a `$DWGCODEPAGE` name such as `ANSI_1252`, `dos932`, `ISO8859-1`.
fn encoding_by_name(name: &str) -> Option<&'static Encoding> {
    let name = name.to_ascii_lowercase();
    let digits = name.rsplit(['_', 's']).next().unwrap_or(&name);
    let label = match digits {
        "874" => "windows-874",
        "932" => "shift_jis",
        "936" => "gbk",
        "949" => "euc-kr",
        "950" => "big5",
        "866" => "ibm866",
        "1250" | "1251" | "1252" | "1253" | "1254" | "1255" | "1256" | "1257" | "1258" => {
            return Encoding::for_label(format!("windows-{digits}").as_bytes());
        }
        "65001" => "utf-8",
        _ if name.starts_with("iso8859-") => {
            return Encoding::for_label(name.replacen("iso", "iso-", 1).as_bytes());
        }
        _ if name == "mac-roman" => "macintosh",
        _ if name.starts_with("utf") => "utf-8",
        _ => return None,
    };
    Encoding::for_label(label.as_bytes())
}

/// Valid Shift_JIS throughout, and at least half of the double bytes start with 0x81–0x9F: kana and the
/// first kanji. European texts use 0xC0–0xFF almost alone.
fn looks_like_shift_jis<'a>(samples: impl Iterator<Item = &'a [u8]>) -> bool {
    let (mut early, mut late) = (0usize, 0usize);
    for sample in samples {
        if SHIFT_JIS.decode_without_bom_handling_and_without_replacement(sample).is_none() {
            return false;
        }
        let mut bytes = sample.iter();
        while let Some(&lead) = bytes.next() {
            match lead {
                0x81..=0x9f => early += 1,
                0xe0..=0xfc => late += 1,
                _ => continue,
            }
            bytes.next();
        }
    }
    early > 0 && early >= late
}

impl CodePage {
    /// A string of the file as text, `\U+XXXX` and `\M+nXXXX` resolved. Bytes that the code page does not
    /// know are read as Windows-1252, so that every name stays distinct.
    pub fn decode(self, value: &[u8]) -> String {
        if value.is_ascii() {
            let text = String::from_utf8_lossy(value).into_owned();
            return if text.contains('\\') { unescape_unicode(&text) } else { text };
        }
        let strict =
            |encoding: &'static Encoding| encoding.decode_without_bom_handling_and_without_replacement(value);
        let text = strict(self.encoding)
            .or_else(|| strict(self.fallback))
            .unwrap_or_else(|| WINDOWS_1252.decode_without_bom_handling(value).0);
        unescape_unicode(&text)
    }

    /// Text as bytes of the file; what the code page cannot say becomes `\U+XXXX`.
    pub fn encode(self, text: &str) -> Vec<u8> {
        let mut out = Vec::with_capacity(text.len());
        for c in text.chars() {
            let mut buffer = [0u8; 4];
            let plain = c.encode_utf8(&mut buffer);
            if c.is_ascii() {
                out.push(c as u8);
                continue;
            }
            let (bytes, _, is_lossy) = self.encoding.encode(plain);
            if self.is_stated && !is_lossy {
                out.extend_from_slice(&bytes);
            } else {
                let mut units = [0u16; 2];
                for unit in c.encode_utf16(&mut units) {
                    out.extend_from_slice(format!("\\U+{unit:04X}").as_bytes());
                }
            }
        }
        out
    }
}

fn hex4(chars: &[char]) -> Option<u16> {
    let mut value = 0u16;
    for c in chars.get(..4)? {
        value = value << 4 | c.to_digit(16)? as u16;
    }
    Some(value)
}

/// Resolves `\U+XXXX` (UTF-16 units, pairs joined) and `\M+nXXXX` (double bytes of code page n).
pub(super) fn unescape_unicode(text: &str) -> String {
    if !text.contains("\\U+") && !text.contains("\\u+") && !text.contains("\\M+") {
        return text.to_owned();
    }
    let chars: Vec<char> = text.chars().collect();
    let (mut out, mut i) = (String::with_capacity(text.len()), 0);
    while i < chars.len() {
        let rest = &chars[i..];
        if let ['\\', 'U' | 'u', '+', tail @ ..] = rest
            && let Some(unit) = hex4(tail)
        {
            let (c, used) = join_surrogates(unit, &tail[4..]);
            out.push(c);
            i += 7 + used;
        } else if let ['\\', 'M', '+', page, tail @ ..] = rest
            && let Some(c) = hex4(tail).and_then(|code| double_byte(*page, code))
        {
            out.push_str(&c);
            i += 8;
        } else {
            out.push(chars[i]);
            i += 1;
        }
    }
    out
}

fn join_surrogates(unit: u16, tail: &[char]) -> (char, usize) {
    if let Some(c) = char::from_u32(unit.into()) {
        return (c, 0);
    }
    if let ['\\', 'U' | 'u', '+', low @ ..] = tail
        && let Some(low) = hex4(low)
        && let Some(Ok(c)) = char::decode_utf16([unit, low]).next()
    {
        return (c, 7);
    }
    (char::REPLACEMENT_CHARACTER, 0)
}

fn double_byte(page: char, code: u16) -> Option<String> {
    let label: &[u8] = match page {
        '1' => b"shift_jis",
        '2' => b"big5",
        '3' => b"euc-kr",
        '5' => b"gbk",
        _ => return None,
    };
    let bytes = code.to_be_bytes();
    let text = Encoding::for_label(label)?.decode_without_bom_handling_and_without_replacement(&bytes)?;
    Some(text.trim_start_matches('\0').to_owned())
}

/// Plain text of a TEXT: `%%d`, `%%c`, `%%p`, `%%nnn`, `%%%`, switches `%%u %%o %%k` dropped, `^I ^J ^M`.
pub(super) fn plain_text(text: &str) -> String {
    let chars: Vec<char> = text.chars().collect();
    let (mut out, mut i) = (String::with_capacity(text.len()), 0);
    while i < chars.len() {
        let (c, used) = match &chars[i..] {
            ['%', '%', 'd' | 'D', ..] => (Some('°'), 3),
            ['%', '%', 'c' | 'C', ..] => (Some('⌀'), 3),
            ['%', '%', 'p' | 'P', ..] => (Some('±'), 3),
            ['%', '%', '%', ..] => (Some('%'), 3),
            ['%', '%', 'u' | 'U' | 'o' | 'O' | 'k' | 'K', ..] => (None, 3),
            ['%', '%', a, b, c, ..] if [a, b, c].iter().all(|d| d.is_ascii_digit()) => {
                let code = [a, b, c].iter().filter_map(|d| d.to_digit(10)).fold(0, |n, d| n * 10 + d);
                (char::from_u32(code), 5)
            }
            ['^', 'I', ..] => (Some('\t'), 2),
            ['^', 'J', ..] => (Some('\n'), 2),
            ['^', 'M', ..] => (None, 2),
            ['^', ' ', ..] => (Some('^'), 2),
            [c, ..] => (Some(*c), 1),
            [] => break,
        };
        out.extend(c);
        i += used;
    }
    out
}

/// Plain text of an MTEXT: formatting codes and groups dropped, `\P` a line end, stacks as `a/b`.
pub(super) fn plain_mtext(text: &str) -> String {
    let chars: Vec<char> = text.chars().collect();
    let (mut out, mut i) = (String::with_capacity(text.len()), 0);
    let until_semicolon =
        |from: usize| chars[from..].iter().position(|&c| c == ';').map_or(chars.len(), |n| from + n + 1);
    while i < chars.len() {
        match &chars[i..] {
            ['\\', 'P' | 'N' | 'X', ..] => (out.push('\n'), i += 2).1,
            ['\\', '~', ..] => (out.push('\u{a0}'), i += 2).1,
            ['\\', c @ ('\\' | '{' | '}'), ..] => (out.push(*c), i += 2).1,
            ['\\', 'L' | 'l' | 'O' | 'o' | 'K' | 'k', ..] => i += 2,
            ['\\', 'S', ..] => {
                let end = until_semicolon(i + 2);
                let stack = chars[i + 2..end].iter().filter(|&&c| c != ';' && c != ' ');
                out.extend(stack.map(|&c| if matches!(c, '^' | '#') { '/' } else { c }));
                i = end;
            }
            ['\\', 'A' | 'C' | 'c' | 'F' | 'f' | 'H' | 'p' | 'Q' | 'T' | 'W', ..] => {
                i = until_semicolon(i + 2)
            }
            ['{' | '}', ..] => i += 1,
            [c, ..] => (out.push(*c), i += 1).1,
            [] => break,
        }
    }
    plain_text(&out)
}

/// One line of plain text as the value of a TEXT, to be encoded: nothing in it is taken for a code.
pub(super) fn text_value(line: &str) -> String {
    let mut out = String::with_capacity(line.len());
    let mut chars = line.chars().peekable();
    while let Some(c) = chars.next() {
        match c {
            '^' => out.push_str("^ "),
            '%' if chars.peek() == Some(&'%') || out.ends_with('%') => out.push_str("%%%"),
            '\\' if matches!(chars.peek(), Some('U' | 'u' | 'M')) => out.push_str("\\U+005C"),
            '\t' => out.push(' '),
            c if c.is_control() => {}
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_lose_their_codes() {
        assert_eq!(
            plain_text("45%%d %%c20 %%p0.1 %%uroom%%u 100%%% %%065 a^Ib"),
            "45° ⌀20 ±0.1 room 100% A a\tb"
        );
        let mtext = r"{\fArial|b0|i0;\H2.5;Raum\~1}\P\A1;\S1/2; \Lunder\l \{x\} \C1;red\\";
        assert_eq!(plain_mtext(mtext), "Raum\u{a0}1\n1/2 under {x} red\\");
        assert_eq!(unescape_unicode(r"W\U+00E4nde \U+D83D\U+DE00 \M+182A0"), "Wände 😀 あ");
    }

    #[test]
    fn what_is_written_is_read_back() {
        for (line, stated) in
            [("100 % of 5%% ^ \\U+00FC Wände 壁 😀", true), ("a%%%b", false), ("Größe", false)]
        {
            let page = CodePage { encoding: WINDOWS_1252, fallback: WINDOWS_1252, is_stated: stated };
            let bytes = page.encode(&text_value(line));
            assert_eq!(plain_text(&page.decode(&bytes)), line);
        }
    }

    #[test]
    fn shift_jis_is_guessed_and_german_is_not() {
        let japanese: &[u8] = b"_0-9_\x95\xc7__\x91\x8b";
        let page = code_page("AC1009", None, [japanese].into_iter());
        assert_eq!((page.decode(japanese).as_str(), page.is_stated), ("_0-9_壁__窓", false));
        let german: &[u8] = b"W\xe4nde";
        assert_eq!(code_page("AC1009", None, [german].into_iter()).decode(german), "Wände");
        assert_eq!(code_page("AC1015", Some("ANSI_936"), [].into_iter()).decode(b"\xc7\xbd"), "墙");
        assert_eq!(code_page("AC1015", Some("dos932"), [].into_iter()).decode(b"\x95\xc7"), "壁");
        assert_eq!(code_page("AC1024", Some("ANSI_1252"), [].into_iter()).decode("壁".as_bytes()), "壁");
        assert_eq!(code_page("AC1024", None, [].into_iter()).decode(german), "Wände");
        assert_eq!(code_page("AC1021", Some("ANSI_932"), [].into_iter()).decode(b"\x95\xc7"), "壁");
        let mixed = ["Wände".as_bytes(), japanese];
        assert_eq!(code_page("AC1021", None, mixed.into_iter()).decode(japanese), "_0-9_壁__窓");
    }
}

//! Mutated files through every parser, by a fixed seed: the checks of `fuzz/`, without its tools. Longer by
//! `ENFILADE_FUZZ_SECS`; an input that shows a fault is left in the folder for temporary files and named.
#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::fs;
use std::panic::catch_unwind;
use std::time::{Duration, Instant};

use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

#[path = "../../fuzz/checks/building.rs"]
mod building;
#[path = "../../fuzz/checks/dxf_patch.rs"]
mod dxf_patch;
#[path = "../../fuzz/checks/dxf_read.rs"]
mod dxf_read;
#[path = "../../fuzz/checks/gltf.rs"]
mod gltf;
#[path = "../../fuzz/checks/ifc.rs"]
mod ifc;
#[path = "../../fuzz/checks/words.rs"]
mod words;

/// How long each parser is tried.
const SECS: u64 = 2;
/// Changes made to one input.
const CHANGES_MAX: usize = 6;
/// Inputs longer than this are cut: many small ones find more than few large ones.
const BYTES_MAX: usize = 200_000;

/// What stands for a number where one is expected, and what ends texts and lines.
const ODD: [&str; 24] = [
    "0",
    "-1",
    "1e999",
    "NaN",
    "1e-320",
    "-0",
    "2147483648",
    "9223372036854775808",
    "0.1",
    "1e10",
    "\n",
    "\r\n",
    "\0",
    "'",
    "\"",
    "(",
    ")",
    "[",
    "{",
    "$",
    "#1",
    ";",
    "\u{feff}",
    "ü",
];

type Corpus = Vec<Vec<u8>>;

fn corpus(folder: &str) -> Corpus {
    let folder = enfilade_fixtures::repository("fuzz/corpus").join(folder);
    let mut paths: Vec<_> = fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    paths.sort();
    paths.iter().map(|p| fs::read(p).unwrap()).collect()
}

fn dictionary(file: &str) -> Vec<String> {
    let text = fs::read_to_string(enfilade_fixtures::repository("fuzz").join(file)).unwrap();
    text.lines().filter_map(|l| l.split('"').nth(1)).map(|w| w.replace("\\x0a", "\n")).collect()
}

/// A random place with a random length behind it, mostly short.
fn span(bytes: &[u8], rng: &mut ChaCha8Rng) -> (usize, usize) {
    let start = rng.random_range(0..=bytes.len());
    let most = if rng.random_range(0..4) == 0 { bytes.len() } else { 64 };
    (start, (start + rng.random_range(0..=most)).min(bytes.len()))
}

/// The line round a random place, with its end.
fn line(bytes: &[u8], rng: &mut ChaCha8Rng) -> (usize, usize) {
    let at = rng.random_range(0..=bytes.len());
    let start = bytes[..at].iter().rposition(|b| *b == b'\n').map_or(0, |i| i + 1);
    let end = bytes[at..].iter().position(|b| *b == b'\n').map_or(bytes.len(), |i| at + i + 1);
    (start, end)
}

fn number(bytes: &[u8], rng: &mut ChaCha8Rng) -> (usize, usize) {
    let from = rng.random_range(0..=bytes.len());
    let is_part = |b: &u8| b.is_ascii_digit() || matches!(b, b'.' | b'-' | b'E' | b'e');
    let start = bytes[from..].iter().position(u8::is_ascii_digit).map_or(bytes.len(), |i| from + i);
    (start, bytes[start..].iter().position(|b| !is_part(b)).map_or(bytes.len(), |i| start + i))
}

fn change(bytes: &mut Vec<u8>, corpus: &Corpus, words: &[String], rng: &mut ChaCha8Rng) {
    let word = |rng: &mut ChaCha8Rng| {
        let i = rng.random_range(0..ODD.len() + words.len());
        ODD.get(i).map_or_else(|| words[i - ODD.len()].clone(), |w| (*w).into()).into_bytes()
    };
    match rng.random_range(0..9) {
        0 if !bytes.is_empty() => {
            let at = rng.random_range(0..bytes.len());
            bytes[at] ^= 1 << rng.random_range(0..8);
        }
        1 => {
            let (a, b) = span(bytes, rng);
            bytes.drain(a..b);
        }
        2 => {
            let (a, b) = span(bytes, rng);
            let again = bytes[a..b].to_vec();
            let at = rng.random_range(0..=bytes.len());
            bytes.splice(at..at, again);
        }
        3 => {
            let other = &corpus[rng.random_range(0..corpus.len())];
            let (a, b) = span(other, rng);
            let at = rng.random_range(0..=bytes.len());
            bytes.splice(at..at, other[a..b].iter().copied());
        }
        4 => {
            let (a, b) = number(bytes, rng);
            let odd = word(rng);
            bytes.splice(a..b, odd);
        }
        5 => {
            let (a, b) = line(bytes, rng);
            bytes.drain(a..b);
        }
        6 => {
            let (a, b) = line(bytes, rng);
            let again = bytes[a..b].to_vec();
            let (at, _) = line(bytes, rng);
            bytes.splice(at..at, again);
        }
        7 => {
            // One line in the place of another: group codes and values out of step, references to others.
            let (a, b) = line(bytes, rng);
            let again = bytes[a..b].to_vec();
            let (a, b) = line(bytes, rng);
            bytes.splice(a..b, again);
        }
        _ => {
            let at = rng.random_range(0..=bytes.len());
            let odd = word(rng);
            bytes.splice(at..at, odd);
        }
    }
}

/// Throws mutated inputs at a check until the time is over; says how many, and how many of them could be read.
fn throw(name: &str, corpus: &Corpus, words: &[String], check: fn(&[u8]) -> bool) {
    let secs = std::env::var("ENFILADE_FUZZ_SECS").ok().and_then(|s| s.parse().ok()).unwrap_or(SECS);
    for (i, input) in corpus.iter().enumerate() {
        assert!(
            catch_unwind(|| check(input)).is_ok(),
            "{name}: the fault above comes from input {i} of the corpus"
        );
    }
    let mut rng = ChaCha8Rng::seed_from_u64(9);
    let (start, mut thrown, mut read, mut slowest) = (Instant::now(), 0u64, 0u64, Duration::ZERO);
    while thrown < 20 || start.elapsed() < Duration::from_secs(secs) {
        // The smaller of two: a large file costs as much as many small ones and finds no more.
        let drawn = [0, 1].map(|_| &corpus[rng.random_range(0..corpus.len())]);
        let mut bytes = drawn[usize::from(drawn[1].len() < drawn[0].len())].clone();
        for _ in 0..rng.random_range(1..=CHANGES_MAX) {
            change(&mut bytes, corpus, words, &mut rng);
            bytes.truncate(BYTES_MAX);
        }
        let begun = Instant::now();
        match catch_unwind(|| check(&bytes)) {
            Ok(is_read) => read += u64::from(is_read),
            Err(_) => {
                let left = std::env::temp_dir().join(format!("enfilade-{name}-{thrown}"));
                fs::write(&left, &bytes).unwrap();
                panic!("{name}: the fault above comes from {}", left.display());
            }
        }
        slowest = slowest.max(begun.elapsed());
        thrown += 1;
    }
    println!(
        "{name}: {thrown} inputs in {:.0} s, {read} of them read, the slowest in {:.2} s",
        start.elapsed().as_secs_f64(),
        slowest.as_secs_f64()
    );
    assert!(read > 0, "nothing that was thrown could be read");
}

#[test]
fn dxf_reading_survives_anything() {
    throw("dxf_read", &corpus("dxf"), &dictionary("dxf.dict"), dxf_read::check);
}

#[test]
fn dxf_writing_survives_anything() {
    throw("dxf_patch", &corpus("dxf"), &dictionary("dxf.dict"), dxf_patch::check);
}

#[test]
fn ifc_survives_anything() {
    throw("ifc", &corpus("ifc"), &dictionary("step.dict"), ifc::check);
}

/// Every argument of every instance missing with all that follow, unset, derived, far beyond all buildings, of
/// another kind: what chance meets late.
#[test]
fn ifc_survives_every_argument_gone_wrong() {
    let whole = fs::read(enfilade_fixtures::repository("fuzz/corpus/ifc/bodies.ifc")).unwrap();
    let text = String::from_utf8(whole).unwrap();
    let mut tried = 0;
    for (from, line) in text.match_indices('\n').map(|(at, _)| (at + 1, text[at + 1..].lines().next())) {
        let Some(line) = line.filter(|l| l.starts_with('#') && l.ends_with(");")) else { continue };
        let (open, close) = (from + line.find('(').unwrap() + 1, from + line.len() - 2);
        let commas: Vec<usize> =
            (open..close).filter(|&i| is_outermost(&text[open..i], &text[i..])).collect();
        let starts = std::iter::once(open).chain(commas.iter().map(|c| c + 1));
        for (start, end) in starts.zip(commas.iter().copied().chain([close])) {
            let gone = if start > open { start - 1 } else { start };
            let odd = ["$", "*", "1.E300", "()", "'x'"].map(|odd| (start, end, odd));
            for (from, to, odd) in odd.into_iter().chain([(gone, close, "")]) {
                let bytes = [&text[..from], odd, &text[to..]].concat();
                let outcome = catch_unwind(|| ifc::check(bytes.as_bytes()));
                assert!(outcome.is_ok(), "{odd:?} from {:?} on in {line}", &text[start..end]);
                tried += 1;
            }
        }
    }
    assert!(tried > 3000, "{tried}");
}

/// Whether a comma begins here, outside of all lists and texts that the arguments before it began.
fn is_outermost(before: &str, from: &str) -> bool {
    let (mut depth, mut in_text) = (0, false);
    for c in before.chars() {
        match c {
            '\'' => in_text = !in_text,
            '(' if !in_text => depth += 1,
            ')' if !in_text => depth -= 1,
            _ => {}
        }
    }
    from.starts_with(',') && depth == 0 && !in_text
}

#[test]
fn gltf_survives_anything() {
    throw("gltf", &corpus("gltf"), &dictionary("gltf.dict"), gltf::check);
}

#[test]
fn settings_jobs_and_results_survive_anything() {
    throw("words", &corpus("words"), &[], words::check);
}

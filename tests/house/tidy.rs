//! The rules of the house, read from the source text (`ARCHITECTURE.md`).

#![allow(clippy::expect_used)]

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// What a drawing names that lies elsewhere is never fetched, and a job speaks to nobody.
const NETWORK: &str = "only the page speaks to a network, and that is this machine";

/// Words that only one file may say: the word, the file, why.
const ONLY_IN: &[(&str, &str, &str)] = &[
    ("clap", "src/cli.rs", "the command line has one file"),
    ("notify", "src/watch", "file events have one file"),
    ("wgpu", "crates/engine/src/gpu.rs", "the graphics card has one file"),
    ("TcpStream", "src/server", NETWORK),
    ("TcpListener", "src/server", NETWORK),
    ("UdpSocket", "src/server", NETWORK),
    ("fs::write", "src/store", WRITING),
    ("fs::rename", "src/store", WRITING),
    ("fs::copy", "src/store", WRITING),
    ("fs::remove_file", "src/store", WRITING),
    ("fs::remove_dir", "src/store", WRITING),
    ("fs::remove_dir_all", "src/store", WRITING),
    ("fs::create_dir", "src/store", WRITING),
    ("fs::create_dir_all", "src/store", WRITING),
    ("File::create", "src/store", WRITING),
    ("File::create_new", "src/store", WRITING),
    ("OpenOptions", "src/store", WRITING),
    ("tempfile", "src/store", WRITING),
];
const WRITING: &str = "only the store writes files";

/// Module names that say nothing about what is inside.
const EMPTY_NAMES: &[&str] =
    &["util", "utils", "helper", "helpers", "common", "manager", "types", "misc", "stuff", "base"];

/// What must not stand outside tests.
const FORBIDDEN: &[&str] = &[".unwrap()", ".expect(\"", "todo!", "unimplemented!", "dbg!"];

/// Lines at which a file has become two.
const LINES_MAX: usize = 800;

/// A source file: its path below the repository and what is in it.
struct Source {
    path: String,
    /// As written.
    raw: String,
    /// Without comments and contents of strings; lines stay where they are.
    code: String,
    /// The same without test code; empty for a file of tests.
    product: String,
}

impl Source {
    fn new(path: String, raw: String) -> Self {
        let code = without_comments_and_strings(&raw);
        let name = path.rsplit('/').next().unwrap_or_default();
        let is_test = source_root(&path).is_none()
            || path.starts_with("crates/fixtures/")
            || path.contains("/tests/")
            || name == "tests.rs"
            || name.ends_with("_tests.rs");
        let product = if is_test { String::new() } else { without_test_items(&code) };
        Self { path, raw, code, product }
    }

    /// Paths of the modules that this file declares for tests only.
    fn test_modules(&self) -> Vec<String> {
        let folder = module_folder(&self.path);
        let declared = self.code.split("#[cfg(test)]").skip(1).filter_map(|after| {
            let item = &after[..after.find([';', '{'])?];
            let name = item.trim().strip_prefix("mod ").or(item.trim().split_once(" mod ").map(|p| p.1))?;
            after[item.len()..].starts_with(';').then(|| name.trim().to_owned())
        });
        declared.flat_map(|n| [format!("{folder}/{n}.rs"), format!("{folder}/{n}/mod.rs")]).collect()
    }

    fn place(&self, offset: usize) -> String {
        format!("{}:{}", self.path, 1 + self.code[..offset].matches('\n').count())
    }
}

/// The folder of a crate's sources in which a file lies: `src`, `crates/cad/src`.
fn source_root(path: &str) -> Option<&str> {
    if path.starts_with("src/") {
        return Some("src");
    }
    let name = path.strip_prefix("crates/")?.split('/').next()?;
    let root = path.get(.."crates/".len() + name.len() + "/src".len())?;
    path[root.len()..].starts_with('/').then_some(root).filter(|r| r.ends_with("/src"))
}

/// The folder in which the modules lie that a file declares.
fn module_folder(path: &str) -> &str {
    let folder = path.trim_end_matches(".rs");
    ["/mod", "/lib", "/main"].iter().find_map(|end| folder.strip_suffix(end)).unwrap_or(folder)
}

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

/// All files below a folder with one of the extensions, in order of path.
fn files(folder: &Path, extensions: &[&str], found: &mut Vec<PathBuf>) {
    let Ok(entries) = fs::read_dir(folder) else { return };
    let mut paths: Vec<_> = entries.map(|e| e.expect("directory entry").path()).collect();
    paths.sort();
    for path in paths {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if path.is_dir() {
            if !["target", ".git", ".venv", "corpus", "artifacts"].contains(&name.as_str())
                && !name.ends_with(".enfilade")
            {
                files(&path, extensions, found);
            }
        } else if extensions.iter().any(|e| name.ends_with(e)) {
            found.push(path);
        }
    }
}

fn relative(path: &Path) -> String {
    path.strip_prefix(root()).unwrap_or(path).to_string_lossy().replace('\\', "/")
}

fn sources() -> Vec<Source> {
    let mut found = vec![];
    for folder in ["src", "crates", "tests", "examples", "benches", "fuzz", "plugins"] {
        files(&root().join(folder), &[".rs"], &mut found);
    }
    let read = |p: &PathBuf| Source::new(relative(p), fs::read_to_string(p).expect("source"));
    let mut sources: Vec<_> = found.iter().map(read).collect();
    let for_tests: Vec<_> = sources.iter().flat_map(Source::test_modules).collect();
    sources.iter_mut().filter(|s| for_tests.contains(&s.path)).for_each(|s| s.product.clear());
    sources
}

/// Blanks comments and the contents of string and character literals.
fn without_comments_and_strings(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(c) = rest.chars().next() {
        let (keep, blank) = literal_or_comment(rest, out.chars().last());
        let taken = if keep + blank == 0 { c.len_utf8() } else { keep + blank };
        if keep + blank == 0 {
            out.push(c);
        } else {
            out.push_str(&rest[..keep]);
            out.extend(rest[keep..taken].bytes().map(|b| if b == b'\n' { '\n' } else { ' ' }));
        }
        rest = &rest[taken..];
    }
    out
}

/// Bytes to keep and bytes to blank where a comment, string or character begins; (0, 0) elsewhere.
fn literal_or_comment(text: &str, before: Option<char>) -> (usize, usize) {
    let is_word = before.is_some_and(|c| c.is_alphanumeric() || c == '_');
    if text.starts_with("//") {
        return (0, text.find('\n').unwrap_or(text.len()));
    }
    if text.starts_with("/*") {
        return (0, block_comment(text));
    }
    if let Some(inside) = text.strip_prefix('"') {
        return (1, quoted(inside, '"'));
    }
    if let Some(raw) = text.strip_prefix('r').filter(|_| !is_word) {
        let hashes = raw.bytes().take_while(|&b| b == b'#').count();
        if raw[hashes..].starts_with('"') {
            let end = format!("\"{}", "#".repeat(hashes));
            let from = 2 + hashes;
            return (from, text[from..].find(&end).map_or(text.len() - from, |i| i + end.len()));
        }
    }
    if let Some(inside) = text.strip_prefix('\'') {
        // A lifetime has no closing quote right after one character or escape.
        let mut chars = inside.char_indices();
        let first = chars.next().map(|(_, c)| c);
        let second = chars.next();
        if first == Some('\\') || second.is_some_and(|(_, c)| c == '\'') {
            return (1, quoted(inside, '\''));
        }
    }
    (0, 0)
}

/// Bytes up to and with the closing quote.
fn quoted(text: &str, quote: char) -> usize {
    let mut is_escaped = false;
    for (i, c) in text.char_indices() {
        match c {
            _ if is_escaped => is_escaped = false,
            '\\' => is_escaped = true,
            c if c == quote => return i + 1,
            _ => {}
        }
    }
    text.len()
}

/// Bytes of a block comment, which may hold others.
fn block_comment(text: &str) -> usize {
    let (mut depth, mut i) = (0, 0);
    while i < text.len() {
        let step = match &text.as_bytes()[i..] {
            [b'/', b'*', ..] => (2, 1),
            [b'*', b'/', ..] => (2, -1),
            _ => (1, 0),
        };
        i += step.0;
        depth += step.1;
        if depth == 0 {
            break;
        }
    }
    i
}

/// Blanks every item under `#[cfg(test)]`.
fn without_test_items(code: &str) -> String {
    const MARK: &str = "#[cfg(test)]";
    let mut out = code.as_bytes().to_vec();
    let mut from = 0;
    while let Some(start) = code[from..].find(MARK).map(|i| i + from) {
        let mut depth = 0;
        let item = code[start + MARK.len()..].char_indices().find(|&(_, c)| {
            depth += i32::from(c == '{') - i32::from(c == '}');
            depth == 0 && (c == ';' || c == '}')
        });
        let end = item.map_or(code.len(), |(i, _)| start + MARK.len() + i + 1);
        out[start..end].iter_mut().filter(|b| **b != b'\n').for_each(|b| *b = b' ');
        from = end;
    }
    String::from_utf8_lossy(&out).into_owned()
}

/// Places where `word` stands as a word of its own.
fn words<'a>(code: &'a str, word: &'a str) -> impl Iterator<Item = usize> + 'a {
    let is_word = |c: Option<char>| c.is_some_and(|c| c.is_alphanumeric() || c == '_');
    code.match_indices(word).map(|(i, _)| i).filter(move |&i| {
        let last = i + word.len();
        !is_word(code[..i].chars().next_back()) && !is_word(code[last..].chars().next())
    })
}

/// Paths of modules and items that begin with `crate` or `super`, from the file that names them: how many modules up
/// (none: from the crate's own root), and the names that follow.
fn named_paths(code: &str) -> Vec<(Option<usize>, Vec<String>)> {
    let mut found = vec![];
    for at in words(code, "crate") {
        follow(&code[at + "crate".len()..], &[], &mut |names| found.push((None, names)));
    }
    for at in words(code, "super").filter(|&at| !code[..at].ends_with("super::")) {
        let mut rest = &code[at + "super".len()..];
        let mut ups = 1;
        while let Some(next) = rest.strip_prefix("::super") {
            (rest, ups) = (next, ups + 1);
        }
        follow(rest, &[], &mut |names| found.push((Some(ups), names)));
    }
    found
}

/// Hands out every path that goes on here, with `::name` and `::{name, name::{…}}`.
fn follow(code: &str, before: &[String], found: &mut dyn FnMut(Vec<String>)) {
    let Some(rest) = code.trim_start().strip_prefix("::") else { return found(before.to_vec()) };
    let rest = rest.trim_start();
    let Some(group) = rest.strip_prefix('{') else {
        let name: String = rest.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
        let with = [before, std::slice::from_ref(&name)].concat();
        return if name.is_empty() {
            found(before.to_vec())
        } else {
            follow(&rest[name.len()..], &with, found)
        };
    };
    let (mut depth, mut start) = (0, 0);
    for (i, c) in group.char_indices() {
        match c {
            '{' => depth += 1,
            '}' if depth > 0 => depth -= 1,
            ',' | '}' if depth == 0 => {
                if !group[start..i].trim().is_empty() {
                    follow(&format!("::{}", group[start..i].trim()), before, found);
                }
                start = i + 1;
                if c == '}' {
                    return;
                }
            }
            _ => {}
        }
    }
}

/// Circles of imports between files of one crate. A module and what lies inside it are one room: the inner ones may name
/// what the outer one holds.
fn circle_faults(sources: &[Source]) -> Vec<String> {
    let is_own = |s: &&Source| source_root(&s.path).is_some();
    let files: BTreeMap<&str, &Source> = sources
        .iter()
        .filter(|s| !s.product.is_empty())
        .filter(is_own)
        .map(|s| (s.path.as_str(), s))
        .collect();
    let imports: BTreeMap<&str, BTreeSet<&str>> =
        files.iter().map(|(path, source)| (*path, imports_of(source, &files))).collect();
    let reach = |from: &str| {
        let mut reached: BTreeSet<&str> = BTreeSet::new();
        let mut ahead: Vec<&str> = imports[from].iter().copied().collect();
        while let Some(next) = ahead.pop() {
            if reached.insert(next) {
                ahead.extend(&imports[next]);
            }
        }
        reached
    };
    let reached: BTreeMap<&str, BTreeSet<&str>> = files.keys().map(|path| (*path, reach(path))).collect();
    let in_circle = |path: &&str| reached[path].contains(path);
    let circles: BTreeSet<Vec<&str>> = files
        .keys()
        .copied()
        .filter(|path| in_circle(path))
        .map(|path| reached[path].iter().copied().filter(|other| reached[other].contains(path)).collect())
        .collect();
    circles.iter().map(|circle| format!("import each other in a circle: {}", circle.join(", "))).collect()
}

/// Files that a file imports from, but for those inside it and around it.
fn imports_of<'s>(source: &Source, files: &BTreeMap<&'s str, &'s Source>) -> BTreeSet<&'s str> {
    let Some(root) = source_root(&source.path) else { return BTreeSet::new() };
    let own = module_folder(&source.path);
    let mut out = BTreeSet::new();
    for (ups, names) in named_paths(&source.product) {
        let start = match ups {
            None => root,
            Some(ups) => {
                (0..ups).fold(own, |folder, _| folder.rsplit_once('/').map_or(root, |parts| parts.0))
            }
        };
        let mut folder = start.to_owned();
        let mut file = None;
        for name in names {
            folder = format!("{folder}/{name}");
            let found =
                ["", "/mod"].iter().find_map(|end| files.get_key_value(format!("{folder}{end}.rs").as_str()));
            let Some((path, _)) = found else { break };
            file = Some(*path);
        }
        let is_apart = |other: &str| {
            let other = module_folder(other);
            let is_within = |a: &str, b: &str| a == b || a.starts_with(&format!("{b}/"));
            !is_within(own, other) && !is_within(other, own)
        };
        out.extend(file.filter(|f| is_apart(f)));
    }
    out
}

fn word_faults(source: &Source) -> Vec<String> {
    let file = &source.path;
    // A file that has grown into a folder of the same name is still one place.
    let is_home =
        |home: &str| file == home || file.starts_with(&format!("{}/", home.trim_end_matches(".rs")));
    let foreign = ONLY_IN.iter().filter(|row| !is_home(row.1));
    foreign
        .flat_map(|&(word, home, why)| {
            words(&source.product, word)
                .map(move |at| format!("{}: `{word}` belongs to {home}: {why}", source.place(at)))
        })
        .collect()
}

fn forbidden_faults(source: &Source) -> Vec<String> {
    FORBIDDEN
        .iter()
        .flat_map(|word| source.product.match_indices(word).map(move |(at, _)| (at, word)))
        .map(|(at, word)| format!("{}: `{word}` outside tests", source.place(at)))
        .collect()
}

/// A test that does not run tells nothing: what is wrong today is asserted as such.
fn ignored_faults(source: &Source) -> Vec<String> {
    let ignored = source.code.match_indices("#[ignore").map(|(at, _)| at);
    ignored.map(|at| format!("{}: a test that is ignored", source.place(at))).collect()
}

fn shape_faults(source: &Source) -> Vec<String> {
    let mut faults = vec![];
    let lines = source.raw.lines().count();
    if lines > LINES_MAX {
        faults.push(format!("{}: {lines} lines; a file of more than {LINES_MAX} is two", source.path));
    }
    for part in source.path.trim_end_matches(".rs").split('/') {
        if EMPTY_NAMES.contains(&part) {
            faults.push(format!("{}: `{part}` says nothing about what is inside", source.path));
        }
    }
    if !source.product.is_empty() && !source.raw.starts_with("//!") {
        faults.push(format!("{}: does not begin by saying what it is (`//!`)", source.path));
    }
    faults
}

/// A reason stands just above, or above the `#![allow(unsafe_code)]` of the module around it.
fn unsafe_faults(source: &Source) -> Vec<String> {
    let lines: Vec<&str> = source.raw.lines().collect();
    let has_reason = |at: usize| {
        let line = source.code[..at].matches('\n').count();
        let mut above = lines[line.saturating_sub(6)..=line].iter();
        above.any(|l| l.contains("SAFETY") || l.contains("# Safety"))
    };
    words(&source.code, "unsafe")
        .filter(|&at| {
            let allowed = source.code[..at].rfind("#![allow(unsafe_code)]");
            !has_reason(at) && !allowed.is_some_and(has_reason)
        })
        .map(|at| format!("{}: `unsafe` without its reason (SAFETY) just above", source.place(at)))
        .collect()
}

/// Public limits: constants with `MAX` as a part of the name.
fn limits(source: &Source) -> Vec<String> {
    let code = &source.product;
    words(code, "const")
        .filter(|&at| code[..at].trim_end().ends_with("pub") || code[..at].trim_end().ends_with(')'))
        .map(|at| code[at + 5..].trim_start().split(|c: char| !c.is_alphanumeric() && c != '_').next())
        .filter_map(|name| name.map(str::to_owned))
        .filter(|name| name.split('_').any(|part| part == "MAX"))
        .collect()
}

#[track_caller]
fn assert_none(faults: Vec<String>) {
    assert!(faults.is_empty(), "\n{}\n", faults.join("\n"));
}

#[test]
fn no_circle_of_imports_stands_between_files() {
    assert_none(circle_faults(&sources()));
}

#[test]
fn some_words_belong_to_one_file() {
    assert_none(sources().iter().flat_map(word_faults).collect());
}

#[test]
fn nothing_unfinished_or_aborting_outside_tests() {
    assert_none(sources().iter().flat_map(forbidden_faults).collect());
}

#[test]
fn no_test_is_ignored() {
    assert_none(sources().iter().flat_map(ignored_faults).collect());
}

#[test]
fn files_have_names_introductions_and_bounds() {
    assert_none(sources().iter().flat_map(shape_faults).collect());
}

#[test]
fn unsafe_code_gives_its_reason() {
    assert_none(sources().iter().flat_map(unsafe_faults).collect());
}

#[test]
fn every_public_limit_has_a_test() {
    let sources = sources();
    let tested: Vec<String> = sources
        .iter()
        .map(|s| if s.product.is_empty() { s.code.clone() } else { test_items(&s.code, &s.product) })
        .collect();
    let untested = sources.iter().flat_map(|s| limits(s).into_iter().map(|name| (s.path.clone(), name)));
    assert_none(
        untested
            // A limit that is the default of a field is tripped through that field.
            .filter(|(_, name)| {
                let field = name.to_lowercase();
                !tested.iter().any(|t| words(t, name).chain(words(t, &field)).next().is_some())
            })
            .map(|(path, name)| format!("{path}: no test names the limit {name}"))
            .collect(),
    );
}

/// What of the code is test code: where code and product differ.
fn test_items(code: &str, product: &str) -> String {
    let both = code.bytes().zip(product.bytes());
    both.map(|(c, p)| if c == p && c != b'\n' { ' ' } else { char::from(c) }).collect()
}

/// Places of the machine something was written on have no business in a project file.
#[test]
fn no_machine_path_anywhere() {
    let mut found = vec![];
    let texts = [
        ".rs", ".md", ".toml", ".dxf", ".py", ".sh", ".html", ".wgsl", ".json", "run", "setup", "demo",
        "test",
    ];
    files(&root(), &texts, &mut found);
    let parts = ["work", "root", "home", "Users"].map(|part| format!("/{part}/"));
    let mut faults = vec![];
    for path in found {
        let Ok(text) = fs::read_to_string(&path) else { continue };
        for (number, line) in text.lines().enumerate() {
            // `~/…`, `<home>/…` and addresses of the web name no machine.
            let is_absolute =
                |i: usize| !line[..i].ends_with(|c: char| c.is_alphanumeric() || "~.>}/-_".contains(c));
            if parts.iter().any(|p| line.match_indices(p.as_str()).any(|(i, _)| is_absolute(i))) {
                faults.push(format!("{}:{}: {}", relative(&path), number + 1, line.trim()));
            }
        }
    }
    assert_none(faults);
}

mod the_rules_find_faults {
    use super::*;

    fn source(path: &str, raw: &str) -> Source {
        Source::new(path.into(), raw.into())
    }

    #[test]
    fn circles() {
        let faults = |files: &[(&str, &str)]| {
            circle_faults(&files.iter().map(|(path, raw)| source(path, raw)).collect::<Vec<_>>())
        };
        let tied = [("src/a.rs", "use crate::b::{c, d};"), ("src/b.rs", "fn f() { super::a::g() }")];
        assert_eq!(faults(&tied), ["import each other in a circle: src/a.rs, src/b.rs"]);
        assert_eq!(
            faults(&[tied[0], ("src/b.rs", "// crate::a\n#[cfg(test)]\nmod tests { use crate::a; }")]).len(),
            0
        );
        let group = ("crates/x/src/b/mod.rs", "use crate::{c, a::{self, d}};");
        assert_eq!(faults(&[("crates/x/src/a.rs", "use super::b;"), group]).len(), 1);
        let inside = ("crates/x/src/a/i.rs", "use super::super::b::e;");
        assert_eq!(faults(&[("crates/x/src/a.rs", "use super::b;"), group, inside]).len(), 1);
        // What lies inside a module may name what it holds.
        assert_eq!(
            faults(&[("src/a.rs", "mod i;\nuse self::i::x;"), ("src/a/i.rs", "use super::y;")]).len(),
            0
        );
        // Crates are apart.
        assert_eq!(faults(&[("src/a.rs", "use crate::b;"), ("crates/x/src/b.rs", "use crate::a;")]).len(), 0);
    }

    #[test]
    fn words_of_one_file() {
        let faults = |path, raw| word_faults(&source(path, raw)).len();
        assert_eq!(faults("src/cli.rs", "use clap::Parser;"), 0);
        assert_eq!(faults("crates/cad/src/dxf.rs", "use clap::Parser;"), 1);
        assert_eq!(faults("src/daemon.rs", "let clapped = 1; // clap"), 0);
        assert_eq!(faults("crates/overlay/src/page.rs", "std::fs::write(a, b)"), 1);
        assert_eq!(faults("crates/overlay/src/page.rs", "fs::write_all"), 0);
        assert_eq!(faults("crates/overlay/src/page.rs", "#[cfg(test)]\nfn f() { fs::write(a, b) }"), 0);
    }

    #[test]
    fn forbidden_words() {
        let faults = |raw| forbidden_faults(&source("crates/plan/src/a.rs", raw)).len();
        assert_eq!(faults("fn f() { a.unwrap(); b.expect(\"c\"); todo!() }"), 3);
        assert_eq!(faults("fn f() { a.unwrap_or(1); self.expect(2) } // .unwrap()"), 0);
        assert_eq!(
            faults("fn f() -> &'static str { \".unwrap()\" }\nfn g(c: char) { c == '\"'; x.unwrap() }"),
            1
        );
        assert_eq!(faults("const A: &str = r#\"todo! \" \"#; /* dbg! /* */ dbg! */"), 0);
    }

    #[test]
    fn modules_for_tests() {
        let modules = |path, raw| source(path, raw).test_modules();
        let raw = "#[cfg(test)]\nmod a;\n#[cfg(test)]\npub(crate) mod b;\n#[cfg(test)]\nmod c { }\nmod d;";
        let below = |folder: &str| ["a", "b"].map(|n| format!("{folder}/{n}.rs"));
        let files =
            |path| modules(path, raw).into_iter().filter(|p| !p.ends_with("mod.rs")).collect::<Vec<_>>();
        assert_eq!(files("crates/plan/src/axes/mod.rs"), below("crates/plan/src/axes"));
        assert_eq!(files("crates/plan/src/x.rs"), below("crates/plan/src/x"));
        assert_eq!(files("src/lib.rs"), below("src"));
    }

    #[test]
    fn ignored_tests() {
        let raw = "#[test]\n#[ignore = \"slow\"]\nfn f() {} // #[ignore]";
        assert_eq!(ignored_faults(&source("tests/a.rs", raw)), ["tests/a.rs:2: a test that is ignored"]);
    }

    #[test]
    fn shapes() {
        let faults = |path: &str, raw: &str| shape_faults(&source(path, raw)).len();
        assert_eq!(faults("crates/plan/src/a.rs", "//! About.\n"), 0);
        assert_eq!(faults("crates/plan/src/a.rs", "fn f() {}\n"), 1);
        assert_eq!(faults("crates/plan/src/utils.rs", "//! About.\n"), 1);
        assert_eq!(faults("crates/utils/src/a.rs", "//! About.\n"), 1);
        assert_eq!(faults("tests/a.rs", &"\n".repeat(LINES_MAX)), 0);
        assert_eq!(faults("tests/a.rs", &"\n".repeat(LINES_MAX + 1)), 1);
    }

    #[test]
    fn unsafe_and_limits() {
        let faults = |raw: &str| unsafe_faults(&source("crates/plan/src/a.rs", raw)).len();
        assert_eq!(faults("fn f() {\n    // SAFETY: checked above.\n    unsafe { g() }\n}"), 0);
        assert_eq!(faults("fn f() { unsafe { g() } }"), 1);
        let module = |reason| {
            format!(
                "mod x {{\n    {reason}\n    #![allow(unsafe_code)]\n{}fn f() {{ unsafe {{ g() }} }}\n}}",
                "\n".repeat(9)
            )
        };
        assert_eq!(faults(&module("// SAFETY of every block here: checked.")), 0);
        assert_eq!(faults(&module("// Fast.")), 1);
        let raw =
            "pub const SIZE_MAX: u8 = 1;\npub(crate) const MAX_DEPTH: u8 = 1;\nconst OWN_MAX: u8 = 1;\n";
        assert_eq!(limits(&source("crates/plan/src/a.rs", raw)), ["SIZE_MAX", "MAX_DEPTH"]);
    }
}

/// Every hazard of a watched folder and every rule of safety has its row, and every test that a row names exists.
#[test]
fn hazards_and_rules_of_safety_have_their_tests() {
    assert_rows_name_tests("docs/watching.md", 30);
    assert_rows_name_tests("docs/safety.md", 19);
}

fn assert_rows_name_tests(file: &str, count: usize) {
    let table = fs::read_to_string(root().join(file)).expect(file);
    let rows: Vec<&str> = table.lines().filter(|l| l.starts_with("| ") && l.contains('`')).collect();
    let numbers: Vec<Option<usize>> =
        rows.iter().map(|r| r.split('|').nth(1).and_then(|n| n.trim().parse().ok())).collect();
    assert_eq!(numbers, (1..=count).map(Some).collect::<Vec<_>>(), "{file}");
    let sources = sources();
    let of_plugins = ["plugins/tests/common/test_bundle.py", "plugins/dask/tests/test_dask.py"];
    let of_plugins: String =
        of_plugins.iter().map(|f| fs::read_to_string(root().join(f)).expect(f)).collect();
    let is_test = |name: &str| {
        let head = format!("fn {name}(");
        sources.iter().any(|s| s.raw.contains(&head)) || of_plugins.contains(&format!("def {name}("))
    };
    for row in rows {
        let tests: Vec<&str> =
            row.rsplit('|').nth(1).unwrap_or_default().split('`').skip(1).step_by(2).collect();
        assert!(!tests.is_empty(), "{row}");
        for name in tests {
            let is_there = match name.strip_suffix(".script") {
                Some(_) => root().join("tests/data/watch").join(name).is_file(),
                None => is_test(name),
            };
            assert!(is_there, "no test {name}: {row}");
        }
    }
}

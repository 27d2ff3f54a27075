//! The documents: short sentences, plain words, links that lead somewhere, commands that the program takes, pictures
//! that a script makes.

#![allow(clippy::expect_used)]

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use clap::error::ErrorKind;
use clap::{CommandFactory, Parser};
use enfilade::cli::Cli;

/// Most words of a sentence.
const WORDS_MAX: usize = 25;
/// Most words and lines of the README: one screen.
const README_MAX: [usize; 2] = [450, 65];
/// What is said shorter or plainer.
const PHRASES: &[&str] = &[
    "none of which",
    "is told",
    "are told",
    "goes along",
    "go along",
    "went along",
    "to speak of",
    "accessibility",
    "organisation",
];

/// A page and what stands in it.
struct Page {
    /// Below the repository.
    path: String,
    text: String,
}

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn read(path: &str) -> Page {
    Page { path: path.into(), text: fs::read_to_string(root().join(path)).expect(path) }
}

/// Files below a folder of the repository whose names end so, in order.
fn files(folder: &str, ending: &str) -> Vec<String> {
    let mut found = vec![];
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(root().join(&folder)).expect(&folder) {
            let entry = entry.expect("entry");
            let path = format!("{folder}/{}", entry.file_name().to_string_lossy());
            if entry.path().is_dir() {
                folders.push(path);
            } else if path.ends_with(ending) {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

/// The pages of the project at its root, in the book and beside the plugins and samples.
fn pages() -> Vec<Page> {
    let at_root =
        ["README.md", "ARCHITECTURE.md", "BENCHMARKS.md", "CHANGELOG.md", "CONTRIBUTING.md", "SECURITY.md"];
    let below = ["docs", "plugins", "samples"].into_iter().flat_map(|folder| files(folder, ".md"));
    at_root.into_iter().map(String::from).chain(below).map(|p| read(&p)).collect()
}

fn assert_none(faults: &[String]) {
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));
}

/// Lines in fences, and the text without them.
fn parted(text: &str) -> (Vec<&str>, String) {
    let (mut code, mut prose, mut is_code) = (vec![], String::new(), false);
    for line in text.lines() {
        if line.trim_start().starts_with("```") {
            is_code = !is_code;
            prose.push('\n');
        } else if is_code {
            code.push(line);
        } else {
            prose.push_str(line);
            prose.push('\n');
        }
    }
    (code, prose)
}

/// Text with inline code as one word and links as their words.
fn plain(text: &str) -> String {
    let without_code: String =
        text.split('`').enumerate().map(|(i, part)| if i % 2 == 0 { part } else { "X" }).collect();
    let mut out = String::new();
    let mut rest = without_code.as_str();
    while let Some((before, target)) = rest.split_once("](") {
        out.push_str(before);
        rest = target.split_once(')').map_or("", |parts| parts.1);
    }
    out.push_str(rest);
    out.replace("![", "").replace('[', "")
}

/// Whether a line begins an item of a list.
fn item(line: &str) -> Option<&str> {
    let bullet = line.strip_prefix("- ").or_else(|| line.strip_prefix("* "));
    let number = || line.split_once(". ").filter(|(n, _)| n.parse::<u32>().is_ok()).map(|(_, rest)| rest);
    bullet.or_else(number)
}

/// Sentences of the prose: paragraphs and items, without tables, headings and code.
fn sentences(text: &str) -> Vec<String> {
    let mut blocks = vec![String::new()];
    for line in parted(text).1.lines().map(str::trim) {
        let starts = item(line);
        if line.is_empty() || line.starts_with(['|', '#', '<']) || starts.is_some() {
            blocks.push(String::new());
        }
        if !line.starts_with(['|', '#', '<'])
            && let Some(block) = blocks.last_mut()
        {
            block.push_str(starts.unwrap_or(line));
            block.push(' ');
        }
    }
    blocks.iter().flat_map(|block| split_sentences(&plain(block))).collect()
}

/// A sentence ends with a mark before a blank.
fn split_sentences(block: &str) -> Vec<String> {
    let mut out = vec![vec![]];
    for word in block.split_whitespace() {
        if let Some(last) = out.last_mut() {
            last.push(word);
        }
        if word.trim_end_matches(['*', ')', '"', '”']).ends_with(['.', '!', '?']) {
            out.push(vec![]);
        }
    }
    out.into_iter().filter(|words| !words.is_empty()).map(|words| words.join(" ")).collect()
}

/// What is wrong with a sentence.
fn fault_of(sentence: &str) -> Option<String> {
    let words = sentence.split(' ').filter(|w| w.chars().any(char::is_alphanumeric)).count();
    if words > WORDS_MAX {
        return Some(format!("{words} words"));
    }
    let lower = sentence.to_lowercase();
    if let Some(phrase) = PHRASES.iter().find(|p| lower.contains(*p)) {
        return Some(format!("says “{phrase}”"));
    }
    let is_roundabout = sentence.starts_with("What ") && lower.contains(" is ") && !sentence.ends_with('?');
    is_roundabout.then(|| "says “what … is …”".into())
}

/// Links of a page that stay within the project: file and heading.
fn links(text: &str) -> Vec<(String, String)> {
    let prose = parted(text).1;
    let targets = prose.split("](").skip(1).filter_map(|rest| rest.split_once(')'));
    let split = |target: &str| {
        let (file, heading) = target.split_once('#').unwrap_or((target, ""));
        (file.to_owned(), heading.to_owned())
    };
    targets.map(|(target, _)| target).filter(|t| !t.contains("://")).map(split).collect()
}

/// A heading as links name it.
fn anchor(heading: &str) -> String {
    let kept = heading.to_lowercase();
    let kept = kept.chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
    kept.collect::<String>().trim().replace(' ', "-")
}

/// Words of a command line, as a shell parts them, up to a comment.
fn words(line: &str) -> Vec<String> {
    let (mut out, mut word, mut quote) = (vec![], String::new(), None);
    for c in line.chars() {
        match (c, quote) {
            ('#', None) if word.is_empty() => break,
            ('"' | '\'', None) => quote = Some(c),
            (c, Some(q)) if c == q => quote = None,
            (' ', None) if !word.is_empty() => out.push(std::mem::take(&mut word)),
            (' ', None) => {}
            (c, _) => word.push(c),
        }
    }
    out.extend((!word.is_empty()).then_some(word));
    out
}

/// Commands of the program that a page shows: lines in fences, and inline code.
fn commands(text: &str) -> Vec<String> {
    let (code, prose) = parted(text);
    let inline = prose.split('`').skip(1).step_by(2).map(str::to_owned);
    let all = code.into_iter().map(|line| line.trim().to_owned()).chain(inline);
    all.filter(|c| c.starts_with("enfilade ") && !c.contains("COMMAND")).collect()
}

#[test]
fn sentences_are_short_and_plain() {
    let mut faults = vec![];
    for page in pages() {
        for sentence in sentences(&page.text) {
            faults.extend(fault_of(&sentence).map(|why| format!("{}: {why}: {sentence}", page.path)));
        }
    }
    assert_none(&faults);
}

#[test]
fn the_readme_is_one_screen() {
    let text = read("README.md").text;
    let size = [text.split_whitespace().count(), text.lines().count()];
    assert!(size[0] <= README_MAX[0] && size[1] <= README_MAX[1], "{size:?} words and lines");
}

#[test]
fn links_lead_somewhere() {
    let mut faults = vec![];
    for page in pages() {
        let folder = Path::new(&page.path).parent().expect("a folder").to_owned();
        for (file, heading) in links(&page.text) {
            let target = if file.is_empty() { page.path.clone().into() } else { folder.join(&file) };
            let is_there = root().join(&target).exists();
            let has_heading = || {
                let text = fs::read_to_string(root().join(&target)).unwrap_or_default();
                let is_it = |l: &str| anchor(l.trim_start_matches('#')) == heading;
                parted(&text).1.lines().filter(|l| l.starts_with('#')).any(is_it)
            };
            if !is_there || !heading.is_empty() && !has_heading() {
                faults.push(format!("{}: {file}#{heading}", page.path));
            }
        }
    }
    assert_none(&faults);
}

#[test]
fn commands_are_what_the_program_takes() {
    let mut faults = vec![];
    let mut count = 0;
    for page in pages() {
        for line in commands(&page.text) {
            count += 1;
            let is_asked = |k| matches!(k, ErrorKind::DisplayHelp | ErrorKind::DisplayVersion);
            match Cli::try_parse_from(words(&line)) {
                Err(e) if !is_asked(e.kind()) => faults.push(format!("{}: {line}: {e}", page.path)),
                _ => {}
            }
        }
    }
    assert_none(&faults);
    assert!(count > 50, "only {count} commands were found");
}

/// What the README says first is what a stranger does first.
#[test]
fn the_commands_of_the_readme_work() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::copy(root().join("samples/library.dxf"), folder.path().join("plan.dxf")).expect("a plan");
    let text = read("README.md").text;
    let (code, _) = parted(&text);
    let lines: Vec<&str> = code.into_iter().filter(|l| l.starts_with("enfilade ")).collect();
    assert_eq!(lines.len(), 4);
    for line in lines {
        let mut words = words(line);
        if words[1] == "run" {
            words.extend(["--evaluations", "40"].map(String::from));
        }
        let mut command = Command::new(env!("CARGO_BIN_EXE_enfilade"));
        let output = command.args(&words[1..]).current_dir(folder.path()).output().expect("it runs");
        let said = String::from_utf8_lossy(&output.stderr);
        // 1: fewer options than wanted, after so few layouts.
        assert!(matches!(output.status.code(), Some(0 | 1)), "{line}: {:?}\n{said}", output.status);
    }
    for name in [
        "check.png",
        "works.png",
        "plan.enfilade/round-01/report.html",
        "plan.enfilade/round-01/candidate-1.dxf",
    ] {
        assert!(folder.path().join(name).is_file(), "{name}");
    }
    assert!(folder.path().join("plan-r02.dxf").is_file());
}

/// What a page shows of the quick commands works as it stands, on a sample.
#[test]
fn quick_commands_run_on_the_samples() {
    let folder = tempfile::tempdir().expect("a folder");
    let samples = folder.path().join("samples");
    fs::create_dir(&samples).expect("a folder");
    for path in files("samples", "").into_iter().filter(|p| !p.contains(".enfilade/")) {
        fs::copy(root().join(&path), folder.path().join(&path)).expect(&path);
    }
    fs::copy(samples.join("library.dxf"), folder.path().join("plan.dxf")).expect("a plan");
    let quick = ["check", "init", "man", "completions"];
    let lines = pages().into_iter().flat_map(|page| {
        let shown: Vec<String> = parted(&page.text).0.into_iter().map(|l| l.trim().to_owned()).collect();
        shown.into_iter().filter(|l| quick.iter().any(|q| l.starts_with(&format!("enfilade {q}"))))
    });
    let lines: BTreeSet<String> = lines.collect();
    assert!(lines.len() >= 6, "{lines:?}");
    for line in lines {
        let mut command = Command::new(env!("CARGO_BIN_EXE_enfilade"));
        let output = command.args(&words(&line)[1..]).current_dir(folder.path()).output().expect("it runs");
        assert!(output.status.success(), "{line}: {}", String::from_utf8_lossy(&output.stderr));
    }
}

#[test]
fn every_page_is_in_the_book() {
    let summary = links(&read("docs/SUMMARY.md").text).into_iter().map(|(file, _)| format!("docs/{file}"));
    let listed: BTreeSet<String> = summary.collect();
    let there: BTreeSet<String> =
        files("docs", ".md").into_iter().filter(|p| p != "docs/SUMMARY.md").collect();
    assert_eq!(listed, there);
    let decisions = links(&read("docs/decisions/README.md").text).len();
    assert_eq!(decisions + 1, files("docs/decisions", ".md").len());
}

#[test]
fn every_picture_is_shown_and_made_by_a_script() {
    let pages = pages();
    let makers = [("docs/pictures/", "scripts/pictures"), ("docs/hosts/pictures/", "plugins/bundle.py")];
    let mut faults = vec![];
    for picture in files("docs", ".png") {
        let name = picture.rsplit('/').next().unwrap_or_default();
        if !pages.iter().any(|p| links(&p.text).iter().any(|(file, _)| file.ends_with(name))) {
            faults.push(format!("{picture}: no page shows it"));
        }
        let stem = name.trim_end_matches(".png");
        let maker = makers.iter().find(|(folder, _)| picture.starts_with(folder)).map(|(_, script)| *script);
        if !maker.is_some_and(|script| read(script).text.contains(stem)) {
            faults.push(format!("{picture}: no script makes it"));
        }
    }
    assert_none(&faults);
}

#[test]
fn every_command_and_module_has_its_row() {
    let mut faults = vec![];
    let mut expect = |page: &str, row: String| {
        if !read(page).text.lines().any(|l| l.starts_with(&row)) {
            faults.push(format!("{page}: {row}"));
        }
    };
    for command in Cli::command().get_subcommands().filter(|c| !c.is_hide_set() && c.get_name() != "help") {
        expect("docs/commands.md", format!("| `enfilade {}", command.get_name()));
    }
    assert_none(&faults);
    let architecture = read("ARCHITECTURE.md").text;
    for module in read("src/lib.rs").text.lines().filter_map(|l| l.strip_prefix("pub mod ")) {
        let name = format!("`{}`", module.trim_end_matches(';'));
        assert!(architecture.contains(&name), "ARCHITECTURE.md: {name}");
    }
}

/// What a message is made with; its code follows.
const MAKERS: &[&str] = &[
    ".info(",
    ".warn(",
    ".note(",
    ".add(",
    "Error::input(",
    "Error::usage(",
    "Error::environment(",
    "code: ",
];

/// Codes of messages that a source file makes, but for its tests.
fn codes(source: &str) -> Vec<&str> {
    let product = source.split("#[cfg(test)]").next().unwrap_or_default();
    let after = MAKERS.iter().flat_map(|maker| product.split(maker).skip(1));
    let quoted = after.filter_map(|rest| rest.trim_start().strip_prefix('"')?.split_once("\","));
    let is_code = |c: &str| c.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-');
    quoted.map(|(code, _)| code).filter(|c| is_code(c)).collect()
}

/// A message that the page does not explain leaves its reader alone.
#[test]
fn every_code_is_explained() {
    let page = read("docs/codes.md").text;
    let cells = page.lines().filter_map(|l| l.strip_prefix("| ")?.split_once(" | ")).map(|(cell, _)| cell);
    let explained: BTreeSet<&str> = cells.flat_map(|cell| cell.split('`').skip(1).step_by(2)).collect();
    let mut faults = vec![];
    for path in files("src", ".rs").iter().filter(|p| !p.ends_with("tests.rs") && !p.contains("/tests/")) {
        let source = read(path).text;
        let unexplained = codes(&source).into_iter().filter(|c| !explained.contains(c));
        faults.extend(unexplained.map(|c| format!("docs/codes.md: {c} of {path}")));
    }
    assert_none(&faults);
}

mod the_rules_find_faults {
    use super::*;

    #[test]
    fn codes() {
        let source = "r.warn(\n \"a-b\", p); e(Error::usage(\"c\", x)); add(\"No\", 1)\n#[cfg(test)]\nr.info(\"d\", p)";
        assert_eq!(super::codes(source), ["a-b", "c"]);
    }

    #[test]
    fn sentences() {
        let found = |text: &str| super::sentences(text);
        assert_eq!(
            found("# A b.\n\nOne\ntwo. Three!\n- Four\n- Five 1.5 m"),
            ["One two.", "Three!", "Four", "Five 1.5 m"]
        );
        assert_eq!(
            found("Say `a b.c d` to [two words](x.md).\n```\nno. no.\n```\n| no | no |"),
            ["Say X to two words."]
        );
        let long = "a ".repeat(WORDS_MAX + 1);
        assert!(fault_of(&long).is_some() && fault_of(&long[2..]).is_none());
        assert!(fault_of("The user is told so.").is_some());
        assert!(fault_of("What moves is named.").is_some() && fault_of("What is it?").is_none());
    }

    #[test]
    fn links_and_headings() {
        assert_eq!(
            links("[a](b.md#c-d) [e](https://f) ![g](h.png)"),
            [("b.md", "c-d"), ("h.png", "")].map(|(f, h)| (f.into(), h.into()))
        );
        assert_eq!(anchor(" What a threshold is"), "what-a-threshold-is");
    }

    #[test]
    fn commands() {
        assert_eq!(
            words("enfilade run a.dxf --snap \"0.1 m, 5 deg\"   # why"),
            ["enfilade", "run", "a.dxf", "--snap", "0.1 m, 5 deg"]
        );
        assert_eq!(
            super::commands("`enfilade man`\n```sh\nenfilade check a\nother\n```"),
            ["enfilade check a", "enfilade man"]
        );
        assert!(Cli::try_parse_from(words("enfilade run a.dxf --no-such-option")).is_err());
    }
}

//! One analysis in parts: `parts` lists, `run-job` does each, `merge` writes what `analyse` would have written.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Output;

use super::jobs::enfilade_in;

fn enfilade(args: &[&str], input: &str) -> Output {
    enfilade_in(Path::new("."), args, input)
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

/// A sample in a folder of its own, analysed on one machine and in parts.
struct Case {
    dir: tempfile::TempDir,
    plan: PathBuf,
    options: Vec<&'static str>,
}

impl Case {
    fn new(sample: &str, options: &[&'static str]) -> Self {
        let dir = tempfile::tempdir().unwrap();
        let plan = dir.path().join(sample);
        fs::copy(enfilade_fixtures::repository("samples").join(sample), &plan).unwrap();
        Self { dir, plan, options: options.to_vec() }
    }

    fn at(&self, name: &str) -> PathBuf {
        self.dir.path().join(name)
    }

    /// Files of an analysis and the table of cells, with what the command said.
    fn made(&self, name: &str, command: &[&str]) -> (BTreeMap<PathBuf, Vec<u8>>, Output) {
        let out = self.at(name);
        fs::create_dir_all(&out).unwrap();
        let cells = out.join("cells.csv");
        let own = ["--cells", text(&cells), "--out", text(&out), "--quiet"];
        let output = enfilade(&[command, &own].concat(), "");
        let mut files = BTreeMap::new();
        let mut folders = vec![out.clone()];
        while let Some(folder) = folders.pop() {
            for entry in fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()) {
                if entry.is_dir() {
                    folders.push(entry);
                } else if entry.file_name().unwrap() != ".lock" {
                    files.insert(entry.strip_prefix(&out).unwrap().into(), fs::read(&entry).unwrap());
                }
            }
        }
        (files, output)
    }

    fn on_one_machine(&self) -> BTreeMap<PathBuf, Vec<u8>> {
        let command = [&["analyse", text(&self.plan), "--backend", "cpu"], &self.options[..]].concat();
        let (files, output) = self.made("one", &command);
        assert!(output.status.code() <= Some(1), "{}", said(&output));
        files
    }

    /// The list of so many parts, as a file and as lines.
    fn listed(&self, parts: &str, more: &[&str]) -> (PathBuf, Vec<String>) {
        let (list, out) = (self.at("parts.jsonl"), self.at("parts"));
        let own = ["parts", text(&self.plan), "--parts", parts, "--out", text(&out), "-o", text(&list)];
        let output = enfilade(&[&own, &self.options[..], more].concat(), "");
        assert_eq!(output.status.code(), Some(0), "{}", said(&output));
        let lines = fs::read_to_string(&list).unwrap().lines().map(str::to_owned).collect();
        (list, lines)
    }

    fn merged(&self, list: &Path) -> (BTreeMap<PathBuf, Vec<u8>>, Output) {
        self.made("many", &["merge", text(list)])
    }
}

fn do_each<'a>(lines: impl IntoIterator<Item = &'a String>, more: &[&str]) {
    for line in lines {
        let output = enfilade(&[&["run-job", "-"], more].concat(), line);
        assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    }
}

/// Every family, named pairs of regions, storeys and stairs; any order and number of threads; more parts than waves.
#[test]
fn parts_make_what_one_machine_makes() {
    for (sample, parts, options) in [
        ("gallery.dxf", "5", &["--measures", "all", "--spacing", "0.6"][..]),
        ("gallery.dxf", "2", &["--measures", "visual,metric", "--radius", "3", "--no-pictures"]),
        ("museum-hall.dxf", "3", &["--measures", "Visual Mean Depth", "--spacing", "0.8"]),
        ("pavilion.ifc", "3", &["--over-stairs"]),
        ("school-wing.ifc", "2", &["--spacing", "1"]),
    ] {
        let case = Case::new(sample, options);
        let one = case.on_one_machine();
        let (list, lines) = case.listed(parts, &[]);
        let (early, late) = lines.split_at(1);
        do_each(late.iter().rev(), &["--threads", "1"]);
        do_each(early, &["--threads", "3"]);
        let (many, output) = case.merged(&list);
        assert!(output.status.code() <= Some(1), "{sample}: {}", said(&output));
        assert!(one.len() > 1 && one.keys().eq(many.keys()), "{sample}: {:?} {:?}", one.keys(), many.keys());
        let differ: Vec<&PathBuf> = one.iter().filter(|(k, v)| many[*k] != **v).map(|(k, _)| k).collect();
        assert!(differ.is_empty(), "{sample} {options:?}: {differ:?}");
    }
}

/// What is missing or damaged is named with its lines, and only that is done again.
#[test]
fn what_is_missing_is_named_and_sent_again() {
    let case = Case::new("gallery.dxf", &["--spacing", "0.8"]);
    let (list, lines) = case.listed("7", &[]);
    do_each(lines[..2].iter().chain(&lines[5..6]), &[]);
    let left = case.at("left.jsonl");
    let merge = || enfilade(&["merge", text(&list), "--missing", text(&left), "--quiet"], "");
    let output = merge();
    assert_eq!(output.status.code(), Some(75));
    let words = "parts 3 to 5, 7 of 7 are not done";
    assert!(said(&output).contains(words) && said(&output).contains("lines 3 to 5, 7"), "{}", said(&output));
    assert!(!case.at("gallery.enfilade").exists(), "nothing is written");
    let sent: Vec<String> = fs::read_to_string(&left).unwrap().lines().map(str::to_owned).collect();
    assert_eq!(sent, [&lines[2..5], &lines[6..]].concat());
    do_each(&sent, &[]);
    let id = serde_json::from_str::<serde_json::Value>(&lines[4]).unwrap()["id"].as_str().unwrap().to_owned();
    let values = case.at("parts").join(id).join("result/part.bin");
    let whole = fs::read(&values).unwrap();
    fs::write(&values, &whole[..whole.len() / 2]).unwrap();
    assert!(said(&merge()).contains("part 5 of 7 is not done, or damaged"), "{}", said(&merge()));
    do_each(&lines[4..5], &[]);
    assert_eq!(fs::read(&values).unwrap(), whole);
    assert_eq!(merge().status.code(), Some(0));
    assert_eq!(fs::read_to_string(&left).unwrap(), "");
}

#[test]
fn what_is_no_list_of_one_analysis_is_refused() {
    let case = Case::new("gallery.dxf", &["--spacing", "0.8"]);
    let (list, lines) = case.listed("2", &[]);
    do_each(&lines, &[]);
    let (_, other) = case.listed("2", &["--measures", "metric"]);
    let rounds = enfilade(&["jobs", text(&case.plan)], "");
    let rounds = String::from_utf8(rounds.stdout).unwrap();
    let changed = lines[1].replace("\"count\":2", "\"count\":3");
    for (content, words) in [
        (String::new(), "has no job in it"),
        (lines[1].clone(), "has no line of part 1 of 2"),
        (format!("{}\n{}\n", lines[0], other[1]), "line 2 is of another analysis"),
        (rounds, "line 1: is a job of `jobs`"),
        (format!("{}\n{changed}\n", lines[0]), "line 2: job: its id does not belong to it"),
        ("no json\n".into(), "line 1: job"),
    ] {
        fs::write(&list, content).unwrap();
        let output = enfilade(&["merge", text(&list), "--quiet"], "");
        assert_eq!(output.status.code(), Some(2), "{words}: {}", said(&output));
        assert!(said(&output).contains(words), "{words}: {}", said(&output));
    }
    fs::write(&list, lines.join("\n")).unwrap();
    fs::write(&case.plan, "changed").unwrap();
    let output = enfilade(&["merge", text(&list), "--quiet"], "");
    assert!(output.status.code() == Some(2) && said(&output).contains("changed since"), "{}", said(&output));
    for (bad, words) in [
        (&["--measures", "beauty"][..], "beauty"),
        (&["--radius", "2.5"], "whole number"),
        (&["--threads", "2"], "`run-job`"),
    ] {
        let plan = enfilade_fixtures::repository("samples/gallery.dxf");
        let output = enfilade(&[&["parts", text(&plan), "--parts", "2"], bad].concat(), "");
        assert!(output.status.code() == Some(3) && said(&output).contains(words), "{}", said(&output));
    }
}

//! Real drawings, where they lie beside the repository: read, patched and compared with other readers.

use std::path::{Path, PathBuf};

use enfilade::formats::dxf::{Completeness, ReadOptions, changed_records, is_complete, patch, read};
use enfilade::plan::drawing::{Drawing, Edit, Editable};
use enfilade::report::Report;

/// The drawings of `shared/data/dxf` and `shared/reference`, sorted; empty, with a note, where they are absent.
fn corpus() -> Vec<(String, Vec<u8>)> {
    let shared = std::env::var_os("ENFILADE_SHARED")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared"), PathBuf::from);
    let mut files: Vec<PathBuf> = ["data/dxf", "reference", "reference/bench", "reference/depthmapx-n900"]
        .iter()
        .filter_map(|folder| std::fs::read_dir(shared.join(folder)).ok())
        .flat_map(|folder| folder.filter_map(|entry| Some(entry.ok()?.path())))
        .filter(|path| path.extension().is_some_and(|extension| extension == "dxf"))
        .collect();
    files.sort();
    if files.is_empty() {
        eprintln!("skipped: no drawings in {}", shared.display());
    }
    let named = |path: &PathBuf| path.file_name().unwrap().to_string_lossy().into_owned();
    files.iter().map(|path| (named(path), std::fs::read(path).unwrap())).collect()
}

fn read_whole(name: &str, bytes: &[u8]) -> (Drawing, Report) {
    let mut report = Report::default();
    let drawing = read(name, bytes, &ReadOptions::default(), &mut report);
    (drawing.unwrap_or_else(|error| panic!("{name}: {error}")), report)
}

#[test]
fn every_drawing_is_read() {
    for (name, bytes) in corpus() {
        assert_eq!(is_complete(&bytes), Completeness::Whole, "{name}");
        let (drawing, report) = read_whole(&name, &bytes);
        assert!(!drawing.entities.is_empty(), "{name}");
        eprintln!(
            "{name}: {} {} entities, {} texts, {} layers, {}",
            drawing.version,
            drawing.entities.len(),
            drawing.texts.len(),
            drawing.layers.len(),
            drawing.declared_unit_words
        );
        for problem in &report.problems {
            eprintln!("    {:?} {problem}", problem.severity);
        }
    }
}

#[test]
fn rewriting_what_was_read_changes_no_byte() {
    for (name, bytes) in corpus() {
        let (drawing, _) = read_whole(&name, &bytes);
        let free = drawing.entities.iter().filter(|e| e.editable == Editable::Free);
        let edits: Vec<Edit> =
            free.map(|e| Edit::Shape { record: e.source.record, shape: e.shape.clone() }).collect();
        assert_eq!(patch(&name, &bytes, &[], &[]).unwrap(), bytes, "{name}");
        assert!(patch(&name, &bytes, &edits, &[]).unwrap() == bytes, "{name}");
        assert!(changed_records(&name, &bytes, &edits).unwrap().iter().all(Vec::is_empty), "{name}");
    }
}
